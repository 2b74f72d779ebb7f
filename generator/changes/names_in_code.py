"""Names of things in C and in Python, so that users can search their code for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from .change import Thing
from .family_pair import FamilyPair
from .pairs import Pair

#: Names of each kind of thing in C and in Python, with the manufacturer, the family and the thing itself.
_NAMES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "registers": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_REG_{NAME}_…", '{family}.REGISTERS["{name}"]'),
        "layouts": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{Name}"),
        "procedures": ("{manufacturer}_{family}_{interface}_{name}_…", "{family}.{name}"),
        "crcs": ("{manufacturer}_{family}_{interface}_crc_{name}", "{family}.crc_{name}"),
        "data_ids": ("{MANUFACTURER}_{FAMILY}_{INTERFACE}_DATA_ID_{NAME}", "{family}.DataId"),
    }
)


def named_in_code(both: FamilyPair, pair: Pair[Any], path: str, label: str, interface: str) -> Thing:
    """Return a thing, with its names in code if users already know it by them. ``label`` precedes its name."""
    section = path.rpartition(".")[2]
    thing = Thing(f"{path}.{pair.item.name}", f"{label} {pair.item.name}", interface)
    # A new data ID is a new member of an enumeration that users already have.
    if section not in _NAMES or (pair.old is None and section != "data_ids"):
        return thing
    device = both.new if pair.old is None else both.old
    words = {"manufacturer": device.manufacturer.name, "family": device.name, "name": pair.first.name}
    words["interface"] = interface or getattr(pair.first, "interface", "") or device.interfaces[0].name
    words |= {key.upper(): text.upper() for key, text in words.items()}
    words["Name"] = "".join(part[:1].upper() + part[1:] for part in pair.first.name.split("_"))
    c, python = (text.format(**words) for text in _NAMES[section])
    if section == "layouts" and len(device.interface(words["interface"]).layouts) == 1:
        # The only frame of an interface needs no further name.
        c = c.replace(f"_{pair.first.name}_…", "_…")
    if section == "crcs" and not interface:
        # C has no function for a CRC that no frame uses.
        c = "{manufacturer}_{family}_…".format(**words)
    return replace(thing, c=c, python=python)
