"""The functions of ``tracker.h`` and ``angle.h`` as a library for Python, with checks for undefined behaviour."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Mapping
from pathlib import Path

from c_harness import WARNINGS
from working_tools import require

OK, RANGE, LOST = 0, 4, 13


class Config(ctypes.Structure):
    """The limits of an axis, in the order of the header."""

    _fields_ = [
        ("modulus", ctypes.c_uint64),
        ("max_speed", ctypes.c_uint32),
        ("boot_us", ctypes.c_uint32),
        ("lost_after_us", ctypes.c_uint32),
        ("lost_after_refused", ctypes.c_uint32),
    ]


class Tracker(ctypes.Structure):
    """The tracker's struct, in the order of the header."""

    _fields_ = [
        ("known", ctypes.c_uint32),
        ("lost", ctypes.c_uint32),
        ("at_us", ctypes.c_uint32),
        ("refused", ctypes.c_uint32),
        ("elapsed_us", ctypes.c_uint32),
        ("limit", ctypes.c_uint32),
        ("boot_us", ctypes.c_uint32),
        ("lost_after_us", ctypes.c_uint32),
        ("refused_at_most", ctypes.c_uint32),
        ("modulus", ctypes.c_uint64),
        ("raw", ctypes.c_uint64),
        ("position", ctypes.c_int64),
        ("moved", ctypes.c_int64),
    ]


#: Functions with the types of their results and arguments.
FUNCTIONS = {
    "angle": ("uint32_t", ("uint64_t", "uint64_t")),
    "angle_electrical": ("uint32_t", ("uint32_t", "uint32_t", "uint32_t")),
    "angle_q31": ("int32_t", ("uint32_t",)),
    "angle_q15": ("int16_t", ("uint32_t",)),
    "angle_millidegrees": ("uint32_t", ("uint32_t",)),
    "angle_degrees": ("float", ("uint32_t",)),
    "angle_radians": ("float", ("uint32_t",)),
    "angle_highest_bit": ("uint32_t", ("uint64_t",)),
    "counts_per_second": ("int64_t", ("int64_t", "uint32_t")),
    "tracker_start": ("void", ("cw_tracker *", "const cw_tracker_config *", "uint32_t")),
    "tracker_restart": ("void", ("cw_tracker *", "uint32_t")),
    "tracker_add": ("int", ("cw_tracker *", "uint64_t", "uint32_t")),
    "tracker_speed": ("int64_t", ("const cw_tracker *",)),
}
#: Functions that divide, with the compiler's library if the processor cannot.
DIVIDING = {"counts_per_second_divided": ("int64_t", ("int64_t", "uint32_t"))}
_TYPES = {
    "void": None,
    "int": ctypes.c_int,
    "float": ctypes.c_float,
    "int16_t": ctypes.c_int16,
    "int32_t": ctypes.c_int32,
    "int64_t": ctypes.c_int64,
    "uint32_t": ctypes.c_uint32,
    "uint64_t": ctypes.c_uint64,
    "cw_tracker *": ctypes.POINTER(Tracker),
    "const cw_tracker *": ctypes.POINTER(Tracker),
    "const cw_tracker_config *": ctypes.POINTER(Config),
}


def source(functions: Mapping[str, tuple[str, tuple[str, ...]]] = FUNCTIONS) -> str:
    """Return a function for each, without ``cw_`` in its name. It does not compile if the size of a struct differs."""
    text = '#include "codewheel/tracker.h"\n#include "codewheel/angle.h"\n'
    for kind in (Tracker, Config):
        name = "cw_tracker" if kind is Tracker else "cw_tracker_config"
        text += f"typedef char {name}_here[(sizeof({name}) == {ctypes.sizeof(kind)}U) ? 1 : -1];\n"
    for name, (kind, argument_types) in functions.items():
        head = f"{kind} {name}({', '.join(f'{type_} a{index}' for index, type_ in enumerate(argument_types))})"
        call = f"cw_{name}({', '.join(f'a{index}' for index in range(len(argument_types)))})"
        return_ = {"void": "", "int": "return (int)"}.get(kind, "return ")
        text += f"{head};\n{head}\n{{\n    {return_}{call};\n}}\n"
    return text


def compile_motion(include: Path, folder: Path) -> None:
    """Compile the library into the folder. :func:`motion_of` loads it."""
    text = folder / "motion.c"
    text.write_text(source(FUNCTIONS | DIVIDING), encoding="utf-8")
    command = ["gcc", "-std=c99", "-O1", "-shared", "-fPIC", "-fsanitize=undefined", "-fno-sanitize-recover=all"]
    require(command)
    completed = subprocess.run(
        [*command, *WARNINGS, f"-I{include}", str(text), "-o", str(folder / "motion.so")],
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr[:4000]


def motion_of(folder: Path) -> ctypes.CDLL:
    """Return the library, with the types of its functions."""
    library = ctypes.CDLL(str(folder / "motion.so"))
    for name, (kind, argument_types) in (FUNCTIONS | DIVIDING).items():
        function = getattr(library, name)
        function.restype, function.argtypes = _TYPES[kind], [_TYPES[type_] for type_ in argument_types]
    return library
