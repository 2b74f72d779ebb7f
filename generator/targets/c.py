"""The C target: headers to copy into a firmware tree, one for each family and one that the families of a manufacturer share.

The headers need C99 or C++11 and no library. Everything a template prints is prepared here as text: names, numbers, expressions and
conditions. Bits are read and written in one of two ways. A frame carried as bits, or a register whose fields move with the order code, is
handled as one number of at most 64 bits (``word``). Every other frame of bytes is handled byte by byte with the pieces of the model.

Names from a spec become C names as they are. A member whose name is reserved in C or C++ (up to C23 and C++23) or is a common macro takes
an underscore at its end.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from .. import codec
from ..crc import fold_plan
from ..expressions import Expression
from ..model import Alarm, Crc, Device, Erratum, Field, FoldStep, Interface, Join, Layout, Manufacturer, Parameter, Procedure, Register, Step, Timing, Value, Variant, cite
from ..render import plain, render
from . import Library

COLUMNS = 100

#: A paragraph of a comment; a pair is a paragraph with what stands before it, under which its other lines are indented.
Paragraph = str | tuple[str, str]

_WORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break case catch char char16_t char32_t
    char8_t class co_await co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype default delete
    do double dynamic_cast else enum explicit export extern false final float for fortran friend goto if import inline int long module mutable
    namespace new noexcept not not_eq nullptr operator or or_eq override private protected public reflexpr register reinterpret_cast
    requires restrict return short signed sizeof static static_assert static_cast struct switch synchronized template this thread_local
    throw true try typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t while xor xor_eq
"""
_MACROS = "assert complex emit errno far huge i386 imaginary interface interrupt linux max min near noreturn pascal signals slots small stderr stdin stdout unix vector pixel"
RESERVED = frozenset(_WORDS.split()) | frozenset(_MACROS.split())

#: Letters of other alphabets and signs that comments need, in ASCII.
_ASCII = {"µ": "u", "μ": "u", "×": "x", "–": "-", "—": "-", "−": "-", "‑": "-", "“": '"', "”": '"', "‘": "'", "’": "'", "°": " deg ", "≥": ">=", "≤": "<=", "→": "->", "Ω": "ohm", "ß": "ss"}


def generate(library: Library) -> dict[str, str]:
    """The headers and their README."""
    files = {}
    for maker, devices in library.by_manufacturer():
        shared = {"maker": maker, "prefix": maker.name, "PREFIX": maker.name.upper()}
        files[f"c/include/{maker.name}/encoder.h"] = _render(library, "encoder.h.jinja", shared)
        for device in devices:
            view = DeviceView(device)
            files[f"c/include/{maker.name}/{device.name}.h"] = _render(library, "device.h.jinja", {**shared, "d": view})
    files["c/README.md"] = _render(library, "README.md.jinja", {"guides": [Guide(device) for device in library.devices]})
    return files


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    filters: dict[str, Callable[..., str]] = {"comment": comment, "comment_lines": comment_lines, "noted": noted, "code": code, "text": in_comment, "string": string}
    return render("c", template, values, filters=filters, own_templates=library.own_templates)


# ------------------------------------------------------------------------------------------------------------------ text and names


def ascii_text(text: object) -> str:
    """``text`` as one line of ASCII."""
    replaced = "".join(_ASCII.get(letter, letter) for letter in plain(text))
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


def code(line: str, indent: int = 0, hang: int = 4) -> str:
    """A line of code, broken after an operator or a comma where it is too long; further lines stand ``hang`` deeper."""
    margin = " " * indent
    if len(margin) + len(line) <= COLUMNS:
        return margin + line
    pieces = re.split(r"(?<= &&) |(?<= \|\|) |(?<= \|) |(?<= \+) |(?<=,) (?=[a-z])", line)
    lines, current = [], margin
    for piece in pieces:
        if current.strip() and len(current) + len(piece) + 1 > COLUMNS:
            lines.append(current)
            current = margin + " " * hang
        current += piece if not current.strip() else f" {piece}"
    return "\n".join([*lines, current])


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
    return f"UINT64_C({text})" if value > 0xFFFFFFFF else f"{text}U"


def mask(width: int) -> str:
    """A constant of ``width`` ones."""
    return number((1 << width) - 1, hexadecimal=True)


def size_of(bits: int) -> int:
    """The bits of the smallest unsigned type for ``bits`` bits."""
    return next(size for size in (8, 16, 32, 64) if bits <= size)


def unsigned(bits: int) -> str:
    """The smallest unsigned type for ``bits`` bits."""
    return f"uint{size_of(bits)}_t"


def sentence(text: str) -> str:
    """``text`` with a full stop."""
    return text if not text or text.endswith((".", "!", "?", ":")) else text + "."


def described(printed_name: str, meaning: str) -> str:
    """The manual's own name and what it means."""
    return f"{printed_name}: {meaning}" if printed_name and meaning else printed_name or meaning


def words(name: str) -> str:
    """A name as running text."""
    return name.replace("_", " ").replace("data id", "data ID")


def errata_text(erratum: Erratum) -> Paragraph:
    where = cite(erratum.source)
    return (f"Erratum ({erratum.status}): ", f"printed: {sentence(erratum.printed)} Used: {sentence(erratum.used)} [{where}]")


# ------------------------------------------------------------------------------------------------------------------ small views


@dataclass(frozen=True)
class Line:
    """A line of code and what is said about it."""

    code: str
    note: str = ""


@dataclass(frozen=True)
class Choice:
    """An enumeration, or where its numbers do not fit an int, a set of macros."""

    type: str
    about: str
    entries: tuple[Line, ...]
    names: Mapping[int, str]
    is_enum: bool


@dataclass(frozen=True)
class Check:
    """A condition under which a frame or value is refused, and for which fault."""

    condition: str
    fault: str
    note: str = ""


@dataclass(frozen=True)
class Setter:
    """A function that sets a number and the parts that it consists of."""

    name: str
    type: str
    member: str
    limit: str
    assignments: tuple[str, ...]
    about: str
    uses_variant: bool


@dataclass(frozen=True)
class CrcView:
    name: str
    type: str
    style: str
    about: tuple[Paragraph, ...]
    crc: Crc
    wide: str
    poly: str
    init: str
    xorout: str
    mask: str
    top_shift: str
    width: str
    folds: tuple[str, ...] = ()


@dataclass(frozen=True)
class CodecView:
    """A struct with its decoder and encoder, for a frame or a register."""

    name: str
    about: tuple[Paragraph, ...]
    members: tuple[Line, ...]
    carried_as: str
    length_macro: str
    length: int
    bits: str
    bits_largest: int
    uses_word: bool
    word_from_bytes: str
    bytes_from_word: tuple[str, ...]
    locals: tuple[str, ...]
    decode_checks: tuple[Check, ...]
    fills: tuple[str, ...]
    encode_checks: tuple[Check, ...]
    puts: tuple[str, ...]
    crc_line: tuple[str, ...]
    decode_needs_variant: bool
    encode_needs_variant: bool
    setters: tuple[Setter, ...]
    expected: tuple[Line, ...]
    expected_checks: str
    fold: CrcView | None


# ------------------------------------------------------------------------------------------------------------------ expressions


def bracketed(text: str) -> str:
    """An expression in parentheses, where it needs them to take a cast or a shift."""
    return text if re.fullmatch(r"[\w>-]+(\[\d+\])?", text) or re.fullmatch(r"\w*\([^()]*\)", text) or (text[0] == "(" and _closes_at_end(text)) else f"({text})"


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
        if len(expression.terms) == 1 and expression.terms[0].power and expression.terms[0].sign > 0 and expression.constant == -1:
            return f"{self.maker}_mask({self.atom(expression.terms[0].parameter)})"
        plus = [self._term(term.parameter, term.power) for term in expression.terms if term.sign > 0]
        minus = [self._term(term.parameter, term.power) for term in expression.terms if term.sign < 0]
        if expression.constant > 0 or not plus:
            plus.insert(0, number(max(expression.constant, 0)))
        elif len(expression.terms) > 1 or expression.constant < 0:
            plus[0] = f"(uint32_t){plus[0]}" if plus[0].startswith("variant->") else plus[0]
        if expression.constant < 0:
            minus.append(number(-expression.constant))
        return " + ".join(plus) + "".join(f" - {item}" for item in minus)

    def _term(self, parameter: str, power: bool) -> str:
        atom = self.atom(parameter)
        return f"((uint64_t)1U << {atom})" if power else atom


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


# ------------------------------------------------------------------------------------------------------------------ CRCs


def fold_lines(steps: Sequence[FoldStep], bits: int, start: str) -> list[str]:
    """The steps as code that ends with the remainder in ``v``, a number of 32 bits: as soon as the value fits, so that small machines save work."""
    lines = [f"uint32_t v = (uint32_t){bracketed(start)};"] if bits <= 32 else [f"uint64_t wide = {start};", "uint32_t v;"]
    name = "v" if bits <= 32 else "wide"
    for step in steps:
        if name == "wide" and bits <= 32:
            name = "v"
            lines.append("v = (uint32_t)wide;")
        lines.append(fold_line(name, step))
        bits = max(step.shift, bits - step.shift + step.back)
    return lines if name == "v" else [*lines, "v = (uint32_t)wide;"]


def fold_line(name: str, step: FoldStep) -> str:
    shifted = f"({name} >> {step.shift}U)"
    back = f" ^ ({shifted} << {step.back}U)" if step.back else ""
    return f"{name} = ({name} & {mask(step.shift)}) ^ {shifted}{back};"


def crc_body(crc: Crc) -> tuple[str, ...]:
    """A CRC of two or three terms over 64 bits: their remainder, moved up by the CRC's width, and the remainder of that."""
    lines = fold_lines(fold_plan(crc.width, crc.poly, 64), 64, "data")
    again = fold_plan(crc.width, crc.poly, 2 * crc.width)
    if 2 * crc.width <= 32:
        lines += [f"v <<= {crc.width}U;", *(fold_line("v", step) for step in again)]
    else:
        lines += [f"wide = (uint64_t)v << {crc.width}U;", *(fold_line("wide", step) for step in again), "v = (uint32_t)wide;"]
    return (*lines, f"return ({unsigned(crc.width)})(v ^ {number(crc.xorout, True)});")


def crc_view(device: Device, crc: Crc, style: str, name: str) -> CrcView:
    """The function of a CRC over a string of bits (``fold``, ``bits``) or over bytes (``xor``, ``bytes``)."""
    parameters = f"width {crc.width}, polynomial {crc.poly:#x}, start {crc.init:#x}, final XOR {crc.xorout:#x}"
    reflected = ", input and output reflected" if crc.refin and crc.refout else ", input reflected" if crc.refin else ", output reflected" if crc.refout else ""
    about: list[Paragraph] = [f"CRC {crc.name}, {crc.polynomial} [{cite(crc.source)}]: {parameters}{reflected}.", sentence(crc.note)]
    about += {
        "fold": ["The argument holds the bits that the CRC covers, the last one sent in bit 0. Bits of 0 before them change nothing."],
        "bits": ["The argument holds the bits that the CRC covers, the last one sent in bit 0, and how many they are."],
        "xor": ["With this polynomial the CRC of whole bytes is their XOR."],
        "bytes": [],
    }[style]
    about += [errata_text(item) for item in errata_at(device, f"crcs.{crc.name}")]
    return CrcView(
        name=name, type=unsigned(crc.width), style=style, about=tuple(about), crc=crc, wide=unsigned(max(crc.width, 8)), poly=number(crc.poly, True),
        init=number(crc.init, True), xorout=number(crc.xorout, True), mask=mask(crc.width), top_shift=number(crc.width - 1), width=number(crc.width),
        folds=crc_body(crc) if style == "fold" else (),
    )


def errata_at(device: Device, path: str, without: Sequence[str] = ()) -> list[Erratum]:
    """The errata of exactly this part of the spec or of something inside it, but not of the parts ``without``."""

    def inside(other: str, place: str) -> bool:
        return other == place or other.startswith(place + ".")

    return [
        item
        for item in device.errata
        if any(inside(other, path) and not any(inside(other, place) for place in without) for other in item.affects)
    ]


# ------------------------------------------------------------------------------------------------------------------ codecs


class CodecBuilder:
    """Makes the codec of one layout. Locals of a decoder are called like the fields they hold."""

    LOCALS = frozenset(("variant", "word", "plain", "bytes", "length", "out", "in", "crc", "index", "v", "wide", "value"))

    def __init__(self, view: DeviceView, layout: Layout, name: str, length_macro: str, register: Register | None = None) -> None:
        self.view = view
        self.device = view.device
        self.scope = view.scope
        self.maker = view.device.manufacturer.name
        self.layout = layout
        self.name = name
        self.length_macro = length_macro
        self.register = register
        self.by_word = layout.carried_as == "bits" or bool(layout.gray_of) or not all(item.pieces or item.padding_of for item in layout.fields)
        self.length = layout.widest // 8
        self.word = "plain" if layout.gray_of else "word"
        if self.by_word and layout.widest > 64:
            raise ValueError(f"{self.device.name}: '{layout.name}' has {layout.widest} bits and fields that move; the C target can place them in 64 bits only")
        self.folds = bool(layout.fold) and layout.carried_as == "bits" and layout.crc_field is not None and layout.crc_field.widest <= 32
        self.fixed_selector = layout.selector if len(layout.selects) == 1 else ""

    # -- what is in the struct

    def is_member(self, field: Field) -> bool:
        return field.carries_data and field.name != self.fixed_selector

    def local(self, field: Field) -> str:
        return c_name(field.name, self.LOCALS)

    def choice(self, field: Field) -> Choice | None:
        return self.view.choices.get((self.layout.name if self.register is None else "reg_" + self.register.name, field.name))

    def member_type(self, field: Field) -> str:
        if field.kind == "flag":
            return "bool"
        choice = self.choice(field)
        if choice is not None and choice.is_enum:
            return choice.type
        if field.signed:
            return unsigned(field.widest).removeprefix("u")
        return unsigned(max(field.widest, field.zero_means.bit_length()))

    def members(self) -> Iterable[Line]:
        for field in self.layout.fields:
            if not self.is_member(field):
                continue
            about = self._about(field)
            if field.kind == "text":
                yield Line(f"char {c_name(field.name)}[{field.widest // 8}];", described(about, "characters without a terminator"))
                continue
            yield Line(f"{self.member_type(field)} {c_name(field.name)};", about)
            for run in field.digits:
                yield Line(f"{unsigned((run.modulus - 1).bit_length())} {c_name(run.name)};", described("", run.meaning) or f"{run.digits} digits of {field.name}")
        for join in self.layout.joins:
            yield Line(f"{unsigned(self._widest(join))} {c_name(join.name)};", " and ".join(join.fields) + " as one number")

    def _about(self, field: Field) -> str:
        """What a member says, short: its printed name, its meaning and its unit."""
        meaning = field.when_active if field.kind == "flag" and field.when_active else field.meaning
        if field.digits:
            meaning = described(meaning, "the digits below as one number")
        unit = f" [{field.unit}]" if field.unit else ""
        return described(field.printed_name, meaning) + unit

    def _widest(self, join: Join) -> int:
        return min(sum(self.layout.field(name).widest for name in join.fields) or 1, 64)

    # -- reading

    def width(self, field: Field) -> str:
        """A mask as wide as the field."""
        return mask(field.width.constant) if field.width.is_constant else f"{self.maker}_mask({self.scope.text(field.width)})"

    def bits_text(self, field: Field) -> str:
        return self.scope.text(field.width)

    def raw(self, field: Field) -> tuple[str, str]:
        """Type and expression of the bits of a field; with padding where it is read along."""
        if self.by_word:
            kind = unsigned(field.widest)
            if field.low.is_constant and field.width.is_constant:
                shifted = f"({self.word} >> {field.low.constant}U)" if field.low.constant else self.word
                return kind, f"({kind})({shifted} & {mask(field.width.constant)})" if field.width.constant < 64 else self.word
            inner = f"{self.maker}_field({self.word}, {self.scope.text(field.low)}, {self.scope.text(field.width)})"
            return kind, inner if kind == "uint64_t" else f"({kind}){inner}"
        bits = field.container or field.widest
        kind = unsigned(bits)
        if len(field.pieces) == 1:
            piece = field.pieces[0]
            shifted = f"(bytes[{piece.byte}] >> {piece.right}U)" if piece.right else f"bytes[{piece.byte}]"
            if piece.right + piece.mask.bit_length() == 8 and piece.right:
                return kind, f"(uint8_t){shifted}"
            return kind, shifted if piece.mask == 0xFF else f"(uint8_t)({shifted} & {number(piece.mask, True)})"
        work = "uint64_t" if bits > 32 else "uint32_t"
        terms = []
        for piece in field.pieces:
            part = f"bytes[{piece.byte}]"
            if piece.right:
                part = f"({part} >> {piece.right}U)"
            if piece.mask != 0xFF and piece.right + piece.mask.bit_length() < 8:
                part = f"({part} & {number(piece.mask, True)})"
            terms.append(f"({work}){part}" if not piece.left else f"(({work}){part} << {piece.left}U)")
        joined = " | ".join(terms)
        return kind, joined if kind == work else f"({kind})({joined})"

    def gray(self, change: str, word: str) -> str:
        """``word`` with its Gray coded part turned into binary (``from``) or back (``to``), where the variant says that there is one."""
        names = next((join.fields for join in self.layout.joins if join.name == self.layout.gray_of), (self.layout.gray_of,))
        parts = [self.layout.field(name) for name in names]
        bits = parts[0].width
        for part in parts[1:]:
            bits += part.width
        call = f"{self.maker}_{change}_gray({word}, {self.scope.text(parts[-1].low)}, {self.scope.text(bits)})"
        return f"({self.scope.atom(self.layout.gray_when)} != 0U) ? {call} : {word}"

    def locals_(self) -> Iterable[str]:
        if self.layout.gray_of:
            yield f"const uint64_t plain = {self.gray('from', 'word')};"
        for field in self.layout.fields:
            if field.kind in ("constant", "crc", "text"):
                continue
            kind, expression = self.raw(field)
            yield f"const {kind} {self.local(field)} = {expression};"

    def decode_checks(self) -> Iterable[Check]:
        crc_field = self.layout.crc_field
        if crc_field is not None:
            yield Check(self._crc_condition(crc_field), "CRC")
        yield from self._constant_checks()
        for field in self.layout.fields:
            if field.kind == "parity":
                yield Check(f"{self.local(field)} != {self._parity(field, self.local)}", "CONSTANT", f"even parity of {field.parity_of}")
        for field in self.layout.fields:
            condition = self._choice_condition(field, self.local(field))
            if condition:
                yield Check(condition, "RANGE")
            if field.digits:
                limit = field.digits[0].divisor * field.digits[0].modulus
                yield Check(f"{self.local(field)} > {number(limit - 1)}", "RANGE", f"{sum(run.digits for run in field.digits)} digits")

    def _crc_condition(self, field: Field) -> str:
        crc = self.device.crc(field.crc)
        if self.layout.carried_as == "bits":
            if self.folds:
                return f"{self.name}_crc(word) != 0U"
            covered = f"word >> {crc.width}U, {self.scope.text(self.layout.bits - Expression(crc.width))}"
            return f"{self.view.crc_name(crc, 'bits')}({covered}) != (word & {mask(crc.width)})"
        _, received = self.raw(field)
        return f"{self.view.crc_name(crc, 'bytes')}(bytes, {self.length_macro} - {crc.width // 8}U) != {self._bare(received)}"

    @staticmethod
    def _bare(text: str) -> str:
        return f"({text})" if " | " in text else text

    def _constant_checks(self) -> Iterable[Check]:
        by_byte: dict[int, tuple[int, int, list[str]]] = {}
        for field in self.layout.fields:
            if field.kind != "constant":
                continue
            if field.padding_of and not self.by_word:
                padded = self.layout.field(field.padding_of)
                yield Check(f"{self.local(padded)} > {self.width(padded)}", "CONSTANT", f"bits above {padded.name} are always 0")
            elif self.by_word:
                if field.low.is_constant and field.width.is_constant:
                    shifted = f"({self.word} >> {field.low.constant}U)" if field.low.constant else self.word
                    value = f"({shifted} & {mask(field.width.constant)})"
                else:
                    value = f"{self.maker}_field({self.word}, {self.scope.text(field.low)}, {self.scope.text(field.width)})"
                guard = ""
                if field.constant and not field.width.is_constant:
                    guard = f"({self.scope.text(field.width)}) != 0U && "
                yield Check(f"{guard}{value} != {number(field.constant, True)}", "CONSTANT", field.name.replace("_", " "))
            else:
                for piece in field.pieces:
                    bits, value_, names = by_byte.get(piece.byte, (0, 0, []))
                    part = field.constant >> piece.left & piece.mask
                    by_byte[piece.byte] = (bits | piece.mask << piece.right, value_ | part << piece.right, [*names, field.name.replace("_", " ")])
        for byte, (bits, value_, names) in sorted(by_byte.items()):
            found = f"bytes[{byte}]" if bits == 0xFF else f"(bytes[{byte}] & {number(bits, True)})"
            yield Check(f"{found} != {number(value_, True)}", "CONSTANT", ", ".join(dict.fromkeys(names)))

    def _parity(self, field: Field, value: object) -> str:
        of = self.layout.field(field.parity_of)
        name = self.local(of) if value == self.local else self.value(of)
        if value != self.local and of.name == self.fixed_selector:
            return f"{self.layout.selects[0].bit_count() & 1}U"
        if of.widest > 32:
            return f"{self.maker}_parity((uint32_t){name} ^ (uint32_t)({name} >> 32U))"
        return f"{self.maker}_parity({name})" if value == self.local else f"{self.maker}_parity((uint32_t){name})"

    def _choice_condition(self, field: Field, name: str) -> str:
        """When ``name`` is none of the values that the field can take here; empty where it can take all."""
        is_selector = field.name == self.layout.selector
        if field.kind != "choice" and not is_selector:
            return ""
        allowed = list(self.layout.selects) if is_selector else [item.value for item in field.values]
        if field.width.is_constant and set(range(1 << min(field.widest, 16))) <= set(allowed):
            return ""
        choice = self.choice(field)
        names = choice.names if choice is not None else {}
        differences = [f"{name} != {names.get(value, number(value, True))}" for value in dict.fromkeys(allowed)]
        return differences[0] if len(differences) == 1 else " && ".join(f"({item})" for item in differences)

    def fills(self) -> Iterable[str]:
        any_member = False
        for field in self.layout.fields:
            if not self.is_member(field):
                continue
            any_member = True
            target = f"out->{c_name(field.name)}"
            name = self.local(field)
            if field.kind == "text":
                yield from (f"{target}[{index}] = (char){expression};" for index, expression in self._characters(field))
            elif field.kind == "flag":
                yield f"{target} = ({name} {'==' if field.active_low else '!='} 0U);"
            elif field.signed:
                yield f"{target} = ({self.member_type(field)}){self.maker}_signed({name}, {self.bits_text(field)});"
            elif field.zero_means:
                yield f"{target} = ({self.member_type(field)})(({name} == 0U) ? {number(field.zero_means)} : {name});"
            else:
                kind, held = self.member_type(field), self.raw(field)[0]
                yield f"{target} = {name};" if kind == held else f"{target} = ({kind}){name};"
            for run in field.digits:
                divided = f"{name} / {number(run.divisor)}" if run.divisor > 1 else name
                whole = divided if run is field.digits[0] else f"{divided} % {number(run.modulus)}"
                yield f"out->{c_name(run.name)} = ({unsigned((run.modulus - 1).bit_length())})({whole});"
        for join in self.layout.joins:
            kind = unsigned(self._widest(join))
            yield f"out->{c_name(join.name)} = {self._joined(join, kind, self.local)};"
        if not any_member:
            yield "out->no_data = 0U;"

    def _characters(self, field: Field) -> Iterable[tuple[int, str]]:
        """The characters of a text in reading order: index, and the byte that holds it."""
        count = field.widest // 8
        if any(piece.right or piece.mask != 0xFF for piece in field.pieces):
            raise ValueError(f"{self.device.name}: the text '{field.name}' does not begin at a byte")
        for piece in reversed(field.pieces):
            yield count - 1 - piece.left // 8, f"bytes[{piece.byte}]"

    def _joined(self, join: Join, kind: str, value: object) -> str:
        """The fields of a join as one number of type ``kind``."""
        text = ""
        for name in join.fields:
            field = self.layout.field(name)
            part = self.local(field) if value == self.local else f"in->{c_name(name)}"
            if not text:
                text = f"({kind}){part}"
                continue
            width = number(field.width.constant) if field.width.is_constant else self.scope.text(field.width)
            text = f"({text} << {bracketed(width)}) | {part}"
        return text if size_of(self._widest(join)) >= 32 or "|" not in text else f"({kind})({text})"

    # -- writing

    def encode_checks(self) -> Iterable[Check]:
        for field in self.layout.fields:
            if not self.is_member(field):
                continue
            name = f"in->{c_name(field.name)}"
            condition = self._choice_condition(field, name)
            if condition:
                yield Check(condition, "RANGE")
            elif field.signed:
                yield Check(f"!{self.maker}_fits_signed({name}, {self.bits_text(field)})", "RANGE")
            elif field.zero_means:
                yield Check(f"({name} == 0U) || (({name} > {self.width(field)}) && ({name} != {number(field.zero_means)}))", "RANGE")
            elif field.kind in ("number", "choice") and not (field.width.is_constant and size_of(field.widest) == field.widest):
                yield Check(f"{name} > {self.width(field)}", "RANGE")
            if field.digits:
                for run in field.digits:
                    yield Check(f"in->{c_name(run.name)} > {number(run.modulus - 1)}", "RANGE")
                yield Check(f"{name} != {self._from_digits(field)}", "RANGE", "the number and its digits disagree")
        for join in self.layout.joins:
            kind = unsigned(self._widest(join))
            yield Check(f"in->{c_name(join.name)} != ({self._joined(join, kind, None)})", "RANGE", f"{join.name} and its parts disagree")
        yield from self._limit_checks()

    def _limit_checks(self) -> Iterable[Check]:
        if self.register is None:
            return
        name = self.view.limited_member(self.register)
        limits = self.view.limits(self.register)
        if name and limits.binding_min:
            yield Check(f"in->{c_name(name)} < {limits.min}", "RANGE")
        if name and limits.binding_max:
            yield Check(f"in->{c_name(name)} > {limits.max}", "RANGE")

    def _from_digits(self, field: Field) -> str:
        work = unsigned(max(field.widest, 32))
        terms = [f"(({work})in->{c_name(run.name)} * {number(run.divisor)})" if run.divisor > 1 else f"in->{c_name(run.name)}" for run in field.digits]
        return "(" + " + ".join(terms) + ")"

    def value(self, field: Field) -> str:
        """The bits of a field as an expression over ``in``; a constant one as a number."""
        if field.kind == "constant":
            return number(field.constant, True)
        if field.name == self.fixed_selector:
            return number(self.layout.selects[0], True)
        name = f"in->{c_name(field.name)}"
        if field.kind == "parity":
            return self._parity(field, None)
        if field.kind == "flag":
            return f"({name} ? 0U : 1U)" if field.active_low else f"({name} ? 1U : 0U)"
        if field.signed:
            return f"((uint64_t){name} & {self.width(field)})"
        if field.zero_means:
            return f"(({name} == {number(field.zero_means)}) ? 0U : {name})"
        return name

    def puts(self) -> Iterable[str]:
        yield from self._word_puts() if self.by_word else self._byte_puts()

    def _word_puts(self) -> Iterable[str]:
        terms = []
        for field in self.layout.fields:
            if field.kind == "crc" or (field.kind == "constant" and not field.constant):
                continue
            value = self.value(field)
            if field.low == Expression(0):
                terms.append(value if value.startswith("(in->") or not value.startswith("in->") else f"(uint64_t){value}")
            else:
                low = number(field.low.constant) if field.low.is_constant else bracketed(self.scope.text(field.low))
                terms.append(f"((uint64_t){value} << {low})")
        kind = "const uint64_t" if self.layout.crc_field is None and not self.layout.gray_of else "uint64_t"
        if len(terms) < 2:
            yield f"{kind} word = {''.join(terms) or '0U'};"
        else:
            yield f"{kind} word ="
            yield from (f"    {term}" + (" |" if index < len(terms) - 1 else ";") for index, term in enumerate(terms))
        if self.layout.gray_of:
            yield f"word = {self.gray('to', 'word')};"

    def _byte_puts(self) -> Iterable[str]:
        parts: dict[int, list[str]] = {}
        constants: dict[int, int] = {}
        for field in self.layout.fields:
            if field.kind == "crc":
                continue
            fixed = field.constant if field.kind == "constant" else self.layout.selects[0] if field.name == self.fixed_selector else None
            if field.kind == "parity" and self.layout.field(field.parity_of).name == self.fixed_selector:
                fixed = self.layout.selects[0].bit_count() & 1
            if field.kind == "text":
                for index, target in self._characters(field):
                    parts.setdefault(int(target[6:-1]), []).append(f"in->{c_name(field.name)}[{index}]")
                continue
            for piece in field.pieces:
                parts.setdefault(piece.byte, [])
                if fixed is not None:
                    constants[piece.byte] = constants.get(piece.byte, 0) | (fixed >> piece.left & piece.mask) << piece.right
                    continue
                if field.signed or piece.left < size_of(max(field.widest, field.zero_means.bit_length())):
                    parts[piece.byte].append(self._put(field, piece.left, piece.mask, piece.right, alone=len(field.pieces) == 1))
        for byte in range(self.length):
            if byte not in parts:
                if not self._is_crc_byte(byte):
                    yield f"bytes[{byte}] = 0x00U;"
                continue
            terms = [*([number(constants[byte], True)] if constants.get(byte) else []), *parts[byte]] or ["0x00U"]
            inner = " | ".join(terms)
            if len(terms) == 1 and (inner.startswith("0x") or inner in self._bytes_as_they_are()):
                yield f"bytes[{byte}] = {inner};"
            else:
                cast = re.sub(r"^\(uint32_t\)(in->[^ ]+)$", r"\1", inner)
                yield f"bytes[{byte}] = (uint8_t){bracketed(cast)};"

    def _bytes_as_they_are(self) -> set[str]:
        return {f"in->{c_name(field.name)}" for field in self.layout.fields if self.is_member(field) and field.kind != "text" and self.member_type(field) == "uint8_t"}

    def _is_crc_byte(self, byte: int) -> bool:
        field = self.layout.crc_field
        return field is not None and any(piece.byte == byte for piece in field.pieces)

    def _put(self, field: Field, left: int, bits: int, right: int, alone: bool) -> str:
        """One piece of a field, moved to where it goes in its byte."""
        value = self.value(field)
        if field.kind == "flag":
            name = f"in->{c_name(field.name)}"
            bit = number(bits << right, True)
            return f"({name} ? 0x00U : {bit})" if field.active_low else f"({name} ? {bit} : 0x00U)"
        if left:
            value = f"({value} >> {left}U)"
        if (not alone or field.signed) and bits != 0xFF:
            value = f"({value} & {number(bits, True)})"
        if right:
            return f"((uint32_t){value} << {right}U)" if field.kind != "parity" else f"({value} << {right}U)"
        return value if value.startswith("(") or (self.member_type(field) == "uint8_t") else f"(uint32_t){value}"

    def crc_line(self) -> Iterable[str]:
        field = self.layout.crc_field
        if field is None:
            return
        crc = self.device.crc(field.crc)
        if self.layout.carried_as == "bits":
            if self.folds:
                yield f"word |= {self.name}_crc(word);"
            else:
                yield f"word |= {self.view.crc_name(crc, 'bits')}(word >> {crc.width}U, {self.scope.text(self.layout.bits - Expression(crc.width))});"
            return
        call = f"{self.view.crc_name(crc, 'bytes')}(bytes, {self.length_macro} - {crc.width // 8}U)"
        if len(field.pieces) == 1:
            yield f"bytes[{field.pieces[0].byte}] = {call};"
            return
        yield f"const {unsigned(crc.width)} crc = {call};"
        yield from (f"bytes[{piece.byte}] = (uint8_t)(crc >> {piece.left}U);" if piece.left else f"bytes[{piece.byte}] = (uint8_t)crc;" for piece in field.pieces)

    # -- the rest

    def setters(self) -> Iterable[Setter]:
        for join in self.layout.joins:
            kind = unsigned(self._widest(join))
            assignments, offset = [], Expression(0)
            for name in reversed(join.fields):
                field = self.layout.field(name)
                low, width = self.scope.text(offset), self.scope.text(field.width)
                assignments.append(f"out->{c_name(name)} = ({unsigned(field.widest)}){self.maker}_field({c_name(join.name)}, {low}, {width});")
                offset += field.width
            about = f"Sets {join.name} and with it {' and '.join(join.fields)}."
            limit = f"{self.maker}_mask({self.scope.text(offset)})"
            yield Setter(f"{self.name}_set_{join.name}", kind, c_name(join.name), limit, tuple(assignments), about, needs_variant(limit, assignments))
        for field in self.layout.fields:
            if not field.digits:
                continue
            kind, name = self.member_type(field), c_name(field.name)
            assignments = []
            for run in field.digits:
                divided = f"{name} / {number(run.divisor)}" if run.divisor > 1 else name
                whole = divided if run is field.digits[0] else f"{divided} % {number(run.modulus)}"
                assignments.append(f"out->{c_name(run.name)} = ({unsigned((run.modulus - 1).bit_length())})({whole});")
            limit = number(field.digits[0].divisor * field.digits[0].modulus - 1)
            about = f"Sets {field.name} and with it {', '.join(run.name for run in field.digits)}."
            yield Setter(f"{self.name}_set_{field.name}", kind, name, limit, tuple(assignments), about, False)

    def expected(self) -> tuple[list[Line], list[str]]:
        """Macros for what fields are always read as, and the conditions that compare them."""
        macros: list[Line] = []
        checks: list[str] = []
        for field in self.layout.fields:
            if field.equals is None or not self.is_member(field):
                continue
            name = f"in->{c_name(field.name)}"
            equals = field.equals.constant if isinstance(field.equals, Expression) and field.equals.is_constant else field.equals
            if isinstance(equals, Expression):
                checks.append(f"{name} == {bracketed(self.scope.text(equals))}")
                continue
            macro = self.view.unique(f"{self.name.upper()}_{field.name.upper()}_EXPECTED")
            if isinstance(equals, str):
                macros.append(Line(f"#define {macro} {string(equals)}", f"what {field.name} always reads"))
                checks += [f"{name}[{index}] == {macro}[{index}]" for index in range(len(equals.encode("ascii", "replace")))]
            else:
                macros.append(Line(f"#define {macro} {number(equals, True)}", f"what {field.name} always reads"))
                checks.append(f"{name} == {macro}")
        return macros, checks

    def table(self) -> Iterable[Paragraph]:
        """One line for each field: where it is and what it holds."""
        rows = []
        for field in self.layout.fields:
            if field.padding_of and not self.by_word:
                continue
            rows.append((self._where(field), "-" if field.name.startswith("zero_") else field.name, self._holds(field)))
        if not rows:
            return
        places, names = max(len(row[0]) for row in rows), max(len(row[1]) for row in rows)
        for place, name, holds in rows:
            yield (f"  {place:{places}}  {name:{names}}  ", holds or "-")

    def _holds(self, field: Field) -> str:
        """What a field holds: its printed name, its fixed value or rule, its meaning."""
        fixed = {
            "constant": f"always {field.constant:#x}" if field.constant else "always 0",
            "parity": f"even parity of {field.parity_of}",
            "crc": f"CRC {field.crc} over everything before it",
            "flag": f"{'0' if field.active_low else '1'} = {field.when_active or 'active'}",
            "digits": "decimal digits: " + ", ".join(run.name for run in field.digits),
        }.get(field.kind, "")
        if field.name == self.fixed_selector:
            fixed = f"always {self.layout.selects[0]:#x}"
        if field.container:
            fixed = f"{plain_expression(field.width)}{'' if plain_expression(field.width).endswith('bits') else ' bits'}, those above always 0"
        explained = field.kind in ("flag", "parity", "crc") or field.name == self.fixed_selector or field.name.startswith("zero_") or field.padding_of
        return "; ".join(part for part in (field.printed_name, fixed, "" if explained else field.meaning) if part)

    def _where(self, field: Field) -> str:
        if self.by_word or not field.pieces:
            return span_text(field.low, field.width)
        pieces = field.pieces
        if len(pieces) == 1 and pieces[0].mask != 0xFF:
            high = pieces[0].right + pieces[0].mask.bit_length() - 1
            return f"byte {pieces[0].byte} bit {high}" if high == pieces[0].right else f"byte {pieces[0].byte} bits {high}:{pieces[0].right}"
        numbers = [piece.byte for piece in pieces]
        return f"byte {numbers[0]}" if len(numbers) == 1 else f"bytes {min(numbers)} to {max(numbers)}"

    def _fold_body(self, crc: Crc) -> tuple[str, ...]:
        """The remainder of a whole word; the final XOR is taken out of the CRC bits first, so that it is 0 for a sound one."""
        start = f"word ^ {number(crc.xorout, True)}" if crc.xorout else "word"
        return (*fold_lines(self.layout.fold, self.layout.widest, start), f"return ({unsigned(crc.width)})v;")

    def build(self, about: Sequence[Paragraph]) -> CodecView:
        locals_, checks, fills = tuple(self.locals_()), tuple(self.decode_checks()), tuple(self.fills())
        encode_checks, puts, crc_line = tuple(self.encode_checks()), tuple(self.puts()), tuple(self.crc_line())
        order = range(self.length) if self.layout.byte_order == "low_byte_first" else range(self.length - 1, -1, -1)
        terms = [f"(uint64_t)bytes[{byte}]" if place == 0 else f"((uint64_t)bytes[{byte}] << {8 * place}U)" for place, byte in enumerate(order)]
        expected, expected_checks = self.expected()
        bits = self.scope.text(self.layout.bits)
        is_bits = self.layout.carried_as == "bits"
        crc_field = self.layout.crc_field
        fold = None
        if self.folds and crc_field is not None:
            crc = self.device.crc(crc_field.crc)
            about_crc = (
                f"CRC {crc.name} of a whole word, without a table: 0 when the word is sound. For a word with 0 in place of its CRC, the CRC to send.",
            )
            fold = replace(crc_view(self.device, crc, "fold", f"{self.name}_crc"), about=about_crc, folds=self._fold_body(crc))
        return CodecView(
            name=self.name,
            about=tuple(about),
            members=tuple(self.members()) or (Line("uint8_t no_data;", "this layout carries no data"),),
            carried_as=self.layout.carried_as,
            length_macro=self.length_macro,
            length=self.length,
            bits=bits,
            bits_largest=self.layout.widest,
            uses_word=self.by_word,
            word_from_bytes=" |\n        ".join(terms),
            bytes_from_word=tuple(f"bytes[{byte}] = (uint8_t)(word >> {8 * place}U);" if place else f"bytes[{byte}] = (uint8_t)word;" for place, byte in enumerate(order)),
            locals=locals_,
            decode_checks=checks,
            fills=fills,
            encode_checks=encode_checks,
            puts=puts,
            crc_line=crc_line,
            decode_needs_variant=is_bits or needs_variant(locals_, checks, fills),
            encode_needs_variant=needs_variant(encode_checks, puts, crc_line),
            setters=tuple(self.setters()),
            expected=tuple(expected),
            expected_checks=" && ".join(f"({item})" for item in expected_checks),
            fold=fold,
        )


# ------------------------------------------------------------------------------------------------------------------ a device


@dataclass(frozen=True)
class Limits:
    """Least and greatest value of a register, as C; macros where they are the same for all order codes, functions where not."""

    min: str = ""
    max: str = ""
    macros: tuple[Line, ...] = ()
    functions: tuple[tuple[str, str, str, str], ...] = ()
    binding_min: bool = False
    binding_max: bool = False


@dataclass(frozen=True)
class Mask:
    """Place of a field in the number that a register holds."""

    shift_macro: str
    mask_macro: str
    shift: str
    mask: str
    type: str
    variable: bool
    about: str


@dataclass(frozen=True)
class RegisterView:
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]
    masks: tuple[Mask, ...]
    limits: Limits
    choices: tuple[Choice, ...]
    codec: CodecView | None


@dataclass(frozen=True)
class Selector:
    """Functions that tell a frame by its selecting field."""

    function: str
    by_value: str
    field: str
    words: str
    sender: str
    cases: tuple[tuple[tuple[str, ...], str], ...]
    needs: int
    expression: str


@dataclass(frozen=True)
class InterfaceView:
    title: str
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]
    choices: tuple[Choice, ...]
    controls: tuple[Line, ...]
    frames: tuple[Line, ...]
    frame_type: str
    frame_lengths: tuple[tuple[str, str], ...]
    selectors: tuple[Selector, ...]
    cable: tuple[tuple[str, str], ...]
    cable_function: str
    cable_about: tuple[Paragraph, ...]
    timeout_function: str
    timeout_about: tuple[Paragraph, ...]
    timeout_numerator: str
    timeout_type: str
    codecs: tuple[CodecView, ...]


@dataclass(frozen=True)
class StepGroup:
    """Steps of a procedure with arguments: a fixed one, or the bytes of the register that holds an argument."""

    code: str
    address: str = ""
    at: int = 0
    bytes: str = ""


@dataclass(frozen=True)
class ArgumentView:
    """An argument that fills a register: the struct and bytes of that register, and the function that sets them."""

    codec: CodecView
    value: str
    bytes: str
    set: str


@dataclass(frozen=True)
class ProcedureView:
    name: str
    about: tuple[Paragraph, ...]
    count_macro: str
    count: int
    rows: tuple[Line, ...]
    parameters: tuple[tuple[str, str], ...]
    filled: tuple[ArgumentView, ...]
    checks: tuple[Check, ...]
    groups: tuple[StepGroup, ...]
    has_loop: bool
    needs_variant: bool


@dataclass(frozen=True)
class AlarmView:
    about: tuple[Paragraph, ...]
    macros: tuple[Line, ...]


@dataclass(frozen=True)
class DerivedParameter:
    function: str
    type: str
    expression: str
    about: str


class DeviceView:
    """Everything that the template of a device prints."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.maker: Manufacturer = device.manufacturer
        self.prefix = f"{device.manufacturer.name}_{device.name}"
        self.PREFIX = self.prefix.upper()
        self.scope = Scope(self.maker.name, self.prefix, frozenset(item.name for item in device.set_parameters))
        self._taken: set[str] = set()
        self.parameters: Sequence[Parameter] = device.set_parameters
        self.members = [Line(f"{unsigned(max(item.largest, item.max or 0).bit_length())} {c_name(item.name)};", self._meaning(item)) for item in device.set_parameters]
        self.members = self.members or [Line("uint8_t no_parameter;", "all order codes are alike")]
        self.derived = [self._derived(item) for item in self._in_order_of_use()]
        self.codes = [self._code(variant) for variant in device.variants]
        self.choices: dict[tuple[str, str], Choice] = {}
        self._shared_choices: dict[str, tuple[tuple[Value, ...], Choice]] = {}
        self._interface_choices: dict[str, list[Choice]] = {}
        self._register_choices: dict[str, list[Choice]] = {}
        self._collect_choices()
        self._crc_names: dict[tuple[str, str], str] = {}
        self.crcs = [view for crc in device.crcs for view in self._crc_views(crc)]
        self.interfaces = [self._interface(item) for item in device.interfaces]
        self.registers = [self._register(item) for item in device.registers]
        self.procedures = [self._procedure(item) for item in device.procedures]
        self.alarms = [self._alarm(item) for item in device.alarms]
        self.timings = [line for item in device.timings for line in self._timing(item, self.PREFIX)]
        self.order_about = self._order_about()

    @property
    def manual(self) -> str:
        manual = self.device.manual
        editions = ", ".join(f"{item.language} {item.revision}" for item in manual.editions)
        dated = f" of {manual.date}" if manual.date else ""
        return f'"{manual.title}", revision {manual.revision}{dated} ({manual.language}' + (f"; read beside it: {editions})" if editions else ")")

    @property
    def documents(self) -> list[Paragraph]:
        return [(f"  {item.key}: ", f"{item.title}{' - ' + item.url if item.url else ''}") for item in self.device.documents]

    def unique(self, name: str) -> str:
        """``name``, with underscores at its end where something else in the header is called so."""
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name

    def _in_order_of_use(self) -> list[Parameter]:
        """The parameters that follow from others, each after those that it needs."""
        left = [item for item in self.device.parameters if item.equals is not None]
        known = set(self.scope.set_names)
        ordered: list[Parameter] = []
        while left:
            item = next((item for item in left if item.equals is not None and known.issuperset(item.equals.parameters)), left[0])
            left.remove(item)
            known.add(item.name)
            ordered.append(item)
        return ordered

    @staticmethod
    def _meaning(item: Parameter) -> str:
        return item.meaning + (f" [{item.unit}]" if item.unit else "")

    def _derived(self, item: Parameter) -> DerivedParameter:
        assert item.equals is not None
        kind = unsigned(max(item.largest.bit_length(), 32))
        text = self.scope.text(item.equals)
        if kind == "uint32_t" and any(term.power for term in item.equals.terms):
            text = f"({kind}){bracketed(text)}"
        return DerivedParameter(self.unique(f"{self.prefix}_{item.name}"), kind, text, self._meaning(item))

    def _code(self, variant: Variant) -> tuple[str, str, str, str]:
        """Macro, initialiser, text and interface of an order code."""
        stem = variant.code.upper().removeprefix(self.device.name.upper())
        macro = self.unique(f"{self.PREFIX}_{re.sub('[^A-Z0-9]+', '_', stem).strip('_')}")
        values = ", ".join(number(variant.parameters.get(item.name, 0)) for item in self.parameters) or "0U"
        return macro, f"{{ {values} }}", variant.code, f"{self.maker.name.upper()}_INTERFACE_{variant.interface.upper() or 'NONE'}"

    def _order_about(self) -> list[Paragraph]:
        code = self.device.order_code
        about: list[Paragraph] = [f"Order codes: {code.pattern} [{cite(code.source)}]"]
        for part in code.parts:
            values = "; ".join(f"{value.text}" + (f" = {value.meaning}" if value.meaning else "") for value in part.values)
            about.append((f"  {part.name}: ", f"{part.meaning}: {values}"))
        about += [sentence(code.note), sentence(code.special)]
        return about + [errata_text(item) for item in errata_at(self.device, "order_code")]

    def variants_of(self, layout: Layout, register: Register | None = None) -> list[Variant]:
        kind = register.interface if register is not None else next(item.kind for item, other in self.device.layouts() if other is layout)
        return [variant for variant in self.device.variants if variant.interface == kind]

    # -- enumerations

    def _collect_choices(self) -> None:
        for interface, layout in self.device.layouts():
            for field in layout.fields:
                if field.kind == "choice":
                    self._add_choice(layout.name, field, self._interface_choices.setdefault(interface.kind, []), layout.name)
        for register in self.device.registers:
            for field in register.layout.fields:
                if field.kind == "choice":
                    known = self._register_choices.setdefault(register.name, [])
                    self._add_choice(f"reg_{register.name}", field, known, register.name, (register.printed_name or register.name) if len(register.layout.fields) == 1 else "")

    def _add_choice(self, owner: str, field: Field, group: list[Choice], about: str, sole: str = "") -> None:
        known = self._shared_choices.get(field.name)
        if known is not None and known[0] == field.values and not sole:
            self.choices[owner, field.name] = known[1]
            return
        base = f"{self.prefix}_{about}" if sole else f"{self.prefix}_{field.name}" if known is None else f"{self.prefix}_{about}_{field.name}"
        type_name = self.unique(base)
        is_enum = max((item.value for item in field.values), default=0) <= 0x7FFF
        names, entries = {}, []
        for item in field.values:
            entry = self.unique(f"{base.upper()}_{item.name.upper()}")
            names[item.value] = entry
            width = (field.widest + 3) // 4
            entries.append(Line(f"{entry} = 0x{item.value:0{width}X}" if is_enum else f"#define {entry} {number(item.value, True)}", self._value_note(item)))
        if is_enum and entries:
            entries = [*(Line(item.code + ",", item.note) for item in entries[:-1]), entries[-1]]
        choice = Choice(type_name, (f"Values of {sole}." if sole else "") or described(field.printed_name, field.meaning) or field.name.replace("_", " "), tuple(entries), names, is_enum)
        if known is None and not sole:
            self._shared_choices[field.name] = (field.values, choice)
        self.choices[owner, field.name] = choice
        group.append(choice)

    @staticmethod
    def _value_note(item: Value) -> str:
        note = described(item.printed_name if item.printed_name.lower().replace(" ", "_") != item.name else "", item.meaning)
        return f"{note} [{cite(item.source)}]" if item.source and note else note

    # -- CRCs

    def _crc_views(self, crc: Crc) -> Iterable[CrcView]:
        uses = {layout.carried_as for _, layout in self.device.layouts() if any(field.crc == crc.name for field in layout.fields)}
        uses |= {register.layout.carried_as for register in self.device.registers if any(field.crc == crc.name for field in register.layout.fields)}
        if not uses:
            # No whole frame says how it is carried. Reflected input means something for bytes only.
            uses = {"bytes" if crc.refin else "bits"}
        for use in sorted(uses, reverse=True):
            style = ("fold" if crc.form == "fold" and crc.width <= 32 else "bits") if use == "bits" else ("xor" if crc.form == "xor" else "bytes")
            name = self.unique(f"{self.prefix}_crc_{crc.name}" + ("_bits" if use == "bits" and len(uses) > 1 else ""))
            self._crc_names[crc.name, use] = name
            yield crc_view(self.device, crc, style, name)

    def crc_name(self, crc: Crc, use: str) -> str:
        return self._crc_names[crc.name, use]

    # -- interfaces

    def _interface(self, interface: Interface) -> InterfaceView:
        prefix, upper = f"{self.prefix}_{interface.kind}", f"{self.PREFIX}_{interface.kind.upper()}"
        groups = list(dict.fromkeys(field.group for layout in interface.layouts for field in layout.fields if field.group))
        path = f"interfaces.{interface.kind}"
        errata = errata_at(self.device, path, [f"{path}.{layout.name}" for layout in interface.layouts])
        below = [item for layout in interface.layouts for item in errata_at(self.device, f"{path}.{layout.name}")]
        errata = [item for item in errata if item not in below]
        errata += [item for group in groups for item in errata_at(self.device, f"field_groups.{group}") if item not in errata]
        macros = list(self._interface_macros(interface, upper))
        for timing in interface.timings:
            macros += self._timing(timing, upper)
        timeout = interface.timeout
        factor = 500_000_000 * (timeout.half_clock_periods or 0) if timeout is not None and timeout.rule == "follows_clock" else 0
        frames = [layout for layout in interface.layouts if layout.selector]
        frame_names = {layout.name: self.unique(f"{upper}_FRAME_{layout.name.upper()}") for layout in frames}
        return InterfaceView(
            title=interface.title,
            about=tuple(item for item in self._interface_about(interface, errata) if (item if isinstance(item, str) else item[1])),
            macros=tuple(macros),
            choices=tuple(self._interface_choices.get(interface.kind, ())),
            controls=tuple(self._controls(interface, upper)),
            frames=tuple(self._frame_lines(frames, frame_names)),
            frame_type=self.unique(f"{prefix}_frame") if frames else "",
            frame_lengths=tuple((frame_names[layout.name], self._length_macro(layout)) for layout in frames),
            selectors=tuple(self._selector(prefix, sender, layouts, frame_names) for sender, layouts in self._by_sender(frames)),
            cable=tuple((number(item.shorter_than_m), number(item.below_hz)) for item in sorted(interface.cable_lengths, key=lambda item: item.shorter_than_m)),
            cable_function=self.unique(f"{prefix}_clock_limit_hz") if interface.cable_lengths else "",
            cable_about=self._cable_about(interface),
            timeout_function=self.unique(f"{prefix}_timeout_ns") if factor else "",
            timeout_about=self._timeout_about(interface),
            timeout_numerator=number(factor) if factor <= 0xFFFFFFFF else f"UINT64_C({factor})",
            timeout_type="uint32_t" if factor <= 0xFFFFFFFF else "uint64_t",
            codecs=tuple(self._layout_codec(interface, layout) for layout in interface.layouts),
        )

    def _interface_about(self, interface: Interface, errata: Sequence[Erratum]) -> Iterable[Paragraph]:
        yield sentence(interface.note)
        if interface.signals:
            yield sentence(f"Signals: {interface.signals}")
        if interface.alignment:
            aligned = {"msb_left": "to the left: the most significant bit comes with the first clock", "lsb_right": "to the right: zeros come before it"}
            yield sentence(f"The word is aligned {aligned[interface.alignment]}" + (f". Output code: {interface.output_code.replace('_', ' ')}" if interface.output_code else ""))
        if interface.profile:
            yield sentence(f"Profile: {interface.profile}")
        if interface.network is not None:
            allowed = "several slaves may share the line" if interface.network.multiple_slaves else "never more than one slave"
            yield f"Network: {interface.network.topology.replace('_', ' ')}, {allowed} [{cite(interface.network.source)}]."
        if interface.memory_access:
            yield "Access to the memory, by the busy flag of the reply:"
            for row in interface.memory_access:
                yield (f"  {row.access}, busy {row.busy}: ", f"{sentence(row.meaning)} Address: {row.address}; data: {row.data} [{cite(row.source)}].")
        yield ("Control data: ", sentence(interface.control_data_note))
        yield from (errata_text(item) for item in errata)

    def _interface_macros(self, interface: Interface, upper: str) -> Iterable[Line]:
        if interface.clock_min_hz is not None and interface.clock_max_hz is not None:
            where = f"[{cite(interface.clock_source)}]"
            yield self._macro(f"{upper}_CLOCK_MIN_HZ", number(interface.clock_min_hz), f"lowest clock {where}")
            yield self._macro(f"{upper}_CLOCK_MAX_HZ", number(interface.clock_max_hz), f"highest clock {where}")
        timeout = interface.timeout
        if timeout is not None:
            for name, value in (("TYPICAL", timeout.typical_ns), ("AT_MOST", timeout.at_most_ns)):
                if value is not None:
                    yield self._macro(f"{upper}_TIMEOUT_{name}_NS", number(value), f"time-out after a frame [{cite(timeout.source)}]")
        port = interface.port
        if port is not None:
            yield self._macro(f"{upper}_BAUD", number(port.baud), f"bits per second [{cite(port.source)}]")
            yield self._macro(f"{upper}_DATA_BITS", number(port.data_bits))
            yield self._macro(f"{upper}_PARITY", {"none": "'N'", "even": "'E'", "odd": "'O'"}[port.parity], f"{port.parity}; flow control: {port.flow_control}")
            yield self._macro(f"{upper}_STOP_BITS", number(port.stop_bits))
        for field in interface.control_data:
            stem = f"{upper}_CONTROL_{field.name.upper()}"
            yield self._macro(f"{stem}_BITS", number(field.bits), described(field.printed_name, field.meaning) + f" [{cite(field.source)}]" if field.source else described(field.printed_name, field.meaning))
            for item in field.values:
                yield self._macro(f"{stem}_{item.name.upper()}", number(item.value, True), described(item.printed_name, item.meaning))

    def _macro(self, name: str, value: str, note: str = "") -> Line:
        return Line(f"#define {self.unique(name)} {value}", note)

    def _timing(self, timing: Timing, upper: str) -> Iterable[Line]:
        for bound in ("at_least", "typical", "at_most"):
            value = getattr(timing, f"{bound}_us")
            if value is not None:
                note = described(timing.symbol, timing.meaning) + f" [{cite(timing.source)}]"
                yield self._macro(f"{upper}_{timing.name.upper()}_{bound.upper()}_US", number(value), note)

    def _controls(self, interface: Interface, upper: str) -> Iterable[Line]:
        for item in interface.data_ids:
            yield self._macro(f"{upper}_CONTROL_{item.name.upper()}", number(item.control, True), f"data ID {item.id:X}, {item.purpose} [{cite(item.source)}]")

    def _frame_lines(self, frames: Sequence[Layout], names: Mapping[str, str]) -> Iterable[Line]:
        for index, layout in enumerate(frames):
            yield Line(f"{names[layout.name]} = {index}" + ("," if index < len(frames) - 1 else ""), layout.printed_name)

    @staticmethod
    def _by_sender(frames: Sequence[Layout]) -> list[tuple[str, list[Layout]]]:
        senders = list(dict.fromkeys(layout.sender for layout in frames))
        return [(sender, [layout for layout in frames if layout.sender == sender]) for sender in senders]

    def _selector(self, prefix: str, sender: str, layouts: Sequence[Layout], names: Mapping[str, str]) -> Selector:
        kind = {"encoder": "reply", "master": "request"}[sender]
        field = layouts[0].field(layouts[0].selector)
        if any(layout.field(layout.selector).pieces != field.pieces for layout in layouts) or not field.pieces:
            raise ValueError(f"{self.device.name}: the {kind}s do not have '{field.name}' in one place; the C target cannot tell them apart")
        _, expression = CodecBuilder(self, layouts[0], "", "").raw(field)
        owner = layouts[0].name
        choice = self.choices.get((owner, field.name))
        known = choice.names if choice is not None else {}
        cases = tuple((tuple(known.get(value, number(value, True)) for value in layout.selects), names[layout.name]) for layout in layouts)
        needs = max(piece.byte for piece in field.pieces) + 1
        return Selector(self.unique(f"{prefix}_{kind}_frame"), self.unique(f"{prefix}_{kind}_for"), field.name, words(field.name), sender, cases, needs, expression)

    @staticmethod
    def _cable_about(interface: Interface) -> tuple[Paragraph, ...]:
        if not interface.cable_lengths:
            return ()
        where = cite(tuple(dict.fromkeys(source for item in interface.cable_lengths for source in item.source)))
        return (f"The clock that must not be reached with a cable of so many metres, in hertz; 0 where the cable is too long for any [{where}].",)

    @staticmethod
    def _timeout_about(interface: Interface) -> tuple[Paragraph, ...]:
        timeout = interface.timeout
        if timeout is None or timeout.half_clock_periods is None:
            return ()
        printed = "; ".join(f"{item.timeout_ns} ns at {item.clock_hz} Hz" for item in timeout.printed)
        return (
            f"Time-out after a frame in nanoseconds, rounded up: {timeout.half_clock_periods} halves of a clock period [{cite(timeout.source)}]; 0 without a clock.",
            f"The manual's own values: {printed}." if printed else "",
        )

    def _length_macro(self, layout: Layout) -> str:
        return f"{self.PREFIX}_{layout.name.upper()}_LENGTH"

    def _layout_codec(self, interface: Interface, layout: Layout) -> CodecView:
        builder = CodecBuilder(self, layout, f"{self.prefix}_{layout.name}", self._length_macro(layout))
        by = {"encoder": "sent by the encoder", "master": "sent by the master"}[layout.sender]
        size = f"{plain_expression(layout.bits)} bits" if layout.carried_as == "bits" else f"{layout.widest // 8} byte{'s' if layout.widest > 8 else ''}"
        if layout.selects:
            size += f"; {words(layout.selector)} " + ", ".join(f"{value:X}" for value in layout.selects)
        about: list[Paragraph] = [f"{layout.name.replace('_', ' ')}, {by}: {size} [{cite(layout.source)}].", ("In the manual: ", sentence(layout.printed_name)), sentence(layout.note)]
        about += builder.table()
        about += [errata_text(item) for item in errata_at(self.device, f"interfaces.{interface.kind}.{layout.name}")]
        return builder.build(about)

    # -- registers

    def _register(self, register: Register) -> RegisterView:
        stem = f"{self.PREFIX}_REG_{register.name.upper()}"
        name = f"{self.prefix}_reg_{register.name}"
        access = {"read_only": "READ_ONLY", "read_write": "READ_WRITE", "write_only": "WRITE_ONLY"}[register.access]
        macros = [
            self._macro(f"{stem}_ADDRESS", number(register.address, True)),
            self._macro(f"{stem}_LENGTH", number(register.length), f"bytes, {register.address:02X}h to {register.last_address:02X}h" if register.length > 1 else "byte"),
            self._macro(f"{stem}_ACCESS", f"{self.maker.name.upper()}_ACCESS_{access}"),
        ]
        if register.default is not None:
            macros.append(self._macro(f"{stem}_DEFAULT", number(register.default, True, 2 * min(register.length, 8)), "value as delivered"))
        if register.wait_at_least_ms is not None:
            macros.append(self._macro(f"{stem}_WAIT_AT_LEAST_MS", number(register.wait_at_least_ms), "after a write, before the next command"))
        trivial = register.length == 1 and len(register.layout.fields) == 1 and not register.layout.joins and register.layout.fields[0].kind in ("choice", "number")
        builder = None if trivial else CodecBuilder(self, register.layout, name, f"{stem}_LENGTH", register)
        about = list(self._register_about(register))
        if builder is not None:
            about += builder.table()
        about += [errata_text(item) for item in errata_at(self.device, f"registers.{register.name}")]
        return RegisterView(
            about=tuple(about),
            macros=tuple(macros),
            masks=() if trivial else tuple(self._masks(register, name)),
            limits=self.limits(register),
            choices=tuple(self._register_choices.get(register.name, ())),
            codec=builder.build(()) if builder is not None else None,
        )

    def _register_about(self, register: Register) -> Iterable[Paragraph]:
        yield f"{register.printed_name or register.name.replace('_', ' ')}, {register.access.replace('_', ' ').replace('read write', 'read and write')}, over {self.device.interface(register.interface).title} [{cite(register.source)}]."
        yield sentence(register.meaning)
        if register.length > 1:
            yield "The lowest address holds the low byte." if register.byte_order == "low_byte_first" else "The lowest address holds the high byte."
        if register.opened_by:
            opener = self.device.register(register.opened_by)
            value = next((f"{item.value:0{2 * opener.length}X}h" for item in opener.values if item.name == register.opened_by_value), "")
            yield f"Can be written only while {opener.printed_name or opener.name} holds {value} ({register.opened_by_value.replace('_', ' ')})."
        if register.clears_itself:
            yield "Goes back to its default by itself after a write."
        if register.volatile:
            yield "A written value is lost at power-off unless it is saved."
        yield sentence(register.note)

    def _masks(self, register: Register, name: str) -> Iterable[Mask]:
        if register.length > 8:
            return
        for field in register.layout.fields:
            if field.kind in ("constant", "text") or (len(register.layout.fields) == 1 and field.kind != "choice"):
                continue
            variable = not (field.low.is_constant and field.width.is_constant)
            stem = f"{name}_{field.name}" if variable else f"{name}_{field.name}".upper()
            suffixes = ("_shift", "_mask") if variable else ("_SHIFT", "_MASK")
            if variable:
                low = self.scope.text(field.low)
                place = f"{self.maker.name}_mask({self.scope.text(field.width)}) << {bracketed(low)}"
                yield Mask(self.unique(stem + suffixes[0]), self.unique(stem + suffixes[1]), low, place, "uint64_t", True, span_text(field.low, field.width))
            else:
                bits = ((1 << field.width.constant) - 1) << field.low.constant
                yield Mask(self.unique(stem + suffixes[0]), self.unique(stem + suffixes[1]), number(field.low.constant), number(bits, True), "", False, span_text(field.low, field.width))

    def limited_member(self, register: Register) -> str:
        """The member that the limits bound, or nothing where they bound the register as a whole."""
        names = {join.name for join in register.layout.joins} | {field.name for field in register.layout.fields}
        if register.limits_of in names:
            return register.limits_of
        return register.layout.fields[0].name if len(register.layout.fields) == 1 else ""

    def limits(self, register: Register) -> Limits:
        if register.min is None and register.max is None:
            return Limits()
        stem = f"{self.prefix}_reg_{register.name}"
        variants = [variant.parameters for variant in self.device.variants if variant.interface == register.interface]
        widths = []
        for parameters in variants:
            placed = register.layout.place(parameters)
            join = next((item for item in register.layout.joins if item.name == register.limits_of), None)
            field = placed.field(self.limited_member(register)) if join is None else None
            widths.append(placed.place_of(join.name)[1] if join is not None else field.width if field is not None else 8 * register.length)
        macros, functions, texts = [], [], {"min": "", "max": ""}
        for side, expression in (("min", register.min), ("max", register.max)):
            if expression is None:
                continue
            if expression.is_constant:
                macro = f"{stem}_{side}".upper()
                macros.append(Line(f"#define {macro} {number(expression.constant)}"))
                texts[side] = macro
            else:
                largest = max((expression.value(parameters) for parameters in variants), default=0)
                kind = unsigned(max(largest.bit_length(), 32))
                text = self.scope.text(expression)
                body = text if kind == "uint64_t" or not any(term.power for term in expression.terms) else f"({kind}){bracketed(text)}"
                about = f"{'Least' if side == 'min' else 'Greatest'} value of {register.limits_of}: {expression.render()}."
                functions.append((f"{stem}_{side}", kind, body, about))
                texts[side] = f"{stem}_{side}(variant)"
        pairs = list(zip(variants, widths))
        binding_min = register.min is not None and any(register.min.value(parameters) > 0 for parameters in variants)
        binding_max = register.max is not None and any(register.max.value(parameters) < (1 << width) - 1 for parameters, width in pairs)
        return Limits(texts["min"], texts["max"], tuple(macros), tuple(functions), binding_min, binding_max)

    # -- procedures, alarms

    def _procedure(self, procedure: Procedure) -> ProcedureView:
        name = f"{self.prefix}_{procedure.name}_steps"
        taken = {"variant", "steps", "capacity", "count", "index", "result", "address"}
        names = {item.name: c_name(item.name, taken) for item in procedure.arguments}
        types: dict[str, str] = {}
        rows: list[Line] = []
        groups: list[StepGroup] = []
        filled: dict[str, ArgumentView] = {}
        checks: list[Check] = []
        for step in procedure.steps:
            if step.do != "write" or step.value is not None:
                for call, initialiser, note in self._step_rows(step):
                    groups.append(StepGroup(f"steps[{len(rows)}] = {self.maker.name}_step_{call};"))
                    rows.append(Line(f"{{ {initialiser} }}", note))
                continue
            register, argument = self.device.register(step.register), step.value_name
            codec_view = next(view.codec for view, item in zip(self.registers, self.device.registers) if item is register)
            if step.field or codec_view is None:
                field = register.layout.field(step.field) if step.field else register.layout.fields[0]
                types.setdefault(argument, unsigned(field.widest))
                checks += self._argument_checks(register, field, names[argument])
                for piece in field.pieces:
                    value = f"({names[argument]} >> {piece.left}U)" if piece.left else names[argument]
                    value = f"(({value} & {number(piece.mask, True)}) << {piece.right}U)" if piece.right or piece.mask != 0xFF else value
                    bits = number(piece.mask << piece.right, True)
                    cast = f"(uint8_t){value}"
                    groups.append(StepGroup(f"steps[{len(rows)}] = {self.maker.name}_step_write({number(register.address + piece.byte, True)}, {bits}, {cast});"))
                    rows.append(Line(""))
                continue
            member = self.limited_member(register)
            types.setdefault(argument, self._member_type(register, member))
            if argument not in filled:
                value, data = f"{names[argument]}_register", f"{names[argument]}_bytes"
                known = [setter.name for setter in codec_view.setters if setter.member == c_name(member)]
                setting = f"result = {known[0]}(variant, {names[argument]}, &{value});" if known else f"{value}.{c_name(member)} = {names[argument]};"
                filled[argument] = ArgumentView(codec_view, value, data, setting)
            groups.append(StepGroup("", f"{self.PREFIX}_REG_{register.name.upper()}_ADDRESS", len(rows), filled[argument].bytes))
            rows += [Line("")] * register.length
        about: list[Paragraph] = [f"{procedure.title} [{cite(procedure.source)}]."]
        about += [("Before: ", sentence(procedure.precondition))]
        about += [(f"{names[item.name]}: ", sentence(item.meaning)) for item in procedure.arguments]
        about += [("Result: ", sentence(procedure.result)), sentence(procedure.note)]
        about += [errata_text(item) for item in errata_at(self.device, f"procedures.{procedure.name}")]
        return ProcedureView(
            name=self.unique(name), about=tuple(about), count_macro=self.unique(f"{name}_count".upper()), count=len(rows), rows=tuple(rows),
            parameters=tuple((types.get(item.name, "uint64_t"), names[item.name]) for item in procedure.arguments), filled=tuple(filled.values()),
            checks=tuple(checks), groups=tuple(groups), has_loop=bool(filled), needs_variant=bool(filled) or needs_variant(checks),
        )

    def _argument_checks(self, register: Register, field: Field, name: str) -> Iterable[Check]:
        """Bounds of an argument that becomes one field."""
        if not field.pieces:
            raise ValueError(f"{self.device.name}: '{register.name}.{field.name}' moves with the order code; the C target cannot write it alone")
        limits = self.limits(register) if register.limits_of in (field.name, register.name) and len(register.layout.fields) == 1 else Limits()
        if size_of(field.widest) != field.widest:
            yield Check(f"{name} > {mask(field.widest)}", "RANGE")
        if limits.binding_min:
            yield Check(f"{name} < {limits.min}", "RANGE")
        if limits.binding_max:
            yield Check(f"{name} > {limits.max}", "RANGE")
        if field.kind == "choice":
            known = self.choices["reg_" + register.name, field.name].names
            yield Check(" && ".join(f"({name} != {entry})" for entry in known.values()), "RANGE")

    def _member_type(self, register: Register, member: str) -> str:
        """The type of a member of a register's struct."""
        codes = (line.code for line in CodecBuilder(self, register.layout, "", "", register).members())
        return next(code.split(" ")[0] for code in codes if code.endswith(f" {c_name(member)};"))

    def _step_rows(self, step: Step) -> Iterable[tuple[str, str, str]]:
        """For each elementary step: the call that makes it, its initialiser, and what it is for."""
        kind = f"{self.maker.name.upper()}_STEP_"
        if step.do == "wait":
            time = number(step.microseconds)
            yield f"wait({time})", f"{kind}WAIT, 0U, 0U, 0U, 0U, {time}", step.meaning or f"wait {step.microseconds} us at least"
            return
        if step.do == "send":
            byte, time = number(step.request[0] if step.request else 0, True), number(step.microseconds)
            yield f"send({byte}, {step.times}U, {time})", f"{kind}SEND, 0U, 0xFFU, {byte}, {step.times}U, {time}", step.meaning or f"data ID {words(step.data_id)}"
            return
        register = self.device.register(step.register)
        title = register.printed_name or words(register.name)
        about = step.meaning or (f"{title}: {words(step.value_name)}" if step.value_name else title)
        for offset, bits, value in self._step_bytes(register, step):
            address = number(register.address + offset, True)
            values = f"{address}, {number(bits, True)}, {number(value, True)}"
            if step.do == "read":
                yield f"read({address})", f"{kind}READ, {address}, 0xFFU, 0U, 1U, 0U", about
            else:
                yield f"{step.do}({values})", f"{kind}{step.do.upper()}, {values}, 1U, 0U", about

    def _step_bytes(self, register: Register, step: Step) -> Iterable[tuple[int, int, int]]:
        """The bytes of a register that a step touches: offset, the bits concerned, their value."""
        if step.field:
            field = register.layout.field(step.field)
            if not field.pieces:
                raise ValueError(f"{self.device.name}: '{register.name}.{field.name}' moves with the order code; the C target cannot reach it alone")
            for piece in field.pieces:
                yield piece.byte, piece.mask << piece.right, ((step.value or 0) >> piece.left & piece.mask) << piece.right
            return
        data = codec.number_to_bytes(register.layout, step.value or 0, 8 * register.length)
        yield from ((index, 0xFF, value) for index, value in enumerate(data))

    def _alarm(self, alarm: Alarm) -> AlarmView:
        stem = f"{self.PREFIX}_ALARM_{alarm.name.upper()}"
        macros = []
        field = next((field for _, layout in self.device.layouts() for field in layout.fields if field.group == alarm.group and field.name == alarm.field and field.pieces), None)
        if alarm.group and field is not None and len(field.pieces) == 1:
            piece = field.pieces[0]
            macros.append(self._macro(f"{stem}_MASK", number(piece.mask << piece.right, True), f"in the byte of the {alarm.group.replace('_', ' ')}"))
        if alarm.below_mv is not None:
            macros.append(self._macro(f"{stem}_BELOW_MV", number(alarm.below_mv), "threshold in millivolts"))
        latch = "" if alarm.latch is None else "Stays until it is reset." if alarm.latch else "Goes when its cause goes."
        cleared = ", ".join(alarm.cleared_by)
        about: list[Paragraph] = [
            f"{described(alarm.printed_name or alarm.name, alarm.meaning)} [{cite(alarm.source)}]",
            " ".join(part for part in (f"Detected: {sentence(alarm.detected)}" if alarm.detected else "", latch, "" if alarm.implemented else "Not implemented in this encoder.") if part),
            f"Remedy: {sentence(alarm.remedy)}" if alarm.remedy else "",
            f"Procedures that clear it: {cleared}." if cleared else "",
        ]
        about += [errata_text(item) for item in errata_at(self.device, f"alarms.{alarm.name}")]
        return AlarmView(tuple(about), tuple(macros))


# ------------------------------------------------------------------------------------------------------------------ README


class Guide:
    """What the README says about a device: names that exist, so that its example compiles."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.maker = device.manufacturer
        view = DeviceView(device)
        self.prefix, self.PREFIX = view.prefix, view.PREFIX
        self.title = device.title
        ordered = sorted(device.interfaces, key=lambda item: ("biss", "ssi", "rs485").index(item.kind))
        kind = ordered[0].kind
        pairs = [(row, variant) for row, variant in zip(view.codes, device.variants) if variant.interface == kind] or list(zip(view.codes, device.variants))
        chosen, _ = max(pairs, key=lambda pair: sum(pair[1].parameters.values()))
        self.macro, self.code = chosen[0], chosen[2]
        layout = ordered[0].layouts[0]
        self.layout = f"{self.prefix}_{layout.name}"
        self.carried_as = layout.carried_as
        self.length = f"{self.PREFIX}_{layout.name.upper()}_LENGTH"
        members = [join.name for join in layout.joins] or [field.name for field in layout.data_fields if field.name != layout.selector or len(layout.selects) > 1]
        self.member = c_name(members[0]) if members else "no_data"
