"""Names, constants and types in C: reserved names, and parts of specs that would get the same name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from itertools import count

from ...language.document import Path
from ...model import Device, Layout
from ...model.record import dataclass
from .. import TargetError

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

#: Folder of the headers, and the folder in which they are installed.
FOLDER = "codewheel"
#: Prefix of all names in the headers. No name from a spec begins like this.
PREFIX = "cw_"
#: Names that no manufacturer can have, because the runtime uses them.
TAKEN = (FOLDER, PREFIX.rstrip("_"))


def errata_page_name(maker: str) -> str:
    """Return the file name of the page with the errata of a manufacturer."""
    return f"ERRATA-{maker}.md"


def c_name(name: str, taken_names: Iterable[str] = ()) -> str:
    """Return ``name`` as the name of a member or argument, with ``_`` at its end if it is reserved or taken."""
    is_reserved = name in RESERVED or name in taken_names or name.startswith(PREFIX)
    return f"{name}_" if is_reserved else name


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
DeclaredName = tuple[str, Path]


_PLAIN_CHARACTERS = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def string(text: object) -> str:
    """Return ``text`` as a string literal."""
    return '"' + "".join(map(_escape_character, str(text).encode("utf-8"))) + '"'


def _escape_character(byte: int) -> str:
    """Return a byte as a character of a string literal, in octal unless it is printable and plain in C."""
    return chr(byte) if chr(byte) in _PLAIN_CHARACTERS else f"\\{byte:03o}"


def c_number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """Return ``value`` as an unsigned constant, such as ``24U``, ``0x1BU`` or ``UINT64_C(4294967296)``.

    ``digits`` is the minimum number of hexadecimal digits. With more than 8, the constant has 64 bits.
    """
    literal = f"0x{value:0{digits}X}" if hexadecimal else str(value)
    has_64_bits = value > 0xFFFFFFFF or (hexadecimal and digits > 8)
    return f"UINT64_C({literal})" if has_64_bits else f"{literal}U"


def signed_number(value: int) -> str:
    """Return ``value`` as a signed constant, such as ``24``, ``(-24)`` or ``INT64_C(40000)`` above 7FFFh."""
    # An int can have 16 bits.
    magnitude = f"INT64_C({abs(value)})" if abs(value) > 0x7FFF else str(abs(value))
    return f"(-{magnitude})" if value < 0 else magnitude


def mask_constant(width: int) -> str:
    """Return a constant whose lowest ``width`` bits are 1."""
    return c_number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """Return the width of the smallest integer type for ``bits`` bits: 8, 16, 32 or 64.

    Raises:
        TargetError: There are more than 64 bits.
    """
    for size in (8, 16, 32, 64):
        if bits <= size:
            return size
    raise TargetError(f"a number of {bits} bits; the C target holds numbers of at most 64 bits")


def signed(bits: int) -> str:
    """Return the smallest signed type for ``bits`` bits."""
    return f"int{size_of(bits)}_t"


def unsigned(bits: int) -> str:
    """Return the smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"


_SECTION_IN_WORDS = {
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


@dataclass(frozen=True)
class NameClash:
    """Two parts of a spec with the same name in C. The path ``other`` is empty if every header has the name."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return a message with the problem and its fix. ``where`` is the place of the other part: `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {describe_path(self.other)}{where}; rename one of the two"


def describe_path(path: Path) -> str:
    """Return a part of the spec in words, such as ``the register 'status'`` for ``("registers", "status")``.

    The kind of the part is the last step of the path that has a word in ``_SECTION_IN_WORDS``, or else the first step.
    """
    kind = next((step for step in reversed(path) if step in _SECTION_IN_WORDS), path[0])
    kind_in_words = _SECTION_IN_WORDS.get(str(kind), str(kind))
    name = path[-1]
    # A path such as ("order_code",) has no name.
    return f"{kind_in_words} '{name}'" if name != kind else kind_in_words


class HeaderNames:
    """The names that one header declares at file scope, and the clashes between them.

    ``path_by_name`` contains the part of the spec that each name comes from. It is the first part that declares the
    name. Any other part with the same name is a clash.
    """

    def __init__(self, declared: Iterable[DeclaredName]) -> None:
        self.path_by_name: dict[str, Path] = {}
        self.clashes: list[NameClash] = []
        for name, path in declared:
            if name not in self.path_by_name:
                self.path_by_name[name] = path
            elif path:
                self.clashes.append(NameClash(name=name, path=path, other=self.path_by_name[name]))
            else:
                # Every header declares this name, so the earlier part is the one to rename.
                self.clashes.append(NameClash(name=name, path=self.path_by_name[name], other=()))


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and local variables, each with the part of the spec that it comes from.

    A name can come several times, because each struct or function has its own scope.
    """
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    paths_and_layouts: list[tuple[Path, Layout]] = []
    for interface, layout in device.layouts():
        paths_and_layouts.append((("interfaces", interface.name, "layouts", layout.name), layout))
    paths_and_layouts += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in paths_and_layouts:
        for field in layout.fields:
            yield c_name(field.name), path
            yield from ((c_name(run.name), path) for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(argument.name), ("procedures", procedure.name)) for argument in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, HeaderNames]]) -> Iterator[tuple[Device, NameClash]]:
    """Yield every pair of parts of specs with the same C name, with the device in whose spec the second part is.

    Names at file scope must differ in all headers. The name of a member, argument or local must differ from those at
    file scope in its own and in earlier headers. The name of a manufacturer must not be one of ``TAKEN``.
    """
    declared_paths: dict[str, Path] = {}
    for device, names in headers:
        if device.manufacturer.name in TAKEN:
            yield device, NameClash(name=device.manufacturer.name, path=("manufacturer",), other=())
        for clash in names.clashes:
            yield device, clash
        for name, path in names.path_by_name.items():
            if name in declared_paths:
                yield device, NameClash(name=name, path=path or ("device",), other=declared_paths[name])
            # For the families that follow, a name belongs to the family rather than to a part of it.
            declared_paths[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in declared_paths:
                yield device, NameClash(name=name, path=path, other=())


@dataclass(frozen=True, slots=True)
class CMacro:
    """A macro with its value. ``note`` is the comment at the end of its line, empty if it needs none."""

    name: str
    value: str
    note: str = ""


def unused_name(name: str, used_names: Collection[str]) -> str:
    """Return ``name``, with the first free number at its end if it is used already, such as ``status_2``."""
    numbered_name = name
    for number in count(2):
        if numbered_name not in used_names:
            break
        numbered_name = f"{name}_{number}"
    return numbered_name
