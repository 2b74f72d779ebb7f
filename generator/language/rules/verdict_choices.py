"""Rules for alternatives with a default answer, and for the verdicts that depend on them."""

from __future__ import annotations

from ...model import INTERFACES
from ..problems import DocumentReport, Path, quoted
from .walk import Fields, Has, Spec, by_name, field_lists, items, mapping


def default_answers(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a default is the first answer, and that the answers set one parameter, to 0 or 1, that a flag uses."""
    used = {name for fields in field_lists(spec) for _, field in fields for name in mapping(field, "makes_position_if")}
    for path, alternative in items(spec, "alternatives"):
        if "default" not in alternative:
            continue
        answers, default = mapping(alternative, "values"), alternative["default"]
        first_answer = next(iter(answers))
        if default != first_answer:
            problem = f"the default {quoted(default)} is not the first answer of {quoted(alternative['name'])}"
            report.add("alternative-default", (*path, "default"), f"{problem}; write {quoted(first_answer)}")
            continue
        _check_settings(path, alternative, report)
        parameter = next(iter(mapping(answers, first_answer, "sets")))
        if parameter not in used:
            problem = f"no flag has {quoted(parameter)} in 'makes_position_if', so the answer changes nothing"
            report.add("alternative-default", (*path, "default"), f"{problem}; add it to a flag, or remove 'default'")


def _check_settings(path: Path, alternative: Spec, report: DocumentReport) -> None:
    """Check that the default sets the only parameter to 0, and that the other answers set it to 1."""
    for index, (name, answer) in enumerate(alternative["values"].items()):
        sets_path, settings = (*path, "values", name, "sets"), answer["sets"]
        if len(settings) > 1:
            problem = f"{quoted(alternative['name'])} has a default, so its answers set one parameter"
            report.add("alternative-default", sets_path, f"{problem}; keep one, or remove 'default'")
            return
        for parameter, value in settings.items():
            expected = int(index > 0)
            if value != expected:
                owner = "the default" if index == 0 else "an answer other than the default"
                problem = f"{quoted(name)} sets {quoted(parameter)} to {value}, but {owner} sets it to {expected}"
                report.add("alternative-default", (*sets_path, parameter), f"{problem}; write {expected}")


def verdicts_by_answer(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the other verdict of a flag differs, and that it belongs to an alternative with a default."""
    parameters, alternatives = mapping(raw, "parameters"), by_name(raw, "alternatives")
    optional = {name for name, alternative in alternatives.items() if "default" in alternative}
    for fields in field_lists(spec):
        for path, field in fields:
            for parameter, verdict in mapping(field, "makes_position_if").items():
                verdict_path = (*path, "makes_position_if", parameter)
                if mapping(parameters, parameter).get("alternative") not in optional:
                    reason = f"{quoted(parameter)} is not a parameter of an alternative with a default"
                    report.add("verdict-choice", verdict_path, f"{reason}; give it 'alternative' with the name of one")
                    continue
                problem = _no_other_verdict(fields, field, verdict)
                if problem:
                    report.add("verdict-choice", verdict_path, problem)


def _no_other_verdict(fields: Fields, field: Spec, verdict: str) -> str:
    """Return the reason that a flag has no other verdict, and the fix. Empty if it has one."""
    name, interface = quoted(field["name"]), INTERFACES.get(fields.interface)
    implied = interface.flags.get(field["name"], "") if interface is not None else ""
    default = field.get("makes_position", implied)
    if fields.kind in (Has.REGISTER, Has.CONTROL):
        return f"{name} is not in a frame, so it has no verdict on a position; remove 'makes_position_if'"
    if default not in ("not_usable", "usable_with_warning"):
        default_text = f"{quoted(default)}, which is not reported" if default else "no verdict"
        remedy = "write 'makes_position: not_usable' or usable_with_warning"
        return f"without a choice, {name} has {default_text}; {remedy}"
    if default == verdict:
        return f"with both answers, {name} makes the position {quoted(verdict)}; give one of them another verdict"
    return ""
