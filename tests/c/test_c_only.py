"""The option that limits C to some families, interfaces and order codes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.model import Device
from codewheel.targets import Library, OptionError
from codewheel.targets.c.files import generate


def headers(devices: tuple[Device, ...], only: str) -> dict[str, str]:
    """Headers for reading positions, by their stems."""
    files = generate(Library(devices), {"only": only})
    text_by_stem = {path.removeprefix("c/include/lika/").removesuffix(".h"): text for path, text in files.items()}
    return {stem: text for stem, text in text_by_stem.items() if stem.count("_") == 1 and not {*"/."} & {*stem}}


@pytest.mark.slow
@pytest.mark.parametrize(("only", "stems"), [
    ("AMM5A21/65KSC1", {"amm5_biss"}),
    (" amm5a21/65ksc1 , SMA21_SSI", {"amm5_biss", "sma21_ssi"}),
    ("amm5", {"amm5_biss", "amm5_ssi", "amm5_rs485"}),
    ("rs485", {"amm5_rs485", "sma21_rs485"}),
])  # fmt: skip
def test_only_what_is_named_is_there(only: str, stems: set[str], c_devices: tuple[Device, ...]) -> None:
    assert set(headers(c_devices, only)) == stems


@pytest.mark.slow
def test_only_the_order_code_is_there(c_devices: tuple[Device, ...]) -> None:
    text = headers(c_devices, "AMM5A21/65KSC1,AMM5B17/1SC1")["amm5_biss"]
    codes = [line.split()[3] for line in text.splitlines() if line.startswith("static CW_CONST lika_amm5_biss LIKA")]
    assert codes == ["LIKA_AMM5_BISS_A21_65KSC1", "LIKA_AMM5_BISS_B17_1SC1"]
    whole = headers(c_devices, "")["amm5_biss"]
    assert text.splitlines()[-200:] == whole.splitlines()[-200:], "the functions are the same"


@pytest.mark.slow
def test_the_frame_of_an_example_is_one_of_the_order_code(c_devices: tuple[Device, ...]) -> None:
    # 17 bits of position, the 1 before them and the 0 after them fill 19 of 24 bits. The others are 0.
    program = generate(Library(c_devices), {"only": "AMM5A17/1BG1"})["c/examples/amm5_ssi.c"]
    (listed,) = re.findall(r"\[LIKA_AMM5_SSI_A17_1BG1_RX_BYTES\] = \{\s*([^}]*?)\s*\}", program)
    first, *_, last = (int(byte, 16) for byte in re.findall(r"0x([0-9A-F]{2})", listed))
    assert listed.count("0x") == 3
    assert first >> 7 == 1
    assert last & 0x3F == 0


@pytest.mark.parametrize(("only", "hint"), [
    ("AMM5A21/65KSC2", "valid are AMM5A17/1BG1, AMM5A17/1SC1, "),
    ("sma21_bis", "did you mean 'sma21_biss'?"),
    ("amm5,profinet", "valid are order codes, such as AM3616/4096-I7, am36, am36_ssi, am36_biss, amm5"),
])  # fmt: skip
def test_an_unknown_name_is_refused(only: str, hint: str, c_devices: tuple[Device, ...]) -> None:
    with pytest.raises(OptionError, match=r"c\.only: there is no order code, interface or family") as error:
        generate(Library(c_devices), {"only": only})
    assert hint in str(error.value)


def test_wrong_usage_ends_with_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    specs = str(Path(__file__).resolve().parents[1] / "specs" / "bits22.yaml")
    assert main(["generate", specs, "--target", "c", "-o", str(tmp_path), "--option", "c.only=rs485"]) == 2
    assert "valid are order codes, such as T22SC, bits22, bits22_biss, biss" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(("only", "absent", "needed"), [
    ("AMM5A21/65KSC1", {"spi.h", "receive_frame.h"}, {"receive.h", "biss.h", "biss_slave.h", "runner.h"}),
    ("AMM5A21/65KBG1", {"spi.h", "receive_frame.h", "biss_slave.h", "runner.h", "transport.h"}, {"receive.h"}),
    ("AMM5A21/65KJP1", {"spi.h", "receive_frame.h", "biss_slave.h"}, {"receive.h", "runner.h"}),
])  # fmt: skip
def test_it_takes_along_only_what_it_needs(
    only: str, absent: set[str], needed: set[str], c_devices: tuple[Device, ...]
) -> None:
    files = generate(Library(c_devices), {"only": only})
    runtime = {path.removeprefix("c/include/codewheel/") for path in files if path.startswith("c/include/codewheel/")}
    assert needed <= runtime
    assert runtime & absent == set()
    # Every included file exists, and the README names no other file.
    included = {name for text in files.values() for name in re.findall(r'#include "(?:codewheel/)?(\w+\.hp*)"', text)}
    assert included <= {path.rpartition("/")[2] for path in files}
    assert [name for name in absent if f"`{name}`" in files["c/README.md"]] == []
    assert ("An RS-485 procedure" in files["c/README.md"]) == any("_rs485.h" in path for path in files)


@pytest.mark.slow
def test_a_manufacturer_without_an_order_code_has_no_pages(every_device: dict[str, Device]) -> None:
    devices = (every_device["amm5"], every_device["icmu"])
    assert {path for path in generate(Library(devices)) if "ASSUMPTIONS" in path} == {
        "c/ASSUMPTIONS-ichaus.md",
        "c/ASSUMPTIONS-lika.md",
    }
    pages = {
        path for path in generate(Library(devices), {"only": "AMM5A21/65KSC1"}) if re.search(r"[A-Z]+-\w+\.md", path)
    }
    assert pages == {"c/ASSUMPTIONS-lika.md", "c/ERRATA-lika.md"}
