"""Subjects that texts of a manual mention: they contradict a sentence that the manual does not say something.

Facts without a place of their own in the model are texts: times with a meaning, characteristics, tables, notes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from enum import Enum

from ..model import Device, Interface, Timing


class Subject(Enum):
    """A subject, with the words of manuals for it."""

    REPLY_TIME = (
        r"(?i)acknowledg|busy time|latency|turn-?around|(?:reply|response|answer(?:ing)?|processing)[ _-](?:time|delay)"
        r"|\b(?:time|delay|pause|duration)\b.{0,80}\b(?:repl(?:y|ies)|responds?|answers?|start bit)\b"
        r"|\b(?:replies|responds|answers)\b.{0,40}\b(?:within|after at (?:least|most))\b"
    )
    CABLE = r"(?i)\bcables?[ _-](?:length|up to|shorter|below)|length of the cable|(?:maximum|longest) cable"
    TIMEOUT = r"(?i)time-?out|monoflop"
    PAUSE = r"(?i)\bpause|between (?:two|the|consecutive) (?:words|frames|transmissions|clock)"
    SUPPLY = r"(?i)^supply\b(?! source)|(?:supply|operating) voltage|\bsuppl(?:y|ied)\b[^.]*\d ?V\b"
    LEDS = r"(?i)\bleds?\b|light-emitting|indicator light"


def mentions(device: Device, interface: Interface, subject: Subject) -> bool:
    """Return whether anything about the device or this interface may be about the subject."""
    search = re.compile(subject.value).search
    return any(map(search, _texts(device, interface)))


def _texts(device: Device, interface: Interface) -> Iterator[str]:
    yield interface.note
    for timing in (*interface.timings, *device.timings):
        yield _text_of(timing)
    for characteristic in device.characteristics:
        quantities = (quantity.quantity for quantity in characteristic.values)
        yield " ".join((characteristic.name.replace("_", " "), characteristic.value, *quantities))
    for table in device.tables:
        yield " ".join((table.title, *table.columns, *(row[0] for row in table.rows if row), table.note))
    for connector in device.connectors:
        yield connector.note


def _text_of(timing: Timing) -> str:
    return f"{timing.name.replace('_', ' ')}: {timing.symbol} {timing.meaning}"
