"""Boards on which code is measured: bytes of a function with everything it calls, and instructions of one call."""

from __future__ import annotations

import re
import struct
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import unicorn
from unicorn import arm_const, riscv_const

HERE = Path(__file__).resolve().parent
#: No stack protector and no frame pointer, as in a firmware build.
OPTIONS = ("-std=c11", "-Os", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections", "-nostartfiles")
#: Stack address of the emulated machines, and the address that ends a run. No linker script uses addresses near them.
STACK, STOP, PAGE = 0x70080000, 0x70000000, 0x100000
_LOADED = 1


@dataclass(frozen=True)
class Board:
    """A board. The names of its tools begin with ``prefix``, and ``unit`` is the unit of :meth:`executed`."""

    name: str
    prefix: str
    flags: tuple[str, ...]
    unit: str

    @property
    def compiler(self) -> str:
        return f"{self.prefix}-gcc"

    def version(self) -> str:
        return f"{self.compiler} {_run([self.compiler, '-dumpfullversion', '-dumpversion'])}".strip()

    def link(
        self, sources: Sequence[Path], include: Sequence[Path], entry: str, program: Path, options: Sequence[str] = ()
    ) -> Path:
        command = [
            self.compiler,
            *OPTIONS,
            *self.flags,
            *options,
            *(f"-I{folder}" for folder in include),
            *map(str, sources),
            "-o",
            str(program),
        ]
        _run([*command, *([f"-Wl,-e,{entry}"] if entry else [])])
        return program

    def size(self, sources: Sequence[Path], include: Sequence[Path], function: str, folder: Path) -> int:
        """Return the bytes of code and constants of ``function``, with the library functions that it calls."""
        program = self.link(sources, include, function, folder / f"{self.name}.size.elf")
        lines = _run([f"{self.prefix}-size", "-A", str(program)]).splitlines()
        return sum(int(line.split()[1]) for line in lines if re.match(r"\.(text|rodata|data|sdata|srodata)\b", line))

    def executed(self, sources: Sequence[Path], include: Sequence[Path], folder: Path) -> int:
        """Return the count for one call. ``sources`` contain ``entry``, which calls the function and sets ``good``."""
        if self.name == "avr":
            return self._cycles(sources, include, folder)
        return self._instructions(sources, include, folder)

    def _instructions(self, sources: Sequence[Path], include: Sequence[Path], folder: Path) -> int:
        """Count the instructions between ``entry`` and its return by emulation, without those of ``entry`` itself."""
        program = self.link(
            sources,
            include,
            "entry",
            folder / f"{self.name}.run.elf",
            ["-Wl,--undefined=check", "-Wl,--defsym=nothing=0"],
        )
        lines = [line.split() for line in _run([f"{self.prefix}-nm", "-S", str(program)]).splitlines()]
        symbols = {columns[-1]: columns for columns in lines}
        start, size = (int(column, 16) for column in symbols["entry"][:2])
        entry_addresses = range(start, start + size)
        count = 0

        def step(_machine: object, address: int, _size: int, _data: object) -> None:
            nonlocal count
            count += address not in entry_addresses and address != STOP

        machine = _machine(self.name)
        _load(machine, program)
        hook = machine.hook_add(unicorn.UC_HOOK_CODE, step)
        _call(machine, self.name, entry_addresses.start)
        machine.hook_del(hook)
        _call(machine, self.name, int(symbols["check"][0], 16))
        if not struct.unpack("<i", machine.mem_read(int(symbols["good"][0], 16), 4))[0]:
            raise RuntimeError(f"{program.name}: the frame was not decoded as it should be")
        return count

    def _cycles(self, sources: Sequence[Path], include: Sequence[Path], folder: Path) -> int:
        options = [option for option in OPTIONS if option != "-nostartfiles"]
        program = folder / "avr.run.elf"
        _run(
            [
                self.compiler,
                *options,
                *self.flags,
                *(f"-I{folder}" for folder in include),
                *map(str, sources),
                str(HERE / "c" / "avr_main.c"),
                "-o",
                str(program),
            ]
        )
        simulated = subprocess.run(
            ["simavr", "-m", "atmega328p", "-f", "16000000", str(program)], capture_output=True, text=True, timeout=60
        )
        cycles = re.search(r"(\d{5})", simulated.stdout + simulated.stderr)
        if cycles is None or not int(cycles[1]):
            raise RuntimeError(
                f"{program.name}: the frame was not decoded as it should be: {simulated.stdout}{simulated.stderr}"
            )
        return int(cycles[1])


BOARDS = (
    Board("cortex-m0plus", "arm-none-eabi", ("-mcpu=cortex-m0plus", "-mthumb"), "instructions"),
    Board("cortex-m4", "arm-none-eabi", ("-mcpu=cortex-m4", "-mthumb"), "instructions"),
    Board(
        "rv32imc", "riscv64-unknown-elf", ("-march=rv32imc", "-mabi=ilp32", "--specs=picolibc.specs"), "instructions"
    ),
    Board("avr", "avr", ("-mmcu=atmega328p",), "cycles"),
)


def _machine(name: str) -> Any:
    if name == "rv32imc":
        return unicorn.Uc(unicorn.UC_ARCH_RISCV, unicorn.UC_MODE_RISCV32)
    machine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    machine.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4 if name == "cortex-m4" else arm_const.UC_CPU_ARM_CORTEX_M0)
    return machine


def _call(machine: Any, name: str, address: int) -> None:
    """Run the function at ``address`` until it returns."""
    if name == "rv32imc":
        machine.reg_write(riscv_const.UC_RISCV_REG_SP, STACK)
        machine.reg_write(riscv_const.UC_RISCV_REG_RA, STOP)
    else:
        machine.reg_write(arm_const.UC_ARM_REG_SP, STACK)
        machine.reg_write(arm_const.UC_ARM_REG_LR, STOP | 1)
        address |= 1
    machine.emu_start(address, STOP, count=1_000_000)


def _load(machine: Any, program: Path) -> None:
    """Load the segments of a program and map memory for its stack."""
    data = program.read_bytes()
    offset, (size, count) = struct.unpack_from("<I", data, 28)[0], struct.unpack_from("<HH", data, 42)
    headers = [struct.unpack_from("<IIIIIIII", data, offset + index * size) for index in range(count)]
    loaded = [header for header in headers if header[0] == _LOADED and header[5]]
    pages = {STACK // PAGE, STOP // PAGE}
    for header in loaded:
        start, size = header[2], header[5]
        pages |= {address // PAGE for address in range(start, start + size + PAGE, PAGE)}
    for page in sorted(pages):
        machine.mem_map(page * PAGE, PAGE)
    for header in loaded:
        machine.mem_write(header[2], data[header[1] : header[1] + header[4]])


def _run(command: Sequence[str]) -> str:
    completed = subprocess.run(list(command), capture_output=True, text=True, timeout=120)
    if completed.returncode:
        raise RuntimeError(f"{' '.join(command)}\n{completed.stderr[:2000]}")
    return completed.stdout.strip()
