"""Filters for templates of the C target, and tests for the class of an operation."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

from ...model import Digits, Join
from ...model.expressions import Expression
from ...plan import steps
from ...plan.limits import Refusal
from ...plan.operations import Check, Whole
from ...render import tests_for
from ...say.layout import join as said_of_join
from ...say.markdown import text as markdown_text
from ...say.names_and_places import addresses, title, words
from ...say.text import BY_TITLE
from .about import place
from .bits import digits
from .comments import comment, comment_lines, in_comment
from .decode import ByteIs, FlagsIn, UnusedAre, UnusedIn
from .folds import FoldOperation
from .lines import end_comment, in_lines, literals
from .positions import Positions
from .procedures import FilledRows
from .reserved import c_name
from .selftest import Work
from .types import mask, number, string, unsigned

#: Operations of the plan and further operations of this target.
TESTS = tests_for(
    *(Expression, Check, Refusal, Whole, steps.Operation, steps.ArgumentRefusal),
    *(ByteIs, FlagsIn, UnusedIn, UnusedAre, FoldOperation, FilledRows, Positions, Work),
)


def _hex(value: int, digits: int = 2) -> str:
    """Return a number as a hexadecimal constant of at least this many digits."""
    return number(value, hexadecimal=True, digits=digits)


def _refuse_operation(op: object) -> NoReturn:
    """Refuse an operation for which a template has no case."""
    raise AssertionError(f"no case for {op!r}")


def _md(text: object) -> str:
    """Return text of a spec as Markdown."""
    return markdown_text(in_comment(text))


def _digits_type(run: Digits) -> str:
    """Return the type that holds a run of decimal digits."""
    return unsigned((run.modulus - 1).bit_length())


def _made_of(join: Join) -> str:
    """Describe which fields form a number."""
    return BY_TITLE.sentence(said_of_join(join))


def _bytes(count: int) -> str:
    """Return a number of bytes as text."""
    return f"{count} byte{'s' if count > 1 else ''}"


FILTERS: dict[str, Callable[..., object]] = {
    "addresses": addresses,
    "end_comment": end_comment,
    "bytes": _bytes,
    "c_name": c_name,
    "comment": comment,
    "comment_lines": comment_lines,
    "digits_of": digits,
    "digits_type": _digits_type,
    "hex": _hex,
    "in_lines": in_lines,
    "in_words": words,
    "literals": literals,
    "mask": mask,
    "md": _md,
    "never": _refuse_operation,
    "number": number,
    "made_of": _made_of,
    "place": place,
    "string": string,
    "text": in_comment,
    "title": title,
    "type": unsigned,
}
