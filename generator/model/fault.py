"""The faults for which a decoder refuses a frame."""

from enum import Enum


class Fault(Enum):
    """The faults of a frame, in the order in which a decoder looks for them."""

    LENGTH = "length"
    CRC = "crc"
    CONSTANT = "constant"
    RANGE = "range"
