"""Wording of numbers with units and of other facts, shared by all text outputs."""

from __future__ import annotations

from ..model import PrintedTimeout, Timeout, Verdict
from .numbers import counted as counted
from .numbers import number as number
from .numbers import with_unit as with_unit

_RULE = {"follows_clock": "varies with the clock", "fixed": "fixed"}
#: Verdicts on the position, as clauses.
WORTH = {
    Verdict.NOT_USABLE: "the position is not usable",
    Verdict.USABLE_WITH_WARNING: "the position is usable, with a warning",
    Verdict.USABLE: "the position is usable",
    Verdict.UNKNOWN: "no bit of this frame confirms that the position is usable",
}
_LANGUAGES = {
    "de": "German",
    "en": "English",
    "es": "Spanish",
    "fr": "French",
    "it": "Italian",
    "ja": "Japanese",
    "zh": "Chinese",
}


def hertz(value: int) -> str:
    """Return a frequency in its shortest unit."""
    for factor, unit in ((1_000_000, "MHz"), (1_000, "kHz")):
        if value >= factor:
            return f"{value / factor:g} {unit}"
    return f"{value} Hz"


def volts(millivolts: int) -> str:
    return f"{millivolts / 1000:g} V"


def microseconds(value: int) -> str:
    """Return a time in the largest unit in which it is a whole number."""
    for factor, unit in ((1_000_000, "s"), (1_000, "ms")):
        if value >= factor and value % factor == 0:
            return f"{value // factor} {unit}"
    return f"{value} µs"


def nanoseconds(value: int) -> str:
    if value % 1000 == 0:
        return microseconds(value // 1000)
    return f"{value / 1000:g} µs" if value > 1000 else f"{value} ns"


def printed_timeout_words(printed: PrintedTimeout) -> str:
    """Return a time-out that a manual prints, with its clock."""
    return f"{nanoseconds(printed.timeout_ns)} at {hertz(printed.clock_hz)}"


def timeout_words(timeout: Timeout) -> str:
    """Return the rule and limits of a time-out."""
    half = timeout.half_clock_periods
    parts = [f"{half / 2:g} clock periods" if half is not None else _RULE.get(timeout.rule, timeout.rule)]
    bounds = {"typically": timeout.typical_ns, "at most": timeout.at_most_ns}
    parts += [f"{word} {nanoseconds(value)}" for word, value in bounds.items() if value is not None]
    if half is None:
        # Without a rule, only the values printed in the manual are known.
        parts += map(printed_timeout_words, timeout.printed)
    return ", ".join(parts)


def language(key: str) -> str:
    """Return the name of a language, or its code if there is no name for it."""
    return _LANGUAGES.get(key, key)


def sentence(text: str) -> str:
    """Return the text with a full stop, unless it already ends with punctuation."""
    return text if not text or text.endswith((".", "!", "?", ":")) else f"{text}."
