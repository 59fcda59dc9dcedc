"""How deep two meshes are in each other, as solids."""

from __future__ import annotations

from typing import Any, Literal, Unpack, overload

from impinge import _impinge
from impinge._mesh import Mesh
from impinge._rows import Pose, Raising, Stating, Statuses, beside_status
from impinge._shape_answers import Penetration, penetration_of


@overload
def penetration(a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Raising]) -> Penetration: ...
@overload
def penetration(
    a: Mesh, b: Mesh, pose_a: Pose = None, pose_b: Pose = None, **rows: Unpack[Stating]
) -> tuple[Penetration, Statuses]: ...
def penetration(
    a: Mesh,
    b: Mesh,
    pose_a: Pose = None,
    pose_b: Pose = None,
    *,
    on_error: Literal["raise", "status"] = "raise",
    progress: bool = False,
) -> Any:
    """Return how deep two meshes, taken as solids, are in each other: a short way to take them apart.

    Parameters
    ----------
    a, b : Mesh
        The solids: all about which a mesh winds more than half.
    pose_a, pose_b : (..., 4, 4) array_like of float32 or float64, optional
        World from mesh; None is the identity. Leading axes broadcast as in NumPy.
    on_error : {"raise", "status"}
        As for `intersects`. Nothing is proved about rows with a bad pose: their depth is from zero to infinity.
    progress : bool
        As for `intersects`.

    Returns
    -------
    Penetration
        Moving `b` by `upper` along the normal takes the interiors apart, nothing shorter than `lower` does. Zero where
        they touch or are apart. The shortest way is searched for, as meshes are not convex.

    Raises
    ------
    InputError
        If an argument is none of the above; it says which row and entry.

    Notes
    -----
    `impinge.shapes.penetration` is the same question to any two shapes. It takes some hundred distances a row.

    Examples
    --------
    >>> import impinge
    >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
    >>> solid = impinge.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> deep = impinge.penetration(solid, solid, None, impinge.pose([0, 0, 3.5]))
    >>> bool(deep.lower <= 0.5 / 3**0.5 * (1 + 1e-6) and deep.hit)
    True
    """
    answer = _impinge.penetration((a, b, pose_a, pose_b, on_error, progress))
    return beside_status(answer, on_error, penetration_of)
