"""Rules for tables: their shape and units, and cells that other facts repeat, such as frequencies and order codes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from decimal import Decimal

from ...model import Table
from ...say.text import count_with_unit
from ..problems import DocumentReport, quoted
from ..written import LocatedPart
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
            is_correct = edge_frequency == _EDGES_PER_PERIOD * period_frequency
            is_explained = {row[period_column], row[edge_column]} <= numbers_of_errata
            if not is_correct and not is_explained:
                factor = f"{_EDGES_PER_PERIOD} times the period frequency {row[period_column]}"
                message = f"the edge frequency {row[edge_column]} is not {factor}"
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
            meanings = {label: value.meaning for label, value in part.values.items()}
            columns: list[int] = []
            for index, heading in enumerate(table.part.columns):
                if part.meaning and heading.casefold().startswith(part.meaning.casefold()):
                    columns.append(index)
            if len(columns) != 1:
                continue
            (column,) = columns
            has_unit = column < len(table.part.units)
            if has_unit:
                _compare_rows(table, column, meanings, report)


def _compare_rows(table: LocatedPart[Table], column: int, meanings: dict[str, str], report: DocumentReport) -> None:
    """Report each row of a table whose number in a column differs from the meaning of the label in its other cells.

    ``meanings`` contains the meaning of each label, such as ``50 µm``. Rows with no label or several are skipped.
    """
    unit = table.part.units[column]
    for index, row in enumerate(table.part.rows):
        other_cells = " ".join(cell for cell_index, cell in enumerate(row) if cell_index != column)
        labels = {word for word in re.split(r"[^A-Za-z0-9]+", other_cells) if word in meanings}
        if len(labels) != 1 or _number_in_cell(row, column) is None:
            continue
        label = labels.pop()
        quantity = re.fullmatch(rf"({_DECIMAL_NUMBER.pattern}) {re.escape(unit)}", meanings[label]) if unit else None
        if quantity is not None and Decimal(quantity[1]) != Decimal(row[column]):
            message = (
                f"the row is about {quoted(label)}, which means {meanings[label]} in the order code, but this is"
                f" {row[column]} {unit}; correct one of the two"
            )
            report.add("table-arithmetic", (*table.path, "rows", index, column), message)


def check_order_codes_in_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the codes in table columns with the heading "order code" begin with the fixed text of order codes.

    Also check that each number between two hyphens in them is a label of a part of the order code, or one that an open
    part accepts.
    """
    start, _, _ = spec.order_code.pattern.partition("{")  # The text before the first part.
    if not start.strip("-/ "):
        return
    for table in spec.tables:
        headings = [heading.casefold() for heading in table.part.columns]
        if "order code" not in headings:
            continue
        column = headings.index("order code")
        for index, row in enumerate(table.part.rows):
            codes = re.findall(r"\S+-\.\.\.", row[column]) if column < len(row) else []
            problems = [_problem_of_code(code, start, spec) for code in codes]
            first_problem = next(filter(None, problems), "")
            path = (*table.path, "rows", index, column)
            is_reported = path in report.faults()  # As an order code in a text.
            if first_problem and not is_reported:
                report.add("table-arithmetic", path, f"{first_problem}; correct it")


def _problem_of_code(code: str, start: str, spec: WrittenSpec) -> str:
    """Return the reason that a text cannot be an order code, or an empty string if it can.

    ``start`` is the fixed text with which order codes begin.
    """
    if not code.startswith(start):
        return f"{quoted(code)} does not begin with {quoted(start)}, as order codes do"
    for word in code.removeprefix(start).split("-"):
        # An open part also accepts labels that match its expression.
        is_label = any(
            word in part.values or (part.open and re.fullmatch(part.open, word)) for part in spec.order_code.parts
        )
        if word.isdecimal() and not is_label:
            return f"{quoted(word)} is not in the order code"
    return ""


def check_reserved_addresses(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no register is in a range of addresses that a table calls reserved."""
    for table in spec.tables:
        headings = [heading.casefold() for heading in table.part.columns]
        is_about_reserved = "reserved" in table.part.title.casefold()
        has_ranges = "first address" in headings and "last address" in headings
        if not is_about_reserved or not has_ranges:
            continue
        for index, row in enumerate(table.part.rows):
            if len(row) < len(headings):
                continue
            first_match = _HEX_NUMBER.fullmatch(row[headings.index("first address")])
            last_match = _HEX_NUMBER.fullmatch(row[headings.index("last address")])
            if first_match is None or last_match is None:
                continue
            reserved_addresses = range(int(first_match[1], 16), int(last_match[1], 16) + 1)
            for register in spec.registers:
                is_in_bank = register.bank is not None
                if not register.reserved and not is_in_bank and register.address in reserved_addresses:
                    message = f"the register {quoted(register.name)} is at {register.address:02X}h"
                    report.add("table-arithmetic", (*table.path, "rows", index), f"{message}; correct one of the two")
                    break


def check_lengths_of_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the lengths in ``used``, an erratum's text about what applies, are in the tables that it affects.

    Only errata about tables with a column of lengths are checked.
    """
    tables = {f"tables.{table.part.name}": table.part for table in spec.tables}
    for erratum in spec.errata:
        lengths: set[Decimal] = set()
        for affected in erratum.affects:
            if affected in tables:
                lengths.update(_yield_lengths(tables[affected]))
        if not lengths:
            continue
        for number, unit in re.findall(r"(\d[\d,]*(?:\.\d+)?) (nm|µm|mm)\b", erratum.used):
            if Decimal(number.replace(",", "")) * _NANOMETRES_PER_UNIT[unit] not in lengths:
                message = f"no table that it affects has {number} {unit}; correct one of the two"
                report.add("left-behind", erratum.place_of("used"), message)
                break


def _yield_lengths(table: Table) -> Iterator[Decimal]:
    """Yield the numbers in the columns of lengths of a table, in nanometres."""
    for row in table.rows:
        for column, unit in enumerate(table.units):
            number = _number_in_cell(row, column)
            if unit in _NANOMETRES_PER_UNIT and number is not None:
                yield number * _NANOMETRES_PER_UNIT[unit]


_CELL_WITH_NUMBER = re.compile(r"(?:(?:above|at least|at most|below) |[<>≤≥] ?)?-?\d+(?:\.\d+)?")


def check_column_units(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a table with units has one per column, and only numbers in the columns whose unit is not empty."""
    for table in spec.tables:
        units, columns = table.part.units, table.part.columns
        if not units:
            continue
        if len(units) != len(columns):
            counts = f"{count_with_unit(len(columns), 'column')} but {count_with_unit(len(units), 'unit')}"
            report.add("column-units", (*table.path, "units"), f'the table has {counts}; give one for each, or ""')
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
                cells, columns = count_with_unit(len(row), "cell"), count_with_unit(column_count, "column")
                message = f"the row has {cells}, but the table has {columns}"
                report.add("table-shape", (*table.path, "rows", row_index), message)
