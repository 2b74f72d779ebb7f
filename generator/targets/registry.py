"""All built-in and registered targets, and the files that built-in targets share."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from importlib import import_module, resources
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ..language.problems import TemplateFault
from ..loading.configuration import BUILT_IN
from . import Library, Options, Target, TargetError, TargetProblem

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


#: Built-in targets that cannot express everything. ``check`` asks only these for problems.
WITH_PROBLEMS = ("c",)
GROUP = "codewheel.targets"
_Result = TypeVar("_Result")


class PackageMissing(TargetError):
    """A target needs a Python package that is not installed."""


def target_names() -> list[str]:
    """Return the names of all targets, first the built-in and then the registered targets."""
    return [*BUILT_IN, *(name for name in _entry_points_by_name() if name not in BUILT_IN)]


def load_target(name: str) -> Target:
    """Load the target with this name, without importing the modules of other targets.

    Raises:
        LookupError: There is no such target.
        TargetError: The target cannot be loaded, or is not a ``Target``.
    """
    if name in BUILT_IN:
        return _load_checked(name, lambda: import_module(f"{__package__}.{name}.files").TARGET)
    points = _entry_points_by_name()[name]  # a KeyError is a LookupError
    if len(points) > 1:
        packages = " and by ".join(map(_package_of, points))
        raise TargetError(f"the target '{name}' is registered by {packages}; remove one")
    return _load_checked(name, points[0].load)


def files_of(target: Target, library: Library, options: Options) -> Mapping[str, str]:
    """Return the files of a target, keyed by path.

    Args:
        target: The target.
        library: The devices, and the folder of the user's templates, which has a folder for each target.
        options: The value of every option.

    Raises:
        TargetError: The target cannot express something, fails, or returns something else than text by path.
        TemplateFault: A user's template has an error.
    """
    templates = library.own_templates / target.name if library.own_templates is not None else None
    target_library = replace(library, own_templates=templates)
    files = _run_target(target.name, lambda: target.files(target_library, options))
    if fault := _fault_of_files(files):
        raise TargetError(f"the target '{target.name}' must return text by path; {fault}")
    return files


def problems_of(target: Target, library: Library) -> list[TargetProblem]:
    """Return the parts of specs that a target cannot express.

    Raises:
        TargetError: The target fails, or returns something else than problems of these devices.
    """
    problems = _run_target(target.name, lambda: list(target.problems(library)))
    for problem in problems:
        if fault := _fault_of_problem(problem, library):
            raise TargetError(f"the target '{target.name}' must return problems as TargetProblem; {fault}")
    return problems


def _fault_of_problem(problem: object, library: Library) -> str:
    """Return what is wrong with a problem that a target reports, or an empty string if it is a valid problem."""
    if not isinstance(problem, TargetProblem):
        return f"this is {_type_name(problem)}"
    if problem.device.name not in {device.name for device in library.devices}:
        return f"the device '{problem.device.name}' is not in its library"
    texts = (problem.rule, problem.message, *problem.place, *problem.other)
    parts_of_wrong_type = [part for part in texts if not isinstance(part, (str, int))]
    return f"a part of it is {_type_name(parts_of_wrong_type[0])}" if parts_of_wrong_type else ""


def _fault_of_files(files: object) -> str:
    """Return what is wrong with the files of a target, or an empty string if they are text by path."""
    if not isinstance(files, Mapping):
        return f"this is {_type_name(files)}"
    for path, text in files.items():
        if not isinstance(path, str):
            return f"{path!r} is not a path"
        if not isinstance(text, str):
            return f"{path!r} is {_type_name(text)}"
        try:
            (path + text).encode()
        except UnicodeEncodeError as error:
            return f"{path!r} contains U+{ord(error.object[error.start]):04X}, which is not a character"
    return ""


def _type_name(value: object) -> str:
    """Return the name of the type of a value for a message, or ``nothing`` for None."""
    return "nothing" if value is None else type(value).__name__


def _entry_points_by_name() -> dict[str, list[EntryPoint]]:
    """Return the entry points by name. Several packages may use the same name."""
    from importlib.metadata import entry_points

    points_by_name: dict[str, list[EntryPoint]] = {}
    for entry_point in entry_points(group=GROUP):
        points_by_name.setdefault(entry_point.name, []).append(entry_point)
    return dict(sorted(points_by_name.items()))


def _package_of(entry_point: EntryPoint) -> str:
    """Return the package that registers an entry point, or its value if the package is not known."""
    return entry_point.dist.name if entry_point.dist is not None else entry_point.value


def _load_checked(name: str, load: Callable[[], object]) -> Target:
    """Return the target that ``load`` returns.

    Raises:
        TargetError: It cannot be loaded, is not a ``Target``, or has another name.
    """
    try:
        target = load()
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if not package or package == __package__.partition(".")[0]:
            raise TargetError(f"the target '{name}' cannot be loaded: {_error_line(error)}") from error
        raise PackageMissing(f"the target '{name}' needs the Python package '{package}', which is missing") from error
    except Exception as error:
        raise TargetError(f"the target '{name}' cannot be loaded: {_error_line(error)}") from error
    if not isinstance(target, Target):
        raise TargetError(f"the target '{name}' must be a codewheel.targets.Target; this is {_type_name(target)}")
    if target.name != name:
        raise TargetError(f"the target '{name}' calls itself '{target.name}'; both names must be the same")
    return target


def _run_target(name: str, work: Callable[[], _Result]) -> _Result:
    """Return the result of ``work``.

    Raises:
        TargetError: The target raised it, or it failed with another error, which the message contains.
        TemplateFault: A user's template has an error.
    """
    try:
        return work()
    except (TargetError, TemplateFault):
        raise
    except Exception as error:
        raise TargetError(f"the target '{name}' fails: {_error_line(error)}") from error


def _error_line(error: Exception) -> str:
    """Return an error in one line, with its origin."""
    frames = traceback.extract_tb(error.__traceback__)
    origin = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    message = " ".join(str(error).split())
    return f"{type(error).__name__}: {message}{origin}"


_NOT_ALLOWED = re.compile(r"[^A-Za-z0-9.-]+")
_LONGEST_TEXT = 80


def names_of_codes(order_codes: Iterable[str], reserved_names: Iterable[str] = ()) -> list[str]:
    """Return a file name for each order code. The names are unique even on file systems that ignore case.

    Characters that are not allowed become hyphens, and dots at the start are dropped. A name has at most 80 characters.
    Duplicates and empty names are numbered. ``reserved_names`` are in lowercase.
    """
    used_names = set(reserved_names)
    file_names: list[str] = []
    for order_code in order_codes:
        file_name = _unused_file_name(_NOT_ALLOWED.sub("-", order_code).lstrip("."), used_names)
        file_names.append(file_name)
        used_names.add(file_name.casefold())
    return file_names


def _unused_file_name(stem: str, used_names: Collection[str]) -> str:
    """Return ``stem``, with a number at its end if it is empty or used already. ``used_names`` are in lower case."""
    file_name = stem[:_LONGEST_TEXT]
    numbers = count(2)
    while not file_name or file_name.casefold() in used_names:
        suffix = f"-{next(numbers)}"
        file_name = f"{stem[: _LONGEST_TEXT - len(suffix)]}{suffix}"
    return file_name


_LICENCE_TEXT = """\
Zero-Clause BSD (0BSD)

Permission to use, copy, modify, and/or distribute this software for any purpose with or without fee is hereby granted.

THE SOFTWARE IS PROVIDED "AS IS" AND THE AUTHOR DISCLAIMS ALL WARRANTIES WITH REGARD TO THIS SOFTWARE INCLUDING ALL
IMPLIED WARRANTIES OF MERCHANTABILITY AND FITNESS. IN NO EVENT SHALL THE AUTHOR BE LIABLE FOR ANY SPECIAL, DIRECT,
INDIRECT, OR CONSEQUENTIAL DAMAGES OR ANY DAMAGES WHATSOEVER RESULTING FROM LOSS OF USE, DATA OR PROFITS, WHETHER IN AN
ACTION OF CONTRACT, NEGLIGENCE OR OTHER TORTIOUS ACTION, ARISING OUT OF OR IN CONNECTION WITH THE USE OR PERFORMANCE OF
THIS SOFTWARE.
"""


def licence_in(folder: str) -> dict[str, str]:
    """Return the licence as a file in this folder."""
    return {f"{folder}/LICENSE": _LICENCE_TEXT}


def our_runtime(language: str) -> Path:
    """Return the folder of the runtime for a language."""
    return Path(str(resources.files("codewheel.runtime"))) / language


def copied_files(folder: Path, to: str) -> dict[str, str]:
    """Return the text of each file in a folder and its subfolders, keyed by its path in the folder ``to``."""
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]
    return {f"{to}/{path.relative_to(folder).as_posix()}": path.read_text(encoding="utf-8") for path in paths}
