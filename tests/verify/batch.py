"""A C program that decodes and encodes by the million: binary in, binary out, for every struct of a header.

It reads chunks until its input ends, and answers each record with a record of a fixed size:

    operation, codec, count, variant     one byte; two and two bytes; eight bytes for each member of the variant, and
                                         for each answer to an open question of the manual
    count records                        of ``Batch.record`` bytes to be decoded, of ``Codec.size`` bytes to be encoded

A record to be decoded is a length and that many bytes, or eight bytes with a word. The answer is the result, the
members, and the result of encoding them again with the bytes or the word. The verdict follows in one byte, 255 without
a verdict, and the mask of reports in eight bytes. A record to be encoded consists of the members. The answer is a
result and the bytes or the word. Numbers are low byte first, words and frames as they are sent. On an error, everything
after the result is 0. The highest bit of the result is 1 if the struct has changed nevertheless.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from c_harness import Member, answers, codecs, included, members, short
from codewheel.model import Alternative, Choice, Device, Layout, PlacedLayout, Variant
from codewheel.targets.c.codec import StructCodec
from codewheel.targets.c.device import DeviceView
from codewheel.targets.c.names import c_name

HERE = Path(__file__).resolve().parent

DECODE, ENCODE = 0, 1

_FORMATS = {
    "bool": "?",
    "uint8_t": "B",
    "uint16_t": "H",
    "uint32_t": "I",
    "uint64_t": "Q",
    "int8_t": "b",
    "int16_t": "h",
    "int32_t": "i",
    "int64_t": "q",
}


def member_format(member: Member) -> str:
    """Type in which a member is written. An enumeration is one byte, as some compilers store it."""
    return f"{member.characters}s" if member.characters else _FORMATS.get(member.type, "B")


@dataclass(frozen=True)
class Codec:
    """A struct of the header: its layout, and the types of its members."""

    number: int
    name: str
    interface: str
    layout: Layout
    view: StructCodec
    members: tuple[Member, ...]

    @property
    def format(self) -> str:
        return "".join(map(member_format, self.members))

    @property
    def size(self) -> int:
        return struct.calcsize(f"<{self.format}")

    @property
    def encoded_bytes(self) -> int:
        """Bytes of an encoded word or frame in an answer."""
        return 8 if not self.view.layout_plan.in_bytes else self.view.layout_plan.length

    @property
    def answer(self) -> str:
        """Format of the answer to a record to be decoded.

        It contains the result, members, result of encoding them again, word or frame, verdict, reports.
        """
        return f"<B{self.format}B{self.encoded_bytes}sBQ"


class Batch:
    """Code of a program for a device with one interface, and the meaning of its bytes."""

    def __init__(self, device: Device) -> None:
        self.device = device
        self.view = DeviceView(device)
        layouts = {layout.name: (interface.name, layout) for interface, layout in device.layouts()}
        layouts |= {f"reg_{register.name}": (register.interface, register.layout) for register in device.registers}
        self.codecs: list[Codec] = []
        for number, plain_codec in enumerate(codecs(self.view)):
            name = short(self.view, plain_codec)
            interface, layout = layouts[name]
            codec = Codec(
                number=number,
                name=name,
                interface=interface,
                layout=layout,
                view=plain_codec,
                members=tuple(members(plain_codec)),
            )
            self.codecs.append(codec)
        fields = [field for codec in self.codecs for field in codec.layout.fields]
        choices = [field for field in fields if isinstance(field.kind, Choice)]
        assert all(value.value < 256 for field in choices for value in field.values)
        #: A length, and room for the longest frame and two bytes more.
        self.record = 1 + max(8, *(codec.view.layout_plan.length + 2 for codec in self.codecs))
        self._parameters = [parameter.name for parameter in device.set_parameters]

    def chunk(self, operation: int, codec: Codec, variant: Variant, records: Sequence[bytes] | bytes) -> bytes:
        """Return a chunk of at most 65,535 records."""
        record_bytes = records if isinstance(records, bytes) else b"".join(records)
        record_size = self.record if operation == DECODE else codec.size
        variant_values = [variant.parameters.get(name, 0) for name in self._parameters]
        undecided = [alternative for alternative in self.device.alternatives if not alternative.default]
        variant_values += [answer_of(alternative, variant) for alternative in undecided]
        record_count = len(record_bytes) // record_size
        head = struct.pack(f"<BHH{len(variant_values)}Q", operation, codec.number, record_count, *variant_values)
        return head + record_bytes

    def frame(self, placed: PlacedLayout, wire: bytes) -> bytes:
        """Return the record for a word or frame."""
        return bytes([len(wire)]) + wire.ljust(self.record - 1, b"\0")

    def source(self, main_text: str) -> str:
        """Return the program. ``main_text`` has ``feed`` and ``emit``, and a ``main`` that calls ``work()``."""
        view, prefix = self.view, self.view.prefix
        pieces = "".join(self._codec(codec, prefix) for codec in self.codecs)
        rows = ",\n".join(map(_row, self.codecs))
        member_type, parameters = view.context.member_type, self.device.set_parameters
        targets = [(f"variant->{c_name(parameter.name)}", member_type(parameter)) for parameter in parameters]
        answer_types = [alternative.type for alternative in view.alternatives]
        targets += [(f"{type_}_taken", type_) for type_ in answer_types]
        sets = ""
        for index, (target, type_) in enumerate(targets):
            sets += f"    {target} = ({type_})number(&bytes[{8 * index}], 8U);\n"
        values = {
            "headers": included(self.device),
            "prefix": prefix,
            "entry": main_text,
            "codecs": pieces,
            "rows": rows,
            "sets": sets,
        }
        values |= {
            "record": str(self.record),
            "parameters": str(8 * max(1, len(targets))),
            "given": str(8 * len(targets)),
            "taken": "".join(f"static {type_} {type_}_taken;\n" for type_ in answer_types),
        }
        largest = max(struct.calcsize(codec.answer) for codec in self.codecs)
        return _fill(
            (HERE / "batch.c").read_text(encoding="utf-8"), values | {"largest": str(max(largest, self.record))}
        )

    @staticmethod
    def _codec(codec: Codec, prefix: str) -> str:
        view, at, puts, gets = codec.view, 0, "", ""
        for member in codec.members:
            size = struct.calcsize(f"<{member_format(member)}")
            if member.characters:
                puts += f"    copy(&to[{at}], (const uint8_t *)out.{member.name}, {size}U);\n"
                gets += f"    copy((uint8_t *)in.{member.name}, &from[{at}], {size}U);\n"
            else:
                puts += f"    put(&to[{at}], (uint64_t)out.{member.name}, {size}U);\n"
                gets += f"    in.{member.name} = {_from_number(member, f'number(&from[{at}], {size}U)', 8 * size)};\n"
            at += size
        bits = not view.layout_plan.in_bytes
        values = {
            "prefix": prefix,
            "name": codec.name,
            "struct": view.name,
            "type": view.type,
            "puts": puts,
            "gets": gets,
            "size": str(at),
            "sent": str(codec.encoded_bytes),
            "decode": answers(view) + (f"{_word(view)}, &out" if bits else "&from[1], from[0], &out"),
            "answers": answers(view),
            "verdict": f"{view.reports.verdict_function}(*variant, &out)"
            if view.reports and view.reports.verdict_function
            else "255U",
            "reports": f"{view.reports.reports_function}(*variant, &out)"
            if view.reports and view.reports.reports_function
            else "0U",
            "encode": "&word" if bits else f"to, {view.layout_plan.length}U",
            "before": f"{view.struct.number_type} word = 0U;" if bits else "",
            "too_high": _refuse_too_high(view),
            "after": "put_word(to, word);" if bits else "",
        }
        return _fill(_CODEC, values)


def _word(view: StructCodec) -> str:
    """Return the word of a record, with the length of the variant. Too high a number is a word that is too long."""
    if not view.word_has_length:
        return f"({view.struct.number_type})word_of(from)"
    taken = "".join(f", {question.type}_taken" for question in view.length_alternatives)
    return f"cw_word_of(word_of(from), {view.name}_bits(*variant{taken}))"


def _refuse_too_high(view: StructCodec) -> str:
    """Return C that refuses a number that the type of the word does not hold, because no caller can pass it."""
    size = view.struct.reader.word_size
    if view.layout_plan.in_bytes or size == 64:
        return ""
    return f"if ((word_of(from) >> {size}U) != 0U) {{ to[-1] = (uint8_t)CW_FAULT_LENGTH; return; }}"


def _row(codec: Codec) -> str:
    sizes = f"{struct.calcsize(codec.answer)}U, {codec.size}U, {1 + codec.encoded_bytes}U"
    return f"    {{ decode_{codec.name}, encode_{codec.name}, {sizes} }}"


def answer_of(alternative: Alternative, variant: Variant) -> int:
    """Return the answer that a variant has, from its parameters."""
    for index, answer in enumerate(alternative.answers):
        if all(variant.parameters[name] == value for name, value in answer.sets.items()):
            return index
    raise LookupError(f"{variant.code} has no answer about {alternative.name}")


def _from_number(member: Member, text: str, bits: int) -> str:
    if member.type == "bool":
        return f"{text} != 0U"
    return f"({member.type})to_signed({text}, {bits}U)" if member.type.startswith("int") else f"({member.type}){text}"


def _fill(text: str, values: Mapping[str, str]) -> str:
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text


def stdio_entry() -> str:
    """Return the entry of a program for a system with standard input and output."""
    return _STDIO


def on_the_wire(layout: Layout, number: int, bits: int) -> bytes:
    """Return a word as eight bytes, or a frame as it is sent."""
    if layout.carried_as == "bits":
        return number.to_bytes(8, "big")
    return number.to_bytes(bits // 8, "little" if layout.byte_order == "low_byte_first" else "big")


_STDIO = """#include <stdio.h>
static size_t feed(uint8_t *to, size_t count) { return fread(to, 1U, count, stdin); }
static void emit(const uint8_t *from, size_t count) { (void)fwrite(from, 1U, count, stdout); }
int main(void) { return work(); }
"""

_CODEC = """
static void encode_@name@(const @prefix@ *variant, const uint8_t *from, uint8_t *to)
{
    @type@ in;
    cw_result result;
    @before@
    wipe((uint8_t *)&in, sizeof in, 0U);
@gets@    result = @struct@_encode(*variant, @answers@&in, @encode@);
    to[-1] = (uint8_t)result;
    if (result == CW_OK) {
        @after@
    }
}

static void decode_@name@(const @prefix@ *variant, const uint8_t *from, uint8_t *to)
{
    @type@ out;
    cw_result result;
    wipe((uint8_t *)&out, sizeof out, 0x5AU);
    @too_high@
    result = @struct@_decode(*variant, @decode@);
    to[-1] = (uint8_t)result;
    if (result != CW_OK) {
        to[-1] |= is_all((const uint8_t *)&out, sizeof out, 0x5AU) ? 0U : 0x80U;
        return;
    }
@puts@    encode_@name@(variant, to, &to[@size@ + 1]);
    to[@size@ + 1 + @sent@] = (uint8_t)@verdict@;
    put(&to[@size@ + 2 + @sent@], (uint64_t)@reports@, 8U);
}
"""
