"""Members of times, connectors, examples and other facts of the manual."""

from __future__ import annotations

from ..documents import EditionTest, LostFigure
from ..examples import Write
from ..facts import Characteristic, Connector, Contact, Input, Led, LedState, Quantity, Table, Timing
from ..measurement import Measurement
from .member import NAME, NAMES, NOTE, PRINTED_NAME, Member, Part, described_part

SURROUNDINGS = (
    described_part(
        Timing,
        Member(
            "interface", "|ssi|biss|rs485|spi", "Interface that the item belongs to. Empty for the device as a whole."
        ),
        after="meaning",
    ),
    described_part(Contact),
    described_part(Connector),
    described_part(LedState),
    described_part(Led),
    described_part(Characteristic),
    described_part(Quantity),
    described_part(Write),
    Part(
        "example",
        "A worked example.",
        NAME,
        Member("kind", "frame|register|crc|procedure|measure", "Kind of comparison."),
        Member("order_code", "string", "Order code to which the example applies."),
        Member("alternatives", "{string}", "frame: chosen answers, each under the name of its alternative."),
        Member("layout", "name", "frame: name of the layout."),
        Member("register", "name", "register: name of the register."),
        Member("procedure", "name", "procedure: name of the procedure."),
        Member("crc", "name", "crc: name of the CRC."),
        Member("from", "encoder|master", "frame: sender.", of="sender"),
        Member("bytes", "string", "Bytes of the example."),
        Member("bits", "string", "Bits in order of transmission."),
        Member("check", "hex?", "crc: check value."),
        Member("arguments", "{integer}", "procedure: arguments."),
        Member("values", "{scalar}", "Expected values of fields, joins or groups of digits, by name."),
        Member("writes", "[write]", "procedure: resulting writes."),
        Member("refused", "|crc|constant|length|range", "frame: the error with which a decoder rejects it."),
        Member("counts", "integer?", "A position in counts."),
        Member("micrometres", "integer?", "The same position in micrometres."),
        Member("erratum", "name", "Erratum that explains an incorrect example."),
        NOTE,
        of="FrameExample RegisterExample CrcExample ProcedureExample MeasureExample",
    ),
    Part(
        "erratum",
        "A passage of the manual that must not be followed literally.",
        NAME,
        Member("title", "text", "Sentence that says what is wrong in the manual."),
        Member("printed", "text", "Printed text. Text in double quotation marks is quoted to the letter."),
        Member("used", "text", "Fact used instead."),
        Member("why", "text", "Evidence for this choice."),
        Member(
            "status",
            "settled|open",
            "settled if the manual's own evidence or arithmetic is decisive, otherwise open.",
        ),
        Member("severity", "wrong_data|wrong_limit|omission|wording", "Effect of following the manual literally."),
        Member("affects", "[name]", "Affected facts, as paths into the spec."),
        Member(
            "overlay",
            "name",
            "Overlay that makes the change, if this is not an erratum of the manual. 'printed' is then the "
            "content of the spec, and 'used' the replacement.",
        ),
        Member(
            "edition",
            "text",
            "Edition that makes the change, if this is not an erratum of the manual. 'printed' and 'used' are "
            "as for an overlay.",
        ),
        Member("only", "string", "Order codes that the erratum concerns. Empty if it concerns all."),
    ),
    Part(
        "overlay",
        "Overlays applied to the spec.",
        NAME,
        Member("title", "text", "The manufacturer's document, or the author of the correction."),
        Member("special", "name", "End of the order codes that the overlay applies to. Empty if it applies to all."),
        is_sourced=False,
    ),
    Part(
        "manual_edition",
        "An edition of the manual that can be selected.",
        Member("revision", "text", "Revision."),
        Member("date", "text", "Release date. Empty if it is not known."),
        Member("labels", "[text]", "Patterns of labels, as spelled in this edition."),
        Member("tests", "[edition_test]", "Registers that identify an encoder of an earlier edition."),
        is_sourced=False,
    ),
    described_part(EditionTest),
    described_part(LostFigure),
    described_part(Measurement),
    described_part(Input),
    Part(
        "table_row",
        "One row.",
        Member("cells", "[text]", "Cells of the row."),
        is_sourced=False,
        of="",
    ),
    described_part(Table),
    Part(
        "field_group",
        "Fields that several layouts share.",
        NAME,
        PRINTED_NAME,
        NAMES,
        Member("bits", "integer", "Width of the group."),
        NOTE,
    ),
)
