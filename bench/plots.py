"""Style and files of the plots that benchmarks draw."""

import argparse
from pathlib import Path

import matplotlib as mpl
from about import ROOT, print_circumstances
from matplotlib.axes import Axes

mpl.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 the backend is chosen first

GREY = "#9498a0"

mpl.rcParams.update({"font.size": 9, "axes.edgecolor": GREY, "xtick.color": "#55585f", "ytick.color": "#55585f"})


def arguments(about: str | None, name: str) -> argparse.ArgumentParser:
    """Return a parser with an option for the path of the picture; `name` gives the default."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "images" / f"{name}.png")
    return parser


def blank() -> Axes:
    """Return axes with a faint grid, and without a frame above and on the right."""
    _, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    bare(axes)
    return axes


def bare(axes: Axes) -> None:
    """Remove the frame above and on the right, and draw a faint grid below the content."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)


def keep(axes: Axes, table: str, about: dict[str, str], note: str, picture: Path) -> None:
    """Print the circumstances, a note and a table, and save the figure of the axes to `picture`."""
    print_circumstances(about, note)
    print(table)
    axes.figure.savefig(picture, dpi=160)
    print(f"drawn in {picture}")
