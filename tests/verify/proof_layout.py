"""Facts about a layout that the proofs need: its parameters, its members as declared, and their meaning.

Nothing here or in the reference uses the code with which the C target reads or writes a field. Only the names and types
of struct members come from the header.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as attribute
from functools import cached_property

from codewheel.model import Choice, Crc, Device, Field, Flag, Join, Layout, Register, Text
from codewheel.model.expressions import Expression
from proof import Header, Member, Variants, in_c

#: The documented order of errors.
LENGTH, CRC, CONSTANT, RANGE = 1, 2, 3, 4


@dataclass(frozen=True)
class VisibleMember:
    """A member that users see: a field of the layout, a run of digits, or a join.

    ``value`` is the expected value according to the reference.
    """

    name: str
    member: Member
    type: str
    value: str
    characters: int = 0

    def equals(self, struct: str, expected: str) -> str:
        if self.type == "digits":
            return "1"  # division is too hard for the checker, so proof_digits.py goes through all numbers
        if self.characters:
            parts = []
            for at in range(self.characters):
                character = f"(unsigned char){struct}.{self.member.name}[{at}]"
                parts.append(f"{character} == (unsigned char)({expected} >> {8 * (self.characters - 1 - at)})")
            return "(" + " && ".join(parts) + ")"
        return f"(({self.type}){struct}.{self.member.name} == {expected})"


@dataclass(frozen=True)
class Codec:
    """One layout with its decoder and encoder.

    ``name`` is the name of the struct in C, and ``fixed_values`` fixes the contents of registers at run time.
    """

    device: Device
    interface: str
    layout: Layout
    header: Header
    prefix: str
    name: str
    register: Register | None = None
    fixed_values: Mapping[str, int] = attribute(default_factory=dict)

    @property
    def type(self) -> str:
        """Return the name of its struct in C."""
        return f"{self.name}_frame" if self.name == self.prefix else self.name

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        fixed = self.layout.selector if len(self.layout.selects) == 1 else ""
        return tuple(field for field in self.layout.data_fields if field.name != fixed)

    @cached_property
    def variants(self) -> Variants:
        ends = () if self.register is None else (self.register.min, self.register.max)
        limits = [end for end in ends if end is not None]
        equals = [field.equals for field in self.layout.fields if isinstance(field.equals, Expression)]
        expressions = [
            self.layout.bits,
            *(part for field in self.layout.fields for part in (field.low, field.width)),
            *limits,
            *equals,
        ]
        used = dict.fromkeys(name for expression in expressions for name in expression.parameters)
        return Variants.of_interface(
            self.device, self.interface, [*used, *([self.layout.gray_when] if self.layout.gray_when else [])]
        ).fixed(self.fixed_values)

    @property
    def by_word(self) -> bool:
        return self.layout.carried_as == "bits"

    @property
    def size(self) -> int:
        """Return the number of bytes of a layout that is carried as bytes."""
        assert self.layout.bits.is_constant
        assert self.layout.bits.constant % 8 == 0
        return self.layout.bits.constant // 8

    @property
    def bytes_upwards(self) -> range:
        """Return the places of the bytes, lowest first, or nothing for a word."""
        if self.by_word:
            return range(0)
        return range(self.size) if self.layout.byte_order == "low_byte_first" else range(self.size - 1, -1, -1)

    @property
    def has_digits(self) -> bool:
        return any(field.runs for field in self.fields)

    @property
    def crc(self) -> Crc | None:
        """The CRC of all its frames. Order codes with different CRCs have no proof."""
        return next(iter(self.device.crcs_of(self.layout)), None)

    def allowed(self, field: Field) -> tuple[int, ...]:
        """Return the only values that a field may have, or nothing if it may have any."""
        if field.name == self.layout.selector:
            return tuple(self.layout.selects)
        return tuple(value.value for value in field.values) if isinstance(field.kind, Choice) else ()

    def member(self, name: str) -> Member:
        return self.header.member(self.type, name)

    def join_width(self, join: Join) -> Expression:
        return sum((self.layout.field(name).width for name in join.fields), Expression(0))

    def joined(self, join: Join, *parts: str) -> str:
        """Return the number that consists of these parts, the highest first."""
        value = "0"
        for name, part in zip(join.fields, parts, strict=True):
            value = part if value == "0" else f"(({value}) << {in_c(self.layout.field(name).width)} | {part})"
        return value

    @cached_property
    def visible_members(self) -> tuple[VisibleMember, ...]:
        members: list[VisibleMember] = []
        for field in self.fields:
            raw, member = f"r_{field.name}", self.member(field.name)
            if isinstance(field.kind, Text):
                members.append(VisibleMember(field.name, member, "number", raw, field.widest // 8))
            elif isinstance(field.kind, Flag):
                sign = "==" if field.kind.active_low else "!="
                members.append(VisibleMember(field.name, member, "unsigned", f"({raw} {sign} 0)"))
            elif field.number.signed:
                value = f"signed_number({raw}, {in_c(field.width)})"
                members.append(VisibleMember(field.name, member, "long long", value))
            else:
                zero = field.number.zero_means
                value = f"({raw} == 0 ? (number){zero} : {raw})" if zero else raw
                members.append(VisibleMember(field.name, member, "number", value))
            members += [VisibleMember(run.name, self.member(run.name), "digits", field.name) for run in field.runs]
        numbers = [join.name for join in self.layout.joins] + (["unused"] if self.layout.unused else [])
        members += [VisibleMember(name, self.member(name), "number", f"r_{name}") for name in numbers]
        return tuple(members)

    def check_members(self) -> None:
        """Check that the struct has exactly the members of the layout."""
        names = {member.name for member in self.header.structs[self.type]} - {"no_data"}
        members = self.visible_members
        expected_names = {visible.member.name for visible in members}
        assert names == expected_names, f"{self.name}: members {sorted(names ^ expected_names)}"
        assert all(visible.member.count == visible.characters for visible in members), f"{self.name}: characters"
