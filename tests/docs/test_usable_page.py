"""The pages with the verdicts of the families: their tables agree with the reference codec for every frame."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

import pytest
from codewheel.model import Choice, Device, Flag, Layout, Number, Unused, Verdict
from codewheel.order_codes.parameters import with_answers
from codewheel.plan.verdicts import reports_of
from codewheel.reference import codec
from codewheel.reference.findings import Findings, findings
from codewheel.targets import Library
from codewheel.targets.docs.verdict_table import EFFECTS

Row = tuple[str, ...]
#: Number of columns of the table below each heading.
COLUMNS = {"Deciding bits": 7, "Reports of each frame": 3, "Meaning of each report": 4}


def rows(page: str, after: str) -> list[Row]:
    """Return the rows of the table below a heading. A cell that is left out repeats the row above."""
    lines = page.partition(f"## {after}\n")[2].partition("\n## ")[0].splitlines()
    table = [re.split(r" ?(?<!\\)\| ?", line)[1:-1] for line in lines if line.startswith("|")][2:]
    table_rows: list[Row] = []
    for cells in table:
        # An interface and a frame apply until the next interface or frame is named.
        first_filled = next((index for index, cell in enumerate(cells) if cell), 0)
        above = table_rows[-1][:first_filled] if table_rows else ()
        table_rows.append((*above, *cells[len(above) :]))
    return table_rows


def plain(cell: str) -> str:
    """Return a cell without its links, and a name without the manual's names."""
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"<a [^>]*></a>", "", cell)).partition("<br>")[0]


def frames(device: Device, cell: str) -> list[Layout]:
    return [device.layout(name.strip("`")) for name in plain(cell).split(", ")]


def code_part(when: str) -> str:
    """Return the part of the order codes to which a row applies, since AMM5 has flags that depend on the order code."""
    if "for all other order codes" in when:
        return "/1"
    return "/65K" if ".../65K..." in when else ""


def findings_of_frame(device: Device, layout: Layout, active: str, when: str = "") -> Findings:
    """Return the findings of a frame in which one flag is active, or unused bits differ, or neither.

    If ``active`` is not a field, nothing is active. The order code, and the answer of the user, are those to which the
    row applies, according to ``when``.
    """
    interface = next(kind for kind, candidate in device.layouts() if candidate is layout)
    variants = [variant for variant in device.variants if variant.interface == interface.name]
    variant = next(variant for variant in variants if code_part(when) in variant.code)
    answer = re.search(r"you choose `(\w+)`", plain(when))
    for question in device.verdict_alternatives(layout) if answer is not None else ():
        variant = with_answers(device, variant, {question.name: answer[1]})
    placed = layout.place(variant.parameters)
    unused = {field.name: ((1 << field.widest) - 1) << place for field, place in layout.unused}
    values: dict[str, int | str | bool] = {"unused": unused.get(active, 0)} if layout.unused else {}
    for placed_field in placed.fields:
        match placed_field.field.kind:
            case Flag():
                values[placed_field.name] = placed_field.name == active
            case Number():
                values[placed_field.name] = placed_field.field.number.zero_means
            case Choice(values=choices):
                is_selector = placed_field.name == layout.selector
                possible = [choice for choice in choices if not is_selector or choice.value in layout.selects]
                values[placed_field.name] = possible[0].name
    decoded = codec.decode(device, placed, codec.encode(device, placed, values))
    assert decoded.problems == ()
    return findings(device, variant, decoded)


def by_family(library: Library, pages: Mapping[str, str], heading: str) -> Iterator[tuple[Device, Row]]:
    for device in library.devices:
        for row in rows(pages[f"docs/{device.name}-verdicts.md"], heading):
            # A table has no column that is empty for the whole family.
            yield device, (*row, *[""] * (COLUMNS[heading] - len(row)))


def test_the_table_is_what_the_reference_codec_decides(library: Library, pages: Mapping[str, str]) -> None:
    names_by_layout: dict[tuple[str, str], set[str]] = {}
    for device, (title, cell, name, when, verdict, *_) in by_family(library, pages, "Deciding bits"):
        for layout in frames(device, cell):
            assert title in {kind.title for kind, candidate in device.layouts() if candidate is layout}
            speaks = plain(name).strip("`")
            decided = findings_of_frame(device, layout, speaks, when).verdict
            assert decided is not None
            assert EFFECTS[decided] == verdict, (layout.name, name)
            names_by_layout.setdefault((device.name, layout.name), set()).add(speaks)
            if speaks in {field.name for field in layout.fields}:
                assert when.startswith(active_value(layout, speaks)), (layout.name, name)
    deciding_fields = {}
    for device in library.devices:
        for kind, layout in device.layouts():
            if device.sends_position(kind.name, layout):
                fields = [field.name for field in layout.fields if isinstance(field.kind, (Flag, Unused))]
                deciding_fields[device.name, layout.name] = set(fields)
    assert {key: names & deciding_fields[key] for key, names in names_by_layout.items()} == deciding_fields
    assert all(names & {"none of these", "no field decides"} for names in names_by_layout.values())


def active_value(layout: Layout, name: str) -> str:
    field = layout.field(name)
    match field.kind:
        case Flag(active_low=low):
            return "0" if low else "1"
        case Unused(value) if field.widest > 1:
            return f"not {value}"
        case Unused(value):
            return f"{1 - value}"
        case _:
            raise AssertionError(name)


@pytest.mark.parametrize(
    ("family", "frame", "name", "when", "verdict"),
    [
        # 6.3.1 p.21: nE and nW are not used and always 1. In the BiSS protocol, 0 is an error or a warning.
        ("am36", "single_cycle_data", "error", "0", "not_usable"),
        ("am36", "single_cycle_data", "warning", "0", "unknown"),
        ("am36", "single_cycle_data", "none of these", "", "unknown"),
        # 7.3.2 p.42: EE_1 represents four flags, which occur only in ALMC of data ID 3.
        ("amm5", "singleturn_reply", "status_other_error", "1", "not_usable"),
        (
            "amm5",
            "complete_reply",
            "status_other_error",
            "1, with `busy`, `ps_error`, `battery_alarm` and `mt_error` inactive",
            "not_usable",
        ),
        ("amm5", "complete_reply", "busy", "1", "not_usable"),
        ("amm5", "complete_reply", "battery_alarm", "1", "usable_with_warning"),
        ("amm5", "complete_reply", "alarm_zero_3_4", "not 0", "usable_with_warning"),
        ("amm5", "ssi_word", "no field decides", "", "unknown"),
        # 5.4 p.22: the error bit of SSI is 0 while there is an error.
        ("sma21", "ssi_word", "error", "0", "not_usable"),
        ("sma21", "wide_position_reply", "status_alarm", "1", "usable_with_warning"),
    ],
)
def test_as_the_manuals_have_it(
    library: Library, pages: Mapping[str, str], family: str, frame: str, name: str, when: str, verdict: str
) -> None:
    verdict_rows = []
    for device, row in by_family(library, pages, "Deciding bits"):
        if device.name == family and plain(row[2]).strip("`") == name:
            frame_names = [layout.name for layout in frames(device, row[1])]
            if frame in frame_names:
                verdict_rows.append(row[3:5])
    assert verdict_rows == [(when, EFFECTS[Verdict(verdict)])]


def test_what_a_battery_decides_goes_by_the_order_code(library: Library, pages: Mapping[str, str]) -> None:
    """AMM5, 6.2.1 p.33 and 7.4.1 p.44: only multiturn models have a battery (4.3 p.23)."""
    amm5_rows = [row for device, row in by_family(library, pages, "Deciding bits") if device.name == "amm5"]
    conditions = {(plain(row[2]).strip("`"), plain(row[3]).partition(", ")[0], row[4]) for row in amm5_rows}
    chosen = {
        "warning": (
            "0 for `.../65K...` if you choose `either_cause` (the default)",
            "0 for all other order codes",
        ),
        "mt_error": ("1 for `.../65K...`", "1 for all other order codes"),
    }
    for name, (with_battery, without) in chosen.items():
        assert (name, with_battery, "✕ **not usable**") in conditions
        assert (name, without, "▲ usable with a warning") in conditions
    with_answer = "0 for `.../65K...` if you choose `low_battery`"
    assert ("warning", with_answer, "▲ usable with a warning") in conditions


def test_where_the_manual_is_silent_the_erratum_is_named(library: Library, pages: Mapping[str, str]) -> None:
    silent = {"amm5", "asc85", "sma21"}
    for device, row in by_family(library, pages, "Deciding bits"):
        name = plain(row[2]).strip("`")
        fields = [field for layout in frames(device, row[1]) for field in layout.fields]
        flags = {field.name for field in fields if isinstance(field.kind, Flag)}
        assert ("position_under_error" in row[6]) == (name in flags and device.name in silent), (device.name, name)
        # The spec of a part of a manual cites the pages of a frame, but not of each flag.
        cites = name not in ("no field decides", "none of these") and device.evidence.grade == "manual"
        assert (row[5] != "") == cites


@pytest.mark.parametrize(
    ("family", "name", "remedy"),
    [
        ("amm5", "status_other_error", "Request data ID 3. Its ALMC shows the active error"),
        # 7.5 p.46: the request is not executed while the memory is busy.
        ("amm5", "eeprom_write_reply_mem_busy", "Send the request again"),
        ("amm5", "eeprom_read_reply_mem_busy", "Send the request again"),
        # 6.2.1 p.20: both bits refer to register 69h.
        ("asc85", "error", "Read the error register (69h). It shows the active errors."),
        # 6.2.1: "For a comprehensive list of the available warning messages".
        ("asc85", "warning", "Read the error register (69h). It shows the active warnings."),
        # 7.3.2 p.38: "E' necessario un reset, bisogna trasmettere un ID di reset errore per 10 volte".
        ("sma21", "status_error", "Reset the errors with data ID B"),
    ],
)
def test_a_remedy_of_the_manual_is_named(
    library: Library, pages: Mapping[str, str], family: str, name: str, remedy: str
) -> None:
    meanings = by_family(library, pages, "Meaning of each report")
    rows_of_family = [row for device, row in meanings if device.name == family]
    assert [row[2] for row in rows_of_family if plain(row[0]).strip("`") == name] == [remedy]


def test_every_report_is_there_and_each_frame_says_which(library: Library, pages: Mapping[str, str]) -> None:
    listed: dict[str, list[str]] = {}
    for device, row in by_family(library, pages, "Meaning of each report"):
        listed.setdefault(device.name, []).append(plain(row[0]).strip("`"))
        assert row[1]
    for device in library.devices:
        assert listed[device.name] == [report.name for report in reports_of(device)]
    assert set(listed) == {device.name for device in library.devices}
    reported: dict[str, set[str]] = {}
    for device, row in by_family(library, pages, "Reports of each frame"):
        reported.setdefault(device.name, set()).update(re.findall("`([a-z0-9_]+)`", row[2]))
        for layout in frames(device, row[1]):
            assert layout.sender == "encoder"
            frame_findings = [findings_of_frame(device, layout, field.name) for field in layout.fields]
            expected = {report.field for findings in frame_findings for report in findings.reports}
            flags = (field for field in layout.fields if isinstance(field.kind, Flag) and field.kind.only)
            expected |= {f"{field.name}_unexplained" for field in flags}
            if device.alternatives_of(layout) == ():
                assert set(re.findall("`([a-z0-9_]+)`", row[2])) == expected
    assert reported == {name: set(names) for name, names in listed.items()}


def test_every_page_leads_to_it(library: Library, pages: Mapping[str, str]) -> None:
    assert "[page on verdicts](usable-or-not.md)" in pages["docs/README.md"]
    for device in library.devices:
        page = f"{device.name}-verdicts.md"
        assert f"[usable or not]({page})" in pages[f"docs/{device.name}.md"]
        assert f"[{device.title}]({page})" in pages["docs/usable-or-not.md"]
        assert "[page on verdicts](usable-or-not.md)" in pages[f"docs/{page}"]
