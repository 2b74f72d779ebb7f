"""Long specs are checked in a time that grows with their length, and long lists of problems end."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from codewheel.commands.check import as_data, as_text
from codewheel.commands.cli import main
from codewheel.language import messages, problems
from codewheel.language.problems import MAX_FOUND, MAX_PROBLEMS, TOO_MANY, ProblemReport
from codewheel.language.rules import order_code, times, walk
from codewheel.language.schemas import load_schema
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import TargetError
from codewheel.targets.c.order_codes import open_codes

MINIMAL = Path(__file__).parent / "ok" / "minimal.yaml"
MAKER = 'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nsource: "1"\n'


def write_spec(folder: Path, text: str) -> Path:
    (folder / "manufacturer.yaml").write_text(MAKER)
    (folder / "minimal.yaml").write_text(text)
    return folder


def load_spec(folder: Path, text: str) -> tuple[tuple[Device, ...], ProblemReport]:
    return load_library([write_spec(folder, text)])


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
        for subschema in schema.values():
            yield from lists_of(subschema)


@pytest.mark.parametrize("kind", ["device", "manufacturer", "master", "overlay"])
def test_every_list_has_a_limit(kind: str) -> None:
    for list_schema in lists_of(load_schema(kind)):
        assert list_schema.get("maxItems" if "items" in list_schema else "maxProperties", 2001) <= 2000, list_schema


def report_of(*counts: int, rule: str = "rule") -> ProblemReport:
    report = ProblemReport()
    for number, count in enumerate(counts):
        for line in range(1, count + 1):
            report.add_at(f"{number}.yaml", rule, f"wrong {line}", line=line, column=3, path="a.b", text="text")
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
    of_first_file = [problem for problem in report.shown if problem.file == "0.yaml"]
    of_second_file = [problem for problem in report.shown if problem.file == "1.yaml"]
    assert len(of_second_file) == 3
    assert [problem.line for problem in of_first_file[:MAX_PROBLEMS]] == list(range(1, MAX_PROBLEMS + 1))
    last = [(problem.rule, problem.line, problem.message) for problem in of_first_file[MAX_PROBLEMS:]]
    assert last == ([(TOO_MANY, MAX_PROBLEMS + 1, message)] if message else [])


def test_problems_that_were_not_looked_for_are_not_counted() -> None:
    report = report_of(MAX_PROBLEMS + 5)
    report.add_at("0.yaml", TOO_MANY, "there are more")
    assert len(report.shown) == MAX_PROBLEMS + 1
    assert report.shown[-1].message.startswith("there are at least 5 more problems from here on")
    report = report_of(MAX_PROBLEMS)
    report.add_at("0.yaml", TOO_MANY, "there are more")
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
    folder = write_spec(tmp_path, MINIMAL.read_text() + "device: minimal\n" * 500)
    assert main(["check", str(folder), "--no-cache"]) == 1
    out = capsys.readouterr().out
    assert out.count("duplicate-key") == MAX_PROBLEMS
    assert "there are 300 more problems from here on; they are reported once these are fixed" in out
    assert main(["list", str(folder), "--no-cache"]) != 0
    assert capsys.readouterr().err.count("duplicate-key") <= MAX_PROBLEMS


def erratum_text(index: int, affected: str) -> str:
    return (
        f"  - {{name: e{index}, title: Number {index} is wrong, source: '1', printed: a, used: b, why: c, status: open,"
        f" severity: wording, affects: [{affected}]}}\n"
    )


def test_no_rule_is_checked_after_many_problems(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[str] = []
    monkeypatch.setattr(problems, "is_typo", lambda word, known_word: bool(compared.append(word)))
    errata = "".join(erratum_text(index, f"crcs.other{index}") for index in range(MAX_FOUND + 100))
    _, report = load_spec(tmp_path, MINIMAL.read_text() + "errata:\n" + errata)
    assert len(report) == MAX_FOUND + 1
    assert len(report.shown) == MAX_PROBLEMS + 1
    assert report.shown[-1].message.startswith(f"there are at least {MAX_FOUND - MAX_PROBLEMS} more problems")
    assert len(set(compared)) <= MAX_FOUND + 1


def test_hints_for_unknown_keys_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hinted_keys: list[str] = []
    key_hint = messages._key_hint

    def count_hint(error: Any, path: Any, key: str) -> str:
        hinted_keys.append(key)
        return key_hint(error, path, key)

    monkeypatch.setattr(messages, "_key_hint", count_hint)
    text = MINIMAL.read_text().replace("title:", "titel:") + "".join(f"key_{index}: 1\n" for index in range(3000))
    _, report = load_spec(tmp_path, text)
    assert len(report) == MAX_PROBLEMS + 1
    assert len(hinted_keys) <= 2 * MAX_PROBLEMS


def test_values_of_a_part_are_collected_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    collected_parts: list[str] = []
    fits = order_code._label_test
    monkeypatch.setattr(order_code, "_label_test", lambda part: collected_parts.append(part.name) or fits(part))
    values = ", ".join(f"A{index}: {{}}" for index in range(300))
    _, report = load_spec(tmp_path, with_codes(f"{{name: part, meaning: Part, values: {{{values}}}}}"))
    assert not report
    assert sorted(collected_parts) == ["output", "part", "resolution"]


class CountedParts(dict[str, str]):
    """The parts of an order code, with a count of the accesses."""

    accesses = 0

    def __getitem__(self, key: str) -> str:
        CountedParts.accesses += 1
        return super().__getitem__(key)


def codes_of(folder: Path, part: str, more: str = "") -> Device:
    devices, report = load_spec(folder, with_codes(part, more))
    assert not report, report.problems[0]
    parts = (replace(variant, parts=MappingProxyType(CountedParts(variant.parts))) for variant in devices[0].variants)
    return replace(devices[0], variants=tuple(parts))


def test_each_order_code_is_looked_up_once(tmp_path: Path) -> None:
    values = ", ".join(f"{index:03}: {{}}" for index in range(300))
    device = codes_of(tmp_path, f'{{name: part, meaning: Part, open: "[0-9]{{3}}", values: {{{values}}}}}')
    CountedParts.accesses = 0
    rows = open_codes(device)
    assert len(rows) == len(device.variants) // 300
    assert CountedParts.accesses < 20 * len(device.variants)


def test_patterns_of_refused_codes_are_looked_up(tmp_path: Path) -> None:
    """A listed value that is not an order code hides the pattern of an open part."""
    part = (
        '{name: part, meaning: Part, open: "[0-9]{3}", values: '
        '{100: {}, 101: {only_with: {resolution: ["12"]}}, 102: {only_with: {resolution: ["16"]}}}}'
    )
    rows = [(row.pattern, row.order_code_index is None) for row in open_codes(codes_of(tmp_path, part))]
    refused = {pattern for pattern, is_refused in rows if is_refused}
    assert refused == {"MIN16101SC", "MIN12102SC"}
    assert [pattern for pattern, is_refused in rows if not is_refused] == ["MIN12###SC", "MIN16###SC"]


def test_too_many_patterns_of_labels_are_refused(tmp_path: Path) -> None:
    values = ", ".join(f"{index:03}: {{}}" for index in range(500))
    spellings = ""
    for letter, second_letter in product("CDEFGHIJKL", "ABCDEFGHIJK"):
        pattern = f"{letter}{second_letter}{{resolution}}{{part}}{{output}}"
        spellings += f'    - {{pattern: "{pattern}", where: label, source: "1"}}\n'
    device = codes_of(tmp_path, f"{{name: part, meaning: Part, values: {{{values}}}}}", f"  also_written:\n{spellings}")
    with pytest.raises(TargetError, match="combine to more than 100000 patterns of labels"):
        open_codes(device)


def test_times_below_a_place_are_found_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nodes: list[int] = []
    nanoseconds_in = times._nanoseconds_in
    monkeypatch.setattr(times, "_nanoseconds_in", lambda node: nodes.append(id(node)) or nanoseconds_in(node))
    before = len(nodes)
    load_spec(tmp_path, MINIMAL.read_text())
    nodes_without_errata = len(nodes) - before
    errata = "".join(erratum_text(index, "interfaces, crcs") for index in range(200))
    _, report = load_spec(tmp_path, MINIMAL.read_text() + "errata:\n" + errata)
    assert not report
    assert len(nodes) - before - nodes_without_errata < nodes_without_errata + 20


def test_a_path_is_looked_up_without_reading_its_list_again() -> None:
    class Items(list[Any]):
        reads = 0

        def __iter__(self) -> Iterator[Any]:
            Items.reads += 1
            return super().__iter__()

    affected = walk.ErratumTargets({"registers": Items([{"name": f"r{index}"} for index in range(50)])})
    for index in range(50):
        assert affected.values_at(f"registers.r{index}") == [{"name": f"r{index}"}]
    assert Items.reads == 1
