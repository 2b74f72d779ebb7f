"""Parameters: parameters in registers at run time, the sets that order codes combine, and checks of expressions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from types import MappingProxyType

from ..language.problems import DocumentReport, quoted
from ..language.rules.parameters import all_parameters, parameter_uses
from ..language.rules.parts import by_name, field_lists, interface_of, with_groups_expanded
from ..language.rules.walk import leaves
from ..language.schema_files import is_second
from ..language.written_parts import WrittenSpec
from ..model import Alternative, CodedValue, Device, Interface, Layout, Parameter, Variant
from ..model.expressions import Expression, ExpressionError, resolve_parameters
from ..order_codes.parameters import State, coded_states, extreme_combinations
from .fields import LayoutContext, bit_range
from .from_mapping import Raw

_BITS_ENDING = "_bits"
_NAME_IN_TEXT = re.compile(r"[a-z][a-z0-9_]*")
#: Keys of texts in which the name of a parameter is only a word.
_KEYS_OF_PROSE = frozenset(("meaning", "note", "source", "title", "printed_name", "printed", "used", "why", "result"))


def check_named_widths(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report a parameter such as ``position_bits`` that differs from the width of ``position`` in a frame.

    Only a parameter with ``equals`` that the spec uses nowhere is checked. If another fact uses it, that fact would
    show a mistake in its formula.
    """
    if is_second(report.document.file):
        return
    if report.document.family:  # An older edition may lack what uses a parameter.
        return
    used_words = set(_used_words(raw_spec))
    for parameter in device.parameters:
        is_checked = parameter.equals is not None and parameter.name.endswith(_BITS_ENDING)
        if not is_checked or parameter.name in used_words:
            continue
        frames = ((interface, layout) for interface in device.interfaces for layout in interface.layouts)
        problems = (_describe_difference(device, parameter, interface, layout) for interface, layout in frames)
        problem = next(filter(None, problems), "")
        if problem:
            remedy = "correct 'equals', or rename the parameter if it is a different number"
            report.add("parameter-width", ("parameters", parameter.name, "equals"), f"{problem}; {remedy}")


def _used_words(raw_spec: Raw) -> Iterator[str]:
    """Yield every word of a spec that may refer to a parameter: in an expression, a condition or a key."""
    for path, value in leaves(raw_spec):
        # The definition of a parameter, below ``parameters.NAME``, is not a use of its name.
        keys_of_use = path[2:] if path[0] == "parameters" else path
        yield from (step for step in keys_of_use if isinstance(step, str))  # Without the indices in lists.
        if isinstance(value, str) and path[-1] not in _KEYS_OF_PROSE:
            yield from _NAME_IN_TEXT.findall(value)


def _describe_difference(device: Device, parameter: Parameter, interface: Interface, layout: Layout) -> str:
    """Return how a parameter differs from the width of the number of its name in a frame, or an empty string.

    It is empty if the encoder does not send a number of this name with this layout.
    """
    name = parameter.name.removesuffix(_BITS_ENDING)
    field_names = {field.name for field in layout.fields}
    has_number = field_names.issuperset(layout.names_in(name))
    if layout.sender != "encoder" or not has_number:
        return ""
    for variant in device.variants_over(interface.name):
        placed = layout.place(variant.parameters)
        placed_fields = placed.find_fields(layout.names_in(name))
        width = sum(field.width for field in placed_fields)
        value = variant.parameters.get(parameter.name)
        if placed_fields and value not in (None, width):
            return f"'{parameter.name}' is {value} for {variant.code}, but '{name}' in '{layout.name}' has {width} bits"
    return ""


def check_reach(raw_spec: Raw, context: LayoutContext, variants: Sequence[Variant]) -> bool:
    """Return True if every expression has a value. Report expressions without a value.

    An expression needs a value for each order code of the interface that uses it. A parameter with ``equals`` needs one
    for at least one order code.
    """
    problems_before = len(context.report)
    spec = WrittenSpec(dict(raw_spec))
    for path, interface, expression_text in parameter_uses(spec):
        parameter_names = list(all_parameters(expression_text, spec.parameters))
        definitions_of_parameters = [raw_spec["parameters"][name] for name in parameter_names]
        formulas_of_parameters = [raw["equals"] for raw in definitions_of_parameters if "equals" in raw]
        sets_of_interface = context.parameter_sets.get(interface, ())
        # A number is the same in each set.
        sets_to_check = sets_of_interface if parameter_names else sets_of_interface[:1]
        sets_and_expressions = product(sets_to_check, (expression_text, *formulas_of_parameters))
        problems = (_error_of_expression(expression, parameters) for parameters, expression in sets_and_expressions)
        first_problem = next(filter(None, problems), "")
        if first_problem:
            context.report.add("bad-expression", path, first_problem)
    for name, definition in raw_spec["parameters"].items():
        if "equals" not in definition:
            continue
        problem_of_each_code = [_error_of_expression(definition["equals"], variant.parameters) for variant in variants]
        if problem_of_each_code and all(problem_of_each_code):
            context.report.add("bad-expression", ("parameters", name, "equals"), problem_of_each_code[0])
    return len(context.report) == problems_before


def _error_of_expression(expression_text: int | str, parameters: Mapping[str, int]) -> str:
    """Return the reason why an expression has no value for these parameters, or an empty string.

    It is empty for an expression with a syntax error or an unknown parameter, which other rules report.
    """
    try:
        expression = Expression.parse(expression_text)
    except ExpressionError:
        return ""  # Reported by the rule on expressions.
    are_known = parameters.keys() >= set(expression.parameters)  # An unknown name is reported by the same rule.
    try:
        if are_known:
            expression.value(parameters)
    except ExpressionError as error:
        return str(error)
    return ""


def held_in_registers(raw_spec: Raw, report: DocumentReport) -> Mapping[str, int]:
    """Return the parameters held in registers at run time, with their default values, and check them.

    Parameters whose values the order code sets are not in the result. If the default cannot be found, the highest
    value, or 0 without one, stands for it, so that the rest of the spec can be checked.
    """
    defaults: dict[str, int] = {}
    names_set_by_codes = set_by_codes(raw_spec)
    for name, definition in raw_spec["parameters"].items():
        if "read_from" not in definition:
            continue
        register, field = _register_and_field(raw_spec, definition)
        if register is None or field is None:
            defaults[name] = definition.get("max", 0)  # reported by the rule on references
            continue
        low_and_width = _lowest_bit_and_width(field)
        if low_and_width is None:
            message = f"'{definition['read_from']}' must be placed with 'at' and a constant width"
            report.add("undefined-reference", ("parameters", name, "read_from"), message)
            defaults[name] = definition.get("max", 0)
            continue
        low_bit, width = low_and_width
        _check_codes(name, definition, width, report)
        if name in names_set_by_codes:
            _check_set_values(name, raw_spec, coded_values(definition), report)
        elif "default" not in register:
            message = f"the register of '{definition['read_from']}' has no default"
            report.add(
                "undefined-reference",
                ("parameters", name, "read_from"),
                f"{message}, so every order code must set {quoted(name)}",
            )
            defaults[name] = definition.get("max", 0)
        else:
            mask = (1 << width) - 1
            number = (register["default"] >> low_bit) & mask
            defaults[name] = _default_of_parameter(name, definition, number, field.get("zero_means", 0), report)
    return MappingProxyType(defaults)


def _register_and_field(raw_spec: Raw, definition: Raw) -> tuple[Raw | None, Raw | None]:
    """Return the register and the field that a parameter is read from, each None if it does not exist."""
    register_name, _, field_name = definition["read_from"].partition(".")
    registers = raw_spec.get("registers", ())
    register = next((candidate for candidate in registers if candidate["name"] == register_name), None)
    if register is None:
        return None, None
    return register, _find_raw_field(register, field_name)


def _default_of_parameter(
    name: str, definition: Raw, stored_number: int, zero_means: int, report: DocumentReport
) -> int:
    """Return the value of a parameter whose field has this number by default, and check it.

    A parameter with codes has the value of the code, or 0 if the number is not a code. ``zero_means`` is the value for
    which a stored zero stands, or 0.
    """
    codes_with_values = coded_values(definition)
    if codes_with_values:
        value = next((coded.value for coded in codes_with_values if coded.code == stored_number), None)
        if value is None:
            message = f"the default of '{definition['read_from']}' is {stored_number}"
            remedy = f"which is not a code of {quoted('by_code')}"
            report.add("default-does-not-fit", ("parameters", name), f"{message}, {remedy}")
        return value or 0
    value = stored_number or zero_means
    lowest, highest = definition.get("min", 0), definition.get("max", value)
    if not lowest <= value <= highest:
        message = f"the default of '{definition['read_from']}' is {value}, not between 'min' and 'max'"
        report.add("default-does-not-fit", ("parameters", name), message)
    return value


def coded_values(definition: Raw) -> tuple[CodedValue, ...]:
    """Return the codes of a parameter in a register with their values, in the order of the codes."""
    values = (CodedValue(int(code, 0), value) for code, value in definition.get("by_code", {}).items())
    return tuple(sorted(values, key=lambda coded: coded.code))


def extreme_states(raw_spec: Raw) -> Sequence[Sequence[State]]:
    """Return the states of each register field that must fit: the limits of its parameter, or each of its codes.

    There is one list for each parameter with limits, such as ``[{"offset": 0}, {"offset": 15}]``, and one for each
    field with codes, which can hold several parameters.
    """
    states_of_limits: list[list[State]] = []
    codes_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    for name, definition in raw_spec["parameters"].items():
        field = definition.get("read_from")
        if field is not None and "by_code" in definition:
            values_by_code = {coded.code: coded.value for coded in coded_values(definition)}
            codes_by_field.setdefault(field, {})[name] = values_by_code
        elif field is not None:
            limits = [definition[key] for key in ("min", "max") if key in definition]
            states_of_limits.append([{name: limit} for limit in limits])
    return [*states_of_limits, *map(coded_states, codes_by_field.values())]


def set_by_codes(raw_spec: Raw) -> frozenset[str]:
    """Return the names of the parameters that values of the order code set."""
    parameter_names: set[str] = set()
    for part in raw_spec["order_code"]["parts"]:
        for code_value in part["values"].values():
            parameter_names.update((code_value or {}).get("sets", ()))
    return frozenset(parameter_names)


def _check_set_values(name: str, raw_spec: Raw, codes: Sequence[CodedValue], report: DocumentReport) -> None:
    """Check that order codes set only values that the register can hold, which are the values with a code.

    Without codes, nothing is checked.
    """
    values_with_code = {coded.value for coded in codes}
    for index, part in enumerate(raw_spec["order_code"]["parts"]):
        for text_of_value, code_value in part["values"].items():
            value_set = (code_value or {}).get("sets", {}).get(name)
            if values_with_code and value_set is not None and value_set not in values_with_code:
                path = ("order_code", "parts", index, "values", text_of_value, "sets", name)
                report.add(
                    "default-does-not-fit", path, f"{value_set} is not one of the values in 'by_code' of {quoted(name)}"
                )


def _check_codes(name: str, definition: Raw, width: int, report: DocumentReport) -> None:
    """Check that each code fits into the field and is unique. The codes are texts such as ``0x10``."""
    first_text_by_code: dict[int, str] = {}
    for code_text in definition.get("by_code", {}):
        code = int(code_text, 0)  # Base 0 reads 0x10 as hexadecimal.
        path = ("parameters", name, "by_code", code_text)
        has_too_many_bits = code >> width != 0
        if has_too_many_bits:
            message = f"the code {code_text} does not fit into the {width} bits of '{definition['read_from']}'"
            report.add("value-too-wide", path, message, at_key=True)
        elif code in first_text_by_code:
            report.add(
                "value-clash",
                path,
                f"{first_text_by_code[code]} and {code_text} are the same code; keep one",
                at_key=True,
            )
        first_text_by_code.setdefault(code, code_text)


def _find_raw_field(register: Raw, field_name: str) -> Raw | None:
    """Return a field of a register as in the spec, or None if the field does not exist.

    A register without fields is one number, whose field has the name of the register. If the register uses a group, any
    other name may be a field of the group. The result is then empty.
    """
    if "fields" not in register:
        highest_bit = 8 * register["length"] - 1
        return {"name": field_name, "at": f"{highest_bit}:0"} if field_name == register["name"] else None
    own_fields = [field for field in register["fields"] if "use" not in field]
    field_of_group: Raw | None = {} if len(own_fields) < len(register["fields"]) else None
    return next((field for field in own_fields if field.get("name") == field_name), field_of_group)


def _lowest_bit_and_width(field: Raw) -> tuple[int, int] | None:
    """Return the lowest bit and the width of a field, such as ``(0, 8)`` for ``at: 7:0``.

    Return None for a field without a valid ``at``, or with a width that is an expression.
    """
    bounds = bit_range(field["at"]) if "at" in field else None
    if bounds is None:
        return None
    high, low = bounds
    width = field.get("bits", high - low + 1)
    return (low, width) if isinstance(width, int) else None


#: Largest number of sets of parameters, and of fields times sets. The largest manuals need 200 and 20,000.
MOST_SETS = 20_000
MOST_PLACES = 500_000


def parameter_sets(
    raw_spec: Raw,
    definitions: Mapping[str, Expression],
    variants: Sequence[Variant],
    alternatives: Sequence[Alternative],
) -> Mapping[str, Sequence[Mapping[str, int]]]:
    """Return, by interface, every set of parameters that a layout must support.

    These are the sets of the order codes, the bounds of parameters held in registers, one by one and together, and each
    of these with the default answers, and with each other answer of one alternative.
    """
    interface_names = (*raw_spec["interfaces"], *map(interface_of, WrittenSpec(dict(raw_spec)).registers))
    if not variants:  # Parameters are unknown. Parts that do not use them can still be checked.
        return MappingProxyType({kind: ({},) for kind in interface_names})
    sets_by_interface: dict[str, list[Mapping[str, int]]] = {kind: [] for kind in interface_names}
    values_of_answers: list[Mapping[str, int]] = [{}]
    for alternative in alternatives:
        # The first answer is the default, which the order codes already have.
        values_of_answers += [answer.sets for answer in alternative.answers[1:]]
    states_by_field = extreme_states(raw_spec)
    # One by one first, so that messages name as few parameters as possible.
    single_states = (register_state for states in states_by_field for register_state in states)
    combined_states = extreme_combinations(states_by_field) if len(states_by_field) > 1 else ()
    register_states: list[State] = [{}, *single_states, *combined_states]
    known_sets: set[tuple[str, tuple[int, ...]]] = set()
    sets_by_codes = _without_definitions(definitions, variants)
    for (kind, set_by_code), register_state, values_of_answer in product(
        sets_by_codes, register_states, values_of_answers
    ):
        parameters = {**set_by_code, **register_state, **values_of_answer}
        # The parameters of an interface are always in the same order, so their values identify a set.
        interface_and_values = (kind, tuple(parameters.values()))
        if interface_and_values not in known_sets:
            known_sets.add(interface_and_values)
            sets_by_interface.setdefault(kind, []).append(resolve_parameters(parameters, definitions))
        # too_much_work reports the spec.
        if len(known_sets) > MOST_SETS:
            break
    # An interface that no order code selects has been reported. Its layouts are checked with the parameters of the
    # other interfaces.
    all_sets = [parameters for sets in sets_by_interface.values() for parameters in sets]
    return MappingProxyType({kind: sets or all_sets for kind, sets in sets_by_interface.items()})


def _without_definitions(
    definitions: Mapping[str, Expression], variants: Sequence[Variant]
) -> Iterator[tuple[str, Mapping[str, int]]]:
    """Yield the interface and the parameters of each order code, without derived parameters.

    Order codes with the same interface and values count once.
    """
    base_by_values: dict[tuple[str, tuple[int, ...]], Mapping[str, int]] = {}
    for variant in variants:
        base = {name: value for name, value in variant.parameters.items() if name not in definitions}
        base_by_values.setdefault((variant.interface, tuple(base.values())), base)
    yield from ((interface, base) for (interface, _), base in base_by_values.items())


def too_much_work(raw_spec: Raw, context: LayoutContext) -> bool:
    """Report a spec for which each field would be placed too often, and return True. Otherwise, return False.

    Each field is placed once for each set of parameters.
    """
    number_of_sets = sum(map(len, context.parameter_sets.values()))
    spec = WrittenSpec(dict(raw_spec))
    groups = by_name(spec.field_groups)
    number_of_fields = 0
    for fields in field_lists(spec):
        number_of_fields += sum(1 for _ in with_groups_expanded(fields, groups))
    if number_of_sets <= MOST_SETS and number_of_sets * number_of_fields <= MOST_PLACES:
        return False
    number_text = f"more than {MOST_SETS}" if number_of_sets > MOST_SETS else str(number_of_sets)
    message = f"order codes, registers and alternatives combine to {number_text} sets of parameters"
    if number_of_sets <= MOST_SETS:
        message += f", and there are {number_of_fields} fields; the product must be at most {MOST_PLACES}"
    context.report.add("too-large", ("order_code", "parts"), f"{message}; split the family", at_key=True)
    return True
