"""Frames of crowds of 100 to 10,000 animated characters, all against all, and 1,000 rays, on two threads, as a plot.

    .venv/bin/python bench/crowds.py
"""

import argparse
import json
from pathlib import Path

import matplotlib as mpl
from rivals import ROOT, circumstances, output

mpl.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402: the backend is chosen first

SERIES = [
    ("pose", "posing", "#4269d0"),
    ("parts", "pairs of parts", "#ff725c"),
    ("sweep", "pairs of characters", "#6cc5b0"),
    ("rays", "1,000 rays", "#a463f2"),
    ("all", "all", "#1b1e23"),
]


def measure(repeats: int) -> list[dict[str, float]]:
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "characters", "--", "--json"]
    return [json.loads(line) for line in output(*command, "--repeats", str(repeats)).splitlines()]


def table(rows: list[dict[str, float]]) -> str:
    names = [name for _, name, _ in SERIES]
    lines = ["| characters | " + " | ".join(names) + " | pairs of parts that meet |", "|" + "---|" * 7]
    for row in rows:
        cells = [f"{row['characters']:,}", *(f"{row[key] * 1e3:.3g} ms" for key, _, _ in SERIES)]
        lines.append("| " + " | ".join([*cells, f"{row['pairs_of_parts']:,}"]) + " |")
    return "\n".join(lines)


def draw(rows: list[dict[str, float]], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    counts = [row["characters"] for row in rows]
    for key, name, colour in SERIES:
        milliseconds = [row[key] * 1e3 for row in rows]
        axes.loglog(counts, milliseconds, marker="o", color=colour)
        axes.annotate(name, (counts[-1], milliseconds[-1]), (8, -4), textcoords="offset points", color=colour)
    axes.axhline(1e3 / 60, color="#9498a0", linewidth=0.8, linestyle=(0, (4, 3)))
    axes.annotate("60 frames a second", (counts[0], 1e3 / 60), (0, 4), textcoords="offset points", color="#9498a0")
    axes.set_xlabel("characters of 20 volumes")
    axes.set_ylabel("milliseconds a frame, two threads")
    axes.set_xlim(counts[0] * 0.8, counts[-1] * 4.0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    figure.savefig(path, dpi=160)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=30, help="frames of each crowd, of which the least counts")
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "crowds.png")
    parser.add_argument("--record", type=Path, default=ROOT / "bench" / "record", help="folder of the dated records")
    options = parser.parse_args()

    mpl.rcParams.update({"font.size": 9, "axes.edgecolor": "#9498a0", "xtick.color": "#55585f", "ytick.color": "#55585f"})
    about = circumstances()
    rows = measure(options.repeats)
    found = table(rows)
    print(found)
    draw(rows, options.picture)
    record = options.record / f"{about['date']}-crowds.md"
    lines = [f"# Crowds of characters, {about['date']}", ""]
    lines += [f"- {name}: `{value}`" for name, value in about.items() if name != "date"]
    lines += ["", "Two threads; the least of the frames.", ""]
    record.write_text("\n".join([*lines, found]) + "\n")
    print(f"recorded in {record}, drawn in {options.picture}")


if __name__ == "__main__":
    main()
