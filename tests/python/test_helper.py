"""Compiled loops give what NumPy gives, for every layout; those of another generation are refused."""

from __future__ import annotations

import importlib
import os
import random
import re
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
README = Path(__file__).parents[2] / "generated" / "python" / "README.md"


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
    """What switches the helper on and off; on, it tells for each table whether the helper made it."""
    needs_a_compiler()
    build, use = parts_of(family)
    library = build.build(tmp_path / "helper.so", encoders=tried(family))
    package: Any = importlib.import_module(family.module.__name__.rpartition(".")[0] + "._many")

    def switch(on: bool) -> list[bool]:
        use.use(library if on else None)
        taken: list[bool] = []
        loops = package.HELPER

        def watched(*arguments: Any) -> bool:
            taken.append(loops(*arguments))
            return taken[-1]

        package.HELPER = watched if on else None
        return taken

    yield switch
    switch(False)


def tried(family: Family) -> list[Any]:
    """The encoders of all cases, with registers that hold this and that."""
    return list(dict.fromkeys(case.made for found in by_layout(family).values() for case in found))


@pytest.mark.parametrize("family", ALL, indirect=True)
def test_compiled_loops_give_what_numpy_gives(family: Family, helper: Any) -> None:
    source = random.Random(f"helper {family.device.name}")
    for found in by_layout(family).values():
        for case in found:
            made = numbers(case, max(40, FRAMES // len(found)), source)
            wire = b"".join(map(case.carried, made)) if case.layout.in_bytes else numpy.array(made, numpy.uint64)
            helper(False)
            expected = case.view.decode_many(wire, *given(case))
            taken = helper(True)
            table = case.view.decode_many(wire, *given(case))
            # Our own families leave nothing to NumPy.
            assert taken == [True] or family.device.name not in FAMILIES
            assert (table.fault == expected.fault).all(), case.layout.name
            sound = table.ok
            for name in expected:
                rows = slice(None) if name in ("fault", "verdict") else sound
                assert table[name].dtype == expected[name].dtype
                assert (table[name][rows] == expected[name][rows]).all(), (case.layout.name, name)


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_frames_of_other_encoders_are_left_to_numpy(family: Family, tmp_path: Path) -> None:
    needs_a_compiler()
    build, use = parts_of(family)
    many: Any = importlib.import_module("lika_encoders._many")
    one = build.build(tmp_path / "one.so", encoders=["AMM5A23/65KJP1"])
    assert 0 < build.source(["AMM5A23/65KJP1"]).count("CHOSEN void") < build.source().count("CHOSEN void")
    use.use(one)
    try:
        loops, taken = many.HELPER, []
        many.HELPER = lambda *arguments: bool(taken.append(loops(*arguments))) or taken[-1]
        table = family.module.lookup("AMM5A21/65KSC1").decode_many([0x0123456789])
        assert len(table.fault) == 1
        family.module.DataRequest.decode_many(b"\x02")
        assert taken == [False, True]
    finally:
        use.use(None)


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
def test_the_command_of_the_readme(family: Family, tmp_path: Path) -> None:
    """It writes into the package, so a copy of that is used."""
    needs_a_compiler()
    package = Path(family.module.__file__).parent
    shutil.copytree(package, tmp_path / "lika_encoders", ignore=shutil.ignore_patterns("_compiled.so", "__pycache__"))
    found = re.search(r"^python (-m lika_encoders\.build_helper .*)$", README.read_text(encoding="utf-8"), re.MULTILINE)
    assert found
    done = subprocess.run([sys.executable, *found[1].split()], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    library = tmp_path / "lika_encoders" / "_compiled.so"
    assert done.stdout == f"written    {library}\n"
    used = "import lika_encoders as e; e.use_helper(); print(e.lookup('AMM5A21/65KSC1').decode_many([0]).fault)"
    done = subprocess.run([sys.executable, "-c", used], cwd=tmp_path, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("[2]\n", "")


@pytest.mark.parametrize("family", ["amm5"], indirect=True)
def test_an_order_code_that_is_none_is_told(family: Family, tmp_path: Path) -> None:
    package = Path(family.module.__file__).parent.parent
    command = [sys.executable, "-m", "lika_encoders.build_helper", "AMM5A23/65KJP9", "-o", str(tmp_path / "x.so")]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(package)})
    assert done.returncode == 1
    assert "AMM5A23/65KJP1" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("compiler", ["cc", "clang"])
@pytest.mark.parametrize("family", ["amm5", "odd_shapes"], indirect=True)
def test_c_compiles_without_a_word(family: Family, compiler: str) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no C compiler '{compiler}' here; apt-get install gcc clang")
    warnings = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wcast-qual -Werror".split()
    # Not each family needs all that loops can have in common.
    warnings.append("-Wno-unused-function")
    command = [compiler, "-std=c99", "-O1", *warnings, '-DGENERATION="x"', "-x", "c", "-fsyntax-only", "-"]
    text = parts_of(family)[0].source(tried(family))
    done = subprocess.run(command, input=text, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
