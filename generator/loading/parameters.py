"""Parameters: those in registers at run time, the sets that order codes combine, and checks of expressions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from types import MappingProxyType

from ..language.problems import DocumentReport, quoted
from ..language.rules.parameters import all_parameters, uses
from ..language.rules.walk import by_name, expanded, field_lists, interface_of, leaves
from ..language.schema_files import is_second
from ..language.written_parts import WrittenSpec
from ..model import Alternative, CodedValue, Device, Interface, Layout, Parameter, Variant
from ..model.expressions import Expression, ExpressionError
from ..order_codes.parameters import State, coded_states, corners, resolve_parameters
from .fields import Context, bit_range
from .from_mapping import Raw

_ENDING = "_bits"
_WORD = re.compile(r"[a-z][a-z0-9_]*")
#: Keys of texts in which the name of a parameter is only a word.
_PROSE = frozenset(("meaning", "note", "source", "title", "printed_name", "printed", "used", "why", "result"))


def check_named_widths(raw: Raw, device: Device, report: DocumentReport) -> None:
    """Report a parameter such as ``position_bits`` that differs from the width of ``position`` in a frame.

    Other facts would show a mistake in a formula that they use, so this checks only parameters without a use.
    """
    if is_second(report.document.file):
        return
    if report.document.family:  # An older edition may lack what uses a parameter.
        return
    used_words = set(_used_words(raw))
    for parameter in device.parameters:
        is_checked = parameter.equals is not None and parameter.name.endswith(_ENDING)
        if not is_checked or parameter.name in used_words:
            continue
        frames = ((interface, layout) for interface in device.interfaces for layout in interface.layouts)
        problem = next(filter(None, (_difference(device, parameter, *frame) for frame in frames)), "")
        if problem:
            remedy = "correct 'equals', or rename the parameter if it is another number"
            report.add("parameter-width", ("parameters", parameter.name, "equals"), f"{problem}; {remedy}")


def _used_words(raw: Raw) -> Iterator[str]:
    """Yield every word of a spec that may refer to a parameter: in an expression, a condition or a key."""
    for path, value in leaves(raw):
        keys = path[2:] if path[0] == "parameters" else path
        yield from (step for step in keys if isinstance(step, str))
        if isinstance(value, str) and path[-1] not in _PROSE:
            yield from _WORD.findall(value)


def _difference(device: Device, parameter: Parameter, interface: Interface, layout: Layout) -> str:
    """Return how the parameter differs from the width of the number in a frame, or an empty text."""
    name = parameter.name.removesuffix(_ENDING)
    if layout.sender != "encoder" or not {field.name for field in layout.fields}.issuperset(layout.names_in(name)):
        return ""
    for variant in device.variants_over(interface.name):
        placed = layout.place(variant.parameters)
        fields = placed.find_fields(layout.names_in(name))
        width, value = sum(field.width for field in fields), variant.parameters.get(parameter.name)
        if fields and value not in (None, width):
            return f"'{parameter.name}' is {value} for {variant.code}, but '{name}' in '{layout.name}' has {width} bits"
    return ""


def check_reach(raw: Raw, context: Context, variants: Sequence[Variant]) -> bool:
    """Report expressions without a value for an order code of their interface, and parameters that never have one."""
    problems_before = len(context.report)
    spec = WrittenSpec(dict(raw))
    for path, interface, text in uses(spec):
        names = list(all_parameters(text, spec.parameters))
        formulas = [raw["parameters"][name]["equals"] for name in names if "equals" in raw["parameters"][name]]
        sets = context.parameter_sets.get(interface, ())
        # A number has the same value in each set.
        needed_sets = sets if names else sets[:1]
        pairs = product(needed_sets, (text, *formulas))
        problem = next(filter(None, (_fault(expression, parameters) for parameters, expression in pairs)), "")
        if problem:
            context.report.add("bad-expression", path, problem)
    for name, definition in raw["parameters"].items():
        if "equals" not in definition:
            continue
        problems = [_fault(definition["equals"], variant.parameters) for variant in variants]
        if problems and all(problems):
            context.report.add("bad-expression", ("parameters", name, "equals"), problems[0])
    return len(context.report) == problems_before


def _fault(text: int | str, parameters: Mapping[str, int]) -> str:
    try:
        expression = Expression.parse(text)
    except ExpressionError:
        return ""  # Reported by the rule on expressions.
    try:
        if parameters.keys() >= set(expression.parameters):  # Another name is reported by the rule on expressions.
            expression.value(parameters)
    except ExpressionError as error:
        return str(error)
    return ""


def held_in_registers(raw: Raw, report: DocumentReport) -> Mapping[str, int]:
    """Return the parameters held in registers at run time, with their default values.

    Parameters whose values the order code sets are not in the result.
    """
    defaults: dict[str, int] = {}
    by_order_code = set_by_codes(raw)
    for name, definition in raw["parameters"].items():
        if "read_from" not in definition:
            continue
        register, field = _register_and_field(raw, definition)
        if register is None or field is None:
            defaults[name] = definition.get("max", 0)  # reported by the rule on references
            continue
        place = _place(field)
        if place is None:
            message = f"'{definition['read_from']}' must be placed with 'at' and a constant width"
            report.add("undefined-reference", ("parameters", name, "read_from"), message)
            defaults[name] = definition.get("max", 0)
            continue
        low, width = place
        _check_codes(name, definition, width, report)
        if name in by_order_code:
            _check_set_values(name, raw, coded_values(definition), report)
        elif "default" not in register:
            message = f"the register of '{definition['read_from']}' has no default"
            report.add(
                "undefined-reference",
                ("parameters", name, "read_from"),
                f"{message}, so every order code must set {quoted(name)}",
            )
            defaults[name] = definition.get("max", 0)
        else:
            number = register["default"] >> low & ((1 << width) - 1)
            defaults[name] = _default(name, definition, number, field.get("zero_means", 0), report)
    return MappingProxyType(defaults)


def _register_and_field(raw: Raw, definition: Raw) -> tuple[Raw | None, Raw | None]:
    """Return the register and the field that a parameter is read from, each None if it does not exist."""
    register_name, _, field_name = definition["read_from"].partition(".")
    registers = raw.get("registers", ())
    register = next((candidate for candidate in registers if candidate["name"] == register_name), None)
    return register, _field(register, field_name) if register is not None else None


def _default(name: str, definition: Raw, number: int, zero_means: int, report: DocumentReport) -> int:
    """Return the value of a parameter whose field has this number by default, and check it."""
    codes = coded_values(definition)
    if codes:
        value = next((coded.value for coded in codes if coded.code == number), None)
        if value is None:
            message = f"the default of '{definition['read_from']}' is {number}"
            remedy = f"which is not a code of {quoted('by_code')}"
            report.add("default-does-not-fit", ("parameters", name), f"{message}, {remedy}")
        return value or 0
    value = number or zero_means
    if not definition.get("min", 0) <= value <= definition.get("max", value):
        message = f"the default of '{definition['read_from']}' is {value}, not between 'min' and 'max'"
        report.add("default-does-not-fit", ("parameters", name), message)
    return value


def coded_values(definition: Raw) -> tuple[CodedValue, ...]:
    """Return the codes of a parameter in a register with their values, in the order of the codes."""
    values = (CodedValue(int(code, 0), value) for code, value in definition.get("by_code", {}).items())
    return tuple(sorted(values, key=lambda coded: coded.code))


def extreme_states(raw: Raw) -> Sequence[Sequence[State]]:
    """Return the states of each register field that must fit: the limits of its parameter, or each of its codes."""
    limits: list[list[State]] = []
    codes_by_field: dict[str, dict[str, Mapping[int, int]]] = {}
    for name, definition in raw["parameters"].items():
        field = definition.get("read_from")
        if field is not None and "by_code" in definition:
            values_by_code = {coded.code: coded.value for coded in coded_values(definition)}
            codes_by_field.setdefault(field, {})[name] = values_by_code
        elif field is not None:
            limits.append([{name: definition[key]} for key in ("min", "max") if key in definition])
    return [*limits, *map(coded_states, codes_by_field.values())]


def set_by_codes(raw: Raw) -> frozenset[str]:
    """Return the parameters that an order code sets."""
    names: set[str] = set()
    for part in raw["order_code"]["parts"]:
        for value in part["values"].values():
            names.update((value or {}).get("sets", ()))
    return frozenset(names)


def _check_set_values(name: str, raw: Raw, codes: Sequence[CodedValue], report: DocumentReport) -> None:
    """Check that order codes set values that the register can hold."""
    known_values = {coded.value for coded in codes}
    for index, part in enumerate(raw["order_code"]["parts"]):
        for text, value in part["values"].items():
            number = (value or {}).get("sets", {}).get(name)
            if known_values and number is not None and number not in known_values:
                path = ("order_code", "parts", index, "values", text, "sets", name)
                report.add(
                    "default-does-not-fit", path, f"{number} is not one of the values in 'by_code' of {quoted(name)}"
                )


def _check_codes(name: str, definition: Raw, width: int, report: DocumentReport) -> None:
    """Check that each code fits into the field and is unique."""
    texts: dict[int, str] = {}
    for text in definition.get("by_code", {}):
        code = int(text, 0)
        path = ("parameters", name, "by_code", text)
        if code >> width:
            message = f"the code {text} does not fit into the {width} bits of '{definition['read_from']}'"
            report.add("value-too-wide", path, message, at_key=True)
        elif code in texts:
            report.add("value-clash", path, f"{texts[code]} and {text} are the same code; keep one", at_key=True)
        texts.setdefault(code, text)


def _field(register: Raw, name: str) -> Raw | None:
    """Return the field of a register as in the spec.

    A register without fields is one number. A field of a group is empty.
    """
    if "fields" not in register:
        return {"name": name, "at": f"{8 * register['length'] - 1}:0"} if name == register["name"] else None
    own_fields = [field for field in register["fields"] if "use" not in field]
    of_group: Raw | None = {} if len(own_fields) < len(register["fields"]) else None
    return next((field for field in own_fields if field.get("name") == name), of_group)


def _place(field: Raw) -> tuple[int, int] | None:
    """Return low bit and width of a field, or None if they are not plain numbers."""
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
    raw: Raw, definitions: Mapping[str, Expression], variants: Sequence[Variant], alternatives: Sequence[Alternative]
) -> Mapping[str, Sequence[Mapping[str, int]]]:
    """Return, by interface, every set of parameters that a layout must support.

    These are the sets of the order codes, the bounds of parameters held in registers, one by one and together, and each
    of these with each answer of an alternative.
    """
    kinds = (*raw["interfaces"], *map(interface_of, raw.get("registers", ())))
    if not variants:  # Parameters are unknown. Parts that do not use them can still be checked.
        return MappingProxyType({kind: ({},) for kind in kinds})
    sets_by_interface: dict[str, list[Mapping[str, int]]] = {kind: [] for kind in kinds}
    answers: list[Mapping[str, int]] = [{}]
    for alternative in alternatives:
        answers += [answer.sets for answer in alternative.answers[1:]]
    fields = extreme_states(raw)
    # One by one first, so that messages name as few parameters as possible.
    singles = (state for states in fields for state in states)
    register_states: list[State] = [{}, *singles, *(corners(fields) if len(fields) > 1 else ())]
    known_keys: set[tuple[str, tuple[int, ...]]] = set()
    bases = _without_definitions(definitions, variants)
    for (kind, base), state, answer in product(bases, register_states, answers):
        parameters = {**base, **state, **answer}
        key = (kind, tuple(parameters.values()))
        if key not in known_keys:
            known_keys.add(key)
            sets_by_interface.setdefault(kind, []).append(resolve_parameters(parameters, definitions))
        if len(known_keys) > MOST_SETS:
            break
    # An interface that no order code selects has been reported. Its layouts are checked with the parameters of the
    # others.
    all_sets = [parameters for sets in sets_by_interface.values() for parameters in sets]
    return MappingProxyType({kind: sets or all_sets for kind, sets in sets_by_interface.items()})


def _without_definitions(
    definitions: Mapping[str, Expression], variants: Sequence[Variant]
) -> Iterator[tuple[str, Mapping[str, int]]]:
    """Yield the interface and the parameters that order codes set, without those that follow from others, each once."""
    base_by_values: dict[tuple[str, tuple[int, ...]], Mapping[str, int]] = {}
    for variant in variants:
        base = {name: value for name, value in variant.parameters.items() if name not in definitions}
        base_by_values.setdefault((variant.interface, tuple(base.values())), base)
    yield from ((interface, base) for (interface, _), base in base_by_values.items())


def too_much_work(raw: Raw, context: Context) -> bool:
    """Report a spec for which each field would be placed too often, as it is for each set of parameters."""
    sets = sum(map(len, context.parameter_sets.values()))
    groups = by_name(raw, "field_groups")
    fields = sum(1 for owner in field_lists(dict(raw)) for _ in expanded(owner, groups))
    if sets <= MOST_SETS and sets * fields <= MOST_PLACES:
        return False
    number = f"more than {MOST_SETS}" if sets > MOST_SETS else str(sets)
    message = f"order codes, registers and alternatives combine to {number} sets of parameters"
    if sets <= MOST_SETS:
        message += f", and there are {fields} fields; the product must be at most {MOST_PLACES}"
    context.report.add("too-large", ("order_code", "parts"), f"{message}; split the family", at_key=True)
    return True
