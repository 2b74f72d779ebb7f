"""Editions of a manual: the family as it was before a revision, or with the published facts of a later one.

The spec transcribes one revision. Its ``editions`` are applied to it step by step: the changes ``before`` each revision
on the way back to an older one, or those of ``then`` on the way to a newer one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..language.document import Path
from ..language.overlay import KINDS, Layer, LayeredSpec, LayerKind
from ..language.places import NothingThere, as_affected, resolve
from ..language.problems import DocumentReport, Report, listed, quoted
from ..language.rules.walk import leaves
from ..model import LEFT_OUT, NOT_KNOWN, Device, Erratum, ManualEdition
from ..order_codes.narrowing import for_codes
from .from_mapping import record
from .overlays import Build, Family, errata_of, few, without_examples

#: Largest number of editions times values. Each edition is checked like a spec. The largest manual needs 26,000.
MOST_VALUES = 500_000
_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")
Raw = Mapping[str, Any]


class UnknownEdition(ValueError):
    """No such edition. The message lists the existing ones."""


def editions(raw: Raw) -> tuple[ManualEdition, ...]:
    """Return the editions that can be selected, oldest first, or none if the spec lists no changes."""
    known = {item["revision"]: item for item in raw.get("editions", ())}
    if not known:
        return ()
    history = {item["revision"]: item.get("date", "") for item in raw["manual"].get("history", ())}
    own = raw["manual"]["revision"]
    dates = {**history, own: raw["manual"].get("date", history.get(own, ""))}
    dates |= {name: item.get("date", "") for name, item in known.items() if name not in dates}
    return tuple(record(ManualEdition, known.get(name, {}), revision=name, date=date) for name, date in dates.items())


def chosen(device: Device, wanted: str) -> str:
    """Return the revision of an edition given by its revision, or by a date on which it was the latest.

    Raises:
        UnknownEdition: There is no such edition.
    """
    names = [item.revision for item in device.editions] or [device.manual.revision]
    if wanted in names:
        return wanted
    # A year does not determine which edition was the latest on a given day.
    dated = [item for item in device.editions if _DATE.fullmatch(item.date)]
    if _DATE.fullmatch(wanted) and dated:
        then = [item.revision for item in dated if item.date <= wanted]
        if then:
            return then[-1]
        raise UnknownEdition(
            f"the first edition, {dated[0].revision}, is dated {dated[0].date}, which is after {wanted}"
        )
    raise UnknownEdition(
        f"the spec of {device.name} has no edition {quoted(wanted)}; use {listed(names, 'or')}"
        + (", or a date such as 2020-03-31" if dated else "")
    )


def edition_of(family: Family, revision: str, build: Build, report: Report) -> Family | None:
    """Return the family in the edition of this revision. Its problems are reported in the spec.

    Args:
        family: The family as in its spec.
        revision: One of its editions.
        build: Builds the family of a document.
        report: Receives changes that cannot be applied, and problems of the result.
    """
    laying = LayeredSpec(family.document, report)
    before = len(report)
    for index, key, name in _steps(family, revision):
        laying.apply([Layer(family.document, ("editions", index, key), LayerKind.EDITION, name)])
    name = f"{family.device.name}_{re.sub('[^a-z0-9]+', '_', revision.lower()).strip('_')}"
    document = laying.document(name)
    document = replace(document, data={key: item for key, item in document.data.items() if key != "editions"})
    inside = Report()
    device = build(document, inside)
    known = set(report.problems)
    for item in inside.problems if len(report) == before else ():
        if item not in known:
            told = f"in edition {revision}: {item.message}"
            report.add_at(item.file, item.line, item.column, item.rule, told, path=item.path, text=item.text)
    if device is None:
        return None
    device = for_codes(device, {item.code for item in device.variants})
    date = next((item.date for item in family.device.editions if item.revision == revision), "")
    device = replace(
        device,
        title=f"{device.title}, edition {revision}",
        manual=replace(device.manual, revision=revision, date=date, editions=()),
        errata=(*device.errata, *errata_of(laying.applied)),
        overlays=family.device.overlays,
        editions=(),
        base=family.device.name,
        edition=revision,
        times_read=None,
    )
    return Family(device, document, family.files)


def _steps(family: Family, revision: str) -> Iterator[tuple[int, str, str]]:
    """Yield the lists of changes that lead to a revision, each as index, key and name in outputs."""
    order = [item.revision for item in family.device.editions]
    own, wanted = order.index(family.device.manual.revision), order.index(revision)
    listed_ = {item["revision"]: (index, item) for index, item in enumerate(family.document.data.get("editions", ()))}
    way = range(own, wanted, -1) if wanted < own else range(own + 1, wanted + 1)
    key = "before" if wanted < own else "then"
    for place in way:
        index, item = listed_.get(order[place], (0, {}))
        if key in item:
            yield index, key, f"before {order[place]}" if key == "before" else order[place]


def notes(raw: Raw) -> Iterator[Erratum]:
    """Yield the differences of other editions, as errata of the family of the spec."""
    for item in raw.get("editions", ()):
        for key, name in (("before", f"before {item['revision']}"), ("then", item["revision"])):
            for number, change in enumerate(item.get(key, ()), 1):
                # A change with no kind or several is reported when it is applied.
                if len(kinds := [word for word in KINDS if word in change]) == 1:
                    yield _note(raw, change, name, number, kinds[0])


def _note(raw: Raw, change: Raw, name: str, number: int, kind: str) -> Erratum:
    texts = change[kind] if isinstance(change[kind], list) else [change[kind]]
    affects = [] if kind == "also" else [_affected(raw, text) for text in texts]
    value = change.get("to", change.get("value"))
    used = {"remove": LEFT_OUT, "unknown": NOT_KNOWN, "also": NOT_KNOWN}.get(kind, _text(value))
    return record(
        Erratum,
        {"severity": "wrong_data", **{key: change[key] for key in ("why", "source", "severity") if key in change}},
        name=f"edition_{re.sub('[^a-z0-9]+', '_', name.lower())}_{number}",
        printed=few(without_examples([text.removeprefix("registers.") for text in texts])),
        used=used,
        status="open" if used == NOT_KNOWN else "settled",
        affects=tuple(dict.fromkeys(filter(None, affects))),
        edition=name,
    )


def _text(value: object) -> str:
    """Return a value of a spec in words."""
    match value:
        case bool():
            return "yes" if value else "no"
        case dict():
            return ", ".join(f"{key} = {item}" for key, item in value.items())
        case list():
            return ", ".join(map(str, value))
        case _:
            return str(value)


def _affected(raw: Raw, text: str) -> str:
    try:
        return as_affected(raw, resolve(raw, text))
    except NothingThere as nothing:
        return as_affected(raw, nothing.found)


def check_editions(raw: Raw, device: Device, report: DocumentReport) -> None:
    """Report too many editions, editions in the wrong place, and labels and registers that do not exist."""
    count, values = len(device.editions), len(leaves(raw))
    if count * values > MOST_VALUES:
        wrong = f"each of {count} editions is checked with {values} values; the product must be at most {MOST_VALUES}"
        report.add("too-large", ("editions",), f"{wrong}; leave out early editions", at_key=True)
    history = [item["revision"] for item in raw["manual"].get("history", ())]
    own = raw["manual"]["revision"]
    past = history[: history.index(own) + 1] if own in history else [own]
    patterns = {item.pattern for item in device.order_code.also_written}
    for index, item in enumerate(raw.get("editions", ())):
        path: Path = ("editions", index)
        name = item["revision"]
        if any(other["revision"] == name for other in raw["editions"][:index]):
            report.add("duplicate-name", (*path, "revision"), f"the edition {quoted(name)} already exists")
        if "before" in item and name not in past[1:]:
            wrong = (
                f"{quoted(name)} can have 'before' only if it is in the history, after the first and not after {own}"
            )
            report.add("edition-order", (*path, "before"), wrong, at_key=True)
        if "then" in item and name in past:
            wrong = f"{quoted(name)} is not after {own}, which this file transcribes; use 'before' for it"
            report.add("edition-order", (*path, "then"), wrong, at_key=True)
        for number, label in enumerate(item.get("labels", ())):
            if label not in patterns:
                wrong = f"there is no spelling {quoted(label)} in 'also_written' of the order code"
                report.add("undefined-reference", (*path, "labels", number), wrong)
        for number, test in enumerate(item.get("tests", ())):
            _check_test(test, (*path, "tests", number), device, report)


def _check_test(test: Raw, path: Path, device: Device, report: DocumentReport) -> None:
    register = next((item for item in device.registers if item.name == test["register"]), None)
    if register is None:
        report.add("undefined-reference", (*path, "register"), f"there is no register {quoted(test['register'])}")
    elif test["run"] not in runs_of(register):
        wrong = f"{quoted(test['register'])} has no field or run of digits {quoted(test['run'])}"
        report.add("undefined-reference", (*path, "run"), f"{wrong}; it has {listed(runs_of(register))}")
    if test["min"] > test["max"]:
        report.add("out-of-range", (*path, "min"), f"'min' is {test['min']}; it must be at most {test['max']}")


def runs_of(register: Any) -> list[str]:
    """Return the names of a register's fields, and of the groups of digits in these fields."""
    names = [item.name for item in register.layout.fields]
    return names + [run.name for item in register.layout.fields for run in getattr(item.kind, "runs", ())]
