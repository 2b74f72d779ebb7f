"""Files that BiSS and SSI masters load, for each order code or in bulk.

The description of a master lists its file formats. A format is a row of ``FILE_FORMATS`` and a template with its name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Annotated, TypedDict

from ...language.master_items import FILE_FORMATS
from ...language.problems import listed
from ...masters.groups import sheets_of
from ...masters.places import Place
from ...masters.record import Record
from ...masters.sheet import Sheet, shipped_masters
from ...masters.text import cited, condition
from ...model import Device
from ...render import Templates, our_templates
from ...say.lines import plain, wrapped
from ...say.markdown import text as markdown
from .. import NO_OPTIONS, Library, Option, Options, Target
from ..file_names import names_of_codes
from ..licence import licence_in
from .entries import Channel, Content, Raw, content

_WIDTH = 120
_EACH = "each"
_BY_CODE = Option("order-codes", "each: a file that the tool loads for each order code", "bulk", ("bulk", _EACH))


class MasterFile(TypedDict):
    head: Annotated[list[str], "paragraphs of the comment at the top"]
    content: Annotated[Content, "values to write, and those left out"]
    channels: Annotated[Sequence[Channel], "channels to write: all of them, or the first in a bulk file"]
    name: Annotated[str, "order code as an identifier"]
    device: Annotated[str, "device of the master"]
    also: Annotated[Mapping[str, int | str], "further keys that the tool needs, with their values"]
    line: Annotated[str, "pattern of the command line, or empty"]


class Index(TypedDict):
    families: Annotated[list[str], "titles of the families"]
    rows: Annotated[list[dict[str, str]], "masters and formats that have files, with folder, tool and reader"]


def file_text(
    device: Device,
    codes: Sequence[str],
    found: Sheet,
    rule: Raw,
    on: str,
    library: Library | None = None,
    is_short: bool = False,
    made: Content | None = None,
) -> str:
    """Return the file for a master and for order codes that have the same settings.

    Args:
        device: The family.
        codes: The order codes. Names in the file are based on the first one.
        found: The settings.
        rule: Entry of ``files`` in the description of the master.
        on: Device of the master.
        library: The library, for the user's templates.
        is_short: True to leave out the text that all order codes of a family share.
        made: The content of the file, if it is known already.
    """
    name = rule["format"]
    made = content(found, rule, on) if made is None else made
    written = {item.key for item in made.entries}
    values: MasterFile = {
        "head": [*([] if is_short else _head(device, codes, found, rule, on)), *_about(made, is_short)],
        "content": made,
        "channels": made.channels[:1] if is_short else made.channels,
        "name": re.sub(r"\W|^(?=\d)", "_", codes[0], flags=re.ASCII),
        "device": on,
        "also": {key: value for key, value in rule.get("also", {}).items() if key not in written},
        "line": rule.get("line", ""),
    }
    return TEMPLATES.render(f"{name}.jinja", values, library.own_templates if library is not None else None)


def _head(device: Device, codes: Sequence[str], found: Sheet, rule: Raw, on: str) -> Iterator[str]:
    format_ = FILE_FORMATS[rule["format"]]
    yield f"{on} with {', '.join(codes)}. For {format_.title}."
    yield from _origin(device, found, rule, on)


def _origin(device: Device, found: Sheet, rule: Raw, on: str) -> Iterator[str]:
    format_, manual = FILE_FORMATS[rule["format"]], device.manual
    yield f"From the spec of {device.title}, manual {manual.title}, revision {manual.revision}."
    used = {word for place in _places(found, on) for word in re.split(r"[;:]\s*", place.source)}
    documents = "; ".join(f"{item.key}: {item.title}" for item in found.master.documents if item.key in used)
    yield f"From the documents of the master: {documents}."
    read = f"Read by {format_.reader}, see docs/master-files.md." if format_.reader else "Not yet read by its tool."
    yield f"Not yet tested on hardware. {read} Form of the file: {cited(rule['source'])}."


def _places(found: Sheet, on: str) -> Iterator[Place]:
    """Yield the locations of all settings on a device."""
    yield from (place for item in found.settings for place in item.places if place.device == on)


def _about(made: Content, is_short: bool) -> Iterator[str]:
    derived = list(dict.fromkeys(item.name for item in made.entries if "derived" in item.mark))
    if derived:
        yield f"Derived, not stated in a document: {listed(derived)}."
    starts = list(dict.fromkeys(item.name for item in made.entries if "start with" in item.mark))
    if starts:
        yield f"Only a value to start with, because the highest clock of the encoder is not known: {listed(starts)}."
    for item in made.left_out:
        yield f"Not in this file: {item}"
    if not is_short:
        yield from made.conditions


def comment(paragraphs: Sequence[str], prefix: str) -> str:
    """Return paragraphs as a comment whose lines begin with ``prefix``, which is ``<!--`` in XML."""
    if prefix == "<!--":
        return "\n".join(["<!--", *(wrapped(note(item), _WIDTH, "       ", "     ") for item in paragraphs), "-->"])
    if prefix == "//":
        paragraphs = [item.replace("\\", "/") for item in paragraphs]  # at the end of a line it would continue it
    return "\n".join(wrapped(item, _WIDTH, f"{prefix}   ", f"{prefix} ") for item in paragraphs)


def note(text: object) -> str:
    """Return text that cannot end a one-line comment in XML or C."""
    return plain(text).replace("--", "- -").replace("*/", "* /")


def filled(pattern: str, made: Content) -> str:
    """Return the pattern with each name in braces replaced by the value of that name."""
    for item in made.entries:
        pattern = pattern.replace(f"{{{item.key}}}", item.word)
    return pattern


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return ``masters/<master>/<format>/<device>-<family>`` in bulk, or a file for each order code.

    A bulk file contains the files of all order codes of a family as comments, so that no tool loads the wrong one by
    accident.
    """
    files: dict[str, str] = {}
    for device in library.devices:
        files |= library.part(_family, device, options)
    return files | {"masters/README.md": _index(library, files)} | licence_in("masters")


def _family(device: Device, library: Library, options: Options) -> dict[str, str]:
    """Return the files of a family by path."""
    write = _each if options.get(_BY_CODE.name, _BY_CODE.default) == _EACH else _bulk
    files: dict[str, str] = {}
    masters = shipped_masters()
    found = sheets_of(device, masters)
    for number, master in enumerate(masters):
        sheets = (zip(item.sheets[number][1], item.groups, strict=True) for item in found)
        taken = [(of, group.record, group.codes) for of, group in chain(*sheets) if not of.refusals]
        for rule in master.files if taken else ():
            for on in dict.fromkeys(name for item in taken for name in item[0].devices_with(rule)):
                folder = f"masters/{master.name}/{rule['format']}"
                stem = "" if len(master.devices) == 1 else f"{names_of_codes([on])[0]}-"
                able = [item for item in taken if on not in item[0].barred]
                files |= write(f"{folder}/{stem}", device, able, rule, on, library)
    return files


def _index(library: Library, files: Iterable[str]) -> str:
    folders = {path.rpartition("/")[0].removeprefix("masters/") for path in files}
    rows = [
        {"master": master.title, "format": rule["format"], "folder": folder, "title": kind.title, "reader": kind.reader}
        for master in shipped_masters()
        for rule in master.files
        for folder, kind in [(f"{master.name}/{rule['format']}", FILE_FORMATS[rule["format"]])]
        if folder in folders
    ]
    values: Index = {"families": [markdown(item.title) for item in library.devices], "rows": rows}
    return TEMPLATES.render("README.md.jinja", values, library.own_templates)


Taken = Sequence[tuple[Sheet, Record, Sequence[str]]]


def _each(start: str, device: Device, taken: Taken, rule: Raw, on: str, library: Library) -> dict[str, str]:
    suffix = FILE_FORMATS[rule["format"]].suffix
    labels = [_label(code, record) for _, record, codes in taken for code in codes]
    texts = [file_text(device, [code], found, rule, on, library) for found, _, codes in taken for code in codes]
    return {f"{start}{name}{suffix}": text for name, text in zip(names_of_codes(labels), texts, strict=True)}


def _label(code: str, record: Record) -> str:
    return "-".join((code, *record.answers.values()))


def _bulk(start: str, device: Device, taken: Taken, rule: Raw, on: str, library: Library) -> dict[str, str]:
    """Return one file in which order codes with the same content share a block."""
    format_ = FILE_FORMATS[rule["format"]]
    alike: dict[tuple[Content, Sequence[tuple[str, str]]], list[tuple[Sheet, Record, Sequence[str]]]] = {}
    for item in taken:
        made = content(item[0], rule, on)
        alike.setdefault((made, tuple(item[1].answers.items())), []).append(item)
    blocks = []
    for (made, _), same in alike.items():
        codes = [code for _, _, found in same for code in found]
        answers = [f"{name}={answer}" for name, answer in same[0][1].answers.items()]
        title = f"{', '.join(codes)}{' with ' if answers else ''}{' and '.join(answers)}"
        blocks.append((title, file_text(device, codes, same[0][0], rule, on, library, is_short=True, made=made)))
    return {f"{start}{device.name}{format_.suffix}": _joined(device, blocks, same[0][0], rule, on)}


def _joined(device: Device, blocks: Sequence[tuple[str, str]], found: Sheet, rule: Raw, on: str) -> str:
    """Return the files as comments, or as children of one element in XML."""
    format_ = FILE_FORMATS[rule["format"]]
    head = [f"{on} with the order codes of {device.title}. For {format_.title}.", *_origin(device, found, rule, on)]
    head += dict.fromkeys(condition(item) for item in found.writing)
    head.append(
        "Each block is for the first channel. A file that codewheel prints for one order code has all channels."
    )
    if format_.comment == "<!--":
        head.append("Copy the element below your order code into a file of its own.")
        inner = "".join(f"\n{comment([title], '<!--')}\n{_without_declaration(text)}" for title, text in blocks)
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{comment(head, "<!--")}\n<files>{inner}</files>\n'
    head.append(f"Copy the lines below your order code and remove the first {format_.comment} of each line.")
    lines = [comment(head, format_.comment)]
    for title, text in blocks:
        lines += ["", comment([f"=== {title}"], format_.comment)]
        lines += [f"{format_.comment} {line}".rstrip() for line in text.splitlines()]
    return "\n".join(lines) + "\n"


def _without_declaration(text: str) -> str:
    return text.partition("?>\n")[2] if text.startswith("<?xml") else text


TEMPLATES = Templates(
    our_templates("masters"),
    values={"README.md.jinja": Index, **{f"{name}.jinja": MasterFile for name in FILE_FORMATS}},
    filters={"comment": comment, "filled": filled, "note": note},
)
TARGET = Target(
    name="masters",
    summary="files that BiSS and SSI masters load",
    files=generate,
    options=(_BY_CODE,),
    templates=TEMPLATES,
    family=_family,
)
