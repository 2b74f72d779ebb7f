"""Check that procedures do not change limits in ways that generated code does not follow."""

from __future__ import annotations

from collections.abc import Iterator

from ..language.problems import DocumentReport, quoted
from ..model import Argument, Device, ModifyStep, Parameter, Procedure, Step, WriteStep


def check_limits_in_procedures(device: Device, report: DocumentReport) -> None:
    """Report a step that changes the limit of a later argument, unless it writes an argument to the whole register.

    Only for such a write do the generated procedures check the later argument with the written value.
    """
    for procedure in device.procedures:
        for index, step in enumerate(procedure.steps):
            changed_names = {parameter.name for parameter in _parameters_changed_unseen(device, step)}
            if not changed_names:
                continue
            for argument in _arguments_written(procedure, procedure.steps[index + 1 :]):
                limiting_names = _limiting_names(device, argument) & changed_names
                if limiting_names:
                    effect = f"this changes {quoted(min(limiting_names))}, which limits the later argument"
                    remedy = "write an argument to the whole register, or make two procedures of the steps"
                    message = f"{effect} {quoted(argument.name)}; {remedy}"
                    report.add("limit-changed", ("procedures", procedure.name, "steps", index), message)
                    break


def _limiting_names(device: Device, argument: Argument) -> set[str]:
    """Return the names of the parameters on which the lowest or highest value of an argument depends."""
    limiting_names: set[str] = set()
    for limit in device.limits(device.register(argument.of), argument.meant_as):
        limiting_names.update(limit.parameters if limit is not None else ())
    return limiting_names


def _parameters_changed_unseen(device: Device, step: Step) -> Iterator[Parameter]:
    """Yield the run-time parameters that a step changes by writing their field, or a fixed value to their register."""
    for parameter in device.run_time_parameters:
        match step:
            case ModifyStep() if (step.register, step.field) == (parameter.register, parameter.field):
                yield parameter
            case WriteStep() if step.register == parameter.register and step.value is not None:
                yield parameter
            case _:
                pass


def _arguments_written(procedure: Procedure, steps: tuple[Step, ...]) -> Iterator[Argument]:
    """Yield the arguments that steps write. A value that is not an argument is reported elsewhere."""
    arguments = {argument.name: argument for argument in procedure.arguments}
    for step in steps:
        if isinstance(step, WriteStep | ModifyStep) and step.value is None and step.value_name in arguments:
            yield arguments[step.value_name]
