"""Proofs of every other function, called with arbitrary arguments.

It has no undefined behaviour, and it keeps what the headers guarantee for all functions. On an error, its results are
unchanged, and an error of the transport is returned. The harness of a function is built from its signature, so a new
function is proved as soon as it is in a header.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from c_harness import SHARED
from codewheel.model import Device
from codewheel.targets.c.device import DeviceView
from proof import PARTLY, PRELUDE, UNDEFINED, Function, Header, Proof, Variants

TRANSPORT, UNSUPPORTED = 5, 7
#: Bounds of arguments: bytes of a buffer, steps of a procedure, characters of a label, repetitions of a step.
BYTES, STEPS, LABEL, TIMES = 16, 2, 12, 2
#: Length of the longest reply for which there is space.
REPLY = 16
#: Limit of a position in either direction.
#: In steps of one byte, it fits into 64 bits, as the headers require.
POSITION = "(1LL << 55)"
#: Maximum rounds of a loop, plus one: over order codes, over arbitrary steps, every other loop, and a loop with
#: arbitrary rounds.
CODES_ROUNDS, STEPS_ROUNDS, ROUNDS, ANY_ROUNDS = 70, 4, 32, 3

#: A transport in which every function may be missing or fail at any call, with any number except 0.
#: After a failure, registers are read and written only to close open registers, with a separate result.
_TRANSPORT = """\
static int32_t failed_with;
static int32_t fails(void)
{
    int32_t error;
    if (failed_with == 0) failed_with = error;
    return error;
}
static int32_t fails_first(void)
{
    __CPROVER_assert(failed_with == 0, "nothing is sent and nothing waited for after a failure");
    return fails();
}
static int32_t on_read(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    __CPROVER_assert(__CPROVER_w_ok(bytes, length), "the bytes to read into are there");
    for (size_t at = 0; at < length; at++) bytes[at] = nondet_byte();
    return fails();
}
static int32_t on_write(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    __CPROVER_assert(__CPROVER_r_ok(bytes, length), "the bytes to write are there");
    return fails();
}
static int32_t on_wait(void *context, uint32_t microseconds) { return fails_first(); }
static int32_t on_send(void *context, uint8_t request, uint8_t *reply, size_t length)
{
    __CPROVER_assert(__CPROVER_w_ok(reply, length), "the bytes to receive into are there");
    if (length > 0) __CPROVER_havoc_slice(reply, length);
    return fails_first();
}
static cw_transport any_transport(void)
{
    cw_transport found;
    found.context = 0;
    found.read_registers = nondet_bool() ? on_read : 0;
    found.write_registers = nondet_bool() ? on_write : 0;
    found.wait_us = nondet_bool() ? on_wait : 0;
    found.send_request = nondet_bool() ? on_send : 0;
    __CPROVER_assume(found.poll_at_most > 0 && found.poll_at_most <= @times@);
    failed_with = 0;
    return found;
}
"""

#: Replaces running steps in proofs of a device's procedures: it reads and writes everything that it receives and may
#: end in any allowed way. The shared header has the proof that running steps does the same.
_RUN = """\
static cw_result any_run(
    const cw_transport *transport, const cw_step *steps, size_t count, uint8_t *bytes, size_t length,
    cw_failure *failure)
{
    size_t reads = 0;
    bool reading = false;
    __CPROVER_assert(failed_with == 0, "nothing is run after a failure");
    for (size_t at = 0; at < count; at++) {
        __CPROVER_assert(steps[at].kind >= CW_STEP_WRITE, "a kind of step");
        __CPROVER_assert(steps[at].kind <= CW_STEP_MORE, "a kind of step");
        reading = steps[at].kind == CW_STEP_READ || (reading && steps[at].kind == CW_STEP_MORE);
        reads += reading;
    }
    __CPROVER_assert(reads == length, "a place for each byte that is read");
    for (size_t at = 0; at < length; at++) bytes[at] = nondet_byte();
    if (nondet_bool()) return CW_OK;
    if (nondet_bool()) return nondet_bool() ? CW_FAULT_UNSUPPORTED : CW_FAULT_TIMEOUT;
    __CPROVER_assume(fails() != 0);
    if (failure != 0) failure->error = failed_with;
    return CW_FAULT_TRANSPORT;
}
#define cw_run any_run
"""


def _bounded(step: str) -> str:
    """Return the assumptions about a step that let its loops end within the rounds.

    The assumptions are few repetitions, and a reply, whose length replaces an address, that is short or longer than its
    space.
    """
    reply = f"{step}.address <= {TIMES} || {step}.address > {REPLY}"
    return f"__CPROVER_assume({step}.times <= {TIMES}); __CPROVER_assume({reply});"


class _Arguments:
    """Arguments of a function: lines that declare them, the arguments, and the results by type and name."""

    def __init__(self, proof: CallProof, function: Function) -> None:
        self.lines: list[str] = []
        self.passed: list[str] = []
        self.results: list[tuple[str, str]] = []
        self.transport = any(name == "transport" for _, name in function.arguments)
        self._proof, self._any_steps = proof, _any_steps(function)
        kinds = [kind for kind, _ in function.arguments]
        counted = ""
        for (kind, name), follows in zip(function.arguments, [*kinds[1:], ""], strict=True):
            plain, local = kind.removeprefix("const ").rstrip(" *"), f"a_{name}"
            if (kind, name) == ("const uint8_t *", "first"):
                # Two buffers have the same length, which follows the second buffer.
                self._several(plain, kind, local, f"{local}_count")
            elif (kind, name) == ("const uint8_t *", "second"):
                counted = "a_first_count"
                self._several(plain, kind, local, f"{local}_count", counted)
            elif counted and kind == "size_t":
                self.passed.append(counted)
                counted = ""
            elif kind.endswith("*") and follows == "size_t" and plain in ("uint8_t", "cw_step"):
                counted = f"{local}_count"
                self._several(plain, kind, local, counted)
            elif kind == "const cw_step *" and ("size_t", "length") in function.arguments:
                # The last argument is the length of both the steps and the bytes.
                self.lines.append(f"{plain} {local}[{STEPS}];")
                self.passed.append(local)
            elif kind.endswith("*"):
                self._pointer(plain, kind, local)
            elif proof.device is not None and kind == proof.prefix:
                self.passed.append("variant")
            else:
                self.lines.append(f"{kind} {local}{' = nondet_bool()' if kind == 'bool' else ''};")
                if (kind, name) == ("int64_t", "position"):
                    self.lines.append(f"__CPROVER_assume({local} >= -{POSITION} && {local} <= {POSITION});")
                self.passed.append(local)

    def _several(self, plain: str, kind: str, local: str, count: str, same_as: str = "nondet_size()") -> None:
        """Add a buffer and its length."""
        limit = BYTES if plain == "uint8_t" else 4 * BYTES
        if self._any_steps or kind == "const cw_step *":
            limit = STEPS
        self.lines.append(f"size_t {count} = {same_as}; __CPROVER_assume({count} <= {limit});")
        if self._any_steps:
            # Memory of arbitrary size is too hard here.
            self.lines.append(f"{plain} {local}[{limit}];")
        else:
            self.lines.append(f"{plain} *{local} = malloc({count} * sizeof({plain})); __CPROVER_assume({local} != 0);")
        if plain != "uint8_t" and kind.startswith("const"):
            # A function that accesses one step at once receives its number of bytes, which may be 0.
            bounded = limit if self._any_steps else count
            self.lines.append(f"for (size_t at = 0; at < {bounded}; at++) {{ {_bounded(f'{local}[at]')} }}")
        self.passed.append(local)

    def _pointer(self, plain: str, kind: str, local: str) -> None:
        proof = self._proof
        if proof.device is not None and plain == proof.prefix:
            self.lines.append(f"{plain} {local} = variant;")
        elif plain == "char":
            self.lines.append(f"char {local}[{LABEL + 1}]; {local}[{LABEL}] = 0;")
        elif plain == "cw_transport":
            self.lines.append(f"const {plain} {local} = any_transport();")
        elif plain == "cw_failure":
            self.lines.append(f"{plain} failure; failure.left_open = 0;")
        else:
            self.lines += [line.strip() for line in proof.header.anything(plain, local).splitlines()]
            if plain == "cw_step":
                self.lines.append(_bounded(local))
            if not kind.startswith("const"):
                self.results.append((plain, local))
        if plain == "cw_failure":
            self.passed.append("&failure" if self.transport else "nondet_bool() ? &failure : 0")
        else:
            self.passed.append(local if plain == "char" else f"&{local}")


@dataclass(frozen=True)
class CallProof:
    """Proofs of the functions of one header, of a device or, without one, of the runtime."""

    header: Header
    include: str
    functions: Sequence[Function]
    device: Device | None = None

    @property
    def prefix(self) -> str:
        return DeviceView(self.device).prefix if self.device is not None else "cw"

    @cached_property
    def variants(self) -> Variants | None:
        if self.device is None:
            return None
        return Variants.of_interface(self.device, "", [parameter.name for parameter in self.device.set_parameters])

    @cached_property
    def harness(self) -> str:
        text = "".join(f'#include "codewheel/{name}.h"\n' for name in SHARED) + PRELUDE + _TRANSPORT
        if self.device is not None:
            # Comparing labels is proved with encoder.h. Here it may find anything, so that the search holds whatever
            # the label.
            text += "static size_t any_match(const char *label, const char *code) { return nondet_size(); }\n"
            text += "#define cw_label_match any_match\n"
            text += f'{_RUN}#include "{self.include}"\n'
        text = text.replace("@times@", str(TIMES))
        if self.variants is not None:
            text += self.variants.declare(self.prefix, self.header)
        return text + "".join(map(self._call, self.functions))

    def _call(self, function: Function) -> str:
        arguments = _Arguments(self, function)
        call = f"{function.name}({', '.join(arguments.passed)})"
        lines = arguments.lines
        if function.type == "cw_result":
            lines += [f"const {kind} before_{name} = {name};" for kind, name in arguments.results]
            lines += [f"const int found = (int){call};", *self._claims(arguments)]
        else:
            lines.append(f"{'' if function.type == 'void' else '(void)'}{call};")
        variant = "    any_variant();\n" if self.device is not None else ""
        return f"void call_{function.name}(void)\n{{\n{variant}" + "".join(f"    {line}\n" for line in lines) + "}\n"

    def _claims(self, arguments: _Arguments) -> Iterator[str]:
        for kind, name in arguments.results:
            places = []
            for member in self.header.structs.get(kind, ()):
                indexes = [f"[{index}]" for index in range(member.count)] or [""]
                places += [f".{member.name}{index}" for index in indexes]
            is_unchanged = " && ".join(f"{name}{place} == before_{name}{place}" for place in places or [""])
            yield f'__CPROVER_assert(found == 0 || ({is_unchanged}), "a fault leaves the result as it was");'
        if arguments.transport:
            # If a step failed with another error, that remains the reason, even if closing fails after it.
            is_reported = f"found == {TRANSPORT} || (found != 0 && failure.left_open)"
            yield f'__CPROVER_assert(failed_with == 0 || {is_reported}, "a failure is reported");'
            yield f'__CPROVER_assert(found != {TRANSPORT} || failure.error == failed_with, "with its number");'
            yield f'__CPROVER_assert(found != {TRANSPORT} || failed_with != 0, "and only then");'

    def proofs(self, together: int = 10) -> Iterable[Proof]:
        """Yield several functions in one run.

        Proofs that go through all order codes run alone, as they take longest.
        """
        text = self.harness
        anywhere = [function for function in self.functions if ("size_t *", "next") in function.arguments]
        labels = [function for function in self.functions if function.name.startswith("cw_label")]
        codes = [function for function in self.functions if "order_codes(" in function.body or "label" in function.name]
        codes = [function for function in codes if function not in (*anywhere, *labels)]
        steps = [function for function in self.functions if _any_steps(function)]
        simple = [function for function in self.functions if function not in (*labels, *codes, *steps, *anywhere)]
        groups = (
            [([function], LABEL + 2) for function in labels]
            + [([function], CODES_ROUNDS) for function in codes]
            + [([function], ANY_ROUNDS) for function in anywhere]
            + [([function], STEPS_ROUNDS) for function in steps]
        )
        groups += [(simple[at : at + together], ROUNDS) for at in range(0, len(simple), together)]
        for group, rounds in groups:
            body = "".join(f"    call_{function.name}();\n" for function in group)
            more = f" and {len(group) - 1} more" if len(group) > 1 else ""
            options = (*UNDEFINED, *([PARTLY] if rounds == ANY_ROUNDS else []))
            whole = f"{text}void everything(void)\n{{\n{body}}}\n"
            name = f"{group[0].name}{more}, called"
            yield Proof(name, harness=whole, function="everything", unwind=rounds, options=options)


def _any_steps(function: Function) -> bool:
    """Return True if the function receives arbitrary steps."""
    return any(kind == "const cw_step *" for kind, _ in function.arguments)
