"""Rules for parameters: the interface that may use them, and their unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

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
    fields_of_all = list(layouts(spec))
    for path, register in items(spec, "registers"):
        interface = interface_of(register)
        fields_of_all.append(Fields(Has.REGISTER, register, path, interface))
    for fields in fields_of_all:
        located_texts = [use for path, field in expanded(fields, groups) for use in _of_field(path, field)]
        located_texts += _of_limits(fields.path, fields.owner)
        located_texts += _expressions_under((*fields.path, "gray"), mapping(fields.owner, "gray"), ("when",))
        yield from ((path, fields.interface, text) for path, text in located_texts)
    for path, kind, own_range in position_ranges(spec):
        yield from ((path, kind, text) for path, text in _expressions_under(path, own_range, _MEASURED))
    for kind, interface in mapping(spec, "interfaces").items():
        has_own_measurement = "measurement" in interface
        measurement_path: Path = ("interfaces", kind, "measurement") if has_own_measurement else ("measurement",)
        measurement = mapping(interface if has_own_measurement else spec, "measurement")
        located_texts = [*_expressions_under(measurement_path, measurement, _MEASURED), *_of_words(kind, interface)]
        yield from ((path, kind, text) for path, text in located_texts)


def _expressions_under(path: Path, spec: Spec, keys: Iterable[str]) -> Iterator[tuple[Path, int | str]]:
    return (((*path, key), spec[key]) for key in keys if key in spec)


def _of_words(kind: str, interface: Spec) -> Iterator[tuple[Path, int | str]]:
    """Yield the lengths of words, of the interface and of its exchanges."""
    interface_path = ("interfaces", kind)
    for path, owner in (
        (interface_path, interface),
        *(((*interface_path, *path), owner) for path, owner in items(interface, "exchanges")),
    ):
        yield from _expressions_under(path, owner, ("word_bits",))


def _of_field(path: Path, field: Spec) -> Iterator[tuple[Path, int | str]]:
    """Return the expressions of a field. ``equals`` of a text field is text, otherwise an expression."""
    return _expressions_under(path, field, ("bits", "low_bit") if "text" in field else ("bits", "low_bit", "equals"))


def _of_limits(path: Path, owner: Spec) -> Iterator[tuple[Path, int | str]]:
    for below, limited in (((), owner), *items(owner, "meanings")):
        yield from _expressions_under((*path, *below), limited, ("min", "max"))


def all_parameters(text: object, parameters: Spec) -> Iterator[str]:
    """Yield the parameters in an expression, and those that define them."""
    factors, visited_names = _factors(text), set()
    # The list grows during the loop: parameters named directly come before those that define them.
    for factor in factors:
        name = factor.parameter
        if name not in visited_names and name in parameters:
            visited_names.add(name)
            yield name
            factors += _factors(mapping(parameters, name).get("equals"))


def _factors(text: object) -> list[Factor]:
    try:
        terms = Expression.parse(text).terms if isinstance(text, (int, str)) else ()
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
        limit = next((key for key in ("min", "max") if key in parameter), "")
        if "read_from" not in parameter:
            problem = "'by_code' needs 'read_from', the register field that holds the code"
            report.add("parameter-origin", ("parameters", name, "by_code"), problem, at_key=True)
        elif limit:
            problem = f"'by_code' already lists the values of {quoted(name)}; leave out {quoted(limit)}"
            report.add("parameter-origin", ("parameters", name, limit), problem, at_key=True)


def alternative_use(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that alternatives affect only the places of fields, because generated code can use them only there.

    Those with a default affect only verdicts, which do not need a choice.
    """
    parameters, alternatives = mapping(raw, "parameters"), by_name(raw, "alternatives")
    decided = {name for name in parameters if "alternative" in mapping(parameters, name)}
    used = [*expressions(spec), *((path, text) for path, _, text in uses(spec, raw) if path[-1] == "when")]
    for path, text in used:
        name = next((factor.parameter for factor in _factors(text) if factor.parameter in decided), None)
        if name is not None and path[-1] not in _WIDTHS:
            alt = mapping(parameters, name)["alternative"]
            problem = (
                f"{quoted(name)} is set by the alternative {quoted(alt)}, so only frames and registers can depend on it"
            )
            report.add("alternative-use", path, f"{problem}; use it only in 'bits' or 'low_bit' of a field")
        elif name is not None and "default" in alternatives.get(mapping(parameters, name)["alternative"], {}):
            alt = mapping(parameters, name)["alternative"]
            problem = f"{quoted(name)} is set by the alternative {quoted(alt)}, whose default applies without a choice"
            remedy = f"use it only in 'makes_position_if' of a flag, or remove 'default' from {quoted(alt)}"
            report.add("alternative-use", path, f"{problem}; {remedy}")


def units(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that exponents are in bits, and that numbers of a measurement and fields have the right unit."""
    parameters = mapping(raw, "parameters")

    def compare(path: Path, factor: Factor, needed_unit: str, use: str) -> None:
        unit = mapping(parameters, factor.parameter).get("unit")
        kind = _KIND_OF.get(str(unit))
        if kind is not None and kind != needed_unit:
            report.add(
                "unit-mismatch",
                path,
                f"{quoted(factor.parameter)} is in {unit}, but {use} must be in"
                f" {'µm' if needed_unit == 'micrometres' else needed_unit}",
            )

    for fields in field_lists(spec):
        for path, field in fields:
            unit, peer = field.get("unit"), mapping(parameters, str(field.get("equals"))).get("unit")
            if unit and peer and _KIND_OF.get(unit, unit) != _KIND_OF.get(str(peer), peer):
                problem = (
                    f"{quoted(field['name'])} is in {unit}, but it equals {quoted(field['equals'])}, which is in {peer}"
                )
                report.add("unit-mismatch", (*path, "unit"), problem)
    for path, text in expressions(spec):
        for factor in _factors(text):
            needed_unit = "bits" if factor.power or path[-1] in _WIDTHS else _MEASURED.get(str(path[-1]), "")
            if needed_unit:
                compare(
                    path,
                    factor,
                    needed_unit,
                    f"the exponent in 2^{factor.parameter}" if factor.power else quoted(path[-1]),
                )
