"""The struct of a frame or register, with its decoder and encoder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from ...model import Biss, Field, Spi, Ssi
from ...model.expressions import Expression
from ...plan.limits import OutsideLimits, depends
from .about import about_bits_crc, about_member, about_unused, about_word_crc
from .comments import Paragraph
from .crc_folds import BitsCrc, WordCrc, folds
from .decode import Decoder
from .encode import Encoder
from .enumerations import AlternativeCode, alternatives_in
from .expr import Expr, Name, Number, Operation, joined, number, string, unsigned
from .names import Declared, c_name
from .structs import Struct


class StructCodec:
    """The values that the templates print for a layout. ``about`` describes a frame and is empty for a register."""

    def __init__(self, struct: Struct, about: Sequence[Paragraph] = (), outside: Sequence[OutsideLimits] = ()) -> None:
        self.struct = struct
        self.plan = struct.plan
        self.scope = struct.scope
        self.name, self.type = struct.name, struct.type
        self.length_macro = struct.length_macro
        self.about = tuple(about)
        self.decoder = Decoder(struct)
        self.encoder = Encoder(struct, outside)
        questions = struct.context.alternatives
        self.alternatives = tuple(question for question in questions if question.item in self.plan.alternatives)
        #: Whether a program that talks to an encoder decodes it, and encodes it. A simulator does the rest.
        self.decodes = struct.register is not None or struct.layout.sender == "encoder"
        self.encodes = struct.register is not None or not self.decodes
        #: The reports of a frame, None for a register.
        self.reports = (
            struct.context.reports.of(struct.layout, self.name, self.type) if struct.register is None else None
        )

    def declared(self) -> Iterator[Declared]:
        yield from ((name, self.struct.path) for name in self._names())

    def _names(self) -> Iterator[str]:
        yield self.type
        yield from (f"{self.name}_{ending}" for ending in ("decode", "encode"))
        if not self.plan.in_bytes:
            yield f"{self.name}_bits"
        elif self.about:
            yield self.length_macro
        yield from (scale.name for scale in self.struct.scales)
        yield from (f"{self.name}_set_{name}" for name in self.set_names)
        yield from self.reports.names() if self.reports is not None else ()
        if self.word_crc is not None:
            yield self.word_crc.name
        if self.bits_crc is not None:
            yield self.bits_crc.name
        if self.measured:
            yield f"{self.name}_position"
        if self.is_received:
            yield f"{self.name}_receive"
        if self.is_read:
            yield f"{self.name}_read"
        if self.tells_difference:
            yield f"{self.name}_is_expected"
            yield from (self.expected_macro(field) for field in self.expected if self.has_one_value(field))

    @property
    def measured(self) -> str:
        """The field or join with the position that a function returns, or an empty text if there is no such function.

        A frame has it if its verdict is known.
        """
        context, layout = self.struct.context, self.struct.layout
        measurement = context.device.measurement_of(context.interface.name)
        has_verdict = self.reports is not None and bool(self.reports.verdict)
        if measurement is None or layout.sender != "encoder" or not has_verdict:
            return ""
        return measurement.of if measurement.of in layout.member_names else ""

    @property
    def receiver(self) -> str:
        """The function of the runtime that extracts the frame from a buffer, empty if a port receives its bytes."""
        if self.struct.register is not None or not self.decodes:
            return ""
        match self.struct.context.interface:
            case Biss() | Ssi() as interface:
                return f"cw_{interface.name}_receive" + ("_frame" if self.plan.in_bytes else "")
            case Spi() if not self.plan.in_bytes:
                return "cw_spi_load"
            case _:
                return ""

    @property
    def is_received(self) -> bool:
        """True if a function extracts the word of the frame from a buffer."""
        return bool(self.receiver) and not self.plan.in_bytes

    @property
    def is_read(self) -> bool:
        """True if a function returns the position from a buffer."""
        return bool(self.measured and self.receiver)

    @property
    def length_alternatives(self) -> tuple[AlternativeCode, ...]:
        """The alternatives on whose answers the length of the frame depends."""
        return self.alternatives_for(self.plan.layout.bits)

    @property
    def word_has_length(self) -> bool:
        """True if the decoder takes a word with its length, because not all words of the frame have the same length."""
        return self.is_received and not self.plan.layout.bits.is_constant

    @property
    def word_type(self) -> str:
        """The type of the word that the decoder takes."""
        return "cw_word" if self.word_has_length else "uint64_t"

    @property
    def about_unused(self) -> str:
        return about_unused(self.struct)

    def about_member(self, field: Field) -> str:
        return about_member(self.struct, field)

    @property
    def set_names(self) -> tuple[str, ...]:
        """The members that other members repeat."""
        decimal = (part.field.name for part in self.plan.parts if part.field.runs)
        return (*(whole.join.name for whole in self.plan.wholes), *decimal)

    @cached_property
    def word_crc(self) -> WordCrc | None:
        """The function that computes the CRC of a whole word."""
        crc, bits = self.plan.crc, self.plan.layout.widest
        # Its register has 32 bits.
        if crc is None or not crc.divides or crc.crc.width > 32:
            return None
        steps = tuple(folds(crc.steps, bits, "word")) if crc.steps else ()
        about = tuple(about_word_crc(self.struct.device, crc.crc, bool(steps)))
        return WordCrc(f"{self.name}_crc", self.struct.crc_function, crc.crc, bits, steps, about)

    @property
    def bits_crc(self) -> BitsCrc | None:
        """The function that computes the CRC of a frame of bits in bytes."""
        crc, layout = self.plan.crc, self.plan.layout
        if crc is None or not layout.in_bytes or layout.crc_covers_bytes:
            return None
        about = tuple(about_bits_crc(self.struct.device, crc.crc))
        return BitsCrc(f"{self.name}_crc", crc.crc, crc.covered.constant, unsigned(crc.crc.width), about)

    def alternatives_for(self, *expressions: Expression) -> tuple[AlternativeCode, ...]:
        """Return the alternatives whose answers these expressions need."""
        return alternatives_in(self.alternatives, *expressions)

    @property
    def decoder_depends(self) -> bool:
        """True if the decoder uses the variant."""
        return self.plan.depends or not self.plan.in_bytes

    @property
    def encoder_depends(self) -> bool:
        """True if the encoder uses the variant."""
        crc, plan = self.plan.crc, self.plan
        if self.alternatives and not plan.depends:
            return False
        return (
            (plan.gray is not None and plan.gray.depends)
            or any(op.depends for op in plan.terms)
            or self.struct.unused.depends
            or any(depends(op) for op in self.encoder.refusals)
            or (crc is not None and not plan.in_bytes and self.word_crc is None and not crc.covered.is_constant)
        )

    # -- values of fields that the manual states

    @property
    def expected(self) -> tuple[Field, ...]:
        return tuple(part.field for part in self.plan.parts if part.field.equals is not None)

    @property
    def tells_difference(self) -> bool:
        """True if a valid frame can differ from the manual."""
        return bool(self.expected or self.struct.unused)

    @staticmethod
    def has_one_value(field: Field) -> bool:
        """Return True if the manual states one value for all order codes."""
        return not isinstance(field.equals, Expression) or field.equals.is_constant

    @property
    def expected_depends(self) -> bool:
        return not all(map(self.has_one_value, self.expected))

    def expected_value(self, field: Field) -> str:
        match field.equals:
            case str(text):
                return string(text)
            case Expression(constant):
                return number(constant)
            case _:
                return number(field.equals or 0, hexadecimal=True)

    def expected_macro(self, field: Field) -> str:
        return f"{self.name}_{field.name}_EXPECTED".upper()

    @property
    def is_expected(self) -> Expr:
        """Condition that a struct has the values of the manual."""
        unused = [Operation("==", (Name("in->unused"), Number(0)))] if self.struct.unused else []
        return joined(
            "&&", (*(condition for field in self.expected for condition in self._is_expected(field)), *unused)
        )

    def _is_expected(self, field: Field) -> Iterator[Expr]:
        name, macro = f"in->{c_name(field.name)}", self.expected_macro(field)
        match field.equals:
            case str(text):
                for index in range(len(text.encode("ascii", "replace"))):
                    yield Operation("==", (Name(f"{name}[{index}]"), Name(f"{macro}[{index}]")))
            case Expression() as equals if not equals.is_constant:
                yield Operation("==", (Name(name), self.scope.of(equals)))
            case _:
                yield Operation("==", (Name(name), Name(macro)))
