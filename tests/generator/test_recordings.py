"""Raw buffers of BiSS and words of SSI with another number of clocks. The right answers come from public cases."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.why.diagnosis import Diagnosis, Explanation
from codewheel.why.together import judge_together
from planted import crc

Decode = Callable[..., dict[str, Any]]

MANUFACTURER = """\
codewheel: 1
manufacturer: example
title: Name of the manufacturer
source: Cover
"""
#: A family with one order code, X-A, and one interface.
FAMILY = """\
codewheel: 1
device: x
manufacturer: example
title: X encoder
movement: rotary
evidence: {{grade: manual, documents: {{manual: all pages}}}}
manual: {{title: Guide, revision: "1.0", language: en, history: [{{revision: "1.0", changes: First issue.}}]}}
parameters: {{}}
order_code:
  pattern: "X-{{output}}"
  source: "1"
  parts: [{{name: output, meaning: Interface, values: {{"A": {{meaning: the interface, interface: {interface}}}}}}}]
measurement: {{of: position, counts_per_turn: {counts}, turns: {turns}, source: "1"}}
interfaces:
  {interface}:
    source: "1"
{setup}
    layouts:
      - name: position_frame
        from: encoder
        source: "1"
{fields}
"""
SSI = """\
    clock: {min_hz: 100000, max_hz: 1000000, source: "1"}
    alignment: msb_left
    output_code: binary"""
#: The absolute encoder AS5045 of ams: the data of 18 bits follow a first clock without data.
AS5045 = """\
        fields:
          - {name: position, bits: 12, unit: counts}
          - {name: ocf, active: low, makes_position: not_usable, when_active: offset compensation not finished}
          - {name: cof, active: high, makes_position: not_usable, when_active: CORDIC overflow}
          - {name: lin, active: high, makes_position: usable_with_warning, when_active: linearity alarm}
          - {name: mag_inc, bits: 1}
          - {name: mag_dec, bits: 1}
          - {name: parity, parity_of: [position, ocf, cof, lin, mag_inc, mag_dec]}"""
PLAIN = """\
        fields:
          - {name: position, bits: 21, unit: counts}"""
BISS = """\
    clock: {max_hz: 10000000, source: "1"}"""
#: RESOLUTE-32 of Renishaw: 32 bits of position, error and warning, which are active low, and a CRC.
RESOLUTE = """\
        fields:
          - {name: position, bits: 32, unit: counts}
          - {name: error, active: low, makes_position: not_usable, when_active: error}
          - {name: warning, active: low, makes_position: usable_with_warning, when_active: warning}
          - {name: crc, crc: biss_6}"""


def write_family(folder: Path, interface: str, setup: str, fields: str, counts: str, turns: str = "1") -> Path:
    """Write a family with the order code X-A."""
    text = FAMILY.format(interface=interface, setup=setup, fields=fields, counts=counts, turns=turns)
    (folder / "x.yaml").write_text(text, encoding="utf-8")
    (folder / "manufacturer.yaml").write_text(MANUFACTURER, encoding="utf-8")
    return folder


@pytest.fixture
def decode(capsys: pytest.CaptureFixture[str]) -> Decode:
    """``codewheel decode --json`` with the specs of a folder."""

    def run(folder: Path, *frame: str, code: str = "X-A") -> dict[str, Any]:
        main(["decode", code, *frame, "--json", "--specs", str(folder)])
        captured = capsys.readouterr()
        assert captured.out, captured.err
        data: dict[str, Any] = json.loads(captured.out)
        return data

    return run


@pytest.fixture
def resolute(tmp_path: Path) -> Path:
    fields = RESOLUTE.replace("biss_6", "crc_6")
    family = write_family(tmp_path, "biss", BISS, fields, "2^32")
    text = (family / "x.yaml").read_text(encoding="utf-8")
    biss_6 = "name: crc_6, width: 6, poly: 0x03, init: 0, refin: false, refout: false, xorout: 0x3F"
    with_crc = f'crcs:\n  - {{{biss_6}, source: "1"}}\ninterfaces:'
    (family / "x.yaml").write_text(text.replace("interfaces:", with_crc), encoding="utf-8")
    return family


def first(data: dict[str, Any]) -> dict[str, Any]:
    explanation: dict[str, Any] = data["why"]["explanations"][0]
    return explanation


def parts(explanation: dict[str, Any]) -> list[str]:
    return [f"{part['name']} {part['bits']}" for part in explanation["parts"]]


#: Position 123456789 without error and warning. A test computes its CRC by division.
FRAME = "0000011101011011110011010001010111110000"


def test_the_frame_is_right() -> None:
    assert FRAME[:32] == f"{123456789:032b}"
    assert crc(FRAME[:34]) == FRAME[34:]


@pytest.mark.parametrize(
    ("text", "around"),
    [
        (f"0b010{FRAME}", ["acknowledge 0", "start 1", "CDS 0"]),
        (
            f"0b110010{FRAME}0001",
            ["idle 11", "acknowledge 00", "start 1", "CDS 0", "stop 0", "time_out 00", "behind 1"],
        ),
        ("0xd03ade68af80", ["idle 11", "acknowledge 0", "start 1", "CDS 0", "stop 0", "time_out 00"]),
        ("d0 3a de 68 af 80", ["idle 11", "acknowledge 0", "start 1", "CDS 0", "stop 0", "time_out 00"]),
        (f"0b10{FRAME}0", ["start 1", "CDS 0", "stop 0"]),
    ],
)
def test_a_raw_buffer_shows_its_parts(text: str, around: Sequence[str], resolute: Path, decode: Decode) -> None:
    data = decode(resolute, *text.split())
    assert first(data)["reads"] == {"position": 123456789}
    assert [part for part in parts(first(data)) if not part.startswith("frame")] == list(around)
    assert f"frame {FRAME}" in parts(first(data))


def test_leading_zeros_of_a_buffer_count(resolute: Path, decode: Decode) -> None:
    """Twelve zeros are the acknowledge of an encoder with a long line delay."""
    buffer = f"{'0' * 12}11{FRAME}{'0' * 10}"
    data = decode(resolute, f"0x{int(buffer, 2):016x}")
    assert first(data)["kind"] == "raw_buffer"
    assert parts(first(data))[0] == f"acknowledge {'0' * 12}"
    assert first(data)["reads"] == {"position": 123456789}


@pytest.mark.parametrize(
    ("buffer", "words"),
    [
        ("1" * 30 + "0" * 18, "no start bit"),
        ("1" * 10 + "0" * 37 + "1", "CDS and the frame are missing"),
        ("1110" + "11" + "0" * 12 + "1" * 27, "39 of the 40 bits"),
    ],
)
def test_a_buffer_without_a_frame_says_what_is_missing(buffer: str, words: str, resolute: Path, decode: Decode) -> None:
    assert words in decode(resolute, f"0b{buffer}")["why"]["missing"]


def test_a_frame_that_only_its_crc_finds_has_the_chance_of_all_places(resolute: Path, decode: Decode) -> None:
    """After the start bit of the rule, the frame does not fit. It begins at bit 9 of 60: 21 places, so 64 / 21 = 3."""
    text = f"0b101110111{FRAME}{'1' * 11}"
    explanations = decode(resolute, text)["why"]["explanations"]
    inside = [explanation for explanation in explanations if explanation["reads"] == {"position": 123456789}]
    assert [(explanation["kind"], explanation["one_in"]) for explanation in inside] == [("frame_inside", 3)]


def test_the_first_clock_carries_no_data(tmp_path: Path, decode: Decode) -> None:
    """AS5045, 19 clocks: a public driver reads them all. The position is 1000, and OCF is set as always."""
    folder = write_family(tmp_path, "ssi", SSI, AS5045, "2^12")
    data = decode(folder, "0b1001111101000100001")
    assert first(data)["kind"] == "bits_in_front"
    assert first(data)["reads"]["position"] == 1000


@pytest.mark.parametrize(
    ("word", "kind"),
    [
        ("{word}000", "zeros_behind"),
        ("{word}{zeros}", "zeros_behind"),
        ("{word}{word}", "word_twice"),
        ("{word}0{word}", "word_twice"),
        ("{word}0{start}", "word_twice"),
        ("1{word}000000", "bits_in_front"),
    ],
)
def test_a_word_with_more_clocks(word: str, kind: str, tmp_path: Path, decode: Decode) -> None:
    """21 bits, read with 24, 32, 42, 43, 28 and 28 clocks. The position is 0x12345A."""
    folder = write_family(tmp_path, "ssi", SSI, PLAIN, "2^21")
    position = 0x12345A
    bits = f"{position:021b}"
    data = decode(folder, "0b" + word.format(word=bits, zeros="0" * 11, start=bits[:6]))
    readings = data["why"]["explanations"][:3]
    assert (kind, position) in [(reading["kind"], reading["reads"]["position"]) for reading in readings]
    assert data["verdict"] is None


def test_the_alignment_decides_where_zeros_are(tmp_path: Path, decode: Decode) -> None:
    folder = write_family(tmp_path, "ssi", SSI.replace("msb_left", "lsb_right"), PLAIN, "2^21")
    data = decode(folder, f"0b000{0x12345A:021b}")
    assert (first(data)["kind"], first(data)["reads"]) == ("zeros_in_front", {"position": 0x12345A})


def test_a_word_aligned_to_its_last_bit_may_also_come_first(tmp_path: Path, decode: Decode) -> None:
    """An encoder does not know how many clocks follow."""
    folder = write_family(tmp_path, "ssi", SSI.replace("msb_left", "lsb_right"), PLAIN, "2^21")
    data = decode(folder, f"0b{0x12345A:021b}000")
    assert (first(data)["kind"], first(data)["reads"]) == ("zeros_behind", {"position": 0x12345A})
    kinds = [reading["kind"] for reading in decode(folder, f"0b{0x12345A:021b}101")["why"]["explanations"]]
    assert "bits_behind" in kinds


def test_zeros_that_the_word_has_are_no_evidence(tmp_path: Path, decode: Decode) -> None:
    """Each word of 25 bits begins with 4 zeros, so 3 more zeros in front do not show that it comes last."""
    ssi = SSI.replace("msb_left", "lsb_right")
    padded = PLAIN.replace("fields:", "fields:\n          - {name: zeros, bits: 4, constant: 0}")
    folder = write_family(tmp_path, "ssi", ssi, padded, "2^21")
    reading, *others = decode(folder, f"0b{0x123:025b}000")["why"]["explanations"]
    assert (reading["kind"], reading["reads"], reading["one_in"]) == ("zeros_behind", {"position": 0x123}, 8 << 4)
    assert {other["one_in"] for other in others if other["kind"] == "zeros_in_front"} == {1 << 4}


def test_nothing_is_certain_without_a_crc(tmp_path: Path, capsys: pytest.CaptureFixture[str], decode: Decode) -> None:
    folder = write_family(tmp_path, "ssi", SSI, PLAIN, "2^21")
    main(["decode", "X-A", f"0b{0x12345A:021b}000", "--specs", str(folder)])
    assert "Each of them is uncertain" in " ".join(capsys.readouterr().out.split())


def test_a_short_word_says_so(tmp_path: Path, decode: Decode) -> None:
    folder = write_family(tmp_path, "ssi", SSI, PLAIN, "2^21")
    assert "18 of the 21 bits" in decode(folder, "0b" + "01" * 9)["why"]["missing"]


def tamagawa_specs() -> Path:
    """Return the folder of the family, which may move."""
    root = Path(__file__).parents[2]
    return next(root.glob("*/**/tamagawa/ts5700.yaml")).parent


#: The published reply of a TS5700N8401 to its request 02h: position 0x3412 = 13330, and the XOR of the bytes.
REPLY = "02 00 12 34 00 24"


@pytest.mark.parametrize(
    ("text", "kind", "names"),
    [
        ("1A", "echo", ["request data_request"]),
        (f"02 {REPLY}", "bytes_in_front", ["request data_request", "reply singleturn_reply"]),
        (f"{REPLY} {REPLY}", "several_frames", ["reply singleturn_reply", "reply singleturn_reply"]),
    ],
)
def test_the_frames_among_the_bytes(text: str, kind: str, names: list[str], decode: Decode) -> None:
    best = first(decode(tamagawa_specs(), *text.split(), code="TS5700N8401"))
    assert (best["kind"], [part["name"] for part in best["parts"]]) == (kind, names)
    if kind != "echo":
        assert best["reads"]["singleturn"] == 0x3412


def test_the_first_byte_is_missing(decode: Decode) -> None:
    data = decode(tamagawa_specs(), *REPLY.split()[1:], code="TS5700N8401")
    assert "first_byte_lost" in [explanation["kind"] for explanation in data["why"]["explanations"]]


def test_missing_first_bytes_of_several_requests_are_one_mistake(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same reply to the requests 02h and BAh, whose first byte repeats them. The last byte is the XOR."""
    monkeypatch.setattr("sys.stdin", io.StringIO("00 12 34 00 24\n00 12 34 00 9C\n"))
    assert main(["decode", "TS5700N8401", "-", "--specs", str(tamagawa_specs())]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "- the first byte is missing;" in printed


SPI = """\
    mode: 1
    word_bits: 16
    reply: same_word
    clock: {max_hz: 8000000, source: "1"}"""
#: The angle sensor SC60228 of Semiment.
SC60228 = """\
        fields:
          - {name: position, bits: 12, unit: counts}
          - {name: error, active: high, makes_position: not_usable, when_active: an error}
          - {name: df1, bits: 1}
          - {name: df2, bits: 1}
          - {name: parity, parity_of: [position, error, df1, df2]}"""


def test_a_valid_frame_lists_other_readings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A bit in front halves the angle, and the parity happens to fit: 0x3E80 instead of 0x7D00, which is 2000."""
    folder = write_family(tmp_path, "spi", SPI, SC60228, "2^12")
    assert main(["decode", "X-A", "0x3e80", "--specs", str(folder)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "the position is usable" in printed
    assert "Does the position look wrong?" in printed
    assert "2000 if it was read one clock early, 500 if it was read one clock late" in printed
    assert "matches by chance" not in printed


def test_a_wrong_parity_over_spi_may_be_a_shift(tmp_path: Path, decode: Decode) -> None:
    """0x7D01 has a wrong parity. Read one clock early, it is 0xFA02 with the position 0xFA0 = 4000."""
    folder = write_family(tmp_path, "spi", SPI, SC60228, "2^12")
    readings = decode(folder, "0x7d01")["why"]["explanations"]
    assert {"kind": "bits_in_front", "position": 4000} in [
        {"kind": reading["kind"], "position": reading["reads"]["position"]} for reading in readings
    ]


def test_a_number_in_gray_code_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    """1100 0000 0000 in Gray code is 1000 0000 0000."""
    assert main(["decode", "AM3616/4096-GG", "0b1100000000000000000000000001"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "Sent in Gray code as 0xc00, decoded 0x800" in printed


def test_several_frames_decide_what_one_cannot(
    resolute: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three frames whose CRC is not inverted: in each, a single explanation can be a coincidence."""
    frames = [f"{position:032b}11" for position in (123456789, 987654321, 55555)]
    lines = [f"0b{frame}{crc(frame, invert=False)}\n" for frame in frames]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(lines)))
    assert main(["decode", "X-A", "-", "--specs", str(resolute)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "3 of 3 frames with an error have this explanation" in printed
    assert "- the CRC is not inverted; matches by chance in 1 of 262,144" in printed
    assert "Another frame would help" in printed


def test_a_coincidence_in_one_frame_does_not_count() -> None:
    """Two mistakes explain both frames, with 2 x 8 and 2 x 6 bits of evidence.

    One mistake explains only the first frame.
    """
    evidence = {"likely": 8, "unlikely": 6, "coincidence": 40}
    explanations = [Explanation("start_value", text, 64, 2.0**bits, 1.0, {}) for text, bits in evidence.items()]
    likely, unlikely, coincidence = explanations
    whys = [Diagnosis((coincidence, likely, unlikely), 3, 0.1, ()), Diagnosis((unlikely, likely), 2, 0.1, ())]
    mistakes = judge_together(whys)
    assert [(mistake.text, mistake.frames, mistake.one_in) for mistake in mistakes] == [
        ("likely", 2, 64 * 64),
        ("unlikely", 2, 64 * 64),
    ]


def test_a_rare_mistake_is_rare_only_once() -> None:
    """Inverted bits over SPI are a rare mistake. In three frames with 6 bits of evidence each, it was made once."""
    rare = Explanation("all_inverted", "rare", 64, 0.25 * 2.0**6, 0.25, {})
    usual = Explanation("bytes_reversed", "usual", 16, 2.0 * 2.0**4, 2.0, {})
    one_frame = Diagnosis((usual, rare), 2, 0.1, ())
    assert [mistake.text for mistake in judge_together([one_frame] * 3)] == ["rare", "usual"]


def test_another_frame_helps_only_in_doubt(resolute: Path, decode: Decode) -> None:
    assert decode(resolute, f"0b010{FRAME}")["why"]["another_frame_helps"] is True
    assert decode(resolute, f"0b{'0' * 40}")["why"]["another_frame_helps"] is False


def test_each_argument_of_bits_is_a_frame(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_family(tmp_path, "ssi", SSI, PLAIN, "2^21")
    frames = [f"0b{position:021b}" for position in (0x12345, 0x12346)]
    assert main(["decode", "X-A", *frames, "--specs", str(folder)]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("line 1: X-A")
    assert "74566" in printed.partition("line 2: X-A")[2]
