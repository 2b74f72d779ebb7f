"""The C target: headers to copy into a firmware tree, one for each family and one that the families of a manufacturer share.

The headers need C99 or C++11 and no library. Everything a template prints is prepared as text: names, numbers, expressions and conditions.

Names from a spec become C names as they are. A member whose name is reserved in C or C++ (up to C23 and C++23) or is a common macro takes
an underscore at its end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..markdown import text as markdown_text
from ..render import render
from . import Library, TargetError, has_biss
from .c_device import DeviceView
from .c_package import package_files
from .c_source import code, comment, comment_lines, in_comment, noted, string


def generate(library: Library) -> dict[str, str]:
    """The headers, their README, and what makes a package of them."""
    files = {}
    views: dict[str, DeviceView] = {}
    for maker, devices in library.by_manufacturer():
        shared = {"maker": maker, "prefix": maker.name, "PREFIX": maker.name.upper()}
        files[f"c/include/{maker.name}/encoder.h"] = _render(library, "encoder.h.jinja", shared)
        if has_biss(devices):
            files[f"c/include/{maker.name}/biss.h"] = _render(library, "biss.h.jinja", shared)
        for device in devices:
            if device.name in ("biss", "encoder"):
                raise TargetError(f"a family cannot be called '{device.name}': that is the name of a header that all share")
            views[device.name] = view = DeviceView(device)
            files[f"c/include/{maker.name}/{device.name}.h"] = _render(library, "device.h.jinja", {**shared, "d": view})
    if library.devices:
        package = package_files(library.by_manufacturer(), views, lambda template, values: _render(library, template, values))
        files |= {f"c/{path}": text for path, text in package.items()}
        files["c/MISRA.md"] = _render(library, "MISRA.md.jinja", {})
    return files


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    filters: dict[str, Callable[..., str]] = {"comment": comment, "comment_lines": comment_lines, "noted": noted, "code": code, "text": in_comment, "string": string, "md": lambda value: markdown_text(in_comment(value))}
    return render("c", template, values, filters=filters, own_templates=library.own_templates)
