"""Examples of frames with several data channels in the README."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...model import ChannelFrame, Device, Interface, Sample, channel_frame
from ...model.record import dataclass
from .codec import LayoutClass
from .names import DeviceNames
from .readme import numbers_by_name


@dataclass(frozen=True)
class ChannelExample:
    """An example in the README that decodes a frame with several data channels.

    ``channel_classes`` are the classes of its channels, and ``position_class`` is the one with the position. ``frame``
    is the frame as a number of ``bits`` bits. ``printed_expressions`` are the expressions that the example prints, and
    ``printed_text`` has their values.
    """

    order_code: str
    module: str
    interface: str
    channel_classes: tuple[str, ...]
    position_class: str
    frame: str
    bits: int
    printed_expressions: str
    printed_text: str


def channel_example(
    device_names: DeviceNames, interface: Interface, layout_classes: Sequence[LayoutClass]
) -> ChannelExample | None:
    """Return an example that joins the samples of all channels, or None if they do not form a usable frame.

    ``layout_classes`` are the classes of the frames over the interface.
    """
    frame = channel_frame(interface)
    samples = _samples_of_channels(device_names.device, frame) if frame is not None else []
    if frame is None or not samples:
        return None
    order_code = samples[0].order_code
    placed_frame = frame.place(device_names.device.variant(order_code).parameters)
    # Some manuals require that the positions of two channels agree.
    if frame.compared and not placed_frame.agree([sample.values for sample in samples]):
        return None
    class_by_layout = {layout_class.layout.name: layout_class for layout_class in layout_classes}
    classes_and_samples = [(class_by_layout[sample.layout], sample) for sample in samples]
    position_classes = [layout_class.name for layout_class, _ in classes_and_samples if layout_class.position_attribute]
    expressions_and_values = list(_printed_numbers(device_names, classes_and_samples))
    return ChannelExample(
        order_code=order_code,
        module=device_names.module_name,
        interface=interface.title,
        channel_classes=tuple(layout_class.name for layout_class, _ in classes_and_samples),
        position_class=position_classes[0],
        frame=f"{placed_frame.join([sample.frame for sample in samples]):#x}",
        bits=placed_frame.bits,
        printed_expressions=", ".join(expression for expression, _ in expressions_and_values),
        printed_text=" ".join(value for _, value in expressions_and_values),
    )


def _samples_of_channels(device: Device, frame: ChannelFrame) -> list[Sample]:
    """Return the sample of each channel, or an empty list if not all have one, for the same order code."""
    samples = [sample for layout in frame.layouts if (sample := device.sample_of(layout)) is not None]
    order_codes = {sample.order_code for sample in samples}
    is_complete = len(samples) == len(frame.layouts) and len(order_codes) == 1
    return samples if is_complete else []


def _printed_numbers(
    device_names: DeviceNames, classes_and_samples: Sequence[tuple[LayoutClass, Sample]]
) -> Iterator[tuple[str, str]]:
    """Yield the expression and the value of the position, and of the first number in each other channel."""
    for layout_class, sample in classes_and_samples:
        number_by_attribute: dict[str, object] = {}
        for name, number in numbers_by_name(layout_class, sample).items():
            number_by_attribute[layout_class.class_names.attribute_name(name)] = number
        if layout_class.position_attribute:
            yield "frame.position", str(number_by_attribute[layout_class.position_attribute])
        elif number_by_attribute:
            attribute_name, number = next(iter(number_by_attribute.items()))
            yield f"frame.of({device_names.module_name}.{layout_class.name}).{attribute_name}", str(number)
