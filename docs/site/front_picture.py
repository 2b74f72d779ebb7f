"""Draw the picture on the front page: a frame in YAML on the left, its outputs on the right.

`python docs/site/front_picture.py docs/front.svg` writes it. A test compares its lines with their files and commands.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from codewheel.targets.picture_elements import palette


@dataclass(frozen=True)
class Panel:
    """One box of the picture, in pixels. An ellipsis marks omitted lines."""

    title: str
    x: int
    y: int
    width: int
    lines: tuple[str, ...]

    @property
    def height(self) -> int:
        return TOP + LINE * len(self.lines) + 10


LINE = 18
TOP = 38
SPEC = Panel(
    "specs/lika/amm5.yaml: the manual as data",
    0,
    0,
    430,
    (
        "- name: single_cycle_data",
        "  printed_name: Single Cycle Data SCD",
        "  source: 6.2.1 p.32",
        "  fields:",
        "    - {name: multiturn, bits: multiturn_bits, …",
        "    - {name: singleturn, bits: singleturn_bits, …",
        "    - name: error",
        "      printed_name: Error, nE",
        "      active: low",
        "      makes_position: not_usable",
        "      source: 6.2.1 p.32",
        "    - name: warning",
        "      printed_name: Warning, nW",
        "      …",
        "    - {name: crc, printed_name: CRC, crc: biss_6, …",
        "  join: {position: [multiturn, singleturn]}",
    ),
)
C = Panel(
    "C headers",
    450,
    0,
    460,
    (
        "uint64_t position;",
        "if (LIKA_AMM5_BISS_READ(A21_65KSC1, rx,",
        "        &position) != CW_NOT_USABLE) {",
    ),
)
PYTHON = Panel(
    "Python package",
    450,
    C.height + 14,
    460,
    (
        '>>> frame = lookup("AMM5A21/65KSC1").decode(0xF4243D3)',
        ">>> frame.position, frame.verdict.value",
        "(1000003, 'usable')",
    ),
)
DECODED = Panel(
    "codewheel decode AMM5A21/65KSC1 0xF4243D3",
    450,
    PYTHON.y + PYTHON.height + 14,
    460,
    (
        "44:29  multiturn   0x0      0 revolutions   …",
        "28:8   singleturn  0xf4243  1000003 counts  …",
        "7      error       1        no              …",
        "5:0    crc         0x13     19              …",
        "…",
        "position: 171.6619° of revolution 0",
    ),
)
PANELS = (SPEC, C, PYTHON, DECODED)
ABOUT = (
    "One frame of an encoder as YAML on the left. On the right the same frame in C, in Python, and decoded on the "
    "command line: multiturn 0, singleturn 1000003, no active error, position 171.6619 degrees."
)


def _colours(name_of: Callable[[str], str]) -> str:
    """Return the rules with colours. ``name_of`` returns the colour of a name."""
    return f"""
    rect {{ fill: {name_of("surface")}; stroke: {name_of("border")}; }}
    rect.spec {{ fill: {name_of("bits-data")}; stroke: {name_of("link")}; }}
    text {{ fill: {name_of("ink")}; }}
    text.title {{ fill: {name_of("soft-ink")}; }}"""


def _style() -> str:
    colours = palette()
    return f"""
    text {{ font: 13px ui-monospace, Consolas, Menlo, monospace; white-space: pre; }}
    text.title {{ font: 600 13px system-ui, sans-serif; }}{_colours(colours.light.__getitem__)}
    @media (prefers-color-scheme: dark) {{{_colours(colours.on_dark)}
    }}"""


def picture() -> str:
    """Return the picture as SVG."""
    width = max(panel.x + panel.width for panel in PANELS)
    height = max(panel.y + panel.height for panel in PANELS)
    drawn = "\n".join(_panel_svg(panel) for panel in PANELS)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-1 -1 {width + 2} {height + 2}" width="{width}" '
        f'height="{height}" role="img" aria-labelledby="front-title front-text">\n'
        f'  <title id="front-title">From a spec to decoded frames</title>\n'
        f'  <desc id="front-text">{escape(ABOUT)}</desc>\n  <style>{_style()}\n  </style>\n{drawn}\n</svg>\n'
    )


def _panel_svg(panel: Panel) -> str:
    height = max(p.y + p.height for p in PANELS) if panel is SPEC else panel.height
    kind = ' class="spec"' if panel is SPEC else ""
    lines = [
        f'  <rect{kind} x="{panel.x}" y="{panel.y}" width="{panel.width}" height="{height}" rx="6"/>',
        f'  <text class="title" x="{panel.x + 12}" y="{panel.y + 22}">{escape(panel.title)}</text>',
    ]
    for number, line in enumerate(panel.lines):
        y = panel.y + TOP + LINE * number + 8
        lines.append(f'  <text x="{panel.x + 12}" y="{y}" xml:space="preserve">{escape(line)}</text>')
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(picture(), encoding="utf-8", newline="\n")
