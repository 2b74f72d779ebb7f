"""The text of a single header: the facts at its top, comments shortened from other headers, and lines broken again."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Collection, Iterable, Iterator
from itertools import chain

from ...model import Spi
from ...plan.values import is_number, meaning_of
from ...say.names_and_evidence import Topic, mentions, word_for_document
from .codec import StructCodec
from .comments import COLUMNS
from .device import DeviceView
from .names import c_name

#: Width of a line of a comment after its `` * ``.
COMMENT_WIDTH = COLUMNS - 3
#: The end of a sentence, or of words before a colon. ``Steps: Battery replacement.`` is one sentence.
SENTENCE_END = re.compile(r"(?<=[.:])(?<!Steps:)\s(?=[A-Z])")

#: Paragraphs that reading a position does not need, by what they begin with.
_OTHER_PARAGRAPHS = (
    *("Control data: ", "Description file: ", "For register access with ", "In the manual: "),
    *("Network: ", "Profile: "),
)
#: Words in sentences about parts that the single header does not have, such as other headers and example programs.
_ABOUT_ABSENT = re.compile(r"\b\w+\.h\b|examples/|_reports\(\)|order code is named once|[Cc]ode can be ")
#: The beginning of the sentence on the choice that sets a quantity.
_CHOICE = "It is set by your choice of "
#: The beginnings of further sentences about such parts.
_OTHER_SENTENCES = ("Steps: ", "With 0 in place of the CRC", _CHOICE)
#: The name of an erratum, which this header lists by its title: `` (erratum low_battery)``.
_NAME_OF_ERRATUM = re.compile(r" \((?:see )?erratum \w+\)")
C_IDENTIFIER = re.compile(r"\b[A-Za-z_]\w*\b")


class CommentAdapter:
    """Adapts comments of the normal header and the runtime to a single header.

    ``rename`` replaces the names in a text by those of the single header, and ``is_absent`` is True for a name that the
    single header does not have. ``note_on_choice`` says how to set a quantity that follows from a choice of the user.
    ``absent_errata`` are the titles of errata about parts that the single header does not have.
    """

    def __init__(
        self,
        rename: Callable[[str], str],
        is_absent: Callable[[str], bool],
        note_on_choice: str,
        absent_errata: Collection[str],
    ) -> None:
        self._absent_errata = tuple(f"Erratum: {title}" for title in absent_errata)
        self._rename = rename
        self._is_absent = is_absent
        self._note_on_choice = note_on_choice

    def adapt(self, comment: str, *, with_arguments: bool) -> str:
        """Return a comment with the names of this header, without sentences about parts that the header does not have.

        Unless ``with_arguments`` is True, it ends before its first ``@param``.
        """
        lines: list[str] = []
        for paragraph in split_paragraphs(comment_lines(comment)):
            if paragraph[0].startswith("@") and not with_arguments:
                break
            lines += self._adapt_paragraph(paragraph)
        return as_comment(lines)

    def adapt_member(self, comment: re.Match[str]) -> str:
        """Return the comment above a member, without sentences about parts that the header does not have."""
        marked_comment = comment[0]
        margin = " " * (len(marked_comment) - len(marked_comment.lstrip()))
        lines = comment_lines(marked_comment.strip())
        comment_text = " ".join(lines).strip()
        sentences = SENTENCE_END.split(_NAME_OF_ERRATUM.sub("", comment_text))
        kept_sentences = [sentence for sentence in sentences if not self._is_about_absent(sentence)]
        if any(sentence.startswith(_CHOICE) for sentence in sentences):
            kept_sentences.append(self._note_on_choice)
        new_text = self._rename(" ".join(kept_sentences))
        return member_comment(new_text, margin)

    def _adapt_paragraph(self, lines: list[str]) -> list[str]:
        """Return the lines of a paragraph without sentences about parts that the header does not have.

        The result is empty if no sentence is left. In an indented line, such as one of a picture, only names change.
        """
        paragraph = " ".join(lines)
        if lines[0].startswith((" ", "@")) or not paragraph:
            return [self._rename(line) for line in lines]
        if paragraph.startswith((*_OTHER_PARAGRAPHS, *self._absent_errata)):
            return []
        sentences = SENTENCE_END.split(_NAME_OF_ERRATUM.sub("", paragraph))
        kept_sentences = [sentence for sentence in sentences if not self._is_about_absent(sentence)]
        new_text = self._rename(" ".join(kept_sentences))
        return lines if new_text == paragraph else wrap_text(new_text)

    def _is_about_absent(self, sentence: str) -> bool:
        """Return True if a sentence is about a part that this header does not have.

        Examples are other headers, the parameter ``code`` of a macro, and names that were left out.
        """
        if sentence.startswith(_OTHER_SENTENCES) or _ABOUT_ABSENT.search(sentence) is not None:
            return True
        return any(map(self._is_absent, C_IDENTIFIER.findall(sentence)))


def member_comment(text: str, margin: str) -> str:
    """Return the comment on a member of a struct, with ``/*`` and ``*/`` on the lines of the text."""
    single_line = f"{margin}/* {text} */\n"
    # Its line break counts too, which leaves room for Doxygen's mark, longer by one character.
    if len(single_line) <= COLUMNS:
        return single_line
    # A placeholder instead of a space keeps the mark at the end on the line of the last word.
    unbreakable_space = "\0"
    lines = wrap_text(f"{text}{unbreakable_space}*/", COLUMNS - 1, first_margin=f"{margin}/* ", margin=f"{margin} * ")
    return "".join(f"{line}\n" for line in lines).replace(unbreakable_space, " ")


def first_sentence(comment: str) -> str:
    """Return the first sentence of a comment from the runtime."""
    sentence, *_ = SENTENCE_END.split(" ".join(comment_lines(comment)).strip())
    return as_comment(wrap_text(sentence))


def first_paragraph(comment: str) -> str:
    """Return the first paragraph of a comment from the runtime, or if it has a picture, its text up to the picture.

    A picture follows ``:`` and a blank line. It is included unless it is an example that calls the runtime.
    """
    text_before_picture, _, picture_and_rest = "\n".join(comment_lines(comment)).partition(":\n\n")
    # An empty line ends a picture, and a paragraph.
    picture, _, _ = picture_and_rest.partition("\n\n")
    text_on_one_line = text_before_picture.replace("\n", " ")
    if picture_and_rest and "cw_" in picture:
        return as_comment(wrap_text(f"{text_on_one_line}."))
    if picture_and_rest:
        return as_comment([*wrap_text(f"{text_on_one_line}:"), "", *picture.splitlines()])
    first_paragraph, _, _ = text_before_picture.partition("\n\n")
    # The parameters of a function can follow on the next line.
    description, _, _ = first_paragraph.partition("\n@")
    return as_comment(wrap_text(description.replace("\n", " ")))


def without_example(comment: str) -> str:
    """Return a comment from the runtime without the example that follows its first sentence, if there is one."""
    comment_text = "\n".join(comment_lines(comment))
    text_before_example, example_begins, example_and_text = comment_text.partition(":\n\n")
    if not example_begins:
        return comment
    _, _, text_after_example = example_and_text.partition("\n\n")
    sentence = text_before_example.replace("\n", " ") + "."
    return as_comment([*wrap_text(sentence), "", *text_after_example.splitlines()])


def wrap_text(text: str, width: int = COMMENT_WIDTH, first_margin: str = "", margin: str = "") -> list[str]:
    """Return the lines of a text with whole words. ``first_margin`` begins the first line, ``margin`` the others."""
    wrapper = textwrap.TextWrapper(width, initial_indent=first_margin, subsequent_indent=margin)
    wrapper.break_long_words = wrapper.break_on_hyphens = False
    return wrapper.wrap(text)


def comment_lines(comment: str) -> list[str]:
    """Return the lines of a comment without ``/**``, ``*/`` and the ``*`` in front. Indentation is kept."""
    if not comment:
        return []
    lines = comment.rstrip().removeprefix("/**").removesuffix("*/").strip("\n").splitlines()
    return [line.strip().removeprefix("*").removeprefix(" ") for line in lines]


def split_paragraphs(lines: Iterable[str]) -> Iterator[list[str]]:
    """Yield the lines of each paragraph of a comment. A line that begins with a space or @ is a separate paragraph.

    A line is the last one of its paragraph if the first word of the next line would have fit on it.
    """
    paragraph: list[str] = []
    for line in lines:
        first_word = line.partition(" ")[0]
        # 1 is the space before the word.
        is_line_full = bool(paragraph) and len(paragraph[-1]) + 1 + len(first_word) > COMMENT_WIDTH
        goes_on = is_line_full and bool(first_word) and not line.startswith("@")
        if paragraph and not goes_on:
            yield paragraph
            paragraph = []
        paragraph.append(line)
        if line.startswith((" ", "@")) or not line:
            yield paragraph
            paragraph = []
    if paragraph:
        yield paragraph


def as_comment(lines: list[str]) -> str:
    """Return lines as a comment with the marks of Doxygen, or an empty string without lines."""
    text = "\n".join(lines).strip("\n")
    if not text:
        return ""
    # 7 characters are the marks of a comment on one line.
    if "\n" not in text and len(text) <= COLUMNS - 7:
        return f"/** {text.strip()} */\n"
    body = "\n".join(f" * {line}".rstrip() for line in text.splitlines())
    return f"/**\n{body}\n */\n"


class SingleUsage:
    """How to read a position with a single header.

    ``named`` returns a text with the names of the single header in place of those in the normal header.
    """

    def __init__(self, view: DeviceView, named: Callable[[str], str]) -> None:
        self.view = view
        self._named = named

    @property
    def request(self) -> StructCodec | None:
        """The frame that requests the position, or None if there is no such frame.

        Over SPI, it is the frame that the macro of the request names.
        """
        usage = self.view.usage
        if usage is not None and usage.request_for_reply is not None:
            return usage.request_for_reply.codec
        exchanged = self.view.interface.position_request.removeprefix(f"{self.view.PREFIX}_REQUEST_").lower()
        requests = (codec for codec in self.view.interface.codecs if codec.struct.layout.name == exchanged)
        return next(requests, None)

    @property
    def reply_bytes(self) -> int:
        """Number of bytes in the reply with the position, 0 without such a reply."""
        usage = self.view.usage
        if usage is None:
            return 0
        parameters = self.view.device.variants[0].parameters
        bits = usage.frame.struct.layout.bits.value(parameters)
        # Bits to bytes, rounded up.
        return (bits + 7) // 8

    @property
    def replies_later(self) -> bool:
        """True if a reply over SPI comes with the word after its request."""
        interface = self.view.context.interface
        return isinstance(interface, Spi) and interface.reply == "next_word"

    @property
    def is_from_manual(self) -> bool:
        """True if the facts come from the manual of the encoder, and not from other documents or programs."""
        return word_for_document(self.view.device) == "manual"

    @property
    def request_bytes(self) -> str:
        """The bytes of a request that is always the same, such as ``FFh FFh``, or an empty string."""
        if self.request is None:
            return ""
        layout = self.request.struct.layout
        fields = layout.fields
        if not layout.sent_bits.is_constant:
            return ""
        number = 0
        for field in fields:
            if field.fixed_value is None:
                return ""
            number |= field.fixed_value << field.low.constant
        number_of_bytes = (layout.sent_bits.constant + 7) // 8
        return " ".join(f"{byte:02X}h" for byte in number.to_bytes(number_of_bytes, "big"))

    @property
    def pause_macro(self) -> str:
        """The macro for the shortest pause between two words over SSI, or an empty string if it is not known."""
        timings = self.view.context.interface.timings
        is_known = any(timing.name == "pause" and timing.at_least_us is not None for timing in timings)
        return self._named(f"{self.view.PREFIX}_PAUSE_AT_LEAST_US") if is_known else ""

    @property
    def lacks_pause(self) -> bool:
        """True if the spec has no times of the interface and says nothing about the pause between two words."""
        interface = self.view.context.interface
        return not interface.timings and not mentions(self.view.device, interface, Topic.PAUSE)

    @property
    def ignored_numbers(self) -> tuple[str, ...]:
        """Names of the numbers that affect neither the position nor the verdict, such as a life counter."""
        frame = self.view.position_reader.frame
        if frame is None:
            return ()
        position_name = self.view.device.position_name(self.view.context.interface.name)
        layouts = frame.whole_frame.layouts if frame.whole_frame is not None else (frame.struct.layout,)
        parts_of_position = {position_name}
        for layout in layouts:
            parts_of_position.update(*(join.fields for join in layout.joins if join.name == position_name))
        fields = chain.from_iterable(layout.data_fields for layout in layouts)
        numbers = (field for field in fields if is_number(meaning_of(field)) and field.equals is None)
        return tuple(c_name(field.name) for field in numbers if field.name not in parts_of_position)

    @property
    def function_for_all_fields(self) -> str:
        """The function that returns all fields of a frame: of a word, or of all data channels from the buffer."""
        frame = self.view.position_reader.frame
        assert frame is not None
        if frame.whole_frame is not None and self.view.channels is not None:
            return self._named(f"{self.view.channels.type}_receive")
        return self._named(f"{frame.name}_decode")


#: A condition on one line, after which the function only returns a result.
_GUARD = re.compile(r"^(?P<condition> +if \(.*\) \{)\n +(?P<result>return [^;\n]*;)\n +\}\n(?! *else)", re.MULTILINE)


def with_signature_on_one_line(c_code: str) -> str:
    """Return a C function with its signature on one line, from the macros that mark it to its parameters.

    The macros are on a separate line if they and the name of the function are too long for one line. ``break_lines``
    breaks the parameters again if necessary. Other code is returned unchanged.
    """
    function = re.match(r"(?P<marks>(?:CW_[A-Z]+[ \n])*)(?P<signature>static inline [^{;]*\))\n\{", c_code)
    if function is None:
        return c_code
    marks = function["marks"].replace("\n", " ")
    with_first_parameter = function["signature"].replace("(\n    ", "(")
    signature = re.sub(r"\n +", " ", with_first_parameter)
    body = c_code[function.end("signature") :]
    type_and_name, _, _ = signature.partition("(")
    if len(marks + type_and_name) >= COLUMNS:
        return f"{marks.rstrip()}\n{signature}{body}"
    return f"{marks}{signature}{body}"


def with_short_conditions(c_code: str) -> str:
    """Return a C function in which each condition that only returns a result is on one line, if it fits."""
    return _GUARD.sub(_on_one_line, c_code)


def _on_one_line(guard: re.Match[str]) -> str:
    """Return a condition and its result on one line, or unchanged if that is too long or has a comment."""
    line = f"{guard['condition']} {guard['result']} }}"
    return guard[0] if len(line) > COLUMNS or "/*" in line else f"{line}\n"


def refilled_macro(c_code: str) -> str:
    """Return a macro whose lines after the first, if any, are joined and broken again at the width of a header."""
    first_line, *body = (line.removesuffix("\\").rstrip() for line in c_code.splitlines())
    if not body:
        return c_code
    joined_body = " ".join(line.strip() for line in body)
    # 2 characters are the space and the backslash at the end of a line.
    lines = wrap_text(joined_body, COLUMNS - 2, first_margin=" " * 4, margin=" " * 8)
    return " \\\n".join((first_line, *lines)) + "\n"
