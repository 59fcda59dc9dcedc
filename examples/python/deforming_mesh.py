"""A mesh that deforms: its vertices move every frame, and its hierarchy is refitted, not rebuilt.

A sheet sinks onto a human and its rim hangs down. `aging` tells how much slower the hierarchy has
become.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"
SIDE = 33  # vertices along each side

human = impinge.load(DATA / "human_makehuman_cc0.ply")
x, z = np.meshgrid(np.arange(SIDE) / 16 - 1, np.arange(SIDE) / 16 - 1)
corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
faces = np.concatenate(
    [
        np.stack([corner, corner + 1, corner + SIDE], axis=1),
        np.stack([corner + 1, corner + SIDE + 1, corner + SIDE], axis=1),
    ]
)


def vertices(frame):
    """Return the vertices of the sheet in a frame."""
    y = 1.25 - frame / 16 - (x * x + z * z) * (frame / 8)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)


sheet = impinge.Mesh(vertices(0), faces)
for frame in range(8):
    sheet.refit(vertices(frame))
    pairs = impinge.intersecting_pairs(sheet, human)
    if len(pairs):
        print(f"frame {frame}: {len(pairs)} pairs of faces intersect")
    else:
        print(f"frame {frame}: {impinge.distance(sheet, human).distance:.6f} apart")

if sheet.aging > 1.5:
    sheet.rebuild()
    print("the hierarchy was built anew")
else:
    print("the hierarchy is as good as new")
