"""Two versions of a family: their common order codes, and the old and new names of things."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import fields, replace
from functools import cached_property
from typing import Any, TypeVar

from ..model import Device, Field
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS
from .affected_codes import reach
from .change import Change, Thing
from .expressions import Differing, Point, differing, settings_of, with_setting
from .pairs import Pair, both_of
from .rules import RULES, SAME
from .value_text import plain

_Part = TypeVar("_Part", bound=Any)
#: Rules whose values are interfaces, both of which are affected.
_MOVES = ("register-interface", "procedure-interface")


class FamilyPair:
    """Two versions of a family with their common order codes and renamed things."""

    def __init__(self, old: Device, new: Device) -> None:
        self.old = old
        self.new = new
        #: The new name by the old one, for each kind of renamed thing, and for fields also by their frame or register.
        self.names: dict[str, dict[str, str]] = {}
        #: The fields and joined numbers of the new frames.
        self.frame_names = frozenset(
            item.name for _, layout in new.layouts() for items in (layout.fields, layout.joins) for item in items
        )
        by_parts = {tuple(sorted(item.parts.items())): item.code for item in new.variants}
        codes, before = ({item.code for item in device.variants} for device in (new, old))
        #: The common order codes: the new ones by the old ones.
        self.shared: dict[str, str] = {}
        for item in old.variants:
            other = item.code if item.code in codes else by_parts.get(tuple(sorted(item.parts.items())), "")
            if other and (other == item.code or other not in before):
                self.shared[item.code] = other
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
        known = PARTS_BY_CLASS[type(part).__name__].by_attribute
        kinds = {item.name: known[item.name].refers_to for item in fields(part) if item.name in known}
        own = {name: self.to_new(kind, getattr(part, name), scope) for name, kind in kinds.items() if kind}
        return replace(part, **own) if own else part

    def to_new(self, kind: str, value: Any, scope: str = "") -> Any:
        """Return an old value with the new names of the things in it."""
        if isinstance(value, tuple):
            return tuple(self.to_new(kind.removesuffix("s"), item, scope) for item in value)
        if not isinstance(value, str):
            return {self.to_new("parameter", key): item for key, item in value.items()} if value else value
        if kind == "pattern":
            for before, after in self.names.get("part", {}).items():
                value = value.replace(f"{{{before}}}", f"{{{after}}}")
            return value
        if kind == "dotted":
            head, dot, tail = value.partition(".")
            register = self.to_new("register", head)
            return f"{register}{dot}{self.to_new('field', tail, register)}"
        if kind == "condition":
            field, _, word = value.partition(".")
            return f"{self.to_new('field', field, scope)}.{self.to_new('any-value', word)}"
        if kind == "limits":
            return self.to_new("register", self.to_new("field", value, scope))
        if kind == "any-field" and value in self.frame_names:
            return value
        if kind == "field":
            return self.names.get(f"field {scope}", {}).get(value, value)
        return self.names.get(kind, {}).get(value, value)

    @cached_property
    def _points(self) -> dict[str, list[Point]]:
        """The points for comparing expressions of each interface, and under an empty name those of all interfaces."""
        variants = {item.code: item for item in self.new.variants}
        back = {name: before for before, name in self.names.get("parameter", {}).items()}
        found: dict[str, list[Point]] = {}
        for variant in (item for item in self.old.variants if item.code in self.shared):
            other = variants[self.shared[variant.code]]
            for setting in settings_of(self.new):
                before = {back.get(name, name): value for name, value in setting.items()}
                was, now = with_setting(self.old, variant, before), with_setting(self.new, other, setting)
                point = Point(other.code, was, now, {name: now.get(name, number) for name, number in was.items()})
                for name in ("", other.interface):
                    found.setdefault(name, []).append(point)
        return found

    def differing(self, interface: str, old: Expression | None, new: Expression | None) -> Differing | None:
        """Return the differences of two expressions for an interface, or for all, or None if they are equal."""
        return differing(old, new, self._points.get(interface, ()))

    def place(self, field: Field, interface: str, is_old: bool) -> tuple[int | str, ...]:
        """Return the bits of a field at every point of an interface."""
        used = [item.old if is_old else item.new for item in self._points.get(interface, ())]
        bits = field.low, field.width
        return tuple(each.value(values) for values in used for each in bits) or tuple(each.render() for each in bits)

    def codes(self, interface: str, of: str = "shared") -> tuple[str, ...]:
        """Return the order codes of an interface, or all: of the ``old`` or ``new`` family, or the common ones."""
        device = self.old if of == "old" else self.new
        only = self.kept if of == "shared" else ()
        variants = (item for item in device.variants if interface in ("", item.interface))
        return tuple(item.code for item in variants if not only or item.code in only)

    def change(
        self, rule: str, thing: Thing, said: str, old: Any, new: Any, codes: Iterable[str] | None = None
    ) -> Change:
        """Return a change of a thing. Without ``codes``, it affects all order codes that the thing concerns."""
        side = "old" if rule.endswith("-gone") else "new" if rule.endswith("-new") else "shared"
        found = tuple(codes) if codes is not None else self.codes(thing.interface, side)
        if rule in _MOVES:
            found = (*found, *(code for code in self.codes(old) if code not in found))
        return Change(
            self.new.name,
            RULES[rule],
            thing.path,
            f"{thing.label}{said}",
            plain(old),
            plain(new),
            found,
            "" if rule.startswith("order-code-") else self._reach(side, found),
            thing.names,
        )

    def _reach(self, side: str, codes: Collection[str]) -> str:
        """Describe order codes of the old family, of the new one, or of those that both have."""
        if side == "old":
            return reach(self.old, codes)
        kept = tuple(item for item in self.new.variants if item.code in self.kept)
        said = reach(self.new, codes)
        if side == "new" or not kept or len(kept) == len(self.new.variants) or said.startswith("all "):
            return said
        among = reach(replace(self.new, variants=kept), codes)
        return f"{among} that stay" if among.startswith("all ") else said

    def presence(self, kind: str, thing: Thing, old: Any, new: Any) -> Iterator[Change]:
        """Yield a change if a thing is gone, new or renamed. ``thing.label`` ends with its present name."""
        if new is None:
            yield self.change(f"{kind}-gone", thing, " is gone", old, None)
        elif old is None:
            yield self.change(f"{kind}-new", thing, " is new", None, new)
        elif old.name != new.name:
            label = f"{thing.label.removesuffix(new.name)}{old.name} → {new.name} ({SAME[kind]})"
            yield self.change(f"{kind}-renamed", replace(thing, label=label), "", old.name, new.name)
