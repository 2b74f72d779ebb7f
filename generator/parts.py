"""Parts of outputs that depend on one family: from the cache, or else rendered in parallel processes.

Only built-in targets with default options and without the user's templates have such parts. The result is the same as
without this module. A process that dies ends the run before anything is written.
"""

from __future__ import annotations

import json
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, BinaryIO, NoReturn

from .cache import Cache, content_of
from .loading.shipped import packaged_masters
from .masters.sheet import shipped_masters
from .model import Device
from .targets import NO_OPTIONS, Library, Options, Target, TargetError
from .targets.registry import BUILT_IN

#: Highest number of processes, and the free memory in bytes that each of them needs.
_MOST_PROCESSES = 4
_MEMORY = 256 * 2**20
#: Least number of parts that justifies more processes, and largest number that a process holds before returning them.
_FEWEST, _MOST = 4, 256
_NUMBER = 4


@dataclass(frozen=True)
class Kept:
    """Parts of earlier runs. ``digests`` has the digest of each model, by the name of its family.

    ``tell`` is called with the number of parts that have been begun and the number of all that are not in the cache.
    """

    cache: Cache
    digests: Mapping[str, str] = field(default_factory=dict)
    tell: Callable[[int, int], None] = lambda begun, all_of_them: None


NOTHING_KEPT = Kept(Cache(None))
_Task = tuple[Target, Device]


def is_plain(target: Target, options: Options) -> bool:
    """Return whether a target is built in and has its default options."""
    return target.name in BUILT_IN and options == {item.name: item.default for item in target.options}


def parts_of(library: Library, targets: Sequence[Target], kept: Kept) -> dict[str, dict[str, Any]]:
    """Return the parts of these targets by name of the target and of the family.

    Raises:
        TargetError: A target fails, or a process dies.
    """
    if library.own_templates is not None:
        return {}
    masters = content_of(sorted(packaged_masters().iterdir()))
    found: dict[str, dict[str, Any]] = {target.name: {} for target in targets}
    missing: list[_Task] = []

    def content(task: _Task) -> list[bytes | str]:
        digest = kept.digests.get(task[1].name)
        return [digest, *masters] if digest else []

    for task in ((target, device) for target in targets if target.family for device in library.devices):
        entry = kept.cache.get(f"part {task[0].name}", content(task)) if content(task) else None
        if isinstance(entry, dict) and "part" in entry:
            found[task[0].name][task[1].name] = entry["part"]
        else:
            missing.append(task)

    def make(task: _Task) -> Any:
        target, device = task
        made = target.family(device, Library((device,)), _defaults(target)) if target.family is not None else None
        if content(task):
            kept.cache.put(f"part {target.name}", content(task), {"part": made})
        return made

    if missing:
        with suppress(ValueError):  # The target reports it.
            shipped_masters(kept.cache)
    # The targets that take longest are the last ones.
    missing.reverse()
    for start in range(0, len(missing), _MOST):
        some = missing[start : start + _MOST]

        def tell(begun: int, _: int, start: int = start) -> None:
            kept.tell(start + begun, len(missing))

        for number, made in _made(some, make, tell).items():
            target, device = some[number]
            found[target.name][device.name] = made
    return found


def _defaults(target: Target) -> Options:
    return {item.name: item.default for item in target.options} or NO_OPTIONS


def _made(tasks: Sequence[_Task], make: Callable[[_Task], Any], tell: Callable[[int, int], None]) -> dict[int, Any]:
    """Return the parts by the position of their tasks. Those with errors are missing, so that the target reports them.

    All processes take the positions from one pipe. Each child returns its parts through a pipe of its own, as JSON.
    """
    queue, fill = os.pipe()
    children: list[tuple[int, BinaryIO]] = []
    made: dict[int, Any] = {}

    def work() -> Iterator[tuple[int, Any]]:
        while number := os.read(queue, _NUMBER):
            position = int.from_bytes(number, "big")
            tell(position, len(tasks))
            with suppress(Exception):
                yield position, make(tasks[position])

    try:
        os.write(fill, b"".join(position.to_bytes(_NUMBER, "big") for position in range(len(tasks))))
        os.close(fill)
        with suppress(OSError):  # Without further processes, this one does everything.
            children.extend(_child(work) for _ in range(_processes(len(tasks)) - 1))
        made.update(work())
        while children:
            number, stream = children[-1]
            with stream:
                text = stream.read()
            children.pop()
            _, status = os.waitpid(number, 0)
            if status:
                raise TargetError(_died(status))
            made.update((int(position), part) for position, part in json.loads(text).items())
        return made
    finally:
        os.close(queue)
        for number, stream in children:
            stream.close()
            with suppress(OSError):
                os.kill(number, signal.SIGKILL)
                os.waitpid(number, 0)


def _processes(tasks: int) -> int:
    """Return the number of processes for a number of tasks, this one included."""
    # Only a process with one thread can be copied safely, and on macOS, which lacks this function, not even that.
    if tasks < _FEWEST or not hasattr(os, "sched_getaffinity") or threading.active_count() > 1:
        return 1
    free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 0
    return max(1, min(_MOST_PROCESSES, len(os.sched_getaffinity(0)), free // _MEMORY))


def _child(work: Callable[[], Iterator[tuple[int, Any]]]) -> tuple[int, BinaryIO]:
    """Start a process that works, and return its number and the stream of its results."""
    out, into = os.pipe()
    number = os.fork()
    if number == 0:
        _run(work, into)
    os.close(into)
    return number, open(out, "rb")


def _run(work: Callable[[], Iterator[tuple[int, Any]]], into: int) -> NoReturn:
    code = 1
    try:
        text = json.dumps(dict(work()))
        with open(into, "wb") as stream:
            stream.write(text.encode())
        code = 0
    finally:
        os._exit(code)


def _died(status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    how = f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"
    return f"a process that renders files {how}; nothing has changed; run the command again"
