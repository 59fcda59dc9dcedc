"""The look of a plot, and its file, for the scripts that draw how something grows."""

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
    """Return a parser with the path of the picture of this name."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "images" / f"{name}.png")
    return parser


def blank() -> Axes:
    """Axes without a frame, over a faint grid."""
    _, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
    bare(axes)
    return axes


def bare(axes: Axes) -> None:
    """Take the frame away and lay a faint grid beneath."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)


def keep(axes: Axes, table: str, about: dict[str, str], note: str, picture: Path) -> None:
    """Print the circumstances, a note and a table, and save the figure of these axes."""
    print_circumstances(about, note)
    print(table)
    axes.figure.savefig(picture, dpi=160)
    print(f"drawn in {picture}")
