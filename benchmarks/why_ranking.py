"""Measure how often a planted mistake is found, and how often it is listed first. Each frame has one mistake.

    python benchmarks/why_ranking.py [FRAMES]

FRAMES is the number of frames of each order code with each mistake, by default 20. The frames are the same every time.
A frame whose CRC is still correct, by coincidence or because the mistake changed nothing, is counted as unseen, because
no reader would ask why it was rejected.
"""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from codewheel.commands.decode.explanations import why_text
from codewheel.commands.decode.frames import decode_text
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.order_codes.labels import UnknownOrderCode, find_code
from codewheel.why.diagnosis import Diagnosis, Explanation

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "generator"))

import planted


@dataclass
class Count:
    """Results for the frames with one mistake."""

    frames: int = 0
    unseen: int = 0
    listed: int = 0
    first: int = 0
    explanations: int = 0
    seconds: list[float] = field(default_factory=list)


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    devices, report = load_library()
    if report:
        sys.exit("the specs have problems. Run codewheel check")
    counts = measure({device.name: device for device in devices}, rounds)
    print(f"{'mistake':34} {'frames':>7} {'unseen':>7} {'listed':>8} {'first':>8} {'in the list':>12}")
    for name, count in counts.items():
        noticed = max(count.frames - count.unseen, 1)
        print(
            f"{name:34} {count.frames:7} {count.unseen:7} {count.listed / noticed:8.1%} {count.first / noticed:8.1%} "
            f"{count.explanations / noticed:12.2f}"
        )
    everything = [second for count in counts.values() for second in count.seconds]
    planted_ones = [count for name, count in counts.items() if name not in NOISE]
    noticed = sum(count.frames - count.unseen for count in planted_ones)
    print(
        f"{'all planted mistakes':34} {sum(count.frames for count in planted_ones):7} "
        f"{sum(count.unseen for count in planted_ones):7} "
        f"{sum(count.listed for count in planted_ones) / noticed:8.1%} "
        f"{sum(count.first for count in planted_ones) / noticed:8.1%}"
    )
    print(f"seconds for one frame: {sum(everything) / len(everything):.4f} on average, {max(everything):.4f} at most")


def measure(devices: Mapping[str, Device], rounds: int) -> dict[str, Count]:
    """Return the results for each mistake by name, and for frames of random bits.

    For random bits, ``listed`` counts the frames for which any explanation is found.
    """
    counts: dict[str, Count] = {}
    for name, plant in _plants(rounds):
        count = counts.setdefault(name, Count())
        count.frames += 1
        why = _why(devices, plant, count)
        if why is None:
            count.unseen += 1
            continue
        places = [place for place, explanation in enumerate(why.explanations) if _explains(explanation, plant)]
        count.listed += (
            bool(places) if plant.kind else any(not explanation.needs_two_mistakes for explanation in why.explanations)
        )
        count.first += places[:1] == [0]
        count.explanations += len(why.explanations)
    return counts


def _explains(explanation: Explanation, plant: planted.Plant) -> bool:
    """Return whether an explanation names the planted mistake."""
    words = f"{explanation.text} {' '.join(explanation.order_codes)}"
    return explanation.kind == plant.kind and plant.words in words


NOISE = ("(random bits)",)


def _plants(rounds: int) -> Iterator[tuple[str, planted.Plant]]:
    source = random.Random(5)
    for _ in range(rounds):
        for encoder in planted.ENCODERS:
            for maker in planted.MISTAKES:
                for plant in maker(encoder, source):
                    yield maker.__name__, plant
                    if maker in AS_HEX:
                        yield f"{maker.__name__}, hex", planted.as_hex(plant)
            for _ in range(5):
                yield NOISE[0], planted.Plant(encoder.code, "0b" + planted.random_bits(source, encoder.bits), "")
        for code in planted.BYTE_CODES:
            for plant in planted.byte_mistakes(code, source):
                yield f"{plant.kind}, bytes", plant


AS_HEX = (planted.not_inverted, planted.status_left_out, planted.read_late, planted.read_early, planted.other_code)


def _why(devices: Mapping[str, Device], plant: planted.Plant, count: Count) -> Diagnosis | None:
    for device in devices.values():
        try:
            variant = find_code(device, plant.code).variant
        except UnknownOrderCode:
            continue
        before = time.perf_counter()
        decoded = decode_text(device, variant, "encoder", plant.text)
        why = why_text(device, variant, "encoder", plant.text, decoded)
        count.seconds.append(time.perf_counter() - before)
        return why
    raise LookupError(plant.code)


if __name__ == "__main__":
    main()
