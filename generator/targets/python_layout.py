"""From a layout to the lines of its Python class: attributes, checks, ``decode`` and ``encode``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Digits, Field, Join, Layout, Piece, Register
from .python_source import WIDTH, Block, Call, Code, attribute, bare, chain, docstring, expression, grouped, literal, operand, quoted, sentence
from .python_views import Attribute, Check, Codec, Joined, JoinPart

if TYPE_CHECKING:
    from .python_module import Module

#: Names that the generated classes, and in them the methods, use for themselves.
CLASS_NAMES = ("bit_fields", "cls", "count", "decode", "encode", "index", "is_as_documented", "limits", "self", "variant")
LOCAL_NAMES = ("body", "cls", "computed", "data", "number", "remainder", "variant", "word")

#: The longest frame whose CRC is written out as one XOR of bytes.
_UNROLLED = 16


class CodecBuilder:
    """Builds the Python of one layout."""

    def __init__(self, module: Module, layout: Layout, name: str, doc: tuple[str, list[Block]], register: Register | None) -> None:
        self.module = module
        self.layout = layout
        self.name = name
        self.doc = doc
        self.register = register
        self.in_bytes = layout.carried_as == "bytes"
        self.order = "little" if layout.byte_order == "low_byte_first" else "big"
        self.bytes = layout.bits.constant // 8 if self.in_bytes else 0
        crc = layout.crc_field
        self.crc = module.device.crc(crc.crc) if crc is not None else None
        self.by_piece = self.in_bytes and all(item.pieces or item.padding_of or item.kind in ("crc", "text") for item in layout.fields)
        self.by_piece = self.by_piece and not layout.gray_when and all(item.pieces for item in layout.fields if item.kind == "text")
        self.containers = {item.padding_of: item for item in layout.fields if item.padding_of} if self.by_piece else {}
        self.source = "data" if self.by_piece else "number" if self.in_bytes else "word"
        limits = [item for item in (register.min, register.max) if item is not None] if register is not None else []
        positions = [part for item in layout.fields for part in (item.low, item.width)]
        expected = [item.equals for item in layout.fields if isinstance(item.equals, Expression)]
        self.takes_variant = bool(layout.gray_when) or not all(item.is_constant for item in (layout.bits, *positions, *limits, *expected))
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
        length_error = f'{self._text(layout.bits)}, word.bit_length(), "bits"' if not self.in_bytes else f"{self.bytes}, len(data)"
        crc_setup, crc_check = self._crc_check()
        setup = (f'number = int.from_bytes(data, "{self.order}")',) if self.source == "number" else ()
        limits = self._limits()
        lines = (*encode_checks, *terms, finish)
        gray = self._gray()
        plain_word = finish == "return number" and gray is None
        if finish.startswith("return number.to_bytes") and len(terms) == 1 and gray is None:
            terms, finish, plain_word = [finish.replace("return number", operand(terms[0]) if "(" not in terms[0] else terms[0])], "", True
        listed = [("variant", "The encoder that the frame belongs to.")] if self.takes_variant and self.register is None else []
        listed += [("variant", "The encoder that the register belongs to.")] if self.takes_variant and self.register is not None else []
        summary, blocks = self.doc
        doc = docstring(summary, *blocks, ("Attributes", [*listed, *((item.name, item.meaning) for item in attributes)]), indent=4)
        return Codec(
            layout=layout,
            name=self.name,
            doc=doc,
            source="data" if self.in_bytes else "word",
            source_type="bytes" if self.in_bytes else "int",
            source_doc=self._source_doc(),
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
            encode_variant=gray is not None or any(re.search(r"(?<!self\.)\bvariant\b", line) for line in lines),
            bit_fields=tuple(
                literal(Call("BitField", (("", item.name), ("", self._code(item.low)), ("", self._code(item.width)))), 12, 12, 1) for item in layout.fields
            ),
            limits=limits,
            limits_doc=docstring(f"Lowest and highest value of ``{self.register.limits_of}`` that may be written.", indent=8) if limits and self.register else "",
            raises=tuple(self._raises()),
        )

    # --------------------------------------------------------------------------------------------------------------- expressions

    def _text(self, value: Expression, owner: str = "variant") -> str:
        return grouped(value.constant) if value.is_constant else expression(value, self.module.parameter_names, owner)

    def _code(self, value: Expression) -> int | Code:
        return value.constant if value.is_constant else Code(self._text(value))

    def _attribute(self, name: str) -> str:
        return attribute(name, CLASS_NAMES)

    def _mask(self, width: Expression, owner: str = "variant") -> str:
        return f"0x{(1 << width.constant) - 1:X}" if width.is_constant else f"((1 << {operand(self._text(width, owner))}) - 1)"

    def _raw(self, item: Field) -> str:
        """The expression for the bits of a field; with padding in bytes, for the whole container."""
        if self.by_piece and item.pieces:
            return from_pieces(item.pieces, self.bytes)
        shifted = self.source if item.low == Expression(0) else f"{self.source} >> {operand(self._text(item.low))}"
        return shifted if item.low + item.width == self.layout.bits else f"{shifted} & {self._mask(item.width)}"

    def _bit(self, item: Field) -> str:
        """The expression that is not 0 when the bit is set."""
        if self.by_piece and item.pieces:
            piece = item.pieces[0]
            return f"data[{piece.byte}] & 0x{1 << piece.right:02X}"
        if item.low.is_constant:
            return f"{self.source} & 0x{1 << item.low.constant:02X}"
        return f"{self.source} >> {operand(self._text(item.low))} & 1"

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
                condition = f"{_compared(raw)} != {expected}" if item.constant else raw
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
        self.checks.append(Check(f"{_compared(raw)} != ({computed})", f'ConstantError("{item.name}", {raw}, {computed})'))

    def _data(self, item: Field, ranges: list[Check], late: list[str]) -> Iterable[Attribute]:
        name, local, raw = self._attribute(item.name), attribute(item.name, LOCAL_NAMES), self._raw(item)
        meaning = _meaning(item, any(item.width.value(variant.parameters) == 0 for variant in self.module.device.variants))
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
                yield Attribute(self._attribute(run.name), "int", _digits(local, run, run is item.digits[0]), sentence(run.meaning or f"{run.digits} digits"))
        elif item.kind == "text":
            yield Attribute(name, "str", self._characters(item, raw), meaning)
        elif item.signed:
            yield Attribute(name, "int", f"signed({raw}, {self._text(item.width)})", meaning)
        elif item.zero_means:
            yield Attribute(name, "int", f"{_compared(raw)} or {grouped(item.zero_means)}", meaning)
        else:
            yield Attribute(name, "int", raw, meaning)

    def _selector(self, item: Field, name: str, local: str, raw: str, meaning: str, ranges: list[Check]) -> Iterable[Attribute]:
        selects = self.layout.selects
        listed = ", ".join(f"{value:X}h" for value in selects)
        if len(selects) == 1:
            ranges.append(Check(f"{_compared(raw)} != {number_text(selects[0])}", f'RangeError("{item.name}", {raw}, "{listed}")'))
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
            return f"The {what} in ``data``, its bytes {order}."
        return f"The {what} in ``word``, whose first bit sent is the most significant."

    def _raises(self) -> Iterable[tuple[str, str]]:
        yield "LengthError", f"There are too {'many or too few bytes' if self.in_bytes else 'many bits'}."
        if self.crc is not None:
            yield "CrcError", "The CRC does not belong to the other bits."
        if any("ConstantError" in item.error for item in self.checks):
            yield "ConstantError", "Bits that always hold the same value, or a parity bit, hold another."
        if any("RangeError" in item.error for item in self.checks) or any("choice(" in line for line in self.locals):
            yield "RangeError", "A field holds a value without meaning."

    def _expected(self, value: Expression | int | str | None) -> str:
        if isinstance(value, Expression):
            return operand(self._text(value, "self.variant"))
        return quoted(value) if isinstance(value, str) else str(value)

    # -------------------------------------------------------------------------------------------------------------------- encode

    def _encode_checks(self) -> list[str]:
        lines = []
        for item in self.layout.fields:
            name = self._attribute(item.name)
            if not item.carries_data or item.kind in ("flag", "text"):
                continue
            if item.name == self.layout.selector:
                if len(self.layout.selects) > 1:
                    listed = ", ".join(f"{value:X}h" for value in self.layout.selects)
                    lines.append(f"if self.{name} not in ({', '.join(map(number_text, self.layout.selects))}):")
                    lines.append(f'    raise RangeError("{item.name}", int(self.{name}), "one of {listed}")')
            elif item.kind == "choice":
                lines.append(f'choice({self.module.enum_for(item, self.layout.name)}, "{item.name}", self.{name})')
            elif item.kind == "digits":
                for run in item.digits:
                    lines.append(f'check_limits("{run.name}", self.{self._attribute(run.name)}, (0, {grouped(run.modulus - 1)}))')
            elif item.signed:
                lines.append(f'check_signed("{item.name}", self.{name}, {self._text(item.width)})')
            elif not item.zero_means:
                lines.append(f'check_width("{item.name}", self.{name}, {self._text(item.width)})')
            if item.power_of_two:
                lines.append(f'check_power_of_two("{item.name}", self.{name})')
        if self.register is not None and (self.register.min is not None or self.register.max is not None):
            bounded = self._bounded(self.register)
            if bounded:
                arguments = "variant" if self.takes_variant else ""
                lines.append(f'check_limits("{self.register.limits_of}", self.{bounded}, self.limits({arguments}))')
        return lines

    def _bounded(self, register: Register) -> str:
        """The attribute that the limits bound."""
        names = [item.name for item in self.layout.data_fields] + [item.name for item in self.layout.joins]
        if register.limits_of in names:
            return self._attribute(register.limits_of)
        return self._attribute(self.layout.data_fields[0].name) if len(self.layout.data_fields) == 1 else ""

    def _limits(self) -> tuple[str, str] | None:
        register = self.register
        if register is None or (register.min is None and register.max is None):
            return None
        join = next((item for item in self.layout.joins if item.name == register.limits_of), None)
        names = join.fields if join is not None else (register.limits_of,)
        widths = [item.width for item in self.layout.fields if item.name in names]
        total = sum(widths, Expression(0)) if widths else self.layout.bits
        low = self._text(register.min) if register.min is not None else "0"
        return low, self._text(register.max) if register.max is not None else f"(1 << {operand(self._text(total))}) - 1"

    def _terms(self) -> tuple[list[str], str, str]:
        """The parts that OR together to the number, how it is finished, and what it is called before."""
        cut = self.crc.width if self.crc is not None and self.in_bytes and self.order == "big" else 0
        constants = sum(
            (item.constant or 0) << (item.low.constant - cut) for item in self.layout.fields if item.kind == "constant" and item.low.is_constant
        )
        if self.layout.selector and len(self.layout.selects) == 1:
            constants |= self._fixed(cut)
        terms = [f"0x{constants:X}"] if constants else []
        for item in self.layout.fields:
            term = self._term(item)
            if term:
                terms.append(moved_left(term, self._text(item.low - Expression(cut))))
        if self.crc is None:
            if not self.in_bytes:
                return terms, "return number", "number"
            return terms, f'return number.to_bytes({self.bytes}, "{self.order}")', "number"
        if self.in_bytes:
            size = self.crc.width // 8
            made = f'{self.module.crc_names[self.crc.name]}(body).to_bytes({size}, "{self.order}")'
            return terms, f"return body + {made}", f'body = number.to_bytes({self.bytes - size}, "{self.order}")'
        if self.layout.fold:
            inverted = f" ^ 0x{self.crc.xorout:02X}" if self.crc.xorout else ""
            return terms, f"return number | {self.module.fold_name(self.crc, self.layout)}(number){inverted}", "number"
        bits = self._text(self.layout.bits - Expression(self.crc.width))
        return terms, f"return number | {self.module.bits_function(self.crc)}(number >> {self.crc.width}, {bits})", "number"

    def _fixed(self, cut: int) -> int:
        """The bits of a selector that has one value only, and of its parity."""
        selector = self.layout.field(self.layout.selector)
        value = self.layout.selects[0]
        number = value << (selector.low.constant - cut)
        for item in self.layout.fields:
            if item.kind == "parity" and item.parity_of == selector.name:
                number |= (value.bit_count() & 1) << (item.low.constant - cut)
        return number

    def _term(self, item: Field) -> str:
        name = f"self.{self._attribute(item.name)}"
        fixed = self.layout.selector if len(self.layout.selects) == 1 else ""
        if fixed and fixed in (item.name, item.parity_of):
            return ""
        if item.kind == "constant":
            return f"0x{item.constant:X}" if item.constant and not item.low.is_constant else ""
        if item.kind == "crc":
            return ""
        if item.kind == "parity":
            return f"(self.{self._attribute(item.parity_of)}.bit_count() & 1)"
        if item.kind == "flag":
            return f"(not {name})" if item.active_low else f"bool({name})"
        if item.kind == "digits":
            return f"({' + '.join(_times(f'self.{self._attribute(run.name)}', run.divisor) for run in item.digits)})"
        if item.kind == "text":
            return f'text_number("{item.name}", {name}, {item.width.constant // 8})'
        if item.signed:
            return f"({name} & {self._mask(item.width)})"
        if item.zero_means:
            return f'zero_for("{item.name}", {name}, {grouped(item.zero_means)}, {self._text(item.width)})'
        return name

    # ------------------------------------------------------------------------------------------------------------- joins and more

    def _join(self, join: Join, attributes: Sequence[Attribute]) -> Joined:
        fields = [self.layout.field(name) for name in join.fields]
        terms: list[str] = []
        parts: list[JoinPart] = []
        below = Expression(0)
        name = self._attribute(join.name)
        for item in reversed(fields):
            terms.insert(0, moved_left(f"self.{self._attribute(item.name)}", self._text(below, "self.variant")))
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
        return Joined(name, doc, " | ".join(terms), self._text(below), signature, tuple(parts), others)

    def _gray(self) -> tuple[str, str, str] | None:
        """When a part is sent in Gray code, its place, and what it stands in."""
        if not self.layout.gray_when:
            return None
        join = next((item for item in self.layout.joins if item.name == self.layout.gray_of), None)
        fields = [self.layout.field(name) for name in (join.fields if join is not None else (self.layout.gray_of,))]
        width = sum((item.width for item in fields), Expression(0))
        name = self.module.parameter_names[self.layout.gray_when]
        return f"variant.{name}", f"{self._text(fields[-1].low)}, {self._text(width)}", self.source

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
                value = " + ".join(_times(f"self.{self._attribute(run.name)}", run.divisor) for run in item.digits)
                yield self._attribute(item.name), "int", docstring(f"The digits of {runs}, as one number.", indent=8), value

    def _documented(self) -> Iterable[tuple[str, str, str, str]]:
        expected = [item for item in self.layout.fields if item.equals is not None]
        if expected:
            listed = ", ".join(f"{item.name} {item.equals.render() if isinstance(item.equals, Expression) else repr(item.equals)}" for item in expected)
            value = " and ".join(f"self.{self._attribute(item.name)} == {self._expected(item.equals)}" for item in expected)
            yield "is_as_documented", "bool", docstring(f"Whether it holds what the manual says: {listed}.", indent=8), value


def _note(item: Field) -> str:
    """What a reader should know of a field that is not there for everybody, or that others explain."""
    texts = ["Not implemented." if not item.implemented else "", f"Reserved for the {item.reserved}." if item.reserved else ""]
    texts.append(f"0 on the wire stands for {item.zero_means}." if item.zero_means else "")
    texts.append("Only powers of two." if item.power_of_two else "")
    texts.append(f"Explained by {', '.join(item.explained_by)}." if item.explained_by else "")
    return " ".join(filter(None, texts))


def _with_defaults(attributes: Sequence[Attribute]) -> list[Attribute]:
    """The attributes; flags at the end are false unless given."""
    made: list[Attribute] = []
    for item in reversed(attributes):
        trailing = all(other.default for other in made)
        made.insert(0, Attribute(item.name, item.type, item.value, item.meaning, "False") if trailing and item.type == "bool" else item)
    return made


def _meaning(item: Field, may_be_missing: bool) -> str:
    texts = []
    if item.kind == "flag":
        texts.append(f"True: {item.when_active or 'active'}; False: {item.when_inactive or 'not active'}; {'low' if item.active_low else 'high'} active")
        texts.append(item.meaning)
    else:
        unit = f" ({item.unit})" if item.unit and item.unit not in item.meaning else ""
        texts.append(f"{(item.meaning or item.printed_name or item.name.replace('_', ' ')).rstrip('.')}{unit}")
    if may_be_missing:
        texts.append("0 where the encoder has none")
    texts += [_note(item), item.note]
    return " ".join(sentence(text) for text in texts if text)


def from_pieces(pieces: Sequence[Piece], length: int = 0) -> str:
    """The number that the pieces make."""
    whole = all(piece.right == 0 and piece.mask == 0xFF for piece in pieces)
    places = [piece.byte for piece in pieces]
    if whole and len(pieces) > 3:
        if places == list(range(places[0], places[0] + len(places))):
            return _int_from(places[0], places[-1], length, "little")
        if places == list(range(places[0], places[0] - len(places), -1)):
            return _int_from(places[-1], places[0], length, "big")
    return " | ".join(map(_from_piece, pieces if places[0] <= places[-1] else reversed(pieces)))


def _int_from(first: int, last: int, length: int, order: str) -> str:
    part = "data" if first == 0 and last == length - 1 else f"data[{first}:{last + 1}]"
    return f'int.from_bytes({part}, "{order}")'


def _from_piece(piece: Piece) -> str:
    text = f"data[{piece.byte}]"
    if piece.right:
        text += f" >> {piece.right}"
    if piece.mask << piece.right & 0xFF != 0xFF >> piece.right << piece.right:
        text += f" & 0x{piece.mask:X}"
    if not piece.left:
        return text
    return f"{text} << {piece.left}" if text.endswith("]") else f"({text}) << {piece.left}"


def _compared(raw: str) -> str:
    """``raw`` in parentheses where a reader might not be sure that it is taken before a comparison."""
    return f"({raw})" if " " in raw else raw


def _digits(local: str, run: Digits, first: bool) -> str:
    text = local if run.divisor == 1 else f"{local} // {grouped(run.divisor)}"
    return text if first else f"{text} % {grouped(run.modulus)}"


def _times(value: str, factor: int) -> str:
    return value if factor == 1 else f"{value} * {grouped(factor)}"


def moved_left(term: str, low: str) -> str:
    return term if low == "0" else f"{term} << {operand(low)}"


def number_text(value: int) -> str:
    return str(value) if value < 10 else f"0x{value:X}"


def among(value: str, values: Sequence[int]) -> str:
    return f"{value} == {number_text(values[0])}" if len(values) == 1 else f"{value} in ({', '.join(map(number_text, values))})"
