"""Data of a family for the script: order codes and their grammar, CRCs, frames and registers.

Regular expressions are those of ``order_codes.labels`` in the notation of JavaScript.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...model import Alternative, Answer, CodePart, Crc, Device, Interface, Spelling, Variant
from ...model.layout import have_lengths
from ...order_codes.labels import AFTER, as_listed, regex
from ...plan.crcs import Carrier, carriers
from ...plan.frames import Dispatch, dispatches
from ...plan.registers import HeldParameter, held_parameters
from ...plan.verdicts import reportings
from ...say.evidence import grade, origin
from ...say.names_and_places import field_at
from ...say.text import BY_NAME
from ...why import in_bits, in_bytes
from ...why.recordings import line_name
from .layouts import (
    Data,
    SharedParts,
    expression_data,
    frame_data,
    json_number,
    optional_expression_data,
    register_data,
    without_empty,
)


def label_grammar(device: Device) -> Data:
    """Return the notations of the order codes of a family."""
    order_code = device.order_code
    listed_spelling = as_listed(order_code)
    spellings = (listed_spelling, *order_code.also_written)
    return {
        "pattern": order_code.pattern,
        "written": [_spelling_data(device, spelling) for spelling in spellings],
        "wrong": [_javascript_pattern(regex(order_code, listed_spelling, part.name)) for part in order_code.parts],
        "parts": [_part_data(part) for part in order_code.parts],
    }


def _part_data(part: CodePart) -> Data:
    values = [value.text for value in part.values]
    return without_empty(name=part.name, values=values, only_with=dict(part.open_only_with))


def _spelling_data(device: Device, spelling: Spelling) -> Data:
    values: dict[str, dict[str, str]] = {}
    for value in spelling.values:
        values.setdefault(value.part, {})[value.text.upper()] = value.value
    return without_empty(
        label=_javascript_pattern(regex(device.order_code, spelling)), where=spelling.where, values=values
    )


def _javascript_pattern(expression: str) -> str:
    """Return a regular expression for a whole label in the notation of JavaScript."""
    return javascript_pattern(f"^{expression}{AFTER}$")


def javascript_pattern(expression: str) -> str:
    """Return a regular expression in the notation of JavaScript."""
    return expression.replace("(?P<", "(?<")


def family_data(device: Device) -> Data:
    """Return all data of a family for the script."""
    parameter_names = [parameter.name for parameter in device.parameters if parameter.equals is None]
    interface_names = [interface.name for interface in device.interfaces]
    held = [parameter for register in held_parameters(device) for parameter in register.parameters]
    shared = SharedParts()
    return without_empty(
        name=device.name,
        title=device.title,
        base=device.base,
        special=next((overlay.special for overlay in device.overlays if overlay.special), ""),
        special_codes=device.order_code.special,
        about=[BY_NAME.sentence(fact) for fact in origin(device)],
        evidence=BY_NAME.sentence(grade(device)),
        given=parameter_names,
        derived=[[name, expression_data(value)] for name, value in device.definitions.items()],
        held=[_held_parameter_data(device, parameter) for parameter in held],
        alternatives=[_alternative_data(alternative) for alternative in device.alternatives],
        crcs={crc.name: _crc_data(device, crc) for crc in device.crcs},
        interfaces=[_interface_data(device, interface, shared) for interface in device.interfaces],
        shared=shared.parts,
        labels=label_grammar(device),
        codes=[_order_code_row(variant, interface_names, parameter_names) for variant in device.variants],
    )


def _order_code_row(variant: Variant, interface_names: Sequence[str], parameter_names: Sequence[str]) -> list[Any]:
    """Return an order code, the index of its interface, and the values of its parameters."""
    values = (json_number(variant.parameters[name]) for name in parameter_names)
    return [variant.code, interface_names.index(variant.interface), *values]


def _held_parameter_data(device: Device, register_parameter: HeldParameter) -> Data:
    """Return a parameter that is held in a register, with its limits."""
    parameter = register_parameter.parameter
    return without_empty(
        name=parameter.name,
        meaning=parameter.meaning,
        at=field_at(device, parameter.read_from),
        min=parameter.min,
        max=parameter.max,
        values=sorted({row.value for row in parameter.by_code}),
    )


def _alternative_data(alternative: Alternative) -> Data:
    return without_empty(
        name=alternative.name,
        meaning=alternative.meaning,
        answers=[_answer_data(answer) for answer in alternative.answers],
        default=alternative.default,
    )


def _answer_data(answer: Answer) -> list[Any]:
    return [answer.name, answer.meaning, {name: json_number(value) for name, value in answer.sets.items()}]


def _crc_data(device: Device, crc: Crc) -> Data:
    """Return the parameters of a CRC, and those of similar CRCs that may be used by mistake."""
    is_over_bytes = Carrier.BYTES in carriers(device, crc)
    similar_crcs = in_bytes.other_crcs(crc) if is_over_bytes else in_bits.other_crcs(crc)
    others = [
        [kind, difference, _crc_parameters(similar)] for kind, difference, similar in similar_crcs if similar != crc
    ]
    return _crc_parameters(crc) | {"text": crc.polynomial, "others": others}


def _crc_parameters(crc: Crc) -> Data:
    return without_empty(
        width=crc.width,
        poly=json_number(crc.poly),
        init=json_number(crc.init),
        refin=int(crc.refin),
        refout=int(crc.refout),
        xorout=json_number(crc.xorout),
    )


def _interface_data(device: Device, interface: Interface, shared: SharedParts) -> Data:
    reportings_by_name = {reporting.codec.layout.name: reporting for reporting in reportings(device)}
    frames = [frame_data(device, layout, reportings_by_name.get(layout.name)) for layout in interface.layouts]
    registers = [register_data(device, register) for register in device.registers_over(interface.name)]
    return without_empty(
        name=interface.name,
        title=interface.title,
        line=line_name(interface),
        measure=_position_unit(device, interface),
        exact=[sender for sender in ("encoder", "master") if have_lengths(interface.layouts, sender)],
        frames=list(map(shared.with_indexes, frames)),
        told=[_dispatch_data(interface, dispatch) for dispatch in dispatches(interface.layouts)],
        registers=list(map(shared.with_indexes, registers)),
    )


def _position_unit(device: Device, interface: Interface) -> Data:
    """Return the unit of the position. If the position is not sent as a whole, ``part`` contains the angle."""
    measurement = device.measurement_of(interface.name)
    if measurement is None:
        return {}
    joins = (join for layout in interface.layouts for join in layout.joins if join.name == measurement.of)
    return without_empty(
        of=measurement.of,
        part=next((join.fields[-1] for join in joins), ""),
        step_um=optional_expression_data(measurement.step_um),
        step_nm=optional_expression_data(measurement.step_nm),
        per_counts=optional_expression_data(measurement.per_counts),
        counts_per_turn=optional_expression_data(measurement.counts_per_turn),
        turns=optional_expression_data(measurement.turns),
    )


def _dispatch_data(interface: Interface, dispatch: Dispatch) -> Data:
    """Return the pieces of bytes that form the selector of a sender's frames, and the frames keyed by its value."""
    indexes = {layout.name: index for index, layout in enumerate(interface.layouts)}
    return without_empty(
        sender=dispatch.sender,
        selector=dispatch.selector.name,
        pieces=[[piece.byte, piece.right, piece.mask, piece.left] for piece in dispatch.bits.pieces],
        needs=dispatch.needs,
        frames=[[indexes[branch.layout.name], *map(json_number, branch.values)] for branch in dispatch.branches],
    ) | {"fallback": indexes[dispatch.fallback.name] if dispatch.fallback is not None else -1}
