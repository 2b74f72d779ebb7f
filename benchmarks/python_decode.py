"""How fast the generated Python decodes, against a floor that only takes the fields out of the bytes.

    python benchmarks/python_decode.py

The machine is shared and noisy: trust the ratios, which come from one run with the candidates taking turns.
"""

from __future__ import annotations

import sys
import tempfile
import timeit
from collections.abc import Callable
from pathlib import Path

from codewheel.build.load import load_library
from codewheel.targets import Library
from codewheel.targets.python.files import generate

CALLS = 100_000
ROUNDS = 7


def main() -> None:
    devices, report = load_library()
    if report:
        sys.exit("the specs have problems; run codewheel check")
    with tempfile.TemporaryDirectory() as folder:
        for path, text in generate(Library(devices)).items():
            target = Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        sys.path.insert(0, str(Path(folder, "python")))
        _measure_biss()
        _measure_rs485()


def _measure_biss() -> None:
    from lika_encoders import amm5

    variant = amm5.lookup("AMM5A23/65KSC1")
    word = amm5.SingleCycleData.from_position(variant, 0x5A5A5A5A5A).encode()
    data = word.to_bytes(6, "big")

    def floor() -> object:
        number = int.from_bytes(data, "big")
        return number >> 31, number >> 8 & 0x7FFFFF, number >> 7 & 1, number >> 6 & 1

    _compare(
        "BiSS single cycle data, 47 bits",
        {
            "floor: int.from_bytes and a tuple, no CRC": floor,
            "SingleCycleData.decode": lambda: amm5.SingleCycleData.decode(word, variant),
            "SingleCycleData.decode, from bytes": lambda: amm5.SingleCycleData.decode(
                int.from_bytes(data, "big"), variant
            ),
            "variant.decode": lambda: variant.decode(word),
        },
    )


def _measure_rs485() -> None:
    from lika_encoders import amm5

    variant = amm5.lookup("AMM5A23/65KJP1")
    made = amm5.CompleteReply(variant, False, False, singleturn=0x5A5A5A, encoder_id=0x23, multiturn=0x1234)
    data, busy = made.encode(), made._replace(busy=True)

    def floor() -> object:
        number = int.from_bytes(data, "little")
        return number >> 3 & 0xF, number >> 16 & 0xFFFFFF, number >> 48 & 0xFFFFFF, number >> 72 & 0xFF

    _compare(
        "RS-485 complete reply, 11 bytes",
        {
            "floor: int.from_bytes and a tuple, no CRC": floor,
            "CompleteReply.decode": lambda: amm5.CompleteReply.decode(data, variant),
            "decode_reply": lambda: amm5.decode_reply(data, variant),
            "frame.verdict": lambda: made.verdict,
            "frame.reports, nothing to report": lambda: made.reports,
            "frame.reports, busy": lambda: busy.reports,
        },
    )


def _compare(title: str, candidates: dict[str, Callable[[], object]]) -> None:
    """Prints each candidate's best time and its ratio to the first."""
    best = dict.fromkeys(candidates, float("inf"))
    for _ in range(ROUNDS):
        for name, function in candidates.items():
            best[name] = min(best[name], timeit.timeit(function, number=CALLS))
    base = next(iter(best.values()))
    print(title)
    for name, seconds in best.items():
        print(f"  {name:45} {seconds / CALLS * 1e9:7.0f} ns  x {seconds / base:.2f}")


if __name__ == "__main__":
    main()
