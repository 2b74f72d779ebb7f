"""Check that the frames over SPI that access a register hold as many bytes as it has."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..language.problems import DocumentReport
from ..model import Device, Register, Spi
from ..say.words import counted
from .valid_parts import valid_parts_so_far

#: Field of a frame that holds the value of a register.
_DATA = "data"


def check_spi_registers(device: Device, report: DocumentReport) -> None:
    """Compare the length of each register with the frames that read and write it, for every order code."""
    interface = device.find_interface(Spi)
    if interface is None or not valid_parts_so_far(report).has_frames:
        return
    for register in device.registers_over(interface.name):
        for name, bits in _widths(device, interface, set(_frames(interface, register))):
            if (bits + 7) // 8 != register.length:
                register_text = f"'{register.name}' has {counted(register.length, 'byte')}"
                message = f"{register_text}, but '{_DATA}' in '{name}' has {counted(bits, 'bit')}"
                remedy = "correct 'length', or describe each part as a register"
                report.add("width-mismatch", ("registers", register.name, "length"), f"{message}; {remedy}")
                break


def _frames(interface: Spi, register: Register) -> Iterator[str]:
    """Yield the names of the frames that carry the value of a register."""
    for exchange in interface.exchanges:
        if (exchange.purpose == "read" and register.readable) or (exchange.purpose == "write" and register.writable):
            yield from (exchange.request, exchange.reply)


def _widths(device: Device, interface: Spi, frames: Collection[str]) -> Iterator[tuple[str, int]]:
    """Yield each of these frames that has a value, with the number of its bits."""
    for layout in interface.layouts:
        for variant in device.variants_over(interface.name) if layout.name in frames else ():
            field = layout.place(variant.parameters).find_field(_DATA)
            if field is not None:
                yield layout.name, field.width
