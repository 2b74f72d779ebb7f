"""The headers of the runtime that the headers, examples and self-tests of some interfaces need."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from ...model import Biss, Rs485, Spi
from .device import DeviceView
from .names import FOLDER
from .runtime_texts import runtime_headers, runtime_tests

#: Headers for every encoder: order codes, results, and the use of positions.
_FOR_ALL = ("bits.h", "result.h", "result.hpp", "encoder.h", "angle.h", "tracker.h")
_RUNTIME_INCLUDE = re.compile(rf'^#include "(?:{FOLDER}/)?(\w+\.hp*)"', re.MULTILINE)


def needed_runtime(views: Iterable[DeviceView]) -> dict[str, str]:
    """Return the headers of the runtime that these interfaces need: their texts by file name.

    They are the headers for all encoders, for each interface, and for the self-tests, with the headers that these
    include.
    """
    texts_by_header = runtime_headers()
    unvisited_headers = list(_FOR_ALL)
    for view in views:
        unvisited_headers += _headers_for_interface(view)
    for test_text in runtime_tests().values():
        unvisited_headers += _RUNTIME_INCLUDE.findall(test_text)
    needed_headers: set[str] = set()
    while unvisited_headers:
        header = unvisited_headers.pop()
        if header not in needed_headers:
            needed_headers.add(header)
            unvisited_headers += _RUNTIME_INCLUDE.findall(texts_by_header[header])
    return {header: text for header, text in texts_by_header.items() if header in needed_headers}


def _headers_for_interface(view: DeviceView) -> Iterator[str]:
    """Yield the headers of the runtime that the headers of an interface include, or that users need with them.

    Users need a receiver for its frames, and helpers for its registers and procedures.
    """
    interface = view.context.interface
    for part in view.parts:
        yield from (name.removeprefix(f"{FOLDER}/") for name in part.includes if name.startswith(f"{FOLDER}/"))
    if view.lengths.macros:
        yield "receive_frame.h" if view.lengths.length else "receive.h"
    if view.channels is not None:
        yield "channels.h"
    if isinstance(interface, Spi):
        yield "spi.h"
    if isinstance(interface, Rs485):
        yield "receive.h"
    if isinstance(interface, Biss) and view.registers:
        yield "biss_slave.h"
    if view.procedures:
        yield "runner.h"
