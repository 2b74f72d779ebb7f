"""Facts about order codes: which codes exist, and their properties."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain

from ..language.problems import Path
from ..model import CodePart, Interface, Layout, Parameter, Spelling, Variant
from ..order_codes.patterns import values_by_spelling
from ..say.names_and_evidence import bits
from .reading import FACTORY_DEFAULTS, CodeAndState, ComparedFact, ComparedFacts, FactClass, SpecReading, count_text
from .stated import FactSubject


def add_codes(reading: SpecReading, facts: ComparedFacts) -> None:
    """Add the facts about order codes: notations, supplies, parameters, alternatives, measurements and the movement.

    Parameters with a formula follow from other parameters, so they only count as derived.
    """
    facts.add(_order_code_facts(reading))
    facts.add(_spelling_facts(reading))
    facts.add(_supply_facts(reading))
    facts.add(_parameter_facts(reading))
    _add_alternatives(reading, facts)
    for parameter in reading.device.run_time_parameters:
        facts.add(_held_parameter_facts(reading, parameter))
    for interface in reading.device.interfaces:
        facts.add(_measurement_facts(reading, interface))
    movement = reading.device.movement
    movement_fact = ComparedFact(
        fact_class=FactClass.MEASUREMENT,
        key=("movement",),
        value=movement,
        description="movement",
        path_in_file=("movement",),
    )
    facts.add(iter([movement_fact]))
    facts.derived[FactClass.LIMIT] += len(reading.device.definitions)


def _order_code_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield each order code with its interface, and each part of the order code that can have unlisted values.

    Such a part is identified by the values that the manual lists. If unlisted values are only possible with certain
    values of other parts, the text contains these values.
    """
    path_in_file: Path = ("order_code", "parts")
    for variant in reading.device.variants:
        description = f"interface of the order code {variant.code}"
        yield ComparedFact(
            fact_class=FactClass.ORDER_CODE,
            key=("code", variant.code),
            value=variant.interface,
            description=description,
            path_in_file=path_in_file,
        )
    for part in reading.device.order_code.parts:
        if not part.open:
            continue
        allowed_values = sorted(chain.from_iterable(part.open_only_with.values()))
        with_text = f" with {', '.join(allowed_values)}" if allowed_values else ""
        printed_values = ", ".join(sorted(part_value.text for part_value in part.values))
        yield ComparedFact(
            fact_class=FactClass.ORDER_CODE,
            key=("open", printed_values),
            value=part.open + with_text,
            description=f"other values than {printed_values}",
            path_in_file=(*path_in_file, part.name, "open"),
        )


def _supply_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield a fact with the supply of each order code, such as ``5000 to 30000 mV``, if any supply is stated."""
    supplies: dict[CodeAndState, str] = {}
    for variant in reading.device.variants:
        supply = reading.device.supply_of(variant)
        if supply is not None:
            supplies[CodeAndState(variant.code, FACTORY_DEFAULTS)] = f"{supply.min_mv} to {supply.max_mv} mV"
    if supplies:
        yield ComparedFact(
            fact_class=FactClass.SUPPLY,
            key=("supply",),
            value=supplies,
            description="supply",
            path_in_file=reading.first_existing(("supply",), ("order_code", "parts")),
        )


def _parameter_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield a fact for each parameter, with its value in each case: an order code with a state of its registers.

    A parameter may be missing in the other reading, because readers define their own. Parameters with the same name are
    compared.
    """
    for parameter in reading.device.parameters:
        value_by_case: dict[CodeAndState, str] = {}
        for interface in reading.device.interfaces:
            for case, parameters in reading.cases(interface.name).items():
                if parameter.name in parameters:
                    value_by_case[case] = count_text(parameters[parameter.name])
        path_in_file = ("parameters", parameter.name)
        subject = FactSubject(
            reading,
            key=("parameter", parameter.name),
            path_in_file=path_in_file,
            description=f"the parameter '{parameter.name}'",
        )
        yield replace(subject.existence_fact(FactClass.ORDER_CODE, value_by_case), may_be_missing=True)
        yield from subject.stated_facts(parameter)


def _add_alternatives(reading: SpecReading, facts: ComparedFacts) -> None:
    """Add the names of open questions and of their answers, which are identified by their numbers from 1."""
    for number, alternative in enumerate(reading.device.alternatives, 1):
        path_in_file: Path = ("alternatives", alternative.name)
        description = f"name of alternative {number}"
        facts.add_name(
            ("alternative",),
            ComparedFact(
                fact_class=FactClass.ORDER_CODE,
                key=(number,),
                value=alternative.name,
                description=description,
                path_in_file=(*path_in_file, "name"),
            ),
        )
        for index, answer in enumerate(alternative.answers, 1):
            description = f"name of answer {index} of alternative {number}"
            path = (*path_in_file, "values", answer.name)
            facts.add_name(
                ("answer", number),
                ComparedFact(
                    fact_class=FactClass.ORDER_CODE,
                    key=(index,),
                    value=answer.name,
                    description=description,
                    path_in_file=path,
                ),
            )


def _spelling_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield each label in an additional notation, with the order code that it represents.

    A label is identified by its text and by the pattern of the text after it (``then``).
    """
    for index, spelling in enumerate(reading.device.order_code.also_written):
        path_in_file: Path = ("order_code", "also_written", index)
        for variant in reading.device.variants:
            label = _label_with_spelling(spelling, variant, reading.device.order_code.parts)
            if label is not None:
                key = ("label", label, spelling.then)
                yield ComparedFact(
                    fact_class=FactClass.ORDER_CODE,
                    key=key,
                    value=variant.code,
                    description=f"label {label}",
                    path_in_file=path_in_file,
                )


def _label_with_spelling(spelling: Spelling, variant: Variant, parts: Iterable[CodePart]) -> str | None:
    """Return the label of an order code in an additional notation: ``X24B`` for ``X-24-B``.

    Return None if the notation has no text for a value of this order code.
    """
    label = spelling.pattern
    for part in parts:
        placeholder = f"{{{part.name}}}"
        value_by_spelled_text = values_by_spelling(part, spelling)
        value = variant.parts[part.name]
        spelled_texts = [text for text, listed_value in value_by_spelled_text.items() if listed_value == value]
        if spelled_texts:
            label = label.replace(placeholder, spelled_texts[0])
        elif placeholder in label:
            return None
    return label


def _held_parameter_facts(reading: SpecReading, parameter: Parameter) -> Iterator[ComparedFact]:
    """Yield the limits of a parameter that a register holds, such as ``minimum held in register 0x49 bits 7:4``.

    The bits that hold the parameter identify its limits.
    """
    bits_text = reading.describe_bits(parameter.read_from)
    register = reading.register(parameter.register)
    for bound_name, bound in (("min", parameter.min), ("max", parameter.max)):
        if bound is not None:
            yield ComparedFact(
                fact_class=FactClass.LIMIT,
                key=("held", bits_text, bound_name),
                value=count_text(bound),
                description=f"{bound_name}imum held in {bits_text}",  # minimum or maximum
                path_in_file=("parameters", parameter.name, bound_name),
                depends_on=reading.key_of(register) if register is not None else (),
            )


def _measurement_facts(reading: SpecReading, interface: Interface) -> Iterator[ComparedFact]:
    """Yield the facts about the position over an interface, and its bits in each frame that contains it.

    The position is described by the ``measurement`` of the interface, or else of the device.
    """
    measurement = reading.device.measurement_of(interface.name)
    if measurement is None:
        return
    measurement_place: Path = ("measurement",)
    if interface.measurement is not None:
        measurement_place = ("interfaces", interface.name, "measurement")
    subject = FactSubject(
        reading,
        key=("measurement", interface.name),
        path_in_file=measurement_place,
        description=f"measurement over {interface.short}",
        interface=interface.name,
        joint=" of the ",
    )
    yield from subject.facts_of_part(FactClass.MEASUREMENT, measurement)
    for layout in interface.layouts:
        yield from _range_facts(subject, interface, layout)
        position_bits: dict[CodeAndState, str] = {}
        for case, parameters in reading.cases(interface.name).items():
            # The width is 0 if the frame does not contain the position in this case.
            low_bit, width = layout.place(parameters).lowest_bit_and_width_of(measurement.position_name)
            if width:
                high_bit = low_bit + width - 1
                position_bits[case] = bits(high_bit, low_bit)
        if position_bits:
            position_key = (*subject.key, "of", layout.sender, *layout.selects)
            description = f"measured bits of '{layout.name}'"
            yield ComparedFact(
                fact_class=FactClass.MEASUREMENT,
                key=position_key,
                value=position_bits,
                description=description,
                path_in_file=(*measurement_place, "of"),
                depends_on=subject.key,
            )


def _range_facts(measured: FactSubject, interface: Interface, layout: Layout) -> Iterator[ComparedFact]:
    """Yield the facts about the range of the position in a layout, if the layout states its own."""
    if layout.position_range is None:
        return
    path_in_file: Path = ("interfaces", interface.name, "layouts", layout.name, "position_range")
    key = (*measured.key, "range", layout.sender, *layout.selects)
    description = f"position range of '{layout.name}'"
    subject = replace(measured, key=key, path_in_file=path_in_file, description=description, depends_on=measured.key)
    yield from subject.facts_of_part(FactClass.MEASUREMENT, layout.position_range)
