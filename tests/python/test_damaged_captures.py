"""Captures with missing or exchanged parts lead to an error instead of fewer or wrong frames."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy
import pytest
from codewheel_runtime.errors import InputError, UsageError
from test_capture_files import HERTZ, POSITIONS, RATE, read, saleae, saleae_1, session, wave

#: Bytes of the header of a Saleae file of version 1, and of each of its chunks.
HEADER, CHUNK = 24, 36
Chunk = tuple[bytes, bytes]


def chunks_of(data: bytes) -> list[Chunk]:
    """Return the header and the edges of each chunk of a Saleae file of version 1."""
    chunks: list[Chunk] = []
    start = HEADER
    while start < len(data):
        (count,) = struct.unpack_from("<Q", data, start + CHUNK - 8)
        edges_start = start + CHUNK
        end = edges_start + 8 * count
        chunks.append((data[start:edges_start], data[edges_start:end]))
        start = end
    return chunks


def begin_early(chunks: list[Chunk]) -> list[Chunk]:
    """Let the last chunk begin with the other level before the last edge of the one before."""
    head, edges = chunks[-1]
    (level,) = struct.unpack_from("<I", head)
    return [*chunks[:-1], (struct.pack("<I", level ^ 1) + head[4:12] + struct.pack("<d", 0.0) + head[20:], edges)]


def keep_level(chunks: list[Chunk]) -> list[Chunk]:
    head, edges = chunks[-1]
    return [*chunks[:-1], (head[:12] + struct.pack("<d", 0.0) + head[20:], edges)]


@pytest.mark.parametrize("change", [begin_early, keep_level, lambda chunks: chunks[::-1]])
def test_a_chunk_begins_after_the_last_edge(change: Callable[[list[Chunk]], list[Chunk]], tmp_path: Path) -> None:
    paths = saleae_1(tmp_path / "line.bin", wave())
    assert read(paths).table["position"].tolist() == POSITIONS
    for path in paths:
        data = path.read_bytes()
        changed = change(chunks_of(data))
        path.write_bytes(data[:HEADER] + b"".join(head + edges for head, edges in changed))
    with pytest.raises(InputError, match="the parts of this Saleae file are not in ascending order"):
        read(paths)


@pytest.mark.parametrize("version", [0, 1])
def test_edges_that_are_not_counted(version: int, tmp_path: Path) -> None:
    """A count that is too low would leave out the last edges."""
    paths = saleae(tmp_path / "line.bin", wave(), version)
    offset = HEADER + CHUNK - 8 if version else 16 + 28 - 8
    for path in paths:
        data = bytearray(path.read_bytes())
        (count,) = struct.unpack_from("<Q", data, offset)
        if version:
            # The second chunk is not counted at all.
            struct.pack_into("<Q", data, 16, 1)
        else:
            struct.pack_into("<Q", data, offset, count - 2)
        path.write_bytes(data)
    with pytest.raises(InputError, match="more bytes follow its last edge"):
        read(paths)


def test_one_file_is_not_both_lines(tmp_path: Path) -> None:
    paths = saleae(tmp_path / "line.bin", wave())
    with pytest.raises(UsageError, match="the clock and the data line are the same file"):
        read([paths[0], paths[0]])


@pytest.mark.parametrize("missing", ["logic-1-1", "logic-1-2"])
def test_a_session_without_one_of_its_files(missing: str, tmp_path: Path) -> None:
    (path,) = session(tmp_path / "line.sr", wave())
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist() if name != missing}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    with pytest.raises(InputError, match=f"its file {missing} is missing"):
        read([path])


def arrays() -> dict[str, Any]:
    """Return the levels of the two lines."""
    clock, data = numpy.array(wave().samples(RATE)).T
    return {"MA": clock, "SLO": data}


@pytest.mark.parametrize("missing_bytes", [1, 2000])
def test_an_array_that_ends_early(missing_bytes: int, tmp_path: Path) -> None:
    path = tmp_path / "line.npy"
    numpy.save(path, numpy.stack([*arrays().values()], 1).astype("u2"))
    assert read([path], rate=HERTZ).table["position"].tolist() == POSITIONS
    path.write_bytes(path.read_bytes()[:-missing_bytes])
    with pytest.raises(InputError, match="this NumPy file ends early"):
        read([path], rate=HERTZ)


def test_an_array_in_fortran_order(tmp_path: Path) -> None:
    path = tmp_path / "line.npy"
    numpy.save(path, numpy.asfortranarray(numpy.stack([*arrays().values()], 1)))
    with pytest.raises(InputError, match=r"save numpy\.ascontiguousarray\(samples\)"):
        read([path], rate=HERTZ)


def replaced(column: Any, value: float) -> Any:
    """Return a copy whose element 9 has another value."""
    changed = column.astype(float)
    changed[9] = value
    return changed


def odd_archives() -> Sequence[tuple[dict[str, Any], str]]:
    lines = arrays()
    times = numpy.arange(len(lines["MA"])) / HERTZ
    late = numpy.append(times[:-1], numpy.inf)
    return (
        ({**lines, "rate": numpy.inf}, "expected a sample rate above 0 in 'rate', got inf"),
        ({**lines, "rate": numpy.nan}, "expected a sample rate above 0 in 'rate', got nan"),
        ({**lines, "rate": -5}, "expected a sample rate above 0 in 'rate', got -5"),
        ({**lines, "time": late}, "the times are not finite numbers in ascending order"),
        ({**lines, "MA": replaced(lines["MA"] * 3.3, numpy.nan)}, "expected finite voltages"),
        ({**lines, "MA": replaced(lines["MA"] * 3.3, numpy.inf)}, "expected finite voltages"),
    )


@pytest.mark.parametrize(("contents", "message"), odd_archives())
def test_arrays_with_infinite_values(contents: dict[str, Any], message: str, tmp_path: Path) -> None:
    path = tmp_path / "line.npz"
    numpy.savez(path, **contents)
    with pytest.raises(InputError, match=message):
        read([path])


def test_numbers_of_thousands_of_digits(tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    path.write_text("".join(f"{'1' * 5000},{place & 1},1\n" for place in range(10)))
    with pytest.raises(InputError, match="choose a channel with --clock"):
        read([path])


def test_an_increment_of_almost_nothing_is_not_a_rate(tmp_path: Path) -> None:
    """Its inverse is infinite, so sample numbers would become seconds."""
    path = tmp_path / "line.csv"
    rows = "".join(f"{row},{clock},{data},,\n" for row, (clock, data) in enumerate(wave().samples(RATE)))
    path.write_text(f"X,MA,SLO,Start,Increment\nSequence,Volt,Volt,0,5e-324\n{rows}")
    capture = read([path])
    assert capture.table["position"].tolist() == POSITIONS
    assert "time" not in capture.table.names
