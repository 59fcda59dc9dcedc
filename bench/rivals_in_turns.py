"""All intersecting pairs of FCL and impinge in turns, in one process, one thread: for machines that change their pace.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/python bench/rivals_in_turns.py

`rivals.py` asks one engine after the other, each for some seconds. Where others share the processor and come and go by
the second, its ratios tell whom they met. Here a turn is one query of FCL and as many of impinge as take about half as
long, so that both meet the same moments; both are called from Python, FCL through python-fcl, whose share of FCL alone
is asked for too. Meshes and poses are those of `rivals.py`, but for those at which nothing meets. The numbers of pairs
are compared.
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

LEAST_TURNS = 5


@dataclass
class Turns:
    """What both engines took at one pose; the lists hold the seconds of single queries, `ratios` one number a turn."""

    pose: str
    pairs: int
    whole: list[float] = field(default_factory=list)
    own_share: list[float] = field(default_factory=list)
    impinge: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)


def fcl_model(scene: Scene) -> fcl.BVHModel:
    vertices, faces = scene.mesh
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(vertices))
    model.addSubModel(vertices, faces)
    model.endModel()
    return model


def world_from_b(pose: Pose) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.rotation(), pose.translation
    return matrix


def take_turns(scene: Scene, budget: float) -> list[Turns]:
    """At each pose at which something meets, for `budget` seconds.

    Raises ValueError where the engines find different numbers of pairs.
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
            raise ValueError(f"{pose.name}: FCL finds {pairs} pairs where impinge finds {found}")
        if pairs > 0:
            taken.append(turns_of(Turns(pose.name, pairs), lambda query=query: query(NO_LIMIT), ours, budget))
    return taken


def turns_of(turns: Turns, theirs: Callable[[], None], ours: Callable[[], np.ndarray], budget: float) -> Turns:
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads round its tube")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seconds", type=float, default=20, help="for each pose")
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
