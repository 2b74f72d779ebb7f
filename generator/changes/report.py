"""Reports on changes: as data, as text, and as files about a release with the changes that a maintainer accepted."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any

from ..language.document import Document
from ..language.problems import Report, listed, quoted, suggestion
from ..language.read import read_document
from ..loading.evidence import history_beside, history_text, with_release
from ..loading.overlays import Family
from ..model import Manual, Release, ReleasedChange
from ..say.markdown import code as in_code
from ..say.markdown import text
from ..say.plain_text import WIDTH, counted, first_of, wrapped
from .names import NameChange
from .rules import OUTPUTS, RULES, TITLES, Change, Impact, Package

#: Version of the data, in the shape of ``language/diff.schema.json``.
VERSION = 2


@dataclass(frozen=True)
class Files:
    """The generated files that differ, the number of all, and the names in them that go or change their value."""

    changed: tuple[str, ...]
    count: int
    names: tuple[NameChange, ...] = ()


@dataclass(frozen=True)
class DiffResult:
    """Everything that ``diff`` found. ``files`` is None if nothing could be generated."""

    changes: Sequence[Change]
    packages: Sequence[Package]
    files: Files | None = None
    notices: Sequence[str] = field(default=())

    @property
    def impact(self) -> Impact:
        return max((change.impact for change in self.changes), default=Impact.NONE)


def outputs(change: Change, code: str = "{}") -> str:
    """Return the outputs that a change affects, most affected first. ``code`` is the format of a name."""
    texts, impacts = [], dict(zip(OUTPUTS, change.rule.impacts, strict=True))
    for impact in sorted(set(impacts.values()), reverse=True):
        if impact is Impact.NONE or (impact is Impact.DOCUMENTATION and change.impact is not impact):
            continue
        names = [_output(change, name, code) for name, output_impact in impacts.items() if output_impact is impact]
        # Every change affects the pages. They are named only if no other output is.
        texts.append(", ".join(names) + ("" if impact is change.impact else f" ({impact.word})"))
    return "; ".join(texts)


def _output(change: Change, name: str, code: str) -> str:
    code_name = change.names.get(name, "")
    return f"{TITLES[name]} {code.format(code_name)}" if code_name else TITLES[name]


def about(change: Change, code: str = "{}") -> str:
    """Return the order codes and the outputs that a change affects."""
    return "; ".join(filter(None, (change.reach, outputs(change, code))))


def totals(changes: Sequence[Change]) -> str:
    """Return a summary such as ``5 changes: 2 breaking, 3 behaviour``."""
    counts = _counts(changes)
    texts = [f"{counts[impact]} {impact.word}" for impact in reversed(Impact) if counts[impact]]
    return f"{counted(len(changes), 'change')}: {', '.join(texts)}"


def _counts(changes: Sequence[Change]) -> Counter[Impact]:
    """Return the number of changes with each impact."""
    return Counter(change.impact for change in changes)


def versions(package: Package) -> str:
    """Return the old and the new version, and the stated version if it must be updated."""
    if package.old == package.new == package.stated:
        return f"{package.name} stays {package.old}"
    step = f"{package.name} {package.old} → {package.new}"
    if package.is_enough:
        return step
    return f"{step}, but the spec still says {package.stated}"


def as_data(findings: DiffResult) -> dict[str, Any]:
    """Return the output of ``codewheel diff --json``."""
    counts, files = _counts(findings.changes), findings.files
    return {
        "version": VERSION,
        "impact": findings.impact.word,
        "counts": {impact.word: counts[impact] for impact in Impact if impact},
        "changes": list(map(_change_data, findings.changes)),
        "generated": _files_data(files) if files else None,
        "packages": list(map(_package_data, findings.packages)),
        "notices": list(findings.notices),
    }


def _files_data(files: Files) -> dict[str, Any]:
    names = [
        {"family": name.family, "kind": name.kind, "name": name.name, "old": name.old, "new": name.new}
        for name in files.names
    ]
    return {"files": files.count, "changed": list(files.changed), "names": names}


def _package_data(package: Package) -> dict[str, str]:
    return {
        "name": package.name,
        "old": package.old,
        "stated": package.stated,
        "due": package.due,
        "new": package.new,
    }


def _change_data(change: Change) -> dict[str, Any]:
    return {
        "family": change.family,
        "rule": change.rule.name,
        "impact": change.impact.word,
        "outputs": {name: impact.word for name, impact in zip(OUTPUTS, change.rule.impacts, strict=True)},
        "path": change.path,
        "text": change.text,
        "old": change.old,
        "new": change.new,
        "order_codes": list(change.codes),
        "reach": change.reach,
        "names": dict(change.names),
    }


_TITLES = {
    Impact.BREAKING: "Breaking",
    Impact.BEHAVIOUR: "Behaviour",
    Impact.COMPATIBLE: "Compatible",
    Impact.DOCUMENTATION: "Documentation",
}


def as_markdown(findings: DiffResult) -> str:
    """Return the output of ``codewheel diff --markdown``: a heading for each package, family and impact."""
    lines = [f"## {'; '.join(map(versions, findings.packages)) or 'Changes'}", ""]
    lines += [line for notice in findings.notices for line in (text(notice), "")]
    for family in dict.fromkeys(change.family for change in findings.changes):
        lines += [f"### {text(family)}", ""]
        lines += _family([change for change in findings.changes if change.family == family])
        name_lines = [f"- {text(line)}" for line in _names_of(findings, family)]
        lines += ["#### Names in code", "", *name_lines, ""] if name_lines else []
    if not findings.changes:
        lines += ["No differences.", ""]
    if findings.changes and findings.files is not None:
        lines += [f"{len(findings.files.changed)} of {findings.files.count} generated files change.", ""]
    return "\n".join(lines).rstrip()


def _names_of(findings: DiffResult, family: str) -> list[str]:
    """Return the changes of names of a family in generated files."""
    names = findings.files.names if findings.files is not None else ()
    return [name.text for name in names if name.family == family]


def _family(changes: Sequence[Change]) -> Iterator[str]:
    for impact, title in _TITLES.items():
        changes_of_impact = [change for change in changes if change.impact is impact]
        if changes_of_impact:
            yield from (f"#### {title}", "", *map(_item, changes_of_impact), "")


def _item(change: Change) -> str:
    return f"- {text(change.text)} ({in_code(change.rule.name)}): {_about(change)}"


def _about(change: Change) -> str:
    pieces = about(change, "\0{}\0").split("\0")  # Prose and code in turn.
    pieces[::2] = map(_escaped, pieces[::2])
    pieces[1::2] = map(in_code, pieces[1::2])
    return "".join(pieces)


def _escaped(piece: str) -> str:
    """Return escaped text with its leading and trailing space."""
    start = " " if piece.startswith(" ") else ""
    end = " " if piece.endswith(" ") else ""
    return f"{start}{text(piece)}{end}" if piece.strip() else piece


_COLUMN = 17
#: Names that are listed in the text. The others are counted.
_MOST_NAMES = 4


def as_text(findings: DiffResult) -> str:
    """Return the output of ``codewheel diff``."""
    lines = list(findings.notices)
    for family in dict.fromkeys(change.family for change in findings.changes):
        family_changes = [change for change in findings.changes if change.family == family]
        lines.append(family)
        for change in sorted(family_changes, key=lambda change: (-change.impact, change.rule.is_renaming)):
            if change.impact > Impact.DOCUMENTATION:
                lines += _change(change)
        lines += _words([change for change in family_changes if change.impact is Impact.DOCUMENTATION])
        lines += _names(_names_of(findings, family))
    lines.append(totals(findings.changes) if findings.changes else "no differences")
    if findings.changes:
        lines += _result(findings)
    return "\n".join(lines)


def _change(change: Change) -> Iterator[str]:
    indent = " " * _COLUMN
    yield wrapped(change.text, WIDTH, indent, f"  {change.rule.word:<13}  ")
    yield wrapped(f"{about(change)} [{change.rule.name}]", WIDTH, indent)


def _words(changes: Sequence[Change]) -> Iterator[str]:
    """Yield the documentation changes: the places of the first few, and the number of the others."""
    for rule in dict.fromkeys(change.rule for change in changes):
        changes_of_rule = [change for change in changes if change.rule is rule]
        texts = first_of([_place(change) for change in changes_of_rule], between="; ")
        yield wrapped(f"{texts} [{rule.name}]", WIDTH, " " * _COLUMN, f"  {rule.word:<13}  ")


def _names(texts: Sequence[str]) -> Iterator[str]:
    """Yield the first names that go or change their value, and the number of the others."""
    if texts:
        others = f"; and {len(texts) - _MOST_NAMES} more, all with --markdown" if len(texts) > _MOST_NAMES else ""
        names = "; ".join(texts[:_MOST_NAMES])
        yield wrapped(f"{names}{others}", WIDTH, " " * _COLUMN, f"  {'names':<13}  ")


def _place(change: Change) -> str:
    path = change.path.removeprefix("interfaces.").replace(".layouts.", ".")
    return path if change.rule.name in ("words", "source") else change.text


def _result(findings: DiffResult) -> Iterator[str]:
    """Yield the line about generated files and versions."""
    parts = []
    if findings.files is not None:
        count = len(findings.files.changed)
        parts.append(f"{count} of {counted(findings.files.count, 'file')} change{'s' * (count == 1)}")
    parts += map(versions, findings.packages)
    if parts:
        yield wrapped(f"generated: {'; '.join(parts)}", WIDTH, "  ", "")


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


def read_accepted(file: Path) -> list[Accepted]:
    """Return the accepted changes in a file.

    Raises:
        NotAccepted: The file cannot be read, or an entry lacks a key, names no rule of ``diff``, or has no date.
    """
    report = Report()
    document = read_document(file, report)
    if document is None or report:
        raise NotAccepted(report.problems[0].format().splitlines()[0])
    entries = document.data.get("accepted")
    if set(document.data) != {"accepted"} or not isinstance(entries, list):
        raise NotAccepted(f"{file}:1: the file must have only the key 'accepted', with a list of accepted changes")
    return [_entry(document, index, definition) for index, definition in enumerate(entries)]


def _entry(document: Document, index: int, definition: object) -> Accepted:
    location = f"{document.file}:{document.position(('accepted', index))[0]}"
    if not isinstance(definition, dict) or set(definition) != set(_KEYS) or not _has_texts(definition):
        raise NotAccepted(f"{location}: an accepted change has the keys {listed(_KEYS)}, each with text")
    rule, until = definition["rule"], definition["until"]
    if rule not in RULES:
        raise NotAccepted(f"{location}: there is no rule {quoted(rule)}{suggestion(rule, RULES)}")
    try:
        return Accepted(**{**definition, "until": date.fromisoformat(until)})
    except ValueError:
        raise NotAccepted(f"{location}: 'until' is a date such as 2027-03-31, not {quoted(until)}") from None


def _has_texts(definition: dict[object, object]) -> bool:
    return all(isinstance(value, str) for value in definition.values())


def still_open(
    changes: Sequence[Change], accepted: Sequence[Accepted], today: date
) -> tuple[list[Change], Sequence[str]]:
    """Return the changes without a valid entry on this day, and a notice about each entry."""
    current = [acceptance for acceptance in accepted if acceptance.until >= today]
    open_changes = [change for change in changes if not _is_accepted(change, current)]
    return open_changes, tuple(_notices(changes, accepted, today))


def _is_accepted(change: Change, accepted: Sequence[Accepted]) -> bool:
    return any(acceptance.covers(change) for acceptance in accepted)


def _notices(changes: Sequence[Change], accepted: Sequence[Accepted], today: date) -> Iterator[str]:
    for acceptance in accepted:
        name = f"{acceptance.family}: {acceptance.rule} {acceptance.path}"
        if not any(map(acceptance.covers, changes)):
            yield f"accepted, but not found: {name}{_suggestion(acceptance, changes)}"
        elif acceptance.until < today:
            yield f"accepted until {acceptance.until} only, so asked again: {name}: {acceptance.why}"
        else:
            yield f"accepted until {acceptance.until}: {name}: {acceptance.why}"


def _suggestion(acceptance: Accepted, changes: Sequence[Change]) -> str:
    """Return a suggestion for the family of an entry if it has no changes, or else for the path."""
    families = {change.family for change in changes}
    if acceptance.family not in families:
        return suggestion(acceptance.family, sorted(families), "families with changes")
    of_family = [change for change in changes if change.family == acceptance.family]
    paths = (change.path for change in of_family if change.rule.name == acceptance.rule)
    return suggestion(acceptance.path, paths, "paths of this rule")


_VERSION = re.compile(r"^(version:[ \t]*)(['\"]?)[0-9.]+\2", re.MULTILINE)


class NotRecorded(ValueError):
    """A file cannot be updated. The message says which one."""


def records(findings: DiffResult, families: Sequence[Family]) -> Iterator[tuple[Path, str]]:
    """Yield the files to write with their new texts, except for manufacturers without changes.

    Raises:
        NotRecorded: A manufacturer's file has no version to replace.
    """
    for package in findings.packages:
        families_of_maker = [family for family in families if family.device.manufacturer.name == package.maker]
        changed_names = {change.family for change in findings.changes}
        changed_families = [family for family in families_of_maker if family.device.name in changed_names]
        if not changed_families:
            continue
        files: set[str] = set()
        for family in families_of_maker:
            files |= family.files - {family.document.file}
        yield from _version_text(package, files)
        for family in changed_families:
            changes = [change for change in findings.changes if change.family == family.device.name]
            release = _release(package, family.device.manual, changes, _names_of(findings, family.device.name))
            text = history_text(with_release(family.device.releases, release))
            yield history_beside(Path(family.document.file)), text


def _version_text(package: Package, files: set[str]) -> Iterator[tuple[Path, str]]:
    if package.new == package.stated:
        return
    for file in map(Path, sorted(files)):
        text, count = _VERSION.subn(rf'\g<1>"{package.new}"', file.read_text(encoding="utf-8"))
        if count != 1:
            raise NotRecorded(f'{file} has no line like version: "{package.stated}"; set it to {package.new} by hand')
        yield file, text


def _release(package: Package, manual: Manual, changes: Sequence[Change], names: Sequence[str]) -> Release:
    manual_text = f"{manual.revision}{f' of {manual.date}' if manual.date else ''}"
    return Release(package.new, package.old, manual_text, tuple(map(_released_change, changes)), tuple(names))


def _released_change(change: Change) -> ReleasedChange:
    return ReleasedChange(change.rule.name, change.impact.word, change.text, change.reach, outputs(change))
