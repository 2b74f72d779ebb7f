"""Templates: the Jinja templates of a target, and a user's own, which come before them file by file.

A mistake in a template of the user's is told by file and line. A template that has no effect is told as well.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial
from importlib import resources
from pathlib import Path
from typing import get_args

from jinja2 import (
    ChoiceLoader,
    Environment,
    FileSystemBytecodeCache,
    FileSystemLoader,
    PrefixLoader,
    StrictUndefined,
    TemplateNotFound,
    TemplateSyntaxError,
)
from jinja2.bccache import Bucket

from .language.problems import suggestion
from .sandbox import Sandbox
from .say.lines import plain, wrapped

_SUFFIX = ".jinja"
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
#: Before the name of a template: the one that ships with the target, also where the user has one of that name.
_SHIPPED = "shipped"
#: The filters that all targets have.
COMMON_FILTERS: Mapping[str, Callable[..., object]] = {"plain": plain, "wrapped": wrapped}


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
        if not path.resolve().is_relative_to(self.folder.resolve()):
            raise TemplateFault(f"{path.as_posix()}: this leads out of the folder of templates")
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


def our_templates(target: str) -> Path:
    """The folder of the templates that ship with codewheel for a target of ours."""
    return Path(str(resources.files("codewheel.templates"))) / target


@cache
def _own_loader(own: Path) -> _OwnTemplates:
    return _OwnTemplates(own)


@dataclass(frozen=True, eq=False)
class Templates:
    """The templates of a target: the ``*.jinja`` files of a folder, and what they can use.

    A user's template of the same name comes first; in it ``shipped/NAME`` is the one that it stands for. An undefined
    name is an error. A line that holds nothing but a statement leaves nothing behind.

    Attributes:
        folder: Where the files lie; in a package of yours ``Path(__file__).parent / "templates"``.
        values: For each template that is rendered by name, the ``TypedDict`` of its values, each value ``Annotated``
            with a line on it. Only the page of templates is made from this.
        filters: Filters by name, besides those of Jinja, ``plain`` and ``wrapped``. Text from a spec can be anything;
            they make it harmless in the language of the output. The page shows the first lines of their docstrings.
        functions: Functions by name, which every template can call. The page shows them likewise.
        autoescape: Whether values are escaped for XML.
        tests: Classes that templates can ask for, by the name of the test: ``op is zeros_above``. ``tests_for`` names
            them. The page shows the first lines of their docstrings.
    """

    folder: Path
    values: Mapping[str, type] = field(default_factory=dict)
    filters: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    functions: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    autoescape: bool = False
    tests: Mapping[str, type] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """The file names of all templates, sorted."""
        return sorted(path.name for path in self.folder.glob(f"*{_SUFFIX}"))

    def render(self, template: str, values: Mapping[str, object], own: Path | None) -> str:
        """The text that a template makes of these values.

        Args:
            template: Its file name.
            values: Values by name.
            own: The folder of the user's templates for this target: ``Library.own_templates``.

        Raises:
            TemplateFault: A template of the user's is at fault.
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
    """Return the environment in which templates are rendered: a sandbox if a user's templates come before ours."""
    shipped = FileSystemLoader(templates.folder, encoding="utf-8-sig")
    by_name = PrefixLoader({_SHIPPED: shipped})
    # Code that was compiled for one of the two does not serve the other, so that of the sandbox is not kept.
    kind = Environment if own is None else Sandbox
    made = kind(
        loader=shipped if own is None else ChoiceLoader([_own_loader(own), by_name, shipped]),
        bytecode_cache=_compiled() if own is None else None,
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
    """The test for each of these classes, alone or in a union: ``zeros_above`` for a ``ZerosAbove``."""
    found = [item for one in classes for item in get_args(one) or (one,)]
    return {_CAPITAL.sub("_", item.__name__).lower(): item for item in found}


def _is(kind: type, item: object) -> bool:
    return isinstance(item, kind)


def _place(error: Exception, own: Path) -> str:
    """File and line of a fault: in the user's template if it arose there, else in one of ours that uses theirs."""
    if isinstance(error, TemplateSyntaxError):
        return f"{error.filename or error.name}:{error.lineno}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.endswith(_SUFFIX)]
    theirs = [frame for frame in frames if Path(frame.filename).is_relative_to(own)]
    return next((f"{Path(frame.filename).as_posix()}:{frame.lineno}" for frame in reversed(theirs or frames)), "")


def _reason(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"there is no template '{plain(error.name)}'"
    if isinstance(error, UnicodeEncodeError):
        return f"the text holds U+{ord(error.object[error.start]):04X}, which is no character"
    if isinstance(error, MemoryError):
        return "the template takes too much memory"
    module = type(error).__module__
    kind = "" if module.startswith("jinja2") else f"{type(error).__name__}: "
    return f"{kind}{plain(error)}"


def unused_templates(own: Path, rendered: Mapping[str, Templates | None], others: Iterable[str]) -> Iterator[str]:
    """A line for each template of the user's that has no effect; to be asked after rendering.

    Args:
        own: The user's folder, which has a folder for each target.
        rendered: The templates of the targets that were run, by the name of the target.
        others: The names of targets that were not run; nothing is said of their folders.
    """
    ours = {f"{name}/{file}" for name, templates in rendered.items() if templates for file in templates.names}
    found = [path.relative_to(own) for path in sorted(own.rglob(f"*{_SUFFIX}"))]
    visible = [path for path in found if not any(part.startswith(".") for part in path.parts)]
    if not visible:
        example = f"; a template of ours has a path such as {min(ours)} in it" if ours else ""
        yield f"the folder {own.as_posix()} holds no template{example}"
    for path in visible:
        folder, name = path.parts[0], path.as_posix()
        if name in ours or (folder not in rendered and folder in others):
            continue
        if folder not in rendered or Path(*path.parts[1:]).as_posix() not in _own_loader(own / folder).used:
            misplaced = [item for item in ours if item.endswith(f"/{path.name}")]
            hint = f"; did you mean '{misplaced[0]}'?" if len(misplaced) == 1 else suggestion(name, ours)
            yield f"no output uses {(own / path).as_posix()}{hint}"
