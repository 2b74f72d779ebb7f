"""A virtual encoder answers for an encoder in one line, over SSI clock by clock and over SPI word by word."""

from __future__ import annotations

import pytest
from codewheel.virtual.clocked_lines import SsiLine
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine


def ssi_word(encoder: VirtualEncoder, bits: int) -> str:
    """Return the bits of one word."""
    line = SsiLine(encoder)
    line.timeout()
    line.clock(0)
    word = ""
    for _ in range(bits):
        word += str(line.clock(1))
        line.clock(0)
    return word


def test_gray_over_ssi() -> None:
    encoder = VirtualEncoder("ssi,gray:position=13,error=high", 0b1_0110_0000_1111)
    # Gray code: each bit equals the number's bit, xor the bit before it.
    assert ssi_word(encoder, 14) == "1110100001000" + "0"
    encoder.set_flag("error")
    assert ssi_word(encoder, 14) == "1110100001000" + "1"


def test_parity_over_spi() -> None:
    line = SpiLine(VirtualEncoder("spi:parity=even,error=high,position=14", 0b10_0000_0000_0001))
    line.receive(bytes(2))
    assert line.send() == bytes([0b0010_0000, 0b0000_0001])
    line = SpiLine(VirtualEncoder("spi:parity=odd,error=high,position=14", 0b10_0000_0000_0001))
    line.receive(bytes(2))
    assert line.send() == bytes([0b1010_0000, 0b0000_0001])


def test_size_of_a_line() -> None:
    encoder = VirtualEncoder("biss:multiturn=12,singleturn=20,error,warning,crc=6:0x43")
    assert (encoder.counts, encoder.counts_per_turn) == (1 << 32, 1 << 20)


def test_wrong_lines() -> None:
    with pytest.raises(ValueError, match="no active level"):
        VirtualEncoder("ssi:position=13,error")
    with pytest.raises(ValueError, match="has no editions"):
        VirtualEncoder("ssi:position=13", edition="1.0")
