"""The numbers of a scale in C: firmware computes a quantity from them in integers."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from c_harness import GCC, SANITIZED, compile_c, devices_of, write

# Compiles a program.
pytestmark = pytest.mark.slow

ENCODERS = Path(__file__).resolve().parents[2] / "specs"
PROGRAM = """\
#include <stdint.h>
#include <stdio.h>

#include "infineon/tle5012b_spi_registers.h"
#include "rls/orbis_serial_rs485.h"

/* In thousandths of a degree, rounded towards 0. */
#define MILLI(name, value) (((value) * name##_NUMERATOR + name##_OFFSET) * 1000 / name##_DENOMINATOR)
#define ORBIS(value) MILLI(RLS_ORBIS_SERIAL_RS485_TEMPERATURE_REPLY_TEMPERATURE, value)
#define TLE(value) MILLI(INFINEON_TLE5012B_SPI_REG_FSYNC_TEMPERATURE, value)

int main(void)
{
    const uint8_t bytes[] = { 0x74, 0x00, 0x03, 0xF5, 0x54 };
    const uint8_t fsync[] = { 0x01, 0xB8 };
    rls_orbis_serial_rs485_temperature_reply reply;
    infineon_tle5012b_spi_reg_fsync reg;
    if (rls_orbis_serial_rs485_temperature_reply_decode(
            RLS_ORBIS_SERIAL_RS485_ORBISSERIAL_14, bytes, sizeof(bytes), &reply) != CW_OK
        || infineon_tle5012b_spi_reg_fsync_decode(
            INFINEON_TLE5012B_SPI_TLE5012B, fsync, sizeof(fsync), &reg) != CW_OK) {
        return 1;
    }
    printf("%d %lld\\n", reply.temperature, (long long)ORBIS(reply.temperature));
    printf("%d %lld\\n", reg.temperature, (long long)TLE(reg.temperature));
    printf("%lld %lld\\n", (long long)TLE(-152), (long long)TLE(195));
    return 0;
}
"""


def test_firmware_computes_temperatures_in_integers(tmp_path: Path) -> None:
    """-2732 is -273.2 °C in a test of a driver. By hand, (-72 + 152) / 2.776 = 28.818, and 0 and 125 are exact."""
    names = ("infineon/manufacturer", "infineon/tle5012b", "rls/manufacturer", "rls/orbis_serial")
    include = write(tmp_path, devices_of(*(ENCODERS / f"{name}.yaml" for name in names)))
    program = compile_c([*GCC, *SANITIZED], PROGRAM, tmp_path, include)
    output = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
    assert output.split() == ["-2732", "-273200", "-72", "28818", "0", "125000"]
