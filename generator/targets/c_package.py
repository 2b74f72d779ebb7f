"""What makes the C folder a package by itself: for CMake, pkg-config, PlatformIO and Zephyr, and the programs that show its use."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from ..model import Device, Manufacturer
from ..render import plain
from . import has_biss
from .c_device import DeviceView
from .c_example import ExampleView, ReadView, RunView, examples
from .c_source import ascii_text, c_name
from .c_views import CrcView

#: Each file beside headers and programs, and its template; ``{package}`` is the package's name. Placed so that the folder is itself laid out as it is installed.
FILES = {
    "README.md": "README.md.jinja",
    "CMakeLists.txt": "CMakeLists.txt.jinja",
    "share/cmake/{package}/{package}-config.cmake": "config.cmake.jinja",
    "share/cmake/{package}/{package}-config-version.cmake": "config-version.cmake.jinja",
    "share/pkgconfig/{package}.pc": "pkgconfig.pc.jinja",
    "library.json": "library.json.jinja",
    "zephyr/module.yml": "zephyr_module.yml.jinja",
    "zephyr/CMakeLists.txt": "zephyr_CMakeLists.txt.jinja",
    "zephyr/Kconfig": "zephyr_Kconfig.jinja",
}

Render = Callable[[str, Mapping[str, object]], str]


def package_files(makers: Sequence[tuple[Manufacturer, tuple[Device, ...]]], views: Mapping[str, DeviceView], render: Render) -> dict[str, str]:
    """The files of the package beside the headers, by their path in the C folder."""
    programs = {maker.name: [(views[device.name], item) for device in devices for item in examples(views[device.name])] for maker, devices in makers}
    names = [maker.name for maker, _ in makers]
    package = "-".join((*names, "encoders"))
    values: dict[str, object] = {
        "package": package,
        "namespace": "-".join(names),
        "option": package.replace("-", "_").upper(),
        "version": max((maker.version for maker, _ in makers), key=_order),
        "title": bare(f"Headers for encoders by {' and '.join(maker.title for maker, _ in makers)}"),
        "json": lambda value: json.dumps(plain(value)),
        "guide": guide(programs),
        "makers": [maker for maker, _ in makers],
        "with_biss": [maker.name for maker, devices in makers if has_biss(devices)],
        "devices": [device for _, devices in makers for device in devices],
        "with_tables": _with_crcs(makers, views, lambda crc: crc.style == "fold" and bool(crc.table)),
        "with_bitwise": _with_crcs(makers, views, lambda crc: bool(crc.step)),
        "longest": max((item for view in views.values() for item in view.procedures if item.parameters), key=lambda item: item.count, default=None),
        "examples": [item.name for found in programs.values() for _, item in found],
    }
    files = {path.format(package=package): render(template, values) for path, template in FILES.items()}
    for maker, _ in makers:
        for view, item in programs[maker.name]:
            files[f"examples/{item.name}.c"] = render("example.c.jinja", {"maker": maker, "prefix": maker.name, "PREFIX": maker.name.upper(), "d": view, "e": item})
    return files


def _with_crcs(makers: Sequence[tuple[Manufacturer, tuple[Device, ...]]], views: Mapping[str, DeviceView], wanted: Callable[[CrcView], bool]) -> list[str]:
    """The manufacturers, in capitals, some of whose CRCs are such ones."""
    return [maker.name.upper() for maker, devices in makers if any(wanted(crc) for device in devices for crc in views[device.name].crcs)]


@dataclass(frozen=True)
class Guide:
    """What the README shows: names that exist, so that its code compiles."""

    example: ExampleView
    reads: ReadView | None
    runs: RunView | None
    device: Device
    maker: Manufacturer
    prefix: str
    layout: str
    carried_as: str
    member: str
    spoiled: str


def guide(programs: Mapping[str, Sequence[tuple[DeviceView, ExampleView]]]) -> Guide | None:
    """The family with the most interfaces, by the program whose procedure has the most steps."""
    found = [item for each in programs.values() for item in each]
    if not found:
        return None
    view, example = max(found, key=lambda item: (len(item[0].device.interfaces), item[1].run.procedure.count if item[1].run is not None else 0))
    layout = view.device.layout(example.frame.layout)
    members = [join.name for join in layout.joins] or [field.name for field in layout.data_fields if field.name != layout.selector or len(layout.selects) > 1]
    whole = [item for item in example.reads if item.access.struct]
    return Guide(
        example=example,
        reads=max(whole, key=lambda item: len(item.shown), default=None),
        runs=example.run if example.run is not None and not example.run.procedure.read_type else None,
        device=view.device,
        maker=view.maker,
        prefix=view.prefix,
        layout=example.frame.struct,
        carried_as=example.frame.carried_as,
        member=c_name(members[0]) if members else "no_data",
        spoiled=" || ".join(f"frame.{c_name(field.name)}" for field in layout.spoiling_flags),
    )


def _order(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split(".")))


def bare(text: str) -> str:
    """``text`` with nothing in it that CMake, Kconfig or pkg-config would take for its own."""
    return " ".join(re.sub(r"[^A-Za-z0-9 .,:/+&-]+", " ", ascii_text(text)).split())
