"""Load only the families that a name or a label can belong to, from the cache if they are in it.

A few expressions find the names and the patterns of order codes in the text of the specs, without reading them as
YAML. If the result could differ from the result of reading all specs, nothing is selected.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..cache import Cache, content_of
from ..language.schema_files import is_second
from .spec_files import MANUFACTURER, family_files, spec_files

if TYPE_CHECKING:
    from ..model import Device

#: Keys of files that can change a family, and those of descriptions of masters, which cannot.
_OTHER_KINDS = frozenset((b"overlay", b"changes"))
_MASTER_KEYS = frozenset((b"master", b"takes"))
_KEY = re.compile(rb"\n([a-z_]+)[ \t]*:(?=[ \t\r\n]|$)")
_NAME = re.compile(rb"\ndevice[ \t]*:[ \t]*([a-z][a-z0-9_]*)[ \t]*(?:#[^\n]*)?(?=\r?\n)")
_PATTERN_KEY = re.compile(rb"pattern['\"]?[ \t]*:")
_PATTERN = re.compile(rb"pattern[ \t]*:[ \t]*\"([^\"\\{}\r\n]*)\{")
_ORDER_CODE = re.compile(r"\norder_code[ \t]*:[ \t]*(?=[\r\n]).*?(?=\n[^ #\r\n]|\Z)", re.DOTALL)

#: Kind of entry in the cache for the beginnings of order codes that begin with a part.
_BEGINNINGS = "beginnings"
#: Kinds of files that can be selected.
_DEVICE, _MANUFACTURER, _MASTER = "device", "manufacturer", "master"


class _NotSelectable(Exception):
    """All specs must be read."""


@dataclass(frozen=True, slots=True)
class _SpecFile:
    """A spec: its kind, the name of its device, and the beginnings of its order codes.

    The kind is empty if the text does not show it. So are the beginnings, and then any label can belong to the device.
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
        cache: The place for families that were loaded before.

    Returns:
        The families, or None if all specs must be read, for example because one of them is an overlay.
    """
    try:
        device_files = _device_files(paths)
        name, label = text.strip().lower(), "".join(text.split()).upper()
        named_files = [device_file for device_file in device_files if device_file.name == name]
        if len(named_files) > 1:
            return None
        if named_files:
            return (_load(named_files[0].path, cache)[0],)
        devices: list[Device] = []
        for device_file in device_files:
            if device_file.can_have(label):
                # If the text shows the beginnings, they have been compared already.
                devices += _load(device_file.path, cache, "" if all(device_file.beginnings) else label)
        return tuple(devices)
    except (OSError, ValueError, _NotSelectable):
        return None


def has_family(paths: Sequence[Path], name: str) -> bool:
    """Return True if one of the specs has a family of this name, without loading it."""
    try:
        return name in {device_file.name for device_file in _device_files(paths)}
    except (OSError, ValueError, _NotSelectable):
        return False


def _device_files(paths: Sequence[Path]) -> list[_SpecFile]:
    """Return the device files.

    Raises:
        OSError: A file cannot be read.
        _NotSelectable: There is a file of another kind that can affect a family, other than its manufacturer's.
    """
    device_files = []
    has_manufacturer = functools.cache(lambda folder: (folder / MANUFACTURER).is_file())
    for path in dict.fromkeys(spec_files(paths)):
        spec_file = _spec_file(path)
        if spec_file.kind == _DEVICE and not is_second(path) and has_manufacturer(path.parent):
            device_files.append(spec_file)
        elif spec_file.kind != _MASTER and (spec_file.kind != _MANUFACTURER or path.name != MANUFACTURER):
            raise _NotSelectable
    return device_files


def _spec_file(path: Path) -> _SpecFile:
    """Return the kind of a spec, and the name and the beginnings of order codes of a device.

    Raises:
        OSError: The file cannot be read.
    """
    if not path.is_file():
        raise OSError
    text = b"\n" + path.read_bytes()
    keys = set(_KEY.findall(text))
    names = _NAME.findall(text)
    if not keys.isdisjoint(_OTHER_KINDS):
        return _SpecFile(path)
    if not keys.isdisjoint(_MASTER_KEYS):
        return _SpecFile(path, "" if b"device" in keys else _MASTER)
    if len(names) == 1:
        return _SpecFile(path, _DEVICE, names[0].decode(), _beginnings(text))
    return _SpecFile(path, "" if b"device" in keys else _MANUFACTURER)


def _beginnings(text: bytes) -> tuple[str, ...]:
    """Return the beginnings of order codes, in capitals and without spaces, or an empty one if there are none."""
    patterns = _PATTERN.findall(text)
    if not patterns or len(patterns) != len(_PATTERN_KEY.findall(text)):
        return ("",)
    return tuple("".join(pattern.decode("ascii", "replace").split()).upper() for pattern in patterns)


def _beginnings_of_parts(spec: Path) -> tuple[str, ...]:
    """Return the beginnings of order codes that begin with a part, from the data under ``order_code`` alone.

    If these data have problems or refer to other data, the result matches any label.
    """
    from ..language.yaml import Unreadable, parse
    from ..order_codes.labels import beginnings
    from .device import code_grammar

    section = _ORDER_CODE.search("\n" + spec.read_text(encoding="utf-8"))
    problems: list[object] = []
    try:
        data, _ = parse(section[0] if section else "", problems.append, problems.append)
        prefixes = beginnings(code_grammar(data["order_code"]))
    except (Unreadable, LookupError, TypeError, ValueError, AttributeError):
        return ("",)
    return ("",) if problems or "{" in "".join(prefixes) else prefixes


def _load(spec: Path, cache: Cache, label: str = "") -> Sequence[Device]:
    """Return the device of a spec, or nothing if it cannot have the order code ``label``.

    Raises:
        _NotSelectable: The spec has problems or overlays.
    """
    from .stored import store_device, stored_device

    files = family_files(spec)
    if any(".overlay." in path.name for path in files):
        raise _NotSelectable
    content = content_of(files)
    if label and not label.startswith(_cached_beginnings(spec, content, cache)):
        return ()
    device = stored_device(cache, content)
    if device is not None:
        return (device,)
    from .library import load_library

    devices, report = load_library([spec])
    if report or len(devices) != 1:
        raise _NotSelectable
    # The files must not have changed since their content was read.
    if content_of(family_files(spec)) == content:
        store_device(cache, content, devices[0])
    return devices


def _cached_beginnings(spec: Path, content: Sequence[bytes | str], cache: Cache) -> tuple[str, ...]:
    """Return the beginnings of order codes of a spec with this content, from the cache if they are in it."""
    stored = cache.get(_BEGINNINGS, content)
    if stored is not None:
        return tuple(stored)
    beginnings = _beginnings_of_parts(spec)
    if content_of(family_files(spec)) == content:
        cache.put(_BEGINNINGS, content, beginnings)
    return beginnings
