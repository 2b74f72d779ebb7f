"""Open questions of the manuals are open, with public evidence, and facts once missing are there with their source."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest
from codewheel.model import Device, Erratum, Flag, SendStep, Sources, Ssi, cite

#: Required citations in the sources or the reason, by family and erratum.
OPEN: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("am36", "biss_crc_start"): ("prot: p.7-8",),
    ("am36", "biss_documents"): ("BiSS C Protocol Description",),
    ("am36", "command_default"): ("7 p.33",),
    ("am36", "emc_directive_superseded"): ("2014/30/EU", "20 April 2016"),
    ("am36", "input_levels"): ("4.5 p.15", "+VDC"),
    ("am36", "order_code_edition_1_1"): ("am36_1_1_biss: p.21", "am36_1_1: p.22"),
    ("am36", "output_letters"): ("amm5", "infers"),
    ("am36", "serial_number_coding"): ("amm36: p.38", "46h"),
    ("am36", "ssi_pause"): ("Tp > 12 µs", "no margin"),
    ("amm5", "battery_shorted_under_supply"): ("Step 14", "Step 15"),
    ("amm5", "biss_crc_start"): ("prot: p.7-8",),
    ("amm5", "biss_documents"): ("BiSS C Protocol Description",),
    ("amm5", "busy_and_errors_in_one_bit"): ("EE_1", "Data ID 3"),
    ("amm5", "encoder_id_23h"): ("hpm_sdk: samples/drivers/sei/slave/tamagawa/README_en.rst", "0x17", "23 in decimal"),
    ("amm5", "error_bits_leds_alarms"): ("nE", "nW", "LED 1", "LED 2", "EE_0", "EE_1"),
    ("amm5", "mem_busy_on_read"): ("7.5 p.46", "Writing is being executed"),
    ("amm5", "mem_busy_position"): (
        "hpm_sdk: samples/drivers/sei/slave/tamagawa/README_en.rst",
        "ti_sdk: tamagawa_over_soc_uart/driver/tamagawa_soc_uart_driv.c",
        "32 7F 01 4C", "32 01 5A 69", "EA 01 EB", "EA 05 EF", "EA 0A E0",
    ),
    ("amm5", "preset_setting_enable_default"): ("10 p.52",),
    ("amm5", "reset_interval"): ("in succession", "from the start of one to the start of the next"),
    ("amm5", "serial_number_order"): ("amm36: p.38", "1.7"),
    ("asc85", "biss_crc_start"): ("icmr: p.35", "onstepx"),
    ("asc85", "biss_documents"): ("BiSS C Protocol Description",),
    ("asc85", "cycle_counter"): ("icmr: p.26",),
    ("asc85", "do_not_touch"): ("tool", "3.3 p.12"),
    ("asc85", "scd_length"): ("onstepx: src/lib/encoder/bissc/Asc85.cpp", "33 in all", "without the 0 bit"),
    ("asc85", "ssi_code_letters"): ("amm5", "infers"),
    ("asc85", "ssi_pause"): ("Tp > 12 µs", "no margin"),
    ("sma21", "biss_crc_start"): ("prot: p.7-8",),
    ("sma21", "biss_documents"): ("Protocol description C-mode",),
    ("sma21", "command_default"): ("12 p.51",),
    ("sma21", "data_id_5_example_status"): ("7.3.4", "dd1"),
    ("sma21", "reset_interval"): ("in successione", "from the start of one to the start of the next"),
    ("sma21", "rs485_position_width"): ("4.10 p.18",),
}  # fmt: skip

MANUAL = re.compile(r"manual, (English|Italian) edition")
#: Settled errata that cite the manual of another family, although their own manual is enough.
SETTLED_BESIDE_A_SISTER = {
    ("am36", "cable_impedance"),
    ("am36", "enable_preset_polarity"),
    ("asc85", "resistance_by_cross_section"),
    ("asc85", "ssi_bit_numbers"),
}


def erratum(device: Device, name: str) -> Erratum:
    return next(erratum for erratum in device.errata if erratum.name == name)


@pytest.mark.parametrize(("family", "name"), OPEN)
def test_it_is_open_and_cites_its_evidence(devices: Mapping[str, Device], family: str, name: str) -> None:
    open_erratum = erratum(devices[family], name)
    evidence = " ".join((cite(open_erratum.source), open_erratum.printed, open_erratum.used, open_erratum.why))
    assert open_erratum.status == "open"
    assert [words for words in OPEN[family, name] if words not in evidence] == []
    assert open_erratum.affects


def test_nothing_is_settled_by_the_manual_of_another_family(devices: Mapping[str, Device]) -> None:
    settled = set()
    for device in devices.values():
        manuals = [document.key for document in device.documents if MANUAL.search(document.title)]
        sisters = {key for key in manuals if not key.startswith(device.name)}
        for erratum in device.errata:
            if erratum.status == "settled":
                assert "of the same maker" not in erratum.why, erratum.name
                assert "infer" not in erratum.why, erratum.name
                if not sisters.isdisjoint(source.document for source in erratum.source):
                    settled.add((device.name, erratum.name))
    assert settled == SETTLED_BESIDE_A_SISTER


def cited(sources: Sources) -> str:
    return cite(sources)


def test_ssi_cites_what_is_said_of_this_encoder_and_not_of_ssi_in_general(devices: Mapping[str, Device]) -> None:
    """5.1 of all manuals says "binary or Gray" about SSI in general. Alignment and code of the encoder are in 5.2."""
    places = {"am36": "5.2", "amm5": "5.2 p.28", "asc85": "5.2 p.16", "sma21": "5.2 p.20"}
    for name, place in places.items():
        ssi = devices[name].find_interface(Ssi)
        assert ssi is not None
        assert ssi.output_code is not None
        assert (cited(ssi.alignment.source), cited(ssi.output_code.source)) == (place, place)


def test_the_voltages_of_the_inputs(devices: Mapping[str, Device]) -> None:
    """AM36 4.4 and 4.5: 0VDC is low, CW; +VDC is high, CCW."""
    zero, direction = devices["am36"].inputs
    assert direction.low.startswith("0VDC. The position counts up clockwise (CW)")
    assert direction.high.startswith("+VDC. The position counts up counterclockwise (CCW)")
    assert zero.low.startswith("0VDC")
    assert zero.high.startswith("+VDC")


@pytest.mark.parametrize("family", ["am36", "asc85"])
def test_a_pause_of_exactly_12_us_is_said_to_be_no_margin(devices: Mapping[str, Device], family: str) -> None:
    pause = next(timing for timing in devices[family].interface("ssi").timings if timing.name == "pause")
    assert pause.at_least_us == 12
    assert "Tp > 12 µs" in pause.meaning


def test_a_reset_is_sent_ten_times_in_succession(devices: Mapping[str, Device]) -> None:
    """AMM5 7.4.2 p.45, SMA21 7.3.3.2 p.41."""
    sends: list[SendStep] = []
    for device in devices.values():
        for procedure in device.procedures:
            sends += [step for step in procedure.steps if isinstance(step, SendStep)]
    assert len(sends) == 5
    assert all(step.times == 10 and step.in_succession for step in sends)


def test_no_meaning_says_set_of_a_bit_that_is_0_then(devices: Mapping[str, Device]) -> None:
    for device in devices.values():
        for _, layout in device.layouts():
            for field in layout.fields:
                if isinstance(field.kind, Flag) and field.kind.active_low:
                    assert not re.match(r"set\b", field.meaning.lower()), (device.name, field.name)


#: Facts from a single place in a manual, by a word that names them and their source.
FACTS = [
    ("am36", "personnel", "can injure or kill", "Safety p.8"),
    ("amm5", "personnel", "can injure or kill", "1.1 p.8"),
    ("asc85", "personnel", "can injure or kill", "1.1 p.8"),
    ("sma21", "personnel", "can injure or kill", "1.1 p.9"),
    ("amm5", "enclosure", "encoder and the disk", "it: 1.3 p.9"),
    ("asc85", "mechanical_safety", "Do not machine the encoder or its shaft", "1.3 p.8"),
    ("asc85", "cable_resistance", "90 Ω/km (0.22 mm²) or 148 Ω/km (0.14 mm²)", "4.3 p.14"),
    ("am36", "cable_resistance", "148 Ω/km (0.14 mm²), 90 Ω/km (0.22 mm²)", "4.2"),
    ("sma21", "cable_resistance", "148 Ω/km (0.14 mm²) or 90 Ω/km (0.25 mm²)", "4.5 p.16"),
    ("sma21", "diagnostic_led", "front", "9.1 p.47"),
]


@pytest.mark.parametrize(("family", "name", "words", "place"), FACTS)
def test_facts_with_their_sources(
    devices: Mapping[str, Device], family: str, name: str, words: str, place: str
) -> None:
    (characteristic,) = [fact for fact in devices[family].characteristics if fact.name == name]
    assert words in characteristic.value
    assert place in cited(characteristic.source)


def test_what_the_line_carries_round_a_byte_is_said(devices: Mapping[str, Device]) -> None:
    """AMM5 7.6 p.47 and 7.4 p.43; SMA21 7.3.1 to 7.3.4."""
    for name in ("amm5", "sma21"):
        note = devices[name].interface("rs485").note
        assert "start bit" in note
        assert "delimiter" in note
        assert "least significant bit first" in note
    assert "in binary code" in devices["amm5"].interface("rs485").note


def test_the_registers_of_the_maker(devices: Mapping[str, Device]) -> None:
    """ASC85 6.4 p.26: configuration registers 00h to 2Dh, not available to users."""
    table = next(table for table in devices["asc85"].tables if table.name == "reserved_registers")
    assert table.rows[0][:2] == ("00h", "2Dh")
    assert cited(table.source) == "6.4 p.26"


def test_a_name_is_what_its_erratum_says(devices: Mapping[str, Device]) -> None:
    """SMA21 58h: the misprint SENO-COSENSO is only in the erratum."""
    names = devices["sma21"].register("sine_cosine_resolution").names
    assert names["it"] == "Risoluzione SENO-COSENO"
    assert "SENO-COSENO" in erratum(devices["sma21"], "sine_cosine_name").used
