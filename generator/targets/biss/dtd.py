"""Validation of idbiss files against a document type definition (DTD) that the user provides.

The real DTD is not public and is not part of this project.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lxml import etree

#: Size limit in bytes. It is far above the size of any DTD of this kind and prevents the reading of a wrong file.
_LARGEST_DTD = 1_000_000


class DtdError(ValueError):
    """A DTD cannot be used. The message gives the reason."""


class _OneFile(etree.Resolver):
    """A resolver that supplies the DTD for the DOCTYPE of our file, and rejects other files and the network.

    ``refused`` is the address of the first rejected file, or empty. ``answered`` is True after the DTD was supplied.
    """

    def __init__(self, path: str, text: bytes) -> None:
        super().__init__()
        self.path = path
        self.text = text
        self.refused = ""
        self.answered = False

    def resolve(self, *request: Any, **_: Any) -> Any:
        """Return the DTD for the first request, which comes from our DOCTYPE, and an empty text for any other request.

        lxml calls this method with the address, the public ID and the context. The published type stubs do not declare
        the context.
        """
        address, public_id, context = request
        supply: Any = self.resolve_string
        if not self.answered:
            self.answered = True
            return supply(self.text, context, base_url=self.path)
        # The message names the first rejected file.
        self.refused = self.refused or address or public_id or "another file"
        return supply(b"", context)


def read_dtd(path: Path) -> bytes:
    """Return the text of a DTD.

    Raises:
        DtdError: The file cannot be read or is far too large.
    """
    try:
        with path.open("rb") as file:
            # One byte more than allowed shows that the file is too large.
            text = file.read(_LARGEST_DTD + 1)
    except OSError as error:
        raise DtdError(f"{path}: {error.strerror}") from None
    if len(text) > _LARGEST_DTD:
        raise DtdError(f"{path}: too large for a document type. Is this the right file?")
    return text


def validation_errors(document: str, name: str, dtd: bytes, dtd_name: str) -> list[str]:
    """Return the errors in ``document`` according to ``dtd``, each as ``file:line: message``.

    The document is ASCII text. Entities in it are not expanded. If the parser stops without logging an error, the only
    message has no line.

    Raises:
        DtdError: The DTD itself is invalid or refers to other files.
    """
    resolver = _OneFile(dtd_name, dtd)
    parser = etree.XMLParser(
        dtd_validation=True, load_dtd=True, no_network=True, resolve_entities=False, huge_tree=False
    )
    parser.resolvers.add(resolver)
    # The message of the parser if it stops, for when it has logged none.
    syntax_error = ""
    try:
        # Called for the errors that it logs. The document itself is not needed.
        etree.fromstring(document.encode("ascii"), parser, base_url=name)
    except etree.XMLSyntaxError as error:
        syntax_error = str(error.msg)
    if resolver.refused:
        raise DtdError(
            f"{dtd_name}: refers to {resolver.refused}. Other files and the network are not read. Put everything"
            " into one file"
        )
    located_messages = []
    for logged in parser.error_log:
        message = " ".join(logged.message.split())
        if logged.filename == dtd_name:
            raise DtdError(f"{dtd_name}:{logged.line}: {message}")
        located_messages.append(f"{name}:{logged.line}: {message}")
    if not located_messages and syntax_error:
        return [f"{name}: {syntax_error}"]
    return located_messages
