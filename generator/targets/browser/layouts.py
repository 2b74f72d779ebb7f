"""Frame or register for the script: the operations of its plan, applied to the bits of one number, and its texts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...model import Alarm, Device, Field, Layout, Register, RegisterMeaning, cite
from ...model.expressions import Expression
from ...model.never import assert_never
from ...order_codes.editions import edition_before, tests_of
from ...order_codes.parameters import needed_parameters
from ...plan.codec import (
    AlwaysIs,
    AtMost,
    Codec,
    Fixed,
    IsOneOf,
    ParityIs,
    ParityOf,
    Turned,
    ZerosAbove,
    codec_of,
)
from ...plan.columns import Condition, Place, conditions
from ...plan.limits import Limits, limits_of
from ...plan.refusals import powers_of_two
from ...plan.reports import Judgement, Only, Reporting, Speaks, explained
from ...plan.values import Active, Characters, DigitRuns, Meaning, Named, Raw, TwosComplement, ZeroMeans, meaning_of
from ...say.fault import of_older_edition
from ...say.name import title
from ...say.place import register_at
from ...say.register import facts
from ...say.report import alarm_of, meaning, remedy, source, states
from ...say.text import BY_NAME, told
from .plain import Data, bound, expression, kept, number


def frame(device: Device, layout: Layout, reporting: Reporting | None) -> Data:
    """Return a frame with its verdict and reports."""
    judgement = reporting.judgement if reporting is not None else None
    reports = list(reporting.told if reporting is not None else ())
    # Use the order of the frame, without flags first.
    made = [(field, told) for field in layout.fields for told in reports if told.by.field.name == field.name]
    return _layout(device, layout) | kept(
        title=title(layout),
        source=cite(layout.source),
        sender=layout.sender,
        channel=layout.channel,
        selector=layout.selector,
        selects=[number(value) for value in layout.selects],
        speaks=[*_speaks(judgement)] if judgement is not None else (),
        otherwise=judgement.otherwise.value if judgement is not None else "",
        tells=[_told(told.made_of, field.name, alarm_of(device, told.made_of), told.only) for field, told in made],
    )


def register(device: Device, item: Register) -> Data:
    """Return a register with its alarms and the rules for writing it."""
    meanings: tuple[RegisterMeaning | None, ...] = item.meanings or (None,)
    alarms = [(field, alarm_of(device, field, item.name)) for field in item.layout.fields]
    default = item.default_bytes()
    about = (*told(item.meaning), *facts(device, item), *told(item.note))
    return _layout(device, item.layout) | kept(
        title=title(item),
        source=cite(item.source),
        place=register_at(item),
        length=item.length,
        # The script gives the limits in numbers of the order code.
        about=[BY_NAME.sentence(one) for one in about if one.label != "Limits"],
        writable=item.writable,
        default=default.hex(" ").upper() if default is not None else "",
        limits=[_limits(one, limits_of(device, item, one)) for one in meanings],
        tells=[_told(field, field.name, alarm, explained(field)) for field, alarm in alarms if alarm is not None],
        strange=[*_strange(device, item)],
    )


def _layout(device: Device, layout: Layout) -> Data:
    codec = codec_of(device, layout)
    gray = codec.gray
    return kept(
        name=layout.name,
        bits=expression(layout.bits),
        bytes={"low_byte_first": 1, "high_byte_first": 2}[layout.byte_order] if layout.in_bytes else 0,
        fields=[*_fields(codec)],
        joins=[[item.join.name, [[one.name, expression(low)] for one, low in item.from_low]] for item in codec.wholes],
        checks=[_check(layout, item) for item in conditions(codec)],
        crc=codec.crc.crc.name if codec.crc is not None else "",
        gray=[expression(gray.low), expression(gray.width), gray.when] if gray is not None else (),
        asks=[item.name for item in codec.alternatives],
        held=_held(device, layout, codec),
    )


def _held(device: Device, layout: Layout, codec: Codec) -> list[str]:
    """Return those parameters of the layout that registers hold."""
    places = (place for item in layout.fields for place in (item.low, item.width))
    names = {name for item in (layout.bits, *places) for name in item.parameters}
    names |= {codec.gray.when} if codec.gray is not None else set()
    needed = frozenset[str]().union(*(needed_parameters(device, name) for name in names))
    return [item.name for item in device.run_time_parameters if item.name in needed]


def _fields(codec: Codec) -> Iterator[Data]:
    sent, powers = {item.field.name: item.value for item in codec.terms}, powers_of_two(codec)
    for item in codec.layout.fields:
        (on, off), only = states(item), explained(item)
        # Use the order in which they are written.
        row = {
            "name": item.name,
            "printed": item.printed_name,
            "low": expression(item.low),
            "width": expression(item.width),
            "kind": "",
            "meaning": item.meaning,
            "on": on,
            "off": off,
            "only": only.parameter if only is not None else "",
            "values": [],
            "zero": 0,
            "power": item.name in powers,
            "runs": [],
            "unit": item.unit,
            "equals": _stated(item),
        }
        yield kept(**row | _meant(meaning_of(item))) | _sent(sent.get(item.name))


def _meant(meant: Meaning) -> Data:
    """Return the operation with which the script converts the bits of a field."""
    match meant:
        case Raw():
            return {}
        case TwosComplement():
            return {"kind": "signed"}
        case ZeroMeans(stands_for):
            return {"zero": number(stands_for)}
        case Active(low):
            return {"kind": "not_flag" if low else "flag"}
        case Named(values):
            return {"kind": "choice", "values": [_cut(number(one.value), one.name, one.meaning) for one in values]}
        case DigitRuns(runs):
            cut = [_cut(run.name, number(run.divisor), number(run.modulus), run.meaning) for run in runs]
            return {"kind": "digits", "runs": cut}
        case Characters():
            return {"kind": "text"}
        case _:
            assert_never(meant)


def _cut(*row: Any) -> list[Any]:
    """Return a row without the empty values at its end."""
    return list(row if row[-1] else row[:-1])


def _stated(item: Field) -> Any:
    """Return the documented value of a field, either as a text or as a list that holds a number or an expression."""
    value = item.equals
    if value is None or isinstance(value, str):
        return value
    return [expression(value if isinstance(value, Expression) else Expression(value))]


def _sent(value: object) -> Data:
    """Return the data for encoding a field that users do not provide. For a CRC, there is none."""
    match value:
        case Fixed(fixed):
            return {"fixed": number(fixed)}
        case ParityOf(of, odd):
            return {"parity": [field.name for field in of], "odd": int(odd)}
        case Turned(documented, place):
            return {"unused": number(documented), "place": place}
        case None:
            return {"crc": 1}
    return {}


def _place(item: Place) -> list[Any]:
    return [expression(item.low), expression(item.width)]


def _check(layout: Layout, item: Condition) -> Data:
    """Return a check. ``says`` selects the message that is shown if it fails."""
    name, says, most, always = item.check.field.name, "", 0, False
    match item.check:
        case AlwaysIs():
            says, always = "constant", True
        case ZerosAbove(padding=padding):
            name, says, always = padding.name, "constant", True
        case ParityIs():
            says, always = "parity", True
        case IsOneOf(field=field):
            always = field.name == layout.selector
            says = "of_other_frame" if always else "no_value"
        case AtMost(runs=runs):
            says, most = "digits", sum(run.digits for run in runs)
    return kept(
        at=_place(item.place),
        fault=item.check.fault.value,
        field=name,
        says=says,
        always=int(always),
        values=[number(value) for value in item.values],
        limit=number(item.limit) if item.limit is not None else None,
        most=most,
        of=[_place(of) for of in item.parity_of],
        of_name=", ".join(of.name for of in item.check.of) if isinstance(item.check, ParityIs) else "",
        odd=int(item.odd),
    )


def _speaks(judgement: Judgement) -> Iterator[list[Any]]:
    """Yield the fields that decide the verdict, worst verdict first.

    Each item has the verdict, the field, the flags that override it, and a parameter with True if it must not be 0.
    """
    for verdict, items in judgement.worst_first:
        yield from ([verdict.value, *_speaking(item)] for item in items)


def _speaking(item: Speaks) -> list[Any]:
    row = [item.by.field.name, [part.field.name for part in item.unless]]
    return [*row, item.only.parameter, int(item.only.holds)] if item.only is not None else _cut(*row)


def _told(field: Field, name: str, alarm: Alarm | None, only: Only | None = None) -> Data:
    """Return the report of the field ``name``, shown while it is active or differs from the manual.

    It applies only to order codes for which the parameter in ``only`` is not 0, or only to the others.
    """
    return kept(
        field=name,
        meaning=meaning(field, alarm),
        remedy=remedy(field, alarm),
        only=only.parameter if only is not None and only.holds else "",
        others=only.parameter if only is not None and not only.holds else "",
        source=cite(source(field, alarm)),
    )


def _limits(meant: RegisterMeaning | None, limits: Limits) -> Data:
    name, text = (meant.name, meant.meaning) if meant is not None else ("", "")
    return kept(name=name, meaning=text, of=limits.member) | {"low": bound(limits.low), "high": bound(limits.high)}


def _strange(device: Device, item: Register) -> Iterator[list[Any]]:
    """Yield digits whose values show that an older edition applies: the digits, their bounds, and the message."""
    for revision, test in tests_of(device, item.name):
        before = edition_before(device, revision)
        words = of_older_edition(test.run, "{0}", f"{test.min} to {test.max}", revision, item.name, before)
        yield [test.run, test.min, test.max, words]
