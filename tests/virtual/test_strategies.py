"""Hypothesis strategies for users: frames of a virtual encoder, valid or with one wrong bit."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.strategies import disturbed_frames, frames, positions
from hypothesis import given, settings
from hypothesis import strategies as st

CODES = ("AMM5A21/65KSC1", "AMM5A17/1BG1", "AMM5A23/65KJP1")


@pytest.mark.slow
@pytest.mark.parametrize("code", CODES)
def test_frames_decode_to_their_positions(generated_python: tuple[Path, ModuleType], code: str) -> None:
    lika: Any = generated_python[1]

    @settings(max_examples=50)
    @given(frames(VirtualEncoder(code)))
    def each(drawn: Any) -> None:
        assert lika.lookup(code).decode(drawn[1]).position == drawn[0]

    each()


@pytest.mark.parametrize("code", CODES[::2])
def test_a_wrong_bit_is_detected(generated_python: tuple[Path, ModuleType], code: str) -> None:
    lika: Any = generated_python[1]

    @settings(max_examples=20)
    @given(disturbed_frames(VirtualEncoder(code)))
    def each(frame: Any) -> None:
        assert isinstance(lika.lookup(code).try_decode(frame), lika.FrameError)

    each()


@settings(max_examples=20)
@given(st.data())
def test_positions_and_names_of_frames(data: st.DataObject) -> None:
    encoder = VirtualEncoder("AMM5A23/65KJP1")
    assert 0 <= data.draw(positions(encoder)) < 1 << 39
    assert data.draw(frames(encoder, "multiturn_reply"))[1][:1] == b"\x8a"
    with pytest.raises(ValueError, match="has no frame 'nothing'; it has: singleturn_reply, "):
        data.draw(frames(encoder, "nothing"))
