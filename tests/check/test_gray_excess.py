"""Gray code with counts per turn that are not a power of two is sent with an excess."""

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


#: The excess of both order codes, as the message asks for it.
EXCESS = (
    ("  ssi_gray: {meaning: 1 for Gray code}", "  ssi_gray: {meaning: 1 for Gray code}\n  first: {meaning: Code of 0}"),
    ('"512": {sets: {counts: 512}}', '"512": {sets: {counts: 512, first: 0}}'),
    ('"360": {sets: {counts: 360}}', '"360": {sets: {counts: 360, first: 76}}'),
    ("when: ssi_gray}", "when: ssi_gray, excess: first}"),
)


def test_the_excess_that_the_message_asks_for(tmp_path: Path) -> None:
    assert _rules(_write(tmp_path, *EXCESS)) == []


@pytest.mark.parametrize("wrong", [0, 75, 77, 152, 436])
def test_another_excess_is_refused(tmp_path: Path, wrong: int) -> None:
    changes = [(old, new.replace("first: 76", f"first: {wrong}")) for old, new in EXCESS]
    assert _rules(_write(tmp_path, *changes)) == ["gray-excess"]


def test_the_excess_of_order_codes_in_binary_does_not_matter(tmp_path: Path) -> None:
    changes = [(old, new.replace("first: 0", "first: 5")) for old, new in EXCESS]
    without_gray = ("sets: {ssi_gray: 1}", "sets: {ssi_gray: 0}")
    assert _rules(_write(tmp_path, *changes, without_gray)) == []


def test_a_way_out_exists(tmp_path: Path) -> None:
    """Without an excess, leave 'gray' and 'measurement' out, and call the field 'gray_code', as the message says.

    The parameters of both are then unused.
    """
    raw = _write(
        tmp_path,
        ("        gray: {of: position, when: ssi_gray}\n", ""),
        ('measurement: {of: position, counts_per_turn: counts, turns: 1, source: "6.2"}\n', ""),
        ("{name: position, bits: 9}", "{name: gray_code, bits: 9}"),
    )
    assert _rules(raw) == ["unused-parameter", "unused-parameter"]


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


def test_a_counter_of_turns_may_be_in_gray_code(tmp_path: Path) -> None:
    """One count per turn is a power of two, although it is odd."""
    one_count = ('"512": {sets: {counts: 512}}', '"512": {sets: {counts: 1}}')
    turns = ("counts_per_turn: counts, turns: 1,", "counts_per_turn: counts, turns: 512,")
    folder = _write(tmp_path, ('        "360": {sets: {counts: 360}}\n', ""), one_count, turns)
    assert _rules(folder) == []


def test_only_masters_with_remainder_code_get_settings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Omron's manual W524, page 7-46: Encoder Resolution is the counts per turn, and the code is Gray code."""
    specs = str(_write(tmp_path, *EXCESS))
    assert main(["master", "EXC360G", "--specs", specs, "--master", "omron_nx"]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["Encoder", "Resolution", "360"] in lines
    assert ["Coding", "Method", "gray", "code"] in lines
    for master in ("siemens_posinput", "galil_ssi", "beckhoff_el5042", "keb_f6", "synapticon", "linuxcnc_hostmot2"):
        assert main(["master", "EXC360G", "--specs", specs, "--master", master]) != 0
        assert "Gray excess" in capsys.readouterr().out or master == "keb_f6"
    assert main(["master", "EXC512G", "--specs", specs, "--master", "galil_ssi"]) == 0


def test_no_master_gets_settings_for_the_way_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The settings would be the settings of a binary position."""
    raw = _write(
        tmp_path,
        ("        gray: {of: position, when: ssi_gray}\n", ""),
        ('measurement: {of: position, counts_per_turn: counts, turns: 1, source: "6.2"}\n', ""),
        ("{name: position, bits: 9}", "{name: gray_code, bits: 9}"),
    )
    assert main(["master", "EXC360G", "--specs", str(raw), "--master", "omron_nx"]) != 0
    assert "Encoder Resolution" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("wrong", "rule"), [("first", "undefined-reference"), ("2 *", "bad-expression"), ("2^200", "bad-expression")]
)
def test_an_excess_must_be_an_expression_of_parameters(tmp_path: Path, wrong: str, rule: str) -> None:
    power_of_two = ('        "360": {sets: {counts: 360}}\n', "")
    assert _rules(_write(tmp_path, power_of_two)) == []
    changes = (power_of_two, ("when: ssi_gray}", f'when: ssi_gray, excess: "{wrong}"}}'))
    assert _rules(_write(tmp_path, *changes)) == [rule]
