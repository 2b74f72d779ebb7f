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
    _check_unique(_labels(((layout.path, layout.owner) for layout in layouts(spec)), "name"), "a layout", report)
    for interface in mapping(spec, "interfaces"):
        _check_unique(_labels(items(spec, "interfaces", interface, "timings"), "name"), "a timing", report)
        for key, word in (
            ("name", "a data ID"),
            ("id", "a data ID with the number"),
            ("control", "a data ID with the control field"),
        ):
            _check_unique(_labels(items(spec, "interfaces", interface, "data_ids"), key), word, report)
    for key, label in (("editions", "language"), ("history", "revision")):
        _check_unique(_labels(items(spec, "manual", key), label), f"a {label}", report)
    _check_unique(_labels(items(spec, "order_code", "parts"), "name"), "a part", report)
    for key, inner, label, word in _INNER_LISTS:
        for path, owner in items(spec, key):
            entries = [((*path, *inner_path), inner_spec) for inner_path, inner_spec in items(owner, inner)]
            _check_unique(_labels(entries, label), word, report)


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
        use_paths = {path for path, field in fields if "use" in field}
        named_values: list[Named] = []
        for path, field in expanded(fields, groups):
            place = (*path, "name") if path not in use_paths else path
            named_values.append((place, field.get("name")))
            named_values += (((*path, *run_path, "name"), run["name"]) for run_path, run in items(field, "digits"))
        named_values += (((*fields.path, "join", name), name) for name in mapping(fields.owner, "join"))
        _check_unique(named_values, "a field", report)


def duplicate_selection(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that each value of the selecting field identifies one frame of its sender."""
    first_layouts: dict[tuple[str, object, object], object] = {}
    for layout in layouts(spec):
        for selector, values in mapping(layout.owner, "when").items():
            for index, value in enumerate(values):
                key = (layout.interface, layout.owner.get("from"), value)
                name = layout.owner["name"]
                first_layout = first_layouts.setdefault(key, name)
                if first_layout != name or value in values[:index]:
                    fault = "listed" if first_layout == name else f"used by {quoted(first_layout)}"
                    message = (
                        f"{quoted(selector)} {value} is already {fault}; "
                        f"use each value for only one frame of the {key[1]}"
                    )
                    report.add("duplicate-name", (*layout.path, "when", selector, index), message)


def duplicate_address(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no two registers of an interface and bank share a byte.

    A read-only and a write-only register may have the same address.
    """
    registers = sorted(items(spec, "registers"), key=lambda path_and_register: path_and_register[1]["address"])
    for index, (path, register) in enumerate(registers):
        for other_path, other_register in reversed(registers[max(0, index - 128) : index]):
            if (
                _address_space(other_register) != _address_space(register)
                or last_address(other_register) < register["address"]
            ):
                continue
            accesses = {register["access"], other_register["access"]}
            if register["address"] == other_register["address"] and accesses == {"read_only", "write_only"}:
                continue
            earlier, later = (other_path, other_register), (path, register)
            if path < other_path:
                earlier, later = later, earlier
            line = report.document.position(earlier[0])[0]
            message = (
                f"{_address_range(later[1])} overlap{'s' if later[1]['address'] == last_address(later[1]) else ''} "
                f"{quoted(earlier[1]['name'])} on line {line}, which has {_address_range(earlier[1])}"
            )
            report.add("duplicate-address", (*later[0], "address"), message)
            break


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


def _labels(entries: Iterable[tuple[Path, Spec]], label: str) -> Iterator[Named]:
    """Yield the label of each entry with its path."""
    return (((*path, label), spec[label]) for path, spec in entries)


def _check_unique(named_values: Iterable[Named], word: str, report: DocumentReport) -> None:
    """Report every value equal to an earlier one. ``word`` is the kind of item, with its article."""
    first_paths: dict[object, Path] = {}
    for path, value in named_values:
        if value is None:
            continue
        first_path = first_paths.setdefault(value, path)
        if first_path != path:
            value_text = f"{value:#04x}" if isinstance(value, int) else quoted(value)
            line = report.document.position(first_path)[0]
            report.add(
                "duplicate-name",
                path,
                f"there is already {word} {value_text} on line {line}; rename one of them",
                at_key=path[-2] == "join",
            )


def _address_space(register: Spec) -> tuple[str, object]:
    """Return the address space of a register. Each bank is a space, and the area without banks is another."""
    return interface_of(register), register.get("bank")


def _address_range(register: Spec) -> str:
    first, last = register["address"], last_address(register)
    return f"address {first:#04x}" if first == last else f"addresses {first:#04x} to {last:#04x}"
