"""Compare the first hits of the same rays in Embree and impinge, on one thread each.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt
    .venv/bin/python bench/rivals_rays.py

Some rays are random, others are aimed at edges and corners: from outside at a knot of two million
triangles, and from inside at a sphere. Embree is called through embreex, one ray per call, with its
fast and with its robust test of triangles. Its time is that of embreex's compiled loop. Both
engines get the same numbers in single precision.

If the two hit at different parameters, rational arithmetic decides which face is right. The cases
are counted, and some of the rays are printed. From inside of the sphere, every ray must hit.
"""

import argparse
import json
import sys
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import record
from about import ROOT, circumstances, output, print_circumstances
from rivals import ratio, seconds, spread
from torus_knot import torus_knot, write_ply

FOLDER = ROOT / "target" / "rivals"
TOLERANCE = 1e-4  # relative difference of parameters that single precision explains
NAMED = 5  # number of disagreements of each kind that are printed
NO_FACE = 2**32 - 1  # face index of a ray that misses


@dataclass
class Scene:
    """A mesh, and rays in its frame. If `is_inside` is set, every ray must hit."""

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    rays: np.ndarray
    """Origins and directions of the rays, (n, 6) float32."""
    is_inside: bool = False


def scenes(knot: tuple[int, int], levels: int, count: int) -> list[Scene]:
    """Return random rays and rays at edges for the knot and for the sphere, `count` of each."""
    rng = np.random.default_rng(5)
    tube, sphere = torus_knot(*knot), icosphere(levels)
    around = rng.normal(size=(count, 3))
    around *= 12 / np.linalg.norm(around, axis=1)[:, None]
    inside = rng.uniform(-0.3, 0.3, (count, 3))
    return [
        Scene("knot, random", *single(tube), towards(around, rng.uniform(tube[0].min(0), tube[0].max(0), (count, 3)))),
        Scene("knot, edges", *single(tube), towards(around, edges(rng, tube, count))),
        Scene("sphere, random", *single(sphere), towards(inside, rng.normal(size=(count, 3))), True),
        Scene("sphere, edges", *single(sphere), towards(inside, edges(rng, sphere, count)), True),
    ]


def single(mesh: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return a mesh with its vertices rounded to single precision."""
    return mesh[0].astype(np.float32), mesh[1]


def towards(origins: np.ndarray, aims: np.ndarray) -> np.ndarray:
    """Return rays, (n, 6) float32, from origins to points, rounded."""
    origins = origins.astype(np.float32)
    return np.hstack([origins, (aims - origins).astype(np.float32)])


def edges(rng: np.random.Generator, mesh: tuple[np.ndarray, np.ndarray], count: int) -> np.ndarray:
    """Return random points on edges, (count, 3); about a third of them are corners."""
    vertices, faces = single(mesh)
    ends = vertices[faces[rng.integers(len(faces), size=count)][:, :2]].astype(float)
    along = rng.choice([0.0, 0.5, 0.25], (count, 1))
    return ends[:, 0] * (1 - along) + ends[:, 1] * along


def icosphere(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a unit sphere of 8 * 4^levels triangles, from a subdivided octahedron."""
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    for _ in range(levels):
        sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        ends, number = np.unique(sides, axis=0, return_inverse=True)
        middles = vertices[ends].sum(axis=1)
        ab, bc, ca = number.reshape(3, -1) + len(vertices)
        vertices = np.concatenate([vertices, middles / np.linalg.norm(middles, axis=1)[:, None]])
        a, b, c = faces.T
        faces = np.concatenate([np.stack(row, axis=1) for row in [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]])
    return vertices, faces


@dataclass
class Hits:
    """First hits of all rays by one engine, and the seconds of single runs."""

    engine: str
    t: np.ndarray
    faces: np.ndarray
    seconds: list[float]


def measure_embree(scene: Scene, repeats: int, robust: bool) -> Hits:
    """Return the hits and times of Embree, with its fast or its robust test."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    tree = EmbreeScene(robust=robust)
    TriangleMesh(tree, scene.vertices[scene.faces])
    origins, directions = (np.ascontiguousarray(part) for part in (scene.rays[:, :3], scene.rays[:, 3:]))
    found = tree.run(origins, directions, output=True)  # builds the tree as well
    times = [seconds(lambda: tree.run(origins, directions)) for _ in range(repeats)]
    faces = found["primID"].astype(np.int64) & NO_FACE
    t = np.where(faces == NO_FACE, np.inf, found["tfar"].astype(float))
    return Hits("Embree, robust" if robust else "Embree", t, faces, times)


def measure_impinge(scene: Scene, repeats: int) -> list[Hits]:
    """Return the hits of impinge with the times of single calls, and with those of one call."""
    mesh, rays, hits = (FOLDER / name for name in ("rays.ply", "rays.f32", "hits.bin"))
    write_ply(mesh, scene.vertices, scene.faces)
    scene.rays.astype("<f4").tofile(rays)
    program = ["cargo", "run", "--quiet", "--release", "-p", "impinge-bench", "--bin", "rays", "--"]
    arguments = ["--mesh", mesh, "--rays", rays, "--hits", hits, "--repeats", repeats]
    times = json.loads(output(*program, *map(str, arguments)))
    found = np.fromfile(hits, np.dtype([("t", "<f8"), ("face", "<u4")]))
    t, faces = found["t"], found["face"].astype(np.int64)
    return [
        Hits("impinge, one by one", t, faces, times["one_by_one_seconds"]),
        Hits("impinge, in one call", t, faces, times["in_one_call_seconds"]),
    ]


def true_parameter(scene: Scene, ray: int, face: int) -> Fraction | None:
    """Return the exact parameter at which a ray hits a face; None if it misses or is edge-on."""
    if face == NO_FACE:
        return None
    origin, direction = ([Fraction(float(x)) for x in scene.rays[ray, part]] for part in (slice(3), slice(3, 6)))
    corners = [
        [Fraction(float(x)) - o for x, o in zip(scene.vertices[v], origin, strict=True)] for v in scene.faces[face]
    ]
    sides = [dot(direction, cross(corners[i], corners[(i + 1) % 3])) for i in range(3)]
    if min(sides) < 0 < max(sides) or sum(sides) == 0:
        return None
    # The three sides are the barycentric weights of the opposite corners.
    total = sum(sides)
    at = [sum(sides[(i + 1) % 3] * corners[i][k] for i in range(3)) / total for k in range(3)]
    t = dot(at, direction) / dot(direction, direction)
    return t if t >= 0 else None


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    """Return the cross product, exactly."""
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]


def dot(a: list[Fraction], b: list[Fraction]) -> Fraction:
    """Return the inner product, exactly."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def disagreements(scene: Scene, ours: Hits, theirs: Hits) -> dict[str, list[str]]:
    """Describe the rays for which the engines disagree, grouped by the exact answer."""
    both = np.isfinite(ours.t) & np.isfinite(theirs.t)
    differ = np.isfinite(ours.t) != np.isfinite(theirs.t)
    differ[both] = np.abs(ours.t[both] - theirs.t[both]) > TOLERANCE * ours.t[both]
    found: dict[str, list[str]] = {}
    for ray in map(int, np.flatnonzero(differ)):
        at = [true_parameter(scene, ray, int(hits.faces[ray])) for hits in (ours, theirs)]
        if at[0] is not None and (at[1] is None or at[0] < at[1]):
            kind = "passed through a face" if ours.t[ray] < theirs.t[ray] else "hit a face that the ray misses"
        elif at[0] is None and at[1] is None and not np.isfinite(ours.t[ray]):
            kind = "hit a face that the ray misses"
        elif at == [None, None] or at[0] == at[1]:
            kind = "edge-on, undecided"
        else:
            kind = "IMPINGE IS WRONG"
        whose = f"ray {ray}: impinge {ours.faces[ray]} at {ours.t[ray]:.9g}, {theirs.engine} {theirs.faces[ray]} at {theirs.t[ray]:.9g}"
        found.setdefault(kind, []).append(whose)
    return found


def write_rows(scene: Scene, hits: Hits, hit: int, seen_differently: dict[str, list[str]]) -> None:
    """Record the number of hits, the time of a ray, and the disagreements of each kind."""
    record.row(scene.name, "hits", "1", hit, hits.engine)
    if scene.is_inside:
        record.row(scene.name, "leaks", "1", len(hits.t) - hit, hits.engine)
    record.seconds(scene.name, "ray", [run / len(hits.t) for run in hits.seconds], hits.engine)
    for kind, rays in seen_differently.items():
        record.row(scene.name, f"rays {kind}", "1", len(rays), hits.engine)


def main() -> int:
    """Print the table; return 1 if a hit of impinge is wrong, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nu", type=int, default=2000, help="quads along the knot")
    parser.add_argument("--nv", type=int, default=500, help="quads around its tube")
    parser.add_argument("--levels", type=int, default=7, help="subdivisions of the sphere")
    parser.add_argument("--rays", type=int, default=1_000_000, help="rays of each kind")
    parser.add_argument("--repeats", type=int, default=5, help="runs of all rays")
    options = parser.parse_args()

    FOLDER.mkdir(parents=True, exist_ok=True)
    about = circumstances("embreex")
    lines = ["| rays | engine | hits | leaks | a ray, µs | ratio | seen differently |", "|" + "---|" * 7]
    notes, is_wrong = [], False
    for scene in scenes((options.nu, options.nv), options.levels, options.rays):
        single, ours = measure_impinge(scene, options.repeats)
        rivals = [measure_embree(scene, options.repeats, robust) for robust in (False, True)]
        for hits in (single, ours, *rivals):
            judged = disagreements(scene, ours, hits)
            hit = int(np.isfinite(hits.t).sum())
            leaks = str(len(hits.t) - hit) if scene.is_inside else ""
            a_ray = spread(hits.seconds, 1e6 / len(hits.t))
            differently = ", ".join(f"{len(rays)} {kind}" for kind, rays in judged.items())
            cells = [scene.name, hits.engine, str(hit), leaks, a_ray, ratio(hits.seconds, ours.seconds), differently]
            lines.append("| " + " | ".join(cells) + " |")
            write_rows(scene, hits, hit, judged)
            notes += [
                f"- {scene.name}, {hits.engine} {kind}: {name}"
                for kind, rays in judged.items()
                for name in rays[:NAMED]
            ]
            is_wrong |= "IMPINGE IS WRONG" in judged
        is_wrong |= scene.is_inside and not np.isfinite(ours.t).all()
    print_circumstances(
        about, "One thread; median (minimum) of the runs; a ratio is the median over impinge's in one call."
    )
    print("\n".join([*lines, "", *notes]))
    return 1 if is_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
