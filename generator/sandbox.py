"""Sandbox for a user's templates. They can read values but change nothing, and their computing effort is limited.

Jinja's own sandbox blocks access to the rest of Python. This one also counts loop items, calls, printed values, and the
lengths of texts and lists. The count for a file is the same on every machine.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, ItemsView, Iterable, Iterator, KeysView, Mapping, ValuesView
from contextlib import contextmanager
from io import IOBase
from pathlib import Path, PurePath
from types import GeneratorType, ModuleType
from typing import Any

from jinja2 import Template, nodes
from jinja2.exceptions import SecurityError
from jinja2.runtime import Context, LoopContext
from jinja2.sandbox import ImmutableSandboxedEnvironment

#: Highest number of steps for one file. The largest file from the shipped specs takes a fiftieth of this.
MOST_STEPS = 1_000_000
#: Characters of a text that count as one step.
_CHARACTERS = 100
#: Highest number of characters or items in a repetition, and of bits in a number.
_MOST_REPEATED = 10_000_000
_MOST_BITS = 100_000
#: Jinja filters that take a length as an argument, and the maximum length.
_WITH_LENGTHS = ("batch", "center", "indent", "round", "slice", "truncate", "urlize", "wordwrap")
_MOST_LENGTH = 10_000
#: Types that give access to files or other code, even if a target passes them to a template.
_OUTSIDE = (PurePath, ModuleType, IOBase, type)
#: Memory limit for one file, on systems that can limit it.
_MOST_BYTES = 2**30
_WITH_ITEMS = (str, bytes, list, tuple, dict, set, frozenset, range, KeysView, ValuesView, ItemsView)
_COUNTED = "counted by the sandbox"
Filter = Callable[..., Any]


class Sandbox(ImmutableSandboxedEnvironment):
    """An environment for a user's templates. Call ``finish`` once all filters have been added."""

    intercepted_binops = frozenset(("*", "**", "+", "%"))

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        # Without the optimizer, no constant expression is computed before counting starts.
        super().__init__(*args, **kwargs, optimized=False, finalize=self._spent)
        del self.globals["lipsum"]
        self.left = MOST_STEPS

    def text_of(self, template: str, values: Mapping[str, object]) -> str:
        """Render a template within the limits of one file.

        Raises:
            SecurityError: The template accesses something forbidden, or takes too many steps.
            MemoryError: The template uses too much memory.
        """
        self.left = MOST_STEPS
        with limited_memory():
            return "".join(map(self._spent, self.get_template(template).generate(values)))

    def finish(self, filters: Iterable[str]) -> None:
        """Make the environment count calls of these filters and of all others."""
        own = frozenset(filters)
        for name, function in list(self.filters.items()):
            self.filters[name] = self._counting(function, name in _WITH_LENGTHS and name not in own)
        self.filters[_COUNTED] = self._spent

    def is_safe_attribute(self, obj: Any, attr: str, value: Any) -> bool:
        return not isinstance(obj, _OUTSIDE) and super().is_safe_attribute(obj, attr, value)

    def call(__self, __context: Context, __obj: Any, *args: Any, **kwargs: Any) -> Any:  # noqa: N805
        if isinstance(__obj, LoopContext) and args:
            args = (__self._items(args[0]), *args[1:])
        return __self._spent(super().call(__context, __obj, *args, **kwargs))

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        if operator == "*":
            _refuse_long(left, right)
            _refuse_long(right, left)
        if operator in ("*", "**") and isinstance(left, int) and isinstance(right, int):
            bits = left.bit_length() + right.bit_length() if operator == "*" else left.bit_length() * right
            if bits > _MOST_BITS:
                raise SecurityError(f"the result of '{operator}' has more than {_MOST_BITS} bits")
        return self._spent(super().call_binop(context, operator, left, right))

    def get_template(self, *args: Any, **kwargs: Any) -> Template:
        self._spent(None)
        return super().get_template(*args, **kwargs)

    def _generate(self, source: nodes.Template, *args: Any, **kwargs: Any) -> str:
        """Generate code that counts the items of loops and the parts of joined texts."""
        for loop in source.find_all(nodes.For):
            loop.iter = _through_the_count(loop.iter, loop.lineno)
        for joined in source.find_all(nodes.Concat):
            joined.nodes = [_through_the_count(part, joined.lineno) for part in joined.nodes]
        return super()._generate(source, *args, **kwargs)

    def _spent(self, value: Any) -> Any:
        """Count a value and return it. A generator is wrapped in one that counts its items."""
        cost = len(value) if isinstance(value, _WITH_ITEMS) else 0
        self.left -= 1 + (cost // _CHARACTERS if isinstance(value, (str, bytes)) else cost)
        if self.left < 0:
            raise SecurityError(
                f"the template takes more than {MOST_STEPS} steps for one file; look for an endless loop"
            )
        return self._items(value) if isinstance(value, GeneratorType) else value

    def _items(self, items: Iterable[Any]) -> Iterator[Any]:
        for item in items:
            self._spent(None)
            yield item

    def _counting(self, function: Filter, has_lengths: bool) -> Filter:
        @functools.wraps(function)
        def counting(*args: Any, **kwargs: Any) -> Any:
            if has_lengths and any(
                isinstance(item, int) and abs(item) > _MOST_LENGTH for item in (*args, *kwargs.values())
            ):
                raise SecurityError(f"a length is above {_MOST_LENGTH}")
            return self._spent(function(*map(self._spent, args), **kwargs))

        return counting


def _through_the_count(value: Any, line: int) -> nodes.Filter:
    return nodes.Filter(value, _COUNTED, [], [], None, None, lineno=line)


def _refuse_long(value: Any, times: Any) -> None:
    if isinstance(value, (str, bytes, list, tuple)) and isinstance(times, int) and len(value) * times > _MOST_REPEATED:
        raise SecurityError(f"the result of '*' is longer than {_MOST_REPEATED}")


@contextmanager
def limited_memory() -> Iterator[None]:
    """Limit this process to 1 GB of additional memory on Linux. Other systems have no such limit."""
    if sys.platform != "linux":
        yield
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    most = pages * os.sysconf("SC_PAGESIZE") + _MOST_BYTES
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    least = min((item for item in (soft, hard, most) if item != resource.RLIM_INFINITY), default=most)
    resource.setrlimit(resource.RLIMIT_AS, (least, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
