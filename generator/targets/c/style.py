"""The style of comments in headers: running text, with each erratum explained once, at the end of the header."""

from __future__ import annotations

from ...say.text import BY_TITLE, Said, Style


class InHeader(Style):
    """A style that mentions an erratum where it matters, with the value used if wrong bytes could be sent."""

    def sentence(self, item: Said) -> str:
        if item.brief is None:
            return super().sentence(item)
        label = self.text(item.label)
        return f"{label}: {item.brief}" if item.brief else f"{label}."


S = InHeader(text=BY_TITLE.text, code=BY_TITLE.code, ref=BY_TITLE.ref)
