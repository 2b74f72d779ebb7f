"""Readers of the files for masters, which replace the tools. They refuse everything that the tools do not know.

======================  ============================================================================================
ethercat_driver_ros2    ec_sdo_manager.hpp: a list under the key sdo of index, sub_index, type and value, an int
linuxcnc_ethercat       lcec_conf.c: idx and subIdx in hexadecimal, sdoDataRaw with bytes in hexadecimal, little-endian
ecmc                    ecmccfg, hardware/Encoders: Cfg.EcAddSdo(slave, index, subindex, value, bytes)
twincat                 the XML of a tree item: decimal index and subindex, bytes in hexadecimal, little-endian
fastcat                 el5042.cc: eleven lists of one value for each of two channels, clocks by name
conf_set                aux_common.h, BissC::Config: five members
hal                     halcmd: loadrt with the module parameter config, setp with a name and a number
xcf                     configuration_file.py: attributes access, dtype, id, storage and subnode of a register
======================  ============================================================================================
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.etree import ElementTree

import yaml

#: Index and subindex with a value and a size in bytes.
Objects = dict[tuple[int, int], tuple[int, int]]

_SIZES = {f"{sign}int{8 * size}": size for sign in ("", "u") for size in (1, 2, 4, 8)}
_FASTCAT = {
    "invert_feedback_direction": 0x01,
    "disable_status_bits": 0x02,
    "invert_checksum": 0x03,
    "checksum_polynomial": 0x11,
    "supply_voltage": 0x12,
    "clock_frequency": 0x13,
    "gray_code": 0x14,
    "multiturn_bits": 0x15,
    "singleturn_bits": 0x16,
    "offset_bits": 0x17,
    "ssi_mode": 0x18,
}
_CLOCKS = dict(
    zip(
        ("10MHz", "5MHz", "3_33MHz", "2_5MHz", "2MHz", "1MHz", "500KHz", "250KHz"),
        (0, 1, 2, 3, 4, 9, 17, 19),
        strict=True,
    )
)
_MOTEUS = {"enabled": 1, "rate_hz": 0xFFFFFFFF, "data_bits": 255, "crc_bits": 255, "poll_rate_us": 0x7FFFFFFF}
_ECMC = re.compile(
    r"ecmcConfigOrDie \"Cfg\.EcAddSdo\(\$\{ECMC_EC_SLAVE_NUM\},(0x[0-9A-F]+),(0x[0-9A-F]+),(\d+),([1248])\)\""
)


class Refused(ValueError):
    """The tool would not know the content."""


def _require_names(names: Iterable[str], known_names: Iterable[str]) -> None:
    unknown = set(names) ^ set(known_names)
    if unknown:
        raise Refused(sorted(unknown))


def _add_object(objects: Objects, index: int, subindex: int, value: int, size: int) -> None:
    if (index, subindex) in objects or not 0 <= value < 1 << 8 * size:
        raise Refused((index, subindex, value))
    objects[index, subindex] = value, size


def ethercat_driver_ros2(text: str) -> Objects:
    data = yaml.safe_load(text)
    _require_names(data, ["sdo"])
    objects: Objects = {}
    for sdo in data["sdo"]:
        _require_names(sdo, ["index", "sub_index", "type", "value"])
        if not isinstance(sdo["value"], int) or not -(1 << 31) <= sdo["value"] < 1 << 31:
            raise Refused(sdo["value"])
        _add_object(objects, sdo["index"], sdo["sub_index"], sdo["value"], _SIZES[sdo["type"]])
    return objects


def linuxcnc_ethercat(text: str) -> Objects:
    root = ElementTree.fromstring(text)
    slave = root.find("master/slave")
    assert slave is not None
    _require_names([root.tag, *(node.tag for node in slave)], ["masters", "sdoConfig"])
    _require_names([slave.get("type", "")], ["generic"])
    objects: Objects = {}
    for sdo in slave:
        _require_names(sdo.attrib, ["idx", "subIdx"])
        data = b"".join(bytes.fromhex(raw.attrib["data"]) for raw in sdo)
        _add_object(
            objects,
            int(sdo.attrib["idx"], 16),
            int(sdo.attrib["subIdx"], 16),
            int.from_bytes(data, "little"),
            len(data),
        )
    return objects


def ecmc(text: str) -> Objects:
    objects: Objects = {}
    for line in filter(None, text.splitlines()):
        if not line.startswith("#-"):
            match = _ECMC.fullmatch(line)
            if match is None:
                raise Refused(line)
            _add_object(objects, *(int(number, 0) for number in match.groups()))
    return objects


def twincat(text: str) -> Objects:
    root = ElementTree.fromstring(text)
    commands = root.find("EtherCAT/Slave/Mailbox/CoE/InitCmds")
    assert root.tag == "TreeItem"
    assert commands is not None
    objects: Objects = {}
    for command in commands:
        parts = {part.tag: part.text or "" for part in command}
        _require_names(parts, ["Transition", "Comment", "Timeout", "Ccs", "Index", "SubIndex", "Data"])
        _require_names([command.tag, parts["Transition"], parts["Ccs"]], ["InitCmd", "PS", "1"])
        data = bytes.fromhex(parts["Data"])
        _add_object(objects, int(parts["Index"]), int(parts["SubIndex"]), int.from_bytes(data, "little"), len(data))
    return objects


def fastcat(text: str) -> dict[int, int]:
    """Return the values by subindex, which must be the same for both channels."""
    (device,) = yaml.safe_load(text)
    _require_names(device, ["device_class", "name", *_FASTCAT])
    _require_names([device["device_class"]], ["El5042"])
    objects = {}
    for key, subindex in _FASTCAT.items():
        names_or_values = device[key]
        if key == "clock_frequency":
            names_or_values = [_CLOCKS[clock] for clock in names_or_values]
        first, second = names_or_values
        if first != second or not isinstance(first, int):
            raise Refused((key, first, second))
        objects[subindex] = first
    return objects


def conf_set(text: str) -> dict[str, int]:
    objects = {}
    for line in text.splitlines():
        if not line.startswith("#"):
            command, action, name, value = line.split(" ")
            channel, group, member = name.split(".")
            _require_names([command, action, channel, group], ["conf", "set", "aux1", "bissc"])
            if not 0 <= int(value) <= _MOTEUS[member]:
                raise Refused(line)
            objects[member] = int(value)
    return objects


def hal(text: str) -> tuple[str, float]:
    """Return the entry of the module parameter config, and the frequency in kHz."""
    load, setp = (line for line in text.splitlines() if not line.startswith("#"))
    loaded = re.fullmatch(r'loadrt \[HOSTMOT2\]\(DRIVER\) config="([^" ]+)"', load)
    assert loaded is not None
    chosen = re.fullmatch(r"setp hm2_\[HOSTMOT2\]\(BOARD\)\.0\.(biss|ssi)\.00\.frequency-khz ([0-9.]+)", setp)
    assert chosen is not None
    assert loaded[1].startswith(f"{chosen[1]}_chan_0=")
    return loaded[1], float(chosen[2])


def xcf(text: str) -> dict[str, int]:
    root = ElementTree.fromstring(text)
    device = root.find("Body/Device")
    assert device is not None
    _require_names(device.attrib, ["Interface", "PartNumber", "ProductCode", "RevisionNumber", "firmwareVersion"])
    objects = {}
    for register in device.iterfind("Registers/Register"):
        _require_names(register.attrib, ["access", "dtype", "id", "storage", "subnode"])
        bits = {"u16": 16, "u32": 32}[register.attrib["dtype"]]
        if not 0 <= int(register.attrib["storage"]) < 1 << bits:
            raise Refused(register.attrib)
        objects[register.attrib["id"]] = int(register.attrib["storage"])
    return objects


def defines(text: str) -> dict[str, int]:
    """Return the numbers that a C header defines."""
    return {name: int(value, 0) for name, value in re.findall(r"^#define (\w+) (\w+?)U$", text, re.MULTILINE)}


def members(text: str) -> dict[str, int]:
    """Return the members of an initializer in C."""
    return {name: int(value) for name, value in re.findall(r"^    \.(\w+) = (\d+),", text, re.MULTILINE)}
