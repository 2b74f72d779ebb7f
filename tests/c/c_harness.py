"""A C program that calls everything in a header of the C target, told by lines on standard input.

Each line begins with an order code, after which ``;REGISTER=HEX`` may tell what a register holds at run time. It answers each line with one line,
beginning with the number of the result:

    CODE decode LAYOUT HEX            the members, in the struct's order; texts as hex
    CODE encode LAYOUT VALUE...       the word or the bytes as hex
    CODE crc NAME HEX                 the CRC
    CODE select SENDER HEX            the frame and its length
    CODE steps PROCEDURE [HEX...]      kind,address,mask,value,times,microseconds of each step
    CODE expected REGISTER HEX        whether the register reads as always
    CODE measure FUNCTION NUMBER...   what a function of positions gives
    CODE candidates HEX...            the order codes that read so, by the members of the identity
    CODE take                         nothing but the results of taking the registers over
    LABEL find                        the text of the order code and the parts that are not listed

Registers are layouts called ``reg_NAME``. The struct is filled with a pattern before each call, so that a fault that changes it shows.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from codewheel.load import load_library
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c import generate
from codewheel.targets.c_device import DeviceView
from codewheel.targets.c_views import CodecView, Function, IdentityView

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wcast-qual -Wshadow -Werror".split()
SPECS = Path(__file__).resolve().parents[1] / "specs"

#: Runs lines through the program and gives one answer for each.
Run = Callable[[Iterable[str]], list[str]]

#: The families of the library, by which tests are named.
FAMILIES = ("am36", "amm5", "asc85", "sma21")


def devices_of(*paths: Path) -> tuple[Device, ...]:
    devices, report = load_library(paths)
    assert not len(report)
    return devices


def write(folder: Path, devices: tuple[Device, ...]) -> Path:
    """Writes the C tree of these devices; gives the folder to include from."""
    for name, text in generate(Library(devices)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "c" / "include"


def compile_c(command: list[str], code: str, folder: Path, include: Path, stem: str = "program", link: bool = True) -> Path:
    """Compiles a text with all warnings as errors, and links it."""
    text, program = folder / f"{stem}.c", folder / stem
    text.write_text(code, encoding="utf-8")
    options = ["-o", str(program)] if link else ["-c", "-o", f"{program}.o"]
    done = subprocess.run([*command, *WARNINGS, f"-I{include}", str(text), *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:4000]
    return program


def runner(program: Path) -> Run:
    def run(lines: Iterable[str]) -> list[str]:
        text = "".join(f"{line}\n" for line in lines)
        done = subprocess.run([str(program)], input=text, capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run

_MEMBER = re.compile(r"(\w+) (\w+)(?:\[(\d+)\])?;")


@dataclass(frozen=True)
class Member:
    type: str
    name: str
    characters: int


def codecs(view: DeviceView) -> list[CodecView]:
    found = [codec for interface in view.interfaces for codec in interface.codecs]
    return found + [register.codec for register in view.registers if register.codec is not None]


def members(codec: CodecView) -> list[Member]:
    matches = (_MEMBER.fullmatch(line.code) for line in codec.members)
    return [Member(match[1], match[2], int(match[3] or 0)) for match in matches if match is not None]


def short(view: DeviceView, codec: CodecView) -> str:
    return codec.name.removeprefix(view.prefix + "_")


def source(device: Device) -> str:
    view = DeviceView(device)
    maker, prefix = device.manufacturer.name, view.prefix
    text = _HEAD.replace("@maker@", maker).replace("@MAKER@", maker.upper()).replace("@device@", device.name).replace("@prefix@", prefix)
    branches = []
    for codec in codecs(view):
        name = short(view, codec)
        text += _decode(view, codec, name) + _encode(view, codec, name)
        branches += [_branch("decode", name), _branch("encode", name)]
    for crc in view.crcs:
        call = f"{crc.name}(number(text))" if crc.style == "fold" else f"{crc.name}(number(text), 4U * (uint32_t)strlen(text))" if crc.style == "bits" else ""
        body = f'printf("0 %llu\\n", (unsigned long long){call});' if call else f'uint8_t b[64]; const size_t n = bytes_of(text, b); printf("0 %llu\\n", (unsigned long long){crc.name}(b, n));'
        text += f"static void crc_{crc.crc.name}(const {prefix}_variant *variant, char *text)\n{{\n    (void)variant;\n    {body}\n}}\n"
        branches.append(_branch("crc", crc.crc.name))
    for interface in view.interfaces:
        for selector in interface.selectors:
            kind = selector.function.rsplit("_", 2)[-2]
            text += f"""static void select_{kind}(const {prefix}_variant *variant, char *text)
{{
    uint8_t b[64];
    const size_t n = bytes_of(text, b);
    {interface.frame_type} frame = ({interface.frame_type})0;
    const {maker}_result result = {selector.function}(b, n, &frame);
    (void)variant;
    printf("%d %d %u\\n", (int)result, (int)frame, (unsigned)(result == {maker.upper()}_OK ? {interface.frame_type}_length(frame) : 0U));
}}
"""
            branches.append(_branch("select", kind))
    for procedure in view.procedures:
        name = procedure.name.removeprefix(prefix + "_").removesuffix("_steps")
        if procedure.parameters:
            given = ", ".join(f"({type_})number(arguments[{index}])" for index, (type_, _) in enumerate(procedure.parameters))
            fetch = f"""    {maker}_step steps[{procedure.count_macro}];
    const char *arguments[{len(procedure.parameters)}];
    size_t count = 0U;
    size_t index;
    {maker}_result result;
    for (index = 0U; index < {len(procedure.parameters)}U; index++) {{
        arguments[index] = strtok(index == 0U ? text : NULL, " ");
    }}
    result = {procedure.name}(variant, {given}, steps, {procedure.count_macro} - 1U, &count);
    if (result != {maker.upper()}_FAULT_LENGTH || count != 0U) {{
        abort();
    }}
    result = {procedure.name}(variant, {given}, steps, {procedure.count_macro}, &count);
    print_steps(result, steps, count);
"""
        else:
            fetch = f"""    size_t count;
    const {maker}_step *const steps = {procedure.name}(&count);
    (void)variant;
    (void)text;
    print_steps({maker.upper()}_OK, steps, count);
"""
        text += f"static void steps_{name}(const {prefix}_variant *variant, char *text)\n{{\n{fetch}}}\n"
        branches.append(_branch("steps", name))
    for function in functions(view):
        name = function.name.removeprefix(prefix + "_")
        text += _call(view, function, name)
        branches.append(_branch("measure", name))
    for codec in codecs(view):
        if codec.expected_checks:
            text += _expected(view, codec, short(view, codec))
            branches.append(_branch("expected", short(view, codec)))
    for identity in view.identities:
        text += _candidates(view, identity)
        branches.append(_branch("candidates", "of"))
    takes = "".join(_TAKE.replace("@register@", item.name.removeprefix(f"{prefix}_take_")).replace("@call@", item.name) for item in view.takers)
    return text + _MAIN.replace("@prefix@", prefix).replace("@branches@", "".join(branches)).replace("@takes@", takes)


def functions(view: DeviceView) -> list[Function]:
    """The small functions of a variant: parameters that follow, what positions mean, limits."""
    limits = [limits for register in view.registers for limits in (register.limits, *(item.limits for item in register.meanings))]
    return [*view.derived, *view.meanings, *(item for limit in limits for item in limit.functions)]


def _call(view: DeviceView, function: Function, name: str) -> str:
    types = [argument.split()[0] for argument in function.arguments.split(", ") if argument]
    given = "".join(f", ({type_})strto{'ll' if type_ == 'int64_t' else 'ull'}(item[{index}], NULL, 10)" for index, type_ in enumerate(types))
    reads = "".join(f'    item[{index}] = strtok({"text" if index == 0 else "NULL"}, " ");\n' for index in range(len(types)))
    show, cast = {"double": ("%.17g", "double"), "int64_t": ("%lld", "long long")}.get(function.type, ("%llu", "unsigned long long"))
    declare = f"    char *item[{len(types)}];\n" if types else ""
    return f"""static void measure_{name}(const {view.prefix}_variant *variant, char *text)
{{
{declare}    (void)text;
{reads}    printf("0 {show}\\n", ({cast}){function.name}(variant{given}));
}}
"""


def _expected(view: DeviceView, codec: CodecView, name: str) -> str:
    return f"""static void expected_{name}(const {view.prefix}_variant *variant, char *text)
{{
    uint8_t b[64];
    {codec.name} out;
    const {view.maker.name}_result result = {codec.name}_decode(variant, b, bytes_of(text, b), &out);
    printf("%d %d\\n", (int)result, (int)(result == {view.maker.name.upper()}_OK && {codec.name}_is_expected(variant, &out)));
}}
"""


def _candidates(view: DeviceView, identity: IdentityView) -> str:
    reads = "".join(
        f'    bytes_of(strtok({"text" if index == 0 else "NULL"}, " "), b);\n    memcpy(read.{member.code.split(" ")[1].partition("[")[0]}, b, sizeof read.{member.code.split(" ")[1].partition("[")[0]});\n'
        for index, member in enumerate(identity.members)
    )
    return f"""static void candidates_of(const {view.prefix}_variant *variant, char *text)
{{
    uint8_t b[64];
    {identity.type} read;
    size_t next = 0U;
    const {view.prefix}_order_code *code;
    (void)variant;
{reads}    printf("0");
    while ((code = {identity.next}(&read, &next)) != NULL) {{
        printf(" %s", code->text);
    }}
    printf("\\n");
}}
"""


def _branch(verb: str, name: str) -> str:
    return f'        if (strcmp(verb, "{verb}") == 0 && strcmp(name, "{name}") == 0) {{\n            {verb}_{name}(&variant, rest);\n            continue;\n        }}\n'


def _decode(view: DeviceView, codec: CodecView, name: str) -> str:
    prints = "".join(
        "".join(f'    printf("{" " if index == 0 else ""}%02X", (unsigned)(unsigned char)out.{member.name}[{index}]);\n' for index in range(member.characters))
        if member.characters
        else f'    printf(" {"%lld" if member.type.startswith("int") else "%llu"}", ({"" if member.type.startswith("int") else "unsigned "}long long)out.{member.name});\n'
        for member in members(codec)
    )
    call = f"{codec.name}_decode(variant, number(text), &out)" if codec.carried_as == "bits" else f"{codec.name}_decode(variant, b, bytes_of(text, b), &out)"
    return f"""static void decode_{name}(const {view.prefix}_variant *variant, char *text)
{{
    {"" if codec.carried_as == "bits" else "uint8_t b[64];"}
    {codec.name} out;
    {codec.name} before;
    {view.maker.name}_result result;
    memset(&out, 0x5A, sizeof out);
    memset(&before, 0x5A, sizeof before);
    result = {call};
    printf("%d", (int)result);
    if (result != {view.maker.name.upper()}_OK) {{
        printf("%s\\n", memcmp(&out, &before, sizeof out) == 0 ? "" : " changed");
        return;
    }}
{prints}    printf("\\n");
}}
"""


def _encode(view: DeviceView, codec: CodecView, name: str) -> str:
    reads = ""
    for member in members(codec):
        reads += "    item = strtok(NULL, \" \");\n" if reads else "    item = strtok(text, \" \");\n"
        if member.characters:
            reads += f"    bytes_of(item, c);\n    memcpy(in.{member.name}, c, sizeof in.{member.name});\n"
        elif member.type == "bool":
            reads += f"    in.{member.name} = *item == '1';\n"
        else:
            reads += f"    in.{member.name} = ({member.type}){'strtoll' if member.type.startswith('int') else 'strtoull'}(item, NULL, 10);\n"
    if codec.carried_as == "bits":
        call = f"uint64_t word = 0U;\n    const {view.maker.name}_result result = {codec.name}_encode(variant, &in, &word);\n"
        show = '    printf("%d %llX\\n", (int)result, (unsigned long long)word);\n'
    else:
        call = f"""uint8_t b[{codec.length_macro}];
    size_t index;
    {view.maker.name}_result result;
    memset(b, 0, sizeof b);
    if ({codec.name}_encode(variant, &in, b, {codec.length_macro} + 1U) != {view.maker.name.upper()}_FAULT_LENGTH) {{
        abort();
    }}
    result = {codec.name}_encode(variant, &in, b, sizeof b);
"""
        show = '    printf("%d ", (int)result);\n    for (index = 0U; index < sizeof b; index++) {\n        printf("%02X", b[index]);\n    }\n    printf("\\n");\n'
    setters = "".join(
        f"    {{\n        const {codec.name} same = in;\n        if ({setter.name}(variant, in.{setter.member}, &in) == {view.maker.name.upper()}_OK && result == {view.maker.name.upper()}_OK"
        f" && memcmp(&same, &in, sizeof in) != 0) {{\n            abort();\n        }}\n    }}\n"
        for setter in codec.setters
    )
    return f"""static void encode_{name}(const {view.prefix}_variant *variant, char *text)
{{
    char *item;
    {"uint8_t c[64];" if any(member.characters for member in members(codec)) else ""}
    {codec.name} in;
    memset(&in, 0, sizeof in);
{reads}    {{
    {call}{show}{setters}    }}
}}
"""


_HEAD = r"""
#include "@maker@/@device@.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t number(const char *text)
{
    return strtoull(text, NULL, 16);
}

static size_t bytes_of(const char *text, uint8_t *bytes)
{
    size_t count = 0U;
    while (text[0] != '\0' && text[0] != ';' && text[1] != '\0' && count < 64U) {
        const char pair[3] = { text[0], text[1], '\0' };
        bytes[count++] = (uint8_t)strtoul(pair, NULL, 16);
        text += 2;
    }
    return count;
}

static void print_steps(@maker@_result result, const @maker@_step *steps, size_t count)
{
    size_t index;
    printf("%d", (int)result);
    for (index = 0U; index < count; index++) {
        printf(" %d,%u,%u,%u,%u,%lu", (int)steps[index].kind, steps[index].address, steps[index].mask, steps[index].value,
               steps[index].times, (unsigned long)steps[index].microseconds);
    }
    printf("\n");
}

"""

_TAKE = r"""            if (strncmp(state, "@register@=", sizeof "@register@=" - 1U) == 0) {
                taken = (int)@call@(&variant, held, held_length);
            }
"""

_MAIN = r"""
int main(void)
{
    static char line[4096];
    (void)number;
    (void)bytes_of;
    (void)print_steps;
    while (fgets(line, (int)sizeof line, stdin) != NULL) {
        char *label;
        char *verb;
        char *name;
        char *rest;
        char *state;
        uint32_t unlisted = 99U;
        @prefix@_variant variant;
        const @prefix@_order_code *code;
        line[strcspn(line, "\n")] = '\0';
        label = strtok(line, " ");
        verb = strtok(NULL, " ");
        state = strchr(label, ';');
        if (state != NULL) {
            *state++ = '\0';
        }
        code = @prefix@_find_order_code(label, &unlisted);
        if (strcmp(verb, "find") == 0) {
            printf("%s %lu\n", code == NULL ? "-" : code->text, (unsigned long)unlisted);
            continue;
        }
        if (code == NULL) {
            abort();
        }
        variant = code->variant;
        for (; state != NULL && *state != '\0'; state += strcspn(state, ";"), state += strspn(state, ";")) {
            uint8_t held[64];
            const char *const value = state + strcspn(state, "=") + 1;
            const size_t held_length = bytes_of(value, held);
            int taken = -1;
@takes@            (void)held_length;
            (void)held;
            if (strcmp(verb, "take") == 0) {
                printf("%d ", taken);
            } else if (taken != 0) {
                abort();
            }
        }
        if (strcmp(verb, "take") == 0) {
            printf("\n");
            continue;
        }
        name = strtok(NULL, " ");
        rest = strtok(NULL, "");
        if (rest == NULL) {
            rest = name + strlen(name);
        }
@branches@        printf("?\n");
    }
    return 0;
}
"""
