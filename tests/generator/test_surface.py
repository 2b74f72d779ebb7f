"""Behaviour for users who mistype, forget a path, or ask for help."""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path

import pytest
from codewheel.commands.cli import COMMANDS, command_named, main

EXAMPLES = {name: command_named(name).EXAMPLES for name in COMMANDS}


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    exit_code = main(arguments)
    captured = capsys.readouterr()
    return exit_code, captured.out, captured.err


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with the specs that ``new`` writes."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my_encoder"]) == 0
    return tmp_path


def add_broken(folder: Path) -> None:
    (folder / "bad.yaml").write_text("codewheel: 1\ndevice: bad\nmanufacturer: maker\n")


# ----------------------------------------------------------------------------------------------------------------- help


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)], ids=" ".join)
def test_help_fits_a_terminal_and_has_examples(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    exit_code, out, _ = run(capsys, *command, "--help")
    assert exit_code == 0
    assert max(map(len, out.splitlines())) <= 80
    if command:
        assert all(f"\n  {line}\n" in out for line in EXAMPLES[command[0]])
    else:
        assert all(f"    {name} " in out for name in COMMANDS), "every command has examples"


@pytest.mark.slow
@pytest.mark.parametrize("command", [name for name in COMMANDS if name not in ("new", "simulate")])
def test_the_examples_work(capsys: pytest.CaptureFixture[str], own_folder: Path, command: str) -> None:
    assert main(["generate"]) == 0
    if command == "diff":
        (own_folder / "old").mkdir()
        for name in ("my_encoder.yaml", "manufacturer.yaml"):
            shutil.copy(own_folder / name, own_folder / "old")
    for edition in ("1.0", "1.1"):
        (own_folder / f"manual-{edition}.txt").write_text("1 - Resolution\n\n13 bits\n", encoding="utf-8")
    for line in EXAMPLES[command]:
        exit_code, _, err = run(capsys, *shlex.split(line)[1:])
        assert (exit_code, err) == (0, ""), line


def test_the_examples_of_new_work(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "specs").mkdir()
    for line in EXAMPLES["new"]:
        assert run(capsys, *shlex.split(line)[1:])[0] == 0, line


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    exit_code, out, _ = run(capsys, "--version")
    assert exit_code == 0
    assert out.startswith("codewheel 0.")


# ---------------------------------------------------------------------------------------------------------- wrong usage


KNOWN = "generate, check, list, show, decode, find, master, simulate, diff, reread, facts, cloze, explain, new, migrate"


@pytest.mark.parametrize(
    ("arguments", "usage", "error"),
    [
        (["shwo"], "codewheel", "there is no command 'shwo'; did you mean 'show'?"),
        (
            ["xyzzy"],
            "codewheel",
            f"there is no command 'xyzzy'; known: {KNOWN}",
        ),
        (["check", "--jsno"], "codewheel check", "there is no option '--jsno'; did you mean '--json'?"),
        (
            ["show", "x", "irs.yaml"],
            "codewheel show",
            "unexpected argument 'irs.yaml'; give a spec as --specs irs.yaml",
        ),
        (["show", "x", "y"], "codewheel show", "unexpected argument 'y'"),
        (["generate", "-o", ""], "codewheel generate", "argument -o: the path is empty; write . for this folder"),
        (["check", ""], "codewheel check", "argument SPECS: the path is empty; write . for this folder"),
        (["list", "--specs", ""], "codewheel list", "argument --specs: the path is empty; write . for this folder"),
    ],
)
def test_wrong_usage_shows_the_commands_own_usage(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    usage: str,
    error: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    exit_code, out, err = run(capsys, *arguments)
    assert (exit_code, out) == (2, "")
    assert err.startswith(f"usage: {usage} [")
    assert err.endswith(f": error: {error}\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        ["check"],
        ["check", "--json"],
        ["check", "--specs"],
        ["generate"],
        ["list"],
        ["list", "--specs"],
        ["show", "x", "--specs"],
        ["diff", "x.yaml"],
    ],
)
def test_a_missing_file_is_wrong_usage(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.yaml").write_text("device: x\n")
    if arguments[0] == "diff":
        arguments = ["diff", "nowhere.yaml"]
    exit_code, out, err = run(capsys, *arguments, "nowhere.yaml")
    assert (exit_code, out, err) == (2, "", "codewheel: no such file or folder: nowhere.yaml\n")


@pytest.mark.slow
def test_codes_are_near_only_where_something_is_near(capsys: pytest.CaptureFixture[str]) -> None:
    for text in ("FOO", "X", "../x", "99999"):
        assert run(capsys, "show", text) == (
            2,
            "",
            f"codewheel: '{text}' is not a known order code; codewheel list shows the known patterns\n",
        )
    assert "the nearest are AMM5A21/" in run(capsys, "show", "AMM5A21")[2]


def test_a_family_is_no_order_code(capsys: pytest.CaptureFixture[str], own_folder: Path) -> None:
    for command in (["decode", "--specs", ".", "MY_ENCODER", "0x1"], ["master", "--specs", ".", "MY_ENCODER"]):
        exit_code, _, err = run(capsys, *command)
        assert exit_code == 2
        assert err == (
            "codewheel: 'MY_ENCODER' is a family; give an order code, such as MY-ENCODER-13-SC "
            "(codewheel show my_encoder explains them)\n"
        )


# ---------------------------------------------------------------------------------------------------- the specs to read


@pytest.mark.slow
def test_without_arguments_the_specs_of_the_folder_are_read_and_named(
    capsys: pytest.CaptureFixture[str], own_folder: Path
) -> None:
    (own_folder / "ci.yml").write_text("jobs: {}\n")
    for command in ("check", "generate"):
        exit_code, out, _ = run(capsys, command)
        assert exit_code == 0
        assert "read 2 specs: manufacturer.yaml, my_encoder.yaml\n" in out
    assert not list(own_folder.rglob("amm5*"))
    assert (own_folder / "generated/docs/my_encoder.md").is_file()
    _, out, _ = run(capsys, "check", "--json")
    data = json.loads(out)
    assert {place["file"] for place in data.pop("placeholders")} == {"manufacturer.yaml", "my_encoder.yaml"}
    assert data == {
        "version": 1,
        "files": ["manufacturer.yaml", "my_encoder.yaml"],
        "passed_over": [],
        "problems": [],
    }
    _, out, _ = run(capsys, "check", "--specs", "my_encoder.yaml")
    assert "read 2 specs: my_encoder.yaml, manufacturer.yaml\n" in out


def test_without_specs_in_the_folder_those_that_ship_are_read(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    exit_code, _, err = run(capsys, "show", "AMM5A21/65KSC1")
    assert (exit_code, err) == (0, "")


def test_a_spec_that_is_given_as_an_order_code(capsys: pytest.CaptureFixture[str], own_folder: Path) -> None:
    exit_code, _, err = run(capsys, "show", "my_encoder.yaml")
    assert exit_code == 2
    assert err.endswith("codewheel: 'my_encoder.yaml' is not an order code; give a spec as --specs my_encoder.yaml\n")


@pytest.mark.slow
def test_one_broken_spec_does_not_keep_the_others_from_use(
    capsys: pytest.CaptureFixture[str], own_folder: Path
) -> None:
    add_broken(own_folder)
    for command in (
        ["decode", "MY-ENCODER-13-SC", "0b0001111101000_1_1_011010"],
        ["show", "my_encoder"],
        ["show", "MY-ENCODER-13-SC"],
        ["master", "MY-ENCODER-13-SC"],
    ):
        exit_code, out, err = run(capsys, *command, "--specs", ".")
        assert exit_code == 0
        assert out
        # Another family cannot have that name, but the broken family could have the order code.
        is_named = "my_encoder" in command
        assert ("codewheel: skipped, with " in err) != is_named
        assert (": bad.yaml; run codewheel check\n" in err) != is_named
    exit_code, out, _ = run(
        capsys, "decode", "MY-ENCODER-13-SC", "0b0001111101000_1_1_011010", "--specs", ".", "--json"
    )
    assert exit_code == 0
    assert json.loads(out)["problems"] == []
    # The requested family may be in the broken file.
    exit_code, out, err = run(capsys, "show", "bad", "--specs", ".")
    assert exit_code == 1
    assert not out
    assert "bad.yaml:1:1: missing-key: " in err
    for command in (["list", "--specs", "."], ["generate", "."]):
        assert run(capsys, *command)[0] == 1


@pytest.mark.parametrize("shared", ["device", "maker"])
def test_a_spec_that_cannot_be_told_from_a_broken_one_is_not_used(
    capsys: pytest.CaptureFixture[str], own_folder: Path, shared: str
) -> None:
    text = (own_folder / "my_encoder.yaml").read_text()
    if shared == "device":
        (own_folder / "other.yaml").write_text(text.replace("device: my_encoder", "device: other"))
    else:
        maker = own_folder / "manufacturer.yaml"
        maker.write_text(maker.read_text().replace("codewheel: 1", "codewheel: 1\nunknown: 1"))
    exit_code, out, err = run(capsys, "show", "MY-ENCODER-13-SC", "--specs", ".")
    assert exit_code == 1
    assert not out
    assert "order-code-ambiguous" in err or "unknown-key" in err


# -------------------------------------------------------------------------------------------------------------- writing


@pytest.mark.slow
def test_files_in_the_way_need_force(capsys: pytest.CaptureFixture[str], own_folder: Path) -> None:
    (own_folder / "docs").mkdir()
    (own_folder / "docs/README.md").write_text("my own text")
    exit_code, _, err = run(capsys, "generate", "-o", ".")
    assert exit_code == 1
    assert err.startswith("codewheel: in the way and not written by codewheel; nothing has changed; ")
    assert "\n  docs/README.md\n" in err
    assert (own_folder / "docs/README.md").read_text() == "my own text"
    assert not (own_folder / "python").exists()
    assert run(capsys, "generate", "-o", ".", "--force")[0] == 0
    assert (own_folder / "docs/README.md").read_text() != "my own text"


@pytest.mark.slow
def test_check_says_how_to_bring_the_files_up_to_date(capsys: pytest.CaptureFixture[str], own_folder: Path) -> None:
    exit_code, _, err = run(capsys, "generate", "my_encoder.yaml", "-o", "an out", "--check")
    assert exit_code == 1
    assert err.endswith("run: codewheel generate my_encoder.yaml -o 'an out'\n")
