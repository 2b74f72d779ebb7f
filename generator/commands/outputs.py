"""Targets of a run: find those that the user named, with their options and families, and render their outputs.

Parts of a spec that a target cannot express are reported. Parts of outputs that depend on only one family are rendered
once, and stored in the cache.
"""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..cache import Cache, content_of
from ..language.files import packaged_masters
from ..language.problems import ProblemReport, TemplateFault, join_words, suggest_word
from ..loading.configuration import BUILT_IN, NO_FILTERS, FamilyFilters
from ..loading.library import families_without_problems, load_families
from ..loading.overlays import Family
from ..loading.stored import digest_of
from ..model import Device
from ..render import unused_templates
from ..say import first_of
from ..targets import Library, OptionError, Options, Target, TargetError
from ..targets.registry import PackageMissing, files_of, load_target, problems_of, target_names
from .families_in_specs import edition_devices
from .terminal import CommandError

if TYPE_CHECKING:
    from ..model import Device


#: Families named in a message. If there are more, the list ends with their number.
_MOST_FAMILIES = 8


def accepted_devices(target: str, devices: Sequence[Device], filters: FamilyFilters) -> tuple[Device, ...]:
    """Return the devices that a target writes: the devices that its filter accepts, or all without a filter.

    The filter selects families by name or by grade of evidence. An edition is written if its family is.
    """
    if target not in filters:
        return tuple(devices)
    accepts = filters[target].accepts
    return tuple(device for device in devices if accepts(family_of(device), device.evidence.grade))


def devices_by_target(
    targets: Iterable[str], devices: Sequence[Device], filters: FamilyFilters
) -> dict[str, tuple[Device, ...]]:
    """Return the devices that each target writes: those that its filter accepts, by the name of the target.

    Raises:
        CommandError: A target writes no family. The exit code is 1.
    """
    accepted = {target: accepted_devices(target, devices, filters) for target in targets}
    for target, target_devices in accepted.items():
        if devices and not target_devices:
            names_and_grades = [f"{device.name} ({device.evidence.grade})" for device in devices]
            families_read = first_of(names_and_grades, _MOST_FAMILIES)
            problem = f"the setting 'only.{target}' accepts no family that was read: {families_read}"
            raise CommandError(f"{problem}; change it, or name the other targets with --target", 1)
    return accepted


def targets_named(names: Iterable[str] | None = None, default_names: Iterable[str] = BUILT_IN) -> list[Target]:
    """Return the named targets, each once. Without names, return the default targets whose packages are installed.

    Raises:
        CommandError: There is no such target (exit code 2), or it cannot be loaded (exit code 1).
    """
    loaded_targets = []
    for name in dict.fromkeys(names or default_names):
        try:
            loaded_targets.append(load_target(name))
        except LookupError:
            raise CommandError(_unknown_target_message(name), 2) from None
        except PackageMissing as error:
            if names:
                raise CommandError(str(error), 1) from None
            print(f"codewheel: {error}; this target is skipped", file=sys.stderr)
        except TargetError as error:
            raise CommandError(str(error), 1) from None
    return loaded_targets


def are_built_in(targets: Iterable[Target], names: Iterable[str] | None) -> bool:
    """Return whether all targets with these names are built in and were loaded.

    ``targets`` are the loaded ones, in the order of the names. Without names, all built-in targets are meant.
    """
    wanted_names = list(dict.fromkeys(names or BUILT_IN))
    all_are_loaded = [target.name for target in targets] == wanted_names
    all_are_built_in = set(wanted_names) <= set(BUILT_IN)
    return all_are_loaded and all_are_built_in


def _unknown_target_message(name: str) -> str:
    """Return the message about an unknown target, with the nearest target or all of them."""
    hint = suggest_word(name, target_names(), "there are")
    return f"there is no target '{name}'{hint}"


def options_named(settings: Iterable[str], targets: Sequence[Target]) -> dict[str, Options]:
    """Return the options of each target by its name, set by ``settings`` or else to their defaults.

    Args:
        settings: Settings such as ``plc.separator=semicolon``.
        targets: The targets to run.

    Raises:
        CommandError: A setting is malformed, or its target does not run. The exit code is 2.
    """
    targets_by_name = {target.name: target for target in targets}
    options = {target.name: dict(target.defaults) for target in targets}
    for setting in settings:
        # A setting has the form TARGET.OPTION=VALUE.
        target_and_option, equals, value = setting.partition("=")
        target_name, dot, option = target_and_option.partition(".")
        if not equals or not dot:
            raise CommandError(f"'{setting}' is not a setting; write it like TARGET.OPTION=VALUE", 2)
        if target_name not in targets_by_name:
            if target_name not in target_names():
                raise CommandError(_unknown_target_message(target_name), 2)
            problem = f"'{target_and_option}' is for a target that does not run"
            raise CommandError(f"{problem}; add --target {target_name}", 2)
        _refuse_setting(targets_by_name[target_name], option, value)
        options[target_name][option] = value
    return dict(options)


def _refuse_setting(target: Target, name: str, value: str) -> None:
    """Raise ``CommandError`` if the option does not exist in the target or does not accept the value.

    An option without a list of values accepts all.
    """
    options = {option.name: option for option in target.options}
    if name not in options:
        hint = suggest_word(name, options, "it has") if options else "; it has none"
        raise CommandError(f"the target '{target.name}' has no option '{name}'{hint}", 2)
    accepted_values = options[name].values
    if accepted_values and value not in accepted_values:
        hint = suggest_word(value, accepted_values, "it can be")
        raise CommandError(f"'{target.name}.{name}' cannot be '{value}'{hint}", 2)


def load_for_targets(paths: Sequence[Path], targets: Iterable[Target]) -> tuple[tuple[Device, ...], ProblemReport]:
    """Return the devices of the specs, and a report that includes the parts that these targets cannot express.

    Raises:
        CommandError: A target fails. The exit code is 1.
    """
    families, report = load_families(paths)
    return complete_devices(families, targets, editions=(), report=report), report


def complete_devices(
    families: Sequence[Family],
    targets: Iterable[Target],
    *,
    editions: Iterable[str],
    report: ProblemReport,
    filters: FamilyFilters = NO_FILTERS,
) -> tuple[Device, ...]:
    """Return the devices of families and of ``editions``, by name, and report the parts that targets cannot express.

    ``editions`` are additional editions of families, such as ``FAMILY=1.6``. ``filters`` are the conditions for the
    families that each target must express.

    Raises:
        CommandError: A target fails. The exit code is 1.
    """
    report_unfit_parts(families, targets, report, filters)
    devices = [family.device for family in families]
    devices += edition_devices(families, editions, report)
    return tuple(sorted(devices, key=lambda device: device.name))


def report_unfit_parts(
    families: Sequence[Family], targets: Iterable[Target], report: ProblemReport, filters: FamilyFilters = NO_FILTERS
) -> None:
    """Report the parts that these targets cannot express, for families whose specs have no other problems.

    ``filters`` are the conditions for the families that each target must express.

    Raises:
        CommandError: A target fails. The exit code is 1.
    """
    valid_families = {family.device.name: family for family in families_without_problems(families, report)}
    devices = [family.device for family in valid_families.values()]
    for target in targets:
        library = Library(accepted_devices(target.name, devices, filters))
        try:
            target_problems = problems_of(target, library)
        except TargetError as error:
            raise CommandError(str(error), 1) from None
        for problem in target_problems:
            document = valid_families[problem.device.name].document
            message = problem.message
            if problem.other:  # The message contains the line of another place in the spec.
                line_number, _ = document.position(problem.other)
                message = message.replace("{line}", str(line_number))
            report.add(problem.rule, document, problem.place, message)


def render_targets(
    library: Library,
    targets: Sequence[Target],
    options: Mapping[str, Options],
    files_of: Callable[[Target, Library, Options], Mapping[str, str]] = files_of,
) -> dict[str, Mapping[str, str]]:
    """Return the files of each target, as ``{target: {path: text}}``.

    Args:
        library: The devices, and the folder of the user's templates.
        targets: The targets to run.
        options: The options of each target, by its name.
        files_of: Function that returns the files of one target.

    Raises:
        CommandError: A target or a user's template fails (exit code 1), or the name of a template is misspelt (exit
            code 2).
    """
    try:
        files = {target.name: files_of(target, library, options[target.name]) for target in targets}
    except OptionError as error:
        raise CommandError(str(error), 2) from None
    except (TargetError, TemplateFault) as error:
        raise CommandError(str(error), 1) from None
    if library.own_templates is not None:
        templates_by_target = {target.name: target.templates for target in targets}
        problems = list(unused_templates(library.own_templates, templates_by_target, target_names()))
        if problems:
            lines = ["nothing written: these templates have no effect:", *problems]
            raise CommandError("\n  ".join(lines), 2)
    return files


def targets_help() -> str:
    """Return the text about all targets and their options for ``--help``.

    A target that fails is listed with its error.
    """
    known_names = target_names()
    # Two spaces are in front of a name, and at least two behind it.
    indent = " " * (max(map(len, known_names)) + 4)
    lines = [f"targets ({join_words(BUILT_IN)} run by default):"]
    for name in known_names:
        name_column = f"  {name}".ljust(len(indent))
        try:
            target = load_target(name)
        except TargetError as error:
            lines += _wrap_paragraph(str(error), first=name_column, indent=indent)
            continue
        lines += _wrap_paragraph(target.summary, first=name_column, indent=indent)
        for option in target.options:
            values = "|".join(option.values) or "VALUE"
            option_text = f"--option {name}.{option.name}={values}: {option.summary} (default: {option.default})"
            lines += _wrap_paragraph(option_text, first=indent, indent=indent + "  ")
    return "\n".join(lines)


def _wrap_paragraph(text: str, first: str, indent: str) -> list[str]:
    """Return the lines of a paragraph, of which the first begins with ``first`` and the others with ``indent``."""
    # One column less than the terminal, like the rest of the help: 79 if the width is unknown.
    width = shutil.get_terminal_size().columns - 1
    return textwrap.wrap(text, width, initial_indent=first, subsequent_indent=indent, break_on_hyphens=False)


class FamilyParts:
    """Parts by target and model, from this run or from the cache."""

    def __init__(self, cache: Cache, only_paths: frozenset[str] = frozenset()) -> None:
        """Set the cache, and the names of families for which only the paths of files are needed, not their texts."""
        self._cache = cache
        self._families_with_only_paths = only_paths
        self._masters_content = content_of(sorted(packaged_masters().iterdir()))
        self._part_by_target_and_digest: dict[tuple[str, str], Any] = {}
        self._device_and_digest_by_id: dict[int, tuple[Device, str]] = {}

    def files_of(self, target: Target, library: Library, options: Options) -> Mapping[str, str]:
        """Return the files of a target like ``registry.files_of``, but render only parts that were not rendered before.

        Raises:
            TargetError: The target cannot express something, or fails.
            TemplateFault: A user's template has an error.
        """
        if target.name in BUILT_IN and options == target.defaults and library.own_templates is None:
            stored_part = partial(self._cached_part, target.name)
            library = replace(library, stored_part=stored_part, only_paths=self._families_with_only_paths)
        return files_of(target, library, options)

    def _cached_part(self, target_name: str, device: Device, render: Callable[[], Any]) -> Any:
        """Return the part of a target for one family, from this run or the cache, or rendered.

        A device without a digest is always rendered. Parts of families in ``only_paths`` are cached separately.
        """
        digest = self._digest_of(device)
        if not digest:
            return render()
        key = (target_name, digest)
        if key not in self._part_by_target_and_digest:
            part_kind = "paths" if device.name in self._families_with_only_paths else "part"
            self._part_by_target_and_digest[key] = self._part_from_cache(f"{part_kind} {target_name}", digest, render)
        return self._part_by_target_and_digest[key]

    def _part_from_cache(self, entry_kind: str, digest: str, render: Callable[[], Any]) -> Any:
        """Return the part in the cache, or render and store it.

        The key also contains the descriptions of all masters.
        """
        key_content = [digest, *self._masters_content]
        stored_part = self._cache.get(entry_kind, key_content)
        if stored_part is not None:
            return stored_part
        part = render()
        self._cache.put(entry_kind, key_content, part)
        return part

    def _digest_of(self, device: Device) -> str:
        """Return the digest of a device, or "" if it has none. It is computed once for all targets.

        The device is stored with its digest, because Python would otherwise reuse its ``id`` for another device.
        """
        if id(device) not in self._device_and_digest_by_id:
            self._device_and_digest_by_id[id(device)] = (device, digest_of(device))
        _, digest = self._device_and_digest_by_id[id(device)]
        return digest


def owners(devices: Iterable[Device]) -> list[str]:
    """Return the families as ``manufacturer/family``. Other editions belong to their family."""
    families = (device for device in devices if family_of(device) == device.name)
    return sorted(f"{device.manufacturer.name}/{device.name}" for device in families)


def family_of(device: Device) -> str:
    """Return the name of the family of a device. A special model is a family, another edition is not."""
    return device.name if not device.base or _is_special(device) else device.base


def _is_special(device: Device) -> bool:
    """Return True for a special model, which is described by an overlay."""
    return any(overlay.special for overlay in device.overlays)
