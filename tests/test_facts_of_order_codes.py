"""Every module that reads facts with ``only`` selects the facts of its order codes, or shows the codes next to them."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

GENERATOR = Path(__file__).parent.parent / "generator"
#: Members of the model whose items have ``only``.
RESTRICTED = {
    "alarms",
    "cable_lengths",
    "characteristics",
    "clocks",
    "contacts",
    "errata",
    "leds",
    "timeouts",
    "timings",
}

#: Modules that read them, by the reason why no order code gets the fact of another.
READERS = {
    "keeps those of the order code, with facts_for_code or applies_to_code": {
        "model/interfaces.py",
        "targets/c/code_facts.py",
        "masters/encoder_facts.py",
        "masters/order_code_facts.py",
        "order_codes/reduction.py",
        "targets/python/readme.py",
    },
    "reads a device that reduced_to_codes has reduced to the order codes": {
        "commands/show/text.py",
        "targets/c/single.py",
        "targets/docs/order_code_page.py",
        "targets/docs/verdict_table.py",
    },
    "finds the alarm of a flag, which has the same only, and callers treat the flag of other codes as unexplained": {
        "say/commands_and_alarms.py",
        "targets/docs/verdict_page.py",
    },
    "needs only names, links or procedures, which do not depend on the order code": {
        "reference/registers.py",
        "targets/docs/cross_family_pages.py",
        "targets/docs/interface_page.py",
        "targets/docs/links_and_errata.py",
    },
    "builds the family, or passes its facts to one of the others": {
        "loading/order_code_facts.py",
        "loading/history.py",
        "loading/library.py",
        "loading/overlays.py",
        "loading/whole_frame_checks.py",
        "loading/spec_parts.py",
    },
    "reads the errata of a cable table, which the record has chosen": {
        "masters/text.py",
        "targets/docs/masters_page.py",
    },
    "plays an encoder whose user sets the flags": {
        "virtual/encoder.py",
        "virtual/memory.py",
    },
    "compares a length with those of the frames of all order codes": {"loading/repeated_facts.py"},
    "denies something only if no fact of any order code mentions it": {
        "say/names_and_evidence.py",
        "targets/docs/wiring_tables.py",
    },
    "shows the order codes beside each fact": {
        "targets/c/variants.py",
        "targets/c/single_text.py",
        "targets/c/worked_examples.py",
        "changes/families.py",
        "changes/interfaces.py",
        "dump/plain.py",
        "readings/interfaces.py",
        "readings/surroundings.py",
        "say/errata.py",
        "say/order_code.py",
        "say/names_and_evidence.py",
        "targets/c/device.py",
        "targets/c/package.py",
        "targets/c/interfaces.py",
        "targets/docs/wiring_tables.py",
        "targets/docs/page_pictures.py",
        "targets/docs/cross_family_pages.py",
        "targets/docs/family_pages.py",
        "targets/docs/order_code_page.py",
        "targets/docs/links_and_errata.py",
        "targets/docs/interface_page.py",
        "targets/docs/fact_tables.py",
        "targets/docs/timing_pictures.py",
    },
}


def readers() -> dict[str, set[str]]:
    """Return the restricted members that each module reads."""
    readers_by_module: dict[str, set[str]] = {}
    for path in sorted(GENERATOR.rglob("*.py")):
        if "rules" in path.parts:  # Rules check a whole spec, with the facts of all order codes.
            continue
        text = path.read_text(encoding="utf-8")
        if not any(f".{name}" in text for name in RESTRICTED):
            continue
        tree = ast.parse(text)
        names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)} & RESTRICTED
        if names:
            readers_by_module[str(path.relative_to(GENERATOR))] = names
    return readers_by_module


@pytest.mark.slow
def test_every_reader_is_known() -> None:
    listed = {module for modules in READERS.values() for module in modules}
    assert {module: names for module, names in readers().items() if module not in listed} == {}
    assert listed <= readers().keys()
