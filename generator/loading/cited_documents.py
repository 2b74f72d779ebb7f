"""Check documents that several specs of a manufacturer cite, and specs that cite the manual of another spec."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePath

from ..language.document import Document
from ..language.problems import ProblemReport, quoted
from ..language.rules.manual import problems_of_other_manual
from ..language.rules.walk import leaves, mapping, sources
from ..language.written_parts import WrittenManual, WrittenSpec

#: A number in the title or address of a document, but not in a name such as ABC21.
_NUMBER_IN_REFERENCE = re.compile(r"(?<![A-Za-z0-9])\d+")
_DIGITS = re.compile(r"\d+")
_MEMBERS = ("title", "url")


def compare_documents(specs: Sequence[Document], report: ProblemReport) -> None:
    """Report a document whose title or address differs from one under the same key in another spec, only in numbers.

    Several specs of a manufacturer cite the same document, such as a standard. Another document has other words. If the
    title or the address is the same, numbers in names are compared too.
    """
    first_spec_by_words: dict[tuple[str, ...], Document] = {}
    for spec in sorted(specs, key=lambda spec: spec.file):
        for key in mapping(spec.data, "documents"):
            texts = _texts_of_document(spec, key)
            title, url = texts.values()
            first_specs: list[Document] = []
            for words in (
                (key, *(_NUMBER_IN_REFERENCE.sub("0", text) for text in texts.values())),
                (key, title, _DIGITS.sub("0", url)),
                (key, _DIGITS.sub("0", title), url or spec.file),
            ):
                first_specs.append(first_spec_by_words.setdefault(words, spec))
            _report_other_numbers(spec, key, first_specs, report)


def _texts_of_document(spec: Document, key: str) -> dict[str, str]:
    """Return the title and the address of a document. The address is empty if it has none."""
    document = mapping(spec.data, "documents", key)
    return {member: str(document.get(member, "")) for member in _MEMBERS}


def _report_other_numbers(spec: Document, key: str, first_specs: Sequence[Document], report: ProblemReport) -> None:
    """Report the title and the address of a document that differ from those in one of the first specs with it."""
    for member, text in _texts_of_document(spec, key).items():
        for first_spec in first_specs:
            first_text = _texts_of_document(first_spec, key)[member]
            if text == first_text:
                continue
            line, _ = first_spec.position(("documents", key, member))
            message = (
                f"only a number differs from {quoted(first_text)} in {PurePath(first_spec.file).name}:{line};"
                f" correct one of the two, or give one of the documents another key"
            )
            report.add("not-alike", spec, ("documents", key, member), message)
            break


def check_cited_manuals(specs: Sequence[Document], report: ProblemReport) -> None:
    """Check the sections and pages that a spec cites in the manual of another spec of the same manufacturer.

    The key of this document is the name of the other device, and its title contains the title and the revision of the
    manual. A title that differs from the manual's only in numbers is reported.
    """
    documents_by_device = {str(spec.data["device"]): spec for spec in specs}
    for spec in specs:
        for key in mapping(spec.data, "documents"):
            other_spec = documents_by_device.get(key)
            if other_spec is None or other_spec is spec:
                continue
            manual = WrittenSpec(other_spec.data).manual
            title = _texts_of_document(spec, key)["title"]
            if manual.title not in title:
                _report_other_title(spec, key, title, other_spec, report)
            elif re.search(rf"(?<![\w.]){re.escape(manual.revision)}(?![\w.]*\w)", title) and manual.contents:
                _check_citations(spec, key, manual, report)


def _report_other_title(spec: Document, key: str, title: str, other_spec: Document, report: ProblemReport) -> None:
    """Report a title of a document that differs from the title of the manual in another spec only in numbers."""
    manual_title = str(mapping(other_spec.data, "manual").get("title", ""))
    if _DIGITS.sub("0", manual_title) in _DIGITS.sub("0", title):
        line, _ = other_spec.position(("manual", "title"))
        message = (
            f"only a number differs from the manual's title {quoted(manual_title)} in"
            f" {PurePath(other_spec.file).name}:{line}; correct one of the two, or give the document another key"
        )
        report.add("not-alike", spec, ("documents", key, "title"), message)


def _check_citations(spec: Document, key: str, manual: WrittenManual, report: ProblemReport) -> None:
    """Report each section or page that a spec cites in another manual, and that this manual does not have there."""
    for path, source in sources(leaves(spec.data)):
        for problem in problems_of_other_manual(source, key, manual.contents):
            report.add("cited-place", spec, path, f"{key}: {problem}")
