"""Rules on procedures: a step can be carried out, and does as its procedure is called."""

from __future__ import annotations

from ..problems import DocumentReport, Path, quoted
from .walk import Spec, by_name, items, mapping, named_values

#: What a step needs of the access of its register, and the access that rules it out.
_REFUSED = {"write": "read_only", "read": "write_only", "poll": "write_only"}


def step_access(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """What a procedure writes can be written, and what it reads can be read."""
    registers = by_name(raw, "registers")
    for path, procedure in items(spec, "procedures"):
        for below, step in items(procedure, "steps"):
            access = registers.get(step.get("register", ""), {}).get("access")
            if access is not None and _REFUSED.get(step["do"]) == access:
                wrong = f"{quoted(step['register'])} is {access}, so that a step cannot {step['do']} it"
                report.add("access-mismatch", (*path, *below, "register"), wrong)
    for path, register in items(spec, "registers"):
        opener = mapping(register, "opened_by").get("register")
        if registers.get(str(opener), {}).get("access") == "read_only":
            report.add(
                "access-mismatch",
                (*path, "opened_by", "register"),
                f"{quoted(opener)} is read_only, so that nothing opens {quoted(register['name'])}",
            )
    select = mapping(spec, "interfaces", "biss").get("bank_select")
    if registers.get(str(select), {}).get("access") == "read_only":
        report.add(
            "access-mismatch",
            ("interfaces", "biss", "bank_select"),
            f"{quoted(select)} is read_only, so that it selects no bank",
        )


def procedure_name(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """A procedure that is called like a value of the register to which it writes, a command, writes that value."""
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
                    f"the procedure is called {quoted(name)}, as is a value of {quoted(register_name)}, and writes"
                    f" {quoted(value)}; write that value, or call it otherwise"
                )
                report.add("procedure-name", place, wrong)
