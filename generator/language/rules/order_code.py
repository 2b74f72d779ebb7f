"""Rules for order codes: their references, their pattern, the parameters that they set, and how labels are read."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..document import Path
from ..problems import WORDS_ONLY, DocumentReport, quoted
from ..written_codes import WrittenCodePart, WrittenCodeValue, WrittenParameter, WrittenSpelling
from ..written_parts import WrittenSpec
from .parts import origins_of

#: Largest number of codes of one family. More indicate an error, because the largest catalogs list a few hundred.
MAX_CODES = 10_000

#: The name of a part in a pattern, such as ``{bits}``. Splitting at it yields literals and names in turn.
_PART_IN_BRACES = re.compile(r"\{([^{}]*)\}")
_LITERAL_TEXT = re.compile(r"[A-Za-z0-9/_. -]*")
#: Keys of parameters that are not set by order codes, each with the text for messages that says what sets them.
_OTHER_ORIGINS = {
    "equals": "is computed from other parameters ('equals')",
    "read_from": "is read from the encoder ('read_from')",
    "alternative": "is set by an alternative ('alternative')",
}
_CHARACTER_CLASS = re.compile(r"\[[^\]]*\]")
_REPETITION = re.compile(r"[*+?{]")
_PATH_OF_PARTS: tuple[str, str] = ("order_code", "parts")


@dataclass(frozen=True, slots=True)
class _Code:
    """A complete order code: its text, and for each part its name, the chosen label and the value of this label."""

    text: str
    chosen: tuple[tuple[str, str, WrittenCodeValue], ...]

    @property
    def interfaces(self) -> list[str]:
        return [value.interface for _, _, value in self.chosen if value.interface is not None]

    @property
    def set_parameters(self) -> list[str]:
        """Names of the parameters that its parts set. A name that several parts set is repeated."""
        names: list[str] = []
        for _, _, value in self.chosen:
            names += value.sets
        return names


def check_order_code_pattern(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the pattern contains each part, and that each order code selects one interface.

    Each order code must also set every parameter once. Order codes are checked only if the pattern has no problems.
    """
    if not are_codes_complete(spec.data, spec.with_invalid_parts.data):
        return  # Something invalid was removed, which is reported already.
    problems_before = len(report)
    _check_pattern(spec, report)
    _check_values(spec, report)
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
        _check_codes(spec, codes, report)


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
    message = _find_ambiguity(spec)
    if message:
        report.add("order-code-ambiguous", ("order_code", "pattern"), message)


def _find_ambiguity(spec: WrittenSpec) -> str:
    """Return a message about the first order code that occurs twice or can be read in two ways, or an empty string."""
    parts = spec.order_code.parts
    # Literal text is at even indices, and names of parts are at odd indices. Blanks on a label are ignored.
    pieces = _PART_IN_BRACES.split(spec.order_code.pattern)
    names_of_parts = pieces[1::2]
    pieces[::2] = map(_without_blanks, pieces[::2])
    # With parts of fixed length, each code splits at fixed places, so it can only be read as it was composed.
    has_fixed_lengths = all(map(_has_fixed_length, parts))
    label_tests = {part.name: _label_test(part) for part in parts}
    first_codes: dict[str, _Code] = {}  # The first code with each text.
    for code in _compose_codes(spec) or ():
        code_text = _without_blanks(code.text)
        first_code = first_codes.setdefault(code_text, code)
        if first_code is not code:
            occurrences = f"as {_parts_text(first_code)}, and as {_parts_text(code)}"
            return f"the code {quoted(code.text)} occurs twice: {occurrences}"
        if has_fixed_lengths:
            continue
        two_readings = list(itertools.islice(_yield_readings(code_text, pieces, label_tests), 2))
        if len(two_readings) == 2:
            first, second = (_reading_text(names_of_parts, labels) for labels in two_readings)
            return f"the code {quoted(code.text)} can be read as {first}, and as {second}"
    return ""


def _has_fixed_length(part: WrittenCodePart) -> bool:
    """Return True if a part of the order code has only listed labels, all of the same length."""
    return not part.open and len(set(map(len, part.values))) == 1


def _reading_text(names_of_parts: Sequence[str], labels: Sequence[str]) -> str:
    """Return a reading of an order code as text, such as ``bits 24, output S``."""
    return ", ".join(f"{name} {label}" for name, label in zip(names_of_parts, labels, strict=True))


def check_also_written(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an alternative spelling has every part exactly once, and that its texts represent listed labels."""
    if not are_codes_complete(spec.data, spec.with_invalid_parts.data):
        return  # Invalid parts of the order code were removed from ``spec``, so parts of the spelling could be missing.
    parts = {part.name: part for part in spec.order_code.parts}
    for spelling in spec.order_code.also_written:
        used_parts = _PART_IN_BRACES.findall(spelling.pattern)
        if sorted(used_parts) == sorted(parts):
            _check_spelling(spelling, parts, report)
            continue
        noun = "part" if len(used_parts) == 1 else "parts"
        used_text = f"the {noun} {', '.join(used_parts)}" if used_parts else "no parts"
        message = (
            f"{quoted(spelling.pattern)} has {used_text}; "
            f"each part ({', '.join(parts)}) must occur exactly once, as in {quoted(spec.order_code.pattern)}"
        )
        report.add("also-written", spelling.place_of("pattern"), message)


def _check_spelling(
    spelling: WrittenSpelling, parts_by_name: Mapping[str, WrittenCodePart], report: DocumentReport
) -> None:
    """Check that the texts of an alternative spelling represent listed labels, and that its expression is valid."""
    for name, texts_to_labels in spelling.values.items():
        if name not in parts_by_name:
            message = f"there is no part {quoted(name)}; known: {', '.join(parts_by_name)}"
            report.add("also-written", (*spelling.path, "values", name), message, at_key=True)
            continue
        listed_labels = parts_by_name[name].values
        for printed_text, label in texts_to_labels.items():
            if label not in listed_labels:
                message = f"{quoted(label)} is not a value of {name}; known: {', '.join(listed_labels)}"
                report.add(
                    "also-written", (*spelling.path, "values", name, printed_text), message, cause=f"{name} {label}"
                )
    problem = _problem_of_expression(spelling.then)
    if problem:
        message = f"{quoted(spelling.then)} is not a valid regular expression: {problem}"
        report.add("also-written", spelling.place_of("then"), message)


def _without_blanks(label: str) -> str:
    """Return a label in capitals and without blanks, as labels are compared."""
    return "".join(label.split()).upper()


def are_codes_complete(valid_data: dict[str, object], all_data: dict[str, object]) -> bool:
    """Return True if no part of the order codes and parameters of a spec was removed as invalid, except prose.

    ``all_data`` is the spec, and ``valid_data`` its copy without the invalid parts.
    """
    for key in ("order_code", "parameters"):
        if key not in valid_data or _without_prose(valid_data[key]) != _without_prose(all_data[key]):
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
    path = spec.order_code.place_of("pattern")
    used_parts = _PART_IN_BRACES.findall(pattern)
    names = [part.name for part in spec.order_code.parts]
    literals = "".join(_PART_IN_BRACES.split(pattern)[0::2])  # The split pieces alternate: literal, name, literal.
    forbidden = [character for character in literals if not _LITERAL_TEXT.fullmatch(character)]
    if forbidden:
        message = (
            f"{quoted(forbidden[0])} is not allowed outside braces; "
            "a code contains only letters, digits, '/', '-', '_', '.' and spaces"
        )
        report.add("order-code-pattern", path, message)
    for name in dict.fromkeys(used_parts):
        if name not in names:
            report.add("order-code-pattern", path, f"there is no part {{{name}}}; known parts: {', '.join(names)}")
        count = used_parts.count(name)
        if count > 1:
            report.add("order-code-pattern", path, f"the part {{{name}}} occurs {count} times in the pattern")
    for part in spec.order_code.parts:
        if part.name not in used_parts:
            message = f"the pattern {quoted(pattern)} does not contain {{{part.name}}}"
            report.add("order-code-pattern", part.place_of("name"), message)


def _check_values(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that order codes set only parameters that are not calculated, read or set by an answer of the user.

    Also check that the regular expressions of open parts are valid. They describe labels that the spec does not list.
    """
    for part in spec.order_code.parts:
        for value in part.values.values():
            for name in value.sets:
                origin = _other_origin(spec, spec.parameters[name]) if name in spec.parameters else None
                if origin is not None:
                    message = f"{quoted(name)} {_OTHER_ORIGINS[origin]}, so an order code cannot set it too"
                    report.add("order-code-pattern", (*value.path, "sets", name), message)
        problem = _problem_of_expression(part.open)
        if problem:
            message = f"{quoted(part.open)} is not a valid regular expression: {problem}"
            report.add("order-code-pattern", part.place_of("open"), message)


def _other_origin(spec: WrittenSpec, parameter: WrittenParameter) -> str | None:
    """Return the key that prevents an order code from setting a parameter, such as ``equals``, or None without one.

    An order code can set a parameter that is read from a register if the register has no default.
    """
    origins = origins_of(parameter)
    if not origins:
        return None
    needs_order_code = origins[0] == "read_from" and _lacks_default(spec, parameter)
    return None if needs_order_code else origins[0]


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


def _check_codes(spec: WrittenSpec, codes: Sequence[_Code], report: DocumentReport) -> None:
    """Report order codes that do not select exactly one interface, or do not set each required parameter exactly once.

    The interface and each parameter are reported only for the first such code.
    """
    first_problems: dict[str, tuple[Path, str]] = {}
    required_parameters = _required_parameters(spec, codes)
    for code in codes:
        interfaces = code.interfaces
        if len(interfaces) != 1:
            first_problems.setdefault("interface", (_PATH_OF_PARTS, _message_on_interfaces(spec, code)))
        for name in required_parameters:
            message = _message_on_parameter(name, code, spec.parameters)
            if message:
                first_problems.setdefault(name, (("parameters", name), message))
    for path, message in first_problems.values():
        report.add("order-code-pattern", path, message, at_key=True)
    if "interface" not in first_problems:
        _check_selected_interfaces(spec, codes, report)


def _message_on_interfaces(spec: WrittenSpec, code: _Code) -> str:
    """Return the message about an order code that selects no interface, or several."""
    rule = "each code must select one interface"
    if code.interfaces:
        selected = f"{len(code.interfaces)} ({', '.join(code.interfaces)})"
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
        if not origins_of(parameter) or is_read_and_set:
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
    choices = []  # For each part, its name with each of its labels and values.
    for part in parts:
        choices.append([(part.name, label, value) for label, value in part.values.items()])
    codes = []
    for chosen in itertools.product(*choices):
        labels = {name: label for name, label, _ in chosen}
        if _is_allowed(chosen, labels):
            codes.append(_Code(_fill_pattern(spec.order_code.pattern, labels), chosen))
    return codes


def _is_allowed(chosen: Sequence[tuple[str, str, WrittenCodeValue]], labels: Mapping[str, str]) -> bool:
    """Return True if the ``only_with`` of each chosen value allows the labels of the other parts."""
    for _, _, value in chosen:
        for name, allowed_labels in value.only_with.items():
            if labels.get(name) not in allowed_labels:
                return False
    return True


def _fill_pattern(pattern: str, labels: dict[str, str]) -> str:
    """Return a pattern such as ``X-{bits}`` with the name of each part in braces replaced by the part's label."""
    return _PART_IN_BRACES.sub(lambda braces: labels.get(braces[1], ""), pattern)


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
    pieces: Sequence[str],
    label_tests: Mapping[str, Callable[[str], bool]],
    start: int = 0,
    index: int = 0,
) -> Iterator[tuple[str, ...]]:
    """Yield every way to split an order code into a label for each part: ``("24", "S")`` for ``X-24S``.

    ``pieces`` are literal text and the name of a part in turn, such as ``["X-", "bits", "", "output", ""]``.
    ``label_tests`` contains a function for each part that returns True for its labels. The text is split from ``start``
    on, and the pieces are used from ``index`` on.
    """
    literal = pieces[index].upper()
    if not code_text.startswith(literal, start):
        return
    label_start = start + len(literal)
    is_last_piece = index == len(pieces) - 1
    if is_last_piece:
        if label_start == len(code_text):
            yield ()
        return
    is_label = label_tests[pieces[index + 1]]
    for label_end in range(label_start, len(code_text) + 1):
        label = code_text[label_start:label_end]
        if is_label(label):
            for later_labels in _yield_readings(code_text, pieces, label_tests, start=label_end, index=index + 2):
                yield (label, *later_labels)


def _parts_text(code: _Code) -> str:
    """Return the parts of an order code as text, such as ``bits 24, output S``."""
    return ", ".join(f"{name} {label}" for name, label, _ in code.chosen)
