"""An interface for which there is a driver, with the names of the C headers that it calls."""

from __future__ import annotations

import json
from collections.abc import Iterator

from codewheel.model import Device, Spi, Variant
from codewheel.say import text_on_one_line
from codewheel.targets.c.codec import StructCodec
from codewheel.targets.c.device import DeviceView, views_of
from codewheel.targets.c.names import c_name

#: Interfaces over an SPI peripheral.
BUSES = ("biss", "ssi", "spi")


def quoted(text: str) -> str:
    """Return text in double quotes for YAML and Kconfig."""
    return json.dumps(text_on_one_line(text).replace('"', "'").replace("$", ""), ensure_ascii=True)


def setting(name: str) -> str:
    """Return the name of a setting of Kconfig without its prefix."""
    return name.upper().replace("-", "_").replace(",", "_")


class Driver:
    """The values that the templates print for the driver of an interface."""

    def __init__(self, view: DeviceView, frame: StructCodec) -> None:
        self.view, self.frame = view, frame
        self.device: Device = view.device
        self.bus = view.context.interface.name
        self.stem, self.prefix, self.header = view.stem, view.prefix, view.header
        self.title = f"{self.device.title} over {view.context.interface.title}"
        self.compatible = f"{view.maker.name},{view.stem.replace('_', '-')}".replace("_", "-")
        self.binding = f"{self.compatible.replace(',', '-')}.yaml"
        self.codes = [(row.variant.code, row.macro) for row in view.variants.rows]
        self.is_read_twice = view.position_reader.reads_twice
        self.position_type = frame.struct.member_type(frame.position_member)
        self.member = c_name(frame.position_member)
        self.sets_position = frame.position_member in frame.set_names

    @property
    def lengths(self) -> list[str]:
        """Number of bytes in the buffer of each order code, over BiSS and SSI as a macro of the header."""
        if self.bus == "spi":
            return [str(_bits(self.frame, row.variant) // 8) for row in self.view.variants.rows]
        return [self.view.position_reader.buffer_of(row) for row in self.view.variants.rows]

    @property
    def request(self) -> StructCodec | None:
        """The request for the position over SPI, or None if the encoder ignores what it receives."""
        name = self.view.interface.position_request.removeprefix(f"{self.view.PREFIX}_REQUEST_").lower()
        requests = (codec for codec in self.view.interface.codecs if codec.struct.layout.name == name)
        return next(requests, None)

    @property
    def initial_request(self) -> str:
        """The initial value of the request, with the defaults of the spec."""
        parameters = self.view.variants.rows[0].variant.parameters
        return self.request.struct.initializer(parameters) if self.request is not None else ""

    @property
    def reply_words(self) -> int:
        """Number of words from a request to its reply."""
        interface = self.view.context.interface
        return int(isinstance(interface, Spi) and self.request is not None and interface.reply == "next_word")

    @property
    def mode(self) -> str:
        """The SPI mode as flags of Zephyr. BiSS and SSI need a clock that idles high."""
        interface = self.view.context.interface
        mode = interface.mode if isinstance(interface, Spi) else 3
        flags = {"SPI_MODE_CPOL": mode & 2, "SPI_MODE_CPHA": mode & 1}
        return "".join(f" | {flag}" for flag, is_set in flags.items() if is_set)

    @property
    def is_supported(self) -> bool:
        """True if the templates can express the interface."""
        measurement = self.device.measurement_of(self.bus)
        has_counts = measurement is not None and measurement.counts_per_turn is not None
        is_angle = self.device.movement == "rotary" and has_counts and self.position_type.startswith("u")
        sizes = [_bits(self.frame, row.variant) for row in self.view.variants.rows]
        is_whole = self.bus != "spi" or all(size % 8 == 0 for size in sizes)
        has_one_frame = self.view.channels is None and not self.view.position_reader.questions
        return is_angle and is_whole and has_one_frame and not self.frame.layout_plan.in_bytes


def _bits(frame: StructCodec, variant: Variant) -> int:
    return frame.struct.layout.bits.value(variant.parameters)


def drivers_of(device: Device) -> Iterator[Driver]:
    """Yield the interfaces of a family that can have a driver."""
    for view in views_of(device):
        frame = view.position_reader.frame
        if frame is not None and view.context.interface.name in BUSES and Driver(view, frame).is_supported:
            yield Driver(view, frame)
