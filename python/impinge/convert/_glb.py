"""Writes scenes as GLB: the binary container of glTF 2.0."""

from __future__ import annotations

import json
import os
import struct
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

_FAR = 4.0
"""Distance from the origin, in sizes of a mesh, from which the mesh gets an origin of its own."""


class Glb:
    """A scene of meshes, which nodes share.

    Parameters
    ----------
    extras : dict
        Properties of the file, such as the sag.
    """

    def __init__(self, extras: dict[str, Any]) -> None:
        self._extras = extras
        self._nodes: list[dict[str, Any]] = []
        self._roots: list[int] = []
        self._meshes: list[dict[str, Any]] = []
        self._origins: list[NDArray[np.float64]] = []
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, int]] = []
        self._chunks: list[bytes] = []
        self._length = 0
        self.parts = 0
        """Number of nodes with a mesh."""

    def add_mesh(self, vertices: NDArray[np.float64], faces: NDArray[Any], name: str) -> int:
        """Add a mesh and return its index.

        Vertices are stored in single precision. A mesh far from the origin is stored around a point
        of its own, which the nodes add again, so that it keeps its precision.
        """
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        is_far = np.abs(vertices).max() > _FAR * np.linalg.norm(high - low)
        origin = np.round(0.5 * (low + high)) if is_far else np.zeros(3)
        points = (vertices - origin).astype("<f4")
        bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
        position = self._accessor(points, "VEC3", 5126, bounds)
        indices = self._accessor(np.ascontiguousarray(faces, "<u4").reshape(-1), "SCALAR", 5125, {})
        self._meshes.append({"name": name, "primitives": [{"attributes": {"POSITION": position}, "indices": indices}]})
        self._origins.append(origin)
        return len(self._meshes) - 1

    def add_group(self, name: str, parent: int | None, extras: dict[str, Any]) -> int:
        """Add a node without a mesh, and return its index."""
        return self._add({"name": name} | ({"extras": extras} if extras else {}), parent)

    def add_part(
        self, name: str, parent: int | None, extras: dict[str, Any], mesh: int, matrix: NDArray[np.float64]
    ) -> None:
        """Add a node with a mesh at a place in the scene. Groups around it have the identity."""
        world = matrix.copy()
        world[:3, 3] += matrix[:3, :3] @ self._origins[mesh]
        node: dict[str, Any] = {"name": name, "mesh": mesh}
        if not np.array_equal(world, np.eye(4)):
            node["matrix"] = world.T.reshape(-1).tolist()
        if extras:
            node["extras"] = extras
        self._add(node, parent)
        self.parts += 1

    def _add(self, node: dict[str, Any], parent: int | None) -> int:
        self._nodes.append(node)
        number = len(self._nodes) - 1
        siblings = self._roots if parent is None else self._nodes[parent].setdefault("children", [])
        siblings.append(number)
        return number

    def _accessor(self, values: NDArray[Any], shape: str, component: int, bounds: dict[str, Any]) -> int:
        content = values.tobytes()
        self._views.append({"buffer": 0, "byteOffset": self._length, "byteLength": len(content)})
        self._chunks.append(content)
        self._length += len(content)
        view = len(self._views) - 1
        about = {"bufferView": view, "componentType": component, "count": len(values), "type": shape}
        self._accessors.append(about | bounds)
        return len(self._accessors) - 1

    def write(self, path: str) -> None:
        """Write the file. A file of this name is replaced once the new one is complete."""
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "impinge.convert", "extras": self._extras},
            "scene": 0,
            "scenes": [{"nodes": self._roots} if self._roots else {}],
        }
        lists = {"nodes": self._nodes, "meshes": self._meshes, "accessors": self._accessors, "bufferViews": self._views}
        document |= {name: entries for name, entries in lists.items() if entries}
        if self._length:
            document["buffers"] = [{"byteLength": self._length}]
        text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = [(b"JSON", text)] + ([(b"BIN\0", b"".join(self._chunks))] if self._length else [])
        total = 12 + sum(8 + len(content) for _, content in chunks)
        folder = os.path.dirname(os.path.abspath(path))
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
            file.write(struct.pack("<4sII", b"glTF", 2, total))
            for kind, content in chunks:
                file.write(struct.pack("<I4s", len(content), kind))
                file.write(content)
        os.replace(file.name, path)
