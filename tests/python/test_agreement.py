"""The generated package against the model's codec: every order code of every family, valid and damaged frames."""

from __future__ import annotations

import dataclasses
import inspect
import itertools
import random
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codewheel.loading.library import load_library
from codewheel.model import (
    Choice,
    Constant,
    CrcValue,
    Decimal,
    Device,
    Field,
    Flag,
    Layout,
    Parity,
    PlacedLayout,
    Register,
    Text,
    Variant,
    Write,
    number_from_bytes,
    number_to_bytes,
)
from codewheel.model.registers import name_with_limits, value_bounds
from codewheel.order_codes.parameters import with_answers, with_registers
from codewheel.reference.bits_and_values import compute, join_value
from codewheel.reference.codec import EncodeError, decode, decode_bytes, encode
from codewheel.reference.findings import DecodedFrame, findings
from codewheel.reference.registers import register_writes
from codewheel.targets import Library
from codewheel.targets.python.names import CLASS_NAMES, DeviceNames, python_name
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow

KINDS = {"LengthError": "length", "CrcError": "crc", "ConstantError": "constant", "RangeError": "range"}
ROUNDS = 12

TESTS = Path(__file__).resolve().parents[1]
SPECS = TESTS.parent / "specs"
#: Families in ``generated/``. Each has a second reading.
FAMILIES = sorted(path.name.removesuffix(".second.yaml") for path in SPECS.glob("*/*.second.yaml"))
#: Specs with features that no device has.
MADE_UP = {"words": TESTS / "specs", "odd_shapes": TESTS / "python" / "specs", "shapes": TESTS / "c" / "specs"}
MADE_UP |= dict.fromkeys(
    (
        "banks",
        "byte_orders",
        "gray",
        "gray_excess",
        "gray_parity",
        "lowfirst",
        "modbus",
        "ring",
        "ring_split",
        "ring_turns",
        "scale",
        "signs",
        "switched",
        "wide",
        "long",
        "long_crc",
    ),
    TESTS / "specs",
)
MADE_UP |= {"as5047p": TESTS.parent / "specs" / "ams"}
MADE_UP |= {"amt21": TESTS.parent / "specs" / "cui"}
MADE_UP |= {"skm36": TESTS.parent / "specs" / "sick"}
ALL = [*FAMILIES, *MADE_UP]
#: Families whose tests ``make test`` runs. ``make verify`` runs the tests of the other families.
REPRESENTATIVES = ("amm5", "as5047p", "long_crc", "odd_shapes", "shapes", "signs", "switched")
CASES_OF_FAMILIES = mostly_exhaustive(ALL, *REPRESENTATIVES)


@dataclasses.dataclass(frozen=True)
class Family:
    """A family in the model and in the generated module."""

    device: Device
    module: Any

    @cached_property
    def names(self) -> DeviceNames:
        return DeviceNames(self.device)

    def view(self, layout: Layout, register: Register | None) -> Any:
        name = (
            self.names.class_name_by_frame[layout.name]
            if register is None
            else self.names.class_name_by_register[register.name]
        )
        return getattr(self.module, name)


@dataclasses.dataclass(frozen=True)
class Case:
    """One layout of one order code, with the present values of its registers."""

    family: Family
    variant: Variant
    encoder: Any
    layout: Layout
    register: Register | None
    placed: PlacedLayout
    answers: tuple[Any, ...] = ()

    @property
    def view(self) -> Any:
        return self.family.view(self.layout, self.register)

    def carried(self, number: int) -> Any:
        """Return the frame as it is on the line or in a register."""
        if self.layout.carried_as == "bytes":
            return number_to_bytes(self.layout, number, self.placed.bits)
        return number


#: Filled once in a process. Each module that imports the fixture has a fixture of its own.
_FAMILIES_BY_NAME: dict[str, Family] = {}


@pytest.fixture(scope="session")
def families(
    packages: Mapping[str, ModuleType],
    library: Library,
    import_generated: Callable[[Library, str], tuple[Path, ModuleType]],
) -> dict[str, Family]:
    families_by_name = _FAMILIES_BY_NAME
    if families_by_name:
        return families_by_name
    for device in library.devices:
        families_by_name[device.name] = Family(device, getattr(packages[device.name], device.name))
    for name, folder in MADE_UP.items():
        loaded_devices, report = load_library([folder / f"{name}.yaml", folder / "manufacturer.yaml"])
        assert not report, "\n".join(problem.format() for problem in report.problems)
        device = next(candidate for candidate in loaded_devices if candidate.name == name)
        # The package has a name of its own, because its modules find each other by their names.
        maker = dataclasses.replace(device.manufacturer, python_package=f"{name}_encoders")
        device = dataclasses.replace(device, manufacturer=maker)
        package: Any = import_generated(Library((device,)), maker.python_package)[1]
        families_by_name[name] = Family(device, getattr(package, name))
    return families_by_name


@pytest.fixture
def family(request: pytest.FixtureRequest, families: dict[str, Family]) -> Family:
    return families[request.param]


def states(family: Family, variant: Variant) -> Iterator[tuple[Variant, Any]]:
    """Return the order code with its defaults, and with its run-time parameters at and between their bounds."""
    device, encoder = family.device, family.module.VARIANTS[variant.code]
    yield variant, encoder
    source = random.Random(variant.code)
    registers = [register.name for register in device.registers if register.interface == variant.interface]
    parameters = [parameter for parameter in device.run_time_parameters if parameter.register in registers]
    for kind in ("min", "max", "random", "random", "random") if parameters else ():
        register_bytes: dict[int, int] = {}
        for parameter in parameters:
            register = device.register(parameter.register)
            number = number_with_parameter(register, parameter, kind, source)
            data = number_to_bytes(register.layout, number, 8 * register.length)
            register_bytes |= {register.address + index: byte for index, byte in enumerate(data)}
        changed_variant = with_registers(device, variant, register_bytes)
        changed_encoder = encoder.with_registers(register_bytes)
        for changed_parameter in device.parameters:
            if not changed_parameter.alternative and changed_parameter.interface in ("", variant.interface):
                package_value = getattr(changed_encoder, python_name(changed_parameter.name, ("class",)))
                assert package_value == changed_variant.parameters[changed_parameter.name]
        yield changed_variant, changed_encoder


def number_with_parameter(register: Register, parameter: Any, kind: str, source: random.Random) -> int:
    """Return the content of a register whose field has the lowest, the highest or any value of a parameter."""
    field = register.layout.field(parameter.field)
    mask = (1 << field.widest) - 1
    lowest, highest = parameter.min or 0, parameter.max if parameter.max is not None else mask
    value = {"min": lowest, "max": highest}.get(kind, source.randint(lowest, highest))
    field_bits = value if value != field.number.zero_means else 0
    if parameter.by_code:
        matching_codes = [named.code for named in parameter.by_code if named.value == value or kind == "random"]
        field_bits = matching_codes[0]
    lowest_bit = field.low.constant
    return (register.default or 0) & ~(mask << lowest_bit) | field_bits << lowest_bit


def cases(family: Family) -> Iterator[Case]:
    """Return every layout of every order code, without registers that have the same places as an earlier register."""
    compared_keys = set()
    for variant in family.device.variants:
        for state, encoder in states(family, variant):
            frames = family.device.interface(variant.interface).layouts
            layouts: list[tuple[Layout, Register | None]] = [(frame, None) for frame in frames]
            registers = [register for register in family.device.registers if register.interface == variant.interface]
            layouts += [(register.layout, register) for register in registers]
            for layout, register, decided_state, answers in _with_answers(family, state, layouts):
                placed = layout.place(decided_state.parameters)
                key = (
                    layout.name,
                    variant.code if register is None else "",
                    variant.interface,
                    placed.bits,
                    placed.gray,
                    tuple(
                        (placed_field.name, placed_field.lowest_bit, placed_field.width)
                        for placed_field in placed.fields
                    ),
                )
                if key not in compared_keys:
                    compared_keys.add(key)
                    yield Case(family, decided_state, encoder, layout, register, placed, answers)


def _with_answers(
    family: Family, state: Variant, layouts: list[tuple[Layout, Register | None]]
) -> Iterator[tuple[Layout, Register | None, Variant, tuple[Any, ...]]]:
    """Return each layout with each answer to its open questions."""
    for layout, register in layouts:
        alternatives = family.device.alternatives_of(layout)
        for answers in itertools.product(*(alternative.answers for alternative in alternatives)):
            names = [alternative.name for alternative in alternatives]
            answer_names = [answer.name for answer in answers]
            kinds = [getattr(family.module, family.names.question_by_name[name].enum_name) for name in names]
            members = [kind[name.upper()] for kind, name in zip(kinds, answer_names, strict=True)]
            decided_state = with_answers(family.device, state, dict(zip(names, answer_names, strict=True)))
            yield layout, register, decided_state, tuple(members)


def value_of(case: Case, field: Field, width: int, kind: str, source: random.Random) -> int | str | bool:
    """Return a value of this kind that the field can have."""
    if field.name == case.layout.selector:
        return source.choice(case.layout.selects)
    if isinstance(field.kind, Flag):
        return {"zero": False, "ones": True}.get(kind, source.random() < 0.5)
    if isinstance(field.kind, Choice):
        return source.choice(field.values).value
    if isinstance(field.kind, Text):
        return "".join(chr(source.randrange(0x20, 0x7F)) for _ in range(width // 8))
    return number_of(case, field, width, kind, source)


def number_of(case: Case, field: Field, width: int, kind: str, source: random.Random) -> int:
    """Return a number of this kind between the limits of the field."""
    has_max = case.register is not None and case.register.max is not None
    if field.number.zero_means and kind == "ones" and not has_max:
        return field.number.zero_means
    lowest, largest = limits_of(case, field, width)
    if field.number.power_of_two:
        return 1 << source.randrange(min(width, largest.bit_length()))
    chosen = {
        "zero": lowest,
        "one": 1,
        "ones": -1 if field.number.signed else largest,
        "top": 1 << (width - 1) if width else 0,
    }
    return max(lowest, min(chosen.get(kind, source.randint(lowest, largest)), largest))


def limits_of(case: Case, field: Field, width: int) -> tuple[int, int]:
    register, parameters = case.register, case.variant.parameters
    if register is not None and register.limits_of == field.name:
        minimum, maximum = register.min, register.max
        if minimum is not None and maximum is not None:
            return minimum.value(parameters), maximum.value(parameters)
    valid = case.family.device.range_in(case.layout) if register is None else None
    if valid is not None and valid.name == field.name:
        return valid.lowest.value(parameters), valid.highest.value(parameters)
    lowest, largest = 0, (1 << width) - 1
    if field.number.zero_means:
        lowest, largest = 1, min(largest, field.number.zero_means)
    if field.number.signed:
        lowest, largest = -(1 << (width - 1)), (1 << (width - 1)) - 1
    if isinstance(field.kind, Decimal):
        largest = min(largest, field.kind.limit - 1)
    return lowest, largest


def is_allowed(case: Case, number: int) -> bool:
    """Return True if the limits of the register allow the joined number to which they apply."""
    register = case.register
    if register is None:
        return True
    join = next((join for join in case.layout.joins if join.name == name_with_limits(register)), None)
    if join is None:
        return True
    low, high = value_bounds(register, case.placed, (register.min, register.max), case.variant.parameters)
    return low <= join_value(case.placed, join, number) <= high


def values_of(case: Case, kind: str, source: random.Random) -> dict[str, int | str | bool]:
    values = {}
    for placed_field in case.placed.fields:
        field = placed_field.field
        if field.carries_data:
            values[placed_field.name] = value_of(case, field, placed_field.width, kind, source)
    values |= highest_parts(case, values)
    if case.layout.unused:
        every = unused_bits(case.placed)
        values["unused"] = {"zero": 0, "ones": every}.get(kind, source.getrandbits(64) & every)
    return values


def highest_parts(case: Case, values: Mapping[str, int | str | bool]) -> dict[str, int]:
    """Return the parts of the highest position if the values form one in several fields that is above it."""
    valid = case.family.device.range_in(case.layout) if case.register is None else None
    if valid is None or valid.field is not None:
        return {}
    highest = valid.highest.value(case.placed.parameters)
    parts = {}
    position = 0
    place = sum(part.width for part in case.placed.find_fields([field.name for field in valid.fields]))
    for part in case.placed.find_fields([field.name for field in valid.fields]):
        place -= part.width
        position |= int(values[part.name]) << place
        parts[part.name] = highest >> place & part.mask
    return parts if position > highest else {}


def unused_bits(placed: PlacedLayout) -> int:
    """Return ones for all unused bits of this order code, at their places in ``unused``."""
    masks = {placed_field.name: placed_field.mask for placed_field in placed.fields}
    return sum(masks.get(field.name, 0) << place for field, place in placed.layout.unused)


def arguments_of(case: Case) -> list[Any]:
    """Return the members of a frame that are not fields."""
    return [*([case.encoder] if "variant" in getattr(case.view, "_fields", ()) else []), *case.answers]


def decode_generated(case: Case, number: int) -> Any:
    """Return the decoded object, or the kind of its error as the model calls it."""
    try:
        return case.view.decode(case.carried(number), *arguments_of(case))
    except ValueError as error:
        return KINDS[type(error).__name__]


def report_facts(report: Any) -> tuple[str, str, str]:
    """Return the facts of a report of the package or the model. Printed name and source belong to one frame."""
    return report.meaning, report.remedy, report.makes_position.value if report.makes_position is not None else ""


def compare_reports(family: Family, variant: Variant, expected: DecodedFrame, decoded: Any) -> None:
    """Compare the reports and the verdict of both."""
    assert expected.layout is not None
    layout, expected_findings = expected.layout.layout, findings(family.device, variant, expected)
    if layout.sender == "encoder":
        verdict = getattr(decoded, "verdict", None)
        assert (verdict and verdict.value) == (expected_findings.verdict and expected_findings.verdict.value), decoded
        assert sorted(map(report_facts, decoded.reports)) == sorted(map(report_facts, expected_findings.reports)), (
            decoded
        )
        assert all(family.module.REPORTS[report.name] is report for report in decoded.reports)
    if layout.unused and layout.sender:
        assert not (decoded.unused and decoded.is_as_documented), decoded
        assert decoded._replace(unused=0).is_as_documented == (not expected_findings.differences), decoded


def compare_values(expected: DecodedFrame, decoded: Any, layout: Layout) -> None:
    """Compare the values that both read."""
    if not hasattr(decoded, "_fields"):
        assert decoded.name.lower() == expected.fields[0].value
        return
    fixed = {field.name for field in layout.fields if not field.carries_data}
    for expected_field in expected.fields:
        if expected_field.name in fixed:
            continue
        value = getattr(decoded, python_name(expected_field.name, CLASS_NAMES))
        assert (
            value.name.lower() if hasattr(value, "name") and isinstance(expected_field.value, str) else value
        ) == expected_field.value, expected_field.name


@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_round_trip_of_every_order_code(family: Family) -> None:
    """The package decodes frames of the model to the same values and encodes them again, at and between the bounds."""
    source = random.Random(family.device.name)
    for case in cases(family):
        for kind in ["zero", "one", "ones", "top", *["random"] * ROUNDS]:
            number = encode(family.device, case.placed, values_of(case, kind, source))
            if not is_allowed(case, number):
                continue
            data = case.carried(number)
            decoded = decode_generated(case, number)
            assert not isinstance(decoded, str), (case.variant.code, case.layout.name, kind, decoded)
            assert decoded.encode() == data, (case.variant.code, case.layout.name, kind)
            expected = decode(family.device, case.placed, number)
            compare_values(expected, decoded, case.layout)
            compare_reports(family, case.variant, expected, decoded)
            for join in case.layout.joins:
                joined_names = (*join.fields, "variant")
                extra_values = [getattr(decoded, name) for name in decoded._fields if name not in joined_names]
                extra_values = [value for value in extra_values if value not in case.answers]
                again = getattr(case.view, f"from_{join.name}")(
                    *arguments_of(case), getattr(decoded, join.name), *extra_values
                )
                assert again == decoded


@pytest.mark.one_in(2, "exhaustive")
@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_faults_are_told_as_the_model_tells_them(family: Family) -> None:
    source = random.Random(family.device.name)
    faults_of_frames, possible = set(), set()
    for case in cases(family):
        kinds = {type(field.kind) for field in case.layout.fields}
        if CrcValue in kinds:
            possible.add("crc")
        if kinds & {Constant, Parity}:
            possible.add("constant")
        if case.layout.carried_as == "bits":
            possible.add("length")
        for number in damaged_frames(case, source):
            expected = decode(family.device, case.placed, number)
            if number >> case.placed.bits and case.layout.carried_as == "bytes":
                continue
            decoded = decode_generated(case, number)
            if expected.problems:
                faults_of_frames.add(expected.problems[0].fault.value)
                assert decoded == expected.problems[0].fault.value, (case.variant.code, case.layout.name, hex(number))
            else:
                assert not isinstance(decoded, str), (case.variant.code, case.layout.name, hex(number), decoded)
                compare_values(expected, decoded, case.layout)
                compare_reports(family, case.variant, expected, decoded)
    assert faults_of_frames >= possible


def test_an_encoder_whose_family_sends_bytes_alone(import_generated: Callable[..., Any]) -> None:
    folder = Path(__file__).parents[1] / "check" / "ok_model"
    devices, report = load_library([folder / "plain_bytes.yaml", folder / "manufacturer.yaml"])
    assert not report
    variant, package = devices[0].variants[0], import_generated(Library(devices), "acme_encoders")[1]
    placed = devices[0].layout("reply_first").place(variant.parameters)
    number = encode(devices[0], placed, {"position": 4711})
    reply = package.lookup(variant.code).decode(number_to_bytes(placed.layout, number, placed.bits))
    assert reply.position == 4711


def damaged_frames(case: Case, source: random.Random) -> Iterator[int]:
    """Frames with changed bits, some with a CRC that matches the change, and random numbers."""
    device, placed = case.family.device, case.placed
    sound = encode(device, placed, values_of(case, "random", source))
    crc = placed.crc_field
    yield sound
    yield sound | 1 << placed.bits
    for bit in range(placed.bits):
        yield sound ^ 1 << bit
        if crc is not None:
            yield with_matching_crc(device, placed, sound ^ 1 << bit)
    for _ in range(4 * ROUNDS):
        number = source.getrandbits(placed.bits)
        yield number
        if crc is not None:
            yield with_matching_crc(device, placed, number)


def with_matching_crc(device: Device, placed: PlacedLayout, number: int) -> int:
    crc_field, crc = placed.crc_field, device.crc_of(placed)
    assert crc_field is not None
    assert crc is not None
    cleared = number & ~(crc_field.mask << crc_field.lowest_bit)
    return cleared | compute(crc, placed, cleared) << crc_field.lowest_bit


def has_selector(device: Device, variant: Variant) -> bool:
    """Return whether the frames of an order code have a field that selects their kind."""
    return bool(device.interface(variant.interface).layouts[0].selector)


def byte_frames(family: Family, layouts: tuple[Layout, ...], source: random.Random) -> list[bytes]:
    """Return random bytes of many lengths and with every control field, also with a correct CRC at their end."""
    frames = [source.randbytes(source.randrange(13)) for _ in range(1000)]
    for control in range(256):
        frames += [bytes([control]) + source.randbytes(length) for length in range(12)]
    crc = next(crc for layout in layouts for crc in family.device.crcs_of(layout))
    size, compute = crc.width // 8, getattr(family.module, f"crc_{crc.name}")
    order: Any = "little" if layouts[0].byte_order == "low_byte_first" else "big"
    bodies = [frame[:-size] for frame in frames if len(frame) > size]
    return frames + [body + compute(body).to_bytes(size, order) for body in bodies]


def first_answers(family: Family) -> dict[str, Any]:
    """Return the first answer to each open question, which the model uses."""
    answers = {}
    for alternative in family.names.question_by_name.values():
        kind = getattr(family.module, alternative.enum_name)
        answers[alternative.name] = kind[alternative.alternative.answers[0].name.upper()]
    return answers


def decoder(family: Family, name: str) -> Callable[..., Any]:
    """Return a function of the module with the first answers to the open questions that it takes."""
    decode = getattr(family.module, name)
    parameters = inspect.signature(decode).parameters
    return partial(decode, **{key: answer for key, answer in first_answers(family).items() if key in parameters})


@pytest.mark.one_in(4, "exhaustive")
@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_any_bytes_are_told_as_the_model_tells_them(family: Family) -> None:
    source = random.Random(5)
    device = family.device
    variants = [variant for variant in device.variants if has_selector(device, variant)]
    for variant in variants[:2]:
        frames = byte_frames(family, device.interface(variant.interface).layouts, source)
        for sender, name in (("encoder", "decode_reply"), ("master", "decode_request")):
            decode = decoder(family, name)
            for frame in frames:
                expected = decode_bytes(device, variant, sender, frame)
                try:
                    decoded = decode(frame, family.module.VARIANTS[variant.code])
                except ValueError as error:
                    assert expected.problems, frame.hex(" ")
                    assert KINDS[type(error).__name__] == expected.problems[0].fault.value, frame.hex(" ")
                else:
                    assert not expected.problems, frame.hex(" ")
                    assert expected.layout is not None, frame.hex(" ")
                    compare_values(expected, decoded, expected.layout.layout)
                    compare_reports(family, variant, expected, decoded)


@pytest.mark.parametrize("family", CASES_OF_FAMILIES, indirect=True)
def test_procedures_write_what_they_write_on_paper(family: Family) -> None:
    """Arguments at their limits and beyond."""
    source = random.Random(family.device.name)
    for procedure in family.device.procedures:
        build = getattr(family.module, family.names.function_name_by_procedure[procedure.name])
        variants = [variant for variant in family.device.variants if variant.interface == procedure.interface]
        for variant in variants:
            takes_variant = build.__code__.co_varnames[:1] == ("variant",)
            first_arguments = [family.module.VARIANTS[variant.code]] if takes_variant else []
            for _ in range(12 if procedure.arguments else 1):
                names = [argument.name for argument in procedure.arguments]
                arguments = {name: 1 << source.randrange(25) | source.choice((0, 0, 1)) for name in names}
                try:
                    expected = register_writes(family.device, procedure, variant, arguments)
                except EncodeError:
                    with pytest.raises(ValueError):
                        build(*first_arguments, *arguments.values())
                    continue
                writes = writes_on_paper(family.device, build(*first_arguments, *arguments.values()))
                assert writes == expected, (procedure.name, variant.code, arguments)


def writes_on_paper(device: Device, steps: Any) -> tuple[Write, ...]:
    """Return the writes of generated steps. A register that is read first has its default or the written value."""
    register_bytes: dict[int, int] = {}
    for register in device.registers:
        register_bytes |= enumerate(register.default_bytes() or bytes(register.length), register.address)
    writes = []
    for step in steps:
        kind = type(step).__name__
        if kind == "Write":
            writes.append(Write(step.address, step.value))
        elif kind == "Modify":
            register = device.register(step.register)
            data = bytes(register_bytes[step.address + index] for index in range(step.length))
            number = number_from_bytes(register.layout, data) & ~step.mask | step.value
            changed = number_to_bytes(register.layout, number, 8 * step.length)
            writes += [Write(address, byte) for address, byte in enumerate(changed, step.address)]
        register_bytes |= {write.address: write.value for write in writes}
    return tuple(writes)


def test_a_field_that_the_order_code_does_not_have(families: dict[str, Family]) -> None:
    """Zero is the content of such a field. The model and the package refuse anything else."""
    family = families["amm5"]
    variant = family.device.variant("AMM5A21/1SC1")
    placed = family.device.layout("single_cycle_data").place(variant.parameters)
    values = {"singleturn": 5, "error": False, "warning": False}
    frame = family.module.SingleCycleData(family.module.VARIANTS[variant.code], 0, 5)
    assert (
        encode(family.device, placed, values)
        == encode(family.device, placed, {**values, "multiturn": 0})
        == frame.encode()
    )
    with pytest.raises(EncodeError, match="multiturn 1 does not fit: this order code has no such field"):
        encode(family.device, placed, {**values, "multiturn": 1})
    with pytest.raises(ValueError):
        frame._replace(multiturn=1).encode()


def test_error_warning_and_crc_are_told_apart(families: dict[str, Family]) -> None:
    amm5 = families["amm5"].module
    variant = amm5.lookup("AMM5A21/65KSC1")
    for error in (False, True):
        for warning in (False, True):
            word = amm5.SingleCycleData.from_position(variant, 123456, error=error, warning=warning).encode()
            frame = variant.decode(word)
            assert (frame.position, frame.error, frame.warning) == (123456, error, warning)
            with pytest.raises(ValueError) as caught:
                variant.decode(word ^ 0x80)
            assert type(caught.value).__name__ == "CrcError"
            error_of_crc: Any = caught.value
            assert error_of_crc.received == word & 0x3F != error_of_crc.computed


def test_steps_of_every_kind(families: dict[str, Family]) -> None:
    module = families["words"].module
    steps = module.import_(limit=1000, bank=2)
    assert [type(step).__name__ for step in steps] == ["Read", "Modify", "Write", "Write", "Write", "Poll", "Wait"]
    assert (steps[1].mask, steps[1].value) == (0x06, 0x02)
    assert bytes(step.value for step in steps[2:5]) == b"\x03\xe8\x02"
    with pytest.raises(ValueError, match="10 to 1000"):
        module.import_(limit=1001, bank=0)


def test_values_that_only_some_encoders_have(families: dict[str, Family]) -> None:
    module = families["words"].module
    variant = module.lookup("w99sc")
    assert (variant.code, variant.unlisted, variant.position_bits, variant.class_) == ("W99SC", ("resolution",), 20, 3)
    assert variant.micrometres(7) == 350
    assert module.Scale.decode(bytes(2) + b"\x00\x01") == module.Scale(65536, 1)
    for unencodable in (
        module.Scale(0, 1),
        module.Scale(65537, 1),
        module.Scale(1, 3),
        module.Offset(1 << 47),
        module.Offset(-(1 << 47) - 1),
    ):
        with pytest.raises(ValueError):
            unencodable.encode()
    assert module.Offset(-1).encode() == b"\xff" * 6
    assert module.Profile(variant, 10260).is_as_documented
    assert module.BISS.timeout.nanoseconds(1) == 16000
