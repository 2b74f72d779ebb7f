"""Files next to the headers: files of build systems, the page for safety reviews, and receivers with DMA."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Annotated, NamedTuple, TypedDict

from ...model import (
    Biss,
    Crc,
    Device,
    Layout,
    Manufacturer,
    Spi,
    Ssi,
    Verdict,
    answer_combinations,
    channel_frame,
    first_or_raise,
)
from ...model.record import dataclass
from ...plan.crcs import UndetectedErrors, residual_of
from ...plan.verdicts import reportings
from ...say.names_and_evidence import name_in_words
from .. import main_manufacturer, manufacturers
from .comments import ascii_text
from .crc_code import CrcCode
from .device import DeviceView
from .examples import ExampleCode, ShownRegister, ShownRun, example_codes
from .names import FOLDER, c_name
from .procedures import ProcedureCode
from .variants import CodeRow

TEMPLATE = "ASSUMPTIONS.md.jinja"


@dataclass(frozen=True)
class FramesWithCrc:
    """Frames of one length whose CRCs have the same polynomial, and the errors that the CRC does not detect in them."""

    crc: Crc
    names: tuple[str, ...]
    residual: UndetectedErrors


class _KindOfFrames(NamedTuple):
    """Frames in which the CRC misses the same errors: of one length, with CRCs of one width and one polynomial."""

    crc_width: int
    polynomial: int
    bits: int


class Assumptions(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    frames: Annotated[list[FramesWithCrc], "the frames with a CRC, by CRC and length"]
    silent: Annotated[list[str], "the frames with a position whose verdict is always unknown"]
    unprotected: Annotated[list[str], "the SSI words with a position that have no CRC"]
    interfaces: Annotated[frozenset[str], "the interfaces of the encoders"]
    later: Annotated[bool, "whether an encoder over SPI answers with the next word"]
    parity: Annotated[list[str], "the frames with a position that have a parity bit and no CRC"]
    compared: Annotated[list[str], "the frames with several data channels whose positions are compared"]


def assumptions_files(
    makers: Iterable[tuple[Manufacturer, tuple[Device, ...]]], render: Callable[[str, Mapping[str, object]], str]
) -> Iterator[tuple[str, str]]:
    """Yield the path in the C folder and the text of each manufacturer's page with assumptions, for safety reviews."""
    for maker, devices in makers:
        interfaces = [interface for device in devices for interface in device.interfaces]
        values: Assumptions = {
            "maker": maker,
            "frames": list(_group_frames_by_crc(devices)),
            "silent": list(_frames_without_verdict(devices)),
            "unprotected": list(_yield_unprotected(devices)),
            "interfaces": frozenset(interface.name for interface in interfaces),
            "later": any(isinstance(interface, Spi) and interface.reply == "next_word" for interface in interfaces),
            "parity": list(_frames_with_parity(devices)),
            "compared": list(_frames_with_comparison(devices)),
        }
        yield f"ASSUMPTIONS-{maker.name}.md", render(TEMPLATE, values)


def _group_frames_by_crc(devices: tuple[Device, ...]) -> Iterator[FramesWithCrc]:
    """Yield the frames that have the same length and the same polynomial, with the errors that the CRC does not detect.

    They are in order of the width of the CRC, of its polynomial and of the length.
    """
    crcs_by_kind: dict[_KindOfFrames, dict[str, Crc]] = {}
    for device in devices:
        for interface, layout in device.layouts():
            name = _frame_name(device, interface=interface.title, layout=layout)
            for crc, bits in _crcs_and_lengths(device, interface.name, layout):
                kind_of_frames = _KindOfFrames(crc.width, crc.poly, bits)
                crcs_by_kind.setdefault(kind_of_frames, {}).setdefault(name, crc)
    for kind_of_frames, crc_by_name in sorted(crcs_by_kind.items()):
        first_crc = next(iter(crc_by_name.values()))
        undetected_errors = residual_of(first_crc, kind_of_frames.bits)
        yield FramesWithCrc(crc=first_crc, names=tuple(crc_by_name), residual=undetected_errors)


def _crcs_and_lengths(device: Device, interface: str, layout: Layout) -> Iterator[tuple[Crc, int]]:
    """Yield each CRC of a frame with each length in bits that the frame can have. A pair can come several times.

    The lengths are those for each order code and each answer to an open question. If all frames have the CRC, the
    longest frame that registers of the encoder can select is included.
    """
    if layout.always_has_crc:
        for crc in device.crcs_of(layout):
            yield crc, layout.widest
    for variant in device.variants_over(interface):
        for _, parameters_of_answers in answer_combinations(device.alternatives):
            placed = layout.place({**variant.parameters, **parameters_of_answers})
            placed_crc = device.crc_of(placed)
            if placed_crc is not None:
                yield placed_crc, placed.bits


def _frames_without_verdict(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with a position whose verdict is always unknown: no flag or unused bit affects it."""
    for device in devices:
        for reporting in reportings(device).values():
            rules = reporting.verdict_rules
            if rules is not None and rules.otherwise is Verdict.UNKNOWN and not rules.worst_first:
                yield _frame_name(device, interface=reporting.interface.title, layout=reporting.codec.layout)


def _yield_unprotected(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames over SSI with a position that have no CRC, at least with some order codes."""
    for device in devices:
        for interface, layout in device.layouts():
            has_position = device.sends_position(interface.name, layout)
            if isinstance(interface, Ssi) and has_position and not layout.always_has_crc:
                yield _frame_name(device, interface=interface.title, layout=layout) + _of_some_codes(layout)


def _frames_with_parity(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with a position that have a parity bit and, at least with some order codes, no CRC."""
    for device in devices:
        for interface, layout in device.layouts():
            has_only_parity = layout.has_parity and not layout.always_has_crc
            if has_only_parity and device.sends_position(interface.name, layout):
                yield _frame_name(device, interface=interface.title, layout=layout) + _of_some_codes(layout)


def _frames_with_comparison(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with several data channels whose positions must agree."""
    for device in devices:
        for interface in device.interfaces:
            frame = channel_frame(interface)
            if frame is not None and frame.compared:
                names = " and ".join(name_in_words(layout.name) for layout in frame.layouts)
                yield f"{device.name.upper()} {interface.title}: {names}"


def _of_some_codes(layout: Layout) -> str:
    """Return the remark that only some order codes have no CRC, or an empty string if this applies to all."""
    return " (some order codes)" if layout.crc_fields else ""


def _frame_name(device: Device, interface: str, layout: Layout) -> str:
    """Return the name of a frame on a page for all families, such as ``X BiSS: position``."""
    return f"{device.name.upper()} {interface}: {name_in_words(layout.name)}"


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
