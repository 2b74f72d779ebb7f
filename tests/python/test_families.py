"""The content of the package for every family: examples, order codes, meanings of counts, identification, data."""

from __future__ import annotations

import inspect
import random
import re
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

import codewheel_runtime
import pytest
from codewheel.model import (
    Biss,
    CrcExample,
    Device,
    Example,
    FrameExample,
    Layout,
    MeasureExample,
    ProcedureExample,
    Register,
    RegisterExample,
    Text,
    Unused,
    Variant,
)
from codewheel.order_codes.labels import UnknownOrderCode, find_code
from codewheel.targets.python.names import CLASS_NAMES, DeviceNames, python_name

_Kind = TypeVar("_Kind", bound=Example)
ERRORS = {"length": "LengthError", "crc": "CrcError", "constant": "ConstantError", "range": "RangeError"}


@pytest.fixture(scope="session")
def lika(generated_python: tuple[Path, ModuleType]) -> Any:
    return generated_python[1]


def examples(
    lika: Any, devices: Mapping[str, Device], kind: type[_Kind]
) -> Iterator[tuple[Device, Any, DeviceNames, _Kind]]:
    """Return the worked examples of a kind in all families, each with the family, its module and the names in it."""
    has_examples = False
    for device in devices.values():
        names = DeviceNames(device)
        for example in device.examples:
            if isinstance(example, kind):
                has_examples = True
                yield device, getattr(lika, device.name), names, example
    assert has_examples


def values_by_name(decoded: Any, names: Mapping[str, object], layout: Layout) -> dict[str, object]:
    """Return attributes as the specs write them: a named value, and unused bits by the name of their field."""
    unused = {field.name: (field, place) for field, place in layout.unused}
    attributes = {name: getattr(decoded, python_name(name, CLASS_NAMES)) for name in names if name not in unused}
    for field, place in (unused[name] for name in names if name in unused):
        assert isinstance(field.kind, Unused)
        attributes[field.name] = decoded.unused >> place & ((1 << field.widest) - 1) ^ field.kind.value
    for name, value in attributes.items():
        if hasattr(value, "name") and isinstance(names[name], str):
            attributes[name] = value.name.lower()
    return attributes


# ------------------------------------------------------------------------------------------------------ worked examples


def test_register_examples(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, module, names, example in examples(lika, devices, RegisterExample):
        register = getattr(module, names.class_name_by_register[example.register])
        takes_variant = "variant" in getattr(register, "_fields", ())
        extra_arguments = [lika.lookup(example.order_code)] if takes_variant else []
        decoded = register.decode(example.bytes, *extra_arguments)
        if hasattr(decoded, "_fields"):
            layout = device.register(example.register).layout
            assert values_by_name(decoded, example.values, layout) == example.values, (device.name, example.name)
        else:
            assert [decoded.name.lower()] == list(example.values.values()), (device.name, example.name)
        assert decoded.encode() == example.bytes, (device.name, example.name)


def test_procedure_examples(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, module, _, example in examples(lika, devices, ProcedureExample):
        procedure = getattr(module, example.procedure)
        takes_variant = procedure.__code__.co_varnames[:1] == ("variant",)
        encoders = [lika.lookup(example.order_code)] if takes_variant else []
        steps = procedure(*encoders, *example.arguments.values())
        register_bytes: dict[int, int] = {}
        for register in module.REGISTERS.values():
            register_bytes |= enumerate(register.default or b"", register.address)
        writes = []
        for step in steps:
            if isinstance(step, codewheel_runtime.Write):
                writes.append((step.address, step.value))
            elif isinstance(step, codewheel_runtime.Modify):
                assert step.length == 1
                writes.append((step.address, register_bytes[step.address] & ~step.mask | step.value))
            register_bytes |= dict(writes)
        assert writes == [(write.address, write.value) for write in example.writes], (device.name, example.name)


def test_frame_examples(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, module, names, example in examples(lika, devices, FrameExample):
        variant = lika.lookup(example.order_code)
        frame = int(example.bits, 2) if example.bits else example.bytes
        answers = {}
        for name, answer in answers_of_example(device, variant.interface.name, example).items():
            answers[name] = getattr(module, names.question_by_name[name].enum_name)[answer.upper()]
        decode = variant.decode if example.sender == "encoder" else partial(module.decode_request, variant=variant)
        decode = partial(decode, **answers)
        if example.refused:
            with pytest.raises(getattr(lika, ERRORS[example.refused])):
                decode(frame)
            continue
        decoded = decode(frame)
        layouts = {names.class_name_by_frame[layout.name]: layout for _, layout in device.layouts()}
        layout = layouts[type(decoded).__name__]
        assert example.layout in ("", layout.name)
        assert values_by_name(decoded, example.values, layout) == example.values, (device.name, example.name)
        assert decoded.encode() == frame, (device.name, example.name)


def answers_of_example(device: Device, interface: str, example: FrameExample) -> dict[str, str]:
    """Return the names of the answers to the open questions: over RS-485 the first answers, if the example has none."""
    answers = {}
    if interface == "RS485":
        alternatives = [alternative for alternative in device.alternatives if not alternative.default]
        answers = {alternative.name: alternative.answers[0].name for alternative in alternatives}
    return {**answers, **example.alternatives}


def test_crc_examples(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, module, _, example in examples(lika, devices, CrcExample):
        function = getattr(module, f"crc_{example.crc}")
        arguments: list[Any] = [example.bytes]
        if device.crc(example.crc).width % 8 != 0:
            arguments = [int.from_bytes(example.bytes, "big"), 8 * len(example.bytes)]
        computed = function(*arguments)
        assert computed == example.check, (device.name, example.name)


def test_measure_examples(lika: Any, devices: Mapping[str, Device]) -> None:
    for device, _, _, example in examples(lika, devices, MeasureExample):
        variant = lika.lookup(example.order_code)
        assert variant.micrometres(example.counts) == example.micrometres, (device.name, example.name)
        assert variant.millimetres(example.counts) == (example.micrometres or 0) / 1000


# ---------------------------------------------------------------------------------------------------------- order codes


@pytest.mark.slow
def test_the_order_codes_of_all_families(lika: Any, devices: Mapping[str, Device]) -> None:
    """Each is found in any case and with a suffix, with the model's values. A wrong or missing part is refused."""
    assert {family.name for family in lika.FAMILIES} == set(devices)
    for device in devices.values():
        module = getattr(lika, device.name)
        parameters = [parameter for parameter in device.parameters if not parameter.alternative]
        assert list(module.VARIANTS) == [variant.code for variant in device.variants]
        for variant in device.variants:
            for label, tail, special in (
                (variant.code, "", False),
                (variant.code.lower(), "", False),
                (f" {variant.code}-ABC/S123 ", "-ABC", True),
            ):
                encoder = lika.lookup(label)
                assert (encoder == module.VARIANTS[variant.code]) is not special
                assert (encoder.interface.value, encoder.tail, encoder.special, encoder.unlisted) == (
                    variant.interface,
                    tail,
                    special,
                    (),
                )
                for parameter in parameters:
                    if parameter.interface in ("", variant.interface):
                        assert (
                            getattr(encoder, python_name(parameter.name, ("class",)))
                            == variant.parameters[parameter.name]
                        )
            for part in device.order_code.parts:
                for mistaken_text in ("", "ZZ9"):
                    code = order_code_with(device, {**variant.parts, part.name: mistaken_text})
                    with pytest.raises(lika.OrderCodeError) as caught:
                        lika.lookup(code)
                    assert caught.value.part == part.name, code
                    assert part.values[0].text in str(caught.value)
                    assert caught.value.label == code
                    assert set(caught.value.nearest) <= set(module.VARIANTS)
                    assert len(caught.value.nearest) == 3
                    assert caught.value.nearest[0] in str(caught.value)


def order_code_with(device: Device, parts: Mapping[str, str]) -> str:
    """Return the order code with these texts in its parts."""
    return re.sub(r"\{(\w+)\}", lambda brace: parts[brace[1]], device.order_code.pattern)


@pytest.mark.slow
def test_labels_are_read_as_the_model_reads_them(lika: Any, devices: Mapping[str, Device]) -> None:
    """Return every combination of listed and open values, with allowed suffixes."""
    for device in devices.values():
        module = getattr(lika, device.name)
        labels = []
        for variant in device.variants:
            for part in device.order_code.parts:
                texts = [value.text for value in part.values] + (["9", "17", "8192", "x"] if part.open else ["x"])
                labels += [order_code_with(device, {**variant.parts, part.name: text}) for text in texts]
        for label in [text + tail for text in dict.fromkeys(labels) for tail in ("", "-R2", "/S1", "-X/S77")]:
            try:
                match = find_code(device, label)
            except UnknownOrderCode:
                with pytest.raises(lika.OrderCodeError):
                    module.lookup(label)
                continue
            encoder = module.lookup(label)
            assert (encoder.code, encoder.unlisted, encoder.tail, encoder.special) == (
                match.variant.code,
                match.unlisted,
                match.tail,
                match.special,
            ), label
            assert encoder.parts == tuple(match.variant.parts.values())
            assert encoder.interface.value == match.variant.interface
            assert encoder.written_as_in == match.written_as_in == ""


@pytest.mark.parametrize(
    ("label", "code"),
    [
        ("AM3616/4096SC1", "AM3616/4096-I7"),
        ("AMC3619/4096-SC1-x", "AMC3619/4096-I7"),
        ("am3616/4096bg2", "AM3616/4096-BG"),
        ("AM3620/4096SC1", "AM3620/4096-I7"),
    ],
)
def test_labels_of_edition_1_1(lika: Any, label: str, code: str) -> None:
    """AM36 manual, edition 1.1 p.21: AMx36xx/4096SCx-...

    The code belongs to edition 1.0, and the label says where this spelling is used.
    """
    encoder = lika.lookup(label)
    assert encoder.code == code
    assert "edition 1.1" in encoder.written_as_in
    assert code not in lika.am36.VARIANTS or encoder == lika.am36.VARIANTS[code]
    assert lika.am36.lookup(code).written_as_in == ""


def test_blanks_of_a_label_mean_nothing(lika: Any) -> None:
    assert lika.lookup("SMA21 -BG1-0050") == lika.sma21.VARIANTS["SMA21-BG1-0050"]


@pytest.mark.parametrize(
    ("label", "part", "words"),
    [
        ("AM3617/4096-GG", "singleturn", "has singleturn '17' and output 'GG', which cannot be combined"),
        (
            "SMA21-JP4-0050",
            "output",
            "has output 'JP' and supply '4', which cannot be combined; similar order codes: SMA21-JP1-0050",
        ),
        (
            "ASC8529/SC1",
            "resolution",
            (
                "'ASC8529/SC1' has resolution '29'; valid values: 20, 21, 22, 23, 24, 25; "
                "similar order codes: ASC8520/SC1"
            ),
        ),
    ],
)
def test_parts_that_do_not_go_together(lika: Any, label: str, part: str, words: str) -> None:
    with pytest.raises(lika.OrderCodeError) as caught:
        lika.lookup(label)
    assert words in str(caught.value)
    assert caught.value.part == part


def test_what_looks_like_a_special_code(lika: Any) -> None:
    encoder = lika.lookup("ASC8525/SC2")
    assert (encoder.code, encoder.special) == ("ASC8525/SC2", False)
    encoder = lika.lookup("asc8525/sc2-x/s12")
    assert (encoder.code, encoder.tail, encoder.special) == ("ASC8525/SC2", "-X", True)


# ------------------------------------------------------------------------------------------------ registers at run time


def test_frames_follow_registers(lika: Any) -> None:
    encoder = lika.lookup("AM3616/4096-I7")
    smaller = encoder.with_registers({0x56: 16, 0x57: 12})
    assert (encoder.used_position_bits, smaller.used_position_bits) == (36, 28)
    assert smaller.with_registers({0x49: 0x00}).used_position_bits == 28
    word = lika.am36.SingleCycleData.from_position(smaller, 0xABCDEF1).encode()
    assert word < 1 << 36
    assert smaller.decode(word).position == 0xABCDEF1
    with pytest.raises(lika.LengthError):
        smaller.decode(lika.am36.SingleCycleData.from_position(encoder, 1 << 35).encode())
    gray = encoder.with_registers({0x49: 0x00})
    assert lika.am36.SingleCycleData.from_position(gray, 3).encode() >> 8 == 2
    assert encoder.with_registers({0x4E: 0x07, 0x4F: 0xD0}).modulus == 2000 << 20
    assert encoder.with_registers({0x4F: 0}).used_revolutions == 65536


def test_an_offset_takes_the_whole_position_field(lika: Any) -> None:
    """F0 00 00h is the highest offset at 50 µm (6.4 p.32).

    The position 123 is then sent as F0 00 7Bh, in all 24 bits of the field.
    """
    encoder = lika.lookup("SMA21-SC1-0050")
    word = 0xF0007BE4
    with pytest.raises(lika.ConstantError, match="padding"):
        encoder.decode(word)
    shifted = encoder.with_registers({0x49: 0x22})
    frame = shifted.decode(word)
    assert (frame.position, frame.error, frame.warning, frame.encode()) == (0xF0007B, False, False, word)
    assert (encoder.highest, shifted.highest, shifted.modulus) == (0xFFFFF, 0xFFFFFF, 0x100000)
    # As many positions as before, starting at the offset. After the highest of them, the count continues.
    assert shifted.unwrap(0xFFFFFF, 0xF00000) == 0x1000000
    assert shifted.unwrap(0xF0007B, 0xF0007A) == 0xF0007A
    with pytest.raises(lika.RangeError):
        encoder.unwrap(0, 0xF00000)
    assert lika.lookup("SMA21-SC1-0001").with_registers({0x49: 0x22}).scd_value_bits == 25
    gray = encoder.with_registers({0x49: 0x02})
    assert gray.decode(lika.sma21.SingleCycleData(gray, 0xF0007B).encode()).position == 0xF0007B


def test_registers_that_cannot_be(lika: Any) -> None:
    encoder = lika.lookup("AM3616/4096-I7")
    with pytest.raises(lika.RangeError, match="0 to 20"):
        encoder.with_registers({0x56: 21})
    message = "register 0x42 does not affect decoding; registers that do: 0x49, 0x4B, 0x4E, 0x56, 0x57"
    with pytest.raises(ValueError, match=message):
        encoder.with_registers({0x42: 0})
    with pytest.raises(ValueError, match="registers that do: none"):
        lika.lookup("AM3616/4096-GG").with_registers({0x56: 16})
    assert not hasattr(lika.lookup("AMM5A21/65KSC1"), "with_registers")


def test_a_register_given_whole(lika: Any) -> None:
    am36 = lika.am36
    as_object = am36.Configuration(am36.EnablePreset.ENABLE, am36.OutputCode.BINARY, am36.CountingDirection.CCW)
    by_name = am36.Configuration(
        enable_preset=am36.EnablePreset.ENABLE,
        output_code=am36.OutputCode.BINARY,
        counting_direction=am36.CountingDirection.CCW,
    )
    assert am36.set_configuration(by_name) == am36.set_configuration(0x60)
    assert isinstance(as_object, am36.Configuration)
    for number in (0x100, -1):
        with pytest.raises(lika.RangeError):
            am36.set_configuration(number)


def test_a_preset_is_below_the_product_of_the_resolution(lika: Any) -> None:
    """Information per revolution x Number of revolutions - 1 (6.5 p.29), with the present or the new values."""
    am36, encoder = lika.am36, lika.lookup("AM3616/4096-I7")
    small = encoder.with_registers({0x4B: 0, 0x4C: 0x10, 0x4D: 0, 0x4E: 0, 0x4F: 10})
    assert (am36.Preset.limits(encoder), am36.Preset.limits(small)) == ((0, (1 << 36) - 1), (0, 40_959))
    assert am36.set_preset(small, 40_959)
    for call in (
        lambda: am36.set_preset(small, 40_960),
        lambda: am36.set_preset(encoder, 1 << 36),
        lambda: am36.Preset(small, 40_960).encode(),
        lambda: am36.set_resolution(encoder, 4096, 10, 40_960),
    ):
        with pytest.raises(lika.RangeError, match="position must be 0 to "):
            call()
    # The new resolution applies to the preset that is written after it, even if the old one is smaller.
    steps = am36.set_resolution(small, 8192, 10, 40_960)
    assert steps[:5] == am36.set_resolution(encoder, 8192, 10, 40_960)[:5]
    written = bytes(step.value for step in steps if isinstance(step, codewheel_runtime.Write))
    assert written[:5] == bytes.fromhex("00 20 00 00 0A")
    assert bytes.fromhex("00 00 00 A0 00") in written[5:]


def test_a_procedure_takes_no_more_than_its_register(lika: Any) -> None:
    """Bits 0, 1, 3, 4 and 7 of AM36's configuration are always 0 (6.5 p.25)."""
    assert lika.am36.set_configuration(0x64)
    for bit in (0, 1, 3, 4, 7):
        with pytest.raises(lika.ConstantError, match="zero_"):
            lika.am36.set_configuration(0x60 | 1 << bit)
        with pytest.raises(lika.ConstantError):
            lika.am36.Configuration.decode(bytes([0x60 | 1 << bit]))


def test_limits_by_meaning(lika: Any) -> None:
    sma21 = lika.sma21
    coarse, fine = lika.lookup("SMA21-SC1-0050"), lika.lookup("SMA21-SC1-0001")
    assert sma21.PresetOffset.preset_limits(coarse) == (0, 0xFFFFF)
    assert sma21.PresetOffset.offset_limits(coarse) == (0, 0xF00000)
    assert sma21.PresetOffset.offset_limits(fine) == (0, 0)
    sma21.set_offset(coarse, 0xF00000)
    for build, variant, value in (
        (sma21.set_offset, coarse, 0xF00001),
        (sma21.set_offset, fine, 1),
        (sma21.set_preset, coarse, 1 << 20),
    ):
        with pytest.raises(lika.RangeError):
            build(variant, value)
    meanings = sma21.REGISTERS["preset_offset"].meanings
    assert [(meaning.name, meaning.min, meaning.max) for meaning in meanings] == [
        ("preset", "0", "2^position_bits - 1"),
        ("offset", "0", "2^scd_position_bits - 2^position_bits"),
    ]


def test_powers_of_two(lika: Any) -> None:
    assert lika.am36.InformationPerRevolution(4096).encode() == b"\x00\x10\x00"
    for number in (1000, 0, 1 << 21):
        with pytest.raises(lika.RangeError):
            lika.am36.InformationPerRevolution(number).encode()


# ----------------------------------------------------------------------------------------------- meanings of counts


def range_of(lika: Any, encoder: Any) -> Any:
    """Return the encoder, or the range of its 24-bit replies if its replies have different ranges."""
    is_wide = (encoder.family.name, encoder.interface.value) == ("sma21", "rs485")
    return encoder.range_of(lika.sma21.PositionReply) if is_wide else encoder


def test_every_position_has_a_meaning(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        for variant in device.variants:
            measurement = device.measurement_of(variant.interface)
            assert measurement is not None
            encoder, parameters = lika.lookup(variant.code), variant.parameters
            if measurement.step_um is not None:
                step = measurement.step_um.value(parameters)
                assert (encoder.micrometres(1), encoder.micrometres(-3), encoder.millimetres(7)) == (
                    step,
                    -3 * step,
                    7 * step / 1000,
                )
                assert measurement.modulus is not None
                assert range_of(lika, encoder).modulus == measurement.modulus.value(parameters)
            else:
                assert measurement.counts_per_turn is not None
                assert measurement.turns is not None
                steps, turns = measurement.counts_per_turn.value(parameters), measurement.turns.value(parameters)
                assert (encoder.counts_per_turn, encoder.modulus) == (steps, steps * turns)
                assert (encoder.turns(0), encoder.turns(steps // 2)) == (0.0, 0.5)
                assert (encoder.degrees(steps // 4), encoder.degrees(steps // 4 * 3)) == (90.0, 270.0)
                assert encoder.degrees(steps - 1) < 360
                if turns > 1:
                    assert (encoder.turns(steps), encoder.degrees(steps + steps // 4)) == (1.0, 90.0)
                for convert in (encoder.turns, encoder.degrees, encoder.radians):
                    with pytest.raises(lika.RangeError):
                        convert(steps * turns)
                    with pytest.raises(lika.RangeError):
                        convert(-1)
                    with pytest.raises(TypeError):
                        convert(True)


def test_counts_go_on_where_the_position_starts_again(lika: Any, devices: Mapping[str, Device]) -> None:
    encoders = [lika.lookup(variant.code) for device in devices.values() for variant in device.variants]
    encoders.append(lika.lookup("AM3616/4096-I7").with_registers({0x4E: 0x07, 0x4F: 0xD0, 0x57: 11}))
    for encoder in [range_of(lika, encoder) for encoder in encoders]:
        size, step = encoder.modulus, encoder.modulus // 2 - 1
        assert step > 0
        for direction in (1, -1):
            count = true = size - 5
            for _ in range(9):
                true += direction * step
                count = encoder.unwrap(count, true % size)
                assert count == true
        for position in (encoder.highest + 1, encoder.lowest - 1):
            with pytest.raises(lika.RangeError):
                encoder.unwrap(0, position)


# ------------------------------------------------------------------------------------------------------- identification


def test_encoders_are_known_by_their_registers(lika: Any, devices: Mapping[str, Device]) -> None:
    """The documented content of an encoder identifies it, and so does anything with the same content."""
    for device in devices.values():
        for variant in device.variants:
            if not any(register.interface == variant.interface for register, _ in device.identity):
                continue
            register_bytes: dict[int, int] = {}
            for register in {register.name: register for register, _ in device.identity}.values():
                register_bytes |= enumerate(documented_bytes(register, variant), register.address)
            codes = lika.identify(register_bytes)
            assert variant.code in codes
            assert set(codes) <= {listed.code for listed in device.variants}


def documented_bytes(register: Register, variant: Variant) -> bytes:
    """Return the content of a register that identifies an encoder, with zeros in place of undocumented text."""
    number = 0
    for placed_field in register.layout.place(variant.parameters).fields:
        expected: Any = placed_field.field.equals
        if expected is None:
            expected = "0" * (placed_field.width // 8) if isinstance(placed_field.field.kind, Text) else 0
        elif not isinstance(expected, (int, str)):
            expected = expected.value(variant.parameters)
        if isinstance(expected, str):
            expected = int.from_bytes(expected.encode(), "big")
        number |= expected << placed_field.lowest_bit
    return number.to_bytes(register.length, "little" if register.byte_order == "low_byte_first" else "big")


def test_identification(lika: Any) -> None:
    device_id = b"SM21\x00\x01"
    assert lika.identify({"device_id": device_id, "profile_id": b"\x28\x14"}) == ("SMA21-SC1-0050", "SMA21-SC4-0050")
    assert lika.sma21.identify({0x4D: 1}) == ("SMA21-SC1-0001", "SMA21-SC4-0001")
    assert lika.sma21.identify({0x78: 0x53}) == lika.sma21.identify({})
    assert lika.identify({"manufacturer_id": b"XX"}) == ()
    assert {code[:3] for code in lika.identify({"manufacturer_id": b"Li"})} == {"AMM", "AM3", "AMC", "ASC", "SMA"}
    for contents in ({"device_id": b"SM21"}, {"nonsense": b""}, {0x78: 256}):
        with pytest.raises(ValueError):
            lika.identify(contents)
    with pytest.raises(TypeError):
        lika.identify({"device_id": 5})


# ----------------------------------------------------------------------------------------------------------------- data


def test_registers_encode_what_they_decoded(lika: Any, devices: Mapping[str, Device]) -> None:
    """All bits are preserved, known or not, for every register that accepts any bits, with each of its order codes."""
    assert lika.asc85.ErrorRegister.decode(b"\x97").encode() == b"\x97"
    assert lika.asc85.ErrorRegister.decode(b"\x97").unused == 0x84
    assert lika.amm5.ManufacturerId.decode(b"\xff\xfe") != lika.amm5.ManufacturerId.decode(b"\x80\x81")
    with pytest.raises(lika.RangeError, match="unused must be within the mask 0x84, got 1"):
        lika.asc85.ErrorRegister(unused=1).encode()
    with pytest.raises(lika.RangeError, match="must be 2 Latin-1 characters"):
        lika.amm5.ManufacturerId("\u0100x").encode()
    source, tried = random.Random(7), 0
    for device in devices.values():
        module, names = getattr(lika, device.name), DeviceNames(device).class_name_by_register
        for register in device.registers:
            if register.name not in names:
                continue
            kind = getattr(module, names[register.name])
            takes = "variant" in inspect.signature(kind.decode).parameters
            speakers = [code for code in module.VARIANTS.values() if code.interface.value == register.interface]
            for variant in speakers if takes else [None]:
                data = source.randbytes(register.length)
                try:
                    decoded = kind.decode(data, *([variant] if takes else []))
                    encoded = decoded.encode()
                except lika.FrameError:
                    continue  # There is no such value, or it may not be written.
                assert encoded == data, (register.name, data)
                tried += 1
    assert tried > 50


def test_registers_hold_what_the_spec_says(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        module = getattr(lika, device.name)
        for register in device.registers:
            facts = module.REGISTERS[register.name]
            assert getattr(module.Address, register.name.upper()) == facts.address == register.address
            assert (facts.length, facts.access.value, facts.byte_order.value, facts.default) == (
                register.length,
                register.access,
                register.byte_order,
                register.default_bytes(),
            )
            assert (facts.opened_by, facts.opened_by_field, facts.opened_by_value) == (
                register.opened_by,
                register.opened_by_field,
                register.opened_by_value,
            )
            assert (facts.above_max.value if facts.above_max else "", facts.write_clears, facts.reserved) == (
                register.above_max,
                register.write_clears,
                register.reserved,
            )
            if facts.fields:
                check_fields(facts.fields, register.layout.fields)
        for _, layout in device.layouts():
            check_fields(module.FRAMES[layout.name], layout.fields)


def check_fields(facts_of_fields: Any, fields: Any) -> None:
    assert [facts.name for facts in facts_of_fields] == [field.name for field in fields]
    for facts, field in zip(facts_of_fields, fields, strict=True):
        for name in (
            "meaning",
            "unit",
            "implemented",
            "reserved",
            "explained_by",
            "default",
            "names",
            "printed_name",
        ):
            assert getattr(facts, name) == getattr(field, name), (field.name, name)
        for name in ("signed", "zero_means", "power_of_two"):
            assert getattr(facts, name) == getattr(field.number, name), (field.name, name)


def test_facts_hold_what_the_spec_says(lika: Any, devices: Mapping[str, Device]) -> None:
    tables = ("alarms", "timings", "connectors", "leds", "characteristics", "errata", "inputs", "tables")
    for device in devices.values():
        module = getattr(lika, device.name)
        for table in tables:
            names = [facts.name for facts in getattr(module, table.upper(), ())]
            assert names == [member.name for member in getattr(device, table)], (device.name, table)
        contents = [figure.content for figure in getattr(module, "LOST_FIGURES", ())]
        assert contents == [figure.content for figure in device.lost_figures]
        for facts, alarm in zip(module.ALARMS, device.alarms, strict=True):
            assert (facts.register, facts.field, facts.implemented) == (alarm.register, alarm.field, alarm.implemented)
        biss = device.find_interface(Biss)
        if biss is not None and biss.timeout is not None:
            printed = biss.timeout.printed
            assert module.BISS.timeout.printed == tuple((timeout.clock_hz, timeout.timeout_ns) for timeout in printed)
            for timeout in printed:
                assert module.BISS.timeout.nanoseconds(timeout.clock_hz) == timeout.timeout_ns


def test_bit_fields_are_those_of_the_model(lika: Any, devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        module, names = getattr(lika, device.name), DeviceNames(device)
        for variant in device.variants:
            frames = device.interface(variant.interface).layouts
            views = [(frame, names.class_name_by_frame[frame.name]) for frame in frames]
            registers = [register for register in device.registers if register.interface == variant.interface]
            views += [(register.layout, names.class_name_by_register[register.name]) for register in registers]
            for layout, name in views:
                view = getattr(module, name)
                if not hasattr(view, "bit_fields"):
                    continue
                extra_arguments = [module.VARIANTS[variant.code]] if "variant" in view._fields else []
                # The model uses the first answer to an open question.
                kinds = [getattr(module, alternative.enum_name) for alternative in names.questions_of(layout)]
                extra_arguments += [next(iter(kind)) for kind in kinds]
                bit_fields = [field for field in view.bit_fields(*extra_arguments) if field.width]
                placed_fields = layout.place(variant.parameters).fields
                assert {field.name: (field.low, field.width) for field in bit_fields} == {
                    field.name: (field.lowest_bit, field.width) for field in placed_fields
                }
