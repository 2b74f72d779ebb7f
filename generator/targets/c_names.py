"""Every name that a header declares at file scope, and the part of the spec that it comes from: two parts can meet in one name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from ..model import Device, Layout
from ..problems import Path
from . import TargetError
from .c_source import c_name
from .c_views import CodecView, Line, RegisterView

_WORDS = {
    "alarms": "the alarm", "crcs": "the CRC", "layouts": "the layout", "order_code": "the order code", "parameters": "the parameter", "parts": "the part of the order code",
    "procedures": "the procedure", "registers": "the register", "timings": "the timing", "device": "the family",
}  # fmt: skip


@dataclass(frozen=True)
class Clash:
    """Two parts of a spec whose names are one in C. ``other`` is empty for what every header has."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """What is wrong and what would be right; ``where`` says where the other part is, as in `` on line 5``."""
        if not self.other:
            return f"something of it would be called {self.name} in C, and the headers have that name for something else; rename it"
        return f"something of it would be called {self.name} in C, and so would something of {called(self.other)}{where}; rename one of the two"


def called(path: Path) -> str:
    """A part of the spec in words."""
    kind = next((step for step in reversed(path) if step in _WORDS), path[0])
    return f"{_WORDS.get(str(kind), str(kind))} '{path[-1]}'" if path[-1] != kind else _WORDS.get(str(kind), str(kind))


class Names:
    """Gives out the names of one header. The first that asks for a name has it; every other one is noted as a clash."""

    def __init__(self) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[Clash] = []
        self._path: Path = ()

    @contextmanager
    def of(self, *path: str) -> Iterator[None]:
        """Names given out in here are those of this part of the spec."""
        before, self._path = self._path, path
        try:
            yield
        except TargetError as error:
            error.place = error.place or path
            raise
        finally:
            self._path = before

    def give(self, name: str) -> str:
        if name not in self.paths:
            self.paths[name] = self._path
        elif self._path:
            self.clashes.append(Clash(name, self._path, self.paths[name]))
        else:
            self.clashes.append(Clash(name, self.paths[name], ()))
        return name

    def give_codec(self, codec: CodecView) -> None:
        """The names of a struct and of the functions that go with it."""
        self.give(codec.name)
        for ending in ("decode", "encode", *(["bits"] if codec.carried_as == "bits" else []), *(["is_expected"] if codec.expected_checks else [])):
            self.give(f"{codec.name}_{ending}")
        for setter in codec.setters:
            self.give(setter.name)
        if codec.fold is not None:
            self.give(codec.fold.name)
        if codec.carried_as == "bytes" and codec.about:
            self.give(codec.length_macro)

    def give_limits(self, register: RegisterView) -> None:
        """The names of the limits of a register and of its meanings."""
        for limits in (register.limits, *(item.limits for item in register.meanings)):
            for macro in limits.macros:
                self.give(defined(macro))
            for function in limits.functions:
                self.give(function.name)


def defined(line: Line) -> str:
    """The name of the macro that a line defines."""
    return line.code.split()[1]


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """The names of members, arguments and locals, as C spells them, and the part of the spec that each comes from."""
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    places: list[tuple[Path, Layout]] = [(("interfaces", interface.kind, "layouts", layout.name), layout) for interface, layout in device.layouts()]
    places += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in places:
        yield from ((c_name(field.name), path) for field in layout.fields)
        yield from ((c_name(run.name), path) for field in layout.fields for run in field.digits)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(item.name), ("procedures", procedure.name)) for item in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, Names]], shared: Iterable[str]) -> Iterator[tuple[Device, Clash]]:
    """Every clash within these headers, with what all families share (``shared``), and between families."""
    taken: dict[str, Path] = dict.fromkeys(shared, ())
    for device, names in headers:
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in taken:
                yield device, Clash(name, path or ("device",), taken[name])
            taken[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in taken:
                yield device, Clash(name, path, ())
