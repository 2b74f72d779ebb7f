"""Files for masters: typed by hand for some order codes, and read back for all of them.

The expected values come from the documents of the masters and from the frames in ``test_master_settings.py``:
AMM5A21/65KSC1 sends 16 + 21 bits, error, warning and the CRC x^6 + x + 1, inverted, at up to 10 MHz.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from copy import deepcopy
from dataclasses import replace
from typing import Any

import file_readers as readers
import pytest
from codewheel.commands.cli import main
from codewheel.language.keys_of_masters import FILE_FORMATS
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.frame_parts import NoMasterSettings
from codewheel.masters.groups import facts_of_order_codes
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import Master, SettingsSheet, sheet
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.masters.contents import content_of_file
from codewheel.targets.masters.files import file_text, generate

Raw = Mapping[str, Any]
CODE = "AMM5A21/65KSC1"
FAMILY_BY_START = {"AMM5": "amm5", "AM36": "am36", "SMA21": "sma21"}

#: EL5042, channel 1, for CODE: index and subindex with value and size, from infosys el5042/4216721675.
EL5042: readers.Objects = {
    (0x8008, 0x18): (0, 1),
    (0x8008, 0x02): (0, 1),
    (0x8008, 0x03): (1, 1),
    (0x8008, 0x11): (0x43, 4),
    (0x8008, 0x13): (0, 1),
    (0x8008, 0x14): (0, 1),
    (0x8008, 0x15): (16, 1),
    (0x8008, 0x16): (21, 1),
    (0x8008, 0x17): (0, 1),
}
#: The EJ5042 has no supply voltage, and CRC Polynomial has 8 bytes: infosys ej5042/10839989899.
EJ5042: readers.Objects = {**EL5042, (0x8008, 0x11): (0x43, 8)}
#: The page of the EP7041-4032 gives no type for Mode and Offset LSB Bit.
EP7041: readers.Objects = {key: value for key, value in EL5042.items() if key[1] not in (0x17, 0x18)}
#: 32EF: 2^21 steps, 2^16 turns, layout 0, no fill bits, 10,000 kHz, inverted. The page of the polynomial has no type.
AX8000: readers.Objects = {
    (0x32EF, 0x02): (0, 4),
    (0x32EF, 0x03): (2097152, 8),
    (0x32EF, 0x04): (65536, 8),
    (0x32EF, 0x05): (0, 1),
    (0x32EF, 0x06): (0, 1),
    (0x32EF, 0x09): (10000, 2),
    (0x32EF, 0x0D): (1, 1),
}
#: 0x2110: 16 bits from bit 0, 21 bits from bit 16, timeout 30 µs, polynomial 67, active low. No page gives the type of
#: the frame size, and the manual of the encoder states no processing time.
SOMANET: readers.Objects = {
    (0x2110, 10): (16, 1),
    (0x2110, 11): (0, 1),
    (0x2110, 12): (21, 1),
    (0x2110, 13): (16, 1),
    (0x2110, 14): (30, 1),
    (0x2110, 15): (67, 1),
    (0x2110, 17): (0, 1),
}
SDO = ["ethercat_driver_ros2", "linuxcnc_ethercat", "ecmc", "twincat"]
OBJECTS = [
    ("beckhoff_el5042", "EL5042", EL5042),
    ("beckhoff_el5042", "EJ5042", EJ5042),
    ("beckhoff_el5042", "EP7041-4032", EP7041),
    ("beckhoff_ax8000", "AX8000", AX8000),
    ("synapticon", "SOMANET Circulo", SOMANET),
]

SheetOf = Callable[[str, str], SettingsSheet]
RecordOf = Callable[[str], EncoderFacts]
FileOf = Callable[..., str]


def format_names(master: Master) -> list[str]:
    return [rule["format"] for rule in master.files]


def rule_of(master: Master, name: str) -> Raw:
    return next(file_rule for file_rule in master.files if file_rule["format"] == name)


@pytest.fixture
def file_of(devices: Mapping[str, Device], sheet_of: SheetOf) -> FileOf:
    """Return the file of a master for an order code."""

    def written_file(
        master: str, name: str, code: str = CODE, on: str = "", settings_sheet: SettingsSheet | None = None
    ) -> str:
        settings_sheet = settings_sheet or sheet_of(master, code)
        rule = rule_of(settings_sheet.master, name)
        family = next(name for start, name in FAMILY_BY_START.items() if code.startswith(start))
        return file_text(
            devices[family],
            [code],
            settings_sheet,
            file_rule=rule,
            master_device=on or settings_sheet.devices_with(rule)[0],
        )

    return written_file


@pytest.mark.parametrize("name", SDO)
@pytest.mark.parametrize(("master", "on", "expected"), OBJECTS)
def test_objects_as_typed(file_of: FileOf, master: str, on: str, expected: readers.Objects, name: str) -> None:
    assert getattr(readers, name)(file_of(master, name, on=on)) == expected


#: EL5042 for a scale of 4 zeros and 20 bits with BiSS, and for a scale with SSI: 22 bits in Gray code and an error bit.
OTHERS = [
    ("SMA21-SC1-0050", {0x18: 0, 0x02: 0, 0x03: 1, 0x11: 0x43, 0x13: 0, 0x14: 0, 0x15: 0, 0x16: 24, 0x17: 0}),
    ("SMA21-GG1-0010", {0x18: 1, 0x02: 1, 0x11: 0, 0x13: 9, 0x14: 1, 0x15: 0, 0x16: 22, 0x17: 1}),
]


@pytest.mark.parametrize("name", SDO)
@pytest.mark.parametrize(("code", "expected"), OTHERS)
def test_other_encoders_as_typed(file_of: FileOf, code: str, expected: dict[int, int], name: str) -> None:
    objects = getattr(readers, name)(file_of("beckhoff_el5042", name, code))
    sizes = {subindex: 4 if subindex == 0x11 else 1 for subindex in expected}
    assert objects == {(0x8008, subindex): (value, sizes[subindex]) for subindex, value in expected.items()}


def test_the_second_channel_is_a_comment(file_of: FileOf) -> None:
    text = file_of("beckhoff_el5042", "ethercat_driver_ros2")
    lines = [line.replace("  # - {", "  - {") for line in text.splitlines() if "0x8018" in line]
    second = readers.ethercat_driver_ros2("\n".join(["sdo:", *lines]))
    assert second == {(0x8018, subindex): value for (_, subindex), value in EL5042.items()}


def test_a_code_word_comes_first(
    file_of: FileOf, masters: dict[str, Master], record_of: Callable[[str], EncoderFacts]
) -> None:
    """An encoder for 7 V to 30 V needs 9 V: F008 = 72657375h is written before 8008:12 = 90."""
    record = record_of(CODE)
    record = replace(record, numbers={**record.numbers, "supply_min_mv": 7000, "supply_max_mv": 30_000})
    text = file_of("beckhoff_el5042", "ecmc", settings_sheet=sheet(masters["beckhoff_el5042"], record))
    objects = readers.ecmc(text)
    order = list(objects)
    assert order.index((0xF008, 0)) + 1 == order.index((0x8008, 0x12))
    assert (objects[0xF008, 0], objects[0x8008, 0x12]) == ((0x72657375, 4), (90, 1))


def test_a_device_without_a_clock_does_not_bar_the_others(
    file_of: FileOf, masters: dict[str, Master], record_of: RecordOf
) -> None:
    """The EJ5042 has no clock between 500 kHz and 2.5 MHz, but the EL5042 has 1 MHz, which is 9."""
    record = record_of(CODE)
    record = replace(record, numbers={**record.numbers, "clock_min_hz": 1_000_000, "clock_max_hz": 1_000_000})
    settings_sheet = sheet(masters["beckhoff_el5042"], record)
    assert (settings_sheet.refusals, settings_sheet.unusable_devices) == ((), {"EJ5042"})
    assert settings_sheet.notes[0].startswith(
        "Not for EJ5042. Clock Frequency, EJ5042: no clock is between 1 MHz and 1 MHz"
    )
    assert settings_sheet.devices_with({}) == ["EL5042", "EP7041-4032"]
    assert readers.ecmc(file_of("beckhoff_el5042", "ecmc", settings_sheet=settings_sheet))[0x8008, 0x13] == (9, 1)


def test_fastcat_as_typed(file_of: FileOf) -> None:
    expected = {1: 0, 2: 0, 3: 1, 0x11: 67, 0x12: 50, 0x13: 0, 0x14: 0, 0x15: 16, 0x16: 21, 0x17: 0, 0x18: 0}
    assert readers.fastcat(file_of("beckhoff_el5042", "fastcat")) == expected
    # SSI at 1 MHz, in Gray code: 22 bits, of which the lowest is the error bit after 4 zeros.
    ssi = readers.fastcat(file_of("beckhoff_el5042", "fastcat", "SMA21-GG1-0010"))
    assert (ssi[0x18], ssi[0x14], ssi[0x02], ssi[0x11], ssi[0x13]) == (1, 1, 1, 0, 9)


def test_moteus_as_typed(file_of: FileOf) -> None:
    assert readers.conf_set(file_of("moteus", "conf_set")) == {
        "enabled": 1,
        "rate_hz": 1_000_000,
        "data_bits": 37,
        "crc_bits": 6,
    }


def test_hostmot2_as_typed(file_of: FileOf) -> None:
    config = "biss_chan_0=crc%6pnwarning%1bnerror%1bpositionlow%21lposition%16mh"
    assert readers.hal(file_of("linuxcnc_hostmot2", "hal")) == (config, 10_000)


def test_novanta_as_typed(file_of: FileOf) -> None:
    """25 bits in all, 17 of them position from bit 8 up."""
    assert readers.xcf(file_of("novanta", "xcf", "AMM5A17/1SC1")) == {
        "FBK_BISS1_SSI1_PROTOCOL": 0,
        "FBK_BISS1_SSI1_FRAME_SIZE": 25,
        "FBK_BISS1_SSI1_FRAME_TYPE": 3,
        "FBK_BISS1_SSI1_POS_BITS": 17,
        "FBK_BISS1_SSI1_POS_ST_BITS": 17,
        "FBK_BISS1_SSI1_POS_START_BIT": 8,
        "FBK_BISS1_SSI1_BAUD": 10_000,
        "FBK_BISS1_SSI1_WAIT_CYCLES": 0,
    }


def test_c_as_typed(file_of: FileOf) -> None:
    assert readers.members(file_of("ti_c2000", "c_struct")) == {
        "crcBits": 6,
        "crcPoly": 3,
        "crcStart": 0,
        "positionMTBits": 16,
        "positionSTBits": 21,
    }
    expected = {"multi_turn_len": 16, "single_turn_len": 21, "baud_rate": 10}
    assert readers.members(file_of("ti_motor_control_sdk", "c_struct")) == expected


def test_registers_as_typed(file_of: FileOf) -> None:
    """B1CLTCONx: SCDLEN 38 in 5:0, SCDEN in 6, CRCLEN in 14:8. iC-MB3: SDLEN 38, ENSENS in 6, 21h, INVCRCS in 7."""
    dspic = readers.defines(file_of("microchip_dspic33a", "c_registers"))
    for client in range(4):
        assert dspic[f"AMM5A21_65KSC1_B1CLTCON{client}_VALUE"] == 38 | 1 << 6 | 6 << 8
        assert dspic[f"AMM5A21_65KSC1_B1CLTCON{client}_MASK"] == 0xFFFFFFFF
    assert len(dspic) == 8
    mb3 = readers.defines(file_of("ic_mb", "c_registers"))
    assert len(mb3) == 18
    for slave in range(3):
        start = f"AMM5A21_65KSC1_ADDRESS_{192 + 4 * slave}"
        assert (mb3[f"{start}_VALUE"], mb3[f"{start}_MASK"]) == (38 | 1 << 6, 0xFF)
        start = f"AMM5A21_65KSC1_ADDRESS_{193 + 4 * slave}"
        assert (mb3[f"{start}_VALUE"], mb3[f"{start}_MASK"]) == (0x21 | 1 << 7, 0xFF)
        start = f"AMM5A21_65KSC1_ADDRESS_{194 + 4 * slave}"
        assert (mb3[f"{start}_VALUE"], mb3[f"{start}_MASK"]) == (0, 0x80)


def test_ax5000_as_typed(file_of: FileOf) -> None:
    """Bit offsets of P-0-0150 from its pages, UINT of 16 bits, little-endian."""
    text = file_of("beckhoff_ax5000", "soe_structure")
    rows = [line.split(";") for line in text.splitlines() if line.startswith("P-0-0150")]
    channel, biss = "P-0-0150 Parameter channel", "P-0-0150 Parameter channel / Data / BiSS"
    assert {(row[0], int(row[2])): (int(row[3]), int(row[4]), row[5]) for row in rows} == {
        (channel, 64): (16, 21, "15 00"),
        (channel, 80): (16, 16, "10 00"),
        (biss, 0): (16, 1, "01 00"),
        (biss, 16): (16, 2, "02 00"),
        (biss, 32): (16, 0, "00 00"),
        (biss, 48): (16, 6, "06 00"),
        (biss, 64): (16, 67, "43 00"),
        (biss, 80): (16, 1, "01 00"),
        (biss, 176): (16, 30, "1E 00"),
        (biss, 208): (16, 10_000, "10 27"),
    }


@pytest.mark.parametrize(("on", "divider"), [("Optima and Econo", 24), ("Accelera", 24)])
def test_galil_as_typed(file_of: FileOf, on: str, divider: int) -> None:
    """SMA21-GG1 takes 1 MHz: 25 MHz / (2 * 13) is 961,538 Hz with 12, and 27 MHz / (2 * 14) is 964,286 Hz with 13."""
    text = file_of("galil_ssi", "dmc", "AMM5A21/65KBG1", on)
    assert text.splitlines()[-1] == "SIA=1,37,21,0<4>1"
    assert all(line.startswith("REM ") for line in text.splitlines()[:-1])


#: A mistake in the description of a master: key of a place and wrong content, or key of a setting.
MISTAKES = [
    ("beckhoff_el5042", "ecmc", "CRC Polynomial", "index", [0x8009, 0x8018]),
    ("beckhoff_el5042", "linuxcnc_ethercat", "CRC Polynomial", "subindex", 0x12),
    ("beckhoff_el5042", "twincat", "CRC Polynomial", "type", "UINT16"),
    ("beckhoff_el5042", "fastcat", "CRC Polynomial", "value", "crc_polynomial_without_top_bit"),
    ("beckhoff_ax8000", "ethercat_driver_ros2", "Number of distinguishable revolutions", "type", "UINT32"),
    ("beckhoff_ax8000", "ecmc", "Number of distinguishable revolutions", "index", [0x32EE, 0x36EF, 0x330F, 0x370F]),
    ("synapticon", "ecmc", "Singleturn bits", "subindex", 11),
    ("synapticon", "twincat", "Singleturn bits", "value", "data_bits"),
    ("moteus", "conf_set", "aux[12].bissc.crc_bits", "symbol", ["aux1.bissc.crc_len", "aux2.bissc.crc_len"]),
    ("moteus", "conf_set", "aux[12].bissc.data_bits", "value", "data_and_status_bits"),
    ("microchip_dspic33a", "c_registers", "SCDLENx", "at", "6:1"),
    ("microchip_dspic33a", "c_registers", "SCDLENx", "value", "data_and_status_bits"),
    ("beckhoff_ax5000", "soe_structure", "Sensor mode: Number of CRC bits", "at", "79:64"),
    ("ti_c2000", "c_struct", "crcPoly", "value", "crc_polynomial"),
]


def _with_mistake(master: Master, setting: str, key: str, wrong_value: Any) -> Master:
    settings = deepcopy(master.settings)
    for mapping in settings:
        if mapping["name"] == setting:
            owner = mapping if key == "value" else mapping["places"][0]
            owner[key] = wrong_value
    return replace(master, settings=settings)


@pytest.mark.parametrize(("master", "name", "setting", "key", "wrong_value"), MISTAKES)
def test_a_planted_mistake_changes_the_file(
    masters: dict[str, Master],
    record_of: Callable[[str], EncoderFacts],
    file_of: FileOf,
    master: str,
    name: str,
    setting: str,
    key: str,
    wrong_value: Any,
) -> None:
    """Every mistake reaches the file, so the typed values above fail with it."""
    right_text = file_of(master, name)
    wrong_sheet = sheet(_with_mistake(masters[master], setting, key, wrong_value), record_of(CODE))
    assert not wrong_sheet.refusals
    wrong_text = file_of(master, name, settings_sheet=wrong_sheet)
    reader = getattr(readers, name, None)
    if reader is None:
        assert wrong_text != right_text
    else:
        with suppress(readers.Refused, KeyError):
            assert reader(wrong_text) != reader(right_text)


def records(library: Library) -> Iterator[tuple[Device, EncoderFacts]]:
    for device in library.devices:
        for interface in device.interfaces:
            for encoder_record in facts_of_order_codes(device, interface):
                yield device, encoder_record


@pytest.mark.exhaustive
def test_every_order_code_has_a_file_or_a_reason(library: Library, masters: dict[str, Master]) -> None:
    """154 of the 171 order codes have a record. The other 17 have RS-485, and the reason says so."""
    codes = {encoder_record.code for _, encoder_record in records(library)}
    variants = [(device, variant) for device in library.devices for variant in device.variants]
    assert (len(codes), len(variants)) == (154, 171)
    for device, variant in variants:
        if variant.code not in codes:
            with pytest.raises(
                NoMasterSettings, match="has the interface RS-485; there are masters for SSI and BiSS C-mode only"
            ):
                facts_of_order_code(device, variant)
    file_count = 0
    for device, encoder_record in records(library):
        for master in masters.values():
            settings_sheet = sheet(master, encoder_record)
            if settings_sheet.refusals:
                assert all(refusal.reason.endswith(".") for refusal in settings_sheet.refusals)
                continue
            for rule in master.files:
                for on in settings_sheet.devices_with(rule):
                    text = file_text(device, [encoder_record.code], settings_sheet, file_rule=rule, master_device=on)
                    assert "Not yet tested on hardware." in " ".join(text.split())
                    _read_back(rule["format"], text, settings_sheet, on, rule)
                    file_count += 1
    assert file_count > 2_800


def _read_back(name: str, text: str, settings_sheet: SettingsSheet, device_name: str, rule: Raw) -> None:
    """Read a file with the reader of its format, and compare each value with the page of the master."""
    entries = content_of_file(settings_sheet, rule, device_name).file_values
    value_by_setting = {setting.name: setting.value for setting in settings_sheet.settings}
    for entry in entries:
        assert entry.value == value_by_setting.get(entry.name, entry.value)
    read_format = getattr(readers, name, None)
    if name in SDO:
        expected = {(entry.place.index, entry.place.subindex): (int(entry.value), entry.size) for entry in entries}
        assert read_format is not None
        assert read_format(text) == expected
        assert len(expected) == len(entries)
    elif name == "fastcat":
        values = readers.fastcat(text)
        assert {entry.place.subindex: entry.value for entry in entries}.items() <= values.items()
    elif read_format is not None:
        read_format(text)


@pytest.mark.slow
def test_bulk_files_have_every_order_code_as_a_comment(library: Library) -> None:
    files = generate(library)
    assert 100 < len(files) < 200
    # LinuxCNC takes at most 32 position bits of a BiSS frame. A few iC-MU have 38.
    all_records = [encoder_record for _, encoder_record in records(library)]
    codes = {encoder.code for encoder in all_records if (encoder.numbers["position_bits"] or 0) <= 32}
    for path, text in files.items():
        if path.endswith((".yaml", ".cmd", ".cfg", ".hal", ".h", ".csv", ".dmc")):
            assert all(line.startswith(("#", "//", "REM")) for line in text.splitlines() if line), path
    # The head has the documents of all blocks: only settings for SSI cite page 836 and the channel.
    head = " ".join(files["masters/synapticon/ecmc/amm5.cmd"].partition("===")[0].split())
    assert all(f"p{page}: SOMANET Circulo 7" in head for page in (833, 836, 846))
    assert "ssi_chan_0 takes effect" in files["masters/linuxcnc_hostmot2/hal/amm5.hal"].partition("===")[0]
    joined = "\n".join(text for path, text in files.items() if "/linuxcnc_hostmot2/" in path)
    assert all(code in joined for code in codes)


@pytest.mark.parametrize("name", [*SDO, "c_struct", "xcf"])
def test_hostile_names_stay_in_comments(
    masters: dict[str, Master], file_of: FileOf, record_of: RecordOf, name: str
) -> None:
    """A setting or document whose name would end a comment changes no value."""
    masters_with_format = (master for master in masters.values() if name in format_names(master))
    master = next(masters_with_format)
    hostile = "x --> ---> */ \n- {index: 1}\\"
    settings = [{**setting, "name": f"{setting['name']} {hostile}"} for setting in master.settings]
    documents = tuple(replace(document, title=f"{document.title} {hostile}") for document in master.documents)
    hostile_sheet = sheet(
        replace(master, settings=tuple(settings), documents=documents, writing=()), record_of("AMM5A17/1SC1")
    )
    reader = getattr(readers, name, readers.members)
    text = file_of(master.name, name, settings_sheet=hostile_sheet)
    assert reader(text) == reader(file_of(master.name, name, "AMM5A17/1SC1"))
    assert not any(line.endswith("\\") for line in text.splitlines() if line.startswith("//"))


def test_formats_are_those_of_the_schema_and_the_templates(masters: dict[str, Master]) -> None:
    used = {rule["format"] for master in masters.values() for rule in master.files}
    assert used == set(FILE_FORMATS)


REFUSED = (
    "moteus cannot use AMM5A21/65KBG1: This master is described for BiSS C-mode only, but AMM5A21/65KBG1 has SSI; "
    "there are files for beckhoff_el5042, galil_ssi, linuxcnc_hostmot2 and synapticon"
)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            [CODE, "--master", "moteus", "--format", "yaml"],
            "moteus has no format 'yaml'; the formats of moteus are conf_set",
        ),
        ([CODE, "--format", "ecmc"], "--format needs an order code and --master"),
        (["--format", "ecmc"], "--format needs an order code and --master"),
        (
            [CODE, "--master", "moteus", "--device", "aux"],
            "--device needs --format; the formats of moteus are conf_set",
        ),
        (
            [CODE, "--master", "beckhoff_el5042", "--format", "fastcat", "--device", "EJ5042"],
            "'EJ5042' is not a device with this format; use --device EL5042",
        ),
        (
            ["AMM5A21/65KBG1", "--master", "moteus", "--format", "conf_set"],
            REFUSED,
        ),
        ([CODE, "--master", "moteus", "--format", "conf_set", "--json"], "--format prints a file; leave out --json"),
    ],
)
def test_wrong_usage_is_one_message(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert main(["master", *arguments]) == 2
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", f"codewheel: {message}\n")


@pytest.mark.slow
def test_a_missing_choice_and_a_master_without_files(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["master", "ASC8525/SC1", "--master", "moteus", "--format", "conf_set"]) == 2
    assert "--choose zero_bit=as_printed" in capsys.readouterr().err
    assert main(["master", CODE, "--master", "keb_f6", "--format", "ecmc"]) == 2
    assert capsys.readouterr().err.startswith(
        "codewheel: no file format is known for keb_f6; there are formats for beck"
    )
    assert main(["master", CODE, "--master", "keb_f6"]) == 0


def test_data_name_the_formats(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["master", CODE, "--json"]) == 0
    masters = json.loads(capsys.readouterr().out)["masters"]
    files = {master["name"]: master["files"] for master in masters}
    assert {"format": "fastcat", "devices": ["EL5042"]} in files["beckhoff_el5042"]
    assert (files["keb_f5"], files["omron_nx"]) == ([], [])


def test_the_command_prints_the_file(capsys: pytest.CaptureFixture[str], file_of: FileOf) -> None:
    assert main(["master", CODE, "--master", "moteus", "--format", "conf_set"]) == 0
    assert capsys.readouterr().out == file_of("moteus", "conf_set")
