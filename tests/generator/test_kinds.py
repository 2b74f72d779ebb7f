"""The kinds of fields: a spec has each of them, and the reference codec knows both senses of a parity bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device, Fault, Kind, Layout, Parity
from codewheel.reference import codec

#: Control fields of requests by data ID, as the manual of AMM5 prints them (7.3.1 p.42). Bit 7 is the even parity of
#: the data ID.
PRINTED = {0x0: 0x02, 0x1: 0x8A, 0x2: 0x92, 0x3: 0x1A, 0x7: 0xBA, 0x8: 0xC2, 0xC: 0x62}


def test_each_kind_is_built_by_a_spec(devices: Mapping[str, Device]) -> None:
    """No other test would cover a kind that is in no spec."""
    fictional, report = load_library([Path(__file__).parents[1] / "specs"])
    assert not report
    layouts: list[Layout] = []
    for device in (*devices.values(), *fictional):
        layouts += [layout for _, layout in device.layouts()]
        layouts += [register.layout for register in device.registers]
    assert {type(field.kind) for layout in layouts for field in layout.fields} == set(get_args(Kind))


def with_odd_parity(layout: Layout) -> Layout:
    fields = []
    for field in layout.fields:
        if isinstance(field.kind, Parity):
            fields.append(replace(field, kind=replace(field.kind, odd=True)))
        else:
            fields.append(field)
    return replace(layout, fields=tuple(fields))


@pytest.mark.parametrize("is_odd", [False, True])
def test_parity_has_a_sense(devices: Mapping[str, Device], is_odd: bool) -> None:
    device = devices["amm5"]
    layout = next(layout for _, layout in device.layouts() if layout.name == "data_request")
    tested_layout = with_odd_parity(layout) if is_odd else layout
    placed = tested_layout.place(device.variants[0].parameters)
    for data_id, even in PRINTED.items():
        valid, invalid = (even ^ 0x80, even) if is_odd else (even, even ^ 0x80)
        assert codec.encode(device, placed, {"data_id": data_id}) == valid
        assert not codec.decode(device, placed, valid).problems
        assert [problem.fault for problem in codec.decode(device, placed, invalid).problems] == [Fault.CONSTANT]
