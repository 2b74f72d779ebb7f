"""``only`` in the settings: the families and grades that each target writes."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from codewheel import cache as cache_module
from codewheel.cache import default_folder
from codewheel.commands.cli import main
from codewheel.language.document import SourceMark
from codewheel.loading.configuration import FamilyFilter
from codewheel.loading.configuration_file import places_in, read_configuration
from codewheel.output_folder import LIST, families_in

ROOT = Path(__file__).parents[2]
BISS, DOCS = ("--target", "biss"), ("--target", "docs")


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with a family of the grade manual, tv62, and a family of the grade uncorroborated, my_encoder."""
    folder = tmp_path / "project"
    shutil.copytree(ROOT / "docs/example/tolvarn", folder / "specs/tolvarn")
    monkeypatch.chdir(folder)
    assert main(["new", "my_encoder", "-o", "specs/mine/my_encoder.yaml"]) == 0
    return folder


def write_settings(project: Path, only: str = "") -> None:
    (project / "codewheel.yaml").write_text(f"specs: [specs]\n{only}", encoding="utf-8")


def families(project: Path, folder: str = "generated", target: str = "biss") -> set[str]:
    """Return the families whose files a target wrote."""
    output = project / folder / target
    paths = [path.relative_to(output).as_posix() for path in output.rglob("*")]
    return {name for name in ("my_encoder", "tv62") if any(name in path for path in paths)}


# ------------------------------------------------------------------------------------------------------ the choice


@pytest.mark.parametrize(
    ("only", "written"),
    [
        ("", {"my_encoder", "tv62"}),
        ("only: {biss: {families: [tv62]}}\n", {"tv62"}),
        pytest.param("only: {biss: {families: [my_encoder]}}\n", {"my_encoder"}, marks=pytest.mark.slow),
        pytest.param("only: {biss: {families: [my_encoder, tv62]}}\n", {"my_encoder", "tv62"}, marks=pytest.mark.slow),
        pytest.param("only: {biss: {grades: [manual, quoted]}}\n", {"tv62"}, marks=pytest.mark.slow),
        pytest.param("only: {biss: {grades: [uncorroborated]}}\n", {"my_encoder"}, marks=pytest.mark.slow),
        pytest.param(
            "only: {biss: {families: [my_encoder, tv62], grades: [manual]}}\n", {"tv62"}, marks=pytest.mark.slow
        ),
        pytest.param("only: {docs: {families: [my_encoder]}}\n", {"my_encoder", "tv62"}, marks=pytest.mark.slow),
    ],
)
def test_a_target_writes_the_families_of_its_condition(
    capsys: pytest.CaptureFixture[str], project: Path, only: str, written: set[str]
) -> None:
    write_settings(project, only)
    assert run(capsys, "generate", *BISS)[0] == 0
    assert families(project) == written
    owners = {"my_encoder": "example/my_encoder", "tv62": "tolvarn/tv62"}
    assert families_in(project / "generated/biss") == sorted(owners[name] for name in written)
    assert run(capsys, "generate", *BISS, "--check")[0] == 0


def test_both_notations_are_the_same(project: Path) -> None:
    filters = {"docs": FamilyFilter(grades=("manual", "quoted")), "masters": FamilyFilter(families=("tv62",))}
    write_settings(project, "only:\n  docs: {grades: [manual, quoted]}\n  masters: {families: [tv62]}\n")
    settings = read_configuration(Path("codewheel.yaml"))
    assert settings is not None
    assert settings.only == filters
    for text in (
        '[tool.codewheel.only.docs]\ngrades = ["manual", "quoted"]\n[tool.codewheel.only.masters]\nfamilies = ["tv62"]',
        '[tool.codewheel]\nonly = {docs = {grades = ["manual", "quoted"]}, masters = {families = ["tv62"]}}\n',
        '[tool.codewheel]\nonly.docs.grades = ["manual", "quoted"]\nonly.masters.families = ["tv62"]\n',
    ):
        Path("pyproject.toml").write_text(text, encoding="utf-8")
        settings = read_configuration(Path("pyproject.toml"))
        assert settings is not None
        assert settings.only == filters


def test_a_comparison_reports_families_that_are_not_selected(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project)
    assert run(capsys, "generate", *BISS)[0] == 0
    write_settings(project, "only: {biss: {families: [tv62]}}\n")
    code, out, err = run(capsys, "generate", *BISS, "--check")
    assert code == 1
    assert "left over  generated/biss/example-my_encoder.xml\n" in out
    assert err.endswith(" out of date; run: codewheel generate --target biss\n")


@pytest.mark.slow
def test_only_the_folder_of_the_settings_is_limited(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project, "output: tracked\nonly: {biss: {families: [tv62]}}\n")
    assert run(capsys, "generate", *BISS, "-o", "out")[0] == 0
    assert families(project, "out") == {"my_encoder", "tv62"}
    for output in ("tracked", "./specs/../tracked", str(project / "tracked")):
        assert run(capsys, "generate", *BISS, "-o", output)[0] == 0
        assert families(project, "tracked") == {"tv62"}
    # Specs that are named on the command line are limited too.
    assert run(capsys, "generate", "specs", *BISS)[0] == 0
    assert families(project, "tracked") == {"tv62"}


@pytest.mark.slow
def test_an_edition_is_written_with_its_family(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    (project / "codewheel.yaml").write_text("only: {biss: {families: [amm5]}}\n", encoding="utf-8")
    command = ("generate", str(ROOT / "specs/lika"), *BISS, "--edition", "amm5=1.6")
    assert run(capsys, *command)[::2] == (0, "")
    names = sorted(path.name for path in (project / "generated/biss").glob("lika-*.xml"))
    assert names == ["lika-amm5.xml", "lika-amm5_1_6.xml"]
    # Without the edition, the command would remove it.
    (project / "generated/biss/lika-amm5_1_6.xml").write_text("", encoding="utf-8")
    err = run(capsys, *command, "--check")[2]
    assert err.endswith(f" out of date; run: codewheel generate {ROOT}/specs/lika --target biss --edition amm5=1.6\n")


def test_a_target_that_would_write_no_family_is_an_error(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project, "only: {biss: {grades: [quoted]}}\n")
    code, _, err = run(capsys, "generate", *BISS)
    assert (code, err) == (
        1,
        (
            "codewheel: the setting 'only.biss' accepts no family that was read: my_encoder (uncorroborated), tv62 "
            "(manual); change it, or name the other targets with --target\n"
        ),
    )
    assert not (project / "generated").exists()


def test_c_need_not_express_a_family_that_it_does_not_write(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    broken = ROOT / "tests/check/broken_model"
    (project / "specs/broken").mkdir()
    for name in ("c_name_procedure.yaml", "manufacturer.yaml"):
        shutil.copy(broken / name, project / "specs/broken")
    write_settings(project)
    code, _, err = run(capsys, "generate", "--target", "c", "--unchecked")
    assert code == 1
    assert ": c-name: " in err
    write_settings(project, "only: {c: {families: [tv62]}}\n")
    assert run(capsys, "generate", "--target", "c", "--unchecked")[0] == 0
    assert families(project, target="c") == {"tv62"}


@pytest.mark.slow
def test_an_order_code_narrows_c_to_the_families_that_it_writes(
    capsys: pytest.CaptureFixture[str], project: Path
) -> None:
    write_settings(project, "only: {c: {families: [tv62, amm5]}}\n")
    code, _, err = run(capsys, "generate", "specs", "--packaged", "AMM5A21/65KSC1", "--target", "c", "--unchecked")
    assert (code, err) == (0, "")
    assert families(project, target="c") == {"tv62"}
    assert (project / "generated/c/include/lika/amm5_biss.h").is_file()


# ------------------------------------------------------------------------------------------------------ earlier outputs


@pytest.mark.slow
@pytest.mark.parametrize("is_recorded", [True, False])
def test_outputs_of_a_family_that_is_no_longer_selected_are_removed(
    capsys: pytest.CaptureFixture[str], project: Path, is_recorded: bool
) -> None:
    """The families in the list of an output were read, so the guard allows its files to be removed.

    Old lists have no families.
    """
    write_settings(project)
    assert run(capsys, "generate", *BISS, *DOCS)[0] == 0
    if not is_recorded:
        for target in ("biss", "docs"):
            listing = project / "generated" / target / LIST
            lines = listing.read_text(encoding="utf-8").splitlines(keepends=True)
            listing.write_text("".join(line for line in lines if "# Families" not in line), encoding="utf-8")
    write_settings(project, "only: {biss: {families: [tv62]}, docs: {families: [my_encoder]}}\n")
    code, out, err = run(capsys, "generate", *BISS, *DOCS)
    assert (code, err) == (0, "")
    assert "removed    generated/biss/example-my_encoder.xml\n" in out
    assert "removed    generated/docs/tv62.md\n" in out
    assert (families(project), families(project, target="docs")) == ({"tv62"}, {"my_encoder"})


def test_outputs_of_a_family_that_was_not_read_are_kept(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project, "only: {biss: {families: [tv62]}}\n")
    assert run(capsys, "generate", *BISS)[0] == 0
    write_settings(project, "only: {biss: {families: [my_encoder]}}\n")
    code, _, err = run(capsys, "generate", "specs/mine", *BISS)
    assert code == 1
    assert err.startswith("codewheel: generated has outputs of tolvarn/tv62, which were not read (")
    assert families(project) == {"tv62"}
    # A family that is not among the outputs of a target can be missing.
    write_settings(project, "only: {biss: {families: [tv62]}}\n")
    assert run(capsys, "generate", "specs/tolvarn", *BISS)[0] == 0


@pytest.mark.slow
def test_a_stored_result_belongs_to_its_condition(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(cache_module, "default_folder", default_folder)
    conditions = ["", "only: {biss: {families: [tv62]}}\n", "only: {biss: {grades: [uncorroborated]}}\n"]
    conditions.append("only: {biss: {families: [my_encoder, tv62]}}\n")
    written = [{"my_encoder", "tv62"}, {"tv62"}, {"my_encoder"}, {"my_encoder", "tv62"}]
    for _ in range(2):
        for condition, names in zip(conditions, written, strict=True):
            write_settings(project, condition)
            assert run(capsys, "generate", *BISS)[0] == 0
            assert families(project) == names
            assert "unchanged" in run(capsys, "generate", *BISS)[1].splitlines()[-1]
    # A run of check without problems is stored too.
    assert run(capsys, "check")[0] == 0
    write_settings(project, "only: {biss: {families: [tv63]}}\n")
    assert run(capsys, "check")[0] == 1


# ------------------------------------------------------------------------------------------------------ errors

TARGETS = "python, c, biss, docs, browser, masters"
CONDITION = "must be a map with 'families' or 'grades', such as"
TEXTS = "must be a list of texts, such as"


@pytest.mark.parametrize(
    ("file", "text", "problems"),
    [
        (
            "pyproject.toml",
            '[tool.codewheel]\nspecs = ["specs"]\nonly = ["c"]\n',
            [
                (
                    "3:8: wrong-type: 'only' must be a map of targets, such as "
                    'only = {docs = {grades = ["manual", "quoted"]}}'
                )
            ],
        ),
        (
            "codewheel.yaml",
            "only: c\n",
            ["1:7: wrong-type: 'only' must be a map of targets, such as only: {docs: {grades: [manual, quoted]}}"],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel.only]\nc = "tv62"\n[tool.codewheel.only.docs]\n',
            [
                f"2:5: wrong-type: 'only.c' {CONDITION} c = {{families = [\"my_encoder\"]}}",
                f"3:22: wrong-type: 'only.docs' {CONDITION} docs = {{families = [\"my_encoder\"]}}",
            ],
        ),
        (
            "codewheel.yaml",
            "only: {c: tv62}\n",
            [f"1:11: wrong-type: 'only.c' {CONDITION} c: {{families: [my_encoder]}}"],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel.only.c]\nfamilies = "tv62"\ngrades = []\n[tool.codewheel.only.docs]\nfamilies = [1]\n',
            [
                f"2:12: wrong-type: 'only.c.families' {TEXTS} families = [\"my_encoder\"]",
                f'3:10: wrong-type: \'only.c.grades\' {TEXTS} grades = ["manual", "quoted"]',
                f"5:12: wrong-type: 'only.docs.families' {TEXTS} families = [\"my_encoder\"]",
            ],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel.only.c]\nowner = ["tv62"]\n[tool.codewheel]\nonly.docs = {grade = ["manual"]}\n',
            [
                "2:1: unknown-key: unknown key 'owner'; known keys: families, grades",
                "4:14: unknown-key: unknown key 'grade'; did you mean 'grades'?",
            ],
        ),
        (
            "pyproject.toml",
            "[tool.codewheel.only.c]\ngrades = [\n  'manual',  # 'x'\n  \"manaul\",\n  'best']\n",
            [
                "4:3: not-allowed: a grade cannot be 'manaul'; did you mean 'manual'?",
                (
                    "5:3: not-allowed: a grade cannot be 'best'; it can be 'manual', 'quoted', 'corroborated', "
                    "'corroborated, no hardware frame seen' or 'uncorroborated'"
                ),
            ],
        ),
        (
            "pyproject.toml",
            '[tool.codewheel]\ntargets = ["d"]\n[tool.codewheel.only.dosc]\nfamilies = ["tv62"]\n',
            [
                f"2:12: undefined-reference: there is no target 'd'; there are: {TARGETS}",
                "3:22: undefined-reference: there is no target 'dosc'; did you mean 'docs'?",
            ],
        ),
        (
            "codewheel.yaml",
            "only:\n  dosc: {families: [tv62]}\n",
            ["2:3: undefined-reference: there is no target 'dosc'; did you mean 'docs'?"],
        ),
    ],
)
@pytest.mark.parametrize("command", ["generate", "list"])
def test_errors_in_a_condition_have_a_place(
    capsys: pytest.CaptureFixture[str], project: Path, file: str, text: str, problems: list[str], command: str
) -> None:
    (project / file).write_text(text, encoding="utf-8")
    code, _, err = run(capsys, command)
    assert code == 1
    assert [line for line in err.splitlines() if line.startswith(file)] == [f"{file}:{line}" for line in problems]
    assert not (project / "generated").exists()


def test_a_family_without_a_spec_is_reported(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project, "only:\n  c: {families: [tv62, my_encodr]}\n  biss: {families: [TV62, tv_63]}\n")
    expected = [
        (
            "codewheel.yaml:3:24: undefined-reference: there is no family 'my_encodr' among the specs; "
            "did you mean 'my_encoder'?"
        ),
        "codewheel.yaml:4:21: undefined-reference: there is no family 'TV62' among the specs; did you mean 'tv62'?",
        (
            "codewheel.yaml:4:27: undefined-reference: there is no family 'tv_63' among the specs; "
            "there are: my_encoder, tv62"
        ),
    ]
    for command in (("check",), ("generate",), ("generate", "-o", "out", *BISS)):
        code, out, err = run(capsys, *command)
        assert code == 1
        assert [line for line in (out + err).splitlines() if line.startswith("codewheel.yaml:")] == expected
    # Specs that are named need not be all.
    write_settings(project, "only: {biss: {families: [tv62, my_encoder]}}\n")
    assert run(capsys, "check", "specs/mine")[0] == 0
    assert run(capsys, "generate", "specs/mine", *BISS)[0] == 0


def test_a_family_whose_spec_is_broken_has_a_spec(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    write_settings(project, "only: {biss: {families: [my_encoder, other]}}\n")
    (project / "specs/mine/my_encoder.yaml").write_text("device: [\n", encoding="utf-8")
    _, out, _ = run(capsys, "check")
    lines = [line for line in out.splitlines() if line.startswith("codewheel.yaml:")]
    assert lines == [
        "codewheel.yaml:2:38: undefined-reference: there is no family 'other' among the specs; there are: tv62"
    ]


# ------------------------------------------------------------------------------------------------------ places in TOML

TOML = '''# "a" = [1]
top = 1979-05-27 07:32:00 # x = 2
[a . "b c".d]
text = """
x = "1"  \\""" """"
'lit' = \'\'\'
[a]\'\'\'
list = [ # first
  "one", 'two', [3.5, 0x1F],
  {k = "v", m.n = [true]},
]
last.x.y = {}
[[many]]
one = 1
[a]
two = 2'''


@pytest.mark.parametrize(
    ("path", "key", "value"),
    [
        (("top",), (2, 1), (2, 7)),
        (("a",), (3, 2), (3, 2)),
        (("a", "b c", "d"), (3, 12), (3, 12)),
        (("a", "b c", "d", "text"), (4, 1), (4, 8)),
        (("a", "b c", "d", "lit"), (6, 1), (6, 9)),
        (("a", "b c", "d", "list"), (8, 1), (8, 8)),
        (("a", "b c", "d", "list", 1), (9, 10), (9, 10)),
        (("a", "b c", "d", "list", 2, 1), (9, 23), (9, 23)),
        (("a", "b c", "d", "list", 3, "m", "n"), (10, 15), (10, 19)),
        (("a", "b c", "d", "list", 3, "m", "n", 0), (10, 20), (10, 20)),
        (("a", "b c", "d", "last", "x", "y"), (12, 8), (12, 12)),
        (("many", "one"), (14, 1), (14, 7)),
        (("a", "two"), (16, 1), (16, 7)),
    ],
)
def test_places_of_keys_and_values(path: tuple[str | int, ...], key: tuple[int, int], value: tuple[int, int]) -> None:
    mark: SourceMark = places_in(TOML)
    for step in path:
        mark = mark.children[step]
    assert ((mark.key_line, mark.key_column), (mark.line, mark.column)) == (key, value)


def test_the_sample_is_valid_toml() -> None:
    tomllib = pytest.importorskip("tomllib")
    assert tomllib.loads(TOML)["a"]["b c"]["d"]["list"][3] == {"k": "v", "m": {"n": [True]}}
