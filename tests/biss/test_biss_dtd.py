"""``generate --biss-dtd``: the idbiss file against a document type of the user's own."""

from __future__ import annotations

import time
from importlib import resources
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.targets import Library
from codewheel.targets.biss.files import DtdError, generate, validation_errors

# Document types do not depend on wording or rules.
pytestmark = pytest.mark.slow

NAME = "biss/idbiss4C69.xml"


@pytest.fixture(scope="module")
def ours() -> bytes:
    return (resources.files("codewheel.language") / "idbiss.reconstructed.dtd").read_bytes()


@pytest.fixture(scope="module")
def document(library: Library) -> str:
    return generate(library)[NAME]


def check(document: str, dtd: bytes) -> list[str]:
    return validation_errors(document, "out/idbiss.xml", dtd, "mine/idbiss.dtd")


def test_our_own_document_type_is_content(document: str, ours: bytes) -> None:
    assert check(document, ours) == []


def test_faults_come_with_file_and_line(document: str, ours: bytes) -> None:
    assert b"Label Pos CDATA #REQUIRED" in ours
    problems = check(
        document, ours.replace(b"Label Pos CDATA #REQUIRED", b"Label Pos CDATA #REQUIRED Language CDATA #REQUIRED")
    )
    lines = [number for number, line in enumerate(document.splitlines(), 1) if "<Label" in line]
    assert [problem.partition(": ")[0] for problem in problems] == [f"out/idbiss.xml:{line}" for line in lines]
    assert all("Language" in problem for problem in problems)


def test_another_wrapper_is_seen(document: str, ours: bytes) -> None:
    (problem,) = check(document, ours.replace(b"<!ELEMENT Profile (Device+)>", b"<!ELEMENT Profile (Manufacturer+)>"))
    assert "Profile" in problem
    assert "Manufacturer" in problem


@pytest.mark.parametrize("target", ["file:///etc/passwd", "http://127.0.0.1:9/x.dtd", "other.dtd"])
def test_nothing_else_is_read(document: str, ours: bytes, target: str) -> None:
    with pytest.raises(DtdError, match="Other files and the network are not read"):
        check(document, f'<!ENTITY % more SYSTEM "{target}">\n%more;\n'.encode() + ours)


def test_a_broken_document_type_is_told_with_its_line(document: str, ours: bytes) -> None:
    lines = ours.splitlines()
    broken = next(number for number, line in enumerate(lines, 1) if line.startswith(b"<!ELEMENT CrcPoly"))
    with pytest.raises(DtdError, match=rf"^mine/idbiss.dtd:{broken}: "):
        check(document, ours.replace(b"<!ELEMENT CrcPoly (#PCDATA)>", b"<!ELEMENT CrcPoly (#PCDATA>"))


def test_entities_that_grow_are_refused(document: str, ours: bytes) -> None:
    levels = b"".join(b'<!ENTITY %% a%d "%s">\n' % (level, b"%%a%d;" % (level - 1) * 10) for level in range(1, 12))
    before = time.process_time()
    with pytest.raises(DtdError):
        check(document, b"<!ENTITY % a0 \"<!ENTITY b 'x'>\">\n" + levels + b"%a11;\n" + ours)
    assert time.process_time() - before < 5


@pytest.mark.parametrize("text", [b"", b"\x00\xff\x80", b"<a/>", b"<!ELEMENT"])
def test_what_is_no_document_type(document: str, text: bytes) -> None:
    try:
        assert check(document, text) != []
    except DtdError as error:
        assert str(error).startswith("mine/idbiss.dtd")


def test_the_command(tmp_path: Path, ours: bytes, capsys: pytest.CaptureFixture[str]) -> None:
    valid_dtd, strict = tmp_path / "good.dtd", tmp_path / "strict.dtd"
    valid_dtd.write_bytes(ours)
    strict.write_bytes(ours.replace(b'Version CDATA #FIXED "1.0"', b'Version CDATA #FIXED "2.0"'))
    out = ["generate", "-o", str(tmp_path / "out"), "--target", "biss", "--biss-dtd"]
    assert main([*out, str(valid_dtd)]) == 0
    assert f"valid against {valid_dtd}: {tmp_path / 'out' / NAME}" in capsys.readouterr().out
    assert main([*out, str(strict)]) == 1
    error = capsys.readouterr().err
    written = (tmp_path / "out" / NAME).read_text(encoding="ascii").splitlines()
    line = next(number for number, text in enumerate(written, 1) if "<BiSS-Identifier" in text)
    assert f"{tmp_path / 'out' / NAME}:{line}: " in error
    assert "Traceback" not in error
    assert main([*out, str(tmp_path / "none.dtd")]) == 2
    assert main(["generate", "-o", str(tmp_path / "out"), "--target", "docs", "--biss-dtd", str(valid_dtd)]) == 2
    (tmp_path / "large.dtd").write_bytes(b" " * 1_000_001)
    assert main([*out, str(tmp_path / "large.dtd")]) == 2
    assert "Is this the right file" in capsys.readouterr().err
