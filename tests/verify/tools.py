"""Tools of the evidence. If a tool is missing or cannot do its job, its test is skipped with a message that says so."""

from __future__ import annotations

from collections.abc import Sequence

from working_tools import require


def tool(name: str, folders: Sequence[str] = (), options: Sequence[str] = ()) -> str:
    """Return the path of a tool that works with these options.

    Otherwise, skip the test, or fail it with ``CODEWHEEL_REQUIRE_TOOLS=1``.
    """
    return require([name, *options], folders)
