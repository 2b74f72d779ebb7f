"""Parameters that registers hold at run time, the sets of parameters to support, and checks for expressions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from types import MappingProxyType

from ..language.files import is_second
from ..language.keys_of_specs import WrittenSpec
from ..language.problems import DocumentReport, quoted
from ..language.rules.parameters import all_parameters, parameter_uses
from ..language.rules.parts import by_name, field_lists, interface_name_of, with_groups_expanded
from ..language.rules.walk import leaves
from ..model import Alternative, CodedValue, Device, Interface, Layout, Parameter, Variant
from ..model.expressions import Expression, ExpressionError, resolve_parameters
from ..order_codes.parameters import State, coded_states, extreme_combinations
from .fields import LayoutContext, bit_range
from .spec_parts import Raw

_BITS_ENDING = "_bits"
_NAME_IN_TEXT = re.compile(r"[a-z][a-z0-9_]*")
#: Keys of texts in which the name of a parameter is only a word.
_KEYS_OF_PROSE = frozenset(("meaning", "note", "source", "title", "printed_name", "printed", "used", "why", "result"))


def check_named_widths(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report a parameter such as ``position_bits`` that differs from the width of ``position`` in a frame.

    Only parameters with a formula (``equals``) that nothing in the spec uses are checked. If another fact uses the
    parameter, a mistake in its formula shows there.
    """
    if is_second(report.document.file):  # The second reading, an independent transcription, must equal the spec.
        return
    if report.document.family:  # In an older edition, the facts that use a parameter may be missing.
        return
    used_words = set(_used_words(raw_spec))
    for parameter in device.parameters:
        is_calculated_width = parameter.equals is not None and parameter.name.endswith(_BITS_ENDING)
        if not is_calculated_width or parameter.name in used_words:
            continue
        difference_text = _first_difference(device, parameter)
        if difference_text:
            remedy = "correct 'equals', or rename the parameter if it is a different number"
            report.add("parameter-width", ("parameters", parameter.name, "equals"), f"{difference_text}; {remedy}")


def _first_difference(device: Device, parameter: Parameter) -> str:
    """Return the text of a difference between a parameter and the width of the number with its name, or ""."""
    for interface in device.interfaces:
        for layout in interface.layouts:
            difference = _describe_difference(device, parameter, interface, layout)
            if difference:
                return difference
    return ""


def _used_words(raw_spec: Raw) -> Iterator[str]:
    """Yield every word of a spec that may refer to a parameter: in an expression, a condition or a key."""
    for spec_path, spec_value in leaves(raw_spec):
        # The name in ``parameters.NAME`` defines the parameter, so it does not count as a use.
        steps_of_use = spec_path[2:] if spec_path[0] == "parameters" else spec_path
        yield from (step for step in steps_of_use if isinstance(step, str))  # An index in a list is not a word.
        if isinstance(spec_value, str) and spec_path[-1] not in _KEYS_OF_PROSE:
            yield from _NAME_IN_TEXT.findall(spec_value)


def _describe_difference(device: Device, parameter: Parameter, interface: Interface, layout: Layout) -> str:
    """Return how a parameter such as ``position_bits`` differs from the width of ``position`` in a frame, or "".

    The result is also "" if the encoder does not send a number of this name in this frame.
    """
    number_name = parameter.name.removesuffix(_BITS_ENDING)
    field_names = {field.name for field in layout.fields}
    has_number = field_names.issuperset(layout.field_names_of(number_name))
    if layout.sender != "encoder" or not has_number:
        return ""
    for variant in device.variants_over(interface.name):
        placed_layout = layout.place(variant.parameters)
        placed_fields = placed_layout.find_fields(layout.field_names_of(number_name))
        field_width = sum(field.width for field in placed_fields)
        stated_width = variant.parameters.get(parameter.name)
        if placed_fields and stated_width not in (None, field_width):
            problem = f"'{parameter.name}' is {stated_width} for {variant.code}"
            return f"{problem}, but '{number_name}' in '{layout.name}' has {field_width} bits"
    return ""


def check_expression_values(raw_spec: Raw, context: LayoutContext, variants: Sequence[Variant]) -> bool:
    """Return whether every expression in a spec has a value, and report the expressions that have none.

    An expression needs a value for each order code of the interface that uses it. The formula of a parameter (its
    ``equals``) needs a value for at least one order code.
    """
    problem_count_before = len(context.report)
    spec = WrittenSpec(dict(raw_spec))
    for expression_path, interface, expression_text in parameter_uses(spec):
        parameter_names = list(all_parameters(expression_text, spec.parameters))
        raw_parameters = [raw_spec["parameters"][parameter_name] for parameter_name in parameter_names]
        formulas = [raw_parameter["equals"] for raw_parameter in raw_parameters if "equals" in raw_parameter]
        sets_of_interface = context.parameter_sets_by_interface.get(interface, ())
        # An expression without parameters has the same value for all order codes.
        sets_to_check = sets_of_interface if parameter_names else sets_of_interface[:1]
        for parameters, text_of_expression in product(sets_to_check, (expression_text, *formulas)):
            error_text = _error_of_expression(text_of_expression, parameters)
            if error_text:
                context.report.add("bad-expression", expression_path, error_text)
                break
    for parameter_name, raw_parameter in raw_spec["parameters"].items():
        if "equals" not in raw_parameter:
            continue
        error_of_each_code = [_error_of_expression(raw_parameter["equals"], variant.parameters) for variant in variants]
        if error_of_each_code and all(error_of_each_code):
            context.report.add("bad-expression", ("parameters", parameter_name, "equals"), error_of_each_code[0])
    return len(context.report) == problem_count_before


def _error_of_expression(expression_text: int | str, parameters: Mapping[str, int]) -> str:
    """Return the reason an expression has no value with these parameters, or "".

    The result is also "" for an expression with a syntax error or an unknown parameter, which other rules report.
    """
    try:
        expression = Expression.parse(expression_text)
    except ExpressionError:
        return ""
    has_unknown_parameter = not parameters.keys() >= set(expression.parameters)
    if has_unknown_parameter:
        return ""
    try:
        expression.value(parameters)
    except ExpressionError as error:
        return str(error)
    return ""


def factory_defaults(raw_spec: Raw, report: DocumentReport) -> Mapping[str, int]:
    """Return the factory defaults of the parameters that registers hold at run time, and check their definitions.

    Parameters that order codes set are left out. If a default cannot be determined, it is replaced by the highest value
    of the parameter, or by 0, so that the rest of the spec can be checked.
    """
    default_by_name: dict[str, int] = {}
    names_set_by_codes = names_in_code_values(raw_spec)
    for name, raw_parameter in raw_spec["parameters"].items():
        if "read_from" not in raw_parameter:
            continue
        raw_register, raw_field = _register_and_field(raw_spec, raw_parameter)
        if raw_register is None or raw_field is None:
            # The rule on references reports it.
            default_by_name[name] = raw_parameter.get("max", 0)
            continue
        lowest_bit_and_width = _lowest_bit_and_width(raw_field)
        if lowest_bit_and_width is None:
            message = f"'{raw_parameter['read_from']}' must be placed with 'at' and a constant width"
            report.add("undefined-reference", ("parameters", name, "read_from"), message)
            default_by_name[name] = raw_parameter.get("max", 0)
            continue
        lowest_bit, bit_count = lowest_bit_and_width
        _check_codes(name, raw_parameter, bit_count, report)
        if name in names_set_by_codes:
            values_of_codes = coded_values(raw_parameter)
            _check_set_values(name, raw_spec, values_of_codes, report)
        elif "default" not in raw_register:
            message = f"the register of '{raw_parameter['read_from']}' has no default, so every order code must set"
            report.add("undefined-reference", ("parameters", name, "read_from"), f"{message} {quoted(name)}")
            default_by_name[name] = raw_parameter.get("max", 0)
        else:
            mask = (1 << bit_count) - 1
            stored_number = (raw_register["default"] >> lowest_bit) & mask
            default_by_name[name] = _default_of_parameter(
                name, raw_parameter, report, stored_number=stored_number, zero_means=raw_field.get("zero_means", 0)
            )
    return MappingProxyType(default_by_name)


def _register_and_field(raw_spec: Raw, raw_parameter: Raw) -> tuple[Raw | None, Raw | None]:
    """Return the register and the field that hold a parameter. Each is None if it does not exist in the spec."""
    register_name, _, field_name = raw_parameter["read_from"].partition(".")
    registers = raw_spec.get("registers", ())
    raw_register = next((register for register in registers if register["name"] == register_name), None)
    if raw_register is None:
        return None, None
    return raw_register, _find_raw_field(raw_register, field_name)


def _default_of_parameter(
    parameter_name: str, raw_parameter: Raw, report: DocumentReport, *, stored_number: int, zero_means: int
) -> int:
    """Return the value of a parameter whose register field contains this number by default, and check it.

    If the field holds a code, this is the value of the code, or 0 if the number is not a code. ``zero_means`` is the
    value that a stored zero represents.
    """
    codes_with_values = coded_values(raw_parameter)
    if codes_with_values:
        value_by_code = {coded.code: coded.value for coded in codes_with_values}
        if stored_number not in value_by_code:
            message = f"the default of '{raw_parameter['read_from']}' is {stored_number}"
            remedy = f"which is not a code of {quoted('by_code')}"
            report.add("default-does-not-fit", ("parameters", parameter_name), f"{message}, {remedy}")
        return value_by_code.get(stored_number, 0)
    value = stored_number or zero_means
    lowest, highest = raw_parameter.get("min", 0), raw_parameter.get("max", value)
    if not lowest <= value <= highest:
        message = f"the default of '{raw_parameter['read_from']}' is {value}, not between 'min' and 'max'"
        report.add("default-does-not-fit", ("parameters", parameter_name), message)
    return value


def coded_values(definition: Raw) -> tuple[CodedValue, ...]:
    """Return the codes by which a register holds a parameter, with their values, sorted by code."""
    values = (CodedValue(int(code, 0), value) for code, value in definition.get("by_code", {}).items())
    return tuple(sorted(values, key=lambda coded: coded.code))


def _extreme_states_in_spec(raw_spec: Raw) -> Sequence[Sequence[State]]:
    """Return the extreme states of each register field that holds parameters, for which all layouts must be valid.

    A parameter with limits has a list of two states, such as ``[{"offset": 0}, {"offset": 15}]``. A field that holds a
    code has a list with a state for each code, which can set several parameters.
    """
    states_of_limits: list[list[State]] = []
    values_by_code_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    for parameter_name, raw_parameter in raw_spec["parameters"].items():
        field_path = raw_parameter.get("read_from")
        if field_path is not None and "by_code" in raw_parameter:
            values_by_code = {coded.code: coded.value for coded in coded_values(raw_parameter)}
            values_by_code_by_field.setdefault(field_path, {})[parameter_name] = values_by_code
        elif field_path is not None:
            limits = [raw_parameter[key] for key in ("min", "max") if key in raw_parameter]
            states_of_limits.append([{parameter_name: limit} for limit in limits])
    return [*states_of_limits, *map(coded_states, values_by_code_by_field.values())]


def names_in_code_values(raw_spec: Raw) -> frozenset[str]:
    """Return the names of the parameters that values of the order code set."""
    parameter_names: set[str] = set()
    for raw_part in raw_spec["order_code"]["parts"]:
        for raw_value in raw_part["values"].values():
            parameter_names.update((raw_value or {}).get("sets", ()))
    return frozenset(parameter_names)


def _check_set_values(
    parameter_name: str, raw_spec: Raw, coded_values: Sequence[CodedValue], report: DocumentReport
) -> None:
    """Check that order codes only set values of a parameter that its register can hold, which are values with a code.

    A parameter without codes is not checked.
    """
    values_with_code = {coded.value for coded in coded_values}
    for part_index, raw_part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, raw_value in raw_part["values"].items():
            set_number = (raw_value or {}).get("sets", {}).get(parameter_name)
            if values_with_code and set_number is not None and set_number not in values_with_code:
                value_path = ("order_code", "parts", part_index, "values", text_of_value, "sets", parameter_name)
                report.add(
                    "default-does-not-fit",
                    value_path,
                    f"{set_number} is not one of the values in 'by_code' of {quoted(parameter_name)}",
                )


def _check_codes(parameter_name: str, raw_parameter: Raw, bit_count: int, report: DocumentReport) -> None:
    """Check that each code of a parameter, such as ``0x10``, fits into its register field and is unique."""
    first_text_by_code: dict[int, str] = {}
    for code_text in raw_parameter.get("by_code", {}):
        code = int(code_text, 0)  # Base 0 reads 0x10 as hexadecimal.
        code_path = ("parameters", parameter_name, "by_code", code_text)
        has_too_many_bits = code >> bit_count != 0
        if has_too_many_bits:
            message = f"the code {code_text} does not fit into the {bit_count} bits of '{raw_parameter['read_from']}'"
            report.add("value-too-wide", code_path, message, at_key=True)
        elif code in first_text_by_code:
            report.add(
                "value-clash",
                code_path,
                f"{first_text_by_code[code]} and {code_text} are the same code; keep one",
                at_key=True,
            )
        first_text_by_code.setdefault(code, code_text)


def _find_raw_field(raw_register: Raw, field_name: str) -> Raw | None:
    """Return the definition of a field of a register in the spec, or None if there is no such field.

    A register without fields is a single number, whose field has the name of the register. If the register uses a group
    of fields, any other name may belong to a field of the group, and the result is an empty definition.
    """
    if "fields" not in raw_register:
        if field_name != raw_register["name"]:
            return None
        highest_bit = 8 * raw_register["length"] - 1
        return {"name": field_name, "at": f"{highest_bit}:0"}
    single_fields: list[Raw] = [field for field in raw_register["fields"] if "use" not in field]
    for field in single_fields:
        if field.get("name") == field_name:
            return field
    uses_group = len(single_fields) < len(raw_register["fields"])
    return {} if uses_group else None


def _lowest_bit_and_width(raw_field: Raw) -> tuple[int, int] | None:
    """Return the lowest bit and the width of a field, such as ``(0, 8)`` for ``at: 7:0``.

    Return None for a field without a valid ``at``, or with a width that is an expression.
    """
    highest_and_lowest = bit_range(raw_field["at"]) if "at" in raw_field else None
    if highest_and_lowest is None:
        return None
    highest_bit, lowest_bit = highest_and_lowest
    width = raw_field.get("bits", highest_bit - lowest_bit + 1)
    return (lowest_bit, width) if isinstance(width, int) else None


#: Highest number of sets of parameters, and of fields times sets. The largest manuals need 200 and 20,000.
MOST_SETS = 20_000
MOST_PLACES = 500_000


def parameter_sets(
    raw_spec: Raw,
    definitions: Mapping[str, Expression],
    variants: Sequence[Variant],
    alternatives: Sequence[Alternative],
) -> Mapping[str, Sequence[Mapping[str, int]]]:
    """Return every set of parameters that layouts must support, by interface.

    Each set contains the parameters of an order code, possibly with extreme values of the parameters that registers
    hold (one of them or several), and possibly with an answer to an open question other than its first answer. If there
    are more than ``MOST_SETS``, the rest is left out, and ``exceeds_work_limit`` reports the spec.
    """
    interface_names = (*raw_spec["interfaces"], *map(interface_name_of, WrittenSpec(dict(raw_spec)).registers))
    if not variants:  # The parameters are not known, but parts that do not use them can still be checked.
        return MappingProxyType({interface: ({},) for interface in interface_names})
    sets_by_interface: dict[str, list[Mapping[str, int]]] = {interface: [] for interface in interface_names}
    values_of_answers: list[Mapping[str, int]] = [{}]
    for alternative in alternatives:
        # The order codes already have the values of the first answer, which is the default.
        values_of_answers += [answer.sets for answer in alternative.answers[1:]]
    listed_sets: set[tuple[str, frozenset[tuple[str, int]]]] = set()
    for (interface, code_values), register_values, answer_values in product(
        _values_set_by_codes(definitions, variants), _states_of_registers(raw_spec), values_of_answers
    ):
        parameters = {**code_values, **register_values, **answer_values}
        interface_and_values = (interface, frozenset(parameters.items()))
        if interface_and_values not in listed_sets:
            listed_sets.add(interface_and_values)
            sets_by_interface.setdefault(interface, []).append(resolve_parameters(parameters, definitions))
        if len(listed_sets) > MOST_SETS:
            break
    # An interface that no order code has is reported elsewhere. Its layouts are checked with the parameters of the
    # other interfaces.
    all_sets = [parameters for sets_of_interface in sets_by_interface.values() for parameters in sets_of_interface]
    return MappingProxyType(
        {interface: sets_of_interface or all_sets for interface, sets_of_interface in sets_by_interface.items()}
    )


def _states_of_registers(raw_spec: Raw) -> Sequence[State]:
    """Return the values of parameters in registers: the factory defaults, then extreme values of one or several.

    A state only contains the parameters that differ from the factory defaults. States with a single extreme value come
    first, so that messages name as few parameters as possible.
    """
    states_by_field = _extreme_states_in_spec(raw_spec)
    states: list[State] = [{}]
    for states_of_field in states_by_field:
        states += states_of_field
    if len(states_by_field) > 1:
        states += extreme_combinations(states_by_field)
    return states


def _values_set_by_codes(
    definitions: Mapping[str, Expression], variants: Sequence[Variant]
) -> Iterator[tuple[str, Mapping[str, int]]]:
    """Yield the interface and the parameters of each order code, without parameters that a formula calculates.

    Order codes with the same interface and the same values are yielded once.
    """
    parameters_by_interface_and_values: dict[tuple[str, tuple[int, ...]], Mapping[str, int]] = {}
    for variant in variants:
        parameters = {name: value for name, value in variant.parameters.items() if name not in definitions}
        parameters_by_interface_and_values.setdefault((variant.interface, tuple(parameters.values())), parameters)
    for (interface, _), parameters_of_code in parameters_by_interface_and_values.items():
        yield interface, parameters_of_code


def exceeds_work_limit(raw_spec: Raw, context: LayoutContext) -> bool:
    """Return whether checking a spec would take too long, and report it.

    Each field is placed once for each set of parameters, so the numbers of both are limited.
    """
    set_count = sum(map(len, context.parameter_sets_by_interface.values()))
    spec = WrittenSpec(dict(raw_spec))
    group_by_name = by_name(spec.field_groups)
    field_count = 0
    for fields in field_lists(spec):
        field_count += sum(1 for _ in with_groups_expanded(fields, group_by_name))
    if set_count <= MOST_SETS and set_count * field_count <= MOST_PLACES:
        return False
    set_count_text = f"more than {MOST_SETS}" if set_count > MOST_SETS else str(set_count)
    message = f"order codes, registers and alternatives combine to {set_count_text} sets of parameters"
    if set_count <= MOST_SETS:
        message += f", and there are {field_count} fields; the product must be at most {MOST_PLACES}"
    context.report.add("too-large", ("order_code", "parts"), f"{message}; split the family", at_key=True)
    return True
