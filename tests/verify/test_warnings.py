"""The headers compile under every standard of C and C++ from C99 and C++11 on, with all warnings of gcc and clang."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import pytest
from tools import tool
from uses import declared, use_everything, without_nodiscard, without_texts

#: Each standard by its name, and its name in older compilers.
C = (("c99",), ("c11",), ("c17",), ("c23", "c2x"))
CXX = (("c++11",), ("c++14",), ("c++17",), ("c++20",), ("c++23", "c++2b"))
COMPILERS = [
    *(("gcc", names) for names in C),
    *(("clang", names) for names in C),
    *(("g++", names) for names in CXX),
    *(("clang++", names) for names in CXX),
]

#: All of gcc's that are not a matter of taste: no -Wpadded, -Winline, -Waggregate-return, -Wsystem-headers,
#: and none about names of the C++ ABI.
GCC = """
    -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wfloat-conversion -Warith-conversion -Wdouble-promotion
    -Wcast-qual -Wcast-align=strict -Wshadow -Wundef -Wredundant-decls -Wmissing-declarations -Wswitch-default
    -Wswitch-enum -Wformat=2 -Wlogical-op -Wduplicated-cond -Wduplicated-branches -Wnull-dereference -Wfloat-equal
    -Wwrite-strings -Wpointer-arith -Wvla -Wunused -Wunused-const-variable=2 -Wstrict-overflow=2 -Wstrict-aliasing=2
    -Warray-bounds=2 -Wshift-overflow=2 -Wstack-usage=1024 -Wdate-time -Wunused-macros -Wtrampolines
    -Wdisabled-optimization -Werror
""".split()
GCC_C = """
    -Wstrict-prototypes -Wmissing-prototypes -Wold-style-definition -Wnested-externs -Wbad-function-cast -Wc++-compat
    -Wjump-misses-init
""".split()
GCC_CXX = """
    -Wextra-semi -Wctor-dtor-privacy -Woverloaded-virtual -Wnoexcept -Wsign-promo -Wstrict-null-sentinel
    -Wcomma-subscript -Wredundant-tags
""".split()

#: Exclusions from clang's -Weverything, with reasons.
#: There is no other such list, apart from the exclusions for gcc above.
NOT_WANTED = {
    "declaration-after-statement": "a rule of C90; C99 lets a value be const that needs a check before it",
    "padded": "no struct is sent or stored as it lies in memory, so that padding in it says nothing",
    "covered-switch-default": "contradicts MISRA C:2012 16.4, which wants a default in every switch",
    "unsafe-buffer-usage": "wants containers of C++ in place of arrays",
    "pre-c2x-compat": "an older standard is wanted to work and is compiled by itself",
}
NOT_WANTED_CXX = {
    "c++98-compat": "results have to be looked at by the word that C++17 has for it, where it is C++17",
    "old-style-cast": "C has no other cast, and the headers are C",
    "zero-as-null-pointer-constant": (
        "C has no nullptr before C23, and this is NULL as the compiler's own stddef.h defines it"
    ),
}
#: Options that exist only in newer versions. Older ones would warn about unknown options.
_UNKNOWN = "-Wno-unknown-warning-option"

#: The default form of the CRCs, and the other forms that a macro selects.
FORMS = (
    (),
    ("-DLIKA_CRC_TABLE", "-DTEST_CRC_TABLE", "-DTOLVARN_CRC_TABLE"),
    ("-DLIKA_CRC_BITWISE", "-DTEST_CRC_BITWISE", "-DTOLVARN_CRC_BITWISE"),
)


@cache
def standard(compiler: str, names: tuple[str, ...]) -> str:
    """Return the option for the first of these names that the compiler knows."""
    for name in names:
        language = "c++" if name.startswith("c++") else "c"
        if (
            subprocess.run(
                [compiler, f"-std={name}", "-x", language, "-fsyntax-only", "-"],
                input="",
                text=True,
                capture_output=True,
            ).returncode
            == 0
        ):
            return f"-std={name}"
    pytest.skip(f"{compiler} does not know {names[0]}")


def options(compiler: str, names: tuple[str, ...]) -> list[str]:
    cxx = compiler.endswith("++")
    chosen = [tool(compiler), standard(compiler, names), "-x", "c++" if cxx else "c"]
    if not compiler.startswith("clang"):
        return [*chosen, *GCC, *(GCC_CXX if cxx else GCC_C)]
    left_out = {**NOT_WANTED, **(NOT_WANTED_CXX if cxx else {})}
    return [*chosen, "-Weverything", "-Werror", _UNKNOWN, *(f"-Wno-{name}" for name in left_out)]


def compiled(command: Sequence[str], code: str, folder: Path, include: Path, *more: str) -> Path:
    """Return the object compiled from this text, without any message."""
    text, object_file = folder / "unit.c", folder / "unit.o"
    text.write_text(code, encoding="ascii")
    completed = subprocess.run(
        [*command, f"-I{include}", *(more or ("-O2",)), "-c", str(text), "-o", str(object_file)],
        capture_output=True,
        text=True,
    )
    assert completed.returncode == 0, completed.stderr[:6000]
    assert not completed.stderr, completed.stderr[:6000]
    return object_file


@pytest.mark.parametrize(
    ("compiler", "names"), COMPILERS, ids=lambda value: value if isinstance(value, str) else value[0]
)
def test_no_warning(compiler: str, names: tuple[str, ...], headers: tuple[Path, list[str]], tmp_path: Path) -> None:
    """The oldest and the newest standard compile all headers, the oldest in all forms. Others only read them."""
    include, header_names = headers
    command = options(compiler, names)
    is_end = names in (C[0], C[-1], CXX[0], CXX[-1])
    for form in FORMS if names in (C[0], CXX[0]) else FORMS[:1]:
        how = "-O2" if is_end else "-fsyntax-only"
        compiled(command, use_everything(header_names, include), tmp_path, include, how, *form)
    for header in header_names if is_end else ():
        # Alone and unused, as the first of a file, and a second time.
        compiled(
            command,
            f'#include "{header}"\n#include "{header}"\ntypedef int some_declaration;\n',
            tmp_path,
            include,
            "-fsyntax-only",
        )


@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++", "clang++"])
def test_every_header_can_be_used_alone(compiler: str, headers: tuple[Path, list[str]], tmp_path: Path) -> None:
    include, names = headers
    command = options(compiler, CXX[0] if compiler.endswith("++") else C[0])
    for header in names:
        compiled(command, use_everything([header], include), tmp_path, include, "-fsyntax-only")


@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++", "clang++"])
def test_no_macro_leaks(compiler: str, headers: tuple[Path, list[str]], tmp_path: Path) -> None:
    """The headers define only the macros of three standard headers and their own, which have the family's prefix."""
    include, names = headers
    language = "c++" if compiler.endswith("++") else "c"

    def macros(code: str) -> set[str]:
        command = [tool(compiler), "-x", language, "-dM", "-E", f"-I{include}", "-"]
        return set(
            re.findall(
                r"^#define (\w+)",
                subprocess.run(command, input=code, capture_output=True, text=True, check=True).stdout,
                re.MULTILINE,
            )
        )

    every_one = "".join(f'#include "{header}"\n' for header in names if header.startswith("codewheel/"))
    standard = macros("#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n")
    runtime = macros(every_one) - standard
    assert all(macro.startswith(("CW_", "CODEWHEEL_")) for macro in runtime)
    for header in names:
        if not header.startswith("codewheel/"):
            maker, name = header.removesuffix(".h").upper().split("/")
            name = re.sub("_(LABELS|REPORTS|REGISTERS|PROCEDURES|SIMULATE)$", "", name)
            family_macros = macros(f'#include "{header}"\n') - standard - runtime
            assert family_macros
            assert all(macro.startswith(f"{maker}_{name}_") for macro in family_macros)


def test_only_the_three_headers_of_the_standard_are_included(headers: tuple[Path, list[str]]) -> None:
    include, names = headers
    lines = [line.strip() for header in names for line in (include / header).read_text().splitlines()]
    used = {line for line in lines if re.match(r"#\s*include", line)}
    assert {line for line in used if "<" in line} == {f"#include <std{name}.h>" for name in ("bool", "def", "int")}


#: The macros that identify compilers, and unaligned loads on Arm, which decide how an XOR of bytes is written.
#: SDCC returns no structures.
_COMPILER = r"__(GNUC__|SDCC\b|ARM_FEATURE_UNALIGNED\b)"
#: The only built-in functions are functions for words of memory, used where a macro says that they exist, and the
#: function that keeps C++17 from using them at compile time.
_PREDEFINED = (
    _COMPILER
    + r"|__(ARM_FEATURE_(UNALIGNED|CLZ)|(BYTE_)?ORDER(_LITTLE_ENDIAN)?__|builtin_(memcpy|bswap32|bswap64|clz|clzll))"
    + r"|__builtin_is_constant_evaluated\b"
)


def test_only_plain_c_is_used(headers: tuple[Path, list[str]]) -> None:
    """No extension, bit-field, packing, union, goto, allocation or variable argument, and portable directives.

    The mark for results that must not be ignored is spelt as the compiler requires, and is tested separately.
    """
    include, names = headers
    for header in names:
        code = without_nodiscard(without_texts((include / header).read_text(encoding="ascii")))
        directives = set(re.findall(r"^\s*#\s*(\w+)", code, re.MULTILINE))
        assert directives <= {"include", "define", "if", "ifndef", "ifdef", "elif", "else", "endif", "error"}
        code = re.sub(_PREDEFINED, "", code) if header == "codewheel/receive.h" else re.sub(_COMPILER, "", code)
        assert not re.findall(
            r"__(?!cplusplus\b)\w+|\b_Pragma|\basm\b|\bunion\b|\bgoto\b|\bmalloc\b|\.\.\.|\bvolatile\b|\brestrict\b|//",
            code,
        ), header
        assert not re.findall(r"^\s+(?:unsigned|signed|bool|u?int\d+_t) \w+ ?: ?\d+;", code, re.MULTILINE), header


#: A compiler may use these for an assignment of a struct or of zeros, whatever the source says,
#: and a freestanding one must provide them.
INSERTED = {"memcpy", "memset", "memmove", "memcmp"}


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_no_function_of_a_library_is_needed(compiler: str, headers: tuple[Path, list[str]], tmp_path: Path) -> None:
    include, names = headers
    object_file = compiled(
        [tool(compiler), "-std=c99", "-x", "c"],
        use_everything(names, include),
        tmp_path,
        include,
        "-Os",
        "-ffreestanding",
        "-fno-pic",
        "-fno-stack-protector",
    )
    symbol_list = subprocess.run(
        [tool("nm"), "-u", str(object_file)], capture_output=True, text=True, check=True
    ).stdout
    needed = {line.split()[-1] for line in symbol_list.splitlines()}
    assert needed <= INSERTED, sorted(needed)
    defined = subprocess.run(
        [tool("nm"), "--defined-only", str(object_file)], capture_output=True, text=True, check=True
    ).stdout
    assert "use_cw_mask" in defined, "a header has no data that can be written"
    assert not re.search(r" [BDbd] ", defined), "a header has no data that can be written"


def test_no_function_calls_itself(headers: tuple[Path, list[str]]) -> None:
    """Every function calls only functions that are defined above it, so there is no recursion."""
    include, header_names = headers
    for header in header_names:
        code = without_texts((include / header).read_text(encoding="ascii"))
        # A macro calls functions that are above it.
        code = re.sub(r"^#define(?:.*\\\n)*.*\n", "", code, flags=re.MULTILINE)
        names = [name for _, name, _ in declared([code]).functions]
        # A macro behind a function may call it.
        code = re.sub(r"^#define (?:.*\\\n)*.*\n", "", code, flags=re.MULTILINE)
        parts = re.split(r"^static inline [\w \*]+?\w+\([^()]*\)\s*\{", code, flags=re.MULTILINE)[1:]
        assert len(parts) == len(names)
        for index, body in enumerate(parts):
            assert not set(re.findall(r"\b(\w+)\(", body)) & set(names[index:]), (header, names[index])
