"""Rules for order codes: their references, their pattern, the parameters that they set, and how labels are read."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from ..document import Path
from ..keys_of_order_codes import WrittenCodePart, WrittenCodeValue, WrittenParameter, WrittenSpelling
from ..keys_of_specs import WrittenSpec
from ..problems import WORDS_ONLY, DocumentReport, quoted
from .parts import keys_of_origin

#: Largest number of codes of one family. More indicate an error, because the largest catalogs list a few hundred.
MAX_CODES = 10_000

#: The name of a part in a pattern, such as ``{bits}``. Splitting at it yields literals and names in turn.
_PART_IN_BRACES = re.compile(r"\{([^{}]*)\}")
_LITERAL_TEXT = re.compile(r"[A-Za-z0-9/_. -]*")
#: Keys of parameters that are not set by order codes, each with the text for messages that says what sets them.
_TEXT_BY_ORIGIN_KEY = {
    "equals": "is computed from other parameters ('equals')",
    "read_from": "is read from the encoder ('read_from')",
    "alternative": "is set by an alternative ('alternative')",
}
_CHARACTER_CLASS = re.compile(r"\[[^\]]*\]")
_REPETITION = re.compile(r"[*+?{]")
_PATH_OF_PARTS: tuple[str, str] = ("order_code", "parts")


class _Choice(NamedTuple):
    """A label that is chosen for a part of an order code, with the meaning of this label: its value."""

    part_name: str
    label: str
    value: WrittenCodeValue


@dataclass(frozen=True, slots=True)
class _Code:
    """A complete order code: its text, and for each part the chosen label."""

    text: str
    choices: tuple[_Choice, ...]

    @property
    def interfaces(self) -> list[str]:
        return [choice.value.interface for choice in self.choices if choice.value.interface is not None]

    @property
    def set_parameters(self) -> list[str]:
        """Names of the parameters that its parts set. A name that several parts set is repeated."""
        names: list[str] = []
        for choice in self.choices:
            names += choice.value.sets
        return names


def check_order_code_pattern(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the pattern contains each part, and that each order code selects one interface.

    Each order code must also set every parameter once. Order codes are checked only if the pattern has no problems.
    """
    if not are_codes_complete(spec.data, spec.with_invalid_parts.data):
        return  # Something invalid was removed, which is reported already.
    problems_before = len(report)
    _check_pattern(spec, report)
    _check_set_parameters(spec, report)
    if len(report) > problems_before:
        return
    codes = _compose_codes(spec)
    if codes is None:
        message = f"the parts combine to more than {MAX_CODES} order codes; use 'open' for parts with open values"
        report.add("order-code-pattern", _PATH_OF_PARTS, message, at_key=True)
    elif not codes:
        message = "'only_with' excludes every combination, so no order code remains"
        report.add("order-code-pattern", _PATH_OF_PARTS, message, at_key=True)
    else:
        _check_selections_of_codes(spec, codes, report)


def check_ambiguous_order_codes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text on a label can be read in two ways: as two codes, or as one code split in two ways."""
    if not are_codes_complete(spec.data, spec.with_invalid_parts.data):
        return  # Something invalid was removed, which is reported already.
    parts, pattern = spec.order_code.parts, spec.order_code.pattern
    part_names = {part.name for part in parts}
    has_duplicate_names = len(part_names) < len(parts)
    has_invalid_expression = any(_problem_of_expression(part.open) for part in parts)
    names_each_part_once = sorted(_PART_IN_BRACES.findall(pattern)) == sorted(part_names)
    if has_duplicate_names or has_invalid_expression or not names_each_part_once:
        return  # Other rules report these mistakes.
    message = _message_on_ambiguity(spec)
    if message:
        report.add("order-code-ambiguous", ("order_code", "pattern"), message)


def _message_on_ambiguity(spec: WrittenSpec) -> str:
    """Return a message about the first order code that occurs twice or can be read in two ways, or an empty string."""
    parts = spec.order_code.parts
    # In turn, literal text and the name of a part: "X-", "bits", "", "output" and "" for ``X-{bits}{output}``.
    literals_and_names = _PART_IN_BRACES.split(spec.order_code.pattern)
    names_of_parts = literals_and_names[1::2]
    for index in range(0, len(literals_and_names), 2):  # Of each literal. Blanks on a label are ignored.
        literals_and_names[index] = _capitals_without_blanks(literals_and_names[index])
    # With parts of fixed length, each code splits at fixed places, so it can only be read as it was composed.
    has_fixed_lengths = all(map(_has_fixed_length, parts))
    # For each part, a function that tells whether a text is one of its labels.
    label_test_by_part = {part.name: _label_test(part) for part in parts}
    first_code_by_text: dict[str, _Code] = {}
    for code in _compose_codes(spec) or ():
        code_text = _capitals_without_blanks(code.text)
        first_code = first_code_by_text.setdefault(code_text, code)
        if first_code is not code:
            choices_text = f"as {_choices_text(first_code)}, and as {_choices_text(code)}"
            return f"the code {quoted(code.text)} occurs twice: {choices_text}"
        if not has_fixed_lengths:
            all_readings = _yield_readings(code_text, literals_and_names, label_test_by_part)
            first_two_readings = list(itertools.islice(all_readings, 2))
            if len(first_two_readings) == 2:
                reading, other_reading = [_reading_text(names_of_parts, labels) for labels in first_two_readings]
                return f"the code {quoted(code.text)} can be read as {reading}, and as {other_reading}"
    return ""


def _has_fixed_length(part: WrittenCodePart) -> bool:
    """Return True if a part of the order code has only listed labels, all of the same length."""
    has_only_listed_labels = not part.open
    lengths_of_labels = set(map(len, part.values))
    return has_only_listed_labels and len(lengths_of_labels) == 1


def _reading_text(names_of_parts: Sequence[str], labels: Sequence[str]) -> str:
    """Return a reading of an order code as text, such as ``bits 24, output S``."""
    return ", ".join(f"{name} {label}" for name, label in zip(names_of_parts, labels, strict=True))


def check_also_written(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alternative spelling has every part exactly once, and that its texts represent listed labels."""
    if not are_codes_complete(spec.data, spec.with_invalid_parts.data):
        return  # Invalid parts of the order code were removed from ``spec``, so parts of the spelling could be missing.
    part_by_name = {part.name: part for part in spec.order_code.parts}
    for spelling in spec.order_code.also_written:
        used_names = _PART_IN_BRACES.findall(spelling.pattern)
        if sorted(used_names) == sorted(part_by_name):
            _check_spelling(spelling, part_by_name, report)
            continue
        noun = "part" if len(used_names) == 1 else "parts"
        used_text = f"the {noun} {', '.join(used_names)}" if used_names else "no parts"
        names_of_parts = ", ".join(part_by_name)
        message = (
            f"{quoted(spelling.pattern)} has {used_text}; "
            f"each part ({names_of_parts}) must occur exactly once, as in {quoted(spec.order_code.pattern)}"
        )
        report.add("also-written", spelling.path_of("pattern"), message)


def _check_spelling(
    spelling: WrittenSpelling, part_by_name: Mapping[str, WrittenCodePart], report: DocumentReport
) -> None:
    """Check that the texts of an alternative spelling represent listed labels, and that its expression is valid."""
    for part_name, label_by_text in spelling.values.items():
        path: Path = (*spelling.path, "values", part_name)
        if part_name not in part_by_name:
            known_names = ", ".join(part_by_name)
            message = f"there is no part {quoted(part_name)}; known: {known_names}"
            report.add("also-written", path, message, at_key=True)
            continue
        listed_labels = part_by_name[part_name].values
        for printed_text, label in label_by_text.items():
            if label not in listed_labels:
                known_labels = ", ".join(listed_labels)
                message = f"{quoted(label)} is not a value of {part_name}; known: {known_labels}"
                report.add("also-written", (*path, printed_text), message, cause=f"{part_name} {label}")
    problem = _problem_of_expression(spelling.then)
    if problem:
        message = f"{quoted(spelling.then)} is not a valid regular expression: {problem}"
        report.add("also-written", spelling.path_of("then"), message)


def _capitals_without_blanks(label: str) -> str:
    """Return a label in capitals and without blanks, as labels are compared."""
    return "".join(label.split()).upper()


def are_codes_complete(valid_data: dict[str, object], all_data: dict[str, object]) -> bool:
    """Return True if no part of the order codes and parameters of a spec was removed as invalid, except prose.

    ``all_data`` is the spec, and ``valid_data`` its copy without the invalid parts.
    """
    for key in ("order_code", "parameters"):
        if key not in valid_data:
            return False
        has_all_facts = _without_prose(valid_data[key]) == _without_prose(all_data[key])
        if not has_all_facts:
            return False
    return True


def _without_prose(node: object) -> object:
    """Return a copy of maps and lists without the keys that hold only prose."""
    if isinstance(node, dict):
        return {key: _without_prose(inner) for key, inner in node.items() if key not in WORDS_ONLY}
    if isinstance(node, list):
        return [_without_prose(inner) for inner in node]
    return node


def _check_pattern(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the pattern of the order code has each part once, and only allowed characters between the parts."""
    pattern = spec.order_code.pattern
    path = spec.order_code.path_of("pattern")
    used_names = _PART_IN_BRACES.findall(pattern)
    known_names = [part.name for part in spec.order_code.parts]
    literals_and_names = _PART_IN_BRACES.split(pattern)  # In turn, beginning and ending with literal text.
    literal_text = "".join(literals_and_names[::2])
    forbidden_characters = [character for character in literal_text if not _LITERAL_TEXT.fullmatch(character)]
    if forbidden_characters:
        message = (
            f"{quoted(forbidden_characters[0])} is not allowed outside braces; "
            "a code contains only letters, digits, '/', '-', '_', '.' and spaces"
        )
        report.add("order-code-pattern", path, message)
    for name in dict.fromkeys(used_names):
        if name not in known_names:
            message = f"there is no part {{{name}}}; known parts: {', '.join(known_names)}"
            report.add("order-code-pattern", path, message)
        count = used_names.count(name)
        if count > 1:
            report.add("order-code-pattern", path, f"the part {{{name}}} occurs {count} times in the pattern")
    for part in spec.order_code.parts:
        if part.name not in used_names:
            message = f"the pattern {quoted(pattern)} does not contain {{{part.name}}}"
            report.add("order-code-pattern", part.path_of("name"), message)


def _check_set_parameters(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that order codes set only parameters that are not calculated, read or set by an answer of the user.

    Also check that the regular expressions of open parts are valid. They describe labels that the spec does not list.
    """
    for part in spec.order_code.parts:
        for value in part.values.values():
            for name in value.sets:
                if name not in spec.parameters:
                    continue  # Another rule reports it.
                origin_key = _conflicting_origin_key(spec, spec.parameters[name])
                if origin_key is not None:
                    message = f"{quoted(name)} {_TEXT_BY_ORIGIN_KEY[origin_key]}, so an order code cannot set it too"
                    report.add("order-code-pattern", (*value.path, "sets", name), message)
        problem = _problem_of_expression(part.open)
        if problem:
            message = f"{quoted(part.open)} is not a valid regular expression: {problem}"
            report.add("order-code-pattern", part.path_of("open"), message)


def _conflicting_origin_key(spec: WrittenSpec, parameter: WrittenParameter) -> str | None:
    """Return the key that prevents an order code from setting a parameter, such as ``equals``, or None without one.

    An order code can set a parameter that is read from a register if the register has no default.
    """
    origin_keys = keys_of_origin(parameter)
    if not origin_keys:
        return None
    needs_order_code = origin_keys[0] == "read_from" and _lacks_default(spec, parameter)
    return None if needs_order_code else origin_keys[0]


def _lacks_default(spec: WrittenSpec, parameter: WrittenParameter) -> bool:
    """Return True if a parameter is read from a register without a default, so that the order code must set it."""
    register_name, _, _ = parameter.read_from.partition(".")  # ``read_from`` is ``register`` or ``register.field``.
    return any(register.name == register_name and register.default is None for register in spec.registers)


def _problem_of_expression(regular_expression: str) -> str:
    """Return the reason that a regular expression cannot describe labels, or an empty string if it can."""
    try:
        re.compile(regular_expression)
    except (re.error, OverflowError) as error:
        return str(error)
    # Each repetition multiplies the ways to match a label. Three are more than any catalog needs.
    expression_without_classes = _CHARACTER_CLASS.sub("", regular_expression)  # In [+*], signs represent themselves.
    repetitions = _REPETITION.findall(expression_without_classes)
    return "more than three repetitions" if len(repetitions) > 3 else ""


def _check_selections_of_codes(spec: WrittenSpec, codes: Sequence[_Code], report: DocumentReport) -> None:
    """Report order codes that do not select exactly one interface, or do not set each required parameter exactly once.

    The interface and each parameter are reported only for the first such code.
    """
    first_problem_by_subject: dict[str, tuple[Path, str]] = {}  # By the parameter, or by "interface".
    required_parameters = _required_parameters(spec, codes)
    for code in codes:
        if len(code.interfaces) != 1:
            first_problem_by_subject.setdefault("interface", (_PATH_OF_PARTS, _message_on_interfaces(spec, code)))
        for name in required_parameters:
            message = _message_on_parameter(name, code, spec.parameters)
            if message:
                first_problem_by_subject.setdefault(name, (("parameters", name), message))
    for path, message in first_problem_by_subject.values():
        report.add("order-code-pattern", path, message, at_key=True)
    if "interface" not in first_problem_by_subject:
        _check_selected_interfaces(spec, codes, report)


def _message_on_interfaces(spec: WrittenSpec, code: _Code) -> str:
    """Return the message about an order code that selects no interface, or several."""
    rule = "each code must select one interface"
    if code.interfaces:
        interface_names = ", ".join(code.interfaces)
        selected = f"{len(code.interfaces)} ({interface_names})"
        return f"{rule}, but {code.text} selects {selected}; keep 'interface' in the values of one part"
    first_interface, *others = spec.interfaces.data or ["ssi"]
    choice = "or another one" if others else "the only one of this spec"
    remedy = f"write 'interface: {first_interface}', {choice}, in each value of one part"
    return f"{rule}, but {code.text} selects none; {remedy}"


def _message_on_parameter(parameter_name: str, code: _Code, parameters: Mapping[str, WrittenParameter]) -> str:
    """Return the message about an order code that sets a parameter twice or not at all. Empty if it sets it once."""
    set_parameters = code.set_parameters
    count = set_parameters.count(parameter_name)
    if count > 1:
        return f"{count} parts of {code.text} set {quoted(parameter_name)}; only one may"
    # A misspelt name, which another rule reports, may mean this name.
    has_unknown_name = any(set_name not in parameters for set_name in set_parameters)
    if count == 0 and not has_unknown_name:
        return (
            f"no part of {code.text} sets {quoted(parameter_name)}; "
            "every code must set it, or the parameter needs 'equals', 'read_from' or 'alternative'"
        )
    return ""


def _required_parameters(spec: WrittenSpec, codes: Sequence[_Code]) -> list[str]:
    """Return the names of the parameters that every order code must set.

    These are the parameters that only they can set, and those that are read from a register and set by some code.
    """
    set_by_codes = {name for code in codes for name in code.set_parameters}
    names = []
    for name, parameter in spec.parameters.items():
        is_read_and_set = bool(parameter.read_from) and name in set_by_codes
        only_codes_can_set = not keys_of_origin(parameter)
        if only_codes_can_set or is_read_and_set:
            names.append(name)
    return names


def _check_selected_interfaces(spec: WrittenSpec, codes: Sequence[_Code], report: DocumentReport) -> None:
    """Report each interface that no code selects."""
    interfaces = spec.interfaces.data
    selected_interfaces: set[str] = set()
    for code in codes:
        selected_interfaces.update(code.interfaces)
    if not selected_interfaces <= interfaces.keys():
        return  # The mistake is that a code selects an interface that does not exist. Another rule reports it.
    for interface in interfaces:
        if interface not in selected_interfaces:
            message = f"no order code selects the interface {quoted(interface)}"
            report.add("order-code-pattern", ("interfaces", interface), message, at_key=True)


def _compose_codes(spec: WrittenSpec) -> list[_Code] | None:
    """Return every order code that combines a listed label of each part, or None if there are too many.

    With the labels 12 and 13, and S and B, the codes are 12S, 12B, 13S and 13B. Combinations that the key ``only_with``
    of a value excludes are left out.
    """
    parts = spec.order_code.parts
    if math.prod(len(part.values) for part in parts) > MAX_CODES:
        return None
    choices_by_part = [[_Choice(part.name, label, value) for label, value in part.values.items()] for part in parts]
    codes = []
    for choices in itertools.product(*choices_by_part):
        label_by_part = {choice.part_name: choice.label for choice in choices}
        if _can_be_combined(choices, label_by_part):
            code_text = _fill_pattern(spec.order_code.pattern, label_by_part)
            codes.append(_Code(code_text, choices))
    return codes


def _can_be_combined(choices: Sequence[_Choice], label_by_part: Mapping[str, str]) -> bool:
    """Return True if the ``only_with`` of each chosen value allows the labels of the other parts."""
    for choice in choices:
        for part_name, allowed_labels in choice.value.only_with.items():
            if label_by_part.get(part_name) not in allowed_labels:
                return False
    return True


def _fill_pattern(pattern: str, label_by_part: dict[str, str]) -> str:
    """Return a pattern such as ``X-{bits}`` with the name of each part in braces replaced by the part's label."""
    return _PART_IN_BRACES.sub(lambda name_in_braces: label_by_part.get(name_in_braces[1], ""), pattern)


def _label_test(part: WrittenCodePart) -> Callable[[str], bool]:
    """Return a function that returns True for a label of this part of the order code, in capitals.

    It accepts the listed labels and, for an open part, texts that match its regular expression.
    """
    listed_labels = frozenset(label.upper() for label in part.values)
    if not part.open:
        return listed_labels.__contains__
    expression = re.compile(part.open, re.IGNORECASE)
    return lambda text: text in listed_labels or expression.fullmatch(text) is not None


def _yield_readings(
    code_text: str,
    literals_and_names: Sequence[str],
    label_test_by_part: Mapping[str, Callable[[str], bool]],
    text_start: int = 0,
    literal_index: int = 0,
) -> Iterator[tuple[str, ...]]:
    """Yield every way to split an order code into a label for each part: ``("24", "S")`` for ``X-24S``.

    ``literals_and_names`` are literal text and the name of a part in turn: "X-", "bits", "", "output" and "". For each
    part, ``label_test_by_part`` has a function that returns True for its labels. The text is split from ``text_start``
    on, where the literal at ``literal_index`` must be.
    """
    literal = literals_and_names[literal_index].upper()
    if not code_text.startswith(literal, text_start):
        return
    label_start = text_start + len(literal)
    is_last_literal = literal_index == len(literals_and_names) - 1
    if is_last_literal:
        is_whole_text_read = label_start == len(code_text)
        if is_whole_text_read:
            yield ()
        return
    part_name = literals_and_names[literal_index + 1]
    is_label = label_test_by_part[part_name]
    for label_end in range(label_start, len(code_text) + 1):
        label = code_text[label_start:label_end]
        if is_label(label):
            for later_labels in _yield_readings(
                code_text, literals_and_names, label_test_by_part, text_start=label_end, literal_index=literal_index + 2
            ):
                yield (label, *later_labels)


def _choices_text(code: _Code) -> str:
    """Return the parts of an order code as text, such as ``bits 24, output S``."""
    return ", ".join(f"{choice.part_name} {choice.label}" for choice in code.choices)
