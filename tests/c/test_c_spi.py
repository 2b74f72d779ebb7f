"""``spi.h``: the request that a word answers, and values of registers as bytes, with both kinds of replies."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, RUNTIME, SANITIZED
from working_tools import require

pytestmark = pytest.mark.slow

PROGRAM = """
#include <stdio.h>
#include "codewheel/spi.h"

static void answered(uint32_t reply_words)
{
    cw_spi_pipeline line;
    uint32_t request;
    cw_spi_start(&line, reply_words);
    for (request = 1U; request < 4U; request++) {
        const cw_spi_asked found = cw_spi_exchange(&line, request, 0x10U + request);
        printf("%u %u\\n", (unsigned)found.request, (unsigned)found.address);
    }
    cw_spi_start(&line, reply_words);
    printf("%u\\n", (unsigned)cw_spi_exchange(&line, 9U, 0U).request);
}

static void lengths(void)
{
    uint8_t bytes[4] = { 0U, 0U, 0U, 0U };
    uint64_t word = 7U;
    printf("%d %d\\n", (int)cw_spi_store(0x1ABCDU, 17U, bytes, 2U), (int)cw_spi_store(0x1ABCDU, 17U, bytes, 4U));
    printf("%d %d\\n", (int)cw_spi_load(bytes, 2U, 17U, &word), (int)cw_spi_load(bytes, 4U, 17U, &word));
    printf("%02X %llu\\n", bytes[0], (unsigned long long)word);
    printf("%d\\n", (int)cw_spi_store(0x1ABCDU, 17U, bytes, 3U));
    printf("%02X %02X %02X\\n", bytes[0], bytes[1], bytes[2]);
    printf("%d\\n", (int)cw_spi_load(bytes, 3U, 17U, &word));
    printf("%llX\\n", (unsigned long long)word);
}

int main(void)
{
    uint8_t bytes[3] = { 0xFFU, 0xFFU, 0xFFU };
    answered(1U);
    answered(0U);
    cw_spi_bytes(0x12ABU, bytes, 2U);
    printf("%02X %02X %02X\\n", bytes[0], bytes[1], bytes[2]);
    printf("%llX %llX\\n", (unsigned long long)cw_spi_data(bytes, 3U), (unsigned long long)cw_spi_data(bytes, 0U));
    lengths();
    return 0;
}
"""
NEXT_WORD = ["0 0", "1 17", "2 18", "0"]
#: A word of 17 bits has three bytes. With two or four of them, the outputs are unchanged.
LENGTHS = ["1 1", "1 1", "00 7", "0", "01 AB CD", "0", "1ABCD"]
SAME_WORD = ["1 17", "2 18", "3 19", "9"]


def test_requests_and_values(tmp_path: Path) -> None:
    source, program = tmp_path / "spi.c", tmp_path / "spi"
    source.write_text(PROGRAM, encoding="ascii")
    strict = ["-Wall", "-Wextra", "-Wconversion", "-Werror"]
    require([*GCC, *SANITIZED])
    subprocess.run([*GCC, *SANITIZED, *strict, f"-I{RUNTIME}", str(source), "-o", str(program)], check=True)
    completed = subprocess.run([program], capture_output=True, text=True, check=True)
    assert completed.stdout.splitlines() == [*NEXT_WORD, *SAME_WORD, "12 AB FF", "12ABFF 0", *LENGTHS]
