"""The generated package as text."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from codewheel.model import Device
from codewheel.targets import Library


@pytest.fixture(scope="session")
def files(python_files: Mapping[str, str]) -> Mapping[str, str]:
    return python_files


@pytest.fixture(scope="session")
def devices(library: Library) -> Mapping[str, Device]:
    """The families in the package of ``generated_python``.

    ``test_agreement.py`` uses the devices of other manufacturers.
    """
    return {device.name: device for device in library.devices if device.manufacturer.main}
