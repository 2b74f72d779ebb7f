"""Imports of a device module and of its facts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ...model.never import assert_never
from ...plan.codec import AlwaysIs, AtMost, Check, IsOneOf, ParityIs, ParityOf, ZerosAbove
from ...plan.crcs import Carrier, Form
from ...plan.refusals import (
    DigitsDisagree,
    DigitTooHigh,
    NoPowerOfTwo,
    NotOneOf,
    NotSigned,
    NotZeroFor,
    OutsideLimits,
    Refusal,
    TooWide,
    WholeDisagrees,
)
from ...plan.steps import AsNumber, Beyond, Operation, Polls, Reads, Sends, Stated, Undecodable, Verifies, Waits, Writes
from ...plan.values import (
    Active,
    Characters,
    DigitRuns,
    Meaning,
    Named,
    Raw,
    TwosComplement,
    ZeroMeans,
    is_named,
    meaning_of,
)
from .codec import Coder
from .literals import Call, functions
from .module import Enumeration, Module
from .names import FACTS, PACKAGE, STANDARD
from .procedures import Steps
from .variants import Variants


def imports(module: Module) -> list[list[tuple[str, list[str]]]]:
    """Return the modules from which a device module imports, with the names. Python's own modules come first."""
    used = {name for names in _used(module) for name in names.split()}
    used |= {name for item in (module.family, *(row for _, row in module.codes.held)) for name in functions(item)}
    return _groups(used, STANDARD, PACKAGE)


def fact_imports(module: Module) -> list[list[tuple[str, list[str]]]]:
    """Return the same for the module with its facts."""
    used = {"Final", *(item.kind for item in module.tables)}
    used |= {name for item in _facts(module) for name in functions(item)}
    given = (
        (module.reports, "Mapping Report Reports"),
        (module.frame_rows, "FieldFacts Mapping MappingProxyType"),
        (module.registers, "Mapping MappingProxyType Register"),
        (module.crcs, "Crc"),
    )
    return _groups(used | _named(given), STANDARD, FACTS)


def _groups(used: set[str], *groups: Mapping[str, tuple[str, ...]]) -> list[list[tuple[str, list[str]]]]:
    named = [{source: [n for n in names if n in used] for source, names in of.items()} for of in groups]
    return [[(source, names) for source, names in group.items() if names] for group in named]


def _facts(module: Module) -> Iterator[Call]:
    yield from (module.manual, module.order_code, *module.crcs, *module.register_rows.values())
    yield from (section.facts for section in module.sections)
    yield from (row for item in module.tables for row in item.rows)
    yield from module.reports
    yield from (row for rows in module.frame_rows.values() for row in rows)


def _named(given: Iterable[tuple[object, str]]) -> set[str]:
    """Return the names of the parts that are not empty."""
    return {name for what, names in given if what for name in names.split()}


def _if(condition: object, names: str) -> str:
    return names if condition else ""


def _used(module: Module) -> Iterator[str]:
    """Yield texts with one or several of the used names."""
    yield "ClassVar Encoder Final Interface Mapping MappingProxyType TYPE_CHECKING checked fact overload"
    yield _if(module.enums, "IntEnum")
    yield _if(module.alternatives, "Enum decided")
    yield _if(module.identities, "Data agrees held_bytes")
    yield from _of_variants(module.codes)
    for function in module.context.crc_functions.values():
        of_bytes = "crc_by_xor" if function.form is Form.XOR else "crc_of_bytes"
        yield "crc_of_bits" if function.carrier is Carrier.BITS else of_bytes
    for item in module.registers:
        yield _if(isinstance(item, Enumeration), "IntEnum Data LengthError as_bytes choice")
    for dispatcher in (item for section in module.sections for item in section.dispatchers):
        yield "Data LengthError TypeAlias as_bytes wrong_encoder"
        yield _if(len(dispatcher.members) > 1, "Union")
        yield _if(dispatcher.asked, "cast")
        yield _if(dispatcher.fallback is None, "RangeError")
    for coder in module.coders:
        yield from (*_of_coder(coder), *_of_operations(coder), *_of_joins(coder))
    for steps in module.procedures:
        yield "Step check_encoder"
        refusals = [item for given in steps.arguments for item in given.refusals]
        yield from ("check_width" if isinstance(item, TooWide) else _of(item) for item in refusals)
        yield from (_of_step(item, steps) for item in steps.steps)


def _of_variants(codes: Variants) -> Iterator[str]:
    carried = {kind.in_bytes for kind in codes.frame_kinds}
    yield _if(codes.sent, "Any FrameError TypeAlias")
    yield _if(len(codes.sent) > 1, "Union")
    yield _if(True in carried, "Data Rows")
    yield _if(False in carried, "Word Words")
    yield _if(any(kind.dispatch for kind in codes.frame_kinds), "check_kind")
    yield _if(any(kind.dispatch or kind.fast for kind in codes.frame_kinds), "Callable")
    fast = [item for kind in codes.frame_kinds for item in kind.fast]
    yield _if(any(item.tables for item in fast), "crc_tables")
    yield _if(any(item.plan.in_bytes for item in fast), "cast")
    yield _if(codes.counts_per_turn.cases or codes.step_um.cases, "index")
    yield _if(codes.counts_per_turn.cases, "tau")
    yield _if(codes.modulus.cases, "unwrap")
    yield _if(codes.held, "TypeVar held_parameters held_text")
    yield _if(any(kind.asked and not kind.dispatch for kind in codes.frame_kinds), "cast")


def _of_coder(coder: Coder) -> Iterator[str]:
    plan, reports = coder.plan, coder.reports
    yield _if(reports is not None, "Report")
    yield _if(reports is not None and reports.otherwise, "Verdict")
    yield _if(plan.reserved or plan.keeps_others, "check_bits")
    yield "BitField NamedTuple by_class"
    yield "Data LengthError as_bytes" if plan.in_bytes else "Word as_word too_long"
    if coder.register is None:
        yield "Rows Any Mapping" if plan.in_bytes else "Words Any Mapping"
    yield _if(coder.takes_variant or coder.attributes, "made")
    yield _if(coder.takes_variant, "check_encoder wrong_encoder")
    yield _if(plan.gray, "from_gray to_gray")
    yield _if(plan.crc, "CrcError")
    yield _if(coder.limited, "check_limits")


def _of_operations(coder: Coder) -> Iterator[str]:
    for op in (*coder.plan.checks, *coder.make.refusals):
        if isinstance(op, (IsOneOf, NotOneOf)) and coder.selects(op.field):
            yield "RangeError whole_number" if isinstance(op, NotOneOf) else "RangeError"
        else:
            yield _of(op)
    for part in coder.plan.parts:
        yield _to_decode(meaning_of(part.field), coder.selects(part.field))
    for term in coder.plan.terms:
        for of in term.value.of if isinstance(term.value, ParityOf) else (term.field,):
            yield _to_encode(meaning_of(of))


def _to_decode(meaning: Meaning, selects: bool) -> str:
    """Return the names that convert bits to a value. ``selects`` is true for the value that selects the frame."""
    match meaning:
        case TwosComplement():
            return "signed"
        case Named():
            return _if(not selects, "choice")
        case Raw() | ZeroMeans() | Active() | DigitRuns() | Characters():
            return ""
        case _:
            assert_never(meaning)


def _to_encode(meaning: Meaning) -> str:
    """Return the names that convert a checked value to bits."""
    match meaning:
        case DigitRuns():
            return "index"
        case Characters():
            return "text_number"
        case Raw() | TwosComplement() | ZeroMeans() | Active() | Named():
            return ""
        case _:
            assert_never(meaning)


def _to_join(meaning: Meaning) -> str:
    """Return the names for a value that is part of a joined number."""
    match meaning:
        case Raw() | TwosComplement() | ZeroMeans() | DigitRuns():
            return "index"
        case Named():
            return "choice index"
        case Characters():
            return "text_number"
        case Active():
            return ""
        case _:
            assert_never(meaning)


def _of_joins(coder: Coder) -> Iterator[str]:
    yield _if(coder.plan.wholes, "check_width")
    for field in (field for whole in coder.plan.wholes for field in whole.fields):
        yield _to_join(meaning_of(field))


def _of(op: Check | Refusal | Beyond | Undecodable) -> str:
    match op:
        case AlwaysIs() | ZerosAbove() | ParityIs():
            return "ConstantError"
        case AtMost():
            return "RangeError"
        case IsOneOf() | NotOneOf():
            return "choice"
        case TooWide(field):
            return "choice" if is_named(meaning_of(field)) else "check_width"
        case NotSigned():
            return "check_signed"
        case NotZeroFor():
            return "zero_for"
        case NoPowerOfTwo():
            return "check_power_of_two"
        case DigitTooHigh() | OutsideLimits() | Beyond():
            return "check_limits"
        case Undecodable():
            return "whole"
        case DigitsDisagree() | WholeDisagrees():
            return ""
        case _:
            assert_never(op)


def _of_step(op: Operation, steps: Steps) -> str:
    match op:
        case Writes(field=None):
            encoded = "" if isinstance(op.value, Stated) or op.register.name in steps.coders else "choice"
            return "writes whole" if isinstance(op.value, AsNumber) else f"writes {encoded}"
        case Writes():
            return "Modify"
        case Polls():
            return "Poll"
        case Verifies():
            return "Verify"
        case Reads():
            return "Read"
        case Waits():
            return "Wait"
        case Sends():
            return "Send"
        case _:
            assert_never(op)
