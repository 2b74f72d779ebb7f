"""The headers say in half a sentence what is used instead of an erratum, and ERRATA-*.md next to them says the rest."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from codewheel.model import Device
from codewheel.say.errata import paths_in_words
from codewheel.targets import Library
from codewheel.targets.c.files import generate

SPECS = Path(__file__).parents[2] / "specs" / "lika"
FAMILIES = ("am36", "amm5", "asc85", "sma21")


@pytest.fixture(scope="module")
def files(c_devices: tuple[Device, ...]) -> dict[str, str]:
    return generate(Library(c_devices))


def flat(text: str) -> str:
    """Return text in one line, without the marks of comments and of Markdown."""
    return " ".join(re.sub(r"^ \*|\\(?=\W)|[`*“”\"]", " ", text, flags=re.MULTILINE).split())


def words(text: str) -> str:
    """Return the words of a text, which Markdown and ASCII leave as they are."""
    return " ".join(re.findall(r"[A-Za-z0-9]+", text))


def titles_in(header: str) -> list[str]:
    return re.findall(r"Erratum: (.*?) \((?:open|resolved)\)", flat(header))


@pytest.mark.slow
def test_each_erratum_of_a_header_is_in_the_page_next_to_it(files: dict[str, str]) -> None:
    page = files["c/ERRATA-lika.md"]
    titles = set(re.findall(r"^### (.*)$", page, re.MULTILINE))
    mentioned = {title for path, text in files.items() if "/lika/" in path for title in titles_in(text)}
    assert len(mentioned) > 50
    assert {title for title in mentioned if title not in {flat(known) for known in titles}} == set()


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_the_page_has_all_that_a_spec_says(family: str, files: dict[str, str]) -> None:
    page = words(files["c/ERRATA-lika.md"])
    errata = yaml.safe_load((SPECS / f"{family}.yaml").read_text(encoding="utf-8"))["errata"]
    texts = [str(erratum[key]) for erratum in errata for key in ("title", "printed", "used", "why") if key in erratum]
    plain_texts = [text for text in texts if text.isascii()]
    assert len(plain_texts) > 20
    assert [text for text in plain_texts if words(text) not in page] == []


@pytest.mark.slow
def test_differences_from_other_editions_are_one_sentence_in_a_header(files: dict[str, str]) -> None:
    """Manual AMM5A AMM5B, edition 1.8 introduced AMM5B, and 1.9 is transcribed."""
    headers = [text for path, text in files.items() if re.search(r"/lika/amm5_(biss|ssi|rs485)\.h$", path)]
    assert len(headers) == 3
    for header in headers:
        said = flat(header)
        assert said.count("Differences from other editions of the manual are noted in ERRATA-lika.md.") == 1
        assert "Before edition" not in said
    assert all("encoder's page" not in text for path, text in files.items() if path.startswith("c/include/"))
    assert "### Before edition 1.8" in files["c/ERRATA-lika.md"]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("interfaces.rs485.position_reply", "the RS-485 position reply"),
        ("interfaces.rs485.eeprom_read_reply", "the RS-485 EEPROM read reply"),
        ("interfaces.ssi.ssi_word", "the SSI word"),
        ("interfaces.biss.scd.fields.error", "the field error of the BiSS C-mode scd"),
        ("interfaces.biss.measurement", "the unit of the position of BiSS C-mode"),
        ("registers.bank.default", "the default of the register bank"),
        ("registers.bank.access", "the access of the register bank"),
        ("registers.status.data_valid", "the field data_valid of the register status"),
        ("field_groups.alarms.mt_error", "the field mt_error of the group alarms"),
        ("registers.bank.when_active", "the meaning of the register bank when active"),
        ("registers.bank, registers.eds, supply", "the registers bank and eds, and the supply"),
        ("registers.a, registers.b, registers.c and 2 more", "the registers a, b and c, and 2 more"),
        ("supply, inputs, leds", "the supply, the hardware inputs and the LEDs"),
        (
            "interfaces.biss.scd.error, interfaces.biss.scd.warning",
            "the error bit and the warning bit of the BiSS C-mode scd",
        ),
        ("connectors.plug.interfaces, connectors.cable.interfaces", "the interfaces of the connectors plug and cable"),
    ],
)
def test_the_interface_comes_before_its_part(path: str, expected: str) -> None:
    assert paths_in_words(path) == expected
