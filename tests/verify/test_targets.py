"""The same code returns the same results on Cortex-M0, M3, M4, big-endian PowerPC and the host, there also with tables.

Its input comes from all tests of the C target, including the worked examples of the manuals and public vectors, and
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
from c_harness import FAMILIES, INTERFACES, Run, combined_run, source
from codewheel.model import Device, PlacedLayout, Variant, number_from_bytes
from codewheel.reference import codec as model
from codewheel.targets.c.device import views_of
from frames import chunks, input_of, variants, wires
from machines import HOST, MACHINES, Machine
from recorded import Recording, every_device, run_tests
from test_c_codec import FAULTS, Table
from test_c_reports import ExpectedReports
from tree import generated_tree, include_of, interfaces, number_from_environment

FRAMES = number_from_environment("CODEWHEEL_TARGET_FRAMES", 2_000)
DEVICES = every_device()

by_machine = pytest.mark.parametrize("machine", MACHINES, ids=[machine.name for machine in MACHINES])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target_folder = tmp_path_factory.mktemp("targets")
    generated_tree(target_folder)
    return target_folder


@pytest.fixture(scope="module")
def includes(folder: Path) -> dict[str, Path]:
    return {name: include_of(device, folder) for name, device in DEVICES.items()}


# -- input of the tests of the C target


def programs_on(machine: Machine, device: Device, folder: Path, include: Path) -> Run:
    """Return the programs of a device, one for each interface, as one."""
    programs = {}
    for view in views_of(device):
        program = machine.compile_main(source(view), folder, include, view.stem)
        programs[view.context.interface.name] = program.by_line()
    return combined_run(device, programs)


@pytest.fixture(scope="module")
def recordings(folder: Path, includes: Mapping[str, Path]) -> dict[str, Recording]:
    """Return the lines and answers of the tests on the host, where each test must pass."""
    recorded = {name: Recording(programs_on(HOST, device, folder, includes[name])) for name, device in DEVICES.items()}
    called = run_tests(DEVICES, recorded)
    assert len(set(called)) >= 25
    assert "test_every_worked_example" in called
    assert "test_public_crc_rows" in called
    return recorded


@by_machine
@pytest.mark.parametrize("name", DEVICES)
def test_every_answer_is_the_same_as_on_the_host(
    machine: Machine, name: str, recordings: Mapping[str, Recording], folder: Path, includes: Mapping[str, Path]
) -> None:
    recorded = recordings[name].answers
    run = programs_on(machine, DEVICES[name], folder, includes[name])
    answers = run(recorded)
    assert len(answers) == len(recorded) > (5_000 if name in FAMILIES else 10)
    rows = [(line, expected, answer) for (line, expected), answer in zip(recorded.items(), answers, strict=True)]
    differing = [row for row in rows if row[1] != row[2]]
    assert not differing, differing[:5]


# -- random frames


def questions(batch: Batch) -> list[tuple[Codec, list[tuple[Variant, bytes]]]]:
    return [(codec, list(chunks(batch, codec, FRAMES, "targets"))) for codec in batch.codecs]


def values_to_encode(batch: Batch) -> bytes:
    """Return random members, with few bits as often as with many. Some values fit, most do not."""
    random_ = random.Random("members")
    chunk_data = b""
    for codec in batch.codecs:
        for variant in variants(batch.device, codec):
            records = [_random_members(random_, codec.size) for _ in range(50)]
            chunk_data += batch.chunk(ENCODE, codec, variant, records)
    return chunk_data


def _random_members(random_: random.Random, size: int) -> bytes:
    return bytes(random_.getrandbits(8) & random_.choice([0, 1, 15, 255]) for _ in range(size))


@pytest.fixture(scope="module", params=INTERFACES)
def on_the_host(
    request: pytest.FixtureRequest, folder: Path, includes: Mapping[str, Path]
) -> tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes]:
    """Return frames of an interface, and the host's results for them and for random members."""
    batch = Batch(interfaces()[request.param])
    codec_pieces = questions(batch)
    include = includes[batch.device.name]
    run = HOST.compile(batch.source(HOST.entry()), folder, include, f"{request.param}_batch")
    return (
        batch,
        codec_pieces,
        run(b"".join(input_of(batch, *question) for question in codec_pieces) + values_to_encode(batch)),
    )


@by_machine
def test_random_frames_are_decoded_and_encoded_as_on_the_host(
    machine: Machine,
    on_the_host: tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes],
    folder: Path,
    includes: Mapping[str, Path],
) -> None:
    batch, codec_pieces, expected = on_the_host
    include = includes[batch.device.name]
    run = machine.compile(batch.source(machine.entry()), folder, include, f"{batch.view.stem}_batch")
    answers = run(b"".join(input_of(batch, *question) for question in codec_pieces) + values_to_encode(batch))
    assert len(answers) == len(expected)
    different = next(
        (at for at, (actual, host) in enumerate(zip(answers, expected, strict=True)) if actual != host), None
    )
    assert different is None, f"byte {different} of the answers"


def test_random_frames_mean_what_the_model_says(
    on_the_host: tuple[Batch, list[tuple[Codec, list[tuple[Variant, bytes]]]], bytes],
) -> None:
    batch, codec_pieces, out = on_the_host
    table, expected_reports, at = Table(batch.device), ExpectedReports(batch.device), 0
    for codec, pieces in codec_pieces:
        answer = struct.Struct(codec.answer)
        for variant, records in pieces:
            placed = codec.layout.place(variant.parameters)
            for wire in wires(batch, codec, records):
                fields = answer.unpack_from(out, at)
                at += answer.size
                result, row = expected_row(table, codec, placed, wire)
                assert fields[0] == result, (codec.name, variant.code, wire, fields)
                if result == 0:
                    assert list(fields[1:-4]) == row, (codec.name, variant.code, wire, fields, row)
                    context = (codec.name, variant.code, wire, fields)
                    assert fields[-4] != 0 or meaning(table, codec, placed, fields[-3]) == row, context
                    assert fields[-2:] == expected_findings(expected_reports, codec, variant, placed, wire), context


def expected_findings(
    expected_reports: ExpectedReports, codec: Codec, variant: Variant, placed: PlacedLayout, wire: int | bytes
) -> tuple[int, int]:
    """Return the expected verdict and reports."""
    if codec.view.reports is None:
        return 255, 0
    number = wire if isinstance(wire, int) else number_from_bytes(codec.layout, wire)
    verdict, reports = expected_reports.verdict_and_mask(variant, placed, number)
    return 255 if verdict is None else verdict, reports


def expected_row(table: Table, codec: Codec, placed: PlacedLayout, wire: int | bytes) -> tuple[int, list[object]]:
    """Return the expected result and members."""
    if isinstance(wire, bytes) and 8 * len(wire) != placed.bits:
        return FAULTS["length"], []
    number = wire if isinstance(wire, int) else number_from_bytes(codec.layout, wire)
    problems = model.decode(table.device, placed, number).problems
    return (FAULTS[problems[0].fault.value], []) if problems else (0, row_of(table, codec, placed, number))


def row_of(table: Table, codec: Codec, placed: PlacedLayout, number: int) -> list[object]:
    texts = table.row(codec.name, placed, number).split(" ") if codec.members[0].name != "no_data" else ["0"]
    pairs = zip(texts, codec.members, strict=True)
    return [bytes.fromhex(text) if member.characters else int(text) for text, member in pairs]


def meaning(table: Table, codec: Codec, placed: PlacedLayout, encoded: bytes) -> list[object]:
    """Return the model's reading of an encoded word or frame."""
    wire = int.from_bytes(encoded, "big") if not codec.view.layout_plan.in_bytes else encoded
    result, row = expected_row(table, codec, placed, wire)
    return row if result == 0 else []
