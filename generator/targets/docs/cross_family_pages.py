"""Pages across families: encoder identification, registers by address, alarms and LEDs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, TypedDict

from ...model import Alarm, Device, Field, Interface, Register, Supply
from ...order_codes.narrowing import for_interface
from ...order_codes.parameters import run_time_names
from ...say import register as say_register
from ...say.crc import sent
from ...say.interface import settings
from ...say.markdown import STYLE, cited, code, joined, link, text
from ...say.name import title, words
from ...say.parameter import value
from ...say.place import addresses
from ...say.words import volts
from .order_code_patterns import patterns
from .page_links import to_alarm, to_layout, to_register, to_steps

#: File names of the pages, which no family can have.
WHICH, REGISTERS, ALARMS = "which-encoder.md", "registers-by-address.md", "alarms-and-leds.md"
Row = tuple[str, ...]
#: Labels of the interface facts to compare.
_COMPARED = ("Clock", "Alignment", "Code", "Time-out", "Baud rate")


class WhichPage(TypedDict):
    label_rows: Annotated[list[Row], "family, title, patterns of its order codes, interfaces, supply"]
    told_rows: Annotated[list[Row], "family, identifying register, name, content, source"]
    compared_rows: Annotated[list[Row], "interface of a family, fact, value, source"]
    resolution_rows: Annotated[list[Row], "quantities set by order codes: family, quantity, values, unit, source"]
    frame_rows: Annotated[list[Row], "frames with a position: interface, family, frame, bits, order, CRC"]
    byte_order_rows: Annotated[list[Row], "registers of several bytes: family, first byte, registers"]


class RegistersPage(TypedDict):
    register_rows: Annotated[list[Row], "address, bank, register, family, access, default, meaning"]


class AlarmsPage(TypedDict):
    alarm_rows: Annotated[list[Row], "alarm, family, meaning, remedy, source"]
    led_rows: Annotated[list[Row], "LED, state, family, meaning, source"]


def which(devices: Sequence[Device]) -> WhichPage:
    return {
        "label_rows": [_label_row(item) for item in devices],
        "told_rows": [row for item in devices for row in _told(item)],
        "resolution_rows": [row for item in devices for row in _resolutions(item)],
        "byte_order_rows": [row for item in devices for row in _byte_orders(item)],
        "compared_rows": _side_by_side(row for item in devices for row in _compared(item)),
        "frame_rows": _side_by_side(row for item in devices for row in _frames(item)),
    }


def _side_by_side(rows: Iterable[Row]) -> list[Row]:
    """Group the rows by interface, in the order in which the interfaces first occur."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row[0], []).append(row)
    return [row for part in found.values() for row in part]


def _family(device: Device) -> str:
    return link(text(device.name.upper()), f"{device.name}.md")


def _label_row(device: Device) -> Row:
    titles = joined((item.title for item in device.interfaces), ", ")
    supplies = dict.fromkeys(filter(None, map(device.supply_of, device.variants)))
    labels = joined(map(code, patterns(device, [item.code for item in device.variants])))
    return _family(device), text(device.title), labels, titles, joined(map(_volts, supplies))


def _volts(supply: Supply) -> str:
    return f"{volts(supply.min_mv)} to {volts(supply.max_mv)}"


def _told(device: Device) -> Iterator[Row]:
    """Yield the registers whose content is the same for the whole family or is determined by the order code."""
    for register, field in device.identity:
        where = to_register(device, register, addresses(register))
        name = title(register) + (f", {words(field.name)}" if len(register.layout.fields) > 1 else "")
        yield _family(device), where, text(name), _held(field), cited(field.source or register.source)


def _held(field: Field) -> str:
    match field.equals:
        case int():
            return f"`{field.equals:0{(field.widest + 3) // 4}X}h`"
        case str():
            return code(field.equals)
        case None:
            return ""
        case expression:
            return STYLE.number(expression) + ", by order code"


def _compared(device: Device) -> Iterator[Row]:
    for interface in device.interfaces:
        for item in settings(device, interface):
            if item.label in _COMPARED:
                yield interface.title, _family(device), text(item.label), STYLE.phrase(item), cited(item.source)


def _frames(device: Device) -> Iterator[Row]:
    for interface, layout in device.layouts():
        if device.tells_position(interface.name, layout):
            variants = device.variants_over(interface.name)
            lengths = sorted({layout.place(item.parameters).bits for item in variants}) or [0]
            crc = device.crc_of(layout)
            yield (
                interface.title,
                _family(device),
                to_layout(device, layout, code(layout.name)),
                f"{lengths[0]}" if len(lengths) == 1 else f"{lengths[0]} to {lengths[-1]}",
                layout.byte_order.replace("_", " ") if layout.in_bytes else "most significant bit first",
                text(f"{crc.polynomial}, {sent(crc)}") if crc is not None else "none",
            )


def _resolutions(device: Device) -> Iterator[Row]:
    """Yield the resolution and range of the position by order code."""
    held = run_time_names(device)
    for item in device.set_parameters:
        if not item.unit or item.name in held:
            continue
        found = sorted({one.parameters[item.name] for one in device.variants if item.name in one.parameters})
        values = ", ".join(value(item, count) for count in found)
        yield _family(device), text(item.meaning), values, text(item.unit), cited(item.source)


def _byte_orders(device: Device) -> Iterator[Row]:
    """Yield the byte order of registers that have several bytes."""
    found: dict[str, list[Register]] = {}
    for item in device.registers:
        if item.length > 1:
            found.setdefault(item.byte_order, []).append(item)
    for order, those in found.items():
        links = (to_register(device, item, f"{addresses(item)} {text(title(item))}") for item in those)
        yield _family(device), order.replace("_", " "), ", ".join(links)


def registers(devices: Sequence[Device]) -> RegistersPage:
    found = [(item, device) for device in devices for item in device.registers]
    found.sort(key=lambda pair: (pair[0].address, -1 if pair[0].bank is None else pair[0].bank, pair[1].name))
    return {"register_rows": [_register_row(*pair) for pair in found]}


def _register_row(register: Register, device: Device) -> Row:
    data = register.default_bytes()
    return (
        addresses(register),
        "" if register.bank is None else f"{register.bank}",
        to_register(device, register, code(register.name)),
        _family(device),
        say_register.access(register),
        code(data.hex(" ").upper()) if data is not None else "",
        text(register.meaning),
        cited(register.source),
    )


def alarms(devices: Sequence[Device]) -> AlarmsPage:
    found = sorted((item for device in devices for item in _alarms(device)), key=_by_name)
    return {
        "alarm_rows": [_alarm_row(*item) for item in found],
        "led_rows": [
            (
                text(item.title),
                text(state.state),
                _family(device),
                joined([text(state.meaning), *to_steps(f"{device.name}/", state.by_hand)]),
                code(state.only),
                cited(item.source),
            )
            for device in devices
            for item in device.leds
            for state in item.states
        ],
    }


def _alarms(device: Device) -> list[tuple[Alarm, Device, Interface]]:
    """Return each alarm with the first interface that has it, whose page explains it."""
    found = [(alarm, item) for item in device.interfaces for alarm in for_interface(device, item.name).alarms]
    over = {alarm.name: item for alarm, item in reversed(found)}
    return [(alarm, device, over[alarm.name]) for alarm in device.alarms]


def _by_name(item: tuple[Alarm, Device, Interface]) -> tuple[str, str]:
    alarm, device, _ = item
    return title(alarm).casefold(), device.name


def _alarm_row(alarm: Alarm, device: Device, over: Interface) -> Row:
    name = to_alarm(device, over, alarm, text(title(alarm)))
    meaning = text(alarm.meaning) if alarm.implemented else "not implemented in this encoder"
    remedy = joined([text(alarm.remedy), *to_steps(f"{device.name}/", alarm.by_hand)])
    return name, _family(device), meaning, remedy, code(alarm.only), cited(alarm.source)
