"""The specs and settings that a command reads: found by one rule, and named in its output.

The nearest file with settings applies, in the current folder or above it, up to the top of the repository. Every
command looks for this file, so the parsers are only imported if it exists.

docs/transcribe/which-specs.md explains the rule to users.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..language.files import (
    CONFIGURATION,
    LINK,
    REPOSITORY,
    UNREADABLE,
    describes_encoders,
    find_files,
    is_folder,
    is_spec,
    packaged_families,
)
from ..loading.configuration import BUILT_IN, PYPROJECT, Configuration, Faulty
from ..say import first_of
from .terminal import CommandError, error_after_printing, refuse_missing

if TYPE_CHECKING:
    from ..language.document import Path as Place
    from ..language.problems import ProblemReport


#: Text in each pyproject.toml with settings for codewheel. Files without this text are not parsed.
_SECTION_IN_PYPROJECT = b"tool.codewheel"


def configuration_above() -> Configuration | None:
    """Return the settings of the nearest folder with settings, or None if there are none.

    The search goes up from the current folder, and ends at the root of its repository.

    Raises:
        Faulty: The settings contain errors, or a folder has two files with settings.
    """
    for folder in _folders_above():
        files = [path for path in (folder / PYPROJECT, folder / CONFIGURATION) if _has_settings(path)]
        if len(files) > 1:
            raise Faulty(*files)
        if files:
            from ..loading.configuration_file import read_configuration

            # This is None if a pyproject.toml has no section for codewheel.
            configuration = read_configuration(files[0])
            if configuration is not None:
                return configuration
        if os.path.lexists(folder / REPOSITORY):
            return None
    return None


def _folders_above() -> Iterator[Path]:
    """Yield the current folder and its parents, as relative paths for messages: ``.``, ``..``, ``../..``."""
    try:
        number_above = len(Path.cwd().parents)
    except OSError:  # The current folder has been removed.
        return
    folder = Path()
    yield folder
    for _ in range(number_above):
        folder /= os.pardir
        yield folder


def _has_settings(file: Path) -> bool:
    """Return whether a file may contain settings: a ``codewheel.yaml``, or a pyproject.toml with the section's name.

    Whether the name is that of a section is only known after parsing the file.

    Raises:
        Faulty: The file cannot be read.
    """
    if not os.path.isfile(file):
        return False
    if file.name == CONFIGURATION:
        return not is_spec(file)
    try:
        return _SECTION_IN_PYPROJECT in file.read_bytes()
    except OSError:
        raise Faulty(file) from None


#: Number of files and folders after which the search below the current folder ends. The search takes less than 50 ms.
MOST_NAMES = 10_000
#: Highest number of folders in the message about folders that were not searched. The others are counted.
_MAX_FOLDERS = 8


@dataclass(frozen=True, slots=True)
class Specs:
    """The user's specs, and the packaged specs that read-only commands can also use.

    Attributes:
        paths: Files and folders of the user. Empty if there are none.
        packaged: Files and folders of the packaged specs, without those among ``paths``.
        settings: The user's settings, or None.
        is_complete: False if the search for specs ended at its limit.
        not_entered: Folders that were not searched but may contain specs, each with the reason.
    """

    paths: tuple[Path, ...]
    packaged: tuple[Path, ...] = ()
    settings: Configuration | None = None
    is_complete: bool = True
    not_entered: tuple[tuple[Path, str], ...] = ()

    @property
    def groups(self) -> list[tuple[Path, ...]]:
        """The user's specs, and then the packaged specs. Groups without specs are omitted."""
        return [group for group in (self.paths, self.packaged) if group]


def find_specs(named_paths: Sequence[Path]) -> Specs:
    """Return the specs that a command reads.

    These are the specs that are named on the command line. If none are named, they are the specs that the settings of
    the project list, or else all specs in the folder of the settings and below it. Without settings, they are all specs
    in the current folder and below it. If no specs are named, the packaged specs are included too.

    Raises:
        CommandError: A named path does not exist (exit code 2), or the settings contain errors (exit code 1).
    """
    refuse_missing(named_paths)
    settings = find_settings()
    if named_paths:
        return Specs(paths=tuple(named_paths), settings=settings)
    if settings is None:
        user_specs = _search_folder(Path(), outputs=())
    elif settings.specs:
        user_specs = Specs(paths=tuple(_specs_without_output(settings)))
    else:
        user_specs = _search_folder(settings.folder, _output_paths(settings))
    packaged = _packaged_except(user_specs.paths)
    return replace(user_specs, packaged=tuple(packaged), settings=settings)


def find_settings() -> Configuration | None:
    """Return the settings for the current folder, or None.

    Raises:
        CommandError: The settings contain errors. The exit code is 1.
    """
    try:
        return configuration_above()
    except Faulty as error:
        from ..loading.configuration_file import errors_in

        raise error_after_printing(errors_in(error.files)) from None


#: Commands that get the folder of the specs with an option.
_COMMANDS_WITH_OPTION = ("reread OLD NEW", "facts FAMILY", "cloze FAMILY")


def find_specs_to_judge(named_paths: Sequence[Path], command: str) -> Specs:
    """Return the user's specs for a command that writes or checks something, without the packaged specs.

    ``command`` is the command in messages, such as ``generate`` or ``facts FAMILY``.

    Raises:
        CommandError: There are no specs, there are more files than the search can find, or a named path does not exist
            (exit code 2). Or the settings contain errors (exit code 1).
    """
    specs = find_specs(named_paths)
    folder = specs.settings.folder if specs.settings is not None else Path()
    # These commands have positional arguments of their own, so specs are named with an option.
    option = " --specs" if command in _COMMANDS_WITH_OPTION else ""
    command_with_folder = f"codewheel {command}{option} FOLDER"
    if not specs.is_complete:
        problem = f"{_folder_text(folder)} has more than {MOST_NAMES:,} files and folders"
        consequence = "so not all of its specs were found"
        remedy = f"name the folder of the specs: {command_with_folder}, or list it under [tool.codewheel]"
        raise CommandError(f"{problem}, {consequence}; {remedy}", 2)
    if not specs.paths:
        problem = f"there are no specs in {_folder_text(folder)} or below it{_output_with_specs(specs)}"
        remedy = f"name them: {command_with_folder}, or list them under [tool.codewheel] in pyproject.toml"
        hint = ""
        if command == "generate":
            example = _example_of_packaged_family()
            hint = f"; outputs for a packaged encoder: codewheel generate --packaged {example} -o out"
        raise CommandError(f"{problem}; {remedy}{hint}", 2)
    _report_unsearched_folders(specs, folder)
    return replace(specs, packaged=())


def _output_with_specs(specs: Specs) -> str:
    """Return a clause for an error message if the output folder, which is not searched, contains specs, or ""."""
    output = specs.settings.output if specs.settings is not None else None
    has_specs = output is not None and is_folder(output) and bool(find_files(output).specs)
    if output is None or not has_specs:
        return ""
    return f", apart from those in {output.as_posix()}, which is the output folder and is not searched"


def _example_of_packaged_family() -> str:
    """Return the name of the first packaged family, which is also the name of its file."""
    for folder in packaged_families():
        for spec in find_files(folder).specs:
            if describes_encoders(spec):
                return spec.stem
    raise LookupError("there are no packaged families")


def _real_folder(path: Path) -> str:
    """Return the real path of a folder with a separator at its end. The paths of all files in it begin with this."""
    return os.path.join(os.path.realpath(path), "")


def _report_unsearched_folders(specs: Specs, folder: Path) -> None:
    """Report folders that may contain specs but were not searched, so that users do not believe they were checked.

    ``folder`` is the folder that was searched if no folders are among the specs. A link to a folder that was searched
    anyway is not reported, nor is an unreadable folder below a folder among the specs.
    """
    folders = [path for path in specs.paths if is_folder(path)]
    searched_folders = tuple(_real_folder(path) for path in folders or [folder])
    not_entered = list(specs.not_entered)
    for searched_folder in folders:
        # This search only finds the folders that it does not enter, so it needs to read no file.
        search_result = find_files(searched_folder, lambda _: False)
        not_entered += [(path, reason) for path, reason in search_result.not_entered if reason != UNREADABLE]
    paths_with_reasons = []
    for path, reason in not_entered:
        is_searched_anyway = reason == LINK and _real_folder(path).startswith(searched_folders)
        if not is_searched_anyway:
            paths_with_reasons.append(f"{path.as_posix()} ({reason})")
    if paths_with_reasons:
        print(f"codewheel: not searched for specs: {first_of(paths_with_reasons, _MAX_FOLDERS)}", file=sys.stderr)


def find_specs_to_read(named_paths: Sequence[Path]) -> Specs:
    """Return the specs for a command that only reads, and print a notice if the search ended before its end.

    Raises:
        CommandError: A named path does not exist (exit code 2), or the settings contain errors (exit code 1).
    """
    specs = find_specs(named_paths)
    if not specs.is_complete:
        print(
            f"codewheel: searched only {MOST_NAMES:,} files and folders for specs; name yours with --specs, or list "
            "them under [tool.codewheel]",
            file=sys.stderr,
        )
    return specs


def _folder_text(folder: Path) -> str:
    return "this folder" if folder == Path() else folder.as_posix()


def _output_paths(settings: Configuration) -> list[str]:
    """Return the real path of the output folder in the settings, if they have one."""
    return [os.path.realpath(settings.output)] if settings.output is not None else []


def _specs_without_output(settings: Configuration) -> Iterator[Path]:
    """Yield the specs that the settings list. A folder that contains the output folder is replaced by its own specs."""
    output_paths = _output_paths(settings)
    for path in settings.specs:
        contains_output = any(output.startswith(_real_folder(path)) for output in output_paths)
        if contains_output:
            yield from find_files(path, outputs=output_paths).specs
        else:
            yield path


def _search_folder(folder: Path, outputs: Sequence[str]) -> Specs:
    """Return the specs in a folder and below it, except unreadable specs and specs in the folders ``outputs``.

    If none of the specs describes encoders, no paths are returned.
    """
    search_result = find_files(folder, outputs=outputs, most_names=MOST_NAMES)
    unreadable_paths = {path for path, reason in search_result.not_entered if reason == UNREADABLE}
    specs = tuple(path for path in search_result.specs if path not in unreadable_paths)
    has_encoders = any(describes_encoders(spec) for spec in specs)
    return Specs(
        paths=specs if has_encoders else (),
        is_complete=search_result.is_complete,
        not_entered=search_result.not_entered,
    )


def _packaged_except(paths: Sequence[Path]) -> Iterator[Path]:
    """Yield the folders of packaged specs, without specs that are also among the user's ``paths``.

    A folder at or below one of these paths is left out. If only some of its files are among the paths, its other specs
    are yielded instead of the folder.
    """
    user_paths = [os.path.realpath(path) for path in paths]
    for folder in packaged_families():
        packaged_folder = _real_folder(folder)
        # Each folder ends in a separator in these comparisons, so that ``acme`` does not contain ``acme_new``.
        is_inside_user_folder = any(packaged_folder.startswith(os.path.join(path, "")) for path in user_paths)
        has_user_files = any(path.startswith(packaged_folder) for path in user_paths)
        if is_inside_user_folder:
            continue
        if not has_user_files:
            yield folder
            continue
        for spec in find_files(folder).specs:
            if os.path.realpath(spec) not in user_paths:
                yield spec


def refuse_unknown_targets(settings: Configuration | None) -> None:
    """Check that the targets in the settings exist, without loading them.

    Raises:
        CommandError: There is no such target. The exit code is 1.
    """
    if settings is None or not (settings.targets or settings.only):
        return
    # Each target that is not built in, with its place in the settings, such as ("targets", 0) or ("only", "html").
    registered_targets: list[tuple[str, Place]] = []
    for index, name in enumerate(settings.targets):
        if name not in BUILT_IN:
            registered_targets.append((name, ("targets", index)))
    for name in settings.only:
        if name not in BUILT_IN:
            registered_targets.append((name, ("only", name)))
    if not registered_targets:
        return
    from ..targets.registry import target_names

    known_names = target_names()
    unknown_targets = [(name, settings_path) for name, settings_path in registered_targets if name not in known_names]
    if unknown_targets:
        raise error_after_printing(_report_unknown_targets(settings.file, unknown_targets, known_names))


def _report_unknown_targets(
    file: Path, unknown_targets: Iterable[tuple[str, Place]], known_names: Iterable[str]
) -> ProblemReport:
    """Return a report with an error for each unknown target, at its place in the settings.

    Under ``targets``, the place is an item of the list. Under ``only``, it is a key.
    """
    from ..language.problems import ProblemReport, suggest_word
    from ..loading.configuration_file import add_error

    report = ProblemReport()
    for name, settings_path in unknown_targets:
        hint = suggest_word(name, known_names, "there are")
        message = f"there is no target '{name}'{hint}"
        is_key = settings_path[0] == "only"
        add_error(report, file, settings_path, rule="undefined-reference", message=message, at_key=is_key)
    return report


def report_unknown_families(settings: Configuration | None, family_names: Iterable[str], report: ProblemReport) -> None:
    """Report families in the settings that none of the specs describes.

    Args:
        settings: The settings.
        family_names: Names of the families that were read from all specs of the settings.
        report: The report on these specs, to which the errors are added.
    """
    if settings is None or not settings.only:
        return
    from ..language.problems import suggest_word
    from ..loading.configuration_file import add_error

    # A spec with problems may have no family yet, so its file counts as a family of this name.
    names_of_files = [Path(file).stem for file in report.files] if report else []
    known_names = list(family_names)
    for target, family_filter in settings.only.items():
        for index, name in enumerate(family_filter.families):
            if name in known_names or name in names_of_files:
                continue
            hint = suggest_word(name, known_names, "there are")
            message = f"there is no family '{name}' among the specs{hint}"
            settings_path = ("only", target, "families", index)
            add_error(report, settings.file, settings_path, rule="undefined-reference", message=message)


def specs_to_judge(named_paths: Sequence[Path], command: str) -> Specs:
    """Return the user's specs for a command that writes or checks something, and check the targets in the settings.

    ``command`` is the command in messages, such as ``generate`` or ``facts FAMILY``.

    Raises:
        CommandError: There are no specs, a named path does not exist, or the settings contain errors.
    """
    specs = find_specs_to_judge(named_paths, command)
    refuse_unknown_targets(specs.settings)
    return specs


def specs_to_read(named_paths: Sequence[Path]) -> Specs:
    """Return the specs for a command that only reads, after checking the targets in the settings.

    Raises:
        CommandError: A named path does not exist, or the settings contain errors.
    """
    specs = find_specs_to_read(named_paths)
    refuse_unknown_targets(specs.settings)
    return specs
