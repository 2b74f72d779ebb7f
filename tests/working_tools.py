"""Programs that tests run. A tool that is present but cannot do its job counts as missing, with the reason.

A compiler may lack the headers and libraries of C or the runtime of its sanitizers, which are packages of their own.
Each program is therefore tried once per test run, with a tiny example of its job.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import pytest

#: How each tool is installed on Debian 12.
PACKAGES = {
    "gcc": "apt-get install gcc libc6-dev",
    "cc": "apt-get install gcc libc6-dev",
    "g++": "apt-get install g++",
    "c++": "apt-get install g++",
    "clang": "apt-get install clang libclang-rt-14-dev llvm",
    "clang++": "apt-get install clang libclang-rt-14-dev llvm",
    "llvm-cov": "apt-get install llvm",
    "llvm-profdata": "apt-get install llvm",
    "objdump": "apt-get install binutils",
    "nm": "apt-get install binutils",
    "cppcheck": "apt-get install cppcheck",
    "arm-none-eabi-gcc": "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi",
    "arm-none-eabi-nm": "apt-get install binutils-arm-none-eabi",
    "qemu-system-arm": "apt-get install qemu-system-arm",
    "powerpc-linux-gnu-gcc": "apt-get install gcc-powerpc-linux-gnu libc6-dev-powerpc-cross",
    "qemu-ppc-static": "apt-get install qemu-user-static",
    "riscv64-unknown-elf-gcc": "apt-get install gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
    "avr-gcc": "apt-get install gcc-avr avr-libc",
    "avr-g++": "apt-get install gcc-avr avr-libc",
    "simavr": "apt-get install simavr",
    "cbmc": "tests/verify/get-cbmc .cbmc (and apt-get install cryptominisat)",
    "cryptominisat5": "apt-get install cryptominisat",
    "verilator": "apt-get install verilator",
    "cmake": "apt-get install cmake",
    "doxygen": "apt-get install doxygen",
    "pkg-config": "apt-get install pkg-config",
    "sdcc": "apt-get install sdcc",
    "s51": "apt-get install sdcc-ucsim",
    "sstm8": "apt-get install sdcc-ucsim",
    "chromium": "apt-get install chromium",
    "node": "apt-get install nodejs",
    "rustc": "apt-get install rustc rust-clippy",
    "clippy-driver": "apt-get install rustc rust-clippy",
}
#: Folder with the result of each trial, which the processes of a test run share. Set by ``conftest.py``.
results: Path | None = None

_C = '#include <stdint.h>\n#include <stdio.h>\nint main(void) { return puts("it works") < 0; }\n'
_CXX = '#include <cstdint>\n#include <cstdio>\nint main() { return std::puts("it works") < 0; }\n'
_FUZZER = """#include <stddef.h>
#include <stdint.h>
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { (void)data; (void)size; return 0; }
"""
#: A page whose text has a width and a height only with fonts.
_PAGE = "<p><span>it works</span><script>const span = document.querySelector('span'); \
document.title = span.offsetWidth * span.offsetHeight > 100 ? 'drawn' : 'empty';</script>"
#: The newest parts of the language that the page and its tests use.
_SCRIPT = "const box = {}; box.a ??= 'xx'; if (box?.a.replaceAll('x', 'y') !== 'yy' || 2n ** 64n < 1n) process.exit(1);"
_RUST = 'fn main() { println!("it works"); }\n'
#: Options with which cross compilers find their headers, where they need any.
_CROSS = {
    "arm-none-eabi-gcc": ["-mcpu=cortex-m4", "-mthumb"],
    "avr-gcc": ["-mmcu=atmega328p"],
    "avr-g++": ["-mmcu=atmega328p"],
    "riscv64-unknown-elf-gcc": ["--specs=picolibc.specs"],
}


def require(command: Sequence[str], folders: Sequence[str] = ()) -> str:
    """Return the path of the program of a command that can do its job.

    Otherwise, skip the test, or fail it with ``CODEWHEEL_REQUIRE_TOOLS=1``. ``folders`` are searched before ``PATH``.
    """
    __tracebackhide__ = True  # pytest reports the place of the test.
    name, *options = command
    path = shutil.which(name, path=os.pathsep.join([*folders, os.environ.get("PATH", "")]))
    words = f"no {name} here"
    if path:
        sanitizers = tuple(option for option in options if option.startswith("-fsanitize="))
        is_cxx = name.endswith("++") or "c++" in options
        words = problem(path, Path(name).name, sanitizers, is_cxx)
        if not words:
            return path
    message = f"{words}, so this is not shown; {PACKAGES.get(Path(name).name, 'install it')}"
    if os.environ.get("CODEWHEEL_REQUIRE_TOOLS"):
        pytest.fail(message)
    pytest.skip(message)


@cache
def problem(path: str, name: str, sanitizers: tuple[str, ...] = (), is_cxx: bool = False) -> str:
    """Return why a program cannot do its job, or an empty string."""
    if results is None:
        return _tried(path, name, sanitizers, is_cxx)
    key = hashlib.sha256(repr((path, name, sanitizers, is_cxx)).encode()).hexdigest()[:32]
    result_file = results / key
    if not result_file.exists():
        results.mkdir(parents=True, exist_ok=True)
        partial_file = results / f"{key}-{os.getpid()}"
        partial_file.write_text(_tried(path, name, sanitizers, is_cxx), encoding="utf-8")
        partial_file.replace(result_file)
    return result_file.read_text(encoding="utf-8")


def _tried(path: str, name: str, sanitizers: tuple[str, ...], is_cxx: bool) -> str:
    """Try the job of a program, and return why it failed, or an empty string."""
    with tempfile.TemporaryDirectory() as folder:
        if name in ("gcc", "g++", "cc", "c++", "clang", "clang++"):
            return _compiles(path, name, Path(folder), sanitizers, is_cxx)
        if name.endswith(("-gcc", "-g++")):
            return _compiles_for_another_machine(path, name, Path(folder))
        trial = _TRIALS.get(name)
        return trial(path, Path(folder)) if trial is not None else ""


def _compiles(path: str, name: str, folder: Path, sanitizers: tuple[str, ...], is_cxx: bool) -> str:
    """Compile, link and run a program with these sanitizers."""
    is_fuzzer = any("fuzzer" in option for option in sanitizers)
    source, program = folder / ("trial.cpp" if is_cxx else "trial.c"), folder / "trial"
    program_text = _CXX if is_cxx else _C
    source.write_text(_FUZZER if is_fuzzer else program_text, encoding="utf-8")
    language = ["-x", "c++"] if is_cxx else []
    with_options = f" with {' '.join(sanitizers)}" if sanitizers else ""
    failed = f"{name} cannot compile and link a program{with_options}"
    error = _error(failed, [path, *sanitizers, *language, str(source), "-o", str(program)])
    if error:
        return error
    run = [str(program), "-runs=1"] if is_fuzzer else [str(program)]
    return _error(f"{name} compiles a program{with_options} that does not run", run)


def _compiles_for_another_machine(path: str, name: str, folder: Path) -> str:
    """Compile a unit that includes the headers of C."""
    source = folder / ("trial.cpp" if name.endswith("++") else "trial.c")
    source.write_text("#include <stdint.h>\n#include <string.h>\nint unused;\n", encoding="utf-8")
    command = [path, *_CROSS.get(name, []), "-c", str(source), "-o", str(folder / "trial.o")]
    return _error(f"{name} cannot compile with the headers of C", command)


def _draws(path: str, folder: Path) -> str:
    """Start Chromium with a page, and look whether its text is drawn."""
    (folder / "trial.html").write_text(_PAGE, encoding="utf-8")
    options = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--no-first-run",
        f"--user-data-dir={folder / 'user'}",
    ]
    command = [path, *options, "--dump-dom", (folder / "trial.html").as_uri()]
    try:
        completed = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=120)
    except (OSError, subprocess.TimeoutExpired):
        return "chromium does not start"
    if completed.returncode or "<title>" not in completed.stdout:
        return "chromium does not start"
    return "" if "<title>drawn</title>" in completed.stdout else "chromium has no fonts"


def _runs_scripts(path: str, folder: Path) -> str:
    return _error("node is too old or does not start", [path, "-e", _SCRIPT])


def _links_rust(path: str, folder: Path) -> str:
    (folder / "trial.rs").write_text(_RUST, encoding="utf-8")
    command = [path, str(folder / "trial.rs"), "-o", str(folder / "trial")]
    return _error("rustc cannot compile and link a program", command)


def _starts(path: str, folder: Path) -> str:
    """Ask for the version. The system reports with 126 or 127 that it cannot start a program or find its libraries."""
    return _error(f"{Path(path).name} does not start", [path, "--version"], lambda code: code < 0 or code in (126, 127))


_TRIALS: dict[str, Callable[[str, Path], str]] = {
    "chromium": _draws,
    "chromium-browser": _draws,
    "google-chrome": _draws,
    "node": _runs_scripts,
    "rustc": _links_rust,
    **dict.fromkeys(
        "cmake doxygen cppcheck verilator cbmc cryptominisat5 qemu-system-arm qemu-ppc-static objdump nm sdcc "
        "pkg-config llvm-cov clippy-driver arm-none-eabi-nm".split(),
        _starts,
    ),
}


def _error(failed: str, command: Sequence[str], is_failure: Callable[[int], bool] = bool) -> str:
    """Return the words with the first error of a command, or an empty string if it succeeds."""
    try:
        completed = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=120)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"{failed} ({type(error).__name__})"
    if not is_failure(completed.returncode):
        return ""
    lines = [line.strip() for line in (completed.stderr + completed.stdout).splitlines() if line.strip()]
    first = next((line for line in lines if "error" in line.lower()), lines[0] if lines else "no message")
    return f"{failed} ({first[:200]})"
