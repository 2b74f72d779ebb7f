"""Decode frames from text that a user types or pastes, as bytes or as numbers.

Ambiguous text is rejected.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from ...language.document import visible
from ...language.problems import quoted
from ...model import (
    INTERFACES,
    Device,
    Layout,
    PlacedChannels,
    PlacedLayout,
    Variant,
    number_to_bytes,
)
from ...model.layout import differ_in_length
from ...reference import codec
from ...reference.registers import decode_register
from ...say import frame_texts
from ...why.hypotheses import TypedFrame
from .digits import (
    are_several_numbers,
    bits_of_bytes,
    meanings_of_array,
    meanings_of_decimal_bytes,
    meanings_of_long_number,
    possible_meanings,
    with_leading_zeros,
    with_prefix,
    with_two_digits,
)

_HEX_NUMBER = re.compile(r"(?:0x)?[0-9A-Fa-f]+", re.IGNORECASE)
_GAPS_IN_NUMBERS = re.compile(r"[\s_]")
_BINARY_NUMBER = re.compile(r"0[bB][01]+")
_PREFIXED_HEX = re.compile(r"0[xX][0-9A-Fa-f]+")
_WHOLE_BYTES = re.compile(r"(?:0x)?((?:[0-9A-F]{2})+)", re.IGNORECASE)
#: A single number with its prefix, such as ``0x1F``.
_LONE_PREFIXED_NUMBER = re.compile(r"0[xXbB][0-9A-Fa-f]+")
_PASTED_FORMS = tuple((re.compile(pattern), replacement) for pattern, replacement in frame_texts.PASTED)
_TIME_STAMP = re.compile(frame_texts.TIME)
_ODD_BLANKS = re.compile(frame_texts.ODD_BLANKS)


class FrameTextError(ValueError):
    """The text is not a frame. The message shows the accepted forms."""


class FrameLine(NamedTuple):
    """A frame as text, with its line number (None for a single frame) and the time that precedes it, or ``""``."""

    number: int | None
    time: str
    text: str


def frame_lines(lines: Iterable[str]) -> Iterator[FrameLine]:
    """Yield the frames in some lines, one per line, with their line numbers from 1 and the times before them.

    Comments after ``#`` are removed, and empty lines are skipped. A byte order mark counts as a space.
    """
    for line_number, line in enumerate(lines, 1):
        before_comment, _, _ = _ODD_BLANKS.sub(" ", line).partition("#")
        time_and_frame = before_comment.strip()
        time = _TIME_STAMP.match(time_and_frame)
        if time:
            yield FrameLine(number=line_number, time=time[1], text=time_and_frame[time.end() :])
        elif time_and_frame:
            yield FrameLine(number=line_number, time="", text=time_and_frame)


def undecorated(frame_text: str) -> str:
    """Return the text of a frame without the brackets, quotes and suffixes of the program that it was copied from.

    ``{0x1Fu, 2Ah}`` becomes ``0x1F  0x2A``. A plain number with a prefix, such as ``0x1F2A``, is returned as it is.

    Raises:
        FrameTextError: The text is empty or longer than any frame, or an array of numbers that may be decimal or hex.
    """
    if len(frame_text) > frame_texts.LONGEST:
        raise FrameTextError(frame_texts.TOO_LONG)
    if _LONE_PREFIXED_NUMBER.fullmatch(frame_text):
        return frame_text
    meanings = meanings_of_array(frame_text)
    if meanings:
        raise _decimal_bytes_error(frame_text, meanings)
    frame_text = with_two_digits(frame_text)
    # Brackets, quotes and commas become spaces, ``b`` and ``u`` are removed, ``\x1F`` and ``1Fh`` become ``0x1F``.
    for pattern, replacement in _PASTED_FORMS:
        frame_text = pattern.sub(replacement, frame_text)
    frame_text = frame_text.strip()
    if not frame_text:
        raise FrameTextError(frame_texts.EMPTY)
    return frame_text


def _decimal_bytes_error(frame_text: str, meanings: Sequence[str]) -> FrameTextError:
    """Return the error for numbers that may be bytes in decimal. ``meanings`` says how to write each meaning."""
    return FrameTextError(frame_texts.decimal_bytes_message(quoted(visible(frame_text)), ", ".join(meanings)))


def frame_bytes(frame_text: str) -> bytes:
    """Return the bytes in a hex text such as ``1F 2A`` or ``1F2A``. Each piece between spaces consists of whole bytes.

    A piece may begin with ``0x``. A single digit is a byte if it follows ``0x``, or if all pieces have no leading
    zeros.

    Raises:
        FrameTextError: A piece is not hex, or has an odd number of digits, or the bytes are decimal.
    """
    frame = b""
    pieces = with_leading_zeros(frame_text.split())
    are_binary = sum(_BINARY_NUMBER.fullmatch(piece) is not None for piece in pieces) > 1
    meanings = meanings_of_decimal_bytes(frame_text.split())
    if len(meanings) == 1:
        raise _decimal_bytes_error(frame_text, meanings)
    for piece in pieces:
        quoted_piece = quoted(visible(piece))
        if are_binary or not _HEX_NUMBER.fullmatch(piece):
            raise FrameTextError(frame_texts.not_hex_message(quoted_piece))
        has_prefix = piece[:2] in ("0x", "0X")
        digits = piece[2:] if has_prefix else piece
        if len(digits) == 1 and has_prefix:
            digits = f"0{digits}"
        elif len(digits) == 1:
            raise FrameTextError(frame_texts.one_digit_message(quoted_piece, digits))
        elif len(digits) % 2:
            is_above_byte = len(pieces) > 1 and not has_prefix and digits.isdecimal() and int(digits) > 0xFF
            message_of = frame_texts.above_byte_message if is_above_byte else frame_texts.odd_digits_message
            raise FrameTextError(message_of(quoted_piece))
        frame += bytes.fromhex(digits)
    return frame


def placed_bytes(placed_layout: PlacedLayout, variant: Variant, frame_text: str) -> bytes:
    """Return the bytes of a frame that is described in bytes. The text contains hex bytes or one binary number.

    If the line carries bits, the binary number must contain every bit that is sent. If it carries bytes, the number is
    converted in the byte order of the layout, and its leading zeros may be missing.

    Raises:
        FrameTextError: The text has a different form, or the wrong number of bits.
    """
    bits = placed_layout.layout.sent_bits.value(placed_layout.parameters)
    line_carries_bytes = INTERFACES[variant.interface].carried_as == "bytes"
    digits = bits_of_bytes(frame_text, bits, line_carries_bytes=line_carries_bytes)
    if not digits:
        return frame_bytes(frame_text)
    if line_carries_bytes:
        return number_to_bytes(placed_layout.layout, int(digits, 2), placed_layout.bits)
    # The line may carry fewer bits than the bytes of the frame have. The first bits are then zeros that are not sent.
    byte_count = placed_layout.bits // 8
    if len(digits) != bits:
        quoted_text = quoted(visible(frame_text))
        remedy = frame_texts.write_bits(str(bits), str(byte_count))
        raise FrameTextError(frame_texts.no_bits_message(quoted_text, str(bits), remedy))
    return int(digits, 2).to_bytes(byte_count, "big")


def frame_number(placed: PlacedLayout | PlacedChannels, frame_text: str, *, exact: bool = False) -> TypedFrame:
    """Return a frame written as one number: ``0b`` and every bit, ``0x`` and hex digits, or bytes such as ``01 2A``.

    ``0b`` determines the number of bits (``exact`` in the result). Hex digits do not, because the frame may begin with
    more zeros. If frames of the sender have different lengths (``exact`` is true), the number of bytes also determines
    it, unless it is the number that the layout needs. Digits without a prefix are accepted if they have only one
    possible meaning.

    Raises:
        FrameTextError: The text has a different form.
    """
    if are_several_numbers(frame_text.replace("_", "").split(), placed.bits):
        raise _number_error(placed, frame_text, frame_texts.write_separately(str(placed.bits)))
    prefixed_text = with_prefix(frame_text, placed.bits)
    without_gaps = _GAPS_IN_NUMBERS.sub("", prefixed_text)
    if _BINARY_NUMBER.fullmatch(without_gaps):
        bits = len(without_gaps) - len("0b")
        return TypedFrame(int(without_gaps, 2), bits, is_length_known=True, digit_bits=bits)
    pieces = prefixed_text.split()
    are_bytes = len(pieces) > 1 and all(map(_WHOLE_BYTES.fullmatch, pieces))
    if are_bytes:
        _reject_zeros_and_ones(pieces, frame_text)
        # Each byte may have its own prefix.
        hex_bytes = [_WHOLE_BYTES.sub(r"\1", piece) for piece in pieces]
        without_gaps = "0x" + "".join(hex_bytes)
        bits = 4 * (len(without_gaps) - len("0x"))
        needed_bytes = (placed.bits + 7) // 8
        if exact and bits // 8 != needed_bytes:
            return TypedFrame(int(without_gaps, 16), bits, is_length_known=True, digit_bits=bits)
    if _PREFIXED_HEX.fullmatch(without_gaps):
        return _hex_frame(without_gaps, is_bytes=are_bytes)
    if len(pieces) == 1:
        return _number_without_prefix(placed, without_gaps, frame_text)
    meanings = meanings_of_decimal_bytes(pieces)
    if meanings:
        raise _decimal_bytes_error(frame_text, meanings)
    raise _number_error(placed, frame_text, frame_texts.write_number(str(placed.bits)))


def _hex_frame(prefixed_digits: str, *, is_bytes: bool) -> TypedFrame:
    """Return the frame in hex digits after ``0x``, which may have more leading zeros than the digits."""
    number = int(prefixed_digits, 16)
    digit_bits = 4 * (len(prefixed_digits) - len("0x"))
    return TypedFrame(number, number.bit_length(), is_length_known=False, digit_bits=digit_bits, is_bytes=is_bytes)


def typed_bits(device: Device, placed_layout: PlacedLayout, frame_text: str, *, exact: bool = False) -> TypedFrame:
    """Return a frame written as one number, as ``frame_number`` does, or the first bits of one if bytes are missing.

    Bytes such as ``50 FC`` usually have all their zeros, so a frame of 24 bits then lacks its last bits, not its
    leading zeros. A number such as ``0x50FC`` may lack zeros, and so may bytes that are valid by their CRC. Bits that
    begin with a 1 are read as they are, but a program may have printed them without leading zeros. The decode page
    follows the same rule.

    Raises:
        FrameTextError: The text has a different form.
    """
    typed_frame = frame_number(placed_layout, frame_text, exact=exact)
    lacks_bytes = typed_frame.digit_bits // 8 < (placed_layout.bits + 7) // 8
    lacks_bits = typed_frame.is_length_known and typed_frame.bits < placed_layout.bits
    may_lack_zeros = lacks_bits and typed_frame.number.bit_length() == typed_frame.bits
    if not may_lack_zeros and not (typed_frame.is_bytes and lacks_bytes):
        return typed_frame
    is_valid = not codec.decode(device, placed_layout, typed_frame.number).problems
    if may_lack_zeros:
        return replace(
            typed_frame, text_with_zeros=f"0b{typed_frame.number:0{placed_layout.bits}b}" if is_valid else ""
        )
    if is_valid and device.crc_of(placed_layout) is not None:
        return typed_frame
    padded = f"0x{typed_frame.number:0{(placed_layout.bits + 3) // 4}X}" if is_valid else ""
    return replace(typed_frame, bits=typed_frame.digit_bits, is_length_known=True, text_with_zeros=padded)


def _number_without_prefix(placed: PlacedLayout | PlacedChannels, digits: str, frame_text: str) -> TypedFrame:
    """Return a frame from digits without a prefix that can only be bits or a decimal number.

    Raises:
        FrameTextError: The digits have several possible meanings, or none.
    """
    meanings = list(possible_meanings(digits, placed.bits))
    if meanings == [frame_texts.if_bits(digits)]:
        return TypedFrame(int(digits, 2), len(digits), is_length_known=True, digit_bits=len(digits))
    # Hex digits with only one meaning already have a prefix, unless it is misspelled.
    if len(meanings) == 1 and digits.isdecimal():
        number = int(digits)
        return TypedFrame(number, number.bit_length(), is_length_known=False)
    if not meanings:
        meanings = list(meanings_of_long_number(digits))
    if meanings:
        remedy = frame_texts.write_one_of(", ".join(meanings))
    else:
        remedy = frame_texts.write_number(str(placed.bits))
    raise _number_error(placed, frame_text, remedy)


def _number_error(placed: PlacedLayout | PlacedChannels, frame_text: str, remedy: str) -> FrameTextError:
    """Return the error for a text that is not a number of the frame's bits."""
    quoted_text = quoted(visible(frame_text))
    pieces = frame_text.split()
    meanings = meanings_of_decimal_bytes(pieces)
    is_whole_frame = meanings and len(pieces) == (placed.bits + 7) // 8
    if is_whole_frame and int.from_bytes(map(int, pieces), "big") >> placed.bits == 0:
        return _decimal_bytes_error(frame_text, meanings)
    return FrameTextError(frame_texts.no_bits_message(quoted_text, str(placed.bits), remedy))


def _reject_zeros_and_ones(pieces: Sequence[str], frame_text: str) -> None:
    """Raise ``FrameTextError`` if pieces such as ``10 01 11`` could be either bits or bytes.

    This is possible if all digits are 0 or 1, and no piece has a prefix.
    """
    are_zeros_and_ones = set("".join(pieces)) <= {"0", "1"}
    if are_zeros_and_ones:
        raise FrameTextError(frame_texts.bits_or_bytes_message(quoted(visible(frame_text))))


# -- decoding


def decode_text(
    device: Device, variant: Variant, sender: str, text: str, layout_name: str | None = None
) -> codec.DecodedFrame:
    """Decode a frame given as text.

    Args:
        device: The family.
        variant: The order code.
        sender: ``encoder`` or ``master``.
        text: Hex bytes for a line that carries bytes. For a line that carries bits, one number: ``0b`` with every
            digit, or ``0x``.
        layout_name: The name of the layout. By default, this is the layout that the frame identifies by its selector or
            its length, or the first layout of the sender.

    Raises:
        FrameTextError: The text cannot be read as a frame, or the layout does not exist.
    """
    decode = text_decoder(device, variant, sender, layout_name)
    return decode(text)


def text_decoder(
    device: Device, variant: Variant, sender: str, layout_name: str | None
) -> Callable[[str], codec.DecodedFrame]:
    """Return a function that decodes the text of one frame.

    If ``layout_name`` is None, each frame identifies its layout by its selector or its length. If the layout does not
    exist, the function raises ``FrameTextError`` for every frame.
    """
    layouts = layouts_of_sender(device, variant, sender)
    possible_layouts = [layout for layout in layouts if layout_name in (None, layout.name)]
    first_layout = possible_layouts[0].place(variant.parameters) if possible_layouts else None
    # If layouts differ in length, the number of bits identifies the layout.
    is_exact = differ_in_length(layouts, sender)

    def decode(text: str) -> codec.DecodedFrame:
        """Decode a frame with the named layout, or with the layout that the frame identifies."""
        frame_text = undecorated(text)
        if first_layout is None:
            raise FrameTextError(_no_layout_message(device, variant, sender, layout_name))
        if layout_name is None and first_layout.layout.in_bytes:
            frame = placed_bytes(first_layout, variant, frame_text)
            # The codec finds the layout by the selector in the bytes, or by their number.
            return codec.decode_bytes(device, variant, sender, frame)
        placed_layout = first_layout
        if layout_name is None and is_exact:
            placed_layout = _layout_of_length(frame_text, first_layout, layouts, variant)
        return decode_as(device, variant, placed_layout, frame_text, exact=is_exact)

    return decode


def layouts_of_sender(device: Device, variant: Variant, sender: str) -> list[Layout]:
    """Return the layouts of the frames that the sender, encoder or master, sends over the interface of the variant."""
    return [layout for layout in device.interface(variant.interface).layouts if layout.sender == sender]


def _no_layout_message(device: Device, variant: Variant, sender: str, name: str | None) -> str:
    """Return the message about a sender without frames, or without a layout of this name.

    If the other sender has a layout of this name, the message says how to choose that sender.
    """
    interface = device.interface(variant.interface)
    known_layouts = layouts_of_sender(device, variant, sender)
    if not known_layouts:
        return f"the manual describes no frame from the {sender} over {interface.title}"
    other_senders = [layout.sender for layout in interface.layouts if layout.name == name]
    hint = f" (add --from {other_senders[0]})" if other_senders else ""
    known_names = ", ".join(layout.name for layout in known_layouts)
    return f"{variant.code} has no layout '{name}' from the {sender}{hint}; it has: {known_names}"


def decode_register_text(device: Device, variant: Variant, name: str, frame_text: str) -> codec.DecodedFrame:
    """Decode the value of the register ``name`` from hex bytes in ascending order of address.

    Raises:
        FrameTextError: The text does not consist of hex bytes.
        RegisterError: The register does not exist, or it has a different length.
    """
    return decode_register(device, variant, name, frame_bytes(undecorated(frame_text)))


def _layout_of_length(
    frame_text: str, first_layout: PlacedLayout, layouts: Sequence[Layout], variant: Variant
) -> PlacedLayout:
    """Return the layout whose length matches the text: ``first_layout`` if it does, or the only other one that does.

    If no other layout matches, or several do, it is also ``first_layout``, and the decoder reports the wrong length.
    """
    if _has_length(first_layout, frame_text):
        return first_layout
    placed_layouts = [layout.place(variant.parameters) for layout in layouts]
    fitting_layouts = [layout for layout in placed_layouts if _has_length(layout, frame_text)]
    return fitting_layouts[0] if len(fitting_layouts) == 1 else first_layout


def _has_length(placed_layout: PlacedLayout, frame_text: str) -> bool:
    """Return whether the number of bits in a text matches a layout.

    A layout of 24 bits matches ``0b`` with 24 digits, three bytes such as ``1F 2A 3B``, and numbers such as ``0x1F2A``
    of at most 24 bits, whose leading zeros may be missing. It does not match ``1F 2A``, which is exactly 16 bits.
    """
    # The frames of the sender have different lengths, so the number of hex bytes determines the length.
    frame = frame_number(placed_layout, frame_text, exact=True)
    bits = placed_layout.layout.sent_bits.value(placed_layout.parameters)
    has_known_length = frame.is_length_known
    return frame.bits == bits if has_known_length else frame.bits <= bits


def decode_as(
    device: Device, variant: Variant, placed_layout: PlacedLayout, frame_text: str, *, exact: bool
) -> codec.DecodedFrame:
    """Decode the text of a frame, without brackets and quotes, with a known layout.

    ``exact`` means that frames of the sender have different lengths, so that the number of hex bytes determines the
    length of the frame.

    Raises:
        FrameTextError: The text cannot be read as a frame.
    """
    if placed_layout.layout.in_bytes:
        frame_in_bytes = placed_bytes(placed_layout, variant, frame_text)
        return codec.decode_placed(device, placed_layout, frame_in_bytes)
    typed_frame = typed_bits(device, placed_layout, frame_text, exact=exact)
    if typed_frame.is_length_known:
        return codec.decode_bits(device, placed_layout, typed_frame.number, typed_frame.bits)
    has_too_many_bits = typed_frame.number >> placed_layout.bits != 0
    if typed_frame.is_bytes and has_too_many_bits:
        return codec.decode_bits(device, placed_layout, typed_frame.number, typed_frame.digit_bits)
    return codec.decode(device, placed_layout, typed_frame.number)
