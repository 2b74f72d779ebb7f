"""The page about templates: their purpose, their values, and how to change them.

``python -m codewheel.targets.templates_page FILE [TARGET...]`` writes it, by default for the built-in targets. ``make
templates-page`` writes ``docs/templates.md``. Everything except the introduction comes from the targets: the first
comment of each template, the classes of its values, and the docstrings of filters, tests and functions.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

from jinja2 import Environment, meta, nodes

from ..environments import COMMON_FILTERS, environment
from ..render import Templates
from ..say.markdown import STYLE, code, paragraph, table, text
from . import Target
from .registry import BUILT_IN, load_target

_ABOUT = re.compile(r"\{#-? (.+?) -?#\}", re.DOTALL)
_INTRODUCTION = """\
<!-- Made from the targets and their templates by: make templates-page -->

# Templates

All files written by `codewheel generate`, except pictures and full XML, come from
[Jinja](https://jinja.palletsprojects.com/templates/) templates. To change one, put a template of the same name into
your own folder, in a subfolder with the name of its target, and pass the folder to `generate`. Your template replaces
the shipped one. All others remain unchanged. Inside yours, `shipped/NAME` refers to the template that it replaces.

For example, this adds a line to the end of the index page. Write it to `house/docs/index.md.jinja`:

```jinja
{% include "shipped/index.md.jinja" %}

Families: {{ rows|length }}. Questions: drives@example.com
```

Then run:

```
codewheel generate my_encoder.yaml --target docs --templates house
```

The page `generated/docs/README.md` now ends with:

```
Families: 1. Questions: drives@example.com
```

Errors in a template are reported with file and line. A template that no output uses is also reported, because its name
is misspelt or it is in the wrong folder. An undefined name is an error, not empty text. A line that contains only a
statement produces no output. Values contain text from specs, which can be anything. The filters of a target escape it
for its language.

Your templates run in Jinja's sandbox, as do any shipped templates used with them. They can neither change
values nor access files outside their folder, modules or other programs. Each file is limited to a million steps: items
of loops, calls and printed values. A template that needs more steps is stopped with a message. See [what is
trusted](../SECURITY.md).

All templates can use Jinja's filters and these:
"""


def templates_page(targets: Iterable[Target]) -> str:
    """Return the page for these targets. A target without templates has no section."""
    lines = [_INTRODUCTION, _callables("Filter", {_filter(name, item): item for name, item in COMMON_FILTERS.items()})]
    model: set[type] = set()
    for target in targets:
        if target.templates is not None:
            kinds = _kinds(target.templates)
            of_model = {kind for kind in kinds if ".model." in kind.__module__}
            model |= of_model
            lines += [*_section(target, target.templates), *_types(f"Types of {target.name}", kinds - of_model)]
    return "\n".join([*lines, *_types("Types of the model", model)]) + "\n"


def faults(templates: Templates) -> Iterator[str]:
    """Yield a line for every error or gap in the page. The tests call this."""
    parts, used, declared = set[str](), set[str](), set[str]()
    for template, shape in templates.values.items():
        tree = _tree(templates, template)
        names, values = _used(templates, *tree), get_type_hints(shape, include_extras=True)
        known = {*values, *templates.functions, *environment(templates).globals}
        yield from (f"{template} uses '{name}', which {shape.__name__} lacks" for name in sorted(names - known))
        yield from (f"{shape.__name__}.{name} has no line" for name in values if not _line(values[name]))
        parts.update(tree)
        used |= names
        declared |= values.keys()
    yield from (f"no template uses the value '{name}'" for name in sorted(declared - used))
    yield from (f"no template uses {name}" for name in templates.names if name not in parts)
    yield from (
        f"{name} does not begin with a comment that describes it"
        for name in templates.names
        if not _about(templates, name)
    )
    made = {**templates.filters, **templates.functions}
    yield from (f"'{name}' has no docstring" for name, item in made.items() if not _first_line(item))


def _section(target: Target, templates: Templates) -> Iterator[str]:
    yield from ("", f"## {target.name}", "", paragraph(text(f"{target.summary[0].upper()}{target.summary[1:]}.")), "")
    rows = [_row(target, templates, template) for template in templates.names]
    yield table(["Template", "Purpose", "Values", "Used values", "Macros"], rows)
    if templates.filters:
        yield from ("", _callables("Filter", {_filter(name, item): item for name, item in templates.filters.items()}))
    if templates.tests:
        asked = {f"... is {name}": kind for name, kind in sorted(templates.tests.items())}
        yield from ("", _callables("Test", asked))
    if templates.functions:
        named = {f"{name}{_signature(item)}": item for name, item in templates.functions.items()}
        yield from ("", _callables("Function", named))
    shapes = sorted(set(templates.values.values()), key=lambda item: (len(get_type_hints(item)), item.__name__))
    for index, shape in enumerate(shapes):
        yield from _values(shape, shapes[:index])


def _row(target: Target, templates: Templates, template: str) -> tuple[str, ...]:
    """Return the row for a template: its purpose, its values, the values it uses, and its macros."""
    made, colon, about = _about(templates, template).partition(": ")
    about = (
        f"{code(made)}: {_marked(about)}" if made.startswith(f"{target.name}/") else _marked(f"{made}{colon}{about}")
    )
    shape = templates.values.get(template)
    users = [name for name in templates.names if template in _referred(_parsed(templates, name))]
    gets = code(shape.__name__) if shape is not None else f"those of {_list(users)}"
    uses = _used(templates, *(_tree(templates, template) if shape is not None else [template]))
    macros = _parsed(templates, template).find_all(nodes.Macro)
    named = (f"{item.name}({', '.join(argument.name for argument in item.args)})" for item in macros)
    others = {*templates.functions, *environment(templates).globals} - (
        get_type_hints(shape).keys() if shape else set()
    )
    return code(template), about, gets, _list(uses - others), _list(named)


def _values(shape: type, smaller: Iterable[type]) -> Iterator[str]:
    """Yield the values of a class. Those of a class that it includes completely are not repeated."""
    hints = get_type_hints(shape, include_extras=True)
    inside = [item for item in smaller if get_type_hints(item).items() <= get_type_hints(shape).items()]
    told = {name for item in inside for name in get_type_hints(item)}
    rows = [(code(name), code(_shown(kind)), _marked(_line(kind))) for name, kind in hints.items() if name not in told]
    more = f", and those of {_list(item.__name__ for item in inside)}" if inside else ""
    yield from ("", f"Values of {code(shape.__name__)}{more}:", "", table(["Value", "Type", "Meaning"], rows))


def _list(names: Iterable[str]) -> str:
    return ", ".join(map(code, sorted(names)))


def _callables(head: str, items: Mapping[str, Callable[..., object]]) -> str:
    rows = [(code(name), _marked(_first_line(item))) for name, item in items.items()]
    return table([head, "Condition" if head == "Test" else "Result"], rows)


def _filter(name: str, item: Callable[..., object]) -> str:
    """Return a filter as written in a template, without its first argument, which precedes the vertical bar."""
    arguments = _signature(item, 1)
    return f"{name}{arguments}" if arguments != "()" else name


def _signature(item: Callable[..., object], leave_out: int = 0) -> str:
    """Return the names of the arguments without their types."""
    parameters = list(inspect.signature(item).parameters.values())[leave_out:]
    bare = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in parameters]
    return str(inspect.Signature(bare))


def _first_line(item: object) -> str:
    return (inspect.getdoc(item) or "").partition("\n")[0]


def _marked(line: str) -> str:
    """Return a line of text as Markdown, in which only what is between backticks is code."""
    return "".join((code if index % 2 else STYLE.text)(part) for index, part in enumerate(re.split("`+", line)))


# -- templates


def _environment(templates: Templates) -> Environment:
    """Return an environment without predefined names, so that Jinja's names also count as used."""
    made = environment(templates).overlay()
    made.globals = {}
    return made


@cache
def _parsed(templates: Templates, template: str) -> nodes.Template:
    return _environment(templates).parse(_source(templates, template))


def _source(templates: Templates, template: str) -> str:
    return (templates.folder / template).read_text(encoding="utf-8")


def _about(templates: Templates, template: str) -> str:
    found = _ABOUT.match(_source(templates, template))
    return found[1] if found else ""


def _referred(tree: nodes.Template) -> set[str]:
    """Return the names of the templates that a template includes or imports."""
    return {name for name in meta.find_referenced_templates(tree) if name is not None}


def _tree(templates: Templates, template: str) -> list[str]:
    """Return the template and all templates that it includes or imports, directly or indirectly."""
    found = [template]
    for name in found:  # the list grows during the loop
        found += sorted(_referred(_parsed(templates, name)) - set(found))
    return found


def _used(templates: Templates, *names: str) -> set[str]:
    """Return the names that these templates use but do not set."""
    trees = [_parsed(templates, name) for name in names]
    stored = {item.name for tree in trees for item in tree.find_all(nodes.Name) if item.ctx == "store"}
    return {name for tree in trees for name in meta.find_undeclared_variables(tree)} - stored


# -- types


def _line(kind: Any) -> str:
    """Return the description of an annotated type, or an empty string."""
    return str(kind.__metadata__[0]) if get_origin(kind) is Annotated else ""


def _shown(kind: Any) -> str:
    """Return a type as text, without its modules."""
    kind = get_args(kind)[0] if get_origin(kind) is Annotated else kind
    return kind.__name__ if hasattr(kind, "__name__") and not get_args(kind) else re.sub(r"\w+\.(?=\w)", "", str(kind))


def _kinds(templates: Templates) -> set[type]:
    """Return the classes in the values of templates, at any depth."""
    shapes = set(templates.values.values())
    found = list(shapes)
    for kind in found:  # the list grows during the loop
        found += {item for part in _parts(kind).values() for item in _classes(part)}.difference(found)
    return set(found) - shapes


def _classes(kind: Any) -> Iterator[type]:
    """Yield the classes inside a type that are not from the standard library."""
    for part in get_args(kind):
        yield from _classes(part)
    if isinstance(kind, type) and kind.__module__.partition(".")[0] not in sys.stdlib_module_names:
        yield kind


def _parts(kind: type) -> dict[str, Any]:
    """Return the members of a class with their types. The type of a method is the type of its result."""
    found = _hints(kind)
    for name, part in found.items():
        if part is ClassVar or get_origin(part) is ClassVar:
            found[name] = next(iter(get_args(part)), type(getattr(kind, name)))
    for name, item in vars(kind).items():
        if isinstance(item, property):
            found[name] = _hints(item.fget).get("return", Any)
        elif isinstance(item, cached_property):
            found[name] = _hints(item.func).get("return", Any)
        elif inspect.isfunction(item):
            found[f"{name}{_signature(item, 1)}"] = _hints(item).get("return", Any)
    return {name: part for name, part in found.items() if not name.startswith("_")}


def _hints(item: object) -> dict[str, Any]:
    """Return the annotated types of a class or function, as text if they are only imported for type checking."""
    try:
        return get_type_hints(item, include_extras=True)
    except NameError:
        return dict(inspect.get_annotations(item)) if callable(item) else {}


def _types(title: str, kinds: Iterable[type]) -> Iterator[str]:
    rows = []
    for kind in sorted(kinds, key=lambda item: item.__name__):
        # Without a docstring, a data class has its name, or its name and its members.
        about = "" if (kind.__doc__ or kind.__name__).split("(")[0] == kind.__name__ else _first_line(kind)
        parts = ", ".join(code(f"{name}: {_shown(part)}") for name, part in _parts(kind).items())
        rows.append((code(kind.__name__), _marked(about), parts))
    if rows:
        yield from ("", f"### {title}", "", table(["Type", "Meaning", "Members"], rows))


if __name__ == "__main__":
    path, *names = sys.argv[1:]
    Path(path).write_text(templates_page(map(load_target, names or BUILT_IN)), encoding="utf-8")
