"""The interfaces, each in a module of its own: its names, its nature, and what a manual says of it.

They lie inside the model: a device is made of them, and they of layouts.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import get_args

from .biss import BankSelect, Biss, DescriptionFile, Network, Profile, Timeout
from .common import Clock, Signals
from .rs485 import Port, Rs485
from .ssi import Alignment, CableLength, OutputCode, Ssi

Interface = Ssi | Biss | Rs485
#: What ``facts`` of an interface yields: an output that shows each of these shows every interface.
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
