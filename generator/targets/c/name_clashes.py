"""The C names that the headers of a family declare, and parts of specs that would get the same name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...language.document import Path
from ...model import Device, Layout
from ...model.record import dataclass
from .names import TAKEN, DeclaredName, c_name

_SECTION_IN_WORDS = {
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


@dataclass(frozen=True)
class NameClash:
    """Two parts of a spec with the same name in C. The path ``other`` is empty if every header has the name."""

    name: str
    path: Path
    other: Path

    def message(self, where: str = "") -> str:
        """Return a message with the problem and its fix. ``where`` is the place of the other part: `` on line 5``."""
        if not self.other:
            return f"its C name {self.name} is already used by the headers; rename it"
        return f"its C name {self.name} is also that of {describe_path(self.other)}{where}; rename one of the two"


def describe_path(path: Path) -> str:
    """Return a part of the spec in words, such as ``the register 'status'`` for ``("registers", "status")``.

    The kind of the part is the last step of the path that has a word in ``_SECTION_IN_WORDS``, or else the first step.
    """
    kind = next((step for step in reversed(path) if step in _SECTION_IN_WORDS), path[0])
    kind_in_words = _SECTION_IN_WORDS.get(str(kind), str(kind))
    name = path[-1]
    # A path such as ("order_code",) has no name.
    return f"{kind_in_words} '{name}'" if name != kind else kind_in_words


class HeaderNames:
    """The names that one header declares at file scope, and the clashes between them.

    ``paths`` contains the part of the spec that each name comes from. It is the first part that declares the name. Any
    other part with the same name is a clash.
    """

    def __init__(self, declared: Iterable[DeclaredName]) -> None:
        self.paths: dict[str, Path] = {}
        self.clashes: list[NameClash] = []
        for name, path in declared:
            if name not in self.paths:
                self.paths[name] = path
            elif path:
                self.clashes.append(NameClash(name=name, path=path, other=self.paths[name]))
            else:
                # Every header declares this name, so the earlier part is the one to rename.
                self.clashes.append(NameClash(name=name, path=self.paths[name], other=()))


def inner_names(device: Device) -> Iterator[tuple[str, Path]]:
    """Yield the C names of members, arguments and local variables, each with the part of the spec that it comes from.

    A name can come several times, because each struct or function has its own scope.
    """
    for parameter in device.parameters:
        yield c_name(parameter.name), ("parameters", parameter.name)
    paths_and_layouts: list[tuple[Path, Layout]] = []
    for interface, layout in device.layouts():
        paths_and_layouts.append((("interfaces", interface.name, "layouts", layout.name), layout))
    paths_and_layouts += [(("registers", register.name), register.layout) for register in device.registers]
    for path, layout in paths_and_layouts:
        for field in layout.fields:
            yield c_name(field.name), path
            yield from ((c_name(run.name), path) for run in field.runs)
        yield from ((c_name(join.name), path) for join in layout.joins)
    for register in device.registers:
        yield c_name(register.name), ("registers", register.name)
    for procedure in device.procedures:
        yield from ((c_name(argument.name), ("procedures", procedure.name)) for argument in procedure.arguments)


def clashes(headers: Iterable[tuple[Device, HeaderNames]]) -> Iterator[tuple[Device, NameClash]]:
    """Yield every pair of parts of specs with the same C name, with the device in whose spec the second part is.

    Names at file scope must differ in all headers. The name of a member, argument or local must differ from those at
    file scope in its own and in earlier headers. The name of a manufacturer must not be one of ``TAKEN``.
    """
    declared_paths: dict[str, Path] = {}
    for device, names in headers:
        if device.manufacturer.name in TAKEN:
            yield device, NameClash(name=device.manufacturer.name, path=("manufacturer",), other=())
        for clash in names.clashes:
            yield device, clash
        for name, path in names.paths.items():
            if name in declared_paths:
                yield device, NameClash(name=name, path=path or ("device",), other=declared_paths[name])
            # For the families that follow, a name belongs to the family rather than to a part of it.
            declared_paths[name] = ("device", device.name)
        for name, path in inner_names(device):
            if name in declared_paths:
                yield device, NameClash(name=name, path=path, other=())
