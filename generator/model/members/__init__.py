"""The table of members: each member of each part of the model, described once.

The JSON Schema and the XML Schema of the data, the data themselves, the comparison of two versions by ``diff`` and the
comparison of two readings by ``check`` follow from this table.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..keys_and_members import WIDER, ModelMember, ModelPart
from .family_and_manual import FAMILY, IDENTITY, SURROUNDINGS
from .frames import FRAMES
from .interfaces_and_registers import INTERFACES, REGISTERS

__all__ = ["FAMILY", "PARTS", "PARTS_BY_CLASS", "WIDER", "ModelMember", "ModelPart"]

#: Every part of the data except the family itself.
PARTS = (*IDENTITY, *INTERFACES, *FRAMES, *REGISTERS, *SURROUNDINGS)
#: The part for each class of the model.
PARTS_BY_CLASS: Mapping[str, ModelPart] = MappingProxyType({name: part for part in PARTS for name in part.classes})
