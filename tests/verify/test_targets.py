"""The same code gives the same results on Cortex-M0, M3, M4, big-endian PowerPC and the host, there also by table.

Its input is that of all tests of the C target, including the worked examples of the manuals and public vectors, and
thousands of random and disturbed frames of each layout, which are also compared with the model's own codec.
``CODEWHEEL_TARGET_FRAMES`` sets another number of them.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Mapping
from pathlib import Path

import pytest
from batch import ENCODE, Batch, Codec
from c_harness import FAMILIES, INTERFACES, Run, as_one, source
from codewheel.model import Device, PlacedLayout, Variant, number_from_bytes
from codewheel.reference import codec as model
from codewheel.targets.c.device import views_of
from frames import chunks, input_of, variants, wires
from machines import HOST, MACHINES, Machine
from recorded import Recording, every_device, run_tests
from test_c_codec import FAULTS, Table
from test_c_reports import Telling
from tree import generated_tree, include_of, interfaces, number_from_environment

FRAMES = number_from_environment("CODEWHEEL_TARGET_FRAMES", 2_000)
DEVICES = every_device()

by_machine = pytest.mark.parametrize("machine", MACHINES, ids=[item.name for item in MACHINES])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("targets")
    generated_tree(made)
    return made


@pytest.fixture(scope="module")
def includes(folder: Path) -> dict[str, Path]:
    return {name: include_of(device, folder) for name, device in DEVICES.items()}


# -- input of the tests of the C target


def programs_on(machine: Machine, device: Device, folder: Path, include: Path) -> Run:
    """Return the programs of a device, one for each interface, as one."""
    made = {
        view.context.interface.name: machine.compile_main(source(view), folder, include, view.stem).by_line()
        for view in views_of(device)
    }
    return as_one(device, made)


@pytest.fixture(scope="module")
def recordings(folder: Path, includes: Mapping[str, Path]) -> dict[str, Recording]:
    """Return the lines and answers of the tests on the host, where each test must pass."""
    made = {name: Recording(programs_on(HOST, device, folder, includes[name])) for name, device in DEVICES.items()}
    called = run_tests(DEVICES, made)
    assert len(set(called)) >= 25
    assert "test_every_worked_example" in called
    assert "test_public_crc_rows" in called
    return made


@by_machine
@pytest.mark.parametrize("name", DEVICES)
def test_every_answer_is_the_same_as_on_the_host(
    machine: Machine, name: str, recordings: Mapping[str, Recording], folder: Path, includes: Mapping[str, Path]
) -> None:
    asked = recordings[name].answers
    run = programs_on(machine, DEVICES[name], folder, includes[name])
    answers = run(asked)
    assert len(answers) == len(asked) > (5_000 if name in FAMILIES else 10)
    wrong = [
        (line, expected, answer)
        for (line, expected), answer in zip(asked.items(), answers, strict=True)
        if expected != answer
    ]
    assert not wrong, wrong[:5]


# -- random frames


def questions(batch: Batch) -> list[tuple[Codec, list[tuple[Variant, bytes]]]]:
    return [(codec, list(chunks(batch, codec, FRAMES, "targets"))) for codec in batch.codecs]


def values_to_encode(batch: Batch) -> bytes:
    """Return random members, with few bits as often as with many. Some fit, most do not."""
    random_ = random.Random("members")
    found = b""
    for codec in batch.codecs:
        for variant in variants(batch.device, codec):
            records = [
                bytes(random_.getrandbits(8) & random_.choice([0, 1, 15, 255]) for _ in range(codec.size))
                for _ in range(50)
            ]
            found += batch.chunk(ENCODE, codec, variant, records)
    return found


@pytest.fixture(scope="module", params=INTERFACES)
def on_the_host(
    request: pytest.FixtureRequest, folder: Path, includes: Mapping[str, Path]
) -> tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes]:
    """Return frames of an interface, and the host's results for them and for random members."""
    batch = Batch(interfaces()[request.param])
    asked = questions(batch)
    include = includes[batch.device.name]
    run = HOST.compile(batch.source(HOST.entry()), folder, include, f"{request.param}_batch")
    return batch, asked, run(b"".join(input_of(batch, *item) for item in asked) + values_to_encode(batch))


@by_machine
def test_random_frames_are_decoded_and_encoded_as_on_the_host(
    machine: Machine,
    on_the_host: tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes],
    folder: Path,
    includes: Mapping[str, Path],
) -> None:
    batch, asked, expected = on_the_host
    include = includes[batch.device.name]
    run = machine.compile(batch.source(machine.entry()), folder, include, f"{batch.view.stem}_batch")
    answers = run(b"".join(input_of(batch, *item) for item in asked) + values_to_encode(batch))
    assert len(answers) == len(expected)
    different = next((at for at, (one, other) in enumerate(zip(answers, expected, strict=True)) if one != other), None)
    assert different is None, f"byte {different} of the answers"


def test_random_frames_mean_what_the_model_says(
    on_the_host: tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes],
) -> None:
    batch, asked, out = on_the_host
    table, telling, at = Table(batch.device), Telling(batch.device), 0
    for codec, pieces in asked:
        answer = struct.Struct(codec.answer)
        for variant, records in pieces:
            placed = codec.layout.place(variant.parameters)
            for wire in wires(batch, codec, records):
                got = answer.unpack_from(out, at)
                at += answer.size
                result, row = judged(table, codec, placed, wire)
                assert got[0] == result, (codec.name, variant.code, wire, got)
                if result == 0:
                    assert list(got[1:-4]) == row, (codec.name, variant.code, wire, got, row)
                    what = (codec.name, variant.code, wire, got)
                    assert got[-4] != 0 or meaning(table, codec, placed, got[-3]) == row, what
                    assert got[-2:] == tells(telling, codec, variant, placed, wire), what


def tells(telling: Telling, codec: Codec, variant: Variant, placed: PlacedLayout, wire: int | bytes) -> tuple[int, int]:
    """Return the expected verdict and reports."""
    if codec.view.reports is None:
        return 255, 0
    number = wire if isinstance(wire, int) else number_from_bytes(codec.layout, wire)
    verdict, reports = telling.of(variant, placed, number)
    return 255 if verdict is None else verdict, reports


def judged(table: Table, codec: Codec, placed: PlacedLayout, wire: int | bytes) -> tuple[int, list[object]]:
    """Return the expected result and members."""
    if isinstance(wire, bytes) and 8 * len(wire) != placed.bits:
        return FAULTS["length"], []
    number = wire if isinstance(wire, int) else number_from_bytes(codec.layout, wire)
    problems = model.decode(table.device, placed, number).problems
    return (FAULTS[problems[0].fault.value], []) if problems else (0, row_of(table, codec, placed, number))


def row_of(table: Table, codec: Codec, placed: PlacedLayout, number: int) -> list[object]:
    texts = table.row(codec.name, placed, number).split(" ") if codec.members[0].name != "no_data" else ["0"]
    return [
        bytes.fromhex(text) if member.characters else int(text)
        for text, member in zip(texts, codec.members, strict=True)
    ]


def meaning(table: Table, codec: Codec, placed: PlacedLayout, sent: bytes) -> list[object]:
    """Return the model's reading of an encoded word or frame."""
    wire = int.from_bytes(sent, "big") if not codec.view.plan.in_bytes else sent
    result, row = judged(table, codec, placed, wire)
    return row if result == 0 else []
