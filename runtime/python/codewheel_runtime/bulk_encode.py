# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Encodes many frames from columns. Loaded only by ``encode_many``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from .bulk_decode import CHUNK, Chunk, crc_difference, np, parity_bits, within
from .codec import assert_never
from .errors import RangeError
from .shape import Column, Join, Shape, scales, width_of


class RowError(RangeError):
    """A field cannot be encoded. ``row`` is the index of the first row that has such a field."""

    def __init__(self, row: int, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.row = row
        self.args = (row, field, value, allowed)

    def __str__(self) -> str:
        return f"row {self.row}: {super().__str__()}"


class Refused:
    """First error in the rows: the first wrong field of the first row with an error."""

    def __init__(self) -> None:
        self.row: int | None = None
        self._error: tuple[str, object, str] = ("", 0, "")

    def add(self, bad: Any, field: str, values: Any, allowed: str) -> None:
        """Record the first row in which ``bad`` is True."""
        if not bad.any():
            return
        row = int(bad.argmax())
        if self.row is None or row < self.row:
            self.row, self._error = row, (field, values[row].item(), allowed)

    def tell(self, start: int) -> None:
        """Raise RowError if there is an error. ``start`` is the number of the first row."""
        if self.row is not None:
            raise RowError(start + self.row, *self._error)


def encode_many(columns: Mapping[str, Any], shape: Shape) -> Any:
    """Encode the frames in ``columns``. For the arguments, see ``encode_many`` of the frame's class."""
    given = _given(columns, shape)
    count = len(next(iter(given.values()))) if given else 0
    frames = np.empty((count, shape.length), np.uint8) if shape.length else np.empty(count, np.uint64)
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        refused = Refused()
        limbs = _made({name: column[part] for name, column in given.items()}, shape, refused)
        refused.tell(start)
        frames[part] = _rows(limbs, shape) if shape.length else limbs[0]
    return frames


def _given(columns: Mapping[str, Any], shape: Shape) -> dict[str, Any]:
    """Return the required columns as arrays of equal length. A single value applies to all rows."""
    if not hasattr(columns, "keys"):
        raise TypeError(f"columns must be a mapping of names to arrays, got {type(columns).__name__}")
    needed = {name: item for item in shape.columns for name in names_of(item)}
    joined = {join.name: [name for name, _ in join.fields] for join in shape.joins}
    by_join = {name for join, names in joined.items() if join in columns for name in names}
    optional = {name for name, item in needed.items() if item.kind.endswith("flag") or not item.width} | {"unused"}
    missing = sorted(needed.keys() - columns.keys() - by_join - optional)
    others: set[str] = {*getattr(columns, "others", ()), *scales(shape)}
    unknown = sorted({*columns} - others - needed.keys() - joined.keys() - {"unused", "fault", "verdict"})
    if missing or unknown:
        raise TypeError(f"missing columns: {missing}; unknown columns: {unknown}")
    wanted = [name for name in (*needed, *joined, "unused", "fault") if name in columns]
    arrays = {name: np.asarray(columns[name]) for name in wanted}
    longest = max((item.size for item in arrays.values() if item.ndim), default=1)
    for name, item in arrays.items():
        if item.ndim > 1 or (item.ndim == 1 and len(item) != longest):
            raise ValueError(f"column {name} has the shape {item.shape}, but others have {longest} rows")
        if item.dtype.kind not in ("SU" if name in needed and needed[name].kind == "text" else "uib"):
            raise TypeError(f"column {name} has the type {item.dtype}, which does not fit the field")
    return {name: np.broadcast_to(item, (longest,)) for name, item in arrays.items()}


def names_of(item: Column) -> tuple[str, ...]:
    """Return the names of a field's columns: one for each group of its decimal digits, or just the field."""
    return tuple(name for name, _, _ in item.runs) or (item.name,)


def _made(given: Mapping[str, Any], shape: Shape, refused: Refused) -> list[Any]:
    """Return the frames as numbers, in 64-bit limbs."""
    count = len(next(iter(given.values())))
    limbs = [np.full(count, shape.fixed >> low & (1 << 64) - 1, np.uint64) for low in range(0, shape.bits, 64)]
    if "fault" in given:
        refused.add(given["fault"] != 0, "fault", given["fault"], "0 (a frame with an error has no values)")
    for item in shape.columns:
        if all(name in given for name in names_of(item)):
            for low, width, bits in _bits(given, item, refused):
                _put(limbs, low, width, bits)
        elif item.kind == "not_flag":
            _put(limbs, item.low, item.width, np.ones(count, np.uint64))
    for join in shape.joins:
        if join.name in given:
            _put_join(limbs, given, shape, join, refused)
    _put_unused(limbs, given, shape, refused)
    chunk = Chunk(limbs, shape.bits)
    for check in shape.parities:
        _put(limbs, check.low, check.width, parity_bits(chunk, check).astype(np.uint64))
    _check_values(limbs, given, shape, refused)
    _finish(limbs, shape)
    return limbs


def _put(limbs: list[Any], low: int, width: int, bits: Any) -> None:
    """Insert bits at a position where all bits are still 0."""
    at, shift = divmod(low, 64)
    if width:
        limbs[at] |= bits << np.uint64(shift)
    if shift + width > 64:
        limbs[at + 1] |= bits >> np.uint64(64 - shift)


def _bits(given: Mapping[str, Any], item: Column, refused: Refused) -> Iterator[tuple[int, int, Any]]:
    """Yield the pieces of a field: lowest bit, width and bits."""
    values = given[names_of(item)[0]]
    match item.kind:
        case "flag" | "not_flag":
            yield item.low, item.width, ((values != 0) == (item.kind == "flag")).astype(np.uint64)
        case "digits":
            number = np.zeros(len(values), np.uint64)
            for name, divisor, modulus in item.runs:
                digits = _unsigned(given[name], refused, name, modulus - 1)
                number += digits * np.uint64(divisor)
            yield item.low, item.width, _fitting(number, item.width, number, refused, item.name)
        case "text":
            yield from _text(values, item, refused)
        case "signed":
            top = 1 << item.width >> 1
            high = max(top, 1) - 1
            wrong = values > high if top else values != 0
            if values.dtype.kind == "i":
                wrong = wrong | (values < -top)
            refused.add(wrong, item.name, values, f"{-top} to {top - 1}")
            yield item.low, item.width, values.astype(np.int64).view(np.uint64) & np.uint64((1 << item.width) - 1)
        case "number" | "choice":
            yield item.low, item.width, _number(values, item, refused)
        case _:
            assert_never(item.kind)


def _number(values: Any, item: Column, refused: Refused) -> Any:
    """Return the bits of an unsigned number."""
    if item.power_of_two:
        wrong = (values < 1) | (values & (values - values.dtype.type(1)) != 0)
        refused.add(wrong, item.name, values, "a power of two")
    if item.zero_means:
        refused.add(values == 0, item.name, values, f"1 to {item.zero_means}")
        values = np.where(values == item.zero_means, values.dtype.type(0), values)
    return _unsigned(values, refused, item.name, (1 << item.width) - 1)


def _unsigned(values: Any, refused: Refused, name: str, most: int) -> Any:
    """Return numbers that are at most ``most`` as unsigned 64-bit numbers."""
    wrong = values < 0 if values.dtype.kind == "i" else np.zeros(len(values), bool)
    bits = values.astype(np.uint64)
    if most < (1 << 64) - 1:
        wrong = wrong | (bits > np.uint64(most))
    refused.add(wrong, name, values, f"0 to {most}")
    return bits


def _fitting(bits: Any, width: int, values: Any, refused: Refused, name: str) -> Any:
    """Return bits after a check that they fit into ``width`` bits."""
    if width < 64:
        refused.add(bits >> np.uint64(width) != 0, name, values, f"0 to {(1 << width) - 1}")
    return bits


def _text(values: Any, item: Column, refused: Refused) -> Iterator[tuple[int, int, Any]]:
    """Yield the characters of a string, the first one most significant. Trailing NUL characters may be omitted."""
    length = item.width // 8
    kind = np.dtype(np.uint8 if values.dtype.kind == "S" else np.uint32)
    count = values.dtype.itemsize // kind.itemsize
    letters = np.zeros((len(values), max(length, count)), kind)
    native = np.ascontiguousarray(values, values.dtype.newbyteorder("="))
    letters[:, :count] = native.view(kind).reshape(len(values), count)
    wrong = (letters > 255).any(1) | letters[:, length:].any(1)
    refused.add(wrong, item.name, values, f"{length} Latin-1 characters")
    for place in range(length):
        yield item.low + 8 * (length - 1 - place), 8, letters[:, place].astype(np.uint64)


def _put_join(limbs: list[Any], given: Mapping[str, Any], shape: Shape, join: Join, refused: Refused) -> None:
    """Insert the fields of a joined number. Fields that are also given separately must agree with it."""
    width = width_of(shape, join)
    whole = _unsigned(given[join.name], refused, join.name, (1 << width) - 1)
    by_name = {item.name: item for item in shape.columns}
    for name, place in join.fields:
        item = by_name[name]
        if not item.width:
            continue
        bits = whole >> np.uint64(place) & np.uint64((1 << item.width) - 1)
        if all(known in given for known in names_of(item)):
            had = Chunk(limbs, shape.bits).take(item.low, item.width)
            refused.add(had != bits, join.name, given[join.name], "equal to its fields")
        else:
            _put(limbs, item.low, item.width, bits)


def _put_unused(limbs: list[Any], given: Mapping[str, Any], shape: Shape, refused: Refused) -> None:
    """Insert unused bits as in the manual, inverted where the column ``unused`` is 1."""
    values = given.get("unused", np.zeros(len(limbs[0]), np.uint8))
    bits = values.astype(np.uint64)
    known = sum(((1 << item.width) - 1) << item.place for item in shape.unused)
    refused.add(bits & np.uint64(~known & (1 << 64) - 1) != 0, "unused", values, f"within the mask {known:#x}")
    for item in shape.unused:
        mask = np.uint64((1 << item.width) - 1)
        _put(limbs, item.low, item.width, (bits >> np.uint64(item.place) ^ np.uint64(item.value)) & mask)


def _check_values(limbs: list[Any], given: Mapping[str, Any], shape: Shape, refused: Refused) -> None:
    """Check the fields that allow only some values or consist of decimal digits."""
    by_place = {(item.low, item.width): item for item in shape.columns}
    for check in shape.checks:
        item = by_place.get((check.low, check.width))
        if item is None or check.parity_of:
            continue
        bits = Chunk(limbs, shape.bits).take(check.low, check.width)
        if check.limit is not None:
            is_signed = item.kind == "signed"
            allowed = f"{check.lowest} to {check.limit}" if is_signed else f"at most {check.limit}"
            refused.add(~within(bits, check, check.limit), item.name, given[item.name] if is_signed else bits, allowed)
        else:
            good = np.isin(bits, [value for value in check.values if not value >> check.width])
            allowed = "one of " + ", ".join(map(str, check.values))
            refused.add(~good, item.name, given.get(item.name, bits), allowed)


def _finish(limbs: list[Any], shape: Shape) -> None:
    """Apply Gray code and the CRC."""
    if shape.gray is not None:
        low, width = shape.gray
        number = limbs[0] >> np.uint64(low) & np.uint64((1 << width) - 1)
        limbs[0] ^= number >> np.uint64(1) << np.uint64(low)
    if shape.crc is not None:
        found = crc_difference(Chunk(limbs, shape.bits), shape.crc).astype(np.uint64)
        _put(limbs, shape.crc.low, shape.crc.width, found)


def _rows(limbs: list[Any], shape: Shape) -> Any:
    """Return the bytes of each frame in the order in which they are sent."""
    rows = np.stack([limb.astype("<u8").view(np.uint8).reshape(-1, 8) for limb in limbs], 1)
    rows = rows.reshape(len(limbs[0]), -1)[:, : shape.length]
    return rows if shape.order == "little" else rows[:, ::-1]
