"""Load descriptions of BiSS and SSI masters, and compute the settings of a master for one order code.

Everything about a master is in its description, a file in ``specs/masters``. See ``language/master.schema.json``.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from ..language.check import check_document
from ..language.files import packaged_masters
from ..language.problems import ProblemReport, join_words
from ..language.read import read_specs
from ..model import INTERFACES, Document
from ..model.record import dataclass
from ..say.order_code import clocks_in_use
from .encoder_facts import EncoderFacts
from .frame_parts import depends_on_crc, depends_on_whole_frame, uncovered_parts
from .places_and_writing import MasterDevice, SettingPlace, WriteCondition, devices_of, places_of, writing_of
from .setting_values import (
    START_WITH,
    UnknownValue,
    UnsupportedFeature,
    YamlMapping,
    best_listed_clock,
    best_selectable_clock,
    fill_template,
    is_within_limits,
    rule_applies,
    sentence_about_encoder,
    value_of_setting,
)

_RULE_LISTS = ("limits", "settings", "writing", "notes", "files")


@dataclass(frozen=True, slots=True)
class Master:
    """A master as described in its file. ``limits``, ``settings``, ``writing``, ``notes`` and ``files`` are its rules.

    ``several_channels`` says how it reads several data channels of one frame, and is empty if its description covers
    only a single channel.
    """

    name: str
    title: str
    supported_interfaces: tuple[str, ...]
    documents: tuple[Document, ...]
    devices: tuple[MasterDevice, ...]
    standing: str
    limits: tuple[YamlMapping, ...]
    settings: tuple[YamlMapping, ...]
    writing: tuple[YamlMapping, ...]
    notes: tuple[YamlMapping, ...]
    files: tuple[YamlMapping, ...] = ()
    several_channels: str = ""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of a master. If its value is unknown, ``value`` is None, and ``text`` gives the reason.

    ``bound`` is ``at_least``, ``at_most``, ``below``, ``start_with`` or empty. ``at`` is the name of the setting in the
    master's documentation, and ``places`` are its locations in the devices of the master.
    """

    name: str
    at: str
    value: int | bool | str | None
    text: str
    bound: str
    standing: str
    source: str
    note: str
    places: tuple[SettingPlace, ...]

    @property
    def is_default(self) -> bool:
        """True if the value is the factory default at each of its places."""
        return all(place.is_default for place in self.places)


@dataclass(frozen=True, slots=True)
class MasterRefusal:
    """Reason why a master cannot use an order code. ``source`` is empty if no document states it."""

    reason: str
    standing: str
    source: str


@dataclass(frozen=True, slots=True)
class SettingsSheet:
    """Settings of one master for one order code.

    If there are ``refusals``, reasons why the master cannot use the order code, there are no settings. ``writing`` are
    the conditions for writing the settings. ``is_described`` is false if the description of the master does not cover
    the interface. ``unusable_devices`` are devices that cannot use the order code although others can. ``gaps`` are
    statements about parts of the frame that the description does not cover. Settings that depend on them are unknown.
    """

    master: Master
    refusals: tuple[MasterRefusal, ...]
    settings: tuple[Setting, ...]
    notes: tuple[str, ...]
    writing: tuple[WriteCondition, ...] = ()
    is_described: bool = True
    unusable_devices: frozenset[str] = frozenset()
    gaps: tuple[MasterRefusal, ...] = ()

    def devices_with(self, file: YamlMapping) -> list[str]:
        """Return the names of the usable devices to which a file of the master applies.

        The file lists its devices under ``on``. Without this key, it applies to all devices.
        """
        names = [device.name for device in self.master.devices if device.name not in self.unusable_devices]
        return [name for name in names if name in file.get("on", names)]

    def writing_of(self, setting: Setting) -> tuple[WriteCondition, ...]:
        """Return the conditions that apply only to this setting."""
        return tuple(rule for rule in self.writing if rule.of == (setting.name,))

    @property
    def shared_writing(self) -> tuple[WriteCondition, ...]:
        """Conditions for several or all settings."""
        return tuple(rule for rule in self.writing if len(rule.of) != 1)


def load_masters(paths: Sequence[Path] = ()) -> tuple[tuple[Master, ...], ProblemReport]:
    """Load the masters of the package and the masters at ``paths``, sorted by title.

    A master with the same name replaces one of the package.

    Returns:
        The masters, valid only if the report is empty, and the report.
    """
    report = ProblemReport()
    master_by_name: dict[str, Master] = {}
    # The user's masters are loaded last, so they replace those of the package. Names within a group must be unique.
    for paths_of_group in ([packaged_masters()], paths):
        group_names: set[str] = set()
        for document in read_specs(paths_of_group, report):
            description = check_document(document, report)
            if description is None:  # The report contains its problems.
                continue
            if "master" not in description:
                problem = "this is not a description of a master: the key 'master' is missing"
                report.add("not-allowed", document, (), problem)
                continue
            name = description["master"]
            if name in group_names:
                report.add("duplicate-name", document, ("master",), f"there is another description of '{name}'")
            group_names.add(name)
            master_by_name[name] = _master_from_spec(description)
    return tuple(sorted(master_by_name.values(), key=lambda master: master.title.lower())), report


@functools.cache
def shipped_masters() -> tuple[Master, ...]:
    """Return the masters of the package, which are loaded only once.

    Raises:
        ValueError: There are problems in a description.
    """
    masters, report = load_masters()
    if report:
        raise ValueError(report.problems[0].format())
    return masters


def _master_from_spec(master_data: YamlMapping) -> Master:
    """Return the master for a checked description. A list of rules that the description lacks is empty."""
    documents: list[Document] = []
    for key, description in master_data["documents"].items():
        documents.append(Document(key=key, title=description["title"], url=description.get("url", "")))
    rule_lists = {list_name: tuple(master_data.get(list_name, ())) for list_name in _RULE_LISTS}
    return Master(
        name=master_data["master"],
        title=master_data["title"],
        supported_interfaces=tuple(master_data["takes"]),
        documents=tuple(documents),
        devices=devices_of(master_data),
        standing=master_data.get("standing", "documented"),
        several_channels=master_data.get("several_channels", {}).get("text", ""),
        **rule_lists,
    )


def sheet(master: Master, facts: EncoderFacts) -> SettingsSheet:
    """Return the settings of a master for an order code, or the reasons why the master cannot use it.

    ``facts`` are the facts about the order code.
    """
    interface = facts.words["interface"]
    if interface not in master.supported_interfaces:
        refusing_sheet = _refusing_sheet(master, _interface_refusal(master, facts))
        return replace(refusing_sheet, is_described=False)
    if facts.obstacle:
        return _refusing_sheet(master, MasterRefusal(reason=facts.obstacle, standing="inferred", source=""))
    # The parts of the frame that the description does not cover, or empty.
    uncovered_text = uncovered_parts((master.limits, master.settings, master.notes), facts.frame_parts)
    settings, device_refusals = _settings_and_device_refusals(master, facts, uncovered_text)
    unusable_devices: set[str] = set()
    for _, refusing_devices in device_refusals:
        unusable_devices |= refusing_devices
    refusals = list(_refusals_of_order_code(master, facts))
    # If only some devices cannot use the order code, this becomes a note.
    are_all_devices_unusable = len(unusable_devices) == len(master.devices)
    if are_all_devices_unusable:
        refusals += [refusal for refusal, _ in device_refusals]
    if not refusals:
        refusals = list(_refusals_of_values(settings))
    if refusals:
        return _refusing_sheet(master, *refusals)
    device_notes = [f"Not for {join_words(sorted(devices))}. {refusal.reason}" for refusal, devices in device_refusals]
    writing_rules = [_with_setting_names(rule, facts) for rule in master.writing if rule_applies(rule, facts)]
    setting_names = [setting.name for setting in settings]
    return SettingsSheet(
        master=master,
        refusals=(),
        settings=tuple(settings),
        notes=(*device_notes, *_notes_of_master(master, facts)),
        writing=writing_of(writing_rules, setting_names, devices=master.devices, standing=master.standing),
        unusable_devices=frozenset(unusable_devices),
        gaps=tuple(_gaps_in_description(master, facts, uncovered_text)),
    )


def _refusals_of_order_code(master: Master, facts: EncoderFacts) -> Iterator[MasterRefusal]:
    """Yield the reasons why a master cannot use an order code: limits of the master, the CRC, and data channels."""
    for rule in master.limits:
        if rule_applies(rule, facts) and not is_within_limits(rule, facts):
            yield _limit_refusal(rule, master, facts)
    yield from _refusals_of_crc(master, facts)
    reads_single_channel = not master.several_channels
    channel_refusal = facts.other_channels.refusal(facts.layout_name) if reads_single_channel else ""
    if channel_refusal:
        yield MasterRefusal(reason=channel_refusal, standing="inferred", source="")


def _notes_of_master(master: Master, facts: EncoderFacts) -> Iterator[str]:
    """Yield the notes of a master that apply to an order code, first about several data channels in its frame."""
    if facts.other_channels and master.several_channels:
        yield master.several_channels
    for note in master.notes:
        if rule_applies(note, facts):
            yield fill_template(note["text"], facts)


def _gaps_in_description(master: Master, facts: EncoderFacts, uncovered_text: str) -> Iterator[MasterRefusal]:
    """Yield statements about parts of the frame that a master's description does not cover.

    ``uncovered_text`` lists unusual bits of the frame, or is empty. Other data channels in the frame are also parts.
    """
    if uncovered_text:
        yield _refusal_of_gap(uncovered_text)
    if facts.other_channels and not master.several_channels:
        yield MasterRefusal(reason=facts.other_channels.gap, standing="inferred", source="")


def _refusing_sheet(master: Master, *refusals: MasterRefusal) -> SettingsSheet:
    """Return the sheet of a master that cannot use an order code for these reasons."""
    return SettingsSheet(master=master, refusals=refusals, settings=(), notes=())


def _interface_refusal(master: Master, facts: EncoderFacts) -> MasterRefusal:
    """Return the refusal of a master whose description does not cover the interface of the order code."""
    described_interfaces = join_words(INTERFACES[name].title for name in master.supported_interfaces)
    encoder_interface = INTERFACES[facts.words["interface"]].title
    reason = f"This master is described for {described_interfaces} only, but {facts.code} has {encoder_interface}."
    return MasterRefusal(reason=reason, standing=master.standing, source="")


def _settings_and_device_refusals(
    master: Master, facts: EncoderFacts, uncovered_text: str
) -> tuple[list[Setting], list[tuple[MasterRefusal, set[str]]]]:
    """Return the settings of a master for an order code, and the settings that have no value for it.

    For each of the latter, return a refusal, and the devices that have this setting and therefore cannot use the order
    code. ``uncovered_text`` lists the parts of the frame that the description does not cover. If it is not empty,
    settings that depend on the whole frame are unknown.
    """
    settings: list[Setting] = []
    device_refusals: list[tuple[MasterRefusal, set[str]]] = []
    for rule in master.settings:
        if not rule_applies(rule, facts):
            continue
        try:
            unknown_parts_text = uncovered_text if depends_on_whole_frame(rule) else ""
            settings.append(_setting_of_rule(rule, master, facts, unknown_parts_text))
        except UnsupportedFeature as reason:
            standing = rule.get("standing", master.standing)
            refusal = MasterRefusal(reason=f"{reason}.", standing=standing, source=rule["source"])
            device_refusals.append((refusal, _devices_with_setting(rule, master)))
    return settings, device_refusals


def _limit_refusal(rule: YamlMapping, master: Master, facts: EncoderFacts) -> MasterRefusal:
    """Return the refusal for a limit of a master that the order code does not meet."""
    reason = f"{rule['reason']} {sentence_about_encoder(rule['item'], facts)}"
    return MasterRefusal(reason=reason, standing=rule.get("standing", master.standing), source=rule["source"])


def _refusals_of_values(settings: Sequence[Setting]) -> Iterator[MasterRefusal]:
    """Yield a refusal for each setting whose value is too large or too small for its location in the master."""
    for setting in settings:
        reason = misfit_message(setting.name, setting.value, setting.places)
        if reason:
            yield MasterRefusal(reason=f"{reason}.", standing=setting.standing, source=setting.source)


def _refusals_of_crc(master: Master, facts: EncoderFacts) -> Iterator[MasterRefusal]:
    """Yield a refusal if the master checks CRCs, but no master can check the CRC of this encoder.

    ``crc_obstacle`` is the reason, or empty. A master checks CRCs if its rules depend on the parameters of a CRC.
    """
    checks_crc = depends_on_crc((master.limits, master.settings))
    if facts.crc_obstacle and checks_crc:
        yield MasterRefusal(reason=facts.crc_obstacle, standing="inferred", source="")


def _refusal_of_gap(uncovered_text: str) -> MasterRefusal:
    """Return the statement that a master's description does not cover these parts of the frame."""
    reason = f"The description of this master does not say how it handles {uncovered_text} in the frame."
    return MasterRefusal(reason=reason, standing="inferred", source="")


def _devices_with_setting(rule: YamlMapping, master: Master) -> set[str]:
    """Return the names of the devices of a master that have a setting.

    A location of the setting lists its devices under ``on``. Without this key, it applies to all devices.
    """
    all_names = [device.name for device in master.devices]
    names_with_setting: set[str] = set()
    for place in rule["places"]:
        names_with_setting.update(place.get("on", all_names))
    return names_with_setting


def _with_setting_names(rule: YamlMapping, facts: EncoderFacts) -> YamlMapping:
    """Return a condition for writing in which names of settings have their braces filled in, as on the sheet."""
    named_rule = dict(rule)
    for key in ("of", "after"):
        if key in rule:
            named_rule[key] = [fill_template(name, facts) for name in rule[key]]
    return named_rule


def _setting_of_rule(rule: YamlMapping, master: Master, facts: EncoderFacts, unknown_parts_text: str) -> Setting:
    """Return one setting of a master for an order code.

    Its value is None if the spec does not give a number that it needs, or if ``unknown_parts_text`` is not empty. This
    text lists the parts of the frame that it depends on, but that the description does not cover.

    Raises:
        UnsupportedFeature: The master offers no value for it.
    """
    try:
        if unknown_parts_text:
            raise UnknownValue(f"it depends on how the master handles {unknown_parts_text}")
        value, text, bound = value_of_setting(rule, facts)
    except UnknownValue as reason:
        value = None
        text = f"unknown: {reason}"
        bound = ""
    notes = (rule.get("note", ""), _start_note(bound, facts), _cable_note(rule, value, facts))
    places = places_of(
        rule,
        value,
        devices=master.devices,
        standing=master.standing,
        fill_in=lambda symbol: fill_template(symbol, facts),
    )
    return Setting(
        name=fill_template(rule["name"], facts),
        at=fill_template(rule.get("at", ""), facts),
        value=value,
        text=text,
        bound=bound,
        standing=rule.get("standing", master.standing),
        source=rule["source"],
        note=" ".join(filter(None, notes)),
        places=places,
    )


def _start_note(bound: str, facts: EncoderFacts) -> str:
    """Return a note on a clock that is only a starting value, or an empty string if it is a limit."""
    if bound != START_WITH:
        return ""
    return f"The highest clock of the encoder is not known. {clocks_in_use(facts.used_hz)}."


def _cable_note(rule: YamlMapping, value: int | bool | str | None, facts: EncoderFacts) -> str:
    """Return a note on the cable lengths that allow the clock of a setting.

    It is empty if the setting is not a clock, or if the user gave a cable length.
    """
    if value is None or facts.cable_m is not None:
        return ""
    if "clocks" in rule:
        return facts.cable_table.sentence_on_clock(best_listed_clock(rule, facts)["hz"])
    if "any_clock" in rule:
        return facts.cable_table.sentence_on_clock(best_selectable_clock(rule["any_clock"], facts))
    return ""


def misfit_message(name: str, value: int | bool | str | None, places: Sequence[SettingPlace]) -> str:
    """Return an error message if a number does not fit in one of its locations, or an empty string.

    The message is, for example, ``Bits would be 70, but it is at most 63``. Texts always fit.
    """
    if not isinstance(value, int):
        return ""
    for place in places:
        highest = _highest_value(place)
        if highest is not None and value > highest:
            return f"{name} would be {value}, but it is at most {highest}"
        if place.minimum is not None and value < place.minimum:
            return f"{name} would be {value}, but it is at least {place.minimum}"
    return ""


def _highest_value(place: SettingPlace) -> int | None:
    """Return the highest number that fits in the range and the bits of a location, or None if there is no limit."""
    upper_limits = [] if place.maximum is None else [place.maximum]
    if place.kind == "unsigned" and place.bits is not None:
        all_ones = (1 << place.bits) - 1
        upper_limits.append(all_ones)
    return min(upper_limits, default=None)
