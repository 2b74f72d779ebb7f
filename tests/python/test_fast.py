"""All methods that decode one frame of an encoder return the same result."""

from __future__ import annotations

import copy
import pickle
import random
from collections.abc import Callable
from typing import Any

import numpy
import pytest
from test_agreement import CASES_OF_FAMILIES, FAMILIES, Family, arguments_of, cases, families, family
from test_many import numbers

#: Result of `try_decode`. Each package has its own FrameError.
FrameErrors = ValueError

__all__ = ["families", "family"]
pytestmark = pytest.mark.slow


def frame_or_error(decode: Any, frame: object, **more: object) -> object:
    """Return the frame, or the error: its class, its text and its frame."""
    try:
        return decode(frame, **more)
    except (ValueError, TypeError) as error:
        return type(error), str(error), getattr(error, "frame", None), getattr(error, "order_code", "")


@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_it_says_the_same(family: Family) -> None:
    """The method that raises, the method that returns errors and the class's own method share their code."""
    source = random.Random(family.device.name)
    frame_count = 0
    for case in cases(family):
        encoder = case.encoder
        if case.register is not None or case.layout.sender != "encoder":
            continue
        for number in numbers(case, 300, source):
            wire = case.carried(number)
            decoded, tried = frame_or_error(encoder.decode, wire), frame_or_error(encoder.try_decode, wire)
            if isinstance(tried, FrameErrors):
                assert decoded == frame_or_error(raise_error, tried)
                assert decoded[2:] == (wire, encoder.code)  # type: ignore[index]
            else:
                assert decoded == tried
            if type(decoded) is case.view:
                assert decoded == case.view.decode(wire, *arguments_of(case))
            frame_count += hasattr(decoded, "_fields")
        assert {"decode", "try_decode"} <= vars(encoder).keys()
        for odd in (-1, 1 << 80, "0101", b"", b"x", 1.5, None, True, numpy.uint32(5), "0b" + "0" * case.placed.bits):
            tried = frame_or_error(encoder.try_decode, odd)
            assert frame_or_error(encoder.decode, odd) == (
                frame_or_error(raise_error, tried) if isinstance(tried, FrameErrors) else tried
            )
    assert frame_count or family.device.name not in FAMILIES


def raise_error(error: Exception) -> None:
    raise error


def test_a_bound_encoder_can_still_be_copied(families: dict[str, Family]) -> None:
    encoder = families["amm5"].module.lookup("AMM5A21/65KSC1")
    unbound = encoder.decode
    frame = encoder.decode(0x55BCD15E2)
    assert unbound(0x55BCD15E2) == encoder.decode("0b" + f"{0x55BCD15E2:045b}", bits=45) == frame
    for again in (copy.copy(encoder), copy.deepcopy(encoder), pickle.loads(pickle.dumps(encoder))):
        assert again == encoder
        assert again.decode(0x55BCD15E2) == frame
    assert pickle.loads(pickle.dumps(frame)) == frame


def test_other_registers_make_another_decoder(families: dict[str, Family]) -> None:
    """A decoder that is bound to an encoder with its defaults is not used if its registers differ."""
    encoder = families["am36"].module.lookup("AM3616/4096-I7")
    before = encoder.decode(0x2ABCD15EF)
    shorter = encoder.with_registers({0x56: 0x10})
    assert before.variant is encoder
    assert len({encoder.frame_bits, shorter.frame_bits}) == 2
    assert "decode" not in vars(shorter)


def test_an_error_says_which_frame_it_was(families: dict[str, Family]) -> None:
    encoder = families["amm5"].module.lookup("AMM5A21/65KSC1")
    with pytest.raises(ValueError) as caught:
        encoder.decode(0x55BCD15E3)
    assert (caught.value.frame, caught.value.order_code) == (0x55BCD15E3, "AMM5A21/65KSC1")
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.frame, again.order_code, str(again)) == (0x55BCD15E3, "AMM5A21/65KSC1", str(caught.value))


def test_an_answer_left_out_is_told_with_the_answers(families: dict[str, Family]) -> None:
    """This also holds if the answer determines the length of a frame: no attribute of None is accessed."""
    module = families["odd_shapes"].module
    encoder, kind, cycle = module.lookup("OBSC"), module.Open, module.Cycle
    message = r"form_ must be Form\.NARROW or Form\.WIDE, got .*: the manual leaves this open$"
    asking: list[Callable[[Any], object]] = [
        lambda answer: encoder.decode(5, form_=answer),
        lambda answer: encoder.try_decode(5, form_=answer),
        lambda answer: encoder.decode_many([5], form_=answer),
        lambda answer: encoder.encode_many({}, form_=answer),
        lambda answer: cycle.frame_bits(encoder, answer),
        lambda answer: cycle.bit_fields(encoder, answer),
        lambda answer: kind.decode(5, answer),
        lambda answer: kind.from_whole(answer, 1, 1),
    ]
    for asks in asking:
        for answer in (None, "narrow", module.Form):
            with pytest.raises(TypeError, match=message):
                asks(answer)
    assert cycle.frame_bits(encoder, module.Form.NARROW) == 47
    assert not hasattr(encoder, "frame_bits")
    fault = encoder.try_decode(5, form_=module.Form.NARROW)
    assert fault.hint == ""
