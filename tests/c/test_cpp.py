"""The headers for C++17: frames received and decoded at compile time, and errors found at compile time."""

from __future__ import annotations

import random
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from c_harness import devices_of, members, short, write
from codewheel.model import Device, Text
from codewheel.targets.c.codec import StructCodec
from codewheel.targets.c.device import DeviceView, views_of
from exhaustive import mostly_exhaustive
from test_c_codec import Table, on_the_wire, valid_numbers
from working_tools import require

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]

COMPILERS = ("g++ -std=c++17", "g++ -std=c++20", "clang++ -std=c++17", "clang++ -std=c++20")
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror"

#: Values from the manuals and public sources.
PRINTED = """
#include <array>

constexpr cw_word biss(uint64_t value)
{
    return cw_word_of(value, LIKA_SMA21_BISS_SC1_0010_BITS);
}
constexpr cw_word ssi(uint64_t value)
{
    return cw_word_of(value, LIKA_SMA21_SSI_BG1_0050_BITS);
}

// T-format request, reply and CRC, AMM5 7.4.2 and 7.6, and a reply that another receiver printed.
constexpr auto request = lika::amm5_rs485::data_request_encode(
    LIKA_AMM5_RS485_A23_65KJP1, {LIKA_AMM5_RS485_DATA_ID_SINGLETURN});
static_assert(request && request->size() == 1 && request->data()[0] == 0x02);
constexpr uint8_t covered[] = {0x32, 0x10, 0x01, 0x28, 0xB0, 0x08};
static_assert(lika_amm5_rs485_crc_rs485_8(covered, 6) == 0xB3);
constexpr std::array<uint8_t, 6> received{0x02, 0x20, 0xC7, 0xD1, 0x6A, 0x5E};
constexpr auto reply = lika::amm5_rs485::singleturn_reply_decode(LIKA_AMM5_RS485_A23_65KJP1, received);
static_assert(reply && reply->singleturn == 7000519);
static_assert(lika::amm5_rs485::singleturn_reply_verdict(LIKA_AMM5_RS485_A23_65KJP1, *reply) ==
              codewheel::verdict::not_usable);
static_assert(lika::amm5_rs485::singleturn_reply_reports(LIKA_AMM5_RS485_A23_65KJP1, *reply) != 0);

// Reply with data ID 4, SMA21 7.3.4.
constexpr uint8_t printed[] = {0xA2, 0x00, 0x10, 0x32, 0x54, 0x00, 0xD4};
constexpr auto position = lika::sma21_rs485::position_reply_decode(LIKA_SMA21_RS485_JP1_0005, printed);
static_assert(position && position->position == 5517840);
static_assert(lika::sma21_rs485::position_reply_verdict(LIKA_SMA21_RS485_JP1_0005, *position) ==
              codewheel::verdict::usable);

// Words of 22 bits, timonburkard/BiSS_Bridge: 192458 with CRC 28, and 74565 with an active error and CRC 11.
constexpr auto captured = lika::sma21_biss::position(LIKA_SMA21_BISS_SC1_0010, biss((192458ULL << 2 | 3) << 6 | 28));
static_assert(captured && captured.position == 192458 && captured.verdict == codewheel::verdict::usable);
constexpr auto faulty = lika::sma21_biss::position(LIKA_SMA21_BISS_SC1_0010, biss((74565ULL << 2 | 1) << 6 | 11));
static_assert(!faulty && faulty.error() == codewheel::fault::none && faulty.position == 0);

// The same in a buffer: idle, an acknowledge, start bit, CDS, the word, and a stop bit.
constexpr std::array<uint8_t, 5> rx_captured{0xC4, 0x05, 0xDF, 0x95, 0xB8};
constexpr auto read_captured = lika::sma21_biss::read(LIKA_SMA21_BISS_SC1_0010, rx_captured);
static_assert(read_captured && read_captured.position == 192458 && read_captured.verdict == codewheel::verdict::usable);

// 123 counts are 6.15 mm, SMA21 5.2; in Gray code 123 is 70. The error bit 1 is inactive.
constexpr auto length = lika::sma21_ssi::position(LIKA_SMA21_SSI_GG1_0050, ssi(70U << 1 | 1U));
static_assert(length && length.position == 123);
static_assert(lika_sma21_ssi_micrometres(LIKA_SMA21_SSI_GG1_0050, length.position) == 6150);
"""

#: Errors, each found at compile time.
WRONG = """
constexpr auto disturbed = lika::sma21_biss::decode(LIKA_SMA21_BISS_SC1_0010, biss((192458ULL << 2 | 3) << 6 | 29));
static_assert(!disturbed && disturbed.error() == codewheel::fault::crc && disturbed->position == 0);
constexpr auto rejected = lika::sma21_biss::position(LIKA_SMA21_BISS_SC1_0010, biss((192458ULL << 2 | 3) << 6 | 29));
static_assert(!rejected && rejected.error() == codewheel::fault::crc);
constexpr std::array<uint8_t, 5> rx_disturbed{0xC4, 0x05, 0xDF, 0x95, 0xBA};
constexpr auto unread = lika::sma21_biss::read(LIKA_SMA21_BISS_SC1_0010, rx_disturbed);
static_assert(!unread && unread.error() == codewheel::fault::crc && unread.position == 0);
constexpr std::array<uint8_t, 8> rx_high{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
static_assert(lika::sma21_biss::read(LIKA_SMA21_BISS_SC1_0010, rx_high).error() == codewheel::fault::line_high);
static_assert(lika::sma21_ssi::read(LIKA_SMA21_SSI_BG1_0050, rx_high).error() == codewheel::fault::line_high);
constexpr auto wide = lika::sma21_ssi::decode(LIKA_SMA21_SSI_BG1_0050, ssi(1ULL << 21));
static_assert(wide.error() == codewheel::fault::length);
static_assert(lika::sma21_rs485::position_reply_decode(LIKA_SMA21_RS485_JP1_0005, {printed, 6}).error() ==
              codewheel::fault::length);
constexpr uint8_t other[] = {0xA2, 0x00, 0x11, 0x32, 0x54, 0x00, 0xD4};
static_assert(lika::sma21_rs485::position_reply_decode(LIKA_SMA21_RS485_JP1_0005, other).error() ==
              codewheel::fault::crc);
"""


def assertions(device: Device) -> Iterator[str]:
    """Two random frames of each layout that the encoder sends, for each order code, with the reference's results."""
    table, random_ = Table(device), random.Random("c++")
    for view in views_of(device):
        for codec in view.interface.codecs:
            if codec.decodes:
                yield from _assertions_of_layout(table, view, codec, random_)


def _assertions_of_layout(table: Table, view: DeviceView, codec: StructCodec, random_: random.Random) -> Iterator[str]:
    name = short(view, codec)
    kinds = {field.name: field.kind for field in codec.struct.layout.fields}
    numbers = [member.name for member in members(codec)]
    head = f"{codec.name.removeprefix(view.prefix)}_".removeprefix("_")
    space = f"{view.maker.name}::{view.stem}"
    answers = "".join(f"{choice.enumeration.constants[0].name}, " for choice in codec.alternatives)
    for row in view.variants.rows:
        placed = table.layouts[name][1].place(row.variant.parameters)
        for number in random_.sample(list(valid_numbers(table.device, placed, random_)), 2):
            wire = on_the_wire(placed, number)
            frame = f"0x{wire}ULL"
            if codec.layout_plan.in_bytes:
                listed = ", ".join(f"0x{byte:02X}" for byte in bytes.fromhex(wire))
                frame = f"codewheel::buffer<{len(wire) // 2}>{{{{{listed}}}}}"
            elif codec.word_has_length:
                taken = "".join(f", {choice.enumeration.constants[0].name}" for choice in codec.length_alternatives)
                frame = f"cw_word_of({frame}, {codec.name}_bits({row.macro}{taken}))"
            values = zip(numbers, table.row(name, placed, number).split(), strict=True)
            numeric = [(name, value) for name, value in values if not isinstance(kinds.get(name.rstrip("_")), Text)]
            claims = [f"static_cast<int64_t>(f->{name}) == {_signed(value)}" for name, value in numeric]
            yield (
                f"static_assert([] {{ constexpr auto f = {space}::{head}decode({row.macro}, {answers}{frame});\n"
                f"    return f && {' && '.join(claims)}; }}());\n"
            )
            if codec.is_read:
                sent_bits = placed.layout.sent_bits.value(row.variant.parameters)
                position = _signed(dict(numeric)[codec.position_member])
                rx = _line(view.context.interface.name, number, sent_bits)
                yield _assertion_of_buffer(f"{space}::{head}read({row.macro}, {answers}rx)", position, rx)


def _assertion_of_buffer(call: str, position: str, rx: bytes) -> str:
    listed = ", ".join(f"0x{byte:02X}" for byte in rx)
    return (
        f"static_assert([] {{ constexpr uint8_t rx[] = {{{listed}}};\n    constexpr auto f = {call};\n"
        f"    return f.error() == codewheel::fault::none &&\n"
        f"        static_cast<int64_t>(f.position) == (f ? {position} : 0); }}());\n"
    )


def _signed(number: str) -> str:
    """Return a number as a literal of 64 bits in two's complement."""
    wrapped = (int(number) + (1 << 63)) % (1 << 64) - (1 << 63)
    return f"INT64_C({wrapped})"


def _line(interface: str, number: int, bits: int) -> bytes:
    """Return the bytes that a master stores while the encoder sends a word."""
    word = format(number, f"0{bits}b")
    levels = {"biss": f"11000010{word}01", "ssi": f"1{word}01", "spi": word.zfill(-(-bits // 8) * 8)}[interface]
    filled = levels.ljust(-(-len(levels) // 8) * 8, "1")
    return int(filled, 2).to_bytes(len(filled) // 8, "big")


@pytest.fixture(scope="module")
def program(c_devices: tuple[Device, ...]) -> str:
    stems = [view.header for device in c_devices for view in views_of(device)]
    lines = [line for device in c_devices for line in assertions(device)]
    assert len(lines) > 200
    assert sum("read(" in line for line in lines) > 100
    return "".join(f'#include "{stem}pp"\n' for stem in stems) + PRINTED + WRONG + "".join(lines)


def compiled(command: str, text: str, include: Path, tmp_path: Path) -> tuple[int, str]:
    require(command.split())
    (tmp_path / "unit.cpp").write_text(text, encoding="ascii")
    completed = subprocess.run(
        [*command.split(), *WARNINGS.split(), f"-I{include}", "-fsyntax-only", str(tmp_path / "unit.cpp")],
        capture_output=True,
        text=True,
    )
    return completed.returncode, completed.stderr


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[0], COMPILERS[-1]))
def test_a_compiler_decodes_frames(command: str, program: str, include: Path, tmp_path: Path) -> None:
    assert compiled(command, program, include, tmp_path) == (0, "")


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[-1]))
@pytest.mark.parametrize("specs", ["tests/specs/long.yaml", "specs/ams/as5048a.yaml"])
def test_long_frames_and_spi_are_received_at_compile_time(command: str, specs: str, tmp_path: Path) -> None:
    devices = devices_of(ROOT / specs)
    lines = list(assertions(devices[0]))
    assert any("read(" in line for line in lines)
    heads = "".join(f'#include "{view.header}pp"\n' for view in views_of(devices[0]))
    assert compiled(command, heads + "".join(lines), write(tmp_path, devices), tmp_path) == (0, "")


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[0], COMPILERS[-1]))
def test_four_bytes_are_loaded_at_once_only_at_run_time(
    command: str, program: str, include: Path, tmp_path: Path
) -> None:
    """Code for processors with unaligned access calls memcpy, which no compiler evaluates."""
    assert compiled(f"{command} -D__ARM_FEATURE_UNALIGNED", program, include, tmp_path) == (0, "")


@pytest.mark.parametrize("option", ["-DLIKA_CRC_TABLE", "-DLIKA_CRC_BITWISE"])
def test_other_forms_of_the_crc_too(option: str, program: str, include: Path, tmp_path: Path) -> None:
    assert compiled(f"g++ -std=c++17 {option}", program, include, tmp_path) == (0, "")


@pytest.mark.parametrize(
    ("correct", "mistaken"),
    [
        ("== 7000519", "== 7000520"),
        ("0x6A, 0x5E", "0x6A, 0x5F"),
        ("static_assert(!disturbed", "static_assert(disturbed"),
        ("LIKA_SMA21_BISS_SC1_0010, biss(", "LIKA_SMA21_SSI_BG1_0010, (192458ULL"),
        ("static_assert(!rejected", "static_assert(rejected"),
    ],
)
@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS[::2], COMPILERS[0]))
def test_a_mistake_does_not_compile(command: str, correct: str, mistaken: str, include: Path, tmp_path: Path) -> None:
    stems = ("amm5_rs485", "sma21_rs485", "sma21_biss", "sma21_ssi")
    heads = "".join(f'#include "lika/{stem}.hpp"\n' for stem in stems)
    text = heads + PRINTED + WRONG
    assert correct in text
    status, output = compiled(command, text.replace(correct, mistaken), include, tmp_path)
    assert status != 0
    assert "error:" in output


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS[::2], COMPILERS[0]))
def test_the_readme(command: str, include: Path, tmp_path: Path) -> None:
    readme = (Path(__file__).parents[2] / "generated" / "c" / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```cpp\n(.*?)```", readme, re.DOTALL)
    declarations = (
        "#include <cstdint>\nvoid move_to(uint64_t position);\nvoid ask_again();\nvoid received(uint64_t word);\n"
    )
    assert compiled(command, declarations + block, include, tmp_path) == (0, "")


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS[::2], COMPILERS[0]))
def test_the_page_on_languages(command: str, include: Path, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "firmware" / "languages.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```cpp\n(.*?)```", page, re.DOTALL)
    assert compiled(command, block, include, tmp_path) == (0, "")


@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS[::2], COMPILERS[0]))
def test_a_result_that_is_not_looked_at_is_a_warning(command: str, include: Path, tmp_path: Path) -> None:
    text = (
        '#include "lika/amm5_biss.hpp"\nvoid f();\nvoid f() { lika::amm5_biss::@(LIKA_AMM5_BISS_A17_1SC1, {0, 25}); }\n'
    )
    for name in ("decode", "position"):
        status, output = compiled(command, text.replace("@", name), include, tmp_path)
        assert status != 0
        assert "nodiscard" in output


def test_an_older_standard_is_named(include: Path, tmp_path: Path) -> None:
    status, output = compiled("g++ -std=c++14", '#include "lika/amm5_biss.hpp"\n', include, tmp_path)
    assert status != 0
    assert "codewheel/result.hpp needs C++17" in output


#: Macros whose size of an array must not show as a cast in the line of the program that uses them.
MACROS_ON_ARRAYS = """
#include "lika/amm5_biss.h"
#include "lika/amm5_rs485.h"
#include "lika/amm5_ssi.h"

bool read(uint64_t *position)
{
    static uint8_t biss[LIKA_AMM5_BISS_A21_65KSC1_RX_BYTES];
    static const uint8_t ssi[2][LIKA_AMM5_SSI_A23_65KBG1_RX_BYTES] = {};
    static uint8_t reply[LIKA_AMM5_RS485_COMPLETE_REPLY_LENGTH];
    cw_word word;
    return LIKA_AMM5_BISS_RECEIVE(A21_65KSC1, biss, &word) == CW_OK
        && LIKA_AMM5_BISS_READ(A21_65KSC1, biss, position) != CW_NOT_USABLE
        && LIKA_AMM5_SSI_READ_TWICE(A23_65KBG1, ssi[0], ssi[1], 100U, position) != CW_NOT_USABLE
        && LIKA_AMM5_RS485_READ(A23_65KJP1, reply, position) != CW_NOT_USABLE;
}
"""


@pytest.mark.parametrize("command", mostly_exhaustive(("g++ -std=c++11", *COMPILERS), "g++ -std=c++11"))
def test_a_program_gets_no_warning_about_casts_of_macros(command: str, include: Path, tmp_path: Path) -> None:
    """The headers are those of a system, so only the lines of the program get warnings."""
    require(command.split())
    (tmp_path / "unit.cpp").write_text(MACROS_ON_ARRAYS, encoding="ascii")
    warnings = [*WARNINGS.split(), "-Wold-style-cast"] + ["-Wuseless-cast"] * command.startswith("g++")
    checked = [*command.split(), *warnings, "-isystem", str(include), "-fsyntax-only", str(tmp_path / "unit.cpp")]
    completed = subprocess.run(checked, capture_output=True, text=True)
    assert (completed.returncode, completed.stderr) == (0, "")
