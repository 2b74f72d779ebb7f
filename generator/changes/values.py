"""Values of the model and the affected order codes as text for a sentence, and expressions compared by value."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from typing import Any

from ..model import CodedValue, Device, Scale, Supply, Variant
from ..model.expressions import Expression, ExpressionError
from ..order_codes.parameters import with_changed
from ..say.plain_text import count_with_unit, first_of, formula
from ..say.text import hertz, time_text, volts

Parameters = Mapping[str, int]


@dataclass(frozen=True, slots=True)
class ComparisonPoint:
    """A common order code, and its parameters under one setting of registers and answers.

    ``compared_parameters`` are the parameters for expressions of the old family. They take the new values where the old
    family has the parameter too, so that a changed parameter is reported only once. A renamed parameter has its old
    value, which is the same by definition.
    """

    code: str
    old_parameters: Parameters
    new_parameters: Parameters
    compared_parameters: Parameters


@dataclass(frozen=True, slots=True)
class NumberDifferences:
    """Differences of two expressions: the order codes, and each pair of numbers that occurs, once.

    ``is_everywhere`` is true if they differ under every setting of registers and answers.
    """

    codes: tuple[str, ...]
    value_pairs: tuple[tuple[int | None, int | None], ...]
    is_everywhere: bool = True


def settings_of(device: Device) -> Iterator[Parameters]:
    """Yield settings of registers and answers, each with the parameters that it changes: ``{"resolution": 24}``.

    The first setting is empty and stands for the defaults. In each other setting, one parameter is at an end of its
    range, or one question has one of its answers.
    """
    yield {}
    for parameter in device.run_time_parameters:
        yield {parameter.name: parameter.min or 0}
        yield {parameter.name: parameter.max if parameter.max is not None else parameter.largest}
    for alternative in device.alternatives:
        for answer in alternative.answers:
            yield answer.sets


def with_setting(device: Device, variant: Variant, setting: Parameters) -> Parameters:
    """Return the parameters of an order code under a setting.

    Names that the order code does not have are ignored, and so are names that a formula defines.
    """
    own_names = variant.parameters.keys() - device.definitions
    own_setting = {name: value for name, value in setting.items() if name in own_names}
    return with_changed(device, variant, own_setting) if own_setting else variant.parameters


def compare_at_points(
    old: Expression | None, new: Expression | None, points: Sequence[ComparisonPoint]
) -> NumberDifferences | None:
    """Return the differences of two expressions, or None if they are equal at every point.

    Without points, since no order code is common, they are equal if their texts are the same.
    """
    # A name used on both sides was not renamed, and has the same number on both.
    if old == new:
        return None
    if not points:
        has_same_text = old is not None and new is not None and old.render() == new.render()
        return None if has_same_text else NumberDifferences(codes=(), value_pairs=_constant_pairs(old, new))
    differing_codes: list[str] = []
    value_pairs: list[tuple[int | None, int | None]] = []
    for point in points:
        old_value = _value_or_none(old, point.compared_parameters)
        new_value = _value_or_none(new, point.new_parameters)
        if old_value != new_value:
            differing_codes.append(point.code)
            value_pairs.append((old_value, new_value))
    if not differing_codes:
        return None
    # A differing code occurs once for each point at which it differs.
    points_of_codes = [point for point in points if point.code in differing_codes]
    differ_at_all_points = len(points_of_codes) == len(differing_codes)
    return NumberDifferences(
        codes=tuple(dict.fromkeys(differing_codes)),
        value_pairs=tuple(dict.fromkeys(value_pairs)),
        is_everywhere=differ_at_all_points,
    )


def _constant_pairs(old: Expression | None, new: Expression | None) -> tuple[tuple[int | None, int | None], ...]:
    """Return one pair of numbers, ``((17, 19),)``, if both expressions are numbers or None.

    Return ``()`` if one of them contains variables, whose values are not known.
    """
    has_variables = any(expression is not None and not expression.is_constant for expression in (old, new))
    if has_variables:
        return ()
    pair = _value_or_none(old, {}), _value_or_none(new, {})
    return (pair,)


def _value_or_none(expression: Expression | None, parameters: Parameters) -> int | None:
    """Return the value of an expression, or None if there is no expression or a parameter is missing."""
    if expression is None:
        return None
    try:
        return expression.value(parameters)
    except ExpressionError:
        return None


#: A part in the pattern of order codes, such as ``{resolution}``.
_PART_IN_BRACES = re.compile(r"\{(\w+)\}")
#: Stands for all texts of a part in the pattern of affected order codes.
_ANY_TEXT = "…"


def describe_codes(device: Device, codes: Collection[str]) -> str:
    """Describe order codes of a family, by the first of these that applies.

    ``all 12 order codes``, ``all 6 BiSS order codes``, a pattern such as ``X-24-…``, or the first few and the number of
    the others. A family with a single order code returns that code, and no codes return "".
    """
    variants = device.variants
    if not codes:
        return ""
    if len(codes) == len(variants):
        return f"all {count_with_unit(len(variants), 'order code')}" if len(variants) > 1 else variants[0].code
    for interface in device.interfaces:
        interface_codes = [variant.code for variant in variants if variant.interface == interface.name]
        if len(interface_codes) > 1 and set(interface_codes) == set(codes):
            return f"all {len(interface_codes)} {interface.short} order codes"
    codes_in_order = [variant.code for variant in variants if variant.code in codes]
    return codes_as_pattern(device, codes) or first_of(codes_in_order)


def codes_as_pattern(device: Device, codes: Collection[str]) -> str:
    """Return the order codes as a pattern with some parts left open, such as ``X-…20-B1``, or "".

    The pattern must match exactly these order codes, of which there are at least two.
    """
    affected_variants = [variant for variant in device.variants if variant.code in codes]
    used_texts = _texts_by_part(device, affected_variants)
    # Any combination of the used texts matches the pattern, also one that is not affected.
    matching_variants = [variant for variant in device.variants if _has_only(variant, used_texts)]
    if len(affected_variants) < 2 or matching_variants != affected_variants:
        return ""
    all_part_texts = _texts_by_part(device, device.variants)
    # Literal texts and the names of parts in turn, beginning and ending with a literal text. Parts have odd indices.
    bit_slices = _PART_IN_BRACES.split(device.order_code.pattern)
    bit_slices[1::2] = [_part_pattern(used_texts[name], all_part_texts[name]) for name in bit_slices[1::2]]
    closed_indices = [index for index in range(1, len(bit_slices), 2) if bit_slices[index] != _ANY_TEXT]
    last_closed_index = closed_indices[-1] if closed_indices else 0
    has_open_parts_behind = last_closed_index + 2 < len(bit_slices)
    if not has_open_parts_behind:
        return "".join(bit_slices)
    # If everything up to the end is open, one mark represents the rest.
    return "".join(bit_slices[: last_closed_index + 1]) + _ANY_TEXT


def _texts_by_part(device: Device, variants: Sequence[Variant]) -> dict[str, tuple[str, ...]]:
    """Return the distinct texts that each part of the order code has in these variants, by the part's name."""
    texts_by_part: dict[str, tuple[str, ...]] = {}
    for part in device.order_code.parts:
        texts_by_part[part.name] = tuple(dict.fromkeys(variant.parts[part.name] for variant in variants))
    return texts_by_part


def _has_only(variant: Variant, allowed_texts: Mapping[str, tuple[str, ...]]) -> bool:
    """Return whether each part of an order code has one of its allowed texts."""
    return all(variant.parts[part_name] in texts for part_name, texts in allowed_texts.items())


def _part_pattern(used_texts: tuple[str, ...], all_texts: tuple[str, ...]) -> str:
    """Return the used texts of a part in a pattern: ``17``, ``{17,19}``, or ``…`` for all texts of the part."""
    if len(used_texts) == 1:
        return used_texts[0]
    if len(used_texts) == len(all_texts):
        return _ANY_TEXT
    alternatives = ",".join(used_texts)
    return f"{{{alternatives}}}"


#: Most letters of a shown value, and members that are left out of it.
_LONGEST_SHOWN_VALUE = 60
_TEXT_MEMBERS = ("meaning", "note", "printed")
_FORMAT_BY_UNIT: Mapping[str, Callable[[int], str]] = {
    # In whole bytes, which have two digits each: 0Ah, 01FFh.
    "hex": lambda value: f"{value:0{2 * max(1, (value.bit_length() + 7) // 8)}X}h",
    "bytes": lambda value: count_with_unit(value, "byte"),
    "mv": volts,
    "us": time_text,
    "ms": lambda value: time_text(1000 * value),
    "hz": hertz,
}


def as_plain_data(model_value: Any) -> Any:
    """Return any part of the model as JSON data, without sources.

    Numbers and texts stay. Constant expressions become numbers, others texts, and bytes hexadecimal: ``"0A FF"``.
    """
    if isinstance(model_value, Expression):
        return model_value.constant if model_value.is_constant else model_value.render()
    if isinstance(model_value, Enum):
        return model_value.value
    if isinstance(model_value, bytes):
        return model_value.hex(" ").upper()
    if isinstance(model_value, Mapping):
        return {str(key): as_plain_data(member) for key, member in model_value.items()}
    if isinstance(model_value, (tuple, list)):
        return [as_plain_data(member) for member in model_value]
    if is_dataclass(model_value) and not isinstance(model_value, type):
        member_names = [member.name for member in fields(model_value) if member.name != "source"]
        return {name: as_plain_data(getattr(model_value, name)) for name in member_names}
    return model_value


def short_value(model_value: Any, notation: str = "") -> str:
    """Return a value as text of at most 60 letters, in the given notation of manuals: ``0Ah`` for "hex".

    Missing and empty values are "none". A part of the model is ``min = 1, max = 5``, without texts and empty members.
    If one member is left, only its value is shown.
    """
    if model_value is None or model_value in ("", (), [], {}):
        return "none"
    if isinstance(model_value, (bool, int)):
        return _number_text(model_value, notation)
    if isinstance(model_value, Enum):
        return str(model_value.value).replace("_", " ")
    if isinstance(model_value, (tuple, list)):
        return _shorten_text(", ".join(short_value(member, notation) for member in model_value))
    if isinstance(model_value, (Expression, Supply, Scale, CodedValue)):
        return _quantity_text(model_value)
    if is_dataclass(model_value):
        members = without_texts(model_value).items()
        model_value = {name: member for name, member in members if member not in (None, "", [], {})}
        if len(model_value) == 1:
            (only_member,) = model_value.values()
            return short_value(only_member, notation)
    if isinstance(model_value, Mapping):
        return _shorten_text(", ".join(f"{key} = {short_value(member)}" for key, member in model_value.items()))
    value_text = str(model_value)
    if notation == "word":
        value_text = value_text.replace("_", " ")
    return _shorten_text(value_text)


def _number_text(value: int, notation: str) -> str:
    """Return a number or a bool in the given notation of manuals, such as ``0Ah`` for "hex" or ``low`` for "level"."""
    if isinstance(value, bool):
        text_if_true, text_if_false = ("low", "high") if notation == "level" else ("yes", "no")
        return text_if_true if value else text_if_false
    if notation in _FORMAT_BY_UNIT:
        return _FORMAT_BY_UNIT[notation](value)
    return f"{value}"


def _quantity_text(value: Expression | Supply | Scale | CodedValue) -> str:
    """Return a formula, a quantity with its unit, ``5 V to 30 V``, or a code with its value, ``3 = 24``."""
    match value:
        case Expression():
            return value.render()
        case Supply():
            return f"{volts(value.min_mv)} to {volts(value.max_mv)}"
        case Scale():
            return f"{formula(value)} {value.unit}"
        case CodedValue():
            return f"{value.code} = {value.value}"


def _shorten_text(text: str) -> str:
    """Return a text of at most ``_LONGEST_SHOWN_VALUE`` characters, cut with an ellipsis."""
    if len(text) <= _LONGEST_SHOWN_VALUE:
        return text
    return f"{text[: _LONGEST_SHOWN_VALUE - 1]}…"


def without_texts(value: Any) -> Any:
    """Return a part of the model as data without its meaning, note and printed text, or a list of such data.

    Texts of parts inside it stay. Any other value is returned as it is.
    """
    if isinstance(value, tuple):
        return [without_texts(member) for member in value]
    if is_dataclass(value) and not isinstance(value, type):
        data_by_member = as_plain_data(value)
        return {
            member_name: member for member_name, member in data_by_member.items() if member_name not in _TEXT_MEMBERS
        }
    return value


def differing_items(old: Any, new: Any) -> tuple[Any, Any]:
    """Return both values, reduced to the items that the other value lacks if both are tuples of parts.

    Items are compared without their texts. If only their order or their texts differ, both values stay whole.
    """
    are_parts = isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_dataclass, (*old, *new)))
    if not are_parts:
        return old, new
    old_only, new_only = _items_not_in(old, new), _items_not_in(new, old)
    # Only the order of the items or their texts differ.
    if not old_only and not new_only:
        return old, new
    return old_only, new_only


def _items_not_in(items: tuple[Any, ...], other_items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the items without an equal item in ``other_items``, ignoring their texts."""
    other_data = [without_texts(other_item) for other_item in other_items]
    return tuple(item for item in items if without_texts(item) not in other_data)


def old_to_new(old: Any, new: Any, notation: str = "") -> str:
    """Return ``5 → 12``, with both values as from ``short_value``."""
    return f"{short_value(old, notation)} → {short_value(new, notation)}"
