"""The first ten facts listed for a passage are all that it touches, with numbers as the spec spells them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from codewheel.commands.cli import main

ROOT = Path(__file__).parents[2]
SPECS = ROOT / "docs/example/tolvarn"
MANUAL = (ROOT / "docs/example/manual.md").read_text(encoding="utf-8")
#: Facts that are listed at most.
LISTED = 10


def reread(tmp_path: Path, capsys: pytest.CaptureFixture[str], new: str, *options: str) -> str:
    (tmp_path / "old.txt").write_text(MANUAL, encoding="utf-8")
    (tmp_path / "new.txt").write_text(new, encoding="utf-8")
    main(["reread", str(tmp_path / "old.txt"), str(tmp_path / "new.txt"), "--specs", str(SPECS), *options])
    return capsys.readouterr().out


def listed_paths(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str) -> list[str]:
    """Return the paths of the facts that are listed for the only passage after a change of the manual."""
    assert MANUAL.count(old) == 1
    (passage,) = json.loads(reread(tmp_path, capsys, MANUAL.replace(old, new), "--json"))["passages"]
    return [fact["path"] for fact in passage["facts"][:LISTED]]


#: A change of the manual, and the facts that an editor must then look at.
TOUCHED = {
    "start value printed where none was": (
        "is 5A3Ch for the position and 0 for the",
        "is 5A3Ch for the position (all bits of the register) and 0 for the",
        ("crcs.position_16.init", "crcs.position_16.poly"),
    ),
    "default that an example contains": (
        "95.0 °C | Upper",
        "90.0 °C | Upper",
        ("registers.upper_limit.default", "examples.upper_limit_delivered.values.upper_limit"),
    ),
    "wait that an erratum explains": (
        "least 50 ms",
        "least 80 ms",
        ("procedures.set_preset.steps[2].at_least_ms", "errata.wait_after_bank.used"),
    ),
    "revision on the cover": (
        "revision 1.1 of 5 February 2024",
        "revision 1.2 of 10 March 2025",
        ("manual.revision",),
    ),
}


@pytest.mark.parametrize(("old", "new", "facts"), TOUCHED.values(), ids=TOUCHED)
def test_all_facts_that_a_passage_touches_are_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, facts: tuple[str, ...]
) -> None:
    paths = listed_paths(tmp_path, capsys, old, new)
    assert [fact for fact in facts if fact not in paths] == [], paths


def test_numbers_are_spelled_as_in_the_spec(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec_lines = (SPECS / "tv62.yaml").read_text(encoding="utf-8").splitlines()
    printed = reread(tmp_path, capsys, MANUAL.replace("95.0 °C | Upper", "90.0 °C | Upper"))
    line_and_number = re.findall(r"tv62\.yaml:(\d+): \S+: (0x[0-9A-Fa-f]+|\d+|true|false)$", printed, re.MULTILINE)
    assert [number for _, number in line_and_number if number.startswith("0x")]
    assert [number for line, number in line_and_number if number not in spec_lines[int(line) - 1]] == []
    assert main(["facts", "tv62", "--section", "3.3", "--specs", str(SPECS)]) == 0
    facts = capsys.readouterr().out
    assert ": crcs.position_16.refin: false\n" in facts
    assert "False" not in facts


def test_a_name_in_the_contents_is_a_fact_of_its_section(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A renamed alarm of the SMA21 is also a heading that the spec lists with its page."""
    specs = ROOT / "specs" / "lika"
    chapters = [f"{number} Chapter" for number in range(1, 8)]
    titles = [*chapters, "7.3 Fields", "7.3.1 Control Field", "7.3.2 Status Field", "7.3.3 Data Field"]
    titles += ["7.3.3.1 Errori encoder", "7.3.4 CRC Field", "8 Chapter"]
    contents = "".join(f"{title}....... {page}\n" for page, title in enumerate(titles, 38))
    body = "\n\n".join(titles).replace(titles[-3], f"{titles[-3]}\n\nOverspeed")
    old = f"SMA21 + MTA-A154\n\n{contents}\n{body}\n"
    (tmp_path / "old.txt").write_text(old, encoding="utf-8")
    (tmp_path / "new.txt").write_text(old.replace("Overspeed", "Speed limit error"), encoding="utf-8")
    files = [str(tmp_path / "old.txt"), str(tmp_path / "new.txt")]
    main(["reread", *files, "--specs", str(specs), "--json"])
    (passage,) = json.loads(capsys.readouterr().out)["passages"]
    paths = [fact["path"] for fact in passage["facts"][:LISTED]]
    assert "manual.contents.7.3.3.1.entries.Overspeed" in paths
    assert "alarms.overspeed.printed_name" in paths


AM36 = ROOT / "specs" / "lika" / "am36.yaml"
#: A text of the manual that a change concerns, with headings around it.
AM36_TEXT = """\
AM36 AMC36

{contents}

4 Electrical connections

Function\tM12 8-pin\tM8 type cable
0VDC\t1\tBlack
+10VDC +30VDC\t2\tRed

5 SSI interface

Order codes: AMx36xx/4096-BG-... AMx36xx/4096-GG-...

6 BiSS C-mode interface

6.3.1 SCD structure

CRC

Polynomial: X6 + X1 + 1 (binary: 1000011)

6.5 Implemented registers

Command

After the command, wait min. 30 ms (EPROM writing time) before using a new function.

Configuration

Set to 1 the bit 2 Enable preset in this register, then enter the wished preset value.

7 Default parameters list

Document release\tDescription
1.0\tFirst issue
This device is to be supplied by a Class 2 circuit.
"""


def paths_of_am36(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str) -> list[str]:
    """Return the paths of the facts that are listed for the only passage, with facts of the same value and key."""
    titles = ["1 Safety summary", "2 Identification", "3 Mounting instructions", "4 Electrical connections"]
    titles += ["5 SSI interface", "6 BiSS C-mode interface", "6.3.1 SCD structure"]
    titles += ["6.5 Implemented registers", "7 Default parameters list"]
    text = AM36_TEXT.format(contents="".join(f"{title}....... {page}\n" for page, title in enumerate(titles, 8)))
    assert text.count(old) == 1
    (tmp_path / "old.txt").write_text(text, encoding="utf-8")
    (tmp_path / "new.txt").write_text(text.replace(old, new), encoding="utf-8")
    files = [str(tmp_path / "old.txt"), str(tmp_path / "new.txt")]
    main(["reread", *files, "--specs", str(AM36.parent), "--family", "am36"])
    shown = capsys.readouterr().out
    lines: list[int] = []
    for line, others in re.findall(
        r"am36\.yaml:(\d+): [^\n]*?(?:, also in lines? ([\d, and]+))?$", shown, re.MULTILINE
    ):
        lines += [int(line), *(int(number) for number in re.findall(r"\d+", others))]
    assert "and -" not in shown
    return [AM36.read_text(encoding="utf-8").splitlines()[line - 1].strip() for line in lines]


def test_each_fact_with_a_changed_wait_is_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec_lines = [line.strip() for line in AM36.read_text(encoding="utf-8").splitlines()]
    waits = [line for line in spec_lines if re.search(r"at_least_ms: 30\b|at_least_us: 30000\b", line)]
    assert len(waits) == 10  # In the register, in seven procedures, one of which has two, and in a timing.
    listed = paths_of_am36(tmp_path, capsys, "min. 30 ms", "min. 50 ms")
    assert sorted(line for line in listed if line in waits) == sorted(waits)


def test_each_fact_with_a_changed_supply_is_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    listed = "\n".join(paths_of_am36(tmp_path, capsys, "+10VDC +30VDC", "+5VDC +30VDC"))
    for text in ("supply: {min_mv: 10000", "quantity: supply, min: 10", '"2", signal: +10VDC', "Red, signal: +10VDC"):
        assert text in listed
    assert "value: +10 V DC to +30 V DC" in listed
    assert "used: The supply of all models is +10 V to +30 V." in listed


def test_references_to_a_renamed_bit_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    listed = "\n".join(paths_of_am36(tmp_path, capsys, "the bit 2 Enable preset", "the bit 2 Preset lock"))
    for text in ("printed_name: Enable preset", "field: enable_preset", "values: {enable_preset", "Enable preset: 25"):
        assert text in listed


def test_a_dropped_order_code_lists_its_option(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    listed = "\n".join(paths_of_am36(tmp_path, capsys, " AMx36xx/4096-GG-...", ""))
    assert 'GG: {meaning: "SSI, Gray code"' in listed
    assert "BG is binary, GG is Gray." in listed


def test_a_new_row_of_the_history_lists_the_rows_above(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    listed = "\n".join(paths_of_am36(tmp_path, capsys, "1.0\tFirst issue\n", "1.0\tFirst issue\n2.0\tCable colours\n"))
    assert 'revision: "1.0", changes: First issue.' in listed


def test_an_added_start_value_lists_that_of_the_crc_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    added = "(binary: 1000011)\n\nStart value of the calculation: 3F hex\n"
    listed = paths_of_am36(tmp_path, capsys, "(binary: 1000011)\n", added)[:LISTED]
    assert listed[0] == "init: 0"
    assert any("The start value is 0." in line for line in listed)


#: A text of the ASC85's manual: a register that moves, and a register whose bytes change their order.
ASC85_TEXT = """\
ASC85

{contents}

4 Electrical connections

5 SSI interface

6 BiSS C-mode interface

6.2.1 SCD structure

Error

For a list of the messages refer to the register 69 Error register.

Warning

The meaning of the warnings is explained at the register 69 Error register.

6.4 Implemented registers

Position

Registers 61-64 contain the absolute position information.

Register\t61\t62\t63\t64
\tLSB\t\t\tMSB

6.5 Application notes
"""


def reread_asc85(tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str) -> str:
    titles = ["1 Safety summary", "2 Identification", "3 Mounting instructions", "4 Electrical connections"]
    titles += ["5 SSI interface", "6 BiSS C-mode interface", "6.2.1 SCD structure"]
    titles += ["6.4 Implemented registers", "6.5 Application notes"]
    text = ASC85_TEXT.format(contents="".join(f"{title}....... {page}\n" for page, title in enumerate(titles, 8)))
    assert old in text
    (tmp_path / "old.txt").write_text(text, encoding="utf-8")
    (tmp_path / "new.txt").write_text(text.replace(old, new), encoding="utf-8")
    main(["reread", str(tmp_path / "old.txt"), str(tmp_path / "new.txt"), "--specs", str(AM36.parent)])
    return capsys.readouterr().out


def test_an_address_in_a_text_is_listed_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The manual prints 69, and the spec 69h. The second passage has the same change as the first."""
    printed = reread_asc85(tmp_path, capsys, "the register 69", "the register 6A")
    first_passage, second_passage = printed.split("  old: ")[1:]
    for flag in ("error", "warning"):
        line = f"fields.{flag}.remedy: Read the error register (69h)"
        assert line in "\n".join(first_passage.splitlines()[: LISTED + 2])
        assert line not in second_passage
    assert "the facts listed above for the same change\n" in second_passage


def test_the_order_of_bytes_is_listed_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    printed = reread_asc85(tmp_path, capsys, "\tLSB\t\t\tMSB", "\tMSB\t\t\tLSB")
    _, new_line, first_fact, *_ = printed[printed.index("  old: ") :].splitlines()
    assert new_line.startswith("  new: ")
    assert "registers.position.byte_order: low_byte_first" in first_fact
