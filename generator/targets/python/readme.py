"""The examples in the README and the guides: frames over each interface, and worked examples from the manuals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from math import prod

from ...model import (
    CrcExample,
    ModifyStep,
    PlacedField,
    PollStep,
    ProcedureExample,
    RegisterExample,
    Sample,
    Variant,
)
from ...model.order_codes import facts_for_code
from ...model.record import dataclass
from ...plan.values import count_factors, is_number, meaning_of
from ...say.commands_and_alarms import alarm_of, meaning
from .codec import LayoutClass
from .frame_kinds import FrameKind
from .literals import bytes_literal, frame_literal, grouped
from .names import ModuleContext, OpenQuestion
from .procedures import ProcedureFunction

#: Number of registers and number of procedures that are shown.
_SHOWN_REGISTERS, _SHOWN_PROCEDURES = 2, 2


@dataclass(frozen=True)
class ReadmeExample:
    """Example in the README: a call and its result. Values that do not apply to an example are empty.

    ``code`` is the order code, or the whole call, and ``text`` the argument of the call. ``shown`` are the expressions
    that the example prints, and ``result`` is what it prints.

    For a frame, ``has_verdict`` is True if it has a verdict. ``unusable_frame`` is the same frame with a flag that
    makes the position unusable: ``flag`` in the spec, ``flag_attribute`` in Python. ``report_name`` is the report of
    that flag. ``printed_lines`` are the lines for both frames and for one with a wrong CRC. ``kind`` is the class of
    the frame if the encoder sends several, ``position`` its position, and ``bits`` and ``digits`` describe a frame of
    bits. ``answers`` are the arguments for questions that the manual leaves open, and ``module`` has their classes.
    ``is_position_only`` is True for a frame of only flags and its position.

    ``needs_lookup`` is True if the call needs the encoder. ``interface`` is the interface of the order code, and
    ``order_code`` the order code of a procedure. ``is_rotary`` is True if the position of the encoder is an angle.
    """

    code: str
    text: str
    shown: str
    result: str
    has_verdict: bool = False
    unusable_frame: str = ""
    report_name: str = ""
    printed_lines: tuple[str, ...] = ()
    kind: str = ""
    bits: int = 0
    digits: str = ""
    needs_lookup: bool = False
    answers: str = ""
    module: str = ""
    interface: str = ""
    position: str = ""
    flag: str = ""
    flag_attribute: str = ""
    order_code: str = ""
    is_position_only: bool = False
    is_rotary: bool = False

    @property
    def fence(self) -> str:
        """The Markdown fence around ``printed_lines``, longer than any fence in these texts from the spec."""
        fence = "```"
        while any(fence in line for line in self.printed_lines):
            fence += "`"
        return fence

    @property
    def lines(self) -> tuple[str, ...]:
        """Lines that print the values of a frame, after a check of the verdict if there is one."""
        if not self.has_verdict:
            return (f"print({self.shown})",)
        return "if frame.verdict is not Verdict.NOT_USABLE:", f"    print({self.shown})"


def first_example(readmes: Sequence[Readme]) -> ReadmeExample:
    """Return the first example of the README, or an example with only an order code if no module has a frame.

    An example without open questions comes first, then one that can report an error, and then a frame of bits.
    """
    frames: list[ReadmeExample] = []
    for readme in readmes:
        frames += readme.frames
    if not frames:
        return ReadmeExample(code=readmes[0].device.variants[0].code, text="", shown="", result="")

    def preference(example: ReadmeExample) -> tuple[bool, bool, bool]:
        return not example.answers, bool(example.unusable_frame), bool(example.bits)

    return max(frames, key=preference)


def virtual_examples(readmes: Sequence[Readme]) -> dict[str, ReadmeExample]:
    """Return an example of a frame with a position over each interface, if possible one that can report an error.

    Examples with questions that the manual leaves open are left out, since programs would need answers.
    """
    example_by_interface: dict[str, ReadmeExample] = {}
    for readme in readmes:
        for example in readme.frames:
            if not example.position or example.answers:
                continue
            chosen_example = example_by_interface.setdefault(example.interface, example)
            if example.flag and not chosen_example.flag:
                example_by_interface[example.interface] = example
    return example_by_interface


class Readme:
    """Examples of one module in the README and in the guides."""

    def __init__(
        self,
        context: ModuleContext,
        kinds: Sequence[FrameKind],
        layout_classes: Mapping[str, LayoutClass],
        procedures: Mapping[str, ProcedureFunction],
    ) -> None:
        self.context = context
        self.device = context.device
        self._frame_kinds = kinds
        self._class_by_register = layout_classes
        self._procedures = procedures

    @cached_property
    def frames(self) -> list[ReadmeExample]:
        """An example of each kind of frame for which the model has a sample, with invented values.

        ``kind`` is set for kinds that a dispatching decoder distinguishes.
        """
        examples: list[ReadmeExample] = []
        for kind in self._frame_kinds:
            example = self._frame_example(kind.layout_class)
            if example is not None:
                examples.append(replace(example, kind=kind.layout_class.name if kind.dispatch else ""))
        # Users copy the first example, so it shows a frame that can report an error, if there is one.
        return sorted(examples, key=lambda example: not example.unusable_frame)

    def _frame_example(self, layout_class: LayoutClass) -> ReadmeExample | None:
        """Return an example of a frame, or None without a sample of it for a listed order code."""
        sample = self.device.sample_of(layout_class.layout)
        if sample is None:
            return None
        for variant in self.device.variants:
            if variant.code == sample.order_code:
                example = self._valid_frame(layout_class, variant, sample)
                return self._with_error(example, layout_class, variant, sample) if example.has_verdict else example
        return None

    def _valid_frame(self, layout_class: LayoutClass, variant: Variant, sample: Sample) -> ReadmeExample:
        """Return the example that decodes the sample of a frame and prints its numbers."""
        layout = layout_class.layout
        placed_layout = layout.place(variant.parameters)
        numbers = numbers_by_name(layout_class, sample)
        return ReadmeExample(
            code=variant.code,
            text=frame_literal(placed_layout, sample.frame),
            shown=", ".join(f"frame.{layout_class.names.attribute(name)}" for name in numbers),
            result=" ".join(map(str, numbers.values())),
            has_verdict=layout_class.reports is not None and bool(layout_class.reports.default_verdict),
            bits=0 if layout.in_bytes else placed_layout.bits,
            digits="" if layout.in_bytes else f"{sample.frame:0{placed_layout.bits}b}",
            answers="".join(map(self._first_answer, layout_class.questions)),
            module=self.device.name if layout_class.questions else "",
            interface=variant.interface,
            position=str(numbers.get(layout_class.position_attribute, "")),
            is_position_only=self._is_position_only(layout_class, variant.interface),
        )

    def _with_error(
        self, example: ReadmeExample, layout_class: LayoutClass, variant: Variant, sample: Sample
    ) -> ReadmeExample:
        """Return an example with an additional frame in which a flag makes the position unusable.

        The example is unchanged if the frame has no such flag. ``printed_lines`` is filled only for a frame of bits
        that has a CRC and the whole position.
        """
        if layout_class.reports is None or sample.spoilt is None:
            return example
        placed_layout = layout_class.layout.place(variant.parameters)
        spoiling_flag = placed_layout.spoiling_flags[0]
        example = replace(
            example,
            unusable_frame=frame_literal(placed_layout, sample.spoilt),
            report_name=layout_class.reports.name_of(spoiling_flag),
            flag=spoiling_flag.name,
            flag_attribute=layout_class.names.attribute(spoiling_flag.name),
        )
        crc_field = placed_layout.crc_field
        numbers = numbers_by_name(layout_class, sample)
        if crc_field is None or layout_class.layout.in_bytes or layout_class.position_attribute not in numbers:
            return example
        position = str(numbers[layout_class.position_attribute])
        flag_meaning = meaning(spoiling_flag, alarm_of(self.device, spoiling_flag))
        invalid_frame = f"invalid frame of {variant.code}: {_damaged_crc(crc_field, sample.frame)}"
        return replace(example, printed_lines=(position, flag_meaning, invalid_frame))

    def _is_position_only(self, layout_class: LayoutClass, interface: str) -> bool:
        """Return whether a frame has only flags and its position, or parts of it, as attributes."""
        position_names = map(layout_class.names.attribute, self.device.position_names(interface))
        attributes_with_value = {attribute.name for attribute in layout_class.attributes if attribute.type != "bool"}
        return attributes_with_value.issubset(position_names)

    def _first_answer(self, question: OpenQuestion) -> str:
        """Return the argument that passes the first answer to a question: ``, order=x24.Order.NORMAL``."""
        first_answer = question.alternative.answers[0]
        return f", {question.name}={self.device.name}.{question.kind}.{first_answer.name.upper()}"

    def _example_variant(self, interface_name: str) -> Variant | None:
        """Return an order code with this interface, or None if the spec lists none.

        An order code of a worked example in the manual comes first, and then the one with the largest parameters.
        """
        example_codes = [example.order_code for example in self.device.examples if not isinstance(example, CrcExample)]
        parameter_names = [parameter.name for parameter in self.device.set_parameters]

        def preference(variant: Variant) -> tuple[bool, int]:
            return variant.code in example_codes, sum(variant.parameters[name] for name in parameter_names)

        return max(self.device.variants_over(interface_name), key=preference, default=None)

    @property
    def registers(self) -> list[ReadmeExample]:
        """The first worked example of each register that has a class, for up to ``_SHOWN_REGISTERS`` registers."""
        example_by_class: dict[str, ReadmeExample] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.values and example.register in self._class_by_register:
                layout_class = self._class_by_register[example.register]
                example_by_class.setdefault(layout_class.name, _register_example(example, layout_class))
        return list(example_by_class.values())[:_SHOWN_REGISTERS]

    @property
    def procedures(self) -> list[ReadmeExample]:
        """The first ``_SHOWN_PROCEDURES`` worked examples of procedures that only write bytes."""
        procedure_examples = [example for example in self.device.examples if isinstance(example, ProcedureExample)]
        shown_examples = [
            example for example in procedure_examples if self._only_writes_bytes(self._procedures[example.procedure])
        ]
        return [self._procedure_example(example) for example in shown_examples[:_SHOWN_PROCEDURES]]

    def _only_writes_bytes(self, function: ProcedureFunction) -> bool:
        """Return whether a procedure writes single bytes, and neither modifies nor polls a register.

        Its registers must have an address for each byte.
        """
        if any(isinstance(step, (ModifyStep, PollStep)) for step in function.procedure.steps):
            return False
        return not any(self.device.register(name).is_accessed_whole for name in function.procedure.registers)

    def _procedure_example(self, example: ProcedureExample) -> ReadmeExample:
        """Return the call of a procedure, and the bytes that it writes.

        The encoder is the first argument if the procedure needs it or has no other arguments, and otherwise a keyword.
        """
        function = self._procedures[example.procedure]
        encoder = f'lookup("{example.order_code}")'
        arguments = [grouped(argument) for argument in example.arguments.values()]
        if function.takes_variant or not arguments:
            arguments.insert(0, encoder)
        else:
            arguments.append(f"variant={encoder}")
        written_bytes = bytes(write.value for write in example.writes)
        return ReadmeExample(
            code=f"{self.context.module}.{function.name}({', '.join(arguments)})",
            text="",
            shown="",
            result=repr(written_bytes.hex(" ")),
            module=self.context.module,
            interface=function.procedure.interface,
            order_code=example.order_code,
        )

    @property
    def live_example(self) -> ReadmeExample | None:
        """The example of a live line: an order code with RS-485, or None if the spec lists none.

        ``shown`` is the name of the procedure that clears the most alarms, or empty.
        """
        variant = self._example_variant("rs485")
        if variant is None:
            return None
        return ReadmeExample(
            code=variant.code,
            text="",
            shown=self._best_reset(variant),
            result="",
            module=self.context.module,
            is_rotary=self.device.movement == "rotary",
        )

    def _best_reset(self, variant: Variant) -> str:
        """Return the function without arguments that clears the most alarms of an encoder, or an empty string."""
        alarms_by_procedure: Counter[str] = Counter()
        for alarm in facts_for_code(self.device.alarms, variant.code):
            alarms_by_procedure.update(alarm.cleared_by)
        resets: list[ProcedureFunction] = []
        for function in self._procedures.values():
            is_over_interface = function.procedure.interface == variant.interface
            if is_over_interface and function.procedure.name in alarms_by_procedure and not function.arguments:
                resets.append(function)
        if not resets:
            return ""
        return max(resets, key=lambda function: alarms_by_procedure[function.procedure.name]).name

    @property
    def run_time(self) -> list[ReadmeExample]:
        """The example of a register that changes what frames look like, in a list that is empty without one.

        The register must be one byte that contains a parameter itself rather than a code for it. ``text`` is its
        address and content, such as ``0x5A: 0x0C``.
        """
        for parameter in self.device.run_time_parameters:
            register = self.device.register(parameter.register)
            field = register.layout.field(parameter.field)
            variant = self._example_variant(register.interface)
            is_whole_byte = register.length == 1 and not field.low.constant and field.widest == 8
            if variant is None or parameter.by_code or not is_whole_byte:
                continue
            name = self.context.parameters[parameter.name]
            # A value that differs from the order code shows that the register determines it.
            changed_value = max(variant.parameters[parameter.name] - 4, parameter.min or 0)
            example = ReadmeExample(
                code=variant.code,
                text=f"0x{register.address:02X}: 0x{changed_value:02X}",
                shown=f"encoder.{name}",
                result=str(changed_value),
            )
            return [example]
        return []

    @property
    def positions(self) -> list[ReadmeExample]:
        """The calls that convert and unwrap a position of the first order code, with their results.

        The list is empty if the number of counts after which the position wraps around is unknown or too small.
        """
        variant = self.device.variants[0]
        measurement = self.device.measurement_of(variant.interface)
        if measurement is None:
            return []
        factors = [factor.value(variant.parameters) for factor in count_factors(measurement)]
        modulus = prod(factors) if factors else 0
        # The example unwraps from modulus - 2 to 3, by 5 counts. In a small range, the way back is as short.
        if modulus <= 2 * 5:
            return []
        calls: list[tuple[str, str]] = []
        step_um = measurement.micrometres(variant.parameters)
        if measurement.counts_per_turn is not None:
            counts_per_turn = measurement.counts_per_turn.value(variant.parameters)
            quarter_turn = counts_per_turn // 4
            calls.append((f"encoder.degrees({quarter_turn})", str(quarter_turn * 360 / counts_per_turn)))
        elif step_um is not None:
            calls.append(("encoder.millimetres(1000)", repr(float(step_um))))
        calls.append((f"encoder.unwrap({modulus - 2}, 3)", str(modulus + 3)))
        return [ReadmeExample(code=variant.code, text=call, shown="", result=result) for call, result in calls]

    @property
    def identified(self) -> list[ReadmeExample]:
        """The example that identifies an order code from its registers, in a list that is empty without one.

        The order code is that of the first worked example of an identifying register. ``text`` contains the examples
        of its registers as items of a dict, such as ``"model": bytes.fromhex("1B")``.
        """
        identity_registers = {register.name for register, _ in self.device.identity}
        register_examples: dict[str, RegisterExample] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.register in identity_registers:
                register_examples.setdefault(example.register, example)
        order_codes = [example.order_code for example in register_examples.values()]
        listed_codes = {variant.code for variant in self.device.variants}
        if not order_codes or order_codes[0] not in listed_codes:
            return []
        contents = []
        for example in register_examples.values():
            if example.order_code == order_codes[0]:
                contents.append(f'"{example.register}": {bytes_literal(example.bytes)}')
        return [ReadmeExample(code=order_codes[0], text=", ".join(contents), shown="", result="True")]


def _is_number_of(layout_class: LayoutClass, name: str) -> bool:
    """Return whether a name in a frame belongs to a number, which several fields can form (a join).

    The field by which frames differ (the selector) does not count.
    """
    layout = layout_class.layout
    if any(join.name == name for join in layout.joins):
        return True
    field = layout.field(name)
    return is_number(meaning_of(field)) and not layout_class.selects(field)


def _damaged_crc(crc_field: PlacedField, number: int) -> str:
    """Return the message for a frame whose last bit, which is bit 0 of its CRC, is inverted.

    An example is ``expected CRC 0x13, got 0x12``.
    """
    received = (number ^ 1) & crc_field.mask
    expected = received ^ 1
    return f"expected CRC {expected:#04x}, got {received:#04x}"


def numbers_by_name(layout_class: LayoutClass, sample: Sample) -> dict[str, object]:
    """Return the numbers in a sample frame by name, without the field by which frames differ (the selector)."""
    return {name: value for name, value in sample.values.items() if _is_number_of(layout_class, name)}


def _register_example(example: RegisterExample, layout_class: LayoutClass) -> ReadmeExample:
    """Return the example that decodes a register and prints its attributes.

    In the worked example, a named value is the lowercase name of an Enum member.
    """
    variant_argument = f', lookup("{example.order_code}")' if layout_class.takes_variant else ""
    types = {attribute.name: attribute.type for attribute in layout_class.attributes}
    expressions, printed_values = [], []
    for name, value in example.values.items():
        attribute = layout_class.names.attribute(name)
        if isinstance(value, str) and types.get(attribute) != "str":
            expressions.append(f"register.{attribute}.name")
            printed_values.append(repr(value.upper()))
        else:
            expressions.append(f"register.{attribute}")
            printed_values.append(repr(value))
    return ReadmeExample(
        code=f"{layout_class.name}.decode({bytes_literal(example.bytes)}{variant_argument})",
        text="",
        shown=_tuple_expression(expressions),
        result=_tuple_expression(printed_values),
        needs_lookup=layout_class.takes_variant,
    )


def _tuple_expression(expressions: Sequence[str]) -> str:
    """Return expressions as a tuple, or the only expression alone."""
    return f"({', '.join(expressions)})" if len(expressions) != 1 else expressions[0]
