"""Reading: from YAML files to plain data that knows where each value stands.

PyYAML does the syntax; scalars are resolved here, by the YAML 1.2 core schema. PyYAML's own resolver follows YAML 1.1, where ``7:0``
is the number 420, ``010`` is 8 and ``no`` is false: none of that is what someone means who transcribes a manual.
Nothing after this module knows YAML.
"""

from __future__ import annotations

import os
import pathlib
import re
import stat
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

from . import spec_files
from .parse import FORBIDDEN, LINE_BREAK, MAX_BYTES, Mark, Refused, parse
from .problems import Path, Report

#: Keys by which an item of a list is called, the first that it has.
_ITEM_KEYS = ("name", "id", "revision", "contact")
_PLAIN_LABEL = re.compile(r"[A-Za-z0-9_]+")


@dataclass
class Document:
    """A spec as it was read.

    ``data`` consists of dict, list, str, int, float, bool and None. ``broken`` lists the places about which the reader has already
    complained; what stands there is only a stand-in. ``doubtful`` lists those where something was left out, such as a key that comes twice.
    ``kept`` is filled by the schema check: for a list that lost items, the
    original index of each item that stayed, so that paths into the pruned data still find their lines.
    """

    file: str
    lines: tuple[str, ...]
    data: dict[str, Any]
    marks: Mark
    broken: tuple[Path, ...] = ()
    doubtful: tuple[Path, ...] = ()
    kept: dict[Path, tuple[int, ...]] = field(default_factory=dict)

    def line(self, number: int) -> str:
        """The text of a line, counted from 1; empty beyond the end."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def position(self, path: Path, at_key: bool = False) -> tuple[int, int]:
        """Line and column of what stands at ``path``, both from 1; of its nearest ancestor where there is nothing.

        A str in the place of a list index picks the item of that name. With ``at_key`` the key counts, not its value; an ancestor
        is always found by its key, since that is where a reader would look for what is missing.
        """
        mark, found = self.marks, 0
        for _, child in self._walk(path):
            mark, found = child, found + 1
        if found == 0:
            return (1, 1) if path else (mark.line, mark.column)
        if at_key or found < len(path):
            return mark.key_line, mark.key_column
        return mark.line, mark.column

    def name_path(self, path: Path) -> str:
        """The path as a message shows it, list items by name where they have one, else counted from 1: ``procedures.preset.steps[3]``."""
        text = ""
        node: Any = self.data
        for step in self.original(path):
            if isinstance(node, list) and isinstance(step, int):
                node = node[step] if step < len(node) else None
                label = _label(node)
                text += f".{label}" if label and _PLAIN_LABEL.fullmatch(label) else f"[{step + 1}]"
            else:
                node = node.get(step) if isinstance(node, dict) else None
                text += f".{step}"
        return text.removeprefix(".")

    def _walk(self, path: Path) -> Iterator[tuple[str | int, Mark]]:
        """Each step of the path that exists, with its mark."""
        mark = self.marks
        for step in self.original(path):
            child = mark.children.get(step)
            if child is None:
                return
            yield step, child
            mark = child

    def original(self, path: Path) -> Path:
        """The path in terms of the data as read: names of items as indices, indices of pruned lists as original ones."""
        node: Any = self.data
        result: Path = ()
        for step in path:
            if isinstance(node, list):
                if isinstance(step, int):
                    kept = self.kept.get(result)
                    step = step if kept is None or step >= len(kept) else kept[step]
                else:
                    step = next((index for index, item in enumerate(node) if _label(item) == step), step)
                node = node[step] if isinstance(step, int) and 0 <= step < len(node) else None
            else:
                node = node.get(step) if isinstance(node, dict) else None
            result += (step,)
        return result


def read_document(path: pathlib.Path, report: Report, shown_as: str | None = None) -> Document | None:
    """Reads one file; what is wrong with it goes into ``report``.

    Args:
        path: The file.
        report: Gets every problem.
        shown_as: The name to show for the file; its path as given, unless said.

    Returns:
        The document, or None where nothing of the file can be used. A document may be returned although there are problems.
    """
    file = shown_as if shown_as is not None else str(path)
    report.files.append(file)
    try:
        content = _content(path)
    except Refused as refusal:
        report.add_at(file, 1, 1, refusal.rule, refusal.message)
        return None
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        report.add_at(file, line, 1, "not-text", _not_text(content, f"byte 0x{content[error.start]:02X} is not UTF-8; save the file as UTF-8"))
        return None
    text = text.removeprefix("\ufeff")
    lines = tuple(LINE_BREAK.split(text))
    forbidden = FORBIDDEN.search(text)
    if forbidden is not None:
        before = LINE_BREAK.split(text[: forbidden.start()])
        message = _not_text(content, f"the character U+{ord(forbidden[0]):04X} has no place in a text; remove it")
        report.add_at(file, len(before), len(before[-1]) + 1, "not-text", message, text="" if "\0" in text else lines[len(before) - 1])
        return None
    return _document(file, text, lines, report)


def _document(file: str, text: str, lines: tuple[str, ...], report: Report) -> Document | None:
    findings: list[Refused] = []
    broken: list[Path] = []
    try:
        data, marks = parse(text, findings.append, broken.append)
    except Refused as refusal:
        findings.append(refusal)
        data = None
    for item in findings:
        shown = lines[item.line - 1] if item.line <= len(lines) else ""
        report.add_at(file, item.line, item.column, item.rule, item.message, text=shown)
    doubtful = tuple(item.path for item in findings if item.path)
    return None if data is None else Document(file, lines, data, marks, tuple(broken), doubtful)


def read_specs(paths: Iterable[pathlib.Path], report: Report) -> list[Document]:
    """Reads files and whole folders, each file once.

    A folder stands for the specs in it and below it, in sorted order; ``spec_files`` knows which files are specs.
    A file that is given is read whatever it holds.
    """
    documents = []
    seen: set[str] = set()
    for given in paths:
        found = spec_files.below(given) if spec_files.is_folder(given) else spec_files.Found((given,), ())
        report.passed_over += map(str, found.passed_over)
        if not found.specs:
            count = len(found.passed_over)
            others = f"; {count} other YAML file{'s were' if count > 1 else ' was'} passed over" if count else ""
            message = "the folder holds no spec, a .yaml file with one of the keys 'device', 'manufacturer' and 'master'"
            report.add_at(str(given), 1, 1, "no-specs", message + others)
        for path in found.specs:
            real = os.path.realpath(path) if "\0" not in str(path) else str(path)
            if real not in seen:
                seen.add(real)
                document = read_document(path, report)
                if document is not None:
                    documents.append(document)
    return documents


def _content(path: pathlib.Path) -> bytes:
    """The bytes of a file.

    Raises:
        Refused: It cannot be read, is no regular file, or is too large.
    """
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "no regular file"
            raise Refused(1, 1, "unreadable", f"this is {kind}; a spec is a .yaml file")
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise Refused(1, 1, "unreadable", "there is no such file") from None
    except (OSError, ValueError) as error:
        raise Refused(1, 1, "unreadable", f"the file cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > MAX_BYTES:
        raise Refused(1, 1, "too-large", f"the file is larger than {MAX_BYTES // 2**20} MB; one spec holds one manual")
    return content


def _not_text(content: bytes, otherwise: str) -> str:
    return "this is a binary file; a spec is a text in UTF-8" if b"\0" in content[:65536] else otherwise


def _label(item: Any) -> str | None:
    """What an item of a list is called, or None."""
    if not isinstance(item, dict):
        return None
    key = next((key for key in _ITEM_KEYS if key in item), None)
    return None if key is None or isinstance(item[key], (dict, list)) else str(item[key])
