"""The struct of a frame or register in C with its decoder and encoder, and the CRC functions that they call."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from ...model import Biss, ChannelFrame, Field, Spi, Ssi, channel_frame
from ...model.expressions import Expression
from ...plan.crcs import CoveredData, CrcFunction, CrcMethod, byte_table, covered_data_of, word_table
from ...plan.limits import OutsideLimits, depends_on_order_code
from ...plan.operations import FrameCrc
from .about import about_bits_crc, about_crc, about_member, about_unused, about_word_crc
from .comments import Paragraph
from .context import AlternativeCode, HeaderContext, alternatives_in
from .crcs import BitsCrc, CrcCode, WordCrc, fold_operations
from .decode import CDecoder
from .encode import CEncoder
from .expressions import CExpression, CName, CNumber, COperation, join_operands
from .names import DeclaredName, c_name, c_number, string, unsigned
from .reports import Reports
from .structs import LayoutStruct, covers_32_bits


class StructCodec:
    """The values that the templates print for the struct of a frame or register, its decoder and its encoder.

    ``about`` is the comment on a frame, and is empty for a register. The encoder of a register makes ``limit_checks``.
    ``family_reports`` are the reports of the family, and None for a register.
    """

    def __init__(
        self,
        struct: LayoutStruct,
        about: Sequence[Paragraph] = (),
        limit_checks: Sequence[OutsideLimits] = (),
        family_reports: Reports | None = None,
    ) -> None:
        self.struct = struct
        self.layout_plan = struct.layout_plan
        self.translator = struct.translator
        self.name = struct.name
        self.type = struct.type
        self.length_macro = struct.length_macro
        self.about = tuple(about)
        self.decoder = CDecoder(struct)
        self.encoder = CEncoder(struct, limit_checks)
        questions_of_layout = self.layout_plan.alternatives
        #: The open questions on which the layout depends.
        self.alternatives = tuple(
            question for question in struct.context.alternatives if question.spec_question in questions_of_layout
        )
        #: Whether a program that reads an encoder decodes the struct, and encodes it. A simulator does the opposite.
        self.decodes = struct.register is not None or struct.layout.sender == "encoder"
        self.encodes = struct.register is not None or not self.decodes
        #: The reports of a frame, None for a register.
        self.reports = None
        if family_reports is not None:
            self.reports = family_reports.of(struct.layout, self.name, self.type)

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names at file scope, each with the path of the layout in the spec."""
        for name in self._yield_names():
            yield name, self.struct.path

    def _yield_names(self) -> Iterator[str]:
        """Yield the names of the type, its functions and its macros."""
        yield self.type
        yield f"{self.name}_decode"
        yield f"{self.name}_encode"
        if not self.layout_plan.in_bytes:
            yield f"{self.name}_bits"
        elif self.about:
            # A register declares this macro by itself.
            yield self.length_macro
        yield from (scale.name for scale in self.struct.scales)
        yield from (f"{self.name}_set_{name}" for name in self.set_names)
        if self.reports is not None:
            yield from self.reports.names()
        if self.word_crc is not None:
            yield self.word_crc.name
        yield from (bits_crc.name for bits_crc in self.bits_crcs.values())
        if self.position_member:
            yield f"{self.name}_position"
        if self.is_received:
            yield f"{self.name}_receive"
        if self.is_read:
            yield f"{self.name}_read"
        if self.can_differ_from_manual:
            yield f"{self.name}_is_expected"
            yield from (self.expected_macro(field) for field in self.expected_fields if self.has_one_value(field))

    @property
    def position_member(self) -> str:
        """The field or joined number with the position that the function ``_position`` returns.

        It is empty if there is no such function, because the frame has no position, or no flag that says whether the
        position is usable (its verdict).
        """
        context = self.struct.context
        layout = self.struct.layout
        has_verdict = self.reports is not None and bool(self.reports.verdict_function)
        if layout.sender != "encoder" or not has_verdict:
            return ""
        position_name = context.device.position_name(context.interface.name)
        return position_name if position_name in layout.member_names else ""

    @property
    def receiver(self) -> str:
        """The function of the runtime that extracts the frame from the bytes that SPI received.

        It is empty for a register, for a frame that the master sends, and for a frame that a serial port receives.
        """
        if self.struct.register is not None or not self.decodes:
            return ""
        match self.struct.context.interface:
            case Biss() | Ssi() as interface:
                ending = "_frame" if self.layout_plan.in_bytes else ""
                return f"cw_{interface.name}_receive{ending}"
            case Spi() if not self.layout_plan.in_bytes:
                return "cw_spi_load"
            case _:
                return ""

    @property
    def is_received(self) -> bool:
        """True if a function extracts the word of the frame from a buffer."""
        return bool(self.receiver) and not self.layout_plan.in_bytes

    @property
    def is_read(self) -> bool:
        """True if a function returns the position from a buffer."""
        return bool(self.position_member and self.receiver)

    @cached_property
    def whole_frame(self) -> ChannelFrame | None:
        """The frame with several data channels to which this frame belongs, or None."""
        frame = channel_frame(self.struct.context.interface) if self.struct.register is None else None
        is_channel = frame is not None and self.struct.layout in frame.layouts
        return frame if is_channel else None

    @property
    def length_alternatives(self) -> tuple[AlternativeCode, ...]:
        """The alternatives on whose answers the length of the frame depends."""
        return self.alternatives_for(self.layout_plan.layout.bits)

    @property
    def word_has_length(self) -> bool:
        """True if the decoder takes a word with its length, because the length of the frame varies."""
        return self.is_received and not self.layout_plan.layout.bits.is_constant

    @property
    def word_type(self) -> str:
        """The type of the word that the decoder takes."""
        return "cw_word" if self.word_has_length else self.struct.number_type

    @property
    def word_parameter(self) -> str:
        """The word as a parameter of functions that pass it on to the decoder."""
        if self.word_has_length:
            return self.struct.context.passing.parameter("cw_word", "word")
        return f"{self.struct.number_type} word"

    @property
    def word_may_be_longer(self) -> bool:
        """True if a word can have bits above the frame, because its type is wider than a frame of some order code."""
        bits = self.layout_plan.layout.bits
        always_fills_word = bits.is_constant and bits.constant == self.struct.reader.word_size
        return not always_fills_word

    @property
    def order_of_bytes(self) -> str:
        """The order of several bytes, for the comments on the decoder and the encoder. Empty for a single byte.

        Only frames have their own comment (``about``), so without one it is a register.
        """
        if self.layout_plan.length < 2:
            return ""
        if not self.about:
            return ", lowest address first"
        order = self.struct.layout.byte_order.replace("_", " ")
        return f" in the order sent, {order}"

    @property
    def about_unused(self) -> str:
        """The comment on the member for the unused bits."""
        return about_unused(self.struct)

    def about_member(self, field: Field) -> str:
        """Return the comment on the member of a field."""
        return about_member(self.struct, field)

    @property
    def set_names(self) -> tuple[str, ...]:
        """The members with a ``_set_`` function, because other members repeat their value.

        They are numbers joined from several fields, and numbers whose decimal digits are members, too.
        """
        join_names = (joined_number.join.name for joined_number in self.layout_plan.joined_numbers)
        fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        decimal_names = [field.name for field in fields if field.runs]
        return (*join_names, *decimal_names)

    @cached_property
    def word_crc(self) -> WordCrc | None:
        """The function that computes the CRC of a whole word, or None if the layout has no such CRC."""
        frame_crc = self.layout_plan.crc_of_all_order_codes
        word_bits = self.layout_plan.layout.widest
        if frame_crc is None or not frame_crc.is_checked_by_division:
            return None
        crc = frame_crc.crc
        is_wider_than_shift_register = crc.width > 32
        if is_wider_than_shift_register:
            return None
        fold_steps = tuple(fold_operations(frame_crc.steps, word_bits, source="word")) if frame_crc.steps else ()
        about = about_word_crc(self.struct.device, crc, is_folded=bool(fold_steps))
        return WordCrc(
            name=f"{self.name}_crc",
            general_function=self.struct.crc_function(frame_crc),
            crc=crc,
            word_bits=word_bits,
            folds=fold_steps,
            about=tuple(about),
        )

    @property
    def bits_crcs(self) -> dict[str, BitsCrc]:
        """The functions that compute the CRCs of a frame of bits in bytes, by the name of the CRC field.

        Empty for a word, and for a CRC over whole bytes.
        """
        if not self.layout_plan.in_bytes or self.layout_plan.layout.crc_covers_bytes:
            return {}
        return {crc.field.name: self._bits_crc(crc) for crc in self.layout_plan.crcs}

    def _bits_crc(self, frame_crc: FrameCrc) -> BitsCrc:
        """Return the function of one CRC. Its name contains the field if only some order codes have the CRC."""
        return BitsCrc(
            name=f"{self.name}_{frame_crc.field.name}_crc" if frame_crc.is_optional else f"{self.name}_crc",
            crc=frame_crc.crc,
            covered_width=frame_crc.covered_width.constant,
            type=unsigned(frame_crc.crc.width),
            about=tuple(about_bits_crc(self.struct.device, frame_crc.crc)),
        )

    def alternatives_for(self, *expressions: Expression) -> tuple[AlternativeCode, ...]:
        """Return the questions left open by the manual (alternatives) whose answers these expressions need."""
        return alternatives_in(self.alternatives, *expressions)

    @property
    def decoder_uses_variant(self) -> bool:
        """True if the decoder uses the variant, because places or lengths depend on the order code."""
        checks_length = not self.layout_plan.in_bytes and self.word_may_be_longer
        return self.layout_plan.depends_on_order_code or checks_length

    @property
    def encoder_uses_variant(self) -> bool:
        """True if the encoder uses the variant: for Gray code, fields, unused bits, limits or a CRC.

        A layout that depends only on the user's answer to an open question does not use the variant.
        """
        depends_only_on_answers = bool(self.alternatives) and not self.layout_plan.depends_on_order_code
        if depends_only_on_answers:
            return False
        gray = self.layout_plan.gray
        gray_depends = gray is not None and gray.depends_on_order_code
        fields_depend = any(encoded_field.depends_on_order_code for encoded_field in self.layout_plan.encoded_fields)
        limits_depend = any(depends_on_order_code(refusal) for refusal in self.encoder.refusals)
        crcs_depend = any(map(self._crc_depends, self.layout_plan.crcs))
        return gray_depends or fields_depend or self.struct.unused.depends_on_order_code or limits_depend or crcs_depend

    def _crc_depends(self, crc: FrameCrc) -> bool:
        """Return True if the order code decides whether the frame has the CRC, or how many bits the CRC covers."""
        passes_length = not self.layout_plan.in_bytes and self.word_crc is None
        return crc.is_optional or (passes_length and not crc.covered_width.is_constant)

    # -- values of fields that the manual states

    @property
    def expected_fields(self) -> tuple[Field, ...]:
        """The fields for which the manual states a value, such as a device ID."""
        fields = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        return tuple(field for field in fields if field.equals is not None)

    @property
    def can_differ_from_manual(self) -> bool:
        """True if a valid frame can differ from the manual."""
        return bool(self.expected_fields or self.struct.unused)

    @staticmethod
    def has_one_value(field: Field) -> bool:
        """Return True if the manual states one value for all order codes."""
        return not isinstance(field.equals, Expression) or field.equals.is_constant

    @property
    def expected_values_depend_on_code(self) -> bool:
        """True if a value in the manual depends on the order code."""
        return not all(map(self.has_one_value, self.expected_fields))

    def expected_value(self, field: Field) -> str:
        """Return the value in the manual as C, such as ``0x1BU``."""
        match field.equals:
            case str(characters):
                return string(characters)
            case Expression(constant):
                # Only values that are the same for all order codes have a macro.
                return c_number(constant)
            case _:
                return c_number(field.equals or 0, hexadecimal=True)

    def expected_macro(self, field: Field) -> str:
        """Return the name of the macro for the value of a field that the manual states."""
        return f"{self.name}_{field.name}_EXPECTED".upper()

    @property
    def is_expected(self) -> CExpression:
        """Condition that all fields have the values that the manual states, and that no unused bit differs from it."""
        conditions: list[CExpression] = []
        for field in self.expected_fields:
            conditions += self._conditions_of_field(field)
        if self.struct.unused:
            conditions.append(COperation("==", (CName("in->unused"), CNumber(0))))
        return join_operands("&&", tuple(conditions))

    def _conditions_of_field(self, field: Field) -> Iterator[CExpression]:
        """Yield the conditions under which a member equals the value that the manual states for its field.

        There is one condition for a number, and one for each character of a text.
        """
        member = f"in->{c_name(field.name)}"
        macro = self.expected_macro(field)
        match field.equals:
            case str(characters):
                for index in range(len(characters)):
                    yield COperation("==", (CName(f"{member}[{index}]"), CName(f"{macro}[{index}]")))
            case Expression() as equals if not equals.is_constant:
                yield COperation("==", (CName(member), self.translator.to_c(equals)))
            case _:
                yield COperation("==", (CName(member), CName(macro)))


def crc_code(context: HeaderContext, function: CrcFunction, codecs: Sequence[StructCodec]) -> CrcCode:
    """Return the general function for a CRC, with its table if it has one.

    The table is left out if no frame or register uses it. A frame with its own CRC function for words does not call
    the general function, and only uses its table.
    """
    users = [codec for codec in codecs if _uses_function(codec, function)]
    return CrcCode(
        name=context.crc_name(function.crc, function.covered_data.value),
        function=function,
        about=tuple(about_crc(context.device, function)),
        table=_table_entries(function) if users else (),
        is_called=any(codec.word_crc is None for codec in users),
        data_type=_type_of_covered_bits(function, users),
    )


def _type_of_covered_bits(function: CrcFunction, users: Sequence[StructCodec]) -> str:
    """Return the type of the bits that a CRC covers: ``uint32_t`` if 32 bits are enough for all frames."""
    crcs: list[FrameCrc] = []
    for codec in users:
        crcs += [frame_crc for frame_crc in codec.layout_plan.crcs if frame_crc.crc == function.crc]
    return "uint32_t" if all(map(covers_32_bits, crcs)) else "uint64_t"


def _uses_function(codec: StructCodec, function: CrcFunction) -> bool:
    """Return True if the code of a frame uses this CRC function or its table.

    A frame of bits that arrives in bytes has a CRC function of its own (``bits_crcs``).
    """
    has_crc = any(frame_crc.crc == function.crc for frame_crc in codec.layout_plan.crcs)
    has_own_function = bool(codec.bits_crcs)
    return has_crc and not has_own_function and covered_data_of(codec.struct.layout) is function.covered_data


def _table_entries(function: CrcFunction) -> tuple[int, ...]:
    """Return the entries of the table of a CRC, one for each byte, or nothing if its function needs no table.

    A CRC in straight-line code (``FOLD``) has a table only for frames that are words.
    """
    crc = function.crc
    if function.method is CrcMethod.TABLE:
        is_reflected = function.covered_data is CoveredData.BYTES and crc.refin
        return byte_table(crc.width, crc.poly, is_reflected)
    if function.method is CrcMethod.FOLD and function.ends_words:
        return word_table(crc.width, crc.poly)
    return ()
