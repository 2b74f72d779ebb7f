"""The end of every ``match`` over a union of the model."""

from typing import NoReturn


def assert_never(value: NoReturn) -> NoReturn:
    """Makes mypy refuse a ``match`` that forgets a member of the union."""
    raise AssertionError(f"no case for {value!r}")
