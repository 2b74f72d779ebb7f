"""Find the places of keys and values in a TOML text. The parsers of TOML return values only."""

from __future__ import annotations

import re
from bisect import bisect_right

from ..language.document import Mark

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
        root = table = Mark(1, 1, 1, 1)
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
