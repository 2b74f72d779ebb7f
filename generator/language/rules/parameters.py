"""Rules for parameters, alternatives and expressions: the origin of values, their use, and the size of sums."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from ...model.expressions import LARGEST_MULTIPLE, Expression, ExpressionError, Factor, Term
from ..hints import expression_hint, number_hint
from ..keys_of_fields import WrittenField, WrittenRegister
from ..keys_of_order_codes import WrittenAlternative, WrittenBiss, WrittenParameter, WrittenSpi
from ..keys_of_specs import WrittenSpec
from ..problems import DocumentReport, Path, join_words, quoted
from .parts import (
    FieldList,
    FieldOwner,
    PlacedPart,
    WrittenInterface,
    by_name,
    field_lists,
    interface_name_of,
    interfaces,
    keys_of_origin,
    layouts_of_interfaces,
    measurements,
    with_groups_expanded,
)
from .references import NameResolver

#: Keys of fields whose expressions are in bits.
KEYS_IN_BITS = ("bits", "low_bit")
#: Kind of unit of each number of a measurement.
KIND_OF_UNIT_BY_KEY = {
    "counts_per_turn": "counts",
    "turns": "revolutions",
    "step_um": "micrometres",
    "step_nm": "nanometres",
    "per_counts": "counts",
    "modulus": "counts",
    "highest": "counts",
}


def check_parameter_interface(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no expression of an interface uses a parameter of another interface.

    Parameters that define the parameters in an expression are checked, too.
    """
    parameters = spec.with_invalid_parts.parameters
    for path, interface, text in parameter_uses(spec):
        for name in dict.fromkeys(all_parameters(text, parameters)):
            own_interface = parameters[name].interface
            if own_interface is not None and own_interface != interface:
                message = f"{quoted(name)} is only for {own_interface} (see its 'interface'), but this is {interface}"
                report.add("parameter-interface", path, message)
                break


#: An expression as written, with its path.
_Expressions = Iterator[tuple[Path, int | str]]


def expressions(spec: WrittenSpec) -> _Expressions:
    """Yield every expression of a spec as it is written, with its path. Expressions in groups are yielded once."""
    for part in spec.order_code.parts:
        yield from _expressions_under(part, ("label_is",))
    for parameter in spec.parameters.values():
        yield from _expressions_under(parameter, ("equals",))
    for field_list in field_lists(spec):
        for field in field_list.fields:
            yield from _expressions_of_field(field, field.path)
    for register in spec.registers:
        for part_with_limits in (register, *register.meanings):
            yield from _expressions_under(part_with_limits, ("min", "max"))
    for measurement in measurements(spec):
        yield from _expressions_under(measurement, KIND_OF_UNIT_BY_KEY)
    for field_list in layouts_of_interfaces(spec):
        yield from _expressions_of_position_range(field_list)
        yield from _expressions_of_gray_code(field_list, ("excess",))
    for _, interface in interfaces(spec):
        yield from _expressions_of_interface(interface)


class ParameterUse(NamedTuple):
    """An expression as it is written, or the name of a parameter, with its place and an interface that uses it."""

    path: Path
    interface: str
    text: int | str


def parameter_uses(spec: WrittenSpec) -> Iterator[ParameterUse]:
    """Yield each use of an expression or parameter by an interface.

    A field of a group is yielded for each layout or register that uses the group.
    """
    group_by_name = by_name(spec.with_invalid_parts.field_groups)
    layouts_and_registers = list(layouts_of_interfaces(spec))
    for register in spec.registers:
        layouts_and_registers.append(FieldList(FieldOwner.REGISTER, register, interface_name_of(register)))
    for field_list in layouts_and_registers:
        for path, field in with_groups_expanded(field_list, group_by_name):
            yield from _with_interface(field_list.interface, _expressions_of_field(field, path))
        yield from _with_interface(field_list.interface, _expressions_of_owner(field_list))
    for name, interface in interfaces(spec):
        # A measurement of the device applies to each interface without its own.
        measurement = interface.measurement if interface.has("measurement") else spec.measurement
        if measurement is not None:
            yield from _with_interface(name, _expressions_under(measurement, KIND_OF_UNIT_BY_KEY))
        yield from _with_interface(name, _expressions_of_interface(interface))


def _with_interface(interface: str, expressions: _Expressions) -> Iterator[ParameterUse]:
    """Yield each expression with its path and the interface that uses it."""
    for path, text in expressions:
        yield ParameterUse(path=path, interface=interface, text=text)


def _expressions_of_owner(field_list: FieldList) -> _Expressions:
    """Yield the limits of a register, or the numbers in the position range and the Gray code of a layout."""
    if isinstance(field_list.owner, WrittenRegister):
        for part_with_limits in (field_list.owner, *field_list.owner.meanings):
            yield from _expressions_under(part_with_limits, ("min", "max"))
    yield from _expressions_of_position_range(field_list)
    yield from _expressions_of_gray_code(field_list, ("when", "excess"))


def _expressions_of_gray_code(field_list: FieldList, keys: Iterable[str]) -> _Expressions:
    """Yield the expressions under these keys of ``gray``, which describes the Gray code of a layout.

    The text under ``when`` is the name of a parameter. Nothing is yielded for a layout in binary code.
    """
    if field_list.layout is not None and field_list.layout.gray is not None:
        yield from _expressions_under(field_list.layout.gray, keys)


def _expressions_of_position_range(field_list: FieldList) -> _Expressions:
    """Yield the expressions in the position range of a layout, if it differs from the range of the interface."""
    if field_list.layout is not None and field_list.layout.position_range is not None:
        yield from _expressions_under(field_list.layout.position_range, KIND_OF_UNIT_BY_KEY)


def _expressions_under(part: PlacedPart, keys: Iterable[str]) -> _Expressions:
    """Yield the expression under each of these keys that a part has, with its path."""
    for key in keys:
        text = part.data.get(key)
        if isinstance(text, (int, str)):
            yield (*part.path, key), text


def _expressions_of_interface(interface: WrittenInterface) -> _Expressions:
    """Yield the lengths of words over SPI, and the number of bits that are compared between BiSS data channels."""
    if isinstance(interface, WrittenSpi):
        for part in (interface, *interface.exchanges):
            yield from _expressions_under(part, ("word_bits",))
    if isinstance(interface, WrittenBiss) and interface.channels is not None:
        yield from _expressions_under(interface.channels, ("compared_bits",))


def _expressions_of_field(field: WrittenField, path: Path) -> _Expressions:
    """Yield the width, the lowest bit and the documented value of a field as they are written.

    Their paths begin with ``path``. The documented value (``equals``) of a text field is not an expression.
    """
    keys = ("bits", "low_bit") if field.has("text") else ("bits", "low_bit", "equals")
    for key in keys:
        if key in field.data:
            yield (*path, key), field.data[key]


def all_parameters(expression_text: object, parameters: Mapping[str, WrittenParameter]) -> Iterator[str]:
    """Yield the names of the parameters in an expression, and of the parameters from which they are calculated.

    Each name is yielded once. ``parameters`` contains all parameters of the spec. Unknown names are left out.
    """
    factors_to_visit = list_factors(expression_text)
    visited_names: set[str] = set()
    # The list grows during the loop, so that parameters named directly come before those that define them.
    for factor in factors_to_visit:
        name = factor.parameter
        if name not in visited_names and name in parameters:
            visited_names.add(name)
            yield name
            # A parameter without ``equals`` adds no factors.
            factors_to_visit += list_factors(parameters[name].equals)


def list_factors(expression_text: object) -> list[Factor]:
    """Return the factors of all terms of an expression as it is written. Empty for text that is not an expression.

    A factor is a parameter, or two to the power of a parameter.
    """
    return [factor for term in list_terms(expression_text) for factor in term.factors]


def check_parameter_origin(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a parameter is either calculated, read from a register, or set by an answer of the user.

    ``by_code``, which lists the value for each code in the register, is allowed only for a parameter that is read, and
    excludes limits.
    """
    for name, parameter in spec.parameters.items():
        origin_keys = keys_of_origin(parameter)
        if len(origin_keys) > 1:
            second_key = origin_keys[1]
            problem = f"{join_words(map(quoted, origin_keys))} each define {quoted(name)}; keep one"
            report.add("parameter-origin", parameter.path_of(second_key), problem, at_key=True)
        if not parameter.by_code:
            continue
        limit_keys = [key for key in ("min", "max") if parameter.has(key)]
        if not parameter.read_from:
            problem = "'by_code' needs 'read_from', the register field that holds the code"
            report.add("parameter-origin", parameter.path_of("by_code"), problem, at_key=True)
        elif limit_keys:
            limit_key = limit_keys[0]
            problem = f"'by_code' already lists the values of {quoted(name)}; leave out {quoted(limit_key)}"
            report.add("parameter-origin", parameter.path_of(limit_key), problem, at_key=True)


def check_alternative_references(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that all answers to a question (alternative) set the same parameters, and that these name the question.

    Also check that parameters and examples name questions that exist, and that examples name existing answers.
    """
    resolver = NameResolver(spec, report)
    alternative_by_name = by_name(spec.with_invalid_parts.alternatives)
    named_parameters = spec.with_invalid_parts.parameters.items()
    for alternative in spec.alternatives:
        own_parameter_names = [
            name for name, parameter in named_parameters if parameter.alternative == alternative.name
        ]
        _check_answers(alternative, own_parameter_names, resolver)
    for name, parameter in spec.parameters.items():
        path = parameter.path_of("alternative")
        resolver.check_optional_name(path, "alternative", parameter.alternative, known_names=alternative_by_name)
        alternative_of_parameter = alternative_by_name.get(parameter.alternative)
        if alternative_of_parameter is not None and not _sets_parameter(alternative_of_parameter, name):
            problem = f"no answer of {quoted(parameter.alternative)} sets {quoted(name)}"
            report.add("undefined-reference", path, problem)
    for example in spec.examples:
        for name, answer in example.alternatives.items():
            answer_path = (*example.path, "alternatives", name)
            resolver.check_name(answer_path, "alternative", name, known_names=alternative_by_name)
            if name in alternative_by_name:
                known_answers = alternative_by_name[name].names_in("values")
                noun = f"answer of {quoted(name)} called"
                resolver.check_name(answer_path, noun, answer, known_names=known_answers)


def _sets_parameter(alternative: WrittenAlternative, parameter_name: str) -> bool:
    """Return True if any answer to a question sets a parameter."""
    return any(parameter_name in answer.names_in("sets") for answer in alternative.values.values())


def _check_answers(alternative: WrittenAlternative, own_parameter_names: Sequence[str], resolver: NameResolver) -> None:
    """Check that each answer to a question sets all parameters of the question, and no others.

    ``own_parameter_names`` are the parameters that name the question. Another rule reports one that no answer sets.
    """
    question = alternative.name
    first_answer_by_parameter: dict[str, str] = {}
    for answer_name, answer in alternative.values.items():
        for name in answer.sets:
            first_answer_by_parameter.setdefault(name, answer_name)
    for answer_name, answer in alternative.values.items():
        sets_path = answer.path_of("sets")
        for name in answer.sets:
            resolver.check_name((*sets_path, name), "parameter", name)
            if name in resolver.parameter_names and name not in own_parameter_names:
                problem = f"{quoted(name)} is not a parameter of {quoted(question)}; give it 'alternative: {question}'"
                resolver.report_problem((*sets_path, name), problem)
        for name in own_parameter_names:
            if name in first_answer_by_parameter and name not in answer.sets:
                first_answer = quoted(first_answer_by_parameter[name])
                problem = f"{quoted(answer_name)} does not set {quoted(name)}, which {first_answer} sets"
                resolver.report_problem(sets_path, problem)


def check_alternative_use(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the user's answer to a question affects only widths and positions of fields, or only verdicts.

    Generated code can use an answer nowhere else. Answers to a question with a default affect only verdicts, so no
    expression may contain their parameters.
    """
    alternative_by_name = by_name(spec.with_invalid_parts.alternatives)
    alternative_by_parameter: dict[str, str] = {}  # The names of the questions by the parameters that answers set.
    for name, parameter in spec.with_invalid_parts.parameters.items():
        if parameter.alternative:
            alternative_by_parameter[name] = parameter.alternative
    used_expressions = list(expressions(spec))
    # The parameter under 'when', which turns Gray code on, is not an expression.
    used_expressions += [(use.path, use.text) for use in parameter_uses(spec) if use.path[-1] == "when"]
    for path, expression_text in used_expressions:
        used_names = [factor.parameter for factor in list_factors(expression_text)]
        names_set_by_answers = [name for name in used_names if name in alternative_by_parameter]
        if not names_set_by_answers:
            continue
        parameter_name = names_set_by_answers[0]
        alternative_name = alternative_by_parameter[parameter_name]
        alternative = alternative_by_name.get(alternative_name)
        problem = f"{quoted(parameter_name)} is set by the alternative {quoted(alternative_name)}"
        if path[-1] not in KEYS_IN_BITS:
            remedy = "use it only in 'bits' or 'low_bit' of a field"
            message = f"{problem}, so only frames and registers can depend on it; {remedy}"
            report.add("alternative-use", path, message)
        elif alternative is not None and alternative.has("default"):
            alternative_text = quoted(alternative_name)
            remedy = f"use it only in 'makes_position_if' of a flag, or remove 'default' from {alternative_text}"
            report.add("alternative-use", path, f"{problem}, whose default applies without a choice; {remedy}")


def check_parameter_cycle(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no parameter is defined by itself, directly or through other parameters."""
    used_names_by_parameter: dict[str, list[str]] = {}
    for name, parameter in spec.parameters.items():
        if parameter.equals is not None:
            used_names_by_parameter[name] = [factor.parameter for factor in list_factors(parameter.equals)]
    searched_names: set[str] = set()
    for name in used_names_by_parameter:
        cycle = _find_cycle(name, used_names_by_parameter, searched_names)
        if cycle:
            cycle_text = " -> ".join(cycle)
            message = f"circular definition of parameter: {cycle_text}"
            report.add("parameter-cycle", ("parameters", cycle[0], "equals"), message)


def _find_cycle(start: str, used_names_by_parameter: Mapping[str, list[str]], searched_names: set[str]) -> list[str]:
    """Return a circular definition that is reached from the parameter ``start``, or an empty list.

    If a needs b, b needs c and c needs b, the cycle reached from a is ``["b", "c", "b"]``. ``used_names_by_parameter``
    contains the names in the definition of each parameter. Parameters in ``searched_names`` are skipped, and every
    visited parameter is added there, so that each cycle is reported once.
    """
    # Depth first, without recursion: a long chain of parameters must not exhaust the stack.
    trail: list[str] = []  # The parameters from the start to the current one.
    names_to_visit = [iter((start,))]  # First the start, then for each parameter of the trail the names in it.
    while names_to_visit:
        name = next(names_to_visit[-1], None)
        if name is None:  # All names in a definition have been visited.
            names_to_visit.pop()
            if trail:
                searched_names.add(trail.pop())
        elif name in trail:
            searched_names.update(trail)
            return [*trail[trail.index(name) :], name]
        elif name in used_names_by_parameter and name not in searched_names:
            trail.append(name)
            names_to_visit.append(iter(used_names_by_parameter[name]))
    return []


def check_expressions(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that every expression is valid, and that every parameter in it exists."""
    resolver = NameResolver(spec, report)
    for path, text in expressions(spec):
        try:
            names = Expression.parse(text).parameters
        except ExpressionError as error:
            key = str(path[-1])
            hint = expression_hint(str(text)) or number_hint(key, text)
            if not hint:
                hint = "; write an expression such as singleturn_bits + 8"
            report.add("bad-expression", path, f"{error}{hint}")
            continue
        for name in names:
            resolver.check_name(path, "parameter", name)


#: Most terms of a sum of parameters, with all definitions inserted.
_MOST_TERMS = 256


def list_terms(expression_text: object) -> tuple[Term, ...]:
    """Return the terms of an expression as it is written. Empty for text that is not an expression."""
    if not isinstance(expression_text, (int, str)):
        return ()
    try:
        return Expression.parse(expression_text).terms
    except ExpressionError:  # Reported by the rule on expressions.
        return ()


class _SumSize(NamedTuple):
    """Number of terms of a parameter with all definitions inserted, and the largest number in a product."""

    term_count: int
    multiple: int

    @property
    def is_too_large(self) -> bool:
        return self.term_count > _MOST_TERMS or self.multiple > LARGEST_MULTIPLE


def check_long_sums(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no parameter becomes a long sum or a large multiple when its parameters are replaced.

    They are replaced by their definitions. Definitions that each use another one twice would take forever: 30 of them
    are a sum of 2^30 terms. A parameter that uses a reported one is not reported.
    """
    size_by_name: dict[str, _SumSize] = {}
    for name, parameter in spec.parameters.items():
        size = _size_of_parameter(name, spec.parameters, size_by_name)
        used_names = [factor.parameter for term in list_terms(parameter.equals) for factor in term.factors]
        uses_reported_parameter = any(size_by_name[used_name].is_too_large for used_name in used_names)
        if not size.is_too_large or uses_reported_parameter:
            continue
        if size.term_count > _MOST_TERMS:
            problem = f"is a sum of {size.term_count} terms with the definitions of its parameters"
            limit = _MOST_TERMS
        else:
            problem = f"is a multiple of {size.multiple} with the definitions of its parameters"
            limit = LARGEST_MULTIPLE
        report.add("bad-expression", parameter.path_of("equals"), f"{quoted(name)} {problem}; the limit is {limit}")


def _size_of_parameter(
    name: str, parameters: Mapping[str, WrittenParameter], size_by_name: dict[str, _SumSize]
) -> _SumSize:
    """Return the size of a parameter when all parameters in it are replaced by their definitions.

    Each factor of a product counts as a term. A parameter without a definition has one term. ``size_by_name`` caches
    the results.
    """
    if name in size_by_name:
        return size_by_name[name]
    # This ends the recursion for a circular definition, which another rule reports.
    size_by_name[name] = _SumSize(term_count=1, multiple=1)
    terms = list_terms(parameters[name].equals) if name in parameters else ()
    term_count, largest_multiple = 0, 1
    for term in terms:
        sizes_of_factors = [_size_of_parameter(factor.parameter, parameters, size_by_name) for factor in term.factors]
        term_count += sum(size.term_count for size in sizes_of_factors)
        multiple = abs(term.multiple) * math.prod(size.multiple for size in sizes_of_factors)
        largest_multiple = max(largest_multiple, multiple)
    if terms:
        size_by_name[name] = _SumSize(term_count=term_count, multiple=largest_multiple)
    return size_by_name[name]
