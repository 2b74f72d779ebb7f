"""``codewheel diff``: its input, its output in each form, and its exit code."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from shutil import copytree

import pytest
from codewheel.changes.families import compare
from codewheel.commands.cli import main
from codewheel.loading.revisions import RevisionError, revision_in, write_revision
from codewheel.model import Device
from exhaustive import mostly_exhaustive
from jsonschema import Draft202012Validator
from pair import BASE

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = json.loads((ROOT / "generator" / "language" / "diff.schema.json").read_text(encoding="utf-8"))
Git = Callable[..., str]
#: They start git.
pytestmark = pytest.mark.slow


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.count(old) == 1, old
    file.write_text(text.replace(old, new), encoding="utf-8")


@pytest.fixture
def git(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Git:
    """Create a repository with the base in the folder ``specs`` and the tag v1.0."""
    copytree(BASE, tmp_path / "specs")
    monkeypatch.chdir(tmp_path)
    # In a git hook, these point to another repository.
    for name in ("GIT_DIR", "GIT_INDEX_FILE", "GIT_WORK_TREE"):
        monkeypatch.delenv(name, raising=False)
    # Ignore the user's settings, such as hooks or signatures.
    monkeypatch.setenv("GIT_CONFIG_NOSYSTEM", "1")
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", str(tmp_path / "no.gitconfig"))

    def run(*words: str) -> str:
        settings = ("-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false")
        return subprocess.run(["git", *settings, *words], check=True, capture_output=True, text=True).stdout.strip()

    run("init", "-q")
    run("add", ".")
    run("commit", "-q", "-m", "first")
    run("tag", "v1.0")
    return run


def diff(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    exit_code = main(["diff", *words])
    done = capsys.readouterr()
    return exit_code, done.out, done.err


TOLD = """\
demo
  breaking       register 3Bh configuration: read and write → read-only
                 all 4 BiSS order codes; C MAKER_DEMO_BISS_REG_CONFIGURATION_…,
                 Python demo.REGISTERS["configuration"], XML [access-lost]
  behaviour      BiSS: highest clock 10 MHz → 5 MHz
                 all 4 BiSS order codes; C, Python, XML [clock-narrower]
  compatible     command.function: value reset is new
                 all 4 BiSS order codes; C, Python, XML [value-new]
  documentation  registers.command.function.save.meaning [words]
  names          C macro MAKER_DEMO_BISS_CLOCK_MAX_HZ: 10000000U → 5000000U; C
                 macro MAKER_DEMO_BISS_REG_CONFIGURATION_ACCESS:
                 CW_ACCESS_READ_WRITE → CW_ACCESS_READ_ONLY; C function
                 maker_demo_biss_write_configuration is gone; C functions with
                 different code: maker_demo_biss_write_command
4 changes: 1 breaking, 1 behaviour, 1 compatible, 1 documentation
generated: 57 of 304 files change; maker_encoders 1.4.2 → 2.0.0, but the spec
  still says 1.4.2
"""


def revise(folder: Path) -> None:
    file = folder / "demo.yaml"
    edit(
        file,
        "    address: 0x3B\n    length: 1\n    access: read_write\n",
        "    address: 0x3B\n    length: 1\n    access: read_only\n",
    )
    edit(file, "max_hz: 10000000", "max_hz: 5000000")
    edit(
        file,
        "          save: {value: 1, meaning: Saves the parameters}\n",
        "          save: {value: 1, meaning: Saves all}\n          reset: {value: 2, meaning: Resets}\n",
    )


def test_as_text(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert diff(capsys, "v1.0:specs", "specs") == (0, "no differences\n", "")
    revise(tmp_path / "specs")
    for old, new in (("v1.0:specs", "specs"), ("v1.0:specs/demo.yaml", "specs/demo.yaml"), ("HEAD:./specs", "specs")):
        assert diff(capsys, old, new) == (1, TOLD, "")
    git("commit", "-q", "-a", "-m", "second")
    assert diff(capsys, "HEAD~1:", "HEAD:") == (1, TOLD, "")


@pytest.mark.parametrize(
    "impact", mostly_exhaustive(["breaking", "behaviour", "compatible", "documentation", None], "documentation")
)
def test_fail_on_a_breaking_change(
    git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str], impact: str | None
) -> None:
    revise(tmp_path / "specs")
    words = ("--fail-on", impact) if impact else ()
    assert diff(capsys, "v1.0:specs", "specs", *words)[0] == 1


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize(
    ("impact", "code"), [("breaking", 0), ("behaviour", 0), ("compatible", 0), ("documentation", 1)]
)
def test_fail_on_words(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str], impact: str, code: int) -> None:
    edit(tmp_path / "specs" / "demo.yaml", "title: DEMO encoder", "title: Demo encoder")
    assert diff(capsys, "v1.0:specs", "specs", "--fail-on", impact)[0] == code


def test_an_impact_that_is_none(git: Git, capsys: pytest.CaptureFixture[str]) -> None:
    exit_code, _, err = diff(capsys, "v1.0:specs", "specs", "--fail-on", "braking")
    assert (exit_code, "there is no choice 'braking'; did you mean 'breaking'?" in err) == (2, True)


def test_as_data(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Draft202012Validator.check_schema(SCHEMA)
    validator = Draft202012Validator(SCHEMA)
    validator.validate(json.loads(diff(capsys, "v1.0:specs", "specs", "--json")[1]))
    revise(tmp_path / "specs")
    exit_code, out, _ = diff(capsys, "v1.0:specs", "specs", "--json")
    data = json.loads(out)
    validator.validate(data)
    assert (exit_code, data["impact"], data["generated"]["files"]) == (1, "breaking", 304)
    assert data["counts"] == {"documentation": 1, "compatible": 1, "behaviour": 1, "breaking": 1}
    assert data["changes"][1] == {
        "family": "demo",
        "rule": "clock-narrower",
        "impact": "behaviour",
        "outputs": {"c": "behaviour", "python": "behaviour", "xml": "behaviour", "pages": "documentation"},
        "path": "interfaces.biss.clock.max_hz",
        "text": "BiSS: highest clock 10 MHz → 5 MHz",
        "old": 10000000,
        "new": 5000000,
        "order_codes": ["DEMO13-SSC", "DEMO13-MSC", "DEMO17-SSC", "DEMO17-MSC"],
        "reach": "all 4 BiSS order codes",
        "names": {},
    }
    assert data["packages"] == [
        {"name": "maker_encoders", "old": "1.4.2", "stated": "1.4.2", "due": "2.0.0", "new": "2.0.0"}
    ]


def test_as_markdown(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    revise(tmp_path / "specs")
    edit(tmp_path / "specs" / "manufacturer.yaml", '"1.4.2"', '"2.0.0"')
    assert diff(capsys, "v1.0:specs", "specs", "--markdown")[:2] == (
        1,
        """\
## maker_encoders 1.4.2 → 2.0.0

### demo

#### Breaking

- register 3Bh configuration: read and write → read-only (`access-lost`): all 4 BiSS order codes; C \
`MAKER_DEMO_BISS_REG_CONFIGURATION_…`, Python `demo.REGISTERS["configuration"]`, XML

#### Behaviour

- BiSS: highest clock 10 MHz → 5 MHz (`clock-narrower`): all 4 BiSS order codes; C, Python, XML

#### Compatible

- command.function: value reset is new (`value-new`): all 4 BiSS order codes; C, Python, XML

#### Documentation

- command.function: value save: meaning (`words`): all 4 BiSS order codes; C, Python, XML, pages

#### Names in code

- C macro MAKER_DEMO_BISS_CLOCK_MAX_HZ: 10000000U → 5000000U
- C macro MAKER_DEMO_BISS_REG_CONFIGURATION_ACCESS: CW_ACCESS_READ_WRITE → CW_ACCESS_READ_ONLY
- C function maker_demo_biss_write_configuration is gone
- C functions with different code: maker_demo_biss_write_command

66 of 304 generated files change.
""",
    )


@pytest.mark.parametrize(
    ("old", "message"),
    [
        ("v9:specs", "there is no revision 'v9' in this repository; known: master, v1.0"),
        ("-x:specs", "'-x' is not a revision; write it like v1.0:specs/my_encoder.yaml"),
        ("--upload-pack=touch x:specs", None),
        ("v1.0:spec", "there is no spec in v1.0"),
        ("v1.0:../specs", "v1.0:../specs is outside the repository; paths are relative to its top"),
        ("v1.0:/a/b", "v1.0:/a/b is outside the repository; paths are relative to its top"),
        ("$(touch x):specs", "there is no revision '$(touch x)' in this repository; known: master, v1.0"),
        ("v1.0\x1b[2J:specs", "there is no revision 'v1.0\\x1b[2J' in this repository; did you mean 'v1.0'?"),
        ("specs/nowhere.yaml", "no such file or folder: specs/nowhere.yaml"),
    ],
)
def test_what_is_not_there(
    git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, message: str | None
) -> None:
    git("branch", "-M", "master")
    exit_code, out, err = diff(capsys, *(("--", old) if old.startswith("-") else (old,)), "specs")
    assert (exit_code, out) == (2, "")
    assert "Traceback" not in err
    if message is not None:
        assert err.splitlines()[-1].startswith(f"codewheel: {message.partition('; did')[0]}")
    assert not (tmp_path / "x").exists()


def test_without_a_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    monkeypatch.delenv("GIT_DIR", raising=False)
    place = revision_in("v1.0:specs")
    assert place is not None
    with pytest.raises(RevisionError, match="the current folder is not in a git repository"):
        write_revision(place, tmp_path / "out")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RevisionError, match="git is not installed"):
        write_revision(place, tmp_path / "out")


def test_a_file_with_a_colon_is_a_file(git: Git, tmp_path: Path) -> None:
    (tmp_path / "v1.0:specs").mkdir()
    assert revision_in("v1.0:specs") is None
    assert revision_in("specs") is None


@pytest.mark.parametrize("path", ["C:\\old\\demo.yaml", "c:/old"])
def test_a_path_of_windows_is_a_path(capsys: pytest.CaptureFixture[str], path: str) -> None:
    assert revision_in(path) is None
    exit_code, _, err = diff(capsys, path, "specs")
    assert (exit_code, err) == (2, f"codewheel: no such file or folder: {path}\n")


def test_links_in_history_lead_nowhere(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "link.yaml").symlink_to(tmp_path / "specs" / "demo.yaml")
    git("add", ".")
    git("commit", "-q", "-m", "link")
    exit_code, _, err = diff(capsys, "HEAD:link.yaml", "specs")
    assert (exit_code, err) == (2, "codewheel: there is no link.yaml in HEAD\n")


def test_an_earlier_form_of_the_language(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    edit(file, "movement: rotary", "motion: rotary")
    git("commit", "-q", "-a", "-m", "old form")
    edit(file, "motion: rotary", "movement: rotary")
    exit_code, out, err = diff(capsys, "HEAD:specs", "specs")
    assert (exit_code, out) == (1, "")
    assert err.startswith("HEAD:specs/demo.yaml:2:1: missing-key: ")
    assert err.endswith(
        "codewheel: HEAD:specs is not compared, because the current spec language finds 2 problems in it. It may "
        "use an older form of the language: add --lenient, use a later revision, or run the version of codewheel from "
        "that time\n"
    )
    exit_code, out, _ = diff(capsys, "--lenient", "HEAD:specs", "specs")
    assert out.splitlines()[0] == (
        "the current spec language finds 2 problems in HEAD:specs. "
        "The faulty parts are left out and may be listed as new"
    )


def test_a_spec_without_interfaces_is_compared(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    edit(file, "\ninterfaces:", "\ninterface:")
    git("commit", "-q", "-a", "-m", "old form")
    edit(file, "\ninterface:", "\ninterfaces:")
    exit_code, out, _ = diff(capsys, "--lenient", "HEAD:specs", "specs")
    assert exit_code == 1
    assert "order codes DEMO…: 12 new" in out


def test_a_spec_without_evidence_is_compared(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    text = file.read_text(encoding="utf-8")
    (evidence,) = [line for line in text.splitlines(keepends=True) if line.startswith("evidence:")]
    file.write_text(text.replace(evidence, ""), encoding="utf-8")
    git("commit", "-q", "-a", "-m", "old form")
    file.write_text(text, encoding="utf-8")
    _, out, _ = diff(capsys, "--lenient", "HEAD:specs", "specs")
    assert "  documentation  evidence is new [evidence]\n1 change: 1 documentation\n" in out
    _, out, _ = diff(capsys, "--lenient", "specs", "HEAD:specs")
    assert "evidence is gone [evidence]" in out


def test_a_family_that_cannot_be_read_is_left_out(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (tmp_path / "specs" / "demo.yaml").read_text(encoding="utf-8")
    other_text = (
        text.replace("device: demo", "device: other").replace('"DEMO{', '"OTHER{').replace("DEMO17-", "OTHER17-")
    )
    other_text = other_text.replace('"DM{', '"OT{')
    (tmp_path / "specs" / "other.yaml").write_text(other_text, encoding="utf-8")
    edit(tmp_path / "specs" / "demo.yaml", "movement: rotary", "motion: rotary")
    git("add", ".")
    git("commit", "-q", "-m", "two")
    edit(tmp_path / "specs" / "demo.yaml", "motion: rotary", "movement: rotary")
    exit_code, out, _ = diff(capsys, "HEAD:specs", "specs")
    assert (exit_code, out) == (
        0,
        "not compared because of 2 problems in the current spec language: demo of HEAD:specs\nno differences\n",
    )


def test_the_new_specs_have_to_be_sound(git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edit(tmp_path / "specs" / "demo.yaml", "movement: rotary", "movement: round")
    exit_code, out, err = diff(capsys, "v1.0:specs", "specs")
    assert (exit_code, out) == (1, "")
    assert err.endswith("codewheel: specs has 1 problem and is not compared\n")


def _rules(old: Device, new: Device) -> set[tuple[str, str]]:
    return {(change.rule.name, change.affected_codes_text) for change in compare([old], [new])}


def test_amm5_needs_a_decision(amm5: Device) -> None:
    """A decision that a frame now needs breaks its callers, and so does its removal."""
    before = replace(amm5, alternatives=())
    forward, backward = _rules(before, amm5), _rules(amm5, before)
    assert {("decision-new", "all 12 RS-485 order codes"), ("frame-decision", "all 12 RS-485 order codes")} <= forward
    assert {("decision-gone", "all 12 RS-485 order codes"), ("frame-decision", "all 12 RS-485 order codes")} <= backward


def test_what_order_codes_of_amm5_are_called(amm5: Device) -> None:
    """As the manual's edition 1.8 had it, which introduced AMM5B."""
    before = replace(amm5, variants=tuple(variant for variant in amm5.variants if variant.parts["mount"] == "A"))
    texts = [(change.text, change.affected_codes_text) for change in compare([before], [amm5])]
    assert ("order codes AMM5B…: 18 new", "") in texts
    register = replace(amm5.register("preset"), default=1)
    registers = tuple(register if candidate.name == "preset" else candidate for candidate in amm5.registers)
    changed = compare([amm5], [replace(amm5, registers=registers)])
    assert [(change.text, change.affected_codes_text) for change in changed] == [
        ("registers 11h to 17h preset: default 00h → 01h", "all 12 BiSS order codes")
    ]


def _reach(device: Device, parts: Sequence[str]) -> str:
    from codewheel.changes.values import describe_codes

    codes = [variant.code for variant in device.variants if set(parts) <= set(variant.parts.values())]
    return describe_codes(device, codes)


@pytest.mark.parametrize(
    ("parts", "reach_text"),
    [
        ((), "all 36 order codes"),
        (("SC1",), "all 12 BiSS order codes"),
        (("B",), "AMM5B…"),
        (("17", "SC1"), "AMM5…17/…SC1"),
        (("A", "17", "1", "SC1"), "AMM5A17/1SC1"),
        (("A", "17", "1"), "AMM5A17/1…"),
    ],
)
def test_reach(amm5: Device, parts: Sequence[str], reach_text: str) -> None:
    assert _reach(amm5, parts) == reach_text


def test_reach_of_a_few(amm5: Device) -> None:
    from codewheel.changes.values import describe_codes

    codes = [variant.code for variant in amm5.variants]
    assert describe_codes(amm5, [codes[0], codes[4], codes[8], codes[15]]) == (
        "AMM5A17/1BG1, AMM5A17/65KSC1, AMM5A21/1JP1 and 1 more"
    )
    assert describe_codes(amm5, [codes[0], codes[6]]) == "AMM5A{17,21}/1BG1"


def test_a_joined_number_of_a_missing_field_is_left_out(
    git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    text = file.read_text(encoding="utf-8")
    assert "join: {position: [multiturn, singleturn]}" in text
    file.write_text(text.replace("[multiturn, singleturn]", "[multiturn, single]"), encoding="utf-8")
    git("commit", "-q", "-a", "-m", "a mistake")
    file.write_text(text, encoding="utf-8")
    exit_code, out, _ = diff(capsys, "--lenient", "HEAD:specs", "specs")
    assert exit_code == 1
    assert "reply: number position is new" in out


def test_the_entry_for_older_encoders_of_a_spec_without_its_manual(
    git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    edit(file, "\nmanual:", "\nmanuals:")
    register = '  - {name: spare, interface: biss, address: 0x60, length: 1, access: read_only, source: "6"}\n'
    git("commit", "-q", "-a", "-m", "new form")
    edit(file, "\nmanuals:", "\nmanual:")
    edit(file, "\nregisters:\n", f"\nregisters:\n{register}")
    _, out, _ = diff(capsys, "--lenient", "--editions", "specs", "HEAD:specs")
    assert "{add: registers, value: {name: spare, " in out


def test_the_entry_for_older_encoders_of_a_spec_whose_options_are_numbers(
    git: Git, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "specs" / "demo.yaml"
    option = "S: {meaning: Singleturn, sets: {multiturn_bits: 0}}"
    edit(file, option, "single: 0")
    edit(file, '\n  revision: "1.0"', '\n  revision: "2.0"')
    git("commit", "-q", "-a", "-m", "a damaged option")
    edit(file, "single: 0", option)
    edit(file, '\n  revision: "2.0"', '\n  revision: "1.0"')
    _, out, _ = diff(capsys, "--lenient", "--editions", "specs", "HEAD:specs")
    assert "{add: order_code.parts.turns.values.S, value: {meaning: Singleturn, " in out
