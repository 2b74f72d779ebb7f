"""The worked examples of the manual that a program shows, and a made-up frame if the manual has none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from ...loading.examples import example_variant
from ...model import (
    CrcExample,
    Device,
    Example,
    FrameExample,
    Interface,
    Layout,
    MeasureExample,
    PollStep,
    Procedure,
    ProcedureExample,
    Register,
    RegisterExample,
    SendStep,
    Values,
    Variant,
    assert_never,
    cite,
    number_from_bytes,
)
from ...model.record import dataclass
from ...say.evidence import document


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame as a number, its source, and the values of its fields as far as these are given."""

    layout: Layout
    wire: int
    about: str
    values: Values


class NoFrame(Exception):
    """The manual shows no frame of an interface, and none could be made up."""


def chosen_variant(device: Device, interface: Interface) -> Variant:
    """Return the order code of an interface with the most examples that are used as printed."""
    given = (item for item in device.examples if _is_here(device, interface, item))
    # An example without an order code holds for every one.
    counted = Counter(getattr(item, "order_code", "") for item in given if not item.erratum)
    variants = device.variants_over(interface.name) or device.variants
    # Without any example, take the one with the finest resolution.
    return max(variants, key=lambda item: (counted[item.code], sum(item.parameters.values())))


def _is_here(device: Device, interface: Interface, example: Example) -> bool:
    """Return True if the manual shows it for an order code with this interface."""
    if example_variant(device, example).interface != interface.name:
        return False
    match example:
        case RegisterExample():
            register = device.register(example.register)
            return register.interface == interface.name and register.readable
        case FrameExample():
            plain = not example.refused and example.sender == "encoder" and bool(example.layout)
            return plain and not device.alternatives_of(device.layout(example.layout))
        case ProcedureExample() | MeasureExample():
            return True
        case CrcExample():
            return False
        case _:
            assert_never(example)


class Chosen:
    """The examples for the chosen order code of an interface.

    Raises:
        NoFrame: There is no frame to show.
    """

    def __init__(self, device: Device, interface: Interface) -> None:
        self.device, self.interface = device, interface
        self.measurement = device.measurement_of(interface.name)
        self.variant = chosen_variant(device, interface)
        given = (item for item in device.examples if _is_here(device, interface, item))
        self.examples = [item for item in given if example_variant(device, item).code == self.variant.code]
        self.frame = self._frame()

    @property
    def registers(self) -> Mapping[str, tuple[Register, RegisterExample]]:
        """The registers that are shown, by name. Simulated ones have no banks."""
        shown: dict[str, tuple[Register, RegisterExample]] = {}
        for item in self.examples:
            if isinstance(item, RegisterExample) and self.device.register(item.register).bank is None:
                shown.setdefault(item.register, (self.device.register(item.register), item))
        return shown

    @property
    def procedure(self) -> tuple[Procedure, ProcedureExample | None] | None:
        """Worked procedure with the most writes, or else the first one that clears an alarm by a request."""
        given = (item for item in self.examples if isinstance(item, ProcedureExample))
        worked = [(self.device.procedure(item.procedure), item) for item in given]
        # The simulated encoder is never done, so that a poll would not end.
        ending = [item for item in worked if not any(isinstance(step, PollStep) for step in item[0].steps)]
        if ending:
            return max(ending, key=lambda item: len(item[1].writes))
        return next(((item, None) for item in self._clearing()), None)

    def _clearing(self) -> Iterator[Procedure]:
        for alarm in self.device.alarms:
            for item in map(self.device.procedure, alarm.cleared_by):
                sends = any(isinstance(step, SendStep) for step in item.steps)
                if sends and item.interface == self.interface.name:
                    yield item

    # -- the frame

    def _frame(self) -> Frame:
        """Return a worked frame, or a made-up one if there is none.

        A frame used as printed is preferred, and then a frame from the manual to one from another source.
        """
        worked = [item for item in self.examples if isinstance(item, FrameExample)]
        if not worked:
            return self._made_up()
        first = min(worked, key=lambda item: (bool(item.erratum), any(source.document for source in item.source)))
        layout = self.device.layout(first.layout)
        wire = int(first.bits, 2) if first.bits else number_from_bytes(layout, first.bytes)
        return Frame(layout, wire, f"a worked example [{cite(first.source)}]", first.values)

    def _made_up(self) -> Frame:
        sent = [item for item in self.interface.layouts if item.sender == "encoder"]
        # Prefer one that needs no choice by the user. Order codes have the first answer of each alternative.
        sent.sort(key=lambda item: (not self.has_position(item), bool(self.device.alternatives_of(item))))
        sample = self.device.sample_of(sent[0])
        if sample is None:
            raise NoFrame
        of_others = any(isinstance(item, FrameExample) and item.layout == sent[0].name for item in self.device.examples)
        about = f"made up, since the {document(self.device)} has no example of it"
        about += " for this order code" if of_others else ""
        if sample.source:
            about = f"made up, with the position of a worked example [{cite(sample.source)}]"
        return Frame(sent[0], sample.frame, about, sample.values)

    def has_position(self, layout: Layout) -> bool:
        """Return True if a layout has the field or join that contains the position."""
        return self.measurement is not None and self.measurement.of in layout.member_names
