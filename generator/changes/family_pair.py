"""Two versions of a family: their common order codes, and pairs of parts, with the new names of renamed ones."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from operator import attrgetter
from typing import Any, Generic, TypeVar

from ..model import Device, Field, Variant
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS
from .rules import COMMON_PROPERTY_BY_KIND, RULES, Change, ChangeSubject
from .values import (
    ComparisonPoint,
    NumberDifferences,
    as_plain_data,
    compare_at_points,
    describe_codes,
    settings_of,
    with_setting,
)

_Item = TypeVar("_Item")
_Key = TypeVar("_Key", bound=Hashable)
#: Return the name or another identifying property of an item.
PairingKey = Callable[[Any], Hashable | None]
_name_of: Callable[[Any], str] = attrgetter("name")


@dataclass(frozen=True, slots=True)
class OldAndNew(Generic[_Item]):
    """An old item and its new counterpart. ``old`` is None for a new item, ``new`` for an item that is gone."""

    old: _Item | None
    new: _Item | None

    @property
    def new_or_old(self) -> _Item:
        """The new item, or the old one if it is gone."""
        item = self.old if self.new is None else self.new
        assert item is not None
        return item

    @property
    def old_or_new(self) -> _Item:
        """The old item, or the new one if there was none."""
        item = self.new if self.old is None else self.old
        assert item is not None
        return item


def complete_pairs(pairs: Iterable[OldAndNew[_Item]]) -> Iterator[tuple[_Item, _Item]]:
    """Yield the old and the new item of each pair that has both."""
    for pair in pairs:
        if pair.old is not None and pair.new is not None:
            yield pair.old, pair.new


def pair_by_name(
    old_items: Sequence[_Item],
    new_items: Sequence[_Item],
    identity_of_old: PairingKey = lambda _: None,
    identity_of_new: PairingKey | None = None,
    *,
    name_of: PairingKey = _name_of,
) -> list[OldAndNew[_Item]]:
    """Return every item with its counterpart: first the new items in their order, then the items that are gone.

    Items with the same name are a pair. The other items are paired by their identity, a property that stays the same
    when an item is renamed. An old and a new item are a pair if they have the same identity, and no other unpaired item
    of the same version has it.

    Args:
        old_items: The old items.
        new_items: The new items.
        identity_of_old: Returns the identity of an old item, or None if only its name identifies it. By default, all
            items are identified only by their names.
        identity_of_new: Returns the identity of a new item. By default, it is computed as for old items.
        name_of: Returns the name of an item.
    """
    # The old item that corresponds to each name. Below, renamed items are added under their new names.
    old_item_by_name = {name_of(old_item): old_item for old_item in old_items}
    old_names = set(old_item_by_name)
    new_names = {name_of(new_item) for new_item in new_items}
    without_new_name = [old_item for old_item in old_items if name_of(old_item) not in new_names]
    without_old_name = [new_item for new_item in new_items if name_of(new_item) not in old_names]
    old_by_identity = _item_by_unique_identity(without_new_name, identity_of_old)
    new_by_identity = _item_by_unique_identity(without_old_name, identity_of_new or identity_of_old)
    paired_old_names = set(new_names)
    for identity, new_item in new_by_identity.items():
        if identity in old_by_identity:
            renamed_item = old_by_identity[identity]
            old_item_by_name[name_of(new_item)] = renamed_item
            paired_old_names.add(name_of(renamed_item))
    new_pairs = [OldAndNew(old=old_item_by_name.get(name_of(new_item)), new=new_item) for new_item in new_items]
    gone_items = [old_item for old_item in old_items if name_of(old_item) not in paired_old_names]
    return new_pairs + [OldAndNew(old=gone_item, new=None) for gone_item in gone_items]


def _item_by_unique_identity(items: Sequence[_Item], identity_of: PairingKey) -> dict[Hashable, _Item]:
    """Return the items by their identities, without items that have no identity or share it with another item."""
    identities = [identity_of(item) for item in items]
    count_by_identity = Counter(identities)
    item_by_identity: dict[Hashable, _Item] = {}
    for identity, item in zip(identities, items, strict=True):
        if identity is not None and count_by_identity[identity] == 1:
            item_by_identity[identity] = item
    return item_by_identity


def keys_with_old_and_new(
    old_by_key: Mapping[_Key, _Item], new_by_key: Mapping[_Key, _Item]
) -> Iterator[tuple[_Key, _Item | None, _Item | None]]:
    """Yield every key with its old and new item: ``("pin 1", old_contact, None)`` for an item that is gone.

    The keys of the old items come first, then the keys that are new.
    """
    for key in dict.fromkeys((*old_by_key, *new_by_key)):
        yield key, old_by_key.get(key), new_by_key.get(key)


_Part = TypeVar("_Part", bound=Any)
#: Rules for a move from one interface to another, which affects both interfaces.
_RULES_OF_INTERFACES = ("register-interface", "procedure-interface")


def _names_of_frame_fields(device: Device) -> frozenset[str]:
    """Return the names of all fields and joined numbers in the frames of a device."""
    names: set[str] = set()
    for _, layout in device.layouts():
        names.update(field.name for field in layout.fields)
        names.update(join.name for join in layout.joins)
    return frozenset(names)


def _match_order_codes(old: Device, new: Device) -> dict[str, str]:
    """Return the new order code for each old order code that both versions have.

    An order code was renamed if its text changed, and the texts of all its parts are the same: ``{"X-24": "X-24",
    "X-17": "X-17-B"}``. Removed order codes are left out.
    """
    old_codes, new_codes = _order_codes_of(old), _order_codes_of(new)
    new_code_by_parts = {_parts_key(variant): variant.code for variant in new.variants}
    new_code_by_old: dict[str, str] = {}
    for variant in old.variants:
        if variant.code in new_codes:
            new_code_by_old[variant.code] = variant.code
            continue
        renamed_code = new_code_by_parts.get(_parts_key(variant))
        # A new code that is also in the old family is the counterpart of that old code.
        if renamed_code is not None and renamed_code not in old_codes:
            new_code_by_old[variant.code] = renamed_code
    return new_code_by_old


def _affected_side(rule: str) -> str:
    """Return which order codes a change by a rule affects: the "old" ones, the "new" ones, or the "common" ones."""
    if rule.endswith("-gone"):
        return "old"
    if rule.endswith("-new"):
        return "new"
    return "common"


def _order_codes_of(device: Device) -> set[str]:
    return {variant.code for variant in device.variants}


def _parts_key(variant: Variant) -> tuple[tuple[str, str], ...]:
    """Return the texts of the parts of an order code, in a comparable form."""
    return tuple(sorted(variant.parts.items()))


class FamilyPair:
    """Two versions of a family with their common order codes and renamed parts."""

    def __init__(self, old: Device, new: Device) -> None:
        self.old = old
        self.new = new
        #: The new name by the old name, for each kind of renamed part, and for fields also by their frame or register.
        self.new_names_by_kind: dict[str, dict[str, str]] = {}
        #: The fields and joined numbers of the new frames.
        self.names_in_new_frames = _names_of_frame_fields(new)
        #: The new order code by the old one, for order codes that both versions have.
        self.new_code_by_old = _match_order_codes(old, new)
        self._old_code_by_new = {new_code: old_code for old_code, new_code in self.new_code_by_old.items()}
        #: The order codes that both versions have, as the new version spells them.
        self.common_new_codes = frozenset(self.new_code_by_old.values())

    def remember_renamings(self, part_kind: str, pairs: Iterable[OldAndNew[Any]]) -> None:
        """Remember the new names of renamed parts, so that references to them do not count as changed.

        ``part_kind`` is the kind of the parts, such as ``register``, or ``field mode`` for the fields of a register or
        frame ``mode``.
        """
        for old, new in complete_pairs(pairs):
            if old.name != new.name:
                new_names = self.new_names_by_kind.setdefault(part_kind, {})
                new_names[old.name] = new.name

    def with_new_names(self, part: _Part, scope: str = "") -> _Part:
        """Return an old part of the model in which references to renamed parts have the new names.

        The table of members lists the kind of part that each member refers to. ``scope`` is the frame or register in
        which to look up the names of fields.
        """
        members = PARTS_BY_CLASS[type(part).__name__].by_attribute
        renamed_references: dict[str, Any] = {}
        for attribute in dataclasses.fields(part):
            member = members.get(attribute.name)
            # ``refers_to`` is the kind of part that the member names, or "" if it names none.
            if member is not None and member.refers_to:
                old_reference = getattr(part, attribute.name)
                renamed_references[attribute.name] = self.to_new_names(member.refers_to, old_reference, scope)
        return replace(part, **renamed_references) if renamed_references else part

    def to_new_names(self, part_kind: str, old_names: Any, scope: str = "") -> Any:
        """Return an old value, with the names of one kind of part replaced by their new names.

        The value is a name, a tuple of names, or a map of numbers by parameter names. ``part_kind`` is plural for a
        tuple, such as ``registers``. ``scope`` is the frame or register in which fields are looked up.
        """
        if isinstance(old_names, str):
            return self._text_to_new_names(part_kind, old_names, scope)
        if isinstance(old_names, tuple):
            kind_of_each = part_kind.removesuffix("s")
            return tuple(self.to_new_names(kind_of_each, old_name, scope) for old_name in old_names)
        if not old_names:
            return old_names
        return {self.to_new_names("parameter", parameter): number for parameter, number in old_names.items()}

    def _text_to_new_names(self, part_kind: str, old_text: str, scope: str) -> str:
        """Return a text in which the old names of renamed parts are replaced by their new names.

        ``part_kind`` is the form of the text: a pattern, a dotted path, a condition or the subject of limits. For any
        other kind, the text is the name of a part of this kind.
        """
        match part_kind:
            case "pattern":
                # Order codes, such as ``TV62-{resolution}``.
                for old_part, new_part in self.new_names_by_kind.get("part", {}).items():
                    old_text = old_text.replace(f"{{{old_part}}}", f"{{{new_part}}}")
                return old_text
            case "dotted":
                # A register, or a field of it: ``status.error``.
                old_register, dot, old_field = old_text.partition(".")
                new_register = self.to_new_names("register", old_register)
                new_field = self.to_new_names("field", old_field, new_register)
                return f"{new_register}{dot}{new_field}"
            case "condition":
                # A field and its value: ``mode.fast``.
                old_field, _, old_value = old_text.partition(".")
                new_field = self.to_new_names("field", old_field, scope)
                new_value = self.to_new_names("any-value", old_value)
                return f"{new_field}.{new_value}"
            case "limits":
                # The limits of a register apply to a field, or to the register itself.
                new_name: str = self.to_new_names("field", old_text, scope)
                return self._text_to_new_names("register", new_name, scope="")
            case "any-field" if old_text in self.names_in_new_frames:
                # The reference is valid for any frame with this field, and a new frame still has it.
                return old_text
            case "field":
                return self.new_names_by_kind.get(f"field {scope}", {}).get(old_text, old_text)
            case _:
                return self.new_names_by_kind.get(part_kind, {}).get(old_text, old_text)

    @cached_property
    def _points_by_interface(self) -> dict[str, list[ComparisonPoint]]:
        """The points at which expressions are compared, by interface. The name "" has the points of all interfaces.

        There is a point for each order code that both versions have, with each setting of registers and each answer to
        the manual's open questions.
        """
        new_variant_by_code = {variant.code: variant for variant in self.new.variants}
        points_by_interface: dict[str, list[ComparisonPoint]] = {}
        for old_variant in self.old.variants:
            if old_variant.code not in self.new_code_by_old:
                continue
            new_variant = new_variant_by_code[self.new_code_by_old[old_variant.code]]
            for setting in settings_of(self.new):
                point = self._comparison_point(old_variant, new_variant, setting)
                points_by_interface.setdefault("", []).append(point)
                points_by_interface.setdefault(new_variant.interface, []).append(point)
        return points_by_interface

    def _comparison_point(
        self, old_variant: Variant, new_variant: Variant, setting: Mapping[str, int]
    ) -> ComparisonPoint:
        """Return the parameters of an order code in both versions, under a setting of registers and answers.

        ``setting`` contains values by the new names of the parameters. The old version gets them under the old names.
        """
        new_name_by_old = self.new_names_by_kind.get("parameter", {})
        old_name_by_new = {new_name: old_name for old_name, new_name in new_name_by_old.items()}
        old_setting = {old_name_by_new.get(name, name): value for name, value in setting.items()}
        old_parameters = with_setting(self.old, old_variant, old_setting)
        new_parameters = with_setting(self.new, new_variant, setting)
        return ComparisonPoint(
            code=new_variant.code,
            old_parameters=old_parameters,
            new_parameters=new_parameters,
            compared_parameters={name: new_parameters.get(name, value) for name, value in old_parameters.items()},
        )

    def compare_expressions(
        self, interface: str, old: Expression | None, new: Expression | None
    ) -> NumberDifferences | None:
        """Return the differences between two expressions, or None if their values are equal for every order code.

        They are compared for the order codes of the interface, or for all order codes if ``interface`` is empty.
        """
        return compare_at_points(old, new, self._points_by_interface.get(interface, ()))

    def low_bits_and_widths(self, field: Field, interface: str, *, is_old: bool) -> tuple[int | str, ...]:
        """Return the low bit and the width of a field for each common order code: ``(0, 17, 0, 19)`` for two codes.

        If the versions have no common order code over this interface, the two expressions are returned as texts:
        ``("0", "resolution")``.
        """
        if not self._points_by_interface.get(interface):
            return field.low.render(), field.width.render()
        low_bits = self.values_at_points(field.low, interface, is_old=is_old)
        widths = self.values_at_points(field.width, interface, is_old=is_old)
        return tuple(chain.from_iterable(zip(low_bits, widths, strict=True)))

    def values_at_points(self, expression: Expression, interface: str, *, is_old: bool) -> tuple[int, ...]:
        """Return the values of an expression for each common order code and setting of an interface.

        ``is_old`` selects the parameters of the old or the new version.
        """
        points = self._points_by_interface.get(interface, ())
        if is_old:
            return tuple(expression.value(point.old_parameters) for point in points)
        return tuple(expression.value(point.new_parameters) for point in points)

    def order_codes_with_interface(self, interface: str, side: str = "common") -> tuple[str, ...]:
        """Return the order codes of an interface, or of all interfaces if ``interface`` is empty.

        ``side`` selects the codes of the ``old`` or ``new`` version, or the ``common`` codes, in the spelling of the
        new version. If the versions have no common code, all codes of the new version count as common.
        """
        device = self.old if side == "old" else self.new
        codes = [variant.code for variant in device.variants if interface in ("", variant.interface)]
        if side == "common" and self.common_new_codes:
            codes = [code for code in codes if code in self.common_new_codes]
        return tuple(codes)

    def change(
        self,
        rule: str,
        subject: ChangeSubject,
        description: str,
        old: Any,
        new: Any,
        codes: Iterable[str] | None = None,
    ) -> Change:
        """Return a change of the subject by a rule, with the order codes that it affects.

        These are ``codes``, or by default all order codes of the subject's interface: the old codes if the rule ends
        with "-gone", the new codes if it ends with "-new", and otherwise the codes that both versions have. A register
        or procedure that moves to a different interface affects the order codes of both interfaces.
        """
        side = _affected_side(rule)
        affected_codes = tuple(codes) if codes is not None else self.order_codes_with_interface(subject.interface, side)
        if rule in _RULES_OF_INTERFACES:
            old_interface = old
            codes_of_both_interfaces = (*affected_codes, *self.order_codes_with_interface(old_interface))
            affected_codes = tuple(dict.fromkeys(codes_of_both_interfaces))
        affected_codes_text = ""
        # The text of a change of order codes already lists them.
        if not rule.startswith("order-code-"):
            affected_codes_text = self._describe_affected_codes(side, affected_codes)
        return Change(
            family=self.new.name,
            rule=RULES[rule],
            path=subject.path,
            text=f"{subject.label}{description}",
            old=as_plain_data(old),
            new=as_plain_data(new),
            codes=affected_codes,
            affected_codes_text=affected_codes_text,
            names=subject.names,
        )

    def limited_to_codes(self, change: Change, codes: Sequence[str]) -> Change:
        """Return the change with only these order codes as affected. Both versions have them."""
        return replace(change, codes=tuple(codes), affected_codes_text=self._describe_affected_codes("common", codes))

    def old_code(self, code: str) -> str:
        """Return the old order code that corresponds to an order code of the new version."""
        return self._old_code_by_new.get(code, code)

    def _describe_affected_codes(self, side: str, codes: Collection[str]) -> str:
        """Describe order codes in words, such as ``all 12 BiSS order codes``, or as a pattern, such as ``X-24-…``.

        ``side`` is "old", "new" or "common". If the codes are all codes that both versions have over an interface, but
        the new version has more, the text is ``all 10 BiSS order codes that stay``.
        """
        if side == "old":
            return describe_codes(self.old, codes)
        codes_text = describe_codes(self.new, codes)
        common_variants = tuple(variant for variant in self.new.variants if variant.code in self.common_new_codes)
        has_only_some_common_codes = 0 < len(common_variants) < len(self.new.variants)
        if side == "new" or not has_only_some_common_codes or codes_text.startswith("all "):
            return codes_text
        # The codes may be all common codes of an interface, while the new version has more codes.
        new_family_without_new_codes = replace(self.new, variants=common_variants)
        text_among_common = describe_codes(new_family_without_new_codes, codes)
        if text_among_common.startswith("all "):
            return f"{text_among_common} that stay"
        return codes_text

    def compare_presence(
        self, part_kind: str, subject: ChangeSubject, old: Any, new: Any, common_property: str = ""
    ) -> Iterator[Change]:
        """Yield a change if a part is gone, new or renamed. ``subject.label`` ends with its new or only name.

        The text of a renaming says what both versions of the part have in common: ``register mode → state (the same
        address)``. This is ``common_property``, or by default the property that identifies parts of this kind.
        """
        if new is None:
            yield self.change(f"{part_kind}-gone", subject, description=" is gone", old=old, new=None)
        elif old is None:
            yield self.change(f"{part_kind}-new", subject, description=" is new", old=None, new=new)
        elif old.name != new.name:
            words_before_name = subject.label.removesuffix(new.name)
            label = (
                f"{words_before_name}{old.name} → {new.name} ({common_property or COMMON_PROPERTY_BY_KIND[part_kind]})"
            )
            renamed_subject = replace(subject, label=label)
            yield self.change(f"{part_kind}-renamed", renamed_subject, description="", old=old.name, new=new.name)
