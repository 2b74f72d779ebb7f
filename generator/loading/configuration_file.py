"""Read a file with settings, and report its errors like those of a spec: with file, line and column."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..language.document import Document, Mark
from ..language.document import Path as Place
from ..language.files import CONFIGURATION
from ..language.problems import Report, suggestion
from .configuration import PYPROJECT, SETTINGS, Faulty, exists, settings_in

_HEADER = re.compile(r"^[ \t]*\[[ \t]*tool[ \t]*\.[ \t]*codewheel[ \t]*\]", re.MULTILINE)
_KEY = r"^[ \t]*[\"']?{}[\"']?[ \t]*=[ \t]*"
#: A comment, a text, or the end of a list.
_IN_A_LIST = re.compile(r"#[^\n]*|\"(?:[^\"\\\n]|\\.)*\"|'[^'\n]*'|\]")
_WHERE = re.compile(r" \(at (?:line ([0-9]+), column ([0-9]+)|end of document)\)$")
_LIST, _TEXT = "a list of texts", "a text"
#: What each key has. A selection by grade or by target can be added as a further key.
_KEYS = {"specs": _LIST, "output": _TEXT, "targets": _LIST}
_EXAMPLES = {"specs": '["specs"]', "output": '"generated"', "targets": '["c", "docs"]'}

#: Messages of rules whose own messages are about specs.
_MESSAGES = {
    "empty": "the file is empty; write a setting, such as specs: [specs], or remove it",
    "not-a-map": "settings are a map of keys, such as specs: [specs]",
}


def read_configuration(file: Path) -> dict[str, list[str]] | None:
    """Return the settings in a file as lists of texts by their keys, or None if it has none.

    Raises:
        Faulty: There are errors in the settings.
    """
    report = Report()
    document = _read(file, report)
    values = None if document is None else _values(file, document, report)
    if report:
        raise Faulty(file)
    return values


def errors_in(files: tuple[Path, ...]) -> Report:
    """Return a report with the errors in these files, which are next to each other."""
    report = Report()
    for file in files:
        document = _read(file, report)
        if document is not None:
            _values(file, document, report)
    if len(files) > 1 and not report:
        message = f"{PYPROJECT} next to it also has [tool.codewheel]; keep the settings in one of them"
        report.add_at(str(files[1]), 1, 1, "duplicate-name", message)
    return report


def error_at(file: Path, place: Place, rule: str, message: str) -> Report:
    """Return a report with an error in a setting that was found later, such as in the name of a target."""
    report = Report()
    document = _read(file, Report())
    if document is not None:
        report.add(rule, document, place, message)
    return report


def _read(file: Path, report: Report) -> Document | None:
    """Return the settings in a file as a document, or None if there are none or they cannot be read."""
    return _yaml_document(file, report) if file.name == CONFIGURATION else _section(file, report)


def _yaml_document(file: Path, report: Report) -> Document | None:
    """Return a codewheel.yaml as a document. Its messages are about settings, unlike those for a spec."""
    from ..language.read import read_document  # PyYAML takes longer to import than a frame to decode.

    reading = Report()
    document = read_document(file, reading)
    report.files += reading.files
    for problem in reading.problems:
        message = _MESSAGES.get(problem.rule, problem.message)
        report.add_at(problem.file, problem.line, problem.column, problem.rule, message, text=problem.text)
    return document


def _section(file: Path, report: Report) -> Document | None:
    """Return the section of a pyproject.toml as a document, or None if there is none or it cannot be read."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        content = file.read_bytes()
    except OSError as error:
        report.add_at(str(file), 1, 1, "unreadable", f"the file cannot be read: {error.strerror or error}")
        return None
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
        error_line = content.decode("utf-8").splitlines()[line - 1 : line]
        report.add_at(str(file), line, column, "toml-syntax", f"not valid TOML: {message}", text="".join(error_line))
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
        key_match = re.compile(_KEY.format(re.escape(key)), re.MULTILINE).search(text, start)
        if key_match is None:
            continue
        key_line, key_column = at(key_match.start() + len(key_match[0]) - len(key_match[0].lstrip()))
        mark = Mark(*at(key_match.end()), key_line, key_column)
        marks.children[key] = mark
        if isinstance(value, list):
            for index, offset in zip(range(len(value)), _texts_of_a_list(text, key_match.end()), strict=False):
                mark.children[index] = Mark(*at(offset), *at(offset))
    return marks


def _texts_of_a_list(text: str, start: int) -> Iterator[int]:
    """Yield the offset of each text in the list that begins at ``start``."""
    for token in _IN_A_LIST.finditer(text, start):
        if token[0] == "]":
            return
        if not token[0].startswith("#"):
            yield token.start()


def _values(file: Path, document: Document, report: Report) -> dict[str, list[str]]:
    """Return the settings in a document as lists of texts. Settings with errors are reported and left out."""
    settings: dict[str, list[str]] = {key: [] for key in SETTINGS}
    for key, value in document.data.items():
        kind = _KEYS.get(key)
        if kind is None:
            message = f"unknown key '{key}'{suggestion(str(key), _KEYS, 'known keys')}"
            report.add("unknown-key", document, (key,), message, at_key=True)
        elif (texts := _texts(value, kind)) is None:
            report.add("wrong-type", document, (key,), f"'{key}' must be {kind}, such as {_example(key, file)}")
        else:
            settings[key] = texts
    for index, path in enumerate(settings_in(file, settings).specs):
        if not exists(path):
            message = f"there is no file or folder {path.as_posix()}"
            report.add("undefined-reference", document, ("specs", index), message)
    return settings


def _example(key: str, file: Path) -> str:
    value = _EXAMPLES[key] if file.name == PYPROJECT else _EXAMPLES[key].replace('"', "")
    return f"{key} = {value}" if file.name == PYPROJECT else f"{key}: {value}"


def _texts(value: Any, kind: str) -> list[str] | None:
    """Return the texts of a value, or None if it is not of this kind or has an empty text."""
    values = value if kind == _LIST else [value]
    is_valid = isinstance(values, list) and values and all(isinstance(text, str) and text for text in values)
    return list(values) if is_valid else None
