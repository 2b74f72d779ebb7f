"""Texts of mistakes, for this package and for the script of the decode page."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

#: Texts by name. Numbers in braces are replaced by the details of a frame.
TEXTS: Mapping[str, str] = MappingProxyType(
    {
        "all_inverted": "every bit is inverted, as with swapped data wires",
        "bits_reversed": "the bits are in reverse order",
        "bits_reversed_in_bytes": "the bits of each byte are in reverse order",
        "bytes_reversed": "the bytes are in reverse order",
        "words_swapped": "the two bytes of each 16-bit word are swapped",
        "crc_reversed": "the bits of the CRC are in reverse order",
        "crc_bytes_swapped": "the bytes of the CRC are swapped",
        "and_swapped": "{0}, and its bytes are swapped",
        "status_left_out": "the CRC covers only the bits before error and warning",
        "status_turned": "error and warning were converted to active high",
        "removed_and_idle": "error and warning were removed from the frame, and the CRC is computed as if they were "
        "inactive",
        "removed": "error and warning were removed from the frame, and the CRC covers the rest",
        "covers_binary": "the CRC covers the position in binary, but here it is in Gray code",
        "covers_gray": "the CRC covers the position in Gray code, but here it is already binary",
        "polynomial": "the polynomial is {0}, a {1}-bit CRC",
        "bits_arrived": "{0}, of which only {1} bits arrived",
        "then_zeros": "{0}, followed by zeros",
        "inverted_too": "{0}, and the CRC is inverted",
        "not_inverted_too": "{0}, and the CRC is not inverted",
        "command_left_out": "the first {0} bits, which are sent during the command, are missing",
        "command_idle": "the first {0} bits, which are sent during the command, are all {1}, as if only MISO were "
        "recorded",
        "after_command": "in the bits after the command: {0}",
        "bits": "{0} bits",
        "bits_or_more": "{0} bits or more",
        "of_code": "the frame of {0}",
        "of_two_codes": "the frame of {0} or {1}",
        "of_more_codes": "the frame of {0} and {1} more",
        "of_other_code": "the frame of another order code",
        "of_registers": "the frame that {0} sends when its registers select other widths",
        "read_too_long": ", read {0} too long",
        "read_too_short": ", read {0} too short",
        "extra_byte": "an extra byte",
        "extra_bytes": "{0} extra bytes",
        "before": "{0} before the frame, such as an echo of the request",
        "after": "{0} after the frame",
        "byte_missing": "the first byte ({0}) is missing",
        "last_byte_missing": "the last byte, a part of the CRC, is missing",
        "and_follows": "{0}, and an extra byte follows the frame",
        "bytes_inverted": "every bit is inverted",
        "bytes_missing": "the text has {0} of the {1} bytes of the frame. Missing: {2}",
        "read_as_zeros": "{0}, treated as leading zeros",
        "zeros_left_out": "{0}. If it lacks its leading zeros instead, write {1}",
        "first_byte_left_out": "the CRC does not cover the first byte",
        "line_stuck": "every bit is {0}: the line never changes. Check for {1}, the supply and {2}",
        "line_may_be_stuck": "every bit is {0}. A dead line looks the same, {1}",
        "crc_is_correct": "and the CRC is correct too",
        "has_no_crc": "and there is no CRC to distinguish it",
        "zero_reply": "every bit after the command is 0: the encoder does not drive the line. Check for a short "
        "circuit, the supply and the chip select",
    }
)
#: Bits that BiSS sends before the frame, which a CRC may also cover, with the text.
START_BITS: tuple[tuple[str, str], ...] = (
    ("1", "the CRC also covers the start bit, or a CDS bit of 1"),
    ("10", "the CRC also covers the start bit and a CDS bit of 0"),
    ("11", "the CRC also covers the start bit and a CDS bit of 1"),
)
