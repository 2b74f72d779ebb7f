"""``codewheel master``: show the settings that a BiSS or SSI master needs for an order code."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

from ..cache import Cache
from ..language.problems import listed, suggestion
from ..masters import sheet, text
from ..masters.record import NoRecord, Record, Undecided, record
from ..model import Device
from ..order_codes.run_time import RegisterError, with_registers
from . import look_up
from .arguments import held_bytes
from .choose import answers_of, undecided
from .editions import asked_for
from .settings_targets import refuse_unknown_targets
from .terminal import Stop, problems, refuse_missing
from .which_specs import specs_to_read


def run(chosen: argparse.Namespace, cache: Cache) -> tuple[int, str | Mapping[str, Any]]:
    """Return the exit code, and the text to print or the data of ``--json``.

    Raises:
        Stop: There is no such master, order code or edition, or there are no settings for it.
    """
    refuse_missing(chosen.masters)
    masters, report = sheet.load_masters(chosen.masters)
    if report:
        raise problems(report)
    if (chosen.format or chosen.device) is not None and (chosen.master is None or chosen.order_code is None):
        raise Stop(f"{'--format' if chosen.format is not None else '--device'} needs an order code and --master", 2)
    if chosen.order_code is None:
        if chosen.edition is not None:
            raise Stop("--edition needs an order code", 2)
        return 0, text.masters_data(masters) if chosen.json else text.masters_text(masters)
    names = [master.name for master in masters]
    if chosen.master is not None and chosen.master not in names:
        hint = suggestion(chosen.master, names) or "; codewheel master lists them"
        raise Stop(f"there is no master '{chosen.master}'{hint}", 2)
    specs = specs_to_read(chosen.specs)
    refuse_unknown_targets(specs.settings)
    device, listed_match, paths = look_up.order_code(specs, chosen.order_code, cache)
    match, register_bytes = listed_match, held_bytes(chosen.register)
    if chosen.edition is not None:
        device, match_in_edition, register_bytes = asked_for(
            paths, device, listed_match, chosen.edition, chosen.order_code, register_bytes
        )
        match = match_in_edition or listed_match
    try:
        variant = with_registers(device, match.variant, register_bytes)
        answers = answers_of(device, match.variant, chosen.choose)
        encoder_record = record(device, variant, not register_bytes, chosen.cable, answers)
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    except Undecided as error:
        raise Stop(undecided(device, error.layout, answers, "has no settings"), 2) from None
    except NoRecord as error:
        raise Stop(str(error), 1) from None
    if chosen.format is not None or chosen.device is not None:
        return 0, _file(chosen, device, masters, encoder_record)
    sheets = [sheet.sheet(master, encoder_record) for master in masters if chosen.master in (None, master.name)]
    code = 1 if chosen.master is not None and sheets[0].refusals else 0
    return code, text.sheet_data(match, encoder_record, sheets) if chosen.json else text.sheet_text(
        device, match, encoder_record, sheets
    )


def _file(chosen: argparse.Namespace, device: Device, masters: Sequence[sheet.Master], encoder_record: Record) -> str:
    """Return the file of the master in the format that the user chose."""
    from ..targets.masters.files import file_text

    master = next(master for master in masters if master.name == chosen.master)
    formats = {file_format["format"]: file_format for file_format in master.files}
    if not formats:
        masters_with_files = listed(other_master.name for other_master in masters if other_master.files)
        raise Stop(f"no file format is known for {master.name}; there are formats for {masters_with_files}", 2)
    if chosen.format not in formats:
        problem = f"{master.name} has no format '{chosen.format}'" if chosen.format else "--device needs --format"
        raise Stop(f"{problem}; the formats of {master.name} are {listed(formats)}", 2)
    if chosen.json:
        raise Stop("--format prints a file; leave out --json", 2)
    master_sheet = sheet.sheet(master, encoder_record)
    if master_sheet.refusals:
        able = [
            other_master.name
            for other_master in masters
            if other_master.files and not sheet.sheet(other_master, encoder_record).refusals
        ]
        taking = f"; there are files for {listed(able)}" if able else ""
        raise Stop(
            f"{master.name} cannot use {encoder_record.code}: {master_sheet.refusals[0].reason.rstrip('.')}{taking}", 2
        )
    rule = formats[chosen.format]
    devices = master_sheet.devices_with(rule)
    on = devices[0] if chosen.device is None else chosen.device
    if on not in devices:
        raise Stop(f"'{on}' is not a device with this format; use --device {listed(devices, 'or')}", 2)
    return file_text(device, [encoder_record.code], master_sheet, rule, on).rstrip("\n")
