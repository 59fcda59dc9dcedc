"""The connection to Ray, and the run of the tasks of a call."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from impinge import _limits
from impinge._errors import InputError
from impinge._impinge import __version__
from impinge._progress import Line
from impinge._scalars import path_of
from impinge._shape import AnyShape
from impinge.cluster import _worker
from impinge.cluster._calls import Call
from impinge.cluster._checkpoint import Checkpoint
from impinge.cluster._functions import Functions

_TASKS_PER_PROCESSOR = 2
"""Number of tasks that are with Ray at a time, for each processor of the cluster. With one, a
processor waits for its next task. More take memory and are not faster."""

_MAX_RETRIES = 16
"""Number of times that Ray runs a task again if its worker or its node ended. With fewer, a call
fails on a cluster whose nodes come and go. With more, a task that ends each worker takes longer to
fail."""

_INSTALL = 'pip install "impinge[ray]"'
"""Command that installs Ray, for the error message."""


_AGAIN = "Run the call again. If the connection has a checkpoint, finished tasks are not run again."
"""Hint for a task that Ray could not complete."""


class ClusterError(RuntimeError):
    """Raised if Ray is not installed, if the connection fails, or if a task fails."""


@dataclass
class Work:
    """Work that the last call on a cluster did.

    Attributes
    ----------
    tasks : int
        Number of tasks of the call.
    resumed : int
        Number of these tasks whose answers were in the checkpoint.
    bytes_put : int
        Size in bytes of the parts that were put into the object store.
    bytes_mapped : int
        Size in bytes of the baked meshes that workers mapped, once for each worker that used one.
    memory : dict of str to int
        For each node, the private memory of its workers in bytes, without mapped files and without
        the object store: the sum of the maximum of each worker at the ends of tasks. The name of a
        node is that of its machine, and the process number of Ray's raylet there. The size is 0 on
        systems other than Linux.
    """

    tasks: int = 0
    resumed: int = 0
    bytes_put: int = 0
    bytes_mapped: int = 0
    memory: dict[str, int] = field(default_factory=dict)


class Cluster:
    """A connection to a Ray cluster, which `ray` makes; pass it to calls as ``on=cluster``.

    Attributes
    ----------
    work : Work
        Work of the last call.
    """

    work: Work

    def __init__(self, engine: Any, checkpoint: Checkpoint | None, shared: str | None = None) -> None:
        self._ray: Any = engine
        self._checkpoint, self._shared = checkpoint, shared
        self._remote = engine.remote(num_cpus=1, max_retries=_MAX_RETRIES)(_worker.answer)
        self.work = Work()

    @property
    def processors(self) -> int:
        """Number of processors of all nodes."""
        return int(self._connected().cluster_resources().get("CPU", 0))

    def _functions(self) -> Functions:
        """Return the functions that answer calls in place of those of the extension."""
        self._connected()
        if _limits.asked.get() is not None:
            message = "the limits of impinge.limit do not hold on a cluster"
            raise InputError(message, kind="option", what="on", hint="leave the block of impinge.limit")
        return Functions(self._answer)

    def _connected(self) -> Any:
        if self._ray is None:
            raise ClusterError("the connection to the cluster is closed: call impinge.cluster.ray again")
        return self._ray

    def _close(self) -> None:
        self._ray = None
        if self._checkpoint is not None:
            self._checkpoint.close()

    def _answer(self, call: Call, progress: bool) -> Any:
        """Run all tasks of a call, and return its answer."""
        answers: dict[int, Any] = {}
        self._run(call, answers, progress)
        return call.merged(answers)

    def _run(self, call: Call, answers: dict[int, Any], progress: bool) -> None:
        """Run the tasks of a call, and add their answers, also if the run is interrupted."""
        call.parcels.arrange(self._shared)
        fingerprint = call.fingerprint() if self._checkpoint else ""
        if self._checkpoint:
            answers.update(self._checkpoint.answers(fingerprint))
        self.work = Work(call.count, len(answers))
        tasks = [at for at in range(call.count) if at not in answers]
        run = _Run(self._connected(), self._remote, call, tasks, self.work)
        line = Line(call.count) if progress else None
        room = max(_TASKS_PER_PROCESSOR * self.processors, 1)
        try:
            while run.fill(room):
                for task, answer in run.finished():
                    answers[task] = answer
                    if self._checkpoint:
                        self._checkpoint.add(fingerprint, task, answer)
                if line:
                    line.show(len(answers))
        finally:
            run.cancel()
            if line:
                line.end()


class _Run:
    """The tasks of a call that are with Ray, and the parcels that they need."""

    def __init__(self, engine: Any, remote: Any, call: Call, tasks: list[int], work: Work) -> None:
        self._ray, self._remote, self._call, self._work = engine, remote, call, work
        self._tasks = iter(tasks)
        self._pending: dict[Any, int] = {}
        self._parcels: dict[int, Any] = {}
        # A parcel is dropped when the last task that needs it was given to Ray, which keeps it.
        self._last = {parcel: task for task in tasks for parcel in self._parcels_of(task)}
        self._memory: dict[tuple[str, int], int] = {}
        """Maximum private memory of each worker, by its node and its process number."""

    def _parcels_of(self, task: int) -> list[int]:
        return self._call.parcels.numbers_of(self._call.parts[part] for part in self._call.parts_of(task))

    def fill(self, room: int) -> bool:
        """Give tasks to Ray until it has `room` of them. Return whether it has any."""
        for task in islice(self._tasks, max(room - len(self._pending), 0)):
            self._pending[self._started(task)] = task
        return bool(self._pending)

    def _started(self, task: int) -> Any:
        call = self._call
        parcels = self._parcels_of(task)
        for parcel in parcels:
            if parcel not in self._parcels:
                packed = call.parcels.packed(parcel)
                self._parcels[parcel] = self._ray.put(packed)
                self._work.bytes_put += packed.nbytes
        places = [self._place(call.names[part], call.parts[part], parcels) for part in call.parts_of(task)]
        remote = self._remote.options(name=f"impinge: {self._name(task)}")
        contents = [self._parcels[parcel] for parcel in parcels]
        started = remote.remote(__version__, call.function, places, call.arguments_of(task), *contents)
        for parcel in parcels:
            if self._last[parcel] == task:
                del self._parcels[parcel]
        return started

    def _place(self, name: str, part: AnyShape, parcels: list[int]) -> _worker.Place | _worker.StoredPlace:
        """Return where a worker finds a part: in a file, or in one of the parcels of its task."""
        stored = self._call.parcels.stored(part)
        if stored is not None:
            return _worker.StoredPlace(name, stored)
        slot = self._call.parcels.slot_of(part)
        return _worker.Place(name, slot.digest, slot.is_mesh, parcels.index(slot.parcel), slot.start, slot.size)

    def finished(self) -> Iterator[tuple[int, Any]]:
        """Wait until tasks are finished, and return their numbers and answers.

        Raises
        ------
        InputError, ClusterError
            If a task failed.
        """
        self._ray.wait(list(self._pending), num_returns=1)
        ready, _ = self._ray.wait(list(self._pending), num_returns=len(self._pending), timeout=0)
        for reference in ready:
            task = self._pending.pop(reference)
            answer, use = self._get(reference, task)
            self._count(use)
            yield task, answer

    def _count(self, use: _worker.Use) -> None:
        worker = use.node, use.process
        grown = max(use.memory - self._memory.get(worker, 0), 0)
        self._memory[worker] = self._memory.get(worker, 0) + grown
        self._work.memory[use.node] = self._work.memory.get(use.node, 0) + grown
        self._work.bytes_mapped += use.mapped

    def _get(self, reference: Any, task: int) -> Any:
        try:
            return self._ray.get(reference)
        except self._ray.exceptions.RayTaskError as error:
            cause = error.cause if isinstance(error.cause, Exception) else error
            if isinstance(cause, InputError | MemoryError):
                raise cause from None
            reason = str(cause) if isinstance(cause, _worker.VersionError) else f"{type(cause).__name__}: {cause}"
        except self._ray.exceptions.RayError as error:
            reason = f"{type(error).__name__}: {str(error).strip()}\n{_AGAIN}"
        raise ClusterError(f"{self._name(task)}: {reason.strip()}")

    def _name(self, task: int) -> str:
        return f"{self._call.what}, task {task + 1} of {self._call.count}"

    def cancel(self) -> None:
        """Cancel the tasks that are not finished."""
        for reference in self._pending:
            self._ray.cancel(reference)
        self._pending.clear()


@contextmanager
def ray(
    address: str | None = None,
    *,
    checkpoint: str | os.PathLike[str] | None = None,
    shared: str | os.PathLike[str] | None = None,
    **options: Any,
) -> Iterator[Cluster]:
    """Connect to a Ray cluster for the calls within a ``with`` block.

    Parameters
    ----------
    address : str, optional
        Address of the cluster, as for ``ray.init``: ``"auto"`` is the cluster that this machine is
        a node of. Without it, Ray is started on this machine, with a worker for each processor, and
        is stopped at the end of the block. If the process is connected to Ray already, that
        connection is used and stays.
    checkpoint : str or os.PathLike, optional
        A file to which the answer of each finished task is added. If it has answers of a call with
        the same arguments, these tasks are not run again. So the same program, run again after an
        interruption, continues.
    shared : str or os.PathLike, optional
        A folder that each node has at the same path, such as one on shared storage. Meshes that
        were loaded from baked files in it travel as paths, and each worker maps the files that its
        tasks need. Other parts travel as bytes.
    **options
        More arguments for ``ray.init``, such as ``object_store_memory``.

    Returns
    -------
    Cluster
        The argument `on` of calls within the block: of every function of two things at many poses
        or in many motions, `Scene.check`, `clash`, and the checks of a `Robot`. Answers have the
        bytes of a call without `on`, for any number of nodes, also if some of them end during the
        call. A call uses the parts as they are when it starts. Ctrl-C interrupts it. Each node must
        have the same version of impinge.

    Raises
    ------
    ClusterError
        If Ray is not installed, if the connection fails, or, by a call, if a task fails.
    InputError
        If `shared` is not a folder, or, by a call, if a worker has another file at the path of a
        part, or a damaged one.
    OSError
        If the checkpoint cannot be read or written.

    Examples
    --------
    ::

        with impinge.cluster.ray(address="auto", checkpoint="night.ndjson") as cluster:
            report = scene.check(question="penetrates", stop="all", on=cluster)
    """
    folder = None if shared is None else os.path.abspath(path_of(shared, "shared"))
    if folder is not None and not os.path.isdir(folder):
        raise InputError(f"{folder!r} is not a folder", kind="option", what="shared")
    engine = _imported()
    is_ours = not engine.is_initialized()
    if is_ours:
        try:
            engine.init(address, **{**_QUIET, **options})
        except (ConnectionError, RuntimeError, ValueError) as error:
            message = f"cannot connect to Ray at {address or 'this machine'}: {error}"
            raise ClusterError(f"{message}; `ray start --head` starts a cluster") from error
    try:
        kept = None if checkpoint is None else Checkpoint(path_of(checkpoint, "checkpoint"))
        cluster = Cluster(engine, kept, folder)
        try:
            yield cluster
        finally:
            cluster._close()
    finally:
        if is_ours:
            engine.shutdown()


_QUIET = {"log_to_driver": False, "logging_level": "ERROR", "include_dashboard": None}
"""Arguments of ``ray.init`` that keep its messages out of the output."""


def _imported() -> Any:
    try:
        return importlib.import_module("ray")
    except ModuleNotFoundError as error:
        if error.name != "ray":
            raise
        raise ClusterError(f"Ray is not installed: {_INSTALL}") from None
