"""A single header for one order code, with everything that reads a position.

The headers of the interface are those of a family with only this order code, whose quantities are numbers: fields and
flags that the order code does not have are absent. All names begin with the order code, so that several headers can be
included together. Only the results and verdicts are shared, under their own guard.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import Annotated, TypedDict

from ...model import Biss, Device, Manufacturer, Ssi
from ...order_codes.quantities import with_quantities
from ...order_codes.reduction import for_codes
from ...plan.frames import received_sizes
from .. import TargetError
from .code_facts import timing_macros
from .codec import StructCodec
from .comments import break_lines
from .device import DeviceView, views_of
from .expressions import StructPassing
from .header_text import (
    BYTES_LOADED_AT_ONCE,
    Declaration,
    WordLength,
    cut_biss_receiver,
    cut_ssi_receiver,
    declarations_in,
    declarations_needed_by,
    names_of,
    runtime_headers,
    runtime_version,
    without_settings,
)
from .single_text import (
    C_IDENTIFIER,
    CommentAdapter,
    SingleUsage,
    first_paragraph,
    first_sentence,
    refilled_macro,
    with_short_conditions,
    with_signature_on_one_line,
    without_example,
)

TEMPLATE = "single.h.jinja"
#: The headers of the runtime that receive frames, in the order in which they include each other.
_RECEIVING_HEADERS = ("bits.h", "receive.h", "receive_frame.h", "channels.h", "spi.h")
#: The part of the runtime that all headers share.
_SHARED_HEADER = "result.h"
#: A part of the names of macros that only register access needs.
_FOR_REGISTERS = "_CONTROL_"
#: Parts of an interface in a spec that reading a position does not need.
_OTHER_PARTS = ("control_data", "description_file", "network", "profile")
#: Suffixes of the functions of a frame that are needed to read its position.
_READING_SUFFIXES = ("decode", "verdict")
#: Suffixes of further functions of a frame. The macros need some of them, and without macros, a program needs all.
_FURTHER_SUFFIXES = ("bits", "position", "read", "receive")
#: Suffixes of the functions that collect the bytes of a reply over RS-485.
_BYTE_BY_BYTE = ("ask", "take", "take_any", "resume", "late", "reason")
#: The parts of the runtime that a program uses itself. Their comments stay, without examples.
_USED_BY_PROGRAMS = frozenset(f"cw_rs485_{part}" for part in ("line", *_BYTE_BY_BYTE))
#: A comment on the lines above a member of a struct::
#:
#:     /**
#:      * Number of revolutions.
#:      */
_COMMENT_ABOVE_MEMBER = re.compile(r"^ +/\*\*\n.*?\*/\n", re.MULTILINE | re.DOTALL)


class SingleHeader(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    PREFIX: Annotated[str, "the prefix of its macros"]
    d: Annotated[DeviceView, "the interface, narrowed to the order code"]
    s: Annotated[SingleCode, "the parts of the header"]


class SingleCode:
    """The parts of the single header for the only order code of a view.

    ``header`` is the text of the normal header, from which the declarations are taken.
    """

    def __init__(self, view: DeviceView, header: str) -> None:
        self.view = view
        self.order_code = view.device.variants[0].code
        self.path = single_path(view.maker, self.order_code)
        self.stem = self.path.removesuffix(".h")
        self.STEM = self.stem.upper()
        self.usage = SingleUsage(view, self.named)
        crc_settings = {f"{view.maker.name.upper()}_CRC_{setting}" for setting in ("TABLE", "BITWISE")}
        header = without_settings(header, crc_settings)
        if not view.variants.parameters:
            header = _without_order_code(header, view)
        runtime_declarations: list[Declaration] = []
        for name in _RECEIVING_HEADERS:
            # The mark of functions to be inlined needs more lines than it saves here.
            runtime_header = self._runtime_header(name).replace("\nCW_INLINE\n", "\n")
            runtime_declarations += declarations_in(runtime_header)
        all_declarations = [*runtime_declarations, *declarations_in(header)]
        names_to_keep = self._yield_roots(names_of(all_declarations))
        needed_declarations = declarations_needed_by(names_to_keep, all_declarations)
        self.declarations = [declaration for declaration in needed_declarations if not declaration.is_title]
        self._insert_comment_on_interface(all_declarations)
        kept_names = names_of(self.declarations)
        self._runtime_names = names_of(runtime_declarations) & kept_names
        self._renamed = self._new_names(kept_names)
        self._shared_names = names_of(declarations_in(runtime_headers()[_SHARED_HEADER]))
        note_on_choice = f"{self.order_code} has 0. For 1, pass your own {self.stem} to {self.stem}_read."
        self._comments = CommentAdapter(
            rename=self._named_in_comment,
            is_absent=self._is_absent,
            note_on_choice=note_on_choice,
            absent_errata=frozenset(self._titles_of_other_errata()),
        )

    @property
    def shared(self) -> str:
        """The declarations of the results and verdicts, which all single headers share."""
        declarations = declarations_in(runtime_headers()[_SHARED_HEADER])
        return "\n".join(first_sentence(declaration.comment) + declaration.code for declaration in declarations)

    @property
    def runtime_version(self) -> tuple[int, int]:
        """The major and minor version of the runtime that the declarations come from."""
        return runtime_version()

    @property
    def marks(self) -> str:
        """The definitions of the macros that mark functions and constants, and of the size of an array."""
        bits_header = runtime_headers()["bits.h"]
        marks_and_size = bits_header[
            bits_header.index("/* With C++17") : bits_header.index("#ifdef __cplusplus\nextern")
        ]
        # The first line is a comment on the standard. The definitions follow it.
        _, _, definitions = marks_and_size.rstrip("\n").partition("\n")
        if self.view.position_reader.frame is None:
            definitions, _, _ = definitions.partition("\n\n")
        return f"{definitions}\n"

    @property
    def body(self) -> str:
        """The declarations, with their names in this header, separated by blank lines.

        There is no blank line before a function with a comment of one line, nor between macros without comments.
        """
        texts: list[str] = []
        follows_macro = False
        for declaration in self.declarations:
            declaration_text = self._format_declaration(declaration)
            is_short_function = declaration_text.startswith("/** ") and declaration.is_function
            is_further_macro = follows_macro and declaration_text.startswith("#define")
            if texts and not is_short_function and not is_further_macro:
                texts.append("\n")
            texts.append(declaration_text)
            follows_macro = declaration.has_macro
        return "".join(texts)

    def named(self, text: str) -> str:
        """Return a text with the names of this header in place of those in the normal header and the runtime."""
        return C_IDENTIFIER.sub(lambda word: self._renamed.get(word[0], word[0]), text)

    def _insert_comment_on_interface(self, declarations: Sequence[Declaration]) -> None:
        """Insert the comment on the interface, unless a macro has it that is kept.

        The comment is below the title of the interface, alone or on a macro. It goes before the first kept declaration
        that follows it.
        """
        title = f"/* -- {self.view.context.interface.title} "
        title_indexes = [index for index, item in enumerate(declarations) if item.comment.startswith(title)]
        declarations_after_title = declarations[title_indexes[0] + 1 :] if title_indexes else ()
        if not declarations_after_title:
            return
        commented = declarations_after_title[0]
        is_comment_on_interface = commented.has_macro or not commented.code
        is_kept = not names_of(self.declarations).isdisjoint(commented.names)
        if is_comment_on_interface and not is_kept:
            following_names = names_of(declarations_after_title)
            is_following = [not following_names.isdisjoint(kept.names) for kept in self.declarations]
            self.declarations.insert(is_following.index(True), Declaration(commented.comment, code=""))

    def _runtime_header(self, name: str) -> str:
        """Return a header of the runtime, without code for words of lengths that the frame with the position lacks."""
        text = runtime_headers()[name]
        length = self._word_length
        if name != "receive.h" or length is None:
            return text
        match self.view.context.interface:
            case Biss():
                return cut_biss_receiver(text, length)
            case Ssi() if not length.is_variable:
                return cut_ssi_receiver(text, length.most_bits)
            case _:
                return text

    @cached_property
    def _word_length(self) -> WordLength | None:
        """The length of the word that the macros receive, or None if they receive no single word."""
        frame, interface = self.view.position_reader.frame, self.view.context.interface
        if frame is None or frame.layout_plan.in_bytes or frame.whole_frame is not None:
            return None
        sizes = [size for size in received_sizes(self.view.device, interface) if size.layout == frame.struct.layout]
        if not sizes:
            return None
        varies = len(sizes) > 1 or sizes[0].depends_on_registers
        most_bits = sizes[0].layout.widest if varies else sizes[0].frame_bits
        return WordLength(most_bits, buffer_bytes=sizes[0].buffer_bytes, is_variable=varies)

    def _titles_of_other_errata(self) -> Iterator[str]:
        """Yield the titles of the errata that are only about parts of the interface that this header does not have."""
        other_parts = {f"interfaces.{self.view.context.interface.name}.{part}" for part in _OTHER_PARTS}
        for erratum in self.view.device.errata:
            if other_parts.issuperset(erratum.affects):
                yield erratum.title

    def _named_in_comment(self, text: str) -> str:
        """Return a text of a comment with the names of this header, and with the smallest size of its buffers."""
        is_biss = isinstance(self.view.context.interface, Biss)
        if is_biss and self._word_length is not None and self._word_length.fits_one_load:
            smallest_size = f"of at least {BYTES_LOADED_AT_ONCE} bytes"
            text = text.replace("Any other size works too", f"Any other size {smallest_size} works too")
            text = text.replace("any number of bytes", f"{BYTES_LOADED_AT_ONCE} or more bytes")
        return self.named(text)

    def _is_helper(self, declaration: Declaration) -> bool:
        """Return True if a declaration comes from the runtime."""
        return not self._runtime_names.isdisjoint(declaration.names)

    # -- what is needed

    def _yield_roots(self, known_names: Collection[str]) -> Iterator[str]:
        """Yield the names in the normal header that a program uses to read positions. Some of them may not exist.

        They are the macros of the interface, except those for registers and times, the functions of the frames with the
        position, and the functions for the request.
        """
        view = self.view
        timings = view.context.interface.timings
        macros_of_times = chain.from_iterable(timing_macros(timing, view.PREFIX) for timing in timings)
        # The times of other interfaces are about registers and resets.
        time_names = {macro.name for macro in macros_of_times} if not isinstance(view.context.interface, Ssi) else set()
        for macro in view.interface.macros:
            if _FOR_REGISTERS not in macro.name and macro.name not in time_names:
                yield macro.name
        if view.variants.parameters:
            yield view.code_row.macro
        yield f"{view.prefix}_counts_per_turn"
        for codec in self._position_codecs():
            yield from (f"{codec.name}_{suffix}" for suffix in _READING_SUFFIXES)
            if view.position_reader.frame is None:
                yield from (f"{codec.name}_{suffix}" for suffix in _FURTHER_SUFFIXES)
        starts = (view.position_reader.macro, f"{view.code_row.macro}_")
        other_channels = self._macros_of_other_channels()
        yield from (name for name in known_names if name.startswith(starts) and name not in other_channels)
        yield from self._roots_of_requests()

    def _roots_of_requests(self) -> Iterator[str]:
        """Yield the names that a program uses to request positions over RS-485 or SPI."""
        usage = self.view.usage
        if usage is not None and usage.request_macro:
            yield usage.request_macro
        if usage is not None and (usage.request_macro or usage.request_for_reply is not None):
            yield from (f"cw_rs485_{action}" for action in _BYTE_BY_BYTE)
        if self.usage.request is not None:
            yield f"{self.usage.request.name}_encode"
            yield f"{self.usage.request.name}_bits"
            if self.view.interface.position_request:
                yield "cw_spi_store"
                yield "cw_spi_load"

    def _macros_of_other_channels(self) -> set[str]:
        """Return the lengths of the data channels that the macros do not name."""
        frame = self.view.position_reader.frame
        if frame is None or frame.whole_frame is None:
            return set()
        other_layouts = (layout for layout in frame.whole_frame.layouts if layout != frame.struct.layout)
        stems = [f"{self.view.code_row.macro}_{layout.name.upper()}" for layout in other_layouts]
        return {f"{stem}_{suffix}" for stem in stems for suffix in ("BITS", "RX_BYTES")}

    def _position_codecs(self) -> Iterator[StructCodec]:
        """Yield the frame that the macros read, or all frames with a position if there are no macros."""
        frame = self.view.position_reader.frame
        if frame is not None:
            yield frame
            return
        device, interface = self.view.device, self.view.context.interface
        codecs = self.view.interface.codecs
        yield from (codec for codec in codecs if device.sends_position(interface.name, codec.struct.layout))

    # -- names

    def _new_names(self, kept_names: Iterable[str]) -> Mapping[str, str]:
        """Return the names in this header, by the names in the normal header and the runtime.

        Raises:
            TargetError: Two declarations would have the same name.
        """
        new_names = {name: self._new_name(name) for name in kept_names}
        for new_name, number_of_declarations in Counter(new_names.values()).items():
            if number_of_declarations > 1:
                raise TargetError(f"{self.order_code}: two parts of its header have the C name {new_name}")
        return new_names

    def _new_name(self, name: str) -> str:
        """Return a name with the prefix of this header, such as ``acme_x_24_read`` for ``cw_read``."""
        view = self.view
        if name in self._runtime_names:
            # If the order code is the name of the family, acme_x_ssi_receive is a function of the normal header.
            is_name_of_family = view.prefix == f"{self.stem}_{view.context.interface.name}"
            kept_prefix = "cw_" if is_name_of_family else ""
            new_name = re.sub("^cw_", f"{self.stem}_{kept_prefix}", name)
            return re.sub("^CW_", f"{self.STEM}_{kept_prefix.upper()}", new_name)
        # The macro of the order code itself begins with view.PREFIX, so it is tried first.
        new_prefixes = {view.code_row.macro: self.STEM, view.PREFIX: self.STEM, view.prefix: self.stem}
        for old_prefix, new_prefix in new_prefixes.items():
            if name == old_prefix or name.startswith(f"{old_prefix}_"):
                return new_prefix + name.removeprefix(old_prefix)
        return name

    # -- texts

    def _format_declaration(self, declaration: Declaration) -> str:
        """Return a declaration and its comment as text, with the names of this header and its lines broken again."""
        comment, code = declaration.comment, declaration.code
        is_used_by_programs = not _USED_BY_PROGRAMS.isdisjoint(declaration.names)
        if is_used_by_programs:
            comment = without_example(comment)
        elif self._is_helper(declaration):
            comment = first_paragraph(comment)
        if declaration.has_macro:
            code = self._without_code_parameter(code)
        code = _COMMENT_ABOVE_MEMBER.sub(self._comments.adapt_member, code)
        code = "".join(map(self._rename_pasted, code.splitlines(keepends=True)))
        # The marks for Doxygen come back with the marks of the whole header.
        code = code.replace("/**< ", "/* ").replace("/**", "/*")
        code = self.named(code)
        if declaration.has_macro:
            code = refilled_macro(code)
        # The names are longer or shorter than in the normal header, so the lines are broken again.
        code = with_signature_on_one_line(code)
        code = with_short_conditions(code)
        new_comment = self._comments.adapt(comment, with_arguments=is_used_by_programs)
        return new_comment + break_lines(code)

    def _without_code_parameter(self, c_code: str) -> str:
        """Return the code of a macro without its parameter ``code``, since the header is for one order code.

        ``RECEIVE(code, rx)``, which pastes ``ACME_X_##code##_BITS``, becomes ``RECEIVE(rx)`` with ``ACME_X_24_BITS``.
        """
        if "(code, " not in c_code:
            return c_code
        order_code = self.view.code_row.macro.removeprefix(f"{self.view.PREFIX}_")
        code_without_parameter = c_code.replace("(code, ", "(", 1)
        code_without_parameter = code_without_parameter.replace("##code", order_code)
        # In MACRO##_BITS nothing is left to paste. MACRO##_##name still pastes another parameter.
        return re.sub(rf"({self.view.code_row.macro})##(?=_\w)(?!_##)", r"\1", code_without_parameter)

    def _rename_pasted(self, line: str) -> str:
        """Return a line with the prefix of this header in names that a macro pastes, as in ``ACME_X_##name``."""
        # A prefix that is followed by letters and ##.
        pattern = rf"\b(?:{self.view.code_row.macro}|{self.view.PREFIX})_(?=\w*##)"
        return re.sub(pattern, f"{self.STEM}_", line)

    def _is_absent(self, name: str) -> bool:
        """Return True if a name of the normal header or the runtime is not in this header."""
        has_known_prefix = name.startswith((f"{self.view.prefix}_", f"{self.view.PREFIX}_", "cw_"))
        return has_known_prefix and name not in self._renamed and name not in self._shared_names


def _without_order_code(header: str, view: DeviceView) -> str:
    """Return the text of a header whose functions do not take an order code, because nothing depends on it.

    ``x_bits(x variant)`` becomes ``x_bits(void)``, ``x_read(x variant, word)`` becomes ``x_read(word)``, the calls
    ``x_bits(variant)`` and ``x_read(X_##code, word)`` become ``x_bits()`` and ``x_read(word)``.
    """
    # acme_x variant, or const acme_x *variant
    parameter = rf"(?:const )?{view.prefix} \*?variant"
    # variant, or in a macro ACME_X_##code, each also by address
    arguments = ("variant", rf"&?{view.PREFIX}_##code")
    header = header.replace("    (void)variant;\n", "")
    # x_bits(acme_x variant) becomes x_bits(void).
    header = re.sub(rf"\(\s*{parameter}\)", "(void)", header)
    for argument in arguments:
        # x_bits(variant) becomes x_bits().
        header = re.sub(rf"\(\s*{argument}\)", "()", header)
    for first_argument in (parameter, *arguments):
        # x_read(variant, word) becomes x_read(word). In a macro, the next argument can be on the next line, after a
        # backslash.
        header = re.sub(rf"\((\s*){first_argument},\s+(?:\\\n\s+)?", r"(\1", header)
    return header


def identifier(order_code: str) -> str:
    """Return an order code as part of a C name: ``tv62_s042`` for ``TV62/S042``."""
    return re.sub("[^a-z0-9]+", "_", order_code.lower()).strip("_")


def single_path(maker: Manufacturer, order_code: str) -> str:
    """Return the file name of the header for an order code."""
    return f"{maker.name}_{identifier(order_code)}.h"


def single_views(device: Device, passing: StructPassing) -> Iterator[DeviceView]:
    """Yield a view of the device for each of its order codes, with numbers instead of the quantities that it sets.

    Answers to questions that the manual leaves open, settings in registers, and what follows from them stay open.
    """
    for variant in device.variants:
        device_with_numbers = with_quantities(for_codes(device, {variant.code}), variant, keeps_settings=True)
        yield from views_of(device_with_numbers, passing)


def single_header(view: DeviceView, render: Callable[[str, Mapping[str, object]], str], header: str) -> str:
    """Return the text of the single header for the only order code of a view. ``header`` is the normal header."""
    single = SingleCode(view, header)
    values: SingleHeader = {"maker": view.maker, "PREFIX": view.maker.name.upper(), "d": view, "s": single}
    return render(TEMPLATE, values)
