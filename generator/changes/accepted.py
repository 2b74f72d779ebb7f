"""Changes that a maintainer accepted, read from a file next to the new specs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from ..language.document import Document
from ..language.problems import ProblemReport, join_words, quoted, suggest_word
from ..language.read import read_document
from .rules import RULES, Change

#: Name of the file next to the new specs.
NAME = "accepted.yaml"
_ENTRY_KEYS = ("family", "rule", "path", "why", "until")


class NotAccepted(ValueError):
    """The file with accepted changes is not valid. The message says where and why."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """A change that a maintainer accepted. After the day ``until``, it must be accepted again."""

    family: str
    rule: str
    path: str
    why: str
    until: date

    def covers(self, change: Change) -> bool:
        """Return whether this is the accepted change: the same rule at the same path of the same family."""
        return (self.family, self.rule, self.path) == (change.family, change.rule.name, change.path)


def read_accepted(file: Path) -> list[Accepted]:
    """Return the accepted changes in a file.

    Raises:
        NotAccepted: The file cannot be read, or it has a different structure. Or an entry lacks a key, or its rule or
            date is not valid.
    """
    report = ProblemReport()
    document = read_document(file, report)
    if document is None or report.problems:
        first_problem = report.problems[0].format()
        raise NotAccepted(first_problem.splitlines()[0])
    acceptances = document.data.get("accepted")
    if set(document.data) != {"accepted"} or not isinstance(acceptances, list):
        raise NotAccepted(f"{file}:1: the file must have only the key 'accepted', with a list of accepted changes")
    return [_read_acceptance(document, index, acceptance) for index, acceptance in enumerate(acceptances)]


def _read_acceptance(document: Document, index: int, acceptance: object) -> Accepted:
    """Return the accepted change at this index of the file.

    Raises:
        NotAccepted: The entry is not a map with exactly the keys ``_ENTRY_KEYS``, or its rule or date is not valid.
    """
    line, _ = document.position(("accepted", index))
    location = f"{document.file}:{line}"
    if not isinstance(acceptance, dict) or set(acceptance) != set(_ENTRY_KEYS) or not _has_texts(acceptance):
        raise NotAccepted(f"{location}: an accepted change has the keys {join_words(_ENTRY_KEYS)}, each with text")
    rule = acceptance["rule"]
    until = acceptance["until"]
    if rule not in RULES:
        raise NotAccepted(f"{location}: there is no rule {quoted(rule)}{suggest_word(rule, RULES)}")
    try:
        return Accepted(**{**acceptance, "until": date.fromisoformat(until)})
    except ValueError:
        raise NotAccepted(f"{location}: 'until' is a date such as 2027-03-31, not {quoted(until)}") from None


def _has_texts(acceptance: dict[object, object]) -> bool:
    """Return whether all values of an entry are texts."""
    return all(isinstance(value, str) for value in acceptance.values())


def changes_to_accept(
    changes: Sequence[Change], acceptances: Sequence[Accepted], today: date
) -> tuple[list[Change], Sequence[str]]:
    """Return the changes that are not accepted on this day, and one notice about each acceptance.

    An acceptance covers a change of the same family, rule and path, up to and including its last day.
    """
    valid_acceptances = [acceptance for acceptance in acceptances if acceptance.until >= today]
    open_changes: list[Change] = []
    for change in changes:
        if not any(acceptance.covers(change) for acceptance in valid_acceptances):
            open_changes.append(change)
    return open_changes, [_describe_acceptance(acceptance, changes, today) for acceptance in acceptances]


def _describe_acceptance(acceptance: Accepted, changes: Sequence[Change], today: date) -> str:
    """Return a sentence on an acceptance: the change does not exist, the acceptance has expired, or it is valid."""
    accepted_change = f"{acceptance.family}: {acceptance.rule} {acceptance.path}"
    has_change = any(acceptance.covers(change) for change in changes)
    if not has_change:
        return f"accepted, but not found: {accepted_change}{_suggest_correction(acceptance, changes)}"
    if acceptance.until < today:
        return f"accepted until {acceptance.until} only, so asked again: {accepted_change}: {acceptance.why}"
    return f"accepted until {acceptance.until}: {accepted_change}: {acceptance.why}"


def _suggest_correction(acceptance: Accepted, changes: Sequence[Change]) -> str:
    """Return a suggestion for an acceptance that matches no change, such as a similar family or path, or "".

    If its family has changes, the path may be misspelled, so the paths of changes by its rule are suggested.
    """
    families = {change.family for change in changes}
    if acceptance.family not in families:
        return suggest_word(acceptance.family, sorted(families), "families with changes")
    family_changes = [change for change in changes if change.family == acceptance.family]
    paths_of_rule = [change.path for change in family_changes if change.rule.name == acceptance.rule]
    return suggest_word(acceptance.path, paths_of_rule, "paths of this rule")
