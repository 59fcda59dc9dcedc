"""Scenes for the tests of clusters."""

import impinge
import numpy as np
from shapes import cube, torus

CUBE, TORUS = impinge.Mesh(*cube()), impinge.Mesh(*torus())


def grid_scene(count, seed):
    """Returns a scene of meshes and shapes at half units, so that many touch, and their poses."""
    rng = np.random.default_rng(seed)
    kinds = [
        CUBE,
        TORUS,
        impinge.Shape.sphere(0.5),
        impinge.Shape.half_space([0, 0, 1], -9.0),
        impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
        impinge.Mesh(*cube(-0.25, 0.75)),
    ]
    which = rng.choice(len(kinds), count, p=[0.4, 0.2, 0.15, 0.01, 0.04, 0.2])
    parts = {f"part {at}": kinds[kind] for at, kind in enumerate(which)}
    places = rng.integers(-9, 10, (count, 3)) / 2
    poses = {name: impinge.pose(place) for name, place in zip(parts, places, strict=True) if rng.random() < 0.9}
    ignored = [tuple(rng.choice(list(parts), 2)) for _ in range(count)]
    return impinge.Scene(parts, ignored=ignored, solid=bool(seed % 2)), poses


def row_of(meshes):
    """Returns a scene of meshes that overlap their neighbors, and their poses."""
    poses = {str(at): impinge.pose([at * 1.5, 0, 0]) for at in range(len(meshes))}
    return impinge.Scene({str(at): mesh for at, mesh in enumerate(meshes)}), poses
