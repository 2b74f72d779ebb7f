"""The headers as text and as code: no strict warnings in C and C++ for any spec, and always the same text."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping
from functools import reduce
from operator import xor
from pathlib import Path

import pytest
from c_harness import (
    FAMILIES,
    MADE_UP,
    RUNTIME,
    SHARED,
    compile_c,
    compile_programs,
    devices_of,
    headers_of,
    text_of,
    write,
)
from codewheel.commands.cli import main
from codewheel.model import Biss, Device, Ssi
from codewheel.targets import Library, TargetError
from codewheel.targets.c.comments import break_lines, comment, end_comment, in_comment
from codewheel.targets.c.device import views_of
from codewheel.targets.c.files import generate
from codewheel.targets.c.names import RESERVED, c_name, string
from exhaustive import mostly_exhaustive
from hostile_texts import TEXTS, spoilt
from uses import without_texts
from working_tools import require

ROOT = Path(__file__).parents[2]

COMPILERS = [
    ["gcc", "-std=c99"],
    ["gcc", "-std=c11"],
    ["gcc", "-std=c17"],
    ["g++", "-x", "c++", "-std=c++11"],
    ["g++", "-x", "c++", "-std=c++17"],
    ["clang", "-std=c99"],
    ["clang", "-x", "c++", "-std=c++11"],
    ["clang", "-x", "c++", "-std=c++17"],
]


@pytest.mark.slow
@pytest.mark.parametrize("optimised", mostly_exhaustive(["-O0", "-O2"], "-O2"))
@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[0], COMPILERS[-1]), ids=" ".join)
def test_no_warning_for_any_word_of_the_language(
    command: list[str], optimised: str, tmp_path: Path, words: Device
) -> None:
    require(command)
    compile_programs([*command, optimised], words, tmp_path, write(tmp_path, (words,)), link=False)


@pytest.mark.slow
def test_no_warning_for_a_whole_unused_byte(tmp_path: Path) -> None:
    """Its bits are the lowest of the member, which has more than 8."""
    specs = ROOT / "tests" / "check" / "ok_model"
    (device,) = devices_of(specs / "spare.yaml", specs / "manufacturer.yaml")
    compile_programs(["gcc", "-std=c99"], device, tmp_path, write(tmp_path, (device,)), link=False)
    assert "bytes[3] = (uint8_t)in->unused;" in text_of("spare", tmp_path / "c" / "include")


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    mostly_exhaustive(
        [["gcc", "-std=c99", "-O2"], ["g++", "-x", "c++", "-std=c++17", "-O0"], ["clang", "-std=c99", "-O0"]],
        ["gcc", "-std=c99", "-O2"],
    ),
    ids=" ".join,
)
@pytest.mark.parametrize("name", mostly_exhaustive([*FAMILIES, "banks"], "amm5"))
def test_no_warning_for_any_family(
    name: str, command: list[str], tmp_path: Path, every_device: Mapping[str, Device]
) -> None:
    """This also holds if the register that selects banks follows those in its banks, in the order of a data sheet."""
    require(command)
    device = every_device[name]
    compile_programs(command, device, tmp_path, write(tmp_path, (device,)), link=False)


@pytest.mark.slow
@pytest.mark.parametrize("command", mostly_exhaustive(COMPILERS, COMPILERS[0]), ids=" ".join)
def test_a_header_alone_and_unused_has_no_warning(
    command: list[str], c_devices: tuple[Device, ...], include: Path, tmp_path: Path
) -> None:
    require(command)
    headers = [header for device in c_devices for view in views_of(device) for header in view.headers]
    assert len(headers) > 40
    for header in headers:
        compile_c(
            command, f'#include "{header}"\n#include "{header}"\nint main(void) {{ return 0; }}\n', tmp_path, include
        )


@pytest.mark.slow
def test_only_the_three_headers_of_the_standard_are_used(include: Path) -> None:
    lines = [line for path in include.rglob("*.h") for line in path.read_text().splitlines()]
    include_lines = {line for line in lines if line.startswith("#include")}
    standard_includes = {f"#include <std{name}.h>" for name in ("bool", "def", "int")}
    assert {line for line in include_lines if "<" in line} == standard_includes
    shared_includes = {f'#include "codewheel/{name}.h"' for name in SHARED}
    runtime_includes = {f'#include "{path.name}"' for path in (include / "codewheel").iterdir()}
    manufacturers = sorted(set(FAMILIES.values()))
    family_includes = set[str]()
    for name in manufacturers:
        family_includes |= {f'#include "{name}/{path.name}"' for path in (include / name).iterdir()}
    assert {line for line in include_lines if "<" not in line} <= shared_includes | runtime_includes | family_includes


@pytest.mark.parametrize("family", FAMILIES)
def test_names_have_their_prefix(family: str, every_device: Mapping[str, Device], include: Path) -> None:
    for interface in every_device[family].interfaces:
        paths = [path for path in headers_of(family, include) if path.stem.startswith(f"{family}_{interface.name}")]
        assert len(paths) >= 3
        prefix = f"{FAMILIES[family]}_{family}_{interface.name}"
        names_have_their_prefix(prefix, "".join(path.read_text() for path in paths))


def names_have_their_prefix(prefix: str, header: str) -> None:
    text = without_texts(header)
    macros = re.findall(r"^#define (\w+)", text, re.MULTILINE)
    functions = re.findall(r"^static inline [\w \*]+?\b(\w+)\(", text, re.MULTILINE)
    types = re.findall(r"^typedef (?:struct|enum) (\w+)", text, re.MULTILINE)
    assert all(name.startswith(f"{prefix.upper()}_") for name in macros)
    assert all(name.startswith(f"{prefix}_") for name in functions + types if name != prefix)
    codes = re.findall(rf"^static CW_CONST {prefix} (\w+) = ", text, re.MULTILINE)
    assert codes
    assert all(name.startswith(f"{prefix.upper()}_") for name in codes)
    names = macros + functions + types + codes
    # C99 guarantees that 63 characters distinguish names.
    assert len(names) == len(set(names)) == len({name[:63] for name in names})


def test_nothing_runs_over_the_page_or_ends_in_a_space(include: Path) -> None:
    for path in include.rglob("*.h"):
        lines = path.read_text(encoding="ascii").splitlines()
        too_long = [line for line in lines if len(line) > 100 and "http" not in line]
        assert too_long == []
        assert [line for line in lines if line != line.rstrip() or "\t" in line] == []
        assert "\n\n\n" not in path.read_text()


def test_no_version_date_or_path(include: Path, c_devices: tuple[Device, ...]) -> None:
    dates = {device.manual.date for device in c_devices}
    for path in include.parent.rglob("*"):
        if path.is_file():
            assert not re.search(r"/work|\.yaml|\.jinja|codewheel \d", path.read_text())
            assert set(re.findall(r"20[23]\d-\d\d-\d\d", path.read_text())) <= dates


_README_MAIN = """#include <stdio.h>
#include <string.h>
static uint8_t memory[0x80];
int32_t bus_read(void *context, uint16_t address, uint8_t *bytes, size_t length)
{
    (void)context;
    printf("r %02X %d\\n", (unsigned)address, (int)length);
    for (; length > 0U; length--) {
        bytes[length - 1U] = memory[address + length - 1U];
    }
    return 0;
}
int32_t bus_write(void *context, uint16_t address, const uint8_t *bytes, size_t length)
{
    (void)context;
    memory[address] = bytes[0];
    printf("w %02X %02X\\n", (unsigned)address, (unsigned)bytes[0]);
    return length == 1U && address != 0x77U ? 0 : -5;
}
int32_t bus_wait(void *context, uint32_t microseconds)
{
    (void)context;
    return microseconds == 0U ? 1 : 0;
}
int main(void)
{
    static const uint8_t ssi_sent[] = { @ssi@ }, reply_sent[] = { @reply@ };
    uint64_t position = 0U;
    lika_amm5_rs485_complete_reply reply;
    cw_failure failure = { 0U, CW_STEP_READ, CW_STEP_READ, 0U, 0, false };
    printf("%d %lu\\n", (int)decode_frame(cw_word_of(0xFBU, 45U), &position), (unsigned long)position);
    /* 1,000,003 with error and warning active, with the warning alone, and with neither; the CRC is right each time. */
    printf("%d %lu\\n", (int)decode_frame(cw_word_of(0xF424316U, 45U), &position), (unsigned long)position);
    position = 0U;
    printf("%d", (int)decode_frame(cw_word_of(0xF424390U, 45U), &position));
    printf(" %lu\\n", (unsigned long)position);
    position = 0U;
    printf("%d", (int)decode_frame(cw_word_of(0xF4243D3U, 45U), &position));
    printf(" %lu\\n", (unsigned long)position);
    printf("%d", (int)decode_frame(cw_word_of(@biss@U, 45U), &position));
    printf(" %lu\\n", (unsigned long)position);
    printf("%d", (int)ssi_position(&position));
    (void)memcpy(ssi_rx[0], ssi_sent, sizeof ssi_sent);
    (void)memcpy(ssi_rx[1], ssi_sent, sizeof ssi_sent);
    printf(" %d", (int)ssi_position(&position));
    printf(" %lu", (unsigned long)position);
    ssi_rx[1][1] ^= 1U;
    printf(" %d\\n", (int)ssi_position(&position));
    printf("%d %d", (int)read_encoder(&position), (int)rs485_ask(0U));
    for (unsigned index = 0U; index < sizeof reply_sent; index++) {
        printf(" %d", (int)rs485_received(reply_sent[index], &reply));
    }
    printf(" %lu\\n", (unsigned long)reply.position);
    printf("%d", (int)set_up(&failure));
    printf(" %d %02X %d\\n", (int)failure.step, (unsigned)failure.address, (int)failure.error);
    return 0;
}
"""


@pytest.mark.slow
def test_the_readme_compiles_and_prints(include: Path, tmp_path: Path) -> None:
    readme = (include.parent / "README.md").read_text()
    code = re.findall(r"```c\n(.*?)```", readme, re.DOTALL)
    assert len(code) == 7
    # The 1 before an SSI word, 39 bits, and zeros. A reply of AMM5 7.3 after a foreign byte: turn 1, ENID 23h, XOR.
    sent_words = {"ssi": (1 << 39 | 42 << 23 | 6016277) << 8, "biss": 0x55BCD15E2}
    reply = bytes((0x1A, 0x00, *(7000519).to_bytes(3, "little"), 0x23, 1, 0, 0, 0))
    reply = b"\xff" + reply + bytes([reduce(xor, reply)])
    main = _README_MAIN.replace("@ssi@", ", ".join(map(str, sent_words["ssi"].to_bytes(6, "big")))).replace(
        "@biss@", hex(sent_words["biss"])
    )
    main = main.replace("@reply@", ", ".join(map(str, reply)))
    assert f"word `0x{sent_words['biss']:X}` from that program, `decode_frame` stores {42 << 21 | 1821973}." in readme
    program = compile_c(["gcc", "-std=c99"], "".join(code) + main, tmp_path, include)
    written = ("11 00", "12 30", "13 24", "14 F4", "15 00", "16 00", "17 00")
    read = [f"r {line[:2]} 1" for line in written]
    accesses = ["w 40 01", *(f"w {line}" for line in written), *read, "w 40 00", "w 77 01"]
    preset = "".join(f"{access}\n" for access in accesses)
    snippets = f"1 {42 << 21 | 1821973}\n0 1 {42 << 23 | 6016277} 0\n0 1 {'0 ' * 11}1 {1 << 23 | 7000519}\n"
    # The serial number is read, the manual's preset is written and read back, and the command fails in step 16 with
    # -5, the bus's own error.
    assert (
        subprocess.run([str(program)], capture_output=True, text=True).stdout
        == f"0 0\n0 0\n0 0\n1 1000003\n{snippets}r 44 4\n{preset}5 16 77 -5\n"
    )


@pytest.mark.slow
def test_a_constant_variant_costs_nothing(include: Path, tmp_path: Path) -> None:
    """If the order code is chosen at compile time, neither a variant nor a call remains in the object."""
    require(["objdump"])
    code = """#include "lika/amm5_biss.h"
#define encoder LIKA_AMM5_BISS_A21_65KSC1
uint64_t position(uint64_t word);
uint64_t position(uint64_t word)
{
    lika_amm5_biss_frame frame;
    return lika_amm5_biss_decode(encoder, cw_word_of(word, 45U), &frame) == CW_OK ? frame.position : UINT64_MAX;
}
"""
    compile_c(["gcc", "-std=c99", "-O2"], code, tmp_path, include, link=False)
    listing = subprocess.run(
        ["objdump", "-dr", str(tmp_path / "program.o")], capture_output=True, text=True, check=True
    ).stdout
    assert "encoder" not in listing
    assert "call" not in listing


def code_without_spaces(text: str) -> str:
    """Return the code of a header, with normalised spaces and joined string literals."""
    return re.sub(r'""(?: "")+', '""', " ".join(without_texts(text).split()))


HOSTILE = "x */ int y; /* z \" ' \\ ??/ \n # error // é µ \u202e %s {{ 1 }} */*/ /*/ \\"
MORE_TEXTS = frozenset(
    """
    rule_text control_data_note address_text data url section revision date trademarks low high when_unused
    """.split()
)


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
def test_text_of_a_spec_stays_text(
    name: str, every_device: Mapping[str, Device], include: Path, tmp_path: Path
) -> None:
    hostile = spoilt(every_device[name], HOSTILE, (TEXTS | MORE_TEXTS) - {"only"})  # It narrows the headers.
    assert isinstance(hostile, Device)
    assert hostile.title == HOSTILE
    assert HOSTILE in {source.section for register in hostile.registers for source in register.layout.source}
    folder = write(tmp_path, (hostile,))
    assert code_without_spaces(text_of(name, folder)) == code_without_spaces(text_of(name, include))
    includes = "".join(f'#include "{FAMILIES[name]}/{path.name}"\n' for path in headers_of(name, folder))
    for standard in ("-std=c99", "-std=c17"):
        compile_c(["gcc", standard, "-trigraphs"], f"{includes}int main(void) {{ return 0; }}\n", tmp_path, folder)


@pytest.mark.parametrize(
    "text", ["*/", "/*", "*/*", "/*/", "**//", "??/", "???/", "a\\", "\\*/", "*\\/", "a\nb */ c", "\u202e*/"]
)
def test_no_text_ends_a_comment(text: str) -> None:
    for printed in (
        comment(text),
        comment([("lead */", text)]),
        break_lines(f"int x;{end_comment(text)}\n"),
        comment(text + " " + "word " * 40 + text),
    ):
        inner = printed.replace("int x;", "").strip()
        assert inner.startswith("/*")
        assert inner.endswith("*/")
        assert not re.search(r"\*/|/\*", inner[2:-2])
        assert "??" not in inner
        assert "\\" not in inner
    assert "\n" not in in_comment(text)


def test_strings_are_escaped() -> None:
    assert string('a"b\\c??/\n\x00é') == r'"a\042b\134c\077\077/\012\000\303\251"'


def test_reserved_words_get_an_underscore() -> None:
    assert {"register", "class", "interface", "constexpr", "typeof", "near"} <= RESERVED
    assert c_name("class") == "class_"
    assert c_name("position") == "position"
    assert c_name("word", {"word"}) == "word_"


@pytest.mark.slow
def test_a_spec_whose_names_are_reserved_compiles(tmp_path: Path) -> None:
    text = (ROOT / "tests" / "specs" / "bits22.yaml").read_text()
    for old, new in (
        ("position_bits", "int"),
        ("{name: position,", "{name: register,"),
        ("{name: error,", "{name: word,"),
        ("{name: warning,", "{name: near,"),
    ):
        text = text.replace(old, new)
    (tmp_path / "bits22.yaml").write_text(text)
    shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", tmp_path)
    (device,) = devices_of(tmp_path / "bits22.yaml")
    folder = write(tmp_path, (device,))
    header = (folder / "test" / "bits22_biss.h").read_text()
    assert "uint8_t int_;" in header
    assert "uint32_t register_;" in header
    assert "bool near_;" in header
    for command in (["gcc", "-std=c99"], ["g++", "-x", "c++", "-std=c++17"]):
        compile_programs(command, device, tmp_path, folder, link=False)


@pytest.mark.slow
def test_files_and_their_places(c_devices: tuple[Device, ...]) -> None:
    files = generate(Library(c_devices))
    assert {"c/README.md", "c/include/codewheel/encoder.h", "c/include/lika/amm5_biss.h"} <= set(files)
    for path in (RUNTIME / "codewheel").iterdir():
        assert files[f"c/include/codewheel/{path.name}"] == path.read_text(encoding="ascii"), "copied unchanged"


@pytest.mark.parametrize("family", FAMILIES)
def test_every_register_alarm_and_limit_is_there(
    family: str, every_device: Mapping[str, Device], include: Path
) -> None:
    device, upper = every_device[family], f"{FAMILIES[family]}_{family}".upper()
    text = text_of(family, include)
    for register in device.registers:
        stem = f"{upper}_{register.interface.upper()}_REG_{register.name.upper()}"
        assert f"#define {stem}_ADDRESS 0x{register.address:02X}U" in text
        assert f"#define {stem}_LENGTH {register.length}U" in text
        assert f"#define {stem}_ACCESS CW_ACCESS_{register.access.upper()}" in text
        assert register.default is None or f"#define {stem}_DEFAULT" in text
    for alarm in device.alarms:
        if alarm.group or alarm.register:
            assert re.search(rf"{upper}_[A-Z0-9]+_ALARM_{alarm.name.upper()}_MASK", text)
        assert (alarm.printed_name or alarm.name) in text
    for interface in device.interfaces:
        if isinstance(interface, (Ssi, Biss)):
            assert f"{upper}_{interface.name.upper()}_CLOCK_MAX_HZ {interface.clock.max_hz}U" in text
    comments = " ".join(re.sub(r"\n *\*", " ", text).split())
    used = {f"crcs.{crc.name}" for _, layout in device.layouts() for crc in device.crcs_of(layout)}
    for erratum in device.errata:
        # The headers do not compute a CRC that is in no frame, such as the CRC of a memory.
        parts = {path.split(".")[0] for path in erratum.affects if path in used or not path.startswith("crcs.")}
        if erratum.severity != "wording" and parts & {
            "registers",
            "procedures",
            "crcs",
            "alarms",
            "order_code",
            "parameters",
            "interfaces",
            "field_groups",
            "measurement",
        }:
            # The other errata, and differences from other editions, are only in ERRATA-lika.md.
            title = erratum.title.replace("µ", "u")
            assert (f"Erratum: {title} (" in comments) == (not erratum.edition), erratum.name


_CONSTANTS_C = """#include "lika/amm5_biss.h"
#include "lika/amm5_biss_registers.h"
#include "lika/amm5_rs485.h"
#include "lika/amm5_rs485_reports.h"
#include "lika/amm5_ssi.h"
#include <stdio.h>
int main(void)
{
    const lika_amm5_biss variants[3] = {
        LIKA_AMM5_BISS_A17_65KSC1, LIKA_AMM5_BISS_A21_65KSC1, LIKA_AMM5_BISS_B23_1SC1
    };
    static const uint8_t id[6] = { 0x41, 0x4D, 0x4D, 0x35, 0x01, 0x02 };
    static const uint8_t other[6] = { 0x41, 0x4D, 0x4D, 0x36, 0x01, 0x02 };
    lika_amm5_biss_reg_device_id device;
    unsigned index;
    printf("%lu %lu %lu %lu", (unsigned long)lika_amm5_biss_timeout_ns(50000U),
           (unsigned long)lika_amm5_biss_timeout_ns(200000U),
           (unsigned long)lika_amm5_biss_timeout_ns(10000000U), (unsigned long)lika_amm5_biss_timeout_ns(0U));
    printf(" %lu %lu %lu", (unsigned long)lika_amm5_ssi_clock_limit_hz(49U),
           (unsigned long)lika_amm5_ssi_clock_limit_hz(50U),
           (unsigned long)lika_amm5_ssi_clock_limit_hz(400U));
    for (index = 0U; index < 3U; index++) {
        printf(" %u %llx %llx", (unsigned)lika_amm5_biss_reg_preset_singleturn_shift(variants[index]),
               (unsigned long long)lika_amm5_biss_reg_preset_singleturn_mask(variants[index]),
               (unsigned long long)lika_amm5_biss_reg_preset_max(variants[index]));
    }
    if (lika_amm5_biss_reg_device_id_decode(variants[0], id, sizeof id, &device) == CW_OK) {
        printf(" %d %x", (int)lika_amm5_biss_reg_device_id_is_expected(variants[0], &device), device.release);
    }
    if (lika_amm5_biss_reg_device_id_decode(variants[0], other, sizeof other, &device) == CW_OK) {
        printf(" %d", (int)lika_amm5_biss_reg_device_id_is_expected(variants[0], &device));
    }
    printf(" %x %x\\n", LIKA_AMM5_RS485_ALARM_BATTERY_ALARM_MASK, LIKA_AMM5_RS485_CONTROL_ALL_DATA);
    return 0;
}
"""


@pytest.mark.slow
def test_constants_and_small_functions(include: Path, tmp_path: Path) -> None:
    """A compiled program checks timeouts, cable lengths, masks that depend on an order code, and expected texts."""
    command = ["gcc", "-std=c99", "-fsanitize=undefined", "-fno-sanitize-recover"]
    program = compile_c(command, _CONSTANTS_C, tmp_path, include)
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    assert printed == [
        "30000",
        "7500",
        "150",
        "0",
        "400000",
        "300000",
        "0",
        "16",
        "1ffff0000",
        "1ffffffff",
        "12",
        "1fffff000",
        "1fffffffff",
        "10",
        "1fffffc00",
        "7fffff",
        "1",
        "102",
        "0",
        "80",
        "1a",
    ]


@pytest.mark.slow
def test_another_encoder_id_is_decoded_and_not_as_expected(include: Path, tmp_path: Path) -> None:
    """AMM5 7.4 p.43 prints ENID 23h. T-format encoders of 23 bits usually have 17h."""
    code = """#include "lika/amm5_rs485.h"
#include <stdio.h>
int main(void)
{
    const lika_amm5_rs485 encoder = LIKA_AMM5_RS485_A23_65KJP1;
    static uint8_t other[11] = { 0x1A, 0x00, 0xA5, 0xA5, 0x00, 0x17, 0x88, 0x88, 0x00, 0x00, 0x0D };
    static const uint8_t alone[4] = { 0x92, 0x00, 0x23, 0xB1 };
    lika_amm5_rs485_complete_reply reply;
    lika_amm5_rs485_encoder_id_reply id;
    printf("%d", (int)lika_amm5_rs485_complete_reply_decode(encoder, other, sizeof other, &reply));
    printf(" %lx %x %x", (unsigned long)reply.singleturn, (unsigned)reply.multiturn, (unsigned)reply.encoder_id);
    printf(" %d", (int)lika_amm5_rs485_complete_reply_is_expected(encoder, &reply));
    printf(" %d", (int)lika_amm5_rs485_encoder_id_reply_decode(encoder, alone, sizeof alone, &id));
    printf(" %d", (int)lika_amm5_rs485_encoder_id_reply_is_expected(encoder, &id));
    other[0] ^= 0x01U;
    other[10] ^= 0x01U;
    printf(" %d\\n",
           (int)lika_amm5_rs485_complete_reply_decode(encoder, other, sizeof other, &reply) == CW_FAULT_CONSTANT);
    return 0;
}
"""
    program = compile_c(["gcc", "-std=c99", "-fsanitize=undefined", "-fno-sanitize-recover"], code, tmp_path, include)
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    assert printed == ["0", "a5a5", "8888", "17", "0", "0", "1", "1"]


@pytest.mark.slow
def test_labels_of_edition_1_1_are_found(include: Path, tmp_path: Path) -> None:
    """AM36 manual, edition 1.1 p.21: AMx36xx/4096SCx-...; SMA21 cover: SMA21 -BGx-..., with a blank."""
    expected = {
        "AM3616/4096SC1": "AM3616/4096-I7", "amc3619/4096-SC-x": "AMC3619/4096-I7", "AM3616/4096BG2": "AM3616/4096-BG",
        "AM3616/4096SCX": "-", "AM3616/4096I7": "-",
    }  # fmt: skip
    calls = ""
    for label in expected:
        calls += f'    code = lika_am36_biss_find_order_code("{label}", &unlisted);\n'
        calls += f'    other = lika_am36_ssi_find_order_code("{label}", &unlisted);\n'
        calls += '    puts(code != NULL ? code->text : other != NULL ? other->text : "-");\n'
    code = f"""#include "lika/am36_biss_labels.h"
#include "lika/am36_ssi_labels.h"
#include "lika/sma21_ssi_labels.h"
#include <stdio.h>
int main(void)
{{
    uint32_t unlisted = 0U;
    const lika_am36_biss_order_code *code;
    const lika_am36_ssi_order_code *other;
    const lika_sma21_ssi_order_code *blank;
{calls}    blank = lika_sma21_ssi_find_order_code(" SMA21 -BG1-0050 ", &unlisted);
    puts(blank == NULL ? "-" : blank->text);
    return 0;
}}
"""
    program = compile_c(["gcc", "-std=c99", "-fsanitize=undefined", "-fno-sanitize-recover"], code, tmp_path, include)
    printed = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    assert printed == [*expected.values(), "SMA21-BG1-0050"]


@pytest.mark.slow
def test_what_c_cannot_express_has_its_place_and_stops_no_other_target(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A text that does not begin at a byte."""
    text = (ROOT / "tests" / "c" / "specs" / "words.yaml").read_text()
    old = '      - {name: text, bits: 96, text: ascii, equals: "A?b/*\\\\c\\"d??/"}\n'
    assert old in text
    text = text.replace(
        old,
        "      - {name: head, at: 95:92}\n      - {name: text, at: 91:4, text: ascii}\n      - {name: tail, at: 3:0}\n",
    )
    (tmp_path / "words.yaml").write_text(text)
    shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", tmp_path)
    assert main(["generate", str(tmp_path), "--target", "c", "-o", str(tmp_path / "out")]) == 1
    rows = (tmp_path / "words.yaml").read_text().splitlines()
    line = next(number for number, row in enumerate(rows, 1) if "{name: text, at: 91:4" in row)
    message = (
        f"words.yaml:{line}:9: c-target: the text 'text' does not begin at a byte boundary, which the C target does not"
        " support; "
        "use 'generate --target' to write the other outputs\n"
    )
    assert message in capsys.readouterr().err
    assert main(["check", str(tmp_path)]) == 1
    assert message in capsys.readouterr().out
    assert main(["generate", str(tmp_path), "-o", str(tmp_path / "out")]) == 1
    assert not (tmp_path / "out").exists()
    assert main(["generate", str(tmp_path), "--target", "python", "-o", str(tmp_path / "out")]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["python"]


def test_the_target_raises_nothing_else() -> None:
    assert issubclass(TargetError, ValueError)
    for path in (ROOT / "generator" / "targets").glob("c*.py"):
        assert "raise ValueError" not in path.read_text()


#: May be ignored, because the tracker stores its result.
MAY_BE_LEFT = {"cw_tracker_add"}


def test_no_result_can_be_dropped_unseen(include: Path) -> None:
    """Each function that returns a result is marked, so that compilers warn if it is ignored."""
    plain, marked = set(), set()
    for path in include.rglob("*.h"):
        text = without_texts(path.read_text(encoding="ascii"))
        for match in re.finditer(
            r"^(CW_NODISCARD[ \n])?(?:CW_CONSTEXPR\n)?static inline cw_result\s+(\w+)\(", text, re.MULTILINE
        ):
            (marked if match[1] else plain).add(match[2])
    assert plain == MAY_BE_LEFT
    assert len(marked) > 100


def test_what_a_register_can_hold_fits_into_the_variant() -> None:
    """The field scale: a byte in which 0 means 256, without a maximum. Its default needs fewer bits."""
    files = generate(Library(devices_of(MADE_UP["shapes"])))
    header = next(text for path, text in files.items() if path.endswith("/shapes_biss.h"))
    assert "    uint16_t scale;\n" in header
