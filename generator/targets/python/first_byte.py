"""Checks of a frame that depend only on its first byte, so that a look-up of this byte is enough."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property

from ...model import BitSlice, Field
from ...plan.codec import LayoutPlan
from ...plan.operations import AlwaysIs, Check, IsOneOf, ParityIs
from ...plan.values import NamedChoice, meaning_of
from .literals import coded


class FirstByte:
    """The first byte of a frame in bytes, which can contain the selector: the field by which frames differ.

    ``enum_name_of`` returns the name of the IntEnum of a field.
    """

    def __init__(self, layout_plan: LayoutPlan, enum_name_of: Callable[[Field], str]) -> None:
        self.layout_plan = layout_plan
        self.enum_name_of = enum_name_of

    @property
    def checks(self) -> list[Check]:
        """The checks that need only the first byte."""
        return [check for check in self.layout_plan.checks if _needs_only_first_byte(check)]

    @property
    def other_checks(self) -> list[Check]:
        """The checks that need other bytes."""
        return [check for check in self.layout_plan.checks if not _needs_only_first_byte(check)]

    @cached_property
    def selectors_by_byte(self) -> dict[int, int]:
        """The value of the selector for each first byte that passes all checks, such as ``{0x1A: 3}``.

        The dict is empty if the first byte does not contain the selector.
        """
        checks = self.checks
        for check in checks:
            if isinstance(check, IsOneOf) and self._is_selector(check.field):
                valid_bytes = (byte for byte in range(256) if _passes_all(checks, byte))
                return {byte: _bits_in_byte(check.bits.bit_slices, byte) for byte in valid_bytes}
        return {}

    @property
    def selector_codes_by_byte(self) -> dict[int, str]:
        """The Python code of the selector for each valid first byte, such as ``Command.READ`` or ``3``.

        The dict is empty if the selector is not an attribute of the frame.
        """
        for decoded_field in self.layout_plan.decoded_fields:
            if self._is_selector(decoded_field.field):
                return self._codes_by_first_byte(decoded_field.field)
        return {}

    def _codes_by_first_byte(self, selector: Field) -> dict[int, str]:
        """Return the Python code of the selector by first byte: the member of its enumeration, or else a number."""
        meaning = meaning_of(selector)
        choices = meaning.values if isinstance(meaning, NamedChoice) else ()
        member_by_value = {choice.value: f"{self.enum_name_of(selector)}.{choice.name.upper()}" for choice in choices}
        code_by_byte: dict[int, str] = {}
        for byte, selector_value in self.selectors_by_byte.items():
            code_by_byte[byte] = member_by_value.get(selector_value, coded(selector_value))
        return code_by_byte

    @property
    def is_invalid(self) -> str:
        """Condition that the first byte, in the variable ``b0``, is not a valid one."""
        if self.selector_codes_by_byte:
            return "b0 not in valid_first_bytes"
        valid_bytes = [f"0x{byte:02X}" for byte in self.selectors_by_byte]
        if len(valid_bytes) == 1:
            return f"b0 != {valid_bytes[0]}"
        return f"b0 not in ({', '.join(valid_bytes)})"

    def _is_selector(self, field: Field) -> bool:
        return field.name == self.layout_plan.layout.selector


def _needs_only_first_byte(check: Check) -> bool:
    """Return whether a check compares constants, parity or listed values, all of them in the first byte."""
    if not isinstance(check, (AlwaysIs, ParityIs, IsOneOf)):
        return False
    bit_slices = list(check.bits.bit_slices)
    if isinstance(check, ParityIs):
        for covered_bits in check.covered_bits:
            bit_slices += covered_bits.bit_slices
    return bool(bit_slices) and all(bit_slice.byte == 0 for bit_slice in bit_slices)


def _passes_all(checks: Sequence[Check], first_byte: int) -> bool:
    """Return whether a frame with this first byte passes all of these checks."""
    return all(_check_passes(check, first_byte) for check in checks)


def _check_passes(check: Check, first_byte: int) -> bool:
    """Return whether a frame with this first byte passes a check that needs only the first byte."""
    checked_bits = _bits_in_byte(check.bits.bit_slices, first_byte)
    match check:
        case AlwaysIs(value=constant):
            return checked_bits == constant
        case ParityIs():
            return checked_bits == _expected_parity(check, first_byte)
        case IsOneOf(values=values):
            return checked_bits in values
        # Other checks need more than the first byte.
        case _:
            return True


def _expected_parity(check: ParityIs, first_byte: int) -> int:
    """Return the parity bit that belongs to this first byte: 1 for an odd number of ones, inverted for odd parity."""
    one_count = 0
    for covered_bits in check.covered_bits:
        covered_ones = _bits_in_byte(covered_bits.bit_slices, first_byte)
        # Bit 0 of the mask is the lowest bit of the field.
        if check.mask:
            covered_ones &= check.mask
        one_count += covered_ones.bit_count()
    # The lowest bit of the count is 1 for an odd number, and & binds more tightly than ^.
    return (one_count & 1) ^ check.odd


def _bits_in_byte(bit_slices: Iterable[BitSlice], byte: int) -> int:
    """Return the number that these slices of a byte form."""
    number = 0
    for bit_slice in bit_slices:
        bits_of_slice = (byte >> bit_slice.low_in_byte) & bit_slice.mask
        number |= bits_of_slice << bit_slice.low_in_number
    return number
