"""Energies of stacks on contacts of meshes and of convex hulls, as a plot.

    .venv/bin/python bench/stacks.py

A tower, a pyramid and an arch stand for ten seconds in the simulation of `examples/simulation`.
"""

import csv
import tempfile
from collections import defaultdict
from pathlib import Path

import plots
from about import circumstances, output

NOTE = "Energies less those at the start. A block of side 1 has mass 1 and falls with 9.81."

COLOURS = {"Tower": "#4269d0", "Pyramid": "#efb118", "Arch": "#ff725c"}
LINES = {"Hull": ("-", "hulls"), "Mesh(2)": ("--", "meshes")}


def measure(seconds: float) -> tuple[str, list[dict[str, str]]]:
    """Run the simulation, and return what it prints and the rows of energies."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "energies.csv"
        command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-simulation", "--", str(seconds), str(file)]
        printed = output(*command)
        with file.open(newline="") as rows:
            return printed, list(csv.DictReader(rows))


def main() -> None:
    parser = plots.arguments(__doc__, "stacks")
    parser.add_argument("--seconds", type=float, default=10, help="simulated time")
    options = parser.parse_args()
    about = circumstances()
    printed, rows = measure(options.seconds)
    curves = defaultdict(list)
    for row in rows:
        curves[row["stack"], row["material"]].append((float(row["seconds"]), float(row["energy"])))
    axes = plots.blank()
    for (stack, material), points in curves.items():
        line, name = LINES[material]
        axes.plot(*zip(*points, strict=True), line, color=COLOURS[stack], label=f"{stack.lower()} of {name}")
    axes.set_xlabel("seconds")
    axes.set_ylabel("change of energy")
    axes.legend(frameon=False)
    plots.keep(axes, printed, about, NOTE, options.picture)


if __name__ == "__main__":
    main()
