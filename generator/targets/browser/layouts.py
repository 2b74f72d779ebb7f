"""Frame or register for the script: its description, and the texts about it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...model import Alarm, Device, Digits, Field, Layout, Register, RegisterMeaning, cite
from ...model.expressions import Expression
from ...model.never import assert_never
from ...order_codes.editions import edition_before, tests_of
from ...plan.codec import (
    AlwaysIs,
    AtMost,
    Check,
    Codec,
    Fixed,
    IsBetween,
    IsOneOf,
    NotAbove,
    ParityIs,
    ParityOf,
    ReservedBits,
    ZerosAbove,
    codec_of,
)
from ...plan.description import Description, Name, Tells, describe
from ...plan.limits import Limits, limits_of
from ...plan.reports import ReportCause, Reporting, explained
from ...say.fault import of_older_edition
from ...say.name import title
from ...say.place import register_at
from ...say.register import facts
from ...say.report import alarm_of, meaning, remedy, source, states
from ...say.text import BY_NAME, spec_text
from .plain import Data, bound, described, expression, number, without_empty


def frame(device: Device, layout: Layout, reporting: Reporting | None) -> Data:
    """Return a frame with its verdict and reports."""
    codec = codec_of(device, layout)
    description = describe(codec, reporting)
    reported = reporting.causes if reporting is not None else ()
    tells = [_report(device, *pair) for pair in zip(description.tells, reported, strict=True)]
    # Use the order of the frame, without flags first. Values with a verdict come last.
    names = [*(field.name for field in layout.fields), *(sign.flag.name for sign in layout.signs)]
    return _layout(device, codec, description) | without_empty(
        title=title(layout),
        source=cite(layout.source),
        sender=layout.sender,
        channel=layout.channel,
        selector=layout.selector,
        selects=[number(value) for value in layout.selects],
        tells=sorted(tells, key=lambda report: names.index(report["flag"])),
    )


def register(device: Device, register: Register) -> Data:
    """Return a register with its alarms and the rules for writing it."""
    meanings: tuple[RegisterMeaning | None, ...] = register.meanings or (None,)
    field_alarms = ((field, alarm_of(device, field, register.name)) for field in register.layout.fields)
    default = register.default_bytes()
    about = (*spec_text(register.meaning), *facts(device, register), *spec_text(register.note))
    codec = codec_of(device, register.layout)
    return _layout(device, codec, describe(codec)) | without_empty(
        title=title(register),
        source=cite(register.source),
        place=register_at(register),
        length=register.length,
        # The script gives the limits in numbers of the order code.
        about=[BY_NAME.sentence(fact) for fact in about if fact.label != "Limits"],
        writable=register.writable,
        default=default.hex(" ").upper() if default is not None else "",
        limits=[_limits(case, limits_of(device, register, case)) for case in meanings],
        tells=[_alarm_report(field, alarm) for field, alarm in field_alarms if alarm is not None],
        strange=[*_edition_tests(device, register)],
    )


def _report(device: Device, tells: Tells, reported: ReportCause) -> Data:
    """Return a report of a frame with its texts."""
    data: Data = described(tells)
    return data | _words(reported.made_of, alarm_of(device, reported.made_of))


def _alarm_report(field: Field, alarm: Alarm) -> Data:
    """Return the report of an alarm in a register with its texts."""
    data: Data = described(Tells("", Name(field.name), 0, explained(field)))
    return data | _words(field, alarm)


def _layout(device: Device, codec: Codec, description: Description) -> Data:
    """Return the description of a frame or register with the texts about its parts."""
    parts = ("bits", "order", "joins", "speaks", "gray", "otherwise")
    checks = zip(description.checks, codec.checks, strict=True)
    crc = description.crc
    return without_empty(
        name=codec.layout.name,
        **{name: described(getattr(description, name)) for name in parts},
        fields=[*_fields(codec, description)],
        checks=[described(check) | _message_of_check(codec.layout, op) for check, op in checks],
        # A byte that the bits sent do not fill begins with these zeros.
        fill=(codec.layout.bits - codec.layout.sent_bits).constant,
        crc=crc.crc.name if crc is not None else "",
        crc_of=[crc.low, crc.covered.constant] if crc is not None and crc.is_part else [],
        asks=[alternative.name for alternative in codec.alternatives],
        offers=[alternative.name for alternative in device.verdict_alternatives(codec.layout)],
        held=_parameters_in_registers(device, codec.layout, codec),
    )


def _parameters_in_registers(device: Device, layout: Layout, codec: Codec) -> list[str]:
    """Return those parameters of the layout that registers hold."""
    places = (place for field in layout.fields for place in (field.low, field.width))
    names = {name for expression in (layout.bits, *places) for name in expression.parameters}
    names |= {codec.gray.when} if codec.gray is not None and codec.gray.when else set()
    needed = device.needed_parameters(names)
    return [parameter.name for parameter in device.run_time_parameters if parameter.name in needed]


def _fields(codec: Codec, description: Description) -> Iterator[Data]:
    terms = {term.field.name: term.value for term in codec.terms}
    for column, field in zip(description.columns, codec.layout.fields, strict=True):
        (on, off), only = states(field), explained(field)
        texts = without_empty(
            printed=field.printed_name,
            meaning=field.meaning,
            on=on,
            off=off,
            only=only.parameter if only is not None else "",
            values=[_without_empty_end(number(value.value), value.name, value.meaning) for value in field.values],
            runs=[_run(run) for run in field.runs],
            unit=field.unit,
            equals=_documented_value(field),
        )
        yield described(column) | texts | _sent(terms.get(field.name))


def _run(run: Digits) -> list[Any]:
    return _without_empty_end(run.name, number(run.divisor), number(run.modulus), run.meaning)


def _without_empty_end(*row: Any) -> list[Any]:
    """Return a row without the empty values at its end."""
    return list(row if row[-1] else row[:-1])


def _documented_value(field: Field) -> Any:
    """Return the documented value of a field, either as a string or as a list that holds a number or an expression."""
    value = field.equals
    if value is None or isinstance(value, str):
        return value
    return [expression(value if isinstance(value, Expression) else Expression(value))]


def _sent(value: object) -> Data:
    """Return the data for encoding a field that users do not provide. For a CRC, there is none."""
    match value:
        case Fixed(fixed):
            return {"fixed": number(fixed)}
        case ParityOf(covered_fields, odd, mask):
            return {"parity": [field.name for field in covered_fields], "odd": int(odd)} | without_empty(
                mask=number(mask)
            )
        case ReservedBits(documented, place):
            return {"unused": number(documented), "place": place}
        case None:
            return {"crc": 1}
    return {}


def _message_of_check(layout: Layout, check: Check) -> Data:
    """Return the message of a check that fails: ``says`` selects it. The other members fill it in."""
    name, says, highest_digit, always = check.field.name, "", 0, False
    match check:
        case AlwaysIs():
            says, always = "constant", True
        case ZerosAbove(padding=padding):
            name, says, always = padding.name, "constant", True
        case ParityIs():
            says, always = "parity", True
        case IsOneOf(field=field):
            always = field.name == layout.selector
            says = "of_other_frame" if always else "no_value"
        case AtMost():
            says, highest_digit = "digits", check.digits
        case NotAbove():
            says = "too_high"
        case IsBetween():
            says = "outside"
        case _:
            assert_never(check)
    covered = check.of if isinstance(check, ParityIs) else ()
    of_name = ", ".join(field.name for field in covered)
    return without_empty(field=name, says=says, always=int(always), most=highest_digit, of_name=of_name)


def _words(field: Field, alarm: Alarm | None) -> Data:
    """Return the text of a report, shown while the field is active or differs from the manual."""
    return without_empty(meaning=meaning(field, alarm), remedy=remedy(field, alarm), source=cite(source(field, alarm)))


def _limits(register_meaning: RegisterMeaning | None, limits: Limits) -> Data:
    name, text = (register_meaning.name, register_meaning.meaning) if register_meaning is not None else ("", "")
    return without_empty(name=name, meaning=text, of=limits.member) | {
        "low": bound(limits.low),
        "high": bound(limits.high),
    }


def _edition_tests(device: Device, register: Register) -> Iterator[list[Any]]:
    """Yield digits whose values show that an older edition applies: the digits, their bounds, and the message."""
    for revision, test in tests_of(device, register.name):
        before = edition_before(device, revision)
        message = of_older_edition(test.run, "{0}", f"{test.min} to {test.max}", revision, register.name, before)
        yield [test.run, test.min, test.max, message]
