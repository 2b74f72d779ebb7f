"""Quantities that numbers represent: values printed by manufacturers and drivers, in the model and in Python."""

from __future__ import annotations

import json
import random
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.language.schema_check import load_schema
from codewheel.model import Scale
from codewheel.model.kinds import WIDEST
from codewheel.say import formula, quantity_text
from codewheel_runtime import facts

ENCODERS = Path(__file__).parents[2] / "specs"
#: Infineon/TLE5012-Magnetic-Angle-Sensor: (TEMP_OFFSET + temperature) / TEMP_DIV, with 152 and 2.776.
TLE5012B = Scale(1000, 2776, 152_000, "°C")
#: TLE5014 user's manual, revision 1.0, equation 9.9: (2 T + 34.54) / 1.3815.
TLE5014 = Scale(20_000, 13_815, 345_400, "°C")
#: smilerobotics/orbis_encoder, position_and_temperature.rs: a tenth of a degree.
ORBIS = Scale(1, 10, 0, "°C")
#: Tenths of a kelvin, in degrees.
KELVIN = Scale(10, 100, -27_315, "°C")


def in_python(scale: Scale) -> facts.Scale:
    """Return the same scale in the Python package."""
    return facts.Scale(scale.numerator, scale.denominator, scale.offset, scale.unit)


@pytest.mark.parametrize(
    ("number", "printed"),
    [
        *((-5, "17.76"), (-4, "19.21"), (-2, "22.11"), (0, "25.00"), (1, "26.45")),
        *((127, "208.86"), (-128, "-160.30"), (-1, "23.55")),
    ],
)
def test_the_table_of_the_tle5014(number: int, printed: str) -> None:
    """Table 20 of its user's manual prints two decimals."""
    assert round(TLE5014.quantity(number) * 100) == Decimal(printed) * 100
    assert round(in_python(TLE5014).quantity(number) * 100) == Decimal(printed) * 100


@pytest.mark.parametrize(
    ("data", "printed"),
    [("0000", "0.0"), ("0064", "10.0"), ("010D", "26.9"), ("3039", "1234.5"), ("FF9C", "-10.0"), ("F554", "-273.2")],
)
def test_the_bytes_in_the_tests_of_a_driver(data: str, printed: str) -> None:
    """test_temperature of smilerobotics/orbis_encoder."""
    number = int.from_bytes(bytes.fromhex(data), "big", signed=True)
    assert ORBIS.decimal(number) == f"{in_python(ORBIS).decimal(number):f}" == printed
    assert ORBIS.is_exact(number)


def test_the_formula_of_the_tle5012b() -> None:
    """By hand: (-152 + 152) / 2.776 = 0, (195 + 152) / 2.776 = 125, and (-72 + 152) / 2.776 = 10000 / 347.

    -72 is the number in the example in section 4.4 of the user's manual, revision 1.2.
    """
    assert [TLE5012B.quantity(number) for number in (-152, 195, -72)] == [0, 125, Fraction(10_000, 347)]
    assert quantity_text(TLE5012B, -152) == "0.00 °C"
    assert quantity_text(TLE5012B, 195) == "125.00 °C"
    # One count is 0.36 °C, so a tenth of it needs two decimals.
    assert quantity_text(TLE5012B, -72) == "≈ 28.82 °C"


def test_rounding_is_away_from_zero_and_never_negative_zero() -> None:
    """3/48 = 0.0625 has three decimals here, because 1/48 never ends."""
    scale = Scale(1, 48, 0, "V")
    assert [scale.decimal(number) for number in (3, -3, 0)] == ["0.063", "-0.063", "0.000"]
    assert Scale(1, 7, -1, "V").decimal(1) == "0.00"
    small = Scale(1000, 3000, -1, "V")
    assert small.decimal(0) == "0.00"
    assert f"{in_python(small).decimal(0):f}" == "0.00"


@pytest.mark.parametrize(
    ("scale", "printed"),
    [
        (TLE5012B, "(value + 152) / 2.776"),
        (TLE5014, "(value × 20000 + 345400) / 13815"),
        (ORBIS, "value / 10"),
        (KELVIN, "(value × 10 - 27315) / 100"),
        (Scale(1, 2, -80, "°C"), "value / 2 - 40"),
        (Scale(5, 10, 0, "°C"), "value × 0.5"),
        (Scale(9, 5, 160, "°F"), "value × 9 / 5 + 32"),
        (Scale(125, 347, 19_000, "°C"), "(value + 152) × 125 / 347"),
        (Scale(100, 1, 0, "mV"), "value × 100"),
        (Scale(1, 1, -40, "°C"), "value - 40"),
        (Scale(10, 10, 0, "°C"), "value"),
        (Scale(1000, 4000, 0, "V"), "value / 4"),
        (Scale(10, 100, 7, "V"), "(value × 10 + 7) / 100"),
    ],
)
def test_formulas_read_as_manuals_print_them(scale: Scale, printed: str) -> None:
    assert formula(scale) == printed


@pytest.mark.slow
def test_python_agrees_with_the_model_and_both_are_bounded() -> None:
    """At the limits of the schema too, a quantity fits in the 38 digits of a decimal in Arrow, and in 64 bits in C."""
    shape = load_schema("device")["$defs"]["scale"]["properties"]
    highest, offset = shape["numerator"]["maximum"], shape["offset"]["maximum"]
    assert (shape["denominator"]["maximum"], shape["offset"]["minimum"]) == (highest, -offset)
    assert (highest << WIDEST) + offset < 1 << 63
    random_ = random.Random("scale")
    numbers = [0, 1, -1, (1 << WIDEST) - 1, -(1 << WIDEST - 1)]
    ratios = ((1, highest), (highest, 1), (highest, highest - 1))
    scales = [Scale(*ratio, shift, "V") for ratio in ratios for shift in (0, -offset)]
    for _ in range(2_000):
        limit = 10 ** random_.randrange(1, 8)
        pair = (random_.randint(1, min(limit, highest)), random_.randint(1, min(limit, highest)))
        scales.append(Scale(*pair, random_.randint(-limit, limit), "V"))
    for scale in scales:
        python_scale = in_python(scale)
        assert python_scale.places == scale.places <= 24
        for number in (*numbers, random_.randint(-100_000, 100_000)):
            text = scale.decimal(number)
            assert f"{python_scale.decimal(number):f}" == text
            assert len(text.replace("-", "").replace(".", "")) <= 38
            error = abs(Fraction(text) - scale.quantity(number))
            assert (error == 0) == scale.is_exact(number)
            assert python_scale.quantity(number) == scale.quantity(number)
            assert error * 20 <= Fraction(scale.numerator, scale.denominator)


def decode(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["decode", *arguments, "--specs", str(ENCODERS)]) == 0
    return capsys.readouterr().out


@pytest.mark.slow
def test_decode_shows_the_quantity_beside_the_number(capsys: pytest.CaptureFixture[str]) -> None:
    frame = ("OrbisSerial-14", "74 00 03 F5 54", "--layout", "temperature_reply")
    assert "bytes 3-4      temperature  0xf554  -2732 (-273.2 °C)" in decode(capsys, *frame)
    register = ("TLE5012B", "01 B8", "--as", "fsync")
    assert "temperature  0x1b8  -72 (≈ 28.82 °C)" in decode(capsys, *register)
    (field,) = json.loads(decode(capsys, *register, "--json"))["fields"]
    assert (field["raw"], field["value"], field["unit"]) == (0x1B8, -72, None)
    exact = {"numerator": 10_000, "denominator": 347}
    assert field["quantity"] == {"decimal": "28.82", "exact": False, **exact, "unit": "°C"}
    fields = json.loads(decode(capsys, *frame, "--json"))["fields"]
    quantities = {field["name"]: field["quantity"] for field in fields}
    assert quantities["position"] is None
    assert quantities["temperature"]["decimal"] == "-273.2"
    assert quantities["temperature"]["exact"] is True
