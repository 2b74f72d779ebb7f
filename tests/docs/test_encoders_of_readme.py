"""The table of encoders on the front page has every family of ``specs/``, with its interfaces and its grade."""

from __future__ import annotations

import re
from pathlib import Path

from codewheel.targets import Library

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def test_it_lists_every_encoder_by_manufacturer(every_encoder: Library) -> None:
    """Each row has the families of one manufacturer with links, and their interfaces."""
    rows = re.findall(r"^\| ([^|]+) \| (\[[^|]+) \| ([^|]+) \|$", README, re.MULTILINE)
    listed = {
        manufacturer: (set(re.findall(r"/(\w+)\.(?:yaml|md)\)", links)), set(interfaces.split(", ")))
        for manufacturer, links, interfaces in rows
    }
    families: dict[str, tuple[set[str], set[str]]] = {}
    for device in every_encoder.devices:
        names, interfaces = families.setdefault(device.manufacturer.title, (set(), set()))
        names.add(device.name)
        interfaces.update(interface.title for interface in device.interfaces)
    assert listed == families
    assert [row[0] for row in rows] == sorted(listed, key=str.lower)


def test_its_grades_match_the_specs(every_encoder: Library) -> None:
    """The line below the table says which families are from the manual or quoted. An asterisk marks the weakest."""
    assert (
        "`manual` for Lika, `quoted` for iC-MU, `uncorroborated` for \\*, `corroborated` for all others."
        in " ".join(README.split())
    )
    marked = set(re.findall(r"/(\w+)\.(?:yaml|md)\)\\\*", README))
    for device in every_encoder.devices:
        grade = device.evidence.grade.partition(",")[0]
        assert (grade == "manual") == (device.manufacturer.name == "lika"), device.name
        assert (grade == "quoted") == (device.name == "icmu"), device.name
        assert (grade == "uncorroborated") == (device.name in marked), device.name
