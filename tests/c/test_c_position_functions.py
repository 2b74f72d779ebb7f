"""Every interface has the functions that read positions and, if its spec gives their unit, those that convert them."""

from __future__ import annotations

import re

import pytest
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate

#: The spec leaves out what its position measures: that depends on the configuration of the chip.
WITHOUT_UNIT = {"ichaus/icmu_biss.h"}
#: A linear scale and distance sensors whose range of positions exceeds what they can measure.
NEVER_WRAPS = {"renishaw/resolute_linear_biss.h", "sick/dl100_ssi.h", "sick/dl1000_ssi.h"}
#: Linear encoders. A wire or a tape has no turns.
LINEAR = {
    *("balluff/bml_s1g_biss.h", "balluff/bml_s1g_ssi.h", "renishaw/resolute_linear_biss.h", "rls/la11_biss.h"),
    *("sick/dl100_ssi.h", "sick/dl1000_ssi.h", "siko/msa213c_biss.h"),
    *("lika/sma21_biss.h", "lika/sma21_rs485.h", "lika/sma21_ssi.h"),
}


@pytest.fixture(scope="module")
def headers() -> dict[str, str]:
    """The headers for reading positions of all packaged encoders, by their include paths."""
    devices: tuple[Device, ...] = load_library()[0]
    files = generate(Library(devices))
    names = {path: path.removeprefix("c/include/") for path in files if re.search(r"_(biss|ssi|spi|rs485)\.h$", path)}
    return {name: files[path] for path, name in names.items()}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "without"),
    [
        ("position", set()),
        ("modulus", WITHOUT_UNIT | NEVER_WRAPS),
        ("counts_per_turn", WITHOUT_UNIT | LINEAR),
    ],
)
def test_every_interface_has_the_function(ending: str, without: set[str], headers: dict[str, str]) -> None:
    assert len(headers) > 40
    missing = {
        name
        for name, text in headers.items()
        if not re.search(rf"^static inline \w+ \w+_{ending}\(", text, re.MULTILINE)
    }
    assert missing == without


@pytest.mark.slow
def test_every_interface_reads_a_position_with_the_order_code_named_once(headers: dict[str, str]) -> None:
    for name, text in headers.items():
        for macro in ("READ", "READ_BYTES"):
            assert re.search(rf"^#define \w+_{macro}\(", text, re.MULTILINE), (name, macro)


@pytest.mark.slow
def test_a_header_without_the_unit_of_its_positions_says_so(headers: dict[str, str]) -> None:
    sentence = "The spec leaves the size of a count open."
    assert {name for name, text in headers.items() if sentence in text} == WITHOUT_UNIT
