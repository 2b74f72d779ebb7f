"""Build the model from checked data.

Building finds problems that are not visible in the text of a spec: bits that overlap, limits that do not fit, examples
that contradict their layout. A part that cannot be built is reported and left out, so that one run shows every problem.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from ..language.problems import DocumentReport, Path
from ..language.rules.walk import is_placeholder, placeholder_names
from ..model import (
    Alarm,
    Alternative,
    Answer,
    Biss,
    Crc,
    DataId,
    Device,
    Document,
    Manufacturer,
    OrderCode,
    Parameter,
    PlacedLayout,
    Register,
    RegisterMeaning,
    Variant,
)
from ..model.expressions import Expression, ExpressionError
from ..model.registers import bounded_width, name_with_limits, numbers_that_fit, value_bounds
from ..reference.bits_and_values import join_value
from ..say import first_of
from .examples import build_examples, check_examples
from .fields import LayoutContext, SpecPlace
from .frame_rules import check_control_bytes, check_requests, check_settings_of_crcs
from .history import build_editions
from .interfaces import build_interfaces, build_measurement, check_spi_registers
from .layouts import build_layout
from .measurement_checks import check_measurements
from .order_code_facts import (
    check_facts_by_code,
    check_limits_in_procedures,
    check_unused_parameters,
    code_grammar,
    list_variants,
)
from .parameters import (
    check_expression_values,
    check_named_widths,
    coded_values,
    exceeds_work_limit,
    factory_defaults,
    parameter_sets,
)
from .position_encoding import check_position_widths
from .repeated_facts import check_agreement, check_stated_bits, check_stated_lengths
from .samples import sample_frames
from .spec_parts import (
    Raw,
    build_part,
    build_procedures,
    build_supply,
    build_table,
    check_alarms,
    check_only_patterns,
    names_set_by_order_codes,
    only_while,
    records,
    sources,
)
from .whole_frame_checks import check_errata, check_frame_kinds


def _first_answers(alternatives: Iterable[Alternative]) -> dict[str, int]:
    """Return the parameters that the first answers to open questions set. These answers apply by default."""
    values: dict[str, int] = {}
    for alternative in alternatives:
        values |= alternative.answers[0].sets
    return values


def build_device(raw_spec: Raw, manufacturer: Manufacturer, report: DocumentReport) -> Device | None:
    """Return the device that a checked spec describes, or None if an expression has no value or too many values.

    Parts that could not be built are left out of the device. It can only be used if nothing was reported.
    """
    definitions = _derived_expressions(raw_spec)
    order_code = code_grammar(raw_spec["order_code"])
    alternatives = tuple(_build_alternative(raw_alternative) for raw_alternative in raw_spec.get("alternatives", ()))
    default_values = {**factory_defaults(raw_spec, report), **_first_answers(alternatives)}
    variants = list_variants(order_code, definitions, default_values)
    context = _build_context(raw_spec, report, definitions=definitions, variants=variants, alternatives=alternatives)
    if exceeds_work_limit(raw_spec, context):
        return None
    if variants and not check_expression_values(raw_spec, context, variants):
        return None
    check_only_patterns(raw_spec, variants, report)
    check_alarms(raw_spec, report)
    device = _build_device_without_procedures(
        raw_spec,
        context,
        manufacturer=manufacturer,
        order_code=order_code,
        variants=variants,
        alternatives=alternatives,
    )
    _check_interfaces(raw_spec, device, report)
    device = replace(device, procedures=build_procedures(raw_spec, device))
    check_limits_in_procedures(device, report)
    check_measurements(device, report)
    check_position_widths(device, report)
    check_named_widths(raw_spec, device, report)
    check_unused_parameters(raw_spec, variants, report)
    device = replace(device, editions=build_editions(raw_spec), content_hash=_content_hash(raw_spec))
    device = with_placeholders(raw_spec, device, report)
    check_agreement(raw_spec, device, report)
    check_stated_lengths(device, report)
    check_stated_bits(device, report)
    check_errata(device, report)
    check_examples(device, report)
    return replace(device, samples=sample_frames(device)) if variants and not report.faults() else device


def _content_hash(raw_spec: Raw) -> str:
    """Return the first 8 digits of a hash of the values in a spec. Comments and formatting do not change it."""
    content = json.dumps(raw_spec, ensure_ascii=True, separators=(",", ":"))
    return hashlib.sha256(content.encode("ascii")).hexdigest()[:8]


def _build_context(
    raw_spec: Raw,
    report: DocumentReport,
    *,
    definitions: Mapping[str, Expression],
    variants: Sequence[Variant],
    alternatives: Sequence[Alternative],
) -> LayoutContext:
    """Return the definitions in a spec that layouts may refer to: field groups, CRCs, data IDs and parameters."""
    raw_groups = raw_spec.get("field_groups", ())
    return LayoutContext(
        report=report,
        group_and_path_by_name={raw["name"]: (raw, ("field_groups", index)) for index, raw in enumerate(raw_groups)},
        definitions=definitions,
        parameter_sets_by_interface=parameter_sets(raw_spec, definitions, variants, alternatives),
        crc_by_name={raw_crc["name"]: build_part(Crc, raw_crc) for raw_crc in raw_spec.get("crcs", ())},
        data_ids_by_interface={name: records(DataId, raw, "data_ids") for name, raw in raw_spec["interfaces"].items()},
        only_while=lambda only: only_while(only, variants, names_set_by_order_codes(raw_spec)),
    )


def _check_interfaces(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Check the frames and requests of a device, its CRCs, and the facts that apply to only some order codes."""
    check_control_bytes(device, report)
    check_requests(device, report)
    check_facts_by_code(raw_spec, device, report)
    check_spi_registers(device, report)
    check_frame_kinds(device, report)
    check_settings_of_crcs(device, report)


def _build_device_without_procedures(
    raw_spec: Raw,
    context: LayoutContext,
    *,
    manufacturer: Manufacturer,
    order_code: OrderCode,
    variants: tuple[Variant, ...],
    alternatives: tuple[Alternative, ...],
) -> Device:
    """Return the device without its procedures, which can only be built when the rest of the device is complete."""
    # Interfaces are built before registers, so that their problems are reported first.
    interfaces = build_interfaces(raw_spec, context)
    registers = _build_registers(raw_spec, context)
    parameters = [_build_parameter(name, parameter, context) for name, parameter in raw_spec["parameters"].items()]
    documents = [build_part(Document, document, key=key) for key, document in raw_spec.get("documents", {}).items()]
    # An encoder implements its alarms unless the spec says otherwise.
    raw_alarms = [{"implemented": True, **raw_alarm} for raw_alarm in raw_spec.get("alarms", ())]
    return build_part(
        Device,
        raw_spec,
        name=raw_spec["device"],
        manufacturer=manufacturer,
        documents=tuple(documents),
        parameters=tuple(parameters),
        order_code=order_code,
        variants=variants,
        crcs=tuple(context.crc_by_name.values()),
        interfaces=interfaces,
        registers=registers,
        alarms=tuple(build_part(Alarm, raw_alarm) for raw_alarm in raw_alarms),
        procedures=(),
        examples=build_examples(raw_spec),
        measurement=build_measurement(raw_spec, context),
        tables=tuple(map(build_table, raw_spec.get("tables", ()))),
        supply=build_supply(raw_spec),
        alternatives=alternatives,
    )


def _derived_expressions(raw_spec: Raw) -> Mapping[str, Expression]:
    """Return the expression of each parameter that is calculated from others, by name. Invalid ones are left out."""
    definitions = {}
    for parameter_name, raw_parameter in raw_spec["parameters"].items():
        if "equals" not in raw_parameter:
            continue
        try:
            definitions[parameter_name] = Expression.parse(raw_parameter["equals"])
        except ExpressionError:
            continue  # reported by the rule on expressions
    return MappingProxyType(definitions)


def _build_alternative(raw_alternative: Raw) -> Alternative:
    """Return a question that the manual leaves open, with its answers."""
    answers = tuple(_build_answer(name, answer) for name, answer in raw_alternative["values"].items())
    return Alternative(
        name=raw_alternative["name"],
        meaning=raw_alternative["meaning"],
        answers=answers,
        source=sources(raw_alternative),
        default=raw_alternative.get("default", ""),
    )


def _build_answer(name: str, raw_answer: Raw) -> Answer:
    """Return an answer to a question that the manual leaves open, with the parameters that it sets."""
    return Answer(
        name=name,
        meaning=raw_answer["meaning"],
        sets=MappingProxyType(dict(raw_answer["sets"])),
        source=sources(raw_answer),
    )


def _build_parameter(name: str, raw_parameter: Raw, context: LayoutContext) -> Parameter:
    """Return a parameter with its limits and its largest value over all order codes.

    If a register holds the parameter as a code, the limits are the lowest and the highest value of the codes.
    """
    codes_with_values = coded_values(raw_parameter)
    if codes_with_values:
        values_of_codes = [coded_value.value for coded_value in codes_with_values]
        raw_parameter = {**raw_parameter, "min": min(values_of_codes), "max": max(values_of_codes)}
    values_over_order_codes: list[int] = []
    for sets_of_interface in context.parameter_sets_by_interface.values():
        # A parameter that an order code does not have counts as 0.
        values_over_order_codes += [parameters.get(name, 0) for parameters in sets_of_interface]
    return build_part(
        Parameter,
        raw_parameter,
        name=name,
        equals=context.definitions.get(name),  # The formula of a calculated parameter, or None.
        largest=max(values_over_order_codes, default=0),
        by_code=codes_with_values,
    )


def _build_registers(raw_spec: Raw, context: LayoutContext) -> tuple[Register, ...]:
    """Return the registers whose layouts are valid."""
    registers: list[Register] = []
    for index, raw_register in enumerate(raw_spec.get("registers", ())):
        register = _build_register(raw_register, ("registers", index), context)
        if register is not None:
            registers.append(register)
    return tuple(registers)


def _build_register(raw_register: Raw, path: Path, context: LayoutContext) -> Register | None:
    """Return a register, or None if its layout is not valid. A register without fields contains a single number."""
    interface = raw_register.get("interface", Biss.name)
    register_bits = 8 * raw_register["length"]
    raw_only_field = {"name": raw_register["name"], "bits": register_bits}
    raw_with_fields = {"fields": [raw_only_field], **raw_register}  # If the register lists fields, these replace it.
    layout = build_layout(raw_with_fields, SpecPlace(path, context, interface), register_bits)
    if layout is None:
        return None
    raw_opener = raw_register.get("opened_by", {})  # The register that must have a value before this one is written.
    register = build_part(
        Register,
        raw_register,
        interface=interface,
        byte_order=raw_register.get("byte_order", "high_byte_first"),
        limits_of=raw_register.get("limits_of", raw_register["name"]),
        opened_by=raw_opener.get("register", ""),
        opened_by_field=raw_opener.get("field", ""),
        opened_by_value=raw_opener.get("value", ""),
        layout=layout,
        meanings=tuple(_build_register_meaning(meaning, context) for meaning in raw_register.get("meanings", ())),
        **context.expressions(raw_register, ("min", "max")),
    )
    _check_limits(register, path, context)
    return register


def _build_register_meaning(raw_meaning: Raw, context: LayoutContext) -> RegisterMeaning:
    """Return one of several meanings of a register, with its limits."""
    return build_part(
        RegisterMeaning, raw_meaning, value=raw_meaning["is"], **context.expressions(raw_meaning, ("min", "max"))
    )


def _check_limits(register: Register, path: Path, context: LayoutContext) -> None:
    """Check that the limits of a register fit into their field, and that its default is within them.

    If the register has named values, the default must be one of them. Only the first problem is reported, for the first
    order code that has it.
    """
    expressions = [register.min, register.max]
    for field in register.layout.fields:
        expressions += [field.low, field.width]
    depends_on_order_code = any(expression is not None and not expression.is_constant for expression in expressions)
    sets_of_interface = context.parameter_sets_by_interface.get(register.interface, ())
    # If nothing depends on the order code, the first order code represents all.
    checked_sets = sets_of_interface if depends_on_order_code else sets_of_interface[:1]
    for parameters in checked_sets:
        placed_layout = register.layout.place(parameters)
        problem = _problem_of_limits(register, placed_layout, parameters) or _problem_of_default(
            register, placed_layout, parameters
        )
        if problem is not None:
            context.report.add(problem.rule, (*path, problem.key), problem.message)
            return


class _RegisterProblem(NamedTuple):
    """A problem of a register: the rule, the key with the problem, and the message."""

    rule: str
    key: str
    message: str


class _Limits(NamedTuple):
    """The lowest and the highest value that a register stores, and the number that a stored zero represents."""

    low: int
    high: int
    zero_means: int


def _limits_for_code(register: Register, placed_layout: PlacedLayout, parameters: Mapping[str, int]) -> _Limits:
    """Return the limits of a register for one order code.

    Some registers store their highest number as 0, such as 256 in 8 bits. Then ``highest`` is the number below it.
    """
    bounded_field = placed_layout.find_field(name_with_limits(register))
    meaning_of_zero = bounded_field.field.number.zero_means if bounded_field is not None else 0
    lowest, highest = value_bounds(register, placed_layout, (register.min, register.max), parameters)
    is_highest_stored_as_zero = meaning_of_zero > 0 and highest == meaning_of_zero
    if is_highest_stored_as_zero:
        highest -= 1
    return _Limits(lowest, highest, meaning_of_zero)


def _problem_of_limits(
    register: Register, placed_layout: PlacedLayout, parameters: Mapping[str, int]
) -> _RegisterProblem | None:
    """Return the first problem with the limits of a register for one order code, or None."""
    lowest_that_fits, highest_that_fits = numbers_that_fit(register, placed_layout)
    limits = _limits_for_code(register, placed_layout, parameters)
    width_text = f"the {bounded_width(register, placed_layout)} bits of '{register.limits_of}'"
    if limits.high > highest_that_fits:
        message = f"the maximum {limits.high} does not fit into {width_text}"
        return _RegisterProblem("limit-does-not-fit", "max", message)
    if limits.low < lowest_that_fits:
        message = f"the minimum {limits.low} does not fit into {width_text}"
        return _RegisterProblem("limit-does-not-fit", "min", message)
    if limits.low > limits.high:
        message = f"the minimum {limits.low} is above the maximum {limits.high}"
        return _RegisterProblem("limit-does-not-fit", "min", message)
    return None


def _problem_of_default(
    register: Register, placed_layout: PlacedLayout, parameters: Mapping[str, int]
) -> _RegisterProblem | None:
    """Return the first problem with the default of a register for one order code, or None."""
    default = register.default
    if default is None:
        return None
    limits = _limits_for_code(register, placed_layout, parameters)
    default_number = _number_within_limits(register, placed_layout, default)
    # A stored zero can stand for a different number.
    meant_number = default_number or limits.zero_means
    named_numbers = [named_value.value for named_value in register.values]
    register_bits = 8 * register.length
    if default >> register_bits:
        problem = f"{default:#x} does not fit into {register_bits} bits"
    elif not limits.low <= meant_number <= max(limits.high, limits.zero_means):
        problem = f"{default_number} is outside the limits {limits.low} to {limits.high}"
    elif named_numbers and default not in named_numbers and not register.clears_itself:
        values_text = ", ".join(f"{number:#x}" for number in named_numbers)
        problem = f"{default:#x} is not one of the values {values_text}"
    else:
        return None
    return _RegisterProblem("default-does-not-fit", "default", f"the default {problem}")


def _number_within_limits(register: Register, placed_layout: PlacedLayout, default: int) -> int:
    """Return the signed number in the default value of a register to which the limits apply.

    The limits apply to a field, to a number that consists of several fields, or to the whole register.
    """
    bounded_name, width = name_with_limits(register), bounded_width(register, placed_layout)
    bounded_joins = [join for join in register.layout.joins if join.name == bounded_name]
    if bounded_joins:
        number_without_sign = join_value(placed_layout, bounded_joins[0], default)
    else:
        bounded_field = placed_layout.find_field(bounded_name)
        lowest_bit = bounded_field.lowest_bit if bounded_field is not None else 0
        mask = (1 << width) - 1
        number_without_sign = (default >> lowest_bit) & mask
    _, highest_that_fits = numbers_that_fit(register, placed_layout)
    # Read without a sign, a negative number is larger than the highest number of a signed field.
    is_negative = number_without_sign > highest_that_fits
    return number_without_sign - (1 << width) if is_negative else number_without_sign


#: The only grade of a spec that is still being filled in.
_LOWEST_GRADE = "uncorroborated"


#: Highest number of placeholders that a message names.
_MAX_SHOWN_NAMES = 3


def with_placeholders(raw_spec: Raw, device: Device, report: DocumentReport) -> Device:
    """Return the device with its placeholders listed in its evidence, and report a grade that is too high.

    A placeholder is a text from the template for new specs that was not replaced. A spec with placeholders can only
    have the lowest grade.
    """
    if not raw_spec.get("evidence"):
        return device
    placeholders = placeholder_names(report.document.data)  # The paths of their keys in the spec.
    if is_placeholder(device.manufacturer.title):
        placeholders.append("manufacturer.title")
    grade = device.evidence.grade
    if placeholders and grade != _LOWEST_GRADE:
        names_text = first_of(placeholders, _MAX_SHOWN_NAMES)
        message = f"values left over from the template are not allowed with grade '{grade}': {names_text}"
        remedy = f"replace every text that contains TODO, or write 'grade: {_LOWEST_GRADE}' until all are replaced"
        report.add("evidence-grade", ("evidence", "grade"), f"{message}; {remedy}")
    return replace(device, evidence=replace(device.evidence, placeholders=tuple(placeholders)))
