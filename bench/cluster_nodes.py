"""Simulates calls on 10, 100 and 1,000 nodes, from times that were measured on one machine.

    .venv/bin/python bench/cluster_nodes.py

Prints a table of `docs/cluster.md`. Each load is a call of so much work that 10 nodes take about an
hour, or of 200,000 tasks. It is cut into tasks as `impinge.cluster` cuts it. The simulation has the
resources that a cluster has, each of which serves one request at a time:

- the calling process, which gives a task to Ray and reads its answer (`CALLER`);
- the network of its machine, which sends the parcels and the arguments of tasks;
- the network of each node, which receives them, and reads the files that its tasks map;
- the shared storage, which sends those files to all nodes;
- the processors of the nodes. A processor needs `WORKER` for a task besides its queries.

At most two tasks for each processor are with Ray. Times of tasks vary at random. The programs of
Ray on each node are not simulated: they work beside the others. A processor waits for all files
that its task maps, as if none of them was in the memory of its node. The efficiency is the time
that the queries take, divided by the time of all processors until the call ends. A run fails if a
call ends earlier than its busiest resource allows.
"""

import argparse
import heapq
from dataclasses import dataclass

import numpy as np
import record

CALLER, WORKER = 3e-3, 2e-3
"""Measured processor time of a task in the calling process and in a worker, in seconds, besides its
queries: a table of `docs/cluster.md`."""

PROCESSORS = 16
"""Number of processors of a node."""

NETWORK, STORAGE = 1.25e9, 5e9
"""Bandwidth of a machine (10 Gbit/s) and of the shared storage, in bytes per second."""

HOUR_OF_TEN_NODES = 10 * PROCESSORS * 3600.0
"""Work of each load in seconds of one processor."""

MOST_TASKS = 200_000
"""Maximum number of tasks of a load. More of them take longer to simulate, and show the same."""

TASKS_IN_FLIGHT = 2
"""Number of tasks for each processor that are with Ray at a time."""


@dataclass(frozen=True)
class Load:
    """A kind of call.

    Attributes
    ----------
    seconds : float
        Mean time of the queries of a task, in seconds.
    spread : float
        Standard deviation of the logarithm of that time.
    sent : float
        Mean number of bytes that the calling process sends for a task.
    mapped : float
        Mean number of bytes that a task reads from the shared storage.
    """

    seconds: float
    spread: float
    sent: float
    mapped: float

    def tasks(self) -> np.ndarray:
        """Return the times of the tasks."""
        count = min(round(HOUR_OF_TEN_NODES / self.seconds), MOST_TASKS)
        varied = np.random.default_rng(1).lognormal(0.0, self.spread, count)
        return varied * (self.seconds * count / varied.sum())


LOADS = {
    "poses of two meshes": Load(seconds=0.105, spread=0.1, sent=8 << 20, mapped=0),
    "configurations of 200 parts": Load(seconds=0.65, spread=0.1, sent=8 << 20, mapped=0),
    "pairs of large parts in baked files": Load(seconds=0.6, spread=0.5, sent=50_000, mapped=60e6),
    "pairs of small parts": Load(seconds=7.0, spread=0.5, sent=5e6, mapped=0),
}
"""Loads in tasks of the largest size, into which large calls are cut. Times and bytes of smaller
tasks were measured: for the first two by `cluster_rows.py`, for the third by `beyond_memory.py`,
for the last by the check of a building in `docs/cluster.md`."""


@dataclass
class Outcome:
    """Time of a call in seconds, its efficiency, and the share of that time of each resource."""

    seconds: float
    efficiency: float
    busy: dict[str, float]


def simulated(load: Load, nodes: int) -> Outcome:
    """Return the outcome of a call on some nodes."""
    times = load.tasks()
    processors = nodes * PROCESSORS
    free = [(0.0, at) for at in range(processors)]  # times at which processors are free
    heapq.heapify(free)
    room: list[float] = []  # times at which tasks with Ray end, for the bound on their number
    caller = sending = storage = 0.0  # times at which these are free
    receiving = [0.0] * nodes
    for seconds in times:
        if len(room) == TASKS_IN_FLIGHT * processors:
            caller = max(caller, heapq.heappop(room))
        caller += CALLER
        sending = max(sending, caller) + load.sent / NETWORK
        ready, processor = heapq.heappop(free)
        node = processor // PROCESSORS
        receiving[node] = max(receiving[node], sending) + load.sent / NETWORK
        start = max(ready, receiving[node])
        if load.mapped:  # a processor waits for the files that it maps
            storage = max(storage, start) + load.mapped / STORAGE
            receiving[node] = max(receiving[node], start) + load.mapped / NETWORK
            start = max(storage, receiving[node])
        end = start + WORKER + seconds
        heapq.heappush(free, (end, processor))
        heapq.heappush(room, end)
    end = max(caller, *(each for each, _ in free))
    count = len(times)
    busy = {
        "calling process": CALLER * count,
        "its network": load.sent * count / NETWORK,
        "network of nodes": (load.sent + load.mapped) * count / NETWORK / nodes,
        "shared storage": load.mapped * count / STORAGE,
        "processors": (times.sum() + WORKER * count) / processors,
    }
    assert end >= max(busy.values()) * (1 - 1e-9), "the call ends too early"
    return Outcome(end, times.sum() / processors / end, {name: spent / end for name, spent in busy.items()})


def main() -> None:
    """Print and record a row for each load and number of nodes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, nargs="+", default=[10, 100, 1000])
    arguments = parser.parse_args()
    print("| call | nodes | tasks | time | efficiency | busiest resource |\n|---|---|---|---|---|---|")
    for name, load in LOADS.items():
        for nodes in arguments.nodes:
            outcome = simulated(load, nodes)
            first = max(outcome.busy, key=lambda each: outcome.busy[each])
            cells = f"{outcome.seconds:,.0f} s | {outcome.efficiency:.0%} | {first}, {outcome.busy[first]:.0%}"
            print(f"| {name} | {nodes:,} | {len(load.tasks()):,} | {cells} |")
            record.row(f"{name}, {nodes} nodes", "time", "s", outcome.seconds)
            record.row(f"{name}, {nodes} nodes", "efficiency", "%", 100 * outcome.efficiency)


if __name__ == "__main__":
    main()
