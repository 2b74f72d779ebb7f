"""From checked data to those parts of the model that nothing is computed with: the manual, times, connections, alarms, examples, errata."""

from __future__ import annotations

import re
from types import MappingProxyType

from .fields import Raw
from .model import (
    Alarm, Connector, Contact, Edition, Erratum, Example, Input, Manual, Manufacturer, Revision, Source, Sources, Supply, Table, Timing, Write,
)

_SOURCE = re.compile(r"\s*(?:(?P<document>[a-z][a-z0-9_]*):\s*)?(?P<section>.*?)(?:\s*\bp\.(?P<page>[0-9]+))?\s*$")


def parse_sources(text: str) -> Sources:
    """``6.4 p.35; it: 6.4 p.36`` as sources; a page range such as ``p.14-15`` stays part of the section."""
    found = []
    for piece in text.split(";"):
        match = _SOURCE.fullmatch(piece)
        if match is not None:
            page = int(match["page"]) if match["page"] else None
            found.append(Source(match["document"] or "", match["section"], page))
    return tuple(found)


def sources(raw: Raw, key: str = "source") -> Sources:
    return parse_sources(raw[key]) if key in raw else ()


def build_manufacturer(raw: Raw) -> Manufacturer:
    """The manufacturer that a checked manufacturer file describes."""
    return Manufacturer(
        name=raw["manufacturer"],
        title=raw["title"],
        biss_id=raw.get("biss_id"),
        python_package=raw.get("python_package", f"{raw['manufacturer']}_encoders"),
        version=raw.get("version", "0.0.0"),
        trademarks=tuple(raw.get("trademarks", ())),
    )


def manual(raw: Raw) -> Manual:
    return Manual(
        title=raw["title"],
        revision=raw["revision"],
        date=raw.get("date", ""),
        language=raw["language"],
        publisher=raw.get("publisher", ""),
        editions=tuple(Edition(item["language"], item.get("title", ""), item["revision"], item.get("date", "")) for item in raw.get("editions", ())),
        history=tuple(
            Revision(item["revision"], item.get("date", ""), item["changes"], item.get("hardware", ""), item.get("software", "")) for item in raw.get("history", ())
        ),
    )


def timing(raw: Raw) -> Timing:
    bounds = {key: raw.get(key) for key in ("at_least_us", "typical_us", "at_most_us")}
    return Timing(raw["name"], raw.get("symbol", ""), raw["meaning"], source=sources(raw), **bounds)


def supply(raw: Raw, inherited: Sources = ()) -> Supply | None:
    """The supply of a device or of a value of its order code."""
    found = raw.get("supply")
    return None if found is None else Supply(found["min_mv"], found["max_mv"], sources(found) or sources(raw) or inherited)


def hardware_input(raw: Raw) -> Input:
    return Input(
        name=raw["name"], printed_name=raw.get("printed_name", ""), names=raw.get("names", {}), meaning=raw["meaning"], low=raw.get("low", ""),
        high=raw.get("high", ""), pulse_at_least_us=raw.get("pulse_at_least_us"), inverts=raw.get("inverts", ""), needs=raw.get("needs", ""),
        when_unused=raw.get("when_unused", ""), note=raw.get("note", ""), source=sources(raw),
    )


def table(raw: Raw) -> Table:
    return Table(raw["name"], raw["title"], tuple(raw["columns"]), tuple(tuple(map(str, row)) for row in raw["rows"]), raw.get("note", ""), sources(raw))


def alarm(raw: Raw) -> Alarm:
    return Alarm(
        name=raw["name"], printed_name=raw.get("printed_name", ""), names=raw.get("names", {}), group=raw.get("group", ""),
        register=raw.get("register", ""), field=raw.get("field", ""), meaning=raw["meaning"], detected=raw.get("detected", ""), below_mv=raw.get("below_mv"),
        latch=raw.get("latch"), implemented=raw.get("implemented", True), remedy=raw.get("remedy", ""),
        cleared_by=tuple(raw.get("cleared_by", ())), source=sources(raw),
    )


def connector(raw: Raw) -> Connector:
    contacts = tuple(Contact(item["contact"], item["signal"], item.get("only", "")) for item in raw["contacts"])
    return Connector(raw["name"], raw["kind"], raw["title"], tuple(raw.get("interfaces", ())), raw.get("mating", ""), contacts, raw.get("note", ""), sources(raw))


def example(raw: Raw) -> Example:
    return Example(
        name=raw["name"], kind=raw["kind"], order_code=raw.get("order_code", ""), layout=raw.get("layout", ""), register=raw.get("register", ""),
        procedure=raw.get("procedure", ""), crc=raw.get("crc", ""), sender=raw.get("from", "encoder"), bytes=bytes.fromhex(raw.get("bytes", "")),
        bits=raw.get("bits", ""), check=raw.get("check"), arguments=MappingProxyType(dict(raw.get("arguments", {}))), values=MappingProxyType(dict(raw.get("values", {}))),
        writes=tuple(Write(item["address"], item["value"]) for item in raw.get("writes", ())), refused=raw.get("refused", ""),
        erratum=raw.get("erratum", ""), note=raw.get("note", ""), source=sources(raw), counts=raw.get("counts"), micrometres=raw.get("micrometres"),
    )


def erratum(raw: Raw) -> Erratum:
    return Erratum(raw["name"], raw["printed"], raw["used"], raw["why"], raw["status"], raw["severity"], tuple(raw.get("affects", ())), sources(raw))
