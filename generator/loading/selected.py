"""Load only the families that a name or a label can belong to, from the cache if they are in it.

A few expressions find the names and the patterns of order codes in the text of the specs, without reading them as
YAML. What they find is kept, so that unchanged specs are not even opened. If the result could differ from the result of
reading all specs, nothing is selected.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..cache import Cache, content_of
from ..known_files import KnownFiles
from ..language.files import is_spec
from ..language.second_reading import is_second
from ..typed import fits
from .family_files import MANUFACTURER, family_files, spec_files

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


#: Kinds of files that can be selected.
_DEVICE, _MAKER, _MASTER = "device", "manufacturer", "master"


class _NotSelectable(Exception):
    """All specs must be read."""


@dataclass(frozen=True, slots=True)
class _DeviceFile:
    """A device file: its name, and the beginnings of its order codes or None if the text does not show them."""

    path: Path
    name: str
    beginnings: tuple[str, ...] | None

    def can_have(self, label: str) -> bool:
        return self.beginnings is None or label.startswith(self.beginnings)


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
        device_files = list(_device_files(paths, cache))
        name, label = text.strip().lower(), "".join(text.split()).upper()
        named_files = [device_file for device_file in device_files if device_file.name == name]
        if len(named_files) > 1:
            return None
        if named_files:
            return (_load(named_files[0].path, cache)[0],)
        # If the text shows the beginnings, they have been compared already.
        devices: list[Device] = []
        for device_file in device_files:
            if device_file.can_have(label):
                is_compared = device_file.beginnings and all(device_file.beginnings)
                devices += _load(device_file.path, cache, "" if is_compared else label)
        return tuple(devices)
    except (OSError, ValueError, TypeError, LookupError, AttributeError, _NotSelectable):
        return None


def has_family(paths: Sequence[Path], name: str, cache: Cache) -> bool:
    """Return True if one of the specs has a family of this name, without loading it."""
    try:
        # All files are looked at, because the results are stored after the last one.
        return name in {device_file.name for device_file in _device_files(paths, cache)}
    except (OSError, ValueError, TypeError, LookupError, AttributeError, _NotSelectable):
        return False


def _device_files(paths: Sequence[Path], cache: Cache) -> Iterator[_DeviceFile]:
    """Yield each device file.

    Raises:
        OSError: A file cannot be read.
        _NotSelectable: There is a file of another kind that can affect a family, other than its manufacturer's.
    """
    known_files = KnownFiles(cache, "glances", list(map(str, paths)))

    def glance(path: Path) -> Mapping[str, Any]:
        glance_data: Mapping[str, Any] = known_files.result(str(path), lambda: _glance(path))
        return glance_data

    has_maker = functools.cache(lambda folder: (folder / MANUFACTURER).is_file())
    for path in dict.fromkeys(spec_files(paths, lambda path: glance(path)["is_spec"] is not False)):
        kind, name, beginnings = glance(path)["shows"]
        if not fits([kind, name, *(beginnings or ())], list[str]):
            raise _NotSelectable
        if kind == _DEVICE and not is_second(path) and has_maker(path.parent):
            yield _DeviceFile(path, str(name), None if beginnings is None else tuple(map(str, beginnings)))
        elif kind != _MASTER and (kind != _MAKER or path.name != MANUFACTURER):
            raise _NotSelectable
    known_files.keep()


def _glance(path: Path) -> dict[str, Any]:
    """Return whether a file is a spec, its kind, and the name and the beginnings of order codes of a device.

    Raises:
        OSError: The file cannot be read.
    """
    if not path.is_file():
        raise OSError
    text = b"\n" + path.read_bytes()
    keys = set(_KEY.findall(text))
    names = _NAME.findall(text)
    shows: tuple[str, str, Sequence[str] | None] = ("", "", None)
    if not keys.isdisjoint(_MASTER_KEYS) and keys.isdisjoint((*_OTHER_KINDS, b"device")):
        shows = (_MASTER, "", None)
    elif len(names) == 1 and keys.isdisjoint(_OTHER_KINDS | _MASTER_KEYS):
        shows = (_DEVICE, names[0].decode(), _beginnings(text))
    elif b"device" not in keys and keys.isdisjoint(_OTHER_KINDS | _MASTER_KEYS):
        shows = (_MAKER, "", None)
    return {"is_spec": is_spec(path), "shows": shows}


def _beginnings(text: bytes) -> tuple[str, ...] | None:
    """Return the beginnings of order codes, in capitals and without spaces, or None if the text does not show them."""
    patterns = _PATTERN.findall(text)
    if not patterns or len(patterns) != len(_PATTERN_KEY.findall(text)):
        return None
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
    """Return the device of a spec. If the cache shows that it cannot have the order code ``label``, return none.

    Raises:
        _NotSelectable: The spec has problems or overlays.
    """
    from .stored import keep, kept

    files = family_files(spec)
    if any(".overlay." in path.name for path in files):
        raise _NotSelectable
    content = content_of(files)
    starts: Any = cache.get("beginnings", content) if label else None
    if fits(starts, list[str]):
        if not label.startswith(tuple(starts)):
            return ()
    elif label:
        found_alone = _beginnings_of_parts(spec)
        if content_of(family_files(spec)) == content:
            cache.put("beginnings", content, found_alone)
        if not label.startswith(found_alone):
            return ()
    cached_devices = kept(cache, content)
    if cached_devices is not None:
        return cached_devices[:1]
    from ..order_codes.labels import beginnings
    from .library import load_library

    devices, report = load_library([spec])
    if report or len(devices) != 1:
        raise _NotSelectable
    # The files must not have changed since their content was read.
    if content_of(family_files(spec)) == content:
        keep(cache, content, devices[0])
        cache.put("beginnings", content, beginnings(devices[0].order_code))
    return devices
