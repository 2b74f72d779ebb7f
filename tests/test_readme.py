"""Check that every command, picture and link on the front page is right."""

from __future__ import annotations

import doctest
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device
from front_picture import DECODED, PANELS, PYTHON, SPEC, C, picture

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def _block(language: str) -> str:
    block = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert block is not None
    return block[1]


def _examples_pass(text: str, package: ModuleType) -> bool:
    sys.modules["lika_encoders"] = package
    test = doctest.DocTestParser().get_doctest(text, {}, "README", "README.md", 0)
    assert test.examples
    return doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


@pytest.mark.slow
def test_its_python(generated_python: tuple[Path, ModuleType]) -> None:
    assert _examples_pass(_block("python"), generated_python[1])


@pytest.mark.slow
def test_its_c_compiles(tmp_path: Path) -> None:
    """The statements of the block, in a function that calls them with a valid frame, find its position."""
    # The line is high, then low until the start bit. The CDS bit and 45 bits follow, and the stop bit.
    line = f"1100001{0}{0xF4243D3:045b}0".ljust(96, "1")
    received = ", ".join(f"0x{byte:02X}U" for byte in int(line, 2).to_bytes(12, "big"))
    program = (
        '#include <stdio.h>\n#include "lika/amm5_biss.h"\n'
        'static void use(uint64_t position) { printf("%u\\n", (unsigned)position); }\n'
        "int main(void)\n{\n"
        f"{_block('c').replace(';', f' = {{ {received} }};', 1)}    return 0;\n}}\n"
    )
    (tmp_path / "front.c").write_text(program, encoding="utf-8")
    include = ROOT / "generated" / "c" / "include"
    subprocess.run(
        ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{include}", "front.c", "-o", "front"],
        cwd=tmp_path,
        check=True,
    )
    completed = subprocess.run([tmp_path / "front"], capture_output=True, text=True, check=True)
    assert completed.stdout == "1000003\n"


def _commands() -> list[str]:
    """Return each line of the README that calls the installed command for a shipped encoder."""
    lines = [line.removeprefix("$ ") for line in README.splitlines()]
    return [line for line in lines if re.match(r"\.venv/bin/codewheel (decode|master) ", line)]


@pytest.mark.parametrize("command", _commands())
def test_commands_run(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = shlex.split(command)
    assert main(words[1:]) == 0
    assert words[2] in capsys.readouterr().out


def test_its_first_command_prints_what_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    """An ellipsis represents omitted lines, and all others are printed in this order."""
    block = re.search(r"^```\n\$ python3 .*\n\$ (.*)\n((?:.*\n)*?)```$", README, re.MULTILINE)
    assert block is not None
    assert main(shlex.split(block[1])[1:]) == 0
    pieces = map(re.escape, block[2].split("...\n"))
    assert re.fullmatch("(?:.*\n)*".join(pieces), capsys.readouterr().out)
    assert block[2].count("\n") >= 5


def test_its_picture_is_up_to_date() -> None:
    assert (ROOT / "docs" / "front.svg").read_text(encoding="utf-8") == picture()


def test_its_picture_shows_what_is_in_the_spec() -> None:
    """Every line of the panel is in the spec, in this order."""
    spec = (ROOT / "specs" / "lika" / "amm5.yaml").read_text(encoding="utf-8")
    pieces = [re.escape(line.strip().rstrip("…").rstrip()) for line in SPEC.lines if line.strip() != "…"]
    assert re.search(".*?".join(pieces), spec, re.DOTALL)


def test_its_picture_shows_what_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(DECODED.title)[1:]) == 0
    printed = capsys.readouterr().out
    for line in DECODED.lines:
        assert line.rstrip("…").rstrip() in printed, line


@pytest.mark.slow
def test_its_picture_shows_the_result_of_python(generated_python: tuple[Path, ModuleType]) -> None:
    example = "\n".join([">>> from lika_encoders import lookup", *PYTHON.lines, ""])
    assert _examples_pass(example, generated_python[1])


def test_its_picture_shows_c_of_the_headers() -> None:
    header = (ROOT / "generated" / "c" / "include" / "lika" / "amm5_biss.h").read_text(encoding="utf-8")
    for name in re.findall(r"lika_\w+", "".join(C.lines)):
        assert re.search(rf"\b{name}\b", header), name


def test_its_picture_has_no_text_wider_than_its_box() -> None:
    for panel in PANELS:
        assert all(len(line) * 7.9 <= panel.width - 20 for line in panel.lines), panel.title


def test_its_first_screen_has_a_command_and_its_result() -> None:
    first = "".join(README.splitlines(keepends=True)[:22])
    assert "docs/front.svg" in first
    assert "pip install" in first
    assert "$ .venv/bin/codewheel decode" in first
    assert "position: 171.6619°" in first
    assert "not on a package index yet" in first


def test_its_parts_are_in_order() -> None:
    """Title, picture, installation with a result, encoders, grades with the badge, own encoder, three doors, trust."""
    parts = [
        "# codewheel",
        "docs/front.svg",
        "$ python3 -m venv",
        "## Encoders",
        "[Grades of evidence]",
        "[![Not yet tested on hardware]",
        "## Your own encoder",
        "## Firmware",
        "## BiSS or SSI master, PLC",
        "## Bench",
        "## Can I trust it?",
        "## Limits",
        "## License",
    ]
    places = [README.index(part) for part in parts]
    assert places == sorted(places)


def test_it_is_short() -> None:
    """A front page has at most 700 words outside code blocks and the list of encoders."""
    assert len(re.sub(r"```.*?```|^\|[^\n]*\n", "", README, flags=re.DOTALL | re.MULTILINE).split()) <= 700


def test_your_own_encoder_is_within_the_first_300_words() -> None:
    before = README.partition("## Your own encoder")[0]
    assert len(re.sub(r"\]\([^)]*\)|[|]|-{3,}", " ", before).split()) <= 300


def test_its_links_to_encoders_lead_to_pages_where_the_repository_has_them(devices: Mapping[str, Device]) -> None:
    assert set(re.findall(r"\]\(generated/docs/(\w+)\.md\)", README)) - {"usable-or-not"} == devices.keys()


def test_its_links() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
