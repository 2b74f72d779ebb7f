"""Members of the parts that are described in one class each (see ``model/part.py``)."""

from __future__ import annotations

from typing import Any

from ..key_types import data_notation, name_of_part
from ..part import DescribedKey, description_of, keys_of
from .member import Member, Part


def described_part(part_class: Any, *additional: Member, after: str = "", name: str = "") -> Part:
    """Return the part that a class describes.

    ``additional`` members, which only the data have, follow the member ``after``. ``name`` is the name of the part, if
    it differs from the name of the class.
    """
    description = description_of(part_class)
    members = []
    for described in keys_of(part_class):
        if described.name == "source":
            continue
        members.append(_build_member(described))
        if described.name == after:
            members += additional
    return Part(
        name or name_of_part(part_class.__name__),
        description.data or description.about,
        *members,
        of=part_class.__name__,
        identity=description.identity,
        is_sourced=description.is_sourced,
    )


def _build_member(described: DescribedKey) -> Member:
    key = described.key
    about = key.data or f"{key.about} {key.reading}".rstrip()
    return Member(described.name, data_notation(described), about, **key.member)
