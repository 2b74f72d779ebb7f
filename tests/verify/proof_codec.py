"""Proofs of a decoder and an encoder: a plain reference written from the layout of the model, bit by bit, and the claims that the header is equal to it.

Nothing here looks at how the C target reads or writes a field; from the header come only the names and types of the struct members.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field as attribute
from functools import cached_property

from codewheel.expressions import Expression
from codewheel.limits import bounded
from codewheel.model import Crc, Device, Field, Join, Layout, Register

from proof import PRELUDE, UNDEFINED, Header, Member, Proof, Variants, in_c

#: The documented order of faults.
LENGTH, CRC, CONSTANT, RANGE = 1, 2, 3, 4


def function(name: str, *lines: str) -> str:
    return f"void {name}(void)\n{{\n    any_variant();\n" + "".join(f"    {line.strip()}\n" if line.strip() else "" for line in lines) + "}\n"


def claim(condition: str, words: str) -> str:
    return f'__CPROVER_assert({condition}, "{words}");'


@dataclass(frozen=True)
class Item:
    """A member that users see: a field of the layout, a run of digits, or a join. ``value`` is what the reference says that it is."""

    name: str
    member: Member
    type: str
    value: str
    characters: int = 0

    def same(self, struct: str, expected: str) -> str:
        if self.type == "digits":
            return "1"  # division is beyond the checker: proof_digits.py goes through all numbers
        if self.characters:
            parts = (f"(unsigned char){struct}.{self.member.name}[{at}] == (unsigned char)({expected} >> {8 * (self.characters - 1 - at)})" for at in range(self.characters))
            return "(" + " && ".join(parts) + ")"
        return f"(({self.type}){struct}.{self.member.name} == {expected})"


@dataclass(frozen=True)
class CodecProof:
    """All proofs of one layout. ``name`` is the struct's name in C."""

    device: Device
    interface: str
    layout: Layout
    header: Header
    prefix: str
    name: str
    register: Register | None = None
    held: Mapping[str, int] = attribute(default_factory=dict)

    # -- the layout

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        fixed = self.layout.selector if len(self.layout.selects) == 1 else ""
        return tuple(item for item in self.layout.data_fields if item.name != fixed)

    @cached_property
    def variants(self) -> Variants:
        limits = [item for item in (self.register.min, self.register.max) if item is not None] if self.register is not None else []
        equals = [item.equals for item in self.layout.fields if isinstance(item.equals, Expression)]
        expressions = [self.layout.bits, *(part for item in self.layout.fields for part in (item.low, item.width)), *limits, *equals]
        used = dict.fromkeys(name for item in expressions for name in item.parameters)
        return Variants.of(self.device, self.interface, [*used, *([self.layout.gray_when] if self.layout.gray_when else [])]).fixed(self.held)

    @property
    def by_word(self) -> bool:
        return self.layout.carried_as == "bits"

    @property
    def size(self) -> int:
        """Bytes of a layout that is carried as bytes."""
        assert self.layout.bits.is_constant and self.layout.bits.constant % 8 == 0
        return self.layout.bits.constant // 8

    @property
    def has_digits(self) -> bool:
        return any(field.digits for field in self.fields)

    @property
    def crc(self) -> Crc | None:
        return self.device.crc(self.layout.crc_field.crc) if self.layout.crc_field is not None else None

    def join_width(self, join: Join) -> Expression:
        return sum((self.layout.field(name).width for name in join.fields), Expression(0))

    @cached_property
    def items(self) -> tuple[Item, ...]:
        items: list[Item] = []
        for field in self.fields:
            raw = f"r_{field.name}"
            member = self.header.member(self.name, field.name)
            if field.kind == "text":
                items.append(Item(field.name, member, "number", raw, field.widest // 8))
            elif field.kind == "flag":
                items.append(Item(field.name, member, "unsigned", f"({raw} {'==' if field.active_low else '!='} 0)"))
            elif field.signed:
                items.append(Item(field.name, member, "long long", f"signed_number({raw}, {in_c(field.width)})"))
            else:
                value = f"({raw} == 0 ? (number){field.zero_means} : {raw})" if field.zero_means else raw
                items.append(Item(field.name, member, "number", value))
            items += [Item(run.name, self.header.member(self.name, run.name), "digits", field.name) for run in field.digits]
        for join in self.layout.joins:
            items.append(Item(join.name, self.header.member(self.name, join.name), "number", f"r_{join.name}"))
        return tuple(items)

    def check_members(self) -> None:
        """The struct has the members that the layout tells and no others."""
        found = {item.name for item in self.header.structs[self.name]} - {"no_data"}
        expected = {item.member.name for item in self.items}
        assert found == expected, f"{self.name}: members {sorted(found ^ expected)}"
        counts = {item.member.name: item.member.count for item in self.items}
        assert all(counts[item.member.name] == item.characters for item in self.items), f"{self.name}: characters"

    # -- the reference

    def reference(self) -> str:
        layout = self.layout
        names = [*(item.name for item in layout.fields), *(join.name for join in layout.joins)]
        lines = [f"static number r_{name};" for name in names]
        lines += ["static number received(number word, long long low, long long width)", "{", "    number value = 0;"]
        lines += [f"    for (int i = 0; i < {layout.widest}; i++) if (i < width) value |= ((word >> low) & ((number)1 << i));", "    return value;", "}"]
        if any(item.signed for item in layout.fields):
            lines += ["static long long signed_number(number raw, long long width)", "{"]
            lines += ["    return (raw >> (width - 1)) & 1 ? (long long)raw - (1LL << width) : (long long)raw;", "}"]
        lines += self._plain()
        if self.crc is not None:
            lines += self._crc(self.crc)
        lines += ["static int check(number word)", "{", "    number plain = out_of_gray(word);"]
        for field in layout.fields:
            lines.append(f"    r_{field.name} = received({'word' if field.kind == 'parity' else 'plain'}, {in_c(field.low)}, {in_c(field.width)});")
        for join in layout.joins:
            joined = "0"
            for name in join.fields:
                joined = f"(({joined}) << {in_c(layout.field(name).width)} | r_{name})" if joined != "0" else f"r_{name}"
            lines.append(f"    r_{join.name} = {joined};")
        for fault, conditions in ((CONSTANT, self._constants()), (RANGE, self._ranges())):
            lines += [f"    if ({condition}) return {fault};" for condition in conditions]
        lines += ["    return 0;", "}", "static number uncovered(number word)", "{"]
        lines += [f"    word &= ~(received(~(number)0, 0, {in_c(field.width)}) << {in_c(field.low)});" for field in layout.fields]
        lines += [f"    return received(word, 0, {in_c(layout.bits)});", "}"]
        lines += ["static int reference(number word)", "{"]
        lines += [f"    if (word >> {in_c(layout.bits)}) return {LENGTH};"] if self.by_word else []
        lines += [f"    if (crc_of(word) != received(word, {in_c(layout.crc_field.low)}, {in_c(layout.crc_field.width)})) return {CRC};"] if layout.crc_field else []
        return "\n".join([*lines, "    return check(word);", "}", ""])

    def _plain(self) -> Iterator[str]:
        """The word with the part that is in Gray code, if any, in binary: every bit is the sum of the bits from the top of the number down to it."""
        yield from ("static number out_of_gray(number word)", "{")
        if self.layout.gray_of:
            join = next((item for item in self.layout.joins if item.name == self.layout.gray_of), Join("", (self.layout.gray_of,)))
            low, high = in_c(self.layout.field(join.fields[-1]).low), in_c(self.layout.field(join.fields[-1]).low + self.join_width(join))
            yield from (f"    if (p_{self.layout.gray_when} != 0) {{", "        number sum = 0;", f"        for (int i = {self.layout.widest - 1}; i >= 0; i--)")
            yield from (f"            if (i >= {low} && i < {high}) {{", "                sum ^= (word >> i) & 1;")
            yield from ("                word = (word & ~((number)1 << i)) | (sum << i);", "            }", "    }")
        yield from ("    return word;", "}")

    def _crc(self, crc: Crc) -> Iterator[str]:
        """The shift register of the definition, fed with everything that was sent before the CRC, in the order of sending."""
        yield from ("static number crc_of(number word)", "{", f"    unsigned long long shift_register = {crc.init}ULL;")
        if self.by_word:
            yield f"    for (int i = {self.layout.widest - 1}; i >= {crc.width}; i--) {{"
            yield f"        if (i >= {in_c(self.layout.bits)}) continue;" if crc.init else "        /* zeros before the word leave a register of zeros as it is */"
            bit = "(word >> i) & 1"
        else:
            yield f"    for (int i = 0; i < {8 * self.size - crc.width}; i++) {{"
            byte = "i / 8" if self.layout.byte_order == "low_byte_first" else f"{self.size - 1} - i / 8"
            bit = f"(word >> (8 * ({byte}) + ({'i % 8' if crc.refin else '7 - i % 8'}))) & 1"
        yield f"        unsigned long long feedback = ((shift_register >> {crc.width - 1}) ^ (unsigned long long)({bit})) & 1;"
        yield f"        shift_register = (shift_register << 1) & {crc.mask}ULL;"
        yield f"        for (int k = 0; k < {crc.width}; k++) shift_register ^= (({crc.poly}ULL >> k) & feedback) << k;"
        yield "    }"
        if crc.refout:
            yield f"    unsigned long long turned = 0;\n    for (int k = 0; k < {crc.width}; k++) turned |= ((shift_register >> k) & 1) << ({crc.width - 1} - k);"
            yield "    shift_register = turned;"
        yield from (f"    return shift_register ^ {crc.xorout}ULL;", "}")

    def _constants(self) -> Iterator[str]:
        for field in self.layout.fields:
            if field.kind == "constant":
                yield f"{in_c(field.width)} > 0 && r_{field.name} != {field.constant}ULL"
            if field.kind == "parity":
                of = self.layout.field(field.parity_of)
                yield f"r_{field.name} != ({' ^ '.join(f'((r_{of.name} >> {bit}) & 1)' for bit in range(of.widest))})"

    def _ranges(self) -> Iterator[str]:
        for field in self.layout.fields:
            allowed = self.layout.selects if field.name == self.layout.selector else [item.value for item in field.values] if field.kind == "choice" else ()
            if allowed:
                yield " && ".join(f"r_{field.name} != {value}" for value in allowed)
            if field.digits:
                yield f"r_{field.name} >= {10 ** sum(run.digits for run in field.digits)}ULL"

    # -- which values an encoder has to take

    def valid(self) -> Iterator[str]:
        for field in self.fields:
            yield from self._valid_field(field)
        for join in self.layout.joins:
            joined = "0"
            for name in join.fields:
                joined = f"(({joined}) << {in_c(self.layout.field(name).width)} | {self._given(name)})"
            yield f"{self._given(join.name)} == {joined}"
        yield from self.limits(self._given)

    def _given(self, name: str) -> str:
        return f"((number)in.{self.header.member(self.name, name).name})"

    def _valid_field(self, field: Field) -> Iterator[str]:
        given, width = self._given(field.name), in_c(field.width)
        if field.kind in ("flag", "text"):
            return
        if field.signed:
            member = f"(long long)in.{self.header.member(self.name, field.name).name}"
            yield f"{member} >= -(1LL << ({width} - 1)) && {member} <= (1LL << ({width} - 1)) - 1"
            return
        fits = f"({given} >> {width}) == 0"
        yield f"(({given} != 0 && {fits}) || {given} == {field.zero_means})" if field.zero_means else fits
        allowed = self.layout.selects if field.name == self.layout.selector else [item.value for item in field.values] if field.kind == "choice" else ()
        if allowed:
            yield " || ".join(f"{given} == {value}" for value in allowed)
        if field.power_of_two:
            yield " || ".join(f"{given} == {1 << bit}ULL" for bit in range(field.widest))
        for run in field.digits:
            yield f"{self._given(run.name)} < {run.modulus}"
        if field.digits:
            yield f"{given} == {' + '.join(f'{self._given(run.name)} * {run.divisor}' for run in field.digits)}"

    def limits(self, given: Callable[[str], str]) -> Iterator[str]:
        """The limits of a register, which bound what is written and not what is read."""
        name = bounded(self.register) if self.register is not None else ""
        if self.register is None or not name:
            return
        if self.register.min is not None and not (self.register.min.is_constant and self.register.min.constant <= 0):
            yield f"{given(name)} >= {in_c(self.register.min)}"
        if self.register.max is not None:
            yield f"{given(name)} <= {in_c(self.register.max)}"

    # -- the claims

    def harness(self) -> str:
        self.check_members()
        bits = max(self.layout.widest, 64) + 8
        result = self.prefix.partition("_")[0] + "_result"
        wire = "unsigned long long wire = nondet_word();" if self.by_word else "\n    ".join([f"uint8_t wire[{self.size}];", *(f"wire[{at}] = nondet_byte();" for at in range(self.size))])
        order = range(self.size) if not self.by_word and self.layout.byte_order == "low_byte_first" else range(self.size - 1, -1, -1) if not self.by_word else ()
        number_of = "(number)wire" if self.by_word else " | ".join(f"((number)wire[{at}] << {8 * place})" for place, at in enumerate(order))
        passed = "wire" if self.by_word else f"wire, {self.size}"
        sent = "&wire" if self.by_word else f"wire, {self.size}"
        out, given = self.header.anything(self.name, "out"), self.header.anything(self.name, "in")
        expected = [item.same("out", f"({item.type})({item.value})") for item in self.items]
        unchanged = [f"out.{item.name}{at} == before.{item.name}{at}" for item in self.header.structs[self.name] for at in ([f"[{index}]" for index in range(item.count)] or [""])]
        equal_in = [f"out.{item.member.name}{at} == in.{item.member.name}{at}" for item in self.items if item.type != "digits" for at in ([f"[{index}]" for index in range(item.characters)] or [""])]
        equal_reference = [item.same("in", f"({item.type})({item.value})") for item in self.items]
        valid = " && ".join(f"({item})" for item in self.valid()) or "1"
        writable = [f"({item})" for item in self.limits(lambda name: f"((number)out.{self.header.member(self.name, name).name})")]
        writable += [f"({' || '.join(f'(number)out.{self.header.member(self.name, field.name).name} == {1 << bit}ULL' for bit in range(field.widest))})" for field in self.fields if field.power_of_two]
        before_wire = "unsigned long long before = wire;" if self.by_word else f"uint8_t before[{self.size}]; for (int i = 0; i < {self.size}; i++) before[i] = wire[i];"
        same_wire = "wire == before" if self.by_word else " && ".join(f"wire[{at}] == before[{at}]" for at in range(self.size))
        again = "unsigned long long again = nondet_word();" if self.by_word else f"uint8_t again[{self.size}];"
        again_passed = "&again" if self.by_word else f"again, {self.size}"
        again_number = number_of.replace("wire", "again")

        every = " && ".join
        text = f'#include "{self.prefix.replace("_", "/", 1)}.h"\n{PRELUDE}typedef unsigned __CPROVER_bitvector[{bits}] number;\n'
        text += self.variants.declare(self.prefix, self.header) + self.reference()
        decoded = (out, wire, f"{self.name} before = out;", f"{result} found = {self.name}_decode(&variant, {passed}, &out);")
        text += function("decode_result", *decoded, claim(f"(int)found == reference({number_of})", "same result as the reference"))
        text += function(
            "decode_members", *decoded, f"(void)check({number_of});",
            f"if (found == 0) {{ {' '.join(claim(item, 'same member as the reference') for item in expected)} }}",
            f"else {{ {claim(every(unchanged), 'a fault leaves the result as it was')} }}",
        )
        encoded = (given, wire, before_wire, f"{result} found = {self.name}_encode(&variant, &in, {sent});")
        text += function(
            "encode_members", *encoded, claim(f"(int)found == (({valid}) ? 0 : {RANGE})", "takes exactly the values in range"),
            f"if (found != 0) {{ {claim(same_wire, 'a fault leaves the result as it was')} return; }}",
            claim(f"check({number_of}) == 0", "constants, parity and choices as the layout has them"),
            claim(f"({number_of}) >> {in_c(self.layout.bits)} == 0", "as many bits as the layout has") if self.by_word else "",
            claim(f"uncovered({number_of}) == 0", "bits without a field are 0"),
            *(claim(item, "the reference reads the member back") for item in equal_reference),
        )
        text += function(
            "decode_of_encode", *encoded, "if (found != 0) return;", out, f"found = {self.name}_decode(&variant, {passed}, &out);",
            claim("found == 0", "what was encoded can be decoded"), *(claim(item, "decode(encode(x)) = x") for item in equal_in),
        )
        text += function(
            "encode_of_decode", *decoded, "if (found != 0) return;", again, f"found = {self.name}_encode(&variant, &out, {again_passed});",
            claim("1" if self.has_digits else f"(found == 0) == ({every(writable) or '1'})", "what was decoded can be encoded"),
            claim(f"found != 0 || {again_number} == (({number_of}) & ~uncovered({number_of}))", "encode(decode(f)) = f"),
        )
        if self.crc is not None and self.layout.crc_field is not None:
            place = f"{in_c(self.layout.crc_field.low)}, {in_c(self.layout.crc_field.width)}"
            text += function("encode_crc", *encoded, claim(f"found != 0 || crc_of({number_of}) == received({number_of}, {place})", "the CRC of the definition"))
        text += self._length(out, given) + self._setters(result) + self._expected()
        calls = [name for name in ("decode_members", "encode_members", "length", *self._set_names(), *self._expected_names()) if f"void {name}(void)" in text]
        if self.crc is None:
            calls += ["decode_result", "decode_of_encode", "encode_of_decode"]
        return text + "void everything(void)\n{\n" + "".join(f"    {name}();\n" for name in calls) + "}\n"

    def _length(self, out: str, given: str) -> str:
        if self.by_word:
            return ""
        unchanged = " && ".join(f"out.{item.name} == before.{item.name}" for item in self.header.structs[self.name] if not item.count) or "1"
        return function(
            "length", out, f"{self.name} before = out;", "size_t length = nondet_size();", f"__CPROVER_assume(length != {self.size});", "uint8_t none[1];",
            claim(f"{self.name}_decode(&variant, none, length, &out) == {LENGTH} && {unchanged}", "another length is refused before a byte is read"),
            given, claim(f"{self.name}_encode(&variant, &in, none, length) == {LENGTH}", "another length is refused before a byte is written"),
        )

    def _set_names(self) -> list[str]:
        return [f"set_{item}" for item in (*(join.name for join in self.layout.joins), *(field.name for field in self.fields if field.digits))]

    def _setters(self, result: str) -> str:
        """A number and its parts: the setter takes exactly the numbers that fit, and the parts are those that the reference would read."""
        text = ""
        parts: list[tuple[str, str, Sequence[tuple[str, str]]]] = []
        for join in self.layout.joins:
            offset, found = Expression(0), []
            for name in reversed(join.fields):
                found.append((name, f"received(given, {in_c(offset)}, {in_c(self.layout.field(name).width)})"))
                offset += self.layout.field(name).width
            parts.append((join.name, f"((number)given >> {in_c(offset)}) == 0", found))
        for field in self.fields:
            if field.digits:
                parts.append((field.name, f"given < {10 ** sum(run.digits for run in field.digits)}ULL", [(run.name, "") for run in field.digits]))
        for name, fits, pieces in parts:
            whole = self.header.member(self.name, name)
            touched = {whole.name, *(self.header.member(self.name, part).name for part, _ in pieces)}
            others = [f"out.{item.name} == before.{item.name}" for item in self.header.structs[self.name] if item.name not in touched and not item.count] or ["1"]
            same = [f"out.{item.name} == before.{item.name}" for item in self.header.structs[self.name] if item.name in touched]
            equal = [f"out.{whole.name} == given", *(f"(number)out.{self.header.member(self.name, part).name} == {value}" for part, value in pieces if value)]
            text += function(
                f"set_{name}", self.header.anything(self.name, "out"), f"{self.name} before = out;", f"{whole.type} given = ({whole.type})nondet_word();",
                f"{result} found = {self.name}_set_{name}(&variant, given, &out);", claim(f"(int)found == (({fits}) ? 0 : {RANGE})", "takes exactly the numbers that fit"),
                claim(" && ".join(others), "sets nothing else"), claim(f"found != 0 || ({' && '.join(equal)})", "sets the number and its parts"),
                claim(f"found == 0 || ({' && '.join(same)})", "a fault leaves the result as it was"),
            )
        return text

    def _expected_names(self) -> list[str]:
        return ["expected"] if f"{self.name}_is_expected" in self.header.functions else []

    def _expected(self) -> str:
        if not self._expected_names():
            return ""
        conditions: list[str] = []
        for field in self.fields:
            member = self.header.member(self.name, field.name).name
            if isinstance(field.equals, str):
                conditions += [f"(unsigned char)in.{member}[{at}] == {byte}" for at, byte in enumerate(field.equals.encode("ascii"))]
            elif isinstance(field.equals, Expression):
                conditions.append(f"(number)in.{member} == {in_c(field.equals)}")
            elif field.equals is not None:
                conditions.append(f"(number)in.{member} == {field.equals}")
        test = f"{self.name}_is_expected(&variant, &in) == ({' && '.join(conditions)})"
        return function("expected", self.header.anything(self.name, "in"), claim(test, "reads as the manual states"))

    @property
    def functions(self) -> Iterator[str]:
        """The functions that are proved here."""
        yield from (f"{self.name}_{item}" for item in ("decode", "encode", *self._set_names()))
        if self._expected_names():
            yield f"{self.name}_is_expected"

    def proofs(self) -> Iterable[Proof]:
        text, covers = self.harness(), self.variants.count
        state = "".join(f", {name} {value}" for name, value in self.held.items())
        unwind = max(66, self.layout.widest + 2)
        yield Proof(f"{self.name} everything{state}", text, "everything", unwind, tuple(UNDEFINED), covers)
        if self.crc is not None:
            for entry in ("decode_result", "encode_crc", "decode_of_encode", "encode_of_decode"):
                yield Proof(f"{self.name} {entry}{state}", text, entry, unwind, ("--no-standard-checks",), covers)
            for option in self.header.options:
                for entry in ("decode_result", "encode_crc"):
                    yield Proof(f"{self.name} {entry} with {option}{state}", text, entry, unwind, (f"-D{option}", *UNDEFINED), covers)
