"""``codewheel list``: a few facts about each family, as text at most 80 columns wide and as plain data."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypedDict

from ..say.lines import WIDTH, pairs, wrapped

if TYPE_CHECKING:
    from ..model import Device


class Manual(TypedDict):
    """The manual of a family."""

    title: str
    revision: str
    date: str | None


class Row(TypedDict):
    """Facts about a family. Each interface has a name and a title."""

    family: str
    title: str
    manufacturer: str
    interfaces: list[list[str]]
    pattern: str
    order_codes: list[str]
    manual: Manual


def rows(devices: Sequence[Device]) -> list[Row]:
    """Return the facts about each family, as data that JSON can express."""
    return [
        {
            "family": device.name,
            "title": device.title,
            "manufacturer": device.manufacturer.title,
            "interfaces": [[interface.name, interface.title] for interface in device.interfaces],
            "pattern": device.order_code.pattern,
            "order_codes": [variant.code for variant in device.variants],
            "manual": {
                "title": device.manual.title,
                "revision": device.manual.revision,
                "date": device.manual.date or None,
            },
        }
        for device in devices
    ]


def without_repeated(own_rows: Sequence[Row] = (), packaged: Sequence[Row] = ()) -> list[Row]:
    """Return the user's families and then the packaged ones, without those that the user's have too.

    Report these on standard error.
    """
    names = {row["family"] for row in own_rows}
    codes = {code for row in own_rows for code in row["order_codes"]}
    repeated = [row for row in packaged if row["family"] in names or not codes.isdisjoint(row["order_codes"])]
    if repeated:
        repeated_names = ", ".join(row["family"] for row in repeated)
        print(f"codewheel: in your specs and in the packaged ones: {repeated_names}; yours are used", file=sys.stderr)
    return [*own_rows, *(row for row in packaged if row not in repeated)]


def as_data(families: Sequence[Row]) -> dict[str, Any]:
    """Return the families in the form that ``--json`` prints."""
    rows = [{**family, "interfaces": [name for name, _ in family["interfaces"]]} for family in families]
    return {"version": 1, "families": rows}


def as_text(families: Sequence[Row]) -> str:
    """Return a few lines about each family."""
    lines = []
    for family in families:
        manual = family["manual"]
        date = f" of {manual['date']}" if manual["date"] else ""
        lines += [
            wrapped(f"{family['title']} ({family['manufacturer']})", WIDTH, " " * 10, f"{family['family']:<8}  "),
            *pairs(
                [
                    ("interfaces", ", ".join(title for _, title in family["interfaces"])),
                    ("order codes", f"{len(family['order_codes'])}, {family['pattern']}"),
                    ("manual", f"{manual['title']}, revision {manual['revision']}{date}"),
                ],
                10,
            ),
            "",
        ]
    return "\n".join(lines).rstrip()
