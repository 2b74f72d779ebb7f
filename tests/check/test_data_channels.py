"""Each contradiction in the data channels of a frame is reported at its place."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.outputs import load_for_targets, targets_named

SPECS = Path(__file__).resolve().parents[1] / "specs"
_CONTROL = "{name: singleturn, bits: control_bits, meaning: Angle within a revolution}"
_SAFE = "{name: safe_singleturn, bits: safety_bits, meaning: Angle within a revolution}"
_ORDER = "order: [control_word, safety_word]"
_COMPARED = "compared: {control_word: singleturn, safety_word: safe_singleturn}"

#: Texts of the valid spec with their replacements, the place in the spec, and the message.
CASES = {
    "listed twice": (
        {_ORDER: "order: [control_word, safety_word, control_word]"},
        ".order[3]",
        "'control_word' is listed twice; list each channel once",
    ),
    "other order than the layouts": (
        {_ORDER: "order: [safety_word, control_word]"},
        ".order[1]",
        (
            "'safety_word' is the first channel of the frame, but the first layout is 'control_word';"
            " correct one of them"
        ),
    ),
    "one channel": (
        {
            _ORDER: "order: [control_word]",
            _COMPARED: "tolerance: 0",
            "      compared_bits: accurate_bits\n": "",
            "      tolerance: 1\n": "",
        },
        ".order",
        "a frame with several channels has at least two; list all of them, or remove 'channels'",
    ),
    "no number": (
        {"        channel: 2\n": ""},
        ".order[2]",
        "'safety_word' has no 'channel'; give each channel of the frame its number",
    ),
    "carried as bytes": (
        {
            "        channel: 2\n": "        channel: 2\n        carried_as: bytes\n"
            "        byte_order: high_byte_first\n",
            "{name: safe_multiturn, bits: turn_bits,": "{name: safe_multiturn, bits: 12,",
            "{name: safe_singleturn, bits: safety_bits,": "{name: safe_singleturn, bits: 20,",
        },
        ".order[2]",
        "'safety_word' is carried as bytes, but a channel of a frame is one word of at most 64 bits",
    ),
    "open question": (
        {
            "measurement:": "alternatives:\n  - name: width\n    meaning: Bits of the counter\n    source: '1'\n"
            "    values:\n      short: {meaning: six, sets: {life_bits: 6}}\n"
            "      long: {meaning: eight, sets: {life_bits: 8}}\nmeasurement:",
            "  turn_bits: {": "  life_bits: {meaning: Bits of the counter, alternative: width}\n  turn_bits: {",
            "{name: life, bits: 6,": "{name: life, bits: life_bits,",
        },
        ".order[2]",
        (
            "'safety_word' depends on the question 'width', which decoders of a whole frame do not ask; remove"
            " 'channels', and decode each channel separately"
        ),
    ),
    "no position": (
        {"measurement: {of: position,": "measurement: {of: angle,", "join: {position:": "join: {place:"},
        ".order",
        "no channel of the frame contains the position; list the one that does",
    ),
    "two positions": (
        {
            "name: safe_multiturn": "name: multiturn",
            _SAFE: _CONTROL,
            "{name: crc, crc: safety_16}": "{name: crc, crc: safety_16}\n"
            "        join: {position: [multiturn, singleturn]}",
            "safety_word: safe_singleturn": "safety_word: singleturn",
        },
        ".order",
        (
            "'control_word' and 'safety_word' contain the position; name its fields differently in all but one of"
            " them, and list the fields in 'compared'"
        ),
    ),
    "no number of bits": (
        {"      compared_bits: accurate_bits\n": ""},
        "",
        "'compared' and 'compared_bits' need each other; give both or none",
    ),
    "one field": (
        {_COMPARED: "compared: {control_word: singleturn}"},
        ".compared",
        "one field cannot be compared; list the field of each channel",
    ),
    "unknown field": (
        {_COMPARED: "compared: {control_word: singleturn, safety_word: angle}"},
        ".compared.safety_word",
        "'safety_word' has no field 'angle'",
    ),
    "flag": (
        {_COMPARED: "compared: {control_word: singleturn, safety_word: warning}"},
        ".compared.safety_word",
        "'warning' is not an unsigned number, so its highest bits cannot be compared",
    ),
    "too many bits": (
        {"compared_bits: accurate_bits": "compared_bits: accurate_bits + 4"},
        ".compared_bits",
        "13 bits cannot be compared, because 'safe_singleturn' has 12 with safety_bits = 12, accurate_bits = 9",
    ),
    "any numbers agree": (
        {"tolerance: 1": "tolerance: 256"},
        ".tolerance",
        "with a tolerance of 256, any two numbers of 9 bits agree with control_bits = 16, accurate_bits = 9",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_contradictions_are_reported_at_their_place(case: str, tmp_path: Path) -> None:
    replacements, place, message = CASES[case]
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    for old, new in replacements.items():
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "channels.yaml").write_text(text, encoding="utf-8")
    _, report = load_for_targets([tmp_path, SPECS / "manufacturer.yaml"], targets_named())
    found = [problem for problem in report.problems if problem.rule == "data-channels"]
    assert [problem.message for problem in found] == [message]
    assert found[0].path == f"interfaces.biss.channels{place}"


def test_a_channel_that_is_not_in_the_frame_cannot_be_compared(tmp_path: Path) -> None:
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    third = text[text.index("      - name: safety_word") :]
    third = third.replace("name: safety_word", "name: third_word").replace("channel: 2", "channel: 3")
    text = text.replace("{control_word: singleturn, safety_word:", "{control_word: singleturn, third_word:") + third
    (tmp_path / "channels.yaml").write_text(text, encoding="utf-8")
    _, report = load_for_targets([tmp_path, SPECS / "manufacturer.yaml"], targets_named())
    messages = [problem.message for problem in report.problems]
    assert messages == ["'third_word' is not in 'order'; add it, or leave it out here"]


@pytest.mark.parametrize(("wrong", "rule"), [("other_bits", "undefined-reference"), ('"9 *"', "bad-expression")])
def test_the_number_of_compared_bits_must_be_an_expression_of_parameters(tmp_path: Path, wrong: str, rule: str) -> None:
    text = (SPECS / "channels.yaml").read_text(encoding="utf-8")
    assert "compared_bits: accurate_bits" in text
    (tmp_path / "channels.yaml").write_text(
        text.replace("compared_bits: accurate_bits", f"compared_bits: {wrong}"), encoding="utf-8"
    )
    _, report = load_for_targets([tmp_path, SPECS / "manufacturer.yaml"], targets_named())
    found = [(problem.rule, problem.path) for problem in report.problems]
    assert found == [(rule, "interfaces.biss.channels.compared_bits")]
