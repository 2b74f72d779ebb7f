"""The full description is lossless: a model that is rebuilt from the XML alone equals the original."""

from __future__ import annotations

import dataclasses
import sys
import types
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from codewheel import model
from codewheel.dump.plain import device_dump
from codewheel.dump.xml import to_xml
from codewheel.loading.library import load_library
from codewheel.model import Device
from codewheel.model.expressions import Expression
from codewheel.order_codes.labels import find_code
from codewheel.order_codes.parameters import with_registers
from xml_reader import from_xml

# Rebuilds every model from its XML, which does not depend on wording or rules of check.
pytestmark = pytest.mark.slow

ENCODERS = Path(__file__).parents[2] / "specs"
SPECS = Path(__file__).parents[1] / "specs"
#: Members that the XML does not carry: those that follow from the others and only guide code, the counts of the
#: second reading, earlier versions, and the hash of the spec.
COMPUTED = {
    "Field": {"bit_slices", "widest"},
    "Layout": {"fold", "widest"},
    "Crc": {"form"},
    "Constant": {"fills_gap", "fills_byte"},
    "Parity": {"constants", "turned"},
    "Manufacturer": {"main"},
    "Device": {"times_read", "releases", "samples", "content_hash"},
}
COMPUTED_AS = {
    "bit_slices": (),
    "fold": (),
    "widest": 0,
    "form": "",
    "fills_gap": False,
    "fills_byte": False,
    "constants": (),
    "turned": False,
    "main": False,
    "times_read": None,
    "releases": (),
    "samples": (),
    "content_hash": "",
}
#: Kinds of fields by their words.
KINDS = {
    "number": model.Number,
    "flag": model.Flag,
    "choice": model.Choice,
    "constant": model.Constant,
    "unused": model.Unused,
    "crc": model.CrcValue,
    "parity": model.Parity,
    "digits": model.Decimal,
    "text": model.Text,
}
RENAMED = {
    "Layout": {
        "sender": "from",
        "selector": "told_by",
        "selects": "told_by_values",
        "gaps": "other_bits",
        "joins": "join",
    },
    "FrameExample": {"sender": "from"},
    "Register": {"volatile": "lost_unless_saved"},
    "Constant": {"value": "constant"},
    "CrcValue": {"of": "crc_of"},
    "Unused": {"value": "unused"},
    "Parity": {"of": "parity_of"},
    "Decimal": {"runs": "digits"},
    "Device": {
        "name": "family",
        "variants": "order_codes",
        "order_code": "order_code_grammar",
        "parameters": "parameter_definitions",
    },
}
Dump = dict[str, Any]


def build(hint: Any, value: Any) -> Any:
    """Return ``value`` with the type ``hint``."""
    origin, inside = typing.get_origin(hint), typing.get_args(hint)
    if hint == model.Kind:
        return build_class(KINDS[value["kind"]], value)
    if origin in (typing.Union, types.UnionType):
        options = [option for option in inside if option is not type(None)]
        if value is None:
            return None
        if Expression in options:
            return Expression.parse(value) if isinstance(value, str) or len(options) == 1 else value
        if len(options) > 1 and all(map(dataclasses.is_dataclass, options)):
            return build_class(union_member(options, value), value)
        return build(options[0], value) if len(options) == 1 else value
    if origin is tuple:
        return tuple(build(inside[0], member) for member in value)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {key: build(inside[1], member) for key, member in value.items()}
    if hint is Expression:
        return Expression.parse(value)
    if hint is bytes:
        return bytes.fromhex(value)
    return build_class(hint, value) if dataclasses.is_dataclass(hint) else value


def union_member(options: list[Any], dump: Dump) -> Any:
    """Return the member of a union to which an object belongs."""
    if options == list(model.INTERFACES.values()):
        return model.INTERFACES[dump["kind"]]
    word = "do" if "do" in dump else "kind"
    options = [kind for kind in options if getattr(kind, word) == dump[word]]
    # Writing a field is a step of its own.
    return options[-1 if dump.get("field") else 0]


def build_class(kind: Any, dump: Dump) -> Any:
    """Return an object of the model, built from its part of the description."""
    name = kind.__name__
    dump = ADAPT.get(name, lambda plain: plain)(dump)
    names = vars(model) | vars(model.kinds) | vars(model.layout) | vars(sys.modules[kind.__module__])
    hints = typing.get_type_hints(kind, names, {})
    arguments = {}
    for field in dataclasses.fields(kind):
        outside = RENAMED.get(name, {}).get(field.name, field.name)
        if field.name in COMPUTED.get(name, set()):
            arguments[field.name] = COMPUTED_AS[field.name]
        elif field.name.endswith("source"):
            arguments[field.name] = ()
        else:
            # A member with the name of its type hides the type.
            arguments[field.name] = build(bytes if field.type == "bytes" else hints[field.name], dump[outside])
    return kind(**arguments)


def _verdict(dump: Dump) -> Dump:
    names = [name for name in ("makes_position", "verdict_if_set") if name in dump]
    return {name: model.Verdict(dump[name]) if dump[name] else None for name in names}


def _field(dump: Dump) -> Dump:
    equals = dump["equals_text"] or dump["equals"]
    # A text of the spec that is not an expression remains a text, as in the model.
    text = types.SimpleNamespace(value=dump["equals_text"]) if dump["equals_text"] else None
    of_kind = {"active_low": dump["active"] == "low", "odd": dump["parity"] == "odd", **_verdict(dump)}
    return {
        **dump,
        "kind": dump | of_kind,
        "equals": text if text is not None else equals,
    }


def _ssi(dump: Dump) -> Dump:
    code = {"code": dump["output_code"]} if dump["output_code"] else None
    return {**dump, "alignment": {"end": dump["alignment"]}, "output_code": code}


def _register(dump: Dump) -> Dump:
    opened = dump["opened_by"] or {"register": "", "field": "", "value": ""}
    layout = {
        "name": dump["name"],
        "printed_name": dump["printed_name"],
        "from": "",
        "carried_as": "bytes",
        "byte_order": dump["byte_order"],
        "bits": 8 * dump["length"],
        "fields": dump["fields"],
        "join": dump["join"],
        "told_by": "",
        "told_by_values": [],
        "other_bits": dump["other_bits"],
        "note": dump["note"],
        "gray_of": "",
        "gray_when": "",
        "gray_excess": None,
        "position_range": None,
        "channel": None,
        "combinations": [],
    }
    return {
        **dump,
        "opened_by": opened["register"],
        "opened_by_field": opened["field"],
        "opened_by_value": opened["value"],
        "layout": layout,
    }


def _device(dump: Dump) -> Dump:
    """Layouts and times are in separate lists, and each names its interface."""
    interfaces = []
    for kind, part in dump["interfaces"].items():
        lists = {name: _of_interface(dump[name], kind) for name in ("layouts", "timings")}
        by_code = {f"{name}s": _one_or_more(part, name) for name in ("clock", "timeout")}
        interfaces.append({**part, **lists, **by_code})
    return {
        **dump,
        "interfaces": interfaces,
        "timings": _of_interface(dump["timings"], ""),
    }


def _one_or_more(part: Dump, name: str) -> list[Dump]:
    """Return the facts that depend on the order code, or else the fact for all order codes, if any."""
    return part[f"{name}s"] or [fact for fact in [part[name]] if fact]


def _of_interface(parts: list[Dump], interface: str) -> list[Dump]:
    return [part for part in parts if part["interface"] == interface]


def _table(dump: Dump) -> Dump:
    return {**dump, "rows": [row["cells"] for row in dump["rows"]]}


ADAPT: dict[str, Any] = {
    "Combination": lambda dump: dump | _verdict(dump),
    "Field": _field,
    "Value": lambda dump: dump | _verdict(dump),
    "Layout": lambda dump: {**dump, "in_bytes": dump["carried_as"] == "bytes"},
    "Ssi": _ssi,
    "Register": _register,
    "Device": _device,
    "Table": _table,
}


def comparable(value: Any) -> Any:
    """Return a part of the model without its sources and without what follows from the rest.

    It makes no difference whether a text was read or built.
    """
    if isinstance(value, types.SimpleNamespace):
        return value.value
    if isinstance(value, Expression):
        return value.constant if value.is_constant else value.render()
    if isinstance(value, tuple):
        return [comparable(member) for member in value]
    if isinstance(value, Mapping):
        return {key: comparable(member) for key, member in value.items()}
    if dataclasses.is_dataclass(value):
        kind = type(value).__name__
        left_out = COMPUTED.get(kind, set())
        names = [field.name for field in dataclasses.fields(value)]
        compared = [name for name in names if name not in left_out and not name.endswith("source")]
        return {"": kind} | {name: comparable(getattr(value, name)) for name in compared}
    return value


def differences(ours: Any, theirs: Any, path: str = "") -> list[str]:
    if isinstance(ours, dict) and isinstance(theirs, dict):
        keys = ours.keys() | theirs.keys()
        pairs = [(f"{path}.{key}", ours.get(key), theirs.get(key)) for key in keys]
    elif isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        members = enumerate(zip(ours, theirs, strict=True))
        pairs = [(f"{path}[{index}]", *members_at) for index, members_at in members]
    else:
        return [] if ours == theirs else [f"{path}: {ours!r} is not {theirs!r}"]
    return [difference for place, mine, its in pairs for difference in differences(mine, its, place)]


def public() -> dict[str, Device]:
    """Return encoders with codes for widths, RS-485 requests, verdicts on values, or facts by order code."""
    made_up = SPECS.parent / "check" / "ok_model"
    by_code = [made_up / "facts_by_code.yaml", made_up / "manufacturer.yaml"]
    loaded, _ = load_library(
        [*(ENCODERS / name for name in ("ichaus", "cui")), SPECS / "signs.yaml", SPECS / "modbus.yaml", *by_code]
    )
    names = ("icmhm", "amt21", "signs", "modbus", "facts_by_code")
    return {device.name: device for device in loaded if device.name in names}


@pytest.fixture(scope="module")
def rebuilt(devices: Mapping[str, Device]) -> dict[str, tuple[Device, Device]]:
    originals = {**devices, **public()}
    texts = {name: to_xml(device_dump(device)) for name, device in originals.items()}
    return {name: (originals[name], build_class(Device, from_xml(text.encode()))) for name, text in texts.items()}


def test_the_model_comes_back(rebuilt: dict[str, tuple[Device, Device]]) -> None:
    for device, again in rebuilt.values():
        assert differences(comparable(device), comparable(again)) == []


def test_positions_come_back_for_every_order_code(rebuilt: dict[str, tuple[Device, Device]]) -> None:
    """The rebuilt model finds order codes and places fields like the original, whatever the registers contain."""
    for device, again in rebuilt.values():
        for variant in device.variants:
            match = find_code(again, variant.code)
            assert match.variant.parameters == variant.parameters
            for original_state, rebuilt_state in (
                (variant, match.variant),
                (with_registers(device, variant, {}), with_registers(again, match.variant, {})),
            ):
                for layout in device.interface(variant.interface).layouts:
                    mine, its = (
                        layout.place(original_state.parameters),
                        again.layout(layout.name).place(rebuilt_state.parameters),
                    )
                    assert (mine.bits, mine.gray, mine.gray_excess) == (its.bits, its.gray, its.gray_excess)
                    places = [(field.name, field.lowest_bit, field.width) for field in mine.fields]
                    assert places == [(field.name, field.lowest_bit, field.width) for field in its.fields]


#: Path into a description. Items of a list are identified by number or name.
ALTERED: list[tuple[str, tuple[int | str, ...]]] = [
    ("am36", ("registers", 0, "address")),
    ("am36", ("crcs", 0, "init")),
    ("am36", ("layouts", 0, "fields", 0, "low")),
    ("am36", ("order_codes", 0, "parameters")),
    ("am36", ("errata", 0, "used")),
    ("am36", ("procedures", 0, "steps", 0, "meaning")),
    ("am36", ("registers", 1, "access")),
    ("am36", ("interfaces", "biss", "clock", "max_hz")),
    ("facts_by_code", ("interfaces", "ssi", "clocks", 1, "max_hz")),
    ("facts_by_code", ("interfaces", "biss", "timeouts", 1, "only")),
    ("facts_by_code", ("interfaces", "ssi", "cable_lengths", 0, "only")),
    ("am36", ("layouts", "single_cycle_data", "fields", "error", "unused")),
    ("am36", ("layouts", "single_cycle_data", "fields", "error", "makes_position")),
    ("signs", ("layouts", "gray_word", "fields", "quality", "values", "poor", "makes_position")),
    ("signs", ("layouts", "word", "combinations", "field_out_of_range", "makes_position")),
    ("signs", ("layouts", "word", "combinations", "field_out_of_range", "meaning")),
    ("amm5", ("procedures", "reset_errors", "steps", 0, "in_succession")),
    ("amm5", ("alternatives", "adf_layout", "meaning")),
    ("amm5", ("alternatives", "adf_layout", "answers", "as_t_format", "sets", "mem_busy_bit")),
    ("amm5", ("parameter_definitions", "mem_busy_bit", "alternative")),
    ("amm5", ("examples", "public_eeprom_read_request", "alternatives", "adf_layout")),
]


@pytest.mark.one_in(3, "exhaustive")
@pytest.mark.parametrize(("name", "path"), ALTERED, ids=lambda parameter: ".".join(map(str, parameter)))
def test_a_lost_fact_would_be_seen(devices: Mapping[str, Device], name: str, path: tuple[int | str, ...]) -> None:
    """The comparison is effective: a change of any single text or number of the description changes the model."""
    devices = {**devices, **public()}
    data: Any = from_xml(to_xml(device_dump(devices[name])).encode())
    holder = data
    for key in path[:-1]:
        named = isinstance(holder, list) and isinstance(key, str)
        holder = next(member for member in holder if member["name"] == key) if named else holder[key]
    holder[path[-1]] = "usable" if path[-1] == "makes_position" else _altered(holder[path[-1]])
    assert len(differences(comparable(devices[name]), comparable(build_class(Device, data)))) >= 1


def _altered(value: Any) -> Any:
    """Return another value of the same type."""
    if isinstance(value, dict):
        return {**value, "no_such": 1}
    return value + 1 if isinstance(value, int) else value + "x"
