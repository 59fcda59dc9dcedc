"""Details of the parts of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Details:
    """Key, type, path and further properties of a part of a scene. No check reads them.

    Attributes
    ----------
    key : str
        Identity of the part, which stays the same if the file changes elsewhere, for example an IFC
        GlobalId. `load_scene` gives every part a key that no other part has.
    type : str
        Type of the part, for example ``"IfcWall"``.
    path : tuple of str
        Names of the groups that contain the part, the outermost first.
    extras : dict of str to str
        Further properties of the part, as text.

    Examples
    --------
    >>> import impinge
    >>> wall = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> details = impinge.Details(key="2O2Fr$t4X7Zf8NOew3FNr2", type="IfcWall", path=("ground floor",))
    >>> impinge.Scene({"wall": wall}, details={"wall": details}).details("wall").type
    'IfcWall'
    """

    key: str = ""
    type: str = ""
    path: tuple[str, ...] = ()
    extras: Mapping[str, str] = field(default_factory=dict, hash=False)
