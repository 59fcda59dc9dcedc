"""A small rasteriser: triangles and cords with depth, many at once in NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_LIGHTS = [((-0.5, 0.7, 0.8), 0.72), ((0.9, 0.2, 0.4), 0.25), ((0.0, -0.5, 0.6), 0.08)]
"""Directions towards the lights, in the camera's frame, and their strengths."""

_AMBIENT = 0.25
_CHUNK = 1 << 21  # pixels that are looked at together: some 200 MB of scratch


class Canvas:
    """Colour and depth of (height, width) pixels; z towards the viewer."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        fade = np.linspace(0.0, 1.0, height)[:, None, None]
        paper = np.array([250.0, 250.0, 250.0]) * (1 - fade) + np.array([226.0, 229.0, 233.0]) * fade
        self.colour: Floats = np.broadcast_to(paper, (height, width, 3)).reshape(-1, 3).copy()
        self.depth: Floats = np.full(height * width, -np.inf)

    def triangles(self, corners: Floats, colours: Floats) -> None:
        """Draw (n, 3, 3) triangles, x and y in pixels, each in its own colour, lit from both sides alike."""
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        across[:, 1] *= -1  # y runs down in pixels
        colours = shade(across, colours)
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
                self._fill(corners[part], colours[part], low[part], edge)
            edge *= 2

    def _fill(self, p: Floats, colours: Floats, low: NDArray[np.int64], edge: int) -> None:
        """Triangles within boxes of one size."""
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
        self._put(place, depth[inside], colours[which])

    def cord(self, points: Floats, radius: float, colour: Floats) -> None:
        """Draw a round cord along (n, 3) points, in front of surfaces that it lies on."""
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
        colours = shade(np.stack([dx, -dy, rise], axis=-1), np.broadcast_to(colour, (len(dx), 3)), ambient=0.6)
        for start in range(0, len(at), step := max(1, _CHUNK // len(dx))):
            part = at[start : start + step]
            x, y = (part[:, k, None].astype(int) + d for k, d in ((0, dx), (1, dy)))
            kept = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
            depth = part[:, 2, None] + 2 * radius + rise
            self._put((y * self.width + x)[kept], depth[kept], np.broadcast_to(colours, (*x.shape, 3))[kept])

    def veil(self, front: Canvas, opacity: float) -> None:
        """Lay another canvas over this one, see-through, where it is nearer."""
        nearer = front.depth > self.depth
        self.colour[nearer] = opacity * front.colour[nearer] + (1 - opacity) * self.colour[nearer]
        self.depth[nearer] = front.depth[nearer]

    def pixels(self, samples: int) -> NDArray[np.uint8]:
        """Return (height / samples, width / samples, 3) colours, means of `samples` squared."""
        size = (self.height // samples, samples, self.width // samples, samples, 3)
        means: Floats = self.colour.reshape(size).mean(axis=(1, 3))
        return np.clip(means, 0, 255).astype(np.uint8)

    def _put(self, place: NDArray[np.int64], depth: Floats, colours: Floats) -> None:
        nearer = np.flatnonzero(depth > self.depth[place])
        order = nearer[np.argsort(depth[nearer], kind="stable")]  # where places repeat, the last one stays
        self.depth[place[order]] = depth[order]
        self.colour[place[order]] = colours[order]


def shade(normals: Floats, colours: Floats, ambient: float = _AMBIENT) -> Floats:
    """Lambert's law for (n, 3) normals of any length, turned to the viewer."""
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals = np.where(normals[:, 2:] < 0, -normals, normals)
    light = np.full(len(normals), ambient)
    for direction, strength in _LIGHTS:
        light += strength * np.maximum(normals @ (np.array(direction) / np.linalg.norm(direction)), 0)
    lit: Floats = colours * np.minimum(light, 1.1)[:, None]
    return lit
