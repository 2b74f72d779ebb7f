"""Words of several lengths over SPI: short ones for registers or the position, and a long one for the position."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine
from python_path import import_anew
from working_tools import require

pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("words")
    targets = [text for name in ("python", "c", "docs") for text in ("--target", name)]
    specs = [str(SPECS / name) for name in ("cui", "magntek", "mps")]
    assert main(["generate", *specs, *targets, "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def packages(outputs: Path) -> Iterator[dict[str, Any]]:
    names = ("cui_encoders", "magntek_encoders")
    folders = [str(outputs / "python" / name) for name in names]
    sys.path[:0] = folders
    with pytest.MonkeyPatch.context() as monkeypatch:
        yield {name: import_anew(name, monkeypatch) for name in names}
    for folder in folders:
        sys.path.remove(folder)


@pytest.fixture
def cui(packages: dict[str, Any]) -> Any:
    return packages["cui_encoders"]


@pytest.fixture
def magntek(packages: dict[str, Any]) -> Any:
    return packages["magntek_encoders"]


def checked(value: int) -> int:
    """The 14 bits with the check bits that the data sheet of the AMT22 defines, in the words of its sample code."""
    odd = sum(value >> place & 1 for place in range(1, 14, 2))
    even = sum(value >> place & 1 for place in range(0, 14, 2))
    return (~odd & 1) << 15 | (~even & 1) << 14 | value


def test_the_request_says_the_length_of_a_word() -> None:
    """AMT22: 00 00 reads the position, and 00 A0 00 00 the position and the turns. 61ABh is in the data sheet."""
    encoder = VirtualEncoder("AMT22-14", 0x21AB, specs=[SPECS])
    line = SpiLine(encoder)
    assert checked(0x21AB) == 0x61AB
    line.receive(bytes.fromhex("0000 00A00000 0000"))
    replies = line.send()
    assert (replies[:4], replies[6:]) == (bytes.fromhex("61AB 61AB"), bytes.fromhex("61AB"))
    assert int.from_bytes(replies[4:6], "big") == checked(int.from_bytes(replies[4:6], "big") & 0x3FFF)
    assert line.exchange(0x00A00000, 32) >> 16 == line.exchange(0, 16) == 0x61AB
    for word, bits in ((0, 24), (0x10000, 16), (0x10000, None)):
        with pytest.raises(ValueError, match="AMT22-14 has 16 or 32 bits"):
            line.exchange(word, bits)


def test_a_request_in_a_word_of_another_length_is_an_error() -> None:
    """MT6835: a write request in 48 bits is not a request, and nothing is written."""
    encoder = VirtualEncoder("MT6835", 5, specs=[SPECS])
    line = SpiLine(encoder)
    line.exchange(0x600107, 24)
    assert line.exchange(0x300100, 24) & 0xFF == 7
    line.exchange(0x600109 << 24, 48)
    assert line.exchange(0x300100, 24) & 0xFF == 7
    assert line.exchange(0xA00300000000, 48) >> 11 & 0x1FFFFF == 5


def test_python_pairs_words_of_both_lengths(cui: Any, magntek: Any) -> None:
    amt22 = importlib.import_module("cui_encoders.amt22")
    encoder = VirtualEncoder("AMT22-12", 0x123, specs=[SPECS])
    virtual, line = SpiLine(encoder), cui.lookup("AMT22-12").pipeline()
    assert line.bits == 0
    for request, bits in ((amt22.PositionRequest(), 16), (amt22.TurnsRequest(), 32), (amt22.PositionRequest(), 16)):
        word = line.ask(request)
        assert line.bits == bits
        answer = line.take(virtual.exchange(word, bits), bits=bits)
        assert (answer.request, answer.reply.position) == (request, 0x123)
    mt6835 = importlib.import_module("magntek_encoders.mt6835")
    virtual, line = SpiLine(VirtualEncoder("MT6835", 77, specs=[SPECS])), magntek.lookup("MT6835").pipeline()
    exchanged = []

    def exchange(word: int) -> int:
        exchanged.append((word, line.bits))
        return virtual.exchange(word, line.bits)

    magntek.run(mt6835.set_zero(0x12, 0x3), line.bus(exchange))
    assert exchanged == [(0x600912, 24), (0x300A00, 24), (0x600A30, 24)]
    assert line.take(exchange(line.ask(mt6835.AngleRequest()))).reply.position == 77
    assert line.take(exchange(line.read(mt6835.ZeroHigh))).register.zero_high == 0x12
    assert [bits for _, bits in exchanged[3:]] == [48, 24]


@pytest.mark.parametrize(
    ("data", "bits"), [(bytes(2), None), (bytes(6), None), (0, 16), (0, 48), ("0" * 31, None), (1 << 32, None)]
)
def test_python_refuses_another_length(data: Any, bits: int | None, cui: Any) -> None:
    """The reply to a request of 32 bits has 32. The pipeline stays in step."""
    amt22 = importlib.import_module("cui_encoders.amt22")
    line = cui.lookup("AMT22-14").pipeline()
    line.ask(amt22.TurnsRequest())
    with pytest.raises(cui.LengthError):
        line.take(data, bits=bits)
    line.ask(amt22.PositionRequest())
    assert line.take(bytes.fromhex("61AB")).reply.position == 0x21AB


_LENGTHS_C = """
#include <stdio.h>
#include "codewheel/spi.h"
#include "cui/amt22_spi.h"
#define encoder CUI_AMT22_SPI_14
#ifdef CUI_AMT22_SPI_WORD_BITS
#error "words have several lengths"
#endif
int main(void)
{
    static const uint8_t rx[4] = { 0x61U, 0xABU, 0xC0U, 0x00U };
    uint16_t word = 0U;
    uint32_t long_word = 0U;
    cui_amt22_spi_position position;
    cui_amt22_spi_position_and_turns both;
    printf("%d %d\\n", (int)cui_amt22_spi_position_receive(encoder, rx, 4U, &word),
           (int)cui_amt22_spi_position_and_turns_receive(encoder, rx, 2U, &long_word));
    printf("%u %u\\n", (unsigned)word, (unsigned)long_word);
    if (cui_amt22_spi_position_and_turns_receive(encoder, rx, 4U, &long_word) == CW_OK
        && cui_amt22_spi_position_and_turns_decode(encoder, long_word, &both) == CW_OK) {
        printf("%X %d\\n", (unsigned)both.position, (int)both.turns);
    }
    if (cui_amt22_spi_position_receive(encoder, rx, 2U, &word) == CW_OK
        && cui_amt22_spi_position_decode(encoder, word, &position) == CW_OK) {
        printf("%X\\n", (unsigned)position.position);
    }
    return 0;
}
"""


@pytest.mark.parametrize(
    ("header", "decoder", "word_type"),
    [
        ("cui/amt22_spi.h", "cui_amt22_spi_position_decode", "uint16_t"),
        ("cui/amt22_spi.h", "cui_amt22_spi_position_and_turns_decode", "uint32_t"),
        ("mps/ma732_spi.h", "mps_ma732_spi_position_with_parity_decode", "uint32_t"),
        ("magntek/mt6835_spi.h", "magntek_mt6835_spi_angle_decode", "uint64_t"),
    ],
)
def test_c_takes_a_word_in_the_smallest_type(outputs: Path, header: str, decoder: str, word_type: str) -> None:
    """Words of 16, 17, 32 and 48 bits."""
    text = (outputs / "c/include" / header).read_text(encoding="ascii")
    parameters = text.split(f"{decoder}(", 1)[1].split(")", 1)[0]
    assert f"{word_type} word" in parameters


def test_c_refuses_another_length(outputs: Path, tmp_path: Path) -> None:
    """A word of 32 bits sent as a word of 16 bits, and vice versa. Both words are then unchanged."""
    source, program = tmp_path / "words.c", tmp_path / "words"
    source.write_text(_LENGTHS_C, encoding="ascii")
    strict = "-std=c99 -Wall -Wextra -Wconversion -Werror -fsanitize=undefined,address".split()
    include = str(outputs / "c" / "include")
    require(["gcc", *strict])
    subprocess.run(["gcc", *strict, "-I", include, str(source), "-o", str(program)], check=True)
    completed = subprocess.run([program], capture_output=True, text=True, check=True)
    assert completed.stdout.splitlines() == ["1 1", "0 0", "21AB 0", "21AB"]


@pytest.mark.parametrize(
    ("code", "frame", "line"),
    [
        ("AMT22-14", "61 AB", "position, 16 bits"),
        ("AMT22-14", "61 AB C0 00", "position and turns, 32 bits"),
        ("AMT22-14", "0b" + f"{0x61ABC000:032b}", "position and turns, 32 bits"),
        ("AMT22-14", "0x61ABC000", "position and turns, 32 bits"),
        ("MA732", "0b10001100011000100", "position with parity, 17 bits"),
        ("AMT22-14", "61 AB C0", "length error: 'position' has 16 bits, got 24"),
        ("MT6835", "00 00 55", "length error: 'angle' has 48 bits, got 24"),
    ],
)
def test_decode_uses_the_only_frame_of_a_length(
    code: str, frame: str, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three replies of the MT6835 have 24 bits, so the name of the frame is needed."""
    main(["decode", code, frame, "--specs", str(SPECS)])
    assert line in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(("layout", "frame"), [("position", "61 AB C0 00"), ("position_and_turns", "61 AB")])
def test_decode_refuses_another_length(layout: str, frame: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["decode", "AMT22-14", frame, "--layout", layout, "--specs", str(SPECS)]) == 1
    assert f"length error: '{layout}' has" in capsys.readouterr().out


def test_the_page_says_which_word_has_which_length(outputs: Path) -> None:
    page = next((outputs / "docs").rglob("mt6835/spi.md")).read_text(encoding="utf-8")
    assert "48 or 24 bits, SPI mode 3" in page
    rows = [line for line in page.splitlines() if line.startswith("| [`") and "bits |" in line]
    lengths = [row.split("|")[3].strip() for row in rows]
    assert lengths == ["48 bits", "24 bits", "24 bits", "24 bits", "24 bits"]
    card = next((outputs / "docs").rglob("amt22/AMT22-14.md")).read_text(encoding="utf-8")
    assert "Requests the position, in words of 32 bits" in card


MAKER = "codewheel: 1\nmanufacturer: acme\ntitle: ACME\nsource: test\npython_package: late_encoders\n"
#: An encoder that answers with the next word: the position in 16 bits, or with a counter in 24.
LATE = """\
codewheel: 1
device: late
manufacturer: acme
title: Late replies of two lengths
movement: rotary
manual: {title: Manual, revision: "1.0", language: en}
parameters: {}
order_code:
  pattern: "{model}"
  source: "1"
  parts: [{name: model, meaning: Model, values: {LATE: {interface: spi}}}]
measurement: {of: position, counts_per_turn: 65536, turns: 1, source: "2"}
interfaces:
  spi:
    source: "6"
    mode: 1
    word_bits: 16
    reply: next_word
    clock: {max_hz: 10000000, source: "6.2"}
    exchanges:
      - {request: ask, reply: position, purpose: position}
      - {request: ask_both, reply: both, purpose: position, word_bits: 24}
    layouts:
      - {name: ask, from: master, source: "6", fields: [{name: command, bits: 16, constant: 1}]}
      - {name: ask_both, from: master, source: "6", fields: [{name: command, bits: 24, constant: 2}]}
      - {name: position, from: encoder, source: "6", fields: [{name: position, bits: 16}]}
      - {name: both, from: encoder, source: "6", fields: [{name: position, bits: 16}, {name: count, bits: 8}]}
evidence: {grade: manual, documents: {manual: all pages}}
"""


def test_bytes_without_a_request_are_words_of_the_shortest_length(tmp_path: Path) -> None:
    """Here, no word has the length of the interface, and none fills its bytes."""
    odd = re.sub(r"bits: (16|24), constant", lambda match: f"bits: {int(match[1]) + 1}, constant", LATE)
    odd = odd.replace("purpose: position}", "purpose: position, word_bits: 17}").replace(": 24}", ": 25}")
    odd = odd.replace("bits: 16}]", "bits: 16}, {name: rest, bits: 1, unused: 0}]").replace("bits: 8}", "bits: 9}")
    (tmp_path / "late.yaml").write_text(odd, encoding="ascii")
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="ascii")
    line = SpiLine(VirtualEncoder("LATE", 0, specs=[tmp_path]))
    line.receive(bytes.fromhex("FF FF FF FF FF FF"))
    assert line.send() == bytes(6)
    line.encoder.position = 1
    line.receive(bytes.fromhex("00 00 01 00 00 01"))
    assert line.send()[3:] == bytes.fromhex("00 00 02"), "16 bits of position, then a 0"


def test_unused_bits_above_a_word_do_not_matter(tmp_path: Path) -> None:
    """Both lengths leave unused bits at the top of the first byte, which a master may send as 1."""
    odd = re.sub(r"bits: (16|24), constant", lambda match: f"bits: {int(match[1]) + 1}, constant", LATE)
    odd = odd.replace("purpose: position}", "purpose: position, word_bits: 17}").replace(": 24}", ": 25}")
    odd = odd.replace("bits: 16}]", "bits: 16}, {name: rest, bits: 1, unused: 0}]").replace("bits: 8}", "bits: 9}")
    (tmp_path / "late.yaml").write_text(odd, encoding="ascii")
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="ascii")
    line = SpiLine(VirtualEncoder("LATE", 1, specs=[tmp_path]))
    for request in ("00 00 00 02", "FE 00 00 02"):
        line.receive(bytes.fromhex(request))
    assert line.send() == bytes(4) + bytes.fromhex("00 00 02 00"), "16 bits of position, then the counter"


def test_a_late_reply_needs_a_word_of_its_length(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "late.yaml").write_text(LATE, encoding="ascii")
    (tmp_path / "manufacturer.yaml").write_text(MAKER, encoding="ascii")
    assert main(["generate", str(tmp_path), "--target", "python", "-o", str(tmp_path / "out")]) == 0
    monkeypatch.syspath_prepend(str(tmp_path / "out" / "python"))
    package = importlib.import_module("late_encoders")
    late = importlib.import_module("late_encoders.late")
    encoder = VirtualEncoder("LATE", 0x1234, specs=[tmp_path])
    virtual, line = SpiLine(encoder), package.lookup("LATE").pipeline()
    exchanged = []
    for request in (late.Ask(), late.Ask(), late.AskBoth(), late.AskBoth(), late.Ask(), late.Ask()):
        word = line.ask(request)
        received = virtual.exchange(word, line.bits)
        answer = line.take(received, bits=line.bits)
        exchanged.append((received, None if answer is None else answer.reply.position))
    # The reply to the second request ends with zeros in a longer word, and that to the fourth lacks its end.
    long_reply = exchanged[3][0]
    assert long_reply >> 8 == 0x1234
    assert exchanged == [
        (0, None), (0x1234, 0x1234), (0x123400, None), (long_reply, 0x1234), (0x1234, None), (0x1234, 0x1234),
    ]  # fmt: skip
