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
from ..say.names_and_places import register_at
from ..say.plain_text import first_of
from .counterparts import pair_parts, pair_section
from .family_pair import FamilyPair
from .pairs import OldAndNew
from .rules import Change, ChangeSubject
from .values import NumberDifferences, as_plain_data, differing_items, old_to_new, short_value, without_texts

_Item = TypeVar("_Item")
#: Rules whose changes are described only by their location.
_WITHOUT_VALUES = ("words", "source")
_SOURCE_MEMBER = ModelMember("source", rule="source")
#: Kinds of things with a section in the spec: the path of the section, and the words that precede the name of a thing.
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
#: Kinds of things that concern the interface of the old thing even if the new one has another.
_KINDS_OF_OLD_INTERFACE = ("crc", "procedure")
#: Names of things in C and in Python, so that users can search their code for them: by section, with the manufacturer,
#: the family and the thing itself.
_NAME_PATTERNS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "registers": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_REG_{NAME}_…", '{family}.REGISTERS["{name}"]'),
        "layouts": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{Name}"),
        "procedures": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{name}"),
        "crcs": ("{manufacturer}_{family}_{interface}_crc_{name}", "{family}.crc_{name}"),
        "data_ids": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_DATA_ID_{NAME}", "{family}.DataId"),
    }
)
#: Compare the content of two things.
CompareContent = Callable[[FamilyPair, ChangeSubject, Any, Any], Iterator[Change]]


def compare_members(family_pair: FamilyPair, subject: ChangeSubject, old: Any, new: Any) -> Iterator[Change]:
    """Yield a change for each member of a part that differs, by the rule of the member.

    Members without a rule are compared elsewhere. References are compared by the new names of the things.
    """
    old = family_pair.with_new_names(old, subject.scope)
    members_by_name = {"source": _SOURCE_MEMBER, **PARTS_BY_CLASS[type(new).__name__].by_attribute}
    for attribute in fields(new):
        # An attribute that the table lacks still leads to a change, so that nothing is overlooked.
        member = members_by_name.get(attribute.name) or ModelMember(attribute.name, rule="unforeseen")
        # A member without a rule is compared elsewhere, or by its order code.
        if member.rule:
            old_value, new_value = getattr(old, attribute.name), getattr(new, attribute.name)
            member_subject = subject.inside(attribute.name, subject.label)
            yield from compare_member(family_pair, member_subject, member, old_value, new_value)


def compare_member(
    family_pair: FamilyPair, subject: ChangeSubject, member: ModelMember, old: Any, new: Any
) -> Iterator[Change]:
    """Yield a change if the member differs: in its value, else in its texts, else in its citations.

    Limits and expressions are compared by their numbers. For changes of texts and citations, only the member is named.
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
    if rule in _WITHOUT_VALUES:
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

    For a limit that allows less nowhere, the rule is the "wider" counterpart of the member's rule.
    """
    old_expression, new_expression = _as_expression(old), _as_expression(new)
    difference = family_pair.compare_expressions(subject.interface, old_expression, new_expression)
    if difference is None:
        return
    if difference.value_pairs:
        allows_less = any(_allows_less(member, old_value, new_value) for old_value, new_value in difference.value_pairs)
    else:
        # Without a common order code, only a limit that is gone is certain to allow more.
        allows_less = new is not None
    is_wider = member.is_limit and not allows_less
    rule = WIDER[member.rule] if is_wider else member.rule
    values_text = _difference_text(difference, old_expression, new_expression, member.notation)
    description = f": {member.words} {values_text}"
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
    """Return the differing values of two expressions, by the first of these forms that applies.

    ``17 → 19`` if all settings give the same pair of numbers, the two expressions if their texts differ, or the first
    two pairs of numbers.
    """
    pair_texts = [old_to_new(old_value, new_value, notation) for old_value, new_value in difference.value_pairs]
    if len(pair_texts) == 1 and difference.is_everywhere:
        return pair_texts[0]
    old_text, new_text = short_value(old, notation), short_value(new, notation)
    if old_text != new_text:
        return f"{old_text} → {new_text}"
    # The same expression has other values if the value of a parameter in it changes. The first two pairs of values are
    # shown.
    return first_of(pair_texts, 2)


def compare_parts(
    family_pair: FamilyPair,
    part_kind: str,
    old_parts: Sequence[_Item],
    new_parts: Sequence[_Item],
    section_subject: ChangeSubject,
    compare_content: CompareContent | None = None,
) -> Iterator[Change]:
    """Yield the changes of several things: the new, removed and renamed ones, and changed members of the rest.

    Args:
        family_pair: The two versions of the family.
        part_kind: Kind of the things, with which the names of their rules begin.
        old_parts: The old things.
        new_parts: The new things.
        section_subject: The section that contains them. Its label has the words that precede the name of a thing.
        compare_content: Compare the content of a thing that the table of members does not compare.
    """
    for pair in pair_parts(family_pair, old_parts, new_parts, section_subject.interface, section_subject.scope):
        subject = _named_in_code(family_pair, pair, section_subject)
        yield from compare_pair(family_pair, part_kind, subject, pair, compare_content)


def compare_pair(
    family_pair: FamilyPair,
    part_kind: str,
    subject: ChangeSubject,
    pair: OldAndNew[Any],
    compare_content: CompareContent | None = None,
) -> Iterator[Change]:
    """Yield the changes of one thing: new, gone or renamed, or changes of its members and content.

    ``subject`` is the thing, and ``compare_content`` is as in ``compare_parts``. A decision with a default, which
    users need not make, has its own rules for its presence, such as "choice-new".
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
    """Yield the changes of all things in a section of the spec, such as ``"register"``, a key of ``_SECTION_BY_KIND``.

    A thing concerns its interface in the new version. Removed things, CRCs and procedures concern the interface in the
    old version.
    """
    section_path, label = _SECTION_BY_KIND[part_kind]
    for pair in pair_section(family_pair, section_path):
        section_label = label if isinstance(label, str) else label(pair)
        concerns_old_interface = part_kind in _KINDS_OF_OLD_INTERFACE and pair.old is not None
        if pair.new is None or concerns_old_interface:
            interface = _only_interface_of(family_pair.old, pair.old)
        else:
            interface = _only_interface_of(family_pair.new, pair.new)
        section_subject = ChangeSubject(path=section_path, label=section_label, interface=interface)
        subject = _named_in_code(family_pair, pair, section_subject)
        yield from compare_pair(family_pair, part_kind, subject, pair, compare_content)


def _only_interface_of(device: Device, part: Any) -> str:
    """Return the only interface that a thing of a section concerns, or "" if it concerns several or all."""
    interfaces = _interfaces_of(device, part)
    return interfaces.pop() if len(interfaces) == 1 else ""


def _interfaces_of(device: Device, part: Any) -> set[str]:
    """Return the names of the interfaces that a thing concerns, in which "" stands for all.

    These are the interfaces of a decision's parameters, of an alarm's register and frames, of a connector, or all that
    send a CRC. Any other thing has its own interface.
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


def _named_in_code(family_pair: FamilyPair, pair: OldAndNew[Any], section_subject: ChangeSubject) -> ChangeSubject:
    """Return a thing of a section as a subject, with its old names in code if it has any.

    A new thing has no names known to users, except a new data ID, which extends an enumeration that they already use.
    """
    # The last step of the path, such as ``layouts`` of ``interfaces.ssi.layouts``.
    section = section_subject.path.rpartition(".")[2]
    thing_name = pair.new_or_old.name
    subject = ChangeSubject(
        path=f"{section_subject.path}.{thing_name}",
        label=f"{section_subject.label} {thing_name}",
        interface=section_subject.interface,
        scope=section_subject.scope or thing_name,
    )
    is_known_to_users = pair.old is not None or section == "data_ids"
    if section not in _NAME_PATTERNS or not is_known_to_users:
        return subject
    device = family_pair.new if pair.old is None else family_pair.old
    names_in_code = _names_in_code(device, section, pair.old_or_new, section_subject.interface)
    return replace(subject, names=names_in_code)


def _names_in_code(device: Device, section: str, part: Any, section_interface: str) -> dict[str, str]:
    """Return the names of a thing of a section in code: ``{"c": "acme_x24_ssi_frame_…", "python": "x24.Frame"}``.

    ``section_interface`` is "" for things without an interface of their own. The name in C is then the name for the
    first interface, or for a CRC the part that all names share.
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
