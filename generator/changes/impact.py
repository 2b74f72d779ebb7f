"""How much a change asks of whom, and in which output."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Impact(IntEnum):
    """What a change asks of a user; the highest counts."""

    NONE = 0
    #: Words, sources and other facts that no code acts on.
    DOCUMENTATION = 1
    #: Something new; all that was there is as it was.
    COMPATIBLE = 2
    #: Code builds as before, and sends, reads, accepts or refuses something else.
    BEHAVIOUR = 3
    #: Code that uses it no longer builds, or asks for something that is no longer there.
    BREAKING = 4

    @property
    def word(self) -> str:
        return self.name.lower()


#: The words that a user can give, the lowest first.
IMPACTS = tuple(item.word for item in Impact if item)
#: The outputs, in the order in which they are told.
OUTPUTS = ("c", "python", "xml", "pages")
TITLES = {"c": "C", "python": "Python", "xml": "XML", "pages": "pages"}


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of change.

    ``impacts`` has that of each of ``OUTPUTS``; ``when`` says what the rule is about, ``why`` why it has this impact.
    """

    name: str
    impacts: tuple[Impact, Impact, Impact, Impact]
    when: str
    why: str

    @property
    def impact(self) -> Impact:
        """That of the output that it reaches most."""
        return max(self.impacts)

    @property
    def is_renaming(self) -> bool:
        return self.name.endswith("-renamed")

    @property
    def word(self) -> str:
        """What the first column of the text says."""
        return "renamed" if self.is_renaming else self.impact.word
