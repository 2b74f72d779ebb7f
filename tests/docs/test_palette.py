"""Pages, pictures and the decode page use only the colours of one file, and text on them has enough contrast."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PALETTE = ROOT / "runtime" / "browser" / "palette.css"
GENERATED = ROOT / "generated"
#: Least contrast of text according to WCAG 2.2, level AA.
LEAST_CONTRAST = 4.5
COLOUR = re.compile(r"#[0-9a-fA-F]{3,8}\b(?![-_])|\b(?:rgba?|hsla?|color-mix|lab|lch|oklch)\(")
#: Names of colours and of system colours in a declaration. In ``transparent`` and ``currentColor`` there is no colour.
NAMED = re.compile(
    r"(?:color|background|border[a-z-]*|outline|fill|stroke)\s*:[^;}\n]*?"
    r"(?<![-\w])(white|black|red|green|blue|gr[ae]y|orange|yellow|Canvas(?:Text)?|GrayText|Field(?:Text)?)(?![-\w])"
)
USED = re.compile(r"var\(--codewheel-([a-z-]+)")
DEFINED = re.compile(r"--codewheel-([a-z-]+):\s*(#[0-9a-f]{6});")
STYLED = (
    *sorted((ROOT / "docs" / "site").rglob("*.css")),
    *sorted((ROOT / "docs" / "site").rglob("*.js")),
    *sorted((ROOT / "docs" / "site").rglob("*.py")),
    *sorted((ROOT / "docs" / "site").rglob("*.html")),
    *sorted((ROOT / "runtime" / "browser").glob("*.js")),
    *sorted((ROOT / "templates" / "browser").glob("*.jinja")),
    *sorted((ROOT / "generator" / "targets" / "docs").glob("*.py")),
)
KINDS = ("data", "flag", "active", "choice", "check", "fixed", "group", "nothing")
VERDICTS = ("usable", "warning", "not-usable", "unknown")
#: Text and its background.
PAIRS = (
    *((ink, f"bits-{kind}") for kind in KINDS for ink in ("ink", "soft-ink")),
    *((verdict, f"{verdict}-ground") for verdict in VERDICTS),
    *((verdict, ground) for verdict in VERDICTS for ground in ("page", "surface", "header")),
    *(("ink", f"{verdict}-ground") for verdict in VERDICTS),
    *((ink, ground) for ink in ("ink", "soft-ink", "link") for ground in ("page", "surface", "header", "code")),
    *(("control", ground) for ground in ("page", "surface")),
    ("link", "chosen"),
    ("ink", "chosen"),
    ("ink", "highlight"),
)


def schemes() -> dict[str, dict[str, str]]:
    """Return the colours by name on light and on dark screens."""
    light, _, dark = PALETTE.read_text(encoding="utf-8").partition("@media (prefers-color-scheme: dark)")
    colours = dict(DEFINED.findall(light))
    return {"light": colours, "dark": {**colours, **dict(DEFINED.findall(dark))}}


def luminance(colour: str) -> float:
    """Return the relative luminance of a colour as WCAG 2.2 defines it."""
    channels = [int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_contrast_of_black_and_grey_on_white_is_that_of_the_standard() -> None:
    """#767676 is the lightest grey with 4.5 on white, and #777777 the first without."""
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") >= LEAST_CONTRAST > contrast("#777777", "#ffffff")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_enough_contrast(scheme: str) -> None:
    colours = schemes()[scheme]
    contrasts = {pair: round(contrast(colours[pair[0]], colours[pair[1]]), 2) for pair in PAIRS}
    assert {pair: value for pair, value in contrasts.items() if value < LEAST_CONTRAST} == {}


def test_every_kind_and_verdict_has_its_own_colour() -> None:
    for colours in schemes().values():
        grounds = [colours[f"bits-{kind}"] for kind in KINDS] + [colours[f"{verdict}-ground"] for verdict in VERDICTS]
        assert len(set(grounds)) == len(grounds)


def test_only_the_palette_defines_colours() -> None:
    assert len(STYLED) > 30
    found = {}
    for path in STYLED:
        content = path.read_text(encoding="utf-8")
        colours = [*COLOUR.findall(content), *NAMED.findall(content)]
        if colours:
            found[path.name] = colours
    assert found == {}


def test_only_colours_of_the_palette_are_used() -> None:
    names = set(schemes()["light"])
    used = {name for path in STYLED for name in USED.findall(path.read_text(encoding="utf-8"))}
    assert {"bits-flag", "bits-check", "not-usable-ground"} <= used
    assert used - names == set()


def test_pictures_have_only_colours_of_the_palette() -> None:
    colours = {colour for scheme in schemes().values() for colour in scheme.values()}
    pictures = [*sorted((GENERATED / "docs").rglob("*.svg")), ROOT / "docs" / "front.svg"]
    assert len(pictures) > 100
    found = {}
    for path in pictures:
        # Numbers of errata or places may begin with the mark, but only colours have six digits.
        foreign = set(re.findall(r"#[0-9a-f]{6}\b", path.read_text(encoding="utf-8"))) - colours
        if foreign:
            found[path.name] = foreign
    assert found == {}


def test_the_decode_page_contains_the_palette() -> None:
    colours = DEFINED.findall(PALETTE.read_text(encoding="utf-8"))
    for name in ("decode.js", "decode.html"):
        content = (GENERATED / "browser" / name).read_text(encoding="utf-8")
        assert DEFINED.findall(content) == colours, name
