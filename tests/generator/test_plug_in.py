"""Third-party targets work like built-in ones, and each of their errors is reported in one line."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.targets import Library, Option, Options, Target, TargetError, TargetProblem, registry

ROOT = Path(__file__).resolve().parents[2]
RUST = Target(
    name="rust",
    summary="a crate",
    files=lambda library, options: {"rust/x.rs": " ".join(f"{key}={value}" for key, value in options.items())},
    options=(Option("edition", "of the language", "2021", ("2018", "2021")), Option("crate", "its name", "acme")),
)


class EntryPoint:
    """Stands for an entry point."""

    def __init__(self, target: object, fails: bool = False) -> None:
        self.target, self.fails, self.dist, self.value = target, fails, None, "somewhere:TARGET"

    def load(self) -> object:
        if self.fails:
            raise ImportError("no such module")
        return self.target


def register(monkeypatch: pytest.MonkeyPatch, **entries: EntryPoint) -> None:
    monkeypatch.setattr(
        registry, "_entry_points_by_name", lambda: {name: [entry_point] for name, entry_point in entries.items()}
    )


def fails(*_: object) -> Any:
    raise KeyError("a\nb")


def mine(files: Callable[..., Any]) -> Target:
    return Target("mine", "mine", files)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("entry_point", "message"),
    [
        (EntryPoint(mine(fails)), "the target 'mine' fails: KeyError: 'a\\nb' ("),
        (EntryPoint(None, fails=True), "the target 'mine' cannot be loaded: ImportError: no such module ("),
        (EntryPoint(None), "the target 'mine' must be a codewheel.targets.Target; this is nothing"),
        (EntryPoint(fails), "the target 'mine' must be a codewheel.targets.Target; this is function"),
        (EntryPoint(RUST), "the target 'mine' calls itself 'rust'; both names must be the same"),
        (EntryPoint(mine(lambda *_: None)), "the target 'mine' must return text by path; this is nothing"),
        (EntryPoint(mine(lambda *_: b"x")), "the target 'mine' must return text by path; this is bytes"),
        (EntryPoint(mine(lambda *_: ["mine/x"])), "the target 'mine' must return text by path; this is list"),
        (
            EntryPoint(mine(lambda *_: {"mine/x": b"x"})),
            "the target 'mine' must return text by path; 'mine/x' is bytes",
        ),
        (EntryPoint(mine(lambda *_: {1: "x"})), "the target 'mine' must return text by path; 1 is not a path"),
        (
            EntryPoint(mine(lambda *_: {"mine/x": "\ud800"})),
            "the target 'mine' must return text by path; 'mine/x' contains U+D800, which is not a character",
        ),
        (
            EntryPoint(Target("mine", "mine", lambda *_: {}, problems=fails)),
            "the target 'mine' fails: KeyError: 'a\\nb' (",
        ),
        (
            EntryPoint(Target("mine", "mine", lambda *_: {}, problems=lambda _: ["x"])),  # type: ignore[list-item]
            "the target 'mine' must return problems as TargetProblem; this is str",
        ),
    ],
)
def test_its_faults_are_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    entry_point: EntryPoint,
    message: str,
) -> None:
    register(monkeypatch, mine=entry_point)
    assert main(["generate", "-o", str(tmp_path / "out"), "--target", "mine"]) == 1
    err = capsys.readouterr().err
    assert err.startswith(f"codewheel: {message}")
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_ours_run_behind_the_same_guard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("codewheel.targets.docs.files._index_values", fails)
    specs = str(ROOT / "docs" / "example" / "tolvarn")
    assert main(["generate", specs, "-o", str(tmp_path / "out"), "--target", "docs"]) == 1
    err = capsys.readouterr().err
    assert err.startswith("codewheel: the target 'docs' fails: KeyError: 'a\\nb' (")
    assert err.count("\n") == 1


@pytest.mark.slow
def test_it_is_known_by_name_and_runs_when_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    register(monkeypatch, rust=EntryPoint(RUST))
    assert main(["generate", "-o", str(tmp_path), "--target", "ruts"]) == 2
    assert capsys.readouterr().err == "codewheel: there is no target 'ruts'; did you mean 'rust'?\n"
    assert main(["generate", "-o", str(tmp_path), "--target", "cobol"]) == 2
    message = "codewheel: there is no target 'cobol'; there are: python, c, biss, docs, browser, masters, rust\n"
    assert capsys.readouterr().err == message
    monkeypatch.chdir(tmp_path)
    assert main(["new", "demo"]) == 0
    assert main(["generate", "demo.yaml", "-o", "out"]) == 0
    folders = sorted(path.name for path in Path("out").iterdir())
    assert folders == ["biss", "browser", "c", "docs", "masters", "python"]
    assert main(["generate", "demo.yaml", "-o", "out", "--target", "rust"]) == 0
    assert Path("out/rust/x.rs").read_text() == "edition=2021 crate=acme"


def test_two_packages_with_one_target(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(registry, "_entry_points_by_name", lambda: {"rust": [EntryPoint(RUST), EntryPoint(RUST)]})
    assert main(["generate", "--target", "rust"]) == 1
    err = capsys.readouterr().err
    assert err == "codewheel: the target 'rust' is registered by somewhere:TARGET and by somewhere:TARGET; remove one\n"


@pytest.mark.parametrize("command", ["generate", "check"])
def test_help_lists_all_targets_and_options(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    register(monkeypatch, rust=EntryPoint(RUST), broken=EntryPoint(None, fails=True))
    assert main([command, "--help"]) == 0
    out = capsys.readouterr().out
    printed = " ".join(out.split())
    assert "python an installable, typed package" in printed
    assert "c headers for C99" in printed
    assert "rust a crate --option rust.edition=2018|2021: of the language (default: 2021)" in printed
    assert "--option rust.crate=VALUE: its name (default: acme)" in printed
    assert "broken the target 'broken' cannot be loaded: ImportError: no such module" in printed
    listed = out[out.index("targets (python") :].splitlines()
    assert max(map(len, (line for line in listed if "/" not in line))) <= 79


@pytest.mark.slow
@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("rust.edition=2017", "'rust.edition' cannot be '2017'; it can be: 2018, 2021"),
        ("rust.editon=2018", "the target 'rust' has no option 'editon'; did you mean 'edition'?"),
        ("rust.std=no", "the target 'rust' has no option 'std'; it has: edition, crate"),
        ("docs.std=no", "the target 'docs' has no option 'std'; it has none"),
        ("c.std=no", "'c.std' is for a target that does not run; add --target c"),
        ("ruts.edition=2018", "there is no target 'ruts'; did you mean 'rust'?"),
        ("edition=2018", "'edition=2018' is not a setting; write it like TARGET.OPTION=VALUE"),
        ("rust.edition", "'rust.edition' is not a setting; write it like TARGET.OPTION=VALUE"),
    ],
)
def test_a_wrong_option_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], setting: str, message: str
) -> None:
    register(monkeypatch, rust=EntryPoint(RUST))
    command = ["generate", "-o", str(tmp_path / "out"), "--target", "rust", "--target", "docs", "--option", setting]
    assert main(command) == 2
    assert capsys.readouterr().err == f"codewheel: {message}\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_options_reach_it_and_the_command_that_mends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    register(monkeypatch, rust=EntryPoint(RUST))
    command = ["generate", "-o", str(tmp_path), "--target", "rust", "--option", "rust.edition=2018"]
    again = "generate -o {} --target rust --option rust.crate=a=b --option rust.edition=2018\n"
    assert main(command) == 0
    assert (tmp_path / "rust/x.rs").read_text() == "edition=2018 crate=acme"
    capsys.readouterr()
    assert main([*command[:5], "--option", "rust.crate=a=b", *command[5:], "--check"]) == 1
    assert capsys.readouterr().err.endswith(again.format(tmp_path))


def problem_in_amm5(library: Library) -> Iterable[TargetProblem]:
    """Yield a problem of one register, with a second place, or nothing without that family."""
    for device in library.devices:
        if device.name == "amm5":
            place = ("registers", "preset", "length")
            yield TargetProblem(device, "rust-size", place, "too long; see line {line}", ("registers", "serial_number"))


@pytest.mark.slow
def test_its_problems_have_places(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    register(monkeypatch, rust=EntryPoint(Target("rust", "a crate", lambda *_: {}, problem_in_amm5)))
    spec = (ROOT / "specs/lika/amm5.yaml").read_text(encoding="utf-8").splitlines()
    preset = next(index for index, line in enumerate(spec) if line.strip() == "- name: preset")
    line, length = next((index, text) for index, text in enumerate(spec) if index > preset and "length:" in text)
    serial = next(index for index, text in enumerate(spec) if "name: serial_number" in text)
    column = length.index("length:") + len("length: ") + 1
    monkeypatch.chdir(ROOT)
    for command in ("check", "generate"):
        assert main([command, "specs/lika", "--target", "rust"]) == 1
        printed = "".join(capsys.readouterr())
        assert f"specs/lika/amm5.yaml:{line + 1}:{column}: rust-size: too long; see line {serial + 1}\n" in printed
    assert main(["check", "specs/lika"]) == 0


def test_it_is_not_asked_of_a_family_with_problems(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    checked: list[str] = []

    def problems(library: Library) -> list[TargetProblem]:
        checked.extend(device.name for device in library.devices)
        return []

    register(monkeypatch, rust=EntryPoint(Target("rust", "a crate", lambda *_: {}, problems)))
    assert main(["new", "sound", "-o", str(tmp_path / "sound.yaml")]) == 0
    text = (tmp_path / "sound.yaml").read_text(encoding="utf-8").replace("sound", "broken").replace("SOUND", "BROKEN")
    (tmp_path / "broken.yaml").write_text(text.replace("revision:", "revison:"), encoding="utf-8")
    assert main(["check", str(tmp_path), "--target", "rust"]) == 1
    assert "revison" in capsys.readouterr().out
    assert checked == ["sound"]


@pytest.mark.parametrize("name", ["", "Rust", "a.b", "a/b", "-x", "a=b", "\ud800"])
def test_a_name_that_cannot_be_one(name: str) -> None:
    files: Callable[[Library, Options], Mapping[str, str]] = lambda library, options: {}  # noqa: E731
    with pytest.raises(ValueError, match="cannot name a target or option"):
        Target(name, "", files)
    with pytest.raises(ValueError, match="cannot name a target or option"):
        Target("x", "", files, options=(Option(name, "", ""),))


def test_a_target_error_is_its_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def files(library: Library, options: Options) -> dict[str, str]:
        raise TargetError("the crate cannot be called 'a b'")

    register(monkeypatch, rust=EntryPoint(Target("rust", "a crate", files)))
    assert main(["generate", "-o", str(tmp_path), "--target", "rust"]) == 1
    assert capsys.readouterr().err == "codewheel: the crate cannot be called 'a b'\n"


def test_only_some_built_in_targets_have_problems() -> None:
    default = Target("x", "", lambda library, options: {}).problems
    with_problems = [name for name in registry.BUILT_IN if registry.load_target(name).problems is not default]
    assert tuple(with_problems) == registry.WITH_PROBLEMS
