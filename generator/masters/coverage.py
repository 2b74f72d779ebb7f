"""Parts of a frame that the description of a master may not cover: other BiSS data channels, and unusual bits."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..language.master_items import NUMBERS
from ..language.problems import join_words
from ..model import Biss, Interface, PlacedLayout, channel_frame
from ..model.expressions import Expression
from ..model.record import dataclass
from .frame_parts import FramePart


@dataclass(frozen=True, slots=True)
class FrameChannels:
    """Names of the data channels before and after the position in its frame, in the order in which they are sent."""

    before: tuple[str, ...] = ()
    after: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Return whether the frame has other data channels than the one with the position."""
        return bool(self.before or self.after)

    def refusal(self, position_layout: str) -> str:
        """Return the reason why a master for a single data channel cannot read the position, or an empty string.

        Such a master reads only the first channel of a frame. ``position_layout`` is the channel with the position.
        """
        if not self.before:
            return ""
        first_name = self.before[0]
        order_text = f"'{first_name}' is the first in the frame, and '{position_layout}' with the position follows it"
        return f"The description of this master covers a single data channel, but {order_text}."

    @property
    def gap(self) -> str:
        """Sentence about the channels that a master for a single data channel does not read."""
        names = join_words(f"'{name}'" for name in self.after)
        return f"The description of this master covers a single data channel. Nothing reads {names} after it."


#: A frame with a single data channel.
NO_CHANNELS = FrameChannels()


def frame_channels(interface: Interface, position_layout: PlacedLayout) -> FrameChannels:
    """Return the names of the other data channels in the frame with the position, if the frame has several channels."""
    frame = channel_frame(interface)
    layouts = frame.layouts if frame is not None else ()
    names = [layout.name for layout in layouts if layout.is_sent(position_layout.parameters)]
    if position_layout.name not in names:
        return NO_CHANNELS
    index = names.index(position_layout.name)
    return FrameChannels(before=tuple(names[:index]), after=tuple(names[index + 1 :]))


def channel_notes(interface: Interface, position_layout: PlacedLayout) -> Iterator[str]:
    """Yield a sentence about BiSS data channels that the settings do not cover, because they lack the position."""
    channel = position_layout.layout.channel
    sent_layouts = [layout for layout in interface.layouts if layout.is_sent(position_layout.parameters)]
    other_layouts = [layout for layout in sent_layouts if layout.channel and layout.channel != channel]
    if isinstance(interface, Biss) and channel and other_layouts:
        other_channels = " and ".join(f"'{layout.name}' on channel {layout.channel}" for layout in other_layouts)
        yield f"The encoder also sends {other_channels}. These settings are for channel {channel} only."


#: Names of facts about the computation of the CRC, such as ``crc_polynomial``.
_CRC_ITEMS = {name for name in NUMBERS if name.startswith("crc_")} - {"crc_bits"}
#: Names of facts that do not depend on other bits of the frame.
_ITEMS_OF_ANY_FRAME = {"multiturn_bits", "singleturn_bits", "position_bits", "status_bits", *_CRC_ITEMS, "crc_bits"}
#: Names of facts that count bits of the frame, such as ``data_bits``, ``padding_left`` and ``other_bits_right``.
_FRAME_ITEMS = {name for name in NUMBERS if name.endswith("_bits") or "padding" in name or "bits_" in name}


def depends_on_crc(rules: Any) -> bool:
    """Return whether any rule of a master depends on the parameters of the CRC, such as its polynomial."""
    return not _CRC_ITEMS.isdisjoint(_mentioned_items(rules))


def depends_on_whole_frame(rule: Mapping[str, Any]) -> bool:
    """Return whether parts of the frame that a master's description does not cover can change the value of a setting.

    They cannot if the value depends on no number of bits, or only on one that is independent of the other bits, such as
    ``position_bits``.
    """
    describes_every_part = "string" in rule
    if describes_every_part:
        return True
    items_in_value = _mentioned_items({key: rule[key] for key in ("value", "choice") if key in rule})
    # Names in braces, such as "{data_bits}".
    items_in_text = set(re.findall(r"\{(\w+)\}", rule.get("text", "")))
    frame_items = _FRAME_ITEMS & (items_in_value | items_in_text)
    has_several_items = len(frame_items) > 1
    return has_several_items or not frame_items <= _ITEMS_OF_ANY_FRAME


def uncovered_parts(rules: Any, frame_parts: Sequence[FramePart]) -> str:
    """Return a text with the unusual parts of the frame that a master's description does not cover.

    The text, such as ``'parity' and 'reserved'``, is empty if there are none. Unusual parts are parity bits and bits
    with the role ``other``. The description covers one if one of its ``rules`` depends on the number of its bits.
    """
    parts_and_items = zip(frame_parts, _items_of_parts(frame_parts), strict=True)
    # For usual parts, the name of the fact is empty.
    item_by_uncommon_part = {part.name: item for part, item in parts_and_items if item}
    if not item_by_uncommon_part:
        return ""
    covered = covered_items(rules)
    uncovered_names = [name for name, item in item_by_uncommon_part.items() if item not in covered]
    return join_words(f"'{name}'" for name in uncovered_names)


def covered_items(rules: Any) -> set[str]:
    """Return the names of the facts about an encoder that the rules of a master cover: ``{"crc_bits", "coding"}``."""
    covered = _mentioned_items(rules)
    # A rule that depends on the kind of parity also covers the parity bit.
    if "parity" in covered:
        covered.add("parity_bits")
    return covered


def _items_of_parts(frame_parts: Sequence[FramePart]) -> Iterator[str]:
    """Yield for each part of a frame the name of the fact that counts its bits, such as ``parity_bits``.

    For usual parts, which every master can read, the name is empty.
    """
    is_after_position = False
    for part in frame_parts:
        if part.role in ("multiturn", "singleturn"):
            is_after_position = True
        if part.role == "other":
            yield "other_bits_right" if is_after_position else "other_bits_left"
        elif part.role == "parity":
            yield "parity_bits"
        else:
            yield ""


def _mentioned_items(rule: Any) -> set[str]:
    """Return the names of the facts about an encoder on which rules depend: ``{"crc_bits", "coding"}``.

    ``rule`` is a rule, a list of rules, or any part of one. The names are the values of the keys ``item`` and ``of``,
    and the parameters of expressions under ``value``, at any depth.
    """
    items: set[str] = set()
    if rule is None or isinstance(rule, (str, bool, int)):
        return items  # Most calls are for plain values, and the test for Mapping is slow.
    if isinstance(rule, (list, tuple)):
        for part_of_rule in rule:
            items |= _mentioned_items(part_of_rule)
    elif isinstance(rule, Mapping):
        items |= _mentioned_items(tuple(rule.values()))
        items |= {str(rule[key]) for key in ("item", "of") if key in rule}
        if isinstance(rule.get("value"), str):
            items |= set(Expression.parse(rule["value"]).parameters)
    return items
