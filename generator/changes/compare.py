"""Compare two parts of one kind, member by member, by the rules in the table of members."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any, TypeVar

from ..model import Alarm, Alternative, Connector, Crc, Device, Layout
from ..model.expressions import Expression
from ..model.members import PARTS_BY_CLASS, WIDER, ModelMember
from ..order_codes.reduction import sent_crcs
from ..say import first_of
from ..say.names_and_evidence import register_at
from .counterparts import pair_parts, pair_section
from .family_pair import FamilyPair, OldAndNew
from .rules import Change, ChangeSubject
from .values import NumberDifferences, as_plain_data, differing_items, old_to_new, short_value, without_texts

_Item = TypeVar("_Item")
#: Rules whose changes are described only by their location, without the old and new values.
_RULES_WITHOUT_VALUES = ("words", "source")
_SOURCE_MEMBER = ModelMember("source", rule="source")
#: Kinds of parts with a section in the spec: the path of the section, and the words that precede the name of a part.
_SECTION_BY_KIND: Mapping[str, tuple[str, str | Callable[[OldAndNew[Any]], str]]] = MappingProxyType(
    {
        "part": ("order_code.parts", "part"),
        "parameter": ("parameters", "parameter"),
        "decision": ("alternatives", "decision"),
        "crc": ("crcs", "CRC"),
        "register": ("registers", lambda pair: register_at(pair.old_or_new)),
        "alarm": ("alarms", "alarm"),
        "procedure": ("procedures", "procedure"),
        "connector": ("connectors", lambda pair: str(pair.new_or_old.kind)),
        "input": ("inputs", "input"),
    }
)
#: Kinds of parts whose changes concern the interface of the old part, even if the new part has a different interface.
_KINDS_OF_OLD_INTERFACE = ("crc", "procedure")
#: Patterns of the names in C and in Python for the parts of each section. Users can search their code for these names.
_NAME_PATTERNS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "registers": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_REG_{NAME}_…", '{family}.REGISTERS["{name}"]'),
        "layouts": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{Name}"),
        "procedures": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{name}"),
        "crcs": ("{manufacturer}_{family}_{interface}_crc_{name}", "{family}.crc_{name}"),
        "data_ids": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_DATA_ID_{NAME}", "{family}.DataId"),
    }
)
#: Compare the content of two parts.
CompareContent = Callable[[FamilyPair, ChangeSubject, Any, Any], Iterator[Change]]


def compare_members(family_pair: FamilyPair, subject: ChangeSubject, old: Any, new: Any) -> Iterator[Change]:
    """Yield a change for each member (attribute) that differs between the old and the new version of a part.

    The table of members assigns a rule to each member, and the rule decides the impact of the change. Other functions
    compare the members without a rule. In the old version, references to renamed parts are replaced by the new names
    first, so that a renaming does not count as a change of the reference.
    """
    old = family_pair.with_new_names(old, subject.scope)
    members_by_name = {"source": _SOURCE_MEMBER, **PARTS_BY_CLASS[type(new).__name__].by_attribute}
    for attribute in fields(new):
        # An attribute that the table lacks still leads to a change, so that nothing is overlooked.
        member = members_by_name.get(attribute.name) or ModelMember(attribute.name, rule="unforeseen")
        # Other functions compare a member without a rule, for example for each order code.
        if member.rule:
            old_value, new_value = getattr(old, attribute.name), getattr(new, attribute.name)
            member_subject = subject.inside(attribute.name, subject.label)
            yield from compare_member(family_pair, member_subject, member, old_value, new_value)


def compare_member(
    family_pair: FamilyPair, subject: ChangeSubject, member: ModelMember, old: Any, new: Any
) -> Iterator[Change]:
    """Yield a change if two values of a member (an attribute of a part) differ.

    The rule of the change depends on what differs: the rule of the member if the value differs, "words" if only
    texts differ, or "source" if only citations differ. Limits and expressions are compared by their numbers. The
    description of a change of texts or citations names the member without its values.
    """
    types = {type(old), type(new)}
    # With an expression on one side, the other may be a number or None. A text has no value for each order code.
    is_expression = Expression in types and str not in types
    if member.is_limit or is_expression:
        yield from _compare_number(family_pair, subject, member, old, new)
        return
    if old == new:
        return
    if without_texts(old) != without_texts(new):
        rule = member.rule
    elif as_plain_data(old) == as_plain_data(new):
        rule = "source"
    else:
        rule = "words"
    if rule in _RULES_WITHOUT_VALUES:
        attribute_words = member.attribute.replace("_", " ")
        description = f": {attribute_words}"
    else:
        old_items, new_items = differing_items(old, new)
        description = f": {member.words} {old_to_new(old_items, new_items, member.notation)}"
    yield family_pair.change(rule, subject, description=description, old=old, new=new)


def _compare_number(
    family_pair: FamilyPair, subject: ChangeSubject, member: ModelMember, old: Any, new: Any
) -> Iterator[Change]:
    """Yield a change if two numbers or expressions have different values for an order code.

    If the member is a limit, and the new limit allows at least as much for every order code, the change gets the
    "wider" counterpart of the member's rule.
    """
    old_expression, new_expression = _as_expression(old), _as_expression(new)
    difference = family_pair.compare_expressions(subject.interface, old_expression, new_expression)
    if difference is None:
        return
    if difference.value_pairs:
        allows_less = any(_allows_less(member, old_value, new_value) for old_value, new_value in difference.value_pairs)
    else:
        # Without a common order code, the values cannot be compared. Only the removal of a limit surely allows more.
        allows_less = new is not None
    is_wider = member.is_limit and not allows_less
    rule = WIDER[member.rule] if is_wider else member.rule
    values_text = _difference_text(difference, old_expression, new_expression, member.notation)
    description = f": {member.words} {values_text}"
    # Without codes of its own, the change affects all order codes of the interface.
    yield family_pair.change(rule, subject, description=description, old=old, new=new, codes=difference.codes or None)


def _as_expression(number: Any) -> Any:
    """Return a number as an expression without parameters. An expression or None is returned as it is."""
    return Expression(number) if isinstance(number, int) else number


def _allows_less(member: ModelMember, old_limit: int | None, new_limit: int | None) -> bool:
    """Return whether a new limit allows less than the old one: a lower maximum, or a higher minimum.

    None means that there is no limit.
    """
    if new_limit is None:
        return False
    if old_limit is None:
        return True
    if member.is_upper:
        return new_limit < old_limit
    return new_limit > old_limit


def _difference_text(
    difference: NumberDifferences, old: Expression | None, new: Expression | None, notation: str
) -> str:
    """Return a text that shows how the values of two expressions differ, in the first form that applies.

    The forms are: ``17 → 19`` if all order codes and settings give the same pair of numbers, both expressions if their
    texts differ, and otherwise the first two pairs of numbers.
    """
    pair_texts = [old_to_new(old_value, new_value, notation) for old_value, new_value in difference.value_pairs]
    if len(pair_texts) == 1 and difference.is_everywhere:
        return pair_texts[0]
    old_text, new_text = short_value(old, notation), short_value(new, notation)
    if old_text != new_text:
        return f"{old_text} → {new_text}"
    # The expressions have the same text, so the value of a parameter in them has changed.
    return first_of(pair_texts, 2)


def compare_parts(
    family_pair: FamilyPair,
    part_kind: str,
    old_parts: Sequence[_Item],
    new_parts: Sequence[_Item],
    section_subject: ChangeSubject,
    compare_content: CompareContent | None = None,
) -> Iterator[Change]:
    """Yield the changes between two lists of parts: new, removed and renamed parts, and changed members of the others.

    Args:
        family_pair: The two versions of the family.
        part_kind: Kind of the parts. The names of their rules begin with it.
        old_parts: The parts of the old version.
        new_parts: The parts of the new version.
        section_subject: The section that contains them. Its label has the words that precede the name of a part.
        compare_content: Compares the content of a part that the table of members does not compare.
    """
    for pair in pair_parts(family_pair, old_parts, new_parts, section_subject.interface, section_subject.scope):
        subject = _subject_with_code_names(family_pair, pair, section_subject)
        yield from compare_pair(family_pair, part_kind, subject, pair, compare_content)


def compare_pair(
    family_pair: FamilyPair,
    part_kind: str,
    subject: ChangeSubject,
    pair: OldAndNew[Any],
    compare_content: CompareContent | None = None,
) -> Iterator[Change]:
    """Yield the changes of one part: that it is new, gone or renamed, and the changes of its members and content.

    ``subject`` names the part in the texts of the changes. ``compare_content`` compares content that the table of
    members does not compare. A decision with a default, which users need not make, has its own rules for its presence,
    such as "choice-new".
    """
    part = pair.new_or_old
    is_decision_with_default = isinstance(part, Alternative) and bool(part.default)
    presence_kind = "choice" if is_decision_with_default else part_kind
    yield from family_pair.compare_presence(presence_kind, subject, old=pair.old, new=pair.new)
    if pair.old is not None and pair.new is not None:
        yield from compare_members(family_pair, subject.unnamed, pair.old, pair.new)
        if compare_content is not None:
            yield from compare_content(family_pair, subject, pair.old, pair.new)


def compare_section(
    family_pair: FamilyPair, part_kind: str, compare_content: CompareContent | None = None
) -> Iterator[Change]:
    """Yield the changes of all parts of one kind that have a section in the spec, such as ``"register"``.

    The changes of a part concern its interface in the new version. The changes of removed parts, CRCs and procedures
    concern the interface in the old version.
    """
    section_path, label = _SECTION_BY_KIND[part_kind]
    for pair in pair_section(family_pair, section_path):
        # The labels of registers and connectors depend on the part, so a function returns them.
        section_label = label if isinstance(label, str) else label(pair)
        concerns_old_interface = part_kind in _KINDS_OF_OLD_INTERFACE and pair.old is not None
        if pair.new is None or concerns_old_interface:
            interface = _only_interface_of(family_pair.old, pair.old)
        else:
            interface = _only_interface_of(family_pair.new, pair.new)
        section_subject = ChangeSubject(path=section_path, label=section_label, interface=interface)
        subject = _subject_with_code_names(family_pair, pair, section_subject)
        yield from compare_pair(family_pair, part_kind, subject, pair, compare_content)


def _only_interface_of(device: Device, part: Any) -> str:
    """Return the name of the interface that a part concerns, or "" if it concerns several or all interfaces."""
    interfaces = _interfaces_of(device, part)
    return interfaces.pop() if len(interfaces) == 1 else ""


def _interfaces_of(device: Device, part: Any) -> set[str]:
    """Return the names of the interfaces that a part concerns, in which "" means all interfaces.

    A decision concerns the interfaces of its parameters, and an alarm the interfaces of its register and frames. A
    connector lists its interfaces, and a CRC concerns all interfaces that send it. Any other part has its own
    interface.
    """
    match part:
        case Alternative(name):
            return {parameter.interface for parameter in device.parameters if parameter.alternative == name}
        case Alarm():
            interfaces = {register.interface for register in device.registers if register.name == part.register}
            if part.group:
                for interface, layout in device.layouts():
                    if _has_group(layout, part.group):
                        interfaces.add(interface.name)
            return interfaces
        case Connector():
            return set(part.interfaces)
        case Crc(name=name):
            return {interface.name for interface in device.interfaces if name in sent_crcs((interface,))}
        case _:
            return {getattr(part, "interface", "")}


def _has_group(layout: Layout, group: str) -> bool:
    return any(field.group == group for field in layout.fields)


def _subject_with_code_names(
    family_pair: FamilyPair, pair: OldAndNew[Any], section_subject: ChangeSubject
) -> ChangeSubject:
    """Return the part of a section as the subject of changes, with the names by which users find it in their code.

    These are the names in the old version. A new part has no names that users know, except a new data ID, which
    extends an enumeration that they already use.
    """
    # The last step of the path, such as ``layouts`` of ``interfaces.ssi.layouts``.
    section = section_subject.path.rpartition(".")[2]
    part_name = pair.new_or_old.name
    subject = ChangeSubject(
        path=f"{section_subject.path}.{part_name}",
        label=f"{section_subject.label} {part_name}",
        interface=section_subject.interface,
        scope=section_subject.scope or part_name,
    )
    is_known_to_users = pair.old is not None or section == "data_ids"
    if section not in _NAME_PATTERNS or not is_known_to_users:
        return subject
    device = family_pair.new if pair.old is None else family_pair.old
    names_in_code = _name_in_code_by_language(device, section, pair.old_or_new, section_subject.interface)
    return replace(subject, names=names_in_code)


def _name_in_code_by_language(device: Device, section: str, part: Any, section_interface: str) -> dict[str, str]:
    """Return the names of a part in generated code: ``{"c": "acme_x24_ssi_frame_…", "python": "x24.Frame"}``.

    ``section_interface`` is "" for parts without an interface of their own. The name in C is then the name for the
    first interface. For a CRC without an interface, it is the beginning that all names share.
    """
    interface = section_interface or getattr(part, "interface", "")
    if not interface and device.interfaces:
        interface = device.interfaces[0].name
    text_by_placeholder = {
        "manufacturer": device.manufacturer.name,
        "family": device.name,
        "name": part.name,
        "interface": interface,
    }
    # Macros have the same words in capitals. ``Name`` is the name of a Python class.
    text_by_placeholder |= {
        placeholder.upper(): replacement.upper() for placeholder, replacement in text_by_placeholder.items()
    }
    words_of_name = part.name.split("_")
    text_by_placeholder["Name"] = "".join(word[:1].upper() + word[1:] for word in words_of_name)
    c_pattern, python_pattern = _NAME_PATTERNS[section]
    c_name = c_pattern.format(**text_by_placeholder)
    if section == "layouts" and len(device.interface(interface).layouts) == 1:
        # The only frame of an interface needs no further name.
        c_name = c_name.replace(f"_{part.name}_…", "_…")
    if section == "crcs" and not section_interface:
        # C has no function for a CRC that no frame uses.
        c_name = "{manufacturer}_{family}_…".format(**text_by_placeholder)
    return {"c": c_name, "python": python_pattern.format(**text_by_placeholder)}
