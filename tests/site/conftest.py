"""The site, built once, and a browser that checks it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from building import build
from chromium import CHROMIUM, Browser
from working_tools import require


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    """``make verify`` builds the site. ``make test`` looks at the pages that it is built from."""
    for test in items:
        if Path(__file__).parent in test.path.parents and "site" in getattr(test, "fixturenames", ()):
            test.add_marker(pytest.mark.exhaustive)


@pytest.fixture(scope="session")
def site(made_once: Callable[[str, Callable[[Path], object]], Path]) -> Path:
    """The folder of the site."""
    pytest.importorskip("myst_parser", reason="the extra 'site' is not installed")
    return made_once("site", lambda folder: build(folder / "site")) / "site"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    require([CHROMIUM])
    with Browser(tmp_path_factory.mktemp("profile")) as started:
        yield started
