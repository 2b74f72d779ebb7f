"""The Jinja environments in which templates are rendered. A user's templates are code that the user trusts.

Errors in a user's template are reported with file and line.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Hashable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Protocol

from jinja2 import (
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PrefixLoader,
    StrictUndefined,
    TemplateNotFound,
    TemplateSyntaxError,
)

from .compiled_templates import CompiledTemplates
from .say.plain_text import plain, wrapped
from .template_fault import SUFFIX, TemplateFault

#: Filters of all targets.
COMMON_FILTERS: Mapping[str, Callable[..., object]] = {"plain": plain, "wrapped": wrapped}
#: Prefix for template names that selects the target's own template, even if the user overrides it.
_SHIPPED = "shipped"


class Settings(Hashable, Protocol):
    """Settings of an environment, which the templates of a target have, see ``codewheel.render.Templates``."""

    @property
    def folder(self) -> Path: ...
    @property
    def filters(self) -> Mapping[str, Callable[..., object]]: ...
    @property
    def functions(self) -> Mapping[str, Callable[..., object]]: ...
    @property
    def autoescape(self) -> bool: ...
    @property
    def tests(self) -> Mapping[str, type]: ...


class _OwnTemplates(FileSystemLoader):
    """The user's templates in one folder. ``used`` collects the names of those that were read."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, encoding="utf-8-sig")
        self.folder = folder
        self.used: set[str] = set()

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        path = self.folder / template
        try:
            source = super().get_source(environment, template)
        except TemplateNotFound:
            raise
        except UnicodeDecodeError:
            place = f"{path.as_posix()}:{_first_bad_line(path)}"
            raise TemplateFault(f"{place}: not UTF-8; save the template as UTF-8") from None
        except OSError as error:
            raise TemplateFault(f"{path.as_posix()}: cannot read the template: {error.strerror or error}") from None
        self.used.add(template)
        return source


def _first_bad_line(path: Path) -> int:
    content = path.read_bytes()
    try:
        content.decode()
    except UnicodeDecodeError as error:
        return content.count(b"\n", 0, error.start) + 1
    return 1


@cache
def own_loader(own_folder: Path) -> _OwnTemplates:
    return _OwnTemplates(own_folder)


def text_of(templates: Settings, template: str, values: Mapping[str, object], own_folder: Path | None) -> str:
    """Render a template of a target. ``own_folder`` is the folder of the user's templates for it.

    Raises:
        TemplateFault: A user's template has an error.
    """
    try:
        text = environment(templates, own_folder).get_template(template).render(values)
        text.encode()
        return text
    except TemplateFault:
        raise
    except Exception as error:
        if own_folder is None or not own_loader(own_folder).used:
            raise
        raise TemplateFault(
            f"{_place(error, own_folder) or (own_folder / template).as_posix()}: {_reason(error)}"
        ) from None


@cache
def environment(templates: Settings, own_folder: Path | None = None) -> Environment:
    """Return the environment for rendering templates. Those of the user in ``own`` come first."""
    shipped = FileSystemLoader(templates.folder, encoding="utf-8-sig")
    by_name = PrefixLoader({_SHIPPED: shipped})
    new_environment = Environment(
        loader=shipped if own_folder is None else ChoiceLoader([own_loader(own_folder), by_name, shipped]),
        bytecode_cache=CompiledTemplates() if own_folder is None else None,
        undefined=StrictUndefined,
        autoescape=templates.autoescape,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    new_environment.filters |= {**COMMON_FILTERS, **templates.filters}
    tests: dict[str, Callable[..., bool]] = {name: partial(_is, kind) for name, kind in templates.tests.items()}
    new_environment.tests.update(tests)
    new_environment.globals |= templates.functions
    return new_environment


def _is(kind: type, value: object) -> bool:
    return isinstance(value, kind)


def _place(error: Exception, own_folder: Path) -> str:
    """Return file and line of an error, either in the user's template or in one of ours that includes it."""
    if isinstance(error, TemplateSyntaxError):
        return f"{error.filename or error.name}:{error.lineno}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.endswith(SUFFIX)]
    theirs = [frame for frame in frames if Path(frame.filename).is_relative_to(own_folder)]
    return next((f"{Path(frame.filename).as_posix()}:{frame.lineno}" for frame in reversed(theirs or frames)), "")


def _reason(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"there is no template '{plain(error.name)}'"
    if isinstance(error, UnicodeEncodeError):
        return f"the text contains U+{ord(error.object[error.start]):04X}, which is not a character"
    module = type(error).__module__
    kind = "" if module.startswith("jinja2") else f"{type(error).__name__}: "
    return f"{kind}{plain(error)}"
