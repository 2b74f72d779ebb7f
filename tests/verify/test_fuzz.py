"""A fuzzer with sanitizers finds no error in any function of any header, and decoded frames are encoded identically.

The targets are generated from the headers, see ``fuzz.py``. ``CODEWHEEL_FUZZ_SECONDS`` sets the duration of each.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest
from batch import Batch
from c_harness import INTERFACES
from fuzz import HERE, PRECONDITIONS, Header, seeds, source, texts_of
from machines import crc_tables
from tools import tool
from tree import generated_tree, interfaces, number_from_environment

SECONDS = number_from_environment("CODEWHEEL_FUZZ_SECONDS", 20)
#: Wrap-around of unsigned numbers and shifts that lose bits are intended.
#: Every other loss of a number's value is detected.
SANITIZERS = [
    "-fsanitize=fuzzer,address,undefined,integer",
    "-fno-sanitize=unsigned-integer-overflow,unsigned-shift-base",
    "-fno-sanitize-recover=all",
]
BY_HAND = ("biss", "receive", "runner", "motion")
#: Headers of the manufacturer, not of a family, have targets written by hand.
#: The other form of the CRCs is tested for a quarter of the time.
TARGETS = (*INTERFACES, *BY_HAND, *(f"{name}-crc-table" for name in INTERFACES))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


@pytest.fixture(scope="module")
def include(folder: Path) -> Path:
    return generated_tree(folder) / "c" / "include"


def seconds(target: str) -> int:
    return max(1, SECONDS // 4) if "-" in target else SECONDS


def fuzzed(compiler: list[str], text: str, inputs: Iterable[bytes], folder: Path) -> tuple[int, str]:
    corpus = folder / "corpus"
    corpus.mkdir(parents=True)
    for index, data in enumerate(inputs):
        (corpus / f"{index:04}").write_bytes(data)
    program = folder / "target"
    (folder / "target.c").write_text(text, encoding="utf-8")
    completed = subprocess.run(
        [*compiler, str(folder / "target.c"), "-o", str(program)], capture_output=True, text=True
    )
    assert completed.returncode == 0, completed.stderr[:4000]
    options = [
        f"-max_total_time={seconds(folder.name)}",
        "-max_len=1200" if folder.name == "biss" else "-max_len=96",
        "-seed=1",
        "-rss_limit_mb=1024",
        "-print_final_stats=1",
        "-verbosity=1",
    ]
    completed = subprocess.run(
        [str(program), *options, f"-artifact_prefix={folder}/", str(corpus)],
        capture_output=True,
        text=True,
        errors="replace",
        timeout=SECONDS + 120,
    )
    return completed.returncode, completed.stderr


@pytest.mark.parametrize("target", TARGETS)
def test_the_fuzzer_finds_nothing(target: str, folder: Path, include: Path) -> None:
    name, _, table = target.partition("-")
    compiler = [
        tool("clang", options=SANITIZERS),
        "-std=c99",
        "-O1",
        "-g",
        *SANITIZERS,
        f"-I{include}",
        f"-I{HERE}",
        *(crc_tables(include) if table else ()),
    ]
    if name in INTERFACES:
        batch = Batch(interfaces()[name])
        text, inputs = source(batch, include), seeds(batch)
    else:
        text, inputs = (HERE / f"fuzz_{name}.c").read_text(encoding="utf-8"), iter(())
    status, log = fuzzed(compiler, text, inputs, folder / target)
    log_lines = [line for line in log.splitlines() if not re.match(r"#\d|INFO|\s+NEW_FUNC", line)]
    assert status == 0, "\n".join(log_lines[-60:])
    runs = re.search(r"number_of_executed_units:\s+(\d+)", log)
    assert runs is not None, log_lines[-10:]
    assert int(runs[1]) > 500 * seconds(target), log_lines[-10:]


@pytest.mark.parametrize("name", INTERFACES)
def test_every_function_is_called(name: str, include: Path) -> None:
    """All except the helpers that are named with a reason. Functions that the expressions miss would not be fuzzed."""
    batch = Batch(interfaces()[name])
    header = Header(batch, include)
    called = re.findall(r"\(void\)(\w+)\(", header.calls())
    decoders = [f"{codec.view.name}_decode" for codec in batch.codecs]
    declaration = re.compile(r"^static inline [^;{]*?(\w+)\(", re.MULTILINE)
    declared = [name for text in texts_of(batch, include) for name in declaration.findall(text)]
    assert sorted([*called, *decoders, *(f"cw_{name}" for name in PRECONDITIONS)]) == sorted(declared)
