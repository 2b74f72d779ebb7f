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
from .names import DeviceNames, OpenQuestion
from .procedures import ProcedureFunction

#: Number of registers and number of procedures that are shown.
_SHOWN_REGISTERS, _SHOWN_PROCEDURES = 2, 2


@dataclass(frozen=True)
class ReadmeExample:
    """Example in the README: a call and its result. Values that do not apply to an example are empty.

    ``code`` is the order code, or the whole call, and ``argument`` the argument of the call. ``printed_expressions``
    are the expressions that the example prints, and ``printed_text`` is what it prints.

    For a frame, ``has_verdict`` is True if it has a verdict. ``unusable_frame`` is the same frame with a flag that
    makes the position unusable: ``flag`` in the spec, ``flag_attribute`` in Python. ``report_name`` is the report of
    that flag. ``printed_lines`` are the lines for both frames and for one with a wrong CRC. ``frame_class`` is the
    class of the frame if the encoder sends several, ``position`` its position, and ``bits`` and ``digits`` describe a
    frame of bits. ``answers`` are the arguments for questions that the manual leaves open, and ``module`` has their
    classes. ``is_position_only`` is True for a frame of only flags and its position.

    ``needs_lookup`` is True if the call needs the encoder. ``interface`` is the interface of the order code, and
    ``order_code`` the order code of a procedure. ``is_rotary`` is True if the position of the encoder is an angle.
    """

    code: str
    argument: str = ""
    printed_expressions: str = ""
    printed_text: str = ""
    has_verdict: bool = False
    unusable_frame: str = ""
    report_name: str = ""
    printed_lines: tuple[str, ...] = ()
    frame_class: str = ""
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
            return (f"print({self.printed_expressions})",)
        return "if frame.verdict is not Verdict.NOT_USABLE:", f"    print({self.printed_expressions})"


def first_example(readmes: Sequence[Readme]) -> ReadmeExample:
    """Return the first example of the README, or an example with only an order code if no module has a frame.

    An example without open questions comes first, then one that can report an error, and then a frame of bits.
    """
    frame_examples: list[ReadmeExample] = []
    for readme in readmes:
        frame_examples += readme.frame_examples
    if not frame_examples:
        return ReadmeExample(
            code=readmes[0].device.variants[0].code,
        )

    def preference(example: ReadmeExample) -> tuple[bool, bool, bool]:
        return not example.answers, bool(example.unusable_frame), bool(example.bits)

    return max(frame_examples, key=preference)


def virtual_examples(readmes: Sequence[Readme]) -> dict[str, ReadmeExample]:
    """Return an example of a frame with a position over each interface, if possible one that can report an error.

    Examples with questions that the manual leaves open are left out, since programs would need answers.
    """
    example_by_interface: dict[str, ReadmeExample] = {}
    for readme in readmes:
        for example in readme.frame_examples:
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
        device_names: DeviceNames,
        frame_kinds: Sequence[FrameKind],
        class_by_register: Mapping[str, LayoutClass],
        function_by_procedure: Mapping[str, ProcedureFunction],
    ) -> None:
        self.device_names = device_names
        self.device = device_names.device
        self._frame_kinds = frame_kinds
        self._class_by_register = class_by_register
        self._function_by_procedure = function_by_procedure

    @cached_property
    def frame_examples(self) -> list[ReadmeExample]:
        """An example of each kind of frame for which the model has a sample, with invented values.

        ``frame_class`` is set for kinds that a dispatching decoder distinguishes.
        """
        examples: list[ReadmeExample] = []
        for frame_kind in self._frame_kinds:
            example = self._frame_example(frame_kind.layout_class)
            if example is not None:
                frame_class = frame_kind.layout_class.name if frame_kind.dispatch_function else ""
                examples.append(replace(example, frame_class=frame_class))
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
        number_by_name = numbers_by_name(layout_class, sample)
        attribute_name_of = layout_class.class_names.attribute_name
        return ReadmeExample(
            code=variant.code,
            argument=frame_literal(placed_layout, sample.frame),
            printed_expressions=", ".join(f"frame.{attribute_name_of(name)}" for name in number_by_name),
            printed_text=" ".join(map(str, number_by_name.values())),
            has_verdict=layout_class.reports is not None and bool(layout_class.reports.default_verdict),
            bits=0 if layout.in_bytes else placed_layout.bits,
            digits="" if layout.in_bytes else f"{sample.frame:0{placed_layout.bits}b}",
            answers="".join(map(self._first_answer, layout_class.questions)),
            module=self.device.name if layout_class.questions else "",
            interface=variant.interface,
            position=str(number_by_name.get(layout_class.position_attribute, "")),
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
            flag_attribute=layout_class.class_names.attribute_name(spoiling_flag.name),
        )
        crc_field = placed_layout.crc_field
        number_by_name = numbers_by_name(layout_class, sample)
        if crc_field is None or layout_class.layout.in_bytes or layout_class.position_attribute not in number_by_name:
            return example
        position_text = str(number_by_name[layout_class.position_attribute])
        flag_meaning = meaning(spoiling_flag, alarm_of(self.device, spoiling_flag))
        invalid_frame = f"invalid frame of {variant.code}: {_damaged_crc(crc_field, sample.frame)}"
        return replace(example, printed_lines=(position_text, flag_meaning, invalid_frame))

    def _is_position_only(self, layout_class: LayoutClass, interface: str) -> bool:
        """Return whether a frame has only flags and its position, or parts of it, as attributes."""
        position_names = map(layout_class.class_names.attribute_name, self.device.position_names(interface))
        attributes_with_value = {attribute.name for attribute in layout_class.attributes if attribute.type != "bool"}
        return attributes_with_value.issubset(position_names)

    def _first_answer(self, question: OpenQuestion) -> str:
        """Return the argument that passes the first answer to a question: ``, order=x24.Order.NORMAL``."""
        first_answer = question.alternative.answers[0]
        return f", {question.name}={self.device.name}.{question.enum_name}.{first_answer.name.upper()}"

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
    def register_examples(self) -> list[ReadmeExample]:
        """The first worked example of each register that has a class, for up to ``_SHOWN_REGISTERS`` registers."""
        example_by_class: dict[str, ReadmeExample] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.values and example.register in self._class_by_register:
                layout_class = self._class_by_register[example.register]
                example_by_class.setdefault(layout_class.name, _register_example(example, layout_class))
        return list(example_by_class.values())[:_SHOWN_REGISTERS]

    @property
    def procedure_examples(self) -> list[ReadmeExample]:
        """The first ``_SHOWN_PROCEDURES`` worked examples of procedures that only write bytes."""
        all_examples = [example for example in self.device.examples if isinstance(example, ProcedureExample)]
        shown_examples = [example for example in all_examples if self._only_writes_bytes(example)]
        return [self._procedure_example(example) for example in shown_examples[:_SHOWN_PROCEDURES]]

    def _only_writes_bytes(self, example: ProcedureExample) -> bool:
        """Return whether a procedure writes single bytes, and neither modifies nor polls a register.

        Its registers must have an address for each byte.
        """
        procedure = self._function_by_procedure[example.procedure].procedure
        if any(isinstance(step, (ModifyStep, PollStep)) for step in procedure.steps):
            return False
        return not any(self.device.register(name).is_accessed_whole for name in procedure.registers)

    def _procedure_example(self, example: ProcedureExample) -> ReadmeExample:
        """Return the call of a procedure, and the bytes that it writes.

        The encoder is the first argument if the procedure needs it or has no other arguments, and otherwise a keyword.
        """
        function = self._function_by_procedure[example.procedure]
        encoder = f'lookup("{example.order_code}")'
        arguments = [grouped(argument) for argument in example.arguments.values()]
        if function.takes_variant or not arguments:
            arguments.insert(0, encoder)
        else:
            arguments.append(f"variant={encoder}")
        written_bytes = bytes(write.value for write in example.writes)
        return ReadmeExample(
            code=f"{self.device_names.module_name}.{function.name}({', '.join(arguments)})",
            printed_text=repr(written_bytes.hex(" ")),
            module=self.device_names.module_name,
            interface=function.procedure.interface,
            order_code=example.order_code,
        )

    @property
    def live_example(self) -> ReadmeExample | None:
        """The example of a live line: an order code with RS-485, or None if the spec lists none.

        ``printed_expressions`` is the name of the procedure that clears the most alarms, or empty.
        """
        variant = self._example_variant("rs485")
        if variant is None:
            return None
        return ReadmeExample(
            code=variant.code,
            printed_expressions=self._best_reset(variant),
            module=self.device_names.module_name,
            is_rotary=self.device.movement == "rotary",
        )

    def _best_reset(self, variant: Variant) -> str:
        """Return the function without arguments that clears the most alarms of an encoder, or an empty string."""
        alarm_count_by_procedure: Counter[str] = Counter()
        for alarm in facts_for_code(self.device.alarms, variant.code):
            alarm_count_by_procedure.update(alarm.cleared_by)
        reset_functions: list[ProcedureFunction] = []
        for function in self._function_by_procedure.values():
            is_over_interface = function.procedure.interface == variant.interface
            if is_over_interface and function.procedure.name in alarm_count_by_procedure and not function.arguments:
                reset_functions.append(function)
        if not reset_functions:
            return ""
        return max(reset_functions, key=lambda function: alarm_count_by_procedure[function.procedure.name]).name

    @property
    def run_time_examples(self) -> list[ReadmeExample]:
        """The example of a register that changes what frames look like, in a list that is empty without one.

        The register must be one byte that contains a parameter itself rather than a code for it. ``argument`` is its
        address and content, such as ``0x5A: 0x0C``.
        """
        for parameter in self.device.run_time_parameters:
            register = self.device.register(parameter.register)
            field = register.layout.field(parameter.field)
            variant = self._example_variant(register.interface)
            is_whole_byte = register.length == 1 and not field.low.constant and field.widest == 8
            if variant is None or parameter.by_code or not is_whole_byte:
                continue
            attribute_name = self.device_names.attribute_by_parameter[parameter.name]
            # A value that differs from the order code shows that the register determines it.
            changed_value = max(variant.parameters[parameter.name] - 4, parameter.min or 0)
            example = ReadmeExample(
                code=variant.code,
                argument=f"0x{register.address:02X}: 0x{changed_value:02X}",
                printed_expressions=f"encoder.{attribute_name}",
                printed_text=str(changed_value),
            )
            return [example]
        return []

    @property
    def position_examples(self) -> list[ReadmeExample]:
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
        calls_and_results: list[tuple[str, str]] = []
        step_um = measurement.micrometres(variant.parameters)
        if measurement.counts_per_turn is not None:
            counts_per_turn = measurement.counts_per_turn.value(variant.parameters)
            quarter_turn = counts_per_turn // 4
            calls_and_results.append((f"encoder.degrees({quarter_turn})", str(quarter_turn * 360 / counts_per_turn)))
        elif step_um is not None:
            calls_and_results.append(("encoder.millimetres(1000)", repr(float(step_um))))
        calls_and_results.append((f"encoder.unwrap({modulus - 2}, 3)", str(modulus + 3)))
        return [
            ReadmeExample(code=variant.code, argument=call_code, printed_text=result)
            for call_code, result in calls_and_results
        ]

    @property
    def identification_examples(self) -> list[ReadmeExample]:
        """The example that identifies an order code from its registers, in a list that is empty without one.

        The order code is that of the first worked example of an identifying register. ``argument`` contains the
        examples of its registers as items of a dict, such as ``"model": bytes.fromhex("1B")``.
        """
        identity_registers = {register.name for register, _ in self.device.identity}
        example_by_register: dict[str, RegisterExample] = {}
        for example in self.device.examples:
            if isinstance(example, RegisterExample) and example.register in identity_registers:
                example_by_register.setdefault(example.register, example)
        order_codes = [example.order_code for example in example_by_register.values()]
        listed_codes = {variant.code for variant in self.device.variants}
        if not order_codes or order_codes[0] not in listed_codes:
            return []
        register_items = []
        for example in example_by_register.values():
            if example.order_code == order_codes[0]:
                register_items.append(f'"{example.register}": {bytes_literal(example.bytes)}')
        return [ReadmeExample(code=order_codes[0], argument=", ".join(register_items), printed_text="True")]


def _is_number_of(layout_class: LayoutClass, name: str) -> bool:
    """Return whether a name in a frame belongs to a number, which several fields can form (a join).

    The field by which frames differ (the selector) does not count.
    """
    layout = layout_class.layout
    if any(join.name == name for join in layout.joins):
        return True
    field = layout.field(name)
    return is_number(meaning_of(field)) and not layout_class.selects(field)


def _damaged_crc(crc_field: PlacedField, frame_number: int) -> str:
    """Return the message for a frame whose last bit, which is bit 0 of its CRC, is inverted.

    An example is ``expected CRC 0x13, got 0x12``.
    """
    received_crc = (frame_number ^ 1) & crc_field.mask
    expected_crc = received_crc ^ 1
    return f"expected CRC {expected_crc:#04x}, got {received_crc:#04x}"


def numbers_by_name(layout_class: LayoutClass, sample: Sample) -> dict[str, object]:
    """Return the numbers in a sample frame by name, without the field by which frames differ (the selector)."""
    return {name: value for name, value in sample.values.items() if _is_number_of(layout_class, name)}


def _register_example(example: RegisterExample, layout_class: LayoutClass) -> ReadmeExample:
    """Return the example that decodes a register and prints its attributes.

    In the worked example, a named value is the lowercase name of an Enum member.
    """
    variant_argument = f', lookup("{example.order_code}")' if layout_class.takes_variant else ""
    type_by_attribute = {attribute.name: attribute.type for attribute in layout_class.attributes}
    expressions, printed_values = [], []
    for name, value in example.values.items():
        attribute_name = layout_class.class_names.attribute_name(name)
        if isinstance(value, str) and type_by_attribute.get(attribute_name) != "str":
            expressions.append(f"register.{attribute_name}.name")
            printed_values.append(repr(value.upper()))
        else:
            expressions.append(f"register.{attribute_name}")
            printed_values.append(repr(value))
    return ReadmeExample(
        code=f"{layout_class.name}.decode({bytes_literal(example.bytes)}{variant_argument})",
        printed_expressions=_tuple_expression(expressions),
        printed_text=_tuple_expression(printed_values),
        needs_lookup=layout_class.takes_variant,
    )


def _tuple_expression(expressions: Sequence[str]) -> str:
    """Return expressions as a tuple, or the only expression alone."""
    return f"({', '.join(expressions)})" if len(expressions) != 1 else expressions[0]
