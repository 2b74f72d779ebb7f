"""The user's settings: the section ``[tool.codewheel]`` of a ``pyproject.toml``, or a file ``codewheel.yaml``.

Both have the same keys, and are checked like specs: each error is a problem with file, line and column. The nearest of
these files holds, in the current folder or above it, but not above the repository that the current folder is in.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..cache import Cache
from ..language.document import Document, Mark
from ..language.document import Path as Path_
from ..language.files import CONFIGURATION, REPOSITORY, is_spec
from ..language.problems import Report, suggestion
from ..language.read import read_document
from ..typed import fits

PYPROJECT = "pyproject.toml"
#: Text that a file with the section must contain. Other files are not parsed.
_NEEDED = b"tool.codewheel"
_HEADER = re.compile(r"^[ \t]*\[[ \t]*tool[ \t]*\.[ \t]*codewheel[ \t]*\]", re.MULTILINE)
_KEY = r"^[ \t]*[\"']?{}[\"']?[ \t]*=[ \t]*"
#: A comment, a text, or the end of a list.
_IN_A_LIST = re.compile(r"#[^\n]*|\"(?:[^\"\\\n]|\\.)*\"|'[^'\n]*'|\]")
_WHERE = re.compile(r" \(at (?:line ([0-9]+), column ([0-9]+)|end of document)\)$")
#: Kind of entry in the cache for a section without errors.
_KIND = "configuration"
_LIST, _TEXT = "a list of texts", "a text"
#: What each key has. A selection by grade or target can be added as a further key.
_KEYS = {"specs": _LIST, "output": _TEXT, "targets": _LIST}
_EXAMPLES = {"specs": '["specs"]', "output": '"generated"', "targets": '["c", "docs"]'}


@dataclass(frozen=True, slots=True)
class Configuration:
    """The settings in a file.

    Attributes:
        file: The file.
        specs: Paths of specs, relative to the current folder. Empty if the file lists none.
        output: The output folder, or None for the default.
        targets: Names of the targets to write. Empty for the default.
        document: The file as read, for messages about it.
    """

    file: Path
    specs: tuple[Path, ...] = ()
    output: Path | None = None
    targets: tuple[str, ...] = ()
    document: Document | None = field(default=None, compare=False)

    @property
    def folder(self) -> Path:
        """Folder to which the paths in the file are relative."""
        return self.file.parent


def configuration_above(cache: Cache, report: Report) -> Configuration | None:
    """Return the settings that hold for the current folder, or None, and report the errors in them."""
    for folder in _folders_above():
        files = [path for path in (folder / PYPROJECT, folder / CONFIGURATION) if os.path.isfile(path)]
        found = [item for path in files if (item := _read(path, cache, report)) is not None]
        if len(found) > 1:
            message = f"{PYPROJECT} next to it also has [tool.codewheel]; keep the settings in one of them"
            report.add_at(str(found[1].file), 1, 1, "duplicate-name", message)
        if found or report:
            return found[0] if found else None
        if os.path.lexists(folder / REPOSITORY):
            return None
    return None


def report_setting(settings: Configuration, path: Path_, rule: str, message: str) -> Report:
    """Return a report with an error in a setting that was found later, such as the name of a target."""
    report, found = Report(), Report()
    again = _read(settings.file, Cache(None), report)
    if again is not None and again.document is not None:
        found.add(rule, again.document, path, message)
    return found


def _folders_above() -> Iterator[Path]:
    """Yield the current folder and those above it, relative to it, so that messages have short paths."""
    try:
        above = len(Path.cwd().parents)
    except OSError:  # The current folder has been removed.
        return
    yield Path()
    for count in range(1, above + 1):
        yield Path(*[os.pardir] * count)


def _read(file: Path, cache: Cache, report: Report) -> Configuration | None:
    """Return the settings in a file, or None if it has none."""
    try:
        if file.name == CONFIGURATION:
            return None if is_spec(file) else _checked(file, read_document(file, report, cache=cache), report)
        content = file.read_bytes()
    except OSError as error:
        report.add_at(str(file), 1, 1, "unreadable", f"the file cannot be read: {error.strerror or error}")
        return None
    if _NEEDED not in content:
        return None
    known = cache.get(_KIND, [content])
    if fits(known, dict[str, list[str]]) and all(map(_exists, (kept := _settings(file, known)).specs)):
        return kept
    document = _document(file, content, report)
    found = None if document is None else _checked(file, document, report)
    if found is not None and not report:
        cache.put(_KIND, [content], _as_lists(found))
    return found


def _document(file: Path, content: bytes, report: Report) -> Document | None:
    """Return the section of a pyproject.toml as a document, or None if there is none or it cannot be read."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        text = content.decode("utf-8")
        data = tomllib.loads(text)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"
        report.add_at(str(file), line, 1, "not-text", message)
        return None
    except tomllib.TOMLDecodeError as error:
        line, column, message = _place_of(str(error), content.decode("utf-8"))
        shown = content.decode("utf-8").splitlines()[line - 1 : line]
        report.add_at(str(file), line, column, "toml-syntax", f"not valid TOML: {message}", text="".join(shown))
        return None
    tools = data.get("tool")
    section = tools.get("codewheel") if isinstance(tools, dict) else None
    if section is None:
        return None
    lines = tuple(text.split("\n"))
    if not isinstance(section, dict):
        return Document(str(file), lines, {"codewheel": section}, Mark(1, 1, 1, 1))
    return Document(str(file), lines, section, _marks(text, section))


def _place_of(message: str, text: str) -> tuple[int, int, str]:
    """Return line, column and the rest of a message of the TOML parser."""
    place = _WHERE.search(message)
    if place is not None and place[1] is not None:
        return int(place[1]), int(place[2]), message[: place.start()]
    lines = text.splitlines() or [""]
    return len(lines), max(len(lines[-1]), 1), message if place is None else message[: place.start()]


def _marks(text: str, section: Mapping[str, Any]) -> Mark:
    """Return the places of the section, of its keys and of the texts in its lists."""

    def at(offset: int) -> tuple[int, int]:
        return text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)

    header = _HEADER.search(text)
    start = header.end() if header is not None else 0
    line, column = at(header.start()) if header is not None else (1, 1)
    marks = Mark(line, column, line, column)
    for key, value in section.items():
        found = re.compile(_KEY.format(re.escape(key)), re.MULTILINE).search(text, start)
        if found is None:
            continue
        key_line, key_column = at(found.start() + len(found[0]) - len(found[0].lstrip()))
        mark = Mark(*at(found.end()), key_line, key_column)
        marks.children[key] = mark
        if isinstance(value, list):
            for index, offset in zip(range(len(value)), _texts_of_a_list(text, found.end()), strict=False):
                mark.children[index] = Mark(*at(offset), *at(offset))
    return marks


def _texts_of_a_list(text: str, start: int) -> Iterator[int]:
    """Yield the offset of each text in the list that begins at ``start``."""
    for found in _IN_A_LIST.finditer(text, start):
        if found[0] == "]":
            return
        if not found[0].startswith("#"):
            yield found.start()


def _checked(file: Path, document: Document | None, report: Report) -> Configuration | None:
    """Return the settings in a document. Parts with errors are reported and left out."""
    if document is None:
        return None
    found: dict[str, list[str]] = {}
    for key, value in document.data.items():
        kind = _KEYS.get(key)
        if kind is None:
            message = f"unknown key '{key}'{suggestion(str(key), _KEYS, 'known keys')}"
            report.add("unknown-key", document, (key,), message, at_key=True)
        elif (texts := _texts(value, kind)) is None:
            report.add("wrong-type", document, (key,), f"'{key}' must be {kind}, such as {_example(key, file)}")
        else:
            found[key] = texts
    settings = _settings(file, found, document)
    for index, path in enumerate(settings.specs):
        if not _exists(path):
            message = f"there is no file or folder {path.as_posix()}"
            report.add("undefined-reference", document, ("specs", index), message)
    return settings


def _example(key: str, file: Path) -> str:
    value = _EXAMPLES[key] if file.name == PYPROJECT else _EXAMPLES[key].replace('"', "")
    return f"{key} = {value}" if file.name == PYPROJECT else f"{key}: {value}"


def _texts(value: Any, kind: str) -> list[str] | None:
    """Return the texts of a value, or None if it is not of this kind or has an empty text."""
    values = value if kind == _LIST else [value]
    is_valid = isinstance(values, list) and values and all(isinstance(item, str) and item for item in values)
    return list(values) if is_valid else None


def _exists(path: Path) -> bool:
    with suppress(OSError, ValueError):
        return os.path.lexists(path)
    return False


def _settings(file: Path, found: Mapping[str, list[str]], document: Document | None = None) -> Configuration:
    folder = file.parent
    output = next((folder / text for text in found.get("output", ())), None)
    specs = tuple(folder / text for text in found.get("specs", ()))
    return Configuration(file, specs, output, tuple(found.get("targets", ())), document)


def _as_lists(found: Configuration) -> dict[str, list[str]]:
    """Return the settings as they are in the file, for the cache."""
    data = found.document.data if found.document is not None else {}
    return {key: [value] if isinstance(value, str) else value for key, value in data.items()}
