"""Six flags with long names, Gray code and one of two CRCs, in five engines, against a decoder that is written here.

The encoder is made up. Its expressions are longer than a line, so the generated code breaks them.
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
    load_made,
    remainder,
    split,
)

pytestmark = pytest.mark.slow

#: Flags in the order sent, each with the bit that makes it active.
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
POSITION_BITS = 13


def case_of(letters: str, random_: random.Random) -> Case:
    """Return a word with random bits. One CRC in five is wrong."""
    flags, (crc_width, poly) = FLAGS[letters[0]], CRCS[letters[2]]
    data_bits = POSITION_BITS + len(flags)
    data = random_.getrandbits(data_bits)
    inverted = (1 << crc_width) - 1
    right_crc = remainder(data, data_bits, poly, crc_width) ^ inverted if crc_width else 0
    crc = random_.getrandbits(crc_width) if crc_width and random_.random() < 0.2 else right_crc
    common = (f"LN{letters}", "word", data_bits + crc_width, data << crc_width | crc)
    if crc != right_crc:
        return Case(*common, "crc")
    bits = split(data, [("position", POSITION_BITS), *((flag, 1) for flag in flags)])
    position = binary_of(bits["position"]) if letters[1] == "G" else bits["position"]
    active = frozenset(flag for flag in flags if bits[flag] == ACTIVE_BITS[flag])
    values = {"position": position, **{flag: flag in active for flag in ACTIVE_BITS}}
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
    return MadeEncoder(load_made("long_names"), {"word": ("position", *ACTIVE_BITS)})


@pytest.mark.parametrize("engine", ENGINES)
def test_every_engine_decides_as_the_decoder_here_does(engine: str, import_generated: Import, tmp_path: Path) -> None:
    results = ENGINES[engine](made(), cases(), import_generated, tmp_path)
    differing = [(case, result) for case, result in zip(cases(), results, strict=True) if case != result]
    assert differing[:3] == []
    assert {case.fault for case in cases()} == {"", "crc"}
    assert {case.verdict for case in cases()} == {"", NOT_USABLE, UNKNOWN, WARNING, USABLE}
