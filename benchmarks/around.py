"""Measure the code around the decoders: receivers, tracker, angles, procedures, and a BiSS master.

    python benchmarks/around.py            measures and prints
    python benchmarks/around.py --write    also writes its table in docs/trust/footprint.md and benchmarks/around.json,
                                           which tests/verify/test_footprint.py checks

Each part is a program with one function, linked as in footprint.py, with the parts of the compiler's library it needs.
Its bytes are measured, and for some parts also the instructions of one call.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from operator import xor
from pathlib import Path

from boards import BOARDS, Board
from candidates import FRAMES, word, write_headers

HERE = Path(__file__).resolve().parent
RECORDED = HERE / "around.json"
PAGE = HERE.parent / "docs/trust/footprint.md"
BEGIN, END = "<!-- measured around -->", "<!-- end of measured around -->"
#: Bytes of each part, and the count of its call or None.
Figures = Mapping[str, tuple[int, int | None]]


@dataclass(frozen=True)
class Call:
    """One call of ``measured``: C variables, its arguments, and a test that it did what it should.

    The test can use the value that it returned as ``result``. ``at_most`` limits the count by the name of a board.
    """

    variables: str
    arguments: str
    good: str
    at_most: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """A function ``measured`` that calls ours. It may take up to ``most`` bytes on a Cortex-M. 0 means no limit."""

    title: str
    headers: tuple[str, ...]
    given: str
    body: str
    most: int = 0
    call: Call | None = None

    @property
    def head(self) -> str:
        return f"uint32_t measured({self.given})"

    def includes(self, ending: str = "") -> str:
        return "".join(f'#include "{name}"\n' for name in self.headers if name.endswith(ending))

    @property
    def source(self) -> str:
        return f"{self.includes()}{self.head};\n{self.head}\n{{\n    {self.body}\n}}\n"

    def entry(self, call: Call) -> str:
        """Return C code as in candidates.entry, with the call, an empty call and a check of what it returned."""
        return f"""{self.includes(".h")}{self.head};
{call.variables}
extern __typeof__(measured) nothing;
static volatile uint32_t result;
volatile int good;
void entry(void);
void entry_of_nothing(void);
void check(void);
void entry(void)
{{
    result = measured({call.arguments});
}}
void entry_of_nothing(void)
{{
    result = nothing({call.arguments});
}}
void check(void)
{{
    good = ({call.good}) ? 1 : 0;
}}
"""


(BISS,) = (frame for frame in FRAMES if frame.name == "biss47")
WORD, BITS, BUFFER = word(BISS), 47, 96
POSITION = WORD >> 8
BY_HAND = f"{HERE}/c/hand.h", f"{HERE}/c/hand_receive.c", f"{HERE}/c/hand_spi.c"


def _line_bits(acknowledge: int) -> str:
    """Return the bits of a BiSS buffer: rest, acknowledge, start, CDS, word, stop, then rest again."""
    return ("11" + "0" * acknowledge + "10" + f"{WORD:0{BITS}b}" + "0").ljust(BUFFER, "1")


def _c_bytes(bits: str) -> str:
    return ", ".join(f"0x{int(bits[at : at + 8], 2):02X}U" for at in range(0, len(bits), 8))


def _buffer(acknowledge: int) -> str:
    return f"static const uint8_t rx[] = {{ {_c_bytes(_line_bits(acknowledge))} }};\n"


def _samples(acknowledge: int) -> str:
    """Return samples of bit 3 of a port, whose other bits differ from sample to sample."""
    port = (0x51 + 37 * at & 0xF7 | int(bit) << 3 for at, bit in enumerate(_line_bits(acknowledge)))
    listed = ", ".join(f"0x{sample:02X}U" for sample in port)
    return f"static const uint8_t samples[] __attribute__((aligned(4))) = {{ {listed} }};\nstatic uint8_t rx[12];\n"


def _to_position(size: str) -> str:
    read = BISS.decoder.replace("_decode", "_read")
    return f"return ({read}({BISS.variant}, rx, {size}, position) == CW_NOT_USABLE) ? 1U : 0U;"


_POSITION_OUT = "static uint64_t position;\n"
_FOUND = f"result == 0U && position == UINT64_C({POSITION:#x})"
_RX = f"{BUFFER // 8}U"
_SSI_RX = f"static const uint8_t rx[] = {{ {_c_bytes('1' + f'{POSITION:039b}' + '0' * 8)} }};\n"
_AXIS = """static cw_tracker axis = { 1U, 0U, 1000U, 0U, 250U, 1062500U, 0U, 0xFFFFFFFFU, 0xFFFFFFFFU,
    UINT64_C(0x8000000000), UINT64_C(0x7FFFFFFFFF), 0x7FFFFFFFFF, 100 };
static const uint64_t position = 100U;
"""
_RECEIVED = "result == 0U && word == UINT64_C(0x%x)"
#: A reply of AMM5 to data ID 3 without an active flag: control, status, singleturn, encoder ID, multiturn, alarms.
_REPLY = bytes((0x1A, 0x00, 0x67, 0x45, 0x23, 0x23, 0xBC, 0x0A, 0x00, 0x00))
_REPLY_RX = ", ".join(f"0x{byte:02X}U" for byte in (*_REPLY, reduce(xor, _REPLY)))
_REPLY_POSITION = 0xABC << 23 | 0x234567
#: A word of AS5048A: the parity bit is 1, because the angle has five ones, and the error flag is 0.
_ANGLE_14 = 0x1234
_WORD_14 = 1 << 15 | _ANGLE_14
#: A word of MT6835: 16 bits sent during the request, 21 bits of angle, three flags, and their CRC x^8 + x^2 + x + 1.
_ANGLE_21, _CRC_21 = 0x12345, 0x37
_WORD_21 = 0xFFFF << 32 | _ANGLE_21 << 11 | _CRC_21


def _buffer_receivers(acknowledge: int) -> Iterator[Part]:
    """Yield receivers of a buffer of bits, ours and by hand."""
    named = f"{acknowledge}-bit acknowledge"
    buffer = _buffer(acknowledge)
    yield Part(
        f"BiSS buffer to usable position, {named}",
        (BISS.header, "codewheel/receive.h"),
        "const uint8_t *rx, uint64_t *position",
        _to_position(_RX),
        call=Call(buffer + _POSITION_OUT, "rx, &position", _FOUND, {"cortex-m0plus": 180, "cortex-m4": 80}),
    )
    yield Part(
        f"the same by hand, {named}",
        BY_HAND,
        "const uint8_t *rx, uint64_t *position",
        "return (hand_position47(rx, position) == HAND_NOT_USABLE) ? 1U : 0U;",
        call=Call(buffer + _POSITION_OUT, "rx, &position", _FOUND),
    )


def _sample_receivers(acknowledge: int) -> Iterator[Part]:
    """Yield receivers of pin samples, ours and by hand."""
    named = f"{acknowledge}-bit acknowledge"
    samples = _samples(acknowledge)
    yield Part(
        f"{BUFFER} pin samples to usable position, {named}",
        (BISS.header, "codewheel/receive.h"),
        "const uint8_t *samples, uint8_t *rx, uint64_t *position",
        f"(void)cw_received_samples(samples, {BUFFER}U, 0x08U, rx);\n    " + _to_position(_RX),
        call=Call(samples + _POSITION_OUT, "samples, rx, &position", _FOUND, {"cortex-m4": 400}),
    )
    yield Part(
        f"the same samples by hand, {named}",
        BY_HAND,
        "const uint8_t *samples, uint8_t *rx, uint64_t *position",
        "return (hand_samples47(samples, rx, position) == HAND_NOT_USABLE) ? 1U : 0U;",
        call=Call(samples + _POSITION_OUT, "samples, rx, &position", _FOUND),
    )


def _receivers() -> Iterator[Part]:
    for acknowledge in (4, 20):
        yield from _buffer_receivers(acknowledge)
        yield from _sample_receivers(acknowledge)
        yield Part(
            f"receive: a 47-bit BiSS frame, {acknowledge}-bit acknowledge",
            ("codewheel/receive.h",),
            "const uint8_t *rx, uint64_t *word",
            f"return (uint32_t)cw_biss_receive(rx, {BUFFER // 8}U, {BITS}U, word);",
            300,
            Call(_buffer(acknowledge) + "static uint64_t word;\n", "rx, &word", _RECEIVED % WORD),
        )


def _replies_to_usable_positions() -> Iterator[Part]:
    """Yield the paths from an RS-485 reply to a usable position, ours and by hand."""
    yield from _two_ways(
        "11-byte RS-485 reply to usable position (AMM5)",
        "the same RS-485 reply by hand",
        "lika/amm5_rs485.h",
        "const uint8_t *rx, uint64_t *position",
        "LIKA_AMM5_RS485_READ_BYTES(A23_65KJP1, rx, 11U, position)",
        "hand_rs485_position(rx, position)",
        Call(
            f"static const uint8_t rx[] = {{ {_REPLY_RX} }};\n" + _POSITION_OUT,
            "rx, &position",
            f"result == 3U && position == UINT64_C({_REPLY_POSITION:#x})",
            {"cortex-m0plus": 120, "cortex-m4": 60},
        ),
    )


def _words_to_usable_positions() -> Iterator[Part]:
    """Yield the paths from an SPI word to a usable position, ours and by hand."""
    yield from _two_ways(
        "48-bit SPI word with a CRC to usable position (MT6835)",
        "the same 48-bit word by hand",
        "magntek/mt6835_spi.h",
        "uint64_t word, uint32_t *position",
        "magntek_mt6835_spi_angle_position(MAGNTEK_MT6835_SPI_MT6835, word, position)",
        "hand_mt6835_position(word, position)",
        Call(
            f"static const uint64_t word = UINT64_C({_WORD_21:#x});\nstatic uint32_t position;\n",
            "word, &position",
            f"result == 3U && position == {_ANGLE_21}U",
            {"cortex-m0plus": 38, "cortex-m4": 27},
        ),
    )
    yield from _two_ways(
        "16-bit SPI word with parity to usable position (AS5048A)",
        "the same 16-bit word by hand",
        "ams/as5048a_spi.h",
        "uint16_t word, uint16_t *position",
        "ams_as5048a_spi_position_position(AMS_AS5048A_SPI_AS5048A, word, position)",
        "hand_as5048a_position(word, position)",
        Call(
            f"static const uint16_t word = {_WORD_14:#x}U;\nstatic uint16_t position;\n",
            "word, &position",
            f"result == 3U && position == {_ANGLE_14}U",
            {"cortex-m0plus": 26, "cortex-m4": 14},
        ),
    )


def _two_ways(
    title: str, title_by_hand: str, header: str, parameters: str, our_call: str, hand_call: str, call: Call
) -> Iterator[Part]:
    """Yield two parts that return the verdict on a position, ours and by hand. Only ours has limits."""
    yield Part(title, (header,), parameters, f"return (uint32_t){our_call};", call=call)
    yield Part(title_by_hand, BY_HAND, parameters, f"return (uint32_t){hand_call};", call=replace(call, at_most={}))


PARTS = (
    *_receivers(),
    *_replies_to_usable_positions(),
    *_words_to_usable_positions(),
    Part(
        "receive: a 39-bit SSI word",
        ("codewheel/receive.h",),
        "const uint8_t *rx, uint64_t *word",
        "return (uint32_t)cw_ssi_receive(rx, 6U, 39U, word);",
        300,
        Call(
            _SSI_RX + "static uint64_t word;\n",
            "rx, &word",
            _RECEIVED % POSITION,
            {"cortex-m0plus": 40, "cortex-m4": 22},
        ),
    ),
    Part(
        "the same SSI word by hand",
        BY_HAND,
        "const uint8_t *rx, uint64_t *word",
        "return (uint32_t)hand_ssi39(rx, word);",
        call=Call(_SSI_RX + "static uint64_t word;\n", "rx, &word", _RECEIVED % POSITION),
    ),
    Part(
        "receive: RS-485 byte by byte, also after a rejected reply",
        ("codewheel/receive.h",),
        "cw_rs485_line *line, uint8_t byte, uint32_t now",
        "if (byte == 0U) { cw_rs485_resume(line); } return cw_rs485_take(line, byte) || cw_rs485_late(line, now);",
    ),
    Part(
        "tracker: a position",
        ("codewheel/tracker.h",),
        "cw_tracker *axis, const uint64_t *position, uint32_t now",
        "return (uint32_t)cw_tracker_add(axis, *position, now);",
        240,
        Call(_AXIS, "&axis, &position, 1250U", "result == 0U && axis.position == 0x8000000064"),
    ),
    Part(
        "tracker: its speed",
        ("codewheel/tracker.h",),
        "const cw_tracker *axis",
        "return (uint32_t)cw_tracker_speed(axis);",
        call=Call(_AXIS, "&axis", "result == 400000U"),
    ),
    Part(
        "tracker: its speed, by division",
        ("codewheel/tracker.h",),
        "const cw_tracker *axis",
        "return (uint32_t)cw_counts_per_second_divided(axis->moved, axis->elapsed_us);",
        call=Call(_AXIS, "&axis", "result == 400000U"),
    ),
    Part(
        "angle: counts are a constant power of two",
        ("codewheel/angle.h",),
        "const uint64_t *position",
        "return cw_angle(*position, 8388608U);",
    ),
    Part(
        "angle: any number of counts",
        ("codewheel/angle.h",),
        "const uint64_t *position, const uint64_t *steps",
        "return cw_angle(*position, *steps);",
    ),
    Part(
        "angle: electrical, as Q31",
        ("codewheel/angle.h",),
        "uint32_t angle, uint32_t offset",
        "return (uint32_t)cw_angle_q31(cw_angle_electrical(angle, 7U, offset));",
    ),
    Part(
        "angle: thousandths of a degree",
        ("codewheel/angle.h",),
        "uint32_t angle",
        "return cw_angle_millidegrees(angle);",
    ),
    Part(
        "runner: start and end of a step",
        ("codewheel/runner.h",),
        "cw_runner *runner, int32_t error, uint32_t now",
        "cw_runner_done(runner, error, now); return (uint32_t)cw_runner_next(runner, now);",
    ),
    Part(
        "BiSS master: control bit and answer in the same frame",
        ("codewheel/biss.h",),
        "cw_biss_master *master, bool cds",
        "return cw_biss_master_next(master, cds) ? 1U : 0U;",
    ),
    Part(
        "BiSS master: answer one frame after the control bit",
        ("codewheel/biss.h",),
        "cw_biss_master *master, bool cds",
        "return cw_biss_master_next_late(master, cds) ? 1U : 0U;",
    ),
)


def measured(part: Part, board: Board, include: Path, folder: Path) -> tuple[int, int | None]:
    """Return the bytes of a part on a board, and the count of its call."""
    source, entry = folder / "around.c", folder / "entry.c"
    source.write_text(part.source, encoding="utf-8")
    count = None
    if part.call is not None:
        entry.write_text(part.entry(part.call), encoding="utf-8")
        count = board.executed([source, entry], [include], folder)
    return board.size([source], [include], "measured", folder), count


def measure(board: Board, include: Path, folder: Path) -> Figures:
    """Return the figures of all parts on a board."""
    return {part.title: measured(part, board, include, folder) for part in PARTS}


def table(figures: Mapping[str, Figures]) -> str:
    lines = ["| | " + " | ".join(f"{board.name}: bytes / {board.unit}" for board in BOARDS) + " |"]
    lines += ["|---" * (len(BOARDS) + 1) + "|"]
    for part in PARTS:
        pairs = (figures[board.name][part.title] for board in BOARDS)
        cells = (f"{size}" if count is None else f"{size} / {count}" for size, count in pairs)
        lines.append(f"| {part.title} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write docs/trust/footprint.md and the recorded figures")
    write = parser.parse_args().write
    with tempfile.TemporaryDirectory() as name:
        include = write_headers(Path(name))
        figures = {board.name: measure(board, include, Path(name)) for board in BOARDS}
    print(table(figures))
    if write:
        page = PAGE.read_text(encoding="utf-8")
        before, after = page[: page.index(BEGIN) + len(BEGIN)], page[page.index(END) :]
        PAGE.write_text(f"{before}\n\n{table(figures)}\n{after}", encoding="utf-8")
        recorded = {board.name: {"compiler": board.version(), "figures": figures[board.name]} for board in BOARDS}
        RECORDED.write_text(json.dumps(recorded, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except (RuntimeError, FileNotFoundError) as problem:
        sys.exit(f"around: {problem}")
