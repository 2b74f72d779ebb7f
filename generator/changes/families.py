"""Compare two libraries family by family: the family itself, its order codes, and the quantities that they set."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from operator import attrgetter

from ..model import Alternative, CodePart, Device, Manual, Parameter, Spelling, Supply, Variant
from ..say.plain_text import first_of
from .compare import compare_members, compare_parts, compare_section
from .consequences import fold_alike, fold_defaults, fold_types, with_consequences
from .counterparts import FamilyPair, in_section, note_all
from .interfaces import contacts, displayed, interfaces, procedure, register, timings
from .pairs import Pair, both_of, paired
from .rules import Change, Impact, Subject
from .values import arrow, pattern


def family(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare the family itself, its manufacturer and its manual."""
    old, new = family_pair.old, family_pair.new
    yield from family_pair.presence("family", Subject("device", f"family {new.name}"), old, new)
    if old.title != new.title:
        title_subject = Subject("title", new.name)
        yield family_pair.change("words", title_subject, ": title", old.title, new.title)
    if old.movement != new.movement:
        movement_subject = Subject("movement", new.name)
        description = f": {arrow(old.movement, new.movement)}"
        yield family_pair.change("movement", movement_subject, description, old.movement, new.movement)
    manufacturer = Subject(f"manufacturers.{new.manufacturer.name}", f"manufacturer {new.manufacturer.name}")
    yield from compare_members(family_pair, manufacturer, old.manufacturer, new.manufacturer)
    evidence = Subject("evidence", "evidence")
    if old.evidence and new.evidence:
        yield from compare_members(family_pair, evidence, old.evidence, new.evidence)
    elif old.evidence or new.evidence:  # With --lenient, a spec in an older form of the language has none.
        description = " is new" if new.evidence else " is gone"
        yield family_pair.change("evidence", evidence, description, old.evidence, new.evidence)
    if old.manual != new.manual:
        old_edition, new_edition = _edition(old.manual), _edition(new.manual)
        is_other_edition = old_edition != new_edition
        description = f" {arrow(old_edition, new_edition)}" if is_other_edition else ": details"
        yield family_pair.change("manual", Subject("manual", "manual"), description, old.manual, new.manual)


def _edition(manual: Manual) -> str:
    """Return the revision and date of a manual as text."""
    return f"{manual.revision} of {manual.date}" if manual.date else manual.revision


def order_codes(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare the order codes, the values of their parts, and their additional notations."""
    old, new = family_pair.old, family_pair.new
    gone_codes = [variant.code for variant in old.variants if variant.code not in family_pair.shared]
    new_codes = [variant.code for variant in new.variants if variant.code not in family_pair.kept]
    if gone_codes:
        label = _codes_label(old, gone_codes, "gone")
        yield family_pair.change("order-code-gone", Subject("order_codes", label), "", gone_codes, None, gone_codes)
    if new_codes:
        label = _codes_label(new, new_codes, "new")
        yield family_pair.change("order-code-new", Subject("order_codes", label), "", None, new_codes, new_codes)
    renamed = {old_code: new_code for old_code, new_code in family_pair.shared.items() if old_code != new_code}
    old_order_code = old.order_code
    if renamed:
        yield _renamed_codes(family_pair, renamed)
        # A different pattern is the reason for the renaming, which is reported.
        old_order_code = replace(old_order_code, pattern=new.order_code.pattern)
    yield from _compare_codes(family_pair)
    yield from compare_members(family_pair, Subject("order_code", "order codes"), old_order_code, new.order_code)
    yield from compare_section(family_pair, "part", _compare_part_values)
    yield from _compare_spellings(family_pair)


def _codes_label(device: Device, codes: list[str], state: str) -> str:
    """Return a sentence on order codes that are gone or new."""
    codes_text = pattern(device, codes) or first_of(codes)
    if len(codes) > 1:
        return f"order codes {codes_text}: {len(codes)} {state}"
    return f"order code {codes_text} is {state}"


def _renamed_codes(family_pair: FamilyPair, renamed: Mapping[str, str]) -> Change:
    """Return the change of order codes with a different text, given by the old ones."""
    renamings = first_of([f"{old_code} → {new_code}" for old_code, new_code in renamed.items()], 1)
    noun = "order codes" if len(renamed) > 1 else "order code"
    subject = Subject("order_codes", f"{noun} {renamings} (the same parts)")
    return family_pair.change("order-code-renamed", subject, "", list(renamed), list(renamed.values()))


def _compare_codes(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare the interface and the numbers of order codes that both versions have."""
    new_by_code = {variant.code: variant for variant in family_pair.new.variants}
    shared = family_pair.shared
    variant_pairs = [
        (variant, new_by_code[shared[variant.code]]) for variant in family_pair.old.variants if variant.code in shared
    ]
    codes_by_interfaces: dict[tuple[str, str], list[str]] = {}
    for old, new in variant_pairs:
        if old.interface != new.interface:
            codes_by_interfaces.setdefault((old.interface, new.interface), []).append(new.code)
    subject = Subject("order_codes.interface", "order codes")
    for (old_interface, new_interface), codes in codes_by_interfaces.items():
        description = f": interface {arrow(old_interface, new_interface)}"
        yield family_pair.change("interface-of-code", subject, description, old_interface, new_interface, codes)
    for old_parameter, new_parameter in both_of(in_section(family_pair, "parameters")):
        if _is_of_code(old_parameter) and _is_of_code(new_parameter):
            yield from _compare_numbers(family_pair, variant_pairs, old_parameter.name, new_parameter.name)


def _compare_numbers(
    family_pair: FamilyPair, variant_pairs: Iterable[tuple[Variant, Variant]], old_name: str, new_name: str
) -> Iterator[Change]:
    """Compare the numbers that a parameter has for order codes that both versions have."""
    codes_by_numbers: dict[tuple[int, int], list[str]] = {}
    for old, new in variant_pairs:
        old_number, new_number = old.parameters[old_name], new.parameters[new_name]
        if old_number != new_number:
            codes_by_numbers.setdefault((old_number, new_number), []).append(new.code)
    subject = Subject(f"order_codes.parameters.{new_name}", new_name)
    for (old_number, new_number), codes in codes_by_numbers.items():
        description = f" {arrow(old_number, new_number)}"
        yield family_pair.change("parameter-of-code", subject, description, old_number, new_number, codes)


def _is_of_code(parameter: Parameter) -> bool:
    """Return whether order codes set it, rather than a formula, a register or a decision."""
    return parameter.equals is None and not parameter.read_from and not parameter.alternative


def _compare_part_values(family_pair: FamilyPair, subject: Subject, old: CodePart, new: CodePart) -> Iterator[Change]:
    """Compare the values that the part has in both versions. Other changes are visible in the order codes."""
    for old_value, new_value in both_of(paired(old.values, new.values, name=attrgetter("text"))):
        inner = subject.inside(new_value.text, f"{subject.label}: value {new_value.text}")
        yield from compare_members(family_pair, inner, old_value, new_value)
        variants = family_pair.new.variants
        codes = tuple(variant.code for variant in variants if variant.parts.get(new.name) == new_value.text)
        yield from supply(family_pair, inner, old_value.supply, new_value.supply, codes or family_pair.codes(""))


def _compare_spellings(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare the additional notations for labels. One is recognised by its texts, apart from where it is used."""

    def texts_of(spelling: Spelling) -> Hashable:
        return replace(family_pair.in_new(spelling), where="", source=())

    old_spellings, new_spellings = family_pair.old.order_code.also_written, family_pair.new.order_code.also_written
    for pair in paired(old_spellings, new_spellings, texts_of, name=attrgetter("where")):
        subject = Subject("order_code.also_written", f"spelling by {pair.item.where}")
        old, new = pair.old, pair.new
        if old is None or new is None:
            yield from family_pair.presence("spelling", subject, old, new)
        elif old.where != new.where:
            renamed = Subject(subject.path, f"spelling by {old.where} → {new.where} (the same texts)")
            yield family_pair.change("spelling-renamed", renamed, "", old.where, new.where)
        else:
            yield from compare_members(family_pair, subject, old, new)


def supply(
    family_pair: FamilyPair,
    subject: Subject,
    old: Supply | None,
    new: Supply | None,
    codes: tuple[str, ...] | None = None,
) -> Iterator[Change]:
    """Compare the supply of a family, or of an order code value that ``codes`` have."""
    supply_subject = subject.inside("supply", f"{subject.label} supply".strip())
    if old is not None and new is not None:
        for change in compare_members(family_pair, supply_subject, old, new):
            yield family_pair.change(
                change.rule.name, Subject(change.path, change.text), "", change.old, change.new, codes
            )
    elif old is not new:
        rule = "supply-wider" if new is None else "supply-narrower"
        yield family_pair.change(rule, supply_subject, f" {arrow(old, new)}", old, new, codes)


def quantities(family_pair: FamilyPair) -> Iterator[Change]:
    """Compare parameters, decisions and the measurement."""
    yield from compare_section(family_pair, "parameter")
    yield from compare_section(family_pair, "decision", _compare_answers)
    measured = [(Subject("measurement", "measurement"), family_pair.old.measurement, family_pair.new.measurement)]
    for old, new in both_of(paired(family_pair.old.interfaces, family_pair.new.interfaces)):
        subject = Subject(f"interfaces.{new.name}.measurement", f"{new.short} measurement", new.name)
        measured.append((subject, old.measurement, new.measurement))
    for subject, old_measurement, new_measurement in measured:
        if old_measurement is not None and new_measurement is not None:
            yield from compare_members(family_pair, subject, old_measurement, new_measurement)
        elif old_measurement is not new_measurement:
            yield from family_pair.presence("measurement", subject, old_measurement, new_measurement)


def _compare_answers(family_pair: FamilyPair, subject: Subject, old: Alternative, new: Alternative) -> Iterator[Change]:
    yield from compare_parts(
        family_pair, "answer", old.answers, new.answers, replace(subject, label=f"{subject.label}: answer")
    )


def compare(old: Sequence[Device], new: Sequence[Device]) -> list[Change]:
    """Return all changes of all families, by family name and then by descending impact.

    A missing family was renamed if a new one has the same order codes, or if there is only one of each.
    """
    changes: list[Change] = []
    pairs = paired(old, new, lambda device: frozenset(variant.code for variant in device.variants))
    if len(old) == len(new) == 1:
        pairs = [Pair(old[0], new[0])]
    for pair in sorted(pairs, key=lambda pair: pair.item.name):
        if pair.old is None or pair.new is None:
            old_name = pair.old.name if pair.old is not None else None
            new_name = pair.new.name if pair.new is not None else None
            subject = Subject("", f"family {pair.item.name}")
            changes += FamilyPair(pair.item, pair.item).presence("family", subject, old_name, new_name)
        elif pair.old is not pair.new:
            changes += compare_family(pair.old, pair.new)
    return changes


def _section_changes(family_pair: FamilyPair) -> Iterator[Change]:
    """Return the changes of each section of the specs in turn."""
    old, new = family_pair.old, family_pair.new
    return chain(
        family(family_pair),
        order_codes(family_pair),
        quantities(family_pair),
        compare_section(family_pair, "crc"),
        interfaces(family_pair),
        compare_section(family_pair, "register", register),
        compare_section(family_pair, "alarm"),
        compare_section(family_pair, "procedure", procedure),
        timings(family_pair, Subject("", ""), old.timings, new.timings),
        supply(family_pair, Subject("", ""), old.supply, new.supply),
        compare_section(family_pair, "connector", contacts),
        compare_section(family_pair, "input"),
        displayed(family_pair),
    )


def compare_family(old: Device, new: Device) -> list[Change]:
    """Return all changes of a family, by descending impact."""
    family_pair = FamilyPair(old, new)
    note_all(family_pair)
    changes = list(_merge_repeated(_section_changes(family_pair)))
    changes = list(fold_alike(list(fold_types(list(fold_defaults(changes))))))
    if not changes and _without_spec_data(old) != _without_spec_data(new):
        subject = Subject("", f"family {new.name}")
        changes.append(family_pair.change("order", subject, ": different order, same facts", None, None))
    return sorted(changes, key=lambda change: -change.impact)


def _without_spec_data(device: Device) -> Device:
    """Return a family without data about the spec itself: number of readings, history, hash and version."""
    maker = replace(device.manufacturer, version="")
    return replace(device, times_read=None, releases=(), content_hash="", manufacturer=maker)


def _merge_repeated(changes: Iterable[Change]) -> Iterator[Change]:
    """Return each change once. Changes of a field group in many frames are reported for the group."""
    merged: dict[tuple[str, str], Change] = {}
    for change in changes:
        # Documentation of one place is one change, even if its text names different frames.
        identity = change.text if change.impact > Impact.DOCUMENTATION else change.path
        key = change.rule.name, identity
        if key not in merged:
            merged[key] = change
            continue
        earlier_change = merged[key] = _with_consequences_of_both(merged[key], change)
        codes = tuple(dict.fromkeys((*earlier_change.codes, *change.codes)))
        if codes != earlier_change.codes:
            merged[key] = replace(earlier_change, codes=codes, reach=f"{earlier_change.reach}; {change.reach}")
    yield from map(with_consequences, merged.values())


def _with_consequences_of_both(change: Change, repeated_change: Change) -> Change:
    moved_fields = tuple(dict.fromkeys((*change.moved_fields, *repeated_change.moved_fields)))
    resized_frames = {**change.resized_frames, **repeated_change.resized_frames}
    return replace(change, moved_fields=moved_fields, resized_frames=resized_frames)
