"""Run ``codewheel generate`` and record the origin of every character in its files: a template, or a Python string.

    python -m figures.traced RESULT FOLDER ARGUMENTS...

runs ``codewheel ARGUMENTS...`` with the codewheel on the module path. It then writes the text and the origin of every
file in FOLDER to RESULT, as JSON. It needs its own process because it changes Jinja.

The text of a template and the strings in its expressions belong to the template. In ``{{ "if (" ~ limit ~ ")" }}``
these are ``if (`` and ``)``. The origin is preserved through macros, ``{% set %}`` blocks, ``~``, ``+``, ``%``,
``strip``, ``join``, and every filter that changes whitespace or adds something. If a filter changes a string in another
way (``upper``, ``replace``), the result counts as Python's, and so does a string from a template that Python code cuts
or joins. Templates with autoescape, which produce XML, are not traced.
"""

from __future__ import annotations

import functools
import json
import os
import re
import runpy
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any
from unittest.mock import patch

import jinja2
import jinja2.runtime
from jinja2 import nodes
from jinja2.compiler import CodeGenerator, Frame
from jinja2.runtime import Context

TEMPLATE, PYTHON = "t", "p"

_PLACEHOLDER = re.compile(r"%[sdr]|%\(\w+\)s|\{\w*\}")
#: Line that a target replaces by the imports of a module.
_IMPORTS = "IMPORTS\n"
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
#: A Python formatter adds brackets and commas where it breaks a line.
_MOVED = frozenset(" \t\n\r(),")
_RENDERED: list[Traced] = []


class Traced(str):
    """Text whose ``origin`` has a letter for each of its characters: ``TEMPLATE`` or ``PYTHON``."""

    origin: str

    def __new__(cls, text: str, origin: str) -> Traced:
        made = super().__new__(cls, text)
        made.origin = origin
        return made

    def __str__(self) -> str:
        return self  # Jinja calls str() on printed values

    def __add__(self, other: str) -> str:
        return _joined((self, _traced(other)))

    def __radd__(self, other: str) -> str:
        return _joined((_traced(other), self))

    def __mod__(self, values: Any) -> str:
        return aligned(super().__mod__(values), [self])

    def format(self, *values: object, **named: object) -> str:
        return aligned(super().format(*values, **named), [self])

    def join(self, items: Iterable[Any], /) -> str:
        parts = [part for item in items for part in (self, _traced(item))]
        return _joined(parts[1:])

    def strip(self, letters: str | None = None, /) -> str:
        return aligned(super().strip(letters), [self])

    def lstrip(self, letters: str | None = None, /) -> str:
        return aligned(super().lstrip(letters), [self])

    def rstrip(self, letters: str | None = None, /) -> str:
        return aligned(super().rstrip(letters), [self])


def template_text(text: str) -> Traced:
    """Return a string from a template."""
    return Traced(text, TEMPLATE * len(text))


def _traced(value: object) -> Traced:
    """Return the value of an expression in a template, traced."""
    return value if isinstance(value, Traced) else Traced(text := str(value), PYTHON * len(text))


def _joined(parts: Iterable[Traced]) -> Traced:
    kept = list(parts)
    return Traced("".join(kept), "".join(part.origin for part in kept))


def _printed(parts: Iterable[str]) -> Traced:
    """Return the output of a template, a macro or a block: traced values with the template's text between them."""
    return _joined(part if isinstance(part, Traced) else template_text(part) for part in parts)


def aligned(text: str, sources: Iterable[Traced]) -> Traced:
    """Return ``text`` with the origins of ``sources``. It differs from them in whitespace and added characters."""
    places = [index for index, letter in enumerate(text) if not letter.isspace()]
    dense = "".join(text[index] for index in places)
    origin = [PYTHON] * len(text)
    cursor = 0
    for source in sources:
        whole = _dense(source)
        for piece in [whole] if dense.find(whole, cursor) >= 0 else _runs(source):
            at = dense.find(piece, cursor)
            if at >= 0:
                cursor = at + len(piece)
                for index, letter in zip(places[at:cursor], piece.origin, strict=True):
                    origin[index] = letter
    return Traced(text, "".join(origin))


def _dense(text: Traced) -> Traced:
    """Return ``text`` without whitespace."""
    kept = [index for index, letter in enumerate(text) if not letter.isspace()]
    return Traced("".join(text[index] for index in kept), "".join(text.origin[index] for index in kept))


def _runs(text: Traced) -> Iterator[Traced]:
    """Yield the parts of ``text`` that have a single origin, split also at the placeholders of a format string."""
    for run in re.finditer(f"{TEMPLATE}+|{PYTHON}+", text.origin):
        for part in _PLACEHOLDER.split(text[run.start() : run.end()]):
            dense = "".join(part.split())
            if dense:
                yield Traced(dense, run[0][0] * len(dense))


class _Filters(dict[str, Callable[..., Any]]):
    """Filters that keep the origin of their input."""

    def __getitem__(self, name: str) -> Callable[..., Any]:
        plain = super().__getitem__(name)

        @functools.wraps(plain)
        def tracing(*arguments: Any, **named: Any) -> Any:
            made = plain(*arguments, **named)
            if not isinstance(made, str) or isinstance(made, Traced) or hasattr(made, "__html__"):
                return made
            return aligned(made, _filtered(arguments))

        return tracing


def _filtered(arguments: Iterable[Any]) -> Iterator[Traced]:
    """Yield the input of a filter: the first argument after those that Jinja passes, or the items of that argument."""
    value = next(item for item in arguments if not isinstance(item, (Context, nodes.EvalContext, jinja2.Environment)))
    for item in value if isinstance(value, (list, tuple)) else [value]:
        if isinstance(item, Traced):
            yield item


class _Generator(CodeGenerator):
    """Code generator that makes strings in the expressions of a template record their origin."""

    def visit_Const(self, node: nodes.Const, frame: Frame) -> None:  # noqa: N802 (Jinja's name)
        value = node.as_const(frame.eval_ctx)
        if isinstance(value, str) and not frame.eval_ctx.autoescape:
            self.write(f"environment.template_text({value!r})")
        else:
            super().visit_Const(node, frame)


class _Template(jinja2.Template):
    def render(self, *values: Any, **named: Any) -> str:
        text = super().render(*values, **named)
        if isinstance(text, Traced):
            _RENDERED.append(text)
        return text


class _Environment(jinja2.Environment):
    """Replacement for Jinja's environment, without a cache, because cached templates are not traced."""

    code_generator_class = _Generator
    template_class = _Template
    concat = staticmethod(_printed)
    template_text = staticmethod(template_text)

    def __init__(self, *options: Any, **named: Any) -> None:
        named["bytecode_cache"] = None
        super().__init__(*options, **named)
        self.filters = _Filters(self.filters)
        if not self.autoescape:
            self.finalize = _traced


def _str_join(parts: Iterable[Any]) -> str:
    """Apply the operator ``~``."""
    return _joined(map(_traced, parts))


def _code(text: str) -> list[int]:
    """Return the indexes of the characters that a line-breaking formatter keeps: no whitespace, no C comments."""
    kept = set(range(len(text)))
    for found in _COMMENT.finditer(text):
        kept.difference_update(range(*found.span()))
    return [index for index, letter in enumerate(text) if index in kept and letter not in _MOVED]


def _origin(text: str) -> str:
    """Return the origin of each character of a file, as recorded by the templates that printed it."""
    whole = next((item for item in _RENDERED if item == text), None)
    if whole is not None:
        return whole.origin
    code = _code(text)
    letters = "".join(text[index] for index in code)
    for item in _RENDERED:
        places = _code(item)
        if "".join(item[index] for index in places) == letters:
            origin = [PYTHON] * len(text)
            for at, place in zip(code, places, strict=True):
                origin[at] = item.origin[place]
            return "".join(origin)
    for item in _RENDERED:
        # Imports that replace a line of their own after the module was rendered.
        head, mark, tail = str.partition(item, _IMPORTS)
        if mark and text.startswith(head) and text.endswith(tail):
            added = len(text) - len(head) - len(tail)
            return item.origin[: len(head)] + PYTHON * added + item.origin[len(head) + len(mark) :]
    parts = [item for item in _RENDERED if item.strip() and item.strip() in text]
    return aligned(text, sorted(parts, key=lambda item: text.find(item.strip()))).origin


def main() -> None:
    result, folder, *arguments = sys.argv[1:]
    sys.argv[1:] = arguments
    if hasattr(os, "sched_setaffinity"):
        # On one processor, codewheel renders in this process, which has the changed Jinja and sees the origins.
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    with patch.object(jinja2, "Environment", _Environment), patch.object(jinja2.runtime, "str_join", _str_join):
        try:
            runpy.run_module("codewheel", run_name="__main__", alter_sys=True)
        except SystemExit as end:
            if end.code:
                raise
    files = {
        path.relative_to(folder).as_posix(): path for path in Path(folder).rglob("*") if path.suffix in (".h", ".py")
    }
    texts = {name: path.read_text(encoding="utf-8") for name, path in sorted(files.items())}
    Path(result).write_text(json.dumps({name: [text, _origin(text)] for name, text in texts.items()}), encoding="utf-8")


if __name__ == "__main__":
    main()
