"""Receivers, proved by CBMC for every content of a buffer and every state of a serial line."""

from __future__ import annotations

import signal
import subprocess
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import pytest
from c_harness import GCC, RUNTIME, SANITIZED, compile_c
from claims import claims_of, planted, verdict
from tools import tool

HARNESS = Path(__file__).with_name("proof_receive.c")
#: Undefined behaviour, and also every unsigned overflow and every number that does not fit into a smaller type.
MORE = ("--unsigned-overflow-check", "--conversion-check")
#: Rounds of each loop: 16 bits or bytes, or the 32 bits after the last word of a longer line.
ROUNDS = defaultdict(lambda: 18, a_start_bit=34, a_frame_in_eight_bytes=34)
#: Fewer for the loops that store a frame of up to four bytes. Without them, the proofs take twenty times as long.
AS_BYTES = ("--unwindset", "cw_received_frame.0:5,cw_received_bits.0:4")


@pytest.fixture(scope="module")
def include() -> Path:
    """Return the include folder of the runtime."""
    return RUNTIME


def header_with(code: str) -> str:
    """Return the name of the receivers' header that contains this code."""
    headers = (RUNTIME / "codewheel" / name for name in ("receive.h", "receive_frame.h"))
    return next((path.name for path in headers if code in path.read_text(encoding="ascii")), "receive.h")


@pytest.mark.parametrize("claim", claims_of(HARNESS))
def test_whatever_was_received(claim: str, include: Path, tmp_path: Path) -> None:
    proved, words = verdict(
        HARNESS, claim, include, tmp_path, ROUNDS[claim], (*MORE, *(AS_BYTES if "as_bytes" in claim else ()))
    )
    assert proved, words


@pytest.mark.parametrize(
    ("claim", "sound", "instead"),
    [
        ("a_frame_of_biss", "first = start + 2U;", "first = start + 1U;"),
        ("a_frame_of_biss", "(stop > received)", "(stop > (received + 1U))"),
        ("a_frame_of_biss", "((stop < received)", "((stop <= received)"),
        ("a_frame_in_eight_bytes", "0x80000000U >> (bits", "0x40000000U >> (bits"),
        ("a_frame_in_eight_bytes", "(bits > 31U) ? low", "(bits > 32U) ? low"),
        ("a_frame_in_eight_bytes", "&& (stop < received))", "&& (stop <= received))"),
        ("a_start_bit", "zeros += 4U;", "zeros += 5U;"),
        ("a_start_bit", "(bits & 1U) << 31U", "0x80000000U"),
        ("a_start_bit", "(index + 32U) <= received", "(index + 31U) <= received"),
        ("a_word_in_eight_bytes", "(31U - shift)", "(32U - shift)"),
        ("a_word_in_eight_bytes", "(wanted_end > size) ? size : wanted_end", "wanted_end"),
        ("a_word_over_nine_bytes", "(low >> 24U)", "(low >> 23U)"),
        ("a_frame_in_whole_bytes", "receive_bits(rx, 8U * size, bits", "receive_bits(rx, 7U * size, bits"),
        ("its_cds", "if (cds_index >= received) {", "if (cds_index > received) {"),
        ("a_word_of_ssi", "((size_t)bits + 2U)", "((size_t)bits + 1U)"),
        ("a_word_of_ssi_in_nine_bytes", "byte = rx[4];", "byte = rx[3];"),
        ("a_word_of_ssi_in_nine_bytes", "upper << bits_in_last", "upper << 8U"),
        ("a_word_of_ssi_in_nine_bytes", "if (last == 3U)", "if (last == 4U)"),
        ("a_word_of_ssi_in_nine_bytes", "0x7FFFFFFFU) >> (8U", "0xFFFFFFFFU) >> (8U"),
        ("bits_as_bytes", "(bits_left < 8U) ? bits_left : 8U", "(bits_left < 7U) ? bits_left : 8U"),
        ("bits_as_bytes", "byte_first, byte_bits", "byte_first, 8U"),
        ("a_frame_of_biss_as_bytes", "data_index = start + 2U;", "data_index = start + 1U;"),
        ("a_frame_of_biss_as_bytes", "(frame_end > received)", "(frame_end > (received + 1U))"),
        ("a_frame_of_biss_as_bytes", "((frame_end < received)", "((frame_end <= received)"),
        ("a_frame_as_bytes_from_whole_bytes", "frame_bits(rx, 8U * size", "frame_bits(rx, 7U * size"),
        ("a_word_of_ssi_as_bytes", "(after_word >= (8U * size))", "(after_word > (8U * size))"),
        ("a_word_of_ssi_as_bytes", "(index == after_word)", "(index >= (after_word - 1U))"),
        ("two_readings", "(modulus - distance)", "(modulus - distance - 1U)"),
        ("other_shapes", "8U * (index % 4U)", "8U * (index % 3U)"),
        ("other_shapes", "is_padding = index >= count", "is_padding = index > count"),
        ("other_shapes", "0x01010101U) << 4U", "0x01010101U) << 5U"),
        ("other_shapes", "(pin == ((uint32_t)1U << pin_bit))", "(pin != 0U)"),
        ("one_more_byte_of_a_line", "line->length) {\n        return false;", "9999U) {\n        return false;"),
        ("a_reply_without_its_first_byte", "RS485_BYTES) ? 1U", "RS485_BYTES) ? 0U"),
        ("a_line_that_waits", "(uint64_t)1U << 32U", "(uint64_t)1U << 31U"),
    ],
)
def test_what_is_planted_is_found(claim: str, sound: str, instead: str, include: Path, tmp_path: Path) -> None:
    broken = planted(include, header_with(sound), sound, instead, tmp_path)
    proved, words = verdict(
        HARNESS, claim, broken, tmp_path, ROUNDS[claim], (*MORE, *(AS_BYTES if "as_bytes" in claim else ()))
    )
    assert not proved
    assert "REFUTED" in words, words


#: Number of random buffers, and of those checked with a sanitizer.
BUFFERS, WATCHED = 10_000_000, 500_000


def count_differences(include: Path, folder: Path, options: Sequence[str], buffers: int) -> tuple[int, int]:
    """Return the number of buffers with a frame, and of those whose result differs from bitwise reception."""
    text = HARNESS.with_name("receive_random.c").read_text(encoding="ascii")
    program = compile_c([*GCC, *options, f"-I{HARNESS.parent}"], text, folder, include)
    output = subprocess.run([str(program), str(buffers)], capture_output=True, text=True, check=True).stdout
    count, frames, differing = map(int, output.split())
    assert count == buffers
    return frames, differing


#: The forms for processors that load words from any address and count leading zeros.
LOADS = ("-D__ARM_FEATURE_UNALIGNED", "-D__ARM_FEATURE_CLZ")


@pytest.mark.parametrize(
    ("options", "buffers"),
    [
        (["-O2"], BUFFERS),
        (["-O2", *LOADS], BUFFERS),
        (["-O1", *SANITIZED], WATCHED),
        (["-O1", *LOADS, *SANITIZED], WATCHED),
    ],
)
def test_the_same_as_bit_by_bit(options: Sequence[str], buffers: int, include: Path, tmp_path: Path) -> None:
    frames, differing = count_differences(include, tmp_path, options, buffers)
    assert differing == 0
    assert frames > buffers // 10


@pytest.mark.parametrize(
    ("sound", "instead"),
    [
        ("while (shifted < 0x80000000U) {", "while (shifted < 0x40000000U) {"),
        ("last_bits = end - (8U * last);", "last_bits = (end - (8U * last)) % 8U;"),
        ("(byte >> bits_before)", "(byte >> (bits_before & 3U))"),
        ("(low >> unused)", "low"),
        ("bits |= bits << 9U;", "bits |= bits << 8U;"),
        ("(bits_left < 8U) ? bits_left : 8U", "(bits_left < 7U) ? bits_left : 8U"),
        ("(pin == ((uint32_t)1U << pin_bit))", "(pin != 0U)"),
    ],
)
def test_a_difference_would_be_seen(sound: str, instead: str, include: Path, tmp_path: Path) -> None:
    broken = planted(include, header_with(sound), sound, instead, tmp_path)
    try:
        assert count_differences(broken, tmp_path, ["-O2"], 10_000)[1] > 0
    except subprocess.CalledProcessError as ended:  # With one bit too many, it writes beyond the array.
        assert ended.returncode == -signal.SIGSEGV


@pytest.mark.parametrize("cpu", ["cortex-m0plus", "cortex-m4"])
def test_how_many_bytes_a_receiver_takes(cpu: str, include: Path, tmp_path: Path) -> None:
    """At most 300 bytes for a known order code, without functions of the compiler's library."""
    source, object_file = tmp_path / "source.c", tmp_path / "source.o"
    source.write_text(
        '#include "codewheel/receive.h"\n'
        "cw_result received(const uint8_t *rx, uint64_t *word);\n"
        "cw_result received(const uint8_t *rx, uint64_t *word)\n{\n"
        "    return cw_biss_receive(rx, 12U, 47U, word); /* AMM5A23/65KSC1 */\n}\n",
        encoding="ascii",
    )
    command = [tool("arm-none-eabi-gcc"), "-std=c99", "-Os", "-mthumb", f"-mcpu={cpu}", f"-I{include}", "-c"]
    subprocess.run([*command, str(source), "-o", str(object_file)], check=True)
    needed = subprocess.run(["arm-none-eabi-nm", "-u", str(object_file)], capture_output=True, text=True, check=True)
    assert needed.stdout == ""
    size_table = subprocess.run(
        ["arm-none-eabi-size", str(object_file)], capture_output=True, text=True, check=True
    ).stdout
    assert int(size_table.splitlines()[1].split()[0]) <= 300
