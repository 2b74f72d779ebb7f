"""``codewheel list``: a few facts about each family, as text at most 80 columns wide and as plain data."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from .cli import AND_PACKAGED, Parser, add_cache_option, add_specs, cache_for
from .terminal import error_after_printing, print_json

if TYPE_CHECKING:
    import argparse

    from ..cache import Cache
    from ..model import Device

EXAMPLES = ("codewheel list", "codewheel list my_encoder.yaml")


class Manual(TypedDict):
    """The manual of a family."""

    title: str
    revision: str
    date: str | None


class FamilyRow(TypedDict):
    """Facts about a family. Each interface has a name and a title."""

    family: str
    title: str
    manufacturer: str
    interfaces: list[list[str]]
    pattern: str
    order_codes: list[str]
    manual: Manual
    evidence: str


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "List families, interfaces, order codes and manuals."
    add_specs(parser, AND_PACKAGED)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_cache_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the families.

    Raises:
        CommandError: The specs have problems, or a path does not exist.
    """
    from .families_in_specs import has_same_spec
    from .read_specs import specs_to_read

    cache = cache_for(arguments)
    specs = specs_to_read([*arguments.specs, *arguments.more_specs])
    # The groups are the user's specs and the packaged ones. If there is only one group, no family is in both.
    rows_of_groups = [_rows_of_specs(paths, cache) for paths in specs.groups]
    families, repeated_names = without_packaged_duplicates(*rows_of_groups)
    differing_names: list[str] = []
    if repeated_names:
        own_paths, packaged_paths = specs.groups
        differing_names = [name for name in repeated_names if not has_same_spec(own_paths, packaged_paths, name)]
    if differing_names:
        names_text = ", ".join(differing_names)
        print(f"codewheel: in your specs and in the packaged ones: {names_text}; yours are used", file=sys.stderr)
    if arguments.json:
        print_json(as_data(families))
    else:
        print(as_text(families))
    return 0


def _rows_of_specs(paths: Sequence[Path], cache: Cache) -> list[FamilyRow]:
    """Return the facts about the families of specs, from an earlier run if they have not changed."""
    from ..cache import CachedResult

    cached_rows = CachedResult(cache, "list", paths)
    stored_rows: list[FamilyRow] | None = cached_rows.get()
    if stored_rows is not None:
        return stored_rows
    new_rows = family_rows(_load_devices(paths))
    cached_rows.put(new_rows)
    return new_rows


def _load_devices(paths: Sequence[Path]) -> Sequence[Device]:
    """Return the devices of the specs.

    Raises:
        CommandError: There are problems, which are printed to standard error. The exit code is 1.
    """
    from ..loading.library import load_library

    devices, report = load_library(paths)
    if report:
        raise error_after_printing(report)
    return devices


def family_rows(devices: Sequence[Device]) -> list[FamilyRow]:
    """Return the facts about each family, as data that JSON can express."""
    return [_summarise_family(device) for device in devices]


def _summarise_family(device: Device) -> FamilyRow:
    """Return the facts about a family."""
    manual = device.manual
    return {
        "family": device.name,
        "title": device.title,
        "manufacturer": device.manufacturer.title,
        "interfaces": [[interface.name, interface.title] for interface in device.interfaces],
        "pattern": device.order_code.pattern,
        "order_codes": [variant.code for variant in device.variants],
        "manual": {"title": manual.title, "revision": manual.revision, "date": manual.date or None},
        "evidence": device.evidence.grade,
    }


def without_packaged_duplicates(
    own_rows: Sequence[FamilyRow] = (), packaged: Sequence[FamilyRow] = ()
) -> tuple[list[FamilyRow], list[str]]:
    """Return the user's families, then the packaged ones, except families whose name or order code a user's family has.

    The second list contains the names of these exceptions.
    """
    user_names = {row["family"] for row in own_rows}
    user_codes = {code for row in own_rows for code in row["order_codes"]}
    repeated_names: list[str] = []
    other_rows: list[FamilyRow] = []
    for row in packaged:
        has_code_of_user = not user_codes.isdisjoint(row["order_codes"])
        if row["family"] in user_names or has_code_of_user:
            repeated_names.append(row["family"])
        else:
            other_rows.append(row)
    return [*own_rows, *other_rows], repeated_names


def as_data(families: Sequence[FamilyRow]) -> dict[str, Any]:
    """Return the families in the form that ``--json`` prints."""
    return {"version": 1, "families": [_with_interface_names(family) for family in families]}


def _with_interface_names(family: FamilyRow) -> dict[str, Any]:
    return {**family, "interfaces": [name for name, _ in family["interfaces"]]}


def _pattern_or_codes(family: FamilyRow) -> str:
    """Return the pattern of the order codes, or the codes themselves if it is only one part, such as ``{model}``."""
    pattern = family["pattern"]
    has_text_or_parts = not pattern.startswith("{") or pattern.count("{") > 1
    return pattern if has_text_or_parts else ", ".join(family["order_codes"])


def as_text(families: Sequence[FamilyRow]) -> str:
    """Return a heading and four lines of facts about each family, at most 80 columns wide."""
    from ..say import WIDTH, two_columns, wrap_text

    lines = []
    for family in families:
        heading = f"{family['title']} ({family['manufacturer']})"
        manual = family["manual"]
        date = f" of {manual['date']}" if manual["date"] else ""
        interface_titles = [title for _, title in family["interfaces"]]
        number_of_codes = len(family["order_codes"])
        facts = [
            ("interfaces", ", ".join(interface_titles)),
            ("order codes", f"{number_of_codes}, {_pattern_or_codes(family)}"),
            ("manual", f"{manual['title']}, revision {manual['revision']}{date}"),
            ("evidence", family["evidence"]),
        ]
        lines.append(wrap_text(heading, WIDTH, prefix=" " * 10, first=f"{family['family']:<8}  "))
        lines += [*two_columns(facts, indent=10), ""]
    return "\n".join(lines).rstrip()
