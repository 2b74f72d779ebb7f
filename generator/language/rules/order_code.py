"""Rules for parameters and order codes: every code is unambiguous and sets everything."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...model.expressions import Expression, ExpressionError
from ..problems import WORDS_ONLY, DocumentReport, Path, quoted
from .walk import Spec, items, mapping

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


def parameter_cycle(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no parameter is defined by itself."""
    parameters = mapping(spec, "parameters")
    definitions = {name: _parameters_in(item["equals"]) for name, item in parameters.items() if "equals" in item}
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
    before = len(report)
    _check_pattern(spec, report)
    _check_values(spec, report)
    if len(report) > before:
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
    parts = [part for _, part in items(spec, *_PARTS)]
    pattern = str(mapping(spec, "order_code").get("pattern", ""))
    by_part = {part["name"]: part for part in parts}
    if (
        not is_whole(spec, raw)
        or len(by_part) < len(parts)
        or any(_wrong_expression(part.get("open", "")) for part in parts)
    ):
        return
    if sorted(_BRACES.findall(pattern)) != sorted(by_part):
        return
    # Blanks on a label are ignored.
    pieces = [piece if index % 2 else _without_blanks(piece) for index, piece in enumerate(_BRACES.split(pattern))]
    # With parts of fixed length each code splits at fixed places, so it can only be read as it was composed.
    fixed = all("open" not in part and len({len(text) for text in part["values"]}) == 1 for part in parts)
    fits = {name: _fits(part) for name, part in by_part.items()}
    seen: dict[str, _Code] = {}
    for code in _codes(spec) or ():
        other = seen.setdefault(_without_blanks(code.text), code)
        if other is not code:
            report.add(
                "order-code-ambiguous",
                ("order_code", "pattern"),
                f"the code {quoted(code.text)} occurs twice: as {_words(other)}, and as {_words(code)}",
            )
            return
        readings = [] if fixed else list(itertools.islice(_readings(_without_blanks(code.text), pieces, fits), 2))
        if len(readings) > 1:
            names = pieces[1::2]
            ways = [
                ", ".join(f"{name} {text}" for name, text in zip(names, reading, strict=True)) for reading in readings
            ]
            report.add(
                "order-code-ambiguous",
                ("order_code", "pattern"),
                f"the code {quoted(code.text)} can be read as {ways[0]}, and as {ways[1]}",
            )
            return


def also_written(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that an alternative spelling has every part exactly once, and that its texts represent listed values."""
    if not is_whole(spec, raw):
        return
    parts = {part["name"]: part for _, part in items(spec, *_PARTS)}
    pattern = spec["order_code"]["pattern"]
    for path, spelling in items(spec, "order_code", "also_written"):
        used = _BRACES.findall(spelling["pattern"])
        if sorted(used) != sorted(parts):
            needed = f"each part ({', '.join(parts)}) must occur exactly once, as in {quoted(pattern)}"
            has = f"the part{'s' * (len(used) > 1)} {', '.join(used)}" if used else "no parts"
            report.add("also-written", (*path, "pattern"), f"{quoted(spelling['pattern'])} has {has}; {needed}")
            continue
        for name, texts in mapping(spelling, "values").items():
            if name not in parts:
                wrong = f"there is no part {quoted(name)}; known: {', '.join(parts)}"
                report.add("also-written", (*path, "values", name), wrong, at_key=True)
                continue
            for text, value in texts.items():
                if value not in parts[name]["values"]:
                    wrong = f"{quoted(value)} is not a value of {name}; known: {', '.join(parts[name]['values'])}"
                    report.add("also-written", (*path, "values", name, text), wrong)
        wrong = _wrong_expression(spelling.get("then", ""))
        if wrong:
            wrong = f"{quoted(spelling['then'])} is not a valid regular expression: {wrong}"
            report.add("also-written", (*path, "then"), wrong)


def _without_blanks(text: str) -> str:
    """Return the text as used to compare labels, where blanks are ignored."""
    return "".join(text.split()).upper()


def is_whole(spec: Spec, raw: Spec) -> bool:
    """Return True if only prose was cut out of order codes and parameters.

    Any other missing part would cause errors in the remaining data.
    """
    return all(
        key in spec and _without_words(spec[key]) == _without_words(raw[key]) for key in ("order_code", "parameters")
    )


def _without_words(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_words(item) for key, item in value.items() if key not in WORDS_ONLY}
    return list(map(_without_words, value)) if isinstance(value, list) else value


def _check_pattern(spec: Spec, report: DocumentReport) -> None:
    pattern = spec["order_code"]["pattern"]
    path: Path = ("order_code", "pattern")
    used = _BRACES.findall(pattern)
    names = [part["name"] for _, part in items(spec, *_PARTS)]
    literals = "".join(_BRACES.split(pattern)[0::2])
    if not _LITERAL.fullmatch(literals):
        wrong = next(character for character in literals if not _LITERAL.fullmatch(character))
        report.add(
            "order-code-pattern",
            path,
            f"{quoted(wrong)} is not allowed outside braces; a code contains only letters, digits, '/', '-', '_', '.'"
            " and spaces",
        )
    for name in dict.fromkeys(used):
        if name not in names:
            report.add("order-code-pattern", path, f"there is no part {{{name}}}; known parts: {', '.join(names)}")
        if used.count(name) > 1:
            report.add(
                "order-code-pattern", path, f"the part {{{name}}} occurs {used.count(name)} times in the pattern"
            )
    for place, part in items(spec, *_PARTS):
        if part["name"] not in used:
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
        wrong = _wrong_expression(part.get("open", ""))
        if wrong:
            report.add(
                "order-code-pattern",
                (*path, "open"),
                f"{quoted(part['open'])} is not a valid regular expression: {wrong}",
            )


def _has_no_default(spec: Spec, parameter: Spec) -> bool:
    """Return True if a parameter is read from a register without a default, so that the order code must set it."""
    name = str(parameter["read_from"]).partition(".")[0]
    return any(register["name"] == name and "default" not in register for _, register in items(spec, "registers"))


def _wrong_expression(text: str) -> str:
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
    chosen = {name for code in codes for _, _, value in code.chosen for name in mapping(value, "sets")}
    free = [
        name
        for name, item in spec["parameters"].items()
        if not any(key in item for key in _NOT_SET) or ("read_from" in item and name in chosen)
    ]
    for code in codes:
        interfaces = code.interfaces
        if len(interfaces) != 1:
            found = f"{len(interfaces)} ({', '.join(interfaces)})" if interfaces else "none"
            faults.setdefault(
                "interface", (_PARTS, f"each code must select one interface; {code.text} selects {found}")
            )
        count = [name for _, _, value in code.chosen for name in mapping(value, "sets")]
        misspelt = any(name not in spec["parameters"] for name in count)
        for name in free:
            if count.count(name) == 0 and not misspelt:
                message = (
                    f"no part of {code.text} sets {quoted(name)}; "
                    "every code must set it, or the parameter needs 'equals', 'read_from' or 'alternative'"
                )
                faults.setdefault(name, (("parameters", name), message))
            elif count.count(name) > 1:
                faults.setdefault(
                    name,
                    (
                        ("parameters", name),
                        f"{count.count(name)} parts of {code.text} set {quoted(name)}; only one may",
                    ),
                )
    for path, message in faults.values():
        report.add("order-code-pattern", path, message, at_key=True)
    reached = {interface for code in codes for interface in code.interfaces}
    for interface in mapping(spec, "interfaces"):
        # If a code selects an interface that does not exist, that is the mistake. Another rule reports it.
        if interface not in reached and reached <= mapping(spec, "interfaces").keys():
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
        if all(
            texts.get(name) in allowed
            for _, _, value in chosen
            for name, allowed in mapping(value, "only_with").items()
        ):
            codes.append(_Code(_filled(spec["order_code"]["pattern"], texts), chosen))
    return codes


def _filled(pattern: str, texts: dict[str, str]) -> str:
    return _BRACES.sub(lambda brace: texts.get(brace[1], ""), pattern)


def _fits(part: Spec) -> Callable[[str], bool]:
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
            yield from ((value, *rest) for rest in _readings(text, pieces, fits, end, index + 2))


def _words(code: _Code) -> str:
    return ", ".join(f"{name} {text}" for name, text, _ in code.chosen)


def _parameters_in(text: int | str) -> tuple[str, ...]:
    try:
        return Expression.parse(text).parameters
    except ExpressionError:  # Reported by the rule on expressions.
        return ()
