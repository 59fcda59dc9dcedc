"""Draws the pictures of the README and of the documentation, except for the plots of benchmarks.

    cargo build --release -p impinge-cli && maturin develop --release
    (cd viewer && npm ci)
    python docs/images/draw.py target/release/impinge [NAME ...]

The pictures are those of the command, of `impinge.show`, and of the pages in a headless Chromium
(named by the variable CHROMIUM). Each has a function of its own name here. Without names, all are
drawn. Beside the package, only NumPy and Pillow are needed.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import impinge
import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent.parent
DATA = ROOT / "data"
IMAGES = ROOT / "docs" / "images"
HUMAN = DATA / "human_makehuman_cc0.ply"
GANTRY = DATA / "robots" / "gantry.urdf"
GEARBOX = [str(DATA / "cad_cycloidal_gearbox.glb"), "--file-unit", "mm", "--tolerance", "10um", "--repair"]
"""A gearbox in millimeters, although glTF is in meters, and the question about it."""
MAX_BYTES = 150_000
"""Maximum size of a picture. A clone of the repository has all of them."""

sys.path.insert(0, str(ROOT / "bench"))
from torus_knot import torus_knot  # noqa: E402

RULES = """
[sets]
dowels = { name = "dowel*" }
plates = { name = "fixed_lower*" }

[[rule]]
a = "dowels"
b = "plates"
"""


def picture(_: Command) -> None:
    """Draw the human, a torus knot around it, and the curves in which they intersect."""
    knot = impinge.Mesh(*torus_knot(200, 50))
    pose = np.loadtxt(DATA / "torus_knot_on_human.txt")
    human = impinge.load(HUMAN)
    impinge.show(human, knot, pose_b=pose, up="y", size=(960, 760), view=(25, 18), path=IMAGES / "picture.png")


def clash(run: Command) -> None:
    """Draw a dowel of the gearbox, and the plate that it enters."""
    run.folder.joinpath("rules.toml").write_text(RULES)
    run(1, "clash", *GEARBOX, "--rules", "rules.toml", "--json=out.json", "--pictures", "out")
    report = json.loads((run.folder / "out.json").read_text())
    worst = report["groups"][0]["clashes"][0]
    shutil.copy(run.folder / "out" / f"{worst}.png", IMAGES / "clash.png")


def characters(run: Command) -> None:
    """Draw frames of a punch, with the hit volumes."""
    out = IMAGES / "characters.png"
    run(0, "hits", DATA / "robot.glb", "--animation", "Robot_Punch", "--picture", out)


def hierarchy(run: Command) -> None:
    """Draw the boxes of one level of a hierarchy."""
    run(0, "inspect", HUMAN, "--level", "2", "--picture", IMAGES / "hierarchy.png")


def shapes(_: Command) -> None:
    """Draw shapes of all kinds on a height field."""
    x, y = np.meshgrid(np.linspace(0, 12, 61), np.linspace(0, 8, 41))
    heights = 0.3 * np.sin(0.9 * x) * np.cos(0.8 * y) - 0.25
    kinds = {
        "box": impinge.Shape.box([0.7, 0.7, 0.7]),
        "rounded box": impinge.Shape.box([0.45, 0.45, 0.45]).rounded(0.25),
        "rounded cylinder": impinge.Shape.cylinder(0.5, 0.5).rounded(0.2),
        "tapered capsule": impinge.Shape.tapered_capsule([0, 0, -0.6], [0, 0, 0.7], (0.6, 0.25)),
        "capsule": impinge.Shape.capsule([0, 0, -0.6], [0, 0, 0.6], 0.45),
        "cone": impinge.Shape.cone(0.8, 0.7),
        "ellipsoid": impinge.Shape.ellipsoid([0.8, 0.5, 0.9]),
        "hull": impinge.Shape.hull(np.random.default_rng(4).normal(0, 0.5, (40, 3))),
    }
    places = {name: impinge.pose([2 + 2.7 * (at % 4), 2.4 + 3.2 * (at // 4), 1.4]) for at, name in enumerate(kinds)}
    scene = impinge.Scene({**kinds, "terrain": impinge.Shape.height_field(heights, (0.2, 0.2))}, poses=places)
    impinge.show(scene, size=(960, 600), view=(20, 32), path=IMAGES / "shapes.png")


def convex_parts(_: Command) -> None:
    """Draw the convex parts of a torus knot, moved apart."""
    knot = impinge.Mesh(*torus_knot(160, 16))
    parts = knot.convex_parts(concavity=0.25, max_parts=40).parts
    hulls = {str(at): impinge.Shape.hull(part.vertices) for at, part in enumerate(parts)}
    places = {str(at): impinge.pose(0.3 * part.vertices.mean(0)) for at, part in enumerate(parts)}
    scene = impinge.Scene(hulls, poses=places)
    impinge.show(scene, size=(960, 640), view=(20, 50), path=IMAGES / "convex-parts.png")


def clash_page(run: Command) -> None:
    """Draw the page of a report of clashes."""
    run(1, "clash", *GEARBOX, "--view", "page.html")
    screenshot(run.folder / "page.html", IMAGES / "clash-page.png", "n")


def check_page(run: Command) -> None:
    """Draw the page of two meshes."""
    arguments = ["--pose-b", "0.45,0.1,0.1", "--up", "y", "--view", "page.html"]
    run(1, "check", HUMAN, HUMAN, *arguments)
    screenshot(run.folder / "page.html", IMAGES / "check-page.png", "f")


def robot_page(run: Command) -> None:
    """Draw the page of a robot on a path that collides."""
    path = ROOT / "viewer" / "test" / "path.csv"
    arguments = ["--srdf", GANTRY.with_suffix(".srdf"), "--path", path, "--view", "page.html"]
    run(1, "robot", "motion", GANTRY, *arguments)
    screenshot(run.folder / "page.html", IMAGES / "robot-page.png", "")


PICTURES = (picture, clash, characters, hierarchy, shapes, convex_parts, clash_page, check_page, robot_page)


class Command:
    """Runs the command in a folder of its own."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program, self.folder = program, folder

    def __call__(self, code: int, *arguments: str | Path) -> None:
        """Run the command with arguments, and expect an exit code."""
        run = subprocess.run([self.program, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL, check=False)
        if run.returncode != code:
            sys.exit(f"impinge {arguments[0]}: exit code {run.returncode}, where {code} is expected")


def screenshot(page: Path, path: Path, keys: str) -> None:
    """Open a page in a browser, press keys, and write a picture of it."""
    browser = os.environ.get("CHROMIUM") or shutil.which("chromium") or "chromium"
    environment = {**os.environ, "IMPINGE_PAGE": str(page), "CHROMIUM": browser}
    command = ["npm", "run", "--silent", "screenshot", "--", str(path), *keys]
    subprocess.run(command, cwd=ROOT / "viewer", env=environment, check=True)


def reduce(path: Path) -> None:
    """Keep 256 colors of a picture, which takes half the bytes or less."""
    with Image.open(path) as picture:
        colors = picture.convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    colors.save(path, optimize=True)


def main() -> None:
    program, names = Path(sys.argv[1]).resolve(), sys.argv[2:]
    for draw in PICTURES:
        if names and draw.__name__ not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            draw(Command(program, Path(folder)))
        path = IMAGES / f"{draw.__name__.replace('_', '-')}.png"
        reduce(path)
        size = path.stat().st_size
        print(f"{path.relative_to(ROOT)}: {size / 1000:.0f} kB")
        if size > MAX_BYTES:
            sys.exit(f"the picture has more than {MAX_BYTES / 1000:.0f} kB")


if __name__ == "__main__":
    main()
