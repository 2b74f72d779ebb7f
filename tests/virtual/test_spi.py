"""A virtual encoder with SPI, and programs in Python and C that keep a pipeline of one word."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.spi_line import SpiLine
from python_path import new_packages
from working_tools import require

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
SPECS = ROOT / "specs"
#: ``CODEWHEEL_POSITIONS=100000`` reads as many as the longer evidence asks for.
POSITIONS = int(os.environ.get("CODEWHEEL_POSITIONS", "5000"))
DIAAGC = {"diaagc": bytes.fromhex("0180")}


def virtual() -> tuple[VirtualEncoder, SpiLine]:
    encoder = VirtualEncoder("AS5047P", registers=DIAAGC, specs=[SPECS])
    return encoder, SpiLine(encoder)


def even(word: int) -> int:
    """The word with bit 15 such that the number of 1 bits is even."""
    return word | (word.bit_count() & 1) << 15


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("spi")
    specs = sorted(map(str, (SPECS / "ams").glob("*.yaml")))
    assert main(["generate", *specs, "--target", "python", "--target", "c", "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def package(outputs: Path) -> Iterator[Any]:
    sys.path.insert(0, str(outputs / "python"))
    with new_packages():
        yield importlib.import_module("ams_encoders")
    sys.path.remove(str(outputs / "python"))


def test_replies_come_with_the_next_word() -> None:
    """The words are in the comments of a public driver: simplefoc/Arduino-FOC-drivers, AS5047.cpp."""
    encoder, line = virtual()
    encoder.position = 0x1234
    line.exchange(0xFFFF)
    encoder.position = 0x2345
    assert line.exchange(0xFFFC) == even(0x1234)
    assert line.exchange(0xFFFF) == even(0x0180)
    assert line.exchange(0xC018) == even(0x2345)
    assert line.exchange(0xFFFF) == even(0x0001), "the default of SETTINGS1"


def test_a_register_is_written_in_two_words() -> None:
    """SETTINGS1 at 18h: the reply to the address contains the old value, and the reply to the data the new value."""
    _, line = virtual()
    line.exchange(0x0018)
    assert line.exchange(even(0x0081)) == even(0x0001)
    assert line.exchange(0xC018) == even(0x0081)
    assert line.exchange(0xFFFF) == even(0x0081)


@pytest.mark.parametrize("word", [0x7FFF, 0x0000 | 0x4002, 0x3FFC])
def test_a_request_with_an_error_sets_the_error_flag(word: int) -> None:
    """Wrong parity, an address without a register, and a write to a register that can only be read."""
    _, line = virtual()
    line.exchange(word)
    reply = line.exchange(0x8000 if word == 0x3FFC else 0xFFFF)
    reply = line.exchange(0xFFFF) if word == 0x3FFC else reply
    assert reply & 0x4000


def test_bytes_are_answered_by_as_many() -> None:
    encoder, line = virtual()
    encoder.position = 5
    line.receive(bytes.fromhex("FF FF FF"))
    assert line.send() == bytes(2)
    line.receive(bytes.fromhex("FF"))
    assert line.send() == bytes.fromhex("00 05")


def test_the_programs_of_the_pages(package: Any, capsys: pytest.CaptureFixture[str]) -> None:
    module = importlib.import_module("ams_encoders.as5047p")
    encoder, line = virtual()
    encoder.position = 77
    names = {"lookup": package.lookup, "as5047p": module, "exchange": line.exchange}
    (program,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs/firmware/spi.md").read_text(encoding="utf-8"), re.DOTALL
    )
    exec(program, names)
    assert names["answer"].reply.usable_position == 77

    def five_times(word: int) -> int:
        nonlocal words
        words -= 1
        if words < 0:
            raise EOFError
        return line.exchange(word)

    words = 5
    readme = (ROOT / "runtime" / "python" / "README.md").read_text(encoding="utf-8")
    (program,) = (block for block in re.findall(r"```text\n(.*?)```", readme, re.DOTALL) if "pipeline" in block)
    names = {"encoder": package.lookup("AS5047P"), "PositionRequest": module.PositionRequest, "exchange": five_times}
    with pytest.raises(EOFError):
        exec(program, names)
    assert capsys.readouterr().out == "77\n" * 4


def test_python_loses_no_position(package: Any) -> None:
    module = importlib.import_module("ams_encoders.as5047p")
    encoder, line = virtual()
    pipeline = package.lookup("AS5047P").pipeline()
    positions = registers = words = 0
    while positions < POSITIONS:
        encoder.position = words - words // 101
        reads = words % 101 == 100
        word = pipeline.read(module.Diaagc) if reads else pipeline.ask(module.PositionRequest())
        assert word == (0xFFFC if reads else 0xFFFF)
        words += 1
        answer = pipeline.take(line.exchange(word))
        if answer is None:
            assert words == 1
        elif answer.register is not None:
            assert (answer.register.agc, answer.register.offset_loop, answer.register.mag_low) == (0x80, True, False)
            registers += 1
        else:
            assert answer.reply.usable_position == positions % 16384
            positions += 1
    assert registers >= (POSITIONS - 1) // 100


def test_python_writes_a_register(package: Any) -> None:
    module = importlib.import_module("ams_encoders.as5047p")
    _, line = virtual()
    pipeline = package.lookup("AS5047P").pipeline()
    value = module.Settings1.decode(bytes.fromhex("00 01"))._replace(pwm_on=True)
    sent_words, answers = [], []
    for word in pipeline.write(value):
        sent_words.append(word)
        answers.append(pipeline.take(line.exchange(word)))
    answers.append(pipeline.take(line.exchange(pipeline.read(module.Settings1))))
    answers.append(pipeline.take(line.exchange(pipeline.read(module.Settings1))))
    assert sent_words == [0x0018, even(0x0081)]
    assert [answer and answer.register.pwm_on for answer in answers] == [None, False, True, True]


def test_a_write_may_be_answered_without_its_value(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some encoders send zeros after a write, as the TMAG5170 does."""
    spec = (SPECS / "ams" / "as5047p.yaml").read_text(encoding="utf-8")
    spec = spec.replace("{request: write_data, reply: register_reply", "{request: write_data, reply: zeros")
    zeros = (
        '      - {name: zeros, from: encoder, source: "jm: a; zt: b", fields: [{name: data, bits: 16, unused: 0}]}\n'
    )
    (tmp_path / "as5047p.yaml").write_text(spec.replace("\nregisters:", f"{zeros}\nregisters:", 1), encoding="utf-8")
    maker = "codewheel: 1\nmanufacturer: ams\ntitle: ams\nsource: test\npython_package: zeros_encoders\n"
    (tmp_path / "manufacturer.yaml").write_text(maker, encoding="utf-8")
    assert main(["generate", str(tmp_path / "as5047p.yaml"), "--target", "python", "-o", str(tmp_path / "out")]) == 0
    monkeypatch.syspath_prepend(str(tmp_path / "out" / "python"))
    package: Any = importlib.import_module("zeros_encoders")
    pipeline = package.lookup("AS5047P").pipeline()
    words = [0, even(0x0001), 0]
    write_words = pipeline.write(package.as5047p.Settings1(*(0 for _ in package.as5047p.Settings1._fields)))
    answers = [pipeline.take(words.pop(0)) for _ in write_words]
    pipeline.ask(package.as5047p.PositionRequest())
    answers.append(pipeline.take(words.pop(0)))
    assert [answer and answer.register is not None for answer in answers] == [None, True, False]


def test_a_layout_of_the_other_sender_is_suggested(capsys: pytest.CaptureFixture[str]) -> None:
    command = ["decode", "AS5047P", "--specs", str(SPECS), "--layout", "read_request", "0xFFFC"]
    assert main(command) == 2
    assert "no layout 'read_request' from the encoder (add --from master); it has:" in capsys.readouterr().err
    assert main([*command, "--from", "master"]) == 0


def test_python_stays_in_step_after_a_damaged_word(package: Any) -> None:
    module = importlib.import_module("ams_encoders.as5047p")
    pipeline = package.lookup("AS5047P").pipeline()
    pipeline.ask(module.PositionRequest())
    assert pipeline.take(0) is None
    with pytest.raises(RuntimeError, match="no request has been sent"):
        pipeline.take(0)
    pipeline.read(module.Mag)
    with pytest.raises(RuntimeError, match="take the word"):
        pipeline.ask(module.PositionRequest())
    with pytest.raises(package.ConstantError):
        pipeline.take(0x0001)
    pipeline.ask(module.PositionRequest())
    assert pipeline.take(even(0x0123)).register.magnitude == 0x0123
    with pytest.raises(TypeError, match="AS5047P answers PositionRequest, ReadRequest, WriteRequest, WriteData, not"):
        pipeline.ask(module.Position(False, 1))
    with pytest.raises(TypeError, match="'int' is not a register over SPI"):
        pipeline.read(int)
    pipeline.restart()
    pipeline.ask(module.PositionRequest())
    assert pipeline.take(0) is None


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_c_loses_no_position(outputs: Path, compiler: str, tmp_path: Path) -> None:
    program = tmp_path / "positions"
    checks = "-Wall -Wextra -Wconversion -Werror -O1 -fsanitize=undefined,address -fno-sanitize-recover=all".split()
    source = str(Path(__file__).with_name("spi_positions.c"))
    command = [compiler, "-std=c99", *checks, "-I", str(outputs / "c" / "include"), source, "-o", str(program)]
    require(command)
    subprocess.run(command, check=True)
    encoder, line = virtual()
    words = 0
    with subprocess.Popen([program, str(POSITIONS)], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        while word := process.stdout.read(2):
            encoder.position = 7 * (words - words // 101)
            words += 1
            process.stdin.write(line.exchange(int.from_bytes(word, "big")).to_bytes(2, "big"))
            process.stdin.flush()
    assert process.returncode == 0
    assert words > POSITIONS


#: Frames with the bits that a valid word must have, as a mask and a value, and the member at its low end.
FRAMES = {
    "position_request": (0xFFFF, 0xFFFF, ""),
    "read_request": (0x4000, 0x4000, "address"),
    "write_request": (0x4000, 0x0000, "address"),
    "write_data": (0x4000, 0x0000, "data"),
    "position": (0, 0, "position"),
    "register_reply": (0, 0, "data"),
}


def valid(name: str) -> list[int]:
    """Each word of a frame that is valid: an even number of 1 bits, and its constants."""
    mask, value, _ = FRAMES[name]
    return [word for word in range(1 << 16) if not word.bit_count() & 1 and word & mask == value]


def test_c_accepts_exactly_the_valid_words(outputs: Path, tmp_path: Path) -> None:
    """All 65,536 words as each of the frames. For valid words, the member is compared, and requests are encoded."""
    lines = []
    for name, (_, _, member) in FRAMES.items():
        argument = f"(unsigned)frame.{member}" if member else "0x3FFFU"
        prefix = f"ams_as5047p_spi_{name}"
        encoded = f"if ({prefix}_encode(encoder, &frame, &again) != CW_OK || again != word) return 1;"
        lines += [
            f"{{ {prefix} frame; if ({prefix}_decode(encoder, word, &frame) == CW_OK) {{",
            f'{encoded} printf("{name} %u %u\\n", (unsigned)word, {argument}); }} }}',
        ]
    source = tmp_path / "words.c"
    source.write_text(
        '#include <stdio.h>\n#include "ams/as5047p_spi_simulate.h"\n'
        "#define encoder AMS_AS5047P_SPI_AS5047P\n"
        "int main(void)\n{\nuint32_t number;\nuint16_t again;\nfor (number = 0U; number < 65536U; number++) {\n"
        "const uint16_t word = (uint16_t)number;\n" + "\n".join(lines) + "\n}\nreturn 0;\n}\n",
        encoding="ascii",
    )
    include = str(outputs / "c" / "include")
    require(["gcc"])
    subprocess.run(["gcc", "-std=c99", "-O1", "-I", include, str(source), "-o", str(tmp_path / "words")], check=True)
    printed = subprocess.run([tmp_path / "words"], capture_output=True, text=True, check=True).stdout.splitlines()
    expected = [f"{name} {word} {word & 0x3FFF}" for name in FRAMES for word in valid(name)]
    assert sorted(printed) == sorted(expected)


_READ_WORD_C = """
#include <stdio.h>
#include "ams/as5047p_spi.h"
int main(void)
{
    for (uint32_t number = 0U; number < 65536U; number++) {
        const uint8_t rx[2] = { (uint8_t)(number >> 8U), (uint8_t)number };
        uint16_t from_bytes = 0xFFFFU;
        uint16_t from_word = 0xFFFFU;
        const cw_verdict bytes = AMS_AS5047P_SPI_READ(AS5047P, rx, &from_bytes);
        const cw_verdict word = AMS_AS5047P_SPI_READ_WORD(AS5047P, (uint16_t)number, &from_word);
        if ((bytes != word) || (from_bytes != from_word)) {
            return 1;
        }
        if (word != CW_NOT_USABLE) {
            printf("%u %u\\n", (unsigned)number, (unsigned)from_word);
        }
    }
    return 0;
}
"""


def test_c_reads_a_word_of_16_bits_as_its_bytes(outputs: Path, tmp_path: Path) -> None:
    """STM32 peripherals exchange words of 16 bits as one number. Bit 14 is the error, and the parity is even."""
    source, program = tmp_path / "read_word.c", tmp_path / "read_word"
    source.write_text(_READ_WORD_C, encoding="ascii")
    strict = "-std=c99 -O1 -Wall -Wextra -Wconversion -Werror".split()
    require(["gcc"])
    subprocess.run(["gcc", *strict, "-I", str(outputs / "c/include"), str(source), "-o", str(program)], check=True)
    printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
    usable = [word for word in valid("position") if not word & 0x4000]
    assert printed == [f"{word} {word & 0x3FFF}" for word in usable]


@pytest.mark.exhaustive
def test_python_accepts_exactly_the_valid_words(package: Any) -> None:
    module = importlib.import_module("ams_encoders.as5047p")
    kinds = [module.PositionRequest, module.ReadRequest, module.WriteRequest, module.WriteData]
    for kind, name in zip([*kinds, module.Position, module.RegisterReply], FRAMES, strict=True):
        accepted = []
        for word in range(1 << 16):
            try:
                frame = kind.decode(word)
            except package.ConstantError:
                continue
            accepted.append(word)
            assert frame.encode() == word
        assert accepted == valid(name)
