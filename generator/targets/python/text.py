"""What the docstrings of a device module say of the device: of its order codes, frames, registers and fields."""

from __future__ import annotations

from collections.abc import Collection, Iterable
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
)
from ...say import crc, field, layout, place, procedure, register
from ...say.erratum import errata, erratum
from ...say.lines import plain
from ...say.name import full_title, heading, title
from ...say.origin import origin, other_editions, taken_away
from ...say.parameter import parameter
from ...say.text import AS_LITERAL as S
from ...say.text import Said, said, told
from ...say.words import counted, sentence
from .context import is_one_choice
from .docstrings import Block, docstring

# -- the module


def of_module(device: Device, contents: Iterable[tuple[str, str]], example: Iterable[Block]) -> str:
    """``contents`` are what the module holds, in a few groups; whoever opens it sees them first."""
    manual = device.manual
    revision = f"revision {manual.revision}" + (f" of {manual.date}" if manual.date else "") + f" ({manual.language})"
    return docstring(
        sentence(f"{device.title}, by {device.manufacturer.title}"),
        "Start with lookup(), which knows every order code. Names are those of the manual; one that Python needs for"
        " itself ends in an underscore.",
        ("In here", [item for item in contents if item[1]]),
        *example,
        f"Version {device.manufacturer.version}, made from the manual “{plain(manual.title)}”, {plain(revision)}."
        " Sections and pages in this module are those"
        " of that manual; a source that begins with a language code is another edition, one that begins with another"
        " key stands in DOCUMENTS.",
        S.paragraph([*origin(device), *other_editions(device)]),
        *paragraphs(taken_away(device)),
        " ".join(device.manufacturer.trademarks),
    )


def of_errata(device: Device, *paths: str, without: Collection[str] = ()) -> list[Block]:
    """Return the errata of these parts of the spec; errata of wording are only in the table."""
    return paragraphs(map(erratum, errata(device, *paths, without=without)))


def paragraphs(statements: Iterable[Said]) -> list[Block]:
    """Return a paragraph for each statement, or its head with the labelled statements below it."""
    return [
        (S.head(item), [(part.label, S.sentence(replace(part, label=""))) for part in item.below])
        if item.below
        else S.sentence(item)
        for item in statements
    ]


def notes(device: Device, interface: Interface) -> list[list[str]]:
    """Errata of an interface that are of none of its layouts alone."""
    here = f"interfaces.{interface.name}"
    found = errata(device, here, without=[f"{here}.{item.name}" for item in interface.layouts])
    return [S.lines(erratum(item)) for item in found]


# -- order codes


def of_variant(device: Device, names: dict[str, str]) -> str:
    set_here = []
    for item in device.set_parameters:
        text = of_parameter(device, item)
        if item.interface and len(device.interfaces) > 1:
            text += f" Over {device.interface(item.interface).title} only."
        if item.read_from:
            text += " As delivered, unless with_registers() gives another."
        set_here.append((names[item.name], text))
    parts = ", ".join(part.name for part in device.order_code.parts)
    attributes = [
        ("family", "The encoder's family."),
        ("interface", "How the encoder is connected."),
        ("code", "Order code, without what may follow it on the label."),
        ("parts", f"The parts of the order code: {parts}."),
        *set_here,
        ("unlisted", "Parts of the order code that the manual leaves open."),
        ("tail", "What followed the order code on the label."),
        ("special_code", f"What the label ends in as /Sxxx. {sentence(device.order_code.special)}".strip()),
        ("written_as_in", "Where codes are written like the label, if that is not as the order codes are listed."),
    ]
    return docstring(
        "An encoder as its order code describes it; that of each interface has a class of its own.",
        ("Attributes", attributes),
        indent=4,
    )


def of_alternative(device: Device, item: Alternative) -> str:
    """What the manual leaves open, and why it matters."""
    head = S.sentence(said(item.meaning, source=item.source))
    decide = "The manual leaves this open, or other evidence contradicts it: there is no default."
    return docstring(head, decide, *of_errata(device, f"alternatives.{item.name}"), indent=4)


def of_answer(item: Answer) -> str:
    """What an answer to what the manual leaves open means."""
    return S.sentence(said(item.meaning, source=item.source))


def of_parameter(device: Device, item: Parameter) -> str:
    return S.paragraph(parameter(device, item))


# -- frames, registers and procedures


def of_layout(device: Device, interface: Interface, item: Layout) -> tuple[str, list[Block]]:
    summary = S.sentence(layout.head(interface, item, heading(item.name), device.alternatives))
    groups = [f"field_groups.{name}" for name in dict.fromkeys(item.group for item in item.fields if item.group)]
    found = errata(device, f"interfaces.{interface.name}.{item.name}")
    shared = ", ".join(other.name for other in errata(device, *groups) if other not in found)
    more = f"Of its parts, see ERRATA: {shared}." if shared else ""
    return summary, [*paragraphs(layout.layout(device, interface, item)), more]


def of_register(device: Device, item: Register) -> tuple[str, list[Block]]:
    """What is said of a register; the rules for its use make one paragraph."""
    facts = [*register.facts(device, item)]
    if is_one_choice(item):
        facts += field.rules(device, item.layout.fields[0])
    found = of_errata(device, f"registers.{item.name}")
    blocks: list[Block] = [sentence(item.meaning), S.paragraph(facts), sentence(item.note), *found]
    return S.sentence(register.head(device, item, full_title(item))), blocks


def of_class(
    about: tuple[str, list[Block]], of_variant: str, attributes: Iterable[tuple[str, str]], *others: Block
) -> str:
    """The docstring of a class; ``of_variant`` is what belongs to the encoder, if it matters which one."""
    variant = [("variant", f"The encoder that the {of_variant} belongs to.")] if of_variant else []
    summary, blocks = about
    return docstring(summary, ("Attributes", [*variant, *attributes]), *blocks, *others, indent=4)


def of_crc(device: Device, item: Crc, over: str) -> list[Block]:
    """What is said of a CRC that is computed ``over`` something, as paragraphs."""
    head, *more = paragraphs(crc.crc(device, item))
    return [head, f"Computed over {over}.", *more]


def of_procedure(device: Device, item: Procedure) -> list[Block]:
    return paragraphs([said(item.title, source=item.source), *procedure.procedure(device, item)])


def of_argument(device: Device, item: Argument) -> str:
    return S.sentence(procedure.argument(device, item))


# -- fields


def of_field(device: Device, item: Field, may_be_missing: bool = False) -> str:
    missing = [said("0 where the encoder has none")] if may_be_missing else []
    about = [*field.meaning(item, item.meaning), *missing, *field.rules(device, item), *told(item.note)]
    return S.paragraph(about) or sentence(title(item))


#: What is said of the member for unused bits.
OF_UNUSED = "0 while all unused bits are as the manual has them; those that differ are 1."
#: The same of a register, where the manual does not say what these bits are.
OF_OTHERS = "Bits that the manual does not describe, at their places in the number that the bytes make."


def of_unused(item: Field, at: int) -> str:
    """A field of unused bits, and where it stands in the number of all of them."""
    return f"{place.bits(at + item.widest - 1, at)}, {item.name}"


def of_value(item: Field | Value) -> str:
    """What a named value, or a field with such values, means; empty where the manual does not say."""
    return S.paragraph(field.meaning(item, item.meaning))


def of_run(run: Digits) -> str:
    return sentence(run.meaning or counted(run.digits, "digit"))
