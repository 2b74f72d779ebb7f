"""The texts of C headers: those of the runtime, the declarations in a header, and code that can be cut from it."""

from __future__ import annotations

import dataclasses
import re
import textwrap
from collections.abc import Collection, Iterable, Iterator, Sequence, Set
from functools import cache
from importlib import resources
from itertools import chain

from ...model.record import dataclass
from .. import TargetError
from .names import FOLDER


@cache
def runtime_headers() -> dict[str, str]:
    """Return the texts of the headers by their file names."""
    return _read_texts(FOLDER)


@cache
def runtime_tests() -> dict[str, str]:
    """Return the texts of the self-tests of the headers by their file names."""
    return _read_texts("selftest")


@cache
def runtime_version() -> tuple[int, int]:
    """Return the major and minor version of the headers."""
    text = runtime_headers()["version.h"]
    numbers = dict(re.findall(r"#define CW_RUNTIME_(MAJOR|MINOR) (\d+)", text))
    return int(numbers["MAJOR"]), int(numbers["MINOR"])


def _read_texts(folder: str) -> dict[str, str]:
    """Return the texts of the files in a folder of the C runtime, by their file names in alphabetical order."""
    texts_folder = resources.files("codewheel.runtime") / "c" / folder
    paths = sorted(texts_folder.iterdir(), key=lambda path: path.name)
    return {path.name: path.read_text(encoding="utf-8") for path in paths}


#: Headers for every encoder: order codes, results, and the use of positions.
_FOR_ALL = ("bits.h", "result.h", "result.hpp", "encoder.h", "angle.h", "tracker.h")
_RUNTIME_INCLUDE = re.compile(rf'^#include "(?:{FOLDER}/)?(\w+\.hp*)"', re.MULTILINE)


def needed_runtime(headers_of_interfaces: Iterable[str]) -> dict[str, str]:
    """Return the texts of the headers of the runtime that some interfaces need, by their file names.

    They are the headers for all encoders, those for the interfaces, those for the self-tests, and all headers that
    these include.
    """
    texts_by_header = runtime_headers()
    unvisited_headers = [*_FOR_ALL, *headers_of_interfaces]
    for test_text in runtime_tests().values():
        unvisited_headers += _RUNTIME_INCLUDE.findall(test_text)
    needed_headers: set[str] = set()
    while unvisited_headers:
        header = unvisited_headers.pop()
        if header not in needed_headers:
            needed_headers.add(header)
            unvisited_headers += _RUNTIME_INCLUDE.findall(texts_by_header[header])
    return {header: text for header, text in texts_by_header.items() if header in needed_headers}


_C_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_C_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_DEFINED_MACRO = re.compile(r"^#define (\w+)", re.MULTILINE)
#: The constant of an enumeration, in the line with its value.
_ENUMERATION_CONSTANT = re.compile(r"^ +(\w+) = ", re.MULTILINE)
_PREPROCESSOR_CONDITION = re.compile(r"#(if|el|endif)")
_FUNCTION_NAME = re.compile(r"(\w+)\(")
#: What opens and closes the scope of C in a header.
_OPENS_C, _CLOSES_C = 'extern "C" {\n#endif\n', "#ifdef __cplusplus\n}\n#endif\n"


@dataclass(frozen=True, slots=True)
class Declaration:
    """A function, type, constant or macro in a header, with the comment above it.

    A comment alone and the title of a section are declarations without code.
    """

    comment: str
    code: str

    @property
    def text(self) -> str:
        """The comment and the code."""
        return self.comment + self.code

    @property
    def is_title(self) -> bool:
        """True if it is the title of a section."""
        return self.comment.startswith("/* -- ")

    @property
    def plain_code(self) -> str:
        """The code without comments."""
        return _C_COMMENT.sub("", self.code)

    @property
    def names(self) -> tuple[str, ...]:
        """The names that it declares.

        For a condition such as ``#ifdef``, these are the names declared inside it. For an enumeration, they are its
        type and its constants.
        """
        code = self.plain_code
        if code.startswith("#if"):
            return self._names_inside_condition
        # #define X_BITS 12
        macros = tuple(_DEFINED_MACRO.findall(code))
        if macros:
            return macros
        # typedef enum { X_READ = 1 } x_mode;
        if code.startswith("typedef"):
            last_line = code.rstrip().splitlines()[-1]
            constants = _ENUMERATION_CONSTANT.findall(code) if code.startswith("typedef enum") else []
            return (*_last_identifier(last_line), *constants)
        code_before_body, _, _ = code.partition("{")
        code_before_value, _, _ = code_before_body.partition("=")
        # static inline uint8_t x_crc(uint32_t bits) {
        function = _FUNCTION_NAME.search(code_before_value)
        if function is not None and "static inline" in code_before_value:
            return (function[1],)
        # static const uint8_t x_table[2] = {0x00U, 0x13U};
        code_before_length, _, _ = code_before_value.partition("[")
        return _last_identifier(code_before_length)

    @property
    def _names_inside_condition(self) -> tuple[str, ...]:
        """The names declared inside a condition such as ``#ifdef``, in alphabetical order."""
        # With the comments, which separate the declarations.
        lines = self.code.splitlines(keepends=True)
        inner_lines = [line for line in lines if not _PREPROCESSOR_CONDITION.match(line)]
        return tuple(sorted(names_of(_parse_declarations(inner_lines))))

    @property
    def used_names(self) -> frozenset[str]:
        """All names in its code."""
        return frozenset(_C_IDENTIFIER.findall(self.plain_code))

    @property
    def is_function(self) -> bool:
        """True if it is a function."""
        return self.code.rstrip().endswith("\n}")

    @property
    def has_macro(self) -> bool:
        """True if it is one or more macros."""
        return self.code.startswith("#define")


def _last_identifier(c_code: str) -> tuple[str, ...]:
    """Return the last identifier in C code as a tuple, which is empty without one: ``x_table`` for ``int x_table``."""
    return tuple(_C_IDENTIFIER.findall(c_code)[-1:])


def declarations_in(header: str) -> list[Declaration]:
    """Return the declarations of a header in their order: those between the braces of ``extern "C"``."""
    body = header.partition(_OPENS_C)[2].rpartition(_CLOSES_C)[0]
    return list(_parse_declarations(body.splitlines(keepends=True)))


def _parse_declarations(lines: Sequence[str]) -> Iterator[Declaration]:
    """Yield the declarations in these lines, each with the comment directly above it.

    A comment with a blank line or another comment below it is a declaration without code. A comment that ends the lines
    is left out.
    """
    comment = ""
    index = 0
    while index < len(lines):
        line = lines[index]
        is_code = not line.startswith("/*") and bool(line.strip())
        if comment and not is_code:
            yield Declaration(comment, code="")
            comment = ""
        if is_code:
            end = _end_of_code(lines, index)
            yield Declaration(comment, code="".join(lines[index:end]))
            comment = ""
        elif line.startswith("/*"):
            end = _end_of_comment(lines, index)
            comment = "".join(lines[index:end])
        else:
            end = index + 1
        index = end


def _end_of_comment(lines: Sequence[str], start: int) -> int:
    """Return the index after the last line of a comment that begins at ``start``."""
    end = start
    while not lines[end].rstrip().endswith("*/"):
        end += 1
    return end + 1


def _end_of_code(lines: Sequence[str], start: int) -> int:
    """Return the index after the last line of a declaration that begins at ``start``.

    The last line is the first one outside braces that ends in a semicolon, or the closing brace.
    """
    if lines[start].startswith("#define"):
        return _end_of_macro(lines, start)
    if lines[start].startswith("#if"):
        return _end_of_condition(lines, start)
    end = start
    open_braces = 0
    while True:
        code = _C_COMMENT.sub("", lines[end]).rstrip()
        open_braces += code.count("{") - code.count("}")
        end += 1
        if open_braces == 0 and (code.endswith(";") or code == "}"):
            return end


def _end_of_macro(lines: Sequence[str], start: int) -> int:
    """Return the index after the last line of a macro that begins at ``start``, which does not end in a backslash."""
    end = start
    while lines[end].endswith("\\\n"):
        end += 1
    return end + 1


def _end_of_condition(lines: Sequence[str], start: int) -> int:
    """Return the index after the ``#endif`` of a condition that begins at ``start``."""
    end = start
    open_conditions = 0
    while True:
        open_conditions += lines[end].startswith("#if") - lines[end].startswith("#endif")
        end += 1
        if open_conditions == 0:
            return end


@dataclasses.dataclass(slots=True)
class _OpenCondition:
    """A condition of the preprocessor whose ``#endif`` has not been read yet.

    ``is_on_setting`` is True if it tests a setting, and ``keeps_lines`` if the lines read now are kept.
    """

    is_on_setting: bool
    keeps_lines: bool


def without_settings(text: str, settings: Collection[str]) -> str:
    """Return the text as the preprocessor would leave it if no macro of ``settings`` is defined.

    Only conditions on these macros are resolved. Lines between ``#ifndef`` and ``#else`` or ``#endif`` stay, and so do
    lines after the ``#else`` of an ``#ifdef``.
    """
    kept_lines: list[str] = []
    conditions: list[_OpenCondition] = []
    for line in text.splitlines(keepends=True):
        directive, _, macro = line.rstrip().partition(" ")
        if directive.startswith("#if"):
            keeps_lines = macro not in settings or directive == "#ifndef"
            conditions.append(_OpenCondition(is_on_setting=macro in settings, keeps_lines=keeps_lines))
        is_directive = directive in {"#ifdef", "#ifndef", "#else", "#endif"}
        # A directive that belongs to a condition on a setting is left out.
        is_left_out = is_directive and bool(conditions) and conditions[-1].is_on_setting
        if is_left_out and directive == "#else":
            conditions[-1].keeps_lines = not conditions[-1].keeps_lines
        if not is_left_out and all(condition.keeps_lines for condition in conditions):
            kept_lines.append(line)
        if directive == "#endif":
            conditions.pop()
    return "".join(kept_lines)


def declarations_needed_by(roots: Iterable[str], declarations: Sequence[Declaration]) -> list[Declaration]:
    """Return the declarations of the names ``roots``, and all declarations that these use, in their order.

    The titles of their sections are included. Names that no declaration has are ignored.
    """
    declaration_by_name: dict[str, Declaration] = {}
    for declaration in declarations:
        declaration_by_name |= dict.fromkeys(declaration.names, declaration)
    unvisited = [name for name in roots if name in declaration_by_name]
    needed_names: set[str] = set()
    while unvisited:
        name = unvisited.pop()
        if name not in needed_names:
            declaration = declaration_by_name[name]
            needed_names.update(declaration.names)
            unvisited += [used_name for used_name in declaration.used_names if used_name in declaration_by_name]
    return list(_select_titled(declarations, needed_names))


def _select_titled(declarations: Iterable[Declaration], needed_names: Set[str]) -> Iterator[Declaration]:
    """Yield the needed declarations, and each title above one of them."""
    title: Declaration | None = None
    for declaration in declarations:
        if declaration.is_title:
            title = declaration
        elif not needed_names.isdisjoint(declaration.names):
            if title is not None:
                yield title
            title = None
            yield declaration


def names_of(declarations: Iterable[Declaration]) -> set[str]:
    """Return all names that these declarations declare."""
    return set(chain.from_iterable(declaration.names for declaration in declarations))


#: Number of bytes that the fast receiver of BiSS frames loads at once.
BYTES_LOADED_AT_ONCE = 8
#: Highest number of bits for which these bytes always contain the whole word and its stop bit.
_MOST_BITS_LOADED_AT_ONCE = 56
_RECEIVED_SLOWLY = "(received < 57U) || (bits == 0U) || (bits > 56U)"
#: The comment is inside the braces, since a condition with a comment stays on lines of its own.
_REFUSAL = """\
    if ({condition}) {{ /* the loads below need 8 bytes */
        return CW_FAULT_LENGTH;
    }}
"""


@dataclass(frozen=True, slots=True)
class WordLength:
    """The highest number of bits of a received word, and the bytes of its buffer.

    ``varies`` is True if registers or answers of the user change the number of bits.
    """

    most_bits: int
    buffer_bytes: int
    is_variable: bool

    @property
    def fits_one_load(self) -> bool:
        """True if the receiver of BiSS words needs only its fast way, which loads 8 bytes at once."""
        return 0 < self.most_bits <= _MOST_BITS_LOADED_AT_ONCE and self.buffer_bytes >= BYTES_LOADED_AT_ONCE


def cut_biss_receiver(runtime: str, length: WordLength) -> str:
    """Return the receiver of BiSS words with only one of its two ways, which depend on the length of the word.

    The fast way refuses a buffer of less than 8 bytes, which the slow way would accept. If the length varies, it also
    refuses lengths that no word of the encoder has.
    """
    if length.fits_one_load:
        condition = _RECEIVED_SLOWLY if length.is_variable else "received < 57U"
        return _replace_block(runtime, _RECEIVED_SLOWLY, replacement=_REFUSAL.format(condition=condition))
    if length.most_bits > _MOST_BITS_LOADED_AT_ONCE and not length.is_variable:
        slow_way = _body_of_block(runtime, _RECEIVED_SLOWLY)
        start = runtime.index(f"    if ({_RECEIVED_SLOWLY})")
        end = runtime.index("\n}\n", start)
        return runtime[:start] + slow_way + runtime[end:]
    return runtime


def cut_ssi_receiver(runtime: str, bits: int) -> str:
    """Return the receiver of SSI words without the ways for words of other lengths."""
    last_byte = bits // 8
    if last_byte == 3:
        # The word is in the first 4 bytes. All that follows the return is for other words.
        start = runtime.index("static inline uint64_t cw_ssi_word(")
        first_line = runtime.index("    const size_t last = ", start)
        end = runtime.index("\n}\n", start)
        one_load = _body_of_block(runtime, "last == 3U").rstrip("\n")
        return runtime[:first_line] + "    const uint32_t bits_in_last = (bits % 8U) + 1U;\n" + one_load + runtime[end:]
    runtime = _replace_block(runtime, "last == 3U", replacement="")
    if last_byte < 3:
        return _replace_block(runtime, "last > 3U", replacement="")
    return _replace_initial_values(runtime, "last > 3U")


def _replace_initial_values(runtime: str, condition: str) -> str:
    """Return the code with the assignments of a block as the initial values of the variables.

    ``int32_t x = 0;`` above ``if (condition) { x = 4; }`` becomes ``int32_t x = 4;`` in place of the block.
    """
    body = _body_of_block(runtime, condition)
    start = _find_block(runtime, condition).start()
    code_before, code_from_block = runtime[:start], runtime[start:]
    for variable in re.findall(r"^    (\w+) = ", body, re.MULTILINE):
        # The last declaration above the block is that of the same function: ``    uint32_t byte = 0U;``.
        pattern = rf"^    (?P<type>\w+) {variable} = .*;\n"
        *_, declaration = re.finditer(pattern, code_before, re.MULTILINE)
        code_before = code_before[: declaration.start()] + code_before[declaration.end() :]
        body = body.replace(f"    {variable} = ", f"    {declaration['type']} {variable} = ", 1)
    return code_before + _replace_block(code_from_block, condition, replacement=body)


def _find_block(c_code: str, condition: str) -> re.Match[str]:
    """Return the only block ``if (condition) {`` of a function, up to its closing brace.

    Raises:
        TargetError: The runtime has no such block, or several.
    """
    pattern = rf"^    if \({re.escape(condition)}\) \{{\n(?P<body>.*?)^    \}}\n"
    blocks = list(re.finditer(pattern, c_code, re.MULTILINE | re.DOTALL))
    if len(blocks) != 1:
        raise TargetError(f"the runtime must have one block with the condition '{condition}', and has {len(blocks)}")
    return blocks[0]


def _body_of_block(c_code: str, condition: str) -> str:
    """Return the lines in a block, indented like the block itself."""
    return textwrap.indent(textwrap.dedent(_find_block(c_code, condition)["body"]), "    ")


def _replace_block(c_code: str, condition: str, replacement: str) -> str:
    """Return the code with other lines in place of a block."""
    block = _find_block(c_code, condition)
    return c_code[: block.start()] + replacement + c_code[block.end() :]
