"""The rules of ``diff``: each kind of change by its name, with its impact on each output and the reason for it."""

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

_GONE = "Its names are gone from C and Python, and its element from the XML. Code that uses them no longer builds."
_NEW = "All other names stay the same."
_RENAMED = "Names in C, Python and XML follow the spec, so code must use the new name. It works as before."
_WIRE = "The same names mean something else on the line, so code still builds but behaves differently."
_LESS = "Less is allowed: values, clocks or pauses that worked are rejected or too short."
_MORE = "Everything that was allowed still is."

#: Named things. Their rules are THING-gone, THING-new and THING-renamed. Each has a description, then the impacts on C,
#: Python, XML and pages of the three rules, then the property by which a renamed one is recognised.
_THINGS = (
    ("family", "a family of encoders", "BBBD", "+++D", "BBBD", "the same order codes"),
    ("order-code", "an order code", "BBBD", "+++D", "BBBD", "the same parts"),
    ("part", "a part of the order code", "-BBD", "-WWD", "-BBD", "the same values"),
    ("spelling", "another notation for labels", "BBBD", "+++D", "BBBD", "the same texts"),
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
    ("meaning", "a meaning of a register under a setting", "BBBD", "+++D", "BBBD", "the same setting"),
    ("crc", "a CRC", "BBBD", "+++D", "BBBD", "the same computation"),
    ("data-id", "a data ID", "BBBD", "+++D", "BBBD", "the same number"),
    ("timing", "a time", "BBBD", "+++D", "BBBD", "the same times"),
    ("alarm", "an error or warning", "BBBD", "+++D", "BBBD", "the same bit"),
    ("procedure", "a procedure", "BBBD", "+++D", "BBBD", "the same steps"),
    ("decision", "a question that the manual leaves open", "BBBD", "BBBD", "BBBD", "the same bits"),
    ("answer", "an answer to an open question", "BBBD", "+++D", "BBBD", "the same bits"),
    ("control-field", "a field of the control frame", "BBBD", "+++D", "BBBD", "the same bits"),
    ("connector", "a connector or cable", "DBBD", "D++D", "DBBD", "the same contacts"),
    ("measurement", "the measurement of a position", "BBBD", "B++D", "BBBD", ""),
    ("input", "a hardware input", "DBBD", "D++D", "DBBD", "the same effect"),
)

#: Other changes: name, impact on C, Python, XML and pages, condition, reason.
_CHANGES = (
    ("interface-of-code", "BBBD", "an order code has another interface", "It has other frames and registers."),
    ("parameter-of-code", "WWWD", "an order code has another resolution or other number", _WIRE),
    ("parameter-rule", "WWWD", "the formula of a quantity has changed", _WIRE),
    ("parameter-range", "WWWD", "a quantity held in a register has another range or another register", _WIRE),
    ("label", "WWWD", "the rule for reading labels has changed", "Labels may give other order codes."),
    ("movement", "-WWD", "rotary has become linear or vice versa", "A position means something else."),
    ("measurement", "WWWD", "the units of the position have changed", "Angles and lengths differ."),
    ("maker", "BBBD", "the manufacturer's name or its Python package has changed", "Every name begins with it."),
    ("maker-id", "--BD", "the BiSS manufacturer ID has changed", "Masters use it to find the description file."),
    ("supply-narrower", "D+WD", "the supply voltage has narrower limits", "A supply that was right may do damage."),
    ("supply-wider", "D++D", "the supply voltage has wider limits, or none", _MORE),
    ("frame-length", "WWWD", "a frame has another length", _WIRE),
    ("frame-order", "WWWD", "a frame is sent in another order or in another code", _WIRE),
    ("frame-told-by", "WWWD", "another value identifies a frame", _WIRE),
    ("frame-decision", "BBBD", "a frame now needs a decision, or no longer does", "An argument is added or removed."),
    ("other-bits", "WWWD", "the required values of bits outside the fields have changed", _WIRE),
    ("field-moved", "WWWD", "a field is at other bits", _WIRE),
    ("field-width", "WWWD", "a field has another width", _WIRE),
    ("field-kind", "BBBD", "a field is of another kind", "Its type changes, or it is added or removed."),
    ("field-reads-otherwise", "WWWD", "the bits of a field are converted in another way", _WIRE),
    ("field-constant", "WWWD", "fixed or unused bits have another value", "Other frames are rejected or reported."),
    ("field-verdict", "WWWD", "a bit has another effect on the position", "It decides whether positions are usable."),
    ("field-expected", "WWWD", "a field has another documented value", "It identifies the encoder."),
    ("field-default", "WWWD", "a field has another default", _WIRE),
    ("field-unit", "DWWD", "a field has another unit", "The same number means something else."),
    ("value-changed", "WWWD", "a named value has another number", _WIRE),
    ("joined-of", "WWWD", "a number consists of other fields", _WIRE),
    ("register-moved", "WWWD", "a register has another address or bank", _WIRE),
    (
        "register-length",
        "BWWD",
        "a register has another length",
        "Buffers of the old length are too short or too long.",
    ),
    ("register-order", "WWWD", "the bytes of a register have another order", _WIRE),
    ("register-interface", "BBBD", "a register belongs to another interface", "It is accessed by other means."),
    ("access-lost", "BBBD", "a register can no longer be read or written", "Its functions are gone."),
    ("access-gained", "+++D", "a register can now also be read or written", _NEW),
    ("register-default", "WWWD", "a register has another default", _WIRE),
    (
        "register-rule",
        "WWWD",
        "the effect, the conditions or the time of a write have changed",
        "An access that worked may behave differently.",
    ),
    ("limit-narrower", "WWWD", "a value has narrower limits", _LESS),
    ("limit-wider", "+++D", "a value has wider limits, or none", _MORE),
    ("wait-longer", "WWWD", "a required waiting time is longer or new", _LESS),
    ("wait-shorter", "+++D", "a required waiting time is shorter or gone", _MORE),
    ("timing-typical", "+++D", "a typical time, or its symbol, has changed", "Code cannot rely on typical times."),
    ("clock-narrower", "WWWD", "the clock has narrower limits", _LESS),
    ("clock-wider", "+++D", "the clock has wider limits", _MORE),
    ("port", "WWWD", "the settings of the serial port have changed", _WIRE),
    ("alignment", "DWWD", "a word has another alignment or code", _WIRE),
    ("bank-select", "WWWD", "the bank is selected by another register", _WIRE),
    (
        "interface-rule",
        "DWWD",
        "signals, network, profile or memory access have changed",
        "Set-ups depend on it.",
    ),
    ("data-id-changed", "WWWD", "a data ID has another number, control byte or purpose", _WIRE),
    ("crc-changed", "WWWD", "a CRC is computed differently", "Frames that were valid are rejected."),
    ("alarm-bit", "WWWD", "an error or warning is another bit", _WIRE),
    (
        "alarm-rule",
        "DWWD",
        "the conditions that set or clear an error or warning have changed",
        "A reset or a wait has another effect.",
    ),
    ("procedure-steps", "WWWD", "the steps of a procedure have changed", "The same call sends something else."),
    ("procedure-arguments", "BBBD", "a procedure has other arguments", "Calls no longer match."),
    ("procedure-interface", "BBBD", "a procedure uses another interface", "It is accessed by other means."),
    ("answer-sets", "WWWD", "an answer stands for other bits", _WIRE),
    ("contact", "DWWD", "a contact or wire carries another signal", "Wiring by the old spec may do damage."),
    ("input-rule", "DWWD", "a hardware input has another function", "An encoder wired to it behaves differently."),
    ("unforeseen", "WWWD", "a change that no other rule covers", "It is reported rather than ignored."),
    ("words", "DDDD", "only the wording has changed", "No code depends on it."),
    ("source", "DDDD", "a citation has changed", "No code depends on it."),
    ("manual", "DDDD", "the manual has another edition or more revisions", "Its changes have rules of their own."),
    ("erratum", "DDDD", "an erratum is new, gone or changed", "The facts that it changes have rules of their own."),
    ("example", "DDDD", "a worked example is new, gone or changed", "Examples are tests and pages."),
    ("told", "DDDD", "a characteristic, table, light, document or lost figure has changed", "No code depends on it."),
    ("order", "DDDD", "only the order of the facts has changed", "Facts are found by their names."),
)


def _all() -> Iterator[Rule]:
    for thing, what, gone, new, renamed, same in _THINGS:
        yield Rule(f"{thing}-gone", _impacts(gone), f"{what} is gone", _GONE)
        why = "Callers must give an answer." if thing == "decision" else _NEW
        if thing in ("field", "joined"):
            why = "Code that encodes the frame or register must give one more value, and decoders return one more."
        if thing == "measurement":
            why = "In C, a quantity that it uses is named after its role there, such as the counts per turn."
        yield Rule(f"{thing}-new", _impacts(new), f"{what} is new", why)
        if same:
            yield Rule(f"{thing}-renamed", _impacts(renamed), f"{what} has another name but {same}", _RENAMED)
    for name, impacts, when, why in _CHANGES:
        yield Rule(name, _impacts(impacts), when, why)


def _impacts(letters: str) -> tuple[Impact, Impact, Impact, Impact]:
    c, python, xml, pages = (_LETTERS[letter] for letter in letters)
    return c, python, xml, pages


#: Every rule by its name.
RULES: Mapping[str, Rule] = MappingProxyType({rule.name: rule for rule in _all()})
#: The property by which a renamed thing is recognised.
SAME: Mapping[str, str] = MappingProxyType({thing: same for thing, _, _, _, _, same in _THINGS})
