"""Page about an interface of a family, and the parts of it that are also on the page of an order code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, TypedDict

from ...model import Device, Interface, Supply, Variant
from ...order_codes.parameters import follows_registers
from ...order_codes.reduction import for_interface
from ...say.field import measurement, own_ranges, position_range
from ...say.markdown import STYLE, cited, code, text
from ...say.names_and_places import Named, title
from ...say.order_code import initial
from ...say.text import volts
from . import fact_tables, order_code_tables
from .interface_sections import Rows, Section, Sections, page_sections
from .order_code_patterns import order_codes, patterns
from .page_pictures import Pictures
from .timing_pictures import TimingDiagram, timing_diagram

Row = tuple[str, ...]


class InterfaceValues(TypedDict):
    """Values of a page about one interface in addition to its sections."""

    interface: Annotated[Interface, "the interface"]
    has_masters: Annotated[bool, "whether there is a page of master settings"]
    short_rows: Annotated[list[Row], "fact, value, source: the position, the supply, the interface"]
    pictures: Annotated[Pictures, "pictures by their subject, such as `register-preset`: name, text"]
    timing: Annotated[TimingDiagram | None, "timing diagram of the interface, if there is one"]
    delivered: Annotated[Sequence[str], "frames in which positions of fields, or the code, depend on registers"]
    initial: Annotated[str, "values until these registers are read: factory defaults or values of the order code"]


class InterfacePage(Sections, InterfaceValues):
    patterns: Annotated[list[str], "patterns of the order codes with the interface"]
    code_table: Annotated[Section, "these order codes as links, with their quantities: head, rows"]
    parameter_rows: Annotated[Rows, "quantities set by an order code"]
    run_time_rows: Annotated[Rows, "quantities held by registers"]
    name_rows: Annotated[Rows, "names in the manual and its other editions: here, manual, language, name"]


def interface_values(
    family: Device, device: Device, variants: Sequence[Variant], has_masters: bool, pictures: Pictures
) -> InterfaceValues:
    """Return the values. ``device`` is the family, reduced to the interface."""
    (interface,) = device.interfaces
    layouts = family.interface(interface.name).layouts
    return {
        "interface": interface,
        "has_masters": has_masters,
        "short_rows": list(_overview_rows(device, interface, variants)),
        "pictures": pictures,
        "timing": timing_diagram(device, interface),
        "delivered": [layout.name for layout in layouts if follows_registers(family, layout)],
        "initial": initial(family),
    }


def page_values(
    device: Device, kind: str, links: Mapping[str, str], has_masters: bool, pictures: Pictures
) -> InterfacePage:
    """Return the values of the page. ``links`` contains a link to the page of each order code."""
    interface_device = for_interface(device, kind)
    variants = device.variants_over(kind)
    codes = [variant.code for variant in variants]
    return {
        **page_sections(interface_device),
        **interface_values(device, interface_device, variants, has_masters, pictures),
        "patterns": patterns(device, codes) if codes else [],
        "code_table": order_code_tables.code_table(device, device.interface(kind), links),
        "parameter_rows": list(order_code_tables.parameter_rows(device, kind)),
        "run_time_rows": list(order_code_tables.run_time_rows(device, kind)),
        "name_rows": list(_name_rows(interface_device)),
    }


def _overview_rows(device: Device, interface: Interface, variants: Sequence[Variant]) -> Iterator[Row]:
    """Yield the unit of the position, the supply, and the facts of the interface."""
    position_measurement = device.measurement_of(interface.name)
    if position_measurement is not None:
        yield "Position", STYLE.phrase(measurement(position_measurement)), cited(position_measurement.source)
        for name, own_range in own_ranges(device, interface.name):
            yield f"Position in {code(name)}", STYLE.phrase(position_range(own_range)), cited(own_range.source)
    for supply, codes in _codes_by_supply(device, variants).items():
        with_codes = f" ({order_codes(device, codes)})" if len(codes) < len(variants) else ""
        yield f"Supply{with_codes}", f"{volts(supply.min_mv)} to {volts(supply.max_mv)}", cited(supply.source)
    yield from fact_tables.interface_rows(device, interface)


def _codes_by_supply(device: Device, variants: Iterable[Variant]) -> dict[Supply, list[str]]:
    codes_by_supply: dict[Supply, list[str]] = {}
    for variant in variants:
        supply = device.supply_of(variant)
        if supply is not None:
            codes_by_supply.setdefault(supply, []).append(variant.code)
    return codes_by_supply


def _name_rows(device: Device) -> Iterator[Row]:
    """Yield name, printed name, language and name in that language of items that have other names."""
    for named_part in _parts_with_names(device):
        for language, name in named_part.names.items():
            if name != title(named_part):
                yield code(named_part.name), text(named_part.printed_name), text(language), text(name)


def _parts_with_names(device: Device) -> Iterator[Named]:
    """Yield the parts of an interface that may have other names. Fields and values of the same name are one part."""
    (interface,) = device.interfaces
    layouts = [*interface.layouts, *(register.layout for register in device.registers)]
    fields = [field for layout in layouts for field in layout.fields]
    values = [value for field in fields for value in field.values]
    yield from {field.name: field for field in fields if field.names}.values()
    yield from {value.name: value for value in values if value.names}.values()
    yield from device.registers
    yield from device.field_groups
    yield from device.alarms
    yield from device.inputs
    yield from getattr(interface, "control_data", ())
