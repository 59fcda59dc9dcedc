"""All pairs of 1,000 to 10,000,000 boxes that all move, by impinge's sweep of columns and by parry3d, on one thread, as a plot.

    .venv/bin/python bench/growth_worlds.py

Each box meets about one other; sizes are alike, or spread over a ratio of 1,000. parry3d is left out
where it would take gigabytes.
"""

import argparse
import json
from pathlib import Path

import matplotlib as mpl
from rivals import ROOT, circumstances, output

mpl.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402: the backend is chosen first

SIZES = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000]

SERIES = [
    ("like", "columns", "columns", "#4269d0", "-"),
    ("pareto", "columns", "columns, spread sizes", "#6cc5b0", "-"),
    ("like", "parry", "parry3d", "#ff725c", "-"),
    ("pareto", "parry", "parry3d, spread sizes", "#efb118", "-"),
]
"""Scene, key of the seconds, label, colour, line."""

Answer = dict[str, list[dict[str, float]]]


def measure(steps: int) -> Answer:
    """The least seconds of a step for every scene and number of boxes."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "partitions", "--", "--json"]
    return json.loads(output(*command, "--steps", str(steps), "--counts", ",".join(str(size) for size in SIZES)))


def table(answer: Answer) -> str:
    lines = ["| sizes | boxes | pairs | columns | a box | parry3d | ratio |", "|" + "---|" * 7]
    for scene, rows in answer.items():
        for row in rows:
            ours, theirs = row["columns"], row["parry"]
            rival = [f"{theirs * 1e3:.3g} ms", f"{ours / theirs:.2f}"] if theirs else ["", ""]
            cells = [scene, f"{row['boxes']:,}", f"{row['pairs']:,}", f"{ours * 1e3:.3g} ms", f"{ours / row['boxes'] * 1e9:.0f} ns"]
            lines.append("| " + " | ".join(cells + rival) + " |")
    return "\n".join(lines)


def draw(answer: Answer, path: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    for scene, key, label, colour, line in SERIES:
        rows = [row for row in answer[scene] if row[key]]
        boxes, nanoseconds = [row["boxes"] for row in rows], [row[key] / row["boxes"] * 1e9 for row in rows]
        axes.semilogx(boxes, nanoseconds, marker="o", color=colour, linestyle=line)
        axes.annotate(label, (boxes[-1], nanoseconds[-1]), (8, -3), textcoords="offset points", color=colour)
    axes.set_xlabel("boxes, all of which move")
    axes.set_ylabel("nanoseconds a box and step, one thread")
    axes.set_xlim(SIZES[0] * 0.8, SIZES[-1] * 14)
    axes.set_ylim(bottom=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    figure.savefig(path, dpi=160)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=9, help="steps of 300,000 boxes, of which the least counts")
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "growth-worlds.png")
    parser.add_argument("--record", type=Path, default=ROOT / "bench" / "record", help="folder of the dated records")
    options = parser.parse_args()

    mpl.rcParams.update({"font.size": 9, "axes.edgecolor": "#9498a0", "xtick.color": "#55585f", "ytick.color": "#55585f"})
    about = circumstances()
    answer = measure(options.steps)
    found = table(answer)
    print(found)
    draw(answer, options.picture)
    record = options.record / f"{about['date']}-growth-worlds.md"
    lines = [f"# How all pairs of moving boxes grow, {about['date']}", ""]
    lines += [f"- {name}: `{value}`" for name, value in about.items() if name != "date"]
    lines += ["", "One thread, processor time, the least of the steps; pairs compared with parry3d's where that runs.", ""]
    record.write_text("\n".join([*lines, found]) + "\n")
    print(f"recorded in {record}, drawn in {options.picture}")


if __name__ == "__main__":
    main()
