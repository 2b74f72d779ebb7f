"""The interfaces, each in its own module with its names and the facts that a manual gives about it.

They are part of the model: a device consists of interfaces, and these of layouts.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import get_args

from .biss import BankSelect, Biss, DescriptionFile, Network, Profile, Timeout
from .common import Clock, Signals
from .rs485 import Port, Rs485
from .ssi import Alignment, CableLength, OutputCode, Ssi

Interface = Ssi | Biss | Rs485
#: Facts that ``facts`` of an interface yields. An output that can show each of these can show every interface.
Fact = (
    Clock
    | CableLength
    | Signals
    | Alignment
    | OutputCode
    | Profile
    | DescriptionFile
    | BankSelect
    | Network
    | Timeout
    | Port
)
#: Every interface by its name.
INTERFACES: Mapping[str, type[Interface]] = MappingProxyType({kind.name: kind for kind in get_args(Interface)})
