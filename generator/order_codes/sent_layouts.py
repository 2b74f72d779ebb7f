"""Leave out the layouts that have no bits for an order code, with their data channels."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from ..model import Biss, DataChannels, Interface


def with_sent_layouts(interface: Interface, parameters: Mapping[str, int]) -> Interface:
    """Return the interface without the layouts that have no bits for these parameters."""
    layouts = tuple(layout for layout in interface.layouts if layout.is_sent(parameters))
    if len(layouts) == len(interface.layouts):
        return interface
    if isinstance(interface, Biss) and interface.channels is not None:
        sent_names = [layout.name for layout in layouts]
        interface = replace(interface, channels=_with_sent_channels(interface.channels, sent_names))
    return replace(interface, layouts=layouts)


def _with_sent_channels(channels: DataChannels, sent_names: Collection[str]) -> DataChannels | None:
    """Return the channels of a frame that have bits, or None if it carries a single one."""
    sent_order = tuple(name for name in channels.order if name in sent_names)
    if len(sent_order) < 2:
        return None
    compared = {name: field for name, field in channels.compared.items() if name in sent_names}
    return replace(channels, order=sent_order, compared=compared)
