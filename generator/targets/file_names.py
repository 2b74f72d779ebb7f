"""File names for order codes, which may contain characters that are not allowed in file names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain, count

_NOT_ALLOWED = re.compile(r"[^A-Za-z0-9.-]+")
_LONGEST = 80


def names_of_codes(order_codes: Iterable[str], reserved_names: Iterable[str] = ()) -> list[str]:
    """Return a file name for each order code. The names are unique even on file systems that ignore case.

    Characters that are not allowed become hyphens. Duplicates are numbered. ``reserved_names`` are in lowercase.
    """
    used_names, names = set(reserved_names), list[str]()
    for order_code in order_codes:
        allowed_text = _NOT_ALLOWED.sub("-", order_code).lstrip(".")
        suffixes = chain([""], (f"-{number}" for number in count(2)))
        candidates = (f"{allowed_text[: _LONGEST - len(suffix)]}{suffix}" for suffix in suffixes)
        name = next(candidate for candidate in candidates if candidate and candidate.casefold() not in used_names)
        names.append(name)
        used_names.add(name.casefold())
    return names
