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
from ..say import count_with_unit, first_of, formula
from ..say.text import hertz, time_text, volts

Parameters = Mapping[str, int]


@dataclass(frozen=True, slots=True)
class ComparisonPoint:
    """An order code that both versions have, and its parameters under one setting of registers and answers.

    ``compared_parameters`` are the parameters for evaluating expressions of the old version. They have the new values
    of parameters that both versions have, so that a changed parameter is reported only once. A renamed parameter has
    its old value, which is equal to the new one.
    """

    code: str
    old_parameters: Parameters
    new_parameters: Parameters
    compared_parameters: Parameters


@dataclass(frozen=True, slots=True)
class NumberDifferences:
    """Differences between two expressions: the affected order codes, and each pair of old and new value once.

    ``is_everywhere`` is true if the values differ under every setting of registers and answers.
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
    """Return the parameters of an order code with the values of a setting of registers and answers.

    Parameters that the order code does not have, and parameters that a formula calculates, are ignored in the setting.
    """
    settable_names = variant.parameters.keys() - device.definitions
    applicable_setting = {name: value for name, value in setting.items() if name in settable_names}
    if not applicable_setting:
        return variant.parameters
    return with_changed(device, variant, applicable_setting)


def compare_at_points(
    old: Expression | None, new: Expression | None, points: Sequence[ComparisonPoint]
) -> NumberDifferences | None:
    """Return the differences between two expressions, or None if their values are equal at every point.

    A point is an order code that both versions have, with its parameters under one setting. If the versions share no
    order code, there are no points, and the expressions are equal if their texts are the same.
    """
    # A parameter in both expressions was not renamed, and has the same value in both.
    if old == new:
        return None
    if not points:
        has_same_text = old is not None and new is not None and old.render() == new.render()
        if has_same_text:
            return None
        return NumberDifferences(codes=(), value_pairs=_constant_pairs(old, new))
    code_of_each_difference: list[str] = []
    value_pairs: list[tuple[int | None, int | None]] = []
    for point in points:
        old_value = _value_or_none(old, point.compared_parameters)
        new_value = _value_or_none(new, point.new_parameters)
        if old_value != new_value:
            code_of_each_difference.append(point.code)
            value_pairs.append((old_value, new_value))
    if not code_of_each_difference:
        return None
    # An order code has a point for each setting. The list contains it once for each of these points that differs.
    points_of_codes = [point for point in points if point.code in code_of_each_difference]
    differ_at_all_points = len(points_of_codes) == len(code_of_each_difference)
    return NumberDifferences(
        codes=tuple(dict.fromkeys(code_of_each_difference)),
        value_pairs=tuple(dict.fromkeys(value_pairs)),
        is_everywhere=differ_at_all_points,
    )


def _constant_pairs(old: Expression | None, new: Expression | None) -> tuple[tuple[int | None, int | None], ...]:
    """Return the pair of old and new value, ``((17, 19),)``, if neither expression contains a parameter.

    Return ``()`` if an expression contains a parameter, because its value is not known.
    """
    has_parameters = any(expression is not None and not expression.is_constant for expression in (old, new))
    if has_parameters:
        return ()
    old_value, new_value = _value_or_none(old, {}), _value_or_none(new, {})
    return ((old_value, new_value),)


def _value_or_none(expression: Expression | None, parameters: Parameters) -> int | None:
    """Return the value of an expression with these parameters.

    Return None if there is no expression, or if it contains a parameter that is not among them.
    """
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
    """Describe some order codes of a device in the first of these forms that applies.

    The forms are: ``all 12 order codes``, ``all 6 BiSS order codes``, a pattern such as ``X-24-…``, or the first few
    codes and the number of the others. The only order code of a device is described by its text. Without codes, the
    description is "".
    """
    variants = device.variants
    if not codes:
        return ""
    if len(variants) == 1:
        return variants[0].code
    if len(codes) == len(variants):
        return f"all {len(variants)} order codes"
    for interface in device.interfaces:
        interface_codes = [variant.code for variant in variants if variant.interface == interface.name]
        if len(interface_codes) > 1 and set(interface_codes) == set(codes):
            return f"all {len(interface_codes)} {interface.short} order codes"
    codes_in_order = [variant.code for variant in variants if variant.code in codes]
    return codes_as_pattern(device, codes) or first_of(codes_in_order)


def codes_as_pattern(device: Device, codes: Collection[str]) -> str:
    """Return a pattern that matches exactly these order codes of a device, such as ``X-…20-B1``, or "".

    The mark ``…`` stands for all texts of a part of the order code. The result is "" if there is only one order code,
    or if each pattern for the codes also matches others.
    """
    affected_variants = [variant for variant in device.variants if variant.code in codes]
    used_texts = _texts_by_part(device, affected_variants)
    # The pattern matches every combination of the used texts, including combinations that are not affected.
    matching_variants = [variant for variant in device.variants if _has_allowed_texts(variant, used_texts)]
    if len(affected_variants) < 2 or matching_variants != affected_variants:
        return ""
    all_part_texts = _texts_by_part(device, device.variants)
    # Fixed texts and names of parts alternate, so the parts have odd indices: ``X-{bits}-{output}`` is split into
    # "X-", "bits", "-", "output" and "".
    pieces = _PART_IN_BRACES.split(device.order_code.pattern)
    last_restricted_index = 0
    for index in range(1, len(pieces), 2):
        part_name = pieces[index]
        pieces[index] = _part_pattern(used_texts[part_name], all_part_texts[part_name])
        if pieces[index] != _ANY_TEXT:
            last_restricted_index = index
    last_part_index = len(pieces) - 2
    if last_restricted_index == last_part_index:
        return "".join(pieces)
    # One mark represents all parts at the end that can have any text.
    return "".join(pieces[: last_restricted_index + 1]) + _ANY_TEXT


def _texts_by_part(device: Device, variants: Sequence[Variant]) -> dict[str, tuple[str, ...]]:
    """Return the distinct texts that each part of the order code has in these variants, by the part's name."""
    texts_by_part: dict[str, tuple[str, ...]] = {}
    for part in device.order_code.parts:
        texts_by_part[part.name] = tuple(dict.fromkeys(variant.parts[part.name] for variant in variants))
    return texts_by_part


def _has_allowed_texts(variant: Variant, allowed_texts: Mapping[str, tuple[str, ...]]) -> bool:
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


#: Highest number of characters of a shown value, and members that are left out of it.
_LONGEST_SHOWN_VALUE = 60
_TEXT_MEMBERS = ("meaning", "note", "printed")
#: Values of members without content.
_EMPTY_VALUES: tuple[object, ...] = (None, "", (), [], {})
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
    """Return a value or part of the model as data for JSON, without citations.

    A constant expression becomes a number, any other expression a text, and bytes become hexadecimal text: ``"0A FF"``.
    A part becomes a map of its members. Numbers and texts are returned as they are.
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
    """Return a value of the model as text of at most 60 characters, in a notation of manuals such as "hex" (``0Ah``).

    A missing or empty value becomes "none". A part of the model becomes ``min = 1, max = 5``, without descriptive texts
    and empty members, or just the value of its only member.
    """
    if model_value in _EMPTY_VALUES:
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
        model_value = {name: member for name, member in members if member not in _EMPTY_VALUES}
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
    """Return a number or a bool in a notation of manuals, such as ``0Ah`` for "hex".

    A bool is ``yes`` or ``no``. In the notation "level", it is the active level of a signal, and true means ``low``.
    """
    if isinstance(value, bool) and notation == "level":
        return "low" if value else "high"
    if isinstance(value, bool):
        return "yes" if value else "no"
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
    """Return a part of the model as plain data without its descriptive texts, or a list of such data for a tuple.

    The texts are its meaning, note and printed text. Texts of inner parts are kept. Any other value is returned as it
    is.
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
    """Return two values of a member, reduced to their differences if both are tuples of parts.

    Each tuple then only contains the parts that the other one lacks. Parts are compared without their descriptive
    texts. If only the order or the texts differ, or the values are not tuples of parts, they are returned unchanged.
    """
    are_parts = isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_dataclass, (*old, *new)))
    if not are_parts:
        return old, new
    old_only, new_only = _items_not_in(old, new), _items_not_in(new, old)
    only_order_or_texts_differ = not old_only and not new_only
    return (old, new) if only_order_or_texts_differ else (old_only, new_only)


def _items_not_in(items: tuple[Any, ...], other_items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the items that have no equal item in ``other_items``, regardless of their descriptive texts."""
    other_data = [without_texts(other_item) for other_item in other_items]
    return tuple(item for item in items if without_texts(item) not in other_data)


def old_to_new(old: Any, new: Any, notation: str = "") -> str:
    """Return two values of the model as short texts in a notation of manuals: ``5 → 12``.

    Of two parts of the model, only the members that differ are shown, and of two long texts, the words that differ.
    """
    old, new = _differing_members(old, new)
    old_text, new_text = short_value(old, notation), short_value(new, notation)
    if old_text == new_text and isinstance(old, str) and isinstance(new, str):
        old_text, new_text = _from_first_difference(old, new)
    return f"{old_text} → {new_text}"


def _differing_members(old: Any, new: Any) -> tuple[Any, Any]:
    """Return two parts of the model of the same class as maps of the members that differ, and other values unchanged.

    They are also unchanged if a member that differs is missing in one of them.
    """
    if type(old) is not type(new) or not is_dataclass(old) or isinstance(old, (Expression, Supply, Scale, CodedValue)):
        return old, new
    old_members, new_members = without_texts(old), without_texts(new)
    differing_names = [name for name in old_members if old_members[name] != new_members[name]]
    old_differences = {name: old_members[name] for name in differing_names}
    new_differences = {name: new_members[name] for name in differing_names}
    differing_values = [*old_differences.values(), *new_differences.values()]
    is_value_missing = any(value in _EMPTY_VALUES for value in differing_values)
    filled_members = [member for member in new_members.values() if member not in _EMPTY_VALUES]
    # A part with a single member is shown as this member, without its name.
    has_one_member = len(filled_members) == 1
    if not differing_names or is_value_missing or has_one_member:
        return old, new
    return old_differences, new_differences


#: Number of words that are shown before the first difference of two long texts.
_WORDS_BEFORE_DIFFERENCE = 3


def _from_first_difference(old: str, new: str) -> tuple[str, str]:
    """Return two texts from a few words before their first difference: ``…50 mm to 2 mm`` and ``…50 mm to 5 mm``."""
    old_words, new_words = old.split(), new.split()
    common_count = 0
    for old_word, new_word in zip(old_words, new_words, strict=False):
        if old_word != new_word:
            break
        common_count += 1
    start = max(0, common_count - _WORDS_BEFORE_DIFFERENCE)
    old_text, new_text = " ".join(old_words[start:]), " ".join(new_words[start:])
    return _shorten_text(f"…{old_text}"), _shorten_text(f"…{new_text}")
