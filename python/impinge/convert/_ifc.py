"""Reads IFC models by ifcopenshell."""

from __future__ import annotations

import multiprocessing
import os
from typing import Any

import ifcopenshell
import ifcopenshell.geom
import ifcopenshell.util.element
import ifcopenshell.util.shape
import numpy as np

from impinge.convert._glb import Glb

_SAG = 1e-3
"""Default sag, in meters: that of ifcopenshell."""

_WITHOUT_BODY = ["IfcOpeningElement", "IfcSpace"]
"""Classes of elements that have a shape but are not material."""

_FURTHER = ["ObjectType", "PredefinedType", "Tag"]
"""Further attributes that become extras of a part."""


def read(path: str, sag: float | None) -> Glb:
    """Return the elements of a model that have a shape, in meters."""
    model = ifcopenshell.open(path)
    settings = ifcopenshell.geom.settings()
    settings.set("mesher-linear-deflection", _SAG if sag is None else sag)
    glb = Glb({"source": os.path.basename(path), "sag": _SAG if sag is None else sag})
    absent = [name for name in _WITHOUT_BODY if not _is_known(model, name)]
    without = [name for name in _WITHOUT_BODY if name not in absent]
    iterator = ifcopenshell.geom.iterator(settings, model, multiprocessing.cpu_count(), exclude=without)
    shapes = []
    if iterator.initialize():
        while True:
            shapes.append(iterator.get())
            if not iterator.next():
                break
    meshes: dict[str, int | None] = {}
    groups: dict[int, int] = {}
    # The threads of ifcopenshell return elements in any order.
    for shape in sorted(shapes, key=lambda shape: shape.id):
        geometry = shape.geometry
        if geometry.id not in meshes:
            faces = ifcopenshell.util.shape.get_faces(geometry)
            vertices = np.asarray(ifcopenshell.util.shape.get_vertices(geometry), np.float64)
            meshes[geometry.id] = glb.add_mesh(vertices, faces, geometry.id) if len(faces) else None
        mesh = meshes[geometry.id]
        if mesh is None:
            continue
        element = model.by_id(shape.id)
        parent = _group(glb, groups, ifcopenshell.util.element.get_parent(element))
        matrix = np.asarray(ifcopenshell.util.shape.get_shape_matrix(shape), np.float64)
        glb.add_part(_name(element), parent, _extras(element), mesh, matrix)
    return glb


def _is_known(model: Any, name: str) -> bool:
    """Report whether the schema of a model has a class."""
    try:
        model.by_type(name)
    except RuntimeError:
        return False
    return True


def _group(glb: Glb, groups: dict[int, int], element: Any) -> int | None:
    """Return the node of an element that contains others: a storey, a building or an assembly."""
    if element is None:
        return None
    if element.id() not in groups:
        parent = _group(glb, groups, ifcopenshell.util.element.get_parent(element))
        groups[element.id()] = glb.add_group(_name(element), parent, _extras(element))
    return groups[element.id()]


def _name(element: Any) -> str:
    return str(element.Name or element.is_a())


def _extras(element: Any) -> dict[str, Any]:
    further = {name: getattr(element, name, None) for name in _FURTHER}
    own = {"GlobalId": element.GlobalId, "type": element.is_a()}
    return own | {name: value for name, value in further.items() if value not in (None, "", "NOTDEFINED")}
