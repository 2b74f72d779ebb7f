"""Facts about the clock of an interface: its limits, the limits with long cables, and the timeout after a frame."""

from __future__ import annotations

from typing import Literal

from .documents import Sources
from .part import ClocksInUse, Count, Phrase, key, only_key, part, source_key


@part(
    "Clock frequencies: the limits of the encoder, and clocks that are known to have been used. "
    "One of the two is required, unless the source is still TODO or the grade is uncorroborated. The "
    "outputs then say that the clock is not known.",
    data="Clock frequencies. A limit is null if it is not known.",
)
class Clock:
    """The master's clock: its limits, inclusive, each None if not known, and clocks with which encoders are read.

    ``used_hz`` contains the clocks of programs and masters in ascending order. They are not limits. A spec whose clock
    has not been stated yet has neither limits nor clocks in use.
    """

    min_hz: int | None = key(
        "Minimum clock frequency in Hz. Leave it out if it is not known.",
        data="Minimum frequency in Hz.",
        minimum=1,
        maximum=1000000000,
        default=None,
        rule="clock-narrower",
        label="lowest clock",
        read="clock",
    )
    max_hz: int | None = key(
        "Maximum clock frequency in Hz. Required, unless 'used_hz' is given or no clock is known.",
        data="Maximum frequency in Hz.",
        minimum=1,
        maximum=1000000000,
        default=None,
        rule="clock-narrower",
        label="highest clock",
        read="clock",
    )
    used_hz: ClocksInUse = key(
        "A clock in Hz at which a program or a master reads the encoder, or a list of them in "
        "ascending order. It is not a limit. Use it if no document of the manufacturer gives the "
        "limits.",
        data="Frequencies in Hz that programs or masters use, in ascending order. They are not limits.",
        default=(),
        rule="clock-used",
        label="clock in use",
        read="clock",
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key()

    @property
    def fastest_hz(self) -> int | None:
        """Highest clock if it is known, otherwise the fastest that is in use. None if there is neither."""
        return self.max_hz if self.max_hz is not None else max(self.used_hz, default=None)

    @property
    def has_limits(self) -> bool:
        return self.min_hz is not None or self.max_hz is not None


@part("One value.", data="A value calculated in the manual.")
class PrintedTimeout:
    """Timeout given in the manual for one clock frequency."""

    clock_hz: int = key("Clock in Hz.", minimum=1)
    timeout_ns: Count = key("Timeout in nanoseconds.")


@part("Timeout after a frame.")
class Timeout:
    """Timeout after a frame. ``rule`` is ``follows_clock`` or ``fixed``."""

    rule: Literal["follows_clock", "fixed"] = key(
        "Rule of the timeout: it depends on the clock, or it is fixed.", read="time", shape="name"
    )
    half_clock_periods: int | None = key(
        "Length in half clock periods: 3 is one and a half periods.",
        data="Length in half clock periods.",
        minimum=1,
        maximum=100,
        default=None,
        read="time",
    )
    at_most_ns: Count | None = key("Upper bound in nanoseconds.", default=None, read="time", noun="upper bound")
    typical_ns: Count | None = key("Typical value in nanoseconds.", default=None, read="time", noun="typical value")
    printed: tuple[PrintedTimeout, ...] = key(
        "Values calculated in the manual.", writing="'check' compares them with the rule.", least=0, default=()
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key()


#: Keys of the clock limit in a row of the table of cable lengths.
CABLE_LIMITS = ("below_hz", "at_most_hz")


@part("One row of the table.", data="Highest clock frequency by cable length.")
class CableLength:
    """Clock limit in Hz for cables shorter than a length in metres: ``below_hz`` (exclusive) or ``at_most_hz``."""

    shorter_than_m: int = key("Cable length in metres, exclusive upper bound.", minimum=1)
    below_hz: int | None = key("Clock in Hz, exclusive upper bound.", minimum=1, default=None)
    at_most_hz: int | None = key(
        "Clock in Hz, inclusive upper bound.",
        writing="All rows of a table have either this key or below_hz.",
        minimum=1,
        default=None,
    )
    only: Phrase = only_key(default="")
    source: Sources = source_key(default=())

    @property
    def is_exclusive(self) -> bool:
        """True if the clock must be below the limit, not equal to it."""
        return self.at_most_hz is None

    @property
    def limit_key(self) -> str:
        """Key of the limit: ``at_most_hz`` or, by default, ``below_hz``."""
        return "below_hz" if self.is_exclusive else "at_most_hz"

    @property
    def limit_hz(self) -> int:
        """The limit as the manual prints it, or 0 if the row of a spec with problems has none."""
        return self.at_most_hz or self.below_hz or 0

    @property
    def limit_words(self) -> str:
        """Words in front of the limit: ``below`` or ``at most``."""
        return "below" if self.is_exclusive else "at most"
