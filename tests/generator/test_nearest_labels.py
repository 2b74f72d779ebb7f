"""Messages about labels that are not an order code: the family that is meant, and the nearest codes."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.cli import main

ENCODERS = Path(__file__).resolve().parents[2] / "specs"


def refusal(capsys: pytest.CaptureFixture[str], label: str, *specs: str) -> str:
    """Return the message of ``decode``, with all specs or those of these manufacturers."""
    options = [option for name in specs for option in ("--specs", str(ENCODERS / name))]
    assert main(["decode", label, "0x1", *options]) == 2
    return capsys.readouterr().err.removeprefix("codewheel: ").strip()


@pytest.mark.parametrize(
    ("label", "family", "example"), [("iC-MR", "icmr", "iC-MR-0-N6S"), ("iC-MU", "icmu", "iC-MU-16-0")]
)
def test_the_name_of_a_chip_is_a_family(
    capsys: pytest.CaptureFixture[str], label: str, family: str, example: str
) -> None:
    """The pattern ``iC-{chip}`` of another family also matches it, with a chip that is not listed."""
    expected = f"'{label}' is a family; give an order code, such as {example} (codewheel show {family} explains them)"
    assert refusal(capsys, label, "ichaus") == expected


def test_the_family_with_the_longest_beginning_explains_the_label(capsys: pytest.CaptureFixture[str]) -> None:
    message = refusal(capsys, "iC-MR-24-L16S", "ichaus")
    assert "has turns '24' and crc '16', which cannot be combined; the nearest codes are iC-MR-24-L6S" in message
    assert "has turns '13'; valid values: 0, 12, 24" in refusal(capsys, "iC-MR-13-L6T", "ichaus")
    assert "the nearest are iC-MU-28-0" in refusal(capsys, "iC-MU-28", "ichaus")


@pytest.mark.parametrize("label", ["", " ", "\t"])
def test_an_empty_order_code_is_called_empty(capsys: pytest.CaptureFixture[str], label: str) -> None:
    assert refusal(capsys, label) == "the order code is empty; give the code on the label"


@pytest.mark.parametrize("label", ["-", "/"])
def test_marks_alone_are_not_like_a_family_of_one_part(capsys: pytest.CaptureFixture[str], label: str) -> None:
    """The pattern of the AS5047P is ``{model}``, so that its code without the part is empty."""
    expected = f"'{label}' is not a known order code; codewheel list shows the known patterns. "
    expected += "To describe an encoder without a spec, write it in one line, such as ssi:position=25,error=low"
    assert refusal(capsys, label, "ams") == expected


def test_hyphens_and_slashes_are_alike_in_the_nearest_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert "the nearest are AMM5A21/65KSC1," in refusal(capsys, "AMM5A21-65KSC1", "lika")
    assert "the nearest are SMA21-JP1-0050," in refusal(capsys, "SMA21/JP1/0050", "lika")


def test_codes_that_begin_with_the_label_come_first(capsys: pytest.CaptureFixture[str]) -> None:
    """``iC-MU150`` is written like the shorter ``iC-MU-16-0``, but names the other chip."""
    assert "the nearest are iC-MU150-16-0, iC-MU150-16-2, iC-MU150-16-7" in refusal(capsys, "iC-MU150", "ichaus")
