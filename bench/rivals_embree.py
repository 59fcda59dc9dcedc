"""Compare impinge and Embree on the headline meshes, on one thread each: build, refit and pairs.

    apt install g++ libembree-dev
    .venv/bin/python bench/rivals_embree.py

Embree's rtcCollide finds pairs of faces whose boxes overlap in one common frame; it does not decide
whether the triangles intersect. Its trees are of medium quality. Both engines get the same vertices
in single precision, because Embree accepts no other.
"""

import argparse
import json
import subprocess
from pathlib import Path

import numpy as np
import record
from about import ROOT, circumstances, output, print_circumstances
from rivals import KNOT_POSES, Mesh, Pose, ratio, spread
from torus_knot import torus_knot, write_ply

FOLDER = ROOT / "target" / "rivals"
KEYS = {"build_seconds": "build", "refit_seconds": "refit", "pairs_seconds": "find pairs"}
"""Keys of the times in an answer, and their names in the record."""


def program() -> Path:
    """Return the path of the Embree program; compile it if its source is newer."""
    source, binary = ROOT / "bench" / "embree" / "embree.cpp", FOLDER / "embree"
    if not binary.exists() or binary.stat().st_mtime < source.stat().st_mtime:
        subprocess.run(["g++", "-O3", "-march=native", str(source), "-o", str(binary), "-lembree3"], check=True)
    return binary


def measure_embree(mesh: Mesh, pose: Pose, repeats: int) -> dict[str, object]:
    """Return the number of pairs of overlapping boxes, and the seconds of single runs."""
    vertices, faces = mesh
    moved = vertices @ pose.rotation().T + pose.translation
    paths = [FOLDER / name for name in ("vertices_a.f32", "vertices_b.f32", "faces.u32")]
    for path, array in zip(paths, (vertices.astype("<f4"), moved.astype("<f4"), faces.astype("<u4")), strict=True):
        array.tofile(path)
    answer = json.loads(output(str(program()), *map(str, paths), str(repeats)))
    return {**answer, "pairs": answer["box_pairs"], "pairs_seconds": answer["collide_seconds"]}


def measure_impinge(path: Path, pose: Pose, repeats: int) -> dict[str, object]:
    """Return the number of intersecting pairs, and the seconds of single runs."""
    numbers = ",".join(repr(x) for x in (*pose.translation, *pose.quaternion))
    command = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "headline", "--"]
    arguments = ["--mesh", str(path), "--pose-b", numbers, "--threads", "1", "--json", "--repeats", str(repeats)]
    answer = json.loads(output(*command, *arguments))
    return {**answer, "pairs_seconds": answer["all_pairs_seconds"]}


def table(timings: list[dict[str, object]]) -> str:
    """Return a Markdown table with two rows for each pose, impinge first."""
    rows = ["| pose | engine | pairs | build, ms | ratio | refit, ms | ratio | pairs, ms | ratio |", "|" + "---|" * 9]
    for ours, theirs in zip(timings[::2], timings[1::2], strict=True):
        for timing in (ours, theirs):
            cells = [timing["pose"], timing["engine"], str(timing["pairs"])]
            for key in KEYS:
                cells += [spread(timing[key], 1e3), ratio(timing[key], ours[key])]
            rows.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(rows)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads around its tube")
    parser.add_argument("--repeats", type=int, default=9, help="runs of each")
    options = parser.parse_args()

    FOLDER.mkdir(parents=True, exist_ok=True)
    about = circumstances()
    mesh = torus_knot(options.nu, options.nv)
    path = FOLDER / f"torus_knot_{len(mesh[1])}_single.ply"
    vertices, faces = mesh
    single = vertices.astype(np.float32)
    mesh = (single.astype(np.float64), faces)
    write_ply(path, single, faces)
    timings = []
    for pose in KNOT_POSES:
        timings.append({"pose": pose.name, "engine": "impinge", **measure_impinge(path, pose, options.repeats)})
        timings.append({"pose": pose.name, "engine": "Embree", **measure_embree(mesh, pose, options.repeats)})
        # Boxes contain their triangles, so every intersecting pair is a pair of overlapping boxes.
        assert timings[-1]["pairs"] >= timings[-2]["pairs"], f"{pose.name}: Embree finds fewer pairs than impinge"
    print_circumstances(
        about, "One thread; median (minimum) of the runs; a ratio is the engine's median over impinge's."
    )
    print(table(timings))
    for timing in timings:
        pose, engine = timing["pose"], timing["engine"]
        record.row(pose, "pairs", "1", timing["pairs"], engine)
        for key, name in KEYS.items():
            record.seconds(pose, name, timing[key], engine)


if __name__ == "__main__":
    main()
