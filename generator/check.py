"""Checking: the schema, then every rule, all problems in one go."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from .problems import DocumentReport, Path, Report
from .rules import FOUNDATIONS, RULES, SHAPES
from .rules.master import check_master
from .rules.order_code import is_whole
from .schema import Checked, check_schema, holder, without

if TYPE_CHECKING:
    from .read import Document

#: What stands for keys at the top that are missing, so that the rest can be built and looked at.
_STAND_INS: dict[str, Any] = {
    "title": "",
    "movement": "rotary",
    "manufacturer": "",
    "manual": {"title": "", "revision": "", "language": "en"},
    "interfaces": {},
}
_NO_CODES: dict[str, Any] = {"parameters": {}, "order_code": {"pattern": "", "parts": []}}


def check_document(document: Document, report: Report) -> dict[str, Any] | None:
    """Checks a document and adds what is wrong with it to ``report``.

    Returns:
        The data without what is at fault: it can be built, as far as it goes, to find what else is wrong. Of a device
        whose order codes or parameters are at fault both are empty. None where nothing can be built.
    """
    checked = check_schema(document, report)
    if checked is None:
        return None
    if checked.kind == "device":
        return _check_device(checked, document, report)
    before = len(report)
    if checked.kind == "master":
        check_master(checked.data, report.for_document(document))
    return checked.data if checked.complete and len(report) == before else None


class _Noting(DocumentReport):
    """Notes the places of which a rule speaks."""

    def __init__(self, report: Report, document: Document) -> None:
        super().__init__(report, document)
        self.noted: list[Path] = []

    def add(self, rule: str, path: Path, message: str, *, at_key: bool = False) -> None:
        self.noted.append(self.document.original(path))
        super().add(rule, path, message, at_key=at_key)


def _check_device(checked: Checked, document: Document, report: Report) -> dict[str, Any]:
    codes = is_whole(checked.data, document.data)
    report.mark(document, checked.cut)
    cut = set(checked.cut)
    for rule in RULES:
        about = _Noting(report, document)
        rule(checked.data, document.data, about)
        if rule in FOUNDATIONS:
            codes = codes and not any(path[0] in _NO_CODES for path in about.noted)
        if rule in SHAPES:
            cut |= set(map(holder, about.noted))
    data = without(document, cut, checked.given) if cut != checked.cut else checked.data
    return _whole(data, codes, document)


def _whole(data: dict[str, Any], codes: bool, document: Document) -> dict[str, Any]:
    """The data with stand-ins for what is missing at the top and at the top of an interface."""
    whole = {"device": PurePath(document.file).stem, **_STAND_INS, **data, **({} if codes else _NO_CODES)}
    whole["interfaces"] = {kind: {"layouts": [], **item} for kind, item in whole["interfaces"].items()}
    return whole
