"""Files next to the headers: README, files of build systems, and the pages with errata and for safety reviews."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Annotated, NamedTuple, TypedDict

from ...model import (
    Biss,
    Crc,
    Device,
    Erratum,
    Layout,
    Manufacturer,
    Spi,
    Ssi,
    Verdict,
    channel_frame,
    cite,
    first_or_raise,
    layer_in_words,
)
from ...model.record import dataclass
from ...plan.crcs import UndetectedErrors, crcs_and_lengths, undetected_errors_of
from ...plan.verdicts import reportings
from ...say.errata import STATUS_IN_WORDS, consequence, content_before_and_after, paths_in_words
from ...say.names_and_evidence import name_in_words
from .. import main_manufacturer, manufacturers
from .about import manual_title
from .comments import without_special_characters
from .crcs import CrcCode
from .device import DeviceView
from .examples import ExampleCode, ReceiverCode, example_codes, receiver_codes
from .names import FOLDER, c_name, errata_page_name
from .procedures import ProcedureCode
from .worked_examples import ShownProcedure, ShownRegister

ERRATA_TEMPLATE = "ERRATA.md.jinja"
Rows = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ErratumText:
    """An erratum of a manual, as text.

    ``standing`` is a sentence with its name, status and impact. Each row has a label and a text.
    """

    title: str
    standing: str
    rows: Rows


@dataclass(frozen=True)
class FamilyErrata:
    """The errata of a family, and the changes by each other edition of the manual and by each overlay on the spec."""

    title: str
    manual: str
    errata: tuple[ErratumText, ...]
    editions: tuple[tuple[str, tuple[Rows, ...]], ...]


class ErrataPage(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    families: Annotated[list[FamilyErrata], "the families with their errata"]


def errata_files(
    makers: Iterable[tuple[Manufacturer, Iterable[Device]]], render: Callable[[str, Mapping[str, object]], str]
) -> Iterator[tuple[str, str]]:
    """Yield the path in the C folder and the text of the page with the errata of each manufacturer."""
    for maker, devices in makers:
        values: ErrataPage = {"maker": maker, "families": [_family_errata(device) for device in devices]}
        yield errata_page_name(maker.name), render(ERRATA_TEMPLATE, values)


def _family_errata(device: Device) -> FamilyErrata:
    """Return the errata of the manual of a family, and separately the changes by other editions and overlays.

    ``editions`` contains the name of each edition or overlay with its changes, in the order of the errata.
    """
    errata_of_manual: list[ErratumText] = []
    changes_by_layer: dict[str, list[Rows]] = {}
    for erratum in device.errata:
        if erratum.overlay or erratum.edition:
            layer = layer_in_words(erratum.overlay, erratum.edition)
            labeled_texts = (*content_before_and_after(erratum), *_reason_and_source(erratum))
            changes_by_layer.setdefault(layer, []).append(labeled_texts)
        else:
            errata_of_manual.append(_erratum_text(erratum))
    return FamilyErrata(
        title=device.title,
        manual=manual_title(device),
        errata=tuple(errata_of_manual),
        editions=tuple((layer, tuple(changes)) for layer, changes in changes_by_layer.items()),
    )


def _erratum_text(erratum: Erratum) -> ErratumText:
    """Return the text of an erratum, without empty rows."""
    labeled_texts = (
        ("Affects", paths_in_words(", ".join(erratum.affects))),
        ("Printed", erratum.printed),
        ("Used", erratum.used),
        ("Only with", erratum.only),
    )
    rows = tuple((label, text) for label, text in labeled_texts if text)
    return ErratumText(
        title=erratum.title,
        standing=f"The erratum {erratum.name} is {STATUS_IN_WORDS[erratum.status]}. {consequence(erratum.severity)}.",
        rows=(*rows, *_reason_and_source(erratum)),
    )


def _reason_and_source(erratum: Erratum) -> Iterator[tuple[str, str]]:
    """Yield the rows ``Why`` and ``Source``, if they have content."""
    if erratum.why:
        yield "Why", erratum.why
    if erratum.source:
        yield "Source", cite(erratum.source)


TEMPLATE = "ASSUMPTIONS.md.jinja"


@dataclass(frozen=True)
class FramesWithCrc:
    """Frames of one length whose CRCs have the same polynomial, and the errors that the CRC does not detect in them."""

    crc: Crc
    names: tuple[str, ...]
    undetected_errors: UndetectedErrors


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
            for crc, bits in crcs_and_lengths(device, interface.name, layout):
                kind_of_frames = _KindOfFrames(crc.width, crc.poly, bits)
                crcs_by_kind.setdefault(kind_of_frames, {}).setdefault(name, crc)
    for kind_of_frames, crc_by_name in sorted(crcs_by_kind.items()):
        first_crc = next(iter(crc_by_name.values()))
        undetected_errors = undetected_errors_of(first_crc, kind_of_frames.bits)
        yield FramesWithCrc(crc=first_crc, names=tuple(crc_by_name), undetected_errors=undetected_errors)


def _frames_without_verdict(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the frames with a position whose verdict is always unknown: no flag or unused bit affects it."""
    for device in devices:
        for reporting in reportings(device).values():
            rules = reporting.verdict_rules
            if rules is not None and rules.default_verdict is Verdict.UNKNOWN and not rules.worst_first:
                yield _frame_name(device, interface=reporting.interface.title, layout=reporting.layout_plan.layout)


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
            may_lack_crc = not layout.always_has_crc
            if layout.has_parity and may_lack_crc and device.sends_position(interface.name, layout):
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
    views: Sequence[DeviceView], runtime_headers: Iterable[str], test_paths: Iterable[str], render: Render
) -> dict[str, str]:
    """Return the files of the package that all families share, such as the README, by their path in the C folder.

    ``runtime_headers`` and ``test_paths`` are files that other functions return, for lists of files in the package.
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
        "headers": [*_headers_of_families(views), *(f"{FOLDER}/{name}" for name in runtime_headers)],
        "runtime": list(runtime_headers),
        "examples": [program.name for program in programs],
        "tests": sorted(path for path in test_paths if path.endswith(".c")),
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
    return max(procedures, key=lambda procedure: procedure.step_count, default=None)


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
    shown_procedure: ShownProcedure | None
    #: The programs of the same family, one for each interface, the example first.
    programs_of_family: tuple[ExampleCode, ...]

    @property
    def over_biss(self) -> bool:
        """True if its registers are accessed by a BiSS master."""
        return isinstance(self.example.interface, Biss)

    @property
    def bits_macro(self) -> str:
        """The macro of the length of its frame in bits, for a receiver."""
        variant = self.example.code_row.variant
        sizes = (size for size in self.example.received_sizes if size.variant is variant)
        # The first of its two macros takes the bits, the second takes the bytes.
        frame_size = first_or_raise(sizes, f"frame received from {variant.code}")
        macros = self.example.view.frame_lengths.macros_of(frame_size)
        return first_or_raise(macros, f"macro for the length of the frames of {variant.code}").name

    @property
    def shown_number(self) -> str:
        """The name in the spec of the position, or else of the first number of the frame, or else ``no_data``."""
        plan = self.example.struct.layout_plan
        number_names = [joined_number.join.name for joined_number in plan.joined_numbers]
        number_names += [decoded_field.name for decoded_field in plan.decoded_fields]
        for name in number_names:
            if c_name(name) == self.example.position_member:
                return name
        return number_names[0] if number_names else "no_data"

    @property
    def member(self) -> str:
        """The member that holds this number."""
        return c_name(self.shown_number)

    @property
    def is_signed(self) -> bool:
        """True if this number can be negative."""
        return self.example.is_signed(self.member)

    @property
    def shown_value(self) -> object:
        """The value of this number in the example, or None if it has no value for it or a frame in bytes."""
        return self.example.frame.values.get(self.shown_number) if not self.example.frame_bytes else None


def choose_guide(examples: Sequence[ExampleCode]) -> Guide | None:
    """Return the program that the README shows, or None if there are no programs.

    It is a program from the family with the most programs, and among these the one whose procedure has the most steps.
    The README also shows its register with the most members, and its procedure unless that reads values.
    """
    if not examples:
        return None
    programs_by_family = Counter(program.view.device.name for program in examples)

    def preference(program: ExampleCode) -> tuple[int, int]:
        number_of_steps = program.shown_procedure.procedure_code.step_count if program.shown_procedure else 0
        return programs_by_family[program.view.device.name], number_of_steps

    example = max(examples, key=preference)
    family = example.view.device.name
    # A register that is one plain byte has no struct.
    registers_with_struct = [register for register in example.shown_registers if register.access.struct]
    only_writes = example.shown_procedure is not None and not example.shown_procedure.procedure_code.read_members
    example_first = sorted(examples, key=lambda program: program is not example)
    return Guide(
        example=example,
        shown_register=max(registers_with_struct, key=lambda register: register.members, default=None),
        shown_procedure=example.shown_procedure if only_writes else None,
        programs_of_family=tuple(program for program in example_first if program.view.device.name == family),
    )


def _version_numbers(version: str) -> tuple[int, ...]:
    """Return a version as numbers that can be compared, such as (1, 10, 0) for ``1.10.0``."""
    return tuple(map(int, version.split(".")))
