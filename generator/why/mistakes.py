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
#: So few bits may well be all alike.
_LEAST_STUCK = 12


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
    them. ``cannot_see`` says which mistakes no CRC of this kind notices. ``disturbed`` are the bits, 0 the last one of
    the number, each of which makes the frame valid if it alone is inverted. It is the usual cause if only some frames
    fail, and none that a single frame could show: the CRC is short, and most random frames have such a bit.
    """

    explanations: tuple[Explanation, ...]
    tried: int
    coincidence: float
    cannot_see: tuple[str, ...]
    disturbed: tuple[int, ...] = ()


def explain_bits(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """What would make the CRC of ``text`` fit, which was to be a frame by ``placed``.

    None where the frame has no CRC, unless all its bits are alike.
    """
    crc = device.crc_of(placed.layout)
    stuck = _stuck(text.number, text.bits if text.exact else max(text.bits, placed.bits), crc is not None)
    if stuck is not None:
        return stuck
    if crc is None:
        return None
    failed = _known_to_fail(placed, crc, text)
    why = _why(device, in_bits.tries(device, variant, placed, crc, text), failed, (crc,))
    flips = (1 << bit for bit in range(placed.bits if failed else 0))
    fits = [in_bits.read_as("", "", placed, crc, text.number ^ flip).fits for flip in flips]
    return replace(why, disturbed=_fitting_bits(fits)) if why is not None else None


def explain_constant(device: Device, variant: Variant, placed: PlacedLayout, text: BitText) -> Why | None:
    """Explain a frame whose CRC fits and whose constant does not by another answer to what the manual leaves open.

    None where no other answer fits.
    """
    crc = device.crc_of(placed.layout)
    if crc is None:
        return None
    fitting = [item for item in in_bits.other_answers(device, variant, placed, crc, text) if item.fits]
    return _why(device, fitting, (), (crc,)) if fitting else None


def explain_bytes(
    device: Device, variant: Variant, sender: str, placed: PlacedLayout | None, data: bytes
) -> Why | None:
    """What would make the CRC of ``data`` fit, which was to be a frame by ``placed`` if that is known.

    None where nothing could be tried.
    """
    number = int.from_bytes(data, "big")
    stuck = _stuck(number, 8 * len(data), True)
    if stuck is not None:
        return stuck
    tried = list(in_bytes.tries(device, variant, sender, placed, data))
    crcs = tuple({item.crc.name: device.crc(item.crc.name) for item in tried}.values())
    # The user has decided nothing for an unknown frame, so what depends on an answer is not read.
    undecided = frozenset(name for item in device.alternatives for name in item.answers[0].sets)
    why = _why(device, tried, (), crcs, undecided)
    if why is None or placed is None or 8 * len(data) != placed.bits:
        return why
    flipped = ((number ^ 1 << bit).to_bytes(len(data), "big") for bit in range(placed.bits))
    return replace(why, disturbed=_fitting_bits([in_bytes.is_sound(device, placed, item) for item in flipped]))


def _fitting_bits(fits: Sequence[bool]) -> tuple[int, ...]:
    return tuple(bit for bit, does_fit in enumerate(fits) if does_fit)


def _known_to_fail(placed: PlacedLayout, crc: Crc, text: BitText) -> tuple[Try, ...]:
    """The frame as given, which is known not to fit; a mistake that comes to the same is not worth a try."""
    if text.bits > placed.bits or (text.exact and text.bits != placed.bits):
        return ()
    return (in_bits.as_sent(placed, crc, text.number),)


def _why(
    device: Device,
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
    if not found:
        # Two at once only with the commonest of all, and only then: every further pair would fit by coincidence too.
        asked = _distinct((*single, *(_not_inverted(item) for item in single if item.kind != NOT_INVERTED)), failed)
        found = [
            replace(_explanation(device, item, undecided), twice=True) for item in asked[len(single) :] if item.fits
        ]
    found.sort(key=lambda item: -item.score)
    chances = {item.question: item.one_in for item in asked}
    coincidence = 1 - prod(1 - 1 / one_in for one_in in chances.values())
    blind = tuple(dict.fromkeys(text for crc in crcs for text in _cannot_see(crc)))
    return Why(tuple(found), len(asked), coincidence, blind)


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


def _stuck(number: int, bits: int, has_crc: bool) -> Why | None:
    """All bits alike: that is no frame at all, and no other mistake is worth a try."""
    if bits < _LEAST_STUCK or number not in (0, (1 << bits) - 1):
        return None
    level = 1 if number else 0
    if has_crc:
        cause = "cut" if level else "shorted"
        text = f"every bit is {level}: the line does not move. Is it {cause}, is there a supply, does the clock arrive?"
    else:
        text = f"every bit is {level}: a line that does not move looks the same, and without a CRC nothing tells"
    one_in = 1 << min(bits - 1, 62)
    found = Explanation("line_stuck", text, one_in, MISTAKES["line_stuck"] * one_in, {})
    return Why((found,), 1, 1 / one_in, ())


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
