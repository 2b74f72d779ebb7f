"""Decode CSV files, with and without quotes, and compare CPU time and memory with a program written by hand.

``python benchmarks/csv_speed.py --gigabytes 2`` compares two million rows, and measures the memory for 50 MB and 2 GB.
The program by hand reads with pyarrow, decodes each batch with ``decode_partition``, and writes with pyarrow.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "generated" / "python"
#: Number of different frames. A file repeats them.
FRAMES: Final = 200_000
#: Limits: CPU time relative to the hand-written program, memory relative to a small file, and memory in MB.
PARQUET_LIMIT, CSV_LIMIT, GROWTH_LIMIT, MEMORY_LIMIT = 1.1, 1.2, 1.15, 230


class Cost(NamedTuple):
    seconds: float
    peak_mb: float


def write_csv(path: Path, code: str, size: int, quotes: str) -> None:
    """Write times and words, until the file has at least this many bytes."""
    import numpy
    from lika_encoders import lookup  # type: ignore[import-not-found, unused-ignore]

    encoder = lookup(code)
    steps = numpy.random.default_rng(1).integers(-3000, 3000, FRAMES)
    words = encoder.encode_many({"position": numpy.cumsum(steps) % encoder.modulus}).tolist()
    lines = [f"{row * 1e-4:.4f},{quotes}{word:#x}{quotes}\n" for row, word in enumerate(words)]
    with path.open("w") as file:
        written = file.write(f"{quotes}time{quotes},{quotes}word{quotes}\n")
        while written < size:
            written += file.write("".join(lines))


def by_hand(code: str, source: str, target: str) -> None:
    """Decode a file as a user would without ``decode_file``."""
    import pyarrow.csv
    import pyarrow.parquet
    from lika_encoders import decode_partition, lookup

    encoder = lookup(code)
    options = pyarrow.csv.ReadOptions(block_size=1 << 22, use_threads=False)
    writer: Any = None
    for batch in pyarrow.csv.open_csv(source, options):
        decoded = decode_partition(batch, encoder, "word")
        if writer is None:
            is_csv = target.endswith(".csv")
            writer = (pyarrow.csv.CSVWriter if is_csv else pyarrow.parquet.ParquetWriter)(target, decoded.schema)
        writer.write(decoded)
    writer.close()


def with_package(code: str, source: str, target: str) -> None:
    """Decode a file with the package."""
    from lika_encoders import decode_file

    decode_file(code, source, target, column="word", force=True)


WAYS: Final[dict[str, Callable[[str, str, str], None]]] = {"by_hand": by_hand, "with_package": with_package}


def measure(way: str, code: str, source: Path, target: Path) -> Cost:
    """Measure a way to decode a file in a process of its own."""
    command = [sys.executable, __file__, "--child", way, code, str(source), str(target)]
    completed = subprocess.run(command, capture_output=True, text=True, check=True)
    return Cost(*json.loads(completed.stdout))


def child(way: str, *arguments: str) -> None:
    start = time.process_time()
    WAYS[way](*arguments)
    seconds = time.process_time() - start
    # Linux reports KiB.
    print(json.dumps([seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6]))


def compare(folder: Path, code: str, size: int) -> bool:
    """Print the ratio of each kind of file, and return whether all are within the limits."""
    is_within = True
    for quotes in ("", '"'):
        source = folder / "in.csv"
        write_csv(source, code, size, quotes)
        for target, limit in (("out.parquet", PARQUET_LIMIT), ("out.csv", CSV_LIMIT)):
            seconds = {way: min(measure(way, code, source, folder / target).seconds for _ in range(3)) for way in WAYS}
            ratio = seconds["with_package"] / seconds["by_hand"]
            kind = "with quotes" if quotes else "without quotes"
            print(f"{kind}, to {target[4:]}: {seconds['with_package']:.2f} s, {ratio:.2f} of by hand (limit {limit})")
            is_within = is_within and ratio <= limit
    return is_within


def compare_memory(folder: Path, code: str, size: int) -> bool:
    """Print the memory for a small and a large file, and return whether it is within the limits."""
    is_within = True
    for target in ("out.parquet", "out.csv"):
        peaks: list[float] = []
        for file_size in (50_000_000, size):
            write_csv(folder / "in.csv", code, file_size, "")
            cost = measure("with_package", code, folder / "in.csv", folder / target)
            peaks.append(cost.peak_mb)
            print(f"{file_size:,} bytes to {target[4:]}: {cost.seconds:.1f} s CPU, at most {cost.peak_mb:.0f} MB")
        is_within = is_within and max(peaks) <= MEMORY_LIMIT and peaks[1] <= GROWTH_LIMIT * peaks[0]
    return is_within


def main() -> int:
    if sys.argv[1:2] == ["--child"]:
        child(*sys.argv[2:])
        return 0
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gigabytes", type=float, default=2.0, help="size of the large file (default: 2)")
    parser.add_argument("--code", default="AMM5A21/65KSC1", help="an order code with BiSS (default: %(default)s)")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        is_fast = compare(Path(folder), chosen.code, 40_000_000)
        is_small = compare_memory(Path(folder), chosen.code, int(chosen.gigabytes * 1e9))
    return 0 if is_fast and is_small else 1


sys.path[:0] = [str(PACKAGE), str(ROOT / "runtime" / "python")]
if __name__ == "__main__":
    sys.exit(main())
