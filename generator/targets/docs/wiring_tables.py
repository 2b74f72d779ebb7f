"""Tables on the page of an order code: pins and wires, the supply, and the clock by cable length."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ...masters.encoder_facts import CableTable, cable_table
from ...model import (
    Biss,
    Clock,
    Connector,
    Contact,
    Device,
    Interface,
    Layout,
    Rs485,
    Spi,
    Ssi,
    Supply,
    Variant,
    answer_combinations,
    assert_never,
)
from ...model.order_codes import applies_to_code
from ...model.record import dataclass
from ...say import count_with_unit
from ...say.names_and_evidence import Topic, mentions, word_for_document
from ...say.order_code import bounds_with_codes, clock_words, describe_settings
from ...say.text import (
    MARKDOWN,
    anchor_of,
    as_sentence,
    citation,
    code_span,
    escape,
    hertz,
    markdown_link,
    nanoseconds,
    timeout_words,
    volts,
)

Row = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Wiring:
    """Table of contacts and signals.

    ``about`` lists the connectors and cables in each column, and ``notes`` the sentences that apply to all of them.
    ``errata`` are the paths in the spec whose errata are about these connectors.
    """

    head: tuple[str, ...]
    rows: tuple[Row, ...]
    about: tuple[str, ...]
    notes: tuple[str, ...]
    errata: tuple[str, ...]


def wiring_table(device: Device, order_codes: Sequence[str]) -> Wiring:
    """Return a table with a row for each signal, and a column for each connector or cable.

    Connectors with mostly the same contacts share a column.
    """
    connectors_by_column = _connectors_by_column(device.connectors, order_codes)
    column_heads = _column_heads(connectors_by_column)
    contacts = [contact for connector in device.connectors for contact in connector.contacts]
    # Each signal only once, in the order of its first contact.
    signals = dict.fromkeys(_signal_cell(contact, order_codes) for contact in contacts)
    texts_about_columns = []
    for head, connectors in zip(column_heads, connectors_by_column, strict=True):
        titles = ", or ".join(map(_anchored_title, connectors))
        texts_about_columns.append(f"{head}: {titles}")
    return Wiring(
        head=(*column_heads, "Signal"),
        rows=tuple(_build_row(connectors_by_column, signal, order_codes) for signal in signals),
        about=tuple(texts_about_columns),
        notes=tuple(_common_sentences(device.connectors)),
        errata=tuple(f"connectors.{connector.name}" for connector in device.connectors),
    )


def _column_heads(columns: Sequence[Sequence[Connector]]) -> list[str]:
    """Return the head of each column: ``Pin`` or ``Wire`` or, if several columns would have it, a connector's name."""
    words_for_contacts = [_word_for_contact(column[0]) for column in columns]
    heads = _short_names([column[0].title for column in columns])
    for index, word in enumerate(words_for_contacts):
        if words_for_contacts.count(word) == 1:
            heads[index] = word
    return heads


def _word_for_contact(connector: Connector) -> str:
    """Return the word for a contact of a connector or cable."""
    return "Wire" if connector.kind == "cable" else "Pin"


def _build_row(columns: Sequence[Sequence[Connector]], signal: str, order_codes: Sequence[str]) -> Row:
    """Return a row of the contacts in each column and their signal, such as ``("3", "wh", "CLOCK+")``."""
    contact_cells = [_contacts_cell(column, signal, order_codes) for column in columns]
    return (*contact_cells, signal)


def _common_sentences(connectors: Sequence[Connector]) -> list[str]:
    """Return the sentences that the notes on all connectors have in common."""
    notes_in_sentences = [connector.note.rstrip(".").split(". ") for connector in connectors]
    if not notes_in_sentences:
        return []
    first_note, *other_notes = notes_in_sentences
    common_sentences = []
    for note_sentence in first_note:
        is_common = all(note_sentence in other_note for other_note in other_notes)
        if note_sentence and is_common:
            common_sentences.append(escape(as_sentence(note_sentence)))
    return common_sentences


def _connectors_by_column(connectors: Sequence[Connector], order_codes: Sequence[str]) -> list[list[Connector]]:
    """Return the connectors of each column.

    A connector joins the first column whose first connector has mostly the same contacts.
    """
    columns: list[list[Connector]] = []
    for connector in connectors:
        for column in columns:
            if _have_similar_contacts(connector, column[0], order_codes):
                column.append(connector)
                break
        else:
            columns.append([connector])
    return columns


def _have_similar_contacts(connector: Connector, other_connector: Connector, order_codes: Sequence[str]) -> bool:
    """Return whether two connectors are of one kind and have mostly the same contacts.

    They do if they agree on more than half of the signals of the connector that has fewer signals.
    """
    contacts_by_signal = _contacts_by_signal(connector, order_codes)
    other_contacts_by_signal = _contacts_by_signal(other_connector, order_codes)
    equal_signals = [
        signal
        for signal in other_contacts_by_signal
        if contacts_by_signal.get(signal) == other_contacts_by_signal[signal]
    ]
    fewest_signals = min(len(contacts_by_signal), len(other_contacts_by_signal))
    are_mostly_equal = 2 * len(equal_signals) > fewest_signals
    return connector.kind == other_connector.kind and are_mostly_equal


def _contacts_by_signal(connector: Connector, order_codes: Sequence[str]) -> dict[str, list[str]]:
    """Return the contacts of a connector for each signal. The keys are the table cells of the signals."""
    contacts_by_signal: dict[str, list[str]] = {}
    for contact in connector.contacts:
        contacts_by_signal.setdefault(_signal_cell(contact, order_codes), []).append(contact.contact)
    return contacts_by_signal


def _signal_cell(contact: Contact, order_codes: Sequence[str]) -> str:
    """Return the signal of a contact in Markdown.

    If only some order codes have the contact, their patterns follow, as far as they match one of ``order_codes``.
    """
    if not contact.only:
        return escape(contact.signal)
    matching_patterns = []
    # ``only`` is a list of patterns of order codes, such as "X-*-24, X-*-25".
    for pattern in contact.only.split(", "):
        if any(applies_to_code(pattern, order_code) for order_code in order_codes):
            matching_patterns.append(pattern)
    return f"{escape(contact.signal)} <small>(only {escape(', '.join(matching_patterns))})</small>"


def _contacts_cell(connectors: Sequence[Connector], signal: str, order_codes: Sequence[str]) -> str:
    """Return the contacts of a signal for the connectors of a column.

    If they differ between the connectors, each list is followed by the name of its connector: ``3 (M12), 7 (M23)``.
    """
    contact_lists = []
    for connector in connectors:
        contacts = _contacts_by_signal(connector, order_codes).get(signal, [])
        contact_lists.append(_contact_list(contacts))
    if len(set(contact_lists)) == 1:
        return escape(contact_lists[0])
    connector_names = _short_names([connector.title for connector in connectors])
    lists_with_names = []
    for contact_list, connector_name in zip(contact_lists, connector_names, strict=True):
        if contact_list:
            lists_with_names.append(f"{contact_list} ({connector_name})")
    return escape(", ".join(lists_with_names))


def _short_names(titles: Sequence[str]) -> list[str]:
    """Return for each title the first words that distinguish it from the others, such as M12, or 8 pins.

    A number alone does not count. If no words distinguish all titles, the names are ``connector 1`` and so on.
    """
    titles_in_phrases = [title.split(", ") for title in titles]
    # First compare the first phrases of all titles, then the second phrases.
    for phrases in zip(*titles_in_phrases, strict=False):
        phrases_in_words = [phrase.split() for phrase in phrases]
        longest = max(map(len, phrases_in_words))
        for word_count in range(1, longest + 1):
            short_names = [" ".join(phrase_words[:word_count]) for phrase_words in phrases_in_words]
            are_unique = len(set(short_names)) == len(short_names)
            has_number = any(name.isdecimal() for name in short_names)
            if are_unique and not has_number:
                return short_names
    return [f"connector {index}" for index, _ in enumerate(titles, 1)]


def _contact_list(contacts: Sequence[str]) -> str:
    """Return contacts as a list, or as a range if they are three or more consecutive numbers: ``3 to 6``."""
    numbers = [int(contact) for contact in contacts if contact.isdecimal()]
    has_only_numbers = len(numbers) == len(contacts)
    if has_only_numbers and len(numbers) > 2:
        first, last = numbers[0], numbers[-1]
        if numbers == list(range(first, last + 1)):
            return f"{first} to {last}"
    return ", ".join(contacts)


def _anchored_title(connector: Connector) -> str:
    """Return the title of a connector with the anchor for links to it."""
    return f"{anchor_of(f'connector-{connector.name}')}{escape(connector.title)}"


def supply_lines(device: Device, variants: Sequence[Variant]) -> list[str]:
    """Return each supply with its source and its order codes, which are omitted if there is only one supply.

    Order codes whose supply is unknown are ignored.
    """
    codes_by_supply: dict[str, list[str]] = {}
    for variant in variants:
        variant_supply = device.supply_of(variant)
        if variant_supply is not None:
            codes_by_supply.setdefault(_supply_text(variant_supply), []).append(variant.code)
    if len(codes_by_supply) == 1:
        return list(codes_by_supply)
    lines = []
    for supply_text, codes in codes_by_supply.items():
        listed_codes = ", ".join(map(code_span, codes))
        lines.append(f"{supply_text} with {listed_codes}")
    return lines


def _supply_text(supply: Supply) -> str:
    """Return the limits of a supply with their source: ``4.75 V to 5.25 V (§4.1)``."""
    return f"{volts(supply.min_mv)} to {volts(supply.max_mv)} ({citation(supply.source)})"


def unstated_facts(family_device: Device, interface: Interface, topic_by_label: Mapping[str, Topic]) -> Iterator[str]:
    """Yield one line about facts that the spec has no place for, or nothing without labels.

    ``topic_by_label`` has the topic to look for, by the label of the fact. If no text of the family mentions a topic,
    the line says that the manual does not state it. Otherwise, it links to the texts that may.
    """
    sentences = []
    unmentioned_labels = []
    mentioned_labels = []
    for label, topic in topic_by_label.items():
        if mentions(family_device, interface, topic):
            mentioned_labels.append(label)
        else:
            unmentioned_labels.append(label)
    if unmentioned_labels:
        unmentioned_facts = " or the ".join(unmentioned_labels)
        sentences.append(f"The {word_for_document(family_device)} does not state the {unmentioned_facts}.")
    if mentioned_labels:
        mentioned_facts = " and the ".join(mentioned_labels)
        section_links = [markdown_link("times", "#timings")]
        if family_device.characteristics:
            section_links.append(markdown_link("characteristics", "hardware.md#characteristics"))
        sentences.append(f"For the {mentioned_facts}, see {' and '.join(section_links)}.")
    if sentences:
        yield " ".join(sentences)


def no_leds(family_device: Device, device: Device, interface: Interface) -> str:
    """Return the sentence that the manual describes no LEDs, or "" if it does or may describe some.

    It may if a text mentions LEDs, or if the spec does not cover a whole manual.
    """
    if device.leds or word_for_document(family_device) != "manual":
        return ""
    if family_device.leds:
        return "The manual describes no LEDs of this order code."
    return "" if mentions(family_device, interface, Topic.LEDS) else "The manual describes no LEDs."


def no_supply(family_device: Device, interface: Interface) -> str:
    """Return the text in place of an unknown supply: a link to characteristics that may state it, or that none do."""
    if mentions(family_device, interface, Topic.SUPPLY):
        return f"see {markdown_link('characteristics', 'hardware.md#characteristics')}"
    return f"the {word_for_document(family_device)} does not say"


#: Bits of a BiSS frame before the position: the start bit and the CDS bit.
_BISS_START_BITS = 2
#: Clock in Hz for which the page gives the duration of a frame, if the encoder supports it.
_COMMON_HZ = 1_000_000


@dataclass(frozen=True, slots=True)
class SpeedSection:
    """Section about the clock or baud rate: facts, and a table of the clock and the frame duration by cable length."""

    title: str
    facts: tuple[str, ...]
    head: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()


def speed_section(family_device: Device, device: Device, interface: Interface, layout: Layout | None) -> SpeedSection:
    """Return the section about the clock or the baud rate of an interface."""
    match interface:
        case Ssi() | Biss():
            return _clock_section(family_device, device, interface, layout)
        case Spi():
            setting_sentences = map(MARKDOWN.sentence, describe_settings(device, interface))
            return SpeedSection("Clock and words", tuple(setting_sentences))
        case Rs485():
            return _baud_section(family_device, device, interface)
        case _:
            assert_never(interface)


def _clock_section(family_device: Device, device: Device, interface: Ssi | Biss, layout: Layout | None) -> SpeedSection:
    """Return the limits of the clock, the duration of a frame, and a table of the clock by cable length.

    The table omits cables that need a clock below the encoder's lowest clock. No clock in it is above the highest one.
    """
    # The order codes of a page share their clock.
    clock = interface.clocks[0]
    facts = [f"Clock: {clock_words(clock)} ({citation(clock.source)})."]
    bit_counts = _frame_lengths(device, layout) if layout is not None else []
    start_bits = _BISS_START_BITS if isinstance(interface, Biss) else 0
    clock_counts = [bit_count + start_bits for bit_count in bit_counts]
    if bit_counts:
        facts.append(_duration_sentence(bit_counts, start_bits, _example_clock(clock)))
    facts += _pause_sentences(family_device, interface)
    table_of_clocks = cable_table(device, interface)
    cable_rows = list(_cable_rows(clock, table_of_clocks, clock_counts))
    if cable_rows:
        clock_limit = _limit_of_used_clocks(clock)
        facts.append(f"The clock for each cable length is from {escape(table_of_clocks.origin)}{clock_limit}.")
    # Manuals give lengths, and mostly also clocks, that a cable must stay below.
    has_exclusive_clocks = any(cable_row.is_below for cable_row in table_of_clocks.rows)
    cable_head = "Cable below" if any(cable_row.is_shorter for cable_row in table_of_clocks.rows) else "Cable up to"
    clock_heads = ("Clock below", "Frame above") if has_exclusive_clocks else ("Clock up to", "Frame")
    return SpeedSection("Clock and cable", facts=tuple(facts), head=(cable_head, *clock_heads), rows=tuple(cable_rows))


def _duration_sentence(bit_counts: Sequence[int], start_bits: int, clock_hz: int) -> str:
    """Return the durations of frames with these lengths: ``45 bits at 1 MHz: 47 µs, including the start bit …``."""
    lengths_text = _joined_by_or(map(str, bit_counts))
    durations_text = _duration_range([bit_count + start_bits for bit_count in bit_counts], clock_hz)
    with_start_bits = ", including the start bit and the CDS bit" if start_bits else ""
    return f"{lengths_text} bits at {hertz(clock_hz)}: {durations_text}{with_start_bits}."


def _cable_rows(clock: Clock, cable_clocks: CableTable, clock_counts: Sequence[int]) -> Iterator[Row]:
    """Yield rows of cable length, clock, frame duration. ``clock_counts`` are the lengths of a frame in clocks."""
    if clock.fastest_hz is None:
        return
    lowest_hz = clock.min_hz or 0
    for cable in cable_clocks.rows:
        if cable.hz >= lowest_hz:
            clock_hz = min(cable.hz, clock.fastest_hz)
            yield f"{cable.metres} m", hertz(clock_hz), _duration_range(clock_counts, clock_hz)


def _example_clock(clock: Clock) -> int:
    """Return 1 MHz in Hz, or the nearest clock that the encoder supports.

    If neither a highest clock nor a clock in use is known, the lowest clock is the only limit.
    """
    at_least_lowest = max(_COMMON_HZ, clock.min_hz or 0)
    return min(at_least_lowest, clock.fastest_hz or at_least_lowest)


def _limit_of_used_clocks(clock: Clock) -> str:
    """Return the phrase that the table ends at the fastest clock in use, for an encoder whose highest clock is unknown.

    Return an empty string if the highest clock is known, or if no clock is known at all.
    """
    if clock.max_hz is not None or clock.fastest_hz is None:
        return ""
    return f", up to {hertz(clock.fastest_hz)}, the fastest clock in use"


def _pause_sentences(family_device: Device, interface: Ssi | Biss) -> Iterator[str]:
    """Yield sentences on the pause between two words over SSI, or on the timeout and the reply time over BiSS."""
    match interface:
        case Ssi():
            pauses = [timing for timing in interface.timings if timing.symbol == "Tp"]
            for pause in pauses:
                yield f"Pause between two words: {bounds_with_codes(pause)} ({citation(pause.source)})."
        case Biss():
            for timeout in interface.timeouts:
                yield f"Timeout after a frame: {timeout_words(timeout)} ({citation(timeout.source)})."
            yield from unstated_facts(family_device, interface, {"reply time (acknowledge)": Topic.REPLY_TIME})


def _baud_section(family_device: Device, device: Device, interface: Rs485) -> SpeedSection:
    """Return the baud rate, and the durations of one byte and of each reply."""
    port = interface.port
    start_bit = 1
    parity_bits = 0 if port.parity == "none" else 1
    bits_per_byte = start_bit + port.data_bits + parity_bits + port.stop_bits
    reply_sizes = {layout.widest // 8 for layout in interface.layouts if layout.sender == "encoder"}
    durations = []
    for byte_count in (1, *sorted(reply_sizes)):
        duration = _duration_text(byte_count * bits_per_byte, port.baud)
        durations.append(f"{count_with_unit(byte_count, 'byte')} {duration}")
    # The first setting of a serial interface is its baud rate.
    baud_rate = next(iter(describe_settings(device, interface)))
    further_subjects = {"reply time": Topic.REPLY_TIME, "cable length": Topic.CABLE}
    facts = (
        f"{MARKDOWN.phrase(baud_rate)} ({citation(port.source)}).",
        f"Duration ({bits_per_byte} bits per byte): {', '.join(durations)}.",
        *unstated_facts(family_device, interface, further_subjects),
    )
    return SpeedSection("Baud rate and times", facts)


def _frame_lengths(device: Device, layout: Layout) -> list[int]:
    """Return the possible lengths of a frame in bits, which answers to open questions can change."""
    bit_counts: set[int] = set()
    for _, parameters in answer_combinations(device.alternatives_of(layout)):
        bit_counts.add(layout.sent_bits.value(parameters))
    return sorted(bit_counts)


def _joined_by_or(alternatives: Iterable[str]) -> str:
    """Return texts with ``or`` between them."""
    return " or ".join(alternatives)


def _duration_range(bit_counts: Iterable[int], clock_hz: int) -> str:
    """Return the durations of frames with these lengths in bits at a clock in Hz, such as ``26 µs or 32 µs``."""
    return _joined_by_or(_duration_text(bit_count, clock_hz) for bit_count in bit_counts)


def _duration_text(bit_count: int, clock_hz: int) -> str:
    """Return the duration of this many bits at a clock in Hz, rounded to 0.1 µs."""
    exact_ns = bit_count * 1_000_000_000 / clock_hz
    needs_no_rounding = exact_ns % 100 == 0
    return nanoseconds(round(exact_ns)) if needs_no_rounding else f"{exact_ns / 1000:.1f} µs"
