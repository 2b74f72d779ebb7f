"""The headers as their reader has them: formatted like code, and every fact of the manual under its own name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest
from c_harness import FAMILIES, text_of, write
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.comments import in_comment
from codewheel.targets.c.files import generate
from exhaustive import mostly_exhaustive

#: Maximum distance of a value from the manual's name, in lines. It is one screen.
_NEAR = 20

#: Names as the manuals print them, and the contents of their tables: address, bit, value, limit or time.
#: AM36 4.4, 6.5, 6.6; AMM5 5.3, 6.4, 6.5, 7.1 to 7.5; ASC85 6.4, 6.5; SMA21 6.3 to 6.5, 7.3.
#: A bit without its own constant is in the table of its frame.
PRINTED = {
    "am36": {
        "Command": "_ADDRESS 0x48U",
        "Normal operational state": "= 0x00,",
        "Save parameters on EEPROM": "= 0x01,",
        "Save parameters and activate Preset": "= 0x02,",
        "Load and save default parameters": "= 0x04",
        "Configuration": "_DEFAULT 0x20U",
        "Information per revolution": "4Bh to 4Dh, read and write",
        "Number of revolutions": "4Eh to 4Fh, read and write",
        "bits used for singleturn resolution": "_DEFAULT 0x14U",
        "bits used for multiturn resolution": "_DEFAULT 0x10U",
        "Device type": "_DEFAULT 0x02U",
        "Timeout": "_AT_MOST_NS 10000U",
        "Clock": "BISS_CLOCK_MAX_HZ 10000000U",
    },
    "amm5": {
        "Preset setting enable": "_ADDRESS 0x40U",
        "Save parameters": "= 0x01,",
        "Activate Preset": "= 0x02",
        "EEPROM": "_AT_LEAST_US 30000U",
        "Data ID 8": "0xC2U",
        "Data ID D": "0xEAU",
        "Data ID 3": "0x1AU",
        "ENID": "The value 23h",
        "PS error": "_MASK 0x20U",
        "ST error": "_MASK 0x04U",
        "BUSY flag": "_BUSY_MASK 0x02U",
        "Battery alarm": "_BELOW_MV 3150U",
        "MT error": "_BELOW_MV 3050U",
        "Tp": "_AT_LEAST_US 20U",
        "Baud rate": "2500000U",
        "Data bits": "8U",
        "Parity": "'N'",
        "Stop bit": "1U",
        "MEM BUSY": "MEM BUSY in bit 0, as printed in the manual",
        "Serial number": "_ADDRESS 0x44U",
        "Manufacturer ID": "_ADDRESS 0x7EU",
    },
    "asc85": {
        "Diagnostic data": "_ADDRESS 0x5AU",
        "Request of new position data": "= 0x00,",
        "Write current configuration to EEPROM": "= 0x01,",
        "Trigger software reset": "= 0x03,",
        "Error simulation: delete Error message status": "= 0x06",
        "Internal data bus busy": "_POLL, LIKA_ASC85_BISS_REG_STATUS_ADDRESS, 0x04U",
        "Absolute data error": "_ERROR_MASK 0x40U",
        "Synchronization error": "_ERROR_MASK 0x08U",
        "Timeout": "350U",
        "Device ID": "_ADDRESS 0x78U",
        "Profile ID": "_DEFAULT 0x281AU",
    },
    "icmu": {
        "BANKSEL": "_ADDRESS 0x40U",
        "PROFILE_ID": "_ADDRESS 0x42U",
        "EVENT_COUNT": "_ADDRESS 0x73U",
        "CMD_MU": "_ADDRESS 0x75U",
        "DEV_ID": "_ADDRESS 0x78U",
        "MFG_ID": "_ADDRESS 0x7EU",
        "SOFT_E2P_PRES": "= 0x09,",
        "STUP": "_MASK 0x10U",
        "CRC_ERR": "_MASK 0x80U",
        "Clock": "BISS_CLOCK_MAX_HZ 10000000U",
    },
    "sma21": {
        "Comando": "_ADDRESS 0x48U",
        "Salva e attiva Preset / Offset": "= 0x02,",
        "Carica e salva tutti i parametri di default": "= 0x04",
        "Configurazione": "_DEFAULT 0x20U",
        "Risoluzione assoluta": "_ADDRESS 0x4DU",
        "Tipo di dispositivo": "_DEFAULT 0x08U",
        "Risoluzione SENO-COSENO": "_ADDRESS 0x58U",
        "Controllo posizione": "_ADDRESS 0x59U",
        "ENID1": "Always 51h",
        "Low amplitude error": "_MASK 0x20U",
        "Overspeed": "_MASK 0x01U",
        "Data ID B": "0xDAU",
        "Data ID F": "0x7AU",
        "ID Profilo": "_ADDRESS 0x42U",
    },
}


def lines_around(text: str, name: str) -> list[str]:
    """Return each place of a name with the lines around it."""
    lines = text.splitlines()
    places = [index for index, line in enumerate(lines) if name.lower() in line.lower()]
    return ["\n".join(lines[max(index - _NEAR, 0) : index + _NEAR]) for index in places]


def _is_near(text: str, name: str, value: str) -> bool:
    return any(value in place for place in lines_around(text, name))


@pytest.mark.parametrize("family", FAMILIES)
def test_the_manuals_own_name_leads_to_the_value(family: str, include: Path) -> None:
    text = text_of(family, include)
    missing = {name: value for name, value in PRINTED[family].items() if not _is_near(text, name, value)}
    assert missing == {}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_exhaustive([*FAMILIES, "words", "bits22", "tv62"], "amm5", "words"))
def test_bodies_are_indented(name: str, every_device: Mapping[str, Device], tmp_path: Path) -> None:
    for path in write(tmp_path, (every_device[name],)).rglob("*.h"):
        inside = False
        for line in path.read_text(encoding="ascii").splitlines():
            if line in ("{", "}"):
                inside = line == "{"
            elif inside and line and not line.startswith("#"):
                assert line.startswith("    "), (path.name, line)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_exhaustive([*FAMILIES, "words", "bits22", "tv62"], "amm5", "words"))
def test_nothing_is_shifted_by_nothing_octal_or_left_to_precedence(
    name: str, every_device: Mapping[str, Device], tmp_path: Path
) -> None:
    for path in write(tmp_path, (every_device[name],)).rglob("*.h"):
        code = re.sub(r"/\*.*?\*/|\"[^\"]*\"", " ", path.read_text(encoding="ascii"), flags=re.DOTALL)
        assert re.findall(r"(?:<<|>>) 0U?\b.*", code) == []
        assert re.findall(r"(?<![\w.])0\d+U?\b", code) == []
        assert re.findall(r"[/%*] \w+ [/%].*", code) == []


def test_a_step_names_the_bit_that_it_looks_at(include: Path) -> None:
    """ASC85 6.4: command 02 sets the status bit 1 and the error bit 6, command 01 the status bit 2.
    SMA21 6.4: bits 2 and 1 of the configuration."""
    text = text_of("asc85", include)
    assert "_STATUS_ADDRESS 0x60U" in text
    assert "_ERROR_REGISTER_ADDRESS 0x69U" in text
    assert re.search(r"/\* Absolute data valid: [^/]+\*/\n +\{ CW_STEP_POLL, \w+_STATUS_ADDRESS, 0x02U, 0x02U,", text)
    assert re.search(r"/\* Absolute data error: [^/]+\*/\n +\{ CW_STEP_READ, \w+_ERROR_REGISTER_ADDRESS,", text)
    assert re.search(
        r"/\* Internal data bus busy: [^/]+\*/\n +\{ CW_STEP_POLL, \w+_STATUS_ADDRESS, 0x04U, 0x00U,", text
    )
    assert "/** Absolute data error in Error register: " in text
    text = text_of("sma21", include)
    assert "_CONFIGURATION_ADDRESS 0x49U" in text
    assert re.search(
        r"/\* Enable preset offset in Configuration: enable \*/\n +\{ CW_STEP_WRITE, \w+_ADDRESS, 0x04U, 0x00U,",
        text,
    )
    assert re.search(
        r"/\* Select preset offset in Configuration: preset \*/\n +\{ CW_STEP_WRITE, \w+_ADDRESS, 0x02U, 0x00U,",
        text,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("names", "present", "absent"), [
    (["amm5"], ["`LIKA_CRC_TABLE`"], ["_CRC_BITWISE"]),
    (["words"], ["`TEST_CRC_TABLE`", "`TEST_CRC_BITWISE`"], ["LIKA_"]),
    (["amm5", "words"], ["`LIKA_CRC_TABLE` or `TEST_CRC_TABLE`", "`TEST_CRC_BITWISE`"], ["LIKA_CRC_BITWISE"]),
])  # fmt: skip
def test_the_readme_names_the_macros_that_there_are(
    names: list[str], present: list[str], absent: list[str], every_device: Mapping[str, Device]
) -> None:
    files = generate(Library(tuple(every_device[name] for name in names)))
    readme = files["c/README.md"]
    assert [name for name in present if name not in readme] == []
    assert [name for name in absent if name in readme] == []
    headers = "".join(text for path, text in files.items() if path.endswith(".h"))
    assert all(macro in headers for macro in re.findall(r"`(\w+_CRC_\w+)`", readme))


#: Bytes of the word with the position over SPI, as the data sheets have them. They are counted by hand.
SPI_WORD_BYTES = {
    "ma600": 2,  # an angle of 16 bits in 16 clocks
    "as5047p": 2,  # parity, error and 14 bits of the angle
    "amt22": 2,  # two check bits and 14 bits of the position
    "mt6835": 6,  # two bytes of the request, 21 bits of the angle, 3 bits of the status, and 8 bits of the CRC
    "tle5012b": 6,  # three words of 16 bits: the command, the angle and the safety word
    "mlx90363": 8,  # messages of 64 bits
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SPI_WORD_BYTES)
def test_the_buffer_of_an_spi_word_in_the_readme_has_its_bytes(name: str, every_encoder: Library) -> None:
    device = next(device for device in every_encoder.devices if device.name == name)
    readme = generate(Library((device,)))["c/README.md"]
    buffers = re.findall(r"^static uint8_t spi_rx\[(\w+)\];", readme, re.MULTILINE)
    assert buffers == [str(SPI_WORD_BYTES[name])]


@pytest.mark.slow
def test_the_readme_tells_the_stack_of_the_longest_procedure(c_devices: tuple[Device, ...]) -> None:
    # AM36 set_resolution: 3 + 2 register bytes, which are read back, save, wait, open, 5 preset bytes, which are read
    # back with the byte that opens, activate, wait, 2 readings.
    assert "at most 28 (`lika_am36_biss_set_resolution`)" in generate(Library(c_devices))["c/README.md"]


@pytest.mark.slow
def test_an_erratum_says_what_is_used(c_devices: tuple[Device, ...]) -> None:
    """The whole text is on the page of the encoder. If wrong data could be sent, the header has all that is used."""
    files = generate(Library(c_devices))
    for device in c_devices:
        stem = f"c/include/{FAMILIES[device.name]}/{device.name}_"
        text = "".join(text for path, text in files.items() if path.startswith(stem))
        header = " ".join(text.replace("\n *", "\n").split())
        mentioned = [erratum for erratum in device.errata if f"Erratum: {erratum.title} (" in header]
        assert len(mentioned) > (5 if device.evidence.grade == "manual" else 0)
        for erratum in mentioned:
            assert in_comment(erratum.printed) not in header
            used = in_comment(erratum.used)
            if erratum.severity != "wrong_data" or erratum.status != "open":
                used = used.partition(". ")[0]
            assert f"). Used: {used}" in header, erratum.name


@pytest.mark.slow
def test_an_erratum_says_what_is_used_where_data_is_at_stake(c_devices: tuple[Device, ...]) -> None:
    """An AMM5 EEPROM write with the address at another encoder's position hits another address.

    The functions say so.
    """
    header = " ".join(generate(Library(c_devices))["c/include/lika/amm5_rs485.h"].replace("\n *", "\n").split())
    for name in ("EEPROM_WRITE_REQUEST", "EEPROM_READ_REQUEST"):
        before = header.partition(f"typedef struct lika_amm5_rs485_{name.lower()} ")[0].rpartition("/*")[2]
        assert "Used: Either position is possible. The user must choose, and there is no default" in before
        assert "a write overwrites other data" in before
