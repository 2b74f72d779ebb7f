"""The page on editions: the revisions of AMM5 and edition 1.1 of AM36, in every output and on the page."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.dump.plain import device_dump
from codewheel.language.problems import ProblemReport
from codewheel.loading import library as loading
from codewheel.loading.library import in_edition
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.docs.files import generate as generate_docs
from python_path import python_path
from xml_reader import from_xml

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
SPECS = ROOT / "specs" / "lika"
CHAPTER = (ROOT / "docs/transcribe/how-to-revise.md").read_text(encoding="utf-8")
#: The part of the chapter on editions.
PAGE = CHAPTER.partition("\n## Editions")[2].partition("\n## Overlays")[0]
#: The revision table of the manual: the editions before the spec's.
OLD = "1.0 1.1 1.2 1.3 1.4 1.5 1.6 1.7 1.8".split()
TITLES = {"SSI": "ssi", "BiSS": "biss", "RS-485": "rs485"}


def fences(word: str) -> list[str]:
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return [text for kind, text in blocks if kind == word]


def edition(name: str, revision: str) -> Device:
    families, report = loading.load_families([SPECS / f"{name}.yaml"])
    family = in_edition(families[0], revision, report)
    assert family is not None
    assert report.problems == ()
    return family.device


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All outputs of the specs with each older edition of AMM5, and with edition 1.1 of AM36."""
    out = tmp_path_factory.mktemp("out")
    editions = [*(f"amm5={revision}" for revision in OLD), "am36=1.1", "sma21=1.0"]
    options = [f"--edition={edition}" for edition in editions]
    assert main(["generate", str(SPECS), "-o", str(out), *options]) == 0
    return out


def test_the_yaml_is_that_of_the_spec() -> None:
    (example,) = fences("yaml")
    lines = example.splitlines()
    spec = (SPECS / "amm5.yaml").read_text(encoding="utf-8")
    assert lines[0] in spec.splitlines()
    assert "\n".join(lines[1:]) in spec


def test_commands_print_what_is_shown(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    examples = fences("")
    assert len(examples) == 2
    for text in examples:
        command, _, printed = text.removeprefix("$ ").partition("\n")
        main(shlex.split(command)[1:])
        captured = capsys.readouterr()
        assert captured.out + captured.err == printed


@pytest.mark.parametrize("revision", OLD)
def test_the_story_is_what_the_editions_are(revision: str) -> None:
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| {revision} |")]
    _, _, date, codes, interfaces, registers, procedures, *_ = (cell.strip() for cell in row.split("|"))
    device = edition("amm5", revision)
    assert device.manual.date == date
    assert len(device.variants) == int(codes)
    assert {interface.name for interface in device.interfaces} == {TITLES[word] for word in interfaces.split(", ")}
    assert (len(device.registers), len(device.procedures)) == (int(registers), int(procedures))


def test_dates_and_changes_are_those_of_the_revision_table() -> None:
    """By the last page of the manual, in the form of the spec."""
    families, _ = loading.load_families([SPECS / "amm5.yaml"])
    history = {release.revision: release.date for release in families[0].device.manual.history}
    assert list(history) == [*OLD, "1.9"]
    assert {release.revision: release.date for release in families[0].device.editions} == history
    assert (history["1.7"], history["1.4"]) == ("2020-05-06", "2019-07-31")


def test_the_year_of_am36(capsys: pytest.CaptureFixture[str]) -> None:
    """The imprint of 1.0 has a copyright of 2014 and no date."""
    assert main(["show", "am36"]) == 0
    assert "revision 1.0 of 2014, in English" in capsys.readouterr().out
    assert edition("am36", "1.1").manual.date == ""


def test_what_the_table_says_of_each_revision() -> None:
    assert {variant.parts["mount"] for variant in edition("amm5", "1.7").variants} == {"A"}
    assert {variant.parts["mount"] for variant in edition("amm5", "1.8").variants} == {"A", "B"}
    for revision in OLD:
        device = edition("amm5", revision)
        at = {register.address for register in device.registers}
        assert (0x44 in at) == (0x78 in at) == (revision >= "1.7"), revision
        assert (0x77 in at) == (revision >= "1.4"), revision
        errata = [erratum for erratum in device.errata if erratum.edition == "before 1.4" and "3Bh" in erratum.printed]
        assert len(errata) == (revision < "1.4"), revision
        assert all(erratum.used == "not known" for erratum in errata)
        # "To-be-updated" information removed, with 1.3.
        marked = [erratum.used for erratum in device.errata if erratum.edition == "before 1.3"]
        assert marked == ["not known"] * (revision < "1.3"), revision
        pins = {contact.contact for connector in device.connectors for contact in connector.contacts}
        assert ("1" in pins) == (revision >= "1.5"), revision
        assert bool(device.leds) == (revision >= "1.1"), revision


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize(
    ("edition_arguments", "phrase", "not_said"),
    [
        (
            [],
            "November 2023, but that an older encoder may have. Its cause is not known",
            "this encoder does not have it",
        ),
        (
            ["--edition", "1.1"],
            "November 2023, but that an older encoder may have. Its cause is not known",
            "does not have it",
        ),
        (["--edition", "1.0"], "(Encoder inharmonious error): encoder inharmonious error.", "removed"),
        # The day before edition 1.1.
        (["--edition", "2023-11-09"], "(Encoder inharmonious error): encoder inharmonious error.", "removed"),
    ],
)
def test_the_alarm_that_sma21_had(
    edition_arguments: list[str], phrase: str, not_said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bit 3 of ALMC, which 1.1 of 2023-11-10 removed. The CRC is the XOR of the bytes: 8Bh."""
    assert main(["decode", "SMA21-JP1-0050", "A2 20 01 00 00 08 8B", *edition_arguments]) == 3
    report = " ".join(capsys.readouterr().out.split()).split("the encoder reports:")[1]
    assert phrase in report
    assert not_said not in report
    assert report.endswith("so the position is not usable evidence: manual")


def test_editions_of_sma21() -> None:
    """Implemented only before 1.1. Panasonic® is named since 1.2."""
    for revision, has_alarm in (("1.0", True), ("1.1", False)):
        device = edition("sma21", revision)
        assert [alarm.implemented for alarm in device.alarms if alarm.name == "encoder_inharmonious_error"] == [
            has_alarm
        ]
        (output,) = [part for part in device.order_code.parts if part.name == "output"]
        assert ["Panasonic" in value.meaning for value in output.values if value.text == "JP"] == [False]


@pytest.mark.exhaustive
def test_nothing_is_filled_in_for_the_old_serial_number(generated: Path) -> None:
    """Neither order of its bytes has a name in any language."""
    headers = sorted((generated / "c" / "include" / "lika").glob("amm5_1_6_*.h"))
    in_c = "".join(path.read_text(encoding="utf-8") for path in headers)
    assert "REG_MANUFACTURER_ID" in in_c
    assert "REG_SERIAL_NUMBER" not in in_c
    texts = [
        (generated / "python" / "lika_encoders" / "amm5_1_6.py").read_text(encoding="utf-8"),
        "".join(path.read_text(encoding="utf-8") for path in sorted((generated / "docs" / "amm5_1_6").glob("*.md"))),
    ]
    for text in texts:
        assert "The table does not give their earlier content" in " ".join(text.replace("\n *", "\n").split())
        assert not re.search(r"REG_SERIAL_NUMBER|class SerialNumber|register-serial_number", text)
    header = (generated / "c/include/lika/amm5_biss_registers.h").read_text(encoding="utf-8")
    assert "LIKA_AMM5_BISS_REG_SERIAL_NUMBER_ADDRESS 0x44U" in header


@pytest.mark.exhaustive
def test_each_edition_is_in_each_output(generated: Path) -> None:
    for name, revision in [*(("amm5", revision) for revision in OLD), ("am36", "1.1"), ("sma21", "1.0")]:
        stem = f"{name}_{revision.replace('.', '_')}"
        device = edition(name, revision)
        xml = (generated / "biss" / f"lika-{stem}.xml").read_bytes()
        assert from_xml(xml) == device_dump(device)
        for path in (f"c/include/lika/{stem}_biss.h", f"python/lika_encoders/{stem}.py", f"docs/{stem}.md"):
            flat = " ".join((generated / path).read_text(encoding="utf-8").replace("\n *", "\n").split())
            date = f" of {device.manual.date}" if device.manual.date else ""
            about = f"This describes encoders of edition {revision} of the manual{date}, as far as they are known"
            assert about in flat, path
    identity = (generated / "biss" / "idbiss4C69.xml").read_text(encoding="utf-8")
    shipped = (ROOT / "generated" / "biss" / "idbiss4C69.xml").read_text(encoding="utf-8")
    assert identity == shipped


@pytest.mark.exhaustive
def test_the_files_of_the_spec_stay_as_they_are(generated: Path) -> None:
    for path in (
        "c/include/lika/amm5_biss.h",
        "c/include/lika/am36_biss.h",
        "python/lika_encoders/amm5.py",
        "docs/amm5.md",
    ):
        assert (generated / path).read_bytes() == (ROOT / "generated" / path).read_bytes(), path


@pytest.mark.exhaustive
def test_python_has_the_editions_side_by_side(generated: Path) -> None:
    program = """
import lika_encoders as lika
new, old = lika.lookup("AMM5A21/65KSC1"), lika.amm5_1_6.lookup("AMM5A21/65KSC1")
assert isinstance(new, lika.amm5.Variant) and isinstance(old, lika.amm5_1_6.Variant)
assert new.decode(0xF4243D3).position == old.decode(0xF4243D3).position == 1000003
assert str(lika.amm5.SerialNumber.decode(bytes.fromhex("0ae869ee"))).endswith("week=30, number=3630)")
assert not hasattr(lika.amm5_1_6, "SerialNumber") and not hasattr(lika.amm5_1_3, "set_preset")
unknown = {"AMM5B21/65KSC1": lika.amm5_1_7, "AMM5A21/65KJP1": lika.amm5_1_5, "AM3616/4096-BG": lika.am36_1_1}
for label, module in unknown.items():
    lika.lookup(label)
    try:
        module.lookup(label)
    except lika.OrderCodeError:
        continue
    raise AssertionError(label)
assert lika.identify({"manufacturer_id": b"Li"}) == tuple(dict.fromkeys(lika.identify({"manufacturer_id": b"Li"})))
"""
    environment = {**os.environ, "PYTHONPATH": python_path(generated / "python")}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True)


@pytest.mark.exhaustive
def test_c_has_the_editions_side_by_side(generated: Path, tmp_path: Path) -> None:
    names = ["amm5", "am36", "am36_1_1", *(f"amm5_{revision.replace('.', '_')}" for revision in OLD)]
    program = tmp_path / "all.c"
    include = generated / "c" / "include"
    headers = [path.name for name in names for path in sorted((include / "lika").glob(f"{name}_[bsr]*.h"))]
    assert len(headers) > 100
    program.write_text("".join(f'#include "lika/{name}"\n' for name in headers) + "int main(void) { return 0; }\n")
    strict = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{include}", "-fsyntax-only"]
    subprocess.run([*strict, program], check=True)
    program.write_text(
        '#include "lika/amm5_1_6_biss_registers.h"\nint a = LIKA_AMM5_1_6_BISS_REG_SERIAL_NUMBER_ADDRESS;\n'
    )
    refused = subprocess.run([*strict, program], check=False, capture_output=True, text=True)
    assert refused.returncode != 0
    assert "LIKA_AMM5_1_6_BISS_REG_SERIAL_NUMBER_ADDRESS" in refused.stderr


def test_am36_1_1_is_what_six_pages_say() -> None:
    """Pages 21, 22, 24, 29 and 30: order codes, frame, addresses, resolution, preset."""
    device = edition("am36", "1.1")
    assert {variant.parts["output"] for variant in device.variants} == {"I7"}
    assert {(variant.parts["singleturn"], variant.parts["turns"]) for variant in device.variants} == {
        ("16", "4096"),
        ("19", "4096"),
    }
    assert [interface.name for interface in device.interfaces] == ["biss"]
    assert {(register.address, register.length) for register in device.registers} == {
        (0x49, 1), (0x4B, 3), (0x4E, 2), (0x50, 5), (0x56, 1), (0x57, 1)
    }  # fmt: skip
    assert (device.crc("biss_6").poly, device.crc("biss_4").poly) == (0x03, 0x3)
    assert device.register("information_per_revolution").default == 0x100000
    assert device.procedures == () == device.connectors == device.inputs
    assert device.register("configuration").note.startswith("For edition 1.1, only two facts are known")


@pytest.mark.parametrize(
    ("arguments", "phrase"),
    [
        (["--edition", "2020-04-30"], "This describes encoders of edition 1.6 of the manual"),
        (["--edition", "2018-08-10"], "This describes encoders of edition 1.0 of the manual"),
        (["--edition", "1.9"], "manual AMM5A AMM5B, revision 1.9"),
        (["--edition", "2026-01-01"], "manual AMM5A AMM5B, revision 1.9"),
    ],
)
def test_an_edition_is_chosen_by_revision_or_date(
    arguments: list[str], phrase: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", "AMM5A21/65KSC1", *arguments]) == 0
    assert phrase in capsys.readouterr().out


def serial_number_options(text: str) -> list[str]:
    registers = zip(range(0x44, 0x48), text.split(), strict=True)
    return [f"--register={address:#x}=0x{byte}" for address, byte in registers]


@pytest.mark.parametrize(("serial", "revision"), [("EE 69 E8 0A", "1.6"), ("0A E8 69 EE", "")])
def test_an_edition_is_chosen_by_a_register(serial: str, revision: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The number of the manual, and the same in the order of the sister AMM36."""
    assert (
        main(["decode", "AMM5A21/65KSC1", "0xF4243D3", "--edition", "registers", *serial_number_options(serial)]) == 0
    )
    out = capsys.readouterr().out
    assert ("This describes encoders of edition" in out) == bool(revision)
    assert f"This describes encoders of edition {revision}" in out or not revision


@pytest.mark.exhaustive
def test_a_master_is_told_of_an_edition(capsys: pytest.CaptureFixture[str]) -> None:
    """Pages 21 to 24, 29 and 30 of AM36's 1.1, which are public, do not mention the supply. 1.0 does (10 V to 30 V)."""
    command = ["master", "AM3616/4096SC5", "--master", "ti_c2000"]
    assert main(command) == 0
    newest = capsys.readouterr().out
    assert "This describes encoders of edition" not in newest
    assert re.search(r"Supply +10 V to 30 V", newest)
    for edition in ("1.1", "label"):
        assert main([*command, "--edition", edition]) == 0
        out = capsys.readouterr().out
        assert "This describes encoders of edition 1.1 of the manual" in out, edition
        assert re.search(r"Supply +the manual does not say", out), edition
        assert main([*command, "--edition", edition, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["family"] == "am36_1_1"
    # A possible serial number of an AMM5 from before 1.7. Only these registers identify the edition.
    command_of_registers = ["master", "AMM5A21/65KSC1", "--edition", "registers"]
    assert main([*command_of_registers, *serial_number_options("EE 69 E8 0A")]) == 0
    assert "This describes encoders of edition 1.6 of the manual of 2020-04-03" in capsys.readouterr().out


@pytest.mark.exhaustive
@pytest.mark.parametrize("edition", ["2.0", "2018-01-01", "label", "registers", "1.0", "nonsense"])
def test_a_master_refuses_as_show_does(edition: str, capsys: pytest.CaptureFixture[str]) -> None:
    """RS-485, SSI and AMM5B were added after 1.0 (Document release), so 1.0 has no such order code."""
    arguments = ["AMM5B21/65KBG1", "--edition", edition]
    refused = []
    for command in ("show", "master"):
        assert main([command, *arguments]) == 2
        out, error = capsys.readouterr()
        assert out == ""
        refused.append(error)
    assert refused[0] == refused[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["show", "amm5", "--edition", "2.0"],
            (
                "the spec of amm5 has no edition '2.0'; use 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8 "
                "or 1.9, or a date such as 2020-03-31"
            ),
        ),
        (
            ["show", "amm5", "--edition", "2018-01-01"],
            "the first edition, 1.0, is dated 2018-08-10, which is after 2018-01-01",
        ),
        # Only the year of 1.0 is known, and no date of 1.1, so the dates do not show which was the latest.
        (
            ["show", "am36", "--edition", "2020-01-01"],
            "the spec of am36 has no edition '2020-01-01'; use 1.0 or 1.1",
        ),
        (["show", "asc85", "--edition", "0.9"], "the spec of asc85 has no edition '0.9'; use 1.0"),
        (
            ["show", "AMM5A21/65KSC1", "--edition", "label"],
            "cannot infer the edition from this label; give its revision, such as 1.9",
        ),
        (
            ["decode", "AMM5B21/65KSC1", "0x0", "--edition", "1.7"],
            (
                "in edition 1.7 of the manual: 'AMM5B21/65KSC1' has mount 'B'; valid values: A. The nearest codes are "
                "AMM5A21/65KSC1, AMM5A17/65KSC1, AMM5A23/65KSC1"
            ),
        ),
        (
            ["decode", "AMM5A21/65KSC1", "0x0", "--edition", "registers"],
            (
                "to infer the edition, give all of serial_number: --register 0x44=0x.. --register 0x45=0x.. "
                "--register 0x46=0x.. --register 0x47=0x.."
            ),
        ),
        (["master", "--edition", "1.0"], "--edition needs an order code"),
        (
            ["generate", str(SPECS), "--edition", "amm6=1.0"],
            "'amm6=1.0' is not a family and an edition; write it like am36=1.0 (am36, amm5, asc85, sma21)",
        ),
        (["generate", str(SPECS), "--edition", "amm5=1.9"], "the spec of amm5 is already edition 1.9"),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(map(os.path.basename, value)),
)
def test_what_cannot_be_asked_for(
    arguments: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert capsys.readouterr().err == f"codewheel: {message}\n"


#: A mistake in the spec, and the message about it.
SLIPS = {
    "not in the history": (
        'revision: "1.7"\n    before',
        'revision: "0.7"\n    before',
        "edition-order: '0.7' can have 'before' only if it is in the history, after the first and not after 1.9",
    ),
    "twice": ('- revision: "1.6"\n    before', '- revision: "1.7"\n    before', "the edition '1.7' already exists"),
    "then": (
        'revision: "1.2"\n    before',
        'revision: "1.2"\n    then',
        "edition-order: '1.2' is not after 1.9, which this file transcribes; use 'before' for it",
    ),
    "then of a revision that no history has": (
        'revision: "1.2"\n    before',
        'revision: "0.7"\n    then',
        "edition-order: '0.7' is not after 1.9, which this file transcribes; use 'before' for it",
    ),
    "nothing there": (
        "- unknown: [registers.device_id]",
        "- unknown: [registers.device_di]",
        "overlay-unused: there is nothing at 'registers.device_di': 'registers' has no 'device_di'",
    ),
    "a reference is left": (
        "- unknown: [registers.serial_number, examples.serial_number]",
        "- unknown: [registers.serial_number]",
        "undefined-reference: in edition 1.0: there is no register 'serial_number'",
    ),
    "a change of nothing": (
        "      - unknown: [registers.serial_number, examples.serial_number]\n        why",
        "      - why",
        "overlay-change: this change does nothing; use exactly one of 'set', 'add', 'remove', 'unknown' and 'also'",
    ),
    "a change of two kinds": (
        "- unknown: [registers.device_id]",
        "- unknown: [registers.device_id]\n        also: More",
        (
            "overlay-change: this change has 'unknown' and 'also'; "
            "use exactly one of 'set', 'add', 'remove', 'unknown' and 'also'"
        ),
    ),
    "no such register": (
        "      - register: serial_number\n        run: week",
        "      - register: serial\n        run: week",
        "undefined-reference: there is no register 'serial'",
    ),
    "no such run": (
        "        run: week\n        min",
        "        run: day\n        min",
        (
            "undefined-reference: 'serial_number' has no field or run of digits 'day'; it has serial, year, week "
            "and number"
        ),
    ),
    "bounds": ("        min: 1\n        max: 53", "        min: 54\n        max: 53", "out-of-range: 'min' is 54"),
}


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("slip", SLIPS)
def test_slips_are_told_in_the_spec(slip: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    original, mistaken, message = SLIPS[slip]
    text = (SPECS / "amm5.yaml").read_text(encoding="utf-8")
    head, editions = text.split("\neditions:\n")
    assert original in editions
    spec = tmp_path / "amm5.yaml"
    spec.write_text(f"{head}\neditions:\n{editions.replace(original, mistaken, 1)}", encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text((SPECS / "manufacturer.yaml").read_text(encoding="utf-8"))
    assert main(["check", str(spec)]) == 1
    messages = [line for line in capsys.readouterr().out.splitlines() if line.startswith(str(spec))]
    assert any(message in line for line in messages), messages


def test_labels_of_an_edition_are_among_those_also_written(tmp_path: Path) -> None:
    text = (SPECS / "am36.yaml").read_text(encoding="utf-8")
    spec = tmp_path / "am36.yaml"
    spec.write_text(
        text.replace('labels: ["{model}{singleturn}/{turns}{output}"', 'labels: ["{model}"'), encoding="utf-8"
    )
    (tmp_path / "manufacturer.yaml").write_text((SPECS / "manufacturer.yaml").read_text(encoding="utf-8"))
    _, report = loading.load_families([spec])
    assert [problem.message for problem in report.problems] == [
        "there is no spelling '{model}' in 'also_written' of the order code"
    ]


def test_both_files_mean_the_same_by_a_change() -> None:
    """The words of a change are in two schemas, because editors read each schema alone."""
    from codewheel.language.schemas import load_schema

    device, overlay = load_schema("device")["$defs"], load_schema("overlay")["$defs"]
    assert {name: device[name] for name in overlay} == overlay


def test_reports_of_editions_are_no_problem_of_the_spec() -> None:
    report = ProblemReport()
    families, _ = loading.load_families([SPECS / "amm5.yaml"])
    assert in_edition(families[0], "1.0", report) is not None
    assert len(report) == 0


def test_changes_are_recorded_for_the_edition_of_the_spec() -> None:
    page = generate_docs(Library((edition("amm5", "1.4"),)))["docs/amm5_1_4-changes.md"]
    assert page.endswith("\n\nChanges are recorded for `amm5`, which is the edition that the spec transcribes.\n")
