"""Faults by name, at a rate, without I/O and in virtual time: each leads to its error, none to a wrong position."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from types import ModuleType
from zlib import crc32

import pytest
from bench import Bench, codes_with, shares
from codewheel.targets import Library
from codewheel.virtual.simulation_options import FAULTS

pytestmark = pytest.mark.slow

Package = tuple[Path, ModuleType]
#: Errors that a fault can have. No other error may occur, and at least the first one must.
ERRORS = {
    "lost": ("NoReplyError",),
    "short": ("DisturbedError", "NoReplyError"),
    "doubled": (),
    # An extra reply before or after the next reply makes that reply useless, if they differ.
    "repeated": ("DisturbedError", "SecondDeviceError"),
    "second": ("DisturbedError", "SecondDeviceError"),
    # The second part of a late reply looks disturbed.
    "late": ("NoReplyError", "DisturbedError"),
    "flip": ("DisturbedError",),
    "echo": (),
    "junk": (),
    "low": ("DisturbedError",),
    "high": ("NoReplyError",),
    "busy": ("NotUsableError", "NoReplyError"),
    "restart": ("NoReplyError", "NotUsableError"),
    "brownout": ("DisturbedError", "NotUsableError", "NoReplyError"),
}


def count_outcomes(
    package: ModuleType, codes: list[str], fault: str, rate: float, total: int, retries: int
) -> tuple[Counter[str], Counter[str]]:
    """Return the outcomes and the injected faults of this many requests, spread over all order codes."""
    outcomes, injected = Counter[str](), Counter[str]()
    for code, count in shares(total, codes):
        bench = Bench(package, code, f"{fault}:{rate}", seed=crc32(f"{code} {fault}".encode()), retries=retries)
        for _ in range(count):
            bench.position()
        outcomes += bench.outcomes
        injected += bench.virtual.faults.injected
    return outcomes, injected


def test_each_fault_has_errors_here() -> None:
    assert sorted(ERRORS) == sorted(FAULTS)


@pytest.mark.one_in(8, "exhaustive")
@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_has_its_error(generated_python: Package, library: Library, fault: str) -> None:
    """One reply in five has the fault, and nothing is retried."""
    codes = codes_with(library.devices, "rs485")
    outcomes, injected = count_outcomes(generated_python[1], codes, fault, 0.2, 2500, 0)
    assert outcomes["wrong"] == 0
    assert set(outcomes) - {"right", "wrong"} <= set(ERRORS[fault])
    assert all(outcomes[name] for name in ERRORS[fault][:1])
    assert outcomes["right"] > 100
    assert injected[fault] > 100


@pytest.mark.one_in(6, "exhaustive")
@pytest.mark.parametrize("fault", FAULTS)
def test_retries_make_up_for_a_fault(generated_python: Package, library: Library, fault: str) -> None:
    """One reply in fifty has the fault. The link gives up only if an encoder is busy or off, or if two reply."""
    codes = codes_with(library.devices, "rs485")
    outcomes, injected = count_outcomes(generated_python[1], codes, fault, 0.02, 2500, 3)
    assert outcomes["wrong"] == 0
    lasting = sum(outcomes.values()) - outcomes["right"]
    assert lasting == 0 or fault in ("busy", "restart", "brownout", "second")
    assert injected[fault] > 10


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize("fault", FAULTS)
def test_resets_of_ten_requests(generated_python: Package, library: Library, fault: str) -> None:
    """A reset that succeeds was carried out, however often it had to start again."""
    lika = generated_python[1]
    succeeded = 0
    for at, code in enumerate(codes_with(library.devices, "rs485")):
        bench = Bench(lika, code, f"{fault}:0.05", seed=at, retries=20)
        bench.virtual.position = 1234 + at
        module = getattr(lika, bench.session.encoder.family.name)
        procedures = [procedure for procedure in bench.virtual.device.procedures if procedure.interface == "rs485"]
        procedure = next(reset for reset in procedures if "reset" in reset.name and "errors" not in reset.name)
        try:
            bench.do(bench.session.run(getattr(module, procedure.name)()))
        except lika.StepError:
            continue
        succeeded += 1
        bench.now += 1
        assert bench.virtual.position_now() == 0
    assert succeeded > 5


def test_memory_that_is_busy(generated_python: Package) -> None:
    """Accesses wait for MEM BUSY, and the reply to another address is refused."""
    lika = generated_python[1]
    answer = lika.amm5.AdfLayout.AS_T_FORMAT
    bench = Bench(lika, "AMM5A23/65KJP1", "busy:0.1", choose={"adf_layout": "as_t_format"})
    for address in range(100):
        written = lika.amm5.EepromWriteRequest(answer, address, address ^ 0x5A)
        assert bench.do(bench.session.exchange(written)).data == address ^ 0x5A
        read = bench.do(bench.session.exchange(lika.amm5.EepromReadRequest(answer, address)))
        assert (read.address, read.data) == (address, address ^ 0x5A)
    assert bench.virtual.faults.injected["busy"] > 10


def test_a_memory_that_stays_busy(generated_python: Package) -> None:
    lika = generated_python[1]
    from codewheel_runtime.link import BusyError

    bench = Bench(lika, "AMM5A23/65KJP1", "busy", choose={"adf_layout": "as_t_format"})
    request = lika.amm5.EepromReadRequest(lika.amm5.AdfLayout.AS_T_FORMAT, 1)
    with pytest.raises(BusyError, match="the memory of AMM5A23/65KJP1 stayed busy for 1 s"):
        bench.do(bench.session.exchange(request))
    assert 1 < bench.now < 1.1


@pytest.mark.parametrize("noise", [b"\x1a" * 4096, bytes(4096), bytes(range(256)) * 16])
def test_endless_noise_ends_in_an_error_and_takes_little_memory(generated_python: Package, noise: bytes) -> None:
    from codewheel_runtime.link import Link, LinkError

    class Noise:
        def write(self, data: bytes) -> None:
            pass

        def read(self, timeout_s: float) -> bytes:
            return noise

    link = Link(generated_python[1].lookup("AMM5A23/65KJP1"), Noise(), retries=0)
    with pytest.raises(LinkError) as caught:
        link.position()
    assert len(caught.value.received) < 3 * 4096


def test_requests_that_there_are_not(generated_python: Package) -> None:
    from codewheel_runtime.link import LinkError

    bench = Bench(generated_python[1], "AMM5A23/65KJP1")
    for request in (b"\x55", b"", generated_python[1].sma21.DataId.POSITION, "position", 5):
        with pytest.raises(
            LinkError, match=r"AMM5A23/65KJP1 has no request '.*'; its requests are 02 \(singleturn\), "
        ):
            bench.do(bench.session.exchange(request))
