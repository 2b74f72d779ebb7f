"""Procedures of the generated Python package over the bits of BiSS, with every fifth access to registers disturbed."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from bench import codes_with
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.virtual.clocked_lines import BissLine
from codewheel.virtual.encoder import VirtualEncoder
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow

Package = tuple[Path, ModuleType]
ANSWERS = {"zero_bit": "as_printed"}


class Wire:
    """BiSS line in virtual time, 20 µs a cycle. One bit of every fifth access is inverted, on its way there or back."""

    def __init__(self, lika: Any, code: str, seed: int, every: int = 5) -> None:
        self.now, self.every, self.chance = 0.0, every, random.Random(seed)
        needs_answer = code.startswith("ASC")
        answers = ANSWERS if needs_answer else {}
        self.encoder = VirtualEncoder(code, 1000, choose=answers, clock=lambda: self.now)
        self.line = BissLine(self.encoder)
        self.error = lika.biss.AccessError
        self.bus = lika.biss.RegisterBus(self.exchange, busy_limit=1000)
        self.accesses = self.disturbed = 0
        self.countdown = -1

    def exchange(self, cdm: int) -> int:
        self.now += 20e-6
        is_disturbed_bit = self.countdown == 0
        self.countdown -= 1
        self.disturbed += is_disturbed_bit
        in_cdm = self.chance.random() < 0.5
        cds = self.line.exchange(cdm ^ (is_disturbed_bit and in_cdm))[0]
        return cds ^ (is_disturbed_bit and not in_cdm)

    def read(self, address: int, length: int, /) -> bytes:
        return self._repeated(length, lambda: bytes(self.bus.read(address, length)))

    def write(self, address: int, data: bytes, /) -> None:
        self._repeated(len(data), lambda: self.bus.write(address, data))

    def _repeated(self, length: int, access: Callable[[], Any]) -> Any:
        """Repeat an access after an error, and after the longest wait of a command that may have been executed."""
        for _ in range(3):
            self._count(length)
            try:
                return access()
            except self.error:
                self.wait(0.03)
        raise AssertionError("three accesses in a row failed, of which at most one was disturbed")

    def wait(self, seconds: float) -> None:
        self.now += seconds

    def _count(self, length: int) -> None:
        self.accesses += 1
        self.countdown = self.chance.randrange(14, 32 + 14 * length) if self.accesses % self.every == 0 else -1


def _has_preset(device: Device) -> bool:
    return any(procedure.name == "set_preset" for procedure in device.procedures)


@pytest.mark.parametrize("first_code", mostly_exhaustive(range(4), 0))
def test_presets_of_every_order_code(generated_python: Package, library: Library, first_code: int) -> None:
    """The position is always the old one or the preset, and in the end the preset."""
    lika: Any = generated_python[1]
    presets_by_module = Counter[str]()
    with_preset = [device for device in library.devices if _has_preset(device)]
    for at, code in enumerate(codes_with(with_preset, "biss")[first_code::4]):
        encoder = lika.lookup(code)
        module = getattr(lika, encoder.family.name)
        wire = Wire(lika, code, seed=at)
        before = 1000
        for _ in range(5):
            expected = wire.chance.randrange(wire.encoder.counts)
            steps = module.set_preset(encoder, expected)
            while True:
                try:
                    lika.run(steps, wire, wait=wire.wait)
                    break
                except lika.StepError as error:
                    assert isinstance(error.__cause__, lika.VerifyError)
                    assert wire.encoder.position_now() in (before, expected), code
            assert wire.encoder.position_now() == expected, code
            assert encoder.decode(wire.line.frame()).usable_position in (None, expected)
            before = expected
        presets_by_module[module.__name__] += 1
        assert wire.encoder.memory.too_early == 0
        assert 2 * wire.disturbed > wire.accesses // 5
    assert len(presets_by_module) == 3


@pytest.mark.parametrize("first_code", mostly_exhaustive(range(4), 0))
def test_identities_and_serial_numbers(packages: Mapping[str, ModuleType], library: Library, first_code: int) -> None:
    """Reads repeated after an error return only the content of the encoder."""
    codes = [(device, code) for device in library.devices for code in codes_with([device], "biss")]
    for at, (device, code) in enumerate(codes[first_code::4]):
        wire = Wire(packages[device.name], code, seed=at)
        for name, register in wire.encoder.memory.registers.items():
            if not register.readable:
                continue
            contents = bytes(wire.chance.randrange(1, 256) for _ in range(register.length))
            if name in ("serial_number", "device_id"):
                for place, byte in enumerate(contents):
                    wire.encoder.memory.hold(register.address + place, byte)
                assert [wire.read(register.address, register.length) for _ in range(5)] == [contents] * 5


def test_all_procedures_of_each_family(packages: Mapping[str, Any], library: Library) -> None:
    """Every procedure over BiSS succeeds, with its limits as arguments."""
    carried_out = 0
    for device in library.devices:
        package = packages[device.name]
        code = next(variant.code for variant in device.variants if variant.interface == "biss")
        module, encoder = getattr(package, device.name), package.lookup(code)
        for at, procedure in enumerate(procedure for procedure in device.procedures if procedure.interface == "biss"):
            wire = Wire(package, code, seed=at)
            values = {argument.name: _value(argument.of) for argument in procedure.arguments}
            # The module's own identify() compares registers.
            name = "identify_steps" if procedure.name == "identify" else procedure.name
            package.run(getattr(module, name)(variant=encoder, **values), wire, wait=wire.wait)
            carried_out += 1
    assert carried_out > 20


def _value(register: str) -> int:
    return {"information_per_revolution": 4096, "number_of_revolutions": 16, "configuration": 0x20}.get(register, 77)


def test_every_fault_of_a_clocked_line(generated_python: Package) -> None:
    """A disturbed frame is an error or, if only CDS or what lies outside the CRC changed, the right position."""
    lika: Any = generated_python[1]
    encoder = lika.lookup("AMM5A21/65KSC1")
    for fault in ("lost", "short", "late", "flip", "low", "high", "busy", "restart", "brownout"):
        now = [0.0]
        virtual = VirtualEncoder(
            "AMM5A21/65KSC1", lambda at: at * 1e6, faults=[f"{fault}:0.3"], clock=lambda now=now: now[0]
        )
        line = BissLine(virtual)
        outcomes = Counter[str]()
        for _ in range(2000):
            now[0] += 0.01
            true_position = virtual.position_now()
            bits = line.cycle(0)
            start = next((at for at, bit in enumerate(bits) if bit), None)
            word = "".join(map(str, bits[start + 2 : start + 2 + line.bits])) if start is not None else ""
            decoded = encoder.try_decode(int(word or "0", 2), bits=len(word))
            value = decoded.usable_position
            outcome = "right" if value == true_position else "wrong"
            outcomes["none" if value is None else outcome] += 1
        # A cut leaves 1 bits, and a disturbed start bit moves the word: six bits of CRC miss one in 64.
        assert outcomes["wrong"] <= (2000 * 0.3 / 64 if fault in ("short", "brownout", "flip") else 0), fault
        assert outcomes["right"] > 100, fault
        assert outcomes["none"] > 100 or fault in ("late", "busy", "restart"), fault
