"""The page of templates follows from the targets, is complete, and its example works."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, TypedDict, get_type_hints

import pytest
from codewheel import environments
from codewheel.commands.cli import main
from codewheel.render import Templates
from codewheel.targets import Library
from codewheel.targets.registry import BUILT_IN, load_target
from codewheel.targets.templates_page import faults, templates_page

PAGE = Path(__file__).parents[2] / "docs" / "templates.md"


@pytest.mark.slow
def test_the_page_is_up_to_date() -> None:
    made = templates_page(map(load_target, BUILT_IN))
    assert PAGE.read_text(encoding="utf-8") == made, "templates or their values have changed; run: make templates-page"


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT_IN)
def test_it_tells_the_whole_truth(name: str) -> None:
    templates = load_target(name).templates
    assert templates is not None
    assert list(faults(templates)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT_IN)
def test_templates_get_the_values_that_it_names(name: str, library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    rendered: dict[str, set[str]] = {}
    render_ = Templates.render

    def noted(self: Templates, template: str, values: Mapping[str, object], own: Path | None) -> str:
        rendered[template] = set(values)
        return render_(self, template, values, own)

    monkeypatch.setattr(Templates, "render", noted)
    target = load_target(name)
    assert target.templates is not None
    assert target.files(library, {})
    assert rendered == {item: set(get_type_hints(shape)) for item, shape in target.templates.values.items()}


def test_it_names_every_template_filter_and_value() -> None:
    page = PAGE.read_text(encoding="utf-8")
    for name in BUILT_IN:
        templates = load_target(name).templates
        assert templates is not None
        section = page.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        values = {key for shape in templates.values.values() for key in get_type_hints(shape)}
        for item in (*templates.names, *templates.filters, *templates.functions, *values):
            assert re.search(rf"^\| `{re.escape(item)}[`(]", section, re.MULTILINE), f"{name}: {item}"


class Values(TypedDict):
    known: Annotated[str, "a line"]
    bare: str


def test_every_gap_is_told(tmp_path: Path) -> None:
    (tmp_path / "a.jinja").write_text(
        "{# A. #}\n{% set own = 1 %}{{ known }}{{ own }}{{ lost }}{{ range(3) }}{{ f() }}"
    )
    (tmp_path / "b.jinja").write_text("no comment")
    templates = Templates(tmp_path, {"a.jinja": Values}, {"g": lambda text: text}, {"f": lambda: ""})
    assert list(faults(templates)) == [
        "a.jinja uses 'lost', which Values lacks",
        "Values.bare has no line",
        "no template uses the value 'bare'",
        "no template uses b.jinja",
        "b.jinja does not begin with a comment that describes it",
        "'g' has no docstring",
        "'f' has no docstring",
    ]


@pytest.mark.slow
def test_its_example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    page = PAGE.read_text(encoding="utf-8")
    template = re.search(r"`(house/\S+)`:\n\n```jinja\n(.*?)```", page, re.DOTALL)
    command, ending = re.findall(r"\n\n```\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    made = re.search(r"`(generated/\S+)` now ends with", page)
    assert template is not None
    assert made is not None
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my_encoder"]) == 0
    place = tmp_path / template[1]
    place.parent.mkdir(parents=True)
    place.write_text(template[2], encoding="utf-8")
    assert main(shlex.split(command)[1:]) == 0, capsys.readouterr().err
    assert (tmp_path / made[1]).read_text(encoding="utf-8").endswith(f"\n\n{ending}")
    environments.environment.cache_clear()
    environments.own_loader.cache_clear()
