"""``codewheel simulate``: a virtual encoder on a pseudo-terminal or over TCP."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..one_line.parse import is_line
from .cli import Parser, a_path, add_choose_option, add_register_option, bytes_by_address, cache_for
from .find_encoder import OR_A_LINE, encoder_in_line
from .terminal import CommandError

if TYPE_CHECKING:
    import argparse

    from ..virtual.encoder import VirtualEncoder

EXAMPLES = (
    "codewheel simulate MY-ENCODER-13-SC --position 1000",
    "codewheel simulate MY-ENCODER-13-SC --position sine:1Hz:90deg --fault flip",
    "codewheel simulate ssi,gray:position=13,error=high --position ramp:100",
)
#: Columns of the help.
_HELP_WIDTH = 79
_HOW_TO_USE = (
    "For RS-485, open the printed device like a serial port, at any baud rate. With --tcp, and on systems without "
    "pseudo-terminals, open the printed URL with pyserial. For SPI, send the bytes of each word. The reply has as many "
    "bytes. For SSI and BiSS, send 0 or 1 for each level of the clock, C for 0 and then 1, and T for a timeout. "
    "The reply to each is the level of the data line, 0 or 1. Press Ctrl+C to stop."
)


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Emulate an encoder on a pseudo-terminal or over TCP, and print the device or URL to open."
    parser.add_argument("order_code", metavar="ORDER-CODE", help=f"the code on the label{OR_A_LINE}")
    parser.add_argument(
        "--position",
        default="0",
        metavar="POSITION",
        help="counts such as 1000003, sine:0.5Hz:90deg to turn back and forth, sine:0.5Hz through all positions, or "
        "ramp:1000 in counts per second (default: 0)",
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="NAME[:RATE]",
        help="inject a fault into this share of the replies, such as flip:1e-3 (may be repeated)",
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the random faults (default: 0)")
    parser.add_argument(
        "--flag", action="append", default=[], metavar="NAME", help="activate an alarm or flag (may be repeated)"
    )
    parser.add_argument(
        "--tcp",
        nargs="?",
        type=int,
        const=0,
        metavar="PORT",
        help="use TCP on this computer instead of a pseudo-terminal (default: any free port)",
    )
    add_register_option(parser)
    add_choose_option(parser, "requests that depend on it are not answered")
    parser.add_argument(
        "--edition", metavar="EDITION", help="use a different edition of the manual: a revision or a date"
    )
    parser.add_argument(
        "--specs", action="append", type=a_path, default=[], metavar="PATH", help="specs to use, as for decode"
    )
    parser.more_help = _more_help


def _more_help() -> str:
    """Return the end of the help: how to use the port, and the faults that can be injected over each interface."""
    from textwrap import fill

    from ..model import INTERFACES
    from ..virtual.simulation_options import FAULTS, faults_of

    lines = [fill(_HOW_TO_USE, _HELP_WIDTH)]
    interfaces: dict[str, None] = {}
    for effect_by_interface in FAULTS.values():
        # A fault has an effect for each interface over which it can occur.
        interfaces |= dict.fromkeys(effect_by_interface)
    for interface in interfaces:
        lines += ["", f"faults over {INTERFACES[interface].short}:"]
        lines += [f"  {name:<10}{effect}" for name, effect in faults_of(interface).items()]
    return "\n".join(lines)


def run(arguments: argparse.Namespace) -> int:
    """Serve a virtual encoder until the user ends it.

    Raises:
        CommandError: An argument is wrong, with exit code 2, or the port cannot be opened, with exit code 1.
    """
    from ..virtual.serving import has_terminals, line_of, listen_tcp, serve, terminal
    from .find_encoder import find_order_code
    from .read_specs import specs_to_read

    paths: Sequence[Path] = ()
    if is_line(arguments.order_code):
        # The result is not needed, only the error if the line has problems.
        encoder_in_line(arguments.order_code)
    else:
        specs = specs_to_read(arguments.specs)
        _, _, paths = find_order_code(specs, arguments.order_code, cache_for(arguments))
    try:
        encoder = _virtual_encoder(arguments, paths)
    except ValueError as error:
        raise CommandError(str(error), 2) from None
    try:
        uses_tcp = arguments.tcp is not None or not has_terminals()
        port = listen_tcp(arguments.tcp or 0) if uses_tcp else terminal()
    except (OSError, OverflowError) as error:
        # Only an error of the system has this text.
        reason = getattr(error, "strerror", None) or error
        raise CommandError(f"cannot open a port: {reason}", 1) from None
    print(port.name, flush=True)
    try:
        serve(encoder, line_of(encoder), port)
    except KeyboardInterrupt:
        return 0
    finally:
        port.close()
    return 0


def _virtual_encoder(arguments: argparse.Namespace, paths: Sequence[Path]) -> VirtualEncoder:
    """Return a virtual encoder with the position, flags, registers and faults that the arguments request.

    ``paths`` are the specs that contain its order code. They are empty for an encoder that is described in one line.

    Raises:
        ValueError: An argument is wrong.
    """
    from ..virtual.encoder import VirtualEncoder
    from ..virtual.simulation_options import motion

    answers: dict[str, str] = {}
    for pair in arguments.choose:
        name, _, answer = pair.partition("=")
        answers[name] = answer
    encoder = VirtualEncoder(
        arguments.order_code,
        choose=answers,
        faults=arguments.fault,
        seed=arguments.seed,
        edition=arguments.edition or "",
        specs=paths,
    )
    position = motion(arguments.position, encoder.counts, encoder.lowest, encoder.counts_per_turn)
    highest = encoder.lowest + encoder.counts - 1
    if isinstance(position, int) and not encoder.lowest <= position <= highest:
        message = f"position {position} is out of range; {arguments.order_code} has {encoder.lowest} to {highest}"
        raise ValueError(message)
    encoder.position = position
    encoder.set_flag(*arguments.flag)
    for address, byte in bytes_by_address(arguments.register).items():
        encoder.memory.hold(address, byte)
    return encoder
