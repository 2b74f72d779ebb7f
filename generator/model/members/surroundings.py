"""Members of times, connectors, examples and other facts of the manual."""

from __future__ import annotations

from ..documents import EditionTest, LostFigure
from ..examples import Write
from ..facts import Characteristic, Connector, Contact, Input, Led, LedState, Quantity, Table, Timing
from ..measurement import Measurement
from .member import NAME, NAMES, NOTE, PRINTED_NAME, ModelMember, ModelPart, described_part

SURROUNDINGS = (
    described_part(
        Timing,
        ModelMember(
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
    ModelPart(
        "example",
        "A worked example.",
        NAME,
        ModelMember("kind", "frame|register|crc|procedure|measure", "Kind of comparison."),
        ModelMember("order_code", "string", "Order code that the example applies to."),
        ModelMember("alternatives", "{string}", "frame: chosen answers, each under the name of its alternative."),
        ModelMember("layout", "name", "frame: name of the layout."),
        ModelMember("register", "name", "register: name of the register."),
        ModelMember("procedure", "name", "procedure: name of the procedure."),
        ModelMember("crc", "name", "crc: name of the CRC."),
        ModelMember("from", "encoder|master", "frame: sender.", of="sender"),
        ModelMember("bytes", "string", "Bytes of the example."),
        ModelMember("bits", "string", "Bits in order of transmission."),
        ModelMember("check", "hex?", "crc: check value."),
        ModelMember("arguments", "{integer}", "procedure: arguments."),
        ModelMember("values", "{scalar}", "Expected values of fields, joins or groups of digits, by name."),
        ModelMember("writes", "[write]", "procedure: resulting writes."),
        ModelMember("refused", "|crc|constant|length|range", "frame: error for which a decoder rejects the frame."),
        ModelMember("counts", "integer?", "A position in counts."),
        ModelMember("micrometres", "integer?", "The same position in micrometres."),
        ModelMember("erratum", "name", "Erratum that explains an incorrect example."),
        NOTE,
        of="FrameExample RegisterExample CrcExample ProcedureExample MeasureExample",
    ),
    ModelPart(
        "erratum",
        "A place where the manual must not be followed literally.",
        NAME,
        ModelMember("title", "text", "Sentence that says what is wrong in the manual."),
        ModelMember("printed", "text", "Printed text. Text in double quotation marks is quoted to the letter."),
        ModelMember("used", "text", "Fact used instead."),
        ModelMember("why", "text", "Evidence for this choice."),
        ModelMember(
            "status",
            "settled|open",
            "settled if the manual's own evidence or arithmetic is decisive, otherwise open.",
        ),
        ModelMember("severity", "wrong_data|wrong_limit|omission|wording", "Effect of following the manual literally."),
        ModelMember("affects", "[name]", "Affected facts, as paths into the spec."),
        ModelMember(
            "overlay",
            "name",
            "Overlay that makes the change, if this is not an erratum of the manual. 'printed' is then the "
            "content of the spec, and 'used' the replacement.",
        ),
        ModelMember(
            "edition",
            "text",
            "Edition that makes the change, if this is not an erratum of the manual. 'printed' and 'used' are "
            "as for an overlay.",
        ),
        ModelMember("only", "string", "Order codes that the erratum concerns. Empty if it concerns all."),
    ),
    ModelPart(
        "overlay",
        "Overlays applied to the spec.",
        NAME,
        ModelMember("title", "text", "The manufacturer's document, or the author of the correction."),
        ModelMember(
            "special", "name", "End of the order codes that the overlay applies to. Empty if it applies to all."
        ),
        is_sourced=False,
    ),
    ModelPart(
        "manual_edition",
        "An edition of the manual that can be selected.",
        ModelMember("revision", "text", "Revision."),
        ModelMember("date", "text", "Release date. Empty if it is not known."),
        ModelMember("labels", "[text]", "Patterns of labels, as spelled in this edition."),
        ModelMember("tests", "[edition_test]", "Registers that identify an encoder of an earlier edition."),
        is_sourced=False,
    ),
    described_part(EditionTest),
    described_part(LostFigure),
    described_part(Measurement),
    described_part(Input),
    ModelPart(
        "table_row",
        "One row.",
        ModelMember("cells", "[text]", "Cells of the row."),
        is_sourced=False,
        of="",
    ),
    described_part(Table),
    ModelPart(
        "field_group",
        "Fields that several layouts share.",
        NAME,
        PRINTED_NAME,
        NAMES,
        ModelMember("bits", "integer", "Width of the group."),
        NOTE,
    ),
)
