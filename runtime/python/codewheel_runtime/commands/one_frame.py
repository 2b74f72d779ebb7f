# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes the frame in the command-line arguments, and prints it."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Iterable, Mapping
from enum import EnumMeta
from typing import TYPE_CHECKING, Any, cast, get_args, get_type_hints

from ..encoder import Encoder
from ..errors import FrameError, LengthError
from ..frames.decoders import cached_decoder, raise_error
from ..frames.descriptions import find_any_layout, find_kinds
from ..reports import Interface, Report, Verdict
from .common import (
    DONE,
    FAILED,
    NOT_USABLE,
    USAGE,
    CommandFailed,
    find_answer,
)

if TYPE_CHECKING:
    pass


def parse_frame(text: str, encoder: Encoder) -> int | bytes | str | None:
    """Return the frame that the arguments contain, or None if they do not have the form of a frame.

    Over RS-485, ``"1A 2B"`` is bytes. A frame of bits is a hexadecimal number, such as ``1A2B`` or ``0x1A2B``, or
    text made of 0 and 1, such as ``0b0110``, which also shows the length. If all frames of the encoder are too long for
    a 64-bit number, whole bytes without ``0x`` are read as bytes.

    Raises:
        CommandFailed: Several digits are all 0 or 1 and have no prefix, so they can be bits or hexadecimal digits.
    """
    # Separators between bytes or digits are ignored.
    digits = re.sub("[ _,:]", "", text)
    if encoder.interface is Interface.RS485:
        digits = digits.removeprefix("0x")
        return bytes.fromhex(digits) if re.fullmatch("([0-9a-fA-F]{2})+", digits) else None
    if re.fullmatch("0b[01]+", digits):
        return digits
    if re.fullmatch("[01]{2,}", digits):
        raise CommandFailed(f"{text[:60]!r} could be bits or hexadecimal digits. Prefix it with 0b or 0x", USAGE)
    # Frames of more than 64 bits are decoded from bytes, so their layouts have a length in bytes.
    are_long_frames = all(find_any_layout(frame_class, encoder).byte_count for frame_class in find_kinds(encoder))
    if are_long_frames and re.fullmatch("([0-9a-fA-F]{2})+", digits):
        return bytes.fromhex(digits)
    return int(digits, 16) if re.fullmatch("(0x)?[0-9a-fA-F]{1,64}", digits) else None


def _name_other_frames(encoder: Encoder, frame: int | bytes | str, decoded_or_error: Any) -> str:
    """Return a sentence that names the other kinds of frames that match, or an empty string.

    ``decoded_or_error`` is the decoded frame, or its error.
    """
    # The return type of ``try_decode`` is a union of the classes of frames that it decodes, and of FrameError.
    return_type = get_type_hints(type(encoder).try_decode)["return"]
    result_classes = get_args(return_type) or (return_type,)
    decoded_kinds = [frame_class for frame_class in result_classes if not issubclass(frame_class, FrameError)]
    if len(decoded_kinds) != 1:
        # An encoder with several classes identifies its frames by a field.
        return ""
    (decoded_kind,) = decoded_kinds
    decoded_bits = find_any_layout(decoded_kind, encoder).bit_count
    other_names: list[str] = []
    for frame_class in find_kinds(encoder):
        # A number in hexadecimal does not show its leading zeros, so a short frame would be valid as a long one.
        has_same_length = find_any_layout(frame_class, encoder).bit_count == decoded_bits
        may_fit = has_same_length or isinstance(decoded_or_error, LengthError)
        if frame_class is not decoded_kind and may_fit and _is_valid_as(frame_class, encoder, frame):
            other_names.append(frame_class.__name__)
    if not other_names:
        return ""
    sentence_start = (
        "This can be another frame" if isinstance(decoded_or_error, FrameError) else "This can also be another frame"
    )
    return f"{sentence_start}: {', '.join(other_names)} (decode it with the class in {type(encoder).__module__})"


def _is_valid_as(frame_class: Any, encoder: Encoder, frame: int | bytes | str) -> bool:
    """Return whether a frame is valid when it is decoded as a frame of class ``frame_class``."""
    try:
        cached_decoder(frame_class._make_decoder, encoder, raise_error)(frame)
    except (FrameError, TypeError):
        return False
    return True


def print_frame(encoder: Encoder, frame: int | bytes | str, options: argparse.Namespace) -> int:
    """Decode one frame and print it. Return the exit code. This requires no other packages.

    Raises:
        CommandFailed: The frame has an error, unless the output is JSON, which contains the error.
    """
    decoded_or_error = _decode_with_answers(encoder, frame, dict(options.choose))
    values: dict[str, Any] = decoded_or_error.to_dict()
    other_frames = _name_other_frames(encoder, frame, decoded_or_error)
    if options.json:
        print(json.dumps(values, ensure_ascii=False))
    elif isinstance(decoded_or_error, FrameError):
        advice = other_frames or decoded_or_error.hint
        message: object = f"{decoded_or_error}. {advice}" if advice else decoded_or_error
        raise CommandFailed(message)
    else:
        _print_values_and_reports(values, decoded_or_error.reports)
        if other_frames:
            print(f"\n{other_frames}")
    if isinstance(decoded_or_error, FrameError):
        return FAILED
    return NOT_USABLE if values.get("verdict") == Verdict.NOT_USABLE.value else DONE


def _print_values_and_reports(values: Mapping[str, Any], reports: Iterable[Report]) -> None:
    """Print the values of a frame by name, a line for each, then its reports with their remedies."""
    name_width = max(map(len, values))
    for name, value in values.items():
        print(f"{name:<{name_width}}  {_format_value(value)}")
    for report in reports:
        print(f"\n{report.name}: {report.meaning}")
        if report.remedy:
            print(f"  {report.remedy}")


def _format_value(value: Any) -> str:
    """Return a value as text for the terminal.

    None becomes ``-``, a list its items or ``none``, and a bool is in lower case.
    """
    if value is None:
        return "-"
    if isinstance(value, list):
        return " ".join(map(str, cast("list[object]", value))) or "none"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _decode_with_answers(encoder: Encoder, frame: int | bytes | str, answers: dict[str, str]) -> Any:
    """Return the decoded frame or its error. ``answers`` are the user's answers to open questions, by name.

    Raises:
        CommandFailed: An answer does not apply or is missing.
    """
    open_answers: dict[str, Any] = {}
    parameter_types = get_type_hints(encoder.try_decode)
    for name, answer in answers.items():
        # The parameter for an answer has the type ``Kind | None``, where ``Kind`` is the enumeration of the answers.
        union_members = get_args(parameter_types.get(name))
        answer_classes = [member for member in union_members if member is not type(None)]
        if not answer_classes:
            raise CommandFailed(f"--choose {name} does not apply to the frames of {encoder.code}", USAGE)
        try:
            open_answers[name] = find_answer(name, answer, answer_classes[0])
        except ValueError as error:
            raise CommandFailed(error, USAGE) from None
    decode: Any = encoder.try_decode
    try:
        return decode(frame, **open_answers)
    except (TypeError, NotImplementedError) as error:
        raise CommandFailed(f"{error}{_suggest_answers(parameter_types, str(error))}", USAGE) from None


def _suggest_answers(parameter_types: dict[str, Any], message: str) -> str:
    """Return the options for the answers that an error message requests, or an empty string if it requests none.

    Example: ``; add --choose zero_bit=as_printed or --choose zero_bit=left_out``. ``parameter_types`` are the
    types of the parameters of ``try_decode``.
    """
    for parameter_name, parameter_type in parameter_types.items():
        answer_classes = [candidate for candidate in get_args(parameter_type) if isinstance(candidate, EnumMeta)]
        for answer_class in answer_classes:
            # The message names a member of the class that it requests, such as "must be ZeroBit.AS_PRINTED".
            is_requested = f"must be {answer_class.__name__}." in message
            if is_requested:
                options = [f"--choose {parameter_name}={name.lower()}" for name in answer_class.__members__]
                return "; add " + " or ".join(options)
    return ""
