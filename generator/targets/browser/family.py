"""Data of a family for the script: order codes, CRCs, frames and registers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...model import Alternative, Answer, Crc, Device, Interface, Variant
from ...model.layout import have_lengths
from ...plan.crcs import Carrier, carriers
from ...plan.frames import Dispatch, dispatches
from ...plan.reports import reportings
from ...plan.run_time_parameters import HeldParameter, held_parameters
from ...say.evidence import grade
from ...say.origin import origin
from ...say.place import field_at
from ...say.text import BY_NAME
from ...why import in_bits, in_bytes
from .labels import labels
from .layouts import frame, register
from .plain import Data, Pool, bound, expression, number, without_empty


def family(device: Device) -> Data:
    """Return all data of a family for the script."""
    parameter_names = [parameter.name for parameter in device.parameters if parameter.equals is None]
    names, shared = [interface.name for interface in device.interfaces], Pool()
    return without_empty(
        name=device.name,
        title=device.title,
        base=device.base,
        special=next((overlay.special for overlay in device.overlays if overlay.special), ""),
        special_codes=device.order_code.special,
        about=[BY_NAME.sentence(fact) for fact in origin(device)],
        evidence=BY_NAME.sentence(grade(device)),
        given=parameter_names,
        derived=[[name, expression(value)] for name, value in device.definitions.items()],
        held=[_held(device, parameter) for register in held_parameters(device) for parameter in register.parameters],
        alternatives=[_alternative(alternative) for alternative in device.alternatives],
        crcs={crc.name: _crc(device, crc) for crc in device.crcs},
        interfaces=[_interface(device, interface, shared) for interface in device.interfaces],
        shared=shared.items,
        labels=labels(device),
        codes=[_code_row(variant, names, parameter_names) for variant in device.variants],
    )


def _code_row(variant: Variant, interface_names: Sequence[str], parameter_names: Sequence[str]) -> list[Any]:
    """Return an order code, the index of its interface, and the values of its parameters."""
    values = (number(variant.parameters[name]) for name in parameter_names)
    return [variant.code, interface_names.index(variant.interface), *values]


def _held(device: Device, register_parameter: HeldParameter) -> Data:
    """Return a parameter that is held in a register, with its limits."""
    parameter = register_parameter.parameter
    at = field_at(device, parameter.read_from)
    values = sorted({row.value for row in parameter.by_code})
    return without_empty(
        name=parameter.name, meaning=parameter.meaning, at=at, min=parameter.min, max=parameter.max, values=values
    )


def _alternative(alternative: Alternative) -> Data:
    answers = [*map(_answer, alternative.answers)]
    return without_empty(
        name=alternative.name, meaning=alternative.meaning, answers=answers, default=alternative.default
    )


def _answer(answer: Answer) -> list[Any]:
    return [answer.name, answer.meaning, {name: number(value) for name, value in answer.sets.items()}]


def _crc(device: Device, crc: Crc) -> Data:
    """Return the parameters of a CRC, and those of similar CRCs that may be used by mistake."""
    for_bytes = Carrier.BYTES in carriers(device, crc)
    similar_crcs = in_bytes.other_crcs(crc) if for_bytes else in_bits.other_crcs(crc)
    return _parameters(crc) | {
        "text": crc.polynomial,
        "others": [[words, _parameters(similar)] for _, words, similar in similar_crcs if similar != crc],
    }


def _parameters(crc: Crc) -> Data:
    return without_empty(
        width=crc.width,
        poly=number(crc.poly),
        init=number(crc.init),
        refin=int(crc.refin),
        refout=int(crc.refout),
        xorout=number(crc.xorout),
    )


def _interface(device: Device, interface: Interface, shared: Pool) -> Data:
    by_frame = {reporting.codec.layout.name: reporting for reporting in reportings(device)}
    registers = device.registers_over(interface.name)
    return without_empty(
        name=interface.name,
        title=interface.title,
        measure=_position_unit(device, interface),
        exact=[sender for sender in ("encoder", "master") if have_lengths(interface.layouts, sender)],
        frames=[shared.parts(frame(device, layout, by_frame.get(layout.name))) for layout in interface.layouts],
        told=[_dispatch(interface, dispatch) for dispatch in dispatches(interface.layouts)],
        registers=[shared.parts(register(device, memory_register)) for memory_register in registers],
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
        step_um=bound(measurement.step_um),
        step_nm=bound(measurement.step_nm),
        per_counts=bound(measurement.per_counts),
        counts_per_turn=bound(measurement.counts_per_turn),
        turns=bound(measurement.turns),
    )


def _dispatch(interface: Interface, dispatch: Dispatch) -> Data:
    """Return the pieces of bytes that form the selector of a sender's frames, and the frames keyed by its value."""
    places = {layout.name: place for place, layout in enumerate(interface.layouts)}
    return without_empty(
        sender=dispatch.sender,
        selector=dispatch.selector.name,
        pieces=[[piece.byte, piece.right, piece.mask, piece.left] for piece in dispatch.bits.pieces],
        needs=dispatch.needs,
        frames=[[places[branch.layout.name], *map(number, branch.values)] for branch in dispatch.branches],
    ) | {"fallback": places[dispatch.fallback.name] if dispatch.fallback is not None else -1}
