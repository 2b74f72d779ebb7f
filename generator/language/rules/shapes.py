"""Rules for combinations of keys, which a schema could only check with incomprehensible messages."""

from __future__ import annotations

from collections.abc import Collection

from ...model import INTERFACES, Spi
from ...model.expressions import Expression, ExpressionError
from ...say.text import counted
from ..problems import DocumentReport, Path, listed, missing, quoted
from .values import constant_width
from .walk import (
    Fields,
    Has,
    Spec,
    by_name,
    field_lists,
    interface_of,
    items,
    layouts,
    mapping,
    measurements,
    position_ranges,
    readable_names,
)

#: Keys that define the kind of a field. A field without any is a number.
KINDS = ("constant", "unused", "active", "values", "values_of", "crc", "parity_of", "digits", "text")
#: Keys that give the place of a field.
PLACES = ("at", "top_bit", "low_bit")
#: Begins the names of values that a manual reserves.
RESERVED = "reserved"
#: Each of the values gets a name in every output, so there cannot be many.
_MOST_RESERVED_BITS = 4
_OF_FLAGS = ("when_active", "when_inactive", "makes_position", "makes_position_if", "sums_up")
_OF_PARITIES = ("parity", "over")
_OF_NUMBERS = ("signed", "zero_means", "power_of_two", "scale")
#: Keys that are not allowed next to ``scale``: one gives 0 another meaning, the other gives a unit of its own.
_NOT_SCALED = ("zero_means", "unit")
#: Keys allowed next to ``use``.
_BESIDE_USE = frozenset(("use", "note", "source"))
#: Kinds with an implied width: a flag and a parity bit have one bit, a CRC its own width.
_WIDTH_FOLLOWS = ("active", "parity_of", "crc")

#: Required keys and additional optional keys of a kind of step or example.
_Keys = tuple[Collection[str], Collection[str]]
_STEPS: dict[str, _Keys] = {
    "write": (("register", "value"), ("field",)),
    "read": (("register",), ("field",)),
    "poll": (("register", "field", "until"), ()),
    "wait": (("at_least_ms",), ()),
    "send": (("data_id",), ("times", "every_at_least_us", "in_succession")),
}
#: Keys of the measurement of an angle, and of a length.
ANGLE = ("counts_per_turn", "turns")
LENGTH = ("step_um", "step_nm", "per_counts", "modulus")
_ALL_STEPS = frozenset(("do", "meaning", "source"))
_EXAMPLES: dict[str, _Keys] = {
    "frame": ((), ("order_code", "alternatives", "layout", "from", "bytes", "bits", "values", "refused")),
    "register": (("register", "bytes", "values"), ("order_code",)),
    "crc": (("crc", "bytes", "check"), ()),
    "procedure": (("procedure", "writes"), ("order_code", "arguments")),
    "measure": (("order_code", "counts", "micrometres"), ()),
}
_ALL_EXAMPLES = frozenset(("name", "kind", "source", "erratum", "note"))


def layout_keys(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that fields and layouts have valid combinations of keys."""
    for fields in field_lists(spec):
        for path, field in fields:
            if "use" in field:
                _check_use(fields, path, field, report)
            else:
                _check_field(path, field, report)
                _check_others(fields, path, field, report)
        _check_placing(fields, report)
        if fields.kind is Has.LAYOUT:
            _check_carriage(fields, raw, report)


def _check_use(fields: Fields, path: Path, field: Spec, report: DocumentReport) -> None:
    if fields.kind is Has.GROUP:
        report.add("layout-keys", (*path, "use"), "a field group cannot include another group; list the fields here")
    elif fields.kind is Has.CONTROL:
        report.add("layout-keys", (*path, "use"), "the control data cannot include field groups; list the fields here")
    beside = [key for key in field if key not in _BESIDE_USE]
    if beside:
        report.add(
            "layout-keys",
            (*path, beside[0]),
            f"{quoted(beside[0])} is not allowed with 'use'; it belongs to a field of the group",
            at_key=True,
        )


def _check_field(path: Path, field: Spec, report: DocumentReport) -> None:
    if "name" not in field:
        report.add("layout-keys", path, "a field needs 'name', or 'use' to include a group")
        return
    _check_kind(path, field, report)
    _check_width(path, field, report)


def _check_kind(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field is of one kind, and has only keys of that kind."""
    name = quoted(field["name"])
    kinds = [key for key in KINDS if key in field]
    if len(kinds) > 1:
        problem = f"{listed(map(quoted, kinds))} exclude each other; keep one of them"
        report.add("layout-keys", (*path, kinds[1]), problem, at_key=True)
    for key in _OF_NUMBERS:
        if key in field and kinds:
            problem = f"{quoted(key)} is only for numbers; {name} has {quoted(kinds[0])}, so it is not a number"
            report.add("layout-keys", (*path, key), problem, at_key=True)
    for key in _NOT_SCALED:
        if key in field and "scale" in field:
            problem = f"{quoted(key)} and 'scale' exclude each other; keep one of them"
            report.add("layout-keys", (*path, key), problem, at_key=True)
    _check_flag_keys(path, field, report)
    for key in _OF_PARITIES:
        if key in field and "parity_of" not in field:
            problem = (
                f"{quoted(key)} is only for parity bits; to make {name} a parity bit, add 'parity_of' with the covered"
                " field"
            )
            report.add("layout-keys", (*path, key), problem, at_key=True)
    if "crc_of" in field and "crc" not in field:
        problem = f"'crc_of' is only for CRCs; to make {name} a CRC, add 'crc' with its name"
        report.add("layout-keys", (*path, "crc_of"), problem, at_key=True)
    if isinstance(field.get("equals"), int) and "text" in field:
        report.add("layout-keys", (*path, "equals"), f"{name} is text; put the value in quotes")


def _check_flag_keys(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field has keys of flags only if it is a flag."""
    name = quoted(field["name"])
    for key in _OF_FLAGS:
        if key in field and "active" not in field and not (key == "makes_position" and "unused" in field):
            problem = f"{quoted(key)} is only for flags; to make {name} a flag, add 'active: high' or 'active: low'"
            if key == "makes_position" and "values" in field:
                remedy = "write it at a value, as in too_weak: {value: 2, makes_position: usable_with_warning}"
                problem = f"{name} has named values, and not each of them has the same effect on the position; {remedy}"
            report.add("layout-keys", (*path, key), problem, at_key=True)


def _check_others(fields: Fields, path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that ``others`` names few values, none that a master writes, and none like a listed value."""
    if "others" not in field:
        return
    name, values, problem = quoted(field["name"]), mapping(field, "values"), ""
    width = constant_width(field)
    if not values:
        problem = f"'others' names the values that 'values' does not list; {name} also needs 'values'"
    elif width is None or width > _MOST_RESERVED_BITS:
        problem = (
            f"'others' gives every value a name, so 'bits' of {name} must be a number from 1 to {_MOST_RESERVED_BITS}"
        )
    elif fields.owner.get("from") == "master" or fields.owner.get("access", "read_only") != "read_only":
        problem = f"{name} is written by a master, which does not write reserved values; leave 'others' out"
    names_for_others = {f"{RESERVED}_{number}" for number in range(1 << _MOST_RESERVED_BITS)}
    renamed = {name for name, value in values.items() if name != f"{RESERVED}_{value.get('value')}"}
    reserved_names = names_for_others & renamed
    if not problem and reserved_names:
        problem = f"'others' gives the name {quoted(min(reserved_names))} to another value; rename this one"
    if problem:
        report.add("layout-keys", (*path, "others"), problem, at_key=True)


def _check_width(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field has a width, and that its width and place are given once."""
    name = quoted(field["name"])
    if _is_nothing(field.get("bits")):
        problem = f"{name} has no bits; a field needs at least one, unless its width depends on a parameter"
        report.add("layout-keys", (*path, "bits"), problem)
    keys = [key for key in PLACES if key in field]
    if len(keys) > 1:
        problem = (
            f"{listed(map(quoted, keys))} {'both' if len(keys) == 2 else 'all'} give the position; keep one of them"
        )
        report.add("layout-keys", (*path, keys[1]), problem, at_key=True)
    elif "bits" in field and ":" in str(field.get("at", "")):
        problem = f"the range {quoted(field['at'])} already gives the width; leave 'bits' out"
        report.add("layout-keys", (*path, "bits"), problem, at_key=True)
    elif "bits" not in field and "at" not in field and not any(key in field for key in _WIDTH_FOLLOWS):
        report.add("layout-keys", path, f"{name} has no width; give it 'bits', or 'at' with a range such as 7:6")


def _is_nothing(bits: object) -> bool:
    """Return True if a width is a plain number that is not valid for a field."""
    try:
        width = Expression.parse(bits) if isinstance(bits, (int, str)) else None
    except ExpressionError:  # Reported by the rule on expressions.
        return False
    return width is not None and width.is_constant and width.constant <= 0


def _check_placing(fields: Fields, report: DocumentReport) -> None:
    """Check that either all or none of the fields of a layout have positions."""
    listed_fields = list(fields)
    placed_fields = [(path, field) for path, field in listed_fields if _is_placed(field)]
    if not placed_fields or len(placed_fields) == len(listed_fields):
        return
    if fields.kind is Has.CONTROL:
        return
    path, field = next((path, field) for path, field in listed_fields if not _is_placed(field))
    name = quoted(field.get("name", field.get("use", "")))
    placed_name = quoted(placed_fields[0][1].get("name", ""))
    report.add(
        "layout-keys",
        path,
        f"{name} has no position, but {placed_name} has one; "
        "give a position ('at', 'top_bit' or 'low_bit') to all fields of a layout or to none",
    )


def _is_placed(field: Spec) -> bool:
    return any(key in field for key in PLACES)


def _check_carriage(fields: Fields, raw: Spec, report: DocumentReport) -> None:
    layout = fields.owner
    carried_as = layout.get("carried_as", INTERFACES[fields.interface].carried_as)
    name = quoted(layout["name"])
    if carried_as == "bytes" and "byte_order" not in layout and not _is_one_byte(fields, raw):
        report.add(
            "layout-keys",
            fields.path,
            f"{name} is carried as bytes, so it needs 'byte_order': low_byte_first or high_byte_first",
        )
    if carried_as == "bits" and (problem := _wrong_order(fields, name)):
        report.add("layout-keys", (*fields.path, "byte_order"), problem, at_key=True)
    if carried_as == "bits" and "when" in layout:
        problem = f"'when' only distinguishes frames of bytes, but {name} is carried as bits; leave 'when' out"
        remedy = "" if fields.interface == Spi.name else ", or write 'carried_as: bytes'"
        report.add("layout-keys", (*fields.path, "when"), problem + remedy, at_key=True)
    if "channel" in layout and not INTERFACES[fields.interface].has_channels:
        report.add(
            "layout-keys",
            (*fields.path, "channel"),
            f"{name} cannot have a data channel; only BiSS has channels",
            at_key=True,
        )


def _wrong_order(fields: Fields, name: str) -> str:
    """Return what is wrong with the byte order of a layout that is carried as bits. Empty if nothing is.

    Over SPI, it states in which order the bytes of a joined number are sent.
    """
    layout = fields.owner
    if "byte_order" not in layout:
        return ""
    if fields.interface != Spi.name:
        return f"{name} is carried as bits, which have no byte order; leave 'byte_order' out"
    if layout["byte_order"] == "high_byte_first":
        return f"{name} is sent over SPI, high byte first unless it says otherwise; leave 'byte_order' out"
    if "join" not in layout:
        return f"{name} sends the low byte first, so describe each byte as a field, and 'join' them"
    return ""


def _is_one_byte(fields: Fields, raw: Spec) -> bool:
    """Return True if the layout is one byte whose fields need no order: a single field, or all with positions."""
    groups, crcs = by_name(raw, "field_groups"), by_name(raw, "crcs")
    listed_fields = [field for _, field in fields]
    if all("at" in field or "top_bit" in field for field in listed_fields):
        tops = [field.get("top_bit", str(field.get("at")).partition(":")[0]) for field in listed_fields]
        return max((int(top) for top in tops if str(top).isdecimal()), default=0) == 7
    if len(listed_fields) > 1:
        return False
    field = listed_fields[0]
    owner = groups.get(field.get("use", "")) or crcs.get(field.get("crc", "")) or {}
    return (owner.get("bits") or owner.get("width") or field.get("padded_to") or constant_width(field)) == 8


def byte_order_missing(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers of several bytes have a byte order, because no default is safe."""
    for path, register in items(spec, "registers"):
        kind = INTERFACES.get(interface_of(register))
        if register["length"] > 1 and "byte_order" not in register and (kind is None or kind.byte_addresses):
            message = (
                f"{quoted(register['name'])} has {register['length']} bytes, "
                "so it needs 'byte_order': low_byte_first or high_byte_first"
            )
            report.add("byte-order-missing", path, message)


def step_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each step has the keys of its kind."""
    for path, procedure in items(spec, "procedures"):
        for below, step in items(procedure, "steps"):
            kind: str = step["do"]
            _check_keys("step-shape", f"a {kind} step", (*path, *below), step, _STEPS[kind], _ALL_STEPS, report)
            _check_repeated((*path, *below), step, report)


def _check_repeated(path: Path, step: Spec, report: DocumentReport) -> None:
    """Check that conditions between the requests of a step are only given for several requests."""
    condition = next((key for key in ("in_succession", "every_at_least_us") if step.get(key)), None)
    if step["do"] == "send" and condition is not None and step.get("times", 1) == 1:
        request_count = "sends one" if "times" in step else "has no 'times'"
        key = quoted(condition)
        problem = f"{key} applies to several requests, but the step {request_count}; add 'times', or remove {key}"
        report.add("step-shape", (*path, condition), problem, at_key=True)


def example_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each example has the keys of its kind, and that an incorrect one is explained."""
    for path, example in items(spec, "examples"):
        kind: str = example["kind"]
        _check_keys("example-shape", f"a {kind} example", path, example, _EXAMPLES[kind], _ALL_EXAMPLES, report)
        if kind == "frame":
            _check_frame(path, example, report)


def _check_frame(path: Path, example: Spec, report: DocumentReport) -> None:
    if ("bytes" in example) == ("bits" in example):
        fault = "has both; keep one of them" if "bits" in example else "has neither"
        report.add("example-shape", path, f"a frame example needs 'bytes' or 'bits'; this one {fault}")
    elif "layout" not in example and ("bits" in example or "refused" not in example):
        report.add(
            "example-shape",
            path,
            "'layout' is missing; a frame example needs it"
            + ("" if "bits" in example else ", or 'refused' if it fits no layout"),
        )
    if "refused" in example:
        if "erratum" not in example and "note" not in example:
            report.add("example-shape", path, "a refused example needs 'erratum' or 'note' to explain it")
    elif "values" not in example:
        report.add("example-shape", path, "'values' is missing; a frame example needs it, or 'refused'")


def example_arguments(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an example of a procedure gives all its arguments."""
    procedures = by_name(raw, "procedures")
    for path, example in items(spec, "examples"):
        procedure = procedures.get(example.get("procedure", ""))
        if example["kind"] == "procedure" and procedure is not None:
            given_arguments = mapping(example, "arguments")
            names = [quoted(name) for name in by_name(procedure, "arguments") if name not in given_arguments]
            if names:
                problem = (
                    f"{listed(names)} {'is' if len(names) == 1 else 'are'} missing from 'arguments' of the example"
                )
                report.add("example-shape", path, problem)


def measurement_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the measurement matches the movement."""
    movement = spec.get("movement")
    if movement not in ("rotary", "linear"):
        return
    needed_keys, foreign = (ANGLE, LENGTH) if movement == "rotary" else (LENGTH, ANGLE)
    for path, measurement in measurements(spec):
        # A key rejected by the schema was removed. It must not be reported as missing, too.
        stated_keys = measurement.keys()
        if not stated_keys & {needed_keys[0], "step_nm"} and stated_keys == mapping(raw, *map(str, path)).keys():
            report.add(
                "measurement-shape",
                path,
                f"{quoted(needed_keys[0])} is missing; the measurement of a {movement} encoder needs it",
                at_key=True,
            )
        for key in foreign:
            if key in measurement:
                report.add(
                    "measurement-shape",
                    (*path, key),
                    f"{quoted(key)} does not apply to a {movement} encoder",
                    at_key=True,
                )
        if movement == "linear":
            _check_step(path, measurement, report)
        if "highest" in measurement and needed_keys[-1] not in mapping(raw, *map(str, path)):
            problem = f"'highest' has no effect without {quoted(needed_keys[-1])}; add it, or leave 'highest' out"
            report.add("measurement-shape", (*path, "highest"), problem, at_key=True)


def position_range_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the range of one layout has a position to refer to, and matches the movement."""
    groups = by_name(raw, "field_groups")
    owners = {fields.path: fields for fields in layouts(raw)}
    movement = spec.get("movement")
    for path, interface, own_range in position_ranges(spec):
        measurement = mapping(raw, "interfaces", interface, "measurement") or mapping(raw, "measurement")
        fields = owners[path[:-1]]
        name = quoted(fields.owner.get("name"))
        if not measurement:
            problem = "'position_range' needs a 'measurement', which gives the unit of the position"
            report.add("measurement-shape", path, f"{problem}; add it to the interface or the encoder", at_key=True)
        elif fields.owner.get("from") != "encoder" or measurement.get("of") not in readable_names(fields, groups):
            problem = f"{name} does not carry the position, {quoted(measurement.get('of'))}, to the master"
            report.add("measurement-shape", path, f"{problem}; leave 'position_range' out", at_key=True)
        _check_range_keys(path, own_range, measurement, str(movement), report)


def _check_range_keys(path: Path, own_range: Spec, measurement: Spec, movement: str, report: DocumentReport) -> None:
    """Check that the keys of a range belong together."""
    total, foreign = ("turns", "modulus") if movement == "rotary" else ("modulus", "turns")
    if foreign in own_range and movement in ("rotary", "linear"):
        problem = f"{quoted(foreign)} does not apply to a {movement} encoder; write {quoted(total)}"
        report.add("measurement-shape", (*path, foreign), problem, at_key=True)
    if "wraps" in own_range:
        for key in [key for key in ("turns", "modulus", "highest") if key in own_range][:1]:
            problem = f"{quoted(key)} contradicts 'wraps: false'; leave one of the two out"
            report.add("measurement-shape", (*path, key), problem, at_key=True)
    elif "highest" in own_range and not {total, "modulus"} & {*own_range, *measurement}:
        problem = f"'highest' has no effect without {quoted(total)}; add it, or leave 'highest' out"
        report.add("measurement-shape", (*path, "highest"), problem, at_key=True)


def _check_step(path: Path, measurement: Spec, report: DocumentReport) -> None:
    """Check that a length has one step, and that ``per_counts`` belongs to a step in nanometres."""
    if "step_um" in measurement and "step_nm" in measurement:
        problem = "'step_um' and 'step_nm' exclude each other; keep the one that is a whole number"
        report.add("measurement-shape", (*path, "step_nm"), problem, at_key=True)
    elif "per_counts" in measurement and "step_nm" not in measurement:
        problem = "'per_counts' is only for 'step_nm', the number of nanometres for that many counts"
        report.add("measurement-shape", (*path, "per_counts"), problem, at_key=True)


def table_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each row of a table has one cell per column."""
    for path, table in items(spec, "tables"):
        columns = len(table["columns"])
        for index, row in enumerate(table["rows"]):
            if len(row) != columns:
                message = f"the row has {counted(len(row), 'cell')}, but the table has {counted(columns, 'column')}"
                report.add("table-shape", (*path, "rows", index), message)


def _check_keys(
    rule: str,
    subject: str,
    path: Path,
    spec: Spec,
    of_kind: _Keys,
    of_all: Collection[str],
    report: DocumentReport,
) -> None:
    needed_keys, optional = of_kind
    missing_keys = [key for key in needed_keys if key not in spec]
    if missing_keys:
        report.add(rule, path, missing(missing_keys, subject))
    for key in spec:
        if key not in (*needed_keys, *optional, *of_all):
            report.add(rule, (*path, key), f"{quoted(key)} does not apply to {subject}", at_key=True)
