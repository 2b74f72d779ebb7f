"""Build interfaces from checked data, with one function for each kind.

Missing required keys have already been reported. Defaults replace them, so that the other keys can be checked.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ..language.problems import DocumentReport
from ..model import (
    INTERFACES,
    Alignment,
    CableLength,
    Clock,
    ControlField,
    DataChannels,
    Device,
    Exchange,
    Interface,
    Layout,
    Measurement,
    OutputCode,
    Port,
    Register,
    Spi,
    Timeout,
)
from ..model.expressions import Expression
from ..say import count_with_unit
from .fields import LayoutContext, SpecPlace, build_values
from .layouts import build_layout
from .spec_parts import Raw, build_part, sources, valid_parts_so_far


def build_interfaces(raw_spec: Raw, context: LayoutContext) -> tuple[Interface, ...]:
    return tuple(_build_interface(name, definition, context) for name, definition in raw_spec["interfaces"].items())


def _build_interface(interface_name: str, raw_interface: Raw, context: LayoutContext) -> Interface:
    """Return an interface with its valid layouts. Layouts with problems are reported and left out."""
    layouts: list[Layout] = []
    for layout_index, raw_layout in enumerate(raw_interface["layouts"]):
        layout = build_layout(
            raw_layout, SpecPlace(("interfaces", interface_name, "layouts", layout_index), context, interface_name)
        )
        if layout is not None:
            layouts.append(layout)
    if "word_bits" in raw_interface:
        _check_words(raw_interface, layouts, SpecPlace(("interfaces", interface_name), context, interface_name))
    interface_class: Callable[..., Interface] = INTERFACES[interface_name]
    built_members = _INTERFACES[interface_name](raw_interface, context)
    measurement = build_measurement(raw_interface, context)
    return build_part(interface_class, raw_interface, layouts=tuple(layouts), measurement=measurement, **built_members)


#: Lowest and highest number of bits in an SPI word.
_SPI_WORD_BITS = (8, 64)


class _Word(NamedTuple):
    """An SPI exchange from the spec, and the number of bits in its words, or None if this is not valid.

    The exchange is empty for a layout that no exchange uses.
    """

    raw_exchange: Raw
    width: Expression | None


def _check_words(raw_interface: Raw, layouts: Sequence[Layout], spec_place: SpecPlace) -> None:
    """Check that SPI words have a possible number of bits for every order code, and that their layouts have as many.

    ``word_bits`` of an exchange replaces ``word_bits`` of the interface. If several layouts all have the same number of
    bits, but ``word_bits`` is different, ``word_bits`` is the mistake, and is reported once.
    """
    default_width = _checked_word_bits(raw_interface, spec_place)
    words: list[_Word] = []
    for index, exchange in enumerate(raw_interface.get("exchanges", ())):
        word_width = default_width
        if "word_bits" in exchange:
            word_width = _checked_word_bits(exchange, spec_place, "exchanges", index)
        words.append(_Word(exchange, word_width))
    words_have_default_bits = all(word.width == default_width for word in words)
    layout_widths = {layout.bits for layout in layouts}
    layouts_agree = len(layouts) > 1 and len(layout_widths) == 1
    if default_width is not None and words_have_default_bits and layouts_agree:
        if default_width not in layout_widths:
            message = f"'word_bits' is {default_width.render()}, but every layout has {layouts[0].bits.render()} bits"
            spec_place.report("width-mismatch", f"{message}; correct 'word_bits' or the fields", "word_bits")
        return
    for layout in layouts:
        words_of_layout = [
            word for word in words if layout.name in (word.raw_exchange["request"], word.raw_exchange["reply"])
        ]
        # A layout that no exchange uses is compared with ``word_bits`` of the interface.
        _check_word_bits(layout, words_of_layout or [_Word({}, default_width)], layouts, spec_place)


def _check_word_bits(layout: Layout, words: Sequence[_Word], layouts: Sequence[Layout], spec_place: SpecPlace) -> None:
    """Report the first SPI exchange that uses a layout, but whose words have a different number of bits."""
    mismatches = [word for word in words if word.width is not None and not word.width.has_value_of(layout.bits)]
    if not mismatches:
        return
    raw_exchange, word_width = mismatches[0]
    exchange_text = ""
    remedy = "correct 'word_bits' or the fields"
    if "word_bits" in raw_exchange:
        exchange_text = f" of the exchange of '{raw_exchange['request']}'"
    elif raw_exchange:
        remedy += f", or give the exchange of '{raw_exchange['request']}' its own 'word_bits'"
    word_width_text = word_width.render() if word_width is not None else ""
    message = f"'{layout.name}' has {layout.bits.render()} bits, but 'word_bits'{exchange_text} is {word_width_text}"
    if _is_longer_than_request(layout, raw_exchange, layouts, spec_place):
        reason = "a reply that is longer than its request is not supported"
        remedy = f"{reason}, so add a constant to the request, and give the exchange their 'word_bits'"
    spec_place.report("width-mismatch", f"{message}; {remedy}", "layouts", layout.name)


def _is_longer_than_request(
    layout: Layout, raw_exchange: Raw, layouts: Sequence[Layout], spec_place: SpecPlace
) -> bool:
    """Return whether a layout is the reply of an exchange whose request has fewer bits for some order code."""
    if layout.name != raw_exchange.get("reply"):
        return False
    for request_layout in layouts:
        if request_layout.name != raw_exchange["request"]:
            continue
        for parameters in spec_place.parameter_sets:
            if request_layout.bits.value(parameters) < layout.bits.value(parameters):
                return True
    return False


def _checked_word_bits(
    interface_or_exchange: Raw, spec_place: SpecPlace, *path_of_exchange: str | int
) -> Expression | None:
    """Return ``word_bits`` of an SPI interface or exchange, after checking its range for every order code.

    Return None for an invalid expression. ``path_of_exchange`` is the path in the interface.
    """
    fewest_bits, most_bits = _SPI_WORD_BITS
    word_bits = spec_place.context.expression(interface_or_exchange.get("word_bits", fewest_bits))
    if word_bits is None:
        return None
    bit_counts = sorted({word_bits.value(parameters) for parameters in spec_place.parameter_sets})
    impossible_bit_counts = [bit_count for bit_count in bit_counts if not fewest_bits <= bit_count <= most_bits]
    if impossible_bit_counts:
        message = f"a word has {impossible_bit_counts[0]} bits, but {fewest_bits} to {most_bits} are possible"
        spec_place.report("width-mismatch", message, *path_of_exchange, "word_bits")
    return word_bits


def build_measurement(raw_owner: Raw, context: LayoutContext) -> Measurement | None:
    """Return the description of the position, such as its counts per turn, of a device or interface, or None."""
    if "measurement" not in raw_owner:
        return None
    raw_measurement = raw_owner["measurement"]
    expression_keys = ("counts_per_turn", "turns", "step_um", "step_nm", "per_counts", "modulus", "highest")
    return Measurement(
        of=raw_measurement["of"],
        source=sources(raw_measurement),
        **context.expressions(raw_measurement, expression_keys),
    )


def _build_clocks(raw_interface: Raw) -> tuple[Clock, ...]:
    """Return the clocks of an interface: one for all order codes, or several that each apply to some order codes."""
    return tuple(map(_build_clock, _as_list(raw_interface.get("clock", {}))))


def _build_clock(raw_clock: Raw) -> Clock:
    """Return a clock with its limits. The frequencies known to be in use are one number or a list in the spec."""
    used_hz = raw_clock.get("used_hz", ())
    clocks_in_use = tuple(sorted(used_hz)) if isinstance(used_hz, Sequence) else (used_hz,)
    return build_part(Clock, raw_clock, used_hz=clocks_in_use)


def _as_list(raw_or_list: Raw | Sequence[Raw]) -> Sequence[Raw]:
    """Return the value of a key that can contain one part or a list of parts, as a list."""
    return [raw_or_list] if isinstance(raw_or_list, Mapping) else raw_or_list


def _members_of_ssi(raw_interface: Raw, context: LayoutContext) -> Mapping[str, Any]:
    """Return the members of an SSI interface that are not copied from the spec, by name.

    Members without a citation have the citation of the interface.
    """
    source = sources(raw_interface)
    output_code = None
    if raw_interface.get("output_code"):
        source_of_code = sources(raw_interface, "output_code_source") or source
        output_code = OutputCode(raw_interface["output_code"], source_of_code)
    raw_cable_lengths = raw_interface.get("cable_lengths", ())
    return {
        "clocks": _build_clocks(raw_interface),
        "alignment": Alignment(
            raw_interface.get("alignment", ""), sources(raw_interface, "alignment_source") or source
        ),
        "output_code": output_code,
        "cable_lengths": tuple(
            build_part(CableLength, raw_cable_length, source=sources(raw_cable_length) or source)
            for raw_cable_length in raw_cable_lengths
        ),
    }


def _members_of_biss(raw_interface: Raw, context: LayoutContext) -> Mapping[str, Any]:
    """Return the members of a BiSS interface that are not copied from the spec, by name."""
    raw_control = raw_interface.get("control_data", {})
    raw_timeouts = _as_list(raw_interface.get("timeout", ()))
    control_fields = [
        _build_control_field(raw_field, raw_control, context) for raw_field in raw_control.get("fields", ())
    ]
    return {
        "clocks": _build_clocks(raw_interface),
        "timeouts": tuple(build_part(Timeout, raw_timeout) for raw_timeout in raw_timeouts),
        "channels": _build_channels(raw_interface, context),
        "control_data": tuple(control_fields),
        "control_data_note": raw_control.get("note", ""),
    }


def _build_channels(raw_interface: Raw, context: LayoutContext) -> DataChannels | None:
    """Return the data channels that one BiSS frame carries, or None if the spec does not list them."""
    if "channels" not in raw_interface:
        return None
    raw_channels = raw_interface["channels"]
    source = sources(raw_channels) or sources(raw_interface)
    compared_bits_member = context.expressions(raw_channels, ("compared_bits",))
    return build_part(DataChannels, {"order": (), **raw_channels}, source=source, **compared_bits_member)


def _members_of_rs485(raw_interface: Raw, context: LayoutContext) -> Mapping[str, Any]:
    """Return the members of an RS-485 interface that are not copied from the spec, by name."""
    return {
        "port": build_part(Port, {**_PORT_DEFAULTS, **raw_interface.get("port", {})}),
        "exchanges": _build_exchanges(raw_interface, context),
    }


def _members_of_spi(raw_interface: Raw, context: LayoutContext) -> Mapping[str, Any]:
    """Return the members of an SPI interface that are not copied from the spec, by name."""
    word_bits = context.expression(raw_interface.get("word_bits", _SPI_WORD_BITS[0]))
    return {
        "clocks": _build_clocks(raw_interface),
        "word_bits": word_bits,
        "exchanges": _build_exchanges(raw_interface, context),
    }


def _build_exchanges(raw_interface: Raw, context: LayoutContext) -> tuple[Exchange, ...]:
    """Return the exchanges of an interface. Without a citation, they have the citation of the interface."""
    source_of_interface = raw_interface.get("source", "")
    raw_exchanges = raw_interface.get("exchanges", ())
    return tuple(_build_exchange(raw_exchange, source_of_interface, context) for raw_exchange in raw_exchanges)


def _build_exchange(raw_exchange: Raw, source: str, context: LayoutContext) -> Exchange:
    """Return an exchange of a request and a reply. ``source`` is the citation of an exchange without its own."""
    word_bits = context.expression(raw_exchange["word_bits"]) if "word_bits" in raw_exchange else None
    return build_part(Exchange, {"source": source, **raw_exchange}, word_bits=word_bits)


#: Settings of a serial port if the manual does not give them.
_PORT_DEFAULTS = {"data_bits": 8, "parity": "none", "stop_bits": 1, "flow_control": "none"}
#: Functions that build the members of an interface that are not copied from the spec.
_INTERFACES = {"ssi": _members_of_ssi, "biss": _members_of_biss, "rs485": _members_of_rs485, "spi": _members_of_spi}


def _build_control_field(raw_field: Raw, raw_control: Raw, context: LayoutContext) -> ControlField:
    """Return a field of the BiSS control frame.

    If the spec does not give its number of bits, a CRC has the width of the CRC, and any other field has one bit.
    """
    crc = context.crc_by_name.get(raw_field.get("crc", ""))
    default_bit_count = crc.width if crc is not None else 1
    bit_count = raw_field.get("bits", default_bit_count)
    if not isinstance(bit_count, int):  # This is already reported, because the control frame has fixed widths.
        bit_count = 0
    source = sources(raw_field) or sources(raw_control)
    return build_part(ControlField, raw_field, bits=bit_count, values=build_values(raw_field), source=source)


#: Field of a frame that holds the value of a register.
_REGISTER_VALUE_FIELD = "data"


def check_spi_registers(device: Device, report: DocumentReport) -> None:
    """Report each SPI register whose length does not match its value in the frames that read or write it.

    The value is in the field ``data`` of the frames. Only the first mismatch of each register is reported.
    """
    spi = device.find_interface(Spi)
    if spi is None or not valid_parts_so_far(report).has_valid_layouts:
        return
    for register in device.registers_over(spi.name):
        frame_names = set(_frames_with_register(spi, register))
        for frame_name, value_bit_count in _widths_of_value(device, spi, frame_names):
            needed_byte_count = (value_bit_count + 7) // 8  # rounded up
            if needed_byte_count != register.length:
                register_text = f"'{register.name}' has {count_with_unit(register.length, 'byte')}"
                value_width_text = count_with_unit(value_bit_count, "bit")
                message = f"{register_text}, but '{_REGISTER_VALUE_FIELD}' in '{frame_name}' has {value_width_text}"
                remedy = "correct 'length', or describe each part as a register"
                report.add("width-mismatch", ("registers", register.name, "length"), f"{message}; {remedy}")
                break


def _frames_with_register(interface: Spi, register: Register) -> Iterator[str]:
    """Yield the names of the SPI requests and replies that can carry the value of a register."""
    for exchange in interface.exchanges:
        reads_register = exchange.purpose == "read" and register.readable
        writes_register = exchange.purpose == "write" and register.writable
        if reads_register or writes_register:
            yield exchange.request
            yield exchange.reply


def _widths_of_value(device: Device, interface: Spi, frame_names: Collection[str]) -> Iterator[tuple[str, int]]:
    """Yield the name of each of these frames, and the width of the register value in it for each order code."""
    for layout in interface.layouts:
        if layout.name not in frame_names:
            continue
        for variant in device.variants_over(interface.name):
            value_field = layout.place(variant.parameters).find_field(_REGISTER_VALUE_FIELD)
            if value_field is not None:
                yield layout.name, value_field.width
