"""Overlays: their effects, and the exact messages about invalid ones."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.language.problems import ProblemReport
from codewheel.loading.library import load_families, load_library, load_valid
from codewheel.model import Device
from xml_reader import from_xml

# Loads a whole library for each overlay, independent of wording and rules of check.
pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs" / "lika"
HEAD = "codewheel: 1\noverlay: mine\nof: amm5\ntitle: Measured here\nchanges:\n"
OWN = '    why: Measured.\n    source: "6.4"\n'


def load_with_overlays(tmp_path: Path, *texts: str) -> tuple[Sequence[Device], list[str], ProblemReport]:
    """Return AMM5 with overlays, and each problem as ``line:column: rule: message``."""
    paths = [SPECS / "amm5.yaml"]
    for number, text in enumerate(texts):
        paths.append(tmp_path / f"o{number}.yaml")
        paths[-1].write_text(text, encoding="utf-8")
    devices, report = load_library(paths)
    messages = [problem.format().splitlines()[0].removeprefix(f"{tmp_path}/") for problem in report.problems]
    return devices, messages, report


def messages_of_change(tmp_path: Path, changes: str) -> list[str]:
    return load_with_overlays(tmp_path, HEAD + changes)[1]


def test_a_correction_takes_the_place_of_the_value(tmp_path: Path) -> None:
    change = "  - set: registers.manufacturer_id.meaning\n    to: The maker\n" + OWN
    (device,), messages, _ = load_with_overlays(tmp_path, HEAD + change)
    assert messages == []
    assert (device.name, device.base) == ("amm5", "")
    assert device.register("manufacturer_id").meaning == "The maker"
    erratum = device.errata[-1]
    assert (erratum.name, erratum.overlay, erratum.affects) == (
        "mine_1",
        "mine",
        ("registers.manufacturer_id.meaning",),
    )
    assert (erratum.printed, erratum.used) == ("manufacturer_id.meaning: Manufacturer", "The maker")
    assert (erratum.why, str(erratum.source[0]), erratum.severity) == ("Measured.", "6.4", "wrong_data")


def test_items_are_added_and_removed(tmp_path: Path) -> None:
    changes = (
        "  - add: timings\n    value: {name: start_up, meaning: Time to start, at_most_us: 900000, source: '4'}\n"
        + OWN
        + "  - add: registers.manufacturer_id.note\n    value: Never written.\n"
        + OWN
        + "  - remove: [examples.serial_number, registers.serial_number]\n"
        + OWN
    )
    (device,), messages, _ = load_with_overlays(tmp_path, HEAD + changes)
    assert messages == []
    assert device.timings[-1].at_most_us == 900_000
    assert device.register("manufacturer_id").note == "Never written."
    assert "serial_number" not in {register.name for register in device.registers}
    # An erratum no longer refers to removed parts.
    order = next(erratum for erratum in device.errata if erratum.name == "serial_number_order")
    assert order.affects == ()
    assert [erratum.used for erratum in device.errata if erratum.overlay][-2:] == ["left out", "left out"]


def test_what_is_unknown_is_taken_away_and_said_to_be_unknown(tmp_path: Path) -> None:
    changes = "  - unknown: [registers.serial_number, examples.serial_number]\n" + OWN
    (device,), messages, _ = load_with_overlays(tmp_path, HEAD + changes)
    assert messages == []
    assert all(register.name != "serial_number" for register in device.registers)
    assert [(erratum.printed, erratum.used, erratum.status) for erratum in device.errata if erratum.overlay] == [
        ("serial_number", "not known", "open"),
        ("examples.serial_number", "not known", "open"),
    ]


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            "  - set: registers.comand.access\n    to: read_write\n" + OWN,
            (
                "o0.yaml:6:10: overlay-unused: there is nothing at 'registers.comand.access': "
                "'registers' has no 'comand'; "
                "did you mean 'command'?"
            ),
        ),
        (
            "  - set: procedures.set_preset.steps[99].meaning\n    to: x\n" + OWN,
            (
                "o0.yaml:6:10: overlay-unused: there is nothing at 'procedures.set_preset.steps[99].meaning': "
                "'procedures.set_preset.steps' has no '[99]'"
            ),
        ),
        (
            "  - set: registers.command.wait_at_least_ms\n    to: 30\n" + OWN,
            "o0.yaml:6:10: overlay-unused: the spec already has 30 here; leave the change out",
        ),
        (
            "  - set: registers.command.address\n    to: 0x77\n" + OWN,
            "o0.yaml:6:10: overlay-unused: the spec already has 0x77 here; leave the change out",
        ),
        (
            "  - add: registers.command.wait_at_least_ms\n    value: 40\n" + OWN,
            ("o0.yaml:6:10: overlay-unused: 'registers.command.wait_at_least_ms' already exists; change it with 'set'"),
        ),
        (
            "  - add: registers\n    value: {name: command}\n" + OWN,
            "o0.yaml:6:10: overlay-unused: 'registers' already has 'command'; change it with 'set'",
        ),
        (
            "  - remove: registers.nothing\n" + OWN,
            (
                "o0.yaml:6:13: overlay-unused: there is nothing at 'registers.nothing': 'registers' has no 'nothing'; "
                "known: preset, preset_setting_enable, serial_number, command, device_id, manufacturer_id"
            ),
        ),
        (
            "  - set: registers.command.note\n    to: A\n" + OWN + "  - remove: registers.command\n" + OWN,
            "o0.yaml:10:13: overlay-conflict: o0.yaml:6 changes the same location; keep one of the two",
        ),
        (
            "  - set: registers.command.note\n    to: A\n    remove: registers.command\n" + OWN,
            (
                "o0.yaml:6:5: overlay-change: this change has 'set' and 'remove'; "
                "use exactly one of 'set', 'add', 'remove', 'unknown' and 'also'"
            ),
        ),
        (
            "  - to: 5\n" + OWN,
            (
                "o0.yaml:6:5: overlay-change: this change does nothing; "
                "use exactly one of 'set', 'add', 'remove', 'unknown' and 'also'"
            ),
        ),
        ("  - set: title\n" + OWN, "o0.yaml:6:5: overlay-change: a change with 'set' needs 'to'"),
        (
            "  - remove: leds\n    value: 5\n" + OWN,
            "o0.yaml:6:5: overlay-change: a change with 'remove' cannot have 'value'",
        ),
        (
            "  - set: device\n    to: other\n" + OWN,
            ("o0.yaml:6:10: overlay-change: an overlay cannot change 'device', only facts about the encoder"),
        ),
        (
            "  - set: ../../etc/passwd\n    to: x\n" + OWN,
            (
                "o0.yaml:6:10: bad-pattern: 'set' cannot be '../../etc/passwd': a place consists of keys and names "
                "joined by dots, with numbers for unnamed items, as in procedures.set_preset.steps[3]"
            ),
        ),
        (
            "  - remove: leds\n    why: Measured.\n",
            "o0.yaml:6:5: missing-key: 'source' is missing; a change needs it",
        ),
        (
            "  - remove: leds\n    why: Measured.\n    source: 'ti: 3'\n",
            "o0.yaml:8:13: undefined-reference: there is no edition or document 'ti'",
        ),
    ],
    ids=lambda text: text.strip().splitlines()[0][:30],
)
def test_what_is_wrong_with_a_change_is_said_where_it_stands(changes: str, message: str, tmp_path: Path) -> None:
    assert messages_of_change(tmp_path, changes)[0] == message


def test_a_wrong_value_is_told_in_the_overlay(tmp_path: Path) -> None:
    messages = messages_of_change(tmp_path, "  - set: registers.command.access\n    to: sometimes\n" + OWN)
    assert messages[0] == (
        "o0.yaml:7:9: not-allowed: 'access' cannot be 'sometimes'; use one of: read_only, read_write, write_only"
    )
    messages = messages_of_change(tmp_path, "  - set: crcs.biss_6.poly\n    to: 0x143\n" + OWN)
    assert messages[0].startswith("o0.yaml:7:9: crc-impossible: the polynomial 0x143 does not fit into 6 bits")


def test_what_the_spec_lacks_under_an_overlay_is_told_in_the_overlay(tmp_path: Path) -> None:
    messages = messages_of_change(tmp_path, "  - remove: registers.serial_number\n" + OWN)
    line = (SPECS / "amm5.yaml").read_text(encoding="utf-8").splitlines().index("    register: serial_number") + 1
    assert messages == [
        (
            f"o0.yaml:2:10: undefined-reference: with this overlay, amm5.yaml:{line}, "
            "examples.serial_number.register: there is no register 'serial_number'; known: preset, "
            "preset_setting_enable, command, device_id, manufacturer_id"
        )
    ]


def test_two_overlays_may_not_set_one_place(tmp_path: Path) -> None:
    text = HEAD + "  - set: registers.command.note\n    to: A\n" + OWN
    theirs = text.replace("mine", "theirs").replace("to: A", "to: B")
    assert load_with_overlays(tmp_path, text, theirs)[1] == [
        "o1.yaml:6:10: overlay-conflict: o0.yaml:6 changes the same location; keep one of the two"
    ]
    assert (
        load_with_overlays(tmp_path, text, text)[1][0] == "o1.yaml:2:10: duplicate-name: o0.yaml is also called 'mine'"
    )


def test_an_overlay_names_a_family_that_was_read_and_never_a_file(tmp_path: Path) -> None:
    text = HEAD + "  - remove: leds\n" + OWN
    assert load_with_overlays(tmp_path, text.replace("of: amm5", "of: am36"))[1] == [
        "o0.yaml:3:5: undefined-reference: there is no family 'am36' among the specs that were read; known: amm5"
    ]
    assert load_with_overlays(tmp_path, text.replace("of: amm5", "of: ../amm5.yaml"))[1][0].startswith(
        "o0.yaml:3:5: bad-pattern: 'of' cannot be '../amm5.yaml': a name begins with a lowercase letter"
    )


def test_order_codes_of_a_special_model_exist(tmp_path: Path) -> None:
    text = HEAD.replace("changes:", "applies_to: {special: S007, order_codes: [AMM5A21/65KSC2]}\nchanges:")
    messages = load_with_overlays(tmp_path, text + "  - set: registers.command.note\n    to: A\n" + OWN)[1]
    assert messages == ["o0.yaml:5:43: undefined-reference: 'AMM5A21/65KSC2' is not a listed order code of the family"]


def test_a_faulty_special_model_takes_nothing_from_the_family(tmp_path: Path) -> None:
    text = HEAD.replace("changes:", "applies_to: {special: S007}\nchanges:") + "  - remove: nowhere\n" + OWN
    path = tmp_path / "o.yaml"
    path.write_text(text, encoding="utf-8")
    devices, report = load_valid([SPECS / "amm5.yaml", path])
    assert [device.name for device in devices] == ["amm5"]
    assert len(report) == 1


@pytest.mark.parametrize("applies_to", ["", "applies_to: {special: S007}\n"])
def test_an_invalid_overlay_next_to_a_valid_one_makes_their_family_faulty(applies_to: str, tmp_path: Path) -> None:
    """A family with only one of two corrections would be mistaken for the corrected family."""
    head = HEAD.replace("changes:", f"{applies_to}changes:")
    valid = head + "  - set: registers.command.note\n    to: Slow.\n" + OWN
    invalid = head.replace("mine", "theirs") + "  - remove: leds\n    misspelt: 1\n" + OWN
    paths = [SPECS / "amm5.yaml", tmp_path / "valid.yaml", tmp_path / "invalid.yaml"]
    paths[1].write_text(valid, encoding="utf-8")
    paths[2].write_text(invalid, encoding="utf-8")
    devices, report = load_valid(paths)
    assert [problem.rule for problem in report.problems] == ["unknown-key"]
    assert [device.name for device in devices] == (["amm5"] if applies_to else [])


def test_a_special_model_is_a_family_beside_its_own(tmp_path: Path) -> None:
    text = HEAD.replace("changes:", "applies_to: {special: S007, order_codes: [AMM5A21/65KSC1]}\nchanges:")
    (plain, special), messages, _ = load_with_overlays(
        tmp_path, text + "  - set: registers.command.note\n    to: Slow.\n" + OWN
    )
    assert messages == []
    assert (plain.name, special.name, special.base) == ("amm5", "amm5_s007", "amm5")
    assert plain.register("command").note != "Slow." == special.register("command").note
    assert [variant.code for variant in special.variants] == ["AMM5A21/65KSC1"]
    assert [interface.name for interface in special.interfaces] == ["biss"]
    assert from_xml(to_xml(device_dump(special)).encode()) == device_dump(special)


def test_an_overlay_beside_its_spec_is_found_by_its_name(tmp_path: Path) -> None:
    for name in ("amm5.yaml", "manufacturer.yaml"):
        (tmp_path / name).write_text((SPECS / name).read_text(encoding="utf-8"), encoding="utf-8")
    text = HEAD + "  - set: registers.command.note\n    to: Slow.\n" + OWN
    (tmp_path / "amm5.mine.overlay.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "amm50.other.overlay.yaml").write_text("no: overlay of this one\n", encoding="utf-8")
    (family,), report = load_families([tmp_path / "amm5.yaml"])
    assert not report.problems
    assert family.device.register("command").note == "Slow."
    assert family.without_overlays is not None
    assert family.without_overlays.device.register("command").note != "Slow."


def test_second_readings_are_held_against_the_spec_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in SPECS.glob("amm5*.yaml"):
        (tmp_path / path.name).write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text((SPECS / "manufacturer.yaml").read_text(encoding="utf-8"))
    text = HEAD + "  - set: registers.serial_number.access\n    to: read_write\n" + OWN
    (tmp_path / "mine.yaml").write_text(text, encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 0
    assert "no problems in 1 family: amm5" in capsys.readouterr().out


def test_an_overlay_alone_lies_over_what_ships(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(HEAD + "  - set: registers.command.note\n    to: Slow here.\n" + OWN, encoding="utf-8")
    assert main(["show", "amm5", "--specs", str(path)]) == 0
    out = capsys.readouterr().out
    assert "Slow here." in out
    assert "This includes the overlay mine, “Measured here”." in out
    assert "Overlay mine [6.4]: In the spec: " in " ".join(out.split())
    assert "Why: Measured." in out
