"""All intersecting pairs of a scene that is larger than the memory limit, on nodes of a cluster.

    .venv/bin/python bench/beyond_memory.py [--stones 500] [--faces 250000] [--copies 8]

A stone is a closed bumpy surface between two spheres around its center. No two stones have the same
corners. They are baked to a folder, and each has several copies in a lattice, turned at random.
Along each axis of the lattice the gaps are narrow or wide. Across a narrow gap two stones overlap,
as the inner spheres overlap and neither stone fits in the other. All other stones are farther apart
than the outer spheres reach, also along diagonals, where their boxes overlap. So the right pairs
are known, and the run fails if one is missing or wrong.

Each node is a raylet on this machine with one worker and an object store of 300 MB. No process may
have more than LIMIT minus that store of private memory (RLIMIT_DATA). The memory of each node is
sampled: private pages and pages of the object store. Mapped pages of files are told apart, because
the system drops them when memory is short. The files are dropped from the page cache at the start.
"""

import argparse
import os
import resource
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import chain
from multiprocessing import get_context
from pathlib import Path

import impinge
import numpy as np
import record
from node_memory import Memory, swapped
from ray.cluster_utils import Cluster

LIMIT = 4 << 30
"""Memory of a node in bytes."""

STORE = 300_000_000
"""Object store of a node in bytes."""

INNER, OUTER = 0.88, 1.0
"""Radii of the spheres between which the surface of a stone lies."""

NARROW, WIDE = 1.7, 2.05
"""Distances of neighbors that overlap, and of neighbors that do not."""


def stone(number: int, faces: int) -> impinge.Mesh:
    """Return a bumpy sphere of at least a number of faces."""
    rng = np.random.default_rng(number)
    rings = int(np.ceil(np.sqrt(faces / 4))) + 1
    around = 2 * rings
    angles = np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(around) / around
    polar, turn = np.meshgrid(*angles, indexing="ij")
    bumps = np.zeros_like(polar)
    for _ in range(4):
        waves, phase = rng.integers(2, 40, 2), rng.uniform(0, 2 * np.pi, 2)
        bumps += np.sin(waves[0] * polar + phase[0]) * np.sin(waves[1] * turn + phase[1]) / 4
    radius = 0.5 * (INNER + OUTER) + 0.49 * (OUTER - INNER) * bumps
    axis = np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)
    middle = 0.5 * (INNER + OUTER)
    corners = np.vstack([(radius * np.array(axis)).reshape(3, -1).T, [[0, 0, middle], [0, 0, -middle]]])
    at = np.arange((rings - 1) * around).reshape(rings - 1, around)
    right = np.roll(at, -1, axis=1)
    a, b, c, d = (each.ravel() for each in (at[:-1], right[:-1], at[1:], right[1:]))
    top, bottom = np.full(around, at.size), np.full(around, at.size + 1)
    quads = [(a, c, b), (b, c, d), (top, at[0], right[0]), (bottom, right[-1], at[-1])]
    return impinge.Mesh(corners.astype(np.float32), np.vstack([np.column_stack(each) for each in quads]))


def baked(job: tuple[int, int, str]) -> int:
    """Bake a stone to a file of its own, and return its number of faces."""
    number, faces, folder = job
    with impinge.threads(1):
        mesh = stone(number, faces)
        mesh.bake(Path(folder) / f"{number}.impinge")
    return mesh.face_count


def lattice(count: int) -> tuple[np.ndarray, set[frozenset[int]]]:
    """Return the places of stones in a lattice, and the pairs of numbers that overlap."""
    side = round(count ** (1 / 3))
    while count % side:
        side -= 1
    rest = round((count // side) ** 0.5)
    while (count // side) % rest:
        rest -= 1
    sizes = side, rest, count // side // rest
    rng = np.random.default_rng(1)
    gaps = [rng.choice([NARROW, WIDE], size - 1) for size in sizes]
    steps = [np.concatenate([[0.0], np.cumsum(each)]) for each in gaps]
    numbers = np.arange(count).reshape(sizes)
    places = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    pairs = set()
    for axis in range(3):
        lower, upper = np.delete(numbers, -1, axis), np.delete(numbers, 0, axis)
        near = np.flatnonzero(gaps[axis] == NARROW)
        both = np.take(lower, near, axis).ravel(), np.take(upper, near, axis).ravel()
        pairs |= {frozenset(pair) for pair in zip(both[0].tolist(), both[1].tolist(), strict=True)}
    return places, pairs


def bake(arguments: argparse.Namespace, folder: str) -> Iterator[tuple[str, str, float]]:
    """Bake the stones, and yield the quantity, the unit and the value of each number."""
    start = time.perf_counter()
    jobs = [(number, arguments.faces, folder) for number in range(arguments.stones)]
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        counts = list(pool.map(baked, jobs))
    yield "unique triangles", "1", sum(counts)
    yield "triangles", "1", sum(counts) * arguments.copies
    yield "bytes of files", "1", sum(path.stat().st_size for path in Path(folder).iterdir())
    yield "baking", "s", time.perf_counter() - start
    for path in Path(folder).iterdir():
        with path.open("rb") as file:
            os.fsync(file.fileno())
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def check(arguments: argparse.Namespace, folder: str, address: str) -> Iterator[tuple[str, str, float]]:
    """Load the scene, find its pairs and compare them; yield as `bake` does."""
    start = time.perf_counter()
    meshes = [impinge.load(Path(folder) / f"{number}.impinge") for number in range(arguments.stones)]
    places, right = lattice(arguments.stones * arguments.copies)
    turns = np.random.default_rng(2).uniform(-np.pi, np.pi, (len(places), 3))
    parts = {str(at): meshes[at % len(meshes)] for at in range(len(places))}
    scene = impinge.Scene(parts, poses=dict(zip(parts, impinge.pose(places, rpy=turns), strict=True)))
    yield "loading", "s", time.perf_counter() - start
    with impinge.cluster.ray(address, shared=folder) as cluster:
        start = time.perf_counter()
        report = scene.check(stop="all", on=cluster)
        seconds = time.perf_counter() - start
        work = cluster.work
    found = {frozenset(map(int, pair)) for pair in report.names()}
    assert found == right, f"{len(right - found)} pairs are missing, {len(found - right)} are wrong"
    yield "pairs", "1", len(right)
    yield "check", "s", seconds
    total = arguments.copies * sum(mesh.face_count for mesh in meshes)
    yield "triangles a second a core", "1", total / seconds / arguments.nodes
    yield "tasks", "1", work.tasks
    yield "bytes put", "1", work.bytes_put
    yield "bytes mapped", "1", work.bytes_mapped
    for at, private in enumerate(work.memory.values()):
        yield f"bytes of cluster.work.memory {at + 1}", "1", private


def started(count: int) -> Cluster:
    """Start the nodes, with several attempts, because Ray waits for 30 seconds only."""
    node = {"num_cpus": 1, "object_store_memory": STORE}
    for attempt in range(5):
        nodes = Cluster()
        try:
            for at in range(count):
                nodes.add_node(**node, **({"include_dashboard": False} if at == 0 else {}))
            return nodes
        except Exception as error:
            print(f"attempt {attempt + 1}: {error}", flush=True)
            nodes.shutdown()
    raise SystemExit("Ray does not start")


def on_nodes(arguments: argparse.Namespace, folder: str) -> Iterator[tuple[str, str, float]]:
    """Start the nodes with their limits, check on them, and stop them; yield as `bake` does."""
    resource.setrlimit(resource.RLIMIT_DATA, (LIMIT - STORE, LIMIT - STORE))
    before = swapped()
    nodes = started(arguments.nodes)
    raylets = [each.all_processes["raylet"][0].process.pid for each in nodes.list_all_nodes()]
    memory = Memory({f"node {at + 1}": pid for at, pid in enumerate(raylets)})
    memory.start()
    try:
        yield from check(arguments, folder, nodes.address)
    finally:
        memory.stop()
        nodes.shutdown()
    for name, (counted, files) in memory.peaks.items():
        yield f"bytes of {name}", "1", counted
        yield f"mapped bytes of {name}", "1", files
        assert counted < LIMIT, name
    yield "pages swapped out", "1", swapped() - before


def main() -> None:
    """Print and record the numbers of one run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stones", type=int, default=500)
    parser.add_argument("--faces", type=int, default=250_000)
    parser.add_argument("--copies", type=int, default=8)
    parser.add_argument("--nodes", type=int, default=2)
    parser.add_argument("--folder", help="parent of the temporary folder of baked files")
    arguments = parser.parse_args()
    case = f"{arguments.stones} stones of {arguments.faces} faces, {arguments.copies} copies, {arguments.nodes} nodes"
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        for quantity, unit, value in chain(bake(arguments, folder), on_nodes(arguments, folder)):
            print(f"{quantity}: {value:,.12g} {unit}".removesuffix(" 1"), flush=True)
            record.row(case, quantity, unit, value)


if __name__ == "__main__":
    main()
