"""Messages about text that is not an order code, for the command line and the page. Callers format the lists."""

from __future__ import annotations


def too_long(start: str, length: str, longest: str) -> str:
    """Return the message for text that is longer than any label."""
    return f"'{start}...' is not an order code: it has {length} characters, more than the {longest} of any label"


def cannot_be_combined(code: str, parts: str, nearest: str) -> str:
    """Return the message for parts that are valid individually but not in combination."""
    return f"'{code}' has {parts}, which cannot be combined; the nearest codes are {nearest}"


def not_of_family(code: str, family: str, nearest: str) -> str:
    return f"'{code}' is not an order code of {family}; the nearest are {nearest}"


def wrong_part(code: str, problem: str, valid: str, nearest: str) -> str:
    """Return the message for one wrong or missing part. ``problem`` says which: ``has singleturn '19'``."""
    return f"'{code}' {problem}; valid values: {valid}. The nearest codes are {nearest}"


def has_part(name: str, value: str) -> str:
    return f"has {name} '{value}'"


def has_no_part(name: str) -> str:
    return f"has no {name}"


def family(text: str, code: str) -> str:
    """Return the message for the name of a family in place of an order code."""
    return f"'{text}' is a family; give an order code, such as {code}"


def unknown(text: str) -> str:
    return f"'{text}' is not a known order code"


def nearest(codes: str) -> str:
    """Return the end of the message for an unknown order code that is similar to others."""
    return f"; the nearest are {codes}"
