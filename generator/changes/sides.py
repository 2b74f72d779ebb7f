"""Two families side by side: the order codes that both have, and the names under which things are known on each."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import Any

from ..model import Device, Layout, Parameter
from ..model.expressions import Expression
from .change import Change, Thing
from .pairs import Pair, pairs
from .reach import reach
from .rules import RULES
from .shown import plain
from .values import Differing, Point, differing, points_of

#: Rules whose values are interfaces, which they reach both.
_MOVES = ("register-interface", "procedure-interface")


class Sides:
    """Two families, and what is known of both."""

    def __init__(self, old: Device, new: Device) -> None:
        self.old = old
        self.new = new
        #: The new name by the old one, for each kind of thing that was renamed; fields also by what they are part of.
        self.names: dict[str, dict[str, str]] = {}
        by_parts = {tuple(sorted(item.parts.items())): item.code for item in new.variants}
        codes = {item.code for item in new.variants}
        #: The fields and joined numbers that the new frames have.
        self.frame_names = frozenset(
            item.name for _, layout in new.layouts() for items in (layout.fields, layout.joins) for item in items
        )
        before = {item.code for item in old.variants}
        #: The order codes that both have, the new by the old.
        self.shared: dict[str, str] = {}
        for item in old.variants:
            other = item.code if item.code in codes else by_parts.get(tuple(sorted(item.parts.items())), "")
            if other and (other == item.code or other not in before):
                self.shared[item.code] = other
        for pair in self.parameters():
            self.note("parameter", pair.old, pair.new)
        points = points_of(old, new, self.shared, self.names.get("parameter", {}))
        interfaces = {item.interface for item in points}
        self._points = {"": points} | {
            name: tuple(item for item in points if item.interface == name) for name in interfaces
        }

    def note(self, kind: str, old: Any, new: Any) -> None:
        """Remember that a thing has another name."""
        if old is not None and new is not None and old.name != new.name:
            self.names.setdefault(kind, {})[old.name] = new.name

    def parameters(self) -> list[Pair[Parameter]]:
        """The quantities of both; one with another name has the same number for every order code."""
        shared = {code: index for index, code in enumerate(self.shared.values())}

        def same(device: Device, codes: Collection[str]) -> Any:
            variants = [item for item in device.variants if item.code in codes]

            def mark(item: Parameter) -> Any:
                numbers = tuple(variant.parameters[item.name] for variant in variants)
                return (item.unit, bool(item.read_from), item.alternative, numbers) if shared else None

            return mark

        before, after = same(self.old, self.shared), same(self.new, shared)
        return list(pairs(self.old.parameters, self.new.parameters, lambda item: item.name, before, after))

    def to_new(self, kind: str, value: Any, scope: str = "") -> Any:
        """An old value that names things, by their new names."""
        if isinstance(value, tuple):
            return tuple(self.to_new(kind.removesuffix("s"), item, scope) for item in value)
        if not isinstance(value, str):
            return {self.to_new("parameter", key): item for key, item in value.items()} if value else value
        if kind == "dotted":
            head, dot, tail = value.partition(".")
            register = self.to_new("register", head)
            return f"{register}{dot}{self.to_new('field', tail, register)}"
        if kind == "limits":
            return self.to_new("register", self.to_new("field", value, scope))
        if kind == "any-field" and value in self.frame_names:
            return value
        if kind == "field":
            return self.names.get(f"field {scope}", {}).get(value, value)
        return self.names.get(kind, {}).get(value, value)

    def at(self, interface: str) -> tuple[Point, ...]:
        """The points at which expressions of an interface are compared; of all where it is empty."""
        return self._points.get(interface, ())

    def differing(self, interface: str, old: Expression | None, new: Expression | None) -> Differing | None:
        """Where two expressions differ, at the points of an interface; None where they come to the same."""
        return differing(old, new, self.at(interface))

    def places(self, layout: Layout, interface: str, is_old: bool) -> tuple[tuple[int, ...], ...]:
        """Where each field of a layout stands at every point."""
        points = self.at(interface)
        used = [item.old if is_old else item.new for item in points]
        return tuple(
            tuple(number for values in used for number in (item.low.value(values), item.width.value(values)))
            if used
            else (hash(item.low.render()), hash(item.width.render()))
            for item in layout.fields
        )

    def codes(self, interface: str, of: str = "shared") -> tuple[str, ...]:
        """The order codes of an interface, or all: those of the ``old`` or ``new`` family, or those that both have."""
        device = self.old if of == "old" else self.new
        kept = set(self.shared.values()) if of == "shared" and self.shared else None
        return tuple(
            item.code
            for item in device.variants
            if interface in ("", item.interface) and (kept is None or item.code in kept)
        )

    def change(
        self, rule: str, thing: Thing, said: str, old: Any, new: Any, codes: Iterable[str] | None = None
    ) -> Change:
        """A change of a thing; without ``codes`` it reaches all that the thing concerns."""
        side = "old" if rule.endswith("-gone") else "new" if rule.endswith("-new") else "shared"
        found = tuple(codes) if codes is not None else self.codes(thing.interface, side)
        if rule in _MOVES:
            found = (*found, *(code for code in self.codes(old) if code not in found))
        names = {"c": thing.c, "python": thing.python}
        return Change(
            self.new.name,
            RULES[rule],
            thing.path,
            f"{thing.label}{said}",
            plain(old),
            plain(new),
            found,
            "" if rule.startswith("order-code-") else self._reach(side, found),
            {name: text for name, text in names.items() if text},
        )

    def _reach(self, side: str, codes: Collection[str]) -> str:
        """Which order codes these are, of the old family, of the new one, or of those that both have."""
        if side == "old":
            return reach(self.old, codes)
        kept = tuple(item for item in self.new.variants if item.code in self.shared.values())
        said = reach(self.new, codes)
        if side == "new" or not kept or len(kept) == len(self.new.variants) or said.startswith("all "):
            return said
        among = reach(replace(self.new, variants=kept), codes)
        return f"{among} that stay" if among.startswith("all ") else said

    def presence(self, kind: str, thing: Thing, old: Any, new: Any) -> Iterator[Change]:
        """Whether a thing is gone, new, or has another name; ``thing.label`` ends with the name that it has now."""
        from .rules import SAME

        if new is None:
            yield self.change(f"{kind}-gone", thing, " is gone", old, None)
        elif old is None:
            yield self.change(f"{kind}-new", thing, " is new", None, new)
        elif old.name != new.name:
            label = f"{thing.label.removesuffix(new.name)}{old.name} → {new.name} ({SAME[kind]})"
            yield self.change(
                f"{kind}-renamed",
                Thing(thing.path, label, thing.interface, thing.c, thing.python),
                "",
                old.name,
                new.name,
            )
