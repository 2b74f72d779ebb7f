"""Read YAML files into plain data, with the place of each value, within bounds.

Events are used instead of PyYAML's nodes, so that depth and aliases are bounded before anything is built. The cost of
any file, even a hostile one, is then limited by its size. Scalars are resolved here, by the YAML 1.2 core schema.
PyYAML's own resolver follows YAML 1.1, where ``7:0`` is the number 420, ``010`` is 8 and ``no`` is false.
"""

from __future__ import annotations

import os
import pathlib
import re
import stat
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import yaml

from . import files
from .document import Document, Path, SourceMark
from .files import family_of, is_second, is_word_sheet
from .problems import ProblemReport, quoted
from .yaml_text import INTEGER_TEXT, LINE_BREAK, YAML_LOADER, CorrectedEvents, explain, resolve_scalar

#: Largest size of a file.
MAX_BYTES = 4 * 2**20
#: Largest number of values in a spec, including repetitions by aliases. The largest manuals need about 20,000.
MAX_VALUES = 200_000
#: Largest nesting depth of maps and lists. The language needs 9.
MAX_DEPTH = 60
#: Largest number of digits in a number. 64 bits need 20.
MAX_DIGITS = 40

# Forbidden in addition to YAML's own rules: line breaks of YAML 1.1 that are not in 1.2 (they would shift the line
# numbers), characters that reorder the text around them, and invisible ones (a spec, and the comments generated from
# it, would look different from their content). A class of the allowed characters would take ten times as long to
# compile.
_UNSEEN = r"\u00ad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e0fff"
FORBIDDEN = re.compile(f"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff{_UNSEEN}]")


_CORE_TAG = "tag:yaml.org,2002:"
_TAGGED_TYPES: dict[str, tuple[type, ...]] = {
    f"{_CORE_TAG}null": (type(None),),
    f"{_CORE_TAG}bool": (bool,),
    f"{_CORE_TAG}int": (int,),
    f"{_CORE_TAG}float": (int, float),
}


class Unreadable(Exception):
    """Something that cannot be read.

    ``rule`` and ``message`` describe the problem, whose place is the start of the file by default. The path is given if
    the rest of the file can be read.
    """

    def __init__(self, rule: str, message: str, *, line: int = 1, column: int = 1, path: Path = ()) -> None:
        super().__init__(message)
        self.line, self.column, self.rule, self.message, self.path = line, column, rule, message, path


@dataclass(slots=True)
class _Value:
    """A value that was read: its data, its mark, and its count and depth for repetition by an alias."""

    data: Any
    mark: SourceMark
    count: int
    depth: int


def parse(
    yaml_text: str, report_error: Callable[[Unreadable], None], report_stand_in: Callable[[Path], None]
) -> tuple[dict[str, Any], SourceMark]:
    """Parse a YAML text and return its data and marks.

    Args:
        yaml_text: The text, without characters that YAML forbids.
        report_error: Called with each error that does not prevent reading the rest, such as a duplicate key.
        report_stand_in: Called with the path of each value that could not be read and was replaced by None.

    Raises:
        Unreadable: Nothing can be read: broken syntax, a bad alias, too deep, too many values, several documents, no
            content, or not a map.
    """
    try:
        return _Parser(yaml_text, report_error, report_stand_in).document()
    except yaml.MarkedYAMLError as error:
        mistake = explain(error, yaml_text)
        raise Unreadable("yaml-syntax", mistake.message, line=mistake.line, column=mistake.column) from None
    except yaml.YAMLError as error:
        first_line, *_ = str(error).splitlines()
        raise Unreadable("yaml-syntax", f"not valid YAML: {first_line}") from None


class _Parser:
    def __init__(
        self, text: str, report_error: Callable[[Unreadable], None], report_stand_in: Callable[[Path], None]
    ) -> None:
        self._report_error = report_error
        self._report_stand_in = report_stand_in
        parser_events = iter(yaml.parse(text, Loader=YAML_LOADER))
        corrected_events = CorrectedEvents(parser_events, lines=LINE_BREAK.split(text), complain=self._report)
        self._events = iter(corrected_events)
        #: Values by anchor. None while the value is being read.
        self._anchors: dict[str, _Value | None] = {}
        self._value_count = 0

    def _report(self, event: Any, rule: str, message: str, path: Path = ()) -> None:
        self._report_error(_build_error(event, rule, message, path))

    def document(self) -> tuple[dict[str, Any], SourceMark]:
        """Return the data and marks of the only document, or raise Unreadable if it is not one map."""
        next(self._events)  # Discarded: the start of the stream.
        start = next(self._events)
        if isinstance(start, yaml.StreamEndEvent):
            raise Unreadable("empty", "the file is empty; a spec begins with 'codewheel: 1'")
        if getattr(start, "version", None) not in (None, (1, 2)):
            raise _build_error(start, "yaml-syntax", "specs are read as YAML 1.2; remove the %YAML line")
        value = self._read_value(next(self._events), path=(), depth=1)
        next(self._events)  # Discarded: the end of the document.
        next_event = next(self._events)
        if not isinstance(next_event, yaml.StreamEndEvent):
            raise _build_error(
                next_event, "several-documents", "a second document begins here; a file contains only one"
            )
        if value.data is None:
            raise Unreadable("empty", "the file is empty; a spec begins with 'codewheel: 1'")
        if not isinstance(value.data, dict):
            found_text = "a list" if isinstance(value.data, list) else "one value"
            message = f"a spec is a map of keys and begins with 'codewheel: 1'; this is {found_text}"
            raise Unreadable("not-a-map", message, line=value.mark.line, column=value.mark.column)
        return value.data, value.mark

    def _read_value(self, event: Any, path: Path, depth: int) -> _Value:
        """Return the value that begins with ``event``, on the level ``depth`` of nesting.

        Raises:
            Unreadable: A bound is exceeded, or an alias cannot be followed.
        """
        if isinstance(event, yaml.AliasEvent):
            return self._repeat_alias(event, depth)
        self._add_to_value_count(1, event)
        if depth > MAX_DEPTH:
            raise _build_error(event, "too-deep", f"maps and lists are nested more than {MAX_DEPTH} levels deep")
        anchor = event.anchor
        if anchor is not None:
            self._anchors[anchor] = None  # Open: an alias to it from inside would never end.
        mark = _mark_at_start(event)
        if isinstance(event, yaml.ScalarEvent):
            value = _Value(self._read_scalar(event, path), mark, count=1, depth=0)
        else:
            self._check_container_tag(event)
            read_container = self._read_map if isinstance(event, yaml.MappingStartEvent) else self._read_list
            value = read_container(mark, path, depth)
        if anchor is not None:
            self._anchors[anchor] = value
        return value

    def _repeat_alias(self, event: Any, depth: int) -> _Value:
        """Return the value that an alias repeats, with the place of the alias. All its values are counted again.

        Raises:
            Unreadable: There is no such anchor, the alias is inside the value, or a bound is exceeded.
        """
        if event.anchor not in self._anchors:
            raise _build_error(event, "alias", f"there is no anchor '&{event.anchor}' before this alias")
        value = self._anchors[event.anchor]
        if value is None:
            raise _build_error(event, "alias", f"the alias '*{event.anchor}' is inside the value that it repeats")
        self._add_to_value_count(value.count, event)
        if depth + value.depth > MAX_DEPTH:
            message = f"maps and lists are nested more than {MAX_DEPTH} levels deep through this alias"
            raise _build_error(event, "too-deep", message)
        # The values keep the positions where they are written. Only the item itself is located at the alias.
        mark = replace(_mark_at_start(event), children=value.mark.children)
        return replace(value, mark=mark)

    def _add_to_value_count(self, count: int, event: Any) -> None:
        """Count values, and raise Unreadable if the file has too many."""
        self._value_count += count
        if self._value_count > MAX_VALUES:
            message = (
                f"there are more than {MAX_VALUES} values up to this point, counting those repeated by aliases; remove"
                " the aliases"
            )
            raise _build_error(event, "too-large", message)

    def _read_list(self, mark: SourceMark, path: Path, depth: int) -> _Value:
        """Return the list whose first event was read, with its values. ``depth`` is its level of nesting, from 1."""
        list_data: list[Any] = []
        count, depth_below = 1, 0
        while True:
            event = next(self._events)
            if isinstance(event, yaml.SequenceEndEvent):
                return _Value(list_data, mark, count=count, depth=depth_below + 1)
            index = len(list_data)
            value = self._read_value(event, path=(*path, index), depth=depth + 1)
            mark.children[index] = value.mark
            list_data.append(value.data)
            count += value.count
            depth_below = max(depth_below, value.depth)

    def _read_map(self, mark: SourceMark, path: Path, depth: int) -> _Value:
        """Return the map whose first event was read, at level ``depth`` of nesting. Report and omit invalid keys."""
        map_data: dict[str, Any] = {}
        count, depth_below = 1, 0
        while True:
            key_event = next(self._events)
            if isinstance(key_event, yaml.MappingEndEvent):
                return _Value(map_data, mark, count=count, depth=depth_below + 1)
            key = self._read_key(key_event, path, depth)
            key_in_path = "" if key is None else key
            value = self._read_value(next(self._events), path=(*path, key_in_path), depth=depth + 1)
            count += value.count
            depth_below = max(depth_below, value.depth)
            if key is None:
                continue  # Already reported. Its value was read only to find its end.
            if key in map_data:
                first_line = mark.children[key].key_line
                message = f"duplicate key {quoted(key)}, already on line {first_line}; keep one of them"
                self._report(key_event, "duplicate-key", message, (*path, key))
                continue
            value.mark.key_line = key_event.start_mark.line + 1
            value.mark.key_column = key_event.start_mark.column + 1
            mark.children[key] = value.mark
            map_data[key] = value.data

    def _read_key(self, event: Any, path: Path, depth: int) -> str | None:
        """Return a key of a map as text, so that ``01`` stays ``01``. Report an invalid key, and return None."""
        if not isinstance(event, yaml.ScalarEvent):
            self._read_value(event, path=(), depth=depth + 1)  # Discarded, but its events must be read.
            self._report(event, "bad-key", "a key is one word, not a list, a map or an alias", path)
            return None
        is_quoted = bool(event.style)
        if event.value == "<<" and not is_quoted:
            self._report(event, "merge-key", "merge keys are not part of YAML 1.2; write out the entries", path)
            return None
        has_tag_of_text = event.tag in (None, "!", f"{_CORE_TAG}str")
        if event.value == "" or FORBIDDEN.search(event.value) or not has_tag_of_text:
            self._report(event, "bad-key", "a key is one word, without a tag and without control characters", path)
            return None
        return str(event.value)

    def _read_scalar(self, event: Any, path: Path) -> Any:
        """Return the value of a scalar, such as text or a number. Report an invalid one, and return None instead."""
        text, tag = event.value, event.tag
        is_quoted = bool(event.style)
        # The text of the file was searched before. Only an escape in double quotes can still produce such a character.
        forbidden = FORBIDDEN.search(text) if event.style == '"' else None
        if forbidden is not None:
            code_point = f"U+{ord(forbidden[0]):04X}"
            message = f"the character {code_point} is not allowed in text; remove its escape"
            return self._report_and_replace(event, path, "not-text", message)
        is_untagged_text = tag is None and is_quoted
        if is_untagged_text or tag in ("!", f"{_CORE_TAG}str"):
            return text
        shown_tag = quoted(_short_tag(tag or ""))
        if tag is not None and tag not in _TAGGED_TYPES:
            return self._report_and_replace(event, path, "tag", f"the tag {shown_tag} is not supported; remove it")
        if len(text) > MAX_DIGITS and INTEGER_TEXT.fullmatch(text):
            message = f"a number of {len(text)} digits is too long; put it in quotes if it is text"
            return self._report_and_replace(event, path, "number-too-long", message)
        value = resolve_scalar(text)
        if tag is not None and not isinstance(value, _TAGGED_TYPES[tag]):
            return self._report_and_replace(event, path, "tag", f"{quoted(text)} is not of type {_short_tag(tag)}")
        return value

    def _report_and_replace(self, event: Any, path: Path, rule: str, message: str) -> None:
        """Report an invalid scalar. None, which this method returns, replaces its value."""
        self._report(event, rule, message)
        self._report_stand_in(path)

    def _check_container_tag(self, event: Any) -> None:
        container_tag = "map" if isinstance(event, yaml.MappingStartEvent) else "seq"
        if event.tag not in (None, "!", f"{_CORE_TAG}{container_tag}"):
            self._report(event, "tag", f"the tag {quoted(_short_tag(event.tag))} is not supported; remove it")


def _short_tag(tag: str) -> str:
    return tag.replace(_CORE_TAG, "!!")


def _build_error(event: Any, rule: str, message: str, path: Path = ()) -> Unreadable:
    mark = _mark_at_start(event)
    return Unreadable(rule, message, line=mark.line, column=mark.column, path=path)


def _mark_at_start(event: Any) -> SourceMark:
    """Return the place where a value begins, which is also the place of its key until the key is known."""
    line, column = event.start_mark.line + 1, event.start_mark.column + 1
    return SourceMark(line=line, column=column, key_line=line, key_column=column)


def read_document(path: pathlib.Path, report: ProblemReport, shown_as: str | None = None) -> Document | None:
    """Read one file and add its problems to ``report``.

    The result is None if nothing in the file can be used. A document may have problems. ``shown_as`` is the name to
    show for the file, by default its path as given.
    """
    file = shown_as if shown_as is not None else str(path)
    report.files.append(file)
    try:
        content = _read_content(path)
        text = _decode_text(content)
    except Unreadable as error:
        report.add_at(file, error.rule, error.message, line=error.line, column=error.column)
        return None
    lines = tuple(LINE_BREAK.split(text))
    forbidden_character = FORBIDDEN.search(text)
    if forbidden_character is None:
        return _parsed_document(file, text, lines, report)
    lines_up_to_it = LINE_BREAK.split(text[: forbidden_character.start()])
    line, column = len(lines_up_to_it), len(lines_up_to_it[-1]) + 1
    code_point = f"U+{ord(forbidden_character[0]):04X}"
    message = _message_on_content(content, f"the character {code_point} is not allowed in text; remove it")
    is_binary = "\0" in text
    line_text = "" if is_binary else lines[line - 1]
    report.add_at(file, "not-text", message, line=line, column=column, text=line_text)
    return None


def document_of_text(file: str, yaml_text: str, report: ProblemReport) -> Document | None:
    """Parse a text without forbidden characters as if a file with that name contained it, like ``read_document``."""
    report.files.append(file)
    lines = tuple(LINE_BREAK.split(yaml_text))
    return _parsed_document(file, yaml_text, lines, report)


def _parsed_document(file: str, yaml_text: str, lines: tuple[str, ...], report: ProblemReport) -> Document | None:
    """Return the document in a text, or None if nothing in it can be used. Report the errors in the text."""
    errors: list[Unreadable] = []
    replaced_paths: list[Path] = []  # The places of values that could not be read.
    data_and_marks = None
    try:
        data_and_marks = parse(yaml_text, report_error=errors.append, report_stand_in=replaced_paths.append)
    except Unreadable as last_error:
        errors.append(last_error)
    for error in errors:
        line_text = lines[error.line - 1] if error.line <= len(lines) else ""
        report.add_at(file, error.rule, error.message, line=error.line, column=error.column, text=line_text)
    if data_and_marks is None:
        return None
    data, marks = data_and_marks
    doubtful_paths = tuple(error.path for error in errors if error.path)
    return Document(
        file=file, lines=lines, data=data, marks=marks, broken=tuple(replaced_paths), doubtful=doubtful_paths
    )


def read_specs(paths: Iterable[pathlib.Path], report: ProblemReport) -> list[Document]:
    """Read files and whole folders, each file once.

    A folder represents the specs in it and below it, in sorted order, which ``find_files`` lists. A file given by name
    is always read, except for a second reading or a sheet of turning words, which belongs to a spec.
    """
    documents = []
    read_paths: set[str] = set()
    requested_paths = tuple(paths)
    for requested_path in requested_paths:
        belongs_to_spec = is_second(requested_path) or is_word_sheet(requested_path)
        if belongs_to_spec and not files.is_folder(requested_path):
            _report_lone_file(requested_path, requested_paths, report)
            continue
        for path in _specs_in_folder_or_file(requested_path, report):
            # A path with a NUL cannot be resolved. Reading it reports the error.
            real_path = str(path) if "\0" in str(path) else os.path.realpath(path)
            if real_path in read_paths:
                continue
            read_paths.add(real_path)
            document = read_document(path, report)
            if document is not None:
                documents.append(document)
    return documents


def _report_lone_file(file: pathlib.Path, requested_paths: Sequence[pathlib.Path], report: ProblemReport) -> None:
    """Report a second reading or a sheet of turning words that was given by name, unless its spec was given too."""
    spec_path = file.with_name(f"{family_of(str(file))}{file.suffix}")
    if spec_path not in requested_paths:
        kind_in_words, rule = "sheet of turning words", "word-sheet"
        if is_second(file):
            kind_in_words, rule = "second reading", "second-reading"
        report.add_at(str(file), rule, f"this is a {kind_in_words}; give {spec_path.name}, the spec that it belongs to")


def _specs_in_folder_or_file(path: pathlib.Path, report: ProblemReport) -> Sequence[pathlib.Path]:
    """Return the specs in a folder, or the file itself. Report a folder without specs, and note its other files."""
    if not files.is_folder(path):
        return (path,)
    found_files = files.find_files(path)
    report.passed_over += map(str, found_files.passed_over)
    if not found_files.specs:
        message = "no spec (a .yaml file with the key 'device', 'manufacturer' or 'master') in this folder"
        skipped_count = len(found_files.passed_over)
        if skipped_count == 1:
            message += "; 1 other YAML file was skipped"
        elif skipped_count > 1:
            message += f"; {skipped_count} other YAML files were skipped"
        report.add_at(str(path), "no-specs", message)
    return found_files.specs


def _read_content(path: pathlib.Path) -> bytes:
    """Return the bytes of a file.

    Raises:
        Unreadable: The file cannot be read, is not a regular file, or is too large.
    """
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode):
            found_text = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
            raise Unreadable("unreadable", f"this is {found_text}; a spec is a .yaml file")
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise Unreadable("unreadable", "there is no such file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Unreadable("unreadable", f"the file cannot be read: {reason}") from None
    if len(content) > MAX_BYTES:
        message = f"the file is larger than {MAX_BYTES // 2**20} MB; one spec covers one manual"
        raise Unreadable("too-large", message)
    return content


def _decode_text(content: bytes) -> str:
    """Return the text of a file, without a byte order mark at its start.

    Raises:
        Unreadable: The file is not UTF-8.
    """
    try:
        return content.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        problem = f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"
        raise Unreadable("not-text", _message_on_content(content, problem), line=line) from None


def _message_on_content(content: bytes, problem: str) -> str:
    """Return the message about content that is not text: ``problem``, or for a binary file that it is one."""
    return "this is a binary file; a spec is UTF-8 text" if b"\0" in content[:65536] else problem
