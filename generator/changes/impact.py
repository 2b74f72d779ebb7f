"""Impact of a change on users, by output."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Impact(IntEnum):
    """Effort that a change causes for users, in ascending order."""

    NONE = 0
    #: Words, sources and other facts that no code depends on.
    DOCUMENTATION = 1
    #: Additions. Everything else is unchanged.
    COMPATIBLE = 2
    #: Code still builds, but sends, reads, accepts or rejects something else.
    BEHAVIOUR = 3
    #: Code that uses it no longer builds, or asks for something that no longer exists.
    BREAKING = 4

    @property
    def word(self) -> str:
        return self.name.lower()


#: The impacts that a user can name, lowest first.
IMPACTS = tuple(impact.word for impact in Impact if impact)
#: The outputs, in the order of reports.
OUTPUTS = ("c", "python", "xml", "pages")
TITLES = {"c": "C", "python": "Python", "xml": "XML", "pages": "pages"}


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of change.

    ``impacts`` contains one impact for each of ``OUTPUTS``. ``when`` describes the change, ``why`` justifies the
    impact.
    """

    name: str
    impacts: tuple[Impact, Impact, Impact, Impact]
    when: str
    why: str

    @property
    def impact(self) -> Impact:
        """Highest impact on any output."""
        return max(self.impacts)

    @property
    def is_renaming(self) -> bool:
        return self.name.endswith("-renamed")

    @property
    def word(self) -> str:
        """Word in the first column of the text."""
        return "renamed" if self.is_renaming else self.impact.word
