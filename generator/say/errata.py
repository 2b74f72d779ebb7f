"""Statements about errata of a manual, and about questions that it leaves open."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence, Set

from ..model import INTERFACES, LEFT_OUT, NOT_KNOWN, Alternative, Answer, Device, Erratum, Layout, layer_in_words
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
#: Keys inside a part, with the words that precede the part.
_WORDS_BEFORE_KEYS = {
    "note": "the note on {}",
    "meaning": "the meaning of {}",
    "default": "the default of {}",
    "min": "the minimum of {}",
    "max": "the maximum of {}",
    "implemented": "whether {} is implemented",
    "interfaces": "the interfaces of {}",
    "when_active": "the meaning of an active {}",
    "when_inactive": "the meaning of an inactive {}",
    "wait_at_least_ms": "the wait in ms after a write to {}",
    "at_least_ms": "the minimum time in ms for {}",
    "open": "unlisted values of {}",
    "open_only_with": "the values that may accompany unlisted values of {}",
}
#: Lists of named items, with the word for one item.
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
#: Words for keys whose parts are abbreviations or one word in the spec.
_WORDS_OF_STEPS = {
    "data_ids": "data IDs",
    "measurement": "unit of the position",
    "profile_id": "profile ID",
    "ssi_word": "SSI word",
    "timeout": "time-out",
}
_PATH_PATTERN = re.compile(r"[A-Za-z0-9_]+([.][A-Za-z0-9_+/ -]+)*")
#: Number of an item in a list without names, counted from 1.
_INDEX_IN_LIST = re.compile(r"\[([0-9]+)\]")
_MORE_ITEMS = re.compile(r" and ([0-9]+ more)$")


def paths_in_words(paths: str) -> str:
    """Return paths such as ``registers.bank.default, supply and 2 more`` in words.

    The result is ``the default of the register bank, the supply and 2 more``.
    """
    number_of_more = _MORE_ITEMS.search(paths)
    listed_paths = _MORE_ITEMS.sub("", paths).split(", ")
    phrases = [_path_in_words(listed_path.split(".")) for listed_path in listed_paths]
    if number_of_more is not None:
        phrases.append(number_of_more[1])
    return "".join(map(str, list_parts(phrases)))


def change_in_words(printed: str) -> str:
    """Return a part and its value in words: ``bank.default: 50`` becomes ``the default of the register bank: 50``.

    Text that does not begin with paths is unchanged.
    """
    paths, colon, new_value = printed.partition(": ")
    # A number such as [1] becomes a step.
    numbered_paths = _INDEX_IN_LIST.sub(r".\1", paths)
    are_paths = all(map(_PATH_PATTERN.fullmatch, _MORE_ITEMS.sub("", numbered_paths).split(", ")))
    return f"{paths_in_words(numbered_paths)}{colon}{new_value}" if are_paths else printed


def _beginning_in_words(steps: Sequence[str]) -> tuple[str, Sequence[str]]:
    """Return the words for the first steps of a path that are described together, and the other steps.

    ``["bank", "default"]`` becomes ``("the register bank", ["default"])``. If no steps are described together, the
    words are empty and all steps are left.
    """
    match steps:
        # order_code.parts.output.values.B
        case ["order_code", "parts", part, "values", value, *other_steps]:
            return f"order codes with {part} {value}", other_steps
        # order_code.parts.output.open
        case ["order_code", "parts", part, key, *other_steps]:
            return f"the order code part {part}", [key, *other_steps]
        # order_code.also_written.1.values.output
        case ["order_code", "also_written", number, "values", part, *other_steps]:
            return f"the values of {part} in spelling {number} on labels", other_steps
    is_register = steps[0] not in (*_WORDS_FOR_LIST_ITEMS, *_TOP_LEVEL_PARTS, "interfaces", "order_code")
    if is_register:
        # Paths of registers may leave out the name of their list.
        return f"the register {steps[0]}", steps[1:]
    return "", steps


def _path_in_words(steps: Sequence[str]) -> str:
    """Return one path in words, such as ``the note on the field status of the register command``.

    The words begin with the outermost step, and each further step is added before or around them. A step without words
    is kept.
    """
    if len(steps) == 1 and steps[0] in _TOP_LEVEL_PARTS:
        return _TOP_LEVEL_PARTS[steps[0]]
    words, remaining_steps = _beginning_in_words(steps)
    # registers.command.fields.status.note: "the register command", "the field status of …", "the note on the field …".
    while remaining_steps:
        match remaining_steps:
            case ["interfaces", name, *later_steps]:
                words = INTERFACES[name].title if name in INTERFACES else name
            case ["order_code", *later_steps]:
                words = "the order code"
            case [list_name, name, *later_steps] if list_name in _WORDS_FOR_LIST_ITEMS:
                words = _of_owner(f"the {_WORDS_FOR_LIST_ITEMS[list_name]} {name}", words)
            case [key] if key in _WORDS_BEFORE_KEYS:
                words = _WORDS_BEFORE_KEYS[key].format(words)
                later_steps = []
            case [row, *later_steps] if row.isdecimal():
                words = _of_owner(f"row {row}", words)
            case [step, *later_steps]:
                words = _of_owner(f"the {_WORDS_OF_STEPS.get(step, step.replace('_', ' '))}", words)
        remaining_steps = later_steps
    return words


def _of_owner(part: str, owner: str) -> str:
    """Return a part with what it belongs to, such as ``the field status of the register command``.

    The owner is omitted if the part is named after it, as in ``the SSI word``.
    """
    return f"{part} of {owner}" if owner and owner not in part.split() else part


#: Words for the status of an erratum. The manual's own evidence or arithmetic resolves a settled erratum.
STATUS_IN_WORDS = {"open": "open", "settled": "resolved"}
#: Longest reason, in characters, that is shown next to code. Errata with wrong data always show their reason.
_LONGEST_INLINE_REASON = 100


def errata(
    device: Device, *paths: str, without: Collection[str] = (), exactly: Collection[str] = (), wording: bool = False
) -> tuple[Erratum, ...]:
    """Return the errata about the parts ``paths`` of the spec or anything inside them, except the parts ``without``.

    Errata about a part in ``exactly`` as a whole are included even if it is in ``without``. Errata about wording are
    included only on request, for pages that show the text of a manual.
    """

    def is_about(affected_path: str) -> bool:
        if affected_path in exactly:
            return True
        return _is_within(affected_path, paths) and not _is_within(affected_path, without)

    candidates = [correction for correction in device.errata if wording or correction.severity != "wording"]
    return tuple(correction for correction in candidates if any(map(is_about, correction.affects)))


def _is_within(path: str, parts: Collection[str]) -> bool:
    """Return whether a path names one of the parts, or something inside it."""
    return path in parts or path.startswith(tuple(f"{part}." for part in parts))


def describe_erratum(correction: Erratum, *, whole: bool = False) -> Statement:
    """Return an erratum in three labelled parts: the printed text, the value used, and the reason.

    The reason is omitted if it is longer than ``_LONGEST_INLINE_REASON``, unless ``whole`` is set or wrong bytes could
    be sent. A change by an overlay or another edition is always given with its reason. ``brief`` is the form in one
    line. It contains the first sentence on the value used, and all sentences if wrong bytes could be sent and the
    erratum is open.
    """
    if correction.overlay or correction.edition:
        return _change_statement(correction)
    may_send_wrong_bytes = correction.severity == "wrong_data"
    shows_reason = whole or may_send_wrong_bytes or len(correction.why) <= _LONGEST_INLINE_REASON
    used = as_sentence(correction.used)
    if correction.only:
        used += " " + as_sentence(f"This applies only to {correction.only}")
    label = f"Erratum: {correction.title} ({STATUS_IN_WORDS[correction.status]})"
    brief_needs_all = may_send_wrong_bytes and correction.status == "open"
    used_in_brief = used if brief_needs_all else _first_sentence(used)
    labelled_texts = [("Printed", correction.printed), ("Used", used)]
    if shows_reason:
        labelled_texts.append(("Why", correction.why))
    return Statement(
        parts=(),
        label=label,
        source=correction.source,
        brief=f"{label}. Used: {used_in_brief}",
        below=tuple(_labelled_statements(labelled_texts)),
    )


#: The end of a sentence that another one follows. Numbers of sections and abbreviations do not end a sentence.
_SENTENCE_END = re.compile(r"(?<=[a-z0-9)°%][.]) (?=[A-Z0-9])")


def _first_sentence(text: str) -> str:
    return _SENTENCE_END.split(text, maxsplit=1)[0]


def _labelled_statements(labelled_texts: Iterable[tuple[str, str]]) -> Iterator[Statement]:
    """Yield a statement for each pair of a label and a text, without those whose text is empty."""
    for label, text in labelled_texts:
        if text:
            yield statement(text, label=label)


def _change_statement(correction: Erratum) -> Statement:
    """Return a change by an overlay, by another edition, or by the editions before one, with its reason below it."""
    # The code is correct for an edition, and the header of a file says where the differences are.
    brief = "" if correction.edition else None
    return Statement(
        parts=(),
        label=layer_in_words(correction.overlay, correction.edition),
        source=correction.source,
        brief=brief,
        below=tuple(_labelled_statements([*changed(correction), ("Why", correction.why)])),
    )


def changed(correction: Erratum) -> Iterator[tuple[str, str]]:
    """Yield a change by an overlay or another edition as labelled texts: the part, and its changed content.

    For example ``("In the spec", "the default of register bank: 50")`` and ``("With the overlay", "20")``. A part that
    is removed or not known has only one text. A changed note is labelled as the text that replaces it.
    """
    change = change_in_words(correction.printed)
    if correction.used == NOT_KNOWN:
        yield "Not known", change
    elif correction.used == LEFT_OUT and correction.edition:
        yield "Not present", change
    elif correction.printed.endswith(".note") and correction.edition:
        yield "Instead of", change
        yield "Text", f"{correction.used}"
    else:
        yield "In the spec", change
        label_of_used = "In that edition" if correction.edition else "With the overlay"
        yield label_of_used, f"{correction.used}"


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
    """Return the question."""
    return statement(alternative.meaning, source=alternative.source)


def describe_answer(choice: Answer) -> Statement:
    """Return one answer, preceded by its name."""
    return statement(CodeText(choice.name), f": {choice.meaning}", source=choice.source)


def needed_answers(device: Device, layout: Layout) -> Iterator[Statement]:
    """Yield a statement for each choice that is needed to read or write a frame of this layout, with its answers."""
    for alternative in device.alternatives_of(layout):
        answers = list_parts([CodeText(choice.name) for choice in alternative.answers], " or ")
        choice = Reference("alternative", alternative.name, alternative.name)
        yield statement("The positions of its fields depend on your choice of ", choice, ": ", *answers)


def answer_names(answers: Sequence[Answer]) -> Iterator[TextPart]:
    """Yield the names of the answers as parts, such as ``as_printed``."""
    yield from list_parts([CodeText(choice.name) for choice in answers])


def deciding_alternatives(alternatives: Sequence[Alternative], parameters: Set[str]) -> list[Alternative]:
    """Return the alternatives whose answers set some of the parameters.

    The list is empty if one of the parameters is set by no alternative. In this case, the answers alone do not decide.
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
