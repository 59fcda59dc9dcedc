"""The picture of docs/tasks/convex-parts.md: the human, and the hulls of its convex parts.

    python3 -m venv .venv && .venv/bin/pip install numpy pillow
    cargo build --release -p impinge-cli
    .venv/bin/python docs/images/convex_parts.py target/release/impinge

The command writes the hulls; the rest is the z-buffer of picture.py. The script writes
docs/images/convex-parts.png.
"""

import colorsys
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from picture import HUMAN, ROOT, SKIN, Canvas, read_human, view

SIZE = 0.69  # of the human in the picture, relative to picture.py
ASIDE, RISE = 0.41, 0.19  # meters from the middle of the picture to the middle of each figure
GOLDEN_RATIO = 0.618034  # of a turn between the hues of two parts, so that neighbors differ


def read_hulls(path: Path) -> list[np.ndarray]:
    """Returns the corners of the triangles of each object, (n, 3, 3)."""
    vertices: list[list[float]] = []
    hulls: list[list[list[int]]] = []
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "o":
            hulls.append([])
        elif word == "v":
            vertices.append([float(x) for x in rest])
        elif word == "f":
            hulls[-1].append([int(i) - 1 for i in rest])
    return [np.array(vertices)[faces] for faces in hulls]


def placed(points: np.ndarray, aside: float) -> np.ndarray:
    """Returns points in the frame of the camera, small and to one side."""
    return view(points) * SIZE + [aside, RISE, 0]


def draw(hulls: list[np.ndarray], path: Path) -> None:
    """Draws the human on the left, and the hulls on the right, each face flat."""
    canvas = Canvas()
    human, faces = read_human()
    canvas.mesh(placed(human, -ASIDE), faces, SKIN)
    for number, corners in enumerate(hulls):
        color = 225 * np.array(colorsys.hsv_to_rgb(number * GOLDEN_RATIO % 1, 0.5, 1))
        own = np.arange(3 * len(corners)).reshape(-1, 3)  # no corner is shared, so no normal is smooth
        canvas.mesh(placed(corners.reshape(-1, 3), ASIDE), own, color)
    canvas.save(path)


def main() -> None:
    command = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([command, "decompose", HUMAN, "-o", "parts.obj"], cwd=folder, check=True)
        draw(read_hulls(Path(folder) / "parts.obj"), ROOT / "docs" / "images" / "convex-parts.png")


if __name__ == "__main__":
    main()
