"""Valid and disturbed frames and register contents, and the results of the model's own codec for each."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from codewheel.model import Choice, Device, Fault, Field, PlacedLayout, Text, Variant, number_to_bytes
from codewheel.model.registers import name_with_limits, value_bounds
from codewheel.order_codes.parameters import with_answers
from codewheel.reference.bits_and_values import join_value
from codewheel.reference.codec import UNUSED, EncodeError, FrameProblem, decode, encode
from codewheel.reference.findings import DecodedField, DecodedFrame
from codewheel_rust.family import Struct
from rust_harness import Program
from test_c_codec import encoded_sample, run_time_variants, samples, with_crc

Values = Mapping[str, "int | str | bool"]
#: Minimum number of frames for an order code, and the number that are created one by one.
_LEAST, _POOL = 100, 32


@dataclass(frozen=True)
class Case:
    """A frame or register for one order code."""

    device: Device
    struct: Struct
    variant: Variant
    placed: PlacedLayout

    @property
    def set(self) -> str:
        """Return the line that sets the variant."""
        names = (parameter.name for parameter in self.device.parameters if parameter.equals is None)
        return f"v {' '.join(str(self.variant.parameters[name]) for name in names)}"

    def wire(self, number: int, longer: int = 0) -> str:
        """Return a word, or the bytes of a frame with this many more."""
        if not self.struct.codec.in_bytes:
            return f"{number:X}"
        data = number_to_bytes(self.placed.layout, number, self.placed.bits)
        return "x" + (data + bytes(longer) if longer >= 0 else data[:longer]).hex().upper()

    def wrong_lengths(self, number: int) -> list[str]:
        """Return the same with too many bits, or too few or too many bytes."""
        if self.struct.codec.in_bytes:
            return [self.wire(number, longer) for longer in (-1, 1, 2)]
        return [self.wire(number | 1 << bit) for bit in range(self.placed.bits, 64)]

    def decoding(self, number: int) -> str:
        """Return the expected answer to decoding."""
        decoded = decode(self.device, self.placed, number)
        if decoded.problems:
            return first_fault(decoded.problems)
        powers = any(field.field.number.power_of_two for field in self.placed.fields)
        covered = sum(field.mask << field.lowest_bit for field in self.placed.fields)
        again = self._encoded(decoded.values) if powers else self._limited(decoded.values, covered & number)
        return f"ok {self._row(decoded, {})} = {again}"

    def encoding(self, sound: int, name: str, value: int) -> tuple[str, str]:
        """Return a valid frame with another value of one member, and the expected answer to encoding it."""
        reference = decode(self.device, self.placed, sound)
        # A run of digits or a join would contradict the value that it repeats, and a text can be other than ASCII.
        fields = {field.name: field.field for field in self.placed.fields if field.field.carries_data}
        values: dict[str, int | str | bool] = {}
        for decoded in reference.fields:
            if decoded.name in fields:
                values[decoded.name] = decoded.raw if isinstance(fields[decoded.name].kind, Text) else decoded.value
            if decoded.name == UNUSED:
                values[decoded.name] = decoded.raw
        return self._row(reference, {name: value}, "x"), self._encoded({**values, name: value})

    def _encoded(self, values: Values) -> str:
        try:
            number = encode(self.device, self.placed, values)
        except EncodeError:
            return "range"
        # The model encodes digits that it would refuse to decode.
        return "range" if decode(self.device, self.placed, number).problems else self._limited(values, number)

    def _limited(self, values: Values, number: int) -> str:
        register = self.struct.register
        if register is not None and (register.min is not None or register.max is not None):
            name = name_with_limits(register)
            low, high = value_bounds(register, self.placed, (register.min, register.max), self.variant.parameters)
            joined = {join.name: join_value(self.placed, join, number) for join in self.struct.layout.joins}
            value = {**values, **joined}.get(name, number)
            if not low <= int(value) <= high:
                return f"range {name or register.name}"
        return self.wire(number).removeprefix("x")

    def _row(self, decoded: DecodedFrame, changed_values: Mapping[str, int], mark: str = "") -> str:
        """Return the members. In an answer, also return the runs of digits and the joins."""
        fields = {decoded_field.name: decoded_field for decoded_field in decoded.fields}
        members = [part.field for part in self.struct.codec.decoded_fields]
        words = []
        for member in members:
            is_changed = member.name in changed_values
            words.append(str(changed_values[member.name]) if is_changed else _member_text(member, fields, mark))
        if self.struct.codec.reserved:
            words.append(str(changed_values.get(UNUSED, fields[UNUSED].raw)))
        if not mark:
            runs = [run.name for member in members for run in member.runs]
            joins = [join.name for join in self.struct.layout.joins]
            words += [str(fields[name].value) for name in (*runs, *joins)]
        return " ".join(words)


def _member_text(field: Field, fields: Mapping[str, DecodedField], mark: str) -> str:
    """Return a member. A field that this order code lacks is 0."""
    decoded = fields.get(field.name)
    if decoded is None:
        return str(field.number.zero_means)
    if isinstance(field.kind, Text):
        return mark + decoded.raw.to_bytes((decoded.high - decoded.low + 1) // 8, "big").hex().upper()
    if isinstance(field.kind, Choice):
        return str(next(value.value for value in field.values if value.name == decoded.value))
    return str(int(decoded.value))


def first_fault(problems: Sequence[FrameProblem]) -> str:
    """Return the first error, and its field if it is reported."""
    fault, field = problems[0].fault, problems[0].field
    return f"{fault.value} {field}" if fault in (Fault.CONSTANT, Fault.RANGE) else fault.value


def cases(program: Program, index: int) -> list[Case]:
    """Return a frame or register for the order codes that differ and send it, and for some states of the registers."""
    device, struct = program.device, program.structs[index]
    names = [interface.name for interface, frame in program.family.frames if frame is struct]
    name = struct.register.interface if struct.register is not None else names[0]
    answered = _with_each_answer(device, (*device.variants, *run_time_variants(device)))
    variants = {tuple(variant.parameters.items()): variant for variant in answered if variant.interface == name}
    placed = ((variant, struct.layout.place(variant.parameters)) for variant in variants.values())
    return [Case(device, struct, variant, placed_layout) for variant, placed_layout in placed if placed_layout.bits]


def _with_each_answer(device: Device, variants: Iterable[Variant]) -> Iterator[Variant]:
    """Return the variants with each answer to the open questions of the manual."""
    questions = device.alternatives
    for variant, chosen in itertools.product(
        variants, itertools.product(*(question.answers for question in questions))
    ):
        answers = {question.name: answer.name for question, answer in zip(questions, chosen, strict=True)}
        yield with_answers(device, variant, answers)


def numbers(case: Case, count: int, random_: random.Random) -> Iterator[int]:
    """Return this many numbers, half of them valid or nearly valid.

    CRCs, parities and constants are sums modulo 2 of bits, so the sum of three valid numbers is usually also valid.
    """
    placed = case.placed
    data = [field for field in placed.fields if field.field.carries_data]
    choices = {field.name: samples(field.field, field.width, placed.layout, random_) for field in data}
    sound = [encoded_sample(case.device, placed, choices, {}, random_) for _ in range(min(count, _POOL))]
    yield from sound
    changes = [0] * _POOL
    changes += [_some_bits(placed.bits, random_) for _ in range(_POOL // 2)]
    for number in sound[: _POOL // 2]:
        changes.append(with_crc(case.device, placed, number ^ _some_bits(placed.bits, random_)) ^ number)
        changes.append(random_.getrandbits(placed.bits))
    for _ in range(count - len(sound)):
        yield random_.choice(sound) ^ random_.choice(sound) ^ random_.choice(sound) ^ random_.choice(changes)


def _some_bits(bits: int, random_: random.Random) -> int:
    return sum({1 << random_.randrange(bits) for _ in range(random_.randint(1, 3))})


def decoding(program: Program, index: int, count: int) -> set[str]:
    """Decode this many frames of a layout, over all order codes. Return the kinds of answers."""
    random_ = random.Random(f"{program.device.name} {index}")
    frame_cases = cases(program, index)
    pairs = []
    for case in frame_cases:
        pairs.append((case.set, ""))
        for number in numbers(case, max(count // len(frame_cases), _LEAST), random_):
            pairs.append((f"d {index} {case.wire(number)}", case.decoding(number)))
        pairs += [(f"d {index} {wire}", "length") for wire in case.wrong_lengths(number)]
    check(program, pairs)
    return {expected.partition(" ")[0] for _, expected in pairs if expected}


def check(program: Program, pairs: list[tuple[str, str]]) -> None:
    """Send each line, and compare the answer with the expected one, or with nothing if that is empty."""
    answers = program.run(line for line, _ in pairs)
    assert len(answers) == len(pairs)
    rows = [(line, expected, answer) for (line, expected), answer in zip(pairs, answers, strict=True) if expected]
    differing = [row for row in rows if not _matches(row[1], row[2])]
    assert not differing, differing[:5]


def _matches(expected: str, answer: str) -> bool:
    """Return True if an answer is as expected. The model does not say which value it refuses."""
    return answer.startswith(f"{expected} ") if expected.endswith("range") else expected == answer
