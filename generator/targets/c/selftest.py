"""A self-test that users compile with their own compiler: a function for each worked example.

The checks of a family are numbered from 1 in the order of its spec. The number returned is the number of the failed
check.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Annotated, TypedDict

from ...model import (
    CrcExample,
    Example,
    FrameExample,
    Manufacturer,
    MeasureExample,
    ProcedureExample,
    RegisterExample,
    Rs485,
    Write,
    assert_never,
    cite,
    first_or_raise,
    member_named,
)
from ...model.record import dataclass
from ...plan.crcs import CONTROL_FIELDS, public_vectors_of
from ...plan.operations import FieldToDecode
from ...plan.values import ActiveFlag, Latin1Text, NamedChoice, TwosComplement, UnsignedNumber
from .. import manufacturers
from .codec import StructCodec
from .context import AlternativeCode
from .crcs import WordCrc
from .device import DeviceView
from .header_text import runtime_tests
from .names import c_name, c_number, signed_number, string
from .positions import LengthPositions
from .procedures import ProcedureCode


@dataclass(frozen=True, slots=True)
class ExpectedMember:
    """A member of a struct and its expected value as C. ``is_text`` is True for a string."""

    member: str
    value: str
    is_text: bool = False


@dataclass(frozen=True, slots=True)
class FrameCheck:
    """A frame or register of a worked example, as ``data`` in bytes or as a ``word``.

    It must decode to the expected values and encode to the same bits. With a ``fault``, the decoder must return this
    fault instead. ``answers`` are the arguments for questions that the manual leaves open.
    """

    codec: StructCodec
    variant: str
    answers: str
    data: tuple[str, ...]
    word: str
    #: The number of bits in the word, if its decoder takes it.
    length: str
    expected_members: tuple[ExpectedMember, ...]
    fault: str


@dataclass(frozen=True, slots=True)
class CrcCheck:
    """A function that must return ``crc`` for the bytes ``data``, or for a ``word``."""

    function: str
    data: tuple[str, ...]
    word: str
    crc: str


@dataclass(frozen=True, slots=True)
class ProcedureCheck:
    """A procedure that must write these bytes in order: pairs of address and byte."""

    code: ProcedureCode
    variant: str
    arguments: tuple[str, ...]
    writes: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class MeasureCheck:
    """A function that must convert a position in counts to this length."""

    function: str
    variant: str
    counts: str
    micrometres: str


@dataclass(frozen=True, slots=True)
class ConstantCheck:
    """A macro that must have this value."""

    macro: str
    value: str


Expectation = ConstantCheck | FrameCheck | CrcCheck | ProcedureCheck | MeasureCheck


@dataclass(frozen=True, slots=True)
class SelfTestCheck:
    """A numbered check. ``about`` names the example and its source."""

    number: int
    about: str
    expectation: Expectation


class SelfTest:
    """The checks of an interface, one for each worked example whose function is in the headers."""

    def __init__(self, view: DeviceView) -> None:
        self.view = view
        self.name = f"{view.prefix}_selftest"
        self.path = f"selftest/{view.stem}.c"
        descriptions_and_expectations = [*self._example_checks(), *self._vector_checks()]
        self.checks: list[SelfTestCheck] = []
        for number, (about, expectation) in enumerate(descriptions_and_expectations, 1):
            self.checks.append(SelfTestCheck(number, about, expectation))

    @property
    def is_used(self) -> Mapping[str, bool]:
        """For each helper function, which compares bytes, texts or writes, True if a check needs it."""
        frames = [check.expectation for check in self.checks if isinstance(check.expectation, FrameCheck)]
        expected_members: list[ExpectedMember] = []
        for frame in frames:
            expected_members += frame.expected_members
        return {
            # A frame that is rejected is not encoded, so that there are no bytes to compare.
            "bytes": any(frame.data and not frame.fault for frame in frames),
            "texts": any(member.is_text for member in expected_members),
            "writes": any(isinstance(check.expectation, ProcedureCheck) for check in self.checks),
        }

    def _example_checks(self) -> Iterator[tuple[str, Expectation]]:
        """Yield a description and a check for each worked example of the manual."""
        for example in self.view.device.examples:
            about = f"{example.name.replace('_', ' ')} [{cite(example.source)}]"
            for expectation in self._checks_of_example(example):
                yield about, expectation

    def _vector_checks(self) -> Iterator[tuple[str, Expectation]]:
        """Yield a description and a check for each test vector from a public source.

        The vectors are for the CRCs of words, and for the control fields of RS-485.
        """
        for codec in self.view.interface.codecs:
            word_crc = codec.word_crc
            if word_crc is None:
                continue
            for vector in public_vectors_of(word_crc.crc):
                for expectation in _word_check(word_crc, covered_bits=vector.data, check=vector.crc):
                    yield f"{word_crc.crc.name}: {vector.title} [{vector.source}]", expectation
        interface = self.view.context.interface
        data_ids = interface.data_ids if isinstance(interface, Rs485) else ()
        for data_id in data_ids:
            if data_id.id in CONTROL_FIELDS:
                macro = f"{self.view.PREFIX}_CONTROL_{data_id.name}".upper()
                yield (
                    f"control field of data ID {data_id.id}",
                    ConstantCheck(macro, _format_hex(CONTROL_FIELDS[data_id.id])),
                )

    def _checks_of_example(self, example: Example) -> Iterator[Expectation]:
        """Yield the checks for one worked example, none if the headers have no function for it."""
        match example:
            case FrameExample():
                yield from self._frame_checks(example)
            case RegisterExample():
                yield from self._register_checks(example)
            case CrcExample():
                yield from self._crc_checks(example)
            case ProcedureExample():
                yield self._procedure_check(example)
            case MeasureExample():
                yield from self._measure_checks(example)
            case _:
                assert_never(example)

    def _procedure_check(self, example: ProcedureExample) -> ProcedureCheck:
        """Return the check that a procedure writes the bytes of its worked example."""
        code_by_procedure = {code.procedure_plan.procedure.name: code for code in self.view.procedures}
        code = code_by_procedure[example.procedure]
        argument_names = [argument.checked_argument.argument.name for argument in code.arguments]
        written_bytes: list[tuple[str, str]] = []
        for write in example.writes:
            written_bytes += self._written_bytes(write)
        return ProcedureCheck(
            code=code,
            variant=self._find_variant(example.order_code),
            arguments=tuple(c_number(example.arguments[name]) for name in argument_names),
            writes=tuple(written_bytes),
        )

    def _written_bytes(self, write: Write) -> Iterator[tuple[str, str]]:
        """Yield the bytes of a write as pairs of address and byte, such as ``("0x10U", "0x02U")``.

        A write is one byte if the interface addresses bytes. Otherwise, it covers all bytes of the register, which then
        have the same address.
        """
        length = 1
        if self.writes_whole:
            interface = self.view.context.interface.name
            writable = [register for register in self.view.device.registers_over(interface) if register.writable]
            registers = (register for register in writable if register.address == write.address)
            length = first_or_raise(registers, f"writable register at {write.address:#x}").length
        for byte in write.value.to_bytes(length, "big"):
            yield _format_hex(write.address), _format_hex(byte)

    @property
    def writes_whole(self) -> bool:
        """True if a write covers all bytes of a register, because the interface does not address single bytes."""
        return not self.view.context.interface.byte_addresses

    def _find_variant(self, order_code: str) -> str:
        """Return the macro of an order code, or of the first order code if the family does not list the code."""
        device = self.view.device
        order_codes = [variant.code for variant in device.variants]
        index = order_codes.index(order_code) if order_code in order_codes else 0
        return self.view.variants.rows[index].macro

    def _yield_codecs(self, example: FrameExample) -> Iterator[StructCodec]:
        """Yield the codec of the example's layout, or all codecs of its sender if the example has no layout."""
        for codec in self.view.interface.codecs:
            layout = codec.struct.layout
            is_from_sender = not example.layout and layout.sender == example.sender
            if layout.name == example.layout or is_from_sender:
                yield codec

    def _frame_checks(self, example: FrameExample) -> Iterator[Expectation]:
        """Yield a check for each frame whose decoder accepts the example.

        A decoder of bytes accepts an example in bytes. A decoder of words accepts bits, and also bytes unless their
        length is wrong. An example without a layout is checked only if its length is wrong.
        """
        has_wrong_length = example.refused == "length"
        if not example.layout and not has_wrong_length:
            return
        for codec in self._yield_codecs(example):
            if codec.layout_plan.in_bytes:
                is_accepted = bool(example.bytes)
            else:
                # An example states bits or bytes.
                is_accepted = bool(example.bits) or not has_wrong_length
            if is_accepted:
                yield self._frame_check(codec, example)

    def _frame_check(self, codec: StructCodec, example: FrameExample) -> FrameCheck:
        """Return the check that a frame decodes to the values of the example, or that its decoder returns the fault."""
        # A word can be given as its bytes, too.
        word = int(example.bits, 2) if example.bits else int.from_bytes(example.bytes, "big")
        fault = f"CW_FAULT_{example.refused.upper()}" if example.refused else ""
        in_bytes = codec.layout_plan.in_bytes
        length = self._express_length(codec, example) if codec.word_has_length else ""
        layout_name = codec.struct.layout.name
        members = tuple(self._expected_members(codec, layout_name, example.values)) if not fault else ()
        return FrameCheck(
            codec=codec,
            variant=self._find_variant(example.order_code),
            answers=self._format_answers(codec.alternatives, example),
            data=_format_bytes(example.bytes) if in_bytes else (),
            word="" if in_bytes else _format_hex(word, 64),
            length=length,
            expected_members=members,
            fault=fault,
        )

    def _express_length(self, codec: StructCodec, example: FrameExample) -> str:
        """Return the number of bits in the word of an example, as C.

        It is a literal if the example states bits, or else a call such as ``acme_x24_bits(variant, WIDE)``.
        """
        if example.bits:
            return c_number(len(example.bits))
        answers = self._format_answers(codec.length_alternatives, example).removesuffix(", ")
        arguments = ", ".join(filter(None, ("variant", answers)))
        return f"{codec.name}_bits({arguments})"

    def _format_answers(self, questions: Sequence[AlternativeCode], example: FrameExample) -> str:
        """Return the answers to open questions as arguments, such as ``CODE_GRAY, ``.

        They are the answers that the example states, or else the first answers.
        """
        arguments = ""
        for question in questions:
            answer_names = [answer.name for answer in question.spec_question.answers]
            chosen_name = example.alternatives.get(question.spec_question.name, answer_names[0])
            # The enumeration has a constant for each answer, in the same order.
            constant = question.enumeration.constants[answer_names.index(chosen_name)]
            arguments += f"{constant.name}, "
        return arguments

    def _register_checks(self, example: RegisterExample) -> Iterator[Expectation]:
        """Yield the check that a register decodes to the values of the example, or nothing if it has no decoder."""
        codes = (code for code in self.view.registers if code.register.name == example.register)
        code = first_or_raise(codes, f"code for the register '{example.register}'")
        if code.codec is not None:
            yield FrameCheck(
                codec=code.codec,
                variant=self._find_variant(example.order_code),
                answers="",
                data=_format_bytes(example.bytes),
                word="",
                length="",
                expected_members=tuple(self._expected_members(code.codec, f"reg_{example.register}", example.values)),
                fault="",
            )

    def _expected_members(
        self, codec: StructCodec, owner: str, values: Mapping[str, int | str | bool]
    ) -> Iterator[ExpectedMember]:
        """Yield the members of a struct with the values of a worked example.

        ``owner`` is the name of the layout, or ``reg_`` and the name of a register. Constant fields have no member, and
        are checked by decoding and encoding the frame.
        """
        member_names = set(_member_names(codec))
        part_by_field = {decoded_field.name: decoded_field for decoded_field in codec.layout_plan.decoded_fields}
        for name, value in values.items():
            if name in member_names:
                yield self._expected_member(owner, name, value, part_by_field.get(name))

    def _expected_member(
        self, owner: str, name: str, value: int | str | bool, decoded_field: FieldToDecode | None
    ) -> ExpectedMember:
        """Return a member with its expected value as C, for a named value its constant.

        ``decoded_field`` is the field of the member, or None for a plain number that several fields form (a join) or
        that is some decimal digits of a field.
        """
        member = c_name(name)
        meaning = decoded_field.meaning if decoded_field is not None else UnsignedNumber()
        match meaning:
            case Latin1Text():
                return ExpectedMember(member, string(value), is_text=True)
            case NamedChoice(values) if isinstance(value, str):
                number = member_named(values, value, f"value of '{name}'").value
                enumeration = self.view.context.enumeration_by_field.get((owner, name))
                constant_by_number = enumeration.constant_by_value if enumeration else {}
                return ExpectedMember(member, constant_by_number.get(number, c_number(number)))
            case ActiveFlag():
                return ExpectedMember(member, "true" if value else "false")
            case TwosComplement() if int(value) < 0:
                return ExpectedMember(member, signed_number(int(value)))
            case _:
                return ExpectedMember(member, c_number(int(value)))

    def _crc_checks(self, example: CrcExample) -> Iterator[Expectation]:
        """Yield the checks of a CRC example: over its bytes, and over its bytes as a word that ends in the CRC."""
        for function in self.view.crcs:
            if function.crc.name == example.crc and function.is_called and function.in_bytes:
                yield CrcCheck(
                    function.name, data=_format_bytes(example.bytes), word="", crc=_format_hex(example.check)
                )
        covered_bits = int.from_bytes(example.bytes, "big")
        for codec in self.view.interface.codecs:
            word_crc = codec.word_crc
            if word_crc is not None and word_crc.crc.name == example.crc:
                yield from _word_check(word_crc, covered_bits=covered_bits, check=example.check)

    def _measure_checks(self, example: MeasureExample) -> Iterator[Expectation]:
        """Yield the check that converts a position in counts to a length, or nothing for a rotary encoder."""
        if isinstance(self.view.positions, LengthPositions):
            yield MeasureCheck(
                function=f"{self.view.prefix}_micrometres",
                variant=self._find_variant(example.order_code),
                counts=c_number(example.counts),
                micrometres=c_number(example.micrometres),
            )


def _member_names(codec: StructCodec) -> Iterator[str]:
    """Yield the names of the members of a struct, as in the spec."""
    yield from (joined_number.join.name for joined_number in codec.layout_plan.joined_numbers)
    for decoded_field in codec.layout_plan.decoded_fields:
        yield from (decoded_field.name, *(run.name for run in decoded_field.field.runs))


def _word_check(crc: WordCrc, covered_bits: int, check: int) -> Iterator[Expectation]:
    """Yield the check that the CRC function returns 0 for a word that ends in its CRC.

    ``check`` is the CRC of ``covered_bits``. Nothing is yielded if the word is longer than a frame.
    """
    word = (covered_bits << crc.crc.width) | check
    if word.bit_length() <= crc.word_bits:
        yield CrcCheck(crc.name, data=(), word=_format_hex(word, 64), crc=_format_hex(0))


def _format_bytes(data: bytes) -> tuple[str, ...]:
    return tuple(_format_hex(byte) for byte in data)


def _format_hex(value: int, bits: int = 32) -> str:
    return f"UINT64_C(0x{value:X})" if bits == 64 else f"0x{value:02X}U"


class FamilyTest(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    t: Annotated[SelfTest, "the checks of the family"]


class AllTests(TypedDict):
    makers: Annotated[dict[str, list[SelfTest]], "the self-tests of the families, by manufacturer"]


def own_test(
    view: DeviceView, render_later: Callable[[str, Mapping[str, object]], Callable[[], str]]
) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path in the C folder of the self-test of an interface, and a function that returns its text.

    Nothing is yielded if the interface has no checks. ``render_later`` takes a template and its values, and returns
    such a function.
    """
    test = SelfTest(view)
    if test.checks:
        family: FamilyTest = {"maker": view.maker, "t": test}
        yield test.path, render_later("selftest.c.jinja", family)


def selftest_files(
    views: Sequence[DeviceView], tests: Sequence[SelfTest], render: Callable[[str, Mapping[str, object]], str]
) -> dict[str, str]:
    """Return the self-test files that do not belong to a family, by their path in the C folder."""
    files = {}
    tests_by_maker: dict[str, list[SelfTest]] = {}
    for maker in manufacturers(view.device for view in views):
        tests_by_maker[maker.name] = [test for test in tests if test.view.maker.name == maker.name]
    values: AllTests = {"makers": tests_by_maker}
    for name, template in (("selftest.h", "selftest.h.jinja"), ("selftest.c", "selftest_all.c.jinja")):
        files[f"selftest/{name}"] = render(template, values)
    return files | {f"selftest/{name}": text for name, text in runtime_tests().items()}
