"""Rules for parameters and alternatives: the origin of their values, the places that may use them, and units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.expressions import Expression, ExpressionError, Factor
from ..problems import DocumentReport, Path, join_words, quoted
from ..written_codes import WrittenAlternative, WrittenParameter, WrittenRegister
from ..written_interfaces import WrittenBiss, WrittenSpi
from ..written_layouts import WrittenField
from ..written_parts import WrittenSpec
from .name_resolver import NameResolver
from .parts import (
    FieldList,
    FieldOwner,
    PlacedPart,
    WrittenInterface,
    by_name,
    field_lists,
    interface_of,
    interfaces,
    layouts_of_interfaces,
    measurements,
    origins_of,
    with_groups_expanded,
)

#: Quantities by their units as manuals name them. Other units are used unchanged.
_KINDS = {
    "bits": ("bit", "bits"),
    "micrometres": ("um", "µm", "μm", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"),
    "nanometres": ("nm", "nanometre", "nanometres", "nanometer", "nanometers"),
    "another length": ("mm", "cm", "m", "millimetre", "millimetres", "millimeters", "inch", "inches"),
    "revolutions": ("revolution", "revolutions", "turn", "turns", "rev", "revs"),
    "counts": ("count", "counts", "step", "steps", "position", "positions", "increments"),
}
_KIND_OF = {unit: kind for kind, units in _KINDS.items() for unit in units}
#: Keys of fields whose expressions are in bits.
_KEYS_IN_BITS = ("bits", "low_bit")
#: Quantity of each number of a measurement.
_QUANTITY_OF_KEY = {
    "counts_per_turn": "counts",
    "turns": "revolutions",
    "step_um": "micrometres",
    "step_nm": "nanometres",
    "per_counts": "counts",
    "modulus": "counts",
    "highest": "counts",
}


def kind_of_unit(unit: str) -> str:
    """Return the quantity of a unit, or the unit itself if it is not known."""
    return _KIND_OF.get(unit, unit)


def check_parameter_interface(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an expression of one interface uses no parameter of another, directly or through other parameters."""
    for path, interface, text in parameter_uses(spec):
        for name in dict.fromkeys(all_parameters(text, spec.with_invalid_parts.parameters)):
            owner_interface = spec.with_invalid_parts.parameters[name].interface
            if owner_interface is not None and owner_interface != interface:
                report.add(
                    "parameter-interface",
                    path,
                    f"{quoted(name)} is only for {owner_interface} (see its 'interface'), but this is {interface}",
                )
                break


#: An expression as written, with its path.
_Expressions = Iterator[tuple[Path, int | str]]


def expressions(spec: WrittenSpec) -> _Expressions:
    """Yield every expression of a spec, with the expressions of groups once."""
    for part in spec.order_code.parts:
        yield from _expressions_under(part, ("label_is",))
    for parameter in spec.parameters.values():
        yield from _expressions_under(parameter, ("equals",))
    for field_list in field_lists(spec):
        for field in field_list.fields:
            yield from _of_field(field, field.path)
    for register in spec.registers:
        for limited in (register, *register.meanings):
            yield from _expressions_under(limited, ("min", "max"))
    for measurement in measurements(spec):
        yield from _expressions_under(measurement, _QUANTITY_OF_KEY)
    for field_list in layouts_of_interfaces(spec):
        yield from _of_position_range(field_list)
        yield from _of_gray_code(field_list, ("excess",))
    for _, interface in interfaces(spec):
        yield from _of_interface(interface)


class ParameterUse(NamedTuple):
    """An expression or a parameter, its place, and an interface that uses it."""

    path: Path
    interface: str
    text: int | str


def parameter_uses(spec: WrittenSpec) -> Iterator[ParameterUse]:
    """Yield each use of an expression or parameter by an interface.

    A field of a group is yielded for each layout or register that uses the group.
    """
    groups = by_name(spec.with_invalid_parts.field_groups)
    field_owners = list(layouts_of_interfaces(spec))
    field_owners += [FieldList(FieldOwner.REGISTER, register, interface_of(register)) for register in spec.registers]
    for field_list in field_owners:
        for path, field in with_groups_expanded(field_list, groups):
            yield from _used_by(field_list.interface, _of_field(field, path))
        yield from _used_by(field_list.interface, _of_owner(field_list))
    for name, interface in interfaces(spec):
        # A measurement of the device applies to each interface without its own.
        measurement = interface.measurement if interface.has("measurement") else spec.measurement
        if measurement is not None:
            yield from _used_by(name, _expressions_under(measurement, _QUANTITY_OF_KEY))
        yield from _used_by(name, _of_interface(interface))


def _used_by(interface: str, expressions: _Expressions) -> Iterator[ParameterUse]:
    """Yield expressions with the interface that uses them."""
    for path, text in expressions:
        yield ParameterUse(path=path, interface=interface, text=text)


def _of_owner(field_list: FieldList) -> _Expressions:
    """Yield the limits of a register, or the position range and the Gray code of a layout."""
    if isinstance(field_list.owner, WrittenRegister):
        for limited in (field_list.owner, *field_list.owner.meanings):
            yield from _expressions_under(limited, ("min", "max"))
    yield from _of_position_range(field_list)
    yield from _of_gray_code(field_list, ("when", "excess"))


def _of_gray_code(field_list: FieldList, keys: Iterable[str]) -> _Expressions:
    """Yield the expressions under these keys of the Gray code of a layout. The one under ``when`` is a parameter."""
    if field_list.layout is not None and field_list.layout.gray is not None:
        yield from _expressions_under(field_list.layout.gray, keys)


def _of_position_range(field_list: FieldList) -> _Expressions:
    """Yield the numbers of the range that a layout has for itself."""
    if field_list.layout is not None and field_list.layout.position_range is not None:
        yield from _expressions_under(field_list.layout.position_range, _QUANTITY_OF_KEY)


def _expressions_under(owner: PlacedPart, keys: Iterable[str]) -> _Expressions:
    """Yield the expressions under these keys of a part. The schema allows only numbers and texts there."""
    for key in keys:
        text = owner.data.get(key)
        if isinstance(text, (int, str)):
            yield (*owner.path, key), text


def _of_interface(interface: WrittenInterface) -> _Expressions:
    """Yield the lengths of words over SPI, and the number of bits that data channels over BiSS compare."""
    if isinstance(interface, WrittenSpi):
        for owner in (interface, *interface.exchanges):
            yield from _expressions_under(owner, ("word_bits",))
    if isinstance(interface, WrittenBiss) and interface.channels is not None:
        yield from _expressions_under(interface.channels, ("compared_bits",))


def _of_field(field: WrittenField, path: Path) -> _Expressions:
    """Yield the expressions of a field, placed at ``path``. ``equals`` of a text field is text, not an expression."""
    keys = ("bits", "low_bit") if field.has("text") else ("bits", "low_bit", "equals")
    return (((*path, key), field.data[key]) for key in keys if key in field.data)


#: Most terms of a sum of parameters, with all definitions inserted.
_MOST_TERMS = 256


def all_parameters(expression_text: object, parameters: Mapping[str, WrittenParameter]) -> Iterator[str]:
    """Yield the parameters in an expression, and in the expressions that define these parameters, each once."""
    factors_to_visit = _list_factors(expression_text)
    visited_names: set[str] = set()
    # The list grows during the loop, so that parameters named directly come before those that define them.
    for factor in factors_to_visit:
        name = factor.parameter
        if name not in visited_names and name in parameters:
            visited_names.add(name)
            yield name
            # A parameter without ``equals`` adds no factors.
            factors_to_visit += _list_factors(parameters[name].equals)


def _list_factors(expression_text: object) -> list[Factor]:
    """Return the factors of all terms of an expression as it is written, or none if it is not valid.

    ``bits + bits`` has the factor twice, although it is one term.
    """
    if not isinstance(expression_text, (int, str)):
        return []
    try:
        terms = Expression.parse(expression_text).terms
    except ExpressionError:  # Reported by the rule on expressions.
        return []
    return [factor for term in terms for factor in term.factors * abs(term.multiple)]


def check_long_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no parameter becomes a long sum when the definitions of its parameters are inserted.

    Definitions that use others twice each would fill the memory: 30 of them are a sum of 2^30 terms.
    """
    terms_by_name: dict[str, int] = {}
    for name, parameter in spec.parameters.items():
        term_count = _count_of_terms(name, spec.parameters, terms_by_name)
        # Then that parameter is reported, and not those that use it.
        has_long_parameter = any(
            terms_by_name.get(factor.parameter, 0) > _MOST_TERMS for factor in _list_factors(parameter.equals)
        )
        if term_count > _MOST_TERMS and not has_long_parameter:
            problem = f"{quoted(name)} is a sum of {term_count} terms with the definitions of its parameters"
            report.add("bad-expression", parameter.place_of("equals"), f"{problem}; the limit is {_MOST_TERMS}")


def _count_of_terms(parameter_name: str, parameters: Mapping[str, WrittenParameter], counts: dict[str, int]) -> int:
    """Return the number of terms of a parameter with all definitions inserted, which ``counts`` keeps by name.

    Each factor of a product counts like a term, and a parameter without a definition as one.
    """
    if parameter_name in counts:
        return counts[parameter_name]
    counts[parameter_name] = 1  # This ends a cycle, which another rule reports.
    factors = _list_factors(parameters[parameter_name].equals) if parameter_name in parameters else []
    if factors:
        counts[parameter_name] = sum(_count_of_terms(factor.parameter, parameters, counts) for factor in factors)
    return counts[parameter_name]


def check_parameter_origin(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the value of a parameter has at most one origin, and that ``by_code`` occurs only with ``read_from``.

    ``by_code`` lists the value for each code in the register, so it excludes limits.
    """
    for name, parameter in spec.parameters.items():
        origins = origins_of(parameter)
        if len(origins) > 1:
            problem = f"{join_words(map(quoted, origins))} each define {quoted(name)}; keep one"
            report.add("parameter-origin", parameter.place_of(origins[1]), problem, at_key=True)
        if not parameter.by_code:
            continue
        limit_keys = [key for key in ("min", "max") if parameter.has(key)]
        if not parameter.read_from:
            problem = "'by_code' needs 'read_from', the register field that holds the code"
            report.add("parameter-origin", parameter.place_of("by_code"), problem, at_key=True)
        elif limit_keys:
            problem = f"'by_code' already lists the values of {quoted(name)}; leave out {quoted(limit_keys[0])}"
            report.add("parameter-origin", parameter.place_of(limit_keys[0]), problem, at_key=True)


def check_alternative_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the answers of an alternative set the same parameters, and that these name the alternative.

    Parameters and examples must name alternatives that exist, and examples their answers.
    """
    resolver = NameResolver(spec, report)
    alternatives = by_name(spec.with_invalid_parts.alternatives)
    for alternative in spec.alternatives:
        parameters_as_read = spec.with_invalid_parts.parameters.items()
        own_parameters = [name for name, parameter in parameters_as_read if parameter.alternative == alternative.name]
        _check_answers(alternative, own_parameters, resolver)
    for name, parameter in spec.parameters.items():
        path = parameter.place_of("alternative")
        resolver.refer_if_given(path, "alternative", parameter.alternative, alternatives)
        alternative_of_parameter = alternatives.get(parameter.alternative)
        if alternative_of_parameter is not None and not _is_set(name, alternative_of_parameter):
            problem = f"no answer of {quoted(parameter.alternative)} sets {quoted(name)}"
            report.add("undefined-reference", path, problem)
    for example in spec.examples:
        for name, answer in example.alternatives.items():
            answer_path = (*example.path, "alternatives", name)
            resolver.refer(answer_path, "alternative", name, alternatives)
            if name in alternatives:
                answers = alternatives[name].names_in("values")
                resolver.refer(answer_path, f"answer of {quoted(name)} called", answer, answers)


def _is_set(parameter_name: str, alternative: WrittenAlternative) -> bool:
    """Return True if any answer of an alternative sets a parameter."""
    return any(parameter_name in answer.names_in("sets") for answer in alternative.values.values())


def _check_answers(alternative: WrittenAlternative, own_parameters: Sequence[str], resolver: NameResolver) -> None:
    """Check that each answer of an alternative sets all its parameters, and no others.

    A parameter that no answer sets is reported elsewhere.
    """
    owner = alternative.name
    first_answers: dict[str, str] = {}  # For each parameter, the first answer that sets it.
    for answer_name, answer in alternative.values.items():
        for name in answer.sets:
            first_answers.setdefault(name, answer_name)
    for answer_name, answer in alternative.values.items():
        sets_path = answer.place_of("sets")
        for name in answer.sets:
            resolver.refer((*sets_path, name), "parameter", name)
            if name in resolver.parameter_names and name not in own_parameters:
                problem = f"{quoted(name)} is not a parameter of {quoted(owner)}; give it 'alternative: {owner}'"
                resolver.report_problem((*sets_path, name), problem)
        for name in own_parameters:
            if name in first_answers and name not in answer.sets:
                first_answer = quoted(first_answers[name])
                problem = f"{quoted(answer_name)} does not set {quoted(name)}, which {first_answer} sets"
                resolver.report_problem(sets_path, problem)


def check_alternative_use(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that alternatives affect only the places of fields, because generated code can use them only there.

    Alternatives with a default affect only verdicts, which do not need a choice. So their parameters are in no
    expression.
    """
    alternatives = by_name(spec.with_invalid_parts.alternatives)
    set_by_alternative = {
        name: parameter for name, parameter in spec.with_invalid_parts.parameters.items() if parameter.alternative
    }
    used_texts = list(expressions(spec))
    # The parameter under 'when', which turns Gray code on, is not an expression.
    used_texts += [(use.path, use.text) for use in parameter_uses(spec) if use.path[-1] == "when"]
    for path, text in used_texts:
        names = [factor.parameter for factor in _list_factors(text) if factor.parameter in set_by_alternative]
        if not names:
            continue
        alternative_name = set_by_alternative[names[0]].alternative
        alternative = alternatives.get(alternative_name)
        problem = f"{quoted(names[0])} is set by the alternative {quoted(alternative_name)}"
        if path[-1] not in _KEYS_IN_BITS:
            remedy = "use it only in 'bits' or 'low_bit' of a field"
            message = f"{problem}, so only frames and registers can depend on it; {remedy}"
            report.add("alternative-use", path, message)
        elif alternative is not None and alternative.has("default"):
            alternative_text = quoted(alternative_name)
            remedy = f"use it only in 'makes_position_if' of a flag, or remove 'default' from {alternative_text}"
            report.add("alternative-use", path, f"{problem}, whose default applies without a choice; {remedy}")


def check_units(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check the units of fields that equal a parameter, and of the parameters in expressions.

    A field and its parameter have units of the same quantity, and each unknown unit counts as a separate quantity.
    Exponents and widths are in bits, and numbers of a measurement in its units. There, unknown units are not checked.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            # None unless ``equals`` is only the name of a parameter.
            equal_parameter = spec.with_invalid_parts.parameters.get(str(field.equals))
            equal_unit = equal_parameter.unit if equal_parameter is not None else ""
            if field.unit and equal_unit and kind_of_unit(field.unit) != kind_of_unit(equal_unit):
                problem = f"{quoted(field.name)} is in {field.unit}, but it equals {quoted(field.equals)}"
                report.add("unit-mismatch", field.place_of("unit"), f"{problem}, which is in {equal_unit}")
    for path, text in expressions(spec):
        for factor in _list_factors(text):
            if factor.parameter in spec.with_invalid_parts.parameters:
                _check_unit_of_factor(path, factor, spec.with_invalid_parts.parameters[factor.parameter].unit, report)


def _check_unit_of_factor(path: Path, factor: Factor, unit: str, report: DocumentReport) -> None:
    """Check that a parameter in an expression has the unit that its place needs, if both are known.

    ``unit`` is the unit of the parameter.
    """
    key = str(path[-1])
    is_exponent = bool(factor.power)
    needed_kind = "bits" if is_exponent or key in _KEYS_IN_BITS else _QUANTITY_OF_KEY.get(key)
    kind = _KIND_OF.get(unit)
    if needed_kind is None or kind is None or kind == needed_kind:
        return
    quoted_place = f"the exponent in 2^{factor.parameter}" if is_exponent else quoted(key)
    needed_unit = "µm" if needed_kind == "micrometres" else needed_kind
    message = f"{quoted(factor.parameter)} is in {unit}, but {quoted_place} must be in {needed_unit}"
    report.add("unit-mismatch", path, message)


def check_parameter_cycle(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no parameter is defined by itself, directly or through other parameters."""
    definitions: dict[str, tuple[str, ...]] = {}
    for name, parameter in spec.parameters.items():
        if parameter.equals is not None:
            definitions[name] = _parameters_in(parameter.equals)
    settled: set[str] = set()  # Parameters that need no further search.
    for name in definitions:
        cycle = _find_cycle(name, definitions, settled)
        if cycle:
            message = f"circular definition of parameter: {' -> '.join(cycle)}"
            report.add("parameter-cycle", ("parameters", cycle[0], "equals"), message)


def _find_cycle(start: str, definitions: Mapping[str, tuple[str, ...]], settled: set[str]) -> list[str]:
    """Return the parameters of a cycle that is reached from ``start``, with the first one also at the end, or none.

    If a needs b, b needs c and c needs b, the cycle reached from a is ``["b", "c", "b"]``.
    Every parameter that is visited is added to ``settled``, because each cycle is reported once.
    """
    # Depth first, without recursion: a long chain of parameters must not exhaust the stack.
    # ``trail`` contains the open definitions, and ``pending`` an iterator for each of them and for the start.
    trail: list[str] = []
    pending = [iter((start,))]
    while pending:
        name = next(pending[-1], None)
        if name is None:
            pending.pop()
            if trail:
                settled.add(trail.pop())
        elif name in trail:
            settled.update(trail)
            return [*trail[trail.index(name) :], name]
        elif name in definitions and name not in settled:
            trail.append(name)
            pending.append(iter(definitions[name]))
    return []


def _parameters_in(expression_text: int | str) -> tuple[str, ...]:
    """Return the parameters in an expression, or none if it is not valid."""
    try:
        return Expression.parse(expression_text).parameters
    except ExpressionError:  # Reported by the rule on expressions.
        return ()
