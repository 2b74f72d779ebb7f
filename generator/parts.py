"""Parts of outputs that depend on one family: from the cache, or else rendered in parallel processes.

Only built-in targets with default options and without the user's templates have such parts. The result is the same as
without this module. If a process dies, the run ends before anything is written.
"""

from __future__ import annotations

import json
import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, BinaryIO, NoReturn

from .cache import Cache, content_of
from .loading.shipped import packaged_masters
from .masters.sheet import shipped_masters
from .model import Device
from .targets import Library, Options, Target, TargetError
from .targets.registry import BUILT_IN, load_target

#: Highest number of processes, and the free memory in bytes that each of them needs.
_MOST_PROCESSES = 4
_MEMORY = 256 * 2**20
#: Least number of tasks that justifies more processes, and largest number of tasks whose parts a process holds.
_FEWEST, _MOST = 4, 256
_NUMBER = 4
#: Targets whose parts of a family one process makes. The files for masters and their page need the same settings. The
#: longest ones come first. C is second, because this process has done half the work when it has looked for problems.
_TOGETHER = (("masters", "docs"), ("c",), ("python",), ("biss",), ("browser",))


@dataclass(frozen=True)
class Kept:
    """Parts of earlier runs. ``digests`` has the digest of each model, by the name of its family.

    ``tell`` is called with the number of tasks that have been begun and the number of all of them.
    """

    cache: Cache
    digests: Mapping[str, str] = field(default_factory=dict)
    tell: Callable[[int, int], None] = lambda begun, all_of_them: None


#: Parts by name of the target and of the family.
Made = Mapping[str, Mapping[str, Any]]
#: Names of targets, and a family.
_Task = tuple[tuple[str, ...], Device]


def is_plain(target: Target, options: Options) -> bool:
    """Return whether a target is built in and has its default options."""
    return target.name in BUILT_IN and options == _defaults(target)


class Rendering:
    """Parts that other processes make while this one goes on. The end of the context ends these processes.

    Args:
        devices: All families.
        targets: The names of built-in targets.
        kept_parts: Parts of earlier runs, and the place for new ones.
    """

    def __init__(self, devices: Sequence[Device], targets: Sequence[str], kept_parts: Kept) -> None:
        self._kept, self._masters = kept_parts, content_of(sorted(packaged_masters().iterdir()))
        self._found: dict[str, dict[str, Any]] = {name: {} for name in targets}
        self._missing: list[_Task] = []
        for together, device in ((together, device) for together in _TOGETHER for device in devices):
            missing_targets = tuple(name for name in together if name in targets and not self._finds(name, device))
            self._missing += [(missing_targets, device)] if missing_targets else []
        if self._missing:
            with suppress(ValueError):  # The target reports it.
                shipped_masters(kept_parts.cache)
            with suppress(ImportError, TargetError):  # Modules that two processes need are imported once, before both.
                import_module(f"{__package__}.environments")
                for name in self._missing[0][0]:
                    load_target(name)
        self._first = _Pool(self._missing[:_MOST], self._make)

    def _finds(self, name: str, device: Device) -> bool:
        """Return whether an earlier run made a part, and take it."""
        stored = self._kept.cache.get(f"part {name}", self._content(device)) if self._content(device) else None
        if isinstance(stored, dict) and "part" in stored:
            self._found[name][device.name] = stored["part"]
            return True
        return False

    def __enter__(self) -> Rendering:
        return self

    def __exit__(self, *_: object) -> None:
        self._first.close()

    def finished(self, meanwhile: Callable[[Made], None] = lambda complete: None) -> Made:
        """Return the parts by name of the target and of the family. This process works too.

        Before it waits for other processes, it calls ``meanwhile`` with the parts of the targets that are complete.

        Raises:
            TargetError: A process died.
        """
        for start in range(0, len(self._missing), _MOST):
            batch = self._missing[start : start + _MOST]

            def tell(begun: int, start: int = start) -> None:
                self._kept.tell(start + begun, len(self._missing))

            with self._first if start == 0 else _Pool(batch, self._make) as pool:
                ours = pool.worked(tell)
                self._take(batch, ours)
                if start + _MOST >= len(self._missing):
                    waiting = {name for number, (names, _) in enumerate(batch) if number not in ours for name in names}
                    meanwhile({name: parts for name, parts in self._found.items() if name not in waiting})
                self._take(batch, pool.waited_for())
        return self._found

    def _take(self, tasks: Sequence[_Task], parts_by_task: Mapping[int, Mapping[str, Any]]) -> None:
        for number, parts in parts_by_task.items():
            for name, part in parts.items():
                self._found[name][tasks[number][1].name] = part

    def _content(self, device: Device) -> list[bytes | str]:
        digest = self._kept.digests.get(device.name)
        return [digest, *self._masters] if digest else []

    def _make(self, task: _Task) -> dict[str, Any]:
        """Return the parts of a family by the name of the target."""
        names, device = task
        parts_by_target: dict[str, Any] = {}
        for target in map(load_target, names):
            part = target.family(device, Library((device,)), _defaults(target)) if target.family is not None else None
            if self._content(device):
                self._kept.cache.put(f"part {target.name}", self._content(device), {"part": part})
            parts_by_target[target.name] = part
        return parts_by_target


def _defaults(target: Target) -> Options:
    return {option.name: option.default for option in target.options}


class _Pool:
    """Processes that take the positions of tasks from one pipe. Each returns its parts through a pipe of its own."""

    def __init__(self, tasks: Sequence[_Task], make: Callable[[_Task], Any]) -> None:
        self._tasks, self._make = tasks, make
        self._children: list[tuple[int, BinaryIO]] = []
        self._queue, fill = os.pipe()
        os.write(fill, b"".join(position.to_bytes(_NUMBER, "big") for position in range(len(tasks))))
        os.close(fill)
        with suppress(OSError):  # Without further processes, this one does everything.
            for _ in range(_processes(len(tasks)) - 1):
                self._children.append(_child(self._work, [stream for _, stream in self._children]))

    def __enter__(self) -> _Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all processes."""
        if self._queue >= 0:
            os.close(self._queue)
        self._queue = -1
        for number, stream in self._children:
            stream.close()
            with suppress(OSError):
                os.kill(number, signal.SIGKILL)
                os.waitpid(number, 0)
        self._children.clear()

    def worked(self, tell: Callable[[int], None]) -> dict[int, Any]:
        """Work until no task is left, and return the parts that this process made, by the position of their tasks.

        Those with errors are missing, so that targets report them.
        """
        return dict(self._work(tell))

    def waited_for(self) -> dict[int, Any]:
        """Wait for the other processes, and return their parts by the position of their tasks.

        Raises:
            TargetError: A process died.
        """
        parts_by_task: dict[int, Any] = {}
        while self._children:
            number, stream = self._children[-1]
            with stream:
                text = stream.read()
            self._children.pop()
            _, status = os.waitpid(number, 0)
            if status:
                raise TargetError(_died(status))
            parts_by_task.update((int(position), part) for position, part in json.loads(text).items())
        return parts_by_task

    def _work(self, tell: Callable[[int], None] = lambda begun: None) -> Iterator[tuple[int, Any]]:
        while number := os.read(self._queue, _NUMBER):
            position = int.from_bytes(number, "big")
            tell(position)
            with suppress(Exception):
                yield position, self._make(self._tasks[position])


def _processes(tasks: int) -> int:
    """Return the number of processes for a number of tasks, this one included."""
    # Only a process with one thread can be copied safely, and on macOS, which lacks this function, not even that.
    if tasks < _FEWEST or not hasattr(os, "sched_getaffinity") or threading.active_count() > 1:
        return 1
    free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 0
    return max(1, min(_MOST_PROCESSES, len(os.sched_getaffinity(0)), free // _MEMORY))


def _child(work: Callable[[], Iterator[tuple[int, Any]]], other_streams: Sequence[BinaryIO]) -> tuple[int, BinaryIO]:
    """Start a process that works, and return its number and the stream of its results.

    It closes the streams of all children, including its own. Otherwise it would wait for ever to be read from if this
    process is killed.
    """
    read_end, write_end = os.pipe()
    number = os.fork()
    if number == 0:
        os.close(read_end)
        for stream in other_streams:
            stream.close()
        _run(work, write_end)
    os.close(write_end)
    return number, open(read_end, "rb")


def _run(work: Callable[[], Iterator[tuple[int, Any]]], write_end: int) -> NoReturn:
    code = 1
    try:
        text = json.dumps(dict(work()))
        with open(write_end, "wb") as stream:
            stream.write(text.encode())
        code = 0
    finally:
        os._exit(code)


def _died(status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    ending = f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"
    return f"a process that renders files {ending}; nothing has changed; run the command again"
