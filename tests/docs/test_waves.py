"""The pictures of what goes over the lines: their times are those of the manual, and words say the same."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree

import pytest
from codewheel.targets import Library
from codewheel.targets.docs.waves import wave

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize(
    ("family", "interface", "times"),
    [
        # AM36 5.1 and 5.3; AMM5 5.3 and 7.4.2 p.45; SMA21 6.5 p.34.
        ("am36", "ssi", ["Tm, typically 12 µs", "Tp, at least 12 µs"]),
        ("amm5", "ssi", ["Tm, typically 12 µs", "Tp, at least 20 µs"]),
        ("amm5", "rs485", ["between the requests of a reset: at least 40 µs"]),
        ("sma21", "biss", ["time-out: follows the clock, at most 16 µs"]),
    ],
)
def test_times_are_those_of_the_manual(pages: Mapping[str, str], family: str, interface: str, times: list[str]) -> None:
    root = ElementTree.fromstring(pages[f"docs/{family}/timing-{interface}.svg"])
    found = [item.text for item in root.iter(f"{SVG}text")]
    assert [item for item in times if item not in found] == []


def test_biss_is_in_the_order_of_the_protocol(pages: Mapping[str, str]) -> None:
    """Protocol description (BiSS C), p. 3: acknowledge, start, CDS, data, CRC, stop, time-out with CDM."""
    root = ElementTree.fromstring(pages["docs/amm5/timing-biss.svg"])
    places = {item.text: float(item.get("x", "")) for item in root.iter(f"{SVG}text")}
    order = ["Ack", "Start", "CDS", "position", "error", "warning", "CRC", "stop"]
    assert sorted(order, key=places.__getitem__) == order
    assert places["not CDM"] == places["stop"]


def test_nothing_sticks_out(pages: Mapping[str, str]) -> None:
    for name, picture in pages.items():
        if "/timing-" in name:
            root = ElementTree.fromstring(picture)
            right = float(root.get("width", ""))
            assert all(
                float(item.get("x", "")) + float(item.get("width", "")) <= right for item in root.iter(f"{SVG}rect")
            )


def test_the_words_have_each_field_and_time(library: Library) -> None:
    for device in library.devices:
        for interface in device.interfaces:
            shown = wave(device, interface)
            assert shown is not None
            assert [span.label for span in shown.spans if span.label.rpartition(": ")[2] not in shown.told] == []
