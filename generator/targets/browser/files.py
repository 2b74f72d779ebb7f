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
from ...say import report
from ...say.layout import as_one_number
from ...say.markdown import text
from ...say.plain_text import plain
from ...say.text import WORTH
from ...why.in_bits import SLIPS
from .. import NO_OPTIONS, Library, Options, Target
from ..shared_files import licence_in, our_runtime
from .family import family_data
from .layouts import Data, script_json

#: Error messages, with placeholders for numbers and names: ``{0} is {1}``.
_MESSAGES = {
    "length": report.length("{0}", "{1}", "{2}"),
    "crc": report.crc("{0}", "{1}"),
    "constant": report.constant("{0}", "{1}", "{2}"),
    "parity": report.parity("{0}", "{1}", "{2}", "{3}"),
    "no_value": report.no_value("{0}", "{1}"),
    "too_high": report.too_high("{0}", "{1}", "{2}"),
    "digits": report.digits("{0}", "{1}", "{2}"),
    "of_other_frame": report.of_other_frame("{0}", "{1}"),
    "too_few_bytes": report.too_few_bytes("{0}"),
    "no_frame": report.no_frame("{0}", "{1}", "{2}"),
    "other_value": report.other_value("{0}", "{1}", "{2}"),
    "other_content": report.other_content("{0}", "{1}", "{2}", "{3}"),
    "too_wide": report.too_wide("{0}", "{1}", "{2}"),
    "no_power_of_two": report.no_power_of_two("{0}", "{1}"),
    "outside": report.outside("{0}", "{1}", "{2}"),
    "as_one_number": as_one_number("{0}"),
    "frame_empty": report.EMPTY,
    "frame_too_long": report.TOO_LONG,
    "not_hex": report.not_hex("{0}"),
    "one_digit": report.one_digit("{0}", "{1}"),
    "odd": report.odd("{0}"),
    "bits_or_bytes": report.bits_or_bytes("{0}"),
    "no_bits": report.no_bits("{0}", "{1}", "{2}"),
    "write_number": report.write_number("{0}"),
    "write_bits": report.write_bits("{0}", "{1}"),
    "no_order_code": report.no_order_code("{0}", "{1}"),
    "write_any": report.write_any(),
    "write_one_of": report.write_one_of("{0}"),
    "if_decimal": report.if_decimal("{0}"),
    "if_hex": report.if_hex("{0}"),
    "if_bits": report.if_bits("{0}"),
    "also": report.also_possible("{0}"),
    "instead": report.possible_instead("{0}"),
    "valid_other": report.valid_other("{0}"),
    "register_length": report.register_length("{0}", "{1}", "{2}"),
    "too_long": labels.too_long("{0}", "{1}", "{2}"),
    "cannot_be_combined": labels.cannot_be_combined("{0}", "{1}", "{2}"),
    "not_of_family": labels.not_of_family("{0}", "{1}", "{2}"),
    "wrong_part": labels.wrong_part("{0}", "{1}", "{2}", "{3}"),
    "has_part": labels.has_part("{0}", "{1}"),
    "has_no_part": labels.has_no_part("{0}"),
    "family": labels.family_instead_of_code("{0}", "{1}"),
    "unknown": labels.unknown_code("{0}"),
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
        "limits": {"text": report.LONGEST, "quote": LONGEST_QUOTE, "label": LONGEST, "likeness": NEAR},
        "slips": [[slip.text, slip.front, slip.missing, slip.lost, slip.behind] for slip in SLIPS],
        "families": [library.part(_family_data, device, NO_OPTIONS) for device in library.devices],
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
