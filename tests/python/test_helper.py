"""Compiled loops give what NumPy gives, for every layout; those of another generation are refused."""

from __future__ import annotations

import importlib
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy
import pytest
from test_agreement import ALL, FAMILIES, Family, families, family, given
from test_many import by_layout, numbers

__all__ = ["families", "family"]
pytestmark = pytest.mark.slow

FRAMES = 6_000


def parts_of(family: Family) -> tuple[Any, Any]:
    """The modules of a package that make the helper and use it."""
    package = family.module.__name__.rpartition(".")[0]
    return importlib.import_module(f"{package}.build_helper"), importlib.import_module(f"{package}._helper")


def needs_a_compiler() -> None:
    name = os.environ.get("CC", "cc").split()[0]
    if shutil.which(name) is None:
        pytest.skip(f"no C compiler '{name}' here, so the compiled helper is not tried; apt-get install gcc")


@pytest.fixture
def helper(family: Family, tmp_path: Path) -> Iterator[Any]:
    needs_a_compiler()
    build, use = parts_of(family)
    library = build.build(tmp_path / "helper.so")

    def switch(on: bool) -> None:
        use.use(library if on else None)

    yield switch
    switch(False)


@pytest.mark.parametrize("family", ALL, indirect=True)
def test_compiled_loops_give_what_numpy_gives(family: Family, helper: Any) -> None:
    source, use = random.Random(f"helper {family.device.name}"), parts_of(family)[1]
    for found in by_layout(family).values():
        for case in found:
            made = numbers(case, max(40, FRAMES // len(found)), source)
            wire = b"".join(map(case.carried, made)) if case.layout.in_bytes else numpy.array(made, numpy.uint64)
            helper(False)
            expected = case.view.decode_many(wire, *given(case))
            helper(True)
            table = case.view.decode_many(wire, *given(case))
            assert (table.fault == expected.fault).all(), case.layout.name
            sound = table.ok
            for name in expected:
                rows = slice(None) if name in ("fault", "verdict") else sound
                assert table[name].dtype == expected[name].dtype
                assert (table[name][rows] == expected[name][rows]).all(), (case.layout.name, name)
    # Our own families leave nothing to NumPy.
    left = [shape for shape in shapes_of(family) if use.steps_of(shape) is None]
    assert not left or family.device.name not in FAMILIES


def shapes_of(family: Family) -> list[Any]:
    package, _, name = family.module.__name__.rpartition(".")
    module: Any = importlib.import_module(f"{package}._shapes.{name}")
    found = []
    for layout, cases in by_layout(family).items():
        found += [getattr(module, f"shape_of_{layout}")(*given(case)) for case in cases[:3]]
    return found


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 2_047, 2_048, 2_049, 10_000])
def test_nothing_is_read_beyond_the_frames(family: Family, helper: Any, count: int) -> None:
    """Rows of every length, at the very end of what there is."""
    helper(True)
    serial = family.module.lookup("AMM5A23/65KJP1")
    for kind in (family.module.DataRequest, family.module.SingleturnReply, family.module.CompleteReply):
        length = kind.decode_many([], *([serial] if "variant" in kind._fields else [])).fault.size
        assert length == 0
    rows = numpy.frombuffer(bytes.fromhex("02 00 C7 D1 6A 7E") * count, numpy.uint8).reshape(-1, 6)
    table = serial.decode_many(rows, family.module.SingleturnReply)
    assert not table.fault.any()
    assert (table["singleturn"] == 7000519).all()
    every_other = numpy.repeat(rows, 2, 0)[::2]
    assert (serial.decode_many(every_other, family.module.SingleturnReply)["singleturn"] == 7000519).all()


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_another_generation_is_refused(family: Family, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    needs_a_compiler()
    build, use = parts_of(family)
    with pytest.raises(use.HelperError, match=r"python -m lika_encoders.build_helper makes it"):
        use.use(tmp_path / "none.so")
    (tmp_path / "text.so").write_text("no library", encoding="utf-8")
    with pytest.raises(use.HelperError, match="no helper of this package"):
        use.use(tmp_path / "text.so")
    monkeypatch.setattr(build, "generation", lambda: "0123456789abcdef")
    old = build.build(tmp_path / "old.so")
    with pytest.raises(use.HelperError, match="of the generation 0123456789abcdef"):
        use.use(old)
    assert importlib.import_module("lika_encoders._many").HELPER is None


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_without_a_compiler_it_says_so(family: Family, tmp_path: Path) -> None:
    package = Path(family.module.__file__).parent.parent
    command = [sys.executable, "-m", "lika_encoders.build_helper", "-o", str(tmp_path / "x.so")]
    setting = {**os.environ, "CC": "no-such-compiler", "PYTHONPATH": str(package)}
    done = subprocess.run(command, capture_output=True, text=True, env=setting)
    assert done.returncode == 1
    assert "there is no C compiler 'no-such-compiler'" in done.stderr


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_c_compiles_without_a_word(family: Family, tmp_path: Path) -> None:
    needs_a_compiler()
    source = parts_of(family)[1].SOURCE
    warnings = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-qual -Werror".split()
    command = [os.environ.get("CC", "cc"), "-std=c99", *warnings, '-DGENERATION="x"', "-c", str(source)]
    done = subprocess.run([*command, "-o", str(tmp_path / "x.o")], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
