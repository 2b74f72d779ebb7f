"""The error that is in a user's template, and the end of the names of templates."""

from __future__ import annotations

SUFFIX = ".jinja"


class TemplateFault(ValueError):
    """An error in a user's template. The message gives the location and the reason in one line."""
