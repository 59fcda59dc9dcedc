"""Clashes of a building beside IfcClash, on the same triangles, checked against an exact oracle.

    python3 -m venv .venv && .venv/bin/pip install -r bench/requirements.txt .
    .venv/bin/pip install ifcopenshell==0.9.0.post1 ifcclash==0.9.0
    IMPINGE_DATA=... .venv/bin/python bench/clash.py duplex AC20-FZK-Haus [--repeats 3]

The folder `clash` of IMPINGE_DATA has each building as NAME.npz, with its parts as triangles, and
NAME.truth.json, with the depth of each pair of closed parts from exact booleans. IfcClash gets an
IFC file with the same triangles. The time of impinge is that of building all meshes and of the
search. The time of IfcClash is that of adding the parts to its tree and of the search; reading the
file and its own tessellation are left out. Pairs within 2 % of the tolerance are not compared. The
run fails if impinge misses a pair that is deeper, or reports one that is not.
"""

import argparse
import json
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import Any

import ifcopenshell
import ifcopenshell.geom
import ifcopenshell.guid
import impinge
import numpy as np
import record

TOLERANCE = 0.002
CLEARANCE = 0.01

Part = tuple[str, np.ndarray, np.ndarray]
Pairs = set[frozenset[str]]


def parts_of(path: Path) -> Iterator[Part]:
    """Yield the key, the vertices and the faces of each part."""
    model = np.load(path)
    corners, ends = model["vertex_offsets"], model["face_offsets"]
    for at, key in enumerate(model["key"]):
        yield str(key), model["vertices"][corners[at] : corners[at + 1]], model["faces"][ends[at] : ends[at + 1]]


def write_ifc(parts: list[Part], path: Path) -> None:
    """Write the parts as proxies of triangles, in meters."""
    model = ifcopenshell.file(schema="IFC4")
    make = model.create_entity
    axes = make("IfcAxis2Placement3D", make("IfcCartesianPoint", (0.0, 0.0, 0.0)))
    context = make(
        "IfcGeometricRepresentationContext",
        ContextType="Model",
        CoordinateSpaceDimension=3,
        Precision=1e-7,
        WorldCoordinateSystem=axes,
    )
    units = make("IfcUnitAssignment", Units=[make("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")])
    make(
        "IfcProject",
        GlobalId=ifcopenshell.guid.new(),
        Name="parts",
        RepresentationContexts=[context],
        UnitsInContext=units,
    )
    placement = make("IfcLocalPlacement", RelativePlacement=axes)
    for key, vertices, faces in parts:
        points = make("IfcCartesianPointList3D", vertices.tolist())
        surface = make("IfcTriangulatedFaceSet", Coordinates=points, CoordIndex=(faces + 1).tolist())
        body = make(
            "IfcShapeRepresentation",
            ContextOfItems=context,
            RepresentationIdentifier="Body",
            RepresentationType="Tessellation",
            Items=[surface],
        )
        shape = make("IfcProductDefinitionShape", Representations=[body])
        make("IfcBuildingElementProxy", GlobalId=key, Name=key, ObjectPlacement=placement, Representation=shape)
    model.write(str(path))


def tessellated(path: Path) -> tuple[list[Any], list[Any]]:
    """Return the elements of an IFC file and their triangles, as IfcClash makes them."""
    model = ifcopenshell.open(str(path))
    elements = list(model.by_type("IfcElement"))
    iterator = ifcopenshell.geom.iterator(ifcopenshell.geom.settings(), model, os.cpu_count(), include=elements)
    shapes = []
    more = iterator.initialize()
    while more:
        shapes.append(iterator.get())
        more = iterator.next()
    return elements, shapes


def of_ifcclash(elements: list[Any], shapes: list[Any], mode: str) -> tuple[float, Pairs]:
    """Return the seconds of a search as IfcClash does it, and the pairs that it reports."""
    start = time.perf_counter()
    tree = ifcopenshell.geom.tree(backend="opencascade.trianglebvh")
    for shape in shapes:
        tree.add_element(shape)
    if mode == "intersection":
        found = tree.clash_intersection_many(elements, elements, tolerance=TOLERANCE, check_all=True)
    else:
        found = tree.clash_clearance_many(elements, elements, clearance=CLEARANCE, check_all=True)
    seconds = time.perf_counter() - start
    return seconds, {frozenset((each.a.get_argument(0), each.b.get_argument(0))) for each in found}


def of_impinge(parts: list[Part], mode: str) -> tuple[float, Pairs, int]:
    """Return the seconds of a search, the pairs that are deeper, and how many are undecided."""
    start = time.perf_counter()
    scene = impinge.Scene({key: impinge.Mesh(vertices, faces) for key, vertices, faces in parts})
    report = impinge.clash(scene, tolerance=TOLERANCE, clearance=CLEARANCE if mode == "clearance" else None)
    seconds = time.perf_counter() - start
    pairs = {frozenset((each.a.name, each.b.name)) for each in report}
    for each in report.duplicates:
        pairs |= {frozenset((x.name, y.name)) for x, y in combinations(each.parts, 2)}
    return seconds, pairs, report.counts["undecided"]


def wrong(pairs: Pairs, depths: dict[frozenset[str], float]) -> tuple[int, int]:
    """Return how many pairs are deeper and missed, and how many are reported and not deeper."""
    sure = {pair: depth for pair, depth in depths.items() if abs(depth - TOLERANCE) > 0.02 * TOLERANCE}
    missed = sum(depth > TOLERANCE and pair not in pairs for pair, depth in sure.items())
    return missed, sum(depth <= TOLERANCE and pair in pairs for pair, depth in sure.items())


def compare(folder: Path, name: str, repeats: int) -> None:
    """Print and record the rows of one building."""
    parts = list(parts_of(folder / f"{name}.npz"))
    truth = json.loads((folder / f"{name}.truth.json").read_text())["pairs"]
    depths = {frozenset(pair.split("|")): answer["depth"] for pair, answer in truth.items()}
    with tempfile.TemporaryDirectory() as temporary:
        file = Path(temporary) / "parts.ifc"
        write_ifc(parts, file)
        elements, shapes = tessellated(file)
    for mode, length in (("intersection", "2 mm"), ("clearance", "10 mm")):
        theirs = [of_ifcclash(elements, shapes, mode) for _ in range(repeats)]
        ours = [of_impinge(parts, mode) for _ in range(repeats)]
        for engine, runs in (("IfcClash", theirs), ("impinge", ours)):
            times, (_, pairs, *undecided) = [run[0] for run in runs], runs[0]
            middle = f"{statistics.median(times):.3f}"
            row = f"| {name} | {len(parts):,} | {mode} {length} | {engine} | {middle} | {len(pairs):,} |"
            record.seconds(f"{name} {mode}", "time", times, engine)
            if mode == "clearance":
                print(f"{row} | |", flush=True)
                continue
            missed, false = wrong(pairs, depths)
            print(f"{row} {missed} | {false} |", flush=True)
            record.row(f"{name} {mode}", "missed", "1", missed, engine)
            record.row(f"{name} {mode}", "false", "1", false, engine)
            if engine == "impinge":
                # An undecided pair is listed, too.
                assert missed == 0, name
                assert false <= undecided[0], name


def main() -> None:
    """Print a row for each building and question."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("buildings", nargs="+")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    print("| building | parts | question | engine | seconds | pairs | missed | false |")
    print("|---|---|---|---|---|---|---|---|")
    for name in arguments.buildings:
        compare(Path(os.environ["IMPINGE_DATA"]) / "clash", name, arguments.repeats)


if __name__ == "__main__":
    main()
