"""The C target: headers to copy into a firmware tree, one for each family and one that the families of a manufacturer share.

The headers need C99 or C++11 and no library. Everything a template prints is prepared as text: names, numbers, expressions and conditions.

Names from a spec become C names as they are. A member whose name is reserved in C or C++ (up to C23 and C++23) or is a common macro takes
an underscore at its end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..markdown import text as markdown_text
from ..render import render
from . import Library, TargetError
from .c_device import DeviceView
from .c_source import c_name, code, comment, comment_lines, in_comment, noted, string


def generate(library: Library) -> dict[str, str]:
    """The headers and their README."""
    files = {}
    guides = {}
    for maker, devices in library.by_manufacturer():
        shared = {"maker": maker, "prefix": maker.name, "PREFIX": maker.name.upper()}
        files[f"c/include/{maker.name}/encoder.h"] = _render(library, "encoder.h.jinja", shared)
        for device in devices:
            if device.name == "encoder":
                raise TargetError("a family cannot be called 'encoder': that is the name of the header that all share")
            view = DeviceView(device)
            guides[device.name] = Guide(view)
            files[f"c/include/{maker.name}/{device.name}.h"] = _render(library, "device.h.jinja", {**shared, "d": view})
    files["c/README.md"] = _render(library, "README.md.jinja", {"guides": [guides[device.name] for device in library.devices]})
    return files


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    filters: dict[str, Callable[..., str]] = {"comment": comment, "comment_lines": comment_lines, "noted": noted, "code": code, "text": in_comment, "string": string, "md": lambda value: markdown_text(in_comment(value))}
    return render("c", template, values, filters=filters, own_templates=library.own_templates)


class Guide:
    """What the README says about a device: names that exist, so that its example compiles."""

    def __init__(self, view: DeviceView) -> None:
        device = self.device = view.device
        self.maker = device.manufacturer
        self.prefix, self.PREFIX = view.prefix, view.PREFIX
        self.title = device.title
        ordered = sorted(device.interfaces, key=lambda item: ("biss", "ssi", "rs485").index(item.kind))
        kind = ordered[0].kind
        pairs = [(row, variant) for row, variant in zip(view.codes, device.variants) if variant.interface == kind] or list(zip(view.codes, device.variants))
        chosen, _ = max(pairs, key=lambda pair: sum(pair[1].parameters.values()))
        self.macro, self.code = chosen[0], chosen[2]
        layout = ordered[0].layouts[0]
        self.layout = f"{self.prefix}_{layout.name}"
        self.carried_as = layout.carried_as
        self.length = f"{self.PREFIX}_{layout.name.upper()}_LENGTH"
        members = [join.name for join in layout.joins] or [field.name for field in layout.data_fields if field.name != layout.selector or len(layout.selects) > 1]
        self.member = c_name(members[0]) if members else "no_data"
