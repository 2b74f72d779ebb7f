"""Facts that a reader states about a part of the model, by the table of members, and about its procedures."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any, NamedTuple

from ..language.document import Path
from ..language.rules.quantities import kind_of_unit
from ..model import (
    Digits,
    ModifyStep,
    PollStep,
    Procedure,
    ReadStep,
    Scale,
    SendStep,
    Step,
    WaitStep,
    WriteStep,
    assert_never,
)
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, ModelMember
from ..model.order_codes import facts_for_code
from ..model.record import dataclass
from .reading import (
    CodeAndState,
    ComparedFact,
    FactClass,
    FactKey,
    FactValue,
    SpecReading,
    count_text,
    in_hex,
    interface_label,
    register_text,
)


class _Detail(NamedTuple):
    """A fact about part of a procedure. Its key and its place are within the procedure."""

    fact_class: FactClass
    key: FactKey
    place: Path
    value: str
    description: str


def procedures(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield the facts of every procedure: its steps as text, and its argument limits, waits and repetitions.

    Two readers give procedures different names. A procedure is therefore identified by its interface and the text of
    its steps, such as ``write 0x49 = 05; read 0x4A``.
    """
    for procedure in reading.device.procedures:
        steps_text = program_text(reading, procedure)
        procedure_key: FactKey = ("procedure", procedure.interface, steps_text)
        procedure_place: Path = ("procedures", procedure.name)
        yield ComparedFact(
            fact_class=FactClass.PROCEDURE,
            key=procedure_key,
            value=steps_text,
            description=f"a procedure over {interface_label(procedure.interface)}",
            place=procedure_place,
            name=procedure.name,
            name_place=(*procedure_place, "name"),
        )
        for detail in (*_argument_limits(reading, procedure), *_waits_and_repetitions(reading, procedure)):
            yield ComparedFact(
                fact_class=detail.fact_class,
                key=(*procedure_key, *detail.key),
                value=detail.value,
                description=detail.description,
                place=(*procedure_place, *detail.place),
                depends_on=procedure_key,
            )


def _argument_limits(reading: SpecReading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield for each argument the register whose limits apply to it: ``register 0x49``.

    If another register determines what the argument means, the condition for its meaning follows: ``register 0x49 while
    register 0x4A bits 1:0 is 3``.
    """
    for number, argument in enumerate(procedure.arguments, 1):
        register = reading.device.register(argument.of)
        while_text = ""
        for meaning in register.meanings:
            if meaning.name == argument.meant_as:
                while_text = f" while {reading.state(meaning.when, meaning.value)}"
        yield _Detail(
            fact_class=FactClass.LIMIT,
            key=("argument", number),
            place=("arguments", argument.name, "of"),
            value=f"{register_text(register)}{while_text}",
            description=f"limits of argument {number} of the procedure '{procedure.name}'",
        )


def _waits_and_repetitions(reading: SpecReading, procedure: Procedure) -> Iterator[_Detail]:
    """Yield the waits, the bits that are read, and the repetitions of requests.

    A step is identified by its number, for which waits are not counted. Consecutive waits are added up, and are
    identified by the number of the step before them, or 0 at the start.
    """
    step_number, total_wait_us, position_text = 0, 0, "at its start"
    for index, step in enumerate(procedure.steps):
        step_place = ("steps", index)
        if isinstance(step, WaitStep):
            total_wait_us += step.microseconds
            following_steps = procedure.steps[index + 1 :]
            is_last_of_waits = not following_steps or not isinstance(following_steps[0], WaitStep)
            if is_last_of_waits:
                yield _Detail(
                    fact_class=FactClass.WAIT,
                    key=("wait", step_number),
                    place=(*step_place, "at_least_ms"),
                    value=f"{total_wait_us // 1000} ms",
                    description=f"wait {position_text} in the procedure '{procedure.name}'",
                )
            continue
        step_text = f"'{_step_text(reading, step, procedure)}'"
        # Another step begins a new wait.
        step_number, total_wait_us, position_text = step_number + 1, 0, f"after {step_text}"
        if isinstance(step, ReadStep) and step.field:
            bits_read = _register_and_bits(reading, step.register, step.field)
            description = f"bits used by {step_text}"
            yield _Detail(
                fact_class=FactClass.PROCEDURE,
                key=("bits", step_number),
                place=(*step_place, "field"),
                value=bits_read,
                description=description,
            )
        if isinstance(step, SendStep):
            yield from _repetition_details(
                step, step_number, step_place, f"{step_text} in the procedure '{procedure.name}'"
            )


def _repetition_details(step: SendStep, step_number: int, place: Path, request_text: str) -> Iterator[_Detail]:
    """Yield how often a request is sent, at which interval, and whether in succession without other requests."""
    yield _Detail(
        fact_class=FactClass.PROCEDURE,
        key=("times", step_number),
        place=(*place, "times"),
        value=str(step.times),
        description=f"repetitions of {request_text}",
    )
    if step.microseconds:
        yield _Detail(
            fact_class=FactClass.WAIT,
            key=("every", step_number),
            place=(*place, "every_at_least_us"),
            value=f"{step.microseconds} µs",
            description=f"interval of {request_text}",
        )
    if step.in_succession:
        yield _Detail(
            fact_class=FactClass.PROCEDURE,
            key=("succession", step_number),
            place=(*place, "in_succession"),
            value="yes",
            description=f"succession of {request_text}",
        )


def program_text(reading: SpecReading, procedure: Procedure) -> str:
    """Return the steps of a procedure as text, without waits and repetitions: ``write 0x49 = 05; read 0x4A``."""
    texts = (_step_text(reading, step, procedure) for step in procedure.steps)
    return "; ".join(text for text in texts if text)


def _step_text(reading: SpecReading, step: Step, procedure: Procedure) -> str:
    """Return a step in words without names, such as ``set 0x49 bits 3:0 to argument 1``, or "" for a wait."""
    match step:
        case WriteStep(register, name, value):
            written_register = reading.device.register(register)
            value_text = _argument_text(procedure, name)
            if value is not None:
                value_text = written_register.bytes_of(value).hex(" ").upper()
            return f"write {_register_and_bits(reading, register, '')} = {value_text}"
        case ModifyStep(register, field, name, value):
            value_text = in_hex(value) if value is not None else _argument_text(procedure, name)
            return f"set {_register_and_bits(reading, register, field)} to {value_text}"
        case ReadStep(register):
            return f"read {_register_and_bits(reading, register, '')}"
        case PollStep(register, field, value):
            return f"poll {_register_and_bits(reading, register, field)} until {value}"
        case SendStep():
            return f"send {step.request.hex(' ').upper()}"
        case WaitStep():
            return ""
        case _:
            assert_never(step)


def _argument_text(procedure: Procedure, value_name: str) -> str:
    """Return ``argument 2`` for an argument of the procedure, or the name if it is not an argument."""
    names = [argument.name for argument in procedure.arguments]
    return f"argument {names.index(value_name) + 1}" if value_name in names else value_name


def _register_and_bits(reading: SpecReading, register_name: str, field_name: str) -> str:
    """Return ``0x49 bits 3:0``, or only ``0x49`` for a field that is the whole register, or without a field."""
    register = reading.device.register(register_name)
    bits_text = ""
    register_bits = 8 * register.length
    for field in register.layout.fields:
        is_whole_register = field.width.is_constant and field.width.constant == register_bits
        if field.name == field_name and not is_whole_register:
            bits_text = f" {reading.bits_of(register.interface, field)}"
    return f"{register_text(register).removeprefix('register ')}{bits_text}"


def program_texts(reading: SpecReading, names: tuple[str, ...]) -> str:
    """Return the steps of several procedures as text, in the order of these texts: ``read 0x4A | write 0x49 = 05``."""
    procedures_by_name = {procedure.name: procedure for procedure in reading.device.procedures}
    texts = [program_text(reading, procedures_by_name[name]) for name in names if name in procedures_by_name]
    return " | ".join(sorted(texts))


_UNIT_BY_ENDING = {"mv": " mV", "us": " µs", "ms": " ms", "hz": " Hz", "ns": " ns"}


@dataclass(frozen=True)
class FactSubject:
    """A thing that facts are about, such as a register.

    Attributes:
        reading: The reading with the facts.
        key: Key of the thing, without the names that a reader chooses.
        place: Place of the thing in the file.
        description: Its name in messages, such as ``register 0x49``.
        interface: Interface whose order codes determine the values of its expressions.
        depends_on: Key of the fact without which the other facts of the thing are not compared. By default, this is its
            own key.
        joint: Text between the name of a fact and the description: "default of register 0x49".
    """

    reading: SpecReading
    key: FactKey
    place: Path
    description: str
    interface: str = ""
    depends_on: FactKey | None = None
    joint: str = " of "

    def inside(self, key: FactKey, place: Path, description: str) -> FactSubject:
        """Return a part of the subject. Its facts are only compared if the subject exists in both readings.

        ``key`` and ``place`` are relative to the key and place of the subject.
        """
        return FactSubject(
            self.reading,
            key=(*self.key, *key),
            place=(*self.place, *place),
            description=description,
            interface=self.interface,
            depends_on=self.key,
        )

    def existence_fact(
        self, fact_class: FactClass, value: FactValue, at: str = "", name: str = "", depends_on: FactKey = ()
    ) -> ComparedFact:
        """Return the fact that the subject exists, with a value such as "present".

        ``at`` is the key inside the subject where the file states it, and ``name`` is the reader's name of the subject.
        """
        place = (*self.place, at) if at else self.place
        return ComparedFact(
            fact_class=fact_class,
            key=self.key,
            value=value,
            description=self.description,
            place=place,
            depends_on=depends_on or self.depends_on or (),
            name=name,
            name_place=(*self.place, "name"),
        )

    def facts_of_part(
        self, fact_class: FactClass, model_part: Any, value: str = "present", at: str = ""
    ) -> Iterator[ComparedFact]:
        """Yield the fact that the subject exists, and those that are stated about its ``model_part``."""
        name = getattr(model_part, "name", "")
        yield self.existence_fact(fact_class, value=value, at=at, name=name)
        yield from self.stated_facts(model_part)

    def detail_fact(
        self,
        fact_class: FactClass,
        *,
        name: str,
        value: FactValue,
        noun: str,
        place: Path | None = None,
        may_be_missing: bool = False,
    ) -> ComparedFact:
        """Return another fact about the subject, such as "default of register 0x49".

        Args:
            fact_class: Class of the fact.
            name: Identifies the fact, such as ``default``.
            value: Its value.
            noun: Its name in messages, to which ``joint`` and the description of the subject are added.
            place: Its place in the spec, by default the member ``name`` of the subject.
            may_be_missing: True if one of the two readings may lack the fact.
        """
        depends_on = self.key if self.depends_on is None else self.depends_on
        place = (*self.place, name) if place is None else place
        return ComparedFact(
            fact_class=fact_class,
            key=(*self.key, name),
            value=value,
            description=f"{noun}{self.joint}{self.description}",
            place=place,
            depends_on=depends_on,
            may_be_missing=may_be_missing,
        )

    def stated_facts(self, model_part: Any, without: Collection[str] = ()) -> Iterator[ComparedFact]:
        """Yield a fact for each member of the part that the spec states, and for each name that the manual prints.

        In the table of members, ``read`` is the class of the fact. Members without it have no fact, and neither have
        members in ``without``.
        """
        attributes = {member_field.name for member_field in fields(model_part)}
        for member in PARTS_BY_CLASS[type(model_part).__name__].members:
            if not member.read or member.attribute not in attributes or member.name in without:
                continue
            member_value = getattr(model_part, member.attribute)
            if member.is_stated(member_value):
                # The key of the member in the spec is its name in the model or in the table.
                place = self.reading.first_existing((*self.place, member.attribute), (*self.place, member.name))
                text = _value_text(self.reading, member, member_value, self.interface)
                noun = member.noun or member.words
                yield self.detail_fact(FactClass(member.read), name=member.name, value=text, noun=noun, place=place)
        for language, text in self.reading.printed_names(model_part).items():
            places = (*self.place, "names", language), (*self.place, "printed_name"), self.place
            place = self.reading.first_existing(*places)
            yield self.detail_fact(
                FactClass.PRINTED,
                name=f"name in {language}",
                value=text,
                noun="printed name",
                place=place,
                may_be_missing=True,
            )

    def stated_facts_by_code(self, rows: Sequence[Any]) -> Iterator[ComparedFact]:
        """Yield a fact for each member of ``rows``, with its value for each order code.

        Each row states the values for some order codes, such as the clock limits of one output.
        """
        for member in PARTS_BY_CLASS[type(rows[0]).__name__].members:
            values: dict[CodeAndState, str] = {}
            for case in self.reading.cases(self.interface):
                for row in facts_for_code(rows, case.code):
                    member_value = getattr(row, member.attribute)
                    if member.read and member.is_stated(member_value):
                        values[case] = str(_value_text(self.reading, member, member_value, self.interface))
            if values:
                yield self.detail_fact(
                    FactClass(member.read),
                    name=member.name,
                    value=values,
                    noun=member.noun or member.words,
                    place=self.place,
                )


def _value_text(reading: SpecReading, member: ModelMember, member_value: Any, interface: str) -> FactValue:
    """Return a stated value as text, such as ``16 µs``, ``0x1A`` or ``yes``, without names that a reader chooses.

    For an expression, return its value for each order code.
    """
    if member.refers_to:
        return _referred_text(reading, member, member_value, interface)
    if isinstance(member_value, Expression):
        return {
            case: count_text(member_value.value(parameters)) for case, parameters in reading.cases(interface).items()
        }
    if isinstance(member_value, bool):
        return _bool_text(member, member_value)
    if isinstance(member_value, int):
        return (
            in_hex(member_value)
            if member.notation == "hex"
            else f"{member_value}{_UNIT_BY_ENDING.get(member.notation, '')}"
        )
    if isinstance(member_value, float):
        return f"{member_value:g}"
    if isinstance(member_value, Enum):
        return str(member_value.value)
    if isinstance(member_value, tuple):
        return f"{' '.join(map(_part_text, member_value))}{_UNIT_BY_ENDING.get(member.notation, '')}"
    if isinstance(member_value, Scale):
        # Two readers may write the same formula with different numbers, so it is reduced to a factor and an offset.
        factor = member_value.quantity(1) - member_value.quantity(0)
        offset = member_value.quantity(0)
        return f"number * {factor} + {offset} {member_value.unit}"
    # The first member of any other part is its value, such as the code of ``output_code``.
    if is_dataclass(member_value):
        return str(getattr(member_value, fields(member_value)[0].name))
    return kind_of_unit(member_value) if member.form == "unit" else str(member_value)


def _bool_text(member: ModelMember, is_true: bool) -> str:
    """Return ``low`` or ``high`` for a level, ``yes`` or ``no`` for a property, else ``true`` or ``false``."""
    if member.form == "level":
        return "low" if is_true else "high"
    # A member with a default, such as ``boolean=false``, is a property that the item has or lacks.
    if "=" in member.shape:
        return "yes" if is_true else "no"
    return "true" if is_true else "false"


def _part_text(value_or_part: object) -> str:
    return str(value_or_part.digits if isinstance(value_or_part, Digits) else value_or_part)


def _referred_text(reading: SpecReading, member: ModelMember, referred_names: Any, interface: str) -> str:
    """Return the things that a member refers to, without the names that a reader gave them, sorted.

    Registers are described by their addresses, fields by their bits, and procedures by their steps.
    """
    names = (referred_names,) if isinstance(referred_names, str) else referred_names
    match member.refers_to.removesuffix("s"):
        case "register":
            thing_texts = {_register_text(reading, name) for name in names}
        case "dotted":
            thing_texts = {reading.describe_bits(name) for name in names}
        case "procedure":
            return program_texts(reading, names)
        case _:
            # All other members name fields of the frames of the interface.
            thing_texts = set()
            for layout in reading.device.interface(interface).layouts:
                for field in layout.fields:
                    if field.name in names:
                        thing_texts.update(reading.bits_in_frames(interface, layout, field))
    return ", ".join(sorted(thing_texts))


def _register_text(reading: SpecReading, register_name: str) -> str:
    """Return the address of a register, or its name if there is no such register."""
    register = reading.register(register_name)
    return register_text(register) if register is not None else register_name
