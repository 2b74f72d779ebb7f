"""Files next to the headers: files of build systems, the page for safety reviews, and receivers with DMA."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Annotated, TypedDict

from ...model import (
    Biss,
    Manufacturer,
    first_or_raise,
)
from ...model.record import dataclass
from .. import main_manufacturer, manufacturers
from .comments import ascii_text
from .crcs import CrcCode
from .device import DeviceView
from .examples import ExampleCode, ShownRegister, ShownRun, example_codes
from .names import FOLDER, c_name
from .procedures import ProcedureCode
from .variants import CodeRow


class ReceiverCode:
    """The values for the template of a program that receives frames by DMA.

    The program is for the order code with the longest frame.
    """

    def __init__(self, example: ExampleCode) -> None:
        view = example.view
        self.view = view
        self.example = example
        self.name = f"{view.stem}_dma"
        self.sketch = f"{view.stem}_arduino"
        self.struct = example.struct
        self.verdict = example.reports.verdict if example.reports is not None else ""
        self.member = example.counts
        self.is_signed = example.is_signed(example.counts)
        #: The size of the longest frame. The program is for its order code.
        self.longest = max(example.received, key=lambda frame: frame.bits)
        variant = self.longest.variant
        rows = (row for row in view.variants.rows if row.variant is variant)
        self.row: CodeRow = first_or_raise(rows, f"row for {variant.code}")
        #: The macros of the bits in a frame and of the bytes in its buffer.
        self.bits, self.size = (macro.name for macro in view.lengths.macros_of(self.longest))
        reading = view.reading
        #: The call that reads the position from the buffer.
        self.read = f"{reading.macro}({reading.arguments_of(self.row.code)}, rx, &position)"
        self.position_type = reading.frame.struct.member_type(reading.frame.position_member) if reading.frame else ""
        self.modulus = view.modulus(self.row.macro, example.frame.layout)


def receiver_codes(examples: Iterable[ExampleCode]) -> Iterator[ReceiverCode]:
    """Yield a program that receives by DMA for each example over BiSS with one frame, whose position has a verdict."""
    for example in examples:
        has_verdict = example.reports is not None and bool(example.reports.verdict)
        has_position = bool(example.counts) and example.position is not None
        has_one_frame = len(example.view.lengths.layouts) == 1
        if isinstance(example.interface, Biss) and has_verdict and has_position and has_one_frame:
            yield ReceiverCode(example)


#: The other files of the folder, and their templates. The folder has the layout of an installation.
FILES = {
    "README.md": "README.md.jinja",
    "MISRA.md": "MISRA.md.jinja",
    "CMakeLists.txt": "CMakeLists.txt.jinja",
    "library.json": "library.json.jinja",
    "library.properties": "library.properties.jinja",
    "zephyr/module.yml": "zephyr_module.yml.jinja",
    "zephyr/CMakeLists.txt": "zephyr_CMakeLists.txt.jinja",
    "zephyr/Kconfig": "zephyr_Kconfig.jinja",
}
#: The files by which a build finds the headers under the name ``{package}``, and their templates.
FOUND_BY_NAME = {
    "share/cmake/{package}/{package}-config.cmake": "config.cmake.jinja",
    "share/cmake/{package}/{package}-config-version.cmake": "config-version.cmake.jinja",
    "share/pkgconfig/{package}.pc": "pkgconfig.pc.jinja",
}

Render = Callable[[str, Mapping[str, object]], str]


class Named(TypedDict):
    package: Annotated[str, "the name of the package, for example acme-encoders"]
    namespace: Annotated[str, "the namespace of its CMake targets, for example acme"]
    option: Annotated[str, "the name of the package in uppercase, for settings"]
    version: Annotated[str, "its version"]
    title: Annotated[str, "its description in one line of plain ASCII"]


class Package(Named):
    makers: Annotated[list[str], "the names of the manufacturers, which prefix the functions of their self-tests"]
    others: Annotated[list[str], "further namespaces under which the same headers are found"]
    guide: Annotated[Guide | None, "the family and program that the README shows"]
    families: Annotated[list[str], "the names of the families"]
    views: Annotated[Sequence[DeviceView], "the interfaces of the families"]
    with_tables: Annotated[list[str], "the uppercase names of manufacturers with a CRC that can use a table"]
    with_bitwise: Annotated[list[str], "the uppercase names of manufacturers with a CRC that can do without a table"]
    longest: Annotated[ProcedureCode | None, "the procedure with parameters that has the most steps"]
    headers: Annotated[list[str], "all headers, as they are included"]
    runtime: Annotated[list[str], "the file names of the headers of the runtime"]
    examples: Annotated[list[str], "the names of the programs"]
    tests: Annotated[list[str], "the C files of the self-test, keyed by their path within the folder"]


def package_files(
    views: Sequence[DeviceView], runtime: Iterable[str], tests: Iterable[str], render: Render
) -> dict[str, str]:
    """Return the files of the package that all families share, such as the README, by their path in the C folder.

    ``runtime`` and ``tests`` are the paths of files that other functions return, for lists of files in the package.
    """
    examples = [example for view in views for example in example_codes(view)]
    programs: list[ExampleCode | ReceiverCode] = [*examples, *receiver_codes(examples)]
    makers = manufacturers(view.device for view in views)
    main = main_manufacturer(makers)
    maker_names = [maker.name for maker in makers]
    names_of_package = _package_names(main.name if main else "-".join(maker_names), makers)
    values: Package = {
        **names_of_package,
        "makers": maker_names,
        "others": [maker.name for maker in makers if maker is not main],
        "guide": choose_guide(examples),
        "families": list(dict.fromkeys(view.device.name for view in views)),
        "views": views,
        "with_tables": _makers_with_crc(views, lambda crc: not crc.can_be_bitwise and bool(crc.table)),
        "with_bitwise": _makers_with_crc(views, lambda crc: crc.can_be_bitwise),
        "longest": _longest_procedure(views),
        "headers": [*_headers_of_families(views), *(f"{FOLDER}/{name}" for name in runtime)],
        "runtime": list(runtime),
        "examples": [program.name for program in programs],
        "tests": sorted(path for path in tests if path.endswith(".c")),
    }
    files = {path: render(template, values) for path, template in FILES.items()}
    # A build finds the headers under the name of each manufacturer, and under a common name.
    names_to_find = [_package_names(maker.name, [maker]) for maker in makers]
    if main is None:
        names_to_find.append(names_of_package)
    for package_names in names_to_find:
        for path, template in FOUND_BY_NAME.items():
            files[path.format(package=package_names["package"])] = render(template, package_names)
    return files


def _longest_procedure(views: Iterable[DeviceView]) -> ProcedureCode | None:
    """Return the procedure with arguments that has the most steps, or None if no procedure has arguments."""
    procedures: list[ProcedureCode] = []
    for view in views:
        procedures += [procedure for procedure in view.procedures if procedure.arguments]
    return max(procedures, key=lambda procedure: procedure.count, default=None)


def _headers_of_families(views: Iterable[DeviceView]) -> list[str]:
    """Return the include paths of the headers of all interfaces."""
    headers: list[str] = []
    for view in views:
        headers += [*view.headers, view.cpp_header]
    return headers


def _package_names(namespace: str, makers: Sequence[Manufacturer]) -> Named:
    """Return the names of a package with the headers of these manufacturers, such as ``acme-encoders`` for ``acme``.

    The version of the package is the highest version of a manufacturer.
    """
    package = f"{namespace}-encoders"
    titles = " and ".join(maker.title for maker in makers)
    return {
        "package": package,
        "namespace": namespace,
        "option": package.replace("-", "_").upper(),
        "version": max((maker.version for maker in makers), key=_version_numbers),
        "title": without_special_characters(f"Headers for encoders by {titles}"),
    }


def own_programs(
    view: DeviceView, render_later: Callable[[str, Mapping[str, object]], Callable[[], str]]
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path in the C folder of each example program of an interface, and a function that returns its text.

    ``render_later`` takes a template and its values, and returns such a function.
    """
    maker = view.maker
    examples = list(example_codes(view))
    programs: list[ExampleCode | ReceiverCode] = [*examples, *receiver_codes(examples)]
    for program in programs:
        values = {"maker": maker, "PREFIX": maker.name.upper(), "d": view, "e": program}
        yield f"examples/{program.name}.c", render_later(_program_template(program), values)
        if isinstance(program, ReceiverCode):
            yield f"examples/{program.sketch}/{program.sketch}.ino", render_later("sketch.ino.jinja", values)


def _program_template(program: ExampleCode | ReceiverCode) -> str:
    """Return the template of a program: a receiver with DMA, a main loop that polls, or a list of worked examples."""
    if isinstance(program, ReceiverCode):
        return "receiver.c.jinja"
    return "poller.c.jinja" if program.can_poll else "example.c.jinja"


def _makers_with_crc(views: Iterable[DeviceView], is_wanted: Callable[[CrcCode], bool]) -> list[str]:
    """Return the uppercase names of the manufacturers with a CRC for which ``is_wanted`` is true, sorted."""
    views_with_crc = (view for view in views if any(map(is_wanted, view.crcs)))
    return sorted({view.maker.name.upper() for view in views_with_crc})


@dataclass(frozen=True)
class Guide:
    """The example program that the README shows, with a register to read and a procedure to carry out, or None.

    All names in it exist, so the code compiles.
    """

    example: ExampleCode
    shown_register: ShownRegister | None
    shown_run: ShownRun | None
    #: The programs of the same family, one for each interface, the example first.
    programs_of_family: tuple[ExampleCode, ...]

    @property
    def over_biss(self) -> bool:
        """True if its registers are accessed by a BiSS master."""
        return isinstance(self.example.interface, Biss)

    @property
    def bits(self) -> str:
        """The macro of the length of its frame in bits, for a receiver."""
        variant = self.example.row.variant
        frames = (frame for frame in self.example.received if frame.variant is variant)
        # The first of its two macros takes the bits, the second takes the bytes.
        macros = self.example.view.lengths.macros_of(first_or_raise(frames, f"frame received from {variant.code}"))
        return first_or_raise(macros, f"macro for the length of the frames of {variant.code}").name

    @property
    def number(self) -> str:
        """The name in the spec of the position, or else of the first number of the frame, or else ``no_data``."""
        plan = self.example.struct.plan
        number_names = [joined_number.join.name for joined_number in plan.joined_numbers]
        number_names += [part.field.name for part in plan.parts]
        for name in number_names:
            if c_name(name) == self.example.counts:
                return name
        return number_names[0] if number_names else "no_data"

    @property
    def member(self) -> str:
        """The member that holds this number."""
        return c_name(self.number)

    @property
    def is_signed(self) -> bool:
        """True if this number can be negative."""
        return self.example.is_signed(self.member)

    @property
    def result(self) -> object:
        """The value of this number in the example, or None if it has no value for it or a frame in bytes."""
        return self.example.frame.values.get(self.number) if not self.example.data else None


def choose_guide(examples: Sequence[ExampleCode]) -> Guide | None:
    """Return the program that the README shows, or None if there are no programs.

    It is a program from the family with the most programs, and among these the one whose procedure has the most steps.
    The README also shows its register with the most members, and its procedure unless that reads values.
    """
    if not examples:
        return None
    programs_by_family = Counter(program.view.device.name for program in examples)

    def preference(program: ExampleCode) -> tuple[int, int]:
        number_of_steps = program.run.code.count if program.run else 0
        return programs_by_family[program.view.device.name], number_of_steps

    example = max(examples, key=preference)
    family = example.view.device.name
    # A register that is one plain byte has no struct.
    registers_with_struct = [register for register in example.reads if register.access.struct]
    only_writes = example.run is not None and not example.run.code.reads
    example_first = sorted(examples, key=lambda program: program is not example)
    return Guide(
        example=example,
        shown_register=max(registers_with_struct, key=lambda register: register.members, default=None),
        shown_run=example.run if only_writes else None,
        programs_of_family=tuple(program for program in example_first if program.view.device.name == family),
    )


def _version_numbers(version: str) -> tuple[int, ...]:
    """Return a version as numbers that can be compared, such as (1, 10, 0) for ``1.10.0``."""
    return tuple(map(int, version.split(".")))


def without_special_characters(text: str) -> str:
    """Return ``text`` with single spaces in place of all characters special to CMake, Kconfig or pkg-config."""
    plain_text = re.sub(r"[^A-Za-z0-9 .,:/+&-]+", " ", ascii_text(text))
    return " ".join(plain_text.split())
