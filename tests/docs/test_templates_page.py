"""The example of the page about templates works, and each template begins with its description."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from codewheel import environments
from codewheel.commands.cli import main

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/extend/templates.md"


def test_each_template_begins_with_a_comment() -> None:
    templates = [*(ROOT / "templates").rglob("*.jinja"), *(ROOT / "examples").rglob("*.jinja")]
    bare_templates = [path for path in templates if not re.match(r"\{#-? \w", path.read_text(encoding="utf-8"))]
    assert bare_templates == []


@pytest.mark.slow
def test_its_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    page = PAGE.read_text(encoding="utf-8")
    template = re.search(r"`(house/\S+)`:\n\n```jinja\n(.*?)```", page, re.DOTALL)
    command, ending = re.findall(r"\n\n```\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    generated = re.search(r"`(generated/\S+)` now ends with", page)
    assert template is not None
    assert generated is not None
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my_encoder"]) == 0
    place = tmp_path / template[1]
    place.parent.mkdir(parents=True)
    place.write_text(template[2], encoding="utf-8")
    assert main(shlex.split(command)[1:]) == 0, capsys.readouterr().err
    assert (tmp_path / generated[1]).read_text(encoding="utf-8").endswith(f"\n\n{ending}")
    environments.environment.cache_clear()
    environments.own_loader.cache_clear()
