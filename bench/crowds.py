"""Frames of crowds of 100 to 10,000 animated characters, on two threads, as a plot.

In each frame all characters are tested against each other, and 1,000 rays are cast.

    .venv/bin/python bench/crowds.py
"""

import json

import plots
import record
from about import circumstances, output
from matplotlib.axes import Axes

SERIES = [
    ("pose", "posing", "#4269d0", -6),
    ("parts", "pairs of parts", "#ff725c", 4),
    ("sweep", "pairs of characters", "#6cc5b0", -4),
    ("rays", "1,000 rays", "#a463f2", -4),
    ("all", "all", "#1b1e23", -4),
]
"""Key of a phase in a row, its label and color in the plot, and the height of the label above the
end of the line, in points."""

NOTE = "Two threads; minimum of the frames."


def measure(repeats: int) -> list[dict[str, float]]:
    """Run the benchmark program; return a row for each crowd, with the minimum times in seconds."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "characters", "--", "--json"]
    return [json.loads(line) for line in output(*command, "--repeats", str(repeats)).splitlines()]


def table(rows: list[dict[str, float]]) -> str:
    """Return a Markdown table with a row for each crowd."""
    names = [name for _, name, _, _ in SERIES]
    lines = ["| characters | " + " | ".join(names) + " | intersecting pairs of parts |", "|" + "---|" * 7]
    for row in rows:
        cells = [f"{row['characters']:,}", *(f"{row[key] * 1e3:.3g} ms" for key, _, _, _ in SERIES)]
        lines.append("| " + " | ".join([*cells, f"{row['pairs_of_parts']:,}"]) + " |")
    return "\n".join(lines)


def drawn(rows: list[dict[str, float]]) -> Axes:
    """Draw the time of each phase over the number of characters."""
    axes = plots.blank()
    counts = [row["characters"] for row in rows]
    for key, name, colour, above in SERIES:
        milliseconds = [row[key] * 1e3 for row in rows]
        axes.loglog(counts, milliseconds, marker="o", color=colour)
        axes.annotate(name, (counts[-1], milliseconds[-1]), (8, above), textcoords="offset points", color=colour)
    axes.axhline(1e3 / 60, color=plots.GREY, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.annotate("60 frames a second", (counts[0], 1e3 / 60), (0, 4), textcoords="offset points", color=plots.GREY)
    axes.set_xlabel("characters of 20 volumes")
    axes.set_ylabel("milliseconds a frame, two threads")
    axes.set_xlim(counts[0] * 0.8, counts[-1] * 4.0)
    return axes


def write_rows(rows: list[dict[str, float]]) -> None:
    """Record the minimum time of each phase of a frame, and the number of intersecting parts."""
    for row in rows:
        case = f"{row['characters']} characters"
        for key, name, _, _ in SERIES:
            record.row(case, f"{name} minimum", "s", row[key])
        record.row(case, "intersecting pairs of parts", "1", row["pairs_of_parts"])


def main() -> None:
    parser = plots.arguments(__doc__, "crowds")
    parser.add_argument("--repeats", type=int, default=30, help="frames of each crowd; the minimum counts")
    options = parser.parse_args()
    about = circumstances()
    answer = measure(options.repeats)
    plots.keep(drawn(answer), table(answer), about, NOTE, options.picture)
    write_rows(answer)


if __name__ == "__main__":
    main()
