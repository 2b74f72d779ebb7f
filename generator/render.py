"""Templates: one Jinja environment per output language, set up so that text from a spec cannot become anything but text.

Templates hold text and loops. A user's own template folder comes before ours, file by file; what is wrong with a template of
theirs is said by file and line.
"""

from __future__ import annotations

import re
import textwrap
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, FileSystemBytecodeCache, FileSystemLoader, PackageLoader, StrictUndefined
from jinja2 import TemplateNotFound, TemplateSyntaxError
from jinja2.bccache import Bucket

from .problems import suggestion

#: The folders of templates.
FOLDERS = ("biss", "c", "markdown", "python")
_SUFFIX = ".jinja"

_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]+")


def plain(text: object) -> str:
    """One line of text: control characters, line ends and direction marks become spaces."""
    return _CONTROL.sub(" ", str(text)).strip()


def wrapped(text: object, width: int, prefix: str = "", first: str | None = None) -> str:
    """``text`` as a paragraph of at most ``width`` columns, every line after ``prefix`` (the first after ``first``)."""
    lead = prefix if first is None else first
    return textwrap.fill(
        plain(text), width=width, initial_indent=lead, subsequent_indent=prefix, break_long_words=False, break_on_hyphens=False
    )


class TemplateFault(ValueError):
    """A template of the user's is at fault; the message says where and how, in one line."""


class _Compiled(FileSystemBytecodeCache):
    """Compiled templates of earlier runs, in a folder of the user's own; compiling them is a third of a run.

    It is a convenience: where the disk is full or the cache spoilt, templates are compiled anew.
    """

    def load_bytecode(self, bucket: Bucket) -> None:
        try:
            super().load_bytecode(bucket)
        except Exception:  # Whatever a spoilt file makes of unpickling.
            bucket.reset()

    def dump_bytecode(self, bucket: Bucket) -> None:
        with suppress(OSError):
            super().dump_bytecode(bucket)


def _compiled() -> FileSystemBytecodeCache | None:
    try:
        return _Compiled()
    except (RuntimeError, OSError):
        return None  # There is no such folder here, or it belongs to somebody else.


class _OwnTemplates(FileSystemLoader):
    """The user's templates of one folder; ``used`` names those that were read."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, encoding="utf-8-sig")
        self.folder = folder
        self.used: set[str] = set()

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        path = self.folder / template
        try:
            found = super().get_source(environment, template)
        except TemplateNotFound:
            raise
        except UnicodeDecodeError:
            place = f"{path.as_posix()}:{_first_bad_line(path)}"
            raise TemplateFault(f"{place}: this is not UTF-8; save the template as UTF-8") from None
        except OSError as error:
            raise TemplateFault(f"{path.as_posix()}: the template cannot be read: {error.strerror or error}") from None
        self.used.add(template)
        return found


def _first_bad_line(path: Path) -> int:
    content = path.read_bytes()
    try:
        content.decode()
    except UnicodeDecodeError as error:
        return content.count(b"\n", 0, error.start) + 1
    return 1


@lru_cache(maxsize=None)
def _own_loader(folder: str, own_templates: Path) -> _OwnTemplates:
    return _OwnTemplates(own_templates / folder)


@lru_cache(maxsize=None)
def environment(folder: str, own_templates: Path | None = None) -> Environment:
    """The environment for the templates in ``folder``, one of ``FOLDERS``."""
    ours = PackageLoader("codewheel.templates", folder)
    made = Environment(
        loader=ours if own_templates is None else ChoiceLoader([_own_loader(folder, own_templates), ours]),
        bytecode_cache=_compiled(),
        undefined=StrictUndefined,
        autoescape=folder == "biss",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["plain"] = plain
    made.filters["wrapped"] = wrapped
    return made


def render(folder: str, template: str, values: Mapping[str, Any], filters: Mapping[str, Callable[..., Any]] | None = None, own_templates: Path | None = None) -> str:
    """The text that ``template`` of ``folder`` makes of ``values``.

    Raises:
        TemplateFault: A template of the user's is at fault.
    """
    made = environment(folder, own_templates)
    if filters:
        made.filters.update(filters)
    try:
        return made.get_template(template).render(values)
    except TemplateFault:
        raise
    except Exception as error:
        if own_templates is None or not _own_loader(folder, own_templates).used:
            raise
        raise TemplateFault(f"{_place(error, own_templates / folder) or template}: {_reason(error)}") from None


def _place(error: Exception, own: Path) -> str:
    """File and line of a fault: in a template of the user's if it came about there, else in one of ours that uses theirs."""
    if isinstance(error, TemplateSyntaxError):
        return f"{error.filename or error.name}:{error.lineno}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.endswith(_SUFFIX)]
    theirs = [frame for frame in frames if Path(frame.filename).is_relative_to(own)]
    return next((f"{Path(frame.filename).as_posix()}:{frame.lineno}" for frame in reversed(theirs or frames)), "")


def _reason(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"there is no template '{plain(error.name)}'"
    module = type(error).__module__
    kind = "" if module.startswith("jinja2") else f"{type(error).__name__}: "
    return f"{kind}{plain(error)}"


def unused_templates(own: Path, folders: Iterable[str]) -> Iterator[str]:
    """A line for each template of the user's that has no effect, being misspelt or misplaced; to be asked after rendering.

    Args:
        own: The user's folder.
        folders: The folders of templates that were rendered; nothing is said of the others.
    """
    templates = resources.files("codewheel.templates")
    names = (f"{folder}/{item.name}" for folder in FOLDERS for item in (templates / folder).iterdir())
    ours = {name for name in names if name.endswith(_SUFFIX)}
    rendered = set(folders)
    found = [path.relative_to(own) for path in sorted(own.rglob(f"*{_SUFFIX}"))]
    visible = [path for path in found if not any(part.startswith(".") for part in path.parts)]
    if not visible:
        yield f"the folder {own.as_posix()} holds no template; a template of ours has a path such as {min(ours)} in it"
    for path in visible:
        folder, name = path.parts[0], path.as_posix()
        if name in ours or (folder in FOLDERS and folder not in rendered):
            continue
        if folder not in FOLDERS or Path(*path.parts[1:]).as_posix() not in _own_loader(folder, own).used:
            misplaced = [item for item in ours if item.endswith(f"/{path.name}")] if len(path.parts) == 1 else []
            hint = f"; did you mean '{misplaced[0]}'?" if len(misplaced) == 1 else suggestion(name, ours)
            yield f"no output uses {(own / path).as_posix()}{hint}"
