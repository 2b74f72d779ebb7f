"""Machines that run the generated C.

They are the host, with either form of the CRCs, Cortex-M under system emulation, and a big-endian machine under user
emulation.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from batch import stdio_entry
from c_harness import Run
from tools import tool

HERE = Path(__file__).resolve().parent
_BARE = ["-mthumb", "-std=gnu99", "-nostartfiles", "--specs=nosys.specs", "-T", str(HERE / "cortex_m.ld")]
_EMULATE = [
    "-nographic",
    "-semihosting-config",
    "enable=on,target=native",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-kernel",
]

#: A program with a ``main`` instead of ``work``.
_MAIN = """
static size_t feed(uint8_t *to, size_t count);
static void emit(const uint8_t *from, size_t count);
static int work(void) { return main(); }
"""


@dataclass(frozen=True)
class Machine:
    """How to compile for a machine and how to run a program.

    ``bare`` means that it has no system and needs a start file. ``table`` selects CRCs by table.
    """

    name: str
    compiler: tuple[str, ...]
    emulator: tuple[str, ...] = ()
    bare: bool = False
    table: bool = False

    def entry(self) -> str:
        """Return the end of a program that has ``work``, ``feed`` and ``emit``."""
        return (HERE / "cortex_m.c").read_text(encoding="utf-8") if self.bare else stdio_entry()

    def compile(self, text: str, folder: Path, include: Path, stem: str) -> Program:
        path, program = folder / f"{stem}.c", folder / f"{stem}-{self.name}"
        path.write_text(text, encoding="utf-8")
        compiler = [tool(self.compiler[0]), *self.compiler[1:], *(crc_tables(include) if self.table else ())]
        completed = subprocess.run(
            [*compiler, "-Wall", "-Wextra", "-Werror", f"-I{include}", str(path), "-o", str(program)],
            capture_output=True,
            text=True,
        )
        assert completed.returncode == 0, completed.stderr[:4000]
        emulator = [tool(name) for name in self.emulator[:1]] + list(self.emulator[1:])
        return Program((*emulator, str(program)))

    def compile_main(self, text: str, folder: Path, include: Path, stem: str) -> Program:
        """Return the end of a program with ``main``."""
        return self.compile(text + _MAIN + self.entry() if self.bare else text, folder, include, stem)


def crc_tables(include: Path) -> list[str]:
    """Return the options that select the other form of the CRCs of whole words."""
    return [f"-D{maker.name.upper()}_CRC_TABLE" for maker in sorted(include.iterdir()) if maker.name != "codewheel"]


@dataclass(frozen=True)
class Program:
    command: tuple[str, ...]

    def __call__(self, data: bytes) -> bytes:
        completed = subprocess.run(self.command, input=data, capture_output=True, timeout=300)
        assert completed.returncode == 0, completed.stderr.decode(errors="replace")[:2000]
        return completed.stdout

    def by_line(self) -> Run:
        """Return the same for the program of the harness, which answers line by line."""

        def run(lines: Iterable[str]) -> list[str]:
            return self("".join(f"{line}\n" for line in lines).encode("ascii")).decode("ascii").splitlines()

        return run


HOST = Machine("host", ("gcc", "-std=c99", "-O2"))
MACHINES = (
    Machine("crc-table", ("gcc", "-std=c99", "-O2"), table=True),
    Machine(
        "cortex-m0",
        ("arm-none-eabi-gcc", "-mcpu=cortex-m0", "-Os", *_BARE),
        ("qemu-system-arm", "-M", "microbit", *_EMULATE),
        bare=True,
    ),
    Machine(
        "cortex-m3",
        ("arm-none-eabi-gcc", "-mcpu=cortex-m3", "-O2", *_BARE),
        ("qemu-system-arm", "-M", "lm3s6965evb", *_EMULATE),
        bare=True,
    ),
    Machine(
        "cortex-m4",
        ("arm-none-eabi-gcc", "-mcpu=cortex-m4", "-O3", *_BARE),
        ("qemu-system-arm", "-M", "netduinoplus2", *_EMULATE),
        bare=True,
    ),
    Machine("powerpc", ("powerpc-linux-gnu-gcc", "-std=c99", "-O2", "-static"), ("qemu-ppc-static",)),
)
