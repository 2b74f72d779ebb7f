"""Help around a release: forms for review tools, accepted changes, and the entry for an older edition."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml
from codewheel.changes.families import compare
from codewheel.changes.report import read_accepted
from codewheel.commands.cli import main, parser_for
from codewheel.commands.diff.spec_entries import edition_entries
from codewheel.commands.new import device_text, manufacturer_text
from codewheel.loading.library import load_families

SPEC = device_text("my_encoder", "example", "d.json")
CLOCK, SLOWER = "max_hz: 10000000", "max_hz: 5000000"


def write_specs(folder: Path, *edits: tuple[str, str]) -> Path:
    text = SPEC
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    folder.mkdir()
    (folder / "my_encoder.yaml").write_text(text, encoding="utf-8")
    (folder / "manufacturer.yaml").write_text(manufacturer_text("m.json"), encoding="utf-8")
    return folder


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, str, str]:
    exit_code = main([str(argument) for argument in arguments])
    return (exit_code, *capsys.readouterr())


@pytest.fixture
def old_and_new(tmp_path: Path) -> tuple[Path, Path]:
    return write_specs(tmp_path / "old"), write_specs(tmp_path / "new", (CLOCK, SLOWER))


LINE = SPEC[: SPEC.index(CLOCK)].count("\n") + 1
COLUMN = SPEC.splitlines()[LINE - 1].index("10000000") + 1


@pytest.mark.slow
def test_changes_as_comments_of_a_pull_request(
    old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    exit_code, out, _ = run(capsys, "diff", *old_and_new, "--format", "github")
    assert exit_code == 1
    place = f"{old_and_new[1]}/my_encoder.yaml,line={LINE},col={COLUMN}"
    assert out.startswith(f"::warning file={place},title=clock-narrower::BiSS: highest clock")
    assert out.count("\n") == 1


def test_problems_as_comments_of_a_pull_request(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = write_specs(tmp_path / "a,b", ("title: Set and save a preset", "title: “100%”"))
    exit_code, out, _ = run(capsys, "check", folder, "--format", "github")
    assert exit_code == 1
    # The workflow commands escape a percent sign everywhere, and a comma in properties.
    assert out.startswith(f"::error file={tmp_path}/a%2Cb/my_encoder.yaml,line=134,col=12,title=typographic-quotes::")
    assert 'write "100%25" with straight quotes' in out


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "diff"])
def test_sarif(old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str], command: str) -> None:
    """The members that the schema of SARIF 2.1.0 requires, with its types and enumerations."""
    new = old_and_new[1] / "my_encoder.yaml"
    if command == "check":
        new.write_text(SPEC.replace("address: 0x50", "address: 50"), encoding="utf-8")
    exit_code, out, _ = run(
        capsys, command, *(old_and_new if command == "diff" else (old_and_new[1],)), "--format", "sarif"
    )
    sarif = json.loads(out)
    assert (exit_code, sarif["version"]) == (1, "2.1.0")
    (sarif_run,) = sarif["runs"]
    assert sarif_run["columnKind"] in ("utf16CodeUnits", "unicodeCodePoints")
    assert sarif_run["tool"]["driver"]["name"] == "codewheel"
    (result,) = sarif_run["results"]
    assert [{"id": result["ruleId"]}] == sarif_run["tool"]["driver"]["rules"]
    assert result["level"] in ("none", "note", "warning", "error")
    assert isinstance(result["message"]["text"], str)
    (place,) = (location["physicalLocation"] for location in result["locations"])
    assert place["artifactLocation"]["uri"] == new.as_uri()
    line, column = (LINE, COLUMN) if command == "diff" else (123, 14)
    assert place["region"] == {"startLine": line, "startColumn": column}


def test_without_problems_the_forms_are_empty(
    old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(capsys, "check", old_and_new[0], "--format", "github")[:2] == (0, "\n")
    exit_code, out, _ = run(capsys, "check", old_and_new[0], "--format", "sarif")
    assert (exit_code, json.loads(out)["runs"][0]["results"]) == (0, [])
    exit_code, out, _ = run(capsys, "check", old_and_new[0], "--format", "json")
    assert (exit_code, json.loads(out)["problems"]) == (0, [])


ENTRY = "{family: my_encoder, rule: clock-narrower, path: interfaces.biss.clock.max_hz, why: no faster master, until: "


@pytest.mark.slow
@pytest.mark.parametrize(
    ("until", "code", "notice"),
    [
        (
            "2999-12-31",
            0,
            "accepted until 2999-12-31: my_encoder: clock-narrower interfaces.biss.clock.max_hz: no",
        ),
        ("2001-01-01", 1, "accepted until 2001-01-01 only, so asked again: my_encoder: clock-narrower"),
    ],
)
def test_a_change_is_accepted_until_a_date(
    old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str], until: str, code: int, notice: str
) -> None:
    (old_and_new[1] / "accepted.yaml").write_text(f"accepted:\n  - {ENTRY}{until}}}\n", encoding="utf-8")
    exit_code, out, _ = run(capsys, "diff", *old_and_new)
    assert exit_code == code
    assert notice in " ".join(out.split())
    assert "1 change: 1 behaviour" in out
    assert (run(capsys, "diff", *old_and_new, "--format", "github")[1].strip() == "") == (code == 0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("accepted:\n  - {rule: clock-narrower}\n", "accepted.yaml:2: an accepted change has the keys family, rule"),
        (f"accepted:\n  - {ENTRY.replace('narrower', 'narower')}2030-01-01}}\n", "did you mean 'clock-narrower'?"),
        (f"accepted:\n  - {ENTRY}soon}}\n", "accepted.yaml:2: 'until' is a date such as 2027-03-31, not 'soon'"),
        ("other: 1\n", "accepted.yaml:1: the file must have only the key 'accepted'"),
        ("accepted: [\n", "yaml-syntax"),
    ],
)
def test_a_wrong_file_of_accepted_changes(
    old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str], text: str, message: str
) -> None:
    (old_and_new[1] / "accepted.yaml").write_text(text, encoding="utf-8")
    exit_code, _, err = run(capsys, "diff", *old_and_new)
    assert exit_code == 2
    assert message in err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("valid_text", "misspelt", "suggested"),
    [
        ("clock.max_hz", "clock", "did you mean 'interfaces.biss.clock.max_hz'?"),
        ("my_encoder", "my_encodr", "did you mean 'my_encoder'?"),
    ],
)
def test_an_entry_that_accepts_nothing_is_reported(
    old_and_new: tuple[Path, Path], capsys: pytest.CaptureFixture[str], valid_text: str, misspelt: str, suggested: str
) -> None:
    accepted_entry = f"{ENTRY}2999-12-31}}".replace(valid_text, misspelt)
    (old_and_new[1] / "accepted.yaml").write_text(f"accepted:\n  - {accepted_entry}\n", encoding="utf-8")
    printed = " ".join(run(capsys, "diff", *old_and_new)[1].split())
    assert "accepted, but not found: " in printed
    assert suggested in printed


@pytest.mark.slow
def test_the_entry_for_an_older_edition_keeps_what_was_taken_away(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seventeen = '        "17": {meaning: "131,072 counts per turn", sets: {singleturn_bits: 17}}\n'
    extra = "  - {name: spare, interface: biss, address: 0x60, length: 1, access: read_only, source: '6'}\n"
    examples = ("MY-ENCODER-17-SC", "MY-ENCODER-13-SC")
    # The frame of the other example has 17 bits.
    template = device_text("my_encoder", "example", "d.json")
    frame = template[template.index("  - name: position  ") : template.index("# Errors and contradictions")]
    without = (frame, "\n")
    revision = [
        ('  revision: "1.0"', '  revision: "1.1"'),
        ("changes: First issue.}\n", 'changes: First issue.}\n    - {revision: "1.1", changes: 17 bits removed}\n'),
        (seventeen, ""),
        without,
        examples,
    ]
    old = write_specs(tmp_path / "old", without, examples, ("registers:\n", f"registers:\n{extra}"))
    new = write_specs(tmp_path / "new", *revision)
    out = run(capsys, "diff", old, new, "--editions")[1]
    _, _, edition_entry = out.partition("with their source:\n\n")
    assert "value: {name: spare, interface: biss, address: 0x60" in edition_entry
    spec = new / "my_encoder.yaml"
    spec.write_text(spec.read_text(encoding="utf-8") + edition_entry, encoding="utf-8")
    assert run(capsys, "check", new)[:1] == (0,)
    for edition, is_kept in (("1.0", True), ("1.1", False)):
        data = json.loads(run(capsys, "show", "my_encoder", "--edition", edition, "--specs", new, "--json")[1])
        assert ("spare" in [register["name"] for register in data["registers"]]) == is_kept
        assert ("MY-ENCODER-17-SC" in json.dumps(data["order_codes"])) == is_kept
    assert "removed these items" not in run(capsys, "diff", old, old, "--editions")[1]


def test_an_item_is_not_renamed_because_another_item_of_its_name_is(tmp_path: Path) -> None:
    """The field busy of one register is renamed, and the one of the other register is removed."""
    register = """
  - name: {name}
    interface: biss
    address: {address}
    length: 1
    access: read_only
    other_bits: zero
    fields:
      - {{name: busy, at: "0"}}
      - {{name: fault, at: "1"}}
    source: "6"
"""
    renamed = register.format(name="memory", address="0x60")
    thinned = register.format(name="state", address="0x61")
    removed_field = '      - {name: busy, at: "0"}\n'
    old = write_specs(tmp_path / "old", ("registers:\n", f"registers:\n{renamed}{thinned}"))
    renaming = renamed.replace("name: busy", "name: working")
    removal = thinned.replace(removed_field, "")
    new = write_specs(
        tmp_path / "new",
        ("registers:\n", f"registers:\n{renaming}{removal}"),
        ('  revision: "1.0"', '  revision: "1.1"'),
    )
    (old_families, _), (new_families, _) = load_families([old]), load_families([new])
    old_devices = [family.device for family in old_families]
    new_devices = [family.device for family in new_families]
    changes = compare(old_devices, new_devices)
    assert [change.path for change in changes if change.rule.is_renaming] == ["registers.memory.working"]
    entry = "\n".join(edition_entries(old_families, new_families, changes))
    assert re.findall(r"\{add: ([\w.]+), value: \{name: (\w+)", entry) == [("registers.state.fields", "busy")]


FIRST = '  history:\n    - {revision: "1.0", changes: First issue.}\n'
SECOND = ('  revision: "1.0"', '  revision: "1.1"')
EDITIONS = """
editions:
  - revision: "1.0"
    before:
      - {also: The label was on the shaft, why: The table of revisions says so, source: Document release}
"""
LABELS = {
    "a part": [('"17": {meaning', '"17A": {meaning'), ("MY-ENCODER-17-SC", "MY-ENCODER-17A-SC")],
    "an interface": [("SC: {meaning", "SX: {meaning"), ("-SC", "-SX"), ("output: [SC]", "output: [SX]")],
    "an example": [
        ('"17": {meaning', '"17A": {meaning'),
        ("MY-ENCODER-17-SC", "MY-ENCODER-17A-SC"),
        ("name: preset_register", "name: other_register"),
    ],
}


def shown_codes(capsys: pytest.CaptureFixture[str], *options: object) -> set[str]:
    shown_family = json.loads(run(capsys, "show", "my_encoder", *options, "--json")[1])
    return {order_code["code"] for order_code in shown_family["order_codes"]}


@pytest.mark.one_in(4, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("labels", LABELS.values(), ids=LABELS)
@pytest.mark.parametrize("around", ["history", "no history", "editions"])
def test_the_entry_for_an_option_with_another_label_passes_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], labels: list[tuple[str, str]], around: str
) -> None:
    before = [("sets: {singleturn_bits: 13}", "sets: {singleturn_bits: 13}, only_with: {output: [SC]}")]
    more = f'{FIRST}    - {{revision: "1.1", changes: New labels}}\n'
    if around == "editions":
        first = FIRST.replace("1.0", "0.9")
        before.append((FIRST, f'{first}    - {{revision: "1.0", changes: More}}\n'))
        more = f'{first}    - {{revision: "1.0", changes: More}}\n    - {{revision: "1.1", changes: New labels}}\n'
    old = write_specs(tmp_path / "old", *before)
    new = write_specs(tmp_path / "new", before[0], SECOND, (FIRST, "" if around == "no history" else more), *labels)
    spec = new / "my_encoder.yaml"
    if around == "editions":
        spec.write_text(spec.read_text(encoding="utf-8") + EDITIONS, encoding="utf-8")
    assert run(capsys, "check", old)[0] == run(capsys, "check", new)[0] == 0
    begin, _, edition_entry = run(capsys, "diff", old, new, "--editions")[1].partition("with their source:\n\n")
    text = spec.read_text(encoding="utf-8")
    if around == "editions":
        assert begin.endswith("under its editions, ")
        text = text.replace("editions:\n  - revision", f"editions:\n{edition_entry.rstrip()}\n  - revision")
    else:
        text += edition_entry
    if around == "no history":
        history = begin.partition("under 'manual':\n\n")[2].partition("\n\n")[0]
        text = text.replace(SECOND[1], f"{SECOND[1]}\n{history}", 1)
    spec.write_text(text, encoding="utf-8")
    exit_code, out, _ = run(capsys, "check", new)
    assert exit_code == 0, out
    codes_before = shown_codes(capsys, "--specs", old)
    assert codes_before == shown_codes(capsys, "--edition", "1.0", "--specs", new)


def test_the_commands_of_the_page_are_right(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/transcribe/check-in-ci.md").read_text(encoding="utf-8")
    hook, workflow, accepted_block = map(yaml.safe_load, re.findall(r"```yaml\n(.*?)```", page, re.DOTALL))
    steps = [step["run"] for step in workflow["jobs"]["specs"]["steps"] if "run" in step]
    lines = [hook["repos"][0]["hooks"][0]["entry"], *(line for line in steps if line.startswith("codewheel"))]
    assert len(lines) == 4
    for line in lines:
        words = line.partition(" >")[0].split()[1:]
        assert parser_for(words).parse_args(words).command == words[0]
    (accepted,) = accepted_block["accepted"]
    (tmp_path / "accepted.yaml").write_text(f"accepted:\n  - {json.dumps(accepted, default=str)}\n", encoding="utf-8")
    assert read_accepted(tmp_path / "accepted.yaml")[0].rule == "clock-narrower"
