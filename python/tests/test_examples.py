"""The programs in `examples/python`.

The output of each equals its file in `examples/expected`. The tests of `examples/rust` compare the
same files with the same programs in Rust.
"""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PROGRAMS = sorted((EXAMPLES / "python").glob("*.py"))
MOST_LINES = 59


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_the_output_equals_the_expected_file(program, tmp_path):
    done = subprocess.run([sys.executable, program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == (EXAMPLES / "expected" / f"{program.stem}.txt").read_text()


def test_both_languages_have_the_same_programs():
    names = [program.stem for program in PROGRAMS]
    assert len(names) == 10
    assert names == sorted(path.stem for path in (EXAMPLES / "rust" / "src" / "bin").glob("*.rs"))
    assert names == sorted(path.stem for path in (EXAMPLES / "expected").glob("*.txt"))


def test_programs_are_short():
    for path in [*PROGRAMS, *(EXAMPLES / "rust" / "src" / "bin").glob("*.rs")]:
        assert len(path.read_text().splitlines()) <= MOST_LINES, path
