"""A word over SPI that does not fill its bytes: the header says which bits of the buffer it is."""

from __future__ import annotations

from pathlib import Path

from codewheel.commands.new import device_text, manufacturer_text
from codewheel.loading.library import load_library
from codewheel.targets import Library
from codewheel.targets.c.files import generate

SENTENCE = "The last bit of the word is bit 0 of the last byte."


def header(tmp_path: Path, bits: int) -> str:
    """Return the header of the encoder that ``new --like spi`` writes, with words of ``bits`` bits."""
    text = device_text("demo_spi", "example", "schema.json", "spi").partition("\nexamples:")[0]
    for old, new in (("word_bits: 16", f"word_bits: {bits}"), ("bits: 14,", f"bits: {bits - 2},")):
        text = text.replace(old, new)
    text = text.replace("2^14", f"2^{bits - 2}")
    for zeros in (7, 6):
        text = text.replace(f"bits: {zeros}, constant: 0", f"bits: {bits - 16 + zeros}, constant: 0")
    (tmp_path / "demo_spi.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(manufacturer_text("schema.json"), encoding="utf-8")
    devices, report = load_library([tmp_path / "demo_spi.yaml", tmp_path / "manufacturer.yaml"])
    assert not report, [problem.format() for problem in report.problems]
    (name,) = {name for name in generate(Library(devices)) if name.endswith("/demo_spi_spi.h")}
    return " ".join(generate(Library(devices))[name].replace("\n *", "").split())


def test_the_place_of_a_padded_word_is_stated(tmp_path: Path) -> None:
    assert SENTENCE in header(tmp_path, 20)
    assert SENTENCE not in header(tmp_path, 16)
