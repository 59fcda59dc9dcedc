"""Ctrl-C in long calls: milliseconds until the call returns, and processor time that it costs then.

Each call lasts seconds, or is repeated, and is interrupted at three times. It must end with
`KeyboardInterrupt`. The work that the call left behind ends at its next check: the table says after
how long this process is idle, and how much processor time it used from the signal on. On a busy
machine only the processor time is comparable.
"""

import signal
import threading
import time
from collections.abc import Callable

import impinge
import numpy as np
import record
from impinge import fit, pose

DELAYS = (0.15, 0.4, 0.9)
"""Seconds after which a call is interrupted."""

PAUSE = 0.06
"""Seconds without work after which the process counts as idle."""

ROWS = np.random.default_rng(1)


def ball(n: int, wave: float = 0.0, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return a closed surface of 4 n² faces: a ball with waves of a height."""
    polar, around = np.meshgrid(
        np.linspace(0, np.pi, n + 1)[1:-1], np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), indexing="ij"
    )
    length = radius + wave * np.sin(9 * polar) * np.cos(11 * around)
    ring = np.sin(polar)
    points = np.stack([ring * np.cos(around), ring * np.sin(around), np.cos(polar)], axis=-1) * length[..., None]
    corner = np.arange(points.shape[0] * 2 * n).reshape(-1, 2 * n)
    beside = np.roll(corner, -1, axis=1)
    a, b, c, d = corner[:-1].ravel(), beside[:-1].ravel(), corner[1:].ravel(), beside[1:].ravel()
    top, bottom = np.full(2 * n, corner.size), np.full(2 * n, corner.size + 1)
    caps = [np.c_[top, corner[0], beside[0]], np.c_[bottom, beside[-1], corner[-1]]]
    poles = [[0, 0, radius], [0, 0, -radius]]
    return np.vstack([points.reshape(-1, 3), poles]), np.vstack([np.c_[a, c, d], np.c_[a, d, b], *caps])


def calls() -> dict[str, Callable[[], object]]:
    """Return long calls by name."""
    huge = ball(1400)
    vertices, faces = ball(700, 0.01)
    large, crossing = impinge.Mesh(vertices, faces), impinge.Mesh(*ball(700, 0.012))
    a, b = impinge.Mesh(*ball(300, 0.01)), impinge.Mesh(*ball(300, 0.012))
    small, other = impinge.Mesh(*ball(60, 0.05)), impinge.Mesh(*ball(60, 0.06))
    inner, outer = impinge.Mesh(*ball(500)), impinge.Mesh(*ball(500, radius=1.1))
    points = ROWS.uniform(-1.2, 1.2, (2_000_000, 3))
    names = [f"part {at}" for at in range(300)]
    scene = impinge.Scene(dict.fromkeys(names, small), poses={name: pose(ROWS.uniform(-2, 2, 3)) for name in names})
    still, rising = impinge.Motion(np.eye(4), np.eye(4)), impinge.Motion(np.eye(4), pose([0, 0, 0.2]))
    return {
        "Mesh, 7.8 million faces": lambda: impinge.Mesh(*huge),
        "rebuild": large.rebuild,
        "refit": lambda: large.refit(vertices),
        "intersecting_pairs": lambda: impinge.intersecting_pairs(large, crossing),
        "intersection_curves": lambda: impinge.intersection_curves(large, crossing),
        "distance": lambda: impinge.distance(inner, outer),
        "within": lambda: impinge.within(inner, outer, 0.0995),
        "penetrates": lambda: impinge.penetrates(impinge.Mesh(vertices, faces), b),
        "penetration": lambda: impinge.penetration(small, other),
        "depth": lambda: impinge.depth(a, b),
        "deeper": lambda: impinge.deeper(a, b, 1e-5),
        "contacts": lambda: impinge.contacts(a, b),
        "time_of_impact": lambda: impinge.time_of_impact(inner, outer, still, rising),
        "contains": lambda: a.contains(points),
        "signed_distance": lambda: a.signed_distance(points),
        "winding_number": lambda: a.winding_number(points),
        "closest_point": lambda: a.closest_point(points),
        "ray_cast": lambda: a.ray_cast(points, -points),
        "fit.obb": lambda: fit.obb(huge[0]),
        "fit.sphere": lambda: fit.sphere(huge[0]),
        "Mesh.repaired": large.repaired,
        "Scene.check": lambda: scene.check(question="penetrates", stop="all"),
        "clash": lambda: impinge.clash(scene, tolerance=1e-3),
    }


def interrupted(call: Callable[[], object], delay: float) -> tuple[float, float, float]:
    """Return the seconds from the signal until a call returned and until this process was idle.

    The third number is the processor time that the process used after the signal.
    """
    sent = []

    def interrupt() -> None:
        sent.append((time.perf_counter(), time.process_time()))
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(delay, interrupt)
    timer.start()
    try:
        while True:
            call()
    except KeyboardInterrupt:
        returned = time.perf_counter()
    timer.join()
    idle, used = returned, time.process_time()
    quiet = time.perf_counter()
    while time.perf_counter() - quiet < PAUSE:
        time.sleep(0.004)
        now = time.process_time()
        if now - used > 0.0012:
            idle = quiet = time.perf_counter()
        used = now
    begun, processor = sent[0]
    return returned - begun, idle - begun, used - processor


def main() -> None:
    """Print a table of all calls: the worst of three interrupts each."""
    # Shells make background processes ignore the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    print(f"{'call':26} {'returned':>10} {'idle':>10} {'processor':>10}   ms")
    for name, call in calls().items():
        worst = np.max([interrupted(call, delay) for delay in DELAYS], axis=0)
        print(f"{name:26} " + " ".join(f"{1e3 * value:10.1f}" for value in worst), flush=True)
        for quantity, value in zip(("returned", "idle", "processor time"), worst, strict=True):
            record.row(name, quantity, "s", value)


if __name__ == "__main__":
    main()
