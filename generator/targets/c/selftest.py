"""A self-test that users compile with their own compiler: a function for each worked example.

The checks of a family are numbered from 1 in the order of its spec. The number returned is that of the failed check.
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
)
from ...model.record import dataclass
from ...plan.codec import Part
from ...plan.values import Active, Characters, DigitRuns, Named, Raw, TwosComplement, ZeroMeans
from ...plan.vectors import CONTROL_FIELDS, vectors_of
from .. import manufacturers
from .codec import StructCodec
from .device import DeviceView
from .folds import WordCrc
from .positions import LengthPositions
from .procedures import ProcedureCode
from .reserved import c_name
from .runtime import runtime_tests
from .types import number, signed_number, string


@dataclass(frozen=True, slots=True)
class Expected:
    """A member of a struct and its expected value. ``text`` is True if it is a string."""

    member: str
    value: str
    text: bool = False


@dataclass(frozen=True, slots=True)
class FrameCheck:
    """A frame or register that decodes to the expected values and encodes to the same bits, or fails with ``fault``."""

    codec: StructCodec
    variant: str
    answers: str
    data: tuple[str, ...]
    word: str
    expected: tuple[Expected, ...]
    fault: str


@dataclass(frozen=True, slots=True)
class CrcCheck:
    """A CRC over bytes."""

    function: str
    data: tuple[str, ...]
    word: str
    crc: str


@dataclass(frozen=True, slots=True)
class ProcedureCheck:
    """The writes of a procedure in order: address and byte."""

    code: ProcedureCode
    variant: str
    arguments: tuple[str, ...]
    writes: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class MeasureCheck:
    """A position in counts, as a length."""

    function: str
    variant: str
    counts: str
    micrometres: str


@dataclass(frozen=True, slots=True)
class ConstantCheck:
    """A macro with its value."""

    macro: str
    value: str


Work = ConstantCheck | FrameCheck | CrcCheck | ProcedureCheck | MeasureCheck


@dataclass(frozen=True, slots=True)
class Check:
    """A numbered check. ``about`` names the example and its source."""

    number: int
    about: str
    work: Work


class SelfTest:
    """The checks of an interface, without the examples for which its headers have no function."""

    def __init__(self, view: DeviceView) -> None:
        self.view = view
        self.name = f"{view.prefix}_selftest"
        self.path = f"selftest/{view.stem}.c"
        works = [*self._examples(), *self._vectors()]
        self.checks = [Check(index, about, work) for index, (about, work) in enumerate(works, 1)]

    @property
    def is_used(self) -> Mapping[str, bool]:
        """The helpers that the checks need."""
        frames = [item.work for item in self.checks if isinstance(item.work, FrameCheck)]
        return {
            "bytes": any(item.data and not item.fault for item in frames),
            "texts": any(one.text for item in frames for one in item.expected),
            "writes": any(isinstance(item.work, ProcedureCheck) for item in self.checks),
        }

    def _examples(self) -> Iterator[tuple[str, Work]]:
        for example in self.view.device.examples:
            about = f"{example.name.replace('_', ' ')} [{cite(example.source)}]"
            yield from ((about, work) for work in self._works(example))

    def _vectors(self) -> Iterator[tuple[str, Work]]:
        for codec in self.view.interface.codecs:
            crc = codec.word_crc
            if crc is None:
                continue
            for vector in vectors_of(crc.crc):
                about = f"{vector.title} [{vector.source}]"
                yield from ((f"{crc.crc.name}: {about}", work) for work in _whole_word(crc, vector.data, vector.crc))
        interface = self.view.context.interface
        for item in interface.data_ids if isinstance(interface, Rs485) else ():
            if item.id in CONTROL_FIELDS:
                macro = f"{self.view.PREFIX}_CONTROL_{item.name}".upper()
                yield f"control field of data ID {item.id}", ConstantCheck(macro, _hex(CONTROL_FIELDS[item.id]))

    def _works(self, example: Example) -> Iterator[Work]:
        match example:
            case FrameExample():
                yield from self._frames(example)
            case RegisterExample():
                yield from self._register(example)
            case CrcExample():
                yield from self._crc(example)
            case ProcedureExample():
                code = next(item for item in self.view.procedures if item.run.procedure.name == example.procedure)
                given = tuple(number(example.arguments[item.given.argument.name]) for item in code.arguments)
                writes = tuple(byte for item in example.writes for byte in self._written(item))
                yield ProcedureCheck(code, self._variant(example.order_code), given, writes)
            case MeasureExample():
                yield from self._measure(example)
            case _:
                assert_never(example)

    def _written(self, item: Write) -> Iterator[tuple[str, str]]:
        """Yield the bytes of a write, each with its address."""
        length = 1
        if self.writes_whole:
            over = self.view.context.interface.name
            registers = (one for one in self.view.device.registers_over(over) if one.writable)
            length = next(one.length for one in registers if one.address == item.address)
        yield from ((_hex(item.address), _hex(byte)) for byte in item.value.to_bytes(length, "big"))

    @property
    def writes_whole(self) -> bool:
        """True if a write has all bytes of a register."""
        return not self.view.context.interface.byte_addresses

    def _variant(self, order_code: str) -> str:
        """Return the macro of an order code, or of the first one if it is not a listed code."""
        device = self.view.device
        codes = [item.code for item in device.variants]
        at = codes.index(order_code) if order_code in codes else 0
        return self.view.variants.rows[at].macro

    def _codecs(self, example: FrameExample) -> Iterator[StructCodec]:
        for item in self.view.interface.codecs:
            layout = item.struct.layout
            if layout.name == example.layout or (not example.layout and layout.sender == example.sender):
                yield item

    def _frames(self, example: FrameExample) -> Iterator[Work]:
        for item in self._codecs(example):
            layout = item.struct.layout
            # A word can be given as its bytes, too.
            word = int(example.bits, 2) if example.bits else int.from_bytes(example.bytes, "big")
            fits = bool(example.bytes) if item.plan.in_bytes else bool(example.bits) or example.refused != "length"
            if fits and (example.layout or example.refused == "length"):
                fault = f"CW_FAULT_{example.refused.upper()}" if example.refused else ""
                yield FrameCheck(
                    item,
                    self._variant(example.order_code),
                    self._answers(item, example),
                    _bytes(example.bytes) if item.plan.in_bytes else (),
                    "" if item.plan.in_bytes else _hex(word, 64),
                    () if fault else tuple(self._expected(item, layout.name, example.values)),
                    fault,
                )

    def _answers(self, item: StructCodec, example: FrameExample) -> str:
        """Return the answers for the example, or the first answer if it states none."""
        found = ""
        for asked in item.asked:
            names = [answer.name for answer in asked.item.answers]
            at = names.index(example.alternatives.get(asked.item.name, names[0]))
            found += f"{asked.enumeration.entries[at].name}, "
        return found

    def _register(self, example: RegisterExample) -> Iterator[Work]:
        code = next(item for item in self.view.registers if item.register.name == example.register)
        if code.codec is not None:
            expected = tuple(self._expected(code.codec, f"reg_{example.register}", example.values))
            variant = self._variant(example.order_code)
            yield FrameCheck(code.codec, variant, "", _bytes(example.bytes), "", expected, "")

    def _expected(self, of: StructCodec, key: str, values: Mapping[str, int | str | bool]) -> Iterator[Expected]:
        """Yield the members. Fields without one are constant. They are checked by decoding and encoding the frame."""
        members = set(_members(of))
        for name, value in values.items():
            if name not in members:
                continue
            part = next((item for item in of.plan.parts if item.field.name == name), None)
            yield self._member(key, name, value, part)

    def _member(self, key: str, name: str, value: int | str | bool, part: Part | None) -> Expected:
        """Return the expected value of a field, or without ``part`` of a join or a run of digits."""
        match part.meaning if part is not None else Raw():
            case Characters():
                return Expected(c_name(name), string(value), text=True)
            case Named(values) if isinstance(value, str):
                found = next(item.value for item in values if item.name == value)
                choice = self.view.context.choices.get((key, name))
                return Expected(c_name(name), choice.names.get(found, number(found)) if choice else number(found))
            case Active():
                return Expected(c_name(name), "true" if value else "false")
            case TwosComplement() if int(value) < 0:
                return Expected(c_name(name), signed_number(int(value)))
            case Raw() | TwosComplement() | ZeroMeans() | Named() | DigitRuns():
                return Expected(c_name(name), number(int(value)))
            case other:
                assert_never(other)

    def _crc(self, example: CrcExample) -> Iterator[Work]:
        for item in self.view.crcs:
            if item.crc.name == example.crc and item.is_called and item.in_bytes:
                yield CrcCheck(item.name, _bytes(example.bytes), "", _hex(example.check))
        data = int.from_bytes(example.bytes, "big")
        for crc in (item.word_crc for item in self.view.interface.codecs):
            if crc is not None and crc.crc.name == example.crc:
                yield from _whole_word(crc, data, example.check)

    def _measure(self, example: MeasureExample) -> Iterator[Work]:
        if isinstance(self.view.positions, LengthPositions):
            function, macro = f"{self.view.prefix}_micrometres", self._variant(example.order_code)
            yield MeasureCheck(function, macro, number(example.counts), number(example.micrometres))


def _members(of: StructCodec) -> Iterator[str]:
    """Yield the names of the members of a struct, as in the spec."""
    yield from (whole.join.name for whole in of.plan.wholes)
    for part in of.plan.parts:
        yield from (part.field.name, *(run.name for run in part.field.runs))


def _whole_word(crc: WordCrc, data: int, check: int) -> Iterator[Work]:
    """Yield the check of a word that ends in its CRC, if a frame can be as long."""
    word = data << crc.crc.width | check
    if word.bit_length() <= crc.bits:
        yield CrcCheck(crc.name, (), _hex(word, 64), _hex(0))


def _bytes(data: bytes) -> tuple[str, ...]:
    return tuple(_hex(byte) for byte in data)


def _hex(value: int, bits: int = 32) -> str:
    return f"UINT64_C(0x{value:X})" if bits == 64 else f"0x{value:02X}U"


class FamilyTest(TypedDict):
    maker: Annotated[Manufacturer, "the manufacturer"]
    t: Annotated[SelfTest, "the checks of the family"]


class AllTests(TypedDict):
    makers: Annotated[dict[str, list[SelfTest]], "the self-tests of the families, by manufacturer"]


def own_test(view: DeviceView, render: Callable[[str, Mapping[str, object]], str]) -> Iterator[tuple[str, str]]:
    """Yield the self-test of an interface if it has any, with its path in the C folder."""
    test = SelfTest(view)
    if test.checks:
        family: FamilyTest = {"maker": view.maker, "t": test}
        yield test.path, render("selftest.c.jinja", family)


def selftest_files(
    views: Sequence[DeviceView], tests: Sequence[SelfTest], render: Callable[[str, Mapping[str, object]], str]
) -> dict[str, str]:
    """Return the files of the self-test other than those of the families, by their path in the C folder."""
    files = {}
    names = [maker.name for maker in manufacturers(view.device for view in views)]
    values: AllTests = {"makers": {name: [test for test in tests if test.view.maker.name == name] for name in names}}
    for name, template in (("selftest.h", "selftest.h.jinja"), ("selftest.c", "selftest_all.c.jinja")):
        files[f"selftest/{name}"] = render(template, values)
    return files | {f"selftest/{name}": text for name, text in runtime_tests().items()}
