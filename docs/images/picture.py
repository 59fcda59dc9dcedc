"""The picture of the README: the human, a torus knot about it, and the curves in which they meet.

    python3 -m venv .venv && .venv/bin/pip install numpy pillow
    cargo build --release -p impinge-cli
    .venv/bin/python docs/images/picture.py target/release/impinge

The command writes the curves. The rest is a small z-buffer with smooth shading. The script writes
docs/images/picture.png.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench"))
from torus_knot import torus_knot, write_ply  # noqa: E402

HUMAN = ROOT / "data" / "human_makehuman_cc0.ply"
POSE = ROOT / "data" / "torus_knot_on_human.txt"

WIDTH, HEIGHT = 960, 760  # pixels of the picture
SAMPLES = 3  # rendered pixels for one of the picture, along each side
SKIN, TUBE, CURVE = np.array([201, 185, 170]), np.array([92, 132, 176]), np.array([255, 84, 20])
PAPER_TOP, PAPER_BOTTOM = np.array([250, 250, 250]), np.array([226, 229, 233])
LIGHTS = [((-0.5, 0.7, 0.8), 0.75), ((0.9, 0.15, 0.4), 0.28), ((0.0, -0.4, -1.0), 0.1)]  # towards each, its strength
AMBIENT = 0.22
GLASS = 0.5  # share of the knot's colour in what is seen through it
YAW, PITCH = -0.45, 0.34  # rad: the camera walks round the human, then climbs
CENTER = np.array([0.0, 0.27, 0.0])  # the point in the middle of the picture, meters
PIXELS_PER_METRE = 555
CURVE_RADIUS = 0.005  # meters
NUDGE = 0.006  # meters by which a curve is drawn in front of the surfaces that it lies on


def read_human() -> tuple[np.ndarray, np.ndarray]:
    """Returns (n, 3) vertices in meters, y up, and (m, 3) faces."""
    data = HUMAN.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    counts = [int(line.split()[2]) for line in data[:end].decode().splitlines() if line.startswith("element")]
    vertices = np.frombuffer(data, "<f4", 3 * counts[0], end).reshape(-1, 3).astype(float)
    rows = np.frombuffer(data, [("count", "u1"), ("corners", "<i4", 3)], counts[1], end + 12 * counts[0])
    return vertices, rows["corners"]


def read_curves(path: Path) -> list[np.ndarray]:
    vertices, lines = [], []
    for line in path.read_text().splitlines():
        word, *rest = line.split()
        if word == "v":
            vertices.append([float(x) for x in rest])
        elif word == "l":
            lines.append([int(i) - 1 for i in rest])
    return [np.array(vertices)[line] for line in lines]


def view(points: np.ndarray) -> np.ndarray:
    """World to camera: x right, y up, z towards the viewer."""
    (cy, sy), (cp, sp) = (np.cos(YAW), np.sin(YAW)), (np.cos(PITCH), np.sin(PITCH))
    turn = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    climb = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    return (points - CENTER) @ (climb @ turn).T


class Canvas:
    """Colour and depth, in rendered pixels; orthographic."""

    def __init__(self) -> None:
        self.width, self.height = WIDTH * SAMPLES, HEIGHT * SAMPLES
        self.scale = PIXELS_PER_METRE * SAMPLES
        rows = np.linspace(0, 1, self.height)[:, None, None]
        self.colour = np.broadcast_to(PAPER_TOP * (1 - rows) + PAPER_BOTTOM * rows, (self.height, self.width, 3)).copy()
        self.depth = np.full((self.height, self.width), -np.inf)

    def to_pixels(self, points: np.ndarray) -> np.ndarray:
        middle = np.array([self.width / 2, self.height / 2, 0.0])
        return middle + points * [self.scale, -self.scale, 1.0]

    def mesh(self, vertices: np.ndarray, faces: np.ndarray, colour: np.ndarray) -> None:
        corners = vertices[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.zeros_like(vertices)
        for k in range(3):
            np.add.at(normals, faces[:, k], across)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        pixels = self.to_pixels(vertices)
        for face in faces:
            self.triangle(pixels[face], normals[face], colour)

    def triangle(self, p: np.ndarray, n: np.ndarray, colour: np.ndarray) -> None:
        x0, y0 = np.maximum(np.ceil(p[:, :2].min(0) - 0.5), 0).astype(int)
        x1, y1 = np.floor(p[:, :2].max(0) + 0.5).astype(int)
        x1, y1 = min(x1, self.width), min(y1, self.height)
        area = (p[1, 0] - p[0, 0]) * (p[2, 1] - p[0, 1]) - (p[2, 0] - p[0, 0]) * (p[1, 1] - p[0, 1])
        if x0 >= x1 or y0 >= y1 or area == 0:
            return
        x, y = np.arange(x0, x1) + 0.5, (np.arange(y0, y1) + 0.5)[:, None]
        b = ((x - p[0, 0]) * (p[2, 1] - p[0, 1]) - (p[2, 0] - p[0, 0]) * (y - p[0, 1])) / area
        c = ((p[1, 0] - p[0, 0]) * (y - p[0, 1]) - (x - p[0, 0]) * (p[1, 1] - p[0, 1])) / area
        a = 1 - b - c
        depth = a * p[0, 2] + b * p[1, 2] + c * p[2, 2]
        seen = (a >= 0) & (b >= 0) & (c >= 0) & (depth > self.depth[y0:y1, x0:x1])
        if seen.any():
            normal = a[seen, None] * n[0] + b[seen, None] * n[1] + c[seen, None] * n[2]
            self.depth[y0:y1, x0:x1][seen] = depth[seen]
            self.colour[y0:y1, x0:x1][seen] = shade(normal, colour)

    def curve(self, points: np.ndarray) -> None:
        """Draws a round tube along a polyline, as small spheres half a pixel apart."""
        p = self.to_pixels(points)
        steps = np.maximum(np.ceil(2 * np.linalg.norm(np.diff(p[:, :2], axis=0), axis=1)), 1).astype(int)
        radius = CURVE_RADIUS * self.scale
        reach = int(np.ceil(radius))
        grid = np.arange(-reach, reach + 1)
        dx, dy = np.meshgrid(grid, grid)
        inside = dx * dx + dy * dy <= radius * radius
        dx, dy = dx[inside], dy[inside]
        rise = np.sqrt(radius * radius - dx * dx - dy * dy)
        colour = shade(np.stack([dx, -dy, rise], axis=1) / radius, CURVE, flat=0.55)
        for start, end, count in zip(p[:-1], p[1:], steps, strict=True):
            for t in np.arange(count) / count:
                q = start + t * (end - start)
                x, y = q[0].astype(int) + dx, q[1].astype(int) + dy
                depth = q[2] + NUDGE + rise / self.scale
                seen = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
                seen[seen] = depth[seen] > self.depth[y[seen], x[seen]]
                self.depth[y[seen], x[seen]] = depth[seen]
                self.colour[y[seen], x[seen]] = colour[seen]

    def veil(self, front: "Canvas") -> None:
        """Lays a front over this canvas, see-through, where it is nearer."""
        nearer = front.depth > self.depth
        self.colour[nearer] = GLASS * front.colour[nearer] + (1 - GLASS) * self.colour[nearer]
        self.depth[nearer] = front.depth[nearer]

    def save(self, path: Path) -> None:
        small = self.colour.reshape(HEIGHT, SAMPLES, WIDTH, SAMPLES, 3).mean(axis=(1, 3))
        Image.fromarray(np.clip(small, 0, 255).astype(np.uint8)).save(path, optimize=True)


def shade(normals: np.ndarray, colour: np.ndarray, flat: float = AMBIENT) -> np.ndarray:
    """Returns a color for each normal (k, 3): Lambert's law for both sides, and a highlight."""
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    normals = np.where(normals[:, 2:] < 0, -normals, normals)
    light = np.full(len(normals), flat)
    gloss = np.zeros(len(normals))
    for direction, strength in LIGHTS:
        towards = np.array(direction) / np.linalg.norm(direction)
        light += strength * np.maximum(normals @ towards, 0)
        half = towards + np.array([0, 0, 1])
        gloss += strength * np.maximum(normals @ (half / np.linalg.norm(half)), 0) ** 40
    return colour * np.minimum(light, 1.15)[:, None] + 38 * gloss[:, None]


def main() -> None:
    command = Path(sys.argv[1]).resolve()
    human, human_faces = read_human()
    knot, knot_faces = torus_knot(200, 50)
    pose = np.loadtxt(POSE)
    with tempfile.TemporaryDirectory() as folder:
        write_ply(Path(folder) / "knot.ply", knot, knot_faces)
        arguments = ["check", HUMAN, "knot.ply", "--pose-b", POSE, "--curves", "curves.obj"]
        run = subprocess.run([command, *arguments], cwd=folder)
        if run.returncode != 1:
            sys.exit("the human and the knot should intersect")
        curves = read_curves(Path(folder) / "curves.obj")
    knot = knot @ pose[:3, :3].T + pose[:3, 3]

    curves = [view(points) for points in curves]
    canvas, glass = Canvas(), Canvas()
    canvas.mesh(view(human), human_faces, SKIN)
    glass.mesh(view(knot), knot_faces, TUBE)
    for points in curves:  # those behind the knot, seen through it
        canvas.curve(points)
    canvas.veil(glass)
    for points in curves:
        canvas.curve(points)
    canvas.save(ROOT / "docs" / "images" / "picture.png")


if __name__ == "__main__":
    main()
