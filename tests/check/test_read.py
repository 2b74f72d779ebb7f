"""Reading: YAML 1.2 values, places, and files that are not specs."""

from __future__ import annotations

import os
import pathlib
import time

import pytest
from codewheel.language.document import Document
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document, read_specs


def read(folder: pathlib.Path, content: str | bytes) -> tuple[Document | None, list[str]]:
    """Return the document made from ``content``, and the problems."""
    path = folder / "spec.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    report = ProblemReport()
    document = read_document(path, report, "spec.yaml")
    return document, [problem.format() for problem in report.problems]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("7:0", "7:0"),
        ("12:30", "12:30"),
        ("no", "no"),
        ("on", "on"),
        ("Yes", "Yes"),
        ("010", 10),
        ("0o10", 8),
        ("0x1F", 31),
        ("0b11", "0b11"),
        ("-3", -3),
        ("+3", 3),
        ("1_000", "1_000"),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("1.9", 1.9),
        ("-.inf", float("-inf")),
        ("2024-05-10", "2024-05-10"),
        ("true", True),
        ("FALSE", False),
        ("tRue", "tRue"),
        ("null", None),
        ("~", None),
        ("", None),
        ('"5"', "5"),
        ("'true'", "true"),
        ('""', ""),
        ("!!str 5", "5"),
        ("! 5", "5"),
        ("!!float 5", 5),
        ("=", "="),
    ],
)
def test_scalars_follow_yaml_1_2(tmp_path: pathlib.Path, text: str, value: object) -> None:
    document, problems = read(tmp_path, f"key: {text}\n")
    assert problems == []
    assert document is not None
    assert document.data["key"] == value
    assert type(document.data["key"]) is type(value)


def test_keys_stay_as_written(tmp_path: pathlib.Path) -> None:
    document, problems = read(tmp_path, "01: a\n0A: b\n'17': c\nno: d\n1e3: e\n")
    assert problems == []
    assert document is not None
    assert list(document.data) == ["01", "0A", "17", "no", "1e3"]


def test_aliases_repeat_values(tmp_path: pathlib.Path) -> None:
    document, problems = read(tmp_path, "a: &x {b: [1]}\nc: *x\n")
    assert problems == []
    assert document is not None
    assert document.data["c"] == {"b": [1]}
    assert document.position(("c",)) == (2, 4)
    assert document.position(("c", "b", 0)) == (1, 12)


def test_positions(tmp_path: pathlib.Path) -> None:
    document, _ = read(
        tmp_path, "\ufeffregisters:\n  - name: bank\n    fields: [{name: low, bits: 3}]\n  - {revision: 1.9, x: 1}\n"
    )
    assert document is not None
    assert document.position(("registers", 0, "name")) == (2, 11)
    assert document.position(("registers", "bank", "name"), at_key=True) == (2, 5)
    assert document.position(("registers", "bank", "fields", "low", "bits")) == (3, 32)
    assert document.position(("registers", "1.9", "x")) == (4, 24)
    # Problems of a missing path are reported at the key of its nearest existing parent.
    assert document.position(("registers", "bank", "default")) == (2, 5)
    assert document.position(("registers", 7)) == (1, 1)
    assert document.position(("nothing", "at", "all")) == (1, 1)
    assert document.name_path(("registers", 0, "fields", 0, "bits")) == "registers.bank.fields.low.bits"
    assert document.name_path(("registers", 1, "x")) == "registers[2].x"


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "spec.yaml:1:1: empty: the file is empty; a spec begins with 'codewheel: 1'"),
        (b"\n# nothing but a comment\n", "spec.yaml:1:1: empty: the file is empty; a spec begins with 'codewheel: 1'"),
        (b"---\n", "spec.yaml:1:1: empty: the file is empty; a spec begins with 'codewheel: 1'"),
        (b"\x7fELF\x02\x01\x01\x00\x00", "spec.yaml:1:1: not-text: this is a binary file; a spec is UTF-8 text"),
        ("a: 1\n".encode("utf-16"), "spec.yaml:1:1: not-text: this is a binary file; a spec is UTF-8 text"),
        (b"a: 1\nb: caf\xe9\n", "spec.yaml:2:1: not-text: byte 0xE9 is not UTF-8; save the file as UTF-8"),
        (b"a: 1\nb: x\x1b[2Jy\n", "spec.yaml:2:5: not-text: the character U+001B is not allowed in text; remove it"),
        (
            "a: 1\nb: x\u2028y\n".encode(),
            "spec.yaml:2:5: not-text: the character U+2028 is not allowed in text; remove it",
        ),
        ("a: \u202eabc\n".encode(), "spec.yaml:1:4: not-text: the character U+202E is not allowed in text; remove it"),
        (
            b"# " + b"x" * (4 * 2**20),
            "spec.yaml:1:1: too-large: the file is larger than 4 MB; one spec covers one manual",
        ),
    ],
    ids=[
        "empty",
        "comment",
        "no-value",
        "binary",
        "utf-16",
        "latin-1",
        "escape",
        "line-separator",
        "right-to-left",
        "large",
    ],
)
def test_file_that_is_no_spec(tmp_path: pathlib.Path, content: bytes, expected: str) -> None:
    document, problems = read(tmp_path, content)
    assert document is None
    assert [problem.splitlines()[0] for problem in problems] == [expected]


@pytest.mark.parametrize(
    "character",
    "\u00ad\u061c\u180e\u200b\u200e\u200f\u202a\u202e\u2060\u2066\u2069\ufeff\U000e0001\U000e0041\U000e0100",
    ids=ascii,
)
@pytest.mark.parametrize("escaped", [False, True], ids=["as it is", "as an escape"])
def test_what_nobody_sees_or_turns_a_text_around_is_refused(
    tmp_path: pathlib.Path, character: str, escaped: bool
) -> None:
    written = f"\\U{ord(character):08X}" if escaped else character
    _, problems = read(tmp_path, f'a: 1\nb: "x{written}y"\n')
    assert [problem.splitlines()[0] for problem in problems] == [
        (
            f"spec.yaml:2:{4 if escaped else 6}: not-text: "
            f"the character U+{ord(character):04X} is not allowed in text; remove {'its escape' if escaped else 'it'}"
        )
    ]


def test_letters_of_other_scripts_are_text(tmp_path: pathlib.Path) -> None:
    text = "Lärm, \u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645, 幅, 𝄞, µm, ½"
    document, problems = read(tmp_path, f'a: "{text}"\n')
    assert problems == []
    assert document is not None
    assert document.data == {"a": text}


def first_lines(report: ProblemReport, folder: pathlib.Path) -> list[str]:
    return [problem.format().splitlines()[0].replace(f"{folder}{os.sep}", "") for problem in report.problems]


def test_paths_that_cannot_be_read(tmp_path: pathlib.Path) -> None:
    (tmp_path / "loop.yaml").symlink_to("loop.yaml")
    (tmp_path / "gone.yaml").symlink_to("nowhere")
    (tmp_path / "folder.yaml").mkdir()
    (tmp_path / "plain.yaml").write_text("a: 1\n")
    os.mkfifo(tmp_path / "pipe.yaml")
    report = ProblemReport()
    for name in (
        "missing.yaml",
        "loop.yaml",
        "gone.yaml",
        "folder.yaml",
        "pipe.yaml",
        "plain.yaml/inside.yaml",
        "zero\0.yaml",
        "x" * 300,
    ):
        assert read_document(tmp_path / name, report) is None
    assert first_lines(report, tmp_path) == [
        "folder.yaml:1:1: unreadable: this is a folder; a spec is a .yaml file",
        "gone.yaml:1:1: unreadable: there is no such file",
        "loop.yaml:1:1: unreadable: the file cannot be read: Too many levels of symbolic links",
        "missing.yaml:1:1: unreadable: there is no such file",
        "pipe.yaml:1:1: unreadable: this is not a regular file; a spec is a .yaml file",
        "plain.yaml/inside.yaml:1:1: unreadable: the file cannot be read: Not a directory",
        f"{'x' * 300}:1:1: unreadable: the file cannot be read: File name too long",
        "zero\\x00.yaml:1:1: unreadable: the file cannot be read: embedded null byte",
    ]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_file_without_permission(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "secret.yaml"
    path.write_text("a: 1\n")
    path.chmod(0)
    report = ProblemReport()
    assert read_document(path, report) is None
    assert first_lines(report, tmp_path) == ["secret.yaml:1:1: unreadable: the file cannot be read: Permission denied"]


def test_error_of_the_disk_is_a_problem(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError(5, "Input/output error")

    path = tmp_path / "spec.yaml"
    path.write_text("a: 1\n")
    report = ProblemReport()
    monkeypatch.setattr("builtins.open", fail)
    document = read_document(path, report)
    monkeypatch.undo()
    assert document is None
    assert first_lines(report, tmp_path) == ["spec.yaml:1:1: unreadable: the file cannot be read: Input/output error"]


def test_folders_are_read_in_order_and_each_file_once(tmp_path: pathlib.Path) -> None:
    for name in ("b/two.yml", "b/one.yaml", "a.yaml", ".hidden/three.yaml", "b/notes.txt"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("device: a\n")
    (tmp_path / "b" / "up").symlink_to(tmp_path)
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "round").symlink_to("round")
    report = ProblemReport()
    documents = read_specs([tmp_path, tmp_path / "a.yaml"], report)
    assert report.problems == ()
    assert [pathlib.Path(document.file).relative_to(tmp_path).as_posix() for document in documents] == [
        "a.yaml",
        "b/one.yaml",
        "b/two.yml",
    ]


def test_folder_without_specs(tmp_path: pathlib.Path) -> None:
    report = ProblemReport()
    assert read_specs([tmp_path], report) == []
    assert [problem.rule for problem in report.problems] == ["no-specs"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "content",
    [
        "a: &a [x,x,x,x,x,x,x,x,x]\n"
        + "".join(f"{b}: &{b} [{','.join(['*' + a] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)),
        "a: " + "[" * 2_000_000,
        "a: " + "{" * 100_000,
        "".join(" " * depth + "a:\n" for depth in range(1000)),
        "a: " + "9" * 3_000_000,
        "a: [" + "1," * 1_000_000 + "]",
    ],
    ids=["aliases", "lists", "maps", "indentation", "digits", "items"],
)
def test_bombs_give_one_problem_soon(tmp_path: pathlib.Path, content: str) -> None:
    start = time.process_time()
    _, problems = read(tmp_path, content)
    assert len(problems) == 1
    assert time.process_time() - start < 5


def test_reader_goes_on_after_a_duplicate_key(tmp_path: pathlib.Path) -> None:
    document, problems = read(tmp_path, "a: 1\na: 2\nb: !x 3\n")
    assert document is not None
    assert document.data == {"a": 1, "b": None}
    assert document.broken == (("b",),)
    assert [problem.splitlines()[0] for problem in problems] == [
        "spec.yaml:2:1: duplicate-key: duplicate key 'a', already on line 1; keep one of them",
        "spec.yaml:3:4: tag: the tag '!x' is not supported; remove it",
    ]
