"""Facts that the file of a manufacturer lists as alike are compared, even if both readings are wrong."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from codewheel.commands.outputs import load_for_targets, targets_named
from codewheel.language.problems import Problem

LIKA = Path(__file__).parents[2] / "specs" / "lika"
#: Family, others with the same fact, two texts as printed that are exchanged (AMM5 4.1.2, AM36 4.2, ASC85 4.1, SMA21
#: 4.1), and the message.
EXCHANGED = [
    (
        "am36",
        ["asc85"],
        "{contact: Yellow,",
        "{contact: Blue,",
        "'clock in-' is on contact 'Blue' here, but on 'Yellow'",
    ),
    ("asc85", ["am36"], "signal: 0Vdc}", "signal: +Vdc}", "'0 V' is on contact '2' here, but on '1' in am36"),
    ("amm5", ["sma21"], "{contact: Brown_Green,", "{contact: White_Green,", "'+V' is on contact 'Brown_Green' here"),
    ("sma21", ["amm5"], "{contact: Red,", "{contact: Black,", "'b' is on contact 'Black' here, but on 'Red' in amm5"),
    # One of them is exchanged with a colour that the cable does not have.
    ("asc85", ["am36"], "{contact: Grey,", "{contact: Violet,", "only one of this cable and the one in am36"),
    # AMM5 7.1: 2.5 Mbaud
    ("sma21", ["amm5"], "baud: 2500000", "baud: 250000", "this is 250000, but 2500000 in amm5.yaml:"),
    # AMM5 5.3, AM36 5.3, ASC85 5.3, SMA21 5.3: the same lengths. AMM5 6.5, AM36 6.6, ASC85 6.5, SMA21 6.5: 10 MHz
    ("am36", ["amm5", "asc85"], "shorter_than_m: 100,", "shorter_than_m: 10,", "this is 10, but 100 in amm5.yaml:"),
    ("asc85", ["am36"], "max_hz: 10000000", "max_hz: 1000000", "this is 1000000, but 10000000 in am36.yaml:"),
]


def copy_specs(folder: Path, *families: str) -> None:
    """Copy the manufacturer and families without their second readings: other families take time, and agree."""
    folder.mkdir()
    for name in ("manufacturer", *families):
        shutil.copy(LIKA / f"{name}.yaml", folder)


def exchanged(text: str, first: str, second: str) -> str:
    return text.replace(first, "\0").replace(second, first).replace("\0", second)


def unlike_parts(folder: Path) -> list[Problem]:
    _, report = load_for_targets([folder], targets_named())
    return [problem for problem in report.problems if problem.rule == "not-alike"]


@pytest.mark.one_in(8, "slow")
@pytest.mark.parametrize(("family", "others", "first", "second", "message"), EXCHANGED)
def test_a_mistake_in_both_readings_is_reported(
    tmp_path: Path, family: str, others: list[str], first: str, second: str, message: str
) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, family, f"{family}.second", *others)
    for name in (f"{family}.yaml", f"{family}.second.yaml"):
        text = (folder / name).read_text(encoding="utf-8")
        assert first in text
        (folder / name).write_text(exchanged(text, first, second), encoding="utf-8")
    problems = unlike_parts(folder)
    assert [problem for problem in problems if message in problem.message]


@pytest.mark.one_in(3, "slow")
@pytest.mark.parametrize(
    ("family", "others", "old", "new", "message"),
    [
        (
            "asc85",
            ["am36"],
            "    network: {topology: point_to_point, multiple_slaves: false, source: 6 p.19}\n",
            "",
            "this is nothing, but point_to_point in am36.yaml:",
        ),
        # Most devices have the length.
        (
            "am36",
            ["amm5", "asc85"],
            '      - {shorter_than_m: 200, below_hz: 200000, source: "5.3"}\n',
            "",
            "this is 400, but 200 in amm5.yaml:",
        ),
        ("sma21", ["amm5"], "typical_us: 12\n", "typical_us: 11\n", "this is 11, but 12 in amm5.yaml:"),
    ],
)
def test_a_fact_that_differs_or_is_missing_in_one_device_is_reported(
    tmp_path: Path, family: str, others: list[str], old: str, new: str, message: str
) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, family, *others)
    spec = folder / f"{family}.yaml"
    text = spec.read_text(encoding="utf-8")
    assert text.count(old) == 1
    spec.write_text(text.replace(old, new), encoding="utf-8")
    (problem,) = unlike_parts(folder)
    assert problem.message.startswith(message)


@pytest.mark.one_in(2, "slow")
@pytest.mark.parametrize(
    ("other", "printed", "mistake", "place"),
    [
        ("am36", "max_hz: 10000000", "max_hz: 5000000", "interfaces.biss.clock.max_hz"),
        # Errata omit the key of the list.
        ("amm5", "typical_us: 12\n", "typical_us: 11\n", "interfaces.ssi.monoflop"),
    ],
)
def test_an_erratum_explains_a_fact_that_differs(
    tmp_path: Path, other: str, printed: str, mistake: str, place: str
) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, other, "sma21")
    spec = folder / "sma21.yaml"
    text = spec.read_text(encoding="utf-8").replace(printed, mistake)
    spec.write_text(text, encoding="utf-8")
    (problem,) = unlike_parts(folder)
    assert f"add an erratum that affects {place}, or" in problem.message
    affects = f"affects: [{place}, interfaces.biss.single_cycle_data]"
    text = text.replace("affects: [interfaces.biss.single_cycle_data]", affects, 1)
    spec.write_text(text, encoding="utf-8")
    assert unlike_parts(folder) == []


@pytest.mark.slow
def test_an_erratum_explains_a_contact_that_differs(tmp_path: Path) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, "am36", "asc85")
    spec = folder / "asc85.yaml"
    text = exchanged(spec.read_text(encoding="utf-8"), "{contact: Yellow,", "{contact: Blue,")
    spec.write_text(text, encoding="utf-8")
    assert len(unlike_parts(folder)) == 2
    place = "connectors.m8_cable.contacts"
    affects = f"affects: [{place}, connectors.m12_connector,"
    spec.write_text(text.replace("affects: [connectors.m12_connector,", affects), encoding="utf-8")
    _, report = load_for_targets([folder], targets_named())
    assert list(report.problems) == []


@pytest.mark.slow
def test_exchanged_wires_are_one_problem(tmp_path: Path) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, "am36", "asc85")
    spec = folder / "asc85.yaml"
    text = exchanged(spec.read_text(encoding="utf-8"), "{contact: Yellow,", "{contact: Blue,")
    spec.write_text(text, encoding="utf-8")
    _, report = load_for_targets([folder], targets_named())
    (problem,) = report.by_cause
    assert "'clock in+' is on contact 'Blue' here, but on 'Yellow' in am36.yaml:" in problem.message


@pytest.mark.slow
def test_an_erratum_that_one_device_has_explains_a_fact_about_which_both_have_another_erratum(tmp_path: Path) -> None:
    """All manuals list cable lengths that do not fit the clock. AM36 lists fewer, which is another erratum."""
    folder = tmp_path / "lika"
    copy_specs(folder, "am36", "amm5", "asc85")
    spec = folder / "am36.yaml"
    text = spec.read_text(encoding="utf-8")
    text = text.replace('      - {shorter_than_m: 200, below_hz: 200000, source: "5.3"}\n', "")
    spec.write_text(text, encoding="utf-8")
    assert len(unlike_parts(folder)) == 1
    start, end = text.index("  - name: ssi_cable_400_m"), text.index("  - name: ssi_cable_50_m")
    erratum = text[start:end].replace("ssi_cable_400_m", "ssi_cable_200_m")
    spec.write_text(text[:end] + erratum + text[end:], encoding="utf-8")
    assert unlike_parts(folder) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("printed", "mistake", "is_reported"),
    [
        ("L-9709-9005-03-F", "L-9709-9050-03-F", True),
        ("ICHAUS/30/IC-MU_17.htm", "ICHAUS/30/IC-MU_1.htm", True),
        # A number in a name, at the same address.
        ("ika/amm36/amm36_user", "ika/amm36/amm3_user", True),
        ("AMM36 manual, English edition 1.0, Lika Electronic, the page with the serial", "AMM63 manual", False),
        # Another document under the same key.
        ("L-9709-9005-03-F, BiSS data sheet, Renishaw", "L-9709-9050-03-F, installation guide", False),
        ("SMA21 + MTA-A154 manual, Italian", "SMA22 + MTA-A154 manual, Italian", False),
    ],
)
def test_a_document_whose_digits_differ_between_specs(
    tmp_path: Path, printed: str, mistake: str, is_reported: bool
) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, "am36", "amm5")
    spec = folder / "amm5.yaml"
    text = spec.read_text(encoding="utf-8")
    assert printed in text
    spec.write_text(text.replace(printed, mistake), encoding="utf-8")
    messages = [problem.message for problem in unlike_parts(folder)]
    assert [message for message in messages if "only a number differs" in message and printed in message] == (
        messages if is_reported else []
    )
    assert bool(messages) is is_reported


@pytest.mark.slow
@pytest.mark.parametrize(
    ("printed", "mistake", "message"),
    [
        # A citation of the manual of the AMM5, whose spec contains its table of contents.
        ("amm5: 6.4 p.38; asc85", "amm5: 6.4 p.83; asc85", "amm5: section 6.4 is on pages 35 to 40 according to"),
        ("amm5: 5 p.27", "amm5: 55 p.27", "amm5: the contents have no section '55'"),
        ("AMM5A AMM5B manual", "AMM5A AMM6B manual", "only a number differs from the manual's title 'AMM5A AMM5B' in"),
        # Another edition can have other sections.
        ("English edition 1.9", "English edition 1.8", ""),
        ("English edition 1.9", "English edition 1.91", ""),
    ],
)
def test_citations_of_the_manual_of_another_spec_are_checked(
    tmp_path: Path, printed: str, mistake: str, message: str
) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, "am36", "amm5")
    spec = folder / "am36.yaml"
    text = spec.read_text(encoding="utf-8")
    assert printed in text
    text = text.replace(printed, mistake)
    if not message:
        text = text.replace("amm5: 6.4 p.38; asc85", "amm5: 6.4 p.83; asc85")
    spec.write_text(text, encoding="utf-8")
    _, report = load_for_targets([folder], targets_named())
    assert [problem.message.startswith(message) for problem in report.problems] == ([True] if message else [])


@pytest.mark.slow
def test_a_connector_that_no_device_has_is_reported(tmp_path: Path) -> None:
    folder = tmp_path / "lika"
    copy_specs(folder, "am36")
    maker = folder / "manufacturer.yaml"
    text = maker.read_text(encoding="utf-8")
    maker.write_text(text.replace("am36.m12_connector", "am36.m13_connector"), encoding="utf-8")
    _, report = load_for_targets([folder], targets_named())
    assert [problem.message for problem in report.problems] == ["'am36' has no connector or cable 'm13_connector'"]
