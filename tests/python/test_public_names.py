"""Names at the top of a package."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from types import ModuleType

import codewheel_runtime

#: Names for programs that create steps or implement a bus. These names are in the runtime.
RARE = {
    "BitField", "Bus", "Line", "Modify", "Movement", "Poll", "Read", "Reading", "Send", "Verify", "Wait", "Write",
}  # fmt: skip


def test_rare_names_are_only_in_the_runtime(generated_python: tuple[Path, ModuleType]) -> None:
    _, lika = generated_python
    assert set(codewheel_runtime.__all__) >= RARE
    assert not RARE & {*lika.__all__, *dir(lika)}
    assert not any(hasattr(lika, name) for name in RARE)


def test_errors_of_a_link_and_asyncio_are_at_the_top(generated_python: tuple[Path, ModuleType]) -> None:
    _, lika = generated_python
    assert {"LinkError", "NoReplyError", "NotUsableError", "open_async", "open_encoder"} <= set(lika.__all__)


def test_all_public_names_can_be_copied_and_pickled(generated_python: tuple[Path, ModuleType]) -> None:
    """For worker processes. The facts are mappings, and the copies of classes and functions are the originals."""
    _, lika = generated_python
    for family in (lika.am36, lika.amm5, lika.asc85, lika.sma21):
        for name in family.__all__:
            value = getattr(family, name)
            assert pickle.loads(pickle.dumps(value)) == value == copy.deepcopy(value) == copy.copy(value), name
