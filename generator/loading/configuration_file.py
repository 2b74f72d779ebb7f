"""Read a file with settings, and report its errors like those of a spec, also at their places in TOML."""

from __future__ import annotations

import re
import sys
from bisect import bisect_right
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ..language.document import Document, Mark
from ..language.document import Path as Place
from ..language.files import CONFIGURATION
from ..language.problems import Report, listed, nearest_choice, quoted, suggestion
from .configuration import PYPROJECT, Configuration, FamilyFilter, Faulty, exists

_TOKEN = re.compile(
    r"""
    (?P<blank>[ \t\r]+|\#[^\n]*)
    | (?P<newline>\n)
    | (?P<text>\"{3}(?:\\.|[^\\])*?\"{3}(?!\") | '{3}.*?'{3}(?!') | \"(?:\\.|[^\"\\])*\" | '[^']*')
    | (?P<sign>[][{}=,.])
    | (?P<word>[^][{}=,.\s\#\"']+)
    """,
    re.VERBOSE | re.DOTALL,
)
_VALUE_ENDS = ("\n", ",", "]", "}")


def places_in(text: str) -> Mark:
    """Return the places of all keys and values in a text that is valid TOML.

    A table has the place of its name in the header that begins it. Keys with escapes are not found by their name.
    """
    return _PlaceFinder(text).document()


class _PlaceFinder:
    """Reads the tokens of a text from the first to the last, and marks the places of keys and values."""

    def __init__(self, text: str) -> None:
        self._tokens = [token for token in _TOKEN.finditer(text) if token.lastgroup != "blank"]
        self._index = 0
        self._line_starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def document(self) -> Mark:
        """Return the marks of all keys and values."""
        root = Mark(1, 1, 1, 1)
        table = root
        while self._token():
            if self._token() == "\n":
                self._index += 1
            elif self._token() == "[":
                table = self._header(root)
            else:
                self._setting(table)
        return root

    def _token(self) -> str:
        """Return the text of the next token, or an empty string at the end."""
        return self._tokens[self._index][0] if self._index < len(self._tokens) else ""

    def _place(self) -> tuple[int, int]:
        """Return line and column of the next token, both from 1."""
        offset = self._tokens[self._index].start()
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def _skip_newlines(self) -> None:
        while self._token() == "\n":
            self._index += 1

    def _header(self, root: Mark) -> Mark:
        """Read the header of a table, and return the mark of the table."""
        while self._token() == "[":
            self._index += 1
        table = self._key(root)
        while self._token() == "]":
            self._index += 1
        return table

    def _key(self, table: Mark) -> Mark:
        """Read a key, which can be dotted, and return its mark below the mark of a table."""
        mark = table
        while self._token() not in ("", "=", "]", "\n"):
            name = self._token()
            if name != ".":
                place = self._place()
                bare_name = name[1:-1] if name[0] in "\"'" else name
                mark = mark.children.setdefault(bare_name, Mark(*place, *place))
            self._index += 1
        return mark

    def _setting(self, table: Mark) -> None:
        """Read a key and its value."""
        mark = self._key(table)
        self._index += 1  # The equals sign.
        if self._token():
            mark.line, mark.column = self._place()
            self._value(mark)

    def _value(self, mark: Mark) -> None:
        if self._token() == "[":
            self._array(mark)
        elif self._token() == "{":
            self._inline_table(mark)
        else:
            while self._token() and self._token() not in _VALUE_ENDS:
                self._index += 1

    def _array(self, mark: Mark) -> None:
        self._index += 1
        self._skip_newlines()
        while self._token() not in ("", "]"):
            place = self._place()
            value_mark = mark.children.setdefault(len(mark.children), Mark(*place, *place))
            self._value(value_mark)
            self._skip_separator()
        self._index += 1

    def _inline_table(self, mark: Mark) -> None:
        self._index += 1
        self._skip_newlines()
        while self._token() not in ("", "}"):
            self._setting(mark)
            self._skip_separator()
        self._index += 1

    def _skip_separator(self) -> None:
        self._skip_newlines()
        if self._token() == ",":
            self._index += 1
        self._skip_newlines()


_WHERE = re.compile(r" \(at (?:line ([0-9]+), column ([0-9]+)|end of document)\)$")
#: All settings, and those in the condition of a target.
_KEYS = ("specs", "output", "targets", "only")
_FILTER_KEYS = ("families", "grades")
#: Values in TOML, by key.
_EXAMPLES = {
    "specs": '["specs"]',
    "output": '"generated"',
    "targets": '["c", "docs"]',
    "only": '{docs = {grades = ["manual", "quoted"]}}',
    "families": '["my_encoder"]',
    "grades": '["manual", "quoted"]',
}
_EXAMPLE_OF_A_FILTER = '{families = ["my_encoder"]}'

#: Messages of rules whose own messages are about specs.
_MESSAGES = {
    "empty": "the file is empty; write a setting, such as specs: [specs], or remove it",
    "not-a-map": "settings are a map of keys, such as specs: [specs]",
}


def read_configuration(file: Path) -> Configuration | None:
    """Return the settings in a file, or None if it has none.

    Raises:
        Faulty: There are errors in the settings.
    """
    report = Report()
    document = _read(file, report, has_places=False)  # With an error, errors_in reads the file again.
    configuration = None if document is None else _configuration(file, document, report)
    if report:
        raise Faulty(file)
    return configuration


def errors_in(files: tuple[Path, ...]) -> Report:
    """Return a report with the errors in these files, which are next to each other."""
    report = Report()
    for file in files:
        document = _read(file, report)
        if document is not None:
            _configuration(file, document, report)
    if len(files) > 1 and not report:
        message = f"{PYPROJECT} next to it also has [tool.codewheel]; keep the settings in one of them"
        report.add_at(str(files[1]), 1, 1, "duplicate-name", message)
    return report


def add_error(report: Report, file: Path, place: Place, rule: str, message: str, *, at_key: bool = False) -> None:
    """Add an error in a setting that was found later, such as in the name of a target."""
    document = _read(file, Report())
    if document is not None:
        report.add(rule, document, place, message, at_key=at_key)


def _read(file: Path, report: Report, *, has_places: bool = True) -> Document | None:
    """Return the settings in a file as a document, or None if there are none or they cannot be read.

    Without places, a ``pyproject.toml`` is read in half the time.
    """
    return _yaml_document(file, report) if file.name == CONFIGURATION else _section(file, report, has_places)


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


def _section(file: Path, report: Report, has_places: bool) -> Document | None:
    """Return the section of a pyproject.toml as a document, or None if there is none or it cannot be read."""
    try:
        content = file.read_bytes()
    except OSError as error:
        report.add_at(str(file), 1, 1, "unreadable", f"the file cannot be read: {error.strerror or error}")
        return None
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"
        report.add_at(str(file), line, 1, "not-text", message)
        return None
    data = _parsed_toml(file, text, report)
    tools = data.get("tool")
    section = tools.get("codewheel") if isinstance(tools, dict) else None
    if section is None:
        return None
    lines = tuple(text.split("\n"))
    if not isinstance(section, dict):
        return Document(str(file), lines, {"codewheel": section}, Mark(1, 1, 1, 1))
    marks = places_in(text) if has_places else Mark(1, 1, 1, 1)
    for name in ("tool", "codewheel"):
        marks = marks.children.get(name, Mark(1, 1, 1, 1))
    return Document(str(file), lines, section, marks)


def _parsed_toml(file: Path, text: str, report: Report) -> dict[str, Any]:
    """Return the data of a TOML file, or an empty map if it is not valid, which is reported."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        data: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        line, column, message = _place_of(str(error), text)
        error_line = "".join(text.splitlines()[line - 1 : line])
        report.add_at(str(file), line, column, "toml-syntax", f"not valid TOML: {message}", text=error_line)
        return {}
    return data


def _place_of(message: str, text: str) -> tuple[int, int, str]:
    """Return line, column and the rest of a message of the TOML parser. Without a place, it is the end of the text."""
    lines = text.splitlines() or [""]
    line, column = len(lines), max(len(lines[-1]), 1)
    place = _WHERE.search(message)
    if place is None:
        return line, column, message
    if place[1] is not None:
        line, column = int(place[1]), int(place[2])
    return line, column, message[: place.start()]


def _configuration(file: Path, document: Document, report: Report) -> Configuration:
    """Return the settings in a document. Settings with errors are reported and left out."""
    settings = document.data
    _report_unknown_keys(document, (), settings, _KEYS, report)
    output = _text_at(document, "output", report)
    configuration = Configuration(
        file=file,
        specs=tuple(file.parent / text for text in _texts_at(document, settings, ("specs",), report)),
        output=file.parent / output if output else None,
        targets=_texts_at(document, settings, ("targets",), report),
        only=_filters(document, report),
    )
    for index, path in enumerate(configuration.specs):
        if not exists(path):
            message = f"there is no file or folder {path.as_posix()}"
            report.add("undefined-reference", document, ("specs", index), message)
    return configuration


def _report_unknown_keys(
    document: Document, place: Place, keys: Iterable[Any], known_keys: Iterable[str], report: Report
) -> None:
    for key in keys:
        if key not in known_keys:
            message = f"unknown key '{key}'{suggestion(str(key), known_keys, 'known keys')}"
            report.add("unknown-key", document, (*place, key), message, at_key=True)


def _text_at(document: Document, key: str, report: Report) -> str:
    """Return a setting that is a text, or an empty string if it is missing or has an error."""
    value = document.data.get(key, "")
    if key in document.data and not _is_text(value):
        _report_type(document, (key,), "a text", _EXAMPLES[key], report)
    return value if _is_text(value) else ""


def _texts_at(document: Document, table: Mapping[Any, Any], place: Place, report: Report) -> tuple[str, ...]:
    """Return a setting that is a list of texts, or no texts if it is missing or has an error.

    ``table`` is the map with the last key of ``place``.
    """
    key = str(place[-1])
    if key not in table:
        return ()
    texts = table[key]
    if isinstance(texts, list) and texts and all(map(_is_text, texts)):
        return tuple(texts)
    _report_type(document, place, "a list of texts", _EXAMPLES[key], report)
    return ()


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value)


def _filters(document: Document, report: Report) -> dict[str, FamilyFilter]:
    """Return the conditions of all targets that have one."""
    if "only" not in document.data:
        return {}
    filters = document.data["only"]
    if not isinstance(filters, dict) or not filters:
        _report_type(document, ("only",), "a map of targets", _EXAMPLES["only"], report)
        return {}
    return {str(target): _filter(document, target, conditions, report) for target, conditions in filters.items()}


def _filter(document: Document, target: str, conditions: Any, report: Report) -> FamilyFilter:
    """Return the condition of a target. ``conditions`` is the value in the file."""
    place = ("only", target)
    if not isinstance(conditions, dict) or not conditions:
        _report_type(document, place, "a map with 'families' or 'grades'", _EXAMPLE_OF_A_FILTER, report)
        return FamilyFilter()
    _report_unknown_keys(document, place, conditions, _FILTER_KEYS, report)
    families = _texts_at(document, conditions, (*place, "families"), report)
    grades = _texts_at(document, conditions, (*place, "grades"), report)
    _report_unknown_grades(document, (*place, "grades"), grades, report)
    return FamilyFilter(families, grades)


def _report_unknown_grades(document: Document, place: Place, grades: Iterable[str], report: Report) -> None:
    from ..say.evidence import GRADES  # Settings without grades need no model.

    for index, grade in enumerate(grades):
        if grade not in GRADES:
            nearest_grade = nearest_choice(grade, GRADES)
            if nearest_grade:
                hint = f"did you mean '{nearest_grade}'?"
            else:
                hint = f"it can be {listed(map(quoted, GRADES), 'or')}"
            message = f"a grade cannot be {quoted(grade)}; {hint}"
            report.add("not-allowed", document, (*place, index), message)


def _report_type(document: Document, place: Place, kind: str, example: str, report: Report) -> None:
    """Report a value that is not of a kind. ``example`` is a correct value in TOML."""
    if Path(document.file).name == PYPROJECT:
        setting = f"{place[-1]} = {example}"
    else:
        setting = f"{place[-1]} = {example}".replace(" = ", ": ").replace('"', "")
    name = ".".join(map(str, place))
    report.add("wrong-type", document, place, f"'{name}' must be {kind}, such as {setting}")
