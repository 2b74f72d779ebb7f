"""Models as plain data for the cache, and the choice of the families that a name or a label can belong to.

An object is a list that begins with the position of its class in ``_CLASSES``. Objects that occur more than once are
stored once. Only objects of the model can be built, so no data can run other code.

A few expressions find the names and the patterns of order codes in the text of the specs, without reading them as
YAML. If the result could differ from the result of reading all specs, nothing is selected.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any

from .. import model
from ..cache import Cache, content_of
from ..language.files import MANUFACTURER, family_files, spec_files
from ..language.schema_files import is_second
from ..model import (
    device,
    expressions,
    facts,
    fields,
    interfaces,
    kinds,
    layout,
    measurement,
    order_codes,
    registers,
    steps,
)
from ..model import facts as examples

if TYPE_CHECKING:
    from ..model import Device


_MODULES: tuple[ModuleType, ...] = (
    *(
        device,
        examples,
        expressions,
        facts,
        fields,
        interfaces,
        kinds,
        layout,
        measurement,
        order_codes,
        registers,
        steps,
    ),
)


def _types_in(module: ModuleType) -> list[type]:
    """Return the classes that a module defines itself."""
    values = vars(module).values()
    return [value for value in values if isinstance(value, type) and value.__module__ == module.__name__]


def _member_names(kind: type) -> tuple[str, ...]:
    return tuple(member.name for member in dataclasses.fields(kind))


def _has_keywords(kind: type) -> bool:
    """Return True if a class must be called with keywords."""
    return any(member.kw_only for member in dataclasses.fields(kind))


_TYPES = tuple(kind for module in _MODULES for kind in _types_in(module))
_CLASSES: tuple[type, ...] = tuple(kind for kind in _TYPES if dataclasses.is_dataclass(kind))
_ENUMS: tuple[type[Enum], ...] = tuple(kind for kind in _TYPES if issubclass(kind, Enum))
_NAMES = tuple(map(_member_names, _CLASSES))
_BY_KEYWORD = tuple(map(_has_keywords, _CLASSES))
_INDEX = {kind: index for index, kind in enumerate(_CLASSES)}
_MAP, _OBJECT, _ENUM, _BYTES = "m", "o", "e", "b"
#: Kind of entry in the cache for the model of a family.
_FAMILY = "family"


class NotStorable(Exception):
    """The data does not have the form of a model."""


def stored_device(cache: Cache, content: Sequence[bytes | str]) -> model.Device | None:
    """Return the device that ``store_device`` stored for files with this content, or None."""
    with suppress(NotStorable):
        rows = cache.get(_FAMILY, content)
        return None if rows is None else from_data(rows)
    return None


def store_device(cache: Cache, content: Sequence[bytes | str], device: model.Device) -> None:
    """Store a device whose spec has no problems. ``content`` is that of all files on which it depends."""
    with suppress(NotStorable):
        cache.put(_FAMILY, content, as_data(device))


def digest_of(device: model.Device) -> str:
    """Return a hash of everything in a model, for the keys of results that depend only on the model.

    Models from the same spec with other comments have the same digest. It is empty if the model cannot be stored.
    """
    with suppress(NotStorable):
        return hashlib.sha256(json.dumps(as_data(device), separators=(",", ":")).encode()).hexdigest()
    return ""


def as_data(device: model.Device) -> list[Any]:
    """Return a device as data that JSON can express.

    Raises:
        NotStorable: A member has a type that models did not have so far.
    """
    rows: list[Any] = []
    row_by_id: dict[int, int] = {}

    def put(value: Any) -> Any:
        kind = type(value)
        if value is None or kind in (bool, int, float, str):
            return value
        if kind is bytes:
            return {_BYTES: value.hex()}
        if kind is tuple:
            return [put(part) for part in value]
        if kind in _INDEX:
            if id(value) not in row_by_id:
                index = _INDEX[kind]
                rows.append([index, *(put(getattr(value, name)) for name in _NAMES[index])])
                row_by_id[id(value)] = len(rows) - 1
            return {_OBJECT: row_by_id[id(value)]}
        if isinstance(value, Enum) and kind in _ENUMS:
            return {_ENUM: [_ENUMS.index(kind), value.name]}
        if isinstance(value, Mapping):
            return {_MAP: [[put(key), put(member)] for key, member in value.items()], "f": kind is MappingProxyType}
        raise NotStorable(kind.__name__)

    put(device)
    return rows


def from_data(rows: Any) -> model.Device:
    """Return the device that ``as_data`` converted.

    Raises:
        NotStorable: The data does not describe a device.
    """
    built: list[Any] = []
    try:
        for index, *parts in rows:
            kind, values = _CLASSES[index], [_rebuilt(part, built) for part in parts]
            if _BY_KEYWORD[index]:
                built.append(kind(**dict(zip(_NAMES[index], values, strict=True))))
            else:
                built.append(kind(*values))
        device = built[-1]
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise NotStorable(str(error)) from None
    if not isinstance(device, model.Device):
        raise NotStorable(type(device).__name__)
    return device


def _rebuilt(value: Any, built: Sequence[Any]) -> Any:
    """Return the value of a member, which may refer to objects that were built before."""
    if isinstance(value, list):
        return tuple([_rebuilt(member, built) for member in value])
    if not isinstance(value, dict):
        return value
    if _OBJECT in value:
        return built[value[_OBJECT]]
    if _ENUM in value:
        index, name = value[_ENUM]
        return _ENUMS[index][name]
    if _BYTES in value:
        return bytes.fromhex(value[_BYTES])
    mapping = {_rebuilt(key, built): _rebuilt(member, built) for key, member in value[_MAP]}
    return MappingProxyType(mapping) if value["f"] else mapping


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
    from ..language.read import Unreadable, parse
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
