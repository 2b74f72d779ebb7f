"""Rules for parameters: the interface that may use them, and their unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ...model.expressions import Expression, ExpressionError, Factor
from ..problems import DocumentReport, Path, listed, quoted
from .walk import (
    Fields,
    Has,
    Spec,
    by_name,
    expanded,
    field_lists,
    interface_of,
    items,
    layouts,
    mapping,
    measurements,
    position_ranges,
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
#: Quantity of each number of a measurement.
_WIDTHS = ("bits", "low_bit")
_MEASURED = {
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


def parameter_interface(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a parameter of one interface is not used for another."""
    parameters = mapping(raw, "parameters")
    for path, interface, text in uses(spec, raw):
        for name in dict.fromkeys(all_parameters(text, parameters)):
            owner_interface = mapping(parameters, name).get("interface")
            if isinstance(owner_interface, str) and owner_interface != interface:
                report.add(
                    "parameter-interface",
                    path,
                    f"{quoted(name)} is only for {owner_interface} (see its 'interface'), but this is {interface}",
                )
                break


def expressions(spec: Spec) -> Iterator[tuple[Path, int | str]]:
    """Yield every expression of a spec, those of groups once."""
    for path, part in items(spec, "order_code", "parts"):
        yield from _expressions_under(path, part, ("label_is",))
    for name, parameter in mapping(spec, "parameters").items():
        yield from _expressions_under(("parameters", name), parameter, ("equals",))
    for fields in field_lists(spec):
        for path, field in fields:
            yield from _of_field(path, field)
    for path, register in items(spec, "registers"):
        yield from _of_limits(path, register)
    for path, measurement in measurements(spec):
        yield from _expressions_under(path, measurement, _MEASURED)
    for path, _, own_range in position_ranges(spec):
        yield from _expressions_under(path, own_range, _MEASURED)
    for kind, interface in mapping(spec, "interfaces").items():
        yield from _of_words(kind, interface)


def uses(spec: Spec, raw: Spec | None = None) -> Iterator[tuple[Path, str, int | str]]:
    """Yield each use of an expression or parameter by an interface: the place, the interface, and the text."""
    groups = by_name(raw if raw is not None else spec, "field_groups")
    field_owners = list(layouts(spec))
    for path, register in items(spec, "registers"):
        field_owners.append(Fields(Has.REGISTER, register, path, interface_of(register)))
    for fields in field_owners:
        for path, text in _expressions_of_fields(fields, groups):
            yield path, fields.interface, text
    for path, kind, own_range in position_ranges(spec):
        for key_path, text in _expressions_under(path, own_range, _MEASURED):
            yield key_path, kind, text
    for kind, interface in mapping(spec, "interfaces").items():
        # A measurement of the device applies to each interface without its own.
        measurement_path: Path = ("measurement",)
        measurement = mapping(spec, "measurement")
        if "measurement" in interface:
            measurement_path = ("interfaces", kind, "measurement")
            measurement = mapping(interface, "measurement")
        for path, text in _expressions_under(measurement_path, measurement, _MEASURED):
            yield path, kind, text
        for path, text in _of_words(kind, interface):
            yield path, kind, text


def _expressions_of_fields(fields: Fields, groups: Mapping[str, Spec]) -> Iterator[tuple[Path, int | str]]:
    """Yield the expressions of a layout or register: those of its fields, of its limits and of its Gray code."""
    for path, field in expanded(fields, groups):
        yield from _of_field(path, field)
    yield from _of_limits(fields.path, fields.owner)
    yield from _expressions_under((*fields.path, "gray"), mapping(fields.owner, "gray"), ("when", "excess"))


def _expressions_under(path: Path, spec: Spec, keys: Iterable[str]) -> Iterator[tuple[Path, int | str]]:
    return (((*path, key), spec[key]) for key in keys if key in spec)


def _of_words(kind: str, interface: Spec) -> Iterator[tuple[Path, int | str]]:
    """Yield the lengths of words, of the interface and of its exchanges."""
    interface_path = ("interfaces", kind)
    yield from _expressions_under(interface_path, interface, ("word_bits",))
    for path, exchange in items(interface, "exchanges"):
        yield from _expressions_under((*interface_path, *path), exchange, ("word_bits",))


def _of_field(path: Path, field: Spec) -> Iterator[tuple[Path, int | str]]:
    """Return the expressions of a field. ``equals`` of a text field is text, otherwise an expression."""
    keys = ("bits", "low_bit") if "text" in field else ("bits", "low_bit", "equals")
    return _expressions_under(path, field, keys)


def _of_limits(path: Path, owner: Spec) -> Iterator[tuple[Path, int | str]]:
    """Yield the limits of a register, and those of its meanings."""
    yield from _expressions_under(path, owner, ("min", "max"))
    for meaning_path, meaning in items(owner, "meanings"):
        yield from _expressions_under((*path, *meaning_path), meaning, ("min", "max"))


def all_parameters(text: object, parameters: Spec) -> Iterator[str]:
    """Yield the parameters in an expression, and those that define them."""
    factors = _factors(text)
    visited_names: set[str] = set()
    # The list grows during the loop: parameters named directly come before those that define them.
    for factor in factors:
        name = factor.parameter
        if name not in visited_names and name in parameters:
            visited_names.add(name)
            yield name
            factors += _factors(mapping(parameters, name).get("equals"))


def _factors(text: object) -> list[Factor]:
    """Return the factors of all terms of an expression, or none if it is not valid."""
    if not isinstance(text, (int, str)):
        return []
    try:
        terms = Expression.parse(text).terms
    except ExpressionError:  # Reported by the rule on expressions.
        return []
    return [factor for term in terms for factor in term.factors]


#: Keys for the origin of a parameter's value. Without any, the order code sets it.
_ORIGINS = ("equals", "read_from", "alternative")


def parameter_origin(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the value of a parameter has one origin, and that codes are those of a register."""
    for name, parameter in mapping(spec, "parameters").items():
        origins = [key for key in _ORIGINS if key in parameter]
        if len(origins) > 1:
            problem = f"{listed(map(quoted, origins))} each define {quoted(name)}; keep one"
            report.add("parameter-origin", ("parameters", name, origins[1]), problem, at_key=True)
        if "by_code" not in parameter:
            continue
        limits = [key for key in ("min", "max") if key in parameter]
        if "read_from" not in parameter:
            problem = "'by_code' needs 'read_from', the register field that holds the code"
            report.add("parameter-origin", ("parameters", name, "by_code"), problem, at_key=True)
        elif limits:
            problem = f"'by_code' already lists the values of {quoted(name)}; leave out {quoted(limits[0])}"
            report.add("parameter-origin", ("parameters", name, limits[0]), problem, at_key=True)


def alternative_use(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that alternatives affect only the places of fields, because generated code can use them only there.

    Those with a default affect only verdicts, which do not need a choice.
    """
    parameters, alternatives = mapping(raw, "parameters"), by_name(raw, "alternatives")
    used_texts = list(expressions(spec))
    used_texts += [(path, text) for path, _, text in uses(spec, raw) if path[-1] == "when"]
    for path, text in used_texts:
        set_by_alternative = [
            factor.parameter for factor in _factors(text) if "alternative" in mapping(parameters, factor.parameter)
        ]
        if not set_by_alternative:
            continue
        name = set_by_alternative[0]
        alternative = mapping(parameters, name)["alternative"]
        problem = f"{quoted(name)} is set by the alternative {quoted(alternative)}"
        if path[-1] not in _WIDTHS:
            remedy = "use it only in 'bits' or 'low_bit' of a field"
            message = f"{problem}, so only frames and registers can depend on it; {remedy}"
            report.add("alternative-use", path, message)
        elif "default" in alternatives.get(alternative, {}):
            remedy = f"use it only in 'makes_position_if' of a flag, or remove 'default' from {quoted(alternative)}"
            report.add("alternative-use", path, f"{problem}, whose default applies without a choice; {remedy}")


def units(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that exponents are in bits, and that numbers of a measurement and fields have the right unit."""
    parameters = mapping(raw, "parameters")
    for fields in field_lists(spec):
        for path, field in fields:
            unit = field.get("unit")
            equal_unit = mapping(parameters, str(field.get("equals"))).get("unit")
            if unit and equal_unit and kind_of_unit(unit) != _KIND_OF.get(str(equal_unit), equal_unit):
                problem = f"{quoted(field['name'])} is in {unit}, but it equals {quoted(field['equals'])}"
                report.add("unit-mismatch", (*path, "unit"), f"{problem}, which is in {equal_unit}")
    for path, text in expressions(spec):
        for factor in _factors(text):
            _check_unit_of_factor(path, factor, parameters, report)


def _check_unit_of_factor(path: Path, factor: Factor, parameters: Spec, report: DocumentReport) -> None:
    """Check that a parameter in an expression has the unit that its place needs, if that unit is known."""
    key = str(path[-1])
    is_exponent = bool(factor.power)
    needed_kind = "bits" if is_exponent or key in _WIDTHS else _MEASURED.get(key)
    unit = mapping(parameters, factor.parameter).get("unit")
    kind = _KIND_OF.get(str(unit))
    if needed_kind is None or kind is None or kind == needed_kind:
        return
    place = f"the exponent in 2^{factor.parameter}" if is_exponent else quoted(key)
    needed_unit = "µm" if needed_kind == "micrometres" else needed_kind
    message = f"{quoted(factor.parameter)} is in {unit}, but {place} must be in {needed_unit}"
    report.add("unit-mismatch", path, message)
