"""The five-minute starts: their files are written, their commands run, and the output is exactly as on the pages."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").glob("*/start-*.md"))
SPI = ROOT / "docs/firmware/spi.md"
QUESTIONS = sorted((ROOT / "docs/encoder").glob("questions-*.md"))


def files(page: str) -> dict[str, str]:
    """Return the blocks that follow the name of a file."""
    return dict(re.findall(r"^`([\w.]+)`:\n\n```\w+\n(.*?)^```$", page, re.DOTALL | re.MULTILINE))


def commands(page: str) -> Iterator[tuple[str, str]]:
    """Return each command with its output."""
    for block in re.findall(r"^```\n(\$ .*?)^```$", page, re.DOTALL | re.MULTILINE):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, output = part.partition("\n")
            yield command, output


def environment(folder: Path) -> dict[str, str]:
    """The command codewheel, and the Python that runs the tests."""
    for name, arguments in (("codewheel", " -m codewheel"), ("python3", "")):
        tool = folder / name
        tool.write_text(f'#!/bin/sh\nexec "{sys.executable}"{arguments} "$@"\n', encoding="utf-8")
        tool.chmod(0o755)
    return {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "PYTHONIOENCODING": "utf-8"}


@pytest.mark.one_in(12, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("page", [*PAGES, *QUESTIONS, SPI], ids=lambda page: page.stem)
def test_its_commands(page: Path, tmp_path: Path) -> None:
    text, work, tools = page.read_text(encoding="utf-8"), tmp_path / "work", tmp_path / "tools"
    work.mkdir()
    tools.mkdir()
    for name, content in files(text).items():
        (work / name).write_text(content, encoding="utf-8")
    for command, output in commands(text):
        completed = subprocess.run(
            ["bash", "-c", command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=work,
            env=environment(tools),
        )
        # Three dots replace omitted lines. All other lines are shown.
        pieces = output.split("...\n")
        assert re.fullmatch("(?:.*\n)*".join(map(re.escape, pieces)), completed.stdout), (
            f"{command}\n{completed.stdout}"
        )


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_has_commands(page: Path) -> None:
    assert len(list(commands(page.read_text(encoding="utf-8")))) >= 2


@pytest.mark.parametrize("page", QUESTIONS, ids=lambda page: page.stem)
def test_an_answer_is_short_and_begins_with_an_example(page: Path) -> None:
    """And the page of questions lists it under its title. No page begins with a command line."""
    _, front_matter, text = page.read_text(encoding="utf-8").split("---\n", 2)
    assert front_matter.startswith("asked:\n")
    title, _, example = text.splitlines()[:3]
    assert len(text.splitlines()) <= 40
    assert re.fullmatch(r"\[[^\]]+\]\(\.\./\.\./generated/browser/decode\.html#code=[^&]+&frame=\S+\)\.", example)
    listed = f"- [{title.removeprefix('# ')}]({page.name})\n"
    assert listed in (ROOT / "docs/encoder/questions.md").read_text(encoding="utf-8")


def test_the_warning_about_hardware_is_given_once() -> None:
    """The front page and the header of the site have it with a link. The pages do not repeat it."""
    badge = "[![Not yet tested on hardware](docs/not-on-hardware.svg)](docs/trust/evidence.md)"
    assert (ROOT / "README.md").read_text(encoding="utf-8").count(badge) == 1
    header = (ROOT / "docs" / "site" / "templates" / "page.html").read_text(encoding="utf-8")
    assert header.count("""href="{{ pathto('docs/trust/evidence') }}">Not yet tested on hardware</a>""") == 1
    site = sorted((ROOT / "docs" / "site").glob("*.md"))
    repeated = re.compile("(tested|tried) on (an encoder|hardware)")
    fence = re.compile("^```.*?^```$", flags=re.MULTILINE | re.DOTALL)
    prose = {page.name: fence.sub("", page.read_text(encoding="utf-8")) for page in [*PAGES, *site]}
    assert [name for name, text in prose.items() if repeated.search(text)] == []


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "site").glob("*.md")), ids=lambda page: page.stem)
def test_links_of_the_site_s_own_pages_work_in_the_repository_too(page: Path) -> None:
    links = re.findall(r"""(?:\]\(|\bhref=")([^)"#\s]+)""", page.read_text(encoding="utf-8"))
    assert links
    assert [link for link in links if ":" not in link and not (page.parent / link).exists()] == []


def test_there_is_one_for_each() -> None:
    assert sorted(page.stem for page in PAGES) == ["start-bench", "start-firmware", "start-maintainer", "start-master"]
