"""cppcheck's MISRA add-on reports only the deviations that ``generated/c/MISRA.md`` lists with a reason."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from tools import tool
from uses import use_everything

ROOT = Path(__file__).resolve().parents[2]
DEVIATIONS = ROOT / "generated" / "c" / "MISRA.md"
#: For unused types, tags and macros: only in files that do not use them.
UNUSED = {"2.3", "2.4", "2.5"}
#: Sizes of int and long: 16 and 32 bits for headers that are only included, 32 and 32 for headers that are used
#: completely. With 32 and 64, what is planted is found.
SMALL, USUAL, LARGE = "avr8", "arm32-wchar_t4", "unix64"


def deviations() -> set[str]:
    """Return the rules of the first table, which lists the findings of the add-on."""
    table = DEVIATIONS.read_text(encoding="utf-8").partition("These additional deviations")[0]
    lines = [line.strip("|").split("|") for line in table.splitlines() if line.startswith("|")]
    rows = [[*map(str.strip, cells)] for cells in lines[2:]]
    assert rows, "each deviation has a rule, a category, a place and a reason"
    assert all(len(row) == 4 and all(row) for row in rows), (
        "each deviation has a rule, a category, a place and a reason"
    )
    assert {row[1] for row in rows} == {"advisory"}, "no required rule is deviated from"
    return {row[0] for row in rows}


def findings(code: str, include: Path, folder: Path, platform: str) -> set[tuple[str, str]]:
    """Return rule and place of every finding in the headers."""
    unit = folder / "unit.c"
    unit.write_text(code, encoding="ascii")
    command = [
        tool("cppcheck"),
        f"--platform={platform}",
        "--addon=misra",
        "--std=c99",
        f"-I{include}",
        # As in stdint.h, which cppcheck does not read.
        "-DUINT64_C(value)=value##ULL",
        "--enable=warning,style,performance,portability",
        "--inconclusive",
        "--quiet",
        "--error-exitcode=0",
        "--template={file}:{line}: [{id}] {message}",
        str(unit),
    ]
    completed = subprocess.run(command, capture_output=True, text=True)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    assert "Bailing out" not in completed.stderr, completed.stdout + completed.stderr
    rows = re.findall(r"^(.+?):(\d+): \[(?:misra-c2012-)?(.+?)\]", completed.stderr, re.MULTILINE)
    assert len(rows) == len(completed.stderr.splitlines()), completed.stderr[:2000]
    return {(rule, f"{Path(path).relative_to(include)}:{line}") for path, line, rule in rows if Path(path) != unit}


def by_interface(headers: list[str]) -> list[list[str]]:
    """Return the headers in groups. The other headers of an interface include the first header.

    The add-on compares all names of a unit with each other, so all headers at once take minutes.
    """
    groups: list[list[str]] = []
    for header in headers:
        if groups and header.startswith(groups[-1][0].removesuffix(".h") + "_"):
            groups[-1].append(header)
        else:
            groups.append([header])
    return groups


def test_headers_that_are_included_have_no_finding_without_a_reason(
    headers: tuple[Path, list[str]], tmp_path: Path
) -> None:
    include, names = headers
    reported = set[tuple[str, str]]()
    for group in by_interface(names):
        reported |= findings("".join(f'#include "{header}"\n' for header in group), include, tmp_path, SMALL)
    allowed = deviations()
    assert [finding for finding in sorted(reported) if finding[0] not in allowed] == []
    assert {rule for rule, _ in reported} == allowed, "a deviation that nothing needs"


def test_headers_of_which_all_is_used_have_no_finding_without_a_reason(
    headers: tuple[Path, list[str]], tmp_path: Path
) -> None:
    include, names = headers
    for group in by_interface(names):
        reported = findings(use_everything(group, include), include, tmp_path, USUAL)
        assert [finding for finding in sorted(reported) if finding[0] not in deviations() - UNUSED] == []


@pytest.mark.parametrize("order_code", ["AMM5A23/65KSC1", "AMM5A23/65KBG1", "AMM5A23/65KJP1", "AS5047P"])
def test_a_header_for_one_order_code_has_no_finding_without_a_reason(order_code: str, tmp_path: Path) -> None:
    families = {"as5047p"} if order_code == "AS5047P" else {"amm5"}
    devices = tuple(device for device in load_library()[0] if device.name in families)
    files = generate(Library(devices), {"form": "single", "only": order_code})
    ((path, text),) = ((path, text) for path, text in files.items() if path.endswith(".h"))
    name = Path(path).name
    (tmp_path / name).write_text(text, encoding="ascii")
    for platform in (SMALL, USUAL):
        reported = findings(f'#include "{name}"\n', tmp_path, tmp_path, platform)
        assert [finding for finding in sorted(reported) if finding[0] not in deviations()] == []


@pytest.mark.parametrize(
    ("name", "sound", "planted", "rule"),
    [
        ("bits.h", "return (0x6996U >> (v & 0x0FU)) & 1U;", "return v & value >> 31U;", "12.1"),
        ("bits.h", "    return (0x6996U >>", "    v = v << 1U, v >> 1U;\n    return (0x6996U >>", "12.3"),
        (
            "encoder.h",
            "static inline bool cw_is_digit(char letter)\n{\n",
            "static inline bool cw_is_digit(char letter)\n{\n    letter++;\n",
            "17.8",
        ),
        ("bits.h", "return (0x6996U >> (v & 0x0FU)) & 1U;", "goto done;\ndone:\n    return v & 1U;", "15.1"),
        (
            "transport.h",
            "        index += steps_done;\n",
            (
                "        if (steps_done > 2U) {\n            index += steps_done;\n"
                "        } else if (steps_done > 1U) {\n            index += 2U;\n        }\n"
            ),
            "15.7",
        ),
    ],
)
def test_what_is_planted_is_found(
    name: str, sound: str, planted: str, rule: str, headers: tuple[Path, list[str]], tmp_path: Path
) -> None:
    shutil.copytree(headers[0], tmp_path / "include")
    header = tmp_path / "include" / "codewheel" / name
    text = header.read_text(encoding="ascii")
    assert text.count(sound) == 1
    header.write_text(text.replace(sound, planted), encoding="ascii")
    reported = findings(f'#include "codewheel/{name}"\n', tmp_path / "include", tmp_path, LARGE)
    assert rule in {reported_rule for reported_rule, _ in reported} - deviations()


def test_nothing_is_switched_off(headers: tuple[Path, list[str]]) -> None:
    include, names = headers
    suppression = re.compile(r"cppcheck-suppress|NOLINT|lint ?[-!]e")
    assert not [header for header in names if suppression.search((include / header).read_text())]
