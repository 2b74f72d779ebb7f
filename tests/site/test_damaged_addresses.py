"""The scripts of the site go on after a damaged address or an odd search. They run in Node, with a few elements."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow
STATIC = Path(__file__).parents[2] / "docs" / "site" / "static"
#: Elements that accept everything, and that keep their children.
ELEMENTS = """
const element = () => ({children: [], append(...added) { this.children.push(...added); }, replaceChildren(...added) {
  this.children = added; }, setAttribute() {}, addEventListener() {}, focus() {}});
const [elements, listeners] = [{}, {}];
globalThis.addEventListener = (name, listener) => { listeners[name] = listener; };
globalThis.window = globalThis;
globalThis.document = {
  readyState: "complete", addEventListener() {}, createElement: element,
  createTextNode: (text) => text, getElementById: (id) => (elements[id] ??= id ? element() : null),
  querySelector: (selector) => (/menu|search/.test(selector) ? element() : null), querySelectorAll: () => [],
};
"""


def in_node(program: str) -> Any:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    command = [node, "-e", f"{ELEMENTS}{program}", "x", str(STATIC)]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_a_damaged_address_opens_nothing() -> None:
    program = """
      globalThis.location = {hash: "#%"};
      require(`${process.argv[2]}/site.js`);
      location.hash = "#%E0%A4%A";
      listeners.hashchange();
      console.log(JSON.stringify(Object.keys(listeners).includes("resize")));
    """
    assert in_node(program) is True


def test_names_that_every_object_has_are_not_manufacturers() -> None:
    program = """
      globalThis.location = {search: "?q=constructor"};
      globalThis.codewheelSearch = {pages: [["page", "Page", "general", "", "", false]], texts: ["other words"],
        sections: [[0, "", "Title", 0, 0]], asked: {}, codes: {}, manufacturers: {}, things: []};
      require(`${process.argv[2]}/search.js`);
      console.log(JSON.stringify([document.title, elements["search-results"].children.length]));
    """
    assert in_node(program) == ["constructor \u00b7 Search \u00b7 codewheel", 1]
