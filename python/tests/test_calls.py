"""How calls behave: threads, the interpreter's lock, signals, forks, memory, overhead."""

import gc
import multiprocessing
import os
import pickle
import signal
import threading
import time
from pathlib import Path

import impinge
import numpy as np
import pytest
from shapes import cube, random_poses, torus

TORUS = impinge.Mesh(*torus())
CUBE = impinge.Mesh(*cube())


def test_a_call_equals_a_loop_for_any_number_of_threads():
    poses = random_poses(300, 2.0, 5)
    answers = []
    for n in (1, 2, 5):
        with impinge.threads(n):
            answers.append((impinge.intersects(TORUS, TORUS, poses), impinge.intersecting_pairs(TORUS, TORUS, poses)))
    hits, pairs = answers[0]
    assert 0.3 < hits.mean() < 0.95
    for other_hits, other_pairs in answers[1:]:
        assert np.array_equal(hits, other_hits)
        assert np.array_equal(pairs.rows, other_pairs.rows)
        assert np.array_equal(pairs.offsets, other_pairs.offsets)
    assert hits.tolist() == [impinge.intersects(TORUS, TORUS, pose) for pose in poses]
    assert all(np.array_equal(pairs[i], impinge.intersecting_pairs(TORUS, TORUS, pose)) for i, pose in enumerate(poses))


def _long_call():
    return impinge.intersecting_pairs(TORUS, TORUS, random_poses(200_000, 1.0, 1), limit=1)


def test_progress_is_one_line_that_is_cleared(capsys):
    poses = random_poses(60_000, 1.0, 1)
    scene = impinge.Scene({"a": TORUS, "b": TORUS})
    for ask in (
        lambda: impinge.intersecting_pairs(TORUS, TORUS, poses[:20_000], limit=1, progress=True),
        lambda: impinge.distance(TORUS, TORUS, poses[:4_000], progress=True),
        lambda: scene.check({"a": poses}, stop="all", progress=True),
    ):
        with impinge.threads(1):
            ask()
        out, err = capsys.readouterr()
        assert out == ""
        shown = err.split("\r")
        assert shown[-1] == ""
        assert shown[-2].strip() == ""
        assert len(err) > 0, "a call of a second and no line"
        assert all(text.startswith("impinge: ") and " of " in text for text in shown[1:-2])
    impinge.intersects(CUBE, CUBE, poses[:3], progress=True)  # too short for a progress line
    assert capsys.readouterr().err == ""


def test_a_call_ends_if_its_progress_line_cannot_be_written(monkeypatch):
    class Closed:
        def write(self, text):
            raise OSError("closed")

        def flush(self):
            pass

    monkeypatch.setattr("sys.stderr", Closed())
    with pytest.raises(OSError, match="closed"):
        impinge.intersecting_pairs(TORUS, TORUS, random_poses(200_000, 1.0, 1), limit=1, progress=True)


@pytest.mark.usefixtures("ctrl_c_raises_keyboard_interrupt")
def test_ctrl_c_ends_a_long_call_within_a_fraction_of_a_second():
    sent = []

    def interrupt():
        sent.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(0.3, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        _long_call()
    assert time.perf_counter() - sent[0] < 0.5
    timer.join()
    assert impinge.intersects(TORUS, TORUS)  # the next call works


def _round_sheet(n, radius):
    """Returns a sphere without its poles, with 4 n² faces."""
    polar, around = np.meshgrid(
        np.linspace(0.1, np.pi - 0.1, n + 1), np.linspace(0, 2 * np.pi, 2 * n + 1), indexing="ij"
    )
    sine = np.sin(polar)
    vertices = radius * np.stack([sine * np.cos(around), sine * np.sin(around), np.cos(polar)], axis=-1).reshape(-1, 3)
    first = (np.arange(n)[:, None] * (2 * n + 1) + np.arange(2 * n)).ravel()
    below = first + 2 * n + 1
    return impinge.Mesh(vertices, np.vstack([np.c_[first, below, below + 1], np.c_[first, below + 1, first + 1]]))


def _repeat(ask, a, b):
    for _ in range(10_000):
        ask(a, b)


@pytest.mark.usefixtures("ctrl_c_raises_keyboard_interrupt")
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_query_about_one_pose(threads):
    inner, outer = _round_sheet(300, 1.0), _round_sheet(300, 1.1)
    sent = []

    def interrupt():
        sent.append(time.perf_counter())
        signal.raise_signal(signal.SIGINT)

    # All faces are equally near, so the search is slow.
    with impinge.threads(threads):
        for ask in (impinge.distance, lambda a, b: impinge.within(a, b, 0.0995)):
            timer = threading.Timer(0.01, interrupt)
            timer.start()
            with pytest.raises(KeyboardInterrupt):
                _repeat(ask, inner, outer)
            assert time.perf_counter() - sent[-1] < 0.25
            timer.join()
        assert not impinge.intersects(inner, outer)


def test_other_threads_run_during_a_call():
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(time.perf_counter())

    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.perf_counter()
    impinge.intersecting_pairs(TORUS, TORUS, random_poses(10_000, 1.0, 1), limit=1)
    seconds = time.perf_counter() - start
    done.set()
    ticker.join()
    assert seconds > 0.1
    assert len(ticks) > 5
    assert max(np.diff([start, *ticks])) < seconds / 2


def test_threads_may_call_at_the_same_time():
    poses = random_poses(400, 2.0, 9)
    expected = impinge.intersects(TORUS, TORUS, poses)
    answers = [None] * 6

    def ask(i):
        with impinge.threads(1 + i % 3):
            answers[i] = impinge.intersects(TORUS, TORUS, poses)

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(len(answers))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(answer, expected) for answer in answers)


def _in_child(queue, poses):
    made = impinge.Mesh(*torus())
    single = impinge.intersecting_pairs(made, TORUS, poses[0])
    first = impinge.intersects(made, TORUS, poses[0])
    # Enough pairs that the library would distribute their lookup, from the calling thread.
    square = impinge.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.tile([[0, 1, 2]], (300, 1)))
    queue.put((impinge.intersects(TORUS, made, poses), single, first, len(impinge.intersecting_pairs(square, square))))


@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_fork_after_a_parallel_call_does_not_hang():
    poses = random_poses(500, 2.0, 3)
    hits = impinge.intersects(TORUS, TORUS, poses)  # starts the threads of this process's pool
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_in_child, args=(queue, poses))
    child.start()
    try:
        in_child, single, first, many = queue.get(timeout=60)
    finally:
        child.join(10)
        child.kill()
    assert np.array_equal(in_child, hits)
    assert np.array_equal(single, impinge.intersecting_pairs(TORUS, TORUS, poses[0]))
    assert first == hits[0]
    assert many == 300 * 300
    assert child.exitcode == 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_mesh_pickles_without_copies_of_its_arrays(dtype):
    vertices, faces = torus()
    mesh = impinge.Mesh(vertices.astype(dtype), faces)
    buffers = []
    head = pickle.dumps(mesh, protocol=5, buffer_callback=buffers.append)
    assert len(head) < 1000
    assert sorted(b.raw().nbytes for b in buffers) == sorted([mesh.vertices.nbytes, mesh.faces.nbytes])
    for other in (pickle.loads(head, buffers=buffers), pickle.loads(pickle.dumps(mesh))):
        assert np.array_equal(other.vertices, mesh.vertices)
        assert other.vertices.dtype == dtype
        assert np.array_equal(other.faces, mesh.faces)
        assert np.array_equal(impinge.intersecting_pairs(other, TORUS), impinge.intersecting_pairs(mesh, TORUS))


def test_errors_pickle():
    with pytest.raises(impinge.InputError) as caught:
        impinge.intersects(CUBE, CUBE, np.full((2, 4, 4), np.nan))
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.kind, copy.what, copy.where) == (
        str(caught.value),
        "non-finite",
        "pose_a",
        caught.value.where,
    )


def test_a_million_poses_do_not_leak():
    resource = pytest.importorskip("resource")
    poses = random_poses(250_000, 2.0, 3)
    impinge.intersects(CUBE, CUBE, poses)
    peaks = []
    for _ in range(4):
        impinge.intersects(CUBE, CUBE, poses)
        gc.collect()
        peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert peaks[-1] - peaks[0] < 8_000  # kilobytes; one call has answers of 250 and poses of 30,000


def _overcommits():
    setting = Path("/proc/sys/vm/overcommit_memory")
    return not setting.exists() or setting.read_text().strip() == "1"


@pytest.mark.skipif(_overcommits(), reason="this system grants memory that it does not have")
def test_more_rows_than_fit_into_memory_raise_an_error():
    poses = np.tile(np.eye(4), (1 << 18, 1, 1))  # 32 MiB of poses, broadcast to 2^36 rows
    with pytest.raises(MemoryError):
        impinge.intersecting_pairs(CUBE, CUBE, poses[:, None], poses)


def test_a_call_with_one_pose_has_little_overhead():
    a = impinge.Mesh(*cube())
    far = impinge.pose([100, 0, 0])
    runs = []
    for _ in range(50):
        start = time.perf_counter()
        for _ in range(200):
            impinge.intersects(a, a, None, far)
        runs.append((time.perf_counter() - start) / 200)
    assert min(runs) < 20e-6  # about 1 us on an idle machine: see docs/python.md


def test_a_single_query_of_large_meshes_does_not_wait_for_threads():
    resource = pytest.importorskip("resource")
    if not hasattr(resource, "RUSAGE_THREAD"):
        pytest.skip("this system does not count what one thread waits")
    sheet = _round_sheet(200, 1.0)
    crossing = impinge.pose([0.3, 0.2, 0.1])
    assert impinge.intersects(sheet, sheet, None, crossing)
    before = resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw
    for _ in range(100):
        impinge.intersects(sheet, sheet, None, crossing)
    waits = resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw - before
    assert waits < 50  # waiting for another thread is a voluntary context switch
