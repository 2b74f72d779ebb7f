"""From a layout to the lines of ``encode``: checks, the number that the fields make, and how it is finished."""

from __future__ import annotations

from collections.abc import Iterable

from ..expressions import Expression
from ..model import Field, Register, RegisterMeaning
from .python_expressions import LOCAL_NAMES, LayoutText, meaning_limits, moved_left, number_text, times
from .python_source import attribute, docstring, grouped, operand


def depends_on_variant(meaning: RegisterMeaning) -> bool:
    """Whether the limits of one meaning of a register differ with the order code."""
    return any(item is not None and not item.is_constant for item in (meaning.min, meaning.max))


class EncodeText(LayoutText):
    """The lines of ``encode`` for one layout."""

    def _encode_checks(self) -> list[str]:
        lines = []
        for item in self.layout.fields:
            name, local = self._attribute(item.name), self._local(item)
            if not item.carries_data or item.kind in ("flag", "text"):
                continue
            if item.name == self.layout.selector:
                if len(self.layout.selects) > 1:
                    listed = ", ".join(f"{value:X}h" for value in self.layout.selects)
                    lines.append(f'{local} = whole_number("{item.name}", self.{name})')
                    lines.append(f"if {local} not in ({', '.join(map(number_text, self.layout.selects))}):")
                    lines.append(f'    raise RangeError("{item.name}", {local}, "one of {listed}")')
            elif item.kind == "choice":
                enum = self.module.enum_for(item, self.layout.name)
                lines.append(f'{local} = choice({enum}, "{item.name}", self.{name})')
            elif item.kind == "digits":
                for run in item.digits:
                    lines.append(f'check_limits("{run.name}", self.{self._attribute(run.name)}, (0, {grouped(run.modulus - 1)}))')
            elif item.signed:
                lines.append(f'{local} = check_signed("{item.name}", self.{name}, {self._text(item.width)})')
            elif item.zero_means:
                width = self._text(item.width)
                lines.append(f'{local} = zero_for("{item.name}", self.{name}, {grouped(item.zero_means)}, {width})')
            else:
                lines.append(f'{local} = check_width("{item.name}", self.{name}, {self._text(item.width)})')
            if item.power_of_two:
                lines.append(f'check_power_of_two("{item.name}", self.{name})')
        if self.register is not None and (self.register.min is not None or self.register.max is not None):
            bounded = self._bounded(self.register)
            if bounded:
                arguments = "variant" if self.takes_variant else ""
                lines.append(f'check_limits("{self.register.limits_of}", self.{bounded}, self.limits({arguments}))')
        return lines

    @property
    def _local_names(self) -> tuple[str, ...]:
        """What ``decode`` and ``encode`` use for themselves, the functions of CRCs among them."""
        crcs = self.module.crc_names.values()
        return (*LOCAL_NAMES, *crcs, *(f"{name}_of_bits" for name in crcs))

    def _local(self, item: Field) -> str:
        """The variable in ``encode`` that holds the checked bits of a field."""
        return attribute(item.name, self._local_names)

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
        lowest, highest = "0", f"(1 << {operand(self._text(total))}) - 1"
        if join is None and any(item.signed for item in self.layout.fields if item.name in names):
            half = f"(1 << {operand(self._text(total - Expression(1)))})"
            lowest, highest = f"-{half}", f"{half} - 1"
        return self._text(register.min) if register.min is not None else lowest, self._text(register.max) if register.max is not None else highest

    def _meaning_limits(self) -> Iterable[tuple[str, str, str, str, str]]:
        """By meaning of the register: the name of the function, its argument, docstring, lowest and highest value."""
        for item in self.register.meanings if self.register is not None else ():
            if item.min is None and item.max is None:
                continue
            low = self._text(item.min) if item.min is not None else "0"
            high = self._text(item.max) if item.max is not None else f"(1 << {operand(self._text(self.layout.bits))}) - 1"
            doc = docstring(f"Lowest and highest value while the register is the {item.name.replace('_', ' ')}.", indent=8)
            yield meaning_limits(item), "variant: Variant" if depends_on_variant(item) else "", doc, low, high

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
            of = self.layout.field(item.parity_of)
            value = f"index(self.{self._attribute(of.name)})" if of.kind == "flag" else self._local(of)
            return f"({value}.bit_count() & 1)"
        if item.kind == "flag":
            return f"(not {name})" if item.active_low else f"bool({name})"
        if item.kind == "digits":
            return f"({self._digits(item)})"
        if item.kind == "text":
            return f'text_number("{item.name}", {name}, {item.width.constant // 8})'
        local = self._local(item)
        return f"({local} & {self._mask(item.width)})" if item.signed else local

    def _gray(self) -> tuple[str, str, str] | None:
        """When a part is sent in Gray code, its place, and what it stands in."""
        if not self.layout.gray_when:
            return None
        join = next((item for item in self.layout.joins if item.name == self.layout.gray_of), None)
        fields = [self.layout.field(name) for name in (join.fields if join is not None else (self.layout.gray_of,))]
        width = sum((item.width for item in fields), Expression(0))
        name = self.module.parameter_names[self.layout.gray_when]
        return f"variant.{name}", f"{self._text(fields[-1].low)}, {self._text(width)}", self.source
