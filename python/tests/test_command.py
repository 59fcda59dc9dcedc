"""The `impinge` command that the package installs, as a script and as a module."""

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path

import impinge
import pytest
from impinge import _command

HUMAN = str(Path(__file__).resolve().parents[2] / "data" / "human_makehuman_cc0.ply")
SCRIPT = [shutil.which("impinge", path=sysconfig.get_path("scripts")) or "no script impinge is installed"]
MODULE = [sys.executable, "-m", "impinge"]

either = pytest.mark.parametrize("command", [pytest.param(SCRIPT, id="script"), pytest.param(MODULE, id="module")])
on_unix = pytest.mark.skipif(sys.platform == "win32", reason="needs signals and named pipes")


def run(command, *arguments, **options):
    return subprocess.run([*command, *arguments], capture_output=True, text=True, check=False, timeout=300, **options)


@either
def test_the_version_is_that_of_the_package(command):
    done = run(command, "--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"impinge {impinge.__version__}\n", "")


@either
@pytest.mark.parametrize(("shift", "code"), [("5,0,0", 0), ("0.4,0,0", 1)])
def test_the_exit_code_says_whether_meshes_intersect(command, shift, code):
    done = run(command, "check", HUMAN, HUMAN, "--pose-b", shift, "--json")
    assert (done.returncode, done.stderr) == (code, "")
    answer = json.loads(done.stdout)
    human = impinge.load(HUMAN)
    pairs = impinge.intersecting_pairs(human, human, pose_b=impinge.pose([float(x) for x in shift.split(",")]))
    assert (answer["intersects"], answer["pairs"]) == (code == 1, len(pairs))


@either
def test_errors_exit_with_2_and_a_message(command):
    done = run(command, "check", HUMAN, "missing.stl", "--json")
    assert done.returncode == 2
    error = json.loads(done.stdout)["error"]
    assert (error["kind"], error["file"]) == ("io", "missing.stl")
    assert done.stderr.startswith("error: missing.stl: ")
    assert "Traceback" not in done.stderr


@either
def test_wrong_arguments_exit_with_2(command):
    done = run(command, "check", HUMAN)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: ")


@either
def test_no_arguments_exit_with_2_and_the_help(command):
    done = run(command)
    assert (done.returncode, done.stdout) == (2, "")
    assert "Usage: impinge [OPTIONS] <COMMAND>" in done.stderr
    assert "\nExamples:\n  impinge check " in done.stderr


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="counts the processors of the process")
def test_the_command_uses_all_processors():
    environment = {key: value for key, value in os.environ.items() if key != "RAYON_NUM_THREADS"}
    done = run(SCRIPT, "world", "--bodies", "10", "--steps", "1", "--json", env=environment)
    assert json.loads(done.stdout)["threads"] == len(os.sched_getaffinity(0))


@on_unix
def test_a_closed_pipe_does_not_change_the_exit_code():
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [*SCRIPT, "check", HUMAN, HUMAN]
        done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False, timeout=300)
    finally:
        os.close(writer)
    assert (done.returncode, done.stderr) == (1, "")


@on_unix
def test_an_interrupt_ends_the_command_with_2():
    command = [*SCRIPT, "check", "-", HUMAN, "--format", "obj", "--json"]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as child:
        # A pipe holds far less than this, so the command reads when writing ends.
        child.stdin.write("\n" * (1 << 20))
        child.stdin.flush()
        child.send_signal(signal.SIGINT)
        child.wait(timeout=300)
        stdout, stderr = child.stdout.read(), child.stderr.read()
    assert child.returncode == 2
    assert stderr == "error: interrupted before the answer was known\n"
    assert json.loads(stdout)["complete"] is False


def test_output_printed_before_the_command_comes_first():
    program = "from impinge._command import main; print('before'); code = main(); print('after', code)"
    done = run([sys.executable, "-c", program], "--version")
    assert done.stdout == f"before\nimpinge {impinge.__version__}\nafter 0\n"


def test_an_internal_error_exits_with_2(monkeypatch, capsys):
    def broken(_arguments):
        raise RuntimeError("a defect")

    monkeypatch.setattr(_command, "run_command", broken)
    assert _command.main() == 2
    assert "RuntimeError: a defect" in capsys.readouterr().err
