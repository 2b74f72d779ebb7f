"""The style of comments in headers: running text, with each erratum explained once, at the end of the header."""

from __future__ import annotations

from ...say.text import BY_TITLE, Statement, Style


class InHeader(Style):
    """A style that mentions an erratum where it matters, with the value used if wrong bytes could be sent."""

    def sentence(self, statement: Statement) -> str:
        if statement.brief is None:
            return super().sentence(statement)
        label = self.text(statement.label)
        return f"{label}: {statement.brief}" if statement.brief else f"{label}."


S = InHeader(text=BY_TITLE.text, code=BY_TITLE.code, ref=BY_TITLE.ref)
