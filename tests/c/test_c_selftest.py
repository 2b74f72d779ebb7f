"""The self-test that users compile passes unchanged, and fails if a CRC, a shift or anything else in it is changed."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from c_harness import FAMILIES, INTERFACES, WARNINGS
from codewheel.model import CrcExample, Device
from codewheel.plan.crcs import CONTROL_FIELDS, public_vectors_of
from exhaustive import mostly_exhaustive

ROOT = Path(__file__).resolve().parents[2]
#: The manuals show no example of these registers.
TESTED = tuple(interface for interface in INTERFACES if interface not in ("am36_ssi", "amm5_ssi", "asc85_ssi"))


def compiled(include: Path, folder: Path, *options: str) -> ctypes.CDLL:
    """Return the self-test of the package as a library."""
    library = folder / f"selftest{len(options)}.so"
    tests = sorted(str(path) for path in (include.parent / "selftest").glob("*.c"))
    command = ["gcc", "-std=c99", "-O1", "-shared", "-fPIC", *WARNINGS, f"-I{include}", *options, *tests]
    completed = subprocess.run([*command, "-o", str(library)], capture_output=True, text=True)
    assert completed.returncode == 0, completed.stderr[:4000]
    return ctypes.CDLL(str(library))


OPTIONS: list[tuple[str, ...]] = [(), ("-DLIKA_CRC_TABLE",), ("-DLIKA_CRC_BITWISE", "-O3")]


@pytest.mark.slow
@pytest.mark.parametrize("options", mostly_exhaustive(OPTIONS, OPTIONS[0]), ids=" ".join)
def test_all_is_well(options: tuple[str, ...], include: Path, tmp_path: Path) -> None:
    tests = compiled(include, tmp_path, *options)
    assert tests.lika_selftest() == tests.ichaus_selftest() == 0
    names = {interface: f"{FAMILIES[interface.partition('_')[0]]}_{interface}_selftest" for interface in TESTED}
    assert {interface: getattr(tests, name)() for interface, name in names.items()} == dict.fromkeys(TESTED, 0)
    assert tests.cw_selftest() == 0


def test_every_example_has_a_check(include: Path, every_device: Mapping[str, Device]) -> None:
    """Registers of one byte that are a number are excluded, because nothing decodes them."""
    for name in FAMILIES:
        paths = (include.parent / "selftest").glob(f"{name}_*.c")
        text = "".join(path.read_text(encoding="ascii") for path in paths)
        comments = " ".join(re.findall(r"^/\*\s+(?:\* )?(\d+: .*?)\*/", text, re.MULTILINE | re.DOTALL))
        for example in every_device[name].examples:
            register = getattr(example, "register", "")
            plain = register and every_device[name].register(register).length == 1
            # The runtime computes the first CRC, and the second is the CRC of an EEPROM.
            by_runtime = isinstance(example, CrcExample) and example.crc in ("biss_4", "configuration_16")
            assert plain or by_runtime or f": {example.name.replace('_', ' ')}" in comments, example.name
        assert "stdio" not in text


#: Header, the change in it, and the families of which at least one self-test must fail.
FAULTS = {
    "polynomial of a CRC of bits": ("amm5_biss.h",
        r"(lika_amm5_biss_crc\(uint64_t word\).*#else.*?)<< 1U\)", r"\1<< 2U)"),
    "inversion of a CRC": ("asc85_biss.h",
        r"(lika_asc85_biss_crc\(uint64_t word\).*#else.*?)\^ 0x3FU;", r"\g<1>^ 0x3EU;"),
    "CRC of bytes": ("sma21_rs485.h", r"(lika_sma21_rs485_crc_rs485_8\(.*?#else.*?)\^", r"\1+"),
    "shift of a frame": ("amm5_rs485.h", r"(lika_amm5_rs485_singleturn_reply_decode\(.*?)<< 8U", r"\1<< 7U"),
    "shift of a register": ("am36_biss_registers.h", r"(lika_am36_biss_reg_preset_decode\(.*?)<< 8U", r"\1<< 9U"),
    "level of a flag": ("sma21_biss.h",
        r"(static inline cw_result lika_sma21_biss_decode\(.*?)(==|!=) 0U\);", r"\1 > 1U);"),
    "order of a procedure": ("amm5_biss_procedures.h",
        r"(lika_amm5_biss_set_preset_steps\(.*?)cw_step_write\(\w+_ENABLE_ADDRESS, 0xFFU, 0x01U\)",
        r"\1cw_step_write(0x41U, 0xFFU, 0x01U)"),
    "words of BiSS": ("biss.h",
        r"(static inline cw_result cw_biss_request_encode\(.*?)<< CW_BISS_WORD_RW_SHIFT", r"\1<< 14U"),
    "a count that goes on": ("tracker.h", r"forward \+= modulus;", "forward += 1U;"),
    "an angle": ("angle.h", r"bit \+= 16U;", "bit += 15U;"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", mostly_exhaustive(FAULTS, *[*FAULTS][:2]))
def test_a_header_that_was_changed_is_told(fault: str, include: Path, tmp_path: Path) -> None:
    header, sound, planted = FAULTS[fault]
    shutil.copytree(include.parent, tmp_path / "c")
    stem = "_".join(header.removesuffix(".h").split("_")[:2])
    path = tmp_path / "c" / "include" / ("lika" if stem in TESTED else "codewheel") / header
    text, count = re.subn(sound, planted, path.read_text(encoding="ascii"), count=1, flags=re.DOTALL)
    assert count == 1
    path.write_text(text, encoding="ascii")
    result = compiled(tmp_path / "c" / "include", tmp_path).lika_selftest()
    lika = [interface for interface in TESTED if FAMILIES[interface.partition("_")[0]] == "lika"]
    place = 1 + (lika.index(stem) if stem in lika else len(lika))
    assert result // 1000 == place
    assert result % 1000 > 0


def test_public_vectors_are_those_of_their_sources(
    vectors: list[dict[str, Any]], every_device: Mapping[str, Device]
) -> None:
    crcs, fields = {6: {}, 4: {}}, {}
    for row in vectors:
        row_fields = row["fields"]
        if "position_bits" in row_fields:
            crcs[6][row_fields["position"] << 2 | row_fields["nE"] << 1 | row_fields["nW"]] = row_fields[
                "CRC6_inverted"
            ]
        if "CRC6_raw" in row_fields:
            crcs[6][row_fields["data"]] = row_fields["CRC6_inverted"]
        if "DATA" in row_fields:
            crcs[4][row_fields["DATA"]] = row_fields.get("DATA_CRC4", row_fields.get("CRC4_inverted"))
        if set(row_fields) == {"data_id", "CF"}:
            fields[row_fields["data_id"]] = row_fields["CF"]
    assert fields == CONTROL_FIELDS
    for crc in every_device["amm5"].crcs:
        if crc.name.startswith("biss"):
            assert {vector.data: vector.crc for vector in public_vectors_of(crc)} == crcs[crc.width]
        else:
            assert public_vectors_of(crc) == ()
