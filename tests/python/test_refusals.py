"""Values that do not fit their field are rejected in the same way, whichever function receives them."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy
import pytest
from codewheel_runtime.frames.descriptions import layout_of
from codewheel_runtime.frames.encode import encode_number

MULTITURN, SINGLETURN = "AMM5A21/65KSC1", "AMM5A21/1SC1"


@pytest.fixture(scope="module")
def amm5(generated_python: tuple[Path, ModuleType]) -> Any:
    __import__("lika_encoders.amm5")
    return generated_python[1].amm5  # type: ignore[attr-defined]


def test_messages_have_public_names(amm5: Any, generated_python: tuple[Path, ModuleType]) -> None:
    lika: Any = generated_python[1]
    encoder, serial = amm5.lookup(MULTITURN), amm5.lookup("AMM5A23/65KJP1")
    calls: list[tuple[str, Callable[[], object]]] = [
        ("SingleCycleData.__new__() missing 3 required positional", amm5.SingleCycleData),
        ("SingleturnReply.__new__() got an unexpected keyword argument 'x'", lambda: amm5.SingleturnReply(x=1)),
        ("DeviceId.__new__() missing 2 required positional arguments: 'name' and 'release'", amm5.DeviceId),
        ("EepromReadRequest.__new__() missing", amm5.EepromReadRequest),
        ("BissEncoder.decode() missing 1 required positional argument: 'frame'", encoder.decode),
        ("BissEncoder.try_decode() got an unexpected keyword argument 'x'", lambda: encoder.try_decode(1, x=2)),
        ("Rs485Encoder.decode() missing 1 required positional argument: 'frame'", serial.decode),
        ("frames of the class 5 have no position", lambda: serial.range_of(5)),
        ("expected an encoder, got 'AMM5A21'; lookup() returns one", lambda: lika.why("AMM5A21", 5)),
    ]
    for message, call in calls:
        with pytest.raises(TypeError) as caught:
            call()
        assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ({"device_id": 5}, "register 'device_id' must be bytes, got 5"),
        ({"device_id": "41 4D"}, "register 'device_id' must be bytes, got '41 4D'"),
        ({0x78: b"A"}, "the byte at 0x78 must be an integer, got b'A'"),
        ({0x78: None}, "the byte at 0x78 must be an integer, got None"),
        ({1.5: 1}, "the address of a register must be an integer, got 1.5"),
    ],
)
def test_wrong_register_contents_are_named(amm5: Any, contents: Any, message: str) -> None:
    with pytest.raises(TypeError) as caught:
        amm5.identify(contents)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("multiturn", "singleturn", "error"),
    [
        (True, 7, TypeError),
        (1, False, TypeError),
        (1, 7.0, TypeError),
        (1, 1 << 21, ValueError),
        (1, 1 << 30, ValueError),
        (1 << 16, 7, ValueError),
        (1, -1, ValueError),
        (-1, 1, ValueError),
    ],
)
def test_numbers(amm5: Any, multiturn: Any, singleturn: Any, error: type[Exception]) -> None:
    encoder = amm5.lookup(MULTITURN)
    frame = amm5.SingleCycleData(encoder, multiturn, singleturn, error=False, warning=False)
    calls: list[Callable[[], object]] = [
        frame.encode,
        lambda: frame.position,
        lambda: encoder.encode_many({"multiturn": [multiturn], "singleturn": [singleturn]}),
        lambda: encoder.encode_many({"multiturn": multiturn, "singleturn": numpy.asarray(singleturn)}),
    ]
    for call in calls:
        with pytest.raises(error):
            call()


@pytest.mark.parametrize(("value", "error"), [("no", TypeError), (None, TypeError), (2, ValueError), (-1, ValueError)])
def test_flags(amm5: Any, value: Any, error: type[Exception]) -> None:
    """A flag is True or False, or 1 or 0."""
    encoder = amm5.lookup(MULTITURN)
    with pytest.raises(error, match=r"True or False|does not fit|missing values"):
        amm5.SingleCycleData(encoder, 1, 7, error=value, warning=False).encode()
    with pytest.raises(error, match=r"True or False|does not fit|missing values"):
        encoder.encode_many({"multiturn": [1], "singleturn": [7], "error": [value]})


@pytest.mark.parametrize("value", [True, 1, numpy.True_, numpy.uint8(1)])
def test_flags_of_other_types(amm5: Any, value: Any) -> None:
    encoder = amm5.lookup(MULTITURN)
    expected = amm5.SingleCycleData(encoder, 1, 7, error=True, warning=False).encode()
    assert amm5.SingleCycleData(encoder, 1, 7, error=value, warning=False).encode() == expected
    assert encoder.encode_many({"multiturn": [1], "singleturn": [7], "error": [value]}).tolist() == [expected]


def test_positions_beyond_one_turn(amm5: Any) -> None:
    """A singleturn encoder with 21 bits has no position of 2 turns."""
    encoder = amm5.lookup(SINGLETURN)
    for convert in (encoder.degrees, encoder.turns, encoder.radians):
        assert convert((1 << 21) - 1) > 0
        for position in (1 << 21, 1 << 22, -1):
            with pytest.raises(ValueError, match=r"^position must be 0 to 2097151, got "):
                convert(position)
        with pytest.raises(TypeError, match=r"^position must be an integer, got True$"):
            convert(True)
    assert amm5.lookup(MULTITURN).turns(1 << 22) == 2.0


def test_the_compiled_function_encodes_like_the_description(generated_python: tuple[Path, ModuleType]) -> None:
    """Frames of every layout with random values of every type: the same number, or the same error."""
    from codewheel_runtime.frames.descriptions import find_kinds

    lika: Any = generated_python[1]
    source = random.Random(3)
    compared = 0
    for code in ("AMM5A21/65KSC1", "AMM5A21/65KJP1", "AMM5A23/65KBG1", "AM3616/4096-I7", "AM36S12/4096-BG"):
        try:
            encoder = lika.lookup(code)
        except ValueError:
            continue
        for kind in find_kinds(encoder):
            fields: Any = kind
            if fields._fields[0] != "variant":
                continue
            for _ in range(300):
                values = [source.choice([0, 1, True, False, 5, 35, 1 << 12, -1, 1 << 40, "no", numpy.uint8(3)])]
                values += [source.choice([0, 1, True, False, 2]) for _ in fields._fields[2:]]
                frame = fields(encoder, *values)
                assert _outcome(frame.encode) == _outcome(partial(_described, frame, encoder))
                compared += 1
    assert compared > 1000


def _described(frame: Any, encoder: Any) -> object:
    layout = layout_of(type(frame), encoder)
    number = encode_number(frame, layout, (encoder,))
    return number.to_bytes(layout.byte_count, layout.order) if layout.byte_count else number


def _outcome(call: Callable[[], object]) -> object:
    try:
        return call()
    except (TypeError, ValueError) as error:
        return type(error), str(error)
