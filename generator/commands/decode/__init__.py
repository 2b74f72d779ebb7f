"""``codewheel decode``: name every bit of frames, check their CRC, and list the reports of the encoder.

``frames`` reads and decodes their text, ``text`` explains them, and ``decoding`` prints them one after the other.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ...one_line.parse import is_line
from ..cli import Parser, add_choose_option, add_edition_option, add_register_option, add_specs_option, cache_for
from ..find_encoder import OR_A_LINE, command_for_spec
from ..terminal import CommandError, release_streams

if TYPE_CHECKING:
    import argparse

    from .decoding import DecodeRequest

EXAMPLES = (
    "codewheel decode MY-ENCODER-13-SC 0b0001111101000_1_1_011010",
    'codewheel decode MY-ENCODER-13-SC --as preset "00 00 03 E8"',
)
_ABOUT_FRAMES = (
    "For RS-485, FRAME is a sequence of bytes in hexadecimal. For SSI, BiSS and SPI, it is one number whose most "
    "significant bit is the first bit sent: 0b... with every digit, 0x..., or hex bytes. The notations of "
    "programs and logs are also accepted, such as 0F:42, [0x0F, 0x42], \\x0F\\x42, F4243D3h and 7FFE. Except "
    "over RS-485, several words of the frame's size are read as separate frames, and a column of decimal numbers may "
    "follow a line number or a time. With -, lines may begin with a time, and empty lines and text after # are "
    "skipped. The exit code is 0 on success, 1 for a frame with an error or a register value that this encoder "
    "cannot have, 2 for a usage error, input that is not a frame, or a missing --choose, and 3 for a valid frame "
    "whose position is not usable. With several frames, the worst one determines the exit code (worst first: 2, 1, 3)."
)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Name every bit of a frame, check its CRC, and list the encoder's reports."
    parser.epilog = _ABOUT_FRAMES
    parser.add_argument("order_code", metavar="ORDER-CODE", help=f"the code on the label{OR_A_LINE}")
    parser.add_argument(
        "frame", nargs="+", metavar="FRAME", help="the frame, as one or more arguments, or - to read one frame per line"
    )
    parser.add_argument(
        "--as", dest="register_name", metavar="REGISTER", help="decode the bytes as this register's value"
    )
    add_register_option(parser)
    add_choose_option(parser, "frames that depend on it are not decoded")
    add_edition_option(parser)
    parser.add_argument(
        "--layout",
        metavar="NAME",
        help="layout of the frame, as listed by show, if the frame does not identify it (for example, a different BiSS"
        " data channel)",
    )
    parser.add_argument(
        "--from",
        dest="sender",
        choices=("encoder", "master"),
        default="encoder",
        help="sender of the frame (default: encoder)",
    )
    add_specs_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the decoded frames, and return the exit code of the worst frame.

    If the arguments describe the encoder in one line, a command that writes it as a spec follows the frames.

    Raises:
        CommandError: There is no such order code or edition, or an answer or a register value is wrong.
    """
    from .decoding import Decoding
    from .several_frames import argument_lines

    decoding = Decoding(_request_of(arguments))
    try:
        decoding.run(argument_lines(arguments.frame))
        if is_line(arguments.order_code) and not arguments.json and arguments.frame != ["-"]:
            print(f"To write it as a spec: {command_for_spec(arguments.order_code)}")
    except BrokenPipeError:
        release_streams()
    return decoding.code


def _request_of(arguments: argparse.Namespace) -> DecodeRequest:
    """Return the encoder that ``--edition``, ``--register`` and ``--choose`` describe, with the options for decoding.

    Register bytes that identify the order code are only compared with it, and reported if they contradict it.

    Raises:
        CommandError: There is no such order code or edition, or an answer or a register value is wrong.
    """
    from ...order_codes.parameters import RegisterError, with_answers, with_registers
    from ...order_codes.reduction import reduced_to_codes
    from ...reference.registers import compare_identifying_registers, identifying_addresses
    from ..find_encoder import answers_of, find_requested
    from ..read_specs import specs_to_read
    from .decoding import DecodeRequest

    cache = cache_for(arguments)
    device, code_match, register_bytes = find_requested(arguments, specs_to_read(arguments.specs), cache)
    listed_variant = code_match.variant
    answers = answers_of(device, listed_variant, arguments.choose)
    # Registers that identify the order code are only compared with it. Others may change the layout of frames.
    known_addresses = identifying_addresses(device, listed_variant)
    changed_bytes = {address: byte for address, byte in register_bytes.items() if address not in known_addresses}
    try:
        variant_with_registers = with_registers(device, listed_variant, changed_bytes)
        variant = with_answers(device, variant_with_registers, answers)
    except RegisterError as error:
        raise CommandError(str(error), 2) from None
    return DecodeRequest(
        device=reduced_to_codes(device, [variant.code]),
        match=replace(code_match, variant=variant),
        sender=arguments.sender,
        layout=arguments.layout,
        register=arguments.register_name,
        as_json=arguments.json,
        register_differences=compare_identifying_registers(device, listed_variant, register_bytes),
        answers=answers,
    )
