"""Check the names of targets in the user's settings, which only the registry of targets knows."""

from __future__ import annotations

from ..loading.configuration import Configuration
from .terminal import problems


def refuse_unknown_targets(settings: Configuration | None) -> None:
    """Check that the targets in the settings exist, without loading them.

    Raises:
        Stop: There is no such target. The exit code is 1.
    """
    if settings is None or not settings.targets:
        return
    from ..targets.registry import target_names

    known_names = target_names()
    for index, name in enumerate(settings.targets):
        if name not in known_names:
            from ..language.problems import suggestion
            from ..loading.configuration_file import error_at

            message = f"there is no target '{name}'{suggestion(name, known_names, 'there are')}"
            raise problems(error_at(settings.file, ("targets", index), "undefined-reference", message))
