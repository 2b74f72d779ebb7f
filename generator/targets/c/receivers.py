"""A program that tracks an axis from the raw buffers of an SPI with DMA, over BiSS."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model import Biss
from .examples import ExampleCode
from .variants import CodeRow


class ReceiverCode:
    """The values that the template prints: the order code with the longest frame, and the example of that frame."""

    def __init__(self, example: ExampleCode) -> None:
        view = example.view
        self.view, self.example = view, example
        self.name, self.sketch = f"{view.stem}_dma", f"{view.stem}_arduino"
        self.struct = example.struct
        self.verdict = example.reports.verdict if example.reports is not None else ""
        self.member = example.counts
        self.is_signed = example.is_signed(example.counts)
        self.longest = max(example.received, key=lambda item: item.bits)
        rows = view.variants.rows
        self.row: CodeRow = next(row for row in rows if row.variant is self.longest.variant)
        self.bits, self.size = (item.name for item in view.lengths.macros_of(self.longest))
        self.receive = f"{view.lengths.receive}({view.lengths.code_of(self.longest)}, rx, {view.lengths.into()})"
        self.modulus = example.modulus


def receiver_codes(examples: Iterable[ExampleCode]) -> Iterator[ReceiverCode]:
    """Yield a program for each family whose BiSS frames have a verdict."""
    for item in examples:
        told = item.reports is not None and item.reports.verdict
        lengths = item.view.lengths
        if isinstance(item.interface, Biss) and told and item.counts and item.position and len(lengths.layouts) == 1:
            yield ReceiverCode(item)
