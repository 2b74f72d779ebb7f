"""Specs in the language before the first release get the current names, and are otherwise unchanged."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.new import device_text, manufacturer_text

#: Beginning of a spec, its current text, and the text in the language of 21 November 2026.
RENAMED = {
    "rotary": ("", "counts_per_turn: 2^", "steps_per_turn: 2^"),
    "quoted": ("", "counts_per_turn: 2^", '"steps_per_turn": 2^'),
    "linear": ("linear", "modulus: 2^", "steps: 2^"),
}


def write_specs(folder: Path, text: str, end: str = "\n", mark: bytes = b"") -> Path:
    folder.mkdir()
    (folder / "manufacturer.yaml").write_text(manufacturer_text("m.json"), encoding="utf-8")
    (folder / "my_encoder.yaml").write_bytes(mark + text.replace("\n", end).encode())
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(("like", "new", "old"), RENAMED.values(), ids=RENAMED)
@pytest.mark.parametrize(("end", "mark"), [("\n", b""), ("\r\n", b"\xef\xbb\xbf")], ids=["unix", "windows"])
def test_keys_get_their_new_names_and_the_rest_stays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], like: str, new: str, old: str, end: str, mark: bytes
) -> None:
    current = device_text("my_encoder", "example", "d.json", like)
    assert current.count(new) == 1
    before = write_specs(tmp_path / "before", current.replace(new, old), end, mark)
    folder = write_specs(tmp_path / "specs", current.replace(new, old), end, mark)
    spec = folder / "my_encoder.yaml"
    assert main(["migrate", "--check", str(folder)]) == 1
    assert capsys.readouterr().out.endswith("1 change to apply\n")
    assert spec.read_bytes() == (before / "my_encoder.yaml").read_bytes()
    assert main(["migrate", str(folder)]) == 0
    line, _, _ = capsys.readouterr().out.partition("\n")
    assert line.startswith(f"{spec}:{current[: current.index(new)].count(chr(10)) + 1}:")
    after = current.replace(new, f'"{new[: new.index(":")]}"{new[new.index(":") :]}') if '"' in old else current
    assert spec.read_bytes() == mark + after.replace("\n", end).encode()
    assert main(["migrate", str(folder)]) == 0
    assert capsys.readouterr().out == "0 changes applied, nothing to decide\n"
    assert sorted(path.name for path in folder.iterdir()) == ["manufacturer.yaml", "my_encoder.yaml"]
    assert main(["diff", str(before), str(folder)]) == 0
    assert capsys.readouterr().out == "no differences\n"


def test_a_decision_is_listed_with_its_place(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = device_text("my_encoder", "example", "d.json", "rs485")
    flag = "at: 4, active: high, makes_position: not_usable,"
    assert flag in text
    text = text.replace(flag, "at: 4, active: high,").replace("counts_per_turn", "steps_per_turn")
    folder = write_specs(tmp_path / "specs", text)
    assert main(["migrate", str(folder)]) == 1
    out = capsys.readouterr().out.splitlines()
    line = text[: text.index("at: 4, active: high,")].count("\n") + 1
    assert out[1].startswith(f"{folder}/my_encoder.yaml:{line}:9: makes-position-missing: 'encoder_error'")
    assert out[-1] == "1 change applied, 1 place to decide by hand"


def test_a_key_that_is_there_under_both_names_is_left_to_a_person(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = device_text("my_encoder", "example", "d.json").replace("turns: 1,", "turns: 1, steps_per_turn: 4096,")
    folder = write_specs(tmp_path / "specs", text)
    assert main(["migrate", str(folder)]) == 1
    assert (folder / "my_encoder.yaml").read_text(encoding="utf-8") == text
    assert "unknown-key: unknown key 'steps_per_turn'" in capsys.readouterr().out


def test_without_specs_there_is_nothing_to_migrate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["migrate"]) == 2
    assert capsys.readouterr().err == (
        "codewheel: there are no specs in this folder or below it; name them: codewheel migrate FOLDER, or list them "
        "under [tool.codewheel] in pyproject.toml\n"
    )


def test_a_later_language_needs_a_later_version(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = device_text("my_encoder", "example", "d.json").replace("codewheel: 1\n", "codewheel: 2\n")
    assert main(["check", str(write_specs(tmp_path / "specs", text))]) == 1
    assert "'codewheel' must be 1, not 2; a later version of codewheel can read this file" in capsys.readouterr().out


def test_an_erratum_without_a_title_is_a_place_to_decide(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    erratum = (
        "errata:\n  - {name: width, source: '1', printed: a, used: b, why: c, status: settled, severity: wording}\n"
    )
    folder = write_specs(tmp_path / "specs", device_text("my_encoder", "example", "d.json") + erratum)
    assert main(["migrate", str(folder)]) == 1
    out = capsys.readouterr().out.splitlines()
    line = (folder / "my_encoder.yaml").read_text(encoding="utf-8").count("\n")
    assert out[0].startswith(f"{folder}/my_encoder.yaml:{line}:")
    assert "missing-key: 'title' is missing; an erratum needs it" in out[0]
    assert out[-1] == "0 changes applied, 1 place to decide by hand"
