"""Six flags with long names, Gray code and one of two CRCs, in five engines, compared with a decoder written here.

The encoder is made up. Its expressions are longer than a line, so the generated code breaks them. Zeros are between the
parts of the position if it is binary.
"""

from __future__ import annotations

import random
from functools import cache
from itertools import product
from pathlib import Path

import pytest
from five_engines import (
    ENGINES,
    NOT_USABLE,
    UNKNOWN,
    USABLE,
    WARNING,
    Case,
    Import,
    MadeEncoder,
    joined,
    load_made,
    remainder,
    split,
)

pytestmark = pytest.mark.slow

#: Flags in the order sent, each with its active level.
ACTIVE_BITS = {
    "broken_glass": 1,
    "missing_light": 0,
    "wrong_counter": 1,
    "warm_bearing": 0,
    "weak_battery": 1,
    "dirty_glass": 0,
}
ERRORS = {"broken_glass", "missing_light", "wrong_counter"}
#: Flags of the order codes by their first letter.
FLAGS = {"X": (), "E": ("broken_glass",), "W": ("warm_bearing", "dirty_glass"), "A": tuple(ACTIVE_BITS)}
#: Width and polynomial of the CRC by the last letter. Each is sent inverted.
CRCS = {"N": (0, 0), "S": (6, 0x03), "L": (16, 0x90D9)}
TURNS_BITS, ANGLE_BITS = 4, 9


def case_of(letters: str, random_: random.Random) -> Case:
    """Return a word with random bits. One CRC in five is wrong, and one word in five can have a 1 among its zeros."""
    flags, is_gray, (crc_width, poly) = FLAGS[letters[0]], letters[1] == "G", CRCS[letters[2]]
    zero_bits = 0 if is_gray else 2
    widths = [("turns", TURNS_BITS), ("zeros", zero_bits), ("angle", ANGLE_BITS), *((flag, 1) for flag in flags)]
    data_bits = sum(width for _, width in widths)
    bits = split(random_.getrandbits(data_bits), widths)
    bits["zeros"] *= random_.random() < 0.2
    data = joined(bits, widths)
    inverted = (1 << crc_width) - 1
    right_crc = remainder(data, data_bits, poly, crc_width) ^ inverted if crc_width else 0
    crc = random_.getrandbits(crc_width) if crc_width and random_.random() < 0.2 else right_crc
    common = (f"LN{letters}", "word", data_bits + crc_width, data << crc_width | crc)
    if crc != right_crc or bits["zeros"]:
        return Case(*common, "crc" if crc != right_crc else "constant")
    sent_position = bits["turns"] << ANGLE_BITS | bits["angle"]
    position = binary_of(sent_position) if is_gray else sent_position
    active = frozenset(flag for flag in flags if bits[flag] == ACTIVE_BITS[flag])
    values = {
        "turns": position >> ANGLE_BITS,
        "angle": position & (1 << ANGLE_BITS) - 1,
        **{flag: flag in active for flag in ACTIVE_BITS},
        "position": position,
    }
    return Case(*common, "", verdict_of(flags, active), active, values)


def binary_of(gray: int) -> int:
    number = 0
    while gray:
        number, gray = number ^ gray, gray >> 1
    return number


def verdict_of(flags: tuple[str, ...], active: frozenset[str]) -> str:
    """Return the verdict. Without flags, nothing of a frame judges the position."""
    if not flags:
        return UNKNOWN
    if active & ERRORS:
        return NOT_USABLE
    return WARNING if active else USABLE


@cache
def cases() -> tuple[Case, ...]:
    random_ = random.Random("long names")
    codes = ["".join(letters) for letters in product(FLAGS, "BG", CRCS)]
    return tuple(case_of(letters, random_) for letters in codes for _ in range(100))


@cache
def made() -> MadeEncoder:
    return MadeEncoder(load_made("long_names"), {"word": ("turns", "angle", *ACTIVE_BITS, "position")})


@pytest.mark.parametrize("engine", ENGINES)
def test_every_engine_decides_as_the_decoder_here_does(engine: str, import_generated: Import, tmp_path: Path) -> None:
    results = ENGINES[engine](made(), cases(), import_generated, tmp_path)
    differing = [(case, result) for case, result in zip(cases(), results, strict=True) if case != result]
    assert differing[:3] == []
    assert {case.fault for case in cases()} == {"", "crc", "constant"}
    assert {case.verdict for case in cases()} == {"", NOT_USABLE, UNKNOWN, WARNING, USABLE}
