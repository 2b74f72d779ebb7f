"""Names of things in C and in Python, so that users can search their code for them."""

from __future__ import annotations

from ..model import Crc, DataId, Device, Layout, Procedure, Register
from .change import Thing


def _of_c(device: Device) -> str:
    return f"{device.manufacturer.name}_{device.name}"


def _camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def register(device: Device, item: Register, label: str) -> Thing:
    c = f"{_of_c(device)}_reg_{item.name}".upper() + "_…"
    return Thing(f"registers.{item.name}", label, item.interface, c, f'{device.name}.REGISTERS["{item.name}"]')


def frame(device: Device, interface: str, item: Layout) -> Thing:
    path = f"interfaces.{interface}.layouts.{item.name}"
    c, python = f"{_of_c(device)}_{item.name}_…", f"{device.name}.{_camel(item.name)}"
    return Thing(path, f"frame {item.name}", interface, c, python)


def procedure(device: Device, item: Procedure) -> Thing:
    c, python = f"{_of_c(device)}_{item.name}_…", f"{device.name}.{item.name}"
    return Thing(f"procedures.{item.name}", f"procedure {item.name}", item.interface, c, python)


def crc(device: Device, item: Crc, interface: str) -> Thing:
    c, python = f"{_of_c(device)}_crc_{item.name}", f"{device.name}.crc_{item.name}"
    return Thing(f"crcs.{item.name}", f"CRC {item.name}", interface, c, python)


def data_id(device: Device, interface: str, item: DataId) -> Thing:
    c = f"{_of_c(device)}_data_id_{item.name}".upper()
    path = f"interfaces.{interface}.data_ids.{item.name}"
    return Thing(path, f"data ID {item.name}", interface, c, f"{device.name}.DataId")
