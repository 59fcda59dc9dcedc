"""Runs checks on a cluster from the command line: ``python -m impinge.cluster pairs SCENE...``."""

import sys

from impinge.cluster._command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
