"""The page that explains verdicts, and a page for each family with the verdicts on its frames and their reports."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, TypedDict

from ...model import Alarm, Alternative, Device, Field, Interface, Layout, Sign, Verdict, first_or_raise
from ...model.record import dataclass
from ...plan.values import ActiveFlag, meaning_of
from ...plan.verdicts import (
    CodeCondition,
    ReportsAndVerdict,
    VerdictRules,
    reportings,
    reports_of,
)
from ...say.commands_and_alarms import alarm_of, alarm_source, manual_steps, meaning, remedy_text
from ...say.names_and_evidence import conditions_text, deciding_value, own_names, word_for_document
from ...say.text import (
    MARKDOWN,
    CodeText,
    citation,
    code_span,
    escape,
    join_filled,
    link_list,
    list_parts,
    markdown_link,
    statement,
)
from .links_and_errata import link_to_erratum, link_to_layout, links_to_steps, path_to_anchor
from .verdict_table import EFFECTS

#: File name of the page on verdicts, which no family can have.
PAGE = "usable-or-not.md"
Row = tuple[str, ...]


class UsablePage(TypedDict):
    family_links: Annotated[list[str], "links to the page of each family with a frame"]


class VerdictPage(TypedDict):
    device: Annotated[Device, "the family"]
    usable_page: Annotated[str, "the page on verdicts"]
    decides_rows: Annotated[list[Row], "deciding bits and verdict of each frame, with source and errata"]
    frame_rows: Annotated[list[Row], "possible reports of each frame"]
    report_rows: Annotated[list[Row], "meaning and remedy of each report"]


def file_name(device: Device) -> str:
    """Return the name of the page with the verdicts of a family."""
    return f"{device.name}-verdicts.md"


def usable_values(devices: Sequence[Device]) -> UsablePage:
    """Return the values of the page that explains verdicts."""
    return {"family_links": [markdown_link(escape(device.title), file_name(device)) for device in devices]}


def page_values(device: Device) -> VerdictPage:
    """Return the values of the page with the verdicts of a family."""
    reporting_by_frame = reportings(device)
    return {
        "device": device,
        "usable_page": PAGE,
        "decides_rows": list(_deciding_rows(device, reporting_by_frame.values())),
        "frame_rows": list(_frame_rows(device, reporting_by_frame)),
        "report_rows": list(_report_rows(device)),
    }


def _deciding_rows(device: Device, reporting_frames: Iterable[ReportsAndVerdict]) -> Iterator[Row]:
    """Yield rows of interface, frames, deciding field, its active value, verdict, source, errata.

    Frames of an interface that have equal rows share them. Only the first of these rows names the interface and the
    frames. If no frame has a position, a single row says so.
    """
    layouts_by_rows: dict[tuple[str, tuple[Row, ...]], list[Layout]] = {}
    for frame in reporting_frames:
        if frame.verdict_rules is not None:
            layout = frame.layout_plan.layout
            rows_of_frame = tuple(_rows_of_frame(device, frame.interface, layout, frame.verdict_rules))
            layouts_by_rows.setdefault((frame.interface.title, rows_of_frame), []).append(layout)
    for (interface_title, rows_of_frame), layouts in layouts_by_rows.items():
        first_row, *further_rows = rows_of_frame
        yield interface_title, _layout_links(device, layouts), *first_row
        for row in further_rows:
            yield "", "", *row
    if not layouts_by_rows:
        titles = ", ".join(interface.title for interface in device.interfaces)
        yield titles, "no frame with a position", "", "", "", "", ""


def _rows_of_frame(device: Device, interface: Interface, layout: Layout, verdict_rules: VerdictRules) -> Iterator[Row]:
    """Yield a row for each field that can decide the verdict on a frame, then a row for all other cases.

    If some order codes lack the bits that say whether the position is usable, a last row has their verdict.
    """
    # A sign is a set of field values that decides the verdict. Its flag represents it.
    sign_by_field = {sign.flag.name: sign for sign in layout.signs}
    deciders = _deciding_fields(layout, verdict_rules)
    for decider in deciders:
        sign = sign_by_field.get(decider.field.name)
        yield _decider_row(device, interface, layout, decider=decider, sign=sign)
    # Rows of deciding field, value, verdict, source, errata.
    other_cases = "none of these" if deciders else "no field decides"
    yield other_cases, "", EFFECTS[verdict_rules.default_verdict], "", ""
    if verdict_rules.may_be_unknown:
        judging_names = [CodeText(field.name) for field in layout.judging_fields]
        lacking_names_text = MARKDOWN.phrase(statement(*list_parts(judging_names)))
        yield f"order codes that lack {lacking_names_text}", "", EFFECTS[Verdict.UNKNOWN], "", ""


@dataclass(frozen=True, slots=True)
class _Decider:
    """Field that can decide the verdict on a frame.

    ``conditions`` are the order codes, and the answers to open questions, for which it does.
    """

    verdict: Verdict
    field: Field
    conditions: tuple[CodeCondition, ...] = ()


def _deciding_fields(layout: Layout, verdict_rules: VerdictRules) -> list[_Decider]:
    """Return the fields that can decide the verdict on a frame: the worst verdict first, then in frame order.

    If the verdict without any cause is UNKNOWN, fields that lead to a warning or to UNKNOWN are listed with UNKNOWN,
    because a warning does not improve it. Fields that leave the position usable are last.
    """
    # A sign is a set of field values that decides the verdict. Its flag represents it.
    fields_and_flags_of_signs = (*layout.fields, *(sign.flag for sign in layout.signs))
    deciders: list[_Decider] = []
    for verdict, causes in verdict_rules.worst_first:
        deciders += [_Decider(verdict, cause.cause.field, cause.conditions) for cause in causes]
    if verdict_rules.default_verdict is Verdict.UNKNOWN:
        verdicts_without_improvement = (Verdict.USABLE_WITH_WARNING, Verdict.UNKNOWN)
        fields_without_improvement = [
            field for field in layout.fields if field.makes_position in verdicts_without_improvement
        ]
        deciders += [_Decider(Verdict.UNKNOWN, field) for field in fields_without_improvement]
    # The enumeration lists the verdicts from the worst to the best.
    worst_first = list(Verdict)
    field_names = [field.name for field in fields_and_flags_of_signs]

    def verdict_and_place(decider: _Decider) -> tuple[int, int]:
        return worst_first.index(decider.verdict), field_names.index(decider.field.name)

    deciders.sort(key=verdict_and_place)
    usable_fields = [field for field in fields_and_flags_of_signs if field.makes_position is Verdict.USABLE]
    return [*deciders, *(_Decider(Verdict.USABLE, field) for field in usable_fields)]


def _decider_row(device: Device, interface: Interface, layout: Layout, *, decider: _Decider, sign: Sign | None) -> Row:
    """Return a row of deciding field, the value with which it decides, verdict, source, errata.

    If the field represents the values of several fields, ``sign`` has these values. Otherwise, it is None.
    """
    field = decider.field
    if sign is None:
        value_with_conditions = _active_value(device, field, decider.conditions)
        deciding_cell = value_with_conditions + _condition_on_combined_flags(field, layout)
    else:
        deciding_cell = _values_of_sign(layout, sign)
    path_of_frame = f"interfaces.{interface.name}.{layout.name}"
    return (
        _name_cell(field),
        deciding_cell,
        EFFECTS[decider.verdict],
        _source_cell(device, field),
        _errata_links(device, path_of_frame, field, _fields_of_sign(layout, sign)),
    )


def _fields_of_sign(layout: Layout, sign: Sign | None) -> list[Field]:
    """Return the fields whose values decide the verdict together, or an empty list without a sign."""
    return [layout.field(name) for name, _ in sign.conditions] if sign is not None else []


def _active_value(device: Device, field: Field, conditions_on_codes: Sequence[CodeCondition]) -> str:
    """Return the value with which a field decides the verdict, followed by its conditions: ``1 with X-24``."""
    texts_of_conditions = [_condition_text(device, condition) for condition in conditions_on_codes]
    return " ".join([deciding_value(field), *texts_of_conditions])


def _condition_text(device: Device, condition: CodeCondition) -> str:
    """Return a condition as text: order codes, such as ``for X-24``, or the required answer to an open question."""
    for alternative in device.optional_alternatives:
        if alternative.parameter == condition.parameter:
            return _answer_text(device, alternative, condition)
    return f"for {code_span(condition.codes)}" if condition.holds else "for all other order codes"


def _answer_text(device: Device, question: Alternative, condition: CodeCondition) -> str:
    """Return the answers to an open question for which a condition holds, with a link to the question.

    The link leads to the page of the first interface with a frame whose verdict depends on the question.
    """
    answer_codes = [code_span(answer.name) for answer in question.answers if condition.contains(answer.sets)]
    answer_names = " or ".join(answer_codes)
    frames = device.layouts()
    interfaces = (interface for interface, layout in frames if question in device.verdict_alternatives(layout))
    interface = first_or_raise(interfaces, f"frame whose verdict '{question.name}' decides")
    path_to_question = f"{device.name}/{interface.name}.md#alternative-{question.name}"
    # The default answer sets the parameter to 0.
    default_text = "" if condition.holds else " (the default)"
    return f"if {markdown_link('you choose', path_to_question)} {answer_names}{default_text}"


def _values_of_sign(layout: Layout, sign: Sign) -> str:
    """Return the field values that decide the verdict together: ``error is 1 and mode is 5h (test)``."""
    fields_and_values = [(layout.field(name), value) for name, value in sign.conditions]
    return MARKDOWN.phrase(conditions_text(fields_and_values))


def _condition_on_combined_flags(field: Field, layout: Layout) -> str:
    """Return the condition under which a flag that combines other flags decides: ``, with busy and error inactive``.

    Only combined flags in the same frame count. Return an empty string if there are none.
    """
    names_in_layout = {field.name for field in layout.fields}
    combined_flags = [CodeText(name) for name in field.sums_up if name in names_in_layout]
    if not combined_flags:
        return ""
    listed_flags = MARKDOWN.phrase(statement(*list_parts(combined_flags)))
    return f", with {listed_flags} inactive"


def _frame_rows(device: Device, reporting_by_frame: Mapping[str, ReportsAndVerdict]) -> Iterator[Row]:
    """Yield rows of interface, frames, and their possible reports, or ``nothing`` for frames without reports.

    Frames of an interface that have the same reports share a row.
    """
    layouts_by_reports: dict[tuple[str, tuple[str, ...]], list[Layout]] = {}
    for interface, layout in device.layouts():
        if layout.sender == "encoder":
            reports_and_verdict = reporting_by_frame.get(layout.name)
            causes = reports_and_verdict.causes if reports_and_verdict is not None else ()
            report_names = tuple(cause.report.name for cause in causes)
            layouts_by_reports.setdefault((interface.title, report_names), []).append(layout)
    for (interface_title, report_names), layouts in layouts_by_reports.items():
        reports_cell = ", ".join(map(code_span, report_names))
        yield interface_title, _layout_links(device, layouts), reports_cell or "nothing"


def _report_rows(device: Device) -> Iterator[Row]:
    """Yield rows of report, meaning, remedy, source for all reports of a family."""
    for report in reports_of(device):
        field = report.field
        alarm = alarm_of(device, field)
        name_cell = join_filled([code_span(report.name), escape(own_names(field))])
        step_links = links_to_steps(f"{device.name}/", manual_steps(field, alarm))
        remedy_cell_text = join_filled([escape(remedy_text(field, alarm)), *step_links])
        if not remedy_cell_text:
            remedy_cell_text = _clearing_procedures(device, alarm)
        if not remedy_cell_text:
            remedy_cell_text = f"The {word_for_document(device)} gives no remedy"
        yield name_cell, escape(meaning(field, alarm)), remedy_cell_text, citation(alarm_source(field, alarm))


def _clearing_procedures(device: Device, alarm: Alarm | None) -> str:
    """Return links to the procedures that clear an alarm, or "" without an alarm or if the spec names none."""
    if alarm is None or not alarm.cleared_by:
        return ""
    procedure_links = []
    for procedure in map(device.procedure, alarm.cleared_by):
        path = path_to_anchor(device, procedure.interface, f"procedure-{procedure.name}")
        procedure_links.append(markdown_link(escape(procedure.title), path))
    return f"Cleared by: {', '.join(procedure_links)}"


def _name_cell(field: Field) -> str:
    """Return the name of a field in the spec, with its names in the editions of the manual below it."""
    return join_filled([code_span(field.name), escape(own_names(field))])


def _source_cell(device: Device, field: Field) -> str:
    """Return the source of a flag's alarm or, without an alarm, of the flag."""
    return citation(alarm_source(field, alarm_of(device, field)))


def _layout_links(device: Device, layouts: Sequence[Layout]) -> str:
    return ", ".join(link_to_layout(device, layout, code_span(layout.name)) for layout in layouts)


def _errata_links(device: Device, path_of_frame: str, field: Field, fields_of_sign: Sequence[Field]) -> str:
    """Return links to the errata about a deciding field and, for a flag, about its group of fields.

    If several fields decide together, they are ``fields_of_sign``, and the errata are about all of them.
    ``path_of_frame`` is the path of the frame in the spec.
    """
    spec_paths = {f"{path_of_frame}.{field.name}"}
    for deciding_field in fields_of_sign or [field]:
        name, group = deciding_field.name, deciding_field.group
        spec_paths |= {f"{path_of_frame}.{name}", f"field_groups.{group}.{name}"}
        if group and isinstance(meaning_of(deciding_field), ActiveFlag):
            spec_paths.add(f"field_groups.{group}")
    errata_about_facts = [erratum for erratum in device.errata if not erratum.edition and erratum.severity != "wording"]
    # ``affects`` are paths in the spec.
    affecting_errata = [erratum for erratum in errata_about_facts if not spec_paths.isdisjoint(erratum.affects)]
    return link_list(link_to_erratum(device, erratum) for erratum in affecting_errata)
