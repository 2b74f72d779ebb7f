"""Members of records that describe how the bits of a field become its value."""

from __future__ import annotations

from ...model.lookup import assert_never
from ...plan.values import Active, Characters, DigitRuns, Meaning, Named, Raw, TwosComplement, ZeroMeans
from .literals import Literal


def of_number(meaning: Meaning) -> dict[str, Literal]:
    """Return the members of a record for an unsigned number."""
    match meaning:
        case ZeroMeans(number):
            return {"zero_means": number}
        case Raw() | TwosComplement() | Active() | Named() | DigitRuns() | Characters():
            return {}
        case _:
            assert_never(meaning)


def of_facts(meaning: Meaning) -> dict[str, Literal]:
    """Return the members of ``FieldFacts``, with None for those that do not apply to the field."""
    without_members: dict[str, Literal] = {"active": None, "signed": None, "zero_means": None}
    match meaning:
        case Raw() | ZeroMeans() | Named() | DigitRuns() | Characters():
            return without_members | of_number(meaning)
        case TwosComplement():
            return without_members | {"signed": True}
        case Active(low):
            return without_members | {"active": "low" if low else "high"}
        case _:
            assert_never(meaning)
