"""pytest plugin: the fixture ``virtual_encoder``, for tests of programs that read encoders."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

if TYPE_CHECKING:
    from .virtual.encoder import VirtualEncoder


class Served(NamedTuple):
    """Virtual encoder, and the port to open: a device, or a pyserial URL."""

    encoder: VirtualEncoder
    port: str


@pytest.fixture
def virtual_encoder() -> Iterator[Callable[..., Served]]:
    """Start virtual encoders: ``virtual_encoder(order_code, position=1000003, faults=["flip:0.01"])``.

    The function takes the arguments of ``VirtualEncoder`` and ``tcp=True`` to use TCP. It returns the encoder and the
    ``port`` to open. The encoders end with the test.
    """
    with ExitStack() as stack:

        def start(order_code: str, *arguments: Any, tcp: bool = False, **options: Any) -> Served:
            """Start an encoder that ends with the test."""
            # The plugin is loaded in every test run, so the specs are read only when an encoder is needed.
            from .virtual.encoder import VirtualEncoder
            from .virtual.serving import serving

            encoder = VirtualEncoder(order_code, *arguments, **options)
            return Served(encoder, stack.enter_context(serving(encoder, tcp=tcp)))

        yield start
