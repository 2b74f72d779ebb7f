"""What one layout is made of in Python source: numbers, masks, fields in a word and fields in bytes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Digits, Field, Layout, Piece, Register, RegisterMeaning
from ..words import sentence
from .python_source import Block, Code, attribute, expression, grouped, operand

if TYPE_CHECKING:
    from .python_module import Module

#: The functions of the package that a device module imports, by the module that has them.
CODEC_FUNCTIONS = (
    "as_bytes", "as_word", "by_class", "check_encoder", "check_limits", "check_power_of_two", "check_signed", "check_width", "choice", "crc_by_xor",
    "crc_of_bits", "crc_of_bytes", "from_gray", "made", "signed", "text_number", "to_gray", "too_long", "unwrap", "whole_number", "wrong_encoder",
    "zero_for",
)  # fmt: skip
REGISTER_FUNCTIONS = ("agrees", "held_bytes", "held_parameters", "held_text", "whole")
STEP_FUNCTIONS = ("writes",)
FUNCTIONS = (*CODEC_FUNCTIONS, *REGISTER_FUNCTIONS, *STEP_FUNCTIONS, "index")
#: Names that the generated classes, and in them the methods, use for themselves.
CLASS_NAMES = (
    "bit_fields", "check_width", "cls", "count", "decode", "encode", "frame_bits", "index", "is_as_documented", "limits", "self", "variant",
)
LOCAL_NAMES = (
    "bits", "body", "cls", "computed", "data", "isinstance", "len", "number", "remainder", "self", "type", "values", "variant", "word", *FUNCTIONS,
)


#: What the argument ``bits`` of every decoder of a string of bits means.
BITS = ("bits", "How many bits came in, where that is known. A number alone does not tell whether bits are missing.")


def interface_name(kind: str) -> str:
    """The module's own name for an interface; to ask the Enum for it takes longer than all checks."""
    return f"_{kind.upper()}"


def meaning_limits(meaning: RegisterMeaning) -> str:
    """The function that gives the limits of one meaning of a register."""
    return f"{meaning.name}_limits"


def class_names(layout: Layout, register: Register | None) -> tuple[str, ...]:
    """The names that the class of a layout has for itself: no attribute can have one."""
    made = [f"from_{attribute(item.name, CLASS_NAMES)}" for item in layout.joins]
    limits = [meaning_limits(item) for item in register.meanings] if register is not None else []
    return (*CLASS_NAMES, *made, *limits)


class LayoutText:
    """Expressions for the parts of one layout."""

    def __init__(
        self,
        module: Module,
        layout: Layout,
        name: str,
        doc: tuple[str, list[Block]],
        interface: str,
        register: Register | None,
    ) -> None:
        self.module = module
        self.interface = interface_name(interface)
        self.layout = layout
        self.name = name
        self.doc = doc
        self.register = register
        self.in_bytes = layout.carried_as == "bytes"
        self.order = "little" if layout.byte_order == "low_byte_first" else "big"
        self.bytes = layout.bits.constant // 8 if self.in_bytes else 0
        crc = layout.crc_field
        self.crc = module.device.crc(crc.crc) if crc is not None else None
        self.by_piece = self.in_bytes and all(item.pieces or item.padding_of or item.kind in ("crc", "text") for item in layout.fields)
        self.by_piece = self.by_piece and not layout.gray_when and all(item.pieces for item in layout.fields if item.kind == "text")
        self.containers = {item.padding_of: item for item in layout.fields if item.padding_of} if self.by_piece else {}
        self.source = "data" if self.by_piece else "number" if self.in_bytes else "word"
        limits = [item for item in (register.min, register.max) if item is not None] if register is not None else []
        positions = [part for item in layout.fields for part in (item.low, item.width)]
        expected = [item.equals for item in layout.fields if isinstance(item.equals, Expression)]
        self.takes_variant = bool(layout.gray_when) or not all(item.is_constant for item in (layout.bits, *positions, *limits, *expected))

    def _text(self, value: Expression, owner: str = "variant") -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.module.parameter_names, owner)

    def _code(self, value: Expression) -> int | Code:
        return value.constant if value.is_constant else Code(self._text(value))

    def _attribute(self, name: str) -> str:
        return attribute(name, class_names(self.layout, self.register))

    def _digits(self, item: Field) -> str:
        """The number that runs of decimal digits make."""
        return " + ".join(times(f"index(self.{self._attribute(run.name)})", run.divisor) for run in item.digits)

    def _mask(self, width: Expression, owner: str = "variant") -> str:
        return f"0x{(1 << width.constant) - 1:X}" if width.is_constant else f"((1 << {operand(self._text(width, owner))}) - 1)"

    def _raw(self, item: Field) -> str:
        """The expression for the bits of a field; with padding in bytes, for the whole container."""
        if self.by_piece and item.pieces:
            return from_pieces(item.pieces, self.bytes)
        shifted = self.source if item.low == Expression(0) else f"{self.source} >> {operand(self._text(item.low))}"
        return shifted if item.low + item.width == self.layout.bits else f"{shifted} & {self._mask(item.width)}"

    def _bit(self, item: Field) -> str:
        """The expression that is not 0 when the bit is set."""
        if self.by_piece and item.pieces:
            piece = item.pieces[0]
            return f"data[{piece.byte}] & 0x{1 << piece.right:02X}"
        if item.low.is_constant:
            return f"{self.source} & 0x{1 << item.low.constant:02X}"
        return f"{self.source} >> {operand(self._text(item.low))} & 1"


def from_pieces(pieces: Sequence[Piece], length: int = 0) -> str:
    """The number that the pieces make."""
    whole = all(piece.right == 0 and piece.mask == 0xFF for piece in pieces)
    places = [piece.byte for piece in pieces]
    if whole and len(pieces) > 3:
        if places == list(range(places[0], places[0] + len(places))):
            return _int_from(places[0], places[-1], length, "little")
        if places == list(range(places[0], places[0] - len(places), -1)):
            return _int_from(places[-1], places[0], length, "big")
    return " | ".join(map(_from_piece, pieces if places[0] <= places[-1] else reversed(pieces)))


def _int_from(first: int, last: int, length: int, order: str) -> str:
    part = "data" if first == 0 and last == length - 1 else f"data[{first}:{last + 1}]"
    return f'int.from_bytes({part}, "{order}")'


def _from_piece(piece: Piece) -> str:
    text = f"data[{piece.byte}]"
    if piece.right:
        text += f" >> {piece.right}"
    if piece.mask << piece.right & 0xFF != 0xFF >> piece.right << piece.right:
        text += f" & 0x{piece.mask:X}"
    if not piece.left:
        return text
    return f"{text} << {piece.left}" if text.endswith("]") else f"({text}) << {piece.left}"


def compared(raw: str) -> str:
    """``raw`` in parentheses where a reader might not be sure that it is taken before a comparison."""
    return f"({raw})" if " " in raw else raw


def digits_of(local: str, run: Digits, first: bool) -> str:
    text = local if run.divisor == 1 else f"{local} // {grouped(run.divisor)}"
    return text if first else f"{text} % {grouped(run.modulus)}"


def times(value: str, factor: int) -> str:
    return value if factor == 1 else f"{value} * {grouped(factor)}"


def moved_left(term: str, low: str) -> str:
    return term if low == "0" else f"{term} << {operand(low)}"


def number_text(value: int) -> str:
    return str(value) if value < 10 else f"0x{value:X}"


def among(value: str, values: Sequence[int]) -> str:
    return f"{value} == {number_text(values[0])}" if len(values) == 1 else f"{value} in ({', '.join(map(number_text, values))})"


def meaning_of(item: Field, may_be_missing: bool) -> str:
    texts = []
    if item.kind == "flag":
        texts.append(f"True: {item.when_active or 'active'}; False: {item.when_inactive or 'not active'}; {'low' if item.active_low else 'high'} active")
        texts.append(item.meaning)
    else:
        unit = f" ({item.unit})" if item.unit and item.unit not in item.meaning else ""
        texts.append(f"{(item.meaning or item.printed_name or item.name.replace('_', ' ')).rstrip('.')}{unit}")
    if may_be_missing:
        texts.append("0 where the encoder has none")
    texts += [_note(item), item.note]
    return " ".join(sentence(text) for text in texts if text)


def _note(item: Field) -> str:
    """What a reader should know of a field that is not there for everybody, or that others explain."""
    texts = ["Not implemented." if not item.implemented else "", f"Reserved for the {item.reserved}." if item.reserved else ""]
    texts.append(f"0 on the wire stands for {item.zero_means}." if item.zero_means else "")
    texts.append("Only powers of two." if item.power_of_two else "")
    texts.append(f"Explained by {', '.join(item.explained_by)}." if item.explained_by else "")
    return " ".join(filter(None, texts))
