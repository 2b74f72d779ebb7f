"""Names in C: those that C and the headers of the runtime reserve, and those that a header declares."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import resources

from ...language.document import Path
from ...model import Device, Layout
from ...model.record import dataclass

#: Folder of the headers, and the folder in which they are installed.
FOLDER = "codewheel"
#: Prefix of all names in the headers. No name from a spec begins like this.
PREFIX = "cw_"
#: Names that no manufacturer can have, since the runtime uses them.
TAKEN = (FOLDER, PREFIX.rstrip("_"))


@cache
def runtime_headers() -> dict[str, str]:
    """Return the texts of the headers by their file names."""
    return _texts(FOLDER)


@cache
def runtime_tests() -> dict[str, str]:
    """Return the texts of the self-tests of the headers by their file names."""
    return _texts("selftest")


@cache
def runtime_version() -> tuple[int, int]:
    """Return the major and minor version of the headers."""
    text = runtime_headers()["version.h"]
    numbers = dict(re.findall(r"#define CW_RUNTIME_(MAJOR|MINOR) (\d+)", text))
    return int(numbers["MAJOR"]), int(numbers["MINOR"])


def _texts(folder: str) -> dict[str, str]:
    texts_folder = resources.files("codewheel.runtime") / "c" / folder
    paths = sorted(texts_folder.iterdir(), key=lambda path: path.name)
    return {path.name: path.read_text(encoding="utf-8") for path in paths}


#: The keywords of C up to C23, of C++ up to C++26 and its technical specifications, and of common compilers,
#: as far as they can be names in a spec.
_KEYWORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case
    catch char char16_t char32_t char8_t class co_await co_return co_yield compl concept const const_cast consteval
    constexpr constinit continue contract_assert decltype default delete do double dynamic_cast else enum explicit
    export extern false final float for fortran friend goto if import inline int long module mutable namespace new
    noexcept not not_eq nullptr operator or or_eq override private protected public reflexpr register
    reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch
    synchronized template this thread_local throw true try typedef typeid typename typeof typeof_unqual union
    unsigned using virtual void volatile wchar_t while xor xor_eq
"""
#: Types and macros of the three headers that the generated ones include.
_SIZES = [f"{speed}{bits}" for speed in ("", "_least", "_fast") for bits in (8, 16, 32, 64)]
_SIZED_TYPES = " ".join(f"{sign}int{size}_t" for sign in ("", "u") for size in _SIZES)
_TYPES = (
    "intmax_t intptr_t max_align_t nullptr_t offsetof ptrdiff_t size_t uintmax_t uintptr_t unreachable " + _SIZED_TYPES
)
#: Object-like macros of compilers, and of headers of C, Windows, Qt, POSIX and small processors.
_MACROS = """
    assert bool cdecl complex emit environ errno far foreach forever fortran hpux huge hyper i386 i860 i960
    imaginary interface interrupt linux m68k math_errhandling max mc68000 min mips near noreturn pascal pdp11 pixel
    powerpc quad sgi signals signgam slots small sparc stdcall stderr stdin stdout sun timezone tzname ultrix unix
    vax vector vms
"""
#: Functions for double. avr-libc maps the names with an f at the end to them.
_DOUBLE_FUNCTIONS = """
    acos asin atan atan2 cbrt ceil copysign cos cosh exp fabs fdim floor fma fmax fmin fmod frexp hypot isfinite
    isinf isnan ldexp log log10 lrint lround pow round signbit sin sinh sqrt square strtod tan tanh trunc
"""
_MATH = " ".join(f"{name}f" for name in _DOUBLE_FUNCTIONS.split())
RESERVED = frozenset(f"{_KEYWORDS} {_TYPES} {_MACROS} {_MATH}".split())


def c_name(name: str, taken_names: Iterable[str] = ()) -> str:
    """Return ``name`` as the name of a member or argument."""
    return name + "_" if name in RESERVED or name in taken_names or name.startswith(PREFIX) else name


_WORDS = {
    "alarms": "the alarm",
    "alternatives": "the alternative",
    "crcs": "the CRC",
    "device": "the family",
    "layouts": "the layout",
    "order_code": "the order code",
    "parameters": "the parameter",
    "parts": "the part of the order code",
    "procedures": "the procedure",
    "registers": "the register",
    "timings": "the timing",
}


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
Declared = tuple[str, Path]


@dataclass(frozen=True)
class Clash:
    """Two parts of a spec with the same name in C. ``other`` is empty for names that every header has."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return the problem and its fix. ``where`` gives the place of the other part, as in `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {called(self.other)}{where}; rename one of the two"


def called(path: Path) -> str:
    """Describe a part of the spec in words."""
    kind = next((step for step in reversed(path) if step in _WORDS), path[0])
    return f"{_WORDS.get(str(kind), str(kind))} '{path[-1]}'" if path[-1] != kind else _WORDS.get(str(kind), str(kind))


class Names:
    """The names of one header. A name belongs to the first part that declares it. Any other part is a clash."""

    def __init__(self, declared: Iterable[Declared]) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[Clash] = []
        for name, path in declared:
            if name not in self.paths:
                self.paths[name] = path
            elif path:
                self.clashes.append(Clash(name, path, self.paths[name]))
            else:
                self.clashes.append(Clash(name, self.paths[name], ()))


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and locals, and the part of the spec that each comes from."""
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    places: list[tuple[Path, Layout]] = []
    for interface, layout in device.layouts():
        places.append((("interfaces", interface.name, "layouts", layout.name), layout))
    places += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in places:
        yield from ((c_name(field.name), path) for field in layout.fields)
        yield from ((c_name(run.name), path) for field in layout.fields for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(argument.name), ("procedures", procedure.name)) for argument in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, Names]]) -> Iterator[tuple[Device, Clash]]:
    """Yield every clash within these headers, and between families."""
    declared_paths: dict[str, Path] = {}
    for device, names in headers:
        if device.manufacturer.name in TAKEN:
            yield device, Clash(device.manufacturer.name, ("manufacturer",), ())
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in declared_paths:
                yield device, Clash(name, path or ("device",), declared_paths[name])
            declared_paths[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in declared_paths:
                yield device, Clash(name, path, ())
