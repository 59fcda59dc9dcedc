"""Checks of the package by type checkers and linters."""

import inspect
import shutil
import subprocess
import sys
from pathlib import Path

import impinge
import impinge.cluster
import impinge.fcl
import impinge.fit
import impinge.trimesh
import pytest

ROOT = Path(__file__).resolve().parents[2]


def run(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(["mypy", "--cache-dir", "target/mypy"], id="mypy"),
        pytest.param(["stubtest", "impinge._impinge", "--ignore-disjoint-bases"], id="stubtest"),
        pytest.param(["ruff", "check", "--no-cache"], id="ruff"),
        pytest.param(["ruff", "format", "--check", "--no-cache"], id="format"),
    ],
)
def test_checkers_find_no_problem(command):
    program = shutil.which(command[0], path=Path(sys.executable).parent)
    assert program, f"python/requirements-test.txt installs {command[0]}"
    run(program, *command[1:])


def test_wrong_options_are_type_errors(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(
        "import impinge\nmesh = impinge.load('a.obj')\n"
        "impinge.intersects(mesh, mesh, solid='c')\n"
        "impinge.distance(mesh, mesh, on_error='ignore')\n"
        "impinge.within(mesh, mesh)\n"
        "impinge.penetrates(mesh, mesh, solid=True)\n"
        "impinge.intersecting_pairs(mesh, mesh, limt=3)\n"
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", "target/mypy", str(program)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert [f":{line}: error" in done.stdout for line in range(1, 8)] == [False] * 2 + [True] * 5, done.stdout


def test_inferred_types_are_precise(tmp_path):
    """Strict mypy infers precise types in a program that uses the package."""
    program = tmp_path / "program.py"
    program.write_text(
        "import impinge\nimport numpy as np\nfrom typing import assert_type\n"
        "mesh = impinge.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))\n"
        "assert_type(impinge.intersects(mesh, mesh), bool)\n"
        "hit: bool | np.ndarray = impinge.intersects(mesh, mesh, np.eye(4))\n"
        "assert_type(impinge.within(mesh, mesh, 0.5, solid='a'), bool)\n"
        "assert_type(impinge.penetrates(mesh, mesh), bool)\n"
        "assert_type(impinge.distance(mesh, mesh, np.eye(4), progress=True), impinge.Distance)\n"
        "far, status = impinge.distance(mesh, mesh, np.eye(4), solid=True, on_error='status')\n"
        "assert_type(far, impinge.Distance)\n"
        "assert_type(mesh.ray_cast([0, 0, 0], [0, 0, 1]), impinge.RayHit)\n"
        "assert_type(impinge.minimal_sphere([[0, 0, 0]]).radius, float)\n"
        "box = impinge.Shape.box([1, 1, 1])\n"
        "assert_type(impinge.intersects(box, mesh), bool)\n"
        "assert_type(impinge.contacts(box, box), impinge.Contacts)\n"
        "assert_type(impinge.penetration(box, box, np.eye(4)), impinge.Penetration)\n"
        "assert_type(impinge.World().step().work.changed, int)\n"
        "impinge.intersecting_pairs(mesh, mesh).sum()\n"
        "pairs = impinge.intersecting_pairs(mesh, mesh, np.eye(4)[None])\n"
        "assert isinstance(pairs, impinge.Pairs) and pairs.counts.sum() == 0\n"
        "answer, status = impinge.intersects(mesh, mesh, on_error='status')\n"
        "def shared(on: impinge.cluster.Cluster) -> impinge.Impact:\n"
        "    assert_type(impinge.contacts(box, box, on=on), impinge.Contacts)\n"
        "    assert_type(impinge.depth(box, box, np.eye(4), on=on), impinge.Depth)\n"
        "    return impinge.time_of_impact(box, mesh, on=on)\n"
        "print(impinge.Status(int(status[0])).name, impinge.load('a.obj').origin)\n"
    )
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nstrict = True\n")
    run(sys.executable, "-m", "mypy", "--cache-dir", "target/mypy", "--config-file", str(config), str(program))


@pytest.mark.parametrize(
    "module", [impinge, impinge.cluster, impinge.fcl, impinge.fit, impinge.partition, impinge.trimesh]
)
def test_every_public_name_is_documented(module):
    for name in module.__all__:
        thing = getattr(module, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert inspect.getdoc(value), f"{name}.{member}"
