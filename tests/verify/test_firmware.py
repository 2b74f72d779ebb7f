"""The generated example programs for a microcontroller against virtual encoders: a Cortex-M4 in QEMU, whose serial port
is a socket. Only the functions of the port are replaced, and the program around the example's main loop."""

from __future__ import annotations

import re
import socket
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

from c_harness import devices_of
from codewheel.targets import Library
from codewheel.targets.c.files import generate
from codewheel.virtual.clocked_lines import BissLine
from codewheel.virtual.encoder import VirtualEncoder
from codewheel.virtual.rs485_line import Rs485Line
from codewheel.virtual.serving import ByteLine, listener, serve
from machines import _BARE, Machine
from tools import tool

MACHINE = Machine("mps2", ("arm-none-eabi-gcc", "-mcpu=cortex-m4", "-O2", *_BARE), bare=True)

#: UART 0 of the board ("CMSDK UART", Arm DDI 0479): data, state (1 is full, 2 has a byte), control, and bit rate.
UART = """
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
static volatile uint32_t *const uart = (volatile uint32_t *)0x40004000U;
static void uart_start(void)
{
    uart[4] = 16U;
    uart[2] = 3U;
}
static void uart_put(uint8_t byte)
{
    while ((uart[1] & 1U) != 0U) {
    }
    uart[0] = byte;
}
static bool uart_has(void)
{
    return (uart[1] & 2U) != 0U;
}
static uint8_t uart_get(void)
{
    while (!uart_has()) {
    }
    return (uint8_t)uart[0];
}
"""

#: The clock is slow while the program waits for bytes, because the encoder answers through an emulator and a socket.
RS485_PORT = """
static uint32_t now_us;
static unsigned empty;

static bool serial_send(uint8_t request)
{
    uart_put(request);
    return true;
}

static bool serial_receive(uint8_t *byte)
{
    if (!uart_has()) {
        empty++;
        now_us += (empty % 40000U) == 0U ? 1U : 0U;
        return false;
    }
    *byte = uart_get();
    return true;
}

"""

RS485_MAIN = """
#undef main
static void until(unsigned requests, bool to_the_end)
{
    while ((requests > 0U) || (to_the_end && running)) {
        const bool before = asked;
        loop();
        now_us += asked ? 0U : 10U;
        requests -= ((requests > 0U) && before && !asked) ? 1U : 0U;
    }
}
int main(void)
{
    uart_start();
    until(5002U, false);
    if (start() != CW_OK) {
        return 1;
    }
    until(0U, true);
    return (runner.result == CW_OK) ? 0 : 2;
}
"""

BISS_PORT = """
#include "codewheel/biss.h"
#define BITS 45U
#define CLOCKS (BITS + 6U)
static cw_biss_master master;

/* One frame: all levels of MA, then the timeout with the inverse of CDM. */
static cw_word receive_word(void)
{
    uint64_t word = 0U;
    bool started = false;
    bool acknowledged = false;
    bool cds = false;
    unsigned at;
    unsigned count = 0U;
    for (at = 0U; at < CLOCKS; at++) {
        uart_put('C');
    }
    for (at = 0U; at < CLOCKS; at++) {
        bool bit;
        bit = uart_get() == (uint8_t)'1';
        if (started && (count <= BITS)) {
            cds = (count == 0U) ? bit : cds;
            word = (count == 0U) ? 0U : ((word << 1U) | (bit ? 1U : 0U));
            count++;
        }
        acknowledged = acknowledged || !bit;
        started = started || (acknowledged && bit);
    }
    uart_put(cw_biss_master_next(&master, cds) ? '0' : '1');
    uart_put('T');
    (void)uart_get();
    (void)uart_get();
    return cw_word_of(word, BITS);
}

static int32_t finish(void)
{
    while (master.outcome == CW_BISS_RUNNING) {
        (void)receive_word();
    }
    return (master.outcome == CW_BISS_DONE) ? 0 : -(int32_t)master.outcome;
}

static int32_t read_registers(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    (void)context;
    return (cw_biss_master_read(&master, 0U, (uint8_t)address, bytes, length, 1000U) == CW_OK) ? finish() : -1;
}

static int32_t write_registers(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    (void)context;
    return (cw_biss_master_write(&master, 0U, (uint8_t)address, bytes, length, 1000U) == CW_OK) ? finish() : -1;
}

static void print_registers(const char *title, uint16_t address, size_t length)
{
    uint8_t bytes[16];
    size_t index;
    (void)read_registers(NULL, address, bytes, length);
    printf("%s:", title);
    for (index = 0U; index < length; index++) {
        printf(" %02X", (unsigned)bytes[index]);
    }
    printf("\\n");
}

/* The other end waits. */
static int32_t wait_us(void *context, uint32_t microseconds)
{
    (void)context;
    uart_put('W');
    (void)microseconds;
    return 0;
}

static const cw_transport transport = {
    NULL, read_registers, write_registers, wait_us, NULL, 0U, 0U
};

"""

BISS_MAIN = """
#undef main
int main(void)
{
    unsigned left;
    uart_start();
    for (left = 1000U; left > 0U; left--) {
        if (show_frame() != CW_OK) {
            return 1;
        }
    }
    return example();
}
"""


class FirstReplyCut(Rs485Line):
    """Line that loses the first half of the first reply."""

    cut = 3

    def send(self) -> bytes:
        data = super().send()
        cut, self.cut = (self.cut, 0) if data else (0, self.cut)
        return data[cut:]


class Waiting(BissLine):
    """Line in virtual time: 50 µs a frame, and the longest wait of the encoder for each wait of the program."""

    now = 0.0

    def timeout(self) -> int:
        self.now += 50e-6
        return super().timeout()

    def receive(self, data: bytes) -> None:
        for byte in data:
            self.now += 0.03 if byte == ord("W") else 0.0
            super().receive(bytes([byte]))


@contextmanager
def on_socket(folder: Path, encoder: VirtualEncoder, line: ByteLine) -> Iterator[Path]:
    """Serve a line on a Unix socket."""
    path, stop = folder / "line", Event()
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(path))
        server.listen()
        port = listener(server, str(path))
        thread = Thread(target=serve, args=(encoder, line, port, stop), daemon=True)
        thread.start()
        yield path
        stop.set()
        thread.join()
        port.close()


def program(folder: Path, example: str, port: str, main: str) -> Path:
    """Compile an example for the board, with our port instead of the simulated port."""
    for name, text in generate(Library(devices_of())).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    text = (folder / "c" / "examples" / example).read_text(encoding="utf-8")
    replaced = re.subn(
        r"/\* -- your (?:clock|bus).*?(?=/\* -- your application)", lambda _: port, text, flags=re.DOTALL
    )
    assert replaced[1] == 1
    source = f"{UART}#define main example\n{replaced[0]}{main}"
    compiled = MACHINE.compile_main(source, folder, folder / "c" / "include", "firmware")
    return Path(compiled.command[-1])


def run(firmware: Path, line: Path) -> str:
    command = [tool("qemu-system-arm"), "-M", "mps2-an386", "-nographic", "-monitor", "none"]
    command += ["-semihosting-config", "enable=on,target=native", "-chardev", f"socket,id=line,path={line}"]
    completed = subprocess.run(
        [*command, "-serial", "chardev:line", "-kernel", str(firmware)], capture_output=True, text=True, timeout=300
    )
    assert completed.returncode == 0, (completed.returncode, completed.stdout[-2000:], completed.stderr[-2000:])
    return completed.stdout


def recorded_positions(recorded: list[int], bits: int, limit: int) -> Callable[[float], float]:
    """Return this many positions without a pattern, each recorded as it is sent. Then the shaft is at rest."""

    def position(_: float) -> float:
        if len(recorded) == limit:
            return 77
        recorded.append((7919 * (len(recorded) + 1) ** 2) & ((1 << bits) - 1))
        return recorded[-1]

    return position


def test_an_rs_485_program_reads_positions_and_resets_errors(tmp_path: Path) -> None:
    """5,000 positions in a row, after a first reply that lacks its beginning. Then the ten requests of a reset."""
    firmware = program(tmp_path, "amm5_rs485.c", RS485_PORT, RS485_MAIN)
    recorded: list[int] = []
    encoder = VirtualEncoder("AMM5A23/65KJP1", recorded_positions(recorded, 23, 100_000))
    encoder.set_flag("ps_error")
    with on_socket(tmp_path, encoder, FirstReplyCut(encoder)) as line:
        out = run(firmware, line)
    positions = [int(text) for text in re.findall(r"singleturn: (\d+)", out)]
    failures = re.findall(r"us: (.*reply.*)", out)
    # The emulator itself may lose bytes at the start.
    assert len(failures) in (1, 2)
    assert len(positions) == 5002 - len(failures)
    replies = iter(recorded)
    assert all(position in replies for position in positions), "each position is that of a later reply"
    assert out.rstrip().endswith("us: done")
    assert encoder.flags == set()


def test_a_biss_program_reads_frames_and_sets_a_preset(tmp_path: Path) -> None:
    """1,000 frames, bit by bit, then the whole example: the preset 1,000,003, and three registers."""
    firmware = program(tmp_path, "amm5_biss.c", BISS_PORT, BISS_MAIN)
    recorded: list[int] = []
    registers = {"serial_number": bytes.fromhex("0AE869EE")}
    encoder = VirtualEncoder("AMM5A21/65KSC1", recorded_positions(recorded, 37, 1000), registers=registers)
    line = Waiting(encoder)
    encoder.clock = lambda: line.now
    with on_socket(tmp_path, encoder, line) as path:
        out = run(firmware, path)
    positions = [int(text) for text in re.findall(r"  position: (\d+)", out)]
    assert positions[:1000] == recorded[:1000]
    # The frame of the example, and the preset that it reads back.
    assert positions[1000:] == [77, 1_000_003]
    assert encoder.position_now() == 1_000_003
    assert "Preset 11h: 00 30 24 F4 00 00 00\n" in out
    assert "  serial: 183003630\n" in out
    assert "  name: Li\n" in out
    assert encoder.memory.too_early == 0
