"""The C target: headers for firmware, one for each family, and the runtime that they include.

The headers need C99 or C++11 and no library. The templates have their statements. Names, types and expressions are
built here.

Names from a spec become C names unchanged. A member whose name is reserved gets a trailing underscore. Reserved are the
keywords up to C23 and C++26, the types of the three included headers, and object-like macros of common compilers and
standard headers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Annotated, TypedDict

from ...model import Manufacturer
from ...render import Templates, our_templates
from ...say.lines import plain
from .. import NO_OPTIONS, Library, Options, Target, TargetError, TargetProblem
from ..licence import licence_in
from .assumptions import TEMPLATE, Assumptions, assumptions_files
from .device import DeviceView
from .examples import ExampleCode
from .filters import FILTERS, TESTS
from .lines import documented, laid_out
from .names import called, clashes
from .package import FILES, Package, package_files
from .receivers import ReceiverCode
from .runtime import FOLDER, runtime_headers, runtime_version
from .selftest import AllTests, FamilyTest, selftest_files


class Shared(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    PREFIX: Annotated[str, "the prefix of its macros"]


class FamilyHeader(Shared):
    d: Annotated[DeviceView, "the family and the parts of its header, their names and expressions"]
    runtime: Annotated[tuple[int, int], "the major version of the runtime that it needs, and the lowest minor version"]


class Family(Shared):
    d: Annotated[DeviceView, "the family and the parts of its header, their names and expressions"]


class Receiver(Family):
    e: Annotated[ReceiverCode, "the program that extracts positions from raw buffers"]


class Program(Family):
    e: Annotated[ExampleCode, "the program for one interface of the family"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the headers, their README, examples, self-test and package files, by path."""
    files: dict[str, str] = {}
    views: dict[str, DeviceView] = {}
    for maker, devices in library.by_manufacturer():
        for device in devices:
            views[device.name] = DeviceView(device)
            files[f"c/include/{maker.name}/{device.name}.h"] = _family(library, views[device.name])
        for device, clash in clashes((item, views[item.name].names) for item in devices):
            raise TargetError(f"{device.name}: {called(clash.path)}: {clash.message()}")
    if library.devices:
        makers = library.by_manufacturer()

        def rendered(template: str, values: Mapping[str, object]) -> str:
            return _render(library, template, values)

        tests = selftest_files(makers, views, rendered)
        package = package_files(makers, views, tests, rendered)
        package |= dict(assumptions_files(library, rendered))
        files |= {f"c/{path}": text for path, text in (package | tests).items()} | licence_in("c")
        files |= {f"c/include/{FOLDER}/{name}": text for name, text in runtime_headers().items()}
    return files


def problems(library: Library) -> Iterator[TargetProblem]:
    """Yield the first item in each device that C cannot express, and every C name that two parts of specs share."""
    for _, devices in library.by_manufacturer():
        headers = []
        for device in devices:
            try:
                headers.append((device, DeviceView(device).names))
            except TargetError as error:
                said = f"{error}; use 'generate --target' to write the other outputs"
                yield TargetProblem(device, "c-target", error.place or ("device",), said)
        for device, clash in clashes(headers):
            other = () if clash.other[:1] == ("device",) else clash.other
            message = clash.message(" on line {line}" if other else "")
            yield TargetProblem(device, "c-name", clash.path, message, other)


def _family(library: Library, view: DeviceView) -> str:
    """Return the header of a family."""
    maker = view.maker
    values: FamilyHeader = {
        "maker": maker,
        "PREFIX": maker.name.upper(),
        "d": view,
        "runtime": runtime_version(),
    }
    return _render(library, "device.h.jinja", values)


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    text = TEMPLATES.render(template, values, library.own_templates)
    if template.endswith(".h.jinja"):
        return documented(laid_out(text))
    return laid_out(text) if template.endswith(".c.jinja") else text


def _json(value: object) -> str:
    """Return text of a spec as a JSON string."""
    return json.dumps(plain(value))


TEMPLATES = Templates(
    our_templates("c"),
    values={
        "device.h.jinja": FamilyHeader,
        "example.c.jinja": Program,
        "poller.c.jinja": Program,
        "receiver.c.jinja": Receiver,
        "selftest.c.jinja": FamilyTest,
        "selftest_all.c.jinja": AllTests,
        "selftest.h.jinja": AllTests,
        TEMPLATE: Assumptions,
        **dict.fromkeys(FILES.values(), Package),
    },
    filters=FILTERS,
    tests=TESTS,
    functions={"json": _json},
)
TARGET = Target(
    name="c",
    summary="headers for C99 and C++11, packaged for CMake, pkg-config, PlatformIO and Zephyr",
    files=generate,
    problems=problems,
    templates=TEMPLATES,
)
