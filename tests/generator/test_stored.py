"""Models as plain data: the same after a way through JSON, and nothing but models."""

from __future__ import annotations

import dataclasses
import json
import pkgutil
from importlib import import_module

import pytest
from codewheel import model
from codewheel.loading import stored
from codewheel.loading.stored import NotStorable, as_data, digest_of, from_data
from codewheel.targets import Library


@pytest.mark.slow
def test_a_model_survives_the_cache(library: Library) -> None:
    for device in library.devices:
        rows = json.loads(json.dumps(as_data(device)))
        assert from_data(rows) == device
        assert repr(from_data(rows)) == repr(device)
        assert digest_of(from_data(rows)) == digest_of(device)


def test_every_class_of_a_model_can_be_stored() -> None:
    """A family with another class would be checked and rendered again by every command."""
    packages = pkgutil.walk_packages(model.__path__, "codewheel.model.")
    classes = {
        item
        for module in (import_module(found.name) for found in packages if "members" not in found.name)
        for item in vars(module).values()
        if dataclasses.is_dataclass(item) and item.__module__ == module.__name__
    }
    assert len(classes) > 50
    assert classes - set(stored._CLASSES) == set()


@pytest.mark.parametrize(
    "rows",
    [
        None,
        7,
        [],
        [[]],
        [[0]],
        [[9999, 1]],
        [["Device", 1]],
        [[0, {"o": 5}]],
        [[0, {"e": [99, "X"]}]],
        [[0, {"anything": 1}]],
        [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]],
    ],
)
def test_data_that_is_not_a_model_is_rejected(rows: object) -> None:
    with pytest.raises(NotStorable):
        from_data(rows)
