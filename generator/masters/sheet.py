"""Load descriptions of BiSS and SSI masters, and compute the settings of a master for one order code.

Everything about a master is in its description, a file in ``specs/masters``. See ``language/master.schema.json``.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..language.check import check_document
from ..language.master_items import NUMBERS, STEPS
from ..language.problems import Report, listed
from ..language.read import read_specs
from ..loading.spec_files import packaged_masters
from ..model import INTERFACES, Document
from ..model.expressions import Expression, ExpressionError
from ..model.record import dataclass
from ..say.interface import clocks_in_use
from ..say.numbers import decimal
from ..say.text import hertz
from .places import Device, Place, devices_of, places_of, reason_for_misfit
from .record import Part, Record
from .writing import WriteCondition, writing_of

Raw = Mapping[str, Any]

_RULE_LISTS = ("limits", "settings", "writing", "notes", "files")
#: Bound of a clock that is in use, while the limits of the encoder are not known.
_START_WITH = "start_with"
_UNITS = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}


@dataclass(frozen=True, slots=True)
class Master:
    """A master as described in its file. The last five members are checked data."""

    name: str
    title: str
    takes: tuple[str, ...]
    documents: tuple[Document, ...]
    devices: tuple[Device, ...]
    standing: str
    limits: tuple[Raw, ...]
    settings: tuple[Raw, ...]
    writing: tuple[Raw, ...]
    notes: tuple[Raw, ...]
    files: tuple[Raw, ...] = ()


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting. If its value is unknown, ``value`` is None and ``text`` gives the reason.

    ``bound`` is ``at_least``, ``at_most``, ``below``, ``start_with`` or empty.
    """

    name: str
    at: str
    value: int | bool | str | None
    text: str
    bound: str
    standing: str
    source: str
    note: str
    places: tuple[Place, ...]

    @property
    def is_default(self) -> bool:
        """True if the value is the factory default on every device."""
        return all(place.is_default for place in self.places)


@dataclass(frozen=True, slots=True)
class Refusal:
    """Reason why a master cannot use an order code. ``source`` is empty if the master lacks the interface."""

    reason: str
    standing: str
    source: str


@dataclass(frozen=True, slots=True)
class Sheet:
    """Settings of one master for one order code, empty if there are refusals.

    ``writing`` are the conditions for writing the settings.
    ``is_described`` is false if the master is not described for the interface. ``unusable_devices`` are devices that
    cannot use the order code although others can.
    """

    master: Master
    refusals: tuple[Refusal, ...]
    settings: tuple[Setting, ...]
    notes: tuple[str, ...]
    writing: tuple[WriteCondition, ...] = ()
    is_described: bool = True
    unusable_devices: frozenset[str] = frozenset()

    def devices_with(self, file: Raw) -> list[str]:
        """Return the devices of the master to which a file in its description applies."""
        names = [device.name for device in self.master.devices if device.name not in self.unusable_devices]
        return [name for name in names if name in file.get("on", names)]

    def writing_of(self, setting: Setting) -> tuple[WriteCondition, ...]:
        """Return the conditions that apply only to this setting."""
        return tuple(rule for rule in self.writing if rule.of == (setting.name,))

    @property
    def shared_writing(self) -> tuple[WriteCondition, ...]:
        """Conditions for several or all settings."""
        return tuple(rule for rule in self.writing if len(rule.of) != 1)


class _UnknownValue(Exception):
    """A value depends on a number that the spec does not give."""


def _unknown_number(number: str, step: Fraction | None = None) -> _UnknownValue:
    if number in STEPS and step is not None:
        return _UnknownValue(f"one count is {decimal(step)} µm, not a whole number of {STEPS[number]}")
    return _UnknownValue(f"not in the encoder's spec ({NUMBERS[number]})")


class _UnsupportedFeature(Exception):
    """The master does not support a feature that the encoder needs."""


def load_masters(paths: Sequence[Path] = ()) -> tuple[tuple[Master, ...], Report]:
    """Return the shipped masters and those at ``paths``, by title. One with the same name replaces a shipped one.

    Returns:
        The masters, valid only if the report is empty, and the report.
    """
    report = Report()
    masters: dict[str, Master] = {}
    for group in ([packaged_masters()], paths):
        group_names: set[str] = set()
        for document in read_specs(group, report):
            data = check_document(document, report)
            if data is not None and "master" not in data:
                problem = "this is not a description of a master: the key 'master' is missing"
                report.add("not-allowed", document, (), problem)
            elif data is not None:
                name = data["master"]
                if name in group_names:
                    report.add("duplicate-name", document, ("master",), f"there is another description of '{name}'")
                group_names.add(name)
                masters[name] = _master_from_spec(data)
    return tuple(sorted(masters.values(), key=lambda master: master.title.lower())), report


@functools.cache
def shipped_masters() -> tuple[Master, ...]:
    """Return the shipped masters. They are read once.

    Raises:
        ValueError: There are problems in a description.
    """
    masters, report = load_masters()
    if report:
        raise ValueError(report.problems[0].format())
    return masters


def _master_from_spec(data: Raw) -> Master:
    documents = tuple(Document(key, row["title"], row.get("url", "")) for key, row in data["documents"].items())
    return Master(
        name=data["master"],
        title=data["title"],
        takes=tuple(data["takes"]),
        documents=documents,
        devices=devices_of(data),
        standing=data.get("standing", "documented"),
        **{name: tuple(data.get(name, ())) for name in _RULE_LISTS},
    )


def sheet(master: Master, record: Record) -> Sheet:
    """Return the master's settings for the order code of ``record``, or the reasons why it cannot use it."""
    interface = record.words["interface"]
    if interface not in master.takes:
        only = listed(INTERFACES[name].title for name in master.takes)
        reason = f"This master is described for {only} only, but {record.code} has {INTERFACES[interface].title}."
        return Sheet(master, (Refusal(reason, master.standing, ""),), (), (), is_described=False)
    settings, device_refusals = _settings_and_device_refusals(master, record)
    unusable_devices = frozenset[str]().union(*(devices for _, devices in device_refusals))
    broken_limits = (rule for rule in master.limits if _applies(rule, record) and not _is_within_limits(rule, record))
    refusals = [_limit_refusal(rule, master, record) for rule in broken_limits]
    refusals += _refusals_of_parts(master, record)
    if len(unusable_devices) == len(master.devices):
        refusals += [refusal for refusal, _ in device_refusals]
    if not refusals:
        refusals = list(_refusals_of_values(settings))
    if refusals:
        return Sheet(master, tuple(refusals), (), ())
    device_notes = [f"Not for {listed(sorted(devices))}. {refusal.reason}" for refusal, devices in device_refusals]
    notes = [_filled(note["text"], record) for note in master.notes if _applies(note, record)]
    writing_rules = [_with_setting_names(rule, record) for rule in master.writing if _applies(rule, record)]
    setting_names = [setting.name for setting in settings]
    return Sheet(
        master=master,
        refusals=(),
        settings=tuple(settings),
        notes=(*device_notes, *notes),
        writing=writing_of(writing_rules, setting_names, master.devices, master.standing),
        unusable_devices=unusable_devices,
    )


def _settings_and_device_refusals(
    master: Master, record: Record
) -> tuple[list[Setting], list[tuple[Refusal, set[str]]]]:
    """Return the settings, and the refusals of settings that some devices cannot express, with these devices."""
    settings: list[Setting] = []
    device_refusals: list[tuple[Refusal, set[str]]] = []
    for rule in master.settings:
        if not _applies(rule, record):
            continue
        try:
            settings.append(_setting_of_rule(rule, master, record))
        except _UnsupportedFeature as reason:
            refusal = Refusal(f"{reason}.", rule.get("standing", master.standing), rule["source"])
            device_refusals.append((refusal, _devices_of(rule, master)))
    return settings, device_refusals


def _limit_refusal(rule: Raw, master: Master, record: Record) -> Refusal:
    reason = f"{rule['reason']} For this encoder: {_actual_value(rule['item'], record)}."
    return Refusal(reason, rule.get("standing", master.standing), rule["source"])


def _refusals_of_values(settings: Sequence[Setting]) -> Iterator[Refusal]:
    """Yield a refusal for each setting whose value does not fit its location."""
    for setting in settings:
        reason = reason_for_misfit(setting.name, setting.value, setting.places)
        if reason:
            yield Refusal(f"{reason}.", setting.standing, setting.source)


def _refusals_of_parts(master: Master, record: Record) -> list[Refusal]:
    """Return a refusal if the frame has parts that the master's description does not mention."""
    pairs = zip(record.parts, _items_of_parts(record.parts), strict=True)
    uncommon_parts = {part.name: item_name for part, item_name in pairs if item_name}
    mentioned = _mentioned_items((master.limits, master.settings)) if uncommon_parts else set[str]()
    names = [f"'{name}'" for name, item_name in uncommon_parts.items() if item_name not in mentioned]
    if not names:
        return []
    reason = f"The description of this master does not say how it handles {listed(names)} in the frame."
    return [Refusal(reason, "inferred", "")]


def _items_of_parts(parts: Sequence[Part]) -> Iterator[str]:
    """Yield the item that counts the bits of each part, or an empty string for the parts of the common frame."""
    side = "left"
    for part in parts:
        if part.role in ("multiturn", "singleturn"):
            side = "right"
        yield {"other": f"other_bits_{side}", "parity": "parity_bits"}.get(part.role, "")


def _mentioned_items(rule: Any) -> set[str]:
    """Return the items of a record on which rules depend."""
    if isinstance(rule, (list, tuple)):
        return set[str]().union(*map(_mentioned_items, rule))
    if not isinstance(rule, Mapping):
        return set()
    names = _mentioned_items(tuple(rule.values()))
    names |= {str(rule[key]) for key in ("item", "of") if key in rule}
    if isinstance(rule.get("value"), str):
        names |= set(Expression.parse(rule["value"]).parameters)
    return names


def _devices_of(rule: Raw, master: Master) -> set[str]:
    """Return the devices that have a setting."""
    names = [device.name for device in master.devices]
    return {name for place in rule["places"] for name in place.get("on", names)}


def _with_setting_names(rule: Raw, record: Record) -> Raw:
    """Return a condition for writing with the names of settings used on the sheet."""
    named = {key: _filled_names(rule[key], record) for key in ("of", "after") if key in rule}
    return {**rule, **named}


def _filled_names(names: Sequence[str], record: Record) -> list[str]:
    return [_filled(name, record) for name in names]


def _applies(rule: Raw, record: Record) -> bool:
    """Return whether all conditions in ``when`` of a rule are known to hold."""
    return all(_condition_holds(condition, record) for condition in rule.get("when", ()))


def _condition_holds(condition: Raw, record: Record) -> bool:
    """Return whether a condition is known to hold."""
    name = condition["item"]
    is_known = name in record.words or record.numbers[name] is not None
    return is_known and _is_within_limits(condition, record)


def _is_within_limits(limit: Raw, record: Record) -> bool:
    """Return whether an item is within its limits or unknown."""
    name = limit["item"]
    if name in record.words:
        return record.words[name] in limit["is"]
    number = record.numbers[name]
    if number is None:
        return True
    is_within = limit.get("at_least", number) <= number <= limit.get("at_most", number)
    return is_within and number in limit.get("one_of", (number,)) and number not in limit.get("none_of", ())


def _actual_value(name: str, record: Record) -> str:
    if name in record.words:
        return f"{name.replace('_', ' ')} {record.words[name]}"
    number = record.numbers[name]
    is_polynomial = name.startswith("crc_polynomial") and number is not None
    printed_number = f"0x{number:02X}" if is_polynomial else f"{number}"
    return f"{name.replace('_', ' ')} {printed_number}"


def _setting_of_rule(rule: Raw, master: Master, record: Record) -> Setting:
    try:
        value, text, bound = _value_of_setting(rule, record)
    except _UnknownValue as reason:
        value, text, bound = None, f"unknown: {reason}", ""
    notes = (rule.get("note", ""), _start_note(bound, record), _cable_note(rule, value, record))
    return Setting(
        name=_filled(rule["name"], record),
        at=_filled(rule.get("at", ""), record),
        value=value,
        text=text,
        bound=bound,
        standing=rule.get("standing", master.standing),
        source=rule["source"],
        note=" ".join(filter(None, notes)),
        places=places_of(rule, value, master.devices, master.standing, lambda symbol: _filled(symbol, record)),
    )


def _start_note(bound: str, record: Record) -> str:
    """Return why a clock is only a value to start with."""
    if bound != _START_WITH:
        return ""
    return f"The highest clock of the encoder is not known. {clocks_in_use(record.used_hz)}."


def _cable_note(rule: Raw, value: int | bool | str | None, record: Record) -> str:
    """Return the cables that allow the clock of a setting, or an empty string if the user gave a cable length."""
    if value is None or record.cable_m is not None or not {"clocks", "any_clock"} & rule.keys():
        return ""
    if "clocks" in rule:
        return record.cables.about(_best_listed_clock(rule, record)["hz"])
    return record.cables.about(_best_selectable_clock(rule["any_clock"], record))


def _value_of_setting(rule: Raw, record: Record) -> tuple[int | bool | str | None, str, str]:
    """Return the value, its text, and its bound."""
    if "unknown" in rule:
        raise _UnknownValue(rule["unknown"])
    if "value" in rule:
        number = _evaluated(rule["value"], rule["name"], record)
        if rule.get("as") == "boolean":
            text = "TRUE" if number else "FALSE"
            return bool(number), text, ""
        text = f"0x{number:02X}" if rule.get("as") == "hex" else str(number)
        return number, text, rule.get("bound", "")
    if "choice" in rule:
        chosen = _chosen_value(rule, record)
        return chosen, str(chosen), ""
    if "clocks" in rule:
        return _listed_clock(rule, record)
    if "any_clock" in rule:
        return _selectable_clock(rule["any_clock"], record)
    if "text" in rule:
        text = _filled_if_known(rule["text"], record)
        return text, text, ""
    text = "".join(_field_texts(rule["string"], rule["name"], record))
    return text, text, ""


def _evaluated(value: int | str, name: str, record: Record) -> int:
    """Return the number that an expression has for a record. ``name`` is the name of the setting."""
    expression = Expression.parse(value)
    for parameter in expression.parameters:
        if record.numbers[parameter] is None:
            raise _unknown_number(parameter, record.step)
    try:
        number = expression.value(record.known_numbers)
    except ExpressionError:
        number = -1
    if number < 0:
        raise _UnsupportedFeature(f"{name} would be {expression.render()}, which cannot be set")
    return number


def _chosen_value(rule: Raw, record: Record) -> int | str:
    name = rule["choice"]["of"]
    actual = record.words.get(name, record.numbers.get(name))
    if actual is None:
        raise _unknown_number(name, record.step)
    for case in rule["choice"]["cases"]:
        if case["is"] == actual:
            chosen: int | str = case["set"]
            return chosen
    raise _UnsupportedFeature(f"{rule['name']} has no value for {_actual_value(name, record)}")


def _is_highest_clock_known(record: Record) -> bool:
    return record.numbers["clock_max_hz"] is not None


def _clock_limits(record: Record) -> tuple[int, int]:
    slowest, fastest = record.numbers["clock_min_hz"], record.numbers["clock_max_hz"]
    if fastest is None:
        raise _unknown_number("clock_max_hz")
    return slowest or 0, fastest


def _listed_clock(rule: Raw, record: Record) -> tuple[int | str, str, str]:
    best_clock = _best_listed_clock(rule, record)
    frequency, value = hertz(best_clock["hz"]), best_clock["set"]
    text = frequency if str(value) == frequency else f"{value} ({frequency})"
    bound = "" if _is_highest_clock_known(record) else _START_WITH
    return value, text, bound


def _best_listed_clock(rule: Raw, record: Record) -> Raw:
    """Return the fastest of the master's clocks that the encoder supports, or that is in use if this is not known."""
    used_clocks = [clock for clock in rule["clocks"] if clock["hz"] in record.used_hz]
    if used_clocks:
        return _fastest_of(used_clocks)
    slowest, fastest = _clock_limits(record)
    fitting_clocks = [clock for clock in rule["clocks"] if slowest <= clock["hz"] <= fastest]
    if not fitting_clocks:
        with_cable = f" with a cable of {record.cable_m} m" if record.cable_m is not None else ""
        highest = _fastest_clock_text(record)
        raise _UnsupportedFeature(
            f"{rule['name']}: no clock is between {hertz(slowest)} and {highest}, the limits of the encoder{with_cable}"
        )
    return _fastest_of(fitting_clocks)


def _fastest_of(clocks: Sequence[Raw]) -> Raw:
    return max(clocks, key=lambda clock: int(clock["hz"]))


def _fastest_clock_text(record: Record) -> str:
    """Return the highest clock in words, which a table of cable lengths may give as an exclusive limit."""
    row = record.cable_row
    return hertz(row.hz if row is not None else record.known_numbers["clock_max_hz"])


def _selectable_clock(clock: Raw, record: Record) -> tuple[int | str, str, str]:
    best_clock, unit = _best_selectable_clock(clock, record), clock["unit"]
    bound = "at_most" if _is_highest_clock_known(record) else _START_WITH
    row = record.cable_row
    if row is not None and row.is_below and best_clock == row.highest_hz:
        best_clock, bound = row.hz, "below"
    if unit not in _UNITS:
        return best_clock, hertz(best_clock), bound
    number = f"{best_clock / _UNITS[unit]:g}" if best_clock % _UNITS[unit] else str(best_clock // _UNITS[unit])
    text = f"{number} Hz ({hertz(best_clock)})" if unit == "Hz" else f"{number} {unit}"
    value: int | str = int(number) if number.isdigit() else number
    return value, text, bound


def _best_selectable_clock(clock: Raw, record: Record) -> int:
    """Return the fastest clock that the encoder and the master support, for a master with freely selectable clocks."""
    lowest, highest = clock.get("at_least_hz", 0), clock.get("at_most_hz", math.inf)
    used_clocks = [hz for hz in record.used_hz if lowest <= hz <= highest]
    if used_clocks:
        return max(used_clocks)
    slowest, fastest = _clock_limits(record)
    best_clock = min(fastest, int(clock.get("at_most_hz", fastest)))
    if best_clock < max(slowest, lowest):
        supported = f"at most {hertz(highest)}" if highest < slowest else f"at least {hertz(lowest)}"
        needed = f"{hertz(slowest)} to {_fastest_clock_text(record)}"
        raise _UnsupportedFeature(f"The master supports clocks of {supported}, but the encoder needs {needed}")
    return best_clock


def _filled_if_known(text: str, record: Record) -> str:
    """Return the text with the items in braces filled in, all of which must be known."""
    for name in NUMBERS:
        is_known = record.numbers[name] is not None or (name == "step_um" and record.step)
        if f"{{{name}}}" in text and not is_known:
            raise _unknown_number(name, record.step)
    return _filled(text, record)


def _filled(text: str, record: Record) -> str:
    """Return the text with the items in braces filled in, with ``unknown`` for those without a value."""
    if "{" not in text:
        return text
    if record.step is not None:
        text = text.replace("{step_um}", decimal(record.step))
    for name, value in {**record.words, **record.numbers}.items():
        text = text.replace(f"{{{name}}}", "unknown" if value is None else str(value))
    return text


def _field_texts(rule: Raw, name: str, record: Record) -> Iterator[str]:
    """Yield the text of each field of the frame, according to its kind."""
    texts: dict[str, str] = {}
    for field in rule["fields"]:
        if _applies(field, record):
            texts.setdefault(field["of"], field["text"])
    yield _filled_if_known(rule.get("start", ""), record)
    parts = _with_whole_position(record) if "position" in texts else record.parts
    if rule["first"] != "sent_first":
        parts = parts[::-1]
    for part in parts:
        kind = f"status_active_{part.active or 'low'}" if part.role == "status" else part.role
        if kind not in texts:
            raise _UnsupportedFeature(f"{name} cannot express '{part.name}'")
        yield _filled_if_known(texts[kind].replace("{bits}", str(part.bits)).replace("{name}", part.name), record)


def _with_whole_position(record: Record) -> tuple[Part, ...]:
    """Return the parts of the frame with multiturn and singleturn merged."""
    position = Part("position", "position", record.numbers["position_bits"] or 0)
    parts: list[Part] = []
    for part in record.parts:
        if part.role == "singleturn":
            parts.append(position)
        elif part.role != "multiturn":
            parts.append(part)
    return tuple(parts)
