"""``codewheel show``: show everything known about a family or an order code."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..cli import Parser, add_specs_option, cache_for
from ..find_encoder import OR_A_LINE, refuse_line
from ..terminal import print_json

if TYPE_CHECKING:
    import argparse

EXAMPLES = ("codewheel show my_encoder", "codewheel show MY-ENCODER-13-SC")


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Show everything known about a family or an order code."
    parser.add_argument(
        "what", metavar="FAMILY|ORDER-CODE", help=f"a family name as shown by list, the code on the label{OR_A_LINE}"
    )
    parser.add_argument(
        "--edition", metavar="EDITION", help="use a different edition of the manual: a revision, a date, or 'label'"
    )
    add_specs_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the family or the order code.

    Raises:
        CommandError: There is no such family, order code or edition.
    """
    from ..find_encoder import find_family_or_code
    from ..read_specs import specs_to_read

    cache = cache_for(arguments)
    specs = specs_to_read(arguments.specs)
    device, code_match, paths = find_family_or_code(specs, arguments.what, cache)
    if arguments.edition is not None:
        refuse_line(arguments.what, "has no editions")
        from ..families_in_specs import in_requested_edition

        device, code_match, _ = in_requested_edition(
            device,
            code_match,
            specs=paths,
            wanted_edition=arguments.edition,
            text=arguments.what,
            register_bytes={},
        )
    if arguments.json:
        from ...dump.plain import device_dump, variant_dump

        print_json(device_dump(device) if code_match is None else variant_dump(device, code_match))
    else:
        from .text import device_text, variant_text

        print(device_text(device) if code_match is None else variant_text(device, code_match))
    return 0
