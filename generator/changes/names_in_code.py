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
        "registers": ("{MANUFACTURER}_{FAMILY}_REG_{NAME}_…", '{family}.REGISTERS["{name}"]'),
        "layouts": ("{manufacturer}_{family}_{name}_…", "{family}.{Name}"),
        "procedures": ("{manufacturer}_{family}_{name}_…", "{family}.{name}"),
        "crcs": ("{manufacturer}_{family}_crc_{name}", "{family}.crc_{name}"),
        "data_ids": ("{MANUFACTURER}_{FAMILY}_DATA_ID_{NAME}", "{family}.DataId"),
    }
)


def named_in_code(both: FamilyPair, pair: Pair[Any], path: str, label: str, interface: str) -> Thing:
    """Return a thing, with its names in code if it has some that users have already. ``label`` precedes its name."""
    section = path.rpartition(".")[2]
    thing = Thing(f"{path}.{pair.item.name}", f"{label} {pair.item.name}", interface)
    # A new data ID is a new member of an enumeration that users already have.
    if section not in _NAMES or (pair.old is None and section != "data_ids"):
        return thing
    device = both.new if pair.old is None else both.old
    words = {"manufacturer": device.manufacturer.name, "family": device.name, "name": pair.first.name}
    words |= {key.upper(): text.upper() for key, text in words.items()}
    words["Name"] = "".join(part[:1].upper() + part[1:] for part in pair.first.name.split("_"))
    c, python = (text.format(**words) for text in _NAMES[section])
    return replace(thing, c=c, python=python)
