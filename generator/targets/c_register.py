"""One register in C: its constants, the places of its fields, its limits, and the codec of its bytes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from ..expressions import Expression
from ..model import Field, Register, RegisterMeaning, cite
from ..words import sentence
from .c_access import access
from .c_codec import codec
from .c_layout import LayoutSource
from .c_source import Paragraph, addresses, bracketed, errata_at, errata_text, needs_variant, number, signed_number, span_text, title, unbracketed, unsigned, words
from .c_views import Function, Limits, Line, Mask, MeaningView, RegisterView

if TYPE_CHECKING:
    from .c_device import DeviceView


class RegisterSource:
    def __init__(self, view: DeviceView, register: Register) -> None:
        self.view = view
        self.device = view.device
        self.scope = view.scope
        self.register = register
        self.layout = register.layout
        self.name = f"{view.prefix}_reg_{register.name}"
        self.stem = self.name.upper()
        #: Whether the byte itself says all, so that it needs no struct.
        self.is_plain = register.length == 1 and len(self.layout.fields) == 1 and not self.layout.joins and _is_byte(self.layout.fields[0])
        self.source = LayoutSource(view, self.layout, self.name, f"{self.stem}_LENGTH", register)

    def build(self) -> RegisterView:
        macros, limits = tuple(self._macros()), self.limits()
        about = list(self._about())
        if self.is_plain and self.layout.fields[0].kind == "number":
            about.append(sentence(self.source.about(self.layout.fields[0])))
        masks = () if self.is_plain else tuple(self._masks())
        if not self.is_plain and len([mask for mask in masks if not mask.variable]) < len(self.layout.fields):
            about += self.source.table()
        about += [errata_text(item) for item in errata_at(self.device, f"registers.{self.register.name}")]
        struct = codec(self.source, (), self.limited_member, limits) if not self.is_plain else None
        return RegisterView(
            about=tuple(about),
            macros=macros,
            masks=masks,
            limits=limits,
            meanings=tuple(MeaningView(tuple(self._meaning(item)), self.limits(item)) for item in self.register.meanings),
            choices=self.view.choices_of_register(self.register),
            explained=tuple(self._explained()),
            codec=struct,
            access=access(self.view, self.register, self.source, struct, limits),
        )

    def _macros(self) -> Iterable[Line]:
        register, macro = self.register, self.view.macro
        yield macro(f"{self.stem}_ADDRESS", number(register.address, True))
        yield macro(f"{self.stem}_LENGTH", number(register.length), f"bytes, {addresses(register)}" if register.length > 1 else "byte")
        yield macro(f"{self.stem}_ACCESS", f"{self.view.maker.name.upper()}_ACCESS_{register.access.upper()}")
        if register.default is not None:
            yield macro(f"{self.stem}_DEFAULT", number(register.default, True, 2 * min(register.length, 8)), "value as delivered")
        equals = self.layout.fields[0].equals if self.is_plain else None
        if isinstance(equals, int):
            yield macro(f"{self.stem}_EXPECTED", number(equals, True), "what the manual states for it")
        if register.wait_at_least_ms is not None:
            yield macro(f"{self.stem}_WAIT_AT_LEAST_MS", number(register.wait_at_least_ms), "after a write, before the next command")

    def _about(self) -> Iterable[Paragraph]:
        register = self.register
        access = register.access.replace("_", " ").replace("read write", "read and write")
        yield f"{title(register)}{self._elsewhere()}, {addresses(register)}, {access}, over {self.device.interface(register.interface).title} [{cite(register.source)}]."
        yield sentence(register.meaning)
        if register.length > 1:
            yield "The lowest address holds the low byte." if register.byte_order == "low_byte_first" else "The lowest address holds the high byte."
        yield from self._rules()
        yield sentence(register.note)

    def _rules(self) -> Iterable[Paragraph]:
        """What reading and writing the register is subject to."""
        register = self.register
        twin = next((item for item in self.device.registers if item is not register and (item.address, item.bank) == (register.address, register.bank)), None)
        if twin is not None:
            yield f"The same address is another register when {'read' if register.access == 'write_only' else 'written'}: {title(twin)}."
        if register.bank is not None:
            yield f"In bank {register.bank}, which {self.device.interface(register.interface).bank_select or 'the master'} selects."
        if register.reserved:
            yield f"Reserved to the {'manufacturer' if register.reserved == 'maker' else register.reserved}."
        if register.opened_by:
            yield self._opened_by()
        if register.clears_itself:
            yield "Goes back to its default by itself after a write."
        if register.volatile:
            yield "To be kept over power-off, a written value has to be saved."
        if register.above_max:
            yield f"A value above the greatest is taken as the {register.above_max}."
        if register.write_clears:
            yield f"A write clears {' and '.join(self._title(name) for name in register.write_clears)}."

    def _elsewhere(self) -> str:
        """The names of the register in the manual's editions."""
        names = "; ".join(f"{language}: {name}" for language, name in self.register.names.items() if name != title(self.register))
        return f" ({names})" if names else ""

    def _title(self, name: str) -> str:
        return title(self.device.register(name))

    def _opened_by(self) -> str:
        opener = self.device.register(self.register.opened_by)
        field = next((item for item in opener.layout.fields if item.name == self.register.opened_by_field), opener.layout.fields[0])
        value = next((item.value for item in field.values if item.name == self.register.opened_by_value), 0)
        meant = words(self.register.opened_by_value)
        if not self.register.opened_by_field:
            return f"Can be written only while {self._title(opener.name)} holds {value:0{2 * opener.length}X}h ({meant})."
        return f"Can be written only while {title(field)} of {self._title(opener.name)} is {value} ({meant})."

    def _meaning(self, meaning: RegisterMeaning) -> Iterable[Paragraph]:
        register, _, name = meaning.when.partition(".")
        field = self.device.register(register).layout.field(name)
        value = next((item.value for item in field.values if item.name == meaning.value), 0)
        yield f"As {words(meaning.name)}, while {title(field)} of {self._title(register)} is {value} [{cite(meaning.source)}]: {sentence(meaning.meaning)}"

    def _masks(self) -> Iterable[Mask]:
        if self.register.length > 8:
            return
        for field in self.layout.fields:
            if field.kind in ("constant", "text") or (len(self.layout.fields) == 1 and field.kind != "choice"):
                continue
            if field.low.is_constant and field.width.is_constant:
                stem = f"{self.name}_{field.name}".upper()
                bits = ((1 << field.width.constant) - 1) << field.low.constant
                # A flag is taken by its mask; a shift would be of no use.
                shift, mask = "" if field.kind == "flag" else self.view.unique(f"{stem}_SHIFT"), self.view.unique(f"{stem}_MASK")
                yield Mask(shift, mask, number(field.low.constant), number(bits, True), "", False, span_text(field.low, field.width))
            else:
                low = self.scope.text(field.low)
                place = f"{self.view.maker.name}_mask({self.scope.text(field.width)}) << {bracketed(low)}"
                shift, mask = self.view.unique(f"{self.name}_{field.name}_shift"), self.view.unique(f"{self.name}_{field.name}_mask")
                yield Mask(shift, mask, low, place, "uint64_t", True, span_text(field.low, field.width))

    def _explained(self) -> Iterable[Line]:
        """For each field that another register explains, the bits of that register."""
        for field in self.layout.fields:
            by_register: dict[str, int] = {}
            for name in field.explained_by:
                register, _, bit = name.partition(".")
                place = self.device.register(register).layout.field(bit)
                by_register[register] = by_register.get(register, 0) | ((1 << place.widest) - 1) << place.low.constant
            for register, bits in by_register.items():
                yield self.view.macro(f"{self.stem}_{field.name}_IN_{register}".upper(), number(bits, True), f"bits of {self._title(register)} that tell why")

    # -- limits

    @property
    def limited_member(self) -> str:
        """The member that the limits bound, or nothing where they bound the register as a whole."""
        names = {join.name for join in self.layout.joins} | {field.name for field in self.layout.fields}
        if self.register.limits_of in names:
            return self.register.limits_of
        return self.layout.fields[0].name if len(self.layout.fields) == 1 else ""

    def limits(self, meaning: RegisterMeaning | None = None) -> Limits:
        """The limits of the register, or of one of its meanings."""
        low, high = (self.register.min, self.register.max) if meaning is None else (meaning.min, meaning.max)
        stem = self.name if meaning is None else f"{self.name}_{meaning.name}"
        bounded = self.register.limits_of if meaning is None else words(meaning.name)
        macros, functions, texts = [], [], {"min": "", "max": ""}
        for side, expression in (("min", low), ("max", high)):
            if expression is None:
                continue
            if expression.is_constant:
                texts[side] = f"{stem}_{side}".upper()
                macros.append(Line(f"#define {texts[side]} {signed_number(expression.constant) if self._is_signed else number(expression.constant)}"))
            else:
                functions.append(self._limit_function(f"{stem}_{side}", f"{'Least' if side == 'min' else 'Greatest'} {bounded}", expression))
                texts[side] = f"{stem}_{side}(variant)"
        ranges = [(parameters, *self._range(parameters)) for parameters in self._parameters]
        binding_min = low is not None and any(low.value(parameters) > least for parameters, least, _ in ranges)
        binding_max = high is not None and any(high.value(parameters) < most for parameters, _, most in ranges)
        return Limits(texts["min"], texts["max"], tuple(macros), tuple(functions), binding_min, binding_max, low.constant if low is not None and low.is_constant else None)

    @property
    def _parameters(self) -> list[Mapping[str, int]]:
        """The parameters of each order code that has the register."""
        return [variant.parameters for variant in self.device.variants if variant.interface == self.register.interface]

    @property
    def _is_signed(self) -> bool:
        """Whether the limits bound a signed number."""
        return any(field.signed for field in self.layout.fields if field.name == self.limited_member)

    def _range(self, parameters: Mapping[str, int]) -> tuple[int, int]:
        """What the bits that the limits bound can hold."""
        name = self.limited_member
        width = self.layout.place(parameters).place_of(name)[1] if name else 8 * self.register.length
        return (-(1 << width - 1), (1 << width - 1) - 1) if self._is_signed else (0, (1 << width) - 1)

    def _limit_function(self, name: str, bounded: str, expression: Expression) -> Function:
        if self._is_signed:
            text = self.scope.signed_text(expression)
            return Function(name, "int64_t", "", (f"return {text};",), f"{bounded}: {expression.render()}.", needs_variant(text))
        largest = max((expression.value(parameters) for parameters in self._parameters), default=0)
        kind = unsigned(max(largest.bit_length(), 32))
        text = self.scope.text(expression)
        body = text if kind == "uint64_t" or not any(term.is_power for term in expression.terms) else f"({kind}){bracketed(text)}"
        return Function(name, kind, "", (f"return {unbracketed(body)};",), f"{bounded}: {expression.render()}.", needs_variant(body))


def _is_byte(field: Field) -> bool:
    """Whether a field is no more and no less than the number in a byte."""
    return field.kind in ("choice", "number") and field.width == Expression(8) and not (field.signed or field.zero_means or field.power_of_two)
