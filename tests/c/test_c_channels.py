"""``channels.h``: the bits of several data channels on the line, and positions that agree within a tolerance."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, RUNTIME, SANITIZED, compile_c, write
from codewheel.targets import Library
from working_tools import require

pytestmark = pytest.mark.slow

PROGRAM = r"""
#include <stdio.h>
#include <string.h>
#include "codewheel/channels.h"

static const char *name_of(cw_result result)
{
    switch (result) {
    case CW_OK: return "OK";
    case CW_FAULT_LINE_LOW: return "LINE_LOW";
    case CW_FAULT_LINE_HIGH: return "LINE_HIGH";
    case CW_FAULT_NO_START: return "NO_START";
    case CW_FAULT_LENGTH: return "LENGTH";
    case CW_FAULT_CONSTANT: return "CONSTANT";
    default: return "another";
    }
}

static void receive(const char *line)
{
    uint8_t rx[4] = { 0U, 0U, 0U, 0U };
    size_t first = 77U;
    size_t place;
    for (place = 0U; line[place] != '\0'; place++) {
        if (line[place] == '1') {
            rx[place / 8U] = (uint8_t)(rx[place / 8U] | (0x80U >> (place % 8U)));
        }
    }
    const cw_result result = cw_biss_find_frame(rx, strlen(line), 5U, &first);
    printf("%s %u\n", name_of(result), (unsigned)first);
}

int main(void)
{
@lines@
    printf("%d ", (int)cw_biss_positions_agree(0U, 15U, 4U, 1U));
    printf("%d ", (int)cw_biss_positions_agree(15U, 0U, 4U, 1U));
    printf("%d ", (int)cw_biss_positions_agree(3U, 5U, 4U, 1U));
    printf("%d\n", (int)cw_biss_positions_agree(5U, 5U, 64U, 0U));
    return 0;
}
"""
#: Received bits, and the result with the index of the first bit of the first of two words, of 3 and 2 bits. A line has
#: rest, acknowledge, start, CDS, both words and the stop bit (BiSS protocol description C6, p. 3).
LINES = {
    "11 00 1 0 101 01 0 11": "OK 6",
    "1 0 1 1 000 00 0": "OK 4",
    # Without the bits after the last word.
    "11 00 1 0 101 01": "OK 6",
    "11 00 1 0 101 0": "LENGTH 77",
    # The line is high where the stop bit is.
    "11 00 1 0 101 01 1": "CONSTANT 77",
    "11111111": "LINE_HIGH 77",
    "00001010": "LINE_LOW 77",
    "11000000": "NO_START 77",
}


def test_words_on_the_line_and_positions(tmp_path: Path) -> None:
    source, program = tmp_path / "channels.c", tmp_path / "channels"
    lines = [line.replace(" ", "") for line in LINES]
    calls = "\n".join(f'    receive("{line}");' for line in lines)
    source.write_text(PROGRAM.replace("@lines@", calls), encoding="ascii")
    strict = ["-Wall", "-Wextra", "-Wconversion", "-Werror"]
    require([*GCC, *SANITIZED])
    subprocess.run([*GCC, *SANITIZED, *strict, f"-I{RUNTIME}", str(source), "-o", str(program)], check=True)
    completed = subprocess.run([program], capture_output=True, text=True, check=True)
    # 15 and 0 are next to each other in four bits, 3 and 5 are not.
    assert completed.stdout.splitlines() == [*LINES.values(), "1 1 0 1"]


#: A frame of iC-MR-24-L6T: POS with the turns 6016277, the angle 6016277, no error, no warning and the life counter 42,
#: then TMP with 42. The CRCs are those of x^6 + x + 1 and x^5 + x^2 + 1, inverted (tables 52 and 56 of its data sheet).
IC_MR_FRAME, IC_MR_BITS = 0x2DE68AADE68AF50800549, 83
IC_MR_MAIN = """
#include <stdio.h>
int main(void)
{
    static const uint8_t rx[2][16] = { { @valid@ }, { @damaged@ } };
    unsigned buffer;
    for (buffer = 0U; buffer < 2U; buffer++) {
        ichaus_icmr_biss_channels frame = { 0 };
        const cw_verdict verdict = icmr_biss_channels(rx[buffer], 8U * sizeof rx[buffer], &frame);
        printf("%d %llu %u\\n", (int)verdict, (unsigned long long)frame.pos.position, (unsigned)frame.tmp.temperature);
    }
    return 0;
}
"""


def _buffer_of(frame: int) -> str:
    """Return the bytes of a buffer in C: idle, acknowledge, start bit, CDS, the frame and the stop bit."""
    bits = f"1110000_1_0_{frame:0{IC_MR_BITS}b}_0".replace("_", "").ljust(16 * 8, "0")
    return ", ".join(f"0x{byte:02X}" for byte in int(bits, 2).to_bytes(16, "big"))


def test_the_readme_shows_all_channels(every_encoder: Library, tmp_path: Path) -> None:
    device = next(device for device in every_encoder.devices if device.name == "icmr")
    headers = write(tmp_path, (device,))
    readme = (tmp_path / "c" / "README.md").read_text(encoding="utf-8")
    _, _, channel_section = readme.partition("### Several data channels")
    (code,) = re.findall(r"```c\n(.*?)```", channel_section.partition("\n## ")[0], re.DOTALL)
    main = IC_MR_MAIN.replace("@valid@", _buffer_of(IC_MR_FRAME)).replace("@damaged@", _buffer_of(IC_MR_FRAME ^ 1))
    program = compile_c([*GCC], code + main, tmp_path, headers)
    completed = subprocess.run([program], capture_output=True, text=True, check=True)
    assert completed.stdout == f"3 {6016277 << 24 | 6016277} 42\n0 0 0\n"
