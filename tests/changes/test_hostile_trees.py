"""``codewheel diff`` on a hostile git tree does not write elsewhere, run commands or read huge files."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from shutil import copytree

import pytest
from codewheel.commands.cli import main
from codewheel.loading import revisions
from codewheel.loading.revisions import RevisionError, RevisionFiles, RevisionPath, write_revision
from pair import BASE

#: They start git.
pytestmark = pytest.mark.slow
Git = Callable[..., str]
Entry = tuple[str, str, str]
FILE, FOLDER = "100644", "40000"


@pytest.fixture
def git(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Git:
    """Create a repository with the base in ``specs``. Temporary folders are in ``tmp_path/deep/down/tmp``."""
    repository = tmp_path / "repository"
    copytree(BASE, repository / "specs")
    monkeypatch.chdir(repository)
    for name in ("GIT_DIR", "GIT_INDEX_FILE", "GIT_WORK_TREE"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "deep/down/tmp").mkdir(parents=True)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "deep/down/tmp"))

    def run(*words: str, stdin: bytes = b"") -> str:
        settings = ("-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false")
        done = subprocess.run(["git", *settings, *words], check=True, capture_output=True, input=stdin)
        return done.stdout.decode().strip()

    run("init", "-q")
    run("add", ".")
    run("commit", "-q", "-m", "first")
    return run


def blob(git: Git, content: bytes) -> str:
    return git("hash-object", "-w", "--stdin", stdin=content)


def tree(git: Git, *entries: Entry) -> str:
    """Return the tree of these entries with any names, which git itself would refuse to create."""
    raw = b""
    for mode, name, object_id in entries:
        raw += f"{mode} ".encode() + os.fsencode(name) + b"\0" + bytes.fromhex(object_id)
    return git("hash-object", "-t", "tree", "--literally", "-w", "--stdin", stdin=raw)


def commit(git: Git, top: str) -> None:
    git("tag", "evil", git("commit-tree", "-m", "evil", top))


def files_below(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and ".git" not in path.relative_to(folder).parts)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


SPEC = (BASE / "demo.yaml").read_bytes()


@pytest.mark.parametrize(
    ("parts", "path_text", "unsafe_name"),
    [
        (["..", "..", "..", "victim.yaml"], "../../../victim.yaml", ".."),
        (["../../../victim.yaml"], "../../../victim.yaml", ".."),
        (["{tmp}/victim.yaml"], "{tmp}/victim.yaml", ""),
        (["sub", "{tmp}", "victim.yaml"], "sub/{tmp}/victim.yaml", ""),
        ([".", "victim.yaml"], "./victim.yaml", "."),
        (["..\\..\\victim.yaml"], "..\\..\\victim.yaml", "..\\..\\victim.yaml"),
        (["C:victim.yaml"], "C:victim.yaml", "C:victim.yaml"),
    ],
)
@pytest.mark.parametrize("argument", ["evil:specs", "evil:"])
def test_a_name_that_leads_elsewhere_is_refused(
    git: Git,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    argument: str,
    parts: list[str],
    path_text: str,
    unsafe_name: str,
) -> None:
    (tmp_path / "victim.yaml").write_text("precious")
    inside, mode = blob(git, SPEC), FILE
    for part in reversed(parts):
        inside, mode = tree(git, (mode, part.format(tmp=tmp_path), inside)), FOLDER
    commit(git, tree(git, (FOLDER, "specs", inside)))
    before = files_below(tmp_path)
    assert main(["diff", "HEAD:specs", argument]) == 2
    name = f"specs/{path_text.format(tmp=tmp_path)}"
    assert capsys.readouterr().err == (
        f"codewheel: evil contains a file '{name}'; '{unsafe_name}' is not a safe name, so the revision is not read\n"
    )
    assert files_below(tmp_path) == before


def laid_out(tmp_path: Path, path: str, revision: str = "evil") -> RevisionFiles:
    (tmp_path / "out").mkdir()
    return write_revision(RevisionPath(revision, path), tmp_path / "out")


def test_folders_have_neutral_names_and_messages_the_true_ones(git: Git, tmp_path: Path) -> None:
    spec, other_blob = blob(git, SPEC), blob(git, b"a: 1\n")
    deep = tree(git, (FILE, "demo.yaml", spec), (FILE, "manufacturer.yaml", other_blob))
    odd = tree(git, (FILE, "a.yaml", other_blob), (FILE, "A.yaml", spec), (FILE, "con\n.yaml", other_blob))
    hidden = tree(git, (FILE, "x.yaml", other_blob))
    commit(git, tree(git, (FOLDER, "$(id)", deep), (FOLDER, ".hidden", hidden), (FOLDER, "odd", odd)))
    laid = laid_out(tmp_path, "")
    assert {path: laid.names[str(tmp_path / "out" / path)] for path in files_below(tmp_path / "out")} == {
        "0/demo.yaml": "evil:$(id)/demo.yaml",
        "0/manufacturer.yaml": "evil:$(id)/manufacturer.yaml",
        "1/a.yaml": "evil:odd/a.yaml",
        "1/3.yaml": "evil:odd/A.yaml",
        "1/4.yaml": "evil:odd/con\n.yaml",
    }
    assert (tmp_path / "out/1/3.yaml").read_bytes() == SPEC
    assert (laid.place, laid.names[str(laid.place)]) == (tmp_path / "out", "evil:")


def test_a_giant_is_not_read(git: Git, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "trace").touch()
    monkeypatch.setenv("GIT_TRACE", str(tmp_path / "trace"))
    commit(git, tree(git, (FILE, "big.yaml", blob(git, b"#" * (4 * 2**20 + 1)))))
    with pytest.raises(
        RevisionError, match=r"^evil:big\.yaml is larger than 4 MB and cannot be a spec; name the folder"
    ):
        laid_out(tmp_path, "")
    trace = (tmp_path / "trace").read_text()
    assert "--batch-check" in trace
    assert "cat-file --batch\n" not in trace


def test_many_large_files_are_not_read(git: Git, tmp_path: Path) -> None:
    large = blob(git, b"#" * (4 * 2**20))
    commit(git, tree(git, *((FILE, f"{number:02}.yaml", large) for number in range(17))))
    with pytest.raises(RevisionError, match=r"^the YAML files of evil: exceed 64 MB in total; name the folder"):
        laid_out(tmp_path, "")


def test_a_tree_that_lists_more_than_any_disk_holds(git: Git, tmp_path: Path) -> None:
    inside = tree(git, *((FILE, f"{number}.yaml", blob(git, b"")) for number in range(10)))
    for _ in range(20):
        inside = tree(git, *((FOLDER, str(number), inside) for number in range(10)))
    commit(git, inside)
    with pytest.raises(RevisionError, match=r"^git lists more than 16 MB here; name the folder of the specs"):
        laid_out(tmp_path, "")


@pytest.fixture
def partial_clone(git: Git, tmp_path: Path) -> Path:
    """Make the repository a partial clone that lacks one spec, and whose server is a command. Return its mark."""
    lost = git("rev-parse", "HEAD:specs/demo.yaml")
    mark = tmp_path / "run"
    for key, value in {
        "core.repositoryFormatVersion": "1",
        "extensions.partialClone": "origin",
        "remote.origin.url": f"ext::sh -c touch% {mark}",
        "remote.origin.promisor": "true",
        "remote.origin.partialCloneFilter": "blob:none",
        "protocol.ext.allow": "always",
    }.items():
        git("config", key, value)
    (Path(".git/objects") / lost[:2] / lost[2:]).unlink()
    return mark


def test_nothing_is_fetched(partial_clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "trace").touch()
    monkeypatch.setenv("GIT_TRACE", str(tmp_path / "trace"))
    with pytest.raises(RevisionError):
        laid_out(tmp_path, "specs", "HEAD")
    assert "fetch" not in (tmp_path / "trace").read_text()
    assert not partial_clone.exists()


def test_a_git_that_fetches_all_the_same_finds_no_protocol(
    partial_clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(revisions._QUIET, "GIT_NO_LAZY_FETCH")
    with pytest.raises(RevisionError):
        laid_out(tmp_path, "specs", "HEAD")
    assert not partial_clone.exists()


def test_a_revision_never_becomes_an_option(git: Git, tmp_path: Path) -> None:
    with pytest.raises(RevisionError, match=r"^'--git-dir' is not a revision"):
        laid_out(tmp_path, "specs", "--git-dir")
