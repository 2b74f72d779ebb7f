"""Candidates to compare: our decoders, hand-written decoders, and other generators' decoders, for the same frames."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Crc
from codewheel.reference.bits_and_values import compute_bits
from codewheel.targets import Library
from codewheel.targets.c.files import generate

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent
BISS_6 = Crc(name="biss_6", width=6, poly=0x03, init=0, refin=False, refout=False, xorout=0x3F, source=())


@dataclass(frozen=True)
class Frame:
    """A frame to compare.

    ``fields`` are the fields of its sample. ``good`` tests that the sample was decoded correctly.
    """

    name: str
    title: str
    header: str
    variant_type: str
    variant: str
    decoder: str
    struct: str
    good: str

    @property
    def is_word(self) -> bool:
        return self.name != "rs485"

    @property
    def maker(self) -> str:
        return self.header.partition("/")[0].upper()


_POSITION = "(out.multiturn == 0xABCU) && (out.singleturn == 0x234567U)"
_BISS_GOOD = f"{_POSITION} && !out.error && !out.warning"
FRAMES = (
    Frame(
        "biss46",
        "BiSS, 46 bits",
        "bench/biss46_biss.h",
        "bench_biss46_biss",
        "BENCH_BISS46_BISS_B38SC",
        "bench_biss46_biss_decode",
        "bench_biss46_biss_frame",
        _BISS_GOOD,
    ),
    Frame(
        "biss47",
        "BiSS, 47 bits (AMM5)",
        "lika/amm5_biss.h",
        "lika_amm5_biss",
        "LIKA_AMM5_BISS_A23_65KSC1",
        "lika_amm5_biss_decode",
        "lika_amm5_biss_frame",
        _BISS_GOOD,
    ),
    Frame(
        "rs485",
        "RS-485, 11 bytes (AMM5)",
        "lika/amm5_rs485.h",
        "lika_amm5_rs485",
        "LIKA_AMM5_RS485_A23_65KJP1",
        "lika_amm5_rs485_complete_reply_decode",
        "lika_amm5_rs485_complete_reply",
        f"{_POSITION} && out.battery_alarm && out.status_st_error && !out.busy",
    ),
)

#: Width in bits of the singleturn position in frames that are words.
SINGLETURN = {"biss46": 26, "biss47": 23}


def word(frame: Frame, multiturn: int = 0xABC, singleturn: int = 0x234567) -> int:
    """Return a valid word without active flags."""
    data = (multiturn << SINGLETURN[frame.name] | singleturn) << 2 | 3
    return data << 6 | compute_bits(BISS_6, data, 64 - 6)


def reply(multiturn: int = 0xABC, singleturn: int = 0x234567) -> bytes:
    """Return a valid reply with two flags set."""
    data = (
        bytes((0x1A, 0x10))
        + singleturn.to_bytes(3, "little")
        + bytes((0x23,))
        + multiturn.to_bytes(3, "little")
        + bytes((0x80,))
    )
    crc = 0
    for byte in data:
        crc ^= byte
    return data + bytes((crc,))


def sample(frame: Frame) -> bytes:
    """Return the sample frame as bytes, for peers that do not read words."""
    return word(frame).to_bytes(6, "big") if frame.is_word else reply()


@dataclass(frozen=True)
class Candidate:
    """A candidate. ``source`` is C code with ``function``.

    ``call`` decodes the frame ``bytes`` or ``word`` with the variables in ``globals``, and its value is ``result``.
    """

    name: str
    function: str
    source: str
    globals: str
    call: str
    good: str
    result: int = 0
    does: str = "all checks"


def candidates(frame: Frame, peers: Path) -> Iterator[Candidate]:
    """Yield all candidates for one frame, ours first. ``peers`` is the folder of :func:`write_peers`."""
    yield from ours(frame)
    yield from by_hand(frame)
    yield by_cantools(frame, peers)
    yield by_nunavut(frame)
    yield by_pycrc(frame, peers)


def by_hand(frame: Frame) -> Iterator[Candidate]:
    """Yield the hand-written decoder, and a decoder that only extracts the fields."""
    name = frame.name
    arguments = "word" if frame.is_word else "bytes, sizeof bytes"
    yield Candidate(
        "hand-written",
        f"hand_{name}",
        _c(f"hand_{name}.c"),
        f'#include "{HERE}/c/hand.h"\nstatic {_hand(frame)} out;',
        f"hand_{name}({arguments}, &out)",
        frame.good,
    )
    yield Candidate(
        "extraction only",
        f"floor_{name}",
        _c("floor.c"),
        f"""#include "{HERE}/c/hand.h"
int floor_{name}({_arguments(frame)}, {_hand(frame)} *out);
static {_hand(frame)} out;""",
        f"floor_{name}({arguments}, &out)",
        frame.good,
        does="no check",
    )


def by_cantools(frame: Frame, peers: Path) -> Candidate:
    name = frame.name
    return Candidate(
        "cantools",
        f"peer_{name}_unpack",
        f'#include "{peers}/peer.c"\n',
        f'#include "{peers}/peer.h"\nstatic struct peer_{name}_t out;',
        f"peer_{name}_unpack(&out, bytes, sizeof bytes)",
        _POSITION,
        does="no CRC, no constants, no position as one number",
    )


def by_nunavut(frame: Frame) -> Candidate:
    kind = f"peer_{frame.name.capitalize()}_1_0"
    declared = f"""#include "peer/{frame.name.capitalize()}_1_0.h"
int decode_nunavut({kind} *out, const uint8_t *bytes, size_t size);
"""
    return Candidate(
        "nunavut",
        "decode_nunavut",
        f"""{declared}int decode_nunavut({kind} *out, const uint8_t *bytes, size_t size)
{{
    return {kind}_deserialize_(out, bytes, &size);
}}
""",
        f"{declared}static {kind} out;",
        "decode_nunavut(&out, bytes, sizeof bytes)",
        "true",
        does="its own order of bits, no CRC, no constants, no position as one number",
    )


def by_pycrc(frame: Frame, peers: Path) -> Candidate:
    data = f"pycrc_{frame.name}"
    return Candidate(
        "pycrc",
        "crc_of",
        f"""#include "{peers}/{data}.c"
crc_t crc_of(const uint8_t *bytes, size_t length);
crc_t crc_of(const uint8_t *bytes, size_t length)
{{
    return crc_finalize(crc_update(crc_init(), bytes, length));
}}
""",
        f"""#include "{peers}/{data}.h"
crc_t crc_of(const uint8_t *bytes, size_t length);
static const uint8_t covered[] = {{ {_list(covered(frame))} }};""",
        "crc_of(covered, sizeof covered)",
        "true",
        received(frame),
        "the CRC alone, over whole bytes",
    )


def _function(signature: str, result: str) -> str:
    """Return a C function that returns an expression."""
    return f"{signature}\n{{\n    return {result};\n}}\n"


def ours(frame: Frame) -> Iterator[Candidate]:
    """Yield our decoders: with the order code fixed at compile time, chosen at run time, and with a CRC table."""
    parameters, received_frame = "const uint8_t *bytes, size_t length", "bytes, length"
    passed = "bytes, sizeof bytes"
    if frame.is_word:
        # The length comes from the caller, so that the decoder must compare it.
        parameters, received_frame = "uint64_t word, uint32_t length", "cw_word_of(word, length)"
        passed = f"word, {frame.name.removeprefix('biss')}U"
    forms = {"ours, order code fixed": ""}
    if frame.is_word:
        forms["ours, fixed, table"] = f"#ifndef {frame.maker}_CRC_TABLE\n#define {frame.maker}_CRC_TABLE\n#endif\n"
    for name, macro in forms.items():
        head = f'{macro}#include "{frame.header}"\ncw_result decode_ours({parameters}, {frame.struct} *out);\n'
        body = _function(
            f"cw_result decode_ours({parameters}, {frame.struct} *out)",
            f"{frame.decoder}({frame.variant}, {received_frame}, out)",
        )
        yield Candidate(
            name,
            "decode_ours",
            head + body,
            f"{head}static {frame.struct} out;",
            f"decode_ours({passed}, &out)",
            frame.good,
        )
    signature = f"cw_result decode_ours({parameters}, const {frame.variant_type} *variant, {frame.struct} *out)"
    head = f'#include "{frame.header}"\n{signature};\n'
    body = _function(signature, f"{frame.decoder}(*variant, {received_frame}, out)")
    yield Candidate(
        "ours, at run time",
        "decode_ours",
        head + body,
        f"{head}static {frame.struct} out;\nstatic const {frame.variant_type} *const encoder = &{frame.variant};",
        f"decode_ours({passed}, encoder, &out)",
        frame.good,
    )


def covered(frame: Frame) -> bytes:
    """Return the bytes that the CRC covers, with leading zeros up to whole bytes."""
    if not frame.is_word:
        return reply()[:-1]
    data = word(frame) >> 6
    return data.to_bytes((data.bit_length() + 7) // 8, "big")


def received(frame: Frame) -> int:
    return word(frame) & 0x3F if frame.is_word else reply()[-1]


def entry(frame: Frame, candidate: Candidate) -> str:
    """Return C code with the call, an empty call, and a flag that is set if the first result was correct."""
    value = f"static const uint64_t word = UINT64_C({word(frame):#x});\n" if frame.is_word else ""
    nothing = candidate.call.replace(candidate.function, "nothing", 1)
    return f"""#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
{candidate.globals}
{value}static const uint8_t bytes[] = {{ {_list(sample(frame))} }};
extern __typeof__({candidate.function}) nothing;
static volatile int result;
volatile int good;
void entry(void);
void entry_of_nothing(void);
void check(void);
void entry(void)
{{
    result = {candidate.call};
}}
void entry_of_nothing(void)
{{
    result = {nothing};
}}
void check(void)
{{
    (void)bytes;
    good = ((result == {candidate.result}) && {candidate.good}) ? 1 : 0;
}}
"""


def write_headers(folder: Path) -> Path:
    """Write our headers for the frames, and return the include folder."""
    specs = REPOSITORY / "specs"
    spi = (specs / "ams" / "as5048a.yaml", specs / "magntek" / "mt6835.yaml")
    devices, report = load_library([HERE / "specs", specs / "lika", *spi])
    if report:
        sys.exit("the specs have problems. Run codewheel check")
    for path, text in generate(Library(devices)).items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    return folder / "c" / "include"


def write_peers(folder: Path) -> Path:
    """Write the code of cantools, nunavut and pycrc for the frames. This needs the packages of the extra ``bench``."""
    for package in ("cantools", "nunavut", "pycrc"):
        if importlib.util.find_spec(package) is None:
            raise RuntimeError(f"no {package} here. make bench installs it")
    folder.mkdir(parents=True, exist_ok=True)
    cantools_options = ("--no-floating-point-numbers", "--database-name", "peer", "-o", str(folder))
    _run("cantools", "generate_c_source", *cantools_options, str(HERE / "peers" / "frames.dbc"))
    nunavut_options = ("--target-language", "c", "--omit-float-serialization-support", "-O", str(folder))
    _run("nunavut", *nunavut_options, str(HERE / "peers" / "peer"))
    for frame in FRAMES:
        _write_pycrc(frame, folder)
    return folder


def _write_pycrc(frame: Frame, folder: Path) -> None:
    model = ("--width=6", "--poly=3", "--xor-out=0x3f") if frame.is_word else ("--width=8", "--poly=1", "--xor-out=0")
    reflect = str(not frame.is_word)
    options = ("--xor-in=0", f"--reflect-in={reflect}", f"--reflect-out={reflect}", "--algorithm=table-driven")
    for kind in ("h", "c"):
        target = folder / f"pycrc_{frame.name}.{kind}"
        _run("pycrc", *model, *options, f"--generate={kind}", "-o", str(target))


def _run(module: str, *arguments: str) -> None:
    completed = subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True, text=True, timeout=120)
    if completed.returncode:
        raise RuntimeError(f"{module}: {completed.stderr[-1000:]}")


def _c(name: str) -> str:
    return f'#include "{HERE}/c/{name}"\n'


def _hand(frame: Frame) -> str:
    return "hand_biss" if frame.is_word else "hand_reply"


def _arguments(frame: Frame) -> str:
    return "uint64_t word" if frame.is_word else "const uint8_t *bytes, size_t length"


def _list(data: bytes) -> str:
    return ", ".join(f"0x{byte:02X}" for byte in data)
