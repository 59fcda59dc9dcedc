"""All pairs of boxes that all move: impinge's sweep of columns and parry3d, as a plot.

    .venv/bin/python bench/growth_worlds.py

There are from 1,000 to 10,000,000 boxes, on one thread. Each box overlaps about one other. Sizes
are similar, or spread over a ratio of 1,000. parry3d is skipped if it would need gigabytes.
"""

import json

import plots
import record
from about import circumstances, output
from matplotlib.axes import Axes

SIZES = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000]

SERIES = [
    ("like", "columns", "columns", "#4269d0", "-"),
    ("pareto", "columns", "columns, spread sizes", "#6cc5b0", "-"),
    ("like", "parry", "parry3d", "#ff725c", "-"),
    ("pareto", "parry", "parry3d, spread sizes", "#efb118", "-"),
]
"""Scene, key of the time in a row, label, color and line style."""

Answer = dict[str, list[dict[str, float]]]

NOTE = "One thread, processor time, minimum of the steps. Pairs are compared with those of parry3d if it runs."


def measure(steps: int) -> Answer:
    """Return the minimum seconds of a step for each scene and number of boxes."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "partitions", "--", "--json"]
    return json.loads(output(*command, "--steps", str(steps), "--counts", ",".join(str(size) for size in SIZES)))


def table(answer: Answer) -> str:
    """Return a Markdown table with a row for each scene and number of boxes."""
    lines = ["| sizes | boxes | pairs | columns | a box | parry3d | ratio |", "|" + "---|" * 7]
    for scene, rows in answer.items():
        for row in rows:
            ours, theirs = row["columns"], row["parry"]
            rival = [f"{theirs * 1e3:.3g} ms", f"{ours / theirs:.2f}"] if theirs else ["", ""]
            cells = [
                scene,
                f"{row['boxes']:,}",
                f"{row['pairs']:,}",
                f"{ours * 1e3:.3g} ms",
                f"{ours / row['boxes'] * 1e9:.0f} ns",
            ]
            lines.append("| " + " | ".join(cells + rival) + " |")
    return "\n".join(lines)


def drawn(answer: Answer) -> Axes:
    """Draw the time for each box over the number of boxes."""
    axes = plots.blank()
    for scene, key, label, colour, line in SERIES:
        rows = [row for row in answer[scene] if row[key]]
        boxes, nanoseconds = [row["boxes"] for row in rows], [row[key] / row["boxes"] * 1e9 for row in rows]
        axes.semilogx(boxes, nanoseconds, marker="o", color=colour, linestyle=line)
        axes.annotate(label, (boxes[-1], nanoseconds[-1]), (8, -3), textcoords="offset points", color=colour)
    axes.set_xlabel("boxes, all of which move")
    axes.set_ylabel("nanoseconds a box and step, one thread")
    axes.set_xlim(SIZES[0] * 0.8, SIZES[-1] * 14)
    axes.set_ylim(bottom=0)
    return axes


def write_rows(answer: Answer) -> None:
    """Record the numbers of pairs, and the minimum time of a step of each engine."""
    for scene, rows in answer.items():
        for row in rows:
            case = f"{scene}, {row['boxes']} boxes"
            record.row(case, "pairs", "1", row["pairs"])
            for key, engine in (("columns", "impinge"), ("parry", "parry3d")):
                if row[key]:
                    record.row(case, "step minimum", "s", row[key], engine)


def main() -> None:
    parser = plots.arguments(__doc__, "growth-worlds")
    parser.add_argument("--steps", type=int, default=9, help="steps of 300,000 boxes; the minimum counts")
    options = parser.parse_args()
    about = circumstances()
    answer = measure(options.steps)
    plots.keep(drawn(answer), table(answer), about, NOTE, options.picture)
    write_rows(answer)


if __name__ == "__main__":
    main()
