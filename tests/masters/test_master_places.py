"""Addresses and formats of the settings of masters, with numbers typed from the masters' documents.

=======================  ==============================================================================================
EL5042                   infosys el5042/4216721675: 80p8 with p = 0 and 1, types and defaults of 02 to 15
                         ecmccfg, ecmcEL5042-Encoder-RLS-LA11-24bit.cmd: 16, 17 and 18 have one byte, defaults 13, 0, 0
EJ5042                   infosys ej5042/10839989899: the same objects, CRC Polynomial is INT64
AKD2G                    webhelp FBx.MULTITURNBITS: 3500h to 3504h, 0ch, Unsigned8, 0 to 32, default 12
AKD                      AKD BASIC User Guide, p. 270, FB1.ENCRES: 3533h/0, encoder counts, default 1,024
moteus                   fw/aux_common.h, BissC::Config: bool, uint32_t, uint8_t, uint8_t and their initial values
hostmot2                 abs_encoder.c: frequency-khz is a HAL parameter of type float that starts with 500
dsPIC33A                 B1CLTCONx: SCDLEN 5:0, SCDEN 6, GRAY 7, CRCLEN 14:8, CRCSEL 15, CRCSEED 31:16, reset value 0
iC-MB3                   data sheet, p. 15: addresses 192, 196, 200 and 193, 197, 201 for slaves 1 to 3
=======================  ==============================================================================================
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.places_and_writing import SettingPlace, write_order
from codewheel.masters.sheet import Master, Setting, SettingsSheet, sheet

SheetOf = Callable[[str, str], SettingsSheet]
RecordOf = Callable[[str], EncoderFacts]
Row = tuple[Any, ...]

CODE = "AMM5A21/65KSC1"


def rows_of_channels(device: str, settings: list[Row]) -> list[Row]:
    """Return the rows of a terminal with two channels, whose objects are 0x10 apart."""
    rows: list[Row] = []
    for channel in (1, 2):
        index = 0x8008 + 0x10 * (channel - 1)
        rows += [(name, device, f"channel {channel}", index, *facts) for name, *facts in settings]
    return rows


#: Setting, device, channel, index, subindex, type, kind, width, unit, default, value, for AMM5A21/65KSC1: 16 + 21 bits,
#: CRC 0x43 inverted, 10 MHz.
EL5042_SETTINGS: list[Row] = [
    ("Mode", 0x18, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Disable Status Bits", 0x02, "BOOLEAN", "boolean", 1, "none", False, False),
    ("CRC Invert", 0x03, "BOOLEAN", "boolean", 1, "none", True, True),
    ("CRC Polynomial", 0x11, "UINT32", "unsigned", 32, "none", 67, 67),
    ("Clock Frequency, EL5042 and EP7041-4032", 0x13, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Coding", 0x14, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Multiturn [Bit]", 0x15, "UINT8", "unsigned", 8, "bits", 12, 16),
    ("Singleturn [Bit]", 0x16, "UINT8", "unsigned", 8, "bits", 13, 21),
    ("Offset LSB Bit [Bit]", 0x17, "UINT8", "unsigned", 8, "bits", 0, 0),
]
EL5042 = rows_of_channels("EL5042", EL5042_SETTINGS)
SUPPLY: Row = ("Supply Voltage", "EL5042", "", 0x8008, 0x12, "UINT8", "unsigned", 8, "0.1 V", 50, 50)
EJ5042_SETTINGS: list[Row] = [
    ("Mode", 0x18, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Disable Status Bits", 0x02, "BOOLEAN", "boolean", 1, "none", False, False),
    ("CRC Invert", 0x03, "BOOLEAN", "boolean", 1, "none", True, True),
    ("CRC Polynomial", 0x11, "INT64", "signed", 64, "none", 67, 67),
    ("Clock Frequency, EJ5042", 0x13, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Coding", 0x14, "UINT8", "unsigned", 8, "none", 0, 0),
    ("Multiturn [Bit]", 0x15, "UINT8", "unsigned", 8, "bits", 12, 16),
    ("Singleturn [Bit]", 0x16, "UINT8", "unsigned", 8, "bits", 13, 21),
    ("Offset LSB Bit [Bit]", 0x17, "UINT8", "unsigned", 8, "bits", 0, 0),
]
EJ5042 = rows_of_channels("EJ5042", EJ5042_SETTINGS)
AKD2G_SETTING = ("Unsigned8", "unsigned", 8, "bits", 12, 16)
AKD2G: list[Row] = [
    ("FB#.MULTITURNBITS", "AKD2G", "FB1", 0x3500, 0x0C, *AKD2G_SETTING),
    ("FB#.MULTITURNBITS", "AKD2G", "FB2", 0x3501, 0x0C, *AKD2G_SETTING),
    ("FB#.MULTITURNBITS", "AKD2G", "FB3", 0x3502, 0x0C, *AKD2G_SETTING),
    ("FB#.MULTITURNBITS", "AKD2G", "FB4", 0x3503, 0x0C, *AKD2G_SETTING),
    ("FB#.MULTITURNBITS", "AKD2G", "FB5", 0x3504, 0x0C, *AKD2G_SETTING),
]

#: The manual of the AKD has an object only for FB1.ENCRES, and gives no width. 2 to the power of 32 - 16 is 65536.
AKD: list[Row] = [
    ("FB1.SELECT", "Kollmorgen AKD", "", None, None, "", "", None, "none", None, 34),
    ("FB1.BISSBITS", "Kollmorgen AKD", "", None, None, "", "", None, "bits", None, 37),
    ("FB1.ENCRES", "Kollmorgen AKD", "", 0x3533, 0, "", "", None, "encoder counts", 1024, 65536),
]

#: Setting, channel, symbol, type, kind, width, unit, default, value.
MOTEUS_SETTINGS: list[Row] = [
    ("enabled", "bool", "boolean", 1, "none", False, 1),
    ("rate_hz", "uint32_t", "unsigned", 32, "Hz", 1_000_000, 1_000_000),
    ("data_bits", "uint8_t", "unsigned", 8, "bits", 20, 37),
    ("crc_bits", "uint8_t", "unsigned", 8, "bits", 6, 6),
    ("poll_rate_us", "int32_t", "signed", 32, "µs", 100, None),
]
MOTEUS: list[Row] = []
for aux in ("aux1", "aux2"):
    MOTEUS += [(f"aux[12].bissc.{name}", aux, f"{aux}.bissc.{name}", *facts) for name, *facts in MOTEUS_SETTINGS]
HOSTMOT2: list[Row] = [
    (
        "biss_chan_0",
        "",
        "config",
        "text",
        "text",
        None,
        "none",
        None,
        "biss_chan_0=crc%6pnwarning%1bnerror%1bpositionlow%21lposition%16mh",
    ),
    ("frequency-khz", "", "hm2_XXXX.N.biss.MM.frequency-khz", "float", "float", None, "kHz", 500, 10_000),
]

#: Setting, channel, register or address, highest bit, lowest bit, width, default, value. 37 + 2 - 1 = 38 data bits.
DSPIC33A_SETTINGS: list[Row] = [
    ("SCDENx", 6, 6, 1, 0, 1),
    ("SCDLENx", 5, 0, 6, 0, 38),
    ("CRCSELx", 15, 15, 1, 0, 0),
    ("CRCLENx", 14, 8, 7, 0, 6),
    ("CRCSEEDx", 31, 16, 16, 0, 0),
    ("GRAYx", 7, 7, 1, 0, 0),
]
DSPIC33A: list[Row] = []
for client in (0, 1, 2, 3):
    DSPIC33A += [(name, f"client {client}", f"B1CLTCON{client}", *facts) for name, *facts in DSPIC33A_SETTINGS]
IC_MB3_SETTINGS: list[Row] = [
    ("SDLEN", 192, 5, 0, 6, None, 38),
    ("ENSENS", 192, 6, 6, 1, None, 1),
    ("ACTnSENS", 192, 7, 7, 1, None, 0),
    ("SENSCRCPOLY", 193, 6, 0, 7, None, 0x21),
    ("INVCRCS", 193, 7, 7, 1, None, 1),
    ("GRAY", 194, 7, 7, 1, None, 0),
]
IC_MB3: list[Row] = []
for slave in (1, 2, 3):
    offset = 4 * (slave - 1)
    IC_MB3 += [(name, f"slave {slave}", address + offset, *facts) for name, address, *facts in IC_MB3_SETTINGS]


def places_of(settings_sheet: SettingsSheet) -> Iterator[tuple[Setting, SettingPlace]]:
    for setting in settings_sheet.settings:
        for place in setting.places:
            yield setting, place


def object_row(setting: Setting, place: SettingPlace) -> Row:
    address = (setting.name, place.device, place.channel, place.index, place.subindex)
    return (*address, place.type, place.kind, place.bits, place.unit, place.default, setting.value)


def symbol_row(setting: Setting, place: SettingPlace) -> Row:
    address = (setting.name, place.channel, place.symbol)
    return (*address, place.type, place.kind, place.bits, place.unit, place.default, setting.value)


def register_row(setting: Setting, place: SettingPlace) -> Row:
    address = (setting.name, place.channel, place.register or place.address)
    return (*address, place.high_bit, place.low_bit, place.bits, place.default, setting.value)


def objects(settings_sheet: SettingsSheet, device: str) -> list[Row]:
    return [object_row(setting, place) for setting, place in places_of(settings_sheet) if place.device == device]


def symbols(settings_sheet: SettingsSheet, _: str) -> list[Row]:
    return [symbol_row(setting, place) for setting, place in places_of(settings_sheet)]


def registers(settings_sheet: SettingsSheet, device: str) -> list[Row]:
    rows: list[Row] = []
    for setting, place in places_of(settings_sheet):
        has_value = place.high_bit is not None and setting.value is not None
        if place.device == device and has_value:
            rows.append(register_row(setting, place))
    return rows


#: Master, device, reader of its places, expected rows.
TYPED = [
    ("beckhoff_el5042", "EL5042", objects, [*EL5042, SUPPLY]),
    ("beckhoff_el5042", "EJ5042", objects, EJ5042),
    ("kollmorgen_akd2g", "AKD2G", objects, AKD2G),
    ("kollmorgen_akd", "Kollmorgen AKD", objects, AKD),
    ("moteus", "moteus", symbols, MOTEUS),
    ("linuxcnc_hostmot2", "", symbols, HOSTMOT2),
    ("microchip_dspic33a", "dsPIC33A", registers, DSPIC33A),
    ("ic_mb", "iC-MB3", registers, IC_MB3),
]
Reader = Callable[[SettingsSheet, str], list[Row]]


@pytest.mark.parametrize(("master", "device", "read", "rows"), TYPED)
def test_as_typed(sheet_of: SheetOf, master: str, device: str, read: Reader, rows: list[Row]) -> None:
    placed_rows = read(sheet_of(master, CODE), device)
    assert sorted(placed_rows, key=repr) == sorted(rows, key=repr)


def test_default_of_ej5042_clocks(sheet_of: SheetOf) -> None:
    """The page of the EJ5042 has no clock of 1 MHz, so its setting has a place on this module alone."""
    settings_sheet = sheet_of("beckhoff_el5042", "SMA21-GG1-0010")
    clock = next(setting for setting in settings_sheet.settings if setting.name == "Clock Frequency, EJ5042")
    assert {place.device for place in clock.places} == {"EJ5042"}


#: A mistake in the description of a master: key of a place and wrong content, or key of a setting.
MISTAKES = [
    ("beckhoff_el5042", "CRC Polynomial", "index", [0x8009, 0x8018]),
    ("beckhoff_el5042", "CRC Polynomial", "subindex", 0x12),
    ("beckhoff_el5042", "CRC Polynomial", "type", "UINT16"),
    ("beckhoff_el5042", "CRC Polynomial", "value", "crc_polynomial_without_top_bit"),
    ("kollmorgen_akd2g", "FB#.MULTITURNBITS", "index", [0x3500, 0x3501, 0x3502, 0x3503, 0x3505]),
    ("kollmorgen_akd2g", "FB#.MULTITURNBITS", "subindex", 0x0D),
    ("kollmorgen_akd2g", "FB#.MULTITURNBITS", "type", "Unsigned16"),
    ("kollmorgen_akd2g", "FB#.MULTITURNBITS", "value", "singleturn_bits"),
    ("moteus", "aux[12].bissc.data_bits", "symbol", ["aux1.bissc.data_bits", "aux1.bissc.data_bits"]),
    ("moteus", "aux[12].bissc.data_bits", "type", "uint16_t"),
    ("moteus", "aux[12].bissc.data_bits", "value", "data_and_status_bits"),
    ("linuxcnc_hostmot2", "frequency-khz", "symbol", "hm2_XXXX.N.{interface}.MM.frequency"),
    ("linuxcnc_hostmot2", "frequency-khz", "type", "UINT32"),
    ("linuxcnc_hostmot2", "frequency-khz", "default", 1000),
    ("linuxcnc_hostmot2", "frequency-khz", "any_clock", {"unit": "Hz"}),
    ("microchip_dspic33a", "CRCLENx", "register", ["B1CLTCON0", "B1CLTCON1", "B1CLTCON2", "B1CTRLCON"]),
    ("microchip_dspic33a", "CRCLENx", "at", "13:8"),
    ("microchip_dspic33a", "SCDLENx", "value", "data_and_status_bits"),
    ("ic_mb", "SENSCRCPOLY", "address", [193, 197, 202]),
    ("ic_mb", "SENSCRCPOLY", "at", "7:0"),
    ("ic_mb", "SDLEN", "value", "data_and_status_bits"),
]


@pytest.mark.parametrize(("master", "setting", "key", "wrong_value"), MISTAKES)
def test_a_planted_mistake_is_seen(
    masters: dict[str, Master], record_of: RecordOf, master: str, setting: str, key: str, wrong_value: Any
) -> None:
    settings = deepcopy(masters[master].settings)
    (planted, *_) = [mapping for mapping in settings if mapping["name"] == setting]
    place = planted["places"][0]
    owner: Any = place if key in place else planted
    assert owner[key] != wrong_value
    owner[key] = wrong_value
    spoilt = sheet(replace(masters[master], settings=settings), record_of(CODE))
    typed = [(read(spoilt, device), rows) for name, device, read, rows in TYPED if name == master]
    assert any(sorted(spoilt_rows, key=repr) != sorted(rows, key=repr) for spoilt_rows, rows in typed)


def _all_settings(masters: Mapping[str, Master]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for master in masters.values():
        for setting in master.settings:
            yield master.name, setting


def test_a_place_agrees_with_the_notation_of_its_document(masters: dict[str, Master]) -> None:
    """80p8:15, 32EF:0C, 0x2110:10 (decimal), 3500h:06 and 5005 hex repeat the index and subindex of the first place."""
    for name, setting in _all_settings(masters):
        place, at = setting["places"][0], setting.get("at", "")
        if "index" not in place:
            continue
        index = place["index"][0] if isinstance(place["index"], list) else place["index"]
        head, _, tail = at.replace("0x", "").replace("h:", ":").replace(" hex", "").partition(":")
        assert head.replace("p", "0").replace("n", "0").upper() == f"{index:04X}", (name, setting["name"])
        if tail:
            assert int(tail, 10 if name == "synapticon" else 16) == place["subindex"], (name, setting["name"])


def test_an_unknown_width_is_said(sheet_of: SheetOf) -> None:
    """The page on object 32EF:0C was not available, and the pages of the TM PosInput show no data record."""
    (crc,) = [setting for setting in sheet_of("beckhoff_ax8000", CODE).settings if setting.name == "CRC polynome"]
    assert {(place.type, place.kind, place.bits, place.default) for place in crc.places} == {("", "", None, None)}
    length = sheet_of("siemens_posinput", "AM3616/4096-BG").settings[0]
    assert [(place.location, place.type) for place in length.places] == [("", "")]


def test_a_value_that_does_not_fit_is_a_refusal(masters: dict[str, Master], record_of: RecordOf) -> None:
    """Multiturn [Bit] of the EL5042 has 8 bits, and FB#.MULTITURNBITS is at most 32."""
    record = record_of(CODE)
    wide = replace(record, numbers={**record.numbers, "multiturn_bits": 256, "data_bits": 64})
    reasons = [refusal.reason for refusal in sheet(masters["beckhoff_el5042"], wide).refusals]
    assert reasons == ["Multiturn [Bit] would be 256, but it is at most 255."]


def test_code_word_before_the_supply(sheet_of: SheetOf) -> None:
    """F008:00 is UINT32, and it is on the EL5042 and the EP7041-4032 only."""
    needs = [write for rule in sheet_of("beckhoff_el5042", CODE).writing for write in rule.needs]
    assert [(place.device, place.index, place.subindex, place.bits) for write in needs for place in write.places] == [
        ("EL5042", 0xF008, 0, 32),
        ("EP7041-4032", 0xF008, 0, 32),
    ]


def test_order(sheet_of: SheetOf) -> None:
    """SCDENx comes first in the description, but after SCDLENx, CRCSELx and CRCLENx in the text."""
    settings_sheet = sheet_of("microchip_dspic33a", CODE)
    names = [setting.name for setting in settings_sheet.settings]
    assert names[0] == "SCDENx"
    assert write_order(names, settings_sheet.writing) == (
        *("SCDLENx", "CRCSELx", "CRCLENx", "SCDENx"),
        *("CRCSEEDx", "GRAYx", "SFREQ"),
    )


def test_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["master", CODE, "--master", "moteus", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)["masters"][0]
    rate = next(setting for setting in data["settings"] if setting["name"] == "aux[12].bissc.rate_hz")
    assert rate["places"][1] == {
        "device": "moteus",
        "channel": "aux2",
        "index": None,
        "subindex": None,
        "symbol": "aux2.bissc.rate_hz",
        "register": "",
        "address": None,
        "high_bit": None,
        "low_bit": None,
        "type": "uint32_t",
        "kind": "unsigned",
        "bits": 32,
        "minimum": None,
        "maximum": None,
        "unit": "Hz",
        "default": 1_000_000,
        "is_default": True,
        "standing": "documented",
        "source": "aux: BissC",
    }
    assert data["write_order"] == [setting["name"] for setting in data["settings"]]


def test_as_text(capsys: pytest.CaptureFixture[str], pages: dict[str, str]) -> None:
    assert main(["master", CODE, "--master", "beckhoff_el5042"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "EJ5042: 0x8008:11 (channel 1), 0x8018:11 (channel 2), INT64, factory default 0x43, leave it [ej5042]" in out
    assert "EP7041-4032: 0x8008:17, unit bits, data type and factory default not given [ep7041_objects]" in out
    assert "F008 (Code word): EL5042, EP7041-4032: 0xF008:00, UINT32, factory default 0x00 * [profile, supply]" in out
    assert "Parameters that `--master beckhoff_el5042` prints: Mode · " in pages["docs/amm5-biss-masters.md"]
    assert "0x8008:11" not in pages["docs/amm5-biss-masters.md"], "places are on the settings page and in the command"


def test_every_setting_has_places(masters: dict[str, Master], sheet_of: SheetOf) -> None:
    settings: list[Setting] = [setting for name in masters for setting in sheet_of(name, CODE).settings]
    assert settings
    assert all(setting.places for setting in settings)
