"""Find the valid parts of a spec: parts without errors that depend only on parts without errors.

An example of a register with a misspelt field is wrong, but reporting it adds nothing. The example is checked once the
register is fixed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..language.problems import DocumentReport, Path
from ..language.rules.parts import field_lists, interfaces
from ..language.written_interfaces import WrittenRs485
from ..language.written_parts import WrittenProcedure, WrittenSpec
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

    def is_sound(self, section: str, item_name: str) -> bool:
        """Return True if the item of this name is valid. ``section`` is the key of its list, such as ``registers``."""
        return (section, item_name) not in self.items

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
        All examples except CRC examples also depend on order codes and parameters.
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
    return valid_parts(WrittenSpec(document.data), (*report.faults(), *document.broken, *document.doubtful))


def valid_parts(spec: WrittenSpec, faults: Iterable[Path]) -> ValidParts:
    """Return the validity of the parts of a spec as read, given its faulty places.

    A place is faulty if something in it is. An item is also faulty if it uses a faulty item, such as a layout with a
    faulty field group.
    """
    # Each faulty place with its parents: registers, registers[2] and registers[2].address.
    places = frozenset(fault[:end] for fault in faults for end in range(1, len(fault) + 1))
    faulty_items = {item for item, path in _items_with_places(spec) if path in places}
    for fields in field_lists(spec):  # Groups come first, because the others may use them.
        uses = [("field_groups", field.use) for field in fields.fields]
        uses += [("crcs", field.crc) for field in fields.fields]
        if fields.owner.path in places or not faulty_items.isdisjoint(uses):
            faulty_items.add((fields.kind.value, _name_or_mark(fields.name)))
    for procedure in spec.procedures:
        if procedure.path in places or not faulty_items.isdisjoint(_uses_of(procedure)):
            faulty_items.add(("procedures", _name_or_mark(procedure.name)))
    return ValidParts(places, frozenset(faulty_items))


def _items_with_places(spec: WrittenSpec) -> Iterator[tuple[Item, Path]]:
    """Yield the items without references to other items, each with its place, and all registers."""
    for crc in spec.crcs:
        yield ("crcs", _name_or_mark(crc.part.name)), crc.path
    for example in spec.examples:
        yield ("examples", _name_or_mark(example.name)), example.path
    for register in spec.registers:
        yield ("registers", _name_or_mark(register.name)), register.path
    for _, interface in interfaces(spec):
        for data_id in WrittenRs485(interface.data, interface.path).data_ids:
            yield ("data_ids", _name_or_mark(data_id.part.name)), data_id.path


def _uses_of(procedure: WrittenProcedure) -> Iterator[Item]:
    """Yield the registers and data IDs that a procedure uses, in a step or for the limits of an argument."""
    for step in procedure.steps:
        yield from (("registers", step.register), ("data_ids", step.data_id))
    for argument in procedure.arguments:
        yield "registers", argument.of


def _name_or_mark(name: str) -> str:
    return name or "?"  # No name, so nothing refers to it.
