"""Buffers of baked meshes: used in place if nobody can write to them, and copied otherwise."""

import copy
import gc
import mmap
import sys
import weakref

import impinge
import numpy as np
import pytest
from shapes import random_poses, torus

MESH = impinge.Mesh(*torus())
BAKED = MESH.to_baked()
ALIGNMENT = 64


def constant(content, offset=0):
    """Returns an array that nobody can write, whose address is `offset` beyond a multiple of 64.

    An object of `bytes` starts at a multiple of 16, so one of four copies is at the right place.
    """
    pitch = -(-len(content) // ALIGNMENT) * ALIGNMENT + ALIGNMENT + 16
    owner = b"".join((b"\0" * offset + content).ljust(pitch, b"\0") for _ in range(4))
    array = np.frombuffer(owner, np.uint8)
    start = next(at for at in range(0, 4 * pitch, pitch) if (array.ctypes.data + at) % ALIGNMENT == 0) + offset
    return array[start : start + len(content)]


def is_alive(reference):
    gc.collect()
    return reference() is not None


@pytest.mark.parametrize("offset", [0, 1, 4, 16, 32])
def test_constant_bytes_are_used_in_place_if_they_are_aligned(offset):
    array, poses = constant(BAKED, offset), random_poses(30, 2.5, 6)
    mesh = impinge.Mesh.from_baked(array)
    owner = weakref.ref(array)
    del array
    assert is_alive(owner) == (offset == 0)
    hits = impinge.intersects(mesh, MESH, None, poses)
    assert 0 < hits.sum() < 30
    assert np.array_equal(hits, impinge.intersects(MESH, MESH, None, poses))
    assert mesh.to_baked() == BAKED


def test_the_buffer_is_alive_until_the_last_mesh_that_uses_it_is_gone():
    array = constant(BAKED)
    mesh = impinge.Mesh.from_baked(array)
    copied = copy.copy(mesh)
    mesh.refit(MESH.vertices + 1)
    mesh.rebuild("median")
    assert array.tobytes() == BAKED  # changes go to memory of the mesh's own
    assert np.array_equal(mesh.vertices, MESH.vertices + 1)
    owner = weakref.ref(array)
    del array, mesh
    assert is_alive(owner)
    assert np.array_equal(copied.vertices, MESH.vertices)
    del copied
    assert not is_alive(owner)


def writable_buffers():
    """Returns buffers that can be written, or whose owner can, all at a multiple of 64."""
    room = np.zeros(len(BAKED) + ALIGNMENT, np.uint8)
    array = room[-room.ctypes.data % ALIGNMENT :][: len(BAKED)]
    array[:] = np.frombuffer(BAKED, np.uint8)
    frozen = array.view()
    frozen.setflags(write=False)
    own = np.zeros(len(BAKED) + ALIGNMENT, np.uint8)
    start = -own.ctypes.data % ALIGNMENT
    own[start:][: len(BAKED)] = array
    own.setflags(write=False)
    views = {
        "an array": array,
        "a read-only view of an array": frozen,
        "an array that can be made writable": own[start:][: len(BAKED)],
        "a read-only view of a buffer": np.frombuffer(memoryview(array).toreadonly(), np.uint8),
    }
    return [pytest.param(view, id=name) for name, view in views.items()]


@pytest.mark.parametrize("buffer", writable_buffers())
def test_memory_that_can_be_written_is_copied(buffer):
    assert buffer.ctypes.data % ALIGNMENT == 0
    array = buffer.view()
    mesh = impinge.Mesh.from_baked(array)
    owner = weakref.ref(array)
    del array
    assert not is_alive(owner)
    assert mesh.to_baked() == BAKED


def test_a_mapped_file_is_used_in_place(tmp_path):
    path = tmp_path / "torus.impinge"
    path.write_bytes(BAKED)
    with open(path, "rb") as file:
        content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    mesh = impinge.Mesh.from_baked(content)
    with pytest.raises(BufferError):
        content.close()
    assert mesh.to_baked() == BAKED
    del mesh
    gc.collect()
    content.close()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the memory of the process from /proc")
def test_a_mesh_in_place_takes_no_memory_for_its_hierarchy():
    baked = impinge.Mesh(*torus(600, 400)).to_baked()
    array = constant(baked)

    def growth(buffer):
        gc.collect()
        before = resident()
        mesh = impinge.Mesh.from_baked(buffer)
        return mesh, resident() - before

    copied, with_copy = growth(bytearray(baked))
    in_place, without = growth(array)
    assert len(baked) > 16 << 20
    assert with_copy > 0.9 * len(baked)
    assert without < 0.4 * len(baked)  # the origin of the faces, and what the allocator keeps
    assert impinge.intersects(in_place, copied)


def resident():
    """Returns the number of bytes of memory that the process uses."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * mmap.PAGESIZE


def test_damaged_bytes_in_place_are_rejected_or_give_the_same_mesh():
    rejected = 0
    for at in range(0, len(BAKED), 997):
        spoilt = bytearray(BAKED)
        spoilt[at] ^= 0x40
        try:
            mesh = impinge.Mesh.from_baked(constant(bytes(spoilt)))
        except impinge.InputError:
            rejected += 1
        else:
            assert np.array_equal(mesh.vertices, MESH.vertices)
            assert np.array_equal(mesh.faces, MESH.faces)
    assert rejected > 0.8 * len(range(0, len(BAKED), 997))
