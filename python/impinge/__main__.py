"""Runs the `impinge` command: ``python -m impinge check a.stl b.stl``."""

import sys

from impinge._command import main

if __name__ == "__main__":
    sys.exit(main())
