"""Values in a spec that a mistake can change: their places, kinds, and classes of fact."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from codewheel.language.document import Document, Path
from codewheel.language.schema_check import load_schema

#: Quantities with which a wrong value can damage hardware.
_HAZARDS = frozenset("battery clearance current frequency supply temperature torque".split())
#: Classes of facts by their keys without list indexes. The first match applies. Capitals represent a key with any name.
_CLASSES = (
    ("source", r".*\b(source|alignment_source|output_code_source)"),
    ("erratum", r"errata\b.*"),
    ("example", r"examples\b.*"),
    ("characteristic, hazard", r"characteristics\.HAZARD\b.*"),
    ("characteristic", r"characteristics\b.*"),
    ("table", r"tables\b.*"),
    ("LED", r"leds\b.*"),
    ("document", r"(lost_figures|documents)\b.*"),
    ("contents", r"manual\.contents\b.*"),
    (
        "manual",
        r"(codewheel|device|manufacturer|title|(evidence|manual)\b.*|python_package|version|trademarks|vendor|website)",
    ),
    ("BiSS manufacturer ID", r"biss_id"),
    ("edition", r"editions\b.*"),
    ("movement", r"movement"),
    ("supply", r".*\bsupply\b.*"),
    ("parameter", r"parameters\.NAME\.(equals|hexadecimal|unit|alternative|interface|read_from)"),
    ("limit", r"parameters\.NAME\.(min|max)"),
    ("order code: sets", r"order_code\.parts\.values\.NAME\.sets\.NAME"),
    ("order code: interface", r"order_code\.parts\.values\.NAME\.interface"),
    ("order code: labels", r"order_code\.(pattern|parts|also_written)\b.*"),
    ("alternative", r"alternatives\b.*"),
    ("printed once more", r"(printed_defaults\b.*|registers\.addresses|procedures\.printed_writes\b.*)"),
    ("CRC", r"crcs\b.*"),
    ("CRC", r".*\bfields\.crc"),
    ("clock", r"interfaces\.NAME\.clock\b.*"),
    ("cable length", r"interfaces\.NAME\.cable_lengths\b.*"),
    ("time", r"(interfaces\.NAME\.)?(timings|timeout)\b.*"),
    ("serial port", r"interfaces\.NAME\.port\b.*"),
    ("network", r"interfaces\.NAME\.network\b.*"),
    ("data ID", r"interfaces\.NAME\.data_ids\b.*"),
    ("memory access", r"interfaces\.NAME\.memory_access\b.*"),
    ("measurement", r"(interfaces\.NAME\.)?measurement\b.*"),
    ("byte order", r".*\bbyte_order"),
    ("position", r".*\bfields\.(bits|at|top_bit|low_bit|padded_to|use|name|parity_of|parity|signed|digits\b.*)"),
    ("position", r".*\b(join|gray)\b.*"),
    ("position", r"(field_groups|interfaces\.NAME\.(layouts|control_data)|registers)(\.fields)?"),
    ("position", r"field_groups\.bits"),
    ("selector", r"interfaces\.NAME\.layouts\.(when\b.*|from|channel)"),
    (
        "layout",
        r"(interfaces\.NAME\.(layouts|control_data)|registers|field_groups)\.(other_bits|carried_as|name)",
    ),
    ("layout", r"interfaces\.NAME\.layouts"),
    ("named value", r".*\bfields\.values(\.NAME)?(\.value)?"),
    ("active level", r".*\bfields\.active"),
    ("constant", r".*\bfields\.(constant|unused|equals|text|values_of)"),
    ("default", r"registers\.default"),
    ("default", r".*\bfields\.(default|zero_means)"),
    ("scale", r".*\bfields\.scale\b.*"),
    ("flag and field", r".*\bfields\.(makes_position|sums_up|power_of_two|implemented|reserved|explained_by|unit)"),
    ("address", r"registers\.(address|length|bank|interface|name)"),
    ("address", r"(field_groups|registers)"),
    ("access", r"registers\.access"),
    ("limit", r"registers\.(meanings\.)?(min|max|limits_of|above_max|when|is)"),
    ("limit", r"registers\.meanings(\.name)?"),
    ("wait", r"registers\.wait_at_least_ms"),
    ("behaviour", r"registers\.(volatile|clears_itself|write_clears|opened_by|reserved|default)\b.*"),
    ("alarm", r"alarms\b.*"),
    ("wait", r"procedures\.steps\.(at_least_ms|times|every_at_least_us|until|in_succession)"),
    ("procedure step", r"procedures(\.steps\b.*)?"),
    ("procedure", r"procedures\b.*"),
    ("pin", r"connectors\b.*"),
    ("hardware input", r"inputs\b.*"),
    ("interface", r"interfaces\b.*"),
    ("order code: labels", r"(order_code|parameters)\b.*"),
)
_COMPILED = tuple((name, re.compile(pattern)) for name, pattern in _CLASSES)

#: Class of the words that turn a text round.
WORD = "word in a text"
#: Keys of texts for people. Names, quotations and sources are other facts.
_TEXTS = frozenset(
    """
    meaning note value why used remedy precondition result detected when_active when_inactive when_unused special
    """.split()
)
#: Classes in which a wrong value shifts a position, breaks a check or an access, or causes wrong timing.
STRICT = frozenset(("position", "CRC", "address", "byte order", "access", "default", "limit", "clock", "time", "wait"))
#: Classes that are words for people. No output computes with them, and no other fact repeats them.
PROSE = frozenset(("number in a text", "document", "source", "erratum", "manual"))
#: Classes with texts of which the numbers are facts.
WORDED = frozenset(("characteristic, hazard", "characteristic", "table", "LED", "contents"))
#: Highest share of wrong values that may pass, by class of fact.
MOST = {
    **dict.fromkeys(("characteristic", "table", "LED", "alarm"), 0.03),
    "characteristic, hazard": 0.01,
    "cited section": 0.05,
    "cited page": 0.40,
    "number in a text": 0.25,
    WORD: 0.15,
}
#: Highest share of wrong values that may pass if the same mistake is in the spec and in its second reading.
MOST_IN_BOTH = {"all classes": 0.20, "pin": 0.0}
#: Classes that exist to detect mistakes in others.
WITNESSES = frozenset(("example", "printed once more"))

#: Texts that are facts: texts of a pin, a wire or a label.
_FACTUAL_TEXTS = frozenset(("contact", "signal", "description_file", "pattern", "open", "then"))


@dataclass(frozen=True)
class Place:
    """A value in a spec: its place, its keys without list indexes, and its definition in the language."""

    path: Path
    keys: str
    value: Any
    #: The definition of the value in the language, such as ``name`` or ``expression``, or an empty string.
    kind: str
    schema: Mapping[str, Any]
    #: True if the value is optional.
    optional: bool

    @property
    def is_text(self) -> bool:
        """True for a text for people, in which a word can be turned round."""
        return self.kind == "text" and str(self.path[-1]) in _TEXTS

    @property
    def fact(self) -> str:
        """Class of the fact."""
        words = self.kind in ("text", "names") and str(self.path[-1]) not in _FACTUAL_TEXTS
        fact = next((name for name, pattern in _COMPILED if pattern.fullmatch(self.keys)), "other")
        return "number in a text" if words and fact not in PROSE | WITNESSES | WORDED else fact


def places(document: Document) -> Iterator[Place]:
    """Yield every value in a device or manufacturer file. Containers come after their content."""
    kind = "device" if "device" in document.data else "manufacturer"
    schema = load_schema(kind)
    yield from (place for place in _places_inside((), "", document.data, schema, _Language(schema)) if place.keys)


@dataclass(frozen=True)
class _Language:
    """The JSON Schema of a kind of file."""

    schema: Mapping[str, Any]

    def followed(self, schema: Mapping[str, Any]) -> tuple[str, Mapping[str, Any]]:
        """Return the definition to which a schema refers, with its name, or the schema itself."""
        if "$ref" not in schema:
            return "", schema
        name = str(schema["$ref"]).removeprefix("#/$defs/")
        inner, definition = self.followed(self.schema["$defs"][name])
        return inner or name, {**schema, **definition}


def _places_inside(
    path: Path, keys: str, value: Any, schema: Mapping[str, Any], language: _Language, optional: bool = False
) -> Iterator[Place]:
    kind, followed = language.followed(schema)
    yield Place(path, keys, value, kind, followed, optional)
    if isinstance(value, dict):
        properties = followed.get("properties", {})
        for key, member in value.items():
            below = f"{keys}.{key if key in properties or keys == 'interfaces' else 'NAME'}".removeprefix(".")
            below = "interfaces.NAME" if keys == "interfaces" else below
            inner = properties[key] if key in properties else followed.get("additionalProperties", {})
            free = key not in followed.get("required", ())
            yield from _places_inside(
                (*path, key), below, member, inner if isinstance(inner, dict) else {}, language, free
            )
    elif isinstance(value, list):
        for index, member in enumerate(value):
            below = f"{keys}.HAZARD" if keys == "characteristics" and _is_hazard(member) else keys
            yield from _places_inside((*path, index), below, member, followed.get("items", {}), language)


def _is_hazard(characteristic: Mapping[str, Any]) -> bool:
    return any(quantity["quantity"] in _HAZARDS for quantity in characteristic.get("values", ()))
