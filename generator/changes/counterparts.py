"""Two versions of a family: their common order codes, and the things that are the same under another name."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import cached_property, partial
from operator import attrgetter
from typing import Any, TypeVar

from ..model import Device, Field, Layout, ModifyStep, Parameter, Procedure, Register, Rs485, Step, Variant, WriteStep
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS
from .pairs import Pair, both_of, paired
from .rules import RULES, SAME, Change, Subject
from .values import NumberDifferences, Point, describe_codes, differing, plain, settings_of, with_setting

_Part = TypeVar("_Part", bound=Any)
#: Rules whose values are interfaces, both of which are affected.
_MOVES = ("register-interface", "procedure-interface")


def _names_in_frames(device: Device) -> frozenset[str]:
    """Return the names of the fields and joined numbers of all frames."""
    names: set[str] = set()
    for _, layout in device.layouts():
        names.update(field.name for field in layout.fields)
        names.update(join.name for join in layout.joins)
    return frozenset(names)


def _shared_codes(old: Device, new: Device) -> dict[str, str]:
    """Return the new order code by the old one, for those with the same code or else the same parts."""
    old_codes, new_codes = _codes_of(old), _codes_of(new)
    new_code_by_parts = {_parts_key(variant): variant.code for variant in new.variants}
    shared: dict[str, str] = {}
    for variant in old.variants:
        if variant.code in new_codes:
            shared[variant.code] = variant.code
            continue
        renamed_code = new_code_by_parts.get(_parts_key(variant))
        # A code that also the old family has belongs to that order code.
        if renamed_code is not None and renamed_code not in old_codes:
            shared[variant.code] = renamed_code
    return shared


def _side_of(rule: str) -> str:
    """Return the version whose order codes a change affects: the old one, the new one, or those that both have."""
    if rule.endswith("-gone"):
        return "old"
    return "new" if rule.endswith("-new") else "shared"


def _codes_of(device: Device) -> set[str]:
    return {variant.code for variant in device.variants}


def _parts_key(variant: Variant) -> tuple[tuple[str, str], ...]:
    return tuple(sorted(variant.parts.items()))


class FamilyPair:
    """Two versions of a family with their common order codes and renamed things."""

    def __init__(self, old: Device, new: Device) -> None:
        self.old = old
        self.new = new
        #: The new name by the old one, for each kind of renamed thing, and for fields also by their frame or register.
        self.names: dict[str, dict[str, str]] = {}
        #: The fields and joined numbers of the new frames.
        self.frame_names = _names_in_frames(new)
        #: The common order codes: the new ones by the old ones.
        self.shared = _shared_codes(old, new)
        #: The new ones among them.
        self.kept = frozenset(self.shared.values())

    def note(self, kind: str, pairs: Iterable[Pair[Any]]) -> None:
        """Remember which things were renamed, so that references to them do not count as changed."""
        for old, new in both_of(pairs):
            if old.name != new.name:
                self.names.setdefault(kind, {})[old.name] = new.name

    def in_new(self, part: _Part, scope: str = "") -> _Part:
        """Return an old part of the model with the new names of the things that it refers to.

        ``scope`` is the frame or register in which to look up the names of fields.
        """
        members = PARTS_BY_CLASS[type(part).__name__].by_attribute
        renamed: dict[str, Any] = {}
        for attribute in dataclasses.fields(part):
            member = members.get(attribute.name)
            if member is not None and member.refers_to:
                renamed[attribute.name] = self.to_new(member.refers_to, getattr(part, attribute.name), scope)
        return replace(part, **renamed) if renamed else part

    def to_new(self, kind: str, value: Any, scope: str = "") -> Any:
        """Return an old value with the new names of the things in it: a name, names, or numbers by parameter names."""
        if isinstance(value, str):
            return self._text_to_new(kind, value, scope)
        if isinstance(value, tuple):
            return tuple(self.to_new(kind.removesuffix("s"), member, scope) for member in value)
        if not value:
            return value
        return {self.to_new("parameter", parameter): number for parameter, number in value.items()}

    def _text_to_new(self, kind: str, value: str, scope: str) -> str:
        """Return a text that is or contains old names, with the new ones."""
        match kind:
            case "pattern":
                for old_name, new_name in self.names.get("part", {}).items():
                    value = value.replace(f"{{{old_name}}}", f"{{{new_name}}}")
                return value
            case "dotted":
                register_name, dot, field_name = value.partition(".")
                new_register = self.to_new("register", register_name)
                return f"{new_register}{dot}{self.to_new('field', field_name, new_register)}"
            case "condition":
                field_name, _, value_name = value.partition(".")
                return f"{self.to_new('field', field_name, scope)}.{self.to_new('any-value', value_name)}"
            case "limits":
                # The limits of a register apply to a field, or to the register itself.
                new_field: str = self.to_new("field", value, scope)
                return self._text_to_new("register", new_field, "")
            case "any-field" if value in self.frame_names:
                return value
            case "field":
                return self.names.get(f"field {scope}", {}).get(value, value)
            case _:
                return self.names.get(kind, {}).get(value, value)

    @cached_property
    def _points(self) -> dict[str, list[Point]]:
        """The points for comparing expressions of each interface, and under an empty name those of all interfaces."""
        new_variants = {variant.code: variant for variant in self.new.variants}
        points: dict[str, list[Point]] = {}
        for variant in self.old.variants:
            if variant.code not in self.shared:
                continue
            new_variant = new_variants[self.shared[variant.code]]
            for setting in settings_of(self.new):
                point = self._point(variant, new_variant, setting)
                points.setdefault("", []).append(point)
                points.setdefault(new_variant.interface, []).append(point)
        return points

    def _point(self, old_variant: Variant, new_variant: Variant, setting: Mapping[str, int]) -> Point:
        """Return the point of a common order code under a setting of the new family."""
        old_names = {new_name: old_name for old_name, new_name in self.names.get("parameter", {}).items()}
        old_setting = {old_names.get(name, name): value for name, value in setting.items()}
        old_parameters = with_setting(self.old, old_variant, old_setting)
        new_parameters = with_setting(self.new, new_variant, setting)
        return Point(
            code=new_variant.code,
            old=old_parameters,
            new=new_parameters,
            compared={name: new_parameters.get(name, value) for name, value in old_parameters.items()},
        )

    def differing(self, interface: str, old: Expression | None, new: Expression | None) -> NumberDifferences | None:
        """Return the differences of two expressions for an interface, or for all, or None if they are equal."""
        return differing(old, new, self._points.get(interface, ()))

    def place(self, field: Field, interface: str, is_old: bool) -> tuple[int | str, ...]:
        """Return the low bit and the width of a field at every point of an interface, one after the other."""
        points = self._points.get(interface, ())
        if not points:
            return field.low.render(), field.width.render()
        places: list[int] = []
        for point in points:
            parameters = point.old if is_old else point.new
            places += (field.low.value(parameters), field.width.value(parameters))
        return tuple(places)

    def numbers(self, expression: Expression, interface: str, is_old: bool) -> tuple[int, ...]:
        """Return the value of an expression at every point of an interface."""
        points = self._points.get(interface, ())
        return tuple(expression.value(point.old if is_old else point.new) for point in points)

    def codes(self, interface: str, side: str = "shared") -> tuple[str, ...]:
        """Return the order codes of an interface, or all: of the ``old`` or ``new`` family, or the common ones.

        If no order code is common, those of the new family count as common.
        """
        device = self.old if side == "old" else self.new
        codes = [variant.code for variant in device.variants if interface in ("", variant.interface)]
        if side == "shared" and self.kept:
            codes = [code for code in codes if code in self.kept]
        return tuple(codes)

    def change(
        self, rule: str, subject: Subject, description: str, old: Any, new: Any, codes: Iterable[str] | None = None
    ) -> Change:
        """Return a change of a thing. Without ``codes``, it affects all order codes that the thing concerns."""
        side = _side_of(rule)
        affected = tuple(codes) if codes is not None else self.codes(subject.interface, side)
        if rule in _MOVES:
            old_interface = old
            affected = (*affected, *(code for code in self.codes(old_interface) if code not in affected))
        # The text of a change of order codes already lists them.
        reach = "" if rule.startswith("order-code-") else self._reach(side, affected)
        return Change(
            family=self.new.name,
            rule=RULES[rule],
            path=subject.path,
            text=f"{subject.label}{description}",
            old=plain(old),
            new=plain(new),
            codes=affected,
            reach=reach,
            names=subject.names,
        )

    def _reach(self, side: str, codes: Collection[str]) -> str:
        """Describe order codes of the old family, of the new one, or of those that both have."""
        if side == "old":
            return describe_codes(self.old, codes)
        text = describe_codes(self.new, codes)
        common_variants = tuple(variant for variant in self.new.variants if variant.code in self.kept)
        have_same_codes = len(common_variants) in (0, len(self.new.variants))
        if side == "new" or have_same_codes or text.startswith("all "):
            return text
        # All common codes of an interface are not all of the new family.
        text_in_common = describe_codes(replace(self.new, variants=common_variants), codes)
        return f"{text_in_common} that stay" if text_in_common.startswith("all ") else text

    def presence(self, kind: str, subject: Subject, old: Any, new: Any, common: str = "") -> Iterator[Change]:
        """Yield a change if a thing is gone, new or renamed. ``subject.label`` ends with its present name.

        ``common`` is the property by which a renamed one is recognised, if it is not that of its kind.
        """
        if new is None:
            yield self.change(f"{kind}-gone", subject, " is gone", old, None)
        elif old is None:
            yield self.change(f"{kind}-new", subject, " is new", None, new)
        elif old.name != new.name:
            label = f"{subject.label.removesuffix(new.name)}{old.name} → {new.name} ({common or SAME[kind]})"
            yield self.change(f"{kind}-renamed", replace(subject, label=label), "", old.name, new.name)


_Item = TypeVar("_Item")


def note_all(family_pair: FamilyPair) -> None:
    """Remember every renaming, so that references to the renamed thing do not count as changed."""
    family_pair.note("parameter", in_section(family_pair, "parameters"))
    family_pair.note("part", in_section(family_pair, "order_code.parts"))
    family_pair.note("crc", in_section(family_pair, "crcs"))
    family_pair.note("decision", in_section(family_pair, "alternatives"))
    family_pair.note("register", in_section(family_pair, "registers"))
    for old_register, new_register in both_of(in_section(family_pair, "registers")):
        _note_layout(family_pair, old_register.layout, new_register.layout, new_register.interface, new_register.name)
    for old_interface, new_interface in both_of(paired(family_pair.old.interfaces, family_pair.new.interfaces)):
        for old_frame, new_frame in both_of(
            recognised(family_pair, old_interface.layouts, new_interface.layouts, new_interface.name)
        ):
            _note_layout(family_pair, old_frame, new_frame, new_interface.name, new_frame.name)
        if isinstance(old_interface, Rs485) and isinstance(new_interface, Rs485):
            family_pair.note("data-id", recognised(family_pair, old_interface.data_ids, new_interface.data_ids))
    family_pair.note("procedure", in_section(family_pair, "procedures"))


def _note_layout(family_pair: FamilyPair, old: Layout, new: Layout, interface: str, scope: str) -> None:
    field_pairs = fields(family_pair, old, new, interface)
    family_pair.note(f"field {scope}", field_pairs)
    join_pairs = recognised(family_pair, old.joins, new.joins, scope=scope)
    family_pair.note(f"field {scope}", join_pairs)
    family_pair.note("any-field", [*field_pairs, *join_pairs])
    for old_field, new_field in both_of(field_pairs):
        family_pair.note("any-value", recognised(family_pair, old_field.values, new_field.values))


def in_section(family_pair: FamilyPair, path: str) -> list[Pair[Any]]:
    """Pair the things in a section of the spec."""
    return recognised(family_pair, *map(attrgetter(path), (family_pair.old, family_pair.new)))


def fields(family_pair: FamilyPair, old: Layout, new: Layout, interface: str) -> list[Pair[Field]]:
    """Pair the fields of a frame or register, except those that only fill gaps."""
    old_fields, new_fields = _described_fields(old), _described_fields(new)
    pairs = recognised(family_pair, old_fields, new_fields, interface)
    gone_names = {pair.old.name for pair in pairs if pair.old is not None and pair.new is None}
    new_names = {pair.new.name for pair in pairs if pair.new is not None and pair.old is None}
    if not gone_names or not new_names:
        return pairs
    return _with_renamed_between_neighbours(family_pair, pairs, (old_fields, new_fields), interface)


def _with_renamed_between_neighbours(
    family_pair: FamilyPair, pairs: Sequence[Pair[Field]], both_fields: tuple[list[Field], list[Field]], interface: str
) -> list[Pair[Field]]:
    """Return the pairs, also of a field that is gone and a new one that are as wide and between the same fields.

    Such a field was renamed while a change elsewhere in the frame moved it.
    """
    new_by_old = {old.name: new.name for old, new in both_of(pairs)}
    new_by_new = {new: new for new in new_by_old.values()}
    old_neighbours = _neighbours(both_fields[0], new_by_old)
    new_neighbours = _neighbours(both_fields[1], new_by_new)

    def identity(is_old: bool, field: Field) -> Hashable:
        neighbours = (old_neighbours if is_old else new_neighbours)[field.name]
        widths = family_pair.place(field, interface, is_old)[1::2]
        return (*neighbours, field.group, field.carries_data, widths)

    unpaired_old = [pair.old for pair in pairs if pair.old is not None and pair.new is None]
    unpaired_new = [pair.new for pair in pairs if pair.new is not None and pair.old is None]
    found_pairs = paired(unpaired_old, unpaired_new, partial(identity, True), partial(identity, False))
    pair_by_name = {pair.item.name: pair for pair in found_pairs}
    in_new_order = [pair_by_name.get(pair.item.name, pair) for pair in pairs if pair.new is not None]
    return in_new_order + [pair for pair in found_pairs if pair.new is None]


def _neighbours(fields_in_order: Sequence[Field], paired_names: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Return the new names of the nearest paired fields before and after each field."""
    names = [paired_names.get(field.name, "") for field in fields_in_order]
    neighbours: dict[str, tuple[str, str]] = {}
    for index, field in enumerate(fields_in_order):
        name_before = next(filter(None, reversed(names[:index])), "")
        name_after = next(filter(None, names[index + 1 :]), "")
        neighbours[field.name] = name_before, name_after
    return neighbours


def _described_fields(layout: Layout) -> list[Field]:
    return [field for field in layout.fields if not field.fills_gap and not field.fills_byte]


def recognised(
    family_pair: FamilyPair,
    old_parts: Sequence[_Item],
    new_parts: Sequence[_Item],
    interface: str = "",
    scope: str = "",
) -> list[Pair[_Item]]:
    """Pair parts of the model by name, or by what identifies them under another name.

    Args:
        family_pair: The two versions of the family.
        old_parts: The old parts.
        new_parts: The new parts.
        interface: The interface of frames and fields.
        scope: The frame or register in which to look up the names of fields.
    """
    old_key = partial(_identity, family_pair, True, interface, scope)
    new_key = partial(_identity, family_pair, False, interface, scope)
    return paired(old_parts, new_parts, old_key, new_key)


def _identity(family_pair: FamilyPair, is_old: bool, interface: str, scope: str, part: Any) -> Hashable | None:
    """Return what identifies a part: the members that the table of members names, or for some parts as follows.

    Fields have the same bits, and a new one carries data only if the old one does. Frames and registers also have the
    same bits. Procedures have the same steps, and parameters the same number for every order code.
    """
    match part:
        case Field():
            return family_pair.place(part, interface, is_old), part.carries_data
        case Procedure():
            in_new_names: Callable[[Step], Step] = partial(step_in_new, family_pair) if is_old else without_words
            return part.interface, len(part.arguments), tuple(map(in_new_names, part.steps))
        case Parameter():
            return _parameter_identity(family_pair, is_old, part)
    identity_of_inner = partial(_identity, family_pair, is_old, interface, scope)
    if is_old:
        part = family_pair.in_new(part, scope)
    members = PARTS_BY_CLASS[type(part).__name__].identity
    values = [_identifying_value(getattr(part, name), identity_of_inner) for name in members]
    layout = part.layout if isinstance(part, Register) else part
    if isinstance(layout, Layout):
        places = [family_pair.place(field, interface or part.interface, is_old) for field in layout.fields]
        values.append(tuple(places))
    return tuple(values) if any(values) else None


def _parameter_identity(family_pair: FamilyPair, is_old: bool, parameter: Parameter) -> Hashable | None:
    """Return the unit and the origin of a parameter, and its numbers for the common order codes, if there are any."""
    device = family_pair.old if is_old else family_pair.new
    common_codes = family_pair.shared.keys() if is_old else family_pair.kept
    numbers = tuple(variant.parameters[parameter.name] for variant in device.variants if variant.code in common_codes)
    return (parameter.unit, bool(parameter.read_from), parameter.alternative, numbers) if numbers else None


def _identifying_value(member_value: Any, identity_of_inner: Callable[[Any], Hashable | None]) -> Any:
    """Return the value of a member without names: the values of a map, or the identities of parts."""
    if isinstance(member_value, Mapping):
        return tuple(sorted(member_value.values()))
    if isinstance(member_value, tuple) and any(map(is_dataclass, member_value)):
        return tuple(identity_of_inner(inner_part) for inner_part in member_value)
    return member_value


def without_words(step: Step) -> Step:
    """Return a step without its words."""
    return replace(step, meaning="", source=())


def step_in_new(family_pair: FamilyPair, step: Step) -> Step:
    """Return an old step without its words and with the new names of the things that it uses."""
    new_register = family_pair.to_new("register", getattr(step, "register", ""))
    renamed_step = family_pair.in_new(without_words(step), new_register)
    if isinstance(renamed_step, (WriteStep, ModifyStep)) and renamed_step.value is None:
        # Without a value, the name is that of an argument, which is not renamed with values.
        assert isinstance(step, (WriteStep, ModifyStep))
        return replace(renamed_step, value_name=step.value_name)
    return renamed_step
