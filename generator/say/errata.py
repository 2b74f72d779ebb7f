"""Statements about the errata of a manual, and about the questions that it leaves open."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Collection, Iterable, Iterator, Sequence, Set
from itertools import groupby

from ..model import (
    INTERFACES,
    LEFT_OUT,
    NOT_KNOWN,
    Alternative,
    Answer,
    Device,
    Erratum,
    Layout,
    Register,
    layer_in_words,
)
from .text import CodeText, Reference, Statement, TextPart, as_sentence, list_parts, statement

#: Top-level parts of a spec that are not lists of named items.
_TOP_LEVEL_PARTS = {
    "connectors": "the connectors",
    "inputs": "the hardware inputs",
    "supply": "the supply",
    "printed_defaults": "the printed table of defaults",
    "measurement": "the unit of the position",
    "movement": "the movement",
    "characteristics": "the characteristics",
    "leds": "the LEDs",
    "tables": "the tables",
    "alarms": "the alarms",
}
#: Phrase for each key inside a part of a spec. ``{}`` represents the part.
_PHRASES_FOR_KEYS = {
    "note": "the note on {}",
    "meaning": "the meaning of {}",
    "default": "the default of {}",
    "min": "the minimum of {}",
    "max": "the maximum of {}",
    "implemented": "whether {} is implemented",
    "interfaces": "the interfaces of {}",
    "when_active": "the meaning of {} when active",
    "when_inactive": "the meaning of {} when inactive",
    "wait_at_least_ms": "the wait in ms after a write to {}",
    "at_least_ms": "the minimum time in ms for {}",
    "open": "unlisted values of {}",
    "open_only_with": "the values that may accompany unlisted values of {}",
}
#: Words for one item of each list whose items have names.
_WORDS_FOR_LIST_ITEMS = {
    "registers": "register",
    "fields": "field",
    "layouts": "frame",
    "timings": "time",
    "procedures": "procedure",
    "parts": "part",
    "values": "value",
    "alarms": "alarm",
    "crcs": "CRC",
    "parameters": "parameter",
    "connectors": "connector",
    "inputs": "input",
    "field_groups": "group",
    "data_ids": "data ID",
    "steps": "step",
    "contacts": "contact",
    "characteristics": "characteristic",
    "leds": "LED",
    "tables": "table",
    "examples": "example",
    "alternatives": "alternative",
    "documents": "document",
}
#: Keys that single bits of a frame have as their names.
_NAMES_OF_BITS = frozenset({"error", "warning"})
#: Usual spellings of the words in keys.
_SPELLINGS = {
    "crc": "CRC",
    "eeprom": "EEPROM",
    "id": "ID",
    "ids": "IDs",
    "measurement": "unit of the position",
    "ssi": "SSI",
}
#: Beginnings of the words for parts of a spec whose fields are named directly after them in a path.
_OWNERS_OF_FIELDS = ("the register ", "the group ")
#: Keys of a register, which are not names of its fields.
_KEYS_OF_REGISTERS = frozenset(field.name for field in dataclasses.fields(Register))
_INTERFACE_TITLES = frozenset(interface.title for interface in INTERFACES.values())
_PATH_PATTERN = re.compile(r"[A-Za-z0-9_]+([.][A-Za-z0-9_+/ -]+)*")
#: Number of an item in a list without names, counted from 1, such as ``[2]``.
_INDEX_IN_LIST = re.compile(r"\[([0-9]+)\]")
#: The end of a shortened list, such as ``supply and 2 more``.
_MORE_ITEMS = re.compile(r" and ([0-9]+ more)$")
#: A phrase about a named item, such as ``the default of the register bank``.
_NAMED_ITEM = re.compile(
    rf"(?P<before>(?:.* )?)the (?P<kind>{'|'.join(_WORDS_FOR_LIST_ITEMS.values())}) (?P<name>\S+)(?P<after>(?: .*)?)"
)


def paths_in_words(paths: str) -> str:
    """Return a list of paths in a spec as words.

    ``registers.bank.default, supply and 2 more`` becomes ``the default of the register bank, the supply and 2 more``.
    """
    # "and 2 more" at the end.
    end_of_list = _MORE_ITEMS.search(paths)
    listed_paths = _MORE_ITEMS.sub("", paths).split(", ")
    phrases = _join_alike([_path_in_words(listed_path.split(".")) for listed_path in listed_paths])
    if end_of_list is not None:
        (number_of_more_paths,) = end_of_list.groups()
        phrases.append(number_of_more_paths)
    if len(phrases) > 1 and any(" and " in phrase for phrase in phrases):
        # A comma separates "the registers a and b" from what follows.
        return f"{', '.join(phrases[:-1])}, and {phrases[-1]}"
    return "".join(map(str, list_parts(phrases)))


def _join_alike(phrases: Sequence[str]) -> list[str]:
    """Join successive phrases that differ only in a name: ``the register a`` and ``the register b`` to one phrase.

    Phrases about the bits of a frame are joined in the same way: ``the error bit and the warning bit of …``.
    """
    joined_phrases: list[str] = []
    for common_words, similar_phrases in groupby(phrases, _common_words):
        before, kind_of_item, after = common_words
        names = [_name_in_phrase(phrase) for phrase in similar_phrases]
        names_in_words = "".join(map(str, list_parts(names)))
        plural_ending = "s" if len(names) > 1 else ""
        if kind_of_item:
            joined_phrases.append(f"{before}the {kind_of_item}{plural_ending} {names_in_words}{after}")
        elif after:
            joined_phrases.append(f"{names_in_words}{after}")
        else:
            joined_phrases += names
    return joined_phrases


def _common_words(phrase: str) -> tuple[str, str, str]:
    """Return the words before a named item, the kind of the item, and the words after it.

    The kind is empty for the bit of a frame, and everything is empty for a phrase that cannot be joined.
    """
    named_item = _NAMED_ITEM.fullmatch(phrase)
    if named_item is not None:
        return named_item["before"], named_item["kind"], named_item["after"]
    bit_phrase, _, frame_phrase = phrase.partition(" of ")
    return ("", "", f" of {frame_phrase}") if bit_phrase.endswith(" bit") else ("", "", "")


def _name_in_phrase(phrase: str) -> str:
    """Return the part of a phrase that ``_common_words`` omits."""
    named_item = _NAMED_ITEM.fullmatch(phrase)
    if named_item is not None:
        return named_item["name"]
    bit_phrase, _, _ = phrase.partition(" of ")
    return bit_phrase if bit_phrase.endswith(" bit") else phrase


def change_in_words(path_and_value: str) -> str:
    """Return a part of a spec and its value in words: ``bank.default: 50`` as ``the default of the register bank: 50``.

    Text that does not begin with one or more paths is returned unchanged.
    """
    paths, colon, value = path_and_value.partition(": ")
    # A number such as [1] becomes a key of the path.
    paths_with_indices = _INDEX_IN_LIST.sub(r".\1", paths)
    listed_paths = _MORE_ITEMS.sub("", paths_with_indices).split(", ")
    are_paths = all(map(_PATH_PATTERN.fullmatch, listed_paths))
    return f"{paths_in_words(paths_with_indices)}{colon}{value}" if are_paths else path_and_value


def _beginning_in_words(keys: Sequence[str]) -> tuple[str, Sequence[str]]:
    """Return the words for those first keys of a path that need a phrase of their own, and the remaining keys.

    ``["bank", "default"]`` becomes ``("the register bank", ["default"])``. If no keys need such a phrase, the words are
    empty, and all keys remain.
    """
    match keys:
        # order_code.parts.output.values.B
        case ["order_code", "parts", part, "values", value, *remaining_keys]:
            return f"order codes with {part} {value}", remaining_keys
        # order_code.parts.output.open
        case ["order_code", "parts", part, key, *remaining_keys]:
            return f"the order code part {part}", [key, *remaining_keys]
        # order_code.also_written.1.values.output
        case ["order_code", "also_written", number, "values", part, *remaining_keys]:
            return f"the values of {part} in spelling {number} on labels", remaining_keys
    is_register = keys[0] not in (*_WORDS_FOR_LIST_ITEMS, *_TOP_LEVEL_PARTS, "interfaces", "order_code")
    if is_register:
        # Paths of registers may leave out the name of their list.
        return f"the register {keys[0]}", keys[1:]
    return "", keys


def _path_in_words(keys: Sequence[str]) -> str:
    """Return the keys of one path in words, such as ``the note on the field status of the register command``.

    The words begin with the outermost key, and each further key is added before or around them. Underscores in a key
    without a phrase of its own become spaces.
    """
    if len(keys) == 1 and keys[0] in _TOP_LEVEL_PARTS:
        return _TOP_LEVEL_PARTS[keys[0]]
    path_text, remaining_keys = _beginning_in_words(keys)
    # registers.command.fields.status.note: "the register command", "the field status of …", "the note on the field …".
    while remaining_keys:
        match remaining_keys:
            case ["interfaces", name, *later_keys]:
                path_text = INTERFACES[name].title if name in INTERFACES else name
            case ["order_code", *later_keys]:
                path_text = "the order code"
            case [list_name, name, *later_keys] if list_name in _WORDS_FOR_LIST_ITEMS:
                path_text = _of_owner(f"the {_WORDS_FOR_LIST_ITEMS[list_name]} {name}", path_text)
            case [key] if key in _PHRASES_FOR_KEYS:
                path_text = _PHRASES_FOR_KEYS[key].format(path_text)
                later_keys = []
            case [row_number, *later_keys] if row_number.isdecimal():
                path_text = _of_owner(f"row {row_number}", path_text)
            case [key, *later_keys]:
                is_field = path_text.startswith(_OWNERS_OF_FIELDS) and key not in _KEYS_OF_REGISTERS
                key_text = f"field {key}" if is_field else _key_in_words(key)
                path_text = _of_owner(f"the {key_text}", path_text)
        remaining_keys = later_keys
    return path_text


def _key_in_words(key: str) -> str:
    """Return a key with spaces in place of underscores, and abbreviations in their usual spelling: ``SSI word``."""
    if key in _NAMES_OF_BITS:
        return f"{key} bit"
    return " ".join(_SPELLINGS.get(word, word) for word in key.split("_"))


def _of_owner(part: str, owner: str) -> str:
    """Return a part with its owner, such as ``the field status of the register command``.

    An interface comes before the part: ``the RS-485 position reply``. The owner is omitted if it is empty, or if the
    part already contains its name, as in ``the SSI word``.
    """
    if not owner or owner in part.split():
        return part
    name_of_part = part.removeprefix("the ")
    is_compound = owner in _INTERFACE_TITLES and name_of_part != part and " of " not in part
    return f"the {owner} {name_of_part}" if is_compound else f"{part} of {owner}"


#: Words for the status of an erratum. The manual's own evidence or arithmetic resolves a settled erratum.
STATUS_IN_WORDS = {"open": "open", "settled": "resolved"}
#: Longest reason, in characters, that is shown next to code. Errata with wrong data always show their reason.
_LONGEST_INLINE_REASON = 100


def errata_affecting(
    device: Device, *paths: str, without: Collection[str] = (), exactly: Collection[str] = (), wording: bool = False
) -> tuple[Erratum, ...]:
    """Return the errata that affect the parts of the spec at these paths, or anything inside these parts.

    Errata about the parts ``without`` are omitted, unless they affect a part in ``exactly`` as a whole. Errata about
    the wording of the manual are included only if ``wording`` is True, for pages that show the manual's text.
    """

    def is_requested(affected_path: str) -> bool:
        if affected_path in exactly:
            return True
        return _is_within(affected_path, paths) and not _is_within(affected_path, without)

    candidates = [erratum for erratum in device.errata if wording or erratum.severity != "wording"]
    # ``affects`` are the paths of the parts of the spec that an erratum is about.
    return tuple(erratum for erratum in candidates if any(map(is_requested, erratum.affects)))


def _is_within(path: str, outer_paths: Collection[str]) -> bool:
    """Return whether a path is one of ``outer_paths``, or leads to something inside one of these parts of the spec."""
    beginnings = tuple(f"{outer_path}." for outer_path in outer_paths)
    return path in outer_paths or path.startswith(beginnings)


def describe_erratum(erratum: Erratum, *, whole: bool = False) -> Statement:
    """Return an erratum in three labelled parts: the printed text, the value used, and the reason.

    A long reason is omitted unless ``whole`` is True or wrong bytes could be sent. A change by an overlay or in another
    edition always has its reason. The field ``brief`` of the statement is the form on one line. It has only the first
    sentence on the value used, but all sentences if the erratum is open and wrong bytes could be sent.
    """
    if erratum.overlay or erratum.edition:
        return _change_statement(erratum)
    may_send_wrong_bytes = erratum.severity == "wrong_data"
    shows_reason = whole or may_send_wrong_bytes or len(erratum.why) <= _LONGEST_INLINE_REASON
    value_used = as_sentence(erratum.used)
    if erratum.only:
        value_used += f" This applies only to {as_sentence(erratum.only)}"
    label = f"Erratum: {erratum.title} ({STATUS_IN_WORDS[erratum.status]})"
    brief_needs_all = may_send_wrong_bytes and erratum.status == "open"
    value_in_brief = value_used if brief_needs_all else _first_sentence(value_used)
    labelled_texts = [("Printed", erratum.printed), ("Used", value_used)]
    if shows_reason:
        labelled_texts.append(("Why", erratum.why))
    return Statement(
        parts=(),
        label=label,
        source=erratum.source,
        brief=f"{label}. Used: {value_in_brief}",
        statements_below=tuple(_labelled_statements(labelled_texts)),
    )


#: The space between two sentences. The period of a section number or an abbreviation does not end a sentence.
_SENTENCE_END = re.compile(r"(?<=[a-z0-9)°%][.]) (?=[A-Z0-9])")


def _first_sentence(text: str) -> str:
    return _SENTENCE_END.split(text, maxsplit=1)[0]


def _labelled_statements(labelled_texts: Iterable[tuple[str, str]]) -> Iterator[Statement]:
    """Yield a statement for each pair of a label and a text, except pairs with an empty text."""
    for label, text in labelled_texts:
        if text:
            yield statement(text, label=label)


def _change_statement(erratum: Erratum) -> Statement:
    """Return a change by an overlay or in another edition, with the changed content and the reason on lines below.

    A change in another edition has an empty brief form: generated code is correct for the edition, and the header of
    each file says where the differences are.
    """
    brief = "" if erratum.edition else None
    return Statement(
        parts=(),
        label=layer_in_words(erratum.overlay, erratum.edition),
        source=erratum.source,
        brief=brief,
        statements_below=tuple(_labelled_statements([*content_before_and_after(erratum), ("Why", erratum.why)])),
    )


def content_before_and_after(erratum: Erratum) -> Iterator[tuple[str, str]]:
    """Yield the content before and after a change by an overlay or in another edition, each with a label.

    For example ``("In the spec", "the default of register bank: 50")`` and ``("With the overlay", "20")``. A part that
    the edition does not have, or whose content there is not known, has a single text.
    """
    change = change_in_words(erratum.printed)
    if erratum.used == NOT_KNOWN:
        yield "Not known", change
    elif erratum.used == LEFT_OUT and erratum.edition:
        yield "Not present", change
    elif erratum.printed.endswith(".note") and erratum.edition:
        yield "Instead of", change
        yield "Text", f"{erratum.used}"
    else:
        yield "In the spec", change
        label_of_used = "In that edition" if erratum.edition else "With the overlay"
        yield label_of_used, f"{erratum.used}"


#: Result of following the manual literally, by the severity of an erratum.
_CONSEQUENCES = {
    "wrong_data": "Following the manual literally gives wrong bytes or bits on the wire",
    "wrong_limit": "Following the manual literally gives a wrong limit or order code",
    "omission": "Information is missing from the manual",
    "wording": "Only the wording of the manual is affected",
}


def consequence(severity: str) -> str:
    """Return the result of following the manual literally, as a sentence without a full stop."""
    return _CONSEQUENCES[severity]


def describe_question(alternative: Alternative) -> Statement:
    """Return a question that the manual leaves open."""
    return statement(alternative.meaning, source=alternative.source)


def describe_answer(answer: Answer) -> Statement:
    """Return one answer to a question that the manual leaves open, preceded by the name of the answer."""
    return statement(CodeText(answer.name), f": {answer.meaning}", source=answer.source)


def needed_answers(device: Device, layout: Layout) -> Iterator[Statement]:
    """Yield a statement for each question whose answer decides the positions of the fields, with its answers."""
    for alternative in device.alternatives_of(layout):
        answer_parts = list_parts([CodeText(answer.name) for answer in alternative.answers], " or ")
        question = Reference("alternative", alternative.name, alternative.name)
        yield statement("The positions of its fields depend on your choice of ", question, ": ", *answer_parts)


def answer_names(answers: Sequence[Answer]) -> Iterator[TextPart]:
    """Yield the names of the answers as parts, such as ``as_printed``."""
    yield from list_parts([CodeText(answer.name) for answer in answers])


def deciding_alternatives(alternatives: Sequence[Alternative], parameters: Set[str]) -> list[Alternative]:
    """Return the alternatives (questions that the manual leaves open) whose answers set any of these parameters.

    If some parameter is not set by any alternative, the answers alone do not decide, and the list is empty.
    """
    deciding: list[Alternative] = []
    decided_parameters: set[str] = set()
    for alternative in alternatives:
        # All answers to an alternative set the same parameters.
        answered_parameters = alternative.answers[0].sets.keys()
        if parameters & answered_parameters:
            deciding.append(alternative)
            decided_parameters |= answered_parameters
    are_all_decided = parameters <= decided_parameters
    return deciding if are_all_decided else []
