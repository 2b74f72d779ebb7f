"""Reports on changes, as data, Markdown and text, without the changes that a maintainer accepted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any

from ..language.document import Document
from ..language.problems import ProblemReport, join_words, quoted, suggest_word
from ..language.read import read_document
from ..say import WIDTH, count_with_unit, first_of, wrap_text
from ..say.text import code_span as in_code
from ..say.text import escape as escaped
from .names import NameChange
from .rules import OUTPUTS, RULES, TITLES, Change, Impact, PackageVersions

#: Version of the JSON data, whose structure ``language/diff.schema.json`` describes.
VERSION = 2


@dataclass(frozen=True)
class Files:
    """The generated files in both versions."""

    #: Paths of the files that differ.
    changed_paths: tuple[str, ...]
    #: Number of all generated files.
    file_count: int
    #: Names in the files that are gone or have a different value.
    name_changes: tuple[NameChange, ...] = ()


@dataclass(frozen=True)
class DiffResult:
    """Everything that ``diff`` found. ``files`` is None if nothing could be generated."""

    changes: Sequence[Change]
    packages: Sequence[PackageVersions]
    files: Files | None = None
    notices: Sequence[str] = field(default=())

    @property
    def impact(self) -> Impact:
        return max((change.impact for change in self.changes), default=Impact.NONE)


def describe_outputs(change: Change, code_format: str = "{}") -> str:
    """Return the outputs that a change affects, the most affected first: ``C, Python; XML (compatible)``.

    Outputs with the same impact are in one group. If their impact is lower than the impact of the change, it follows in
    parentheses. ``code_format`` formats a name in code.
    """
    impact_by_output = dict(zip(OUTPUTS, change.rule.impacts, strict=True))
    group_texts: list[str] = []
    for impact in sorted(set(impact_by_output.values()), reverse=True):
        # Every change affects the pages. They are only named if the change affects no other output.
        is_obvious = impact is Impact.DOCUMENTATION and change.impact is not Impact.DOCUMENTATION
        if impact is Impact.NONE or is_obvious:
            continue
        outputs = [output for output in OUTPUTS if impact_by_output[output] is impact]
        group_text = ", ".join(_describe_output(change, output, code_format) for output in outputs)
        if impact is not change.impact:
            group_text += f" ({impact.word})"
        group_texts.append(group_text)
    return "; ".join(group_texts)


def _describe_output(change: Change, output: str, code_format: str) -> str:
    """Return the title of an output, with the name of the changed part in its code: ``Python x24.REGISTERS``."""
    name_in_code = change.names.get(output, "")
    if not name_in_code:
        return TITLES[output]
    return f"{TITLES[output]} {code_format.format(name_in_code)}"


def describe_effect(change: Change, code_format: str = "{}") -> str:
    """Return the affected order codes and outputs, if there are any: ``all 12 order codes; C, Python``."""
    outputs_text = describe_outputs(change, code_format)
    return "; ".join(text for text in (change.affected_codes_text, outputs_text) if text)


def summary(changes: Sequence[Change]) -> str:
    """Return a summary such as ``5 changes: 2 breaking, 3 behaviour``."""
    counts = _counts_by_impact(changes)
    count_texts = [f"{counts[impact]} {impact.word}" for impact in reversed(Impact) if counts[impact]]
    return f"{count_with_unit(len(changes), 'change')}: {', '.join(count_texts)}"


def _counts_by_impact(changes: Sequence[Change]) -> Counter[Impact]:
    """Return the number of changes with each impact."""
    return Counter(change.impact for change in changes)


def describe_versions(package: PackageVersions) -> str:
    """Return the old and the new version of a package: ``acme 1.2.0 → 1.3.0``.

    If the spec states a version that is too low for the changes, the text says so.
    """
    if package.old == package.new == package.stated:
        return f"{package.name} stays {package.old}"
    version_change = f"{package.name} {package.old} → {package.new}"
    if package.is_enough:
        return version_change
    return f"{version_change}, but the spec still says {package.stated}"


def as_data(result: DiffResult) -> dict[str, Any]:
    """Return the result of a comparison as plain data, the output of ``codewheel diff --json``."""
    counts_by_impact = _counts_by_impact(result.changes)
    files = result.files
    return {
        "version": VERSION,
        "impact": result.impact.word,
        "counts": {impact.word: counts_by_impact[impact] for impact in Impact if impact},
        "changes": list(map(_change_data, result.changes)),
        "generated": _files_data(files) if files else None,
        "packages": list(map(_package_data, result.packages)),
        "notices": list(result.notices),
    }


def _files_data(files: Files) -> dict[str, Any]:
    """Return the generated files in the JSON output: their number, those that change, and the changed names."""
    name_changes_data = [
        {"family": change.family, "kind": change.kind, "name": change.name, "old": change.old, "new": change.new}
        for change in files.name_changes
    ]
    return {"files": files.file_count, "changed": list(files.changed_paths), "names": name_changes_data}


def _package_data(package: PackageVersions) -> dict[str, str]:
    return {
        "name": package.name,
        "old": package.old,
        "stated": package.stated,
        "due": package.due,
        "new": package.new,
    }


def _change_data(change: Change) -> dict[str, Any]:
    """Return a change in the JSON output, with its impact on each output: ``{"c": "breaking", "pages": …}``."""
    return {
        "family": change.family,
        "rule": change.rule.name,
        "impact": change.impact.word,
        "outputs": {output: impact.word for output, impact in zip(OUTPUTS, change.rule.impacts, strict=True)},
        "path": change.path,
        "text": change.text,
        "old": change.old,
        "new": change.new,
        "order_codes": list(change.codes),
        "reach": change.affected_codes_text,
        "names": dict(change.names),
    }


_TITLE_BY_IMPACT = {
    Impact.BREAKING: "Breaking",
    Impact.BEHAVIOUR: "Behaviour",
    Impact.COMPATIBLE: "Compatible",
    Impact.DOCUMENTATION: "Documentation",
}


def as_markdown(result: DiffResult) -> str:
    """Return the result of a comparison as Markdown, the output of ``codewheel diff --markdown``.

    It contains the package versions as a heading, notices, a section for each family, and the number of changed files.
    """
    versions_text = "; ".join(map(describe_versions, result.packages))
    lines = [f"## {versions_text or 'Changes'}", ""]
    for notice in result.notices:
        lines += [escaped(notice), ""]
    for family in dict.fromkeys(change.family for change in result.changes):
        lines += _family_section(result, family)
    if not result.changes:
        lines += ["No differences.", ""]
    if result.changes and result.files is not None:
        lines += [f"{len(result.files.changed_paths)} of {result.files.file_count} generated files change.", ""]
    return "\n".join(lines).rstrip()


def _family_section(result: DiffResult, family: str) -> Iterator[str]:
    """Yield the Markdown lines about a family: a heading, the changes by impact, and the changed names in code."""
    yield from (f"### {escaped(family)}", "")
    family_changes = [change for change in result.changes if change.family == family]
    for impact, title in _TITLE_BY_IMPACT.items():
        changes_of_impact = [change for change in family_changes if change.impact is impact]
        if changes_of_impact:
            yield from (f"#### {title}", "", *map(_list_item, changes_of_impact), "")
    name_texts = name_change_texts(result, family)
    if name_texts:
        name_items = [f"- {escaped(name_text)}" for name_text in name_texts]
        yield from ("#### Names in code", "", *name_items, "")


def name_change_texts(result: DiffResult, family: str) -> list[str]:
    """Return texts on the names in generated files of a family that are gone or have a different value.

    Functions whose code differs share one text: ``C functions with different code: x24_read, x24_decode``.
    """
    name_changes = result.files.name_changes if result.files is not None else ()
    texts: list[str] = []
    functions_by_kind: dict[str, list[str]] = {}
    for name_change in name_changes:
        if name_change.family != family:
            continue
        if name_change.is_changed_function:
            functions_by_kind.setdefault(name_change.kind, []).append(name_change.name)
        else:
            texts.append(name_change.text)
    for kind, names in functions_by_kind.items():
        texts.append(f"{kind}s with different code: {', '.join(names)}")
    return texts


def _list_item(change: Change) -> str:
    """Return a change as an item of a Markdown list: its text, its rule, and the order codes and outputs it affects."""
    return f"- {escaped(change.text)} ({in_code(change.rule.name)}): {_effect_in_markdown(change)}"


def _effect_in_markdown(change: Change) -> str:
    """Return the affected order codes and outputs in Markdown: names in code as code, all other text escaped."""
    # A NUL before and after each name marks where to split. Then prose and names alternate, beginning with prose.
    prose_and_names = describe_effect(change, code_format="\0{}\0").split("\0")
    pieces_in_markdown: list[str] = []
    for index, piece in enumerate(prose_and_names):
        is_prose = index % 2 == 0
        pieces_in_markdown.append(_escape_between_spaces(piece) if is_prose else in_code(piece))
    return "".join(pieces_in_markdown)


def _escape_between_spaces(prose: str) -> str:
    """Return escaped prose with the spaces at its beginning and end, which escaping alone would remove."""
    if not prose.strip():
        return prose
    space_before = " " if prose.startswith(" ") else ""
    space_after = " " if prose.endswith(" ") else ""
    return f"{space_before}{escaped(prose)}{space_after}"


#: Column in which the texts begin, after the words for the impacts.
_TEXT_COLUMN = 17
#: Highest number of names that are listed in the text. The others are counted.
_MOST_NAMES = 4


def as_text(result: DiffResult) -> str:
    """Return the result of a comparison as text, the output of ``codewheel diff``.

    It contains notices, the changes by family, a summary, and a line on generated files and package versions. Changes
    of the documentation are listed in groups after the other changes of a family.
    """
    lines = list(result.notices)
    for family in dict.fromkeys(change.family for change in result.changes):
        family_changes = [change for change in result.changes if change.family == family]
        lines.append(family)
        # Highest impact first, and renamings after the other changes with the same impact.
        for change in sorted(family_changes, key=lambda change: (-change.impact, change.rule.is_renaming)):
            if change.impact > Impact.DOCUMENTATION:
                lines += _change_lines(change)
        documentation_changes = [change for change in family_changes if change.impact is Impact.DOCUMENTATION]
        lines += _documentation_lines(documentation_changes)
        lines += _name_lines(name_change_texts(result, family))
    lines.append(summary(result.changes) if result.changes else "no differences")
    if result.changes:
        lines += _result_lines(result)
    return "\n".join(lines)


def _change_lines(change: Change) -> Iterator[str]:
    """Yield two wrapped texts about a change: what changed, after the word for its impact, and its effect and rule."""
    indent = " " * _TEXT_COLUMN
    yield wrap_text(change.text, WIDTH, prefix=indent, first=_first_column(change.rule.word))
    yield wrap_text(f"{describe_effect(change)} [{change.rule.name}]", WIDTH, prefix=indent)


def _first_column(word: str) -> str:
    """Return the word for an impact, padded to the column in which the texts begin."""
    return f"  {word:<13}  "


def _documentation_lines(changes: Sequence[Change]) -> Iterator[str]:
    """Yield a wrapped text for each rule of documentation changes: the first few places and the number of others."""
    for rule in dict.fromkeys(change.rule for change in changes):
        changes_of_rule = [change for change in changes if change.rule is rule]
        places = first_of([_path_or_text(change) for change in changes_of_rule], between="; ")
        line_beginning = _first_column(rule.word)
        yield wrap_text(f"{places} [{rule.name}]", WIDTH, prefix=" " * _TEXT_COLUMN, first=line_beginning)


def _name_lines(name_texts: Sequence[str]) -> Iterator[str]:
    """Yield one wrapped text with the first four changed names in code, and the number of the others."""
    if not name_texts:
        return
    names_text = "; ".join(name_texts[:_MOST_NAMES])
    if len(name_texts) > _MOST_NAMES:
        names_text += f"; and {len(name_texts) - _MOST_NAMES} more, all with --markdown"
    yield wrap_text(names_text, WIDTH, prefix=" " * _TEXT_COLUMN, first=_first_column("names"))


def _path_or_text(change: Change) -> str:
    """Return the place of a change of texts or citations, or for any other change its text.

    A place inside an interface is shortened: ``ssi.frame.position`` for ``interfaces.ssi.layouts.frame.position``.
    """
    if change.rule.name in ("words", "source"):
        return change.path.removeprefix("interfaces.").replace(".layouts.", ".")
    return change.text


def _result_lines(result: DiffResult) -> Iterator[str]:
    """Yield one wrapped text about generated files and package versions, or nothing if there are neither."""
    statements: list[str] = []
    if result.files is not None:
        changed_count = len(result.files.changed_paths)
        verb = "changes" if changed_count == 1 else "change"
        statements.append(f"{changed_count} of {count_with_unit(result.files.file_count, 'file')} {verb}")
    statements += map(describe_versions, result.packages)
    if statements:
        yield wrap_text(f"generated: {'; '.join(statements)}", WIDTH, prefix="  ", first="")


#: Name of the file next to the new specs.
ACCEPTED_FILE = "accepted.yaml"
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
        last_day = date.fromisoformat(until)
    except ValueError:
        raise NotAccepted(f"{location}: 'until' is a date such as 2027-03-31, not {quoted(until)}") from None
    return Accepted(
        family=acceptance["family"], rule=rule, path=acceptance["path"], why=acceptance["why"], until=last_day
    )


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
