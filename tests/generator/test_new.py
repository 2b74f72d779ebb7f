"""The spec that ``new`` writes passes check and yields every output."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from codewheel.commands import new
from codewheel.commands.cli import main
from codewheel.commands.outputs import load_for_targets, targets_named
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.targets import Library
from codewheel.targets.biss.files import generate as generate_biss
from codewheel.targets.docs.files import generate as generate_docs

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.slow
def test_it_passes_check_and_decodes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "my_encoder", "-o", str(tmp_path)]) == 0
    names = ("my_encoder.yaml", "manufacturer.yaml", "device.schema.json", "manufacturer.schema.json")
    assert capsys.readouterr().out == "".join(f"written    {tmp_path}/{name}\n" for name in names)
    devices, report = load_for_targets([tmp_path], targets_named())
    assert not report.problems
    (device,) = devices
    assert [variant.code for variant in device.variants] == ["MY-ENCODER-13-SC", "MY-ENCODER-17-SC"]
    assert device.layout("single_cycle_data").place(device.variants[1].parameters).bits == 17 + 1 + 1 + 6
    assert "docs/my_encoder.md" in generate_docs(Library(devices))
    assert "biss/example-my_encoder.xml" in generate_biss(Library(devices))
    # 13 bits of 1000, error and warning bit high (not active), and the inverted remainder of the division of
    # these 15 bits by x^6 + x + 1.
    assert main(["decode", "MY-ENCODER-13-SC", "0b0001111101000_1_1_011010", "--specs", str(tmp_path)]) == 0
    assert "no frame error" in capsys.readouterr().out


#: Per kind, an order code, a frame with 5 revolutions and 1000 counts, and its position. Linear and SPI: only 1000. The
#: CRC over RS-485 is the XOR of the bytes. That over BiSS is the inverted remainder of the division by x^6 + x + 1.
STARTS = {
    "ssi": ("MY-ENCODER-13-4096-BG", "0b000000000101_0001111101000", 5 * 8192 + 1000),
    "rs485": ("MY-ENCODER-17-4096-JP", "1A 00 E8 03 00 17 05 00 00 00 E3", 5 * 131_072 + 1000),
    "rs485-exchanges": ("MY-ENCODER-17-4096-RS", "01 42 00 00 05 00 03 E8 AD", 5 * 131_072 + 1000),
    "biss": ("MY-ENCODER-13-1-SC", "0b0001111101000_1_1_011010", 1000),
    "spi": ("MY-ENCODER-SP", "0b0_0_00001111101000", 1000),
    "linear": ("MY-ENCODER-5-SC", "0b000000000_0001111101000_1_1_011010", 1000),
}


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "code", "frame", "position"), [(kind, *row) for kind, row in STARTS.items()])
def test_each_start_passes_check_and_decodes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, code: str, frame: str, position: int
) -> None:
    assert main(["new", "my_encoder", "--like", kind, "-o", str(tmp_path)]) == 0
    assert not load_for_targets([tmp_path], targets_named())[1].problems
    text = (tmp_path / "my_encoder.yaml").read_text(encoding="utf-8")
    assert ("join: {position: [multiturn, singleturn]}" in text) == (kind not in {"linear", "spi"})
    assert "@" not in text
    capsys.readouterr()
    assert main(["decode", code, frame, "--json", "--specs", str(tmp_path)]) == 0
    decoded = json.loads(capsys.readouterr().out)
    assert {field["name"]: field["value"] for field in decoded["fields"]}["position"] == position
    assert decoded["problems"] == []


def modeline(path: Path) -> str:
    return path.read_text(encoding="utf-8").splitlines()[0].partition("$schema=")[2]


def test_whoever_clones_the_spec_has_its_schema(tmp_path: Path) -> None:
    assert main(["new", "demo", "-o", str(tmp_path / "demo.yaml")]) == 0
    for kind, name in (("device", "demo.yaml"), ("manufacturer", "manufacturer.yaml")):
        assert modeline(tmp_path / name) == f"{kind}.schema.json"
        assert (tmp_path / f"{kind}.schema.json").read_bytes() == (
            ROOT / "generator" / "language" / f"{kind}.schema.json"
        ).read_bytes()


@pytest.mark.parametrize("place", ["generator/language", ".venv/lib/site-packages/codewheel/language"])
def test_in_the_tools_own_checkout_the_schema_is_not_copied(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "specs").mkdir()
    shutil.copytree(ROOT / "generator" / "language", tmp_path / place)
    monkeypatch.setattr(new, "_schema_of_tool", lambda kind: tmp_path / place / f"{kind}.schema.json")
    assert main(["new", "demo", "-o", str(tmp_path / "specs")]) == 0
    of_the_tool = "site-packages" not in place
    assert modeline(tmp_path / "specs/demo.yaml") == (
        "../generator/language/device.schema.json" if of_the_tool else "device.schema.json"
    )
    assert (tmp_path / "specs/device.schema.json").exists() != of_the_tool


def test_a_schema_that_is_there_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "device.schema.json").write_text("{}")
    assert main(["new", "demo", "-o", str(tmp_path)]) == 0
    assert (tmp_path / "device.schema.json").read_text() == "{}"


def test_a_manufacturer_that_is_there_is_used(tmp_path: Path) -> None:
    (tmp_path / "manufacturer.yaml").write_text(
        'codewheel: 1\nmanufacturer: acme\ntitle: Acme\nsource: "1"\n', encoding="utf-8"
    )
    assert main(["new", "demo", "-o", str(tmp_path)]) == 0
    document = read_document(tmp_path / "demo.yaml", ProblemReport())
    assert document is not None
    assert document.data["manufacturer"] == "acme"
    assert not load_for_targets([tmp_path], targets_named())[1].problems
    assert "Acme" in (tmp_path / "manufacturer.yaml").read_text(encoding="utf-8")


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "demo.yaml").write_text("mine", encoding="utf-8")
    assert main(["new", "demo", "-o", str(tmp_path)]) == 1
    assert capsys.readouterr().err == f"codewheel: {tmp_path}/demo.yaml already exists and is not overwritten\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["demo.yaml"]
    assert (tmp_path / "demo.yaml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("name", ["My Encoder", "1x", "", "../x", "class", "manufacturer", "x" * 41, "lookup", "aux"])
def test_names_that_cannot_be(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    assert main(["new", name, "-o", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith("codewheel: '")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "suggested"),
    [("My-Encoder", "my_encoder"), ("Class", "encoder_1"), ("Manufacturer", "encoder_1"), ("Lookup", "encoder_1")],
)
def test_the_name_suggested_can_be_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, suggested: str
) -> None:
    assert main(["new", name, "-o", str(tmp_path)]) == 2
    assert capsys.readouterr().err.endswith(f", such as {suggested}\n")
    assert main(["new", suggested, "-o", str(tmp_path)]) == 0


def test_a_file_is_named_like_its_family(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "demo", "-o", str(tmp_path / "other.yaml")]) == 2
    assert "the file of a spec has its family's name" in capsys.readouterr().err
    file = tmp_path / "file"
    file.touch()
    assert main(["new", "demo", "-o", str(file / "demo.yaml")]) == 1
    assert f"{file} already exists and is not overwritten" in capsys.readouterr().err
    assert main(["new", "demo", "-o", str(tmp_path / "new" / "folder" / "demo.yaml")]) == 0
    assert (tmp_path / "new" / "folder" / "manufacturer.yaml").is_file()


@pytest.mark.parametrize(("gain", "problems"), [(5, 0), (4, 1)])
def test_an_example_may_have_anything_in_unspecified_bits(tmp_path: Path, gain: int, problems: int) -> None:
    """The byte B5 has the flag of bit 7, 5 in bits 3:0, and 011 in the bits without a field."""
    assert main(["new", "my_encoder", "--like", "spi", "-o", str(tmp_path)]) == 0
    spec = tmp_path / "my_encoder.yaml"
    example = "{name: read, kind: register, register: diagnostics, order_code: MY-ENCODER-SP, bytes: B5, "
    example += f'values: {{field_weak: true, gain: {gain}}}, source: "6.1"}}'
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace("\nexamples:\n", f"\nexamples:\n  - {example}\n"), encoding="utf-8")
    assert len(load_for_targets([tmp_path], targets_named())[1].problems) == problems
