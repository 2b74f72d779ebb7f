"""Several frames in pasted text: words in one line, and decimal numbers in columns."""

from __future__ import annotations

import io
import json
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.commands.decode.frames import frame_lines
from codewheel.commands.decode.several_frames import separate_frames

Capture = pytest.CaptureFixture[str]


def frames(text: str, *sizes: int) -> list[str]:
    """Return the texts of the frames in some lines."""
    return [line.text for line in separate_frames(frame_lines(io.StringIO(text)), sizes)]


def positions(capsys: Capture, code: str, text: str) -> list[Any]:
    main(["decode", code, text, "--json"])
    lines = capsys.readouterr().out.splitlines()
    fields = [field for line in lines for field in json.loads(line)["fields"]]
    return [field["value"] for field in fields if field["name"] == "position"]


def test_decimal_numbers_in_a_column(capsys: Capture) -> None:
    """24747 has 5 digits, too many for 16 bits in hex. So 8213 is decimal too."""
    assert positions(capsys, "AMT22-14", "8213\n24747") == [8213, 8363]
    assert frames("8213\n2474", 16) == ["8213", "2474"], "they can be decimal or hex"
    many = [f"{number}" for number in range(2001, 2009)]
    assert frames("\n".join(many), 16) == [f"0x{int(number):X}" for number in many]
    assert frames("\n".join([*many, "2A01"]), 16)[:8] == many, "a letter shows that they are hex"


def test_columns_of_csv() -> None:
    wanted = ["0x60AB", "0x2015", "0x60AC"]
    assert frames("line,raw\n1,24747\n2,8213\n3,24748\n", 16) == wanted
    assert frames("1;0x60AB\n2;0x2015\n3;0x60AC\n", 16) == wanted
    assert frames("time,raw\n0.001,24747\n0.002,8213\n0.004,24748\n", 16) == wanted
    # Bytes whose first one increases with each frame are not numbers of lines.
    assert frames("10, 2A\n11, 2A\n12, 2A\n", 16) == ["10, 2A", "11, 2A", "12, 2A"]


@pytest.mark.parametrize(
    ("text", "sizes", "count"),
    [
        ("0x60AB 2015 0x60AC", (16, 32), 3),
        ("60AB 2015", (16,), 2),
        ("0x60AB 0x2015", (16, 32), 1),  # also one frame of 32 bits
        ("0x0000F4243D2B 0x0000F4243D2C", (45,), 2),
        ("0xD03A 0xDE68 0xAF80", (36,), 1),  # a raw buffer in words of 16 bits
        ("0x60AB 0x15", (16,), 1),
    ],
)
def test_several_frames_in_one_line(text: str, sizes: tuple[int, ...], count: int) -> None:
    assert len(frames(text, *sizes)) == count


def test_a_live_recording_is_decoded_without_delay() -> None:
    """The second line is only read after the first frame."""

    def live_lines() -> Any:
        yield "0x60AB"
        raise AssertionError("read ahead")

    first, *_ = frame_lines(["0x60AB"])
    assert next(separate_frames(frame_lines(live_lines()), (16,))).text == first.text


BYTES = ("0b00000010", "0b00100000", "0b11000111", "0b11010001", "0b01101010", "0b01011110")


@pytest.mark.parametrize(
    ("code", "words", "values"),
    [
        ("AS5045", ("0b011000000000100001", "0b001111111111100001"), [0x600, 0x3FF]),
        ("AS5048A", ("0b1111111111111111", "0b0111111111111101"), [0x3FFF, 0x3FFD]),
        ("ssi:position=13", ("8191", "4096"), [8191, 4096]),
        # The second word lacks its last bit, so it is a frame with an error.
        ("ssi:position=10", ("0b0000000011", "0b000000010"), [3]),
    ],
)
def test_words_are_frames_with_quotes_and_without(
    code: str, words: tuple[str, ...], values: list[int], capsys: Capture
) -> None:
    for arguments in (words, (" ".join(words),)):
        main(["decode", code, *arguments, "--json"])
        frames_read = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert len(frames_read) == len(words)
        fields = [field for frame in frames_read for field in frame["fields"]]
        assert [field["value"] for field in fields if field["name"] == "position"] == values


@pytest.mark.parametrize(
    ("texts", "frames"),
    [
        # github.com/eborghi10/AS5048A/issues/3: print(x, BIN) omits leading zeros.
        (["1" * 16, "1" * 15, "1" + "0" * 14], ["0b" + "1" * 16, "0b0" + "1" * 15, "0b01" + "0" * 14]),
        # No line has all bits, so a clock may be missing. A leading zero shows that zeros are printed.
        (["1" * 15, "1" * 14], ["1" * 15, "1" * 14]),
        (["1" * 16, "0" + "1" * 14], ["1" * 16, "0" + "1" * 14]),
        (["1" * 16, "1" * 8], ["1" * 16, "1" * 8]),
    ],
)
def test_bits_in_a_column_may_lack_leading_zeros(texts: list[str], frames: list[str]) -> None:
    lines = frame_lines(texts)
    assert [line.text for line in separate_frames(lines, (16,))] == frames


def test_bytes_in_binary_are_one_frame(capsys: Capture) -> None:
    for arguments in (BYTES, (" ".join(BYTES),)):
        assert main(["decode", "TS5700N8401", *arguments]) == 0
        assert "7000519 counts" in capsys.readouterr().out
    assert main(["decode", "MT6701", "0b01010000 0b11111100 0b00000000"]) == 1
    assert "not a frame" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("code", "words", "message"),
    [
        ("ssi:position=16", ("1234", "5678"), "If these are several frames, write each on its own line"),
        ("RESOLUTE-26", ("0b0110", "0b0111"), "If these are several frames, write each on its own line"),
        # community.st.com/t5/.../m-p/301243: four bytes as an Arduino prints them.
        ("ssi:position=32", ("173", "96", "74", "45"), "Write 0xAD604A2D if it is decimal"),
        ("ssi:position=9", ("173", "96"), "If these are several frames, write each"),
        ("TLE5012B", ("0000", "0000"), "could be bits or hex bytes. Prefix it with 0b or 0x"),
        ("TS5700N8401", ("0b0110", "0b0111"), "'0b0110' is not hex"),
    ],
)
def test_words_with_several_meanings_are_rejected(
    code: str, words: tuple[str, ...], message: str, capsys: Capture
) -> None:
    for arguments in (words, (" ".join(words),)):
        assert main(["decode", code, *arguments]) == 2
        assert message in capsys.readouterr().err
