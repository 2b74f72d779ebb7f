"""Rules on parameters: over which interface they hold, and in which unit they count."""

from __future__ import annotations

from collections.abc import Iterator

from ..expressions import Expression, ExpressionError, Factor
from ..problems import DocumentReport, Path, quoted
from .shapes import ANGLE, LENGTH
from .walk import Fields, Spec, by_name, expanded, interface_of, items, layouts, mapping

#: What units count, in the words that manuals have for them. A unit that is not here is taken as it is.
_KINDS = {
    "bits": ("bit", "bits"),
    "micrometres": ("um", "µm", "μm", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"),
    "another length": ("nm", "mm", "cm", "m", "millimetre", "millimetres", "millimeters", "inch", "inches"),
    "revolutions": ("revolution", "revolutions", "turn", "turns", "rev", "revs"),
    "counts": ("count", "counts", "step", "steps", "position", "positions", "increments"),
}
_KIND_OF = {unit: kind for kind, units in _KINDS.items() for unit in units}
#: What each number of a measurement counts.
_MEASURED = {"steps_per_turn": "counts", "turns": "revolutions", "step_um": "micrometres", "steps": "counts"}


def parameter_interface(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """A parameter that holds over one interface is not used for another."""
    parameters = mapping(raw, "parameters")
    for path, interface, text in uses(spec, raw):
        for name in dict.fromkeys(all_parameters(text, parameters)):
            of = mapping(parameters, name).get("interface")
            if isinstance(of, str) and of != interface:
                report.add(
                    "parameter-interface",
                    path,
                    f"{quoted(name)} holds over {of} only, by its 'interface'; this is {interface}",
                )
                break


def uses(spec: Spec, raw: Spec | None = None) -> Iterator[tuple[Path, str, int | str]]:
    """Where an interface uses expressions and parameters: the place, the interface, and the text."""
    groups = by_name(raw if raw is not None else spec, "field_groups")
    registers = (
        Fields("register", register, path, interface_of(register)) for path, register in items(spec, "registers")
    )
    for fields in (*layouts(spec), *registers):
        for path, field in expanded(fields, groups):
            keys = ("bits",) if "text" in field else ("bits", "equals")
            yield from (((*path, key), fields.interface, field[key]) for key in keys if key in field)
        for key in ("min", "max"):
            if key in fields.owner:
                yield (*fields.path, key), fields.interface, fields.owner[key]
        for below, meaning in items(fields.owner, "meanings"):
            yield from (
                ((*fields.path, *below, key), fields.interface, meaning[key])
                for key in ("min", "max")
                if key in meaning
            )
        if "gray" in fields.owner:
            yield (*fields.path, "gray", "when"), fields.interface, fields.owner["gray"]["when"]
    for kind, interface in mapping(spec, "interfaces").items():
        own = "measurement" in interface
        here: Path = ("interfaces", kind, "measurement") if own else ("measurement",)
        measurement = mapping(interface if own else spec, "measurement")
        yield from (((*here, key), kind, measurement[key]) for key in (*ANGLE, *LENGTH) if key in measurement)


def all_parameters(text: object, parameters: Spec) -> Iterator[str]:
    """The parameters in an expression, and those from which they follow."""
    factors, seen = _factors(text), set()
    # The list grows while it is gone through: what is named itself comes before what it follows from.
    for factor in factors:
        name = factor.parameter
        if name not in seen and name in parameters:
            seen.add(name)
            yield name
            factors += _factors(mapping(parameters, name).get("equals"))


def _factors(text: object) -> list[Factor]:
    try:
        terms = Expression.parse(text).terms if isinstance(text, (int, str)) else ()
    except ExpressionError:  # Reported by the rule on expressions.
        return []
    return [factor for term in terms for factor in term.factors]


def units(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Two to the power of a parameter needs bits, and what a measurement counts needs the unit of that."""
    parameters = mapping(raw, "parameters")

    def compare(path: Path, factor: Factor, needed: str, use: str) -> None:
        unit = mapping(parameters, factor.parameter).get("unit")
        kind = _KIND_OF.get(str(unit))
        if kind is not None and kind != needed:
            report.add("unit-mismatch", path, f"{quoted(factor.parameter)} is in {unit}; {use} needs {'µm' if needed == 'micrometres' else needed}")

    for path, text in _counted(spec):
        for factor in _factors(text):
            needed = "bits" if factor.power else _MEASURED.get(str(path[-1]), "")
            if needed:
                compare(path, factor, needed, f"the exponent in 2^{factor.parameter}" if factor.power else quoted(path[-1]))


def _counted(spec: Spec) -> Iterator[tuple[Path, object]]:
    """Every expression whose unit is known: those of measurements, and those that parameters follow from."""
    for name, parameter in mapping(spec, "parameters").items():
        if "equals" in parameter:
            yield ("parameters", name, "equals"), parameter["equals"]
    owners: list[tuple[Path, Spec]] = [
        ((), spec),
        *((("interfaces", kind), item) for kind, item in mapping(spec, "interfaces").items()),
    ]
    for path, owner in owners:
        yield from (
            ((*path, "measurement", key), text)
            for key, text in mapping(owner, "measurement").items()
            if key in _MEASURED
        )
