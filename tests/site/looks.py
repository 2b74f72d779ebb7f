"""Defects of a page of the site as a browser shows it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from chromium import Browser

#: Width, and whether the reader prefers dark.
LOOKS = [(375, False), (375, True), (1280, False), (1280, True)]
#: Elements that extend beyond the right edge without a scroll bar of their own, or that are cut off.
_CUT = """[...document.querySelectorAll("body *:not(.skip)")].filter(item => {
  if (item.closest(".table-wrapper, pre, svg, .skip, .sidebar-drawer, .toc-drawer, table.stacks thead")) return false;
  const style = getComputedStyle(item), box = item.getBoundingClientRect();
  if (box.width === 0 || item.matches("input")) return false;
  const hides = style.overflowX !== "visible" || style.overflowY !== "visible";
  return box.right > %d + 1 || (hides && (item.scrollWidth > item.clientWidth + 1));
}).map(item => item.tagName + " " + item.className + ": " + item.textContent.trim().slice(0, 60)).slice(0, 3)"""
#: Tables that are wider than their box, or have a cell with cut-off text, and the number of tables.
_TABLES = """(() => {
  document.querySelectorAll("details").forEach((item) => { item.open = true; });
  const tables = [...document.querySelectorAll("article table")];
  const isCut = (item) => item.scrollWidth > item.clientWidth + 2;
  const wide = tables.filter((item) => item.scrollWidth > item.parentElement.clientWidth
    || [...item.querySelectorAll("td, th")].some((cell) => cell.clientWidth > 1 && isCut(cell)));
  return [tables.length, wide.map((item) => item.innerText.trim().slice(0, 60))];
})()"""
#: The elements of a page by their parent, class and attributes, each once.
_ELEMENTS = """[...new Set([...document.querySelectorAll("body *")].map(item => {
  const attributes = [...item.attributes].map(one => one.name + (one.name === "role" ? "=" + one.value : ""));
  const kind = item.className.baseVal ?? item.className;
  return [item.parentElement.localName, item.localName, kind, ...attributes].join(" ");
}))]"""
_AXE = """axe.run({resultTypes: ["violations"]}).then(found => found.violations
  .filter(item => item.impact === "serious" || item.impact === "critical")
  .map(item => item.id + ": " + item.nodes[0].html.slice(0, 200)))"""


def faults(browser: Browser, page: Path, width: int) -> Iterator[str]:
    """Open a page, and yield each fault that a reader sees or the browser reports."""
    browser.open(page.as_uri())
    yield from faults_here(browser, width)


def faults_here(browser: Browser, width: int) -> Iterator[str]:
    """Yield each fault of the open page that a reader sees or the browser reports."""
    wide = browser.run("document.documentElement.scrollWidth")
    if wide > width:
        yield f"the page is {wide} wide"
    yield from browser.run(_CUT % width)
    yield from browser.run(
        '[...document.images].filter(item => !item.naturalWidth).map(item => "no picture: " + item.src)'
    )
    yield from browser.complaints


def tables_of(browser: Browser) -> tuple[int, list[str]]:
    """Return the number of tables of the open page, and those that do not fit. Opens all folds."""
    count, wide = browser.run(_TABLES)
    return count, wide


def elements_of(browser: Browser) -> set[str]:
    """Return what elements the open page has: their names, classes and attributes, and the elements around them."""
    return set(browser.run(_ELEMENTS))


def axe_finds(browser: Browser, axe: str) -> list[str]:
    """List what axe-core calls serious or critical on the open page."""
    browser.run(f"{axe};0")
    complaints: list[str] = browser.run(_AXE)
    return complaints
