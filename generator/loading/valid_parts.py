"""Find the valid parts of a spec: those without errors that depend only on parts without errors.

An example of a register with a misspelt field is wrong, but reporting it adds nothing. It is checked once the register
is fixed.
"""

from __future__ import annotations

from collections.abc import Iterable

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
from ..model.record import dataclass

#: A kind of item, as the key of its list, and a name.
Item = tuple[str, str]


@dataclass(frozen=True)
class ValidParts:
    """The faulty parts of a spec: ``places`` with their parents, and ``items`` by name with their dependents."""

    places: frozenset[Path]
    items: frozenset[Item]

    def is_sound(self, kind: str, name: str) -> bool:
        """Return True if the item of this name is valid. ``kind`` is the key of its list, such as ``registers``."""
        return (kind, name) not in self.items

    @property
    def has_codes(self) -> bool:
        """True if order codes and parameters are valid."""
        return ("parameters",) not in self.places and ("order_code",) not in self.places

    @property
    def has_frames(self) -> bool:
        """True if frames find their layout by the control field, which may belong to any layout."""
        return not any(kind in ("layouts", "data_ids") for kind, _ in self.items)

    def holds(self, example: Example) -> bool:
        """Return True if an example and all parts that it depends on are valid.

        A frame of bits depends on its layout, and one of bytes on all layouts, because any of them may have its bytes.
        All examples except those of CRCs also depend on order codes and parameters.
        """
        if not self.is_sound("examples", example.name):
            return False
        match example:
            case CrcExample():
                return self.is_sound("crcs", example.crc)
            case FrameExample():
                is_valid = self.is_sound("layouts", example.layout) if example.bits else self.has_frames
            case RegisterExample():
                is_valid = self.is_sound("registers", example.register)
            case ProcedureExample():
                is_valid = self.is_sound("procedures", example.procedure)
            case MeasureExample():
                is_valid = "measurement" not in {step for place in self.places for step in place}
            case _:
                assert_never(example)
        return is_valid and self.has_codes


def valid_parts_so_far(report: DocumentReport) -> ValidParts:
    """Return the validity of the parts of a document, based on the problems reported so far."""
    document = report.document
    return valid_parts(document.data, (*report.faults(), *document.broken, *document.doubtful))


def valid_parts(data: Spec, faults: Iterable[Path]) -> ValidParts:
    """Return the validity of the parts of a spec as read, given its faulty places.

    A place is faulty if something in it is. An item is also faulty if it uses a faulty one, such as a layout with a
    faulty field group.
    """
    # Each faulty place with its parents.
    places = frozenset(fault[:end] for fault in faults for end in range(1, len(fault) + 1))
    faulty_items: set[Item] = set()
    for kind in ("crcs", "examples"):
        faulty_items |= {(kind, _name(owner)) for path, owner in items(data, kind) if path in places}
    for fields in field_lists(data):  # Groups come first, because the others may use them.
        references = ((kind, _text(field, key)) for _, field in fields for key, kind in _MADE_OF)
        if fields.path in places or any(reference in faulty_items for reference in references):
            faulty_items.add((fields.kind.value, _name(fields.owner)))
    faulty_items |= {("registers", _name(register)) for path, register in items(data, "registers") if path in places}
    for interface in mapping(data, "interfaces"):
        data_ids = items(data, "interfaces", interface, "data_ids")
        faulty_items |= {("data_ids", _name(data_id)) for path, data_id in data_ids if path in places}
    for path, procedure in items(data, "procedures"):
        if path in places or _rests_on(procedure, faulty_items):
            faulty_items.add(("procedures", _name(procedure)))
    return ValidParts(places, frozenset(faulty_items))


#: Keys of fields that name another item, each with the key of the list of these items.
_MADE_OF = (("use", "field_groups"), ("crc", "crcs"))


def _rests_on(procedure: Spec, faulty: set[Item]) -> bool:
    """Return True if a procedure uses a faulty register or data ID, in a step or for the limits of an argument."""
    items_of_procedure = [("registers", _text(step, "register")) for _, step in items(procedure, "steps")]
    items_of_procedure += [("data_ids", _text(step, "data_id")) for _, step in items(procedure, "steps")]
    items_of_procedure += [("registers", _text(argument, "of")) for _, argument in items(procedure, "arguments")]
    return any(reference in faulty for reference in items_of_procedure)


def _name(definition: Spec) -> str:
    return _text(definition, "name") or "?"  # No name, so nothing refers to it.


def _text(definition: Spec, key: str) -> str:
    text = definition.get(key)
    return text if isinstance(text, str) else ""
