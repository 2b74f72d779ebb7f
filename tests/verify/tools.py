"""Tools of the evidence. If one is missing, its test is skipped, and the message says how to install it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence

import pytest

#: How each tool is installed on Debian 12.
PACKAGES = {
    "clang": "apt-get install clang libclang-rt-14-dev llvm",
    "clang++": "apt-get install clang libclang-rt-14-dev llvm",
    "llvm-cov": "apt-get install llvm",
    "llvm-profdata": "apt-get install llvm",
    "cppcheck": "apt-get install cppcheck",
    "arm-none-eabi-gcc": "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi",
    "qemu-system-arm": "apt-get install qemu-system-arm",
    "powerpc-linux-gnu-gcc": "apt-get install gcc-powerpc-linux-gnu libc6-dev-powerpc-cross",
    "qemu-ppc-static": "apt-get install qemu-user-static",
    "riscv64-unknown-elf-gcc": "apt-get install gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
    "avr-gcc": "apt-get install gcc-avr avr-libc",
    "simavr": "apt-get install simavr",
    "cbmc": "tests/verify/get-cbmc .cbmc (and apt-get install cryptominisat)",
    "cryptominisat5": "apt-get install cryptominisat",
    "verilator": "apt-get install verilator",
    "cmake": "apt-get install cmake",
    "doxygen": "apt-get install doxygen",
    "pkg-config": "apt-get install pkg-config",
    "sdcc": "apt-get install sdcc",
    "s51": "apt-get install sdcc-ucsim",
    "sstm8": "apt-get install sdcc-ucsim",
    "chromium": "apt-get install chromium",
}


def tool(name: str, folders: Sequence[str] = ()) -> str:
    """Return the path of a tool. If it is missing, skip the test, or fail it with ``CODEWHEEL_REQUIRE_TOOLS=1``."""
    found = shutil.which(name, path=os.pathsep.join([*folders, os.environ.get("PATH", "")]))
    if found:
        return found
    words = f"no {name} here, so this is not shown; {PACKAGES.get(name, 'install it')}"
    if os.environ.get("CODEWHEEL_REQUIRE_TOOLS"):
        pytest.fail(words)
    pytest.skip(words)
