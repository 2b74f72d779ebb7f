"""Proofs of a decoder and an encoder: both equal the plain reference and are inverse to each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from c_harness import included
from codewheel.model.expressions import Expression
from proof import PRELUDE, UNDEFINED, Proof, in_c
from proof_layout import LENGTH, RANGE, Codec
from proof_reference import layout_crc, reference
from proof_reports import report_functions
from proof_values import limits, one_bit, valid

#: Entries that end in a CRC. Each is proved separately, because sums of bits are hard to prove.
_WITH_CRC = ("decode_result", "encode_crc", "decode_of_encode", "encode_of_decode")


def _function(name: str, *lines: str) -> str:
    return (
        f"void {name}(void)\n{{\n    any_variant();\n"
        + "".join(f"    {line.strip()}\n" if line.strip() else "" for line in lines)
        + "}\n"
    )


def _claim(condition: str, words: str) -> str:
    return f'__CPROVER_assert({condition}, "{words}");'


def _all(conditions: Iterable[str]) -> str:
    return " && ".join(conditions) or "1"


def _places(name: str, count: int) -> list[str]:
    """Return a member, or each of its elements if it is an array."""
    return [f"{name}[{at}]" for at in range(count)] or [name]


def _unchanged(codec: Codec, names: Iterable[str]) -> str:
    """Return the claim that members of ``out`` equal ``before``."""
    members = (member for member in codec.header.structs[codec.type] if member.name in set(names))
    return _all(f"out.{place} == before.{place}" for member in members for place in _places(member.name, member.count))


def _every_name(codec: Codec) -> list[str]:
    return [member.name for member in codec.header.structs[codec.type]]


def _harness(codec: Codec) -> str:
    codec.check_members()
    text = f"{included(codec.device)}{PRELUDE}"
    text += f"typedef unsigned __CPROVER_bitvector[{max(codec.layout.widest, 64) + 8}] number;\n"
    text += codec.variants.declare(codec.prefix, codec.header) + reference(codec)
    text += _codec(codec) + _length(codec) + "".join(_setters(codec)) + _expected_claims(codec) + _report_claims(codec)
    calls = ["decode_members", "encode_members", *(["length"] if _length(codec) else []), *_set_names(codec)]
    calls += ["expected"] if _has_expected(codec) else []
    calls += ["tells"] if any(report_functions(codec)) else []
    if codec.crc is None:
        calls += [name for name in _WITH_CRC if name != "encode_crc"]
    return text + "void everything(void)\n{\n" + "".join(f"    {name}();\n" for name in calls) + "}\n"


class _Wire(NamedTuple):
    """C that declares a frame and passes it to decoder and encoder, as a word or as bytes."""

    declare: str
    declare_before: str
    is_unchanged: str
    source: str
    destination: str
    #: The frame as one number.
    number: str
    declare_again: str
    destination_again: str

    @classmethod
    def of_codec(cls, codec: Codec) -> _Wire:
        return (
            cls.word(_given_word(codec), _word_type(codec))
            if codec.by_word
            else cls.buffer(codec.size, codec.bytes_upwards)
        )

    @classmethod
    def word(cls, source: str, type_: str) -> _Wire:
        return cls(
            declare=f"{type_} wire = ({type_})nondet_word();",
            declare_before=f"{type_} before = wire;",
            is_unchanged="wire == before",
            source=source,
            destination="&wire",
            number="(number)wire",
            declare_again=f"{type_} again = ({type_})nondet_word();",
            destination_again="&again",
        )

    @classmethod
    def buffer(cls, size: int, bytes_upwards: Sequence[int]) -> _Wire:
        return cls(
            declare=f"uint8_t wire[{size}]; " + " ".join(f"wire[{at}] = nondet_byte();" for at in range(size)),
            declare_before=f"uint8_t before[{size}]; for (int i = 0; i < {size}; i++) before[i] = wire[i];",
            is_unchanged=_all(f"wire[{at}] == before[{at}]" for at in range(size)),
            source=f"wire, {size}",
            destination=f"wire, {size}",
            number=" | ".join(f"((number)wire[{at}] << {8 * place})" for place, at in enumerate(bytes_upwards)),
            declare_again=f"uint8_t again[{size}];",
            destination_again=f"again, {size}",
        )


def _word_type(codec: Codec) -> str:
    """Return the type of the word that the encoder stores."""
    out, _ = codec.header.functions[f"{codec.name}_encode"].arguments[-1]
    return out.removesuffix("*").strip()


def _given_word(codec: Codec) -> str:
    """Return the argument for a decoder, with the length of the layout if words have several lengths."""
    is_received = codec.register is None and codec.layout.sender == "encoder"
    if not is_received or codec.layout.bits.is_constant:
        return "wire"
    return f"cw_word_of(wire, {in_c(codec.layout.bits)})"


def _codec(codec: Codec) -> str:
    """Return a harness that runs decoder and encoder on the same arbitrary frame, and on the same arbitrary values."""
    wire, answers = _Wire.of_codec(codec), codec.variants.answers
    out, declare_in = codec.header.anything(codec.type, "out"), codec.header.anything(codec.type, "in")
    decode = f"{codec.name}_decode(variant, {answers}{wire.source}, &out);"
    encode = f"{codec.name}_encode(variant, {answers}&in, {wire.destination});"
    encode_again = f"{codec.name}_encode(variant, {answers}&out, {wire.destination_again});"
    decoded = (out, wire.declare, f"{codec.type} before = out;", f"cw_result found = {decode}")
    encoded = (declare_in, wire.declare, wire.declare_before, f"cw_result found = {encode}")
    text = _decode(codec, wire, decoded) + _encode(codec, wire, encoded)
    text += _decode_of_encode(codec, (*encoded, "if (found != 0) return;", out, f"found = {decode}"))
    text += _encode_of_decode(
        codec, wire, (*decoded, "if (found != 0) return;", wire.declare_again, f"found = {encode_again}")
    )
    if codec.crc is not None:
        crc_holds = f"found != 0 || crc_of({wire.number}) == {layout_crc(codec, wire.number)}"
        text += _function("encode_crc", *encoded, _claim(crc_holds, "the CRC of the definition"))
    return text


def _member_claims(codec: Codec, struct: str, words: str) -> list[str]:
    """Return the claims that the members of ``in`` or ``out`` have the values of the reference."""
    members = codec.visible_members
    return [_claim(member.equals(struct, f"({member.type})({member.value})"), words) for member in members]


def _decode(codec: Codec, wire: _Wire, decoded: Sequence[str]) -> str:
    members = _member_claims(codec, "out", "same member as the reference")
    text = _function(
        "decode_result", *decoded, _claim(f"(int)found == reference({wire.number})", "same result as the reference")
    )
    return text + _function(
        "decode_members",
        *decoded,
        f"(void)check({wire.number});",
        f"if (found == 0) {{ {' '.join(members)} }}",
        f"else {{ {_claim(_unchanged(codec, _every_name(codec)), 'a fault leaves the result as it was')} }}",
    )


def _encode(codec: Codec, wire: _Wire, encoded: Sequence[str]) -> str:
    takes = _all(f"({condition})" for condition in valid(codec))
    number = wire.number
    fits = _claim(f"({number}) >> {in_c(codec.layout.bits)} == 0", "as many bits as the layout has")
    return _function(
        "encode_members",
        *encoded,
        _claim(f"(int)found == (({takes}) ? 0 : {RANGE})", "takes exactly the values in range"),
        f"if (found != 0) {{ {_claim(wire.is_unchanged, 'a fault leaves the result as it was')} return; }}",
        _claim(f"check({number}) == 0", "constants, parity and choices as the layout has them"),
        fits if codec.by_word else "",
        _claim(f"uncovered({number}) == 0", "bits without a field are 0"),
        *_member_claims(codec, "in", "the reference reads the member back"),
    )


def _decode_of_encode(codec: Codec, encoded_and_decoded: Sequence[str]) -> str:
    members = [member for member in codec.visible_members if member.type != "digits"]
    places = (place for member in members for place in _places(member.member.name, member.characters))
    text = _function(
        "decode_of_encode",
        *encoded_and_decoded,
        _claim("found == 0", "what was encoded can be decoded"),
        *(_claim(f"out.{place} == in.{place}", "decode(encode(x)) = x") for place in places),
    )
    return text + _function(
        "reached", *encoded_and_decoded, f"if (found == 0) {_claim('0', 'something comes through')}"
    )


def _encode_of_decode(codec: Codec, wire: _Wire, decoded_and_encoded: Sequence[str]) -> str:
    number, number_again = wire.number, wire.number.replace("wire", "again")
    return _function(
        "encode_of_decode",
        *decoded_and_encoded,
        _claim(
            "1" if codec.has_digits else f"(found == 0) == ({_all(_writable(codec))})",
            "what was decoded can be encoded",
        ),
        _claim(f"found != 0 || {number_again} == (({number}) & ~uncovered({number}))", "encode(decode(f)) = f"),
    )


def _writable(codec: Codec) -> Iterator[str]:
    """Return the additional conditions, beyond decoding, under which a value can be encoded."""

    def out(name: str) -> str:
        return f"((number)out.{codec.member(name).name})"

    yield from (f"({limit})" for limit in limits(codec, out))
    yield from (f"({one_bit(field, out(field.name))})" for field in codec.fields if field.number.power_of_two)


def _length(codec: Codec) -> str:
    if codec.by_word:
        return _word_length(codec)
    out, declare_in = codec.header.anything(codec.type, "out"), codec.header.anything(codec.type, "in")
    refused = f"{codec.name}_decode(variant, {codec.variants.answers}none, length, &out) == {LENGTH}"
    return _function(
        "length",
        out,
        f"{codec.type} before = out;",
        "size_t length = nondet_size();",
        f"__CPROVER_assume(length != {codec.size});",
        "uint8_t none[1];",
        _claim(
            f"{refused} && {_unchanged(codec, _every_name(codec))}", "another length is refused before a byte is read"
        ),
        declare_in,
        _claim(
            f"{codec.name}_encode(variant, {codec.variants.answers}&in, none, length) == {LENGTH}",
            "another length is refused before a byte is written",
        ),
    )


def _word_length(codec: Codec) -> str:
    if _given_word(codec) == "wire":
        return ""
    refused = f"{codec.name}_decode(variant, {codec.variants.answers}cw_word_of(wire, length), &out) == {LENGTH}"
    return _function(
        "length",
        codec.header.anything(codec.type, "out"),
        f"{codec.type} before = out;",
        "unsigned long long wire = nondet_word();",
        "uint32_t length = (uint32_t)nondet_size();",
        f"__CPROVER_assume(length != {in_c(codec.layout.bits)});",
        _claim(f"{refused} && {_unchanged(codec, _every_name(codec))}", "a word of another length is refused"),
    )


def _set_names(codec: Codec) -> list[str]:
    names = [join.name for join in codec.layout.joins]
    names += [field.name for field in codec.fields if field.runs]
    return [f"set_{name}" for name in names]


def _setters(codec: Codec) -> Iterator[str]:
    """Return claims about a number and its parts.

    The setter accepts exactly the numbers that fit, and the parts are those that the reference would read.
    """
    for join in codec.layout.joins:
        low, parts = Expression(0), {}
        for name in reversed(join.fields):
            width = codec.layout.field(name).width
            parts[name] = f"received(given, {in_c(low)}, {in_c(width)})"
            low += width
        yield _setter(codec, join.name, f"((number)given >> {in_c(low)}) == 0", parts)
    for field in codec.fields:
        if field.runs:
            yield _setter(
                codec,
                field.name,
                f"given < {10 ** sum(run.digits for run in field.runs)}ULL",
                {run.name: "" for run in field.runs},
            )


def _setter(codec: Codec, name: str, fits: str, parts: dict[str, str]) -> str:
    """Return the claims. ``parts`` names the members of the number, with their values if the checker can tell."""
    whole = codec.member(name)
    touched = {whole.name, *(codec.member(part).name for part in parts)}
    equal = _all(
        [
            f"out.{whole.name} == given",
            *(f"(number)out.{codec.member(part).name} == {value}" for part, value in parts.items() if value),
        ]
    )
    return _function(
        f"set_{name}",
        codec.header.anything(codec.type, "out"),
        f"{codec.type} before = out;",
        f"{whole.type} given = ({whole.type})nondet_word();",
        f"int found = (int){codec.name}_set_{name}(variant, given, &out);",
        _claim(f"found == (({fits}) ? 0 : {RANGE})", "takes exactly the numbers that fit"),
        _claim(_unchanged(codec, set(_every_name(codec)) - touched), "sets nothing else"),
        _claim(f"found != 0 || ({equal})", "sets the number and its parts"),
        _claim(f"found == 0 || ({_unchanged(codec, touched)})", "a fault leaves the result as it was"),
    )


def _has_expected(codec: Codec) -> bool:
    return f"{codec.name}_is_expected" in codec.header.functions


def _expected_claims(codec: Codec) -> str:
    if not _has_expected(codec):
        return ""
    conditions: list[str] = []
    for field in codec.fields:
        member = codec.member(field.name).name
        if isinstance(field.equals, str):
            characters = enumerate(field.equals.encode("ascii"))
            conditions += [f"(unsigned char)in.{member}[{at}] == {byte}" for at, byte in characters]
        elif isinstance(field.equals, Expression):
            conditions.append(f"(number)in.{member} == {in_c(field.equals)}")
        elif field.equals is not None:
            conditions.append(f"(number)in.{member} == {field.equals}")
    conditions += ["in.unused == 0"] if codec.layout.unused else []
    test = f"{codec.name}_is_expected(variant, &in) == ({_all(conditions)})"
    return _function("expected", codec.header.anything(codec.type, "in"), _claim(test, "reads as the manual states"))


def _report_claims(codec: Codec) -> str:
    """Return claims about the verdict and the mask of reports of any frame. ``unused`` has no other bit."""
    unused_bits = sum(((1 << field.widest) - 1) << place for field, place in codec.layout.unused)
    assume = [f"__CPROVER_assume((in.unused & ~{unused_bits:#x}ULL) == 0);"] if codec.layout.unused else []
    reports = report_functions(codec)
    claims = [_claim(f"{function}(variant, &in) == ({value})", words) for function, value, words in reports]
    return _function("tells", codec.header.anything(codec.type, "in"), *assume, *claims) if claims else ""


def functions(codec: Codec) -> Iterator[str]:
    """Return the functions that are proved here."""
    yield from (f"{codec.name}_{suffix}" for suffix in ("decode", "encode", *_set_names(codec)))
    if _has_expected(codec):
        yield f"{codec.name}_is_expected"
    yield from (name for name, _, _ in report_functions(codec))


def proofs(codec: Codec) -> Iterable[Proof]:
    state = "".join(f", {name} {value}" for name, value in codec.fixed_values.items())
    new_proof = partial(
        Proof,
        harness=_harness(codec),
        unwind=max(66, codec.layout.widest + 2),
        covers=codec.variants.count,
        subject=codec.name + state,
    )
    without_checks = ("--no-standard-checks",)
    yield new_proof(f"{codec.name} everything{state}", function="everything", options=tuple(UNDEFINED))
    yield new_proof(f"{codec.name} reached{state}", function="reached", options=without_checks, reached=True)
    if codec.crc is not None:
        for function in _WITH_CRC:
            yield new_proof(f"{codec.name} {function}{state}", function=function, options=without_checks)
        for option in codec.header.options:
            for function in ("decode_result", "encode_crc"):
                name = f"{codec.name} {function} with {option}{state}"
                yield new_proof(name, function=function, options=(f"-D{option}", *UNDEFINED))
