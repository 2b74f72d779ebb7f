"""Docstrings of a device module: order codes, frames, registers, fields and procedures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from ...model import (
    Alternative,
    Answer,
    Argument,
    Crc,
    Device,
    Digits,
    Field,
    Interface,
    Layout,
    Parameter,
    Procedure,
    Register,
    Value,
    cite,
)
from ...model.record import dataclass
from ...say import commands_and_alarms, count_with_unit, names_and_evidence, text_on_one_line, wrap_text
from ...say import layout as say_layout
from ...say import order_code as say_order_code
from ...say import register as say_register
from ...say.errata import describe_erratum, errata_affecting
from ...say.names_and_evidence import (
    describe_grade,
    describe_removals,
    differences_from_manual,
    full_title,
    heading,
    other_editions,
    title_of,
)
from ...say.text import DOCSTRING_STYLE, Statement, as_sentence, spec_text, statement
from .line_breaks import WIDTH
from .names import is_one_choice

#: A quotation mark at the end that is not escaped.
_OPEN_QUOTE = re.compile(r'(?<!\\)(?:\\\\)*"$')


@dataclass(frozen=True)
class Lines:
    """Lines of a docstring that are not wrapped, such as those of an example."""

    lines: tuple[str, ...]


Block = str | Lines | tuple[str, Sequence[tuple[str, str]]]


def docstring(summary: str, *blocks: Block, indent: int = 0) -> str:
    """Return a docstring with its quotes. Empty blocks are omitted.

    A block is a paragraph, lines that are not wrapped, or a title with entries. An entry is a name with its text. The
    name is empty for plain text, as below ``Returns``.
    """
    indentation = " " * indent
    # Without blocks, the closing quotes are on the line of the summary.
    summary_width = WIDTH if any(blocks) else WIDTH - len('"""')
    docstring_lines = [wrap_text(_in_docstring(summary), summary_width, prefix=indentation, first=f'{indentation}"""')]
    for block in blocks:
        block_lines = _block_lines(block, indentation)
        if block_lines:
            docstring_lines += ["", *block_lines]
    unfinished_docstring = "\n".join(docstring_lines)
    if "\n" in unfinished_docstring:
        return f'{unfinished_docstring}\n{indentation}"""'
    # A quotation mark at the end would be read as a closing quotation mark, so it is escaped.
    if _OPEN_QUOTE.search(unfinished_docstring):
        unfinished_docstring = f'{unfinished_docstring[:-1]}\\"'
    return unfinished_docstring + '"""'


def _block_lines(block: Block, indentation: str) -> list[str]:
    """Return the lines of a block, or none if it has no text or no entries."""
    if isinstance(block, str):
        return [wrap_text(_in_docstring(block), WIDTH, indentation)] if block else []
    if isinstance(block, Lines):
        return [f"{indentation}    {_in_docstring_line(line)}" for line in block.lines]
    block_title, entries = block
    if not entries:
        return []
    return [
        wrap_text(_in_docstring(f"{block_title}:"), WIDTH, indentation),
        *(_block_entry(name, text, indentation) for name, text in entries),
    ]


def _block_entry(name: str, text: str, indentation: str) -> str:
    """Return an entry of a block, such as ``    bits: Width of the position.`` Its further lines are indented.

    Without a name, the entry is only the text, and all of its lines begin at the same column.
    """
    first_prefix = f"{indentation}    {_in_docstring(name)}: " if name else f"{indentation}    "
    further_prefix = f"{indentation}        " if name else first_prefix
    return wrap_text(_in_docstring(text), WIDTH, prefix=further_prefix, first=first_prefix)


def _in_docstring_line(line: str) -> str:
    """Return a line as it is written in a docstring, with its indentation."""
    indentation = line[: len(line) - len(line.lstrip())]
    # The text is without the spaces at its start.
    return indentation + _in_docstring(line)


def _in_docstring(text: str) -> str:
    """Return a text on one line, with the characters escaped that have a meaning in a docstring."""
    return text_on_one_line(text).replace("\\", "\\\\").replace('"""', '\\"\\"\\"')


#: End of a sentence that is followed by another sentence.
_END_OF_SENTENCE = re.compile(r"(?<=[.:?!]) (?=[A-Z])")

# -- the module


def describe_module(device: Device, contents: Iterable[tuple[str, str]], example: Iterable[Block]) -> str:
    """Return the docstring of the module. ``contents`` are its public names, in groups with titles."""
    manual = device.manual
    date = f" of {manual.date}" if manual.date else ""
    revision = f"revision {manual.revision}{date} ({manual.language})"
    title = as_sentence(f"{device.title}, by {device.manufacturer.title}")
    return docstring(
        title,
        "Start with lookup(), which accepts every order code. Names follow the manual. Names that are reserved in"
        " Python end in an underscore.",
        ("Contents", [(group_title, names) for group_title, names in contents if names]),
        *example,
        f"Version {device.manufacturer.version}, generated from the manual “{text_on_one_line(manual.title)}”,"
        f" {text_on_one_line(revision)}."
        " Sections and pages refer to this manual. A source that starts with a language code refers to the edition in"
        " that language. A source that starts with any other key refers to that entry of DOCUMENTS.",
        DOCSTRING_STYLE.sentence(describe_grade(device)),
        DOCSTRING_STYLE.paragraph([*differences_from_manual(device), *other_editions(device)]),
        *_in_full(describe_removals(device)),
        " ".join(device.manufacturer.trademarks),
    )


def describe_errata(device: Device, *paths: str) -> list[Block]:
    """Return the block with the errata that affect these parts of the spec. Errata about wording are left out."""
    return paragraphs(map(describe_erratum, errata_affecting(device, *paths)))


def _with_source_below(first: Statement) -> tuple[str, str]:
    """Return a statement as a sentence without its source, and the source as a paragraph: ``Source: 5.3 p.22.``"""
    source = f"Source: {cite(first.source)}." if first.source else ""
    return DOCSTRING_STYLE.sentence(replace(first, source=())), source


def paragraphs(statements: Iterable[Statement]) -> list[Block]:
    """Return a paragraph for each statement, and a list of the errata among them in short form."""
    sentences: list[Block] = []
    short_errata: list[tuple[str, str]] = []
    for printed_statement in statements:
        # Only errata have statements below them.
        if printed_statement.statements_below:
            short_errata.append(_short_erratum(printed_statement))
        else:
            sentences.append(DOCSTRING_STYLE.sentence(printed_statement))
    return [*sentences, ("Errata, with their full text in ERRATA", short_errata)]


def _in_full(statements: Iterable[Statement]) -> list[Block]:
    """Return a block for each statement: its heading, and the labeled statements below it."""
    return [
        (DOCSTRING_STYLE.head(statement), list(map(_split_label, statement.statements_below)))
        for statement in statements
    ]


def _split_label(statement: Statement) -> tuple[str, str]:
    """Return the label of a statement and its sentence without it."""
    return statement.label, DOCSTRING_STYLE.sentence(replace(statement, label=""))


def _short_erratum(statement: Statement) -> tuple[str, str]:
    """Return the title of an erratum, and the value that is used instead of the printed one.

    A change by an overlay or another edition has no such value. Instead, the result contains the label and the first
    sentence of its first statement.
    """
    title_of_erratum = statement.label.removeprefix("Erratum: ")
    phrase_by_label = {
        part_statement.label: DOCSTRING_STYLE.phrase(part_statement) for part_statement in statement.statements_below
    }
    first_statement = statement.statements_below[0]
    correction_text = (
        phrase_by_label.get("Used") or f"{first_statement.label}: {DOCSTRING_STYLE.phrase(first_statement)}"
    )
    # Changes by overlays and other editions have no short form.
    is_erratum_of_manual = bool(statement.brief) and "Used" in phrase_by_label
    if is_erratum_of_manual:
        return title_of_erratum, as_sentence(correction_text)
    first_sentence = _END_OF_SENTENCE.split(correction_text)[0]
    return title_of_erratum, as_sentence(first_sentence)


def errata_lines(device: Device, interface: Interface) -> list[list[str]]:
    """Return the errata of an interface that do not affect a single frame only, each as a list of lines."""
    path = f"interfaces.{interface.name}"
    interface_errata = errata_affecting(device, path, without=[f"{path}.{frame.name}" for frame in interface.layouts])
    return [DOCSTRING_STYLE.lines(describe_erratum(listed_erratum)) for listed_erratum in interface_errata]


# -- order codes


def describe_variant(device: Device, attribute_by_parameter: dict[str, str]) -> str:
    """Return the docstring of the class of encoders. ``attribute_by_parameter`` contains their attributes."""
    names_and_descriptions = [
        (attribute_by_parameter[parameter.name], _about_quantity(device, parameter))
        for parameter in device.set_parameters
    ]
    part_names = ", ".join(part.name for part in device.order_code.parts)
    attributes = [
        ("family", "Family of the encoder."),
        ("interface", "Interface of the encoder."),
        ("code", "Order code, without any text that follows it on the label."),
        ("parts", f"Parts of the order code: {part_names}."),
        *names_and_descriptions,
        ("unlisted", "Names of the parts whose values the manual does not list."),
        ("tail", "Text that followed the order code on the label."),
        ("special_code", f"Suffix /Sxxx of the label, or empty. {as_sentence(device.order_code.special)}".strip()),
        ("written_as_in", "Document that uses the label's spelling of the order code, if it is not the usual one."),
    ]
    return docstring(
        "Encoder as described by its order code. Each interface has a subclass.",
        ("Attributes", attributes),
        indent=4,
    )


def _about_quantity(device: Device, parameter: Parameter) -> str:
    """Return the description of a parameter that order codes set.

    It names the interface if other interfaces do not have the parameter. If a register contains the parameter, it says
    which value applies until the register is read.
    """
    description = describe_parameter(device, parameter)
    if parameter.interface and len(device.interfaces) > 1:
        description += f" Applies only to {device.interface(parameter.interface).title}."
    if parameter.read_from:
        has_factory_default = device.register(parameter.register).default is not None
        initial_value = "the factory default" if has_factory_default else "that of the order code"
        description += f" The value is {initial_value} unless set by with_registers()."
    return description


def describe_alternative(device: Device, alternative: Alternative) -> str:
    """Return the docstring of the class with the answers to a question that the manual leaves open."""
    question, source = _with_source_below(statement(alternative.meaning, source=alternative.source))
    decision = "The manual leaves this open, or other evidence contradicts it."
    if alternative.default:
        decision += f" The default is {alternative.default.upper()}. Variant.with_answers() chooses another answer."
    else:
        decision += " There is no default."
    return docstring(question, source, decision, *describe_errata(device, f"alternatives.{alternative.name}"), indent=4)


def describe_answer(answer: Answer) -> str:
    """Return the meaning of an answer to a question that the manual leaves open."""
    return DOCSTRING_STYLE.sentence(statement(answer.meaning, source=answer.source))


def describe_parameter(device: Device, parameter: Parameter) -> str:
    """Return the description of a parameter of the order code."""
    return DOCSTRING_STYLE.paragraph(say_order_code.describe_parameter(device, parameter))


def describe_derived_parameter(device: Device, parameter: Parameter) -> list[Block]:
    """Return the paragraphs about a parameter that is computed from others: meaning, source, then unit and formula."""
    facts = list(say_order_code.describe_parameter(device, parameter))
    if not parameter.meaning:
        return [DOCSTRING_STYLE.paragraph(facts)]
    # The first one is the meaning.
    summary, source = _with_source_below(facts[0])
    return [summary, source, DOCSTRING_STYLE.paragraph(facts[1:])]


# -- frames, registers and procedures


def describe_layout(device: Device, interface: Interface, frame: Layout) -> tuple[str, list[Block]]:
    """Return the summary of a frame, and the blocks below it.

    The last one lists the titles of errata that affect a group of fields in the frame but not the frame itself. It is
    empty if there are none.
    """
    title = heading(frame.name)
    summary, source = _with_source_below(say_layout.describe_head(interface, frame, title, device.alternatives))
    group_names = dict.fromkeys(field.group for field in frame.fields if field.group)
    # These are paths in the spec of the device, where errata refer to them.
    group_paths = [f"field_groups.{name}" for name in group_names]
    frame_errata = errata_affecting(device, f"interfaces.{interface.name}.{frame.name}")
    group_titles = [erratum.title for erratum in errata_affecting(device, *group_paths) if erratum not in frame_errata]
    further_errata = f"See also these errata in ERRATA: {'; '.join(group_titles)}." if group_titles else ""
    return summary, [source, *paragraphs(say_layout.describe_layout(device, interface, frame)), further_errata]


def describe_register(device: Device, device_register: Register) -> tuple[str, list[Block]]:
    """Return the summary of a register, and the blocks below it: meaning, facts, note and errata.

    The facts about a register with a single named value include those about its only field.
    """
    facts = [*say_register.describe_register_facts(device, device_register)]
    if is_one_choice(device_register):
        facts += say_register.describe_field_rules(device, device_register.layout.fields[0])
    register_errata = describe_errata(device, f"registers.{device_register.name}")
    summary, source = _with_source_below(
        say_register.describe_head(device, device_register, full_title(device_register))
    )
    blocks: list[Block] = [
        source,
        as_sentence(device_register.meaning),
        DOCSTRING_STYLE.paragraph(facts),
        as_sentence(device_register.note),
        *register_errata,
    ]
    return summary, blocks


def describe_class(
    summary_and_blocks: tuple[str, list[Block]],
    frame_or_register: str,
    attributes: Iterable[tuple[str, str]],
    *further_blocks: Block,
) -> str:
    """Return the docstring of a class. ``summary_and_blocks`` is its summary and the paragraphs after the attributes.

    If the class has the attribute ``variant``, ``frame_or_register`` says what it is: ``frame`` or ``register``.
    Otherwise it is empty.
    """
    variant = [("variant", f"Encoder to which the {frame_or_register} belongs.")] if frame_or_register else []
    summary, blocks = summary_and_blocks
    return docstring(summary, ("Attributes", [*variant, *attributes]), *blocks, *further_blocks, indent=4)


def describe_crc(device: Device, device_crc: Crc) -> list[Block]:
    """Return the paragraphs of the function that computes a CRC."""
    head_statement, *further_statements = say_layout.describe_crc(device, device_crc)
    summary, source = _with_source_below(head_statement)
    return [f"Compute the {summary}", source, *paragraphs(further_statements)]


def describe_procedure(device: Device, device_procedure: Procedure) -> list[Block]:
    """Return the paragraphs about a procedure, beginning with its title."""
    summary, source = _with_source_below(statement(device_procedure.title, source=device_procedure.source))
    return [summary, source, *paragraphs(commands_and_alarms.describe_procedure(device, device_procedure))]


def describe_argument(device: Device, argument: Argument) -> str:
    """Return the description of an argument of a procedure."""
    return DOCSTRING_STYLE.sentence(commands_and_alarms.describe_argument(device, argument))


# -- fields


def describe_field(device: Device, data_field: Field, *, may_be_missing: bool) -> str:
    """Return the description of a field: its meaning, rules and note, or else its name.

    ``may_be_missing`` is True if some order codes do not have the field.
    """
    missing_statement = [statement("0 if the encoder does not have this field")] if may_be_missing else []
    statements = [
        *say_register.describe_meaning(data_field, data_field.meaning),
        *missing_statement,
        *say_register.describe_field_rules(device, data_field),
        *spec_text(data_field.note),
    ]
    return DOCSTRING_STYLE.paragraph(statements) or as_sentence(title_of(data_field))


#: Description of the member for unused bits.
ABOUT_UNUSED = "Mask of the unused bits that differ from the manual. 0 if none differs."
#: Description of the member for bits of a register that the manual does not describe.
ABOUT_OTHERS = "Bits that the manual does not describe, at their positions in the number that the bytes form."


def describe_unused(unused_field: Field, lowest_bit: int) -> str:
    """Return the bits and the name of a field of unused bits, such as ``bits 5:4, reserved``.

    The bits are those in the attribute ``unused``, where its lowest bit is bit ``lowest_bit``.
    """
    return f"{names_and_evidence.bits(lowest_bit + unused_field.widest - 1, lowest_bit)}, {unused_field.name}"


def describe_value(named_value: Field | Value) -> str:
    """Return the meaning of a named value, or of a field with named values. It is empty if the manual gives none."""
    return DOCSTRING_STYLE.paragraph(say_register.describe_meaning(named_value, named_value.meaning))


def describe_run(digit_run: Digits) -> str:
    """Return the description of some decimal digits of a field, such as ``3 digits.``"""
    return as_sentence(digit_run.meaning or count_with_unit(digit_run.digits, "digit"))
