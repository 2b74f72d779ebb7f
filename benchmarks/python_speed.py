"""Measure the speed of the generated Python package: one frame, a million frames, and import.

    make bench-python

Everything is measured in one run, in CPU time. The candidates take turns and the best of many rounds counts, so the
ratios are reliable. Peers that are not installed are listed and skipped. No peer checks a CRC. Candidates that check
one have it in their name.
"""

from __future__ import annotations

import ctypes
import importlib
import os
import random
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "generated" / "python"
PATHS = [str(PACKAGE), str(PACKAGE / "runtime")]
ROUNDS, CALLS, MANY = 15, 4_000, 1_000_000
Candidates = dict[str, Callable[[], object]]

BISS, WORD = "AMM5A21/65KSC1", 0x55BCD15E2
SERIAL, REPLY = "AMM5A23/65KJP1", bytes.fromhex("02 00 C7 D1 6A 7E")


def main() -> None:
    sys.path[:0] = PATHS
    print(f"Python {sys.version.split()[0]}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}\n")
    compare("one BiSS frame of 45 bits, ns", {**biss_by_hand(), **peers_of_biss()}, CALLS, 1)
    compare("500 different BiSS frames in a loop, as in the README, ns each", position_loops(), CALLS // 500, 500)
    compare("one RS-485 reply of 6 bytes, ns", {**serial_by_hand(), **peers_of_serial()}, CALLS, 1)
    compare("a million frames, ns each", decoders_of_many(), 1, MANY)
    compare("lookup, ns", lookups(), CALLS, 1)
    print_import_times()


def compare(title: str, candidates: Candidates, calls: int, frames_per_call: int) -> None:
    """Print the time of each candidate, compared with the first."""
    best = dict.fromkeys(candidates, float("inf"))
    for _ in range(ROUNDS):
        for name, call in candidates.items():
            start = time.process_time_ns()
            for _ in range(calls):
                call()
            best[name] = min(best[name], (time.process_time_ns() - start) / calls / frames_per_call)
    first = next(iter(best.values()))
    print(title)
    for name, took in best.items():
        print(f"  {name:52} {took:10.2f} {took / first:7.2f} x")
    print()


# -- one frame


def biss_by_hand() -> Candidates:
    from lika_encoders import amm5

    encoder = amm5.lookup(BISS)
    frame = encoder.decode(WORD)

    def floor(word: int = WORD) -> object:
        return word >> 29, word >> 8 & 0x1FFFFF, word >> 8, word >> 7 & 1, word >> 6 & 1

    tables = map(crc_table, range(0, 48, 8))
    low, second, third, fourth, fifth, high = tables

    def with_crc(word: int = WORD) -> object:
        turned = word ^ 0x3F
        if (
            low[turned & 0xFF]
            ^ second[turned >> 8 & 0xFF]
            ^ third[turned >> 16 & 0xFF]
            ^ fourth[turned >> 24 & 0xFF]
            ^ fifth[turned >> 32 & 0xFF]
            ^ high[turned >> 40]
        ):
            raise ValueError
        return word >> 29, word >> 8 & 0x1FFFFF, word >> 8, word >> 7 & 1, word >> 6 & 1

    return {
        "floor: shifts into a tuple, no CRC": lambda: floor(WORD),
        "by hand: with CRC by six tables": lambda: with_crc(WORD),
        "ours: encoder.decode, CRC, typed": lambda: encoder.decode(WORD),
        "ours: SingleCycleData.decode, CRC, typed": lambda: amm5.SingleCycleData.decode(WORD, encoder),
        "ours: frame.verdict": lambda: frame.verdict,
        "ours: frame.encode": frame.encode,
    }


def position_loops() -> Candidates:
    """Return loops that read positions: by shifts without a call, and as the README of the package does."""
    from lika_encoders import FrameError, amm5

    source = random.Random(1)
    encoder = amm5.lookup(BISS)
    words = [amm5.SingleCycleData.from_position(encoder, source.getrandbits(37)).encode() for _ in range(500)]

    def floor() -> None:
        for word in words:
            _ = (word >> 29, word >> 8 & 0x1FFFFF, word >> 8, word >> 7 & 1, word >> 6 & 1)

    def as_in_the_readme() -> None:
        for word in words:
            reply = encoder.try_decode(word)
            if reply.usable_position is None:
                raise reply if isinstance(reply, FrameError) else ValueError(reply)

    return {"floor: shifts into a tuple, inline, no CRC": floor, "ours: try_decode, usable_position": as_in_the_readme}


def crc_table(shift: int) -> bytes:
    """Return the remainders of all bytes at this place in a word."""
    return bytes(remainder(byte << shift) for byte in range(256))


def remainder(number: int) -> int:
    """Return a number modulo x^6 + x + 1."""
    for place in range(47, 5, -1):
        number ^= 0x43 << place - 6 if number >> place & 1 else 0
    return number


def peers_of_biss() -> Candidates:
    peers: Candidates = {}
    data = WORD.to_bytes(6, "big")
    for name in ("bitstruct.c", "bitstruct"):
        module = peer(name)
        if module is not None:
            unpack = module.compile("u3u16u21u1u1u6").unpack
            peers[f"{name}, no CRC"] = lambda unpack=unpack: unpack(data)

    class Fields(ctypes.BigEndianStructure):
        _fields_ = [(name, ctypes.c_uint64, bits) for name, bits in FIELDS]

    wide = WORD.to_bytes(8, "big")

    def by_ctypes() -> object:
        fields = Fields.from_buffer_copy(wide)
        return fields.multiturn, fields.singleturn, fields.error, fields.warning

    peers["ctypes structure, no CRC"] = by_ctypes
    construct = peer("construct")
    if construct is not None:
        shape = construct.BitStruct(*(name / construct.BitsInteger(bits) for name, bits in FIELDS))
        peers["construct, no CRC"] = lambda: shape.parse(wide)
    kaitai = peer("kaitaistruct")
    if kaitai is not None:
        peers["kaitai runtime, no CRC"] = lambda: kaitai_bits(kaitai, wide)
    message = cantools_message([("multiturn", 19, 16), ("singleturn", 35, 21), ("error", 56, 1), ("warning", 57, 1)])
    if message is not None:
        peers["cantools, no CRC"] = lambda: message.decode(wide)
    return peers


FIELDS = [("spare", 19), ("multiturn", 16), ("singleturn", 21), ("error", 1), ("warning", 1), ("crc", 6)]


def kaitai_bits(kaitai: Any, data: bytes) -> object:
    """Decode with the code that the Kaitai compiler would write for such a record."""
    from io import BytesIO

    stream = kaitai.KaitaiStream(BytesIO(data))
    return [stream.read_bits_int_be(bits) for _, bits in FIELDS]


def cantools_message(fields: list[tuple[str, int, int]]) -> Any:
    """Return an eight-byte message with these signals, each with name, first bit and width."""
    if peer("cantools") is None:
        return None
    lines = [f' SG_ {name} : {8 * (at // 8) + 7 - at % 8}|{bits}@0+ (1,0) [0|0] "" E' for name, at, bits in fields]
    text = 'VERSION ""\nNS_ :\nBS_:\nBU_: E\nBO_ 1 M: 8 E\n' + "\n".join(lines) + "\n"
    return importlib.import_module("cantools").database.load_string(text, "dbc").get_message_by_name("M")


def serial_by_hand() -> Candidates:
    from lika_encoders import amm5

    encoder = amm5.lookup(SERIAL)

    def floor(data: bytes = REPLY) -> object:
        number = int.from_bytes(data, "little")
        return number >> 3 & 0xF, number >> 12 & 1, number >> 13 & 1, number >> 16 & 0xFFFFFF

    def with_crc(data: bytes = REPLY) -> object:
        if data[0] ^ data[1] ^ data[2] ^ data[3] ^ data[4] ^ data[5] or data[0] & 7 != 2:
            raise ValueError
        return floor(data)

    return {
        "floor: int.from_bytes and shifts into a tuple, no CRC": lambda: floor(REPLY),
        "by hand: with CRC and sync": lambda: with_crc(REPLY),
        "ours: encoder.decode, CRC, typed": lambda: encoder.decode(REPLY),
        "ours: SingleturnReply.decode, CRC, typed": lambda: amm5.SingleturnReply.decode(REPLY, encoder),
    }


def peers_of_serial() -> Candidates:
    peers: Candidates = {}
    module = peer("bitstruct.c")
    if module is not None:
        unpack = module.compile("u8u8u24u8").unpack
        peers["bitstruct.c, no CRC"] = lambda: unpack(REPLY)
    construct = peer("construct")
    if construct is not None:
        shape = construct.Struct(
            "control" / construct.Byte,
            "status" / construct.Byte,
            "singleturn" / construct.Int24ul,
            "crc" / construct.Byte,
        )
        peers["construct, no CRC"] = lambda: shape.parse(REPLY)
    return peers


def peer(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"  not installed, left out: {name}")
        return None


# -- many frames


def decoders_of_many() -> Candidates:
    import numpy
    from lika_encoders import amm5

    source = random.Random(1)
    encoder, serial, ssi = amm5.lookup(BISS), amm5.lookup(SERIAL), amm5.lookup("AMM5A23/65KBG1")
    sound = [amm5.SingleCycleData.from_position(encoder, source.getrandbits(37)).encode() for _ in range(2000)]
    words = numpy.tile(numpy.array(sound, numpy.uint64), MANY // 2000)
    replies = b""
    for _ in range(2000):
        singleturn, multiturn = source.getrandbits(23), source.getrandbits(16)
        replies += amm5.CompleteReply(serial, False, False, singleturn, 0x23, multiturn).encode()
    rows = numpy.frombuffer(replies * (MANY // 2000), numpy.uint8).reshape(-1, 11)
    short = numpy.frombuffer(REPLY * MANY, numpy.uint8).reshape(-1, 6)
    some_wrong = words.copy()
    some_wrong[::100] ^= numpy.uint64(1)
    positions = words >> numpy.uint64(8)
    copy = numpy.empty_like(words)
    table = encoder.decode_many(words)

    def fields() -> object:
        return words >> numpy.uint64(8), words & numpy.uint64(0x80), words & numpy.uint64(0x40)

    candidates: Candidates = {
        "copy of the words": lambda: numpy.copyto(copy, words),
        "NumPy by hand: three fields at once, no CRC": fields,
        "ours: decode_many, BiSS": lambda: encoder.decode_many(words),
        "ours: decode_many, BiSS, a frame in 100 with a fault": lambda: encoder.decode_many(some_wrong),
        "ours: decode_many, SSI": lambda: ssi.decode_many(positions),
        "ours: decode_many, reply of 6 bytes": lambda: serial.decode_many(short, amm5.SingleturnReply),
        "ours: decode_many, longest reply, 11 bytes": lambda: serial.decode_many(rows, amm5.CompleteReply),
    }
    by_c = compiled(words)
    candidates |= {"our C header, -O3 -march=native, BiSS": by_c} if by_c is not None else {}
    return {
        **candidates,
        "ours: encode_many, BiSS": lambda: encoder.encode_many({"position": positions}),
        "ours: table.unwrapped": table.unwrapped,
    }


PROGRAM = """
#include "lika/amm5_biss.h"
static const uint32_t bits = LIKA_AMM5_BISS_A21_65KSC1_BITS;
void many(const uint64_t *words, uint64_t *positions, uint8_t *faults, size_t count) {
    for (size_t at = 0; at < count; at++) {
        lika_amm5_biss_frame frame;
        const cw_word word = cw_word_of(words[at], bits);
        faults[at] = (uint8_t)lika_amm5_biss_decode(LIKA_AMM5_BISS_A21_65KSC1, word, &frame);
        positions[at] = frame.position;
    }
}
"""


def compiled(words: Any) -> Callable[[], object] | None:
    """Return a loop in C around our own header. If it cannot be built, print a message and return None."""
    import numpy

    folder = tempfile.mkdtemp()
    source, library = Path(folder, "many.c"), Path(folder, "many.so")
    source.write_text(PROGRAM, encoding="utf-8")
    include = f"-I{ROOT / 'generated' / 'c' / 'include'}"
    command = [os.environ.get("CC", "cc"), "-O3", "-march=native", "-shared", "-fPIC", include, source, "-o", library]
    try:
        completed = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    except OSError:
        completed = None
    if completed is None or completed.returncode:
        print("  left out: our C header, which could not be compiled here")
        return None
    loaded = ctypes.CDLL(str(library))
    # The columns must be kept alive while their addresses are used.
    columns = (words, numpy.empty_like(words), numpy.empty(len(words), numpy.uint8))
    pointers = [ctypes.c_void_p(column.ctypes.data) for column in columns]
    return lambda: loaded.many(*pointers, ctypes.c_size_t(len(columns[0])))


# -- import


def lookups() -> Candidates:
    import lika_encoders

    labels = ("AM3616/4096-I7", "AMM5A21/65KSC1", "ASC8525/SC1", "SMA21-SC1-0050")
    return {f"lookup({label!r})": lambda label=label: lika_encoders.lookup(label) for label in labels}


def print_import_times() -> None:
    """Print the time of an import from bytecode, without the start of the interpreter."""
    print("import with bytecode, ms of CPU time without that of the interpreter")
    family_imports = [f"import lika_encoders.{family}" for family in families()]
    programs = ("pass", "import typing, enum", "import lika_encoders", *family_imports)
    lowest_ms = dict.fromkeys(programs, float("inf"))
    with tempfile.TemporaryDirectory() as folder:
        setting = {**os.environ, "PYTHONPATH": os.pathsep.join(PATHS), "PYTHONPYCACHEPREFIX": folder}
        setting.pop("PYTHONDONTWRITEBYTECODE", None)
        for _ in range(ROUNDS):
            for program in programs:
                seconds_before = _cpu_seconds_of_children()
                subprocess.run([sys.executable, "-c", program], env=setting, check=True)
                milliseconds = 1000 * (_cpu_seconds_of_children() - seconds_before)
                lowest_ms[program] = min(lowest_ms[program], milliseconds)
    for program in programs[1:]:
        print(f"  {program:52} {lowest_ms[program] - lowest_ms['pass']:10.1f}")


def _cpu_seconds_of_children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def families() -> Iterator[str]:
    yield from sorted(path.stem for path in (PACKAGE / "lika_encoders" / "facts").glob("[a-z]*.py"))


if __name__ == "__main__":
    main()
