"""Find the valid parts of a spec: parts without errors that depend only on parts without errors.

An example of a register with a misspelled field is wrong, but reporting it adds nothing. The example is checked once
the register is fixed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..language.problems import DocumentReport, Path
from ..language.rules.parts import field_lists, interfaces
from ..language.written_codes import WrittenRs485
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
    """The valid parts of a spec, given by the parts that are not valid."""

    #: Places with problems, and the places that contain them.
    places: frozenset[Path]
    #: Items with problems, and items that depend on them.
    items: frozenset[Item]

    def is_valid(self, section: str, item_name: str) -> bool:
        """Return whether an item and all items that it uses are valid. ``section`` is a list such as ``registers``."""
        return (section, item_name) not in self.items

    @property
    def has_codes(self) -> bool:
        """Whether the order codes and the parameters are valid."""
        return ("parameters",) not in self.places and ("order_code",) not in self.places

    @property
    def has_frames(self) -> bool:
        """Whether all layouts and data IDs are valid, so that decoders can find the layout of any frame."""
        return not any(kind in ("layouts", "data_ids") for kind, _ in self.items)

    def holds(self, example: Example) -> bool:
        """Return whether an example and all parts that it depends on are valid.

        A bit frame depends on its layout. A frame of bytes depends on all layouts, because its bytes select one of
        them. All examples except those of a CRC also depend on order codes and parameters.
        """
        if not self.is_valid("examples", example.name):
            return False
        match example:
            case CrcExample():
                return self.is_valid("crcs", example.crc)
            case FrameExample() if example.bits:
                has_valid_parts = self.is_valid("layouts", example.layout)
            case FrameExample():
                has_valid_parts = self.has_frames
            case RegisterExample():
                has_valid_parts = self.is_valid("registers", example.register)
            case ProcedureExample():
                has_valid_parts = self.is_valid("procedures", example.procedure)
            case MeasureExample():
                has_valid_parts = not any("measurement" in place for place in self.places)
            case _:
                assert_never(example)
        return has_valid_parts and self.has_codes


def valid_parts_so_far(report: DocumentReport) -> ValidParts:
    """Return which parts of a document are valid, according to the problems reported so far."""
    document = report.document
    return valid_parts(WrittenSpec(document.data), (*report.faults(), *document.broken, *document.doubtful))


def valid_parts(spec: WrittenSpec, faults: Iterable[Path]) -> ValidParts:
    """Return which parts of a spec are valid, given the places with problems.

    A part is not valid if something in it has a problem. An item is also not valid if it uses such an item, for example
    a layout that uses a field group with a problem.
    """
    # Each place with a problem and the places that contain it: registers, registers[2] and registers[2].address.
    places: set[Path] = set()
    for fault in faults:
        places.update(fault[:length] for length in range(1, len(fault) + 1))
    faulty_items = {item for item, path in _items_with_places(spec) if path in places}
    for fields in field_lists(spec):  # Field groups come first, because layouts and registers may use them.
        uses = [("field_groups", field.use) for field in fields.fields]
        uses += [("crcs", field.crc) for field in fields.fields]
        if fields.owner.path in places or not faulty_items.isdisjoint(uses):
            faulty_items.add((fields.owner_kind.value, _name_or_mark(fields.name)))
    for procedure in spec.procedures:
        if procedure.path in places or not faulty_items.isdisjoint(_uses_of(procedure)):
            faulty_items.add(("procedures", _name_or_mark(procedure.name)))
    return ValidParts(frozenset(places), frozenset(faulty_items))


def _items_with_places(spec: WrittenSpec) -> Iterator[tuple[Item, Path]]:
    """Yield each CRC, example, register and data ID of a spec with its place."""
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
    """Yield the registers and data IDs that a procedure uses, in its steps or for the limits of an argument."""
    for step in procedure.steps:
        yield from (("registers", step.register), ("data_ids", step.data_id))
    for argument in procedure.arguments:
        yield "registers", argument.of


def _name_or_mark(name: str) -> str:
    """Return the name of an item, or "?" for an item without a name, which nothing can refer to."""
    return name or "?"
