"""The specs, targets and output folder for ``codewheel generate``, from its arguments or from the settings."""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...cache import Cache
from ...language.files import MANUFACTURER, find_files, packaged_families
from ...loading.configuration import NO_FILTERS, Configuration, FamilyFilters
from ..find_encoder import find_family_or_code
from ..read_specs import Specs, find_settings, find_specs, find_specs_to_judge, refuse_unknown_targets
from ..terminal import CommandError, refuse_missing

if TYPE_CHECKING:
    from ...model import Device
    from .removal_guard import RemovalGuard

OUTPUT = Path("generated")


@dataclass(frozen=True, slots=True)
class Selection:
    """Specs to read, and the options of targets that follow from the arguments.

    Attributes:
        paths: The specs, with the packaged ones last.
        options: Options of targets. With ``--packaged``, one of them can limit C to order codes.
        packaged: The packaged specs among ``paths``.
        is_narrowed: Whether that option is among ``options``.
        command_with: Returns the command that also reads the families with these names, such as ``maker/my_encoder``.
        settings: The user's settings if the run reads all of their specs, otherwise None.
        only: Conditions for the families that targets write to the output folder.
    """

    paths: tuple[Path, ...]
    options: tuple[str, ...]
    packaged: tuple[Path, ...]
    is_narrowed: bool
    command_with: Callable[[Sequence[str]], str]
    settings: Configuration | None
    only: FamilyFilters

    def options_for(self, families: Sequence[str]) -> tuple[str, ...]:
        """Return the options of targets for the families that were read.

        If ``--packaged`` limits C to order codes, the last option is ``c.only=`` with their names. The names of the
        user's own families are added to it, because the limit would exclude them.
        """
        if not self.is_narrowed:
            return self.options
        # A file is named after its family.
        packaged_names = {path.stem for path in self.packaged}
        user_families = [name for name in families if name not in packaged_names]
        *other_options, limit = self.options
        return (*other_options, ",".join([limit, *user_families]))

    def guard(self, arguments: argparse.Namespace, devices: Sequence[Device], files: Sequence[str]) -> RemovalGuard:
        """Return a check that prevents the run from changing outputs that belong to other specs."""
        from .removal_guard import RemovalGuard

        return RemovalGuard(arguments.output, devices, files, self.command_with, is_comparison=arguments.check)


def select_specs(arguments: argparse.Namespace, cache: Cache) -> Selection:
    """Return the specs and options of a run, and complete its arguments.

    The output folder and the targets that the user did not name are set in ``arguments``, as is ``again``, the command
    that repeats the run.

    Raises:
        CommandError: There are no specs, a name is unknown (exit code 2), or there are errors in the settings (exit
            code 1).
    """
    named_paths = [*arguments.specs, *arguments.more_specs]
    # A copy, because the output folder and the targets are filled in later.
    user_arguments = argparse.Namespace(**vars(arguments))
    arguments.again = command_again(user_arguments)
    if user_arguments.prune:
        arguments.again += " --prune"
    _require_existing(named_paths, cache)
    if arguments.packaged:
        packaged, implied_options = _find_packaged(arguments, cache)
        specs = Specs(paths=(*named_paths, *packaged), settings=find_settings())
    else:
        packaged, implied_options = (), ()
        specs = find_specs_to_judge(named_paths, "generate")
    settings = specs.settings
    refuse_unknown_targets(settings)
    _fill_in_output_and_targets(arguments, settings)

    def command_with(families: Sequence[str]) -> str:
        return _command_with(families, user_arguments, settings)

    reads_all_specs = not named_paths and not arguments.packaged
    return Selection(
        paths=specs.paths,
        options=(*arguments.option, *implied_options),
        packaged=packaged,
        is_narrowed=bool(implied_options),
        command_with=command_with,
        settings=settings if reads_all_specs else None,
        only=_filters_for(arguments.output, settings),
    )


def _command_with(families: Sequence[str], user_arguments: argparse.Namespace, settings: Configuration | None) -> str:
    """Return a command like the user's that also reads the families in ``families``, such as ``maker/my_encoder``.

    Packaged families are named with ``--packaged``, and the folders of other families as arguments.
    """
    packaged_families_to_add = [family for family in families if _is_packaged(family)]
    names_specs = bool(user_arguments.specs or user_arguments.more_specs)
    settings_list_specs = settings is not None and bool(settings.specs)
    if names_specs and settings_list_specs and not packaged_families_to_add:
        # The user named some specs. Without names, the command reads all specs that the settings list.
        return "codewheel generate"
    are_only_packaged = bool(families) and len(packaged_families_to_add) == len(families)
    folders = _folders_to_add(user_arguments, settings, needs_own_specs=not are_only_packaged)
    arguments = argparse.Namespace(**vars(user_arguments))
    for family in packaged_families_to_add:
        _, _, name = family.partition("/")
        arguments.packaged = [*arguments.packaged, name]
    return command_again(arguments, *folders)


def _folders_to_add(
    user_arguments: argparse.Namespace, settings: Configuration | None, *, needs_own_specs: bool
) -> list[str]:
    """Return the folders to add to the user's command, so that it also reads more of the user's own specs.

    A folder that only the user knows is the placeholder ``FOLDER``. If ``needs_own_specs`` is false, the added families
    are all packaged. Then folders are only added to name what the command has read without names.
    """
    unknown_folder = ["FOLDER"] if needs_own_specs else []
    if user_arguments.specs or user_arguments.more_specs:
        return unknown_folder
    if not user_arguments.packaged:
        # The user's command has no names and reads all own specs, which a name would exclude.
        return [*_own_specs(settings), *unknown_folder]
    if needs_own_specs:
        # The user's command reads only packaged specs, and the other families may be among the user's own.
        return _own_specs(settings) or unknown_folder
    return []


def command_again(arguments: argparse.Namespace, *more_specs: str) -> str:
    """Return the command line that writes the outputs with the arguments that the user gave, and with more specs.

    For example ``codewheel generate my_encoder.yaml -o out --target c``.
    """
    words = ["codewheel", "generate", *map(str, [*arguments.specs, *arguments.more_specs]), *more_specs]
    for name in arguments.packaged:
        words += ["--packaged", name]
    if arguments.output is not None:
        words += ["-o", str(arguments.output)]
    for name in arguments.target or ():
        words += ["--target", name]
    for setting in arguments.option:
        words += ["--option", setting]
    for edition in arguments.edition:
        words += ["--edition", edition]
    if arguments.templates is not None:
        words += ["--templates", str(arguments.templates)]
    return shlex.join(words)


def _is_packaged(family: str) -> bool:
    """Return whether a family, such as ``maker/my_encoder``, is among the packaged specs."""
    manufacturer, _, name = family.partition("/")
    for folder in packaged_families():
        if folder.name == manufacturer and (folder / f"{name}.yaml").is_file():
            return True
    return False


def _own_specs(settings: Configuration | None) -> list[str]:
    """Return the arguments that name the specs that are read if the user names none.

    These are the specs that the settings name, or else the folder of the settings, or else the current folder.
    """
    if settings is not None and settings.specs:
        return [path.as_posix() for path in settings.specs]
    folder = settings.folder if settings is not None else Path()
    return [folder.as_posix()] if find_specs(()).paths else []


def _require_existing(named: Sequence[Path], cache: Cache) -> None:
    """Check that all paths exist.

    The error explains ``--packaged`` if a missing path is the name of a packaged encoder.

    Raises:
        CommandError: A path does not exist. The exit code is 2.
    """
    try:
        refuse_missing(named)
    except CommandError as stop:
        missing_names = [path.as_posix() for path in named if not path.exists()]
        packaged_names = [name for name in missing_names if _is_name_of_packaged(name, cache)]
        if not packaged_names:
            raise
        command_words = ["codewheel", "generate"]
        for name in packaged_names:
            command_words += ["--packaged", name]
        message = f"{stop}; to generate a packaged encoder: {shlex.join(command_words)}"
        raise CommandError(message, stop.code) from None


def _is_name_of_packaged(name: str, cache: Cache) -> bool:
    """Return whether a name is an order code, family or manufacturer of the packaged specs."""
    try:
        _packaged_specs(name, cache)
    except CommandError:
        return False
    return True


def _fill_in_output_and_targets(arguments: argparse.Namespace, settings: Configuration | None) -> None:
    """Set the output folder and the targets that the user did not name."""
    if arguments.output is None:
        arguments.output = OUTPUT
        if settings is not None and settings.output is not None:
            arguments.output = settings.output
    if not arguments.target and settings is not None and settings.targets:
        arguments.target = list(settings.targets)


def _filters_for(output: Path, settings: Configuration | None) -> FamilyFilters:
    """Return the conditions on families for an output folder. They only apply to the output folder in the settings."""
    if settings is None:
        return NO_FILTERS
    configured_output = os.path.realpath(settings.output or OUTPUT)
    is_configured_output = os.path.realpath(output) == configured_output
    return settings.only if is_configured_output else NO_FILTERS


def _find_packaged(arguments: argparse.Namespace, cache: Cache) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Return the packaged specs that ``--packaged`` names, and the option that limits the C headers to them.

    The option is ``("c.only=X-24,my_encoder",)``, for example, or ``()`` if no name is an order code.
    """
    paths: list[Path] = []
    # If the user names a family or a manufacturer, its families must be in the option too.
    families_and_codes: list[str] = []
    for name in arguments.packaged:
        specs, families_or_code = _packaged_specs(name, cache)
        paths += specs
        families_and_codes += families_or_code
    return tuple(dict.fromkeys(paths)), _option_to_limit_c(arguments, families_and_codes)


def _packaged_specs(name: str, cache: Cache) -> tuple[Sequence[Path], Sequence[str]]:
    """Return the packaged specs of a manufacturer, family or order code, and the names to which C is limited.

    These names are the families of the manufacturer, the family, or the order code. For an order code that the manual
    does not list, C has no separate code, so the name is its family.

    Raises:
        CommandError: There is no such manufacturer, family or order code. The exit code is 2.
    """
    folders = {folder.name: folder for folder in packaged_families()}
    if name.lower() in folders:
        specs = find_files(folders[name.lower()]).specs
        return specs, [path.stem for path in specs if path.name != MANUFACTURER]
    all_packaged_specs = Specs(paths=tuple(folders.values()))
    try:
        device, code_match, _ = find_family_or_code(all_packaged_specs, name, cache)
    except CommandError as stop:
        raise _no_packaged_error(name, stop, folders) from None
    spec = folders[device.manufacturer.name] / f"{device.name}.yaml"
    # The name of a family is found without a match.
    if code_match is None or code_match.unlisted:
        return [spec], [device.name]
    return [spec], [code_match.variant.code]


def _no_packaged_error(name: str, stop: CommandError, folders: Mapping[str, Path]) -> CommandError:
    """Return the error for an unknown name, with the nearest family or manufacturer if there is one.

    ``stop`` is the error of the search for an order code, and ``folders`` are the folders of the manufacturers.
    """
    from difflib import get_close_matches

    from ...language.problems import nearest_choice
    from ...order_codes import labels

    unknown_code = labels.unknown_code(name)
    if not str(stop).startswith(unknown_code):  # The name is close to an order code, and the message says how.
        return stop
    known_names = list(folders)
    for folder in folders.values():
        known_names += [path.stem for path in find_files(folder).specs if path.name != MANUFACTURER]
    nearest_name = nearest_choice(name.lower(), known_names)
    similar_names = get_close_matches(name.lower(), known_names)
    if nearest_name:
        remedy = f"; did you mean '{nearest_name}'?"
    elif similar_names:
        remedy = labels.nearest_codes_hint(", ".join(similar_names))
    else:
        remedy = str(stop).removeprefix(unknown_code)
    return CommandError(f"'{name}' is not a packaged order code, family or manufacturer{remedy}", stop.code)


def _option_to_limit_c(arguments: argparse.Namespace, families_and_codes: Sequence[str]) -> tuple[str, ...]:
    """Return the option that limits the C headers to these families and order codes, or ``()``.

    The option is not needed if the user gave it, if C is not written, or if there are only families.
    """
    has_option = any(setting.startswith("c.only=") for setting in arguments.option)
    writes_c = not arguments.target or "c" in arguments.target
    # Order codes have capitals or only digits, and names of families are in lower case.
    has_codes = any(not name.islower() for name in families_and_codes)
    if has_option or not writes_c or not has_codes:
        return ()
    # Each name once, in the order of the arguments.
    listed_names = ",".join(dict.fromkeys(families_and_codes))
    return (f"c.only={listed_names}",)
