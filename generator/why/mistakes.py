"""Why a CRC fails: the usual mistakes that a CRC can see, and what it cannot see.

Each mistake is tried on the frame: were it made, what would the CRC have to be? All that fit are listed, likeliest
first. A mistake fits by coincidence too: with a CRC of 6 bits, one random frame in 64. So every explanation has its
chance, and the list as a whole has one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod

from ..model import Crc, Device, Number, PlacedLayout, Variant
from ..reference import codec
from . import in_bits, in_bytes
from .in_bits import BitText
from .tries import MISTAKES, NOT_INVERTED, Try

__all__ = ["BitText", "Explanation", "Why", "explain_bits", "explain_bytes", "explain_constant"]

#: A mistake that more than one random frame in eight fits explains nothing.
_LEAST_BITS = 3


@dataclass(frozen=True, slots=True)
class Explanation:
    """A mistake that would make the CRC fit.

    Of ``one_in`` random frames it fits one. ``reads`` are the numbers of the frame as it would be without the mistake,
    where that is another frame than given. ``codes`` are the order codes that would send it. ``twice`` says that two
    mistakes are needed.
    """

    kind: str
    text: str
    one_in: int
    score: float
    reads: Mapping[str, int]
    codes: tuple[str, ...] = ()
    twice: bool = False


@dataclass(frozen=True, slots=True)
class Why:
    """What would explain a frame, likeliest first.

    ``tried`` mistakes were tried, pairs included; of random frames the part ``coincidence`` would fit at least one of
    them. ``cannot_see`` says which mistakes no CRC of this kind notices.
    """

    explanations: tuple[Explanation, ...]
    tried: int
    coincidence: float
    cannot_see: tuple[str, ...]


def explain_bits(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """What would make the CRC of ``text`` fit, which was to be a frame by ``placed``.

    None where the frame has no CRC.
    """
    crc = device.crc_of(placed.layout)
    if crc is None:
        return None
    stuck = _stuck(text.number, placed.bits) if not text.exact or text.bits == placed.bits else None
    return _why(
        device, stuck, in_bits.tries(device, variant, placed, crc, text), _known_to_fail(placed, crc, text), (crc,)
    )


def explain_constant(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """Explain a frame whose CRC fits and whose constant does not by another answer to what the manual leaves open.

    None where no other answer fits.
    """
    crc = device.crc_of(placed.layout)
    if crc is None:
        return None
    fitting = [item for item in in_bits.other_answers(device, variant, placed, crc, text) if item.fits]
    return _why(device, None, fitting, (), (crc,)) if fitting else None


def explain_bytes(
    device: Device, variant: Variant, sender: str, placed: PlacedLayout | None, data: bytes
) -> Why | None:
    """What would make the CRC of ``data`` fit, which was to be a frame by ``placed`` if that is known.

    None where nothing could be tried.
    """
    stuck = _stuck(int.from_bytes(data, "big"), 8 * len(data)) if len(data) > 1 else None
    tried = list(in_bytes.tries(device, variant, sender, placed, data))
    crcs = tuple({item.crc.name: device.crc(item.crc.name) for item in tried}.values())
    # Nobody has decided anything for an unknown frame: what depends on that is not read rather than read wrongly.
    undecided = frozenset(name for item in device.alternatives for name in item.answers[0].sets)
    return _why(device, stuck, tried, (), crcs, undecided)


def _known_to_fail(placed: PlacedLayout, crc: Crc, text: BitText) -> tuple[Try, ...]:
    """The frame as given, which is known not to fit; a mistake that comes to the same is not worth a try."""
    if text.bits > placed.bits or (text.exact and text.bits != placed.bits):
        return ()
    return (in_bits.as_sent(placed, crc, text.number),)


def _why(
    device: Device,
    stuck: Explanation | None,
    tries: Iterable[Try],
    failed: Sequence[Try],
    crcs: Sequence[Crc],
    undecided: frozenset[str] = frozenset(),
) -> Why | None:
    single = _distinct(tries, failed)
    if not single:
        return None
    found = [_explanation(device, item, undecided) for item in single if item.fits]
    asked = single
    if not found and stuck is None:
        # Two at once only with the commonest of all, and only then: every further pair would fit by coincidence too.
        asked = _distinct((*single, *(_not_inverted(item) for item in single if item.kind != NOT_INVERTED)), failed)
        found = [
            replace(_explanation(device, item, undecided), twice=True) for item in asked[len(single) :] if item.fits
        ]
    found.sort(key=lambda item: -item.score)
    chances = {item.question: item.one_in for item in asked}
    coincidence = 1 - prod(1 - 1 / one_in for one_in in chances.values())
    blind = tuple(dict.fromkeys(text for crc in crcs for text in _cannot_see(crc)))
    return Why((*([stuck] if stuck is not None else []), *found), len(asked), coincidence, blind)


def _distinct(tries: Iterable[Try], failed: Sequence[Try]) -> list[Try]:
    """The tries that say something, without those that ask what is known to fail.

    Of those that ask the same and lead to the same frame the first.
    """
    wrong = {item.question for item in failed}
    found: dict[object, Try] = {}
    for item in tries:
        if item.known + item.demanded >= _LEAST_BITS and item.question not in wrong:
            leads_to = (item.number, _places(item.placed)) if item.placed is not None else item.text
            found.setdefault((item.question, leads_to), item)
    return list(found.values())


def _places(placed: PlacedLayout) -> tuple[int, tuple[tuple[str, int], ...]]:
    """The length, and the lowest bits of the fields: frames of one length can differ in them."""
    return placed.bits, tuple((item.name, item.low) for item in placed.fields)


def _not_inverted(item: Try) -> Try:
    turned = "not inverted" if item.crc.xorout else "inverted"
    return replace(
        item,
        text=f"{item.text}; and the CRC is {turned}",
        crc=replace(item.crc, xorout=item.crc.xorout ^ item.crc.mask),
    )


def _explanation(device: Device, item: Try, undecided: frozenset[str]) -> Explanation:
    reads: dict[str, int] = {}
    if item.placed is not None:
        known = (entry for entry in item.placed.fields if undecided.isdisjoint(entry.field.low.parameters))
        numbers = {entry.name for entry in known if isinstance(entry.field.kind, Number)}
        decoded = codec.decode(device, item.placed, item.number)
        reads = {
            entry.name: entry.value
            for entry in decoded.fields
            if entry.name in numbers and isinstance(entry.value, int)
        }
    return Explanation(item.kind, item.text, item.one_in, item.score, reads, item.codes)


def _stuck(number: int, bits: int) -> Explanation | None:
    """All bits alike: that is no frame at all."""
    if number not in (0, (1 << bits) - 1):
        return None
    text = f"every bit is {1 if number else 0}: the line does not move, and there is nothing to check"
    return Explanation("line_stuck", text, 1 << (bits - 1), MISTAKES["line_stuck"] * 2.0 ** (bits - 1), {})


def _cannot_see(crc: Crc) -> list[str]:
    found = []
    if crc.is_xor:
        found.append(
            "that bytes have changed places, or that every byte is sent from the other end: it is the XOR of the bytes"
        )
        found.append("how many bytes of 0 there are")
    elif crc.init == 0:
        found.append(
            "zeros missing or too many in front, such as those of a wider or narrower order code: its start value is 0"
        )
    found.append("which bits are which field, and whether they are Gray code or binary")
    return found
