"""Rules for the parameters that are widths of fields."""

from __future__ import annotations

from ..problems import DocumentReport, quoted
from ..written_parts import WrittenSpec
from .parts import field_lists, interfaces


def widths_and_codes(spec: WrittenSpec, raw: WrittenSpec, report: DocumentReport) -> None:
    """Check that no field is as wide as a parameter that chooses between Gray and binary code."""
    layouts = [layout for _, interface in interfaces(spec) for layout in interface.layouts]
    gray_parameters = {layout.gray.when for layout in layouts if layout.gray is not None and layout.gray.when}
    for field_list in field_lists(spec):
        for field in field_list.fields:
            if str(field.bits) in gray_parameters:
                message = f"{quoted(str(field.bits))} is 1 for Gray code and 0 for binary code, so it is not a width"
                report.add("unit-mismatch", field.place_of("bits"), f"{message}; correct one of the two")
