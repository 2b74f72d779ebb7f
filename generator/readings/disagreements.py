"""Disagreements between two readings, how often each fact was read, and groups of disagreements with the same cause."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence, Set
from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

from ..language.document import Path
from .reading import NOTHING, FactClass


class HowOftenRead(IntEnum):
    """How often a fact was read from the manual, best first. For a place with several facts, the worst applies."""

    TWICE = 0
    DECIDED = 1
    EXPLAINED = 2
    ONCE = 3
    DIFFERENTLY = 4


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A fact with different values in the spec and in the second reading.

    A place is empty if a reading does not state the fact. ``nearest_path`` is then the place in the spec where it
    should be. ``is_name`` is set if the values are names of the same item, and ``resized_frame`` contains the words for
    a frame whose length differs. ``order_codes`` contains the codes with different values, or none if all codes have
    them.
    """

    fact_class: FactClass
    description: str
    spec_value: str
    second_value: str
    path_in_spec: Path
    path_in_second: Path
    nearest_path: Path = ()
    is_name: bool = False
    resized_frame: str = ""
    order_codes: frozenset[str] = frozenset()

    @property
    def path_in_spec_or_nearest(self) -> Path:
        """The place in the spec, or the place where the spec would state the fact."""
        return self.path_in_spec or self.nearest_path


@dataclass(slots=True)
class Comparison:
    """The result of comparing two readings: how often each fact of the spec was read, and the disagreements.

    Facts are identified by their class and place. ``has_names_of_spec`` is set if the second reading uses the names of
    the spec.
    """

    how_often_read_by_fact: dict[tuple[FactClass, Path], HowOftenRead] = field(default_factory=dict)
    disagreements: list[Disagreement] = field(default_factory=list)
    has_names_of_spec: bool = False

    def count_fact(self, fact_class: FactClass, path_in_spec: Path, read: HowOftenRead) -> None:
        """Remember how often a fact of the spec was read. If several facts have this place, the worst count remains."""
        key = fact_class, path_in_spec
        self.how_often_read_by_fact[key] = max(read, self.how_often_read_by_fact.get(key, HowOftenRead.TWICE))

    def add_disagreement(self, disagreement: Disagreement) -> None:
        """Add a disagreement once, and count its fact as read differently if the spec has it."""
        if disagreement.path_in_spec:
            self.count_fact(disagreement.fact_class, disagreement.path_in_spec, HowOftenRead.DIFFERENTLY)
        if disagreement not in self.disagreements:
            self.disagreements.append(disagreement)


#: Classes of facts in texts. A second reading may list texts that the spec no longer contains.
_CLASSES_IN_WORDS = (FactClass.TEXT, FactClass.SECTION)


#: Classes of facts whose values are places or words. Numbers in them are not related to equal numbers elsewhere.
_CLASSES_WITH_OWN_NUMBERS = (
    FactClass.SECTION,
    FactClass.CONTENTS,
    FactClass.PRINTED,
    FactClass.ADDRESS,
    FactClass.POSITION,
)
#: Classes of facts that can follow from the parameters of an order code.
_CLASSES_FROM_PARAMETERS = frozenset(
    (FactClass.POSITION, FactClass.LIMIT, FactClass.MEASUREMENT, FactClass.ORDER_CODE, FactClass.DEFAULT)
)


#: The bits that a disagreement is about, as its description names them.
_BITS = re.compile(r"\bbits? \d")
#: A number in decimal, or in hexadecimal with its mark.
_NUMBER_IN_TEXT = re.compile(r"0x[0-9A-Fa-f]+|\d[0-9A-F]*h\b|\d+(?:\.\d+)?")

#: The edition that a fact of the history is about.
_EDITION_OF_HISTORY = re.compile(r"of the edition '.*'")


class _Renaming(NamedTuple):
    """A renamed item as the cause of disagreements: its names in the spec and in the second reading, without quotes."""

    spec_name: str
    second_name: str


class _ChangedNumbers(NamedTuple):
    """Numbers as the cause of disagreements: the digits of those that only one of the two readings has.

    For 30 ms in the spec and 50 ms in the second reading, these are ``{"3"}`` and ``{"5"}``.
    """

    only_in_spec: frozenset[str]
    only_in_second: frozenset[str]


@dataclass(frozen=True)
class DisagreementsWithOneCause:
    """A disagreement, and other disagreements that have the same cause."""

    first_disagreement: Disagreement
    others: tuple[Disagreement, ...] = ()

    @property
    def is_text_without_spec(self) -> bool:
        """Whether this is about a text that the second reading lists, but the spec does not contain."""
        return self.first_disagreement.fact_class in _CLASSES_IN_WORDS and self.first_disagreement.spec_value == NOTHING


def group_by_cause(disagreements: Sequence[Disagreement]) -> list[DisagreementsWithOneCause]:
    """Return the disagreements in groups with the same cause.

    A disagreement joins the group of a cause that is already known and explains it. Otherwise, its own cause is a new
    group. A disagreement without a cause is a group of its own. In a frame of a different length, many bits differ, so
    only the length is reported.
    """
    resized_frames = [disagreement.resized_frame for disagreement in disagreements if disagreement.resized_frame]
    reported_disagreements = [
        disagreement for disagreement in disagreements if not _is_in_frame(disagreement, resized_frames)
    ]
    reported_disagreements.sort(key=_sort_key)
    disagreements_by_cause: dict[object, list[Disagreement]] = {}
    for index, disagreement in enumerate(reported_disagreements):
        cause = _find_cause(disagreement, reported_disagreements, known_causes=disagreements_by_cause.keys())
        # The index is a unique key, so that a disagreement without a cause is not grouped.
        disagreements_by_cause.setdefault(cause or index, []).append(disagreement)
    groups = disagreements_by_cause.values()
    return [DisagreementsWithOneCause(first_disagreement=group[0], others=tuple(group[1:])) for group in groups]


def _find_cause(
    disagreement: Disagreement, all_disagreements: Sequence[Disagreement], known_causes: Collection[object]
) -> object:
    """Return the first cause that explains a disagreement: a known one, one shared with others, or its own, or None."""
    return (
        _known_renaming_of_entry(disagreement, known_causes)
        or _known_renaming_of_owner(disagreement, known_causes)
        or _known_change_of_time(disagreement, known_causes)
        or _exchanged_bits(disagreement, all_disagreements)
        or _changed_parameters(disagreement, all_disagreements)
        or _register_that_only_second_has(disagreement, all_disagreements)
        or _known_own_cause(disagreement, known_causes)
        or _number_that_texts_lack(disagreement, all_disagreements)
        or _own_cause(disagreement)
    )


def _sort_key(disagreement: Disagreement) -> tuple[bool, bool, bool, bool, bool]:
    """Return a key for sorting disagreements so that causes come before the disagreements that they explain.

    Names come first, then printed names. Numbers in texts, unlisted values of order codes, and times that are not in
    the spec come last.
    """
    is_open_value = disagreement.path_in_second[-1:] == ("open",)
    is_time_without_spec = disagreement.fact_class is FactClass.TIME and disagreement.spec_value == NOTHING
    return (
        not disagreement.is_name,
        disagreement.fact_class is FactClass.PRINTED,
        disagreement.fact_class in _CLASSES_IN_WORDS,
        is_open_value,
        is_time_without_spec,
    )


def _is_in_frame(disagreement: Disagreement, frames: Sequence[str]) -> bool:
    """Return whether a disagreement is only about bits in some frames, given as ``of the encoder's frame``.

    Either its description names a frame, or its values are lists that only differ in items that name a frame.
    """
    if disagreement.resized_frame or not frames:
        return False
    any_frame = re.compile(rf"(?:{'|'.join(map(re.escape, frames))})(?![\w.])")
    if any_frame.search(disagreement.description):
        return True
    # The values may be lists, such as the bits of an alarm in several frames.
    spec_items, second_items = disagreement.spec_value.split(", "), disagreement.second_value.split(", ")
    spec_items_elsewhere = [bits_text for bits_text in spec_items if not any_frame.search(bits_text)]
    second_items_elsewhere = [bits_text for bits_text in second_items if not any_frame.search(bits_text)]
    has_items_in_frame = (spec_items_elsewhere, second_items_elsewhere) != (spec_items, second_items)
    differ_only_in_frame = spec_items_elsewhere == second_items_elsewhere
    return has_items_in_frame and differ_only_in_frame


def _known_own_cause(disagreement: Disagreement, known_causes: Collection[object]) -> object:
    """Return the own cause of a disagreement if it is already known, or None."""
    cause = _own_cause(disagreement)
    return cause if cause in known_causes else None


def _own_cause(disagreement: Disagreement) -> object:
    """Return the cause of a disagreement, which is equal for disagreements with the same cause, or None.

    The cause is a renamed item, missing texts, missing order codes, an edition in the history, a table with missing
    rows, or the values in which the readings differ.
    """
    if disagreement.fact_class in _CLASSES_IN_WORDS and disagreement.spec_value == NOTHING:
        return "text that only the second reading has"
    if disagreement.is_name:
        return _Renaming(_plain_name(disagreement.spec_value), _plain_name(disagreement.second_value))
    if disagreement.fact_class is FactClass.ORDER_CODE and NOTHING in (
        disagreement.spec_value,
        disagreement.second_value,
    ):
        return "order codes"
    if disagreement.fact_class is FactClass.HISTORY:
        edition = _EDITION_OF_HISTORY.search(disagreement.description)
        return edition[0] if edition is not None else None
    # The place of a whole table is ("tables", name), and the place of a row is longer.
    is_whole_table = len(disagreement.path_in_spec) == 2
    if disagreement.fact_class is FactClass.TABLE and (is_whole_table or disagreement.spec_value == NOTHING):
        _, table_name, *_ = disagreement.path_in_second
        return "rows of a table", table_name
    return _changed_values(disagreement)


def _changed_values(disagreement: Disagreement) -> object:
    """Return the numbers in which two values differ, without their units, or the two signals of a contact, or None.

    30 ms in the spec and 50 ms in the second reading have the same cause as 30,000 and 50,000 µs. Numbers in positions
    and addresses are not related to equal numbers elsewhere.
    """
    # A number can occur several times, so each occurrence counts.
    spec_digits = Counter(_digits_of_numbers(disagreement.spec_value))
    second_digits = Counter(_digits_of_numbers(disagreement.second_value))
    only_in_spec, only_in_second = spec_digits - second_digits, second_digits - spec_digits
    if only_in_spec and only_in_second and disagreement.fact_class not in _CLASSES_WITH_OWN_NUMBERS:
        return _ChangedNumbers(frozenset(only_in_spec), frozenset(only_in_second))
    if disagreement.fact_class is FactClass.PIN:
        return "signals", frozenset((disagreement.spec_value, disagreement.second_value))
    return None


def _exchanged_bits(disagreement: Disagreement, all_disagreements: Sequence[Disagreement]) -> object:
    """Return the register or frame in which a field has other bits, if this explains the disagreement, or None.

    The two readings then have the same items at different bits. Names, defaults and values of these bits differ too.
    """
    if not _BITS.search(disagreement.description):
        return None
    owner_path = _register_or_frame_of(disagreement)
    disagreements_on_bits: list[Disagreement] = []
    for other_disagreement in all_disagreements:
        # Only the description of the bits themselves begins with them.
        is_about_bits = _BITS.match(other_disagreement.description) is not None
        if is_about_bits and _register_or_frame_of(other_disagreement) == owner_path:
            disagreements_on_bits.append(other_disagreement)
    spec_items = sorted(on_bits.spec_value for on_bits in disagreements_on_bits)
    second_items = sorted(on_bits.second_value for on_bits in disagreements_on_bits)
    is_exchange = len(disagreements_on_bits) > 1 and spec_items == second_items
    return ("exchanged bits", owner_path) if is_exchange else None


def _register_or_frame_of(disagreement: Disagreement) -> Path:
    """Return the place of the register or frame that a disagreement is about: the steps before ``fields``."""
    path_in_file = disagreement.path_in_spec or disagreement.path_in_second
    return path_in_file[: path_in_file.index("fields")] if "fields" in path_in_file else ()


def _number_that_texts_lack(disagreement: Disagreement, all_disagreements: Sequence[Disagreement]) -> object:
    """Return the number that several texts of the spec lack, such as ``2µm``, if this text lacks it too, or None.

    Of several numbers, it is the one that most texts lack.
    """
    # Digits without a unit occur in many texts for different reasons.
    numbers_with_unit = {number for number in _numbers_only_in_second(disagreement) if not number.isdigit()}
    text_count_by_number: Counter[str] = Counter()
    for other_disagreement in all_disagreements:
        text_count_by_number.update(numbers_with_unit & _numbers_only_in_second(other_disagreement))
    if not text_count_by_number:
        return None
    text_count, number = max((text_count, number) for number, text_count in text_count_by_number.items())
    return ("number that texts lack", number) if text_count > 1 else None


def _numbers_only_in_second(disagreement: Disagreement) -> Set[str]:
    """Return the numbers with their units that a text has in the second reading, but not in the spec."""
    if disagreement.fact_class is not FactClass.TEXT or NOTHING in (disagreement.spec_value, disagreement.second_value):
        return frozenset()
    return set(disagreement.second_value.split()) - set(disagreement.spec_value.split())


def _changed_parameters(disagreement: Disagreement, all_disagreements: Sequence[Disagreement]) -> object:
    """Return the order codes whose different parameters explain a disagreement about the same order codes, or None.

    A wider field, for example, changes the length of a frame, the highest position and the limit of an offset.
    """
    if disagreement.fact_class not in _CLASSES_FROM_PARAMETERS or not disagreement.order_codes:
        return None
    for other_disagreement in all_disagreements:
        is_parameter = other_disagreement.path_in_spec[:1] == ("parameters",)
        if is_parameter and disagreement.order_codes <= other_disagreement.order_codes:
            return "parameters", other_disagreement.order_codes
    return None


#: A register as the description of a disagreement names it, without its bank.
_REGISTER = re.compile(r"register (?P<address>0x[0-9A-F]+)(?: of bank .*)?")


def _register_that_only_second_has(disagreement: Disagreement, all_disagreements: Sequence[Disagreement]) -> object:
    """Return the address of a register that only the second reading has, if it explains the disagreement, or None.

    Alarms in such a register and procedures that access it are also missing in the spec.
    """
    if disagreement.spec_value != NOTHING:
        return None
    addresses = set(re.findall(r"0x[0-9A-F]+", f"{disagreement.description} {disagreement.second_value}"))
    for other_disagreement in all_disagreements:
        register = _REGISTER.fullmatch(other_disagreement.description)
        is_missing = other_disagreement.spec_value == NOTHING
        if register is not None and is_missing and register["address"] in addresses:
            return "register", register["address"]
    return None


def _digits_of_numbers(text: str) -> list[str]:
    """Return the digits of each number in a text without zeros at both ends: ``["3", "25"]`` for ``30 ms to 2.5 s``."""
    # Without these zeros, 30 ms and 30,000 µs have the same digits. For zero itself, "0" remains.
    return [number.replace(".", "").strip("0") or "0" for number in _NUMBER_IN_TEXT.findall(text)]


def _known_renaming_of_entry(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return a known renaming that explains an entry of the table of contents, or None.

    Only the second reading contains the entry, under the name that it uses.
    """
    if disagreement.fact_class is not FactClass.CONTENTS or disagreement.spec_value != NOTHING:
        return None
    entry_name = _plain_name(str(disagreement.path_in_second[-1]))
    for cause in known_causes:
        if isinstance(cause, _Renaming) and cause.second_name == entry_name:
            return cause
    return None


def _known_renaming_of_owner(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return a known renaming of the part that contains a citation, a text or a printed name, or None."""
    if disagreement.fact_class not in (*_CLASSES_IN_WORDS, FactClass.PRINTED):
        return None
    names_in_path = {_plain_name(str(step)) for step in disagreement.path_in_spec}
    for cause in known_causes:
        if isinstance(cause, _Renaming) and cause.spec_name in names_in_path:
            return cause
    return None


def _known_change_of_time(disagreement: Disagreement, known_causes: Iterable[object]) -> object:
    """Return a known change of a time that explains a time that only the second reading has, or None.

    A time without a symbol is identified by its value, so a different value looks like an additional time.
    """
    if disagreement.fact_class is not FactClass.TIME or disagreement.spec_value != NOTHING:
        return None
    digits = set(_digits_of_numbers(disagreement.second_value))
    for cause in known_causes:
        if isinstance(cause, _ChangedNumbers) and cause.only_in_second == digits:
            return cause
    return None


def _plain_name(name: str) -> str:
    """Return a name without quotes, underscores and capitals: ``speed limit`` for ``'Speed_limit'``."""
    return name.strip("'").replace("_", " ").casefold()
