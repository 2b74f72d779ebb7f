"""Common mistakes with a frame of bytes on RS-485: other CRCs, and bytes around the frame or missing from it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ..model import (
    Constant,
    Crc,
    Device,
    Parity,
    PlacedField,
    PlacedLayout,
    Variant,
    number_from_bytes,
    number_to_bytes,
)
from ..reference.bits_and_values import bits_of_field, compute_bytes, parity_bit, reflect
from .exchanges import LEAST_EVIDENCE, usual_values_of
from .hypotheses import (
    OTHER_MESSAGE,
    TEXTS,
    WITH_SECOND_MISTAKE,
    Hypothesis,
    TypedFrame,
    check_constant_bits,
    frame_hypothesis,
)
from .other_crcs import hypothesis_without_mistake, other_crcs_over_bytes
from .other_order_codes import other_order_code_hypotheses

#: Longest request in bytes whose echo is considered. A MODBUS request that reads registers has 8.
MOST_ECHOED_BYTES = 8
#: Fewest bits of a CRC that shows that bytes are a whole message. It matches one of 65,536 random messages.
LEAST_BITS_OF_MESSAGE_CRC = 16
#: Number of values of a byte.
BYTE_VALUES = 256


def byte_hypotheses(
    device: Device, variant: Variant, sender: str, expected_layout: PlacedLayout | None, received_bytes: bytes
) -> Iterator[Hypothesis]:
    """Yield hypotheses, each with one mistake that could have turned a valid frame into ``received_bytes``.

    All frames of the sender that are sent as bytes are considered if their CRC, if any, consists of whole bytes.
    Different CRC parameters are tried only for ``expected_layout``, the layout that the bytes should have, or None if
    it is unknown.
    """
    expected_name = expected_layout.name if expected_layout is not None else None
    for layout in device.interface(variant.interface).layouts:
        if layout.sender != sender or not layout.in_bytes:
            continue
        placed_layout = layout.place(variant.parameters)
        crc = device.crc_of(placed_layout)
        if crc is not None and not is_whole_bytes(crc):
            continue
        is_expected_layout = placed_layout.name == expected_name
        has_frame_length = 8 * len(received_bytes) == placed_layout.bits
        if crc is not None and is_expected_layout and has_frame_length:
            yield from _other_crc_hypotheses(placed_layout, crc, received_bytes)
        if crc is not None and not has_frame_length and _shows_whole_message(crc, received_bytes):
            yield _other_message_hypothesis(placed_layout, crc, received_bytes)
        if crc is None:
            number = number_from_bytes(layout, received_bytes)
            typed_frame = TypedFrame(number, bits=8 * len(received_bytes), is_length_known=True)
            yield from other_order_code_hypotheses(device, variant, placed_layout, typed_frame)
        usual_values = usual_values_of(device, variant.interface, layout)
        first_bytes = tuple(_possible_first_bytes(placed_layout, usual_values))
        yield from _displaced_byte_hypotheses(placed_layout, crc, received_bytes, first_bytes)


def is_whole_bytes(crc: Crc) -> bool:
    """Return whether a CRC consists of whole bytes. Mistakes in bytes with another CRC are not looked for."""
    return crc.width % 8 == 0


def is_valid_in_bytes(device: Device, placed_layout: PlacedLayout, received_bytes: bytes) -> bool:
    """Return whether bytes are a valid frame with a CRC of whole bytes.

    Its CRC, constants, parity and selector are correct.
    """
    crc = device.crc_of(placed_layout)
    if crc is None or not is_whole_bytes(crc):
        return False
    return _frame_hypothesis(kind="", description="", placed_layout=placed_layout, crc=crc, frame=received_bytes).fits


def _other_crc_hypotheses(placed_layout: PlacedLayout, crc: Crc, frame: bytes) -> Iterator[Hypothesis]:
    """Yield hypotheses in which the CRC has different parameters or swapped bytes, or does not cover the first byte."""
    frame_number = number_from_bytes(placed_layout.layout, frame)
    hypothesis = hypothesis_without_mistake(placed_layout, crc, frame_number)
    without_mistake = _with_crc_over_bytes(hypothesis, placed_layout, crc, frame)
    crc_length = crc.width // 8
    has_byte_order = crc_length > 1
    swapped_crc = int.from_bytes(without_mistake.received_crc.to_bytes(crc_length, "little"), "big")
    if has_byte_order:
        description = TEXTS["crc_bytes_swapped"]
        yield replace(without_mistake, kind="crc_bytes_swapped", description=description, received_crc=swapped_crc)
        reversed_crc = reflect(without_mistake.received_crc, crc.width)
        yield replace(
            without_mistake, kind="crc_reversed", description=TEXTS["crc_reversed"], received_crc=reversed_crc
        )
    for kind, description, other_crc in other_crcs_over_bytes(crc):
        with_other_crc = replace(without_mistake, kind=kind, description=description, crc=other_crc)
        yield with_other_crc
        if has_byte_order and kind == "other_polynomial":
            swapped_description = TEXTS["and_swapped"].format(description)
            yield replace(with_other_crc, description=swapped_description, received_crc=swapped_crc)
    bytes_without_first_and_crc = frame[1:-crc_length]
    has_byte_before_crc = len(frame) > crc_length
    if has_byte_before_crc:
        yield replace(
            without_mistake,
            kind="first_byte_left_out",
            description=TEXTS["first_byte_left_out"],
            covered_data=int.from_bytes(bytes_without_first_and_crc, "big"),
            covered_bits=8 * len(bytes_without_first_and_crc),
        )


def _shows_whole_message(crc: Crc, received_bytes: bytes) -> bool:
    """Return whether a correct CRC would show that bytes are a whole message, whatever its length is.

    The CRC has at least 16 bits. Its start value is not 0, because otherwise missing or extra zeros do not change it.
    """
    has_data = len(received_bytes) > crc.width // 8
    return has_data and crc.width >= LEAST_BITS_OF_MESSAGE_CRC and crc.init != 0


def _other_message_hypothesis(placed_layout: PlacedLayout, crc: Crc, received_bytes: bytes) -> Hypothesis:
    """Return the hypothesis that bytes are a whole message of another length, with the same CRC at its end."""
    data = received_bytes[: -crc.width // 8]
    crc_bytes = received_bytes[len(data) :]
    bytes_before_crc = bytes(placed_layout.bits // 8 - len(crc_bytes))
    frame_with_crc = number_from_bytes(placed_layout.layout, bytes_before_crc + crc_bytes)
    return Hypothesis(
        kind=OTHER_MESSAGE,
        description=TEXTS["other_message"],
        crc=crc,
        covered_data=int.from_bytes(data, "big"),
        covered_bits=8 * len(data),
        received_crc=_received_crc(placed_layout, frame_with_crc),
        received_crc_bits=crc.width,
        is_crc_over_bytes=True,
    )


def _displaced_byte_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, received_bytes: bytes, first_bytes: Sequence[int]
) -> Iterator[Hypothesis]:
    """Yield hypotheses in which extra bytes surround the frame, one of its bytes is missing, or bits are changed.

    Up to 8 bytes may precede or follow the frame, such as an echoed request. If the first byte is missing, an extra
    byte may follow the frame. ``first_bytes`` are the possible values of a missing first byte.
    """
    extra_bytes = len(received_bytes) - placed_layout.bits // 8
    missing_first_byte = partial(
        _missing_first_byte_hypotheses, placed_layout=placed_layout, crc=crc, first_bytes=first_bytes
    )
    if 0 < extra_bytes <= MOST_ECHOED_BYTES:
        yield from _extra_byte_hypotheses(placed_layout, crc, received_bytes)
    if extra_bytes == -1:
        yield from missing_first_byte(received_bytes=received_bytes, template=TEXTS["byte_missing"])
        if crc is not None and crc.width > 8:
            yield _missing_last_byte_hypothesis(placed_layout, crc, received_bytes)
    if extra_bytes == 0:
        # The first byte is missing, and a byte follows the frame, so the length is right.
        template = TEXTS["and_follows"].format(TEXTS["byte_missing"])
        yield from missing_first_byte(received_bytes=received_bytes[:-1], template=template)
        yield from _changed_bit_hypotheses(placed_layout, crc, received_bytes)


def _extra_byte_hypotheses(placed_layout: PlacedLayout, crc: Crc | None, received_bytes: bytes) -> Iterator[Hypothesis]:
    """Yield the hypotheses that all extra bytes precede the frame, and that they follow it."""
    frame_length = placed_layout.bits // 8
    extra_bytes = len(received_bytes) - frame_length
    counted_bytes = TEXTS["extra_bytes" if extra_bytes > 1 else "extra_byte"].format(extra_bytes)
    yield _frame_hypothesis(
        kind="bytes_in_front",
        description=TEXTS["before"].format(counted_bytes),
        placed_layout=placed_layout,
        crc=crc,
        frame=received_bytes[extra_bytes:],
    )
    yield _frame_hypothesis(
        kind="bytes_behind",
        description=TEXTS["after"].format(counted_bytes),
        placed_layout=placed_layout,
        crc=crc,
        frame=received_bytes[:frame_length],
    )


def _changed_bit_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, received_bytes: bytes
) -> Iterator[Hypothesis]:
    """Yield the hypotheses that all bits are inverted, and that the bits of each byte are in reverse order.

    The bytes of the CRC may be swapped too.
    """
    inverted_bytes = bytes(byte ^ 0xFF for byte in received_bytes)
    reversed_bytes = bytes(reflect(byte, 8) for byte in received_bytes)
    for kind, description, frame in (
        ("all_inverted", TEXTS["bytes_inverted"], inverted_bytes),
        ("bits_reversed_in_bytes", TEXTS["bits_reversed_in_bytes"], reversed_bytes),
    ):
        yield _frame_hypothesis(kind, description, placed_layout, crc, frame)
        if crc is not None and crc.width > 8:
            crc_length = crc.width // 8
            frame_with_swapped_crc = frame[:-crc_length] + frame[-crc_length:][::-1]
            description_of_both = TEXTS["and_crc_bytes_swapped"].format(description)
            hypothesis = _frame_hypothesis(kind, description_of_both, placed_layout, crc, frame_with_swapped_crc)
            yield replace(hypothesis, relative_frequency=WITH_SECOND_MISTAKE)


def _missing_first_byte_hypotheses(
    placed_layout: PlacedLayout, crc: Crc | None, received_bytes: bytes, first_bytes: Sequence[int], template: str
) -> Iterator[Hypothesis]:
    """Yield hypotheses with each possible first byte before the received bytes.

    ``{0}`` in ``template`` is replaced by the byte. Its bits are assumed, so they prove nothing. Any other first byte
    is searched too, such as another address, if the CRC and the constants have enough bits to show that it is missing.
    """
    assumed_bits = _constant_bits_in_first_byte(placed_layout)

    def with_first_byte(first_byte: int) -> Hypothesis:
        hypothesis = _frame_hypothesis(
            kind="first_byte_lost",
            description=template.format(f"{first_byte:02X}"),
            placed_layout=placed_layout,
            crc=crc,
            frame=bytes([first_byte]) + received_bytes,
        )
        return replace(hypothesis, template=template)

    for first_byte in first_bytes:
        hypothesis = with_first_byte(first_byte)
        yield replace(hypothesis, determined_bits=hypothesis.determined_bits - assumed_bits)
    if crc is None:
        return
    # One of the 256 bytes always fits 8 bits of the CRC, so these bits prove nothing.
    evidence_bits = crc.width - 8 + _constant_bits(placed_layout) - assumed_bits
    if evidence_bits >= LEAST_EVIDENCE:
        searched_byte = _find_first_byte(placed_layout, crc, received_bytes)
        if searched_byte not in first_bytes:
            yield replace(with_first_byte(searched_byte), searched_places=BYTE_VALUES)


def _find_first_byte(placed_layout: PlacedLayout, crc: Crc, received_bytes: bytes) -> int:
    """Return the first byte with which the CRC of a frame is correct, or 0 if there is none.

    A CRC is linear: each bit of the first byte inverts certain bits of the CRC, whatever the other bits are.
    """
    frame_number = number_from_bytes(placed_layout.layout, b"\0" + received_bytes)
    data = received_bytes[: -crc.width // 8]
    crc_with_byte_0 = compute_bytes(crc, b"\0" + data)
    crc_bits_to_invert = _received_crc(placed_layout, frame_number) ^ crc_with_byte_0
    # The bits of the CRC that each bit of the first byte inverts.
    inverted_by_bit = [compute_bytes(crc, bytes([1 << bit]) + data) ^ crc_with_byte_0 for bit in range(8)]
    for first_byte in range(BYTE_VALUES):
        inverted_crc_bits = 0
        for bit, inverted_by_this_bit in enumerate(inverted_by_bit):
            if (first_byte >> bit) & 1:
                inverted_crc_bits ^= inverted_by_this_bit
        if inverted_crc_bits == crc_bits_to_invert:
            return first_byte
    return 0


def _missing_last_byte_hypothesis(placed_layout: PlacedLayout, crc: Crc, received_bytes: bytes) -> Hypothesis:
    """Return the hypothesis that the last byte of a frame, which belongs to a CRC of several bytes, is missing.

    The missing byte is assumed to be correct, so only the other bytes of the CRC are compared.
    """
    data = received_bytes[: -(crc.width // 8 - 1)]
    assert placed_layout.crc_field is not None
    frame_number = compute_bytes(crc, data) << placed_layout.crc_field.lowest_bit
    last_byte = number_to_bytes(placed_layout.layout, frame_number, placed_layout.bits)[-1:]
    hypothesis = _frame_hypothesis(
        kind="last_bits_missing",
        description=TEXTS["last_byte_missing"],
        placed_layout=placed_layout,
        crc=crc,
        frame=received_bytes + last_byte,
    )
    return replace(hypothesis, searched_places=BYTE_VALUES)


def _constant_bits(placed_layout: PlacedLayout) -> int:
    """Return how many bits of a frame are constants, parity bits or determined by the selector."""
    constant_bits, _ = check_constant_bits(placed_layout, frame=0)
    return constant_bits


def _constant_bits_in_first_byte(placed_layout: PlacedLayout) -> int:
    """Return how many bits of the constants, parity bits and selector of a frame are in its first byte."""
    first_byte_mask = _first_byte_mask(placed_layout)
    fields_after_first_byte = [
        field for field in placed_layout.fields if not (first_byte_mask >> field.lowest_bit) & field.mask
    ]
    layout_without_first_byte = replace(placed_layout, fields=tuple(fields_after_first_byte))
    return _constant_bits(placed_layout) - _constant_bits(layout_without_first_byte)


def _first_byte_mask(placed_layout: PlacedLayout) -> int:
    """Return the mask of the first byte in the frame as a number."""
    bytes_after_first = bytes(placed_layout.bits // 8 - 1)
    return number_from_bytes(placed_layout.layout, b"\xff" + bytes_after_first)


def _frame_hypothesis(
    kind: str, description: str, placed_layout: PlacedLayout, crc: Crc | None, frame: bytes
) -> Hypothesis:
    """Return the hypothesis that the encoder sent ``frame``, whose last bytes are the CRC if there is one.

    ``kind`` and ``description`` name the mistake that changed the frame.
    """
    frame_number = number_from_bytes(placed_layout.layout, frame)
    hypothesis = frame_hypothesis(
        kind=kind, description=description, placed_layout=placed_layout, crc=crc, frame=frame_number
    )
    return hypothesis if crc is None else _with_crc_over_bytes(hypothesis, placed_layout, crc, frame)


def _with_crc_over_bytes(hypothesis: Hypothesis, placed_layout: PlacedLayout, crc: Crc, frame: bytes) -> Hypothesis:
    """Return the hypothesis with the CRC computed over the bytes as they are sent, whatever the byte order of numbers.

    The last bytes of the frame are the CRC, and it covers all other bytes.
    """
    data = frame[: -crc.width // 8]
    frame_number = number_from_bytes(placed_layout.layout, frame)
    return replace(
        hypothesis,
        covered_data=int.from_bytes(data, "big"),
        covered_bits=8 * len(data),
        received_crc=_received_crc(placed_layout, frame_number),
        is_crc_over_bytes=True,
    )


def _received_crc(placed_layout: PlacedLayout, frame: int) -> int:
    """Return the CRC in a frame."""
    assert placed_layout.crc_field is not None
    return bits_of_field(placed_layout.crc_field, frame)


def _possible_first_bytes(placed_layout: PlacedLayout, usual_values: Mapping[str, Sequence[int]]) -> Iterator[int]:
    """Yield the values that the first byte of a frame can have: one for each valid value of the selector.

    The selector is the field that identifies the frame. Without a selector in this byte, there is a single value.
    Nothing is yielded if the byte also contains fields that can vary. ``usual_values`` are the values that a field
    usually has, by its name, such as the address of the encoder.
    """
    layout = placed_layout.layout
    first_byte_mask = _first_byte_mask(placed_layout)
    fields_in_first_byte = [
        field for field in placed_layout.fields if (first_byte_mask >> field.lowest_bit) & field.mask
    ]
    frame_without_selector = 0
    parity_fields: list[PlacedField] = []
    for field in fields_in_first_byte:
        field_kind = field.field.kind
        values_of_field = usual_values.get(field.name, ())
        if field.name == layout.selector:
            continue
        if isinstance(field_kind, Parity):
            parity_fields.append(field)
        elif isinstance(field_kind, Constant):
            frame_without_selector |= field_kind.value << field.lowest_bit
        elif len(values_of_field) == 1:
            frame_without_selector |= values_of_field[0] << field.lowest_bit
        else:
            return
    selector_fields = [field for field in fields_in_first_byte if field.name == layout.selector]
    selector_values = layout.selects if selector_fields else (0,)
    for selector_value in selector_values:
        frame_number = frame_without_selector
        for field in selector_fields:
            frame_number |= selector_value << field.lowest_bit
        # Parity bits are set last, because they depend on the other bits.
        for field in parity_fields:
            assert isinstance(field.field.kind, Parity)
            frame_number |= parity_bit(placed_layout, field.field.kind, frame_number) << field.lowest_bit
        yield number_to_bytes(layout, frame_number, placed_layout.bits)[0]
