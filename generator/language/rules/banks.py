"""Rules for registers in banks, whose addresses are only valid after the bank has been selected."""

from __future__ import annotations

from ...model import INTERFACES
from ..problems import DocumentReport, quoted
from .walk import Fields, Has, Spec, bank_select, by_name, expanded, interface_of, items, mapping


def bank_named(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the interface of a register in a bank has banks and names the register that selects them."""
    select = bank_select(raw)
    for path, register in items(spec, "registers"):
        interface = interface_of(register)
        if "bank" not in register:
            continue
        if INTERFACES[interface].highest_in_bank is None:
            message = (
                f"{quoted(register['name'])} is in a bank, but only BiSS has a register that selects banks; leave"
                " 'bank' out, and describe in 'note' how the bank is selected"
            )
            report.add("bank-not-selected", (*path, "bank"), message, at_key=True)
        elif select is None:
            message = (
                f"{quoted(register['name'])} is in bank {register['bank']}; name the register that selects banks with"
                " 'bank_select' under 'biss'"
            )
            report.add("bank-not-selected", (*path, "bank"), message)


def bank_selected(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure selects the bank before it accesses a register in it."""
    registers, select = by_name(raw, "registers"), bank_select(raw)
    if not isinstance(select, str):
        return
    numbers = _numbers(registers.get(select, {}), raw)
    for path, procedure in items(spec, "procedures"):
        selected: object = None
        for below, step in items(procedure, "steps"):
            register = registers.get(step.get("register", ""), {})
            bank = register.get("bank")
            if step["do"] == "write" and step.get("register") == select:
                # An argument may select any bank.
                selected = numbers.get(step.get("value", ""), "any")
            elif isinstance(bank, int) and selected not in (bank, "any"):
                message = (
                    f"{quoted(step['register'])} is in bank {bank}; write {bank} to {quoted(select)} before this step"
                )
                report.add("bank-not-selected", (*path, *below, "register"), message)


def _numbers(register: Spec, raw: Spec) -> dict[str, object]:
    """Return the numbers of all named values of a register."""
    fields = expanded(Fields(Has.REGISTER, register, (), ""), by_name(raw, "field_groups"))
    numbers: dict[str, object] = {}
    for _, field in fields:
        numbers |= {name: mapping(value).get("value") for name, value in mapping(field, "values").items()}
    return numbers
