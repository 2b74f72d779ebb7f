"""One header for one order code: its use, its content, and that it reads what the tree reads."""

from __future__ import annotations

import random
import re
import subprocess
from itertools import permutations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from c_harness import SANITIZED
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device, Flag, number_to_bytes
from codewheel.model.interfaces import channel_frame
from codewheel.order_codes.reduction import for_codes
from codewheel.targets import Library
from codewheel.targets.c.comments import break_lines
from codewheel.targets.c.device import DeviceView, views_of
from codewheel.targets.c.files import generate
from codewheel.targets.c.header_text import WordLength, cut_biss_receiver, runtime_headers
from exhaustive import mostly_exhaustive
from rust_frames import numbers
from test_c_codec import encoded_sample, samples, with_crc
from working_tools import require

STRICT = "-Wall -Wextra -Wpedantic -Wconversion -Werror".split()
COMPILERS = (
    ("gcc", "-std=c99", "-xc"),
    ("clang", "-std=c99", "-xc"),
    ("g++", "-std=c++11", "-xc++"),
    ("g++", "-std=c++17", "-xc++"),
    ("clang++", "-std=c++17", "-xc++"),
)
#: Lines of a header, comments included.
BOUNDS = {"biss": 520, "ssi": 420, "spi": 550, "rs485": 550}


#: What a user writes: a buffer from DMA, and the position.
PROGRAM = """\
#include "lika_amm5a21_65ksc1.h"
#include <stdio.h>

static uint8_t rx[LIKA_AMM5A21_65KSC1_RX_BYTES];

int main(void)
{
    uint64_t position = 0U;
    while (fread(rx, 1U, sizeof rx, stdin) == sizeof rx) {
        const cw_verdict verdict = LIKA_AMM5A21_65KSC1_READ(rx, &position);
        printf("%d %lu\\n", (int)verdict, (unsigned long)position);
    }
    return 0;
}
"""


def crc_6(bits: str) -> str:
    """The remainder of x^6 + x + 1, sent inverted, bit by bit."""
    register = 0
    for bit in bits:
        carry = (register >> 5) ^ int(bit)
        register = ((register << 1) & 0x3F) ^ (0x03 if carry else 0)
    return f"{register ^ 0x3F:06b}"


def buffer(position: int, error: int = 1, warning: int = 1, flipped: int = 0) -> bytes:
    """Two bits of rest, three of acknowledge, start, CDS, 16 + 21 bits of position, nE, nW, CRC, stop, in 12 bytes."""
    data = f"{position:037b}{error}{warning}"
    word = data + crc_6(data)
    bits = "11000" + "10" + f"{int(word, 2) ^ flipped:045b}" + "0"
    return int(bits.ljust(96, "1"), 2).to_bytes(12, "big")


def own_name(device: Device, code: str) -> str:
    """What the names of the header begin with."""
    return f"{device.manufacturer.name}_{re.sub('[^a-z0-9]+', '_', code.lower())}"


def single(device: Device, code: str) -> str:
    # The name of an order code can also be the name of its family.
    return generate(Library((device,)), {"only": code, "form": "single"})[f"c/{own_name(device, code)}.h"]


def codes_of(device: Device) -> list[tuple[str, str]]:
    """The first and the last order code of each interface."""
    ends = []
    for interface in device.interfaces:
        codes = [variant.code for variant in device.variants_over(interface.name)]
        ends += [(interface.name, code) for code in dict.fromkeys((codes[0], codes[-1]))]
    return ends


@pytest.fixture(scope="module")
def packaged() -> tuple[Device, ...]:
    return load_library()[0]


@pytest.mark.slow
def test_a_user_reads_a_position_with_one_header(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--packaged", "AMM5A21/65KSC1", "--target", "c", "--option", "c.form=single", "-o", str(tmp_path)]
    assert main(["generate", *arguments]) == 0
    assert [path.name for path in (tmp_path / "c").glob("[!.]*")] == ["lika_amm5a21_65ksc1.h"]
    (tmp_path / "c" / "main.c").write_text(PROGRAM, encoding="ascii")
    command = ["gcc", "-std=c99", *STRICT, *SANITIZED, "main.c", "-o", "main"]
    require(command[:1])
    compiled = subprocess.run(command, cwd=tmp_path / "c", capture_output=True, text=True)
    assert compiled.returncode == 0, compiled.stderr
    position = (1234 << 21) | 1_000_503
    frames = buffer(position) + buffer(7, warning=0) + buffer(7, error=0) + buffer(7, flipped=1 << 20) + bytes(12)
    printed = subprocess.run([tmp_path / "c" / "main"], input=frames, capture_output=True, check=True).stdout
    # Usable, then two that the flags and two that the line make unusable. These leave the position as it was.
    assert printed.decode().splitlines() == [f"3 {position}", *[f"0 {position}"] * 4]
    assert len([line for line in PROGRAM.splitlines() if line]) <= 15


@pytest.mark.slow
def test_it_is_short(packaged: tuple[Device, ...]) -> None:
    for device in packaged:
        for interface, code in codes_of(device):
            lines = single(device, code).splitlines()
            assert len(lines) <= BOUNDS[interface], code
            assert not [line for line in lines if len(line) > 100 and "https://" not in line], code


@pytest.mark.slow
def test_it_has_nothing_of_other_order_codes_or_files(packaged: tuple[Device, ...]) -> None:
    for device in packaged:
        for interface, code in codes_of(device):
            text = single(device, code)
            own, of_tree = own_name(device, code), f"{device.manufacturer.name}_{device.name}_{interface}_"
            assert of_tree.startswith(f"{own}_") or not re.search(rf"\b{of_tree}", text, re.IGNORECASE)
            assert "encoder's page" not in text
            assert re.findall(r"#include (\S+)", text) == ["<stdbool.h>", "<stddef.h>", "<stdint.h>"]
            names = re.findall(r"^(?:[A-Z_]+ )*static inline \w+ (\w+)\(", text, re.MULTILINE)
            assert names
            assert all(name.startswith(f"{own}_") for name in names)
            assert set(re.findall(r"\bcw_\w+", text)) <= {"cw_result", "cw_verdict"}
            paragraphs = " ".join(line.strip().removeprefix("*") for line in text.splitlines())
            errata = len(re.findall(r"\bErratum: ", paragraphs))
            assert errata == len(re.findall(r"\((?:open|resolved)\)\. +Used: ", paragraphs)), code


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "code", "sentences"),
    [
        ("icmr", "iC-MR-24-L6T", ["READ ignores life and temperature. To use them, call", "Clock: not known [p.34]."]),
        ("icmr", "iC-MR-24-L6T", ["number of bytes in a buffer for all 83 bits of the frame"]),
        ("dl100", "DL100-GRY24E", ["the pause SICK_DL100_GRY24E_PAUSE_AT_LEAST_US", "Tp: at least 30 us"]),
        (
            "amt22",
            "AMT22-14",
            ["wait at least 3 us after the chip select", "Left out: - A frame from real hardware."],
        ),
        ("as5145", "AS5045", ["The documents do not give the length of the pause."]),
        ("as5047p", "AS5047P", ["which is FFh FFh, most significant byte first", 'Source: "Public drivers']),
        (
            "amm5",
            "AMM5A21/65KSC1",
            ['Manual: "AMM5A AMM5B"', "Use SPI mode 3, whose clock is high at rest and samples at"],
        ),
        (
            "amm5",
            "AMM5A21/65KSC1",
            ["How it folds: the remainder of x^6 is x + 1.", "AMM5A21/65KSC1 has 0. For 1, pass your own"],
        ),
    ],
)
def test_it_states_what_a_reader_must_know(
    family: str, code: str, sentences: list[str], packaged: tuple[Device, ...]
) -> None:
    device = next(device for device in packaged if device.name == family)
    text = " ".join(re.sub(r"^ \* ", "", single(device, code), flags=re.MULTILINE).split())
    for sentence in sentences:
        assert sentence in re.sub(r" \* ", " ", text), sentence


@pytest.mark.slow
def test_it_does_not_mention_what_it_lacks(packaged: tuple[Device, ...]) -> None:
    for device in packaged:
        for _, code in codes_of(device):
            text = " ".join(single(device, code).replace("\n     * ", " ").replace("\n * ", " ").split())
            for absent in ("Steps:", "It is set by your choice", "(erratum ", "profile ID registers"):
                assert absent not in text, (code, absent)


@pytest.mark.slow
def test_a_flag_decides_instead_only_if_its_verdict_differs(packaged: tuple[Device, ...]) -> None:
    by_name = {device.name: device for device in packaged}
    sentence = "that flag decides instead"
    # In the AMM5, a depleted battery is only a warning. In the SMA21, all flags have the verdict of the one above them.
    assert sentence in single(by_name["amm5"], "AMM5A21/65KJP1").replace("\n     * ", " ")
    assert sentence not in single(by_name["sma21"], "SMA21-JP1-0050").replace("\n     * ", " ")


@pytest.mark.slow
def test_it_receives_in_only_one_way(packaged: tuple[Device, ...]) -> None:
    """The length of the word is known, so the ways for other lengths are left out."""
    by_name = {device.name: device for device in packaged}
    biss = single(by_name["amm5"], "AMM5A21/65KSC1")
    assert "_received_halves(" in biss
    assert "_received_bits(" not in biss
    assert "(received < 57U) ||" not in biss
    # Registers change the length, which is never above 44 bits.
    length_varies = single(by_name["am36"], "AMC3619/4096-I7")
    assert "_received_bits(" not in length_varies
    assert "(received < 57U) || (bits == 0U) || (bits > 56U)" in length_varies
    assert "of at least 8 bytes works too" in length_varies
    length = WordLength(most_bits=62, buffer_bytes=16, is_variable=False)
    long_word = cut_biss_receiver(runtime_headers()["receive.h"], length)
    assert "(received < 57U)" not in long_word
    receiver = long_word.partition("cw_biss_receive_bits(\n")[2].partition("\n}\n")[0]
    assert "cw_received_bits(rx, first, bits)" in receiver
    assert "cw_received_halves" not in receiver
    ssi = single(by_name["mt6701"], "MT6701")
    assert "while (index < last)" not in ssi


@pytest.mark.slow
@pytest.mark.parametrize("code", ["iC-MU-24-0", "AksIM2-18", "AMT22-14"])
def test_a_packaged_order_code_gives_one_header(code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Order codes with small letters too: once these gave a header for each code of the family."""
    arguments = ["--packaged", code, "--target", "c", "--option", "c.form=single", "-o", str(tmp_path)]
    assert main(["generate", *arguments]) == 0
    (header,) = (tmp_path / "c").glob("*.h")
    assert header.stem.endswith(re.sub("[^a-z0-9]+", "_", code.lower()))


#: Reads buffers with both headers. Prints how many are usable, and how many of the results differ.
BOTH = """\
#include "single.h"
#include "{tree}.h"
#include <stdio.h>

int main(void)
{{
    unsigned long usable = 0U, different = 0U;
    size_t length = 0U;
    uint8_t rx[64];
    while (fread(&length, sizeof length, 1U, stdin) == 1U && fread(rx, 1U, length, stdin) == length) {{
        {own_type} own = 0;
        {tree_type} expected = 0;
        const cw_verdict verdict = {own}_READ_BYTES(rx, length, &own);
        const cw_verdict expected_verdict = {TREE}_READ_BYTES({row}, rx, length, &expected);
        usable += (verdict != CW_NOT_USABLE) ? 1U : 0U;
        different += ((verdict != expected_verdict) || ((uint64_t)own != (uint64_t)expected)) ? 1U : 0U;
    }}
    printf("%lu %lu", usable, different);
    return 0;
}}
"""
#: What the data line sends before a frame: at rest, acknowledge, start and a bit of control data over BiSS.
BITS_BEFORE = {"biss": "110010", "ssi": "1", "spi": ""}


def buffers(view: DeviceView, count: int) -> bytes:
    """Valid and disturbed frames as they are received, each after its length as a size_t."""
    assert view.position_reader.frame is not None
    layout, interface = view.position_reader.frame.struct.layout, view.context.interface.name
    channels = channel_frame(view.context.interface)
    layouts = channels.layouts if channels is not None else (layout,)
    random_ = random.Random(view.code_row.macro)
    placed_channels = [sent.place(view.device.variants[0].parameters) for sent in layouts]
    placed_channels = [channel for channel in placed_channels if channel.bits]
    cases: list[Any] = [SimpleNamespace(device=view.device, placed=channel) for channel in placed_channels]
    frames = list(zip(*(numbers(case, count, random_) for case in cases), strict=True))
    # Frames with one wrong bit and a correct CRC, which only the checks of constants and parity bits can detect.
    frames_without_reports = list(zip(*(frames_without_flags(case, random_) for case in cases), strict=True))
    for index, channel in enumerate(placed_channels):
        for bit in range(channel.bits):
            number = frames_without_reports[0][index]
            changed_bits = with_crc(view.device, channel, number ^ 1 << bit) ^ number
            for frame in frames_without_reports:
                frames.append((*frame[:index], frame[index] ^ changed_bits, *frame[index + 1 :]))
    received_buffers = []
    for frame in frames:
        if layout.in_bytes:
            received_buffers.append(number_to_bytes(layout, frame[0], placed_channels[0].bits))
        else:
            line_bits = BITS_BEFORE[interface]
            for number, channel in zip(frame, placed_channels, strict=True):
                line_bits += f"{number:0{channel.bits}b}"
            line_bits += "0" * (-len(line_bits) % 8 + 16 * (interface != "spi"))
            # The header of a short BiSS word needs a buffer of at least 8 bytes.
            line_bits = line_bits.ljust(64, "0") if interface == "biss" else line_bits
            received_buffers.append(int(line_bits, 2).to_bytes(len(line_bits) // 8, "big"))
    return b"".join(len(received_bytes).to_bytes(8, "little") + received_bytes for received_bytes in received_buffers)


def frames_without_flags(case: Any, random_: random.Random) -> list[int]:
    """Some valid frames in which no flag is active, so that no flag makes the position unusable."""
    fields = [field for field in case.placed.fields if field.field.carries_data]
    samples_by_field = {field.name: samples(field.field, field.width, case.placed.layout, random_) for field in fields}
    kind_by_field = {field.name: field.field.kind for field in fields}
    inactive_flag_bits = {name: int(kind.active_low) for name, kind in kind_by_field.items() if isinstance(kind, Flag)}
    return [encoded_sample(case.device, case.placed, samples_by_field, inactive_flag_bits, random_) for _ in range(8)]


@pytest.mark.slow
@pytest.mark.parametrize("first_family", mostly_exhaustive(range(5), 0))
def test_it_reads_what_the_tree_reads(packaged: tuple[Device, ...], first_family: int, tmp_path: Path) -> None:
    """The quantities of the order code are numbers in its header, and members of a struct in the tree."""
    require(["gcc"])
    compared = 0
    for device in packaged[first_family::5]:
        for interface, code in codes_of(device):
            folder = tmp_path / own_name(device, code)
            include = write_headers(folder, device, code)
            header = single(device, code)
            (folder / "single.h").write_text(header, encoding="ascii")
            own, tree = own_name(device, code), f"{device.manufacturer.name}_{device.name}_{interface}"
            tree_header = (include / device.manufacturer.name / f"{device.name}_{interface}.h").read_text("ascii")
            (view,) = views_of(for_codes(device, {code}))
            # Without a macro there is no single frame with a position. An open question of the manual is an argument.
            if f"{own.upper()}_READ_BYTES(" not in header or view.position_reader.questions:
                continue
            position = r"(\w+) \*position\)"
            own_type, tree_type = (re.findall(position, text)[0] for text in (header, tree_header))
            program = BOTH.format(
                tree=f"{device.manufacturer.name}/{device.name}_{interface}",
                own=own.upper(),
                TREE=tree.upper(),
                row=view.code_row.macro.removeprefix(f"{tree.upper()}_"),
                own_type=own_type,
                tree_type=tree_type,
            )
            (folder / "main.c").write_text(program, encoding="ascii")
            command = ["gcc", "-std=c99", *SANITIZED, f"-I{include}", "main.c", "-o", "main"]
            subprocess.run(command, cwd=folder, check=True)
            data = buffers(view, 2000)
            printed = subprocess.run([folder / "main"], input=data, capture_output=True, check=True).stdout
            usable, different = map(int, printed.split())
            assert usable > 0, code
            assert different == 0, code
            compared += 1
    assert compared >= 10


#: Counts the words that are refused or accepted wrongly. Each check bit makes the number of 1 bits in every second bit
#: odd.
ALL_WORDS = """\
#include "single.h"
#include <stdio.h>

int main(void)
{{
    unsigned long wrong = 0U;
    for (uint32_t word = 0U; word < 0x10000U; word++) {{
        const uint8_t rx[2] = {{ (uint8_t)(word >> {first}U), (uint8_t)(word >> {second}U) }};
        const uint32_t expected = (word & 0x3FFFU) >> {zeros}U;
        const bool is_valid = (__builtin_parity(word & 0x5555U) != 0) && (__builtin_parity(word & 0xAAAAU) != 0)
            && ((expected << {zeros}U) == (word & 0x3FFFU));
        uint16_t position = 0xFFFFU;
        const cw_verdict verdict = {name}_READ_BYTES(rx, 2U, &position);
        wrong += (verdict != (is_valid ? CW_UNKNOWN : CW_NOT_USABLE)) ? 1U : 0U;
        wrong += (position != (is_valid ? expected : 0xFFFFU)) ? 1U : 0U;
    }}
    printf("%lu", wrong);
    return 0;
}}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "code", "zeros", "is_low_first"),
    [("amt22", "AMT22-12", 2, 0), ("amt22", "AMT22-14", 0, 0), ("amt21", "AMT212A", 2, 1), ("amt21", "AMT213B", 0, 1)],
)
def test_two_check_bits_are_checked_together(
    family: str, code: str, zeros: int, is_low_first: int, packaged: tuple[Device, ...], tmp_path: Path
) -> None:
    device = next(device for device in packaged if device.name == family)
    header = single(device, code)
    assert re.search(r"_parities\(\(uint32_t\)word & 0xFFF[CF]U\) != 3U", header)
    first, second = (0, 8) if is_low_first else (8, 0)
    name = own_name(device, code).upper()
    program = ALL_WORDS.format(first=first, second=second, zeros=zeros, name=name)
    (tmp_path / "single.h").write_text(header, encoding="ascii")
    (tmp_path / "main.c").write_text(program, encoding="ascii")
    command = ["gcc", "-std=c99", *STRICT, *SANITIZED, "main.c", "-o", "main"]
    require(command[:1])
    subprocess.run(command, cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    assert printed == "0"


def write_headers(folder: Path, device: Device, only: str = "") -> Path:
    """Write the headers of the tree, and return their include folder."""
    for path, text in generate(Library((device,)), {"only": only}).items():
        if path.startswith("c/include/"):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text, encoding="ascii")
    return folder / "c" / "include"


@pytest.mark.slow
@pytest.mark.one_in(4, "exhaustive")
@pytest.mark.parametrize("compiler", COMPILERS, ids=lambda compiler: " ".join(compiler[:2]))
def test_several_go_together_and_with_the_tree(
    compiler: tuple[str, ...], packaged: tuple[Device, ...], tmp_path: Path
) -> None:
    by_name = {device.name: device for device in packaged}
    include = write_headers(tmp_path, by_name["amm5"])
    (tmp_path / "lika.h").write_text(single(by_name["amm5"], "AMM5A21/65KSC1"), encoding="ascii")
    (tmp_path / "rls.h").write_text(single(by_name["aksim2"], by_name["aksim2"].variants[0].code), encoding="ascii")
    require(compiler[:1])
    for order in permutations(('"lika.h"', '"rls.h"', '"lika/amm5_biss.h"', '"codewheel/tracker.h"')):
        program = "".join(f"#include {header}\n" for header in order) + USE
        command = [*compiler, *STRICT, "-fsyntax-only", f"-I{tmp_path}", f"-I{include}", "-"]
        compiled = subprocess.run(command, input=program, capture_output=True, text=True)
        assert compiled.returncode == 0, (order, compiled.stderr)


USE = """
cw_verdict worst(const uint8_t *bytes, size_t length, uint64_t *position);
cw_verdict worst(const uint8_t *bytes, size_t length, uint64_t *position)
{
    cw_verdict verdict = LIKA_AMM5A21_65KSC1_READ_BYTES(bytes, length, position);
    if (verdict == CW_USABLE) {
        verdict = LIKA_AMM5_BISS_READ_BYTES(A21_65KSC1, bytes, length, position);
    }
    return verdict;
}
"""


@pytest.mark.slow
@pytest.mark.one_in(4, "exhaustive")
@pytest.mark.parametrize("compiler", COMPILERS, ids=lambda compiler: " ".join(compiler[:2]))
def test_each_compiles_without_a_warning(
    compiler: tuple[str, ...], packaged: tuple[Device, ...], tmp_path: Path
) -> None:
    texts = [single(device, codes_of(device)[-1][1]) for device in packaged]
    for index, text in enumerate(texts):
        (tmp_path / f"{index}.h").write_text(text, encoding="ascii")
    program = "".join(f'#include "{index}.h"\n' for index in range(len(texts))) + "int nothing;\n"
    require(compiler[:1])
    command = [*compiler, *STRICT, "-fsyntax-only", f"-I{tmp_path}", "-"]
    compiled = subprocess.run(command, input=program, capture_output=True, text=True)
    assert compiled.returncode == 0, compiled.stderr[:3000]


@pytest.mark.slow
def test_functions_that_a_program_calls_explain_their_arguments(packaged: tuple[Device, ...]) -> None:
    """Of the runtime, a program calls only the functions that collect the bytes of a reply."""
    for device in packaged:
        for interface, code in codes_of(device):
            if interface == "rs485":
                text = single(device, code)
                for argument in ("line", "control", "length", "echo", "now_us", "at_most_us"):
                    assert f" * @param {argument}  " in text, (code, argument)
                comment = text.partition(" * Start waiting")[2].partition("*/")[0]
                assert max(map(len, comment.splitlines())) <= 100, code


@pytest.mark.slow
def test_an_spi_header_has_no_macro_for_functions_that_it_lacks(packaged: tuple[Device, ...]) -> None:
    for device in packaged:
        for interface, code in codes_of(device):
            if interface == "spi":
                # The numbers of requests are for cw_spi_exchange.
                assert not re.search(r"^#define \w+_REQUEST_\w+ \d+U$", single(device, code), re.MULTILINE), code


@pytest.mark.slow
def test_comments_are_about_the_interface(packaged: tuple[Device, ...]) -> None:
    """A reply over SPI or RS-485 has one length, and a request without data has no members to set."""
    by_name = {device.name: device for device in packaged}
    spi = single(by_name["as5047p"], "AS5047P")
    assert "from a pointer to the bytes of one word, or" in spi
    assert "Set all members" not in spi
    rs485 = single(by_name["sma21"], "SMA21-JP1-0050")
    assert "from a pointer to the bytes of one reply, or" in rs485
    assert "Data ID 4: control field A2h, requests data: 24-bit position and error code" in rs485


def test_a_macro_that_is_too_long_is_continued() -> None:
    """The last line of a macro needs a backslash where it is broken."""
    code = f"#define READ(rx) \\\n    {'read_position' * 3}((rx), {'SIZE_' * 12}BYTES, (position))\n"
    first, *others, last = break_lines(code).splitlines()
    assert others
    assert all(line.endswith(" \\") and len(line) <= 100 for line in (first, *others))
    assert not last.endswith("\\")


@pytest.mark.slow
def test_the_parity_of_a_long_word_is_one_call(packaged: tuple[Device, ...]) -> None:
    by_name = {device.name: device for device in packaged}
    text = single(by_name["icpvl"], "iC-PVL-40-B1LWE")
    assert "_parity_64(word & UINT64_C(0xFFFFFFFFFFF)) != 0U" in text
