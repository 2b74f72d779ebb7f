"""Rule for procedures that save parameters before they write them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ..problems import DocumentReport, quoted
from ..second_reading import is_second
from .walk import Spec, by_name, items

_SAVE = re.compile(r"(?:save|store|burn)(?:_.*)?")


def saved_before_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure writes its arguments before it saves, unless a note of the procedure explains it."""
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    registers = by_name(raw, "registers")
    for path, procedure in items(spec, "procedures"):
        if "note" in procedure:
            continue
        arguments = {argument["name"] for _, argument in items(procedure, "arguments")}
        writes = [(below, step) for below, step in items(procedure, "steps") if step["do"] == "write"]
        is_saved = [step.get("register") in registers and _is_save(step) for _, step in writes]
        for index, (below, save) in enumerate(writes):
            later = [step for _, step in writes[index + 1 :] if step.get("register") != save.get("register")]
            if not is_saved[index] or any(is_saved[index + 1 :]):
                continue
            unsaved = _first_unsaved(later, arguments, registers)
            if unsaved:
                problem = f"this step saves before {quoted(unsaved)} is written, so that value is lost at power-off"
                remedy = "move this step behind the write, or explain the order in a 'note' of the procedure"
                report.add("saved-too-early", (*path, *below), f"{problem}; {remedy}")


def _is_save(step: Spec) -> bool:
    """Return whether a step writes a value that is called save, store or burn."""
    return _SAVE.fullmatch(str(step.get("value", ""))) is not None


def _first_unsaved(later: Iterable[Spec], arguments: set[str], registers: dict[str, Spec]) -> str:
    """Return the first register that later steps write with an argument, or an empty text. Not a volatile one."""
    for step in later:
        name = str(step.get("register", ""))
        if step.get("value") in arguments and name in registers and not registers[name].get("volatile"):
            return name
    return ""
