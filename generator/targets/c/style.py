"""How headers write what is said: as running text, but for errata, which a header tells once, at its end."""

from __future__ import annotations

from ...say.text import BY_TITLE, Said, Style


class InHeader(Style):
    """An erratum stands where it bites by its name, and with what is used where wrong bytes could be sent."""

    def sentence(self, item: Said) -> str:
        if item.brief is None:
            return super().sentence(item)
        label = self.text(item.label)
        return f"{label}: {item.brief}" if item.brief else f"{label}."


S = InHeader(text=BY_TITLE.text, code=BY_TITLE.code, ref=BY_TITLE.ref)
