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

    ``where`` are words of headings, the outermost first, each with synonyms. ``near`` are names of other lines there,
    or name and value, which distinguish the section from similar sections. ``labels`` are the possible labels of the
    line. ``whole`` is true if the answer is the only text in its place.
    """

    family: str
    order_code: str
    kind: str
    where: tuple[tuple[str, ...], ...]
    labels: tuple[str, ...]
    answer: str
    near: tuple[tuple[str, str], ...] = ()
    whole: bool = False

    def __str__(self) -> str:
        place = " › ".join(heading[0] for heading in self.where) or "top"
        return f"{self.order_code}: {self.kind}: {place}: {self.labels[0]}: {self.answer}"


def _is_allowed(option: Raw, option_by_part: Mapping[str, str]) -> bool:
    """Return whether an option of an order code can be combined with the options of the other parts."""
    only_with = option.get("only_with", {})
    return all(option_by_part[part_name] in allowed_texts for part_name, allowed_texts in only_with.items())


@dataclass(frozen=True)
class Reading:
    """A second reading as text."""

    family: str
    facts: Raw

    @cached_property
    def codes(self) -> list[tuple[str, str, dict[str, str]]]:
        """Return each order code with its interface and its settings."""
        code_parts = self.facts["order_code"]["parts"]
        codes = []
        for option_texts in itertools.product(*(code_part["values"] for code_part in code_parts)):
            option_by_part = {}
            options = []
            for code_part, option_text in zip(code_parts, option_texts, strict=True):
                option_by_part[code_part["name"]] = option_text
                options.append(code_part["values"][option_text] or {})
            if all(_is_allowed(option, option_by_part) for option in options):
                settings: dict[str, str] = {}
                for option in options:
                    settings |= option.get("sets", {})
                interface = next(option["interface"] for option in options if "interface" in option)
                order_code = self.facts["order_code"]["pattern"].format(**option_by_part)
                codes.append((order_code, interface, settings))
        return codes

    def numbers(self, sets: Mapping[str, str]) -> dict[str, int]:
        """Return the quantities of an order code, with the defaults of quantities in registers."""
        quantities = _numbers(sets)
        for name, parameter in self.facts["parameters"].items():
            if "equals" in parameter:
                quantities[name] = evaluate(parameter["equals"], quantities)
            elif "read_from" in parameter:
                quantities[name] = self.default_of(parameter["read_from"])
        for sets in reversed(self.decisions.values()):
            quantities |= sets
        return quantities

    @property
    def decisions(self) -> dict[str, dict[str, int]]:
        """Return the settings of the answers to the last open question of the manual, by their names."""
        values = self.facts.get("alternatives", [{"values": {}}])[-1]["values"]
        return {name: _numbers(answer["sets"]) for name, answer in values.items()}

    def default_of(self, path: str) -> int:
        register_name, _, field_name = path.partition(".")
        register = next(raw for raw in self.facts["registers"] if raw["name"] == register_name)
        field = next(raw for raw in register["fields"] if raw["name"] == field_name)
        if "default" in field:
            return int(field["default"], 0)
        low = int(field["at"].rpartition(":")[2])
        return int(register["default"], 0) >> low


def readings() -> list[Reading]:
    return [_read(path) for path in sorted(SPECS.glob("*.second.yaml"))]


def _read(path: Path) -> Reading:
    facts = yaml.load(path.read_text(encoding="utf-8"), yaml.BaseLoader)
    return Reading(family=path.name.partition(".")[0], facts=facts)


def _numbers(texts: Mapping[str, str]) -> dict[str, int]:
    return {name: int(text, 0) for name, text in texts.items()}


def evaluate(text: str, quantities: Numbers) -> int:
    """Return the value of a sum, difference, product or power of numbers and quantities."""
    return _evaluate(ast.parse(text.replace("^", "**"), mode="eval").body, quantities)


def _evaluate(node: ast.expr, quantities: Numbers) -> int:
    if isinstance(node, ast.BinOp):
        first, second = _evaluate(node.left, quantities), _evaluate(node.right, quantities)
        signs = {ast.Add: first.__add__, ast.Sub: first.__sub__, ast.Mult: first.__mul__, ast.Pow: first.__pow__}
        return int(signs[type(node.op)](second))
    return quantities[node.id] if isinstance(node, ast.Name) else int(ast.unparse(node), 0)


def questions(only: str = "") -> list[Question]:
    """Return all questions, each for one order code in turn, or all that apply to ``only`` this one."""
    all_questions = []
    for reading in readings():
        turn = itertools.count()
        for template in _templates(reading):
            codes = [code for code in reading.codes if template.is_about(*code[:2]) and only in ("", code[0])]
            if codes:
                code, _, sets = codes[next(turn) % len(codes)]
                all_questions.append(template.question_for(reading.family, code, reading.numbers(sets)))
    return [question for question in all_questions if question.answer]


def applies_to(only: str, order_code: str) -> bool:
    """Return True if an order code matches an abbreviation such as .../65K..., or if there is none."""
    patterns = only.replace("...", "*").replace("x", "?").split(", ")
    return not only or any(fnmatchcase(f"{order_code}-", pattern) for pattern in patterns)


@dataclass(frozen=True)
class QuestionTemplate:
    """A question about any order code with this interface."""

    interface: str
    kind: str
    where: tuple[tuple[str, ...], ...]
    labels: tuple[str, ...]
    answer: str | Callable[[Numbers], str]
    near: tuple[tuple[str, str], ...] = ()
    only: str = ""
    #: The order codes of each item of ``near``, if not all have it.
    near_only: tuple[str, ...] = ()

    def is_about(self, order_code: str, interface: str) -> bool:
        """Return True if an order code with this interface has it."""
        return interface == self.interface and applies_to(self.only, order_code)

    def question_for(self, family: str, order_code: str, numbers: Numbers) -> Question:
        answer = self.answer if isinstance(self.answer, str) else self.answer(numbers)
        whole = self.kind in ("pin", "colour")
        codes = self.near_only or ("",) * len(self.near)
        near = tuple(line for line, only in zip(self.near, codes, strict=True) if applies_to(only, order_code))
        return Question(
            family=family,
            order_code=order_code,
            kind=self.kind,
            where=self.where,
            labels=self.labels,
            answer=answer,
            near=near,
            whole=whole,
        )


def _templates(reading: Reading) -> Iterator[QuestionTemplate]:
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


def _about_interface(name: str, interface: Raw) -> Iterator[QuestionTemplate]:
    if "clock" in interface:
        low, high = (frequency(int(interface["clock"][key])) for key in ("min_hz", "max_hz"))
        yield QuestionTemplate(name, "clock", (("Clock and cable",),), ("Clock",), f"{low} to {high}")
    for limit, metres in zip(interface.get("cable_lengths", []), (30, 80, 150, 300), strict=False):
        assert metres < int(limit["shorter_than_m"])
        label, answer = f"{limit['shorter_than_m']} m", frequency(int(limit["below_hz"]))
        yield QuestionTemplate(name, f"clock at {metres} m", (("Clock and cable",),), (label,), answer)
    for limit in interface.get("timings", []):
        labels = tuple(limit[key] for key in ("symbol", "name") if key in limit)
        yield QuestionTemplate(name, "wait", (("Times",),), labels, duration(limit))


def _about_frame(reading: Reading, interface: str, layouts: Sequence[Raw], layout: Raw) -> Iterator[QuestionTemplate]:
    """Ask about a frame. If there are several, it is the frame in this direction with the data ID that selects it."""
    direction = {"encoder": "Encoder → Master", "master": "Master → Encoder"}[layout["from"]]
    where: tuple[tuple[str, ...], ...] = (("Frames",),)
    if len(layouts) > 1:
        where += ((layout.get("printed_name", direction), direction),)
    data_ids = tuple((name, f"{int(values[0], 0):X}") for name, values in layout.get("when", {}).items())
    for field in layout["fields"]:
        if "name" in field:
            in_bytes = layout.get("carried_as", "bytes" if interface == "rs485" else "bits") == "bytes"
            answer = _in_bytes(layout, field) if in_bytes else _in_bits(reading, layout, field)
            yield QuestionTemplate(interface, "bit", where, _labels_of(field), answer, data_ids)


def _about_group(group: Raw) -> Iterator[QuestionTemplate]:
    where = (("Frames",), _labels_of(group))
    for field in group["fields"]:
        if "at" in field:
            yield QuestionTemplate("rs485", "bit", where, _labels_of(field), _place_of(field))


def _place_of(field: Raw) -> str:
    high, _, low = field["at"].partition(":")
    return place(int(high), int(low or high))


def _labels_of(described: Raw) -> tuple[str, ...]:
    """Return the possible labels of its line: the manual's name, ours, and ours in words."""
    names = (described["name"], described["name"].replace("_", " "), described.get("printed_name", ""))
    return tuple(dict.fromkeys(filter(None, names)))


def _in_bits(reading: Reading, layout: Raw, field: Raw) -> Callable[[Numbers], str]:
    """Return its place in a frame of bits, of which the last one sent is bit 0."""

    def at(numbers: Numbers) -> str:
        below = 0
        for lower_field in reversed(layout["fields"]):
            width = _width(reading, lower_field, numbers)
            if lower_field is field:
                return place(below + width - 1, below) if width else ""
            below += width
        raise AssertionError(field)

    def answer(numbers: Numbers) -> str:
        """Return the place. If the manual leaves it open, return each possible place with its answer."""
        places = {name: at({**numbers, **sets}) for name, sets in reading.decisions.items()}
        if len(set(places.values())) <= 1:
            return at(numbers)
        return " or ".join(f"{where or 'absent'} ({name})" for name, where in places.items())

    return answer


def _width(reading: Reading, field: Raw, numbers: Numbers) -> int:
    if "crc" in field:
        return next(int(crc["width"]) for crc in reading.facts["crcs"] if crc["name"] == field["crc"])
    return evaluate(field.get("bits", "1"), numbers)


def _in_bytes(layout: Raw, field: Raw) -> Callable[[Numbers], str]:
    """Return its place in a frame of bytes, in the order of the line, or nothing if the encoder lacks it."""

    def answer(numbers: Numbers) -> str:
        first = 0
        for earlier_field in layout["fields"]:
            size = (
                1
                if "crc" in earlier_field
                else int(earlier_field.get("padded_to", earlier_field.get("bits", "8"))) // 8
            )
            if earlier_field is field:
                is_sent = "crc" in earlier_field or evaluate(earlier_field["bits"], numbers) > 0
                where = f"byte {first}" if size == 1 else f"bytes {first} to {first + size - 1}"
                return where if is_sent else ""
            first += size
        raise AssertionError(field)

    return answer


def _about_crc(interface: str, crc: Raw) -> Iterator[QuestionTemplate]:
    width, poly = int(crc["width"]), int(crc["poly"], 0)
    lower_powers = [_power(bit) for bit in range(width - 1, -1, -1) if poly >> bit & 1]
    terms = [f"x^{width}", *lower_powers]
    reflections = ["yes" if crc[key] == "true" else "no" for key in ("refin", "refout")]
    answers = {
        "Polynomial": " + ".join(terms),
        "Start value": f"0x{int(crc['init'], 0):X}",
        "Final XOR": f"0x{int(crc['xorout'], 0):X}",
        "Input, output reflected": ", ".join(reflections),
    }
    for label, answer in answers.items():
        yield QuestionTemplate(interface, "CRC", (("CRC",),), (label,), answer, (("Width", f"{width} bits"),))


def _power(bit: int) -> str:
    return {0: "1", 1: "x"}.get(bit, f"x^{bit}")


def _about_register(register: Raw) -> Iterator[QuestionTemplate]:
    address, length = int(register["address"], 0), int(register["length"])
    first, last = f"{address:02X}h", f"{address + length - 1:02X}h"
    addresses = first if length == 1 else f"{first} to {last}"
    interface, where = register.get("interface", "biss"), (("Registers",), (addresses,))
    yield QuestionTemplate(interface, "address", (("Registers",),), _labels_of(register), addresses)
    if length > 1:
        order = register["byte_order"].replace("_", " ")
        yield QuestionTemplate(interface, "byte order", where, ("Byte order",), f"{order}, at {first}")
    if "default" in register:
        order = "little" if register.get("byte_order") == "low_byte_first" else "big"
        data = int(register["default"], 0).to_bytes(length, order).hex(" ").upper()
        yield QuestionTemplate(interface, "default", where, ("Default",), data)
    if "wait_at_least_ms" in register:
        yield QuestionTemplate(interface, "wait", where, ("Wait",), f"at least {register['wait_at_least_ms']} ms")
    fields = register.get("fields", [])
    if len(fields) > 1 or (fields and "at" in fields[0]):
        for field in fields:
            yield QuestionTemplate(interface, "bit", where, _labels_of(field), _in_register(register, field))


def _in_register(register: Raw, field: Raw) -> str | Callable[[Numbers], str]:
    if "at" in field:
        return _place_of(field)

    def answer(numbers: Numbers) -> str:
        if "top_bit" in field:
            high, width = int(field["top_bit"]), evaluate(field["bits"], numbers)
            return place(high, high - width + 1) if width else ""
        high = 8 * int(register["length"]) - 1
        for upper_field in register["fields"]:
            width = evaluate(upper_field["bits"], numbers)
            if upper_field is field:
                return place(high, high - width + 1)
            high -= width
        raise AssertionError(field)

    return answer


def _about_procedure(procedure: Raw) -> Iterator[QuestionTemplate]:
    where = (("Procedures",), (procedure["name"],))
    for number, step in enumerate(procedure["steps"], start=1):
        if step["do"] == "wait":
            yield QuestionTemplate(
                procedure["interface"], "wait", where, (f"{number}",), f"Wait at least {step['at_least_ms']} ms"
            )
        elif step["do"] == "send":
            answer = f"at least {step['every_at_least_us']} µs"
            yield QuestionTemplate(procedure["interface"], "wait", where, (f"{number}",), answer)


def _about_alarm(reading: Reading, alarm: Raw) -> Iterator[QuestionTemplate]:
    where = (("Errors and warnings",), _labels_of(alarm))
    interface = "rs485" if "group" in alarm else "biss"
    assert interface in reading.facts["interfaces"]
    only = alarm.get("only", "")
    for name in alarm.get("cleared_by", []):
        yield QuestionTemplate(interface, "remedy", where, ("Cleared by",), name, only=only)
    if "latch" in alarm:
        stays = alarm["latch"] == "true"
        label, answer = ("Stays", "active until it is reset") if stays else ("Clears", "itself when its cause is gone")
        yield QuestionTemplate(interface, "remedy", where, (label,), answer, only=only)
    if "below_mv" in alarm:
        yield QuestionTemplate(
            interface, "remedy", where, ("Raised",), f"below {int(alarm['below_mv']) / 1000:g} V", only=only
        )


def _about_connector(connector: Raw) -> Iterator[QuestionTemplate]:
    """Return the connector with these contacts, if the page has several."""
    kind = {"connector": "pin", "cable": "colour"}[connector["kind"]]
    contacts = tuple((contact["contact"], "") for contact in connector["contacts"])
    codes = tuple(contact.get("only", "") for contact in connector["contacts"])
    for contact in connector["contacts"]:
        interface = connector["interfaces"][-1]
        yield QuestionTemplate(
            interface,
            kind,
            where=(("Wiring",),),
            labels=(contact["contact"],),
            answer=contact["signal"],
            near=contacts,
            only=contact.get("only", ""),
            near_only=codes,
        )


def place(high: int, low: int) -> str:
    return f"bit {high}" if high == low else f"bits {high}:{low}"


def frequency(hertz: int) -> str:
    return f"{hertz // 1_000_000} MHz" if hertz % 1_000_000 == 0 else f"{hertz // 1000} kHz"


def duration(timing: Raw) -> str:
    for key, bound in (("typical_us", "typically"), ("at_least_us", "at least"), ("at_most_us", "at most")):
        if key in timing:
            us = int(timing[key])
            return f"{bound} {us // 1000} ms" if us % 1000 == 0 else f"{bound} {us} µs"
    raise AssertionError(timing)
