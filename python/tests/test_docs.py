"""The code in the README and in the documentation pages.

The Python blocks of a page run in their order in one namespace, from the root of the repository.
The commands in console blocks are run, and their output is compared except for times.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page, language):
    """Returns the text of each block in a language; included files have tests of their own."""
    found = re.findall(rf"^( *)```{language}\n(.*?)^ *```$", page.read_text(), re.MULTILINE | re.DOTALL)
    texts = [re.sub(rf"^{indent}", "", text, flags=re.MULTILINE) for indent, text in found]
    return [text for text in texts if "--8<--" not in text]


def with_language(language):
    """Returns the pages that have blocks in a language, as test parameters."""
    pages = [page for page in PAGES if blocks(page, language)]
    return pytest.mark.parametrize("page", pages, ids=[str(page.relative_to(ROOT)) for page in pages])


@with_language("python")
def test_python_blocks_run_in_order(page, tmp_path):
    script = tmp_path / "page.py"
    script.write_text("\n".join(blocks(page, "python")))
    # The pictures that pages draw go to a folder of their own, which has the project's data.
    (tmp_path / "data").symlink_to(ROOT / "data")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def without_times(text):
    """Returns the lines of a report, except for the line of times."""
    return [line for line in text.splitlines() if not line.startswith("time ")]


@with_language("console")
def test_commands_print_the_output_that_is_shown(page, tmp_path):
    (tmp_path / "data").symlink_to(ROOT / "data")
    for block in blocks(page, "console"):
        for command, shown in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
            if not command.startswith("impinge "):
                continue
            words = [sys.executable, "-m", "impinge", *shlex.split(command)[1:]]
            done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
            assert done.returncode in (0, 1), done.stderr
            if shown:
                assert without_times(done.stdout) == without_times(shown)


def test_pages_have_code():
    assert sum(bool(blocks(page, "python")) for page in PAGES) >= 12
    assert sum(bool(blocks(page, "console")) for page in PAGES) >= 2


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(ROOT)) for page in PAGES])
def test_links_between_pages_lead_to_files(page):
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{target} in {os.fspath(page)}"
