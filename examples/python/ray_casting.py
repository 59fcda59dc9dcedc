"""Rays at a mesh: a picture of depths from many rays in one call, and all faces that one ray hits.

No ray passes between two faces that share an edge.
"""

from pathlib import Path

import impinge
import numpy as np

DATA = Path(__file__).parents[2] / "data"
WIDTH, HEIGHT = 40, 30

human = impinge.load(DATA / "human_makehuman_cc0.ply")
origins = np.zeros((HEIGHT, WIDTH, 3))
origins[..., 0] = (np.arange(WIDTH) - 19.5) / 32
origins[..., 1] = (15.5 - np.arange(HEIGHT)[:, None]) / 16
origins[..., 2] = 2
hits = human.ray_cast(origins, [0, 0, -1])

# Five characters, the darkest for the nearest, draw depths from 1.6 to 2.1.
for row in hits.t:
    shades = ["#*+-."[int((t - 1.6) * 10)] if np.isfinite(t) else " " for t in row]
    print("".join(shades).rstrip())

print(f"{hits.hit.sum()} of {WIDTH * HEIGHT} rays hit the human, at {hits.t.min():.6f} at the nearest")

through = human.ray_cast_all([2, 0.25, 0.0625], [-1, 0, 0])
print(f"a ray from the side hits {len(through.t)} faces")
for t, face in zip(through.t, through.face, strict=True):
    print(f"face {face} at {t:.6f}")
