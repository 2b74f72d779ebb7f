"""Render parts of outputs that depend on only one family once, and store them in the cache.

Only built-in targets with default options and without the user's templates have such parts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from .cache import Cache, content_of
from .language.files import packaged_masters
from .loading.configuration import BUILT_IN
from .loading.stored import digest_of
from .model import Device
from .targets import Library, Options, Target
from .targets.registry import files_of


class FamilyParts:
    """Parts by target and model, from this run or from the cache."""

    def __init__(self, cache: Cache, only_paths: frozenset[str] = frozenset()) -> None:
        """Set the cache, and the names of families for which only the paths of files are needed, not their texts."""
        self._cache = cache
        self._only_paths = only_paths
        self._masters = content_of(sorted(packaged_masters().iterdir()))
        self._parts: dict[tuple[str, str], Any] = {}
        self._digests: dict[int, tuple[Device, str]] = {}

    def files_of(self, target: Target, library: Library, options: Options) -> Mapping[str, str]:
        """Return the files of a target like ``registry.files_of``, but render only parts that were not rendered before.

        Raises:
            TargetError: The target cannot express something, or fails.
            TemplateFault: A user's template has an error.
        """
        if target.name in BUILT_IN and options == target.defaults and library.own_templates is None:
            stored_part = partial(self._part, target.name)
            library = replace(library, stored_part=stored_part, only_paths=self._only_paths)
        return files_of(target, library, options)

    def _part(self, target_name: str, device: Device, render: Callable[[], Any]) -> Any:
        """Return the part of a target for one family, from this run or the cache, or rendered.

        A device without a digest is always rendered. Parts of families in ``only_paths`` are cached separately.
        """
        digest = self._digest_of(device)
        if not digest:
            return render()
        key = (target_name, digest)
        if key not in self._parts:
            kind = "paths" if device.name in self._only_paths else "part"
            self._parts[key] = self._from_cache(f"{kind} {target_name}", digest, render)
        return self._parts[key]

    def _from_cache(self, kind: str, digest: str, render: Callable[[], Any]) -> Any:
        """Return the part in the cache, or render and store it.

        The key also contains the descriptions of all masters.
        """
        content = [digest, *self._masters]
        stored = self._cache.get(kind, content)
        if stored is not None:
            return stored
        part = render()
        self._cache.put(kind, content, part)
        return part

    def _digest_of(self, device: Device) -> str:
        """Return the digest of a device, or "" if it has none. It is computed once for all targets.

        The device is stored with its digest, because Python would otherwise reuse its ``id`` for another device.
        """
        if id(device) not in self._digests:
            self._digests[id(device)] = (device, digest_of(device))
        _, digest = self._digests[id(device)]
        return digest
