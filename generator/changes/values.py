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
from ..say.plain_text import counted, first_of, formula
from ..say.text import hertz, microseconds, volts

Parameters = Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Point:
    """A common order code, and its parameters under one setting of registers and answers.

    ``compared`` are the parameters for expressions of the old family. They have the new values where the old family
    has the parameter too, so that a changed parameter is reported only once. A renamed one has its old value, which is
    the same by definition.
    """

    code: str
    old: Parameters
    new: Parameters
    compared: Parameters


@dataclass(frozen=True, slots=True)
class NumberDifferences:
    """Differences of two expressions: the order codes, and each pair of numbers that occurs, once.

    ``everywhere`` is true if they differ under every setting of registers and answers.
    """

    codes: tuple[str, ...]
    values: tuple[tuple[int | None, int | None], ...]
    everywhere: bool = True


def settings_of(device: Device) -> Iterator[Parameters]:
    """Yield settings of registers and answers: the defaults, then each at the ends of its range, one by one."""
    yield {}
    for parameter in device.run_time_parameters:
        yield {parameter.name: parameter.min or 0}
        yield {parameter.name: parameter.max if parameter.max is not None else parameter.largest}
    for alternative in device.alternatives:
        for answer in alternative.answers:
            yield answer.sets


def with_setting(device: Device, variant: Variant, setting: Parameters) -> Parameters:
    """Return the parameters of an order code under a setting, without parameters that it does not have."""
    own_names = variant.parameters.keys() - device.definitions
    own_setting = {name: value for name, value in setting.items() if name in own_names}
    return with_changed(device, variant, own_setting) if own_setting else variant.parameters


def differing(old: Expression | None, new: Expression | None, points: Sequence[Point]) -> NumberDifferences | None:
    """Return the differences of two expressions, or None if they are equal everywhere.

    Without a common order code, their texts are compared.
    """
    # A name that both sides use was not renamed, and has the same number on both.
    if old == new:
        return None
    if not points:
        has_same_text = old is not None and new is not None and old.render() == new.render()
        return None if has_same_text else NumberDifferences((), _constants(old, new))
    codes: list[str] = []
    number_pairs: list[tuple[int | None, int | None]] = []
    for point in points:
        old_number, new_number = _number(old, point.compared), _number(new, point.new)
        if old_number != new_number:
            codes.append(point.code)
            number_pairs.append((old_number, new_number))
    if not codes:
        return None
    points_of_codes = [point for point in points if point.code in codes]
    return NumberDifferences(
        codes=tuple(dict.fromkeys(codes)),
        values=tuple(dict.fromkeys(number_pairs)),
        everywhere=len(points_of_codes) == len(codes),
    )


def _constants(old: Expression | None, new: Expression | None) -> tuple[tuple[int | None, int | None], ...]:
    """Return the pair of numbers if the expressions are numbers or None."""
    if all(expression is None or expression.is_constant for expression in (old, new)):
        return ((_number(old, {}), _number(new, {})),)
    return ()


def _number(expression: Expression | None, parameters: Parameters) -> int | None:
    if expression is None:
        return None
    try:
        return expression.value(parameters)
    except ExpressionError:
        return None


_BRACES = re.compile(r"\{(\w+)\}")
_ALL = "…"


def describe_codes(device: Device, codes: Collection[str]) -> str:
    """Describe order codes of a family: ``all 12 BiSS order codes``, ``TV62-M…``, or some of them by name."""
    variants = device.variants
    if not codes:
        return ""
    if len(codes) == len(variants):
        return f"all {counted(len(variants), 'order code')}" if len(variants) > 1 else variants[0].code
    for interface in device.interfaces:
        interface_codes = [variant.code for variant in variants if variant.interface == interface.name]
        if len(interface_codes) > 1 and set(interface_codes) == set(codes):
            return f"all {len(interface_codes)} {interface.short} order codes"
    return pattern(device, codes) or first_of([variant.code for variant in variants if variant.code in codes])


def pattern(device: Device, codes: Collection[str]) -> str:
    """Return the order codes as a pattern with some parts left open, such as ``TV62-…20-B1``, or "" if that fails."""
    affected = [variant for variant in device.variants if variant.code in codes]
    used_texts = {part.name: _used_values(affected, part.name) for part in device.order_code.parts}
    fitting = [variant for variant in device.variants if _fits(variant, used_texts)]
    if len(affected) < 2 or fitting != affected:
        return ""
    all_texts = {part.name: _used_values(device.variants, part.name) for part in device.order_code.parts}
    texts = _BRACES.split(device.order_code.pattern)  # Text and names of parts in turn.
    texts[1::2] = [_part_pattern(used_texts[name], all_texts[name]) for name in texts[1::2]]
    # If everything up to the end is open, one mark stands for the rest.
    closed_parts = [index for index in range(1, len(texts), 2) if texts[index] != _ALL]
    last_closed = closed_parts[-1] if closed_parts else 0
    text_at_end = texts[last_closed + 1]
    is_open_to_end = last_closed + 2 < len(texts)
    return "".join([*texts[: last_closed + 1], _ALL if is_open_to_end else text_at_end])


def _fits(variant: Variant, texts: Mapping[str, tuple[str, ...]]) -> bool:
    """Return True if each part of an order code has one of these texts."""
    return all(variant.parts[name] in allowed_texts for name, allowed_texts in texts.items())


def _used_values(variants: Sequence[Variant], part: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(variant.parts[part] for variant in variants))


def _part_pattern(used_texts: tuple[str, ...], all_texts: tuple[str, ...]) -> str:
    if len(used_texts) == 1:
        return used_texts[0]
    if len(used_texts) == len(all_texts):
        return _ALL
    return f"{{{','.join(used_texts)}}}"


_LONGEST = 60
_SAID = ("meaning", "note", "printed")
_FORMS: Mapping[str, Callable[[int], str]] = {
    # In whole bytes.
    "hex": lambda value: f"{value:0{2 * max(1, (value.bit_length() + 7) // 8)}X}h",
    "bytes": lambda value: counted(value, "byte"),
    "mv": volts,
    "us": microseconds,
    "ms": lambda value: microseconds(1000 * value),
    "hz": hertz,
}


def plain(value: Any) -> Any:
    """Return any part of the model as JSON data, without sources."""
    if isinstance(value, Expression):
        return value.constant if value.is_constant else value.render()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, bytes):
        return value.hex(" ").upper()
    if isinstance(value, Mapping):
        return {str(key): plain(member) for key, member in value.items()}
    if isinstance(value, (tuple, list)):
        return [plain(member) for member in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {member.name: plain(getattr(value, member.name)) for member in fields(value) if member.name != "source"}
    return value


def short_value(value: Any, notation: str = "") -> str:
    """Return a value as short text, in the given notation of manuals if there is one."""
    if value is None or value in ("", (), [], {}):
        return "none"
    if isinstance(value, (bool, int)):
        return _number_text(value, notation)
    if isinstance(value, Enum):
        return str(value.value).replace("_", " ")
    if isinstance(value, (tuple, list)):
        return _shorten(", ".join(short_value(member, notation) for member in value))
    if isinstance(value, (Expression, Supply, Scale, CodedValue)):
        return _quantity_text(value)
    if is_dataclass(value):
        value = {key: member for key, member in without_words(value).items() if member not in (None, "", [], {})}
        if len(value) == 1:
            return short_value(next(iter(value.values())), notation)
    if isinstance(value, Mapping):
        return _shorten(", ".join(f"{key} = {short_value(member)}" for key, member in value.items()))
    return _shorten(str(value).replace("_", " ") if notation == "word" else str(value))


def _number_text(value: int, notation: str) -> str:
    if isinstance(value, bool):
        yes, no = ("low", "high") if notation == "level" else ("yes", "no")
        return yes if value else no
    return _FORMS[notation](value) if notation in _FORMS else f"{value}"


def _quantity_text(value: Expression | Supply | Scale | CodedValue) -> str:
    match value:
        case Expression():
            return value.render()
        case Supply():
            return f"{volts(value.min_mv)} to {volts(value.max_mv)}"
        case Scale():
            return f"{formula(value)} {value.unit}"
        case CodedValue():
            return f"{value.code} = {value.value}"


def _shorten(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


def without_words(value: Any) -> Any:
    """Return a part of the model as data, without its texts."""
    if isinstance(value, tuple):
        return [without_words(member) for member in value]
    if is_dataclass(value) and not isinstance(value, type):
        data = plain(value)
        return {key: member for key, member in data.items() if key not in _SAID}
    return value


def differing_items(old: Any, new: Any) -> tuple[Any, Any]:
    """Return two values, reduced to the items that differ if both are sequences of parts."""
    are_parts = isinstance(old, tuple) and isinstance(new, tuple) and any(map(is_dataclass, (*old, *new)))
    if not are_parts:
        return old, new
    old_only, new_only = _items_not_in(old, new), _items_not_in(new, old)
    # Only the order of the items differs.
    if not old_only and not new_only:
        return old, new
    return old_only, new_only


def _items_not_in(items: tuple[Any, ...], other_items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the items that are not among others, apart from their texts."""
    known_items = [without_words(other_item) for other_item in other_items]
    return tuple(part for part in items if without_words(part) not in known_items)


def arrow(old: Any, new: Any, notation: str = "") -> str:
    """Return ``old → new``."""
    return f"{short_value(old, notation)} → {short_value(new, notation)}"
