"""What of a spec can be relied on: what has no fault itself and is made of nothing that has one.

An example of a register whose field is misspelt does not hold, but that is no news: it is looked at when the register
is mended.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..language.problems import DocumentReport, Path
from ..language.rules.walk import Spec, field_lists, items, mapping
from ..model import (
    CrcExample,
    Example,
    FrameExample,
    MeasureExample,
    ProcedureExample,
    RegisterExample,
    assert_never,
)

#: A kind of item, as the key of its list, and a name.
Item = tuple[str, str]


@dataclass(frozen=True)
class Sound:
    """What is at fault in a spec: ``places`` and all that holds them, and ``items`` by name, with those that rest on
    one."""

    places: frozenset[Path]
    items: frozenset[Item]

    def is_sound(self, kind: str, name: str) -> bool:
        """Whether an item of this name can be relied on; ``kind`` is the key of its list, such as ``registers``."""
        return (kind, name) not in self.items

    @property
    def has_codes(self) -> bool:
        """Whether order codes and parameters can be relied on."""
        return ("parameters",) not in self.places and ("order_code",) not in self.places

    @property
    def has_frames(self) -> bool:
        """Whether a frame finds its layout: by a control field, which may be that of any."""
        return not any(kind in ("layouts", "data_ids") for kind, _ in self.items)

    def holds(self, example: Example) -> bool:
        """Whether all that an example rests on is sound, the example included."""
        if not self.is_sound("examples", example.name):
            return False
        match example:
            case CrcExample():
                return self.is_sound("crcs", example.crc)
            case FrameExample():
                found = self.is_sound("layouts", example.layout) if example.bits else self.has_frames
            case RegisterExample():
                found = self.is_sound("registers", example.register)
            case ProcedureExample():
                found = self.is_sound("procedures", example.procedure)
            case MeasureExample():
                found = "measurement" not in {step for place in self.places for step in place}
            case _:
                assert_never(example)
        return found and self.has_codes


def sound_so_far(report: DocumentReport) -> Sound:
    """What can be relied on in a document by what has been reported up to now."""
    document = report.document
    return sound(document.data, (*report.faults(), *document.broken, *document.doubtful))


def sound(data: Spec, faults: Iterable[Path]) -> Sound:
    """What can be relied on in a spec as it was read, when it is at fault at these places."""
    places = frozenset(fault[:end] for fault in faults for end in range(1, len(fault) + 1))
    found: set[Item] = set()
    for kind in ("crcs", "examples"):
        found |= {(kind, _name(item)) for path, item in items(data, kind) if path in places}
    for fields in field_lists(data):  # Groups come first, since the others may use them.
        used = ((kind, _text(field, key)) for _, field in fields for key, kind in _MADE_OF)
        if fields.path in places or any(item in found for item in used):
            found.add((fields.kind.value, _name(fields.owner)))
    found |= {("registers", _name(item)) for path, item in items(data, "registers") if path in places}
    for interface in mapping(data, "interfaces"):
        listed = items(data, "interfaces", interface, "data_ids")
        found |= {("data_ids", _name(item)) for path, item in listed if path in places}
    for path, item in items(data, "procedures"):
        if path in places or _rests_on(item, found):
            found.add(("procedures", _name(item)))
    return Sound(places, frozenset(found))


_MADE_OF = (("use", "field_groups"), ("crc", "crcs"))


def _rests_on(procedure: Spec, found: set[Item]) -> bool:
    used = [("registers", _text(step, "register")) for _, step in items(procedure, "steps")]
    used += [("data_ids", _text(step, "data_id")) for _, step in items(procedure, "steps")]
    used += [("registers", _text(argument, "of")) for _, argument in items(procedure, "arguments")]
    return any(item in found for item in used)


def _name(item: Spec) -> str:
    return _text(item, "name") or "?"  # No name, and none that anything refers to.


def _text(item: Spec, key: str) -> str:
    found = item.get(key)
    return found if isinstance(found, str) else ""
