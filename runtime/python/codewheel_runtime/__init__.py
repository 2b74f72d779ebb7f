# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Code shared by the packages of all manufacturers, such as verdicts, errors, and the functions that run procedures.

The package of a manufacturer also has the names that most programs need. They are the same objects, so encoders
from several manufacturers can be used together.
"""

from __future__ import annotations

from .codec import BitField, PositionRange
from .encoder import Encoder, Frame, PositionFrame, not_an_encoder_error
from .errors import ConstantError, CrcError, FamilyError, FrameError, InterfaceError, LengthError, RangeError
from .order_codes import OrderCodeError
from .reports import Family, Interface, Movement, Report, Verdict
from .running import Bus, Line, Reading, StepError, VerifyError, run
from .steps import Modify, Poll, Read, Send, Step, Verify, Wait, Write
from .version import __version__

__all__ = [
    "BitField",
    "Bus",
    "ConstantError",
    "CrcError",
    "Encoder",
    "Family",
    "FamilyError",
    "Frame",
    "FrameError",
    "Interface",
    "InterfaceError",
    "LengthError",
    "Line",
    "Modify",
    "Movement",
    "OrderCodeError",
    "Poll",
    "PositionFrame",
    "PositionRange",
    "RangeError",
    "Read",
    "Reading",
    "Report",
    "Send",
    "Step",
    "StepError",
    "Verdict",
    "Verify",
    "VerifyError",
    "Wait",
    "Write",
    "__version__",
    "run",
    "why",
]


def why(encoder: Encoder, frame: object) -> tuple[str, ...]:
    """Find the common mistakes that explain an invalid frame, such as swapped wires.

    A short CRC is sometimes correct by chance. Check several frames, and look for a single mistake that explains
    all of them.

    Args:
        encoder: The encoder.
        frame: The frame, in any form that ``encoder.decode`` accepts.

    Returns:
        Descriptions of the changes that make the frame valid, the most likely first. Empty if none is known.

    Raises:
        TypeError: ``encoder`` is not an encoder.
    """
    from .causes import why

    if not hasattr(encoder, "decode"):
        raise not_an_encoder_error(encoder)
    return why(encoder, frame)
