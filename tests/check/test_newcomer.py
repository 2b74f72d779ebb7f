"""Mistakes in filling in the spec that ``new`` writes: each is one problem that suggests what to write."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.check.specs import check_specs
from codewheel.commands.new import device_text, manufacturer_text

ERROR = "          - {name: error, active: low, makes_position: not_usable, when_active: an error is active}\n"
WARNING = (
    "          - {name: warning, active: low, makes_position: usable_with_warning, when_active: a warning is active}\n"
)
SAVE = "save: {value: 1, printed_name: Save parameters, meaning: Saves what was written}"
SEVENTEEN = '"17": {meaning: "131,072 counts per turn", sets: {singleturn_bits: 17}}'
ANY_NAME = "a name begins with a lowercase letter and contains only lowercase letters, digits and single underscores"

#: Text of the spec, the mistake, and the problem: its line, its rule and a part of its message.
MISTAKES = {
    # Formerly accepted.
    "address with a leading zero": ("address: 0x50", "address: 050", "123", "number-base", "write 0x50"),
    "address without 0x": ("address: 0x50", "address: 50", "123", "number-base", "write 0x50"),
    "nE active high": ("error, active: low", "error, active: high", "94", "biss-protocol", "write 'active: low'"),
    "nW before nE": (ERROR + WARNING, WARNING + ERROR, "94", "biss-protocol", "swap the two"),
    "register at 78h": ("address: 0x50", "address: 0x78", "123", "biss-protocol", "BiSS has 'device_id'"),
    "register at 7Ch": ("address: 0x50", "address: 0x7C", "123", "biss-protocol", "BiSS has 'device_id'"),
    "register at 42h": ("address: 0x50", "address: 0x42", "123", "biss-protocol", "BiSS has 'profile_id'"),
    "CRC not inverted": ("xorout: 0x3F", "xorout: 0", "100", "biss-protocol", "write 'xorout: 0x3f'"),
    "CRC start": ("init: 0\n", "init: 0x3F\n", "159", "example-contradicts", "with 'init: 0x0' in the CRC 'biss_6'"),
    "counts as maximum": (
        "max: 2^singleturn_bits - 1", "max: 2^singleturn_bits", "129", "limit-does-not-fit", "end at 8191",
    ),
    "maximum above": (
        "max: 2^singleturn_bits - 1", "max: 2^singleturn_bits + 1000", "129", "limit-does-not-fit", "end at 8191",
    ),
    "typographic quotes": (
        "Set and save a preset", "“Set and save a preset”", "134", "typographic-quotes", "with straight quotes",
    ),
    "bits of a meaning": (
        SEVENTEEN, '"17": {meaning: 17 bits, sets: {singleturn_bits: 16}}', "49", "meaning-mismatch", "says 17 bits",
    ),
    # Earlier, the message did not say what to write instead.
    "value without a map": (SAVE, "save: 1", "116", "wrong-type", "write 'save: {value: 1}'"),
    "value before its name": (SAVE, "1: save", "116", "bad-pattern", "the name comes first, as in 'save: {value: 1}'"),
    "no for false": ("refin: false", "refin: no", "66", "wrong-type", "write false"),
    "bytes of a default": ("default: 0", "default: [0, 0, 3, 232]", "127", "wrong-type", "write one number: 0x3e8 if"),
    "text of a default": ("default: 0", 'default: "00 00 00 00"', "127", "wrong-type", "write one number: 0x0"),
    "digits without 0x": ("address: 0x50", "address: 5A", "123", "wrong-type", "write 0x5A"),
    "active_low": ("error, active: low", "error, active_low: true", "94", "unknown-key", "write 'active: low'"),
    "description": (
        "    meaning: New value", "    description: New value", "121", "unknown-key", "it is called 'meaning' here",
    ),
    "offset": ("address: 0x50", "offset: 0x50", "123", "unknown-key", "it is called 'address' here"),
    "size": ("    length: 4", "    size: 4", "124", "unknown-key", "it is called 'length' here"),
    "type": ("    length: 4", "    type: uint32_t", "124", "unknown-key", "write 'length: 4'"),
    "type of access": ("access: read_write", "type: read_write", "125", "unknown-key", "it is called 'access' here"),
    "endianness": (
        "byte_order: high_byte_first", "endianness: big", "126", "unknown-key", "write 'byte_order: high_byte_first'",
    ),
    "access in short": ("access: read_write", "access: rw", "125", "not-allowed", "write 'read_write'"),
    # Earlier, the message was misleading, or there were several.
    "no-break space": ("title: Set", "title:\u00a0Set", "134", "yaml-syntax", "the space U+00A0"),
    "no-break indentation": ("    length: 4", "\u00a0   length: 4", "124", "yaml-syntax", "the space U+00A0"),
    "power of Python": (
        "max: 2^singleturn_bits - 1", "max: 2**singleturn_bits - 1", "129", "bad-expression", "write 2^single",
    ),
    "power of C": (
        "max: 2^singleturn_bits - 1", "max: (1 << singleturn_bits) - 1", "129", "bad-expression", "write 2^single",
    ),
    "capital letter": ("name: preset\n", "name: Preset\n", "119", "bad-pattern", ANY_NAME),
    "another interface": (
        "  biss:\n", "  endat:\n", "83", "unknown-key", "codewheel supports only ssi, biss, spi and rs485",
    ),
}  # fmt: skip


def problems(tmp_path: Path, text: str) -> list[tuple[str, str, str]]:
    (tmp_path / "my_encoder.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(manufacturer_text("m.json"), encoding="utf-8")
    report = check_specs([tmp_path], ()).report
    return [(str(item.line), item.rule, item.message) for item in report.problems]


@pytest.mark.parametrize(("old", "new", "line", "rule", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_problem(tmp_path: Path, old: str, new: str, line: str, rule: str, words: str) -> None:
    text = device_text("my_encoder", "example", "d.json")
    assert old in text
    ((actual_line, actual_rule, message),) = problems(tmp_path, text.replace(old, new, 1))
    assert (actual_line, actual_rule) == (line, rule)
    assert words in message


@pytest.mark.parametrize("crc", ["", "          - {name: crc, bits: 6}\n"])
def test_a_frame_without_its_crc_is_reported(tmp_path: Path, crc: str) -> None:
    text = device_text("my_encoder", "example", "d.json")
    old = "          - {name: crc, crc: biss_6}\n"
    assert old in text
    reported = problems(tmp_path, text.replace(old, crc))
    assert [problem[:2] for problem in reported] == [("62", "unused-crc"), ("87", "biss-protocol")]


def test_an_unknown_interface_used_everywhere_is_one_problem(tmp_path: Path) -> None:
    text = device_text("my_encoder", "example", "d.json").replace("biss:\n", "endat:\n")
    text = text.replace("interface: biss", "interface: endat")
    assert [problem[:2] for problem in problems(tmp_path, text)] == [("83", "unknown-key")]


def test_a_name_with_another_mistake_hides_no_wrong_reference(tmp_path: Path) -> None:
    text = device_text("my_encoder", "example", "d.json").replace("name: preset\n", "name: Preset\n")
    reported = problems(tmp_path, text.replace("register: command", "register: comand"))
    assert [problem[:2] for problem in reported] == [("119", "bad-pattern"), ("139", "undefined-reference")]
