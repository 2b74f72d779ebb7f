# Licence 0BSD: you may use, change and distribute this file without any condition.
"""BiSS frame layouts for encoders without a package, such as ``position=32,error,warning,crc=6:0x43``."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final, NamedTuple

from ..bulk.shape import Check, Column, CrcOf, FrameLayout, Join, Unused, VerdictCause, compare_bits
from ..bulk.words import quote
from ..codec import PositionRange, crc_of_bits
from ..errors import ErrorKind, UsageError
from ..reports import Verdict

_FIELDS_HELP: Final = "expected fields in the order of transmission, such as position=32,error,warning,crc=6:0x43"
#: Flags of BiSS frames, which are active at level 0, and the resulting verdict on the position.
_VERDICT_BY_FLAG: Final = {"error": Verdict.NOT_USABLE, "warning": Verdict.USABLE_WITH_WARNING}

#: Maximum number of characters in a number, which is enough for 64 bits.
_LONGEST_NUMBER: Final = 20
#: Names for bits that do not get a column.
_FILLER_NAMES: Final = ("zero", "unused")


class _Field(NamedTuple):
    """Field of a layout: its name and its width in bits. The polynomial and the start value belong to a CRC."""

    name: str
    width: int
    poly: int = 0
    init: int = 0

    def crc(self) -> Callable[[int, int], int]:
        """Return the function that computes the inverted CRC."""
        xorout = (1 << self.width) - 1
        return partial(crc_of_bits, width=self.width, poly=self.poly, init=self.init, refout=False, xorout=xorout)


class BissLayout(NamedTuple):
    """BiSS frame layout of an encoder without a package.

    Attributes:
        text: The layout as text.
        layout: Its description for ``decode_many``.
        modulus: Number of counts after which the position wraps around.
        counts_per_turn: Number of counts in one revolution. 0 if the layout does not specify it.
    """

    text: str
    layout: FrameLayout
    modulus: int
    counts_per_turn: int

    @property
    def code(self) -> str:
        """The layout as text, instead of an order code."""
        return self.text

    def __eq__(self, other: object) -> bool:
        # The functions of the CRC in ``layout`` are never equal.
        return self.text == other.text if isinstance(other, BissLayout) else NotImplemented

    def __ne__(self, other: object) -> bool:
        # The method of tuples would compare the functions.
        return not self == other

    def __hash__(self) -> int:
        return hash(self.text)

    def __reduce__(self) -> tuple[Callable[[str], BissLayout], tuple[str]]:
        """Pickle the text, because the functions of the CRC in ``layout`` cannot be pickled."""
        return biss_layout, (self.text,)

    @property
    def _unknown_size_message(self) -> str:
        """Message for a unit that needs the counts per turn, which this layout does not specify."""
        bits = self.modulus.bit_length() - 1
        return f"the layout does not give the counts per turn: use singleturn={bits} instead of position={bits}"

    def _range_in(self, frame: str, /) -> PositionRange:
        """Return the range of the position.

        All frames of a layout have the same range, whatever the name of the frame.
        """
        return PositionRange(0, self.modulus - 1, self.modulus)

    def from_turns(self, turns: float) -> int:
        """Return the count nearest to ``turns`` revolutions.

        Raises ValueError if the layout does not specify the counts per turn.
        """
        if not self.counts_per_turn:
            raise ValueError(self._unknown_size_message)
        return round(turns * self.counts_per_turn)

    def micrometres(self, counts: int) -> int:
        """Raise ValueError, because the layout of a frame does not specify the length of a count."""
        raise ValueError(self._unknown_size_message)

    def decode_many(self, frames: Any) -> Any:
        """Decode many frames into columns. Needs NumPy.

        Args:
            frames: The frames, as numbers.

        Returns:
            The columns. An error in a frame is not raised, but recorded in the column ``fault``.
        """
        from ..bulk.decode import decode_many

        return decode_many(frames, self.layout, encoder=self)


def biss_layout(text: str) -> BissLayout:
    """Return a BiSS frame layout.

    Fields are separated by commas, in the order of transmission, after CDS. ``position=32`` or ``multiturn=12`` and
    ``singleturn=24`` are numbers with their widths in bits. If all counts belong to one turn, write ``singleturn=32``
    so that degrees and speeds are known. ``error`` and ``warning`` are active-low bits. ``zero=2`` describes two bits
    that are always 0, and ``unused=2`` describes two bits without a meaning. ``crc=6:0x43`` is an inverted 6-bit CRC
    with this polynomial. The polynomial's highest bit may be omitted. ``crc=16:0x190d9:0x0`` also has a start value.
    Any other name with a width in bits is a numeric field.

    Args:
        text: The layout.

    Raises:
        UsageError: The text is not a layout.
    """
    fields = [_parse_field(field_text) for field_text in text.split(",")]
    _check_fields(fields)
    # Widths of the columns by name: ``{"singleturn": 24, "position": 24}``. The number joined from multiturn and
    # singleturn is one of them.
    widths = {field.name: field.width for field in fields if field.name not in ("crc", *_FILLER_NAMES)}
    joins: tuple[Join, ...] = ()
    if "singleturn" in widths and "position" not in widths:
        joins = (_join_position(widths),)
        widths["position"] = widths["singleturn"] + widths.get("multiturn", 0)
    return BissLayout(
        text=text,
        layout=_make_layout(fields, widths, joins),
        modulus=1 << widths.get("position", 0),
        counts_per_turn=1 << widths["singleturn"] if "singleturn" in widths else 0,
    )


def _check_fields(fields: Sequence[_Field]) -> None:
    """Raise UsageError if these fields cannot form a frame.

    Possible reasons: the length is wrong, two fields have the same name, a name is reserved, or a CRC is not the
    last field.
    """
    bits = sum(field.width for field in fields)
    names = [field.name for field in fields if field.name not in _FILLER_NAMES]
    if not 0 < bits <= 64:
        raise UsageError(f"frames of {bits} bits are not supported: expected 1 to 64")
    if len({*names}) < len(names):
        raise UsageError(f"two fields have the same name; {_FIELDS_HELP}")
    if {"verdict", "fault", "time"} & {*names}:
        raise UsageError("verdict, fault and time are names of columns that every table has")
    if "crc" in names and fields[-1].name != "crc":
        raise UsageError("the CRC must be the last field")


def _join_position(widths: Mapping[str, int]) -> Join:
    """Return the position as a number that consists of the singleturn and, if there is one, the multiturn."""
    # Name of each part, and its lowest bit in the position.
    parts = [("singleturn", 0)]
    if "multiturn" in widths:
        # The multiturn is above the singleturn.
        parts.append(("multiturn", widths["singleturn"]))
    return Join("position", tuple(parts))


def _make_layout(fields: Sequence[_Field], widths: Mapping[str, int], joins: tuple[Join, ...]) -> FrameLayout:
    """Return the description of a frame with these fields, for ``decode_many``.

    ``widths`` contains the width of each column by name, and ``joins`` contains the position if it consists of several
    fields.
    """
    bits = sum(field.width for field in fields)
    placed_fields = _place_fields(fields)
    # Without a flag, nothing says whether the position is usable.
    flags = [name for name in _VERDICT_BY_FLAG if name in widths]
    return FrameLayout(
        bits,
        columns=tuple(_make_column(field, lowest_bit) for field, lowest_bit in placed_fields if field.name in widths),
        joins=joins,
        unused=tuple(_list_unused_bits(placed_fields)),
        checks=tuple(_check_zero(field, lowest_bit) for field, lowest_bit in placed_fields if field.name == "zero"),
        crc=_find_crc(placed_fields, bits),
        position="position" if "position" in widths else "",
        default_verdict=Verdict.USABLE if flags else Verdict.UNKNOWN,
        verdict_causes=tuple(VerdictCause(_VERDICT_BY_FLAG[flag], flag) for flag in flags),
    )


class _PlacedField(NamedTuple):
    """Field and its lowest bit in the frame."""

    field: _Field
    lowest_bit: int


def _place_fields(fields: Sequence[_Field]) -> list[_PlacedField]:
    """Return the fields with their places in the frame. The first field forms the highest bits."""
    lowest_bit = sum(field.width for field in fields)
    placed_fields: list[_PlacedField] = []
    for field in fields:
        lowest_bit -= field.width
        placed_fields.append(_PlacedField(field, lowest_bit))
    return placed_fields


def _make_column(field: _Field, lowest_bit: int) -> Column:
    """Return the column of a field with a value. The flags of BiSS are active low."""
    is_flag = field.name in _VERDICT_BY_FLAG
    return Column(field.name, lowest_bit, field.width, value_kind="not_flag" if is_flag else "number")


def _check_zero(field: _Field, lowest_bit: int) -> Check:
    """Return the check that the bits of a field are 0."""
    return Check(lowest_bit, field.width, ErrorKind.CONSTANT, allowed_values=(0,))


def _list_unused_bits(placed_fields: Sequence[_PlacedField]) -> Iterator[Unused]:
    """Yield the unused bits of a frame, which are side by side in the column ``unused``."""
    bit_in_column = 0
    for field, lowest_bit in placed_fields:
        if field.name == "unused":
            yield Unused(lowest_bit, field.width, value=0, bit_in_column=bit_in_column)
            bit_in_column += field.width


def _find_crc(placed_fields: Sequence[_PlacedField], bits: int) -> CrcOf | None:
    """Return the CRC of a frame of ``bits`` bits, or None without one. It covers all bits before it."""
    for field, lowest_bit in placed_fields:
        if field.name == "crc":
            find_difference = compare_bits(field.crc(), covered=bits - field.width, width=field.width)
            return CrcOf(lowest_bit, field.width, find_difference)
    return None


def _parse_field(field_text: str) -> _Field:
    """Return the field for a part of a layout, such as ``position=32``, ``error`` or ``crc=6:0x43``.

    Raises:
        UsageError: The text is not a field.
    """
    not_a_field = UsageError(f"{quote(field_text)} is not a field; {_FIELDS_HELP}")
    name, equals_sign, numbers_text = field_text.strip().partition("=")
    is_flag = name in _VERDICT_BY_FLAG
    # Only a flag needs no width: it has 1 bit.
    if not equals_sign and not is_flag:
        raise not_a_field
    try:
        numbers = [_parse_number(number_text) for number_text in numbers_text.split(":")] if equals_sign else [1]
    except ValueError:
        raise not_a_field from None
    width, *crc_numbers = numbers
    is_name = name.isidentifier() and name.isascii()
    if not is_name or not 0 < width <= 64:
        raise not_a_field
    if is_flag and width != 1:
        raise UsageError(f"{name} is one bit, not {width}")
    if name == "crc":
        return _parse_crc_field(field_text, width, crc_numbers)
    if crc_numbers:
        raise not_a_field
    return _Field(name, width)


def _parse_crc_field(field_text: str, width: int, crc_numbers: Sequence[int]) -> _Field:
    """Return the field of a CRC. ``crc_numbers`` are its polynomial and, if it is not 0, its start value.

    ``crc=6:0x43`` has the numbers ``[0x43]``, and its field has the polynomial ``0x03``, without the highest bit.
    ``field_text`` is the field as it was written, for the error.

    Raises:
        UsageError: A number does not fit the width, the polynomial is missing or even, there are too many numbers, or
            the CRC has more than 32 bits.
    """
    polynomial_top_bit = 1 << width
    polynomial = crc_numbers[0] if crc_numbers else 0
    start_value = crc_numbers[1] if len(crc_numbers) > 1 else 0
    is_odd = bool(polynomial & 1)
    is_narrow = width <= 32
    if crc_numbers and is_narrow and not is_odd:
        reason = f"the last term of its polynomial must be 1, so {polynomial:#x} needs bit 0 set"
        raise UsageError(f"{quote(field_text)} is not a CRC: {reason}")
    # The polynomial may be written with its top bit.
    fits = polynomial < 2 * polynomial_top_bit and start_value < polynomial_top_bit
    if not is_narrow or not is_odd or not fits or len(crc_numbers) > 2:
        raise UsageError(f"{quote(field_text)} is not a CRC: expected crc=BITS:POLYNOMIAL, such as crc=6:0x43")
    return _Field("crc", width, polynomial & (polynomial_top_bit - 1), start_value)


def _parse_number(text: str) -> int:
    """Return a nonnegative number, such as ``6`` or ``0x43``. Raises ValueError for other text."""
    # Spaces around the digits are accepted. ``int`` would also accept digits of other scripts, and underscores.
    if len(text) > _LONGEST_NUMBER or not text.strip().isascii() or "_" in text:
        raise ValueError
    number = int(text, 0)
    if number < 0:
        raise ValueError
    return number
