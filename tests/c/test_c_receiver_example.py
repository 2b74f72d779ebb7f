"""The program that follows an axis from raw SPI buffers, with a line that is drawn here, including its errors."""

from __future__ import annotations

import random
import re
import subprocess
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
from c_harness import GCC, SANITIZED, MadeOnce, compile_c, devices_of, write

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
#: AMM5A23/65KSC1: 39 bits of position, nE, nW and six of CRC (6.2.1 p.32), received into twelve bytes.
POSITION_BITS, SIZE = 39, 12
FRAMES = 100_000


def crc_6(data: int, bits: int) -> int:
    """Return the CRC x^6 + x + 1 with start value 0, inverted, bit by bit, as in PROT p. 7-8."""
    remainder = 0
    for place in range(bits - 1, -1, -1):
        top = remainder >> 5 ^ data >> place & 1
        remainder = remainder << 1 & 0x3F ^ (0x03 if top else 0)
    return remainder ^ 0x3F


def word(position: int, error: bool = False, warning: bool = False) -> int:
    data = position << 2 | (not error) << 1 | (not warning)
    return data << 6 | crc_6(data, POSITION_BITS + 2)


class Line:
    """Return SLO in one buffer: rest, delay, acknowledge, start, CDS, word, stop bit, and low during the timeout."""

    BITS = 8 * SIZE

    def __init__(self, chance: random.Random, frame: int, acknowledge: int, delay: int) -> None:
        self.chance = chance
        self.acknowledge = range(2 + delay, 2 + delay + acknowledge)
        self.start = self.acknowledge.stop
        self.word = range(self.start + 2, self.start + 2 + POSITION_BITS + 8)
        bits = [1] * self.acknowledge.start + [0] * acknowledge + [1, chance.getrandbits(1)]
        bits += [frame >> place & 1 for place in range(len(self.word) - 1, -1, -1)] + [0]
        # The timeout may end within the buffer. The line is high after it.
        bits += [0] * chance.randrange(8) + [1] * self.BITS
        self.bits = bits[: self.BITS]

    def flip(self, place: int) -> None:
        self.bits[place] ^= 1

    @property
    def bytes(self) -> bytes:
        return int("".join(map(str, self.bits)), 2).to_bytes(SIZE, "big")


def nothing(line: Line) -> None:
    """A valid frame."""


def one_bit(line: Line) -> None:
    line.flip(line.chance.choice(line.word))


def two_bits(line: Line) -> None:
    for place in line.chance.sample(line.word, 2):
        line.flip(place)


def burst(line: Line) -> None:
    """Up to six bits in a row, which a CRC of six bits always detects."""
    first = line.chance.choice(line.word[:-6])
    line.flip(first)
    for place in range(first + 1, first + 6):
        line.bits[place] = line.chance.getrandbits(1)


def stuck_high(line: Line) -> None:
    line.bits = [1] * line.BITS


def stuck_low(line: Line) -> None:
    line.bits = [0] * line.BITS


def cut(line: Line) -> None:
    """The cable breaks in the middle of a frame, and the receiver pulls the line up."""
    place = line.chance.choice(line.word)
    line.bits[place:] = [1] * (line.BITS - place)


def never_ready(line: Line) -> None:
    """The acknowledge lasts longer than the buffer."""
    line.bits[line.acknowledge.start :] = [0] * (line.BITS - line.acknowledge.start)


def too_late(line: Line) -> None:
    """The frame begins too late to fit."""
    rest_bits = line.chance.randrange(60, line.BITS)
    line.bits = (line.bits[:2] + [0] * (rest_bits - 2) + line.bits[line.start :])[: line.BITS]


def still_in_the_time_out(line: Line) -> None:
    """The master did not wait, so the buffer begins in the previous frame."""
    line.bits = ([0] * line.chance.randrange(1, 20) + line.bits)[: line.BITS]


CERTAIN: tuple[Callable[[Line], None], ...] = (
    *(one_bit, two_bits, burst, stuck_high, stuck_low),
    *(cut, never_ready, too_late, still_in_the_time_out),
)


def moved(line: Line) -> None:
    """The acknowledge or start bit is disturbed, so the word is found at the wrong place."""
    line.flip(line.chance.choice([*line.acknowledge, line.start]))


def story(seed: int) -> Iterator[tuple[str, int, bool, bytes]]:
    """Yield the event, the unwrapped position of the shaft, whether the encoder reports an error, and the buffer.

    The shaft moves forwards and back across the wrap, and is read every 100 us.
    """
    chance = random.Random(seed)
    position, speed = (1 << POSITION_BITS) - 20_000, 3000
    for _ in range(FRAMES):
        speed = max(-8000, min(8000, speed + chance.randint(-200, 200)))
        position += speed
        error = chance.random() < 0.02
        # The warning of a multiturn model may concern its revolutions, so the position is not usable.
        warning = chance.random() < 0.02
        sent_word = word(position % (1 << POSITION_BITS), error, warning)
        error = error or warning
        line = Line(chance, sent_word, chance.randint(1, 38), chance.randint(0, 3))
        fault = chance.choices((nothing, chance.choice(CERTAIN), moved), (80, 18, 2))[0]
        before = list(line.bits)
        fault(line)
        name = fault.__name__ if line.bits != before else nothing.__name__
        yield "error" if error and name == "nothing" else name, position, error, line.bytes


@pytest.fixture(scope="module")
def program(made_once: MadeOnce) -> Path:
    def built(folder: Path) -> None:
        include = write(folder, devices_of())
        text = (include.parent / "examples" / "amm5_biss_dma.c").read_text(encoding="ascii")
        compile_c([*GCC, "-O2", *SANITIZED], text, folder, include)

    return made_once("amm5_biss_dma", built) / "program"


#: Output of the program: the time, and the position of the axis at which time.
SAID = re.compile(r"(\d+) us: (?:no position yet|(-?\d+) counts at (\d+) us, (-?\d+) counts/s)")


class FrameOutcome(NamedTuple):
    """The event of a frame, whether the tracker ``took`` it, and the first wrong statement that followed, if any."""

    name: str
    took: bool
    problem: str


def frame_outcomes(rows: Sequence[tuple[str, int, bool, bytes]], lines: Sequence[str]) -> Iterator[FrameOutcome]:
    """Compare each line of the program with the shaft.

    The position must be the shaft's at the printed time, and the speed must follow from the frame accepted before.
    """
    last: tuple[int, int] | None = None
    for index, ((name, _, error, _), line) in enumerate(zip(rows, lines, strict=True)):
        match = SAID.fullmatch(line)
        assert match, line
        assert int(match[1]) == 100 * index
        if match[2] is None:
            yield FrameOutcome(name, False, "" if last is None else f"{line}: forgotten")
            continue
        position, at_us, speed = map(int, match.groups()[1:])
        before = last or (position, at_us)
        took = at_us == 100 * index
        last = (position, at_us) if took else before
        if position != rows[at_us // 100][1] or (took and error) or (not took and at_us != before[1]):
            yield FrameOutcome(name, took, f"{line}: the shaft is elsewhere")
        elif took and at_us > before[1] and speed != int((position - before[0]) * 1e6 / (at_us - before[1])):
            yield FrameOutcome(name, took, f"{line}: not its speed")
        else:
            yield FrameOutcome(name, took, "")


@pytest.fixture(scope="module")
def rows() -> list[tuple[str, int, bool, bytes]]:
    return list(story(14))


def printed_lines(program: Path, rows: Sequence[tuple[str, int, bool, bytes]]) -> list[str]:
    completed = subprocess.run([str(program)], input=b"".join(row[3] for row in rows), capture_output=True, timeout=300)
    assert completed.returncode == 0, completed.stderr
    return completed.stdout.decode().splitlines()


@pytest.fixture(scope="module")
def outcomes(program: Path, rows: Sequence[tuple[str, int, bool, bytes]]) -> list[FrameOutcome]:
    return list(frame_outcomes(rows, printed_lines(program, rows)))


def test_100_000_buffers_without_a_wrong_position(outcomes: Sequence[FrameOutcome]) -> None:
    assert len(outcomes) == FRAMES
    assert [outcome.problem for outcome in outcomes if outcome.problem] == []


def test_what_is_taken_and_what_is_not(outcomes: Sequence[FrameOutcome]) -> None:
    counts: dict[str, Counter[bool]] = defaultdict(Counter)
    for outcome in outcomes:
        counts[outcome.name][outcome.took] += 1
    assert counts["nothing"][True] > 70_000
    assert set(counts["nothing"]) == {True}, "no valid frame is lost"
    assert set(counts["error"]) == {False}, "an encoder that reports an error has no position"
    assert all(counts[fault.__name__][False] > 1500 and not counts[fault.__name__][True] for fault in CERTAIN)
    # One of 64 moved words has a matching CRC, and only the limit of the tracker detects those.
    assert counts["moved"][False] > 1500


def test_the_axis_goes_past_the_end_of_its_positions(rows: Sequence[tuple[str, int, bool, bytes]]) -> None:
    turns = {position >> POSITION_BITS for _, position, _, _ in rows}
    assert turns == {0, 1}


def test_what_the_limit_is_for(program: Path, rows: Sequence[tuple[str, int, bool, bytes]], tmp_path: Path) -> None:
    """A tracker that knows nothing of the past accepts moved words with a matching CRC."""
    folder = program.parent / "c"
    text = (folder / "examples" / "amm5_biss_dma.c").read_text(encoding="ascii")
    added = "cw_tracker_add(&axis"
    assert text.count(added) == 1
    compile_c([*GCC, "-O2"], text.replace(added, f"axis.known = 0U; {added}"), tmp_path, folder / "include")
    believing = list(frame_outcomes(rows, printed_lines(tmp_path / "program", rows)))
    assert any(outcome.took and outcome.problem for outcome in believing if outcome.name == "moved")


def test_the_constants_of_the_program() -> None:
    header = (ROOT / "generated" / "c" / "include" / "lika" / "amm5_biss.h").read_text(encoding="ascii")
    assert f"#define LIKA_AMM5_BISS_A23_65KSC1_RX_BYTES {SIZE}U " in header
    assert f"#define LIKA_AMM5_BISS_A23_65KSC1_BITS {POSITION_BITS + 8}U " in header
