"""Requests over RS-485 with an address and a command: the link and a virtual encoder, and a program in C."""

from __future__ import annotations

import importlib
import random
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

import pytest
from bench import Bench
from codewheel.commands.cli import main
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line
from codewheel.virtual.simulation_options import FAULTS
from exhaustive import mostly_exhaustive
from test_link_faults import ERRORS

pytestmark = pytest.mark.slow

SPECS = Path(__file__).parents[2] / "specs"
PAGE = SPECS.parent / "docs/firmware/rs485.md"
#: The example in the data sheet of the AMT21, and a reply that HPMicro logged from an SKM36.
AMT21, SKM36 = bytes.fromhex("AB 61"), bytes.fromhex("40 42 00 27 25 51 51")
ASK = {"AMT212B": b"\x54", "SKM36": bytes.fromhex("40 42 02")}


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("exchanges")
    specs = [str(SPECS / "cui"), str(SPECS / "sick")]
    assert main(["generate", *specs, "--target", "python", "--target", "c", "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def modules(outputs: Path) -> Iterator[dict[str, Any]]:
    candidates = (outputs / "python", *(outputs / "python").glob("*_encoders"))
    folders = [str(folder) for folder in candidates if folder.is_dir()]
    sys.path[:0] = folders
    yield {
        "AMT212B": importlib.import_module("cui_encoders.amt21"),
        "SKM36": importlib.import_module("sick_encoders.skm36"),
    }
    for folder in folders:
        sys.path.remove(folder)


class Answering:
    """Line that answers each request with the bytes that a function returns."""

    def __init__(self, reply: Callable[[bytes], bytes]) -> None:
        self.reply, self.sent, self.waiting = reply, list[bytes](), b""

    def write(self, data: bytes) -> None:
        self.sent.append(data)
        self.waiting += self.reply(data)

    def read(self, timeout_s: float) -> bytes:
        received, self.waiting = self.waiting, b""
        return received


def link(module: Any, code: str, reply: Callable[[bytes], bytes]) -> Any:
    from codewheel_runtime.link import Link

    return Link(module.lookup(code), Answering(reply), timeout_s=0.01, retries=0)


def on_virtual(module: Any, code: str, position: int) -> Any:
    line = Rs485Line(VirtualEncoder(code, position, specs=[SPECS]))

    def reply(data: bytes) -> bytes:
        line.receive(data)
        return line.send()

    return link(module, code, reply)


@pytest.mark.parametrize(("code", "reply", "position"), [("AMT212B", AMT21, 8619), ("SKM36", SKM36, 626 << 12 | 1361)])
def test_the_link_asks_for_the_position(code: str, reply: bytes, position: int, modules: dict[str, Any]) -> None:
    """Alone, after an echo of the request, and with the address in the request."""
    module = modules[code]
    alone = link(module, code, lambda data: reply)
    assert (alone.position(), alone.transport.sent) == (position, [ASK[code]])
    assert link(module, code, lambda data: data + reply).position() == position
    (first, *_) = module.lookup(code).exchanges()
    request = first.request(**first.defaults)
    assert request.encode() == first.request().encode() == ASK[code]
    assert alone.position(request) == alone.position(request.encode()) == position


@pytest.mark.parametrize(
    ("code", "reply", "message"),
    [
        ("SKM36", "41 42 00 27 25 51 50", "the reply of SKM36 has address 65, but 64 was sent"),
        ("SKM36", "40 42 00 27 25 51 52", "no valid reply to the request 40 42 02 to SKM36 in 40 42 00 27 25 51 52"),
        ("SKM36", "40 52 E4 FF 80 01 88", "no valid reply to the request 40 42 02 to SKM36 in 40 52 E4 FF 80 01 88"),
        ("SKM36", "40 42 00", "incomplete reply to the request 40 42 02 to SKM36: 3 of 7 bytes, 40 42 00"),
        ("SKM36", "40 42 02", "only an echo of the request 40 42 02 to SKM36"),
        ("AMT212B", "AA 61", "no valid reply to the request 54 to AMT212B in AA 61"),
        ("AMT212B", "AB 61 00", "no valid reply to the request 54 to AMT212B in AB 61 00"),
        ("AMT212B", "54", "only an echo of the request 54 to AMT212B"),
        ("AMT212B", "AB", "incomplete reply to the request 54 to AMT212B: 1 of 2 bytes, AB"),
        ("AMT212B", "", "no reply to the request 54 to AMT212B within 10 ms"),
    ],
)
def test_other_bytes_are_no_reply(code: str, reply: str, message: str, modules: dict[str, Any]) -> None:
    from codewheel_runtime.link import LinkError

    with pytest.raises(LinkError) as error:
        link(modules[code], code, lambda data: bytes.fromhex(reply)).position()
    assert str(error.value).startswith(message)


def test_requests_that_cannot_be_exchanged(modules: dict[str, Any]) -> None:
    from codewheel_runtime.link import LinkError

    module = modules["AMT212B"]
    line = link(module, "AMT212B", lambda data: b"")
    with pytest.raises(LinkError, match=r"^AMT212B does not answer ResetRequest: send its bytes with 'send'$"):
        line.exchange(module.ResetRequest(address=0x15))
    line.send(module.ResetRequest(address=0x15).encode())
    assert line.transport.sent == [bytes.fromhex("56 75")]
    request_names = "PositionRequest, TurnsRequest, ZeroRequest, ResetRequest"
    with pytest.raises(LinkError, match=f"^AMT212B has no request '57'; its requests are {request_names}$"):
        line.exchange(b"\x57")


@pytest.mark.parametrize(("code", "counts"), [("AMT212B", 1 << 14), ("SKM36", 1 << 24)])
def test_a_virtual_encoder_answers(code: str, counts: int, modules: dict[str, Any]) -> None:
    """Positions arrive, even if a request comes byte by byte or after a broken request.

    Other addresses get no answer.
    """
    from codewheel_runtime.link import NoReplyError

    chance = random.Random(485)
    for position in (0, counts - 1, *(chance.randrange(counts) for _ in range(200))):
        assert on_virtual(modules[code], code, position).position() == position
    (first, *_) = modules[code].lookup(code).exchanges()
    with pytest.raises(NoReplyError):
        on_virtual(modules[code], code, 1).position(first.request(address=0x20))
    line = Rs485Line(VirtualEncoder(code, 1, specs=[SPECS], clock=lambda: 1.0))
    line.receive(b"\x01" + ASK[code])
    reply = line.send()
    for byte in ASK[code]:
        line.receive(bytes([byte]))
    assert line.send() == reply
    assert modules[code].lookup(code).decode(reply).position == 1


def outcomes(module: Any, code: str, fault: str, total: int) -> tuple[Counter[str], Counter[str], int]:
    """Return the outcomes without retries and many faults, with retries and few faults, and the number of faults."""
    counts, injected = [], 0
    for rate, retries in ((0.2, 0), (0.02, 3)):
        seed = crc32(f"{code} {fault}".encode())
        bench = Bench(module, code, f"{fault}:{rate}", seed=seed, retries=retries, specs=[SPECS])
        for _ in range(total // 2):
            bench.position()
        counts.append(bench.outcomes)
        injected += bench.virtual.faults.injected[fault]
    return counts[0], counts[1], injected


def check_positions(module: Any, code: str, fault: str, requests: int) -> None:
    """Half of the requests without retries and many faults, half with retries and few: no position is wrong.

    The replies of the AMT21 can begin with any byte, so replies with other bytes around them are rejected. Faults in
    three requests in a row look like a second device.
    """
    has_bytes_around = fault in ("doubled", "junk") and code == "AMT212B"
    refused = ("DisturbedError", "SecondDeviceError") if has_bytes_around else ()
    plain, retried, injected = outcomes(module, code, fault, requests)
    assert set(plain) - {"right"} <= {*ERRORS[fault], *refused}
    assert plain["right"] > requests / 4
    # Four faults in a row, so that no retry is left, occur once in six million requests.
    assert retried["right"] >= requests // 2 - 2
    assert not retried["wrong"]
    assert injected > requests / 20


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("code", mostly_exhaustive(ASK, next(iter(ASK))))
def test_no_fault_makes_a_position_wrong(code: str, fault: str, modules: dict[str, Any]) -> None:
    check_positions(modules[code], code, fault, 1000)


def test_the_program_of_the_page(modules: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    module = modules["SKM36"]
    reply_class_by_command = {0x42: module.PositionReply, 0x52: module.TypeLabelReply}

    def reply(request_bytes: bytes) -> bytes:
        values = (626, 1361) if request_bytes[1] == 0x42 else (0xE4FF8001,)
        address, command = request_bytes[:2]
        if command == 0x53:
            return b""
        return bytes(reply_class_by_command[command](address, *values).encode())

    encoder_link = link(module, "SKM36", reply)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    exec(program, {"open_encoder": lambda port, code: encoder_link, "skm36": module})
    expected_requests = ["40 42 02", "41 42 03", "40 52 12", "40 53 13"]
    assert [request.hex(" ") for request in encoder_link.transport.sent] == expected_requests
    assert capsys.readouterr().out.splitlines()[:2] == 2 * [str(626 << 12 | 1361)]


def test_the_command_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    (session,) = re.findall(r"```console\n\$ codewheel (.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    command, output = session.split("\n", 1)
    specs = command.split()
    assert main(specs) == 0
    assert capsys.readouterr().out == output


PROGRAM = r"""
#include <stdio.h>
#include "codewheel/receive.h"
#include "cui/amt21_rs485.h"
#include "sick/skm36_rs485.h"

/* One line for each reply in hex: A or S, then its bytes. Print the result and the position. */
int main(void)
{
    const cui_amt21_rs485 amt = CUI_AMT21_RS485_2B;
    const sick_skm36_rs485 skm = SICK_SKM36_RS485_SKM36;
    const cui_amt21_rs485_position_request of_amt = { 0x15U };
    const sick_skm36_rs485_position_request of_skm = { 0x40U };
    uint8_t request[3];
    cw_rs485_line line;
    char kind;
    while (scanf(" %c", &kind) == 1) {
        unsigned byte;
        unsigned count;
        bool whole = false;
        cw_result asked;
        if (kind == 'A') {
            asked = cui_amt21_rs485_position_request_encode(amt, &of_amt, request, 1U);
        } else {
            asked = sick_skm36_rs485_position_request_encode(skm, &of_skm, request, 3U);
        }
        if ((asked != CW_OK) || (cw_rs485_ask(&line, request[0], (kind == 'A') ? CUI_AMT21_RS485_POSITION_REPLY_LENGTH
                : SICK_SKM36_RS485_POSITION_REPLY_LENGTH, 0U, 0U, 100U) != CW_OK) || (scanf("%u", &count) != 1)) {
            return 1;
        }
        while ((count-- != 0U) && (scanf("%x", &byte) == 1)) {
            whole = (kind == 'A') ? cw_rs485_take_any(&line, (uint8_t)byte) : cw_rs485_take(&line, (uint8_t)byte);
        }
        if (kind == 'A') {
            cui_amt21_rs485_position_reply reply = { 0 };
            const cw_result found = cui_amt21_rs485_position_reply_decode(amt, line.bytes, line.count, &reply);
            printf("%02X %d %d %lu\n", request[0], whole, (int)found, (unsigned long)reply.position);
        } else {
            sick_skm36_rs485_position_reply reply = { 0 };
            const cw_result found = sick_skm36_rs485_position_reply_decode(skm, line.bytes, line.count, &reply);
            printf("%02X%02X%02X %d %d %lu\n", request[0], request[1], request[2], whole, (int)found,
                (unsigned long)reply.position);
        }
    }
    return 0;
}
"""


def test_a_program_in_c(outputs: Path, tmp_path: Path) -> None:
    """The same replies with the receiver of the C runtime, the second one for replies that begin with any byte."""
    source, program = tmp_path / "ask.c", tmp_path / "ask"
    source.write_text(PROGRAM, encoding="ascii")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{outputs / 'c' / 'include'}"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(program)], check=True)
    replies = [f"A 2 {AMT21.hex(' ')}", "A 2 AA 61", "A 1 AB", f"S 7 {SKM36.hex(' ')}", f"S 8 FF {SKM36.hex(' ')}"]
    completed = subprocess.run([program], input="\n".join(replies), capture_output=True, text=True, check=True)
    assert completed.stdout.splitlines() == [
        "54 1 0 8619",
        "54 1 3 0",
        "54 0 1 0",
        f"404202 1 0 {626 << 12 | 1361}",
        f"404202 1 0 {626 << 12 | 1361}",
    ]
