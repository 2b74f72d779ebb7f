"""List the generated files that differ between two versions of specs, by generating both in memory.

Parts of families with the same model are rendered once for both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..cache import Cache
from ..changes.report import Files
from ..family_parts import FamilyParts
from ..model import Device
from ..targets import Library, TargetError
from ..targets.registry import BUILT_IN, load_target
from ..template_fault import TemplateFault


def changed_files(old: Sequence[Device], new: Sequence[Device], cache: Cache) -> Files | None:
    """Return the files that our targets add, remove or change, or None if a target cannot express a family."""
    parts = FamilyParts(cache)
    try:
        before, after = _files(old, parts), _files(new, parts)
    except (TargetError, TemplateFault):
        return None
    names = sorted({*before, *after})
    return Files(tuple(name for name in names if before.get(name) != after.get(name)), len(names))


def _files(devices: Sequence[Device], parts: FamilyParts) -> Mapping[str, str]:
    library = Library(tuple(devices))
    files: dict[str, str] = {}
    for name in BUILT_IN:
        target = load_target(name)
        files |= parts.files_of(target, library, target.defaults)
    return files
