"""Specs that a command reads, and files of others that ``generate`` leaves alone."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path

import pytest
from codewheel.commands import read_specs
from codewheel.commands.cli import main
from codewheel.loading.configuration import Configuration, FamilyFilter
from codewheel.output_folder import LIST

ROOT = Path(__file__).parents[2]
JUDGING = (
    ("check", "check FOLDER"),
    ("generate", "generate FOLDER"),
    ("migrate", "migrate FOLDER"),
    ("reread a.txt b.txt", "reread OLD NEW --specs FOLDER"),
    ("facts my_encoder --page 1", "facts FAMILY --specs FOLDER"),
)
#: A frame of the spec that ``new`` writes, from its own worked example.
FRAME = "0b0001111101000_1_1_011010"


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    folder = tmp_path / "project"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def add(name: str, folder: Path) -> None:
    """Write the spec ``name``, with a manufacturer of the name of its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    assert main(["new", name, "-o", str(folder / f"{name}.yaml")]) == 0
    for path in (folder / f"{name}.yaml", folder / "manufacturer.yaml"):
        text = path.read_text(encoding="utf-8").replace("manufacturer: example", f"manufacturer: {folder.name}")
        path.write_text(text.replace("biss_id: 0x", "biss_id: 0x1") if "bb" in folder.name else text, encoding="utf-8")


@pytest.fixture
def two(here: Path) -> Path:
    """The layout of a repository with two manufacturers."""
    add("enc_a", here / "specs/aa")
    add("enc_b", here / "specs/bb")
    return here


def tree(folder: Path) -> dict[str, str]:
    """Return a hash of each file below a folder."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


# ------------------------------------------------------------------------------------------------------ which specs


@pytest.mark.parametrize(("command", "remedy"), JUDGING, ids=lambda value: value.split()[0])
def test_a_command_that_judges_never_uses_the_packaged_specs(
    capsys: pytest.CaptureFixture[str], here: Path, command: str, remedy: str
) -> None:
    for name in ("a.txt", "b.txt"):
        (here / name).write_text("1 - Resolution\n")
    code, out, err = run(capsys, *command.split())
    assert (code, out) == (2, "")
    assert err.startswith(
        f"codewheel: there are no specs in this folder or below it; name them: codewheel {remedy}, or"
    )
    assert ("codewheel generate --packaged as5047p -o out" in err) == (command == "generate")
    assert sorted(path.name for path in here.iterdir()) == ["a.txt", "b.txt"]


@pytest.mark.slow
def test_specs_below_the_current_folder_are_read(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    """At the root of such a repository, every command without names used the packaged specs before."""
    code, out, _ = run(capsys, "check")
    assert code == 0
    assert out.endswith("no problems in 2 families: enc_a, enc_b\n")
    assert run(capsys, "generate", "specs", "--target", "c", "--target", "docs")[0] == 0
    before = tree(two / "generated")
    code, out, _ = run(capsys, "generate", "--target", "c", "--target", "docs")
    assert (code, out.splitlines()[-1]) == (0, f"all {len(before) - 2} files unchanged")
    assert tree(two / "generated") == before
    assert not any("lika" in path for path in before)


def test_commands_that_read_know_both(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    assert run(capsys, "decode", "ENC-A-13-SC", FRAME)[::2] == (0, "")
    assert run(capsys, "decode", "AMM5A21/65KSC1", "0xF4243D3")[::2] == (0, "")
    assert run(capsys, "show", "amm5")[::2] == (0, "")
    code, out, err = run(capsys, "list", "--json")
    assert (code, err) == (0, "")
    assert [row["family"] for row in json.loads(out)["families"]][:3] == ["enc_a", "enc_b", "acuro"]
    # Whoever names specs gets these alone.
    code, out, _ = run(capsys, "list", "specs/aa", "--json")
    assert [row["family"] for row in json.loads(out)["families"]] == ["enc_a"]
    code, _, err = run(capsys, "decode", "AMM5A21/65KSC1", "0xF4243D3", "--specs", "specs")
    assert code == 2
    assert err.endswith("; the packaged specs have it, so leave out the names of specs\n")


@pytest.mark.slow
def test_a_spec_of_the_user_comes_before_a_packaged_one(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    shutil.copytree(ROOT / "specs/lika", here / "lika")
    for path in (here / "lika").glob("amm5.*"):
        path.unlink()
    text = (here / "lika/sma21.yaml").read_text(encoding="utf-8")
    (here / "lika/sma21.yaml").write_text(text.replace("title: ", "title: Mine, ", 1), encoding="utf-8")
    code, out, err = run(capsys, "show", "sma21")
    assert (code, err) == (0, "codewheel: sma21 is in your specs and in the packaged ones; yours are used\n")
    assert "Mine, " in out
    code, out, err = run(capsys, "list")
    assert (code, err) == (
        0,
        "codewheel: in your specs and in the packaged ones: sma21; yours are used\n",
    )
    assert out.count("sma21  ") == out.count("amm5  ") == 1
    assert run(capsys, "show", "asc85")[2] == "", "a copy of a packaged spec is not worth a word"
    (here / "lika/sma21.yaml").write_text(text.replace("title: ", "titel: ", 1), encoding="utf-8")
    assert run(capsys, "show", "sma21")[0] == 1, "the packaged spec does not replace one with a problem"


@pytest.mark.slow
def test_in_this_repository_the_edited_files_are_read(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT / "docs")
    code, out, _ = run(capsys, "facts", "sma21", "--section", "6.4")
    assert code == 0
    assert all(line.startswith("../specs/lika/") for line in out.splitlines()[:-1])
    assert run(capsys, "list")[2] == "", "the packaged specs are the same files"


@pytest.mark.slow
def test_an_overlay_alone_reads_only_the_family_that_it_changes(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    change = "set: alarms.low_amplitude_error.meaning, to: Mine, why: A test, source: 6.4 p.33, severity: wording"
    overlay = "codewheel: 1\noverlay: mine\ntitle: Mine\nof: {}\nchanges:\n  - {{" + change + "}}\n"
    (here / "mine.yaml").write_text(overlay.format("sma21"), encoding="utf-8")
    code, _, err = run(capsys, "list")
    assert (code, err) == (0, "codewheel: in your specs and in the packaged ones: sma21; yours are used\n")
    code, out, _ = run(capsys, "generate", "--target", "c", "--unchecked")
    assert code == 0
    assert out.startswith("read 3 specs: mine.yaml, "), "with its manufacturer"
    stems = {path.name.partition("_")[0] for path in (here / "generated/c/include/lika").glob("*.h")}
    assert "sma21" in stems
    assert "amm5" not in stems
    # An unknown name is compared with all packaged families.
    (here / "mine.yaml").write_text(overlay.format("sma22"), encoding="utf-8")
    code, out, _ = run(capsys, "check")
    assert code == 1
    assert "there is no family 'sma22' among the specs that were read; codewheel list shows the families" in out


# ------------------------------------------------------------------------------------------------------ settings


def test_the_nearest_settings_hold(
    capsys: pytest.CaptureFixture[str], two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (two / "pyproject.toml").write_text('[tool.codewheel]\nspecs = ["specs/aa"]\noutput = "out"\ntargets = ["biss"]\n')
    assert run(capsys, "check")[1].endswith("no problems in 1 family: enc_a\n")
    monkeypatch.chdir(two / "specs/bb")
    assert run(capsys, "check")[1].endswith("no problems in 1 family: enc_a\n")
    assert run(capsys, "generate")[0] == 0
    assert [path.name for path in (two / "out").iterdir()] == ["biss"]
    assert run(capsys, "check", ".")[1].endswith("no problems in 1 family: enc_b\n")
    (two / "specs/codewheel.yaml").write_text("specs: [bb]\n")
    assert run(capsys, "check")[1].endswith("no problems in 1 family: enc_b\n")
    (two / "specs/bb/.git").mkdir()
    assert run(capsys, "check")[1].endswith("no problems in 1 family: enc_b\n"), "the repository itself, without them"
    (two / "specs/codewheel.yaml").write_text("specs: [nowhere]\n")
    assert run(capsys, "check")[0] == 0, "settings outside the repository do not hold in it"


@pytest.mark.parametrize(
    ("file", "text", "problems"),
    [
        (
            "pyproject.toml",
            '[tool.codewheel]\nspecs = [\n  "specs",  # "x"\n  "spcs",\n]\ntarget = ["c"]\n',
            [
                "pyproject.toml:4:3: undefined-reference: there is no file or folder spcs",
                "pyproject.toml:6:1: unknown-key: unknown key 'target'; did you mean 'targets'?",
            ],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel]\nspecs = "specs"\noutput = 1\ntargets = []\n',
            [
                "pyproject.toml:2:9: wrong-type: 'specs' must be a list of texts, such as specs = [\"specs\"]",
                "pyproject.toml:3:10: wrong-type: 'output' must be a text, such as output = \"generated\"",
                'pyproject.toml:4:11: wrong-type: \'targets\' must be a list of texts, such as targets = ["c", "docs"]',
            ],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel]\nspecs = ["specs"]\ntargets = ["c", "dosc"]\n',
            ["pyproject.toml:3:17: undefined-reference: there is no target 'dosc'; did you mean 'docs'?"],
        ),
        (
            "codewheel.yaml",
            "specs: specs\noutptu: x\n",
            [
                "codewheel.yaml:1:8: wrong-type: 'specs' must be a list of texts, such as specs: [specs]",
                "codewheel.yaml:2:1: unknown-key: unknown key 'outptu'; did you mean 'output'?",
            ],
        ),
        (
            "codewheel.yaml",
            "# nothing\n",
            ["codewheel.yaml:1:1: empty: the file is empty; write a setting, such as specs: [specs], or remove it"],
        ),
        (
            "codewheel.yaml",
            "- specs\n",
            ["codewheel.yaml:1:1: not-a-map: settings are a map of keys, such as specs: [specs]"],
        ),
        ("codewheel.yaml", "specs: [\n", ["codewheel.yaml:2:1: yaml-syntax: "]),
        ("pyproject.toml", '[tool.codewheel]\nspecs = "x\n', ["pyproject.toml:2:11: toml-syntax: not valid TOML: "]),
        ("pyproject.toml", "[tool.codewheel]\nspecs = [", ["pyproject.toml:2:9: toml-syntax: not valid TOML: "]),
        ("pyproject.toml", "[tool.codewheel]\n# \udcff\n", ["pyproject.toml:2:1: not-text: byte 0xFF is not UTF-8"]),
    ],
)
def test_errors_in_settings_have_a_place(
    capsys: pytest.CaptureFixture[str], here: Path, file: str, text: str, problems: list[str]
) -> None:
    add("enc_a", here / "specs/aa")
    (here / file).write_text(text, encoding="utf-8", errors="surrogateescape")
    code, _, err = run(capsys, "generate")
    assert code == 1
    found = [line for line in err.splitlines() if line.startswith(file)]
    assert len(found) == len(problems)
    for line, problem in zip(found, problems, strict=True):
        assert line.startswith(problem)
    assert not (here / "generated").exists()


@pytest.mark.parametrize("command", ["check", "list", "migrate", "generate --target c"])
def test_every_command_reports_an_unknown_target(capsys: pytest.CaptureFixture[str], here: Path, command: str) -> None:
    add("enc_a", here / "specs/aa")
    (here / "codewheel.yaml").write_text("targets: [c, dosc]\n")
    code, out, err = run(capsys, *command.split())
    assert (code, out) == (1, "")
    assert err.startswith("codewheel.yaml:1:14: undefined-reference: there is no target 'dosc'; did you mean 'docs'?")


def test_specs_in_the_output_folder_are_mentioned(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    add("enc_a", here / "specs/aa")
    (here / "codewheel.yaml").write_text("output: specs\n")
    code, _, err = run(capsys, "check")
    assert code == 2
    reason = ", apart from those in specs, which is the output folder and is not searched; name them: "
    assert err.startswith(f"codewheel: there are no specs in this folder or below it{reason}")


def test_two_files_with_settings_are_an_error(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    (two / "pyproject.toml").write_text('[tool.codewheel]\nspecs = ["specs"]\n')
    (two / "codewheel.yaml").write_text("specs: [specs]\n")
    code, _, err = run(capsys, "check")
    assert code == 1
    assert err.startswith("codewheel.yaml:1:1: duplicate-name: pyproject.toml next to it also has [tool.codewheel]; ")


def test_other_files_of_these_names_are_no_settings(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    (two / "pyproject.toml").write_text('[project]\nname = "x"\n')
    assert run(capsys, "check")[1].endswith("no problems in 2 families: enc_a, enc_b\n")
    assert main(["new", "codewheel", "-o", str(two / "specs/aa/codewheel.yaml")]) in (0, 1)
    assert run(capsys, "check", "specs/bb")[0] == 0
    (two / "pyproject.toml").write_text("# see tool.codewheel\n[project]\n")
    assert run(capsys, "check", "specs/bb")[0] == 0


@pytest.mark.parametrize(("language", "file"), [("toml", "pyproject.toml"), ("yaml", "codewheel.yaml")])
def test_the_settings_of_the_page(two: Path, language: str, file: str) -> None:
    page = (ROOT / "docs/transcribe/which-specs.md").read_text(encoding="utf-8")
    block = page.partition(f"```{language}\n")[2].partition("```")[0]
    (two / file).write_text(block, encoding="utf-8")
    settings = read_specs.find_settings()
    only = {"docs": FamilyFilter(grades=("manual", "quoted"))}
    assert settings == Configuration(Path(file), (Path("specs"),), Path("generated"), ("c", "docs"), only)


def test_the_limit_is_that_of_the_page() -> None:
    page = (ROOT / "docs/transcribe/which-specs.md").read_text(encoding="utf-8")
    assert f"ends after {read_specs.MOST_NAMES:,} files and folders" in page


# ------------------------------------------------------------------------------------------------------ the search


def test_repositories_and_links_below_are_not_searched_but_named(
    capsys: pytest.CaptureFixture[str], two: Path, tmp_path: Path
) -> None:
    add("enc_c", tmp_path / "cc")
    add("enc_d", two / "vendor/dd")
    (two / "vendor/.git").mkdir()
    (two / "linked").symlink_to(tmp_path / "cc")
    (two / "again").symlink_to("specs")
    code, out, err = run(capsys, "check")
    assert (code, out.splitlines()[-1]) == (0, "no problems in 2 families: enc_a, enc_b")
    assert err == "codewheel: not searched for specs: linked (a link), vendor (a repository of its own)\n"
    assert run(capsys, "check", "vendor", "linked")[1].endswith("no problems in 2 families: enc_c, enc_d\n")


def test_a_link_to_a_spec_is_read_once(capsys: pytest.CaptureFixture[str], two: Path, tmp_path: Path) -> None:
    add("enc_c", tmp_path / "cc")
    (two / "specs/cc").mkdir()
    for name in ("enc_c.yaml", "manufacturer.yaml"):
        (two / "specs/cc" / name).symlink_to(tmp_path / "cc" / name)
    (two / "specs/aa/same.yaml").symlink_to("enc_a.yaml")
    code, out, _ = run(capsys, "check")
    assert (code, out.splitlines()[-1]) == (0, "no problems in 3 families: enc_a, enc_b, enc_c")


def test_the_search_has_a_limit_and_says_so(
    capsys: pytest.CaptureFixture[str], two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(read_specs, "MOST_NAMES", 3)
    code, out, err = run(capsys, "check")
    assert (code, out) == (2, "")
    assert err.startswith(
        "codewheel: this folder has more than 3 files and folders, so not all of its specs were found;"
    )
    code, _, err = run(capsys, "decode", "AMM5A21/65KSC1", "0xF4243D3")
    assert (code, err.splitlines()[0][:60]) == (0, "codewheel: searched only 3 files and folders for specs; name")
    assert run(capsys, "check", "specs")[0] == 0, "a folder that is named is searched to its end"


# ------------------------------------------------------------------------------------------------------ packaged


@pytest.mark.slow
def test_a_packaged_encoder_is_generated_by_its_name(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    code, out, err = run(capsys, "generate", "--packaged", "AMM5A21/65KSC1", "--target", "c", "-o", "out")
    assert (code, err) == (0, "")
    assert out.startswith("read the packaged specs of AMM5A21/65KSC1: amm5\n")
    headers = {path.name for path in (two / "out/c/include/lika").iterdir()}
    assert "amm5_biss.h" in headers
    assert not any("ssi" in name or "rs485" in name for name in headers), "only the order code's interface"
    names = ["--packaged", "ichaus", "--packaged", "sma21", "--target", "biss", "-o", "out"]
    assert run(capsys, "generate", *names)[0] == 0
    assert {path.name for path in (two / "out/biss").glob("*-*.xml")} >= {"ichaus-icmu.xml", "lika-sma21.xml"}
    code, _, err = run(capsys, "generate", "--packaged", "AMM5A21/65KSX1", "-o", "out")
    assert code == 2
    assert "AMM5A21/65KSX1" in err


@pytest.mark.parametrize("name", ["AMM5A21/65KSC1", "amm5", "lika"])
def test_a_packaged_encoder_in_place_of_a_path(capsys: pytest.CaptureFixture[str], here: Path, name: str) -> None:
    code, _, err = run(capsys, "generate", name)
    remedy = f"to generate a packaged encoder: codewheel generate --packaged {name}"
    assert (code, err) == (2, f"codewheel: no such file or folder: {name}; {remedy}\n")
    code, _, err = run(capsys, "generate", "nowhere", "--packaged", "icmu")
    assert (code, err) == (2, "codewheel: no such file or folder: nowhere\n")


@pytest.mark.parametrize(
    ("name", "nearest"),
    [
        ("likka", "; did you mean 'lika'?\n"),
        ("LIKKA", "; did you mean 'lika'?\n"),
        ("amm6", "; the nearest are amm5"),  # Another digit is another family and not a typing error.
    ],
)
def test_the_nearest_packaged_name_is_suggested(
    capsys: pytest.CaptureFixture[str], here: Path, name: str, nearest: str
) -> None:
    code, _, err = run(capsys, "generate", "--packaged", name)
    assert code == 2
    assert err.startswith(f"codewheel: '{name}' is not a packaged order code, family or manufacturer{nearest}")


@pytest.mark.slow
def test_an_order_code_narrows_its_family_alone(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    for _ in range(2):  # The second run uses the cache.
        code, out, err = run(capsys, "generate", "specs", "--packaged", "AMM5A21/65KSC1", "--target", "c", "-o", "out")
        assert (code, err) == (0, "")
        assert out.startswith("read the packaged specs of AMM5A21/65KSC1: amm5, and 4 specs of yours: specs/aa/enc_a.")
    names = {path.name for path in (two / "out/c/include").glob("*/*.h")}
    assert {"amm5_biss.h", "enc_a_biss.h", "enc_b_biss.h"} <= names
    assert not any("ssi" in name or "rs485" in name for name in names), "only the order code's interface"


# ------------------------------------------------------------------------------------------------------ files of others

C = ("--target", "c")
#: Targets with and without a file for each family.
TARGETS = [word for name in ("c", "python", "biss", "docs", "masters", "browser") for word in ("--target", name)]


@pytest.fixture
def generated(capsys: pytest.CaptureFixture[str], two: Path) -> Path:
    """The output of two manufacturers."""
    assert run(capsys, "generate", *TARGETS)[0] == 0
    return two / "generated"


def without_record(folder: Path) -> None:
    """Rewrite the lists of an output as earlier versions wrote them."""
    for path in folder.glob(f"*/{LIST}"):
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        assert lines.pop(1) == "# Families: aa/enc_a bb/enc_b\n"
        path.write_text("".join(lines), encoding="utf-8")


@pytest.mark.slow
def test_outputs_of_others_are_neither_removed_nor_replaced(
    capsys: pytest.CaptureFixture[str], two: Path, generated: Path
) -> None:
    before = tree(generated)
    for more in ([], ["--check"], ["--force"], ["--unchecked"]):
        code, _, err = run(capsys, "generate", "specs/aa", *TARGETS, *more)
        assert (code, tree(generated)) == (1, before)
        assert err.startswith("codewheel: generated has outputs of bb/enc_b, which were not read (")
        assert " files: generated/biss/bb-enc_b.xml, generated/c/" in err
        assert ("Nothing has changed." in err) == (more != ["--check"]), "a comparison changes nothing anyway"
        assert "(codewheel generate specs/aa FOLDER --target c" in err
        assert err.endswith(" browser), write elsewhere with -o, or drop these outputs with --prune\n")
    code, _, err = run(capsys, "generate", "specs/aa", "--target", "c", "--prune", "--check")
    assert (code, tree(generated)) == (1, before)
    assert err.endswith(" out of date; run: codewheel generate specs/aa --target c --prune\n")
    code, out, _ = run(capsys, "generate", "specs/aa", *TARGETS, "--prune")
    assert code == 0
    assert "removed    generated/c/include/bb/enc_b_biss.h\n" in out
    assert not any("enc_b" in path for path in tree(generated))
    assert run(capsys, "generate", *TARGETS)[0] == 0
    assert tree(generated) == before


@pytest.mark.slow
@pytest.mark.parametrize("target", ["c", "python", "biss", "docs", "masters", "browser"])
def test_an_output_of_an_earlier_version_is_safe_too(
    capsys: pytest.CaptureFixture[str], generated: Path, target: str
) -> None:
    without_record(generated)
    before = tree(generated)
    code, _, err = run(capsys, "generate", "specs/aa", "--target", target)
    assert (code, tree(generated)) == (1, before)
    assert "Nothing has changed." in err
    # The same specs as before write the record. No other file changes.
    code, out, _ = run(capsys, "generate", *TARGETS)
    assert (code, out.splitlines()[-1][-15:]) == (0, "files unchanged")
    assert all("# Families: aa/enc_a bb/enc_b\n" in path.read_text() for path in generated.glob(f"*/{LIST}"))


@pytest.mark.slow
def test_an_earlier_version_of_ones_own_output_is_updated(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    add("enc_a", here / "specs/aa")
    assert run(capsys, "generate", *TARGETS)[0] == 0
    old = ["c/include/aa/enc_a_old.h", "docs/enc_a-old.md", "python/runtime/old.py"]
    for name in old:
        target, _, path = name.partition("/")
        (here / "generated" / name).write_text("old")
        listing = here / "generated" / target / LIST
        lines = listing.read_text(encoding="utf-8").splitlines(keepends=True)
        kept = "".join(line for line in lines if not line.startswith("# Families: "))
        listing.write_text(f"{kept}{path}\n", encoding="utf-8")
    code, out, err = run(capsys, "generate", *TARGETS)
    assert (code, err) == (0, "")
    assert sorted(line for line in out.splitlines() if "removed" in line) == [
        f"removed    generated/{name}" for name in old
    ]


@pytest.mark.slow
def test_files_of_an_earlier_version_may_belong_to_anyone(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    """Earlier versions recorded no families, and the name of a manufacturer does not tell which family it was."""
    add("enc_a", here / "specs/aa")
    assert run(capsys, "generate", *TARGETS)[0] == 0
    listing = here / "generated/biss" / LIST
    lines = listing.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = "".join(line for line in lines if not line.startswith("# Families: "))
    listing.write_text(f"{kept}aa-enc_b.xml\nidbiss6943.xml\n", encoding="utf-8")
    for name in ("aa-enc_b.xml", "idbiss6943.xml"):
        (here / "generated/biss" / name).write_text("old")
    before = tree(here / "generated")
    code, _, err = run(capsys, "generate", *TARGETS)
    assert (code, tree(here / "generated")) == (1, before)
    assert err.startswith(
        "codewheel: generated has files of an earlier version whose family is not known "
        "(2 files: generated/biss/aa-enc_b.xml, generated/biss/idbiss6943.xml). Nothing has changed. Remove them with "
        "--prune. If they are outputs of other specs, read these too (codewheel generate . FOLDER --target c "
    )
    assert run(capsys, "generate", *TARGETS, "--prune")[0] == 0
    assert run(capsys, "generate", *TARGETS)[0] == 0


@pytest.mark.slow
def test_a_spec_that_was_deleted(capsys: pytest.CaptureFixture[str], two: Path, generated: Path) -> None:
    add("enc_c", two / "specs/aa")
    assert run(capsys, "generate", *TARGETS)[0] == 0
    (two / "specs/aa/enc_c.yaml").unlink()
    before = tree(generated)
    # A missing spec can also be elsewhere, so its outputs are never removed without --prune.
    for names in (["specs"], []):
        code, _, err = run(capsys, "generate", *names, *TARGETS)
        assert (code, tree(generated)) == (1, before)
        assert err.startswith("codewheel: generated has outputs of aa/enc_c, which were not read (")
    code, out, _ = run(capsys, "generate", *TARGETS, "--prune")
    assert code == 0
    assert "removed    generated/docs/enc_c.md\n" in out
    assert not any("enc_c" in path for path in tree(generated))
    assert run(capsys, "generate", *TARGETS)[0] == 0, "--prune is needed once"


def generate_two_places(capsys: pytest.CaptureFixture[str], here: Path, other: str, *specs: str) -> dict[str, str]:
    """Write the outputs of ``proj/mine.yaml`` and of a family of the same manufacturer in another folder."""
    for name, folder in (("mine", here / "proj"), ("yours", here / other)):
        folder.mkdir(exist_ok=True)
        assert main(["new", name, "-o", str(folder / f"{name}.yaml")]) == 0
    assert run(capsys, "generate", "proj", other, *specs, *C)[0] == 0
    return tree(here / "generated")


def refuses_yours(capsys: pytest.CaptureFixture[str], again: str, *more: str) -> None:
    """Check that ``generate`` refuses to remove the family of the other folder and names the command to include it."""
    code, _, err = run(capsys, "generate", *C, *more)
    assert code == 1
    assert "has outputs of example/yours, which were not read (" in err
    assert f"Nothing has changed. Read these specs too (codewheel generate {again})" in err


def test_specs_beside_the_current_folder_keep_their_outputs(
    capsys: pytest.CaptureFixture[str], here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = generate_two_places(capsys, here, "other")
    monkeypatch.chdir(here / "proj")
    refuses_yours(capsys, ". FOLDER -o ../generated --target c", "-o", "../generated")
    assert run(capsys, "generate", ".", "../other", "-o", "../generated", *C)[0] == 0
    assert tree(here / "generated") == before


@pytest.mark.parametrize("other", ["repository", "build"])
def test_specs_that_are_not_searched_keep_their_outputs(
    capsys: pytest.CaptureFixture[str], here: Path, other: str
) -> None:
    if other == "repository":
        (here / "repository/.git").mkdir(parents=True)
    before = generate_two_places(capsys, here, other)
    refuses_yours(capsys, ". FOLDER --target c")
    assert tree(here / "generated") == before


def test_specs_that_the_settings_omit_keep_their_outputs(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    before = generate_two_places(capsys, here, "other")
    (here / "codewheel.yaml").write_text("specs: [proj]\n")
    refuses_yours(capsys, "proj FOLDER --target c")
    assert tree(here / "generated") == before


@pytest.mark.slow
def test_a_special_model_keeps_its_outputs(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    shutil.copytree(ROOT / "docs/example/tolvarn", here / "tolvarn")
    shutil.copytree(ROOT / "docs/example-overlay", here / "customer")
    assert run(capsys, "generate", "tolvarn", "customer", *C, "--unchecked")[0] == 0
    before = tree(here / "generated")
    code, _, err = run(capsys, "generate", "tolvarn", *C, "--unchecked")
    assert (code, tree(here / "generated")) == (1, before)
    assert err.startswith("codewheel: generated has outputs of tolvarn/tv62_s042, which were not read (")


@pytest.mark.slow
def test_packaged_outputs_of_the_same_manufacturer_are_kept(capsys: pytest.CaptureFixture[str], here: Path) -> None:
    assert run(capsys, "generate", "--packaged", "icmu", *C)[0] == 0
    before = tree(here / "generated")
    assert main(["new", "mine", "-o", str(here / "mine.yaml")]) == 0
    for path in here.glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("manufacturer: example", "manufacturer: ichaus"), encoding="utf-8")
    # A packaged encoder has no folder that the user could name.
    code, _, err = run(capsys, "generate", *C)
    assert (code, tree(here / "generated")) == (1, before)
    assert "has outputs of ichaus/icmu, which were not read (" in err
    assert "Read these specs too (codewheel generate . --packaged icmu --target c), write elsewhere" in err
    # The other way round, the user's specs are the ones that are missing.
    assert run(capsys, "generate", *C, "-o", "out")[0] == 0
    code, _, err = run(capsys, "generate", "--packaged", "icmu", *C, "-o", "out")
    assert code == 1
    assert "Read these specs too (codewheel generate . --packaged icmu -o out --target c), write elsewhere" in err


@pytest.mark.slow
def test_the_output_can_be_inside_the_specs(capsys: pytest.CaptureFixture[str], two: Path) -> None:
    for _ in range(2):
        assert run(capsys, "generate", "specs", "-o", "specs/out", *TARGETS)[0] == 0
        assert run(capsys, "check")[1].endswith("no problems in 2 families: enc_a, enc_b\n")
    assert run(capsys, "generate", "-o", "specs/out", "--check", *TARGETS)[0] == 0
    # A folder that generate writes is not searched, so no spec may be in it.
    add("enc_c", two / "docs/cc")
    code, _, err = run(capsys, "generate", "-o", ".", "--target", "docs")
    assert code == 1
    assert err.startswith(
        "codewheel: the spec docs/cc/enc_c.yaml is in docs, which generate writes; nothing has changed;"
    )


@pytest.mark.slow
def test_leftovers_of_a_killed_run_are_named(capsys: pytest.CaptureFixture[str], two: Path, generated: Path) -> None:
    assert run(capsys, "generate", "--check", *TARGETS)[0] == 0
    stage = generated / ".codewheel-biss-abcd1234"
    stage.mkdir()
    mark = "Temporary folder of codewheel generate. Its next run removes it.\n"
    (stage / ".codewheel-stage").write_text(mark, encoding="utf-8")
    (generated / ".codewheel-mine-abcd1234").mkdir()
    (generated / ".codewheel-mine-abcd1234/notes.txt").write_text("mine")
    code, out, err = run(capsys, "generate", "--check", *TARGETS)
    assert code == 1
    assert out.splitlines()[-1] == "left over  generated/.codewheel-biss-abcd1234"
    assert err.startswith("codewheel: 1 file out of date; run: codewheel generate --target c")
    assert run(capsys, "generate", *TARGETS)[0] == 0
    assert not stage.exists()
    assert (generated / ".codewheel-mine-abcd1234/notes.txt").exists()


@pytest.mark.slow
def test_targets_of_two_runs_are_named(capsys: pytest.CaptureFixture[str], two: Path, generated: Path) -> None:
    spec = two / "specs/aa/enc_a.yaml"
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace("max_hz: 10000000", "max_hz: 5000000"), encoding="utf-8")
    assert run(capsys, "generate", "--target", "c", "--target", "docs")[0] == 0
    code, out, _ = run(capsys, "generate", "--check", *TARGETS)
    assert code == 1
    lines = [line for line in out.splitlines() if line.startswith("up to date: ")]
    assert len(lines) == 1
    assert lines[0].startswith("up to date: c, ")
    assert "; out of date: " in lines[0]
    assert "biss" in lines[0].partition("; ")[2]


# ------------------------------------------------------------------------------------------------------ unknown labels


@pytest.mark.parametrize(
    ("label", "message"),
    [
        # The pattern of several families is {model}, which has a place for any label.
        ("EQN1325", "'EQN1325' is not a known order code; codewheel list shows the known patterns"),
        ("EQN1325-X", "'EQN1325-X' is not a known order code; codewheel list shows the known patterns"),
        ("WDGA36E", "'WDGA36E' is not an order code of WDGA; the nearest are WDGA36E-06-1218-SIA"),
        ("AS5047P1", "'AS5047P1' is not an order code of AS5047P; the nearest are AS5047P"),
    ],
)
def test_an_unknown_label_is_close_to_no_family(capsys: pytest.CaptureFixture[str], label: str, message: str) -> None:
    code, _, err = run(capsys, "decode", label, "0x1", "--specs", str(ROOT / "specs"))
    assert code == 2
    assert err.startswith(f"codewheel: {message}")


def test_a_wrong_part_of_a_known_label_is_still_named(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "show", "AMM5A19/65KSC1")
    assert code == 2
    assert err.startswith("codewheel: 'AMM5A19/65KSC1' has singleturn '19'; valid values: 17, 21, 23. The nearest ")
