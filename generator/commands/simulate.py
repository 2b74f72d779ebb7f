"""``codewheel simulate``: a virtual encoder on a pseudo-terminal or over TCP."""

from __future__ import annotations

import argparse
from textwrap import fill

from ..cache import Cache
from ..model import INTERFACES
from ..virtual import FAULTS, VirtualEncoder, faults_of, motion
from ..virtual.serve import has_terminals, line_of, listen_tcp, serve, terminal
from . import look_up
from .arguments import held_bytes
from .terminal import Stop
from .which_specs import Specs

_HOW = (
    "For RS-485, open the printed device like a serial port, at any baud rate. With --tcp, and on systems without "
    "pseudo-terminals, open the printed URL with pyserial. For SPI, send the bytes of each word, which are answered "
    "by as many. For SSI and BiSS, send 0 or 1 for each level of the clock, C for 0 and then 1, and T for a time-out. "
    "The reply to each is the level of the data line, 0 or 1. Press Ctrl+C to stop."
)


def more_help() -> str:
    """Return how to use the port, and the faults of each interface."""
    lines = [fill(_HOW, 79)]
    for interface in dict.fromkeys(interface for effects in FAULTS.values() for interface in effects):
        effects = faults_of(interface)
        lines += ["", f"faults over {INTERFACES[interface].short}:"]
        lines += [f"  {name:<10}{effect}" for name, effect in effects.items()]
    return "\n".join(lines)


def run(chosen: argparse.Namespace, specs: Specs, cache: Cache) -> int:
    """Serve a virtual encoder until the user ends it.

    Raises:
        Stop: An argument is wrong, with exit code 2, or the port cannot be opened, with exit code 1.
    """
    _, _, paths = look_up.order_code(specs, chosen.order_code, cache)
    try:
        answers = dict(pair.partition("=")[::2] for pair in chosen.choose)
        encoder = VirtualEncoder(
            chosen.order_code,
            choose=answers,
            faults=chosen.fault,
            seed=chosen.seed,
            edition=chosen.edition or "",
            specs=paths,
        )
        encoder.position = motion(chosen.position, encoder.counts, encoder.lowest)
        encoder.set_flag(*chosen.flag)
        for address, byte in held_bytes(chosen.register).items():
            encoder.memory.hold(address, byte)
    except ValueError as error:
        raise Stop(str(error), 2) from None
    try:
        port = listen_tcp(chosen.tcp or 0) if chosen.tcp is not None or not has_terminals() else terminal()
    except (OSError, OverflowError) as error:
        raise Stop(f"cannot open a port: {getattr(error, 'strerror', None) or error}", 1) from None
    print(port.name, flush=True)
    try:
        serve(encoder, line_of(encoder), port)
    except KeyboardInterrupt:
        return 0
    finally:
        port.close()
    return 0
