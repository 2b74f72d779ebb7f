# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Records about a manual: its editions and revisions, cited documents, and errata."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    pass


class Status(Enum):
    """Status of an erratum: resolved by evidence in the manual itself, or open until tested on hardware."""

    SETTLED = "settled"
    OPEN = "open"


class Severity(Enum):
    """Effect of following the printed text of an erratum literally."""

    WRONG_DATA = "wrong_data"
    WRONG_LIMIT = "wrong_limit"
    OMISSION = "omission"
    WORDING = "wording"


class Edition(NamedTuple):
    """Edition of the manual in another language, which was also consulted."""

    language: str
    title: str
    revision: str
    date: str = ""


class Revision(NamedTuple):
    """Row of the manual's revision table."""

    revision: str
    changes: str
    date: str = ""
    hardware: str = ""
    software: str = ""


class Manual(NamedTuple):
    """Manual that a module was generated from."""

    title: str
    revision: str
    date: str
    language: str
    publisher: str = ""
    editions: tuple[Edition, ...] = ()
    history: tuple[Revision, ...] = ()


class Document(NamedTuple):
    """Public document that a source cites by ``key``."""

    key: str
    title: str
    url: str = ""


class Erratum(NamedTuple):
    """Error or ambiguity in the manual.

    ``title`` states the mistake in one sentence. ``printed`` is the text of the manual, to the letter only in double
    quotation marks. ``used`` is the text that is used instead, and ``why`` is the reason. ``only`` describes the order
    codes that it applies to, if not all.
    """

    name: str
    title: str
    printed: str
    used: str
    why: str
    status: Status
    severity: Severity
    affects: tuple[str, ...] = ()
    source: str = ""
    only: str = ""
