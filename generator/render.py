"""Render the Jinja templates of a target. A user's template can override each of them.

Templates without effect are reported. Jinja is loaded when the first template is rendered, because commands that only
look for problems load the targets too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import get_args

from .language.problems import TEMPLATE_SUFFIX, suggest_word

_WORD_BOUNDARY = re.compile(r"(?<=[a-z])(?=[A-Z])")


def our_templates(target: str) -> Path:
    """Return the folder of the shipped templates for a built-in target."""
    return Path(str(resources.files("codewheel.templates"))) / target


@dataclass(frozen=True, eq=False)
class Templates:
    """The templates of a target: the ``*.jinja`` files in a folder, and their values, filters, functions and tests.

    A user's template of the same name overrides one of these, and can include it as ``shipped/NAME``. Undefined names
    are errors. A line with only a statement produces no output.

    Attributes:
        folder: Folder of the files. In your own package, this is ``Path(__file__).parent / "templates"``.
        values: For each template that is rendered by name, the ``TypedDict`` of its values, each value ``Annotated``
            with a one-line description. This is used only for the page about templates.
        filters: Filters by name, in addition to ``plain``, ``wrapped`` and Jinja's own. Text from a spec can contain
            any characters, and a filter escapes them for the language of the output. The page shows the first lines of
            their docstrings.
        functions: Functions by name, which every template can call. The page shows them in the same way.
        autoescape: True if values are escaped for XML.
        tests: Classes that templates can test for, by the name of the test: ``op is zeros_above``. ``tests_for`` builds
            this mapping. The page shows the first lines of their docstrings.
    """

    folder: Path
    values: Mapping[str, type] = field(default_factory=dict)
    filters: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    functions: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    autoescape: bool = False
    tests: Mapping[str, type] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """Return the file names of all templates, sorted."""
        return sorted(path.name for path in self.folder.glob(f"*{TEMPLATE_SUFFIX}"))

    def render(self, template: str, values: Mapping[str, object], own_folder: Path | None) -> str:
        """Render a template with these values.

        Args:
            template: File name of the template.
            values: Values by name.
            own_folder: Folder of the user's templates for this target, ``Library.own_templates``.

        Raises:
            TemplateFault: A user's template has an error.
        """
        from .environments import render_template

        return render_template(self, template, values, own_folder)


def tests_for(*classes: object) -> dict[str, type]:
    """Return a test for each of these classes and members of unions, such as ``zeros_above`` for ``ZerosAbove``."""
    class_by_test: dict[str, type] = {}
    for class_or_union in classes:
        for tested_class in get_args(class_or_union) or (class_or_union,):
            # "ZerosAbove" becomes "Zeros_Above".
            words_with_underscores = _WORD_BOUNDARY.sub("_", tested_class.__name__)
            class_by_test[words_with_underscores.lower()] = tested_class
    return class_by_test


def _similar_template(path: Path, shipped_paths: Iterable[str]) -> str:
    """Return a hint at the only shipped template of this file name, or else at the most similar path, or ""."""
    paths_with_name = [shipped for shipped in shipped_paths if shipped.endswith(f"/{path.name}")]
    if len(paths_with_name) == 1:
        return f"; did you mean '{paths_with_name[0]}'?"
    return suggest_word(path.as_posix(), shipped_paths)


def unused_templates(
    own_folder: Path, templates_by_target: Mapping[str, Templates | None], other_targets: Iterable[str]
) -> Iterator[str]:
    """Yield a line for each of the user's templates that had no effect, or one line if there are no templates.

    Call it after rendering. A template has an effect if it overrides a shipped template, or if another template
    includes it. Hidden files do not count.

    Args:
        own_folder: The user's folder, which has a folder for each target.
        templates_by_target: The templates of the targets that ran, keyed by the name of the target.
        other_targets: The names of targets that did not run, whose folders are ignored.
    """
    from .environments import own_loader

    shipped_paths: set[str] = set()
    for target_name, templates in templates_by_target.items():
        template_names = templates.names if templates else ()
        shipped_paths |= {f"{target_name}/{path_text}" for path_text in template_names}
    own_paths = [path.relative_to(own_folder) for path in sorted(own_folder.rglob(f"*{TEMPLATE_SUFFIX}"))]
    visible_paths = [path for path in own_paths if "/." not in f"/{path.as_posix()}"]
    if not visible_paths:
        example = f"; the path of a template in it looks like {min(shipped_paths)}" if shipped_paths else ""
        yield f"the folder {own_folder.as_posix()} has no templates{example}"
    for path in visible_paths:
        target_name = path.parts[0]
        path_text = path.as_posix()
        is_of_other_target = target_name not in templates_by_target and target_name in other_targets
        if path_text in shipped_paths or is_of_other_target:
            continue
        # Its path in the folder of the target, by which another template includes it.
        path_in_target = Path(*path.parts[1:]).as_posix()
        is_included = target_name in templates_by_target and path_in_target in own_loader(own_folder / target_name).used
        if is_included:
            continue
        yield f"no output uses {(own_folder / path).as_posix()}{_similar_template(path, shipped_paths)}"
