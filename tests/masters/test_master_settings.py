"""Settings of masters, computed on paper: frames from the encoders' manuals, rules from the masters' documents.

The frames, first bit sent first:

=====================  ==================================================================  ======================
SMA21-SC1-0002         position 24, nE, nW, CRC 6                                          6.2, bits 31 to 8
SMA21-SC1-0050         the same 24 bits, of which the lowest 20 are the position           6.2 and 6.6.1, right aligned
SMA21-SC1-0001         position 25, nE, nW, CRC 6                                          6.2, bits 32 to 8
SMA21-GG1-0010         SSI: position 22 in Gray code, error bit 1                          5.2
AMM5A17/1SC1           position 17, nE, nW, CRC 6                                          6.2, bits n + 7 to 8
AMM5A23/65KSC1         turns 16, position 23, nE, nW, CRC 6                                6.2, bits n + 7 to 8, n = 39
AMM5A21/65KBG1         SSI: turns 16, position 21, binary                                  5.2
AM3616/4096-I7         turns 16, position 20 by default (57h = 10h, 56h = 14h), 1, 1, CRC 6      6.2, bits 43 to 8
AM3619/4096-GG         SSI: turns 12, position 19, in Gray code as one word                5.2
ASC8525/SC1            position 25, one zero bit, nE, nW, CRC 6                            6.2, bits n + 8 to 9, n = 25
=====================  ==================================================================  ======================

All of BiSS: CRC x^6 + x + 1, sent inverted, start 0. Its polynomial is 100 0011 in binary, 0x43 or 67;
without its top bit 00 0011, 0x03; without its last 1 10 0001, 0x21.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from codewheel.masters.sheet import SettingsSheet

ValuesOf = Callable[[str, str], dict[str, Any]]

# Beckhoff: bits as they are; zero bits on the right are "Offset LSB"; clock 0 is 10 MHz, 9 is 1 MHz, 4 is 2 MHz,
# the most for SSI. The EJ5042 has 0, 2, 3, 17 (500 kHz) and 19 only.
BECKHOFF_BISS = {"Mode": 0, "Disable Status Bits": False, "CRC Invert": True, "CRC Polynomial": 0x43, "Coding": 0}
BECKHOFF_CLOCKS = {"Clock Frequency, EL5042 and EP7041-4032": 0, "Clock Frequency, EJ5042": 0}
BECKHOFF_SSI = {"Mode": 1, "Disable Status Bits": True, "CRC Polynomial": 0}


@pytest.mark.parametrize(
    ("code", "multiturn", "singleturn", "offset"),
    [
        ("SMA21-SC1-0002", 0, 24, 0),
        ("SMA21-SC1-0050", 0, 24, 0),  # 4 zero bits and 20: the terminal reads 24 bits, whose upper 4 are 0
        ("SMA21-SC1-0001", 0, 25, 0),
        ("AMM5A17/1SC1", 0, 17, 0),
        ("AMM5A23/65KSC1", 16, 23, 0),
        ("AM3616/4096-I7", 16, 20, 0),  # not the 12 and 16 of the order code
        ("ASC8525/SC1 as_printed", 0, 25, 1),
        ("ASC8525/SC1 left_out", 0, 25, 0),
    ],
)
def test_beckhoff_biss(values_of: ValuesOf, code: str, multiturn: int, singleturn: int, offset: int) -> None:
    bits = {"Multiturn [Bit]": multiturn, "Singleturn [Bit]": singleturn, "Offset LSB Bit [Bit]": offset}
    # AM36 needs at least 10 V. All other encoders here use 5 V.
    supply = {} if code.startswith("AM36") else {"Supply Voltage": 50}
    assert values_of("beckhoff_el5042", code) == {**BECKHOFF_BISS, **BECKHOFF_CLOCKS, **bits, **supply}


@pytest.mark.parametrize(
    ("code", "coding", "clock", "multiturn", "singleturn", "offset"),
    [
        ("SMA21-GG1-0010", 1, 9, 0, 22, 1),  # 1 MHz at most. The error bit after the position is masked out.
        ("AMM5A21/65KBG1", 0, 4, 16, 21, 0),  # 4 MHz at most, of which the terminal has 2
        ("AM3619/4096-GG", 1, 4, 12, 19, 0),  # 3 MHz at most
    ],
)
def test_beckhoff_ssi(
    values_of: ValuesOf, code: str, coding: int, clock: int, multiturn: int, singleturn: int, offset: int
) -> None:
    bits = {
        "Coding": coding,
        "Multiturn [Bit]": multiturn,
        "Singleturn [Bit]": singleturn,
        "Offset LSB Bit [Bit]": offset,
    }
    clocks = {"Clock Frequency, EL5042 and EP7041-4032": clock, "Clock Frequency, EJ5042": 17}
    supply = {} if code.startswith("AM36") else {"Supply Voltage": 50}
    assert values_of("beckhoff_el5042", code) == {**BECKHOFF_SSI, **bits, **clocks, **supply}


def test_beckhoff_supply(sheet_of: Callable[[str, str], SettingsSheet]) -> None:
    """The terminals supply 5 V or 9 V: they cannot supply AM36, 10 V to 30 V.

    These terminals can supply SMA21-SC4, 5 V to 30 V, and ASC85/SC1, but not ASC85/SC2.
    """
    for code, is_fed in (
        ("AM3616/4096-I7", False),
        ("AM3619/4096-GG", False),
        ("SMA21-SC4-0050", True),
        ("ASC8525/SC1 as_printed", True),
        ("ASC8525/SC2 as_printed", False),
    ):
        settings_sheet = sheet_of("beckhoff_el5042", code)
        voltages = [setting.value for setting in settings_sheet.settings if setting.name == "Supply Voltage"]
        assert voltages == ([50] if is_fed else []), code
        assert any("which is not enough for this encoder" in note for note in settings_sheet.notes) is not is_fed, code
    # 32EF:02: 0 is 5 V, 2 is 11 V, which suits AM36.
    for code, value in (
        ("AM3616/4096-I7", 2),
        ("ASC8525/SC1 as_printed", 0),
        ("ASC8525/SC2 as_printed", 2),
        ("SMA21-SC4-0050", 0),
    ):
        settings = sheet_of("beckhoff_ax8000", code).settings
        assert [setting.value for setting in settings if setting.name == "Power supply"] == [value], code


# iC-MB: SDLEN is data and status bits less 1. 24 + 2 - 1 = 25, 25 + 2 - 1 = 26, 17 + 2 - 1 = 18, 39 + 2 - 1 = 40,
# 36 + 2 - 1 = 37, 26 + 2 - 1 = 27.
@pytest.mark.parametrize(
    ("code", "sdlen"),
    [
        ("SMA21-SC1-0002", 25),
        ("SMA21-SC1-0050", 25),
        ("SMA21-SC1-0001", 26),
        ("AMM5A17/1SC1", 18),
        ("AMM5A23/65KSC1", 40),
        ("AM3616/4096-I7", 37),
        ("ASC8525/SC1 as_printed", 27),
    ],
)
def test_ic_mb(values_of: ValuesOf, code: str, sdlen: int) -> None:
    expected = {
        "SDLEN": sdlen,
        "ENSENS": 1,
        "ACTnSENS": 0,
        "SENSCRCPOLY": 0x21,
        "INVCRCS": 1,
        "GRAY": 0,
        "CRC start value": 0,
        "Clock": None,
    }
    assert values_of("ic_mb", code) == expected


# TI: neither status bits nor CRC count. Zero bits beside the position belong to it: 4 + 20 = 24, 25 + 1 = 26.
@pytest.mark.parametrize(
    ("code", "multi", "single"),
    [
        ("SMA21-SC1-0002", 0, 24),
        ("SMA21-SC1-0050", 0, 24),
        ("SMA21-SC1-0001", 0, 25),
        ("AMM5A17/1SC1", 0, 17),
        ("AMM5A23/65KSC1", 16, 23),
        ("AM3616/4096-I7", 16, 20),
        ("ASC8525/SC1 as_printed", 0, 26),
    ],
)
def test_ti(values_of: ValuesOf, code: str, multi: int, single: int) -> None:
    assert values_of("ti_motor_control_sdk", code) == {
        "multi_turn_len": multi,
        "single_turn_len": single,
        "Clock, in MHz": 10,
    }
    expected = {
        "crcBits": 6,
        "crcPoly": 0x03,
        "crcStart": 0,
        "positionMTBits": multi,
        "positionSTBits": single,
        "freqDiv": None,
    }
    assert values_of("ti_c2000", code) == expected


# hostmot2: from the last bit of the frame to the first, every bit named, at most 32 in one field;
# g for Gray, m for turns, l and h for a split position.
@pytest.mark.parametrize(
    ("code", "text", "kilohertz"),
    [
        ("SMA21-SC1-0002", "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%24e", 10000),
        ("SMA21-SC1-0050", "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%20epadding%4p", 10000),
        ("SMA21-SC1-0001", "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%25e", 10000),
        ("SMA21-GG1-0010", "ssi_chan_0=nerror%1bposition%22ge", 1000),
        ("AMM5A17/1SC1", "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%17e", 10000),
        ("AMM5A23/65KSC1", "biss_chan_0=crc%6pnwarning%1bnerror%1bpositionlow%23lposition%16mh", 10000),
        ("AMM5A21/65KBG1", "ssi_chan_0=positionlow%21lposition%16mh", 4000),
        ("AM3616/4096-I7", "biss_chan_0=crc%6pnwarning%1bnerror%1bpositionlow%20lposition%16mh", 10000),
        ("AM3619/4096-GG", "ssi_chan_0=position%31gme", 3000),
        ("ASC8525/SC1 left_out", "biss_chan_0=crc%6pnwarning%1bnerror%1bposition%25e", 10000),
        ("ASC8525/SC1 as_printed", "biss_chan_0=crc%6pnwarning%1bnerror%1bzero%1pposition%25e", 10000),
        ("ASC8520/GG1", "ssi_chan_0=position%20ge", 4000),
    ],
)
def test_hostmot2(values_of: ValuesOf, code: str, text: str, kilohertz: int) -> None:
    assert values_of("linuxcnc_hostmot2", code) == {text.partition("=")[0]: text, "frequency-khz": kilohertz}


# Novanta: kbit/s; the frame size counts everything, 24 + 2 + 6 = 32, 25 + 1 + 2 + 6 = 34;
# the position starts at frame size less position bits.
@pytest.mark.parametrize(
    ("code", "size", "position", "single", "start"),
    [
        ("SMA21-SC1-0002", 32, 24, 24, 8),
        ("SMA21-SC1-0050", 32, 24, 24, 8),
        ("AMM5A23/65KSC1", 47, 39, 23, 8),
        ("ASC8525/SC1 as_printed", 34, 25, 25, 9),
    ],
)
def test_novanta(values_of: ValuesOf, code: str, size: int, position: int, single: int, start: int) -> None:
    expected = {
        "Frame size": size,
        "Frame type": 3,
        "Position bits": position,
        "Single-turn bits": single,
        "Position start bit": start,
    }
    # There are no settings for CRC and Gray code, which are not in the document.
    assert values_of("novanta", code) == {**expected, "Protocol": 0, "Baud rate": 10_000, "Wait cycles": 0}


@pytest.mark.parametrize(
    ("master", "code", "expected"),
    [
        # 24 + 2 bits, less 1 as in the code example, and 29 for 28 + 2. The length 6 selects the polynomial.
        (
            "microchip_dspic33a",
            "SMA21-SC1-0002",
            {"SCDENx": 1, "SCDLENx": 25, "CRCSELx": 0, "CRCLENx": 6, "CRCSEEDx": 0, "GRAYx": 0, "SFREQ": None},
        ),
        (
            "moteus",
            "AMM5A23/65KSC1",
            {
                "aux[12].bissc.enabled": 1,
                "aux[12].bissc.rate_hz": 1_000_000,
                "aux[12].bissc.data_bits": 39,
                "aux[12].bissc.crc_bits": 6,
            },
        ),
        # Payload 4 + 20. The position begins after 4 bits. 67 is 0x43.
        (
            "synapticon",
            "SMA21-SC1-0050",
            {
                "Frame size": 24,
                "Multiturn bits": 0,
                "Singleturn bits": 20,
                "Singleturn first bit position": 4,
                "CRC polynomial": 67,
            },
        ),
        (
            "synapticon",
            "SMA21-SC1-0050",
            {"Timeout, in µs": 16, "Maximum tbusy, in µs": None, "Status bits active value": 0},
        ),
        (
            "synapticon",
            "AMM5A23/65KSC1",
            {"Frame size": 39, "Multiturn first bit position": 0, "Singleturn first bit position": 16},
        ),
        # 1.5 periods of 50 kHz are 30 µs. ASC85 prints a timeout for 10 MHz alone.
        ("synapticon", "AMM5A23/65KSC1", {"Timeout, in µs": 30}),
        (
            "synapticon",
            "ASC8525/SC1 as_printed",
            {"Timeout, in µs": None, "Frame size": 26, "Singleturn bits": 25},
        ),
        # SSI: the whole frame, 22 + 1, and a pause of 16 µs.
        (
            "synapticon",
            "SMA21-GG1-0010",
            {"Frame size": 23, "Singleturn bits": 22, "Timeout, in µs": 16, "Data ordering": 1, "Parity type": 0},
        ),
        # The table of the document: Lika SMA2-SC1-1-L5 has 24 and 256 = 2^(32 - 24); rotary encoders 4294967295;
        # 12 turn bits 1048576 = 2^(32 - 12).
        (
            "kollmorgen_akd",
            "SMA21-SC1-0002",
            {"FB1.SELECT": 34, "FB1.BISSBITS": 24, "FB1.ENCRES": "(pole pitch / 2 µm) * 2^(32 - 24)"},
        ),
        ("kollmorgen_akd", "AMM5A17/1SC1", {"FB1.SELECT": 34, "FB1.BISSBITS": 17, "FB1.ENCRES": 4294967295}),
        ("kollmorgen_akd", "AMM5A23/65KSC1", {"FB1.BISSBITS": 39, "FB1.ENCRES": 65536}),
        # FB#.BITS is for linear encoders only, FB#.MULTITURNBITS for rotary ones.
        ("kollmorgen_akd2g", "AMM5A23/65KSC1", {"FB#.BITS": None, "FB#.MULTITURNBITS": 16}),
        ("kollmorgen_akd2g", "SMA21-SC1-0050", {"FB#.BITS": 24, "FB#.MULTITURNBITS": None}),
        (
            "keb_f5",
            "AMM5A23/65KSC1",
            {"inc/r": 2048, "Singleturn resolution": 23, "Multiturn resolution": 16, "Data code": "binary"},
        ),
        (
            "keb_f6",
            "AM3619/4096-GG",
            {
                "Singleturn resolution": 19,
                "Multiturn resolution": 12,
                "SSI data format": "24 (serial right-justified, Gray, no PFB)",
            },
        ),
        # BiSS: the same two numbers, and none of the two of SSI.
        (
            "keb_f6",
            "AM3616/4096-I7",
            {"Singleturn resolution": 20, "Multiturn resolution": 16, "SSI data format": None, "SSI clock freq.": None},
        ),
        # 2^20 steps, 65536 turns, no fill bits. A linear encoder has 4 on the left, ASC85 1 on the right.
        (
            "beckhoff_ax8000",
            "AM3616/4096-I7",
            {
                "Measuring steps per revolution": 1048576,
                "Number of distinguishable revolutions": 65536,
                "Fill bit count left": 0,
            },
        ),
        (
            "beckhoff_ax8000",
            "SMA21-SC1-0050",
            {
                "Measuring step length": 50_000_000,
                "Position bit count": 20,
                "Fill bit count left": 4,
                "Fill bit count right": 0,
            },
        ),
        (
            "beckhoff_ax8000",
            "ASC8525/SC1 as_printed",
            {
                "Measuring steps per revolution": 33554432,
                "Fill bit count right": 1,
                "CRC polynome": 0x43,
                "CRC data inverted": True,
            },
        ),
        # Total 23, of which one status bit after the data; 25 MHz / (2 * 13) = 961.5 kHz is the fastest below 1 MHz,
        # 27 MHz / (2 * 14) = 964.3 kHz.
        (
            "galil_ssi",
            "SMA21-GG1-0010",
            {"si0": 1, "si1": 23, "si2": 22, "si3": 1, "p (Optima, Econo)": 12, "p (Accelera)": 13, "q": 2},
        ),
        ("galil_ssi", "AMM5A21/65KBG1", {"si1": 37, "si2": 21, "si3": 0, "q": 1}),
        # Bit 0 is the first: 22 bits of position, then the error bit;
        # 12 + 19 = 31 bits, turns first. 1 MHz is 5, 2 MHz is 7.
        (
            "omron_nx",
            "SMA21-GG1-0010",
            {
                "Baud Rate": 5,
                "Valid Data Length": 23,
                "Single-turn Data Start Bit": 0,
                "Single-turn Data Length": 22,
                "Leading Bits": 0,
            },
        ),
        (
            "omron_nx",
            "SMA21-GG1-0010",
            {
                "Status Data Start Bit": 22,
                "Status Data Length": 1,
                "Coding Method": "gray code",
                "Encoder Resolution": 0,
            },
        ),
        (
            "omron_nx",
            "AM3619/4096-BG",
            {
                "Baud Rate": 7,
                "Valid Data Length": 31,
                "Multi-turn Data Start Bit": 0,
                "Multi-turn Data Length": 12,
                "Status Data Length": 0,
            },
        ),
        (
            "omron_nx",
            "AM3619/4096-BG",
            {"Single-turn Data Start Bit": 12, "Single-turn Data Length": 19, "Coding Method": "binary code"},
        ),
        # The position is above the error bit, bit 0: 1 to 22.
        (
            "siemens_posinput",
            "SMA21-GG1-0010",
            {
                "Frame length": 23,
                "Bit number of LSB of the position value": 1,
                "Bit number of MSB of the position value": 22,
            },
        ),
        ("siemens_posinput", "SMA21-GG1-0010", {"Code type": "Gray", "Parity": "none"}),
    ],
)
def test_other_masters(values_of: ValuesOf, master: str, code: str, expected: dict[str, Any]) -> None:
    settings = values_of(master, code)
    assert {name: settings.get(name) for name in expected} == expected


def test_example_of_siemens(values_of: ValuesOf) -> None:
    """13 + 12 bits in a frame of 25 have MSB 24 and LSB 0. 12 + 16 bits in one of 28 have 27 and 0."""
    settings = values_of("siemens_posinput", "AM3616/4096-BG")
    assert (
        settings["Frame length"],
        settings["Bit number of MSB of the position value"],
        settings["Bit number of LSB of the position value"],
    ) == (28, 27, 0)


@pytest.mark.parametrize(
    ("master", "code", "reason"),
    [
        ("galil_ssi", "SMA21-SC1-0002", "This master is described for SSI only, but SMA21-SC1-0002 has BiSS C-mode."),
        ("ic_mb", "SMA21-GG1-0010", "This master is described for BiSS C-mode only, but SMA21-GG1-0010 has SSI."),
        (
            "keb_f5",
            "ASC8525/SC1 as_printed",
            (
                "The data word is | MT | ST | ERR | WARN | CRC |, without other bits. "
                "This encoder has 1 zero bit after the position."
            ),
        ),
        (
            "keb_f6",
            "ASC8525/SC1 as_printed",
            (
                "The data word is | MT | ST | ERR | WARN | CRC |, without other bits. "
                "This encoder has 1 zero bit after the position."
            ),
        ),
        # 16 + 23 bits. 16 + 17 are one too many.
        (
            "omron_nx",
            "AMM5A23/65KBG1",
            "A frame has at most 32 data bits in total. This encoder sends frames of 39 bits.",
        ),
        (
            "omron_nx",
            "AMM5A17/65KBG1",
            "A frame has at most 32 data bits in total. This encoder sends frames of 33 bits.",
        ),
        (
            "keb_f5",
            "SMA21-SC1-0002",
            "The data word consists of the turns and the position within one turn. This encoder is linear.",
        ),
    ],
)
def test_refusals(sheet_of: Callable[[str, str], SettingsSheet], master: str, code: str, reason: str) -> None:
    settings_sheet = sheet_of(master, code)
    assert [refusal.reason for refusal in settings_sheet.refusals] == [reason]
    assert settings_sheet.settings == ()
    assert settings_sheet.notes == ()


def test_the_example_of_omron(values_of: ValuesOf) -> None:
    """p. 249, 12 bits of turns, 13 of one: valid 25, single-turn 12 and 13, multi-turn 0 and 12. Ours has 12 and 16."""
    settings = values_of("omron_nx", "AM3616/4096-BG")
    names = (
        "Valid Data Length",
        "Single-turn Data Start Bit",
        "Single-turn Data Length",
        "Multi-turn Data Start Bit",
        "Multi-turn Data Length",
    )
    assert tuple(settings[name] for name in names) == (28, 12, 16, 0, 12)


def test_registers_of_ic_mb3(sheet_of: Callable[[str, str], SettingsSheet]) -> None:
    notes = " ".join(sheet_of("ic_mb", "AMM5A17/1SC1").notes)
    assert "The iC-MB3 does not carry out a BiSS C register access by itself" in notes


def test_notes_follow_the_encoder(sheet_of: Callable[[str, str], SettingsSheet]) -> None:
    def notes(master: str, code: str) -> str:
        return " ".join(sheet_of(master, code).notes)

    assert "shifted to the left by 1" in notes("ti_motor_control_sdk", "ASC8525/SC1 as_printed")
    assert "zero bits" not in notes("ti_motor_control_sdk", "AMM5A17/1SC1")
    assert "converted as one word" in notes("omron_nx", "AM3619/4096-GG")
    assert "converted as one word" not in notes("omron_nx", "AMM5A21/65KBG1")
