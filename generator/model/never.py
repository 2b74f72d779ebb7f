"""The last case of every ``match`` over a union type of the model."""

from typing import NoReturn


def assert_never(value: NoReturn) -> NoReturn:
    """Make mypy reject a ``match`` that misses a member of the union."""
    raise AssertionError(f"no case for {value!r}")
