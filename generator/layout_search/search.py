"""Rank the layouts that could have sent all frames, by their description length (MDL)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from .checks import FoundCrc, FoundParity, crcs_of, parities_of
from .fields import FrameSplit, splits_of
from .frames import FEWEST, MOST_FRAMES, NoLayout, RecordedFrames

#: Number of layouts in an answer.
MOST_LAYOUTS = 3
#: Difference to the cost of the most likely layout in bits, above which a layout is not proposed.
_MOST_MORE_BITS = 20.0
#: Evidence in bits, above which a CRC cannot fit by chance, and frames without one need not be considered.
_CERTAIN_EVIDENCE = 30
#: Bits that describe a parity bit: in its usual place, in the other place, and in addition to a CRC.
_PARITY_BITS, _OTHER_PLACE_BITS, _WITH_CRC_BITS = 4.0, 2.0, 4.0
#: Difference of two costs in bits, below which the frames do not decide between Gray code and binary.
_UNDECIDED_DIFFERENCE = 3.0


@dataclass(frozen=True, slots=True)
class FoundLayout:
    """A layout with its cost in bits.

    ``other_code`` is true if Gray code and binary describe the frames so equally that they do not decide.
    """

    crc: FoundCrc | None
    parity: FoundParity | None
    split: FrameSplit
    cost: float
    other_code: bool = False


def find_layouts(recording: RecordedFrames) -> list[FoundLayout]:
    """Return up to ``MOST_LAYOUTS`` layouts, the layout with the lowest cost first.

    Of layouts that differ only in constant bits in front of the position, only the layout with the lowest cost remains.

    Raises:
        NoLayout: The frames do not change.
    """
    if len(set(recording.frames)) < FEWEST:
        raise NoLayout("all frames are equal; turn the shaft, and give at least 2 different frames")
    best_layouts: dict[object, FoundLayout] = {}
    # From the lowest cost on, so the first layout of a group is the best.
    for layout in sorted(_possible_layouts(recording), key=lambda layout: layout.cost):
        best_layouts.setdefault(_group_key(recording, layout), layout)
    layouts = _with_undecided_codes_joined(list(best_layouts.values()))
    highest_cost = layouts[0].cost + _MOST_MORE_BITS
    return [layout for layout in layouts[:MOST_LAYOUTS] if layout.cost <= highest_cost]


def _possible_layouts(recording: RecordedFrames) -> Iterator[FoundLayout]:
    """Yield every combination of a CRC or none, a parity bit or none, and a split of the other bits.

    If the frames prove a CRC, layouts without a CRC are left out.
    """
    crcs = crcs_of(recording)
    crc_candidates: list[FoundCrc | None] = list(crcs)
    if not any(crc.evidence > _CERTAIN_EVIDENCE for crc in crcs):
        crc_candidates.append(None)
    for crc in crc_candidates:
        # The CRC is the last bits of a frame, and the body is the rest.
        body_bits = recording.bits - (crc.width if crc is not None else 0)
        crc_cost = crc.cost if crc is not None else 0.0
        for parity in (*parities_of(recording, body_bits), None):
            first_bit, end = _bits_between_checks(parity, body_bits)
            parity_cost = _parity_cost(recording, parity, crc) if parity is not None else 0.0
            for split in splits_of(recording, first_bit, end):
                total_cost = crc_cost + parity_cost + split.cost
                yield FoundLayout(crc=crc, parity=parity, split=split, cost=total_cost)


def _bits_between_checks(parity: FoundParity | None, body_bits: int) -> tuple[int, int]:
    """Return the first bit and the end of the bits between a CRC and a parity bit."""
    if parity is None:
        return 0, body_bits
    is_first_bit = parity.place == 0
    return (1, body_bits) if is_first_bit else (0, body_bits - 1)


def _parity_cost(recording: RecordedFrames, parity: FoundParity, crc: FoundCrc | None) -> float:
    """Return the cost of a parity bit in bits: one for each frame that does not prove it, and its place and kind."""
    sample_count = min(len(recording.frames), MOST_FRAMES)
    unproved_bits = max(sample_count - recording.independent, 0)
    cost = _PARITY_BITS + unproved_bits
    usual_is_first_bit = recording.interface == "spi"
    is_first_bit = parity.place == 0
    if is_first_bit != usual_is_first_bit:
        cost += _OTHER_PLACE_BITS
    if crc is not None:
        cost += _WITH_CRC_BITS
    return cost


def _group_key(recording: RecordedFrames, layout: FoundLayout) -> object:
    """Return a key that is equal for layouts that differ only in the constant bits in front of the position."""
    split = layout.split
    first_changing_bit = recording.changing.index(True, split.start, split.end)
    polynomial = layout.crc.polynomial if layout.crc is not None else 0
    return polynomial, layout.parity, first_changing_bit, split.end, split.is_gray, split.byte_order


def _with_undecided_codes_joined(layouts: list[FoundLayout]) -> list[FoundLayout]:
    """Return the layouts in their order, from the lowest cost to the highest.

    Of two that differ only in the code, and whose costs differ by less than ``_UNDECIDED_DIFFERENCE`` bits, the first
    remains, with ``other_code``.
    """
    joined_layouts: list[FoundLayout] = []
    # The index of the first layout in each code, by what a layout and the same one in the other code have in common.
    indexes: dict[tuple[object, bool], int] = {}
    for layout in layouts:
        split = layout.split
        same_but_code = layout.crc, layout.parity, split.start, split.end
        index = indexes.get((same_but_code, not split.is_gray))
        if index is not None and layout.cost - joined_layouts[index].cost < _UNDECIDED_DIFFERENCE:
            joined_layouts[index] = replace(joined_layouts[index], other_code=True)
        else:
            indexes.setdefault((same_but_code, split.is_gray), len(joined_layouts))
            joined_layouts.append(layout)
    return joined_layouts
