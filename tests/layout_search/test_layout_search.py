"""The layouts of unknown encoders are found from frames, which an encoder in ``made_layouts`` sent."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from codewheel.commands.cli import main
from codewheel.commands.decode.frames import decode_text
from codewheel.language.problems import ProblemReport
from codewheel.language.read import read_document
from codewheel.layout_search.answers import PossibleLine, answer_with_lines
from codewheel.layout_search.frames import RecordedFrames
from codewheel.layout_search.search import find_layouts
from codewheel.model.fields import KNOWN_CRCS
from codewheel.one_line.parse import parse_line
from codewheel.one_line.spec import device_of_line
from judge_layouts import is_right
from made_layouts import LAYOUTS, Made, made, shift_register, turning

Run = Callable[..., tuple[int, str, str]]
SPECS = Path(__file__).parents[2] / "specs"


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: str) -> tuple[int, str, str]:
        code = main(arguments)
        out, err = capsys.readouterr()
        return code, out, err

    return run


def answers_for(
    layout: Made, count: int, seed: int, *, with_positions: bool = False
) -> tuple[list[PossibleLine], list[str]]:
    """Return the answers for frames of a turning shaft, and the bits of the frames."""
    random_numbers = random.Random(seed)
    positions = turning(count, layout.width, random_numbers)
    frames = [layout.encode(position, random_numbers) for position in positions]
    recording = RecordedFrames(
        interface=parse_line(layout.line).interface,
        bits=len(frames[0]),
        frames=tuple(int(frame, 2) for frame in frames),
        positions=tuple(map(float, positions)) if with_positions else (),
    )
    return [answer_with_lines(recording, found) for found in find_layouts(recording)], frames


def share_right(count: int, rank: int, seeds: range, *, with_positions: bool = False) -> float:
    """Return the share of recordings whose layout is among the first ``rank`` answers."""
    right = []
    for index, layout in enumerate(LAYOUTS):
        for seed in seeds:
            answers, frames = answers_for(layout, count, 1000 * index + seed, with_positions=with_positions)
            first_answers = answers[:rank]
            right.append(
                any(is_right(found, layout.line, frames, only_first=with_positions) for found in first_answers)
            )
    return sum(right) / len(right)


def test_twenty_layouts_that_differ() -> None:
    assert len({layout.line for layout in LAYOUTS}) == len(LAYOUTS) == 20
    for layout in LAYOUTS:
        frame = layout.encode(1234, random.Random(1))
        assert len(frame) == parse_line(layout.line).bits


@pytest.mark.slow
def test_few_recordings() -> None:
    assert share_right(20, 1, range(1)) >= 0.9
    assert share_right(5, 3, range(1)) >= 0.8


@pytest.mark.exhaustive
@pytest.mark.parametrize("with_positions", [False, True])
def test_many_recordings(with_positions: bool) -> None:
    assert share_right(20, 1, range(100, 103), with_positions=with_positions) >= 0.9
    assert share_right(5, 3, range(100, 103), with_positions=with_positions) >= 0.8


def test_the_first_line_decodes_other_frames() -> None:
    random_numbers = random.Random(7)
    for index in (0, 4, 7, 18):
        layout = LAYOUTS[index]
        answers, _ = answers_for(layout, 20, 5)
        device, match = device_of_line(answers[0].line)
        for _ in range(5):
            position = random_numbers.getrandbits(layout.width)
            frame = decode_text(device, match.variant, "encoder", f"0b{layout.encode(position, random_numbers)}")
            assert (frame.problems, frame.values["position"]) == ((), position), layout.line


def test_start_value_and_inversion_are_one_class() -> None:
    answers, frames = answers_for(LAYOUTS[0], 20, 3)
    equal_lines = [answers[0].line, *(same.line for same in answers[0].equal_lines)]
    crc_fields = [parse_line(line).fields[-1] for line in equal_lines]
    for crc_field in crc_fields:
        assert shift_register(frames[0][:-6], 6, 0x43, crc_field.init, crc_field.is_inverted) == frames[0][-6:]  # type: ignore[union-attr]
    assert len({(crc_field.init, crc_field.is_inverted) for crc_field in crc_fields}) == 2  # type: ignore[union-attr]
    reasons = [same.reason for same in answers[0].equal_lines]
    assert any("start value and inversion" in reason for reason in reasons)


def test_constants_are_not_named() -> None:
    answers, _ = answers_for(LAYOUTS[0], 20, 3)
    assert "error" not in answers[0].line
    assert any("Constant bits cannot be named" in note for note in answers[0].notes)
    assert any("error,warning" in same.line for same in answers[0].equal_lines)


@pytest.mark.slow
def test_random_frames_have_no_crc() -> None:
    random_numbers = random.Random(9)
    for _ in range(20):
        recording = RecordedFrames("biss", 32, tuple(random_numbers.getrandbits(32) for _ in range(6)))
        assert all("crc=" not in answer_with_lines(recording, layout).line for layout in find_layouts(recording))


def test_a_polynomial_that_nobody_lists() -> None:
    layout = made("biss:position=24,crc=6:0x59", 24, ["p"], (6, 0x59, 0, True))
    answers, frames = answers_for(layout, 20, 1)
    assert is_right(answers[0], layout.line, frames)
    assert any("not in the list" in note for note in answers[0].notes)


def test_every_crc_of_a_spec_is_known() -> None:
    known = {known_crc.polynomial for known_crc in KNOWN_CRCS}
    for path in sorted(SPECS.glob("*/*.yaml")):
        if path.parent.name == "masters" or "second" in path.name or path.name == "manufacturer.yaml":
            continue
        document = read_document(path, ProblemReport())
        assert document is not None
        for crc in document.data.get("crcs", []):
            assert crc["poly"] | 1 << crc["width"] in known, path.name


# -- the command


FRAMES = ["0b000010111011111100101011011100", "0b000010111111110110101111001110", "0b000011000100100101010011110010"]


def test_the_command_names_how_to_go_on(run: Run) -> None:
    # The first frame is the real capture of tests/vectors.json: position 192458 of 22 bits.
    code, out, err = run("find", "biss", *FRAMES)
    assert (code, err) == (0, "")
    assert "\n1. biss:position=22,unused=2,crc=6:0x43\n" in out
    commands = re.findall(r"^  codewheel (.*)$", out, re.MULTILINE)
    assert commands[0].startswith("decode biss:position=22,unused=2,crc=6:0x43 0b0000")
    code, decoded, _ = run(*commands[0].split())
    assert code == 0
    assert "192458" in decoded
    assert commands[1] == "new my_encoder --line biss:position=22,unused=2,crc=6:0x43"


def test_hexadecimal_frames_and_json(run: Run) -> None:
    texts = [hex(int(frame, 2)) for frame in FRAMES]
    _, out, _ = run("find", "biss", "--bits", "30", "--json", *texts)
    data = json.loads(out)
    assert (data["version"], data["frames"], data["bits"]) == (1, 3, 30)
    assert data["layouts"][0]["line"] == "biss:position=22,unused=2,crc=6:0x43"


def test_bytes_of_rs485(run: Run) -> None:
    # Little-endian positions of 24 bits after two constant bytes, with the XOR of all bytes at the end.
    random_numbers = random.Random(4)
    frames = []
    for position in turning(8, 24, random_numbers):
        data = bytes([0x02, 0x20]) + position.to_bytes(3, "little")
        check = 0
        for byte in data:
            check ^= byte
        frames.append((data + bytes([check])).hex(" "))
    _, out, _ = run("find", "rs485", *frames)
    assert "\n1. rs485,low_byte_first:unused=16,position=24,crc=8:0x101\n" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["0b01"], "one frame does not show a layout; give at least 2, and turn the shaft between them"),
        (["0b01", "0b011"], "the frames have 2 to 3 bits; give frames of the same length"),
        (["0b01", "0b01"], "all frames are equal; turn the shaft"),
        (["0b01", "12"], "'12' is not a frame; write 0b... with every bit, 0x..., or hex bytes"),
        (["0b01", "0b10", "--positions", "1"], "1 position for 2 frames; give one for each frame"),
        (["0b01", "0b10", "--positions", "a,b"], "'a,b' is not a list of numbers"),
        (["0b01", "0b10", "--positions", "nan,1"], "a position is not a finite number"),
        (["0b01", "0b10", "--positions", "1e200,0"], "a position is beyond ±1e+20"),
        (["0x100", "0x1", "--bits", "8"], "'0x100' has more than 8 bits"),
        ([f"0b{'01' * 40}", f"0b{'10' * 40}"], "the frames have 80 bits; a line has at most 64"),
    ],
)
def test_wrong_arguments(run: Run, arguments: list[str], message: str) -> None:
    code, out, err = run("find", "ssi", *arguments)
    assert (code, out) == (1 if "equal" in message else 2, "")
    assert message in err


@pytest.mark.parametrize("frames", [["0xFFFF"] * 3, ["0x0000"] * 3, ["0xFFFF", "0x0000", "0xFFFF", "0x0000"]])
def test_a_dead_line_has_no_layout(run: Run, frames: list[str]) -> None:
    code, out, err = run("find", "ssi", *frames)
    assert (code, out) == (1, "")
    assert "dead line: all bits of each frame are equal" in err


@pytest.mark.parametrize("frames", [["0xFFFE", "0x1234"], ["0xFFFF", "0xFFFF", "0x1234"]])
def test_too_few_frames(run: Run, frames: list[str]) -> None:
    code, out, _ = run("find", "ssi", *frames)
    assert code == 0
    assert "Too few frames" in out
    assert "To continue" not in out


def test_a_part_of_a_byte_is_no_frame_over_rs485(run: Run) -> None:
    code, out, err = run("find", "rs485", "000F", "000E", "--bits", "12")
    assert (code, out) == (2, "")
    assert "the frames have 12 bits; over RS-485, they are whole bytes" in err


def test_a_frame_of_spi_has_at_least_a_byte(run: Run) -> None:
    code, out, err = run("find", "spi", "0b1010", "0b1011")
    assert (code, out) == (2, "")
    assert "the frames have 4 bits; a line has at least 8" in err


@pytest.mark.slow
def test_great_positions_are_compared(run: Run) -> None:
    assert run("find", "ssi", f"0b{'01' * 32}", f"0b{'10' * 32}", "--positions=1e20,-1e20")[0] == 0


def test_a_wide_field_is_several_fields_of_the_line(run: Run) -> None:
    """A field of a line has at most 64 bits, and so has a position with constant bits in front of it."""
    frames = [bytes([*range(1, 18), position]).hex(" ") for position in (1, 2, 4, 5)]
    out = run("find", "rs485", *frames)[1]
    assert "\n1. rs485:unused=64,unused=64,unused=8,position=8\n" in out
    assert "position=144" not in out
    assert run("decode", "rs485:unused=64,unused=64,unused=8,position=8", frames[0])[0] == 0


def modbus_crc(data: bytes) -> bytes:
    """Return CRC-16/MODBUS as it is sent, low byte first."""
    register = 0xFFFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register >> 1) ^ (0xA001 if register & 1 else 0)
    return register.to_bytes(2, "little")


def test_the_crc_of_modbus(run: Run) -> None:
    """Replies with one register, from a unit at address 1."""
    assert modbus_crc(b"123456789") == bytes.fromhex("37 4B"), "the check value of this CRC"
    replies = [bytes([1, 3, 2]) + position.to_bytes(2, "big") for position in (0x1234, 0x1250, 0x1299, 0x2001, 0x2F00)]
    frames = [(reply + modbus_crc(reply)).hex(" ") for reply in replies]
    _, out, _ = run("find", "rs485", *frames)
    assert "\n1. rs485,high_byte_first:position=40,crc=16:0x18005:0xffff:reflected:low_byte_first\n" in out
    line = "rs485,high_byte_first:unused=24,position=16,crc=16:0x18005:0xffff:reflected:low_byte_first"
    assert line in out.replace("\n", "").replace(" ", "")
    assert "CRC-16/MODBUS, low byte first, fits all 5 frames" in " ".join(out.split())
    code, decoded, _ = run("decode", line, frames[0])
    assert (code, "4660" in decoded) == (0, True)
    # One wrong CRC, and it is not a CRC of all frames.
    _, out, _ = run("find", "rs485", *frames[:4], "01 03 02 2F 00 00 00")
    assert "MODBUS" not in out
