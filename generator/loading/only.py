"""``only``: the order codes that something applies to, and the parameter that distinguishes them in code."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from ..language.problems import DocumentReport, Path, quoted
from ..model import Variant
from ..model.only import fits
from .from_mapping import Raw


def only_while(only: str, variants: Sequence[Variant], parameters: Collection[str]) -> str:
    """Return the parameter that is 0 for all order codes except those of ``only``, or an empty string."""
    return next((name for name in parameters if _distinguishes(name, only, variants)), "")


def _distinguishes(parameter: str, only: str, variants: Sequence[Variant]) -> bool:
    """Return True if a parameter is 0 for all order codes except those of ``only``."""
    return all((variant.parameters.get(parameter, 0) != 0) == fits(only, variant.code) for variant in variants)


def set_parameters(raw: Raw) -> list[str]:
    """Return the parameters that order codes set."""
    derived_keys = {"equals", "read_from", "alternative"}
    return [name for name, definition in raw["parameters"].items() if derived_keys.isdisjoint(definition)]


def check_only(raw: Raw, variants: Sequence[Variant], report: DocumentReport) -> None:
    """Report an ``only`` that no order code matches, and an ``only`` of a flag that no parameter distinguishes."""
    if not variants:
        return
    for path, owner in _mappings_with_only(raw, ()):
        only = owner["only"]
        if not any(fits(only, variant.code) for variant in variants):
            example_code = variants[0].code
            message = f"no order code of the family matches {quoted(only)}"
            example = quoted(f"{example_code[: len(example_code) // 2]}...")
            remedy = f"'...' matches any text and 'x' matches one character, as in {example}"
            report.add("only-codes", (*path, "only"), f"{message}; {remedy}")
        elif "active" in owner and not only_while(only, variants, set_parameters(raw)):
            message = f"no parameter distinguishes the order codes {quoted(only)} from the others"
            remedy = "add one that these set and that is 0 for all others"
            report.add("only-parameter", (*path, "only"), f"{message}; {remedy}")


def check_alarms(raw: Raw, report: DocumentReport) -> None:
    """Report an alarm with a different ``only`` than its flag."""
    owners = {("group", group["name"]): group for group in raw.get("field_groups", ())}
    owners |= {("register", register["name"]): register for register in raw.get("registers", ())}
    for index, alarm in enumerate(raw.get("alarms", ())):
        kind = "register" if "register" in alarm else "group"
        fields = owners.get((kind, alarm.get(kind, "")), {}).get("fields", ())
        flag = next((candidate for candidate in fields if candidate.get("name") == alarm.get("field", "")), None)
        if flag is None or alarm.get("only", "") == flag.get("only", ""):
            continue
        message = (
            f"the alarm applies to {_quoted(alarm)}, but its flag {quoted(flag['name'])} applies to {_quoted(flag)}"
        )
        path: Path = ("alarms", index, "only") if "only" in alarm else ("alarms", index)
        report.add("only-alarm", path, f"{message}; give both the same 'only'")


def _quoted(owner: Raw) -> str:
    return f"the order codes {quoted(owner['only'])}" if "only" in owner else "all order codes"


def _mappings_with_only(value: Any, path: Path) -> Iterator[tuple[Path, Raw]]:
    """Yield the mappings that have an ``only``."""
    if isinstance(value, Mapping):
        if isinstance(value.get("only"), str):
            yield path, value
        for key, member in value.items():
            if key not in ("also_written", "names"):  # below these are texts of labels and of languages
                yield from _mappings_with_only(member, (*path, key))
    elif isinstance(value, (list, tuple)):
        for index, member in enumerate(value):
            yield from _mappings_with_only(member, (*path, index))
