"""The values printed by the templates for one interface of a family, and the CRCs of its frames."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from functools import cached_property, partial
from typing import Protocol, TypeVar

from ...model import Biss, Device, Document, Layout, Parameter, Procedure, Register, Rs485, Spi, Ssi, first_or_raise
from ...model.order_codes import repeated_names
from ...model.record import dataclass
from ...order_codes.reduction import for_codes
from ...plan.crcs import crc_functions
from ...plan.frames import held_parameters
from ...plan.values import TwosComplement
from ...say.errata import describe_erratum, errata_affecting
from ...say.names_and_evidence import (
    describe_grade,
    describe_removals,
    differences_from_manual,
    other_editions,
    titled_in_lists,
)
from ...say.order_code import words_for_initial_values
from .. import TargetError
from .about import manual_title
from .code_facts import CodeFacts, timing_macros
from .codec import StructCodec, crc_code
from .comments import HEADER_STYLE, Paragraph
from .context import HeaderContext
from .crcs import CrcCode
from .expressions import BY_VALUE, StructPassing
from .header_text import runtime_version
from .interfaces import InterfaceCode, ReplyRequest
from .names import FOLDER, CMacro, DeclaredName, HeaderNames, c_name, errata_page_name
from .positions import RangeFunctions, ReadCode, channel_code, positions
from .procedures import ProcedureCode
from .registers import RegisterCode, identity_codes, state_registers
from .reports import AlarmCode, Reports
from .variants import LengthCode, VariantCode, VariantUpdater
from .worked_examples import choose_variant

_Built = TypeVar("_Built")


class _Declaring(Protocol):
    def declared(self) -> Iterator[DeclaredName]: ...


@dataclass(frozen=True, slots=True)
class Usage:
    """The names in the example at the top of the header, which reads a position.

    ``frame`` is the frame with the position, ``verdict`` the function that returns its verdict, and ``member`` the
    member with the position. ``request`` is the macro that requests the frame, or else ``request_for_reply`` is the
    frame that does. ``reads_twice`` is True if no CRC protects the frame, so that two frames must agree.
    """

    frame: StructCodec
    verdict_function: str
    member: str
    request_macro: str
    request_for_reply: ReplyRequest | None
    reads_twice: bool


@dataclass(frozen=True, slots=True)
class HeaderPart:
    """A further header of an interface, which only some users need. ``includes`` lists the headers that it includes."""

    name: str
    file: str
    about: str
    includes: tuple[str, ...]


def _common_timing_macros(device: Device, prefix: str) -> Iterator[CMacro]:
    """Yield the macros for times that are the same for all order codes."""
    repeated_times = repeated_names(device.timings)
    for timing in device.timings:
        if timing.name not in repeated_times:
            yield from timing_macros(timing, prefix)


class DeviceView:
    """One interface of a family: the parts of its headers, each built from the previous parts.

    ``device`` contains only this interface, and only its order codes.
    """

    def __init__(self, device: Device, passing: StructPassing = BY_VALUE) -> None:
        self.device = device
        self.context = context = HeaderContext(device, passing)
        self.parameter = passing.parameter
        self.argument = passing.argument
        self.member = passing.member
        self.maker = context.maker
        self.prefix = context.prefix
        self.PREFIX = context.PREFIX
        self.stem = context.stem
        self.reports = Reports(device, self.prefix, context.enumeration_by_field, context.translator)
        self.alternatives = context.alternatives
        self.variants = VariantCode(context)
        self.interface = _with_path_in_errors(
            partial(InterfaceCode, context, context.interface, self.reports), "interfaces", context.interface.name
        )
        #: The order code in all samples.
        self.code_row = self.variants.rows[device.variants.index(choose_variant(device, context.interface))]
        self.frame_lengths = LengthCode(context, context.interface, self.variants.rows, self.code_row)
        self.code_facts = CodeFacts(context, context.interface, self.variants.rows)
        self.channels = channel_code(context, self.interface.codecs)
        self.positions = positions(context)
        self.registers = [self._build_register(register) for register in _bank_selectors_first(device)]
        self.crcs = list(self._crc_codes())
        register_code_by_name = {code.register.name: code for code in self.registers}
        self.variant_updaters = [
            VariantUpdater(context, group, register_code_by_name[group.register.name].access)
            for group in held_parameters(device)
        ]
        usage = self.usage
        frame_to_read = usage.frame if usage is not None else None
        reads_twice = usage is not None and usage.reads_twice
        self.position_reader = ReadCode(context, frame_to_read, self.frame_lengths, reads_twice=reads_twice)
        self.initial_values_text = words_for_initial_values(device)
        self.read_state = f"{self.prefix}_read_state" if state_registers(device) else ""
        self.identities = list(identity_codes(context, register_code_by_name))
        self.procedures = [self._build_procedure(procedure, register_code_by_name) for procedure in device.procedures]
        self.alarms = [AlarmCode(context, alarm) for alarm in device.alarms]
        #: The macros for times that are the same for all order codes.
        self.timings = list(_common_timing_macros(device, self.PREFIX))

    def _crc_codes(self) -> Iterator[CrcCode]:
        """Yield the CRCs of which frames or registers use the function or the table."""
        codecs = list(self.interface.codecs)
        codecs += [register.codec for register in self.registers if register.codec is not None]
        for function in crc_functions(self.device):
            crc = crc_code(self.context, function, codecs)
            if crc.is_called or crc.table:
                yield crc

    @property
    def variant(self) -> str:
        """The declaration of the parameter for an order code."""
        return self.parameter(self.prefix, "variant")

    def _build_register(self, register: Register) -> RegisterCode:
        """Return the code of a register. An error gets the path of the register."""
        return _with_path_in_errors(partial(RegisterCode, self.context, register), "registers", register.name)

    def _build_procedure(self, procedure: Procedure, codes: Mapping[str, RegisterCode]) -> ProcedureCode:
        """Return the code of a procedure. An error gets the path of the procedure. ``codes`` are the registers."""
        build = partial(ProcedureCode, self.context, codes, self.read_state, procedure)
        return _with_path_in_errors(build, "procedures", procedure.name)

    @property
    def order_code_kind(self) -> str:
        """The name of its order codes in a sentence, which says whether they are on a label."""
        return "made-up order code" if self.device.order_code.not_on_label else "order code from the label"

    @property
    def header(self) -> str:
        """Include path of the header for reading positions."""
        return f"{self.maker.name}/{self.stem}.h"

    @property
    def parts(self) -> list[HeaderPart]:
        """The further headers. Each includes the first header, and the other headers that it needs."""
        first_header = self.header
        encoder_header = "codewheel/encoder.h"
        transport_header = "codewheel/transport.h"
        label_headers = (f"{self.maker.name}/{self.stem}_labels.h",) if self.identities else ()
        registers_header = f"{self.maker.name}/{self.stem}_registers.h" if self.registers else first_header
        has_texts = bool(self.reports.all_reports or self.alarms or self.timings)
        build = self._build_part
        about_labels = "find the order code that a label shows"
        parts = [build("labels", about=about_labels, includes=(encoder_header, first_header))]
        if has_texts:
            about_texts = "strings that describe reports, alarms and times"
            parts.append(build("reports", about=about_texts, includes=(encoder_header, first_header)))
        if self.registers:
            about_registers = "registers, and identification of encoders"
            register_includes = (encoder_header, transport_header, first_header, *label_headers)
            parts.append(build("registers", about=about_registers, includes=register_includes))
        if self.procedures:
            about_procedures = "procedures, step by step"
            parts.append(build("procedures", about=about_procedures, includes=(transport_header, registers_header)))
        about_simulator = "the encoder's side, for simulators and tests"
        parts.append(build("simulate", about=about_simulator, includes=(first_header,)))
        return parts

    def _build_part(self, name: str, *, about: str, includes: tuple[str, ...]) -> HeaderPart:
        """Return a further header, such as ``x_biss_labels.h`` for the name ``labels``."""
        return HeaderPart(name=name, file=f"{self.stem}_{name}.h", about=about, includes=includes)

    @property
    def headers(self) -> list[str]:
        """Include paths of all headers of the interface."""
        return [self.header, *(f"{self.maker.name}/{part.file}" for part in self.parts)]

    @property
    def runtime_headers(self) -> Iterator[str]:
        """The headers of the runtime that the headers of the interface include, or that users need with them.

        Users need a receiver for its frames, and helpers for its registers and procedures. A header can come twice.
        """
        interface = self.context.interface
        for part in self.parts:
            yield from (name.removeprefix(f"{FOLDER}/") for name in part.includes if name.startswith(f"{FOLDER}/"))
        if self.frame_lengths.macros:
            yield "receive_frame.h" if self.frame_lengths.length_macro else "receive.h"
        if self.channels is not None:
            yield "channels.h"
        if isinstance(interface, Spi):
            yield "spi.h"
        if isinstance(interface, Rs485):
            yield "receive.h"
        if isinstance(interface, Biss) and self.registers:
            yield "biss_slave.h"
        if self.procedures:
            yield "runner.h"

    @property
    def cpp_header(self) -> str:
        """The header for C++17."""
        return f"{self.header}pp"

    @property
    def namespace(self) -> str:
        """The namespace of the functions for C++17."""
        return f"{c_name(self.maker.name)}::{c_name(self.stem)}"

    @cached_property
    def names(self) -> HeaderNames:
        """All names in the headers, and the clashes between them."""
        return HeaderNames(self._yield_declared())

    def _yield_declared(self) -> Iterator[DeclaredName]:
        """Yield all names in the headers, each with the part of the spec that it comes from."""
        yield f"{self.PREFIX}_H", ()
        yield f"{self.PREFIX}_HPP", ()
        for part in self.parts:
            yield f"{self.PREFIX}_{part.name}_H".upper(), ()
        yield f"{self.PREFIX}_VERSION", ()
        if self.read_state:
            yield self.read_state, ()
        declaring_parts: list[_Declaring] = [self.variants, *self.context.enumerations.all_enumerations, *self.crcs]
        declaring_parts += [self.reports, *self.alternatives, self.interface, self.frame_lengths]
        declaring_parts += [self.code_facts, self.position_reader]
        if self.channels is not None:
            declaring_parts.append(self.channels)
        if self.positions is not None:
            declaring_parts.append(self.positions)
        declaring_parts += [*self.registers, *self.variant_updaters, *self.identities, *self.procedures, *self.alarms]
        for declaring_part in declaring_parts:
            yield from declaring_part.declared()
        for macro in self.timings:
            yield macro.name, ("timings",)

    @property
    def position_member(self) -> str:
        """The field or join with the position, in the only frame of the interface.

        It is empty if there are several frames, or if the only one has no position or no verdict.
        """
        codecs = self.interface.codecs
        return codecs[0].position_member if len(codecs) == 1 else ""

    @property
    def manual(self) -> str:
        """The title, revision, date and language of the manual."""
        return manual_title(self.device)

    @property
    def errata_page(self) -> str:
        """The file with the errata in full."""
        return errata_page_name(self.maker.name)

    @property
    def title_in_lists(self) -> str:
        """Title of the family, with its grade if that is the lowest."""
        return titled_in_lists(self.device)

    @property
    def version_and_hash(self) -> str:
        """The version of the runtime, and the name and the hash of the spec from which the headers are generated."""
        major, minor = runtime_version()
        device = self.device
        return f"Runtime {major}.{minor}. Spec {device.name}, content hash {device.content_hash}."

    @property
    def evidence(self) -> list[Paragraph]:
        """The sentence on how well the spec is supported by documents (its grade)."""
        return [HEADER_STYLE.sentence(describe_grade(self.device))]

    @property
    def origin(self) -> list[Paragraph]:
        """The sentences on where the spec comes from and how it differs from the manual. Most families have none."""
        where = f"in {self.errata_page}"
        statements = (
            *differences_from_manual(self.device),
            *other_editions(self.device, where),
            *describe_removals(self.device),
        )
        return [HEADER_STYLE.sentence(statement) for statement in statements]

    def documents(self, text: str) -> list[Paragraph]:
        """Return a line with title and address for each document other than the manual that ``text`` cites."""
        cited_documents = (document for document in self.device.documents if _has_source_with_key(text, document.key))
        return [(f"  {document.key}: ", _title_and_url(document)) for document in cited_documents]

    @property
    def takes_spi_words(self) -> bool:
        """True if the bytes that SPI receives are the word itself, so that no start bit must be found."""
        return any(codec.receiver == "cw_spi_load" for codec in self.interface.codecs)

    @property
    def received_codec(self) -> StructCodec:
        """The first frame whose length has macros in the header.

        Raises:
            LookupError: There is no such frame.
        """
        codecs = (
            codec for codec in self.interface.codecs if codec.struct.layout.name in self.frame_lengths.layout_names
        )
        return first_or_raise(codecs, f"frame received over {self.context.interface.title}")

    def modulus(self, encoder: str, layout: Layout | None = None) -> str:
        """Return the call of the function for the counts after which the position wraps around.

        The result is ``0U`` if the position of the frame never wraps around. ``encoder`` is the argument for the order
        code. Without a frame, the result is for the first range of positions that wraps around.
        """
        ranges = self.positions.ranges if self.positions is not None else ()
        if layout is not None:
            ranges = tuple(functions for functions in ranges if _is_range_of(functions, layout))
        for functions in ranges:
            if not functions.never_wraps:
                return f"{self.prefix}_{functions.frame_in_names}modulus({encoder})"
        return "0U"

    @property
    def usage(self) -> Usage | None:
        """The example at the top of the header, or None if there is no frame for it.

        It reads the first frame from the encoder that has the position and a verdict.
        """
        position_name = self.device.position_name(self.context.interface.name)
        for codec in self.interface.codecs:
            layout = codec.struct.layout
            verdict = codec.reports.verdict_function if codec.reports is not None else ""
            if verdict and position_name in layout.member_names and layout.sender == "encoder":
                return Usage(
                    frame=codec,
                    verdict_function=verdict,
                    member=c_name(position_name),
                    request_macro=self.interface.request_of(layout),
                    request_for_reply=self.interface.request_for_reply(layout),
                    reads_twice=self._is_read_twice(codec, position_name),
                )
        return None

    def _is_read_twice(self, codec: StructCodec, position_name: str) -> bool:
        """Return True if a position over SSI must be read twice, because no CRC protects it.

        Two words can be compared only if the position is never negative.
        """
        is_over_ssi = isinstance(self.context.interface, Ssi)
        has_crc = codec.layout_plan.crc_of_all_order_codes is not None
        if not codec.position_member or not is_over_ssi or has_crc:
            return False
        fields = [field for field in codec.layout_plan.decoded_fields if field.name == position_name]
        return not any(isinstance(field.meaning, TwosComplement) for field in fields)

    def errata(self, *paths: str) -> list[Paragraph]:
        """Return a sentence for each erratum that affects one of these parts of the spec."""
        return [
            HEADER_STYLE.sentence(describe_erratum(correction)) for correction in errata_affecting(self.device, *paths)
        ]


def _bank_selectors_first(device: Device) -> list[Register]:
    """Return the registers. Those that select a bank come first, since functions for other registers use them."""
    selector_names = {device.bank_selector(register) for register in device.registers}
    return sorted(device.registers, key=lambda register: register.name not in selector_names)


def _has_source_with_key(text: str, key: str) -> bool:
    """Return True if a text cites a source such as ``data sheet: page 4`` with this key."""
    # The first test is much faster, and few documents pass it.
    return f"{key}:" in text and re.search(rf"\b{key}:", text) is not None


def _title_and_url(document: Document) -> str:
    """Return the title of a document, with its address if it has one."""
    return f"{document.title} - {document.url}" if document.url else document.title


def _is_range_of(functions: RangeFunctions, layout: Layout) -> bool:
    """Return True if these functions are for the positions in a frame."""
    return any(candidate.name == layout.name for candidate in functions.layouts)


def views_of(device: Device, passing: StructPassing = BY_VALUE) -> Sequence[DeviceView]:
    """Return the view of each interface of a family, in the order of the spec. The last families are cached.

    Raises:
        TargetError: C cannot express an interface.
    """
    for known_device, known_passing, known_views in _LATEST_VIEW:
        if known_device is device and known_passing == passing:
            return known_views
    views = tuple(_views_of(device, passing))
    _LATEST_VIEW.append((device, passing, views))
    return views


#: Families are compared by identity, because comparing their members takes longer than building their views.
_LATEST_VIEW: deque[tuple[Device, StructPassing, Sequence[DeviceView]]] = deque(maxlen=8)


def _views_of(device: Device, passing: StructPassing) -> Iterator[DeviceView]:
    """Yield the view of each interface, with only its own order codes, registers and parameters."""
    for interface in device.interfaces:
        codes = {variant.code for variant in device.variants_over(interface.name)}
        narrowed_device = for_codes(device, codes)
        known_registers = {"", *(register.name for register in narrowed_device.registers)}
        parameters = (_with_known_register(parameter, known_registers) for parameter in narrowed_device.parameters)
        yield DeviceView(replace(narrowed_device, parameters=tuple(parameters)), passing)


def _with_known_register(parameter: Parameter, known_registers: Set[str]) -> Parameter:
    """Return a parameter without the register that it is read from, if this interface cannot access that register.

    ``known_registers`` are the registers of this interface, and the empty name of a parameter without a register.
    """
    return parameter if parameter.register in known_registers else replace(parameter, read_from="")


def _with_path_in_errors(build: Callable[[], _Built], *path: str) -> _Built:
    """Return the result of ``build``. A ``TargetError`` without a path gets this path in the spec."""
    try:
        return build()
    except TargetError as error:
        error.place = error.place or path
        raise
