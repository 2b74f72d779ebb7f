"""Configuration of Sphinx. ``build_site.py``, next to it, runs Sphinx on the pages of the repository."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

project = "codewheel"
extensions = ["myst_parser", "mirror", "site_search", "marks", "tables", "search_entries", "page_heads"]
# Links use the paths of the repository. mirror.py turns them into links between pages.
myst_all_links_external = True
# Code, names and addresses stay as they are written.
smartquotes = False
html_theme = "furo"
templates_path = ["templates"]
html_static_path = ["static", str(HERE.parents[1] / "runtime" / "browser" / "palette.css")]
html_css_files = ["palette.css", "site.css"]
html_js_files = ["site.js"]
html_show_sphinx = False
html_title = "codewheel"
html_copy_source = False
html_show_copyright = False
html_additional_pages = {"search": "search.html"}
html_use_index = False
html_permalinks = False
# Output of a terminal is not in a language.
highlight_language = "none"
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
