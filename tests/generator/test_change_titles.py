"""Changes of editions and overlays are titled by what they change, not by a number."""

from __future__ import annotations

import re

import pytest
from codewheel.loading.overlays import change_title
from codewheel.targets import Library


@pytest.mark.parametrize(
    ("places", "title"),
    [
        (["registers.serial_number"], "Before edition 1.7: serial number"),
        (["serial_number.at_least: 5: 6"], "Before edition 1.7: serial number at least"),
        (["interfaces.ssi", "interfaces.rs485"], "Before edition 1.7: SSI and RS-485"),
        (["leds.led_1", "leds.led_2", "supply", "inputs"], "Before edition 1.7: LED 1, LED 2 and others"),
        (["order_code.parts.mount.values.B"], "Before edition 1.7: order code (mount)"),
        (["order_code.also_written.output"], "Before edition 1.7: order code (other spellings)"),
        (["examples.crc[2]"], "Before edition 1.7: example CRC"),
        (["registers.configuration.note"], "Before edition 1.7: note on configuration"),
        (["connectors.biss_plug.interfaces"], "Before edition 1.7: BiSS plug interfaces"),
        (["connectors.plug.contacts.1"], "Before edition 1.7: contact 1 of the plug"),
        (["field_groups.alarms.fields.busy.meaning"], "Before edition 1.7: meaning of busy"),
        (["Register 3Bh, Counting direction"], "Before edition 1.7: Register 3Bh, Counting direction"),
    ],
)
def test_a_title_names_what_changes(places: list[str], title: str) -> None:
    assert change_title("Before edition 1.7", places) == title


def test_no_erratum_is_titled_by_a_number_or_an_identifier(every_encoder: Library) -> None:
    for device in every_encoder.devices:
        titles = [erratum.title for erratum in device.errata]
        assert [title for title in titles if re.search(r"difference \d|change \d|[a-z]_[a-z]", title)] == [], (
            device.name
        )
        assert sorted(set(titles)) == sorted(titles), device.name
