"""Order codes that are on no label are marked as made up, wherever an encoder is named by such a code."""

from __future__ import annotations

import json

import pytest
from codewheel.commands.cli import main
from codewheel.say import text_on_one_line
from codewheel.targets import Library
from codewheel.targets.browser.files import family_data
from codewheel.targets.c.files import generate as generate_c
from codewheel.targets.docs.files import generate
from codewheel.targets.python.files import generate as generate_python

UNCORROBORATED = {
    *("acuro", "as38", "bml_s1g", "c58", "dl100", "dl1000", "icmn", "icmr", "icpvl"),
    *("kcd", "la11", "msa213c", "ocd", "wdga"),
}
SAID = "Made-up order code: The chip's label has only its name."


def _printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    capsys.readouterr()
    main(arguments)
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("arguments", [("decode", "iC-MU-38-7", "0x0"), ("show", "iC-MU-38-7"), ("show", "icmu")])
def test_commands_say_it(capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]) -> None:
    assert SAID in _printed(capsys, *arguments)
    assert "Made-up" not in _printed(capsys, arguments[0], "AMM5A21/65KSC1", *arguments[2:])


def test_pages_say_it(every_encoder: Library) -> None:
    devices = {device.name: device for device in every_encoder.devices}
    pages = generate(Library((devices["icmu"], devices["as5047p"])))
    assert SAID in pages["docs/icmu/iC-MU-38-7.md"]
    assert "Made-up order codes: The chip's label has only its name." in " ".join(pages["docs/icmu.md"].split())
    assert "Made-up" not in pages["docs/as5047p/AS5047P.md"]
    assert any(text.startswith(SAID) for text in family_data(devices["icmu"])["about"])


MADE_UP, ON_LABEL = ("c58", "icmr", "amt22", "dl100"), ("as5047p", "amm5", "tle5012b")


@pytest.mark.one_in(4, "slow")
@pytest.mark.parametrize("name", [*MADE_UP, *ON_LABEL])
def test_packages_say_it(every_encoder: Library, name: str) -> None:
    """A README or a program names no label for a made-up order code, and says what the label shows instead."""
    (device,) = (device for device in every_encoder.devices if device.name == name)
    library = Library((device,))
    python_readme = generate_python(library)["python/README.md"]
    c_files = generate_c(library)
    programs = [text for path, text in c_files.items() if path.startswith("c/examples/")]
    for text in (python_readme, c_files["c/README.md"], *programs):
        names_label = "order code on the label" in text or "order code from the label" in text
        assert names_label is (name in ON_LABEL)
    first_words = text_on_one_line(device.order_code.not_on_label).partition(".")[0]
    assert first_words in python_readme
    assert first_words in c_files["c/README.md"]


def test_the_c58_says_what_its_codes_and_decoders_lack(capsys: pytest.CaptureFixture[str]) -> None:
    """Its default of 24 data bits has no order code, and its check sum is not checked."""
    assert not any(code.startswith("C58-24") for code in _printed(capsys, "show", "c58").split())
    assert "No order code has the default of 24 data bits" in _printed(capsys, "show", "c58")
    position_1 = f"0b{1 << 18:043b}"
    assert "TR check sum. It is not checked, because" in _printed(capsys, "decode", "C58-25B-C25", position_1)


def test_every_code_with_a_width_of_our_own_says_it(every_encoder: Library) -> None:
    """The families whose sources name no labels. The widths of other codes are in their sources."""
    made_up = {device.name for device in every_encoder.devices if device.order_code.not_on_label}
    settings = {"acuro", "bml_s1g", "c58", "dl100", "dl1000", "icmn", "icmr", "icpvl"}
    assert made_up == {"aksim2", "amt22", "icmu", "orbis", "orbis_serial", "resolute", "resolute_linear"} | settings


def test_lists_mark_what_is_uncorroborated(capsys: pytest.CaptureFixture[str], every_encoder: Library) -> None:
    uncorroborated = {device.name for device in every_encoder.devices if device.evidence.grade == "uncorroborated"}
    assert uncorroborated == UNCORROBORATED
    main(["list", "--json"])
    families = json.loads(capsys.readouterr().out)["families"]
    assert {row["family"] for row in families if row["evidence"] == "uncorroborated"} == uncorroborated
    main(["list"])
    assert capsys.readouterr().out.count("evidence     uncorroborated\n") == len(uncorroborated)
    assert {device.name for device in every_encoder.devices if "mark" in family_data(device)} == uncorroborated


@pytest.mark.slow
def test_pages_of_lists_mark_it(every_encoder: Library) -> None:
    pages = generate(every_encoder)
    rows = [line for line in pages["docs/which-encoder.md"].splitlines() if "(uncorroborated)" in line]
    assert sorted(row.split("](")[1].partition(".md")[0] for row in rows) == sorted(UNCORROBORATED)
    assert pages["docs/README.md"].count("| uncorroborated |") == len(UNCORROBORATED)
