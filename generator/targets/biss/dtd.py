"""Validation of idbiss files against a document type that the user has: the real one is not public, and is not part of
this project."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree

#: Far above any document type of this kind; it keeps a wrong file from being read at all.
_LARGEST = 1_000_000


class DtdError(ValueError):
    """The document type cannot be used; the message says why."""


class _OneFile(etree.Resolver):
    """Answers the DOCTYPE of our file with one text; refuses whatever else is asked for: other files, the network."""

    def __init__(self, path: str, text: bytes) -> None:
        super().__init__()
        self.path, self.text, self.refused = path, text, ""
        self.answered = False

    def resolve(self, *request: Any, **_: Any) -> Any:
        """Called with the address, the public ID, and a context that the answer needs.

        The published types know of no context.
        """
        address, public_id, context = request
        answer: Any = self.resolve_string
        if not self.answered:
            self.answered = True
            return answer(self.text, context, base_url=self.path)
        self.refused = self.refused or address or public_id or "another file"
        return answer(b"", context)


def read_dtd(path: Path) -> bytes:
    """The text of a document type.

    Raises:
        DtdError: It cannot be read, or is far too large.
    """
    try:
        with path.open("rb") as file:
            text = file.read(_LARGEST + 1)
    except OSError as error:
        raise DtdError(f"{path}: {error.strerror}") from None
    if len(text) > _LARGEST:
        raise DtdError(f"{path}: larger than any document type; is this the right file?")
    return text


def faults(document: str, name: str, dtd: bytes, dtd_name: str) -> list[str]:
    """What the document type ``dtd`` finds wrong with ``document``, each as ``file:line: message``.

    Entities are not expanded into the document.

    Raises:
        DtdError: The document type itself is broken, or wants other files.
    """
    resolver = _OneFile(dtd_name, dtd)
    parser = etree.XMLParser(
        dtd_validation=True, load_dtd=True, no_network=True, resolve_entities=False, huge_tree=False
    )
    parser.resolvers.add(resolver)
    broken = ""
    try:
        etree.fromstring(document.encode("ascii"), parser, base_url=name)
    except etree.XMLSyntaxError as error:
        broken = str(error.msg)
    if resolver.refused:
        raise DtdError(
            f"{dtd_name}: refers to {resolver.refused}; other files and the network are not read, so put all"
            " into one file"
        )
    found = []
    for entry in parser.error_log:
        message = " ".join(entry.message.split())
        if entry.filename == dtd_name:
            raise DtdError(f"{dtd_name}:{entry.line}: {message}")
        found.append(f"{name}:{entry.line}: {message}")
    return found or ([f"{name}: {broken}"] if broken else [])
