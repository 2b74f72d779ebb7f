"""A layout in C: names and types of its members, how the bits of a field are read, and where they lie in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Field, Join, Layout, Piece, Register
from ..words import sentence
from . import TargetError
from .c_crc import divides_words
from .c_source import Paragraph, bracketed, c_name, described, mask, number, plain_expression, printed, size_of, span_text, title, unbracketed, unsigned
from .c_views import Choice, Line

if TYPE_CHECKING:
    from .c_device import DeviceView

#: What the generated functions call their own arguments and locals; the locals of fields take other names.
LOCALS = frozenset(("variant", "word", "plain", "bytes", "length", "out", "in", "crc", "index", "v", "wide", "value", "flags"))


class LayoutSource:
    """One layout, a frame or the bytes of a register.

    A frame carried as bits, or a layout whose fields move with the order code, is handled as one number of at most 64 bits (``by_word``).
    Every other layout of bytes is handled byte by byte with the pieces of the model.
    """

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
            wrong = f"'{layout.name}' has {layout.widest} bits and fields that move"
            raise TargetError(f"{wrong}; the C target can place them in 64 bits only", self.path)
        crc = self.device.crc(layout.crc_field.crc) if layout.carried_as == "bits" and layout.crc_field is not None else None
        self.whole_word = crc is not None and divides_words(crc)
        self.folds = self.whole_word and crc is not None and crc.form == "fold"
        self.fixed_selector = layout.selector if len(layout.selects) == 1 else ""

    @property
    def path(self) -> tuple[str, ...]:
        """Where the layout stands in the spec."""
        if self.register is not None:
            return ("registers", self.register.name)
        return ("interfaces", next(interface.kind for interface, layout in self.device.layouts() if layout is self.layout), "layouts", self.layout.name)

    # -- members

    def is_member(self, field: Field) -> bool:
        return field.carries_data and field.name != self.fixed_selector

    @property
    def member_fields(self) -> list[Field]:
        return [field for field in self.layout.fields if self.is_member(field)]

    def local(self, field: Field) -> str:
        """The local of a decoder that holds the bits of a field."""
        return c_name(field.name, LOCALS)

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

    def join_type(self, join: Join) -> str:
        return unsigned(self.join_width(join))

    def join_width(self, join: Join) -> int:
        return min(sum(self.layout.field(name).widest for name in join.fields) or 1, 64)

    def type_of(self, member: str) -> str:
        """The type of a field or join by its name in the spec."""
        join = next((item for item in self.layout.joins if item.name == member), None)
        return self.join_type(join) if join is not None else self.member_type(self.layout.field(member))

    def members(self) -> Iterable[Line]:
        for field in self.member_fields:
            about = self.about(field)
            if field.kind == "text":
                yield Line(f"char {c_name(field.name)}[{field.widest // 8}];", described(about, "characters without a terminator"))
                continue
            yield Line(f"{self.member_type(field)} {c_name(field.name)};", about)
            for run in field.digits:
                yield Line(f"{unsigned((run.modulus - 1).bit_length())} {c_name(run.name)};", described("", run.meaning) or f"{run.digits} digits of {field.name}")
        for join in self.layout.joins:
            yield Line(f"{self.join_type(join)} {c_name(join.name)};", " and ".join(join.fields) + " as one number")

    def about(self, field: Field) -> str:
        """What a member says: its printed name, its meaning, its unit, and what the manual says of its use."""
        meaning = field.when_active if field.kind == "flag" and field.when_active else field.meaning
        if field.kind == "flag" and field.when_active and field.meaning:
            meaning = f"{sentence(field.when_active)} {field.meaning}"
        if field.digits:
            meaning = described(meaning, "the digits below as one number")
        choice = self.choice(field)
        if choice is not None and choice.is_enum and choice.about == described(printed(field), field.meaning):
            return field.note
        unit = f" [{field.unit}]" if field.unit else ""
        return "; ".join(part for part in (described(printed(field), meaning) + unit, *self._use(field)) if part)

    def _use(self, field: Field) -> Iterable[str]:
        if not field.implemented and field.meaning.lower() != "not implemented":
            yield "not implemented in this encoder"
        if field.reserved:
            yield f"reserved to the {'manufacturer' if field.reserved == 'maker' else field.reserved}"
        if field.power_of_two:
            yield "powers of two only"
        if field.zero_means:
            yield f"0 in the register stands for {field.zero_means}" if self.register is not None else f"0 on the line stands for {field.zero_means}"
        if field.explained_by:
            register = field.explained_by[0].partition(".")[0]
            yield f"{title(self.device.register(register))} tells why: {', '.join(item.partition('.')[2] or item for item in field.explained_by)}"
        yield field.note

    # -- expressions

    def width(self, field: Field) -> str:
        """A mask as wide as the field."""
        return mask(field.width.constant) if field.width.is_constant else f"{self.maker}_mask({self.scope.text(field.width)})"

    def bits_text(self, field: Field) -> str:
        return self.scope.text(field.width)

    def raw(self, field: Field) -> tuple[str, str]:
        """Type and expression of the bits of a field; with padding where it is read along."""
        return self._raw_of_word(field) if self.by_word else self._raw_of_bytes(field)

    def in_word(self, field: Field) -> str:
        """The bits of a field at a fixed place in the word."""
        return self._at_fixed_place(field.low.constant, field.width.constant)

    def _at_fixed_place(self, low: int, width: int) -> str:
        """In 32 bits where they lie within the lower half."""
        word = f"(uint32_t){self.word}" if low + width <= 32 and self.layout.widest > 32 else self.word
        shifted = f"({word} >> {low}U)" if low else word
        return f"({shifted} & {mask(width)})"

    def bit(self, field: Field) -> str:
        """The bit of a flag where it is: in the word, or in the byte ``flags``."""
        if not self.by_word:
            return f"(flags & {number(field.pieces[0].mask << field.pieces[0].right, True)})"
        if not (field.low.is_constant and field.width.is_constant):
            return self.moving(field)
        low = field.low.constant
        word = f"(uint32_t){self.word}" if low < 32 and self.layout.widest > 32 else self.word
        return f"({word} & {number(1 << low, True)})"

    def moving(self, field: Field) -> str:
        """The bits of a field whose place in the word depends on the variant."""
        return self._moving(field.low, field.width)

    def _moving(self, low: Expression, width: Expression) -> str:
        if self.layout.carried_as == "bits" and self.layout.bits - low - width == Expression(0):
            # Nothing lies above it: the length has been checked.
            if low == Expression(0):
                return self.word
            return f"({self.word} >> {low.constant}U)" if low.is_constant else f"{self.maker}_above({self.word}, {self.scope.text(low)})"
        return f"{self.maker}_field({self.word}, {self.scope.text(low)}, {self.scope.text(width)})"

    def join_in_word(self, join: Join) -> str:
        """The number of a join where its fields lie side by side in the word; empty where they do not."""
        fields = [self.layout.field(name) for name in join.fields]
        if not self.by_word or any(upper.low != lower.low + lower.width for upper, lower in zip(fields, fields[1:])):
            return ""
        low, width = fields[-1].low, sum((field.width for field in fields), Expression(0))
        kind = self.join_type(join)
        inner = self._at_fixed_place(low.constant, width.constant) if low.is_constant and width.is_constant else self._moving(low, width)
        return unbracketed(inner) if kind == "uint64_t" else f"({kind}){inner}"

    def _raw_of_word(self, field: Field) -> tuple[str, str]:
        kind = unsigned(field.widest)
        if field.low.is_constant and field.width.is_constant:
            return kind, f"({kind}){self.in_word(field)}" if field.width.constant < 64 else self.word
        inner = self.moving(field)
        return kind, inner if kind == "uint64_t" else f"({kind}){inner}"

    def _raw_of_bytes(self, field: Field) -> tuple[str, str]:
        pieces = [piece for piece in field.pieces if piece not in self.padding(field)]
        bits = sum(piece.mask.bit_length() for piece in pieces)
        kind = unsigned(bits)
        if len(pieces) == 1:
            return kind, _only_piece(pieces[0])
        work = "uint64_t" if bits > 32 else "uint32_t"
        joined = " | ".join(_piece(piece, work) for piece in pieces)
        return kind, joined if kind == work else f"({kind})({joined})"

    def padding(self, field: Field) -> list[Piece]:
        """The bytes of a container that its field never reaches."""
        return [piece for piece in field.pieces if field.container and piece.left >= field.widest]

    def characters(self, field: Field) -> Iterable[tuple[int, int]]:
        """The characters of a text in reading order: index, and the byte that holds it."""
        count = field.widest // 8
        if any(piece.right or piece.mask != 0xFF for piece in field.pieces):
            wrong = f"the text '{field.name}' does not begin at a byte, which the C target cannot express"
            raise TargetError(wrong, (*self.path, "fields", field.name))
        for piece in reversed(field.pieces):
            yield count - 1 - piece.left // 8, piece.byte

    def joined(self, join: Join, name_of: Callable[[Field], str]) -> str:
        """The fields of a join as one number of the join's type."""
        kind = self.join_type(join)
        text = ""
        for name in join.fields:
            field = self.layout.field(name)
            if not text:
                text = f"({kind}){name_of(field)}"
                continue
            width = number(field.width.constant) if field.width.is_constant else self.scope.text(field.width)
            text = f"({text} << {bracketed(width)}) | {name_of(field)}"
        return text if size_of(self.join_width(join)) >= 32 or "|" not in text else f"({kind})({text})"

    def gray(self, change: str, word: str) -> str:
        """``word`` with its Gray coded part turned into binary (``from``) or back (``to``), where the variant says that there is one."""
        names = next((join.fields for join in self.layout.joins if join.name == self.layout.gray_of), (self.layout.gray_of,))
        parts = [self.layout.field(name) for name in names]
        bits = parts[0].width
        for part in parts[1:]:
            bits += part.width
        call = f"{self.maker}_{change}_gray({word}, {self.scope.text(parts[-1].low)}, {self.scope.text(bits)})"
        return f"({self.scope.atom(self.layout.gray_when)} != 0U) ? {call} : {word}"

    def choice_condition(self, field: Field, name: str, is_raw: bool = False) -> str:
        """When ``name`` is none of the values that the field can take here; empty where it can take all.

        ``is_raw`` says that ``name`` is the bits as read, a number rather than one of the field's enumeration.
        """
        is_selector = field.name == self.layout.selector
        if field.kind != "choice" and not is_selector:
            return ""
        allowed = list(self.layout.selects) if is_selector else [item.value for item in field.values]
        if field.width.is_constant and set(range(1 << min(field.widest, 16))) <= set(allowed):
            return ""
        choice = self.choice(field)
        names = choice.names if choice is not None else {}
        if choice is not None and choice.is_enum and is_raw:
            names = {value: f"({self.raw(field)[0]}){entry}" for value, entry in names.items()}
        differences = [f"{name} != {names.get(value, number(value, True))}" for value in dict.fromkeys(allowed)]
        return differences[0] if len(differences) == 1 else " && ".join(f"({item})" for item in differences)

    # -- words

    def table(self) -> Iterable[Paragraph]:
        """One line for each field: where it is and what it holds."""
        rows = []
        for field in self.layout.fields:
            if field.padding_of and not self.by_word:
                continue
            rows.append((self._where(field), "-" if field.name.startswith("zero_") else field.name, self._holds(field)))
        if not rows:
            return
        # A place too long for the column has its text below, and does not widen the column for the others.
        places, names = max((len(row[0]) for row in rows if len(row[0]) <= _PLACE), default=0), max(len(row[1]) for row in rows)
        for place, name, holds in rows:
            yield (f"  {place:{places}}  {name:{names}}  ", holds) if holds else (f"  {place:{places}}  ", name)

    def _holds(self, field: Field) -> str:
        """What is fixed about a field; the meaning of a member stands in the struct."""
        if field.name == self.fixed_selector:
            return "; ".join(part for part in (printed(field), f"always {self.layout.selects[0]:#x}") if part)
        width = plain_expression(field.width)
        fixed = {
            "constant": f"always {field.constant:#x}" if field.constant else "always 0",
            "parity": f"even parity of {field.parity_of}",
            "crc": f"CRC {field.crc} over everything before it",
            "flag": f"active {'low' if field.active_low else 'high'}" if field.implemented else "not implemented",
            "digits": "decimal digits: " + ", ".join(run.name for run in field.digits),
        }.get(field.kind, "")
        if field.container:
            fixed = f"{width}{'' if width.endswith('bits') else ' bits'}, those above always 0"
        if field.signed:
            fixed = "two's complement"
        if isinstance(field.equals, int):
            fixed = f"{field.equals:#x} by the manual, not enforced"
        explains = field.kind == "constant" and not field.name.startswith("zero_") and not field.padding_of
        outside = () if self.is_member(field) and field.equals is None else (printed(field),)
        return "; ".join(part for part in (*outside, fixed, field.meaning if explains and "always" not in field.meaning.lower() else "") if part)

    def _where(self, field: Field) -> str:
        if self.by_word or not field.pieces:
            return span_text(field.low, field.width)
        pieces = field.pieces
        if len(pieces) == 1 and pieces[0].mask != 0xFF:
            high = pieces[0].right + pieces[0].mask.bit_length() - 1
            bits = f"bit {high}" if high == pieces[0].right else f"bits {high}:{pieces[0].right}"
            return f"byte {pieces[0].byte} {bits}" if self.length > 1 else bits
        numbers = [piece.byte for piece in pieces]
        return f"byte {numbers[0]}" if len(numbers) == 1 else f"bytes {min(numbers)} to {max(numbers)}"


#: The widest column of places in a comment.
_PLACE = 50


def _only_piece(piece: Piece) -> str:
    """A field that lies within one byte."""
    shifted = f"(bytes[{piece.byte}] >> {piece.right}U)" if piece.right else f"bytes[{piece.byte}]"
    if piece.right + piece.mask.bit_length() == 8 and piece.right:
        return f"(uint8_t){shifted}"
    return shifted if piece.mask == 0xFF else f"(uint8_t)({shifted} & {number(piece.mask, True)})"


def _piece(piece: Piece, work: str) -> str:
    """One of several parts of a field, where it goes in a number of type ``work``."""
    part = f"bytes[{piece.byte}]"
    if piece.right:
        part = f"({part} >> {piece.right}U)"
    if piece.mask != 0xFF and piece.right + piece.mask.bit_length() < 8:
        part = f"({part} & {number(piece.mask, True)})"
    return f"({work}){part}" if not piece.left else f"(({work}){part} << {piece.left}U)"
