"""Check that an unused parameter that is named after a number and has a formula is the width of that number."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..language.problems import DocumentReport
from ..language.rules.walk import leaves
from ..language.schema_files import is_second
from ..model import Device, Interface, Layout, Parameter
from .from_mapping import Raw

_ENDING = "_bits"
_WORD = re.compile(r"[a-z][a-z0-9_]*")
#: Keys of texts in which the name of a parameter is only a word.
_PROSE = frozenset(("meaning", "note", "source", "title", "printed_name", "printed", "used", "why", "result"))


def check_named_widths(raw: Raw, device: Device, report: DocumentReport) -> None:
    """Report a parameter such as ``position_bits`` that differs from the width of ``position`` in a frame.

    Other facts would show a mistake in a formula that they use, so this checks only parameters without a use.
    """
    if is_second(report.document.file):
        return
    if report.document.family:  # An older edition may lack what uses a parameter.
        return
    used_words = set(_used_words(raw))
    for parameter in device.parameters:
        is_checked = parameter.equals is not None and parameter.name.endswith(_ENDING)
        if not is_checked or parameter.name in used_words:
            continue
        frames = ((interface, layout) for interface in device.interfaces for layout in interface.layouts)
        problem = next(filter(None, (_difference(device, parameter, *frame) for frame in frames)), "")
        if problem:
            remedy = "correct 'equals', or rename the parameter if it is another number"
            report.add("parameter-width", ("parameters", parameter.name, "equals"), f"{problem}; {remedy}")


def _used_words(raw: Raw) -> Iterator[str]:
    """Yield every word of a spec that may refer to a parameter: in an expression, a condition or a key."""
    for path, value in leaves(raw):
        keys = path[2:] if path[0] == "parameters" else path
        yield from (step for step in keys if isinstance(step, str))
        if isinstance(value, str) and path[-1] not in _PROSE:
            yield from _WORD.findall(value)


def _difference(device: Device, parameter: Parameter, interface: Interface, layout: Layout) -> str:
    """Return how the parameter differs from the width of the number in a frame, or an empty text."""
    name = parameter.name.removesuffix(_ENDING)
    if layout.sender != "encoder" or not {field.name for field in layout.fields}.issuperset(layout.names_in(name)):
        return ""
    for variant in device.variants_over(interface.name):
        placed = layout.place(variant.parameters)
        fields = placed.find_fields(layout.names_in(name))
        width, value = sum(field.width for field in fields), variant.parameters.get(parameter.name)
        if fields and value not in (None, width):
            return f"'{parameter.name}' is {value} for {variant.code}, but '{name}' in '{layout.name}' has {width} bits"
    return ""
