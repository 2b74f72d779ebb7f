"""The figures of ``benchmarks/house.py``, each counted in a made-up tree in which anybody can check the number."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import dedent

import pytest
from figures.functions import functions
from figures.imports import cycles, graph, packages
from figures.kinds import comparisons
from figures.reading import searches
from figures.sizes import is_real, lines_without_docstrings, statements_of
from figures.statements import Printed, by_output, printed, statements
from figures.tree import Checkout, Source, unpack
from house import Figure, lists, table

ROOT = Path(__file__).resolve().parents[1]

Made = Callable[[Mapping[str, str]], Checkout]


@pytest.fixture
def made(tmp_path: Path) -> Made:
    """Write files, and return them as a checkout."""

    def write(files: Mapping[str, str]) -> Checkout:
        for path, text in files.items():
            place = tmp_path / path
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(dedent(text), encoding="utf-8")
        return Checkout(tmp_path)

    return write


def test_cycles_take_type_imports_and_late_ones_into_account(made: Made) -> None:
    checkout = made(
        {
            "generator/__init__.py": "",
            "generator/a.py": "if TYPE_CHECKING:\n    from .room.b import B\n",
            "generator/room/__init__.py": "from .b import B\n",
            "generator/room/b.py": "from . import c\n",
            "generator/room/c.py": "def late():\n    import codewheel.a\n",
            "generator/room/d.py": "from . import c, Name\nfrom ..a import X\nimport json\n",
        }
    )
    arrows = graph(checkout.modules)
    assert arrows["room.d"] == {"a", "room", "room.c"}
    assert arrows["room"] == {"room.b"}
    assert arrows["room.b"] == {"room.c"}
    assert cycles(arrows) == [["a", "room.b", "room.c"]]
    assert cycles(packages(arrows)) == [["a", "room"]]


def test_no_circle(made: Made) -> None:
    checkout = made({"generator/a.py": "from .b import B\n", "generator/b.py": "from codewheel import a_name\n"})
    assert cycles(graph(checkout.modules)) == []


def test_modules_lines_and_size(made: Made) -> None:
    checkout = made(
        {
            "generator/__init__.py": "",
            "generator/__main__.py": "",
            "generator/render.py": "a = 1\n",
            "generator/targets/__init__.py": "\n\n",
            "generator/targets/c/files.py": "b\n",
            "generator/targets/c_codec.py": "b\nc\n",
            "generator/targets/python.py": "b\n",
            "templates/c/device.h.jinja": "{{ a }}\n\n",
            "templates/c/notes.txt": "not counted",
            "generator/__pycache__/old.py": "not counted",
        }
    )
    assert checkout.flat_modules() == ["render"]
    assert checkout.lines_of_targets() == Counter({"c": 3, "shared": 2, "python": 1})
    assert checkout.lines_of_templates() == Counter({"c": 2})
    assert checkout.size() == len("a=1" + "b" + "bc" + "b" + "{{a}}")


def test_lines_that_are_too_wide(made: Made) -> None:
    wide, fits = "x" * 121, "x" * 120
    checkout = made({"generator/a.py": f"{fits}\n{wide}\n", "templates/c/b.jinja": wide, "specs/c.yaml": wide})
    assert list(checkout.wide_lines()) == ["generator/a.py:2", "templates/c/b.jinja:1"]


BRANCHED = '''
    def plain():
        """Does nothing."""

    def branched(items):
        assert items
        for item in items:
            if item and item.a and item.b:
                continue
            elif item:
                break
        else:
            return [x for x in items if x]
        try:
            return 1 if items else 2
        except ValueError:
            def inner():
                return 1 or 2
            return inner

    class A:
        def matched(self, item):
            match item:
                case 1 | 2:
                    return lambda: 3
                case int():
                    return 4
                case _:
                    return 5
'''


def test_functions(made: Made) -> None:
    found = {item.name: item for item in functions(made({"generator/a.py": BRANCHED}).modules)}
    assert {name: item.complexity for name, item in found.items()} == {
        "plain": 1,
        # assert, for and its else, if with two times 'and', elif, a comprehension with its condition, 'if else', except
        "branched": 1 + 1 + 2 + 3 + 1 + 2 + 1 + 1,
        "inner": 2,
        "matched": 3,
    }
    assert [found["plain"].lines, found["inner"].lines, found["matched"].lines] == [2, 2, 8]
    assert [name for name, item in found.items() if item.has_docstring] == ["plain"]
    assert found["plain"].place == "generator/a.py:2"


KINDS = """
    if field.kind == "flag" or "flag" != self.field.kind:
        step.do in ("read", "write")
    match field.kind:
        case "crc" | "parity":
            pass
        case "number":
            pass
        case other:
            pass
    token.style == "'"
    kind == "device"
    raw["kind"] == "device"
    field.name == "flag"
    field.kind == other.kind
    field.kind in {}
"""


def test_comparisons_of_kinds(made: Made) -> None:
    template = '{% if c.carried_as == "bits" and c.name == "bits" %}\n{{ "a" if f.kind in ("ssi", "biss") }}{% endif %}'
    checkout = made({"generator/a.py": KINDS, "templates/c/b.jinja": template})
    found = [(item.place, item.attribute) for item in comparisons(checkout)]
    assert found == [
        ("generator/a.py:2", "kind"),
        ("generator/a.py:2", "kind"),
        ("generator/a.py:3", "do"),
        ("generator/a.py:5", "kind"),
        ("generator/a.py:7", "kind"),
        ("templates/c/b.jinja:1", "carried_as"),
        ("templates/c/b.jinja:2", "kind"),
    ]


LOOKS = r"""
    def needs_variant(code) -> bool:
        return re.search(r"\bvariant\b", code) is not None

    def in_words(name) -> bool:
        return name.replace("_", " ") == "a b"

    def build(code, name, kind):
        if needs_variant(code) or in_words(name):
            return code.replace("x", "y").removeprefix("(")
        if kind == "uint8_t" or kind == "number":
            return "variant" in code
        return replace(code, text="") if code in ("a", "b") else code.upper()
"""


def test_places_that_read_back(made: Made) -> None:
    template = '{% if "in->" not in c.puts | join %}\n{{ c.text.startswith("a") }}{{ c.text | replace("a", "b") }}\n'
    template += '{% if c.kind == "bits" or a in b or "variant" in c.bits %}{% endif %}{% endif %}'
    checkout = made(
        {
            "generator/targets/c/a.py": LOOKS,
            "generator/targets/docs/a.py": LOOKS,
            "generator/say/a.py": LOOKS,
            "templates/c/b.jinja": template,
            "templates/markdown/b.jinja": template,
        }
    )
    found = searches(checkout)
    assert [(item.place, item.function) for item in found if not item.reason] == [
        ("generator/targets/c/a.py:3", "needs_variant"),
        ("generator/targets/c/a.py:9", "build"),
        ("generator/targets/c/a.py:10", "build"),
        ("generator/targets/c/a.py:11", "build"),
        ("generator/targets/c/a.py:12", "build"),
        ("templates/c/b.jinja:1", ""),
        ("templates/c/b.jinja:2", ""),
        ("templates/c/b.jinja:2", ""),
        ("templates/c/b.jinja:3", ""),
    ]
    assert [(item.place, item.reason) for item in found if item.reason] == [
        ("generator/targets/c/a.py:6", "a name of the spec in words, or as a name of another sort")
    ]


def test_modules_of_a_target_that_lie_flat_are_read(made: Made) -> None:
    checkout = made({"generator/targets/c_codec.py": LOOKS, "generator/targets/docs.py": LOOKS})
    assert {item.place.partition(":")[0] for item in searches(checkout)} == {"generator/targets/c_codec.py"}


def file_of(marked: str) -> Printed:
    """Return a file whose text between « and » is from Python, and the rest from a template."""
    text, origin, now = "", "", "t"
    for letter in dedent(marked):
        if letter in "«»":
            now = "p" if letter == "«" else "t"
        else:
            text, origin = text + letter, origin + now
    return Printed(text, origin)


C = """
    /* A comment; «with a statement;» */
    #define MACRO(x) do { «x»; } while (0)
    #ifdef __cplusplus
    extern "C" {
    #endif
    typedef struct frame {
        «uint8_t a;»
    } frame;
    static const uint8_t «values[2] = {1, 2}»;
    static inline int «first»(int a, char b)
    {
        static const uint8_t entries[2] = {
            {«1, 2»}, {«f(1), 2,»},
        };
        «if (a > 1)» {
            return «a»;
        } else {
            «out->x = a»; /* x; */
        }
        for (int i = 0; i < 2; i++) { call("};", «b»); }
        switch (a) {
        case «1»:
            return OK;
        default:
            break;
        }
    #if A
        «a = b
            + c»;
    #endif
        «done()»;
    }
    #ifdef __cplusplus
    }
    #endif
"""


def test_statements_of_c() -> None:
    found = [(item.line, item.origin) for item in statements("a.h", file_of(C))]
    assert found == [
        (16, "Python"),
        (17, "mixed"),
        (18, "template"),
        (19, "Python"),
        (21, "template"),
        (21, "mixed"),
        (22, "template"),
        (23, "mixed"),
        (24, "template"),
        (25, "template"),
        (26, "template"),
        (29, "Python"),
        (32, "Python"),
    ]


PYTHON = '''
    """«A docstring.»"""
    from «a» import b
    VALUES = («1, 2»)

    class A:
        «x: int = 1»

        def first(self, «x»: int) -> int:
            """«A docstring.»"""
            «if x:  # »a comment
                return "é", «x»; «y»
            «else»:
                «y = 1»  # a comment
            for i in «x»:
                «y = [
                    1,
                ]»

                def inner():
                    «return y»
            return y
'''


def test_statements_of_python() -> None:
    found = [(item.line, item.origin) for item in statements("a.py", file_of(PYTHON))]
    assert found == [
        (11, "Python"),
        (12, "mixed"),
        (12, "Python"),
        (14, "Python"),
        (15, "mixed"),
        (16, "Python"),
        (20, "template"),
        (21, "Python"),
        (22, "template"),
    ]


GENERATOR = """
    import sys
    from pathlib import Path
    from jinja2 import Environment, FileSystemBytecodeCache, PackageLoader

    def indented(text):
        return "\\n".join("    " + line for line in text.splitlines())

    assert sys.argv[1] == "generate"
    folder = Path(sys.argv[sys.argv.index("-o") + 1])
    folder.mkdir()
    loader, cache = PackageLoader("codewheel.templates", "c"), FileSystemBytecodeCache(str(folder.parent))
    made = Environment(loader=loader, bytecode_cache=cache, keep_trailing_newline=True)
    made.filters["indented"] = indented
    values = {"line": "out->a = b[0];", "name": "a", "lines": ["a = 1;", "b = 2;"], "kind": "bits", "terms": ["a", "b"]}
    for name in ("device.h", "encoder.h"):
        text = made.get_template(f"{name}.jinja").render(values)
        (folder / name).write_text(text.rstrip() + "\\n", encoding="utf-8")
    assert not list(folder.parent.glob("*.cache"))
"""

DEVICE = """
    {%- macro statement(name) %}out->{{ name }} = 1;{% endmacro -%}
    {% macro read() %}value = read();{% endmacro -%}
    {% set body %}
    {{ line }}
    {{ statement(name) | indented }}
    {{ read() | indented | trim }}
    {{ ("if (" ~ name ~ " > 1) {") | indented }}
    }
    {{ lines | join("\\n") }}
    {{ terms | join(" + ") }};
    {{ "%s = call();" % name }}
    {{ "done();" if kind == "bits" else "failed();" }}
    {{ line | replace("a", "b") }}
    {{ read() | replace("read", "load") }}
    return {{ name }};
    return;
    {% endset -%}
    int f(void) {
    {{ body.strip() }}
    }
"""


@pytest.mark.slow
def test_the_origin_of_letters_survives_templates(made: Made) -> None:
    checkout = made(
        {
            "generator/__init__.py": "",
            "generator/__main__.py": GENERATOR,
            "templates/__init__.py": "",
            "templates/c/device.h.jinja": DEVICE,
            "templates/c/encoder.h.jinja": "int f(void) { return 1; }\n",
            "specs/device.yaml": "",
        }
    )
    files = printed(checkout)
    found = statements("device.h", files["device.h"])
    assert [item.origin for item in found] == [
        "Python",
        "mixed",
        "template",
        "mixed",
        "Python",
        "Python",
        "mixed",
        "mixed",
        "template",
        "Python",
        "Python",  # Filters that change letters lose their origin.
        "mixed",
        "template",
    ]
    counts = by_output(checkout, files)
    assert Counter(item.origin for item in counts["C, families"]) == {"Python": 5, "mixed": 5, "template": 3}
    assert [(item.origin, item.letters, item.from_python) for item in counts["C, shared by all"]] == [
        ("template", len("return1"), 0)
    ]


def test_copied_runtime_is_not_counted_by_origin(made: Made) -> None:
    text = "int f(void) { return 1; }\n"
    checkout = made({"runtime/c/bits.h": text, "specs/device.yaml": ""})
    files = {"c/bits.h": Printed(text, "p" * len(text)), "c/device.h": Printed(text + text, "p" * 2 * len(text))}
    counts = by_output(checkout, files)
    assert (len(counts["C, families"]), len(counts["C, shared by all"])) == (2, 0)


def test_sizes_are_counted_by_what_a_reader_has_to_know() -> None:
    """Count each statement, no docstring, and every other line. A template has tags in 3 % of its lines,
    and not only the manufacturer's prefix in them."""
    source = Source(
        "a.py", '"""About\n\nit."""\n\nx = 1; y = 2\n\n\ndef f():\n    """Do."""\n    if x:\n        return\n'
    )
    assert statements_of(source) == 5
    assert lines_without_docstrings(source) == 7
    plain = "int x;\n" * 32
    tags = ("", "{# no tag #}\n", "{{ prefix }}\n", "{{ prefix ~ (name | text) }}\n")
    assert [is_real(Source("a.jinja", plain + added)) for added in tags] == [False, False, False, True]


@pytest.mark.slow
def test_the_origin_of_letters_survives_a_formatter(made: Made) -> None:
    """Filter that breaks lines, adds commas and wraps comments, as targets do with the output of templates."""
    template = "/* About {{ name }}. */\nint f(void) { return call({{ name }}, done, {{ terms | join('+') }}); }\n"
    layout = '.replace("call(", "call(\\n    ").replace(" done,", "\\n    done,\\n   ").replace("About", "About\\n * ")'
    checkout = made(
        {
            "generator/__init__.py": "",
            "generator/__main__.py": GENERATOR.replace("text.rstrip()", f"text{layout}.rstrip()"),
            "templates/__init__.py": "",
            "templates/c/device.h.jinja": template,
            "templates/c/encoder.h.jinja": "",
            "specs/device.yaml": "",
        }
    )
    file = printed(checkout)["device.h"]
    assert file.text.splitlines()[2:] == ["int f(void) { return call(", "    a,", "    done,", "    a+b); }"]
    code = file.text.index("int f")
    kept = [item for item in zip(file.text, file.origin, strict=True) if item[0] not in " \n(),"]
    of_python = [letter for letter, origin in kept[len("".join(file.text[:code].split())) :] if origin == "p"]
    assert of_python == ["a", "a", "b"]
    assert [item.origin for item in statements("device.h", file)] == ["mixed"]


@pytest.mark.slow
def test_a_checkout_that_generates_nothing(made: Made) -> None:
    checkout = made({"generator/__init__.py": "", "generator/__main__.py": "raise SystemExit('no specs')"})
    with pytest.raises(RuntimeError, match="no specs"):
        printed(checkout)


@pytest.mark.slow
def test_tracing_changes_no_output(tmp_path: Path) -> None:
    """A short spec shows it. A family of a manual takes minutes, because every character is followed."""
    checkout, plain = tmp_path / "checkout", tmp_path / "plain"
    (checkout / "specs").mkdir(parents=True)
    for name in ("generator", "templates", "runtime"):
        (checkout / name).symlink_to(ROOT / name)
    (checkout / "specs" / "masters").symlink_to(ROOT / "specs" / "masters")
    for name in ("manufacturer.yaml", "words.yaml"):
        (checkout / "specs" / name).symlink_to(ROOT / "tests" / "specs" / name)
    command = [sys.executable, "-m", "codewheel", "generate", "specs", "-o", str(plain), "--no-cache"]
    subprocess.run([*command, "--target", "c", "--target", "python"], cwd=checkout, check=True, capture_output=True)
    files = printed(Checkout(checkout))
    ours = {path for path in files if "words" in path}
    assert {Path(path).suffix for path in ours} == {".h", ".py"}
    for path, file in files.items():
        assert file.text == (plain / path).read_text(encoding="utf-8"), path
        assert len(file.origin) == len(file.text), path
    for path in ours:
        assert set(files[path].origin) == {"t", "p"}, path


@pytest.mark.slow
def test_a_commit_is_measured_in_a_folder_of_its_own(made: Made, tmp_path: Path) -> None:
    repository = made({"old/generator/a.py": "a = 1\n"}).root / "old"
    git = ["git", "-C", str(repository), "-c", "user.name=a", "-c", "user.email=a@example.org"]
    for command in (["init", "--quiet"], ["add", "."], ["commit", "--quiet", "-m", "a"]):
        subprocess.run([*git, *command], check=True)
    (repository / "generator" / "a.py").write_text("changed = 1\n")
    assert unpack(repository, "HEAD", tmp_path / "new").modules[0].text == "a = 1\n"
    with pytest.raises(LookupError, match="no_such_commit"):
        unpack(repository, "no_such_commit", tmp_path / "none")


def test_the_table_sets_commits_side_by_side() -> None:
    before, now = [Figure("a", "1")], [Figure("a", "2", ["x:1"]), Figure("b", "3")]
    assert list(table({"abc": before, "here": now})) == [
        "| | abc | here |",
        "|---|---|---|",
        "| a | 1 | 2 |",
        "| b | – | 3 |",
    ]
    assert list(lists(now)) == ["", "### a", "", "- `x:1`"]
