"""Makes the helper modules importable, whichever way pytest imports tests.

Also keeps the database of hypothesis out of the repository.
"""

import signal
import sys
from pathlib import Path

import hypothesis
import pytest

sys.path.insert(0, str(Path(__file__).parent))
hypothesis.settings.register_profile("impinge", database=None, derandomize=True, deadline=None, max_examples=150)
hypothesis.settings.load_profile("impinge")


@pytest.fixture
def ctrl_c_raises_keyboard_interrupt():
    """Sets Python's handler, because shells make background processes ignore the signal."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
