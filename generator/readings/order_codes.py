"""Facts about order codes: the existing ones and their properties."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..language.problems import Path
from ..model import Interface, Layout, Parameter
from ..order_codes.labels import spelled
from ..say.names_and_places import bits
from .reading import FACTORY_DEFAULTS, Case, Fact, Facts, Reading, Sort, short
from .stated import Subject


def add_codes(reading: Reading, facts: Facts) -> None:
    """Add facts about order codes, their parameters in registers, and the measurement of the position."""
    facts.add(_codes(reading))
    facts.add(_spellings(reading))
    facts.add(_supplies(reading))
    facts.add(_parameters(reading))
    _add_alternatives(reading, facts)
    for parameter in reading.device.run_time_parameters:
        facts.add(_held_parameter_facts(reading, parameter))
    for interface in reading.device.interfaces:
        facts.add(_measurement_facts(reading, interface))
    movement = reading.device.movement
    facts.add(iter((Fact(Sort.MEASUREMENT, ("movement",), movement, "movement", ("movement",)),)))
    facts.derived[Sort.LIMIT] += len(reading.device.definitions)


def _codes(reading: Reading) -> Iterator[Fact]:
    """Yield the order codes, and the values that the manual leaves open."""
    parts: Path = ("order_code", "parts")
    for variant in reading.device.variants:
        description = f"interface of the order code {variant.code}"
        yield Fact(Sort.ORDER_CODE, ("code", variant.code), variant.interface, description, parts)
    for part in reading.device.order_code.parts:
        if part.open:
            allowed_values = ", ".join(sorted(value for values in part.open_only_with.values() for value in values))
            value = part.open + (f" with {allowed_values}" if allowed_values else "")
            listed = ", ".join(sorted(part_value.text for part_value in part.values))
            yield Fact(
                Sort.ORDER_CODE, ("open", listed), value, f"other values than {listed}", (*parts, part.name, "open")
            )


def _supplies(reading: Reading) -> Iterator[Fact]:
    """Yield the supply of each order code."""
    supplies: dict[Case, str] = {}
    for variant in reading.device.variants:
        supply = reading.device.supply_of(variant)
        if supply is not None:
            supplies[Case(variant.code, FACTORY_DEFAULTS)] = f"{supply.min_mv} to {supply.max_mv} mV"
    if supplies:
        yield Fact(
            Sort.SUPPLY, ("supply",), supplies, "supply", reading.first_existing(("supply",), ("order_code", "parts"))
        )


def _parameters(reading: Reading) -> Iterator[Fact]:
    """Yield each parameter for each order code. Readers choose their parameters, but one name has one meaning."""
    cases = [case for interface in reading.device.interfaces for case in reading.cases(interface.name).items()]
    for parameter in reading.device.parameters:
        values = {case: short(parameters[parameter.name]) for case, parameters in cases if parameter.name in parameters}
        name = f"the parameter '{parameter.name}'"
        subject = Subject(reading, ("parameter", parameter.name), ("parameters", parameter.name), name)
        yield replace(subject.existence(Sort.ORDER_CODE, values), mild=True)
        yield from subject.stated_facts(parameter)


def _add_alternatives(reading: Reading, facts: Facts) -> None:
    """Add the names of the alternatives and of their answers."""
    for number, alternative in enumerate(reading.device.alternatives, 1):
        place: Path = ("alternatives", alternative.name)
        description = f"name of alternative {number}"
        facts.call(("alternative",), Fact(Sort.ORDER_CODE, (number,), alternative.name, description, (*place, "name")))
        for index, answer in enumerate(alternative.answers, 1):
            description, path = f"name of answer {index} of alternative {number}", (*place, "values", answer.name)
            facts.call(("answer", number), Fact(Sort.ORDER_CODE, (index,), answer.name, description, path))


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


def _held_parameter_facts(reading: Reading, parameter: Parameter) -> Iterator[Fact]:
    bits_text = reading.bits_at(parameter.read_from)
    place: Path = ("parameters", parameter.name)
    register = reading.register(parameter.register)
    register_key = reading.key_of(register) if register is not None else ()
    for name, bound in (("min", parameter.min), ("max", parameter.max)):
        if bound is not None:
            description = f"{name}imum held in {bits_text}"
            yield Fact(Sort.LIMIT, ("held", bits_text, name), short(bound), description, (*place, name), register_key)


def _measurement_facts(reading: Reading, interface: Interface) -> Iterator[Fact]:
    measurement = reading.device.measurement_of(interface.name)
    if measurement is None:
        return
    own_place: Path = ("interfaces", interface.name, "measurement")
    place = own_place if interface.measurement is not None else ("measurement",)
    description = f"measurement over {interface.short}"
    subject = Subject(reading, ("measurement", interface.name), place, description, interface.name, joint=" of the ")
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
            description = f"measured bits of '{layout.name}'"
            yield Fact(Sort.MEASUREMENT, key, places, description, (*place, "of"), subject.key)


def _range_of(measured: Subject, interface: Interface, layout: Layout) -> Iterator[Fact]:
    """Yield the facts about the range that a layout has for itself."""
    if layout.position_range is None:
        return
    place: Path = ("interfaces", interface.name, "layouts", layout.name, "position_range")
    key = (*measured.key, "range", layout.sender, *layout.selects)
    description = f"position range of '{layout.name}'"
    subject = replace(measured, key=key, place=place, description=description, under=measured.key)
    yield from subject.present(Sort.MEASUREMENT, layout.position_range)
