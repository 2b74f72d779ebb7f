from __future__ import annotations

import pytest
from codewheel.model.expressions import Expression, ExpressionError


@pytest.mark.parametrize(
    ("text", "value", "rendered"),
    [
        (24, 24, "24"),
        ("24", 24, "24"),
        ("0x10", 16, "16"),
        ("singleturn_bits + 8", 29, "singleturn_bits + 8"),
        ("24 - singleturn_bits", 3, "24 - singleturn_bits"),
        ("2^singleturn_bits - 1", 2097151, "2^singleturn_bits - 1"),
        ("2^4 + multiturn_bits", 32, "multiturn_bits + 16"),
        ("singleturn_bits + multiturn_bits", 37, "singleturn_bits + multiturn_bits"),
        ("-1 + singleturn_bits", 20, "singleturn_bits - 1"),
        ("singleturn_bits * multiturn_bits", 336, "singleturn_bits * multiturn_bits"),
        ("2^multiturn_bits * singleturn_bits - 1", 1376255, "2^multiturn_bits * singleturn_bits - 1"),
        (
            "singleturn_bits - singleturn_bits * multiturn_bits",
            -315,
            "singleturn_bits - singleturn_bits * multiturn_bits",
        ),
        ("8 - multiturn_bits * singleturn_bits", -328, "8 - multiturn_bits * singleturn_bits"),
    ],
)
def test_values(text: int | str, value: int, rendered: str) -> None:
    expression = Expression.parse(text)
    assert expression.value({"singleturn_bits": 21, "multiturn_bits": 16}) == value
    assert (expression + Expression(0)).render() == rendered


@pytest.mark.parametrize(
    "text", ["", "+", "a +", "a b", "3^a", "a^2", "__import__('os')", "1 +", "A", "a\n; b", "2^", "(a)"]
)
def test_what_is_no_expression(text: str) -> None:
    with pytest.raises(ExpressionError, match="is not a sum of numbers, parameters and powers of two"):
        Expression.parse(text)


@pytest.mark.parametrize("text", ["2^1000000000", "2^129"])
def test_huge_powers_are_refused(text: str) -> None:
    with pytest.raises(ExpressionError, match="larger than any field can hold"):
        Expression.parse(text)


def test_huge_exponents_by_parameter_are_refused() -> None:
    with pytest.raises(ExpressionError, match="is too large"):
        Expression.parse("2^a").value({"a": 10**9})


def test_a_huge_product_is_refused() -> None:
    product = Expression.parse("a * b")
    assert product.value({"a": 2**128, "b": 2**127}) == 2**255
    with pytest.raises(ExpressionError, match="larger than 2\\^256"):
        product.value({"a": 2**128, "b": -(2**128)})


def test_unknown_parameters_are_named() -> None:
    with pytest.raises(ExpressionError, match="there is no parameter 'b'"):
        Expression.parse("a + b").value({"a": 1})


@pytest.mark.parametrize(
    ("text", "rendered"),
    [
        ("a * 2", "2 * a"),
        ("24 - 2 * a", "24 - 2 * a"),
        ("2^3 * a * b - 0x10", "8 * a * b - 16"),
        ("b + a * 1", "b + a"),
        ("3 * 2^a - 3 * 4", "3 * 2^a - 12"),
        ("-2 * a + a", "-a"),
        ("0 * a + b", "b"),
    ],
)
def test_what_is_rendered_can_be_written(text: str, rendered: str) -> None:
    """A product with a number is a sum of equal terms, so ``show`` prints what a spec can contain."""
    expression = Expression.parse(text)
    assert expression.render() == rendered
    assert Expression.parse(rendered) == expression
    values = {"a": 5, "b": 7}
    assert expression.value(values) == eval(text.replace("^", "**"), {}, values)


@pytest.mark.parametrize("text", ["4294967297 * a", "2^32 * 2 * a", "2^33 * a", "65536 * 65537 + a", "2^100 * 2^100"])
def test_a_huge_number_in_a_product_is_refused(text: str) -> None:
    assert Expression.parse("4294967296 * a").value({"a": 1}) == 1 << 32
    with pytest.raises(ExpressionError, match="in a product is larger than 4294967296"):
        Expression.parse(text)


def test_what_follows_from_a_product_keeps_its_name() -> None:
    expressions = {"field": Expression.parse("value + spare"), "now": Expression.parse("value + spare * switch")}
    difference = Expression.parse("field - now").substitute(expressions)
    assert difference == Expression.parse("value + spare - now")
    assert (difference + Expression.parse("now")).parameters == ("value", "spare")
    assert expressions["now"].parameters == ("value", "spare", "switch")


def test_sums_cancel() -> None:
    low = Expression.parse(33) - Expression.parse("bits")
    assert low + Expression.parse("bits") == Expression(33)


def test_terms_of_the_same_factors_are_added_up() -> None:
    """Eight fields of one parameter each begin at multiples of it, not at long sums."""
    total = Expression.parse("flags + bits + flags - other + flags")
    assert total.render() == "3 * flags + bits - other"
    assert total.value({"flags": 1, "bits": 10, "other": 2}) == 11
    assert (total - Expression.parse("flags + flags + flags")).render() == "bits - other"


def test_a_multiple_of_a_derived_parameter_is_a_multiple_of_its_definition() -> None:
    total = Expression.parse("word + word + 1").substitute({"word": Expression.parse("bits + 4")})
    assert total.render() == "2 * bits + 9"
