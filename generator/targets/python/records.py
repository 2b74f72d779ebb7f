"""Records in generated Python: calls of the runtime's classes, such as ``Register(name="preset", address=0x40)``.

The classes of the records are read from their source, so no separate list of members is needed: a member of the
class is printed if the model has it, and an enumeration or another record is printed according to its type.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from types import MappingProxyType

from ...model import Register, cite
from ...model.expressions import Expression
from ...model.members import PARTS_BY_CLASS
from ...model.record import dataclass
from ...plan.frames import HeldParameter
from ...plan.values import meaning_of
from ..registry import our_runtime
from .literals import CallLiteral, EnumMember, Hex, Literal, SourceText, is_empty, record, zero_means_member
from .names import ModuleContext, byte_order

#: Sources with classes of records and enumerations.
_RUNTIME_PACKAGE = our_runtime("python") / "codewheel_runtime"
_RECORD_SOURCES = (
    *sorted((_RUNTIME_PACKAGE / "facts").glob("*.py")),
    _RUNTIME_PACKAGE / "order_codes.py",
    _RUNTIME_PACKAGE / "reports.py",
)
#: Records whose required members are printed without their names.
_POSITIONAL_RECORDS = frozenset(
    "Contact Document Edition Family LedState LostFigure NamedValue PrintedTimeout RegisterMeaning Revision"
    " SpelledValue".split()
)
#: Members that are printed last, although members that were added later follow them in the class.
_PRINTED_LAST: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "SsiFacts": ("timings", "note", "source"),
        "BissFacts": ("timings", "note", "source"),
        "ControlField": ("values", "source"),
    }
)


@dataclass(frozen=True)
class RecordMember:
    """A member of a record: the names in its type, and its default.

    The type ``tuple[Contact, ...] | None`` contains the names ``tuple`` and ``Contact``.
    """

    name: str
    types: frozenset[str]
    default: object = None
    is_required: bool = False


@dataclass(frozen=True)
class RuntimeRecords:
    """The members of each record of the runtime, and the names of its enumerations."""

    members: Mapping[str, tuple[RecordMember, ...]]
    enumerations: frozenset[str]


@cache
def runtime_records() -> RuntimeRecords:
    """Return all records and enumerations of the runtime."""
    members: dict[str, tuple[RecordMember, ...]] = {}
    enumerations: set[str] = set()
    for path in _RECORD_SOURCES:
        for class_def in _record_classes(path.read_text(encoding="utf-8")):
            base_names = {ast.unparse(base) for base in class_def.bases}
            if "NamedTuple" in base_names:
                members[class_def.name] = tuple(_record_members(class_def))
            if "Enum" in base_names:
                enumerations.add(class_def.name)
    return RuntimeRecords(members, frozenset(enumerations))


def _record_classes(source: str) -> list[ast.ClassDef]:
    """Return the classes in the source of a module."""
    return [statement for statement in ast.parse(source).body if isinstance(statement, ast.ClassDef)]


def _record_members(class_def: ast.ClassDef) -> Iterator[RecordMember]:
    """Yield the members of a class, whose statements are like ``address: int`` or ``note: str = ""``."""
    for statement in class_def.body:
        if not isinstance(statement, ast.AnnAssign) or not isinstance(statement.target, ast.Name):
            continue
        names_in_type = [node.id for node in ast.walk(statement.annotation) if isinstance(node, ast.Name)]
        default: object = None
        # The default of some members is a call, which counts as None.
        if isinstance(statement.value, (ast.Constant, ast.Tuple)):
            default = ast.literal_eval(statement.value)
        yield RecordMember(
            name=statement.target.id,
            types=frozenset(names_in_type),
            default=default,
            is_required=statement.value is None,
        )


def record_of(class_name: str, model_part: object, **overrides: Literal) -> CallLiteral:
    """Return the call that creates the record of a part of the model, such as a register.

    It contains all required members, and other members unless they are empty or equal to their default.

    Args:
        class_name: Name of the record.
        model_part: The part of the model, which has members of the same names.
        overrides: Values that replace those of the part.
    """
    arguments: list[tuple[str, Literal]] = []
    for member in _in_printed_order(class_name):
        value = overrides[member.name] if member.name in overrides else _member_literal(model_part, member)
        if member.is_required:
            # An argument with an empty name is positional.
            is_positional = class_name in _POSITIONAL_RECORDS
            arguments.append(("" if is_positional else member.name, value))
        elif value != member.default and not is_empty(value):
            arguments.append((member.name, value))
    return CallLiteral(class_name, tuple(arguments))


def records_of(class_name: str, model_parts: Sequence[object]) -> tuple[CallLiteral, ...]:
    """Return a record for each part of the model."""
    return tuple(record_of(class_name, model_part) for model_part in model_parts)


def _in_printed_order(class_name: str) -> list[RecordMember]:
    """Return the members of a record in the order of its class, with the members in ``_PRINTED_LAST`` at the end."""
    members = runtime_records().members[class_name]
    names_at_end = _PRINTED_LAST.get(class_name, ())
    members_before = [member for member in members if member.name not in names_at_end]
    members_at_end = [member for member in members if member.name in names_at_end]
    return members_before + members_at_end


def _member_literal(model_part: object, member: RecordMember) -> Literal:
    """Return a member of a part of the model as a literal, according to the type of the member in the record.

    If the type is a record or an enumeration, or a tuple of these, the value becomes a call or a member of it. Sources
    become one text.
    """
    value = getattr(model_part, member.name)
    if member.name == "source":
        return cite(value)
    record_names = member.types & runtime_records().members.keys()
    if record_names:
        (record_name,) = record_names  # A type names at most one record.
        if isinstance(value, tuple):
            return records_of(record_name, value)
        return record_of(record_name, value) if value is not None else None
    enumerations = member.types & runtime_records().enumerations
    if enumerations:
        (enumeration,) = enumerations  # A type names at most one enumeration.
        if isinstance(value, tuple):
            return tuple(EnumMember(enumeration, name) for name in value)
        return EnumMember(enumeration, value) if value else None
    if isinstance(value, Expression):
        return value.render()
    if isinstance(value, int) and _is_hexadecimal(model_part, member.name):
        return Hex(value)
    literal_value: Literal = value
    return literal_value


def _is_hexadecimal(model_part: object, member_name: str) -> bool:
    """Return whether specs contain this member of a part of the model in hexadecimal."""
    part = PARTS_BY_CLASS.get(type(model_part).__name__)
    if part is None or member_name not in part.by_attribute:
        return False
    return part.by_attribute[member_name].shape == "hex"


def held_record(context: ModuleContext, register: Register, held_parameter: HeldParameter) -> CallLiteral:
    """Return the record of a parameter that is read from a register: its place, its default, its limits or codes.

    If the manual gives no factory default of the register, the record contains zeros, and ``by_order_code`` says so.
    """
    parameter = held_parameter.parameter
    record_members: dict[str, Literal] = {
        "name": context.parameters[parameter.name],
        "interface": SourceText(f"Interface.{register.interface.upper()}"),
        "address": SourceText(f"Address.{register.name.upper()}"),
        "default": register.default_bytes() or bytes(register.length),
        "order": byte_order(register),
        "low": held_parameter.field.low.constant,
        "width": held_parameter.field.widest,
        "min": parameter.min or 0,
        "max": parameter.max if parameter.max is not None else held_parameter.highest_value,
    }
    if parameter.by_code:
        record_members["codes"] = tuple((by_code.code, by_code.value) for by_code in parameter.by_code)
    if register.default is None:
        record_members["by_order_code"] = True
    if not parameter.by_code:
        record_members |= zero_means_member(meaning_of(held_parameter.field))
    return record("RegisterParameter", record_members)
