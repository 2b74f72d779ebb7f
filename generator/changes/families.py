"""Compare two libraries family by family: the family itself, its order codes, and the quantities that they set."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from operator import attrgetter

from ..model import Alternative, CodePart, Device, Manual, Measurement, Parameter, Spelling, Supply, Variant
from ..say import first_of
from .compare import compare_members, compare_parts, compare_section
from .consequences import (
    merge_equal_waits,
    merge_field_defaults,
    merge_similar_changes,
    merge_type_changes,
    with_consequences,
)
from .counterparts import pair_section, remember_all_renamings
from .family_pair import FamilyPair, OldAndNew, complete_pairs, pair_by_name
from .interfaces import compare_contacts, compare_displayed_facts, compare_interfaces, compare_timings
from .layouts_and_procedures import compare_procedure, compare_register
from .rules import Change, ChangeSubject, Impact
from .values import codes_as_pattern, old_to_new


def compare_family_itself(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield the changes of the family itself: name, title, movement, manufacturer, evidence and manual.

    If the edition of the manual changes, the text shows the old and the new edition. For any other difference of the
    manual, it only says "details".
    """
    old, new = family_pair.old, family_pair.new
    yield from family_pair.compare_presence(
        "family", ChangeSubject(path="device", label=f"family {new.name}"), old=old, new=new
    )
    if old.title != new.title:
        title_subject = ChangeSubject(path="title", label=new.name)
        yield family_pair.change("words", title_subject, description=": title", old=old.title, new=new.title)
    if old.movement != new.movement:
        movement_subject = ChangeSubject(path="movement", label=new.name)
        description = f": {old_to_new(old.movement, new.movement)}"
        yield family_pair.change(
            "movement", movement_subject, description=description, old=old.movement, new=new.movement
        )
    manufacturer = new.manufacturer.name
    manufacturer_subject = ChangeSubject(path=f"manufacturers.{manufacturer}", label=f"manufacturer {manufacturer}")
    yield from compare_members(family_pair, manufacturer_subject, old.manufacturer, new.manufacturer)
    yield from _compare_evidence(family_pair)
    if old.manual != new.manual:
        old_edition, new_edition = _edition_text(old.manual), _edition_text(new.manual)
        if old_edition != new_edition:
            description = f" {old_to_new(old_edition, new_edition)}"
        else:
            description = ": details"
        manual_subject = ChangeSubject(path="manual", label="manual")
        yield family_pair.change("manual", manual_subject, description=description, old=old.manual, new=new.manual)


def _compare_evidence(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield the changes of the evidence: the documents that the spec comes from and how they were read.

    If only one version has evidence, this is the change.
    """
    old, new = family_pair.old, family_pair.new
    subject = ChangeSubject(path="evidence", label="evidence")
    if old.evidence and new.evidence:
        yield from compare_members(family_pair, subject, old.evidence, new.evidence)
    elif old.evidence or new.evidence:  # With --lenient, a spec in an older form of the language has no evidence.
        description = " is new" if new.evidence else " is gone"
        yield family_pair.change("evidence", subject, description=description, old=old.evidence, new=new.evidence)


def _edition_text(manual: Manual) -> str:
    """Return the revision and date of a manual as text."""
    if not manual.date:
        return manual.revision
    return f"{manual.revision} of {manual.date}"


def compare_order_codes(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield order codes that are gone, new or renamed, and the changes of common codes, their parts and notations.

    An order code was renamed if its text changed, and the texts of its parts are the same.
    """
    old, new = family_pair.old, family_pair.new
    gone_codes = [variant.code for variant in old.variants if variant.code not in family_pair.new_code_by_old]
    new_codes = [variant.code for variant in new.variants if variant.code not in family_pair.common_new_codes]
    if gone_codes:
        subject = ChangeSubject(path="order_codes", label=_codes_label(old, gone_codes, "gone"))
        yield family_pair.change("order-code-gone", subject, description="", old=gone_codes, new=None, codes=gone_codes)
    if new_codes:
        subject = ChangeSubject(path="order_codes", label=_codes_label(new, new_codes, "new"))
        yield family_pair.change("order-code-new", subject, description="", old=None, new=new_codes, codes=new_codes)
    all_common_codes = family_pair.new_code_by_old.items()
    renamed_codes = {old_code: new_code for old_code, new_code in all_common_codes if old_code != new_code}
    old_order_code = old.order_code
    if renamed_codes:
        yield _renamed_codes_change(family_pair, renamed_codes)
        # The renaming is already reported, so the pattern that composes the order codes does not count as changed too.
        old_order_code = replace(old_order_code, pattern=new.order_code.pattern)
    yield from _compare_codes(family_pair)
    yield from compare_members(
        family_pair, ChangeSubject(path="order_code", label="order codes"), old_order_code, new.order_code
    )
    yield from compare_section(family_pair, "part", _compare_part_values)
    yield from _compare_spellings(family_pair)


def _codes_label(device: Device, codes: list[str], state: str) -> str:
    """Return ``order codes X-24…: 12 gone`` for several codes, or ``order code X-24-B is gone`` for one."""
    codes_text = codes_as_pattern(device, codes) or first_of(codes)
    if len(codes) > 1:
        return f"order codes {codes_text}: {len(codes)} {state}"
    return f"order code {codes_text} is {state}"


def _renamed_codes_change(family_pair: FamilyPair, new_code_by_old: Mapping[str, str]) -> Change:
    """Return the change of all renamed order codes, whose text shows the first one: ``X-24 → X-24-A``."""
    renaming_texts = [f"{old_code} → {new_code}" for old_code, new_code in new_code_by_old.items()]
    noun = "order codes" if len(new_code_by_old) > 1 else "order code"
    subject = ChangeSubject(path="order_codes", label=f"{noun} {first_of(renaming_texts, 1)} (the same parts)")
    old_codes = list(new_code_by_old)
    new_codes = list(new_code_by_old.values())
    return family_pair.change("order-code-renamed", subject, description="", old=old_codes, new=new_codes)


def _compare_codes(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield changes of the interface and of the parameters of order codes that both versions have.

    Order codes with the same old and new value share a change.
    """
    new_variant_by_code = {variant.code: variant for variant in family_pair.new.variants}
    variant_pairs: list[tuple[Variant, Variant]] = []
    for old_variant in family_pair.old.variants:
        new_code = family_pair.new_code_by_old.get(old_variant.code)
        if new_code is not None:
            variant_pairs.append((old_variant, new_variant_by_code[new_code]))
    yield from _compare_interfaces_of_codes(family_pair, variant_pairs)
    for old_parameter, new_parameter in complete_pairs(pair_section(family_pair, "parameters")):
        if _is_set_by_order_code(old_parameter) and _is_set_by_order_code(new_parameter):
            yield from _compare_parameter(family_pair, variant_pairs, old_parameter.name, new_parameter.name)


def _compare_interfaces_of_codes(
    family_pair: FamilyPair, variant_pairs: Iterable[tuple[Variant, Variant]]
) -> Iterator[Change]:
    """Yield a change for each pair of different old and new interface, with the order codes that have this pair."""
    codes_by_interfaces: dict[tuple[str, str], list[str]] = {}
    for old, new in variant_pairs:
        if old.interface != new.interface:
            codes_by_interfaces.setdefault((old.interface, new.interface), []).append(new.code)
    subject = ChangeSubject(path="order_codes.interface", label="order codes")
    for (old_interface, new_interface), codes in codes_by_interfaces.items():
        yield family_pair.change(
            "interface-of-code",
            subject,
            description=f": interface {old_to_new(old_interface, new_interface)}",
            old=old_interface,
            new=new_interface,
            codes=codes,
        )


def _compare_parameter(
    family_pair: FamilyPair, variant_pairs: Iterable[tuple[Variant, Variant]], old_name: str, new_name: str
) -> Iterator[Change]:
    """Yield changes of the numbers of a parameter for common order codes, one for each pair of old and new number.

    ``variant_pairs`` are the old and new variants of the common order codes.
    """
    pairs_by_numbers: dict[tuple[int, int], list[tuple[Variant, Variant]]] = {}
    for old_variant, new_variant in variant_pairs:
        old_number, new_number = old_variant.parameters[old_name], new_variant.parameters[new_name]
        if old_number != new_number:
            pairs_by_numbers.setdefault((old_number, new_number), []).append((old_variant, new_variant))
    subject = ChangeSubject(path=f"order_codes.parameters.{new_name}", label=new_name)
    for (old_number, new_number), pairs in pairs_by_numbers.items():
        codes = [new_variant.code for _, new_variant in pairs]
        description = f" {old_to_new(old_number, new_number)}{_lengths_text(family_pair, pairs)}"
        yield family_pair.change(
            "parameter-of-code", subject, description=description, old=old_number, new=new_number, codes=codes
        )


def _lengths_text(family_pair: FamilyPair, variant_pairs: Sequence[tuple[Variant, Variant]]) -> str:
    """Return a text on the frames whose length changes: ``: frame single_cycle_data 33 → 34 bits``, or "".

    ``variant_pairs`` are order codes with a changed parameter. If a frame has a different length for each order code,
    its length for the first order code is shown.
    """
    text_by_frame: dict[str, str] = {}
    for old_variant, new_variant in variant_pairs:
        old_bit_counts = _bit_count_by_frame(family_pair.old, old_variant)
        for frame, new_bit_count in _bit_count_by_frame(family_pair.new, new_variant).items():
            old_bit_count = old_bit_counts.get(frame, new_bit_count)
            if old_bit_count != new_bit_count:
                text_by_frame.setdefault(frame, f"{frame} {old_to_new(old_bit_count, new_bit_count)} bits")
    if not text_by_frame:
        return ""
    noun = "frames" if len(text_by_frame) > 1 else "frame"
    return f": {noun} {', '.join(text_by_frame.values())}"


def _bit_count_by_frame(device: Device, variant: Variant) -> Mapping[str, int]:
    """Return the number of bits in each frame of an order code, by the name of the frame."""
    bit_count_by_frame: dict[str, int] = {}
    for interface in device.interfaces:
        if interface.name == variant.interface:
            bit_count_by_frame |= {layout.name: layout.place(variant.parameters).bits for layout in interface.layouts}
    return bit_count_by_frame


def _is_set_by_order_code(parameter: Parameter) -> bool:
    """Return whether the order code sets the parameter, not a formula, a register or a decision of the user."""
    return parameter.equals is None and not parameter.read_from and not parameter.alternative


def _compare_part_values(
    family_pair: FamilyPair, subject: ChangeSubject, old: CodePart, new: CodePart
) -> Iterator[Change]:
    """Yield changes of the values of an order code part, for values whose text is in both versions.

    New and removed values need no change of their own, because they appear as new and removed order codes. A changed
    supply affects the order codes that contain the value, or all order codes if none contains it.
    """
    for old_value, new_value in complete_pairs(pair_by_name(old.values, new.values, name_of=attrgetter("text"))):
        value_subject = subject.inside(new_value.text, f"{subject.label}: value {new_value.text}")
        yield from compare_members(family_pair, value_subject, old_value, new_value)
        codes: list[str] = []
        for variant in family_pair.new.variants:
            if variant.parts.get(new.name) == new_value.text:
                codes.append(variant.code)
        # An empty interface represents all of them.
        affected_codes = tuple(codes) or family_pair.order_codes_with_interface(interface="")
        yield from compare_supply(family_pair, value_subject, old_value.supply, new_value.supply, affected_codes)


def _compare_spellings(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield changes of the additional notations in which order codes are written, for example on labels.

    An old and a new notation are compared if they are used at the same place (``where``). Of the remaining notations,
    an old and a new one with the same texts are one notation whose place was renamed.
    """

    def texts_of(spelling: Spelling) -> Hashable:
        """Return a notation with the new names of order code parts, without its place of use and its citation."""
        return replace(family_pair.with_new_names(spelling), where="", source=())

    old_spellings, new_spellings = family_pair.old.order_code.also_written, family_pair.new.order_code.also_written
    spelling_pairs = pair_by_name(old_spellings, new_spellings, texts_of, name_of=attrgetter("where"))
    for pair in spelling_pairs:
        subject = ChangeSubject(path="order_code.also_written", label=f"spelling by {pair.new_or_old.where}")
        old, new = pair.old, pair.new
        if old is None or new is None:
            yield from family_pair.compare_presence("spelling", subject, old=old, new=new)
        elif old.where != new.where:
            renaming = ChangeSubject(path=subject.path, label=f"spelling by {old.where} → {new.where} (the same texts)")
            yield family_pair.change("spelling-renamed", renaming, description="", old=old.where, new=new.where)
        else:
            yield from compare_members(family_pair, subject, old, new)


def compare_supply(
    family_pair: FamilyPair,
    subject: ChangeSubject,
    old: Supply | None,
    new: Supply | None,
    codes: tuple[str, ...] | None = None,
) -> Iterator[Change]:
    """Yield changes of the supply voltage or current of a family, or of the order codes ``codes``.

    If only the new version states a supply, the accepted range becomes narrower. If only the old version states it, the
    range becomes wider.
    """
    supply_label = f"{subject.label} supply".strip()  # The family itself has no label.
    supply_subject = subject.inside("supply", supply_label)
    if old is not None and new is not None:
        # The changes of members affect all order codes, so each change is created again for ``codes``.
        for change in compare_members(family_pair, supply_subject, old, new):
            yield family_pair.change(
                change.rule.name,
                ChangeSubject(path=change.path, label=change.text),
                description="",
                old=change.old,
                new=change.new,
                codes=codes,
            )
    elif old is not None or new is not None:
        rule = "supply-wider" if new is None else "supply-narrower"
        yield family_pair.change(
            rule, supply_subject, description=f" {old_to_new(old, new)}", old=old, new=new, codes=codes
        )


def compare_quantities(family_pair: FamilyPair) -> Iterator[Change]:
    """Yield changes of parameters, decisions, and measurements of the family and of its interfaces."""
    yield from compare_section(family_pair, "parameter")
    yield from compare_section(family_pair, "decision", _compare_answers)
    old, new = family_pair.old, family_pair.new
    family_subject = ChangeSubject(path="measurement", label="measurement")
    yield from _compare_measurement(family_pair, family_subject, old.measurement, new.measurement)
    for old_interface, new_interface in complete_pairs(pair_by_name(old.interfaces, new.interfaces)):
        interface_subject = ChangeSubject(
            path=f"interfaces.{new_interface.name}.measurement",
            label=f"{new_interface.short} measurement",
            interface=new_interface.name,
        )
        yield from _compare_measurement(
            family_pair, interface_subject, old_interface.measurement, new_interface.measurement
        )


def _compare_measurement(
    family_pair: FamilyPair, subject: ChangeSubject, old: Measurement | None, new: Measurement | None
) -> Iterator[Change]:
    """Yield the changes of a measurement, or that it is new or gone."""
    if old is not None and new is not None:
        yield from compare_members(family_pair, subject, old, new)
    elif old is not None or new is not None:
        yield from family_pair.compare_presence("measurement", subject, old=old, new=new)


def _compare_answers(
    family_pair: FamilyPair, subject: ChangeSubject, old: Alternative, new: Alternative
) -> Iterator[Change]:
    """Yield the changes of the answers to a question that the manual leaves open."""
    answer_subject = replace(subject, label=f"{subject.label}: answer")
    yield from compare_parts(
        family_pair, part_kind="answer", old_parts=old.answers, new_parts=new.answers, section_subject=answer_subject
    )


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Return all changes of all families, by family name and then by descending impact.

    A missing family was renamed if a new family has the same order codes, or if each version has only one family. A
    device that is the same object in both versions is unchanged.
    """
    changes: list[Change] = []
    pairs = pair_by_name(old, new, _set_of_order_codes)
    if len(old) == len(new) == 1:
        pairs = [OldAndNew(old=old[0], new=new[0])]
    for pair in sorted(pairs, key=lambda pair: pair.new_or_old.name):
        if pair.old is None or pair.new is None:
            # Only the presence of the family is compared, so one device represents both versions.
            only_device = pair.new_or_old
            subject = ChangeSubject(path="", label=f"family {only_device.name}")
            old_name = pair.old.name if pair.old is not None else None
            new_name = pair.new.name if pair.new is not None else None
            family_pair = FamilyPair(only_device, only_device)
            changes += family_pair.compare_presence("family", subject, old=old_name, new=new_name)
        elif pair.old is not pair.new:
            changes += compare_family(pair.old, pair.new)
    return changes


def _set_of_order_codes(device: Device) -> frozenset[str]:
    return frozenset(variant.code for variant in device.variants)


def _section_changes(family_pair: FamilyPair) -> Iterator[Change]:
    """Return the changes of each section of the specs in turn, before repeated and similar changes are merged."""
    old, new = family_pair.old, family_pair.new
    return chain(
        compare_family_itself(family_pair),
        compare_order_codes(family_pair),
        compare_quantities(family_pair),
        compare_section(family_pair, "crc"),
        compare_interfaces(family_pair),
        compare_section(family_pair, "register", compare_register),
        compare_section(family_pair, "alarm"),
        compare_section(family_pair, "procedure", compare_procedure),
        compare_timings(family_pair, ChangeSubject(path="", label=""), old.timings, new.timings),
        compare_supply(family_pair, ChangeSubject(path="", label=""), old.supply, new.supply),
        compare_section(family_pair, "connector", compare_contacts),
        compare_section(family_pair, "input"),
        compare_displayed_facts(family_pair),
    )


def compare_family(old: Device, new: Device) -> list[Change]:
    """Return all changes of a family, by descending impact.

    Renamings are found first, because references to renamed parts do not count as changes. If the devices differ but no
    other change is found, only the order of the parts has changed.
    """
    family_pair = FamilyPair(old, new)
    remember_all_renamings(family_pair)
    changes = list(_merge_repeated(_section_changes(family_pair)))
    changes = list(merge_field_defaults(changes))
    changes = list(merge_type_changes(changes))
    changes = list(merge_similar_changes(changes))
    changes = list(merge_equal_waits(changes))
    if not changes and _without_spec_data(old) != _without_spec_data(new):
        subject = ChangeSubject(path="", label=f"family {new.name}")
        changes.append(
            family_pair.change("order", subject, description=": different order, same facts", old=None, new=None)
        )
    # Changes with the same impact stay in the order of the sections.
    return sorted(changes, key=lambda change: -change.impact)


def _without_spec_data(device: Device) -> Device:
    """Return a device without data about its spec: number of readings of the manual, history, hash and version."""
    manufacturer = replace(device.manufacturer, version="")
    return replace(device, times_read=None, releases=(), content_hash="", manufacturer=manufacturer)


def _merge_repeated(changes: Iterable[Change]) -> Iterator[Change]:
    """Yield each change once, with the order codes and consequences of its repetitions.

    Changes with the same rule and text are repetitions, for example if several frames contain the same changed group
    of fields. Changes that only affect documentation are repetitions if they have the same rule and path.
    """
    change_by_key: dict[tuple[str, str], Change] = {}
    for change in changes:
        # Documentation of one place is one change, even if its text names different frames.
        is_documentation = change.impact <= Impact.DOCUMENTATION
        path_or_text = change.path if is_documentation else change.text
        change_key = change.rule.name, path_or_text
        if change_key in change_by_key:
            change_by_key[change_key] = _merge_pair(change_by_key[change_key], change)
        else:
            change_by_key[change_key] = change
    yield from map(with_consequences, change_by_key.values())


def _merge_pair(first_change: Change, repeated_change: Change) -> Change:
    """Return the first change with the order codes and the consequences of both.

    If the repeated change affects more order codes, the descriptions of both are joined: ``X-24-…; all 6 SSI order
    codes``.
    """
    moved_fields = dict.fromkeys((*first_change.moved_fields, *repeated_change.moved_fields))
    codes = tuple(dict.fromkeys((*first_change.codes, *repeated_change.codes)))
    affected_codes_text = first_change.affected_codes_text
    if codes != first_change.codes:
        affected_codes_text += f"; {repeated_change.affected_codes_text}"
    return replace(
        first_change,
        moved_fields=tuple(moved_fields),
        resized_frames={**first_change.resized_frames, **repeated_change.resized_frames},
        codes=codes,
        affected_codes_text=affected_codes_text,
    )
