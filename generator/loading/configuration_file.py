"""Read a file with settings in YAML or TOML, and report its errors at their places, like the errors of a spec."""

from __future__ import annotations

import re
import sys
from bisect import bisect_right
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..language.document import Document, SourceMark
from ..language.document import Path as Place
from ..language.files import CONFIGURATION
from ..language.problems import ProblemReport, join_words, nearest_choice, quoted, suggest_word
from .configuration import PYPROJECT, Configuration, FamilyFilter, Faulty, exists

_TOML_TOKEN = re.compile(
    r"""
    (?P<blank>[ \t\r]+|\#[^\n]*)
    | (?P<newline>\n)
    | (?P<text>\"{3}(?:\\.|[^\\])*?\"{3}(?!\") | '{3}.*?'{3}(?!') | \"(?:\\.|[^\"\\])*\" | '[^']*')
    | (?P<sign>[][{}=,.])
    | (?P<word>[^][{}=,.\s\#\"']+)
    """,
    re.VERBOSE | re.DOTALL,
)
#: Tokens after a number, date or Boolean value in TOML. A value in quotes is one token.
_VALUE_ENDS = ("\n", ",", "]", "}")


def places_in(toml_text: str) -> SourceMark:
    """Return the line and column of each key and value in a text that is valid TOML, as a tree of marks.

    The place of a table is its name in the header that begins it. Keys with escape sequences have no place.
    """
    return _PlaceFinder(toml_text).mark_all()


class _PlaceFinder:
    """Reads the tokens of a TOML text from the first to the last, and marks the places of keys and values."""

    def __init__(self, text: str) -> None:
        self._tokens = [token for token in _TOML_TOKEN.finditer(text) if token.lastgroup != "blank"]
        self._index = 0
        self._line_starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def mark_all(self) -> SourceMark:
        """Return the mark of the whole text, whose children are the marks of all keys and values."""
        root_mark = SourceMark(line=1, column=1, key_line=1, key_column=1)
        # The mark of the table that the header above the current line begins.
        table_mark = root_mark
        while self._peek_token():
            if self._peek_token() == "\n":
                self._index += 1
            elif self._peek_token() == "[":
                table_mark = self._read_table_header(root_mark)
            else:
                self._read_setting(table_mark)
        return root_mark

    def _peek_token(self) -> str:
        """Return the text of the next token without consuming it, or "" at the end of the text."""
        return self._tokens[self._index][0] if self._index < len(self._tokens) else ""

    def _place_of_token(self) -> tuple[int, int]:
        """Return the line and the column of the next token, both counted from 1."""
        offset = self._tokens[self._index].start()
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def _skip_newlines(self) -> None:
        while self._peek_token() == "\n":
            self._index += 1

    def _read_table_header(self, root_mark: SourceMark) -> SourceMark:
        """Read the header of a table, such as ``[tool.codewheel]``, and return the mark of the table."""
        while self._peek_token() == "[":
            self._index += 1
        table_mark = self._read_dotted_key(root_mark)
        while self._peek_token() == "]":
            self._index += 1
        return table_mark

    def _read_dotted_key(self, table_mark: SourceMark) -> SourceMark:
        """Read a key, which can be dotted such as ``tool.codewheel``, and return the mark of its last name.

        The first name gets a mark below ``table_mark``, and each further name below the mark of the name before it. An
        existing mark keeps its place.
        """
        mark = table_mark
        while self._peek_token() not in ("", "=", "]", "\n"):
            name = self._peek_token()
            if name != ".":
                place = self._place_of_token()
                is_quoted = name[0] in "\"'"
                bare_name = name[1:-1] if is_quoted else name
                mark = mark.children.setdefault(bare_name, SourceMark(*place, *place))
            self._index += 1
        return mark

    def _read_setting(self, table_mark: SourceMark) -> None:
        """Read a key, the equals sign and the value, and mark the place of the value in the mark of the key."""
        key_mark = self._read_dotted_key(table_mark)
        self._index += 1  # The equals sign.
        if self._peek_token():
            key_mark.line, key_mark.column = self._place_of_token()
            self._read_value(key_mark)

    def _read_value(self, key_mark: SourceMark) -> None:
        """Read a value. The mark of its key gets children for the members of an array or an inline table."""
        if self._peek_token() == "[":
            self._read_array(key_mark)
        elif self._peek_token() == "{":
            self._read_inline_table(key_mark)
        else:
            while self._peek_token() and self._peek_token() not in _VALUE_ENDS:
                self._index += 1

    def _read_array(self, key_mark: SourceMark) -> None:
        """Read an array, and mark each value in it below ``key_mark``, by its index."""
        self._index += 1
        self._skip_newlines()
        while self._peek_token() not in ("", "]"):
            place = self._place_of_token()
            value_mark = key_mark.children.setdefault(len(key_mark.children), SourceMark(*place, *place))
            self._read_value(value_mark)
            self._skip_separator()
        self._index += 1

    def _read_inline_table(self, key_mark: SourceMark) -> None:
        """Read an inline table such as ``{docs = "a"}``, and mark each key in it below ``key_mark``."""
        self._index += 1
        self._skip_newlines()
        while self._peek_token() not in ("", "}"):
            self._read_setting(key_mark)
            self._skip_separator()
        self._index += 1

    def _skip_separator(self) -> None:
        """Skip a comma, and newlines before and after it."""
        self._skip_newlines()
        if self._peek_token() == ",":
            self._index += 1
        self._skip_newlines()


#: The place at the end of a message of the TOML parser.
_PLACE_IN_MESSAGE = re.compile(r" \(at (?:line (?P<line>[0-9]+), column (?P<column>[0-9]+)|end of document)\)$")
#: All settings, and the settings in the condition of a target.
_SETTING_KEYS = ("specs", "output", "targets", "only")
_FILTER_KEYS = ("families", "grades")
#: Values in TOML, by key.
_EXAMPLE_VALUES = {
    "specs": '["specs"]',
    "output": '"generated"',
    "targets": '["c", "docs"]',
    "only": '{docs = {grades = ["manual", "quoted"]}}',
    "families": '["my_encoder"]',
    "grades": '["manual", "quoted"]',
}
_EXAMPLE_OF_A_FILTER = '{families = ["my_encoder"]}'

#: Messages of rules whose own messages are about specs.
_MESSAGES_OF_RULES = {
    "empty": "the file is empty; write a setting, such as specs: [specs], or remove it",
    "not-a-map": "settings are a map of keys, such as specs: [specs]",
}


def read_configuration(file: Path) -> Configuration | None:
    """Return the settings in a file, or None if it contains none.

    Raises:
        Faulty: There are errors in the settings.
    """
    report = ProblemReport()
    # If there is an error, ``errors_in`` reads the file again, with the places of errors.
    document = _read_settings(file, report, has_places=False)
    configuration = None if document is None else _build_configuration(file, document, report)
    if report.problems:
        raise Faulty(file)
    return configuration


def errors_in(files: tuple[Path, ...]) -> ProblemReport:
    """Return a report with the errors in these files, which are next to each other.

    If none of the files has an error, a second file is reported, because only one file may contain settings.
    """
    report = ProblemReport()
    for file in files:
        document = _read_settings(file, report)
        if document is not None:
            # The result is not needed, only the errors that are reported.
            _build_configuration(file, document, report)
    if len(files) > 1 and not report:
        message = f"{PYPROJECT} next to it also has [tool.codewheel]; keep the settings in one of them"
        report.add_at(str(files[1]), "duplicate-name", message)
    return report


def add_error(
    report: ProblemReport, file: Path, place: Place, rule: str, message: str, *, at_key: bool = False
) -> None:
    """Report an error in a setting that was found after reading the file, for example in the name of a target.

    The file is read again to find the place of the setting. If it can no longer be read, nothing is reported.
    """
    document = _read_settings(file, ProblemReport())
    if document is not None:
        report.add(rule, document, place, message, at_key=at_key)


def _read_settings(file: Path, report: ProblemReport, *, has_places: bool = True) -> Document | None:
    """Return the settings in a file as a document, or None if it contains none or cannot be read.

    If ``has_places`` is false, a ``pyproject.toml`` is read in half the time, and all its keys have the place 1:1.
    """
    if file.name == CONFIGURATION:
        return _read_yaml_settings(file, report)
    return _read_pyproject_table(file, report, has_places=has_places)


def _read_yaml_settings(file: Path, report: ProblemReport) -> Document | None:
    """Return a codewheel.yaml as a document, or None if it cannot be read.

    Problems are reported with messages about settings instead of specs.
    """
    from ..language.read import read_document  # Importing PyYAML takes longer than decoding a frame.

    yaml_report = ProblemReport()
    document = read_document(file, yaml_report)
    report.files += yaml_report.files
    for problem in yaml_report.problems:
        message = _MESSAGES_OF_RULES.get(problem.rule, problem.message)
        report.add_problem(replace(problem, message=message, path="", cause=""))
    return document


def _read_pyproject_table(file: Path, report: ProblemReport, *, has_places: bool) -> Document | None:
    """Return the table ``[tool.codewheel]`` of a pyproject.toml as a document.

    Return None if there is no such table, or if the file cannot be read, which is reported. If ``tool.codewheel`` is
    not a table, the document contains it under the key ``codewheel``, which is later reported as unknown.
    """
    try:
        content = file.read_bytes()
    except OSError as error:
        report.add_at(str(file), "unreadable", f"the file cannot be read: {error.strerror or error}")
        return None
    try:
        toml_text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"
        report.add_at(str(file), "not-text", message, line=line)
        return None
    toml_data = _parse_toml(file, toml_text, report)
    tool_table = toml_data.get("tool")
    section = tool_table.get("codewheel") if isinstance(tool_table, dict) else None
    if section is None:
        return None
    toml_lines = tuple(toml_text.split("\n"))
    start_of_file = SourceMark(line=1, column=1, key_line=1, key_column=1)
    if not isinstance(section, dict):
        return Document(file=str(file), lines=toml_lines, data={"codewheel": section}, marks=start_of_file)
    marks = places_in(toml_text) if has_places else start_of_file
    # The marks of the settings are below the marks of "tool" and "codewheel".
    for name in ("tool", "codewheel"):
        marks = marks.children.get(name, start_of_file)
    return Document(file=str(file), lines=toml_lines, data=section, marks=marks)


def _parse_toml(file: Path, toml_text: str, report: ProblemReport) -> dict[str, Any]:
    """Return the data of a TOML file. If it is not valid, report the error and return an empty map."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        toml_data: dict[str, Any] = tomllib.loads(toml_text)
    except tomllib.TOMLDecodeError as error:
        line, column, message = _split_off_place(str(error), toml_text)
        lines = toml_text.splitlines()
        error_line = lines[line - 1] if line <= len(lines) else ""
        problem = f"not valid TOML: {message}"
        report.add_at(str(file), "toml-syntax", problem, line=line, column=column, text=error_line)
        return {}
    return toml_data


def _split_off_place(message: str, toml_text: str) -> tuple[int, int, str]:
    """Split a message of the TOML parser into the line, the column and the message without its place.

    If the message contains no place, or "end of document", the place is the end of the text.
    """
    lines = toml_text.splitlines() or [""]
    last_line = len(lines)
    last_column = max(len(lines[-1]), 1)
    place_match = _PLACE_IN_MESSAGE.search(message)
    if place_match is None:
        return last_line, last_column, message
    message_without_place = message[: place_match.start()]
    is_end_of_document = place_match["line"] is None
    if is_end_of_document:
        return last_line, last_column, message_without_place
    return int(place_match["line"]), int(place_match["column"]), message_without_place


def _build_configuration(file: Path, document: Document, report: ProblemReport) -> Configuration:
    """Return the settings in a document. Settings with errors are reported and left out.

    Paths are relative to the folder of the file. Specs that do not exist are reported, but remain in the settings.
    """
    reader = _SettingsReader(document, report)
    settings = document.data
    reader.report_unknown_keys(settings, known_keys=_SETTING_KEYS, place=())
    output_text = reader.read_output()
    spec_texts = reader.read_texts(settings, ("specs",))
    configuration = Configuration(
        file=file,
        specs=tuple(file.parent / text for text in spec_texts),
        output=file.parent / output_text if output_text else None,
        targets=reader.read_texts(settings, ("targets",)),
        only=reader.read_family_filters(),
    )
    for spec_index, spec_path in enumerate(configuration.specs):
        if not exists(spec_path):
            message = f"there is no file or folder {spec_path.as_posix()}"
            report.add("undefined-reference", document, ("specs", spec_index), message)
    return configuration


class _SettingsReader:
    """Reads the settings in a document, and reports values of a wrong type. Such values are left out."""

    def __init__(self, document: Document, report: ProblemReport) -> None:
        self._document = document
        self._report = report

    def read_output(self) -> str:
        """Return the setting ``output``, or an empty string if there is none."""
        settings = self._document.data
        output = settings.get("output", "")
        if _is_text(output):
            return str(output)
        if "output" in settings:
            self._report_wrong_type(("output",), expected_type="a text", example=_EXAMPLE_VALUES["output"])
        return ""

    def read_texts(self, table: Mapping[Any, Any], place: Place) -> tuple[str, ...]:
        """Return a list of texts as a tuple, or ``()`` if there is none.

        ``place`` is the path of the list in the document. Its last step is a key of ``table``.
        """
        key = str(place[-1])
        if key not in table:
            return ()
        texts = table[key]
        is_list_of_texts = isinstance(texts, list) and bool(texts) and all(map(_is_text, texts))
        if is_list_of_texts:
            return tuple(texts)
        self._report_wrong_type(place, expected_type="a list of texts", example=_EXAMPLE_VALUES[key])
        return ()

    def read_family_filters(self) -> dict[str, FamilyFilter]:
        """Return the setting ``only``: for some targets, a condition on the families that they generate.

        The result is empty if there is no such setting, or if it is not a map of targets, which is reported.
        """
        if "only" not in self._document.data:
            return {}
        conditions_by_target = self._document.data["only"]
        if not isinstance(conditions_by_target, dict) or not conditions_by_target:
            self._report_wrong_type(("only",), expected_type="a map of targets", example=_EXAMPLE_VALUES["only"])
            return {}
        return {
            str(target_name): self._read_family_filter(target_name, conditions)
            for target_name, conditions in conditions_by_target.items()
        }

    def _read_family_filter(self, target_name: str, conditions: Any) -> FamilyFilter:
        """Return the condition of a target: the families and the grades of evidence for which it is generated.

        ``conditions`` is the value in the file. Values with errors are reported and left out.
        """
        place = ("only", target_name)
        if not isinstance(conditions, dict) or not conditions:
            expected_type = "a map with 'families' or 'grades'"
            self._report_wrong_type(place, expected_type=expected_type, example=_EXAMPLE_OF_A_FILTER)
            return FamilyFilter()
        self.report_unknown_keys(conditions, known_keys=_FILTER_KEYS, place=place)
        families = self.read_texts(conditions, (*place, "families"))
        grades = self.read_texts(conditions, (*place, "grades"))
        self._report_unknown_grades(grades, (*place, "grades"))
        return FamilyFilter(families=families, grades=grades)

    def report_unknown_keys(self, keys: Iterable[Any], *, known_keys: Iterable[str], place: Place) -> None:
        """Report the keys that are not known. ``place`` is the path of the map with these keys."""
        for key in keys:
            if key not in known_keys:
                message = f"unknown key '{key}'{suggest_word(str(key), known_keys, 'known keys')}"
                self._report.add("unknown-key", self._document, (*place, key), message, at_key=True)

    def _report_unknown_grades(self, grades: Iterable[str], place: Place) -> None:
        """Report each grade that does not exist, and suggest the grade that it misspells, or list all grades."""
        from ..say.names_and_evidence import GRADES

        for index, grade in enumerate(grades):
            if grade not in GRADES:
                nearest_grade = nearest_choice(grade, GRADES)
                if nearest_grade:
                    hint = f"did you mean '{nearest_grade}'?"
                else:
                    hint = f"it can be {join_words(map(quoted, GRADES), 'or')}"
                message = f"a grade cannot be {quoted(grade)}; {hint}"
                self._report.add("not-allowed", self._document, (*place, index), message)

    def _report_wrong_type(self, place: Place, *, expected_type: str, example: str) -> None:
        """Report a value of the wrong type, with an example in the language of the file.

        ``expected_type`` is the correct type in words. ``example`` is a correct value in TOML, such as ``["specs"]``.
        """
        example_line = f"{place[-1]} = {example}"
        if Path(self._document.file).name != PYPROJECT:
            # YAML has colons instead of equals signs, and needs no quotes: output: generated.
            example_line = example_line.replace(" = ", ": ").replace('"', "")
        dotted_name = ".".join(map(str, place))
        message = f"'{dotted_name}' must be {expected_type}, such as {example_line}"
        self._report.add("wrong-type", self._document, place, message)


def _is_text(setting: Any) -> bool:
    """Return whether a value is a text that is not empty."""
    return isinstance(setting, str) and bool(setting)
