"""CRCs in Python, including CRCs of no frame, computed over bytes or bits as the plan says, as in C."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.plan.crcs import CoveredData, crc_functions
from codewheel.reference.bits_and_values import compute_bits, compute_bytes
from codewheel.targets import Library

SPEC = Path(__file__).parents[1] / "c" / "specs"
#: Check values of Greg Cook's catalogue of parametrised CRC algorithms, over the digits 1 to 9.
CATALOGUE = {
    "kermit": 0x2189,
    "iso_hdlc": 0xCBF43926,
    "usb": 0x19,
    "g_704": 0x06,
    "ble": 0xC25A56,
    "autosar": 0xDF,
    "ibm_3740": 0x29B1,
    "gsm_40": 0xD4164FC646,
}


@pytest.fixture(scope="module")
def crcs(import_generated: Callable[..., Any]) -> tuple[Device, Any]:
    devices, report = load_library([SPEC / "crcs.yaml", SPEC / "manufacturer.yaml"])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    return devices[0], import_generated(Library(devices), "test_encoders")[1].crcs


@pytest.mark.slow
@pytest.mark.parametrize("name", CATALOGUE)
def test_check_values_of_the_catalogue(crcs: tuple[Device, Any], name: str) -> None:
    assert getattr(crcs[1], f"crc_{name}")(b"123456789") == CATALOGUE[name]


def test_each_is_the_one_of_the_model(crcs: tuple[Device, Any]) -> None:
    device, module = crcs
    used = {crc.name for _, layout in device.layouts() for crc in device.crcs_of(layout)}
    assert {crc.name for crc in device.crcs} - used >= {"usb", "g_704"}
    for function_plan in crc_functions(device):
        function = getattr(module, f"crc_{function_plan.crc.name}")
        if function_plan.covered_data is CoveredData.BYTES:
            assert function(b"\x12\x34\x56") == compute_bytes(function_plan.crc, b"\x12\x34\x56"), (
                function_plan.crc.name
            )
        else:
            assert function(0x12345, 17) == compute_bits(function_plan.crc, 0x12345, 17), function_plan.crc.name
