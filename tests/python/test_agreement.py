"""The generated package against the model's own codec: every order code, sound frames and damaged ones."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from codewheel import codec
from codewheel.load import load_library
from codewheel.model import Device, Field, Layout, PlacedLayout, Register, Variant
from codewheel.targets import Library

KINDS = {"LengthError": "length", "CrcError": "crc", "ConstantError": "constant", "RangeError": "range"}
ROUNDS = 12

CODES = [f"AMM5{mount}{bits}/{turns}{interface}" for mount in "AB" for bits in (17, 21, 23) for turns in ("1", "65K") for interface in ("BG1", "SC1", "JP1")]
#: Of specs/words.yaml, which is made up of what no device has yet; the second with the run-time parameter that sends Gray code.
WORDS = [f"W{bits}{interface}{gray}" for bits in (20, 24) for interface in ("SC", "BG", "JP") for gray in ("", " gray")]


@dataclasses.dataclass(frozen=True)
class Case:
    """An order code as the model knows it and as the generated module does."""

    device: Device
    variant: Variant
    module: Any
    made: Any

    def layouts(self) -> Iterator[tuple[Layout, Register | None]]:
        yield from ((item, None) for item in self.device.interface(self.variant.interface).layouts)
        yield from ((item.layout, item) for item in self.device.registers if item.interface == self.variant.interface)


@pytest.fixture(scope="session")
def amm5(generated_python: tuple[Path, ModuleType]) -> Any:
    package: Any = generated_python[1]
    return package.amm5


@pytest.fixture(scope="session")
def words(import_generated: Callable[[Library, str], tuple[Path, ModuleType]]) -> tuple[Device, Any]:
    found, report = load_library([Path(__file__).parent.parent / "specs"])
    assert not report, "\n".join(problem.format() for problem in report.problems)
    device = next(item for item in found if item.name == "words")
    package: Any = import_generated(Library((device,)), "test_encoders")[1]
    return device, package.words


@pytest.fixture
def case(request: pytest.FixtureRequest, amm5: Any, words: tuple[Device, Any], devices: Mapping[str, Device]) -> Case:
    code, _, gray = request.param.partition(" ")
    if not code.startswith("W"):
        return Case(devices["amm5"], devices["amm5"].variant(code), amm5, amm5.VARIANTS[code])
    device, module = words
    variant, made = device.variant(code), module.VARIANTS[code]
    if gray:
        variant, made = dataclasses.replace(variant, parameters={**variant.parameters, "gray": 1}), dataclasses.replace(made, gray=1)
    return Case(device, variant, module, made)


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def value_of(placed: PlacedLayout, register: Register | None, field: Field, width: int, kind: str, source: random.Random) -> int | str | bool:
    """A value that the field can have; ``kind`` says which."""
    if field.name == placed.layout.selector:
        return source.choice(placed.layout.selects)
    if field.kind == "flag":
        return {"zero": False, "ones": True}.get(kind, source.random() < 0.5)
    if field.kind == "choice":
        return source.choice(field.values).value
    if field.kind == "text":
        return "".join(chr(source.randrange(0x20, 0x7F)) for _ in range(width // 8))
    lowest, largest = 0, (1 << width) - 1
    if field.power_of_two:
        return 1 << source.randrange(width)
    if field.zero_means:
        lowest, largest = 1, field.zero_means
    if field.signed:
        lowest, largest = -(1 << (width - 1)), (1 << (width - 1)) - 1
    if field.kind == "digits":
        largest = min(largest, field.digits[0].divisor * field.digits[0].modulus - 1)
    if register is not None and register.limits_of == field.name and register.min is not None and register.max is not None:
        lowest, largest = register.min.constant, register.max.constant
    chosen = {"zero": lowest, "one": 1, "ones": -1 if field.signed else largest, "top": 1 << (width - 1) if width else 0}
    return max(lowest, min(chosen.get(kind, source.randint(lowest, largest)), largest))


def values_of(placed: PlacedLayout, register: Register | None, kind: str, source: random.Random) -> dict[str, int | str | bool]:
    return {item.name: value_of(placed, register, item.field, item.width, kind, source) for item in placed.fields if item.field.carries_data}


def decode_generated(view: Any, variant: Any, data: Any) -> Any:
    """The decoded object, or the kind of its fault as the model calls it."""
    takes_variant = "variant" in getattr(view, "_fields", ())
    try:
        return view.decode(data, variant) if takes_variant else view.decode(data)
    except ValueError as error:
        return KINDS[type(error).__name__]


@pytest.mark.parametrize("case", CODES + WORDS, indirect=True)
def test_round_trip(case: Case) -> None:
    source = random.Random(case.variant.code)
    for layout, register in case.layouts():
        view = getattr(case.module, camel(layout.name))
        placed = layout.place(case.variant.parameters)
        for kind in ["zero", "one", "ones", "top", *["random"] * ROUNDS]:
            number = codec.encode(case.device, placed, values_of(placed, register, kind, source))
            data = codec.number_to_bytes(layout, number, placed.bits) if layout.carried_as == "bytes" else number
            found = decode_generated(view, case.made, data)
            assert not isinstance(found, str), (layout.name, kind, found)
            assert found.encode() == data
            compare(codec.decode(case.device, placed, number), found, layout)
            for join in layout.joins:
                others = [value for name, value in zip(found._fields, found) if name not in (*join.fields, "variant")]
                assert getattr(view, f"from_{join.name}")(case.made, getattr(found, join.name), *others) == found


def compare(expected: codec.Decoded, found: Any, layout: Layout) -> None:
    """Whether both read the same values."""
    if not hasattr(found, "_fields"):
        assert found.name.lower() == expected.fields[0].value
        return
    fixed = {field.name for field in layout.fields if not field.carries_data}
    for item in expected.fields:
        if item.name in fixed:
            continue
        value = getattr(found, item.name if item.name != "index" else "index_")
        assert (value.name.lower() if hasattr(value, "name") and isinstance(item.value, str) else value) == item.value, item.name


@pytest.mark.parametrize("case", CODES + WORDS, indirect=True)
def test_faults_are_told_as_the_model_tells_them(case: Case) -> None:
    source = random.Random(case.variant.code)
    seen = set()
    for layout, register in case.layouts():
        view = getattr(case.module, camel(layout.name))
        placed = layout.place(case.variant.parameters)
        for number in damaged(case.device, placed, register, source):
            expected = codec.decode(case.device, placed, number)
            if number >> placed.bits and layout.carried_as == "bytes":
                continue
            data = codec.number_to_bytes(layout, number, placed.bits) if layout.carried_as == "bytes" else number
            found = decode_generated(view, case.made, data)
            if expected.problems:
                seen.add(expected.problems[0].kind)
                assert found == expected.problems[0].kind, (layout.name, hex(number))
            else:
                assert not isinstance(found, str), (layout.name, hex(number), found)
                compare(expected, found, layout)
    assert seen >= {"ssi": {"length"}, "biss": {"crc", "constant", "length", "range"}, "rs485": {"crc", "constant", "range"}}[case.variant.interface]


def damaged(device: Device, placed: PlacedLayout, register: Register | None, source: random.Random) -> Iterator[int]:
    """Frames with bits changed, some of them with a CRC that fits the change, and numbers out of the air."""
    sound = codec.encode(device, placed, values_of(placed, register, "random", source))
    crc = placed.layout.crc_field
    yield sound
    yield sound | 1 << placed.bits
    for bit in range(placed.bits):
        yield sound ^ 1 << bit
        if crc is not None:
            yield repaired(device, placed, sound ^ 1 << bit)
    for _ in range(4 * ROUNDS):
        number = source.getrandbits(placed.bits)
        yield number
        if crc is not None:
            yield repaired(device, placed, number)


def repaired(device: Device, placed: PlacedLayout, number: int) -> int:
    item = next(item for item in placed.fields if item.field.kind == "crc")
    cleared = number & ~(item.mask << item.low)
    return cleared | codec.compute(device.crc(item.field.crc), placed, cleared) << item.low


def test_any_bytes_are_told_as_the_model_tells_them(amm5: Any, devices: Mapping[str, Device]) -> None:
    device = devices["amm5"]
    source = random.Random(5)
    variant = device.variant("AMM5B21/65KJP1")
    made = amm5.VARIANTS[variant.code]
    frames = [bytes(source.getrandbits(8) for _ in range(source.randrange(13))) for _ in range(3000)]
    frames += [bytes([control]) + bytes(source.getrandbits(8) for _ in range(length)) for control in range(256) for length in range(12)]
    frames += [frame[:-1] + bytes([amm5.crc_rs485_8(frame[:-1])]) for frame in frames if frame]
    for sender, decode in (("encoder", amm5.decode_reply), ("master", amm5.decode_request)):
        for frame in frames:
            expected = codec.decode_bytes(device, variant, sender, frame)
            try:
                found = decode(frame, made)
            except ValueError as error:
                assert expected.problems and KINDS[type(error).__name__] == expected.problems[0].kind, frame.hex(" ")
            else:
                assert not expected.problems and expected.layout is not None, frame.hex(" ")
                compare(expected, found, expected.layout.layout)


def test_error_warning_and_crc_are_told_apart(amm5: Any) -> None:
    variant = amm5.lookup("AMM5A21/65KSC1")
    for error in (False, True):
        for warning in (False, True):
            word = amm5.SingleCycleData.from_position(variant, 123456, error=error, warning=warning).encode()
            frame = variant.decode(word)
            assert (frame.position, frame.error, frame.warning) == (123456, error, warning)
            with pytest.raises(ValueError) as caught:
                variant.decode(word ^ 0x80)
            assert type(caught.value).__name__ == "CrcError"
            assert caught.value.received == word & 0x3F != caught.value.computed


def test_steps_of_every_kind(words: tuple[Device, Any]) -> None:
    _, module = words
    steps = module.import_(limit=1000, bank=2)
    assert [type(step).__name__ for step in steps] == ["Read", "Modify", "Write", "Write", "Write", "Poll", "Wait"]
    assert (steps[1].mask, steps[1].value) == (0x06, 0x02)
    assert bytes(step.value for step in steps[2:5]) == b"\x03\xe8\x02"
    with pytest.raises(ValueError, match="10 to 1000"):
        module.import_(limit=1001, bank=0)


def test_values_that_only_some_encoders_have(words: tuple[Device, Any]) -> None:
    _, module = words
    variant = module.lookup("w99sc")
    assert (variant.code, variant.unlisted, variant.position_bits, variant.class_) == ("W99SC", ("resolution",), 20, 3)
    assert variant.micrometres(7) == 350
    assert module.Scale.decode(bytes(2) + b"\x00\x01") == (65536, 1)
    for wrong in (module.Scale(0, 1), module.Scale(65537, 1), module.Scale(1, 3), module.Offset(1 << 47), module.Offset(-(1 << 47) - 1)):
        with pytest.raises(ValueError):
            wrong.encode()
    assert module.Offset(-1).encode() == b"\xff" * 6
    assert module.Profile(variant, 10260).is_as_documented
    assert module.BISS.timeout.nanoseconds(1) == 16000
