"""Changes that a maintainer has accepted by name, each with a reason and the date on which it is asked again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from ..language.document import Document
from ..language.problems import Report, listed, quoted, suggestion
from ..language.read import read_document
from .change import Change
from .rules import RULES

#: Name of the file next to the new specs.
NAME = "accepted.yaml"
_KEYS = ("family", "rule", "path", "why", "until")


class NotAccepted(ValueError):
    """The file with accepted changes is not valid. The message says where and why."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """An accepted change. It counts again after the day ``until``."""

    family: str
    rule: str
    path: str
    why: str
    until: date

    def covers(self, change: Change) -> bool:
        return (self.family, self.rule, self.path) == (change.family, change.rule.name, change.path)


def read_accepted(place: Path) -> list[Accepted]:
    """Return the accepted changes in a file.

    Raises:
        NotAccepted: The file cannot be read, or an entry lacks a key, names no rule of ``diff``, or has no date.
    """
    report = Report()
    document = read_document(place, report)
    if document is None or report:
        raise NotAccepted(report.problems[0].format().splitlines()[0])
    entries = document.data.get("accepted")
    if set(document.data) != {"accepted"} or not isinstance(entries, list):
        raise NotAccepted(f"{place}:1: the file must have only the key 'accepted', with a list of accepted changes")
    return [_entry(document, index, item) for index, item in enumerate(entries)]


def _entry(document: Document, index: int, item: object) -> Accepted:
    where = f"{document.file}:{document.position(('accepted', index))[0]}"
    if not isinstance(item, dict) or set(item) != set(_KEYS) or not all(isinstance(item[key], str) for key in _KEYS):
        raise NotAccepted(f"{where}: an accepted change has the keys {listed(_KEYS)}, each with text")
    if item["rule"] not in RULES:
        raise NotAccepted(f"{where}: there is no rule {quoted(item['rule'])}{suggestion(item['rule'], RULES)}")
    try:
        return Accepted(**{**item, "until": date.fromisoformat(item["until"])})
    except ValueError:
        raise NotAccepted(f"{where}: 'until' is a date such as 2027-03-31, not {quoted(item['until'])}") from None


def still_open(
    changes: Sequence[Change], accepted: Sequence[Accepted], today: date
) -> tuple[list[Change], Sequence[str]]:
    """Return the changes without a valid entry on this day, and a notice about each entry."""
    current = [item for item in accepted if item.until >= today]
    found = [change for change in changes if not any(item.covers(change) for item in current)]
    return found, tuple(_notices(changes, accepted, today))


def _notices(changes: Sequence[Change], accepted: Sequence[Accepted], today: date) -> Iterator[str]:
    for item in accepted:
        name = f"{item.family}: {item.rule} {item.path}"
        if not any(map(item.covers, changes)):
            yield f"accepted, but not found: {name}{_meant(item, changes)}"
        elif item.until < today:
            yield f"accepted until {item.until} only, so asked again: {name}: {item.why}"
        else:
            yield f"accepted until {item.until}: {name}: {item.why}"


def _meant(item: Accepted, changes: Sequence[Change]) -> str:
    """Return a suggestion for the family of an entry if it has no changes, or else for the path."""
    families = {change.family for change in changes}
    if item.family not in families:
        return suggestion(item.family, sorted(families), "families with changes")
    same = (change.path for change in changes if (change.family, change.rule.name) == (item.family, item.rule))
    return suggestion(item.path, same, "paths of this rule")
