"""Runtime code that a single header leaves out, because the highest length of its word is known."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass

from .. import TargetError

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
    varies: bool

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
        condition = _RECEIVED_SLOWLY if length.varies else "received < 57U"
        return _replace_block(runtime, _RECEIVED_SLOWLY, replacement=_REFUSAL.format(condition=condition))
    if length.most_bits > _MOST_BITS_LOADED_AT_ONCE and not length.varies:
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
