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
        _check_word(raw["word_bits"], sound, Site(("interfaces", name), context, name))
    return record(
        kind,
        raw,
        layouts=sound,
        measurement=build_measurement(raw, context),
        **_INTERFACES[name](raw, context),
    )


#: Least and highest number of bits in an SPI word.
_WORD = (8, 64)


def _check_word(text: int | str, layouts: Sequence[Layout], site: Site) -> None:
    """Check that a word has a possible number of bits for every order code, and that each layout has as many."""
    bits = site.context.expression(text)
    if bits is None:
        return
    low, high = _WORD
    lengths = {bits.value(parameters) for parameters in site.sets}
    for length in [length for length in sorted(lengths) if not low <= length <= high][:1]:
        site.report("width-mismatch", f"a word has {length} bits, but {low} to {high} are possible", "word_bits")
    for layout in layouts:
        if layout.bits != bits:
            wrong = f"'{layout.name}' has {layout.bits.render()} bits, but 'word_bits' is {bits.render()}"
            way = "all words over SPI have the same length, so correct 'word_bits' or the fields"
            site.report("width-mismatch", f"{wrong}; {way}", "layouts", layout.name)


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


def _ssi(raw: Raw, context: Context) -> Mapping[str, Any]:
    code = raw.get("output_code")
    return {
        "clock": record(Clock, raw.get("clock", {})),
        "alignment": Alignment(raw.get("alignment", ""), sources(raw, "alignment_source") or sources(raw)),
        "output_code": OutputCode(code, sources(raw, "output_code_source") or sources(raw)) if code else None,
        "cable_lengths": tuple(
            record(CableLength, item, source=sources(item) or sources(raw)) for item in raw.get("cable_lengths", ())
        ),
    }


def _biss(raw: Raw, context: Context) -> Mapping[str, Any]:
    control = raw.get("control_data", {})
    return {
        "clock": record(Clock, raw.get("clock", {})),
        "control_data": tuple(_control_field(item, control, context) for item in control.get("fields", ())),
        "control_data_note": control.get("note", ""),
    }


def _rs485(raw: Raw, context: Context) -> Mapping[str, Any]:
    return {"port": record(Port, {**_PORT, **raw.get("port", {})}), "exchanges": _exchanges(raw)}


def _spi(raw: Raw, context: Context) -> Mapping[str, Any]:
    clock, bits = {"min_hz": 0, **raw.get("clock", {})}, context.expression(raw["word_bits"])
    return {"clock": record(Clock, clock), "word_bits": bits, "exchanges": _exchanges(raw)}


def _exchanges(raw: Raw) -> tuple[Exchange, ...]:
    source = raw.get("source", "")
    return tuple(record(Exchange, {"source": source, **item}) for item in raw.get("exchanges", ()))


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
