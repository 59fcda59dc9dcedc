"""Convex parts cover the solid and keep their bounds; options and errors."""

from __future__ import annotations

import impinge
import numpy as np
import pytest

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def union(*boxes: tuple[list[float], list[float]]) -> impinge.Mesh:
    """Return the mesh of boxes, each from its lower to its upper corner."""
    faces = impinge.convex_hull(CUBE).faces
    corners = [np.array(low) + CUBE * (np.array(high) - low) for low, high in boxes]
    return impinge.Mesh(np.vstack(corners), np.vstack([faces + 8 * at for at in range(len(boxes))]))


CHANNEL = union(([0, 0, 0], [4, 1, 1]), ([0, 0, 0], [1, 4, 1]), ([3, 0, 0], [4, 4, 1]))


def test_the_bars_of_a_channel_are_parts_that_cover_it() -> None:
    parts = CHANNEL.convex_parts(concavity=0.125)
    assert len(parts) == 3
    assert parts.is_within
    assert parts.concavity <= 0.125
    shape = impinge.Shape.of_parts(parts)
    points = np.random.default_rng(1).uniform([-1, -1, -1], [5, 5, 2], (500, 3))
    inside = CHANNEL.contains(points)
    assert 30 < inside.sum() < 450
    point = impinge.Shape.sphere(0)
    poses = impinge.pose(points)
    assert (impinge.intersects(shape, point, pose_b=poses) >= inside).all()


def test_bounds_hold_at_points_of_the_hulls() -> None:
    parts = CHANNEL.convex_parts(concavity=0.5, max_parts=1)
    (part,) = parts.parts
    weights = np.random.default_rng(2).dirichlet(np.full(len(part.vertices), 0.2), 2000)
    distance = np.maximum(CHANNEL.signed_distance(weights @ part.vertices), 0)
    assert 0.5 * part.concavity_upper < distance.max() <= part.concavity_upper * (1 + 1e-9)
    assert part.concavity_lower <= part.concavity_upper


def test_too_few_parts_are_reported() -> None:
    parts = CHANNEL.convex_parts(concavity=0.01, max_parts=2)
    assert len(parts) <= 2
    assert not parts.is_within
    assert parts.concavity > 0.01


def test_a_convex_mesh_is_one_part() -> None:
    parts = union(([0, 0, 0], [1, 2, 3])).convex_parts()
    assert (len(parts), parts.concavity, parts.is_within) == (1, 0.0, True)
    assert parts.parts[0].vertices.tolist() == (CUBE * [1, 2, 3]).tolist()
    assert repr(parts) == "ConvexParts(1 parts, concavity <= 0)"


@pytest.mark.parametrize(
    ("mesh", "options", "kind", "what"),
    [
        (impinge.Mesh(CUBE, [[0, 1, 2]]), {}, "open", "mesh"),
        (impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), {}, "empty", "mesh"),
        (CHANNEL, {"concavity": -1.0}, "negative", "concavity"),
        (CHANNEL, {"concavity": np.inf}, "non-finite", "concavity"),
        (CHANNEL, {"max_parts": 0}, "out-of-range", "max_parts"),
        (CHANNEL, {"max_parts": 1.5}, "type", "max_parts"),
    ],
)
def test_invalid_arguments_are_refused(mesh: impinge.Mesh, options: dict[str, float], kind: str, what: str) -> None:
    with pytest.raises(impinge.InputError) as caught:
        mesh.convex_parts(**options)  # type: ignore[arg-type]
    assert (caught.value.kind, caught.value.what) == (kind, what)
