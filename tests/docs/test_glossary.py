"""The glossary: terms link only to the interfaces that use them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
from codewheel.targets import Library
from codewheel.targets.docs.cross_family_pages import GLOSSARY, glossary_values
from codewheel.targets.docs.files import TEMPLATES


@pytest.mark.parametrize(
    ("term", "places"),
    [
        # AMM5 7.4 p.43 and 7.5 p.46; 5.1 and 5.3 of the manuals with SSI; SMA21 6.4: one register is preset or offset.
        ("ALMC", ["amm5/rs485-fields.md#group-alarm_field"]),
        ("MEM BUSY", ["amm5/rs485-fields.md#group-address_of_request"]),
        ("Tm, monoflop time", ["am36/ssi.md#timings", "amm5/ssi.md#timings"]),
        ("Tp, pause", ["asc85/ssi.md#timings", "sma21/ssi.md#timings"]),
        ("Preset", ["amm5/biss-registers.md#register-preset", "sma21/biss-registers.md#register-preset_offset"]),
        ("Offset", ["sma21/biss-registers.md#register-preset_offset"]),
        ("CDM", ["am36/biss.md#timings"]),
        ("Control data", ["amm5/biss.md#control-data"]),
    ],
)
def test_a_term_leads_to_where_it_matters(pages: Mapping[str, str], term: str, places: list[str]) -> None:
    (row,) = [line for line in pages["docs/glossary-of-terms.md"].splitlines() if line.startswith(f"| {term} |")]
    assert [place for place in places if f"({place})" not in row] == []


def test_a_term_leads_nowhere_else(pages: Mapping[str, str]) -> None:
    """AMM5 5.2 p.28: binary over SSI. No data ID of SMA21 accesses a memory (7.3.1 p.38)."""
    rows = {line.split(" | ")[0]: line for line in pages["docs/glossary-of-terms.md"].splitlines()}
    assert "amm5/" not in rows["| Gray code"]
    assert "(am36/ssi.md#frames)" in rows["| Gray code"]
    assert "sma21/" not in rows["| MEM BUSY"]


def test_terms_of_an_interface_that_nobody_has_are_left_out(library: Library) -> None:
    devices = [device for device in library.devices if len(device.interfaces) > 1]
    alone = [replace(device, interfaces=device.interfaces[:1]) for device in devices]
    assert {device.interfaces[0].name for device in alone} == {"ssi"}
    page = TEMPLATES.render(f"{GLOSSARY}.jinja", glossary_values(alone), None)
    names = {line.split(" | ")[0].removeprefix("| ") for line in page.splitlines()}
    assert names >= {"Tm, monoflop time", "Singleturn"}
    assert names.isdisjoint({"CDM", "ALMC", "MEM BUSY", "Preset"})
