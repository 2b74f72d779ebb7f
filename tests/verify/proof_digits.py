"""Decimal digits inside a binary number: every number is tried, because division is too hard for a model checker.

The reference does not divide either. It counts, and carries like an odometer. The counter reaches every value that an
encoder accepts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from c_harness import included
from codewheel.model import Digits, Field
from proof_layout import RANGE, Codec


def program(codec: Codec) -> str:
    """Return a C program for a register whose only field is a number of at most 32 bits with digits.

    It returns 0 if all of them are correct.
    """
    field = _checked_field(codec)
    limit = 10 ** sum(run.digits for run in field.runs)
    names = [codec.header.member(codec.type, run.name).name for run in field.runs]
    whole = codec.header.member(codec.type, field.name)
    places = range(codec.size) if codec.layout.byte_order == "low_byte_first" else range(codec.size - 1, -1, -1)
    writes = " ".join(f"sent[{at}] = (uint8_t)(number >> {8 * place});" for place, at in enumerate(places))
    right_bytes = " && ".join(f"again[{at}] == sent[{at}]" for at in places)
    odometer = _odometer(dict(zip(names, field.runs, strict=True)))
    compared = (*names, whole.name)
    return f"""{included(codec.device)}
int main(void)
{{
    static {codec.prefix} variant;
    static {codec.type} count;
    uint64_t number;
    for (number = 0U; number <= {(1 << field.widest) - 1}U; number++) {{
        uint8_t sent[{codec.size}], again[{codec.size}] = {{ 0U }};
        {codec.type} out = {{ 0 }}, set = {{ 0 }};
        int decoded, chosen;
        {writes}
        decoded = (int){codec.name}_decode(variant, sent, sizeof sent, &out);
        chosen = (int){codec.name}_set_{field.name}(variant, ({whole.type})number, &set);
        if (number >= {limit}U) {{
            if (decoded != {RANGE} || chosen != {RANGE}) return 1;
            continue;
        }}
        count.{whole.name} = ({whole.type})number;
        if (decoded != 0 || chosen != 0 || !({_equal("out", compared)}) || !({_equal("set", compared)})) return 2;
        if (({codec.name}_encode(variant, &count, again, sizeof again) != 0) || !({right_bytes})) return 3;
        {odometer}
    }}
    return 0;
}}
"""


def _checked_field(codec: Codec) -> Field:
    (field,) = codec.fields
    assert field.runs
    assert field.widest <= 32
    assert codec.size * 8 == field.widest
    assert not codec.by_word
    return field


def _odometer(runs: Mapping[str, Digits]) -> str:
    """Return C that adds 1 to the members of ``count``, the last of which counts fastest."""
    statements = ""
    for name, run in runs.items():
        carries = f"if (++count.{name} == {run.modulus}U) {{ count.{name} = 0U; {statements}}}"
        statements = carries if statements else f"count.{name}++;"
    return statements


def _equal(struct: str, names: Iterable[str]) -> str:
    return " && ".join(f"{struct}.{name} == count.{name}" for name in names)
