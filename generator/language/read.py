"""Read YAML files into plain data, with the place of each value.

PyYAML handles the syntax. Scalars are resolved here, by the YAML 1.2 core schema. PyYAML's own resolver follows YAML
1.1, where ``7:0`` is the number 420, ``010`` is 8 and ``no`` is false. A person who transcribes a manual intends none
of these. No later module depends on YAML.
"""

from __future__ import annotations

import os
import pathlib
import stat
from collections.abc import Iterable, Sequence

from . import files
from .document import Document, Path
from .problems import Report
from .schema_files import family_of, is_second
from .yaml import FORBIDDEN, LINE_BREAK, MAX_BYTES, Unreadable, parse


def read_document(path: pathlib.Path, report: Report, shown_as: str | None = None) -> Document | None:
    """Read one file and add its problems to ``report``.

    Args:
        path: The file.
        report: Receives all problems.
        shown_as: The name to show for the file. Default: its path as given.

    Returns:
        The document, or None if nothing in the file can be used. A document may have problems.
    """
    file = shown_as if shown_as is not None else str(path)
    report.files.append(file)
    try:
        content = _content(path)
        text = _text(content)
    except Unreadable as refusal:
        report.add_at(file, refusal.line, refusal.column, refusal.rule, refusal.message)
        return None
    lines = tuple(LINE_BREAK.split(text))
    forbidden = FORBIDDEN.search(text)
    if forbidden is not None:
        before = LINE_BREAK.split(text[: forbidden.start()])
        message = _not_text(content, f"the character U+{ord(forbidden[0]):04X} is not allowed in text; remove it")
        excerpt = "" if "\0" in text else lines[len(before) - 1]
        report.add_at(file, len(before), len(before[-1]) + 1, "not-text", message, text=excerpt)
        return None
    return _parsed_document(file, text, lines, report)


def _parsed_document(file: str, text: str, lines: tuple[str, ...], report: Report) -> Document | None:
    findings: list[Unreadable] = []
    broken: list[Path] = []
    try:
        data, marks = parse(text, findings.append, broken.append)
    except Unreadable as refusal:
        findings.append(refusal)
        data = None
    for finding in findings:
        excerpt = lines[finding.line - 1] if finding.line <= len(lines) else ""
        report.add_at(file, finding.line, finding.column, finding.rule, finding.message, text=excerpt)
    doubtful = tuple(finding.path for finding in findings if finding.path)
    return None if data is None else Document(file, lines, data, marks, tuple(broken), doubtful)


def read_specs(paths: Iterable[pathlib.Path], report: Report) -> list[Document]:
    """Read files and whole folders, each file once.

    A folder stands for the specs in it and below it, in sorted order, which ``find_files`` lists. A file given by name
    is always read, except for a second reading, which belongs to a spec.
    """
    documents = []
    read_paths: set[str] = set()
    requested_paths = tuple(paths)
    for requested_path in requested_paths:
        if is_second(requested_path) and not files.is_folder(requested_path):
            spec = requested_path.with_name(f"{family_of(str(requested_path))}{requested_path.suffix}")
            if spec not in requested_paths:
                message = f"this is a second reading; give {spec.name}, the spec that it belongs to"
                report.add_at(str(requested_path), 1, 1, "second-reading", message)
            continue
        for path in _specs_at(requested_path, report):
            real_path = os.path.realpath(path) if "\0" not in str(path) else str(path)
            if real_path not in read_paths:
                read_paths.add(real_path)
                document = read_document(path, report)
                if document is not None:
                    documents.append(document)
    return documents


def _specs_at(path: pathlib.Path, report: Report) -> Sequence[pathlib.Path]:
    """Return the specs in a folder, or the file itself. Report a folder without specs."""
    if not files.is_folder(path):
        return (path,)
    found_files = files.find_files(path)
    report.passed_over += map(str, found_files.passed_over)
    if not found_files.specs:
        message = "no spec (a .yaml file with the key 'device', 'manufacturer' or 'master') in this folder"
        count = len(found_files.passed_over)
        if count:
            message += f"; {count} other YAML file{'s were' if count > 1 else ' was'} skipped"
        report.add_at(str(path), 1, 1, "no-specs", message)
    return found_files.specs


def _content(path: pathlib.Path) -> bytes:
    """Return the bytes of a file.

    Raises:
        Refused: The file cannot be read, is not a regular file, or is too large.
    """
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
            raise Unreadable(1, 1, "unreadable", f"this is {kind}; a spec is a .yaml file")
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise Unreadable(1, 1, "unreadable", "there is no such file") from None
    except (OSError, ValueError) as error:
        raise Unreadable(
            1, 1, "unreadable", f"the file cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from None
    if len(content) > MAX_BYTES:
        raise Unreadable(
            1, 1, "too-large", f"the file is larger than {MAX_BYTES // 2**20} MB; one spec covers one manual"
        )
    return content


def _text(content: bytes) -> str:
    """Return the text of a file.

    Raises:
        Refused: The file is not UTF-8.
    """
    try:
        return content.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        problem = f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"
        raise Unreadable(line, 1, "not-text", _not_text(content, problem)) from None


def _not_text(content: bytes, problem: str) -> str:
    return "this is a binary file; a spec is UTF-8 text" if b"\0" in content[:65536] else problem
