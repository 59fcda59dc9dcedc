"""Samples the memory of the nodes of a cluster on this machine, on Linux."""

import os
import threading
from pathlib import Path

import numpy as np


class Memory(threading.Thread):
    """Samples the memory of nodes and of this process, the caller.

    Parameters
    ----------
    raylets : dict of str to int
        Process number of Ray's raylet of each node, by the name of the node.

    Attributes
    ----------
    peaks : dict of str to list of int
        For each node and for ``"caller"``, maxima in bytes: private pages and pages of the object
        store, and pages of mapped files, which the system can drop. A page that several processes
        use is divided among them.
    """

    def __init__(self, raylets: dict[str, int]) -> None:
        super().__init__(daemon=True)
        self._raylets, self._ended = raylets, threading.Event()
        self.peaks = {name: [0, 0] for name in ("caller", *raylets)}

    def run(self) -> None:
        """Sample until `stop` is called."""
        while not self._ended.wait(1.0):
            parents = {int(each.name): parent_of(each) for each in Path("/proc").glob("[0-9]*")}
            for name, raylet in self._raylets.items():
                self._sample(name, [pid for pid in parents if is_below(pid, raylet, parents)])
            self._sample("caller", [os.getpid()])

    def _sample(self, name: str, pids: list[int]) -> None:
        sums = np.sum([pages_of(pid) for pid in pids], axis=0)
        self.peaks[name] = np.maximum(self.peaks[name], sums).tolist()

    def stop(self) -> None:
        """End the sampling."""
        self._ended.set()
        self.join()


def parent_of(folder: Path) -> int:
    """Return the number of the parent of a process, or 0 if the process has ended."""
    try:
        return int((folder / "stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return 0


def is_below(pid: int, root: int, parents: dict[int, int]) -> bool:
    """Report whether a process is another one or was started by it."""
    while pid and pid != root:
        pid = parents.get(pid, 0)
    return pid == root


def pages_of(pid: int) -> tuple[int, int]:
    """Return the share of a process in memory that counts, and in mapped files, in bytes."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0, 0
    sizes = {line.split(":")[0]: int(line.split()[1]) << 10 for line in lines if line.startswith("Pss_")}
    return sizes["Pss_Anon"] + sizes["Pss_Shmem"], sizes["Pss_File"]


def swapped() -> int:
    """Return the number of pages that this machine has swapped out since it started."""
    counts = dict(line.split() for line in Path("/proc/vmstat").read_text().splitlines())
    return int(counts["pswpout"])
