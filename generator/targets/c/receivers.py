"""A program that tracks an axis from the raw buffers of an SPI with DMA, over BiSS."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ...model import Biss, first_of
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
        self.longest = max(example.received, key=lambda frame: frame.bits)
        variant = self.longest.variant
        rows = (row for row in view.variants.rows if row.variant is variant)
        self.row: CodeRow = first_of(rows, f"row for {variant.code}")
        self.bits, self.size = (macro.name for macro in view.lengths.macros_of(self.longest))
        self.receive = (
            f"{view.lengths.receive}({view.lengths.code_of(self.longest)}, rx, {view.lengths.receiver_argument()})"
        )
        self.modulus = example.modulus


def receiver_codes(examples: Iterable[ExampleCode]) -> Iterator[ReceiverCode]:
    """Yield a program for each family whose BiSS frames have a verdict."""
    for example in examples:
        has_verdict = example.reports is not None and example.reports.verdict
        lengths = example.view.lengths
        if (
            isinstance(example.interface, Biss)
            and has_verdict
            and example.counts
            and example.position
            and len(lengths.layouts) == 1
        ):
            yield ReceiverCode(example)
