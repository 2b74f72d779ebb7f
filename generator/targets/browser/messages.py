"""The messages of the script, with placeholders for numbers and names, and spellings that it replaces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...model import Device, Register
from ...order_codes import labels
from ...order_codes.labels import edition_before, edition_tests_of_register
from ...say import frame_texts
from ...say.layout import as_one_number

#: Error messages, with placeholders for numbers and names: ``{0} is {1}``.
MESSAGES = {
    "length": frame_texts.wrong_length_message("{0}", "{1}", "{2}"),
    "length_of_channels": frame_texts.wrong_length_of_channels_message("{0}", "{1}", "{2}", "{3}"),
    "bits_around": frame_texts.bits_around("{0}", "{1}"),
    "other_order": frame_texts.other_order("{0}"),
    "all_crcs_correct": frame_texts.all_crcs_correct("{0}"),
    "crc": frame_texts.wrong_crc_message("{0}", "{1}"),
    "crc_exchanged": frame_texts.exchanged_crc_bytes_message("{0}", "{1}"),
    "constant": frame_texts.wrong_constant_message("{0}", "{1}", "{2}"),
    "parity": frame_texts.wrong_parity_message("{0}", "{1}", "{2}", "{3}"),
    "no_value": frame_texts.unknown_value_message("{0}", "{1}"),
    "not_in_code": frame_texts.not_in_code_message("{0}", "{1}", "{2}", "{3}"),
    "too_high": frame_texts.too_high_message("{0}", "{1}", "{2}"),
    "digits": frame_texts.too_many_digits_message("{0}", "{1}", "{2}"),
    "of_other_frame": frame_texts.other_frame_message("{0}", "{1}"),
    "too_few_bytes": frame_texts.too_few_bytes_message("{0}"),
    "no_frame": frame_texts.no_frame_message("{0}", "{1}", "{2}"),
    "other_value": frame_texts.undocumented_value_message("{0}", "{1}", "{2}"),
    "other_content": frame_texts.undocumented_content_message("{0}", "{1}", "{2}", "{3}"),
    "too_wide": frame_texts.too_wide_message("{0}", "{1}", "{2}"),
    "no_power_of_two": frame_texts.no_power_of_two_message("{0}", "{1}"),
    "outside": frame_texts.outside_limits_message("{0}", "{1}", "{2}"),
    "as_one_number": as_one_number("{0}"),
    "frame_empty": frame_texts.EMPTY,
    "frame_too_long": frame_texts.TOO_LONG,
    "not_hex": frame_texts.not_hex_message("{0}"),
    "one_digit": frame_texts.one_digit_message("{0}", "{1}"),
    "odd": frame_texts.odd_digits_message("{0}"),
    "above_byte": frame_texts.above_byte_message("{0}"),
    "decimal_bytes": frame_texts.decimal_bytes_message("{0}", "{1}"),
    "bits_or_bytes": frame_texts.bits_or_bytes_message("{0}"),
    "no_bits": frame_texts.no_bits_message("{0}", "{1}", "{2}"),
    "write_number": frame_texts.write_number("{0}"),
    "write_separately": frame_texts.write_separately("{0}"),
    "write_bits": frame_texts.write_bits("{0}", "{1}"),
    "no_order_code": frame_texts.no_order_code_message("{0}", "{1}"),
    "write_any": frame_texts.write_any(),
    "write_one_of": frame_texts.write_one_of("{0}"),
    "if_decimal": frame_texts.if_decimal("{0}"),
    "if_hex": frame_texts.if_hex("{0}"),
    "if_bits": frame_texts.if_bits("{0}"),
    "also": frame_texts.also_possible("{0}"),
    "instead": frame_texts.possible_instead("{0}"),
    "valid_other": frame_texts.valid_other("{0}"),
    "another_reading": frame_texts.another_reading("{0}"),
    "register_length": frame_texts.register_length_message("{0}", "{1}", "{2}"),
    "too_long": labels.too_long("{0}", "{1}", "{2}"),
    "code_empty": labels.EMPTY,
    "cannot_be_combined": labels.cannot_be_combined("{0}", "{1}", "{2}"),
    "not_of_family": labels.not_of_family("{0}", "{1}", "{2}"),
    "unlisted_values": labels.unlisted_values("{0}"),
    "wrong_part": labels.wrong_part("{0}", "{1}", "{2}", "{3}"),
    "has_part": labels.has_part("{0}", "{1}"),
    "has_no_part": labels.has_no_part("{0}"),
    "family": labels.family_instead_of_code("{0}", "{1}"),
    "unknown": labels.unknown_code("{0}"),
    "gray": frame_texts.gray_code_note("{0}", "{1}"),
    "together": frame_texts.explained_together("{0}", "{1}"),
    "together_all": frame_texts.all_explained_together("{0}"),
    "looks_wrong": frame_texts.looks_wrong("{0}", "{1}"),
    "own_request": frame_texts.own_request_note("{0}"),
    "own_requests": frame_texts.own_requests_note("{0}"),
    "another_frame": frame_texts.ANOTHER_FRAME,
    "uncertain": frame_texts.UNCERTAIN_READINGS,
    "disturbed": frame_texts.inverted_bit_note("{0}", has_crc=True),
    "disturbed_without_crc": frame_texts.inverted_bit_note("{0}", has_crc=False),
    "disturbed_or_shifted": frame_texts.inverted_or_shifted_note("{0}"),
    "hidden_shift": frame_texts.HIDDEN_SHIFT,
    "no_explanation": frame_texts.NO_EXPLANATION,
    "not_searched": frame_texts.NOT_SEARCHED,
    "equal_readings": frame_texts.equal_readings("{0}"),
    "no_position": frame_texts.no_position_note("{0}"),
    "compared": frame_texts.compared_bits_note("{0}", "{1}", agree=True),
    "compared_not": frame_texts.compared_bits_note("{0}", "{1}", agree=False),
    "nearest": labels.nearest_codes_hint("{0}"),
}
#: Spellings of programs and logs, and their replacement in the notation of JavaScript.
PASTED = [(pattern, replacement.replace("\\", "$")) for pattern, replacement in frame_texts.PASTED]


def edition_tests(device: Device, register: Register) -> Iterator[list[Any]]:
    """Yield digits of a register that tell the edition of the manual: the digits, their bounds, and a message.

    The message applies if their value is within the bounds, which means an encoder of an older edition.
    """
    for revision, test in edition_tests_of_register(device, register.name):
        before = edition_before(device, revision)
        message = frame_texts.older_edition_message(
            test.run, "{0}", f"{test.min} to {test.max}", revision, register.name, before
        )
        yield [test.run, test.min, test.max, message]
