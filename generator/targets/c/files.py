"""The files of the C target, and the filters and tests of its templates.

The headers need C99 or C++11 and no library. The templates contain the statements. Names, types and expressions are
built here.

Names from a spec become C names unchanged. A member whose name is reserved gets a trailing underscore. Reserved are the
keywords up to C23 and C++26, the types of the three included headers, and object-like macros of common compilers and
standard headers.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import chain
from typing import Annotated, NoReturn, TypedDict

from ...loading.samples import UnknownName, narrowed_to
from ...model import Device, Digits, Join, Manufacturer
from ...model.expressions import Expression
from ...plan import steps
from ...plan.limits import Refusal
from ...plan.operations import Check, JoinedNumber
from ...render import Templates, our_templates, tests_for
from ...say import text_on_one_line
from ...say.layout import describe_join as say_join
from ...say.names_and_evidence import addresses_text, name_in_words, title_of
from ...say.text import TITLE_STYLE
from ...say.text import escape as markdown_text
from .. import NO_OPTIONS, Library, Option, OptionError, Options, Target, TargetError, TargetProblem
from ..registry import licence_in
from .about import place_of_field
from .bits import ConstantByte, digits
from .comments import (
    break_lines,
    call_in_lines,
    comment,
    comment_lines,
    end_comment,
    in_comment,
    literals,
    mark_for_doxygen,
)
from .crcs import FoldOperation
from .decode import AllUnusedBits, FlagByte, UnusedBitsOfByte
from .device import DeviceView, HeaderPart, views_of
from .examples import ExampleCode, ReceiverCode, own_programs
from .expressions import BY_ADDRESS, BY_VALUE, StructPassing
from .header_text import needed_runtime, runtime_headers, runtime_version
from .names import FOLDER, c_name, c_number, clashes, describe_path, mask_constant, string, unsigned
from .package import (
    ERRATA_TEMPLATE,
    FILES,
    FOUND_BY_NAME,
    TEMPLATE,
    Assumptions,
    ErrataPage,
    Named,
    Package,
    assumptions_files,
    errata_files,
    package_files,
)
from .positions import Positions
from .procedures import FilledRows
from .selftest import AllTests, Expectation, FamilyTest, SelfTest, own_test, selftest_files
from .single import TEMPLATE as SINGLE_TEMPLATE
from .single import SingleHeader, single_header, single_path, single_views

#: Operations of the plan and further operations of this target.
TESTS = tests_for(
    *(Expression, Check, Refusal, JoinedNumber, steps.PlannedStep, steps.ArgumentRefusal),
    *(ConstantByte, FlagByte, UnusedBitsOfByte, AllUnusedBits, FoldOperation, FilledRows, Positions, Expectation),
)


def _format_hex(value: int, digits: int = 2) -> str:
    """Return a number as a hexadecimal constant with at least this many digits."""
    return c_number(value, hexadecimal=True, digits=digits)


def _refuse_operation(op: object) -> NoReturn:
    """Raise an error for an operation that a template does not handle."""
    raise AssertionError(f"no case for {op!r}")


def _format_markdown(text: object) -> str:
    """Return text of a spec as Markdown."""
    return markdown_text(in_comment(text))


def _digits_type(digit_run: Digits) -> str:
    """Return the type that holds a run of decimal digits."""
    return unsigned((digit_run.modulus - 1).bit_length())


def _fields_of_join(join: Join) -> str:
    """Return a sentence on which fields form a number (a join)."""
    return TITLE_STYLE.sentence(say_join(join))


def _count_bytes(count: int) -> str:
    """Return a number of bytes as text."""
    return f"{count} byte{'s' if count > 1 else ''}"


FILTERS: dict[str, Callable[..., object]] = {
    "addresses": addresses_text,
    "end_comment": end_comment,
    "bytes": _count_bytes,
    "c_name": c_name,
    "comment": comment,
    "comment_lines": comment_lines,
    "digits_of": digits,
    "digits_type": _digits_type,
    "hex": _format_hex,
    "in_lines": call_in_lines,
    "in_words": name_in_words,
    "literals": literals,
    "mask": mask_constant,
    "md": _format_markdown,
    "never": _refuse_operation,
    "number": c_number,
    "made_of": _fields_of_join,
    "place": place_of_field,
    "string": string,
    "text": in_comment,
    "title": title_of,
    "type": unsigned,
}


ONLY = Option(
    "only",
    "order codes, families and interfaces (biss, FAMILY_biss) to generate, separated by commas (empty for all)",
    "",
)

PASSING = Option(
    "passing",
    "how order codes and words are passed to functions: by value, or by address for SDCC (writes only C headers)",
    "value",
    ("value", "address"),
)


FORM = Option(
    "form",
    "package: one header per interface, with build files; single: one header per order code, only to decode positions",
    "package",
    ("package", "single"),
)


class Shared(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    PREFIX: Annotated[str, "the prefix of its macros"]


class Family(Shared):
    d: Annotated[DeviceView, "one interface of a family and the parts of its headers, their names and expressions"]


class FamilyHeader(Family):
    runtime: Annotated[tuple[int, int], "the major version of the runtime that it needs, and the lowest minor version"]


class PartHeader(Family):
    further: Annotated[HeaderPart, "the header that the template generates, such as that of the registers"]


class Receiver(Family):
    e: Annotated[ReceiverCode, "the program that extracts positions from raw buffers"]


class Program(Family):
    e: Annotated[ExampleCode, "the program for one interface of the family"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the headers, their README, example programs, self-tests and package files, by path.

    With the form ``single``, these are only the headers for order codes. If order codes are passed by address, they are
    only the headers and the license.

    Raises:
        OptionError: The option ``only`` has an unknown name.
        TargetError: C cannot express something, or two parts of specs have the same C name.
    """
    files: dict[str, str] = {}
    try:
        devices = narrowed_to(library.devices, options.get(ONLY.name, ""))
    except UnknownName as error:
        raise OptionError(f"c.{ONLY.name}: {error}") from None
    passing = _choose_passing(options)
    for device in devices:
        files |= library.files_of(_yield_family_files, device, options)
    if options.get(FORM.name) == "single":
        return files
    views = [view for device in devices for view in views_of(device, passing)]
    # The first clash ends the function.
    for device, clash in clashes((view.device, view.names) for view in views):
        raise TargetError(f"{device.name}: {describe_path(clash.path)}: {clash.message()}")
    if views:
        runtime = runtime_headers()
        if options.get(ONLY.name):
            runtime = needed_runtime(chain.from_iterable(view.runtime_headers for view in views))
        files |= {f"c/include/{FOLDER}/{name}": text for name, text in runtime.items()} | licence_in("c")
        if not passing.by_address:
            shared_files = _shared_files(library, devices, views, runtime)
            files |= {f"c/{path}": text for path, text in shared_files.items()}
    return files


def _shared_files(
    library: Library, devices: Sequence[Device], views: Sequence[DeviceView], runtime: Iterable[str]
) -> dict[str, str]:
    """Return the self-tests, the package files and the pages that all families share, by their path in the C folder."""

    def render(template: str, template_values: Mapping[str, object]) -> str:
        return _render_template(library, template, template_values)

    self_tests = [self_test for self_test in map(SelfTest, views) if self_test.checks]
    files = selftest_files(views, self_tests, render)
    test_paths = [*files, *(self_test.path for self_test in self_tests)]
    files |= package_files(views, runtime, test_paths, render)
    makers = Library(tuple(devices)).by_manufacturer()
    files |= dict(assumptions_files(makers, render))
    files |= dict(errata_files(makers, render))
    return files


def _choose_passing(options: Options) -> StructPassing:
    """Return how functions receive order codes, by value or by address, as the options say."""
    return BY_ADDRESS if options.get(PASSING.name) == "address" else BY_VALUE


def _yield_family_files(device: Device, library: Library, options: Options) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of each header, self-test and example program of a family, and a function that returns its text.

    With the form ``single``, these are only the headers for order codes. If order codes are passed by address, they are
    only the headers for C.
    """

    def render_later(template: str, template_values: Mapping[str, object]) -> Callable[[], str]:
        return partial(_render_template, library, template, template_values)

    passing = _choose_passing(options)
    if options.get(FORM.name) == "single":
        yield from _single_headers(device, library, passing)
        return
    for view in views_of(device, passing):
        for path, text_function in _yield_headers(library, view):
            yield f"c/include/{path}", text_function
        if passing.by_address:
            continue
        yield f"c/include/{view.cpp_header}", render_later("device.hpp.jinja", _template_values(view))
        for path, text_function in own_test(view, render_later):
            yield f"c/{path}", text_function
        for path, text_function in own_programs(view, render_later):
            yield f"c/{path}", text_function


def problems(library: Library) -> Iterator[TargetProblem]:
    """Yield the first part of each spec that C cannot express, and every C name that two parts of specs share."""
    headers = []
    for device in library.devices:
        try:
            headers += [(device, view.names) for view in views_of(device)]
        except TargetError as error:
            problem = f"{error}; use 'generate --target' to write the other outputs"
            yield TargetProblem(device, rule="c-target", place=error.place or ("device",), message=problem)
    for device, clash in clashes(headers):
        # A clash with another family cannot be located in this spec.
        other_place = () if clash.other[:1] == ("device",) else clash.other
        message = clash.message(" on line {line}" if other_place else "")
        yield TargetProblem(device, rule="c-name", place=clash.path, message=message, other=other_place)


def _yield_headers(library: Library, view: DeviceView) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the include path of each header of an interface, and a function that returns its text."""
    values = _template_values(view)
    values_with_runtime = values | {"runtime": runtime_version()}
    yield view.header, partial(_render_template, library, "device.h.jinja", values_with_runtime)
    for header_part in view.parts:
        values_with_part = values | {"further": header_part}
        text_function = partial(_render_template, library, "part.h.jinja", values_with_part)
        yield f"{view.maker.name}/{header_part.file}", text_function


def _single_headers(
    device: Device, library: Library, passing: StructPassing
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of the header of each order code, and a function that returns its text."""

    def render_single(view: DeviceView) -> str:
        text_functions = dict(_yield_headers(library, view))
        # The texts of the other headers are not needed.
        header = text_functions[view.header]()
        return single_header(view, partial(_render_template, library), header)

    for view in single_views(device, passing):
        order_code = view.device.variants[0].code
        yield f"c/{single_path(view.maker, order_code)}", partial(render_single, view)


def _template_values(view: DeviceView) -> Family:
    """Return the values of the templates for one interface of a family."""
    return {"maker": view.maker, "PREFIX": view.maker.name.upper(), "d": view}


def _render_template(library: Library, template: str, template_values: Mapping[str, object]) -> str:
    """Render a template. In C files, long lines are broken, and in headers, comments get the marks of Doxygen."""
    text = TEMPLATES.render(template, template_values, library.own_templates)
    if template.endswith((".h.jinja", ".hpp.jinja")):
        return mark_for_doxygen(break_lines(text))
    return break_lines(text) if template.endswith((".c.jinja", ".ino.jinja")) else text


def _format_json(value: object) -> str:
    """Return text of a spec as a JSON string."""
    return json.dumps(text_on_one_line(value))


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
        SINGLE_TEMPLATE: SingleHeader,
        TEMPLATE: Assumptions,
        ERRATA_TEMPLATE: ErrataPage,
        **dict.fromkeys(FILES.values(), Package),
        **dict.fromkeys(FOUND_BY_NAME.values(), Named),
    },
    filters=FILTERS,
    tests=TESTS,
    functions={"json": _format_json},
)
TARGET = Target(
    name="c",
    summary="headers for C99 and C++11, packaged for CMake, pkg-config, PlatformIO, Arduino and Zephyr",
    files=generate,
    problems=problems,
    options=(ONLY, PASSING, FORM),
    templates=TEMPLATES,
    family=_yield_family_files,
)
