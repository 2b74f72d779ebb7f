# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Classes for the tables from the manuals, except for frames and registers.

``source`` is the section and page of the manual. An empty string, an empty tuple or None means that the manual does
not give this fact.
"""

from __future__ import annotations

from .devices import (
    Alarm,
    Characteristic,
    Connector,
    ConnectorKind,
    Contact,
    Input,
    Led,
    LedState,
    LostFigure,
    Quantity,
    Table,
)
from .fields import AboveMax, Access, ByteOrder, Crc, FieldFacts, NamedValue, Register, RegisterMeaning, Scale
from .interfaces import (
    Alignment,
    BissFacts,
    CableLength,
    Clock,
    ControlField,
    DataChannels,
    DataIdFacts,
    Exchange,
    MemoryAccess,
    Network,
    Port,
    PrintedTimeout,
    Purpose,
    Rs485Facts,
    SpiFacts,
    SsiFacts,
    Timeout,
    TimeoutRule,
    Timing,
)
from .manuals import Document, Edition, Erratum, Manual, Revision, Severity, Status

__all__ = [
    "AboveMax",
    "Access",
    "Alarm",
    "Alignment",
    "BissFacts",
    "ByteOrder",
    "CableLength",
    "Characteristic",
    "Clock",
    "Connector",
    "ConnectorKind",
    "Contact",
    "ControlField",
    "Crc",
    "DataChannels",
    "DataIdFacts",
    "Document",
    "Edition",
    "Erratum",
    "Exchange",
    "FieldFacts",
    "Input",
    "Led",
    "LedState",
    "LostFigure",
    "Manual",
    "MemoryAccess",
    "NamedValue",
    "Network",
    "Port",
    "PrintedTimeout",
    "Purpose",
    "Quantity",
    "Register",
    "RegisterMeaning",
    "Revision",
    "Rs485Facts",
    "Scale",
    "Severity",
    "SpiFacts",
    "SsiFacts",
    "Status",
    "Table",
    "Timeout",
    "TimeoutRule",
    "Timing",
]
