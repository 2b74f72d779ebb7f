"""Files in a folder that count as specs, and those that are skipped."""

from __future__ import annotations

from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.language.files import LINK, NESTED, find_files, top_keys
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_specs

# YAML files of other tools, each with keys from its own documentation.
FOREIGN = {
    "compose.yaml": 'version: "3"\nservices:\n  device: {image: x}\n',
    "azure-pipelines.yml": "parameters:\n  - name: x\ntrigger: [main]\n",
    "zephyr/module.yml": "name: x\nbuild:\n  cmake: zephyr\n",
    "mkdocs.yml": "site_name: x\nnav: [a.md]\n",
    "list.yaml": "- device: x\n- codewheel: 1\n",
    "helm.yaml": "{{- if .Values.x }}\nkind: Pod\n{{- end }}\n",
    "empty.yaml": "",
    "comment.yaml": "# device: x\n",
    "openapi.json.yaml": '{"openapi": "3.1.0", "paths": {}}',
}
# Specs, each broken in another way. All must be read, so that check reports the problem.
SPECS = {
    "plain.yaml": "codewheel: 1\ndevice: x\n",
    "no_version.yaml": "device: x\n",
    "misspelt.yaml": "devise: x\nregisters: []\norder_code: {}\n",
    "nameless.yaml": "title: x\ninterfaces: {}\ncrcs: []\n",
    "maker.yml": "manufacturer: x\n",
    "master.yml": "master: x\n",
    "syntax.yaml": "codewheel: 1\ndevice: x\nregisters: [\n",
    "quoted.yaml": '---\n"device" : x\n',
    "indented.yaml": "%YAML 1.2\n---\n  # first\n  device: x\n",
    "flow.yaml": "{device: x}",
    "windows.yaml": "\ufefftitle: x\r\ndevice: x\r\n",
    "old_mac.yaml": "title: x\rdevice: x\r",
    "tabs.yaml": "title: x\ndevice:\tx\n",
}


def read(folder: Path) -> tuple[set[str], set[str]]:
    report = ProblemReport()
    read_specs([folder], report)
    files = {Path(name).relative_to(folder).as_posix() for name in report.files}
    passed_over = {Path(name).relative_to(folder).as_posix() for name in report.passed_over}
    return files, passed_over


def test_specs_are_told_from_the_yaml_of_others(tmp_path: Path) -> None:
    for name, text in {**FOREIGN, **SPECS}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(text.encode())
    (tmp_path / "utf16.yaml").write_bytes("device: x\n".encode("utf-16"))
    (tmp_path / "gone.yaml").symlink_to("nowhere")
    assert read(tmp_path) == ({*SPECS, "utf16.yaml", "gone.yaml"}, set(FOREIGN))


def test_a_long_name_is_read_once(tmp_path: Path) -> None:
    """Half a megabyte takes hours if each letter is a possible beginning of a key."""
    path = tmp_path / "long.yaml"
    path.write_text(f'{{"device": 1, "{"x" * 500_000}": 2, "title": "{"y" * 500_000}"}}', encoding="ascii")
    assert top_keys(path) == {"device", "x" * 500_000, "title"}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_given_by_name_is_always_read(tmp_path: Path, name: str) -> None:
    path = tmp_path / Path(name).name
    path.write_text(FOREIGN[name])
    report = ProblemReport()
    read_specs([path], report)
    assert report.files == [str(path)]


def test_a_folder_of_other_yaml_files_holds_no_spec(tmp_path: Path) -> None:
    (tmp_path / "ci.yml").write_text("jobs: {}\n")
    report = ProblemReport()
    assert read_specs([tmp_path], report) == []
    (problem,) = report.problems
    assert problem.rule == "no-specs"
    assert problem.message.endswith(
        "'device', 'manufacturer' or 'master') in this folder; 1 other YAML file was skipped"
    )


def test_folders_without_specs_of_the_user_are_left_out(tmp_path: Path) -> None:
    hidden = (".git/a.yaml", "venv/lib/b.yaml", "out/c/top.yaml", "out/c/x/c.yaml", "build/lib/specs/d.yaml")
    excluded = ("node_modules/x/e.yaml", "x.egg-info/f.yaml", "target/debug/g.yaml", "vendor/specs/h.yaml")
    for name in (*hidden, *excluded, "specs/i.yaml"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("device: x\n")
    (tmp_path / "venv/pyvenv.cfg").write_text("")
    (tmp_path / "target/CACHEDIR.TAG").write_text("")
    (tmp_path / "vendor/.git").write_text("gitdir: elsewhere\n")
    (tmp_path / "out/c/.codewheel").write_text("# Written by codewheel generate\ntop.yaml\n")
    (tmp_path / "link").symlink_to("specs")
    assert read(tmp_path) == ({"specs/i.yaml"}, set())
    found = find_files(tmp_path)
    assert found.not_entered == ((tmp_path / "link", LINK), (tmp_path / "vendor", NESTED))
    assert read(tmp_path / "vendor") == ({"specs/h.yaml"}, set()), "a folder that is named is always searched"


def test_the_search_can_have_a_limit(tmp_path: Path) -> None:
    for name in ("a.yaml", "b/c.yaml", "b/d.yaml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("device: x\n")
    assert find_files(tmp_path, most_names=4).is_complete
    found = find_files(tmp_path, most_names=3)
    assert ([path.name for path in found.specs], found.is_complete) == (["a.yaml"], False)


@pytest.mark.slow
def test_a_folder_can_be_checked_and_generated_again_and_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "demo"]) == 0
    (tmp_path / "ci.yml").write_text("jobs: {}\n")
    for command in (
        ["generate", "."],
        ["generate", "."],
        ["check", "."],
        ["generate", ".", "--check"],
        ["generate"],
        ["generate", "-o", "."],
        ["check", "."],
    ):
        assert main(command) == 0, capsys.readouterr().err
    assert "read 2 specs: demo.yaml, manufacturer.yaml; skipped: ci.yml" in capsys.readouterr().out
