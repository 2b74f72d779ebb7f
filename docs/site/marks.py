"""Draw marks beside words on a page: badges of verdicts, chips in the colours of wires, and dots for LEDs.

The words stay, so a page can be read without colours.
"""

from __future__ import annotations

import re
from typing import Any

from codewheel.targets.picture_elements import palette
from sphinx.application import Sphinx

#: Verdicts as they are in a cell, and their classes.
_VERDICTS = {
    "✓ usable": "usable",
    "▲ usable with a warning": "usable_with_warning",
    "✕ <strong>not usable</strong>": "not_usable",
    "? unknown": "unknown",
}
_VERDICT_CELL = re.compile(rf"(<td\b[^>]*>(?:<p>)?)({'|'.join(map(re.escape, _VERDICTS))})(?=(?:</p>)?</td>)")
_SECTION = '<section id="{}">'
_TABLE = re.compile(r"<table\b.*?</table>", re.DOTALL)
_ROW = re.compile(r"<tr\b[^>]*>.*?</tr>", re.DOTALL)
_CELL_TEXT = re.compile(r"(<td\b[^>]*>(?:<p>)?)([^<]*)")
_WIRE = re.compile(r"[A-Za-z]+(?:[_/-][A-Za-z]+)*")
_BETWEEN_COLOURS = re.compile(r"[_/-]")
_STATES = {"on": "on", "stays on": "on", "lit": "on", "off": "off", "blinks": "blinking", "blinking": "blinking"}
_LIGHTS = ("red", "green", "yellow", "orange", "blue")
_STATE = re.compile(rf"(?:{'|'.join((*sorted(_STATES, key=len, reverse=True), *_LIGHTS))})\b", re.IGNORECASE)
#: A sign in front of its word, and the polarity after the name of a signal, which stay in one line with them.
_SIGN = re.compile(r"([✓▲✕⚠]) (?=[\w<])")
_POLARITY = re.compile(r" (?=[+-][\s<)])")
_LISTING = re.compile(r"(<pre\b.*?</pre>)", re.DOTALL)
_OR = re.compile(r" (?:or|and) ")


def marked(body: str) -> str:
    """Return the HTML of a page with its marks."""
    body = _VERDICT_CELL.sub(_badge, body)
    body = _with_marks_in_section(body, "wiring", _with_chips)
    body = _with_marks_in_section(body, "leds", _with_dots)
    pieces = _LISTING.split(body)
    # The other pieces are listings, which are copied as they are.
    pieces[::2] = [_SIGN.sub("\\1\N{NO-BREAK SPACE}", piece) for piece in pieces[::2]]
    return "".join(pieces)


def _badge(cell: re.Match[str]) -> str:
    words = re.sub(r"^\W+|</?strong>", "", cell[2].replace("<strong>", ""))
    return f'{cell[1]}<span class="verdict {_VERDICTS[cell[2]]}">{words}</span>'


def _with_marks_in_section(body: str, section: str, mark: Any) -> str:
    """Return the page with the first table of a section marked."""
    before, start, inside = body.partition(_SECTION.format(section))
    text, end, after = inside.partition("</section>")
    return f"{before}{start}{_TABLE.sub(lambda table: mark(table[0]), text, count=1)}{end}{after}"


def _with_chips(table: str) -> str:
    return _ROW.sub(lambda row: _row_with_chips(row[0]), table)


def _row_with_chips(row: str) -> str:
    """Return a row with a chip beside each colour. Its last cell is the signal."""
    contacts, mark, signal = row.rpartition("<td")
    signal = _POLARITY.sub("\N{NO-BREAK SPACE}", signal)
    return _CELL_TEXT.sub(lambda cell: cell[1] + _WIRE.sub(_chip, cell[2]), contacts) + mark + signal


def _chip(wire: re.Match[str]) -> str:
    colours = _BETWEEN_COLOURS.split(wire[0].lower())
    if not all(colour in palette().wires for colour in colours):
        return wire[0]
    parts = "".join(f'<span class="wire-{colour}"></span>' for colour in colours)
    return f'<span class="wire"><span class="chip" aria-hidden="true">{parts}</span>{wire[0]}</span>'


def _with_dots(table: str) -> str:
    return _ROW.sub(lambda row: _CELL_TEXT.sub(_state_with_dots, row[0], count=1), table)


def _state_with_dots(cell: re.Match[str]) -> str:
    """Return the cell of a state with a dot for each of the words with which it begins, as in "on or blinking"."""
    dots, position = "", 0
    state = _STATE.match(cell[2])
    while state is not None:
        dots += _dot(state[0].lower())
        conjunction = _OR.match(cell[2], state.end())
        position = conjunction.end() if conjunction else len(cell[2])
        state = _STATE.match(cell[2], position)
    return f"{cell[1]}{dots}{cell[2]}"


def _dot(word: str) -> str:
    state, light = (_STATES[word], "lit") if word in _STATES else ("on", word)
    return f'<span class="dot {state} {light}" aria-hidden="true"></span>'


def _mark(_app: Sphinx, _page: str, _template: str, context: dict[str, Any], _doctree: object) -> None:
    if "body" in context:
        context["body"] = marked(context["body"])


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("html-page-context", _mark, priority=480)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
