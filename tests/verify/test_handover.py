"""The C folder alone: in an empty folder, each way of building it prints the numbers of the manual.

The expected lines are the worked examples of the AMM5 manual, 6.4. The preset 1,000,003 of a 21-bit model is 00 30 24
F4 00 00 00 in 11h to 17h, and is written with 40h open, then saved and activated with 77h. The serial number 0A E8 69
EE is year 18, week 30, number 3630.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from tools import tool

ROOT = Path(__file__).resolve().parents[2]

PRESET = """Set, save and activate a preset: position 1000003
  write 40: 01
  write 11: 00
  write 12: 30
  write 13: 24
  write 14: F4
  write 15: 00
  write 16: 00
  write 17: 00
  write 40: 00
  write 77: 01
  wait 30000 us
  write 77: 02
  wait 30000 us
Preset 11h: 00 30 24 F4 00 00 00
  multiturn: 0
  singleturn: 1000003
  position: 1000003
Serial number 44h: 0A E8 69 EE
  serial: 183003630
  year: 18
  week: 30
  number: 3630
Manufacturer ID 7Eh: 4C 69
  name: Li
"""

CMAKE = """cmake_minimum_required(VERSION 3.14)
project(user C)
{lines}
add_executable(user main.c)
target_link_libraries(user PRIVATE {maker}::encoders)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The C folder as it is handed over, without the rest of this project, in a path with a space."""
    return Path(shutil.copytree(ROOT / "generated" / "c", tmp_path / "handed over" / "c"))


@pytest.fixture
def user(folder: Path) -> Path:
    """An empty folder with the README's example."""
    user_folder = folder.parent / "user"
    user_folder.mkdir()
    shutil.copy(folder / "examples" / "amm5_biss.c", user_folder / "main.c")
    return user_folder


def run(*command: str | Path, cwd: Path, **environment: str) -> str:
    completed = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=300,
        env={"PATH": os.environ["PATH"], **environment},
    )
    assert completed.returncode == 0, completed.stdout[-2000:] + completed.stderr[-2000:]
    return completed.stdout


def prints(program: Path) -> None:
    """The program first prints a frame, for which the manual has no example, and then the manual's examples."""
    output = run(program, cwd=program.parent)
    assert output[output.index("Set,") :] == PRESET


def built_by_cmake(user: Path, lines: str, *options: str, maker: str = "lika") -> Path:
    cmake = tool("cmake")
    (user / "CMakeLists.txt").write_text(CMAKE.format(lines=lines, maker=maker))
    run(cmake, "-S", user, "-B", user / "build", "-Wdev", "-Werror=dev", *options, cwd=user)
    run(cmake, "--build", user / "build", cwd=user)
    return user / "build" / "user"


def test_a_plain_line(folder: Path) -> None:
    """The line of the README, run in the folder itself."""
    readme = (folder / "README.md").read_text()
    line = readme.split("```sh\n")[1].split("```")[0].strip()
    assert line == "cc -std=c99 -Iinclude examples/amm5_biss.c -o example && ./example"
    run("sh", "-c", line, cwd=folder)
    prints(folder / "example")


def test_cmake_with_the_folder_in_the_tree(folder: Path, user: Path) -> None:
    prints(built_by_cmake(user, 'add_subdirectory("../c" c)'))


def test_cmake_after_an_installation(folder: Path, user: Path, tmp_path: Path) -> None:
    cmake, prefix = tool("cmake"), tmp_path / "prefix"
    run(cmake, "-S", folder, "-B", tmp_path / "b", cwd=tmp_path)
    run(cmake, "--build", tmp_path / "b", cwd=tmp_path)
    run(cmake, "--install", tmp_path / "b", "--prefix", prefix, cwd=tmp_path)
    assert (prefix / "share" / "doc" / "lika-encoders" / "LICENSE").is_file()
    shutil.rmtree(folder)
    prints(built_by_cmake(user, "find_package(lika-encoders 0.1 REQUIRED)", f"-DCMAKE_PREFIX_PATH={prefix}"))


def test_cmake_with_the_folder_as_it_is(folder: Path, user: Path) -> None:
    prints(built_by_cmake(user, "find_package(lika-encoders 0.1.0 EXACT REQUIRED)", f"-DCMAKE_PREFIX_PATH={folder}"))


def test_cmake_refuses_a_version_to_come(folder: Path, user: Path) -> None:
    cmake = tool("cmake")
    (user / "CMakeLists.txt").write_text(CMAKE.format(lines="find_package(lika-encoders 9.0 REQUIRED)", maker="lika"))
    completed = subprocess.run(
        [cmake, "-S", str(user), "-B", str(user / "build"), f"-DCMAKE_PREFIX_PATH={folder}"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert completed.returncode != 0
    assert "version: 0.1.0" in completed.stderr


def test_the_examples_of_the_folder(folder: Path, tmp_path: Path) -> None:
    cmake = tool("cmake")
    run(cmake, "-S", folder, "-B", tmp_path / "b", "-DLIKA_ENCODERS_EXAMPLES=ON", cwd=tmp_path)
    run(cmake, "--build", tmp_path / "b", cwd=tmp_path)
    programs = sorted(path.stem for path in (folder / "examples").glob("*.c"))
    assert {name.rpartition("_")[2] for name in programs} == {"biss", "dma", "rs485", "ssi"}
    assert len(programs) == 15
    for name in programs:
        run(tmp_path / "b" / name, cwd=tmp_path)
    prints(tmp_path / "b" / "amm5_biss")


def test_the_self_test_of_the_folder(folder: Path, tmp_path: Path) -> None:
    """As a library for a user's program, and with ``ctest``."""
    cmake = tool("cmake")
    run(cmake, "-S", folder, "-B", tmp_path / "b", "-DLIKA_ENCODERS_SELFTEST=ON", cwd=tmp_path)
    run(cmake, "--build", tmp_path / "b", cwd=tmp_path)
    assert "100% tests passed, 0 tests failed out of 1" in run(
        cmake, "--build", tmp_path / "b", "--target", "test", cwd=tmp_path
    )
    project = tmp_path / "own"
    project.mkdir()
    (project / "main.c").write_text(
        '#include "selftest.h"\nint main(void) { return lika_amm5_biss_selftest() == 0U ? 0 : 1; }\n'
    )
    (project / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.14)\nproject(own C)\nset(LIKA_ENCODERS_SELFTEST ON)\n"
        f'add_subdirectory("{folder}" encoders)\nadd_executable(own main.c)\n'
        "target_link_libraries(own PRIVATE lika::selftest)\n"
    )
    run(cmake, "-S", project, "-B", project / "b", cwd=project)
    run(cmake, "--build", project / "b", cwd=project)
    run(project / "b" / "own", cwd=project)


@pytest.mark.parametrize("lines", ['add_subdirectory("../c" c)', "find_package(ichaus-encoders 0.1 REQUIRED)"])
def test_cmake_by_the_name_of_another_manufacturer(lines: str, folder: Path, user: Path) -> None:
    shutil.copy(folder / "examples" / "icmu_biss.c", user / "main.c")
    program = built_by_cmake(user, lines, f"-DCMAKE_PREFIX_PATH={folder}", maker="ichaus")
    assert "DEV_ID 78h: 4D 55 07 00 00 00\n" in run(program, cwd=user)


@pytest.mark.parametrize("installed", [False, True])
def test_pkg_config(installed: bool, folder: Path, user: Path, tmp_path: Path) -> None:
    where = folder
    if installed:
        cmake, where = tool("cmake"), tmp_path / "prefix"
        run(cmake, "-S", folder, "-B", tmp_path / "b", cwd=tmp_path)
        run(cmake, "--install", tmp_path / "b", "--prefix", where, cwd=tmp_path)
    flags = run(
        tool("pkg-config"),
        "--cflags",
        "--print-errors",
        "lika-encoders >= 0.1",
        cwd=user,
        PKG_CONFIG_PATH=str(where / "share" / "pkgconfig"),
    )
    # The flags are quoted for a shell.
    run("sh", "-c", f"eval cc -std=c99 '{flags.strip()}' main.c -o user", cwd=user)
    prints(user / "user")
    assert (
        run(
            tool("pkg-config"),
            "--modversion",
            "lika-encoders",
            cwd=user,
            PKG_CONFIG_PATH=str(where / "share" / "pkgconfig"),
        )
        == "0.1.0\n"
    )


def test_cpp_takes_the_headers(folder: Path, tmp_path: Path) -> None:
    """A C++ program on the same headers, with the manual's serial number."""
    (tmp_path / "main.cpp").write_text(
        r"""#include "lika/amm5_biss.h"
#include "lika/amm5_biss_registers.h"
#include <cstdio>
int main()
{
    const lika_amm5_biss encoder = LIKA_AMM5_BISS_A21_65KSC1;
    const uint8_t bytes[] = { 0x0A, 0xE8, 0x69, 0xEE };
    lika_amm5_biss_reg_serial_number serial;
    const cw_result result = lika_amm5_biss_reg_serial_number_decode(encoder, bytes, sizeof bytes, &serial);
    std::printf("%d %d %d %d\n", (int)result, serial.year, serial.week, (int)serial.number);
}
"""
    )
    run("c++", "-std=c++11", "-I", folder / "include", tmp_path / "main.cpp", "-o", tmp_path / "program", cwd=tmp_path)
    assert run(tmp_path / "program", cwd=tmp_path) == "0 18 30 3630\n"
