"""Digital type plates: an instance of an OPC UA encoder for each order code.

The types are those of OPC 40400-1 (OPC UA for the Powertrain, part 1), in the nodeset of version 1.0.0 of 2024-11-01.
Chapter 7.8 defines the attributes and their units. An attribute that the spec does not give is left out. The nodeset is
not part of this project. A server must load it first.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypedDict

from codewheel.model import Biss, Device, Ssi, Variant
from codewheel.render import Templates
from codewheel.say import text_on_one_line
from codewheel.targets import NO_OPTIONS, Library, Options, Target
from codewheel.targets.registry import licence_in, names_of_codes

#: Values of EncoderType (7.8.9) and EncoderProtocol (7.8.13) with their names.
_SINGLE_TURN, _MULTI_TURN, _LINEAR = (0, "ROT_SINGLE_TURN"), (1, "ROT_MULTI_TURN"), (4, "LINEAR_ABSOLUTE")
_BISS_C, _SSI_BINARY, _SSI_GRAY = (0, "BISS_C"), (6, "SSI_BINARY"), (7, "SSI_GRAY_CODE")
#: Largest number of the type UInt32. A resolution above it is left out.
_LARGEST = 0xFFFFFFFF


class Resolution(TypedDict):
    """An attribute with the resolution: positions per revolution, revolutions, or positions per millimetre."""

    name: Annotated[str, "name of the attribute"]
    type: Annotated[str, "data type of the attribute"]
    value: Annotated[int | float, "number of positions or revolutions, or of positions per millimetre"]


class Plate(TypedDict):
    device: Annotated[Device, "the family"]
    code: Annotated[str, "order code"]
    name: Annotated[str, "name of the file, which also names the nodes"]
    kind: Annotated[str, "``Rotary`` or ``Linear``"]
    encoder_type: Annotated[tuple[int, str], "value and name of EncoderType"]
    resolutions: Annotated[list[Resolution], "the resolutions, or none if the spec has no measurement"]
    protocol: Annotated[
        tuple[int, str] | None,
        "value and name of EncoderProtocol, or None if it has none for the interface",
    ]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return ``opcua/<maker>-<device>/<order code>.xml`` for each listed order code with a known encoder type."""
    files = licence_in("opcua")
    for device in library.devices:
        files |= library.part(_family, device, options)
    return files


def _family(device: Device, library: Library, options: Options) -> dict[str, str]:
    """Return the files of a family by path."""
    files = {}
    names = names_of_codes(variant.code for variant in device.variants)
    for name, variant in zip(names, device.variants, strict=True):
        plate = _plate(device, variant, name)
        if plate is not None:
            path = f"opcua/{device.manufacturer.name}-{device.name}/{name}.xml"
            files[path] = TEMPLATES.render("type_plate.xml.jinja", plate, library.own_templates)
    return files


def _plate(device: Device, variant: Variant, name: str) -> Plate | None:
    """Return the facts on the type plate, or None if there is no measurement to determine the encoder type from."""
    measured = device.measurement_of(variant.interface)
    if measured is None:
        return None
    resolutions: list[Resolution] = []
    step = measured.micrometres(variant.parameters)
    if step is not None:
        encoder_type = _LINEAR
        per_mm = float(1000 / step)
        resolutions.append({"name": "ResolutionLinearAbsolute", "type": "Float", "value": per_mm})
    else:
        turns = measured.turns.value(variant.parameters) if measured.turns is not None else 1
        encoder_type = _MULTI_TURN if turns > 1 else _SINGLE_TURN
        if measured.counts_per_turn is not None:
            counts = measured.counts_per_turn.value(variant.parameters)
            resolutions.append({"name": "ResolutionSingleturnAbsolute", "type": "UInt32", "value": counts})
        if turns > 1:
            resolutions.append({"name": "ResolutionMultiturnAbsolute", "type": "UInt32", "value": turns})
    return {
        "device": device,
        "code": variant.code,
        "name": name,
        "kind": "Linear" if encoder_type == _LINEAR else "Rotary",
        "encoder_type": encoder_type,
        "resolutions": [resolution for resolution in resolutions if resolution["value"] <= _LARGEST],
        "protocol": _protocol(device, variant),
    }


def _protocol(device: Device, variant: Variant) -> tuple[int, str] | None:
    """Return the protocol. The standard has no value for the protocols over RS-485."""
    interface = device.interface(variant.interface)
    if isinstance(interface, Biss):
        return _BISS_C
    if not isinstance(interface, Ssi):
        return None
    layout = next((layout for layout in interface.layouts if device.sends_position(interface.name, layout)), None)
    if layout is None:
        return None
    always = bool(layout.gray_of) and not layout.gray_when
    return _SSI_GRAY if always or variant.parameters.get(layout.gray_when) else _SSI_BINARY


TEMPLATES = Templates(
    Path(__file__).parent / "templates",
    values={"type_plate.xml.jinja": Plate},
    filters={"text": text_on_one_line},
    autoescape=True,
)
TARGET = Target(
    name="opcua",
    summary="type plates for OPC UA servers (OPC 40400-1, Powertrain), one for each order code",
    files=generate,
    templates=TEMPLATES,
    family=_family,
)
