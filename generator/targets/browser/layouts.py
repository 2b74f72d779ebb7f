"""Frame or register for the script: its description, and the texts about it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...model import Alarm, Device, Field, Layout, Register, RegisterMeaning, cite
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
    Turned,
    ZerosAbove,
    codec_of,
)
from ...plan.description import Description, Name, Tells, describe
from ...plan.limits import Limits, limits_of
from ...plan.reports import Reporting, explained
from ...say.fault import of_older_edition
from ...say.name import title
from ...say.place import register_at
from ...say.register import facts
from ...say.report import alarm_of, meaning, remedy, source, states
from ...say.text import BY_NAME, told
from .plain import Data, bound, described, expression, kept, number


def frame(device: Device, layout: Layout, reporting: Reporting | None) -> Data:
    """Return a frame with its verdict and reports."""
    codec = codec_of(device, layout)
    of = describe(codec, reporting)
    told = zip(of.tells, reporting.told if reporting is not None else (), strict=True)
    tells = [described(item) | _words(each.made_of, alarm_of(device, each.made_of)) for item, each in told]
    # Use the order of the frame, without flags first. Values with a verdict come last.
    names = [*(item.name for item in layout.fields), *(sign.flag.name for sign in layout.signs)]
    return _layout(device, codec, of) | kept(
        title=title(layout),
        source=cite(layout.source),
        sender=layout.sender,
        channel=layout.channel,
        selector=layout.selector,
        selects=[number(value) for value in layout.selects],
        tells=sorted(tells, key=lambda item: names.index(item["flag"])),
    )


def register(device: Device, item: Register) -> Data:
    """Return a register with its alarms and the rules for writing it."""
    meanings: tuple[RegisterMeaning | None, ...] = item.meanings or (None,)
    alarms = [(field, alarm_of(device, field, item.name)) for field in item.layout.fields]
    default = item.default_bytes()
    about = (*told(item.meaning), *facts(device, item), *told(item.note))
    codec = codec_of(device, item.layout)
    return _layout(device, codec, describe(codec)) | kept(
        title=title(item),
        source=cite(item.source),
        place=register_at(item),
        length=item.length,
        # The script gives the limits in numbers of the order code.
        about=[BY_NAME.sentence(one) for one in about if one.label != "Limits"],
        writable=item.writable,
        default=default.hex(" ").upper() if default is not None else "",
        limits=[_limits(one, limits_of(device, item, one)) for one in meanings],
        tells=[
            described(Tells("", Name(field.name), 0, explained(field))) | _words(field, alarm)
            for field, alarm in alarms
            if alarm is not None
        ],
        strange=[*_strange(device, item)],
    )


def _layout(device: Device, codec: Codec, of: Description) -> Data:
    """Return the description of a frame or register with the texts about its parts."""
    parts = ("bits", "order", "joins", "speaks", "gray", "otherwise")
    return kept(
        name=codec.layout.name,
        **{name: described(getattr(of, name)) for name in parts},
        fields=[*_fields(codec, of)],
        checks=[described(item) | _message(codec.layout, op) for item, op in zip(of.checks, codec.checks, strict=True)],
        # A byte that the bits sent do not fill begins with these zeros.
        fill=(codec.layout.bits - codec.layout.sent_bits).constant,
        crc=of.crc.crc.name if of.crc is not None else "",
        crc_of=[of.crc.low, of.crc.covered.constant] if of.crc is not None and of.crc.is_part else [],
        asks=[item.name for item in codec.alternatives],
        offers=[item.name for item in device.verdict_alternatives(codec.layout)],
        held=_held(device, codec.layout, codec),
    )


def _held(device: Device, layout: Layout, codec: Codec) -> list[str]:
    """Return those parameters of the layout that registers hold."""
    places = (place for item in layout.fields for place in (item.low, item.width))
    names = {name for item in (layout.bits, *places) for name in item.parameters}
    names |= {codec.gray.when} if codec.gray is not None and codec.gray.when else set()
    needed = device.needed_parameters(names)
    return [item.name for item in device.run_time_parameters if item.name in needed]


def _fields(codec: Codec, of: Description) -> Iterator[Data]:
    sent = {item.field.name: item.value for item in codec.terms}
    for column, item in zip(of.columns, codec.layout.fields, strict=True):
        (on, off), only = states(item), explained(item)
        texts = kept(
            printed=item.printed_name,
            meaning=item.meaning,
            on=on,
            off=off,
            only=only.parameter if only is not None else "",
            values=[_cut(number(one.value), one.name, one.meaning) for one in item.values],
            runs=[_cut(run.name, number(run.divisor), number(run.modulus), run.meaning) for run in item.runs],
            unit=item.unit,
            equals=_stated(item),
        )
        yield described(column) | texts | _sent(sent.get(item.name))


def _cut(*row: Any) -> list[Any]:
    """Return a row without the empty values at its end."""
    return list(row if row[-1] else row[:-1])


def _stated(item: Field) -> Any:
    """Return the documented value of a field, either as a string or as a list that holds a number or an expression."""
    value = item.equals
    if value is None or isinstance(value, str):
        return value
    return [expression(value if isinstance(value, Expression) else Expression(value))]


def _sent(value: object) -> Data:
    """Return the data for encoding a field that users do not provide. For a CRC, there is none."""
    match value:
        case Fixed(fixed):
            return {"fixed": number(fixed)}
        case ParityOf(of, odd, mask):
            return {"parity": [field.name for field in of], "odd": int(odd)} | kept(mask=number(mask))
        case Turned(documented, place):
            return {"unused": number(documented), "place": place}
        case None:
            return {"crc": 1}
    return {}


def _message(layout: Layout, item: Check) -> Data:
    """Return the message of a check that fails: ``says`` selects it. The other members fill it in."""
    name, says, most, always = item.field.name, "", 0, False
    match item:
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
            says, most = "digits", item.digits
        case NotAbove():
            says = "too_high"
        case IsBetween():
            says = "outside"
        case _:
            assert_never(item)
    of_name = ", ".join(of.name for of in item.of) if isinstance(item, ParityIs) else ""
    return kept(field=name, says=says, always=int(always), most=most, of_name=of_name)


def _words(field: Field, alarm: Alarm | None) -> Data:
    """Return the text of a report, shown while the field is active or differs from the manual."""
    return kept(meaning=meaning(field, alarm), remedy=remedy(field, alarm), source=cite(source(field, alarm)))


def _limits(meant: RegisterMeaning | None, limits: Limits) -> Data:
    name, text = (meant.name, meant.meaning) if meant is not None else ("", "")
    return kept(name=name, meaning=text, of=limits.member) | {"low": bound(limits.low), "high": bound(limits.high)}


def _strange(device: Device, item: Register) -> Iterator[list[Any]]:
    """Yield digits whose values show that an older edition applies: the digits, their bounds, and the message."""
    for revision, test in tests_of(device, item.name):
        before = edition_before(device, revision)
        words = of_older_edition(test.run, "{0}", f"{test.min} to {test.max}", revision, item.name, before)
        yield [test.run, test.min, test.max, words]
