"""C source as text: names, numbers, comments, lines, and expressions over the parameters of an order code."""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from ..expressions import Expression, Term
from ..model import Device, Erratum, Register, cite
from ..render import plain
from ..words import sentence
from . import TargetError

COLUMNS = 100
#: The reason of an erratum is told in comments up to so many characters, and at any length where data is at stake.
_SHORT = 100
#: The least width that a text beside its lead gets.
_NARROWEST = 36

#: A paragraph of a comment; a pair is a paragraph with what stands before it, under which its other lines are indented.
Paragraph = str | tuple[str, str]

#: The words of C up to C23 and of C++ up to C++26, those of its technical specifications, and those of common compilers, as far as a name of a spec can be one.
_WORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case catch char char16_t char32_t
    char8_t class co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue contract_assert decltype default
    delete do double dynamic_cast else enum explicit export extern false final float for fortran friend goto if import inline int long module mutable
    namespace new noexcept not not_eq nullptr operator or or_eq override private protected public reflexpr register reinterpret_cast
    requires restrict return short signed sizeof static static_assert static_cast struct switch synchronized template this thread_local
    throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
#: Types and macros of the three headers that ours include.
_TYPES = "intmax_t intptr_t max_align_t nullptr_t offsetof ptrdiff_t size_t uintmax_t uintptr_t unreachable " + " ".join(
    f"{sign}int{speed}{bits}_t" for sign in ("", "u") for speed in ("", "_least", "_fast") for bits in (8, 16, 32, 64)
)
#: Macros without arguments that compilers predefine or that headers of C, of Windows, Qt, POSIX and small machines define.
_MACROS = """
    assert bool cdecl complex emit environ errno far foreach forever fortran hpux huge hyper i386 i860 i960 imaginary interface interrupt linux m68k math_errhandling max mc68000
    min mips near noreturn pascal pdp11 pixel powerpc quad sgi signals signgam slots small sparc stdcall stderr stdin stdout sun timezone tzname ultrix unix vax vector vms
"""
#: What avr-libc maps to the function for double.
_MATH = " ".join(f"{name}f" for name in """
    acos asin atan atan2 cbrt ceil copysign cos cosh exp fabs fdim floor fma fmax fmin fmod frexp hypot isfinite isinf isnan ldexp log log10 lrint lround
    pow round signbit sin sinh sqrt square strtod tan tanh trunc
""".split())
RESERVED = frozenset(f"{_WORDS} {_TYPES} {_MACROS} {_MATH}".split())

#: Letters of other alphabets and signs that comments need, in ASCII.
_ASCII = {"®": "(R)", "™": "(TM)", "©": "(C)", "±": "+/-", "²": "^2", "³": "^3", "…": "...", "µ": "u", "μ": "u", "×": "x", "–": "-", "—": "-", "−": "-", "‑": "-", "“": '"', "”": '"', "‘": "'", "’": "'", "°": " deg ", "≥": ">=", "≤": "<=", "→": "->", "Ω": "ohm", "ß": "ss"}


def ascii_text(text: object) -> str:
    """``text`` as one line of ASCII."""
    replaced = "".join(_ASCII.get(letter, letter) for letter in plain(text).replace("N°", "No."))
    flat = unicodedata.normalize("NFKD", replaced)
    kept = "".join(letter if " " <= letter <= "~" else "" if unicodedata.combining(letter) else "?" for letter in flat)
    return re.sub(" +", " ", kept).strip()


def in_comment(text: object) -> str:
    """``text`` so that it can stand in a comment: nothing in it ends or opens one, continues a line or is a trigraph."""
    safe = ascii_text(text).replace("\\", "|")
    while "??" in safe:
        safe = safe.replace("??", "? ?")
    return _apart(safe)


def _apart(text: str) -> str:
    """``text`` with a space between every star and slash that meet."""
    return re.sub(r"\*(?=/)|/(?=\*)", lambda match: match[0] + " ", text)


def string(text: object) -> str:
    """``text`` as a string literal."""
    return '"' + "".join(chr(byte) if chr(byte) in _PLAIN else f"\\{byte:03o}" for byte in str(text).encode("utf-8")) + '"'


_PLAIN = frozenset(letter for letter in map(chr, range(0x20, 0x7F)) if letter not in '"\\?')


def comment(paragraphs: Sequence[Paragraph] | str, indent: int = 0) -> str:
    """A comment of these paragraphs; empty ones are left out."""
    items = [paragraphs] if isinstance(paragraphs, str) else [item for item in paragraphs if (item if isinstance(item, str) else item[1])]
    margin = " " * indent
    lines: list[str] = []
    for item in items:
        lead, text = ("", item) if isinstance(item, str) else item
        lead = in_comment_lead(lead)
        if len(lead) > COLUMNS - indent - _NARROWEST:
            # No room beside it: the text goes below.
            lines.append(_apart(lead.rstrip()))
            lead = "        "
        width = COLUMNS - indent - 3 - len(lead)
        wrapped = textwrap.wrap(in_comment(text), width, break_long_words=False, break_on_hyphens=False) or [""]
        lines += [_apart((lead if index == 0 else " " * len(lead)) + line) for index, line in enumerate(wrapped)]
    if len(lines) == 1 and len(lines[0]) + indent + 6 <= COLUMNS:
        return f"{margin}/* {lines[0]} */"
    body = "\n".join(f"{margin} * {line}".rstrip() for line in lines)
    return f"{margin}/*\n{body}\n{margin} */"


def comment_lines(paragraphs: Sequence[Paragraph] | str) -> str:
    """The same as lines inside a comment that the template opens and closes."""
    inner = comment(paragraphs).splitlines()
    return f" * {inner[0][3:-3]}" if len(inner) == 1 else "\n".join(inner[1:-1])


#: Where a long line of code may be broken, the better places first.
_BREAKS = (re.compile(r"(?<= &&) |(?<= \|\|) "), re.compile(r"(?<= &&) |(?<= \|\|) |(?<= \|) |(?<= \+) |(?<= -) |(?<=,) (?=[a-z&(])"))


def code(line: str, indent: int = 0, hang: int = 4) -> str:
    """A line of code, broken after an operator or a comma where it is too long; further lines stand ``hang`` deeper."""
    margin = " " * indent
    if len(margin) + len(line) <= COLUMNS:
        return margin + line
    return _broken_once(line, margin, hang) or _broken(line, margin, hang, _BREAKS[0]) or _broken(line, margin, hang, _BREAKS[1], at_any_rate=True)


def _broken_once(line: str, margin: str, hang: int) -> str:
    """The line broken after an assignment or a question, where that is enough."""
    if " | " in line:
        return ""
    mark = " ? " if " ? " in line else " = "
    at = line.find(mark)
    if at < 0 or len(margin) + hang + len(line) - at - 3 > COLUMNS or len(margin) + at + 2 > COLUMNS:
        return ""
    return f"{margin}{line[: at + 2]}\n{margin}{' ' * hang}{line[at + 3 :]}"


def _broken(line: str, margin: str, hang: int, places: re.Pattern[str], at_any_rate: bool = False) -> str:
    """The line broken at these places as late as possible; empty where a part is still too long."""
    lines, current = [], margin
    for piece in places.split(line):
        if current.strip() and len(current) + len(piece) + 1 > COLUMNS:
            lines.append(current)
            current = margin + " " * hang
        current += piece if not current.strip() else f" {piece}"
    lines.append(current)
    return "\n".join(lines) if at_any_rate or max(map(len, lines)) <= COLUMNS else ""


def in_comment_lead(text: str) -> str:
    """What stands before a paragraph, its spaces kept."""
    return "".join(part if part.isspace() else in_comment(part) for part in re.split("( +)", text))


def noted(line: str, note: str, indent: int = 0) -> str:
    """A line of code with a comment behind it, or above it where it would be too long."""
    written = code(line, indent)
    short = in_comment(note)
    if not short:
        return written
    if "\n" not in written and len(written) + len(short) + 7 <= COLUMNS:
        return f"{written} /* {short} */"
    return f"{comment(note, indent)}\n{written}"


def c_name(name: str, taken: Iterable[str] = ()) -> str:
    """``name`` as the name of a member or argument."""
    return name + "_" if name in RESERVED or name in taken else name


def number(value: int, hexadecimal: bool = False, digits: int = 2) -> str:
    """``value`` as an unsigned constant."""
    text = f"0x{value:0{digits}X}" if hexadecimal else str(value)
    return f"UINT64_C({text})" if value > 0xFFFFFFFF or (hexadecimal and digits > 8) else f"{text}U"


def signed_number(value: int) -> str:
    """``value`` as a signed constant."""
    text = f"INT64_C({abs(value)})" if abs(value) > 0x7FFF else str(abs(value))
    return f"(-{text})" if value < 0 else text


def mask(width: int) -> str:
    """A constant of ``width`` ones."""
    return number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """The bits of the smallest unsigned type for ``bits`` bits."""
    if bits > 64:
        raise TargetError(f"a number of {bits} bits; the C target holds numbers in 64 bits at most")
    return next(size for size in (8, 16, 32, 64) if bits <= size)


def unsigned(bits: int) -> str:
    """The smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"



def described(printed_name: str, meaning: str) -> str:
    """The manual's own name and what it means."""
    return f"{printed_name}: {meaning}" if printed_name and meaning else printed_name or meaning


def words(name: str) -> str:
    """A name as running text."""
    return " ".join(_ACRONYMS.get(word, word) for word in name.split("_"))


_ACRONYMS = {"id": "ID", "ssi": "SSI", "biss": "BiSS", "crc": "CRC", "eeprom": "EEPROM", "led": "LED"}


class Named(Protocol):
    """Something of the spec with a name of its own, and what the manual calls it."""

    @property
    def name(self) -> str: ...
    @property
    def printed_name(self) -> str: ...
    @property
    def names(self) -> Mapping[str, str]: ...


def title(item: Named) -> str:
    """What to call it in running text."""
    text = words(item.name)
    return item.printed_name or text[0].upper() + text[1:]


def printed(item: Named) -> str:
    """The manual's own name, in whatever language; empty where the manual has none."""
    return item.printed_name or ", ".join(item.names.values())


def addresses(register: Register) -> str:
    """Where a register is, as the manuals write it."""
    return f"{register.address:02X}h" + (f" to {register.last_address:02X}h" if register.length > 1 else "")


def errata_text(erratum: Erratum) -> Paragraph:
    """What is printed and what is used; and why, where a mistake would put wrong bytes on the wire, or where it is said in a few words."""
    why = f" Why: {sentence(erratum.why)}" if erratum.severity == "wrong_data" or len(erratum.why) <= _SHORT else ""
    return (f"Erratum ({erratum.status}): ", f"printed: {sentence(erratum.printed)} Used: {sentence(erratum.used)}{why} [{cite(erratum.source)}]")


def bracketed(text: str) -> str:
    """An expression in parentheses, where it needs them to take a cast or a shift."""
    return text if re.fullmatch(r"[\w>-]+(\[\d+\])?", text) or re.fullmatch(r"\w*\([^()]*\)", text) or (text[0] == "(" and _closes_at_end(text)) else f"({text})"


def unbracketed(text: str) -> str:
    """An expression without the parentheses around it."""
    return text[1:-1] if text.startswith("(") and _closes_at_end(text) else text


def _closes_at_end(text: str) -> bool:
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0:
            return index == len(text) - 1
    return False


@dataclass(frozen=True)
class Scope:
    """How parameters are written: set ones are members of the variant, others functions of it."""

    maker: str
    prefix: str
    set_names: frozenset[str]

    def atom(self, parameter: str) -> str:
        return f"variant->{c_name(parameter)}" if parameter in self.set_names else f"{self.prefix}_{parameter}(variant)"

    def text(self, expression: Expression) -> str:
        """The expression in C, unsigned throughout and never below zero on the way where the result is not."""
        alone = expression.terms[0].factors if len(expression.terms) == 1 and expression.terms[0].sign > 0 else ()
        if len(alone) == 1 and alone[0].power and expression.constant == -1:
            return f"{self.maker}_mask({self.atom(alone[0].parameter)})"
        plus = [self._term(term) for term in expression.terms if term.sign > 0]
        minus = [self._term(term) for term in expression.terms if term.sign < 0]
        if expression.constant > 0 or not plus:
            plus.insert(0, number(max(expression.constant, 0)))
        elif len(expression.terms) > 1 or expression.constant < 0:
            plus[0] = f"(uint32_t){plus[0]}" if plus[0].startswith("variant->") else plus[0]
        if expression.constant < 0:
            minus.append(number(-expression.constant))
        return " + ".join(plus) + "".join(f" - {item}" for item in minus)

    def signed_text(self, expression: Expression) -> str:
        """The expression in C in 64 bits with a sign. A power of two is one more than its mask, which fits where the power itself may not."""
        masks = [term for term in expression.terms if term.is_power and not term.is_product]
        text = signed_number(expression.constant + sum(term.sign for term in masks))
        for term in expression.terms:
            atom = f"{self.maker}_mask({self.atom(term.factors[0].parameter)})" if term in masks else self._term(term)
            text += f" {'+' if term.sign > 0 else '-'} (int64_t){atom}"
        return text.removeprefix("0 + ")

    def _term(self, term: Term) -> str:
        """A product in C, of 64 bits where a power of two is in it, else of 32; a parameter alone keeps its own type."""
        parts = [f"((uint64_t)1U << {self.atom(item.parameter)})" if item.power else self.atom(item.parameter) for item in term.factors]
        if len(parts) == 1:
            return parts[0]
        if not term.factors[0].power:
            parts[0] = f"({'uint64_t' if term.is_power else 'uint32_t'}){parts[0]}"
        return f"({' * '.join(parts)})"


def needs_variant(*code_of: object) -> bool:
    """Whether any of this code looks at the variant."""
    return re.search(r"\bvariant->|\(variant\)|\(variant,", str(code_of)) is not None


def span_text(low: Expression, width: Expression) -> str:
    """Where a field lies, in words."""
    if low.is_constant and width.is_constant:
        if width.constant == 1:
            return f"bit {low.constant}"
        return f"bits {low.constant + width.constant - 1}:{low.constant}"
    size = plain_expression(width)
    unit = "" if size.endswith("bits") else " bit" if width == Expression(1) else " bits"
    return f"{size}{unit} from bit {plain_expression(low)} up"


def plain_expression(expression: Expression) -> str:
    """The expression for people, a number before what is taken from it."""
    if expression.constant > 0 and expression.terms and all(term.sign < 0 for term in expression.terms):
        return str(expression.constant) + replace(expression, constant=0).render().replace("-", " - ", 1)
    return expression.render()


def errata_at(device: Device, path: str, without: Sequence[str] = ()) -> list[Erratum]:
    """The errata of exactly this part of the spec or of something inside it, but not of the parts ``without``; those of wording alone are for the docs."""

    def inside(other: str, place: str) -> bool:
        return other == place or other.startswith(place + ".")

    return [
        item
        for item in device.errata
        if item.severity != "wording" and any(inside(other, path) and not any(inside(other, place) for place in without) for other in item.affects)
    ]
