"""Every output shows only the clock, timeout, cable row, time and characteristic of the order code.

The encoder of ``ok_model/facts_by_code.yaml`` is made up: FBC12 and FBC16 differ in each of these facts. BML-S1G0 is
Balluff's: 700 kHz at most for words of 24 to 26 bits and 1,300 kHz for words of 32 bits (user's guide, Tab. 6-3). The
AMT21 of CUI Devices updates 12 bits every 25 µs and 14 bits every 100 µs (data sheet, page 1).
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from pathlib import Path

import pytest
from codewheel.changes.families import compare
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Biss, Device, Ssi
from codewheel.model.order_codes import applies_to_code
from codewheel.order_codes.reduction import reduced_to_codes
from codewheel.targets import Library
from codewheel.targets.biss.files import generate as biss_files
from codewheel.targets.c.files import generate as c_files
from codewheel.targets.docs.files import generate as pages
from codewheel.targets.python.files import generate as python_files
from codewheel_runtime.facts.interfaces import _applies_to_code

ROOT = Path(__file__).parents[2]
MADE_UP = ROOT / "tests" / "check" / "ok_model"
SPEC = MADE_UP / "facts_by_code.yaml"
FILES = [SPEC, MADE_UP / "manufacturer.yaml"]


@pytest.fixture(scope="module")
def library() -> Library:
    devices, report = load_library(FILES)
    assert not report.problems
    return Library(tuple(devices))


@pytest.fixture
def device(library: Library) -> Device:
    (device,) = library.devices
    return device


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main([*arguments, "--specs", str(MADE_UP)]) == 0
    return " ".join(capsys.readouterr().out.split())


def test_the_model_has_no_clock_for_all_order_codes(device: Device) -> None:
    ssi, biss = device.interface("ssi"), device.interface("biss")
    assert isinstance(ssi, Ssi)
    assert isinstance(biss, Biss)
    assert (ssi.clock, biss.clock, biss.timeout) == (None, None, None)
    assert [ssi.clock_of(code).max_hz for code in ("FBC12-BG", "FBC16-BG")] == [2_000_000, 1_000_000]
    timeout = biss.timeout_of("FBC16-SC")
    assert timeout is not None
    assert timeout.at_most_ns == 20_000


def test_a_reduced_device_has_the_facts_of_its_order_codes(device: Device) -> None:
    reduced = reduced_to_codes(device, ["FBC16-BG", "FBC16-SC"])
    ssi = reduced.interface("ssi")
    assert isinstance(ssi, Ssi)
    assert ssi.clock is not None
    assert (ssi.clock.max_hz, ssi.clock.only) == (1_000_000, "")
    assert [(row.shorter_than_m, row.below_hz, row.only) for row in ssi.cable_lengths] == [
        (50, 400_000, ""),
        (100, 200_000, ""),
    ]
    assert [timing.at_least_us for timing in ssi.timings] == [20]
    assert [fact.value for fact in reduced.characteristics] == ["About 130 g"]


@pytest.mark.parametrize(
    ("code", "own", "others"),
    [
        ("FBC12-BG", ["100 kHz to 2 MHz", "below 800 kHz", "at least 12 µs"], ["1 MHz", "400 kHz", "20 µs"]),
        ("FBC16-BG", ["100 kHz to 1 MHz", "below 400 kHz", "at least 20 µs"], ["2 MHz", "800 kHz", "12 µs"]),
        ("FBC12-SC", ["50 kHz to 10 MHz", "1.5 clock periods"], ["5 MHz", "20 µs"]),
        ("FBC16-SC", ["200 kHz to 5 MHz", "fixed, at most 20 µs"], ["10 MHz", "1.5 clock periods"]),
    ],
)
def test_show(capsys: pytest.CaptureFixture[str], code: str, own: list[str], others: list[str]) -> None:
    text = run(capsys, "show", code)
    assert [words for words in own if words not in text] == []
    assert [words for words in others if words in text] == []


def test_show_of_the_family_lists_the_order_codes(capsys: pytest.CaptureFixture[str]) -> None:
    text = run(capsys, "show", "facts_by_code")
    assert "100 kHz to 2 MHz (only with FBC12...)" in text
    assert "below 400 kHz with cables shorter than 50 m (only with FBC16...)" in text
    assert "fixed, at most 20 µs (only with FBC16...)" in text


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    interfaces = json.loads(run(capsys, "show", "FBC16-SC", "--json"))["interfaces"]
    assert interfaces["biss"]["clock"]["max_hz"] == 5_000_000
    assert interfaces["biss"]["timeout"]["at_most_ns"] == 20_000
    assert (interfaces["biss"]["clocks"], interfaces["biss"]["timeouts"]) == ([], [])
    interfaces = json.loads(run(capsys, "show", "facts_by_code", "--json"))["interfaces"]
    assert (interfaces["biss"]["clock"], interfaces["biss"]["timeout"]) == (None, None)
    clocks = [(clock["only"], clock["max_hz"]) for clock in interfaces["ssi"]["clocks"]]
    assert clocks == [("FBC12...", 2_000_000), ("FBC16...", 1_000_000)]


def record_of(capsys: pytest.CaptureFixture[str], code: str, *more: str) -> dict[str, object]:
    record: dict[str, object] = json.loads(run(capsys, "master", code, "--json", *more))["record"]
    return record


def test_masters(capsys: pytest.CaptureFixture[str]) -> None:
    numbers = ("clock_min_hz", "clock_max_hz", "pause_us", "timeout_us")
    values = {code: record_of(capsys, code) for code in ("FBC12-BG", "FBC16-BG", "FBC12-SC", "FBC16-SC")}
    assert {code: tuple(record[number] for number in numbers) for code, record in values.items()} == {
        "FBC12-BG": (100_000, 2_000_000, 12, None),
        "FBC16-BG": (100_000, 1_000_000, 20, None),
        # Three half periods at 50 kHz.
        "FBC12-SC": (50_000, 10_000_000, None, 30),
        "FBC16-SC": (200_000, 5_000_000, None, 20),
    }
    assert record_of(capsys, "FBC12-BG", "--cable", "30")["clock_max_hz"] == 799_999
    assert record_of(capsys, "FBC16-BG", "--cable", "30")["clock_max_hz"] == 399_999
    assert record_of(capsys, "FBC16-BG", "--cable", "70")["clock_max_hz"] == 199_999


def test_files_for_masters(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--master", "beckhoff_ax5000", "--format", "soe_structure"]
    for code, clock_khz in (("FBC12-SC", 10_000), ("FBC16-SC", 5_000)):
        assert f";{clock_khz};" in run(capsys, "master", code, *arguments)


def test_c(library: Library) -> None:
    files = c_files(library)
    header = files["c/include/acme/facts_by_code_ssi.h"]
    assert "ACME_FACTS_BY_CODE_SSI_CLOCK_MAX_HZ" not in header
    for macro in ("FBC12_BG_CLOCK_MAX_HZ 2000000U", "FBC16_BG_CLOCK_MAX_HZ 1000000U", "FBC16_BG_PAUSE_AT_LEAST_US 20U"):
        assert f"#define ACME_FACTS_BY_CODE_SSI_{macro}" in header


def test_python(library: Library, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, text in python_files(library).items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path / "python"))
    # Another test may have imported a package of this name.
    for module in [name for name in sys.modules if name.partition(".")[0] == "acme_encoders"]:
        monkeypatch.delitem(sys.modules, module)
    family = import_module("acme_encoders.facts_by_code")
    encoders = {code: family.lookup(code) for code in family.VARIANTS}
    clocks = {code: encoder.clock.max_hz for code, encoder in encoders.items()}
    assert clocks == {"FBC12-BG": 2_000_000, "FBC12-SC": 10_000_000, "FBC16-BG": 1_000_000, "FBC16-SC": 5_000_000}
    assert encoders["FBC12-SC"].timeout.nanoseconds(1_000_000) == 1500
    assert encoders["FBC16-SC"].timeout.nanoseconds(1_000_000) == 20_000
    assert encoders["FBC12-BG"].timeout is None
    facts = family.SSI.for_code("FBC16-BG")
    assert (facts.clock_below_hz(30), facts.clock_below_hz(70), facts.clock_below_hz(100)) == (400_000, 200_000, None)
    assert [timing.at_least_us for timing in facts.timings] == [20]
    # The facts of the family have no limit that is wrong for an order code.
    assert (family.SSI.clock.min_hz, family.SSI.clock.max_hz, family.SSI.clock_below_hz(30)) == (None, None, 200_000)
    for name in [name for name in sys.modules if name.startswith("acme_encoders")]:
        del sys.modules[name]


def test_python_and_the_model_read_the_same_order_codes(every_encoder: Library) -> None:
    """The package contains no part of the tool, so it matches the patterns of ``only`` itself."""
    matches = set()
    for device in every_encoder.devices:
        if device.manufacturer.name not in ("balluff", "cui", "lika"):
            continue
        characteristics = {fact.only for fact in device.characteristics}
        clocks = {clock.only for interface in device.interfaces for clock in getattr(interface, "clocks", ())}
        errata = {erratum.only for erratum in device.errata}
        for only in characteristics | clocks | errata | {"", "AMM5x21/…, AMM5A17/1", "x"}:
            for variant in device.variants:
                is_match = applies_to_code(only, variant.code)
                assert _applies_to_code(only, variant.code) is is_match, (only, variant.code)
                matches.add((only, is_match))
    assert len(matches) > 30


def test_xml(library: Library) -> None:
    text = biss_files(library)["biss/acme-facts_by_code.xml"]
    assert '<clock min_hz="100000" max_hz="1000000" only="FBC16...">' in text
    assert '<timeout rule="fixed" at_most_ns="20000" only="FBC16...">' in text
    assert '<cable_length shorter_than_m="50" below_hz="800000" only="FBC12...">' in text


def test_pages(library: Library) -> None:
    files = pages(library)
    assert "100 kHz to 1 MHz (only with FBC16...)" in files["docs/facts_by_code.md"]
    page = files["docs/facts_by_code/FBC16-BG.md"]
    assert "Clock: 100 kHz to 1 MHz" in page
    assert "| 50 m | 400 kHz |" in page
    assert "2 MHz" not in page
    assert "fixed, at most 20 µs" in files["docs/facts_by_code/FBC16-SC.md"]


def load_edited(tmp_path: Path, *edits: tuple[str, str]) -> tuple[list[Device], list[str]]:
    """Return the made-up family with other texts in its spec, and the messages about it."""
    text = SPEC.read_text(encoding="utf-8")
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / SPEC.name).write_text(text, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_bytes(FILES[1].read_bytes())
    devices, report = load_library([tmp_path])
    return list(devices), [f"{problem.rule}: {problem.message}" for problem in report.problems]


def edited(tmp_path: Path, *edits: tuple[str, str]) -> Device:
    devices, messages = load_edited(tmp_path, *edits)
    assert messages == []
    return devices[0]


ERRATUM = """\
errata:
  - name: one
    title: The manual leaves something out
    source: "5"
    printed: Nothing.
    used: Nothing.
    why: No other source.
    status: open
    severity: omission
    affects: [{affected}]
evidence:"""
SECOND_TIMEOUT = """\
      - {rule: fixed, at_most_ns: 20000, only: FBC16..., source: "6.3"}
"""


def test_a_manual_may_give_the_time_out_of_some_order_codes_only(tmp_path: Path) -> None:
    _, messages = load_edited(tmp_path, (SECOND_TIMEOUT, ""))
    assert [message[:60] for message in messages] == ["only-gap: the order code 'FBC16-SC' has no timeout; extend '"]
    erratum = ("evidence:", ERRATUM.format(affected="interfaces.biss.timeout"))
    device = edited(tmp_path, (SECOND_TIMEOUT, ""), erratum)
    biss = device.interface("biss")
    assert isinstance(biss, Biss)
    assert biss.timeout is None
    assert biss.timeout_of("FBC16-SC") is None
    assert biss.timeout_of("FBC12-SC") is not None


def test_an_erratum_can_affect_a_limit_of_one_of_several_clocks(tmp_path: Path) -> None:
    faster_cable = ("below_hz: 800000", "below_hz: 2800000")
    _, messages = load_edited(tmp_path, faster_cable)
    affected = "interfaces.ssi.clock.max_hz"
    assert len(messages) == 1
    assert messages[0].endswith(f"add an erratum that affects {affected}")
    edited(tmp_path, faster_cable, ("evidence:", ERRATUM.format(affected=affected)))


def test_two_clocks_for_all_order_codes_are_a_problem(tmp_path: Path) -> None:
    clocks = (
        ("max_hz: 2000000, only: FBC12...", "max_hz: 2000000"),
        ("max_hz: 1000000, only: FBC16...", "max_hz: 1000000"),
    )
    _, messages = load_edited(tmp_path, *clocks)
    assert [message.partition(", on line")[0] for message in messages] == [
        "only-overlap: the order code 'FBC12-BG' and 1 other already have a clock"
    ]


def test_a_misspelt_key_of_a_clock_is_not_also_a_gap(tmp_path: Path) -> None:
    _, messages = load_edited(tmp_path, ("max_hz: 1000000,", "maxhz: 1000000,"))
    assert [message.partition(":")[0] for message in messages] == ["unknown-key"]


def test_rules_about_two_limits_compare_those_of_the_same_order_codes(tmp_path: Path) -> None:
    """20 µs is less than half a period of 20 kHz, but only FBC12 has that clock, and it has another timeout."""
    edited(tmp_path, ("{min_hz: 50000,", "{min_hz: 20000,"))
    _, messages = load_edited(tmp_path, ("{min_hz: 200000,", "{min_hz: 20000,"))
    assert [message.partition(":")[0] for message in messages] == ["timeout-mismatch"]


OVERLAY = """\
codewheel: 1
overlay: faster
of: facts_by_code
title: A letter
documents:
  letter: {title: Letter of the manufacturer}
changes:
  - {set: "interfaces.ssi.clock[2].max_hz", to: 1500000, why: The letter says so., source: "letter: p.1"}
"""


def test_an_overlay_changes_the_clock_of_some_order_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edited(tmp_path)
    (tmp_path / "faster.overlay.yaml").write_text(OVERLAY, encoding="utf-8")
    assert main(["show", "FBC16-BG", "--specs", str(tmp_path)]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "100 kHz to 1.5 MHz" in text
    assert "In the spec: the max hz of row 2 of the SSI clock: 1000000." in text
    assert main(["show", "FBC12-BG", "--specs", str(tmp_path)]) == 0
    assert "100 kHz to 2 MHz" in capsys.readouterr().out


def test_second_readings_compare_the_facts_of_each_order_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second reader wrote the order codes in another way, and misread one number of each kind."""
    device = edited(tmp_path)
    text = SPEC.read_text(encoding="utf-8")
    for key in ("manufacturer: acme\n", "evidence: {grade: manual, documents: {manual: all pages}}\n"):
        text = text.replace(key, "")
    second = tmp_path / f"{device.name}.second.yaml"
    # The order codes of a characteristic are compared as text.
    interfaces, characteristics = text.split("characteristics:")
    interfaces = interfaces.replace("only: FBC16...", 'only: "...16-BG, ...16-SC"')
    second.write_text(f"{interfaces}characteristics:{characteristics}", encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 0
    capsys.readouterr()
    misread = {
        "max_hz: 1000000,": "max_hz: 1500000,",
        "below_hz: 400000": "below_hz: 500000",
        "at_most_ns: 20000": "at_most_ns: 30000",
        "at_least_us: 20": "at_least_us: 21",
    }
    for right, wrong in misread.items():
        text = text.replace(right, wrong)
    second.write_text(text, encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 1
    problems = [line for line in capsys.readouterr().out.splitlines() if "readings-disagree: " in line]
    assert [line.partition("readings-disagree: ")[2].partition(" in ")[0] for line in problems] == [
        "highest clock over SSI, for FBC16-BG: 1000000 Hz here, 1500000 Hz",
        "clock for a cable shorter than 50 m, for FBC16-BG: below 400000 Hz here, below 500000 Hz",
        "time Tp over SSI, 'at_least_us': 20 µs here, 21 µs",
        "upper bound of the timeout over BiSS: 20000 ns here, 30000 ns",
    ]


def test_diff_names_the_order_codes(device: Device, tmp_path: Path) -> None:
    new = edited(
        tmp_path,
        ("max_hz: 1000000,", "max_hz: 1500000,"),
        ("at_most_ns: 20000", "at_most_ns: 30000"),
        ("at_most_us: 300000", "at_most_us: 400000"),
        ("About 130 g", "About 140 g"),
    )
    changes = [(change.rule.name, change.text, change.codes) for change in compare([device], [new])]
    codes = ("FBC12-BG", "FBC12-SC", "FBC16-BG", "FBC16-SC")
    assert changes == [
        (
            "interface-rule",
            "BiSS: timeout at_most_ns = 20000 → at_most_ns = 30000",
            ("FBC16-SC",),
        ),
        ("time-limit", "time startup, FBC16...: at most 300 ms → 400 ms", codes),
        ("clock-wider", "SSI: highest clock 1 MHz → 1.5 MHz", ("FBC16-BG",)),
        ("told", "characteristic weight, FBC16...: About 130 g → About 140 g", codes),
    ]


def test_balluff_by_word_length() -> None:
    devices, report = load_library([ROOT / "specs" / "balluff"])
    assert not report.problems
    ssi = devices[0].interface("ssi")
    assert isinstance(ssi, Ssi)
    clocks = {variant.code: ssi.clock_of(variant.code).max_hz for variant in devices[0].variants_over("ssi")}
    assert {code[:12]: clock for code, clock in clocks.items()} == {
        "BML-S1G0-S24": 700_000,
        "BML-S1G0-S25": 700_000,
        "BML-S1G0-S26": 700_000,
        "BML-S1G0-S32": 1_300_000,
    }


@pytest.mark.parametrize(("code", "update"), [("AMT212A", "25 µs"), ("AMT213D", "100 µs")])
def test_amt21_by_resolution(capsys: pytest.CaptureFixture[str], code: str, update: str) -> None:
    assert main(["show", code, "--json", "--specs", str(ROOT / "specs" / "cui")]) == 0
    characteristics = json.loads(capsys.readouterr().out)["characteristics"]
    updates = [fact["value"] for fact in characteristics if fact["name"] == "position_update"]
    assert updates == [f"Position updated every {update}"]
