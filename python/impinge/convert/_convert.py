"""Chooses the program that reads a model, and writes the result."""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib import import_module

from impinge._errors import InputError
from impinge._scalars import path_of, real
from impinge.convert._glb import Glb

_READERS = {".ifc": "_ifc", ".step": "_step", ".stp": "_step"}
"""Modules that read models, by the extension of the file in lower case."""


class ConversionError(RuntimeError):
    """A model cannot be converted: a package is missing, or it cannot read the model."""


def convert(model: str | os.PathLike[str], output: str | os.PathLike[str], *, sag: float | None = None) -> int:
    """Convert an IFC or STEP model to GLB. Return the number of parts.

    Each part keeps its name, its type, its key (the GlobalId of IFC) and its path, as `load_scene`
    reads them. Parts with one shape share its mesh. Lengths are in meters, and the axes are those
    of the model.

    Parameters
    ----------
    model : str or os.PathLike
        A file whose name ends in ``.ifc``, ``.step`` or ``.stp``.
    output : str or os.PathLike
        The GLB file, which is replaced if it exists.
    sag : float, optional
        Maximum distance between a curved surface and its triangles, in meters. The default is
        0.001 for IFC and 0.0001 for STEP.

    Returns
    -------
    int
        Number of parts with a shape.

    Raises
    ------
    ConversionError
        If a package is missing, or if the model cannot be read.
    OSError, InputError
        If a file cannot be read or written, or if the extension is another one.
    """
    path, target = path_of(model, "model"), path_of(output, "output")
    length = None if sag is None else real(sag, "sag", minimum=0)
    if length == 0:
        raise InputError("must be above zero", kind="option", what="sag")
    extension = os.path.splitext(path)[1].lower()
    if extension not in _READERS:
        message = f"{path}: cannot convert {extension or 'a file without an extension'}"
        hint = f"the extensions are {', '.join(_READERS)}"
        raise InputError(message, kind="unsupported-format", what="model", hint=hint)
    with open(path, "rb"):  # a missing file is reported before a missing package
        pass
    try:
        read: Callable[[str, float | None], Glb] = import_module(f"impinge.convert.{_READERS[extension]}").read
    except ImportError as error:
        extra = {"_ifc": "ifc", "_step": "step"}[_READERS[extension]]
        raise ConversionError(f'{path}: {error.name} is missing: pip install "impinge[{extra}]"') from error
    try:
        glb = read(path, length)
    except (RuntimeError, ValueError) as error:
        raise ConversionError(f"{path}: {error}") from error
    glb.write(target)
    return glb.parts
