"""The generated package against the model's own codec: every order code, sound frames and damaged ones."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from codewheel import codec
from codewheel.model import Device, Field, Layout, PlacedLayout, Variant

KINDS = {"LengthError": "length", "CrcError": "crc", "ConstantError": "constant", "RangeError": "range"}
ROUNDS = 12

CODES = [f"AMM5{mount}{bits}/{turns}{interface}" for mount in "AB" for bits in (17, 21, 23) for turns in ("1", "65K") for interface in ("BG1", "SC1", "JP1")]


@pytest.fixture(scope="session")
def amm5(generated_python: tuple[Path, ModuleType]) -> Any:
    package: Any = generated_python[1]
    return package.amm5


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def layouts(device: Device, variant: Variant) -> Iterator[Layout]:
    yield from device.interface(variant.interface).layouts
    yield from (register.layout for register in device.registers if register.interface == variant.interface)


def values_of(placed: PlacedLayout, field: Field, width: int, kind: str, source: random.Random) -> int | str | bool:
    if field.name == placed.layout.selector:
        return source.choice(placed.layout.selects)
    if field.kind == "flag":
        return {"zero": False, "ones": True}.get(kind, source.random() < 0.5)
    if field.kind == "choice":
        return source.choice(field.values).value
    if field.kind == "text":
        return "".join(chr(source.randrange(0x20, 0x7F)) for _ in range(width // 8))
    largest = (1 << width) - 1
    if field.kind == "digits":
        largest = min(largest, field.digits[0].divisor * field.digits[0].modulus - 1)
    chosen = {"zero": 0, "one": 1, "ones": largest, "top": 1 << (width - 1) if width else 0}
    return min(chosen.get(kind, source.randint(0, largest)), largest)


def decode_generated(module: Any, view: Any, variant: Any, data: Any) -> Any:
    """The decoded object, or the kind of its fault as the model calls it."""
    takes_variant = "variant" in getattr(view, "_fields", ())
    try:
        return view.decode(data, variant) if takes_variant else view.decode(data)
    except ValueError as error:
        return KINDS[type(error).__name__]


@pytest.mark.parametrize("code", CODES)
def test_round_trip(amm5: Any, devices: Mapping[str, Device], code: str) -> None:
    device = devices["amm5"]
    variant, made = device.variant(code), amm5.VARIANTS[code]
    source = random.Random(code)
    for layout in layouts(device, variant):
        view = getattr(amm5, camel(layout.name))
        placed = layout.place(variant.parameters)
        for kind in ["zero", "one", "ones", "top", *["random"] * ROUNDS]:
            values = {item.name: values_of(placed, item.field, item.width, kind, source) for item in placed.fields if item.field.carries_data}
            number = codec.encode(device, placed, values)
            data = codec.number_to_bytes(layout, number, placed.bits) if layout.carried_as == "bytes" else number
            found = decode_generated(amm5, view, made, data)
            assert not isinstance(found, str), (layout.name, kind, found)
            assert found.encode() == data
            compare(codec.decode(device, placed, number), found, layout)
            joins = [join.name for join in layout.joins]
            if joins:
                others = [value for name, value in zip(found._fields, found) if name not in (*layout.joins[0].fields, "variant")]
                assert getattr(view, f"from_{joins[0]}")(made, getattr(found, joins[0]), *others) == found


def compare(expected: codec.Decoded, found: Any, layout: Layout) -> None:
    """Whether both read the same values."""
    if not hasattr(found, "_fields"):
        assert found.name.lower() == expected.fields[0].value
        return
    fixed = {field.name for field in layout.fields if not field.carries_data}
    for item in expected.fields:
        if item.name in fixed:
            continue
        value = getattr(found, item.name)
        assert (value.name.lower() if hasattr(value, "name") and isinstance(item.value, str) else value) == item.value, item.name


@pytest.mark.parametrize("code", CODES)
def test_faults_are_told_as_the_model_tells_them(amm5: Any, devices: Mapping[str, Device], code: str) -> None:
    device = devices["amm5"]
    variant, made = device.variant(code), amm5.VARIANTS[code]
    source = random.Random(code)
    seen = set()
    for layout in layouts(device, variant):
        view = getattr(amm5, camel(layout.name))
        placed = layout.place(variant.parameters)
        for number in damaged(device, placed, source):
            expected = codec.decode(device, placed, number)
            if number >> placed.bits and layout.carried_as == "bytes":
                continue
            data = codec.number_to_bytes(layout, number, placed.bits) if layout.carried_as == "bytes" else number
            found = decode_generated(amm5, view, made, data)
            if expected.problems:
                seen.add(expected.problems[0].kind)
                assert found == expected.problems[0].kind, (layout.name, hex(number))
            else:
                assert not isinstance(found, str), (layout.name, hex(number), found)
                compare(expected, found, layout)
    assert seen >= {"ssi": {"length"}, "biss": {"crc", "constant", "length", "range"}, "rs485": {"crc", "constant", "range"}}[variant.interface]


def damaged(device: Device, placed: PlacedLayout, source: random.Random) -> Iterator[int]:
    """Frames with bits changed, some of them with a CRC that fits the change, and numbers out of the air."""
    values = {item.name: values_of(placed, item.field, item.width, "random", source) for item in placed.fields if item.field.carries_data}
    sound = codec.encode(device, placed, values)
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
