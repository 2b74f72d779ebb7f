"""Templates: one Jinja environment per output language, set up so that text from a spec cannot become anything but text.

Templates hold text and loops. A user's own template folder comes before ours, file by file.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import BaseLoader, ChoiceLoader, Environment, FileSystemBytecodeCache, FileSystemLoader, PackageLoader, StrictUndefined

_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+")


def plain(text: object) -> str:
    """One line of text: control characters, line ends and direction marks become spaces."""
    return _CONTROL.sub(" ", str(text)).strip()


def wrapped(text: object, width: int, prefix: str = "", first: str | None = None) -> str:
    """``text`` as a paragraph of at most ``width`` columns, every line after ``prefix`` (the first after ``first``)."""
    lead = prefix if first is None else first
    return textwrap.fill(
        plain(text), width=width, initial_indent=lead, subsequent_indent=prefix, break_long_words=False, break_on_hyphens=False
    )


def _compiled() -> FileSystemBytecodeCache | None:
    """Compiled templates of earlier runs, in a folder of the user's own; compiling them is a third of a run."""
    try:
        return FileSystemBytecodeCache()
    except RuntimeError:
        return None  # there is no such folder here, or it belongs to somebody else


@lru_cache(maxsize=None)
def environment(folder: str, own_templates: Path | None = None) -> Environment:
    """The environment for the templates in ``folder`` (``python``, ``c``, ``biss``, ``markdown``)."""
    ours: BaseLoader = PackageLoader("codewheel.templates", folder)
    loader = ours if own_templates is None else ChoiceLoader([FileSystemLoader(own_templates / folder), ours])
    made = Environment(
        loader=loader,
        bytecode_cache=_compiled(),
        undefined=StrictUndefined,
        autoescape=folder == "biss",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["plain"] = plain
    made.filters["wrapped"] = wrapped
    return made


def render(folder: str, template: str, values: Mapping[str, Any], filters: Mapping[str, Callable[..., Any]] | None = None, own_templates: Path | None = None) -> str:
    """The text that ``template`` of ``folder`` makes of ``values``."""
    made = environment(folder, own_templates)
    if filters:
        made.filters.update(filters)
    return made.get_template(template).render(values)
