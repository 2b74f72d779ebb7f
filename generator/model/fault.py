"""Errors that make a decoder reject a frame."""

from enum import Enum


class Fault(Enum):
    """Frame errors, in the order in which a decoder checks for them."""

    LENGTH = "length"
    CRC = "crc"
    CONSTANT = "constant"
    RANGE = "range"
