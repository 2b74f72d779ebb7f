"""The C target: headers to copy into a firmware tree, one for each family and one that the families of a manufacturer share.

The headers need C99 or C++11 and no library. Everything a template prints is prepared as text: names, numbers, expressions and conditions.

Names from a spec become C names as they are. A member whose name is reserved has an underscore at its end: the words of C to C23 and C++ to
C++26, the types of the three headers, and macros without arguments of common compilers and standard headers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from ..markdown import text as markdown_text
from ..model import Device, Manufacturer
from ..render import render
from . import Library, TargetError, TargetProblem, has_biss
from .c_device import DeviceView
from .c_names import called, clashes
from .c_package import package_files
from .c_source import code, comment, comment_lines, in_comment, noted, string


def generate(library: Library) -> dict[str, str]:
    """The headers, their README, and what makes a package of them."""
    files: dict[str, str] = {}
    views: dict[str, DeviceView] = {}
    for maker, devices in library.by_manufacturer():
        shared = _shared(library, maker, devices)
        files |= {f"c/include/{maker.name}/{name}": text for name, text in shared.items()}
        for device in devices:
            if device.name in ("biss", "encoder"):
                raise TargetError(f"a family cannot be called '{device.name}': that is the name of a header that all share")
            views[device.name] = view = DeviceView(device)
            files[f"c/include/{maker.name}/{device.name}.h"] = _render(library, "device.h.jinja", {**_names_of(maker), "d": view})
        for device, clash in clashes(((item, views[item.name].names) for item in devices), _declared(maker, shared.values())):
            raise TargetError(f"{device.name}: {called(clash.path)}: {clash.message()}")
    if library.devices:
        package = package_files(library.by_manufacturer(), views, lambda template, values: _render(library, template, values))
        files |= {f"c/{path}": text for path, text in package.items()}
        files["c/MISRA.md"] = _render(library, "MISRA.md.jinja", {})
    return files


def problems(library: Library) -> Iterator[TargetProblem]:
    """What C cannot express, the first of each device; and where two parts of a spec, or of two, have one name in C."""
    for maker, devices in library.by_manufacturer():
        headers = []
        for device in devices:
            try:
                headers.append((device, DeviceView(device).names))
            except TargetError as error:
                said = f"{error}; 'generate --target' writes the other outputs"
                yield TargetProblem(device, "c-target", error.place or ("device",), _same(said))
        for device, clash in clashes(headers, _declared(maker, _shared(library, maker, devices).values())):
            other = () if clash.other[:1] == ("device",) else clash.other
            yield TargetProblem(device, "c-name", clash.path, clash.message, other)


def _same(text: str) -> Callable[[str], str]:
    """A message that speaks of one place only."""
    return lambda _: text


def _names_of(maker: Manufacturer) -> dict[str, object]:
    return {"maker": maker, "prefix": maker.name, "PREFIX": maker.name.upper()}


def _shared(library: Library, maker: Manufacturer, devices: Sequence[Device]) -> dict[str, str]:
    """The headers that the families of a manufacturer share, by name."""
    names = ("encoder.h", "biss.h") if has_biss(devices) else ("encoder.h",)
    return {name: _render(library, f"{name}.jinja", _names_of(maker)) for name in names}


def _declared(maker: Manufacturer, headers: Iterable[str]) -> set[str]:
    """Whatever begins with the prefix in the code of these headers."""
    code_alone = re.sub(r"/\*.*?\*/", " ", "\n".join(headers), flags=re.DOTALL)
    return set(re.findall(rf"\b(?:{maker.name}|{maker.name.upper()})_\w+", code_alone))


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    filters: dict[str, Callable[..., str]] = {"comment": comment, "comment_lines": comment_lines, "noted": noted, "code": code, "text": in_comment, "string": string, "md": lambda value: markdown_text(in_comment(value))}
    return render("c", template, values, filters=filters, own_templates=library.own_templates)
