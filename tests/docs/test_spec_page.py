"""The reference page of the spec language follows from the schemas."""

from __future__ import annotations

import json
import re
from importlib import resources
from pathlib import Path

import pytest
from codewheel.language.language_page import spec_page

PAGE = Path(__file__).parents[2] / "docs/transcribe/spec-language.md"


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == spec_page(), "the schemas have changed; run: make spec-page"


@pytest.mark.slow
def test_every_key_is_explained() -> None:
    schema = json.loads((resources.files("codewheel.language") / "device.schema.json").read_text(encoding="utf-8"))
    page = spec_page()
    for name, shape in schema["$defs"].items():
        assert f'<a id="{name}"></a>' in page
        for key in shape.get("properties", {}):
            assert re.search(rf"^\| `{key}` \|.*\| [^|]+ \|$", page, re.MULTILINE), f"{name}.{key}"


def test_links_resolve() -> None:
    page = spec_page()
    anchors = set(re.findall(r'<a id="([^"]+)"></a>', page))
    assert set(re.findall(r"\]\(#([^)]+)\)", page)) <= anchors
