"""Rules for RS-485 requests and for procedures that need the built device: control bytes, constants and limits."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import DocumentReport, Path, quoted
from ..model import (
    Argument,
    Constant,
    DataId,
    Device,
    Layout,
    ModifyStep,
    Parameter,
    Procedure,
    Rs485,
    Step,
    Variant,
    WriteStep,
    number_to_bytes,
)
from ..reference.codec import EncodeError, encode
from .valid_parts import valid_parts_so_far


def check_control_bytes(device: Device, report: DocumentReport) -> None:
    """Check that the control byte that the manual gives for each data ID matches the fields of its request."""
    interface = device.find_interface(Rs485)
    if interface is None or not valid_parts_so_far(report).has_frames:
        return
    variants = device.variants_over(interface.name)
    if not variants:
        return
    for data_id in interface.data_ids:
        path: Path = ("interfaces", interface.name, "data_ids", data_id.name)
        layouts = [layout for layout in interface.layouts if data_id.id in layout.selects]
        if not layouts:
            problem = f"no layout has data ID {data_id.id:X} in its 'when'; add it to one"
            report.add("undefined-reference", path, problem)
            continue
        control_byte = _control_byte(device, layouts[0], data_id, variants[0])
        if control_byte is not None and control_byte != data_id.control:
            problem = f"according to its fields, the control field of data ID {data_id.id:X} is {control_byte:#04x}"
            message = f"{problem}, but it is {data_id.control:#04x} in the manual"
            report.add("control-mismatch", (*path, "control"), message)


def _control_byte(device: Device, layout: Layout, data_id: DataId, variant: Variant) -> int | None:
    """Return the first byte of a frame with a data ID and zeros, or None if such a frame cannot be encoded."""
    placed = layout.place(variant.parameters)
    # All fields are 0, except the selector, which identifies the layout.
    values = {field.name: 0 for field in layout.data_fields} | {layout.selector: data_id.id}
    try:
        frame = encode(device, placed, values)
    except EncodeError:
        return None  # Other rules report the reason.
    return number_to_bytes(layout, frame, placed.bits)[0]


def check_requests(device: Device, report: DocumentReport) -> None:
    """Check that an RS-485 encoder can distinguish its requests: any two must differ in a constant."""
    interface = device.find_interface(Rs485)
    if interface is None or not interface.exchanges or not valid_parts_so_far(report).has_frames:
        return
    layouts = {layout.name: layout for layout in interface.layouts}
    requests = [layouts[exchange.request] for exchange in interface.exchanges if exchange.request in layouts]
    for index, request in enumerate(requests):
        ambiguous_requests = [earlier for earlier in requests[:index] if not _constants_differ(earlier, request)]
        if ambiguous_requests:
            pair = f"'{request.name}' from '{ambiguous_requests[0].name}'"
            problem = f"no constant distinguishes {pair}; add the command as a 'constant' to both"
            report.add("rs485-exchange", ("interfaces", interface.name, "layouts", request.name), problem)


def _constants_differ(layout: Layout, other_layout: Layout) -> bool:
    """Return whether two requests have different constants in the same bit of a byte."""
    constant_bits, other_constant_bits = _constant_bits(layout), _constant_bits(other_layout)
    common_places = constant_bits.keys() & other_constant_bits.keys()
    return any(constant_bits[place] != other_constant_bits[place] for place in common_places)


def _constant_bits(layout: Layout) -> dict[tuple[int, int], int]:
    """Return the constant bits of a layout, by the byte and the bit in it: ``{(0, 7): 1, (0, 6): 0}``."""
    constant_bits = {}
    for field in layout.fields:
        if not isinstance(field.kind, Constant):
            continue
        for bit_slice in field.bit_slices:
            value_in_byte = field.kind.value >> bit_slice.low_in_number
            width_in_byte = bit_slice.mask.bit_length()
            for bit in range(width_in_byte):
                constant_bits[bit_slice.byte, bit_slice.low_in_byte + bit] = (value_in_byte >> bit) & 1
    return constant_bits


def check_limits_in_procedures(device: Device, report: DocumentReport) -> None:
    """Report a step of a procedure that changes the limits of a later argument in a way that generated code ignores.

    Generated code only takes the changed limits into account if the step writes an argument to a whole register. A
    register with problems was not built, so the limits of its arguments are unknown.
    """
    built_registers = {register.name for register in device.registers}
    for procedure in device.procedures:
        for index, step in enumerate(procedure.steps):
            changed_names = {parameter.name for parameter in _parameters_changed(device, step)}
            if not changed_names:
                continue
            for argument in _arguments_written(procedure, procedure.steps[index + 1 :]):
                if argument.of not in built_registers:
                    continue
                limiting_names = _limiting_names(device, argument) & changed_names
                if limiting_names:
                    effect = f"this changes {quoted(min(limiting_names))}, which limits the later argument"
                    remedy = "write an argument to the whole register, or divide the steps into two procedures"
                    message = f"{effect} {quoted(argument.name)}; {remedy}"
                    report.add("limit-changed", ("procedures", procedure.name, "steps", index), message)
                    break


def _limiting_names(device: Device, argument: Argument) -> set[str]:
    """Return the names of the parameters on which the lowest or highest value of an argument depends."""
    limiting_names: set[str] = set()
    for limit in device.limits(device.register(argument.of), argument.meant_as):
        limiting_names.update(limit.parameters if limit is not None else ())
    return limiting_names


def _parameters_changed(device: Device, step: Step) -> Iterator[Parameter]:
    """Yield the parameters that a step changes by writing to their field, or a fixed value to their register.

    A step that writes an argument to a whole register is left out, because generated code takes it into account.
    """
    for parameter in device.run_time_parameters:
        match step:
            case ModifyStep() if (step.register, step.field) == (parameter.register, parameter.field):
                yield parameter
            case WriteStep() if step.register == parameter.register and step.value is not None:
                yield parameter
            case _:
                pass


def _arguments_written(procedure: Procedure, steps: tuple[Step, ...]) -> Iterator[Argument]:
    """Yield the arguments of a procedure that these steps write."""
    arguments = {argument.name: argument for argument in procedure.arguments}
    for step in steps:
        if isinstance(step, WriteStep | ModifyStep) and step.value is None and step.value_name in arguments:
            yield arguments[step.value_name]
