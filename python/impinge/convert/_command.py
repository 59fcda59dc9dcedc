"""The command ``python -m impinge.convert``."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from impinge.convert._convert import ConversionError, convert


def main(arguments: Sequence[str]) -> int:
    """Run the command. Return 0, or 2 if the model was not converted."""
    parser = argparse.ArgumentParser("python -m impinge.convert", description="Converts IFC and STEP models to GLB.")
    parser.add_argument("model", help="a file .ifc, .step or .stp")
    parser.add_argument("-o", "--output", help="the GLB file (default: beside the model)")
    parser.add_argument("--sag", type=float, help="maximum distance of triangles from a curved surface, in meters")
    options = parser.parse_args(arguments)
    output = options.output or os.path.splitext(options.model)[0] + ".glb"
    try:
        parts = convert(options.model, output, sag=options.sag)
    except (OSError, ValueError, ConversionError) as error:
        sys.stderr.write(f"impinge: error: {error}\n")
        return 2
    sys.stderr.write(f"{output}: {parts} parts\n")
    return 0
