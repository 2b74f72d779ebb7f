"""Line breaks in long C code, and parentheses where C or its readers need them."""

from __future__ import annotations

import pytest
from codewheel.model.expressions import Expression
from codewheel.targets.c.comments import break_lines, end_comment
from codewheel.targets.c.expressions import (
    CCall,
    CCast,
    CExpression,
    CName,
    CNumber,
    Conditional,
    COperation,
    ExpressionTranslator,
    join_operands,
    masked,
    shifted_left,
    shifted_right,
)

LONG = "a_name_of_so_many_letters_that_two_of_them_fill_a_line"


def test_what_fits_stays_as_it_is() -> None:
    comments = f"/*\n * {'x' * 120}\n */\n/* {'x' * 120} */\n"
    text = f"{'x' * 100}\n{comments}#define {'X' * 120} 1U\nint a[] = {{ {'1, ' * 60}1 }};\n"
    assert break_lines(text) == text


@pytest.mark.parametrize(
    ("line", "lines"),
    [
        (f"    {LONG}_first = {LONG};", [f"    {LONG}_first =", f"        {LONG};"]),
        (f"    {LONG} = c ? d : {LONG};", [f"    {LONG} = c ?", f"        d : {LONG};"]),
        (f"    if (({LONG}) && ({LONG})) {{", [f"    if (({LONG}) &&", f"        ({LONG})) {{"]),
        (f"    call({LONG}, {LONG});", [f"    call({LONG},", f"        {LONG});"]),
        (f"static int f({LONG} a, {LONG} b)", ["static int f(", f"    {LONG} a,", f"    {LONG} b)"]),
        (f'    p("{LONG}, a || b", {LONG});', [f'    p("{LONG}, a || b",', f"        {LONG});"]),
    ],
)
def test_a_long_line_is_broken_where_it_can_be(line: str, lines: list[str]) -> None:
    assert break_lines(line + "\n").splitlines() == lines


def test_a_line_that_goes_on_is_not_indented_further() -> None:
    assert break_lines(f"    word =\n        ({LONG} +\n        {LONG} + {LONG}) |\n").splitlines()[2:] == [
        f"        {LONG} +",
        f"            {LONG}) |",
    ]
    assert break_lines(f"    word =\n        ({LONG} + {LONG}) |\n").splitlines()[1:] == [
        f"        ({LONG} +",
        f"        {LONG}) |",
    ]


def test_a_comment_behind_a_long_line_moves_above_it() -> None:
    assert break_lines(f"    x = 1;{end_comment('one')}\n") == "    x = 1; /* one */\n"
    assert break_lines(f"    x = {LONG};{end_comment(LONG)}\n") == f"    /* {LONG} */\n    x = {LONG};\n"
    assert end_comment("") == ""
    assert end_comment("*/ int x;") == " /* * / int x; */"


A, B, C = CName("a"), CName("b"), CName("c")


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (COperation("|", (shifted_left(A, 3), B)), "(a << 3U) | b"),
        (shifted_left(COperation("|", (shifted_left(A, 3), B)), 4), "((a << 3U) | b) << 4U"),
        (CCast("uint8_t", shifted_right(A, 2)), "(uint8_t)(a >> 2U)"),
        (shifted_right(CCast("uint8_t", A), 2), "(uint8_t)a >> 2U"),
        (masked(CCall("f", (join_operands("+", (A, B)),)), 7), "f(a + b) & 0x07U"),
        (COperation("-", (COperation("+", (A, B)), C)), "a + b - c"),
        (COperation("-", (A, COperation("+", (B, C)))), "a - (b + c)"),
        (CCast("int", Conditional(COperation("==", (A, CNumber(0))), B, C)), "(int)((a == 0U) ? b : c)"),
        (join_operands("&&", (COperation("!=", (A, B)), COperation("!=", (A, C)))), "(a != b) && (a != c)"),
        (shifted_right(A, 0), "a"),
    ],
)
def test_operations_within_others_stand_in_parentheses(tree: CExpression, text: str) -> None:
    assert str(tree) == text


@pytest.mark.parametrize(
    ("text", "unsigned", "signed"),
    [
        ("5", "5U", "5"),
        ("set + 3", "3U + variant.set", "3 + (int64_t)variant.set"),
        ("set - 3", "(uint32_t)variant.set - 3U", "(-3) + (int64_t)variant.set"),
        ("2^set - 1", "cw_mask(variant.set)", "(int64_t)cw_mask(variant.set)"),
        ("2^set", "(uint64_t)1U << variant.set", "1 + (int64_t)cw_mask(variant.set)"),
        ("set * set", "(uint32_t)variant.set * variant.set", "(int64_t)((uint32_t)variant.set * variant.set)"),
        ("other", "m_d_other(variant)", "(int64_t)m_d_other(variant)"),
        ("4 - set", "4U - variant.set", "4 - (int64_t)variant.set"),
    ],
)  # fmt: skip
def test_parameters_are_members_of_the_variant_or_functions_of_it(text: str, unsigned: str, signed: str) -> None:
    scope = ExpressionTranslator("m_d", {"set": 255}, {})
    assert str(scope.to_c(Expression.parse(text))) == unsigned
    assert str(scope.to_signed_c(Expression.parse(text))) == signed
