"""Order codes of a spec, and checks of the facts that depend on them.

Facts that apply only to some order codes must cover every order code exactly once. Each parameter must be used, and a
procedure must not change the limits of its later arguments.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from types import MappingProxyType
from typing import Protocol

from ..language.files import is_second
from ..language.problems import DocumentReport, Path, join_words, quoted
from ..language.rules.parts import is_explained_at
from ..language.rules.walk import leaves
from ..model import (
    Argument,
    Biss,
    Clocked,
    CodePart,
    CodeValue,
    Device,
    Interface,
    ModifyStep,
    OrderCode,
    Parameter,
    Procedure,
    SpelledValue,
    Spelling,
    Ssi,
    Step,
    Variant,
    WriteStep,
)
from ..model.expressions import Expression, ExpressionError, resolve_parameters
from ..model.order_codes import Restricted, applies_to_code, facts_for_code
from ..model.record import dataclass
from ..order_codes.patterns import listed_codes
from ..say import count_with_unit
from .spec_parts import (
    Raw,
    build_part,
    build_supply,
    names_set_by_order_codes,
    parameters_of_flags,
    sources,
)


@dataclass(frozen=True, slots=True)
class ExclusiveFacts:
    """Facts of one kind, such as clocks, of which each order code has at most one."""

    #: The kind of the facts with an article, such as ``a clock``.
    noun: str
    #: Each fact with its path in the spec.
    paths_and_facts: Sequence[tuple[Path, Restricted]]
    #: The order codes of the interface or of the device.
    codes: Sequence[str]
    #: Short name of the interface, or "" for facts of the device.
    interface: str = ""
    #: Whether each order code must have one of the facts.
    is_needed: bool = False
    #: Whether other rules report two facts that both apply to all order codes.
    has_other_rules: bool = False


def check_facts_by_code(raw_spec: Raw, device: Device, report: DocumentReport) -> None:
    """Report order codes without a clock or timeout, order codes with two facts of a kind, and unused facts."""
    if not device.variants:
        return
    for exclusive_facts in _all_exclusive_facts(raw_spec, device, report):
        # ``only`` of a fact lists the order codes that it applies to. It is "" if the fact applies to all of them.
        depend_on_code = any(fact.only for _, fact in exclusive_facts.paths_and_facts)
        if depend_on_code or not exclusive_facts.has_other_rules:
            _check_unused(exclusive_facts, report)
            _check_overlaps(exclusive_facts, report)
            _check_gaps(exclusive_facts, report)


def _all_exclusive_facts(raw_spec: Raw, device: Device, report: DocumentReport) -> Iterator[ExclusiveFacts]:
    """Yield the facts of the interfaces and of the device, grouped by kind and name."""
    all_order_codes = _codes_of(device.variants)
    for interface in device.interfaces:
        raw_interface = raw_spec["interfaces"][interface.name]
        order_codes = _codes_of(device.variants_over(interface.name))
        yield from _facts_of_interface(raw_interface, interface, order_codes, report)
    yield from _group_by_name(device.timings, noun="a timing", path=("timings",), codes=all_order_codes)
    yield from _group_by_name(
        device.characteristics, noun="a characteristic", path=("characteristics",), codes=all_order_codes
    )


def _codes_of(variants: Sequence[Variant]) -> list[str]:
    return [variant.code for variant in variants]


def _facts_of_interface(
    raw_interface: Raw, interface: Interface, codes: Sequence[str], report: DocumentReport
) -> Iterator[ExclusiveFacts]:
    """Yield the facts of an interface of which an order code has only one.

    These are clocks, timeouts, clock limits for the same cable length, and timings with the same name.
    """
    interface_path = ("interfaces", interface.name)
    if isinstance(interface, Clocked):
        clocks = _with_paths(raw_interface, (*interface_path, "clock"), interface.clocks)
        # If invalid entries were removed, an order code may only seem to have no clock.
        is_complete = (*interface_path, "clock") not in report.document.kept_indices
        yield ExclusiveFacts(
            noun="a clock", paths_and_facts=clocks, codes=codes, interface=interface.short, is_needed=is_complete
        )
    if isinstance(interface, Biss):
        timeouts = _with_paths(raw_interface, (*interface_path, "timeout"), interface.timeouts)
        is_explained_by_erratum = is_explained_at(report.document, *interface_path, "timeout")
        is_complete = (*interface_path, "timeout") not in report.document.kept_indices
        yield ExclusiveFacts(
            noun="a timeout",
            paths_and_facts=timeouts,
            codes=codes,
            interface=interface.short,
            is_needed=is_complete and not is_explained_by_erratum,
        )
    if isinstance(interface, Ssi):
        paths_and_rows = _with_paths(raw_interface, (*interface_path, "cable_lengths"), interface.cable_lengths)
        # The rows of a cable length, each with its path. Usually there is one.
        rows_by_cable_length: dict[int, list[tuple[Path, Restricted]]] = {}
        for path_and_row, row in zip(paths_and_rows, interface.cable_lengths, strict=True):
            rows_by_cable_length.setdefault(row.shorter_than_m, []).append(path_and_row)
        for cable_length, cable_rows in rows_by_cable_length.items():
            noun = f"a clock for cables shorter than {cable_length} m"
            yield ExclusiveFacts(
                noun=noun, paths_and_facts=cable_rows, codes=codes, interface=interface.short, has_other_rules=True
            )
    yield from _group_by_name(interface.timings, noun="a timing", path=(*interface_path, "timings"), codes=codes)


def _with_paths(
    raw_parent: Raw, key_path: tuple[str, ...], facts: Sequence[Restricted]
) -> list[tuple[Path, Restricted]]:
    """Return facts with their paths in the spec. A single fact may be written without a list."""
    spec_key = key_path[-1]
    is_single = isinstance(raw_parent.get(spec_key), Mapping)
    if is_single:
        return [(key_path, fact) for fact in facts]
    return [((*key_path, fact_index), fact) for fact_index, fact in enumerate(facts)]


class _Named(Restricted, Protocol):
    """A fact with a name."""

    @property
    def name(self) -> str: ...


def _group_by_name(facts: Sequence[_Named], *, noun: str, path: Path, codes: Sequence[str]) -> Iterator[ExclusiveFacts]:
    """Yield the facts that share a name, for each such name. An order code has at most one of them.

    ``path`` is the path of the list of facts, and ``noun`` is ``a timing`` or the like.
    """
    facts_by_name: dict[str, list[tuple[Path, Restricted]]] = {}
    for fact_index, fact in enumerate(facts):
        path_and_fact = ((*path, fact_index), fact)
        facts_by_name.setdefault(fact.name, []).append(path_and_fact)
    for shared_name, facts_with_name in facts_by_name.items():
        if len(facts_with_name) > 1:
            named_noun = f"{noun} {quoted(shared_name)}"
            yield ExclusiveFacts(noun=named_noun, paths_and_facts=facts_with_name, codes=codes, has_other_rules=True)


def _check_unused(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report a fact that applies only to order codes of other interfaces."""
    # Other editions of the manual may have fewer order codes, so their facts are not checked.
    is_other_edition = bool(report.document.family)
    if is_other_edition or not exclusive_facts.interface:
        return
    for fact_path, fact in exclusive_facts.paths_and_facts:
        if _is_reported((*fact_path, "only"), report):
            continue
        if fact.only and not any(applies_to_code(fact.only, code) for code in exclusive_facts.codes):
            message = f"no order code with {exclusive_facts.interface} matches {quoted(fact.only)}"
            report.add("only-codes", (*fact_path, "only"), f"{message}; correct the pattern, or remove the entry")


def _is_reported(path: Path, report: DocumentReport) -> bool:
    """Return whether a problem at this place of the spec has been reported."""
    return report.document.path_in_file(path) in report.faults()


def _check_overlaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report pairs of facts of a kind that apply to the same order code."""
    for (first_path, first_fact), (second_path, second_fact) in combinations(exclusive_facts.paths_and_facts, 2):
        codes_of_first = [code for code in exclusive_facts.codes if applies_to_code(first_fact.only, code)]
        common_codes = [code for code in codes_of_first if applies_to_code(second_fact.only, code)]
        if common_codes:
            line, _ = report.document.position(first_path)
            has_or_have = "has" if len(common_codes) == 1 else "have"
            message = f"{_codes_text(common_codes)} already {has_or_have} {exclusive_facts.noun}, on line {line}"
            problem_path = (*second_path, "only") if second_fact.only else second_path
            report.add("only-overlap", problem_path, f"{message}; give each order code exactly one with 'only'")


def _check_gaps(exclusive_facts: ExclusiveFacts, report: DocumentReport) -> None:
    """Report the order codes that none of the facts applies to, if each order code needs one."""
    if not exclusive_facts.is_needed:
        return
    facts = [fact for _, fact in exclusive_facts.paths_and_facts]
    # A wrong pattern has been reported. It was probably meant for the order codes without a fact.
    has_wrong_pattern = any(_is_reported((*path, "only"), report) for path, _ in exclusive_facts.paths_and_facts)
    if not facts or has_wrong_pattern:
        return
    codes_without_fact = [code for code in exclusive_facts.codes if not facts_for_code(facts, code)]
    if codes_without_fact:
        last_path, _ = exclusive_facts.paths_and_facts[-1]
        noun = exclusive_facts.noun.removeprefix("a ")
        message = f"{_codes_text(codes_without_fact)} {_has_or_have(codes_without_fact)} no {noun}"
        remedy = "extend 'only', or add an entry for other order codes"
        if noun == "timeout":
            remedy += ". If the manual gives none for them, add an erratum that affects interfaces.biss.timeout"
        report.add("only-gap", (*last_path, "only"), f"{message}; {remedy}")


def _codes_text(codes: Sequence[str]) -> str:
    """Return a text with the first order code and the number of the others: ``the order code 'X-24' and 2 others``."""
    first_code = f"the order code {quoted(codes[0])}"
    if len(codes) == 1:
        return first_code
    return f"{first_code} and {count_with_unit(len(codes) - 1, 'other')}"


def _has_or_have(codes: Sequence[str]) -> str:
    return "has" if len(codes) == 1 else "have"


#: Keys whose value is an expression, and ``when``, which is a parameter in ``gray``.
EXPRESSION_KEYS = frozenset(
    (
        "bits",
        "compared_bits",
        "counts_per_turn",
        "equals",
        "excess",
        "highest",
        "label_is",
        "low_bit",
        "max",
        "min",
        "modulus",
        "per_counts",
        "step_nm",
        "step_um",
        "turns",
        "when",
        "word_bits",
    )
)
#: Highest number of different values that a message lists.
_MAX_VALUES = 4


def check_unused_parameters(raw_spec: Raw, variants: Sequence[Variant], report: DocumentReport) -> None:
    """Report each parameter of a spec that nothing depends on.

    A parameter with a formula (``equals``) and a citation is a number from the manual, which outputs print, so it may
    be unused. If the spec has another problem, nothing is reported, because the part with the problem may use the
    parameter.
    """
    # The second reading, an independent transcription of the manual, must agree with the spec, so only the spec is
    # checked. In an older edition, the fact that depends on a parameter may be missing.
    if is_second(report.document.file) or report.document.family or report.faults():
        return
    used_names = {*_names_in_expressions(raw_spec), *parameters_of_flags(raw_spec, variants)}
    names_set_by_codes = names_set_by_order_codes(raw_spec)
    for parameter_name, raw_parameter in raw_spec["parameters"].items():
        is_printed_number = "equals" in raw_parameter and "source" in raw_parameter
        if parameter_name in used_names or is_printed_number:
            continue
        problem = f"nothing depends on {quoted(parameter_name)}"
        if parameter_name in names_set_by_codes:
            problem += _values_text(parameter_name, variants)
        remedy = "use it, for example in 'bits' of a field, or remove it"
        if "equals" in raw_parameter:
            remedy += ". If the manual names this number, add its 'source'"
        report.add("unused-parameter", ("parameters", parameter_name), f"{problem}; {remedy}", at_key=True)


def _names_in_expressions(raw_spec: Raw) -> Iterator[str]:
    """Yield the names of the parameters in the expressions of a spec, and in verdicts that depend on an answer."""
    for path, spec_value in leaves(raw_spec):
        if path[-1] in EXPRESSION_KEYS and isinstance(spec_value, str):
            try:
                yield from Expression.parse(spec_value).parameters
            except ExpressionError:
                continue  # This is the value of a text field.
        elif "makes_position_if" in path:
            yield str(path[-1])


def _values_text(parameter_name: str, variants: Sequence[Variant]) -> str:
    """Return a text on the values that order codes set a parameter to: ``, which order codes set to 0 or 1``."""
    values = sorted({variant.parameters[parameter_name] for variant in variants})
    if not values:
        return ""
    if len(values) > _MAX_VALUES:
        return f", which order codes set to {len(values)} different values"
    return f", which order codes set to {join_words(map(str, values), 'or')}"


def check_limits_in_procedures(device: Device, report: DocumentReport) -> None:
    """Report a step of a procedure that changes the limits of a later argument in a way that generated code ignores.

    Generated code only takes the changed limits into account if the step writes an argument to a whole register. A
    register with problems was not built, so the limits of its arguments are unknown.
    """
    built_registers = {register.name for register in device.registers}
    for procedure in device.procedures:
        for step_index, step in enumerate(procedure.steps):
            changed_names = {parameter.name for parameter in _parameters_changed(device, step)}
            if not changed_names:
                continue
            for argument in _arguments_written(procedure, procedure.steps[step_index + 1 :]):
                if argument.of not in built_registers:
                    continue
                limiting_names = _limiting_names(device, argument) & changed_names
                if limiting_names:
                    effect_text = f"this changes {quoted(min(limiting_names))}, which limits the later argument"
                    remedy = "write an argument to the whole register, or divide the steps into two procedures"
                    message = f"{effect_text} {quoted(argument.name)}; {remedy}"
                    report.add("limit-changed", ("procedures", procedure.name, "steps", step_index), message)
                    break


def _limiting_names(device: Device, argument: Argument) -> set[str]:
    """Return the names of the parameters on which the lowest or highest value of an argument depends."""
    limiting_names: set[str] = set()
    for limit in device.limits(device.register(argument.of), argument.meant_as):
        limiting_names.update(limit.parameters if limit is not None else ())
    return limiting_names


def _parameters_changed(device: Device, step: Step) -> Iterator[Parameter]:
    """Yield the parameters that a step changes by writing to their field, or a fixed value to their register.

    A step that writes an argument to a whole register is left out, because generated code takes it into account.
    """
    for parameter in device.run_time_parameters:
        match step:
            case ModifyStep() if (step.register, step.field) == (parameter.register, parameter.field):
                yield parameter
            case WriteStep() if step.register == parameter.register and step.value is not None:
                yield parameter
            case _:
                pass


def _arguments_written(procedure: Procedure, steps: tuple[Step, ...]) -> Iterator[Argument]:
    """Yield the arguments of a procedure that these steps write."""
    arguments = {argument.name: argument for argument in procedure.arguments}
    for step in steps:
        if isinstance(step, WriteStep | ModifyStep) and step.value is None and step.value_name in arguments:
            yield arguments[step.value_name]


def code_grammar(raw_spec: Raw) -> OrderCode:
    """Return the parts and spellings of order codes from the checked section ``order_code`` of a spec."""
    parts = tuple(_build_code_part(part) for part in raw_spec["parts"])
    spellings = tuple(_build_spelling(spelling) for spelling in raw_spec.get("also_written", ()))
    return build_part(OrderCode, raw_spec, parts=parts, also_written=spellings)


def _build_code_part(raw_part: Raw) -> CodePart:
    """Return a part of the order code with its values. In the spec, a value without properties is empty."""
    values = tuple(_build_code_value(text, value or {}, raw_part) for text, value in raw_part["values"].items())
    return build_part(CodePart, raw_part, values=values, open_only_with=_texts_by_part(raw_part, "open_only_with"))


def _build_spelling(raw_spelling: Raw) -> Spelling:
    """Return an additional spelling of order codes, with its own texts for values of the parts."""
    spelled_values: list[SpelledValue] = []
    for part, values_by_text in raw_spelling.get("values", {}).items():
        spelled_values += [SpelledValue(part, text, value) for text, value in values_by_text.items()]
    return build_part(Spelling, raw_spelling, values=tuple(spelled_values))


def _build_code_value(text_in_code: str, raw_value: Raw, raw_part: Raw) -> CodeValue:
    """Return a value of a part of the order code. ``text_in_code`` is its text in a label."""
    return build_part(
        CodeValue,
        raw_value,
        text=text_in_code,
        only_with=_texts_by_part(raw_value, "only_with"),
        supply=build_supply(raw_value, sources(raw_part)),
    )


def _texts_by_part(raw_value: Raw, key: str) -> Mapping[str, tuple[str, ...]]:
    """Return the texts of other parts of the order code with which a value is possible, by the name of the part."""
    return MappingProxyType({part_name: tuple(texts) for part_name, texts in raw_value.get(key, {}).items()})


def list_variants(
    order_code: OrderCode, definitions: Mapping[str, Expression], default_values: Mapping[str, int]
) -> tuple[Variant, ...]:
    """Return every listed order code with its parameters.

    ``default_values`` are the values of parameters that an order code does not set: the factory defaults of registers,
    and the first answers to open questions.
    """
    if not order_code.parts:
        return ()
    variants = []
    for order_code_text, values_by_part, interface, values_set_by_code in listed_codes(order_code):
        parameters = resolve_parameters({**default_values, **values_set_by_code}, definitions)
        variants.append(
            Variant(
                code=order_code_text,
                parts=MappingProxyType(dict(values_by_part)),
                interface=interface,
                parameters=parameters,
            )
        )
    return tuple(variants)
