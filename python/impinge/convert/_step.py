"""Reads STEP models by Open CASCADE (cadquery-ocp)."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.collections import Sequence_TDF_Label
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_AsciiString, TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_Tool
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from impinge.convert._glb import Glb

_SAG = 1e-4
"""Default sag, in meters."""

_TURN = 0.5
"""Maximum angle between neighboring triangles of a curved surface, in radians."""

_METER = 1000.0
"""Length of a meter in the unit that Open CASCADE converts models to, the millimeter."""


def read(path: str, sag: float | None) -> Glb:
    """Return the solids and surfaces of a model, in meters."""
    document = TDocStd_Document(TCollection_ExtendedString("XCAF"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(path) != IFSelect_RetDone or not reader.Transfer(document):
        raise ValueError("not a STEP model that Open CASCADE can read")
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots = Sequence_TDF_Label()
    tool.GetFreeShapes(roots)
    length = _SAG if sag is None else sag
    model = _Model(Glb({"source": os.path.basename(path), "sag": length}), length)
    for number in range(1, roots.Length() + 1):
        model.add(roots.Value(number), None, np.eye(4), "")
    return model.glb


class _Model:
    """A model that is converted, with the meshes of the shapes that were read."""

    def __init__(self, glb: Glb, sag: float) -> None:
        self.glb = glb
        self._sag = sag
        self._meshes: dict[str, int | None] = {}

    def add(self, label: TDF_Label, parent: int | None, matrix: NDArray[np.float64], given: str) -> None:
        """Add a shape or an assembly at a place. `given` is the name of the instance."""
        name = given or _name(label) or "part"
        if not XCAFDoc_ShapeTool.IsAssembly_s(label):
            mesh = self._mesh(label, name)
            if mesh is not None:
                self.glb.add_part(name, parent, {}, mesh, matrix)
            return
        group = self.glb.add_group(name, parent, {})
        components = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetComponents_s(label, components)
        for number in range(1, components.Length() + 1):
            component, shape = components.Value(number), TDF_Label()
            if XCAFDoc_ShapeTool.GetReferredShape_s(component, shape):
                place = matrix @ _matrix(XCAFDoc_ShapeTool.GetLocation_s(component))
                self.add(shape, group, place, _name(component))

    def _mesh(self, label: TDF_Label, name: str) -> int | None:
        """Return the mesh of a shape, which is made once; None if the shape has no faces."""
        key = _entry(label)
        if key not in self._meshes:
            vertices, faces = _triangles(XCAFDoc_ShapeTool.GetShape_s(label), self._sag)
            self._meshes[key] = self.glb.add_mesh(vertices, faces, name) if len(faces) else None
        return self._meshes[key]


def _triangles(shape: Any, sag: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the vertices of a shape in meters, and its triangles, which share vertices."""
    BRepMesh_IncrementalMesh(shape, sag * _METER, False, _TURN, True)
    points: list[NDArray[np.float64]] = []
    corners: list[NDArray[np.int64]] = []
    first = 0
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        face, location = TopoDS.Face(explorer.Current()), TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        explorer.Next()
        if triangulation is None:
            continue
        nodes = [triangulation.Node(number) for number in range(1, triangulation.NbNodes() + 1)]
        local = np.array([(node.X(), node.Y(), node.Z()) for node in nodes])
        matrix = _matrix(location, unit=1.0)
        points.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        indices = [triangulation.Triangle(number).Get() for number in range(1, triangulation.NbTriangles() + 1)]
        triangles = np.array(indices, np.int64).reshape(-1, 3) - 1 + first
        is_reversed = face.Orientation() == TopAbs_REVERSED
        corners.append(triangles[:, ::-1] if is_reversed else triangles)
        first += len(nodes)
    if not corners:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    # Faces that share an edge have points along it that are equal in single precision. They become
    # one vertex. A shape far from the origin is rounded around a point of its own.
    meters = np.concatenate(points) / _METER
    center = np.round(0.5 * (meters.min(axis=0) + meters.max(axis=0)))
    vertices, which = np.unique((meters - center).astype(np.float32), axis=0, return_inverse=True)
    faces = which.reshape(-1)[np.concatenate(corners)]
    is_whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return vertices.astype(np.float64) + center, faces[is_whole]


def _matrix(location: TopLoc_Location, unit: float = _METER) -> NDArray[np.float64]:
    """Return the map of a location, with its translation divided by a unit."""
    transformation = location.Transformation()
    matrix = np.eye(4)
    for row in range(3):
        for column in range(4):
            matrix[row, column] = transformation.Value(row + 1, column + 1)
    matrix[:3, 3] /= unit
    return matrix


def _name(label: TDF_Label) -> str:
    found = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), found):
        return ""
    return str(found.Get().ToExtString()).strip()


def _entry(label: TDF_Label) -> str:
    """Return the path of a label in its document."""
    entry = TCollection_AsciiString()
    TDF_Tool.Entry_s(label, entry)
    return str(entry.ToCString())
