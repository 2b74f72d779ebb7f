# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Add the runtime to the requirements. If its folder is nearby, it is installed from there."""

import sys
from pathlib import Path

from setuptools import setup

#: Versions of the runtime that fit this package. The rule is in ``codewheel_runtime/version.py``.
FITTING = "codewheel-runtime>=1.0,<2"

here = Path(__file__).resolve().parent
# The second place is for a folder with the packages of several manufacturers.
found = [place for place in (here / "runtime", here.parent / "runtime") if (place / "codewheel_runtime").is_dir()]
# An archive for other machines does not refer to a folder of this one.
nearby = [] if "sdist" in sys.argv else [f"codewheel-runtime @ {place.as_uri()}" for place in found[:1]]
setup(install_requires=[FITTING, *nearby])
