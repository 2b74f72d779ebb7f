"""``only``: the order codes to which a fact applies, abbreviated as in manuals, such as ``.../65K...``."""

from __future__ import annotations

import re
from fnmatch import translate
from functools import cache
from glob import escape

_PARTS = re.compile(r"\.\.\.|…|x|[^.…x]+|\.")


def fits(only: str, code: str) -> bool:
    """Return whether ``code`` is one of the order codes ``only``. An empty ``only`` means all of them.

    ``...`` stands for any text and ``x`` for any one character. Commas separate several patterns. The hyphen after an
    order code on a label counts as part of it.
    """
    return not only or any(pattern.match(text) for pattern in _patterns(only) for text in (code, f"{code}-"))


@cache
def _patterns(only: str) -> tuple[re.Pattern[str], ...]:
    # As for file names, where several "..." do not try every way to share the text between them.
    meant = {"...": "*", "…": "*", "x": "?"}
    parts = (_PARTS.findall(item.strip()) for item in only.split(","))
    return tuple(re.compile(translate("".join(meant.get(part) or escape(part) for part in item))) for item in parts)
