"""Rules for combinations of keys, which a schema could only check with incomprehensible messages."""

from __future__ import annotations

from collections.abc import Collection

from ...model import INTERFACES, Spi
from ...model.expressions import Expression, ExpressionError
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
MOST_RESERVED_BITS = 4
_OF_FLAGS = (
    "when_active",
    "when_inactive",
    "makes_position",
    "makes_position_if",
    "sums_up",
    "only",
    "remedy",
    "by_hand",
)
_OF_PARITIES = ("parity", "over")
_OF_NUMBERS = ("signed", "zero_means", "power_of_two", "scale", "unit")
#: Kinds of fields that can have the key ``equals``, apart from numbers.
_EXPECTED_ON_DEVICE = ("values", "text")
#: Keys that are not allowed next to ``scale``: one gives 0 another meaning, the other gives a unit of its own.
_NOT_SCALED = ("zero_means", "unit")
#: Keys allowed next to ``use``.
_BESIDE_USE = frozenset(("use", "note", "source"))
#: Kinds with an implied width: a flag and a parity bit have one bit, a CRC its own width.
_WIDTH_FOLLOWS = ("active", "parity_of", "crc")

#: Required keys and additional optional keys of a kind of step or example.
KeysOfKind = tuple[Collection[str], Collection[str]]
#: Keys of the measurement of an angle, and of a length.
ANGLE = ("counts_per_turn", "turns")
LENGTH = ("step_um", "step_nm", "per_counts", "modulus")
_EXAMPLES: dict[str, KeysOfKind] = {
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
    """Check that a field that includes a group is in a layout or register, and has no keys of a field."""
    if fields.kind is Has.GROUP:
        report.add("layout-keys", (*path, "use"), "a field group cannot include another group; list the fields here")
    elif fields.kind is Has.CONTROL:
        report.add("layout-keys", (*path, "use"), "the control data cannot include field groups; list the fields here")
    keys_of_fields = [key for key in field if key not in _BESIDE_USE]
    if keys_of_fields:
        key = keys_of_fields[0]
        message = f"{quoted(key)} is not allowed with 'use'; it belongs to a field of the group"
        report.add("layout-keys", (*path, key), message, at_key=True)


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
    _checkcheck_keys(path, field, report)
    _check_expected_value(path, field, kinds, report)


def _check_expected_value(path: Path, field: Spec, kinds: list[str], report: DocumentReport) -> None:
    """Check that only a number, a text or named values have ``equals``, and that it is of their type."""
    name = quoted(field["name"])
    if isinstance(field.get("equals"), int) and "text" in field:
        report.add("layout-keys", (*path, "equals"), f"{name} is text; put the value in quotes")
    elif "equals" in field and kinds and kinds[0] not in _EXPECTED_ON_DEVICE:
        problem = f"'equals' is only for numbers, text and named values; {name} has {quoted(kinds[0])}"
        report.add("layout-keys", (*path, "equals"), problem, at_key=True)


def _checkcheck_keys(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field has keys of parity bits or CRCs only if it is one."""
    name = quoted(field["name"])
    for key in _OF_PARITIES:
        if key in field and "parity_of" not in field:
            remedy = f"to make {name} a parity bit, add 'parity_of' with the covered field"
            report.add("layout-keys", (*path, key), f"{quoted(key)} is only for parity bits; {remedy}", at_key=True)
    if "crc_of" in field and "crc" not in field:
        problem = f"'crc_of' is only for CRCs; to make {name} a CRC, add 'crc' with its name"
        report.add("layout-keys", (*path, "crc_of"), problem, at_key=True)


def _check_flag_keys(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field has keys of flags only if it is a flag."""
    if "active" in field:
        return
    name = quoted(field["name"])
    for key in _OF_FLAGS:
        is_verdict = key == "makes_position"
        if key not in field or (is_verdict and "unused" in field):
            continue
        if is_verdict and "values" in field:
            remedy = "write it at a value, as in too_weak: {value: 2, makes_position: usable_with_warning}"
            problem = f"{name} has named values, and not each of them has the same effect on the position; {remedy}"
        else:
            problem = f"{quoted(key)} is only for flags; to make {name} a flag, add 'active: high' or 'active: low'"
        report.add("layout-keys", (*path, key), problem, at_key=True)


def _check_others(fields: Fields, path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that ``others`` names few values, none that a master writes, and none like a listed value."""
    if "others" not in field:
        return
    problem = _problem_with_others(fields, field)
    if problem:
        report.add("layout-keys", (*path, "others"), problem, at_key=True)


def _problem_with_others(fields: Fields, field: Spec) -> str:
    """Return the reason that a field cannot have ``others``, and the fix. Empty if it can."""
    name, values = quoted(field["name"]), mapping(field, "values")
    width = constant_width(field)
    if not values:
        return f"'others' names the values that 'values' does not list; {name} also needs 'values'"
    if width is None or width > MOST_RESERVED_BITS:
        return f"'others' gives every value a name, so 'bits' of {name} must be a number from 1 to {MOST_RESERVED_BITS}"
    if fields.owner.get("from") == "master" or fields.owner.get("access", "read_only") != "read_only":
        return f"{name} is written by a master, which does not write reserved values; leave 'others' out"
    reserved_names = {f"{RESERVED}_{number}" for number in range(1 << MOST_RESERVED_BITS)}
    clashing_names = []
    for value_name, value in values.items():
        is_its_own_name = value_name == f"{RESERVED}_{value.get('value')}"
        if value_name in reserved_names and not is_its_own_name:
            clashing_names.append(value_name)
    if clashing_names:
        return f"'others' gives the name {quoted(min(clashing_names))} to another value; rename this one"
    return ""


def _check_width(path: Path, field: Spec, report: DocumentReport) -> None:
    """Check that a field has a width, and that its width and place are given once."""
    name = quoted(field["name"])
    if _is_nothing(field.get("bits")):
        problem = f"{name} has no bits; a field needs at least one, unless its width depends on a parameter"
        report.add("layout-keys", (*path, "bits"), problem)
    places = [key for key in PLACES if key in field]
    has_width = "bits" in field or "at" in field or any(key in field for key in _WIDTH_FOLLOWS)
    if len(places) > 1:
        quantity = "both" if len(places) == 2 else "all"
        problem = f"{listed(map(quoted, places))} {quantity} give the position; keep one of them"
        report.add("layout-keys", (*path, places[1]), problem, at_key=True)
    elif "bits" in field and ":" in str(field.get("at", "")):
        problem = f"the range {quoted(field['at'])} already gives the width; leave 'bits' out"
        report.add("layout-keys", (*path, "bits"), problem, at_key=True)
    elif not has_width:
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
    placed_fields = [field for _, field in fields if _is_placed(field)]
    unplaced_fields = [(path, field) for path, field in fields if not _is_placed(field)]
    if not placed_fields or not unplaced_fields or fields.kind is Has.CONTROL:
        return
    path, field = unplaced_fields[0]
    name = quoted(field.get("name", field.get("use", "")))
    placed_name = quoted(placed_fields[0].get("name", ""))
    message = (
        f"{name} has no position, but {placed_name} has one; "
        "give a position ('at', 'top_bit' or 'low_bit') to all fields of a layout or to none"
    )
    report.add("layout-keys", path, message)


def _is_placed(field: Spec) -> bool:
    return any(key in field for key in PLACES)


def _check_carriage(fields: Fields, raw: Spec, report: DocumentReport) -> None:
    """Check that a layout has only keys for the way in which its interface carries it, as bits or as bytes."""
    layout, interface = fields.owner, INTERFACES[fields.interface]
    carried_as = layout.get("carried_as", interface.carried_as)
    name = quoted(layout["name"])
    if carried_as == "bytes" and "byte_order" not in layout and not _is_one_byte(fields, raw):
        message = f"{name} is carried as bytes, so it needs 'byte_order': low_byte_first or high_byte_first"
        report.add("layout-keys", fields.path, message)
    if carried_as == "bits":
        problem = _wrong_order(fields, name)
        if problem:
            report.add("layout-keys", (*fields.path, "byte_order"), problem, at_key=True)
        if "when" in layout:
            problem = f"'when' only distinguishes frames of bytes, but {name} is carried as bits; leave 'when' out"
            remedy = "" if fields.interface == Spi.name else ", or write 'carried_as: bytes'"
            report.add("layout-keys", (*fields.path, "when"), problem + remedy, at_key=True)
    if "channel" in layout and not interface.has_channels:
        message = f"{name} cannot have a data channel; only BiSS has channels"
        report.add("layout-keys", (*fields.path, "channel"), message, at_key=True)


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
    listed_fields = [field for _, field in fields]
    if all("at" in field or "top_bit" in field for field in listed_fields):
        return max(map(_top_bit, listed_fields), default=0) == 7
    if len(listed_fields) > 1:
        return False
    field = listed_fields[0]
    group = by_name(raw, "field_groups").get(field.get("use", ""), {})
    crc = by_name(raw, "crcs").get(field.get("crc", ""), {})
    width = group.get("bits") or crc.get("width") or field.get("padded_to") or constant_width(field)
    return bool(width == 8)


def _top_bit(field: Spec) -> int:
    """Return the highest bit of a field with a position, or 0 if it depends on the order code."""
    high, _, _ = str(field.get("at")).partition(":")
    top_bit = str(field.get("top_bit", high))
    return int(top_bit) if top_bit.isdecimal() else 0


def byte_order_missing(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers of several bytes have a byte order, because no default is safe."""
    for path, register in items(spec, "registers"):
        interface = INTERFACES.get(interface_of(register))
        # A register without addresses for its bytes is sent as one number.
        has_bytes = interface is None or interface.byte_addresses
        if has_bytes and register["length"] > 1 and "byte_order" not in register:
            message = (
                f"{quoted(register['name'])} has {register['length']} bytes, "
                "so it needs 'byte_order': low_byte_first or high_byte_first"
            )
            report.add("byte-order-missing", path, message)


def example_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each example has the keys of its kind, and that an incorrect one is explained."""
    for path, example in items(spec, "examples"):
        kind: str = example["kind"]
        check_keys("example-shape", f"a {kind} example", path, example.keys(), _EXAMPLES[kind], _ALL_EXAMPLES, report)
        if kind == "frame":
            _check_frame(path, example, report)


def _check_frame(path: Path, example: Spec, report: DocumentReport) -> None:
    """Check that an example of a frame has bits or bytes, its layout, and what the decoder should make of it."""
    has_bytes, has_bits, is_refused = "bytes" in example, "bits" in example, "refused" in example
    if has_bytes and has_bits:
        message = "a frame example needs 'bytes' or 'bits'; this one has both; keep one of them"
        report.add("example-shape", path, message)
    elif not has_bytes and not has_bits:
        report.add("example-shape", path, "a frame example needs 'bytes' or 'bits'; this one has neither")
    elif "layout" not in example and has_bits:
        report.add("example-shape", path, "'layout' is missing; a frame example needs it")
    elif "layout" not in example and not is_refused:
        message = "'layout' is missing; a frame example needs it, or 'refused' if it fits no layout"
        report.add("example-shape", path, message)
    if not is_refused and "values" not in example:
        report.add("example-shape", path, "'values' is missing; a frame example needs it, or 'refused'")
    if is_refused and "erratum" not in example and "note" not in example:
        report.add("example-shape", path, "a refused example needs 'erratum' or 'note' to explain it")


def example_arguments(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an example of a procedure gives all its arguments."""
    procedures = by_name(raw, "procedures")
    for path, example in items(spec, "examples"):
        procedure = procedures.get(example.get("procedure", ""))
        if example["kind"] != "procedure" or procedure is None:
            continue
        given_arguments = mapping(example, "arguments")
        missing_arguments = [quoted(name) for name in by_name(procedure, "arguments") if name not in given_arguments]
        if missing_arguments:
            verb = "is" if len(missing_arguments) == 1 else "are"
            problem = f"{listed(missing_arguments)} {verb} missing from 'arguments' of the example"
            report.add("example-shape", path, problem)


def measurement_shape(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the measurement matches the movement."""
    movement = spec.get("movement")
    if movement not in ("rotary", "linear"):
        return
    own_keys, foreign_keys = (ANGLE, LENGTH) if movement == "rotary" else (LENGTH, ANGLE)
    unit_key, total_key = own_keys[0], own_keys[-1]
    for path, measurement in measurements(spec):
        raw_measurement = mapping(raw, *map(str, path))
        # A key rejected by the schema was removed. It must not be reported as missing, too.
        is_complete = measurement.keys() == raw_measurement.keys()
        if is_complete and unit_key not in measurement and "step_nm" not in measurement:
            message = f"{quoted(unit_key)} is missing; the measurement of a {movement} encoder needs it"
            report.add("measurement-shape", path, message, at_key=True)
        for key in foreign_keys:
            if key in measurement:
                message = f"{quoted(key)} does not apply to a {movement} encoder"
                report.add("measurement-shape", (*path, key), message, at_key=True)
        if movement == "linear":
            _check_step(path, measurement, report)
        if "highest" in measurement and total_key not in raw_measurement:
            problem = f"'highest' has no effect without {quoted(total_key)}; add it, or leave 'highest' out"
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
    total_key, foreign_key = ("turns", "modulus") if movement == "rotary" else ("modulus", "turns")
    if foreign_key in own_range and movement in ("rotary", "linear"):
        problem = f"{quoted(foreign_key)} does not apply to a {movement} encoder; write {quoted(total_key)}"
        report.add("measurement-shape", (*path, foreign_key), problem, at_key=True)
    if "wraps" in own_range:
        contradictions = [key for key in ("turns", "modulus", "highest") if key in own_range]
        if contradictions:
            problem = f"{quoted(contradictions[0])} contradicts 'wraps: false'; leave one of the two out"
            report.add("measurement-shape", (*path, contradictions[0]), problem, at_key=True)
        return
    stated_keys = own_range.keys() | measurement.keys()
    has_total = total_key in stated_keys or "modulus" in stated_keys
    if "highest" in own_range and not has_total:
        problem = f"'highest' has no effect without {quoted(total_key)}; add it, or leave 'highest' out"
        report.add("measurement-shape", (*path, "highest"), problem, at_key=True)


def _check_step(path: Path, measurement: Spec, report: DocumentReport) -> None:
    """Check that a length has one step, and that ``per_counts`` belongs to a step in nanometres."""
    if "step_um" in measurement and "step_nm" in measurement:
        problem = "'step_um' and 'step_nm' exclude each other; keep the one that is a whole number"
        report.add("measurement-shape", (*path, "step_nm"), problem, at_key=True)
    elif "per_counts" in measurement and "step_nm" not in measurement:
        problem = "'per_counts' is only for 'step_nm', the number of nanometres for that many counts"
        report.add("measurement-shape", (*path, "per_counts"), problem, at_key=True)


def check_keys(
    rule: str,
    subject: str,
    path: Path,
    given_keys: Collection[str],
    keys_of_kind: KeysOfKind,
    keys_of_all: Collection[str],
    report: DocumentReport,
) -> None:
    """Check that a step or example has the keys that its kind requires, and no keys of other kinds."""
    required_keys, optional_keys = keys_of_kind
    missing_keys = [key for key in required_keys if key not in given_keys]
    if missing_keys:
        report.add(rule, path, missing(missing_keys, subject))
    for key in given_keys:
        if key not in (*required_keys, *optional_keys, *keys_of_all):
            report.add(rule, (*path, key), f"{quoted(key)} does not apply to {subject}", at_key=True)
