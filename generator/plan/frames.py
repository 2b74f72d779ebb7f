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
from .frame_checks import bits_of
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

    The selector has the same position in all of them. ``bytes_needed`` is the number of bytes needed to read it.
    """

    sender: str
    selector: Field
    bits: FieldBits
    bytes_needed: int
    branches: tuple[SelectedFrame, ...]
    fallback: Layout | None


def dispatches(layouts: Sequence[Layout]) -> Iterator[FrameDispatch]:
    """Yield the dispatch of each sender whose frames a selector field distinguishes.

    If the first frame of a sender has no selector, every frame of this sender is decoded as the first one, and no
    dispatch is needed.
    """
    layouts_by_sender: dict[str, list[Layout]] = {}
    for layout in layouts:
        layouts_by_sender.setdefault(layout.sender, []).append(layout)
    for sender, sender_layouts in layouts_by_sender.items():
        if sender_layouts[0].selector:
            yield _dispatch_of(sender, sender_layouts)


def _dispatch_of(sender: str, layouts: Sequence[Layout]) -> FrameDispatch:
    """Return the frames of a sender with the selector values that identify each of them.

    The first frame without a selector is the fallback for all other values. Frames after the fallback are omitted,
    since no value is left for them.
    """
    branches = []
    fallback = None
    for layout in layouts:
        if not layout.selector:
            fallback = layout
            break
        branches.append(SelectedFrame(layout, layout.selects))
    # The selector has the same position in all frames.
    first_layout = layouts[0]
    selector = first_layout.field(first_layout.selector)
    last_byte = max((bit_slice.byte for bit_slice in selector.bit_slices), default=0)
    return FrameDispatch(
        sender=sender,
        selector=selector,
        bits=bits_of(first_layout, selector),
        bytes_needed=last_byte + 1,
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
    """Return the frame with which the encoder answers a request with this data ID, or None if the spec has none.

    The selector of a reply contains the data ID of its request. The result is the frame with this selector value, or
    the frame for all other values. Without a selector, it is the only frame that the encoder sends, or None if there
    are several.
    """
    for dispatch in dispatches(interface.layouts):
        if dispatch.sender != "encoder":
            continue
        for branch in dispatch.branches:
            if data_id in branch.values:
                return branch.layout
        return dispatch.fallback
    replies = [layout for layout in interface.layouts if layout.sender == "encoder"]
    return replies[0] if len(replies) == 1 else None


@dataclass(frozen=True, slots=True)
class RequestAndReply:
    """A request with its reply, or None if the encoder does not answer.

    ``repeats_first_byte`` is true if the reply begins with the first byte of the request.
    """

    exchange: Exchange
    request: Layout
    reply: Layout | None
    repeats_first_byte: bool

    @property
    def defaults(self) -> dict[str, int]:
        """Factory defaults of fields in the request, by name."""
        return {field.name: field.default for field in self.request.fields if field.default is not None}


def exchanges(interface: Interface) -> tuple[RequestAndReply, ...]:
    """Return the requests of an interface with their replies, in the order of the spec.

    The tuple is empty for SSI and BiSS, and for T-format interfaces, whose requests are data IDs.
    """
    if not isinstance(interface, (Rs485, Spi)):
        return ()
    layouts = {layout.name: layout for layout in interface.layouts}
    requests_with_replies = []
    for exchange in interface.exchanges:
        request = layouts[exchange.request]
        reply = layouts.get(exchange.reply)
        requests_with_replies.append(_exchange_with_frames(exchange, request, reply))
    return tuple(requests_with_replies)


def _exchange_with_frames(exchange: Exchange, request: Layout, reply: Layout | None) -> RequestAndReply:
    """Return a request with its reply, and with the information whether the reply repeats the request's first byte.

    It does if the same constants and fields occupy the same bits of the first byte in both frames. An example is a byte
    with a constant command in its upper half and the address in its lower half.
    """
    first_byte_of_request = _contents_of_first_byte(request)
    first_byte_of_reply = _contents_of_first_byte(reply) if reply is not None else frozenset()
    repeats_first = bool(first_byte_of_request) and first_byte_of_request == first_byte_of_reply
    return RequestAndReply(exchange=exchange, request=request, reply=reply, repeats_first_byte=repeats_first)


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
    """Return the content of each bit range in the first byte: the value of a constant, or the name of a data field.

    The set is empty if any of the 8 bits belongs to neither a constant nor a data field.
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


#: Two idle clocks, the acknowledge and the line delay precede the start bit of a BiSS frame. No manual states how
#: long an encoder takes. This is an allowance in bits, equal to 4 us at 10 MHz.
BISS_IDLE_BITS, BISS_ACKNOWLEDGE_BITS = 2, 40
#: Start bit and CDS before the data, and stop bit after the data.
BISS_START_AND_STOP_BITS = 3
#: On SSI, the line is high until the first clock has latched the position. One more clock shifts out the 0 after it.
SSI_EXTRA_BITS = 2


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of a frame for one order code: its length in bits, and the bytes of a buffer for it and the bits around it.

    ``answers`` are the user's decisions on which the length depends. ``depends_on_registers`` is true if registers
    change the length at run time. The number of bits then applies to the factory default, and the buffer is large
    enough for any register value.
    """

    variant: Variant
    layout: Layout
    frame_bits: int
    buffer_bytes: int
    depends_on_registers: bool
    answers: tuple[Answer, ...] = ()


def received_sizes(device: Device, interface: Interface) -> Iterator[FrameSize]:
    """Yield the size of each frame that the encoder sends over an interface, for each order code.

    A frame whose length depends on a question that the manual leaves open is yielded once for each answer. Nothing is
    yielded for RS-485 and SPI, where a peripheral of the microcontroller receives whole bytes or words.
    """
    bits_around = _bits_around(interface)
    if bits_around is None:
        return
    for layout in interface.layouts:
        if layout.sender == "encoder":
            yield from _sizes_of_frame(device, interface, layout, bits_around)


def _sizes_of_frame(device: Device, interface: Interface, layout: Layout, bits_around: int) -> Iterator[FrameSize]:
    """Yield the size of one frame for each order code and for each answer to a question that its length depends on.

    ``bits_around`` is the number of bits, such as start and stop bits, that a receiver stores together with the frame.
    """
    # A buffer for a data channel must have room for all channels of its frame.
    frame_of_channels = channel_frame(interface)
    is_channel = frame_of_channels is not None and layout in frame_of_channels.layouts
    whole_frame = frame_of_channels if frame_of_channels is not None and is_channel else layout
    length_parameters = device.needed_parameters(whole_frame.bits.parameters)
    register_parameters = {parameter.name for parameter in device.set_parameters if parameter.register}
    depends_on_registers = not length_parameters.isdisjoint(register_parameters)
    questions = []
    for question in device.alternatives:
        # All answers to a question set the same parameters.
        if not length_parameters.isdisjoint(question.answers[0].sets):
            questions.append(question)
    for variant, (answers, answered_parameters) in product(
        device.variants_over(interface.name), answer_combinations(questions)
    ):
        parameters = {**variant.parameters, **answered_parameters}
        longest_frame_bits = whole_frame.sent_bits.value(parameters)
        if depends_on_registers:
            longest_frame_bits = whole_frame.widest
        yield FrameSize(
            variant=variant,
            layout=layout,
            frame_bits=layout.sent_bits.value(parameters),
            buffer_bytes=(bits_around + longest_frame_bits + 7) // 8,  # rounded up
            depends_on_registers=depends_on_registers,
            answers=answers,
        )


def _bits_around(interface: Interface) -> int | None:
    """Return the number of bits before and after a frame that a receiver stores with it, such as its start bit.

    Return None for RS-485 and SPI, where a peripheral of the microcontroller receives whole bytes or words.
    """
    match interface:
        case Ssi():
            return SSI_EXTRA_BITS
        case Biss():
            return BISS_IDLE_BITS + BISS_ACKNOWLEDGE_BITS + BISS_START_AND_STOP_BITS
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
    """Identifying registers of one interface. ``is_only_interface`` is true if no other interface has any."""

    interface: str
    compared_registers: tuple[IdentityRegister, ...]
    is_only_interface: bool


def identities(device: Device) -> Iterator[Identity]:
    """Yield the registers that identify the encoder over each interface, each with its fields of documented value."""
    fields_by_interface: dict[str, dict[str, list[Field]]] = {}
    for register, field in device.identity:
        fields_by_register = fields_by_interface.setdefault(register.interface, {})
        fields_by_register.setdefault(register.name, []).append(field)
    for interface, fields_by_register in fields_by_interface.items():
        compared_registers: list[IdentityRegister] = []
        for register_name, fields in fields_by_register.items():
            compared_registers.append(IdentityRegister(device.register(register_name), tuple(fields)))
        is_alone = len(fields_by_interface) == 1
        yield Identity(interface=interface, compared_registers=tuple(compared_registers), is_only_interface=is_alone)


@dataclass(frozen=True, slots=True)
class HeldParameter:
    """A parameter in a register.

    ``meaning`` converts its bits to an unsigned number. ``lowest_valid`` and ``highest_valid`` are None if no value of
    the field can be outside them. ``highest_value`` is the highest valid one. If the parameter has codes, its bits are
    one of them, and ``lowest_valid`` and ``highest_valid`` are None.
    """

    parameter: Parameter
    field: Field
    bits: FieldBits
    meaning: UnsignedNumber | ZeroMeans
    lowest_valid: int | None
    highest_valid: int | None
    highest_value: int


@dataclass(frozen=True, slots=True)
class HoldingRegister:
    """A register, and the parameters that it holds."""

    register: Register
    parameters: tuple[HeldParameter, ...]


def held_parameters(device: Device) -> Iterator[HoldingRegister]:
    """Yield each register that holds parameters at run time, with all parameters that it holds."""
    parameters_by_register: dict[str, list[Parameter]] = {}
    for parameter in device.run_time_parameters:
        parameters_by_register.setdefault(parameter.register, []).append(parameter)
    for register_name, parameters in parameters_by_register.items():
        register = device.register(register_name)
        held_in_register = tuple(_held_parameter(register, parameter) for parameter in parameters)
        yield HoldingRegister(register=register, parameters=held_in_register)


def _held_parameter(register: Register, parameter: Parameter) -> HeldParameter:
    """Return a parameter with the bits of the register that hold it, and its limits.

    A limit is None if the parameter has none, or if the bits cannot represent a number outside it. If the register
    holds one of several codes, each of which stands for a value of the parameter, both limits are None.
    """
    field = register.layout.field(parameter.field)
    bits = bits_of(register.layout, field)
    if parameter.by_code:
        return HeldParameter(
            parameter=parameter,
            field=field,
            bits=bits,
            meaning=UnsignedNumber(),
            lowest_valid=None,
            highest_valid=None,
            highest_value=max(coded.value for coded in parameter.by_code),
        )
    meaning = _unsigned_meaning(field)
    lowest_of_bits = 0
    highest_of_bits = (1 << field.widest) - 1
    # The bits 0 then represent another number, so no value is below 1.
    if isinstance(meaning, ZeroMeans):
        lowest_of_bits = 1
        highest_of_bits = max(highest_of_bits, meaning.number)
    can_be_too_low = parameter.min is not None and parameter.min > lowest_of_bits
    can_be_too_high = parameter.max is not None and parameter.max < highest_of_bits
    low = parameter.min if can_be_too_low else None
    high = parameter.max if can_be_too_high else None
    return HeldParameter(
        parameter=parameter,
        field=field,
        bits=bits,
        meaning=meaning,
        lowest_valid=low,
        highest_valid=high,
        highest_value=highest_of_bits if high is None else high,
    )


def _unsigned_meaning(field: Field) -> UnsignedNumber | ZeroMeans:
    """Return the operation that converts the bits of a field to a parameter, which is never negative.

    The bits are an unsigned number, except that in some fields the bits 0 represent another number.
    """
    meaning = meaning_of(field)
    return meaning if isinstance(meaning, ZeroMeans) else UnsignedNumber()
