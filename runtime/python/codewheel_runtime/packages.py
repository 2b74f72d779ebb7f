# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Loads packages that are not always installed, such as NumPy and pyarrow."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def load(module: str) -> Any:
    """Return a module of an optional package.

    Raises:
        ModuleNotFoundError: The package is not installed. The message contains the command that installs it. Or a
            package that it needs is not installed.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        package = module.partition(".")[0]
        if error.name != package:
            raise
        raise ModuleNotFoundError(f"this needs {package}: pip install {package}", name=package) from None
