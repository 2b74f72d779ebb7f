"""Frames and registers that identify an encoder: how to distinguish frames, replies, bits to receive, parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from ..model import (
    Answer,
    Biss,
    Constant,
    Device,
    Exchange,
    Field,
    Interface,
    Layout,
    Parameter,
    Register,
    Rs485,
    Spi,
    Ssi,
    Variant,
    answer_combinations,
    assert_never,
    channel_frame,
    member_named,
)
from ..model.record import dataclass
from .codec import bits_of
from .operations import FieldBits
from .values import UnsignedNumber, ZeroMeans, meaning_of


@dataclass(frozen=True, slots=True)
class SelectedFrame:
    """A frame, and the selector values that identify it."""

    layout: Layout
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class FrameDispatch:
    """The frames of one sender, identified by ``selector``. ``fallback`` is the frame for all other values, or None.

    The selector has the same position in all of them. ``needs`` is the number of bytes needed to read it.
    """

    sender: str
    selector: Field
    bits: FieldBits
    needs: int
    branches: tuple[SelectedFrame, ...]
    fallback: Layout | None


def dispatches(layouts: Sequence[Layout]) -> Iterator[FrameDispatch]:
    """Yield a dispatch for each sender on an interface whose frames are distinguished by a selector.

    The first frame of a sender decides. If it has no selector, every frame of the sender is decoded as the first, and
    there is nothing to distinguish.
    """
    layouts_by_sender: dict[str, list[Layout]] = {}
    for layout in layouts:
        layouts_by_sender.setdefault(layout.sender, []).append(layout)
    for sender, sender_layouts in layouts_by_sender.items():
        if sender_layouts[0].selector:
            yield _dispatch_of(sender, sender_layouts)


def _dispatch_of(sender: str, layouts: Sequence[Layout]) -> FrameDispatch:
    """Return the dispatch of a sender. The first frame without a selector is the fallback.

    Frames after the fallback are omitted, since it accepts all values that the frames before it do not.
    """
    branches = []
    fallback = None
    for layout in layouts:
        if not layout.selector:
            fallback = layout
            break
        branches.append(SelectedFrame(layout, layout.selects))
    # The selector has the same position in all frames, so the position in the first frame applies.
    selector = layouts[0].field(layouts[0].selector)
    last_byte = max((bit_slice.byte for bit_slice in selector.bit_slices), default=0)
    return FrameDispatch(
        sender=sender,
        selector=selector,
        bits=bits_of(layouts[0], selector),
        needs=last_byte + 1,
        branches=tuple(branches),
        fallback=fallback,
    )


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply. ``length`` is in bytes. ``is_xor`` is true if its last byte is the XOR of all other bytes."""

    length: int
    is_xor: bool


def reply_to(device: Device, interface: str, data_id: str) -> Reply | None:
    """Return the length and check of the encoder's reply to a request with a data ID.

    Return None if the interface has no data IDs, the spec has no frame for the reply, or its length depends on the
    order code.
    """
    rs485 = device.interface(interface)
    if not isinstance(rs485, Rs485):
        return None
    request = member_named(rs485.data_ids, data_id, "data ID")
    layout = reply_to_data_id(rs485, request.id)
    if layout is None or not layout.bits.is_constant:
        return None
    is_xor = layout.always_has_crc and all(crc.is_xor for crc in device.crcs_of(layout))
    return Reply(length=layout.bits.constant // 8, is_xor=is_xor)


def reply_to_data_id(interface: Rs485, data_id: int) -> Layout | None:
    """Return the frame with which the encoder answers a data ID, or None if the spec has none.

    It is the frame that the selector identifies by this ID, or the fallback. Without a selector, it is the only frame
    that the encoder sends. Several frames without a selector are ambiguous, so the result is None.
    """
    for dispatch in dispatches(interface.layouts):
        if dispatch.sender != "encoder":
            continue
        # The selector of a reply is the data ID of its request.
        for branch in dispatch.branches:
            if data_id in branch.values:
                return branch.layout
        return dispatch.fallback
    replies = [layout for layout in interface.layouts if layout.sender == "encoder"]
    return replies[0] if len(replies) == 1 else None


@dataclass(frozen=True, slots=True)
class RequestAndReply:
    """A request with its reply, or None if the encoder does not answer.

    ``repeats_first`` is true if the reply begins with the first byte of the request.
    """

    exchange: Exchange
    request: Layout
    reply: Layout | None
    repeats_first: bool

    @property
    def defaults(self) -> dict[str, int]:
        """Factory defaults of fields in the request, by name."""
        return {field.name: field.default for field in self.request.fields if field.default is not None}


def exchanges(interface: Interface) -> tuple[RequestAndReply, ...]:
    """Return the requests of an interface with their replies. T-format requests have data IDs instead."""
    spec_exchanges = interface.exchanges if isinstance(interface, (Rs485, Spi)) else ()
    layouts = {layout.name: layout for layout in interface.layouts}
    return tuple(_exchange_with_frames(spec, layouts[spec.request], layouts.get(spec.reply)) for spec in spec_exchanges)


def _exchange_with_frames(exchange: Exchange, request: Layout, reply: Layout | None) -> RequestAndReply:
    """Return the exchange with its frames.

    The reply repeats the first byte of the request if the same constants and fields occupy the same bits in both. An
    example is a byte with a constant command in its upper half and the address in its lower half.
    """
    first_byte_of_request = _contents_of_first_byte(request)
    first_byte_of_reply = _contents_of_first_byte(reply) if reply is not None else frozenset()
    repeats_first = bool(first_byte_of_request) and first_byte_of_request == first_byte_of_reply
    return RequestAndReply(exchange=exchange, request=request, reply=reply, repeats_first=repeats_first)


@dataclass(frozen=True, slots=True)
class _ContentOfBits:
    """Bits of a byte from ``lowest_bit`` on, as many as the ones in ``mask``.

    They are the bits of ``content``, a constant or the field with this name, from its bit ``low_in_number`` on.
    """

    lowest_bit: int
    mask: int
    low_in_number: int
    content: int | str


def _contents_of_first_byte(layout: Layout) -> frozenset[_ContentOfBits]:
    """Return the contents of the first byte, or an empty set if any of its 8 bits is neither data nor constant.

    The content is the value of a constant or the name of a data field.
    """
    contents = []
    for field in layout.fields:
        if isinstance(field.kind, Constant):
            content: int | str = field.kind.value
        elif field.carries_data:
            content = field.name
        else:
            continue
        for bit_slice in field.bit_slices:
            if bit_slice.byte == 0:
                content_of_bits = _ContentOfBits(
                    lowest_bit=bit_slice.low_in_byte,
                    mask=bit_slice.mask,
                    low_in_number=bit_slice.low_in_number,
                    content=content,
                )
                contents.append(content_of_bits)
    known_bits = sum(content_of_bits.mask.bit_count() for content_of_bits in contents)
    is_whole_byte_known = known_bits == 8
    return frozenset(contents) if is_whole_byte_known else frozenset()


#: Before the start bit of a BiSS frame come two idle clocks, the acknowledge and the line delay. No manual states how
#: long an encoder takes. This is an allowance in bits, equal to 4 us at 10 MHz.
BISS_REST, BISS_ACKNOWLEDGE = 2, 40
#: Start bit and CDS before the data, and stop bit after the data.
BISS_AROUND = 3
#: On SSI, the line is high until the first clock has latched the position. One more clock shifts out the 0 after it.
SSI_AROUND = 2


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of a frame for one order code: its length in bits, and the bytes of a buffer for it and the bits around it.

    ``answers`` are the user's decisions on which the length depends. ``depends_on_registers`` is true if registers
    change the length at run time. The number of bits then applies to the factory default, and the buffer is large
    enough for any register value.
    """

    variant: Variant
    layout: Layout
    bits: int
    bytes: int
    depends_on_registers: bool
    answers: tuple[Answer, ...] = ()


def received_sizes(device: Device, interface: Interface) -> Iterator[FrameSize]:
    """Yield the frames that the encoder sends as bits on this interface, by order code.

    A frame whose length depends on a question that the manual leaves open is yielded once for each answer. Nothing is
    yielded for an interface with a peripheral that receives bytes or words.
    """
    bits_around = _bits_around(interface)
    if bits_around is None:
        return
    register_parameters = {parameter.name for parameter in device.set_parameters if parameter.register}
    frame_of_channels = channel_frame(interface)
    for layout in interface.layouts:
        if layout.sender != "encoder":
            continue
        # A buffer for a data channel holds all channels of its frame.
        is_channel = frame_of_channels is not None and layout in frame_of_channels.layouts
        whole = frame_of_channels if frame_of_channels is not None and is_channel else layout
        length_parameters = device.needed_parameters(whole.bits.parameters)
        depends_on_registers = not length_parameters.isdisjoint(register_parameters)
        # All answers to a question set the same parameters.
        questions = []
        for question in device.alternatives:
            if not length_parameters.isdisjoint(question.answers[0].sets):
                questions.append(question)
        for variant, (answers, answered_parameters) in product(
            device.variants_over(interface.name), answer_combinations(questions)
        ):
            parameters = {**variant.parameters, **answered_parameters}
            whole_bits = whole.sent_bits.value(parameters)
            highest_bits = whole.widest if depends_on_registers else whole_bits
            yield FrameSize(
                variant=variant,
                layout=layout,
                bits=layout.sent_bits.value(parameters),
                bytes=(bits_around + highest_bits + 7) // 8,  # rounded up
                depends_on_registers=depends_on_registers,
                answers=answers,
            )


def _bits_around(interface: Interface) -> int | None:
    """Return the number of bits around a frame, or None if a peripheral receives bytes or words."""
    match interface:
        case Ssi():
            return SSI_AROUND
        case Biss():
            return BISS_REST + BISS_ACKNOWLEDGE + BISS_AROUND
        case Rs485() | Spi():
            return None
        case _:
            assert_never(interface)


@dataclass(frozen=True, slots=True)
class IdentityRegister:
    """A register, and its fields with a documented value."""

    register: Register
    fields: tuple[Field, ...]


@dataclass(frozen=True, slots=True)
class Identity:
    """Identifying registers of one interface. ``alone`` is true if no other interface has such registers."""

    interface: str
    compared: tuple[IdentityRegister, ...]
    alone: bool


def identities(device: Device) -> Iterator[Identity]:
    """Yield the identifying registers of each interface, in the order of the registers."""
    fields_by_interface: dict[str, dict[str, list[Field]]] = {}
    for register, field in device.identity:
        fields_by_register = fields_by_interface.setdefault(register.interface, {})
        fields_by_register.setdefault(register.name, []).append(field)
    for interface, fields_by_register in fields_by_interface.items():
        compared_registers: list[IdentityRegister] = []
        for register_name, fields in fields_by_register.items():
            compared_registers.append(IdentityRegister(device.register(register_name), tuple(fields)))
        is_alone = len(fields_by_interface) == 1
        yield Identity(interface=interface, compared=tuple(compared_registers), alone=is_alone)


@dataclass(frozen=True, slots=True)
class HeldParameter:
    """A parameter in a register.

    ``meaning`` converts its bits to an unsigned number. ``low`` and ``high`` are None if no value of the field can be
    outside them. ``highest_value`` is the highest valid one. If the parameter has codes, its bits are one of them, and
    ``low`` and ``high`` are None.
    """

    parameter: Parameter
    field: Field
    bits: FieldBits
    meaning: UnsignedNumber | ZeroMeans
    low: int | None
    high: int | None
    highest_value: int


@dataclass(frozen=True, slots=True)
class HoldingRegister:
    """A register, and the parameters that it holds."""

    register: Register
    parameters: tuple[HeldParameter, ...]


def held_parameters(device: Device) -> Iterator[HoldingRegister]:
    """Yield the registers that hold parameters, without duplicates."""
    parameters_by_register: dict[str, list[Parameter]] = {}
    for parameter in device.run_time_parameters:
        parameters_by_register.setdefault(parameter.register, []).append(parameter)
    for register_name, parameters in parameters_by_register.items():
        register = device.register(register_name)
        held_in_register = tuple(_held_parameter(register, parameter) for parameter in parameters)
        yield HoldingRegister(register=register, parameters=held_in_register)


def _held_parameter(register: Register, parameter: Parameter) -> HeldParameter:
    """Return a parameter with the bits of the register that hold it, and its limits.

    A limit is None if the parameter has none, if no value of the bits can exceed it, or if the bits are one of the
    parameter's codes.
    """
    field = register.layout.field(parameter.field)
    bits = bits_of(register.layout, field)
    if parameter.by_code:
        return HeldParameter(
            parameter=parameter,
            field=field,
            bits=bits,
            meaning=UnsignedNumber(),
            low=None,
            high=None,
            highest_value=max(coded.value for coded in parameter.by_code),
        )
    meaning = _unsigned_meaning(field)
    lowest_of_bits = 0
    highest_of_bits = (1 << field.widest) - 1
    # Bits that are 0 then represent another number, so no value is below 1.
    if isinstance(meaning, ZeroMeans):
        lowest_of_bits = 1
        highest_of_bits = max(highest_of_bits, meaning.number)
    # The bits can have values outside these limits.
    is_low_binding = parameter.min is not None and parameter.min > lowest_of_bits
    is_high_binding = parameter.max is not None and parameter.max < highest_of_bits
    low = parameter.min if is_low_binding else None
    high = parameter.max if is_high_binding else None
    return HeldParameter(
        parameter=parameter,
        field=field,
        bits=bits,
        meaning=meaning,
        low=low,
        high=high,
        highest_value=highest_of_bits if high is None else high,
    )


def _unsigned_meaning(field: Field) -> UnsignedNumber | ZeroMeans:
    """Return the conversion of bits to a parameter, which is never negative.

    Apart from a zero that represents another number, the bits are the number itself.
    """
    meaning = meaning_of(field)
    return meaning if isinstance(meaning, ZeroMeans) else UnsignedNumber()
