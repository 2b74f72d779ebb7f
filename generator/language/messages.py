"""Messages of the schema check, which explain each keyword of JSON Schema to someone who transcribes a manual."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from .hints import TO_ADD, foreign_key_hint, key_hint, number_hint, unsupported_hint, value_hint, word_hint
from .problems import WORDS_ONLY, Path, join_words, missing_keys_message, nearest_choice, quoted, suggest_word
from .schemas import is_only_in_device_files

_JSON_TYPES_IN_WORDS = {
    "integer": "a whole number",
    "number": "a number",
    "string": "text",
    "object": "a map of keys",
    "array": "a list",
    "boolean": "true or false",
}
_SUM = "a whole number, or a sum such as singleturn_bits + 8"
#: Accepted values of keys that take a number or text.
_NUMBER_OR_TEXT = {
    **dict.fromkeys(("bits", "min", "max", "counts_per_turn", "turns", "step_um", "modulus"), _SUM),
    "at": "a bit number, or a range such as 7:6",
    "addresses": "an address, or the first and the last, as in 0x4B-0x4D",
    "equals": "a whole number, a sum such as singleturn_bits + 8, or text",
}

#: Every pattern of the schemas in words.
PATTERNS = {
    "^[a-z][a-z0-9]*(_[a-z0-9]+)*$": (
        "a name begins with a lowercase letter and contains only lowercase letters, digits and single underscores"
        " between them"
    ),
    r"^[a-z][a-z0-9]*(_[a-z0-9]+)*\.[a-z][a-z0-9]*(_[a-z0-9]+)*$": (
        "it must be the names of a device and of one of its connectors or cables, as in tv62.m12_connector"
    ),
    r"^interfaces(\.[a-z][a-z0-9]*(_[a-z0-9]+)*){2,}$": (
        "it must be a place in an interface, as in interfaces.ssi.cable_lengths"
    ),
    "^[a-z][a-z0-9]*$": "it must begin with a lowercase letter and contain only lowercase letters and digits",
    r"^p\.[0-9]{1,4}(-[0-9]{1,4})?((, | and )[0-9]{1,4}(-[0-9]{1,4})?)*$": (
        "pages are numbers or ranges after one p., as in p.9-14, 18 and 22"
    ),
    "^[a-z]{2}$": "a language code has two lowercase letters, as in en",
    "^[0-9]{4}-[0-9]{2}-[0-9]{2}$": "a date is written as year-month-day, as in 2024-05-10",
    "^[0-9]{4}(-[0-9]{2}-[0-9]{2})?$": "a date is written as year-month-day, as in 2024-05-10, or as a year",
    "^[0-9]{1,2}(:[0-9]{1,2})?$": "bits are written as the highest and the lowest, as in 5:0, or as one bit, as in 7",
    '^https?://[^\\s<>"|`^{}\\[\\]\\\\]+$': (
        "a URL begins with https:// and contains no spaces, quotes, bars or brackets except ( ); "
        "write these as %20, %7C and so on"
    ),
    "^[0-9A-Fa-f]{2}( [0-9A-Fa-f]{2})*$": (
        "bytes are written as two hex digits each, separated by single spaces, as in 1A 00 3F"
    ),
    "^0x[0-9A-Fa-f]+-0x[0-9A-Fa-f]+$": "write the first and last address, as in 0x4B-0x4D",
    "^0x[0-9A-Fa-f]{1,4}(-0x[0-9A-Fa-f]{1,4})?( bit [0-9]{1,3})?( = (0x[0-9A-Fa-f]{1,16}|[0-9]{1,3}))?$": (
        "a write is an address and a byte, as in 0x48 = 0x01, an address and a bit, as in 0x49 bit 2 = 0, or only"
        " addresses, as in 0x50-0x54"
    ),
    "^(0|[1-9][0-9]{0,9}|0x[0-9A-Fa-f]{1,8})$": "a code in a register is a whole number, as in 6 or 0x1F",
    "^[01]+$": "bits are written with the digits 0 and 1 only",
    "^[A-Za-z0-9]+(/[A-Za-z0-9]+)*$": (
        "a value of an order code contains only letters, digits and single slashes between them"
    ),
    "^[A-Za-z0-9\\[\\]{},?+*-]+$": "use only letters, digits, classes in brackets and counts, as in [A-Z]{2}",
    "^[a-z][a-z0-9_]*\\.[a-z][a-z0-9_]*$": "write a register and its field, as in configuration.output_code",
    "^[A-Za-z0-9_.-]+$": "a file name contains only letters, digits, '_', '.' and '-'",
    "^[a-z0-9_]+(\\.[a-z0-9_]+)*$": "a path consists of names joined by dots, as in registers.preset",
    "^S[A-Z0-9]+$": "the name of a special model is the part of its label after the slash, as in S042",
    "^[A-Za-z0-9_/-]+(\\[[0-9]{1,4}\\])*(\\.[A-Za-z0-9_/-]+(\\[[0-9]{1,4}\\])*)*$": (
        "a place consists of keys and names joined by dots, with numbers for unnamed items, as in"
        " procedures.set_preset.steps[3]"
    ),
    "^\\S+ .*[^.\\s]$": "a title is a sentence of several words without a full stop at its end",
    "^[0-9]+\\.[0-9]+\\.[0-9]+$": "a version consists of three numbers joined by dots, as in 0.1.0",
}

#: Names for one item of a list or map, if removing the plural s does not give the singular.
_NAMES_OF_ITEMS = {
    "errata": "an erratum",
    "before": "a change",
    "then": "a change",
    "history": "a revision",
    "crcs": "a CRC",
    "leds": "an LED",
    "data_ids": "a data ID",
    "memory_access": "a row of the memory access",
    "printed": "a printed value",
    "digits": "a run of digits",
    "sets": "a parameter that is set",
    "join": "a joined number",
    "names": "a name",
    "needs": "a required object",
    "when": "a condition",
}


#: Maps in which an unknown key is an unsupported feature rather than a typo.
_SUPPORTED_KEYS: dict[str | int, str] = {
    "interfaces": "codewheel supports only ssi, biss, spi and rs485 (requests and replies as bytes)",
}


#: Keys of fields that are easily given to a register by mistake.
_KEYS_OF_FIELDS = ("values", "signed", "unit")

#: Current names of keys, by their names in earlier versions of the language.
RENAMED = {"steps_per_turn": "counts_per_turn", "steps": "modulus"}

#: Keys of a field with a fixed value. If it depends on the order code, the widths of two fields decide.
_WIDTH_DECIDES = ("active", "parity")

#: Text after a key that device files have and second readings do not.
_NO_PROSE = "; a second reading does not have this part; leave it out"


@dataclass(frozen=True, slots=True)
class RuleFinding:
    """A problem with its rule, place and message.

    ``at_key`` is set if the key is wrong, not its value. ``is_rest_usable`` is set if the parent can still be used, as
    with an extra key or missing prose.
    """

    rule: str
    path: Path
    message: str
    at_key: bool = False
    is_rest_usable: bool = False


def explain(error: Any, file_kind: str) -> Iterator[RuleFinding]:
    """Yield the findings for one error of the validator.

    Args:
        error: A ``jsonschema.ValidationError``.
        file_kind: ``device``, ``second``, ``manufacturer``, ``master``, ``overlay`` or ``words``.
    """
    path: Path = tuple(error.absolute_path)
    if "propertyNames" in error.relative_schema_path:
        yield _finding_on_invalid_key(error, path)
    elif error.validator == "additionalProperties":
        yield from _findings_on_unknown_keys(error, path, file_kind)
    elif error.validator == "required":
        yield from _findings_on_missing_keys(error, path, file_kind)
    else:
        rule, message = _EXPLAIN_BY_KEYWORD[error.validator](error, _subject_in_words(path))
        yield RuleFinding(rule, path, message)


def _finding_on_invalid_key(error: Any, path: Path) -> RuleFinding:
    """Return the finding for a key that is too long or does not match the pattern of names."""
    key = error.instance
    if error.validator == "maxLength":
        message = f"the key {quoted(key)} is longer than {error.validator_value} characters"
        return RuleFinding("too-long", (*path, key), message, at_key=True)
    hint = ""
    if path[-1:] == ("values",) and key.isdigit():
        hint = "; the name comes first, as in 'save: {value: 1}'"
    pattern_in_words = PATTERNS.get(error.schema.get("pattern", ""), "")
    message = f"the key {quoted(key)} is not valid: {pattern_in_words}{hint}"
    return RuleFinding("bad-pattern", (*path, key), message, at_key=True)


def _findings_on_unknown_keys(error: Any, path: Path, file_kind: str) -> Iterator[RuleFinding]:
    """Yield a finding for each key of a map that the schema does not have, with a hint on what to write instead.

    If there is such a hint, the key may be meant as another one, so the map cannot be used without it. The rest of the
    map can still be used if there is none, and if the key is prose, which a second reading does not have.
    """
    for key in error.instance:
        if key in error.schema["properties"]:
            continue
        is_prose_in_second_reading = file_kind == "second" and is_only_in_device_files(key)
        hint = _NO_PROSE if is_prose_in_second_reading else _key_hint(error, path, key)
        is_rest_usable = is_prose_in_second_reading or not hint
        message = f"unknown key {quoted(key)}{hint or _suggest_key(error, key)}"
        yield RuleFinding("unknown-key", (*path, key), message, at_key=True, is_rest_usable=is_rest_usable)


def _key_hint(error: Any, path: Path, key: str) -> str:
    """Return the hint for an unknown key of a map at ``path``, or an empty string if no hint applies.

    The key may be a former name, a key of other tools, an unsupported feature, a typo, an unsupported interface, a key
    of a field, a part of a text without quotes, or have another unit. The first of these that applies is used.
    """
    known_keys = error.schema["properties"]
    if RENAMED.get(key) in known_keys:
        return f"; it is now called '{RENAMED[key]}' (codewheel migrate renames it)"
    if foreign_hint := foreign_key_hint(key, error.instance[key], allowed_keys=known_keys, used_keys=error.instance):
        return foreign_hint
    if missing_feature_hint := unsupported_hint(key):
        return missing_feature_hint
    nearest_key = nearest_choice(key, list(known_keys))
    if nearest_key:
        return f"; did you mean '{nearest_key}'?"
    if path and path[-1] in _SUPPORTED_KEYS:
        return f"; {_SUPPORTED_KEYS[path[-1]]}"
    if key in _KEYS_OF_FIELDS and "fields" in known_keys:
        return f"; it is a key of a field: add 'fields: [{{name: all, at: 7:0, {key}: ...}}]', with your name and bits"
    if " " in key.strip():
        return "; keys have no spaces: if this is part of a string, put the whole string in quotes"
    return key_hint(key, error.instance[key], known_keys)


def _suggest_key(error: Any, unknown_key: str) -> str:
    """Return the known keys, or the most similar one, as a hint after an unknown key."""
    return suggest_word(unknown_key, error.schema["properties"], "known keys")


def _findings_on_missing_keys(error: Any, path: Path, file_kind: str) -> Iterator[RuleFinding]:
    """Yield one finding for all missing keys of a map, except keys that an unknown key misspells."""
    required_keys = error.validator_value
    misspelt_keys = [key for key in required_keys if _is_misspelt(error, key)]
    missing_keys = [key for key in required_keys if key not in error.instance and key not in misspelt_keys]
    if not missing_keys:
        return
    hints = [TO_ADD[key] for key in missing_keys if key in TO_ADD]
    message = "; ".join([missing_keys_message(missing_keys, _owner_in_words(error, path, file_kind)), *hints])
    is_only_prose = not misspelt_keys and WORDS_ONLY.issuperset(missing_keys)
    is_in_named_map = bool(path) and isinstance(path[-1], str)
    yield RuleFinding("missing-key", path, message, at_key=is_in_named_map, is_rest_usable=is_only_prose)


def _is_misspelt(error: Any, required_key: str) -> bool:
    """Return True if some unknown key of the map is a misspelling of a required one."""
    known_keys = error.schema["properties"]
    unknown_keys = [key for key in error.instance if key not in known_keys]
    return any(_is_meant_as(required_key, key, error.instance, known_keys) for key in unknown_keys)


def _is_meant_as(required_key: str, unknown_key: str, map_with_keys: Any, known_keys: Any) -> bool:
    """Return True if an unknown key is a typo of the required one, or the hint about it names the required key."""
    if nearest_choice(unknown_key, list(known_keys)) == required_key:
        return True
    value = map_with_keys[unknown_key]
    hint_on_unit = key_hint(unknown_key, value, known_keys)
    hint_on_other_tools = foreign_key_hint(unknown_key, value, allowed_keys=known_keys, used_keys=map_with_keys)
    # The hints quote the key to write, perhaps followed by a value.
    return f"'{required_key}" in hint_on_unit + hint_on_other_tools


def _owner_in_words(error: Any, path: Path, file_kind: str) -> str:
    """Return the text for the map that lacks keys in a message, such as ``a register`` or ``a device file``.

    A map that is neither an element of a list nor one of several with names is given by its key in quotes.
    """
    if not path:
        return {"second": "a second reading", "overlay": "an overlay"}.get(file_kind, f"a {file_kind} file")
    schema_path = list(error.absolute_schema_path)
    is_list_item_or_named_entry = len(schema_path) > 1 and schema_path[-2] in ("items", "additionalProperties")
    if is_list_item_or_named_entry:
        enclosing_keys = [step for step in path[:-1] if isinstance(step, str)]
        return _one_item_in_words(enclosing_keys[-1])
    return f"'{path[-1]}'"


def _one_item_in_words(plural: str) -> str:
    """Return one item of a list or map with its article, such as ``a register`` for ``registers``."""
    if plural in _NAMES_OF_ITEMS:
        return _NAMES_OF_ITEMS[plural]
    singular = plural.removesuffix("s").replace("_", " ")
    article = "an" if singular[0] in "aeiou" else "a"
    return f"{article} {singular}"


def _subject_in_words(path: Path) -> str:
    """Return the subject of a message about a value: its key, or ``an item of`` the list that contains it."""
    if path and isinstance(path[-1], int):
        return f"an item of '{path[-2]}'"
    return f"'{path[-1]}'" if path else "the file"


class _RuleMessage(NamedTuple):
    """A message about an error of the schema, and the rule under which it is reported."""

    rule: str
    message: str


def _explain_type(error: Any, subject: str) -> _RuleMessage:
    """Return the rule and the message for a value of the wrong type, with the likely correction.

    ``subject`` is the text for the value in the message: its key in quotes, or ``an item of`` its list.
    """
    value = error.instance
    accepted_types = [error.validator_value] if isinstance(error.validator_value, str) else error.validator_value
    key = str(error.absolute_path[-1]) if error.absolute_path else ""
    number_or_text = _NUMBER_OR_TEXT.get(key) if len(accepted_types) > 1 else None
    accepted_text = number_or_text or join_words([_JSON_TYPES_IN_WORDS[name] for name in accepted_types], "or")
    if value is None:
        return _RuleMessage("wrong-type", f"{subject} has no value; it must be {accepted_text}")
    hint = ""
    if number_or_text or accepted_types == ["integer"]:
        hint = number_hint(key, value)
    elif "string" in accepted_types and isinstance(value, (int, float)):
        hint = _hint_for_text(error)
    if not hint:
        hint = value_hint(key, value, error.schema)
    return _RuleMessage("wrong-type", f"{subject} must be {accepted_text}, not {quoted(value)}{hint}")


def _hint_for_text(error: Any) -> str:
    """Return a hint for a number or boolean that must be text: quotes, or a name for the value that a step writes.

    The hint is empty if the text would not be valid in quotes either.
    """
    path = list(error.absolute_path)
    if "steps" in path and path[-1] == "value":
        return "; give the number a name, under 'values' of a field of the register, and write the name"
    pattern = error.schema.get("pattern", "")
    # In quotes, true is a name. A number is not, so quotes would not help.
    is_valid_in_quotes = re.search(pattern, str(error.instance).lower()) is not None
    return "; put it in quotes" if is_valid_in_quotes else ""


def _explain_enum(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a value that is not allowed, with the likely or all allowed values."""
    value, allowed_values = error.instance, error.validator_value
    key = error.absolute_path[-1]
    hint = word_hint(str(key), value) or unsupported_hint(value)
    if not hint and not isinstance(value, (dict, list)):
        hint = suggest_word(str(value), map(str, allowed_values), "use one of")
    if not hint:
        hint = f"; use one of {', '.join(map(str, allowed_values))}"
    lists_allowed_values = "use one of" in hint
    is_key_of_field = "fields" in error.absolute_path
    if lists_allowed_values and is_key_of_field and key in _WIDTH_DECIDES:
        hint += ". If it depends on the order code, write two fields, each with a parameter in 'bits' that is 0 or 1"
    return _RuleMessage("not-allowed", f"{subject} cannot be {quoted(value)}{hint}")


def _explain_const(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a value that must be different, such as the version of the language."""
    value, required_value = error.instance, error.validator_value
    # The key 'codewheel' states the version of the language.
    is_later_version = type(value) is int and subject == "'codewheel'" and value > required_value
    hint = "; a later version of codewheel can read this file" if is_later_version else ""
    return _RuleMessage("not-allowed", f"{subject} must be {quoted(required_value)}, not {quoted(value)}{hint}")


def _explain_pattern(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a text that does not match a pattern of the schema, with the pattern in words."""
    pattern_in_words = PATTERNS.get(error.validator_value, f"it must match {error.validator_value}")
    return _RuleMessage("bad-pattern", f"{subject} cannot be {quoted(error.instance)}: {pattern_in_words}")


def _explain_range(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a number outside its bounds, of which one may be missing."""
    minimum, maximum = error.schema.get("minimum"), error.schema.get("maximum")
    if minimum is None:
        bounds = f"at most {maximum}"
    elif maximum is None:
        bounds = f"at least {minimum}"
    else:
        bounds = f"from {minimum} to {maximum}"
    return _RuleMessage("out-of-range", f"{subject} is {quoted(error.instance)}; it must be {bounds}")


def _explain_too_long(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a text that is longer than the schema allows."""
    return _RuleMessage(
        "too-long", f"{subject} has {len(error.instance)} characters; the limit is {error.validator_value}"
    )


def _explain_empty(error: Any, subject: str) -> _RuleMessage:
    return _RuleMessage("too-short", f"{subject} is empty; fill it in or leave it out")


def _explain_too_few(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a list or map with too few entries."""
    entry_count = len(error.instance)
    least_count = error.validator_value
    if least_count > 1:
        noun = "entry" if entry_count == 1 else "entries"
        return _RuleMessage("too-short", f"{subject} has {entry_count or 'no'} {noun}; it needs at least {least_count}")
    return _RuleMessage("too-short", f"{subject} is empty; it needs at least one entry")


def _explain_too_many(error: Any, subject: str) -> _RuleMessage:
    """Return rule and message for a list or map with more entries than the schema allows."""
    return _RuleMessage(
        "too-long", f"{subject} has {len(error.instance)} entries; the limit is {error.validator_value}"
    )


_EXPLAIN_BY_KEYWORD: dict[str, Callable[[Any, str], _RuleMessage]] = {
    "type": _explain_type,
    "enum": _explain_enum,
    "const": _explain_const,
    "pattern": _explain_pattern,
    "minimum": _explain_range,
    "maximum": _explain_range,
    "maxLength": _explain_too_long,
    "minLength": _explain_empty,
    "minItems": _explain_too_few,
    "minProperties": _explain_too_few,
    "maxProperties": _explain_too_many,
    "maxItems": _explain_too_many,
}

#: Keywords of JSON Schema that the schemas may use. Each has a message.
KEYWORDS = frozenset(("required", "additionalProperties", "propertyNames", *_EXPLAIN_BY_KEYWORD))
