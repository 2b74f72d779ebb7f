"""The generated package as text."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from codewheel.targets import Library
from codewheel.targets.python.files import generate


@pytest.fixture(scope="session")
def files(library: Library) -> Mapping[str, str]:
    return generate(library)
