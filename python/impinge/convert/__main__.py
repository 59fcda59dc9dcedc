"""``python -m impinge.convert``."""

import sys

from impinge.convert._command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
