"""Order codes: the list of them, and what the text on a label means."""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from ..model import CodePart, Device, OrderCode, Spelling, Variant

#: No label has more characters.
LONGEST = 100

_BRACES = re.compile(r"\{([a-z][a-z0-9_]*)\}")
#: What may follow the code on a label.
_AFTER = r"(?P<tail_>-.*?)?(?P<special_>/S[A-Z0-9]+)?"


class UnknownOrderCode(ValueError):
    """No such order code; the message says which part is wrong and what would be right.

    ``close`` says that the message is the one to show: the text is an order code of the family but for a part of it, or
    it can be none of any family.
    """

    def __init__(self, message: str, close: bool) -> None:
        super().__init__(message)
        self.close = close


@dataclass(frozen=True, slots=True)
class Match:
    """An order code as read from a label.

    ``variant`` is the enumerated code that it stands for. ``unlisted`` names the parts whose value the manual leaves
    open, ``tail`` is what followed the code on the label, ``special`` is set for codes that end in /Sxxx.
    ``written_as_in`` says where codes are written like this label, if that is not as the order codes are listed.
    """

    variant: Variant
    unlisted: tuple[str, ...]
    tail: str
    special: bool
    written_as_in: str = ""


def combinations(order_code: OrderCode) -> Iterator[tuple[str, Mapping[str, str], str, Mapping[str, int]]]:
    """Every enumerated code: its text, the value of each part, the interface, and the parameters that the parts set."""
    for values in itertools.product(*(part.values for part in order_code.parts)):
        chosen = {part.name: value for part, value in zip(order_code.parts, values, strict=True)}
        texts = {name: value.text for name, value in chosen.items()}
        if any(texts.get(name) not in allowed for value in values for name, allowed in value.only_with.items()):
            continue
        sets = {name: number for value in values for name, number in value.sets.items()}
        interface = next((value.interface for value in values if value.interface), "")
        yield filled(order_code.pattern, texts), texts, interface, sets


def filled(pattern: str, texts: Mapping[str, str]) -> str:
    """A pattern with the text of each part in the place of its braces."""
    return _BRACES.sub(lambda brace: texts[brace[1]], pattern)


def find(device: Device, text: str) -> Match:
    """What the label ``text`` means for this family.

    A tail after ``-`` and ``/Sxxx`` are accepted, and blanks mean nothing.

    Raises:
        UnknownOrderCode: A part is missing or wrong, or the text is longer than any label.
    """
    if len(text) > LONGEST:
        reason = (
            f"'{text[:20]}...' is no order code: it has {len(text)} characters, and no label has more than {LONGEST}"
        )
        raise UnknownOrderCode(reason, close=True)
    code = without_blanks(text).upper()
    # A part of the code itself may look like /Sxxx; only what follows the code is taken for that.
    for spelling in (_as_listed(device.order_code), *device.order_code.also_written):
        match = re.fullmatch(_regex(device.order_code, spelling) + _AFTER, code, re.IGNORECASE)
        if match is not None:
            listed = {(item.part, item.text.upper()): item.value for item in spelling.values}
            found = ((part.name, match[part.name]) for part in device.order_code.parts)
            parts = {name: listed.get((name, text), text) for name, text in found}
            variant, unlisted = _resolve(device, parts, code)
            return Match(variant, unlisted, match["tail_"] or "", match["special_"] is not None, spelling.where)
    raise _explain(device, code)


def without_blanks(text: str) -> str:
    """A label or pattern without its blanks: some are printed with them, the same codes elsewhere without."""
    return "".join(text.split())


def spelled(part: CodePart, spelling: Spelling) -> Mapping[str, str]:
    """What stands for each listed value of ``part`` in this spelling, by the text on the label."""
    own = {item.text: item.value for item in spelling.values if item.part == part.name}
    return own or {value.text: value.text for value in part.values}


def beginnings(code: OrderCode) -> tuple[str, ...]:
    """How labels of the family can begin, in capitals and without blanks; an empty text where in any way."""
    found = set[str]()
    for spelling in (_as_listed(code), *code.also_written):
        text, *pieces = _BRACES.split(spelling.pattern)
        texts = [text]
        if not text.strip():
            part = next(item for item in code.parts if item.name == pieces[0])
            is_open = part.open and part.name not in {item.part for item in spelling.values}
            texts = [*spelled(part, spelling), *([""] if is_open else [])]
        found |= {without_blanks(item).upper() for item in texts}
    return tuple(sorted(item for item in found if not any(item != o and item.startswith(o) for o in found)))


def _as_listed(order_code: OrderCode) -> Spelling:
    """Order codes as the manual lists them, as a spelling among others."""
    return Spelling(order_code.pattern, "", (), "", ())


def _resolve(device: Device, parts: Mapping[str, str], code: str) -> tuple[Variant, tuple[str, ...]]:
    """The order code that has these parts, and which of them the manual leaves open."""
    known = {part.name: _listed(part, parts[part.name]) for part in device.order_code.parts}
    variant = _fitting(device, known)
    if variant is None:
        raise UnknownOrderCode(_clash(device, code, parts, known), close=True)
    unlisted = tuple(name for name, value in known.items() if value is None)
    if unlisted:
        shown = {name: value or parts[name] for name, value in known.items()}
        printed = filled(device.order_code.pattern, shown)
        variant = Variant(printed, MappingProxyType(shown), variant.interface, variant.parameters)
    return variant, unlisted


def _listed(part: CodePart, text: str) -> str | None:
    return next((value.text for value in part.values if value.text.upper() == text.upper()), None)


def _fitting(device: Device, known: Mapping[str, str | None]) -> Variant | None:
    """The first enumerated code that has these parts, where None stands for a part that is not listed."""
    unlisted = [part for part in device.order_code.parts if known[part.name] is None]
    for variant in device.variants:
        if all(value in (None, variant.parts[name]) for name, value in known.items()) and all(
            known[other] is None or known[other] in allowed
            for part in unlisted
            for other, allowed in part.open_only_with.items()
        ):
            return variant
    return None


def _regex(order_code: OrderCode, spelling: Spelling, anything: str = "") -> str:
    """A regular expression for the whole code in this spelling; the part ``anything`` may be any text."""
    own = {item.part for item in spelling.values}
    parts = {
        part.name: _any_of(spelled(part, spelling)) if part.name in own else _alternatives(part)
        for part in order_code.parts
    }
    if anything:
        parts[anything] = "[A-Z0-9]*"
    pieces = [
        f"(?P<{piece}>{parts[piece]})" if index % 2 else re.escape(without_blanks(piece))
        for index, piece in enumerate(_BRACES.split(spelling.pattern))
    ]
    return "".join(pieces) + (f"(?:{spelling.then})" if spelling.then else "")


def _alternatives(part: CodePart) -> str:
    return "|".join([_any_of(value.text for value in part.values), *([part.open] if part.open else [])])


def _any_of(texts: Iterable[str]) -> str:
    return "|".join(re.escape(without_blanks(text)) for text in sorted(texts, key=len, reverse=True))


def _clash(device: Device, code: str, parts: Mapping[str, str], known: Mapping[str, str | None]) -> str:
    """What is wrong with parts that are right one by one but not together: those of which another value would do."""
    names = [
        part.name
        for part in device.order_code.parts
        if any(_fitting(device, {**known, part.name: value.text}) for value in part.values)
    ]
    listed = " and ".join(f"{name} '{known[name] or parts[name]}'" for name in names) or "its parts"
    return f"'{code}' has {listed}, which do not go together; the nearest codes are {_nearest(device, code)}"


def _explain(device: Device, code: str) -> UnknownOrderCode:
    """The error that says what is wrong with ``code``: the one part that is missing or not listed, or else the nearest
    codes."""
    found = []
    for part in device.order_code.parts:
        match = re.fullmatch(
            _regex(device.order_code, _as_listed(device.order_code), part.name) + _AFTER, code, re.IGNORECASE
        )
        if match is not None:
            others = [other for other in device.order_code.parts if other is not part]
            found.append(
                (
                    sum(_listed(other, match[other.name]) is None for other in others),
                    match[part.name] != "",
                    part,
                    match[part.name],
                )
            )
    if not found:
        wrong = f"'{code}' is no order code of {device.name.upper()}; the nearest are {_nearest(device, code)}"
        return UnknownOrderCode(wrong, close=False)
    # Rather a part that leaves the others with listed values, and rather a missing one.
    _, _, part, given = min(found, key=lambda item: item[:2])
    valid = ", ".join(value.text for value in part.values)
    wrong = f"has {part.name} '{given}'" if given else f"has no {part.name}"
    return UnknownOrderCode(
        f"'{code}' {wrong}; valid are {valid}. The nearest codes are {_nearest(device, code)}", close=True
    )


def _nearest(device: Device, code: str) -> str:
    return ", ".join(nearest_codes([device], code))


def nearest_codes(devices: Sequence[Device], text: str, least: float = 0.0) -> list[str]:
    """The three enumerated codes that look most like ``text``, or like as much of it as comes before a tail.

    Args:
        devices: The families.
        text: What was taken for an order code.
        least: The likeness, of 1, that a code has to have.
    """
    pieces = text.upper().split("-")

    def likeness(code: str) -> float:
        return difflib.SequenceMatcher(None, code, "-".join(pieces[: code.count("-") + 1])).ratio()

    found = ((likeness(variant.code), variant.code) for device in devices for variant in device.variants)
    return [code for ratio, code in sorted(found, key=lambda item: item[0], reverse=True)[:3] if ratio >= least]
