"""The first bytes of a frame, of which the last ones are missing: they have all their zeros."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from browser_harness import Asker, cases, library_of
from codewheel.commands.cli import main
from codewheel.targets import Library

Capture = pytest.CaptureFixture[str]

TOO_SHORT = "it is too short: it has 16 of the 24 bits. Clocks still needed: 8"


def printed(capsys: Capture, *arguments: str) -> str:
    main(["decode", *arguments])
    return " ".join(capsys.readouterr().out.split()).lower()


@pytest.mark.parametrize("frame", ["50 FC", "A8 7E", "01 90", "28 7E"])
def test_two_of_three_bytes_are_the_first_bits(frame: str, capsys: Capture) -> None:
    """community.simplefoc.com/t/4441: a program reads 16 of the 24 bits of an MT6701."""
    text = printed(capsys, "MT6701", frame)
    assert TOO_SHORT.lower() in text
    assert "counts" not in text
    assert "no change is needed" not in text
    assert "leading zeros" not in text


def test_a_biss_frame_is_a_raw_buffer_that_ends_early(capsys: Capture) -> None:
    assert "it ends after 10 of the 34 bits of the frame" in printed(capsys, "RESOLUTE-26", "08 D1")


def test_without_a_crc_bytes_are_never_padded_silently(capsys: Capture) -> None:
    text = printed(capsys, "ssi:position=24", "50 FC")
    assert f"{TOO_SHORT}. If it lacks its leading zeros instead, write 0x0050FC.".lower() in text


@pytest.mark.parametrize("frame", ["0F 42 43 D3", "0xF4243D3"])
def test_a_correct_crc_shows_that_leading_zeros_are_missing(frame: str, capsys: Capture) -> None:
    assert "1000003 counts" in printed(capsys, "AMM5A21/65KSC1", frame)


@pytest.mark.starts_process
def test_the_page_reads_the_same_bits(ask: Callable[[Library, str], Asker]) -> None:
    library = library_of("../specs/magntek/mt6701")
    case = next(case for (case, *_) in cases(library.devices[0]) if case.placed.bits == 24)
    ((bytes_, number),) = ask(library, "node")("reasons", [{**case.data, "frames": ["50 FC", "0x50FC"]}])
    assert bytes_[:2] == [[], TOO_SHORT]
    assert "treated as leading zeros" in number[1]


#: Public cases: AS5048A with MISO connected to MOSI (eborghi10/AS5048A issue 3), printed by Arduino's print(..., BIN).
WITHOUT_ZEROS = {
    "AS5048A": ("111111111111101", "0b0111111111111101"),
    "ssi,gray:position=13": ("11111010001", "0b0011111010001"),
}


@pytest.mark.parametrize("code", WITHOUT_ZEROS)
def test_bits_printed_without_leading_zeros_are_offered_with_them(code: str, capsys: Capture) -> None:
    printed_bits, frame = WITHOUT_ZEROS[code]
    assert f"if it lacks its leading zeros instead, write {frame}." in printed(capsys, code, printed_bits)


@pytest.mark.parametrize(("code", "frame"), [("AS5048A", "111111111111111"), ("AS5048A", "011111111111111")])
def test_bits_are_not_padded_to_a_wrong_frame_or_after_a_zero(code: str, frame: str, capsys: Capture) -> None:
    """15 ones after a zero have odd parity. A text with a leading zero was printed with its zeros."""
    assert "leading zeros" not in printed(capsys, code, frame)


@pytest.mark.starts_process
def test_the_page_offers_the_same_zeros(ask: Callable[[Library, str], Asker]) -> None:
    library = library_of("../specs/ams/as5048a")
    case = next(case for (case, *_) in cases(library.devices[0]) if case.placed.name == "position")
    frames = ["111111111111101", "011111111111111"]
    ((without_zeros, with_zeros),) = ask(library, "node")("reasons", [{**case.data, "frames": frames}])
    assert "write 0b0111111111111101" in without_zeros[1]
    assert "leading zeros" not in with_zeros[1]
