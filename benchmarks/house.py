"""Figures about the code: structure of the generator, and the share of its output that comes from templates.

    python benchmarks/house.py                       measures this checkout and prints a table
    python benchmarks/house.py --against COMMIT      adds a column for an earlier commit
    python benchmarks/house.py --list                also lists the counted places

The sources are read but not imported. Only the generator itself runs, once for each commit, in its own process. The
docstrings of the modules in benchmarks/figures/ explain how they count.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from figures.functions import LONGEST, Function, functions
from figures.imports import cycles, graph, packages
from figures.kinds import comparisons
from figures.reading import Search, searches
from figures.sizes import is_real, lines_without_docstrings, statements_of
from figures.statements import ORIGINS, Printed, by_output, families_of, printed
from figures.tree import COLUMNS, Checkout, Source, unpack

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Figure:
    """A row of the table, with the places that it counts."""

    title: str
    value: str
    places: Sequence[str] = ()


def measure(checkout: Checkout) -> Iterator[Figure]:
    """Yield every figure of a checkout, in the order of the table."""
    arrows = graph(checkout.modules)
    yield _cycles("cycles of modules that import each other", cycles(arrows))
    yield _cycles("cycles of packages", cycles(packages(arrows)))
    flat = checkout.flat_modules()
    yield Figure("modules in no package", _count(flat), flat)
    files = printed(checkout)
    yield from _to_own(checkout, files)
    yield from _shares(checkout, files)
    yield from _lines("lines of targets", checkout.lines_of_targets())
    yield from _lines("lines of templates", checkout.lines_of_templates())
    yield from _searches(checkout)
    yield _kinds(checkout)
    wide = list(checkout.wide_lines())
    yield _counted_by(f"lines over {COLUMNS} columns", {place: place.partition("/")[0] for place in wide})
    yield from _functions(functions(checkout.modules))
    yield Figure("characters without blanks, generator and templates", f"{checkout.size():,}")


def _count(items: Sequence[object]) -> str:
    return f"{len(items):,}"


def _cycles(title: str, found: Sequence[Sequence[str]]) -> Figure:
    shown = f"{len(found)} ({'; '.join(_cycle(item) for item in found)})" if found else "0"
    return Figure(title, shown, [", ".join(item) for item in found])


def _cycle(names: Sequence[str]) -> str:
    """Return a short text about a cycle: all of its names, or only the first ones."""
    return ", ".join(names) if len(names) <= 3 else f"{names[0]}, {names[1]} and {len(names) - 2} more"


def _shares(checkout: Checkout, files: Mapping[str, Printed]) -> Iterator[Figure]:
    """Yield the origin of the statements and of their letters, for each kind of output and for all of them."""
    found = by_output(checkout, files)
    found["all"] = [item for items in found.values() for item in items]
    for title, items in found.items():
        yield Figure(f"statements wholly from Python strings: {title}", _share(Counter(item.origin for item in items)))
    for title, items in found.items():
        letters = sum(item.letters for item in items)
        from_python = sum(item.from_python for item in items) / (letters or 1)
        yield Figure(f"letters of statements from Python strings: {title}", f"{from_python:.1%} of {letters:,}")


def _share(count: Counter[str]) -> str:
    template, mixed, python = (count[item] / (count.total() or 1) for item in ORIGINS)
    return f"{python:.1%} of {count.total():,} (mixed {mixed:.1%}, template {template:.1%})"


def _to_own(checkout: Checkout, files: Mapping[str, Printed]) -> Iterator[Figure]:
    """Yield the size of what must be kept in mind. The runtime is ordinary source and counts apart."""
    statements = sum(map(statements_of, checkout.modules))
    real = sum(item.lines for item in checkout.templates if is_real(item))
    yield Figure("statements of the generator, and lines of real templates", f"{statements + real:,}")
    yield Figure("statements of the generator", f"{statements:,}")
    yield Figure("lines of real templates", f"{real:,}")
    bare = [item.path for item in checkout.templates if not is_real(item)]
    yield Figure("templates without a template", _count(bare), bare)
    runtime = [item for suffix in (".c", ".h", ".js", ".py") for item in checkout.files("runtime", suffix)]
    yield Figure("lines of the runtime", f"{sum(item.lines for item in runtime):,}")
    compared = (item.lines for item in checkout.modules if Path(item.path).parts[1] in ("changes", "readings"))
    yield Figure("lines of changes and readings", f"{sum(compared):,}")
    families = families_of(checkout)
    made = {name: Source(name, file.text) for name, file in files.items() if families.fullmatch(Path(name).stem)}
    tables = ("_shapes", "facts")
    modules = [item for item in made.values() if item.path.endswith(".py")]
    bodies = (lines_without_docstrings(item) for item in modules if Path(item.path).parent.name not in tables)
    yield Figure("lines of Python family modules without docstrings", f"{sum(bodies):,}")
    headers = (item.lines for name, item in made.items() if name.endswith(".h"))
    yield Figure("lines of C family headers", f"{sum(headers):,}")


def _lines(title: str, counts: Counter[str]) -> Iterator[Figure]:
    for name, lines in sorted(counts.items()):
        yield Figure(f"{title}: {name}", f"{lines:,}")
    yield Figure(f"{title}: all", f"{counts.total():,}")


def _searches(checkout: Checkout) -> Iterator[Figure]:
    found = searches(checkout)
    code = [f"{item.place} {item.function}: {_short(item)}" for item in found if not item.reason]
    other = [f"{item.place} {item.function}: {_short(item)} ({item.reason})" for item in found if item.reason]
    yield Figure("places that read back generated text", _count(code), code)
    yield Figure("searches in names, manual text and comments", _count(other), other)


def _short(search: Search) -> str:
    text = " ".join(search.expression.split())
    return text if len(text) <= 100 else f"{text[:97]}..."


def _kinds(checkout: Checkout) -> Figure:
    found = comparisons(checkout)
    value = _by_name(Counter(item.attribute for item in found))
    return Figure("string comparisons of kinds", value, [f"{item.place} {item.attribute}" for item in found])


def _counted_by(title: str, names: Mapping[str, str]) -> Figure:
    return Figure(title, _by_name(Counter(names.values())), list(names))


def _by_name(counts: Counter[str]) -> str:
    parts = ", ".join(f"{name} {count:,}" for name, count in counts.most_common())
    return f"{counts.total():,} ({parts})" if parts else "0"


def _functions(found: Sequence[Function]) -> Iterator[Figure]:
    number = len(found) or 1
    long = [item for item in found if item.lines > LONGEST]
    worst = sorted(found, key=lambda item: -item.complexity)[:10]
    yield Figure("functions", _count(found))
    yield Figure("lines of a function, mean", f"{sum(item.lines for item in found) / number:.1f}")
    yield Figure(
        f"functions over {LONGEST} lines", _count(long), [f"{item.place} {item.name} {item.lines}" for item in long]
    )
    yield Figure("complexity of a function, mean", f"{sum(item.complexity for item in found) / number:.1f}")
    yield Figure(
        "complexity of a function, worst",
        f"{worst[0].complexity} ({worst[0].name})" if worst else "0",
        [f"{item.place} {item.name} {item.complexity}" for item in worst],
    )
    yield Figure("functions with docstrings", f"{sum(item.has_docstring for item in found) / number:.0%}")


def table(columns: Mapping[str, Iterable[Figure]]) -> Iterator[str]:
    """Yield the figures of several commits side by side in Markdown, with a dash for a missing figure."""
    values = {name: {item.title: item.value for item in figures} for name, figures in columns.items()}
    longest = max(values.values(), key=len)
    titles = dict.fromkeys([*longest, *(title for column in values.values() for title in column)])
    yield f"| | {' | '.join(values)} |"
    yield "|---" * (len(values) + 1) + "|"
    for title in titles:
        yield f"| {title} | {' | '.join(column.get(title, '–') for column in values.values())} |"


def lists(figures: Iterable[Figure]) -> Iterator[str]:
    """Yield the places that the figures count as Markdown."""
    for item in figures:
        if item.places:
            yield from ("", f"### {item.title}", "", *(f"- `{place}`" for place in item.places))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", metavar="COMMIT", help="also measure this commit, in a separate folder")
    parser.add_argument("--list", action="store_true", help="list the places that are counted in this checkout")
    chosen = parser.parse_args()
    columns = {}
    if chosen.against:
        with tempfile.TemporaryDirectory() as folder:
            columns[chosen.against] = list(measure(unpack(ROOT, chosen.against, Path(folder))))
    columns["this checkout"] = list(measure(Checkout(ROOT)))
    print("\n".join(table(columns)))
    if chosen.list:
        print("\n".join(lists(columns["this checkout"])))


if __name__ == "__main__":
    try:
        main()
    except (LookupError, RuntimeError) as problem:
        sys.exit(f"house: {problem}")
