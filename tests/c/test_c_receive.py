"""From the bits that SPI, DMA or a serial port received to the word of a decoder.

The lines are drawn bit by bit here. They follow the protocol description of BiSS C (p. 3, 5 and 7) and the SSI sections
of the manuals, and are independent of the project's code.
"""

from __future__ import annotations

import random
import subprocess
from collections.abc import Callable, Iterable, Sequence
from itertools import product
from pathlib import Path

import pytest
from c_harness import FAMILIES, GCC, SANITIZED, WARNINGS, MadeOnce, Run, compile_c, runner
from codewheel.model import Alternative, Answer, Device
from codewheel.plan.frames import FrameSize, received_sizes
from codewheel.targets.c.device import views_of

OK, LENGTH, CRC, CONSTANT, RANGE = range(5)
TIMEOUT = 6
LINE_HIGH, LINE_LOW, NO_START, REPEAT, HEAD_MISSING = range(8, 13)

#: Each line has one answer. All numbers and words of bytes are in hexadecimal.
PROGRAM = r"""
#include "codewheel/receive_frame.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned long long number(void)
{
    const char *const item = strtok(NULL, " \n");
    return (item == NULL) ? 0ULL : strtoull(item, NULL, 0);
}

/* Into memory of just this size, so that a byte too far is seen. */
static uint8_t *bytes(size_t *size)
{
    const char *const item = strtok(NULL, " \n");
    size_t at;
    uint8_t *made;
    *size = (item[0] == '-') ? 0U : strlen(item) / 2U;
    made = (uint8_t *)malloc(*size + (*size == 0U));
    for (at = 0U; at < *size; at++) {
        const char digits[3] = { item[2U * at], item[2U * at + 1U], '\0' };
        made[at] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return made;
}

static void show(const uint8_t *data, size_t size)
{
    size_t at;
    for (at = 0U; at < size; at++) {
        printf("%02X", data[at]);
    }
    printf("\n");
}

int main(void)
{
    static char text[4096];
    static cw_rs485_line line;
    while (fgets(text, sizeof text, stdin) != NULL) {
        const char verb = strtok(text, " \n")[0];
        uint64_t word = 0xA5A5A5A5A5A5A5A5ULL;
        size_t size = 0U;
        uint8_t *rx = (strchr("bBcCfFgsSWX", verb) != NULL) ? bytes(&size) : NULL;
        if (verb == 'b') {
            const cw_result result = cw_biss_receive(rx, size, (uint32_t)number(), &word);
            printf("%d %llu\n", (int)result, (unsigned long long)word);
        } else if (verb == 'c') {
            bool cds = false;
            const cw_result result = cw_biss_receive_cds(rx, size, &cds);
            printf("%d %d\n", (int)result, (int)cds);
        } else if (verb == 'B' || verb == 'C') {
            const size_t received = (size_t)number();
            bool cds = false;
            const cw_result result = (verb == 'B') ? cw_biss_receive_bits(rx, received, (uint32_t)number(), &word)
                : cw_biss_receive_cds_bits(rx, received, &cds);
            printf("%d %llu\n", (int)result, (verb == 'B') ? (unsigned long long)word : (cds ? 1ULL : 0ULL));
        } else if (verb == 'f' || verb == 'F' || verb == 'g') {
            const size_t received = (verb == 'F') ? (size_t)number() : 0U;
            const uint32_t bits = (uint32_t)number();
            const size_t length = (size_t)number();
            uint8_t *const frame = (uint8_t *)malloc(length + (length == 0U));
            cw_result result = CW_OK;
            memset(frame, 0xA5, length);
            if (verb == 'g') {
                result = cw_ssi_receive_frame(rx, size, bits, frame, length);
            } else {
                result = (verb == 'f') ? cw_biss_receive_frame(rx, size, bits, frame, length)
                    : cw_biss_receive_frame_bits(rx, received, bits, frame, length);
            }
            printf("%d ", (int)result);
            show(frame, length);
            free(frame);
        } else if (verb == 's') {
            const cw_result result = cw_ssi_receive(rx, size, (uint32_t)number(), &word);
            printf("%d %llu\n", (int)result, (unsigned long long)word);
        } else if (verb == 'r') {
            const uint64_t first = number();
            const uint64_t second = number();
            const uint64_t modulus = number();
            printf("%d\n", (int)cw_ssi_repeats(first, second, modulus, number()));
        } else if (verb == 'S') {
            const uint8_t mask = (uint8_t)number();
            show(rx, cw_received_samples(rx, size, mask, rx));
        } else if (verb == 'W' || verb == 'X') {
            const size_t wide = (verb == 'W') ? 2U : 4U;
            uint8_t *const out = (uint8_t *)malloc(size + 1U);
            uint16_t halves[64];
            uint32_t words[64];
            size_t at;
            for (at = 0U; at < size / wide; at++) {
                halves[at] = (uint16_t)(((unsigned)rx[wide * at] << 8) | rx[wide * at + 1U]);
                words[at] = (verb == 'W') ? 0U : ((uint32_t)halves[at] << 16)
                    | ((uint32_t)rx[4U * at + 2U] << 8) | rx[4U * at + 3U];
            }
            if (verb == 'W') {
                cw_received_words16(halves, size / wide, out);
            } else {
                cw_received_words32(words, size / wide, out);
            }
            show(out, size / wide * wide);
            free(out);
        } else if (verb == 'a') {
            const uint8_t control = (uint8_t)number();
            const size_t length = (size_t)number();
            const size_t echo = (size_t)number();
            const uint32_t now = (uint32_t)number();
            printf("%d\n", (int)cw_rs485_ask(&line, control, length, echo, now, (uint32_t)number()));
        } else if (verb == 't') {
            printf("%d\n", (int)cw_rs485_take(&line, (uint8_t)number()));
        } else if (verb == 'T') {
            printf("%d\n", (int)cw_rs485_take_any(&line, (uint8_t)number()));
        } else if (verb == 'u') {
            cw_rs485_resume(&line);
            printf("%lu\n", (unsigned long)line.count);
        } else if (verb == 'l') {
            printf("%d\n", (int)cw_rs485_late(&line, (uint32_t)number()));
        } else if (verb == 'y') {
            printf("%d %lu\n", (int)cw_rs485_reason(&line), (unsigned long)line.dropped);
        } else {
            show(line.bytes, line.length);
        }
        free(rx);
    }
    return 0;
}
"""


@pytest.fixture(scope="session")
def run(include: Path, made_once: MadeOnce) -> Run:
    """Run the program, with checks for undefined behaviour."""
    command = [*GCC, "-O1", *SANITIZED]
    return runner(made_once("receive", lambda folder: compile_c(command, PROGRAM, folder, include)) / "program")


Ask = Callable[[str], list[int]]


@pytest.fixture(scope="session")
def ask(run: Run) -> Ask:
    return lambda line: [int(number) for number in run([line])[0].split()]


# --------------------------------------------------------------------------------------------------------- drawn lines


def in_bytes(bits: Sequence[int], then: int = 0) -> str:
    """Return bits as hex bytes, the first in bit 7. The rest of the last byte is filled with ``then``."""
    whole = [*bits, *[then] * (-len(bits) % 8)]
    return "".join(f"{int(''.join(map(str, whole[at : at + 8])), 2):02X}" for at in range(0, len(whole), 8)) or "-"


def bits_of(number: int, width: int) -> list[int]:
    return [number >> place & 1 for place in range(width - 1, -1, -1)]


def biss_line(data: Sequence[int], rest_bits: int = 2, acknowledge: int = 1, cds: int = 0, stop: int = 0) -> list[int]:
    """Return SLO at each rising edge of MA: rest, acknowledge, start, CDS, data and stop bit (PROT p. 3)."""
    return [*[1] * rest_bits, *[0] * acknowledge, 1, cds, *data, stop]


def test_a_line_on_paper(ask: Ask) -> None:
    """11 000 1 0 10110 0: the word 10110, CDS 0 and the stop bit 0. Then the line is high again."""
    line = [1, 1, 0, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 1, 1]
    assert in_bytes(line) == "C567"
    assert ask("b C567 5") == [OK, 0b10110]
    assert ask("c C567") == [OK, 0]
    assert ask("c C767") == [OK, 1]
    # One more bit would interpret the stop bit as data, and find a 1 instead of a 0.
    assert ask("b C567 6") == [CONSTANT, 0xA5A5A5A5A5A5A5A5]


def test_a_word_after_every_rest_and_acknowledge(run: Run) -> None:
    """Widths from 0 to 64, a rest of 1 to 9 bits, an acknowledge of 1 to 40 bits: every position within a byte."""
    chance = random.Random(1)
    lines, expected = [], []
    for width in range(65):
        for _ in range(60):
            word, cds = chance.getrandbits(width), chance.getrandbits(1)
            line = biss_line(bits_of(word, width), chance.randint(1, 9), chance.randint(1, 40), cds)
            received = in_bytes(line, chance.getrandbits(1))
            lines += [f"b {received} {width}", f"c {received}"]
            expected += [f"0 {word}", f"0 {cds}"]
    # No data bits in a long buffer: 1, the acknowledge, the start bit, CDS, and zeros to the end.
    assert run([*lines, "b B000000000000000 0"]) == [*expected, "0 0"]


def test_each_fault_of_a_biss_line(ask: Ask) -> None:
    word = bits_of(0x5A3C, 16)
    untouched = 0xA5A5A5A5A5A5A5A5
    assert ask("b FFFFFFFFFFFF 16") == [LINE_HIGH, untouched]
    assert ask("b - 16") == [LINE_HIGH, untouched], "nothing received, nothing low"
    assert ask("b 000000000000 16") == [LINE_LOW, untouched]
    # The line is still in the timeout of the previous frame, so the next bits may be the end of anything.
    assert ask(f"b {in_bytes([0, *biss_line(word)])} 16") == [LINE_LOW, untouched]
    assert ask("b C00000000000 16") == [NO_START, untouched]
    assert ask(f"b {in_bytes(biss_line(word, stop=1))} 16") == [CONSTANT, untouched]
    for missing in range(1, 20):
        # Rest and start end at a whole byte. Then whole bytes are missing, or the start comes too late.
        line = [1, *[0] * 6, 1, 0, *word, 0, *[0] * 6][: 32 - 8]
        assert ask(f"b {in_bytes(line[:24])} 16") == [LENGTH, untouched]
        late = biss_line(word, 2, 13 + missing)[:32]
        assert ask(f"b {in_bytes(late)} 16")[0] in (LENGTH, NO_START)
    assert ask(f"b {in_bytes(biss_line(bits_of(0, 70)))} 65") == [LENGTH, untouched]
    assert ask(f"b {in_bytes(biss_line(word))} 4294967295") == [LENGTH, untouched]
    assert ask("c FFFF") == ask("c C000") == ask("c C001") == [LENGTH, 0]
    assert ask(f"c {in_bytes([0, *biss_line(word, cds=1)])}") == [LINE_LOW, 0]


def test_the_stop_bit_is_checked_where_it_was_received(ask: Ask) -> None:
    """Some receivers clock in no stop bit, so the last bit of the word may be the last bit of the buffer."""
    line = biss_line(bits_of(0x2B5, 10), 2, 1)  # 2 + 1 + 2 + 10 bits, and the stop bit: 16
    assert ask(f"b {in_bytes(line)} 10") == [OK, 0x2B5]
    assert ask(f"b {in_bytes(biss_line(bits_of(0x2B5, 10), 2, 1, stop=1))} 10") == [CONSTANT, 0xA5A5A5A5A5A5A5A5]
    line = biss_line(bits_of(0x2B5, 10), 2, 2)[:16]
    assert ask(f"b {in_bytes(line)} 10") == [OK, 0x2B5]
    line = biss_line(bits_of(0x2B5, 10), 2, 3)[:16]
    assert ask(f"b {in_bytes(line)} 10") == [LENGTH, 0xA5A5A5A5A5A5A5A5]
    # In a long buffer, the stop bit is loaded together with the word.
    for width in (10, 31, 32, 45, 56):
        word = bits_of(0x2B5, width)
        buffers = [in_bytes([*biss_line(word, 2, 4, stop=stop), *[1] * 60]) for stop in (0, 1)]
        assert [ask(f"b {buffer} {width}") for buffer in buffers] == [[OK, 0x2B5], [CONSTANT, 0xA5A5A5A5A5A5A5A5]]
    # The stop bit reveals a frame that is one bit longer, if there is a stop bit.
    line = biss_line(bits_of(0x56B, 11), 2, 1)[:16]
    assert ask(f"b {in_bytes(line)} 10") == [CONSTANT, 0xA5A5A5A5A5A5A5A5]


def test_a_frame_in_any_number_of_samples(run: Run) -> None:
    """69 samples as mjbots/moteus takes them, 20 before the start bit: each frame that is complete in them is found."""
    chance = random.Random(5)
    packing, counts, expected = [], [], []
    for count in range(60, 76):
        for rest_bits, acknowledge in product((1, 2, 5), range(1, 20)):
            word, cds = chance.getrandbits(47), chance.getrandbits(1)
            line = (biss_line(bits_of(word, 47), rest_bits, acknowledge, cds) + [1] * count)[:count]
            packing.append(f"S {bytes(bit << 3 | chance.getrandbits(8) & 0xF7 for bit in line).hex()} 8")
            counts.append(count)
            whole = rest_bits + acknowledge + 2 + 47 <= count
            expected += [f"0 {word}" if whole else f"{LENGTH} {0xA5A5A5A5A5A5A5A5}", f"0 {cds}"]
    packed = run(packing)
    assert [len(line) // 2 for line in packed] == [(count + 7) // 8 for count in counts]
    pairs = zip(packed, counts, strict=True)
    assert (
        run(request for line, count in pairs for request in (f"B {line} {count} 47", f"C {line} {count}")) == expected
    )


def test_what_fills_up_the_last_byte_is_no_part_of_a_frame(run: Run) -> None:
    """Samples that end within a word are an error, also in the form for whole bytes. SSI has no CRC to detect it."""
    chance = random.Random(6)
    lines = []
    for bits in range(1, 40):
        for count in range(1, bits + 2):
            samples = [1, *bits_of(chance.getrandbits(bits), bits), 0][:count]
            lines.append((bits, bytes(samples).hex()))
    packed = run(f"S {samples} 1" for _, samples in lines)
    answers = run(f"s {line} {bits}" for line, (bits, _) in zip(packed, lines, strict=True))
    assert {answer.split()[0] for answer in answers} == {str(fault) for fault in (LENGTH, CONSTANT, LINE_HIGH)}
    # The acknowledge lasts until the last sample, or only the start bit is present.
    for line in ([1, *[0] * 18], [1, *[0] * 18, 1]):
        (filled,) = run([f"S {bytes(line).hex()} 1"])
        assert run([f"C {filled} {len(line)}"]) == [f"{LENGTH} 0"]
        assert run([f"B {filled} {len(line)} 5"])[0].split()[0] == str(LENGTH if line[-1] else NO_START)


def test_words_of_16_and_32_bits_and_samples(run: Run) -> None:
    """Every form in which a peripheral stores the received bits leads to the same bytes."""
    chance = random.Random(2)
    data = bytes(chance.randrange(256) for _ in range(24))
    assert run([f"W {data.hex()}", f"X {data.hex()}"]) == [data.hex().upper()] * 2
    bits = [bit for byte in data for bit in bits_of(byte, 8)]
    for mask in (0x01, 0x10, 0x80):
        # The other pins of the port can have any level.
        samples = [chance.randrange(256) & ~mask | (mask if bit else 0) for bit in bits]
        for spare in range(8):
            line = bytes([*samples, *[0] * spare]).hex()
            assert run([f"S {line} {mask}"]) == [data.hex().upper() + (f"{0xFF >> spare:02X}" if spare else "")]
    assert run(["S 01000001010001 1", "S - 1"]) == ["9B", ""]
    # With several pins, a sample is 1 if any of them is.
    assert run(["S 02000001030001 3", "S 0400000402000600 6"]) == ["9B", "9A"]


# ------------------------------------------------------------------------------------------------------------- as bytes


def test_a_frame_of_any_length_as_bytes(run: Run) -> None:
    """From 0 to 128 bits, at every position within a byte, in as many bytes as it needs or in more."""
    chance = random.Random(8)
    lines, expected = [], []
    for width in range(129):
        for length in ((width + 7) // 8, 16):
            word = chance.getrandbits(width)
            line = biss_line(bits_of(word, width), chance.randint(1, 9), chance.randint(1, 40), chance.getrandbits(1))
            lines.append(f"f {in_bytes(line)} {width} {length}")
            lines.append(f"F {in_bytes(line)} {len(line) - chance.getrandbits(1)} {width} {length}")
            lines.append(f"g {in_bytes([1, *bits_of(word, width), 0])} {width} {length}")
            expected += [f"0 {word:0{2 * length}X}" if length else "0 "] * 3
    assert run(lines) == expected


def test_each_fault_of_a_frame_as_bytes(run: Run) -> None:
    word, untouched = bits_of(0x5A3C << 64 | 1, 80), "A5" * 10
    biss, ssi = biss_line(word), [1, *word, 0]
    fault_by_line = {
        f"f {'FF' * 12} 80 10": LINE_HIGH,
        "f - 80 10": LINE_HIGH,
        f"f {'00' * 12} 80 10": LINE_LOW,
        f"f {in_bytes([0, *biss])} 80 10": LINE_LOW,
        f"f C0{'00' * 11} 80 10": NO_START,
        f"f {in_bytes(biss_line(word, stop=1))} 80 10": CONSTANT,
        f"F {in_bytes(biss)} {len(biss) - 2} 80 10": LENGTH,
        f"f {in_bytes(biss)} 4294967295 10": LENGTH,
        f"f {in_bytes(biss_line([*word, 0]))} 81 10": LENGTH,
        f"g {'FF' * 12} 80 10": LINE_HIGH,
        f"g {'00' * 12} 80 10": LINE_LOW,
        f"g {in_bytes([0, *word, 0])} 80 10": LINE_LOW,
        f"g {in_bytes([1, *word, 1])} 80 10": CONSTANT,
        f"g {in_bytes(ssi)[:20]} 80 10": LENGTH,
        f"g {in_bytes([*ssi, 0])} 81 10": LENGTH,
        "g - 1 10": LENGTH,
        "g 80 4294967295 10": LENGTH,
    }
    assert run(fault_by_line) == [f"{result} {untouched}" for result in fault_by_line.values()]
    assert run([f"F {in_bytes(biss)} {len(biss) - 1} 80 10"]) == [f"0 {0x5A3C << 64 | 1:020X}"], "no stop bit"


# ------------------------------------------------------------------------------------------------------------------ SSI


class SsiEncoder:
    """The data line of an encoder is high at rest, and the first falling edge stores the position.

    Each rising edge shifts out a bit, the most significant first, then zeros until the clock has rested for the
    monoflop time.
    """

    def __init__(self, word: int, bits: int) -> None:
        self.left, self.data = bits_of(word, bits), 1

    def rise(self) -> None:
        self.data = self.left.pop(0) if self.left else 0


@pytest.mark.parametrize("mode", [2, 3])
def test_an_ssi_word_as_each_spi_mode_samples_it(mode: int, run: Run) -> None:
    chance = random.Random(3)
    lines, expected = [], []
    for width in range(1, 65):
        for _ in range(20):
            word = chance.getrandbits(width)
            encoder, line = SsiEncoder(word, width), []
            for _ in range(8 * ((width + 2 + 7) // 8)):
                # The clock rests high, so it falls first. The bit follows the rising edge.
                at_the_falling_edge = encoder.data
                at_the_rising_edge = encoder.data
                encoder.rise()
                line.append(at_the_falling_edge if mode == 2 else at_the_rising_edge)
            lines.append(f"s {in_bytes(line)} {width}")
            expected.append(f"0 {word}")
    assert run(lines) == expected


def test_each_fault_of_an_ssi_line(ask: Ask) -> None:
    untouched = 0xA5A5A5A5A5A5A5A5
    assert ask("s FFFFFF 20") == [LINE_HIGH, untouched], "not plugged in"
    assert ask("s 000000 20") == [LINE_LOW, untouched], "a short"
    assert ask(f"s {in_bytes([0, *bits_of(0x12345, 20), 0])} 20") == [LINE_LOW, untouched], "the pause was too short"
    assert ask(f"s {in_bytes([1, *bits_of(0x12345, 20), 1])} 20") == [CONSTANT, untouched], "a word of 21 bits"
    assert ask(f"s {in_bytes([1, *bits_of(0xFFFFF, 20), 0])} 20") == [OK, 0xFFFFF], "all ones can be a position"
    assert ask(f"s {in_bytes([1, *bits_of(0, 20), 0])} 20") == [OK, 0]
    assert ask("s 800000 23") == [LENGTH, untouched]
    assert ask("s 800000 22") == [OK, 0]
    assert ask("s FFFFFFFFFFFFFFFFFFFFFFFF 65") == ask("s - 1") == ask("s 80 4294967295") == [LENGTH, untouched]


@pytest.mark.parametrize(
    ("first", "second", "modulus", "at_most", "result"),
    [
        (100, 100, 4096, 0, OK),
        (100, 103, 4096, 3, OK),
        (103, 100, 4096, 3, OK),
        (100, 104, 4096, 3, REPEAT),
        (4095, 0, 4096, 1, OK),
        (1, 4095, 4096, 2, OK),
        (1, 4095, 4096, 1, REPEAT),
        (1, 4095, 0, 2, REPEAT),
        (1, 4095, 0, 4094, OK),
        (0, 2**64 - 1, 0, 2**64 - 1, OK),
        (0, 2**63, 0, 2**63 - 1, REPEAT),
        (2048, 0, 4096, 2048, OK),
        (2048, 0, 4096, 2047, REPEAT),
        (4096, 0, 4096, 9, RANGE),
        (0, 4096, 4096, 9, RANGE),
        (0, 0, 1, 0, OK),
    ],
)
def test_two_readings_agree(first: int, second: int, modulus: int, at_most: int, result: int, ask: Ask) -> None:
    assert ask(f"r {first} {second} {modulus} {at_most}") == [result]


# --------------------------------------------------------------------------------------------------------------- RS-485

#: Data ID 3 of AMM5, control byte 1Ah: eleven bytes, of which the last is the XOR of the others.
REPLY = [0x1A, 0x00, 0xC7, 0xD1, 0x6A, 0x23, 0x02, 0x00, 0x00, 0x00]
REPLY = [*REPLY, 0x1A ^ 0xC7 ^ 0xD1 ^ 0x6A ^ 0x23 ^ 0x02]


def received_replies(
    ask_many: Run, control: int, length: int, stream: Iterable[int], echo: int = 0
) -> tuple[list[int], list[str]]:
    """Return the result of a receiver for these bytes: the bytes that end a reply, and the replies whose XOR is 0.

    The others are refused, as a decoder would refuse them.
    """
    state = [f"a {control} {length} {echo} 0 100"]
    ends, replies = [], []
    for index, byte in enumerate(stream):
        state.append(f"t {byte}")
        if ask_many(state)[-1] == "1":
            data = ask_many([*state, "d"])[-1]
            xor = 0
            for data_byte in bytes.fromhex(data):
                xor ^= data_byte
            if xor == 0:
                ends.append(index)
                replies.append(data)
            else:
                state.append("u")
    return ends, replies


def test_a_reply_byte_by_byte(run: Run) -> None:
    assert received_replies(run, 0x1A, 11, REPLY) == ([10], [bytes(REPLY).hex().upper()])
    # Bytes after a complete reply are dropped, and nothing is late.
    assert run(["a 26 11 0 0 100", *(f"t {byte}" for byte in [*REPLY, 0x1A]), "d", "l 4000000000"])[-2:] == [
        bytes(REPLY).hex().upper(),
        "0",
    ]


@pytest.mark.parametrize("noise", [[0x00], [0xFF, 0x7E], [0x1A], [0x1A, 0x1A], [0x1A, 0x02, 0x1A]])
def test_noise_before_a_reply_costs_nothing(noise: list[int], run: Run) -> None:
    assert received_replies(run, 0x1A, 11, [*noise, *REPLY])[1] == [bytes(REPLY).hex().upper()]


def test_the_echo_of_a_request(run: Run) -> None:
    assert received_replies(run, 0x1A, 11, [0x1A, *REPLY], echo=1) == ([11], [bytes(REPLY).hex().upper()])
    assert received_replies(run, 0xEA, 4, [0xEA, 0x0A, 0xE0, 0xEA, 0x0A, 0x55, 0xB5], echo=3) == ([6], ["EA0A55B5"])


def test_a_reply_that_can_begin_with_any_byte(run: Run) -> None:
    """The example in the data sheet of the AMT21, 61ABh with the low byte first. After it, bytes are dropped."""
    reply = ["T 171", "T 97"]
    assert run(["a 84 2 0 0 100", *reply, "T 84", "d"]) == ["0", "0", "1", "0", "AB61"]
    assert run(["a 84 2 1 0 100", "T 84", *reply, "d"]) == ["0", "0", "0", "1", "AB61"], "after an echo"
    assert run(["a 84 2 0 0 100", "T 171", "l 101", "y"])[-2:] == ["1", f"{LENGTH} 0"]


def test_a_lost_byte_ends_in_a_time_out(run: Run) -> None:
    head = ["a 26 11 0 4294967290 100"]
    lines = [*head, *(f"t {byte}" for byte in REPLY[:4] + REPLY[5:])]
    # 6 us are left before the time wraps around, so the 100 us are over at 94.
    assert run([*lines, "l 4294967290", "l 4294967295", "l 94", "l 95"])[-4:] == ["0", "0", "0", "1"]
    # The next request discards the rest of it.
    assert run([*lines, "a 26 11 0 0 100", *(f"t {byte}" for byte in REPLY)])[-1] == "1"


def test_a_first_byte_that_is_always_lost_has_a_reason_of_its_own(run: Run) -> None:
    """1,000 replies whose first byte came while the driver still held the line.

    This is distinguished from silence and from a reply that is cut short, even if some byte in them looks like the
    start of a reply.
    """
    chance = random.Random(7)
    lines, among = [], 0
    for _ in range(1000):
        data = [chance.choice([0x00, 0x10, 0x20]), *(chance.randrange(256) for _ in range(9))]
        among += 0x1A in data
        lines += ["a 26 11 0 0 100", *(f"t {byte}" for byte in data), "l 101", "y"]
    answers = run(lines)
    assert set(answers[11::13]) == {"1"}
    assert {line.split()[0] for line in answers[12::13]} == {str(HEAD_MISSING)}
    assert {line for line in answers[12::13] if line.endswith(" 10")}, "all ten dropped"
    assert among > 10

    def reason(*stream: int) -> str:
        return run(["a 26 11 0 0 100", *(f"t {byte}" for byte in stream), "y"])[-1]

    assert reason() == f"{TIMEOUT} 0"
    assert reason(*REPLY[:4], *REPLY[5:]) == f"{LENGTH} 0"
    assert reason(*REPLY) == f"{OK} 0"
    assert reason(0xFF, *REPLY) == f"{OK} 1", "noise before a whole reply"
    assert reason(*[0] * 30) == f"{HEAD_MISSING} 16", "it counts as far as the longest reply"
    # The next request starts counting again.
    assert run(["a 26 11 0 0 100", "t 0", "y", "a 26 11 0 0 100", "y"])[-3:] == [f"{HEAD_MISSING} 1", "0", "6 0"]


def test_what_cannot_be_waited_for(run: Run) -> None:
    assert run(["a 26 0 0 0 100", "a 26 17 0 0 100", "a 26 16 0 0 100", "l 100", "l 101"]) == ["1", "1", "0", "0", "1"]


def test_a_line_of_zeros_waits_for_nothing(run: Run) -> None:
    assert run(["t 0", "l 4000000000", "u"]) == ["0", "0", "0"]


# -------------------------------------------------------------------------------------------------------------- lengths


#: From the manuals: AMM5 6.2.1 p.32 (nbitres + 8) and 5.2; AM36 6.3.1 p.21; ASC85 6.2.1 p.20; SMA21 6.2 p.25 and 5.2.
LENGTHS = {
    "amm5": {
        "BISS_A23_65KSC1": 47,
        "BISS_A17_1SC1": 25,
        "BISS_B21_65KSC1": 45,
        "SSI_A23_65KBG1": 39,
        "SSI_A17_1BG1": 17,
    },
    # With the 0 bit that the manual prints, and without it, as read by OnStepX.
    "asc85": {"BISS_25_SC1_AS_PRINTED": 34, "BISS_25_SC1_LEFT_OUT": 33, "BISS_20_SC2_LEFT_OUT": 28},
    "am36": {"BISS_AM3616_4096_I7": 44, "SSI_AM3619_4096_BG": 31, "SSI_AMC3616_4096_GG": 28},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("compiler", "standard", "assertion"),
    [("gcc", "c11", "_Static_assert"), ("g++", "c++11", "static_assert")],
)
@pytest.mark.parametrize("family", LENGTHS)
def test_lengths_are_constants(
    compiler: str, standard: str, assertion: str, family: str, include: Path, tmp_path: Path
) -> None:
    """As sizes of arrays and in static asserts.

    A wrong length is an error, which shows that the assert is evaluated.
    """
    kinds = {name.split("_")[0].lower() for name in LENGTHS[family]}
    lines = [f'#include "lika/{family}_{kind}.h"' for kind in sorted(kinds)]
    for name, bits in LENGTHS[family].items():
        stem = f"LIKA_{family.upper()}_{name}"
        around = 2 if name.startswith("SSI") else 2 + 40 + 1 + 1 + 1
        lines += [
            f"static uint8_t rx_{name.lower()}[{stem}_RX_BYTES];",
            f'{assertion}({stem}_BITS == {bits}U, "bits");',
            f'{assertion}(sizeof rx_{name.lower()} == {(bits + around + 7) // 8}U, "bytes");',
        ]
    lines.append("int main(void) { return " + " + ".join(f"rx_{name.lower()}[0]" for name in LENGTHS[family]) + "; }")
    language = "c++" if compiler == "g++" else "c"
    object_file = str(tmp_path / "made.o")
    command = [compiler, f"-std={standard}", "-x", language, *WARNINGS, f"-I{include}", "-c", "-o", object_file, "-"]
    completed = subprocess.run(command, input="\n".join(lines) + "\n", capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr[:3000]
    mistaken = "\n".join(lines).replace("_BITS == ", "_BITS == 1U + ") + "\n"
    assert subprocess.run(command, input=mistaken, capture_output=True, text=True).returncode != 0


def decided(device: Device, reception: FrameSize) -> list[tuple[Alternative, Answer]]:
    """Return the answers that a receiver depends on, each with its question."""
    pairs = [(question, answer) for question in device.alternatives for answer in reception.answers]
    return [(question, answer) for question, answer in pairs if answer in question.answers]


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_the_constants_are_what_the_functions_say(
    family: str, every_device: dict[str, Device], include: Path, tmp_path: Path
) -> None:
    device = every_device[family]
    views = list(views_of(device))
    lines = [f'#include "{view.header}"' for view in views] + ["int main(void) {", "    int wrong = 0;"]
    count = 0
    for view in views:
        rows = {row.variant.code: row.macro for row in view.variants.rows}
        for reception in received_sizes(view.device, view.context.interface):
            macro = rows[reception.variant.code]
            # The user's decision is the last argument of the function, and the end of the name.
            decisions = decided(view.device, reception)
            arguments = [f", {view.PREFIX}_{question.name}_{answer.name}".upper() for question, answer in decisions]
            stem = "_".join((macro, *(answer.name for answer in reception.answers))).upper()
            lines.append(f"    wrong += {view.prefix}_bits({macro}{''.join(arguments)}) != {stem}_BITS;")
            count += 1
    lines += ["    return wrong;", "}"]
    program = compile_c(GCC, "\n".join(lines) + "\n", tmp_path, include)
    # Each order code of ASC85 with BiSS has two lengths.
    again = sum(variant.interface == "biss" for variant in device.variants) if family == "asc85" else 0
    assert count == sum(variant.interface in ("ssi", "biss") for variant in device.variants) + again
    assert subprocess.run([str(program)]).returncode == 0
