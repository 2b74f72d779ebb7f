"""The rules of ``diff``: every kind of change by its name, with its impact on each output and the reason for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from .impact import Impact, Rule

_LETTERS = {
    "B": Impact.BREAKING,
    "W": Impact.BEHAVIOUR,
    "+": Impact.COMPATIBLE,
    "D": Impact.DOCUMENTATION,
    "-": Impact.NONE,
}

_GONE = "Its names are gone from C and Python, and its element from the XML: what uses them no longer builds."
_NEW = "Nothing that was there is changed by it."
_RENAMED = "Names in C, Python and XML follow the spec, so code has to follow the new name; what it does is the same."
_WIRE = "The same names stand for something else on the line, so code that builds does something else."
_LESS = "What was allowed is not allowed any more: values, clocks or pauses that worked are refused or too short."
_MORE = "What was allowed still is."

#: Things with names: their rules are THING-gone, THING-new and THING-renamed. What they are, then the impact on C,
#: Python, XML and pages of each of the three, then by what a renamed one is known.
_THINGS = (
    ("family", "a family of encoders", "BBBD", "+++D", "BBBD", "the same order codes"),
    ("order-code", "an order code", "BBBD", "+++D", "BBBD", "the same parts"),
    ("part", "a part of the order code", "-BBD", "-WWD", "-BBD", "the same values"),
    ("spelling", "another way in which labels are written", "BBBD", "+++D", "BBBD", "the same texts"),
    (
        "parameter",
        "a quantity that an order code sets",
        "BBBD",
        "+++D",
        "BBBD",
        "the same numbers for every order code",
    ),
    ("interface", "an interface", "BBBD", "+++D", "BBBD", ""),
    ("frame", "a frame", "BBBD", "+++D", "BBBD", "the same bits"),
    ("field", "a field of a frame or register", "BBBD", "WB+D", "BBBD", "the same bits"),
    ("value", "a named value", "BBBD", "+++D", "BBBD", "the same number"),
    ("joined", "a number made of several fields", "BBBD", "BB+D", "BBBD", "the same fields"),
    ("register", "a register", "BBBD", "+++D", "BBBD", "same address and bits"),
    ("meaning", "what a register means under a setting", "BBBD", "+++D", "BBBD", "the same setting"),
    ("crc", "a CRC", "BBBD", "+++D", "BBBD", "the same computation"),
    ("data-id", "a data ID", "BBBD", "+++D", "BBBD", "the same number"),
    ("timing", "a time", "BBBD", "+++D", "BBBD", "the same times"),
    ("alarm", "an error or warning", "BBBD", "+++D", "BBBD", "the same bit"),
    ("procedure", "a procedure", "BBBD", "+++D", "BBBD", "the same steps"),
    ("decision", "what the manual leaves open", "BBBD", "BBBD", "BBBD", "the same bits"),
    ("answer", "an answer to what the manual leaves open", "BBBD", "+++D", "BBBD", "the same bits"),
    ("control-field", "a field of the control frame", "BBBD", "+++D", "BBBD", "the same bits"),
    ("connector", "a connector or cable", "DBBD", "D++D", "DBBD", "the same contacts"),
    ("measurement", "what the position counts", "BBBD", "B++D", "BBBD", ""),
    ("input", "a hardware input", "DBBD", "D++D", "DBBD", "the same effect"),
)

#: What else changes: name, impact on C, Python, XML and pages, when, why.
_CHANGES = (
    ("interface-of-code", "BBBD", "an order code has another interface", "Its frames and registers are other ones."),
    ("parameter-of-code", "WWWD", "an order code has another resolution or other number", _WIRE),
    ("parameter-rule", "WWWD", "a quantity follows from others by another rule", _WIRE),
    ("parameter-range", "WWWD", "a quantity that a register holds has another range or another register", _WIRE),
    ("label", "WWWD", "labels are read by another rule", "Order codes are read from labels by it."),
    ("movement", "-WWD", "rotary has become linear or the reverse", "A position means something else."),
    ("measurement", "WWWD", "the position counts something else", "Angles and lengths come out otherwise."),
    ("maker", "BBBD", "the manufacturer's name or its Python package has changed", "Every name begins with it."),
    ("maker-id", "--BD", "the BiSS manufacturer ID has changed", "Masters find the description file by it."),
    ("supply-narrower", "D+WD", "the supply voltage has narrower limits", "A supply that was right may do harm."),
    ("supply-wider", "D++D", "the supply voltage has wider limits, or none", _MORE),
    ("frame-length", "WWWD", "a frame has another length", _WIRE),
    ("frame-order", "WWWD", "a frame is sent in another order or in another code", _WIRE),
    ("frame-told-by", "WWWD", "a frame is told from others by another value", _WIRE),
    ("frame-decision", "BBBD", "a frame comes to need a decision, or no longer needs it", "An argument comes or goes."),
    ("other-bits", "WWWD", "what bits outside the fields have to be has changed", _WIRE),
    ("field-moved", "WWWD", "a field stands at other bits", _WIRE),
    ("field-width", "WWWD", "a field has another width", _WIRE),
    ("field-kind", "BBBD", "a field has become something else to its user", "Its type changes, or it comes and goes."),
    ("field-reads-otherwise", "WWWD", "the bits of a field become a value in another way", _WIRE),
    ("field-constant", "WWWD", "fixed or unused bits have another value", "Other frames are refused or reported."),
    ("field-verdict", "WWWD", "a bit makes something else of the position", "Positions are usable or not by it."),
    ("field-expected", "WWWD", "a field is documented to hold another value", "The encoder is known by it."),
    ("field-default", "WWWD", "a field has another default", _WIRE),
    ("field-unit", "DWWD", "a field counts in another unit", "The same number means something else."),
    ("value-changed", "WWWD", "a named value has another number", _WIRE),
    ("joined-of", "WWWD", "a number is made of other fields", _WIRE),
    ("register-moved", "WWWD", "a register has another address or bank", _WIRE),
    (
        "register-length",
        "BWWD",
        "a register has another length",
        "Buffers of the old length are too short or too long.",
    ),
    ("register-order", "WWWD", "the bytes of a register have another order", _WIRE),
    ("register-interface", "BBBD", "a register belongs to another interface", "It is reached by other means."),
    ("access-lost", "BBBD", "a register can no longer be read or written", "Its functions are gone."),
    ("access-gained", "+++D", "a register can be read or written as well", _NEW),
    ("register-default", "WWWD", "a register has another default", _WIRE),
    (
        "register-rule",
        "WWWD",
        "what a write does, needs or takes has changed",
        "An access that worked may do otherwise.",
    ),
    ("limit-narrower", "WWWD", "a value has narrower limits", _LESS),
    ("limit-wider", "+++D", "a value has wider limits, or none", _MORE),
    ("wait-longer", "WWWD", "a time that has to be waited for is longer, or has come anew", _LESS),
    ("wait-shorter", "+++D", "a time that has to be waited for is shorter, or gone", _MORE),
    ("timing-typical", "+++D", "a typical time, or its symbol, has changed", "Nothing can be built on typical times."),
    ("clock-narrower", "WWWD", "the clock has narrower limits", _LESS),
    ("clock-wider", "+++D", "the clock has wider limits", _MORE),
    ("port", "WWWD", "the serial port is set otherwise", _WIRE),
    ("alignment", "DWWD", "a word begins at its other end, or in another code", _WIRE),
    ("bank-select", "WWWD", "the bank is selected by another register", _WIRE),
    (
        "interface-rule",
        "DWWD",
        "signals, network, profile or memory access are described otherwise",
        "Set-ups follow it.",
    ),
    ("data-id-changed", "WWWD", "a data ID has another number, control byte or purpose", _WIRE),
    ("crc-changed", "WWWD", "a CRC is computed otherwise", "Frames that were sound are refused."),
    ("alarm-bit", "WWWD", "an error or warning is another bit", _WIRE),
    (
        "alarm-rule",
        "DWWD",
        "when an error or warning comes and goes has changed",
        "A reset, or a wait, does otherwise.",
    ),
    ("procedure-steps", "WWWD", "a procedure does something else", "The same call sends something else."),
    ("procedure-arguments", "BBBD", "a procedure takes other arguments", "Calls no longer fit."),
    ("procedure-interface", "BBBD", "a procedure runs over another interface", "It is reached by other means."),
    ("answer-sets", "WWWD", "an answer stands for other bits", _WIRE),
    ("contact", "DWWD", "a contact or wire carries another signal", "Who wires by the old one may do harm."),
    ("input-rule", "DWWD", "a hardware input does something else", "An encoder wired for it does otherwise."),
    ("unforeseen", "WWWD", "something has changed that no other rule knows", "It is better told than left out."),
    ("words", "DDDD", "something is said in other words", "No code acts on it."),
    ("source", "DDDD", "something is cited from another place", "No code acts on it."),
    ("manual", "DDDD", "the manual is another edition, or has more revisions", "What it changed has rules of its own."),
    ("erratum", "DDDD", "an erratum has come, gone or changed", "What is used instead has rules of its own."),
    ("example", "DDDD", "a worked example has come, gone or changed", "Examples are tests and pages."),
    ("told", "DDDD", "a characteristic, table, light, document or lost figure has changed", "No code acts on it."),
    ("order", "DDDD", "the same facts stand in another order", "They are found by their names."),
)


def _all() -> Iterator[Rule]:
    for thing, what, gone, new, renamed, same in _THINGS:
        yield Rule(f"{thing}-gone", _impacts(gone), f"{what} is gone", _GONE)
        why = "Callers have to say what they take it to be." if thing == "decision" else _NEW
        if thing in ("field", "joined"):
            why = "Who makes such a frame or register has one more value to give; who reads it has one more to see."
        if thing == "measurement":
            why = "In C, a quantity that it counts goes by what it is there, such as the counts of a turn."
        yield Rule(f"{thing}-new", _impacts(new), f"{what} is new", why)
        if same:
            yield Rule(f"{thing}-renamed", _impacts(renamed), f"{what} has another name, known by {same}", _RENAMED)
    for name, impacts, when, why in _CHANGES:
        yield Rule(name, _impacts(impacts), when, why)


def _impacts(letters: str) -> tuple[Impact, Impact, Impact, Impact]:
    c, python, xml, pages = (_LETTERS[letter] for letter in letters)
    return c, python, xml, pages


#: Every rule by its name.
RULES: Mapping[str, Rule] = MappingProxyType({rule.name: rule for rule in _all()})
#: By what a renamed thing is known.
SAME: Mapping[str, str] = MappingProxyType({thing: same for thing, _, _, _, _, same in _THINGS})
