"""Compiled templates, kept where Python keeps its own compiled modules: in ``__pycache__`` next to the source.

Compiled code is never read from the user's cache or from a folder for temporary files. Whoever can write to
``__pycache__`` can change the modules of this tool as well. As with modules, ``PYTHONPYCACHEPREFIX`` selects another
folder, and ``PYTHONDONTWRITEBYTECODE`` disables writing. If the folder is not writable, nothing is kept.
"""

from __future__ import annotations

import hashlib
import marshal
import os
import sys
from contextlib import suppress
from importlib.util import MAGIC_NUMBER, cache_from_source
from types import CodeType

import jinja2
from jinja2.bccache import Bucket, BytecodeCache


class CompiledTemplates(BytecodeCache):
    """Templates compiled for environments with the same options."""

    def get_cache_key(self, name: str, filename: str | None = None) -> str:
        """Return the path of the compiled template, or an empty string if it has none."""
        with suppress(NotImplementedError):  # This interpreter keeps no compiled files.
            return cache_from_source(filename, optimization="") if filename is not None else ""
        return ""

    def load_bytecode(self, bucket: Bucket) -> None:
        """Read the code of a template, unless it is damaged or was compiled from other text or by another version."""
        head = _head(bucket)
        with suppress(OSError, EOFError, ValueError, TypeError):
            with open(bucket.key, "rb") as file:
                content = file.read()
            if content.startswith(head):
                code = marshal.loads(content[len(head) :])
                bucket.code = code if isinstance(code, CodeType) else None

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Write the code of a template atomically, so that no process reads part of it."""
        if sys.dont_write_bytecode or not bucket.key or bucket.code is None:
            return
        unfinished = f"{bucket.key}.{os.getpid()}"
        with suppress(OSError):
            os.makedirs(os.path.dirname(bucket.key), exist_ok=True)
            with open(unfinished, "xb") as file:
                file.write(_head(bucket) + marshal.dumps(bucket.code))
            os.replace(unfinished, bucket.key)


def _head(bucket: Bucket) -> bytes:
    """Return the first bytes of a compiled template: the versions, the options and the text that it is made from."""
    environment = bucket.environment
    options = (
        environment.autoescape,
        environment.trim_blocks,
        environment.lstrip_blocks,
        environment.keep_trailing_newline,
    )
    fingerprint = f"{jinja2.__version__} {sys.version} {options} {bucket.checksum}"
    return MAGIC_NUMBER + hashlib.sha256(fingerprint.encode()).digest()
