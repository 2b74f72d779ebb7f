"""Kinds of change by the rules of ``diff``, each with its impact on every output, and the version that follows.

Breaking changes and changes of behaviour raise the first number, compatible ones the second, and wording the third. A
change of behaviour counts as breaking, since an update must not silently change positions. Before 1.0.0 each is one
place lower: the second number marks breaking changes and changes of behaviour, the third the rest. Only the
manufacturer's file can move a package to 1.0.0.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from types import MappingProxyType
from typing import Any

from ..model import Device, Manufacturer


class Impact(IntEnum):
    """Effort that a change causes for users, in ascending order."""

    NONE = 0
    #: Words, sources and other facts that no code depends on.
    DOCUMENTATION = 1
    #: Additions. Everything else is unchanged.
    COMPATIBLE = 2
    #: Code still builds, but sends, reads, accepts or rejects something else.
    BEHAVIOUR = 3
    #: Code that uses it no longer builds, or asks for something that no longer exists.
    BREAKING = 4

    @property
    def word(self) -> str:
        return self.name.lower()


#: The impacts that a user can name, lowest first.
IMPACTS = tuple(impact.word for impact in Impact if impact)
#: The outputs, in the order of reports.
OUTPUTS = ("c", "python", "xml", "pages")
TITLES = {"c": "C", "python": "Python", "xml": "XML", "pages": "pages"}


@dataclass(frozen=True, slots=True)
class ChangeRule:
    """A kind of change.

    ``impacts`` contains one impact for each of ``OUTPUTS``. ``when`` describes the change, ``why`` justifies the
    impact.
    """

    name: str
    impacts: tuple[Impact, Impact, Impact, Impact]
    when: str
    why: str

    @property
    def impact(self) -> Impact:
        """Highest impact on any output."""
        return max(self.impacts)

    @property
    def is_renaming(self) -> bool:
        return self.name.endswith("-renamed")

    @property
    def word(self) -> str:
        """Word in the first column of the text."""
        return "renamed" if self.is_renaming else self.impact.word


@dataclass(frozen=True, slots=True)
class Change:
    """One difference, described by ``text``. ``old`` and ``new`` are plain data, or None.

    ``codes`` are the order codes that it affects, and ``affected_codes_text`` describes them in words. ``names``
    contains the name of the changed part in each output that names it. The change moves the fields ``moved_fields``.
    ``resized_frames`` contains the frames whose length it changes, with the bits that they gain, or 0 if the gain
    depends on the order code.
    """

    family: str
    rule: ChangeRule
    path: str
    text: str
    old: Any
    new: Any
    codes: tuple[str, ...]
    affected_codes_text: str
    names: Mapping[str, str]
    moved_fields: tuple[str, ...] = ()
    resized_frames: Mapping[str, int] = field(default_factory=dict)

    @property
    def impact(self) -> Impact:
        return self.rule.impact


@dataclass(frozen=True, slots=True)
class ChangeSubject:
    """Subject of a change: its path in the spec, its name in a sentence, and its old names in outputs.

    ``interface`` is empty if it concerns all order codes. ``scope`` is the frame or register in which to look up the
    names of fields.
    """

    path: str
    label: str
    interface: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    scope: str = ""

    def inside(self, path: str, label: str) -> ChangeSubject:
        """Return a part of this subject, such as a member, with its path relative to the subject and its label."""
        return replace(self, path=f"{self.path}.{path}".removeprefix("."), label=label)

    @property
    def unnamed(self) -> ChangeSubject:
        """The same subject without its names in code, for changes that do not affect these names."""
        return replace(self, names={})


_VERSION_NUMBER = re.compile(r"(\d+)\.(\d+)\.(\d+)")


@dataclass(frozen=True, slots=True)
class PackageVersions:
    """Versions of a manufacturer's package: ``old`` and ``stated`` are from the specs, ``due`` is from the changes."""

    manufacturer: str
    name: str
    old: str
    stated: str
    due: str

    @property
    def new(self) -> str:
        """New version: the stated version if that is high enough."""
        return self.stated if self.is_enough else self.due

    @property
    def is_enough(self) -> bool:
        """Whether the stated version is at least the version that the changes require."""
        return _version_numbers(self.stated) >= _version_numbers(self.due)


def due_version(version: str, impact: Impact) -> str:
    """Return the lowest version after ``version`` for changes of at most this impact.

    ``1.2.3`` becomes ``2.0.0`` if code breaks or behaves differently, ``1.3.0`` for additions, and otherwise ``1.2.4``.
    Before 1.0.0, ``0.2.3`` becomes ``0.3.0`` if code breaks or behaves differently, and otherwise ``0.2.4``.
    Without an impact, or if ``version`` does not consist of three numbers, it is returned as it is.
    """
    version_numbers = _version_numbers(version)
    if not impact or not version_numbers:
        return version
    major, minor, patch = version_numbers
    is_incompatible = impact >= Impact.BEHAVIOUR
    adds_something = impact is Impact.COMPATIBLE
    if major > 0 and is_incompatible:
        return f"{major + 1}.0.0"
    if is_incompatible or (major > 0 and adds_something):
        return f"{major}.{minor + 1}.0"
    return f"{major}.{minor}.{patch + 1}"


def packages(old: Sequence[Device], new: Sequence[Device], changes: Collection[Change]) -> list[PackageVersions]:
    """Return the Python packages of the manufacturers in both versions, with their old, stated and due versions.

    The stated version is the version in the new specs. The due version follows from the old version and from the
    highest impact of the changes of the manufacturer's families.
    """
    old_manufacturers, new_manufacturers = _manufacturers_by_name(old), _manufacturers_by_name(new)
    common_packages: list[PackageVersions] = []
    for name, new_manufacturer in new_manufacturers.items():
        if name not in old_manufacturers:
            continue
        old_version = old_manufacturers[name].version
        families = {device.name for device in (*old, *new) if device.manufacturer.name == name}
        impacts = [change.impact for change in changes if change.family in families]
        highest_impact = max(impacts, default=Impact.NONE)
        package = PackageVersions(
            manufacturer=name,
            name=new_manufacturer.python_package,
            old=old_version,
            stated=new_manufacturer.version,
            due=due_version(old_version, highest_impact),
        )
        common_packages.append(package)
    return common_packages


def _manufacturers_by_name(devices: Sequence[Device]) -> dict[str, Manufacturer]:
    return {device.manufacturer.name: device.manufacturer for device in devices}


def _version_numbers(version: str) -> tuple[int, ...]:
    """Return the numbers of a version, such as ``(1, 2, 3)`` for ``1.2.3``, or ``()`` if the text is not a version."""
    match = _VERSION_NUMBER.fullmatch(version)
    return tuple(map(int, match.groups())) if match is not None else ()


_IMPACT_BY_LETTER = {
    "B": Impact.BREAKING,
    "W": Impact.BEHAVIOUR,
    "+": Impact.COMPATIBLE,
    "D": Impact.DOCUMENTATION,
    "-": Impact.NONE,
}

_GONE = "Its names in C and Python and its element in the XML no longer exist. Code that uses them no longer builds."
_NEW = "All other names stay the same."
_RENAMED = "Names in C, Python and XML follow the spec, so code must use the new name. It works as before."
_WIRE = "The same names have a different meaning on the wire, so code still builds but behaves differently."
_LESS = "Values, clocks or pauses that used to work may be rejected or too short."
_MORE = "Everything that was allowed is still allowed."
_SUPPLY_DAMAGE = "A supply that was correct may cause damage."
_WIRING_DAMAGE = "Wiring according to the old spec may cause damage."
_OTHER_FRAMES = "Different frames are rejected or reported."
_USABLE = "It decides whether positions are usable."
_BUFFERS = "Buffers of the old length are too short or too long."
_ACCESS = "An access that used to work may behave differently."
_BOUND = "A higher bound may mean a longer wait, and a lower one leaves less time to act."
_INSTALLATIONS = "Installations depend on it."
_RESET = "A reset or a wait has a different effect."
_APART = "Separate rules apply to changed facts."
_NO_CODE = "No code depends on it."

#: Kinds of named parts. Their rules are KIND-gone, KIND-new and KIND-renamed. Each has a description, then the impacts
#: on C, Python, XML and pages of the three rules, then the property by which a renamed part is recognized.
_NAMED_KINDS = (
    ("family", "a family of encoders", "BBBD", "+++D", "BBBD", "the same order codes"),
    ("order-code", "an order code", "BBBD", "+++D", "BBBD", "the same parts"),
    ("part", "a part of the order code", "-BBD", "-WWD", "-BBD", "the same values"),
    ("spelling", "an additional notation for labels", "BBBD", "+++D", "BBBD", "the same texts"),
    (
        "parameter",
        "a quantity that an order code sets",
        "BBBD",
        "+++D",
        "BBBD",
        "the same numbers for every order code",
    ),
    ("interface", "an interface", "BBBD", "+++D", "BBBD", ""),
    ("frame", "a frame", "BBBD", "+++D", "BBBD", "the same bits"),
    ("field", "a field of a frame or register", "BBBD", "WB+D", "BBBD", "the same bits"),
    ("value", "a named value", "BBBD", "+++D", "BBBD", "the same number"),
    ("joined", "a number made of several fields", "BBBD", "BB+D", "BBBD", "the same fields"),
    ("combination", "a combination of values with a verdict", "BWBD", "WWWD", "BWBD", "the same values"),
    ("register", "a register", "BBBD", "+++D", "BBBD", "the same address and bits"),
    ("meaning", "one of several meanings of a register", "BBBD", "+++D", "BBBD", "the same setting"),
    ("crc", "a CRC", "BBBD", "+++D", "BBBD", "the same computation"),
    ("data-id", "a data ID", "BBBD", "+++D", "BBBD", "the same number"),
    ("timing", "a timing", "BBBD", "+++D", "BBBD", "the same times"),
    ("alarm", "an error or warning", "BBBD", "+++D", "BBBD", "the same bit"),
    ("procedure", "a procedure", "BBBD", "+++D", "BBBD", "the same steps"),
    ("decision", "a question that the manual leaves open", "BBBD", "BBBD", "BBBD", "the same bits"),
    ("choice", "a question with a default answer", "BBBD", "+++D", "BBBD", "the same verdicts"),
    ("answer", "an answer to an open question", "BBBD", "+++D", "BBBD", "the same bits"),
    ("control-field", "a field of the control frame", "BBBD", "+++D", "BBBD", "the same bits"),
    ("connector", "a connector or cable", "DBBD", "D++D", "DBBD", "the same contacts"),
    ("measurement", "the measurement of a position", "BBBD", "B++D", "BBBD", ""),
    ("channels", "a frame with several data channels", "BBBD", "+++D", "BBBD", ""),
    ("input", "a hardware input", "DBBD", "D++D", "DBBD", "the same effect"),
)

#: Other changes: name, impact on C, Python, XML and pages, condition, reason.
_CHANGES = (
    ("interface-of-code", "BBBD", "an order code has a different interface", "It has different frames and registers."),
    ("parameter-of-code", "WWWD", "an order code has a different resolution or a different value", _WIRE),
    ("parameter-rule", "WWWD", "the formula of a quantity has changed", _WIRE),
    ("parameter-range", "WWWD", "a quantity held in a register has a different range or register", _WIRE),
    ("label", "WWWD", "the rule for reading labels has changed", "Labels may result in different order codes."),
    ("movement", "-WWD", "rotary has become linear or vice versa", "Positions have a different meaning."),
    ("measurement", "WWWD", "the units of the position have changed", "Angles and lengths differ."),
    ("maker", "BBBD", "the manufacturer's name or its Python package has changed", "Every name begins with it."),
    ("maker-id", "--BD", "the BiSS manufacturer ID has changed", "Masters use it to find the description file."),
    ("supply-narrower", "D+WD", "the supply voltage has narrower limits", _SUPPLY_DAMAGE),
    ("supply-wider", "D++D", "the supply voltage has wider limits, or none", _MORE),
    ("frame-length", "WWWD", "a frame has a different length", _WIRE),
    ("frame-order", "WWWD", "a frame is sent in a different order or code", _WIRE),
    ("frame-told-by", "WWWD", "a different value identifies a frame", _WIRE),
    ("frame-decision", "BBBD", "a frame now needs a decision, or no longer does", "An argument is added or removed."),
    ("other-bits", "WWWD", "the required values of bits outside the fields have changed", _WIRE),
    ("field-moved", "WWWD", "a field is at different bits", _WIRE),
    ("field-width", "WWWD", "a field has a different width", _WIRE),
    ("field-kind", "BBBD", "a field is of a different kind", "Its type changes, or it is added or removed."),
    ("field-reads-otherwise", "WWWD", "the bits of a field are converted differently", _WIRE),
    ("field-type", "B--D", "a number has a different type in C", "Variables of the old type no longer fit."),
    ("field-constant", "WWWD", "fixed or unused bits have a different value", _OTHER_FRAMES),
    ("field-verdict", "WWWD", "a bit has a different effect on the position", _USABLE),
    ("field-expected", "WWWD", "a field has a different documented value", "It identifies the encoder."),
    ("field-default", "WWWD", "a field has a different default", _WIRE),
    ("field-unit", "DWWD", "a field has a different unit", "The same number has a different meaning."),
    ("value-changed", "WWWD", "a named value has a different number", _WIRE),
    ("joined-of", "WWWD", "a number consists of different fields", _WIRE),
    ("register-moved", "WWWD", "a register has a different address or bank", _WIRE),
    ("register-length", "BWWD", "a register has a different length", _BUFFERS),
    ("register-order", "WWWD", "the bytes of a register are in a different order", _WIRE),
    ("register-interface", "BBBD", "a register belongs to a different interface", "It is accessed in a different way."),
    ("access-lost", "BBBD", "a register can no longer be read or written", "Its functions are gone."),
    ("access-gained", "+++D", "a register can now also be read or written", _NEW),
    ("register-default", "WWWD", "a register has a different default", _WIRE),
    ("register-rule", "WWWD", "the effect, the conditions or the time of a write have changed", _ACCESS),
    ("limit-narrower", "WWWD", "a value has narrower limits", _LESS),
    ("limit-wider", "+++D", "a value has wider limits, or none", _MORE),
    ("wait-longer", "WWWD", "a required waiting time is longer or was added", _LESS),
    ("wait-shorter", "+++D", "a required waiting time is shorter or was removed", _MORE),
    ("time-limit", "WWWD", "the upper bound of a time is different", _BOUND),
    ("timing-typical", "+++D", "a typical time or its symbol has changed", "Code cannot rely on typical times."),
    ("clock-narrower", "WWWD", "the clock has narrower limits", _LESS),
    ("clock-wider", "+++D", "the clock has wider limits", _MORE),
    ("cable-length", "WWWD", "the highest clock for a cable length has changed", _LESS),
    (
        "facts-by-code",
        "BBBD",
        "a clock, a timeout, a time or a table of cable lengths depends on the order code in only one version",
        "A macro and an attribute for all order codes exist only while the fact is the same for all of them.",
    ),
    (
        "clock-used",
        "WWWD",
        "different clocks are known to be in use",
        "Code may use one of them, because no limit is known.",
    ),
    ("port", "WWWD", "the settings of the serial port have changed", _WIRE),
    ("alignment", "DWWD", "a word has a different alignment or code", _WIRE),
    ("bank-select", "WWWD", "the bank is selected by a different register", _WIRE),
    ("channels-of-frame", "WWWD", "a frame has different data channels, or compares them differently", _WIRE),
    ("interface-rule", "DWWD", "signals, network, profile or memory access have changed", _INSTALLATIONS),
    ("data-id-changed", "WWWD", "a data ID has a different number, control byte or purpose", _WIRE),
    ("crc-changed", "WWWD", "a CRC is computed differently", "Frames that were valid are rejected."),
    ("alarm-bit", "WWWD", "an error or warning is signaled by a different bit", _WIRE),
    ("alarm-rule", "DWWD", "the conditions that set or clear an error or warning have changed", _RESET),
    ("alarm-threshold", "WWWD", "an alarm is active below a different voltage", "A constant has a different value."),
    ("procedure-steps", "WWWD", "the steps of a procedure have changed", "The same call sends different data."),
    ("procedure-arguments", "BBBD", "a procedure has different arguments", "Calls no longer match."),
    ("procedure-interface", "BBBD", "a procedure uses a different interface", "It is accessed in a different way."),
    (
        "decision-default",
        "BBBD",
        "a question has a different default, a new one, or none",
        "Callers must, or need not, answer.",
    ),
    ("answer-sets", "WWWD", "an answer selects different bits", _WIRE),
    ("contact", "DWWD", "a contact or wire carries a different signal", _WIRING_DAMAGE),
    ("input-rule", "DWWD", "a hardware input has a different function", "An encoder wired to it behaves differently."),
    ("unforeseen", "WWWD", "a change that no other rule covers", "It is reported rather than ignored."),
    ("words", "DDDD", "only the wording has changed", _NO_CODE),
    ("source", "DDDD", "a citation has changed", _NO_CODE),
    ("evidence", "DDDD", "the evidence for the facts has changed", _APART),
    ("manual", "DDDD", "the manual has a different edition or more revisions", _APART),
    ("erratum", "DDDD", "an erratum was added, removed or changed", _APART),
    ("example", "DDDD", "a worked example was added, removed or changed", "Examples only affect tests and pages."),
    ("told", "DDDD", "a characteristic, table, LED, document or missing figure has changed", _NO_CODE),
    ("order", "DDDD", "only the order of the facts has changed", "Facts are identified by name."),
)


_ONE_MORE_VALUE = "Code that encodes the frame or register must give one more value, and decoders return one more."
#: Reasons why a new part of these kinds has its impact.
_REASONS_OF_NEW = {
    "decision": "Callers must give an answer.",
    "field": _ONE_MORE_VALUE,
    "joined": _ONE_MORE_VALUE,
    "combination": _USABLE,
    "measurement": "In C, each measured quantity, such as the counts per turn, is named after its role.",
}


def _all_rules() -> Iterator[ChangeRule]:
    """Yield all rules: first the rules for parts that are gone, new or renamed, such as "register-gone"."""
    for kind, phrase, if_gone, if_new, if_renamed, common in _NAMED_KINDS:
        yield ChangeRule(name=f"{kind}-gone", impacts=_parse_impacts(if_gone), when=f"{phrase} was removed", why=_GONE)
        why_new = _REASONS_OF_NEW.get(kind, _NEW)
        yield ChangeRule(name=f"{kind}-new", impacts=_parse_impacts(if_new), when=f"{phrase} was added", why=why_new)
        if common:
            when_renamed = f"{phrase} has a different name but {common}"
            yield ChangeRule(
                name=f"{kind}-renamed", impacts=_parse_impacts(if_renamed), when=when_renamed, why=_RENAMED
            )
    for name, impacts, when, why in _CHANGES:
        yield ChangeRule(name=name, impacts=_parse_impacts(impacts), when=when, why=why)


def _parse_impacts(letters: str) -> tuple[Impact, Impact, Impact, Impact]:
    """Return the impacts on C, Python, XML and pages for four letters, such as ``WB+D``."""
    c, python, xml, pages = (_IMPACT_BY_LETTER[letter] for letter in letters)
    return c, python, xml, pages


#: Every rule by its name.
RULES: Mapping[str, ChangeRule] = MappingProxyType({rule.name: rule for rule in _all_rules()})
#: The property by which a renamed part of each kind is recognized.
COMMON_PROPERTY_BY_KIND: Mapping[str, str] = MappingProxyType(
    {kind: common for kind, _, _, _, _, common in _NAMED_KINDS}
)
