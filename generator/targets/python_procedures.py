"""Procedures in Python source: functions that give the steps for an order code and arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Argument, Procedure, Register, RegisterMeaning, Step, cite
from ..words import sentence
from .python_encode import depends_on_variant
from .python_expressions import FUNCTIONS, class_names, interface_name, meaning_limits, moved_left
from .python_source import (
    WIDTH, Call, Code, attribute, call, docstring, expression, grouped, literal, operand, quoted, used_names,
)
from .python_views import Codec, Enumeration, Function

if TYPE_CHECKING:
    from .python_module import Module

#: What the functions call; an argument of such a name gets a trailing underscore.
_USED = (*FUNCTIONS, "isinstance", "variant")


def byte_order(register: Register) -> str:
    """The byte order of a register as Python calls it."""
    return "little" if register.byte_order == "low_byte_first" else "big"


class ProcedureBuilder:
    """Builds the function of one procedure."""

    def __init__(self, module: Module, procedure: Procedure) -> None:
        self.module = module
        self.procedure = procedure
        self.names = {item.name: attribute(item.name, _USED) for item in procedure.arguments}

    def build(self) -> Function:
        item = self.procedure
        checks = tuple(line for argument in item.arguments for line in self._checks(argument))
        steps = tuple(map(self._step, item.steps))
        takes_variant = any("variant" in used_names(line) for line in (*checks, *steps)) or any(self._takes_variant(argument.of) for argument in item.arguments)
        arguments = [f"{self.names[entry.name]}: {self._type(entry)}" for entry in item.arguments]
        if takes_variant:
            arguments.insert(0, "variant: Variant")
        else:
            arguments += ["*"] * bool(arguments) + ["variant: Variant | None = None"]
        listed = [(self.names[entry.name], sentence(entry.meaning or f"Value for {entry.of}")) for entry in item.arguments]
        only_checked = "The encoder, to be checked; the steps are the same for all of the family."
        encoder = ("variant", "The encoder." if takes_variant else only_checked)
        raises = [("RangeError", "An argument is outside the limits of its register.")] if listed else []
        raises.append(("FamilyError", "The encoder is of another family."))
        raises.append(("InterfaceError", "The encoder has another interface."))
        doc = docstring(
            sentence(f"{item.title} ({cite(item.source)})"),
            sentence(f"Before: {item.precondition}") if item.precondition else "",
            sentence(f"After: {item.result}") if item.result else "",
            sentence(item.note),
            *self.module.erratum_paragraphs(self.module.errata(f"procedures.{item.name}")),
            ("Args", [encoder, *listed] if takes_variant else [*listed, encoder]),
            ("Raises", raises),
            indent=4,
        )
        name = self.module.functions_taken[item.name]
        signature = f"def {name}({', '.join(arguments)}) -> tuple[Step, ...]:"
        if len(signature) > WIDTH:
            signature = f"def {name}(\n" + "".join(f"    {item},\n" for item in arguments) + ") -> tuple[Step, ...]:"
        return Function(name, signature, doc, interface_name(item.interface), not takes_variant, checks, steps)

    # ---------------------------------------------------------------------------------------------------------------- arguments

    def _written_by(self, argument: Argument) -> list[Step]:
        return [item for item in self.procedure.steps if item.do == "write" and item.value is None and item.value_name == argument.name]

    def _type(self, argument: Argument) -> str:
        register = self.module.device.register(argument.of)
        whole = any(not step.field and step.register == register.name for step in self._written_by(argument)) and self._is_whole(register)
        return f"{self._view(register.name).name} | int" if whole else "int"

    def _is_whole(self, register: Register) -> bool:
        """Whether a value for the register is that of all its fields together."""
        view = self._view(register.name)
        return isinstance(view, Codec) and not self._bounded(register, view) and not self._is_one_number(register)

    @staticmethod
    def _is_one_number(register: Register) -> bool:
        data = register.layout.data_fields
        return len(data) == 1 and data[0].kind == "number" and data[0].width == register.layout.bits

    @staticmethod
    def _bounded(register: Register, view: Codec) -> str:
        """The attribute or join that the value is given for, where it is only one."""
        name = attribute(register.limits_of, class_names(register.layout, register))
        return name if name in [*(item.name for item in view.attributes), *(item.name for item in view.joins)] else ""

    def _checks(self, argument: Argument) -> list[str]:
        """Statements that refuse a wrong argument where writing it would not."""
        name = self.names[argument.name]
        found = []
        meaning = self._meaning(argument)
        if meaning is not None and (meaning.min is not None or meaning.max is not None):
            view = self._view(argument.of)
            found.append(f'check_limits("{argument.name}", {name}, {view.name}.{meaning_limits(meaning)}({"variant" if depends_on_variant(meaning) else ""}))')
        for step in self._written_by(argument):
            register = self.module.device.register(step.register)
            if step.field:
                width = self._text(register.layout.field(step.field).width)
                found.append(f'{name} = check_width("{argument.name}", {name}, {width})')
            elif self._is_whole(register) and (register.min is not None or register.max is not None) and meaning is None:
                low = self._text(register.min or Expression(0))
                high = self._text(register.max) if register.max is not None else f"0x{(1 << 8 * register.length) - 1:X}"
                view = self._view(argument.of)
                found.append(f"if not isinstance({name}, {view.name}):")
                found.append(f'    check_limits("{argument.name}", {name}, ({low}, {high}))')
        return list(dict.fromkeys(found))

    def _meaning(self, argument: Argument) -> RegisterMeaning | None:
        register = self.module.device.register(argument.of)
        return next((item for item in register.meanings if item.name == argument.meant_as), None)

    def _takes_variant(self, register: str) -> bool:
        view = self._view(register)
        return isinstance(view, Codec) and view.takes_variant

    def _view(self, register: str) -> Codec | Enumeration:
        return next(item for item in self.module.registers if item.name == self.module.classes[f"register {register}"])

    def _text(self, value: Expression) -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.module.parameter_names, "variant")

    # -------------------------------------------------------------------------------------------------------------------- steps

    def _step(self, step: Step) -> str:
        meaning: tuple[tuple[str, str], ...] = (("", step.meaning),) if step.meaning else ()
        if step.do == "wait":
            return literal(Call("Wait", (("", step.microseconds), *meaning)), 8, 8, 1)
        if step.do == "send":
            return literal(call("Send", step.request, times=step.times, every_us=step.microseconds or None, meaning=step.meaning), 8, 8, 1)
        register = self.module.device.register(step.register)
        address = Code(f"Address.{register.name.upper()}")
        place: tuple[tuple[str, Code | int | str], ...] = (("", address), ("", register.length), ("", register.name))
        if step.do == "read":
            return literal(Call("Read", (*place, *meaning)), 8, 8, 1)
        if step.do == "poll" or step.field:
            mask, value = self._bits(step, register)
            order = (("order", byte_order(register)),) if register.length > 1 else ()
            bits = (("", Code(mask)), ("", Code(value)))
            return literal(Call("Poll" if step.do == "poll" else "Modify", (*place, *bits, *meaning, *order)), 8, 8, 1)
        return literal(Call("*writes", (("", register.name), ("", address), ("", Code(self._written(step, register))), *meaning)), 8, 8, 1)

    def _bits(self, step: Step, register: Register) -> tuple[str, str]:
        """Mask and value of a step that touches one field only."""
        item = register.layout.field(step.field)
        low, width = self._text(item.low), self._text(item.width)
        if item.low.is_constant and item.width.is_constant:
            mask = f"0x{((1 << item.width.constant) - 1) << item.low.constant:02X}"
        else:
            mask = moved_left(f"((1 << {operand(width)}) - 1)", low)
        if step.value is None:
            return mask, moved_left(self.names[step.value_name], low)
        return mask, f"0x{step.value << item.low.constant:02X}" if item.low.is_constant else moved_left(str(step.value), low)

    def _written(self, step: Step, register: Register) -> str:
        """The bytes that a step writes into the whole register."""
        view = self._view(register.name)
        order = byte_order(register)
        if step.value is not None:
            if isinstance(view, Enumeration):
                return f"{view.name}.{step.value_name.upper()}.encode()"
            return quoted(step.value.to_bytes(register.length, "little" if order == "little" else "big"))
        argument = self.names[step.value_name]
        if isinstance(view, Enumeration):
            return f'choice({view.name}, "{argument}", {argument}).encode()'
        if self._is_whole(register):
            return f'whole("{step.value_name}", {view.name}, {argument}, {register.length}, "{order}")'
        first = "variant, " if view.takes_variant else ""
        bounded = self._bounded(register, view) or view.attributes[0].name
        if any(item.name == bounded for item in view.joins):
            return f"{view.name}.from_{bounded}({first}{argument}).encode()"
        return f"{view.name}({first}{bounded}={argument}).encode()"
