"""Check the names of targets and families in the user's settings against the targets and specs that exist."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ..loading.configuration import Configuration
from .terminal import problems

if TYPE_CHECKING:
    from ..language.document import Path as Place
    from ..language.problems import Report


def refuse_unknown_targets(settings: Configuration | None) -> None:
    """Check that the targets in the settings exist, without loading them.

    Raises:
        Stop: There is no such target. The exit code is 1.
    """
    if settings is None or not (settings.targets or settings.only):
        return
    from ..targets.registry import target_names

    known_names = target_names()
    places: list[tuple[str, Place]] = [(name, ("targets", index)) for index, name in enumerate(settings.targets)]
    places += [(name, ("only", name)) for name in settings.only]
    unknown_places = [(name, place) for name, place in places if name not in known_names]
    if unknown_places:
        raise problems(_unknown_targets(settings.file, unknown_places, known_names))


def _unknown_targets(file: Path, places: Iterable[tuple[str, Place]], known_names: Iterable[str]) -> Report:
    from ..language.problems import Report, suggestion
    from ..loading.configuration_file import add_error

    report = Report()
    for name, place in places:
        message = f"there is no target '{name}'{suggestion(name, known_names, 'there are')}"
        add_error(report, file, place, "undefined-reference", message, at_key=place[0] == "only")
    return report


def report_unknown_families(settings: Configuration | None, family_names: Iterable[str], report: Report) -> None:
    """Report families in the settings that none of the specs describes.

    Args:
        settings: The settings.
        family_names: Names of the families that were read from all specs of the settings.
        report: The report on these specs, to which the errors are added.
    """
    if settings is None or not settings.only:
        return
    from ..language.problems import suggestion
    from ..loading.configuration_file import add_error

    # A spec with problems may have no family yet. Its name is that of its file.
    spec_names = [Path(file).stem for file in report.files] if report else []
    known_names = list(family_names)
    for target, family_filter in settings.only.items():
        for index, name in enumerate(family_filter.families):
            if name not in known_names and name not in spec_names:
                message = f"there is no family '{name}' among the specs{suggestion(name, known_names, 'there are')}"
                place = ("only", target, "families", index)
                add_error(report, settings.file, place, "undefined-reference", message)
