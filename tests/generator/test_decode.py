"""``codewheel decode`` from a user's view: reports, undocumented values, frames from a file, typing mistakes.

CRCs of BiSS are worked out on paper, modulo x^6 + x + 1 and inverted:
for a position of 0, x^6 = 000011b is nW alone, x^7 = 000110b nE alone.
"""

from __future__ import annotations

import io
import json
import shlex
import shutil
import subprocess
import sys
from importlib import resources
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import jsonschema
import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Flag, Layout, Verdict
from codewheel.say.layout import bit_place
from planted import crc

SPECS = Path(__file__).parents[1] / "specs"
ENCODERS = str(Path(__file__).parents[2] / "specs")
Capture = pytest.CaptureFixture[str]
AS_PRINTED = ("--choose", "adf_layout=as_printed")
AS_T_FORMAT = ("--choose", "adf_layout=as_t_format")
NO_ERROR, NO_WARNING, NEITHER = "10", "01", "11"
BOTH = "--choose adf_layout=as_printed or --choose adf_layout=as_t_format"
CRCS = {"00": "111111", "01": "111100", "10": "111001", "11": "111010"}


def decode(capsys: Capture, *arguments: str) -> tuple[int, dict[str, Any]]:
    """Return exit code and data, after validating the data against their schema."""
    exit_code = main(["decode", *arguments, "--json"])
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    schema = json.loads((resources.files("codewheel.language") / "decode.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(data)
    return exit_code, data


def text(capsys: Capture, *arguments: str) -> tuple[int, str]:
    exit_code = main(["decode", *arguments])
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines()), default=0) <= 80
    return exit_code, " ".join(out.split())


def refusal(capsys: Capture, *arguments: str) -> str:
    assert main(["decode", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("codewheel: ")
    assert captured.err.count("\n") == 1
    return captured.err.removeprefix("codewheel: ").strip()


def reply(*data: int) -> str:
    """A frame over RS-485, whose CRC is the XOR of its bytes."""
    check = 0
    for byte in data:
        check ^= byte
    return bytes([*data, check]).hex(" ")


def reported_fields(data: dict[str, Any]) -> list[str]:
    return [report["field"] for report in data["reports"]]


# ------------------------------------------------------------------------------------------------------ short frames


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ("0xF42", "The text has 2 of the 6 bytes of the frame. Missing: 4 bytes, treated as leading zeros."),
        ("0x0F42", "The text has 2 of the 6 bytes of the frame. Missing: 4 bytes, treated as leading zeros."),
    ],
)
def test_bytes_that_a_number_lacks_are_counted_first(capsys: Capture, frame: str, words: str) -> None:
    """A frame of 45 bits has 6 bytes."""
    code, output = text(capsys, "AMM5A21/65KSC1", frame)
    assert code == 1
    _, _, after_problem = output.partition("crc error: ")
    assert words in after_problem
    explanations = ("one bit may have been corrupted", "common mistake", "No single mistake", "Possible explanations")
    beginnings = [after_problem.index(phrase) for phrase in explanations if phrase in after_problem]
    assert after_problem.index(words) < min(beginnings)


@pytest.mark.parametrize("frame", ["00 00 0F 42 43 D2", "0x1E8487A7", "0F 42 43 D3", "1000003"])
def test_complete_bytes_valid_frames_and_decimal_numbers_lack_nothing(capsys: Capture, frame: str) -> None:
    """Leading zeros can be omitted in a number that a mistake explains, and in a valid frame. A decimal has none."""
    _, output = text(capsys, "AMM5A21/65KSC1", frame)
    assert "Missing:" not in output


@pytest.mark.parametrize(
    ("order_code", "frame", "words"),
    [
        # Replies in examples of the manuals, without their last bytes.
        ("SMA21-JP1-0050", "A2 00 10 32", "The text has 4 of the 7 bytes of the frame. Missing: 3 bytes."),
        ("SMA21-JP1-0050", "A2 00 10 32 54 00", "The text has 6 of the 7 bytes of the frame. Missing: 1 byte."),
        ("AMT212B-V", "12", "The text has 1 of the 2 bytes of the frame. Missing: 1 byte."),
    ],
)
def test_a_short_frame_over_rs_485_has_nothing_to_do_with_its_crc(
    capsys: Capture, order_code: str, frame: str, words: str
) -> None:
    code, output = text(capsys, order_code, frame)
    assert code == 1
    _, _, after_problem = output.partition("length error: ")
    assert words in after_problem
    assert "CRC" not in after_problem
    assert "mistake" not in after_problem
    data = decode(capsys, order_code, frame)[1]["why"]
    assert f"{data['missing']}." == f"t{words[1:]}"
    assert (data["tried"], data["cannot_see"]) == (0, [])


# --------------------------------------------------------------------------------------------- reports of the encoder


@pytest.mark.parametrize(
    ("status", "reported", "verdict", "expected_code"),
    [
        ("11", [], "usable", 0),
        ("10", ["warning"], "usable_with_warning", 0),
        ("01", ["error"], "not_usable", 3),
        ("00", ["error", "warning"], "not_usable", 3),
    ],
)
@pytest.mark.parametrize(
    ("encoder", "before"),
    [
        ("AMM5A17/1SC1", 17),
        ("ASC8525/SC1 --choose zero_bit=as_printed", 26),
        ("ASC8525/SC1 --choose zero_bit=left_out", 25),
        ("SMA21-SC1-0050", 24),
    ],
)
def test_error_and_warning_over_biss(
    capsys: Capture, encoder: str, before: int, status: str, reported: list[str], verdict: str, expected_code: int
) -> None:
    exit_code, data = decode(capsys, *encoder.split(), "0b" + "0" * before + status + CRCS[status])
    assert exit_code == expected_code
    assert (reported_fields(data), data["verdict"], data["problems"]) == (reported, verdict, [])


def test_the_text_ends_with_what_the_encoder_reports(capsys: Capture) -> None:
    exit_code, out = text(capsys, "AMM5A21/65KSC1", "0xf424316")
    assert exit_code == 3
    assert "no frame error" not in out
    assert "°" not in out
    assert "the encoder reports: - error (Error, nE): an error is active in the system." in out
    assert "- warning (Warning, nW): " in out
    assert out.endswith("so the position is not usable evidence: manual")
    exit_code, out = text(capsys, "AMM5A17/1SC1", "0b" + "0" * 17 + "10" + CRCS["10"])
    assert exit_code == 0
    assert "no frame error" not in out
    assert out.endswith("so the position is usable with a warning evidence: manual")
    assert text(capsys, "AMM5A21/65KSC1", "0xf4243d3")[1].endswith(
        "(x^6 + x + 1, sent inverted) no frame error; the position is usable evidence: manual"
    )


@pytest.mark.parametrize(
    ("status", "alarms", "reported", "verdict"),
    [
        (0x00, 0x00, [], "usable"),
        (0x20, 0x80, ["status_other_error", "battery_alarm"], "usable_with_warning"),
        (0x20, 0xC0, ["status_other_error", "mt_error", "battery_alarm"], "not_usable"),
        (0x20, 0x20, ["status_other_error", "ps_error"], "not_usable"),
        (0x20, 0x02, ["status_other_error", "busy"], "not_usable"),
        (0x10, 0x04, ["status_st_error", "st_error"], "not_usable"),
        (0x20, 0x00, ["status_other_error"], "not_usable"),  # a sum of no flags, which is accepted as is
        (0x00, 0x80, ["battery_alarm"], "usable_with_warning"),
    ],
)
def test_alarms_of_amm5(capsys: Capture, status: int, alarms: int, reported: list[str], verdict: str) -> None:
    """Data ID 3, manual 7.3.2 and 7.4: EE_1 sums up BUSY, PS error, battery alarm and MT error, which are in ALMC."""
    exit_code, data = decode(capsys, "AMM5A23/65KJP1", reply(0x1A, status, 1, 2, 3, 0x23, 4, 0, 0, alarms))
    assert (reported_fields(data), data["verdict"]) == (reported, verdict)
    assert exit_code == (3 if verdict == "not_usable" else 0)


@pytest.mark.slow
def test_the_remedy_of_an_alarm_is_told(capsys: Capture) -> None:
    frame = reply(0x1A, 0x20, 0, 0, 0, 0x23, 0, 0, 0, 0x80)
    (_, battery) = decode(capsys, "AMM5A23/65KJP1", frame)[1]["reports"]
    # 7.4.1 has how the flag is cleared, 4.3.1 and 9 what to do about the battery.
    remedy = "Replace the battery as soon as possible, then reset the error with data ID 7 or C"
    remedy += ". Steps on the hardware page: Battery replacement without error"
    assert battery["remedy"] == remedy
    assert battery["makes_position"] == "usable_with_warning"
    assert f"the external battery is below 3.15 V. {remedy}." in text(capsys, "AMM5A23/65KJP1", frame)[1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "frame", "verdict"),
    [
        # A singleturn model has no battery (4.3), and no manual gives the meaning of its battery bits.
        ("AMM5A17/1JP1", reply(0x1A, 0x20, 1, 0, 0, 0x23, 0, 0, 0, 0x80), "usable_with_warning"),
        ("AMM5A17/1JP1", reply(0x1A, 0x20, 1, 0, 0, 0x23, 0, 0, 0, 0x40), "usable_with_warning"),
        # EE_1 alone may be BUSY, with a position of 0 (7.4.1).
        ("AMM5A17/1JP1", reply(0x02, 0x20, 1, 0, 0), "not_usable"),
        # MT error with a battery: 7.4.1, 9.
        ("AMM5A17/65KJP1", reply(0x1A, 0x20, 1, 0, 0, 0x23, 0, 0, 0, 0x40), "not_usable"),
    ],
)
def test_no_battery_is_replaced_in_a_singleturn_model(capsys: Capture, code: str, frame: str, verdict: str) -> None:
    _, data = decode(capsys, code, frame)
    assert data["verdict"] == verdict
    printed = text(capsys, code, frame)[1]
    if "/65K" in code:
        assert "Replace the battery" in printed
    else:
        assert "eplace" not in printed
        unexplained = [report for report in data["reports"] if report["field"] in ("battery_alarm", "mt_error")]
        assert all(report["meaning"].startswith("the manual does not say") for report in unexplained)
        assert all(report["remedy"] is None for report in unexplained)


@pytest.mark.parametrize(
    ("status", "alarms", "reported", "verdict"),
    [
        (0x10, 0x80, ["status_alarm", "temperature_alarm"], "usable_with_warning"),
        (0x20, 0x01, ["status_error", "overspeed"], "not_usable"),
        (0x20, 0x02, ["status_error", "initialization_error"], "not_usable"),
    ],
)
def test_alarms_of_sma21(capsys: Capture, status: int, alarms: int, reported: list[str], verdict: str) -> None:
    """Data ID 4, manual 7.3.2: ea0 is a warning with a valid position, ea1 is a fault."""
    exit_code, data = decode(capsys, "SMA21-JP1-0050", reply(0xA2, status, 123, 0, 0, alarms))
    assert (reported_fields(data), data["verdict"]) == (reported, verdict)
    assert exit_code == (3 if verdict == "not_usable" else 0)
    if alarms == 0x80:
        assert "does not have it" in data["reports"][1]["meaning"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "reported", "verdict"),
    [
        (("AMM5A17/1BG1", "0b" + "0" * 17), [], "unknown"),
        (("AM3616/4096-I7", "0b" + "0" * 36 + "11" + CRCS["11"]), [], "unknown"),  # its nE and nW are always 1
        (("AMM5A23/65KJP1", reply(0x92, 0x20, 0x23)), ["status_other_error"], None),  # the encoder ID, no position
        (("AMM5A23/65KJP1", *AS_PRINTED, reply(0xEA, 0x03, 0x00)), ["mem_busy"], None),
        (("AMM5A23/65KJP1", *AS_T_FORMAT, reply(0xEA, 0x81, 0x00)), ["mem_busy"], None),
        (("AMM5A23/65KJP1", reply(0x8A, 0x00, 5, 0, 0)), [], "usable"),  # multiturn data are part of the position
        (("AMM5A23/1JP1", reply(0x8A, 0x00, 0, 0, 0)), [], "usable"),  # though a singleturn encoder has only 0 there
        (("AMM5A23/65KJP1", "--from", "master", "02"), [], None),
        (("ASC8525/SC1", "--as", "status", "01"), [], None),  # position data valid: no alarm
        (("ASC8525/SC1", "--as", "error_register", "01"), ["control_error"], None),
    ],
)
def test_where_there_is_no_verdict(
    capsys: Capture, arguments: tuple[str, ...], reported: list[str], verdict: str | None
) -> None:
    exit_code, data = decode(capsys, *arguments)
    assert (exit_code, reported_fields(data), data["verdict"]) == (0, reported, verdict)


def test_ssi(capsys: Capture) -> None:
    words = text(capsys, "AMM5A17/1BG1", "0b" + "0" * 16 + "1")[1]
    assert "no frame error; this frame has no CRC; no bit of this frame confirms that the position is usable" in words
    # 1 is 10 in binary after a shift to the left, and 0 after one to the right.
    assert words.endswith(
        "would be 2 if it was read one clock early, 0 if it was read one clock late, 131070 if every bit is inverted. "
        "evidence: manual"
    )
    exit_code, data = decode(capsys, "SMA21-BG1-0050", "0b" + "0" * 20 + "0")
    assert (exit_code, reported_fields(data), data["verdict"]) == (3, ["error"], "not_usable")


def test_a_frame_with_a_fault_says_nothing_of_the_encoder(capsys: Capture) -> None:
    exit_code, data = decode(capsys, "AMM5A17/1SC1", "0b" + "0" * 17 + "00" + "111110")
    assert (exit_code, data["reports"], data["verdict"]) == (1, [], None)


# -------------------------------------------------------------------------------------------------------- unused bits


def test_the_only_reply_to_data_id_5_that_the_manual_prints(capsys: Capture) -> None:
    """SMA21 manual, 7.3.4: 02h in SF sets dd1, which is 0 in 7.3.2. The frame is still valid."""
    printed = ("SMA21-JP1-0001", "2A 02 DA 04 00 43 25 00 90")
    exit_code, data = decode(capsys, *printed)
    assert (exit_code, reported_fields(data), data["verdict"], data["problems"]) == (
        0,
        ["status_info"],
        "usable_with_warning",
        [],
    )
    values = {field["name"]: field["value"] for field in data["fields"]}
    assert (values["status_info"], values["position"], values["unused"]) == (2, 0x25430004DA, 2)
    assert (
        "status_info (dd0 ... dd3): unused bits differ from the documented value 0. Information bits, not used "
        "in this encoder. so the position is usable with a warning"
    ) in text(capsys, *printed)[1]


@pytest.mark.parametrize(
    ("status", "reported", "verdict", "unused"),
    [
        ("11", [], "unknown", 0),
        ("01", ["error"], "not_usable", 2),
        # A warning does not improve a position with an unknown verdict.
        ("10", ["warning"], "unknown", 1),
        ("00", ["error", "warning"], "not_usable", 3),
    ],
)
def test_status_bits_that_the_manual_does_not_use(
    capsys: Capture, status: str, reported: list[str], verdict: str, unused: int
) -> None:
    """AM36 manual, 6.3.1 p.21: nE and nW are always 1. A 0 has its meaning in the BiSS protocol."""
    exit_code, data = decode(capsys, "AM3616/4096-I7", "0b" + "0" * 36 + status + CRCS[status])
    assert (reported_fields(data), data["verdict"]) == (reported, verdict)
    assert exit_code == (3 if verdict == "not_usable" else 0)
    verdicts = {"error": "not_usable", "warning": "unknown"}
    assert [report["makes_position"] for report in data["reports"]] == [verdicts[name] for name in reported]
    assert all(report["source"] == "6.3.1 p.21" for report in data["reports"])
    assert next(field["value"] for field in data["fields"] if field["name"] == "unused") == unused


@pytest.mark.slow
@pytest.mark.parametrize(
    ("frame", "reported", "verdict", "unused"),
    [
        # SF: EI_3 to EI_0 and bits 7:6. ALMC: bits 4:3 and 0. Each byte of the frame has a byte of the number.
        (reply(0x02, 0xC5, 0, 0, 0), ["status_info", "status_zero"], "usable_with_warning", 0xC5),
        (reply(0x02, 0xCF | 0x20, 0, 0, 0), ["status_info", "status_other_error", "status_zero"], "not_usable", 0xCF),
        (
            reply(0x1A, 0x80, 0, 0, 0, 0x23, 0, 0, 0, 0x11),
            ["status_zero", "alarm_zero_0", "alarm_zero_3_4"],
            "usable_with_warning",
            0x1180,
        ),
        (reply(0x92, 0x01, 0x23), ["status_info"], None, 1),
    ],
)
def test_reserved_bits_that_newer_firmware_may_use(
    capsys: Capture, frame: str, reported: list[str], verdict: str | None, unused: int
) -> None:
    """AMM5 manual, 7.3.2 p.42 and 7.4 p.43."""
    exit_code, data = decode(capsys, "AMM5A23/65KJP1", frame)
    assert (reported_fields(data), data["verdict"], data["problems"]) == (reported, verdict, [])
    assert exit_code == (3 if verdict == "not_usable" else 0)
    assert next(field["value"] for field in data["fields"] if field["name"] == "unused") == unused


def test_the_number_of_unused_bits_is_no_line_of_the_text(capsys: Capture) -> None:
    assert "unused " not in text(capsys, "AMM5A23/65KJP1", reply(0x02, 0, 0, 0, 0))[1]


# --------------------------------------------------------------------------------------- open questions of the manual


@pytest.mark.slow
@pytest.mark.parametrize(
    ("frame", "address", "value"), [("32 7F 01 4C", 0x7F, 1), ("32 01 5A 69", 1, 0x5A), ("EA 01 EB", 1, None)]
)
def test_public_frames_of_the_eeprom(capsys: Capture, frame: str, address: int, value: int | None) -> None:
    """HPMicro's three printed requests are valid with the address in bits 6:0, and invalid with it in bits 7:1."""
    master = ("AMM5A23/65KJP1", "--from", "master", frame)
    exit_code, data = decode(capsys, *master, *AS_T_FORMAT)
    assert (exit_code, data["problems"], data["alternatives"]) == (0, [], {"adf_layout": "as_t_format"})
    values = {field["name"]: field["value"] for field in data["fields"]}
    assert (values["address"], values["mem_busy"], values.get("data")) == (address, 0, value)
    exit_code, data = decode(capsys, *master, *AS_PRINTED)
    assert (exit_code, [problem["field"] for problem in data["problems"]]) == (1, ["mem_busy"])
    exit_code, out = text(capsys, *master, *AS_T_FORMAT)
    assert "decoded with adf_layout = as_t_format: Bits 6:0, as in public T-format stacks" in out


@pytest.mark.parametrize(("length", "lines"), [(80, 1), (81, 2)])
def test_what_was_chosen_is_wrapped_at_80_columns(capsys: Capture, tmp_path: Path, length: int, lines: int) -> None:
    base = Path(__file__).parents[1] / "changes" / "base"
    start = "decoded with memory = low: "
    # The last word just fits into the line, or just does not.
    meaning = "x" * (length - len(start) - 5) + " last"
    changed = (base / "demo.yaml").read_text(encoding="utf-8").replace('"Bits 6:0"', meaning)
    (tmp_path / "demo.yaml").write_text(changed, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_bytes((base / "manufacturer.yaml").read_bytes())
    arguments = ("--specs", str(tmp_path), "DEMO13-SJP", "--from", "master", "EA 01 EB", "--choose", "memory=low")
    assert main(["decode", *arguments]) == 0
    meaning_lines = f"{start}{meaning}" if lines == 1 else f"{start}{meaning.removesuffix(' last')}\n  last"
    assert f"\n{meaning_lines}\n" in capsys.readouterr().out


@pytest.mark.slow
def test_nobody_decides_for_the_user(capsys: Capture) -> None:
    for more in ((), ("--json",)):
        message = refusal(capsys, "AMM5A23/65KJP1", "--from", "master", *more, "EA 0A E0")
        assert message == (
            "'eeprom_read_request' cannot be decoded until you decide. Position of the address in byte ADF of an "
            "EEPROM access over RS-485: add --choose adf_layout=as_printed (Bits 7:1, with MEM BUSY in bit 0, as "
            "printed in the manual) or --choose adf_layout=as_t_format (Bits 6:0, as in public T-format stacks. "
            "MEM BUSY is then the remaining bit, bit 7)"
        )
    assert decode(capsys, "AMM5A23/65KJP1", "--from", "master", "02")[1]["alternatives"] == {}
    # Even the length of a word is unknown until then: 33 or 34 bits. A register does not depend on it.
    for frame in ("0x3c1", "0b" + "0" * 33, "0b" + "0" * 34, "0b0"):
        message = refusal(capsys, "ASC8525/SC1", frame)
        assert message.startswith("'single_cycle_data' cannot be decoded until you decide. Constant 0 bit between ")
        assert "add --choose zero_bit=as_printed (Sent, " in message
        assert " or --choose zero_bit=left_out (Not sent, " in message
    assert decode(capsys, "ASC8525/SC1", "--as", "status", "01")[0] == 0
    # A frame of bytes with a wrong length has no fields that could be misread.
    assert decode(capsys, "AMM5A23/65KJP1", "--from", "master", "EA 0A")[1]["problems"][0]["kind"] == "length"


def test_an_undecided_frame_among_others(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("02\nEA 0A E0\n8A\n"))
    assert main(["decode", "AMM5A23/65KJP1", "--from", "master", "-", "--json"]) == 2
    captured = capsys.readouterr()
    assert [json.loads(line)["line"] for line in captured.out.splitlines()] == [1, 3]
    assert captured.err.startswith("codewheel: line 2: 'eeprom_read_request' cannot be decoded until you decide. ")
    assert captured.err.count("\n") == 1


@pytest.mark.parametrize(
    ("encoder", "chosen", "message"),
    [
        ("AMM5A23/65KJP1", ["eeprom=as_printed"], f"AMM5A23/65KJP1 has no choice 'eeprom'; write {BOTH}"),
        ("AMM5A23/65KJP1", ["adf_layout"], f"'adf_layout' has no answer ''; write {BOTH}"),
        ("AMM5A23/65KJP1", ["adf_layout=7:1"], f"'adf_layout' has no answer '7:1'; write {BOTH}"),
        (
            "AMM5A23/65KJP1",
            ["adf_layout=as_printed", "adf_layout=as_t_format"],
            "'adf_layout' is chosen twice, as 'as_printed' and as 'as_t_format'",
        ),
        ("AMM5A17/1SC1", ["adf_layout=as_printed"], "AMM5A17/1SC1 has nothing to choose"),
    ],
)
def test_a_wrong_choice_is_told_the_right_ones(capsys: Capture, encoder: str, chosen: list[str], message: str) -> None:
    options = [word for choice in chosen for word in ("--choose", choice)]
    assert refusal(capsys, encoder, *options, "02") == message


def test_a_guess_at_a_mistake_reads_nothing_undecided(capsys: Capture) -> None:
    """The reply to a read without its first byte is recognised. Its data are shown, its address is not."""
    for more in ((), AS_PRINTED):
        why = decode(capsys, "AMM5A23/65KJP1", *more, reply(0xEA, 0x0A, 0x5A)[3:])[1]["why"]
        (lost_byte,) = [explanation for explanation in why["explanations"] if explanation["kind"] == "first_byte_lost"]
        assert lost_byte["reads"] == {"data": 0x5A}


# ---------------------------------------------------------------------------------------------------- not as documented


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--as", "profile_id", "28 14"), "profile_id: the register holds 0x2814, but SMA21-SC1-0010 has 0x2816"),
        (("--as", "manufacturer_id", "4C 6A"), 'name: the register holds "Lj", but SMA21-SC1-0010 has "Li"'),
        (("--as", "device_id", "48 4D 32 31 00 01"), 'name: the register holds "HM21", but SMA21-SC1-0010 has "SM21"'),
        (("--as", "device_type", "09"), "the register holds 0x09, but SMA21-SC1-0010 has 0x08"),
    ],
)
def test_the_register_of_another_encoder(capsys: Capture, arguments: tuple[str, ...], message: str) -> None:
    exit_code, data = decode(capsys, "SMA21-SC1-0010", *arguments)
    assert exit_code == 1
    assert data["problems"] == []
    assert data["differences"][0]["message"].endswith(message)
    exit_code, out = text(capsys, "SMA21-SC1-0010", *arguments)
    assert exit_code == 1
    assert message in out
    assert out.endswith("no other error evidence: manual")


@pytest.mark.slow
def test_registers_of_another_encoder_beside_a_frame(capsys: Capture) -> None:
    """Profile IDs of SMA21: 2814h at 50 µm, manual 6.4, and 2816h at 10 µm."""
    frame = "0b" + "0" * 24 + "11" + CRCS["11"]
    registers = ("--register", "0x42=0x28", "--register", "0x43=0x14")
    assert decode(capsys, "SMA21-SC1-0050", *registers, frame)[0] == 0
    exit_code, data = decode(capsys, "SMA21-SC1-0010", *registers, frame)
    assert exit_code == 1
    assert data["verdict"] == "usable"
    assert [difference["message"] for difference in data["differences"]] == [
        "profile_id: the register holds 0x2814, but SMA21-SC1-0010 has 0x2816"
    ]
    _, data = decode(capsys, "SMA21-SC1-0010", *registers[2:], frame)
    assert [difference["message"] for difference in data["differences"]] == [
        "profile_id: the given part is ..14h, SMA21-SC1-0010 has ..16h"
    ]
    assert "does not change how a frame is read" in refusal(capsys, "SMA21-SC1-0010", "--register", "0x44=1", frame)


def test_a_frame_with_another_id_is_decoded(capsys: Capture, tmp_path: Path) -> None:
    spec = (SPECS / "bits22.yaml").read_text(encoding="utf-8")
    spec = spec.replace(
        "fields:\n", "fields:\n          - {name: kind, printed_name: KIND, bits: 8, equals: 0x23}\n", 1
    )
    (tmp_path / "bits22.yaml").write_text(spec, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(
        (SPECS / "manufacturer.yaml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    for kind, differs in ((0x23, False), (0x17, True)):
        bits = f"{kind:08b}" + "0" * 21 + "1" + "11"
        arguments = ("T22SC", f"0b{bits}{crc(bits)}", "--specs", str(tmp_path))
        exit_code, data = decode(capsys, *arguments)
        assert (exit_code, data["verdict"], data["problems"]) == (0, "usable", [])
        assert next(field["value"] for field in data["fields"] if field["name"] == "position") == 1
        assert [difference["message"] for difference in data["differences"]] == [
            "KIND is 0x17, but the manual says 0x23"
        ] * differs
        assert (
            "not as documented: KIND is 0x17, but the manual says 0x23 no other error" in text(capsys, *arguments)[1]
        ) is differs


# --------------------------------------------------------------------------------------------------- frames from a file

FRAMES = """\
# captured on the bench
02 00 C7 D1 6A 7E

02 20 C7 D1 6A 5E   # an error is active
022 0C7D16A5E
02 20 C7 D1 6A 5F
zz
02 00 C7 D1 6A 7E
"""


def decode_lines(capsys: Capture, monkeypatch: pytest.MonkeyPatch, lines: str, *arguments: str) -> tuple[int, str, str]:
    monkeypatch.setattr("sys.stdin", io.StringIO(lines))
    exit_code = main(["decode", "AMM5A23/65KJP1", "-", *arguments])
    captured = capsys.readouterr()
    return exit_code, captured.out, captured.err


def test_a_byte_order_mark_is_a_blank(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some programs begin a file with it, before a time or a comment."""
    for first_line in ("0.5 02 00 C7 D1 6A 7E", "# captured on the bench\n0.5 02 00 C7 D1 6A 7E"):
        exit_code, out, _ = decode_lines(capsys, monkeypatch, f"\ufeff{first_line}\n", "--json")
        rows = [json.loads(line) for line in out.splitlines()]
        assert (exit_code, [row["time"] for row in rows]) == (0, ["0.5"])


def test_a_form_feed_does_not_end_a_line(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    """An argument has the same lines as standard input."""
    text = "02 00 C7\x0cD1 6A 7E"
    assert decode_lines(capsys, monkeypatch, text)[0] == 0
    assert main(["decode", "AMM5A23/65KJP1", text]) == 0


def test_lines_are_numbered_and_bad_ones_named(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    exit_code, out, err = decode_lines(capsys, monkeypatch, FRAMES)
    assert exit_code == 2
    started = [line for line in out.splitlines() if "AMM5A23/65KJP1" in line]
    assert started == [f"line {number}: AMM5A23/65KJP1, RS-485, from the encoder" for number in (2, 4, 6, 8)]
    assert err.splitlines() == [
        "codewheel: line 5: '022' has an odd number of hex digits: one is missing or one too many",
        "codewheel: line 7: 'zz' is not hex. Write the bytes like 02 00 12 34 00 24",
    ]
    exit_code, out, _ = decode_lines(capsys, monkeypatch, FRAMES, "--json")
    rows = [json.loads(line) for line in out.splitlines()]
    assert exit_code == 2
    assert [(row["line"], row["verdict"]) for row in rows] == [
        (2, "usable"),
        (4, "not_usable"),
        (6, None),
        (8, "usable"),
    ]


@pytest.mark.slow
def test_the_worst_line_decides(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    fine, reports, fault, unreadable = "02 00 C7 D1 6A 7E\n", "02 20 C7 D1 6A 5E\n", "02 20 C7 D1 6A 5F\n", "x\n"
    for lines, code in (
        ("", 0),
        (fine, 0),
        (fine + reports + fine, 3),
        (reports + fault + reports, 1),
        (unreadable + fault + reports + fine, 2),
    ):
        assert decode_lines(capsys, monkeypatch, lines)[0] == code


def test_a_long_token_is_visibly_cut(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    _, _, err = decode_lines(capsys, monkeypatch, "02 " + "z" * 300 + "\n")
    assert "zzz...' is not hex" in err
    assert len(err) < 200
    _, _, err = decode_lines(capsys, monkeypatch, "02 z\x1b[2J\n")
    assert r"'z\x1b' is not hex" in err


@pytest.mark.slow
def test_other_streams(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "codewheel", "decode", "AMM5A23/65KJP1", "-"]
    done = subprocess.run(command, input=b"\xff\xfe\n02 00 C7 D1 6A 7E\n", capture_output=True)
    assert done.returncode == 2
    assert b"line 1" in done.stderr
    assert b"Traceback" not in done.stderr
    assert b"line 2" in done.stdout
    done = subprocess.run(f"{shlex.join(command)} <&-", shell=True, capture_output=True)
    assert done.returncode == 2
    assert done.stderr == b"codewheel: cannot read frames: standard input is closed\n"
    # The reader leaves after the first line, but the exit code still reports that frame's error.
    lines = tmp_path / "frames"
    lines.write_text("02 20 C7 D1 6A 5F\n" * 2000)
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {shlex.join(command)} < {shlex.quote(str(lines))} | head -1"],
        capture_output=True,
    )
    assert done.returncode == 1
    assert done.stderr == b""


# ----------------------------------------------------------------------------------------------------- typing mistakes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "message"),
    [
        (
            "022 0C7D16A5E",
            "'022' has an odd number of hex digits: one is missing or one too many",
        ),
        ("02 20C", "'20C' has an odd number of hex digits: one is missing or one too many"),
        ("02 20 C7 D1 6A 5", "'5' is one hex digit. Write 05 if it is a byte"),
        ("2 3 4 5 6 7", "'2' is one hex digit. Write 02 if it is a byte"),
        (
            "2 32 199 209 106 94",
            "'2 32 199 209 106 94' could be decimal bytes. Write 0x02 0x20 0xC7 0xD1 0x6A 0x5E if it is decimal",
        ),
        ("", "the frame is empty"),
        (",", "the frame is empty"),
    ],
)
def test_no_digit_is_guessed(capsys: Capture, typed: str, message: str) -> None:
    assert refusal(capsys, "AMM5A23/65KJP1", typed) == message
    assert refusal(capsys, "AMM5A21/65KSC1", "--as", "serial_number", typed) == message


def test_bytes_in_pieces(capsys: Capture) -> None:
    for typed in ("0220C7D16A5E", "0x02 0x20 0xC7,0xD1 6A5E", "0x2 20 C7 D1 6A 5E", "2 20 C7 D1 6A 5E"):
        assert decode(capsys, "AMM5A23/65KJP1", typed)[1]["crc"]["ok"] is True


def test_several_words_are_several_frames_over_spi(capsys: Capture) -> None:
    """An array of 16-bit words from a program. Each is the reply in one access."""
    for typed in ("0x3FFF 0x7FFE 0x8124", "{0x3FFFu, 0x7FFE, 0x8124};", "3FFF 7FFE 8124"):
        assert main(["decode", "AS5047P", "--json", typed]) == 3
        frames = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert [(frame["line"], frame["fields"][-1]["value"]) for frame in frames] == [
            (1, 0x3FFF),
            (2, 0x3FFE),
            (3, 0x0124),
        ]
    typed = "1111111111111111 111111111111110 1000000100100100"  # a program that omits leading zeros
    assert main(["decode", "AS5047P", "--json", typed]) == 3
    frames = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [frame["fields"][-1]["value"] for frame in frames] == [0x3FFF, 0x3FFE, 0x0124]
    assert decode(capsys, "AS5047P", "3F FF")[1]["fields"][-1]["value"] == 0x3FFF


@pytest.mark.parametrize(
    "typed",
    ["18:36:58.979 -> 0xC000", "MISO: 0xC000", "Read returned: 1100000000000000", "uint8_t rx[2] = {0xC0, 0x00};"],
)
def test_a_label_or_an_arrow_is_not_part_of_a_frame(capsys: Capture, typed: str) -> None:
    assert decode(capsys, "AS5048A", typed)[1]["fields"][0]["raw"] == 1


@pytest.mark.slow
def test_a_frame_of_bits_as_bytes(capsys: Capture) -> None:
    """Position 1,000,003 of the manual, in the bytes that a master passes on."""
    for typed in ("0F 42 43 D3", "00 00 0F 42 43 D3", "0x0F 0x42 0x43 0xD3", "0xF4243D3", "0F4243D3", "F 42 43 D3"):
        exit_code, data = decode(capsys, "AMM5A21/65KSC1", typed)
        assert exit_code == 0
        assert data["fields"][-1]["value"] == 1000003
    assert (
        refusal(capsys, "AMM5A21/65KSC1", "101")
        == "'101' is not a frame of 45 bits. Write 0x65 if it is decimal, 0x101 if it is hex, 0b101 if it is bits"
    )
    assert refusal(capsys, "AMM5A21/65KSC1", "10 11") == "'10 11' could be bits or hex bytes. Prefix it with 0b or 0x"
    assert "Write 0b and all 45 bits" in refusal(capsys, "AMM5A21/65KSC1", "0F 42 4")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "typed", "meanings"),
    [
        (
            "AMM5A21/65KBG1",
            "[15, 66, 67, 11, 12]",
            "0x0F 0x42 0x43 0x0B 0x0C if it is decimal, 0x15 0x66 0x67 0x11 0x12 if it is hex",
        ),
        (
            "AMM5A17/1BG1",
            "18,52,86",
            "0x12 0x34 0x56 if it is decimal, 0x18 0x52 0x86 if it is hex",
        ),
        (
            "AMM5A23/65KJP1",
            "2, 16, 19, 20, 10, 12",
            "0x02 0x10 0x13 0x14 0x0A 0x0C if it is decimal, 0x02 0x16 0x19 0x20 0x10 0x12 if it is hex",
        ),
        (
            "AMM5A17/1BG1",
            "1 226 64",
            "0x01 0xE2 0x40 if it is decimal",
        ),
        (
            "AMM5A23/65KJP1",
            "rx: [2, 0, 199, 209, 106, 126]",
            "0x02 0x00 0xC7 0xD1 0x6A 0x7E if it is decimal",
        ),
    ],
)
def test_an_array_of_decimal_bytes_is_not_read_as_hex(capsys: Capture, code: str, typed: str, meanings: str) -> None:
    """A program prints an array in decimal. In hex, the first one would be a different position, without any error."""
    assert refusal(capsys, code, typed) == f"'{typed}' could be decimal bytes. Write {meanings}"


def test_an_array_of_single_digits_has_one_meaning(capsys: Capture) -> None:
    for typed in ("0,1,2", "[0, 1, 2]", "{0, 1, 2}"):
        assert "position 0x102 258 counts" in text(capsys, "ssi:position=24", typed)[1]
    assert "'0' is one hex digit" in refusal(capsys, "AMM5A23/65KJP1", "0,1,1")


def test_a_number_above_255_in_a_list_of_bytes_is_named(capsys: Capture) -> None:
    message = refusal(capsys, "AMM5A23/65KJP1", "18,300,86")
    assert message.startswith("'300' is not a byte: it is above 255 in decimal, and has an odd number of hex digits")


def test_a_shift_that_a_crc_does_not_detect_is_a_reading(capsys: Capture) -> None:
    """The CRC of the MT6701 starts with 0 and is not inverted, so a frame that is shifted by a 0 is valid too."""
    output = text(capsys, "MT6701", "d5 e0 0a")[1]
    assert "Does the position look wrong? The position would be 6844 if it was read one clock late." in output


def test_all_bits_of_too_many_bytes_count(capsys: Capture) -> None:
    assert "length error: 'ssi_word' has 8 bits, got 16" in text(capsys, "ssi:position=8", "12 34")[1]


def test_an_array_with_a_leading_zero_or_a_letter_is_hex(capsys: Capture) -> None:
    for typed in ("[00, 12, 34]", "[0F, 42, 34]", "{0x12, 0x34}", "00,12,34", "1F,42,34", "12,34,05"):
        assert decode(capsys, "AMM5A17/1BG1", typed)[0] in (0, 1)


@pytest.mark.slow
def test_degrees_and_micrometres(capsys: Capture) -> None:
    # 1,000,003 of 2^21 counts are 171.66... degrees; SMA21 manual 7.3.4: 123 counts at 50 µm are 6.15 mm.
    assert "position: 171.6619° of revolution 0 CRC" in text(capsys, "AMM5A21/65KSC1", "0xF4243D3")[1]
    assert "singleturn: 300.42968° CRC" in text(capsys, "AMM5A23/65KJP1", "02 00 C7 D1 6A 7E")[1]
    assert "position: 6,150 µm CRC" in text(capsys, "SMA21-JP1-0050", reply(0xA2, 0, 123, 0, 0, 0))[1]


def test_one_byte_is_no_bytes(capsys: Capture) -> None:
    message = refusal(capsys, "AMM5A21/65KSC1", "--as", "command", "01 02")
    assert message == "the register 'command' has 1 byte, but the text has 2 bytes"
    assert "Master → Encoder: CF, 1 byte " in text(capsys, "AMM5A23/65KJP1", "--from", "master", "02")[1]


def test_the_status_bits_of_biss_need_no_word(tmp_path: Path, capsys: Capture) -> None:
    """nE and nW are the error and warning bits of BiSS, 0 while active, even if a spec says no more about them."""
    specs = Path(__file__).parents[1] / "specs"
    spec = (specs / "bits22.yaml").read_text(encoding="utf-8")
    assert spec.count(", makes_position: ") == 2
    for word in ("not_usable", "usable_with_warning"):
        spec = spec.replace(f", makes_position: {word}", "")
    (tmp_path / "bits22.yaml").write_text(spec, encoding="utf-8")
    (tmp_path / "manufacturer.yaml").write_text(
        (specs / "manufacturer.yaml").read_text(encoding="utf-8"), encoding="utf-8"
    )
    verdicts = []
    for folder in (specs, tmp_path):
        devices, report = load_library([folder / "bits22.yaml"])
        assert not report
        layout = next(layout for layout in devices[0].interface("biss").layouts if layout.sender == "encoder")
        verdicts.append([field.kind.makes_position for field in layout.fields if isinstance(field.kind, Flag)])
    assert verdicts == [[Verdict.NOT_USABLE, Verdict.USABLE_WITH_WARNING]] * 2


@pytest.mark.slow
def test_many_frames_lead_to_the_command_of_the_package(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("codewheel.commands.decode.decoding.MANY", 3)
    told = "codewheel: 3 frames; for files, the Python package is faster: lika-encoders decode\n"
    for count, expected in ((3, ""), (4, told), (6, told)):
        monkeypatch.setattr("sys.stdin", io.StringIO("0xF4243D3\n\n" * count))
        assert main(["decode", "AMM5A21/65KSC1", "-", "--json"]) == 0
        out, err = capsys.readouterr()
        assert (out.count("\n"), err) == (count, expected)


@pytest.mark.parametrize(
    ("byte_order", "high", "low", "place"),
    [
        # Bits 11:0 of two bytes are the whole low byte, and bits 3:0 of the high byte.
        ("high_byte_first", 11, 0, "bytes 0.3-1.0"),
        ("low_byte_first", 11, 0, "bytes 0.0-1.3"),
        ("high_byte_first", 13, 4, "bytes 0.5-1.4"),
        ("low_byte_first", 13, 4, "bytes 0.4-1.5"),
        ("high_byte_first", 15, 0, "bytes 0-1"),
        ("high_byte_first", 12, 12, "byte 0.4"),
    ],
)
def test_the_place_of_a_field_in_bytes(byte_order: str, high: int, low: int, place: str) -> None:
    layout = cast(Layout, SimpleNamespace(in_bytes=True, byte_order=byte_order))
    assert bit_place(layout, 16, high, low) == place


# --------------------------------------------------------------------------------- frames that can also be other frames


@pytest.mark.parametrize(
    ("arguments", "other_layouts", "words"),
    [
        # Both replies consist of a number and two check bits.
        ("AMT212B AB61", ["turns_reply"], "this can also be another frame: turns_reply (choose with --layout)"),
        ("AMT212B AB61 --layout position_reply", [], ""),
        ("AS5047P 0x0123", ["register_reply"], "this can also be another frame: register_reply (choose with --layout)"),
        # The parity is wrong in both.
        ("AS5047P 0x0124", [], ""),
        # The words of 17 bits have the parity of the others behind them. Here it is wrong.
        ("MA732 0b00000000000000011", [], ""),
        ("MA732 0x0123", ["register_reply"], "this can also be another frame: register_reply (choose with --layout)"),
        # The address of the request for the position is a constant.
        (
            "AS5047P 0x1001 --from master",
            ["write_request", "write_data"],
            "this can be another frame: write_request, write_data (choose with --layout)",
        ),
        ("AS5047P 0xFFFC --from master", ["read_request"], "this is a valid read_request: add --layout read_request"),
        ("SKM36 404200272551 51", [], ""),
        (
            "SKM36 40520000000012",
            ["type_label_reply"],
            "this is a valid type_label_reply: add --layout type_label_reply",
        ),
        # The replies have other lengths.
        (
            "OrbisSerial-14 74 00 00 01 0D",
            ["temperature_reply"],
            "this is a valid temperature_reply: add --layout temperature_reply",
        ),
        ("OrbisSerial-14 74 00 00 01", [], ""),
        # The control field identifies the frame.
        ("TS5700N8401 02 00 12 34 00 24", [], ""),
    ],
)
def test_other_frames_that_it_can_be(capsys: Capture, arguments: str, other_layouts: list[str], words: str) -> None:
    options = ("--specs", ENCODERS, *arguments.split())
    assert decode(capsys, *options)[1]["other_layouts"] == other_layouts
    printed = text(capsys, *options)[1]
    assert words in printed
    assert printed.count("--layout") == bool(other_layouts)


def test_a_line_without_an_end_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: Capture) -> None:
    """Its rest is skipped in pieces, so it does not fill the memory, and the next line has the right number."""
    monkeypatch.setattr("sys.stdin", io.StringIO("0" * 1_000_000 + "\n0x5\n" + "1" * (1 << 16)))
    main(["decode", "--specs", ENCODERS, "MA732", "-"])
    captured = capsys.readouterr()
    assert captured.err.splitlines() == [
        "codewheel: line 1: the text is longer than any frame or register",
        "codewheel: line 3: the text is longer than any frame or register",
    ]
    assert captured.out.startswith("line 2: MA732")


def test_another_frame_that_has_nothing_to_check(tmp_path: Path, capsys: Capture) -> None:
    """Any bytes are a valid frame then, so it is only a possibility."""
    shutil.copytree(Path(ENCODERS) / "cui", tmp_path, dirs_exist_ok=True)
    spec = tmp_path / "amt21.yaml"
    before, _, after = spec.read_text(encoding="utf-8").partition("          - {name: turns, bits: 14")
    turns = "          - {name: turns, bits: 16, signed: true, unit: revolutions, meaning: Number of revolutions}\n"
    spec.write_text(before + turns + after[after.index("\n# The example") :], encoding="utf-8")
    printed = text(capsys, "--specs", str(tmp_path), "AMT212B", "AB 62")[1]
    assert "constant error: k0" in printed
    assert "this can be another frame: turns_reply (choose with --layout)" in printed


def test_frames_of_bits_and_of_bytes_on_one_interface(tmp_path: Path, capsys: Capture) -> None:
    """The bits of a short data channel are not read as the bytes of a long one, although 0 and b are hex digits."""
    shutil.copy(SPECS / "manufacturer.yaml", tmp_path)
    short = "{name: short, from: encoder, channel: 1, source: '6.1', fields: [{name: number, bits: 5}]}"
    old = "      - name: single_cycle_data\n"
    spec = (SPECS / "long.yaml").read_text(encoding="utf-8")
    spec = spec.replace(old, f"      - {short}\n{old}        channel: 2\n")
    (tmp_path / "long.yaml").write_text(spec, encoding="utf-8")
    assert decode(capsys, "--specs", str(tmp_path), "LB", "0b0101101")[1]["other_layouts"] == []


@pytest.mark.parametrize("separator", ["", "_"])
def test_the_bits_of_a_long_frame(tmp_path: Path, capsys: Capture, separator: str) -> None:
    """It has 70 bits, and two zeros that are not sent fill its first byte."""
    for name in ("long.yaml", "manufacturer.yaml"):
        shutil.copy(SPECS / name, tmp_path)
    bits = f"0b{5:032b}{separator}{1000:032b}{separator}{3:06b}"
    data = decode(capsys, "--specs", str(tmp_path), "LS", bits)[1]
    values = {field["name"]: field["value"] for field in data["fields"]}
    assert (data["problems"], values["multiturn"], values["singleturn"], values["status"]) == ([], 5, 1000, 3)
    for wrong_length in (f"{bits}0", bits[:-1]):
        message = refusal(capsys, "--specs", str(tmp_path), "LS", wrong_length)
        remedy = "Write 0b and all 70 bits in the order sent, or 9 hex bytes with zeros in front"
        assert message.endswith(f"is not a frame of 70 bits. {remedy}")


def test_0b_are_hex_digits_over_rs_485(capsys: Capture) -> None:
    printed = text(capsys, "--specs", ENCODERS, "AMT212B", "0b01")[1]
    assert "bytes 0.0-1.5 position 0x10b 267" in printed
