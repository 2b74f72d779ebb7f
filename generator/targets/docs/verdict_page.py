"""Page of the verdicts and reports for each frame of every family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, TypedDict

from ...model import Alarm, Device, Field, Interface, Layout, Sign, Verdict
from ...plan.reports import Reporting, reportings, reports_of, sums_up
from ...plan.values import Active, meaning_of
from ...plan.verdicts import Judgement, Only, verdict_of
from ...say.evidence import document
from ...say.markdown import STYLE, anchor, cited, code, joined, link, text
from ...say.name import own_names
from ...say.report import advice, alarm_of, by_hand, conditions, deciding, meaning, source
from ...say.text import Code, listed, said
from .page_links import to_erratum, to_layout, to_steps

#: File name of the page, which no family can have.
PAGE = "usable-or-not.md"
Row = tuple[str, ...]


class UsablePage(TypedDict):
    decides_rows: Annotated[list[Row], "deciding bits and verdict of each frame, with source and errata"]
    frame_rows: Annotated[list[Row], "possible reports of each frame"]
    report_rows: Annotated[list[Row], "meaning and remedy of each report"]


def page_values(devices: Sequence[Device]) -> UsablePage:
    told = [(device, list(reportings(device))) for device in devices]
    return {
        "decides_rows": [
            row for device, found in told for row in _of_family(device, _decides(device, found), device.name)
        ],
        "frame_rows": [row for device, found in told for row in _of_family(device, _frames(device, found))],
        "report_rows": [row for device in devices for row in _of_family(device, _reports(device))],
    }


def _of_family(device: Device, rows: Iterator[Row], name: str = "") -> Iterator[Row]:
    """Yield the rows, with the family in the first row. ``name`` is its anchor."""
    family = (anchor(name) if name else "") + link(text(device.title), f"{device.name}.md")
    for index, row in enumerate(rows):
        yield family if index == 0 else "", *row


def _decides(device: Device, told: Sequence[Reporting]) -> Iterator[Row]:
    """Yield rows of interface, frames, deciding field, its active value, verdict, source, errata."""
    found: dict[tuple[str, tuple[Row, ...]], list[Layout]] = {}
    for item in told:
        if item.judgement is not None:
            layout = item.codec.layout
            rows = tuple(_speaking(device, item.interface, layout, item.judgement))
            last = ("none of these" if rows else "no field decides", "", code(item.judgement.otherwise.value), "", "")
            found.setdefault((item.interface.title, (*rows, last)), []).append(layout)
    if not found:
        yield ", ".join(item.title for item in device.interfaces), "no frame with a position", "", "", "", "", ""
    for (title, rows), layouts in found.items():
        for index, row in enumerate(rows):
            yield *((title, _links(device, layouts)) if index == 0 else ("", "")), *row


def _speaking(device: Device, interface: Interface, layout: Layout, judgement: Judgement) -> Iterator[Row]:
    """Yield the fields that decide the verdict on a frame, worst verdict first."""
    speaking: list[tuple[Verdict, Field, tuple[Only, ...]]] = [
        (verdict, item.by.field, item.conditions) for verdict, items in judgement.worst_first for item in items
    ]
    signs = {sign.flag.name: sign for sign in layout.signs}
    order = [*(item.name for item in layout.fields), *signs]
    if judgement.otherwise is Verdict.UNKNOWN:
        # A warning does not improve on an unknown position.
        not_better = (Verdict.USABLE_WITH_WARNING, Verdict.UNKNOWN)
        warning = (item for item in layout.fields if verdict_of(item) in not_better)
        speaking += [(judgement.otherwise, item, ()) for item in warning]
    speaking.sort(key=lambda item: ([*Verdict].index(item[0]), order.index(item[1].name)))
    fields = (*layout.fields, *(sign.flag for sign in signs.values()))
    speaking += [(Verdict.USABLE, item, ()) for item in fields if verdict_of(item) is Verdict.USABLE]
    for verdict, field, conditions_on_codes in speaking:
        sign = signs.get(field.name)
        yield (
            _named(field),
            _when(device, field, conditions_on_codes) + _unless(field, layout)
            if sign is None
            else _conditions(layout, sign),
            code(verdict.value),
            _cited(device, field),
            _errata(device, interface, layout, field, sign),
        )


def _when(device: Device, field: Field, conditions_on_codes: Sequence[Only]) -> str:
    """Return the value of a field that decides the verdict, with the order codes and the answer that it needs."""
    return " ".join((deciding(field), *(_condition(device, only) for only in conditions_on_codes)))


def _condition(device: Device, only: Only) -> str:
    """Return the order codes, or the answer to a question with a link to it."""
    asked = next((item for item in device.optional_alternatives if item.parameter == only.parameter), None)
    if asked is None:
        return f"with {code(only.codes)}" if only.holds else "with all others"
    names = [code(item.name) for item in asked.answers if bool(item.sets[only.parameter]) == only.holds]
    interface = next(item.name for item, layout in device.layouts() if asked in device.verdict_alternatives(layout))
    question = link("your choice", f"{device.name}/{interface}.md#alternative-{asked.name}")
    default = "" if only.holds else ", the default"
    return f"and {question} is {' or '.join(names)}{default}"


def _conditions(layout: Layout, sign: Sign) -> str:
    """Return the values of fields that decide the verdict together."""
    return STYLE.phrase(conditions((layout.field(name), value) for name, value in sign.conditions))


def _unless(field: Field, layout: Layout) -> str:
    """Return the flags of the frame that must be inactive if a flag that combines them is to decide."""
    here = [Code(name) for name in sums_up(field) if any(item.name == name for item in layout.fields)]
    return f", with {STYLE.phrase(said(*listed(here)))} inactive" if here else ""


def _frames(device: Device, reporting: Sequence[Reporting]) -> Iterator[Row]:
    """Yield rows of interface, frames, possible reports."""
    told = {item.codec.layout.name: item.told for item in reporting}
    found: dict[tuple[str, tuple[str, ...]], list[Layout]] = {}
    for interface, layout in device.layouts():
        if layout.sender == "encoder":
            names = tuple(item.report.name for item in told.get(layout.name, ()))
            found.setdefault((interface.title, names), []).append(layout)
    for (title, names), layouts in found.items():
        yield title, _links(device, layouts), ", ".join(map(code, names)) or "nothing"


def _reports(device: Device) -> Iterator[Row]:
    """Yield rows of report, meaning, remedy, source."""
    for item in reports_of(device):
        alarm = alarm_of(device, item.field)
        name = joined([code(item.name), text(own_names(item.field))])
        steps = to_steps(f"{device.name}/", by_hand(item.field, alarm))
        advised = joined([text(advice(item.field, alarm)), *steps])
        what_to_do = advised or _clearing(device, alarm) or f"The {document(device)} gives no remedy"
        yield name, text(meaning(item.field, alarm)), what_to_do, cited(source(item.field, alarm))


def _clearing(device: Device, alarm: Alarm | None) -> str:
    """Return links to the procedures that clear an alarm, or an empty string."""
    names = alarm.cleared_by if alarm is not None else ()
    procedures = map(device.procedure, names)
    links = [link(text(item.title), f"{device.name}/{item.interface}.md#procedure-{item.name}") for item in procedures]
    return f"Cleared by: {', '.join(links)}" if links else ""


def _named(field: Field) -> str:
    return joined([code(field.name), text(own_names(field))])


def _cited(device: Device, field: Field) -> str:
    return cited(source(field, alarm_of(device, field)))


def _links(device: Device, layouts: Sequence[Layout]) -> str:
    return ", ".join(to_layout(device, item, code(item.name)) for item in layouts)


def _errata(device: Device, interface: Interface, layout: Layout, field: Field, sign: Sign | None) -> str:
    """Return links to the errata about a field and, for a flag, about its group. A sign has those of all its fields."""
    frame = f"interfaces.{interface.name}.{layout.name}"
    paths = {f"{frame}.{field.name}"}
    for item in [field] if sign is None else [layout.field(name) for name, _ in sign.conditions]:
        paths |= {f"{frame}.{item.name}", f"field_groups.{item.group}.{item.name}"}
        if item.group and isinstance(meaning_of(item), Active):
            paths.add(f"field_groups.{item.group}")
    about = (item for item in device.errata if not item.edition and not paths.isdisjoint(item.affects))
    found = (item.name for item in about if item.severity != "wording")
    return ", ".join(to_erratum(device, name) for name in found)
