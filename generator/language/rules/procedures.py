"""Rules for procedures: each step is possible, and matches the name of its procedure."""

from __future__ import annotations

from ...model import Biss
from ..problems import DocumentReport, Path, quoted
from .walk import Spec, bank_select, by_name, has_other_bits, items, mapping, named_values

#: Access of a register that makes a kind of step impossible.
_REFUSED = {"write": "read_only", "read": "write_only", "poll": "write_only"}


def step_access(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that registers that are written are writable, and that those that are read are readable."""
    registers, groups = by_name(raw, "registers"), by_name(raw, "field_groups")
    for path, procedure in items(spec, "procedures"):
        for below, step in items(procedure, "steps"):
            register = registers.get(step.get("register", ""), {})
            access = register.get("access")
            if "field" in step and (step["do"], access) == ("write", "write_only") and has_other_bits(register, groups):
                wrong = f"{quoted(step['register'])} is write_only, so a step cannot keep its other bits"
                right = "describe it as one field with all its bits, and leave 'field' out"
                report.add("access-mismatch", (*path, *below, "field"), f"{wrong}; {right}")
            if access is not None and _REFUSED.get(step["do"]) == access:
                wrong = f"{quoted(step['register'])} is {access}, so a step cannot {step['do']} it"
                report.add("access-mismatch", (*path, *below, "register"), wrong)
    for path, register in items(spec, "registers"):
        opener = mapping(register, "opened_by").get("register")
        if registers.get(str(opener), {}).get("access") == "read_only":
            report.add(
                "access-mismatch",
                (*path, "opened_by", "register"),
                f"{quoted(opener)} is read_only, so it cannot open {quoted(register['name'])}",
            )
    for name, parameter in mapping(spec, "parameters").items():
        held_by = str(parameter.get("read_from", "")).partition(".")[0]
        if registers.get(held_by, {}).get("access") == "write_only":
            wrong = f"{quoted(held_by)} is write_only, so {quoted(name)} cannot be read from it"
            report.add("access-mismatch", ("parameters", name, "read_from"), wrong)
    for path, alarm in items(spec, "alarms"):
        held_by = str(alarm.get("register", ""))
        if registers.get(held_by, {}).get("access") == "write_only":
            wrong = f"{quoted(held_by)} is write_only, so it cannot signal {quoted(alarm['name'])}"
            report.add("access-mismatch", (*path, "register"), wrong)
    select = bank_select(spec)
    if registers.get(str(select), {}).get("access") == "read_only":
        report.add(
            "access-mismatch",
            ("interfaces", Biss.name, "bank_select"),
            f"{quoted(select)} is read_only, so it cannot select a bank",
        )


def step_waits(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure waits long enough after a write that takes time, at least before the next write."""
    registers = by_name(spec, "registers")
    for path, procedure in items(spec, "procedures"):
        steps = list(items(procedure, "steps"))
        for index, (below, step) in enumerate(steps):
            needed = registers.get(step.get("register", ""), {}).get("wait_at_least_ms")
            if step["do"] != "write" or needed is None:
                continue
            rest = steps[index + 1 :]
            end = next((at for at, (_, other) in enumerate(rest) if other["do"] == "write"), None)
            between = [other for _, other in rest[:end]]
            waits = [other["at_least_ms"] for other in between if other["do"] == "wait" and "at_least_ms" in other]
            if any(other["do"] == "poll" for other in between) or sum(waits) >= needed or (end is None and not waits):
                continue
            place, key = next(
                ((at, ("at_least_ms",)) for at, other in rest if other["do"] == "wait" and waits), (below, ())
            )
            said = f"the wait here is {sum(waits)} ms" if waits else "there is no wait here"
            wrong = f"{quoted(step['register'])} needs a wait of {needed} ms after a write, but {said}"
            report.add("wait-too-short", (*path, *place, *key), wrong)


def step_opens(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure that writes to the opener of a register writes the value that opens it."""
    registers = by_name(spec, "registers")
    for path, procedure in items(spec, "procedures"):
        steps = list(items(procedure, "steps"))
        for index, (below, step) in enumerate(steps):
            opener = mapping(registers.get(step.get("register", ""), {}), "opened_by")
            before = [other["value"] for _, other in steps[:index] if _writes(other, opener)]
            known = [opener.get("value"), *(argument["name"] for _, argument in items(procedure, "arguments"))]
            if step["do"] != "write" or not before or before[-1] in known:
                continue
            wrong = (
                f"{quoted(step['register'])} must be opened by writing {quoted(opener['value'])} to"
                f" {quoted(opener['register'])}, but {quoted(before[-1])} was written there"
            )
            report.add("not-opened", (*path, *below, "register"), wrong)


def _writes(step: Spec, opener: Spec) -> bool:
    """Return True if a step writes the register, or the field of it, that opens another register."""
    of = step["do"] == "write" and "value" in step and step.get("register", "") == opener.get("register", None)
    return of and "value" in opener and step.get("field", opener.get("field")) == opener.get("field")


def argument_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure writes each of its arguments."""
    procedures = by_name(raw, "procedures")
    for path, procedure in items(spec, "procedures"):
        # A step rejected by the schema may be the one that writes it.
        steps = [step for _, step in items(procedures.get(procedure["name"], {}), "steps")]
        written = [step.get("value") for step in steps]  # of any type, as the schema may have rejected the step
        for below, argument in items(procedure, "arguments"):
            if argument["name"] not in written:
                wrong = (
                    f"no step writes the argument {quoted(argument['name'])}; write it with"
                    f" 'value: {argument['name']}', or remove the argument"
                )
                report.add("argument-not-written", (*path, *below, "name"), wrong)


def procedure_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a procedure with the name of a command writes the value of that command to the register."""
    registers, groups = by_name(raw, "registers"), by_name(raw, "field_groups")
    for path, procedure in items(spec, "procedures"):
        name = procedure["name"]
        written: dict[str, list[tuple[Path, object]]] = {}
        for below, step in items(procedure, "steps"):
            register = registers.get(step.get("register", ""), {})
            known = named_values(register, groups, step.get("field"))
            if step["do"] == "write" and name in known and step.get("value") in known:
                written.setdefault(step["register"], []).append(((*path, *below, "value"), step["value"]))
        for register_name, steps in written.items():
            if name not in [value for _, value in steps]:
                place, value = steps[-1]
                wrong = (
                    f"the procedure {quoted(name)} has the same name as a value of {quoted(register_name)}, but writes"
                    f" {quoted(value)}; write that value, or rename the procedure"
                )
                report.add("procedure-name", place, wrong)
