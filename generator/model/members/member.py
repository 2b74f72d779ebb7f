"""Members of the parts of the model, as classes describe them, and the notation for their types in the data."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..key_types import data_notation, name_of_part
from ..part import DescribedKey, description_of, keys_of

#: Notations of numbers, by the ends of the names of members.
_NOTATION_BY_ENDING = ("mv", "us", "ms", "hz", "ns")
#: Rules of ``diff`` for limits, and the rules for the opposite change.
WIDER = {
    "clock-narrower": "clock-wider",
    "limit-narrower": "limit-wider",
    "supply-narrower": "supply-wider",
    "wait-longer": "wait-shorter",
}


@dataclass(frozen=True)
class ModelMember:
    """A member of a part of the model. Every output, ``diff`` and the second reading take its description from here.

    Attributes:
        name: Name in the data, in JSON and XML.
        shape: Type in the data. Empty for a member that is not in the data.

            * ``string``, ``integer``, ``boolean``, ``hex`` (an integer in hexadecimal) or ``scalar`` (any of them)
            * the name of a part or of a basic type: ``register``, ``text``, ``name``, ``names``, ``expression``
            * ``one|other``: one of these words
            * ``[name]``: a list. ``{integer}``: a map. ``{kind:interface}``: a map of parts by their member ``kind``.
            * ``text?``: the same type, or null. ``boolean=false``: the same with a default. ``=1``: always this number.
        about: Description for users of the data.
        rule: Rule of ``diff`` for a change. Empty for a member that is compared elsewhere or derived from other
            members.
        label: Name in sentences, if it differs from ``name``.
        read: Class of facts of a second reading to which a stated value belongs. Empty for a member without such facts,
            or whose facts have several parts.
        noun: Name in messages about second readings, where ``label`` does not name a thing.
        form: Notation in sentences: ``hex``, ``bytes``, ``word``, ``level``, ``unit``, ``plain``, or a unit. By default
            it follows from the shape or the name.
        refers_to: Kind of thing that the member names, so that ``diff`` takes a renaming into account.
        of: Name in the model, if it differs from ``name``.
    """

    name: str
    shape: str = ""
    about: str = ""
    rule: str = ""
    label: str = ""
    read: str = ""
    noun: str = ""
    form: str = ""
    refers_to: str = ""
    of: str = ""

    @property
    def attribute(self) -> str:
        """Name in the model."""
        return self.of or self.name

    @property
    def words(self) -> str:
        """Name in sentences."""
        return self.label or self.attribute.replace("_", " ")

    @cached_property
    def notation(self) -> str:
        """Notation of numbers in sentences: ``form``, ``hex``, or the unit at the end of the name, such as ``us``."""
        if self.form:
            return self.form
        if self.shape.startswith("hex"):
            return "hex"
        _, _, unit = self.attribute.rpartition("_")
        return unit if unit in _NOTATION_BY_ENDING else ""

    def is_stated(self, value: object) -> bool:
        """Return True if the manual states a value, and not just the default."""
        _, _, default = self.shape.partition("=")  # ``false`` of ``boolean=false``.
        is_default = bool(default) and str(value).lower() == default
        return value not in (None, "", ()) and not is_default

    @property
    def is_limit(self) -> bool:
        """True if a change that allows more and a change that allows less are reported under different rules."""
        return self.rule in WIDER

    @property
    def is_upper(self) -> bool:
        """True for a limit that allows more if it is raised."""
        return self.name.startswith("max")


class ModelPart:
    """A part of the model with its members in the order of the data.

    ``of`` names the classes of the model if their names differ from the name of the part. ``identity`` names the
    members by which a part is recognized if it has another name in another version. A part that ``is_sourced`` also has
    its sources in the data.
    """

    def __init__(
        self,
        name: str,
        about: str,
        *members: ModelMember,
        of: str | None = None,
        identity: str = "",
        is_sourced: bool = True,
    ) -> None:
        self.identity = tuple(identity.split())
        self.name = name
        self.about = about
        self.members = members
        self.is_sourced = is_sourced
        name_in_camel_case = "".join(word.capitalize() for word in name.split("_"))
        class_names = name_in_camel_case if of is None else of  # Separated by blanks.
        self.classes = tuple(class_names.split())
        #: The members by their names in the model. Of several with one name, the first counts.
        self.by_attribute = {member.attribute: member for member in reversed(members)}


NAME = ModelMember("name", "name", "Name.")
MEANING = ModelMember("meaning", "text", "Meaning or purpose.", "words")
NOTE = ModelMember("note", "text", "Additional information for the reader.", "words")
PRINTED_NAME = ModelMember("printed_name", "text", "Name in the manual.", "words")
NAMES = ModelMember("names", "names", "Names in manuals in other languages, each under its language code.", "words")


def described_part(part_class: Any, *additional: ModelMember, after: str = "", name: str = "") -> ModelPart:
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
    return ModelPart(
        name or name_of_part(part_class.__name__),
        description.data or description.about,
        *members,
        of=part_class.__name__,
        identity=description.identity,
        is_sourced=description.is_sourced,
    )


def _build_member(described: DescribedKey) -> ModelMember:
    key = described.key
    about = key.data or f"{key.about} {key.reading}".rstrip()
    return ModelMember(described.name, data_notation(described), about, **key.member)
