"""Values that are still the template's of ``new``: where they are listed, and which grade allows them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.new import LIKE, device_text
from codewheel.commands.outputs import load_for_targets, targets_named
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.render import our_templates
from codewheel.targets import Library

#: Every fact in the template of a singleturn encoder over BiSS, by the line of its text or source.
FACTS = {
    15: "title", 19: "evidence.documents.manual", 22: "manual.title", 37: "parameters.singleturn_bits",
    43: "order_code", 57: "measurement", 69: "crcs.biss_6", 84: "interfaces.biss", 85: "interfaces.biss.clock",
    90: "interfaces.biss.single_cycle_data", 117: "registers.command", 130: "registers.preset",
    141: "procedures.set_preset", 153: "examples.preset_register", 161: "examples.position",
}  # fmt: skip


@pytest.fixture
def new_spec(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    assert main(["new", "my_encoder", "-o", str(tmp_path)]) == 0
    capsys.readouterr()
    return tmp_path / "my_encoder.yaml"


def test_check_lists_each_with_its_line(new_spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(new_spec)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "16 values are still from the template (each has the word TODO):" in lines
    expected = [f"  {new_spec}:{line}: {name}" for line, name in FACTS.items()]
    assert [line for line in lines if f"{new_spec}:" in line and line.startswith("  ")] == expected
    assert f"  {new_spec.with_name('manufacturer.yaml')}:4: title" in lines
    assert main(["check", "--json", str(new_spec)]) == 0
    listed = json.loads(capsys.readouterr().out)["placeholders"]
    assert {place["line"]: place["name"] for place in listed if place["file"] == str(new_spec)} == FACTS


@pytest.mark.slow
def test_generate_and_every_output_say_so(new_spec: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    first = f"the first at {new_spec}:15; codewheel check lists them\n"
    for _ in range(2):  # The second run only compares.
        assert main(["generate", str(new_spec), "-o", str(out)]) == 0
        assert f"16 values are still from the template, {first}" in capsys.readouterr().out
    names = [*FACTS.values(), "manufacturer.title"]
    sentence = f"16 values are still from the template, not from the manufacturer: {', '.join(names)}"
    for path in (
        "docs/my_encoder.md",
        "docs/my_encoder/MY-ENCODER-17-SC.md",
        "python/README.md",
        "c/include/example/my_encoder_biss.h",
    ):
        text = (out / path).read_text(encoding="utf-8")
        plain = " ".join(text.replace("\n *", " ").replace("\\", "").split())
        assert sentence in plain, path
    assert sentence in (out / "browser" / "decode.js").read_text(encoding="utf-8").replace("\\'", "'")
    assert "registers.preset" in (out / "biss" / "example-my_encoder.xml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_decode_says_so(new_spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frame = "0b0001111101000_1_1_011010"
    assert main(["decode", "MY-ENCODER-13-SC", frame, "--specs", str(new_spec.parent)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "evidence: uncorroborated 16 values are still from the template" in printed


def test_a_manufacturer_that_is_still_the_template_s_allows_only_the_lowest_grade(new_spec: Path) -> None:
    manual = new_spec.read_text(encoding="utf-8").replace("TODO pages that were read", "all pages")
    manual = manual.replace("TODO ", "").replace("grade: uncorroborated", "grade: manual")
    new_spec.write_text(manual, encoding="utf-8")
    (problem,) = load_for_targets([new_spec.parent], targets_named())[1].problems
    assert (problem.line, problem.rule) == (19, "evidence-grade")
    assert "with grade 'manual': manufacturer.title;" in problem.message
    maker = new_spec.with_name("manufacturer.yaml")
    maker.write_text(maker.read_text(encoding="utf-8").replace("TODO Name of the manufacturer", "Acme"))
    devices, report = load_for_targets([new_spec.parent], targets_named())
    assert report.problems == ()
    assert devices[0].evidence.placeholders == ()
    (docs,) = (target for target in targets_named() if target.name == "docs")
    assert not [path for path, text in docs.files(Library(devices), {}).items() if "template's" in text]


@pytest.mark.parametrize("like", ["biss-singleturn", *LIKE])
def test_templates_are_whole_specs_that_share_their_head(like: str) -> None:
    """Editors check them with the schema of the checkout."""
    template = our_templates("new") / f"{like}.yaml"
    document = read_document(template, ProblemReport())
    assert document is not None
    assert document.data["device"] == "my_encoder"
    schema = document.lines[0].partition("$schema=")[2]
    assert (template.parent / schema).resolve().name == "device.schema.json"
    assert head(template) == head(our_templates("new") / "biss-singleturn.yaml")


def head(template: Path) -> list[str]:
    """Return the lines before the order code, without the movement."""
    lines = template.read_text(encoding="utf-8").partition("# ----")[0].splitlines()
    return [line for line in lines if not line.startswith("movement: ")]


def test_names_replace_those_of_the_template() -> None:
    text = device_text("ab_2", "acme", "x.json", "ssi")
    assert "MY-ENCODER" not in text
    assert "my_encoder" not in text
    assert text.splitlines()[0] == "# yaml-language-server: $schema=x.json"
    assert "\nmanufacturer: acme\n" in text
    assert 'pattern: "AB-2-{singleturn}-{turns}-{output}"' in text
