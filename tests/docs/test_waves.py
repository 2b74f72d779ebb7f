"""The timing diagrams have the times of the manual, and the text says the same."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from codewheel.loading.library import load_valid
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.docs.timing_pictures import diagram_picture, timing_diagram

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize(
    ("family", "interface", "times"),
    [
        # AM36 5.1 and 5.3; AMM5 5.3 and 7.4.2 p.45; SMA21 6.5 p.34.
        ("am36", "ssi", ["Tm, typically 12 µs", "Tp, at least 12 µs"]),
        ("amm5", "ssi", ["Tm, typically 12 µs", "Tp, at least 20 µs"]),
        ("amm5", "rs485", ["between repeated requests: at least 40 µs"]),
        ("sma21", "biss", ["timeout: varies with the clock, at most 16 µs"]),
    ],
)
def test_times_are_those_of_the_manual(pages: Mapping[str, str], family: str, interface: str, times: list[str]) -> None:
    root = ElementTree.fromstring(pages[f"docs/{family}/timing-{interface}.svg"])
    times_in_picture = [element.text for element in root.iter(f"{SVG}text")]
    assert [time for time in times if time not in times_in_picture] == []


def test_biss_is_in_the_order_of_the_protocol(pages: Mapping[str, str]) -> None:
    """Protocol description (BiSS C), p. 3: acknowledge, start, CDS, data, CRC, stop, timeout with CDM."""
    root = ElementTree.fromstring(pages["docs/amm5/timing-biss.svg"])
    places = {element.text: float(element.get("x", "")) for element in root.iter(f"{SVG}text")}
    order = ["Ack", "Start", "CDS", "position", "error", "warning", "CRC", "stop"]
    assert sorted(order, key=places.__getitem__) == order
    assert places["not CDM"] == places["stop"]


def test_nothing_sticks_out(pages: Mapping[str, str]) -> None:
    for name, picture in pages.items():
        if "/timing-" in name:
            root = ElementTree.fromstring(picture)
            right_edge = float(root.get("width", ""))
            for box in root.iter(f"{SVG}rect"):
                assert float(box.get("x", "")) + float(box.get("width", "")) <= right_edge


def test_a_clock_pulse_is_as_wide_as_any_other(pages: Mapping[str, str]) -> None:
    """A pulse is low for half of its period everywhere."""
    for family, interface in (("amm5", "ssi"), ("amm5", "biss"), ("sma21", "biss")):
        root = ElementTree.fromstring(pages[f"docs/{family}/timing-{interface}.svg"])
        clock = next(element.get("d", "") for element in root.iter(f"{SVG}path") if element.get("class") == "wave")
        edges = re.findall(r"L([\d.]+) [\d.]+H([\d.]+)V", clock)
        assert edges
        assert {round(float(up) - float(down), 2) for down, up in edges} <= {11.9, 12.0, 12.1}


def family(name: str) -> Device:
    return next(device for device in load_valid()[0] if device.name == name)


def test_requests_that_are_repeated_are_those_of_a_procedure(pages: Mapping[str, str]) -> None:
    """AMM5 7.4.2 p.45: ten requests, 40 µs apart. Without such procedures, there is no picture."""
    amm5 = family("amm5")
    assert "Repeated requests are at least 40 µs apart." in pages["docs/amm5/rs485.md"]
    assert "(rs485.md#timings)" in pages["docs/amm5/AMM5A17-1JP1.md"]
    diagram = timing_diagram(replace(amm5, procedures=()), amm5.interface("rs485"))
    assert diagram is not None
    assert "repeated" not in diagram.text + diagram_picture(diagram)


def test_the_shortest_request_is_said_to_be_the_shortest(pages: Mapping[str, str]) -> None:
    """AMM5 7.2 p.41: requests of 1, 3 and 4 bytes, replies up to 11. SMA21 7.2 p.37: each request is one byte."""
    amm5, sma21 = (pages[f"docs/{name}/timing-rs485.svg"] for name in ("amm5", "sma21"))
    assert "a request of at least 1 byte. The encoder answers with up to 11 bytes" in amm5
    assert "a request of 1 byte. The encoder" in sma21


def test_it_says_what_it_is_drawn_from(pages: Mapping[str, str]) -> None:
    """The figures of the manuals are lost, and for BiSS the text does not say where acknowledge and start bit are."""
    biss, ssi = pages["docs/amm5/biss.md"], pages["docs/amm5/ssi.md"]
    start = "This diagram is drawn from the text of the manual"
    assert f"{start} and the public protocol description of BiSS C-mode. It is not to scale." in biss
    assert f"{start}. It is not to scale." in ssi


def test_the_words_have_each_field_and_time(library: Library) -> None:
    for device in library.devices:
        for interface in device.interfaces:
            diagram = timing_diagram(device, interface)
            assert diagram is not None
            assert [span.label for span in diagram.spans if span.label.rpartition(": ")[2] not in diagram.text] == []
