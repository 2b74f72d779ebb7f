"""Terms used in manuals and for interfaces, each explained in a sentence or two."""

from __future__ import annotations

from ..model import Biss, Interface, Rs485
from ..model.record import dataclass


@dataclass(frozen=True, slots=True)
class Term:
    """Term with its meaning, and the parts of a spec from which it is linked.

    A term of an interface has ``over`` and the ``section`` that covers it. All other terms have ``spelled``, the names
    of the related fields, registers and times.
    """

    name: str
    meaning: str
    spelled: tuple[str, ...] = ()
    over: type[Interface] | None = None
    section: str = ""


TERMS = (
    Term(
        "ALMC",
        "The byte of an RS-485 reply that has a bit for each alarm. It identifies the alarm when a status bit only "
        "indicates that there is one.",
        ("almc",),
    ),
    Term(
        "Acknowledge, start bit",
        "In a BiSS frame, SLO stays low until the encoder's data is ready. The start bit (high) announces the data.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Bank",
        "One of several sets of registers at the same addresses. A separate register selects the bank that answers.",
        ("bank", "bank select"),
    ),
    Term(
        "CDM",
        "Control data, master: the bit of control data that the master sends with each BiSS frame. It is the inverse "
        "of the level of MA during the time-out.",
        over=Biss,
        section="timings",
    ),
    Term(
        "CDS",
        "Control data, slave: the bit of control data that the encoder sends. It directly follows the start bit of a "
        "BiSS frame.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Control data",
        "Access to registers over BiSS without interrupting the position data. Each frame carries one bit in each "
        "direction, CDM and CDS, until address, direction, data and their own CRC are complete.",
        over=Biss,
        section="control-data",
    ),
    Term(
        "Control field, data ID",
        "The first byte of an RS-485 request and of its reply. The data ID in it selects the requested data.",
        ("control field", "data id"),
    ),
    Term(
        "CRC",
        "Checksum that detects disturbed bits: the remainder of a division of the preceding bits. It is defined by "
        "its polynomial, start value, bit order and final XOR.",
        ("crc",),
    ),
    Term(
        "CRC polynomial",
        "The divisor of a CRC. Masters expect it with its top bit, without its top bit, or without its "
        "trailing 1 (Koopman notation): three numbers for the same polynomial.",
        ("crc",),
    ),
    Term(
        "CRC sent inverted",
        "Each bit of the CRC is sent inverted. Tools call this a final XOR with all ones.",
        ("crc",),
    ),
    Term(
        "CRC reflected",
        "The input or the result of the division is processed least significant bit first, as a serial port sends it.",
        ("crc",),
    ),
    Term(
        "Counts",
        "The steps into which a revolution or a length is divided, used as the unit of a position.",
        ("position", "singleturn"),
    ),
    Term(
        "Device ID, manufacturer ID, profile ID",
        "Registers with the same content in all encoders of a type, from which a master identifies the encoder.",
        ("device id", "manufacturer id", "profile id"),
    ),
    Term(
        "Error bit, warning bit",
        "Two active-low bits after the position in a BiSS frame: nE (0 = error, do not use the position) and nW "
        "(0 = warning).",
        over=Biss,
        section="frames",
    ),
    Term(
        "Gray code",
        "A code in which only one bit changes between consecutive numbers. Convert it to binary before you "
        "calculate with it.",
        ("gray",),
    ),
    Term(
        "MA, SLO",
        "The two lines of BiSS: clock from the master (MA) and data from the encoder (SLO).",
        over=Biss,
        section="wiring",
    ),
    Term(
        "MEM BUSY",
        "A bit in replies about the EEPROM. While it is set, the memory is busy and the request is not carried out.",
        ("mem busy",),
    ),
    Term("Multiturn", "The number of whole revolutions, or an encoder that counts them.", ("multiturn",)),
    Term(
        "Offset",
        "A number that the encoder adds to each position.",
        ("offset",),
    ),
    Term(
        "Preset",
        "Value that the encoder reports at the current shaft position once the preset is activated. All other "
        "positions shift accordingly.",
        ("preset",),
    ),
    Term(
        "Profile",
        "Standardized selection and order of the fields in single cycle data.",
        over=Biss,
        section="frames",
    ),
    Term(
        "Single cycle data, SCD",
        "The data in each frame of a BiSS encoder: position, error bit, warning bit, and a CRC over them.",
        over=Biss,
        section="frames",
    ),
    Term(
        "Singleturn", "The position within one revolution, or an encoder without a revolution counter.", ("singleturn",)
    ),
    Term(
        "Status field",
        "The byte of an RS-485 reply that summarizes errors and warnings.",
        ("status field",),
    ),
    Term(
        "Time-out",
        "The pause at the end of a BiSS frame, without clocks on MA, before the encoder is ready for the next frame.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Tm, monoflop time",
        "SSI: the time for which the data line stays low after the last clock.",
        ("tm",),
    ),
    Term("Tp, pause", "SSI: the minimum time between two words.", ("tp",)),
    Term(
        "Repeated request",
        "RS-485: a reset is a request that is sent several times in succession, with a pause after each and no other "
        "request in between.",
        over=Rs485,
        section="procedures",
    ),
)
