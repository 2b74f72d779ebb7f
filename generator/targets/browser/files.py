"""Browser target: a page and a script that decode frames and registers without a server.

The script contains the plan of every frame as a table, and the runtime that interprets it. Other pages can embed the
decoder box.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, TypedDict

from ...language.problems import LONGEST_QUOTE, listed
from ...model import UNEXPLAINED, Device, Fault
from ...order_codes import labels
from ...order_codes.labels import LONGEST, NEAR
from ...render import Templates, our_templates
from ...say import frame_errors
from ...say.layout import as_one_number
from ...say.markdown import text
from ...say.plain_text import plain
from ...say.text import WORTH
from ...why.recordings import FRAME_INSIDE, FRAME_INSIDE_TEXT, LINES, Line
from ...why.tries import ACTIVE, IDLE, MISTAKES
from .. import NO_OPTIONS, Library, Options, Target
from ..shared_files import licence_in, our_runtime
from .family import family_data, javascript_pattern
from .layouts import Data, script_json

#: Error messages, with placeholders for numbers and names: ``{0} is {1}``.
_MESSAGES = {
    "length": frame_errors.length("{0}", "{1}", "{2}"),
    "crc": frame_errors.crc("{0}", "{1}"),
    "constant": frame_errors.constant("{0}", "{1}", "{2}"),
    "parity": frame_errors.parity("{0}", "{1}", "{2}", "{3}"),
    "no_value": frame_errors.no_value("{0}", "{1}"),
    "too_high": frame_errors.too_high("{0}", "{1}", "{2}"),
    "digits": frame_errors.digits("{0}", "{1}", "{2}"),
    "of_other_frame": frame_errors.of_other_frame("{0}", "{1}"),
    "too_few_bytes": frame_errors.too_few_bytes("{0}"),
    "no_frame": frame_errors.no_frame("{0}", "{1}", "{2}"),
    "other_value": frame_errors.other_value("{0}", "{1}", "{2}"),
    "other_content": frame_errors.other_content("{0}", "{1}", "{2}", "{3}"),
    "too_wide": frame_errors.too_wide("{0}", "{1}", "{2}"),
    "no_power_of_two": frame_errors.no_power_of_two("{0}", "{1}"),
    "outside": frame_errors.outside("{0}", "{1}", "{2}"),
    "as_one_number": as_one_number("{0}"),
    "frame_empty": frame_errors.EMPTY,
    "frame_too_long": frame_errors.TOO_LONG,
    "not_hex": frame_errors.not_hex("{0}"),
    "one_digit": frame_errors.one_digit("{0}", "{1}"),
    "odd": frame_errors.odd("{0}"),
    "bits_or_bytes": frame_errors.bits_or_bytes("{0}"),
    "no_bits": frame_errors.no_bits("{0}", "{1}", "{2}"),
    "write_number": frame_errors.write_number("{0}"),
    "write_bits": frame_errors.write_bits("{0}", "{1}"),
    "no_order_code": frame_errors.no_order_code("{0}", "{1}"),
    "write_any": frame_errors.write_any(),
    "write_one_of": frame_errors.write_one_of("{0}"),
    "if_decimal": frame_errors.if_decimal("{0}"),
    "if_hex": frame_errors.if_hex("{0}"),
    "if_bits": frame_errors.if_bits("{0}"),
    "also": frame_errors.also_possible("{0}"),
    "instead": frame_errors.possible_instead("{0}"),
    "valid_other": frame_errors.valid_other("{0}"),
    "register_length": frame_errors.register_length("{0}", "{1}", "{2}"),
    "too_long": labels.too_long("{0}", "{1}", "{2}"),
    "cannot_be_combined": labels.cannot_be_combined("{0}", "{1}", "{2}"),
    "not_of_family": labels.not_of_family("{0}", "{1}", "{2}"),
    "wrong_part": labels.wrong_part("{0}", "{1}", "{2}", "{3}"),
    "has_part": labels.has_part("{0}", "{1}"),
    "has_no_part": labels.has_no_part("{0}"),
    "family": labels.family_instead_of_code("{0}", "{1}"),
    "unknown": labels.unknown_code("{0}"),
    "another_frame": frame_errors.ANOTHER_FRAME,
    "uncertain": frame_errors.UNCERTAIN_READINGS,
    "nearest": labels.nearest_codes_hint("{0}"),
}


class Page(TypedDict):
    title: Annotated[str, "the manufacturers on one line"]
    codes: Annotated[int, "number of order codes"]
    example: Annotated[str, "an order code"]
    table: Annotated[Data, "data of the script: messages, mistakes with a frame, and the families"]
    runtime: Annotated[Mapping[str, str], "the parts of the script that are the same for all encoders, by name"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the page, the script and the README."""
    codes = [variant.code for device in library.devices for variant in device.variants]
    page: Page = {
        "title": listed(plain(manufacturer.title) for manufacturer, _ in library.by_manufacturer()),
        "codes": len(set(codes)),
        "example": codes[0] if codes else "",
        "table": script_table(library),
        "runtime": {path.stem: _code_without_comment(path) for path in our_runtime("browser").glob("*.js")},
    }
    names = ("README.md", "decode.html", "decode.js")
    files = {f"browser/{name}": TEMPLATES.render(f"{name}.jinja", page, library.own_templates) for name in names}
    return files | licence_in("browser")


def _code_without_comment(path: Path) -> str:
    """Return the code of a part of the script, without the comment at its top."""
    return path.read_text(encoding="utf-8").partition("\n\n")[2].rstrip("\n")


def script_table(library: Library) -> Data:
    """Return the data for the script."""
    return {
        "faults": [fault_code.value for fault_code in Fault],
        "worth": {verdict.value: words for verdict, words in WORTH.items()},
        "unexplained": UNEXPLAINED,
        "said": _MESSAGES,
        "limits": {"text": frame_errors.LONGEST, "quote": LONGEST_QUOTE, "label": LONGEST, "likeness": NEAR},
        "lines": {name: _line_data(line) for name, line in LINES.items()},
        "inside": [FRAME_INSIDE, FRAME_INSIDE_TEXT],
        "likely": {"kinds": dict(MISTAKES), "idle": IDLE, "active": ACTIVE},
        "families": [library.part(_family_data, device, NO_OPTIONS) for device in library.devices],
    }


def _line_data(line: Line) -> Data:
    """Return the mistakes with the bits around a frame, with regular expressions in the notation of JavaScript."""
    return {
        "slips": [[slip.kind, slip.text, slip.front, slip.missing, slip.lost, slip.behind] for slip in line.slips],
        "recordings": [
            [recording.kind, recording.text, javascript_pattern(recording.pattern), recording.proof]
            for recording in line.recordings
        ],
        "incomplete": [[incomplete.text, javascript_pattern(incomplete.pattern)] for incomplete in line.incomplete],
    }


def _family_data(device: Device, library: Library, options: Options) -> Data:
    return family_data(device)


def sha256(part: str) -> str:
    """Return the source expression for a Content-Security-Policy that allows this inline part of a page."""
    return f"sha256-{base64.b64encode(hashlib.sha256(part.encode()).digest()).decode()}"


TEMPLATES = Templates(
    our_templates("browser"),
    values=dict.fromkeys(("README.md.jinja", "decode.html.jinja", "decode.js.jinja"), Page),
    filters={"script_json": script_json, "md": text, "sha256": sha256},
)
TARGET = Target(
    name="browser",
    summary="a page that decodes frames without a server",
    files=generate,
    templates=TEMPLATES,
    family=_family_data,
)
