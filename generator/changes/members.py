"""Table of the rule for a change of each member of the model.

A member that is not in the table falls under the rule ``unforeseen``, and a test fails.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Plain:
    """A member that is compared for equality. ``label`` is its name in reports, ``form`` its notation.

    ``refers_to`` is the kind of thing that it names, so that a renaming is taken into account.
    """

    rule: str
    label: str
    form: str = ""
    refers_to: str = ""


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit that becomes narrower if it is lowered (``upper``) or raised. Without a limit, everything is allowed."""

    narrower: str
    wider: str
    label: str
    upper: bool
    form: str = ""


@dataclass(frozen=True, slots=True)
class ByValue:
    """An expression, compared by its value for each order code."""

    rule: str
    label: str


@dataclass(frozen=True, slots=True)
class Skip:
    """A member that is compared elsewhere or follows from others."""


Treatment = Plain | Limit | ByValue | Skip
_SKIP = Skip()
_WORDS = Plain("words", "")
_SOURCE = Plain("source", "")


def _with_words(*names: str, **others: Treatment) -> dict[str, Treatment]:
    """Return the members of a kind: its name, words and source, and the others."""
    words = dict.fromkeys(("printed_name", "names", "meaning", "note", "title", *names), _WORDS)
    return {"name": _SKIP, "source": _SOURCE, **words, **others}


def _plain(rule: str, **labels: str) -> dict[str, Treatment]:
    """Return members under one rule, each with its label."""
    return {name: Plain(rule, label) for name, label in labels.items()}


_NARROWER, _WIDER = "limit-narrower", "limit-wider"
_LONGER, _SHORTER = "wait-longer", "wait-shorter"

_SURROUNDINGS: dict[str, dict[str, Treatment]] = {
    "Parameter": _with_words(
        "hexadecimal",
        unit=Plain("field-unit", "unit"),
        equals=ByValue("parameter-rule", "rule"),
        largest=_SKIP,
        read_from=Plain("parameter-range", "register", refers_to="dotted"),
        min=Limit("parameter-range", "parameter-range", "minimum", False),
        max=Limit("parameter-range", "parameter-range", "maximum", True),
        interface=Plain("parameter-range", "interface"),
        alternative=Plain("parameter-range", "decision", refers_to="decision"),
    ),
    "Alternative": _with_words(answers=_SKIP),
    "Answer": _with_words(sets=Plain("answer-sets", "sets", refers_to="parameters")),
    "CodePart": _with_words(
        open=Plain("label", "unlisted values"), open_only_with=Plain("label", "where"), values=_SKIP
    ),
    "CodeValue": _with_words(text=_SKIP, interface=_SKIP, sets=_SKIP, only_with=_SKIP, supply=_SKIP),
    "Spelling": _with_words(
        where=_SKIP, pattern=Plain("label", "pattern"), values=Plain("label", "values"), then=Plain("label", "tail")
    ),
    "OrderCode": _with_words("special", pattern=Plain("label", "pattern"), parts=_SKIP, also_written=_SKIP),
    "Measurement": _with_words(
        of=Plain("measurement", "counted", refers_to="any-field"),
        counts_per_turn=ByValue("measurement", "counts per turn"),
        turns=ByValue("measurement", "turns"),
        step_um=ByValue("measurement", "step in µm"),
        modulus=ByValue("measurement", "modulus"),
        highest=ByValue("measurement", "highest number"),
    ),
    "Supply": _with_words(
        min_mv=Limit("supply-narrower", "supply-wider", "lowest", False, "mv"),
        max_mv=Limit("supply-narrower", "supply-wider", "highest", True, "mv"),
    ),
    "Manufacturer": {
        "name": Plain("maker", "name"),
        "title": _WORDS,
        "biss_id": Plain("maker-id", "BiSS ID", "hex"),
        "python_package": Plain("maker", "Python package"),
        "version": _SKIP,
        "trademarks": _WORDS,
    },
    "Connector": _with_words(
        "mating", kind=Plain("contact", "kind"), interfaces=Plain("contact", "interfaces"), contacts=_SKIP
    ),
    "Contact": {"contact": _SKIP, **_plain("contact", signal="signal", only="order codes")},
    "Input": _with_words(
        "low",
        "high",
        when_unused=Plain("input-rule", "when unused"),
        pulse_at_least_us=Limit("input-rule", "input-rule", "pulse of at least", False, "us"),
        inverts=Plain("input-rule", "inverts", refers_to="dotted"),
        needs=Plain("input-rule", "needs", refers_to="dotted"),
    ),
    "Alarm": _with_words(
        "detected",
        "remedy",
        group=_SKIP,
        register=Plain("alarm-bit", "register", refers_to="register"),
        field=Plain("alarm-bit", "bit", refers_to="any-field"),
        below_mv=Plain("alarm-rule", "threshold", "mv"),
        latch=Plain("alarm-rule", "kept until reset"),
        implemented=Plain("alarm-rule", "implemented"),
        cleared_by=Plain("alarm-rule", "cleared by", refers_to="procedures"),
        only=Plain("alarm-rule", "order codes"),
        by_hand=Plain("alarm-rule", "manual steps"),
    ),
    "Timing": _with_words(
        only=Plain("timing-typical", "order codes"),
        symbol=Plain("timing-typical", "symbol"),
        at_least_us=Limit(_LONGER, _SHORTER, "at least", False, "us"),
        typical_us=Plain("timing-typical", "typically", "us"),
        at_most_us=Limit(_LONGER, _SHORTER, "at most", False, "us"),
    ),
}

_TALK: dict[str, dict[str, Treatment]] = {
    "Register": _with_words(
        interface=Plain("register-interface", "interface"),
        address=Plain("register-moved", "address", "hex"),
        bank=Plain("register-moved", "bank"),
        length=Plain("register-length", "length", "bytes"),
        access=_SKIP,
        byte_order=Plain("register-order", "byte order", "word"),
        default=Plain("register-default", "default", "hex"),
        min=Limit(_NARROWER, _WIDER, "minimum", False),
        max=Limit(_NARROWER, _WIDER, "maximum", True),
        limits_of=Plain("register-rule", "limits are those of", refers_to="limits"),
        opened_by=Plain("register-rule", "opened by", refers_to="register"),
        opened_by_value=Plain("register-rule", "opened by the value", refers_to="any-value"),
        opened_by_field=Plain("register-rule", "opened by the field", refers_to="any-field"),
        clears_itself=Plain("register-rule", "clears itself"),
        wait_at_least_ms=Limit(_LONGER, _SHORTER, "wait after a write", False, "ms"),
        volatile=Plain("register-rule", "lost at power-off unless saved"),
        layout=_SKIP,
        above_max=Plain("register-rule", "above the maximum"),
        write_clears=Plain("register-rule", "a write clears", refers_to="registers"),
        meanings=_SKIP,
        reserved=Plain("register-rule", "reserved"),
    ),
    "RegisterMeaning": _with_words(
        when=Plain("register-rule", "while", refers_to="dotted"),
        value=Plain("register-rule", "is", refers_to="any-value"),
        min=Limit(_NARROWER, _WIDER, "minimum", False),
        max=Limit(_NARROWER, _WIDER, "maximum", True),
    ),
    "Layout": _with_words(
        sender=Plain("frame-order", "sent by"),
        in_bytes=Plain("frame-order", "carried in bytes"),
        byte_order=Plain("frame-order", "byte order", "word"),
        bits=ByValue("frame-length", "bits"),
        widest=_SKIP,
        fields=_SKIP,
        joins=_SKIP,
        selector=Plain("frame-told-by", "identified by", refers_to="field"),
        selects=Plain("frame-told-by", "identified by the values"),
        gaps=Plain("other-bits", "other bits"),
        gray_of=Plain("frame-order", "in Gray code", refers_to="field"),
        gray_when=Plain("frame-order", "in Gray code while", refers_to="parameter"),
        channel=Plain("frame-order", "channel"),
    ),
    "Field": _with_words(
        "explained_by",
        kind=_SKIP,
        low=ByValue("field-moved", "lowest bit"),
        width=ByValue("field-width", "bits"),
        widest=_SKIP,
        group=_SKIP,
        container=Plain("field-width", "bits with padding"),
        pieces=_SKIP,
        equals=_SKIP,
        implemented=Plain("field-verdict", "implemented"),
        reserved=Plain("register-rule", "reserved"),
        unit=Plain("field-unit", "unit"),
        default=Plain("field-default", "default", "hex"),
        remedy=_WORDS,
        by_hand=_WORDS,
    ),
    "Join": {"name": _SKIP, "fields": Plain("joined-of", "made of", refers_to="fields")},
    "Value": _with_words(value=Plain("value-changed", "number", "hex")),
    "Crc": _with_words(
        width=Plain("crc-changed", "bits"),
        poly=Plain("crc-changed", "polynomial", "hex"),
        init=Plain("crc-changed", "start value", "hex"),
        refin=Plain("crc-changed", "input reflected"),
        refout=Plain("crc-changed", "output reflected"),
        xorout=Plain("crc-changed", "inverted with", "hex"),
    ),
    "FieldGroup": _with_words(bits=_SKIP),
    "Procedure": _with_words(
        "precondition", "result", interface=Plain("procedure-interface", "interface"), arguments=_SKIP, steps=_SKIP
    ),
}

_COMMON = _with_words(layouts=_SKIP, timings=_SKIP, measurement=_SKIP, clock=_SKIP)
_SIGNALS: dict[str, Treatment] = {"signals": Plain("interface-rule", "signals")}
_INTERFACES: dict[str, dict[str, Treatment]] = {
    "Ssi": _COMMON
    | _SIGNALS
    | {
        "alignment": Plain("alignment", "alignment", "word"),
        "output_code": Plain("alignment", "code", "word"),
        "cable_lengths": Plain("interface-rule", "clock by cable"),
    },
    "Biss": _COMMON
    | _SIGNALS
    | {
        "profile": Plain("interface-rule", "profile"),
        "description_file": Plain("interface-rule", "description file"),
        "bank_select": Plain("bank-select", "bank selected by", refers_to="register"),
        "network": Plain("interface-rule", "network"),
        "timeout": Plain("interface-rule", "time-out"),
        "control_data": _SKIP,
        "control_data_note": _WORDS,
    },
    "Rs485": _COMMON | {"port": _SKIP, "data_ids": _SKIP, "memory_access": Plain("interface-rule", "memory access")},
    "Clock": {
        "min_hz": Limit("clock-narrower", "clock-wider", "lowest clock", False, "hz"),
        "max_hz": Limit("clock-narrower", "clock-wider", "highest clock", True, "hz"),
        "source": _SOURCE,
    },
    "Port": {
        **_plain("port", baud="baud", data_bits="data bits", parity="parity", stop_bits="stop bits"),
        "flow_control": Plain("port", "flow control"),
        "source": _SOURCE,
    },
    "DataId": _with_words(
        id=Plain("data-id-changed", "number", "hex"),
        control=Plain("data-id-changed", "control byte", "hex"),
        purpose=Plain("data-id-changed", "purpose"),
    ),
    "ControlField": _with_words(
        bits=Plain("field-width", "bits"), values=_SKIP, crc=Plain("field-reads-otherwise", "CRC", refers_to="crc")
    ),
}
#: Comparison of each member of each kind of part.
MEMBERS: Mapping[str, Mapping[str, Treatment]] = MappingProxyType(_SURROUNDINGS | _TALK | _INTERFACES)
