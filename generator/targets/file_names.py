"""File names for order codes, which may contain characters that are not allowed in file names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain, count

_NO_PART_OF_A_NAME = re.compile(r"[^A-Za-z0-9.-]+")
_LONGEST = 80


def names_of_codes(order_codes: Iterable[str], reserved_names: Iterable[str] = ()) -> list[str]:
    """Return a file name for each order code. The names are unique even on file systems that ignore case.

    Characters that are not allowed become hyphens. Duplicates are numbered. ``reserved_names`` are in lowercase.
    """
    used_names, names = set(reserved_names), list[str]()
    for order_code in order_codes:
        plain = _NO_PART_OF_A_NAME.sub("-", order_code).lstrip(".")
        numbers = chain([""], (f"-{number}" for number in count(2)))
        numbered = (f"{plain[: _LONGEST - len(number)]}{number}" for number in numbers)
        names.append(next(name for name in numbered if name and name.casefold() not in used_names))
        used_names.add(names[-1].casefold())
    return names
