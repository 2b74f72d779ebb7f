"""Templates contain what differs between devices. All the rest is ordinary source in ``runtime``."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from codewheel.environments import environment
from codewheel.render import Templates
from codewheel.targets.registry import BUILT_IN, load_target
from jinja2 import Environment, meta, nodes

#: Lowest percentage of lines with an expression or a statement.
LEAST = 3
#: Values that are the same for every device of a run.
SAME = {"PREFIX", "distribution", "generation", "header", "maker", "option", "package", "prefix", "title", "version"}
#: Templates that are still allowed, and why.
ALLOWED = {
    # A page of text about the C headers.
    ("c", "MISRA.md.jinja"),
    # Short files that name the package to a build tool or a browser.
    ("browser", "decode.html.jinja"),
    *(("c", f"{name}.jinja") for name in ("config-version.cmake", "config.cmake", "pkgconfig.pc")),
    *(("c", f"zephyr_{name}.jinja") for name in ("CMakeLists.txt", "Kconfig", "module.yml")),
    ("python", "pyproject.toml.jinja"),
}


def fault_of(text: str, setting: Environment) -> str:
    """Return the reason why a template should be ordinary source, or an empty string."""
    tree = setting.parse(text)
    lines = {node.lineno for node in tree.find_all((nodes.Expr, nodes.Stmt)) if not isinstance(node, _TEXT)}
    share = 100 * len(lines) / max(text.count("\n"), 1)
    if share < LEAST:
        return f"{share:.0f} % of its lines have an expression or a statement"
    if not _has_arguments(tree) and names_in(tree, setting) <= SAME:
        return "its only expressions are the same for every device"
    return ""


#: Nodes for the text between expressions.
_TEXT = (nodes.Output, nodes.TemplateData)


def _has_arguments(tree: nodes.Template) -> bool:
    """A template of macros is called with what differs."""
    return any(macro.args for macro in tree.find_all(nodes.Macro))


def names_in(tree: nodes.Template, setting: Environment) -> set[str]:
    """Return the values that a template and those that it includes are rendered with."""
    found = meta.find_undeclared_variables(tree) - set(setting.globals)
    for other in meta.find_referenced_templates(tree):
        assert other is not None
        assert setting.loader is not None
        found |= names_in(setting.parse(setting.loader.get_source(setting, other)[0]), setting)
    return found


def templates() -> Iterator[tuple[str, str, Templates]]:
    for target in BUILT_IN:
        of = load_target(target).templates
        for name in of.names if of is not None else ():
            assert of is not None
            yield target, name, of


@pytest.mark.slow
def test_no_template_without_a_template() -> None:
    faults = {}
    for target, name, of in templates():
        text = (of.folder / name).read_text(encoding="utf-8")
        if fault := fault_of(text, environment(of)):
            faults[target, name] = fault
    assert {place: fault for place, fault in faults.items() if place not in ALLOWED} == {}
    assert ALLOWED - {*faults} == set(), "these are no longer exceptions"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("text\n" * 40, "0 % of its lines have an expression or a statement"),
        ("text\n" * 39 + "{# a comment #}\n{{ d }}\n", "2 % of its lines have an expression or a statement"),
        ("text\n" * 38 + "{{ d.name }}\n{{ d.title }}\n", ""),
        ("{{ header }}\n{{ package }} by {{ maker.name }}\n", "its only expressions are the same for every device"),
        ("{{ header }}\n{% for item in devices %}\n{{ item }}\n{% endfor %}\n", ""),
    ],
)
def test_what_is_no_template(text: str, fault: str) -> None:
    assert fault_of(text, Environment()) == fault
