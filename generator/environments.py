"""Jinja environments for the templates of targets, with stored compiled templates.

Compiled templates are stored like Python's compiled modules, in ``__pycache__`` next to the source. As with modules,
``PYTHONPYCACHEPREFIX`` selects another folder, and ``PYTHONDONTWRITEBYTECODE`` disables writing. If the folder is not
writable, nothing is stored.

The user's cache and folders for temporary files are not used, because compiled code must not come from another user.
Anyone who can write to ``__pycache__`` could change the modules of this tool as well.

Errors in a user's template are reported with file and line.
"""

from __future__ import annotations

import hashlib
import marshal
import os
import sys
import traceback
from collections.abc import Callable, Hashable, Mapping
from contextlib import suppress
from functools import cache, partial
from importlib.util import MAGIC_NUMBER, cache_from_source
from pathlib import Path
from types import CodeType
from typing import Protocol

import jinja2
from jinja2 import (
    BaseLoader,
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PrefixLoader,
    StrictUndefined,
    TemplateNotFound,
    TemplateSyntaxError,
)
from jinja2.bccache import Bucket, BytecodeCache

from .language.problems import TEMPLATE_SUFFIX, TemplateFault
from .say import text_on_one_line, wrap_text


class CompiledTemplates(BytecodeCache):
    """Compiled templates of an environment."""

    def get_cache_key(self, name: str, filename: str | None = None) -> str:
        """Return the path of the compiled template, or an empty string if it has none."""
        with suppress(NotImplementedError):  # This interpreter keeps no compiled files.
            return cache_from_source(filename, optimization="") if filename is not None else ""
        return ""

    def load_bytecode(self, bucket: Bucket) -> None:
        """Read the code of a template, unless it is damaged or was compiled from other text or by another version."""
        expected_head = _head(bucket)
        with suppress(OSError, EOFError, ValueError, TypeError):
            with open(bucket.key, "rb") as file:
                content = file.read()
            if content.startswith(expected_head):
                template_code = marshal.loads(content[len(expected_head) :])
                bucket.code = template_code if isinstance(template_code, CodeType) else None

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Write the code of a template atomically, so that no process reads part of it. Errors are ignored."""
        if sys.dont_write_bytecode or not bucket.key or bucket.code is None:
            return
        unfinished_path = f"{bucket.key}.{os.getpid()}"
        with suppress(OSError):
            os.makedirs(os.path.dirname(bucket.key), exist_ok=True)
            with open(unfinished_path, "xb") as file:
                file.write(_head(bucket) + marshal.dumps(bucket.code))
            os.replace(unfinished_path, bucket.key)


def _head(bucket: Bucket) -> bytes:
    """Return the first bytes of a compiled template: the versions, the options and the text that it is made from."""
    environment = bucket.environment
    options = (
        environment.autoescape,
        environment.trim_blocks,
        environment.lstrip_blocks,
        environment.keep_trailing_newline,
    )
    inputs_text = f"{jinja2.__version__} {sys.version} {options} {bucket.checksum}"
    return MAGIC_NUMBER + hashlib.sha256(inputs_text.encode()).digest()


#: Filters of all targets.
COMMON_FILTERS: Mapping[str, Callable[..., object]] = {"plain": text_on_one_line, "wrapped": wrap_text}
#: Prefix for template names that selects the target's own template, even if the user overrides it.
_SHIPPED_PREFIX = "shipped"


class TemplateSettings(Hashable, Protocol):
    """Settings of an environment for the templates of a target, see ``codewheel.render.Templates``."""

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
        """Return what Jinja needs: the text of a template, its path, and a function that is true while it is current.

        Raises:
            TemplateNotFound: The user has no such template, so that Jinja tries the next folder.
            TemplateFault: The template cannot be read, or is not UTF-8.
        """
        path = self.folder / template
        try:
            text_path_and_check = super().get_source(environment, template)
        except TemplateNotFound:
            raise
        except UnicodeDecodeError:
            file_and_line = f"{path.as_posix()}:{_first_bad_line(path)}"
            raise TemplateFault(f"{file_and_line}: not UTF-8; save the template as UTF-8") from None
        except OSError as error:
            raise TemplateFault(f"{path.as_posix()}: cannot read the template: {error.strerror or error}") from None
        self.used.add(template)
        return text_path_and_check


def _first_bad_line(path: Path) -> int:
    """Return the number of the first line that is not UTF-8, or 1 if the file has been corrected since."""
    content = path.read_bytes()
    try:
        content.decode()
    except UnicodeDecodeError as error:
        return content.count(b"\n", 0, error.start) + 1
    return 1


@cache
def own_loader(own_folder: Path) -> _OwnTemplates:
    return _OwnTemplates(own_folder)


def render_template(
    templates: TemplateSettings, template_name: str, values: Mapping[str, object], own_folder: Path | None
) -> str:
    """Render a template of a target. ``own_folder`` is the folder of the user's templates for it.

    Raises:
        TemplateFault: A user's template has an error.
    """
    try:
        rendered_text = environment(templates, own_folder).get_template(template_name).render(values)
        # This is an error if the text has a character that UTF-8 cannot express.
        rendered_text.encode()
        return rendered_text
    except TemplateFault:
        raise
    except Exception as error:
        # If no template of the user was read, the error is in our templates.
        if own_folder is None or not own_loader(own_folder).used:
            raise
        file_and_line = _place_of_error(error, own_folder) or (own_folder / template_name).as_posix()
        raise TemplateFault(f"{file_and_line}: {_reason(error)}") from None


@cache
def environment(templates: TemplateSettings, own_folder: Path | None = None) -> Environment:
    """Return the environment for rendering templates. The user's templates in ``own_folder`` come first.

    With these, ``shipped/NAME`` still finds ours, and no compiled templates are stored.
    """
    shipped_loader = FileSystemLoader(templates.folder, encoding="utf-8-sig")
    loader: BaseLoader = shipped_loader
    if own_folder is not None:
        loader_with_prefix = PrefixLoader({_SHIPPED_PREFIX: shipped_loader})
        loader = ChoiceLoader([own_loader(own_folder), loader_with_prefix, shipped_loader])
    new_environment = Environment(
        loader=loader,
        bytecode_cache=CompiledTemplates() if own_folder is None else None,
        undefined=StrictUndefined,
        autoescape=templates.autoescape,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    new_environment.filters |= {**COMMON_FILTERS, **templates.filters}
    test_by_name: dict[str, Callable[..., bool]] = {}
    for test_name, tested_class in templates.tests.items():
        test_by_name[test_name] = partial(_is_instance_of, tested_class)
    new_environment.tests.update(test_by_name)
    new_environment.globals |= templates.functions
    return new_environment


def _is_instance_of(tested_class: type, value: object) -> bool:
    """Return whether a value is an instance of a class, as a test in a template."""
    return isinstance(value, tested_class)


def _place_of_error(error: Exception, own_folder: Path) -> str:
    """Return file and line of an error, such as ``mine/device.h.jinja:12``, or "" if it is not in a template.

    This is the innermost line in a template of the user or, if there is none, in one of ours.
    """
    if isinstance(error, TemplateSyntaxError):
        return f"{error.filename or error.name}:{error.lineno}"
    stack = traceback.extract_tb(error.__traceback__)
    frames_in_templates = [frame for frame in stack if frame.filename.endswith(TEMPLATE_SUFFIX)]
    frames_of_user = [frame for frame in frames_in_templates if Path(frame.filename).is_relative_to(own_folder)]
    relevant_frames = frames_of_user or frames_in_templates
    if not relevant_frames:
        return ""
    innermost_frame = relevant_frames[-1]
    return f"{Path(innermost_frame.filename).as_posix()}:{innermost_frame.lineno}"


def _reason(error: Exception) -> str:
    """Return the message of an error in a template, with the name of its class unless it is an error of Jinja."""
    if isinstance(error, TemplateNotFound):
        return f"there is no template '{text_on_one_line(error.name)}'"
    if isinstance(error, UnicodeEncodeError):
        invalid_code = ord(error.object[error.start])
        return f"the text contains U+{invalid_code:04X}, which is not a character"
    is_error_of_jinja = type(error).__module__.startswith("jinja2")
    message = text_on_one_line(error)
    return message if is_error_of_jinja else f"{type(error).__name__}: {message}"
