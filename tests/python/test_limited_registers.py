"""A register encodes what it decodes, even if an encoder would not accept the values. Created objects have limits."""

from __future__ import annotations

import copy
import inspect
import pickle
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.targets import Library

SPECS = Path(__file__).parents[1] / "c" / "specs"


def registers_of(lika: ModuleType) -> Iterator[tuple[Any, tuple[Any, ...], int]]:
    """Yield each class of a register with the arguments that it needs, and its length."""
    from codewheel_runtime.errors import LengthError

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


def test_limits_of_a_meaning_depend_on_what_an_earlier_step_writes(import_generated: Callable[..., Any]) -> None:
    """The span is 1,000 by default. The first step of the procedure changes it, and the second one stays below it."""
    devices, report = load_library([SPECS / "arguments.yaml", SPECS / "manufacturer.yaml"])
    assert not report
    module = import_generated(Library(devices), "test_encoders")[1].arguments
    variant = module.VARIANTS["ZASC"]
    for span, inside, is_accepted in ((300, 299, True), (300, 300, False), (2000, 1999, True), (2000, 2000, False)):
        if is_accepted:
            assert module.teach(variant, span, inside)
        else:
            with pytest.raises(ValueError, match="inside"):
                module.teach(variant, span, inside)
