"""What the scripts that draw how something grows share: the look of a plot, and a dated record of what was measured."""

import argparse
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from rivals import ROOT

mpl.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 the backend is chosen first

GREY = "#9498a0"

mpl.rcParams.update({"font.size": 9, "axes.edgecolor": GREY, "xtick.color": "#55585f", "ytick.color": "#55585f"})


def arguments(about: str | None, name: str) -> argparse.ArgumentParser:
    """A parser that knows where the picture and the record of this name go."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "images" / f"{name}.png")
    parser.add_argument("--record", type=Path, default=ROOT / "bench" / "record", help="folder of the dated records")
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


def keep(
    axes: Axes, table: str, about: dict[str, str], options: argparse.Namespace, titles: tuple[str, str, str]
) -> None:
    """Print a table, save the figure of these axes, and record it with the circumstances before it; the titles are the record's name, its head and a note."""
    name, title, note = titles
    print(table)
    axes.figure.savefig(options.picture, dpi=160)
    record = options.record / f"{about['date']}-{name}.md"
    lines = [f"# {title}, {about['date']}", ""]
    lines += [f"- {key}: `{value}`" for key, value in about.items() if key != "date"]
    record.write_text("\n".join([*lines, "", note, "", table]) + "\n")
    print(f"recorded in {record}, drawn in {options.picture}")
