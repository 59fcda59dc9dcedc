"""Small inputs with large answers: errors instead of an aborted process."""

import os
import signal
import subprocess
import sys
import textwrap
import threading

import impinge
import numpy as np
import pytest

BEGINNING = """
import os, resource, sys, threading
import numpy as np
import impinge
from impinge import partition

def limit(megabytes):
    pages = int(open("/proc/self/statm").read().split()[0])
    most = pages * resource.getpagesize() + (megabytes << 20)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))

def raised(call):
    try:
        call()
    except Exception as error:
        return type(error).__name__
    return None
"""


def output(code):
    """Returns what a program of its own prints."""
    code = BEGINNING + textwrap.dedent(code)
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code], check=False, capture_output=True, text=True, timeout=240
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.split()


only_linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits the memory of a process")


@only_linux
@pytest.mark.parametrize(
    "call",
    [
        "partition.pairs(low, low + 1)",
        "partition.BoxTree(low, low + 1).pairs()",
        "partition.BoxTree(low, low + 1).pairs_with(partition.BoxTree(low, low + 1))",
        "partition.HashedGrid(1.0, low, low + 1).pairs()",
        "partition.SweepOneAxis('x', low, low + 1).pairs()",
    ],
)
def test_pairs_without_memory_are_a_memory_error(call):
    found = output(f"""
        low = np.zeros((20_000, 3))
        few = low[:100]
        partition.pairs(few, few + 1)  # starts the threads
        limit(400)
        print(raised(lambda: {call}), len(partition.pairs(few, few + 1)))
    """)
    assert found == ["MemoryError", "4950"]


@only_linux
def test_a_step_without_memory_leaves_the_world_as_it_was():
    found = output("""
        world = impinge.World(narrow_phase="boxes")
        sphere = impinge.Shape.sphere(1.0)
        spread = np.tile(np.eye(4), (12_000, 1, 1))
        spread[:, 0, 3] = 3.0 * np.arange(len(spread))
        bodies = world.insert(sphere, spread)
        world.step()
        limit(400)
        together = np.tile(np.eye(4), (12_000, 1, 1))
        print(raised(lambda: world.step(bodies, together)))
        print(np.array_equal(world.poses(bodies), spread), len(world.step().began))
        spread[1, 0, 3] = 1.0
        print(len(world.step(bodies, spread).began))
    """)
    assert found == ["MemoryError", "True", "0", "1"]


@only_linux
def test_a_mesh_without_memory_is_a_memory_error():
    found = output("""
        vertices = np.zeros((3, 3))
        impinge.Mesh(vertices, np.zeros((9, 3), np.uint32))  # starts the threads
        narrow, wide = [np.zeros((10_000_000, 3), dtype) for dtype in (np.uint32, np.int64)]
        limit(400)
        print(raised(lambda: impinge.Mesh(vertices, narrow)))
        print(raised(lambda: impinge.Mesh(vertices, wide)))
    """)
    assert found == ["MemoryError"] * 2


def test_compounds_of_compounds_have_a_maximum_number_of_parts():
    many = impinge.Shape.compound([(impinge.Shape.sphere(1.0), None)] * 2048)
    with pytest.raises(impinge.InputError, match="4194304 parts are too many: the maximum is 1048576") as caught:
        impinge.Shape.compound([(many, None)] * 2048)
    assert (caught.value.kind, caught.value.what) == ("too-many", "parts")


@only_linux
def test_a_state_with_a_large_handle_is_refused_before_memory_is_allocated():
    found = output("""
        from impinge import _impinge
        world = impinge.World()
        world.insert(impinge.Shape.sphere(1.0))
        data = list(world.save().data())
        data[2] = (np.array([(2**32 - 2) << 32 | 1], np.uint64), *data[2][1:])
        limit(400)
        print(raised(lambda: _impinge.WorldState(tuple(data))))
    """)
    assert found == ["InputError"]


def crowd(**options):
    """Returns a world of boxes in one place, whose first step takes minutes."""
    world = impinge.World(**options)
    world.insert(impinge.Shape.hull(np.random.default_rng(5).normal(size=(200, 3))), np.tile(np.eye(4), (1500, 1, 1)))
    return world


@pytest.mark.usefixtures("ctrl_c_raises_keyboard_interrupt")
def test_an_interrupted_step_leaves_the_world_as_it_was():
    world = crowd()
    before = world.save().data()
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        world.step()
    assert len(world.pairs()) == 0
    after = world.save().data()
    assert [np.array_equal(one, other) for one, other in zip(before[2], after[2], strict=True)] == [True] * 3
    assert np.array_equal(before[4][1], after[4][1])
    # The bodies are still new, so the next step reports the pairs of those that are left.
    bodies = world.bodies
    world.remove(bodies[3:])
    assert len(world.step().began) == 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_child_forked_during_a_step_can_work():
    found = output("""
        sphere = impinge.Shape.sphere(1.0)
        idle, busy = impinge.World(), impinge.World()
        for world in (idle, busy):
            world.insert(sphere)
            world.step()
        state = busy.save()
        for world in (idle, busy):
            world.insert(sphere)
        begun, forked = threading.Event(), threading.Event()

        def wait(a, b):
            begun.set()
            forked.wait()
            return True

        busy.set_filter(wait)
        thread = threading.Thread(target=busy.step)
        thread.start()
        begun.wait()
        pid = os.fork()
        if pid == 0:
            print(len(idle), len(idle.step().began), raised(lambda: len(busy)), raised(busy.step))
            again = impinge.World()
            again.restore(state)
            again.insert(sphere)
            print(len(again.step().began), flush=True)
            os._exit(0)
        forked.set()
        thread.join()
        os.waitpid(pid, 0)
        print(len(busy), len(busy.pairs()), len(idle.step().began))
    """)
    assert found == ["2", "1", "RuntimeError", "RuntimeError", "1", "2", "1", "1"]
