"""A decoder in C: its checks, and the expressions that extract the members of a struct."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...model import Field, assert_never
from ...model.record import dataclass
from ...plan.codec import ShiftedBits, characters, is_plain_flag
from ...plan.operations import AlwaysIs, Check, FieldBits, FieldToDecode, JoinedNumber, ParityIs, ZerosAbove
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
)
from ...say.names_and_places import name_in_words
from .bits import digits
from .names import (
    CCall,
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    c_name,
    join_operands,
    masked,
    unsigned,
)
from .structs import LayoutStruct

#: Names of arguments and locals in the generated functions. The locals of fields have different names.
_NAMES_OF_LOCALS = frozenset("variant word received plain bytes length out in crc index v wide value flags".split())


@dataclass(frozen=True, slots=True)
class ConstantByte:
    """A byte whose bits under ``mask`` never change. ``reasons`` contains the names of its constant fields."""

    byte: int
    mask: int
    value: int
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FlagsIn:
    """The byte of the next flags. ``is_first`` and ``is_only`` show whether there are other such bytes."""

    byte: int
    is_first: bool
    is_only: bool


@dataclass(frozen=True, slots=True)
class UnusedIn:
    """A byte with unused bits, at its position in the member. The first byte initialises the local variable."""

    bits: CExpression
    is_first: bool


@dataclass(frozen=True, slots=True)
class UnusedAre:
    """All unused bits."""

    bits: CExpression


#: Masks of the odd and the even bits in the lower 32 bits of a word.
_ODD_BITS, _EVEN_BITS = 0xAAAAAAAA, 0x55555555


class CDecoder:
    """The operations of a decoder in order, and the expressions in them."""

    def __init__(self, struct: LayoutStruct) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.reader = struct.reader
        self._plain_flags = {part.field.name for part in self.plan.parts if is_plain_flag(part)}
        #: For each parity bit that is checked in the word: the mask of it and of all bits that it covers.
        self._word_parities: dict[str, int] = {}
        #: Fields that a check needs in a local.
        checked_names: set[str] = set()
        for check in self.plan.checks:
            if isinstance(check, ZerosAbove):
                checked_names.add(check.field.name)
            if isinstance(check, ParityIs):
                mask = self._mask_in_word(check)
                if mask:
                    self._word_parities[check.field.name] = mask
                else:
                    checked_names.update(covered.name for covered in check.of)
        self._only_reported = {reserved.field.name for reserved in self.plan.reserved} - checked_names

    def local(self, field: Field) -> CExpression:
        """Return the local that holds the bits of a field."""
        return CName(c_name(field.name, _NAMES_OF_LOCALS))

    @property
    def fields_with_local(self) -> tuple[Field, ...]:
        """The fields whose bits the decoder keeps in a local.

        Those without one are constants, CRCs, texts, unused fields that are only reported, and parity bits that are
        checked in the word. Flags that no join and no parity uses are tested in place, in their byte or in the word.
        """
        names_without_local = self._plain_flags | self._only_reported | self.plan.constants.keys()
        names_without_local |= self._word_parities.keys()
        names_without_local |= {part.field.name for part in self.plan.parts if isinstance(part.meaning, Latin1Text)}
        names_without_local |= {crc.field.name for crc in self.plan.crcs}
        return tuple(field for field in self.plan.layout.fields if field.name not in names_without_local)

    def raw(self, field: Field) -> tuple[str, CExpression]:
        """Return the type and the bits of a field, such as ``uint8_t`` and ``(uint8_t)(bytes[1] >> 4)``."""
        return self.reader.value(self.plan.bits_of(field.name))

    def bits_as_sent(self, field: Field) -> CExpression:
        """Return the bits of a field before any Gray code is converted."""
        return self.reader.bits_as_sent(field)

    # -- errors

    @property
    def parities_in_word(self) -> tuple[ParityIs, ...]:
        """The parity bits that are checked in the word one by one, before any field of it is extracted."""
        pair = self.parity_pair_in_word
        return tuple(parity for parity in self._checked_in_word if parity not in pair)

    @property
    def parity_pair_in_word(self) -> tuple[ParityIs, ...]:
        """The two parity bits over odd and over even bits of the word, which are checked together. Empty if none."""
        masks = [self._word_parities[parity.field.name] for parity in self._checked_in_word]
        have_same_parity = len({parity.odd for parity in self._checked_in_word}) == 1
        if len(masks) != 2 or not have_same_parity:
            return ()
        first_mask, second_mask = masks
        is_pair = not (first_mask & _EVEN_BITS or second_mask & _ODD_BITS)
        is_swapped_pair = not (first_mask & _ODD_BITS or second_mask & _EVEN_BITS)
        return self._checked_in_word if is_pair or is_swapped_pair else ()

    @property
    def _checked_in_word(self) -> tuple[ParityIs, ...]:
        parities = (check for check in self.plan.checks if isinstance(check, ParityIs))
        return tuple(parity for parity in parities if parity.field.name in self._word_parities)

    @property
    def checks(self) -> Iterator[Check | ConstantByte]:
        """The checks in order: constants, parity bits, parity bits of the selector, and then values.

        In bytes, constants are checked byte by byte, after the zeros above fields. A parity bit of the selector is
        checked together with the selector, which then has no check of its own. Those that are checked in the word are
        not among them.
        """
        checks = self.plan.checks
        parities = [check for check in checks if isinstance(check, ParityIs)]
        # A parity is known if it covers only the selector, which has one value in this frame.
        parities_of_selector = [parity for parity in parities if parity.known_parity is not None]
        unknown_parities = [parity for parity in parities if parity.known_parity is None]
        other_parities = [parity for parity in unknown_parities if parity.field.name not in self._word_parities]
        selector_names = {parity.selector.name for parity in parities_of_selector}
        if self.plan.by_word:
            yield from (check for check in checks if isinstance(check, AlwaysIs))
        else:
            yield from (check for check in checks if isinstance(check, ZerosAbove) and check.may_reach)
            yield from _constant_bytes(checks)
        yield from other_parities
        yield from parities_of_selector
        for check in checks:
            is_of_value = not isinstance(check, (AlwaysIs, ZerosAbove, ParityIs))
            if is_of_value and check.field.name not in selector_names:
                yield check

    def is_of_other_frame(self, parity: ParityIs) -> CExpression:
        """Return the condition that the selector or its parity bit differs from this frame's.

        A byte that holds both is compared once, together with the constants in it, such as
        ``(bytes[0] & 0x9FU) != 0x1AU``.
        """
        assert parity.known_parity is not None
        # A known parity covers a single field with a single value: here the selector, with the value of this frame.
        (selected_value,) = self.plan.layout.selects
        (selector_bits,) = parity.of_bits
        bit_slices = [(bit_slice, selected_value) for bit_slice in selector_bits.bit_slices]
        bit_slices += [(bit_slice, parity.known_parity) for bit_slice in parity.bits.bit_slices]
        bytes_of_pieces = {bit_slice.byte for bit_slice, _ in bit_slices}
        if self.plan.by_word or len(bytes_of_pieces) != 1:
            return self._selector_or_parity_differs(parity, parity.known_parity)
        (byte,) = bytes_of_pieces
        mask = 0
        expected_value = 0
        # The constants of the byte were checked before. Comparing them again can complete the mask to 0xFF, so that
        # the byte needs no mask. There is at most one constant for each byte.
        for constant in _constant_bytes(self.plan.checks):
            if constant.byte == byte:
                mask = constant.mask
                expected_value = constant.value
        for bit_slice, number in bit_slices:
            mask |= bit_slice.mask << bit_slice.low_in_byte
            expected_value |= ((number >> bit_slice.low_in_number) & bit_slice.mask) << bit_slice.low_in_byte
        whole_byte = CName(f"bytes[{byte}]")
        compared_bits = masked(whole_byte, mask) if mask != 0xFF else whole_byte
        return COperation("!=", (compared_bits, CNumber(expected_value, hexadecimal=True)))

    def _selector_or_parity_differs(self, parity: ParityIs, known_parity: int) -> CExpression:
        """Return the condition that the local of the selector or of its parity bit has another value."""
        selects = self.plan.layout.selects
        selector = parity.selector
        other_value = self.struct.is_none_of(selector, self.local(selector), selects, is_raw=True)
        other_parity = COperation("!=", (self.local(parity.field), CNumber(known_parity)))
        return join_operands("||", (other_value, other_parity))

    def _mask_in_word(self, parity: ParityIs) -> int:
        """Return the mask of a parity bit and all bits that it covers, or 0 if it cannot be checked by such a mask.

        The frame must be a word without Gray code, in which these bits are the same for all order codes, registers and
        answers, and are in the lower 32 bits. A selector with a known parity is compared instead.
        """
        if not self.plan.by_word or self.plan.gray is not None or parity.known_parity is not None:
            return 0
        all_bits = (parity.bits, *parity.of_bits)
        parameters = {name for bits in all_bits for name in (*bits.low.parameters, *bits.width.parameters)}
        if not parameters.isdisjoint(self._names_beyond_codes()):
            return 0
        masks = {_mask_for_code(parity, variant.parameters) for variant in self.struct.device.variants}
        mask = masks.pop()
        # If all order codes have the same mask, no further mask remains in the set.
        is_same_for_all_codes = not masks
        return mask if is_same_for_all_codes and mask.bit_length() <= 32 else 0

    def _names_beyond_codes(self) -> set[str]:
        """Return the names of the parameters that need more than an order code."""
        device = self.struct.device
        names = {parameter.name for parameter in device.run_time_parameters}
        for alternative in device.alternatives:
            names |= alternative.answers[0].sets.keys()
        return names

    def parity_in_word(self, parity: ParityIs) -> CExpression:
        """Return the parity of a parity bit in the word and all bits that it covers."""
        mask = self._word_parities[parity.field.name]
        return CCall("cw_parity", (masked(self.reader.lower(32), mask),))

    def parities_in_word_together(self, parities: Sequence[ParityIs]) -> CExpression:
        """Return the parities of the odd and of the even bits in the word that two parity bits cover."""
        mask = 0
        for parity in parities:
            mask |= self._word_parities[parity.field.name]
        return CCall("cw_parities", (masked(self.reader.lower(32), mask),))

    def parity(self, fields: Sequence[Field], mask: int) -> CExpression:
        """Return the parity of these fields, or of their bits in ``mask`` if it is not 0."""
        if self.plan.parity_covers_gray:
            return self.reader.parity_as_sent(fields, mask)
        return self.reader.parity([(self.local(field), field.widest) for field in fields], mask)

    # -- members

    @property
    def fill_operations(self) -> Iterator[FlagsIn | FieldToDecode | JoinedNumber | UnusedIn | UnusedAre]:
        """The operations that fill the members, in order. Unused bits are taken from a byte together with its flags."""
        unused = self.struct.unused
        # The unused bits of each byte that no operation has taken yet. It shrinks in the calls below.
        ungathered = {bits.byte: bits for bits in unused.moved if bits.byte is not None}
        for operation in self._parts_and_wholes():
            yield operation
            if isinstance(operation, FlagsIn) and operation.byte in ungathered:
                yield from self._gather_unused(ungathered, operation.byte, CName("flags"))
        for byte in tuple(ungathered):
            yield from self._gather_unused(ungathered, byte, CName(f"bytes[{byte}]"))
        if unused and (self.plan.by_word or unused.single):
            yield UnusedAre(unused.member)

    def _gather_unused(
        self, ungathered: dict[int, ShiftedBits], byte: int, bits_of_byte: CExpression
    ) -> Iterator[UnusedIn | UnusedAre]:
        """Yield the unused bits of a byte, and after the last such byte the whole member.

        The byte is removed from ``ungathered``, which contains the unused bits of each remaining byte.
        """
        unused = self.struct.unused
        # None of the bytes has been removed.
        is_first = len(ungathered) == len(unused.moved)
        moved = ungathered.pop(byte)
        is_only_byte = len(unused.moved) == 1
        if is_only_byte:
            yield UnusedAre(unused.member_from(bits_of_byte))
            return
        yield UnusedIn(unused.at_place(moved, bits_of_byte), is_first=is_first)
        if not ungathered:
            yield UnusedAre(unused.member_from(CName("unused")))

    def _parts_and_wholes(self) -> Iterator[FlagsIn | FieldToDecode | JoinedNumber]:
        """Yield all parts and joins. The byte of adjacent flags comes before the first of them."""
        flags_in = self._first_flags_of_bytes()
        for part in self.plan.parts:
            if part.field.name in flags_in:
                yield flags_in[part.field.name]
            yield part
        yield from self.plan.joined_numbers

    def _first_flags_of_bytes(self) -> dict[str, FlagsIn]:
        """Return the bytes of flags, by the name of the first flag of each run of flags in the same byte.

        A byte occurs again if flags of another byte are between its flags.
        """
        byte_by_first_flag: dict[str, int] = {}
        previous_byte = -1
        for part in self.plan.parts:
            if is_plain_flag(part) and not self.plan.by_word:
                byte = part.bits.bit_slices[0].byte
                if byte != previous_byte:
                    byte_by_first_flag[part.field.name] = byte
                previous_byte = byte
        is_only = len(byte_by_first_flag) == 1
        flags_in: dict[str, FlagsIn] = {}
        for name, byte in byte_by_first_flag.items():
            is_first = not flags_in
            flags_in[name] = FlagsIn(byte, is_first=is_first, is_only=is_only)
        return flags_in

    def members(self, part: FieldToDecode) -> Iterator[tuple[str, CExpression]]:
        """Yield the members that a part fills, each with its value, such as ``error`` and ``(flags & 0x80U) != 0U``."""
        name = c_name(part.field.name)
        bits = self.local(part.field)
        type_ = self.struct.type_of(part.field)
        match part.meaning:
            case UnsignedNumber() | NamedChoice():
                yield name, self._bits_as(type_, part)
            case TwosComplement():
                width = self.struct.scope.expression_of(part.field.width)
                yield name, CCast(type_, CCall("cw_signed", (bits, width)))
            case ZeroMeans(number):
                is_zero = COperation("==", (bits, CNumber(0)))
                yield name, CCast(type_, Conditional(is_zero, CNumber(number), bits))
            case ActiveFlag(low):
                bit = self.reader.flag(part.bits) if is_plain_flag(part) else bits
                is_active = self._is_active(part, bit, low_is_active=low)
                yield name, CName(is_active.operand)
            case DecimalDigits(runs):
                yield name, self._bits_as(type_, part)
                for run in runs:
                    highest_of_run = run.modulus - 1
                    type_of_run = unsigned(highest_of_run.bit_length())
                    yield c_name(run.name), CCast(type_of_run, digits(bits, part.field, run))
            case Latin1Text():
                for index, byte in characters(part.field):
                    yield f"{name}[{index}]", CCast(type_, CName(f"bytes[{byte}]"))
            case never:
                assert_never(never)

    def _is_active(self, part: FieldToDecode, bit: CExpression, *, low_is_active: bool) -> CExpression:
        """Return the condition that a flag is active. A flag that does not exist for the order code is inactive.

        An active-low flag of which only some order codes have the bit is compared with its width, which is 1 or 0.
        """
        if low_is_active and not part.field.width.is_constant:
            return COperation("!=", (bit, self.struct.scope.expression_of(part.field.width)))
        operator = "==" if low_is_active else "!="
        return COperation(operator, (bit, CNumber(0)))

    def _bits_as(self, type_: str, part: FieldToDecode) -> CExpression:
        """Return the bits of a part, with a cast if the member has another type."""
        bits = self.local(part.field)
        type_of_local, _ = self.raw(part.field)
        return bits if type_of_local == type_ else CCast(type_, bits)

    def is_fixed(self, field: Field) -> bool:
        """Return True if a field always has the same bits."""
        return field.name in self.plan.constants

    def number_of_join(self, joined_number: JoinedNumber) -> CExpression:
        return self.reader.number_of_join(joined_number, self.local)


def _constant_bytes(checks: Iterable[Check]) -> list[ConstantByte]:
    """Return the bytes with constant bits, in order, each with the mask and the value of all its constants."""
    constant_bytes: dict[int, ConstantByte] = {}
    for check in checks:
        name = name_in_words(check.field.name)
        match check:
            case ZerosAbove(beyond=pieces_beyond):
                for bit_slice in pieces_beyond:
                    constant_bytes[bit_slice.byte] = ConstantByte(
                        bit_slice.byte, mask=0xFF, value=0, reasons=(f"above {name}",)
                    )
            case AlwaysIs(bits=bits, value=constant):
                for bit_slice in bits.bit_slices:
                    # Bit ``low_in_number`` of the number is bit ``low_in_byte`` of the byte.
                    value_in_byte = ((constant >> bit_slice.low_in_number) & bit_slice.mask) << bit_slice.low_in_byte
                    # The constants that earlier checks have in the same byte.
                    earlier = constant_bytes.get(
                        bit_slice.byte, ConstantByte(bit_slice.byte, mask=0, value=0, reasons=())
                    )
                    constant_bytes[bit_slice.byte] = ConstantByte(
                        bit_slice.byte,
                        mask=earlier.mask | (bit_slice.mask << bit_slice.low_in_byte),
                        value=earlier.value | value_in_byte,
                        reasons=tuple(dict.fromkeys((*earlier.reasons, name))),
                    )
    return [constant_bytes[byte] for byte in sorted(constant_bytes)]


def _mask_for_code(parity: ParityIs, parameters: Mapping[str, int]) -> int:
    """Return the mask, in the word of an order code, of a parity bit and of all bits that it covers."""
    word_mask = _bits_mask(parity.bits, parameters, 0)
    for bits in parity.of_bits:
        word_mask |= _bits_mask(bits, parameters, parity.mask)
    return word_mask


def _bits_mask(bits: FieldBits, parameters: Mapping[str, int], mask: int) -> int:
    """Return the mask of bits in the word, or of the bits in ``mask`` if it is not 0.

    ``mask`` is relative to the lowest of the bits: at bit 8, a mask of 0b11 becomes 0x300.
    """
    all_bits = (1 << bits.width.value(parameters)) - 1
    selected_bits = all_bits & mask if mask else all_bits
    return selected_bits << bits.low.value(parameters)
