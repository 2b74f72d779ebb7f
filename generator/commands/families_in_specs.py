"""Families that a command takes from specs: those that a text can name, and families in other editions of their manual.

Families and order codes are first searched in the text of the specs, because reading all of them as YAML would take
long. Regular expressions find the names of families and the beginnings of order codes. If the selection could be wrong,
nothing is selected, and the caller reads all specs.

Modules that only other editions need are imported in the functions about them.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache import Cache, content_of
from ..language.files import MANUFACTURER, family_files, is_second, spec_files
from ..loading.stored import store_device, stored_device
from .terminal import CommandError, error_after_printing

if TYPE_CHECKING:
    from ..language.problems import ProblemReport
    from ..loading.overlays import Family
    from ..model import Device
    from ..order_codes.labels import LabelMatch

#: Keys of files that can change a family of another file, and keys of descriptions of masters, which cannot.
_OVERLAY_KEYS = frozenset((b"overlay", b"changes"))
_MASTER_KEYS = frozenset((b"master", b"takes"))
_TOP_LEVEL_KEY = re.compile(rb"\n([a-z_]+)[ \t]*:(?=[ \t\r\n]|$)")
_DEVICE_NAME = re.compile(rb"\ndevice[ \t]*:[ \t]*([a-z][a-z0-9_]*)[ \t]*(?:#[^\n]*)?(?=\r?\n)")
_PATTERN_KEY = re.compile(rb"pattern['\"]?[ \t]*:")
_ORDER_CODE_PATTERN = re.compile(rb"pattern[ \t]*:[ \t]*\"([^\"\\{}\r\n]*)\{")
_ORDER_CODE_SECTION = re.compile(r"\norder_code[ \t]*:[ \t]*(?=[\r\n]).*?(?=\n[^ #\r\n]|\Z)", re.DOTALL)

#: Kind of the cache entries with the results of ``_read_beginnings``.
_BEGINNINGS_ENTRY = "beginnings"
#: Kinds of files that can be selected.
_DEVICE_FILE, _MANUFACTURER_FILE, _MASTER_FILE = "device", "manufacturer", "master"


class _NotSelectable(Exception):
    """The text of the specs does not show which of them are needed, so all must be read."""


@dataclass(frozen=True, slots=True)
class _SpecFile:
    """A spec: its kind, the name of its device, and the beginnings of its order codes.

    The kind is empty if the text does not show it. Then the only beginning is "", with which every label begins.
    """

    path: Path
    kind: str = ""
    name: str = ""
    beginnings: tuple[str, ...] = ("",)

    def can_have_order_code(self, label: str) -> bool:
        return label.startswith(self.beginnings)


def families_for(paths: Sequence[Path], text: str, cache: Cache) -> tuple[Device, ...] | None:
    """Return the valid families that ``text`` can name or be an order code of.

    Args:
        paths: Files and folders.
        text: The name of a family, or the text of a label.
        cache: Cache of the families that were loaded before.

    Returns:
        The families, or None if all specs must be read, for example because one of them is an overlay.
    """
    try:
        device_files = _device_files(paths)
        name = text.strip().lower()
        label = "".join(text.split()).upper()
        named_files = [device_file for device_file in device_files if device_file.name == name]
        if len(named_files) > 1:
            return None
        if named_files:
            # Without a label, the result is always one device.
            (device,) = _load_if_possible(named_files[0].path, cache)
            return (device,)
        devices: list[Device] = []
        for device_file in device_files:
            if not device_file.can_have_order_code(label):
                continue
            # If the text shows the beginnings, ``can_have_order_code`` has already compared them with the label.
            shows_beginnings = all(device_file.beginnings)
            devices += _load_if_possible(device_file.path, cache, label="" if shows_beginnings else label)
        return tuple(devices)
    except (OSError, ValueError, _NotSelectable):
        return None


def has_family(paths: Sequence[Path], name: str) -> bool:
    """Return True if one of the specs has a family of this name, without loading it."""
    return bool(_specs_of_family(paths, name))


def has_same_spec(paths: Sequence[Path], other_paths: Sequence[Path], name: str) -> bool:
    """Return True if two groups of specs have the same file for the family of this name, and no overlay."""
    specs = _specs_of_family(paths, name)
    return bool(specs) and specs == _specs_of_family(other_paths, name)


def _specs_of_family(paths: Sequence[Path], name: str) -> list[bytes]:
    """Return the content of each spec with a family of this name, or nothing if the texts do not show which it is."""
    try:
        return [device_file.path.read_bytes() for device_file in _device_files(paths) if device_file.name == name]
    except (OSError, ValueError, _NotSelectable):
        return []


def _device_files(paths: Sequence[Path]) -> list[_SpecFile]:
    """Return the specs of devices that are next to their manufacturer's file. Files about masters are left out.

    Raises:
        OSError: A file cannot be read.
        _NotSelectable: There is a file of another kind, which may affect a family. Files of manufacturers are allowed.
    """
    device_files = []

    @functools.cache
    def has_manufacturer(folder: Path) -> bool:
        return (folder / MANUFACTURER).is_file()

    for path in dict.fromkeys(spec_files(paths)):
        spec_file = _read_spec_file(path)
        is_device = spec_file.kind == _DEVICE_FILE and not is_second(path)
        is_manufacturer = spec_file.kind == _MANUFACTURER_FILE and path.name == MANUFACTURER
        if is_device and has_manufacturer(path.parent):
            device_files.append(spec_file)
        elif spec_file.kind != _MASTER_FILE and not is_manufacturer:
            raise _NotSelectable
    return device_files


def _read_spec_file(path: Path) -> _SpecFile:
    """Return the kind of a file by its top-level keys and, for a device, its name and the beginnings of order codes.

    Raises:
        OSError: The file cannot be read.
    """
    if not path.is_file():
        raise OSError
    # The expressions begin with ``\n`` to match only at the beginning of a line.
    spec_text = b"\n" + path.read_bytes()
    top_level_keys = set(_TOP_LEVEL_KEY.findall(spec_text))
    device_names = _DEVICE_NAME.findall(spec_text)
    if not top_level_keys.isdisjoint(_OVERLAY_KEYS):
        return _SpecFile(path)
    # If a file has the key of a device, but also keys of a master or not exactly one name, its kind is not known.
    has_device_key = b"device" in top_level_keys
    if not top_level_keys.isdisjoint(_MASTER_KEYS):
        return _SpecFile(path, kind="" if has_device_key else _MASTER_FILE)
    if len(device_names) == 1:
        name = device_names[0].decode()
        return _SpecFile(path, kind=_DEVICE_FILE, name=name, beginnings=_beginnings_in_text(spec_text))
    return _SpecFile(path, kind="" if has_device_key else _MANUFACTURER_FILE)


def _beginnings_in_text(text: bytes) -> tuple[str, ...]:
    """Return the text before the first part in each order code pattern: ``("X-24",)`` for ``X-24 {output}``.

    If the text of the spec does not show it for all patterns, the result is ``("",)``, with which any label begins.
    """
    texts_before_part = _ORDER_CODE_PATTERN.findall(text)
    if not texts_before_part or len(texts_before_part) != len(_PATTERN_KEY.findall(text)):
        return ("",)
    beginnings = []
    for text_before_part in texts_before_part:
        without_spaces = "".join(text_before_part.decode("ascii", "replace").split())
        beginnings.append(without_spaces.upper())
    return tuple(beginnings)


def _read_beginnings(spec: Path) -> tuple[str, ...]:
    """Return the beginnings of order codes whose pattern begins with a part, such as ``{model}-24``.

    Only ``order_code`` is read from the spec. If it has problems or refers to other data, the result is ``("",)``, with
    which any label begins.
    """
    from ..language.read import Unreadable, parse
    from ..loading.order_code_facts import code_grammar
    from ..order_codes.patterns import beginnings

    order_code_section = _ORDER_CODE_SECTION.search("\n" + spec.read_text(encoding="utf-8"))
    section_text = order_code_section[0] if order_code_section else ""
    problems: list[object] = []
    try:
        section_data, _ = parse(section_text, problems.append, problems.append)
        prefixes = beginnings(code_grammar(section_data["order_code"]))
    except (Unreadable, LookupError, TypeError, ValueError, AttributeError):
        return ("",)
    has_unknown_part = any("{" in prefix for prefix in prefixes)
    return ("",) if problems or has_unknown_part else prefixes


def _load_if_possible(spec: Path, cache: Cache, label: str = "") -> Sequence[Device]:
    """Return the device of a spec in a sequence, which is empty if ``label`` cannot belong to the device.

    An empty label is not compared.

    Raises:
        _NotSelectable: The spec has problems or overlays.
    """
    files = family_files(spec)
    if any(".overlay." in path.name for path in files):
        raise _NotSelectable
    content = content_of(files)
    if label and not label.startswith(_cached_beginnings(spec, content, cache)):
        return ()
    device = stored_device(cache, content)
    if device is not None:
        return (device,)
    from ..loading.library import load_library

    devices, report = load_library([spec])
    if report or len(devices) != 1:
        raise _NotSelectable
    # The files must not have changed since their content was read.
    if content_of(family_files(spec)) == content:
        store_device(cache, content, devices[0])
    return devices


def _cached_beginnings(spec: Path, content: Sequence[bytes | str], cache: Cache) -> tuple[str, ...]:
    """Return the beginnings of order codes of a spec, from the cache if it has them for this content."""
    stored = cache.get(_BEGINNINGS_ENTRY, content)
    if stored is not None:
        return tuple(stored)
    beginnings = _read_beginnings(spec)
    if content_of(family_files(spec)) == content:
        cache.put(_BEGINNINGS_ENTRY, content, beginnings)
    return beginnings


# -- other editions of a manual

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
        CommandError: The edition does not exist, cannot be inferred, or lacks the order code. The exit code is 2.
    """
    from ..loading.history import UnknownEdition
    from ..order_codes.labels import UnknownOrderCode, find_code
    from ..reference.registers import without_edition_registers

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
    from ..loading.history import UnknownEdition, revision_for
    from ..order_codes.labels import edition_by_label
    from ..reference.registers import edition_by_registers

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
    from ..language.problems import ProblemReport
    from ..loading.library import in_edition, load_families

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
    from ..loading.history import UnknownEdition, revision_for
    from ..loading.library import in_edition

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
    from ..loading.library import in_edition

    for family in families:
        # An overlay may remove parts that an edition changes. This is reported when the edition is requested.
        if family.device.base or family.without_overlays is not None or report.faults(family.document):
            continue
        for edition in family.device.editions:
            if edition.revision != family.device.manual.revision:
                # Only its report is needed, not the family in that edition.
                in_edition(family, edition.revision, report)
