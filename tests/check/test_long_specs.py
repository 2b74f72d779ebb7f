"""Long specs are checked in a time that grows with their length, and long lists of problems end."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from codewheel.commands.check import as_data, as_text
from codewheel.commands.cli import main
from codewheel.language import messages, places, problems
from codewheel.language.problems import MAX_FOUND, MAX_PROBLEMS, TOO_MANY, Report
from codewheel.language.rules import order_code, quantities
from codewheel.language.schema_files import load_schema
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import TargetError
from codewheel.targets.c.order_codes import open_codes

MINIMAL = Path(__file__).parent / "ok" / "minimal.yaml"
MAKER = 'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nsource: "1"\n'


def written(folder: Path, text: str) -> Path:
    (folder / "manufacturer.yaml").write_text(MAKER)
    (folder / "minimal.yaml").write_text(text)
    return folder


def loaded(folder: Path, text: str) -> tuple[tuple[Device, ...], Report]:
    return load_library([written(folder, text)])


def with_codes(part: str, more: str = "") -> str:
    """Return the minimal spec with another part of the order code, and with other keys of the order code."""
    pattern, output = '  pattern: "MIN{resolution}{output}"\n', "    - name: output\n"
    text = MINIMAL.read_text()
    assert pattern in text
    return text.replace(pattern, f'  pattern: "MIN{{resolution}}{{part}}{{output}}"\n{more}').replace(
        output, f"    - {part}\n{output}"
    )


def lists_of(schema: Any) -> Iterator[dict[str, Any]]:
    """Yield the schemas of all lists and of all maps with any keys."""
    if isinstance(schema, dict):
        if "items" in schema or isinstance(schema.get("additionalProperties"), dict):
            yield schema
        for item in schema.values():
            yield from lists_of(item)


@pytest.mark.parametrize("kind", ["device", "manufacturer", "master", "overlay"])
def test_every_list_has_a_limit(kind: str) -> None:
    for item in lists_of(load_schema(kind)):
        assert item.get("maxItems" if "items" in item else "maxProperties", 2001) <= 2000, item


def report_of(*counts: int, rule: str = "rule") -> Report:
    report = Report()
    for number, count in enumerate(counts):
        for line in range(1, count + 1):
            report.add_at(f"{number}.yaml", line, 3, rule, f"wrong {line}", path="a.b", text="text")
    return report


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (MAX_PROBLEMS, ""),
        (MAX_PROBLEMS + 1, "there is 1 more problem from here on; it is reported once these are fixed"),
        (MAX_PROBLEMS + 2, "there are 2 more problems from here on; they are reported once these are fixed"),
    ],
)
def test_a_long_list_of_problems_ends_with_their_number(count: int, message: str) -> None:
    report = report_of(count, 3)
    assert len(report) == count + 3
    here, other = ([item for item in report.shown if item.file == name] for name in ("0.yaml", "1.yaml"))
    assert len(other) == 3
    assert [item.line for item in here[:MAX_PROBLEMS]] == list(range(1, MAX_PROBLEMS + 1))
    last = [(item.rule, item.line, item.message) for item in here[MAX_PROBLEMS:]]
    assert last == ([(TOO_MANY, MAX_PROBLEMS + 1, message)] if message else [])


def test_problems_that_were_not_looked_for_are_not_counted() -> None:
    report = report_of(MAX_PROBLEMS + 5)
    report.add_at("0.yaml", 1, 1, TOO_MANY, "there are more")
    assert len(report.shown) == MAX_PROBLEMS + 1
    assert report.shown[-1].message.startswith("there are at least 5 more problems from here on")
    report = report_of(MAX_PROBLEMS)
    report.add_at("0.yaml", 1, 1, TOO_MANY, "there are more")
    assert report.shown == report.problems


def test_every_form_of_the_output_ends(tmp_path: Path) -> None:
    report = report_of(MAX_PROBLEMS + 7)
    text = as_text((), report)
    assert text.count(": rule: ") == MAX_PROBLEMS
    assert f"0.yaml:201:3: {TOO_MANY}: there are 7 more problems" in text
    assert text.endswith("\n207 problems")
    assert len(as_data(report)["problems"]) == MAX_PROBLEMS + 1
    assert as_text((), report, "github").count("\n") == MAX_PROBLEMS
    assert len(json.loads(as_text((), report, "sarif"))["runs"][0]["results"]) == MAX_PROBLEMS + 1


def test_repeated_keys_are_cut_in_the_reader(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path, MINIMAL.read_text() + "device: minimal\n" * 500)
    assert main(["check", str(folder), "--no-cache"]) == 1
    out = capsys.readouterr().out
    assert out.count("duplicate-key") == MAX_PROBLEMS
    assert "there are 300 more problems from here on; they are reported once these are fixed" in out
    assert main(["list", str(folder), "--no-cache"]) != 0
    assert capsys.readouterr().err.count("duplicate-key") <= MAX_PROBLEMS


def test_no_rule_is_checked_after_many_problems(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[str] = []
    monkeypatch.setattr(problems, "is_typo", lambda word, known: bool(compared.append(word)))
    errata = (
        f"  - {{name: e{index}, source: '1', printed: a, used: b, why: c, status: open, severity: wording,"
        f" affects: [crcs.other{index}]}}\n"
        for index in range(MAX_FOUND + 100)
    )
    _, report = loaded(tmp_path, MINIMAL.read_text() + "errata:\n" + "".join(errata))
    assert len(report) == MAX_FOUND + 1
    assert len(report.shown) == MAX_PROBLEMS + 1
    assert report.shown[-1].message.startswith(f"there are at least {MAX_FOUND - MAX_PROBLEMS} more problems")
    assert len(set(compared)) <= MAX_FOUND + 1


def test_hints_for_unknown_keys_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    key_hint = messages._key_hint

    def counted(error: Any, path: Any, key: str) -> str:
        asked.append(key)
        return key_hint(error, path, key)

    monkeypatch.setattr(messages, "_key_hint", counted)
    text = MINIMAL.read_text().replace("title:", "titel:") + "".join(f"key_{index}: 1\n" for index in range(3000))
    _, report = loaded(tmp_path, text)
    assert len(report) == MAX_PROBLEMS + 1
    assert len(asked) <= 2 * MAX_PROBLEMS


def test_values_of_a_part_are_collected_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    fits = order_code._value_test
    monkeypatch.setattr(order_code, "_value_test", lambda part: asked.append(part["name"]) or fits(part))
    values = ", ".join(f"A{index}: {{}}" for index in range(300))
    _, report = loaded(tmp_path, with_codes(f"{{name: part, meaning: Part, values: {{{values}}}}}"))
    assert not report
    assert sorted(asked) == ["output", "part", "resolution"]


class Counted(dict[str, str]):
    """The parts of an order code, with a count of the accesses."""

    accesses = 0

    def __getitem__(self, key: str) -> str:
        Counted.accesses += 1
        return super().__getitem__(key)


def codes_of(folder: Path, part: str, more: str = "") -> Device:
    devices, report = loaded(folder, with_codes(part, more))
    assert not report, report.problems[0]
    parts = (replace(item, parts=MappingProxyType(Counted(item.parts))) for item in devices[0].variants)
    return replace(devices[0], variants=tuple(parts))


def test_each_order_code_is_looked_up_once(tmp_path: Path) -> None:
    values = ", ".join(f"{index:03}: {{}}" for index in range(300))
    device = codes_of(tmp_path, f'{{name: part, meaning: Part, open: "[0-9]{{3}}", values: {{{values}}}}}')
    Counted.accesses = 0
    rows = open_codes(device)
    assert len(rows) == len(device.variants) // 300
    assert Counted.accesses < 20 * len(device.variants)


def test_patterns_of_refused_codes_are_looked_up(tmp_path: Path) -> None:
    """A listed value that is not an order code hides the pattern of an open part."""
    part = (
        '{name: part, meaning: Part, open: "[0-9]{3}", values: '
        '{100: {}, 101: {only_with: {resolution: ["12"]}}, 102: {only_with: {resolution: ["16"]}}}}'
    )
    rows = [(row.pattern, row.code is None) for row in open_codes(codes_of(tmp_path, part))]
    refused = {pattern for pattern, is_refused in rows if is_refused}
    assert refused == {"MIN16101SC", "MIN12102SC"}
    assert [pattern for pattern, is_refused in rows if not is_refused] == ["MIN12###SC", "MIN16###SC"]


def test_too_many_patterns_of_labels_are_refused(tmp_path: Path) -> None:
    values = ", ".join(f"{index:03}: {{}}" for index in range(500))
    spellings = "".join(
        f'    - {{pattern: "{letter}{other}{{resolution}}{{part}}{{output}}", where: label, source: "1"}}\n'
        for letter in "CDEFGHIJKL"
        for other in "ABCDEFGHIJK"
    )
    device = codes_of(tmp_path, f"{{name: part, meaning: Part, values: {{{values}}}}}", f"  also_written:\n{spellings}")
    with pytest.raises(TargetError, match="combine to more than 100000 patterns of labels"):
        open_codes(device)


def test_times_below_a_place_are_found_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nodes: list[int] = []
    times = quantities._times
    monkeypatch.setattr(quantities, "_times", lambda node: nodes.append(id(node)) or times(node))
    before = len(nodes)
    loaded(tmp_path, MINIMAL.read_text())
    few = len(nodes) - before
    errata = (
        f"  - {{name: e{index}, source: '1', printed: a, used: b, why: c, status: open, severity: wording,"
        " affects: [interfaces, crcs]}\n"
        for index in range(200)
    )
    _, report = loaded(tmp_path, MINIMAL.read_text() + "errata:\n" + "".join(errata))
    assert not report
    assert len(nodes) - before - few < few + 20


def test_a_path_is_looked_up_without_reading_its_list_again() -> None:
    class Items(list[Any]):
        reads = 0

        def __iter__(self) -> Iterator[Any]:
            Items.reads += 1
            return super().__iter__()

    found = places.Affected({"registers": Items([{"name": f"r{index}"} for index in range(50)])})
    assert [found.at(f"registers.r{index}") for index in range(50)] == [[{"name": f"r{index}"}] for index in range(50)]
    assert Items.reads == 1
