"""A user's templates cannot leave the sandbox or run endlessly, and give the same text as without a sandbox."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from codewheel import environments, sandbox
from codewheel.render import Templates
from codewheel.template_fault import TemplateFault

Render = Callable[..., str]


class Thing:
    """A value of ours."""

    name = "thing"
    path = Path("secret")
    kind = Path
    module = sys

    def upper(self) -> str:
        return "THING"


@pytest.fixture
def rendered(tmp_path: Path) -> Render:
    (tmp_path / "ours").mkdir()
    (tmp_path / "own").mkdir()
    (tmp_path / "ours/x.jinja").write_text("shipped {{ thing.name }}")
    templates = Templates(tmp_path / "ours", filters={"hex": hex})
    values = {"thing": Thing(), "things": [Thing()], "numbers": list(range(200))}

    def rendered(text: str, name: str = "x.jinja") -> str:
        (tmp_path / "own" / name).write_text(text)
        environments.environment.cache_clear()
        environments.own_loader.cache_clear()
        return templates.render("x.jinja", values, tmp_path / "own")

    return rendered


def refused(rendered: Render, tmp_path: Path, text: str) -> str:
    with pytest.raises(TemplateFault) as caught:
        rendered(text)
    place, _, said = str(caught.value).partition(": ")
    assert place == f"{tmp_path}/own/x.jinja:1"
    assert "\n" not in said
    return said


@pytest.mark.parametrize(
    "text",
    [
        '{{ cycler.__init__.__globals__.os.popen("touch " ~ "ran").read() }}',
        '{{ cycler["__init__"] }}',
        "{{ thing.__class__ }}",
        '{{ thing["__class__"] }}',
        '{{ thing|attr("__class__") }}',
        '{{ (things|map(attribute="__class__")|first).x }}',
        '{{ (things|map("attr", "__class__")|first).x }}',
        '{{ (things|groupby("__class__")|first).grouper.x }}',
        '{{ "{0.__class__}".format(thing) }}',
        '{{ ("{0.__class__}"|attr("format"))(thing) }}',
        '{{ (["{0.__class__}"]|map(attribute="format")|first)(thing) }}',
        '{{ "{t.__class__}".format_map({"t": thing}) }}',
        "{{ thing.upper.__func__ }}",
        "{{ thing.upper.__globals__ }}",
        "{{ (thing for thing in things).gi_frame }}",
        "{{ self.__init__ }}",
        "{{ self._TemplateReference__context }}",
        "{{ joiner.__base__ }}",
        "{{ thing.path.read_text() }}",
        "{{ thing.path.parent }}",
        '{{ thing.kind("elsewhere") }}{{ thing.kind.cwd() }}',
        "{{ thing.module.modules }}",
        "{{ things.append(1) }}",
        "{{ lipsum(100) }}",
        "{% macro m() %}{% endmacro %}{{ m.__call__ }}",
    ],
)
def test_there_is_no_way_out(rendered: Render, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.chdir(tmp_path)
    refused(rendered, tmp_path, text)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ours", "own"]


STEPS = "the template takes more than 20000 steps for one file; look for an endless loop"
LONG = "the result of '*' is longer than 10000000"
BITS = "has more than 100000 bits"
LENGTH = "a length is above 10000"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{% for i in range(10**9) %}{% endfor %}", "OverflowError: Range too big."),
        ("{% for i in range(999) %}{% for j in range(999) %}{% endfor %}{% endfor %}", STEPS),
        ("{% for a in numbers %}{% for b in numbers %}{% endfor %}{% endfor %}", STEPS),
        ("{% macro f(n) %}{% if n %}{{ f(n - 1) }}{{ f(n - 1) }}{% endif %}{% endmacro %}{{ f(99) }}", STEPS),
        ("{% for i in [9] recursive %}{% if i %}{{ loop([i - 1] * 9) }}{% endif %}{% endfor %}", STEPS),
        ('{% for i in range(999) %}{% include "shipped/x.jinja" %}{{ range(99)|map("abs")|sum }}{% endfor %}', STEPS),
        ("{% for i in range(999) %}{{ range(99)|map('abs')|sum }}{% endfor %}", STEPS),
        ("{% set n = namespace(x='x') %}{% for i in range(99) %}{% set n.x = n.x ~ n.x %}{% endfor %}", STEPS),
        ("{% set n = namespace(x='x') %}{% for i in range(99) %}{% set n.x = n.x + n.x %}{% endfor %}", STEPS),
        ("{% set n = namespace(x=[1]) %}{% for i in range(99) %}{% set n.x = n.x + n.x %}{% endfor %}", STEPS),
        ("{% set x = 'x' * 99999 %}" + "{% set x %}{{ x }}{{ x }}{% endset %}" * 9, STEPS),
        ("{% macro d(s) %}{{ s }}{{ s }}{% endmacro %}{{ " + "d(" * 30 + "'x'" + ")" * 30 + " }}", STEPS),
        ("{{ 'x' * 10**10 }}", LONG),
        ("{{ 10**10 * 'x' }}", LONG),
        ("{{ [0] * 10**10 }}", LONG),
        ("{{ (9, 9) * 10**10 }}", LONG),
        ("{{ 10**(10**9) }}", f"the result of '**' {BITS}"),
        ("{{ (2**40000) * (2**40000) * (2**40000) }}", f"the result of '*' {BITS}"),
        ("{{ 'x'|center(10**9) }}", LENGTH),
        ("{{ 'x'|indent(width=10**9) }}", LENGTH),
        ("{{ 1|round(-10**9) }}", LENGTH),
        ("{{ [1]|batch(10**9, 'x')|list }}", LENGTH),
        ("{{ [1]|slice(10**9)|list }}", LENGTH),
    ],
)
def test_work_has_bounds(
    rendered: Render, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, said: str
) -> None:
    monkeypatch.setattr(sandbox, "MOST_STEPS", 20_000)
    assert refused(rendered, tmp_path, text).startswith(said)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory of a process")
@pytest.mark.parametrize(
    "text",
    [
        "{{ 'x'.center(2 * 10**9) }}",
        "{{ '%2000000000d' % 1 }}",
        "{{ '{:>{}}'.format(1, 2 * 10**9) }}",
        "{{ ('x' * 20000).replace('x', 'y' * 100000) }}",
    ],
)
def test_memory_has_bounds(rendered: Render, tmp_path: Path, text: str) -> None:
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    assert refused(rendered, tmp_path, text) == "the template uses too much memory"
    assert resource.getrlimit(resource.RLIMIT_AS) == before


@pytest.mark.parametrize(
    ("text", "made"),
    [
        ('{% include "shipped/x.jinja" %}!', "shipped thing!"),
        ("{{ thing.upper() }} {{ 2**64 }} {{ (2**64)|hex }} {{ nothing|default('x') }}", f"THING {2**64} {2**64:#x} x"),
        (
            "{% for a in 'ab' %}{{ loop.index }}/{{ loop.length }}{{ a }}{{ ',' if not loop.last }}{% endfor %}",
            "1/2a,2/2b",
        ),
        ("{% for a in [[[]], []] recursive %}<{{ loop(a) }}>{% endfor %}", "<<>><>"),
        ("{{ range(5)|map('string')|join('-') }}{{ ' ' ~ 1 ~ 'x' }}{{ '%03d' % 7 }}", "0-1-2-3-4 1x007"),
        ("{% set x %}a{{ 1 }}{% endset %}{{ x|upper }}{{ 'x'|center(5) }}", "A1  x  "),
        ("{% set n = namespace(i=0) %}{% for _ in range(9) %}{% set n.i = n.i + 2 %}{% endfor %}{{ n.i }}", "18"),
    ],
)
def test_what_templates_do_still_works(rendered: Render, text: str, made: str) -> None:
    assert rendered(text) == made


def test_each_file_has_bounds_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox, "MOST_STEPS", 3_000)
    (tmp_path / "x.jinja").write_text("{% for i in range(900) %}{% endfor %}")
    templates = Templates(tmp_path)
    assert [templates.render("x.jinja", {}, tmp_path) for _ in range(3)] == ["", "", ""]


def test_text_that_a_loop_repeats_has_bounds(rendered: Render, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox, "MOST_STEPS", 20_000)
    with pytest.raises(TemplateFault, match="takes more than 20000 steps"):
        rendered("{% for i in range(99) %}" + "x" * 99_999 + "{% endfor %}")


def test_a_link_out_of_the_folder_is_not_followed(rendered: Render, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("precious")
    (tmp_path / "own/link").symlink_to(tmp_path / "secret")
    with pytest.raises(TemplateFault, match=r"own/link: this path is outside the folder of templates$"):
        rendered('{% include "link" %}')
    with pytest.raises(TemplateFault, match=r"secret: this path is outside the folder of templates$"):
        rendered('{% include "../secret" %}')


def test_code_compiled_outside_the_sandbox_is_not_used_in_it(
    rendered: Render, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is the same, so a cache shared by both would find its name and content."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "compiled"))
    text = "{{ 2**40000 * 2**40000 * 2**40000 % 7 }}"
    (tmp_path / "own/x.jinja").write_text(text)
    assert Templates(tmp_path / "own").render("x.jinja", {}, None) == str(2**120000 % 7)
    assert "more than 100000 bits" in refused(rendered, tmp_path, text)
