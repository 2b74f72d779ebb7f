"""Page of the changes in each version of a family that concern its users."""

from __future__ import annotations

from typing import Annotated, Any, TypedDict

from ...model import Device, Release, ReleasedChange
from ...say.markdown import code, text
from ...say.text import counted

_VERSION_RULE = (
    "Versions follow semantic versioning: major for changes that break code or alter its behaviour, minor for "
    "additions, patch for documentation. Before 1.0.0, the minor number marks breaking changes and the patch number "
    "all others. The version applies to the whole package. Versions without changes to this family are not listed."
)
_TITLES_BY_IMPACT = {
    "breaking": "Breaking",
    "behaviour": "Behaviour",
    "compatible": "Compatible",
    "documentation": "Documentation",
}
#: Highest number of documentation changes that are listed. If there are more, they are only counted.
_MOST_DOCUMENTATION_CHANGES = 10


class ChangesPage(TypedDict):
    device: Annotated[Device, "the family"]
    version: Annotated[str, "the version of the package"]
    manual: Annotated[str, "revision and date of the manual"]
    rule: Annotated[str, "rule that derives versions from changes"]
    releases: Annotated[
        list[dict[str, Any]], "the versions, the newest first: version, about, parts with title and lines"
    ]


def file_name(device: Device) -> str:
    """Return the file name of the page."""
    return f"{device.name}-changes.md"


def page_values(device: Device) -> ChangesPage:
    manual = device.manual
    return {
        "device": device,
        "version": device.manufacturer.version,
        "manual": text(manual.revision) + (f" of {manual.date}" if manual.date else ""),
        "rule": _VERSION_RULE,
        "releases": [_release_section(release) for release in device.releases],
    }


def _release_section(release: Release) -> dict[str, Any]:
    parts: list[dict[str, Any]] = []
    for impact, title in _TITLES_BY_IMPACT.items():
        impact_changes = [change for change in release.changes if change.impact == impact]
        lines = [_change_line(change) for change in impact_changes]
        if impact == "documentation" and len(lines) > _MOST_DOCUMENTATION_CHANGES:
            lines = [f"{counted(len(lines), 'change')} to wording, sources, errata and examples"]
        if lines:
            parts.append({"title": title, "lines": lines})
    about = f"Changes since {release.since}, with revision {release.manual} of the manual."
    return {"version": text(release.version), "about": about, "parts": parts}


def _change_line(change: ReleasedChange) -> str:
    about = "; ".join(filter(None, (change.reach, change.outputs)))
    return f"{text(change.text)} ({code(change.rule)}): {text(about)}"
