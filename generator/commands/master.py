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
    known, report = sheet.load_masters(chosen.masters)
    if report:
        raise problems(report)
    if (chosen.format or chosen.device) is not None and (chosen.master is None or chosen.order_code is None):
        raise Stop(f"{'--format' if chosen.format is not None else '--device'} needs an order code and --master", 2)
    if chosen.order_code is None:
        if chosen.edition is not None:
            raise Stop("--edition needs an order code", 2)
        return 0, text.masters_data(known) if chosen.json else text.masters_text(known)
    names = [item.name for item in known]
    if chosen.master is not None and chosen.master not in names:
        hint = suggestion(chosen.master, names) or "; codewheel master lists them"
        raise Stop(f"there is no master '{chosen.master}'{hint}", 2)
    specs = specs_to_read(chosen.specs, cache)
    refuse_unknown_targets(specs.settings)
    device, found, paths = look_up.order_code(specs, chosen.order_code, cache)
    match, held = found, held_bytes(chosen.register)
    if chosen.edition is not None:
        device, again, held = asked_for(paths, device, found, chosen.edition, chosen.order_code, held)
        match = again or found
    try:
        variant = with_registers(device, match.variant, held)
        answers = answers_of(device, match.variant, chosen.choose)
        told = record(device, variant, not held, chosen.cable, answers)
    except RegisterError as error:
        raise Stop(str(error), 2) from None
    except Undecided as error:
        raise Stop(undecided(device, error.layout, answers, "has no settings"), 2) from None
    except NoRecord as error:
        raise Stop(str(error), 1) from None
    if chosen.format is not None or chosen.device is not None:
        return 0, _file(chosen, device, known, told)
    sheets = [sheet.sheet(item, told) for item in known if chosen.master in (None, item.name)]
    code = 1 if chosen.master is not None and sheets[0].refusals else 0
    return code, text.sheet_data(match, told, sheets) if chosen.json else text.sheet_text(device, match, told, sheets)


def _file(chosen: argparse.Namespace, device: Device, known: Sequence[sheet.Master], told: Record) -> str:
    """Return the file of the master in the format that the user chose."""
    from ..targets.masters.files import file_text

    master = next(item for item in known if item.name == chosen.master)
    formats = {item["format"]: item for item in master.files}
    if not formats:
        others = listed(item.name for item in known if item.files)
        raise Stop(f"no file format is known for {master.name}; there are formats for {others}", 2)
    if chosen.format not in formats:
        wrong = f"{master.name} has no format '{chosen.format}'" if chosen.format else "--device needs --format"
        raise Stop(f"{wrong}; the formats of {master.name} are {listed(formats)}", 2)
    if chosen.json:
        raise Stop("--format prints a file; leave out --json", 2)
    found = sheet.sheet(master, told)
    if found.refusals:
        able = [item.name for item in known if item.files and not sheet.sheet(item, told).refusals]
        taking = f"; there are files for {listed(able)}" if able else ""
        raise Stop(f"{master.name} cannot use {told.code}: {found.refusals[0].reason.rstrip('.')}{taking}", 2)
    rule = formats[chosen.format]
    devices = found.devices_with(rule)
    on = devices[0] if chosen.device is None else chosen.device
    if on not in devices:
        raise Stop(f"'{on}' is not a device with this format; use --device {listed(devices, 'or')}", 2)
    return file_text(device, [told.code], found, rule, on).rstrip("\n")
