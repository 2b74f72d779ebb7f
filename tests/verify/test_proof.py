"""Proof by a bounded model checker, for all inputs and for every order code.

Every decoder and encoder has no undefined behaviour, and returns the same result and members as a plain reference
written from the layout. Exactly the values in range are encoded, decode(encode(x)) = x and encode(decode(f)) = f. Every
other function has no undefined behaviour, leaves its results unchanged on an error, and reports a failure of the
transport. The errors at the end show that the proofs can fail.

Parameters that registers set at run time are arbitrary, together with every order code. If these are too many for the
solver at once, as for the single cycle data of AM36, one width is fixed to its minimum, middle and maximum, or to each
value in turn with ``CODEWHEEL_PROVE_ALL=1``, which takes some minutes more.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from c_harness import INTERFACES, SHARED, SPECS, devices_of, interfaces_of, write
from codewheel.model import Device
from codewheel.targets.c.device import DeviceView
from proof import Checker, Header, Proof, ProofCount, Result, limited
from proof_calls import CallProof
from proof_codec import functions, proofs
from proof_digits import program
from proof_layout import Codec
from proof_shared import FUNCTIONS, crc_proofs, shared_proofs
from tools import tool
from tree import generated_tree, interfaces

ALL = bool(os.environ.get("CODEWHEEL_PROVE_ALL"))
#: Folder in which get-cbmc puts the checker.
OURS = str(Path(__file__).resolve().parents[2] / ".cbmc")
#: With more sets of parameters than this, the solver takes too long to prove them all at once.
AT_ONCE = 100


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("proved")) / "c" / "include"


@pytest.fixture(scope="module")
def checker() -> Checker:
    return Checker(tool("cbmc", (OURS,)), tool("cryptominisat5"))


def header_of(device: Device, include: Path) -> Header:
    headers = [include / header for header in DeviceView(device).headers]
    return Header.parse(*(path.read_text(encoding="utf-8") for path in (*runtime(include), *headers)))


def all_shared(include: Path) -> Header:
    """Return the declarations of the runtime headers that the families include."""
    return Header.parse(*(path.read_text(encoding="utf-8") for path in runtime(include)))


def runtime(include: Path) -> list[Path]:
    """The headers of the runtime that the families include."""
    return [include / "codewheel" / f"{name}.h" for name in SHARED]


def header_named(stem: str, include: Path) -> Path:
    """Return a header of an interface or of the runtime."""
    device = device_of(stem)
    return include / (device.manufacturer.name if device is not None else "codewheel") / f"{stem}.h"


def device_of(stem: str) -> Device | None:
    """Return the device with the interface of a header, or None for a header of the runtime."""
    return interfaces().get("_".join(stem.split("_")[:2]))


def codecs(device: Device, header: Header) -> Iterator[Codec]:
    """Return every frame, and every register that is more than one number in one byte."""
    view = DeviceView(device)
    new_codec = partial(Codec, device, header=header, prefix=view.prefix)
    for codec in view.interface.codecs:
        yield new_codec(view.context.interface.name, layout=codec.struct.layout, name=codec.name)
    for register in device.registers:
        plain = register.length == 1 and [field.width.render() for field in register.layout.fields] == ["8"]
        if not plain:
            name = f"{view.prefix}_reg_{register.name}"
            yield new_codec(register.interface, layout=register.layout, name=name, register=register)


def states(codec: Codec) -> Iterator[Mapping[str, int]]:
    """Yield the cases that are proved one by one, or an empty case if all parameters are proved at once.

    A case fixes the first width in a register, at its ends and middle or at each value, and all switches. The other
    widths stay arbitrary.
    """
    if codec.variants.count <= AT_ONCE:
        yield {}
        return
    first, (low, high) = next((name, limits) for name, limits in codec.variants.ranges.items() if limits[1] > 1)
    switches = [name for name, limits in codec.variants.ranges.items() if limits == (0, 1)]
    for value in range(low, high + 1) if ALL else (low, (low + high) // 2, high):
        for state in itertools.product((0, 1), repeat=len(switches)):
            yield {first: value, **dict(zip(switches, state, strict=True))}


Prove = Callable[..., None]


@pytest.fixture
def prove(checker: Checker, include: Path, tmp_path: Path, proof_counts: list[ProofCount]) -> Prove:
    """Return a function that proves them and records their number. It fails with the refuted claims."""

    def run(subject: str, proofs: Iterable[Proof], headers: Path = include) -> None:
        results = checker.prove_all([(proof, headers) for proof in proofs], tmp_path)
        failures = [result.words for result in results if not result.proved]
        covered = {result.proof.subject: result.proof.covers for result in results}
        proof_counts.append(ProofCount(subject, len(results), len(failures), sum(covered.values())))
        assert results, "\n\n".join(failures)
        assert not failures, "\n\n".join(failures)

    return run


@pytest.mark.parametrize("family", INTERFACES)
def test_codecs_are_equal_to_their_layout(family: str, include: Path, prove: Prove) -> None:
    family_codecs = codecs(interfaces()[family], header_of(interfaces()[family], include))
    cases = [replace(codec, fixed_values=values) for codec in family_codecs for values in states(codec)]
    prove(f"{family}, decoders and encoders", [proof for codec in cases for proof in proofs(codec)])


def test_long_codecs_are_equal_to_their_layout(prove: Prove, tmp_path: Path) -> None:
    """Frames of 72 and 79 bits, whose CRCs are not whole bytes. No family has frames of more than 64 bits."""
    devices = devices_of(SPECS / "long_crc.yaml")
    headers = write(tmp_path, devices)
    for stem, device in interfaces_of(devices).items():
        family_codecs = codecs(device, header_of(device, headers))
        prove(f"{stem}, decoders and encoders", [proof for codec in family_codecs for proof in proofs(codec)], headers)


def _with_crcs() -> list[str]:
    """Return the interfaces with a CRC function over bytes. The one for a frame of BiSS is proved with its encoder."""
    return [name for name, device in interfaces().items() if _calls_a_crc(device)]


def _calls_a_crc(device: Device) -> bool:
    return any(crc.is_called for crc in DeviceView(device).crcs)


@pytest.mark.parametrize("family", _with_crcs())
def test_crcs_are_those_of_the_definition(family: str, include: Path, prove: Prove) -> None:
    prove(f"{family}, CRCs", crc_proofs(interfaces()[family], header_of(interfaces()[family], include)))


def test_shared_functions_on_bits(prove: Prove) -> None:
    prove("bits and positions", shared_proofs())


def stems() -> list[str]:
    """Return every header of the interfaces, and their headers of the runtime."""
    family_headers = [Path(header).stem for device in interfaces().values() for header in DeviceView(device).headers]
    return ["bits", "encoder", "transport", *family_headers]


@pytest.mark.parametrize("stem", stems())
def test_other_functions_keep_what_the_headers_promise(stem: str, include: Path, prove: Prove) -> None:
    device = device_of(stem)
    path = header_named(stem, include)
    tested_header = Header.parse(path.read_text(encoding="utf-8"))
    header = header_of(device, include) if device is not None else all_shared(include)
    proved = {f"cw_{name}" for name in FUNCTIONS if stem == "bits"}
    if device is not None:
        proved = {name for codec in codecs(device, header) for name in functions(codec)}
    assert proved <= header.functions.keys()
    other_functions = [function for function in tested_header.functions.values() if function.name not in proved]
    if not other_functions:
        return
    proofs_of_calls = CallProof(header, str(path.relative_to(include)), other_functions, device).proofs()
    prove(f"{stem}.h, {len(other_functions)} other functions", proofs_of_calls)


def test_every_number_with_decimal_digits(include: Path, tmp_path: Path) -> None:
    count = 0
    for device in interfaces().values():
        for codec in codecs(device, header_of(device, include)):
            if not codec.has_digits:
                continue
            count += 1
            file = tmp_path / f"{codec.name}.c"
            file.write_text(program(codec), encoding="utf-8")
            subprocess.run(
                [os.environ.get("CC", "cc"), "-O2", "-I", str(include), str(file), "-o", str(tmp_path / codec.name)],
                check=True,
            )
            assert subprocess.run(limited([str(tmp_path / codec.name)])).returncode == 0, codec.name
    assert count


#: Errors that a wrong generator could make: header, function, text in it, its replacement, and the proof that must
#: fail.
SEEDED = {
    "mask": (
        "amm5_biss",
        "lika_amm5_biss_crc",
        r"& 0xFFFU",
        "& 0xFFEU",
        "amm5_biss decode_result",
    ),
    "polynomial bit": (
        "amm5_biss",
        "lika_amm5_biss_crc",
        r"(?s)<< 1U\)(?=;\s+return)",
        "<< 2U)",
        "amm5_biss encode_crc",
    ),
    "table entry": (
        "amm5_biss",
        "lika_amm5_biss_crc_biss_6_entries",
        r"0x30U",
        "0x31U",
        "amm5_biss decode_result with LIKA_CRC_TABLE",
    ),
    "shift": (
        "asc85_biss",
        "lika_asc85_biss_decode",
        r"8U \+ lika_asc85_biss_zero_bits",
        "7U + lika_asc85_biss_zero_bits",
        "asc85_biss everything",
    ),
    "byte order": (
        "asc85_biss_registers",
        "lika_asc85_biss_reg_serial_number_decode",
        r"bytes\[3\]",
        "bytes[2]",
        "asc85_biss_reg_serial_number everything",
    ),
    "byte order of an encoder": (
        "asc85_biss_registers",
        "lika_asc85_biss_reg_serial_number_encode",
        r"bytes\[0\]",
        "bytes[1]",
        "asc85_biss_reg_serial_number everything",
    ),
    "limit": (
        "am36_biss_registers",
        "lika_am36_biss_reg_information_per_revolution_encode",
        r"> \w+MAX\)",
        "> 0x200000U)",
        "am36_biss_reg_information_per_revolution everything",
    ),
    "level of a flag": (
        "asc85_biss_simulate",
        "lika_asc85_biss_encode",
        r"\? 0U : 1U",
        "? 1U : 0U",
        "asc85_biss everything",
    ),
    "choice left out": (
        "sma21_rs485_simulate",
        "lika_sma21_rs485_data_request_decode",
        r"return \w+RANGE",
        "return CW_OK",
        "sma21_rs485_data_request everything",
    ),
    "unused bits at another place": (
        "amm5_rs485",
        "lika_amm5_rs485_complete_reply_decode",
        r"<< 8U;(?=\s+out->unused)",
        "<< 7U;",
        "amm5_rs485_complete_reply everything",
    ),
    "flag left out of a verdict": (
        "amm5_rs485",
        "lika_amm5_rs485_complete_reply_verdict",
        r"(?s)if \(\(variant\.multiturn_bits != 0U\) && frame->mt_error\) \{.*?\}",
        "",
        "amm5_rs485_complete_reply everything",
    ),
    "byte that the XOR of words loses": (
        "amm5_rs485",
        "lika_amm5_rs485_crc_rs485_8",
        r"crc >> 16U",
        "crc >> 24U",
        "amm5_rs485_crc_rs485_8 of every input in words",
    ),
    "report of another flag": (
        "sma21_rs485",
        "lika_sma21_rs485_position_reply_reports",
        r"frame->overspeed",
        "frame->hardware_error",
        "sma21_rs485_position_reply everything",
    ),
    "undefined shift": ("bits", "cw_to_gray", r"low < 64U", "low <= 64U", "call cw_to_gray"),
    "result touched by a fault": (
        "amm5_rs485",
        "lika_amm5_rs485_singleturn_reply_decode",
        r"if \(length",
        "out->singleturn = 0U; if (length",
        "amm5_rs485_singleturn_reply everything",
    ),
    "place too few": (
        "sma21_biss_procedures",
        "lika_sma21_biss_identify",
        r"sizeof\(bytes\)",
        "sizeof(bytes) - 1U",
        "call lika_sma21_biss_identify",
    ),
    "failure not reported": ("transport", "cw_write", r"error != 0", "error > 0", "call cw_write_byte"),
}


def with_fault(header: Path, function: str, pattern: str, instead: str) -> None:
    """Put an error into a function or a table of a header."""
    text = header.read_text(encoding="utf-8")
    start = re.search(rf"^static [^;{{}}=]*\b{function}(\([^{{}}]*\)\n|\[256\] = )\{{", text, re.MULTILINE)
    assert start, f"{function} is gone: choose another place for this fault"
    end = text.index("\n}", start.end())
    body, count = re.subn(pattern, instead, text[start.end() : end], count=1)
    assert count, f"{pattern} is gone from {function}: choose another place for this fault"
    assert body != text[start.end() : end], f"{pattern} is gone from {function}: choose another place for this fault"
    header.write_text(text[: start.end()] + body + text[end:], encoding="utf-8")


def proof_called(name: str, stem: str, include: Path) -> Proof:
    """Return the proof with this name for the unchanged header."""
    device = device_of(stem)
    header = header_of(device, include) if device is not None else all_shared(include)
    if device is None or name.startswith("call "):
        functions = [header.functions[name.removeprefix("call ")]]
        path = header_named(stem, include).relative_to(include)
        return next(iter(CallProof(header, str(path), functions, device).proofs()))
    maker = device.manufacturer.name
    candidates = [*crc_proofs(device, header)]
    named = [codec for codec in codecs(device, header) if f"{codec.name} " in f"{maker}_{name}"]
    candidates += [proof for codec in named for proof in proofs(codec)]
    return next(proof for proof in candidates if proof.name == f"{maker}_{name}")


@pytest.fixture(scope="module")
def verdicts(checker: Checker, include: Path, tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Result]:
    """The proofs fail if there is an error in a header.

    The tests above show that the proofs hold for the unchanged header.
    """
    runs: list[tuple[Proof, Path]] = []
    for stem, function, pattern, instead, name in SEEDED.values():
        folder = tmp_path_factory.mktemp("seeded")
        shutil.copytree(include, folder, dirs_exist_ok=True)
        with_fault(header_named(stem, folder), function, pattern, instead)
        runs.append((proof_called(name, stem, include), folder))
    return dict(zip(SEEDED, checker.prove_all(runs, tmp_path_factory.mktemp("runs")), strict=True))


@pytest.mark.parametrize("fault", SEEDED)
def test_a_seeded_fault_is_refuted(fault: str, verdicts: Mapping[str, Result]) -> None:
    """The proof that holds for the unchanged header fails for a header with this error."""
    assert not verdicts[fault].proved, verdicts[fault].words
    assert "REFUTED" in verdicts[fault].words, verdicts[fault].words
