"""``codewheel diff``: what another version of a spec changes for those who use what is generated from it.

Compared are the resolved families, as ``show --json`` prints them. Each change is ``breaking`` or ``compatible``, by
these rules:

* texts, sources, errata, examples, tables, characteristics, lights, documents and lost figures, and how a spec names
  its manual, are compatible;
* what is new is compatible, unless it restricts: a limit, a register that opens another one, a reservation, or a
  decision that a frame now needs;
* a limit or a time is breaking when it allows less or asks for more than before, else compatible;
* everything else that is removed or changed is breaking: an address, a position, a width, a CRC, an order code, a
  value, a default, a pin.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..dump.plain import device_dump
from ..model import Device
from ..say.lines import wrapped
from ..say.words import counted

VERSION = 1
_WIDTH = 100
_LONGEST_VALUE = 60

#: Sections of a family in which nothing decides what is sent or computed.
_TOLD_ONLY = {"manual", "documents", "characteristics", "tables", "leds", "errata", "lost_figures", "examples", "title"}
#: Members that are words for people, wherever they stand.
_WORDS = {
    "meaning",
    "note",
    "printed_name",
    "names",
    "title",
    "source",
    "sources",
    "alignment_source",
    "output_code_source",
    "content",
    "mating",
    "remedy",
    "detected",
    "precondition",
    "result",
    "special",
    "when_active",
    "when_inactive",
    "why",
    "control_data_note",
    "profile",
    "description_file",
    "signals",
    "symbol",
    "trademarks",
    "typical_us",
    "typical_ns",
    "polynomial",
    "explained_by",
    "url",
    "purpose",
    "version",
}
#: What follows from other members, which are compared themselves.
_DERIVED = {"default_bytes", "last_address", "poly_with_top_bit", "largest", "printed"}
#: Numbers that allow less when they are raised: lower limits, and times that have to be waited for.
_LESS_WHEN_RAISED = {
    "min",
    "min_hz",
    "at_least_us",
    "at_most_us",
    "at_most_ns",
    "wait_at_least_ms",
    "pulse_at_least_us",
    "half_clock_periods",
    "microseconds",
}
#: Numbers that allow less when they are lowered: upper limits.
_LESS_WHEN_LOWERED = {"max", "max_hz", "below_hz", "shorter_than_m"}
#: What restricts when it comes anew.
_RESTRICTS = {"opened_by", "reserved", "needs", "inverts", "open_only_with", "only_with"}
#: What generated functions ask their callers for, so that its coming breaks these as its going does.
_ARGUMENTS = {"alternatives"}
#: Numbers that manuals print in hexadecimal.
_HEXADECIMAL = {
    "poly",
    "init",
    "xorout",
    "check",
    "constant",
    "unused",
    "control",
    "value",
    "equals",
    "default",
    "biss_id",
}
#: Members by which an item of a list is known, the first that it has.
_KEYS = (
    "name",
    "code",
    "text",
    "kind",
    "key",
    "contact",
    "data_id",
    "id",
    "revision",
    "language",
    "shorter_than_m",
    "clock_hz",
    "state",
)


@dataclass(frozen=True)
class Change:
    """One changed fact: ``how`` is ``changed``, ``added`` or ``removed``.

    ``hexadecimal`` where manuals print its number so.
    """

    family: str
    path: str
    how: str
    old: Any
    new: Any
    breaking: bool
    hexadecimal: bool = False

    @property
    def effect(self) -> str:
        return "breaking" if self.breaking else "compatible"


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Every changed fact, family by family; one family on each side is compared whatever its name."""
    if len(old) == len(new) == 1:
        return list(_family(old[0], new[0]))
    before, after = ({item.name: item for item in devices} for devices in (old, new))
    found: list[Change] = []
    for name in sorted(before.keys() | after.keys()):
        if name not in after:
            found.append(Change(name, "", "removed", name, None, True))
        elif name not in before:
            found.append(Change(name, "", "added", None, name, False))
        else:
            found += _family(before[name], after[name])
    return found


def _family(old: Device, new: Device) -> Iterator[Change]:
    # A parameter that counts something has a unit; the others are codes, such as a profile ID.
    codes = {item.name for device in (old, new) for item in device.parameters if not item.unit}
    yield from _walk(new.name, (), device_dump(old), device_dump(new), codes)


def _walk(family: str, path: tuple[str, ...], old: Any, new: Any, codes: Container[str]) -> Iterator[Change]:
    if old == new or (path and path[-1] in _DERIVED):
        return
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        for name in dict.fromkeys((*old, *new)):
            yield from _walk(family, (*path, name), old.get(name), new.get(name), codes)
    elif _is_listing(old) and _is_listing(new) and (old or new):
        yield from _walk(family, path, _by_key(old), _by_key(new), codes)
    else:
        how = "added" if _is_nothing(old) else "removed" if _is_nothing(new) else "changed"
        yield Change(
            family, ".".join(path), how, old, new, _is_breaking(path, how, old, new), _is_hexadecimal(path, codes)
        )


def _is_hexadecimal(path: tuple[str, ...], codes: Container[str]) -> bool:
    return path[-1] in _HEXADECIMAL or (path[-2:-1] in (("sets",), ("parameters",)) and path[-1] in codes)


def _is_listing(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, Mapping) for item in value)


def _is_nothing(value: Any) -> bool:
    return value is None or value in ("", [], {})


def _by_key(items: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """The items of a list by what they are called, or else by their place; a name that stands again gets a number."""
    found: dict[str, Mapping[str, Any]] = {}
    for index, item in enumerate(items):
        name = (
            str(next((item[key] for key in _KEYS if item.get(key) not in (None, "")), index + 1))
            if "do" not in item
            else f"{index + 1}"
        )
        unique, count = name, 1
        while unique in found:
            count += 1
            unique = f"{name}#{count}"
        found[unique] = item
    return found


def _is_breaking(path: tuple[str, ...], how: str, old: Any, new: Any) -> bool:
    name = path[-1]
    if path[0] in _TOLD_ONLY or not _WORDS.isdisjoint(path):
        return False
    if how == "added":
        return name in _RESTRICTS | _ARGUMENTS or (
            name in _LESS_WHEN_RAISED | _LESS_WHEN_LOWERED and not isinstance(new, Mapping)
        )
    if how == "removed":
        return name not in _RESTRICTS | _LESS_WHEN_RAISED | _LESS_WHEN_LOWERED
    if isinstance(old, int) and isinstance(new, int) and not isinstance(old, bool):
        if name in _LESS_WHEN_RAISED:
            return new > old
        if name in _LESS_WHEN_LOWERED:
            return new < old
    return True


def as_data(changes: Sequence[Change]) -> dict[str, Any]:
    """The changes as ``--json`` prints them."""
    rows = [
        {
            "family": item.family,
            "path": item.path,
            "change": item.how,
            "old": item.old,
            "new": item.new,
            "effect": item.effect,
        }
        for item in changes
    ]
    return {"version": VERSION, "breaking": sum(item.breaking for item in changes), "changes": rows}


def as_text(changes: Sequence[Change]) -> str:
    """The changes for a person, the breaking ones of each family first."""
    if not changes:
        return "no difference"
    lines = []
    for family in dict.fromkeys(item.family for item in changes):
        lines.append(family)
        here = sorted((item for item in changes if item.family == family), key=lambda item: not item.breaking)
        lines += [wrapped(_sentence(item), _WIDTH, " " * 14, f"  {item.effect:<10}  ") for item in here]
    breaking = sum(item.breaking for item in changes)
    return "\n".join([*lines, f"{counted(len(changes), 'change')}, {breaking} breaking"])


def _sentence(change: Change) -> str:
    what = change.path or "the family"
    if change.how == "changed":
        return f"{what}: {_shown(change, change.old)} -> {_shown(change, change.new)}"
    value = change.new if change.how == "added" else change.old
    detail = "" if isinstance(value, (Mapping, list)) or not change.path else f", {_shown(change, value)}"
    return f"{what}: {change.how}{detail}"


def _shown(change: Change, value: Any) -> str:
    """A value, short; an address or a code as manuals write it."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "nothing"}[value]
    if isinstance(value, int):
        if change.path.endswith("address"):
            return f"{value:02X}h"
        return f"{value:X}h ({value})" if change.hexadecimal and value > 9 else f"{value}"
    text = value if isinstance(value, str) else ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[: _LONGEST_VALUE - 3]}..."
