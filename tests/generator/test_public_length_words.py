"""Words of encoders without a public driver, against the tables of their manuals.

Of each word, half are valid words with one to three bits changed. No implementation of these encoders is public, so
the decoders are written from the pages that the specs cite, with arithmetic on whole numbers. They share no code with
the generator.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

pytestmark = pytest.mark.slow

SPECS = Path(__file__).resolve().parents[2] / "specs"
WORDS = 200_000
Importer = Callable[[Library, str], tuple[Path, ModuleType]]


class Expected(NamedTuple):
    """Position and verdict of a word, or no position if the word is rejected."""

    position: int | None
    verdict: str


REJECTED = Expected(None, "rejected")


def binary_number(gray_code: int) -> int:
    """Return the number of a code in Gray code: each bit is the parity of all bits from the highest one down to it."""
    number = 0
    while gray_code:
        number ^= gray_code
        gray_code >>= 1
    return number


def verdict_of(is_judged: bool, is_unusable: bool, has_warning: bool = False) -> str:
    if not is_judged:
        return "unknown"
    if is_unusable:
        return "not_usable"
    return "usable_with_warning" if has_warning else "usable"


def dl100(order_code: str, word: int) -> Expected:
    """Table 62 of the operating instructions."""
    data_format = order_code.removeprefix("DL100-")
    if data_format == "G25DME":
        # Bin24E with a downstream Gray coding over the entire 25 bits, including the error bit.
        number = binary_number(word)
        return Expected(number // 2, verdict_of(True, number % 2 == 1))
    decode = binary_number if data_format.startswith("G") else int
    if data_format in ("GRY24E", "BIN24E"):
        return Expected(decode(word // 2), verdict_of(True, word % 2 == 1))
    if data_format in ("G24S8", "B24S8"):
        status = word % 256
        # S8 and S7 are errors, S6 and S5 are warnings.
        return Expected(decode(word // 256), verdict_of(True, status >= 64, status // 16 % 4 != 0))
    return Expected(decode(word), "unknown")


def dl1000(order_code: str, word: int) -> Expected:
    """Tables 6 to 9 of the operating instructions."""
    _, data_format, _ = order_code.split("-")
    decode = binary_number if data_format.startswith("GRAY") else int
    if data_format.endswith("S1"):
        return Expected(decode(word // 2), verdict_of(True, word % 2 == 1))
    if data_format.endswith("S8"):
        # From the top: device error, application error, device warning, application warning.
        return Expected(decode(word // 256), verdict_of(True, word // 64 % 4 != 0, word // 16 % 4 != 0))
    return Expected(decode(word), "unknown")


def bml_s1g(order_code: str, word: int) -> Expected:
    """Tab. 6-4 of the user's guide: the error bit, null bits that are always 0, and the position."""
    bits = int(order_code[len("BML-S1G0-S") :].partition("-")[0])
    position_bits = {24: 22, 25: 23, 26: 24, 32: 28}[bits]
    zeros = word % (1 << (bits - 1)) >> position_bits
    if zeros:
        return REJECTED
    return Expected(word % (1 << position_bits), verdict_of(True, word >> (bits - 1) == 1))


def remainder(number: int, bits: int) -> int:
    """Return the CRC of a number with the polynomial 0x43: the remainder of a division in binary, inverted."""
    number <<= 6
    for place in reversed(range(bits)):
        if number >> (place + 6) & 1:
            number ^= 0x43 << place
    return number ^ 0x3F


def bml_biss(_: str, word: int) -> Expected:
    """Tab. 6-8 of the user's guide: four null bits, 28 bits, error, warning and CRC."""
    data = word >> 6
    if remainder(data, 34) != word % 64 or data >> 30:
        return REJECTED
    # Error and warning are active low.
    return Expected(data >> 2, verdict_of(True, data & 2 == 0, data & 1 == 0))


def msa213c(_: str, word: int) -> Expected:
    """Pages 15 and 17 of the instructions: the sign, 24 bits for 0 to 16383999 µm, error, warning and CRC."""
    data = word >> 6
    position = data >> 2 & 0xFFFFFF
    if remainder(data, 27) != word % 64 or position > 16_383_999:
        return REJECTED
    is_negative = data >> 26 == 1
    return Expected(position, verdict_of(True, is_negative or data & 2 == 0, data & 1 == 0))


def ocd(order_code: str, word: int) -> Expected:
    """The rows "SSI Format" and "Code" of the product pages: M and S in Gray code, and 0 only for the SHD1."""
    if "-SHD1G-" in order_code:
        word, zero = divmod(word, 2)
        if zero:
            return REJECTED
    return Expected(binary_number(word), "unknown")


def acuro(order_code: str, word: int) -> Expected:
    """Page 9 of the interface data sheet: all bits are the position. The product page names the two codes."""
    return Expected(binary_number(word) if order_code.endswith("G") else word, "unknown")


def icmn(order_code: str, word: int) -> Expected:
    """Tables 59, 60 and 63 of the data sheet: revolutions and angle, error, warning and CRC."""
    _, _, angle, turns, _ = order_code.split("-")
    data = word >> 6
    if remainder(data, int(angle) + int(turns) + 2) != word % 64:
        return REJECTED
    return Expected(data >> 2, verdict_of(True, data & 2 == 0, data & 1 == 0))


def icpvl(order_code: str, word: int) -> Expected:
    """Pages 19 to 21 of the data sheet: 40 bits of revolutions, then the optional bits, from left to right."""
    code, sync, error, warning, parity = order_code.rpartition("-")[2]
    optional_bits = int(sync) + (error != "N") + (warning == "W") + (parity != "N")
    if parity != "N" and word.bit_count() % 2 != (parity == "O"):
        return REJECTED
    turns = word >> optional_bits
    flags = word // 2 if parity != "N" else word
    # The warning is to the right of the error, and has its level.
    has_warning = warning == "W" and flags % 2 == (error == "H")
    error_bit = flags // 2 % 2 if warning == "W" else flags % 2
    verdict = verdict_of(error != "N", error_bit == (error == "H"), has_warning)
    return Expected(binary_number(turns) if code == "G" else turns, verdict)


class Family(NamedTuple):
    """A family with its decoder from the manual, and the bits of each order code."""

    manufacturer: str
    name: str
    position: str
    decode: Callable[[str, int], Expected]
    bits: dict[str, int]
    #: Number of bits before a CRC, or 0 without one.
    data_bits: int = 0
    #: Highest bits of the data that are 0.
    zeros: int = 0


DL100 = {"GRY24E": 25, "GRY24": 24, "GRY25": 25, "G25DME": 25, "G24S8": 32}
DL100_BINARY = {"BIN24E": 25, "BIN24": 24, "BIN25": 25, "B24S8": 32}
DL1000 = {"24": 24, "24S1": 25, "24S8": 32, "25": 25}
BML = {"S24": 24, "S25": 25, "S26": 26, "S32": 32}
OCD = {"OCD-S101G-0013": 13, "OCD-S101G-1213": 25, "UCD-SHD1G-0013": 14, "UTD-S101G-1616": 32}
ACURO = {"0014-G": 14, "0017-B": 17, "1214-B": 26, "1217-G": 29}
ICPVL = {"B0NNN": 40, "G0NNE": 41, "B3NNO": 44, "G3LNN": 44, "B1HNE": 43, "G3LWO": 46, "B2HWN": 44, "G0LWE": 43}
FAMILIES = [
    Family("sick", "dl100", "distance", dl100, {f"DL100-{form}": n for form, n in (DL100 | DL100_BINARY).items()}),
    Family("sick", "dl1000", "distance", dl1000, {f"DT1000-GRAY{form}-1MM": n for form, n in DL1000.items()}),
    Family("sick", "dl1000", "distance", dl1000, {f"DL1000-BINARY{form}-100UM": n for form, n in DL1000.items()}),
    Family("balluff", "bml_s1g", "position", bml_s1g, {f"BML-S1G0-{form}-2000": n for form, n in BML.items()}),
    Family("balluff", "bml_s1g", "position", bml_biss, {"BML-S1G0-B-2048": 40}, data_bits=34, zeros=4),
    Family("siko", "msa213c", "position", msa213c, {"MSA213C-S": 33}, data_bits=27),
    Family("posital", "ocd", "position", ocd, OCD),
    Family("hengstler", "acuro", "position", acuro, {f"ACURO-{form}": n for form, n in ACURO.items()}),
    Family("ichaus", "icmn", "position", icmn, {"iC-MN-25-8-T2": 41}, data_bits=35),
    Family("ichaus", "icpvl", "multiturn", icpvl, {f"iC-PVL-40-{form}": n for form, n in ICPVL.items()}),
    Family("ichaus", "icmn", "position", icmn, {"iC-MN-8-0-T16": 16}, data_bits=10),
]


def words_of(family: Family, order_code: str, count: int) -> Iterator[int]:
    """Yield words, every second one with one to three bits changed."""
    generator = random.Random(order_code)
    bits = family.bits[order_code]
    for number in range(count):
        if family.data_bits:
            data = generator.getrandbits(family.data_bits - family.zeros)
            word = data << 6 | remainder(data, family.data_bits)
        else:
            word = generator.getrandbits(bits)
        if number % 2:
            for place in generator.sample(range(bits), generator.randint(1, 3)):
                word ^= 1 << place
        yield word


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: f"{family.name}-{next(iter(family.bits))}")
def test_words(import_generated: Importer, family: Family) -> None:
    np: Any = pytest.importorskip("numpy")
    folder = SPECS / family.manufacturer
    devices, report = load_library([folder / f"{family.name}.yaml", folder / "manufacturer.yaml"])
    assert not report
    _, module = import_generated(Library(tuple(devices)), f"{family.manufacturer}_encoders")
    for order_code in family.bits:
        encoder: Any = module.lookup(order_code)
        words = list(words_of(family, order_code, WORDS // len(family.bits)))
        expected_values = [family.decode(order_code, word) for word in words]
        table = encoder.decode_many(np.array(words, dtype=np.uint64))
        is_valid = np.array([expected.position is not None for expected in expected_values])
        assert (table.ok == is_valid).all(), order_code
        positions = np.array([expected.position or 0 for expected in expected_values], dtype=np.int64)
        assert (table[family.position][is_valid] == positions[is_valid]).all(), order_code
        verdicts = np.array([expected.verdict for expected in expected_values])[is_valid]
        valid_words = np.array(words, dtype=np.uint64)[is_valid]
        for verdict in sorted(set(verdicts.tolist())):
            assert len(set(table.verdict[is_valid][verdicts == verdict].tolist())) == 1, (order_code, verdict)
            for word in valid_words[verdicts == verdict][:100]:
                assert encoder.decode(int(word)).verdict.value == verdict, (order_code, int(word))


def test_the_decoders_tell_formats_apart() -> None:
    """Distance 3: 0b10 in Gray code. In the format of the DME, the error bit changes the last bit that is sent."""
    assert dl100("DL100-GRY24E", 0b100) == Expected(3, "usable")
    assert dl100("DL100-GRY24E", 0b101) == Expected(3, "not_usable")
    assert dl100("DL100-G25DME", 0b101) == Expected(3, "usable")
    assert dl100("DL100-G25DME", 0b100) == Expected(3, "not_usable")
    assert dl100("DL100-BIN24", 3) == Expected(3, "unknown")
    assert bml_s1g("BML-S1G0-S26-2000", 1 << 24) == REJECTED
    assert bml_s1g("BML-S1G0-S26-2000", 1 << 25 | 5) == Expected(5, "not_usable")
