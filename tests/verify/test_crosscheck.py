"""C and Python agree on a million random and corrupted frames of each layout.

They agree on the error, the members, the encoded frame, the verdict and the reports. Both are the generated code as a
user has it. C and the reference, which is only the model, agree on the error, verdict, reports and unused bits of a
million frames of each layout that an encoder sends. ``CODEWHEEL_FRAMES`` sets another number.
"""

from __future__ import annotations

import importlib
import inspect
import struct
import subprocess
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from batch import Batch, Codec, stdio_entry
from c_harness import compile_c
from codewheel.model import Device, Fault, Variant, Verdict
from codewheel.plan.verdicts import reportings, reports_of
from codewheel.reference import codec as reference
from codewheel.reference.codec import UNUSED
from codewheel.reference.findings import findings
from codewheel.targets.c.names import c_name
from codewheel.targets.python.names import DeviceNames
from frames import chunks, input_of, wires
from test_c_reports import report_key
from tools import tool
from tree import generated_tree, interfaces, number_from_environment, package_of

FRAMES = number_from_environment("CODEWHEEL_FRAMES", 1_000_000)
#: Number of frames in memory. A piece has one run of the C program.
PIECE = 100_000
LENGTH, CRC, CONSTANT, RANGE = 1, 2, 3, 4
#: Verdicts in C, by their names in Python. 255 means none.
VERDICTS = {verdict.value: number for number, verdict in enumerate(Verdict)}
NO_VERDICT = 255
#: Errors of the model, as C numbers them.
FAULTS = {Fault.LENGTH: LENGTH, Fault.CRC: CRC, Fault.CONSTANT: CONSTANT, Fault.RANGE: RANGE}


class Peer:
    """The Python class of a layout: it decodes, lists its members in the order of the struct, and encodes."""

    def __init__(self, batch: Batch, codec: Codec, module: ModuleType) -> None:
        self.names = names = DeviceNames(batch.device)
        self.module = module
        self.kind = getattr(
            module,
            names.class_name_by_frame.get(codec.name) or names.class_name_by_register[codec.name.removeprefix("reg_")],
        )
        self.takes_variant = "variant" in inspect.signature(self.kind.decode).parameters
        field_names = [
            *(field.name for field in codec.layout.fields),
            *(run.name for field in codec.layout.fields for run in field.runs),
            *(join.name for join in codec.layout.joins),
            *([UNUSED] if codec.layout.unused else []),
        ]
        by_member = {c_name(name): name if hasattr(self.kind, name) else f"{name}_" for name in field_names}
        self.text = [index for index, member in enumerate(codec.members, 1) if member.characters]
        if [member.name for member in codec.members] == ["no_data"]:
            self.members: Callable[[Any], tuple[Any, ...]] = lambda _: (0, 0)
        elif len(self.kind.__mro__) > 1 and not hasattr(self.kind, "_fields"):
            self.members = lambda value: (0, int(value))
        else:
            self.members = eval(
                f"lambda value: (0, {''.join(f'value.{by_member[member.name]}, ' for member in codec.members)})"
            )
        self.tells_verdict, self.tells_reports = hasattr(self.kind, "verdict"), hasattr(self.kind, "reports")
        self.bits = {report.name: 1 << number for number, report in enumerate(reports_of(batch.device))}
        #: Open questions about the layout: the name of each alternative, and its answers in order.
        self.open = {}
        for alternative in batch.device.alternatives_of(codec.layout):
            answers = getattr(module, names.question_by_name[alternative.name].enum_name)
            self.open[alternative.name] = [answers[answer.name.upper()] for answer in alternative.answers]
        package = importlib.import_module(module.__name__.partition(".")[0])
        self.error = package.FrameError
        self.errors = {
            package.LengthError: LENGTH,
            package.CrcError: CRC,
            package.ConstantError: CONSTANT,
            package.RangeError: RANGE,
        }

    def variant(self, device: Device, variant: Variant) -> Any:
        """Return the order code of the package, with the contents of its registers."""
        label, state = label_and_state(variant)
        contents: dict[int, int] = {}
        answers: dict[str, Any] = {}
        alternatives = {alternative.name: alternative for alternative in device.alternatives}
        for name, data in state.items():
            if name not in alternatives:
                address = device.register(name).address
                contents |= {address + index: byte for index, byte in enumerate(bytes.fromhex(data))}
            elif alternatives[name].default:
                answer = alternatives[name].answers[int(data, 16)]
                answers[name] = getattr(self.module, self.names.question_by_name[name].enum_name)[answer.name.upper()]
        encoder = self.module.lookup(label)
        encoder = encoder.with_registers(contents) if contents else encoder
        return encoder.with_answers(**answers) if answers else encoder

    def answers(self, variant: Variant) -> list[Any]:
        """Return the answers for a decoder, with the first answer if the variant has none."""
        _, state = label_and_state(variant)
        return [answers[int(state.get(name, "0"), 16)] for name, answers in self.open.items()]

    def verdict_and_reports(self, value: Any) -> tuple[int, int]:
        """Return the verdict and the mask of the reports."""
        verdict = VERDICTS[value.verdict.value] if self.tells_verdict else NO_VERDICT
        return verdict, sum(self.bits[report.name] for report in value.reports) if self.tells_reports else 0

    def differences(
        self,
        codec: Codec,
        extra: Sequence[Any],
        wires: Sequence[int] | Sequence[bytes],
        answers: bytes,
        kinds: Counter[int],
    ) -> list[object]:
        """Return the differences in C's answers. Every fourth valid frame is encoded again, in half the time."""
        differences: list[object] = []
        decode, members, error, faults, text = self.kind.decode, self.members, self.error, self.errors, self.text
        last = 1 + len(codec.members)
        results: list[int] = []
        for wire, answer in zip(wires, struct.iter_unpack(codec.answer, answers), strict=True):
            try:
                value = decode(wire, *extra)
            except error as reason:
                expected: tuple[Any, ...] = (faults[type(reason)],)
                matches = answer[0] == expected[0] and not any(answer[last + 1])
            else:
                expected = members(value)
                again = len(results) & 3 == 0
                decoded = answer[:last]
                if text:
                    decoded = tuple(part.decode("latin-1") if type(part) is bytes else part for part in answer[:last])
                matches = decoded == expected and (not again or answer[last:-2] == self.encoded(codec, value))
                matches = matches and answer[-2:] == self.verdict_and_reports(value)
            results.append(expected[0])
            if not matches:
                differences.append((wire, answer, expected))
        kinds.update(results)
        return differences

    def encoded(self, codec: Codec, value: Any) -> tuple[int, bytes]:
        """Return the result and the bytes that C should return for ``value``.

        Python also keeps the bits of a register that belong to no field. C writes 0 there. A copy does not keep the
        bytes of a register with limits, so it is checked as in C.
        """
        value = value._replace(unused=0) if codec.view.layout_plan.keeps_undefined_bits else value._replace()
        try:
            again = value.encode()
        except self.error as reason:
            return self.errors[type(reason)], bytes(codec.encoded_bytes)
        return 0, again.to_bytes(8, "big") if not codec.view.layout_plan.in_bytes else again


def label_and_state(variant: Variant) -> tuple[str, dict[str, str]]:
    """Return the label, and the further parts of a variant's code: bytes of registers and answers, by name."""
    label, *state = variant.code.split(";")
    return label, dict(part.split("=") for part in state)


def compare(family: str, name: str, program: Path, package: Path) -> tuple[int, Counter[int], list[object]]:
    """Compare all frames of a layout. Return their number, the counts of the results, and the differences."""
    device = interfaces()[family]
    module = getattr(package_of(device, package), device.name)
    batch = Batch(device)
    codec = next(codec for codec in batch.codecs if codec.name == name)
    peer = Peer(batch, codec, module)
    kinds: Counter[int] = Counter()
    differences: list[object] = []
    compared = 0
    pieces: list[tuple[Variant, bytes]] = []
    for variant, records in chunks(batch, codec, FRAMES, "cross-check"):
        pieces.append((variant, records))
        if sum(len(piece_records) for _, piece_records in pieces) >= PIECE * batch.record:
            compared += compare_piece(batch, codec, peer, pieces, program, kinds, differences)
            pieces = []
    compared += compare_piece(batch, codec, peer, pieces, program, kinds, differences)
    return compared, kinds, differences[:5]


def compare_piece(
    batch: Batch,
    codec: Codec,
    peer: Peer,
    pieces: list[tuple[Variant, bytes]],
    program: Path,
    kinds: Counter[int],
    differences: list[object],
) -> int:
    out = subprocess.run([str(program)], input=input_of(batch, codec, pieces), capture_output=True, check=True).stdout
    size, at = struct.calcsize(codec.answer), 0
    for variant, records in pieces:
        frames = wires(batch, codec, records)
        extra = [*([peer.variant(batch.device, variant)] if peer.takes_variant else []), *peer.answers(variant)]
        differences += peer.differences(codec, extra, frames, out[at : at + size * len(frames)], kinds)
        at += size * len(frames)
    assert at == len(out)
    return at // size


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return generated_tree(tmp_path_factory.mktemp("crosscheck"))


@pytest.fixture(scope="module")
def programs(tree: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return the C program of an interface."""
    folder = tmp_path_factory.mktemp("programs")
    command = [tool("gcc"), "-std=c99", "-O2"]
    return cache(
        lambda family: compile_c(
            command,
            Batch(interfaces()[family]).source(stdio_entry()),
            folder,
            tree / "c" / "include",
            f"{family}_batch",
        )
    )


@pytest.mark.parametrize(
    ("family", "name"), [(stem, codec.name) for stem, device in interfaces().items() for codec in Batch(device).codecs]
)
def test_c_and_python_agree(family: str, name: str, programs: Callable[[str], Path], tree: Path) -> None:
    done, kinds, differences = compare(family, name, programs(family), tree / "python")
    assert not differences
    assert done == FRAMES == sum(kinds.values())
    # At least a sixth is valid, and lengths are sometimes wrong, so that the comparison covers different cases.
    assert kinds[0] > FRAMES / 6, kinds
    assert kinds[LENGTH] > FRAMES / 25, kinds


def of_encoders() -> list[tuple[str, str]]:
    """Return the frames that encoders send, as family and name."""
    families = interfaces().items()
    codecs = [(stem, codec) for stem, device in families for codec in Batch(device).codecs]
    return [(stem, codec.name) for stem, codec in codecs if codec.layout.sender == "encoder"]


class Oracle:
    """Return the findings of the model about frames: error, verdict, mask of reports, and unused bits."""

    def __init__(self, device: Device, codec: Codec) -> None:
        self.device, self.layout = device, codec.layout
        reporting = reportings(device).get(codec.name)
        reports = reporting.causes if reporting is not None else ()
        self._bits = {report_key(device, report): 1 << report.report.number for report in reports}

    def findings_of(
        self, variant: Variant, frames: Sequence[int] | Sequence[bytes]
    ) -> Iterator[tuple[int, int, int, int]]:
        device, placed, bits = self.device, self.layout.place(variant.parameters), self._bits
        for wire in frames:
            if isinstance(wire, bytes):
                decoded = reference.decode_placed(device, placed, wire)
            else:
                decoded = reference.decode(device, placed, wire)
            if decoded.problems:
                yield FAULTS[decoded.problems[0].fault], NO_VERDICT, 0, 0
                continue
            report = findings(device, variant, decoded)
            verdict = VERDICTS[report.verdict.value] if report.verdict is not None else NO_VERDICT
            unused = decoded.fields[-1].raw if decoded.fields[-1].name == UNUSED else 0
            yield 0, verdict, sum(bits[flag.field, flag.meaning] for flag in report.reports), unused


@pytest.mark.parametrize(("family", "name"), of_encoders())
def test_c_tells_what_the_reference_tells(family: str, name: str, programs: Callable[[str], Path]) -> None:
    batch = Batch(interfaces()[family])
    codec = next(codec for codec in batch.codecs if codec.name == name)
    oracle, answer_size = Oracle(batch.device, codec), struct.calcsize(codec.answer)
    indexes_of_unused = [index for index, member in enumerate(codec.members, 1) if member.name == UNUSED]
    index_of_unused = indexes_of_unused[0] if indexes_of_unused else None
    count_by_outcome: Counter[tuple[int, int]] = Counter()
    for variant, records in chunks(batch, codec, FRAMES, "reference"):
        program_input = input_of(batch, codec, [(variant, records)])
        completed = subprocess.run([str(programs(family))], input=program_input, capture_output=True, check=True)
        assert len(completed.stdout) == answer_size * (len(records) // batch.record)
        frames = wires(batch, codec, records)
        c_answers = struct.iter_unpack(codec.answer, completed.stdout)
        for wire, c_answer, expected in zip(frames, c_answers, oracle.findings_of(variant, frames), strict=True):
            verdict, reports = c_answer[-2:] if c_answer[0] == 0 else (NO_VERDICT, 0)
            decoded = c_answer[0], verdict, reports, c_answer[index_of_unused] if index_of_unused is not None else 0
            assert decoded == expected, (variant.code, wire)
            count_by_outcome[expected[:2]] += 1
    assert count_by_outcome.total() == FRAMES
    # There are valid frames, and each verdict that a flag can cause.
    assert sum(count for (fault, _), count in count_by_outcome.items() if not fault) > FRAMES / 6, count_by_outcome
