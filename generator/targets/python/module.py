"""A device module: all its parts, for its template."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

from ...model import Device, Field, Interface, Register, Value
from ...model.record import dataclass
from ...plan.frames import Dispatch, dispatches
from ...plan.identity import identities
from ...say.lines import plain
from ...say.name import words
from . import facts, text
from .bits import from_pieces
from .codec import Coder
from .context import Asked, Context, is_one_choice
from .docstrings import Block, Lines, docstring
from .expr import Expr
from .literals import Call
from .names import LOCAL_NAMES, attribute, camel, encoder_name, interface_name
from .procedures import Steps
from .readme import Readme
from .records import row, rows
from .shapes import Shape
from .variants import FrameKind, Variants


@dataclass(frozen=True)
class Enumeration:
    """Enumeration of named values. The enumeration of a register can decode and encode itself."""

    name: str
    doc: str
    values: tuple[Value, ...]
    register: Register | None = None


@dataclass(frozen=True)
class Dispatcher:
    """Function that decodes any frame from one sender."""

    plan: Dispatch
    name: str
    union: str
    interface: str
    encoder: str
    coders: tuple[Coder, ...]
    fallback: Coder | None

    @property
    def members(self) -> tuple[Coder, ...]:
        return self.coders if self.fallback is None else (*self.coders, self.fallback)

    @property
    def local(self) -> str:
        return attribute(self.plan.selector.name, LOCAL_NAMES)

    @property
    def value(self) -> Expr:
        return from_pieces(self.plan.bits.pieces)

    @property
    def allowed(self) -> list[int]:
        """All values of the selector that belong to a frame."""
        return sorted(value for branch in self.plan.branches for value in branch.values)

    @property
    def asked(self) -> list[Asked]:
        """Questions that the manual leaves open about any of the frames."""
        return list({item.name: item for coder in self.members for item in coder.asked}.values())

    @property
    def listed(self) -> list[tuple[str, str]]:
        """Arguments for the answers, with their descriptions."""
        return [(item.name, item.about) for item in self.asked]

    @property
    def told_by(self) -> str:
        """Printed name of the selector."""
        return plain(self.plan.selector.printed_name or words(self.plan.selector.name))


@dataclass(frozen=True)
class Section:
    """Interface of a device."""

    interface: Interface
    facts: Call
    notes: Sequence[Sequence[str]]
    coders: tuple[Coder, ...]
    dispatchers: tuple[Dispatcher, ...]


class Module:
    """All parts of a device module."""

    def __init__(self, device: Device) -> None:
        self.device, self.context = device, Context(device)
        self.name = self.context.module
        self.sections = [self._section(item) for item in device.interfaces]
        self.registers = [self._register(item) for item in device.registers]
        coders = {item.register.name: item for item in self.registers if isinstance(item, Coder) and item.register}
        self.by_register = coders
        self.procedures = [Steps(self.context, coders, item) for item in device.procedures]
        frames = tuple(item for section in self.sections for item in section.coders)
        self.coders = (*frames, *coders.values())
        kinds = tuple(self._frame_kinds())
        self.codes = Variants(self.context, kinds, frames)
        over = dict.fromkeys(item.interface for item in self.procedures)
        self.procedures_by_interface = {
            kind: tuple(item.name for item in self.procedures if item.interface == kind) for kind in over
        }
        self.readme = Readme(self.context, kinds, coders, {item.procedure.name: item for item in self.procedures})
        self.identities = list(identities(device))
        self.family, self.manual = facts.family(device), row("Manual", device.manual)
        self.order_code = facts.order_code(device.order_code)
        self.crcs = rows("Crc", device.crcs)

    # -- facts, which the files of the whole package do not need

    @cached_property
    def tables(self) -> list[facts.Table]:
        return facts.tables(self.device)

    @cached_property
    def reports(self) -> list[Call]:
        return facts.reports(self.device)

    @cached_property
    def register_rows(self) -> dict[str, Call]:
        return facts.register_rows(self.device)

    @cached_property
    def frame_rows(self) -> dict[str, tuple[Call, ...]]:
        return facts.frame_rows(self.device)

    # -- docstring and contents

    @property
    def doc(self) -> str:
        return text.of_module(self.device, [(name, ", ".join(names)) for name, names in self.contents], self._example())

    @cached_property
    def contents(self) -> list[tuple[str, list[str]]]:
        """All public names of the module, in groups, for its docstring. Each name is in one group."""
        return [(name, names) for name, names in self._contents() if names]

    def _contents(self) -> Iterator[tuple[str, list[str]]]:
        known = ["identify"] if self.identities else []
        yield "Encoders", ["lookup", *known, "Variant", *self._encoders(), "VARIANTS", "FAMILY"]
        for section in self.sections:
            told = [name for item in section.dispatchers for name in (item.union, item.name)]
            yield section.interface.title, [*(item.name for item in section.coders), *told]
        yield "All interfaces", ["Frame"] if self.codes.sent else []
        yield "Values of fields", [*(item.name for item in self.enums), *(item.kind for item, _ in self.alternatives)]
        yield "Registers", [*(item.name for item in self.registers), *(["Address"] if self.registers else [])]
        yield "Procedures", [item.name for item in self.procedures]
        yield "CRCs", [*self.context.crc_functions]
        yield "Facts", self.fact_names

    def _encoders(self) -> Iterator[str]:
        yield from (encoder_name(section.interface.name) for section in self.sections)

    @property
    def fact_names(self) -> list[str]:
        """Names of the tables of facts, in order."""
        names = ["MANUAL", "ORDER_CODE", *(item.name for item in self.tables)]
        names += [section.interface.name.upper() for section in self.sections]
        told = {"CRCS": self.crcs, "FRAMES": self.frame_rows, "REGISTERS": self.registers, "REPORTS": self.reports}
        return sorted([*names, *(name for name, rows in told.items() if rows)])

    def _example(self) -> Iterable[Block]:
        """Yield the lines of an example that decodes a frame and checks its verdict."""
        for frame in self.readme.frames[:1]:
            # The package's lookup() finds the family from which this one is derived.
            name, call = (self.name, f"{self.name}.lookup") if self.device.base else ("lookup", "lookup")
            names = ", ".join(filter(None, ("Verdict" if frame.judged else "", frame.module, name)))
            start = (
                f"from {self.device.manufacturer.python_package} import {names}",
                f'encoder = {call}("{frame.code}")',
            )
            if frame.judged:
                yield "A valid frame does not imply a usable position. Check the verdict before you use the position:"
            yield Lines((*start, f"frame = encoder.decode({frame.text}{frame.answers})", *frame.lines))

    @property
    def alternatives(self) -> list[tuple[Asked, str]]:
        """Questions that the manual leaves open, with their docstrings."""
        asked = self.context.asked.values()
        return [(item, text.of_alternative(self.device, item.alternative)) for item in asked]

    @property
    def known_by(self) -> list[str]:
        """Classes of the encoders whose registers identify the encoder."""
        return [encoder_name(item.interface) for item in self.identities]

    @cached_property
    def shapes(self) -> list[Shape]:
        """Descriptions of all frames for ``decode_many``."""
        frames = (item for section in self.sections for item in section.coders)
        told = self.context.reportings
        return [Shape(item, told.get(item.layout.name)) for item in frames]

    @property
    def register_shapes(self) -> list[Shape]:
        """Descriptions of the registers that have a class."""
        return [Shape(item, None) for item in self.by_register.values()]

    @property
    def shapes_by_sender(self) -> dict[tuple[str, str], list[Shape]]:
        """The same descriptions by interface and sender."""
        of = {id(item): section.interface.name for section in self.sections for item in section.coders}
        found: dict[tuple[str, str], list[Shape]] = {}
        for shape in self.shapes:
            found.setdefault((of[id(shape.coder)], shape.coder.layout.sender), []).append(shape)
        return found

    # -- parts

    @cached_property
    def enums(self) -> list[Enumeration]:
        return [
            Enumeration(self.context.enum(item), docstring(_about(item), indent=4), item.values)
            for item in self.context.choices.values()
        ]

    def _section(self, interface: Interface) -> Section:
        coders = tuple(Coder(self.context, interface.name, item) for item in interface.layouts)
        dispatchers = [self._dispatcher(interface, item, coders) for item in dispatches(interface.layouts)]
        # Frames sent by the master come first.
        dispatchers.sort(key=lambda item: item.plan.sender == "encoder")
        notes = text.notes(self.device, interface)
        return Section(interface, facts.interface(interface), notes, coders, tuple(dispatchers))

    def _dispatcher(self, interface: Interface, plan: Dispatch, coders: Sequence[Coder]) -> Dispatcher:
        several = sum(any(item.selector for item in other.layouts) for other in self.device.interfaces) > 1
        word = ("" if not several else f"{interface.name}_") + ("reply" if plan.sender == "encoder" else "request")
        of = {item.layout.name: item for item in coders}
        made = Dispatcher(
            plan,
            f"decode_{word}",
            camel(word),
            interface_name(interface.name),
            encoder_name(interface.name),
            tuple(of[branch.layout.name] for branch in plan.branches),
            of[plan.fallback.name] if plan.fallback is not None else None,
        )
        for item in made.members:
            item.passed = made.asked
        return made

    def _register(self, register: Register) -> Coder | Enumeration:
        if not is_one_choice(register):
            return Coder(self.context, register.interface, register.layout, register)
        summary, blocks = text.of_register(self.device, register)
        name = self.context.registers[register.name]
        return Enumeration(name, docstring(summary, *blocks, indent=4), register.values, register)

    def _frame_kinds(self) -> Iterator[FrameKind]:
        for section in self.sections:
            sent = [item for item in section.coders if item.layout.sender == "encoder"]
            # A word does not show which frame it is. Without a request, it is taken as the position.
            whole = (item for item in sent if self.device.tells_position(section.interface.name, item.layout))
            first = next(whole, sent[0] if sent else None)
            told = next((item for item in section.dispatchers if item.plan.sender == "encoder"), None)
            if first is not None:
                asked = told.asked if told is not None else first.asked
                names = (told.name, told.union) if told is not None else ("", "")
                members = told.members if told is not None else (first,)
                yield FrameKind(section.interface.name, first, *names, asked, members)


def _about(choice: Field) -> str:
    return text.of_value(choice) or f"Values of {choice.name}."
