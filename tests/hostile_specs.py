"""Parts of specs for tests in which every word of a list becomes a name."""

from __future__ import annotations

from typing import Any

Item = dict[str, Any]

HEAD: Item = {
    "codewheel": 1,
    "device": "hostile",
    "manufacturer": "test",
    "title": "Hostile names",
    "movement": "rotary",
    "evidence": {"grade": "manual", "documents": {"manual": "all pages"}},
    "manual": {"title": "Made up", "revision": "1", "language": "en"},
}
BISS_CLOCK: Item = {"min_hz": 80000, "max_hz": 10000000, "source": "1"}


def crc(name: str, width: int, poly: int, xorout: int) -> Item:
    crc = {"name": name, "width": width, "poly": poly, "init": 0, "refin": False, "refout": False, "xorout": xorout}
    return {**crc, "note": "Some frames of a test end in it.", "source": "1"}


def layout_of(name: str, *fields: Item, **more: Any) -> Item:
    return {"name": name, "note": "Made up", "from": "encoder", "source": "1", "fields": list(fields), **more}


def digits(name: str, high: str, low: str) -> Item:
    """Return a number of four decimal digits in 14 bits, with the names of its two halves."""
    return {"name": name, "bits": 14, "digits": [{"name": high, "digits": 2}, {"name": low, "digits": 2}]}


def flag(name: str, active: str) -> Item:
    return {"name": name, "active": active, "makes_position": "usable", "note": "Made up"}


def sums(names: list[str], used_names: list[str]) -> Item:
    """Return parameters of these names, each a sum of others, so that something depends on each of the others."""
    parameters: Item = {}
    for index, name in enumerate(names):
        summands = used_names[index :: len(names)] or used_names[:1]
        parameters[name] = {"meaning": "A word", "equals": " + ".join(summands), "source": "1"}
    return parameters
