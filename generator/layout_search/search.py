"""Rank the layouts that could have sent all frames, by their description length (MDL)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from .checks import FoundCrc, FoundParity, crcs_of, parities_of
from .fields import Split, splits_of
from .frames import FEWEST, MOST_FRAMES, NoLayout, Recording

#: Number of layouts in an answer.
MOST_LAYOUTS = 3
#: Difference to the cost of the most likely layout in bits, above which a layout is not proposed.
_MOST_MORE_BITS = 20.0
#: Evidence in bits, above which a CRC cannot fit by chance, and frames without one need not be considered.
_CERTAIN = 30
#: Bits that describe a parity bit: in its usual place, in the other one, and in addition to a CRC.
_PARITY_BITS, _OTHER_PLACE_BITS, _WITH_CRC_BITS = 4.0, 2.0, 4.0
#: Difference of two costs in bits, below which the frames do not decide between Gray code and binary.
_UNDECIDED = 3.0


@dataclass(frozen=True, slots=True)
class FoundLayout:
    """A layout with its cost in bits. ``other_code`` is true if Gray code and binary describe the frames equally."""

    crc: FoundCrc | None
    parity: FoundParity | None
    split: Split
    cost: float
    other_code: bool = False


def find_layouts(recording: Recording) -> list[FoundLayout]:
    """Return the most likely layouts, the most likely first.

    Raises:
        NoLayout: The frames do not change.
    """
    if len(set(recording.frames)) < FEWEST:
        raise NoLayout("all frames are equal; turn the shaft, and give at least 2 different frames")
    best_layouts: dict[object, FoundLayout] = {}
    for layout in sorted(_layouts(recording), key=lambda layout: layout.cost):
        best_layouts.setdefault(_group(recording, layout), layout)
    layouts = _with_joined_codes(list(best_layouts.values()))
    highest_cost = layouts[0].cost + _MOST_MORE_BITS
    return [layout for layout in layouts[:MOST_LAYOUTS] if layout.cost <= highest_cost]


def _layouts(recording: Recording) -> Iterator[FoundLayout]:
    crcs = crcs_of(recording)
    candidates: list[FoundCrc | None] = list(crcs)
    if not any(crc.evidence > _CERTAIN for crc in crcs):
        candidates.append(None)
    for crc in candidates:
        body_bits = recording.bits - (crc.width if crc is not None else 0)
        crc_cost = crc.cost if crc is not None else 0.0
        for parity in (*parities_of(recording, body_bits), None):
            first, end = _bits_without(parity, body_bits)
            parity_cost = _parity_cost(recording, parity, crc) if parity is not None else 0.0
            for split in splits_of(recording, first, end):
                # A line has no parity over Gray code.
                if parity is not None and split.is_gray:
                    continue
                yield FoundLayout(crc, parity, split, crc_cost + parity_cost + split.cost)


def _bits_without(parity: FoundParity | None, body_bits: int) -> tuple[int, int]:
    """Return the first bit and the end of the bits between a CRC and a parity bit."""
    if parity is None:
        return 0, body_bits
    return (1, body_bits) if parity.place == 0 else (0, body_bits - 1)


def _parity_cost(recording: Recording, parity: FoundParity, crc: FoundCrc | None) -> float:
    """Return the bits of a parity bit: all that the frames do not prove, and its place and kind."""
    unproved_bits = max(min(len(recording.frames), MOST_FRAMES) - recording.independent, 0)
    is_in_usual_place = (parity.place == 0) == (recording.interface == "spi")
    place_bits = 0.0 if is_in_usual_place else _OTHER_PLACE_BITS
    return unproved_bits + _PARITY_BITS + place_bits + (_WITH_CRC_BITS if crc is not None else 0.0)


def _group(recording: Recording, layout: FoundLayout) -> object:
    """Return what tells layouts apart: all but the constant bits in front of the position."""
    split = layout.split
    first_change = next(place for place in range(split.start, split.end) if recording.changing[place])
    crc = layout.crc.polynomial if layout.crc is not None else 0
    return crc, layout.parity, first_change, split.end, split.is_gray, split.byte_order


def _with_joined_codes(layouts: list[FoundLayout]) -> list[FoundLayout]:
    """Return the layouts, sorted. Two that differ only in the code, and between which nothing decides, are one."""
    joined_layouts: list[FoundLayout] = []
    for layout in layouts:
        twin = next((other for other in joined_layouts if _differ_in_code(other, layout)), None)
        if twin is None:
            joined_layouts.append(layout)
        elif layout.cost - twin.cost < _UNDECIDED:
            joined_layouts[joined_layouts.index(twin)] = replace(twin, other_code=True)
        else:
            joined_layouts.append(layout)
    return joined_layouts


def _differ_in_code(one: FoundLayout, other: FoundLayout) -> bool:
    is_same_place = (one.split.start, one.split.end) == (other.split.start, other.split.end)
    is_same_check = (one.crc, one.parity) == (other.crc, other.parity)
    return is_same_place and is_same_check and one.split.is_gray != other.split.is_gray
