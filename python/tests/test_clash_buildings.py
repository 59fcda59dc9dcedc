"""Clashes of public buildings against an exact oracle, where the data folder has them.

The largest building, the mini project, takes minutes in a build with checks, and is not among them.
"""

import json
import os
from itertools import combinations
from pathlib import Path

import impinge
import numpy as np
import pytest

FOLDER = os.environ.get("IMPINGE_DATA")

BUILDINGS = (
    "duplex",
    "AC20-FZK-Haus",
    "Ifc4_SampleHouse",
    "TallBuilding",
    "bcf_Architectural",
    "bcf_MEP",
)

NEAR = 0.02
"""Relative difference from the tolerance within which the oracle, which samples, is not sure."""


def scene(name, dtype):
    if FOLDER is None or not (Path(FOLDER) / "clash").is_dir():
        pytest.skip("IMPINGE_DATA names no folder with buildings")
    model = np.load(Path(FOLDER) / "clash" / f"{name}.npz")
    parts = {}
    corners, ends = model["vertex_offsets"], model["face_offsets"]
    for at, key in enumerate(model["key"]):
        vertices = model["vertices"][corners[at] : corners[at + 1]].astype(dtype)
        parts[str(key)] = impinge.Mesh(vertices, model["faces"][ends[at] : ends[at + 1]])
    details = {key: impinge.Details(key=key) for key in parts}
    return impinge.Scene(parts, details=details)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", BUILDINGS)
def test_pairs_that_an_exact_boolean_finds_deeper_are_reported(name, dtype):
    building = scene(name, dtype)
    truth = json.loads((Path(FOLDER) / "clash" / f"{name}.truth.json").read_text())
    for tolerance in (0.002, 1e-5):
        report = impinge.clash(building, tolerance=tolerance)
        deep = {frozenset((each.a.key, each.b.key)) for each in report}
        for each in report.duplicates:
            deep |= {frozenset((x.key, y.key)) for x, y in combinations(each.parts, 2)}
        # An undecided pair is listed, but its depth must then be about the tolerance.
        undecided = {frozenset((each.a.key, each.b.key)) for each in report if each.kind == "undecided"}
        assert len(undecided) < 0.02 * truth["candidates"]
        judged = 0
        for pair, answer in truth["pairs"].items():
            if abs(answer["depth"] - tolerance) <= NEAR * tolerance:
                continue
            assert (frozenset(pair.split("|")) in deep) == (answer["depth"] > tolerance), (pair, answer)
            judged += 1
        assert judged > 0
