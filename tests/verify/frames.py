"""Millions of valid, disturbed and random frames from a few frames of the model.

CRCs, parities and constants are sums modulo 2 of the bits of a frame. The sum of three valid frames is therefore a
fourth valid frame, so a small pool yields as many as needed. Some are disturbed by adding further bits.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from batch import DECODE, Batch, Codec, on_the_wire
from codewheel.model import Device, Variant
from test_c_codec import encoded_sample, run_time_variants, samples, with_crc

#: Frames of one chunk, all for one order code.
CHUNK = 10_000
#: Frames of a pool, so that a random byte chooses one.
POOL = 256


def variants(device: Device, codec: Codec) -> list[Variant]:
    """Yield the order codes that differ, and some states of the registers at run time."""
    variants_and_states = (*device.variants, *run_time_variants(device))
    of_interface = [variant for variant in variants_and_states if variant.interface == codec.interface]
    return list({tuple(sorted(variant.parameters.items())): variant for variant in of_interface}.values())


class Frames:
    """A source of frames of one layout for one order code."""

    def __init__(self, batch: Batch, codec: Codec, variant: Variant, random_: random.Random) -> None:
        self.batch, self.codec, self.variant, self.random = batch, codec, variant, random_
        self.placed = codec.layout.place(variant.parameters)
        self.sound = [self._record(number) for number in self._sound_numbers()]
        self.changes = list(self._changes())

    def _sound_numbers(self) -> Iterator[int]:
        data = [field for field in self.placed.fields if field.field.carries_data]
        choices = {field.name: samples(field.field, field.width, self.codec.layout, self.random) for field in data}
        for _ in range(POOL):
            yield encoded_sample(self.batch.device, self.placed, choices, {}, self.random)

    def _record(self, number: int) -> bytes:
        return self.batch.frame(self.placed, on_the_wire(self.codec.layout, number, self.placed.bits))

    def _changes(self) -> Iterator[bytes]:
        """Return the bits added to valid frames: none, one to three, these with a matching CRC, another length, all."""
        bits, random_ = self.placed.bits, self.random
        nothing = self._record(0)
        sound = next(self._sound_numbers())
        for _ in range(103):
            yield bytes(self.batch.record)
        for _ in range(64):
            yield _sum_of(nothing, self._record(_some_bits(bits, random_)))
        for _ in range(26):
            changed = with_crc(self.batch.device, self.placed, sound ^ _some_bits(bits, random_))
            yield _sum_of(self._record(sound), self._record(changed))
        for _ in range(25):
            yield _sum_of(nothing, self._longer_or_shorter())
        for _ in range(38):
            yield _sum_of(nothing, self._record(random_.getrandbits(bits)))

    def _longer_or_shorter(self) -> bytes:
        if not self.codec.view.layout_plan.in_bytes:
            excess = self.random.getrandbits(64 - self.placed.bits) << self.placed.bits if self.placed.bits < 64 else 0
            return self.batch.frame(self.placed, excess.to_bytes(8, "big"))
        length = self.random.choice([size for size in range(self.batch.record) if 8 * size != self.placed.bits])
        return self.batch.frame(self.placed, bytes(length))

    def take(self, count: int) -> bytes:
        """Return this many records."""
        total = 0
        for pool in (self.sound, self.sound, self.sound, self.changes):
            total ^= int.from_bytes(b"".join(map(pool.__getitem__, self.random.randbytes(count))), "big")
        return total.to_bytes(count * self.batch.record, "big")


def _some_bits(bits: int, random_: random.Random) -> int:
    return sum({1 << random_.randrange(bits) for _ in range(random_.randint(1, 3))})


def _sum_of(first: bytes, second: bytes) -> bytes:
    return bytes(a ^ b for a, b in zip(first, second, strict=True))


def chunks(batch: Batch, codec: Codec, total: int, seed: str, size: int = CHUNK) -> Iterator[tuple[Variant, bytes]]:
    """Yield each order code in turn with some records, up to ``total``."""
    random_ = random.Random(f"{seed} {batch.device.name} {codec.name}")
    sources = [Frames(batch, codec, variant, random_) for variant in variants(batch.device, codec)]
    remaining = total
    while remaining > 0:
        for source in sources:
            count = min(size, remaining, max(1, total // len(sources)))
            if count > 0:
                yield source.variant, source.take(count)
            remaining -= count


def wires(batch: Batch, codec: Codec, records: bytes) -> list[int] | list[bytes]:
    """Return the words or frames in records."""
    size = batch.record
    if not codec.view.layout_plan.in_bytes:
        return [int.from_bytes(records[at + 1 : at + 9], "big") for at in range(0, len(records), size)]
    return [records[at + 1 : at + 1 + records[at]] for at in range(0, len(records), size)]


def input_of(batch: Batch, codec: Codec, pieces: list[tuple[Variant, bytes]]) -> bytes:
    return b"".join(batch.chunk(DECODE, codec, variant, records) for variant, records in pieces)
