"""Facts that a reader states: about a part of the model, by the table of members, and in texts.

Two readers write texts in different words, so only their numbers and cited sections are compared.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from ..language.document import Path, label_of
from ..language.rules.quantities import kind_of_unit
from ..language.schemas import PROSE
from ..loading.spec_parts import parse_sources
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
    PrintedNumbers,
    SpecReading,
    count_text,
    in_hex,
    register_text,
)

_UNIT_BY_ENDING = {"mv": " mV", "us": " µs", "ms": " ms", "hz": " Hz", "ns": " ns"}


@dataclass(frozen=True)
class FactSubject:
    """A thing that facts are about, such as a register.

    Attributes:
        reading: The reading with the facts.
        key: Key of the thing, without the names that a reader chooses.
        path_in_file: Path of the thing in the file.
        description: Its name in messages, such as ``register 0x49``.
        interface: Interface whose order codes determine the values of its expressions.
        depends_on: Key of the fact without which the other facts of the thing are not compared. By default, this is its
            own key.
        joint: Text between the name of a fact and the description: "default of register 0x49".
    """

    reading: SpecReading
    key: FactKey
    path_in_file: Path
    description: str
    interface: str = ""
    depends_on: FactKey | None = None
    joint: str = " of "

    def inside(self, key: FactKey, path_in_file: Path, description: str) -> FactSubject:
        """Return a part of the subject. Its facts are only compared if the subject exists in both readings.

        ``key`` and ``path_in_file`` are relative to the key and place of the subject.
        """
        return FactSubject(
            self.reading,
            key=(*self.key, *key),
            path_in_file=(*self.path_in_file, *path_in_file),
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
        path_in_file = (*self.path_in_file, at) if at else self.path_in_file
        return ComparedFact(
            fact_class=fact_class,
            key=self.key,
            value=value,
            description=self.description,
            path_in_file=path_in_file,
            depends_on=depends_on or self.depends_on or (),
            name=name,
            name_path=(*self.path_in_file, "name"),
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
        path_in_file: Path | None = None,
        may_be_missing: bool = False,
    ) -> ComparedFact:
        """Return another fact about the subject, such as "default of register 0x49".

        Args:
            fact_class: Class of the fact.
            name: Identifies the fact, such as ``default``.
            value: Its value.
            noun: Its name in messages, to which ``joint`` and the description of the subject are added.
            path_in_file: Its path in the spec, by default the member ``name`` of the subject.
            may_be_missing: True if one of the two readings may lack the fact.
        """
        depends_on = self.key if self.depends_on is None else self.depends_on
        path_in_file = (*self.path_in_file, name) if path_in_file is None else path_in_file
        return ComparedFact(
            fact_class=fact_class,
            key=(*self.key, name),
            value=value,
            description=f"{noun}{self.joint}{self.description}",
            path_in_file=path_in_file,
            depends_on=depends_on,
            may_be_missing=may_be_missing,
        )

    def stated_facts(self, model_part: Any, without: Collection[str] = ()) -> Iterator[ComparedFact]:
        """Yield a fact for each member of the part that the spec states, and for each name that the manual prints.

        In the table of members, ``read`` is the class of the fact. Members without it have no fact, and neither have
        members in ``without``.
        """
        reading, subject_path = self.reading, self.path_in_file
        attributes = {member_field.name for member_field in fields(model_part)}
        for member in PARTS_BY_CLASS[type(model_part).__name__].members:
            if not member.read or member.attribute not in attributes or member.name in without:
                continue
            member_value = getattr(model_part, member.attribute)
            if member.is_stated(member_value):
                # The key of the member in the spec is its name in the model or in the table.
                path = reading.first_existing((*subject_path, member.attribute), (*subject_path, member.name))
                text = _value_text(reading, member, member_value, self.interface)
                noun = member.noun or member.words
                yield self.detail_fact(
                    FactClass(member.read), name=member.name, value=text, noun=noun, path_in_file=path
                )
        for language, printed_name in reading.printed_names(model_part).items():
            possible_paths = (*subject_path, "names", language), (*subject_path, "printed_name"), subject_path
            path = reading.first_existing(*possible_paths)
            yield self.detail_fact(
                FactClass.PRINTED,
                name=f"name in {language}",
                value=printed_name,
                noun="printed name",
                path_in_file=path,
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
                    path_in_file=self.path_in_file,
                )


def _value_text(reading: SpecReading, member: ModelMember, member_value: Any, interface: str) -> FactValue:
    """Return a stated value as text, such as ``16 µs``, ``0x1A`` or ``yes``, without names that a reader chooses.

    For an expression, return its value for each order code.
    """
    if member.refers_to:
        return _referred_text(reading, member, member_value, interface)
    unit = _UNIT_BY_ENDING.get(member.notation, "")
    if isinstance(member_value, Expression):
        return {
            case: count_text(member_value.value(parameters)) for case, parameters in reading.cases(interface).items()
        }
    if isinstance(member_value, bool):
        return _bool_text(member, member_value)
    if isinstance(member_value, int):
        number_text = in_hex(member_value) if member.notation == "hex" else str(member_value)
        return f"{number_text}{unit}"
    if isinstance(member_value, float):
        return f"{member_value:g}"
    if isinstance(member_value, Enum):
        return str(member_value.value)
    if isinstance(member_value, tuple):
        values_text = " ".join(map(_part_text, member_value))
        return f"{values_text}{unit}"
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
    if "=" in member.data_type:
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


# -- steps of procedures, as texts


def program_text(reading: SpecReading, procedure: Procedure) -> str:
    """Return the steps of a procedure as text, without waits and repetitions: ``write 0x49 = 05; read 0x4A``."""
    texts = (step_text(reading, step, procedure) for step in procedure.steps)
    return "; ".join(text for text in texts if text)


def step_text(reading: SpecReading, step: Step, procedure: Procedure) -> str:
    """Return a step in words without names, such as ``set 0x49 bits 3:0 to argument 1``, or "" for a wait."""
    match step:
        case WriteStep(register, name, value):
            written_register = reading.device.register(register)
            value_text = _argument_text(procedure, name)
            if value is not None:
                value_text = written_register.bytes_of(value).hex(" ").upper()
            return f"write {register_and_bits(reading, register, '')} = {value_text}"
        case ModifyStep(register, field, name, value):
            value_text = in_hex(value) if value is not None else _argument_text(procedure, name)
            return f"set {register_and_bits(reading, register, field)} to {value_text}"
        case ReadStep(register):
            return f"read {register_and_bits(reading, register, '')}"
        case PollStep(register, field, value):
            return f"poll {register_and_bits(reading, register, field)} until {value}"
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


def register_and_bits(reading: SpecReading, register_name: str, field_name: str) -> str:
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


# -- texts: their numbers, the sections that they cite, and the pages of the contents

#: First part of the keys of numbers in texts, and of cited sections.
NUMBERS, CITED = "numbers", "cited"
_UNITS = (
    r"(?:[mµ]?[VA](?:pp)?|[km]?Nm|[mckµ]?m(?:²|/s)?|[mµn]?s|min(?:ute)?s?|[kMG]?Hz|°[CF]?|%|[kM]?Ω(?:/km)?|AWG|k?g)"
)
_NUMBER_IN_TEXT = re.compile(rf"[±−+-]?(?:[^\W\d_][\w-]*)?\d[\w.,-]*(?:/s|/km|²| ?{_UNITS}(?!\w))?")
#: Maps of a second reading by path, which are not texts.
_MAPS_WITHOUT_TEXTS = frozenset((("found",), ("sections",)))
_KEYS_OF_TEXTS = PROSE | {"printed", "used"}
_THOUSANDS_COMMA = re.compile(r"(?<=\d),(?=\d{3}(?!\d))")


def numbers_in(text: str) -> str:
    """Return the numbers in a text in their order, each with its unit: ``5V 10ms``. Return "" if there are none."""
    # 4,096 is read as 4096.
    without_commas = _THOUSANDS_COMMA.sub("", text)
    # The pattern also matches a comma, point or hyphen after a number.
    numbers = (match.rstrip(".,-").replace(" ", "").lstrip("+") for match in _NUMBER_IN_TEXT.findall(without_commas))
    return " ".join(numbers).replace("−", "-")


def text_facts(reading: SpecReading) -> Iterator[ComparedFact]:
    """Yield a fact for every text with numbers, and one for every source with sections, identified by their places."""
    for path_in_file, text in prose_texts((), reading.document.data):
        numbers_or_sections = _numbers_or_sections(path_in_file[-1], text)
        if not numbers_or_sections:
            continue
        if is_source(path_in_file[-1]):
            yield ComparedFact(
                fact_class=FactClass.SECTION,
                key=(CITED, *path_in_file),
                value=numbers_or_sections,
                description=f"section cited at {dotted_path(path_in_file)}",
                path_in_file=path_in_file,
            )
        else:
            yield ComparedFact(
                fact_class=FactClass.TEXT,
                key=(NUMBERS, *path_in_file),
                value=numbers_or_sections,
                description=f"numbers in {dotted_path(path_in_file)}",
                path_in_file=path_in_file,
            )


def is_source(key: str | int) -> bool:
    """Return whether a key of a spec contains a citation of a manual, such as ``source`` or ``alignment_source``."""
    return key == "source" or str(key).endswith("_source")


def _numbers_or_sections(key: str | int, text: str) -> str:
    """Return the part of a text that is compared: its numbers, or the sections of the manual that a source cites.

    Citations of other documents are left out.
    """
    if not is_source(key):
        return numbers_in(text)
    # A source without a document cites the manual itself.
    sections = {cited.section for cited in parse_sources(text) if not cited.document and cited.section}
    return ", ".join(sorted(sections))


def printed_numbers_by_path(reading: SpecReading) -> dict[str, PrintedNumbers]:
    """Return the numbers, or cited sections, that the second reader of a manual read for texts of the spec.

    A second reading is a transcript of the same manual that was written without the spec. Its key ``found`` lists texts
    by the path of the text in the spec, such as ``registers.mode.meaning``. From ``at 5 V, 10 ms`` there, the result is
    ``5V 10ms`` with its place in the second reading.
    """
    printed_numbers: dict[str, PrintedNumbers] = {}
    for path, text in reading.document.data.get("found", {}).items():
        member_name = path.rpartition(".")[2]
        printed_numbers[path] = PrintedNumbers(
            text=_numbers_or_sections(member_name, text), path_in_file=("found", path)
        )
    return printed_numbers


def sections_by_path(reading: SpecReading) -> dict[str, list[str]]:
    """Return the sections that a second reading cites for whole parts of the spec: ``{"registers": ["4.3"]}``."""
    cited_sections: dict[str, list[str]] = {}
    for section, paths in reading.document.data.get("sections", {}).items():
        for path in paths:
            cited_sections.setdefault(path, []).append(section)
    return cited_sections


def prose_texts(path_in_file: Path, node: Any) -> Iterator[tuple[Path, str]]:
    """Yield every text and source in a spec, with its place.

    Call it with ``()`` and the data of the spec. It calls itself for each part. In a place, an item of a list is given
    by its name, or by its index if it has none.
    """
    if isinstance(node, dict):
        for key, member in node.items():
            if (*path_in_file, key) not in _MAPS_WITHOUT_TEXTS:
                yield from prose_texts((*path_in_file, key), member)
    elif isinstance(node, list):
        for index, member in enumerate(node):
            yield from prose_texts((*path_in_file, label_of(member) or index), member)
    elif isinstance(node, str):
        is_characteristic = (path_in_file[0], path_in_file[-1]) == ("characteristics", "value")
        if is_characteristic or path_in_file[-1] in _KEYS_OF_TEXTS:
            yield path_in_file, node


def dotted_path(path_in_file: Path) -> str:
    """Return a place as a path with dots."""
    return ".".join(map(str, path_in_file))
