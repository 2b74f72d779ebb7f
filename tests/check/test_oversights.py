"""Mistakes in the specs that ``new`` writes which only the spec itself shows, and the fix of each."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.check.specs import check_specs
from codewheel.commands.new import device_text, manufacturer_text

READ_ZERO = "{name: read, bits: 1, constant: 0, meaning: 1 to read and 0 to write}"
READ_ONE = READ_ZERO.replace("constant: 0", "constant: 1")
REQUEST = f"          - {READ_ONE}\n          - {{name: address, bits: 14, constant: 0x3FFF"
BISS_CLOCK = "clock: {min_hz: 200000, max_hz: 10000000"
POSITION = (
    "          - {name: position, bits: singleturn_bits, unit: counts, meaning: Position within one revolution}\n"
)
ERROR = "          - {name: error, active: low, makes_position: not_usable, when_active: an error is active}\n"
STEPS = "      - {do: write, register: preset, value: position, meaning: write the four preset registers}\n"
SAVE = "      - {do: write, register: command, value: save, meaning: keep it after power-off}\n"
CRC_FIELD = "          - {name: crc, crc: biss_6}\n"
CHANGES = 'history:\n    - {revision: "1.0", changes: First issue.}'

#: Kind of template, its text, the mistake, the rule, and a part of the message.
MISTAKES = {
    "clock in kHz": (
        "", BISS_CLOCK, "clock: {min_hz: 200, max_hz: 10000", "implausible-rate", "write 10000000",
    ),
    "clock in MHz over SPI": ("spi", "max_hz: 10000000", "max_hz: 10", "implausible-rate", "10 MHz, write 10000000"),
    "baud rate in Mbaud": ("rs485", "baud: 2500000", "baud: 2", "implausible-rate", "2 Mbaud, write 2000000"),
    "error as a number": (
        "ssi", "          # An error bit", "          - {name: error, bits: 1}\n          # An error bit", "plain-bit",
        "write 'active: high'",
    ),
    "parity as a number": (
        "ssi", "          # An error bit", "          - {name: parity, bits: 1}\n          # An error bit", "plain-bit",
        "write 'parity_of",
    ),
    "position request that writes": (
        "spi", REQUEST, REQUEST.replace("bits: 1, constant: 1", "bits: 1, constant: 0"), "spi-exchange", "would write",
    ),
    "saved before written": ("", STEPS + SAVE, SAVE + STEPS, "saved-too-early", "before 'preset' is written"),
    "revision not in its history": (
        "", 'revision: "1.0"          ', 'revision: "1.1"          ', "revision-not-in-history", "lists 1.0",
    ),
    "formula of a parameter": (
        "ssi", "equals: multiturn_bits + singleturn_bits", "equals: multiturn_bits + 1", "parameter-width",
        "'position' in 'ssi_word' has 13 bits",
    ),
    "gray without of": (
        "ssi", "        # gray: {of: position}  ", "        gray: true\n        # ", "wrong-type",
        "write 'gray: {of: position}'",
    ),
    "half a micrometre": (
        "linear", "step_um: resolution_um", "step_um: 0.5", "wrong-type", "write 'step_nm: 500'",
    ),
    "part of a micrometre": (
        "linear", "step_um: resolution_um", "step_um: 0.9765625", "wrong-type",
        # 0.9765625 µm are 976.5625 nm, or 15,625 nm in 16 steps.
        "such as 'step_nm: 15625' with 'per_counts: 16'",
    ),
    "baud rate with its unit": ("rs485", "baud: 2500000", "baud: 2.5 Mbaud", "wrong-type", "write 2500000, in baud"),
    "baud rate with a fraction": (
        "rs485", "baud: 2500000", "baud: 115.2", "wrong-type", "if it is in kbaud, write 115200",
    ),
    "clock with a fraction": ("spi", "max_hz: 10000000", "max_hz: 2.5", "wrong-type", "in MHz, write 2500000"),
    "word with another length": (
        "spi", "word_bits: 16", "word_bits: 15", "width-mismatch", "'word_bits' is 15, but every layout has 16 bits",
    ),
    "another width of the CRC": (
        "", "width: 6", "width: 8", "biss-protocol", "inverts 6 bits; write 'width: 6', or 'xorout: 0xff'",
    ),
}  # fmt: skip


def problems(folder: Path, text: str) -> list[tuple[str, str]]:
    (folder / "my_encoder.yaml").write_text(text, encoding="utf-8")
    (folder / "manufacturer.yaml").write_text(manufacturer_text("m.json"), encoding="utf-8")
    return [(problem.rule, problem.message) for problem in check_specs([folder], ()).report.problems]


@pytest.mark.parametrize(("like", "old", "new", "rule", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_reported_with_a_way_out(
    tmp_path: Path, like: str, old: str, new: str, rule: str, words: str
) -> None:
    text = device_text("my_encoder", "example", "d.json", like)
    assert old in text
    reported = problems(tmp_path, text.replace(old, new, 1))
    ((name, message),) = [problem for problem in reported if problem[0] == rule]
    assert name == rule
    assert words in message


#: Steps that the template and the message about ``step_um`` suggest, with the words of the template.
ADVICE = {
    "step_nm: 500": "'step_nm: 500' for 0.5 µm",
    "step_nm: 1000000, per_counts: 1024": "'step_nm: 1000000' with 'per_counts: 1024' for 1000/1024 µm",
    "step_nm: 15625, per_counts: 16": "",
}


@pytest.mark.parametrize(("advice", "words"), ADVICE.items(), ids=ADVICE)
def test_advice_on_fractions_of_a_micrometre_can_be_followed(tmp_path: Path, advice: str, words: str) -> None:
    text = device_text("my_encoder", "example", "d.json", "linear")
    assert words in " ".join(text.replace("\n#", " ").split())
    reported = problems(tmp_path, text.replace("step_um: resolution_um", advice))
    assert [message for rule, message in reported if rule in ("measurement-shape", "unknown-key")] == []


def without_examples(text: str) -> str:
    """Return the spec without its examples, which would show a wrong width."""
    start, _, after_examples = text.partition("examples:\n")
    return start + after_examples[after_examples.index("# Errors and contradictions") :]


@pytest.mark.parametrize(
    ("like", "old", "new", "words"),
    [
        ("", POSITION, POSITION.replace("singleturn_bits", "17"), "write 'bits: singleturn_bits'"),
        ("spi", "counts_per_turn: 2^14", "counts_per_turn: 2^12", "need 12; write 'bits: 12'"),
    ],
)
def test_a_position_that_is_wider_than_its_counts_is_reported(
    tmp_path: Path, like: str, old: str, new: str, words: str
) -> None:
    text = without_examples(device_text("my_encoder", "example", "d.json", like))
    assert old in text
    ((rule, message),) = problems(tmp_path, text.replace(old, new, 1))
    assert rule == "measurement-does-not-fit"
    assert words in message


@pytest.mark.parametrize("bits", ["17", "singleturn_bits"])
def test_a_position_after_a_flag_is_reported(tmp_path: Path, bits: str) -> None:
    text = without_examples(device_text("my_encoder", "example", "d.json"))
    position = POSITION.replace("singleturn_bits", bits).replace("revolution}", "revolution, note: always 17 bits}")
    reported = problems(tmp_path, text.replace(POSITION + ERROR, ERROR + position, 1))
    assert [rule for rule, _ in reported] == ["biss-protocol"]
    assert "'position' is after 'error'" in reported[0][1]


@pytest.mark.parametrize(
    ("like", "old", "new"),
    [
        ("", BISS_CLOCK, "note: The encoder is that slow.\n    " + BISS_CLOCK.replace("200000", "200")),
        (
            "ssi",
            "          # An error bit",
            "          - {name: error, bits: 1, note: It is not a flag}\n          # An error bit",
        ),
        ("", f"    steps:\n{STEPS}{SAVE}", f"    note: Saved first.\n    steps:\n{SAVE}{STEPS}"),
        ("spi", REQUEST, "          - {name: read, bits: 1, constant: 0, meaning: x}\n" + REQUEST.partition("\n")[2]),
        (
            "",
            'revision: "1.0"                ',
            'revision: "1.1"                ',
        ),
    ],
    ids=["clock", "error", "procedure", "request", "history"],
)
def test_a_true_spec_says_so(tmp_path: Path, like: str, old: str, new: str) -> None:
    text = without_examples(device_text("my_encoder", "example", "d.json", like))
    assert old in text
    text = text.replace(old, new, 1)
    if like == "spi":
        text = text.replace(
            "      - name: position_request\n",
            "      - name: position_request\n        note: There is no register 3FFFh.\n",
        )
    if "1.1" in text:
        text += (
            'errata:\n  - {name: history, title: A revision is missing, source: "1", printed: "1.0", used: "1.1",'
            " why: The cover has it, status: settled, severity: wording, affects: [manual.history]}\n"
        )
    assert problems(tmp_path, text) == []
