"""History of a family: editions of its manual, released versions of its spec, and how often its facts were read.

The spec transcribes one revision. The changes in ``editions`` lead from it to other revisions, step by step: the
changes ``before`` each revision lead back to an older one, and the changes ``then`` lead to a newer one.
"""

from __future__ import annotations

import json
import pathlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields, replace
from typing import Any

from ..language.document import MissingPath, Path, resolve
from ..language.files import coverage_path
from ..language.overlay import CHANGE_KINDS, LayeredSpec, LayerKind, OverlayLayer
from ..language.problems import DocumentReport, ProblemReport, join_words, quoted
from ..language.rules.walk import as_affected, leaves
from ..model import (
    LEFT_OUT,
    NOT_KNOWN,
    Device,
    Erratum,
    ManualEdition,
    Release,
    ReleasedChange,
    TimesRead,
    layer_in_words,
)
from ..order_codes.reduction import for_codes
from .overlays import Build, Family, change_title, errata_of, join_shortened, without_examples
from .spec_parts import build_part

#: Highest number of editions times values. Each edition is checked like a spec. The largest manual needs 26,000.
MOST_VALUES = 500_000
_ISO_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")
Raw = Mapping[str, Any]


class UnknownEdition(ValueError):
    """There is no such edition. The message lists the existing editions."""


def build_editions(raw_spec: Raw) -> tuple[ManualEdition, ...]:
    """Return the editions of the manual that users can select, oldest first, or ``()`` if the spec lists no changes.

    These are all revisions in the manual's history, the revision that the spec transcribes, and later revisions.
    """
    raw_edition_by_revision = {raw_edition["revision"]: raw_edition for raw_edition in raw_spec.get("editions", ())}
    if not raw_edition_by_revision:
        return ()
    manual = raw_spec["manual"]
    # The order is: the history, the transcribed revision, later revisions.
    date_by_revision = {release["revision"]: release.get("date", "") for release in manual.get("history", ())}
    transcribed_revision = manual["revision"]
    date_in_history = date_by_revision.get(transcribed_revision, "")
    date_by_revision[transcribed_revision] = manual.get("date", date_in_history)
    for revision, raw_edition in raw_edition_by_revision.items():
        date_by_revision.setdefault(revision, raw_edition.get("date", ""))
    editions: list[ManualEdition] = []
    for revision, date in date_by_revision.items():
        edition_or_empty = raw_edition_by_revision.get(revision, {})  # Empty for an edition without changes.
        editions.append(build_part(ManualEdition, edition_or_empty, revision=revision, date=date))
    return tuple(editions)


def revision_for(device: Device, revision_or_date: str) -> str:
    """Return the revision that a user asked for, either by its name or by a date on which it was the latest.

    Raises:
        UnknownEdition: There is no such edition.
    """
    revisions = [edition.revision for edition in device.editions] or [device.manual.revision]
    if revision_or_date in revisions:
        return revision_or_date
    # Editions that are only dated by a year do not show which edition was the latest on a given day.
    dated_editions = [edition for edition in device.editions if _ISO_DATE.fullmatch(edition.date)]
    if not dated_editions or not _ISO_DATE.fullmatch(revision_or_date):
        message = (
            f"the spec of {device.name} has no edition {quoted(revision_or_date)}; use {join_words(revisions, 'or')}"
        )
        raise UnknownEdition(f"{message}, or a date such as 2020-03-31" if dated_editions else message)
    # Dates such as 2020-03-31 can be compared as texts. The editions are oldest first, so the last one was the latest.
    editions_until_date = [edition for edition in dated_editions if edition.date <= revision_or_date]
    if not editions_until_date:
        first_edition = dated_editions[0]
        problem = f"the first edition, {first_edition.revision}, is dated {first_edition.date}"
        raise UnknownEdition(f"{problem}, which is after {revision_or_date}")
    return editions_until_date[-1].revision


def _name_of_edition(family: Family, revision: str) -> str:
    """Return the name of a family in an edition, such as ``x_24_1_4`` for edition 1.4 of ``x_24``."""
    revision_in_name = re.sub("[^a-z0-9]+", "_", revision.lower()).strip("_")
    return f"{family.device.name}_{revision_in_name}"


def family_in_edition(family: Family, revision: str, build: Build, report: ProblemReport) -> Family | None:
    """Return a family as an edition of its manual describes it, or None if it cannot be built.

    Args:
        family: The family as its spec describes it.
        revision: The revision of the edition.
        build: Builds the device of a document.
        report: Receives changes that cannot be applied, and problems of the edition.
    """
    # A change that cannot be applied may already be reported, because later editions contain it too.
    report_of_changes = ProblemReport()
    layered_spec = LayeredSpec(family.document, report_of_changes)
    for index, key, name in _change_lists(family, revision):
        layered_spec.apply(
            [OverlayLayer(document=family.document, path=("editions", index, key), kind=LayerKind.EDITION, name=name)]
        )
    report.include(report_of_changes)
    document = layered_spec.document(_name_of_edition(family, revision))
    document = replace(document, data={key: value for key, value in document.data.items() if key != "editions"})
    report_of_edition = ProblemReport()
    device = build(document, report_of_edition)
    if not report_of_changes:
        _report_in_edition(report_of_edition, revision, report)
    if device is None:
        return None
    # This keeps all order codes, but removes values and examples that none of them uses in this edition.
    device = for_codes(device, {variant.code for variant in device.variants})
    date = next((edition.date for edition in family.device.editions if edition.revision == revision), "")
    device = replace(
        device,
        title=f"{device.title}, edition {revision}",
        manual=replace(device.manual, revision=revision, date=date, editions=()),
        errata=(*device.errata, *errata_of(layered_spec.applied)),
        overlays=family.device.overlays,
        editions=(),
        base=family.device.name,
        edition=revision,
        times_read=None,
    )
    return Family(device=device, document=document, files=family.files)


def _report_in_edition(inner_report: ProblemReport, revision: str, report: ProblemReport) -> None:
    """Report the problems of an edition at their places in the spec, except problems that are already reported."""
    reported = set(report.problems)
    for problem in inner_report.problems:
        if problem not in reported:
            report.add_problem(replace(problem, message=f"in edition {revision}: {problem.message}"))


def _change_lists(family: Family, revision: str) -> Iterator[tuple[int, str, str]]:
    """Yield the lists of changes that lead from the revision that the spec transcribes to another one, in order.

    Each list is given as the index of an edition in the spec, the key of the list, and its name in outputs: ``(2,
    "before", "before 1.4")`` for an older revision, or ``(3, "then", "1.6")`` for a newer one.
    """
    oldest_first = [edition.revision for edition in family.device.editions]
    transcribed_position = oldest_first.index(family.device.manual.revision)
    target_position = oldest_first.index(revision)
    if target_position < transcribed_position:
        # Each step back undoes the changes of one revision, newest first: from 1.4 to 1.2, undo 1.4, then 1.3.
        key = "before"
        passed_revisions = list(reversed(oldest_first[target_position + 1 : transcribed_position + 1]))
    else:
        key = "then"
        passed_revisions = oldest_first[transcribed_position + 1 : target_position + 1]
    # The spec lists only editions with changes, in any order.
    raw_editions = family.document.data.get("editions", ())
    index_in_spec_by_revision = {edition["revision"]: index for index, edition in enumerate(raw_editions)}
    for passed_revision in passed_revisions:
        if passed_revision not in index_in_spec_by_revision:
            continue
        index = index_in_spec_by_revision[passed_revision]
        if key in raw_editions[index]:
            name_in_outputs = f"before {passed_revision}" if key == "before" else passed_revision
            yield index, key, name_in_outputs


def errata_of_other_editions(raw_spec: Raw) -> Iterator[Erratum]:
    """Yield the changes of all other editions of the manual as errata, so that users of these editions see them."""
    for edition in raw_spec.get("editions", ()):
        revision = edition["revision"]
        for list_key, edition_name in (("before", f"before {revision}"), ("then", revision)):
            for change_number, change in enumerate(edition.get(list_key, ()), 1):
                kinds_of_change = [kind for kind in CHANGE_KINDS if kind in change]
                # A change without exactly one kind is reported when it is applied.
                if len(kinds_of_change) == 1:
                    yield _edition_erratum(
                        raw_spec,
                        change,
                        revision=edition_name,
                        change_number=change_number,
                        kind_of_change=kinds_of_change[0],
                    )


def _edition_erratum(raw_spec: Raw, change: Raw, *, revision: str, change_number: int, kind_of_change: str) -> Erratum:
    """Return a change of an edition as an erratum.

    Args:
        raw_spec: The spec.
        change: The change, such as ``{"set": "registers.preset.max", "to": 15, "why": …}``.
        revision: The edition, such as ``before 1.4``.
        change_number: The place of the change in its list, from 1.
        kind_of_change: The kind of the change, such as ``set``.
    """
    path_or_paths = change[kind_of_change]
    changed_paths = path_or_paths if isinstance(path_or_paths, list) else [path_or_paths]
    affected_paths: list[str] = []
    # For the kind 'also', it is a sentence instead of a path.
    if kind_of_change != "also":
        affected_paths = [_affected_path(raw_spec, changed_path) for changed_path in changed_paths]
    if kind_of_change == "remove":
        used_text = LEFT_OUT
    elif kind_of_change in ("unknown", "also"):
        used_text = NOT_KNOWN
    else:
        used_text = _value_in_words(change.get("to", change.get("value")))
    stated_facts = {key: change[key] for key in ("why", "source", "severity") if key in change}
    # For example before_1_4.
    name_of_edition = re.sub("[^a-z0-9]+", "_", revision.lower())
    short_texts = [changed_path.removeprefix("registers.") for changed_path in changed_paths]
    return build_part(
        Erratum,
        {"severity": "wrong_data", **stated_facts},
        name=f"edition_{name_of_edition}_{change_number}",
        title=change_title(layer_in_words("", revision), without_examples(changed_paths)),
        printed=join_shortened(without_examples(short_texts)),
        used=used_text,
        status="open" if used_text == NOT_KNOWN else "settled",
        affects=tuple(dict.fromkeys(path for path in affected_paths if path)),
        edition=revision,
    )


def _value_in_words(changed_value: object) -> str:
    """Return a value from a spec in words, such as ``yes`` for true or ``width = 6, poly = 3`` for a map."""
    match changed_value:
        case bool():
            return "yes" if changed_value else "no"
        case dict():
            return ", ".join(f"{key} = {member}" for key, member in changed_value.items())
        case list():
            return ", ".join(map(str, changed_value))
        case _:
            return str(changed_value)


def _affected_path(raw_spec: Raw, path_in_change: str) -> str:
    """Return the path of a changed part in the notation of errata.

    If the change adds a part, this is the path of the existing part that it is added to.
    """
    try:
        spec_path = resolve(raw_spec, path_in_change)
    except MissingPath as missing_path:  # The added part does not exist yet.
        spec_path = missing_path.existing_path
    return as_affected(raw_spec, spec_path)


def check_editions(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report too many editions, duplicate or misplaced editions, and references to parts that do not exist."""
    edition_count = len(device.editions)
    value_count = len(leaves(raw_spec))
    if edition_count * value_count > MOST_VALUES:
        comparison_text = f"each of {edition_count} editions is checked against {value_count} values"
        message = f"{comparison_text}; the product must be at most {MOST_VALUES}"
        report.add("too-large", ("editions",), f"{message}; leave out early editions", at_key=True)
    known_patterns = {spelling.pattern for spelling in device.order_code.also_written}
    for index, raw_edition in enumerate(raw_spec.get("editions", ())):
        edition_path: Path = ("editions", index)
        earlier_revisions = [earlier_edition["revision"] for earlier_edition in raw_spec["editions"][:index]]
        if raw_edition["revision"] in earlier_revisions:
            message = f"the edition {quoted(raw_edition['revision'])} already exists"
            report.add("duplicate-name", (*edition_path, "revision"), message)
        _check_order(raw_spec, raw_edition, edition_path, report)
        for pattern_index, pattern in enumerate(raw_edition.get("labels", ())):
            if pattern not in known_patterns:
                message = f"there is no spelling {quoted(pattern)} in 'also_written' of the order code"
                report.add("undefined-reference", (*edition_path, "labels", pattern_index), message)
        for test_index, raw_test in enumerate(raw_edition.get("tests", ())):
            _check_test(raw_test, (*edition_path, "tests", test_index), device, report)


def _check_order(raw_spec: Raw, raw_edition: Raw, edition_path: Path, report: DocumentReport) -> None:
    """Check that an edition has the key 'before' or 'then' according to its place in the manual's history.

    ``before`` is for revisions after the first, up to the revision that the spec transcribes. ``then`` is for later
    revisions.
    """
    history = [release["revision"] for release in raw_spec["manual"].get("history", ())]
    transcribed_revision = raw_spec["manual"]["revision"]
    # The history is oldest first. The first revision has no predecessor, so it cannot have 'before'.
    if transcribed_revision in history:
        earlier_revisions = history[: history.index(transcribed_revision) + 1]
        can_have_before = raw_edition["revision"] in earlier_revisions[1:]
    else:
        # Another rule reports that the transcribed revision is not in the history.
        earlier_revisions = [transcribed_revision]
        can_have_before = raw_edition["revision"] in history[1:]
    revision = raw_edition["revision"]
    if "before" in raw_edition and not can_have_before:
        message = (
            f"{quoted(revision)} can have 'before' only if it is in the history, after the first and not after"
            f" {transcribed_revision}"
        )
        report.add("edition-order", (*edition_path, "before"), message, at_key=True)
    is_earlier = revision in earlier_revisions or _has_lower_number(revision, transcribed_revision)
    if "then" in raw_edition and is_earlier:
        message = (
            f"{quoted(revision)} is not after {transcribed_revision}, which this file transcribes; use 'before' for it"
        )
        report.add("edition-order", (*edition_path, "then"), message, at_key=True)


def _has_lower_number(revision: str, other_revision: str) -> bool:
    """Return whether a revision is older by its number: 1.9 is older than 1.10. False if one is not such a number."""
    number_pattern = r"\d+(?:\.\d+)*"
    if not re.fullmatch(number_pattern, revision) or not re.fullmatch(number_pattern, other_revision):
        return False
    return [*map(int, revision.split("."))] < [*map(int, other_revision.split("."))]


def _check_test(raw_test: Raw, test_path: Path, device: Device, report: DocumentReport) -> None:
    """Check a test that shows by a register which edition applies: its register, its number and its limits.

    The number is a field of the register, or a run of decimal digits in a field. ``min`` must not exceed ``max``.
    """
    register = next(
        (device_register for device_register in device.registers if device_register.name == raw_test["register"]), None
    )
    if register is None:
        report.add(
            "undefined-reference", (*test_path, "register"), f"there is no register {quoted(raw_test['register'])}"
        )
    elif raw_test["run"] not in runs_of(register):
        message = f"{quoted(raw_test['register'])} has no field or run of digits {quoted(raw_test['run'])}"
        report.add("undefined-reference", (*test_path, "run"), f"{message}; it has {join_words(runs_of(register))}")
    if raw_test["min"] > raw_test["max"]:
        report.add(
            "out-of-range", (*test_path, "min"), f"'min' is {raw_test['min']}; it must be at most {raw_test['max']}"
        )


def runs_of(register: Any) -> list[str]:
    """Return the names of a register's fields, and of the runs of decimal digits in them, such as year and week."""
    names = [field.name for field in register.layout.fields]
    for field in register.layout.fields:
        names += [run.name for run in getattr(field.kind, "runs", ())]
    return names


RULE = "coverage-file"


def read_counts(spec_path: pathlib.Path, report: ProblemReport) -> TimesRead | None:
    """Return how often the facts of a spec were read from the manual, from a file next to it, or None without a file.

    If the file does not contain such counts, it is reported as edited.
    """
    counts_path = coverage_path(spec_path)
    if not counts_path.is_file():
        return None
    expected_keys = [member.name for member in fields(TimesRead)]
    try:
        count_by_name = json.loads(counts_path.read_text(encoding="utf-8"))
        has_expected_keys = set(count_by_name) == set(expected_keys)
        if has_expected_keys and all(type(count_by_name[name]) is int for name in expected_keys):
            return TimesRead(**count_by_name)
    except (OSError, ValueError, TypeError, RecursionError):  # A TypeError means that the content is not a map.
        pass
    message = "the file was edited; write it again: codewheel check --coverage --write"
    report.add_at(str(counts_path), RULE, message)
    return None


def counts_text(counts: TimesRead) -> str:
    """Return the counts in the format of the file."""
    return json.dumps(asdict(counts)) + "\n"


CHANGES_RULE = "changes-file"


def history_beside(spec: pathlib.Path) -> pathlib.Path:
    """Return the path of the history of a family: ``FAMILY.changes.json``."""
    return spec.with_name(f"{spec.stem}.changes.json")


def read_history(spec_path: pathlib.Path, report: ProblemReport) -> tuple[Release, ...]:
    """Return the released versions of a spec, newest first, from a file next to it, or ``()`` without a file.

    If the file does not contain such versions, it is reported as edited.
    """
    history_path = history_beside(spec_path)
    if not history_path.is_file():
        return ()
    try:
        history_data = json.loads(history_path.read_text(encoding="utf-8"))
        releases = tuple(_build_release(release) for release in history_data["releases"])
        if all(_has_only_texts(release) for release in releases):
            return releases
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        pass
    message = "the file was edited; undo the edit, or remove it and write it again: codewheel diff --record"
    report.add_at(str(history_path), CHANGES_RULE, message)
    return ()


def _build_release(release_data: dict[str, object]) -> Release:
    """Return a released version from its data in the file.

    Raises:
        TypeError: The changes or names are not lists, or their members differ from the model.
        KeyError: There are no changes.
    """
    changes = release_data["changes"]
    if not isinstance(changes, list):
        raise TypeError
    released_changes = tuple(ReleasedChange(**change) for change in changes)
    names = release_data.get("names", [])
    if not isinstance(names, list):
        raise TypeError
    members = {**release_data, "changes": released_changes, "names": tuple(names)}
    return Release(**members)  # type: ignore[arg-type]


def _has_only_texts(release: Release) -> bool:
    """Return whether all members of a released version and of its changes are texts."""
    texts: list[object] = [release.version, release.since, release.manual, *release.names]
    for change in release.changes:
        texts += asdict(change).values()
    return all(isinstance(text, str) for text in texts)


def with_release(releases: Sequence[Release], release: Release) -> tuple[Release, ...]:
    """Return the history with a new version at its beginning. An earlier record of the same version is replaced."""
    other_releases = [other_release for other_release in releases if other_release.version != release.version]
    return (release, *other_releases)


def history_text(releases: Sequence[Release]) -> str:
    """Return the history in the format of the file."""
    data = {"releases": [asdict(release) for release in releases]}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
