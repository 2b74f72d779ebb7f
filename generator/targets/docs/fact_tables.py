"""Tables of a page about a device, except those of its layouts, as rows of Markdown cells."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ...model import (
    Biss,
    Crc,
    CrcExample,
    Device,
    Document,
    Erratum,
    Example,
    FrameExample,
    Interface,
    Layout,
    MeasureExample,
    Procedure,
    ProcedureExample,
    RegisterExample,
    Scale,
    Timing,
    assert_never,
)
from ...plan.steps import Verifies, run_of
from ...say.crc import sent
from ...say.erratum import changed, errata
from ...say.field import value
from ...say.interface import settings
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.numbers import quantity
from ...say.place import hexadecimal
from ...say.procedure import read_back, step
from ...say.timing import bounds_with_codes
from ...say.words import counted, number
from .layout_tables import named
from .page_links import ERRATA

_SEVERITY = {
    "wrong_data": "wrong bytes or bits on the wire",
    "wrong_limit": "a wrong limit or order code",
    "omission": "missing information",
    "wording": "wording only",
}
SEVERITIES = tuple(_SEVERITY)


def interface_rows(device: Device, interface: Interface) -> Iterator[tuple[str, str, str]]:
    """Yield rows of fact, value, source."""
    for setting in settings(device, interface):
        yield text(setting.label), STYLE.phrase(setting), cited(setting.source)


def step_rows(device: Device, procedure: Procedure) -> Iterator[tuple[str, ...]]:
    """Yield number, instruction, reason, source. A step that exists only in generated code is not numbered."""
    index = 0
    for operation in run_of(device, procedure).operations:
        spec_step = operation.step
        if isinstance(operation, Verifies):
            field = operation.field.name if operation.field is not None else ""
            instruction = STYLE.sentence(read_back(device, operation.register, field))
            yield (
                "",
                instruction,
                "Added to the given steps by generated code, because a corrupted write can look successful.",
                "",
            )
            continue
        index += 1
        source = cited(spec_step.source) if spec_step.source != procedure.source else ""
        yield f"{index}", STYLE.sentence(step(device, spec_step)), text(spec_step.meaning), source


def timing_rows(timings: tuple[Timing, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the name, meaning, duration and source of each time."""
    for timing in timings:
        duration = text(bounds_with_codes(timing))
        yield joined([code(timing.name), text(timing.symbol)]), text(timing.meaning), duration, cited(timing.source)


def crc_rows(device: Device, crc: Crc) -> Iterator[tuple[str, str]]:
    """Yield the parameters, and the polynomial in every notation that masters expect."""
    full = crc.poly_with_top_bit
    yield "Polynomial", text(crc.polynomial)
    yield "with its top bit", f"`0x{full:X}` = {full} = `{full:b}b`"
    yield "without its top bit", f"`0x{crc.poly:02X}`"
    if full & 1:
        yield "without its trailing 1 (Koopman notation)", f"`0x{full >> 1:X}`"
    yield "Width", counted(crc.width, "bit")
    yield "Start value", f"`0x{crc.init:X}`"
    yield "Input, output reflected", f"{_yes(device.reflects_input(crc))}, {_yes(crc.refout)}"
    yield "Final XOR", f"`0x{crc.xorout:X}` ({sent(crc)})"
    if crc.is_xor:
        yield "In short", "XOR of the preceding bytes"


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def example_facts(device: Device, example: Example) -> Iterator[tuple[str, str]]:
    yield from ((fact, content) for fact, content in _worked(device, example) if content)
    if example.erratum and example.erratum not in {
        erratum.name for erratum in errata(device, f"examples.{example.name}", wording=True)
    }:
        yield "Erratum", link(code(example.erratum), f"{ERRATA}#erratum-{example.erratum}")
    if example.note:
        yield "Note", text(example.note)
    yield "Source", cited(example.source)


def _worked(device: Device, example: Example) -> Iterator[tuple[str, str]]:
    """Yield the facts of an example with their values. A value is empty if the example does not have it."""
    match example:
        case FrameExample():
            yield "Frame", link(code(example.layout), f"#layout-{example.layout}") if example.layout else ""
            yield "Order code", code(example.order_code)
            yield "Sent by", f"the {example.sender}"
            for name, answer in example.alternatives.items():
                yield "Alternative", f"{link(code(name), f'#alternative-{name}')} = {code(answer)}"
            yield from (_bytes(example.bytes), ("Bits", code(example.bits)))
            layouts = [layout for _, layout in device.layouts() if layout.name == example.layout]
            yield _values(example.values, layouts)
            yield "Rejected", f"because of its {text(example.refused)}" if example.refused else ""
        case RegisterExample():
            yield "Register", link(code(example.register), f"#register-{example.register}")
            yield from (("Order code", code(example.order_code)), _bytes(example.bytes))
            yield _values(example.values, [device.register(example.register).layout])
        case CrcExample():
            yield "CRC", link(code(example.crc), f"#crc-{example.crc}")
            yield from (_bytes(example.bytes), ("Check value", f"`{hexadecimal(example.check)}`"))
        case ProcedureExample():
            yield "Procedure", link(code(example.procedure), f"#procedure-{example.procedure}")
            yield "Order code", code(example.order_code)
            for name, value in example.arguments.items():
                yield f"Argument {code(name)}", number(value) + (f" ({hexadecimal(value)})" if value > 9 else "")
            yield "Writes", ", ".join(f"`{write.address:02X}h: {write.value:02X}`" for write in example.writes)
        case MeasureExample():
            yield "Order code", code(example.order_code)
            yield "Length", f"{number(example.counts)} counts are {number(example.micrometres)} µm"
        case _:
            assert_never(example)


def _bytes(data: bytes) -> tuple[str, str]:
    return "Bytes", f"`{data.hex(' ').upper()}`" if data else ""


def _values(values: Mapping[str, int | str | bool], layouts: Iterable[Layout]) -> tuple[str, str]:
    scales = {field.name: field.scale for layout in layouts for field in layout.fields}
    return "Values", ", ".join(f"{code(name)} = {_value(value, scales.get(name))}" for name, value in values.items())


def _value(value: int | str | bool, scale: Scale | None) -> str:
    if isinstance(value, bool):
        return _yes(value)
    if not isinstance(value, int):
        return code(value)
    return number(value) + (f" ({text(quantity(scale, value))})" if scale is not None else "")


def printed_and_used(erratum: Erratum) -> Iterator[tuple[str, str]]:
    """Yield the printed text and the value used, or the parts of a change by an overlay or edition."""
    if erratum.overlay:
        yield "Overlay", code(erratum.overlay)
    if erratum.edition:
        yield "Edition", text(erratum.edition)
    parts = (
        changed(erratum)
        if erratum.overlay or erratum.edition
        else (("Printed", erratum.printed), ("Used", erratum.used))
    )
    yield from ((label, text(value)) for label, value in parts)


def changes(number: int) -> str:
    """Return a sentence on the changes by overlays and other editions."""
    return f" {number} more entries are changes made by overlays or other editions." if number else ""


def severity(value: str) -> str:
    return _SEVERITY[value]


def document_rows(documents: Iterable[Document]) -> list[tuple[str, ...]]:
    """Return the key, title and address of each document."""
    return [
        (code(document.key), text(document.title), f"<{document.url}>" if document.url else "")
        for document in documents
    ]


def control_rows(interface: Biss) -> Iterator[tuple[str, ...]]:
    """Yield the name, bits, meaning and source of each field of the BiSS control frame."""
    for control_field in interface.control_data:
        values = [STYLE.phrase(value(named_value, control_field.bits)) for named_value in control_field.values]
        crc = link(code(control_field.crc), f"#crc-{control_field.crc}") if control_field.crc else ""
        yield (
            named(control_field),
            f"{control_field.bits}",
            joined([text(control_field.meaning), crc, *values]),
            cited(control_field.source),
        )
