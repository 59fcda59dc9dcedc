"""Aging of a mesh's tree under animations, and the cost of queries, on one thread, as a plot.

    IMPINGE_DATA=... .venv/bin/python bench/animation.py

The animations are a knot that is twisted by 0.1 radians more in each frame, and two recorded
animations. Three methods follow each: refits only; refits with a watch, which rebuilds subtrees
that have aged; and a new build in each frame. In each frame, all three find all pairs with the mesh
of the first frame, and the answers must be equal.
"""

import itertools
import json
import statistics

import plots
import record
from about import circumstances, output
from matplotlib.axes import Axes
from plots import plt

WAYS = [
    ("refitted", "refits alone", "#ff725c", 3.0),
    ("watched", "refits with the watch", "#4269d0", 1.4),
    ("rebuilt", "a build each frame", "#6cc5b0", 1.0),
]
"""Key, label, color and line width of each method. If two lines coincide, the wider one shows."""

NAMES = {
    "twist": "twisted knot, 199,712 triangles",
    "anim_robot_cc0.npz": "robot, 3,238 triangles",
    "anim_makehuman_morph.npz": "human, 26,756 triangles",
}
"""Heading of the column for each animation of the program."""

NOTE = (
    "One thread. Queries: minimum of the runs. Updates: median over the frames, timed once in each. "
    "The cost is relative to that of a new tree, by the surface area heuristic."
)

Rows = list[dict]


def measure(repeats: int) -> dict[str, Rows]:
    """Run the benchmark program, and return the frames of each animation, by its name."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "refit", "--", "--json"]
    rows = [json.loads(line) for line in output(*command, "--repeats", str(repeats)).splitlines()]
    return {name: list(frames) for name, frames in itertools.groupby(rows, lambda row: row["animation"])}


def relative_cost(row: dict, way: str) -> float:
    """Return the cost of a method's tree in a frame, divided by that of a new tree."""
    return row[way]["cost"] / row["rebuilt"]["cost"]


def table(animations: dict[str, Rows]) -> str:
    """Return a Markdown table with a row for each animation and method."""
    heads = ["animation", "frames", "way", "greatest cost", "update", "query", "both", "frames with rebuilds"]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    for name, rows in animations.items():
        for way, label, _, _ in WAYS:
            update, query = (
                statistics.median(row[way][f"{key}_seconds"] * 1e3 for row in rows) for key in ("update", "query")
            )
            rebuilds = frames_with_rebuilds(rows, way)
            cost = max(relative_cost(row, way) for row in rows)
            cells = [
                NAMES[name],
                str(len(rows)),
                label,
                f"{cost:.2f}",
                *(f"{x:.3g} ms" for x in (update, query, update + query)),
            ]
            lines.append("| " + " | ".join([*cells, str(rebuilds)]) + " |")
    return "\n".join(lines)


def drawn(animations: dict[str, Rows]) -> Axes:
    """Draw a column for each animation: above the cost of the tree, below the time of a query."""
    figure, grid = plt.subplots(2, len(animations), figsize=(9.2, 4.6), sharex="col", layout="constrained")
    highest = max(relative_cost(row, "refitted") for rows in animations.values() for row in rows)
    for (above, below), (name, rows) in zip(grid.T, animations.items(), strict=True):
        for axes in (above, below):
            plots.bare(axes)
        frames = [row["frame"] for row in rows]
        for way, label, colour, width in WAYS:
            above.plot(frames, [relative_cost(row, way) for row in rows], color=colour, linewidth=width, label=label)
            below.plot(frames, [row[way]["query_seconds"] * 1e3 for row in rows], color=colour, linewidth=width)
        above.set_title(NAMES[name], fontsize=9)
        above.set_ylim(0.8, highest * 1.05)
        below.set_ylim(bottom=0)
        below.set_xlabel("frame")
        for number in (row["frame"] for row in rows if row["faces_rebuilt"]):
            above.axvline(number, color=plots.GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0)
    grid[0, 0].set_ylabel("cost of the tree,\nin that of a new one")
    grid[1, 0].set_ylabel("all pairs, milliseconds")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=len(WAYS), frameon=False)
    return grid[0, 0]


def write_rows(animations: dict[str, Rows]) -> None:
    """Record the greatest cost, and the median times of updates and queries, for each method."""
    for name, rows in animations.items():
        for way, label, _, _ in WAYS:
            case = f"{NAMES[name]}: {label}"
            record.row(case, "frames", "1", len(rows))
            record.row(case, "greatest cost", "1", max(relative_cost(row, way) for row in rows))
            for key in ("update", "query"):
                median = statistics.median(row[way][f"{key}_seconds"] for row in rows)
                record.row(case, f"{key} median", "s", median)
            record.row(case, "frames with rebuilds", "1", frames_with_rebuilds(rows, way))


def frames_with_rebuilds(rows: Rows, way: str) -> int:
    """Return the number of frames in which a method rebuilds a part of the tree."""
    watched = sum(row["faces_rebuilt"] > 0 for row in rows)
    return {"refitted": 0, "watched": watched, "rebuilt": len(rows)}[way]


def main() -> None:
    parser = plots.arguments(__doc__, "animation")
    parser.add_argument("--repeats", type=int, default=9, help="runs of each query; the minimum counts")
    options = parser.parse_args()
    about = circumstances()
    animations = measure(options.repeats)
    plots.keep(drawn(animations), table(animations), about, NOTE, options.picture)
    write_rows(animations)


if __name__ == "__main__":
    main()
