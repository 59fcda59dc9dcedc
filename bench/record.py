"""Rows of a record: the numbers that a benchmark measured, for `cargo xtask bench NAME`.

That command sets the environment variable IMPINGE_RECORD to the path of a file, and adds the date,
the commit and the command to the rows that the benchmark appends to it. A benchmark that runs
without the variable records nothing.

A row has a case (a scene, pose or size), an engine (a library), a quantity, its unit (`s`, `%`, or
`1` for counts and other plain numbers) and its value. No two rows of a run share all of case,
engine and quantity.
"""

import csv
import os
import statistics
from collections.abc import Iterable
from pathlib import Path

# The variable is removed from the environment, so that programs run by a script record nothing.
_ROWS = os.environ.pop("IMPINGE_RECORD", None)


def row(case: str, quantity: str, unit: str, value: float, engine: str = "impinge") -> None:
    """Append a row to the record, if the benchmark is recorded."""
    if _ROWS is None:
        return
    with Path(_ROWS).open("a", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerow([case, engine, quantity, unit, repr(float(value))])


def seconds(case: str, quantity: str, runs: Iterable[float], engine: str = "impinge") -> None:
    """Append the median and the minimum of `runs`, the seconds of single runs."""
    runs = list(runs)
    row(case, f"{quantity} median", "s", statistics.median(runs), engine)
    row(case, f"{quantity} minimum", "s", min(runs), engine)
