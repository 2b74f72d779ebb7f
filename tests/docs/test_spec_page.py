"""The reference pages of the spec language follow from the schemas."""

from __future__ import annotations

import json
import re
from importlib import resources
from pathlib import Path

import pytest
from codewheel.language.language_page import spec_pages

FOLDER = Path(__file__).parents[2] / "docs/transcribe"


def test_the_pages_are_up_to_date() -> None:
    pages = {path.name: path.read_text(encoding="utf-8") for path in FOLDER.glob("spec-language*.md")}
    assert pages == spec_pages(), "the schemas have changed; run: make spec-page"


@pytest.mark.slow
def test_every_key_is_explained_once() -> None:
    schema = json.loads((resources.files("codewheel.language") / "device.schema.json").read_text(encoding="utf-8"))
    text = "".join(spec_pages().values())
    for name, shape in schema["$defs"].items():
        assert text.count(f'<a id="{name}"></a>') == 1, name
        for key in shape.get("properties", {}):
            assert re.search(rf"^\| `{key}` \|.*\| [^|]+ \|$", text, re.MULTILINE), f"{name}.{key}"


def test_links_resolve() -> None:
    pages = spec_pages()
    anchors = {f"{page}#{name}" for page, text in pages.items() for name in re.findall(r'<a id="([^"]+)"></a>', text)}
    links = {link for text in pages.values() for link in re.findall(r"\]\((spec-language[^)]*#[^)]+)\)", text)}
    assert links
    assert links <= anchors
