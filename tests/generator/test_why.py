"""Every usual mistake, planted in frames written by hand, is listed as an explanation, and mostly first."""

from __future__ import annotations

import io
import json
import random
import time
from collections.abc import Callable, Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from codewheel.commands.cli import main
from codewheel.commands.decode.explanations import why_text
from codewheel.commands.decode.frames import decode_text
from codewheel.commands.decode.text import explain
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.order_codes.labels import find_code
from codewheel.why.diagnosis import Diagnosis
from codewheel.why.explain import explain_bits
from codewheel.why.hypotheses import MISTAKES as KINDS
from codewheel.why.hypotheses import TypedFrame
from exhaustive import mostly_exhaustive
from planted import (
    BYTE_CODES,
    ENCODERS,
    MISTAKES,
    Encoder,
    Maker,
    Plant,
    as_hex,
    byte_mistakes,
    crc,
    random_bits,
    valid_frame,
)

SPECS = Path(__file__).parents[1] / "specs"
#: Order codes with a parity bit, without and with a toggle bit, and the bits of their words.
PARITY_WORDS = {"C58-25B-E": 26, "C58-25B-TE": 27}
Run = Callable[..., tuple[int, dict[str, Any]]]


@pytest.fixture
def decode(capsys: pytest.CaptureFixture[str]) -> Run:
    """``codewheel decode --json`` on one frame: exit code and data."""

    def run(code: str, *frame: str) -> tuple[int, dict[str, Any]]:
        exit_code = main(["decode", code, *frame, "--json"])
        return exit_code, json.loads(capsys.readouterr().out)

    return run


def why_of_text(device: Device, code: str, text: str) -> Diagnosis | None:
    variant = find_code(device, code).variant
    return why_text(device, variant, "encoder", text, decode_text(device, variant, "encoder", text))


def explanation_lines(device: Device, plant: Plant) -> list[str] | None:
    """Return ``kind: text`` of every explanation of a planted frame, or None if the frame is valid by chance."""
    explained = why_of_text(device, plant.code, plant.text)
    if explained is None:
        return None
    explanations = explained.explanations
    return [
        f"{explanation.kind}: {explanation.text} {' '.join(explanation.order_codes)}" for explanation in explanations
    ]


def is_planted(plant: Plant) -> Callable[[str], bool]:
    return lambda line: line.startswith(plant.kind + ":") and plant.words in line


def family(devices: Mapping[str, Device], code: str) -> Device:
    """By the first letters of the code, as the manuals print them."""
    families = {"AMM5": "amm5", "ASC85": "asc85", "SMA21": "sma21", "AM": "am36"}
    return devices[next(name for start, name in families.items() if code.startswith(start))]


def test_the_division_is_right() -> None:
    # Published: biss_4 of the register read at 44h (TI, 0x889B4000), the all-zero position of 22 bits,
    # CRC-16/XMODEM over "123456789".
    assert crc("10001000100", 0x13) == f"{0x889B4000 >> 17 & 15:04b}"
    assert crc("0" * 22 + "11") == "111010"
    assert int(crc("".join(f"{byte:08b}" for byte in b"123456789"), 0x11021, invert=False), 2) == 0x31C3
    assert int(crc("".join(f"{byte:08b}" for byte in b"123456789"), 0x11021, "1" * 16, invert=False), 2) == 0x29B1


def test_sound_frames_need_no_explanation(devices: Mapping[str, Device]) -> None:
    source = random.Random(1)
    for encoder in ENCODERS:
        assert why_of_text(family(devices, encoder.code), encoder.code, "0b" + valid_frame(encoder, source)) is None


#: Least fraction of the planted frames whose mistake is listed first.
#: docs/encoder/why-a-crc-fails.md has the numbers of a longer run, and the reasons.
FIRST = {
    "read_late": 0.6,
    "first_bit_missing": 0.6,
    "read_early": 0.6,
    "crc_reversed": 0.5,
    "polynomial_reversed": 0.5,
    "other_polynomial_in_6_bits": 0.7,
    "other_answer": 0.4,
}


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("maker", MISTAKES, ids=lambda maker: maker.__name__)
def test_what_was_planted_is_listed_and_mostly_first(maker: Maker, devices: Mapping[str, Device]) -> None:
    source = random.Random(maker.__name__)
    explained = listed_first = 0
    for _ in range(4):
        for encoder in ENCODERS:
            for plant in maker(encoder, source):
                lines = explanation_lines(family(devices, encoder.code), plant)
                if lines is None:
                    continue  # 1 frame in 64 is valid by chance
                assert any(map(is_planted(plant), lines)), (plant, lines)
                explained += 1
                listed_first += is_planted(plant)(lines[0])
    assert explained >= 40
    assert listed_first >= FIRST.get(maker.__name__, 0.75) * explained


@pytest.mark.slow
def test_a_number_without_its_leading_zeros_is_no_obstacle(devices: Mapping[str, Device]) -> None:
    source = random.Random(3)
    for encoder in ENCODERS:
        for maker in MISTAKES[:9]:
            for plant in map(as_hex, maker(encoder, source)):
                lines = explanation_lines(family(devices, encoder.code), plant)
                if (
                    maker.__name__ in ("not_inverted", "status_left_out", "status_turned", "read_late", "read_early")
                    and lines is not None
                ):
                    assert any(map(is_planted(plant), lines)), (plant, lines)


@pytest.mark.slow
@pytest.mark.parametrize("code", BYTE_CODES)
def test_mistakes_with_bytes(code: str, devices: Mapping[str, Device]) -> None:
    source = random.Random(4)
    explained = listed_first = 0
    for _ in range(20):
        for plant in byte_mistakes(code, source):
            lines = explanation_lines(family(devices, code), plant)
            if lines is not None:
                assert any(map(is_planted(plant), lines)), (plant, lines)
                explained, listed_first = explained + 1, listed_first + is_planted(plant)(lines[0])
    assert explained > 150
    assert listed_first > 0.95 * explained


CODES_OF_EACH_FAMILY = ("AMM5A21/65KSC1", "SMA21-SC4-0050", "AM3616/4096-I7", "ASC8525/SC2", "ASC8525/SC1")


@pytest.mark.slow
@pytest.mark.parametrize(
    "encoder",
    [encoder for encoder in ENCODERS if encoder.code in CODES_OF_EACH_FAMILY],
    ids=lambda encoder: encoder.code,
)
def test_the_command_line_lists_them(
    encoder: Encoder, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Run the command on every mistake once for each family, one frame per line, and validate its JSON."""
    source = random.Random(encoder.code)
    planted_mistakes = [planted for maker in MISTAKES for planted in maker(encoder, source)]
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{planted.text}\n" for planted in planted_mistakes)))
    chosen = ["--choose", "zero_bit=as_printed"] if encoder.below else []
    assert main(["decode", encoder.code, "-", "--json", *chosen]) == 1
    schema = jsonschema.Draft202012Validator(
        json.loads((resources.files("codewheel.language") / "decode.schema.json").read_text(encoding="utf-8"))
    )
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(planted_mistakes) > 20
    for planted, decoded in zip(planted_mistakes, map(json.loads, lines), strict=True):
        schema.validate(decoded)
        if decoded["why"] is None:
            assert decoded["problems"] == []
            continue
        explanations = decoded["why"]["explanations"]
        explanations_of_kind = [explanation for explanation in explanations if explanation["kind"] == planted.kind]
        texts = [explanation["text"] + " ".join(explanation["order_codes"]) for explanation in explanations_of_kind]
        assert any(planted.words in text for text in texts), (planted, explanations)


@pytest.mark.slow
def test_the_words_fit_a_terminal(devices: Mapping[str, Device]) -> None:
    source = random.Random(7)
    for encoder in ENCODERS:
        device = family(devices, encoder.code)
        match = find_code(device, encoder.code)
        for maker in MISTAKES:
            for plant in maker(encoder, source):
                decoded = decode_text(device, match.variant, "encoder", plant.text)
                explained = why_text(device, match.variant, "encoder", plant.text, decoded)
                text = explain(device, match, "encoder", decoded, diagnosis=explained)
                assert [line for line in text.splitlines() if len(line) > 80] == []
                assert (
                    explained is None
                    or "matches by chance in 1 of" in text
                    or "fewer than 1 of" in text
                    or "No common mistake" in text
                )


def test_a_frame_worked_out_on_paper(decode: Run) -> None:
    """AMM5A17/1SC1, position 1, none active: 17 bits, then 11, remainder of 111b * x^6 = x^8 + x^7 + x^6.

    x^6 = x + 1, so x^7 = x^2 + x and x^8 = x^3 + x^2: the sum is x^3 + 1, 001001b. Sent inverted: 110110b;
    not inverted is the mistake.
    """
    frame = "0" * 16 + "1" + "11"
    assert decode("AMM5A17/1SC1", f"0b{frame}110110")[1]["why"] is None
    exit_code, data = decode("AMM5A17/1SC1", f"0b{frame}001001")
    best = data["why"]["explanations"][0]
    assert exit_code == 1
    assert (best["kind"], best["one_in"], best["twice"], best["reads"]) == (
        "crc_not_inverted",
        64,
        False,
        {},
    )


def test_what_the_frame_would_read(decode: Run) -> None:
    """The frame above, started one clock late. Its first bit was a 0, so the position is 1."""
    frame = "0" * 16 + "1" + "11" + "110110"
    _, data = decode("AMM5A17/1SC1", f"0b{frame[1:]}0")
    explanations = data["why"]["explanations"]
    missing_bits = [explanation for explanation in explanations if explanation["kind"] == "first_bit_missing"]
    assert missing_bits[0]["reads"] == {"singleturn": 1}
    _, data = decode("AMM5A23/1SC1", "0b" + frame)
    best = data["why"]["explanations"][0]
    assert best["order_codes"] == ["AMM5A17/1SC1", "AMM5B17/1SC1"]
    assert best["reads"] == {"singleturn": 1}


def test_what_follows_a_shorter_frame_is_0(decode: Run) -> None:
    """The frame above, which ends four bits before the end of an AMM5A21/1SC1 frame.

    Stop bit and SLI are 0, so other bits cannot follow a shorter frame.
    """
    frame = "0" * 16 + "1" + "11" + "110110"
    for behind, expected in (("0000", True), ("0100", False), ("0001", False)):
        explanations = decode("AMM5A21/1SC1", f"0b{frame}{behind}")[1]["why"]["explanations"]
        assert (
            "AMM5A17/1SC1" in [code for explanation in explanations for code in explanation["order_codes"]]
        ) is expected


def test_the_0_bit_of_asc85_may_be_missing(decode: Run) -> None:
    """33 bits as a public driver reads them, 25 + nE + nW + 6.
    Position 1: remainder of 111b * x^6 is 001001b, as above, sent inverted."""
    as_printed = ("--choose", "zero_bit=as_printed")
    exit_code, data = decode("ASC8525/SC1", "0b" + "0" * 24 + "1" + "11" + "110110", *as_printed)
    best = data["why"]["explanations"][0]
    assert exit_code == 1
    assert best["kind"] == "other_answer"
    assert best["reads"] == {"position": 1}
    assert best["text"] == "33 bits, as with --choose zero_bit=left_out"
    # The same with one more clock, since the manual has 34, and without leading zeros,
    # whose number 0x does not show.
    for frame in ("0b" + "0" * 24 + "1" + "11" + "110110" + "0", "0x1f6"):
        explanations = decode("ASC8525/SC1", frame, *as_printed)[1]["why"]["explanations"]
        readings = [(explanation["kind"], explanation["reads"]) for explanation in explanations]
        assert ("other_answer", {"position": 1}) in readings
    # And vice versa: the 0 bit is there, and must be 0.
    for zero, expected in (("0", True), ("1", False)):
        data = "0" * 24 + "1" + zero + "11"
        frame = "0b" + data + crc(data)
        explanations = decode("ASC8525/SC1", frame, "--choose", "zero_bit=left_out")[1]["why"]["explanations"]
        readings = [(explanation["kind"], explanation["reads"]) for explanation in explanations]
        assert (("other_answer", {"position": 1}) in readings) is expected
    # Without an open question there is nothing to try: AM36's constant bits replace error and warning.
    frame = "0b" + "0" * 24 + "1" + "11" + "110110"
    explanations = decode("AM3616/4096-I7", frame.ljust(45, "0"))[1]["why"]["explanations"]
    assert all(explanation["kind"] != "other_answer" for explanation in explanations)


def test_an_echo_of_the_request(decode: Run) -> None:
    # The published reply, TexasInstruments/motor-control-sdk, Tamagawa_UART_output.PNG, after its request.
    exit_code, data = decode("AMM5A23/65KJP1", "02 02 20 C7 D1 6A 5E")
    (best,) = data["why"]["explanations"]
    assert exit_code == 1
    assert best["kind"] == "bytes_in_front"
    assert best["reads"] == {"singleturn": 7000519}


def test_a_line_that_does_not_move_comes_first(decode: Run) -> None:
    for code, frame in (
        ("AMM5A17/1SC1", "0x0"),
        ("AMM5A17/1SC1", "0b" + "1" * 25),
        ("AMM5A23/65KJP1", "FF FF FF FF FF FF"),
    ):
        explanations = decode(code, frame)[1]["why"]["explanations"]
        # There is no other explanation.
        assert [explanation["kind"] for explanation in explanations] == ["line_stuck"]


@pytest.mark.slow
def test_a_dead_line_without_a_crc_is_named_too(decode: Run, capsys: pytest.CaptureFixture[str]) -> None:
    """Position 0 is valid, but SSI has no CRC to distinguish it from a dead line."""
    for frame, level in (("0x0", 0), ("0b" + "1" * 39, 1)):
        exit_code, data = decode("AMM5A23/65KBG1", frame)
        assert exit_code == 0
        assert [explanation["kind"] for explanation in data["why"]["explanations"]] == ["line_stuck"]
        assert main(["decode", "AMM5A23/65KBG1", frame]) == 0
        out = " ".join(capsys.readouterr().out.split())
        assert f"Every bit is {level}. A dead line looks the same, and there is no CRC to distinguish it." in out
    assert decode("AMM5A23/65KBG1", "0x1")[1]["why"] is None


@pytest.mark.slow
def test_a_disturbed_bit_comes_first(decode: Run, capsys: pytest.CaptureFixture[str]) -> None:
    """The frame 0xF4243D3 of AMM5's example position 1,000,003 with its last bit inverted, and a reply in bytes."""
    exit_code, data = decode("AMM5A21/65KSC1", "0xF4243D2")
    assert (exit_code, data["why"]["disturbed"]) == (1, [0])
    assert main(["decode", "AMM5A21/65KSC1", "0xF4243D2"]) == 1
    out = " ".join(capsys.readouterr().out.split())
    first = "one bit may have been corrupted on the line: the CRC matches with bit 0 inverted"
    assert 0 < out.index(first) < out.index("the polynomial is 0x25")
    # x^8 + 1 reveals the bit but not the byte. A parity bit, a constant and padding are excluded.
    reply = bytes.fromhex("02 00 15 CD 5B 81")
    data = decode("AMM5A23/65KJP1", (reply[:4] + bytes([reply[4] ^ 0x10]) + reply[5:]).hex())[1]
    assert data["why"]["disturbed"] == [4, 12, 20, 28, 36]
    assert decode("AMM5A23/65KJP1", "02 02 20 C7 D1 6A 5E")[1]["why"]["disturbed"] == []


def test_a_disturbed_bit_of_a_word_without_a_crc(decode: Run, capsys: pytest.CaptureFixture[str]) -> None:
    """A parity bit shows that one of its 26 bits is inverted, and a wrong constant shows which bit is."""
    exit_code, data = decode("C58-25B-E", f"0b{2:026b}")
    assert (exit_code, data["why"]["disturbed"]) == (1, [*range(26)])
    assert main(["decode", "C58-25B-E", f"0b{2:026b}"]) == 1
    out = " ".join(capsys.readouterr().out.split())
    assert "A shift by one clock passes this check in half of all frames" in out
    assert "on the line: the frame is valid with one of 26 bits inverted." in out
    assert "no change is needed" not in out
    # Position 1, and the middle one of three zeros before the check sum. With two of them, no single bit explains it.
    assert decode("C58-25B-C25", f"0b{1 << 18 | 1 << 16 | 5:043b}")[1]["why"]["disturbed"] == [16]
    assert decode("C58-25B-C25", f"0b{1 << 18 | 3 << 16 | 5:043b}")[1]["why"]["disturbed"] == []
    # A word of another length has another cause: other order codes send 27 bits.
    why_of_longer_word = decode("C58-25B-E", f"0b{2:027b}")[1]["why"]
    assert [explanation["kind"] for explanation in why_of_longer_word["explanations"]] == ["other_order_code"]
    assert why_of_longer_word["disturbed"] == []


def test_a_parity_error_names_only_the_bits_of_the_order_code(decode: Run) -> None:
    messages = {code: decode(code, f"0b{4:0{bits}b}")[1]["problems"] for code, bits in PARITY_WORDS.items()}
    assert [problem["message"].partition("parity of ")[2] for (problem,) in messages.values()] == [
        "multiturn, singleturn",
        "multiturn, singleturn, toggle",
    ]


@pytest.mark.slow
def test_published_frames_with_active_high_status(
    vectors: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    """The source prints these frames with error and warning inverted, so the CRC does not match."""
    rows = [row for row in vectors if row["protocol"] == "BiSS-C SCD"]
    assert len(rows) == 9
    for row in rows:
        bits = row["frame_hex_or_bits"]
        turned = bits[:22] + bits[22:24].translate(str.maketrans("01", "10")) + bits[24:]
        assert main(["decode", "T22SC", "0b" + turned, "--specs", str(SPECS), "--json"]) == 1
        explanations = json.loads(capsys.readouterr().out)["why"]["explanations"]
        assert "status_turned" in [explanation["kind"] for explanation in explanations]


def test_the_published_word_with_a_wrong_crc(
    vectors: list[dict[str, Any]], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """The word that TI misprints: CTS, ID and address, 1 000 1100000b, with CRC 9 instead of Bh.
    A frame of bits like any other.

    No mistake was planted, so whatever is listed is a coincidence: 11 bits and 4 of CRC, one try in 16 fits.
    """
    (row,) = [row for row in vectors if str(row.get("evidence_class")).startswith("negative")]
    text = (SPECS / "bits22.yaml").read_text(encoding="utf-8")
    text = (
        text.replace('"22"', '"11"')
        .replace("position_bits: 22", "position_bits: 11")
        .replace("0x3F", "0x0F")
        .replace("width: 6", "width: 4")
    )
    flags = [line for line in text.splitlines() if "active: low" in line]
    (tmp_path / "bits22.yaml").write_text(text.replace("\n".join(flags) + "\n", ""), encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(
        (SPECS / "manufacturer.yaml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    word = int(row["frame_hex_or_bits"].split()[0], 16)
    assert main(["decode", "T11SC", f"0b{word >> 17:015b}", "--specs", str(tmp_path), "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["crc"] == {"received": 9, "computed": 11, "ok": False}
    # On paper: including the start bit, a leading 1 adds x^15 = 1 to the remainder.
    # Bh xor 1 is Ah, not 9, so this is not an explanation.
    assert not [explanation for explanation in data["why"]["explanations"] if explanation["kind"] == "crc_not_inverted"]
    assert crc("1" + "10001100000", 0x13) == f"{11 ^ 1:04b}"
    assert all("the start bit, or" not in explanation["text"] for explanation in data["why"]["explanations"])
    assert data["why"]["coincidence"] > 0.5


@pytest.mark.slow
def test_a_crc_is_blind_for_what_is_said(devices: Mapping[str, Device], decode: Run) -> None:
    """With start value 0, leading zeros are not detected: AMM5A17/1SC1's frame as a number passes as AMM5A23/1SC1's.
    And an XOR does not detect swapped bytes."""
    narrow = Encoder("AMM5A17/1SC1", 0, 17)
    frame = valid_frame(narrow, random.Random(5))
    assert decode("AMM5A23/1SC1", hex(int(frame, 2)))[0] == 0
    assert any("zeros" in text for text in decode("AMM5A23/1SC1", "0x1")[1]["why"]["cannot_see"])
    swapped, sane = decode("AMM5A23/65KJP1", "02 20 6A D1 C7 5E"), decode("AMM5A23/65KJP1", "02 20 C7 D1 6A 5E")
    assert swapped[1]["crc"] == sane[1]["crc"]
    assert swapped[1]["crc"]["ok"] is True
    assert swapped[1]["fields"] != sane[1]["fields"]
    limits = decode("AMM5A23/65KJP1", "02 20 C7 D1 6A 5F")[1]["why"]["cannot_see"]
    assert any("swapped bytes" in text for text in limits)


def explain_noise(device: Device, code: str, frames: int) -> Iterator[Diagnosis]:
    source = random.Random(code)
    variant = find_code(device, code).variant
    placed = device.layout("single_cycle_data").place(variant.parameters)
    for _ in range(frames):
        explained = explain_bits(
            device, variant, placed, TypedFrame(int(random_bits(source, placed.bits), 2), placed.bits, True)
        )
        assert explained is not None
        yield explained


@pytest.mark.slow
@pytest.mark.parametrize(
    "code",
    mostly_exhaustive(["AMM5A21/65KSC1", "ASC8523/SC1", "SMA21-SC4-0001", "AM3616/4096-I7"], "AMM5A21/65KSC1"),
)
def test_the_stated_coincidence_is_what_noise_shows(code: str, devices: Mapping[str, Device]) -> None:
    """The stated number of random frames has an explanation, within the spread of 600 frames and of related tries."""
    outcomes_of_noise = list(explain_noise(family(devices, code), code, 600))
    single = [
        outcome
        for outcome in outcomes_of_noise
        if outcome.explanations and not outcome.explanations[0].needs_two_mistakes
    ]
    doubled = [outcome for outcome in outcomes_of_noise if outcome not in single]
    assert single
    assert doubled
    assert abs(len(single) / len(outcomes_of_noise) - single[0].chance_of_match) < 0.08
    assert (
        abs(
            sum(bool(outcome.explanations) for outcome in outcomes_of_noise) / len(outcomes_of_noise)
            - doubled[0].chance_of_match
        )
        < 0.12
    )
    assert all(explanation.needs_two_mistakes for outcome in doubled for explanation in outcome.explanations)
    assert all(outcome.tried_count > single[0].tried_count for outcome in doubled)


@pytest.mark.slow
def test_likeliest_first_and_every_kind_weighed(devices: Mapping[str, Device]) -> None:
    for explained in explain_noise(devices["amm5"], "AMM5A21/65KSC1", 60):
        scores = [explanation.score for explanation in explained.explanations]
        assert scores == sorted(scores, reverse=True)
        assert all(explanation.kind in KINDS and explanation.one_in >= 8 for explanation in explained.explanations)
    assert all(weight > 0 for weight in KINDS.values())


def test_a_word_that_is_too_short_says_so(decode: Run) -> None:
    exit_code, data = decode("AMM5A17/1BG1", "0b101")
    assert exit_code == 1
    assert data["why"]["explanations"] == []
    assert "3 of the 17 bits" in data["why"]["missing"]
    assert decode("AMM5A23/65KJP1", "--from", "master", "1A")[1]["why"] is None


@pytest.mark.slow
def test_frames_far_off_are_no_burden(decode: Run) -> None:
    before = time.process_time()
    for code, frame in (
        ("AM3616/4096-I7", "0b" + "10" * 2000),
        ("AM3616/4096-I7", "0x" + "f" * 4000),
        ("AMM5A17/1SC1", "0b1"),
        ("AMM5A23/65KJP1", "02 " * 1000),
        ("AMM5A23/65KJP1", "02"),
    ):
        assert decode(code, frame)[0] == 1
    assert time.process_time() - before < 15


def test_one_frame_takes_far_less_than_a_second(devices: Mapping[str, Device]) -> None:
    before = time.process_time()
    list(explain_noise(devices["am36"], "AM3616/4096-I7", 10))
    assert (time.process_time() - before) / 10 < 0.5


def test_the_page_shows_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    page = (Path(__file__).parents[2] / "docs/encoder/why-a-crc-fails.md").read_text(encoding="utf-8")
    command, *page_lines = page.split("```")[1].strip().splitlines()
    assert main(command.split()[2:]) == 1
    printed = capsys.readouterr().out.splitlines()
    places = [printed.index(line) for line in page_lines if line not in ("...", "")]
    assert len(places) > 5
    assert places == sorted(places)
    assert all(f"`{kind}`" in page for kind in KINDS)


@pytest.mark.parametrize("width", [1, 2, 3, 16])
def test_a_crc_of_any_width(width: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A CRC of one or two bits proves nothing, and mistakes that match more than one frame in eight are not listed."""
    text = (
        (SPECS / "bits22.yaml")
        .read_text(encoding="utf-8")
        .replace("width: 6", f"width: {width}")
        .replace("poly: 0x03", "poly: 1")
    )
    (tmp_path / "bits22.yaml").write_text(
        text.replace("xorout: 0x3F", f"xorout: {(1 << width) - 1:#x}"), encoding="utf-8"
    )
    (tmp_path / "manufacturer.yaml").write_text(
        (SPECS / "manufacturer.yaml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    source = random.Random(width)
    for extra in (-2, -1, 0, 0, 0, 1, 2):
        assert main(
            ["decode", "T22SC", f"0b{random_bits(source, 24 + width + extra)}", "--specs", str(tmp_path), "--json"]
        ) in (0, 1)
        explained = json.loads(capsys.readouterr().out)["why"]
        assert explained is None or all(explanation["one_in"] >= 8 for explanation in explained["explanations"])


@pytest.mark.slow
def test_made_up_layouts_break_nothing() -> None:
    """Every layout with a CRC in the made-up spec gets an explanation or none, but never an exception."""
    devices, report = load_library([SPECS])
    assert not report
    source = random.Random(9)
    explained_frames = 0
    for device in devices:
        for variant in device.variants:
            for layout in device.interface(variant.interface).layouts:
                if not layout.crc_fields:
                    continue
                for extra in (-1, 0, 1):
                    bits = layout.place(variant.parameters).bits
                    text = (
                        random_bits(source, bits + extra)
                        if layout.carried_as == "bits"
                        else "".join(f"{source.getrandbits(8):02x}" for _ in range(bits // 8 + extra))
                    )
                    text = "0b" + text if layout.carried_as == "bits" else text
                    decoded = decode_text(device, variant, layout.sender, text, layout.name)
                    why_text(device, variant, layout.sender, text, decoded)
                    explained_frames += 1
    assert explained_frames > 10


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "frame", "advice"),
    [
        (
            "AMT22-14",
            "0xFFFF",
            "Every bit is 1: the line never changes. Check for a broken wire, the supply",
        ),
        (
            "AMT22-14",
            "0x0000",
            "Every bit is 0: the line never changes. Check for a short circuit, the supply",
        ),
        ("AS5047P", "FF FF", "Every bit is 1. A dead line looks the same, and there is no CRC to distinguish it."),
        ("MT6835", "0x0", "Every bit is 0. A dead line looks the same, and the CRC is correct too."),
        ("MT6835", "FF FF FF FF FF FF", "Check for a broken wire, the supply and the clock."),
        ("SKM36", "FF FF FF FF FF FF FF", "Check for a broken wire, the supply and wires A and B."),
        # forum.arduino.cc/t/1376670: the checksum of an AMT21 is invalid, "Given is: 1111111111111111".
        ("AMT212C", "FF FF", "Every bit is 1: the line never changes. Check for a broken wire, the supply and wires A"),
    ],
)
def test_a_dead_line(code: str, frame: str, advice: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Name what to check on the line.

    Check bits of the AMT22 are wrong on a dead line. The parity of the AS5047P and a CRC of 00h are correct.
    """
    main(["decode", code, frame, "--specs", str(Path(__file__).parents[2] / "specs")])
    assert advice in " ".join(capsys.readouterr().out.split())
