"""Members of the data of a family or order code as a whole."""

from __future__ import annotations

from .member import Member, Part

FAMILY = Part(
    "",
    "A family, or one order code with all values resolved. All members are always present. Numbers that the "
    "manual does not give are null, and texts that it does not give are empty. Numbers are integers, and bit "
    "0 is the least significant. The XML description of a device has the same members with the same names.",
    Member("version", "=1", "Version of this format."),
    Member("family", "name", "Name of the family."),
    Member(
        "base",
        "name",
        "Family of which this is a special model or another edition. Empty for most families.",
    ),
    Member("overlays", "[overlay]", "Overlays applied to the spec."),
    Member(
        "edition",
        "text",
        "Revision of the edition of the manual. Empty for the edition that the spec transcribes.",
    ),
    Member("editions", "[manual_edition]", "Editions that can be selected, oldest first."),
    Member("title", "string", "Name of the family, as used in running text."),
    Member("movement", "rotary|linear", "Kind of movement: rotary for an angle, linear for a length."),
    Member("order_code", "string?", "Order code. null for a family."),
    Member("interface", "string?", "Interface of the order code. null for a family."),
    Member("label", "label?", "Data read from the label. null for a family."),
    Member("manufacturer", "manufacturer", "Manufacturer."),
    Member("evidence", "evidence", "Evidence for the facts."),
    Member("manual", "manual", "Manual that was transcribed."),
    Member("documents", "[document]", "Public documents that sources cite."),
    Member(
        "parameters", "{integer}", "Value of every parameter of its interface for the order code. Empty for a family."
    ),
    Member("parameter_definitions", "[parameter]", "Parameters of the family."),
    Member("alternatives", "[alternative]", "Questions that the manual leaves open and the user must decide."),
    Member("order_code_grammar", "order_code_grammar", "Structure of an order code."),
    Member("order_codes", "[order_code]", "All enumerated order codes. For an order code, only that one."),
    Member("interfaces", "{kind:interface}", "Interfaces, by kind."),
    Member("layouts", "[layout]", "Frames of all interfaces."),
    Member("field_groups", "[field_group]", "Groups of fields that several layouts share."),
    Member("registers", "[register]", "Registers, in the order of the manual."),
    Member("crcs", "[crc]", "CRCs."),
    Member("alarms", "[alarm]", "Errors and warnings with their meaning."),
    Member("procedures", "[procedure]", "Sequences of writes, requests and waits."),
    Member("timings", "[timing]", "Timings of the device and of its interfaces."),
    Member("measurement", "measurement?", "Unit and range of the position."),
    Member("inputs", "[input]", "Hardware inputs."),
    Member("connectors", "[connector]", "Connectors and cables."),
    Member("leds", "[led]", "Diagnostic LEDs."),
    Member("characteristics", "[characteristic]", "Facts that are only displayed, never used in computations."),
    Member("tables", "[table]", "Tables that are only displayed, never used in computations."),
    Member("examples", "[example]", "Worked examples."),
    Member("errata", "[erratum]", "Errors in the manual, and the facts used instead."),
    Member("lost_figures", "[lost_figure]", "Figures that were not available."),
    Member(
        "supply",
        "supply?",
        "Supply voltage for all order codes. null if it depends on the order code or the manual does not give it.",
    ),
    Member("name"),
    Member("variants"),
    Member("times_read"),
    Member("releases"),
    of="Device",
    is_sourced=False,
)
