"""What a page says of other editions of the manual."""

from __future__ import annotations

from typing import Annotated, TypedDict

from ...model import Device
from ...say.markdown import code, link, text
from ...say.origin import edition_test
from ...say.text import Said


class EditionRows(TypedDict):
    edition_rows: Annotated[list[tuple[str, ...]], "the editions that can be asked for, and what is otherwise in them"]
    edition_tests: Annotated[list[Said], "registers that tell an encoder of an older edition"]


def rows_and_tests(device: Device) -> EditionRows:
    """What is otherwise in other editions, by the revision that changed it, and what tells an older encoder."""

    def links(name: str) -> str:
        found = (item.name for item in device.errata if item.edition == name)
        return ", ".join(link(code(item), f"#erratum-{item}") for item in found)

    rows: list[tuple[str, ...]] = [
        (text(name), item.date, links(f"before {name}"), links(name), ", ".join(map(code, item.labels)))
        for item in device.editions
        for name in [item.revision]
    ]
    tests = [edition_test(item.revision, test) for item in device.editions for test in item.tests]
    return {"edition_rows": rows, "edition_tests": tests}
