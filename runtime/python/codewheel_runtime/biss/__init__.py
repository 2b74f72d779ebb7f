# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Register access over BiSS C with control frames, for masters and slaves.

A BiSS frame carries one bit of control data each way: CDM from the master, the inverse of the level of MA during the
timeout, and CDS from the slave, after the start bit. The bits of successive frames form a control frame, which reads
or writes registers:

==== ================================= ==================================================================
step CDM                               CDS, the answers to these bits
==== ================================= ==================================================================
1    at least 14 zeros                 0
2    S = 1, CTS = 1, ID2..0, ADR6..0,  IDL0..15: each slave takes the first bit that is still 0 as its ID
     CRC3..0                           (there are 8 IDs)
3    R W: 10 to read, 01 to write      the same R W. An inverted W refuses the register
4    S = 1                             S = 1, or 0 while the slave is busy. The master then sends S again
5    DATA7..0, CRC3..0 to write, 12    DATA7..0, CRC3..0: the byte read, or the byte received
     zeros to read
6    P = 0                             P = 0, or 1 to refuse the next register
7    S = 1 as in 4 for the next
     register, or 0 to end
==== ================================= ==================================================================

CDS comes early in a frame and CDM at its end, so the answer to a bit comes in the next frame. The CRC is x^4 + x + 1,
start value 0, inverted, over CTS, ID and ADR, or over a byte of data. S, R, W, P and IDL are not protected by a CRC.
Therefore:

* A write that no slave understood looks like a refused write: the bits R and W come back as 00.
* If the slave's S bit is lost on its way to the master, master and slave stay out of step by one bit. A byte read then
  fails its CRC. A byte written is not stored, but values whose CRC ends in 0 (half of all values) are echoed as if they
  had been stored. Read back what you write.
* An incomplete byte can be stored: if a write is aborted within a byte, the slave can store the bits that it has
  received, followed by zeros, if the CRC of that value is 0 (one in 68 combinations of bit position and value). Write
  such a register again, and take special care if any value in it starts an action.

Source: "BiSS Interface, Protocol Description (BiSS C)", Rev C6, iC-Haus, pages 9 to 14 and 18. Three details come from
two published masters: the CRC covers CTS, each answer comes in the frame described above, and P comes before another
S. The masters are lenzencoders/BISS-C (BiSS_C_Master/lib/BiSS_C_Master) and TexasInstruments/motor-control-sdk
(source/position_sense/bissc). Two details are inferred: that the end of a chain has ID 0, and how a slave reacts to a
corrupted byte or to R W = 00 or 11. Not yet tested on hardware. Commands (CTS = 0) are not supported:
a :class:`Slave` ignores them.
"""

from __future__ import annotations

from .control import IDS, REGISTERS, ZEROS, Outcome, crc, decode_byte, encode_byte
from .master import AccessError, Master, RegisterBus
from .requests import Answer, Request
from .slave import Slave, Wants

__all__ = [
    "IDS",
    "REGISTERS",
    "ZEROS",
    "AccessError",
    "Answer",
    "Master",
    "Outcome",
    "RegisterBus",
    "Request",
    "Slave",
    "Wants",
    "crc",
    "decode_byte",
    "encode_byte",
]
