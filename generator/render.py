"""Render the Jinja templates of a target. A user's template can override each of them.

Errors in a user's template are reported with file and line. Templates without effect are reported too.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, partial
from importlib import resources
from pathlib import Path
from typing import get_args

from jinja2 import (
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PrefixLoader,
    StrictUndefined,
    TemplateNotFound,
    TemplateSyntaxError,
)

from .compiled import CompiledTemplates
from .language.problems import suggestion
from .sandbox import Sandbox
from .say.lines import plain, wrapped

_SUFFIX = ".jinja"
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
#: Prefix for template names that selects the target's own template, even if the user overrides it.
_SHIPPED = "shipped"
#: Filters of all targets.
COMMON_FILTERS: Mapping[str, Callable[..., object]] = {"plain": plain, "wrapped": wrapped}


class TemplateFault(ValueError):
    """An error in a user's template. The message gives the location and the reason in one line."""


class _OwnTemplates(FileSystemLoader):
    """The user's templates in one folder. ``used`` collects the names of those that were read."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, encoding="utf-8-sig")
        self.folder = folder
        self.used: set[str] = set()

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        path = self.folder / template
        if not path.resolve().is_relative_to(self.folder.resolve()):
            raise TemplateFault(f"{path.as_posix()}: this path is outside the folder of templates")
        try:
            found = super().get_source(environment, template)
        except TemplateNotFound:
            raise
        except UnicodeDecodeError:
            place = f"{path.as_posix()}:{_first_bad_line(path)}"
            raise TemplateFault(f"{place}: not UTF-8; save the template as UTF-8") from None
        except OSError as error:
            raise TemplateFault(f"{path.as_posix()}: cannot read the template: {error.strerror or error}") from None
        self.used.add(template)
        return found


def _first_bad_line(path: Path) -> int:
    content = path.read_bytes()
    try:
        content.decode()
    except UnicodeDecodeError as error:
        return content.count(b"\n", 0, error.start) + 1
    return 1


def our_templates(target: str) -> Path:
    """Return the folder of the shipped templates for a built-in target."""
    return Path(str(resources.files("codewheel.templates"))) / target


@cache
def _own_loader(own: Path) -> _OwnTemplates:
    return _OwnTemplates(own)


@dataclass(frozen=True, eq=False)
class Templates:
    """The templates of a target: the ``*.jinja`` files in a folder, and their values, filters, functions and tests.

    A user's template of the same name overrides one of these, and can include it as ``shipped/NAME``. Undefined names
    are errors. A line that has only a statement produces no output.

    Attributes:
        folder: Folder of the files. In your own package, this is ``Path(__file__).parent / "templates"``.
        values: For each template that is rendered by name, the ``TypedDict`` of its values, each value ``Annotated``
            with a one-line description. This is used only for the page about templates.
        filters: Filters by name, in addition to ``plain``, ``wrapped`` and Jinja's own. Text from a spec can be
            anything, and filters make it harmless in the output's language. The page shows their docstrings' first
            lines.
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
        return sorted(path.name for path in self.folder.glob(f"*{_SUFFIX}"))

    def render(self, template: str, values: Mapping[str, object], own: Path | None) -> str:
        """Render a template with these values.

        Args:
            template: File name of the template.
            values: Values by name.
            own: Folder of the user's templates for this target, ``Library.own_templates``.

        Raises:
            TemplateFault: A user's template has an error.
        """
        try:
            made = environment(self, own)
            if isinstance(made, Sandbox):
                text = made.text_of(template, values)
            else:
                text = made.get_template(template).render(values)
            text.encode()
            return text
        except TemplateFault:
            raise
        except Exception as error:
            if own is None or not _own_loader(own).used:
                raise
            raise TemplateFault(f"{_place(error, own) or (own / template).as_posix()}: {_reason(error)}") from None


@cache
def environment(templates: Templates, own: Path | None = None) -> Environment:
    """Return the environment for rendering templates. It is a sandbox if the user has templates."""
    shipped = FileSystemLoader(templates.folder, encoding="utf-8-sig")
    by_name = PrefixLoader({_SHIPPED: shipped})
    # The two environments compile templates differently, so code for the sandbox is not cached.
    kind = Environment if own is None else Sandbox
    made = kind(
        loader=shipped if own is None else ChoiceLoader([_own_loader(own), by_name, shipped]),
        bytecode_cache=CompiledTemplates() if own is None else None,
        undefined=StrictUndefined,
        autoescape=templates.autoescape,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {**COMMON_FILTERS, **templates.filters}
    tests: dict[str, Callable[..., bool]] = {name: partial(_is, kind) for name, kind in templates.tests.items()}
    made.tests.update(tests)
    made.globals |= templates.functions
    if isinstance(made, Sandbox):
        made.finish({*COMMON_FILTERS, *templates.filters})
    return made


def tests_for(*classes: object) -> dict[str, type]:
    """Return a test for each of these classes and members of unions, such as ``zeros_above`` for ``ZerosAbove``."""
    found = [item for one in classes for item in get_args(one) or (one,)]
    return {_CAPITAL.sub("_", item.__name__).lower(): item for item in found}


def _is(kind: type, item: object) -> bool:
    return isinstance(item, kind)


def _place(error: Exception, own: Path) -> str:
    """Return file and line of an error, either in the user's template or in one of ours that includes it."""
    if isinstance(error, TemplateSyntaxError):
        return f"{error.filename or error.name}:{error.lineno}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.endswith(_SUFFIX)]
    theirs = [frame for frame in frames if Path(frame.filename).is_relative_to(own)]
    return next((f"{Path(frame.filename).as_posix()}:{frame.lineno}" for frame in reversed(theirs or frames)), "")


def _reason(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"there is no template '{plain(error.name)}'"
    if isinstance(error, UnicodeEncodeError):
        return f"the text contains U+{ord(error.object[error.start]):04X}, which is not a character"
    if isinstance(error, MemoryError):
        return "the template uses too much memory"
    module = type(error).__module__
    kind = "" if module.startswith("jinja2") else f"{type(error).__name__}: "
    return f"{kind}{plain(error)}"


def unused_templates(own: Path, rendered: Mapping[str, Templates | None], others: Iterable[str]) -> Iterator[str]:
    """Yield a line for each of the user's templates that had no effect. Call this after rendering.

    Args:
        own: The user's folder, which has a folder for each target.
        rendered: The templates of the targets that ran, keyed by the name of the target.
        others: The names of targets that did not run, whose folders are ignored.
    """
    ours = {f"{name}/{file}" for name, templates in rendered.items() if templates for file in templates.names}
    found = [path.relative_to(own) for path in sorted(own.rglob(f"*{_SUFFIX}"))]
    visible = [path for path in found if not any(part.startswith(".") for part in path.parts)]
    if not visible:
        example = f"; the path of a template in it looks like {min(ours)}" if ours else ""
        yield f"the folder {own.as_posix()} has no templates{example}"
    for path in visible:
        folder, name = path.parts[0], path.as_posix()
        if name in ours or (folder not in rendered and folder in others):
            continue
        if folder not in rendered or Path(*path.parts[1:]).as_posix() not in _own_loader(own / folder).used:
            misplaced = [item for item in ours if item.endswith(f"/{path.name}")]
            hint = f"; did you mean '{misplaced[0]}'?" if len(misplaced) == 1 else suggestion(name, ours)
            yield f"no output uses {(own / path).as_posix()}{hint}"
