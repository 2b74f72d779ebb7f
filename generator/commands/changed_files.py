"""List the generated files that differ between two versions of specs, by generating both in memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..changes.report import Files
from ..model import Device
from ..targets import Library, TargetError
from ..targets.registry import BUILT_IN, files_of, load_target
from ..template_fault import TemplateFault


def changed_files(old: Sequence[Device], new: Sequence[Device]) -> Files | None:
    """Return the files that our targets add, remove or change, or None if a target cannot express a family."""
    try:
        before, after = (_files(devices) for devices in (old, new))
    except (TargetError, TemplateFault):
        return None
    names = sorted({*before, *after})
    return Files(tuple(name for name in names if before.get(name) != after.get(name)), len(names))


def _files(devices: Sequence[Device]) -> Mapping[str, str]:
    library = Library(tuple(devices))
    files: dict[str, str] = {}
    for name in BUILT_IN:
        target = load_target(name)
        options = {option.name: option.default for option in target.options}
        files |= files_of(target, library, options)
    return files
