"""Build interfaces from checked data, with one function for each kind.

Missing required keys have been reported. Stand-ins replace them, so that the rest can be checked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..model import (
    INTERFACES,
    Alignment,
    CableLength,
    Clock,
    ControlField,
    Exchange,
    Interface,
    Layout,
    Measurement,
    OutputCode,
    Port,
)
from ..model.expressions import Expression
from .fields import Context, Site, build_values
from .from_mapping import Raw, record, sources
from .layouts import build_layout


def build_interfaces(raw: Raw, context: Context) -> tuple[Interface, ...]:
    return tuple(_interface(name, item, context) for name, item in raw["interfaces"].items())


def _interface(name: str, raw: Raw, context: Context) -> Interface:
    layouts = (
        build_layout(item, Site(("interfaces", name, "layouts", index), context, name))
        for index, item in enumerate(raw["layouts"])
    )
    kind: Callable[..., Interface] = INTERFACES[name]
    sound = tuple(item for item in layouts if item is not None)
    if "word_bits" in raw:
        _check_words(raw, sound, Site(("interfaces", name), context, name))
    return record(
        kind,
        raw,
        layouts=sound,
        measurement=build_measurement(raw, context),
        **_INTERFACES[name](raw, context),
    )


#: Least and highest number of bits in an SPI word.
_WORD = (8, 64)


def _check_words(raw: Raw, layouts: Sequence[Layout], site: Site) -> None:
    """Check that words have a possible number of bits for every order code, and that their layouts have as many."""
    shared = _checked(raw, site)
    found = [
        (item, _checked(item, site, "exchanges", index) if "word_bits" in item else shared)
        for index, item in enumerate(raw.get("exchanges", ()))
    ]
    for layout in layouts:
        uses = [(item, bits) for item, bits in found if layout.name in (item["request"], item["reply"])]
        for item, bits in uses or [({}, shared)]:
            if bits is not None and layout.bits != bits:
                of = f" of the exchange of '{item['request']}'" if "word_bits" in item else ""
                wrong = f"'{layout.name}' has {layout.bits.render()} bits, but 'word_bits'{of} is {bits.render()}"
                way = f", or give the exchange of '{item['request']}' its own 'word_bits'" if item and not of else ""
                way = f"correct 'word_bits' or the fields{way}"
                site.report("width-mismatch", f"{wrong}; {way}", "layouts", layout.name)
                break


def _checked(raw: Raw, site: Site, *below: str | int) -> Expression | None:
    """Return ``word_bits`` of an interface or exchange, and check its range for every order code."""
    bits = site.context.expression(raw.get("word_bits", _WORD[0]))
    low, high = _WORD
    lengths = sorted({bits.value(parameters) for parameters in site.sets} if bits is not None else ())
    for length in [length for length in lengths if not low <= length <= high][:1]:
        wrong = f"a word has {length} bits, but {low} to {high} are possible"
        site.report("width-mismatch", wrong, *below, "word_bits")
    return bits


def build_measurement(raw: Raw, context: Context) -> Measurement | None:
    """Return the measurement of a device or of one of its interfaces."""
    if "measurement" not in raw:
        return None
    found = raw["measurement"]
    parts = {
        key: context.expression(found[key]) if key in found else None
        for key in ("counts_per_turn", "turns", "step_um", "step_nm", "per_counts", "modulus", "highest")
    }
    return Measurement(of=found["of"], source=sources(found), **parts)


def _clock(raw: Raw) -> Clock:
    clock = raw.get("clock", {})
    used = clock.get("used_hz", ())
    return record(Clock, clock, used_hz=tuple(sorted(used)) if isinstance(used, Sequence) else (used,))


def _ssi(raw: Raw, context: Context) -> Mapping[str, Any]:
    code = raw.get("output_code")
    return {
        "clock": _clock(raw),
        "alignment": Alignment(raw.get("alignment", ""), sources(raw, "alignment_source") or sources(raw)),
        "output_code": OutputCode(code, sources(raw, "output_code_source") or sources(raw)) if code else None,
        "cable_lengths": tuple(
            record(CableLength, item, source=sources(item) or sources(raw)) for item in raw.get("cable_lengths", ())
        ),
    }


def _biss(raw: Raw, context: Context) -> Mapping[str, Any]:
    control = raw.get("control_data", {})
    return {
        "clock": _clock(raw),
        "control_data": tuple(_control_field(item, control, context) for item in control.get("fields", ())),
        "control_data_note": control.get("note", ""),
    }


def _rs485(raw: Raw, context: Context) -> Mapping[str, Any]:
    return {"port": record(Port, {**_PORT, **raw.get("port", {})}), "exchanges": _exchanges(raw, context)}


def _spi(raw: Raw, context: Context) -> Mapping[str, Any]:
    bits = context.expression(raw.get("word_bits", _WORD[0]))
    return {"clock": _clock(raw), "word_bits": bits, "exchanges": _exchanges(raw, context)}


def _exchanges(raw: Raw, context: Context) -> tuple[Exchange, ...]:
    source = raw.get("source", "")
    return tuple(
        record(
            Exchange,
            {"source": source, **item},
            word_bits=context.expression(item["word_bits"]) if "word_bits" in item else None,
        )
        for item in raw.get("exchanges", ())
    )


#: Settings of a port that the manual does not give.
_PORT = {"data_bits": 8, "parity": "none", "stop_bits": 1, "flow_control": "none"}
#: Functions that build the members of an interface which differ from the spec.
_INTERFACES = {"ssi": _ssi, "biss": _biss, "rs485": _rs485, "spi": _spi}


def _control_field(raw: Raw, parent: Raw, context: Context) -> ControlField:
    bits = raw.get("bits", context.crcs[raw["crc"]].width if raw.get("crc") in context.crcs else 1)
    return record(
        ControlField,
        raw,
        bits=bits if isinstance(bits, int) else 0,
        values=build_values(raw),
        source=sources(raw) or sources(parent),
    )
