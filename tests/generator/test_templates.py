"""A user's templates: each of ours can be overridden, and errors and misspelt names are reported with their place."""

from __future__ import annotations

import marshal
import shutil
import sys
import tempfile
from collections.abc import Iterator
from importlib.util import cache_from_source
from pathlib import Path

import jinja2
import pytest
from codewheel import environments as module
from codewheel.commands.cli import main
from codewheel.loading.configuration import BUILT_IN
from codewheel.render import Templates
from codewheel.targets.registry import load_target
from exhaustive import exhaustive_if

ROOT = Path(__file__).resolve().parents[2]
INDEX = "docs/index.md.jinja"
#: Specs for templates that are used for RS-485 or BiSS encoders only.
SPEC_OF = {"poller.c.jinja": str(ROOT / "specs" / "lika" / "sma21.yaml")} | dict.fromkeys(
    (
        "idbiss.xml.jinja",
        "conf_set.jinja",
        "xcf.jinja",
        "c_struct.jinja",
        "c_registers.jinja",
        "soe_structure.jinja",
        "dmc.jinja",
    ),
    str(ROOT / "specs" / "lika" / "amm5.yaml"),
)
#: Files for one order code, because bulk files contain the result of a template several times.
OPTIONS = {"masters": ("--option", "masters.order-codes=each")}
#: Templates of outputs that an option selects.
OPTIONS_OF = {"single.h.jinja": ("--option", "c.form=single")}


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Iterator[Path]:
    """The current folder, with a spec and an empty folder ``t``."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", "demo"]) == 0
    for folder in BUILT_IN:
        (tmp_path / "t" / folder).mkdir(parents=True)
    capsys.readouterr()
    yield tmp_path
    module.environment.cache_clear()
    module.own_loader.cache_clear()


def generate(capsys: pytest.CaptureFixture[str], *arguments: str, spec: str = "demo.yaml") -> tuple[int, str]:
    code = main(["generate", spec, "--templates", "t", *arguments])
    return code, capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{{ nothing }}", "'nothing' is undefined"),
        ("{{ 1 / 0 }}", "ZeroDivisionError: division by zero"),
        ("{% for %}", "Expected an expression, got 'end of statement block'"),
        ('{% include "x" %}', "there is no template 'x'"),
        ('{% include "index.md.jinja" %}', "RecursionError: maximum recursion depth exceeded"),
        ("\udcff\udcfe", "not UTF-8; save the template as UTF-8"),
    ],
)
@pytest.mark.parametrize("template", [INDEX, "c/device.h.jinja", "python/device.py.jinja", "biss/idbiss.xml.jinja"])
def test_a_mistake_is_one_line(
    place: Path, capsys: pytest.CaptureFixture[str], template: str, text: str, message: str
) -> None:
    maker = place / "manufacturer.yaml"
    maker.write_text(maker.read_text().replace("# biss_id: 0x0000", "biss_id: 0x4142"))
    text = text.replace("index.md.jinja", Path(template).name)
    (place / "t" / template).write_bytes(b"first\n" + text.encode("utf-8", "surrogateescape"))
    of_target = ("--target", template.partition("/")[0]) if "/" in template else ()
    code, err = generate(capsys, *of_target, spec=SPEC_OF.get(Path(template).name, "demo.yaml"))
    assert code == 1
    assert err.startswith(f"codewheel: t/{template}:2: {message}")
    assert err.count("\n") == 1
    assert not (place / "generated").exists()


@pytest.mark.slow
def test_a_template_of_ours_that_misses_a_part_of_theirs(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "t/c/parts.h.jinja").write_text("{% macro section(title) %}{% endmacro %}")
    code, err = generate(capsys)
    assert code == 1
    assert "reports.h.jinja:" in err
    assert "does not export the requested name 'enumeration'" in err
    assert err.count("\n") == 1


@pytest.mark.slow
def test_what_is_no_text(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (place / "t" / INDEX).write_text(r'{{ "\ud800" }}')
    code, err = generate(capsys)
    assert (code, err) == (1, f"codewheel: t/{INDEX}: the text contains U+D800, which is not a character\n")


@pytest.mark.slow
def test_misspelt_and_misplaced_templates_are_told(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    misspelt = ("c/devce.h.jinja", "pythn/device.py.jinja", "device.h.jinja", "markdown/index.md.jinja", "docs/x.jinja")
    for name in (*misspelt, ".git/x.jinja", "c/README.txt"):
        (place / "t" / name).parent.mkdir(exist_ok=True)
        (place / "t" / name).write_text("")
    assert generate(capsys) == (
        2,
        (
            "codewheel: nothing written: these templates have no effect:\n"
            "  no output uses t/c/devce.h.jinja; did you mean 'c/device.h.jinja'?\n"
            "  no output uses t/device.h.jinja; did you mean 'c/device.h.jinja'?\n"
            "  no output uses t/docs/x.jinja\n"
            "  no output uses t/markdown/index.md.jinja; did you mean 'docs/index.md.jinja'?\n"
            "  no output uses t/pythn/device.py.jinja; did you mean 'python/device.py.jinja'?\n"
        ),
    )
    assert not (place / "generated").exists()


@pytest.mark.slow
def test_a_folder_without_templates_is_told(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, err = generate(capsys)
    assert code == 2
    assert "the folder t has no templates" in err


@pytest.mark.slow
def test_a_template_of_theirs_that_theirs_uses_is_fine(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ours = (ROOT / "templates/c/general_crcs.h.jinja").read_text(encoding="utf-8")
    shutil.copy(ROOT / "templates/c/parts.h.jinja", place / "t/c/mine.jinja")
    (place / "t/c/general_crcs.h.jinja").write_text(ours.replace('"parts.h.jinja"', '"mine.jinja"'), encoding="utf-8")
    assert generate(capsys, "--target", "c") == (0, "")
    assert generate(capsys, "--target", "docs") == (0, ""), "the templates of other targets are not judged"


@pytest.mark.slow
def test_line_ends_and_byte_order_marks_of_templates_do_not_matter(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["generate", "demo.yaml"]) == 0
    for path in (ROOT / "templates").glob("*/*.jinja"):
        text = path.read_text(encoding="utf-8").rstrip("\n") + "\n"
        (place / "t" / path.parent.name / path.name).write_text("\ufeff" + text, encoding="utf-8", newline="\r\n")
    assert generate(capsys, "--check") == (0, "")


@pytest.fixture
def compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A template, which is compiled anew whenever the test asks for it."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    (tmp_path / "x.jinja").write_text("{{ 6 * 7 }}", encoding="utf-8")
    yield tmp_path / "x.jinja"
    module.environment.cache_clear()


def text_of(template: Path) -> str:
    module.environment.cache_clear()
    return Templates(template.parent).render(template.name, {}, None)


def test_compiled_templates_are_next_to_their_sources(compiled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No code comes from the user's cache or from the folder for temporary files, which others may be able to write."""
    places = [compiled.parent / "cache", compiled.parent / "tmp"]
    for place in places:
        place.mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(places[0]))
    monkeypatch.setattr(tempfile, "tempdir", str(places[1]))
    assert text_of(compiled) == "42"
    assert [list(place.iterdir()) for place in places] == [[], []]
    kept = list((compiled.parent / "__pycache__").iterdir())
    assert kept == [Path(cache_from_source(str(compiled), optimization=""))]
    # The stored template is used only for the same text.
    with monkeypatch.context() as patch:
        patch.setattr(jinja2.Environment, "compile", None)
        assert text_of(compiled) == "42"
    compiled.write_text("{{ 6 * 8 }}", encoding="utf-8")
    assert text_of(compiled) == "48"


def test_a_damaged_compiled_template_is_compiled_again(compiled: Path) -> None:
    assert text_of(compiled) == "42"
    kept = Path(cache_from_source(str(compiled), optimization=""))
    content = kept.read_bytes()
    for damaged in (b"", content[:20], content[:40], content[:-5], content[:36] + marshal.dumps(5)):
        kept.write_bytes(damaged)
        assert text_of(compiled) == "42"
        assert kept.read_bytes() == content


def test_compiled_templates_that_cannot_be_written_are_done_without(
    compiled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (compiled.parent / "__pycache__").write_text("a file instead of a folder", encoding="utf-8")
    assert text_of(compiled) == "42"
    (compiled.parent / "__pycache__").unlink()
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert text_of(compiled) == "42"
    assert not (compiled.parent / "__pycache__").exists()


def templates_of(name: str) -> Templates:
    found = load_target(name).templates
    assert found is not None
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("target", "template"),
    exhaustive_if(
        lambda target, template: template != next(iter(templates_of(target).values)),
        [(target, template) for target in BUILT_IN for template in templates_of(target).values],
    ),
)
def test_every_rendered_template_can_be_overridden(
    place: Path, capsys: pytest.CaptureFixture[str], target: str, template: str
) -> None:
    """The user's template includes the one that it overrides, and adds a line."""
    maker = place / "manufacturer.yaml"
    maker.write_text(maker.read_text().replace("# biss_id: 0x0000", "biss_id: 0x4142"))
    spec = SPEC_OF.get(template, "demo.yaml")
    options = ("--target", target, *OPTIONS.get(target, ()), *OPTIONS_OF.get(template, ()))
    assert main(["generate", spec, *options]) == 0
    before = {path: path.read_text() for path in (place / "generated").rglob("*") if path.is_file()}
    mine = '{% include "shipped/' + template + '" %}\nmine\n'
    (place / "t" / target / template).write_text(mine)
    assert generate(capsys, *options, spec=spec) == (0, "")
    changed = {path for path, text in before.items() if path.read_text() != text}
    assert changed
    for path in changed:
        old, new = (text.rstrip("\n") for text in (before[path], path.read_text()))
        assert new.splitlines()[: len(old.splitlines())] == old.splitlines()
        assert new.endswith("mine")
