"""A libFuzzer target for a header: byte 0 of an input chooses the call, byte 1 the order code, the rest are arguments.

Every struct is decoded, encoded and decoded again. Every other function of the header is called with anything that its
types allow, by code generated from its declaration, so that none is forgotten. Buffers are on the heap and have exactly
the length that a function receives. Positions have 56 bits, which is more than any encoder has, because their value in
micrometres must fit.
"""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Iterable, Mapping
from itertools import islice
from pathlib import Path

from batch import Batch, Codec, member_format, on_the_wire
from c_harness import SHARED
from codewheel.model import PlacedLayout
from test_c_codec import valid_numbers
from uses import declared, without_texts

HERE = Path(__file__).resolve().parent

_STRUCT = re.compile(r"^typedef struct (\w+) \{(.*?)^\} \w+;", re.MULTILINE | re.DOTALL)
_TABLE = re.compile(r"^#ifdef \w+_CRC_TABLE\n(.*?)(?:^#else\n(.*?))?^#endif\n", re.MULTILINE | re.DOTALL)
_MEMBER = re.compile(r"^\s*(?:const )?([\w ]+?) ?(\*?)(\w+)(?:\[(\w+)\])?;", re.MULTILINE)
#: Names of arguments that state the length of the array before them.
_LENGTHS = ("length", "capacity", "count")
_NUMBERS = {
    "bool": 1,
    "char": 1,
    "uint8_t": 1,
    "int8_t": 1,
    "uint16_t": 2,
    "int16_t": 2,
    "uint32_t": 4,
    "int32_t": 4,
    "uint64_t": 8,
    "int64_t": 8,
    "size_t": 8,
    "double": 8,
}

#: Helpers of the runtime whose arguments must match each other, which the functions that call them ensure.
PRECONDITIONS = {
    "signed": "a value of no more than so many bits",
    "fits_signed": "1 to 64 bits",
    "run_together": "one step at least",
    "run_write": "1 to 8 steps of one register",
    "run_compare": "as run_write",
    "run_closing": "steps that run_fits accepts",
    "run_step": "as run_write",
    "step_change": "as many steps as bytes",
    "step_differs": "as step_change",
    "label_match": "a code of the table",
}


def folded(text: str) -> str:
    """Return the code of a header without CRCs by table, which a macro selects and the same frames on the host test."""
    return _TABLE.sub(lambda match: match[2] or "", without_texts(text))


def texts_of(batch: Batch, include: Path) -> list[str]:
    """Return the code of the included headers of the runtime and of the header of an interface."""
    paths = [include / "codewheel" / f"{name}.h" for name in SHARED if name != "receive"]  # has a target of its own
    paths += [include / header for header in batch.view.headers]
    return [folded(path.read_text(encoding="ascii")) for path in paths]


class Header:
    """Return the functions and structs that a header and its included headers of the runtime declare."""

    def __init__(self, batch: Batch, include: Path) -> None:
        self.prefix = batch.view.prefix
        texts = texts_of(batch, include)
        declarations = declared(texts)
        self.structs = {name: body for text in texts for name, body in _STRUCT.findall(text)}
        decoders = {f"{codec.view.name}_{verb}" for codec in batch.codecs for verb in ("decode",)}
        left_out = {f"cw_{name}" for name in PRECONDITIONS}
        self.functions = [function for function in declarations.functions if function[1] not in decoders | left_out]

    def calls(self) -> str:
        return "".join(self._call(*function) for function in self.functions)

    def _call(self, kind: str, name: str, argument_text: str) -> str:
        """Return a function that calls a function with arguments from the input."""
        before: list[str] = []
        passed: list[str] = []
        after: list[str] = []
        arguments = [] if argument_text == "void" else [self._split(text) for text in argument_text.split(", ")]
        for index, (type_, is_pointer, argument) in enumerate(arguments):
            _, next_is_pointer, next_argument = arguments[index + 1] if index + 1 < len(arguments) else ("", False, "")
            is_first = _shares_length(argument, next_argument)
            has_length = is_first or (next_argument in _LENGTHS and not next_is_pointer)
            if is_pointer:
                follows_first = index > 0 and _shares_length(arguments[index - 1][2], argument)
                count = f"n{index - 1}" if follows_first else "(size_t)(take(1U) % 24U)"
                declared, local, released = self._pointer(index, type_, count if has_length else "")
            elif argument in _LENGTHS and index and arguments[index - 1][1]:
                declared, local, released = "", f"n{index - 1}", ""
            else:
                declared, local, released = self._value(type_, argument, f"a{index}"), f"a{index}", ""
            before += [declared] if declared else []
            passed.append(local)
            after += [released] if released else []
        lines = "".join(f"    {line}\n" for line in (*before, f"(void){name}({', '.join(passed)});", *after))
        return f"\nstatic void call_{name}(const {self.prefix} *variant)\n{{\n    (void)variant;\n{lines}}}\n"

    def _value(self, type_: str, argument: str, local: str) -> str:
        """Return the declaration of an argument that is passed by value."""
        if type_ == self.prefix:
            return f"const {type_} {local} = *variant;"
        if type_ == "cw_word":
            return f"const {type_} {local} = {{ take(8U), (uint32_t)take(1U) }};"
        number = self._number(type_)
        if (type_, argument) == ("int64_t", "position"):
            number = "(int64_t)take(7U) - INT64_C(0x80000000000000)"
        return f"const {type_} {local} = {number};"

    def _pointer(self, index: int, type_: str, count: str) -> tuple[str, str, str]:
        """Return the declaration of an argument that is passed by address, what is passed, and its release.

        ``count`` is the number of elements, or empty for a single element.
        """
        local = f"a{index}"
        if type_ == "char":
            return f"char *const {local} = text();", local, f"free({local});"
        if type_.endswith("_transport"):
            return "", "fuzzed_transport()", ""
        if type_.endswith("_failure"):
            failure = f"{type_} f{index};\n    {type_} *const {local} = (take(1U) & 1U) != 0U ? &f{index} : NULL;"
            return failure, local, ""
        if count:
            return self._array(index, type_, count), local, f"free({local});"
        if type_ == self.prefix:
            return f"{type_} {local} = *variant;", f"&{local}", ""
        return f"{type_} {local};\n    {self._fill(type_, local)}", f"&{local}", ""

    def _array(self, index: int, type_: str, count: str) -> str:
        local = f"a{index}"
        return f"""const size_t n{index} = {count};
    {type_} *const {local} = malloc(n{index} * sizeof(*{local}) + (n{index} == 0U));
    {{
        size_t i;
        for (i = 0U; i < n{index}; i++) {{
            {self._fill(type_, f"{local}[i]")}
        }}
    }}"""

    @staticmethod
    def _split(argument: str) -> tuple[str, bool, str]:
        match = re.fullmatch(r"(?:const )?([\w ]+?) ?(\*?)(?:const )?(\w+)(?:\[\w*\])?", argument)
        assert match is not None, argument
        return match[1], bool(match[2]) or "[" in argument, match[3]

    def _number(self, type_: str) -> str:
        if type_ == "bool":
            return "(take(1U) & 1U) != 0U"
        return f"({type_})take({_NUMBERS.get(type_, 1)}U)"

    def _fill(self, type_: str, place: str) -> str:
        """Return statements that fill a value of this type from the input."""
        if type_ not in self.structs:
            return f"{place} = {self._number(type_)};"
        lines = [f"memset(&{place}, 0, sizeof({place}));"]
        for member, pointer, name, length in _MEMBER.findall(self.structs[type_]):
            if pointer:
                continue
            if type_.endswith("_step") and name == "times":
                lines.append(f"{place}.{name} = (uint16_t)(take(1U) % 16U);")
            elif length:
                array = f"{place}.{name}"
                lines.append(
                    f"{{ size_t j; for (j = 0U; j < sizeof({array}) / sizeof({array}[0]); j++) "
                    f"{{ {array}[j] = {self._number(member)}; }} }}"
                )
            else:
                lines.append(self._fill(member, f"{place}.{name}"))
        return " ".join(lines)


def _shares_length(argument: str, next_argument: str) -> bool:
    """Return True for the first of two buffers with the same length."""
    return (argument, next_argument) == ("first", "second")


def source(batch: Batch, include: Path) -> str:
    """Return the text of the target."""
    header = Header(batch, include)
    takers = "".join(_take(taker.name, taker.access.stem) for taker in batch.view.variant_updaters)
    values = {
        "prefix": header.prefix,
        "spelled": "1" if batch.device.order_code.also_written else "0",
        "calls": header.calls(),
        "takers": takers,
        "rows": ", ".join(f"call_{name}" for _, name, _ in header.functions),
        "exact": ", ".join(str(int(is_exact(batch, codec))) for codec in batch.codecs),
        "refuse": ", ".join(str(int(may_be_refused(batch, codec))) for codec in batch.codecs),
        "bools": ", ".join(f'"{_bool_bytes(codec)}"' for codec in batch.codecs),
        "bits": ", ".join(str(int(not codec.view.layout_plan.in_bytes)) for codec in batch.codecs),
    }
    shared = "".join(f'#include "codewheel/{name}.h"\n' for name in SHARED)
    return batch.source(shared + _replaced((HERE / "fuzz.c").read_text(encoding="utf-8"), values))


def _replaced(text: str, values: Mapping[str, str]) -> str:
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text


def _take(function: str, stem: str) -> str:
    return (
        "    { uint8_t held[8]; size_t i; for (i = 0U; i < 8U; i++) { held[i] = (uint8_t)take(1U); } "
        f"(void){function}(variant, held, {stem}_LENGTH); }}\n"
    )


def _bool_bytes(codec: Codec) -> str:
    """Return a digit for each byte of the members: 1 for a bool, otherwise 0."""
    digits = ""
    for member in codec.members:
        digits += "1" if member.type == "bool" else "0" * struct.calcsize(f"<{member_format(member)}")
    return digits


def is_exact(batch: Batch, codec: Codec) -> bool:
    """Return True if every bit belongs to a field for every order code, so that encoding restores a decoded frame."""
    variants = [variant for variant in batch.device.variants if variant.interface == codec.interface]
    layouts = [codec.layout.place(variant.parameters) for variant in variants]
    return all(_covered_bits(placed) == placed.bits for placed in layouts)


def _covered_bits(placed: PlacedLayout) -> int:
    return sum(field.width for field in placed.fields)


def may_be_refused(batch: Batch, codec: Codec) -> bool:
    """Return True if a valid value may be outside the limits for writing a register."""
    register = next((register for register in batch.device.registers if f"reg_{register.name}" == codec.name), None)
    powers = any(field.number.power_of_two for field in codec.layout.fields)
    return powers or (
        register is not None and (register.min is not None or register.max is not None or bool(register.meanings))
    )


def seeds(batch: Batch) -> Iterable[bytes]:
    """Return inputs to begin with: valid frames and members of each layout for its interface's order codes."""
    random_ = random.Random("seeds")
    for codec in batch.codecs:
        for index, variant in enumerate(batch.device.variants):
            if variant.interface == codec.interface:
                placed = codec.layout.place(variant.parameters)
                numbers = list(islice(valid_numbers(batch.device, placed, random_), 0, 60, 15))
                head = bytes([codec.number, index, 0])
                yield from (head + on_the_wire(codec.layout, number, placed.bits) for number in numbers)
    for index, variant in enumerate(batch.device.variants):
        yield bytes([0xFF, index, len(variant.code)]) + variant.code.encode("ascii")
