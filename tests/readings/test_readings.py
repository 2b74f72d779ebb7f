"""Second readings: each difference between two readers is reported with both places, in these words."""

from __future__ import annotations

import json
import pathlib
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import pytest
from codewheel.commands.check.specs import check_specs
from codewheel.commands.cli import main
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.language.schemas import is_only_in_device_files
from codewheel.loading.library import load_families
from codewheel.model.members import PARTS_BY_CLASS
from codewheel.readings.reading import FactClass, SpecReading
from codewheel.readings.surroundings import surroundings

# Reads whole specs twice, which does not depend on wording or rules of check.
pytestmark = pytest.mark.slow

HERE = pathlib.Path(__file__).parent
MADE_UP = sorted((HERE / "specs").glob("*.yaml"))
MEND = "; check the manual; if it prints both, add an erratum with both under 'readings'"


@pytest.fixture
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A copy of the made-up spec and its second reading, which agree."""
    for path in MADE_UP:
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def replace_in_file(path: pathlib.Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def problem_lines() -> list[str]:
    """Return the problems in this folder, each in one line."""
    report = check_specs([pathlib.Path()], []).report
    return [problem.format().splitlines()[0] for problem in report.problems]


def cases() -> Iterator[tuple[str, str, str, list[str]]]:
    """Return changes of the second reading, and the resulting messages, from the file next to this module."""
    for block in (HERE / "disagreements.txt").read_text(encoding="utf-8").strip().split("\n\n"):
        title, *lines = block.splitlines()
        old_lines = [line[2:] for line in lines if line.startswith("- ")]
        new_lines = [line[2:] for line in lines if line.startswith("+ ")]
        messages = [line for line in lines if not line.startswith(("- ", "+ "))]
        yield title[2:], "\n".join(old_lines), "\n".join(new_lines), messages


CASES = list(cases())


def test_readers_may_name_split_and_order_things_as_they_like(folder: pathlib.Path) -> None:
    assert problem_lines() == []


@pytest.mark.parametrize(("old", "new", "expected"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_a_disagreement_is_reported_once_with_both_places(
    folder: pathlib.Path, old: str, new: str, expected: list[str]
) -> None:
    replace_in_file(folder / "twice.second.yaml", old, new)
    reported = problem_lines()
    assert all(line.endswith(MEND) for line in reported)
    assert [line.removesuffix(MEND) for line in reported] == expected


def test_it_is_shown_with_path_and_line(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    replace_in_file(folder / "twice.second.yaml", "address: 0x49", "address: 0x4A")
    assert main(["check", "twice.yaml"]) == 1
    printed = capsys.readouterr().out
    assert (
        f"""\
twice.second.yaml:128:14: readings-disagree: register 0x4A: 1 byte here, nothing in twice.yaml:127, and 1 more with \
the same cause in line 152 of twice.second.yaml{MEND}
  in registers.configuration.address
    address: 0x4A
             ^
"""
        in printed
    )
    assert "read 3 specs: twice.yaml, manufacturer.yaml, twice.second.yaml\n" in printed


def test_what_only_the_spec_has_is_no_problem(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.second.yaml", "    wait_at_least_ms: 30\n", "")
    assert problem_lines() == []


def test_scales_are_compared_as_formulas(folder: pathlib.Path) -> None:
    scale = "scale: {{numerator: {}, denominator: {}, offset: {}, unit: °C}}"
    scale_of_spec, scale_of_reading = scale.format(1000, 2776, 152_000), scale.format(125, 347, 19_000)
    replace_in_file(
        folder / "twice.yaml", "{name: position, at: 11:0}", f"{{name: position, at: 11:0, {scale_of_spec}}}"
    )
    replace_in_file(
        folder / "twice.second.yaml", "{name: value, at: 11:0}", f"{{name: value, at: 11:0, {scale_of_reading}}}"
    )
    assert problem_lines() == []
    replace_in_file(folder / "twice.second.yaml", "offset: 19000", "offset: 0")
    message = "scale of bits 11:0 of register 0x50: number * 125/347 + 19000/347 °C here, number * 125/347 + 0 °C"
    assert problem_lines()[0].startswith(f"twice.yaml:151:43: readings-disagree: {message} in twice.second.yaml:124")


ERRATUM = "    affects: [registers.preset]\n"


def test_an_erratum_explains_just_these_two_values(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.second.yaml", "max: 2^resolution - 1", "max: 2^resolution")
    replace_in_file(folder / "twice.second.yaml", "{name: value, at: 11:0}", "{name: value, at: 12:0}")
    replace_in_file(folder / "twice.yaml", "{name: position, at: 11:0}", "{name: position, at: 12:0}")
    assert len(problem_lines()) == 1
    replace_in_file(folder / "twice.yaml", ERRATUM, f'{ERRATUM}    readings: [{{second: "1024", used: "1023"}}]\n')
    assert problem_lines() == []
    replace_in_file(folder / "twice.yaml", 'second: "1024"', 'second: "1025"')
    assert len(problem_lines()) == 2
    replace_in_file(folder / "twice.yaml", '"1025", used: "1023"', '"1024", used: "1023"')
    replace_in_file(folder / "twice.yaml", "affects: [registers.preset]", "affects: [registers.width]")
    assert len(problem_lines()) == 2


def test_an_explanation_without_a_disagreement_is_told(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.yaml", ERRATUM, f"{ERRATUM}    readings: [{{second: default, used: nothing}}]\n")
    (problem,) = problem_lines()
    assert problem.endswith(
        "readings-unused: no fact affected by this erratum is 'default' in the second reading and "
        "'nothing' here; correct or remove it"
    )


@pytest.mark.parametrize(
    ("printed", "count"),
    [("15 and 30 ms, or 15 ms", 0), ("10 to 15.0 ms", 0), ("15 to 30 ms", 0), ("Two times", 0), ("10 or 30 ms", 1)],
)
def test_the_printed_text_has_the_value_of_the_second_reading(folder: pathlib.Path, printed: str, count: int) -> None:
    replace_in_file(folder / "twice.second.yaml", "    wait_at_least_ms: 30\n", "    wait_at_least_ms: 15\n")
    replace_in_file(folder / "twice.yaml", "printed: Two limits", f"printed: {printed}")
    readings = "readings: [{second: 15 ms, used: 30 ms}]"
    replace_in_file(folder / "twice.yaml", ERRATUM, f"    affects: [registers.command]\n    {readings}\n")
    assert [line.partition(": ")[2] for line in problem_lines()] == [
        "readings-unused: the printed text has other values than 15 ms, which the second reading has; correct it"
    ] * count


def test_a_fact_that_only_the_second_reading_has_can_be_explained(folder: pathlib.Path) -> None:
    replace_in_file(
        folder / "twice.second.yaml", "    limits_of: value\n", "    limits_of: value\n    above_max: default\n"
    )
    assert len(problem_lines()) == 1
    replace_in_file(folder / "twice.yaml", ERRATUM, f"{ERRATUM}    readings: [{{second: default, used: nothing}}]\n")
    assert problem_lines() == []


def test_a_printed_byte_order_that_biss_does_not_have_is_explained_by_the_spec(folder: pathlib.Path) -> None:
    """A second reading has no errata, so rules that accept what an erratum explains leave it to the comparison."""
    register = "registers:\n  - {{name: profile_id, address: 0x42, length: 2, access: read_only, byte_order: {}{}}}\n"
    replace_in_file(folder / "twice.yaml", "registers:\n", register.format("high_byte_first", ', source: "6"'))
    replace_in_file(folder / "twice.second.yaml", "registers:\n", register.format("low_byte_first", ""))
    assert [line.split(": ")[1] for line in problem_lines()] == ["readings-disagree"]
    readings = "readings: [{second: low_byte_first, used: high_byte_first}]"
    replace_in_file(folder / "twice.yaml", ERRATUM, f"    affects: [registers.profile_id]\n    {readings}\n")
    assert problem_lines() == []


LEFT_OUT = "a second reading does not have this part; leave it out"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("movement: rotary", "movement: rotary\nexamples: []", f"5:1: unknown-key: unknown key 'examples'; {LEFT_OUT}"),
        ("movement: rotary", "movement: rotary\nerrata: []", f"5:1: unknown-key: unknown key 'errata'; {LEFT_OUT}"),
        (
            "device: twice",
            "device: thrice",
            (
                "3:9: device-name: the device is called 'thrice', but the file is called 'twice'; use the same name for"
                " both"
            ),
        ),
        ("movement: rotary\n", "", "2:1: missing-key: 'movement' is missing; a second reading needs it"),
        ("    length: 2\n", "", "114:5: missing-key: 'length' is missing; a register needs it"),
        ("min_hz: 200000, max_hz", "min_hz: 200000, max", "81:29: unknown-key: unknown key 'max'"),
    ],
)
def test_a_second_reading_keeps_to_the_language(folder: pathlib.Path, old: str, new: str, expected: str) -> None:
    """In this case it is not compared."""
    replace_in_file(folder / "twice.second.yaml", old, new)
    replace_in_file(folder / "twice.second.yaml", "baud: 2500000", "baud: 1")
    reported = problem_lines()
    assert reported[0].startswith(f"twice.second.yaml:{expected}")
    assert "readings-disagree" not in "".join(reported)


def test_a_spec_with_faults_is_not_compared(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.yaml", "address: 0x49", "address: 0x48")
    assert [line.split(": ")[1] for line in problem_lines()] == ["duplicate-address"]


def test_it_belongs_to_its_spec(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "twice.second.yaml"]) == 1
    assert "this is a second reading; give twice.yaml, the spec that it belongs to" in capsys.readouterr().out
    assert main(["check", "twice.second.yaml", "twice.yaml"]) == 0


def test_nothing_but_check_sees_it(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "twice.second.yaml").write_text("no spec at all", encoding="utf-8")
    families, report = load_families([folder])
    assert [family.device.name for family in families] == ["twice"]
    assert not report
    assert not any("second" in file for file in (*report.files, *report.passed_over))
    for command in (
        ["list", "--specs", "."],
        ["show", "T10B", "--specs", "."],
        ["decode", "T10B", "--specs", ".", "0"],
    ):
        assert main(command) != 1, command
    assert main(["check"]) == 1


def test_without_one_nothing_changes(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "twice.second.yaml").unlink()
    assert main(["check"]) == 0
    assert "read 2 specs: manufacturer.yaml, twice.yaml\n" in capsys.readouterr().out
    assert main(["check", "--coverage"]) == 0
    assert capsys.readouterr().out.endswith("not read twice: twice\n")


TABLE = """\
facts by number of readings (*: two are required)
                       twice  explained    decided       once    derived
position *                34          0          0          0          0
crc *                     12          0          0          0          0
address *                  4          0          0          0          0
byte order *               3          0          0          0          0
access *                   4          0          0          0          0
default *                  3          0          0          0          0
limit *                    6          0          0          0          2
clock *                    7          0          0          0          0
time *                     5          0          0          0          0
wait *                     2          0          0          1          0
value                      7          0          0          0          0
behaviour                  1          0          0          0          0
verdict                    3          0          0          1          0
alarm                      5          0          0          0          0
procedure                  3          0          0          0          0
order code                 1          0          0          0          0
measurement                1          0          0          0          0
setting                    6          0          0          0          0
supply                     1          0          0          0          0
pin                        3          0          0          0          0
input                      2          0          0          0          0
printed name               8          0          0          0          0
history                    5          0          0          0          0
characteristic             0          0          0          0          0
table                      0          0          0          0          0
LED                        0          0          0          0          0
number in a text           0          0          0          2          0
cited section              0          0          0         37          0
contents                   0          0          0          0          0
twice                    126          0          0         41          2
twice.yaml:117:23: read once: wait, registers.command.wait_at_least_ms
1 fact to read a second time
"""


def test_coverage_by_class(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--coverage"]) == 0
    capsys.readouterr()
    replace_in_file(folder / "twice.second.yaml", "    wait_at_least_ms: 30\n", "")
    assert main(["check", "--coverage"]) == 1
    assert capsys.readouterr().out.partition("no problems in 1 family: twice\n")[2] == TABLE


def test_coverage_as_json(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    replace_in_file(folder / "twice.second.yaml", "    wait_at_least_ms: 30\n", "")
    assert main(["check", "--coverage", "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert (data["version"], data["problems"]) == (1, [])
    assert data["total"] == {"twice": 126, "explained": 0, "decided": 0, "once": 41, "derived": 2}
    (family,) = data["coverage"]
    wait = {"twice": 2, "explained": 0, "decided": 0, "once": 1, "derived": 0, "needed": True}
    assert family["classes"]["wait"] == wait
    assert {
        "class": "wait",
        "file": "twice.yaml",
        "line": 117,
        "path": "registers.command.wait_at_least_ms",
        "needed": True,
    } in family["once"]


def test_counts_beside_the_spec(folder: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The counts are written on request, shown in outputs, and reported if they are out of date."""
    counts_file = folder / "twice.coverage.json"
    assert main(["check", "--write"]) == 2
    assert main(["check", "--coverage"]) == 0
    assert not counts_file.exists()
    assert main(["check", "--coverage", "--write"]) == 0
    counts = '{"twice": 127, "explained": 0, "decided": 0, "once": 40, "derived": 2}\n'
    assert counts_file.read_text(encoding="utf-8") == counts
    (family,), _ = load_families([folder])
    assert family.device.times_read is not None
    assert family.device.times_read.twice == 127
    capsys.readouterr()
    replace_in_file(folder / "twice.second.yaml", "    wait_at_least_ms: 30\n", "")
    assert main(["check"]) == 0
    assert main(["check", "--coverage"]) == 1
    assert "twice.coverage.json:1:1: coverage-file: the counts do not match the readings" in capsys.readouterr().out
    counts_file.write_text("{}", encoding="utf-8")
    assert main(["check"]) == 1
    assert "twice.coverage.json:1:1: coverage-file: the file was edited" in capsys.readouterr().out


def test_our_manuals_were_read_twice(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--coverage"]) == 0
    assert "to read a second time" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (  # The spec has them in the opposite order.
            "{binary_code: {value: 1, printed_name: binary}, gray_code: {value: 0, printed_name: gray}}",
            "{gray: {value: 1, printed_name: binary}, binary: {value: 0, printed_name: gray}}",
            ["name of value 0 of bit 5 of 'setting': 'gray'", "name of value 1 of bit 5 of 'setting': 'binary'"],
        ),
        ("wrong", "faut", ["name of alarm at register 0x49 bit 0: 'fault'"]),
        ("wrong", "mistake", []),
    ],
    ids=["exchanged", "a letter lost", "another"],
)
def test_names_that_must_be_slips_are_told(folder: pathlib.Path, old: str, new: str, expected: list[str]) -> None:
    second = folder / "twice.second.yaml"
    second.write_text(second.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    problems = problem_lines()
    assert all(": readings-disagree: " in line for line in problems)
    disagreements = [line.partition(": readings-disagree: ")[2] for line in problems if line.startswith("twice.yaml")]
    assert [line.partition(" here, ")[0] for line in disagreements] == expected


def disagreements_in_spec() -> list[str]:
    """Return the differences that are reported in the spec, without their places."""
    of_spec = [line for line in problem_lines() if line.startswith("twice.yaml")]
    return [line.partition(": readings-disagree: ")[2] for line in of_spec]


def test_names_count_once_the_second_reading_has_those_of_the_spec(folder: pathlib.Path) -> None:
    """Here they have the names of the spec, because the second reading is the spec without its texts."""
    write_facts_only(folder)
    assert problem_lines() == []
    replace_in_file(folder / "twice.yaml", "- name: function\n", "- name: task\n")
    (disagreement,) = disagreements_in_spec()
    assert disagreement.partition(" in ")[0] == "name of bits 7:0 of 'command': 'task' here, 'function'"


def test_the_line_of_an_item_with_the_name_of_its_list(folder: pathlib.Path) -> None:
    write_facts_only(folder)
    spec = folder / "twice.yaml"
    spec.write_text(spec.read_text(encoding="utf-8").replace("command", "registers"), encoding="utf-8")
    line_number = spec.read_text(encoding="utf-8").splitlines().index("  - name: registers") + 1
    assert [line.partition(" in ")[0] for line in problem_lines() if line.startswith("twice.yaml")] == [
        f"twice.yaml:{line_number}:11: readings-disagree: name of register 0x48: 'registers' here, 'command'"
    ]


def write_facts_only(folder: pathlib.Path) -> None:
    """A second reading that is a copy of the spec."""

    def facts_of(node: object) -> object:
        if isinstance(node, list):
            return [facts_of(child) for child in node]
        if not isinstance(node, dict):
            return node
        facts = {}
        for key, value in node.items():
            if not is_only_in_device_files(key) and key != "manufacturer":
                facts[key] = facts_of(value)
        return facts

    document = read_document(folder / "twice.yaml", ProblemReport())
    assert document is not None
    text = json.dumps(facts_of(document.data), indent=1)
    (folder / "twice.second.yaml").write_text(text, encoding="utf-8")


def test_order_codes_that_only_the_spec_has_are_told_together(folder: pathlib.Path) -> None:
    replace_in_file(
        folder / "twice.second.yaml",
        '"10": {sets: {resolution: 10}}',
        '"10": {sets: {resolution: 10}, only_with: {kind: [B]}}',
    )
    disagreement = "interface of the order code T10G and of 2 more: ssi here, nothing in twice.second.yaml:22" + MEND
    assert disagreement in disagreements_in_spec()


def test_a_parameter_of_one_name_is_the_same_in_both(folder: pathlib.Path) -> None:
    replace_in_file(
        folder / "twice.second.yaml",
        "  resolution: {unit: bits}\n",
        "  resolution: {unit: bits}\n  all_bits: {unit: bits, equals: resolution + 1}\n",
    )
    (problem,) = problem_lines()
    assert "the parameter 'all_bits', for T10B and 7 more: 10 here, 11 in twice.second.yaml:" in problem


def test_a_default_of_a_field_that_only_the_second_reading_states(folder: pathlib.Path) -> None:
    replace_in_file(folder / "twice.second.yaml", "- name: output\n", "- name: output\n        default: 1\n")
    assert "default of bit 5 of register 0x49: 1 here, nothing in twice.yaml:" in problem_lines()[0]


def test_waits_that_follow_each_other_are_one(folder: pathlib.Path) -> None:
    text = (folder / "twice.yaml").read_text(encoding="utf-8")
    wait = "      - {do: wait, at_least_ms: 30}\n"
    assert wait in text
    (folder / "twice.yaml").write_text(text.replace(wait, wait + wait), encoding="utf-8")
    assert any("60 ms" in line for line in problem_lines())


#: An encoder whose requests have other names in the second reading.
EXCHANGES = HERE.parents[1] / "specs" / "sick"
RENAMED = {"position_request": "ask", "type_label_reply": "label", "reset_request": "restart", "xor_8": "xor"}
LEFT_OUT = re.compile(r"^(evidence|documents|examples|errata):.*\n((  .*)?\n)*", re.MULTILINE)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("", "", []),
        ("constant: 0x53", "constant: 0x54", ["request with 0x54 from bit 8: other, without a reply here, nothing in"]),
        ("request: restart,", "request: restart, reply: label,", ["other, without a reply here, other, with a reply"]),
        ("{name: zero, bits: 8, unused: 0}", "{name: zero, bits: 8, constant: 0}", ["constant 00000000"]),
        ("{name: type_label, bits: 32", "{name: type_label, bits: 24", ["bits of 'type_label_reply': 56 here, 48 in"]),
    ],
)
def test_requests_and_replies_are_compared(
    old: str, new: str, expected: list[str], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The constants of a request identify it, and the frame that answers it."""
    text = LEFT_OUT.sub("", (EXCHANGES / "skm36.yaml").read_text(encoding="utf-8"))
    text = re.sub(r',? *source: "[^"]*"', "", text)
    for name, new_name in RENAMED.items():
        text = text.replace(name, new_name)
    assert old in text
    (tmp_path / "skm36.second.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    for name in ("manufacturer.yaml", "skm36.yaml"):
        shutil.copy(EXCHANGES / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    reported = problem_lines()
    assert bool(reported) == bool(expected), reported
    for words in expected:
        assert any(words in line for line in reported), reported


@pytest.mark.parametrize(("part", "fact_class"), [("Led", FactClass.LED), ("Connector", FactClass.PIN)])
def test_a_member_with_a_class_of_facts_is_compared(
    part: str, fact_class: FactClass, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No member of these parts has a class today. A new key with one must not be left out."""
    (family,), _ = load_families([HERE.parents[1] / "specs/lika/amm5.yaml"])
    members = []
    for member in PARTS_BY_CLASS[part].members:
        members.append(replace(member, read=fact_class.value) if member.name == "title" else member)
    changed_parts = {**PARTS_BY_CLASS, part: SimpleNamespace(members=members)}
    monkeypatch.setattr("codewheel.readings.stated.PARTS_BY_CLASS", changed_parts)
    facts = [fact for fact in surroundings(SpecReading(family.device, family.document)) if fact.key[-1] == "title"]
    assert {fact.fact_class for fact in facts} == {fact_class}
