# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Add the runtime to the requirements. If its folder is found nearby, pip installs it from there."""

import sys
from pathlib import Path
from runpy import run_path
from tempfile import TemporaryDirectory

from setuptools import setup

#: Version of the runtime that this package was generated for, and the versions that fit it.
NEEDED, FITTING = "1.0", "codewheel-runtime>=1.0,<2"

folder = Path(__file__).resolve().parent
# The second place is for a folder with the packages of several manufacturers.
places = (folder / "runtime", folder.parent / "runtime")
runtimes = [place for place in places if (place / "codewheel_runtime").is_dir()]
if runtimes:
    run_path(str(runtimes[0] / "codewheel_runtime" / "version.py"))["require"]("this package", NEEDED)

# Archives and wheels are for other machines, so they do not refer to a folder of this machine. pip reads the
# requirements before it builds the wheel that it installs, and finds the runtime in its folder.
is_distribution = "sdist" in sys.argv or "bdist_wheel" in sys.argv
requirement = f"codewheel-runtime @ {runtimes[0].as_uri()}" if runtimes and not is_distribution else FITTING
if "bdist_wheel" in sys.argv and "--dist-info-dir" in sys.argv:
    # This option is for a copy of the metadata that pip has read.
    option = sys.argv.index("--dist-info-dir")
    del sys.argv[option : option + 2]
# The folder ``build`` can contain modules of families that are no longer in the package.
with TemporaryDirectory() as build_folder:
    setup(install_requires=[requirement], options={"build": {"build_base": build_folder}})
