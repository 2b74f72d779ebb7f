"""Build those parts of the model that are never used in computations and differ from the spec."""

from __future__ import annotations

from ..model import Manufacturer, Sources, Supply, Table
from .from_mapping import Raw, record, sources


def build_manufacturer(raw: Raw) -> Manufacturer:
    """Return the manufacturer described by a checked manufacturer file."""
    name = raw["manufacturer"]
    return record(Manufacturer, {"python_package": f"{name}_encoders", "version": "0.0.0", **raw, "name": name})


def supply(raw: Raw, inherited: Sources = ()) -> Supply | None:
    """Return the supply of a device or of a value of its order code."""
    definition = raw.get("supply")
    return (
        None
        if definition is None
        else record(Supply, definition, source=sources(definition) or sources(raw) or inherited)
    )


def table(raw: Raw) -> Table:
    return record(Table, raw, rows=tuple(tuple(map(str, row)) for row in raw["rows"]))
