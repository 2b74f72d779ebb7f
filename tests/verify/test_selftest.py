"""The self-test as a user builds it, on each machine. It returns 0, or another number if a header was changed."""

from __future__ import annotations

from pathlib import Path

import pytest
from c_harness import devices_of, write
from claims import planted
from machines import HOST, MACHINES, Machine

#: Prints the result. The machine without a system has its own stdio.
_MAIN = """
#include <stdio.h>
int main(void) { printf("%lu\\n", (unsigned long)lika_selftest()); return 0; }
"""


@pytest.fixture(scope="module")
def include(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("selftest"), devices_of())


def failed_checks(machine: Machine, include: Path, tests: Path, folder: Path) -> int:
    """The self-test in one unit. The static functions of each file get names of their own."""
    text = ""
    for path in sorted(tests.glob("*.c")):
        names = ("is_text", "are_bytes", "writes", "written", *(f"check_{number}" for number in range(1, 80)))
        text += "".join(f"#define {name} {path.stem}_{name}\n" for name in names)
        text += f'#include "{path}"\n' + "".join(f"#undef {name}\n" for name in names)
    return int(machine.compile_main(text + _MAIN, folder, include, "selftest")(b""))


@pytest.mark.parametrize("machine", [HOST, *MACHINES], ids=[machine.name for machine in (HOST, *MACHINES)])
def test_all_is_well_on_every_machine(machine: Machine, include: Path, tmp_path: Path) -> None:
    assert failed_checks(machine, include, include.parent / "selftest", tmp_path) == 0


def test_a_change_is_told_on_a_machine_without_a_system(include: Path, tmp_path: Path) -> None:
    machine = next(machine for machine in MACHINES if machine.bare)
    broken = planted(include, "tracker.h", "forward += modulus;", "forward += 1U;", tmp_path)
    assert failed_checks(machine, broken, include.parent / "selftest", tmp_path) == 8002
