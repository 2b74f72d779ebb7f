"""The body of an encoder: the values it refuses, and how the word or the bytes are put together."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from ..expressions import Expression
from ..model import Field
from .c_layout import LayoutSource
from .c_source import bracketed, c_name, number, size_of, unsigned
from .c_views import Check, Limits


def given(field: Field) -> str:
    """The member of a field in the struct that is encoded."""
    return f"in->{c_name(field.name)}"


class Encoder:
    def __init__(self, source: LayoutSource, limited: str, limits: Limits) -> None:
        self.source = source
        self.layout = source.layout
        self.view = source.view
        self.scope = source.scope
        self.maker = source.maker
        self.limited = limited
        self.limits = limits

    # -- values that are refused

    def checks(self) -> Iterable[Check]:
        for field in self.source.member_fields:
            yield from self._field_checks(field)
            for run in field.digits:
                yield Check(f"in->{c_name(run.name)} > {number(run.modulus - 1)}", "RANGE")
            if field.digits:
                yield Check(f"{given(field)} != {self._from_digits(field)}", "RANGE", "the number and its digits disagree")
        for join in self.layout.joins:
            yield Check(f"in->{c_name(join.name)} != ({self.source.joined(join, given)})", "RANGE", f"{join.name} and its parts disagree")
        yield from self._limit_checks() if self.limited else ()

    def _limit_checks(self) -> Iterable[Check]:
        """The limits of the register; where 0 is refused already, a least value of 1 says no more."""
        limits = self.limits
        field = next((item for item in self.source.member_fields if item.name == self.limited), None)
        if field is not None and (field.zero_means or field.power_of_two) and limits.least == 1:
            limits = replace(limits, binding_min=False)
        yield from limits.checks(f"in->{c_name(self.limited)}")

    def _field_checks(self, field: Field) -> Iterable[Check]:
        name = given(field)
        condition = self.source.choice_condition(field, name)
        if condition:
            yield Check(condition, "RANGE")
        elif field.signed:
            yield Check(f"!{self.maker}_fits_signed({name}, {self.source.bits_text(field)})", "RANGE")
        elif field.zero_means:
            yield Check(f"({name} == 0U) || (({name} > {self.source.width(field)}) && ({name} != {number(field.zero_means)}))", "RANGE")
        elif field.power_of_two:
            yield Check(f"({name} == 0U) || (({name} & ({name} - 1U)) != 0U)", "RANGE", "powers of two only")
        if condition or field.signed or field.zero_means:
            return
        if field.kind in ("number", "choice") and not (field.width.is_constant and size_of(field.widest) == field.widest):
            choice = self.source.choice(field)
            as_number = f"(uint32_t){name}" if choice is not None and choice.is_enum else name
            yield Check(f"{as_number} > {self.source.width(field)}", "RANGE")

    def _from_digits(self, field: Field) -> str:
        work = unsigned(max(field.widest, 32))
        terms = [f"(({work})in->{c_name(run.name)} * {number(run.divisor)})" if run.divisor > 1 else f"in->{c_name(run.name)}" for run in field.digits]
        return "(" + " + ".join(terms) + ")"

    # -- bits

    def _value(self, field: Field) -> str:
        """The bits of a field as an expression over ``in``; a constant one as a number."""
        if field.kind == "constant":
            return number(field.constant, True)
        if field.name == self.source.fixed_selector:
            return number(self.layout.selects[0], True)
        name = given(field)
        if field.kind == "parity":
            return self._parity(field)
        if field.kind == "flag":
            return f"({name} ? 0U : 1U)" if field.active_low else f"({name} ? 1U : 0U)"
        if field.signed:
            return f"((uint64_t){name} & {self.source.width(field)})"
        if field.zero_means:
            return f"(({name} == {number(field.zero_means)}) ? 0U : {name})"
        return name

    def _parity(self, field: Field) -> str:
        of = self.layout.field(field.parity_of)
        name = self._value(of)
        if of.name == self.source.fixed_selector:
            return f"{self.layout.selects[0].bit_count() & 1}U"
        if of.widest > 32:
            return f"{self.maker}_parity((uint32_t){name} ^ (uint32_t)({name} >> 32U))"
        return f"{self.maker}_parity((uint32_t){name})"

    def puts(self) -> Iterable[str]:
        yield from self._word_puts() if self.source.by_word else self._byte_puts()

    def _word_puts(self) -> Iterable[str]:
        terms = [self._term(field) for field in self.layout.fields if field.kind != "crc" and (field.kind != "constant" or field.constant)]
        kind = "const uint64_t" if self.layout.crc_field is None and not self.layout.gray_of else "uint64_t"
        if len(terms) < 2:
            yield f"{kind} word = {''.join(terms) or '0U'};"
        else:
            yield f"{kind} word ="
            yield from (f"    {term}" + (" |" if index < len(terms) - 1 else ";") for index, term in enumerate(terms))
        if self.layout.gray_of:
            yield f"word = {self.source.gray('to', 'word')};"

    def _term(self, field: Field) -> str:
        """A field where it goes in the word."""
        value = self._value(field)
        if field.low == Expression(0):
            return value if value.startswith("(in->") or not value.startswith("in->") else f"(uint64_t){value}"
        low = number(field.low.constant) if field.low.is_constant else bracketed(self.scope.text(field.low))
        return f"((uint64_t){value} << {low})"

    # -- bytes

    def _byte_puts(self) -> Iterable[str]:
        parts, constants = self._parts()
        for byte in range(self.source.length):
            if byte not in parts:
                if not self._is_crc_byte(byte):
                    yield f"bytes[{byte}] = 0x00U;"
                continue
            terms = [*([number(constants[byte], True)] if constants.get(byte) else []), *parts[byte]] or ["0x00U"]
            inner = " | ".join(terms)
            if len(terms) == 1 and (inner.startswith("0x") or inner in self._bytes_as_they_are()):
                yield f"bytes[{byte}] = {inner};"
            else:
                cast = re.sub(r"^\(uint(?:32|64)_t\)(in->[^ ]+)$", r"\1", inner)
                yield f"bytes[{byte}] = (uint8_t){bracketed(cast)};"

    def _parts(self) -> tuple[dict[int, list[str]], dict[int, int]]:
        """For each byte what members give to it, and what is fixed in it."""
        parts: dict[int, list[str]] = {}
        constants: dict[int, int] = {}
        for field in self.layout.fields:
            if field.kind == "crc":
                continue
            if field.kind == "text":
                for index, byte in self.source.characters(field):
                    parts.setdefault(byte, []).append(f"{given(field)}[{index}]")
                continue
            fixed = self._fixed(field)
            for piece in field.pieces:
                parts.setdefault(piece.byte, [])
                if fixed is not None:
                    constants[piece.byte] = constants.get(piece.byte, 0) | (fixed >> piece.left & piece.mask) << piece.right
                elif field.signed or piece.left < size_of(max(field.widest, field.zero_means.bit_length())):
                    parts[piece.byte].append(self._put(field, piece.left, piece.mask, piece.right, alone=len(field.pieces) == 1))
        return parts, constants

    def _fixed(self, field: Field) -> int | None:
        """The number that a field always holds in this frame, if it does."""
        if field.kind == "constant":
            return field.constant
        if field.name == self.source.fixed_selector:
            return self.layout.selects[0]
        if field.kind == "parity" and self.layout.field(field.parity_of).name == self.source.fixed_selector:
            return self.layout.selects[0].bit_count() & 1
        return None

    def _bytes_as_they_are(self) -> set[str]:
        return {given(field) for field in self.source.member_fields if field.kind != "text" and self.source.member_type(field) == "uint8_t"}

    def _is_crc_byte(self, byte: int) -> bool:
        field = self.layout.crc_field
        return field is not None and any(piece.byte == byte for piece in field.pieces)

    def _put(self, field: Field, left: int, bits: int, right: int, alone: bool) -> str:
        """One piece of a field, moved to where it goes in its byte."""
        value = self._value(field)
        if field.signed:
            value = f"(uint64_t){given(field)}"
        if field.kind == "flag":
            bit = number(bits << right, True)
            return f"({given(field)} ? 0x00U : {bit})" if field.active_low else f"({given(field)} ? {bit} : 0x00U)"
        if left:
            value = f"({value} >> {left}U)"
        if (not alone or field.signed) and bits != 0xFF:
            value = f"({value} & {number(bits, True)})"
        if right:
            return f"((uint32_t){value} << {right}U)" if field.kind != "parity" else f"({value} << {right}U)"
        return value if value.startswith("(") or (self.source.member_type(field) == "uint8_t") else f"(uint32_t){value}"

    def crc_lines(self) -> Iterable[str]:
        """What puts the CRC in."""
        field = self.layout.crc_field
        if field is None:
            return
        crc = self.source.device.crc(field.crc)
        if self.layout.carried_as == "bits":
            if self.source.whole_word:
                yield f"word |= {self.source.name}_crc(word);"
            else:
                yield f"word |= {self.view.crc_name(crc, 'bits')}(word >> {crc.width}U, {self.scope.text(self.layout.bits - Expression(crc.width))});"
            return
        call = f"{self.view.crc_name(crc, 'bytes')}(bytes, {self.source.length_macro} - {crc.width // 8}U)"
        if len(field.pieces) == 1:
            yield f"bytes[{field.pieces[0].byte}] = {call};"
            return
        yield f"const {unsigned(crc.width)} crc = {call};"
        yield from (f"bytes[{piece.byte}] = (uint8_t)(crc >> {piece.left}U);" if piece.left else f"bytes[{piece.byte}] = (uint8_t)crc;" for piece in field.pieces)
