"""What type checkers know of the package: its examples pass, and mistakes in programs that use it are found."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
#: Programs with a mistake each, and what mypy says of it.
MISTAKES: Mapping[str, tuple[str, str]] = {
    "bytes for an encoder that sends bits": (
        "lookup('AMM5A21/65KSC1').decode(b'abcdef')",
        'Argument 1 to "decode" of "BissEncoder" has incompatible type "bytes"',
    ),
    "bits for an encoder that sends bytes": (
        "lookup('AMM5A23/65KJP1').decode(0x55BCD15E2)",
        'Argument 1 to "decode" of "Rs485Encoder" has incompatible type "int"',
    ),
    "a frame of another interface": (
        "amm5.SingleCycleData.decode(5, lookup('AMM5A23/65KBG1'))",
        'incompatible type "SsiEncoder"; expected "BissEncoder"',
    ),
    "a procedure of another family": (
        "amm5.set_preset(lookup('ASC8525/SC1'), 5)",
        'incompatible type "lika_encoders.asc85.BissEncoder"; expected "lika_encoders.amm5.BissEncoder"',
    ),
    "a procedure of another interface": (
        "amm5.set_preset(lookup('AMM5A23/65KJP1'), 5)",
        'incompatible type "Rs485Encoder"; expected "BissEncoder"',
    ),
    "a fault that nobody handles": (
        "print(lookup('AMM5A21/65KSC1').try_decode(0x55BCD15E2).position)",
        'Item "FrameError" of "SingleCycleData | FrameError" has no attribute "position"',
    ),
    "a position that may not be usable": (
        "encoder = lookup('AMM5A21/65KSC1')\nprint(encoder.degrees(encoder.decode(5).usable_position))",
        'incompatible type "int | None"; expected "int"',
    ),
    "a verdict that is forgotten": (
        """
def worth(frame: amm5.SingleCycleData) -> str:
    match frame.verdict:
        case Verdict.USABLE:
            return 'yes'
        case Verdict.NOT_USABLE:
            return 'no'
""",
        "Missing return statement",
    ),
    "a position of a frame that has none": (
        "print(lookup('AMM5A23/65KJP1').decode(b'abcdef').position)",
        'has no attribute "position"',
    ),
    "a text where a word of a manual belongs": (
        "print([item for item in amm5.ERRATA if item.status == 'open'])",
        "Non-overlapping equality check",
    ),
    "a name that a module does not have": ("amm5.NOTHING", 'Module has no attribute "NOTHING"'),
}
HEAD = "from lika_encoders import Verdict, amm5, lookup\n\n_ = (Verdict, amm5, lookup)\n"


def strict(folder: Path, *files: Path) -> str:
    """What mypy says of these files, which use the package in ``folder``."""
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--python-version", "3.10"]
    done = subprocess.run([*command, *map(str, files)], capture_output=True, text=True, cwd=folder)
    return done.stdout + done.stderr


def examples() -> dict[str, str]:
    """The Python of each README of this repository that uses the package; every block is a program of its own."""
    found = {}
    for path in [ROOT / "README.md", ROOT / "generated" / "python" / "README.md"]:
        blocks = re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)
        for number, block in enumerate(blocks):
            lines = [line[4:] for line in block.splitlines() if line.startswith((">>> ", "... "))]
            text = "\n".join(lines)
            found[f"{path.parent.name}_{number}"] = text if "import" in text else f"{_imports(blocks[0])}\n{text}"
    return found


def _imports(block: str) -> str:
    """What the first block of a README imports and begins with."""
    lines = [line[4:] for line in block.splitlines() if line.startswith((">>> from", ">>> encoder =", ">>> frame ="))]
    return "\n".join(lines)


def programs(folder: Path, texts: Mapping[str, str]) -> list[Path]:
    files = []
    for name, text in texts.items():
        files.append(folder / f"{re.sub('[^a-z0-9]', '_', name.lower())}.py")
        files[-1].write_text(text + "\n", encoding="utf-8")
    return files


@pytest.fixture
def package(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> Path:
    """A folder with the package, for programs that use it."""
    shutil.copytree(generated_python[0] / "lika_encoders", tmp_path / "lika_encoders")
    return tmp_path


def test_examples_of_every_readme_pass_mypy(package: Path) -> None:
    texts = examples()
    assert len(texts) > 20
    assert strict(package, *programs(package, texts)) == ""


def test_examples_pass_pyright(package: Path) -> None:
    pyright = shutil.which("pyright", path=str(Path(sys.executable).parent)) or shutil.which("pyright")
    if pyright is None:
        pytest.skip("pyright is not installed: pip install pyright")
    files = programs(package, examples())
    level = "--level", "error"
    command = [pyright, *level, "--pythonpath", sys.executable, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=package)
    if "error" not in done.stdout and done.returncode:
        pytest.skip(f"pyright does not start here: {done.stderr[-200:]}")
    assert done.returncode == 0, done.stdout


def test_mistakes_are_found(package: Path) -> None:
    """Each by what mypy says at its line; the same program without the mistakes passes."""
    files = programs(package, {name: HEAD + code for name, (code, _) in MISTAKES.items()})
    said = strict(package, *files)
    for path, (name, (_, expected)) in zip(files, MISTAKES.items(), strict=True):
        lines = [line for line in said.splitlines() if line.startswith(path.name)]
        assert any(expected in line for line in lines), (name, lines)
    sound = "encoder = lookup('AMM5A21/65KSC1')\nprint(encoder.decode(encoder.decode(5).encode()).position)"
    assert strict(package, *programs(package, {"sound": HEAD + sound})) == ""


def test_every_listed_code_has_its_class(package: Path, generated_python: tuple[Path, ModuleType]) -> None:
    """``lookup`` gives what a type checker takes it for."""
    lika = generated_python[1]
    lines = []
    for family in lika.FAMILIES:
        for code, encoder in getattr(lika, family.name).VARIANTS.items():
            assert type(lika.lookup(code)) is type(encoder)
            lines.append(f"it_{len(lines)}: {family.name}.{type(encoder).__name__} = lookup({code!r})")
    assert len(lines) > 100
    head = f"from lika_encoders import lookup, {', '.join(item.name for item in lika.FAMILIES)}\n"
    assert strict(package, *programs(package, {"all": head + "\n".join(lines)})) == ""
