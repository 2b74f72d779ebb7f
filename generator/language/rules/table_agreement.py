"""Rules for tables: their shape and units, and cells that other facts repeat, such as frequencies and order codes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from decimal import Decimal

from ...model import Table
from ...say.text import count_with_unit
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
from ..written_codes import WrittenCodePart
from ..written_parts import WrittenSpec

_DECIMAL_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_HEX_NUMBER = re.compile(r"(?:0x)?([0-9A-F]{2,4})h?")
#: Edges of the two signals A and B in one period.
_EDGES_PER_PERIOD = 4
_FREQUENCY_UNITS = frozenset(("Hz", "kHz", "MHz"))
_NANOMETRES_PER_UNIT = {"nm": 1, "µm": 1_000, "mm": 1_000_000}


def check_edges_and_periods(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that in tables with the frequencies of periods and of edges, there are four edges per period.

    The incremental signals A and B have two edges each in one period. An erratum about the table that contains both
    numbers explains another ratio.
    """
    for table in spec.tables:
        period_column = _frequency_column(table.part, "periods")
        edge_column = _frequency_column(table.part, "edges")
        if period_column is None or edge_column is None:
            continue
        numbers_of_errata = _numbers_of_errata(spec, f"tables.{table.part.name}")
        for index, row in enumerate(table.part.rows):
            period_frequency = _number_in_cell(row, period_column)
            edge_frequency = _number_in_cell(row, edge_column)
            if period_frequency is None or edge_frequency is None:
                continue
            period_text, edge_text = row[period_column], row[edge_column]
            is_correct = edge_frequency == _EDGES_PER_PERIOD * period_frequency
            is_explained = {period_text, edge_text} <= numbers_of_errata
            if not is_correct and not is_explained:
                expected_text = f"{_EDGES_PER_PERIOD} times the period frequency {period_text}"
                message = f"the edge frequency {edge_text} is not {expected_text}"
                path = (*table.path, "rows", index, edge_column)
                report.add("table-arithmetic", path, f"{message}; correct one of the two")


def _numbers_of_errata(spec: WrittenSpec, affected_path: str) -> set[str]:
    """Return the numbers in the texts of the errata that affect a place."""
    texts = [f"{erratum.printed} {erratum.used}" for erratum in spec.errata if affected_path in erratum.affects]
    return set(_DECIMAL_NUMBER.findall(" ".join(texts)))


def _frequency_column(table: Table, word: str) -> int | None:
    """Return the index of the column of frequencies with this word in its heading.

    The result is None if there is not exactly one, or if the table has frequencies in different units.
    """
    columns: list[int] = []
    for index, (heading, unit) in enumerate(zip(table.columns, table.units, strict=False)):
        if unit in _FREQUENCY_UNITS and re.search(rf"\b{word}\b", heading, re.IGNORECASE):
            columns.append(index)
    frequency_units = {unit for unit in table.units if unit in _FREQUENCY_UNITS}
    is_unambiguous = len(columns) == 1 and len(frequency_units) == 1
    return columns[0] if is_unambiguous else None


def _number_in_cell(row: tuple[str, ...], column: int) -> Decimal | None:
    """Return the number in a cell, or None if the cell is missing or contains other text."""
    cell = row[column] if column < len(row) else ""
    return Decimal(cell) if _DECIMAL_NUMBER.fullmatch(cell) else None


def check_order_codes_in_rows(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a row about a value of the order code has the quantity that this value means.

    For example, the label ``0050`` means ``50 µm``, so its row must have 50 in the column ``Resolution µm``. The
    heading of the column begins with the meaning of the part of the order code.
    """
    for table in spec.tables:
        for part in spec.order_code.parts:
            if not part.meaning:
                continue
            columns: list[int] = []
            for index, heading in enumerate(table.part.columns):
                if heading.casefold().startswith(part.meaning.casefold()):
                    columns.append(index)
            if len(columns) != 1:
                continue
            (column,) = columns
            has_unit = column < len(table.part.units)
            if has_unit:
                meaning_by_label = {label: value.meaning for label, value in part.values.items()}
                _compare_rows(table, column, meaning_by_label, report)


def _compare_rows(
    table: LocatedPart[Table], column: int, meaning_by_label: dict[str, str], report: DocumentReport
) -> None:
    """Report each row of a table whose number in a column differs from the meaning of the label in its other cells.

    A label such as ``0050`` has a meaning such as ``50 µm``. Rows with no label or several are skipped.
    """
    unit = table.part.units[column]
    for index, row in enumerate(table.part.rows):
        other_cells = " ".join(cell for cell_index, cell in enumerate(row) if cell_index != column)
        words_in_row = re.split(r"[^A-Za-z0-9]+", other_cells)
        labels = {word for word in words_in_row if word in meaning_by_label}
        number = _number_in_cell(row, column)
        if len(labels) != 1 or number is None or not unit:
            continue
        label = labels.pop()
        meaning = meaning_by_label[label]
        quantity = re.fullmatch(rf"({_DECIMAL_NUMBER.pattern}) {re.escape(unit)}", meaning)  # ``50 µm``
        if quantity is not None and Decimal(quantity[1]) != number:
            message = (
                f"the row is about {quoted(label)}, which means {meaning} in the order code, but this is"
                f" {row[column]} {unit}; correct one of the two"
            )
            report.add("table-arithmetic", (*table.path, "rows", index, column), message)


def check_order_codes_in_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the codes in table columns with the heading "order code" begin with the fixed text of order codes.

    Also check that each number between two hyphens in them is a label of a part of the order code, or one that an open
    part accepts.
    """
    fixed_start, _, _ = spec.order_code.pattern.partition("{")  # The text before the first part.
    if not fixed_start.strip("-/ "):
        return
    for table in spec.tables:
        headings = [heading.casefold() for heading in table.part.columns]
        if "order code" not in headings:
            continue
        column = headings.index("order code")
        for index, row in enumerate(table.part.rows):
            cell = row[column] if column < len(row) else ""
            codes = re.findall(r"\S+-\.\.\.", cell)  # Such as ``TV62-0050-...``.
            problems = [_problem_of_code(code, fixed_start, spec) for code in codes]
            first_problem = next(filter(None, problems), "")
            path = (*table.path, "rows", index, column)
            is_reported = path in report.faults()  # As an order code in a text.
            if first_problem and not is_reported:
                report.add("table-arithmetic", path, f"{first_problem}; correct it")


def _problem_of_code(code: str, fixed_start: str, spec: WrittenSpec) -> str:
    """Return the reason that a text cannot be an order code, or an empty string if it can.

    ``fixed_start`` is the text with which all order codes begin.
    """
    if not code.startswith(fixed_start):
        return f"{quoted(code)} does not begin with {quoted(fixed_start)}, as order codes do"
    for word in code.removeprefix(fixed_start).split("-"):
        is_label = any(_accepts_label(part, word) for part in spec.order_code.parts)
        if word.isdecimal() and not is_label:
            return f"{quoted(word)} is not in the order code"
    return ""


def _accepts_label(part: WrittenCodePart, label: str) -> bool:
    """Return True if a part of the order code lists a label or, if it is open, its expression matches the label."""
    return label in part.values or bool(part.open and re.fullmatch(part.open, label))


def check_reserved_addresses(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no register is in a range of addresses that a table calls reserved."""
    for table in spec.tables:
        if "reserved" not in table.part.title.casefold():
            continue
        for index, row in enumerate(table.part.rows):
            reserved_addresses = _address_range_in_row(table.part, row)
            for register in spec.registers:
                is_in_bank = register.bank is not None
                if register.reserved or is_in_bank:
                    continue
                if register.address in reserved_addresses:
                    message = f"the register {quoted(register.name)} is at {register.address:02X}h"
                    report.add("table-arithmetic", (*table.path, "rows", index), f"{message}; correct one of the two")
                    break


def _address_range_in_row(table: Table, row: tuple[str, ...]) -> range:
    """Return the addresses from the first to the last address in a row. Empty if the table has no such columns."""
    headings = [heading.casefold() for heading in table.columns]
    cell_by_heading = dict(zip(headings, row, strict=False))
    first_match = _HEX_NUMBER.fullmatch(cell_by_heading.get("first address", ""))
    last_match = _HEX_NUMBER.fullmatch(cell_by_heading.get("last address", ""))
    is_complete = len(row) >= len(headings)
    if first_match is None or last_match is None or not is_complete:
        return range(0)
    first_address = int(first_match[1], 16)
    last_address = int(last_match[1], 16)
    return range(first_address, last_address + 1)


def check_lengths_of_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the lengths in ``used``, an erratum's text about what applies, are in the tables that it affects.

    Only errata about tables with a column of lengths are checked.
    """
    table_by_path = {f"tables.{table.part.name}": table.part for table in spec.tables}
    for erratum in spec.errata:
        lengths_in_tables: set[Decimal] = set()
        for affected_path in erratum.affects:
            if affected_path in table_by_path:
                lengths_in_tables.update(_yield_lengths(table_by_path[affected_path]))
        if not lengths_in_tables:
            continue
        for number_text, unit in re.findall(r"(\d[\d,]*(?:\.\d+)?) (nm|µm|mm)\b", erratum.used):
            length = Decimal(number_text.replace(",", "")) * _NANOMETRES_PER_UNIT[unit]
            if length not in lengths_in_tables:
                message = f"no table that it affects has {number_text} {unit}; correct one of the two"
                report.add("left-behind", erratum.place_of("used"), message)
                break


def _yield_lengths(table: Table) -> Iterator[Decimal]:
    """Yield the numbers in the columns of lengths of a table, in nanometres."""
    for row in table.rows:
        for column, unit in enumerate(table.units):
            number = _number_in_cell(row, column)
            if unit in _NANOMETRES_PER_UNIT and number is not None:
                yield number * _NANOMETRES_PER_UNIT[unit]


#: A number, perhaps with a word or sign for a limit, such as ``above 5`` or ``≤ 5``.
_CELL_WITH_NUMBER = re.compile(r"(?:(?:above|at least|at most|below) |[<>≤≥] ?)?-?\d+(?:\.\d+)?")


def check_column_units(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a table with units has one per column, and only numbers in the columns whose unit is not empty."""
    for table in spec.tables:
        columns, units = table.part.columns, table.part.units
        if not units:
            continue
        if len(units) != len(columns):
            column_count = count_with_unit(len(columns), "column")
            unit_count = count_with_unit(len(units), "unit")
            message = f'the table has {column_count} but {unit_count}; give one for each, or ""'
            report.add("column-units", (*table.path, "units"), message)
            continue
        for row_index, cells in enumerate(table.part.rows):
            # Another rule reports a row with too few or too many cells.
            for column_index, (unit, cell) in enumerate(zip(units, cells, strict=False)):
                if unit and not _CELL_WITH_NUMBER.fullmatch(cell):
                    message = f"{quoted(cell)} is not a number, but the column has the unit {unit}"
                    report.add("column-units", (*table.path, "rows", row_index, column_index), message)


def check_table_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each row of a table has one cell per column."""
    for table in spec.tables:
        column_count = len(table.part.columns)
        for row_index, row in enumerate(table.part.rows):
            if len(row) != column_count:
                cells_text = count_with_unit(len(row), "cell")
                columns_text = count_with_unit(column_count, "column")
                message = f"the row has {cells_text}, but the table has {columns_text}"
                report.add("table-shape", (*table.path, "rows", row_index), message)
