"""Rules for sentences about facts that are also data: thresholds, active levels, latches, named values and wires."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence

from ..document import Path
from ..problems import DocumentReport, quoted
from ..written_parts import WrittenSpec
from .parts import PlacedPart, field_lists

#: Words of which one value cannot have both: in its name and in its meaning.
_OPPOSITES = (
    ("gray", "binary"),
    ("enable", "disable"),
    ("enabled", "disabled"),
    ("clockwise", "counterclockwise"),
    ("cw", "ccw"),
    ("open", "closed"),
    ("on", "off"),
    ("high", "low"),
    ("up", "down"),
)
_OPPOSITE_OF = {**dict(_OPPOSITES), **{opposite: word for word, opposite in _OPPOSITES}}
_VOLTAGE_LIMIT = re.compile(r"\b(above|over|exceeds|below|under) (\d+(?:\.\d+)?) ?(m?)V\b")
_WORDS_FOR_ABOVE = frozenset(("above", "over", "exceeds"))
#: A sentence that gives the level of an active bit: "0 means an error", "active if it is 1", "it is active at 0".
_ACTIVE_LEVEL_SENTENCE = re.compile(r"\bactive (?:at|if it is|when it is|while it is|=) ?([01])\b", re.IGNORECASE)
_CLEARS_ITSELF = re.compile(
    r"\b(?:clears (?:by )?itself|cleared automatically|returns to 0 by itself|not latched|is not stored)\b",
    re.IGNORECASE,
)
_LATCHED_WORDS = re.compile(
    r"\b(?:is latched|remains active until it is reset|stays active until it is reset)\b", re.IGNORECASE
)
#: Two wires named together, as in "white and blue wires".
_TWO_WIRES = re.compile(r"\b([A-Za-z]+(?:[-/_][A-Za-z]+)?) and ([A-Za-z]+(?:[-/_][A-Za-z]+)?) wires\b")
#: A supply line, such as ``+5 V`` or ``0V``.
_SUPPLY_LINE = re.compile(r"(?<![A-Za-z])[+-]?\d*(?:[.,]\d+)? ?V", re.IGNORECASE)
_KEYS_OF_TEXTS = ("meaning", "note", "remedy", "detected", "precondition", "result", "when_active", "when_inactive")


def check_threshold_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the texts of an alarm that is raised below a voltage do not say that it is raised above it."""
    for alarm in spec.alarms:
        threshold_mv = alarm.part.below_mv
        if threshold_mv is None:
            continue
        for path, text in _texts_of(alarm, _KEYS_OF_TEXTS):
            for word, number, prefix in _VOLTAGE_LIMIT.findall(text):  # ("above", "3.6", "") or ("below", "100", "m").
                voltage_mv = float(number) * (1 if prefix == "m" else 1000)
                if word in _WORDS_FOR_ABOVE and voltage_mv == threshold_mv:
                    problem = f"the text says {quoted(word)}, but the alarm has 'below_mv: {threshold_mv}'"
                    message = f"{problem}; correct one of the two"
                    report.add("words-contradict", path, message)


def check_latch_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text says that a latching alarm clears itself, or that any other alarm stays active."""
    for alarm in spec.alarms:
        is_latching = alarm.part.latch
        if is_latching is None:
            continue
        contradicting_words = _CLEARS_ITSELF if is_latching else _LATCHED_WORDS
        for path, text in _texts_of(alarm, _KEYS_OF_TEXTS):
            match = contradicting_words.search(text)
            if match is not None:
                latch_text = "true" if is_latching else "false"
                message = f"the text says {quoted(match[0])}, but 'latch' is {latch_text}; correct one of the two"
                report.add("words-contradict", path, message)


def check_level_words(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that texts of a flag such as "active at 0" give the level at which the flag is active."""
    levels = {"low": "0", "high": "1"}
    for field_list in field_lists(spec):
        for field in field_list.fields:
            active_level = levels.get(field.active)  # None for a field that is not a flag.
            if active_level is None:
                continue
            for path, text in _texts_of(field, _KEYS_OF_TEXTS):
                stated_levels = _ACTIVE_LEVEL_SENTENCE.findall(text)
                wrong_levels = [level for level in stated_levels if level != active_level]
                if wrong_levels:
                    message = (
                        f"the text says that it is active at {wrong_levels[0]}, but 'active: {field.active}' means"
                        f" {active_level}; correct one of the two"
                    )
                    report.add("words-contradict", path, message)


def check_name_and_meaning(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the meaning of a named value does not contain the opposite of a word in its name.

    For example, ``binary`` must not mean "Gray code". A meaning that contains both words is accepted.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            for name, value in field.values.items():
                for word, opposite in _yield_contradictions(name, value.meaning):
                    message = f"{quoted(name)} has a meaning with {quoted(opposite)} and without {quoted(word)}"
                    report.add("words-contradict", value.place_of("meaning"), f"{message}; correct one of the two")


def _yield_contradictions(name: str, meaning: str) -> Iterator[tuple[str, str]]:
    """Yield each word of a name whose opposite, but not itself, is in the meaning, with this opposite.

    For the name ``binary`` and the meaning ``Gray code``, this is ``("binary", "gray")``.
    """
    plain_name = name.replace("counter_clockwise", "counterclockwise")
    plain_meaning = re.sub(r"counter-?clockwise", "counterclockwise", meaning.casefold())
    meaning_words = set(re.findall(r"[a-z]+", plain_meaning))
    for word in plain_name.split("_"):
        if word not in _OPPOSITE_OF or word in meaning_words:
            continue
        opposite = _OPPOSITE_OF[word]
        if opposite in meaning_words:
            yield word, opposite


def check_named_wires(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that two wires that a text names together, by their colors, are a supply or a differential pair.

    The signals of the wires are those in the tables of cables. Wires that no cable has are not checked.
    """
    signals_by_color = _signals_by_wire(spec)
    if not signals_by_color:
        return
    for path, text in _all_texts(spec):
        for first_wire, second_wire in _TWO_WIRES.findall(text):
            first_signals = signals_by_color.get(first_wire.casefold())
            second_signals = signals_by_color.get(second_wire.casefold())
            if first_signals is None or second_signals is None:
                continue
            signal_pairs = itertools.product(first_signals, second_signals)
            are_a_pair = any(_belong_together(signal, other_signal) for signal, other_signal in signal_pairs)
            if not are_a_pair:
                first_signal, second_signal = min(first_signals), min(second_signals)
                message = (
                    f"the text names the {first_wire} and {second_wire} wires together, but they carry"
                    f" {quoted(first_signal)} and {quoted(second_signal)}; correct one of the two"
                )
                report.add("words-contradict", path, message)


def _signals_by_wire(spec: WrittenSpec) -> dict[str, set[str]]:
    """Return the signals that a wire of each color has in some cable: ``{"white": {"MA+"}}``."""
    signals_by_color: dict[str, set[str]] = {}
    for connector in spec.connectors:
        if connector.part.kind != "cable":
            continue
        for wire in connector.part.contacts:
            color = wire.contact.casefold()
            signals_by_color.setdefault(color, set()).add(wire.signal)
    return signals_by_color


def _belong_together(signal: str, other_signal: str) -> bool:
    """Return True if two signals are both supply lines, or have the same letters and digits.

    The latter is true for the lines of a differential pair, such as ``MA+`` and ``MA-``.
    """
    if _SUPPLY_LINE.search(signal) and _SUPPLY_LINE.search(other_signal):
        return True
    letters_and_digits = re.sub(r"[^a-z0-9]", "", signal.casefold())
    other_letters_and_digits = re.sub(r"[^a-z0-9]", "", other_signal.casefold())
    return letters_and_digits == other_letters_and_digits


def _all_texts(spec: WrittenSpec) -> Iterator[tuple[Path, str]]:
    """Yield the texts of procedures, characteristics and alarms, each with its path."""
    for procedure in spec.procedures:
        yield from _texts_of(procedure, _KEYS_OF_TEXTS)
    for characteristic in spec.characteristics:
        yield from _texts_of(characteristic, ("value", "note"))
    for alarm in spec.alarms:
        yield from _texts_of(alarm, _KEYS_OF_TEXTS)


def _texts_of(placed_part: PlacedPart, keys: Sequence[str]) -> Iterator[tuple[Path, str]]:
    """Yield the texts of a part under these keys, with their paths."""
    for key in keys:
        text = placed_part.data.get(key)
        if isinstance(text, str):
            yield (*placed_part.path, key), text
