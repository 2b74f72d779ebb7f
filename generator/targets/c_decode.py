"""The body of a decoder: locals that hold the bits of the fields, the faults it looks for, and how the members are filled."""

from __future__ import annotations

from collections.abc import Iterable

from ..expressions import Expression
from ..model import Field
from .c_layout import LayoutSource
from .c_source import c_name, mask, number, unsigned
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
            if field.kind in ("constant", "crc", "text"):
                continue
            kind, expression = self.source.raw(field)
            yield f"const {kind} {self.local(field)} = {expression};"

    # -- faults

    def checks(self) -> Iterable[Check]:
        crc_field = self.layout.crc_field
        if crc_field is not None:
            yield Check(self._crc_condition(crc_field), "CRC")
        yield from self._constants_in_word() if self.source.by_word else self._constants_in_bytes()
        for field in self.layout.fields:
            if field.kind == "parity":
                yield Check(f"{self.local(field)} != {self._parity(field)}", "CONSTANT", f"even parity of {field.parity_of}")
        for field in self.layout.fields:
            condition = self.source.choice_condition(field, self.local(field))
            if condition:
                yield Check(condition, "RANGE")
            if field.digits:
                limit = field.digits[0].divisor * field.digits[0].modulus
                yield Check(f"{self.local(field)} > {number(limit - 1)}", "RANGE", f"{sum(run.digits for run in field.digits)} digits")

    def _crc_condition(self, field: Field) -> str:
        crc = self.source.device.crc(field.crc)
        if self.layout.carried_as == "bits":
            if self.source.folds:
                return f"{self.source.name}_crc(word) != 0U"
            covered = f"word >> {crc.width}U, {self.scope.text(self.layout.bits - Expression(crc.width))}"
            return f"{self.view.crc_name(crc, 'bits')}({covered}) != (word & {mask(crc.width)})"
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
                yield Check(f"{self.local(padded)} > {self.source.width(padded)}", "CONSTANT", f"bits above {padded.name} are always 0")
                continue
            for piece in field.pieces:
                bits, value, names = by_byte.get(piece.byte, (0, 0, []))
                part = field.constant >> piece.left & piece.mask
                by_byte[piece.byte] = (bits | piece.mask << piece.right, value | part << piece.right, [*names, field.name.replace("_", " ")])
        for byte, (bits, value, names) in sorted(by_byte.items()):
            found = f"bytes[{byte}]" if bits == 0xFF else f"(bytes[{byte}] & {number(bits, True)})"
            yield Check(f"{found} != {number(value, True)}", "CONSTANT", ", ".join(dict.fromkeys(names)))

    def _parity(self, field: Field) -> str:
        of = self.layout.field(field.parity_of)
        name = self.local(of)
        if of.widest > 32:
            return f"{self.maker}_parity((uint32_t){name} ^ (uint32_t)({name} >> 32U))"
        return f"{self.maker}_parity({name})"

    # -- members

    def fills(self) -> Iterable[str]:
        for field in self.source.member_fields:
            yield from self._fill(field)
            name = self.local(field)
            for run in field.digits:
                divided = f"{name} / {number(run.divisor)}" if run.divisor > 1 else name
                whole = divided if run is field.digits[0] else f"{divided} % {number(run.modulus)}"
                yield f"out->{c_name(run.name)} = ({unsigned((run.modulus - 1).bit_length())})({whole});"
        for join in self.layout.joins:
            yield f"out->{c_name(join.name)} = {self.source.joined(join, self.local)};"
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
            yield f"{target} = ({name} {'==' if field.active_low else '!='} 0U);"
        elif field.signed:
            yield f"{target} = ({kind}){self.maker}_signed({name}, {self.source.bits_text(field)});"
        elif field.zero_means:
            yield f"{target} = ({kind})(({name} == 0U) ? {number(field.zero_means)} : {name});"
        else:
            yield f"{target} = {name};" if kind == self.source.raw(field)[0] else f"{target} = ({kind}){name};"
