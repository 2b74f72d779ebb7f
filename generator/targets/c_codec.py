"""A struct with its decoder and encoder, for a frame or a register."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from ..expressions import Expression
from ..model import Field, Join
from .c_crc import crc_view, fold_lines, word_by_bits, word_by_table
from .c_decode import Decoder
from .c_encode import Encoder
from .c_layout import LayoutSource
from .c_source import Paragraph, bracketed, c_name, needs_variant, number, string, unsigned
from .c_views import CodecView, CrcView, Limits, Line, Setter


def codec(source: LayoutSource, about: Sequence[Paragraph], limited: str = "", limits: Limits = Limits()) -> CodecView:
    """The codec of a layout; ``limits`` bound the member ``limited`` of what is encoded."""
    layout = source.layout
    decoder, encoder = Decoder(source), Encoder(source, limited, limits)
    first_checks, locals_, checks, fills = tuple(decoder.first_checks()), tuple(decoder.locals()), tuple(decoder.checks()), tuple(decoder.fills())
    encode_checks, puts, crc_lines = tuple(encoder.checks()), tuple(encoder.puts()), tuple(encoder.crc_lines())
    order = range(source.length) if layout.byte_order == "low_byte_first" else range(source.length - 1, -1, -1)
    terms = [f"(uint64_t)bytes[{byte}]" if place == 0 else f"((uint64_t)bytes[{byte}] << {8 * place}U)" for place, byte in enumerate(order)]
    expected, expected_checks = _expected(source)
    made = CodecView(
        name=source.name,
        about=tuple(about),
        members=tuple(source.members()) or (Line("uint8_t no_data;", "this layout carries no data"),),
        carried_as=layout.carried_as,
        length_macro=source.length_macro,
        length=source.length,
        bits=source.scope.text(layout.bits),
        bits_largest=layout.widest,
        uses_word=source.by_word,
        word_from_bytes=" |\n        ".join(terms),
        bytes_from_word=tuple(f"bytes[{byte}] = (uint8_t)(word >> {8 * place}U);" if place else f"bytes[{byte}] = (uint8_t)word;" for place, byte in enumerate(order)),
        first_checks=first_checks,
        locals=locals_,
        decode_checks=checks,
        fills=fills,
        encode_checks=encode_checks,
        puts=puts,
        crc_line=crc_lines,
        decode_needs_variant=layout.carried_as == "bits" or needs_variant(first_checks, locals_, checks, fills),
        encode_needs_variant=needs_variant(encode_checks, puts, crc_lines),
        setters=tuple(_setters(source)),
        expected=tuple(expected),
        expected_checks=" && ".join(f"({item})" for item in expected_checks) if len(expected_checks) > 1 else "".join(expected_checks),
        expected_needs_variant=needs_variant(expected_checks),
        fold=_fold(source),
    )
    with source.view.names.of(*source.path):
        source.view.names.give_codec(made)
    return made


def _fold(source: LayoutSource) -> CrcView | None:
    """The function that finds the CRC of a whole word."""
    crc_field = source.layout.crc_field
    if not source.whole_word or crc_field is None:
        return None
    crc = source.device.crc(crc_field.crc)
    name, bits = source.view.crc_name(crc, "bits"), source.layout.widest
    # The final XOR lies in the bits of the CRC, which no step moves, so that it can be taken out at the end.
    result = f"return v ^ {number(crc.xorout, True)};" if crc.xorout else "return v;"
    return replace(
        crc_view(source.device, crc, "fold" if source.folds else "bits", name),
        name=f"{source.name}_crc",
        about=(f"CRC {crc.name} of a whole word: 0 when the word is sound. For a word with 0 in place of its CRC, the CRC to send.",),
        folds=(*fold_lines(source.layout.fold, bits, "word"), result) if source.folds else (),
        word_table=(*word_by_table(crc, bits, f"{name}_entry"), result),
        word_bits=(*word_by_bits(crc, bits), result),
    )


def _setters(source: LayoutSource) -> Iterable[Setter]:
    for join in source.layout.joins:
        yield _join_setter(source, join)
    for field in source.layout.fields:
        if field.digits:
            yield _digits_setter(source, field)


#: What the functions that set several members call their other arguments.
_TAKEN = frozenset(("variant", "out"))


def _join_setter(source: LayoutSource, join: Join) -> Setter:
    assignments, offset, argument = [], Expression(0), c_name(join.name, _TAKEN)
    for name in reversed(join.fields):
        field = source.layout.field(name)
        low, width = source.scope.text(offset), source.scope.text(field.width)
        assignments.append(f"out->{c_name(name)} = ({unsigned(field.widest)}){source.maker}_field({argument}, {low}, {width});")
        offset += field.width
    about = f"Sets {join.name} and with it {' and '.join(join.fields)}."
    limit = f"{source.maker}_mask({source.scope.text(offset)})"
    return Setter(f"{source.name}_set_{join.name}", source.join_type(join), c_name(join.name), argument, limit, tuple(assignments), about, needs_variant(limit, assignments))


def _digits_setter(source: LayoutSource, field: Field) -> Setter:
    kind, name = source.member_type(field), c_name(field.name, _TAKEN)
    assignments = []
    for run in field.digits:
        divided = f"{name} / {number(run.divisor)}" if run.divisor > 1 else name
        whole = divided if run is field.digits[0] else f"{bracketed(divided)} % {number(run.modulus)}"
        assignments.append(f"out->{c_name(run.name)} = ({unsigned((run.modulus - 1).bit_length())})({whole});")
    limit = number(field.digits[0].divisor * field.digits[0].modulus - 1)
    about = f"Sets {field.name} and with it {', '.join(run.name for run in field.digits)}."
    return Setter(f"{source.name}_set_{field.name}", kind, c_name(field.name), name, limit, tuple(assignments), about, False)


def _expected(source: LayoutSource) -> tuple[list[Line], list[str]]:
    """Macros for what the manual states that fields hold, and the conditions that compare them."""
    macros: list[Line] = []
    checks: list[str] = []
    for field in source.member_fields:
        if field.equals is None:
            continue
        name = f"in->{c_name(field.name)}"
        equals = field.equals.constant if isinstance(field.equals, Expression) and field.equals.is_constant else field.equals
        if isinstance(equals, Expression):
            checks.append(f"{name} == {bracketed(source.scope.text(equals))}")
            continue
        macro = source.view.unique(f"{source.name.upper()}_{field.name.upper()}_EXPECTED")
        if isinstance(equals, str):
            macros.append(Line(f"#define {macro} {string(equals)}", f"what the manual states for {field.name}"))
            checks += [f"{name}[{index}] == {macro}[{index}]" for index in range(len(equals.encode("ascii", "replace")))]
        else:
            macros.append(Line(f"#define {macro} {number(equals, True)}", f"what the manual states for {field.name}"))
            checks.append(f"{name} == {macro}")
    return macros, checks
