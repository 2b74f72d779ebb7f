"""A register encodes what it decodes, even if an encoder would not accept the values. Created objects have limits."""

from __future__ import annotations

import copy
import inspect
import pickle
import random
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest


def registers_of(lika: ModuleType) -> Iterator[tuple[Any, tuple[Any, ...], int]]:
    """Yield each class of a register with the arguments that it needs, and its length."""
    from codewheel_runtime.codec import LengthError

    for family in lika.FAMILIES:
        module: Any = getattr(lika, family.name)
        encoders = [lika.lookup(code) for code in module.VARIANTS]
        encoder = next((encoder for encoder in encoders if encoder.interface.value == "biss"), None)
        for _, kind in inspect.getmembers(module, inspect.isclass):
            bases = {base.__name__ for base in kind.__mro__}
            if kind.__module__ != module.__name__ or not bases & {"FixedRegister", "RegisterOf"}:
                continue
            arguments = (encoder,) if "RegisterOf" in bases else ()
            with pytest.raises(LengthError) as error:
                kind.decode(b"", *arguments)
            yield kind, arguments, error.value.expected


def test_each_register_encodes_what_it_decodes(generated_python: tuple[Any, ModuleType]) -> None:
    from codewheel_runtime import FrameError

    chance, count, limited = random.Random(7), 0, set[str]()
    for kind, arguments, length in registers_of(generated_python[1]):
        for data in [bytes(length), b"\xff" * length, *(chance.randbytes(length) for _ in range(100))]:
            try:
                register = kind.decode(data, *arguments)
            except FrameError:
                continue
            assert register.encode() == data, kind
            count += 1
            if hasattr(kind, "limits"):
                limited.add(kind.__name__)
    assert {"InformationPerRevolution", "NumberOfRevolutions", "Preset", "PresetOffset"} <= limited
    assert count > 2000


def test_created_and_changed_objects_have_limits(generated_python: tuple[Any, ModuleType]) -> None:
    """AM36, 6.5: a power of two, at most 1,048,576. 3,864,861 is 3A F9 1Dh."""
    lika: Any = generated_python[1]
    register = lika.am36.InformationPerRevolution.decode(bytes.fromhex("3A F9 1D"))
    assert register.steps == 3_864_861
    for copied in (register, copy.deepcopy(register), pickle.loads(pickle.dumps(register))):
        assert copied == register
        assert copied.encode() == bytes.fromhex("3A F9 1D")
    for created in (lika.am36.InformationPerRevolution(3_864_861), register._replace(steps=3)):
        with pytest.raises(lika.RangeError, match="steps must be a power of two, got "):
            created.encode()
    with pytest.raises(lika.RangeError):
        lika.am36.InformationPerRevolution(1 << 21).encode()
    assert register._replace(steps=4096).encode() == bytes.fromhex("00 10 00")
