"""Interfaces, each in its own module with its names and the facts that a manual gives about it.

They are part of the model. A device has interfaces, and an interface has layouts.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import get_args

from .biss import BankSelect, Biss, DescriptionFile, Network, Profile, Timeout
from .common import Clock, Signals
from .rs485 import Port, Rs485
from .spi import Spi, WordFormat
from .ssi import Alignment, CableLength, OutputCode, Ssi

Interface = Ssi | Biss | Rs485 | Spi
#: Facts yielded by the method ``facts`` of an interface. An output that can show all of these can show any interface.
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
    | WordFormat
)
#: All interfaces by name.
INTERFACES: Mapping[str, type[Interface]] = MappingProxyType({kind.name: kind for kind in get_args(Interface)})
