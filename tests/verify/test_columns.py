"""Many frames at once: the comparison of tests/python/test_many.py, with a million frames of each layout."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import test_many as shorter
from test_many import families, family, test_columns_are_what_each_frame_is

__all__ = ["families", "family", "test_columns_are_what_each_frame_is"]

shorter.FRAMES = 1_000_000
