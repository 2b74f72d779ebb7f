"""Every output states each fact of a spec in plain English, in the same words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.show.text import device_text, style_with, variant_text
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.model.expressions import Expression
from codewheel.order_codes.labels import find_code
from codewheel.say import layout, order_code, register
from codewheel.say import order_code as interface
from codewheel.say import register as field
from codewheel.say.text import (
    DOCSTRING_STYLE,
    MARKDOWN,
    PLAIN_STYLE,
    TITLE_STYLE,
    CodeText,
    Hex,
    Level,
    Reference,
    Statement,
    Style,
    join_groups,
    list_parts,
    spec_text,
    statement,
)
from codewheel.targets import Library
from codewheel.targets.c.comments import in_comment
from codewheel.targets.c.files import generate as generate_c
from codewheel.targets.docs.files import generate
from codewheel.targets.python.files import generate as generate_python


@pytest.fixture(scope="module")
def device() -> Device:
    (loaded,), report = load_library([Path(__file__).parent])
    assert not report.problems, report.problems[0].format()
    return loaded


#: Statements about each register of the spec that has one special property.
REGISTERS = [
    ("banked", "First select bank 3 with bank."),
    ("wide", "Byte order: high byte first, at 60h."),
    ("wide", "Default: 12 34."),
    ("narrow", "Byte order: low byte first, at 62h."),
    ("bounded", "Limits: 3 to 200."),
    ("least", "Limits: at least 3."),
    ("greatest", "Limits: at most 200."),
    ("greatest", "The encoder replaces a value above the limit with the default."),
    ("refusing", "The encoder rejects a value above the limit."),
    ("clearing", "A write sets bounded and least to zero."),
    ("kept", "Reserved for the manufacturer."),
    ("lost", "Save the parameters after a write, or the encoder loses the value at power-off."),
    ("slow", "Wait at least 15 ms between a write and the next command."),
    ("key", "After a write, the register returns to its default automatically."),
    ("locked", "The register can be written only while key is C0h (unlock)."),
    ("opened", "The register can be written only while settings.mode is 0 (open)."),
    ("either", "While settings.mode is 0 (open), the register holds preset, at most 100. A place [8.1]."),
    ("either", "While settings.mode is 1 (shut), the register holds offset. A distance [8.2]."),
    ("command", "Reading the same address accesses status instead."),
    ("status", "Writing to the same address accesses command instead."),
]
#: Statements about the fields of registers.
FIELDS = [
    ("settings.mode", "Default: 1."),
    ("fields.counted", "Unit: counts."),
    ("fields.below_zero", "Signed, in two's complement."),
    ("fields.no_zero", "A value of 0 means 256."),
    ("fields.doubling", "Only powers of two are allowed."),
    ("fields.fault", "Active when 1: broken."),
    ("fields.fault", "Inactive when 0: whole."),
    ("fields.fault", "For the reason, see settings.mode."),
    ("fields.missing", "Not implemented in this encoder."),
    ("fields.theirs", "Reserved for the manufacturer."),
    ("fields.fixed", "Always 2."),
    ("fields.digits", "Decimal digits, most significant digit first: tens 1, ones 1."),
    ("maker.letters", "ASCII text."),
    ("maker.letters", "The value Ac helps to identify the encoder. The decoder also accepts other values."),
    ("kind_of.kind", "The value 20h helps to identify the encoder. The decoder also accepts other values."),
]
INTERFACES = [
    ("ssi", "Clock: 100 kHz to 4 MHz [5.1]."),
    ("ssi", "Clock: below 400 kHz with cables shorter than 50 m [5.2]."),
    ("ssi", "Alignment: right: zeros come before the word [5]."),
    ("ssi", "Code: binary or Gray, by order code [5]."),
    ("ssi", "Signals: RS-422 [5]."),
    ("biss", "Timeout: 1.5 clock periods (1.5 µs at 1 MHz) [6.3]."),
    ("biss", "Network: point to point, one slave only [6.4]."),
    ("biss", "Profile: BP1 [6]."),
    ("biss", "Description file: acme.xml, which the manufacturer supplies [6]."),
    ("biss", "Bank select: bank [6]."),
    ("rs485", "Baud rate: 115,200 Bd, 8 data bits, even parity, 1 stop bit, no flow control [7.1]."),
]
LAYOUTS = [
    ("word", "position is in Gray code while gray is 1, and in binary while it is 0."),
    ("word", "position consists of turns and steps, most significant part first."),
    ("reply", "Its data_id is 1 (place)."),
]


def of_register(device: Device, name: str) -> Iterator[Statement]:
    return register.describe_register_facts(device, device.register(name))


def of_field(device: Device, path: str) -> Iterator[Statement]:
    owner, _, name = path.partition(".")
    return field.describe_field_rules(device, device.register(owner).layout.field(name))


def of_interface(device: Device, kind: str) -> Iterator[Statement]:
    return interface.describe_interface_facts(device, device.interface(kind))


def of_layout(device: Device, name: str) -> Iterator[Statement]:
    owner, chosen = next((interface, candidate) for interface, candidate in device.layouts() if candidate.name == name)
    return layout.describe_layout_facts(owner, chosen)


Statements = Callable[[Device, str], Iterator[Statement]]


def cases_of(statements: Statements, table: list[tuple[str, str]]) -> list[Any]:
    return [pytest.param(statements, name, sentence, id=f"{name}: {sentence}") for name, sentence in table]


CASES = [
    *cases_of(of_register, REGISTERS),
    *cases_of(of_field, FIELDS),
    *cases_of(of_interface, INTERFACES),
    *cases_of(of_layout, LAYOUTS),
]


@pytest.mark.parametrize(("statements", "name", "sentence"), CASES)
def test_the_words(device: Device, statements: Statements, name: str, sentence: str) -> None:
    assert sentence in [PLAIN_STYLE.sentence(fact) for fact in statements(device, name)]


def test_nothing_else_is_said(device: Device) -> None:
    """The table above has every statement, except for facts that several registers share."""
    table_rows = {*REGISTERS, *FIELDS}
    common = re.compile(r"(Byte order|Default|Limits|Clock): |Active when |ASCII text")
    for each_register in device.registers:
        field_names = [f"{each_register.name}.{each_field.name}" for each_field in each_register.layout.fields]
        for name, statements in [(each_register.name, of_register), *((name, of_field) for name in field_names)]:
            sentences = {PLAIN_STYLE.sentence(fact) for fact in statements(device, name)}
            in_table = {sentence for row_name, sentence in table_rows if row_name == name}
            assert {sentence for sentence in sentences if not common.match(sentence)} <= in_table


# ------------------------------------------------------------------------------------------------------------- outputs


def on_one_line(text: str) -> str:
    return " ".join(text.split())


#: Facts that C has as code, and Python as data.
IN_CODE = {
    ("c", "wide", "Default: 12 34."): "#define ACME_SAID_BISS_REG_WIDE_DEFAULT 0x1234U",
    (
        "c",
        "bounded",
        "Limits: 3 to 200.",
    ): "#define ACME_SAID_BISS_REG_BOUNDED_MIN 3U /**< limit of its value */ "
    "#define ACME_SAID_BISS_REG_BOUNDED_MAX 200U",
    ("c", "least", "Limits: at least 3."): "#define ACME_SAID_BISS_REG_LEAST_MIN 3U",
    ("c", "greatest", "Limits: at most 200."): "#define ACME_SAID_BISS_REG_GREATEST_MAX 200U",
    ("c", "ssi", "Clock: below 400 kHz with cables shorter than 50 m [5.2]."): "if (cable_m < 50U) { return 400000U;",
    (
        "python",
        "biss",
        "Description file: acme.xml, which the manufacturer supplies [6].",
    ): 'description_file="acme.xml"',
    ("python", "ssi", "Clock: 100 kHz to 4 MHz [5.1]."): 'clock=Clock(min_hz=100_000, max_hz=4_000_000, source="5.1")',
    ("python", "ssi", "Clock: below 400 kHz with cables shorter than 50 m [5.2]."): (
        'CableLength(shorter_than_m=50, below_hz=400_000, source="5.2")'
    ),
    ("python", "ssi", "Alignment: right: zeros come before the word [5]."): "alignment=Alignment.LSB_RIGHT",
    ("python", "ssi", "Code: binary or Gray, by order code [5]."): 'output_code="by_order_code"',
    ("python", "biss", "Timeout: 1.5 clock periods (1.5 µs at 1 MHz) [6.3]."): (
        'half_clock_periods=3, printed=(PrintedTimeout(1_000_000, 1500),), source="6.3"'
    ),
    ("python", "biss", "Network: point to point, one slave only [6.4]."): (
        'Network(topology="point_to_point", multiple_slaves=False, source="6.4")'
    ),
    ("python", "biss", "Bank select: bank [6]."): 'bank_select="bank"',
    ("python", "rs485", "Baud rate: 115,200 Bd, 8 data bits, even parity, 1 stop bit, no flow control [7.1]."): (
        'port=Port(baud=115_200, data_bits=8, parity="even", stop_bits=1, flow_control="none", source="7.1")'
    ),
}
Phrase = Callable[[Statement], str]


@pytest.fixture(scope="module")
def outputs(device: Device) -> dict[str, tuple[str, Phrase]]:
    """Return each output as one line of text, and its form of a statement."""
    show_texts = [
        device_text(device),
        *(variant_text(device, find_code(device, variant.code)) for variant in device.variants),
    ]
    pages = " ".join(text for path, text in generate(Library((device,))).items() if path.startswith("docs/said"))
    headers = (text for path, text in generate_c(Library((device,))).items() if path.startswith("c/include/acme/said"))
    header = re.sub(r"\n +\* ", " ", "\n".join(headers))
    files = generate_python(Library((device,)))
    module = files["python/acme_encoders/said.py"] + files["python/acme_encoders/facts/said.py"]
    return {
        "show": (on_one_line(" ".join(show_texts)), PLAIN_STYLE.phrase),
        "docs": (on_one_line(pages), MARKDOWN.phrase),
        "c": (on_one_line(header), lambda fact: in_comment(TITLE_STYLE.phrase(fact))),
        "python": (on_one_line(module), DOCSTRING_STYLE.phrase),
    }


@pytest.mark.slow
@pytest.mark.parametrize("output", ["show", "docs", "c", "python"])
@pytest.mark.parametrize(("statements", "name", "sentence"), CASES)
def test_every_output_says_it(
    device: Device,
    outputs: dict[str, tuple[str, Phrase]],
    output: str,
    statements: Statements,
    name: str,
    sentence: str,
) -> None:
    text, phrase = outputs[output]
    (stated,) = [fact for fact in statements(device, name) if PLAIN_STYLE.sentence(fact) == sentence]
    assert IN_CODE.get((output, name, sentence), phrase(stated)) in text


# --------------------------------------------------------------------------------------------------------------- parts

PARTS = statement(
    "Set ",
    CodeText("a_b"),
    " of ",
    Reference("register", "one.two", "Two of One"),
    " to ",
    Expression(70000),
    ", ",
    Hex(Expression(63)),
    " or ",
    Expression.parse("2^n - 1"),
    label="How",
)


@pytest.mark.parametrize(
    ("style", "expected"),
    [
        (PLAIN_STYLE, "How: Set a_b of one.two to 70,000, 3Fh or 2^n - 1."),
        (TITLE_STYLE, "How: Set a_b of Two of One to 70,000, 3Fh or 2^n - 1."),
        (DOCSTRING_STYLE, "How: Set ``a_b`` of ``one.two`` to 70,000, 3Fh or ``2^n - 1``."),
        (MARKDOWN, "How: Set `a_b` of [`one.two`](#register-one) to 70,000, 3Fh or `2^n - 1`."),
    ],
)
def test_each_style_writes_the_parts_in_its_way(style: Style, expected: str) -> None:
    assert style.sentence(PARTS) == expected


@pytest.mark.parametrize(
    ("text", "expected"), [("It is so", "It is so."), ("Is it so?", "Is it so?"), ("It is.", "It is."), ("", "")]
)
def test_a_sentence_ends_once(text: str, expected: str) -> None:
    assert PLAIN_STYLE.sentence(statement(text)) == expected


@pytest.mark.parametrize(
    ("style", "expected"),
    [(TITLE_STYLE, ["Active", "Inactive", "active"]), (DOCSTRING_STYLE, ["True", "False", "True"])],
)
def test_a_flag_is_a_truth_value_in_docstrings(style: Style, expected: list[str]) -> None:
    assert [style.phrase(statement(level)) for level in Level] == expected


def test_lists() -> None:
    assert "".join(map(str, list_parts(["a"]))) == "a"
    assert "".join(map(str, list_parts(["a", "b", "c"], " or "))) == "a, b or c"
    assert "".join(map(str, join_groups([["a", "b"], [], ["c"]], "; "))) == "ab; c"
    assert list(spec_text("")) == []
    assert list(spec_text("x")) == [statement("x")]


def test_markup_in_a_spec_stays_text() -> None:
    hostile = statement("a | b <i> ", CodeText("c|`d"), label="[x](y)")
    assert MARKDOWN.sentence(hostile) == "\\[x\\](y): a \\| b &lt;i&gt; ``c\\|`d``."


def test_an_order_code_turns_expressions_into_numbers(device: Device) -> None:
    _, codes = order_code.parameter_origin(
        device, next(candidate for candidate in device.parameters if candidate.name == "coded")
    )
    assert PLAIN_STYLE.sentence(codes) == "The register holds a code: 0 means 8, 16 means 12, 20 means 14."
    (equals,) = order_code.parameter_origin(
        device, next(candidate for candidate in device.parameters if candidate.name == "doubled")
    )
    assert PLAIN_STYLE.sentence(equals) == "It equals 2 * position_bits."
    assert style_with({"position_bits": 16}).sentence(equals) == "It equals 32."
