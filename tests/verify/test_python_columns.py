"""Many frames at once lead to the same results as C, single frames and the model, for a million of each layout.

The first two tests repeat tests/python/test_many.py with more frames. The third uses the frames of the comparison of C
and Python, and compares columns directly with the answers of C. ``CODEWHEEL_FRAMES`` sets another number.
"""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy
import pytest
from batch import Batch, Codec, member_format, stdio_entry
from c_harness import compile_c
from codewheel.model import Layout
from codewheel.plan.verdicts import reports_of
from codewheel.targets.python.names import CLASS_NAMES, python_name
from frames import chunks, input_of
from test_crosscheck import LENGTH, NO_VERDICT, Peer
from tools import tool
from tree import generated_tree, interfaces, number_from_environment, package_of

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import test_many as shorter
from test_agreement import FAMILIES, MADE_UP
from test_many import families, family

__all__ = ["families", "family"]

FRAMES = number_from_environment("CODEWHEEL_FRAMES", 1_000_000)
#: The model takes at least 0.1 ms for a frame. Specs of tests alone have many order codes for each of their layouts.
FRAMES_OF_THE_MODEL, FRAMES_OF_TESTS = 20_000, 100_000
#: Number of frames that pass through C at once.
PIECE = 10_000


@pytest.mark.parametrize("family", [*FAMILIES, *MADE_UP], indirect=True)
def test_columns_are_what_each_frame_is(family: shorter.Family, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = FRAMES if family.device.name in FAMILIES else FRAMES_OF_TESTS
    monkeypatch.setattr(shorter, "FRAMES", min(frames, FRAMES))
    shorter.test_columns_are_what_each_frame_is(family)


@pytest.mark.parametrize("family", [*FAMILIES, *MADE_UP], indirect=True)
def test_columns_are_what_the_model_says(family: shorter.Family, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = FRAMES_OF_THE_MODEL if family.device.name in FAMILIES else FRAMES_OF_THE_MODEL // 10
    monkeypatch.setattr(shorter, "FRAMES_OF_THE_MODEL", min(frames, FRAMES))
    shorter.test_columns_are_what_the_model_says(family)


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("columns"))


@pytest.fixture(scope="module")
def programs(tree: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return the C program of an interface."""
    folder, include = tmp_path_factory.mktemp("programs"), tree / "c" / "include"
    command = [tool("gcc"), "-std=c99", "-O2"]
    sources = {name: Batch(device).source(stdio_entry()) for name, device in interfaces().items()}
    return cache(lambda family: compile_c(command, sources[family], folder, include, f"{family}_columns"))


def frames_of(batch: Batch) -> list[Codec]:
    """Return the frames sent by an encoder or to it, without registers."""
    layouts = {layout.name for _, layout in batch.device.layouts()}
    return [codec for codec in batch.codecs if codec.name in layouts]


@pytest.mark.parametrize(
    ("family", "name"),
    [(stem, codec.name) for stem, device in interfaces().items() for codec in frames_of(Batch(device))],
)
def test_columns_are_what_c_says(family: str, name: str, programs: Callable[[str], Path], tree: Path) -> None:
    device = interfaces()[family]
    batch = Batch(device)
    codec = next(codec for codec in batch.codecs if codec.name == name)
    peer = Peer(batch, codec, getattr(package_of(device, tree / "python"), device.name))
    kinds: Counter[int] = Counter()
    for variant, records in chunks(batch, codec, FRAMES, "columns", PIECE):
        program_input = input_of(batch, codec, [(variant, records)])
        output = subprocess.run([str(programs(family))], input=program_input, capture_output=True, check=True).stdout
        answers = numpy.frombuffer(output, answer_of(codec))
        extra = [*([peer.variant(device, variant)] if peer.takes_variant else []), *peer.answers(variant)]
        table = peer.kind.decode_many(frames_in(batch, codec, records), *extra)
        compare(batch, codec, table, answers)
        kinds.update(dict(zip(*map(numpy.ndarray.tolist, numpy.unique(table.fault, return_counts=True)), strict=True)))
    assert sum(kinds.values()) == FRAMES
    # At least a sixth is valid, and lengths are sometimes wrong, so that the comparison covers different cases.
    assert kinds[0] > FRAMES / 6, kinds
    assert kinds[LENGTH] > FRAMES / 25, kinds


def frames_in(batch: Batch, codec: Codec, records: bytes) -> Any:
    """Return the frames of records: words as an array, and frames of bytes as a list, because lengths can differ."""
    rows = numpy.frombuffer(records, numpy.uint8).reshape(-1, batch.record)
    if not codec.view.layout_plan.in_bytes:
        return rows[:, 1:9].copy().view(">u8")[:, 0]
    data = rows[:, 1:].tobytes()
    wide = batch.record - 1
    return [data[at : at + size] for at, size in zip(range(0, len(data), wide), rows[:, 0].tolist(), strict=True)]


def answer_of(codec: Codec) -> numpy.dtype[Any]:
    """Return the answers of C to the records, as columns."""
    kinds = {"?": "?", "B": "u1", "H": "<u2", "I": "<u4", "Q": "<u8", "b": "i1", "h": "<i2", "i": "<i4", "q": "<i8"}
    members = []
    for member in codec.members:
        kind = f"S{member.characters}" if member.characters else kinds[member_format(member)]
        members.append((member.name, kind))
    again = [("again", "u1"), ("sent", "u1", (codec.encoded_bytes,)), ("verdict ", "u1"), ("reports ", "<u8")]
    return numpy.dtype([("fault ", "u1"), *members, *again])


def compare(batch: Batch, codec: Codec, table: Any, answers: Any) -> None:
    assert (table.fault == answers["fault "]).all(), codec.name
    sound = table.fault == 0
    compared = set()
    for name in names_of(codec.layout):
        column = python_name(name, CLASS_NAMES)
        member = next((member.name for member in codec.members if member.name in (name, f"{name}_")), None)
        if column in table and member is not None:
            assert (table[column][sound] == answers[member][sound]).all(), (codec.name, name)
            compared |= {column}
    assert compared == {name for name in table.names if name not in ("fault", "verdict")}, codec.name
    verdict = answers["verdict "][sound]
    if "verdict" in table:
        assert (table.verdict[sound] == verdict).all(), codec.name
        assert not table.verdict[~sound].any(), codec.name
    else:
        assert (verdict == NO_VERDICT).all()
    reported = numpy.zeros(len(sound), numpy.uint64)
    number = {report.name: report.number for report in reports_of(batch.device)}
    for name, active in table.reports.items():
        reported |= active.astype(numpy.uint64) << numpy.uint64(number[name])
    assert (reported[sound] == answers["reports "][sound]).all(), codec.name


def names_of(layout: Layout) -> list[str]:
    """Return every column of a frame."""
    runs = [run.name for field in layout.fields for run in field.runs]
    return [*(part.name for part in layout.fields), *runs, *(part.name for part in layout.joins), "unused"]
