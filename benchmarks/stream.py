"""Decode a file larger than memory with the command of the generated package, and measure its time and memory.

``python benchmarks/stream.py --gigabytes 2`` writes a file of frames, decodes it into Parquet, and removes both.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
#: Number of generated frames. The file repeats them.
MADE = 60_000
#: Number of frames per damaged frame.
DAMAGED = 1000
#: Limit for the memory of a command, in MB.
LIMIT = 200


class Measured(NamedTuple):
    frames: int
    damaged: int
    seconds: float
    peak_mb: float
    written_mb: float

    def __str__(self) -> str:
        nanoseconds = self.seconds / max(self.frames, 1) * 1e9
        return (
            f"{self.frames:,} frames, {self.damaged:,} with an error, in {self.seconds:.1f} s: "
            f"{nanoseconds:.0f} ns per frame, peak {self.peak_mb:.0f} MB, Parquet of {self.written_mb:.0f} MB"
        )


def frames(encoder: Any) -> bytes:
    """Return frames of an axis that moves back and forth, packed into bytes. Some of them are damaged."""
    source = random.Random(1)
    length = (encoder.frame_bits + 7) // 8
    kind = type(encoder.decode_many([]).encoder)
    module = sys.modules[kind.__module__]
    at, speed, blocks = 0, 0, []
    for number in range(MADE):
        speed += source.randint(-40, 40)
        at = (at + speed) % encoder.modulus
        word = module.SingleCycleData.from_position(encoder, at).encode()
        if number % DAMAGED == 0:
            word ^= 1 << source.randrange(encoder.frame_bits)
        blocks.append(word.to_bytes(length, "big"))
    return b"".join(blocks)


def write(path: Path, block: bytes, size: int, length: int) -> None:
    """Write whole frames, up to this many bytes in total."""
    size -= size % length
    with path.open("wb") as file:
        for _ in range(size // len(block)):
            file.write(block)
        file.write(block[: size % len(block)])


class Run(NamedTuple):
    output: str
    seconds: float
    peak_mb: float


def run(package: Path, *arguments: str) -> Run:
    """Run the command in its own process, and return its time and memory."""
    started = time.monotonic()
    command = [sys.executable, str(Path(__file__)), "--child", str(package), *arguments]
    finished = subprocess.run(command, capture_output=True, text=True, check=True)
    seconds = time.monotonic() - started
    output, _, peak = finished.stdout.strip().rpartition("peak ")
    # Linux reports KiB.
    return Run(output, seconds, int(peak) * 1024 / 1e6)


def measured(package: Path, folder: Path, size: int, code: str) -> Measured:
    """Measure the command for a file of ``size`` bytes."""
    paths = [str(package), str(package / "runtime")]
    sys.path[:0] = paths
    try:
        from lika_encoders import lookup  # type: ignore[import-not-found, unused-ignore]

        encoder = lookup(code)
        block = frames(encoder)
    finally:
        del sys.path[: len(paths)]
    source, target = folder / "frames.bin", folder / "frames.parquet"
    try:
        write(source, block, size, (encoder.frame_bits + 7) // 8)
        finished = run(package, code, str(source), "-o", str(target))
        counts = re.match(r"(\d+) frames.*?, (\d+) with a CRC error", finished.output)
        assert counts is not None, finished.output
        return Measured(int(counts[1]), int(counts[2]), finished.seconds, finished.peak_mb, target.stat().st_size / 1e6)
    finally:
        source.unlink(missing_ok=True)
        target.unlink(missing_ok=True)


def child(package: str, *arguments: str) -> int:
    """Run the command and report its memory. The parent must be small, because a process starts with its memory."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([package, os.path.join(package, "runtime")])}
    finished = subprocess.run([sys.executable, "-m", "lika_encoders", "decode", *arguments], env=environment)
    print("peak", resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
    return finished.returncode


def main() -> int:
    if sys.argv[1:2] == ["--child"]:
        return child(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gigabytes", type=float, default=2.0, help="the size of the file (default: 2)")
    parser.add_argument("--code", default="AMM5A21/65KSC1", help="an order code with BiSS (default: %(default)s)")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        size = int(chosen.gigabytes * 1e9)
        result = measured(ROOT / "generated" / "python", Path(folder), size, chosen.code)
    print(result)
    return 0 if result.peak_mb <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())
