"""Rules for tables: their shape and units, and cells that other tables and facts repeat."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal

from ...model import Table
from ...say.text import count_with_unit
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, quoted
from ..written import LocatedPart

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
        period_column_index = _frequency_column(table.part, "periods")
        edge_column_index = _frequency_column(table.part, "edges")
        if period_column_index is None or edge_column_index is None:
            continue
        numbers_of_errata = _numbers_of_errata(spec, f"tables.{table.part.name}")
        for row_index, row in enumerate(table.part.rows):
            period_frequency = _number_in_cell(row, period_column_index)
            edge_frequency = _number_in_cell(row, edge_column_index)
            if period_frequency is None or edge_frequency is None:
                continue
            period_text, edge_text = row[period_column_index], row[edge_column_index]
            is_correct = edge_frequency == _EDGES_PER_PERIOD * period_frequency
            is_explained = {period_text, edge_text} <= numbers_of_errata
            if not is_correct and not is_explained:
                expected_text = f"{_EDGES_PER_PERIOD} times the period frequency {period_text}"
                message = f"the edge frequency {edge_text} is not {expected_text}"
                path = (*table.path, "rows", row_index, edge_column_index)
                report.add("table-arithmetic", path, f"{message}; correct one of the two")


def _numbers_of_errata(spec: WrittenSpec, affected_path: str) -> set[str]:
    """Return the numbers in the texts of the errata that affect a place."""
    texts = [f"{erratum.printed} {erratum.used}" for erratum in spec.errata if affected_path in erratum.affects]
    return set(_DECIMAL_NUMBER.findall(" ".join(texts)))


def _frequency_column(table: Table, word: str) -> int | None:
    """Return the index of the column of frequencies with this word in its heading.

    The result is None if there is not exactly one, or if the table has frequencies in different units.
    """
    column_indexes: list[int] = []
    for column_index, (heading, unit) in enumerate(zip(table.columns, table.units, strict=False)):
        if unit in _FREQUENCY_UNITS and re.search(rf"\b{word}\b", heading, re.IGNORECASE):
            column_indexes.append(column_index)
    frequency_units = {unit for unit in table.units if unit in _FREQUENCY_UNITS}
    is_unambiguous = len(column_indexes) == 1 and len(frequency_units) == 1
    return column_indexes[0] if is_unambiguous else None


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
            column_indexes: list[int] = []
            for heading_index, heading in enumerate(table.part.columns):
                if heading.casefold().startswith(part.meaning.casefold()):
                    column_indexes.append(heading_index)
            if len(column_indexes) != 1:
                continue
            (column_index,) = column_indexes
            has_unit = column_index < len(table.part.units)
            if has_unit:
                meaning_by_label = {label: value.meaning for label, value in part.values.items()}
                _compare_rows_with_meanings(table, column_index, meaning_by_label, report)


def _compare_rows_with_meanings(
    table: LocatedPart[Table], column_index: int, meaning_by_label: dict[str, str], report: DocumentReport
) -> None:
    """Report each row of a table whose number in a column differs from the meaning of the label in its other cells.

    A label such as ``0050`` has a meaning such as ``50 µm``. Rows with no label or several are skipped.
    """
    unit = table.part.units[column_index]
    for row_index, row in enumerate(table.part.rows):
        other_cells = " ".join(cell for other_index, cell in enumerate(row) if other_index != column_index)
        words_in_row = re.split(r"[^A-Za-z0-9]+", other_cells)
        labels = {word for word in words_in_row if word in meaning_by_label}
        number = _number_in_cell(row, column_index)
        if len(labels) != 1 or number is None or not unit:
            continue
        label = labels.pop()
        meaning = meaning_by_label[label]
        quantity_match = re.fullmatch(rf"({_DECIMAL_NUMBER.pattern}) {re.escape(unit)}", meaning)  # ``50 µm``
        if quantity_match is not None and Decimal(quantity_match[1]) != number:
            message = (
                f"the row is about {quoted(label)}, which means {meaning} in the order code, but this is"
                f" {row[column_index]} {unit}; correct one of the two"
            )
            report.add("table-arithmetic", (*table.path, "rows", row_index, column_index), message)


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
                lengths_in_tables.update(_lengths_in_table(table_by_path[affected_path]))
        if not lengths_in_tables:
            continue
        for number_text, unit in re.findall(r"(\d[\d,]*(?:\.\d+)?) (nm|µm|mm)\b", erratum.used):
            length = Decimal(number_text.replace(",", "")) * _NANOMETRES_PER_UNIT[unit]
            if length not in lengths_in_tables:
                message = f"no table that it affects has {number_text} {unit}; correct one of the two"
                report.add("left-behind", erratum.path_of("used"), message)
                break


def _lengths_in_table(table: Table) -> Iterator[Decimal]:
    """Yield the numbers in the columns of lengths of a table, in nanometres."""
    for row in table.rows:
        for column_index, unit in enumerate(table.units):
            number = _number_in_cell(row, column_index)
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


#: Cells of two tables that must agree before one that differs is a mistake.
_LEAST_EQUAL_CELLS = 8
_MOST_TABLES = 50
_SIGNED_DECIMAL_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def check_repeated_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Report two tables with common columns whose numbers agree in all cells but one.

    Rows belong together if a column whose cells are all different in each table contains the same cell in both.
    """
    tables = spec.tables[:_MOST_TABLES]
    for index, located_table in enumerate(tables):
        table = located_table.part
        earlier_tables = [earlier.part for earlier in tables[:index]]
        for earlier_table in earlier_tables:
            cells = _only_difference(table, earlier_table)
            if cells is not None:
                message = (
                    f"{quoted(cells.column)} is {cells.cell} here, but {cells.earlier_cell} in the table "
                    f"{quoted(earlier_table.name)}; one of the two is wrong"
                )
                path = (*located_table.path, "rows", cells.row, table.columns.index(cells.column))
                report.add("quantity-repeated", path, message)


@dataclass(frozen=True, slots=True)
class _CellPair:
    """Cells of two tables that must agree, with the column and the row of the first cell."""

    row: int
    column: str
    cell: str
    earlier_cell: str

    @property
    def is_numeric(self) -> bool:
        """Return True if both cells are numbers, or texts with a number that have the same words: ``below 7``."""
        words = {_SIGNED_DECIMAL_NUMBER.sub("", cell) for cell in (self.cell, self.earlier_cell)}
        return len(words) == 1 and _SIGNED_DECIMAL_NUMBER.search(self.cell) is not None


def _only_difference(table: Table, earlier_table: Table) -> _CellPair | None:
    """Return the pair of cells that differs if two tables have the same numbers in all common cells but one.

    Rows belong together if they have the same cell in a column that identifies rows. A column in which most numbers
    differ is left out, because it is about something else. The result is None if no number or several numbers differ,
    or if too few are equal.
    """
    common_columns = [name for name in table.columns if name in earlier_table.columns]
    for key_column in common_columns:
        if not _identifies_rows(table, key_column) or not _identifies_rows(earlier_table, key_column):
            continue
        compared_pairs: list[_CellPair] = []
        for column_name in common_columns:
            if column_name == key_column:
                continue
            cell_pairs = _number_pairs(table, earlier_table, key_column, column_name)
            are_mostly_equal = 2 * len(_differing_cells(cell_pairs)) <= len(cell_pairs)
            if are_mostly_equal:
                compared_pairs += cell_pairs
        differing_pairs = _differing_cells(compared_pairs)
        if len(differing_pairs) == 1 and len(compared_pairs) > _LEAST_EQUAL_CELLS:
            return differing_pairs[0]
    return None


def _number_pairs(table: Table, earlier_table: Table, key_column_name: str, column_name: str) -> list[_CellPair]:
    """Return the pairs of cells with numbers in a column, from the rows with the same cell in ``key_column_name``."""
    earlier_cell_by_key: dict[str, str] = {}  # The cells in the column by the cells in the key column.
    for row in earlier_table.rows:
        key_cell = _text_of_cell(earlier_table, row, key_column_name)
        earlier_cell_by_key[key_cell] = _text_of_cell(earlier_table, row, column_name)
    cell_pairs: list[_CellPair] = []
    for row_index, row in enumerate(table.rows):
        key_cell = _text_of_cell(table, row, key_column_name)
        if key_cell in earlier_cell_by_key:
            cell = _text_of_cell(table, row, column_name)
            earlier_cell = earlier_cell_by_key[key_cell]
            cell_pairs.append(_CellPair(row=row_index, column=column_name, cell=cell, earlier_cell=earlier_cell))
    return [pair for pair in cell_pairs if pair.is_numeric]


def _differing_cells(pairs: list[_CellPair]) -> list[_CellPair]:
    return [pair for pair in pairs if pair.cell != pair.earlier_cell]


def _text_of_cell(table: Table, row: Sequence[str], column: str) -> str:
    """Return the text in a column of a row, or an empty string if the row is too short."""
    index = table.columns.index(column)
    return row[index] if index < len(row) else ""


def _identifies_rows(table: Table, column: str) -> bool:
    """Return True if all cells of a column are different, so that each identifies its row."""
    cells = [_text_of_cell(table, row, column) for row in table.rows]
    return len(cells) == len(set(cells))


_HEX_CELL = re.compile(r"(?:0x)?([0-9A-F]+)h?")


def check_address_tables(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each row of a table with first and last addresses is a range: the first address is not the higher one.

    Both addresses must have the same number of digits. Rows with other text than hexadecimal numbers are skipped.
    """
    for table in spec.tables:
        address_columns: list[int] = []
        for index, heading in enumerate(table.part.columns):
            if heading.casefold() in ("first address", "last address"):
                address_columns.append(index)
        if len(address_columns) != 2:
            continue
        for row_index, row in enumerate(table.part.rows):
            cells = [row[column_index] for column_index in address_columns if column_index < len(row)]
            matches = [_HEX_CELL.fullmatch(cell) for cell in cells]
            digits_of_addresses = [match[1] for match in matches if match is not None]
            if len(digits_of_addresses) != 2:
                continue
            first_digits, last_digits = digits_of_addresses
            has_equal_length = len(first_digits) == len(last_digits)
            is_range = has_equal_length and int(first_digits, 16) <= int(last_digits, 16)
            if not is_range:
                path = (*table.path, "rows", row_index, address_columns[0])
                message = f"{cells[0]} to {cells[1]} is not a range of addresses; correct one of the two"
                report.add("table-shape", path, message)
