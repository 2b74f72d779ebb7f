"""Select the specs that can have a family or an order code, without reading them as YAML, which would take long.

Regular expressions find the names of families and the beginnings of order codes in the text of the specs. If the
selection could be wrong, nothing is selected, and the caller reads all specs.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache import Cache, content_of
from ..language.files import MANUFACTURER, family_files, is_second, spec_files
from ..loading.stored import store_device, stored_device

if TYPE_CHECKING:
    from ..model import Device


#: Keys of files that can change a family of another file, and keys of descriptions of masters, which cannot.
_OTHER_KINDS = frozenset((b"overlay", b"changes"))
_MASTER_KEYS = frozenset((b"master", b"takes"))
_TOP_LEVEL_KEY = re.compile(rb"\n([a-z_]+)[ \t]*:(?=[ \t\r\n]|$)")
_DEVICE_NAME = re.compile(rb"\ndevice[ \t]*:[ \t]*([a-z][a-z0-9_]*)[ \t]*(?:#[^\n]*)?(?=\r?\n)")
_PATTERN_KEY = re.compile(rb"pattern['\"]?[ \t]*:")
_ORDER_CODE_PATTERN = re.compile(rb"pattern[ \t]*:[ \t]*\"([^\"\\{}\r\n]*)\{")
_ORDER_CODE = re.compile(r"\norder_code[ \t]*:[ \t]*(?=[\r\n]).*?(?=\n[^ #\r\n]|\Z)", re.DOTALL)

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

    def can_have(self, label: str) -> bool:
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
            if not device_file.can_have(label):
                continue
            # If the text shows the beginnings, ``can_have`` has already compared them with the label.
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
    keys = set(_TOP_LEVEL_KEY.findall(spec_text))
    device_names = _DEVICE_NAME.findall(spec_text)
    if not keys.isdisjoint(_OTHER_KINDS):
        return _SpecFile(path)
    # If a file has the key of a device, but also keys of a master or not exactly one name, its kind is not known.
    has_device_key = b"device" in keys
    if not keys.isdisjoint(_MASTER_KEYS):
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

    order_code_section = _ORDER_CODE.search("\n" + spec.read_text(encoding="utf-8"))
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
