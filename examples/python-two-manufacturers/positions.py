"""Decode frames of encoders of two manufacturers with one function."""

import lika_encoders
import tolvarn_encoders
from codewheel_runtime import Encoder, FrameError, PositionFrame, Verdict


def describe_frame(encoder: Encoder, word: int) -> str:
    """Return the position in a frame as text, or the reason why there is none."""
    try:
        frame = encoder.decode(word)
    except FrameError as error:
        return f"{type(error).__name__}: {error}"
    if not isinstance(frame, PositionFrame) or frame.verdict is Verdict.NOT_USABLE:
        return "not usable: " + ", ".join(report.name for report in frame.reports)
    return f"position {frame.position}"


lika, tolvarn = lika_encoders.lookup("AMM5A21/65KSC1"), tolvarn_encoders.lookup("TV62-M17-B1")
received = [
    (lika, 0xF4243D3),
    (lika, 0xF424355),
    (lika, 0xF4243D2),
    (tolvarn, 0x9A4FF98E54587),
    (tolvarn, 0x9A4FF98E54586),
]

if __name__ == "__main__":
    for encoder, word in received:
        print(f"{encoder.family.manufacturer}, {encoder.code}: {describe_frame(encoder, word)}")
