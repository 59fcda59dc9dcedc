"""The `impinge` command, which runs as an installed script and as ``python -m impinge``."""

from __future__ import annotations

import sys
import traceback

from impinge._impinge import run_command

_NO_ANSWER = 2


def main() -> int:
    """Run the command with the arguments of this process and return its exit code.

    The exit code is 0 for "clear", 1 for "collision" and 2 for no answer. An interrupt ends the
    process with 2.
    """
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()  # the command writes to the file descriptors, past these buffers
    try:
        return run_command(sys.argv[1:])
    except BaseException:  # if it left this function, the interpreter would exit with 1, which means "collision"
        traceback.print_exc()
        return _NO_ANSWER
