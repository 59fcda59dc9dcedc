"""The circumstances of a benchmark run: date, machine, commit and versions."""

import os
import platform
import shlex
import subprocess
import sys
from datetime import date
from importlib.metadata import version
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent


def circumstances(*packages: str) -> dict[str, str]:
    """Return the circumstances of this run by name, with the versions of the given packages."""
    cpus = [line.split(":", 1)[1].strip() for line in read_lines("/proc/cpuinfo") if line.startswith("model name")]
    return {
        "date": date.today().isoformat(),
        "command": shlex.join(["python", *sys.argv]),
        "cpu": f"{cpus[0] if cpus else platform.processor()}, {os.cpu_count()} cores",
        "load before": f"{os.getloadavg()[0]:.2f}",
        "commit": output("git", "describe", "--always", "--dirty"),
        "rustc": output("rustc", "--version"),
        "python": platform.python_version(),
        **{package: version(package) for package in packages},
        "numpy": np.__version__,
    }


def read_lines(path: str) -> list[str]:
    """Return the lines of a file, or an empty list if it does not exist."""
    return Path(path).read_text().splitlines() if Path(path).exists() else []


def output(*command: str) -> str:
    """Run a command in the root of the project, and return its standard output, stripped.

    Raise a `subprocess.CalledProcessError` if it fails.
    """
    return subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True).stdout.strip()


def print_circumstances(about: dict[str, str], note: str) -> None:
    """Print the circumstances of the run, and a note on how to read the numbers."""
    for name, value in about.items():
        print(f"- {name}: `{value}`")
    print(f"\n{note}\n")
