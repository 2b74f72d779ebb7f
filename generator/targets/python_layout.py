"""From a layout to the lines of its Python class: attributes, checks, ``decode`` and ``encode``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Field, Join, Layout, Register
from ..words import sentence
from .python_encode import EncodeText
from .python_expressions import BITS, compared, digits_of, meaning_of, moved_left, number_text, times
from .python_source import WIDTH, Block, Call, attribute, bare, chain, docstring, grouped, literal, operand, quoted, receiver, used_names
from .python_views import Attribute, Check, Codec, Joined, JoinPart

if TYPE_CHECKING:
    from .python_module import Module

#: The longest frame whose CRC is written out as one XOR of bytes.
_UNROLLED = 16



class CodecBuilder(EncodeText):
    """Builds the Python of one layout."""

    def __init__(
        self,
        module: Module,
        layout: Layout,
        name: str,
        doc: tuple[str, list[Block]],
        interface: str,
        register: Register | None,
    ) -> None:
        super().__init__(module, layout, name, doc, interface, register)
        self.checks: list[Check] = []
        self.locals: list[str] = []

    def build(self) -> Codec:
        layout = self.layout
        attributes = self._attributes()
        properties = [*self._fixed_selector(), *self._wholes(), *self._documented()]
        joins = tuple(self._join(item, attributes) for item in layout.joins)
        encode_checks = self._encode_checks()
        terms, finish, body = self._terms()
        length = f"word >> {operand(self._text(layout.bits))}" if not self.in_bytes else f"len(data) != {self.bytes}"
        length_error = f"LengthError({self.bytes}, len(data))" if self.in_bytes else f"too_long(word, {self._text(layout.bits)})"
        crc_setup, crc_check = self._crc_check()
        setup = (f'number = int.from_bytes(data, "{self.order}")',) if self.source == "number" else ()
        limits = self._limits()
        lines = (*encode_checks, *terms, finish)
        gray = self._gray()
        plain_word = finish == "return number" and gray is None
        if finish.startswith("return number.to_bytes") and len(terms) == 1 and gray is None:
            terms, finish, plain_word = [finish.replace("return number", receiver(terms[0]))], "", True
        listed = [("variant", "The encoder that the frame belongs to.")] if self.takes_variant and self.register is None else []
        listed += [("variant", "The encoder that the register belongs to.")] if self.takes_variant and self.register is not None else []
        summary, blocks = self.doc
        doc = docstring(summary, *blocks, ("Attributes", [*listed, *((item.name, item.meaning) for item in attributes)]), indent=4)
        return Codec(
            layout=layout,
            name=self.name,
            doc=doc,
            interface=self.interface,
            source="data" if self.in_bytes else "word",
            source_type="bytes" if self.in_bytes else "int",
            source_doc=self._source_doc(),
            arguments=", ".join(self._decode_arguments()),
            bits=self._text(layout.bits),
            takes_variant=self.takes_variant,
            attributes=tuple(attributes),
            properties=tuple(properties),
            joins=joins,
            length=length,
            length_error=length_error,
            setup=setup,
            crc=crc_check,
            crc_setup=crc_setup,
            checks=tuple(self.checks),
            locals=tuple(self.locals),
            encode_checks=tuple(encode_checks),
            gray=gray,
            number=chain("return " if plain_word else "number = ", [bare(terms[0])] if len(terms) == 1 else terms, 8),
            finish="" if plain_word else finish,
            body=body,
            encode_variant=gray is not None or any("variant" in used_names(line.replace("self.variant", "")) for line in lines),
            bit_fields=tuple(
                literal(Call("BitField", (("", item.name), ("", self._code(item.low)), ("", self._code(item.width)))), 12, 12, 1) for item in layout.fields
            ),
            limits=limits,
            meaning_limits=tuple(self._meaning_limits()),
            limits_doc=docstring(f"Lowest and highest value of ``{self.register.limits_of}`` that may be written.", indent=8) if limits and self.register else "",
        )

    # -------------------------------------------------------------------------------------------------------------------- decode

    def _attributes(self) -> list[Attribute]:
        """The attributes, and on the way every check of ``decode``: constants and parity first, as the model orders faults."""
        ranges: list[Check] = []
        late: list[str] = []
        found: list[Attribute] = []
        for item in self.layout.fields:
            if item.kind == "constant" and not (item.padding_of in self.containers and self.by_piece):
                raw = self._raw(item)
                expected = f"0x{item.constant:X}" if item.constant else "0"
                condition = f"{compared(raw)} != {expected}" if item.constant else raw
                self.checks.append(Check(condition, f'ConstantError("{item.name}", {raw}, {expected})'))
            elif item.kind == "parity":
                self._check_parity(item)
            elif item.carries_data:
                found += self._data(item, ranges, late)
        self.checks += ranges
        self.locals += late
        return _with_defaults(found)

    def _check_parity(self, item: Field) -> None:
        of = self.layout.field(item.parity_of)
        computed = f"({self._raw(of)}).bit_count() & 1"
        raw = self._raw(item)
        self.checks.append(Check(f"{compared(raw)} != ({computed})", f'ConstantError("{item.name}", {raw}, {computed})'))

    def _data(self, item: Field, ranges: list[Check], late: list[str]) -> Iterable[Attribute]:
        name, local, raw = self._attribute(item.name), attribute(item.name, self._local_names), self._raw(item)
        meaning = meaning_of(item, any(item.width.value(variant.parameters) == 0 for variant in self.module.device.variants))
        if item.name in self.containers:
            padding = self.containers[item.name]
            width = operand(self._text(item.width))
            condition = f"({local} := {raw}) >> {width}"
            self.checks.append(Check(condition, f'ConstantError("{padding.name}", {local} >> {width}, 0)'))
            raw = local
        if item.name == self.layout.selector:
            yield from self._selector(item, name, local, raw, meaning, ranges)
        elif item.kind == "flag":
            yield Attribute(name, "bool", f"not {self._bit(item)}" if item.active_low else f"bool({self._bit(item)})", meaning)
        elif item.kind == "choice":
            enum = self.module.enum_for(item, self.layout.name)
            late.append(f'{local} = choice({enum}, "{item.name}", {raw})')
            yield Attribute(name, enum, local, meaning)
        elif item.kind == "digits":
            largest = item.digits[0].divisor * item.digits[0].modulus
            ranges.append(Check(f"({local} := {raw}) >= {grouped(largest)}", f'RangeError("{item.name}", {local}, "at most {largest - 1}")'))
            for run in item.digits:
                yield Attribute(self._attribute(run.name), "int", digits_of(local, run, run is item.digits[0]), sentence(run.meaning or f"{run.digits} digits"))
        elif item.kind == "text":
            yield Attribute(name, "str", self._characters(item, raw), meaning)
        elif item.signed:
            yield Attribute(name, "int", f"signed({raw}, {self._text(item.width)})", meaning)
        elif item.zero_means:
            yield Attribute(name, "int", f"{compared(raw)} or {grouped(item.zero_means)}", meaning)
        else:
            yield Attribute(name, "int", raw, meaning, usual=self._usual(item))

    def _usual(self, item: Field) -> str:
        """The number that the manual states for a field of a frame; empty where it states none."""
        return number_text(item.equals) if self.register is None and isinstance(item.equals, int) else ""

    def _selector(self, item: Field, name: str, local: str, raw: str, meaning: str, ranges: list[Check]) -> Iterable[Attribute]:
        selects = self.layout.selects
        listed = ", ".join(f"{value:X}h" for value in selects)
        if len(selects) == 1:
            ranges.append(Check(f"{compared(raw)} != {number_text(selects[0])}", f'RangeError("{item.name}", {raw}, "{listed}")'))
            if item.values:
                self.module.enum_for(item, self.layout.name)
            return
        condition = f"({local} := {raw}) not in ({', '.join(map(number_text, selects))})"
        ranges.append(Check(condition, f'RangeError("{item.name}", {local}, "one of {listed}")'))
        if item.values:
            enum = self.module.enum_for(item, self.layout.name)
            yield Attribute(name, enum, f"{enum}({local})", meaning)
        else:
            yield Attribute(name, "int", local, meaning)

    def _characters(self, item: Field, raw: str) -> str:
        size = item.width.constant // 8
        if self.by_piece and all(piece.right == 0 and piece.mask == 0xFF for piece in item.pieces):
            places = [piece.byte for piece in reversed(item.pieces)]
            if places == list(range(places[0], places[0] + size)):
                return f'data[{places[0]}:{places[0] + size}].decode("ascii", "replace")'
        return f'({raw}).to_bytes({size}, "big").decode("ascii", "replace")'

    def _crc_check(self) -> tuple[str, Check | None]:
        crc, item = self.crc, self.layout.crc_field
        if crc is None or item is None:
            return "", None
        mask = f"0x{crc.mask:02X}"
        if not self.in_bytes and self.layout.fold:
            whole = f"word ^ 0x{crc.xorout:02X}" if crc.xorout else "word"
            fold = self.module.fold_name(crc, self.layout)
            return "", Check(f"remainder := {fold}({whole})", f"CrcError(word & {mask}, (word & {mask}) ^ remainder)")
        if not self.in_bytes:
            bits = self.layout.bits - Expression(crc.width)
            function = self.module.bits_function(crc)
            return f"computed = {function}(word >> {crc.width}, {self._text(bits)})", Check(f"computed != (word & {mask})", f"CrcError(word & {mask}, computed)")
        size = crc.width // 8
        before = self.bytes - size
        if crc.form == "xor" and before <= _UNROLLED:
            made = " ^ ".join(f"data[{index}]" for index in range(before)) + (f" ^ 0x{crc.xorout:02X}" if crc.xorout else "")
        else:
            made = f"{self.module.crc_names[crc.name]}(data[:{before}])"
        received = f"data[{before}]" if size == 1 else f'int.from_bytes(data[{before}:], "{self.order}")'
        return f"computed = {made}", Check(f"computed != {received}", f"CrcError({received}, computed)")

    def _source_doc(self) -> str:
        what = "register" if self.register is not None else "frame"
        if self.in_bytes:
            order = "in ascending order of address" if self.register is not None else "in the order in which they are sent"
            return docstring(f"The {what} in ``data``, its bytes {order}.", ("Raises", list(self._raises())), indent=8)
        given = f"The {what} in ``word``: a number whose most significant bit was sent first, or text of 0 and 1."
        return docstring(given, ("Args", [BITS]), ("Raises", list(self._raises())), indent=8)

    def _decode_arguments(self) -> Iterable[str]:
        yield "data: Data" if self.in_bytes else "word: Word"
        if self.takes_variant:
            yield "variant: Variant"
        if not self.in_bytes:
            yield "*, bits: int | None = None"

    def _raises(self) -> Iterable[tuple[str, str]]:
        yield "LengthError", f"There are too many or too few {'bytes' if self.in_bytes else 'bits'}."
        if self.crc is not None:
            yield "CrcError", "The CRC does not belong to the other bits."
        if any("ConstantError" in item.error for item in self.checks):
            yield "ConstantError", "Bits that always hold the same value, or a parity bit, hold another."
        if any("RangeError" in item.error for item in self.checks) or any("choice(" in line for line in self.locals):
            yield "RangeError", "A field holds a value without meaning."
        if self.takes_variant:
            yield "FamilyError", "The encoder is of another family."
            yield "InterfaceError", "The encoder has another interface."

    def _expected(self, value: Expression | int | str | None) -> str:
        if isinstance(value, Expression):
            return operand(self._text(value, "self.variant"))
        return quoted(value) if isinstance(value, str) else number_text(value or 0)

    # ------------------------------------------------------------------------------------------------------------- joins and more

    def _join(self, join: Join, attributes: Sequence[Attribute]) -> Joined:
        fields = [self.layout.field(name) for name in join.fields]
        terms: list[str] = []
        parts: list[JoinPart] = []
        below = Expression(0)
        name = self._attribute(join.name)
        for item in reversed(fields):
            terms.insert(0, moved_left(f"index(self.{self._attribute(item.name)})", self._text(below)))
            shifted = name if below == Expression(0) else f"{name} >> {operand(self._text(below))}"
            value = shifted if item is fields[0] else f"{shifted} & {self._mask(item.width)}"
            parts.insert(0, JoinPart(self._attribute(item.name), value))
            below = below + item.width
        names = {part.name for part in parts}
        listed = " and ".join(f"``{part.name}``" for part in parts)
        doc = docstring(f"{listed} as one number, ``{parts[0].name}`` most significant." if len(parts) > 1 else f"The same as {listed}.", indent=8)
        others = tuple(_with_defaults([item for item in attributes if item.name not in names]))
        arguments = ["variant: Variant"] if self.takes_variant else []
        arguments += [f"{name}: int", *(f"{item.name}: {item.type}{' = ' + item.default if item.default else ''}" for item in others)]
        signature = f"    def from_{name}(cls, {', '.join(arguments)}) -> {self.name}:"
        if len(signature) > WIDTH:
            signature = f"    def from_{name}(\n        cls,\n" + "".join(f"        {item},\n" for item in arguments) + f"    ) -> {self.name}:"
        uses_variant = any("variant" in used_names(term) for term in terms)
        return Joined(name, doc, " | ".join(terms), self._text(below), signature, tuple(parts), others, uses_variant)

    def _fixed_selector(self) -> Iterable[tuple[str, str, str, str]]:
        if self.layout.selector and len(self.layout.selects) == 1:
            item = self.layout.field(self.layout.selector)
            named = next((value for value in item.values if value.value == self.layout.selects[0]), None)
            doc = docstring(sentence(item.meaning or item.printed_name or item.name), indent=8)
            if named is not None:
                enum = self.module.enum_for(item, self.layout.name)
                yield self._attribute(item.name), enum, doc, f"{enum}.{named.name.upper()}"
            else:
                yield self._attribute(item.name), "int", doc, number_text(self.layout.selects[0])

    def _wholes(self) -> Iterable[tuple[str, str, str, str]]:
        """Numbers that are read as runs of digits, as a whole."""
        for item in self.layout.fields:
            if item.kind == "digits" and item.name not in {run.name for run in item.digits}:
                runs = ", ".join(f"``{self._attribute(run.name)}``" for run in item.digits)
                doc = docstring(f"The digits of {runs}, as one number.", indent=8)
                yield self._attribute(item.name), "int", doc, self._digits(item)

    def _documented(self) -> Iterable[tuple[str, str, str, str]]:
        expected = [item for item in self.layout.fields if item.equals is not None]
        if expected:
            listed = ", ".join(f"{item.name} {_stated(item.equals)}" for item in expected)
            value = " and ".join(f"self.{self._attribute(item.name)} == {self._expected(item.equals)}" for item in expected)
            yield "is_as_documented", "bool", docstring(f"Whether it holds what the manual says: {listed}.", indent=8), value


def _stated(value: Expression | int | str | None) -> str:
    """What the manual states for a field, in words."""
    if isinstance(value, Expression):
        return value.render()
    return number_text(value) if isinstance(value, int) else repr(value)


def _with_defaults(attributes: Sequence[Attribute]) -> list[Attribute]:
    """The attributes; at the end, flags are false and others have the value that the manual states, unless given."""
    made: list[Attribute] = []
    for item in reversed(attributes):
        usual = "False" if item.type == "bool" else item.usual
        made.insert(0, replace(item, default=usual if all(other.default for other in made) else ""))
    return made
