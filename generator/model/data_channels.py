"""Data channels that one BiSS frame carries, as a spec lists them."""

from __future__ import annotations

from collections.abc import Mapping

from .documents import Sources
from .expressions import Expression
from .part import NOTHING, Count, Name, key, part, source_key


@part(
    "Data channels that the encoder sends in one frame, one directly after the other, such as the "
    "control and the safety position word of BiSS Safety. Each is a layout with its own CRC.",
    data="Data channels in one frame, one directly after the other.",
)
class DataChannels:
    """Data channels of one frame. ``compared`` contains the field of each layout whose highest bits must agree.

    These are ``compared_bits`` bits of each field, which may differ by ``tolerance``. The lowest and the highest number
    of these bits are adjacent.
    """

    order: tuple[Name, ...] = key(
        "Layouts of the channels, in the order in which they are sent.",
        data="Names of the layouts, in the order in which they are sent.",
        most=8,
        rule="channels-of-frame",
        label="order of the channels",
    )
    compared: Mapping[Name, Name] = key(
        "Fields with the same position, by layout, as in {cpw: singleturn, spw: safe_singleturn}. Their "
        "highest bits must agree, otherwise the position is not usable.",
        data="Fields whose highest bits must agree, by layout.",
        shape="{string}",
        most=8,
        default=NOTHING,
        rule="channels-of-frame",
        label="compared fields",
    )
    compared_bits: Expression | None = key(
        "With compared: number of the highest bits of these fields that are compared.",
        data="Number of the highest bits that are compared. null if there are none.",
        default=None,
        rule="channels-of-frame",
        read="setting",
        noun="number of compared bits",
    )
    tolerance: Count = key(
        "Highest difference of the compared bits, in units of their lowest bit.",
        default=0,
        rule="channels-of-frame",
        read="setting",
    )
    source: Sources = source_key()
