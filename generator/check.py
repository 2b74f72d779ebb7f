"""Checking: the schema, then every rule, all problems in one go."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .problems import Report
from .rules import FOUNDATIONS, RULES
from .rules.master import check_master
from .rules.order_code import is_whole
from .schema import check_schema

if TYPE_CHECKING:
    from .read import Document


def check_document(document: Document, report: Report) -> dict[str, Any] | None:
    """Checks a document and adds what is wrong with it to ``report``.

    Returns:
        The data without what the schema refuses: every part of it has the shape that the schema says. None where nothing can be built
        from it: a key at the top is missing, or parameters, order codes, field widths or CRCs are at fault.
    """
    checked = check_schema(document, report)
    if checked is None:
        return None
    sound = checked.complete
    if checked.kind == "device":
        sound = sound and is_whole(checked.data, document.data)
        rules_report = report.for_document(document)
        for rule in RULES:
            before = len(report)
            rule(checked.data, document.data, rules_report)
            sound = sound and (rule not in FOUNDATIONS or len(report) == before)
    if checked.kind == "master":
        before = len(report)
        check_master(checked.data, report.for_document(document))
        sound = sound and len(report) == before
    return checked.data if sound else None
