"""Files that BiSS and SSI masters load, for each order code or in bulk.

The description of a master lists its file formats. A format is a row of ``FILE_FORMATS`` and a template with its name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, TypedDict

from ...language.master_items import FILE_FORMATS
from ...language.problems import listed
from ...masters.groups import sheets_of
from ...masters.places import Place
from ...masters.record import Record
from ...masters.sheet import Master, Sheet, shipped_masters
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
    sheet: Sheet,
    rule: Raw,
    master_device: str,
    library: Library | None = None,
    is_short: bool = False,
    file_content: Content | None = None,
) -> str:
    """Return the file for a master and for order codes that have the same settings.

    Args:
        device: The family.
        codes: The order codes. Names in the file are based on the first one.
        sheet: The settings.
        rule: Entry of ``files`` in the description of the master.
        master_device: Device of the master.
        library: The library, for the user's templates.
        is_short: True to leave out the text that all order codes of a family share.
        file_content: The content of the file, if it is known already.
    """
    name = rule["format"]
    file_content = content(sheet, rule, master_device) if file_content is None else file_content
    written_keys = {entry.key for entry in file_content.entries}
    values: MasterFile = {
        "head": [
            *([] if is_short else _heading(device, codes, sheet, rule, master_device)),
            *_content_comments(file_content, is_short),
        ],
        "content": file_content,
        "channels": file_content.channels[:1] if is_short else file_content.channels,
        "name": re.sub(r"\W|^(?=\d)", "_", codes[0], flags=re.ASCII),
        "device": master_device,
        "also": {key: value for key, value in rule.get("also", {}).items() if key not in written_keys},
        "line": rule.get("line", ""),
    }
    return TEMPLATES.render(f"{name}.jinja", values, library.own_templates if library is not None else None)


def _heading(device: Device, codes: Sequence[str], sheet: Sheet, rule: Raw, master_device: str) -> Iterator[str]:
    format_ = FILE_FORMATS[rule["format"]]
    yield f"{master_device} with {', '.join(codes)}. For {format_.title}."
    yield from _origin(device, sheet, rule, master_device)


def _origin(device: Device, sheet: Sheet, rule: Raw, master_device: str) -> Iterator[str]:
    format_, manual = FILE_FORMATS[rule["format"]], device.manual
    yield f"From the spec of {device.title}, manual {manual.title}, revision {manual.revision}."
    used = {word for place in _places(sheet, master_device) for word in re.split(r"[;:]\s*", place.source)}
    documents = (document for document in sheet.master.documents if document.key in used)
    cited_documents = "; ".join(f"{document.key}: {document.title}" for document in documents)
    yield f"From the documents of the master: {cited_documents}."
    read = f"Read by {format_.reader}, see docs/master-files.md." if format_.reader else "Not yet read by its tool."
    yield f"Not yet tested on hardware. {read} Form of the file: {cited(rule['source'])}."


def _places(sheet: Sheet, master_device: str) -> Iterator[Place]:
    """Yield the locations of all settings on a device."""
    yield from (place for setting in sheet.settings for place in setting.places if place.device == master_device)


def _content_comments(file_content: Content, is_short: bool) -> Iterator[str]:
    derived = list(dict.fromkeys(entry.name for entry in file_content.entries if "derived" in entry.mark))
    if derived:
        yield f"Derived, not stated in a document: {listed(derived)}."
    starts = list(dict.fromkeys(entry.name for entry in file_content.entries if "start with" in entry.mark))
    if starts:
        yield f"Only a value to start with, because the highest clock of the encoder is not known: {listed(starts)}."
    for sentence in file_content.left_out:
        yield f"Not in this file: {sentence}"
    if not is_short:
        yield from file_content.conditions


def comment(paragraphs: Sequence[str], prefix: str) -> str:
    """Return paragraphs as a comment whose lines begin with ``prefix``, which is ``<!--`` in XML."""
    if prefix == "<!--":
        lines = (wrapped(note(paragraph), _WIDTH, "       ", "     ") for paragraph in paragraphs)
        return "\n".join(["<!--", *lines, "-->"])
    if prefix == "//":
        # A backslash at the end of a line would continue it.
        paragraphs = [paragraph.replace("\\", "/") for paragraph in paragraphs]
    return "\n".join(wrapped(paragraph, _WIDTH, f"{prefix}   ", f"{prefix} ") for paragraph in paragraphs)


def note(text: object) -> str:
    """Return text that cannot end a one-line comment in XML or C."""
    return plain(text).replace("--", "- -").replace("*/", "* /")


def filled(pattern: str, file_content: Content) -> str:
    """Return the pattern with each name in braces replaced by the value of that name."""
    for entry in file_content.entries:
        pattern = pattern.replace(f"{{{entry.key}}}", entry.word)
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
    write = _files_by_code if options.get(_BY_CODE.name, _BY_CODE.default) == _EACH else _bulk_file
    files: dict[str, str] = {}
    masters = shipped_masters()
    interface_sheets = sheets_of(device, masters)
    for number, master in enumerate(masters):
        usable: list[SheetOfCodes] = []
        for group_sheets in interface_sheets:
            pairs = zip(group_sheets.sheets[number][1], group_sheets.groups, strict=True)
            usable += ((sheet, group.record, group.codes) for sheet, group in pairs if not sheet.refusals)
        for rule in master.files:
            for master_device in dict.fromkeys(name for sheet, _, _ in usable for name in sheet.devices_with(rule)):
                folder = f"masters/{master.name}/{rule['format']}"
                stem = "" if len(master.devices) == 1 else f"{names_of_codes([master_device])[0]}-"
                sheets = [sheet_of_codes for sheet_of_codes in usable if master_device not in sheet_of_codes[0].barred]
                files |= write(f"{folder}/{stem}", device, sheets, rule, master_device, library)
    return files


def _index(library: Library, files: Iterable[str]) -> str:
    folders = {path.rpartition("/")[0].removeprefix("masters/") for path in files}
    rows = [_index_row(master, rule["format"]) for master in shipped_masters() for rule in master.files]
    rows = [row for row in rows if row["folder"] in folders]
    values: Index = {"families": [markdown(device.title) for device in library.devices], "rows": rows}
    return TEMPLATES.render("README.md.jinja", values, library.own_templates)


def _index_row(master: Master, format_name: str) -> dict[str, str]:
    format_ = FILE_FORMATS[format_name]
    return {
        "master": master.title,
        "format": format_name,
        "folder": f"{master.name}/{format_name}",
        "title": format_.title,
        "reader": format_.reader,
    }


#: The settings of order codes, with the record and the codes that share them.
SheetOfCodes = tuple[Sheet, Record, Sequence[str]]


def _files_by_code(
    start: str, device: Device, sheets: Sequence[SheetOfCodes], rule: Raw, master_device: str, library: Library
) -> dict[str, str]:
    suffix = FILE_FORMATS[rule["format"]].suffix
    labels: list[str] = []
    texts: list[str] = []
    for sheet, record, codes in sheets:
        labels += (_label(code, record) for code in codes)
        texts += (file_text(device, [code], sheet, rule, master_device, library) for code in codes)
    return {f"{start}{name}{suffix}": text for name, text in zip(names_of_codes(labels), texts, strict=True)}


def _label(code: str, record: Record) -> str:
    return "-".join((code, *record.answers.values()))


def _bulk_file(
    start: str, device: Device, sheets: Sequence[SheetOfCodes], rule: Raw, master_device: str, library: Library
) -> dict[str, str]:
    """Return one file in which order codes with the same content share a block."""
    format_ = FILE_FORMATS[rule["format"]]
    alike: dict[tuple[Content, Sequence[tuple[str, str]]], list[SheetOfCodes]] = {}
    for sheet_of_codes in sheets:
        sheet, record, _ = sheet_of_codes
        file_content = content(sheet, rule, master_device)
        alike.setdefault((file_content, tuple(record.answers.items())), []).append(sheet_of_codes)
    blocks = []
    for (file_content, answers), sheets_alike in alike.items():
        codes = [code for _, _, codes_of_sheet in sheets_alike for code in codes_of_sheet]
        choices = " and ".join(f"{name}={answer}" for name, answer in answers)
        title = f"{', '.join(codes)} with {choices}" if choices else ", ".join(codes)
        sheet = sheets_alike[0][0]
        text = file_text(device, codes, sheet, rule, master_device, library, is_short=True, file_content=file_content)
        blocks.append((title, text))
    return {f"{start}{device.name}{format_.suffix}": _joined_blocks(device, blocks, sheet, rule, master_device)}


def _joined_blocks(
    device: Device, blocks: Sequence[tuple[str, str]], sheet: Sheet, rule: Raw, master_device: str
) -> str:
    """Return the files as comments, or as children of one element in XML."""
    format_ = FILE_FORMATS[rule["format"]]
    head = [
        f"{master_device} with the order codes of {device.title}. For {format_.title}.",
        *_origin(device, sheet, rule, master_device),
    ]
    head += dict.fromkeys(condition(writing_rule) for writing_rule in sheet.writing)
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
