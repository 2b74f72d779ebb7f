"""The package for Arduino: sketches compile for AVR and print positions. Arduino.h and SPI.h are stubs of our own."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from codewheel.model import Device
from exhaustive import mostly_exhaustive
from test_c_package import crc_of, written
from working_tools import require

pytestmark = pytest.mark.slow

#: The parts of the core and of the library SPI that a sketch uses.
ARDUINO = """#pragma once
#include <stdint.h>
#include <stddef.h>
#define MSBFIRST 1
#define SPI_MODE3 0x0C
void delay(unsigned long ms);
struct SerialPort { void begin(unsigned long baud); void println(const char *text); };
extern SerialPort Serial;
struct SPISettings { SPISettings(uint32_t hz, uint8_t order, uint8_t mode); };
struct Spi {
    void begin();
    void beginTransaction(SPISettings settings);
    void transfer(void *buffer, size_t size);
    void endTransaction();
};
extern Spi SPI;
"""
#: The stubs on a computer, where SPI returns one frame.
HOST = """#include "Arduino.h"
#include <stdio.h>
#include <string.h>
#include <stdlib.h>
SerialPort Serial;
Spi SPI;
void delay(unsigned long) {}
void SerialPort::begin(unsigned long) {}
void SerialPort::println(const char *text) { puts(text); }
SPISettings::SPISettings(uint32_t, uint8_t, uint8_t) {}
void Spi::begin() {}
void Spi::beginTransaction(SPISettings) {}
void Spi::transfer(void *buffer, size_t size)
{
    static const unsigned char frame[] = { @frame@ };
    if (size != sizeof(frame)) { abort(); }
    memcpy(buffer, frame, size);
}
void Spi::endTransaction() {}
void setup();
void loop();
int main() { setup(); loop(); }
"""
FAMILIES = ("am36", "amm5", "asc85", "sma21")


@pytest.fixture
def library(c_devices: tuple[Device, ...], tmp_path: Path) -> Path:
    """Return the folder as an Arduino library, with ``include`` renamed as its README says."""
    root = written(tmp_path, c_devices)
    (root / "include").rename(root / "src")
    for name in ("Arduino.h", "SPI.h"):
        (tmp_path / name).write_text(ARDUINO if name == "Arduino.h" else '#include "Arduino.h"\n', encoding="ascii")
    return root


def compiled(command: list[str], sketch: Path, library: Path, *more: str) -> None:
    """Compile a sketch as Arduino does: as C++, after Arduino.h."""
    require(command)
    source = sketch.with_suffix(".cpp")
    source.write_text('#include "Arduino.h"\n' + sketch.read_text(encoding="ascii"), encoding="ascii")
    options = ["-Wall", "-Wextra", "-Werror", f"-I{library / 'src'}", f"-I{library.parent}"]
    completed = subprocess.run([*command, *options, str(source), *more], capture_output=True, text=True, timeout=120)
    assert completed.returncode == 0, completed.stderr


@pytest.mark.parametrize("family", mostly_exhaustive(FAMILIES, "amm5"))
def test_a_sketch_compiles_for_avr(family: str, library: Path) -> None:
    name = f"{family}_biss_arduino"
    command = ["avr-g++", "-mmcu=atmega328p", "-std=gnu++11", "-Os", "-fno-exceptions"]
    compiled(command, library / "examples" / name / f"{name}.ino", library, "-c", "-o", str(library / "sketch.o"))


@pytest.mark.parametrize(("error", "printed"), [(0, "549755813\n"), (2, "no usable position\n")])
def test_a_sketch_prints_a_position(error: int, printed: str, library: Path) -> None:
    """A frame of AMM5A23/65KSC1 after 5 bits of acknowledge: 39 bits, two flags, active low, and the CRC."""
    data = 549755813 << 2 | (3 ^ error)
    bits = f"110000010{data:041b}{crc_of(data, 41):06b}0".ljust(96, "1")
    frame = ", ".join(str(int(bits[at : at + 8], 2)) for at in range(0, 96, 8))
    main = library.parent / "main.cpp"
    main.write_text(HOST.replace("@frame@", frame), encoding="ascii")
    sketch = library / "examples" / "amm5_biss_arduino" / "amm5_biss_arduino.ino"
    program = library.parent / "program"
    compiled(["g++", "-std=gnu++11"], sketch, library, str(main), "-o", str(program))
    assert subprocess.run([program], capture_output=True, text=True, timeout=60).stdout == printed


def test_the_manifest_has_what_arduino_asks_for(library: Path) -> None:
    lines = (library / "library.properties").read_text(encoding="ascii").splitlines()
    properties = dict(line.split("=", 1) for line in lines if not line.startswith("#"))
    required_keys = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "architectures"}
    assert required_keys <= properties.keys()
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 ._-]{0,62}", properties["name"])
    assert re.fullmatch(r"\d+\.\d+\.\d+", properties["version"])
    sketches = list((library / "examples").rglob("*.ino"))
    assert len(sketches) == len(FAMILIES)
    assert all(path.stem == path.parent.name for path in sketches), "Arduino wants a folder of the same name"
