"""AM36 6.3.1: nE and nW are not used and always 1, so no bit says that a position is usable.

The erratum and the sentence about nW state the verdict that decoders give: unknown, not usable with a warning.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device, Verdict
from codewheel.plan.codec import layout_plan_of
from codewheel.plan.verdicts import verdict_rules_of
from codewheel.say.register import describe_field as said_of
from codewheel.say.text import PLAIN_STYLE

#: nE is 1 and nW is 0, after a position of zeros.
WARNING_BIT_AT_0 = 0b10


def crc_6(data: int, bits: int) -> int:
    """Return the remainder of x^6 + x + 1, inverted."""
    remainder = data << 6
    for place in range(bits - 1, -1, -1):
        if remainder >> (place + 6) & 1:
            remainder ^= 0b1000011 << place
    return remainder ^ 0b111111


def test_the_verdict_of_the_warning_bit(devices: Mapping[str, Device]) -> None:
    device = devices["am36"]
    layout = next(layout for layout in device.interface("biss").layouts if layout.name == "single_cycle_data")
    assert layout.field("error").kind.makes_position is Verdict.NOT_USABLE
    assert layout.field("warning").kind.makes_position is Verdict.UNKNOWN
    assert verdict_rules_of(layout_plan_of(device, layout)).default_verdict is Verdict.UNKNOWN
    sentences = " ".join(PLAIN_STYLE.sentence(statement) for statement in said_of(device, layout.field("warning")))
    assert "with the verdict unknown" in sentences
    assert "with a warning" not in sentences


def test_the_erratum_states_it(devices: Mapping[str, Device]) -> None:
    erratum = next(erratum for erratum in devices["am36"].errata if erratum.name == "error_and_warning_unused")
    assert "not usable if nE is 0" in erratum.used
    assert "verdict is unknown" in erratum.used
    assert "with a warning" not in erratum.used


def test_decode_agrees(capsys: pytest.CaptureFixture[str]) -> None:
    """36 bits of position, then nE and nW, then the CRC over these 38 bits."""
    frame = WARNING_BIT_AT_0 << 6 | crc_6(WARNING_BIT_AT_0, 38)
    main(["decode", "AM3619/4096-I7", f"0b{frame:044b}", "--json"])
    data = json.loads(capsys.readouterr().out)
    assert data["frames"][0]["verdict"] == "unknown" if "frames" in data else data["verdict"] == "unknown"
