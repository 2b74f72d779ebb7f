"""Order codes as printed on labels. The codes come from the AMM5 manual, cover and section 2."""

from __future__ import annotations

import time
from collections.abc import Mapping

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device
from codewheel.model.order_codes import applies_to_code
from codewheel.order_codes.labels import UnknownOrderCode, find_code


@pytest.fixture
def amm5(devices: Mapping[str, Device]) -> Device:
    return devices["amm5"]


def test_36_codes(amm5: Device) -> None:
    codes = [variant.code for variant in amm5.variants]
    assert len(codes) == len(set(codes)) == 36
    assert {"AMM5A17/1BG1", "AMM5B23/65KJP1", "AMM5A21/65KSC1"} <= set(codes)


@pytest.mark.parametrize(
    ("label", "code", "tail", "special"),
    [
        ("AMM5A21/65KSC1", "AMM5A21/65KSC1", "", False),
        ("amm5a21/65ksc1", "AMM5A21/65KSC1", "", False),
        (" AMM5A21/65KSC1-L2-10 ", "AMM5A21/65KSC1", "-L2-10", False),
        ("AMM5B17/1JP1/S123", "AMM5B17/1JP1", "", True),
        ("AMM5B17/1JP1-X/S001", "AMM5B17/1JP1", "-X", True),
    ],
)
def test_labels(amm5: Device, label: str, code: str, tail: str, special: bool) -> None:
    match = find_code(amm5, label)
    assert (match.variant.code, match.tail, match.special, match.unlisted) == (code, tail, special, ())


def test_what_a_code_decides(amm5: Device) -> None:
    variant = find_code(amm5, "AMM5A23/65KSC1").variant
    assert variant.interface == "biss"
    # No code decides an open question of the manual. Until the user does, the first answer applies.
    open_ = {parameter.name for parameter in amm5.parameters if parameter.alternative}
    assert {name: variant.parameters[name] for name in open_} == {
        "eeprom_address_bit": 1,
        "mem_busy_bit": 0,
        "low_battery_only": 0,
    }
    assert {name: value for name, value in variant.parameters.items() if name not in open_} == {
        "singleturn_bits": 23,
        "multiturn_bits": 16,
        "position_bits": 39,
        "counts_per_turn": 8388608,
        "revolutions": 65536,
        "modulus": 549755813888,
    }


@pytest.mark.parametrize(
    ("label", "message"),
    [
        ("AMM5A22/65KSC1", "has singleturn '22'; valid values: 17, 21, 23"),
        ("AMM5C21/65KSC1", "has mount 'C'; valid values: A, B"),
        ("AMM5A21/65SC1", "has turns '65'; valid values: 1, 65K"),
        ("AMM5A21/65K", "has no interface; valid values: BG1, SC1, JP1"),
        ("AMM5A21/65KSC2", "has interface 'SC2'; valid values: BG1, SC1, JP1"),
        ("AMM5", "is not an order code of AMM5; the nearest are"),
        ("AMM5A21/65KSC1x", "has interface 'SC1X'"),
    ],
)
def test_wrong_codes_name_the_part_and_the_nearest(amm5: Device, label: str, message: str) -> None:
    with pytest.raises(UnknownOrderCode) as caught:
        find_code(amm5, label)
    assert message in str(caught.value)
    assert "nearest" in str(caught.value)


@pytest.mark.parametrize(
    ("family", "label", "message"),
    [
        ("asc85", "ASC8529/SC1", "has resolution '29'; valid values: 20, 21, 22, 23, 24, 25."),
        ("am36", "AM36/4096-I7", "has no singleturn; valid values: 16, 19, and others of the form [0-9]{2}."),
        (
            "am36",
            "AM3617/4096-GG",
            "has singleturn '17' and output 'GG', which cannot be combined; the nearest codes are AM3616/4096-GG",
        ),
        ("sma21", "SMA21-G1-0050", "has no supply; valid values: 1, 4, and others of the form [0-9]."),
        (
            "sma21",
            "SMA21-JP4-0050",
            "has output 'JP' and supply '4', which cannot be combined; the nearest codes are SMA21-JP1-0050",
        ),
    ],
)
def test_wrong_codes_of_the_other_families(
    devices: Mapping[str, Device], family: str, label: str, message: str
) -> None:
    with pytest.raises(UnknownOrderCode) as caught:
        find_code(devices[family], label)
    assert message in str(caught.value)
    assert caught.value.names_mistake


@pytest.mark.parametrize(
    ("family", "label", "code", "unlisted"),
    [
        ("asc85", "ASC8525/SC2", "ASC8525/SC2", ()),
        ("asc85", "ASC8525/SC2/S123", "ASC8525/SC2", ()),
        ("asc85", "ASC8525/SC7", "ASC8525/SC7", ("supply",)),
        ("am36", "AMC3616/4096-GG-M12", "AMC3616/4096-GG", ()),
        ("am36", "AM3620/65536-I7", "AM3620/65536-I7", ("singleturn", "turns")),
        ("sma21", "sma21-sc4-0050-x", "SMA21-SC4-0050", ()),
        ("sma21", "SMA21-SC2-0050", "SMA21-SC2-0050", ("supply",)),
    ],
)
def test_labels_of_the_other_families(
    devices: Mapping[str, Device], family: str, label: str, code: str, unlisted: tuple[str, ...]
) -> None:
    match = find_code(devices[family], label)
    assert (match.variant.code, match.unlisted, match.written_as_in) == (code, unlisted, "")


#: Labels as written in edition 1.1 of the AM36 manual (p.21: AMx36xx/4096SCx-...),
#: and the corresponding codes of edition 1.0.
EDITION_1_1 = {
    "AM3616/4096SC1": "AM3616/4096-I7",
    "am3619/4096scx".replace("x", "2"): "AM3619/4096-I7",
    "AMC3619/4096SC": "AMC3619/4096-I7",
    "AM3616/4096-SC1": "AM3616/4096-I7",
    "AM3616/4096BG2": "AM3616/4096-BG",
    "AMC3616/4096-GG2-M12/S5": "AMC3616/4096-GG",
}


@pytest.mark.parametrize(("label", "code"), EDITION_1_1.items())
def test_labels_of_edition_1_1_are_read_and_shown_as_such(devices: Mapping[str, Device], label: str, code: str) -> None:
    match = find_code(devices["am36"], label)
    assert (match.variant.code, match.unlisted) == (code, ())
    assert "edition 1.1" in match.written_as_in
    assert match.variant in devices["am36"].variants
    assert len(devices["am36"].variants) == 12


@pytest.mark.parametrize(
    "label", ["AM3616/4096I7", "AM3616/4096SC12", "AM3616/4096SCX", "AM3616/4096", "AM3620/4096BG1", "AM3616SC1"]
)
def test_what_edition_1_1_does_not_write_is_refused(devices: Mapping[str, Device], label: str) -> None:
    with pytest.raises(UnknownOrderCode):
        find_code(devices["am36"], label)


@pytest.mark.parametrize(
    ("label", "code"), [("SMA21 -BG1-0050", "SMA21-BG1-0050"), (" SMA21 - SC4-0001 -R", "SMA21-SC4-0001")]
)
def test_blanks_of_a_label_mean_nothing(devices: Mapping[str, Device], label: str, code: str) -> None:
    """The cover of the SMA21 manual prints SMA21 -BGx-..., the rest of it SMA21-BGx-..."""
    assert find_code(devices["sma21"], label).variant.code == code


@pytest.mark.slow
@pytest.mark.parametrize("label", ["x" * 10**6, "AMM5A21/65KSC1-" + "A" * 10**6])
def test_a_label_without_end_is_refused_at_once(amm5: Device, label: str, capsys: pytest.CaptureFixture[str]) -> None:
    begin = time.process_time()
    with pytest.raises(UnknownOrderCode, match="more than the 100 of any label") as caught:
        find_code(amm5, label)
    assert time.process_time() - begin < 0.5
    assert len(str(caught.value)) < 200
    assert main(["show", label]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"codewheel: '{label[:20]}...' is not an order code: it has {len(label)} characters")
    assert len(message) < 200


def test_many_gaps_in_a_pattern_share_the_text_in_one_way() -> None:
    """With every way to share it, this takes hours."""
    assert applies_to_code("...A" * 12, "A" * 36)
    assert not applies_to_code("...A" * 12 + "...Z", "A" * 36)
