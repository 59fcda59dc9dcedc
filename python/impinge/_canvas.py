"""A small rasterizer with a depth buffer, for triangles and tubes, vectorized in NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_LIGHTS = [((-0.5, 0.7, 0.8), 0.72), ((0.9, 0.2, 0.4), 0.25), ((0.0, -0.5, 0.6), 0.08)]
"""Directions towards the lights in the camera frame, and their intensities."""

_AMBIENT = 0.25
_CHUNK = 1 << 21  # maximum number of pixels processed together; they take about 200 MB of memory


class Canvas:
    """An image of (height, width) pixels with a depth buffer; z points towards the viewer.

    Attributes
    ----------
    width, height : int
        Size in pixels.
    color : (height * width, 3) float64 array
        Red, green and blue of the pixels, row by row from the top; 0 to 255.
    depth : (height * width,) float64 array
        The z of the nearest surface at each pixel; -inf if there is none.
    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        fade = np.linspace(0.0, 1.0, height)[:, None, None]
        paper = np.array([250.0, 250.0, 250.0]) * (1 - fade) + np.array([226.0, 229.0, 233.0]) * fade
        self.color: Floats = np.broadcast_to(paper, (height, width, 3)).reshape(-1, 3).copy()
        self.depth: Floats = np.full(height * width, -np.inf)

    def triangles(self, corners: Floats, colors: Floats) -> None:
        """Draw (n, 3, 3) triangles, each with its own color of three numbers from 0 to 255.

        Corners are x and y in pixels, from the upper left corner, and z towards the viewer. Both
        sides of a triangle are lit in the same way.
        """
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        across[:, 1] *= -1  # y runs down in pixels
        colors = shade(across, colors)
        low = np.floor(corners[:, :, :2].min(axis=1)).astype(np.int64)
        high = np.ceil(corners[:, :, :2].max(axis=1)).astype(np.int64)
        low, high = np.maximum(low, 0), np.minimum(high, [self.width, self.height])
        sizes = (high - low).max(axis=1, initial=0)
        seen = (high > low).all(axis=1)
        edge = 1
        while edge < 2 * max(self.width, self.height):
            chosen = np.flatnonzero(seen & (sizes > edge // 2) & (sizes <= edge))
            step = max(1, _CHUNK // (edge * edge))
            for start in range(0, len(chosen), step):
                part = chosen[start : start + step]
                self._fill(corners[part], colors[part], low[part], edge)
            edge *= 2

    def _fill(self, p: Floats, colors: Floats, low: NDArray[np.int64], edge: int) -> None:
        """Draw triangles whose boxes fit into squares of `edge` pixels."""
        steps = np.arange(edge)
        x, y = low[:, 0, None, None] + steps, low[:, 1, None, None] + steps[:, None]
        across = p[:, :, :2] - p[:, :1, :2]
        area = across[:, 1, 0] * across[:, 2, 1] - across[:, 2, 0] * across[:, 1, 1]
        flat = area == 0
        dx, dy = x + 0.5 - p[:, 0, 0, None, None], y + 0.5 - p[:, 0, 1, None, None]
        scale = (1 / np.where(flat, 1, area))[:, None, None]
        b = (dx * across[:, 2, 1, None, None] - dy * across[:, 2, 0, None, None]) * scale
        c = (dy * across[:, 1, 0, None, None] - dx * across[:, 1, 1, None, None]) * scale
        z = p[:, :, 2]
        depth = z[:, 0, None, None] + b * (z[:, 1] - z[:, 0])[:, None, None] + c * (z[:, 2] - z[:, 0])[:, None, None]
        inside = (b >= 0) & (c >= 0) & (b + c <= 1) & (x < self.width) & (y < self.height) & ~flat[:, None, None]
        which, row, column = np.nonzero(inside)
        place = (low[which, 1] + row) * self.width + low[which, 0] + column
        self._put(place, depth[inside], colors[which])

    def tube(self, points: Floats, radius: float, color: Floats) -> None:
        """Draw a round tube along (n, 3) points, in front of the surfaces that it lies on.

        Points are as for `triangles`; the radius is in pixels.
        """
        lengths = np.hypot(*np.diff(points[:, :2], axis=0).T)
        counts = np.maximum(np.ceil(1.5 * lengths), 1).astype(int)
        share = [np.arange(count) / count for count in counts]
        at = np.concatenate(
            [*(a + t[:, None] * (b - a) for a, b, t in zip(points, points[1:], share, strict=False)), points[-1:]]
        )
        reach = int(np.ceil(radius))
        dx, dy = (d.ravel() for d in np.meshgrid(*[np.arange(-reach, reach + 1)] * 2))
        disc = dx * dx + dy * dy <= radius * radius
        dx, dy = dx[disc], dy[disc]
        rise = np.sqrt(radius * radius - dx * dx - dy * dy)
        colors = shade(np.stack([dx, -dy, rise], axis=-1), np.broadcast_to(color, (len(dx), 3)), ambient=0.6)
        for start in range(0, len(at), step := max(1, _CHUNK // len(dx))):
            part = at[start : start + step]
            x, y = (part[:, k, None].astype(int) + d for k, d in ((0, dx), (1, dy)))
            kept = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
            depth = part[:, 2, None] + 2 * radius + rise
            self._put((y * self.width + x)[kept], depth[kept], np.broadcast_to(colors, (*x.shape, 3))[kept])

    def blend(self, other: Canvas, opacity: float) -> None:
        """Blend another canvas of the same size over this one, at the pixels at which it is nearer.

        An opacity of 1 replaces the color, 0 keeps it.
        """
        nearer = other.depth > self.depth
        self.color[nearer] = opacity * other.color[nearer] + (1 - opacity) * self.color[nearer]
        self.depth[nearer] = other.depth[nearer]

    def pixels(self, samples: int) -> NDArray[np.uint8]:
        """Return the image reduced by `samples` in both directions, each pixel a mean of samples^2.

        Colors are (height // samples, width // samples, 3), from 0 to 255. Both sizes must be
        multiples of `samples`.
        """
        size = (self.height // samples, samples, self.width // samples, samples, 3)
        means: Floats = self.color.reshape(size).mean(axis=(1, 3))
        return np.clip(means, 0, 255).astype(np.uint8)

    def _put(self, place: NDArray[np.int64], depth: Floats, colors: Floats) -> None:
        nearer = np.flatnonzero(depth > self.depth[place])
        order = nearer[np.argsort(depth[nearer], kind="stable")]  # the last write to a repeated pixel remains
        self.depth[place[order]] = depth[order]
        self.color[place[order]] = colors[order]


def shade(normals: Floats, colors: Floats, ambient: float = _AMBIENT) -> Floats:
    """Return colors lit by Lambert's law, for (n, 3) normals of any length in the camera frame.

    Normals that point away from the viewer are reversed.
    """
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals = np.where(normals[:, 2:] < 0, -normals, normals)
    light = np.full(len(normals), ambient)
    for direction, strength in _LIGHTS:
        light += strength * np.maximum(normals @ (np.array(direction) / np.linalg.norm(direction)), 0)
    lit: Floats = colors * np.minimum(light, 1.1)[:, None]
    return lit
