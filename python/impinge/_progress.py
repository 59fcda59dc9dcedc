"""Progress of a long call, in one line of stderr."""

from __future__ import annotations

import sys
import time


class Line:
    """Progress line of a call with ``progress=True``; the extension creates and updates it."""

    def __init__(self, rows: int) -> None:
        self._rows = rows
        self._start = time.monotonic()
        self._width = 0

    def show(self, done: int) -> None:
        """Write the number of finished rows, and the remaining time at the current speed."""
        text = f"impinge: {done:,} of {self._rows:,}"
        if done:
            left = (time.monotonic() - self._start) * (self._rows - done) / done
            text += f" ({done / self._rows:.0%}), {left:.1f} s left"
        self._write(text)

    def end(self) -> None:
        """Clear the line."""
        if self._width:
            self._write("")
            self._width = 0

    def _write(self, text: str) -> None:
        sys.stderr.write(f"\r{text:<{self._width}}" if text else f"\r{'':<{self._width}}\r")
        sys.stderr.flush()
        self._width = max(self._width, len(text))
