"""Type checkers accept the examples of the package, and find mistakes in programs that use it."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import warnings
from collections import defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]


class Mistake(NamedTuple):
    """A program with a mistake, and the messages of mypy and pyright. They do not report a second mistake in it."""

    code: str
    mypy: str
    pyright: str


MISTAKES: Mapping[str, Mistake] = {
    "a list for an encoder that sends bits": Mistake(
        "lookup('AMM5A21/65KSC1').decode([5])",
        'Argument 1 to "decode" of "BissEncoder" has incompatible type "list[int]"',
        'Argument of type "list[int]" cannot be assigned to parameter "frame" of type "Word"',
    ),
    "bits for an encoder that sends bytes": Mistake(
        "lookup('AMM5A23/65KJP1').decode(0x55BCD15E2)",
        'Argument 1 to "decode" of "Rs485Encoder" has incompatible type "int"',
        'Argument of type "Literal[23015003618]" cannot be assigned to parameter "frame" of type "Data"',
    ),
    "a frame of another interface": Mistake(
        "amm5.SingleCycleData.decode(5, lookup('AMM5A23/65KBG1'))",
        'incompatible type "SsiEncoder"; expected "BissEncoder"',
        'Argument of type "SsiEncoder" cannot be assigned to parameter "variant" of type "BissEncoder"',
    ),
    "a field of another interface": Mistake(
        "print(lookup('AMM5A23/65KBG1').decode(5).error)",
        '"SsiWord" has no attribute "error"',
        'Cannot access attribute "error" for class "SsiWord"',
    ),
    "a frame of another family": Mistake(
        "frame: am36.SingleCycleData = lookup('AMM5A21/65KSC1').decode(5)",
        'has type "lika_encoders.amm5.SingleCycleData", variable has type "lika_encoders.am36.SingleCycleData"',
        'Type "lika_encoders.amm5.SingleCycleData" is not assignable to declared type "lika_encoders.am36.',
    ),
    "an encoder of another family": Mistake(
        "am36.SingleCycleData.decode(5, lookup('AMM5A21/65KSC1'))",
        'incompatible type "lika_encoders.amm5.BissEncoder"; expected "lika_encoders.am36.BissEncoder"',
        'Argument of type "BissEncoder" cannot be assigned to parameter "variant" of type "BissEncoder"',
    ),
    "a procedure of another family": Mistake(
        "amm5.set_preset(lookup('ASC8525/SC1'), 5)",
        'incompatible type "lika_encoders.asc85.BissEncoder"; expected "lika_encoders.amm5.BissEncoder"',
        'Argument of type "BissEncoder" cannot be assigned to parameter "variant" of type "BissEncoder"',
    ),
    "a procedure of another interface": Mistake(
        "amm5.set_preset(lookup('AMM5A23/65KJP1'), 5)",
        'incompatible type "Rs485Encoder"; expected "BissEncoder"',
        'Argument of type "Rs485Encoder" cannot be assigned to parameter "variant" of type "BissEncoder"',
    ),
    "a fault that nobody handles": Mistake(
        "print(lookup('AMM5A21/65KSC1').try_decode(0x55BCD15E2).position)",
        'Item "FrameError" of "SingleCycleData | FrameError" has no attribute "position"',
        'Cannot access attribute "position" for class "FrameError"',
    ),
    "a position that may not be usable": Mistake(
        "encoder = lookup('AMM5A21/65KSC1')\nprint(encoder.degrees(encoder.decode(5).usable_position))",
        'incompatible type "int | None"; expected "int"',
        'Argument of type "int | None" cannot be assigned to parameter "position" of type "int"',
    ),
    "a verdict that is forgotten": Mistake(
        """
def worth(frame: amm5.SingleCycleData) -> str:
    match frame.verdict:
        case Verdict.USABLE:
            return 'yes'
        case Verdict.NOT_USABLE:
            return 'no'
""",
        "Missing return statement",
        "Cases within match statement do not exhaustively handle all values",
    ),
    "a verdict of a frame that has none": Mistake(
        "print(lookup('AMM5A23/65KJP1').decode(b'abcdef').verdict)",
        'Item "EncoderIdReply" of "SingleturnReply | MultiturnReply | EncoderIdReply | CompleteReply | ',
        'Cannot access attribute "verdict" for class "EncoderIdReply"',
    ),
    "a position of a frame that has none": Mistake(
        "print(lookup('AMM5A23/65KJP1').decode(b'abcdef').position)",
        'has no attribute "position"',
        'Cannot access attribute "position" for class "SingleturnReply"',
    ),
    "a text where a word of a manual belongs": Mistake(
        "print([item for item in amm5.ERRATA if item.status == 'open'])",
        "Non-overlapping equality check",
        'the types "Status" and "Literal[\'open\']" have no overlap',
    ),
    "a column that a table does not have": Mistake(
        "lookup('AMM5A21/65KSC1').decode_many([5])['positon']",
        'No overload variant of "__getitem__" of "Table" matches argument type "str"',
        'No overloads for "__getitem__" match the provided arguments',
    ),
    "a length of an angle": Mistake(
        "lookup('AMM5A21/65KSC1').decode_many([5]).in_units('millimetres')",
        'Argument 1 to "in_units" of "Table" has incompatible type "Literal[\'millimetres\']"',
        'Argument of type "Literal[\'millimetres\']" cannot be assigned to parameter "unit"',
    ),
    "an angle of a length": Mistake(
        "lookup('SMA21-SC1-0050').decode_many([5]).in_units('degrees')",
        'Argument 1 to "in_units" of "Table" has incompatible type "Literal[\'degrees\']"',
        'Argument of type "Literal[\'degrees\']" cannot be assigned to parameter "unit"',
    ),
    "an answer that is missing": Mistake(
        "lookup('ASC8520/SC1').decode(5)",
        'Missing named argument "zero_bit" for "decode" of "BissEncoder"',
        'Argument missing for parameter "zero_bit"',
    ),
    "a serial port for an encoder that needs a clock": Mistake(
        "open_encoder('COM3', lookup('AMM5A21/65KSC1'))",
        'Argument 2 has incompatible type "BissEncoder"; expected "str | SerialEncoder"',
        'Argument of type "BissEncoder" cannot be assigned to parameter "label" of type "str | SerialEncoder"',
    ),
    "a serial port for an encoder that needs a clock, with asyncio": Mistake(
        "open_async('COM3', lookup('AMM5A23/65KBG1'))",
        'Argument 2 has incompatible type "SsiEncoder"; expected "str | SerialEncoder"',
        'Argument of type "SsiEncoder" cannot be assigned to parameter "label" of type "str | SerialEncoder"',
    ),
    "the bits of a frame that is made of bytes": Mistake(
        "print(lookup('AMM5A23/65KJP1').frame_bits)",
        '"Rs485Encoder" has no attribute "frame_bits"',
        'Cannot access attribute "frame_bits" for class "Rs485Encoder"',
    ),
    "a name that a module does not have": Mistake(
        "amm5.NOTHING", 'Module has no attribute "NOTHING"', '"NOTHING" is not a known attribute of module'
    ),
}
NAMES = "Verdict, am36, amm5, lookup, open_async, open_encoder"
HEAD = f"from lika_encoders import {NAMES}\n\n_ = ({NAMES})\n"
SOUND = """
encoder = lookup('AMM5A21/65KSC1')
frame = encoder.try_decode(encoder.decode(5).encode())
if isinstance(frame, amm5.SingleCycleData) and frame.verdict is not Verdict.NOT_USABLE:
    print(frame.position, frame.error)
open_encoder('COM3', lookup('AMM5A23/65KJP1')).close()
open_encoder('COM3', 'AMM5A23/65KJP1').close()
"""
#: Settings of pyright. Examples may show a value that is not used, and import names for the next example.
STRICT = {
    "typeCheckingMode": "strict",
    "pythonVersion": "3.10",
    "reportUnusedExpression": False,
    "reportUnusedImport": False,
}


def strict(folder: Path, *files: Path) -> str:
    """Return the messages of mypy about these files, which use the package in ``folder``."""
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--python-version", "3.10"]
    completed = subprocess.run([*command, *map(str, files)], capture_output=True, text=True, cwd=folder)
    return completed.stdout + completed.stderr


#: Inside the package, modules use each other's private names, and functions check the types of arguments
#: from callers without a type checker.
INSIDE = {**STRICT, "reportPrivateUsage": False, "reportUnnecessaryIsInstance": False}


def pyright(folder: Path, *files: Path, setting: Mapping[str, object] = STRICT) -> list[tuple[str, str]]:
    """Return pyright's messages about these files, with their names. It needs Node, and fetches it if it is missing."""
    command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable]
    (folder / "pyrightconfig.json").write_text(json.dumps(setting), encoding="utf-8")
    completed = subprocess.run([*command, *map(str, files)], capture_output=True, text=True, cwd=folder)
    try:
        report = json.loads(completed.stdout)
    except ValueError:
        output = completed.stderr or completed.stdout
        words = f"pyright does not start here, so what it says is not shown: {output[-200:]}"
        if os.environ.get("CODEWHEEL_REQUIRE_TOOLS"):
            pytest.fail(words)
        warnings.warn(words, stacklevel=2)
        pytest.skip(words)
    assert report["summary"]["filesAnalyzed"] >= len(files)
    return [(Path(diagnostic["file"]).stem, diagnostic["message"]) for diagnostic in report["generalDiagnostics"]]


def examples() -> dict[str, str]:
    """Return the Python of each page of this repository that uses the package. Every block is its own program."""
    programs_by_name = {}
    package_pages = sorted((ROOT / "generated" / "python").glob("*.md"))
    for path in (ROOT / "README.md", *package_pages, ROOT / "runtime" / "python" / "README.md"):
        folder = path.parent
        blocks = re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)
        for number, block in enumerate(blocks):
            if "from codewheel." in block:
                continue  # A program with a virtual encoder. The tool is not among the packages that are checked.
            lines = [line[4:] for line in block.splitlines() if line.startswith((">>> ", "... "))]
            text = "\n".join(lines)
            programs_by_name[f"{folder.parent.name}_{folder.name}_{path.stem}_{number}"] = (
                text if "import" in text else f"{_imports(blocks[0])}\n{text}"
            )
    return programs_by_name


def _imports(block: str) -> str:
    """Return the imports and the beginning of the first block of a README."""
    lines = [line[4:] for line in block.splitlines() if line.startswith((">>> from", ">>> encoder =", ">>> frame ="))]
    return "\n".join(lines)


def stem(name: str) -> str:
    """Return the name of a program's file."""
    return re.sub("[^a-z0-9]", "_", name.lower())


def programs(folder: Path, texts: Mapping[str, str]) -> list[Path]:
    files = []
    for name, text in texts.items():
        files.append(folder / f"{stem(name)}.py")
        files[-1].write_text(text + "\n", encoding="utf-8")
    return files


@pytest.fixture
def package(generated_python: tuple[Path, ModuleType], tmp_path: Path) -> Path:
    """A folder with the package, for programs that use it."""
    shutil.copytree(generated_python[0] / "lika_encoders", tmp_path / "lika_encoders")
    shutil.copytree(generated_python[0] / "runtime" / "codewheel_runtime", tmp_path / "codewheel_runtime")
    return tmp_path


def test_examples_of_every_readme_pass_mypy(package: Path) -> None:
    texts = examples()
    assert len(texts) > 20
    assert strict(package, *programs(package, texts)) == ""


@pytest.mark.exhaustive
def test_the_package_itself_passes_pyright(package: Path) -> None:
    modules = [*(package / "lika_encoders").rglob("*.py"), *(package / "codewheel_runtime").rglob("*.py")]
    assert pyright(package, *modules, setting=INSIDE) == []


def test_examples_of_every_readme_pass_pyright(package: Path) -> None:
    assert pyright(package, *programs(package, examples())) == []


def check_mistakes(lines_by_program: Mapping[str, list[str]], message_of: Callable[[Mistake], str]) -> None:
    """Each mistake is found by its message, and the program without one passes."""
    for name, mistake in MISTAKES.items():
        lines = lines_by_program.get(stem(name), [])
        assert any(message_of(mistake) in line for line in lines), (name, lines)
    assert "sound" not in lines_by_program


def test_mypy_finds_mistakes(package: Path) -> None:
    lines: dict[str, list[str]] = defaultdict(list)
    for line in strict(package, *wrong_programs(package)).splitlines():
        lines[line.partition(".py:")[0]].append(line)
    check_mistakes(lines, lambda mistake: mistake.mypy)


@pytest.mark.exhaustive
def test_pyright_finds_mistakes(package: Path) -> None:
    lines: dict[str, list[str]] = defaultdict(list)
    for file, message in pyright(package, *wrong_programs(package)):
        lines[file].append(message)
    check_mistakes(lines, lambda mistake: mistake.pyright)


def wrong_programs(folder: Path) -> list[Path]:
    """Return the programs with a mistake each, and one without."""
    return programs(
        folder, {**{name: HEAD + mistake.code for name, mistake in MISTAKES.items()}, "sound": HEAD + SOUND}
    )


def test_every_listed_code_has_its_class(package: Path, generated_python: tuple[Path, ModuleType]) -> None:
    """A type checker infers the right type of ``lookup``."""
    lika = generated_python[1]
    lines = []
    for family in lika.FAMILIES:
        for code, encoder in getattr(lika, family.name).VARIANTS.items():
            assert type(lika.lookup(code)) is type(encoder)
            lines.append(f"it_{len(lines)}: {family.name}.{type(encoder).__name__} = lookup({code!r})")
    assert len(lines) > 100
    head = f"from lika_encoders import lookup, {', '.join(family.name for family in lika.FAMILIES)}\n"
    assert strict(package, *programs(package, {"all": head + "\n".join(lines)})) == ""
