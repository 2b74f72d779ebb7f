"""Two versions of a family: their common order codes, and the old and new names of things."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import fields, replace
from functools import cached_property
from typing import Any, TypeVar

from ..model import Device, Field, Variant
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS
from .change import Change, Subject
from .pairs import Pair, both_of
from .rules import RULES, SAME
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
    old_codes, new_codes = (_codes_of(device) for device in (old, new))
    new_by_parts = {_parts_key(variant): variant.code for variant in new.variants}
    shared: dict[str, str] = {}
    for variant in old.variants:
        code = variant.code
        new_code = code if code in new_codes else new_by_parts.get(_parts_key(variant), "")
        if new_code and (new_code == code or new_code not in old_codes):
            shared[code] = new_code
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
        rules = PARTS_BY_CLASS[type(part).__name__].by_attribute
        kinds = {member.name: rules[member.name].refers_to for member in fields(part) if member.name in rules}
        renamed = {name: self.to_new(kind, getattr(part, name), scope) for name, kind in kinds.items() if kind}
        return replace(part, **renamed) if renamed else part

    def to_new(self, kind: str, value: Any, scope: str = "") -> Any:
        """Return an old value with the new names of the things in it."""
        if isinstance(value, tuple):
            return tuple(self.to_new(kind.removesuffix("s"), member, scope) for member in value)
        if not isinstance(value, str):
            if not value:
                return value
            return {self.to_new("parameter", key): member for key, member in value.items()}
        return self._text_to_new(kind, value, scope)

    def _text_to_new(self, kind: str, value: str, scope: str) -> str:
        """Return a text that is or contains old names, with the new ones."""
        if kind == "pattern":
            for old_name, new_name in self.names.get("part", {}).items():
                value = value.replace(f"{{{old_name}}}", f"{{{new_name}}}")
            return value
        if kind == "dotted":
            head, dot, tail = value.partition(".")
            register = self.to_new("register", head)
            return f"{register}{dot}{self.to_new('field', tail, register)}"
        if kind == "condition":
            field, _, value_name = value.partition(".")
            return f"{self.to_new('field', field, scope)}.{self.to_new('any-value', value_name)}"
        if kind == "limits":
            new_field: str = self.to_new("field", value, scope)
            return self._text_to_new("register", new_field, "")
        if kind == "any-field" and value in self.frame_names:
            return value
        if kind == "field":
            return self.names.get(f"field {scope}", {}).get(value, value)
        return self.names.get(kind, {}).get(value, value)

    @cached_property
    def _points(self) -> dict[str, list[Point]]:
        """The points for comparing expressions of each interface, and under an empty name those of all interfaces."""
        variants = {variant.code: variant for variant in self.new.variants}
        old_names = {new_name: old_name for old_name, new_name in self.names.get("parameter", {}).items()}
        points: dict[str, list[Point]] = {}
        for variant in (candidate for candidate in self.old.variants if candidate.code in self.shared):
            new_variant = variants[self.shared[variant.code]]
            for setting in settings_of(self.new):
                old_setting = {old_names.get(name, name): value for name, value in setting.items()}
                old_parameters, new_parameters = (
                    with_setting(self.old, variant, old_setting),
                    with_setting(self.new, new_variant, setting),
                )
                point = Point(
                    new_variant.code,
                    old_parameters,
                    new_parameters,
                    {name: new_parameters.get(name, number) for name, number in old_parameters.items()},
                )
                for name in ("", new_variant.interface):
                    points.setdefault(name, []).append(point)
        return points

    def differing(self, interface: str, old: Expression | None, new: Expression | None) -> NumberDifferences | None:
        """Return the differences of two expressions for an interface, or for all, or None if they are equal."""
        return differing(old, new, self._points.get(interface, ()))

    def place(self, field: Field, interface: str, is_old: bool) -> tuple[int | str, ...]:
        """Return the bits of a field at every point of an interface."""
        points = self._points.get(interface, ())
        if not points:
            return field.low.render(), field.width.render()
        bits: list[int] = []
        for point in points:
            parameters = point.old if is_old else point.new
            bits += (field.low.value(parameters), field.width.value(parameters))
        return tuple(bits)

    def codes(self, interface: str, side: str = "shared") -> tuple[str, ...]:
        """Return the order codes of an interface, or all: of the ``old`` or ``new`` family, or the common ones."""
        device = self.old if side == "old" else self.new
        shared_codes = self.kept if side == "shared" else ()
        variants = (variant for variant in device.variants if interface in ("", variant.interface))
        return tuple(variant.code for variant in variants if not shared_codes or variant.code in shared_codes)

    def change(
        self, rule: str, subject: Subject, description: str, old: Any, new: Any, codes: Iterable[str] | None = None
    ) -> Change:
        """Return a change of a thing. Without ``codes``, it affects all order codes that the thing concerns."""
        side = _side_of(rule)
        affected = tuple(codes) if codes is not None else self.codes(subject.interface, side)
        if rule in _MOVES:
            affected = (*affected, *(code for code in self.codes(old) if code not in affected))
        return Change(
            family=self.new.name,
            rule=RULES[rule],
            path=subject.path,
            text=f"{subject.label}{description}",
            old=plain(old),
            new=plain(new),
            codes=affected,
            reach="" if rule.startswith("order-code-") else self._reach(side, affected),
            names=subject.names,
        )

    def _reach(self, side: str, codes: Collection[str]) -> str:
        """Describe order codes of the old family, of the new one, or of those that both have."""
        if side == "old":
            return describe_codes(self.old, codes)
        shared_variants = tuple(variant for variant in self.new.variants if variant.code in self.kept)
        text = describe_codes(self.new, codes)
        none_or_all_stay = len(shared_variants) in (0, len(self.new.variants))
        if side == "new" or none_or_all_stay or text.startswith("all "):
            return text
        shared_text = describe_codes(replace(self.new, variants=shared_variants), codes)
        return f"{shared_text} that stay" if shared_text.startswith("all ") else text

    def presence(self, kind: str, subject: Subject, old: Any, new: Any) -> Iterator[Change]:
        """Yield a change if a thing is gone, new or renamed. ``subject.label`` ends with its present name."""
        if new is None:
            yield self.change(f"{kind}-gone", subject, " is gone", old, None)
        elif old is None:
            yield self.change(f"{kind}-new", subject, " is new", None, new)
        elif old.name != new.name:
            label = f"{subject.label.removesuffix(new.name)}{old.name} → {new.name} ({SAME[kind]})"
            yield self.change(f"{kind}-renamed", replace(subject, label=label), "", old.name, new.name)
