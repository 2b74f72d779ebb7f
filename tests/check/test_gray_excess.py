"""Gray code with counts per turn that are not a power of two is sent with an excess, which a spec cannot describe."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library

FOLDER = Path(__file__).parent / "broken_model"


def _write(folder: Path, *changes: tuple[str, str]) -> Path:
    """Write the spec that breaks the rule, with some changes."""
    text = (FOLDER / "gray_excess.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "manufacturer.yaml").write_bytes((FOLDER / "manufacturer.yaml").read_bytes())
    (folder / "gray_excess.yaml").write_text(text, encoding="utf-8")
    return folder


def _rules(folder: Path) -> list[str]:
    _, report = load_library([folder])
    return [problem.rule for problem in report.problems]


def test_the_way_out_exists(tmp_path: Path) -> None:
    """The message tells to leave 'gray' and 'measurement' out, and to call the field 'gray_code'."""
    raw = _write(
        tmp_path,
        ("        gray: {of: position, when: ssi_gray}\n", ""),
        ('measurement: {of: position, counts_per_turn: counts, turns: 1, source: "6.2"}\n', ""),
        ("{name: position, bits: 9}", "{name: gray_code, bits: 9}"),
    )
    assert _rules(raw) == []


@pytest.mark.parametrize("counts", [360, 500, 720, 3600])
def test_counts_that_are_no_power_of_two_are_refused(tmp_path: Path, counts: int) -> None:
    """The first code is (2^bits - counts) / 2, such as (512 - 360) / 2 = 76, so 0 degrees would be decoded as 76."""
    bits = counts.bit_length()
    assert (2**bits - counts) // 2 > 0
    changes = ('"360": {sets: {counts: 360}}', f'"360": {{sets: {{counts: {counts}}}}}')
    # The other code must use the bits, too.
    other_code = ('"512": {sets: {counts: 512}}', f'"512": {{sets: {{counts: {2**bits}}}}}')
    assert _rules(_write(tmp_path, changes, other_code, ("bits: 9", f"bits: {bits}"))) == ["gray-excess"]


def test_binary_code_may_have_any_counts(tmp_path: Path) -> None:
    without_gray = (
        "        G: {interface: ssi, sets: {ssi_gray: 1}}",
        "        G: {interface: ssi, sets: {ssi_gray: 0}}",
    )
    assert _rules(_write(tmp_path, without_gray)) == []


def test_a_power_of_two_may_be_in_gray_code(tmp_path: Path) -> None:
    assert _rules(_write(tmp_path, ('        "360": {sets: {counts: 360}}\n', ""))) == []


def test_no_master_gets_settings_for_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Omron's manual W524, page 7-46, has a remainder for it, which a spec cannot give."""
    specs = str(_write(tmp_path))
    assert main(["master", "EXC360G", "--specs", specs, "--master", "omron_nx"]) != 0
    captured = capsys.readouterr()
    assert "Encoder Resolution" not in captured.out
    assert "gray-excess" in captured.out + captured.err


def test_no_master_gets_settings_for_the_way_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The settings would be those of a binary position."""
    raw = _write(
        tmp_path,
        ("        gray: {of: position, when: ssi_gray}\n", ""),
        ('measurement: {of: position, counts_per_turn: counts, turns: 1, source: "6.2"}\n', ""),
        ("{name: position, bits: 9}", "{name: gray_code, bits: 9}"),
    )
    assert main(["master", "EXC360G", "--specs", str(raw), "--master", "omron_nx"]) != 0
    assert "Encoder Resolution" not in capsys.readouterr().out
