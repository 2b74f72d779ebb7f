"""Handle ``--edition``: a different edition of the manual, named or inferred from the label or from registers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ..language.problems import ProblemReport
from ..loading.history import UnknownEdition, revision_for
from ..loading.library import in_edition, load_families
from ..loading.overlays import Family
from ..model import Device
from ..order_codes.labels import LabelMatch, UnknownOrderCode, edition_by_label, find_code
from ..reference.registers import edition_by_registers, without_edition_registers
from .terminal import CommandError, error_after_printing

#: Words that ask to infer the edition instead of naming it.
BY_LABEL, BY_REGISTERS = "label", "registers"


def in_requested_edition(
    device: Device,
    code_match: LabelMatch | None,
    *,
    specs: Sequence[Path],
    wanted_edition: str,
    text: str,
    register_bytes: Mapping[int, int],
) -> tuple[Device, LabelMatch | None, dict[int, int]]:
    """Return a family in the requested edition, its order code, and the register bytes that still apply.

    Register bytes from which the edition was inferred are left out.

    Args:
        device: The family as its spec describes it.
        code_match: The order code on the label, or None if the family was named.
        specs: The specs to read.
        wanted_edition: A revision, a date, ``label`` or ``registers``.
        text: The name or order code that the user gave.
        register_bytes: Register bytes by address.

    Raises:
        CommandError: The edition does not exist, cannot be inferred, or does not have the order code. The exit code is
            2.
    """
    remaining_bytes = dict(register_bytes)
    try:
        revision = _find_revision(device, code_match, wanted_edition, register_bytes)
        device_in_edition = _load_in_edition(specs, device, revision)
        if wanted_edition == BY_REGISTERS:
            remaining_bytes = without_edition_registers(device, register_bytes)
        match_in_edition = find_code(device_in_edition, text) if code_match is not None else None
        return device_in_edition, match_in_edition, remaining_bytes
    except UnknownOrderCode as error:
        raise CommandError(f"in edition {revision} of the manual: {error}", 2) from None
    except (UnknownEdition, ValueError) as error:
        raise CommandError(str(error), 2) from None


def _find_revision(
    device: Device, code_match: LabelMatch | None, wanted_edition: str, register_bytes: Mapping[int, int]
) -> str:
    """Return the revision of the requested edition, found by its name or a date, or inferred from label or registers.

    ``code_match`` is None if the user named a family instead of an order code. Then the edition cannot be inferred.

    Raises:
        UnknownEdition: There is no such edition, or it cannot be inferred.
        ValueError: ``register_bytes`` does not contain the registers that identify the edition.
    """
    if device.base:
        raise UnknownEdition(f"{device.name} is derived from {device.base} and has no editions of its own")
    if wanted_edition == BY_REGISTERS and code_match is not None:
        return edition_by_registers(device, code_match, register_bytes)
    if wanted_edition != BY_LABEL:
        # Without an order code, this also reports ``BY_REGISTERS`` as an edition that does not exist.
        return revision_for(device, wanted_edition)
    revision = ""
    if code_match is not None:
        revision = edition_by_label(device, code_match)
    if not revision:
        example = device.manual.revision
        raise UnknownEdition(f"cannot infer the edition from this label; give its revision, such as {example}")
    return revision


def _load_in_edition(specs: Sequence[Path], device: Device, revision: str) -> Device:
    """Return the device as this edition of its manual describes it. The edition of its spec needs no change.

    Raises:
        CommandError: The edition has problems, which are printed. The exit code is 1.
    """
    if revision == device.manual.revision:
        return device
    families, _ = load_families(specs)
    families_by_name = {family.device.name: family for family in families}
    report = ProblemReport()
    edition_family = in_edition(families_by_name[device.name], revision, report)
    if report or edition_family is None:
        raise error_after_printing(report)
    return edition_family.device


def edition_devices(families: Iterable[Family], wanted_editions: Iterable[str], report: ProblemReport) -> list[Device]:
    """Return the devices of families in the editions given by arguments such as ``FAMILY=1.6``, each once.

    Editions of a family whose spec has problems are left out. Problems of an edition are added to ``report``.

    Raises:
        CommandError: An argument is malformed, or the family or edition does not exist. The exit code is 2.
    """
    families_by_name = {family.device.name: family for family in families if not family.device.base}
    devices: dict[str, Device] = {}
    for wanted_edition in wanted_editions:
        name, equals, revision_or_date = wanted_edition.partition("=")
        if not equals or name not in families_by_name:
            first_name = next(iter(families_by_name), "FAMILY")
            remedy = f"write it like {first_name}=1.0 ({', '.join(families_by_name)})"
            raise CommandError(f"'{wanted_edition}' is not a family and an edition; {remedy}", 2)
        family = families_by_name[name]
        try:
            revision = revision_for(family.device, revision_or_date)
        except UnknownEdition as error:
            raise CommandError(str(error), 2) from None
        if revision == family.device.manual.revision:
            raise CommandError(f"the spec of {name} is already edition {revision}", 2)
        # The changes of an edition are applied to the text of the spec, so the spec must conform to the schema.
        if report.faults(family.document):
            continue
        edition_family = in_edition(family, revision, report)
        if edition_family is not None:
            devices[edition_family.device.name] = edition_family.device
    return list(devices.values())


def check_editions(families: Iterable[Family], report: ProblemReport) -> None:
    """Report the problems in all editions of the families.

    Families that are derived from others, have overlays or have problems are skipped.
    """
    for family in families:
        # An overlay may remove parts that an edition changes. This is reported when the edition is requested.
        if family.device.base or family.plain is not None or report.faults(family.document):
            continue
        for edition in family.device.editions:
            if edition.revision != family.device.manual.revision:
                # Only its report is needed, not the family in that edition.
                in_edition(family, edition.revision, report)
