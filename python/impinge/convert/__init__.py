"""Converts building and CAD models to GLB, which impinge loads: ``python -m impinge.convert``.

IFC needs ``pip install "impinge[ifc]"``, STEP needs ``pip install "impinge[step]"``.
"""

from impinge.convert._convert import ConversionError, convert

__all__ = ["ConversionError", "convert"]
