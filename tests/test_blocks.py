"""Every command and block of code on our pages is run here or by a named test, or has a reason why not."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import pytest
from exhaustive import mostly_exhaustive
from lines import Biss
from python_path import python_path

ROOT = Path(__file__).parents[1]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
    *(page for page in sorted((ROOT / "docs").glob("*/*.md")) if page.parent.name not in {"example", "site"}),
    *sorted((ROOT / "generated").glob("*/README.md")),
    *sorted(path for path in (ROOT / "generated" / "python").glob("*.md") if path.name != "README.md"),
    *sorted((ROOT / "generated").glob("*/runtime/README.md")),
    *sorted((ROOT / "examples").glob("*/README.md")),
]
_FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: By page, then by the language and the beginning of blocks: the test that runs them and compares the output.
_START_PAGES = "tests/docs/test_start_pages.py::test_its_commands"
ELSEWHERE = {
    "README.md": {
        ": .venv/bin/codewheel master": "tests/test_readme.py::test_commands_run",
        "c: ": "tests/test_readme.py::test_its_c_compiles",
        "python: ": "tests/test_readme.py::test_its_python",
    },
    "docs/master/biss-xml.md": {
        ": $ python docs/example": "tests/biss/test_example_script.py::test_the_page_shows_what_it_prints"
    },
    "docs/bench/command-line.md": {"python: def": "tests/virtual/test_live_links.py::test_the_fixture_of_the_page"},
    "docs/extend/how-to-add-a-master.md": {
        "yaml: ": "tests/masters/test_master_files.py::test_the_example_of_the_page"
    },
    "docs/transcribe/how-to-revise.md": {
        "yaml: editions": "tests/docs/test_editions_page.py::test_the_yaml_is_that_of_the_spec",
        ": $ codewheel decode AM": "tests/docs/test_editions_page.py::test_commands_print_what_is_shown",
        "yaml: codewheel": "tests/docs/test_overlays_page.py::test_the_file_is_the_one_that_is_shown",
        ": $ codewheel check docs": "tests/docs/test_overlays_page.py::test_commands_print_what_is_shown",
        ": $ codewheel decode TV62": "tests/docs/test_overlays_page.py::test_commands_print_what_is_shown",
        "c: ": "tests/docs/test_overlays_page.py::test_the_comment_is_that_of_the_header",
        "text: ": "tests/docs/test_overlays_page.py::test_the_wait_that_is_forgotten_is_told",
        ": ": "tests/changes/test_how_to_revise.py::test_its_session",
        "diff: ": "tests/changes/test_how_to_revise.py::test_its_session",
    },
    "docs/encoder/one-line.md": {": ": "tests/docs/test_one_line_page.py::test_a_shown_output"},
    "docs/transcribe/how-to-transcribe.md": {
        "yaml: ": "tests/fictional/test_page.py::test_yaml_is_that_of_the_spec",
        "text: tv62.second": "tests/fictional/test_revision.py::test_the_story_of_the_page",
        "text: ": "tests/fictional/test_page.py::test_slips_are_found_in_the_words_shown",
        ": ": "tests/fictional/test_page.py::test_commands_of_the_page_work",
    },
    "docs/extend/how-to-write-a-target.md": {
        "toml: ": "tests/docs/test_how_to_write_a_target.py::test_its_commands",
        'python: """': "tests/docs/test_how_to_write_a_target.py::test_its_commands",
        "jinja: ": "tests/docs/test_how_to_write_a_target.py::test_its_commands",
        ": codewheel check": "tests/docs/test_how_to_write_a_target.py::test_its_commands",
        "python: from": "tests/docs/test_how_to_write_a_target.py::test_its_own_tests",
    },
    "docs/transcribe/which-specs.md": dict.fromkeys(
        ("toml: ", "yaml: "), "tests/generator/test_which_specs.py::test_the_settings_of_the_page"
    ),
    "docs/transcribe/check-in-ci.md": {
        "yaml: ": "tests/changes/test_around_a_release.py::test_the_commands_of_the_page_are_right",
    },
    "docs/firmware/rs485.md": {
        "python: ": "tests/virtual/test_exchanges.py::test_the_program_of_the_page",
        "console: ": "tests/virtual/test_exchanges.py::test_the_command_of_the_page",
    },
    "docs/firmware/spi.md": {
        "python: ": "tests/virtual/test_spi.py::test_the_programs_of_the_pages",
        "text: run": "tests/virtual/test_spi_steps.py::test_python_sends_the_words_of_the_manual",
        ": $ codewheel": "tests/docs/test_start_pages.py::test_its_commands",
    },
    **{
        f"docs/transcribe/rules-{letters}.md": {
            "yaml: ": "tests/docs/test_rules_page.py::test_the_pages_are_those_of_today"
        }
        for letters in ("a-to-c", "d-to-m", "n-to-r", "s-to-z")
    },
    "docs/bench/start-bench.md": dict.fromkeys((": ", "text: ", "python: "), _START_PAGES),
    "docs/firmware/languages.md": {"cpp: ": "tests/c/test_cpp.py::test_the_page_on_languages"},
    "docs/firmware/start-firmware.md": dict.fromkeys((": ", "c: "), _START_PAGES),
    "docs/transcribe/start-maintainer.md": {": ": _START_PAGES},
    "docs/master/start-master.md": {": ": _START_PAGES},
    "docs/extend/templates.md": {
        "jinja: ": "tests/docs/test_templates_page.py::test_its_example",
        ": ": "tests/docs/test_templates_page.py::test_its_example",
    },
    "docs/bench/virtual-encoders.md": {
        "python: from": "tests/virtual/test_virtual_page.py::test_the_programs",
        "text: $ codewheel simulate AMM5A21": "tests/virtual/test_virtual_page.py::test_the_simulation",
    },
    "docs/encoder/why-a-crc-fails.md": {
        ": $ codewheel": "tests/generator/test_why.py::test_the_page_shows_what_the_command_prints"
    },
    "generated/c/README.md": {
        "sh: cc ": "tests/verify/test_handover.py::test_a_plain_line",
        "c: ": "tests/c/test_c_headers.py::test_the_readme_compiles_and_prints",
        "cpp: ": "tests/c/test_cpp.py::test_the_readme",
    },
    "generated/browser/README.md": {
        "html: ": "tests/browser/test_browser_page.py::test_a_box_has_the_order_code_of_its_element",
    },
    "generated/python/runtime/README.md": {
        "python: ": "tests/python/test_two_manufacturers.py::test_the_readme_of_the_runtime",
        "text: ": "tests/virtual/test_spi.py::test_the_programs_of_the_pages",
    },
    "generated/python/README.md": {
        "python: >>> ": "tests/python/test_amm5.py::test_readme_examples",
        "python: import": "tests/verify/test_stream.py::test_the_readme_of_an_engine",
        "python: from lika_encoders import open_encoder": "tests/python/test_guides.py::test_every_live_example_runs",
    },
    "generated/python/live-line.md": {
        "python: >>> ": "tests/python/test_guides.py::test_every_example_runs",
        **dict.fromkeys(
            ("python: from lika_encoders import LinkError", "python: from lika_encoders import open_encoder"),
            "tests/virtual/test_live_links.py::test_the_live_example_of_the_package",
        ),
        "python: from asyncio": "tests/virtual/test_live_links.py::test_the_asyncio_example_of_the_package",
    },
    "generated/python/files-and-captures.md": {
        "python: >>> ": "tests/python/test_guides.py::test_every_example_runs",
    },
    "generated/python/test-without-an-encoder.md": {
        "python: >>> ": "tests/python/test_guides.py::test_every_example_runs",
        "python: from": "tests/python/test_guides.py::test_every_live_example_runs",
    },
    "examples/python-two-manufacturers/README.md": {
        ": codewheel generate": "tests/python/test_two_manufacturers.py::test_the_example",
        "text: ": "tests/python/test_two_manufacturers.py::test_the_example",
    },
    "examples/rust-target/README.md": {
        "rust: ": "tests/rust/test_rust_target.py::test_the_readme",
        ": position 725360": "tests/rust/test_rust_target.py::test_the_readme",
    },
}
#: Blocks that no test runs, with the reason.
EXCEPTIONS = {
    ("README.md", ": $ python3 -m venv"): "fetches packages. test_readme.py runs and compares the lines after it",
    ("generated/browser/README.md", ": decode.html"): "the address of a page; test_browser_page.py opens such ones",
    ("README.md", ": make generate"): "each line sets up an environment or takes minutes",
    (
        "docs/extend/architecture.md",
        ": spec ",
    ): "a drawing of the packages. lint-imports compares the imports with them",
    ("docs/firmware/rs485.md", "yaml: "): "has ... for the layouts; the files that it names are checked",
    ("docs/firmware/rs485.md", "c: "): "has ... for calls; test_exchanges.py compiles and runs a program with them",
    ("docs/firmware/channels.md", "yaml: "): "has ... for the fields; the file that it names is checked",
    ("docs/firmware/spi.md", "yaml: "): "has ... for the layouts; the file that it names is checked",
    ("docs/firmware/spi.md", "c: "): "has ... for calls; test_spi.py compiles and runs the program that it names",
    ("docs/transcribe/spec-language.md", "yaml: # yaml-language-server"): "a line for editors alone",
    (
        "docs/bench/virtual-encoders.md",
        "text: $ codewheel simulate AMM5A23",
    ): "waits for Ctrl+C; test_live_links.py runs it",
    (
        "docs/encoder/why-a-crc-fails.md",
        ": mistake ",
    ): "measured over 20,000 frames; test_why.py holds a short run against it",
    (
        "generated/python/test-without-an-encoder.md",
        "text: $ codewheel simulate",
    ): "waits for Ctrl+C; test_live_links.py runs it",
    ("generated/python/README.md", ": pip install"): "fetches nothing but changes the reader's own environment",
    ("generated/python/README.md", ": pip wheel"): "tests/python/test_wheel.py runs both lines without an index",
    (
        "examples/rust-target/README.md",
        ": pip install",
    ): "changes the reader's own environment; test_the_readme runs the line after it",
    ("examples/opcua-target/README.md", ": pip install"): "test_the_installed_target runs both lines",
    (
        "examples/zephyr-target/README.md",
        ": pip install",
    ): "changes the reader's own environment; test_it_is_installed_and_generates runs both lines",
    (
        "examples/zephyr-target/README.md",
        "dts: ",
    ): "a part of a devicetree; test_an_order_code_has_its_place_in_the_binding reads one with each order code",
    (
        "examples/rust-target/README.md",
        "toml: ",
    ): "two lines of a Cargo.toml; test_the_readme compiles against the crate",
}
#: Commands without a shown output are run here, in order.
_OURS = re.compile(r"(?:\$ )?(?:\.venv/bin/)?(codewheel|lika-encoders) ")


@dataclass(frozen=True)
class Block:
    page: str
    key: str
    lines: tuple[str, ...]

    @property
    def is_run_here(self) -> bool:
        return self.key.startswith(": ") and all(_OURS.match(line) for line in self.lines)

    @property
    def elsewhere(self) -> str:
        listed = ELSEWHERE.get(self.page, {})
        return next((begin for begin in listed if self.key.startswith(begin)), "")

    @property
    def exception(self) -> str:
        listed = [begin for page, begin in EXCEPTIONS if page == self.page]
        return next((begin for begin in listed if self.key.startswith(begin)), "")


def blocks() -> Iterator[Block]:
    for path in PAGES:
        for language, text in _FENCED.findall(path.read_text(encoding="utf-8")):
            lines = tuple(text.splitlines())
            yield Block(f"{path.relative_to(ROOT)}", f"{language}: {lines[0]}", lines)


EVERY = list(blocks())
HERE = [block for block in EVERY if block.is_run_here and not block.elsewhere]
#: The command of this page takes most of the time. ``test_which_specs.py`` runs such commands in its own process.
LAST_PAGE = "docs/transcribe/which-specs.md"
FIRST_OF_PAGES = {block.page: block for block in reversed(HERE) if block.page != LAST_PAGE}.values()


def test_every_block_is_accounted_for() -> None:
    neither_run_nor_listed = [block for block in EVERY if not (block.elsewhere or block.is_run_here)]
    unaccounted = [f"{block.page}: {block.key}" for block in neither_run_nor_listed if not block.exception]
    assert unaccounted == []


def test_no_entry_is_left_over() -> None:
    used = {(block.page, block.elsewhere) for block in EVERY if block.elsewhere}
    assert {(page, begin) for page, listed in ELSEWHERE.items() for begin in listed} == used
    assert set(EXCEPTIONS) == {(block.page, block.exception) for block in EVERY if block.exception}


def test_the_tests_that_are_named_are_there() -> None:
    for name in {test for listed in ELSEWHERE.values() for test in listed.values()}:
        path, _, function = name.partition("::")
        assert f"\ndef {function}(" in (ROOT / path).read_text(encoding="utf-8"), name


@pytest.mark.slow
@pytest.mark.parametrize(
    "block", mostly_exhaustive(HERE, *FIRST_OF_PAGES), ids=lambda block: f"{block.page}: {block.lines[0][:50]}"
)
def test_its_commands_run(block: Block, tmp_path: Path, generated_python: tuple[Path, ModuleType]) -> None:
    """Run in a folder with their input: a spec under version control, a document type, captured frames."""
    _prepare(tmp_path)
    environment = {"PATH": "/usr/bin:/bin", "PYTHONPATH": python_path(generated_python[0]), "PYTHONIOENCODING": "utf-8"}
    for line in block.lines:
        command = line.removeprefix("$ ").partition(" #")[0].partition(" | ")[0].strip()
        words = shlex.split(command.replace(".venv/bin/codewheel", "codewheel"))
        module = ["-m", words[0].replace("-", "_"), *words[1:]]
        completed = subprocess.run(
            [sys.executable, *module], capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
        )
        assert completed.returncode == 0, (line, completed.stdout[-300:], completed.stderr)
        assert completed.stdout or completed.stderr or (tmp_path / words[-1]).exists(), line
        if words[:2] == ["codewheel", "new"]:
            _versioned(tmp_path)


def _prepare(folder: Path) -> None:
    shutil.copy(ROOT / "generator" / "language" / "idbiss.reconstructed.dtd", folder / "idbiss.dtd")
    word = 0x55BCD15E2  # AMM5A21/65KSC1: 42 revolutions and 1821973 counts
    (folder / "frames.bin").write_bytes(word.to_bytes(6, "big") * 3)
    line = Biss()
    for _ in range(5):
        line.cycle(word, 45)
    with zipfile.ZipFile(folder / "line.sr", "w") as session:
        head = "[device 1]\ncapturefile=logic-1\nsamplerate=24 MHz\nprobe1=MA\nprobe2=SLO\nunitsize=1\n"
        session.writestr("metadata", head)
        session.writestr("logic-1-1", bytes(clock | data << 1 for clock, data in line.finish().samples(12)))
    (folder / "frames.csv").write_text(f"time,word\n0,{word:#x}\n1,{word:#x}\n", encoding="utf-8")


def _versioned(folder: Path) -> None:
    """Return the spec in its state of version 1.0."""
    who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    for words in (["init", "-q"], ["add", "."], [*who, "commit", "-q", "-m", "first"], ["tag", "v1.0"]):
        subprocess.run(["git", *words], check=True, capture_output=True, cwd=folder)
