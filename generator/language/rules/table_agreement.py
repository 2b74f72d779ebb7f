"""Rules for the cells of tables that other facts repeat: frequencies, resolutions, order codes, reserved addresses."""

from __future__ import annotations

import re
from collections.abc import Iterator
from decimal import Decimal

from ...model import Table
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
    """Check that a table with frequencies of periods and of edges has four edges a period.

    The signals A and B have two edges each in one period. Other ratios need an erratum about the table with both
    numbers.
    """
    for table in spec.tables:
        periods, edges = (_frequency_column(table.part, word) for word in ("periods", "edges"))
        if periods is None or edges is None:
            continue
        numbers_of_errata = _numbers_of_errata(spec, f"tables.{table.part.name}")
        for index, row in enumerate(table.part.rows):
            period_frequency, edge_frequency = _number_in_cell(row, periods), _number_in_cell(row, edges)
            if (
                period_frequency is None
                or edge_frequency is None
                or edge_frequency == _EDGES_PER_PERIOD * period_frequency
            ):
                continue
            is_explained = {row[periods], row[edges]} <= numbers_of_errata
            if not is_explained:
                factor = f"{_EDGES_PER_PERIOD} times the period frequency {row[periods]}"
                message = f"the edge frequency {row[edges]} is not {factor}"
                path = (*table.path, "rows", index, edges)
                report.add("table-arithmetic", path, f"{message}; correct one of the two")


def _numbers_of_errata(spec: WrittenSpec, affected_path: str) -> set[str]:
    """Return the numbers in the texts of the errata that affect a place."""
    texts = [f"{erratum.printed} {erratum.used}" for erratum in spec.errata if affected_path in erratum.affects]
    return set(_DECIMAL_NUMBER.findall(" ".join(texts)))


def _frequency_column(table: Table, word: str) -> int | None:
    """Return the only column of frequencies with this word in its heading, if it has the unit of the other columns."""
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
    """Check that a row about an order code has the quantity that the meaning of its label gives.

    For example, the label ``0050`` means ``50 µm``, so its row has 50 in the column ``Resolution µm``. The column
    begins with the meaning of the part of the order code.
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
    """Report each row whose quantity is not the meaning of the only label of ``meanings`` in its other cells."""
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
    """Check that the order codes in a column named after them begin as the pattern does, and have its numbers.

    A number between two hyphens is a label of a part of the order code, or one that an open part accepts.
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
            problems = [_wrong_code(code, start, spec) for code in codes]
            first_problem = next(filter(None, problems), "")
            path = (*table.path, "rows", index, column)
            is_reported = path in report.faults()  # As an order code in a text.
            if first_problem and not is_reported:
                report.add("table-arithmetic", path, f"{first_problem}; correct it")


def _wrong_code(code: str, start: str, spec: WrittenSpec) -> str:
    """Return why a text cannot be an order code, or an empty string."""
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
            first, last = int(first_match[1], 16), int(last_match[1], 16)
            for register in spec.registers:
                if not register.reserved and register.bank is None and first <= register.address <= last:
                    message = f"the register {quoted(register.name)} is at {register.address:02X}h"
                    report.add("table-arithmetic", (*table.path, "rows", index), f"{message}; correct one of the two")
                    break


def check_lengths_of_errata(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the lengths that an erratum about a table uses are in this table, if it has a column of lengths."""
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
