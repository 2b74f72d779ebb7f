"""``codewheel master``: show the settings that a BiSS or SSI master needs for an order code."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .cli import Parser, a_path, add_choose_option, add_edition_option, add_register_option, add_specs_option, cache_for
from .find_encoder import OR_A_LINE
from .terminal import CommandError, error_after_printing, print_json, refuse_missing

if TYPE_CHECKING:
    from ..masters.encoder_facts import EncoderFacts
    from ..masters.sheet import Master, SettingsSheet
    from ..model import Device
    from ..order_codes.labels import LabelMatch

EXAMPLES = ("codewheel master", "codewheel master MY-ENCODER-13-SC")
#: Longest cable that ``--cable`` accepts, in metres. Every real cable is shorter.
_LONGEST_CABLE_M = 100_000


def add_arguments(parser: Parser) -> None:
    """Add the arguments of the command."""
    parser.description = "Show the settings that a BiSS or SSI master needs for an encoder."
    parser.add_argument(
        "order_code",
        nargs="?",
        metavar="ORDER-CODE",
        help=f"the code on the label{OR_A_LINE} (default: list the masters)",
    )
    parser.add_argument(
        "--master", metavar="NAME", help="show only this master, and exit 1 if it does not support the encoder"
    )
    parser.add_argument("--format", metavar="FORMAT", help="print a file for this master in one of its formats")
    parser.add_argument("--device", metavar="DEVICE", help="device of the master for --format (default: the first)")
    parser.add_argument(
        "--masters",
        action="append",
        type=a_path,
        default=[],
        metavar="PATH",
        help="your own descriptions of masters, as files or folders",
    )
    add_register_option(parser)
    add_choose_option(parser, "it is an error if the settings depend on it")
    add_edition_option(parser)
    parser.add_argument("--cable", type=metres, metavar="METRES", help="choose clocks for a cable of this length")
    add_specs_option(parser)


def metres(text: str) -> int:
    """Return a cable length in whole metres, rounded up. Raise ArgumentTypeError unless it is 1 to 100,000 m."""
    not_a_length = argparse.ArgumentTypeError(f"'{text}' is not a length in metres, such as 30")
    try:
        length_in_metres = math.ceil(float(text))
    except (ValueError, OverflowError):
        raise not_a_length from None
    if not 0 < length_in_metres <= _LONGEST_CABLE_M:
        raise not_a_length
    return length_in_metres


def run(arguments: argparse.Namespace) -> int:
    """Print the masters or, with an order code, its settings or a file with them, and return the exit code.

    The exit code is 1 if the named master does not support the encoder, or if no master can read it.

    Raises:
        CommandError: The master, order code or edition does not exist, or there are no settings for it.
    """
    from ..masters import sheet, text

    refuse_missing(arguments.masters)
    masters, report = sheet.load_masters(arguments.masters)
    if report:
        raise error_after_printing(report)
    _refuse_incomplete_options(arguments)
    if arguments.order_code is None:
        if arguments.json:
            print_json(text.masters_data(masters))
        else:
            print(text.masters_text(masters))
        return 0
    _refuse_unknown_master(arguments.master, masters)
    device, code_match, encoder_facts = _facts_of_requested_encoder(arguments)
    if arguments.format is not None or arguments.device is not None:
        print(_file_for_master(arguments, device, masters, encoder_facts))
        return 0
    shown_masters = [master for master in masters if arguments.master in (None, master.name)]
    sheets = [sheet.sheet(master, encoder_facts) for master in shown_masters]
    if arguments.json:
        print_json(text.sheet_data(device, code_match, encoder_facts, sheets))
    else:
        print(text.sheet_text(device, code_match, encoder_facts, sheets))
    # With ``--master``, there is only its sheet.
    is_refused = arguments.master is not None and sheets[0].refusals
    return 1 if is_refused or encoder_facts.obstacle else 0


def _refuse_incomplete_options(arguments: argparse.Namespace) -> None:
    """Check that the order code and the master are given if an option needs them.

    Raises:
        CommandError: One of them is missing. The exit code is 2.
    """
    has_format_option = arguments.format is not None or arguments.device is not None
    if has_format_option and (arguments.master is None or arguments.order_code is None):
        option = "--format" if arguments.format is not None else "--device"
        raise CommandError(f"{option} needs an order code and --master", 2)
    if arguments.order_code is None and arguments.edition is not None:
        raise CommandError("--edition needs an order code", 2)


def _refuse_unknown_master(name: str | None, masters: Sequence[Master]) -> None:
    """Check that there is a master of this name, if the user named one.

    Raises:
        CommandError: There is none. The exit code is 2.
    """
    from ..language.problems import suggest_word

    known_names = [master.name for master in masters]
    if name is not None and name not in known_names:
        hint = suggest_word(name, known_names) or "; codewheel master lists them"
        raise CommandError(f"there is no master '{name}'{hint}", 2)


def _facts_of_requested_encoder(arguments: argparse.Namespace) -> tuple[Device, LabelMatch, EncoderFacts]:
    """Return the family and match of the order code, and the record of the settings that masters need for it.

    Raises:
        CommandError: The order code or edition does not exist, or there are no settings for it.
    """
    from ..masters.encoder_facts import Undecided
    from ..masters.frame_parts import NoMasterSettings
    from ..masters.order_code_facts import facts_of_order_code
    from ..order_codes.parameters import RegisterError, with_registers
    from .find_encoder import answers_of, describe_open_questions, find_requested
    from .read_specs import specs_to_read

    cache = cache_for(arguments)
    device, code_match, register_bytes = find_requested(arguments, specs_to_read(arguments.specs), cache)
    try:
        variant = with_registers(device, code_match.variant, register_bytes)
    except RegisterError as error:
        raise CommandError(str(error), 2) from None
    answers = answers_of(device, code_match.variant, arguments.choose)
    has_factory_defaults = not register_bytes
    try:
        encoder_facts = facts_of_order_code(
            device, variant, as_delivered=has_factory_defaults, cable_m=arguments.cable, answers=answers
        )
    except Undecided as error:
        message = describe_open_questions(device, error.layout, answers, predicate="has no settings")
        raise CommandError(message, 2) from None
    except NoMasterSettings as error:
        raise CommandError(str(error), 1) from None
    return device, code_match, encoder_facts


def _file_for_master(
    arguments: argparse.Namespace, device: Device, masters: Sequence[Master], encoder_facts: EncoderFacts
) -> str:
    """Return the text of a file for ``--master`` in the ``--format`` that the user chose.

    The file is for ``--device``, or for the first device of the master that has the format.

    Raises:
        CommandError: There is no such format or device, or the master cannot use the encoder. The exit code is 2.
    """
    from ..language.problems import join_words
    from ..masters.sheet import sheet
    from ..model import member_named
    from ..targets.masters.files import file_text

    master = member_named(masters, arguments.master, "master")
    file_format = _chosen_format(arguments, master, masters)
    master_sheet = sheet(master, encoder_facts)
    if master_sheet.refusals:
        raise CommandError(_cannot_use_message(master_sheet, masters, encoder_facts), 2)
    devices_with_format = master_sheet.devices_with(file_format)
    master_device = devices_with_format[0] if arguments.device is None else arguments.device
    if master_device not in devices_with_format:
        known_devices = join_words(devices_with_format, "or")
        raise CommandError(f"'{master_device}' is not a device with this format; use --device {known_devices}", 2)
    text = file_text(device, [encoder_facts.code], master_sheet, file_rule=file_format, master_device=master_device)
    return text.rstrip("\n")


def _chosen_format(arguments: argparse.Namespace, master: Master, masters: Sequence[Master]) -> Any:
    """Return the description of the format that the user chose with ``--format``.

    Raises:
        CommandError: The master has no such format, or JSON is also requested. The exit code is 2.
    """
    from ..language.problems import join_words

    formats = {file_format["format"]: file_format for file_format in master.files}
    if not formats:
        masters_with_files = join_words(other_master.name for other_master in masters if other_master.files)
        raise CommandError(f"no file format is known for {master.name}; there are formats for {masters_with_files}", 2)
    if arguments.format not in formats:
        problem = f"{master.name} has no format '{arguments.format}'" if arguments.format else "--device needs --format"
        raise CommandError(f"{problem}; the formats of {master.name} are {join_words(formats)}", 2)
    if arguments.json:
        raise CommandError("--format prints a file; leave out --json", 2)
    return formats[arguments.format]


def _cannot_use_message(master_sheet: SettingsSheet, masters: Sequence[Master], encoder_facts: EncoderFacts) -> str:
    """Return the message about a master that does not support the encoder: why not, and which other masters do.

    Only masters with file formats are suggested.
    """
    from ..language.problems import join_words
    from ..masters.sheet import sheet

    masters_with_files = [master for master in masters if master.files]
    usable_names = [master.name for master in masters_with_files if not sheet(master, encoder_facts).refusals]
    hint = f"; there are files for {join_words(usable_names)}" if usable_names else ""
    reason = master_sheet.refusals[0].reason.rstrip(".")
    return f"{master_sheet.master.name} cannot use {encoder_facts.code}: {reason}{hint}"
