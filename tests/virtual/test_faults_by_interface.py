"""A fault that an interface can have changes every reply. Any other fault is refused when the encoder is created."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import INTERFACES, Device, Layout, Rs485, Spi, number_to_bytes
from codewheel.reference import codec
from codewheel.virtual.clocked_lines import BissLine, ByLevels, SsiLine
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line
from codewheel.virtual.simulation_options import FAULTS, Faults, faults_of
from codewheel.virtual.spi_line import SpiLine

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "specs"
#: Faults that need a request and a reply as bytes, and a fault that needs a start bit.
ONLY_BYTES = {"doubled", "repeated", "second", "echo", "junk"}
NOT_CLOCKED = {"biss": ONLY_BYTES, "ssi": ONLY_BYTES | {"late"}, "spi": ONLY_BYTES | {"late", "busy"}}
LIKA, AMS = (Path(__file__).parents[2] / "specs" / name for name in ("lika", "ams"))
CODES = {"rs485": "AMM5A23/65KJP1", "biss": "AMM5A21/65KSC1", "ssi": "AMM5A21/65KBG1", "spi": "AS5047P"}
REPLIES = 40
#: Milliseconds between replies: within the 20 ms for which a fault lasts, and after them.
PAUSES_MS = (1, 50)


def new_encoder(code: str, *faults: str, **more: Any) -> VirtualEncoder:
    return VirtualEncoder(code, faults=faults, specs=[LIKA, AMS], **more)


@pytest.mark.parametrize("interface", CODES)
def test_each_interface_has_its_faults(interface: str) -> None:
    assert set(faults_of(interface)) == set(FAULTS) - NOT_CLOCKED.get(interface, set())


@pytest.mark.parametrize(
    ("interface", "fault"),
    [(interface, fault) for interface, faults in NOT_CLOCKED.items() for fault in sorted(faults)],
)
@pytest.mark.parametrize("rate", ["", ":0", ":1e-3"])
def test_a_fault_that_the_interface_cannot_have_is_refused(interface: str, fault: str, rate: str) -> None:
    name = {"biss": "BiSS", "ssi": "SSI", "spi": "SPI"}[interface]
    message = f"{name} cannot have the fault '{fault}'; it can have: lost, short, "
    with pytest.raises(ValueError, match=f"^{message}"):
        new_encoder(CODES[interface], f"{fault}{rate}")
    with pytest.raises(ValueError, match=f"^{message}"):
        Faults(interface, [f"{fault}{rate}"])


@pytest.mark.parametrize("fault", ["junk", "echo", "doubled"])
def test_simulate_refuses_it_before_it_opens_a_port(fault: str, capsys: pytest.CaptureFixture[str]) -> None:
    possible = "lost, short, late, flip, low, high, busy, restart, brownout"
    assert main(["simulate", CODES["biss"], "--tcp", "--fault", f"{fault}:1e-3", "--specs", str(LIKA)]) == 2
    captured = capsys.readouterr()
    assert captured.err == f"codewheel: BiSS cannot have the fault '{fault}'; it can have: {possible}\n"
    assert captured.out == ""


@pytest.mark.slow
def test_the_fixture_refuses_it(virtual_encoder: Callable[..., Any]) -> None:
    with pytest.raises(ValueError, match=r"^SSI cannot have the fault 'late'; it can have: "):
        virtual_encoder(CODES["ssi"], faults=["late:0.01"])


def test_the_help_lists_the_faults_of_each_interface(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "--help"]) == 0
    help_text = capsys.readouterr().out
    for interface in CODES:
        block = help_text.split(f"faults over {INTERFACES[interface].short}:\n")[1].split("\n\n")[0]
        assert dict(re.findall(r"^  (\w+) +(.*)$", block, re.MULTILINE)) == faults_of(interface)


@cache
def families() -> tuple[Device, ...]:
    """Return all families, including the families of the examples."""
    devices, report = load_library([EXAMPLES])
    assert not report
    return tuple(device for device in devices if not device.base)


def encoders(interface: str) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the first and the last order code of each family with an interface, with answers to its questions."""
    for device in families():
        codes = [variant.code for variant in device.variants if variant.interface == interface]
        for code in dict.fromkeys(codes[:1] + codes[-1:]):
            yield code, {alternative.name: alternative.answers[0].name for alternative in device.alternatives}


class Pair:
    """An encoder without faults, and the same encoder with one fault in every reply."""

    def __init__(self, code: str, answers: dict[str, str], fault: str) -> None:
        self.now = 100.0
        specs = [EXAMPLES]
        encoder_with = partial(VirtualEncoder, code, self.position, choose=answers, clock=lambda: self.now, specs=specs)
        self.encoders = [encoder_with(faults=()), encoder_with(faults=(fault,))]
        self.counts, self.lowest = self.encoders[0].counts, self.encoders[0].lowest
        # Neither all bits 0 nor all 1, which a line at one level would not change.
        self.places = random.Random(code).sample(range(1, self.counts - 1), REPLIES)
        self.turn = 0

    def position(self, now: float) -> float:
        return self.lowest + self.places[self.turn % REPLIES]

    def replies(self, reply: Callable[[VirtualEncoder], Callable[[], Any]], pause_ms: int) -> Iterator[tuple[Any, Any]]:
        """Yield the replies of both encoders at the same times."""
        intact, faulty = (reply(encoder) for encoder in self.encoders)
        for self.turn in range(REPLIES):
            self.now += pause_ms / 1000
            yield intact(), faulty()


def words(encoder: VirtualEncoder) -> Callable[[], Any]:
    line = SsiLine(encoder)
    return line.word


def cycles(encoder: VirtualEncoder) -> Callable[[], Any]:
    line = BissLine(encoder)
    return lambda: line.cycle(0)


def spi_words(encoder: VirtualEncoder) -> Callable[[], Any]:
    line, interface = SpiLine(encoder), encoder.device.interface("spi")
    assert isinstance(interface, Spi)
    exchange = next((exchange for exchange in interface.exchanges if exchange.purpose == "position"), None)
    if exchange is None:
        return lambda: line.exchange(0)
    layout = next(layout for layout in interface.layouts if layout.name == exchange.request)
    bits = encoder.place(layout).bits
    word = codec.encode(encoder.device, encoder.place(layout), values_of(layout))
    line.exchange(word, bits)
    return lambda: line.exchange(word, bits)


def line_levels(encoder: VirtualEncoder) -> Callable[[], Any]:
    """Return a function that clocks out all bits, and returns the levels of the data line."""
    line: ByLevels = BissLine(encoder) if encoder.variant.interface == "biss" else SsiLine(encoder)
    # A frame can carry several data channels, each with a layout of its own.
    clocks = 8 + sum(encoder.place(layout).bits for layout in encoder.layouts("encoder"))

    def clocked() -> bytes:
        line.receive(b"T" + b"C" * clocks)
        return line.send()

    return clocked


BITS = {"ssi": (words, line_levels), "biss": (cycles, line_levels), "spi": (spi_words,)}


@pytest.mark.one_in(20, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("pause_ms", PAUSES_MS)
@pytest.mark.parametrize(("interface", "fault"), [(name, fault) for name in BITS for fault in faults_of(name)])
def test_each_fault_changes_every_word(interface: str, fault: str, pause_ms: int) -> None:
    tried = 0
    for code, answers in encoders(interface):
        for reply in BITS[interface]:
            pair = Pair(code, answers, fault)
            for intact, faulty in pair.replies(reply, pause_ms):
                assert intact != faulty, (code, reply.__name__, pair.turn)
                tried += 1
            assert pair.encoders[1].faults.injected[fault] >= REPLIES
    assert tried > 100


def requests(encoder: VirtualEncoder) -> Iterator[bytes]:
    """Yield each request for data."""
    interface = encoder.device.interface("rs485")
    assert isinstance(interface, Rs485)
    layouts = {layout.name: layout for layout in interface.layouts}
    for data_id in interface.data_ids:
        if data_id.purpose == "read":
            request = next(layout for layout in encoder.layouts("master") if data_id.id in layout.selects)
            values: dict[str, int | str | bool] = {request.selector: data_id.id, "address": 1}
            yield encoded(encoder, request, values)
        elif data_id.purpose != "write":
            yield bytes([data_id.control])
    for exchange in interface.exchanges:
        if exchange.purpose == "position":
            request = layouts[exchange.request]
            yield encoded(encoder, request, values_of(request))


def values_of(layout: Layout) -> dict[str, int | str | bool]:
    """Return the default of each field of a request, or 0."""
    return {field.name: field.default or 0 for field in layout.data_fields}


def encoded(encoder: VirtualEncoder, layout: Layout, values: dict[str, int | str | bool]) -> bytes:
    placed = encoder.place(layout)
    return number_to_bytes(layout, codec.encode(encoder.device, placed, values), placed.bits)


def timed_reply(request: bytes) -> Callable[[VirtualEncoder], Callable[[], Any]]:
    """Return the bytes that come at once, and the time and the bytes of those that come later."""

    def reply(encoder: VirtualEncoder) -> Callable[[], Any]:
        line = Rs485Line(encoder)

        def asked() -> tuple[bytes, float | None]:
            line.send()
            line.receive(request)
            return line.send(), line.due()

        return asked

    return reply


@pytest.mark.one_in(10, "exhaustive")
@pytest.mark.slow
@pytest.mark.parametrize("fault", faults_of("rs485"))
def test_each_fault_changes_every_reply(fault: str) -> None:
    tried = 0
    for code, answers in encoders("rs485"):
        data_requests = list(requests(VirtualEncoder(code, choose=answers, specs=[EXAMPLES])))
        assert data_requests, code
        for request in data_requests:
            pair = Pair(code, answers, fault)
            for intact, faulty in pair.replies(timed_reply(request), 50):
                assert intact[0]
                assert intact != faulty, (code, request.hex(" "), pair.turn)
                tried += 1
            assert pair.encoders[1].faults.injected[fault] == REPLIES
    assert tried > 100
