"""Records of the facts of a device, filled from the model by the names of their members.

The classes of the records are read from their source, so no separate list of members is needed: a member of the
class is printed if the model has it, and an enumeration or another record is printed according to its type.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType

from ...model import cite
from ...model.expressions import Expression
from ...model.members import PARTS_BY_CLASS
from ...model.record import dataclass
from ..runtime import our_runtime
from .literals import Call, Hex, Literal, Member, is_empty

#: Sources with classes of records and enumerations.
_SOURCES = tuple(
    our_runtime("python") / "codewheel_runtime" / f"{name}.py" for name in ("facts", "order_codes", "reports")
)
#: Records whose required members are printed without their names.
_POSITIONAL = frozenset(
    "Contact Document Edition Family LedState LostFigure NamedValue PrintedTimeout RegisterMeaning Revision"
    " SpelledValue".split()
)
#: Members that are printed last, although members that were added later follow them in the class.
_LAST: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"SsiFacts": ("timings", "note", "source"), "ControlField": ("values", "source")}
)
_NOTHING = object()


@dataclass(frozen=True)
class RecordMember:
    """A member of a record: the names in its type, and its default. A required member has no default."""

    name: str
    types: frozenset[str]
    default: object


@dataclass(frozen=True)
class Records:
    """The members of each record, and the names of the enumerations."""

    members: Mapping[str, tuple[RecordMember, ...]]
    enumerations: frozenset[str]


@cache
def records() -> Records:
    """Return all records and enumerations of the runtime."""
    classes = [item for path in _SOURCES for item in _classes(path.read_text(encoding="utf-8"))]
    bases = {item.name: {ast.unparse(base) for base in item.bases} for item in classes}
    return Records(
        {item.name: tuple(_members(item)) for item in classes if "NamedTuple" in bases[item.name]},
        frozenset(("Interface", *(name for name, found in bases.items() if "Enum" in found))),
    )


def _classes(source: str) -> Iterator[ast.ClassDef]:
    yield from (item for item in ast.parse(source).body if isinstance(item, ast.ClassDef))


def _members(item: ast.ClassDef) -> Iterator[RecordMember]:
    for node in item.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [each.id for each in ast.walk(node.annotation) if isinstance(each, ast.Name)]
            is_literal = isinstance(node.value, (ast.Constant, ast.Tuple))
            default = ast.literal_eval(node.value) if node.value is not None and is_literal else None
            yield RecordMember(node.target.id, frozenset(names), default if node.value is not None else _NOTHING)


def row(function: str, item: object, **made: Literal) -> Call:
    """Return a record of an item of the model: all required members, and the others that differ from the default.

    Args:
        function: Name of the record.
        item: The item, which has members of the same names.
        made: Values that replace those of the item.
    """
    arguments: list[tuple[str, Literal]] = []
    last = _LAST.get(function, ())
    for member in sorted(records().members[function], key=lambda each: each.name in last):
        value = made[member.name] if member.name in made else _value(item, member)
        if member.default is _NOTHING:
            arguments.append(("" if function in _POSITIONAL else member.name, value))
        elif value != member.default and not is_empty(value):
            arguments.append((member.name, value))
    return Call(function, tuple(arguments))


def rows(function: str, items: tuple[object, ...]) -> tuple[Call, ...]:
    """Return a record for each item."""
    return tuple(row(function, item) for item in items)


def _value(item: object, member: RecordMember) -> Literal:
    found = getattr(item, member.name)
    if member.name == "source":
        return cite(found)
    for record in member.types & records().members.keys():
        if not isinstance(found, tuple):
            return row(record, found) if found is not None else None
        return rows(record, found)
    for kind in member.types & records().enumerations:
        if not isinstance(found, tuple):
            return Member(kind, found) if found else None
        return tuple(Member(kind, each) for each in found)
    if isinstance(found, Expression):
        return found.render()
    part = PARTS_BY_CLASS.get(type(item).__name__)
    described = part.by_attribute.get(member.name) if part is not None else None
    if described is not None and described.shape == "hex" and isinstance(found, int):
        return Hex(found)
    value: Literal = found
    return value
