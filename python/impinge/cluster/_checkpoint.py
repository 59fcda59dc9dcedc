"""Answers of finished tasks in a file, with one JSON object in each line.

A line has the fingerprint of its call, the number of the task, its answer and a checksum. Arrays
are in base64. A line that was cut off, as by a process that ended while it wrote, is ignored and
removed.
"""

from __future__ import annotations

import base64
import json
import os
import zlib
from typing import Any

import numpy as np


class Checkpoint:
    """A file of answers, which is created if it does not exist.

    Raises
    ------
    OSError
        If the file cannot be read or written.
    """

    def __init__(self, path: str) -> None:
        self._answers: dict[str, dict[int, Any]] = {}
        self._file = open(path, "a+b")  # noqa: SIM115 (`close` closes it)
        self._file.seek(0)
        end = 0
        for line in self._file:
            if line.endswith(b"\n"):
                end += len(line)
                self._read(line)
        self._file.truncate(end)
        self._file.seek(0, os.SEEK_END)

    def _read(self, line: bytes) -> None:
        try:
            record = json.loads(line)
            if record.pop("crc") == _checksum(record):
                self._answers.setdefault(record["call"], {})[record["task"]] = _decoded(record["answer"])
        except (ValueError, KeyError, TypeError, AttributeError):
            return  # the line is damaged, so its task is run again

    def answers(self, call: str) -> dict[int, Any]:
        """Return the answers of a call by the numbers of their tasks."""
        return dict(self._answers.get(call, {}))

    def add(self, call: str, task: int, answer: Any) -> None:
        """Write the answer of a task."""
        record = {"call": call, "task": task, "answer": _encoded(answer)}
        line = json.dumps({**record, "crc": _checksum(record)}, separators=(",", ":"))
        self._file.write(line.encode() + b"\n")
        self._file.flush()
        self._answers.setdefault(call, {})[task] = answer

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _checksum(record: dict[str, Any]) -> int:
    return zlib.crc32(json.dumps(record, sort_keys=True).encode())


def _encoded(answer: Any) -> Any:
    if isinstance(answer, np.ndarray):
        content = base64.b64encode(np.ascontiguousarray(answer).tobytes()).decode()
        return {"dtype": answer.dtype.str, "shape": list(answer.shape), "base64": content}
    if isinstance(answer, tuple | list):
        return {"tuple" if isinstance(answer, tuple) else "list": [_encoded(item) for item in answer]}
    return answer


def _decoded(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    if "dtype" in value:
        content = base64.b64decode(value["base64"], validate=True)
        return np.frombuffer(content, value["dtype"]).reshape(value["shape"]).copy()
    if "tuple" in value:
        return tuple(_decoded(item) for item in value["tuple"])
    return [_decoded(item) for item in value["list"]]
