"""Imaginary encoders just within and just beyond each master's limits, whose figures are in the reasons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from codewheel.masters.encoder_facts import EncoderFacts
from codewheel.masters.sheet import Master, load_masters, sheet

RecordOf = Callable[[str], EncoderFacts]


def record_with(record: EncoderFacts, **items: int | str | None) -> EncoderFacts:
    words = {name: str(items.get(name, value)) for name, value in record.words.items()}
    numbers: Mapping[str, int | None]
    numbers = {name: items.get(name, value) for name, value in record.numbers.items()}  # type: ignore[misc]
    return replace(record, words=words, numbers=numbers)


@pytest.mark.parametrize(
    ("master", "within", "beyond", "reason"),
    [
        (
            "beckhoff_el5042",
            {"data_bits": 64},
            {"data_bits": 65},
            "The position has at most 64 bits. This encoder has 65 data bits.",
        ),
        (
            "beckhoff_ax8000",
            {"padding_left": 31},
            {"padding_left": 32},
            "There are at most 31 fill bits. This encoder has 32 zero bits before the position.",
        ),
        (
            "ic_mb",
            {"bits_without_crc": 64},
            {"bits_without_crc": 65},
            (
                "A slave sends 1 to 64 bits of sensor data, including status bits. "
                "This encoder has 65 bits of data, status and others."
            ),
        ),
        (
            "ic_mb",
            {"crc_polynomial": 0xB1},
            {"crc_polynomial": 0x12F},
            (
                "A CRC polynomial has at most 8 bits, including its trailing 1. "
                "For this encoder: CRC polynomial with its top bit: 0x12F."
            ),
        ),
        (
            "ti_motor_control_sdk",
            {"data_bits": 56},
            {"data_bits": 57},
            "single_turn_len and multi_turn_len together are at most 56. This encoder has 57 data bits.",
        ),
        (
            "ti_motor_control_sdk",
            {"crc_bits": 6},
            {"crc_bits": 16},
            "The CRC of the position has 6 bits. This encoder has 16 CRC bits.",
        ),
        (
            "ti_motor_control_sdk",
            {"crc_inverted": 1},
            {"crc_inverted": 0},
            ("The driver expects the inverted CRC. No setting changes this. This encoder has a plain CRC."),
        ),
        (
            "ti_c2000",
            {"data_bits": 62},
            {"data_bits": 63},
            "Position, error and warning together are stored in 64 bits. This encoder has 63 data bits.",
        ),
        (
            "moteus",
            {"data_bits": 58},
            {"data_bits": 59},
            "There are at most 58 data bits. This encoder has 59 data bits.",
        ),
        (
            "linuxcnc_hostmot2",
            {"frame_bits": 96},
            {"frame_bits": 97},
            "A BiSS channel has at most 96 bits. This encoder sends frames of 97 bits.",
        ),
        (
            "linuxcnc_hostmot2",
            {"singleturn_bits": 32},
            {"singleturn_bits": 33},
            "A field has at most 32 bits. This encoder has 33 singleturn bits.",
        ),
        (
            "synapticon",
            {"status_active": "high"},
            {"status_active": "mixed"},
            (
                "Both status bits are active low or both are active high. "
                "This encoder has status bits of both active levels."
            ),
        ),
        (
            "keb_f5",
            {"crc_polynomial": 0x43},
            {"crc_polynomial": 0x97},
            "The CRC is x^6 + x^1 + 1 (0x43). For this encoder: CRC polynomial with its top bit: 0x97.",
        ),
    ],
)
def test_limits(
    masters: dict[str, Master],
    record_of: RecordOf,
    master: str,
    within: dict[str, int | str],
    beyond: dict[str, int | str],
    reason: str,
) -> None:
    sound = record_of("AMM5A17/1SC1")
    assert sheet(masters[master], record_with(sound, **within)).refusals == ()
    assert reason in [refusal.reason for refusal in sheet(masters[master], record_with(sound, **beyond)).refusals]


@pytest.mark.parametrize(
    ("slowest", "fastest", "clock"),
    [
        (50_000, 10_000_000, 0),
        (50_000, 9_999_999, 1),
        (50_000, 3_330_000, 2),
        (50_000, 1_999_999, 9),
        (50_000, 250_000, 19),
    ],
)
def test_the_fastest_clock_that_both_have(
    masters: dict[str, Master], record_of: RecordOf, slowest: int, fastest: int, clock: int
) -> None:
    settings_sheet = sheet(
        masters["beckhoff_el5042"], record_with(record_of("AMM5A17/1SC1"), clock_min_hz=slowest, clock_max_hz=fastest)
    )
    assert {setting.name: setting.value for setting in settings_sheet.settings}[
        "Clock Frequency, EL5042 and EP7041-4032"
    ] == clock


def test_no_clock_that_both_have(masters: dict[str, Master], record_of: RecordOf) -> None:
    sound = record_of("AMM5A17/1SC1")
    slow = sheet(masters["beckhoff_el5042"], record_with(sound, clock_min_hz=50_000, clock_max_hz=249_999))
    limits = "no clock is between 50 kHz and 249.999 kHz, the limits of the encoder."
    assert [refusal.reason for refusal in slow.refusals] == [
        f"Clock Frequency, EL5042 and EP7041-4032: {limits}",
        f"Clock Frequency, EJ5042: {limits}",
    ]
    fast = sheet(masters["moteus"], record_with(sound, clock_min_hz=2_000_000))
    assert [refusal.reason for refusal in fast.refusals] == [
        "The master supports clocks of at most 1 MHz, but the encoder needs 2 MHz to 10 MHz."
    ]


@pytest.mark.parametrize(("fastest", "clock"), [(9_999_999, 2), (2_499_999, 17), (250_000, 19)])
def test_the_module_with_fewer_clocks(
    masters: dict[str, Master], record_of: RecordOf, fastest: int, clock: int
) -> None:
    """The EJ5042 has no 5 MHz, 2 MHz and 1 MHz."""
    settings_sheet = sheet(
        masters["beckhoff_el5042"], record_with(record_of("AMM5A17/1SC1"), clock_min_hz=50_000, clock_max_hz=fastest)
    )
    assert {setting.name: setting.value for setting in settings_sheet.settings}["Clock Frequency, EJ5042"] == clock


def test_unknown_is_said(masters: dict[str, Master], record_of: RecordOf) -> None:
    settings_sheet = sheet(masters["beckhoff_el5042"], record_with(record_of("AMM5A17/1SC1"), clock_max_hz=None))
    settings = {setting.name: setting for setting in settings_sheet.settings}
    clock = settings["Clock Frequency, EL5042 and EP7041-4032"]
    assert (clock.value, clock.text) == (
        None,
        "unknown: not in the encoder's spec (fastest clock of the encoder, in Hz)",
    )


@pytest.mark.parametrize(
    ("polynomial", "bits", "expected"),
    [
        (0x43, 6, {"CRCSELx": 0, "CRCLENx": 6}),
        (0x190D9, 16, {"CRCSELx": 0, "CRCLENx": 16}),
        (0x97, 7, {"CRCSELx": 1, "CRCPOLYx": 0x4B}),  # 1001 0111 without its last 1 is 100 1011
    ],
)
def test_polynomials_of_microchip(
    masters: dict[str, Master], record_of: RecordOf, polynomial: int, bits: int, expected: dict[str, int]
) -> None:
    record = record_with(
        record_of("AMM5A17/1SC1"),
        crc_polynomial=polynomial,
        crc_bits=bits,
        crc_polynomial_without_last_1=polynomial >> 1,
    )
    settings = {setting.name: setting.value for setting in sheet(masters["microchip_dspic33a"], record).settings}
    assert {name: value for name, value in settings.items() if name in ("CRCSELx", "CRCLENx", "CRCPOLYx")} == expected


OWN = """
codewheel: 1
master: {name}
title: {title}
takes: [biss]
documents: {{manual: {{title: A manual}}}}
settings:
  - name: Less
    value: position_bits - 100
    places: [{{where: not_given, type: not_given, unit: bits, default: not_given, source: manual}}]
    source: manual
"""


@pytest.mark.slow
def test_own_masters(record_of: RecordOf, tmp_path: Path) -> None:
    """A user's file is added to ours or replaces a file with its name, and an impossible value is a refusal."""
    (tmp_path / "mine.yaml").write_text(OWN.format(name="mine", title="Mine"), encoding="utf-8")
    (tmp_path / "moteus.yaml").write_text(OWN.format(name="moteus", title="Other"), encoding="utf-8")
    masters, report = load_masters([tmp_path])
    assert not report.problems
    by_name = {master.name: master for master in masters}
    assert by_name["mine"].title == "Mine"
    assert by_name["moteus"].title == "Other"
    assert "ic_mb" in by_name
    refusals = sheet(by_name["mine"], record_of("AMM5A17/1SC1")).refusals
    assert [refusal.reason for refusal in refusals] == ["Less would be position_bits - 100, which cannot be set."]


@pytest.mark.slow
def test_a_spec_is_no_master(tmp_path: Path) -> None:
    path = tmp_path / "manufacturer.yaml"
    path.write_text("codewheel: 1\nmanufacturer: x\ntitle: X\nsource: y\n", encoding="utf-8")
    _, report = load_masters([path])
    assert [problem.message for problem in report.problems] == [
        "this is not a description of a master: the key 'master' is missing"
    ]
