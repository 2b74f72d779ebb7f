"""BiSS frames with two data channels, in five engines, against a decoder that is written here.

The encoder is made up. Its words, their CRCs and their comparison follow the profile BiSS Safety, and its order codes
are configurations of table 1 in iC-Haus, BiSS Safety Concept, revision A5: the words of RXH have 24 and 16 bits for the
angle, of which 13 must agree, with a tolerance of one.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from c_harness import GCC, write
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device, Verdict, channel_frame
from codewheel.reference.codec import decode_channels
from codewheel.reference.findings import channel_findings
from codewheel.targets import Library
from codewheel.targets.browser.files import generate as generate_page
from codewheel.virtual.clocked_lines import BissLine
from codewheel.virtual.encoder import VirtualEncoder
from exhaustive import mostly_exhaustive
from five_engines import NOT_USABLE, SPECS, USABLE, VERDICTS, WARNING, Import, joined, load_made, remainder

ENCODERS = Path(__file__).resolve().parents[2] / "specs"
COUNTS = mostly_exhaustive([100, 4000], 100)


@dataclass(frozen=True)
class Configuration:
    """Bits of the revolutions and of the angles in the two words, and the bits of the angles that must agree."""

    turns: int
    control: int
    safety: int
    compared: int

    @property
    def control_bits(self) -> int:
        return self.turns + self.control + 2 + 6

    @property
    def safety_bits(self) -> int:
        return self.turns + self.safety + 2 + 6 + 16

    @property
    def bits(self) -> int:
        return self.control_bits + self.safety_bits


CONFIGURATIONS = {
    "RXM": Configuration(0, 16, 12, 9),
    "RXH": Configuration(0, 24, 16, 13),
    "RSM": Configuration(12, 16, 12, 9),
    "RSH": Configuration(12, 24, 16, 13),
}


@dataclass(frozen=True)
class Case:
    """A frame with the result that every engine must give. ``position`` is None for a frame with an error."""

    code: str
    number: int
    fault: str
    verdict: str = ""
    position: int | None = None
    life: int = 0


def control_word(made: Configuration, turn: int, angle: int, error: int, warning: int) -> int:
    data = joined(
        {"turn": turn, "angle": angle, "error": error, "warning": warning},
        [("turn", made.turns), ("angle", made.control), ("error", 1), ("warning", 1)],
    )
    return data << 6 | remainder(data, made.control_bits - 6, 0x03, 6) ^ 0x3F


def safety_word(made: Configuration, turn: int, angle: int, error: int, warning: int, life: int) -> int:
    data = joined(
        {"turn": turn, "angle": angle, "error": error, "warning": warning, "life": life},
        [("turn", made.turns), ("angle", made.safety), ("error", 1), ("warning", 1), ("life", 6)],
    )
    return data << 16 | remainder(data, made.safety_bits - 16, 0x90D9, 16) ^ 0xFFFF


def whole(made: Configuration, control: int, safety: int) -> int:
    return control << made.safety_bits | safety


def random_case(code: str, random_: random.Random) -> Case:
    """Return a frame. Half of them are disturbed: an inverted bit, or positions that may not agree."""
    made = CONFIGURATIONS[code]
    angle, life = random_.getrandbits(made.control), random_.getrandbits(6)
    turn = random_.getrandbits(made.turns) if made.turns else 0
    safe_angle = angle >> made.control - made.safety
    disturbance = random_.choice(["none", "none", "none", "bit", "angle", "flags"])
    flags = [1, 1, 1, 1]
    if disturbance == "flags":
        flags = [random_.getrandbits(1) for _ in flags]
    if disturbance == "angle":
        # From two units below to two units above, in units of the lowest bit that is compared.
        unit = 1 << made.safety - made.compared
        safe_angle = (safe_angle + random_.randint(-2 * unit - 1, 2 * unit + 1)) % (1 << made.safety)
    control = control_word(made, turn, angle, flags[0], flags[1])
    number = whole(made, control, safety_word(made, turn, safe_angle, flags[2], flags[3], life))
    if disturbance == "bit":
        return Case(code, number ^ 1 << random_.randrange(made.bits), "crc")
    highest = angle >> made.control - made.compared
    safe_highest = safe_angle >> made.safety - made.compared
    size = 1 << made.compared
    agree = (highest - safe_highest) % size in (0, 1, size - 1)
    verdict = USABLE
    if not (flags[1] and flags[3]):
        verdict = WARNING
    if not (flags[0] and flags[2] and agree):
        verdict = NOT_USABLE
    return Case(code, number, "", verdict, turn << made.control | angle, life)


@cache
def made_device() -> Device:
    return load_made("channels")


def in_bytes(case: Case) -> bytes:
    return case.number.to_bytes((CONFIGURATIONS[case.code].bits + 7) // 8, "big")


def by_reference(cases: Sequence[Case], *_: object) -> Iterator[Case]:
    device = made_device()
    frame = channel_frame(device.interface("biss"))
    assert frame is not None
    for case in cases:
        variant = device.variant(case.code)
        placed = frame.place(variant.parameters)
        assert placed.join(placed.split(case.number)) == case.number
        control, safety = decode_channels(device, placed, case.number)
        found = channel_findings(device, variant, placed, (control, safety))
        problems = [*control.problems, *safety.problems]
        if problems:
            yield Case(case.code, case.number, problems[0].fault.value)
            continue
        assert found.verdict is not None
        position, life = control.values["position"], safety.values["life"]
        assert isinstance(position, int)
        assert isinstance(life, int)
        yield Case(case.code, case.number, "", found.verdict.value, position, life)


def in_python(cases: Sequence[Case], import_generated: Import, _: Path) -> Iterator[Case]:
    package: Any = import_generated(Library((made_device(),)), "test_encoders")[1]
    for case in cases:
        layout = package.lookup(case.code).channels()
        frame = layout.try_decode(case.number)
        if isinstance(frame, ValueError):
            assert type(frame).__name__ == "CrcError"
            yield Case(case.code, case.number, "crc")
            continue
        assert frame.encode() == case.number
        assert frame.usable_position == (None if frame.verdict.value == NOT_USABLE else frame.position)
        life = frame.channels[1].life
        yield Case(case.code, case.number, "", frame.verdict.value, frame.position, life)


def in_columns(cases: Sequence[Case], import_generated: Import, _: Path) -> Iterator[Case]:
    numpy: Any = pytest.importorskip("numpy")
    package: Any = import_generated(Library((made_device(),)), "test_encoders")[1]
    for order_code in dict.fromkeys(case.code for case in cases):
        cases_of_code = [case for case in cases if case.code == order_code]
        layout = package.lookup(order_code).channels()
        table = layout.decode_many([case.number for case in cases_of_code])
        # The same frames as an array with a row of bytes for each frame.
        frame_bytes = numpy.frombuffer(b"".join(map(in_bytes, cases_of_code)), numpy.uint8)
        table_of_bytes = layout.decode_many(frame_bytes.reshape(len(cases_of_code), -1))
        assert (table_of_bytes.verdict == table.verdict).all()
        life_counters = table.channels[1]["life"]
        for row, case in enumerate(cases_of_code):
            fault, verdict = int(table.fault[row]), table.verdict[row]
            if fault:
                assert verdict == 0
                yield Case(order_code, case.number, {2: "crc"}[fault])
            else:
                position, life = int(table.position[row]), int(life_counters[row])
                yield Case(order_code, case.number, "", VERDICTS[verdict], position, life)


#: Reads lines with the index of an order code and the bytes of a buffer.
_PROGRAM = """
#include <inttypes.h>
#include <stdio.h>
#include "test/channels_biss.h"
int main(void)
{{
    static const test_channels_biss codes[] = {{ {codes} }};
    unsigned code, length, byte;
    while (scanf("%u %u", &code, &length) == 2) {{
        uint8_t rx[32];
        unsigned at;
        for (at = 0; at < length; at++) {{
            if (scanf("%x", &byte) != 1) {{ return 1; }}
            rx[at] = (uint8_t)byte;
        }}
        test_channels_biss_channels frame;
        uint64_t position = 99U;
        const cw_result result = test_channels_biss_channels_receive(codes[code], rx, 8U * length, &frame);
        const cw_verdict verdict = test_channels_biss_control_word_read(codes[code], rx, length, &position);
        printf("%d %d", (int)result, (int)verdict);
        cw_word word;
        if (test_channels_biss_safety_word_receive(codes[code], rx, length, &word) != CW_OK) {{ return 2; }}
        test_channels_biss_safety_word safety;
        const cw_result alone = test_channels_biss_safety_word_decode(codes[code], word, &safety);
        if ((result == CW_OK) && (alone != CW_OK)) {{ return 3; }}
        if (result == CW_OK) {{
            printf(" %d %" PRIu64 " %" PRIu64 " %u",
                (int)test_channels_biss_channels_verdict(codes[code], &frame),
                (uint64_t)frame.control_word.position, position, (unsigned)frame.safety_word.life);
        }}
        printf("\\n");
    }}
    return 0;
}}
"""


def received(case: Case) -> bytes:
    """Return a buffer of BiSS: idle bits, the acknowledge, start bit, CDS, the frame, stop bit and zeros."""
    made = CONFIGURATIONS[case.code]
    bits = f"111000010{case.number:0{made.bits}b}"
    bits += "0" * (-len(bits) % 8 + 8)
    return int(bits, 2).to_bytes(len(bits) // 8, "big")


def in_c(cases: Sequence[Case], _: Import, folder: Path, compiler: Sequence[str] = GCC) -> Iterator[Case]:
    headers = write(folder, (made_device(),))
    codes = list(CONFIGURATIONS)
    program = folder / "channels.c"
    macros = ", ".join(f"TEST_CHANNELS_BISS_{code}" for code in codes)
    program.write_text(_PROGRAM.format(codes=macros), encoding="utf-8")
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-Werror"]
    command = [*compiler, *warnings, f"-I{headers}", str(program), "-o", str(folder / "channels")]
    subprocess.run(command, check=True)
    lines = []
    for case in cases:
        data = received(case)
        lines.append(f"{codes.index(case.code)} {len(data)} {data.hex(' ')}")
    done = subprocess.run([folder / "channels"], input="\n".join(lines), capture_output=True, text=True, check=True)
    for case, line in zip(cases, done.stdout.splitlines(), strict=True):
        result, read_verdict, *rest = map(int, line.split())
        if result:
            assert read_verdict == 0
            yield Case(case.code, case.number, {2: "crc"}[result])
            continue
        verdict, position, read_position, life = rest
        assert verdict == read_verdict
        assert read_position == (position if verdict else 99)
        yield Case(case.code, case.number, "", VERDICTS[verdict], position, life)


_SCRIPT = """
const frames = JSON.parse(require("fs").readFileSync("frames.json", "utf8"));
require("vm").runInThisContext(require("fs").readFileSync("decode.js", "utf8"));
const wheel = globalThis.codewheelDecode;
const results = frames.map(([code, text]) => {
  const found = wheel.decodeFrame(wheel.findCode(code), "encoder", text);
  const field = (name) => Number(found.fields.find((one) => one.name === name).value);
  if (found.problems.length) return [found.problems.map((one) => `${one.fault} ${one.message}`), null, 0, 0];
  return [[], found.verdict, field("position"), field("safety_word.life")];
});
console.log(JSON.stringify(results));
"""


def in_browser(cases: Sequence[Case], _: Import, folder: Path) -> Iterator[Case]:
    node = shutil.which("node") or shutil.which("nodejs")
    if node is None:
        pytest.skip("needs node")
    (folder / "decode.js").write_text(generate_page(Library((made_device(),)))["browser/decode.js"], encoding="utf-8")
    frames = [(case.code, f"0b{case.number:0{CONFIGURATIONS[case.code].bits}b}") for case in cases]
    (folder / "frames.json").write_text(json.dumps(frames), encoding="utf-8")
    done = subprocess.run([node, "-e", _SCRIPT], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for case, (problems, verdict, position, life) in zip(cases, json.loads(done.stdout), strict=True):
        if problems:
            yield Case(case.code, case.number, problems[0].split()[0])
        else:
            yield Case(case.code, case.number, "", verdict, position, life)


ENGINES: Mapping[str, Callable[..., Iterator[Case]]] = {
    "reference": by_reference,
    "python": in_python,
    "columns": in_columns,
    "c": in_c,
    "browser": in_browser,
}


@pytest.mark.slow
@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("engine", ENGINES)
def test_five_engines_agree(engine: str, count: int, import_generated: Import, tmp_path: Path) -> None:
    random_ = random.Random(count)
    cases = [random_case(code, random_) for code in CONFIGURATIONS for _ in range(count)]
    assert {case.verdict for case in cases} == {"", NOT_USABLE, WARNING, USABLE}
    results = list(ENGINES[engine](cases, import_generated, tmp_path))
    assert sorted(results, key=repr) == sorted(cases, key=repr)


def test_a_virtual_encoder_sends_words_that_agree() -> None:
    device = made_device()
    frame = channel_frame(device.interface("biss"))
    assert frame is not None
    for code, made in CONFIGURATIONS.items():
        variant = device.variant(code)
        placed = frame.place(variant.parameters)
        for position in (0, 1, (1 << made.control) - 1, 0x5A5A):
            encoder = VirtualEncoder(code, position, specs=[SPECS / "channels.yaml", SPECS / "manufacturer.yaml"])
            line = BissLine(encoder)
            assert line.bits == made.bits
            channels = decode_channels(device, placed, line.frame())
            found = channel_findings(device, variant, placed, channels)
            assert found.agree is True
            assert found.verdict is Verdict.USABLE
            assert channels[0].values["position"] == position


def decoded(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Return the exit code and the output of ``decode``, with single spaces."""
    code = main(["decode", *arguments, "--specs", str(SPECS)])
    return code, " ".join(capsys.readouterr().out.split())


#: A frame of RXH: angle 123456h in the control word, and the highest 16 bits of another angle in the safety word.
def frame_of_rxh(safe_angle: int) -> str:
    made = CONFIGURATIONS["RXH"]
    number = whole(made, control_word(made, 0, 0x123456, 1, 1), safety_word(made, 0, safe_angle, 1, 1, 5))
    return f"{number:0{made.bits}b}"


def test_decode_shows_both_words_and_their_verdict(capsys: pytest.CaptureFixture[str]) -> None:
    code, text = decoded(capsys, "RXH", f"0b{frame_of_rxh(0x1234)}")
    assert code == 0
    assert "Control position word, 32 bits, data channel 1" in text
    assert "Safety position word, 40 bits, data channel 2" in text
    assert (
        "the highest 13 bits agree: singleturn of control_word 0x246 and safe_singleturn of safety_word 0x246" in text
    )
    assert "all channels together: the position is usable" in text


def test_decode_reports_positions_that_disagree(capsys: pytest.CaptureFixture[str]) -> None:
    code, text = decoded(capsys, "RXH", f"0b{frame_of_rxh(0x1244)}")
    assert code == 3
    assert "the highest 13 bits DISAGREE: singleturn of control_word 0x246" in text
    assert "all channels together: the position is not usable" in text
    assert "position: 25" not in text


def test_decode_says_which_channel_has_the_wrong_crc(capsys: pytest.CaptureFixture[str]) -> None:
    bits = frame_of_rxh(0x1234)
    changed = bits[:40] + str(1 - int(bits[40])) + bits[41:]
    code, text = decoded(capsys, "RXH", f"0b{changed}")
    assert code == 1
    assert "error in safety_word, so the frame has no position" in text
    assert "error in control_word" not in text


def test_why_finds_bits_around_the_frame_and_exchanged_words(capsys: pytest.CaptureFixture[str]) -> None:
    bits = frame_of_rxh(0x1234)
    code, text = decoded(capsys, "RXH", f"0b10{bits}0")
    assert code == 1
    message = "control_word (32 bits) and safety_word (40 bits) have 72 bits together, got 75: 3 bits are too many."
    assert message in text
    assert "All CRCs are correct with 2 extra bits before the frame and 1 after it." in text
    _, text = decoded(capsys, "RXH", f"0b{bits[32:]}{bits[:32]}")
    assert "All CRCs are correct with the channels in the order safety_word, control_word." in text


def test_a_single_word_is_decoded_as_before(capsys: pytest.CaptureFixture[str]) -> None:
    bits = frame_of_rxh(0x1234)
    code, text = decoded(capsys, "RXH", f"0b{bits[:32]}")
    assert code == 0
    assert "Control position word, 32 bits" in text
    assert "all channels together" not in text
    code, text = decoded(capsys, "RXH", f"0b{bits[32:]}", "--layout", "safety_word")
    assert code == 0
    assert "Safety position word, 40 bits" in text


@pytest.mark.parametrize(
    ("text", "has_whole_frame"),
    [
        # 12 bits of revolutions, 24 of the angle, and 0 for the active error: the whole frame without leading zeros.
        ("0x63a2ba03b57", True),
        ("0x63A2BA03B57", True),
        ("00 00 00 06 3A 2B A0 3B 57", True),
        # The position channel alone, with all its digits.
        ("0x000000031D15D", False),
        ("0x0000000031D15D", False),
        ("00 00 00 00 31 D1 5D", False),
        ("0b" + f"{0x31D15D:050b}", False),
    ],
)
def test_a_number_without_leading_zeros_is_a_whole_frame(
    text: str, has_whole_frame: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its bits would also fit into the position channel of 50 bits, which would then be decoded as usable."""
    exit_code = main(["decode", "iC-MR-12-L6T", text, "--specs", str(ENCODERS / "ichaus")])
    output = " ".join(capsys.readouterr().out.split())
    assert exit_code == 3
    assert "error (nE): an error is active" in output
    assert ("all channels together: the position is not usable" in output) is has_whole_frame


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0F 42 43 00 00 00 00 00", "71 bits together, got 64: 7 bits are missing."),
        ("0b" + "01" * 35, "71 bits together, got 70: 1 bit is missing."),
        ("0b" + "01" * 36, "71 bits together, got 72: 1 bit is too many."),
    ],
)
def test_a_frame_of_another_length_has_the_bits_of_each_channel(
    text: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    exit_code = main(["decode", "iC-MR-12-L6T", text, "--specs", str(ENCODERS / "ichaus")])
    output = " ".join(capsys.readouterr().out.split())
    assert exit_code == 1
    remedy = "Write all of them, or all bits of a single channel"
    assert f"length error: pos (50 bits) and tmp (21 bits) have {words} {remedy}" in output


def test_json_has_both_words_in_the_shape_of_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    number = int(frame_of_rxh(0x1244), 2)
    arguments = ["decode", "RXH", f"0x{number:018X}", "--json", "--specs"]
    code = main([*arguments, str(SPECS)])
    data = json.loads(capsys.readouterr().out)
    schema = json.loads((resources.files("codewheel.language") / "decode.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(data)
    assert (code, data["verdict"], data["agree"]) == (3, "not_usable", False)
    assert [channel["layout"] for channel in data["channels"]] == ["control_word", "safety_word"]
    assert [channel["crc"]["ok"] for channel in data["channels"]] == [True, True]


def test_json_has_the_errors_and_reports_of_all_channels(capsys: pytest.CaptureFixture[str]) -> None:
    """A program that reads only the members of the whole frame sees why it has no usable position."""

    def decode(text: str) -> dict[str, Any]:
        main(["decode", "iC-MR-12-L6T", text, "--json", "--specs", str(ENCODERS / "ichaus")])
        data: dict[str, Any] = json.loads(capsys.readouterr().out)
        return data

    active_error = decode("0x63a2ba03b57")
    assert (active_error["verdict"], active_error["problems"]) == ("not_usable", [])
    assert [report["field"] for report in active_error["reports"]] == ["error"]
    assert active_error["reports"] == active_error["channels"][0]["reports"]
    wrong_crc = decode("0x63a2ba03b56")
    assert wrong_crc["verdict"] is None
    assert [problem["kind"] for problem in wrong_crc["problems"]] == ["crc"]
    assert wrong_crc["problems"][0]["message"] == f"tmp: {wrong_crc['channels'][1]['problems'][0]['message']}"


def test_the_published_word_of_a_safety_encoder_has_this_crc() -> None:
    """Word in a log of TI's motor-control SDK: 65535 turns, angle 2924 of 4096, nE 0, nW 1, counter 57, CRC D79Fh."""
    made = Configuration(16, 0, 12, 0)
    assert safety_word(made, 65535, 2924, 0, 1, 57) & 0xFFFF == 55199


@pytest.mark.slow
def test_a_whole_frame_in_decode_of_a_single_channel_gets_a_hint(import_generated: Import) -> None:
    package: Any = import_generated(Library((made_device(),)), "test_encoders")[1]
    encoder = package.lookup("RXH")
    bits = frame_of_rxh(0x1234)
    expected_hint = "The frame has several data channels, and this decodes a single one: use channels().decode"
    # As text, as bytes, as a number with all its bits, and as one whose two highest bits are 0.
    made = CONFIGURATIONS["RXH"]
    low_number = whole(made, control_word(made, 0, 0x123456, 1, 1), safety_word(made, 0, 0x1234, 1, 1, 5))
    high_number = whole(made, control_word(made, 0, 0xF23456, 1, 1), safety_word(made, 0, 0xF234, 1, 1, 5))
    for frame in (bits, f"0b{bits}", low_number.to_bytes(9, "big"), high_number, low_number):
        error = encoder.try_decode(frame)
        assert (type(error).__name__, error.hint) == ("LengthError", expected_hint)
        assert package.why(encoder, frame) == (expected_hint.replace("The", "the", 1),)
    # The length alone shows it, also with a disturbed bit.
    assert encoder.try_decode(high_number ^ 1 << 30).hint == expected_hint
    # A single word that is one bit too long has another cause.
    one_bit_more = control_word(made, 0, 0xF23456, 1, 1) << 1
    assert "without its last 1 bit" in encoder.try_decode(one_bit_more).hint


@pytest.mark.slow
def test_channels_without_a_comparison(import_generated: Import, tmp_path: Path) -> None:
    """A position with a CRC of 16 bits, and a temperature of the same length for all order codes, without flags."""
    folder = Path(__file__).resolve().parents[2] / "docs" / "example" / "tolvarn"
    text = (folder / "tv62.yaml").read_text(encoding="utf-8")
    text = text.replace(
        "    bank_select: bank\n    layouts:\n",
        '    bank_select: bank\n    channels: {order: [position_data, temperature_data], source: "3"}\n    layouts:\n',
    )
    (tmp_path / "tv62.yaml").write_text(text, encoding="utf-8")
    shutil.copy(folder / "manufacturer.yaml", tmp_path)
    (device,), report = load_library([tmp_path])
    assert not report
    library = Library((device,))
    package: Any = import_generated(library, "tolvarn_encoders")[1]
    layout = package.lookup("TV62-M17-B1").channels()
    # The two words of the manual's examples.
    number = int("01001101001001111111110011000111001010100010110000111" + "000000001110101100101", 2)
    frame = layout.decode(number)
    assert (frame.agree, frame.verdict.value) == (None, USABLE)
    assert [channel.to_dict().get("temperature") for channel in frame.channels] == [None, 235]
    assert frame.position == 1234 << 17 | 65432
    assert frame.encode() == number
    np: Any = pytest.importorskip("numpy")
    table = layout.decode_many([number, number ^ 1])
    assert np.array_equal(table.fault, [0, 2])
    assert [VERDICTS[verdict] for verdict in table.verdict] == [USABLE, NOT_USABLE]
    include = write(tmp_path / "c", (device,))
    program = tmp_path / "program.c"
    program.write_text(
        '#include "tolvarn/tv62_biss.h"\n'
        "int main(void)\n{\n    uint8_t rx[TOLVARN_TV62_BISS_M17_B1_POSITION_DATA_RX_BYTES] = {0};\n"
        "    uint32_t position = 0U;\n"
        "    return (int)TOLVARN_TV62_BISS_READ(M17_B1, rx, &position);\n}\n",
        encoding="utf-8",
    )
    command = [*GCC, "-Wall", "-Wextra", "-Werror", f"-I{include}", str(program), "-o", str(tmp_path / "program")]
    subprocess.run(command, check=True)
    assert subprocess.run([tmp_path / "program"]).returncode == 0
