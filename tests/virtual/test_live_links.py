"""Links to virtual encoders over real pseudo-terminals and TCP, and the command ``simulate``."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from types import ModuleType
from typing import Any

import pytest
from bench import codes_with
from codewheel.commands.cli import main
from codewheel.commands.simulate import EXAMPLES
from codewheel.targets import Library
from codewheel.virtual import serving
from codewheel.virtual.simulation_options import FAULTS
from exhaustive import mostly_exhaustive

pytestmark = pytest.mark.slow

Package = tuple[Path, ModuleType]
CODE = "AMM5A23/65KJP1"


@contextmanager
def simulated(*arguments: str) -> Iterator[str]:
    """Run the command as a user does, with its output in a pipe, and yield the line that it prints."""
    command = [sys.executable, "-m", "codewheel", "simulate", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip()
        finally:
            process.terminate()


def test_the_first_commands_of_a_user(generated_python: Package) -> None:
    lika: Any = generated_python[1]
    with simulated(CODE, "--position", "1000003") as port, lika.open_encoder(port, CODE) as encoder:
        assert encoder.position() == 1_000_003
        assert encoder.read().usable_position == 1_000_003
        assert encoder.exchange(lika.amm5.DataId.ENCODER_ID).encoder_id == 0x23
        encoder.run(lika.amm5.reset_singleturn_and_multiturn())
        assert encoder.position() == 0
        # The line of the runtime's own ``run`` too.
        lika.run(lika.amm5.reset_errors(), encoder)


def test_the_live_example_of_the_package(generated_python: Package, capsys: pytest.CaptureFixture[str]) -> None:
    folder, lika = generated_python[0], generated_python[1]
    blocks = re.findall(r"```python\n(.*?)```", (folder / "live-line.md").read_text(encoding="utf-8"), re.DOTALL)
    short, block = (block for block in blocks if "open_encoder(" in block)
    assert f'lookup("{CODE}")' in block
    turned = 3 * lika.lookup(CODE).counts_per_turn + 1_000_003
    with simulated(CODE, "--position", str(turned)) as port:
        for code in (short, block.replace("range(100)", "range(3)")):
            exec(re.sub(r'open_encoder\("[^"]+"', f'open_encoder("{port}"', code), {})
        assert capsys.readouterr().out == f"{turned}\n" * 4
        with lika.open_encoder(port, CODE) as link:
            assert link.position() == 1_000_003, "the revolutions are reset"


def test_over_tcp_and_for_asyncio(generated_python: Package) -> None:
    lika: Any = generated_python[1]
    from codewheel_runtime.link_async import AsyncLink, StreamTransport, open_async

    async def both(port: str) -> list[int]:
        host, number = port.removeprefix("socket://").split(":")
        reader, writer = await asyncio.open_connection(host, int(number))
        async with AsyncLink(lika.lookup(CODE), StreamTransport(reader, writer)) as encoder:
            positions = await asyncio.gather(*(encoder.position() for _ in range(3)))
            await encoder.run(lika.amm5.reset_singleturn_and_multiturn())
        async with open_async(port, lika.lookup(CODE)) as encoder:
            return [*positions, await encoder.position(), (await encoder.read()).usable_position]

    with simulated(CODE, "--position", "1000003", "--tcp") as port:
        assert port.startswith("socket://127.0.0.1:")
        with lika.open_encoder(port, CODE) as encoder:
            assert encoder.position() == 1_000_003
        assert asyncio.run(both(port)) == [1_000_003] * 3 + [0, 0]


def test_levels_of_biss_over_tcp() -> None:
    import socket

    with simulated("AMM5A21/65KSC1", "--position", "1000003", "--tcp") as port:
        host, number = port.removeprefix("socket://").split(":")
        with socket.create_connection((host, int(number))) as line:
            line.sendall(b"01" * 52 + b"T")
            answer = b""
            while len(answer) < 105:
                answer += line.recv(4096)
    assert answer[1:104:2] == b"1" + b"000" + b"1" + b"0" + f"{1_000_003:037b}11".encode() + b"010011" + b"0"


@pytest.mark.parametrize("line", EXAMPLES)
def test_the_examples_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my_encoder"]) == 0
    with simulated(*shlex.split(line)[2:]) as port:
        assert port


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([CODE, "--position", "x"], "codewheel: 'x' is not a position; write 1000003, sine:0.5Hz, sine:0.5Hz:90deg"),
        ([CODE, "--position=-1"], f"codewheel: position -1 is out of range; {CODE} has 0 to 549755813887"),
        ([CODE, "--fault", "x"], "codewheel: 'x' is not a fault; write a name and a rate from 0 to 1"),
        ([CODE, "--flag", "x"], f"codewheel: {CODE} has no flag 'x'; it has: "),
        ([CODE, "--register", "0x12=1"], f"codewheel: {CODE} has no register at 0x12"),
        ([CODE, "--choose", "x=y"], f"codewheel: 'x=y' answers no question of {CODE}; write adf_layout="),
        (["AMM5A22/65KJP1"], "codewheel: 'AMM5A22/65KJP1' has singleturn '22'"),
        ([CODE, "--tcp", "70000"], "codewheel: cannot open a port: "),
    ],
)
def test_wrong_usage_is_one_line(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert main(["simulate", *arguments]) == (1 if "--tcp" in arguments else 2)
    captured = capsys.readouterr()
    assert captured.err.startswith(message)
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_errors_of_ports(generated_python: Package, tmp_path: Path) -> None:
    lika: Any = generated_python[1]
    from codewheel_runtime.link import PortError

    with pytest.raises(PortError, match=r"cannot open .*nothing: No such file or directory; ports here: "):
        lika.open_encoder(str(tmp_path / "nothing"), CODE)
    with pytest.raises(PortError, match=r"cannot open loop://\?x=y: pyserial does not know an option after the \?"):
        lika.open_encoder("loop://?x=y", CODE)
    with pytest.raises(lika.InterfaceError, match="but this needs RS-485, because a serial port cannot send its clock"):
        lika.open_encoder("any", "AMM5A21/65KSC1")
    with pytest.raises(lika.OrderCodeError):
        lika.open_encoder("any", "AMM5A22/65KJP1")


def test_a_port_that_goes_away(generated_python: Package) -> None:
    lika: Any = generated_python[1]
    from codewheel_runtime.link import LinkError

    with simulated(CODE) as port:
        encoder = lika.open_encoder(port, CODE)
        assert encoder.position() == 0
    with encoder, pytest.raises(LinkError, match=rf"^(the line to {CODE} failed|no reply)"):
        encoder.position()


def test_another_kind_of_encoder(generated_python: Package, virtual_encoder: Callable[..., Any]) -> None:
    """A position with more bits than the order code has."""
    lika: Any = generated_python[1]
    from codewheel_runtime.link import WrongEncoderError

    served = virtual_encoder(CODE, position=(1 << 23) - 1)
    with lika.open_encoder(served.port, "AMM5A17/65KJP1", timeout_s=0.2) as encoder:
        with pytest.raises(WrongEncoderError, match=r"is from another kind of encoder: .*; check the order code"):
            encoder.position()
        encoder.session.requests.encoder = lika.lookup(CODE)
        assert encoder.position() == (1 << 23) - 1


def test_the_fixture_of_the_page(generated_python: Package, virtual_encoder: Callable[..., Any]) -> None:
    lika: Any = generated_python[1]

    def my_program(port: str) -> int:
        with lika.open_encoder(port, CODE, timeout_s=1) as encoder:
            first = encoder.position()
            time.sleep(0.02)
            return 0 if first < encoder.position() else 1

    page = (Path(__file__).parents[2] / "docs/bench/command-line.md").read_text(encoding="utf-8")
    block = next(text for text in page.split("```") if text.startswith("python\ndef test_my_program"))
    names: dict[str, Any] = {"my_program": my_program}
    exec(block.removeprefix("python\n"), names)
    names["test_my_program"](virtual_encoder)


@pytest.mark.parametrize("first_code", mostly_exhaustive(range(4), 0))
def test_200_requests_for_each_order_code(
    generated_python: Package, virtual_encoder: Callable[..., Any], library: Library, first_code: int
) -> None:
    lika: Any = generated_python[1]
    for code in codes_with(library.devices, "rs485")[first_code::4]:
        position = [0]
        served = virtual_encoder(code, position=lambda now, position=position: position[0])
        with lika.open_encoder(served.port, code, timeout_s=1) as encoder:
            for value in range(0, served.encoder.counts, served.encoder.counts // 199):
                position[0] = value
                assert encoder.position() == value


def _times_of_requests(encoder: Any) -> list[float]:
    """Return a list whose item is the time of the last request for the position."""
    last_request, write = [0.0], encoder.transport.write

    def timed(data: bytes) -> None:
        if data == b"\x1a":
            last_request[0] = time.monotonic()
        write(data)

    encoder.transport.write = timed
    return last_request


@pytest.mark.one_in(12, "exhaustive")
@pytest.mark.parametrize("fault", FAULTS)
def test_1000_requests_with_each_fault(
    generated_python: Package, virtual_encoder: Callable[..., Any], fault: str
) -> None:
    """One reply in fifty has the fault. The shaft turns, so a position from before the request would be too old."""
    lika: Any = generated_python[1]
    started = time.monotonic()
    served = virtual_encoder(CODE, lambda now: now * 1e6, faults=[f"{fault}:0.02"], clock=time.monotonic)
    errors = 0
    # On a busy machine, an encoder that is a program can need more than the default.
    settle_s = 0.01 if fault in ("repeated", "second") else None
    with lika.open_encoder(served.port, CODE, timeout_s=0.03, settle_s=settle_s) as encoder:
        last_request = _times_of_requests(encoder)
        for _ in range(1000):
            try:
                value = encoder.position()
            except lika.LinkError:
                errors += 1
                continue
            age = (value - int(last_request[0] * 1e6)) % served.encoder.counts
            assert age <= (time.monotonic() - last_request[0]) * 1e6
    assert served.encoder.faults.injected[fault] > 5
    # On a busy machine a reply can be late without a fault. The link may give up, but return no wrong position.
    assert errors < 20 or fault in ("busy", "restart", "brownout", "late", "low", "high", "second")
    assert time.monotonic() - started < 120


def test_copies_over_a_terminal(generated_python: Package, virtual_encoder: Callable[..., Any]) -> None:
    """The default, without a pause: prints how many positions are older than their request, which should be none.

    A process that does not run when a reply arrives delays it. So the number is printed, and has only a generous limit.
    """
    lika: Any = generated_python[1]
    served = virtual_encoder(CODE, lambda now: now * 1e6, faults=["repeated:0.02"], clock=time.monotonic)
    stale = 0
    with lika.open_encoder(served.port, CODE) as encoder:
        last_request = _times_of_requests(encoder)
        for _ in range(2000):
            value = encoder.position()
            age = (value - int(last_request[0] * 1e6)) % served.encoder.counts
            stale += age > (time.monotonic() - last_request[0]) * 1e6
        copies, extra = served.encoder.faults.injected["repeated"], encoder.statistics.extra_replies
        print(f"{stale} of 2000 positions are older than their request, after {copies} copies, {extra} of them counted")
    assert copies > 10
    assert extra >= copies - 1
    assert stale <= copies


def test_threads_share_a_link(generated_python: Package, virtual_encoder: Callable[..., Any]) -> None:
    """Three threads: no request fails, and each gets the reply to its own request."""
    lika: Any = generated_python[1]
    served = virtual_encoder(CODE, position=1_000_003)
    ids, failures = [lika.amm5.DataId.ENCODER_ID, lika.amm5.DataId.SINGLETURN, lika.amm5.DataId.ALL_DATA], list[str]()

    with lika.open_encoder(served.port, CODE, timeout_s=1, retries=0) as encoder:

        def ask(data_id: Any) -> None:
            for _ in range(100):
                try:
                    assert encoder.exchange(data_id).data_id == data_id
                except (lika.LinkError, AssertionError) as error:
                    failures.append(f"{type(error).__name__}: {error}")

        threads = [Thread(target=ask, args=(data_id,)) for data_id in ids]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not failures
        assert encoder.statistics.requests == encoder.statistics.replies == 300


def test_a_procedure_is_not_interrupted_by_another_thread(
    generated_python: Package, virtual_encoder: Callable[..., Any]
) -> None:
    """A reset needs ten requests in a row, also with ``run`` of the runtime."""
    lika: Any = generated_python[1]
    served = virtual_encoder(CODE, position=1_000_003)
    with lika.open_encoder(served.port, CODE, timeout_s=1) as encoder:
        stop = Event()

        def poll() -> None:
            while not stop.is_set():
                encoder.read()

        thread = Thread(target=poll)
        thread.start()
        try:
            lika.run(lika.amm5.reset_singleturn_and_multiturn(), encoder)
        finally:
            stop.set()
            thread.join()
        assert encoder.position() == 0


@pytest.mark.skipif(not serving.has_terminals(), reason="a TCP port accepts one client after another")
def test_a_port_is_opened_once(generated_python: Package, virtual_encoder: Callable[..., Any]) -> None:
    lika: Any = generated_python[1]
    served = virtual_encoder(CODE, position=7)
    with lika.open_encoder(served.port, CODE) as encoder:
        with pytest.raises(
            lika.PortError, match=r"^cannot open .*: another program, or another link of this program, "
        ):
            lika.open_encoder(served.port, CODE)
        assert encoder.position() == 7
    with lika.open_encoder(served.port, CODE) as encoder:
        assert encoder.position() == 7


def test_the_asyncio_example_of_the_package(generated_python: Package, capsys: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (generated_python[0] / "live-line.md").read_text("utf-8"), re.DOTALL)
    (block,) = (block for block in blocks if "open_async(" in block)
    with simulated(CODE, "--position", "1000003") as port:
        exec(re.sub(r'open_async\("[^"]+"', f'open_async("{port}"', block), {})
    assert capsys.readouterr().out == "1000003\n"


def test_a_cancelled_read_ends_before_its_task(generated_python: Package) -> None:
    """Otherwise its thread would take bytes of the reply to the next request."""
    from codewheel_runtime.link_async import ThreadTransport

    class SlowLine:
        is_reading = False

        def write(self, data: bytes) -> None:
            raise AssertionError

        def read(self, timeout_s: float) -> bytes:
            self.is_reading = True
            time.sleep(timeout_s)
            self.is_reading = False
            return b""

    async def cancel_read(line: SlowLine) -> None:
        task = asyncio.create_task(ThreadTransport(line).read(0.1))
        while not line.is_reading:
            await asyncio.sleep(0)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert not line.is_reading

    asyncio.run(cancel_read(SlowLine()))


def test_all_errors_of_links_are_at_the_top(generated_python: Package) -> None:
    lika: Any = generated_python[1]
    from codewheel_runtime import link_errors

    for name in link_errors.__all__:
        assert getattr(lika, name) is getattr(link_errors, name)
        assert name in lika.__all__


def monitored(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run ``monitor`` as a user does, with its output in a pipe."""
    command = [sys.executable, "-m", "lika_encoders", "monitor", *arguments]
    path = os.pathsep.join([str(folder), str(folder / "runtime")])
    return subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=60, env={**os.environ, "PYTHONPATH": path}
    )


def test_monitor_records_and_fails(
    generated_python: Package, virtual_encoder: Callable[..., Any], tmp_path: Path
) -> None:
    """In a pipe it writes a table. With too many errors, it exits with 1, but the file is complete."""
    folder, served = generated_python[0], virtual_encoder(CODE, position=1_000_003)
    piped = monitored(folder, CODE, served.port, "--count", "3")
    assert piped.returncode == 0
    header, *rows = piped.stdout.splitlines()
    assert header == "time,position,verdict,reports,error"
    assert [row.split(",")[1:] for row in rows] == [["1000003", "usable", "", ""]] * 3
    assert piped.stderr == "0 of 3 readings failed\n"

    served = virtual_encoder(CODE, position=5, faults=["lost:0.5"], seed=3)
    log = str(tmp_path / "log.jsonl")
    lossy = monitored(folder, CODE, served.port, "--count", "20", "-o", log)
    assert lossy.returncode == 1
    assert re.fullmatch(r"lika-encoders: \d+ of 20 readings failed; --max-errors is 10\n", lossy.stderr)
    lines = Path(log).read_text(encoding="utf-8").splitlines()
    assert len(lines) == 20
    assert {json.loads(line)["error"] for line in lines} == {"", "no reply"}
    allowed = monitored(folder, CODE, served.port, "--count", "20", "-o", log, "--max-errors", "100", "--force")
    assert allowed.returncode == 0

    silent = monitored(folder, CODE, virtual_encoder(CODE, faults=["lost"]).port, "--count", "2")
    assert silent.returncode == 1
    assert silent.stdout.count("no reply") == 2
