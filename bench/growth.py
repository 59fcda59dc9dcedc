"""Build, refit and all pairs of impinge on torus knots, on one thread, as a plot.

    .venv/bin/python bench/growth.py

The knots have from 10,000 to 8,000,000 triangles. Each is tested against a moved copy, deep in each
other, as in rivals.py. A knot that is twice as fine along and around its tube has four times as
many triangles, and twice as many intersecting pairs along the curves of intersection.
"""

import json

import plots
import record
from about import circumstances, output
from matplotlib.axes import Axes
from rivals import KNOT_POSES

SIZES = [(140, 36), (316, 79), (632, 158), (1412, 354), (2000, 500), (4000, 1000)]
"""Numbers of quads along each knot and around its tube."""

SERIES = [
    ("build_seconds", "build", "#4269d0"),
    ("refit_seconds", "refit", "#6cc5b0"),
    ("all_pairs_seconds", "all pairs", "#ff725c"),
]

NOTE = "One thread; minimum of the runs; two torus knots deep in each other."


def measure(along: int, around: int, repeats: int) -> dict[str, float]:
    """Return the minimum seconds of each phase, and the numbers of pairs and of triangles."""
    pose = KNOT_POSES[0]
    numbers = ",".join(repr(x) for x in (*pose.translation, *pose.quaternion))
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "headline", "--", "--json"]
    size = ["--along", str(along), "--around", str(around), "--repeats", str(repeats)]
    answer = json.loads(output(*command, *size, "--pose-b", numbers, "--threads", "1", "--builder", "morton"))
    least = {key: min(answer[key]) for key, _, _ in SERIES}
    return {"triangles": 2 * along * around, "pairs": answer["pairs"], **least}


def table(rows: list[dict[str, float]]) -> str:
    """Return a Markdown table with a row for each size."""
    lines = ["| triangles | build | a triangle | refit | all pairs | pairs | a pair |", "|" + "---|" * 7]
    for row in rows:
        build, refit, pairs = (row[key] for key, _, _ in SERIES)
        cells = [
            f"{row['triangles']:,}",
            f"{build * 1e3:.3g} ms",
            f"{build / row['triangles'] * 1e9:.0f} ns",
            f"{refit * 1e3:.3g} ms",
            f"{pairs * 1e3:.3g} ms",
            f"{row['pairs']:,}",
            f"{pairs / row['pairs'] * 1e9:.0f} ns",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def drawn(rows: list[dict[str, float]]) -> Axes:
    """Draw the times over the number of triangles, beside linear and square-root growth."""
    axes = plots.blank()
    triangles = [row["triangles"] for row in rows]
    for key, name, colour in SERIES:
        milliseconds = [row[key] * 1e3 for row in rows]
        axes.loglog(triangles, milliseconds, marker="o", color=colour)
        axes.annotate(name, (triangles[-1], milliseconds[-1]), (8, -4), textcoords="offset points", color=colour)
    first = rows[0]
    for key, power, label in [("build_seconds", 1.0, "linear"), ("all_pairs_seconds", 0.5, "square root")]:
        ideal = [first[key] * 1e3 * (n / triangles[0]) ** power for n in triangles]
        axes.loglog(triangles, ideal, color=plots.GREY, linewidth=0.8, linestyle=(0, (4, 3)))
        place = {"textcoords": "offset points", "ha": "right", "color": plots.GREY}
        axes.annotate(label, (triangles[3], ideal[3]), (-14, 8), **place)
    axes.set_xlabel("triangles of each mesh")
    axes.set_ylabel("milliseconds, one thread")
    axes.set_xlim(triangles[0] * 0.8, triangles[-1] * 2.6)
    return axes


def write_rows(rows: list[dict[str, float]]) -> None:
    """Record the minimum time of each phase, and the number of pairs."""
    for row in rows:
        case = f"{row['triangles']} triangles"
        for key, name, _ in SERIES:
            record.row(case, f"{name} minimum", "s", row[key])
        record.row(case, "pairs", "1", row["pairs"])


def main() -> None:
    parser = plots.arguments(__doc__, "growth")
    parser.add_argument("--repeats", type=int, default=9, help="runs of each; the minimum counts")
    options = parser.parse_args()
    about = circumstances()
    answer = [measure(along, around, options.repeats) for along, around in SIZES]
    plots.keep(drawn(answer), table(answer), about, NOTE, options.picture)
    write_rows(answer)


if __name__ == "__main__":
    main()
