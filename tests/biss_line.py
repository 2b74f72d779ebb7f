"""A BiSS line bit by bit: a master and slaves in a chain, in any language, exchange one bit each way in every frame."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from codewheel.loading.library import load_library
from codewheel.model import Device

SPECS = Path(__file__).resolve().parent / "specs"


class MasterEnd(Protocol):
    """A master with its outcomes by name."""

    @property
    def outcome(self) -> str: ...
    @property
    def slaves(self) -> int: ...
    @property
    def done(self) -> int: ...
    @property
    def data(self) -> bytes: ...
    def read(self, address: int, count: int, slave_id: int, busy_limit: int) -> None: ...
    def write(self, address: int, data: bytes, slave_id: int, busy_limit: int) -> None: ...
    def abort(self) -> None: ...
    def next(self, cds: int) -> int: ...


class SlaveEnd(Protocol):
    """A slave with its requests by name. Without an ID, ``slave_id`` is None."""

    @property
    def wants(self) -> str: ...
    @property
    def address(self) -> int: ...
    @property
    def value(self) -> int: ...
    @property
    def slave_id(self) -> int | None: ...
    def next(self, cdm: int, upstream: int) -> int: ...
    def give(self, value: int) -> None: ...
    def stored(self) -> None: ...


@dataclass
class Memory:
    """Registers behind a slave. The master waits ``delay`` frames for each of them."""

    registers: dict[int, int]
    delay: int = 0
    reads: list[int] = field(default_factory=list)
    writes: list[tuple[int, int]] = field(default_factory=list)
    _waited: int = 0

    def serve(self, slave: SlaveEnd) -> None:
        """Serve the requests of a slave after each frame."""
        if slave.wants == "NOTHING":
            self._waited = 0
        elif self._waited < self.delay:
            self._waited += 1
        elif slave.wants == "BYTE":
            self._waited = 0
            self.reads.append(slave.address)
            slave.give(self.registers[slave.address])
        else:
            self._waited = 0
            self.writes.append((slave.address, slave.value))
            self.registers[slave.address] = slave.value
            slave.stored()


@dataclass
class Line:
    """A line with slaves in order: the first is next to the master, and the last has 0 at its SLI.

    ``cdm`` and ``cds`` record the bits on the line.
    """

    master: MasterEnd
    slaves: Sequence[SlaveEnd]
    memories: Sequence[Memory]
    #: Returns a bit, possibly disturbed, from the number of its frame.
    disturb_cdm: Callable[[int, int], int] = lambda frame, bit: bit
    disturb_cds: Callable[[int, int], int] = lambda frame, bit: bit
    cdm: list[int] = field(default_factory=list)
    cds: list[int] = field(default_factory=list)

    def frame(self) -> None:
        """One BiSS frame: CDS first, from the far end of the chain to the master, then CDM."""
        number = len(self.cdm)
        cdm_bit = self.disturb_cdm(number - 1, self.cdm[-1]) if self.cdm else 0
        bit = 0
        for slave, memory in reversed(list(zip(self.slaves, self.memories, strict=True))):
            bit = slave.next(cdm_bit, bit)
            memory.serve(slave)
        self.cds.append(self.disturb_cds(number, bit))
        self.cdm.append(self.master.next(self.cds[-1]))

    def run(self, frames: int = 2000) -> str:
        """Run frames until the access is over, and then until the line is at rest."""
        for _ in range(frames):
            self.frame()
            if self.master.outcome != "RUNNING":
                break
        outcome = self.master.outcome
        for _ in range(20):
            self.frame()
        return outcome


class PythonMaster:
    """The master of the generated Python package, with its outcomes by name."""

    def __init__(self, biss: Any) -> None:
        self.machine = biss.Master()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.machine, name)

    @property
    def outcome(self) -> str:
        return str(self.machine.outcome.name)

    def read(self, address: int, count: int, slave_id: int, busy_limit: int) -> None:
        self.machine.read(address, count, slave_id=slave_id, busy_limit=busy_limit)

    def write(self, address: int, data: bytes, slave_id: int, busy_limit: int) -> None:
        self.machine.write(address, data, slave_id=slave_id, busy_limit=busy_limit)


class PythonSlave:
    """The slave of the generated Python package, with its requests by name."""

    def __init__(self, biss: Any, readable: Sequence[int] = range(128), writable: Sequence[int] = range(128)) -> None:
        self.machine = biss.Slave(readable, writable)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.machine, name)

    @property
    def wants(self) -> str:
        return str(self.machine.wants.name)


def ssi_only(folder: Path) -> Device:
    """A device without BiSS: the made-up encoder of 22 bits over SSI."""
    text = (
        (SPECS / "bits22.yaml")
        .read_text(encoding="utf-8")
        .replace("  biss:", "  ssi:\n    alignment: lsb_right")
        .replace("interface: biss", "interface: ssi")
    )
    (folder / "bits22.yaml").write_text(text, encoding="utf-8")
    shutil.copy(SPECS / "manufacturer.yaml", folder)
    (device,), report = load_library([folder / "bits22.yaml"])
    assert not report
    assert {interface.name for interface in device.interfaces} == {"ssi"}
    return device
