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
    codes = [(fits(only, item.code), item.parameters) for item in variants]
    return next((name for name in parameters if all((values.get(name, 0) != 0) == here for here, values in codes)), "")


def set_parameters(raw: Raw) -> list[str]:
    """Return the parameters that order codes set."""
    follow = ("equals", "read_from", "alternative")
    return [name for name, item in raw["parameters"].items() if not any(key in item for key in follow)]


def check_only(raw: Raw, variants: Sequence[Variant], report: DocumentReport) -> None:
    """Report an ``only`` that no order code matches, and an ``only`` of a flag that no parameter distinguishes."""
    if not variants:
        return
    for path, owner in _owners(raw, ()):
        only = owner["only"]
        if not any(fits(only, item.code) for item in variants):
            some = variants[0].code
            wrong = f"no order code of the family matches {quoted(only)}"
            right = (
                f"'...' matches any text and 'x' matches one character, as in {quoted(some[: len(some) // 2] + '...')}"
            )
            report.add("only-codes", (*path, "only"), f"{wrong}; {right}")
        elif "active" in owner and not only_while(only, variants, set_parameters(raw)):
            wrong = f"no parameter distinguishes the order codes {quoted(only)} from the others"
            right = "add one that these set and that is 0 for all others"
            report.add("only-parameter", (*path, "only"), f"{wrong}; {right}")


def check_alarms(raw: Raw, report: DocumentReport) -> None:
    """Report an alarm with a different ``only`` than its flag."""
    owners = {
        (kind, item["name"]): item
        for kind, key in (("group", "field_groups"), ("register", "registers"))
        for item in raw.get(key, ())
    }
    for index, alarm in enumerate(raw.get("alarms", ())):
        kind = "register" if "register" in alarm else "group"
        fields = owners.get((kind, alarm.get(kind, "")), {}).get("fields", ())
        flag = next((item for item in fields if item.get("name") == alarm.get("field", "")), None)
        if flag is None or alarm.get("only", "") == flag.get("only", ""):
            continue
        wrong = f"the alarm applies to {_quoted(alarm)}, but its flag {quoted(flag['name'])} applies to {_quoted(flag)}"
        path: Path = ("alarms", index, "only") if "only" in alarm else ("alarms", index)
        report.add("only-alarm", path, f"{wrong}; give both the same 'only'")


def _quoted(item: Raw) -> str:
    return f"the order codes {quoted(item['only'])}" if "only" in item else "all order codes"


def _owners(value: Any, path: Path) -> Iterator[tuple[Path, Raw]]:
    """Yield the mappings that have an ``only``."""
    if isinstance(value, Mapping):
        if isinstance(value.get("only"), str):
            yield path, value
        for key, item in value.items():
            if key not in ("also_written", "names"):  # below these are texts of labels and of languages
                yield from _owners(item, (*path, key))
    elif isinstance(value, (list, tuple)):
        for index, item in enumerate(value):
            yield from _owners(item, (*path, index))
