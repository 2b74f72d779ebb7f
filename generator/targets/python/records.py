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
from ..shared_files import our_runtime
from .literals import Call, Hex, Literal, Member, is_empty

#: Sources with classes of records and enumerations.
_RUNTIME = our_runtime("python") / "codewheel_runtime"
_SOURCES = (_RUNTIME / "facts.py", _RUNTIME / "order_codes.py", _RUNTIME / "reports.py")
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
    classes = [class_def for path in _SOURCES for class_def in _classes(path.read_text(encoding="utf-8"))]
    bases = {class_def.name: set(map(ast.unparse, class_def.bases)) for class_def in classes}
    record_classes = (class_def for class_def in classes if "NamedTuple" in bases[class_def.name])
    enumerations = (name for name, base_names in bases.items() if "Enum" in base_names)
    return Records(
        members={class_def.name: tuple(_members(class_def)) for class_def in record_classes},
        enumerations=frozenset(("Interface", *enumerations)),
    )


def _classes(source: str) -> Iterator[ast.ClassDef]:
    yield from (node for node in ast.parse(source).body if isinstance(node, ast.ClassDef))


def _members(class_def: ast.ClassDef) -> Iterator[RecordMember]:
    for node in class_def.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [name_node.id for name_node in ast.walk(node.annotation) if isinstance(name_node, ast.Name)]
            is_literal = isinstance(node.value, (ast.Constant, ast.Tuple))
            default = ast.literal_eval(node.value) if node.value is not None and is_literal else None
            yield RecordMember(node.target.id, frozenset(names), default if node.value is not None else _NOTHING)


def row(function: str, model_object: object, **overrides: Literal) -> Call:
    """Return a record of a part of the model: all required members, and the others that differ from the default.

    Args:
        function: Name of the record.
        model_object: The part of the model, which has members of the same names.
        overrides: Values that replace those of the part.
    """
    arguments: list[tuple[str, Literal]] = []
    last = _LAST.get(function, ())
    for member in sorted(records().members[function], key=lambda record_member: record_member.name in last):
        value = overrides[member.name] if member.name in overrides else _value(model_object, member)
        if member.default is _NOTHING:
            arguments.append(("" if function in _POSITIONAL else member.name, value))
        elif value != member.default and not is_empty(value):
            arguments.append((member.name, value))
    return Call(function, tuple(arguments))


def rows(function: str, model_objects: tuple[object, ...]) -> tuple[Call, ...]:
    """Return a record for each item."""
    return tuple(row(function, model_object) for model_object in model_objects)


def _value(model_object: object, member: RecordMember) -> Literal:
    content = getattr(model_object, member.name)
    if member.name == "source":
        return cite(content)
    for record in member.types & records().members.keys():
        if isinstance(content, tuple):
            return rows(record, content)
        return row(record, content) if content is not None else None
    for kind in member.types & records().enumerations:
        if isinstance(content, tuple):
            return tuple(Member(kind, name) for name in content)
        return Member(kind, content) if content else None
    if isinstance(content, Expression):
        return content.render()
    part = PARTS_BY_CLASS.get(type(model_object).__name__)
    described = part.by_attribute.get(member.name) if part is not None else None
    if described is not None and described.shape == "hex" and isinstance(content, int):
        return Hex(content)
    value: Literal = content
    return value
