# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Add the runtime to the requirements. If its folder is found nearby, it is installed from there."""

import sys
from pathlib import Path
from runpy import run_path

from setuptools import setup

#: Version of the runtime that this package was generated for, and the versions that fit it.
NEEDED, FITTING = "1.0", "codewheel-runtime>=1.0,<2"

folder = Path(__file__).resolve().parent
# The second place is for a folder with the packages of several manufacturers.
places = (folder / "runtime", folder.parent / "runtime")
runtimes = [place for place in places if (place / "codewheel_runtime").is_dir()]
requirement = FITTING
# A source archive is for other machines, so it does not refer to a folder of this one.
if runtimes and "sdist" not in sys.argv:
    run_path(str(runtimes[0] / "codewheel_runtime" / "version.py"))["require"]("this package", NEEDED)
    requirement = f"codewheel-runtime @ {runtimes[0].as_uri()}"
setup(install_requires=[requirement])
