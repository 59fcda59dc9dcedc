"""Rows of poses and configurations of a scene on two workers, beside two threads of this process.

    IMPINGE_DATA=... .venv/bin/python bench/cluster_rows.py [--poses 10000000] [--rounds 3]

Poses are those of two meshes of FCL. The scene has 200 parts, of which 8 move. Both ways take
turns, and workers have the priority of this process. The run fails if answers differ in any byte.
Efficiency is the median time of two threads, divided by that of two workers. Processor efficiency
is the same with the processor time of the caller, the workers and Ray's own processes. The overhead
of a task is the processor time that two workers take more, divided by the number of tasks.
"""

import argparse
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import impinge
import numpy as np
import record

_TICK = os.sysconf("SC_CLK_TCK")


def random_poses(count: int, middle: np.ndarray, reach: np.ndarray, seed: int) -> np.ndarray:
    """Return (count, 4, 4) poses with random turns and places."""
    rng = np.random.default_rng(seed)
    places = middle + rng.uniform(-1, 1, (count, 3)) * reach
    return impinge.pose(places, rpy=rng.uniform(-np.pi, np.pi, (count, 3)))


def fcl_call(count: int) -> Callable[..., np.ndarray]:
    """Return a call that asks whether two meshes of FCL intersect, for random poses of one."""
    meshes = Path(os.environ["IMPINGE_DATA"]) / "nasty" / "fcl_resources"
    env, rob = impinge.load(meshes / "env.obj"), impinge.load(meshes / "rob.obj")
    low, high = env.vertices.min(axis=0), env.vertices.max(axis=0)
    poses = random_poses(count, (low + high) / 2, (high - low) / 2, 1)
    return lambda **on: impinge.intersects(env, rob, None, poses, **on)


def scene_call(count: int) -> Callable[..., impinge.SceneReport]:
    """Return a call that checks random configurations of 8 of 200 parts."""
    rng = np.random.default_rng(2)
    steps = 2 * np.pi * np.arange(24) / 24
    around, along = np.meshgrid(steps, steps)
    out = 0.5 + 0.2 * np.cos(around)
    corners = np.stack([out * np.cos(along), out * np.sin(along), 0.2 * np.sin(around)], axis=-1).reshape(-1, 3)
    at = np.arange(24 * 24).reshape(24, 24)
    a, b, c, d = (each.ravel() for each in (at, np.roll(at, -1, 0), np.roll(at, -1, 1), np.roll(at, -1, (0, 1))))
    ring = impinge.Mesh(corners, np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])]))
    fixed = {f"fixed {number}": ring for number in range(192)}
    scene = impinge.Scene(
        {**fixed, **{f"moving {number}": ring for number in range(8)}},
        poses={name: impinge.pose(place) for name, place in zip(fixed, rng.uniform(-8, 8, (192, 3)), strict=True)},
        ignored=[(a, b) for a in fixed for b in fixed if a < b],
    )
    poses = {f"moving {at}": random_poses(count, np.zeros(3), np.full(3, 8.0), 3 + at) for at in range(8)}
    return lambda **on: scene.check(poses, **on)


def processor_times() -> tuple[float, float]:
    """Return the seconds of the workers of Ray on this machine, and of its other processes."""
    workers = others = 0.0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            title = (folder / "cmdline").read_bytes()
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        seconds = (int(fields[11]) + int(fields[12])) / _TICK
        if title.startswith((b"ray::", b"ray::IDLE")):
            workers += seconds
        elif b"/ray/" in title or title.startswith(b"ray"):
            others += seconds
    return workers, others


def timed(call: Callable[[], Any]) -> tuple[Any, float, float, float, float]:
    """Return an answer, its time, and the processor time of the caller, the workers and Ray."""
    before, start = (time.process_time(), *processor_times()), time.perf_counter()
    answer = call()
    seconds = time.perf_counter() - start
    after = time.process_time(), *processor_times()
    return answer, seconds, *(b - a for a, b in zip(before, after, strict=True))


def content(answer: np.ndarray | impinge.SceneReport) -> list[tuple[str, bytes]]:
    """Return the types and bytes of an answer, with all pairs of a report."""
    arrays = [answer] if isinstance(answer, np.ndarray) else [answer.intersects, answer._offsets, answer._found]
    return [(array.dtype.str, array.tobytes()) for array in arrays]


def compare(name: str, call: Callable[..., Any], rounds: int, cluster: impinge.cluster.Cluster) -> None:
    """Run both ways in turns, compare their answers, and print and record the times."""
    local, shared = [], []
    for _ in range(rounds):
        with impinge.threads(2):
            local.append(timed(call))
        shared.append(timed(lambda: call(on=cluster)))
        assert content(local[-1][0]) == content(shared[-1][0]), name
    tasks = cluster.work.tasks
    threads, workers = (statistics.median(run[1] for run in runs) for runs in (local, shared))
    own = statistics.median(run[2] for run in local)
    caller, working, ray = (statistics.median(run[at] for run in shared) for at in (2, 3, 4))
    rows = {
        "two threads": ("s", threads),
        "two threads, processor": ("s", own),
        "two workers": ("s", workers),
        "two workers, processor of caller": ("s", caller),
        "two workers, processor of workers": ("s", working),
        "two workers, processor of Ray": ("s", ray),
        "tasks": ("1", tasks),
        "efficiency": ("%", 100 * threads / workers),
        "processor efficiency": ("%", 100 * own / (caller + working + ray)),
        "overhead of a task": ("s", (caller + working + ray - own) / tasks),
    }
    for quantity, (unit, value) in rows.items():
        print(f"{name}: {quantity}: {value:,.4g} {unit}", flush=True)
        record.row(name, quantity, unit, value)


def main() -> None:
    """Compare both ways for poses and for configurations."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=10_000_000)
    parser.add_argument("--configurations", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    os.environ["RAY_worker_niceness"] = "0"  # that of this process, so that both ways have the same share
    with impinge.cluster.ray(num_cpus=2, include_dashboard=False, object_store_memory=1 << 30) as cluster:
        fcl_call(1 << 18)(on=cluster)  # starts the workers
        compare(f"{arguments.poses} poses", fcl_call(arguments.poses), arguments.rounds, cluster)
        configurations = scene_call(arguments.configurations)
        compare(f"{arguments.configurations} configurations", configurations, arguments.rounds, cluster)


if __name__ == "__main__":
    main()
