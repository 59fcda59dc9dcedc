"""All intersecting pairs of FCL and impinge in turn, for machines that change their speed.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/python bench/rivals_in_turns.py

`rivals.py` runs one engine after the other, each for some seconds. If other processes share the
processor and their load changes by the second, its ratios vary. Here a turn is one query of FCL,
and as many queries of impinge as take about half as long, so that both see the same load. Both run
on one thread of one process and are called from Python, FCL through python-fcl; FCL's own share is
timed too. Meshes and poses are those of `rivals.py`, except for poses without intersecting pairs.
The numbers of pairs are compared.
"""

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import fcl
import impinge
import numpy as np
import record
from about import circumstances, print_circumstances
from rivals import NO_LIMIT, SCENES, Pose, Scene, fcl_alone, fcl_query, ratio, seconds, spread

LEAST_TURNS = 5  # minimum number of turns at a pose


@dataclass
class Turns:
    """Times of both engines at one pose, in seconds of single queries.

    `whole` is the time of python-fcl, `own_share` that of FCL alone. `ratios` has one number for
    each turn: the time of python-fcl divided by the median time of impinge.
    """

    pose: str
    pairs: int
    whole: list[float] = field(default_factory=list)
    own_share: list[float] = field(default_factory=list)
    impinge: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)


def fcl_model(scene: Scene) -> fcl.BVHModel:
    """Return the mesh of a scene as a model of python-fcl."""
    vertices, faces = scene.mesh
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(vertices))
    model.addSubModel(vertices, faces)
    model.endModel()
    return model


def world_from_b(pose: Pose) -> np.ndarray:
    """Return a pose as a (4, 4) matrix."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.rotation(), pose.translation
    return matrix


def take_turns(scene: Scene, budget: float) -> list[Turns]:
    """Time both engines for `budget` seconds at each pose that has intersecting pairs.

    Raise a `ValueError` if the engines find different numbers of pairs.
    """
    model, mesh = fcl_model(scene), impinge.Mesh(*scene.mesh)
    taken = []
    for pose in scene.poses:
        query, pairs = fcl_query(model, pose)
        matrix = world_from_b(pose)

        def ours(matrix: np.ndarray = matrix) -> np.ndarray:
            return impinge.intersecting_pairs(mesh, mesh, None, matrix)

        found = len(ours())
        if found != pairs:
            raise ValueError(f"{pose.name}: FCL finds {pairs} pairs, and impinge finds {found}")
        if pairs > 0:
            taken.append(turns_of(Turns(pose.name, pairs), lambda query=query: query(NO_LIMIT), ours, budget))
    return taken


def turns_of(turns: Turns, theirs: Callable[[], None], ours: Callable[[], np.ndarray], budget: float) -> Turns:
    """Add the times of turns until `budget` seconds have passed, and return `turns`."""
    often = max(1, int(seconds(theirs) / seconds(ours) / 2))
    end = time.perf_counter() + budget
    while len(turns.ratios) < LEAST_TURNS or time.perf_counter() < end:
        turns.whole.append(seconds(theirs))
        own = [seconds(ours) for _ in range(often)]
        with fcl_alone():
            turns.own_share.append(seconds(theirs))
        turns.impinge += own
        turns.ratios.append(turns.whole[-1] / statistics.median(own))
    return turns


def table(all_turns: list[Turns]) -> str:
    """Return a Markdown table with a row for each pose."""
    head = "| pose | pairs | turns | impinge, ms | python-fcl, ms | ratio | of a turn | FCL alone, ms | ratio |"
    rows = [head, "|" + "---|" * 9]
    for turns in all_turns:
        quarter, half, three_quarters = statistics.quantiles(turns.ratios, n=4)
        cells = [
            turns.pose,
            str(turns.pairs),
            str(len(turns.ratios)),
            spread(turns.impinge, 1e3),
            spread(turns.whole, 1e3),
            ratio(turns.whole, turns.impinge),
            f"{half:.3g} ({quarter:.3g} to {three_quarters:.3g})",
            spread(turns.own_share, 1e3),
            ratio(turns.own_share, turns.impinge),
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def write_rows(all_turns: list[Turns]) -> None:
    """Record the times of each engine, and the quartiles of the ratios of single turns."""
    for turns in all_turns:
        record.row(turns.pose, "pairs", "1", turns.pairs)
        record.row(turns.pose, "turns", "1", len(turns.ratios))
        record.seconds(turns.pose, "all pairs", turns.impinge)
        record.seconds(turns.pose, "all pairs", turns.whole, "python-fcl")
        quartiles = zip(
            ("lower quartile", "median", "upper quartile"), statistics.quantiles(turns.ratios, n=4), strict=True
        )
        for name, value in quartiles:
            record.row(turns.pose, f"ratio of a turn {name}", "1", value, "python-fcl")
        record.seconds(turns.pose, "all pairs", turns.own_share, "FCL")


def main() -> int:
    """Print the table, and return 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads around its tube")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seconds", type=float, default=20, help="time for each pose, in seconds")
    options = parser.parse_args()

    about = circumstances("python-fcl")
    taken = []
    with impinge.threads(1):
        for name in options.scenes:
            taken += take_turns(SCENES[name](options.nu, options.nv), options.seconds)
    print_circumstances(
        about, "One thread; median (minimum) of the runs, ratios of medians, and of a turn's own (quartiles)."
    )
    print(table(taken))
    write_rows(taken)
    return 0


if __name__ == "__main__":
    sys.exit(main())
