"""Whether the worked examples agree with the model; an example that does not has to be tied to an erratum."""

from __future__ import annotations

from . import codec
from .crc import compute_bytes
from .model import Device, Example, Variant
from .order_codes import UnknownOrderCode, find
from .problems import DocumentReport
from .procedures import register_writes


def check_examples(device: Device, report: DocumentReport) -> None:
    """Report every example that contradicts its layout, CRC or procedure."""
    for example in device.examples:
        try:
            wrong = _check(device, example)
        except (UnknownOrderCode, codec.EncodeError, StopIteration) as reason:
            wrong = str(reason) or "it refers to something that does not exist"
        if wrong:
            report.add("example-contradicts", ("examples", example.name), f"example '{example.name}' does not hold: {wrong}")


def example_variant(device: Device, example: Example) -> Variant:
    """The order code that the example holds for; without one, the first of the family."""
    return find(device, example.order_code).variant if example.order_code else device.variants[0]


def _check(device: Device, example: Example) -> str:
    if example.kind == "crc":
        made = compute_bytes(device.crc(example.crc), example.bytes)
        return "" if made == example.check else f"the CRC over these bytes is {made:#04x}"
    variant = example_variant(device, example)
    if example.kind == "measure":
        measurement = device.measurement_of(variant.interface)
        if measurement is None or measurement.step_um is None or example.counts is None:
            return "the device measures no length"
        made = measurement.step_um.value(variant.parameters) * example.counts
        return "" if made == example.micrometres else f"{example.counts} counts are {made} micrometres"
    if example.kind == "register":
        return _check_register(device, example, variant)
    if example.kind == "procedure":
        made_writes = register_writes(device, device.procedure(example.procedure), variant, example.arguments)
        if made_writes != example.writes:
            return "the writes are " + ", ".join(f"{item.address:02X}h = {item.value:02X}h" for item in made_writes)
        return ""
    return _check_frame(device, example, variant)


def _check_register(device: Device, example: Example, variant: Variant) -> str:
    register = device.register(example.register)
    if len(example.bytes) != register.length:
        return f"register '{register.name}' has {register.length} bytes; the example has {len(example.bytes)}"
    placed = register.layout.place(variant.parameters)
    decoded = codec.decode(device, placed, codec.number_from_bytes(register.layout, example.bytes))
    if decoded.problems:
        return decoded.problems[0].message
    return _compare(decoded, example) or _back(device, decoded)


def _check_frame(device: Device, example: Example, variant: Variant) -> str:
    decoded = decode_example(device, example, variant)
    if example.refused:
        kinds = {problem.kind for problem in decoded.problems}
        return "" if example.refused in kinds else f"it should be refused for its {example.refused}; the decoder says {', '.join(sorted(kinds)) or 'that all is well'}"
    if decoded.problems:
        return decoded.problems[0].message
    if example.layout and decoded.layout is not None and decoded.layout.name != example.layout:
        return f"it is a {decoded.layout.name}, not a {example.layout}"
    return _compare(decoded, example) or _back(device, decoded)


def decode_example(device: Device, example: Example, variant: Variant) -> codec.Decoded:
    """What the model makes of the frame of an example."""
    if not example.bits:
        return codec.decode_bytes(device, variant, example.sender, example.bytes)
    placed = device.layout(example.layout).place(variant.parameters)
    if len(example.bits) != placed.bits:
        wrong = f"'{placed.name}' has {placed.bits} bits; this has {len(example.bits)}"
        return codec.Decoded(placed, int(example.bits, 2), (), None, (codec.Problem("length", "", wrong),))
    return codec.decode(device, placed, int(example.bits, 2))


def _compare(decoded: codec.Decoded, example: Example) -> str:
    made = decoded.values
    for name, value in example.values.items():
        if name not in made:
            return f"there is no field '{name}'"
        if made[name] != value:
            return f"{name} is {made[name]}, not {value}"
    return ""


def _back(device: Device, decoded: codec.Decoded) -> str:
    """Encoding what was decoded gives the example again."""
    if decoded.layout is None:
        return ""
    joins = {join.name for join in decoded.layout.layout.joins}
    runs = {run.name for field in decoded.layout.layout.fields for run in field.digits}
    fixed = {field.name for field in decoded.layout.layout.fields if not field.carries_data}
    values = {name: value for name, value in decoded.values.items() if name not in joins | runs | fixed}
    made = codec.encode(device, decoded.layout, values)
    return "" if made == decoded.number else f"encoding its fields again gives {made:#x}, not {decoded.number:#x}"
