"""Facts about order codes: the existing ones and their properties."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..language.problems import Path
from ..model import Interface, Layout, Parameter
from ..order_codes.labels import spelled
from ..say.place import bits
from .fact import Fact, Facts, Sort
from .reading import Reading, short
from .stated import Subject


def add_codes(reading: Reading, facts: Facts) -> None:
    """Add facts about order codes, their parameters in registers, and the measurement of the position."""
    facts.add(_codes(reading))
    facts.add(_spellings(reading))
    facts.add(_supplies(reading))
    facts.add(_parameters(reading))
    _add_alternatives(reading, facts)
    for item in reading.device.run_time_parameters:
        facts.add(_held(reading, item))
    for interface in reading.device.interfaces:
        facts.add(_measured(reading, interface))
    movement = reading.device.movement
    facts.add(iter((Fact(Sort.MEASUREMENT, ("movement",), movement, "movement", ("movement",)),)))
    facts.derived[Sort.LIMIT] += len(reading.device.definitions)


def _codes(reading: Reading) -> Iterator[Fact]:
    """Yield the order codes, and the values that the manual leaves open."""
    parts: Path = ("order_code", "parts")
    for item in reading.device.variants:
        what = f"interface of the order code {item.code}"
        yield Fact(Sort.ORDER_CODE, ("code", item.code), item.interface, what, parts)
    for part in reading.device.order_code.parts:
        if part.open:
            only = ", ".join(sorted(value for values in part.open_only_with.values() for value in values))
            value = part.open + (f" with {only}" if only else "")
            listed = ", ".join(sorted(item.text for item in part.values))
            yield Fact(
                Sort.ORDER_CODE, ("open", listed), value, f"other values than {listed}", (*parts, part.name, "open")
            )


def _supplies(reading: Reading) -> Iterator[Fact]:
    """Yield the supply of each order code."""
    needs = ((item.code, reading.device.supply_of(item)) for item in reading.device.variants)
    supplies = {(code, ""): f"{need.min_mv} to {need.max_mv} mV" for code, need in needs if need is not None}
    if supplies:
        yield Fact(Sort.SUPPLY, ("supply",), supplies, "supply", reading.first(("supply",), ("order_code", "parts")))


def _parameters(reading: Reading) -> Iterator[Fact]:
    """Yield each parameter for each order code. Readers choose their parameters, but one name has one meaning."""
    cases = [case for item in reading.device.interfaces for case in reading.cases(item.name).items()]
    for item in reading.device.parameters:
        values = {case: short(parameters[item.name]) for case, parameters in cases if item.name in parameters}
        name = f"the parameter '{item.name}'"
        subject = Subject(reading, ("parameter", item.name), ("parameters", item.name), name)
        yield replace(subject.first(Sort.ORDER_CODE, values), mild=True)
        yield from subject.stated(item)


def _add_alternatives(reading: Reading, facts: Facts) -> None:
    """Add the names of the alternatives and of their answers."""
    for number, item in enumerate(reading.device.alternatives, 1):
        place: Path = ("alternatives", item.name)
        what = f"name of alternative {number}"
        facts.call(("alternative",), Fact(Sort.ORDER_CODE, (number,), item.name, what, (*place, "name")))
        for index, answer in enumerate(item.answers, 1):
            what, at = f"name of answer {index} of alternative {number}", (*place, "values", answer.name)
            facts.call(("answer", number), Fact(Sort.ORDER_CODE, (index,), answer.name, what, at))


def _spellings(reading: Reading) -> Iterator[Fact]:
    """Yield labels in alternative spellings, with their suffix."""
    code = reading.device.order_code
    for index, spelling in enumerate(code.also_written):
        place: Path = ("order_code", "also_written", index)
        for variant in reading.device.variants:
            label = spelling.pattern
            for part in code.parts:
                texts = [text for text, value in spelled(part, spelling).items() if value == variant.parts[part.name]]
                label = label.replace(f"{{{part.name}}}", texts[0] if texts else "\0")
            if "\0" not in label:
                yield Fact(Sort.ORDER_CODE, ("label", label, spelling.then), variant.code, f"label {label}", place)


def _held(reading: Reading, item: Parameter) -> Iterator[Fact]:
    where = reading.bits_at(item.read_from)
    place: Path = ("parameters", item.name)
    register = reading.register(item.register)
    under = reading.key_of(register) if register is not None else ()
    for name, bound in (("min", item.min), ("max", item.max)):
        if bound is not None:
            what = f"{name}imum held in {where}"
            yield Fact(Sort.LIMIT, ("held", where, name), short(bound), what, (*place, name), under)


def _measured(reading: Reading, interface: Interface) -> Iterator[Fact]:
    measurement = reading.device.measurement_of(interface.name)
    if measurement is None:
        return
    own: Path = ("interfaces", interface.name, "measurement")
    place = own if interface.measurement is not None else ("measurement",)
    what = f"measurement over {interface.short}"
    subject = Subject(reading, ("measurement", interface.name), place, what, interface.name, joint=" of the ")
    yield from subject.present(Sort.MEASUREMENT, measurement)
    cases = reading.cases(interface.name)
    for layout in interface.layouts:
        yield from _range_of(subject, interface, layout)
        places = {}
        for case, parameters in cases.items():
            low, width = layout.place(parameters).place_of(measurement.of)
            if width:
                places[case] = bits(low + width - 1, low)
        if places:
            key = (*subject.key, "of", layout.sender, *layout.selects)
            what = f"measured bits of '{layout.name}'"
            yield Fact(Sort.MEASUREMENT, key, places, what, (*place, "of"), subject.key)


def _range_of(measured: Subject, interface: Interface, layout: Layout) -> Iterator[Fact]:
    """Yield the facts about the range that a layout has for itself."""
    if layout.position_range is None:
        return
    place: Path = ("interfaces", interface.name, "layouts", layout.name, "position_range")
    key = (*measured.key, "range", layout.sender, *layout.selects)
    what = f"position range of '{layout.name}'"
    subject = replace(measured, key=key, place=place, what=what, under=measured.key)
    yield from subject.present(Sort.MEASUREMENT, layout.position_range)
