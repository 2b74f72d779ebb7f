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
from ...say.report import alarm_of, by_hand, conditions, deciding, meaning, remedy_text, source
from ...say.text import Code, listed, statement
from .page_links import to_erratum, to_layout, to_steps

#: File name of the page, which no family can have.
PAGE = "usable-or-not.md"
Row = tuple[str, ...]


class UsablePage(TypedDict):
    decides_rows: Annotated[list[Row], "deciding bits and verdict of each frame, with source and errata"]
    frame_rows: Annotated[list[Row], "possible reports of each frame"]
    report_rows: Annotated[list[Row], "meaning and remedy of each report"]


def page_values(devices: Sequence[Device]) -> UsablePage:
    families = [(device, list(reportings(device))) for device in devices]
    return {
        "decides_rows": [
            row for device, frames in families for row in _of_family(device, _decides(device, frames), device.name)
        ],
        "frame_rows": [row for device, frames in families for row in _of_family(device, _frames(device, frames))],
        "report_rows": [row for device in devices for row in _of_family(device, _reports(device))],
    }


def _of_family(device: Device, rows: Iterator[Row], name: str = "") -> Iterator[Row]:
    """Yield the rows, with the family in the first row. ``name`` is its anchor."""
    family = (anchor(name) if name else "") + link(text(device.title), f"{device.name}.md")
    for index, row in enumerate(rows):
        yield family if index == 0 else "", *row


def _decides(device: Device, reporting_frames: Sequence[Reporting]) -> Iterator[Row]:
    """Yield rows of interface, frames, deciding field, its active value, verdict, source, errata."""
    layouts_by_rows: dict[tuple[str, tuple[Row, ...]], list[Layout]] = {}
    for reporting in reporting_frames:
        if reporting.judgement is not None:
            layout = reporting.codec.layout
            rows = tuple(_speaking(device, reporting.interface, layout, reporting.judgement))
            last_row = (
                "none of these" if rows else "no field decides",
                "",
                code(reporting.judgement.otherwise.value),
                "",
                "",
            )
            layouts_by_rows.setdefault((reporting.interface.title, (*rows, last_row)), []).append(layout)
    if not layouts_by_rows:
        yield (
            ", ".join(interface.title for interface in device.interfaces),
            "no frame with a position",
            "",
            "",
            "",
            "",
            "",
        )
    for (title, rows), layouts in layouts_by_rows.items():
        for index, row in enumerate(rows):
            yield *((title, _links(device, layouts)) if index == 0 else ("", "")), *row


def _speaking(device: Device, interface: Interface, layout: Layout, judgement: Judgement) -> Iterator[Row]:
    """Yield the fields that decide the verdict on a frame, worst verdict first."""
    speaking: list[tuple[Verdict, Field, tuple[Only, ...]]] = [
        (verdict, cause.by.field, cause.conditions) for verdict, causes in judgement.worst_first for cause in causes
    ]
    signs = {sign.flag.name: sign for sign in layout.signs}
    order = [*(field.name for field in layout.fields), *signs]
    if judgement.otherwise is Verdict.UNKNOWN:
        # A warning does not improve on an unknown position.
        not_better = (Verdict.USABLE_WITH_WARNING, Verdict.UNKNOWN)
        warning = (field for field in layout.fields if verdict_of(field) in not_better)
        speaking += [(judgement.otherwise, field, ()) for field in warning]
    speaking.sort(key=lambda speaker: ([*Verdict].index(speaker[0]), order.index(speaker[1].name)))
    fields = (*layout.fields, *(sign.flag for sign in signs.values()))
    speaking += [(Verdict.USABLE, field, ()) for field in fields if verdict_of(field) is Verdict.USABLE]
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
    open_question = next(
        (alternative for alternative in device.optional_alternatives if alternative.parameter == only.parameter), None
    )
    if open_question is None:
        return f"with {code(only.codes)}" if only.holds else "with all others"
    names = [code(answer.name) for answer in open_question.answers if bool(answer.sets[only.parameter]) == only.holds]
    interface = next(
        interface.name for interface, layout in device.layouts() if open_question in device.verdict_alternatives(layout)
    )
    question = link("your choice", f"{device.name}/{interface}.md#alternative-{open_question.name}")
    default = "" if only.holds else ", the default"
    return f"and {question} is {' or '.join(names)}{default}"


def _conditions(layout: Layout, sign: Sign) -> str:
    """Return the values of fields that decide the verdict together."""
    return STYLE.phrase(conditions((layout.field(name), value) for name, value in sign.conditions))


def _unless(field: Field, layout: Layout) -> str:
    """Return the flags of the frame that must be inactive if a flag that combines them is to decide."""
    lower_flags = [Code(name) for name in sums_up(field) if any(field.name == name for field in layout.fields)]
    return f", with {STYLE.phrase(statement(*listed(lower_flags)))} inactive" if lower_flags else ""


def _frames(device: Device, reporting: Sequence[Reporting]) -> Iterator[Row]:
    """Yield rows of interface, frames, possible reports."""
    reports_by_frame = {reporting.codec.layout.name: reporting.causes for reporting in reporting}
    layouts_by_reports: dict[tuple[str, tuple[str, ...]], list[Layout]] = {}
    for interface, layout in device.layouts():
        if layout.sender == "encoder":
            names = tuple(reported.report.name for reported in reports_by_frame.get(layout.name, ()))
            layouts_by_reports.setdefault((interface.title, names), []).append(layout)
    for (title, names), layouts in layouts_by_reports.items():
        yield title, _links(device, layouts), ", ".join(map(code, names)) or "nothing"


def _reports(device: Device) -> Iterator[Row]:
    """Yield rows of report, meaning, remedy, source."""
    for report in reports_of(device):
        alarm = alarm_of(device, report.field)
        name = joined([code(report.name), text(own_names(report.field))])
        steps = to_steps(f"{device.name}/", by_hand(report.field, alarm))
        advised = joined([text(remedy_text(report.field, alarm)), *steps])
        what_to_do = advised or _clearing(device, alarm) or f"The {document(device)} gives no remedy"
        yield name, text(meaning(report.field, alarm)), what_to_do, cited(source(report.field, alarm))


def _clearing(device: Device, alarm: Alarm | None) -> str:
    """Return links to the procedures that clear an alarm, or an empty string."""
    names = alarm.cleared_by if alarm is not None else ()
    procedures = map(device.procedure, names)
    links = [
        link(text(procedure.title), f"{device.name}/{procedure.interface}.md#procedure-{procedure.name}")
        for procedure in procedures
    ]
    return f"Cleared by: {', '.join(links)}" if links else ""


def _named(field: Field) -> str:
    return joined([code(field.name), text(own_names(field))])


def _cited(device: Device, field: Field) -> str:
    return cited(source(field, alarm_of(device, field)))


def _links(device: Device, layouts: Sequence[Layout]) -> str:
    return ", ".join(to_layout(device, layout, code(layout.name)) for layout in layouts)


def _errata(device: Device, interface: Interface, layout: Layout, field: Field, sign: Sign | None) -> str:
    """Return links to the errata about a field and, for a flag, about its group. A sign has those of all its fields."""
    frame = f"interfaces.{interface.name}.{layout.name}"
    paths = {f"{frame}.{field.name}"}
    for field_of_sign in [field] if sign is None else [layout.field(name) for name, _ in sign.conditions]:
        paths |= {f"{frame}.{field_of_sign.name}", f"field_groups.{field_of_sign.group}.{field_of_sign.name}"}
        if field_of_sign.group and isinstance(meaning_of(field_of_sign), Active):
            paths.add(f"field_groups.{field_of_sign.group}")
    errata = (erratum for erratum in device.errata if not erratum.edition and not paths.isdisjoint(erratum.affects))
    erratum_names = (erratum.name for erratum in errata if erratum.severity != "wording")
    return ", ".join(to_erratum(device, name) for name in erratum_names)
