"""What a layout may refer to, and the parts of a field that do not depend on where it stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .expressions import Expression, ExpressionError
from .model import Crc, DataId, Digits, Field, Piece, Sources, Value
from .problems import DocumentReport, Path

Raw = Mapping[str, Any]


@dataclass(frozen=True)
class Context:
    """What a layout may refer to. ``parameter_sets`` holds, by interface, the parameters of its order codes, each set once."""

    report: DocumentReport
    groups: Mapping[str, tuple[Raw, Path]]
    definitions: Mapping[str, Expression]
    parameter_sets: Mapping[str, Sequence[Mapping[str, int]]]
    crcs: Mapping[str, Crc]
    data_ids: Mapping[str, tuple[DataId, ...]]
    sources: Any

    def expression(self, text: int | str) -> Expression | None:
        """The expression over parameters that order codes set, or None when it is none."""
        try:
            found = Expression.parse(text).substitute(self.definitions)
            known = next((parameters for sets in self.parameter_sets.values() for parameters in sets), {})
            return found if known.keys() >= set(found.parameters) else None
        except ExpressionError:
            return None  # reported by the rules on references and expressions


#: What BiSS itself means by its two status bits: where a spec says nothing else of them, the position is worth this while they are active.
BISS_FLAGS: Mapping[str, str] = {"error": "not_usable", "warning": "usable_with_warning"}


def makes_position(raw: Raw, interface: str) -> str:
    """What the position is worth while the flag ``raw`` is active; empty where nothing is known."""
    said: str = raw.get("makes_position", "")
    return said or (BISS_FLAGS.get(raw["name"], "") if interface == "biss" and "active" in raw else "")


def bit_range(text: int | str) -> tuple[int, int] | None:
    """``7:6`` as (7, 6) and ``5`` as (5, 5); None when it is neither, or upside down."""
    high, _, low = str(text).partition(":")
    if not high.isdecimal() or len(high) > 4 or (low and (not low.isdecimal() or len(low) > 4)):
        return None
    bounds = int(high), int(low or high)
    return bounds if bounds[0] >= bounds[1] else None


def equals(raw: Raw, context: Context) -> Expression | int | str | None:
    """What a reader finds: text as it is, a number as a number, an expression where it depends on the order code."""
    found = raw.get("equals")
    if isinstance(found, str) and "text" not in raw:
        return context.expression(found)
    return found if isinstance(found, (int, str)) else None


def zero_field(name: str, low: Expression, width: Expression, widest: int, source: Sources, padding_of: str = "") -> Field:
    return Field(name=name, kind="constant", low=low, width=width, widest=widest, padding_of=padding_of, meaning="always zero", source=source)


def kind(raw: Raw) -> str:
    kinds = {"constant": "constant", "active": "flag", "values": "choice", "values_of": "choice", "crc": "crc", "parity_of": "parity", "digits": "digits", "text": "text"}
    return next((kind for key, kind in kinds.items() if key in raw), "number")


def build_values(raw: Raw, context: Context) -> tuple[Value, ...]:
    """The named values that ``raw['values']`` lists, as the spec orders them."""
    return tuple(
        Value(name, value["value"], value.get("printed_name", ""), value.get("names", {}), value.get("meaning", ""), context.sources(value))
        for name, value in raw.get("values", {}).items()
    )


def values(raw: Raw, context: Context, interface: str) -> tuple[Value, ...]:
    if "values_of" in raw:
        return tuple(Value(item.name, item.id, f"Data ID {item.id:X}", {}, item.meaning, item.source) for item in context.data_ids.get(interface, ()))
    return build_values(raw, context)


def digits(raw: Raw) -> tuple[Digits, ...]:
    runs, divisor = [], 1
    for run in reversed(raw.get("digits", ())):
        runs.append(Digits(run["name"], run["digits"], divisor, 10 ** run["digits"], run.get("meaning", "")))
        divisor *= 10 ** run["digits"]
    return tuple(reversed(runs))


def pieces(field: Field, length: int, low_first: bool) -> tuple[Piece, ...]:
    """The bytes that hold the field, where that is the same for every order code."""
    size = field.container or (field.width.constant if field.width.is_constant else 0)
    if not field.low.is_constant or not size:
        return ()
    low, pieces, done = field.low.constant, [], 0
    while done < size:
        bit = low + done
        part = min(8 - bit % 8, size - done)
        pieces.append(Piece(bit // 8 if low_first else length - 1 - bit // 8, bit % 8, (1 << part) - 1, done))
        done += part
    return tuple(pieces)
