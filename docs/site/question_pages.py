"""Put a box that decodes at the top of each question page, filled with the example that the page links to."""

from __future__ import annotations

import re
from html import escape
from urllib.parse import parse_qs

#: A paragraph with nothing but the link to an example on the decode page.
_EXAMPLE = re.compile(r"^\[[^\]]*\]\(\.\./\.\./generated/browser/decode\.html#([^)\s]+)\)\.?\n\n?", re.MULTILINE)
_TITLE = re.compile(r"^# .*\n", re.MULTILINE)
PAGES = "docs/encoder/questions-*.md"


def with_example_box(page: str) -> str:
    """Return the Markdown of a question page with a filled box below the title, in place of the link to the example."""
    example = _EXAMPLE.search(page)
    title = _TITLE.search(page)
    if example is None or title is None:
        return page
    box = _box(example[1])
    answer = _EXAMPLE.sub("", page[title.end() :], count=1)
    return f"{page[: title.end()]}\n{box}\n{answer}"


def _box(address: str) -> str:
    given = parse_qs(address)
    filled = {"code": given["code"][0], "frame": given["frame"][0], "page": "../../decode.html"}
    data = "".join(f' data-{name}="{escape(text)}"' for name, text in filled.items())
    data = data.replace("\n", "&#10;")
    return (
        '<p class="try">Replace this example with your order code and your frames. '
        '<span>"Usable" means that the frame reports no error. The position can still be wrong.</span></p>\n\n'
        f'<div class="codewheel-decode example"{data}></div>\n'
    )
