"""Tables that notebooks show."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SHOWN = 10
"""Maximum number of rows of a table. The caption has the number of all rows."""


def table(caption: str, columns: Mapping[str, NDArray[Any]]) -> str:
    """Return the first rows of some columns as HTML. A row of a column may have several numbers."""
    shown = {name: column[:_SHOWN] for name, column in columns.items()}
    head = "".join(f"<th>{html.escape(name)}</th>" for name in ("", *shown))
    rows = zip(*shown.values(), strict=True)
    body = "".join(
        f"<tr><th>{at}</th>{''.join(f'<td>{html.escape(_text(value))}</td>' for value in row)}</tr>"
        for at, row in enumerate(rows)
    )
    return (
        f"<table><caption>{html.escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def _text(value: Any) -> str:
    return ", ".join(f"{number:.6g}" for number in np.atleast_1d(value).tolist())
