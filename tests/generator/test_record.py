"""Data classes of the model behave like data classes of the standard library."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import pytest
from codewheel.model.record import dataclass
from codewheel.targets import Library

Decorator = Callable[..., Callable[[type], Any]]


def class_with_members(decorator: Decorator) -> Any:
    """Return a class with every kind of member, and a base class."""

    @decorator(frozen=True, slots=True)
    class Base:
        first: int
        second: str = "two"
        third: list[int] = dataclasses.field(default_factory=list)

    @decorator(frozen=True, slots=True, kw_only=True)
    class Derived(Base):
        fourth: int
        fifth: str = "five"
        sixth: list[int] = dataclasses.field(default_factory=list, compare=False)

    return Derived


OURS, THEIRS = class_with_members(dataclass), class_with_members(dataclasses.dataclass)
ARGUMENTS: tuple[tuple[tuple[Any, ...], dict[str, Any]], ...] = (
    ((1,), {"fourth": 4}),
    ((1, "2", [3]), {"fourth": 4, "fifth": "5"}),
    ((), {"first": 1, "third": [], "fourth": 4}),
    ((), {}),
    ((1,), {}),
    ((1, "2", [3], 4), {}),
    ((1,), {"fourth": 4, "first": 1}),
    ((1,), {"fourth": 4, "other": 5}),
)


def result_of(kind: Any, *values: Any, **named: Any) -> str:
    try:
        return repr(kind(*values, **named))
    except TypeError:
        return "TypeError"


@pytest.mark.parametrize(("values", "named"), ARGUMENTS)
def test_arguments_are_those_of_the_standard_library(values: tuple[Any, ...], named: dict[str, Any]) -> None:
    expected = result_of(THEIRS, *values, **named)
    # The first object compiles the method, and the second one uses it.
    assert result_of(class_with_members(dataclass), *values, **named) == expected
    assert result_of(OURS, *values, **named) == expected


def test_each_object_has_its_own_default() -> None:
    first, second = OURS(1, fourth=4), OURS(1, fourth=4)
    assert first == second
    assert first.third is not second.third


def test_members_that_are_not_compared_make_no_difference() -> None:
    assert OURS(1, third=(), fourth=4, sixth=[1]) == OURS(1, third=(), fourth=4, sixth=[2])
    assert hash(OURS(1, third=(), fourth=4, sixth=[1])) == hash(OURS(1, third=(), fourth=4))


def test_a_copy_can_differ() -> None:
    assert dataclasses.replace(OURS(1, fourth=4), fifth="6") == OURS(1, fourth=4, fifth="6")


def test_objects_cannot_be_changed() -> None:
    instance = OURS(1, fourth=4)
    with pytest.raises(dataclasses.FrozenInstanceError, match="'first'"):
        instance.first = 2
    with pytest.raises(dataclasses.FrozenInstanceError, match="'first'"):
        del instance.first
    with pytest.raises(dataclasses.FrozenInstanceError):
        instance.other = 2
    assert instance.first == 1


def test_the_range_of_a_position_is_found_again_only_for_layouts_of_the_device(library: Library) -> None:
    for device in library.devices:
        for _, layout in device.layouts():
            fresh = dataclasses.replace(device).range_in(layout)
            assert [device.range_in(layout), device.range_in(layout)] == [fresh, fresh]
            assert device.range_in(dataclasses.replace(layout)) is None
