"""Questions that the second readings of the manuals answer, as a reader of the pages would ask them.

A question belongs to one order code, and has the section where its reader looks, the label of the line, and the
expected answer. The specs from which the pages are generated are not read.
"""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

SPECS = Path(__file__).parents[2] / "specs" / "lika"
Raw = Mapping[str, Any]
#: Ingredients of an answer that depends on the order code.
Numbers = Mapping[str, int]


@dataclass(frozen=True)
class Question:
    """A question, with its place on the page.

    ``where`` are words of headings, the outermost first, each with synonyms. ``known`` are names of other lines there,
    or name and value, which distinguish the section from similar ones. ``labels`` are the possible labels of the line.
    ``whole`` is true if the answer is the only text in its place.
    """

    family: str
    order_code: str
    kind: str
    where: tuple[tuple[str, ...], ...]
    labels: tuple[str, ...]
    answer: str
    known: tuple[tuple[str, str], ...] = ()
    whole: bool = False

    def __str__(self) -> str:
        place = " › ".join(item[0] for item in self.where) or "top"
        return f"{self.order_code}: {self.kind}: {place}: {self.labels[0]}: {self.answer}"


@dataclass(frozen=True)
class Reading:
    """A second reading as text."""

    family: str
    facts: Raw

    @cached_property
    def codes(self) -> list[tuple[str, str, dict[str, str]]]:
        """Return each order code with its interface and its settings."""
        parts = self.facts["order_code"]["parts"]
        found = []
        for texts in itertools.product(*(part["values"] for part in parts)):
            chosen = {part["name"]: text for part, text in zip(parts, texts, strict=True)}
            values = [part["values"][text] or {} for part, text in zip(parts, texts, strict=True)]
            allowed = (only for value in values for only in value.get("only_with", {}).items())
            if all(chosen[name] in listed for name, listed in allowed):
                sets = {key: number for value in values for key, number in value.get("sets", {}).items()}
                interface = next(value["interface"] for value in values if "interface" in value)
                found.append((self.facts["order_code"]["pattern"].format(**chosen), interface, sets))
        return found

    def numbers(self, sets: Mapping[str, str]) -> dict[str, int]:
        """Return the quantities of an order code, with the defaults of those in registers."""
        known = {name: int(text, 0) for name, text in sets.items()}
        for name, item in self.facts["parameters"].items():
            if "equals" in item:
                known[name] = worked_out(item["equals"], known)
            elif "read_from" in item:
                known[name] = self.delivered(item["read_from"])
        for sets in reversed(self.decisions.values()):
            known |= sets
        return known

    @property
    def decisions(self) -> dict[str, dict[str, int]]:
        """Return the settings of the answers to the last open question of the manual, by their names."""
        values = self.facts.get("alternatives", [{"values": {}}])[-1]["values"]
        return {name: {key: int(text, 0) for key, text in item["sets"].items()} for name, item in values.items()}

    def delivered(self, path: str) -> int:
        register, _, name = path.partition(".")
        held = next(item for item in self.facts["registers"] if item["name"] == register)
        field = next(item for item in held["fields"] if item["name"] == name)
        if "default" in field:
            return int(field["default"], 0)
        low = int(field["at"].rpartition(":")[2])
        return int(held["default"], 0) >> low


def readings() -> list[Reading]:
    return [
        Reading(path.name.partition(".")[0], yaml.load(path.read_text(encoding="utf-8"), yaml.BaseLoader))
        for path in sorted(SPECS.glob("*.second.yaml"))
    ]


def worked_out(text: str, known: Numbers) -> int:
    """Return the value of a sum, difference, product or power of numbers and quantities."""
    return _value(ast.parse(text.replace("^", "**"), mode="eval").body, known)


def _value(node: ast.expr, known: Numbers) -> int:
    if isinstance(node, ast.BinOp):
        left, right = _value(node.left, known), _value(node.right, known)
        signs = {ast.Add: left.__add__, ast.Sub: left.__sub__, ast.Mult: left.__mul__, ast.Pow: left.__pow__}
        return int(signs[type(node.op)](right))
    return known[node.id] if isinstance(node, ast.Name) else int(ast.unparse(node), 0)


def questions(only: str = "") -> list[Question]:
    """Return all questions, each for one order code in turn, or all that apply to ``only`` this one."""
    found = []
    for reading in readings():
        turn = itertools.count()
        for item in _asked(reading):
            codes = [
                code
                for code in reading.codes
                if code[1] == item.interface and only in ("", code[0]) and item.is_of(code[0])
            ]
            if codes:
                code, _, sets = codes[next(turn) % len(codes)]
                found.append(item.of(reading.family, code, reading.numbers(sets)))
    return [item for item in found if item.answer]


def is_of(only: str, order_code: str) -> bool:
    """Return True if an order code matches an abbreviation such as .../65K..., or if there is none."""
    patterns = only.replace("...", "*").replace("x", "?").split(", ")
    return not only or any(fnmatchcase(f"{order_code}-", item) for item in patterns)


@dataclass(frozen=True)
class Asked:
    """A question about any order code with this interface."""

    interface: str
    kind: str
    where: tuple[tuple[str, ...], ...]
    labels: tuple[str, ...]
    answer: str | Callable[[Numbers], str]
    known: tuple[tuple[str, str], ...] = ()
    only: str = ""
    #: The order codes of each item of ``known``, if not all have it.
    known_only: tuple[str, ...] = ()

    def is_of(self, order_code: str) -> bool:
        """Return True if an order code has it."""
        return is_of(self.only, order_code)

    def of(self, family: str, order_code: str, numbers: Numbers) -> Question:
        answer = self.answer if isinstance(self.answer, str) else self.answer(numbers)
        whole = self.kind in ("pin", "colour")
        codes = self.known_only or ("",) * len(self.known)
        known = tuple(item for item, only in zip(self.known, codes, strict=True) if is_of(only, order_code))
        return Question(family, order_code, self.kind, self.where, self.labels, answer, known, whole)


def _asked(reading: Reading) -> Iterator[Asked]:
    for name, interface in reading.facts["interfaces"].items():
        yield from _about_interface(name, interface)
        for layout in interface.get("layouts", []):
            yield from _about_frame(reading, name, interface["layouts"], layout)
        for crc in reading.facts["crcs"]:
            if f"'crc': '{crc['name']}'" in f"{interface}":
                yield from _about_crc(name, crc)
    for group in reading.facts.get("field_groups", []):
        yield from _about_group(group)
    for register in reading.facts["registers"]:
        yield from _about_register(register)
    for procedure in reading.facts["procedures"]:
        yield from _about_procedure(procedure)
    for alarm in reading.facts.get("alarms", []):
        yield from _about_alarm(reading, alarm)
    for connector in reading.facts["connectors"]:
        yield from _about_connector(connector)


def _about_interface(name: str, interface: Raw) -> Iterator[Asked]:
    if "clock" in interface:
        low, high = (frequency(int(interface["clock"][key])) for key in ("min_hz", "max_hz"))
        yield Asked(name, "clock", (("Clock and cable",),), ("Clock",), f"{low} to {high}")
    for item, metres in zip(interface.get("cable_lengths", []), (30, 80, 150, 300), strict=False):
        assert metres < int(item["shorter_than_m"])
        label, answer = f"{item['shorter_than_m']} m", frequency(int(item["below_hz"]))
        yield Asked(name, f"clock at {metres} m", (("Clock and cable",),), (label,), answer)
    for item in interface.get("timings", []):
        labels = tuple(item[key] for key in ("symbol", "name") if key in item)
        yield Asked(name, "wait", (("Times",),), labels, duration(item))


def _about_frame(reading: Reading, interface: str, layouts: Sequence[Raw], layout: Raw) -> Iterator[Asked]:
    """Ask about a frame. If there are several, it is the one in this direction with the data ID that selects it."""
    way = {"encoder": "Encoder → Master", "master": "Master → Encoder"}[layout["from"]]
    where = (("Frames",),) if len(layouts) == 1 else (("Frames",), (layout.get("printed_name", way), way))
    known = tuple((name, f"{int(values[0], 0):X}") for name, values in layout.get("when", {}).items())
    for field in layout["fields"]:
        if "name" in field:
            in_bytes = layout.get("carried_as", "bytes" if interface == "rs485" else "bits") == "bytes"
            answer = _in_bytes(layout, field) if in_bytes else _in_bits(reading, layout, field)
            yield Asked(interface, "bit", where, _labels(field), answer, known)


def _about_group(group: Raw) -> Iterator[Asked]:
    where = (("Frames",), _labels(group))
    for field in group["fields"]:
        if "at" in field:
            yield Asked("rs485", "bit", where, _labels(field), _at(field))


def _at(field: Raw) -> str:
    high, _, low = field["at"].partition(":")
    return place(int(high), int(low or high))


def _labels(item: Raw) -> tuple[str, ...]:
    """Return the possible labels of its line: the manual's name, ours, and ours in words."""
    names = (item["name"], item["name"].replace("_", " "), item.get("printed_name", ""))
    return tuple(dict.fromkeys(filter(None, names)))


def _in_bits(reading: Reading, layout: Raw, field: Raw) -> Callable[[Numbers], str]:
    """Return its place in a frame of bits, of which the last one sent is bit 0."""

    def at(known: Numbers) -> str:
        below = 0
        for item in reversed(layout["fields"]):
            width = _width(reading, item, known)
            if item is field:
                return place(below + width - 1, below) if width else ""
            below += width
        raise AssertionError(field)

    def answer(known: Numbers) -> str:
        """Return the place. If the manual leaves it open, return each possible place with its answer."""
        places = {name: at({**known, **sets}) for name, sets in reading.decisions.items()}
        several = len(set(places.values())) > 1
        return " or ".join(f"{where or 'absent'} ({name})" for name, where in places.items()) if several else at(known)

    return answer


def _width(reading: Reading, field: Raw, known: Numbers) -> int:
    if "crc" in field:
        return next(int(item["width"]) for item in reading.facts["crcs"] if item["name"] == field["crc"])
    return worked_out(field.get("bits", "1"), known)


def _in_bytes(layout: Raw, field: Raw) -> Callable[[Numbers], str]:
    """Return its place in a frame of bytes, in the order of the line, or nothing if the encoder lacks it."""

    def answer(known: Numbers) -> str:
        first = 0
        for item in layout["fields"]:
            size = 1 if "crc" in item else int(item.get("padded_to", item.get("bits", "8"))) // 8
            if item is field:
                is_sent = "crc" in item or worked_out(item["bits"], known) > 0
                where = f"byte {first}" if size == 1 else f"bytes {first} to {first + size - 1}"
                return where if is_sent else ""
            first += size
        raise AssertionError(field)

    return answer


def _about_crc(interface: str, crc: Raw) -> Iterator[Asked]:
    width, poly = int(crc["width"]), int(crc["poly"], 0)
    terms = [f"x^{width}", *(_power(bit) for bit in range(width - 1, -1, -1) if poly >> bit & 1)]
    answers = {
        "Polynomial": " + ".join(terms),
        "Start value": f"0x{int(crc['init'], 0):X}",
        "Final XOR": f"0x{int(crc['xorout'], 0):X}",
        "Input, output reflected": ", ".join("yes" if crc[key] == "true" else "no" for key in ("refin", "refout")),
    }
    for label, answer in answers.items():
        yield Asked(interface, "CRC", (("CRC",),), (label,), answer, (("Width", f"{width} bits"),))


def _power(bit: int) -> str:
    return {0: "1", 1: "x"}.get(bit, f"x^{bit}")


def _about_register(register: Raw) -> Iterator[Asked]:
    address, length = int(register["address"], 0), int(register["length"])
    first, last = f"{address:02X}h", f"{address + length - 1:02X}h"
    shown = first if length == 1 else f"{first} to {last}"
    interface, where = register.get("interface", "biss"), (("Registers",), (shown,))
    yield Asked(interface, "address", (("Registers",),), _labels(register), shown)
    if length > 1:
        order = register["byte_order"].replace("_", " ")
        yield Asked(interface, "byte order", where, ("Byte order",), f"{order}, at {first}")
    if "default" in register:
        order = "little" if register.get("byte_order") == "low_byte_first" else "big"
        data = int(register["default"], 0).to_bytes(length, order).hex(" ").upper()
        yield Asked(interface, "default", where, ("Default",), data)
    if "wait_at_least_ms" in register:
        yield Asked(interface, "wait", where, ("Wait",), f"at least {register['wait_at_least_ms']} ms")
    fields = register.get("fields", [])
    if len(fields) > 1 or (fields and "at" in fields[0]):
        for field in fields:
            yield Asked(interface, "bit", where, _labels(field), _in_register(register, field))


def _in_register(register: Raw, field: Raw) -> str | Callable[[Numbers], str]:
    if "at" in field:
        return _at(field)

    def answer(known: Numbers) -> str:
        if "top_bit" in field:
            high, width = int(field["top_bit"]), worked_out(field["bits"], known)
            return place(high, high - width + 1) if width else ""
        high = 8 * int(register["length"]) - 1
        for item in register["fields"]:
            width = worked_out(item["bits"], known)
            if item is field:
                return place(high, high - width + 1)
            high -= width
        raise AssertionError(field)

    return answer


def _about_procedure(procedure: Raw) -> Iterator[Asked]:
    where = (("Procedures",), (procedure["name"],))
    for number, step in enumerate(procedure["steps"], start=1):
        if step["do"] == "wait":
            yield Asked(
                procedure["interface"], "wait", where, (f"{number}",), f"Wait at least {step['at_least_ms']} ms"
            )
        elif step["do"] == "send":
            answer = f"at least {step['every_at_least_us']} µs"
            yield Asked(procedure["interface"], "wait", where, (f"{number}",), answer)


def _about_alarm(reading: Reading, alarm: Raw) -> Iterator[Asked]:
    where = (("Errors and warnings",), _labels(alarm))
    interface = "rs485" if "group" in alarm else "biss"
    assert interface in reading.facts["interfaces"]
    only = alarm.get("only", "")
    for name in alarm.get("cleared_by", []):
        yield Asked(interface, "remedy", where, ("Cleared by",), name, only=only)
    if "latch" in alarm:
        stays = alarm["latch"] == "true"
        label, answer = ("Stays", "active until it is reset") if stays else ("Clears", "itself when its cause is gone")
        yield Asked(interface, "remedy", where, (label,), answer, only=only)
    if "below_mv" in alarm:
        yield Asked(interface, "remedy", where, ("Raised",), f"below {int(alarm['below_mv']) / 1000:g} V", only=only)


def _about_connector(connector: Raw) -> Iterator[Asked]:
    """Return the connector with these contacts, if the page has several."""
    kind = {"connector": "pin", "cable": "colour"}[connector["kind"]]
    known = tuple((item["contact"], "") for item in connector["contacts"])
    codes = tuple(item.get("only", "") for item in connector["contacts"])
    for item in connector["contacts"]:
        interface = connector["interfaces"][-1]
        yield Asked(
            interface, kind, (("Wiring",),), (item["contact"],), item["signal"], known, item.get("only", ""), codes
        )


def place(high: int, low: int) -> str:
    return f"bit {high}" if high == low else f"bits {high}:{low}"


def frequency(hertz: int) -> str:
    return f"{hertz // 1_000_000} MHz" if hertz % 1_000_000 == 0 else f"{hertz // 1000} kHz"


def duration(item: Raw) -> str:
    for key, said in (("typical_us", "typically"), ("at_least_us", "at least"), ("at_most_us", "at most")):
        if key in item:
            us = int(item[key])
            return f"{said} {us // 1000} ms" if us % 1000 == 0 else f"{said} {us} µs"
    raise AssertionError(item)
