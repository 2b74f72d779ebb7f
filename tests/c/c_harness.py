"""C programs that call everything in the headers of an interface, controlled by lines on standard input.

A family has a program for each interface. A line goes to the program of its order code, and ``find`` to all of them.

Each line begins with an order code. ``;REGISTER=HEX`` after it sets the content of a register at run time, and
``;ALTERNATIVE=HEX`` selects the answer to an open question of the manual, with 00 for the first.
It answers each line with one line, beginning with the number of the result:

    CODE decode LAYOUT HEX            the members, in the struct's order; texts as hex
    CODE encode LAYOUT VALUE...       the word or the bytes as hex
    CODE crc NAME HEX                 the CRC
    CODE select SENDER HEX            the frame and its length
    CODE steps PROCEDURE [HEX...]      kind,address,mask,value,times,microseconds of each step
    CODE expected LAYOUT HEX          whether its content is as documented
    CODE tells LAYOUT HEX             the verdict and the mask of reports, or - if the frame has none
    CODE text of HEX                  the members of the text of a report, each in quotes
    CODE measure FUNCTION NUMBER...   the result of a function of positions
    CODE candidates HEX...            the order codes with this identity, by its members
    CODE take                         only the results of updating the variant from the registers
    LABEL find                        the text of the order code and the parts that are not listed

Registers are layouts called ``reg_NAME``. The struct is filled with a pattern before each call,
so that a change on an error is detected.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from codewheel.loading.library import load_library
from codewheel.model import Device, Text
from codewheel.targets import Library
from codewheel.targets.c.codec import StructCodec
from codewheel.targets.c.device import DeviceView, views_of
from codewheel.targets.c.files import generate
from codewheel.targets.c.names import c_name, unsigned
from codewheel.targets.c.procedures import ProcedureCode
from codewheel.targets.c.registers import IdentityCode
from working_tools import require

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wcast-qual -Wshadow -Werror".split()
SPECS = Path(__file__).resolve().parents[1] / "specs"
_HERE = Path(__file__).resolve().parent
_SPECS = _HERE.parents[1] / "specs"
#: Specs with features that no family of the library has, by the name of their device.
MADE_UP = {
    "banks": SPECS / "banks.yaml",
    "bits22": SPECS / "bits22.yaml",
    "digits": SPECS / "digits.yaml",
    "gray": SPECS / "gray.yaml",
    "gray_excess": SPECS / "gray_excess.yaml",
    "gray_parity": SPECS / "gray_parity.yaml",
    "long": SPECS / "long.yaml",
    "long_crc": SPECS / "long_crc.yaml",
    "ring_split": SPECS / "ring_split.yaml",
    "ring_turns": SPECS / "ring_turns.yaml",
    "scale": SPECS / "scale.yaml",
    "signs": SPECS / "signs.yaml",
    "switched": SPECS / "switched.yaml",
    "wide": SPECS / "wide.yaml",
    "reserved": _HERE / "specs" / "reserved.yaml",
    "shapes": _HERE / "specs" / "shapes.yaml",
    "tv62": _HERE.parents[1] / "docs" / "example",
    "words": _HERE / "specs" / "words.yaml",
}

#: Include folder of the runtime.
RUNTIME = _HERE.parents[1] / "runtime" / "c"
#: Headers of the runtime that the headers of a family include.
SHARED = ("result", "bits", "receive", "encoder", "transport")

GCC = ["gcc", "-std=c99"]
#: Undefined behaviour is detected while a program runs.
SANITIZED = ["-fsanitize=undefined,address", "-fno-sanitize-recover=all"]

#: Sends lines to the program and returns one answer for each.
Run = Callable[[Iterable[str]], list[str]]
#: Fixture that fills a folder once for all workers.
MadeOnce = Callable[[str, Callable[[Path], object]], Path]

#: Interfaces of the families, by the stems of their headers.
INTERFACES = (
    *("am36_ssi", "am36_biss", "amm5_ssi", "amm5_biss", "amm5_rs485", "asc85_ssi", "asc85_biss", "icmu_biss"),
    *("sma21_ssi", "sma21_biss", "sma21_rs485"),
)
#: Manufacturers of the families of the library, by the names of the families, which are also names of tests.
FAMILIES = {"am36": "lika", "amm5": "lika", "asc85": "lika", "icmu": "ichaus", "sma21": "lika"}


def headers_of(name: str, include: Path) -> list[Path]:
    """Return the headers of a family, grouped by interface, in the order of their includes."""
    places = [path for path in include.glob(f"*/{name}_*.h") if path.stem.split("_")[0] == name]
    order = ["", "labels", "reports", "registers", "procedures", "simulate"]
    return sorted(places, key=lambda path: (path.stem.split("_")[1], order.index("".join(path.stem.split("_")[2:]))))


def text_of(name: str, include: Path) -> str:
    """Return the text of all headers of a family."""
    return "".join(path.read_text(encoding="ascii") for path in headers_of(name, include))


def interfaces_of(devices: Iterable[Device]) -> dict[str, Device]:
    """Return each device with only one of its interfaces, by the stem of its headers."""
    return {view.stem: view.device for device in devices for view in views_of(device)}


def included(device: Device) -> str:
    """Return the lines that include all headers of a device with one interface."""
    return "".join(f'#include "{header}"\n' for header in DeviceView(device).headers)


def devices_of(*paths: Path) -> tuple[Device, ...]:
    """Return the devices of specs, or else those of ``FAMILIES``."""
    devices, report = load_library(paths or [_SPECS / maker / f"{name}.yaml" for name, maker in FAMILIES.items()])
    assert not len(report)
    return devices


def write(folder: Path, devices: tuple[Device, ...]) -> Path:
    """Write the C tree of these devices, and return its include folder."""
    for name, text in generate(Library(devices)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "c" / "include"


def compile_c(
    command: list[str], code: str, folder: Path, include: Path, stem: str = "program", link: bool = True
) -> Path:
    """Compile and link a text, with all warnings as errors."""
    require(command)
    text, program = folder / f"{stem}.c", folder / stem
    text.write_text(code, encoding="utf-8")
    options = ["-o", str(program)] if link else ["-c", "-o", f"{program}.o"]
    completed = subprocess.run(
        [*command, *WARNINGS, f"-I{include}", str(text), *options], capture_output=True, text=True
    )
    assert completed.returncode == 0, completed.stderr[:4000]
    return program


def program_over(device: Device, made_once: MadeOnce, name: str, *options: str) -> Run:
    """Return the program for the header of a device, in a folder called ``name``. It detects undefined behaviour."""

    def compiled(folder: Path) -> None:
        compile_programs([*GCC, "-O1", *SANITIZED, *options], device, folder, write(folder, (device,)))

    return runner_over(device, made_once(name, compiled))


def compile_programs(command: list[str], device: Device, folder: Path, include: Path, link: bool = True) -> None:
    """Compile the program for each interface of a family, and return them by the name of the interface."""
    for view in views_of(device):
        compile_c(command, source(view), folder, include, view.context.interface.name, link)


def runner_over(device: Device, folder: Path) -> Run:
    """Return the programs compiled into this folder as one."""
    return combined_run(device, {interface.name: runner(folder / interface.name) for interface in device.interfaces})


def combined_run(device: Device, programs: Mapping[str, Run]) -> Run:
    """Send each line to the program for the interface of its order code. A label to be found goes to all programs."""
    interface_by_code = {variant.code: variant.interface for variant in device.variants}

    def run(lines: Iterable[str]) -> list[str]:
        sent_lines = list(lines)
        codes = [line.split(" ")[0].split(";")[0] for line in sent_lines]
        answers = ["- 0"] * len(sent_lines)
        for interface, program in programs.items():
            rows = [row for row, code in enumerate(codes) if interface_by_code.get(code, interface) == interface]
            answers_of_program = program(sent_lines[row] for row in rows)
            for row, answer in zip(rows, answers_of_program, strict=True):
                # "- 0" means that the program does not have the label. Another program can have it.
                if answer != "- 0":
                    answers[row] = answer
        return answers

    return run


def runner(program: Path) -> Run:
    def run(lines: Iterable[str]) -> list[str]:
        text = "".join(f"{line}\n" for line in lines)
        completed = subprocess.run([str(program)], input=text, capture_output=True, text=True, timeout=120)
        assert completed.returncode == 0, completed.stderr
        return completed.stdout.splitlines()

    return run


@dataclass(frozen=True)
class Member:
    type: str
    name: str
    characters: int


def codecs(view: DeviceView) -> list[StructCodec]:
    return [*view.interface.codecs] + [register.codec for register in view.registers if register.codec is not None]


def members(codec: StructCodec) -> list[Member]:
    struct_members = []
    for field in (part.field for part in codec.layout_plan.decoded_fields):
        if isinstance(field.kind, Text):
            struct_members.append(Member("char", c_name(field.name), field.widest // 8))
            continue
        struct_members.append(Member(codec.struct.type_of(field), c_name(field.name), 0))
        struct_members += [Member(unsigned((run.modulus - 1).bit_length()), c_name(run.name), 0) for run in field.runs]
    struct_members += [
        Member(unsigned(whole.widest), c_name(whole.join.name), 0) for whole in codec.layout_plan.joined_numbers
    ]
    struct_members += [Member(codec.struct.unused.type, "unused", 0)] if codec.struct.unused else []
    return struct_members or [Member("uint8_t", "no_data", 0)]


def answers(codec: StructCodec) -> str:
    """Return the answers that the functions of a frame take, passed after the variant."""
    return "".join(f"{question.type}_taken, " for question in codec.alternatives)


def word_of(codec: StructCodec) -> str:
    """Return the word that a decoder takes, from its number in ``text``. If that is too high, the word is too long."""
    if not codec.word_has_length:
        return f"({codec.struct.number_type})number(text)"
    taken = "".join(f", {question.type}_taken" for question in codec.length_alternatives)
    return f"cw_word_of(number(text), {codec.name}_bits(variant{taken}))"


def _too_high(codec: StructCodec) -> str:
    """Return the start of a conditional for numbers that the type of the word cannot hold, so no caller passes them."""
    size = codec.struct.reader.word_size
    if codec.layout_plan.in_bytes or size == 64:
        return ""
    return f"(number(text) >> {size}U) != 0U ? CW_FAULT_LENGTH : "


def short(view: DeviceView, codec: StructCodec) -> str:
    """Return the name of a layout, or ``reg_`` and the name of a register."""
    return codec.struct.layout.name if codec.struct.register is None else codec.name.removeprefix(view.prefix + "_")


def source(view: DeviceView) -> str:
    parts = [*_codec_parts(view), *_procedure_parts(view), *_tested_parts(view)]
    headers = "".join(f'#include "{header}"\n' for header in view.headers)
    taken = "".join(f"static {question.type} {question.type}_taken;\n" for question in view.alternatives)
    text = _HEAD.replace("@headers@", headers) + "".join(code for _, _, code in parts)
    main = _MAIN.replace("@prefix@", view.prefix)
    main = main.replace("@branches@", "".join(_branch(verb, name) for verb, name, _ in parts))
    main = main.replace("@takes@", _takes(view))
    resets = "".join(f"        {question.type}_taken = ({question.type})0;\n" for question in view.alternatives)
    return text.replace(_MARK, taken) + main.replace("@resets@", resets)


def _codec_parts(view: DeviceView) -> Iterator[tuple[str, str, str]]:
    """Yield verb, name and code for the decoders and encoders, the CRCs, and the selection of frames."""
    for codec in codecs(view):
        name = short(view, codec)
        yield "decode", name, _decode(view, codec, name)
        yield "encode", name, _encode(view, codec, name)
    for crc, code in crcs(view).items():
        yield "crc", crc, code
    for teller in view.interface.frame_selectors:
        kind = {"encoder": "reply", "master": "request"}[teller.dispatch.sender]
        yield "select", kind, _select(view, kind, teller.function_of_bytes)


def _select(view: DeviceView, kind: str, function: str) -> str:
    prefix = view.interface.prefix
    return f"""static void select_{kind}({view.prefix} variant, char *text)
{{
    uint8_t b[64];
    const size_t n = bytes_of(text, b);
    {prefix}_frame frame = ({prefix}_frame)0;
    const cw_result result = {function}(b, n, &frame);
    (void)variant;
    printf("%d %d %u\\n", (int)result, (int)frame,
           (unsigned)(result == CW_OK ? {prefix}_frame_length(frame) : 0U));
}}
"""


def _procedure_parts(view: DeviceView) -> Iterator[tuple[str, str, str]]:
    for procedure in view.procedures:
        name = procedure.procedure_plan.procedure.name
        fetch = _steps_with_arguments(procedure) if procedure.arguments else _steps(procedure)
        yield "steps", name, f"static void steps_{name}({view.prefix} variant, char *text)\n{{\n{fetch}}}\n"


def _steps_with_arguments(procedure: ProcedureCode) -> str:
    types = [argument.type for argument in procedure.arguments]
    argument_list = ", ".join(f"({type_})number(arguments[{index}])" for index, type_ in enumerate(types))
    return f"""    cw_step steps[{procedure.count_macro}];
    const char *arguments[{len(types)}];
    size_t count = 0U;
    size_t index;
    cw_result result;
    for (index = 0U; index < {len(types)}U; index++) {{
        arguments[index] = strtok(index == 0U ? text : NULL, " ");
    }}
    result = {procedure.steps_function}(variant, {argument_list}, steps, {procedure.count_macro} - 1U, &count);
    if (result != CW_FAULT_LENGTH || count != 0U) {{
        abort();
    }}
    result = {procedure.steps_function}(variant, {argument_list}, steps, {procedure.count_macro}, &count);
    print_steps(result, steps, count);
"""


def _steps(procedure: ProcedureCode) -> str:
    return f"""    size_t count;
    const cw_step *const steps = {procedure.steps_function}(&count);
    (void)variant;
    (void)text;
    print_steps(CW_OK, steps, count);
"""


def _tested_parts(view: DeviceView) -> Iterator[tuple[str, str, str]]:
    """Yield verb, name and code for the small functions, the expected values and reports, and the identities."""
    for function in functions(view):
        name = function.name.removeprefix(view.prefix + "_")
        yield "measure", name, _call(view, function, name)
    for codec in codecs(view):
        name = short(view, codec)
        if codec.can_differ_from_manual:
            yield "expected", name, _expected_branch(view, codec, name)
        if codec.reports is not None:
            yield "tells", name, _report_branch(view, codec, name)
    if view.reports.all_reports:
        yield "text", "of", _text(view)
    for identity in view.identities:
        yield "candidates", "of", _candidates(view, identity)


def _takes(view: DeviceView) -> str:
    """Return the branches that set the state of the program: registers, answers, and members of the variant."""
    takes = ""
    for taker in view.variant_updaters:
        register = taker.name.removeprefix(f"{view.prefix}_take_")
        takes += _TAKE.replace("@register@", register).replace("@call@", taker.name)
    for question in view.alternatives:
        takes += _ANSWER.replace("@alternative@", question.spec_question.name).replace("@type@", question.type)
    interface = view.interface.interface.name
    names = {parameter.name for parameter in view.device.parameters if parameter.interface == interface}
    for alternative in view.device.alternatives:
        if alternative.default and alternative.parameter in names:
            member = _MEMBER.replace("@alternative@", alternative.name)
            takes += member.replace("@parameter@", alternative.parameter)
    return takes


@dataclass(frozen=True)
class Numeric:
    """A function of a variant and of numbers with these types."""

    name: str
    type: str
    arguments: tuple[str, ...] = ()


#: Functions of positions, by the end of their names: type, and type of each argument.
_OF_POSITIONS = {
    "counts_per_turn": ("uint64_t",),
    "modulus": ("uint64_t",),
    "position_difference": ("int64_t", "uint64_t", "uint64_t"),
    "turns": ("double", "uint64_t"),
    "degrees": ("double", "uint64_t"),
    "micrometres": ("int64_t", "int64_t"),
    "millimetres": ("double", "int64_t"),
}


def functions(view: DeviceView) -> list[Numeric]:
    """Return the small functions of a variant: dependent parameters, conversions of positions, limits."""
    limits = [limits for register in view.registers for limits in register.limits]
    plain = [*view.variants.derived, *(function for limit in limits for function in limit.functions)]
    positions = view.positions
    of_positions = []
    for position_range in positions.ranges if positions is not None else ():
        for name in position_range.names:
            kind = _OF_POSITIONS[name.removeprefix(position_range.frame_in_names)]
            of_positions.append(Numeric(f"{view.prefix}_{name}", *_types(kind, position_range.is_signed)))
    if positions is not None:
        names = [name for name in positions.names if name in _OF_POSITIONS]
        for name in names:
            if not name.endswith(("modulus", "position_difference")):
                types = _types(_OF_POSITIONS[name], positions.is_signed)
                of_positions.append(Numeric(f"{view.prefix}_{name}", *types))
    return [*(Numeric(function.name, function.type) for function in plain), *of_positions]


def crcs(view: DeviceView) -> dict[str, str]:
    """Return a function for each CRC of a frame. The CRC for a whole word takes the data with zeros for the CRC."""
    code_by_crc = {}
    for codec in view.interface.codecs:
        if codec.word_crc is not None:
            function = codec.word_crc
            code_by_crc[function.crc.name] = _crc(
                view, function.crc.name, "", f"{function.name}(number(text) << {function.crc.width}U)"
            )
    for crc in view.crcs:
        if crc.is_called:
            bits = f"({crc.data_type})number(text), 4U * (uint32_t)strlen(text)"
            argument_list = "b, bytes_of(text, b)" if crc.in_bytes else bits
            code_by_crc[crc.crc.name] = _crc(
                view, crc.crc.name, "uint8_t b[64]; " if crc.in_bytes else "", f"{crc.name}({argument_list})"
            )
    return code_by_crc


def _crc(view: DeviceView, name: str, fetch: str, call: str) -> str:
    return f"""static void crc_{name}({view.prefix} variant, char *text)
{{
    (void)variant;
    {fetch}printf("0 %llu\\n", (unsigned long long){call});
}}
"""


def _types(listed: tuple[str, ...], is_signed: bool) -> tuple[str, tuple[str, ...]]:
    return listed[0], tuple("int64_t" if is_signed else type_ for type_ in listed[1:])


def _call(view: DeviceView, function: Numeric, name: str) -> str:
    types = function.arguments
    argument_list = reads = ""
    for index, type_ in enumerate(types):
        convert = "strtoll" if type_ == "int64_t" else "strtoull"
        argument_list += f", ({type_}){convert}(item[{index}], NULL, 10)"
        reads += f'    item[{index}] = strtok({"text" if index == 0 else "NULL"}, " ");\n'
    show, cast = {"double": ("%.17g", "double"), "int64_t": ("%lld", "long long")}.get(
        function.type, ("%llu", "unsigned long long")
    )
    declare = f"    char *item[{len(types)}];\n" if types else ""
    return f"""static void measure_{name}({view.prefix} variant, char *text)
{{
{declare}    (void)text;
{reads}    printf("0 {show}\\n", ({cast}){function.name}(variant{argument_list}));
}}
"""


def _decoded(view: DeviceView, codec: StructCodec, verb: str, name: str, then: str) -> str:
    """Return a function that decodes, prints the result and, if there is no error, prints ``then`` of ``out``."""
    decode_arguments = answers(codec) + ("b, bytes_of(text, b)" if codec.layout_plan.in_bytes else word_of(codec))
    return f"""static void {verb}_{name}({view.prefix} variant, char *text)
{{
    {"" if not codec.layout_plan.in_bytes else "uint8_t b[64];"}
    {codec.type} out;
    cw_result result;
    memset(&out, 0x5A, sizeof out);
    result = {_too_high(codec)}{codec.name}_decode(variant, {decode_arguments}, &out);
    printf("%d", (int)result);
    if (result == CW_OK) {{
        {then}
    }}
    printf("\\n");
}}
"""


def _expected_branch(view: DeviceView, codec: StructCodec, name: str) -> str:
    then = f'printf(" %d", (int){codec.name}_is_expected(variant, &out));'
    return _decoded(view, codec, "expected", name, then)


def _report_branch(view: DeviceView, codec: StructCodec, name: str) -> str:
    assert codec.reports is not None
    verdict, reports = codec.reports.verdict_function, codec.reports.reports_function
    then = f'printf(" %d", (int){verdict}(variant, &out));' if verdict else 'printf(" -");'
    then += f' printf(" %llX", (unsigned long long){reports}(variant, &out));' if reports else ' printf(" -");'
    return _decoded(view, codec, "tells", name, then + _position(view, codec))


def _wrong_length(codec: StructCodec) -> str:
    """Return the frame of a wrong length, or an empty string if the type of its word holds no longer frame."""
    if codec.layout_plan.in_bytes:
        return "b, 0U"
    if codec.word_has_length:
        return "cw_word_of(~(uint64_t)0U, 64U)"
    return f"({codec.struct.number_type})~(uint64_t)0U" if codec.word_may_be_longer else ""


def _position(view: DeviceView, codec: StructCodec) -> str:
    """The short way gives the same verdict and position as the long one, and stores only usable positions."""
    if not codec.position_member:
        return ""
    decode_arguments = answers(codec) + ("b, bytes_of(text, b)" if codec.layout_plan.in_bytes else word_of(codec))
    wrong_length = _wrong_length(codec)
    refused = f"{codec.name}_position(variant, {answers(codec)}{wrong_length}, &position) == CW_NOT_USABLE"
    return f"""
        {codec.struct.member_type(codec.position_member)} position = 0x5A;
        const cw_verdict verdict = {codec.name}_position(variant, {decode_arguments}, &position);
        if (verdict != {codec.name}_verdict(variant, &out)
            || position != (verdict == CW_NOT_USABLE ? 0x5A : out.{c_name(codec.position_member)})) {{
            abort();
        }}
        if (!({refused if wrong_length else "true"})) {{
            abort();
        }}"""


def _text(view: DeviceView) -> str:
    return f"""static void text_of({view.prefix} variant, char *text)
{{
    const cw_report_text *const found = {view.reports.text_function}(({view.reports.mask_type})number(text));
    (void)variant;
    printf("\\"%s\\" \\"%s\\" \\"%s\\" \\"%s\\" \\"%s\\"\\n", found->name, found->printed_name, found->meaning,
           found->remedy, found->source);
}}
"""


def _candidates(view: DeviceView, identity: IdentityCode) -> str:
    reads, start = "", "text"
    for part in identity.compared_registers:
        name = c_name(part.register.name)
        reads += f'    bytes_of(strtok({start}, " "), b);\n    memcpy(read.{name}, b, sizeof read.{name});\n'
        start = "NULL"
    return f"""static void candidates_of({view.prefix} variant, char *text)
{{
    uint8_t b[64];
    {identity.prefix}_identity read;
    size_t next = 0U;
    const {view.prefix}_order_code *code;
    (void)variant;
{reads}    printf("0");
    while ((code = {identity.prefix}_next_candidate(&read, &next)) != NULL) {{
        printf(" %s", code->text);
    }}
    printf("\\n");
}}
"""


def _branch(verb: str, name: str) -> str:
    return f"""        if (strcmp(verb, "{verb}") == 0 && strcmp(name, "{name}") == 0) {{
            {verb}_{name}(variant, rest);
            continue;
        }}
"""


def _decode(view: DeviceView, codec: StructCodec, name: str) -> str:
    prints = "".join(map(_print, members(codec)))
    call = (
        f"{codec.name}_decode(variant, {answers(codec)}{word_of(codec)}, &out)"
        if not codec.layout_plan.in_bytes
        else f"{codec.name}_decode(variant, {answers(codec)}b, bytes_of(text, b), &out)"
    )
    return f"""static void decode_{name}({view.prefix} variant, char *text)
{{
    {"" if not codec.layout_plan.in_bytes else "uint8_t b[64];"}
    {codec.type} out;
    {codec.type} before;
    cw_result result;
    memset(&out, 0x5A, sizeof out);
    memset(&before, 0x5A, sizeof before);
    result = {call};
    printf("%d", (int)result);
    if (result != CW_OK) {{
        printf("%s\\n", memcmp(&out, &before, sizeof out) == 0 ? "" : " changed");
        return;
    }}
{prints}    printf("\\n");
}}
"""


def _print(member: Member) -> str:
    """Return C that prints a member of ``out``, with a text as its bytes."""
    if member.characters:
        text = ""
        for index in range(member.characters):
            space = " " if index == 0 else ""
            text += f'    printf("{space}%02X", (unsigned)(unsigned char)out.{member.name}[{index}]);\n'
        return text
    form, type_ = ("%lld", "long long") if member.type.startswith("int") else ("%llu", "unsigned long long")
    return f'    printf(" {form}", ({type_})out.{member.name});\n'


def _read(member: Member) -> str:
    """Return C that reads a member of ``in`` from ``item``."""
    if member.characters:
        return f"    bytes_of(item, c);\n    memcpy(in.{member.name}, c, sizeof in.{member.name});\n"
    if member.type == "bool":
        return f"    in.{member.name} = *item == '1';\n"
    convert = "strtoll" if member.type.startswith("int") else "strtoull"
    return f"    in.{member.name} = ({member.type}){convert}(item, NULL, 10);\n"


def _encode(view: DeviceView, codec: StructCodec, name: str) -> str:
    reads = ""
    for member in members(codec):
        reads += f'    item = strtok({"NULL" if reads else "text"}, " ");\n{_read(member)}'
    call = _encode_bytes(codec) if codec.layout_plan.in_bytes else _encode_word(codec)
    setters = "".join(_set_again(codec, set_name) for set_name in codec.set_names)
    return f"""static void encode_{name}({view.prefix} variant, char *text)
{{
    char *item;
    {"uint8_t c[64];" if any(member.characters for member in members(codec)) else ""}
    {codec.type} in;
    memset(&in, 0, sizeof in);
{reads}    {{
    {call}{setters}    }}
}}
"""


def _encode_word(codec: StructCodec) -> str:
    return f"""{codec.struct.number_type} word = 0U;
    const cw_result result = {codec.name}_encode(variant, {answers(codec)}&in, &word);
    printf("%d %llX\\n", (int)result, (unsigned long long)word);
"""


def _encode_bytes(codec: StructCodec) -> str:
    return f"""uint8_t b[{codec.length_macro}];
    size_t index;
    cw_result result;
    memset(b, 0, sizeof b);
    result = {codec.name}_encode(variant, {answers(codec)}&in, b, {codec.length_macro} + 1U);
    if (result != CW_FAULT_LENGTH) {{
        abort();
    }}
    result = {codec.name}_encode(variant, {answers(codec)}&in, b, sizeof b);
    printf("%d ", (int)result);
    for (index = 0U; index < sizeof b; index++) {{
        printf("%02X", b[index]);
    }}
    printf("\\n");
"""


def _set_again(codec: StructCodec, name: str) -> str:
    """Return C that sets a number to its own value, which must change nothing."""
    return f"""    {{
        const {codec.type} same = in;
        if ({codec.name}_set_{name}(variant, in.{c_name(name)}, &in) == CW_OK
            && result == CW_OK && memcmp(&same, &in, sizeof in) != 0) {{
            abort();
        }}
    }}
"""


_MARK = "/* answers */\n"
_HEAD = (
    r"""
#include "codewheel/transport.h"
@headers@#include <stdio.h>
#include <stdlib.h>
#include <string.h>
"""
    + _MARK
    + r"""
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

static void print_steps(cw_result result, const cw_step *steps, size_t count)
{
    size_t index;
    printf("%d", (int)result);
    for (index = 0U; index < count; index++) {
        printf(" %d,%u,%u,%u,%u,%lu", (int)steps[index].kind, steps[index].address, steps[index].mask,
               steps[index].value, steps[index].times, (unsigned long)steps[index].microseconds);
    }
    printf("\n");
}

"""
)

_ANSWER = r"""            if (strncmp(state, "@alternative@=", sizeof "@alternative@=" - 1U) == 0) {
                @type@_taken = (@type@)held[0];
                taken = 0;
            }
"""

_MEMBER = r"""            if (strncmp(state, "@alternative@=", sizeof "@alternative@=" - 1U) == 0) {
                variant.@parameter@ = (uint8_t)(held[0] != 0U); /* the first answer sets 0, others set 1 */
                taken = 0;
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
        @prefix@ variant;
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
@resets@        for (; state != NULL && *state != '\0'; state += strcspn(state, ";"), state += strspn(state, ";")) {
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
