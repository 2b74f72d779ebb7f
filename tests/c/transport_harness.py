"""An encoder in Python, reached by the generated C through its own transport.

A library is compiled over a header: one function with plain arguments for each that takes a transport.
The encoder is 128 bytes of registers that keeps a record of every access, and that can fail at any of them.

The record has a line for each call: ``r 44 4`` reads four bytes from 44h up, ``w 77 01`` writes,
``wait 30000`` waits, ``send C2`` sends.
"""

from __future__ import annotations

import ctypes
import functools
import operator
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from c_harness import WARNINGS, write
from codewheel.model import Device
from codewheel.targets.c.device import DeviceView, views_of
from codewheel.targets.c.names import c_name
from codewheel.targets.c.procedures import ProcedureCode
from codewheel.targets.c.registers import RegisterFunctions
from working_tools import require

OK, LENGTH, CRC, CONSTANT, RANGE, TRANSPORT, TIMEOUT, UNSUPPORTED = range(8)
VERIFY = 14
WRITE, WAIT, SEND, READ, POLL, CLOSE, VERIFY_STEP, MORE = range(1, 9)

_READ = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint16, ctypes.POINTER(ctypes.c_uint8), ctypes.c_size_t
)
_WRITE = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint16, ctypes.POINTER(ctypes.c_uint8), ctypes.c_size_t
)
_WAIT = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint32)
_SEND = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint8, ctypes.POINTER(ctypes.c_uint8), ctypes.c_size_t
)
CALLBACKS = {"read_registers": _READ, "write_registers": _WRITE, "wait_us": _WAIT, "send_request": _SEND}


class Transport(ctypes.Structure):
    _fields_ = [
        ("context", ctypes.c_void_p),
        *CALLBACKS.items(),
        ("poll_at_most", ctypes.c_uint32),
        ("poll_pause_us", ctypes.c_uint32),
    ]


class Failure(ctypes.Structure):
    _fields_ = [
        ("step", ctypes.c_size_t),
        ("kind", ctypes.c_int),
        ("call", ctypes.c_int),
        ("address", ctypes.c_uint16),
        ("error", ctypes.c_int32),
        ("left_open", ctypes.c_bool),
    ]

    def as_tuple(self) -> tuple[int, int, int, int, int]:
        return self.step, self.kind, self.call, self.address, self.error


#: Content of a failure before a call, to see whether it was changed.
UNTOUCHED = (99, 0, 0, 0xFFFF, -99)


def xor_of(data: bytes) -> int:
    return functools.reduce(operator.xor, data, 0)


@dataclass
class Encoder:
    """The encoder at the other end of the transport."""

    memory: bytearray = field(default_factory=lambda: bytearray(range(128)))
    record: list[str] = field(default_factory=list)
    fail_at: int = -1
    error: int = 0
    missing: frozenset[str] = frozenset()
    polls: tuple[int, int] = (0, 0)
    #: The error in a reply: the number of the reply, the number of the byte, and the bits.
    spoilt: dict[tuple[int, int], int] = field(default_factory=dict)
    requests_sent: int = 0
    #: True if every call fails from ``fail_at`` on, and false if only that one fails.
    fail_on: bool = False
    #: Bits of a write that arrive wrong, by the index of the access.
    disturbed: dict[int, int] = field(default_factory=dict)
    #: Called with the address before each read. It may change the memory.
    before_read: Callable[[int], None] = lambda address: None

    def transport(self) -> Transport:
        callbacks = {name: kind(getattr(self, name)) for name, kind in CALLBACKS.items() if name not in self.missing}
        self._kept = callbacks
        return Transport(context=0x1234, poll_at_most=self.polls[0], poll_pause_us=self.polls[1], **callbacks)

    def _noted(self, context: int | None, text: str) -> int:
        assert context == 0x1234
        self.record.append(text)
        at = len(self.record) - 1
        return self.error if at == self.fail_at or (self.fail_on and 0 <= self.fail_at <= at) else 0

    def read_registers(self, context: int | None, address: int, data: Any, length: int) -> int:
        self.before_read(address)
        for index in range(length):
            data[index] = self.memory[address + index]
        return self._noted(context, f"r {address:02X} {length}")

    def write_registers(self, context: int | None, address: int, data: Any, length: int) -> int:
        received = bytes(data[:length])
        flipped_bits = self.disturbed.get(len(self.record), 0)
        self.memory[address : address + length] = bytes(byte ^ flipped_bits for byte in received)
        return self._noted(context, f"w {address:02X} {received.hex(' ').upper()}")

    def wait_us(self, context: int | None, microseconds: int) -> int:
        return self._noted(context, f"wait {microseconds}")

    def send_request(self, context: int | None, request: int, reply: ctypes.Array[ctypes.c_uint8], length: int) -> int:
        """Return the reply: the request, and at the end the exclusive-or of the others, apart from planted errors."""
        reply_bytes = bytes([request, *range(1, length - 1)]) if length else b""
        reply_bytes += bytes([xor_of(reply_bytes)]) if length else b""
        for index, byte in enumerate(reply_bytes):
            reply[index] = byte ^ self.spoilt.get((self.requests_sent, index), 0)
        self.requests_sent += 1
        return self._noted(context, f"send {request:02X}")


@dataclass(frozen=True)
class Answer:
    """Outcome of a call: its result, the bytes read, the failure, and the accesses that the encoder saw."""

    result: int
    data: bytes
    failure: tuple[int, int, int, int, int]
    record: list[str]
    left_open: bool = False


@dataclass(frozen=True)
class Machine:
    """The compiled functions of a family."""

    device: Device
    libraries: Sequence[ctypes.CDLL]
    #: True if procedures use the runner, which leaves waiting to its caller, so that a wait cannot fail.
    stepped: bool = False

    def run(self, procedure: str, code: str, arguments: Sequence[int] = (), encoder: Encoder | None = None) -> Answer:
        values = (ctypes.c_uint64 * max(1, len(arguments)))(*arguments)
        return self._call(f"run_{procedure}", encoder or Encoder(), code.encode(), values)

    def read(self, register: str, code: str, encoder: Encoder) -> Answer:
        """The bytes are the encoded struct."""
        return self._call(f"read_{register}", encoder, code.encode())

    def write(self, register: str, code: str, data: bytes, encoder: Encoder) -> Answer:
        """The struct is decoded from the bytes."""
        return self._call(f"write_{register}", encoder, code.encode(), data)

    def identity(self, encoder: Encoder) -> Answer:
        return self._call("identity", encoder)

    def state(self, code: str, encoder: Encoder) -> Answer:
        """The bytes are the members of the variant, eight for each, low byte first."""
        return self._call("state", encoder, code.encode())

    def steps(self, steps: Sequence[tuple[int, int, int, int, int, int]], reads: int, encoder: Encoder) -> Answer:
        """Carry out a list of (kind, address, mask, value, times, microseconds)."""
        flat = [number for step in steps for number in step]
        return self._call(
            "steps", encoder, (ctypes.c_uint32 * len(flat))(*flat), ctypes.c_size_t(len(steps)), ctypes.c_size_t(reads)
        )

    def run_without_failure(self, procedure: str, code: str, encoder: Encoder) -> int:
        transport = encoder.transport()
        return int(
            self._function(f"run_{procedure}")(
                ctypes.byref(transport), code.encode(), None, (ctypes.c_uint8 * 64)(), None
            )
        )

    def has(self, name: str) -> bool:
        """Return True if any interface has the function."""
        return any(hasattr(library, name) for library in self.libraries)

    def _function(self, name: str) -> Any:
        """Return the function from the library of the interface that has it."""
        return next(getattr(library, name) for library in self.libraries if hasattr(library, name))

    def _call(self, name: str, encoder: Encoder, *arguments: object) -> Answer:
        transport, failure = encoder.transport(), Failure(*UNTOUCHED)
        data = (ctypes.c_uint8 * 65)(*[0xAA] * 65)
        result = self._function(name)(ctypes.byref(transport), *arguments, data, ctypes.byref(failure))
        # The first byte is the number of bytes that were filled.
        filled = bytes(data[1 : 1 + data[0]]) if data[0] != 0xAA else b""
        return Answer(
            result=result,
            data=filled,
            failure=failure.as_tuple(),
            record=encoder.record,
            left_open=failure.left_open,
        )


def compile_machine(device: Device, folder: Path, stepped: bool = False) -> None:
    """Compile the functions of a family for :class:`Machine`, with checks for undefined behaviour.

    If ``stepped``, a main loop around the runner carries out the procedures.
    """
    include = write(folder, (device,))
    command = [
        "gcc",
        "-std=c99",
        "-O1",
        "-shared",
        "-fPIC",
        "-fsanitize=undefined",
        "-fno-sanitize-recover=all",
        *WARNINGS,
    ]
    require(command)
    for view in views_of(device):
        text, library = folder / f"{view.stem}.c", folder / f"{view.stem}.so"
        text.write_text((_LOOP if stepped else "") + source(view), encoding="utf-8")
        completed = subprocess.run(
            [*command, f"-I{include}", str(text), "-o", str(library)], capture_output=True, text=True
        )
        assert completed.returncode == 0, completed.stderr[:4000]


def machine_of(device: Device, folder: Path, stepped: bool) -> Machine:
    """Return the functions compiled into this folder."""
    return Machine(device, [ctypes.CDLL(str(path)) for path in sorted(folder.glob("*.so"))], stepped)


def source(view: DeviceView) -> str:
    """Return a function with plain arguments for each function of the headers that takes a transport."""
    text = _HEAD
    text += "".join(map(_run, view.procedures))
    text += "".join(_register(register.access) for register in view.registers)
    text += "".join(_identity(identity.prefix) for identity in view.identities)
    text += _state(view) if view.read_state else ""
    headers = "".join(f'#include "{header}"\n' for header in view.headers)
    return text.replace("@headers@", headers).replace("@prefix@", view.prefix)


def _run(procedure: ProcedureCode) -> str:
    name = procedure.procedure_plan.procedure.name
    types = [argument.type for argument in procedure.arguments]
    argument_list = "".join(f", ({type_})arguments[{index}]" for index, type_ in enumerate(types))
    out = ", &out" if procedure.read_type else ""
    return f"""
int run_{name}(const cw_transport *transport, const char *code, const uint64_t *arguments, uint8_t *data,
    cw_failure *failure);
int run_{name}(const cw_transport *transport, const char *code, const uint64_t *arguments, uint8_t *data,
    cw_failure *failure)
{{
    {f"{procedure.read_type} out;" if out else ""}
    const cw_result result = {procedure.function_name}(transport, variant_of(code){argument_list}{out}, failure);
    (void)arguments;
    {"fill(data, result, &out, sizeof out);" if out else "(void)data;"}
    return (int)result;
}}
"""


def _identity(prefix: str) -> str:
    return f"""
int identity(const cw_transport *transport, uint8_t *data, cw_failure *failure);
int identity(const cw_transport *transport, uint8_t *data, cw_failure *failure)
{{
    {prefix}_identity out;
    const cw_result result = {prefix}_read_identity(transport, &out, failure);
    fill(data, result, &out, sizeof out);
    return (int)result;
}}
"""


def _state(view: DeviceView) -> str:
    names = [c_name(parameter.name) for parameter in view.device.set_parameters]
    members = "".join(f"    put(&data[1 + 8 * {index}], copy.{name});\n" for index, name in enumerate(names))
    return f"""
int state(const cw_transport *transport, const char *code, uint8_t *data, cw_failure *failure);
int state(const cw_transport *transport, const char *code, uint8_t *data, cw_failure *failure)
{{
    {view.prefix} copy = variant_of(code);
    const cw_result result = {view.read_state}(transport, &copy, failure);
    data[0] = 8U * {len(names)}U;
{members}    return (int)result;
}}
"""


def _register(access: RegisterFunctions) -> str:
    return (_read(access) if access.read_function else "") + (_write(access) if access.write_function else "")


def _read(access: RegisterFunctions) -> str:
    name = access.read_function.partition("_read_")[2]
    declaration = f"{access.type} out;" if access.struct else f"{access.type} out = ({access.type})0xAA;"
    encoding = (
        f"{access.struct}_encode(variant_of(code), &out, &data[1], {access.stem}_LENGTH)"
        if access.struct
        else "(data[1] = (uint8_t)out, CW_OK)"
    )
    return f"""
int read_{name}(const cw_transport *transport, const char *code, uint8_t *data, cw_failure *failure);
int read_{name}(const cw_transport *transport, const char *code, uint8_t *data, cw_failure *failure)
{{
    {declaration}
    const cw_result result = {access.read_function}(transport, variant_of(code), &out, failure);
    if (result == CW_OK && {encoding} == CW_OK) {{
        data[0] = {access.stem}_LENGTH;
    }}
    return (int)result;
}}
"""


def _write(access: RegisterFunctions) -> str:
    name = access.write_function.partition("_write_")[2]
    declaration = f"{access.type} in;" if access.struct else f"const {access.type} in = ({access.type})bytes[0];"
    decoding = (
        f"{access.struct}_decode(variant_of(code), bytes, {access.stem}_LENGTH, &in)" if access.struct else "CW_OK"
    )
    return f"""
int write_{name}(const cw_transport *transport, const char *code, const uint8_t *bytes, uint8_t *data,
    cw_failure *failure);
int write_{name}(const cw_transport *transport, const char *code, const uint8_t *bytes, uint8_t *data,
    cw_failure *failure)
{{
    {declaration}
    (void)data;
    return {decoding} != CW_OK
        ? -1
        : (int){access.write_function}(transport, variant_of(code), {"&in" if access.struct else "in"}, failure);
}}
"""


#: A main loop instead of the function that waits. It is sometimes early, and starts nothing twice.
_LOOP = r"""
#include "codewheel/runner.h"
#include <stdlib.h>

enum { MISSING = -77777 };

static int32_t started(const cw_transport *transport, cw_runner *runner, cw_todo todo)
{
    switch (todo) {
    case CW_TODO_READ:
        return transport->read_registers == NULL ? MISSING
            : transport->read_registers(transport->context, runner->address, runner->data, runner->length);
    case CW_TODO_WRITE:
        return transport->write_registers == NULL ? MISSING
            : transport->write_registers(transport->context, runner->address,
                runner->length == 1U ? &runner->byte : runner->data, runner->length);
    case CW_TODO_SEND:
        return transport->send_request == NULL ? MISSING
            : transport->send_request(transport->context, runner->byte, runner->data, runner->length);
    default:
        abort();
    }
}

static inline cw_result in_a_loop(
    const cw_transport *transport, const cw_step *steps, size_t count, uint8_t *bytes, size_t length,
    cw_failure *failure)
{
    cw_runner runner;
    /* The time starts again soon. */
    uint32_t now = 0xFFFFF000U;
    cw_todo todo;
    cw_result result = cw_runner_start(&runner, steps, count, bytes, length, now);
    if (result != CW_OK) {
        return cw_runner_next(&runner, now) == CW_TODO_END ? result : CW_OK;
    }
    runner.poll_at_most = transport->poll_at_most;
    runner.poll_pause_us = transport->poll_pause_us;
    for (todo = cw_runner_next(&runner, now); todo != CW_TODO_END; todo = cw_runner_next(&runner, now)) {
        if (todo != CW_TODO_WAIT) {
            const int32_t error = started(transport, &runner, todo);
            if (cw_runner_next(&runner, now + 3U) != CW_TODO_BUSY || cw_runner_close(&runner, now)) {
                abort();
            }
            cw_runner_done(&runner, error, now);
            continue;
        }
        cw_runner_done(&runner, -5, now);
        if (transport->wait_us != NULL) {
            (void)transport->wait_us(transport->context, runner.wait_us);
        }
        now += runner.wait_us - 1U;
        if (cw_runner_next(&runner, now) != CW_TODO_WAIT || runner.wait_us != 1U) {
            abort();
        }
        now++;
    }
    if (cw_runner_next(&runner, now) != CW_TODO_END || runner.bus_reserved) {
        abort();
    }
    {
        /* Something is left to do exactly where something is open; the tests look at the encoder before that. */
        cw_runner again = runner;
        if (cw_runner_close(&again, now) != runner.failure.left_open
            || (cw_runner_next(&again, now) != CW_TODO_END) != runner.failure.left_open) {
            abort();
        }
    }
    if (runner.result != CW_OK && failure != NULL) {
        *failure = runner.failure;
    }
    if (runner.result == CW_FAULT_TRANSPORT && runner.failure.error == MISSING) {
        if (failure != NULL) {
            failure->error = 0;
        }
        return CW_FAULT_UNSUPPORTED;
    }
    return runner.result;
}
#define cw_run in_a_loop
"""

_HEAD = r"""
@headers@#include "codewheel/transport.h"
#include <stdlib.h>
#include <string.h>

static inline @prefix@ variant_of(const char *code)
{
    uint32_t unlisted;
    const @prefix@_order_code *const found = @prefix@_find_order_code(code, &unlisted);
    if (found == NULL) {
        abort();
    }
    return found->variant;
}

static inline void fill(uint8_t *data, cw_result result, const void *bytes, size_t length)
{
    if (result == CW_OK) {
        data[0] = (uint8_t)length;
        memcpy(&data[1], bytes, length);
    }
}

static inline void put(uint8_t *data, uint64_t number)
{
    size_t index;
    for (index = 0U; index < 8U; index++) {
        data[index] = (uint8_t)(number >> (8U * index));
    }
}

int steps(const cw_transport *transport, const uint32_t *numbers, size_t count, size_t reads, uint8_t *data,
    cw_failure *failure);
int steps(const cw_transport *transport, const uint32_t *numbers, size_t count, size_t reads, uint8_t *data,
    cw_failure *failure)
{
    cw_step list[32];
    size_t index;
    cw_result result;
    for (index = 0U; index < count; index++) {
        const uint32_t *const n = &numbers[6U * index];
        memcpy(&list[index].kind, &n[0], sizeof n[0]);
        list[index].address = (uint16_t)n[1];
        list[index].mask = (uint8_t)n[2];
        list[index].value = (uint8_t)n[3];
        list[index].times = (uint16_t)n[4];
        list[index].microseconds = n[5];
    }
    result = cw_run(transport, list, count, reads == 0U ? NULL : &data[1], reads, failure);
    data[0] = (uint8_t)reads;
    return (int)result;
}
"""
