"""The names that a header declares at file scope, the parts of the spec that they come from, and clashes of names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...language.problems import Path
from ...model import Device, Layout
from ...model.record import dataclass
from .reserved import c_name
from .runtime import TAKEN

_WORDS = {
    "alarms": "the alarm",
    "alternatives": "the alternative",
    "crcs": "the CRC",
    "device": "the family",
    "layouts": "the layout",
    "order_code": "the order code",
    "parameters": "the parameter",
    "parts": "the part of the order code",
    "procedures": "the procedure",
    "registers": "the register",
    "timings": "the timing",
}


#: A name at file scope, and the part of the spec that it comes from, empty for names that every header has.
#: Each part of a header lists its names in ``declared()``.
Declared = tuple[str, Path]


@dataclass(frozen=True)
class Clash:
    """Two parts of a spec with the same name in C. ``other`` is empty for names that every header has."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return the problem and its fix. ``where`` gives the place of the other part, as in `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {called(self.other)}{where}; rename one of the two"


def called(path: Path) -> str:
    """Describe a part of the spec in words."""
    kind = next((step for step in reversed(path) if step in _WORDS), path[0])
    return f"{_WORDS.get(str(kind), str(kind))} '{path[-1]}'" if path[-1] != kind else _WORDS.get(str(kind), str(kind))


class Names:
    """The names of one header. A name belongs to the first part that declares it. Any other part is a clash."""

    def __init__(self, declared: Iterable[Declared]) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[Clash] = []
        for name, path in declared:
            if name not in self.paths:
                self.paths[name] = path
            elif path:
                self.clashes.append(Clash(name, path, self.paths[name]))
            else:
                self.clashes.append(Clash(name, self.paths[name], ()))


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and locals, and the part of the spec that each comes from."""
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    places: list[tuple[Path, Layout]] = []
    for interface, layout in device.layouts():
        places.append((("interfaces", interface.name, "layouts", layout.name), layout))
    places += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in places:
        yield from ((c_name(field.name), path) for field in layout.fields)
        yield from ((c_name(run.name), path) for field in layout.fields for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(argument.name), ("procedures", procedure.name)) for argument in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, Names]]) -> Iterator[tuple[Device, Clash]]:
    """Yield every clash within these headers, and between families."""
    declared_paths: dict[str, Path] = {}
    for device, names in headers:
        if device.manufacturer.name in TAKEN:
            yield device, Clash(device.manufacturer.name, ("manufacturer",), ())
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in declared_paths:
                yield device, Clash(name, path or ("device",), declared_paths[name])
            declared_paths[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in declared_paths:
                yield device, Clash(name, path, ())
