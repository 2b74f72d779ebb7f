"""Names in C: each is used once at file scope, and no name of a spec has another meaning in C, C++ or a header."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from c_harness import FAMILIES, RUNTIME, SHARED, text_of, write
from codewheel.commands.cli import main
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.targets import Library, TargetError
from codewheel.targets.c.device import views_of
from codewheel.targets.c.files import generate
from codewheel.targets.c.names import RESERVED, c_name
from exhaustive import mostly_exhaustive
from hostile_specs import BISS_CLOCK, HEAD, Item, crc, digits, flag, layout_of, sums
from uses import declared, use_everything
from working_tools import require

ROOT = Path(__file__).resolve().parents[2]
NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_exhaustive([*FAMILIES, "bits22", "reserved", "tv62", "words"], "amm5", "words"))
def test_every_name_is_given_out_once(name: str, every_device: Mapping[str, Device]) -> None:
    """The declarations in the text are the listed ones, so no clash is overlooked."""
    device = every_device[name]
    files = generate(Library((device,)))
    for view in views_of(device):
        names = Counter(declared(files[f"c/include/{header}"] for header in view.headers).names)
        assert set(names) == {path for path in view.names.path_by_name if not path.endswith(("_H", "_HPP"))}
        assert max(names.values()) == 1
        assert view.names.clashes == []
        begins = (f"{view.prefix}_", f"{view.PREFIX}_")
        assert all(name.startswith(begins) and not name.endswith("_") for name in names if name != view.prefix)


@pytest.mark.parametrize("path", sorted((RUNTIME / "codewheel").glob("*.h")), ids=lambda path: path.name)
def test_names_of_the_runtime_have_its_prefix(path: Path) -> None:
    """Therefore none of them can be a name of a family, and no list of them is needed."""
    names = declared([path.read_text(encoding="ascii")]).names
    assert [name for name in names if not name.startswith(("cw_", "CW_", "CODEWHEEL_"))] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cw", "codewheel"])
def test_no_manufacturer_has_a_name_of_the_runtime(name: str, every_device: Mapping[str, Device]) -> None:
    device = every_device["amm5"]
    renamed = replace(device, manufacturer=replace(device.manufacturer, name=name))
    with pytest.raises(TargetError, match=f"its C name {name} is already used by the headers; rename it"):
        generate(Library((renamed,)))


def test_a_member_that_begins_like_the_runtime_gets_an_underscore() -> None:
    assert c_name("cw_mask") == "cw_mask_"
    assert c_name("cwm") == "cwm"


def test_two_families_whose_names_meet(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Family ``a`` with a layout ``biss_c``, and family ``a_biss`` with a layout ``c``, all over BiSS."""
    text = (ROOT / "tests" / "specs" / "bits22.yaml").read_text()
    shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", tmp_path)
    layout = text.index("      - name: single_cycle_data\n")
    for device, name in (("a", "biss_c"), ("a_biss", "c")):
        again = text[layout:].replace("single_cycle_data\n", "another\n        channel: 2\n", 1)
        spec_text = (
            (text + again)
            .replace("device: bits22", f"device: {device}")
            .replace("- name: single_cycle_data\n", f"- name: {name}\n")
        )
        (tmp_path / f"{device}.yaml").write_text(
            re.sub(r"(pattern: \W*)", rf"\1{device.upper().replace('_', '')}X", spec_text)
        )
    assert main(["check", str(tmp_path)]) == 1
    problems = [line for line in capsys.readouterr().out.splitlines() if "c-name" in line]
    rows = (tmp_path / "a_biss.yaml").read_text().splitlines()
    line = next(number for number, row in enumerate(rows, 1) if "- name: c" in row)
    for ending in ("", "_bits", "_crc", "_decode", "_encode"):
        expected = (
            f"a_biss.yaml:{line}:9: c-name: its C name test_a_biss_biss_c{ending} "
            "is also that of the family 'a'; rename one of the two"
        )
        assert any(row.endswith(expected) for row in problems), problems


# -- reserved words


def macros(command: list[str], code: str) -> set[str]:
    """Return the macros without arguments that are defined after this text."""
    completed = subprocess.run([*command, "-dM", "-E", "-"], input=code, capture_output=True, text=True)
    return set(re.findall(r"^#define (\w+) ", completed.stdout, re.MULTILINE))


#: All headers of C but stdatomic.h, whose functions are macros without arguments in clang.
#: None of their names could be a member.
HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdbool
    stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype avr/io avr/interrupt
    avr/pgmspace util/delay
""".split()


@pytest.mark.slow
@pytest.mark.parametrize(
    "compiler", ["gcc", "clang", "avr-gcc", "arm-none-eabi-gcc", "riscv64-unknown-elf-gcc", "powerpc-linux-gnu-gcc"]
)
def test_macros_of_compilers_and_of_standard_headers_are_reserved(compiler: str) -> None:
    """Return those whose names a spec could have.

    A macro with arguments is harmless, because no name of a spec is followed by a parenthesis.
    """
    require([compiler])
    macro_names = macros([compiler, "-std=gnu11"], "")
    for header in HEADERS:
        macro_names |= macros([compiler, "-std=c11", "-DF_CPU=1000000UL"], f"#include <{header}.h>\n")
    lower = {name for name in macro_names if NAME.fullmatch(name)}
    assert {"bool", "true", "and_eq"} <= lower
    assert sorted(lower - RESERVED) == []


def test_no_reserved_word_is_a_name_with_an_underscore() -> None:
    assert all(word == word.strip("_") or word == "_t" for word in RESERVED)
    assert {"_BitInt", "_Bool"}.isdisjoint(RESERVED), "no name of a spec can be one of these"
    c23 = """
        alignas alignof bool constexpr false nullptr static_assert thread_local true typeof typeof_unqual restrict
        inline
    """
    cxx23 = """
        char8_t char16_t char32_t concept consteval constinit co_await co_yield co_return requires import module export
        template typename mutable explicit wchar_t
    """
    of_headers = "uint8_t int_least16_t uint_fast64_t size_t ptrdiff_t intmax_t uintptr_t errno"
    of_compilers = "near far min max interface linux unix small huge"
    assert set(f"{c23} {cxx23} {of_headers} {of_compilers}".split()) <= RESERVED


# -- hostile names


def own_words(header: str) -> set[str]:
    """Return the names of arguments, locals and members in a header, with which a name of a spec could clash."""
    code = re.sub(r'/\*.*?\*/|"(?:[^"\\]|\\.)*"', " ", header, flags=re.DOTALL)
    words = [word for word in re.findall(r"\b[a-z]\w*", code) if NAME.fullmatch(word)]
    return {word for word in words if not word.startswith(("lika_", "ichaus_", "cw_", "uint64_c"))}


def hostile(words: list[str]) -> Item:
    """A spec in which everything with a name in C is named by one of these words, in every way through the target.

    At file scope all names have a prefix, so they can only clash with each other.
    """
    read_words, set_by_code = words[:24], words[24:]
    sizes = {str(size): {"sets": {"width_of_it": size, **dict.fromkeys(set_by_code, size)}} for size in (2, 3)}
    kinds = {"SC": {"interface": "biss"}, "JP": {"interface": "rs485"}}
    return {
        **HEAD,
        "parameters": {
            "width_of_it": {"meaning": "Width"},
            **{word: {"meaning": "A word"} for word in set_by_code},
            **{word: {"meaning": "A word", "read_from": f"{word}.{word}", "min": 0, "max": 15} for word in read_words},
            **sums([f"own_sum_{index}" for index in range(-(-len(words) // 4))], words),
        },
        "order_code": {
            "pattern": "H{size}{kind}",
            "source": "1",
            "parts": [
                {"name": "size", "meaning": "Size", "values": sizes},
                {"name": "kind", "meaning": "Interface", "values": kinds},
            ],
        },
        "crcs": [*(crc(word, width=6, poly=3, xorout=0x3F) for word in words), crc("sum_8", width=8, poly=1, xorout=0)],
        "interfaces": {"biss": _biss(words), "rs485": _rs485(words)},
        "registers": _registers(words),
        "procedures": [*map(_procedure, set_by_code)],
        "timings": [{"name": word, "meaning": "Time", "at_least_us": 5, "source": "1"} for word in words],
    }


def _procedure(word: str) -> Item:
    return {
        "name": f"p_{word}",
        "title": "Procedure",
        "interface": "biss",
        "source": "1",
        "arguments": [{"name": word, "of": word, "meaning": "A value"}],
        "steps": [{"do": "write", "register": word, "value": word}],
    }


def _biss(words: list[str]) -> Item:
    """The words as flags, as fields at variable positions, as joins, and as decimal numbers and their parts."""
    moving = [{"name": word, "bits": "width_of_it"} for word in words[:6]]
    joins = {"joined_of_it": words[:3], **dict.fromkeys(words[6:], words[:2])}
    parts = (digits("number_of_it", word, "low_digits_of_it") for word in words[:12])
    numbers = (digits(word, "high_of_it", "low_of_it") for word in words)
    return {
        "source": "1",
        "clock": BISS_CLOCK,
        "layouts": [
            layout_of("l_flags", *(flag(word, "high") for word in words), {"name": "crc_of_all", "crc": words[0]}),
            layout_of("l_moving", *moving, {"name": "crc_of_all", "crc": words[-1]}, channel=2, join=joins),
            *(layout_of(f"l_digits_{index}", field, channel=3 + index) for index, field in enumerate(parts)),
            *(layout_of(f"l_{index}", field, channel=16 + index) for index, field in enumerate(numbers)),
        ],
    }


def _rs485(words: list[str]) -> Item:
    """The words as data IDs, and as bytes of their replies."""
    ids = {"purpose": "capture", "source": "1"}
    fields = [
        {"name": words[0], "bits": 8, "values_of": "data_ids"},
        *({"name": word, "bits": 8} for word in words[1:]),
    ]
    check = {"name": "check_of_it", "crc": "sum_8"}
    when = {words[0]: list(range(16))}
    return {
        "source": "1",
        "port": {"baud": 1000000, "data_bits": 8, "parity": "even", "stop_bits": 2, "source": "1"},
        "data_ids": [{"name": word, "id": id_, "control": id_, **ids} for id_, word in enumerate(words[:16])],
        "layouts": [layout_of("reply_bytes", *fields, check, byte_order="low_byte_first", when=when)],
    }


def _registers(words: list[str]) -> list[Item]:
    """Registers of one byte that hold parameters, of two bytes with a limit, and one that identifies the encoder."""
    values = {value: {"value": at} for at, value in enumerate(words[1:5])}
    one_byte = {"length": 1, "access": "read_write", "default": 0x30, "source": "1"}
    two = {"length": 2, "byte_order": "low_byte_first", "source": "1"}
    rest_of_byte = {"name": "rest_of_it", "at": "7:4", "equals": 3}
    bits = [{"name": word, "at": str(15 - index), "active": "high"} for index, word in enumerate(words[:16])]
    registers: list[Item] = []
    for index, word in enumerate(words[:24]):
        fields = [rest_of_byte, {"name": word, "at": "3:0", "values": values}]
        registers.append({"name": word, "address": index, **one_byte, "fields": fields})
    limited = {"access": "read_write", "max": "2^width_of_it"}
    for index, word in enumerate(words[24:]):
        field = {"name": word, "at": "15:0"}
        registers.append({"name": word, "address": 0x20 + 2 * index, **two, **limited, "fields": [field]})
    identity = {"name": "r_identity", "address": 0x60, **two, "access": "read_only", "fields": bits}
    return [*registers, identity]


def groups(every: Iterable[str], size: int) -> Iterator[list[str]]:
    """The words in groups of this size. The last one is filled up with the first words."""
    words = sorted(every)
    for start in range(0, len(words), size):
        yield [*words[start : start + size], *words[: max(0, size - len(words) + start)]]


def _words_of_c(include: Path) -> set[str]:
    """Return the words of C and of the headers that a spec may use as a name."""
    words = set(RESERVED).union(
        *(own_words(text_of(name, include)) for name in FAMILIES),
        *(own_words((include / "codewheel" / f"{name}.h").read_text()) for name in SHARED),
    )
    assert {
        "variant",
        "out",
        "in",
        "word",
        "bytes",
        "length",
        "uint8_t",
        "int",
        "class",
        "frame",
        "transport",
        "result",
        "read",
    } <= words
    #: Words that name something in every header, and are refused as names of layouts.
    #: see tests/check/broken_model/c_name_*.
    #: BiSS defines the meaning of error and warning.
    # read_identity reads the registers that identify an encoder.
    words -= {"variant", "error", "warning", "frame", "identity"} | {word for word in words if len(word) > 30}
    #: BiSS itself defines addresses for the registers with these names.
    of_biss = {"device_id", "manufacturer_id", "profile_id", "serial_number"} & words
    return words - of_biss | {f"{word}s" for word in of_biss}


@pytest.mark.slow
@pytest.mark.parametrize("are_first", mostly_exhaustive([True, False], True))
def test_no_name_of_a_spec_is_one_that_c_or_a_header_has(are_first: bool, include: Path, tmp_path: Path) -> None:
    """The first words are tried with others than the rest."""
    words = _words_of_c(include)
    # The first word is also the field that distinguishes frames. The second round uses the other words for registers,
    # parameters and procedures.
    word_groups = [sorted(group, key=lambda word: word not in ("frame", "bytes", "int")) for group in groups(words, 40)]
    rounds = [*word_groups, *([*group[20:], *group[:20]] for group in word_groups)]
    for index, group in enumerate(rounds[:1] if are_first else rounds[1:]):
        folder = tmp_path / str(index)
        folder.mkdir()
        shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", folder)
        (folder / "hostile.yaml").write_text(json.dumps(hostile(group), indent=1))
        devices, report = load_library([folder / "hostile.yaml"])
        assert [problem.format() for problem in report.problems] == []
        headers = write(folder, devices)
        names = [header for view in views_of(devices[0]) for header in view.headers]
        (folder / "unit.c").write_text(use_everything(names, headers))
        for command in (["gcc", "-std=gnu2x"], ["g++", "-x", "c++", "-std=gnu++2b"]):
            strict = ["-Wall", "-Wextra", "-Wshadow", "-Werror", "-fsyntax-only"]
            arguments = [*command, *strict, f"-I{headers}", str(folder / "unit.c")]
            compilation = subprocess.run(arguments, capture_output=True, text=True)
            assert compilation.returncode == 0, compilation.stderr[:3000]


@pytest.mark.slow
def test_no_register_is_called_like_a_function_of_the_example(tmp_path: Path) -> None:
    """The program reads and prints each register with a worked example in a function of its own."""
    words = ["frame", "registers", "procedure", "main", "encoder", "transport", "register", "sizeof"]
    text = (ROOT / "tests" / "specs" / "bits22.yaml").read_text()
    registers = examples = ""
    for index, word in enumerate(words):
        registers += f'  - {{name: {word}, address: {index}, length: 1, access: read_only, source: "1"}}\n'
        examples += (
            f'  - {{name: e_{word}, kind: register, register: {word}, source: "1",'
            f' bytes: "0{index}", values: {{{word}: {index}}}}}\n'
        )
    text += f"registers:\n{registers}examples:\n{examples}"
    (tmp_path / "bits22.yaml").write_text(text)
    shutil.copy(ROOT / "tests" / "specs" / "manufacturer.yaml", tmp_path)
    devices, report = load_library([tmp_path])
    assert [problem.format() for problem in report.problems] == []
    include = write(tmp_path, devices)
    for command in (["gcc", "-std=c99"], ["g++", "-x", "c++", "-std=c++11"]):
        program = str(tmp_path / command[0])
        compilation = subprocess.run(
            [
                *command,
                "-Wall",
                "-Wextra",
                "-Werror",
                f"-I{include}",
                str(tmp_path / "c" / "examples" / "bits22_biss.c"),
                "-o",
                program,
            ],
            capture_output=True,
            text=True,
        )
        assert compilation.returncode == 0, compilation.stderr[:3000]
        printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
        assert all(f"value: {index}\n" in printed for index in range(len(words)))
