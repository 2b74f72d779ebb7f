"""Whether the worked examples agree with the model; an example that does not has to be tied to an erratum."""

from __future__ import annotations

from collections.abc import Iterator

from . import codec
from .crc import compute_bytes
from .model import Device, Example, Variant
from .order_codes import UnknownOrderCode, find
from .problems import DocumentReport, Path
from .procedures import register_writes
from .sound import sound_so_far

#: Where in an example, and what is wrong there.
Fault = tuple[Path, str]


def check_examples(device: Device, report: DocumentReport) -> None:
    """Report every example that contradicts its layout, CRC or procedure, where these are sound themselves."""
    known = sound_so_far(report)
    for example in device.examples:
        for below, wrong in _faults(device, example) if known.holds(example) and _is_built(device, example) else ():
            message = f"example '{example.name}' does not hold: {wrong}"
            report.add("example-contradicts", ("examples", example.name, *below), message)


def _is_built(device: Device, example: Example) -> bool:
    """Whether all that the example names is there; what could not be built has been reported."""
    procedure = next((item for item in device.procedures if item.name == example.procedure), None)
    steps = procedure.steps if procedure is not None else ()
    registers = {example.register, *(step.register for step in steps)}
    return (
        (not example.procedure or procedure is not None)
        and registers <= {"", *(register.name for register in device.registers)}
        and example.layout in {"", *(layout.name for _, layout in device.layouts())}
        and {variant.interface for variant in device.variants} <= {interface.kind for interface in device.interfaces}
    )


def _faults(device: Device, example: Example) -> list[Fault]:
    try:
        return list(_check(device, example))
    except UnknownOrderCode as reason:
        return [(("order_code",), str(reason))]
    except codec.EncodeError as reason:
        return [(_data(example), str(reason))]


def example_variant(device: Device, example: Example) -> Variant:
    """The order code that the example holds for; without one, the first of the family."""
    return find(device, example.order_code).variant if example.order_code else device.variants[0]


def _check(device: Device, example: Example) -> Iterator[Fault]:
    if example.kind == "crc":
        made = compute_bytes(device.crc(example.crc), example.bytes)
        if made != example.check:
            yield ("check",), f"the CRC over these bytes is {made:#04x}"
        return
    variant = example_variant(device, example)
    if example.kind == "measure":
        yield from _check_measure(device, example, variant)
    elif example.kind == "register":
        yield from _check_register(device, example, variant)
    elif example.kind == "procedure":
        made_writes = register_writes(device, device.procedure(example.procedure), variant, example.arguments)
        if made_writes != example.writes:
            listed = ", ".join(f"{item.address:02X}h = {item.value:02X}h" for item in made_writes)
            yield ("writes",), f"the writes are {listed}"
    else:
        yield from _check_frame(device, example, variant)


def _check_measure(device: Device, example: Example, variant: Variant) -> Iterator[Fault]:
    measurement = device.measurement_of(variant.interface)
    if measurement is None or measurement.step_um is None or example.counts is None:
        yield (), "the device measures no length"
        return
    made = measurement.step_um.value(variant.parameters) * example.counts
    if made != example.micrometres:
        yield ("micrometres",), f"{example.counts} counts are {made} micrometres"


def _check_register(device: Device, example: Example, variant: Variant) -> Iterator[Fault]:
    register = device.register(example.register)
    if len(example.bytes) != register.length:
        wrong = f"register '{register.name}' has {register.length} bytes; the example has {len(example.bytes)}"
        yield ("bytes",), wrong
        return
    number = codec.number_from_bytes(register.layout, example.bytes)
    yield from _check_decoded(device, codec.decode(device, register.layout.place(variant.parameters), number), example)


def _check_frame(device: Device, example: Example, variant: Variant) -> Iterator[Fault]:
    decoded = decode_example(device, example, variant)
    if example.refused:
        kinds = {problem.kind for problem in decoded.problems}
        if example.refused not in kinds:
            says = ", ".join(sorted(kinds)) or "that all is well"
            yield ("refused",), f"it should be refused for its {example.refused}; the decoder says {says}"
        return
    layout = decoded.layout.name if decoded.layout is not None else example.layout
    if example.layout and layout != example.layout and not decoded.problems:
        yield ("layout",), f"it is a {layout}, not a {example.layout}"
    else:
        yield from _check_decoded(device, decoded, example)


def _check_decoded(device: Device, decoded: codec.Decoded, example: Example) -> Iterator[Fault]:
    """Whether the bits hold no fault and the values that are printed, and come out again when these are encoded."""
    problems = decoded.problems
    if problems and problems[0].kind in ("length", "crc"):  # What is then wrong besides need not be.
        problems = problems[:1]
    found: list[Fault] = [(_data(example), problem.message) for problem in problems] or list(_compare(decoded, example))
    yield from found or _back(device, decoded, example)


def _data(example: Example) -> Path:
    if example.kind == "procedure":
        return ("arguments",)
    return ("bits",) if example.bits else ("bytes",)


def decode_example(device: Device, example: Example, variant: Variant) -> codec.Decoded:
    """What the model makes of the frame of an example."""
    if not example.bits:
        return codec.decode_bytes(device, variant, example.sender, example.bytes)
    placed = device.layout(example.layout).place(variant.parameters)
    if len(example.bits) != placed.bits:
        wrong = f"'{placed.name}' has {placed.bits} bits; this has {len(example.bits)}"
        return codec.Decoded(placed, int(example.bits, 2), (), None, (codec.Problem("length", "", wrong),))
    return codec.decode(device, placed, int(example.bits, 2))


def _compare(decoded: codec.Decoded, example: Example) -> Iterator[Fault]:
    made = decoded.values
    for name, value in example.values.items():
        if name not in made:
            yield ("values", name), f"there is no field '{name}'"
        elif made[name] != value:
            yield ("values", name), f"{name} is {made[name]}, not {value}"


def _back(device: Device, decoded: codec.Decoded, example: Example) -> Iterator[Fault]:
    """Encoding what was decoded gives the example again."""
    if decoded.layout is None:
        return
    joins = {join.name for join in decoded.layout.layout.joins}
    runs = {run.name for field in decoded.layout.layout.fields for run in field.digits}
    fixed = {field.name for field in decoded.layout.layout.fields if not field.carries_data}
    values = {name: value for name, value in decoded.values.items() if name not in joins | runs | fixed}
    made = codec.encode(device, decoded.layout, values)
    if made != decoded.number:
        yield _data(example), f"encoding its fields again gives {made:#x}, not {decoded.number:#x}"
