"""Data of a family for the script: order codes, CRCs, frames and registers."""

from __future__ import annotations

from ...model import Alternative, Crc, Device, Interface
from ...model.layout import have_lengths
from ...plan.crcs import Carrier, carriers
from ...plan.frames import Dispatch, dispatches
from ...plan.reports import reportings
from ...plan.run_time_parameters import Held, held_parameters
from ...say.evidence import grade
from ...say.origin import origin
from ...say.place import field_at
from ...say.text import BY_NAME
from ...why import in_bits, in_bytes
from .labels import labels
from .layouts import frame, register
from .plain import Data, Pool, bound, expression, kept, number


def family(device: Device) -> Data:
    """Return all data of a family for the script."""
    given = [item.name for item in device.parameters if item.equals is None]
    names, shared = [item.name for item in device.interfaces], Pool()
    return kept(
        name=device.name,
        title=device.title,
        base=device.base,
        special=next((item.special for item in device.overlays if item.special), ""),
        special_codes=device.order_code.special,
        about=[BY_NAME.sentence(item) for item in origin(device)],
        evidence=BY_NAME.sentence(grade(device)),
        given=given,
        derived=[[name, expression(item)] for name, item in device.definitions.items()],
        held=[_held(device, item) for held in held_parameters(device) for item in held.parameters],
        alternatives=[_alternative(item) for item in device.alternatives],
        crcs={item.name: _crc(device, item) for item in device.crcs},
        interfaces=[_interface(device, item, shared) for item in device.interfaces],
        shared=shared.items,
        labels=labels(device),
        codes=[
            [item.code, names.index(item.interface), *(number(item.parameters[name]) for name in given)]
            for item in device.variants
        ],
    )


def _held(device: Device, item: Held) -> Data:
    """Return a parameter that is held in a register, with its limits."""
    parameter = item.parameter
    at = field_at(device, parameter.read_from)
    values = sorted({one.value for one in parameter.by_code})
    return kept(
        name=parameter.name, meaning=parameter.meaning, at=at, min=parameter.min, max=parameter.max, values=values
    )


def _alternative(item: Alternative) -> Data:
    answers = [
        [one.name, one.meaning, {name: number(value) for name, value in one.sets.items()}] for one in item.answers
    ]
    return kept(name=item.name, meaning=item.meaning, answers=answers, default=item.default)


def _crc(device: Device, item: Crc) -> Data:
    """Return the parameters of a CRC, and those of similar CRCs that may be used by mistake."""
    others = in_bytes.other_crcs(item) if Carrier.BYTES in carriers(device, item) else in_bits.other_crcs(item)
    return _parameters(item) | {
        "text": item.polynomial,
        "others": [[words, _parameters(other)] for _, words, other in others if other != item],
    }


def _parameters(item: Crc) -> Data:
    return kept(
        width=item.width,
        poly=number(item.poly),
        init=number(item.init),
        refin=int(item.refin),
        refout=int(item.refout),
        xorout=number(item.xorout),
    )


def _interface(device: Device, item: Interface, shared: Pool) -> Data:
    by_frame = {one.codec.layout.name: one for one in reportings(device)}
    return kept(
        name=item.name,
        title=item.title,
        measure=_measure(device, item),
        exact=[sender for sender in ("encoder", "master") if have_lengths(item.layouts, sender)],
        frames=[shared.parts(frame(device, layout, by_frame.get(layout.name))) for layout in item.layouts],
        told=[_dispatch(item, one) for one in dispatches(item.layouts)],
        registers=[shared.parts(register(device, one)) for one in device.registers_over(item.name)],
    )


def _measure(device: Device, interface: Interface) -> Data:
    """Return the unit of the position. If the position is not sent as a whole, ``part`` contains the angle."""
    found = device.measurement_of(interface.name)
    if found is None:
        return {}
    joins = (join for layout in interface.layouts for join in layout.joins if join.name == found.of)
    part = next((join.fields[-1] for join in joins), "")
    step, fine, counts = map(bound, (found.step_um, found.step_nm, found.per_counts))
    turn, turns = map(bound, (found.counts_per_turn, found.turns))
    length = {"step_um": step, "step_nm": fine, "per_counts": counts}
    return kept(of=found.of, part=part, **length, counts_per_turn=turn, turns=turns)


def _dispatch(interface: Interface, item: Dispatch) -> Data:
    """Return the pieces of bytes that form the selector of a sender's frames, and the frames keyed by its value."""
    places = {layout.name: place for place, layout in enumerate(interface.layouts)}
    return kept(
        sender=item.sender,
        selector=item.selector.name,
        pieces=[[piece.byte, piece.right, piece.mask, piece.left] for piece in item.bits.pieces],
        needs=item.needs,
        frames=[[places[branch.layout.name], *map(number, branch.values)] for branch in item.branches],
    ) | {"fallback": places[item.fallback.name] if item.fallback is not None else -1}
