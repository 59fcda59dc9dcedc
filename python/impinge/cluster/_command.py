"""The command ``python -m impinge.cluster``, which writes its report to stdout as JSON."""

from __future__ import annotations

import argparse
import json
import os
import sys
import traceback
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from impinge._load import load_scene
from impinge._scene import Scene
from impinge.cluster._functions import scene_call
from impinge.cluster._session import ClusterError, ray

_CLEAR, _COLLISION, _NO_ANSWER = 0, 1, 2


def main(arguments: Sequence[str]) -> int:
    """Run the command and return its exit code.

    The exit code is 0 if no pair was found, 1 if a pair was found, and 2 if there is no complete
    answer.
    """
    options = _parser().parse_args(arguments)
    try:
        report = _pairs(options)
    except (OSError, ValueError, ClusterError, MemoryError) as error:
        sys.stderr.write(f"impinge: error: {error}\n")
        return _NO_ANSWER
    except BaseException:  # if it left this function, the interpreter would exit with 1, which means "collision"
        traceback.print_exc()
        return _NO_ANSWER
    sys.stdout.write(json.dumps(report) + "\n")
    if not report["complete"]:
        return _NO_ANSWER
    return _COLLISION if report["pairs"] else _CLEAR


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m impinge.cluster", description="Runs checks on a Ray cluster.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    pairs = commands.add_parser(
        "pairs",
        help="find all pairs of parts that intersect, penetrate or come near",
        description="Finds all pairs of parts in the scenes, at the poses of the scenes, and writes them to stdout "
        "as JSON. Exit code: 0 no pair, 1 pairs found, 2 no complete answer.",
    )
    pairs.add_argument(
        "scenes", nargs="+", metavar="SCENE", help="file with parts, or folder of a baked scene; several are one scene"
    )
    questions = ("intersects", "penetrates", "within")
    pairs.add_argument("--question", choices=questions, default="intersects", help="default: %(default)s")
    pairs.add_argument("--clearance", type=float, help="for --question within, in the unit of the scenes")
    pairs.add_argument("--unit", help="unit to which all scenes are converted: um, mm, cm, in, ft or m")
    pairs.add_argument("--address", help='address of the cluster, such as "auto"; without it, this machine alone')
    pairs.add_argument(
        "--checkpoint", metavar="FILE", help="keeps finished tasks; a run with an existing FILE continues"
    )
    pairs.add_argument("--shared", metavar="DIR", help="folder that each node has; baked scenes in it are mapped there")
    return parser


def _pairs(options: argparse.Namespace) -> dict[str, Any]:
    """Return the report of all pairs. An interrupt ends the run with the pairs found so far."""
    if (options.question == "within") != (options.clearance is not None):
        raise ValueError("--clearance is needed with --question within, and only then")
    scene = scene_of(options.scenes, options.unit)
    poses = scene.poses
    parts = [(name, part, scene._solid, poses[name]) for name, part in scene.parts.items()]
    call = scene_call(parts, scene._ignored_places(), (options.question, options.clearance or 0.0), False, "raise")
    answers: dict[int, Any] = {}
    is_complete = True
    with ray(options.address, checkpoint=options.checkpoint, shared=options.shared) as cluster:
        try:
            cluster._run(call, answers, sys.stderr.isatty())
        except KeyboardInterrupt:
            is_complete = False
    _, _, found = call.merged(answers)
    return {
        "complete": is_complete,
        "tasks": [len(answers), call.count],
        "question": options.question,
        "clearance": options.clearance,
        "parts": len(parts),
        "pairs": _named(list(scene.parts), found),
    }


def scene_of(paths: Sequence[str], unit: str | None) -> Scene:
    """Return the parts of all files.

    If there are several, the name of a part begins with the number and the name of its file.
    """
    parts, poses, details, ignored, solids = {}, {}, {}, [], set()
    for at, path in enumerate(paths):
        prefix = "" if len(paths) == 1 else f"{at + 1} {os.path.basename(path)}: "
        scene = load_scene(path, unit)
        parts.update({prefix + name: part for name, part in scene.parts.items()})
        poses.update({prefix + name: pose for name, pose in scene.poses.items()})
        details.update({prefix + name: scene.details(name) for name in scene.parts})
        names = list(scene.parts)
        ignored += [(prefix + names[i], prefix + names[j]) for i, j in scene._ignored]
        solids.add(scene._solid)
    if len(solids) > 1:
        raise ValueError("the meshes of some baked scenes are solids, and those of other scenes are surfaces")
    return Scene(parts, poses=poses, details=details, ignored=ignored, solid=solids == {True})


def _named(names: list[str], pairs: NDArray[np.uint32]) -> list[list[str]]:
    return [[names[i], names[j]] for i, j in pairs.tolist()]
