"""The macros of an interface that read a position from a buffer, in which users name the order code only once."""

from __future__ import annotations

from collections.abc import Iterator

from ...model import Spi
from .codec import StructCodec
from .context import HeaderContext
from .enumerations import AlternativeCode
from .names import DeclaredName
from .variants import CodeRow, LengthCode


class ReadCode:
    """The values that the templates print for the macros that read a position.

    ``frame`` is the frame with the position, or None if no frame has a position and a verdict. ``reads_twice`` is True
    if no CRC protects the frame, so that two frames must agree.
    """

    def __init__(
        self, context: HeaderContext, frame: StructCodec | None, lengths: LengthCode, *, reads_twice: bool
    ) -> None:
        self.frame = frame
        self.reads_twice = reads_twice
        self._context = context
        self._lengths = lengths
        self.macro = f"{context.PREFIX}_READ"

    def declared(self) -> Iterator[DeclaredName]:
        """Yield the names of the macros and of the function that reads twice. Without a frame, there are no macros."""
        if self.frame is not None:
            path = ("interfaces", self._context.interface.name)
            names = [self.macro, f"{self.macro}_BYTES"]
            if self.takes_word:
                names.append(f"{self.macro}_WORD")
            if self.reads_twice:
                names += [f"{self.macro}_TWICE", f"{self.frame.name}_read_twice"]
            yield from ((name, path) for name in names)

    @property
    def takes_word(self) -> bool:
        """True if a macro takes a word as a number, since SPI peripherals exchange words of 16 or 32 bits."""
        is_word = self.frame is not None and not self.frame.plan.in_bytes and not self.frame.word_has_length
        return is_word and isinstance(self._context.interface, Spi)

    @property
    def questions(self) -> tuple[AlternativeCode, ...]:
        """The questions left open by the manual, whose answers the macros take after the order code."""
        return self.frame.alternatives if self.frame is not None else ()

    @property
    def expected_size(self) -> str:
        """C expression for the number of bytes in the array: a macro, or ``sizeof(rx)`` to accept any array.

        It is empty if there is no frame to read.
        """
        if self.frame is None:
            return ""
        if self._lengths.macros and self.frame.struct.layout.name in self._lengths.layouts:
            return self.buffer_macro(self.frame)
        if self.frame.plan.in_bytes:
            return self.frame.length_macro
        return f"{self._word_bytes}U" if self._word_bytes else "sizeof(rx)"

    @property
    def _is_spi_word(self) -> bool:
        """True if the frame with the position is a word over SPI."""
        is_spi = isinstance(self._context.interface, Spi)
        return is_spi and self.frame is not None and not self.frame.plan.in_bytes

    @property
    def is_padded(self) -> bool:
        """True if the frame with the position is a word over SPI that does not fill its bytes with some order code."""
        if self.frame is None or not self._is_spi_word:
            return False
        sent_bits = self.frame.struct.layout.sent_bits
        interface_name = self._context.interface.name
        variants = [variant for variant in self._context.device.variants if variant.interface == interface_name]
        return any(sent_bits.value(variant.parameters) % 8 for variant in variants)

    @property
    def _word_bytes(self) -> int:
        """Number of bytes of a word over SPI. It is 0 if it depends on the order code, or without such a word."""
        if self.frame is None or not self._is_spi_word:
            return 0
        sent_bits = self.frame.struct.layout.sent_bits
        # Bits to bytes, rounded up.
        return (sent_bits.constant + 7) // 8 if sent_bits.is_constant else 0

    def buffer_macro(self, frame: StructCodec) -> str:
        """Return the name of the macro for the size of a buffer, as the preprocessor pastes it.

        In ``ACME_X_SSI_##code##_##width##_RX_BYTES``, ``code`` and ``width`` are arguments: the order code, and the
        user's answer to an open question.
        """
        # If there are several frames, the name includes the name of the frame.
        layout_names = [frame.struct.layout.name.upper()] if len(self._lengths.layouts) > 1 else []
        answers = [f"##{question.argument}##" for question in frame.length_alternatives]
        return "_".join((f"{self._context.PREFIX}_##code##", *layout_names, *answers, "RX_BYTES"))

    def buffer_of(self, row: CodeRow) -> str:
        """Return the size of the buffer for an order code and the first answers, as C, or an empty string.

        A word over SPI has no macro for its size.
        """
        if self._is_spi_word and self.frame is not None:
            sent_bits = self.frame.struct.layout.sent_bits.value(row.variant.parameters)
            # Bits to bytes, rounded up.
            return str((sent_bits + 7) // 8)
        buffer_size = self.expected_size
        if buffer_size == "sizeof(rx)":
            return ""
        for question in self.questions:
            first_answer = question.alternative.answers[0].name.upper()
            buffer_size = buffer_size.replace(f"##{question.argument}##", first_answer)
        return buffer_size.replace("##code##", row.code)

    def arguments_of(self, order_code: str) -> str:
        """Return the first arguments of a macro for an order code and the first answers, such as ``X24, WIDE``."""
        answers = (question.alternative.answers[0].name.upper() for question in self.questions)
        return ", ".join((order_code, *answers))
