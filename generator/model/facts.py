"""Facts that outputs only display: alarms, wiring, timings, quantities and tables."""

from __future__ import annotations

from typing import Literal

from .manual import Sources
from .part import (
    BY_HAND,
    NOTHING,
    STEPS,
    Cells,
    Count,
    InterfaceName,
    Name,
    Names,
    Phrase,
    Prose,
    RegisterBit,
    Unit,
    key,
    meaning_key,
    name_key,
    names_key,
    note_key,
    only_key,
    part,
    printed_name_key,
    source_key,
)


@part(
    "A time, given by its bounds in microseconds.",
    data="A time, given by its bounds.",
    identity="at_least_us typical_us at_most_us",
)
class Timing:
    name: Name = name_key("Name of the timing.")
    symbol: Phrase = key("Symbol in the manual.", default="", rule="timing-typical")
    meaning: Prose = key("Meaning of the time.", rule="words")
    at_least_us: Count | None = key("Lower bound in microseconds.", default=None, rule="wait-longer", label="at least")
    typical_us: Count | None = key(
        "Typical value in microseconds.", default=None, rule="timing-typical", label="typically"
    )
    at_most_us: Count | None = key("Upper bound in microseconds.", default=None, rule="time-limit", label="at most")
    only: Phrase = only_key(default="", rule="timing-typical")
    source: Sources = source_key()


@part(
    "Supply voltage that the encoder needs. As a key of the device, it applies to all order codes. "
    "As a key of a value of an order code part, it applies only to the order codes with that value.",
    data="Supply voltage, including tolerance.",
)
class Supply:
    """Supply voltage that an encoder needs, tolerance included."""

    min_mv: int = key(
        "Lowest voltage in millivolts, including tolerance: 4750 for +5 V ±5 %.",
        data="Lowest voltage in millivolts.",
        minimum=1,
        maximum=1000000,
        rule="supply-narrower",
        label="lowest",
    )
    max_mv: int = key(
        "Highest voltage in millivolts, including tolerance.",
        data="Highest voltage in millivolts.",
        minimum=1,
        maximum=1000000,
        rule="supply-narrower",
        label="highest",
    )
    source: Sources = source_key(default=())


@part("An error or a warning.", identity="register field")
class Alarm:
    name: Name = name_key("Name of the alarm.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = names_key(default=NOTHING)
    group: Name = key("Field group that contains the flag.", data="Group of fields that contains the flag.", default="")
    register: Name = key(
        "Register that contains the flag, instead of a group.",
        data="Register that contains the flag.",
        default="",
        rule="alarm-bit",
        refers_to="register",
    )
    field: Name = key(
        "Flag in that group or register.", default="", rule="alarm-bit", label="bit", refers_to="any-field"
    )
    meaning: Prose = key("Event that the alarm signals.", rule="words")
    detected: Prose = key("Time at which the encoder checks for the alarm.", default="", rule="words")
    below_mv: Count | None = key(
        "Voltage in millivolts below which the alarm is raised.",
        default=None,
        rule="alarm-threshold",
        label="threshold",
        read="alarm",
    )
    latch: bool | None = key(
        "True if the alarm remains active until it is reset.",
        reading="null if the manual does not say.",
        default=None,
        rule="alarm-rule",
        label="kept until reset",
        read="alarm",
        noun="latching",
    )
    implemented: bool = key(
        "False if this encoder does not implement it. Default: true.",
        data="True if this encoder implements the item.",
        default=True,
        rule="alarm-rule",
        read="alarm",
        noun="presence in this encoder",
    )
    remedy: Prose = key("Instructions for clearing the alarm.", default="", rule="words")
    cleared_by: tuple[Name, ...] = key(
        "Procedures that clear the alarm.",
        least=0,
        default=(),
        rule="alarm-rule",
        read="alarm",
        noun="clearing procedures",
        refers_to="procedures",
    )
    only: Phrase = only_key(default="", writing="Its flag must have the same patterns.", rule="alarm-rule")
    by_hand: tuple[Name, ...] = key(
        "Names of characteristics that list steps for a person.",
        writing=STEPS,
        data=BY_HAND,
        default=(),
        rule="alarm-rule",
        label="manual steps",
        read="alarm",
    )
    source: Sources = source_key()

    @property
    def flag_name(self) -> str:
        """Name of its flag in frames and registers, which may differ from the alarm's own name."""
        return self.field or self.name


@part("One contact.", identity="contact signal")
class Contact:
    contact: Phrase = key("Pin number or wire color, as text.", data="Pin number or wire color.")
    signal: Phrase = key("Function as printed.", rule="contact")
    only: Phrase = only_key(
        "Order codes to which it applies, as in .../65K...:",
        default="",
        data="Order codes that have the contact.",
        rule="contact",
        read="pin",
    )


@part("A connector or a cable.", identity="contacts")
class Connector:
    name: Name = name_key("Name of the connector or cable.")
    kind: Literal["connector", "cable"] = key(
        "A connector with pins, or a cable with colored wires.", data="Kind: connector or cable.", rule="contact"
    )
    title: Phrase = key("Type and gender as printed.", rule="words")
    interfaces: tuple[InterfaceName, ...] = key(
        "Interfaces for which it is wired.",
        data="Interfaces that the connector is wired for. Empty for all.",
        least=0,
        default=(),
        rule="contact",
        data_type="[name]",
    )
    mating: Prose = key("Mating connector.", default="", rule="words")
    contacts: tuple[Contact, ...] = key("Contacts of the connector, or wires of the cable.")
    note: Prose = note_key(default="")
    source: Sources = source_key()


@part("One state.")
class LedState:
    state: Phrase = key("State that a person sees.")
    meaning: Prose = key("Meaning of the state.", data="Meaning.")
    only: Phrase = only_key(default="", read="LED")
    by_hand: tuple[Name, ...] = key(
        "Names of characteristics that list steps for a person.",
        writing=STEPS,
        data=BY_HAND,
        default=(),
        label="steps by hand",
        read="LED",
    )


@part("A diagnostic LED.")
class Led:
    name: Name = name_key("Name of the LED.")
    title: Phrase = key("Label as printed.")
    states: tuple[LedState, ...] = key("States of the LED.")
    source: Sources = source_key()


@part("A quantity with its bounds.", writing="State a tolerance as the resulting bounds.", is_sourced=False)
class Quantity:
    """A quantity with its bounds. ``where`` is the part that it applies to, if there are several."""

    quantity: Literal[
        "angle",
        "area",
        "battery",
        "bending_radius",
        "clearance",
        "coverage",
        "current",
        "frequency",
        "length",
        "mass",
        "resistance",
        "resistance_per_length",
        "speed",
        "supply",
        "temperature",
        "time",
        "torque",
        "voltage",
    ] = key(
        "Kind of quantity.",
        data="Kind of quantity, such as torque.",
        label="kind",
        read="characteristic",
        data_type="string",
    )
    where: Phrase = key(
        "Part or condition to which it applies, if there are several.",
        data="Part or condition that it applies to. Empty if there is only one.",
        default="",
    )
    min: float | None = key("Lower bound.", default=None, label="lower bound", read="characteristic")
    typical: float | None = key("Typical or nominal value.", default=None, label="typical value", read="characteristic")
    max: float | None = key("Upper bound.", default=None, label="upper bound", read="characteristic")
    unit: Literal[
        "%",
        "A",
        "Hz",
        "MHz",
        "MΩ",
        "Nm",
        "V",
        "Vpp",
        "diameters",
        "g",
        "in",
        "kHz",
        "kg",
        "m",
        "m/s",
        "mA",
        "min",
        "mm",
        "mm²",
        "ms",
        "s",
        "°",
        "°C",
        "°F",
        "µm",
        "µs",
        "Ω",
        "Ω/km",
    ] = key("Unit of the numbers.", read="characteristic", data_type="string")


@part("A fact that is only displayed, never used in computations.")
class Characteristic:
    name: Name = name_key("Name of the fact.")
    value: Prose = key("The fact, as text.", data="Fact as text.")
    values: tuple[Quantity, ...] = key(
        "The quantities in the text, with units. Each must agree with the text.",
        data="Quantities in the text.",
        default=(),
    )
    only: Phrase = only_key(default="", data="Order codes that the item applies to.", read="characteristic")
    source: Sources = source_key()


@part("A hardware input.", identity="inverts low high")
class Input:
    """A hardware input. ``inverts`` and ``needs`` refer to register bits as ``register.field``."""

    name: Name = name_key("Name of the input.")
    printed_name: Prose = printed_name_key(default="")
    names: Names = names_key(default=NOTHING)
    meaning: Prose = meaning_key("Function of the input.")
    low: Prose = key("Meaning of the low level (0 V).", data="Effect of a low level.", default="", rule="words")
    high: Prose = key("Meaning of the high level (+V).", data="Effect of a high level.", default="", rule="words")
    pulse_at_least_us: Count | None = key(
        "Minimum pulse length in microseconds.",
        default=None,
        rule="input-rule",
        label="pulse of at least",
        read="time",
        noun="pulse",
    )
    inverts: RegisterBit = key(
        "Register bit whose meaning the high level inverts, as register.field.",
        data="register.field whose meaning the high level inverts.",
        default="",
        rule="input-rule",
        read="input",
        noun="inverted bit",
        refers_to="dotted",
    )
    needs: RegisterBit = key(
        "Register bit that enables the input, as register.field.",
        data="register.field that enables the input.",
        default="",
        rule="input-rule",
        read="input",
        noun="enabling bit",
        refers_to="dotted",
    )
    when_unused: Prose = key("Connection of the input when it is not used.", default="", rule="input-rule")
    note: Prose = note_key(default="")
    source: Sources = source_key()


@part("A table as in the manual.", data="A table of the manual that is only displayed, never used in computations.")
class Table:
    name: Name = name_key("Name of the table.")
    title: Phrase = key("Subject of the table.")
    columns: tuple[Prose, ...] = key("Headings, with units.", data="Column headings.", most=12)
    units: tuple[Unit, ...] = key(
        "Units of the columns that contain numbers, in order. A column of text has an empty string.",
        data="Units of the columns that contain numbers. A column of text has an empty string.",
        most=12,
        default=(),
        read="table",
    )
    rows: tuple[Cells, ...] = key("Rows, each with one cell per column.", data="Rows of the table.")
    note: Prose = note_key("Footnotes.", default="")
    source: Sources = source_key()
