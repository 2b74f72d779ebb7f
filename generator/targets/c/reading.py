"""From a buffer to a usable position, with the order code named once: the functions and macros of an interface."""

from __future__ import annotations

from collections.abc import Iterator

from .codec import StructCodec
from .context import Context
from .enumerations import AlternativeCode
from .names import Declared
from .variants import LengthCode


class ReadCode:
    """The values that the templates print for the macros that read a position.

    ``frame`` is the frame with the position, None if the interface has none whose verdict is known. ``twice`` is true
    if no CRC protects it, so that two frames must agree.
    """

    def __init__(self, context: Context, frame: StructCodec | None, lengths: LengthCode, *, twice: bool) -> None:
        self.frame = frame
        self.twice = twice
        self._context, self._lengths = context, lengths
        self.macro = f"{context.PREFIX}_READ"

    def declared(self) -> Iterator[Declared]:
        if self.frame is not None:
            path = ("interfaces", self._context.interface.name)
            names = [self.macro, f"{self.macro}_BYTES"]
            if self.twice:
                names += [f"{self.macro}_TWICE", f"{self.frame.name}_read_twice"]
            yield from ((name, path) for name in names)

    @property
    def questions(self) -> tuple[AlternativeCode, ...]:
        """The choices that the macros take after the order code."""
        return self.frame.alternatives if self.frame is not None else ()

    @property
    def expected_size(self) -> str:
        """The number of bytes in the array of the macro, as C. Without a macro for it, any array is accepted."""
        if self.frame is None:
            return ""
        if self._lengths.macros and self.frame.struct.layout.name in self._lengths.layouts:
            return self.buffer_macro(self.frame)
        if self.frame.plan.in_bytes:
            return self.frame.length_macro
        return "sizeof(rx)"

    def buffer_macro(self, frame: StructCodec) -> str:
        """Return the name of the size of a buffer, made of the arguments of a macro."""
        layout_names = [frame.struct.layout.name.upper()] if len(self._lengths.layouts) > 1 else []
        answers = [f"##{question.argument}##" for question in frame.length_alternatives]
        return "_".join((f"{self._context.PREFIX}_##code##", *layout_names, *answers, "RX_BYTES"))

    def buffer_of(self, code: str) -> str:
        """Return the size of the buffer for an order code and the first answers, as C, or an empty text.

        A word over SPI has no macro for its size.
        """
        size = self.expected_size
        if size == "sizeof(rx)":
            return ""
        for question in self.questions:
            size = size.replace(f"##{question.argument}##", question.item.answers[0].name.upper())
        return size.replace("##code##", code)

    def arguments_of(self, code: str) -> str:
        """Return the first arguments of a macro for an order code and the first answers."""
        answers = (question.item.answers[0].name.upper() for question in self.questions)
        return ", ".join((code, *answers))
