"""The script of the decode page is put together from several files, whose functions share one scope."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[2] / "runtime" / "browser"
DECLARED = re.compile(r"^(?:async )?(?:function|const|let|class) +(\w+)", re.MULTILINE)


def test_each_function_has_a_name_of_its_own() -> None:
    """A second function with the name of another one replaces it in silence."""
    names = Counter(
        name for path in SCRIPTS.glob("*.js") for name in DECLARED.findall(path.read_text(encoding="utf-8"))
    )
    assert len(names) > 200
    assert [name for name, count in names.items() if count > 1] == []
