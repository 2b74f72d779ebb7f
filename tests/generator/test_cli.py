"""The command line as a user runs it: text, JSON and exit codes."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.commands.show import text as show_text
from codewheel.order_codes.labels import find_code
from codewheel.targets import Library

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "docs" / "example"
AS_PRINTED = ("--choose", "adf_layout=as_printed")


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    try:
        exit_code = main(arguments)
    except SystemExit as stop:
        exit_code = int(stop.code or 0)
    captured = capsys.readouterr()
    return exit_code, captured.out, captured.err


def json_of(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    exit_code, out, _ = run(capsys, *arguments)
    return exit_code, json.loads(out)


SHOWN = ["amm5", "AMM5", "AMM5A21/65KSC1", "AMM5B23/1JP1-X", "AMM5A17/1BG1", "sma21", "am36", "asc85"]
SHOWN += ["SMA21-SC4-0050", "SMA21-JP1-0001", "AMC3616/4096-GG", "AM3619/4096-I7", "ASC8525/SC2", "ASC8520/GG1"]


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    exit_code, out, _ = run(capsys, "list")
    assert exit_code == 0
    assert "amm5" in out
    assert "36, AMM5{mount}{singleturn}/{turns}{interface}" in out
    assert "SSI, BiSS C-mode, RS-485" in out
    assert "revision 1.9 of 2021-12-09" in out
    assert max(map(len, out.splitlines())) <= 80


@pytest.mark.slow
@pytest.mark.parametrize("argument", SHOWN)
def test_show_fits_a_terminal(capsys: pytest.CaptureFixture[str], argument: str) -> None:
    exit_code, out, err = run(capsys, "show", argument)
    assert (exit_code, err) == (0, "")
    assert [line for line in out.splitlines() if len(line) > 80] == []


def test_show_has_no_empty_section_and_fits(every_encoder: Library) -> None:
    """A heading is the first line of its section. The order code of some families sets no parameter."""
    assert any(not device.parameters for device in every_encoder.devices)
    for device in every_encoder.devices:
        texts = [show_text.device_text(device)]
        texts += [show_text.variant_text(device, find_code(device, device.variants[0].code))]
        for text in texts:
            headings_alone = [section for section in text.split("\n\n") if "\n" not in section]
            assert not {"Parameters", "Position", "Registers", "Inputs", "Procedures"}.intersection(headings_alone)
            assert [line for line in text.splitlines() if len(line) > 80] == []


def test_show_one_code(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = run(capsys, "show", "AMM5A21/65KSC1")
    assert "| multiturn | singleturn | error | warning | crc |" in out
    assert "44:29" in out
    assert "28:8" in out
    assert "0 to 137,438,953,471" in " ".join(out.split())
    assert "rs485" not in out
    errata = out.partition("\nErrata of the manual\n")[2].split("\n  Erratum: ")[1:]
    assert len(errata) > 5
    assert all("\n    Why: " in erratum for erratum in errata)


def shown_text(capsys: pytest.CaptureFixture[str], argument: str) -> str:
    return " ".join(run(capsys, "show", argument)[1].split())


@pytest.mark.slow
def test_show_leaves_out_what_belongs_to_other_interfaces(capsys: pytest.CaptureFixture[str]) -> None:
    ssi, biss, rs485 = (shown_text(capsys, code) for code in ("SMA21-GG4-0050", "SMA21-SC4-0050", "SMA21-JP1-0001"))
    assert "ssi_gray 1" in ssi
    assert "Code Gray [5.2 p.20]" in ssi
    assert "position is in Gray code" in ssi
    assert "Registers" not in ssi
    assert "profile_id" not in ssi
    assert "profile_id 2814h" in biss
    assert "ssi_gray" not in biss
    assert "rs485_position_bits" not in biss
    assert "crc_coverage" not in biss
    assert "rs485_position_bits 24" in rs485
    assert "scd_padding_bits" not in rs485
    assert "Data ID F control field 7Ah" in rs485


@pytest.mark.slow
def test_show_names_times_limits_and_measures(capsys: pytest.CaptureFixture[str]) -> None:
    sma21 = shown_text(capsys, "SMA21-SC4-0050")
    assert "50 µm per count, 1,048,576 counts in total, maximum 1,048,575, 52,428.800 mm in total" in sma21
    assert "configuration.select_preset_offset is 0 (preset), the register holds preset, 0 to 1,048,575." in sma21
    assert "Timeout varies with the clock, at most 16 µs" in sma21
    ssi = shown_text(capsys, "AMC3616/4096-GG")
    assert "below 400 kHz with cables shorter than 50 m" in ssi
    assert "position is in Gray code" in ssi
    assert "Zero" not in ssi.partition("Inputs")[0]
    assert "65,536 counts per revolution, 4,096 revolutions" in ssi
    asc85 = shown_text(capsys, "ASC8525/SC2")
    assert "Timeout varies with the clock, 350 ns at 10 MHz" in asc85
    assert "1 revolution " in asc85


@pytest.mark.slow
def test_show_and_decode_tell_of_registers_only_where_they_matter(capsys: pytest.CaptureFixture[str]) -> None:
    biss = shown_text(capsys, "AM3616/4096-I7")
    assert "used_singleturn_bits 20" in biss
    assert "--register 0x56=0x.." in biss
    assert "position_bits 28" not in biss
    assert (
        "The widths are the factory defaults in register 56h (singleturn_bits_used.bits) and register 57h "
        "(multiturn_bits_used.bits)."
    ) in biss
    assert "--register" not in shown_text(capsys, "AM3616/4096-BG")
    assert "from registers" not in run(capsys, "decode", "SMA21-BG1-0050", "0b" + "0" * 20 + "1")[1]
    assert "from registers" in run(capsys, "decode", "SMA21-SC1-0050", "0x0")[1]


@pytest.mark.slow
def test_unknown_codes_exit_2(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (
        ("show", "nonsense"),
        ("decode", "AMM5A22/1SC1", "0x1"),
        ("decode", "AMM5A21/1SC1", "zz"),
        ("decode", "AMM5A23/1JP1", "02 20C"),
        ("generate", "--target", "cobol"),
    ):
        exit_code, out, err = run(capsys, *arguments)
        assert exit_code == 2, arguments
        assert not out, arguments
        assert err.count("\n") == 1, arguments
        assert err.startswith("codewheel: "), arguments


# Public vector: TexasInstruments/motor-control-sdk, Tamagawa_UART_output.PNG.
def test_decode_a_reply(capsys: pytest.CaptureFixture[str]) -> None:
    exit_code, decoded = json_of(capsys, "decode", "AMM5A23/65KJP1", "02 20 C7 D1 6A 5E", "--json")
    assert exit_code == 3  # valid, but the encoder reports a fault
    fields = {field["name"]: field["value"] for field in decoded["fields"]}
    assert (decoded["layout"], decoded["direction"], decoded["problems"]) == ("singleturn_reply", "encoder", [])
    assert fields["singleturn"] == 7000519
    assert fields["status_other_error"] is True
    assert fields["status_st_error"] is False
    assert decoded["crc"] == {"received": 0x5E, "computed": 0x5E, "ok": True}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "kind"),
    [
        (("AMM5A23/65KJP1", "32 10 01 28 B0 08 B3"), "length"),  # the manual's CRC example, 7.6: fits no reply
        (("AMM5A23/65KJP1", *AS_PRINTED, "--from", "master", "32 7f 01 4c"), "constant"),  # hpm_sdk: MEM BUSY is 1 then
        (("AMM5A23/65KJP1", *AS_PRINTED, "--from", "master", "32 01 5a 69"), "constant"),
        (("AMM5A23/65KJP1", *AS_PRINTED, "--from", "master", "ea", "01", "eb"), "constant"),
        (("AMM5A23/65KJP1", "02 20 C7 D1 6A 5F"), "crc"),
        (("AMM5A23/65KJP1", "A2 00 10 32 54 00 D4"), "range"),  # data ID 4 does not exist in this family
        (("AMM5A17/1SC1", "0x2000000"), "length"),
        (("AMM5A17/1SC1", "0b1"), "length"),
        (("AMM5A17/1SC1", "0x0"), "crc"),
    ],
)
def test_faults_exit_1(capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], kind: str) -> None:
    exit_code, decoded = json_of(capsys, "decode", *arguments, "--json")
    assert exit_code == 1
    assert kind in [problem["kind"] for problem in decoded["problems"]]
    exit_code, out, _ = run(capsys, "decode", *arguments)
    assert exit_code == 1
    assert f"{kind} error: " in out


def test_a_sound_frame_with_an_error_exits_3(capsys: pytest.CaptureFixture[str]) -> None:
    # 17 bits: position 0, nE 0, nW 0: the CRC of zeros is 0, inverted 3Fh.
    exit_code, decoded = json_of(capsys, "decode", "AMM5A17/1SC1", "0x3F", "--json")
    fields = {field["name"]: field["value"] for field in decoded["fields"]}
    assert exit_code == 3
    assert fields["error"] is True
    assert fields["warning"] is True


@pytest.mark.parametrize("arguments", [("list",), ("show", "AMM5A17/1SC1"), ("decode", "AMM5A17/1SC1", "0x3F")])
def test_json_is_indented_by_two_and_not_escaped(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]
) -> None:
    out = run(capsys, *arguments, "--json")[1]
    assert out == json.dumps(json.loads(out), indent=2, ensure_ascii=False) + "\n"
    assert out.startswith(('{\n  "', "[\n  {"))


@pytest.mark.slow
def test_a_label_of_another_edition_is_shown_as_such(capsys: pytest.CaptureFixture[str]) -> None:
    """AM36 manual, edition 1.1 p.21: AMx36xx/4096SCx-... for AMx36xx/4096-I7-... of edition 1.0."""
    label, frame = "AM3616/4096SC1", f"0x{0b11 << 6 | 0x3F:x}"
    for arguments in (("show", label), ("decode", label, frame), ("master", label)):
        out = " ".join(run(capsys, *arguments)[1].split())
        assert "AM3616/4096-I7" in out, arguments
        assert "the label is written as in edition 1.1 of the manual" in out, arguments
    for command in ("show", "master"):
        exit_code, output = json_of(capsys, command, label, "--json")
        assert exit_code == 0, command
        assert output["label"]["written_as_in"].startswith("edition 1.1"), command
    assert "written as in" not in run(capsys, "show", "AM3616/4096-I7")[1]
    assert "Also written: {model}{singleturn}/{turns}{output}" in run(capsys, "show", "am36")[1]


def test_a_blank_on_a_label_means_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "show", "SMA21 -BG1-0050") == run(capsys, "show", "SMA21-BG1-0050")


def test_decode_a_register(capsys: pytest.CaptureFixture[str]) -> None:
    # AMM5 manual 6.4: 18 30 03630.
    exit_code, decoded = json_of(capsys, "decode", "AMM5A21/65KSC1", "--as", "serial_number", "0AE869EE", "--json")
    fields = {field["name"]: field["value"] for field in decoded["fields"]}
    assert exit_code == 0
    assert (fields["year"], fields["week"], fields["number"]) == (18, 30, 3630)
    exit_code, _, err = run(capsys, "decode", "AMM5A21/65KSC1", "--as", "nothing", "00")
    assert exit_code == 2
    assert "it has: preset" in err


@pytest.mark.slow
def test_frames_from_standard_input() -> None:
    frames = "02 20 C7 D1 6A 5E\n\n02 20 C7 D1 6A 5F\n"
    command = [sys.executable, "-m", "codewheel", "decode", "AMM5A23/65KJP1", "-", "--json"]
    done = subprocess.run(command, input=frames, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert [json.loads(line)["crc"]["ok"] for line in done.stdout.splitlines()] == [True, False]


@pytest.mark.slow
def test_generate_twice_check_and_targets(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    command = ("generate", str(EXAMPLE), "-o", str(tmp_path))
    exit_code, out, _ = run(capsys, *command)
    assert exit_code == 0
    exit_code, out, _ = run(capsys, *command)
    assert exit_code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["read", "all"]
    assert run(capsys, *command, "--check")[0] == 0
    victim = next(tmp_path.rglob("tv62_biss.h"))
    victim.write_text("changed")
    exit_code, out, err = run(capsys, *command, "--check")
    assert exit_code == 1
    assert out.splitlines()[1:] == [
        f"differs    {victim}",
        "up to date: python, biss, docs, browser, masters; out of date: c",
    ]
    assert f"run: codewheel {shlex.join(command)}" in err
    assert victim.read_text() == "changed"
    exit_code, out, _ = run(capsys, *command, "--target", "python")
    assert exit_code == 0
    assert victim.read_text() == "changed"


@pytest.mark.one_in(7, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "imported"),
    [
        ("list", set()),
        ("show amm5", set()),
        ("decode AMM5A17/1SC1 0x3F", set()),
        ("master SMA21-SC4-0050", set()),
        ("diff specs specs", set()),
        ("generate --check --no-cache --target docs", {"docs", "picture_elements", "registry"}),
        ("generate --check --no-cache --target python", {"python", "registry"}),
        ("check --no-cache --target biss specs", {"biss", "registry"}),
        ("check --no-cache --target c specs", {"c", "registry"}),
    ],
)
def test_only_the_targets_that_run_are_imported(arguments: str, imported: set[str]) -> None:
    script = "import sys; from codewheel.commands.cli import main; main(sys.argv[1:]); print(*sorted(sys.modules))"
    command = [sys.executable, "-c", script, *arguments.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    modules = set(done.stdout.splitlines()[-1].split())
    targets = {name.split(".")[2] for name in modules if name.startswith("codewheel.targets.")}
    assert targets == imported, done.stderr
    assert ("jinja2" in modules) == arguments.startswith("generate")


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments", ["show AMM5A17/1SC1", "decode AMM5A17/1SC1 0x3F", "generate specs/cui --target biss -o OUTPUT"]
)
def test_a_result_from_the_cache_needs_no_rules(arguments: str, tmp_path: Path) -> None:
    script = "import sys; from codewheel.commands.cli import main; main(sys.argv[1:]); print(*sorted(sys.modules))"
    command = [sys.executable, "-c", script, *arguments.replace("OUTPUT", str(tmp_path / "output")).split()]
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    for imports_rules in (True, False):
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT, env=environment)
        modules = done.stdout.splitlines()[-1].split()
        assert ("codewheel.language.rules" in modules) is imports_rules, done.stderr


def test_problems_go_to_standard_error_and_exit_1(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "x.yaml").write_text("device: x\n")
    for arguments in (("generate", "-o", str(tmp_path / "out")), ("list", "--specs")):
        exit_code, out, err = run(capsys, *arguments[:1], *arguments[1:], str(tmp_path / "x.yaml"))
        assert exit_code == 1
        assert not out
        assert "x.yaml:1:1: missing-key: " in err
        assert "Traceback" not in err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_what_the_manual_leaves_open_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("amm5", "AMM5A23/65KJP1"):
        out = " ".join(run(capsys, "show", name)[1].split())
        assert (
            "Left open by the manual, for you to choose adf_layout: Position of the address in byte "
            "ADF of an EEPROM access over RS-485 [7.5 p.46]. as_printed: Bits 7:1"
        ) in out
        assert "Give decode the answer with --choose adf_layout=as_printed" in out
        assert "The positions of its fields depend on your choice of adf_layout: as_printed or as_t_format." in out
    assert "The picture shows as_printed." in out
    assert "for you to choose" not in run(capsys, "show", "AMM5A17/1SC1")[1]
    assert json_of(capsys, "show", "AMM5A17/1SC1", "--json")[1]["alternatives"] == []
    shown_data = json_of(capsys, "show", "AMM5A23/65KJP1", "--json")[1]
    assert [answer["name"] for answer in shown_data["alternatives"][0]["answers"]] == ["as_printed", "as_t_format"]
    needed = {layout["name"] for layout in shown_data["layouts"] if layout["alternatives"] == ["adf_layout"]}
    assert needed == {"eeprom_write_request", "eeprom_read_request", "eeprom_write_reply", "eeprom_read_reply"}
