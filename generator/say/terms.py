"""The words of manuals and interfaces, each explained in a sentence or two."""

from __future__ import annotations

from dataclasses import dataclass

from ..model import Biss, Interface, Rs485


@dataclass(frozen=True, slots=True)
class Term:
    """A word: what it means, and by which words of a spec its places are found.

    ``over`` says that it belongs to an interface, whose section ``section`` is about it; else ``spelled`` has the names
    of fields, registers and times that are about it.
    """

    name: str
    meaning: str
    spelled: tuple[str, ...] = ()
    over: type[Interface] | None = None
    section: str = ""


TERMS = (
    Term(
        "ALMC",
        "The byte of a reply over RS-485 that has a bit for each alarm. Status bits that sum alarms up do not say "
        "which one it is; ALMC does.",
        ("almc",),
    ),
    Term(
        "Acknowledge, start bit",
        "In a BiSS frame SLO stays low until the data of the encoder are ready; the start bit, high, says that they "
        "follow.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Bank",
        "Registers that share addresses: a register of its own selects which of them answer.",
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
        "Control data, slave: the bit of control data with which the encoder answers; it stands right after the start "
        "bit of a BiSS frame.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Control data",
        "How registers are read and written over BiSS while positions go on: one bit each way with every frame, CDM "
        "and CDS, until address, direction, data and a CRC of their own are complete.",
        over=Biss,
        section="control-data",
    ),
    Term(
        "Control field, data ID",
        "The first byte of a request over RS-485, and of its reply. The data ID in it says what is asked for.",
        ("control field", "data id"),
    ),
    Term(
        "CRC",
        "The remainder of a division of the bits before it: a frame in which bits were disturbed has another one. It "
        "is known by its polynomial, start value, order of bits, and by what is XORed to it at the end.",
        ("crc",),
    ),
    Term(
        "CRC polynomial",
        "The divisor of a CRC. Masters ask for it with its top bit, without it, or without its last 1: three numbers "
        "for one polynomial.",
        ("crc",),
    ),
    Term(
        "CRC sent inverted",
        "Each bit of the CRC is sent as its inverse; a tool calls that XORed at the end with all ones.",
        ("crc",),
    ),
    Term(
        "CRC reflected",
        "Bits go into the division, or come out of it, the least significant one first, as a serial port sends them.",
        ("crc",),
    ),
    Term(
        "Counts",
        "The steps into which a revolution, or a length, is divided: the unit of a position.",
        ("position", "singleturn"),
    ),
    Term(
        "Device ID, manufacturer ID, profile ID",
        "Registers that hold the same in each encoder of a kind, by which a master knows what it talks to.",
        ("device id", "manufacturer id", "profile id"),
    ),
    Term(
        "Error bit, warning bit",
        "The two bits after the position of a BiSS frame, called nE and nW as they are 0 when active: not to be used, "
        "and to be used with care.",
        over=Biss,
        section="frames",
    ),
    Term(
        "Gray code",
        "A code in which one bit alone changes from each number to the next. It has to be turned into binary before "
        "one calculates with it.",
        ("gray",),
    ),
    Term(
        "MA, SLO",
        "The lines of BiSS: the clock from the master, and the data from the encoder.",
        over=Biss,
        section="wiring",
    ),
    Term(
        "MEM BUSY",
        "A bit of replies about the EEPROM: while it is set the memory is at work, and the request is not carried out.",
        ("mem busy",),
    ),
    Term("Multiturn", "The number of whole revolutions, or the encoder that counts them.", ("multiturn",)),
    Term(
        "Offset",
        "A number that the encoder adds to each position.",
        ("offset",),
    ),
    Term(
        "Preset",
        "The number that the encoder is to show at the place where its shaft stands when the preset is activated; all "
        "other positions follow from it.",
        ("preset",),
    ),
    Term(
        "Profile",
        "Which fields single cycle data have, and in which order, as BiSS documents agree on.",
        over=Biss,
        section="frames",
    ),
    Term(
        "Single cycle data, SCD",
        "What a BiSS encoder sends with each frame: the position, error bit, warning bit, and a CRC over them.",
        over=Biss,
        section="frames",
    ),
    Term("Singleturn", "The position within one revolution, or the encoder that knows no other.", ("singleturn",)),
    Term(
        "Status field",
        "The byte of a reply over RS-485 that sums up errors and warnings.",
        ("status field",),
    ),
    Term(
        "Time-out",
        "The rest of a BiSS frame: how long MA stands still before the encoder is ready for the next one.",
        over=Biss,
        section="timings",
    ),
    Term(
        "Tm, monoflop time",
        "Over SSI: how long the data line stays low after the last clock.",
        ("tm",),
    ),
    Term("Tp, pause", "Over SSI: the least time between two words.", ("tp",)),
    Term(
        "Repeated request",
        "Over RS-485 a reset is a request that is sent several times in a row, with a pause between them and no other "
        "request.",
        over=Rs485,
        section="procedures",
    ),
)
