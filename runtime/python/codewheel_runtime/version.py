# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Version of the runtime, and the compatibility rule for packages that were generated for another version.

A package works with the runtime that it was generated for and with later ones of the same major version:

- The major number increases if a package for an earlier runtime would no longer work.
- The minor number increases if a package for this runtime would not work with an earlier one.

The version does not depend on the specs, or on the version of codewheel.
"""

from __future__ import annotations

from typing import Final

#: Version of the runtime.
__version__: Final = "1.0.0"


def require(package: str, needed: str) -> str:
    """Check that this runtime fits a package.

    Args:
        package: Name of the package, for the error.
        needed: Major and minor number of the runtime that the package was generated for, such as ``1.0``.

    Returns:
        The version of this runtime.

    Raises:
        ImportError: The runtime has a different major version, or is older.
    """
    installed = _parse_numbers(__version__)
    lowest = _parse_numbers(needed)
    if installed[0] != lowest[0] or installed < lowest:
        message = f"{package} needs codewheel-runtime {needed} or a later {lowest[0]}.x, but {__version__} is installed"
        raise ImportError(message, name="codewheel_runtime")
    return __version__


def _parse_numbers(version: str) -> tuple[int, int]:
    major, minor = version.split(".")[:2]
    return int(major), int(minor)
