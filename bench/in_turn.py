"""Rows of a benchmark: a call of impinge and one of another library, made in turn in one run."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import record

Call = Callable[[], Any]


@dataclass
class Row:
    """A call of impinge and one of another library, and a function that compares both answers."""

    name: str
    rival: str
    ours: Call
    theirs: Call
    agree: Callable[[Any, Any], bool]


def same_truth(ours: Any, theirs: Any) -> bool:
    """Report whether both answers are true, or both are false."""
    return bool(ours) == bool(theirs)


def minima(row: Row, budget: float) -> list[float]:
    """Return the minimum seconds of a call of impinge, and of one of the rival, asked in turn."""
    best = [np.inf, np.inf]
    begun, rounds = time.perf_counter(), 0
    while rounds < 3 or time.perf_counter() - begun < budget:
        rounds += 1
        for side, ask in enumerate((row.ours, row.theirs)):
            start = time.perf_counter()
            ask()
            best[side] = min(best[side], time.perf_counter() - start)
    return best


def print_rows(rows: Iterable[Row], budget: float) -> None:
    """Print and record each row, measured for `budget` seconds.

    Raise SystemExit if the two answers of a row differ.
    """
    print("| call | impinge, us | rival | rival, us | impinge / rival |")
    print("|---|---:|---|---:|---:|")
    for row in rows:
        ours, theirs = row.ours(), row.theirs()
        if not row.agree(ours, theirs):
            np.set_printoptions(threshold=10)
            raise SystemExit(f"{row.name}: {ours} and {theirs} differ")
        one, other = minima(row, budget)
        print(f"| {row.name} | {one * 1e6:.2f} | {row.rival} | {other * 1e6:.2f} | {one / other:.2f} |", flush=True)
        for engine, seconds in (("impinge", one), (row.rival, other)):
            record.row(row.name, "call minimum", "s", seconds, engine)
