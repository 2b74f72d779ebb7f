"""The plain reference for a decoder and an encoder, in C: written from the layout, bit by bit, in wide integers.

``check`` reads every field into ``r_…`` and returns the error in the values. ``crc_of`` is the shift register of the
CRC's definition. ``reference`` returns the first error in the documented order, and ``uncovered`` the bits outside all
fields.
"""

from __future__ import annotations

from collections.abc import Iterator

from codewheel.model import Constant, Crc, Field, Join, Parity, Unused
from codewheel.model.expressions import Expression
from proof import in_c
from proof_layout import CONSTANT, CRC, LENGTH, RANGE, Codec


def shift_in(crc: Crc, bit: str) -> tuple[str, ...]:
    """Return C that shifts one more bit into ``shift_register``, as a CRC is defined."""
    return (
        f"unsigned long long feedback = ((shift_register >> {crc.width - 1}) ^ (unsigned long long)({bit})) & 1;",
        f"shift_register = (shift_register << 1) & {crc.mask}ULL;",
        f"for (int k = 0; k < {crc.width}; k++) shift_register ^= (({crc.poly}ULL >> k) & feedback) << k;",
    )


def shifted_out(crc: Crc) -> tuple[str, ...]:
    """Return C that reverses ``shift_register`` if the CRC is defined that way."""
    if not crc.refout:
        return ()
    turn = f"for (int k = 0; k < {crc.width}; k++) turned |= ((shift_register >> k) & 1) << ({crc.width - 1} - k);"
    return ("unsigned long long turned = 0;", turn, "shift_register = turned;")


def reference(codec: Codec) -> str:
    layout, crc, check = codec.layout, codec.crc, layout_crc(codec)
    names = [*(field.name for field in layout.fields), *(join.name for join in layout.joins)]
    lines = [f"static number r_{name};" for name in names]
    lines += ["static number r_unused;"] if layout.unused else []
    lines += ["static number received(number word, long long low, long long width)", "{", "    number value = 0;"]
    lines += [
        f"    for (int i = 0; i < {layout.widest}; i++) if (i < width) value |= ((word >> low) & ((number)1 << i));",
        "    return value;",
        "}",
    ]
    if any(field.number.signed for field in layout.fields):
        lines += ["static long long signed_number(number raw, long long width)", "{"]
        lines += ["    return (raw >> (width - 1)) & 1 ? (long long)raw - (1LL << width) : (long long)raw;", "}"]
    lines += _out_of_gray(codec)
    if crc is not None:
        lines += _crc_of(codec, crc)
    lines += [*_check(codec), "static number uncovered(number word)", "{"]
    places = [(in_c(field.width), in_c(field.low)) for field in layout.fields]
    lines += [f"    word &= ~(received(~(number)0, 0, {width}) << {low});" for width, low in places]
    lines += [f"    return received(word, 0, {in_c(layout.bits)});", "}"]
    lines += ["static int reference(number word)", "{"]
    lines += [f"    if (word >> {in_c(layout.bits)}) return {LENGTH};"] if codec.by_word else []
    lines += [f"    if (crc_of(word) != {check}) return {CRC};"] if check else []
    return "\n".join([*lines, "    return check(word);", "}", ""])


def _check(codec: Codec) -> Iterator[str]:
    """Return the function that reads the fields of a word, and checks its constants and ranges."""
    layout = codec.layout
    yield from ("static int check(number word)", "{", "    number plain = out_of_gray(word);")
    for field in layout.fields:
        source = "word" if isinstance(field.kind, Parity) else "plain"
        yield f"    r_{field.name} = received({source}, {in_c(field.low)}, {in_c(field.width)});"
    for join in layout.joins:
        parts = [f"r_{name}" for name in join.fields]
        yield f"    r_{join.name} = {codec.joined(join, *parts)};"
    # A bit is 1 if it differs from the documented one. If the field is narrower, so is the documented value.
    for index, (field, place) in enumerate(layout.unused):
        difference = f"(r_{field.name} ^ ({documented(field)}ULL & {ones(field)}))"
        yield f"    r_unused {'|=' if index else '='} {difference} << {place};"
    for fault, conditions in ((CONSTANT, _constants(codec)), (RANGE, _ranges(codec))):
        yield from (f"    if ({condition}) return {fault};" for condition in conditions)
    yield from ("    return 0;", "}")


def documented(field: Field) -> int:
    """Return the documented value of unused bits."""
    assert isinstance(field.kind, Unused)
    return field.kind.value


def ones(field: Field) -> str:
    """Return the bits of a field as 1 bits."""
    return f"received(~(number)0, 0, {in_c(field.width)})"


def layout_crc(codec: Codec, word: str = "word") -> str:
    """Return the CRC in a word, or nothing if the layout has none."""
    fields = codec.layout.crc_fields
    return f"received({word}, {in_c(fields[0].low)}, {in_c(fields[0].width)})" if fields else ""


def _out_of_gray(codec: Codec) -> Iterator[str]:
    """Return the word with its part in Gray code, if any, converted to binary.

    Every bit is the sum of the bits from the top of the number down to it.
    """
    layout = codec.layout
    yield from ("static number out_of_gray(number word)", "{")
    if layout.gray_of:
        join = next((join for join in layout.joins if join.name == layout.gray_of), Join("", (layout.gray_of,)))
        lowest = layout.field(join.fields[-1]).low
        yield from (
            f"    if (p_{layout.gray_when} != 0) {{" if layout.gray_when else "    {",
            "        number sum = 0;",
            f"        for (int i = {layout.widest - 1}; i >= 0; i--)",
        )
        yield f"            if (i >= {in_c(lowest)} && i < {in_c(lowest + codec.join_width(join))}) {{"
        yield "                sum ^= (word >> i) & 1;"
        yield from ("                word = (word & ~((number)1 << i)) | (sum << i);", "            }")
        if layout.gray_excess is not None:
            yield from _less_excess(layout.gray_excess, lowest, codec.join_width(join))
        yield "    }"
    yield from ("    return word;", "}")


def _less_excess(excess: Expression, low: Expression, width: Expression) -> Iterator[str]:
    """Yield the subtraction of the excess from the number in the word, modulo the numbers that fit."""
    place, count = in_c(low), in_c(width)
    yield f"        number part = received(word, {place}, {count}) + ((number)1 << {count}) - {in_c(excess)};"
    yield f"        part = received(part, 0, {count});"
    yield f"        word = (word & ~(received(~(number)0, 0, {count}) << {place})) | (part << {place});"


def _crc_of(codec: Codec, crc: Crc) -> Iterator[str]:
    """Return the CRC of everything that was sent before it, in the order of sending."""
    layout = codec.layout
    yield from ("static number crc_of(number word)", "{", f"    unsigned long long shift_register = {crc.init}ULL;")
    if codec.by_word:
        yield f"    for (int i = {layout.widest - 1}; i >= {crc.width}; i--) {{"
        # Leading zeros leave a register of zeros unchanged.
        yield f"        if (i >= {in_c(layout.bits)}) continue;" if crc.init else ""
        bit = "(word >> i) & 1"
    else:
        yield f"    for (int i = 0; i < {8 * codec.size - crc.width}; i++) {{"
        byte = "i / 8" if layout.byte_order == "low_byte_first" else f"{codec.size - 1} - i / 8"
        bit = f"(word >> (8 * ({byte}) + ({'i % 8' if crc.refin else '7 - i % 8'}))) & 1"
    yield from (f"        {line}" for line in shift_in(crc, bit))
    yield from (
        "    }",
        *(f"    {line}" for line in shifted_out(crc)),
        f"    return shift_register ^ {crc.xorout}ULL;",
        "}",
    )


def _constants(codec: Codec) -> Iterator[str]:
    for field in codec.layout.fields:
        if isinstance(field.kind, Constant):
            yield f"{in_c(field.width)} > 0 && r_{field.name} != {field.kind.value}ULL"
        if isinstance(field.kind, Parity):
            parity_fields, mask = map(codec.layout.field, field.kind.of), field.kind.mask
            covered_bits_in_c = []
            for parity_field in parity_fields:
                field_in_c = f"received(word, {in_c(parity_field.low)}, {in_c(parity_field.width)})"
                covered_bits = [bit for bit in range(parity_field.widest) if mask >> bit & 1]
                covered_bits_in_c += [f"(({field_in_c} >> {bit}) & 1)" for bit in covered_bits]
            yield f"r_{field.name} != ({' ^ '.join([*covered_bits_in_c, *(['1'] if field.kind.odd else [])])})"


def _ranges(codec: Codec) -> Iterator[str]:
    for field in codec.layout.fields:
        allowed = codec.allowed(field)
        if allowed:
            yield " && ".join(f"r_{field.name} != {value}" for value in allowed)
        if field.runs:
            yield f"r_{field.name} >= {10 ** sum(run.digits for run in field.runs)}ULL"
