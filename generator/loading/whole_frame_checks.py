"""Checks for whole frames: whether they can be distinguished, and the verdicts of reserved bits and errata."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from ..language.document import Path
from ..language.problems import DocumentReport, join_words, quoted
from ..model import (
    Biss,
    Constant,
    Device,
    Erratum,
    Field,
    Flag,
    Interface,
    Layout,
    Number,
    Rs485,
    Spi,
    Ssi,
    Unused,
    Verdict,
)
from .fields import SpecPlace
from .frame_rules import check_channels
from .spec_parts import Raw, valid_parts_so_far

#: Regular expressions for verdicts in the text of errata. A longer phrase comes before a phrase that it contains.
_VERDICT_PATTERNS = (
    (Verdict.NOT_USABLE, r"not usable|unusable|not_usable"),
    (Verdict.USABLE_WITH_WARNING, r"usable,? with a warning|usable_with_warning"),
    (Verdict.UNKNOWN, r"(?:position|verdict|it) (?:is|becomes|stays) (?:then )?unknown"),
    (Verdict.USABLE, r"\busable\b"),
)


def with_unknown_verdicts(layout: Layout, raw_fields: Iterable[Raw], spec_place: SpecPlace) -> Layout:
    """Return a layout with UNKNOWN as the verdict of reserved bits, if no flag says whether the position is usable.

    Without such a flag, the verdict is always unknown. ``raw_fields``, the fields in the spec, must therefore not give
    reserved bits the verdict "usable with a warning".
    """
    if layout.judges_position:
        return layout
    _report_stated_warnings(layout, raw_fields, spec_place)
    return layout.with_unknown_verdicts()


def _report_stated_warnings(layout: Layout, raw_fields: Iterable[Raw], spec_place: SpecPlace) -> None:
    """Report reserved bits that the spec gives the verdict "usable with a warning"."""
    for index, raw_field in enumerate(raw_fields):
        is_reserved = "unused" in raw_field
        if is_reserved and raw_field.get("makes_position") == Verdict.USABLE_WITH_WARNING.value:
            problem = f"no flag of '{layout.name}' says whether the position is usable, so the verdict stays unknown"
            spec_place.report(
                "reserved-verdict", f"{problem}; remove 'makes_position'", "fields", index, "makes_position"
            )


def check_errata(device: Device, report: DocumentReport) -> None:
    """Check that errata about flags only state verdicts that decoders give.

    The first wrong verdict in the text ``used`` of an erratum is reported. An erratum that affects no flag or unused
    bit with a verdict is not checked.
    """
    is_derived = bool(device.base)
    if is_derived:  # The original family has the same errata, and is checked.
        return
    for erratum in device.errata:
        decoder_verdicts = set(_verdicts_of_affected_bits(device, erratum))
        wrong_verdicts = [verdict for verdict in _verdicts_in_text(erratum.used) if verdict not in decoder_verdicts]
        if not decoder_verdicts or not wrong_verdicts:
            continue
        verdict_texts = [quoted(verdict.value) for verdict in Verdict if verdict in decoder_verdicts]
        possible_verdicts = join_words(verdict_texts, "or")
        problem = f"'used' states the verdict {quoted(wrong_verdicts[0].value)}"
        message = f"{problem}, but for the affected bits, decoders give {possible_verdicts}; correct one of the two"
        report.add("erratum-verdict", ("errata", erratum.name, "used"), message)


def _verdicts_in_text(text_of_erratum: str) -> Iterator[Verdict]:
    """Yield the verdicts that a text names.

    Each one that is found is removed from the text, so that "usable" is not found in "not usable".
    """
    remaining_text = " ".join(text_of_erratum.split())
    for verdict, pattern in _VERDICT_PATTERNS:
        remaining_text, count = re.subn(pattern, "", remaining_text)
        if count:
            yield verdict


def _verdicts_of_affected_bits(device: Device, erratum: Erratum) -> Iterator[Verdict]:
    """Yield the verdicts that decoders can give because of the flags and unused bits that an erratum affects.

    These are the verdicts for each active bit, and the verdict if all bits are inactive. A frame without a flag that
    says whether the position is usable has at best the verdict UNKNOWN.
    """
    for interface in device.interfaces:
        for layout in interface.layouts:
            layout_path = f"interfaces.{interface.name}.{layout.name}"
            verdicts: list[Verdict] = []
            for field in layout.fields:
                if _is_affected(field, layout_path, erratum):
                    verdicts += _verdicts_of_field(field)
            if not verdicts:
                continue
            if layout.judges_position:
                yield from verdicts
                yield Verdict.USABLE
                depends_on_order_code = not layout.judges_if_positive.is_constant
                if depends_on_order_code:
                    yield Verdict.UNKNOWN
            else:
                yield from map(_at_best_unknown, verdicts)
                yield Verdict.UNKNOWN


def _is_affected(field: Field, layout_path: str, erratum: Erratum) -> bool:
    """Return whether an erratum affects a field: directly, or because it affects the whole layout or field group.

    ``layout_path`` is the path of the layout that contains the field.
    """
    paths_with_field = [layout_path]
    if field.group:
        paths_with_field.append(f"field_groups.{field.group}")
    for path in paths_with_field:
        if path in erratum.affects or f"{path}.{field.name}" in erratum.affects:
            return True
    return False


def _verdicts_of_field(field: Field) -> Iterator[Verdict]:
    """Yield all verdicts on the position that a flag or unused bit can lead to while it is active.

    ``makes_position`` is its own verdict. A flag can also have ``verdict_if_set``, the verdict for a different answer
    to a question that the manual leaves open. If the manual explains the flag only for some order codes, the verdict
    for all others is added.
    """
    kind = field.kind
    if isinstance(kind, (Flag, Unused)) and kind.makes_position is not None:
        yield kind.makes_position
    if not isinstance(kind, Flag):
        return
    if kind.verdict_if_set is not None:
        yield kind.verdict_if_set
    is_only_for_some_codes = kind.only_while != ""
    if is_only_for_some_codes:
        kind_for_other_codes = field.unexplained.kind
        if isinstance(kind_for_other_codes, Flag) and kind_for_other_codes.makes_position is not None:
            yield kind_for_other_codes.makes_position


def _at_best_unknown(verdict: Verdict) -> Verdict:
    """Return the verdict of an active flag in a frame that does not say whether the position is usable.

    NOT_USABLE remains. Any other verdict becomes UNKNOWN.
    """
    return verdict if verdict is Verdict.NOT_USABLE else Verdict.UNKNOWN


def check_frame_kinds(device: Device, report: DocumentReport) -> None:
    """Report frames of different layouts that decoders cannot distinguish.

    A number must not be at the place of a constant in a different frame or in the request, because it can have the
    value of the constant. Over RS-485, the request determines the layout of the reply.
    """
    if not valid_parts_so_far(report).has_valid_layouts:
        return
    for interface in device.interfaces:
        _check_replies(interface, device.position_names(interface.name), report)
        if not isinstance(interface, Rs485):
            _check_positions(device, interface, report)
            _check_numbers(device, interface, report)
    check_channels(device, report)
    _check_verdicts_without_position(device, report)


def _check_verdicts_without_position(device: Device, report: DocumentReport) -> None:
    """Report the first flag with a verdict on the position if no SSI word contains the position.

    Decoders give no verdict on words without a position, so the flag has no effect.
    """
    ssi = device.find_interface(Ssi)
    if ssi is None or any(device.sends_position(ssi.name, layout) for layout in ssi.layouts):
        return
    for layout in ssi.layouts:
        flags = [field for field in layout.fields if isinstance(field.kind, Flag) and field.kind.makes_position]
        if flags:
            message = (
                f"'{flags[0].name}' has a verdict on the position, but no SSI word contains the position, so"
                " decoders give no verdict; name the field that contains it 'position', or give its name in"
                " 'measurement'"
            )
            path: Path = ("interfaces", ssi.name, "layouts", layout.name, "fields", flags[0].name)
            report.add("verdict-without-position", (*path, "makes_position"), message)
            return


def _check_numbers(device: Device, interface: Interface, report: DocumentReport) -> None:
    """Report numbers in frames with the position that are constants in a different frame of the encoder.

    Decoders cannot distinguish the two frames. Only the first number of each layout is reported.
    """
    frames = [layout for layout in interface.layouts if layout.sender == "encoder"]
    for layout in frames:
        if not device.sends_position(interface.name, layout):
            continue
        number_names = {field.name for field in layout.fields if isinstance(field.kind, Number)}
        frames_in_channel = [frame for frame in frames if frame.channel == layout.channel]
        frames_with_constant = [frame for frame in frames_in_channel if _has_constant(frame, number_names)]
        first_clash = next(_find_ambiguous_numbers(device, interface, layout, frames_with_constant), None)
        if first_clash is not None:
            name, other_name = first_clash.number.name, first_clash.other_layout.name
            message = f"'{name}' can be any number, but it is always {first_clash.constant:#x} in '{other_name}'"
            remedy = f"a frame '{other_name}' would decode as '{layout.name}'; give this field its 'constant'"
            report.add("frame-kind", _field_path(interface, layout, first_clash.number), f"{message}, so {remedy}")


def _field_path(interface: Interface, layout: Layout, field: Field) -> Path:
    """Return the path in the spec of a field, which is in the layout or in a field group that the layout uses."""
    if field.group:
        return ("field_groups", field.group, "fields", field.name)
    return ("interfaces", interface.name, "layouts", layout.name, "fields", field.name)


def _check_positions(device: Device, interface: Interface, report: DocumentReport) -> None:
    """Report the first two SSI or BiSS frames with the position that decoders cannot distinguish.

    No request selects a frame over SSI and BiSS, so decoders would decode every frame with the first layout. Frames are
    not reported if the second layout has a note, which should say how a master selects the frame.
    """
    if not isinstance(interface, (Biss, Ssi)):
        return
    frames = [layout for layout in interface.layouts if device.sends_position(interface.name, layout)]
    for first, second in combinations(frames, 2):
        if second.note or first.channel != second.channel or _are_distinguished(first, second):
            continue
        message = (
            f"'{first.name}' and '{second.name}' both contain the position, and nothing distinguishes their frames"
        )
        remedy = (
            "if order codes differ in their frames, describe them in one layout with widths that depend on the order"
            " code, or in two specs. If a master selects the frame, say how in a 'note' of the second layout"
        )
        layout_path: Path = ("interfaces", interface.name, "layouts", second.name)
        report.add("frame-kind", layout_path, f"{message}, so decoders use '{first.name}'; {remedy}")
        return


def _are_distinguished(layout: Layout, other_layout: Layout) -> bool:
    """Return whether decoders can distinguish the frames of two layouts.

    Either the first layout has a selector, a field whose values select this layout, or the layouts have constants with
    the same name and different values.
    """
    if layout.selector:
        return True
    constants, other_constants = _constants_by_name(layout), _constants_by_name(other_layout)
    common_names = constants.keys() & other_constants.keys()
    return any(constants[name] != other_constants[name] for name in common_names)


def _constants_by_name(layout: Layout) -> dict[str, int]:
    """Return the value of each constant of a layout, by its name."""
    return {field.name: field.kind.value for field in layout.fields if isinstance(field.kind, Constant)}


def _check_replies(interface: Interface, position_names: frozenset[str], report: DocumentReport) -> None:
    """Report numbers in replies that should be constants, because they are constants in all requests for the reply.

    A number would accept the reply to a different request. Fields in ``position_names`` are not checked, because a
    request for the position may give its command the same name.
    """
    if not isinstance(interface, (Rs485, Spi)):
        return
    layout_by_name = {layout.name: layout for layout in interface.layouts}
    for reply in interface.layouts:
        request_names = [exchange.request for exchange in interface.exchanges if exchange.reply == reply.name]
        requests = [layout_by_name[name] for name in request_names if name in layout_by_name]
        for field in reply.fields:
            constant = _common_constant(requests, field.name)
            if isinstance(field.kind, Number) and constant is not None and field.name not in position_names:
                message = f"'{field.name}' can be any number, but it is always {constant:#x} in '{requests[0].name}'"
                place_of_fix = " in each layout, instead of in the group" if field.group else ""
                remedy = (
                    "the reply to a different request would decode; give this field the same 'constant'"
                    f"{place_of_fix}, or a different name if the reply does not repeat it"
                )
                report.add("frame-kind", _field_path(interface, reply, field), f"{message}, so {remedy}")


def _common_constant(requests: Sequence[Layout], field_name: str) -> int | None:
    """Return the constant value that a field has in all requests that contain it.

    Return None if it is not a constant in one of them, if the constants differ, or if no request contains it.
    """
    constants: set[int] = set()
    for request in requests:
        for field in request.fields:
            if field.name != field_name:
                continue
            if not isinstance(field.kind, Constant):
                return None
            constants.add(field.kind.value)
    return constants.pop() if len(constants) == 1 else None


def _has_constant(layout: Layout, names: set[str]) -> bool:
    """Return whether a layout has a constant with one of these names."""
    return any(isinstance(field.kind, Constant) and field.name in names for field in layout.fields)


class _Clash(NamedTuple):
    """A number that has the name, place and width of a constant in another layout, and the value of the constant."""

    number: Field
    other_layout: Layout
    constant: int


def _find_ambiguous_numbers(
    device: Device, interface: Interface, layout: Layout, other_layouts: list[Layout]
) -> Iterator[_Clash]:
    """Yield each number of a layout that is a constant in a different frame of the same length."""
    for variant in device.variants_over(interface.name):
        placed_layout = layout.place(variant.parameters)
        for other_layout in other_layouts:
            other_placed_layout = other_layout.place(variant.parameters)
            if placed_layout.bits != other_placed_layout.bits:
                continue
            for placed_field in placed_layout.fields:
                other_field = other_placed_layout.find_field(placed_field.name)
                if other_field is None:
                    continue
                has_same_place = (other_field.lowest_bit, other_field.width) == (
                    placed_field.lowest_bit,
                    placed_field.width,
                )
                if not has_same_place:
                    continue
                number_field, other_kind = placed_field.field, other_field.field.kind
                if isinstance(number_field.kind, Number) and isinstance(other_kind, Constant):
                    yield _Clash(number_field, other_layout, other_kind.value)


def check_selector_places(device: Device, report: DocumentReport) -> None:
    """Check that the same bits distinguish all frames of a sender, at the same place for every order code.

    The key ``when`` of a layout names the field that distinguishes it, the selector.
    """
    for interface in device.interfaces:
        first_layout_and_bits_by_sender: dict[str, tuple[str, object]] = {}
        for layout in interface.layouts:
            if not layout.selector:
                continue
            key_path: Path = ("interfaces", interface.name, "layouts", layout.name, "when")
            selector = next((field for field in layout.fields if field.name == layout.selector), None)
            if selector is None:
                continue  # Reported by the rule on references.
            has_fixed_place = bool(selector.bit_slices)
            if not has_fixed_place:
                report.add(
                    "selector-place",
                    key_path,
                    f"the position of '{layout.selector}' depends on the order code; bits that identify a frame must"
                    " have a fixed position",
                )
                continue
            first_name, first_bits = first_layout_and_bits_by_sender.setdefault(
                layout.sender, (layout.name, selector.bit_slices)
            )
            if first_bits != selector.bit_slices:
                message = (
                    f"'{layout.selector}' is not at the same position as in '{first_name}'; the same bits must"
                    " distinguish all frames of a sender"
                )
                report.add("selector-place", key_path, message)
