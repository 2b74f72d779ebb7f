"""Measure which mistake is named for three frames with the same mistake, over all distinct layouts of all encoders.

    python benchmarks/why_campaign.py [SETS] [INTERFACE]

SETS is the number of sets of three frames for each layout and each mistake, by default 6. Of the frames that are not
valid in spite of the mistake, ``single`` is how often the mistake is among the first three if ``decode`` gets only this
frame. Frames of a set with ``no trace`` are left out. Each set is in one column:

- ``as it is``: a frame of the set is valid in spite of its mistake, so ``decode`` explains nothing. ``doubts`` is how
  often "Does the position look wrong?" then lists the position that was sent.
- ``no trace``: with each of several first bytes, any bytes would be a valid frame, so the missing byte is unknown.
- ``undecided``: another mistake explains every one of 32 further frames with this one, and is at least as likely for
  three frames. ``listed`` is how often the mistake is still in the list. Likelihoods are those of ``decode``.
- ``judged``: all other sets. ``first`` is how often the mistake is named first, or the missing byte is named. ``three``
  is how often it is among the first three.
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log2
from typing import NamedTuple

from codewheel.commands.decode.explanations import why_text
from codewheel.commands.decode.frames import decode_text
from codewheel.loading.library import load_library
from codewheel.model import (
    Constant,
    Crc,
    Device,
    Flag,
    Number,
    Parity,
    PlacedField,
    PlacedLayout,
    Unused,
    Variant,
    number_from_bytes,
    number_to_bytes,
)
from codewheel.reference import codec
from codewheel.reference.bits_and_values import compute_bits, compute_bytes, parity_bit, reflect
from codewheel.why.diagnosis import Diagnosis, Explanation, without_details
from codewheel.why.doubts import other_positions, position_name
from codewheel.why.exchanges import usual_values_of
from codewheel.why.hypotheses import crc_covered_bits
from codewheel.why.recordings import FRAME_INSIDE
from codewheel.why.together import CommonMistake, judge_together

FRAMES_OF_SET = 3
#: Frames that show whether another mistake always explains the frames of a layout.
SAMPLE_FRAMES = 32
#: Attempts to make a valid frame, since some random numbers are outside the range of the position.
ATTEMPTS = 50
#: Share of flags that are active.
ACTIVE_SHARE = 0.05


@dataclass(frozen=True)
class Encoder:
    """A distinct layout of an order code. ``crc`` is None if the frame has no CRC, or one that covers bytes."""

    device: Device
    variant: Variant
    placed: PlacedLayout
    crc: Crc | None

    @property
    def name(self) -> str:
        return f"{self.variant.code} {self.placed.name}"

    def number_bits(self, frame: int) -> str:
        return f"{frame:0{self.placed.bits}b}"


@dataclass(frozen=True)
class Mistake:
    """A mistake: how it changes a valid frame, and the kinds of its explanation.

    ``changes_frame`` is false if only the CRC differs. ``pair`` is true for two mistakes at once. With
    ``loses_first_byte``, the length is right, because a byte follows a frame without its first byte. With
    ``other_address``, fields that have a factory default, such as the address of the encoder, have any value.
    """

    name: str
    plant: Callable[[int, random.Random], str]
    kinds: tuple[str, ...]
    changes_frame: bool = True
    pair: bool = False
    loses_first_byte: bool = False
    other_address: bool = False


@dataclass(frozen=True)
class Planted:
    """A frame with a mistake: its text, the result of decoding it, and the numbers that ``decode`` names for it.

    ``diagnoses`` has the diagnosis with pairs of mistakes, if it is known.
    """

    text: str
    decoded: codec.DecodedFrame
    numbers: dict[str, int]
    diagnoses: list[Diagnosis | None]


@dataclass
class Count:
    """Numbers of sets of three frames with the same mistake, in the columns that are printed."""

    as_it_is: int = 0
    doubts: int = 0
    without_doubts: int = 0
    no_trace: int = 0
    undecided: int = 0
    listed: int = 0
    judged: int = 0
    first: int = 0
    among_three: int = 0
    single: int = 0
    single_among_three: int = 0


def main() -> None:
    sets = int(sys.argv[1]) if len(sys.argv) > 1 else 6
    interfaces = sys.argv[2:] or ["biss", "ssi", "spi", "rs485"]
    devices, report = load_library()
    if report:
        sys.exit("the specs have problems. Run codewheel check")
    counts: dict[tuple[str, str], Count] = {}
    misses: Counter[str] = Counter()
    for encoder in distinct_encoders(devices):
        if encoder.variant.interface in interfaces:
            measure(encoder, sets, counts, misses)
    print_counts(counts)
    for text, number in misses.most_common(12):
        print(f"{number:4} {text}")


def print_counts(counts: dict[tuple[str, str], Count]) -> None:
    heads = f"{'as it is':>9}{'doubts':>9}{'no trace':>10}{'undecided':>11}{'listed':>9}"
    heads += f"{'judged':>8}{'first':>9}{'three':>9}{'frames':>9}{'single':>9}"
    print(f"{'frames':15}{'mistake':32}{heads}")
    for (frames, mistake), count in sorted(counts.items()):
        checked = count.doubts + count.without_doubts
        doubts = percentage(count.doubts, checked)
        listed = percentage(count.listed, count.undecided)
        first = percentage(count.first, count.judged)
        among_three = percentage(count.among_three, count.judged)
        single = percentage(count.single_among_three, count.single)
        print(
            f"{frames:15}{mistake:32}{count.as_it_is:9}{doubts:>9}{count.no_trace:10}{count.undecided:11}{listed:>9}"
            f"{count.judged:8}{first:>9}{among_three:>9}{count.single:9}{single:>9}"
        )


def percentage(part: int, whole: int) -> str:
    return f"{part / whole:.1%}" if whole else "-"


def distinct_encoders(devices: Iterable[Device]) -> list[Encoder]:
    """Return one encoder for each combination of interface, field places, CRC and Gray code."""
    encoder_by_shape: dict[object, Encoder] = {}
    for device in devices:
        for variant in device.variants:
            interface = device.interface(variant.interface)
            for layout in interface.layouts:
                placed = layout.place(variant.parameters)
                if layout.sender != "encoder" or placed.bits < 8 or getattr(placed, "channels", None):
                    continue
                crc = device.crc_of(placed)
                places = tuple((field.lowest_bit, field.width, type(field.field.kind)) for field in placed.fields)
                crc_shape = (crc.width, crc.poly, crc.init, crc.xorout) if crc is not None else None
                names = tuple(other.name for other in interface.layouts) if layout.in_bytes else ()
                shape = variant.interface, layout.in_bytes, places, crc_shape, bool(placed.gray), names
                encoder_by_shape.setdefault(shape, Encoder(device, variant, placed, crc))
    return list(encoder_by_shape.values())


# -- valid frames


def valid_frame(encoder: Encoder, placed: PlacedLayout, source: random.Random, *, other_address: bool = False) -> int:
    """Return a random valid frame. Fields with a factory default have it, unless the address is another one."""
    usual_values: Mapping[str, Sequence[int]] = {}
    if not other_address:
        usual_values = usual_values_of(encoder.device, encoder.variant.interface, placed.layout)
    crc = encoder.device.crc_of(placed)
    for _ in range(ATTEMPTS):
        frame = sum(random_value(placed, field, usual_values, source) << field.lowest_bit for field in placed.fields)
        for field in placed.fields:
            if isinstance(field.field.kind, Parity):
                frame |= parity_bit(placed, field.field.kind, frame) << field.lowest_bit
        if crc is not None:
            frame = with_crc(placed, frame, crc)
        if not codec.decode(encoder.device, placed, frame).problems:
            return frame
    raise LookupError(f"no valid frame of {encoder.name}")


def random_value(
    placed: PlacedLayout, field: PlacedField, usual_values: Mapping[str, Sequence[int]], source: random.Random
) -> int:
    kind = field.field.kind
    if field.name == placed.layout.selector:
        return source.choice(list(placed.layout.selects))
    values = usual_values.get(field.name, ())
    if len(values) == 1:
        return values[0]
    match kind:
        case Constant(value) | Unused(value):
            return value & field.mask
        case Flag(active_low=active_low):
            return int((source.random() < ACTIVE_SHARE) != active_low) if field.width else 0
        case Parity():
            return 0
    return source.getrandbits(field.width) if field.width else 0


def with_crc(placed: PlacedLayout, frame: int, crc: Crc) -> int:
    """Return the frame with this CRC in its last bits, or in its last byte if it consists of bytes."""
    if placed.layout.in_bytes:
        data = number_to_bytes(placed.layout, frame, placed.bits)[:-1]
        return number_from_bytes(placed.layout, data + bytes([compute_bytes(crc, data)]))
    covered_data, covered_bits = crc_covered_bits(placed, frame)
    return frame & ~crc.mask | compute_bits(crc, covered_data, covered_bits)


# -- mistakes


def mistakes_of(encoder: Encoder) -> Iterator[Mistake]:
    if encoder.placed.layout.in_bytes:
        yield from byte_mistakes(encoder)
        return
    yield from bit_mistakes(encoder, lambda frame: frame)
    if encoder.crc is not None:
        inverted_crc = replace(encoder.crc, xorout=encoder.crc.xorout ^ encoder.crc.mask)

        def invert_crc(frame: int) -> int:
            return with_crc(encoder.placed, frame, inverted_crc)

        yield Mistake(
            "CRC not inverted",
            lambda frame, _: f"0b{encoder.number_bits(invert_crc(frame))}",
            kinds=("crc_not_inverted",),
            changes_frame=False,
        )
        for mistake in bit_mistakes(encoder, invert_crc):
            yield replace(mistake, name=f"{mistake.name}, CRC inverted", pair=True)


def bit_mistakes(encoder: Encoder, change: Callable[[int], int]) -> Iterator[Mistake]:
    """Yield the mistakes with the bits of a frame. Before that, ``change`` makes a mistake with its CRC, or none."""
    bits = encoder.placed.bits
    byte_count = (bits + 7) // 8
    is_ssi = encoder.variant.interface == "ssi"

    def late(frame: int, source: random.Random) -> str:
        last = "0" if encoder.variant.interface == "biss" else str(source.getrandbits(1))
        return f"0b{encoder.number_bits(change(frame))[1:]}{last}"

    def early(frame: int, source: random.Random) -> str:
        # The line of SSI is idle, which is high, and CDS is usually 0.
        is_high = is_ssi or source.random() < (0.1 if encoder.variant.interface == "biss" else 0.5)
        return f"0b{int(is_high)}{encoder.number_bits(change(frame))[:-1]}"

    def inverted(frame: int, _: random.Random) -> str:
        return f"0b{encoder.number_bits(change(frame) ^ ((1 << bits) - 1))}"

    def bits_reversed(frame: int, _: random.Random) -> str:
        return f"0b{encoder.number_bits(reflect(change(frame), bits))}"

    def bytes_reversed(frame: int, _: random.Random) -> str:
        return " ".join(f"0x{byte:02x}" for byte in change(frame).to_bytes(byte_count, "little"))

    yield from recorded_mistakes(encoder, change)
    yield Mistake("late", late, kinds=("first_bit_missing",))
    yield Mistake("early", early, kinds=("bits_in_front",))
    yield Mistake("inverted", inverted, kinds=("all_inverted",))
    yield Mistake("bits reversed", bits_reversed, kinds=("bits_reversed",))
    if byte_count > 1:
        yield Mistake("bytes reversed", bytes_reversed, kinds=("bytes_reversed",))


def recorded_mistakes(encoder: Encoder, change: Callable[[int], int]) -> Iterator[Mistake]:
    """Yield raw buffers of BiSS, and SSI words with extra clocks, which the master reads as 0."""

    is_left = encoder.variant.interface == "ssi" and encoder.device.interface("ssi").alignment.end == "msb_left"

    def raw_buffer(frame: int, source: random.Random) -> str:
        idle, acknowledge, time_out = source.randrange(9), source.randrange(1, 12), source.randrange(1, 9)
        cds = int(source.random() < 0.1)
        received = f"{'1' * idle}{'0' * acknowledge}1{cds}{encoder.number_bits(change(frame))}{'0' * time_out}"
        received += "1" * (-len(received) % 8)
        return f"0x{int(received, 2):0{len(received) // 4}x}"

    def extra_clocks(frame: int, source: random.Random) -> str:
        zeros = "0" * source.choice((1, 2, 3, 4, 7, 8))
        word = encoder.number_bits(change(frame))
        return f"0b{word}{zeros}" if is_left else f"0b{zeros}{word}"

    if encoder.variant.interface == "biss":
        yield Mistake("raw buffer", raw_buffer, kinds=("raw_buffer",))
    if encoder.variant.interface == "ssi":
        kinds = ("zeros_behind", "bits_behind") if is_left else ("zeros_in_front", "bits_in_front")
        yield Mistake("extra clocks", extra_clocks, kinds)


def byte_mistakes(encoder: Encoder) -> Iterator[Mistake]:
    """Yield the mistakes with the bytes of a frame. An echo is the request that this frame answers."""
    layout = encoder.placed.layout

    def data(frame: int) -> bytes:
        return number_to_bytes(layout, frame, encoder.placed.bits)

    def request(source: random.Random) -> bytes:
        interface = encoder.device.interface(encoder.variant.interface)
        names = [exchange.request for exchange in interface.exchanges if exchange.reply == layout.name]
        placed = next(other for other in interface.layouts if other.name in names).place(encoder.variant.parameters)
        return number_to_bytes(placed.layout, valid_frame(encoder, placed, source), placed.bits)

    if any(exchange.reply == layout.name for exchange in encoder.device.interface("rs485").exchanges):
        yield Mistake("echo alone", lambda _, source: request(source).hex(" "), kinds=("echo",), changes_frame=False)
        yield Mistake(
            "echo before reply",
            lambda frame, source: (request(source) + data(frame)).hex(" "),
            kinds=("bytes_in_front",),
        )
    # Replies to different requests can have the same form, so the numbers are not compared. If a reply has the form of
    # a request, two of them are also the echo of a request and its reply.
    kinds = ("several_frames", "bytes_in_front") if repeats_request(encoder) else ("several_frames",)
    yield Mistake("two replies", lambda frame, _: (data(frame) * 2).hex(" "), kinds, changes_frame=False)
    yield Mistake("first byte missing", lambda frame, _: data(frame)[1:].hex(" "), kinds=("first_byte_lost",))
    yield Mistake(
        "first byte missing, one behind",
        lambda frame, source: (data(frame)[1:] + source.randbytes(1)).hex(" "),
        kinds=("first_byte_lost",),
        loses_first_byte=True,
    )
    yield Mistake("inverted", lambda frame, _: bytes(byte ^ 0xFF for byte in data(frame)).hex(" "), ("all_inverted",))
    if usual_values_of(encoder.device, encoder.variant.interface, layout):
        yield Mistake(
            "first byte missing, address",
            lambda frame, _: data(frame)[1:].hex(" "),
            kinds=("first_byte_lost",),
            other_address=True,
        )


def repeats_request(encoder: Encoder) -> bool:
    """Return whether most random replies with this layout are also valid requests."""
    layouts = encoder.device.interface(encoder.variant.interface).layouts
    requests = [layout.place(encoder.variant.parameters) for layout in layouts if layout.sender == "master"]
    source = random.Random(encoder.name)
    replies = [valid_frame(encoder, encoder.placed, source) for _ in range(SAMPLE_FRAMES)]
    replies_in_bytes = [number_to_bytes(encoder.placed.layout, reply, encoder.placed.bits) for reply in replies]

    def count_valid(request: PlacedLayout) -> int:
        return sum(not codec.decode_placed(encoder.device, request, reply).problems for reply in replies_in_bytes)

    return any(count_valid(request) > SAMPLE_FRAMES / 2 for request in requests)


# -- results

MistakeKey = tuple[str, str, bool]


class Evidence(NamedTuple):
    """The frequency of a mistake, and the evidence for it in a frame, both as binary logarithms."""

    log_frequency: float
    bits: float

    @classmethod
    def of(cls, explanation: Explanation) -> Evidence:
        return cls(log2(explanation.frequency), log2(explanation.score / explanation.frequency))


def explanations_of(diagnosis: Diagnosis | None) -> Sequence[Explanation]:
    """Return all explanations of a frame, including those that lead to the same frame as another one."""
    return (diagnosis.all_explanations or diagnosis.explanations) if diagnosis is not None else ()


def measure(encoder: Encoder, sets: int, counts: dict[tuple[str, str], Count], misses: Counter[str]) -> None:
    source = random.Random(encoder.name)
    has_crc = encoder.crc is not None
    frames = f"{encoder.variant.interface}{'' if has_crc else ' no CRC'}"
    for mistake in mistakes_of(encoder):
        count = counts.setdefault((frames, mistake.name), Count())
        can_tell: bool | None = None
        has_no_trace = mistake.loses_first_byte and is_any_frame(encoder, source)
        for _ in range(sets):
            planted_frames = [plant(encoder, mistake, source) for _ in range(FRAMES_OF_SET)]
            if not has_no_trace:
                count_single_frames(encoder, mistake, planted_frames, count)
            if any(is_valid(planted) for planted in planted_frames):
                count_doubts(encoder, mistake, planted_frames, count)
                continue
            if has_no_trace:
                count.no_trace += 1
                continue
            if can_tell is None:
                can_tell = is_decidable(encoder, mistake, source)
            place = place_of_mistake(encoder, mistake, planted_frames)
            if not can_tell:
                count.undecided += 1
                count.listed += place is not None
                continue
            says_missing = all(is_missing(encoder, planted) for planted in planted_frames)
            is_named = place == 0 or says_missing
            count.judged += 1
            count.first += is_named
            count.among_three += says_missing or (place is not None and place < 3)
            if not is_named:
                misses[f"{frames}, {mistake.name}: {encoder.name}"] += 1


def plant(encoder: Encoder, mistake: Mistake, source: random.Random) -> Planted:
    frame = valid_frame(encoder, encoder.placed, source, other_address=mistake.other_address)
    text = mistake.plant(frame, source)
    name = None if encoder.placed.layout.in_bytes else encoder.placed.name
    decoded = decode_text(encoder.device, encoder.variant, "encoder", text, name)
    values = codec.decode(encoder.device, encoder.placed, frame).values
    undecided: set[str] = set()
    if encoder.placed.layout.in_bytes:
        # ``decode`` omits numbers whose place depends on a question that the user has not answered.
        undecided = {name for alternative in encoder.device.alternatives for name in alternative.answers[0].sets}
    names = [
        field.name
        for field in encoder.placed.fields
        if isinstance(field.field.kind, Number) and undecided.isdisjoint(field.field.low.parameters)
    ]
    numbers = {name: values[name] for name in names if isinstance(values[name], int)}
    return Planted(text, decoded, numbers, diagnoses=[])


def is_valid(planted: Planted) -> bool:
    return planted.decoded.layout is not None and not planted.decoded.problems


def why(encoder: Encoder, planted: Planted, *, with_pairs: bool = False) -> Diagnosis | None:
    """Return the diagnosis of a frame. It is computed only once, since this takes almost all of the time."""
    if not planted.diagnoses:
        diagnosis = why_text(encoder.device, encoder.variant, "encoder", planted.text, planted.decoded, with_pairs=True)
        planted.diagnoses.append(diagnosis)
    (diagnosis_with_pairs,) = planted.diagnoses
    if with_pairs or diagnosis_with_pairs is None:
        return diagnosis_with_pairs
    return without_pairs(diagnosis_with_pairs)


def without_pairs(diagnosis: Diagnosis) -> Diagnosis:
    """Return what ``decode`` shows for a single frame: pairs only if no single mistake explains it by a rule."""
    single_mistakes = [explanation for explanation in diagnosis.explanations if not explanation.needs_two_mistakes]
    if all(explanation.kind == FRAME_INSIDE for explanation in single_mistakes):
        return diagnosis
    all_single_mistakes = tuple(
        explanation for explanation in diagnosis.all_explanations if not explanation.needs_two_mistakes
    )
    return replace(diagnosis, explanations=tuple(single_mistakes), all_explanations=all_single_mistakes)


def count_single_frames(encoder: Encoder, mistake: Mistake, planted_frames: Sequence[Planted], count: Count) -> None:
    """Count the invalid frames for which the mistake, or the missing byte, is among the first three explanations."""
    for planted in planted_frames:
        if is_valid(planted):
            continue
        count.single += 1
        diagnosis = why(encoder, planted)
        likeliest = diagnosis.explanations[:3] if diagnosis is not None else ()
        has_right = any(explains(mistake, planted, explanation) for explanation in likeliest)
        count.single_among_three += has_right or is_missing(encoder, planted)


def is_missing(encoder: Encoder, planted: Planted) -> bool:
    """Return whether the result says that a byte is missing."""
    diagnosis = why(encoder, planted)
    return diagnosis is not None and bool(diagnosis.missing_part)


def count_doubts(encoder: Encoder, mistake: Mistake, planted_frames: Sequence[Planted], count: Count) -> None:
    """Count whether the position that was sent is among the other readings of each valid frame."""
    count.as_it_is += 1
    name = position_name(encoder.device, encoder.variant)
    valid_frames = [planted for planted in planted_frames if is_valid(planted)]
    has_readings = mistake.name in ("inverted", "early", "bytes reversed") and encoder.crc is None
    is_position = all(name in planted.numbers for planted in valid_frames)
    if not has_readings or not is_position:
        return
    for planted in valid_frames:
        sent_position = planted.numbers[name]
        readings = other_positions(encoder.device, encoder.variant, planted.decoded)
        positions = [planted.decoded.values[name], *(position for _, position in readings)]
        if sent_position in positions:
            count.doubts += 1
        else:
            count.without_doubts += 1


def right_mistakes(mistake: Mistake, planted: Planted, diagnosis: Diagnosis | None) -> dict[MistakeKey, Explanation]:
    """Return the explanations of a frame that name the mistake and give the numbers that were sent, by their keys."""
    return {
        explanation.mistake: explanation
        for explanation in explanations_of(diagnosis)
        if explains(mistake, planted, explanation)
    }


def explains(mistake: Mistake, planted: Planted, explanation: Explanation) -> bool:
    """Return whether an explanation names the mistake and gives the numbers that were sent."""
    if explanation.kind not in mistake.kinds or explanation.needs_two_mistakes != mistake.pair:
        return False
    if not explanation.numbers_read or not mistake.changes_frame:
        return True
    return planted.numbers in [dict(reads) for reads in (explanation.numbers_read, *explanation.other_numbers_read)]


def is_decidable(encoder: Encoder, mistake: Mistake, source: random.Random) -> bool:
    """Return whether three frames of this layout can show the mistake.

    They cannot if another mistake explains every frame with this one, and is at least as likely for three of them. If
    ``decode`` does not know the mistake at all, it should, so that counts as decidable.
    """
    evidence_of_others: dict[MistakeKey, list[Evidence]] | None = None
    evidence_of_right: list[Evidence] = []
    for _ in range(SAMPLE_FRAMES):
        planted = plant(encoder, mistake, source)
        if is_valid(planted):
            continue
        diagnosis = why(encoder, planted, with_pairs=mistake.pair)
        right_ones = right_mistakes(mistake, planted, diagnosis)
        evidence_of_right += [Evidence.of(explanation) for explanation in right_ones.values()]
        others = {
            explanation.mistake: Evidence.of(explanation)
            for explanation in explanations_of(diagnosis)
            if explanation.mistake not in right_ones
        }
        if evidence_of_others is None:
            evidence_of_others = {key: [] for key in others}
        evidence_of_others = {key: [*known, others[key]] for key, known in evidence_of_others.items() if key in others}
    if not evidence_of_right:
        return True
    right_score = score_of_set(evidence_of_right)
    return all(score_of_set(evidence) < right_score for evidence in (evidence_of_others or {}).values())


def is_any_frame(encoder: Encoder, source: random.Random) -> bool:
    """Return whether any bytes are a valid frame with several values of the first byte, which may be missing.

    This is so if it is so for 32 random sequences of the other bytes.
    """
    length = encoder.placed.bits // 8

    def has_several_first_bytes(other_bytes: bytes) -> bool:
        frames = [bytes([first_byte]) + other_bytes for first_byte in range(256)]
        decoded_frames = [codec.decode_placed(encoder.device, encoder.placed, frame) for frame in frames]
        return sum(not decoded.problems for decoded in decoded_frames) > 1

    return all(has_several_first_bytes(source.randbytes(length - 1)) for _ in range(SAMPLE_FRAMES))


def score_of_set(evidence: Sequence[Evidence]) -> float:
    """Return the binary logarithm of the likelihood that a mistake with this mean evidence explains a set of frames."""
    mean_bits = sum(part.bits for part in evidence) / len(evidence)
    return evidence[0].log_frequency + FRAMES_OF_SET * mean_bits


def place_of_mistake(encoder: Encoder, mistake: Mistake, planted_frames: Sequence[Planted]) -> int | None:
    """Return the index of the mistake among those that explain the frames together, or None if it is not listed."""
    common_mistakes = judge(encoder, planted_frames)
    texts: set[str] = set()
    for planted in planted_frames:
        diagnosis = why(encoder, planted, with_pairs=True)
        right_ones = right_mistakes(mistake, planted, diagnosis)
        if not right_ones:
            return None
        for (_, template, _), explanation in right_ones.items():
            texts |= {explanation.text, without_details(template)}
    places = [index for index, common_mistake in enumerate(common_mistakes) if common_mistake.text in texts]
    return min(places, default=None)


def judge(encoder: Encoder, planted_frames: Sequence[Planted]) -> list[CommonMistake]:
    """Return the mistakes that explain the frames together, as ``decode`` does."""
    diagnoses = [why(encoder, planted) for planted in planted_frames]
    mistakes = judge_together([diagnosis for diagnosis in diagnoses if diagnosis is not None])
    if mistakes and mistakes[0].frames == len(planted_frames) and not mistakes[0].hides_shift:
        return mistakes
    with_pairs = [why(encoder, planted, with_pairs=True) for planted in planted_frames]
    return judge_together([diagnosis for diagnosis in with_pairs if diagnosis is not None])


if __name__ == "__main__":
    main()
