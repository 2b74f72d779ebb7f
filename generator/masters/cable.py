"""Clock for a cable length, from the table in the encoder's manual or, for BiSS, from a public one."""

from __future__ import annotations

from ..model import Biss, Device, Ssi, assert_never
from ..model.order_codes import facts_for_code
from ..model.record import dataclass
from ..say.text import hertz

#: iC-Haus, application note AN15, BiSS C master operation details, revision A3, table 1: clock on MA with RS-422.
_BISS_CLOCKS = (
    (10, 10_000_000),
    (25, 5_000_000),
    (60, 2_000_000),
    (100, 1_000_000),
    (200, 500_000),
    (500, 200_000),
    (1000, 100_000),
)
_ORIGIN_MANUAL, _ORIGIN_PUBLIC = "the encoder's manual", "AN15 of iC-Haus, revision A3, for RS-422"


@dataclass(frozen=True, slots=True)
class CableRow:
    """A row of a table. With ``is_below``, cable and clock must be below ``metres`` and ``hz``, else at most these."""

    metres: int
    hz: int
    is_below: bool

    @property
    def cable(self) -> str:
        return f"{'shorter than' if self.is_below else 'up to'} {self.metres} m"

    @property
    def text(self) -> str:
        return f"{self.cable}: {'below ' * self.is_below}{hertz(self.hz)}"

    @property
    def highest_hz(self) -> int:
        return self.hz - 1 if self.is_below else self.hz

    def includes(self, metres: int) -> bool:
        """Return whether the row is valid for this cable length."""
        return metres < self.metres or (metres == self.metres and not self.is_below)


@dataclass(frozen=True, slots=True)
class CableTable:
    """The rows, their origin in words, and the names of the errata about them."""

    rows: tuple[CableRow, ...]
    origin: str
    errata: tuple[str, ...]

    def row_of(self, metres: int) -> CableRow | None:
        """Return the row with the fastest clock for this cable length, or None if it exceeds the table."""
        return max((row for row in self.rows if row.includes(metres)), key=lambda row: row.hz, default=None)

    def about(self, clock_hz: int) -> str:
        """Return a sentence about the cables that allow a clock, or an empty string without a table."""
        if not self.rows:
            return ""
        fast_enough_rows = (row for row in self.rows if clock_hz <= row.highest_hz)
        longest = max(fast_enough_rows, key=lambda row: row.metres, default=None)
        if longest is None:
            fastest = max(self.rows, key=lambda row: row.hz)
            limit = f"{'below' if fastest.is_below else 'of at most'} {hertz(fastest.hz)}"
            reason = f"a cable {fastest.cable} needs a clock {limit}, and a longer one needs a lower clock"
            return f"According to the table in {self.origin}, no cable allows this clock: {reason}."
        return f"For a cable {longest.cable}, according to the table in {self.origin}."


def cable_table(device: Device, interface: Ssi | Biss, code: str = "") -> CableTable:
    """Return the table for an interface, without rows if there is none, and its errata about an order code or all."""
    match interface:
        case Ssi():
            path = f"interfaces.{interface.name}.cable_lengths"
            rows = [CableRow(row.shorter_than_m, row.below_hz, is_below=True) for row in interface.cable_lengths]
            errata = facts_for_code(device.errata, code) if code else device.errata
            errata_names = [erratum.name for erratum in errata if path in erratum.affects]
            return CableTable(tuple(rows), _ORIGIN_MANUAL, tuple(errata_names))
        case Biss():
            rows = [CableRow(metres, hz, is_below=False) for metres, hz in _BISS_CLOCKS]
            return CableTable(tuple(rows), _ORIGIN_PUBLIC, ())
        case _:
            assert_never(interface)
