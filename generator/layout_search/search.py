"""Rank the layouts that could have sent all frames, by their description length (MDL)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from operator import attrgetter

from .checks import FoundCrc, FoundParity, find_crcs, find_parities
from .fields import FrameSplit, possible_splits
from .frames import FEWEST_FRAMES, MOST_COMPARED_FRAMES, NoLayout, RecordedFrames

#: Maximum number of layouts in an answer.
MOST_LAYOUTS = 3
#: A layout whose cost exceeds the cost of the most likely one by more bits than this is not proposed.
_MOST_MORE_BITS = 20.0
#: Evidence in bits above which a CRC is not correct by chance, so that layouts without a CRC are not considered.
_CERTAIN_EVIDENCE = 30
#: Evidence in bits from which a CRC confirms a layout: it fits by chance in fewer than one of 250 recordings.
_CONFIRMING_EVIDENCE = 8
#: Number of different frames from which a layout without a CRC can be preferred.
_FEWEST_WITHOUT_CRC = 5
#: Bits that describe a parity bit: in its usual place, in the other place, and in addition to a CRC.
_PARITY_BITS, _OTHER_PLACE_BITS, _WITH_CRC_BITS = 4.0, 2.0, 4.0
#: Difference of two costs in bits, below which the frames do not decide between Gray code and binary.
_UNDECIDED_DIFFERENCE = 3.0


@dataclass(frozen=True, slots=True)
class FoundLayout:
    """A layout that all frames may have.

    ``cost`` is the number of bits that describe the layout and, with it, the frames. The layout with the lowest cost is
    the most likely. ``may_be_other_code`` is true if the frames do not show whether the position is in Gray code or
    binary.
    """

    crc: FoundCrc | None
    parity: FoundParity | None
    frame_split: FrameSplit
    cost: float
    may_be_other_code: bool = False


def find_layouts(recording: RecordedFrames) -> list[FoundLayout]:
    """Return up to three layouts that all frames may have, the most likely first.

    Each layout has a cost, the number of bits that describe the frames with it, and the lowest cost is the most likely.
    Layouts that differ only in whether constant bits belong to the position are represented by the best one.

    Raises:
        NoLayout: All frames are equal, or come from a dead line.
    """
    if recording.is_dead_line:
        raise NoLayout("dead line: all bits of each frame are equal; check the wires and the supply of the encoder")
    if len(set(recording.frames)) < FEWEST_FRAMES:
        raise NoLayout("all frames are equal; turn the shaft, and give at least 2 different frames")
    best_first = sorted(_possible_layouts(recording), key=attrgetter("cost"))
    best_of_group: dict[object, FoundLayout] = {}
    for layout in best_first:
        best_of_group.setdefault(_group_key(recording, layout), layout)
    layouts = _merge_undecided_codes(list(best_of_group.values()))
    highest_cost = layouts[0].cost + _MOST_MORE_BITS
    return [layout for layout in layouts[:MOST_LAYOUTS] if layout.cost <= highest_cost]


def lacks_frames(recording: RecordedFrames, layout: FoundLayout) -> bool:
    """Return whether there are too few frames to prefer a layout: fewer than five, and no CRC that confirms it."""
    if layout.crc is not None and layout.crc.evidence >= _CONFIRMING_EVIDENCE:
        return False
    return len(set(recording.frames)) < _FEWEST_WITHOUT_CRC


def _possible_layouts(recording: RecordedFrames) -> Iterator[FoundLayout]:
    """Yield every layout that the frames may have: with or without a CRC, and with or without a parity bit.

    The other bits are split into the position and other fields in every possible way. If the frames prove a CRC,
    layouts without one are omitted.
    """
    crcs = find_crcs(recording)
    crc_candidates: list[FoundCrc | None] = list(crcs)
    is_crc_proved = any(crc.evidence > _CERTAIN_EVIDENCE for crc in crcs)
    if not is_crc_proved:
        crc_candidates.append(None)
    for crc in crc_candidates:
        # The CRC is at the end of the frame, and the body is everything before it.
        body_bits = recording.bits - (crc.width if crc is not None else 0)
        crc_cost = crc.cost if crc is not None else 0.0
        for parity in (*find_parities(recording, body_bits), None):
            first_bit, end = _bits_between_checks(parity, body_bits)
            parity_cost = _parity_cost(recording, parity, crc) if parity is not None else 0.0
            for split in possible_splits(recording, first_bit, end):
                total_cost = crc_cost + parity_cost + split.cost
                yield FoundLayout(crc=crc, parity=parity, frame_split=split, cost=total_cost)


def _bits_between_checks(parity: FoundParity | None, body_bits: int) -> tuple[int, int]:
    """Return the start and the end of the bits of a frame without its CRC and its parity bit.

    ``body_bits`` is the number of bits before the CRC. The parity bit, if any, is the first or the last of these.
    """
    if parity is None:
        return 0, body_bits
    is_first_bit = parity.bit_index == 0
    return (1, body_bits) if is_first_bit else (0, body_bits - 1)


def _parity_cost(recording: RecordedFrames, parity: FoundParity, crc: FoundCrc | None) -> float:
    """Return the number of bits that describe a parity bit.

    They are one bit for each frame that does not prove it, a few bits for the parity itself, and more for an unusual
    place, and in addition to a CRC.
    """
    sample_count = min(len(recording.frames), MOST_COMPARED_FRAMES)
    unproved_bits = max(sample_count - recording.independent_difference_count, 0)
    cost = _PARITY_BITS + unproved_bits
    usual_is_first_bit = recording.interface == "spi"
    is_first_bit = parity.bit_index == 0
    if is_first_bit != usual_is_first_bit:
        cost += _OTHER_PLACE_BITS
    if crc is not None:
        cost += _WITH_CRC_BITS
    return cost


def _group_key(recording: RecordedFrames, layout: FoundLayout) -> object:
    """Return a key that is equal for layouts that differ only in how many constant bits the position begins with."""
    split = layout.frame_split
    first_changing_bit = recording.bit_changes.index(True, split.position_start, split.position_end)
    polynomial = layout.crc.polynomial if layout.crc is not None else 0
    return polynomial, layout.parity, first_changing_bit, split.position_end, split.is_gray, split.byte_order


def _merge_undecided_codes(layouts: list[FoundLayout]) -> list[FoundLayout]:
    """Merge layouts that differ only in the code of the position, Gray or binary, if the frames do not decide it.

    This is the case if their costs differ by less than 3 bits. The better one remains, with ``may_be_other_code``
    true. The layouts are sorted by cost, and stay in this order.
    """
    merged_layouts: list[FoundLayout] = []
    # Index of the best layout in Gray code and in binary, by everything else that distinguishes the layouts.
    index_by_key: dict[tuple[object, bool], int] = {}
    for layout in layouts:
        split = layout.frame_split
        key_without_code = layout.crc, layout.parity, split.position_start, split.position_end
        index_in_other_code = index_by_key.get((key_without_code, not split.is_gray))
        if index_in_other_code is not None:
            better_layout = merged_layouts[index_in_other_code]
            if layout.cost - better_layout.cost < _UNDECIDED_DIFFERENCE:
                merged_layouts[index_in_other_code] = replace(better_layout, may_be_other_code=True)
                continue
        index_by_key.setdefault((key_without_code, split.is_gray), len(merged_layouts))
        merged_layouts.append(layout)
    return merged_layouts
