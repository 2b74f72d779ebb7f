"""Clocks that programs use are stated as such in every output, and never as limits of the encoder.

The clocks of the RESOLUTE come from the files that its spec cites: 250 kHz and 1 MHz in two scripts of ecmccfg, and 1,
2 and 5 MHz in the names of three captures. The iC-MHM has a highest clock in its data sheet (10 MHz) and a clock of 2
MHz in an example.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.new import write_spec
from codewheel.loading.library import load_library
from codewheel.model import Biss, Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate as c_files
from codewheel.targets.docs.files import generate as pages
from codewheel.targets.python.files import generate as python_files

ENCODERS = Path(__file__).parents[2] / "specs"
USED = (250_000, 1_000_000, 2_000_000, 5_000_000)
IN_WORDS = "250 kHz, 1 MHz, 2 MHz and 5 MHz are in use, the limits are not known"


def library(*names: str) -> Library:
    devices, report = load_library([ENCODERS / name for name in names])
    assert not report.problems
    return Library(tuple(devices))


@pytest.fixture(scope="module")
def encoders() -> Library:
    return library("renishaw/resolute.yaml", "ichaus/icmhm.yaml")


def device(encoders: Library, name: str) -> Device:
    return next(device for device in encoders.devices if device.name == name)


def test_the_model(encoders: Library) -> None:
    clock = device(encoders, "resolute").interface(Biss.name).clock
    assert (clock.min_hz, clock.max_hz, clock.used_hz) == (None, None, USED)
    clock = device(encoders, "icmhm").interface(Biss.name).clock
    assert (clock.min_hz, clock.max_hz, clock.used_hz) == (None, 10_000_000, (2_000_000,))


def clock_macros(files: dict[str, str], header: str) -> dict[str, int]:
    clocks = re.findall(r"#define \w+_BISS_CLOCK_(\w+)_HZ (\d+)U", files[f"c/include/{header}"])
    return {name: int(value) for name, value in clocks}


def test_c(encoders: Library) -> None:
    files = dict(c_files(encoders))
    header = files["c/include/renishaw/resolute_biss.h"]
    assert clock_macros(files, "renishaw/resolute_biss.h") == {"USED": 5_000_000}
    assert IN_WORDS in re.sub(r"\s+\*?\s*", " ", header)
    assert clock_macros(files, "ichaus/icmhm_biss.h") == {"MAX": 10_000_000, "USED": 2_000_000}
    assert "a clock in use in Hz, not a limit" in files["c/include/ichaus/icmhm_biss.h"]


def test_python(encoders: Library) -> None:
    text = re.sub(r"\s+", " ", "\n".join(python_files(encoders).values()))
    assert re.search(r"Clock\( ?min_hz=None, max_hz=None, source=\"[^\"]*\", used_hz=\(250_000, 1_000_000, ", text)
    assert re.search(r"Clock\( ?min_hz=None, max_hz=10_000_000, source=\"[^\"]*\", used_hz=\(2_000_000,\)", text)


def test_pages(encoders: Library) -> None:
    files = pages(encoders)
    for name in ("biss", "RESOLUTE-32"):
        assert IN_WORDS in files[f"docs/resolute/{name}.md"]
    order_code = files["docs/resolute/RESOLUTE-32.md"]
    assert "up to 5 MHz, the fastest clock in use" in order_code
    assert "up to 10 MHz, 2 MHz is in use, the lowest clock is not known" in files["docs/icmhm/biss.md"]


def test_show(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "RESOLUTE-32", "--specs", str(ENCODERS)]) == 0
    assert IN_WORDS in " ".join(capsys.readouterr().out.split())
    assert main(["show", "RESOLUTE-32", "--json", "--specs", str(ENCODERS)]) == 0
    clock = json.loads(capsys.readouterr().out)["interfaces"]["biss"]["clock"]
    assert (clock["min_hz"], clock["max_hz"], clock["used_hz"]) == (None, None, list(USED))


def clock_settings(capsys: pytest.CaptureFixture[str], master: str, *more: str) -> list[tuple[object, str, str]]:
    """Return value, bound and note of each setting for the clock."""
    arguments = ["master", "RESOLUTE-32", "--master", master, "--json", "--specs", str(ENCODERS), *more]
    assert main(arguments) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["record"]["clock_max_hz"] is None
    rows = data["masters"][0]["settings"]
    return [(row["value"], row["bound"], row["note"]) for row in rows if "MHz are in use" in row["note"]]


@pytest.mark.parametrize(
    ("master", "more", "values"),
    [
        ("beckhoff_el5042", (), [1, 19]),  # 1 is 5 MHz. The EJ5042 has none of these clocks but 250 kHz, which is 19.
        ("beckhoff_el5042", ("--cable", "50"), [4, 19]),  # 4 is 2 MHz, the limit of AN15 for up to 60 m
        ("beckhoff_ax5000", (), [5000]),
        ("moteus", (), [1_000_000]),  # its fastest clock
    ],
)
def test_masters_start_with_a_clock_in_use(
    capsys: pytest.CaptureFixture[str], master: str, more: tuple[str, ...], values: list[int]
) -> None:
    rows = clock_settings(capsys, master, *more)
    assert [(value, bound) for value, bound, _ in rows] == [(value, "start_with") for value in values]
    assert all(note.startswith("The highest clock of the encoder is not known. ") for _, _, note in rows)


def test_a_clock_that_is_not_in_use_is_not_proposed(capsys: pytest.CaptureFixture[str]) -> None:
    """For 300 m, the table allows up to 200 kHz, but the slowest clock in use is 250 kHz."""
    assert clock_settings(capsys, "beckhoff_el5042", "--cable", "300") == []


def test_files_for_masters_say_so(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["master", "RESOLUTE-32", "--master", "beckhoff_ax5000", "--format", "soe_structure"]
    assert main([*arguments, "--specs", str(ENCODERS)]) == 0
    text = capsys.readouterr().out
    assert ";Sensor mode: Max clock speed, start with;208;16;5000;" in text
    joined = " ".join(text.replace("#", " ").split())
    assert (
        "Only a value to start with, because the highest clock of the encoder is not known: Sensor mode: Max" in joined
    )


def test_the_example_of_a_page_is_not_below_the_lowest_clock(tmp_path: Path) -> None:
    """Only the lowest clock is known. It is above 1 MHz, at which pages otherwise give the duration of a frame."""
    spec = tmp_path / "my_encoder.yaml"
    write_spec("my_encoder", spec, like="ssi")
    text = spec.read_text(encoding="utf-8")
    assert text.count("min_hz: 100000, max_hz: 1000000,") == 1
    spec.write_text(text.replace("min_hz: 100000, max_hz: 1000000,", "min_hz: 2000000,"), encoding="utf-8")
    devices, report = load_library([tmp_path])
    assert not report.problems
    page = pages(Library(tuple(devices)))["docs/my_encoder/MY-ENCODER-13-1-BG.md"]
    assert "13 bits at 2 MHz: 6.5 µs." in page
