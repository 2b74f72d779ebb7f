# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Build in a new folder, because ``build`` can contain modules of an earlier version, which would go into the wheel."""

from tempfile import TemporaryDirectory

from setuptools import setup

with TemporaryDirectory() as build_folder:
    setup(options={"build": {"build_base": build_folder}})
