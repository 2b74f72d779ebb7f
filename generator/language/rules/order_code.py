"""Rules for references to names, which must exist. Messages suggest the most similar name."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...model.expressions import Expression, ExpressionError
from ..document import Path
from ..problems import WORDS_ONLY, DocumentReport, quoted
from .references import NameResolver
from .walk import Spec, by_name, items, mapping


def order_code_references(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check the references of order code values: parameters, interfaces, other parts and their values."""
    resolver, parts = NameResolver(raw, report), by_name(raw, "order_code", "parts")

    def refer_to_parts(path: Path, part: Spec, combined: Spec) -> None:
        for name in combined:
            resolver.refer(
                (*path, name), "other part", name, [other_part for other_part in parts if other_part != part["name"]]
            )
            if name in parts:
                resolver.refer_by(name, path, combined, name, mapping(parts[name], "values"))

    for path, part in items(spec, "order_code", "parts"):
        refer_to_parts((*path, "open_only_with"), part, mapping(part, "open_only_with"))
        for text, value in part["values"].items():
            value_path = (*path, "values", text)
            for name in mapping(value, "sets"):
                resolver.refer((*value_path, "sets", name), "parameter", name)
            resolver.refer_by("interface", value_path, value, "interface")
            refer_to_parts((*value_path, "only_with"), part, mapping(value, "only_with"))


#: Largest number of codes of one family. More indicate an error, as the largest catalogue pages list a few hundred.
MAX_CODES = 10_000

_BRACES = re.compile(r"\{([^{}]*)\}")
_LITERAL = re.compile(r"[A-Za-z0-9/_. -]*")
#: Keys of parameters that are not set by order codes, with the origin of their value.
_NOT_SET = {
    "equals": "is computed from other parameters ('equals')",
    "read_from": "is read from the encoder ('read_from')",
    "alternative": "is set by an alternative ('alternative')",
}

_CLASS = re.compile(r"\[[^\]]*\]")
_COUNT = re.compile(r"[*+?{]")
_PARTS: tuple[str, str] = ("order_code", "parts")


@dataclass(frozen=True, slots=True)
class _Code:
    """One enumerated code: its text and the chosen value of each part."""

    text: str
    chosen: tuple[tuple[str, str, Spec], ...]

    @property
    def interfaces(self) -> list[str]:
        return [value["interface"] for _, _, value in self.chosen if "interface" in value]

    @property
    def set_parameters(self) -> list[str]:
        """Names of the parameters that its parts set, with duplicates."""
        return [name for _, _, value in self.chosen for name in mapping(value, "sets")]


def parameter_cycle(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no parameter is defined by itself."""
    parameters = mapping(spec, "parameters")
    formulas = {name: parameter["equals"] for name, parameter in parameters.items() if "equals" in parameter}
    definitions = {name: _parameters_in(formula) for name, formula in formulas.items()}
    settled: set[str] = set()
    for start in definitions:
        trail: list[str] = []
        name: str | None = start
        # Depth first, without recursion: a long chain of parameters must not exhaust the stack.
        stack = [iter((start,))]
        while stack:
            name = next(stack[-1], None)
            if name is None:
                stack.pop()
                if trail:
                    settled.add(trail.pop())
            elif name in trail:
                loop = [*trail[trail.index(name) :], name]
                report.add(
                    "parameter-cycle",
                    ("parameters", loop[0], "equals"),
                    f"circular definition of parameter: {' -> '.join(loop)}",
                )
                settled.update(trail)
                break
            elif name in definitions and name not in settled:
                trail.append(name)
                stack.append(iter(definitions[name]))


def order_code_pattern(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that pattern and parts agree, and that every code sets each parameter once and selects one interface."""
    if not is_whole(spec, raw):
        return
    problems_before = len(report)
    _check_pattern(spec, report)
    _check_values(spec, report)
    if len(report) > problems_before:
        return
    codes = _codes(spec)
    if codes is None:
        report.add(
            "order-code-pattern",
            _PARTS,
            f"the parts combine to more than {MAX_CODES} order codes; use 'open' for parts with open values",
            at_key=True,
        )
    elif not codes:
        report.add(
            "order-code-pattern",
            _PARTS,
            "'only_with' excludes every combination, so no order code remains",
            at_key=True,
        )
    else:
        _check_codes(spec, codes, report)


def order_code_ambiguous(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no text on a label can be read in two ways."""
    if not is_whole(spec, raw):
        return
    parts = [part for _, part in items(spec, *_PARTS)]
    part_names = {part["name"] for part in parts}
    if len(part_names) < len(parts) or any(_expression_fault(part.get("open", "")) for part in parts):
        return
    pattern = str(mapping(spec, "order_code").get("pattern", ""))
    if sorted(_BRACES.findall(pattern)) != sorted(part_names):
        return
    message = _ambiguity(spec, parts, pattern)
    if message:
        report.add("order-code-ambiguous", ("order_code", "pattern"), message)


def _ambiguity(spec: Spec, parts: Sequence[Spec], pattern: str) -> str:
    """Return the message about the first text that can be read in two ways, or an empty string."""
    # Blanks on a label are ignored.
    pieces = _BRACES.split(pattern)
    pieces[::2] = map(_without_blanks, pieces[::2])
    # With parts of fixed length each code splits at fixed places, so it can only be read as it was composed.
    has_fixed_lengths = all(map(_has_fixed_length, parts))
    fits = {part["name"]: _value_test(part) for part in parts}
    codes_by_text: dict[str, _Code] = {}
    for code in _codes(spec) or ():
        text = _without_blanks(code.text)
        first_code = codes_by_text.setdefault(text, code)
        if first_code is not code:
            return (
                f"the code {quoted(code.text)} occurs twice: as {_parts_text(first_code)}, and as {_parts_text(code)}"
            )
        if has_fixed_lengths:
            continue
        two_readings = list(itertools.islice(_readings(text, pieces, fits), 2))
        if len(two_readings) == 2:
            first, second = (_reading_text(pieces[1::2], reading) for reading in two_readings)
            return f"the code {quoted(code.text)} can be read as {first}, and as {second}"
    return ""


def _has_fixed_length(part: Spec) -> bool:
    return "open" not in part and len(set(map(len, part["values"]))) == 1


def _reading_text(names: Sequence[str], reading: Sequence[str]) -> str:
    return ", ".join(f"{name} {text}" for name, text in zip(names, reading, strict=True))


def also_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an alternative spelling has every part exactly once, and that its texts represent listed values."""
    if not is_whole(spec, raw):
        return
    parts = {part["name"]: part for _, part in items(spec, *_PARTS)}
    pattern = spec["order_code"]["pattern"]
    for path, spelling in items(spec, "order_code", "also_written"):
        used_parts = _BRACES.findall(spelling["pattern"])
        if sorted(used_parts) != sorted(parts):
            used_text = f"the part{'s' * (len(used_parts) > 1)} {', '.join(used_parts)}" if used_parts else "no parts"
            message = (
                f"{quoted(spelling['pattern'])} has {used_text}; "
                f"each part ({', '.join(parts)}) must occur exactly once, as in {quoted(pattern)}"
            )
            report.add("also-written", (*path, "pattern"), message)
            continue
        for name, texts in mapping(spelling, "values").items():
            if name not in parts:
                message = f"there is no part {quoted(name)}; known: {', '.join(parts)}"
                report.add("also-written", (*path, "values", name), message, at_key=True)
                continue
            for text, value in texts.items():
                if value not in parts[name]["values"]:
                    message = f"{quoted(value)} is not a value of {name}; known: {', '.join(parts[name]['values'])}"
                    report.add("also-written", (*path, "values", name, text), message)
        fault = _expression_fault(spelling.get("then", ""))
        if fault:
            message = f"{quoted(spelling['then'])} is not a valid regular expression: {fault}"
            report.add("also-written", (*path, "then"), message)


def _without_blanks(text: str) -> str:
    """Return the text as used to compare labels, where blanks are ignored."""
    return "".join(text.split()).upper()


def is_whole(spec: Spec, raw: Spec) -> bool:
    """Return True if only prose was cut out of order codes and parameters.

    Any other missing part would cause errors in the remaining data.
    """
    for key in ("order_code", "parameters"):
        if key not in spec or _without_prose(spec[key]) != _without_prose(raw[key]):
            return False
    return True


def _without_prose(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_prose(inner) for key, inner in value.items() if key not in WORDS_ONLY}
    return list(map(_without_prose, value)) if isinstance(value, list) else value


def _check_pattern(spec: Spec, report: DocumentReport) -> None:
    pattern = spec["order_code"]["pattern"]
    path: Path = ("order_code", "pattern")
    used_parts = _BRACES.findall(pattern)
    names = [part["name"] for _, part in items(spec, *_PARTS)]
    literals = "".join(_BRACES.split(pattern)[0::2])
    if not _LITERAL.fullmatch(literals):
        forbidden = next(character for character in literals if not _LITERAL.fullmatch(character))
        message = (
            f"{quoted(forbidden)} is not allowed outside braces; "
            "a code contains only letters, digits, '/', '-', '_', '.' and spaces"
        )
        report.add("order-code-pattern", path, message)
    for name in dict.fromkeys(used_parts):
        if name not in names:
            report.add("order-code-pattern", path, f"there is no part {{{name}}}; known parts: {', '.join(names)}")
        if used_parts.count(name) > 1:
            report.add(
                "order-code-pattern", path, f"the part {{{name}}} occurs {used_parts.count(name)} times in the pattern"
            )
    for place, part in items(spec, *_PARTS):
        if part["name"] not in used_parts:
            report.add(
                "order-code-pattern",
                (*place, "name"),
                f"the pattern {quoted(pattern)} does not contain {{{part['name']}}}",
            )


def _check_values(spec: Spec, report: DocumentReport) -> None:
    parameters = spec["parameters"]
    for path, part in items(spec, *_PARTS):
        for text, value in part["values"].items():
            for name in mapping(value, "sets"):
                origin = next((key for key in _NOT_SET if key in parameters.get(name, ())), None)
                if origin is not None and not (origin == "read_from" and _has_no_default(spec, parameters[name])):
                    report.add(
                        "order-code-pattern",
                        (*path, "values", text, "sets", name),
                        f"{quoted(name)} {_NOT_SET[origin]}, so an order code cannot set it too",
                    )
        fault = _expression_fault(part.get("open", ""))
        if fault:
            message = f"{quoted(part['open'])} is not a valid regular expression: {fault}"
            report.add("order-code-pattern", (*path, "open"), message)


def _has_no_default(spec: Spec, parameter: Spec) -> bool:
    """Return True if a parameter is read from a register without a default, so that the order code must set it."""
    name = str(parameter["read_from"]).partition(".")[0]
    return any(register["name"] == name and "default" not in register for _, register in items(spec, "registers"))


def _expression_fault(text: str) -> str:
    """Return the reason that ``text`` cannot be the expression of an open part, or an empty string if it can."""
    try:
        re.compile(text)
    except (re.error, OverflowError) as error:
        return str(error)
    # Each repetition multiplies the ways to match a label. Three are more than any catalogue needs.
    return "more than three repetitions" if len(_COUNT.findall(_CLASS.sub("", text))) > 3 else ""


def _check_codes(spec: Spec, codes: Sequence[_Code], report: DocumentReport) -> None:
    """Report each kind of error once, for the first code that has it."""
    faults: dict[str, tuple[Path, str]] = {}
    required_parameters = _required_parameters(spec, codes)
    for code in codes:
        interfaces = code.interfaces
        if len(interfaces) != 1:
            selected = f"{len(interfaces)} ({', '.join(interfaces)})" if interfaces else "none"
            message = f"each code must select one interface; {code.text} selects {selected}"
            faults.setdefault("interface", (_PARTS, message))
        set_parameters = code.set_parameters
        is_misspelt = any(name not in spec["parameters"] for name in set_parameters)
        for name in required_parameters:
            count = set_parameters.count(name)
            if count == 0 and not is_misspelt:
                message = (
                    f"no part of {code.text} sets {quoted(name)}; "
                    "every code must set it, or the parameter needs 'equals', 'read_from' or 'alternative'"
                )
                faults.setdefault(name, (("parameters", name), message))
            elif count > 1:
                message = f"{count} parts of {code.text} set {quoted(name)}; only one may"
                faults.setdefault(name, (("parameters", name), message))
    for path, message in faults.values():
        report.add("order-code-pattern", path, message, at_key=True)
    _check_selected_interfaces(spec, codes, report)


def _required_parameters(spec: Spec, codes: Sequence[_Code]) -> list[str]:
    """Return the parameters that every code must set."""
    set_by_codes = {name for code in codes for name in code.set_parameters}
    names = []
    for name, parameter in spec["parameters"].items():
        is_optional = any(key in parameter for key in _NOT_SET)
        if not is_optional or ("read_from" in parameter and name in set_by_codes):
            names.append(name)
    return names


def _check_selected_interfaces(spec: Spec, codes: Sequence[_Code], report: DocumentReport) -> None:
    """Report each interface that no code selects."""
    reached_interfaces = {interface for code in codes for interface in code.interfaces}
    for interface in mapping(spec, "interfaces"):
        # If a code selects an interface that does not exist, that is the mistake. Another rule reports it.
        if interface not in reached_interfaces and reached_interfaces <= mapping(spec, "interfaces").keys():
            report.add(
                "order-code-pattern",
                ("interfaces", interface),
                f"no order code selects the interface {quoted(interface)}",
                at_key=True,
            )


def _codes(spec: Spec) -> list[_Code] | None:
    """Return every enumerated code, or None if there are too many."""
    parts = [part for _, part in items(spec, *_PARTS)]
    if math.prod(len(part["values"]) for part in parts) > MAX_CODES:
        return None
    codes = []
    for values in itertools.product(*(part["values"].items() for part in parts)):
        chosen = tuple((part["name"], text, value) for part, (text, value) in zip(parts, values, strict=True))
        texts = {name: text for name, text, _ in chosen}
        if _is_allowed(chosen, texts):
            codes.append(_Code(_fill_pattern(spec["order_code"]["pattern"], texts), chosen))
    return codes


def _is_allowed(chosen: Sequence[tuple[str, str, Spec]], texts: Mapping[str, str]) -> bool:
    """Return True if each chosen value can be combined with the texts of the other parts."""
    for _, _, value in chosen:
        for name, allowed_texts in mapping(value, "only_with").items():
            if texts.get(name) not in allowed_texts:
                return False
    return True


def _fill_pattern(pattern: str, texts: dict[str, str]) -> str:
    return _BRACES.sub(lambda brace: texts.get(brace[1], ""), pattern)


def _value_test(part: Spec) -> Callable[[str], bool]:
    """Return the test whether a text in capitals is a value of a part."""
    listed = frozenset(value.upper() for value in part["values"])
    expression = re.compile(part["open"], re.IGNORECASE) if "open" in part else None
    return lambda text: text in listed or (expression is not None and expression.fullmatch(text) is not None)


def _readings(
    text: str, pieces: Sequence[str], fits: Mapping[str, Callable[[str], bool]], start: int = 0, index: int = 0
) -> Iterator[tuple[str, ...]]:
    """Yield every way to split ``text`` from ``start`` into the pattern's ``pieces`` from ``index``.

    Pieces at even indices are literals, those at odd indices are parts.
    """
    literal = pieces[index].upper()
    if not text.startswith(literal, start):
        return
    start += len(literal)
    if index == len(pieces) - 1:
        if start == len(text):
            yield ()
        return
    is_value = fits[pieces[index + 1]]
    for end in range(start, len(text) + 1):
        value = text[start:end]
        if is_value(value):
            for following_values in _readings(text, pieces, fits, end, index + 2):
                yield (value, *following_values)


def _parts_text(code: _Code) -> str:
    return ", ".join(f"{name} {text}" for name, text, _ in code.chosen)


def _parameters_in(text: int | str) -> tuple[str, ...]:
    try:
        return Expression.parse(text).parameters
    except ExpressionError:  # Reported by the rule on expressions.
        return ()
