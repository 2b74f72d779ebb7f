# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Records about a device that do not belong to an interface, such as its alarms and connectors."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from ..reports import Interface

if TYPE_CHECKING:
    pass
from .fields import NO_NAMES


class ConnectorKind(Enum):
    """Kind of connection: a connector with pins, or a cable with colored wires."""

    CONNECTOR = "connector"
    CABLE = "cable"


class Alarm(NamedTuple):
    """Error or warning of the encoder.

    ``field`` is its flag, in a frame or in ``register``. ``latch`` is True if it stays active until it is reset.
    ``below_mv`` is the voltage in millivolts below which it is raised. ``cleared_by`` lists the procedures that clear
    it, and ``by_hand`` lists the characteristics that describe manual steps. ``only`` describes the order codes that
    have it, if not all do.
    """

    name: str
    meaning: str
    printed_name: str = ""
    register: str = ""
    field: str = ""
    detected: str = ""
    below_mv: int | None = None
    latch: bool | None = None
    implemented: bool = True
    remedy: str = ""
    cleared_by: tuple[str, ...] = ()
    names: Mapping[str, str] = NO_NAMES
    source: str = ""
    only: str = ""
    by_hand: tuple[str, ...] = ()


class Contact(NamedTuple):
    """Pin or wire. ``only`` lists the order codes that have it, or is empty if all have it."""

    contact: str
    signal: str
    only: str = ""


class Connector(NamedTuple):
    """Connector or cable."""

    name: str
    kind: ConnectorKind
    title: str
    interfaces: tuple[Interface, ...]
    contacts: tuple[Contact, ...]
    mating: str = ""
    note: str = ""
    source: str = ""


class LedState(NamedTuple):
    """State of an LED and its meaning.

    ``only`` describes the order codes that have it, if not all do. ``by_hand`` lists the characteristics that
    describe manual steps.
    """

    state: str
    meaning: str
    only: str = ""
    by_hand: tuple[str, ...] = ()


class Led(NamedTuple):
    """LED and the meaning of its states."""

    name: str
    title: str
    states: tuple[LedState, ...]
    source: str = ""


class Input(NamedTuple):
    """Hardware input. ``inverts`` and ``needs`` are register bits, written as ``register.field``."""

    name: str
    meaning: str
    printed_name: str = ""
    low: str = ""
    high: str = ""
    pulse_at_least_us: int | None = None
    inverts: str = ""
    needs: str = ""
    when_unused: str = ""
    note: str = ""
    names: Mapping[str, str] = NO_NAMES
    source: str = ""


class Table(NamedTuple):
    """Table of the manual."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    source: str = ""
    units: tuple[str, ...] = ()


class LostFigure(NamedTuple):
    """Content of a figure in the manual that is missing from its text."""

    content: str
    source: str = ""


class Quantity(NamedTuple):
    """Quantity such as ``torque``, with its bounds in ``unit``. ``where`` is the part that it applies to."""

    quantity: str
    unit: str
    min: float | None = None
    typical: float | None = None
    max: float | None = None
    where: str = ""


class Characteristic(NamedTuple):
    """Additional fact: its text, and its quantities with units in ``values``.

    ``only`` describes the order codes that it applies to, if not all.
    """

    name: str
    value: str
    only: str = ""
    source: str = ""
    values: tuple[Quantity, ...] = ()
