"""Statements about order codes and interfaces: parts, parameters, labels, clock, port and times."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from ..model import (
    Alignment,
    BankSelect,
    Biss,
    CableLength,
    Clock,
    CodePart,
    CodeValue,
    ControlField,
    DataChannels,
    DataId,
    DescriptionFile,
    Device,
    Exchange,
    Fact,
    Interface,
    MemoryAccess,
    Network,
    OutputCode,
    Parameter,
    Port,
    Profile,
    Rs485,
    Signals,
    Spelling,
    Spi,
    Ssi,
    Timeout,
    Timing,
    WordFormat,
    assert_never,
)
from ..model.expressions import Expression
from ..model.order_codes import Restricted
from . import count_with_unit, group_digits
from .errata import describe_erratum, errata_affecting
from .names_and_evidence import hexadecimal, name_in_words, printed_name_of, register_at, register_field
from .names_and_evidence import register_reference as reference_to_register
from .register import describe_range, describe_value
from .text import (
    CodeText,
    Reference,
    Statement,
    TextPart,
    as_sentence,
    hertz,
    join_groups,
    list_parts,
    printed_timeout_words,
    spec_text,
    statement,
    time_text,
    timeout_words,
)


def describe_order_code(device: Device) -> Iterator[Statement]:
    """Yield all statements about the order codes of a family."""
    order_code = device.order_code
    yield statement(CodeText(order_code.pattern), label="Order codes", source=order_code.source)
    for code_part in order_code.parts:
        yield describe_part(code_part)
        yield from open_values(code_part)
    yield from map(describe_spelling, order_code.also_written)
    yield from not_on_label(device)
    yield from spec_text(order_code.note)
    yield from spec_text(order_code.special)
    yield from map(describe_erratum, errata_affecting(device, "order_code", "parameters"))


def not_on_label(device: Device) -> Iterator[Statement]:
    """Yield what labels show instead of the order codes, if the order codes are made up. Otherwise, yield nothing."""
    yield from spec_text(device.order_code.not_on_label, label="Made-up order code")


def describe_part(code_part: CodePart) -> Statement:
    """Return a part of the order code with its values: ``Output: A = SSI; B = BiSS``."""
    values = join_groups([_value_with_meaning(value) for value in code_part.values], "; ")
    return statement(f"{code_part.meaning}: ", *values, label=code_part.name)


def _value_with_meaning(value: CodeValue) -> tuple[TextPart, ...]:
    """Return a value in the order code, with its meaning if the spec states one: ``A = SSI``."""
    return (CodeText(value.text), f" = {value.meaning}") if value.meaning else (CodeText(value.text),)


def open_values(code_part: CodePart) -> Iterator[Statement]:
    """Yield which unlisted values a part of the order code accepts, or nothing if it accepts only listed values."""
    if code_part.open.isalnum():
        yield statement("The value ", CodeText(code_part.open), " is also accepted, and shown as unlisted")
    elif code_part.open:
        pattern = CodeText(code_part.open)
        yield statement("Other values that match the pattern ", pattern, " are accepted and shown as unlisted")


def describe_spelling(label_spelling: Spelling) -> Statement:
    """Return the pattern of another spelling of the order code on labels, and where it is used."""
    where_used = f", as in {label_spelling.where}"
    return statement(CodeText(label_spelling.pattern), where_used, label="Also written", source=label_spelling.source)


def describe_parameter(device: Device, parameter: Parameter) -> Iterator[Statement]:
    """Yield the meaning of a parameter (a quantity such as ``position_bits``), its unit, and what sets it."""
    yield from spec_text(parameter.meaning, source=parameter.source)
    yield from spec_text(parameter.unit, label="Unit")
    yield from parameter_origin(device, parameter)


def parameter_origin(device: Device, parameter: Parameter) -> Iterator[Statement]:
    """Yield what sets a parameter: an expression of other parameters, a choice of the user, or a register.

    Nothing is yielded if the order code sets it.
    """
    if parameter.equals is not None:
        yield statement("It equals ", parameter.equals)
    if parameter.alternative:
        yield statement("It is set by your choice of ", *_choice_with_values(device, parameter))
    if parameter.read_from:
        register_text = register_at(device.register(parameter.register))
        field_reference = register_field(device, parameter.read_from)
        origin_parts: list[TextPart] = [f"It is read at run time from {register_text} (", field_reference, ")"]
        lowest_value = Expression(parameter.min) if parameter.min is not None else None
        highest_value = Expression(parameter.max) if parameter.max is not None else None
        range_parts = describe_range(lowest_value, highest_value)
        # A register that holds a code has a list of its values instead, which follows.
        if range_parts and not parameter.by_code:
            origin_parts += [", ", *range_parts]
        yield statement(*origin_parts)
    if parameter.by_code:
        code_meanings = []
        for coded_value in parameter.by_code:
            value_text = parameter_value(parameter, coded_value.value)
            code_meanings.append(f"{coded_value.code} means {value_text}")
        yield statement(f"The register holds a code: {', '.join(code_meanings)}")


def _choice_with_values(device: Device, parameter: Parameter) -> Iterator[TextPart]:
    """Yield a reference to the alternative (an open question) that sets a parameter, and the value for each answer.

    The values follow only if the alternative has a default: ``first_bit: 0 for low (default), 1 for high``.
    """
    alternative_name = parameter.alternative
    yield Reference("alternative", alternative_name, alternative_name)
    # Only alternatives with a default are optional.
    for alternative in device.optional_alternatives:
        if alternative.name != alternative_name:
            continue
        default_answer, *other_answers = alternative.answers
        yield f": {default_answer.sets[parameter.name]} for "
        yield CodeText(default_answer.name)
        yield " (default)"
        for answer in other_answers:
            yield f", {answer.sets[parameter.name]} for "
            yield CodeText(answer.name)


def words_for_initial_values(device: Device) -> str:
    """Return the phrase for the values that parameters have until the registers that hold them are read.

    They are ``factory defaults`` or, if none of the registers has a known default, ``values of the order code``.
    """
    register_names = {parameter.register for parameter in device.run_time_parameters}
    # A device of one interface lacks the registers of other interfaces.
    defaults = [register.default for register in device.registers if register.name in register_names]
    has_only_unknown_defaults = bool(defaults) and all(default is None for default in defaults)
    return "values of the order code" if has_only_unknown_defaults else "factory defaults"


def parameter_value(parameter: Parameter, value: int) -> str:
    """Return a value of a parameter as text: ``4,096``, or ``3Fh`` for an ID or another code in hexadecimal."""
    return hexadecimal(value) if parameter.hexadecimal else group_digits(value)


def describe_timing(timing: Timing) -> Statement:
    """Return a time with its limits, meaning and order codes, labelled with its symbol in the manual or its name."""
    meaning_text = f": {timing.meaning}" if timing.meaning else ""
    label = timing.symbol or timing.name
    return statement(_limits_text(timing), f"{meaning_text}{_only_with(timing)}", label=label, source=timing.source)


def bounds_with_codes(timing: Timing) -> str:
    """Return the limits of a time and the order codes it applies to, such as ``at least 12 µs (only with X-24)``.

    The order codes are omitted if the time applies to all of them.
    """
    return f"{_limits_text(timing)}{_only_with(timing)}"


def _only_with(fact: Restricted) -> str:
    """Return the order codes that a fact applies to, such as `` (only with X-24)``, or "" if it applies to all."""
    return f" (only with {fact.only})" if fact.only else ""


def _limits_text(timing: Timing) -> str:
    """Return the limits of a time and its typical value, such as ``at least 12 µs, typically 20 µs``."""
    limit_texts = []
    if timing.at_least_us is not None:
        limit_texts.append(f"at least {time_text(timing.at_least_us)}")
    if timing.typical_us is not None:
        limit_texts.append(f"typically {time_text(timing.typical_us)}")
    if timing.at_most_us is not None:
        limit_texts.append(f"at most {time_text(timing.at_most_us)}")
    return ", ".join(limit_texts)


_ALIGNMENT_IN_WORDS = {
    "msb_left": "left: the most significant bit comes with the first clock, and zeros follow the word",
    "lsb_right": "right: zeros come before the word",
}
#: Clauses for the word in which an encoder replies over SPI.
REPLIES = {
    "same_word": "each reply is in the same word as its request",
    "next_word": "each reply is in the word after its request",
}
_CODING_IN_WORDS = {"binary": "binary", "gray": "Gray", "by_order_code": "binary or Gray, by order code"}


#: Verb phrases for what a request does, by its purpose.
PURPOSES = {"position": "requests the position", "read": "reads a register", "write": "writes a register", "other": ""}

#: What a T-format request asks for, by its purpose.
_REQUESTED = {"capture": "data", "write": "a write", "read": "a read", "reset": "a reset"}


def describe_interface(device: Device, interface: Interface) -> Iterator[Statement]:
    """Yield all statements about an interface except its title and its errata."""
    yield from spec_text(interface.note)
    yield from describe_interface_facts(device, interface)


def describe_interface_facts(device: Device, interface: Interface) -> Iterator[Statement]:
    """Yield the settings and times of an interface, and the requests or control data that are sent over it, if any."""
    yield from describe_settings(device, interface)
    yield from map(describe_timing, interface.timings)
    match interface:
        case Ssi():
            pass
        case Biss():
            yield from spec_text(interface.control_data_note, label="Control data")
            yield from map(describe_control_field, interface.control_data)
        case Rs485():
            yield from map(describe_data_id, interface.data_ids)
            yield from map(describe_memory_access, interface.memory_access)
            yield from map(describe_exchange, interface.exchanges)
        case Spi():
            yield from map(describe_exchange, interface.exchanges)
        case _:
            assert_never(interface)


def describe_settings(device: Device, interface: Interface) -> Iterator[Statement]:
    """Yield the settings and electrical characteristics of an interface, each with a label such as ``Clock``."""
    for fact in interface.facts():
        label, content = _label_and_content(device, fact)
        yield statement(content, label=label, source=fact.source)


def _label_and_content(device: Device, fact: Fact) -> tuple[str, TextPart]:
    """Return a fact about an interface as a label and its text, such as ``Clock`` and ``100 kHz to 4 MHz``."""
    match fact:
        case Clock():
            return "Clock", f"{clock_words(fact)}{_only_with(fact)}"
        case CableLength(shorter_than_m=metres):
            limit = f"{fact.limit_words} {hertz(fact.limit_hz)}"
            return "Clock", f"{limit} with cables shorter than {metres} m{_only_with(fact)}"
        case BankSelect(register):
            return "Bank select", reference_to_register(device, register)
        case Network():
            return "Network", _network_words(fact)
        case DataChannels():
            return "Data channels", _channel_words(fact)
        case Timeout():
            return "Timeout", f"{_timeout_with_examples(fact)}{_only_with(fact)}"
        case Port():
            return "Baud rate", _port_words(fact)
        case WordFormat():
            return "Words", _word_format_words(fact)
        case Signals() | Alignment() | OutputCode() | Profile() | DescriptionFile():
            return _label_and_text(fact)
        case _:
            return assert_never(fact)


def _label_and_text(fact: Signals | Alignment | OutputCode | Profile | DescriptionFile) -> tuple[str, str]:
    """Return a label and a text for a fact that is a single word or text in the spec, such as ``Code`` and ``Gray``."""
    match fact:
        case Signals(text):
            return "Signals", text
        case Alignment(end):
            return "Alignment", _ALIGNMENT_IN_WORDS[end]
        case OutputCode(code):
            return "Code", _CODING_IN_WORDS[code]
        case Profile(text):
            return "Profile", text
        case DescriptionFile(text):
            return "Description file", f"{text}, which the manufacturer supplies"


def timeouts_with_codes(timeouts: Sequence[Timeout]) -> str:
    """Return the timeouts of an interface, each with the order codes it applies to, or "" if there are none."""
    return "; ".join(f"{timeout_words(timeout)}{_only_with(timeout)}" for timeout in timeouts)


def clock_words(clock: Clock) -> str:
    """Return the limits of a clock, such as ``100 kHz to 4 MHz``, or ``not known``.

    If the spec lists clocks in use, these follow, and then the limits that are not known: ``up to 5 MHz, 1 MHz is in
    use, the lowest clock is not known``.
    """
    range_text = _clock_range(clock.min_hz, clock.max_hz)
    if not clock.used_hz:
        return range_text or "not known"
    clauses = [range_text, clocks_in_use(clock.used_hz), unknown_limits(clock)]
    return ", ".join(clause for clause in clauses if clause)


def _clock_range(lowest_hz: int | None, highest_hz: int | None) -> str:
    """Return the limits of a clock in Hz as text, such as ``100 kHz to 4 MHz``, or "" if neither is known (None)."""
    if lowest_hz is not None and highest_hz is not None:
        return f"{hertz(lowest_hz)} to {hertz(highest_hz)}"
    if lowest_hz is not None:
        return f"at least {hertz(lowest_hz)}"
    return f"up to {hertz(highest_hz)}" if highest_hz is not None else ""


def clocks_in_use(clocks_hz: Sequence[int]) -> str:
    """Return a clause about the clocks in Hz that programs or masters use, such as "1 MHz and 5 MHz are in use"."""
    clocks_and_separators = map(str, list_parts([hertz(clock_hz) for clock_hz in clocks_hz]))
    clocks_text = "".join(clocks_and_separators)
    verb = "is" if len(clocks_hz) == 1 else "are"
    return f"{clocks_text} {verb} in use"


def unknown_limits(clock: Clock) -> str:
    """Return a clause about the limits of a clock that are not known, or "" if both are known."""
    if not clock.has_limits:
        return "the limits are not known"
    if clock.min_hz is None:
        return "the lowest clock is not known"
    if clock.max_hz is None:
        return "the highest clock is not known"
    return ""


def _word_format_words(word_format: WordFormat) -> str:
    """Return the lengths of SPI words, the clock mode, and which word contains the encoder's reply."""
    # Bit 1 of an SPI mode is the polarity of the clock, and bit 0 its phase.
    polarity = word_format.mode >> 1
    phase = word_format.mode & 1
    idle_level = "high" if polarity else "low"
    edge = "second" if phase else "first"
    clock_text = f"SPI mode {word_format.mode} (the clock idles {idle_level}, data is taken on the {edge} edge)"
    return f"{word_lengths(word_format.lengths)}, {clock_text}, {REPLIES[word_format.reply]}"


def word_lengths(bit_counts: Iterable[Expression]) -> str:
    """Return the possible lengths of a word as text, such as ``16 or 32 bits``."""
    return f"{' or '.join(bit_count.render() for bit_count in bit_counts)} bits"


def _timeout_with_examples(timeout: Timeout) -> str:
    """Return the rule for a timeout, followed in parentheses by the examples that the manual calculates from it.

    If the rule is not a number of clock periods, it already contains the printed values.
    """
    rule = timeout_words(timeout)
    if timeout.half_clock_periods is None or not timeout.printed:
        return rule
    printed_timeouts = ", ".join(map(printed_timeout_words, timeout.printed))
    return f"{rule} ({printed_timeouts})"


def _port_words(port: Port) -> str:
    """Return the settings of a serial port, such as ``115,200 Bd, 8 data bits, no parity, 1 stop bit, …``."""
    parity_text = f"{port.parity.replace('none', 'no')} parity"
    flow_control_text = f"{port.flow_control.replace('none', 'no')} flow control"
    stop_bits_text = count_with_unit(port.stop_bits, "stop bit")
    bits_text = f"{port.data_bits} data bits, {parity_text}, {stop_bits_text}"
    return f"{group_digits(port.baud)} Bd, {bits_text}, {flow_control_text}"


def _network_words(network: Network) -> str:
    """Return the topology of a network and the number of slaves, such as ``point to point, one slave only``."""
    slaves_text = "several slaves allowed" if network.multiple_slaves else "one slave only"
    return f"{network.topology.replace('_', ' ')}, {slaves_text}"


def _channel_words(channels: DataChannels) -> str:
    """Return the order of the data channels in a frame, and which of their bits must agree."""
    order_text = f"{' and '.join(channels.order)} in one frame, in this order"
    if channels.compared_bits is None:
        return order_text
    compared_fields = [f"{field_name} of {layout_name}" for layout_name, field_name in channels.compared.items()]
    bit_count = channels.compared_bits.render()
    tolerance_text = f", with a difference of at most {channels.tolerance}" if channels.tolerance else ""
    return f"{order_text}. The highest {bit_count} bits of {' and '.join(compared_fields)} must agree{tolerance_text}"


def describe_data_id(request: DataId) -> Statement:
    """Return the control field of a T-format request, its purpose and its meaning, labelled with its data ID."""
    if request.purpose == "capture" and request.meaning:
        purpose_and_meaning = f", requests data: {request.meaning}"
    elif request.meaning:
        # The meaning is a sentence, such as "Write one byte to the EEPROM".
        purpose_and_meaning = f". {request.meaning}"
    else:
        purpose_and_meaning = f", requests {_REQUESTED[request.purpose]}"
    return statement(
        f"control field {request.control:02X}h{purpose_and_meaning}",
        label=f"Data ID {request.id:X}",
        source=request.source,
    )


def describe_memory_access(access: MemoryAccess) -> Statement:
    """Return the meaning of one kind of memory access, and what its reply has as address and data."""
    text = f"{as_sentence(access.meaning)} Address: {access.address}. Data: {access.data}"
    return statement(text, label=f"Memory {access.access}, busy {access.busy}", source=access.source)


def describe_exchange(request: Exchange) -> Statement:
    """Return a request with its reply and its effect, and the length of their words if the spec states one."""
    exchange_parts: list[TextPart] = [CodeText(request.request)]
    if request.reply:
        exchange_parts += [" is answered by ", CodeText(request.reply)]
    else:
        exchange_parts.append(" has no reply")
    effect_clause = PURPOSES[request.purpose]
    if effect_clause:
        exchange_parts.append(f", and {effect_clause}")
    if request.word_bits is not None:
        exchange_parts.append(f", in words of {word_lengths([request.word_bits])}")
    return statement(*exchange_parts, source=request.source)


def describe_control_field(field: ControlField) -> Statement:
    """Return the width, the meaning and the named values of a field in the BiSS control frame."""
    width_and_meaning = count_with_unit(field.bits, "bit")
    if field.meaning:
        width_and_meaning += f": {field.meaning}"
    parts_of_values = [describe_value(named_value, field.bits).parts for named_value in field.values]
    all_parts = join_groups([(width_and_meaning,), *parts_of_values], "; ")
    label = printed_name_of(field) or name_in_words(field.name)
    return statement(*all_parts, label=label, source=field.source)
