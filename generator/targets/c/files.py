"""The C target: headers for firmware, some for each interface of a family, and the runtime that they include.

The headers need C99 or C++11 and no library. The templates contain the statements. Names, types and expressions are
built here.

Names from a spec become C names unchanged. A member whose name is reserved gets a trailing underscore. Reserved are the
keywords up to C23 and C++26, the types of the three included headers, and object-like macros of common compilers and
standard headers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Annotated, TypedDict

from ...loading.named import UnknownName, narrowed_to
from ...model import Device, Manufacturer
from ...render import Templates, our_templates
from ...say.plain_text import plain
from .. import NO_OPTIONS, Library, Option, OptionError, Options, Target, TargetError, TargetProblem
from ..shared_files import licence_in
from .assumptions import TEMPLATE, Assumptions, assumptions_files
from .device import DeviceView, Part, views_of
from .examples import ExampleCode
from .filters import FILTERS, TESTS
from .lines import break_lines, documented
from .names import called, clashes
from .package import FILES, FOUND_BY_NAME, Named, Package, own_programs, package_files
from .receivers import ReceiverCode
from .runtime import FOLDER, runtime_headers, runtime_version
from .selftest import AllTests, FamilyTest, SelfTest, own_test, selftest_files

ONLY = Option(
    "only",
    "order codes, interfaces (biss, FAMILY_biss) and families to generate, separated by commas; empty for all",
    "",
)


class Shared(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    PREFIX: Annotated[str, "the prefix of its macros"]


class Family(Shared):
    d: Annotated[DeviceView, "one interface of a family and the parts of its headers, their names and expressions"]


class FamilyHeader(Family):
    runtime: Annotated[tuple[int, int], "the major version of the runtime that it needs, and the lowest minor version"]


class PartHeader(Family):
    further: Annotated[Part, "the header that the template generates, such as that of the registers"]


class Receiver(Family):
    e: Annotated[ReceiverCode, "the program that extracts positions from raw buffers"]


class Program(Family):
    e: Annotated[ExampleCode, "the program for one interface of the family"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the headers, their README, examples, self-test and package files, by path."""
    files: dict[str, str] = {}
    try:
        devices = narrowed_to(library.devices, options.get(ONLY.name, ""))
    except UnknownName as error:
        raise OptionError(f"c.{ONLY.name}: {error}") from None
    for device in devices:
        files |= library.part(_family, device, options)
    views = [view for device in devices for view in views_of(device)]
    for device, clash in clashes((view.device, view.names) for view in views):
        raise TargetError(f"{device.name}: {called(clash.path)}: {clash.message()}")
    if views:

        def rendered(template: str, values: Mapping[str, object]) -> str:
            return _render(library, template, values)

        tests = [test for test in map(SelfTest, views) if test.checks]
        shared = selftest_files(views, tests, rendered)
        shared |= package_files(views, [*shared, *(test.path for test in tests)], rendered)
        shared |= dict(assumptions_files(library, rendered))
        files |= {f"c/{path}": text for path, text in shared.items()} | licence_in("c")
        files |= {f"c/include/{FOLDER}/{name}": text for name, text in runtime_headers().items()}
    return files


def _family(device: Device, library: Library, options: Options) -> dict[str, str]:
    """Return the headers of a family, its self-tests and its example programs, by path."""
    files: dict[str, str] = {}
    for view in views_of(device):

        def rendered(template: str, values: Mapping[str, object]) -> str:
            return _render(library, template, values)

        files |= {f"c/include/{path}": text for path, text in _headers(library, view)}
        files |= {f"c/{path}": text for path, text in own_test(view, rendered)}
        files |= {f"c/{path}": text for path, text in own_programs(view, rendered)}
    return files


def problems(library: Library) -> Iterator[TargetProblem]:
    """Yield the first item in each device that C cannot express, and every C name that two parts of specs share."""
    headers = []
    for device in library.devices:
        try:
            headers += [(device, view.names) for view in views_of(device)]
        except TargetError as error:
            problem = f"{error}; use 'generate --target' to write the other outputs"
            yield TargetProblem(device, "c-target", error.place or ("device",), problem)
    for device, clash in clashes(headers):
        other_place = () if clash.other[:1] == ("device",) else clash.other
        message = clash.message(" on line {line}" if other_place else "")
        yield TargetProblem(device, "c-name", clash.path, message, other_place)


def _headers(library: Library, view: DeviceView) -> Iterator[tuple[str, str]]:
    """Yield the headers of an interface, by their include paths."""
    values: Family = {"maker": view.maker, "PREFIX": view.maker.name.upper(), "d": view}
    yield view.header, _render(library, "device.h.jinja", values | {"runtime": runtime_version()})
    yield view.cpp_header, _render(library, "device.hpp.jinja", values)
    for part in view.parts:
        yield f"{view.maker.name}/{part.file}", _render(library, "part.h.jinja", values | {"further": part})


def _render(library: Library, template: str, values: Mapping[str, object]) -> str:
    text = TEMPLATES.render(template, values, library.own_templates)
    if template.endswith((".h.jinja", ".hpp.jinja")):
        return documented(break_lines(text))
    return break_lines(text) if template.endswith((".c.jinja", ".ino.jinja")) else text


def _json(value: object) -> str:
    """Return text of a spec as a JSON string."""
    return json.dumps(plain(value))


TEMPLATES = Templates(
    our_templates("c"),
    values={
        "device.h.jinja": FamilyHeader,
        "device.hpp.jinja": Family,
        "part.h.jinja": PartHeader,
        "example.c.jinja": Program,
        "poller.c.jinja": Program,
        "receiver.c.jinja": Receiver,
        "sketch.ino.jinja": Receiver,
        "selftest.c.jinja": FamilyTest,
        "selftest_all.c.jinja": AllTests,
        "selftest.h.jinja": AllTests,
        TEMPLATE: Assumptions,
        **dict.fromkeys(FILES.values(), Package),
        **dict.fromkeys(FOUND_BY_NAME.values(), Named),
    },
    filters=FILTERS,
    tests=TESTS,
    functions={"json": _json},
)
TARGET = Target(
    name="c",
    summary="headers for C99 and C++11, packaged for CMake, pkg-config, PlatformIO, Arduino and Zephyr",
    files=generate,
    problems=problems,
    options=(ONLY,),
    templates=TEMPLATES,
    family=_family,
)
