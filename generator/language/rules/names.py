"""Rules for names and numbers that must be unique."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..problems import MISSING_PROSE, DocumentReport, Path, quoted
from ..schema_files import family_of
from .walk import Spec, by_name, expanded, field_lists, interface_of, items, last_address, layouts, mapping

#: Top-level lists with unique items, with the word for an item and the key that must be unique.
_LISTS = (
    ("crcs", "a CRC", "name"),
    ("field_groups", "a field group", "name"),
    ("registers", "a register", "name"),
    ("alarms", "an alarm", "name"),
    ("procedures", "a procedure", "name"),
    ("timings", "a timing", "name"),
    ("inputs", "an input", "name"),
    ("tables", "a table", "name"),
    ("connectors", "a connector", "name"),
    ("leds", "an LED", "name"),
    ("characteristics", "a characteristic", "name"),
    ("examples", "an example", "name"),
    ("errata", "an erratum", "name"),
)

#: The same for lists in these items.
_INNER_LISTS = (
    ("registers", "meanings", "name", "a meaning"),
    ("procedures", "arguments", "name", "an argument"),
    ("connectors", "contacts", "contact", "a contact"),
    ("leds", "states", "state", "a state"),
)

#: Keys of a data ID that must be unique, each with the word for such a data ID.
_DATA_ID_LABELS = (
    ("name", "a data ID"),
    ("id", "a data ID with the number"),
    ("control", "a data ID with the control field"),
)

#: Family names reserved by an output, with the reason.
TAKEN = {
    "encoder": "the C header that all families share",
    "biss": "the BiSS part of the Python package",
    **dict.fromkeys(
        ("decode_file", "decode_partition", "identify", "lookup", "run", "why"), "a function of the Python package"
    ),
    "nearest": "a function of the Python package",
    "annotations": "a Python attribute",
    # Windows reserves these file names, whatever their suffix.
    **dict.fromkeys(
        ("con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10))),
        "a Windows device",
    ),
}

Named = tuple[Path, object]


def device_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a family and its file have the same name."""
    stem = report.document.family or family_of(report.document.file)
    if "device" in spec and spec["device"] != stem:
        report.add(
            "device-name",
            ("device",),
            f"the device is called {quoted(spec['device'])}, but the file is called {quoted(stem)}; use the same name"
            " for both",
        )
    if spec.get("device") in TAKEN:
        report.add(
            "device-name",
            ("device",),
            f"{quoted(spec['device'])} is the name of {TAKEN[spec['device']]}; rename the family",
        )


def duplicate_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that names are unique among items of one kind."""
    for key, word, label in _LISTS:
        _check_unique(_labels(items(spec, key), label), word, report)
    named_layouts = [(layout.path, layout.owner) for layout in layouts(spec)]
    _check_unique(_labels(named_layouts, "name"), "a layout", report)
    for interface in mapping(spec, "interfaces"):
        _check_unique(_labels(items(spec, "interfaces", interface, "timings"), "name"), "a timing", report)
        for label, word in _DATA_ID_LABELS:
            _check_unique(_labels(items(spec, "interfaces", interface, "data_ids"), label), word, report)
    _check_unique(_labels(items(spec, "manual", "editions"), "language"), "a language", report)
    _check_unique(_labels(items(spec, "manual", "history"), "revision"), "a revision", report)
    _check_unique(_labels(items(spec, "order_code", "parts"), "name"), "a part", report)
    for key, inner_key, label, word in _INNER_LISTS:
        for path, owner in items(spec, key):
            inner_items = [((*path, *inner_path), inner) for inner_path, inner in items(owner, inner_key)]
            _check_unique(_labels(inner_items, label), word, report)


def duplicate_title(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no two errata have the same title, because readers see only the title."""
    first_paths: dict[object, Path] = {}
    for path, erratum in items(spec, "errata"):
        if erratum["title"] == MISSING_PROSE:
            continue
        first_path = first_paths.setdefault(erratum["title"], path)
        if first_path != path:
            line = report.document.position((*first_path, "title"))[0]
            message = f"the erratum on line {line} has the same title; say what differs in this one"
            report.add("duplicate-name", (*path, "title"), message)


def duplicate_field(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that fields, joins and runs of digits of a layout have unique names, as a decoder returns all of them."""
    groups = by_name(spec, "field_groups")
    for fields in field_lists(spec):
        named_values: list[Named] = []
        use_paths = {path for path, field in fields if "use" in field}
        for path, field in expanded(fields, groups):
            # A name in a group is reported at its use, because that is what makes it occur twice.
            name_path = path if path in use_paths else (*path, "name")
            named_values.append((name_path, field.get("name")))
            named_values += [((*path, *run_path, "name"), run["name"]) for run_path, run in items(field, "digits")]
        named_values += [((*fields.path, "join", name), name) for name in mapping(fields.owner, "join")]
        _check_unique(named_values, "a field", report)


def duplicate_selection(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each value of the selecting field identifies one frame of its sender."""
    first_names: dict[tuple[str, object, object], object] = {}
    for layout in layouts(spec):
        name, sender = layout.owner["name"], layout.owner.get("from")
        for selector, values in mapping(layout.owner, "when").items():
            for index, value in enumerate(values):
                first_name = first_names.setdefault((layout.interface, sender, value), name)
                if first_name != name:
                    fault = f"used by {quoted(first_name)}"
                elif value in values[:index]:
                    fault = "listed"
                else:
                    continue
                message = (
                    f"{quoted(selector)} {value} is already {fault}; use each value for only one frame of the {sender}"
                )
                report.add("duplicate-name", (*layout.path, "when", selector, index), message)


def duplicate_address(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no two registers of an interface and bank share a byte.

    A read-only and a write-only register may have the same address.
    """
    by_address = sorted(items(spec, "registers"), key=lambda path_and_register: path_and_register[1]["address"])
    for index, (path, register) in enumerate(by_address):
        # Registers are short, so only the nearest ones can overlap. The limit bounds the time for long lists.
        for lower_path, lower_register in reversed(by_address[max(0, index - 128) : index]):
            if not _share_a_byte(lower_register, register):
                continue
            # The one that comes later in the file is reported.
            if path < lower_path:
                _report_overlap(lower_path, lower_register, path, register, report)
            else:
                _report_overlap(path, register, lower_path, lower_register, report)
            break


def _share_a_byte(lower_register: Spec, register: Spec) -> bool:
    """Return True if a register has an address of one that begins at the same address or below, and must not."""
    if _address_space(lower_register) != _address_space(register):
        return False
    if last_address(lower_register) < register["address"]:
        return False
    accesses = {register["access"], lower_register["access"]}
    is_read_write_pair = accesses == {"read_only", "write_only"}
    return not (is_read_write_pair and register["address"] == lower_register["address"])


def _report_overlap(
    path: Path, register: Spec, earlier_path: Path, earlier_register: Spec, report: DocumentReport
) -> None:
    """Report a register that overlaps one that comes earlier in the file."""
    line, _ = report.document.position(earlier_path)
    has_one_address = register["address"] == last_address(register)
    verb = "overlaps" if has_one_address else "overlap"
    message = (
        f"{_address_range(register)} {verb} {quoted(earlier_register['name'])} on line {line}, "
        f"which has {_address_range(earlier_register)}"
    )
    report.add("duplicate-address", (*path, "address"), message)


def value_clash(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no two names have the same number, because a decoder could not choose."""
    for fields in field_lists(spec):
        for path, field in fields:
            first_names: dict[int, str] = {}
            for name, value in mapping(field, "values").items():
                first_name = first_names.setdefault(value["value"], name)
                if first_name != name:
                    message = f"{value['value']:#x} is already {quoted(first_name)}; a number can have only one name"
                    report.add("value-clash", (*path, "values", name, "value"), message)


def _labels(owners: Iterable[tuple[Path, Spec]], label: str) -> Iterator[Named]:
    """Yield the value under the key ``label`` of each item, with its path."""
    for path, owner in owners:
        yield (*path, label), owner[label]


def _check_unique(named_values: Iterable[Named], word: str, report: DocumentReport) -> None:
    """Report every value equal to an earlier one. ``word`` is the kind of item, with its article."""
    first_paths: dict[object, Path] = {}
    for path, value in named_values:
        if value is None:
            continue
        first_path = first_paths.setdefault(value, path)
        if first_path == path:
            continue
        value_text = f"{value:#04x}" if isinstance(value, int) else quoted(value)
        line, _ = report.document.position(first_path)
        message = f"there is already {word} {value_text} on line {line}; rename one of them"
        is_key_of_join = path[-2] == "join"
        report.add("duplicate-name", path, message, at_key=is_key_of_join)


def _address_space(register: Spec) -> tuple[str, object]:
    """Return the address space of a register. Each bank is a space, and the area without banks is another."""
    return interface_of(register), register.get("bank")


def _address_range(register: Spec) -> str:
    first, last = register["address"], last_address(register)
    return f"address {first:#04x}" if first == last else f"addresses {first:#04x} to {last:#04x}"
