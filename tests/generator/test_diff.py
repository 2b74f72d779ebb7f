"""What another version of a spec changes: each fact by its path, breaking or compatible."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from codewheel.build.load import load_library
from codewheel.commands.cli import main
from codewheel.commands.diff import Change, as_text, compare
from codewheel.commands.new import device_text, manufacturer_text
from codewheel.model import Device


def devices(folder: Path, *replaced: tuple[str, str], name: str = "demo") -> tuple[Device, ...]:
    folder.mkdir(exist_ok=True)
    text = device_text(name, "maker", "")
    for old, new in replaced:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    (folder / "manufacturer.yaml").write_text(manufacturer_text(""), encoding="utf-8")
    found, report = load_library([folder])
    assert not report.problems, report.problems[0].format()
    return found


def changes(tmp_path: Path, *replaced: tuple[str, str]) -> list[Change]:
    return compare(devices(tmp_path / "old"), devices(tmp_path / "new", *replaced))


def told(tmp_path: Path, *replaced: tuple[str, str]) -> set[tuple[str, str, object, object, str]]:
    return {(item.path, item.how, item.old, item.new, item.effect) for item in changes(tmp_path, *replaced)}


def test_the_same_spec_has_no_difference(tmp_path: Path) -> None:
    assert changes(tmp_path) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("address: 0x48", "address: 0x4A", ("registers.command.address", "changed", 0x48, 0x4A, "breaking")),
        (
            "min_hz: 200000,",
            "min_hz: 100000,",
            ("interfaces.biss.clock.min_hz", "changed", 200000, 100000, "compatible"),
        ),
        (
            "makes_position: not_usable",
            "makes_position: usable_with_warning",
            (
                "layouts.single_cycle_data.fields.error.makes_position",
                "changed",
                "not_usable",
                "usable_with_warning",
                "breaking",
            ),
        ),
        (
            "max_hz: 10000000",
            "max_hz: 5000000",
            ("interfaces.biss.clock.max_hz", "changed", 10000000, 5000000, "breaking"),
        ),
        (
            "at_least_ms: 30",
            "at_least_ms: 40",
            ("procedures.set_preset.steps.3.microseconds", "changed", 30000, 40000, "breaking"),
        ),
        ("xorout: 0x3F", "xorout: 0", ("crcs.biss_6.xorout", "changed", 0x3F, 0, "breaking")),
        (
            "active: low, makes_position: not_usable",
            "active: high, makes_position: not_usable",
            ("layouts.single_cycle_data.fields.error.active", "changed", "low", "high", "breaking"),
        ),
        (
            "meaning: Saves what was written",
            "meaning: Saves all",
            (
                "registers.command.fields.function.values.save.meaning",
                "changed",
                "Saves what was written",
                "Saves all",
                "compatible",
            ),
        ),
        (
            "save: {value: 1,",
            "save: {value: 2,",
            ("registers.command.fields.function.values.save.value", "changed", 1, 2, "breaking"),
        ),
        ("    default: 0\n", "", ("registers.preset.default", "removed", 0, None, "breaking")),
        (
            "    max: 2^singleturn_bits - 1\n",
            "    max: 1000\n",
            ("registers.preset.max", "changed", "2^singleturn_bits - 1", 1000, "breaking"),
        ),
        (
            "title: @ absolute encoder".replace("@", "DEMO"),
            "title: Demo",
            ("title", "changed", "DEMO absolute encoder", "Demo", "compatible"),
        ),
    ],
)
def test_one_changed_fact(tmp_path: Path, old: str, new: str, expected: tuple[str, str, object, object, str]) -> None:
    assert expected in told(tmp_path, (old, new))


def test_an_address_changes_nothing_else(tmp_path: Path) -> None:
    assert told(tmp_path, ("address: 0x48", "address: 0x4A")) == {
        ("registers.command.address", "changed", 0x48, 0x4A, "breaking")
    }


def test_a_new_width_moves_the_fields_and_adds_order_codes(tmp_path: Path) -> None:
    added = '        "17": {meaning: "131,072 counts per turn", sets: {singleturn_bits: 17}}\n'
    found = changes(tmp_path, (added, added + '        "19": {meaning: 19 bits, sets: {singleturn_bits: 19}}\n'))
    assert {(item.path, item.how, item.effect) for item in found} == {
        ("order_code_grammar.parts.singleturn.values.19", "added", "compatible"),
        ("order_codes.DEMO-19-SC", "added", "compatible"),
    }
    back = compare(
        devices(tmp_path / "new", (added, added + '        "19": {meaning: 19 bits, sets: {singleturn_bits: 19}}\n')),
        devices(tmp_path / "old"),
    )
    assert {(item.path, item.how, item.effect) for item in back} == {
        ("order_code_grammar.parts.singleturn.values.19", "removed", "breaking"),
        ("order_codes.DEMO-19-SC", "removed", "breaking"),
    }


def test_a_new_restriction_is_breaking(tmp_path: Path) -> None:
    opened = "    default: 0\n    opened_by: {register: command, value: save}\n"
    assert [(item.path, item.how, item.effect) for item in changes(tmp_path, ("    default: 0\n", opened))] == [
        ("registers.preset.opened_by", "added", "breaking")
    ]


def test_families_that_come_and_go(tmp_path: Path) -> None:
    old = devices(tmp_path / "old") + devices(tmp_path / "more", name="second")
    found = compare(old, (*devices(tmp_path / "new"), *devices(tmp_path / "other", name="third")))
    assert [(item.family, item.path, item.how, item.effect) for item in found] == [
        ("second", "", "removed", "breaking"),
        ("third", "", "added", "compatible"),
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("xorout: 0x3F", "xorout: 0x2F", "crcs.biss_6.xorout: 3Fh (63) -> 2Fh (47)"),
        (
            "save: {value: 1,",
            "save: {value: 0x20,",
            "registers.command.fields.function.values.save.value: 1 -> 20h (32)",
        ),
    ],
)
def test_numbers_that_manuals_print_in_hexadecimal(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert expected in as_text(changes(tmp_path, (old, new)))


def test_a_parameter_without_a_unit_is_a_code(tmp_path: Path) -> None:
    words = ("\nparameters:\n", "\nparameters:\n  profile: {meaning: Profile ID, equals: 2104}\n")
    other = (words[0], words[1].replace("2104", "2105"))
    text = as_text(compare(devices(tmp_path / "old", words), devices(tmp_path / "new", other)))
    assert ".parameters.profile: 838h (2104) -> 839h (2105)" in text


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    devices(tmp_path / "old")
    devices(tmp_path / "new", ("address: 0x48", "address: 0x4A"), ("max_hz: 10000000", "max_hz: 12000000"))
    old, new = str(tmp_path / "old" / "demo.yaml"), str(tmp_path / "new")
    assert main(["diff", old, old]) == 0
    assert capsys.readouterr().out == "no difference\n"
    assert main(["diff", old, new]) == 1
    assert capsys.readouterr().out == (
        "demo\n"
        "  breaking    registers.command.address: 48h -> 4Ah\n"
        "  compatible  interfaces.biss.clock.max_hz: 10000000 -> 12000000\n"
        "2 changes, 1 breaking\n"
    )
    assert main(["diff", old, new, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["version"], found["breaking"]) == (1, 1)
    assert {
        "family": "demo",
        "path": "registers.command.address",
        "change": "changed",
        "old": 72,
        "new": 74,
        "effect": "breaking",
    } in found["changes"]
    assert main(["diff", old, str(tmp_path / "nowhere.yaml")]) == 2


def test_a_decision_that_a_frame_needs_breaks_its_callers(amm5: Device) -> None:
    before = replace(amm5, alternatives=())
    found = {item.path: item for item in compare([before], [amm5])}
    needed = found["layouts.eeprom_read_reply.alternatives"]
    assert (needed.how, needed.new, needed.breaking) == ("added", ["eeprom_address"], True)
    assert not found["alternatives.eeprom_address"].breaking
    again = {item.path: item for item in compare([amm5], [before])}
    assert again["layouts.eeprom_read_reply.alternatives"].breaking
