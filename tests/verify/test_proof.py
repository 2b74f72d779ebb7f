"""Proof by a bounded model checker, for all inputs and for every order code.

For every decoder and encoder: no undefined behaviour; the same result and the same members as a plain reference written from the layout;
exactly the values in range are encoded; decode(encode(x)) = x and encode(decode(f)) = f. For every other function: no undefined behaviour, a fault
leaves the results as they were, and a failure of the transport is reported.

``CODEWHEEL_PROVE_ALL=1`` adds what takes longer: every width that registers can set at run time.
"""

from __future__ import annotations

import itertools
import os
import re
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from c_harness import FAMILIES
from codewheel.model import Device
from proof import Checker, Header, Proof
from proof_calls import CallProof
from proof_codec import CodecProof
from proof_digits import program
from proof_shared import FUNCTIONS, crc_proofs, shared_proofs
from tools import tool
from tree import generated_tree, library

ALL = bool(os.environ.get("CODEWHEEL_PROVE_ALL"))
#: Where get-cbmc puts the checker.
OURS = str(Path(__file__).resolve().parents[2] / ".cbmc")
#: With more sets of parameters than this the solver takes too long to prove them all at once.
AT_ONCE = 100


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("proved")) / "c" / "include"


@pytest.fixture(scope="module")
def checker() -> Checker:
    return Checker(tool("cbmc", (OURS,)), tool("cryptominisat5"))


def header_of(device: Device, include: Path) -> Header:
    folder = include / device.manufacturer.name
    return Header.read(*((folder / name).read_text(encoding="utf-8") for name in ("encoder.h", f"{device.name}.h")))


def codecs(device: Device, header: Header) -> Iterator[CodecProof]:
    """Every frame, and every register that is more than one number in one byte."""
    prefix = f"{device.manufacturer.name}_{device.name}"
    for interface, layout in device.layouts():
        yield CodecProof(device, interface.kind, layout, header, prefix, f"{prefix}_{layout.name}")
    for register in device.registers:
        plain = register.length == 1 and [item.width.render() for item in register.layout.fields] == ["8"]
        if not plain:
            yield CodecProof(device, register.interface, register.layout, header, prefix, f"{prefix}_reg_{register.name}", register)


def states(codec: CodecProof) -> Iterator[Mapping[str, int]]:
    """What is proved one by one: nothing where all parameters go at once; else the first width that a register holds, at either end and between or
    everywhere, and what is on or off. The other widths stay anything."""
    if codec.variants.count <= AT_ONCE:
        yield {}
        return
    first, (low, high) = next((name, both) for name, both in codec.variants.ranges.items() if both[1] > 1)
    switches = [name for name, both in codec.variants.ranges.items() if both == (0, 1)]
    for value in range(low, high + 1) if ALL else (low, (low + high) // 2, high):
        for state in itertools.product((0, 1), repeat=len(switches)):
            yield {first: value, **dict(zip(switches, state))}


def told(checker: Checker, proofs: Iterable[Proof], include: Path, folder: Path, capsys: pytest.CaptureFixture[str], what: str) -> None:
    """Proves them, and says how many there were; fails with what was refuted."""
    results = checker.prove_all(list(proofs), include, folder)
    bad = [item for item in results if not item.proved]
    covered = sum(item.proof.covers for item in results)
    with capsys.disabled():
        print(f"\n{what}: {len(results)} proofs over {covered} sets of parameters, {len(bad)} failed", flush=True)
    assert results and not bad, "\n\n".join(item.words for item in bad)


@pytest.mark.parametrize("family", FAMILIES)
def test_codecs_are_equal_to_their_layout(family: str, checker: Checker, include: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    device = library()[family]
    proofs = [proof for codec in codecs(device, header_of(device, include)) for held in states(codec) for proof in replace(codec, held=held).proofs()]
    told(checker, proofs, include, tmp_path, capsys, f"{family}, decoders and encoders")


@pytest.mark.parametrize("family", FAMILIES)
def test_crcs_are_those_of_the_definition(family: str, checker: Checker, include: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    device = library()[family]
    told(checker, crc_proofs(device, header_of(device, include)), include, tmp_path, capsys, f"{family}, CRCs")


def test_shared_functions_on_bits(checker: Checker, include: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maker = library()[FAMILIES[0]].manufacturer.name
    told(checker, shared_proofs(maker), include, tmp_path, capsys, "bits and positions")


@pytest.mark.parametrize("family", ("", *FAMILIES))
def test_no_function_does_anything_undefined(family: str, checker: Checker, include: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    maker = library()[FAMILIES[0]].manufacturer.name
    stem = family or "encoder"
    shared = (include / maker / "encoder.h").read_text(encoding="utf-8")
    own = Header.read((include / maker / f"{stem}.h").read_text(encoding="utf-8"))
    header = Header.read(shared, (include / maker / f"{stem}.h").read_text(encoding="utf-8")) if family else own
    proved = {f"{maker}_{item}" for item in FUNCTIONS}
    if family:
        proved = {name for codec in codecs(library()[family], header) for name in codec.functions}
    assert proved <= own.functions.keys()
    functions = [item for item in own.functions.values() if item.name not in proved]
    calls = CallProof(maker, header, f"{maker}/{stem}.h", functions, library().get(family))
    told(checker, calls.proofs(), include, tmp_path, capsys, f"{stem}.h, {len(functions)} other functions")


def test_every_number_with_decimal_digits(include: Path, tmp_path: Path) -> None:
    found = 0
    for device in library().values():
        for codec in codecs(device, header_of(device, include)):
            if not codec.has_digits:
                continue
            found += 1
            file = tmp_path / f"{codec.name}.c"
            file.write_text(program(codec), encoding="utf-8")
            subprocess.run([os.environ.get("CC", "cc"), "-O2", "-I", str(include), str(file), "-o", str(tmp_path / codec.name)], check=True)
            assert subprocess.run([str(tmp_path / codec.name)], timeout=900).returncode == 0, codec.name
    assert found


#: Faults as a slip of the generator would make them: header, function, what is found in it, what takes its place, and the proof that has to see it.
SEEDED = {
    "mask": ("amm5", "lika_amm5_single_cycle_data_crc", r"& 0xFFFU", "& 0xFFEU", "amm5_single_cycle_data decode_result"),
    "polynomial bit": ("amm5", "lika_amm5_single_cycle_data_crc", r"(?s)<< 1U\)(?=;\s+return)", "<< 2U)", "amm5_single_cycle_data encode_crc"),
    "shift": ("asc85", "lika_asc85_single_cycle_data_decode", r"word >> 9U", "word >> 8U", "asc85_single_cycle_data everything"),
    "byte order": ("asc85", "lika_asc85_reg_serial_number_decode", r"bytes\[3\]", "bytes[2]", "asc85_reg_serial_number everything"),
    "byte order of an encoder": ("asc85", "lika_asc85_reg_serial_number_encode", r"bytes\[0\]", "bytes[1]", "asc85_reg_serial_number everything"),
    "limit": ("am36", "lika_am36_reg_information_per_revolution_encode", r"> \w+MAX\)", "> 0x200000U)", "am36_reg_information_per_revolution everything"),
    "level of a flag": ("asc85", "lika_asc85_single_cycle_data_encode", r"\? 0U : 1U", "? 1U : 0U", "asc85_single_cycle_data everything"),
    "choice left out": ("sma21", "lika_sma21_data_request_decode", r"return \w+RANGE", "return LIKA_OK", "sma21_data_request everything"),
    "undefined shift": ("encoder", "lika_to_gray", r"low < 64U", "low <= 64U", "call lika_to_gray"),
    "failure not reported": ("encoder", "lika_write", r"error != 0", "error > 0", "call lika_write_byte"),
}


@pytest.mark.parametrize("fault", SEEDED)
def test_a_seeded_fault_is_refuted(fault: str, checker: Checker, include: Path, tmp_path: Path) -> None:
    """The proof that holds for the header as it is, does not for one with this fault in it."""
    stem, function, pattern, instead, name = SEEDED[fault]
    maker = library()[FAMILIES[0]].manufacturer.name
    broken = tmp_path / "include" / maker
    broken.mkdir(parents=True)
    for file in (include / maker).glob("*.h"):
        broken.joinpath(file.name).write_bytes(file.read_bytes())
    text = (broken / f"{stem}.h").read_text(encoding="utf-8")
    start = re.search(rf"^static inline [^;{{}}]*\b{function}\([^{{}}]*\)\n\{{", text, re.MULTILINE)
    assert start, f"{function} is gone: choose another place for this fault"
    end = text.index("\n}\n", start.end())
    body, count = re.subn(pattern, instead, text[start.end() : end], count=1)
    assert count and body != text[start.end() : end], f"{pattern} is gone from {function}: choose another place for this fault"
    (broken / f"{stem}.h").write_text(text[: start.end()] + body + text[end:], encoding="utf-8")
    if name.startswith("call "):
        header = Header.read(text)
        calls = CallProof(maker, header, f"{maker}/{stem}.h", [header.functions[name.removeprefix("call ")]])
        proof = next(iter(calls.proofs()))
    else:
        device = library()[stem]
        proof = next(item for codec in codecs(device, header_of(device, include)) if not codec.variants.count > AT_ONCE for item in codec.proofs() if item.name == f"{maker}_{name}")
    assert checker.prove(proof, include, tmp_path).proved, "the header as it is"
    refuted = checker.prove(proof, broken.parent, tmp_path)
    assert not refuted.proved and "REFUTED" in refuted.words, refuted.words
