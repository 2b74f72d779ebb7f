"""Effect of an accepted mutant on the outputs: on code, on texts only, or none."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator, Mapping
from enum import Enum
from functools import cache
from typing import Any

from codewheel.dump.plain import device_dump
from codewheel.dump.schema import schema_of_device_data
from codewheel.model import Device
from codewheel.targets import Library, TargetError
from codewheel.targets.registry import files_of, load_target

#: Outputs that machines read.
_CODE = ("python", "c", "biss")
#: Texts that are facts: the signals of contacts.
_FACTS = frozenset(("contact", "signal"))
#: Lists whose order is a fact. The order of all other lists only determines the order in the outputs.
_ORDERED = frozenset("fields join steps arguments digits control_data answers columns cells writes".split())
_C_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_XML_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


class Effect(Enum):
    """Part that a mutant changes: the outputs, only their order, or only a second reading."""

    NOTHING = "nothing"
    ORDER = "order"
    READING = "second reading"
    TEXTS = "texts"
    CODE = "code"


class Outputs:
    """Outputs of an unchanged device, for comparison with the outputs of its mutants.

    Attributes:
        targets: The outputs that machines read, without those that cannot be generated for the device.
    """

    def __init__(self, device: Device) -> None:
        self._device, self._dump = device, device_dump(device)
        outputs = {name: _code(name, device) for name in _CODE}
        self._code = {name: files for name, files in outputs.items() if files is not None}
        self.targets = tuple(self._code)

    def effect(self, device: Device) -> Effect:
        """Return the effect of replacing the device with another. Outputs are generated only if the facts differ."""
        if device == self._device:
            return Effect.NOTHING
        dump = device_dump(device)
        if dump == self._dump:
            return Effect.NOTHING
        if _unordered(dump) == _unordered(self._dump):
            return Effect.ORDER
        if _facts(dump) == _facts(self._dump):
            return Effect.TEXTS
        has_same_code = self._code and all(_code(name, device) == files for name, files in self._code.items())
        return Effect.TEXTS if has_same_code else Effect.CODE


@cache
def _text_keys() -> frozenset[str]:
    """Return the keys under which plain data has words for people."""
    schema = schema_of_device_data()
    parts: list[Mapping[str, Any]] = [schema, *schema["$defs"].values()]
    members = [member for part in parts for member in part.get("properties", {}).items()]
    facts = {key for key, member in members if not _is_text(member)}
    return frozenset(key for key, member in members if _is_text(member)) - facts - _FACTS


def _is_text(member: Mapping[str, Any]) -> bool:
    """Return whether a member of plain data has words for people."""
    references = (member.get("$ref", ""), member.get("items", {}).get("$ref", ""))
    return any(reference.rpartition("/")[2] in ("text", "names", "source") for reference in references)


def _unordered(data: Any, key: str = "") -> Any:
    """Return plain data with all lists sorted whose order has no meaning."""
    if isinstance(data, dict):
        return {name: _unordered(value, name) for name, value in data.items()}
    if not isinstance(data, list):
        return data
    values = [_unordered(value) for value in data]
    return values if key in _ORDERED else sorted(values, key=lambda value: json.dumps(value, sort_keys=True))


def _facts(data: Any) -> Any:
    """Return plain data without words for people."""
    if isinstance(data, dict):
        return {key: _facts(value) for key, value in data.items() if key not in _text_keys()}
    return [_facts(value) for value in data] if isinstance(data, list) else data


def _files(name: str, device: Device) -> Mapping[str, str] | None:
    target = load_target(name)
    options = {option.name: option.default for option in target.options}
    try:
        return files_of(target, Library((device,)), options)
    except TargetError:
        return None


def _code(name: str, device: Device) -> dict[str, str] | None:
    """Return the files of an output without comments and docstrings, or None if it cannot be generated."""
    files = _files(name, device)
    if files is None:
        return None
    return {path: text for path, whole in files.items() for text in _stripped(path, whole)}


def _stripped(path: str, text: str) -> Iterator[str]:
    if path.endswith(".py"):
        yield _python(text)
    elif path.endswith((".h", ".c")):
        yield " ".join(_C_COMMENT.sub(" ", text).split())
    elif "idbiss" in path:
        yield " ".join(_XML_COMMENT.sub(" ", text).split())


def _python(text: str) -> str:
    """Return a module as its syntax tree without docstrings."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [statement for statement in body if not _is_docstring(statement)]  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
