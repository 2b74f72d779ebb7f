"""Doxygen builds pages of the headers without a warning, so readers in an editor also get all comments."""

from __future__ import annotations

import subprocess
from pathlib import Path

from claims import planted
from tools import tool
from tree import generated_tree

#: Everything has a comment, and Doxygen accepts each. EXTRACT_ALL would hide missing comments.
SETTINGS = """\
INPUT = "{include}"
OUTPUT_DIRECTORY = "{output}"
RECURSIVE = YES
EXTRACT_ALL = NO
WARN_IF_UNDOCUMENTED = YES
EXTRACT_STATIC = YES
OPTIMIZE_OUTPUT_FOR_C = YES
ENABLE_PREPROCESSING = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = CW_NODISCARD= CW_INLINE= CW_CONSTEXPR= CW_CONST=const
JAVADOC_AUTOBRIEF = YES
WARN_NO_PARAMDOC = NO
GENERATE_LATEX = NO
HAVE_DOT = NO
QUIET = YES
"""


def warnings(include: Path, folder: Path) -> list[str]:
    """Return the warnings of Doxygen about these headers."""
    program = tool("doxygen")
    folder.mkdir()
    (folder / "Doxyfile").write_text(SETTINGS.format(include=include, output=folder / "out"), encoding="utf-8")
    completed = subprocess.run([program, "Doxyfile"], cwd=folder, capture_output=True, text=True, timeout=500)
    assert completed.returncode == 0, completed.stderr
    assert (folder / "out" / "html" / "receive_8h.html").is_file()
    return completed.stderr.splitlines()


def test_doxygen_has_no_warning(tmp_path: Path) -> None:
    include = generated_tree(tmp_path) / "c" / "include"
    assert warnings(include, tmp_path / "doxygen") == []


def test_a_warning_would_be_seen(tmp_path: Path) -> None:
    include = generated_tree(tmp_path) / "c" / "include"
    folder = tmp_path / "broken"
    folder.mkdir()
    broken = planted(include, "receive.h", "Bit 0 was received first.", "\\nothing_of_the_kind", folder)
    assert any("nothing_of_the_kind" in line for line in warnings(broken, tmp_path / "doxygen"))
