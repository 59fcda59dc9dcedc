"""Makes the helper modules importable, whichever way pytest imports tests.

Also keeps the database of hypothesis out of the repository.
"""

import sys
from pathlib import Path

import hypothesis

sys.path.insert(0, str(Path(__file__).parent))
hypothesis.settings.register_profile("impinge", database=None, derandomize=True, deadline=None, max_examples=150)
hypothesis.settings.load_profile("impinge")
