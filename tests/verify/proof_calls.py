"""Proofs of every other function: called with anything that its arguments may be, it does nothing that C leaves undefined, and it keeps what the
headers promise of all functions: one that returns a fault has left its results as they were, and a fault of the transport is handed on.

The harness of a function is built from its signature, so that a new function is proved as soon as it is in a header.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from codewheel.model import Device

from proof import PARTLY, PRELUDE, UNDEFINED, Function, Header, Proof, Variants

TRANSPORT, UNSUPPORTED = 5, 7
#: Bounds of what is given: bytes of a buffer, steps of a procedure, characters of a label, repetitions of a step.
BYTES, STEPS, LABEL, TIMES = 16, 2, 12, 2
#: How often a loop goes round at most, and one more: over order codes, over steps that may be anything, and every other.
CODES_ROUNDS, STEPS_ROUNDS, ROUNDS, ANY_ROUNDS = 70, 4, 24, 3

#: A transport of which every function may be missing or may fail at any call, with any number but 0. None may be called after one has failed.
_TRANSPORT = """\
static int32_t failed_with;
static int32_t fails(void)
{
    int32_t error;
    __CPROVER_assert(failed_with == 0, "nothing goes over the transport after a failure");
    failed_with = error;
    return error;
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
static int32_t on_wait(void *context, uint32_t microseconds) { return fails(); }
static int32_t on_send(void *context, uint8_t request) { return fails(); }
static @transport@ any_transport(void)
{
    @transport@ found;
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


@dataclass(frozen=True)
class CallProof:
    """The functions of one header: that of a device, or without one the shared header."""

    maker: str
    header: Header
    include: str
    functions: Sequence[Function]
    device: Device | None = None

    @property
    def prefix(self) -> str:
        return f"{self.maker}_{self.device.name}" if self.device is not None else self.maker

    def harness(self) -> str:
        text = f'#include "{self.maker}/encoder.h"\n{PRELUDE}'
        if self.device is not None:
            # Comparing labels is proved with the shared header; here it may find anything, so that the search holds whatever the label.
            text += f"static size_t any_match(const char *label, const char *code) {{ return nondet_size(); }}\n#define {self.maker}_label_match any_match\n"
        text += f'#include "{self.include}"\n'
        if f"{self.maker}_transport" in self.header.structs or any("transport" in kind for item in self.functions for kind, _ in item.arguments):
            text += _TRANSPORT.replace("@transport@", f"{self.maker}_transport").replace("@times@", str(TIMES))
        if self.device is not None:
            text += Variants.of(self.device, "", [item.name for item in self.device.set_parameters]).declare(self.prefix, self.header)
        return text + "".join(map(self._call, self.functions))

    def _call(self, function: Function) -> str:
        lines: list[str] = []
        passed: list[str] = []
        results: list[tuple[str, str]] = []
        pending = ""
        for index, (kind, name) in enumerate(function.arguments):
            plain = kind.removeprefix("const ").rstrip(" *")
            follows = function.arguments[index + 1][0] if index + 1 < len(function.arguments) else ""
            local = f"a_{name}"
            if pending and kind == "size_t":
                passed.append(pending)
                pending = ""
            elif not kind.endswith("*"):
                lines.append(f"{kind} {local}{' = nondet_bool()' if kind == 'bool' else ''};")
                passed.append(local)
            elif self.device is not None and plain == f"{self.prefix}_variant":
                lines.append(f"{plain} {local} = variant;")
                passed.append(f"&{local}")
            elif plain == "char":
                lines.append(f"char {local}[{LABEL + 1}]; {local}[{LABEL}] = 0;")
                passed.append(local)
            elif follows == "size_t" and plain in ("uint8_t", f"{self.maker}_step"):
                most = (STEPS if _any_steps(self.maker, function) else BYTES) if plain == "uint8_t" else STEPS if kind.startswith("const") else 4 * BYTES
                pending = f"{local}_count"
                lines.append(f"size_t {pending} = nondet_size(); __CPROVER_assume({pending} <= {most});")
                if _any_steps(self.maker, function):
                    # Memory of a size that may be anything is too hard here.
                    lines.append(f"{plain} {local}[{most}];")
                else:
                    lines.append(f"{plain} *{local} = malloc({pending} * sizeof({plain})); __CPROVER_assume({local} != 0);")
                if plain != "uint8_t" and kind.startswith("const"):
                    lines.append(f"for (size_t at = 0; at < {pending}; at++) __CPROVER_assume({local}[at].times <= {TIMES});")
                passed.append(local)
            elif plain == f"{self.maker}_transport":
                lines.append(f"const {plain} {local} = any_transport();")
                passed.append(f"&{local}")
            elif plain == f"{self.maker}_failure":
                lines.append(f"{plain} failure;")
                passed.append("nondet_bool() ? &failure : 0" if "transport" not in dict((n, k) for k, n in function.arguments) else "&failure")
            else:
                lines += [line.strip() for line in self.header.anything(plain, local).splitlines()]
                if plain == f"{self.maker}_step":
                    lines.append(f"__CPROVER_assume({local}.times <= {TIMES});")
                if not kind.startswith("const"):
                    results.append((plain, local))
                passed.append(f"&{local}")
        call = f"{function.name}({', '.join(passed)})"
        given = {name for _, name in function.arguments}
        if function.type != f"{self.maker}_result":
            lines.append(f"{'' if function.type == 'void' else '(void)'}{call};")
        else:
            lines += [f"const {kind} before_{name} = {name};" for kind, name in results]
            lines.append(f"const int found = (int){call};")
            for kind, name in results:
                members = self.header.structs.get(kind)
                places = [f".{item.name}{at}" for item in members for at in ([f"[{index}]" for index in range(item.count)] or [""])] if members else [""]
                same = " && ".join(f"{name}{place} == before_{name}{place}" for place in places)
                lines.append(f'__CPROVER_assert(found == 0 || ({same}), "a fault leaves the result as it was");')
            if "transport" in given:
                lines.append(f'__CPROVER_assert(failed_with == 0 || found == {TRANSPORT}, "a failure of the transport is reported");')
                lines.append(f'__CPROVER_assert(failed_with == 0 || failure.error == failed_with, "with the number of the function that failed");')
                lines.append(f'__CPROVER_assert(found != {TRANSPORT} || failed_with != 0, "and only then");')
        variant = "    any_variant();\n" if self.device is not None else ""
        return f"void call_{function.name}(void)\n{{\n{variant}" + "".join(f"    {line}\n" for line in lines) + "}\n"

    def proofs(self, together: int = 10) -> Iterable[Proof]:
        """Several functions in one run; those that go through the list of order codes one by one, because they take longest."""
        text = self.harness()
        anywhere = [item for item in self.functions if ("size_t *", "next") in item.arguments]
        codes = [item for item in self.functions if "order_codes(" in item.body or "label" in item.name if item not in anywhere]
        steps = [item for item in self.functions if _any_steps(self.maker, item)]
        rest = [item for item in self.functions if item not in (*codes, *steps, *anywhere)]
        groups = [([item], CODES_ROUNDS) for item in codes] + [([item], ANY_ROUNDS) for item in anywhere] + [([item], STEPS_ROUNDS) for item in steps]
        groups += [(rest[at : at + together], ROUNDS) for at in range(0, len(rest), together)]
        for group, rounds in groups:
            body = "".join(f"    call_{item.name}();\n" for item in group)
            more = f" and {len(group) - 1} more" if len(group) > 1 else ""
            yield Proof(f"{group[0].name}{more}, undefined behaviour", f"{text}void everything(void)\n{{\n{body}}}\n", "everything", rounds, (*UNDEFINED, *([PARTLY] if rounds == ANY_ROUNDS else [])))


def _any_steps(maker: str, function: Function) -> bool:
    """Whether the function is given steps that may be anything."""
    return any(kind == f"const {maker}_step *" for kind, _ in function.arguments)
