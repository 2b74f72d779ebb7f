"""References of a spec to places that an overlay or an edition removed. They are left out."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from .document import ErratumTargets


def names_of_characteristics(spec_data: Mapping[str, Any]) -> set[str]:
    """Return the names of the characteristics in the data of a spec, which may be invalid."""
    characteristics = spec_data.get("characteristics")
    if not isinstance(characteristics, list):
        return set()
    names = [characteristic.get("name") for characteristic in characteristics if isinstance(characteristic, dict)]
    return {name for name in names if isinstance(name, str)}


def without_steps(node: Any, removed_names: Collection[str]) -> Any:
    """Return the data of a spec without the names of removed characteristics in ``by_hand``.

    ``by_hand`` lists characteristics with steps for a person. The key is removed if no name remains.
    """
    if isinstance(node, list):
        return [without_steps(inner, removed_names) for inner in node]
    if not isinstance(node, dict):
        return node
    cleaned = {}
    for key, inner in node.items():
        if key in ("join", "when"):  # Their keys are names of the spec, not keys of the language.
            cleaned[key] = inner
        elif key == "by_hand" and isinstance(inner, list):
            remaining_steps = [name for name in inner if name not in removed_names]
            if remaining_steps:
                cleaned[key] = remaining_steps
        else:
            cleaned[key] = without_steps(inner, removed_names)
    return cleaned


def without_removed_paths(spec_data: dict[str, Any], original_data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a spec whose errata no longer affect places that a layer has removed.

    A path that does not exist in the original data either stays, because a rule reports it.
    """
    errata = spec_data.get("errata")
    if not isinstance(errata, list):
        return spec_data
    targets = ErratumTargets(spec_data)
    original_targets = ErratumTargets(original_data)
    remaining_errata = [_erratumwithout_removed_paths(erratum, targets, original_targets) for erratum in errata]
    return {**spec_data, "errata": remaining_errata}


def _erratumwithout_removed_paths(erratum: Any, targets: ErratumTargets, original_targets: ErratumTargets) -> Any:
    """Return an erratum without the paths in ``affects`` that exist only in the original data."""
    affects = erratum.get("affects") if isinstance(erratum, dict) else None
    if not isinstance(affects, list):
        return erratum
    removed_paths = {path for path in affects if original_targets.at(path) and not targets.at(path)}
    if not removed_paths:
        return erratum
    return {**erratum, "affects": [path for path in affects if path not in removed_paths]}
