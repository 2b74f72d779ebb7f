"""The body of a decoder: locals that hold the bits of the fields, the faults it looks for, and how the members are filled."""

from __future__ import annotations

from collections.abc import Iterable

from ..expressions import Expression
from ..model import Field
from .c_layout import LayoutSource
from .c_source import bracketed, c_name, mask, number, unsigned, words
from .c_views import Check


class Decoder:
    def __init__(self, source: LayoutSource) -> None:
        self.source = source
        self.layout = source.layout
        self.view = source.view
        self.scope = source.scope
        self.maker = source.maker
        self.local = source.local

    def locals(self) -> Iterable[str]:
        if self.layout.gray_of:
            yield f"const uint64_t plain = {self.source.gray('from', 'word')};"
        for field in self.layout.fields:
            if field.kind in ("constant", "crc", "text") or self._is_plain_flag(field):
                continue
            kind, expression = self.source.raw(field)
            yield f"const {kind} {self.local(field)} = {expression};"

    def _is_plain_flag(self, field: Field) -> bool:
        """A flag that nothing but its own member looks at."""
        used = {name for join in self.layout.joins for name in join.fields} | {other.parity_of for other in self.layout.fields}
        return field.kind == "flag" and field.name not in used

    # -- faults

    def first_checks(self) -> Iterable[Check]:
        """What is checked before anything is taken out: a disturbed frame costs no more, and registers are free for it."""
        crc_field = self.layout.crc_field
        if crc_field is not None:
            yield Check(self._crc_condition(crc_field), "CRC")

    def checks(self) -> Iterable[Check]:
        if self.source.by_word:
            yield from self._constants_in_word()
        else:
            yield from self._padding()
            yield from self._constants_in_bytes()
        for field in sorted(self.layout.fields, key=lambda item: item.parity_of == self.source.fixed_selector):
            if field.kind == "parity":
                yield from self._parity_checks(field)
        for field in self.layout.fields:
            condition = self.source.choice_condition(field, self.local(field), is_raw=True)
            if condition and not (field.name == self.source.fixed_selector and any(other.parity_of == field.name for other in self.layout.fields)):
                yield Check(condition, "RANGE")
            if field.digits:
                limit = field.digits[0].divisor * field.digits[0].modulus
                yield Check(f"{self.local(field)} > {number(limit - 1)}", "RANGE", f"{sum(run.digits for run in field.digits)} digits")

    def _parity_checks(self, field: Field) -> Iterable[Check]:
        """A parity bit; of the field that tells this frame, whose one value has a known parity, another value is told from a fault first."""
        of = self.layout.field(field.parity_of)
        wrong = f"{self.local(field)} != {self._parity(field)}"
        other = self.source.choice_condition(of, self.local(of), is_raw=True) if of.name == self.source.fixed_selector else ""
        if not other:
            yield Check(wrong, "CONSTANT", f"even parity of {words(of.name)}")
            return
        right = f"{self.local(field)} == {self._parity(field)}"
        yield Check(f"({other}) && ({right})", "RANGE", f"{words(of.name)} of another frame")
        yield Check(f"({other}) || ({self.local(field)} != {self.layout.selects[0].bit_count() & 1}U)", "CONSTANT", f"even parity of {words(of.name)}")

    def _crc_condition(self, field: Field) -> str:
        crc = self.source.device.crc(field.crc)
        if self.layout.carried_as == "bits":
            if self.source.whole_word:
                return f"{self.source.name}_crc(word) != 0U"
            covered = f"word >> {crc.width}U, {self.scope.text(self.layout.bits - Expression(crc.width))}"
            return f"{self.view.crc_name(crc, 'bits')}({covered}) != (word & {mask(crc.width)})"
        if crc.form == "xor":
            return f"{self.view.crc_name(crc, 'bytes')}(bytes, {self.source.length_macro}) != 0U"
        _, received = self.source.raw(field)
        received = f"({received})" if " | " in received else received
        return f"{self.view.crc_name(crc, 'bytes')}(bytes, {self.source.length_macro} - {crc.width // 8}U) != {received}"

    def _constants_in_word(self) -> Iterable[Check]:
        for field in self.layout.fields:
            if field.kind != "constant":
                continue
            value = self.source.in_word(field) if field.low.is_constant and field.width.is_constant else self.source.moving(field)
            guard = f"({self.scope.text(field.width)}) != 0U && " if field.constant and not field.width.is_constant else ""
            yield Check(f"{guard}{value} != {number(field.constant, True)}", "CONSTANT", field.name.replace("_", " "))

    def _constants_in_bytes(self) -> Iterable[Check]:
        by_byte: dict[int, tuple[int, int, list[str]]] = {}
        for field in self.layout.fields:
            if field.kind != "constant":
                continue
            if field.padding_of:
                padded = self.layout.field(field.padding_of)
                by_byte |= {piece.byte: (0xFF, 0, [f"above {padded.name.replace('_', ' ')}"]) for piece in self.source.padding(padded)}
                continue
            for piece in field.pieces:
                bits, value, names = by_byte.get(piece.byte, (0, 0, []))
                part = field.constant >> piece.left & piece.mask
                by_byte[piece.byte] = (bits | piece.mask << piece.right, value | part << piece.right, [*names, field.name.replace("_", " ")])
        for byte, (bits, value, names) in sorted(by_byte.items()):
            found = f"bytes[{byte}]" if bits == 0xFF else f"(bytes[{byte}] & {number(bits, True)})"
            yield Check(f"{found} != {number(value, True)}", "CONSTANT", ", ".join(dict.fromkeys(names)))

    def _padding(self) -> Iterable[Check]:
        """The bits above a field in the bytes that it reaches."""
        for padded in (self.layout.field(field.padding_of) for field in self.layout.fields if field.padding_of):
            if not padded.width.is_constant or padded.container - 8 * len(self.source.padding(padded)) > padded.widest:
                yield Check(f"{self.local(padded)} > {self.source.width(padded)}", "CONSTANT", f"bits above {padded.name.replace('_', ' ')} are always 0")

    def _parity(self, field: Field) -> str:
        of = self.layout.field(field.parity_of)
        name = self.local(of)
        if of.widest > 32:
            return f"{self.maker}_parity((uint32_t){name} ^ (uint32_t)({name} >> 32U))"
        return f"{self.maker}_parity({name})"

    # -- members

    def fills(self) -> Iterable[str]:
        plain = [] if self.source.by_word else [field for field in self.source.member_fields if self._is_plain_flag(field)]
        first = [field for before, field in zip([None, *plain], plain) if before is None or before.pieces[0].byte != field.pieces[0].byte]
        for field in self.source.member_fields:
            if field in first:
                declared = "" if field is not first[0] else "uint8_t " if len(first) > 1 else "const uint8_t "
                yield f"{declared}flags = bytes[{field.pieces[0].byte}];"
            yield from self._fill(field)
            name = self.local(field)
            for run in field.digits:
                divided = f"{name} / {number(run.divisor)}" if run.divisor > 1 else name
                whole = divided if run is field.digits[0] else f"{bracketed(divided)} % {number(run.modulus)}"
                yield f"out->{c_name(run.name)} = ({unsigned((run.modulus - 1).bit_length())})({whole});"
        for join in self.layout.joins:
            yield f"out->{c_name(join.name)} = {self.source.join_in_word(join) or self.source.joined(join, self.local)};"
        if not self.source.member_fields:
            yield "out->no_data = 0U;"

    def _fill(self, field: Field) -> Iterable[str]:
        target = f"out->{c_name(field.name)}"
        name = self.local(field)
        if field.kind == "text":
            yield from (f"{target}[{index}] = (char)bytes[{byte}];" for index, byte in self.source.characters(field))
            return
        kind = self.source.member_type(field)
        if field.kind == "flag":
            bit = self.source.bit(field) if self._is_plain_flag(field) else name
            yield f"{target} = ({bit} {'==' if field.active_low else '!='} 0U);"
        elif field.signed:
            yield f"{target} = ({kind}){self.maker}_signed({name}, {self.source.bits_text(field)});"
        elif field.zero_means:
            yield f"{target} = ({kind})(({name} == 0U) ? {number(field.zero_means)} : {name});"
        else:
            yield f"{target} = {name};" if kind == self.source.raw(field)[0] else f"{target} = ({kind}){name};"
