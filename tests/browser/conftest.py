"""Programs that run the script of the page: Node and Chromium, if they are installed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browser_harness import Asker, program
from codewheel.targets import Library
from codewheel.targets.browser.files import generate

Ask = Callable[[Library, str], Asker]


@pytest.fixture(scope="session")
def ask(tmp_path_factory: pytest.TempPathFactory) -> Ask:
    """Return a function that writes the script of a library and returns its runner: ``node`` or ``chromium``."""

    def start(library: Library, name: str) -> Asker:
        runner = program(name)
        return Asker(tmp_path_factory.mktemp(name), generate(library)["browser/decode.js"], runner)

    return start


@pytest.fixture(scope="session")
def node(ask: Ask, library: Library) -> Asker:
    return ask(library, "node")


@pytest.fixture(scope="session")
def page(library: Library, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the page and its script."""
    folder = tmp_path_factory.mktemp("page")
    for path, text in generate(library).items():
        (folder / Path(path).name).write_text(text, encoding="utf-8")
    return folder
